// Valid scenes. The reference of all keys: it equals
// docs/scenes.md, describes every key completely, and what is gone has an answer.
#define _XOPEN_SOURCE 700

#include "locale_fixture.h"
#include "scene_fixture.h"

#include "files.h"
#include "nearest.h"
#include "scene.h"
#include "scene_keys.h"

// The text in a block exactly as long, so that a sanitizer detects a read beyond its end.
static wisp_status parse( const char* text, size_t size, wisp_scene* scene, wisp_error* error )
{
    SCOPED( free_local ) char* exact = checked_malloc( size + ( size == 0 ) );
    memcpy( exact, text, size );
    return wisp_scene_parse( exact, size, "scenes/test.yaml", scene, error );
}

static wisp_scene good( const char* text )
{
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    assert_ok( parse( text, strlen( text ), &scene, &error ), error );
    return scene;
}

static void demand_refusal( const char* text, const char* message )
{
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( parse( text, strlen( text ), &scene, &error ), WISP_BAD_INPUT );
    assert_string_equal( error.message, message );
}

// ---- missing keys ----

TEST( a_scene_of_one_key_has_the_defaults )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = good( "wisp: 1\n" );
    assert_string_equal( scene.name, "scenes/test.yaml" );
    assert_true( scene.dt == 1.0f / 60.0f );
    assert_int_equal( scene.steps, 1 );
    assert_int_equal( scene.substeps, 10 );
    assert_int_equal( scene.iterations, 1 );
    assert_int_equal( scene.workers, 0 );
    assert_int_equal( scene.strands_count + scene.command_count + scene.output_count, 0 );
}

TEST( a_stage_is_queried_for_by_its_key_alone )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good( "wisp: 1\nstrands:\n"
                             "  - { name: a, generate: {}, frozen_hair: { freeze: {} } }\n"
                             "  - { name: b, generate: {}, frozen_hair: { align: {} } }\n"
                             "  - { name: c, generate: {}, frozen_hair: { clump: {} } }\n"
                             "  - { name: d, generate: {}, frozen_hair: {} }\n" );
    for ( int i = 0; i < 4; ++i )
    {
        const wisp_frozen_hair_def* hair = &scene.strands[i].frozen_hair;
        assert_true( scene.strands[i].has_frozen_hair );
        assert_int_equal( hair->freeze, i == 0 );
        assert_int_equal( hair->align, i == 1 );
        assert_int_equal( hair->clump, i == 2 );
    }
    // Lengths that follow the radius stay unset, so that the module computes them from it.
    assert_true( scene.strands[2].frozen_hair.clump_step_length == wisp_default_frozen_hair_def().clump_step_length );
}

TEST( a_generator_takes_the_defaults_of_its_shape_wherever_the_shape_stands )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good( "wisp: 1\nstrands:\n"
                             "  - { name: a, generate: { length: 0.5, dimension: 2, shape: curly } }\n" );
    wisp_groom_generator expected = wisp_default_groom_generator( WISP_GROOM_CURLY, 2 );
    const wisp_groom_generator* generator = &scene.strands[0].generator;
    assert_int_equal( generator->shape, WISP_GROOM_CURLY );
    assert_int_equal( generator->dimension, 2 );
    assert_int_equal( generator->strand_count, expected.strand_count );
    assert_int_equal( generator->vertices_per_strand, expected.vertices_per_strand );
    assert_true( generator->wave_length == expected.wave_length );
    assert_true( generator->length == 0.5f );
}

// ---- given keys ----

// Lists that no field of a table describes.
TEST( lists_of_strands_reach_their_place )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good( "wisp: 1\n"
                             "output: [ { file: out/a.usda, strands: hair } ]\n" // before the strands that it names
                             "strands:\n  - name: hair\n    generate: { strands: 2, seed: 18446744073709551615 }\n"
                             "    environment: { curve: [[0, 30], [0.25, 9], [1, 2]] }\n"
                             "    compute: [colour, width]\n    appearance: {}\n    frozen_hair: {}\n"
                             "hair_events: [ { cursor: [4, 5, 6], strands: hair, step: 0 } ]\n" );
    const wisp_scene_strands* s = &scene.strands[0];
    assert_true( s->generator.seed == UINT64_MAX );
    assert_int_equal( s->environment.point_count, 3 );
    assert_true( s->environment.ice[1] == 0.25f && s->environment.stiffness[1] == 9.0f &&
                 s->environment.stiffness[2] == 2.0f );
    assert_true( s->request_width && s->request_colour );
    assert_int_equal( scene.commands[0].strands, 0 );
    assert_string_equal( scene.outputs[0].file, "out/a.usda" );
    assert_int_equal( scene.outputs[0].strands, 0 );
    assert_int_equal( scene.outputs[0].line, 2 );
}

TEST( points_are_requested_unless_the_scene_says_what_to_compute )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene =
        good( "wisp: 1\nstrands: [ { name: a, generate: {}, compute: [] }, { name: b, generate: {}, compute: [] }, "
              "{ name: c, generate: {} }, { name: d, generate: {}, show: false } ]\n"
              "output: [ { strands: b, file: b.obj } ]\n" );
    assert_false( scene.strands[0].request_points );
    assert_true( scene.strands[1].request_points );
    assert_true( scene.strands[2].request_points );
    assert_false( scene.strands[3].request_points );
}

TEST( commands_come_in_the_order_of_their_steps )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good( "wisp: 1\nsteps: 9\n"
                             "strands:\n"
                             "  - { name: b, generate: {}, frozen_hair: {} }\n"
                             "  - { name: a, generate: {}, frozen_hair: {} }\n"
                             "hair_events:\n"
                             "  - { step: 8, strands: a, cursor: [8, 0, 0] }\n"
                             "  - { step: 0, strands: a, cursor: [1, 0, 0] }\n"
                             "  - { step: 0, strands: b, cursor: [0, 0, 0] }\n"
                             "  - { step: 4, strands: b, cursor: [4, 0, 0] }\n" );
    static const float cursors[] = { 0.0f, 1.0f, 4.0f, 8.0f };
    static const int lines[] = { 9, 8, 10, 7 };
    assert_int_equal( scene.command_count, 4 );
    for ( int i = 0; i < 4; ++i )
    {
        assert_true( scene.commands[i].cursor.x == cursors[i] );
        assert_int_equal( scene.commands[i].line, lines[i] );
    }
}

TEST( hair_events_change_parameters_from_then_on )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good( "wisp: 1\nsteps: 9\n"
                             "strands:\n"
                             "  - name: a\n    generate: {}\n"
                             "    frozen_hair: { base: stroke, freeze: {}, align: {}, clump: {} }\n"
                             "  - { name: b, generate: {}, frozen_hair: { freeze: {} } }\n"
                             "hair_events:\n"
                             "  - { step: 4, strands: a, begin_stroke: true }\n"
                             "  - { step: 1, strands: a, cursor: [1, 0, 0], intensity: 0.25, reach: 0.5 }\n"
                             "  - { step: 2, strands: a, stretch_stiffness: 4, bend_stiffness: 5, intensity: 0.5 }\n"
                             "  - { step: 2, strands: b, cursor: [0, 0, 0], bend_stiffness: 6 }\n"
                             "  - { step: 5, strands: a, clump_radius: 0.02 }\n" );
    assert_int_equal( scene.strands[0].frozen_hair.base, WISP_FROZEN_BASE_STROKE );
    assert_int_equal( scene.command_count, 5 );
    const wisp_scene_hair_event* e = scene.commands;
    assert_true( e[0].has_cursor && e[0].changes && e[0].intensity == 0.25f && e[0].reach == 0.5f );
    assert_false( e[0].has_bend_stiffness || e[0].begin_stroke );
    assert_true( e[1].changes && !e[1].has_cursor && e[1].intensity == 0.5f && e[1].reach == 0.5f );
    assert_true( e[1].stretch_stiffness == 4.0f && e[1].bend_stiffness == 5.0f );
    assert_true( e[2].has_bend_stiffness && e[2].bend_stiffness == 6.0f && !e[2].has_intensity );
    assert_true( e[3].begin_stroke && !e[3].changes && !e[3].has_cursor && e[3].intensity == 0.5f );
    assert_true( e[4].changes && e[4].clump_radius == 0.02f && e[4].bend_stiffness == 5.0f );
}

TEST( files_are_looked_for_beside_the_scene )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good( "wisp: 1\nstrands:\n"
                             "  - { name: a, file: ../grooms/hair.hair, frozen_hair: { freeze: "
                             "{ bend_stiffness: [1, 2, 3, 4, 5] } } }\n"
                             "  - { name: b, file: /grooms/hair.hair }\n" );
    assert_string_equal( scene.strands[0].file, "scenes/../grooms/hair.hair" );
    assert_false( scene.strands[0].is_generated );
    assert_int_equal( scene.strands[0].bend_count, 5 );
    assert_string_equal( scene.strands[1].file, "/grooms/hair.hair" );
}

// ---- files ----

TEST( a_scene_in_json_says_the_same_as_in_yaml )
{
    SCOPED( wisp_scene_release )
    wisp_scene yaml = read_good( "freeze_only.yaml" ), json = read_good( "freeze_only.json" );
    const wisp_scene_strands *a = yaml.strands, *b = json.strands;
    assert_string_equal( a->name, b->name );
    assert_int_equal( a->stretch_count, 8 );
    assert_int_equal( b->stretch_count, 8 );
    assert_memory_equal( a->frozen_hair.strand_stretch_stiffness, b->frozen_hair.strand_stretch_stiffness,
                         8 * sizeof( float ) );
    assert_memory_equal( a->frozen_hair.strand_bend_stiffness, b->frozen_hair.strand_bend_stiffness,
                         8 * sizeof( float ) );
    assert_int_equal( a->generator.shape, b->generator.shape );
    assert_int_equal( a->generator.strand_count, b->generator.strand_count );
    assert_true( a->generator.seed == b->generator.seed );
}

TEST( scenes_with_the_keys_of_every_block_are_read )
{
    static const char* const files[] = { "every_key", "boundary_and_contact", "implicit_cloth", "moving_strands" };
    for ( int i = 0; i < WISP_COUNT( files ); ++i )
    {
        char path[400];
        wisp_error error = { .status = WISP_OK };
        SCOPED( wisp_scene_release ) wisp_scene scene;
        snprintf( path, sizeof path, WISP_SOURCE_ROOT "/tests/app/scenes/%s.yaml", files[i] );
        assert_ok( wisp_scene_read( path, &scene, &error ), error );
        if ( i == 0 )
        {
            assert_int_equal( scene.strands[0].bend_count, 4 );
            assert_int_equal( scene.command_count, 2 );
            assert_int_equal( scene.surface_count, 4 );
            assert_int_equal( scene.collider_count, 4 );
            assert_int_equal( scene.seam_count, 2 );
            assert_int_equal( scene.event_count, 4 );
            assert_int_equal( scene.output_count, 2 );
        }
    }
}

TEST( a_missing_file_is_an_error_of_the_system )
{
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_scene_read( "no_such_folder/scene.yaml", &scene, &error ), WISP_IO_ERROR );
    assert_non_null( strstr( error.message, "no_such_folder/scene.yaml" ) );
    assert_null( scene.blocks );
    wisp_scene_release( &scene );
    wisp_scene_release( NULL );
}

// ---- text ----

TEST( line_ends_byte_order_marks_and_comments_do_not_matter )
{
    static const char* const texts[] = {
        "wisp: 1\r\nsteps: 7 # seven\r\n",
        "\xef\xbb\xbfwisp: 1\nsteps: 7\n",
        "# caf\xc3\xa9\n---\n\nwisp: 1\nsteps: +7\n...\n",
        "{\n\t\"wisp\": 1,\n\t\"steps\": 7\n}\n",
        "{\"wisp\":1,\"steps\":7}",
    };
    for ( int i = 0; i < WISP_COUNT( texts ); ++i )
    {
        SCOPED( wisp_scene_release ) wisp_scene scene = good( texts[i] );
        assert_int_equal( scene.steps, 7 );
    }
}

TEST( a_byte_order_mark_does_not_push_the_column )
{
    demand_refusal( "\xef\xbb\xbfwisp: 2\n", "scenes/test.yaml:1:7: wisp: got version 2, expected version 1" );
}

TEST( columns_count_characters_and_not_bytes )
{
    demand_refusal( "{ \"wisp\": 1, \"\xc3\xa4\": 2, \"steps\": 1 }",
                    "scenes/test.yaml:1:14: unknown key '\xc3\xa4'; the nearest are dt, wisp, steps, seams; wisp "
                    "info --keys lists all 17" );
    demand_refusal( "{ \"wisp\": 1, \"strands\": [ { \"name\": \"\xc3\xa4\xc3\xa4\", \"generate\": 3 } ] }",
                    "scenes/test.yaml:1:37: strands[0].name: got '\xc3\xa4\xc3\xa4', expected 1 to 64 of the "
                    "characters A-Z a-z 0-9 _ -" );
    demand_refusal( "{ \"wisp\": 1, \"strands\": [ { \"file\": \"\xc3\xa4\xc3\xa4\", \"name\": 3.5 } ] }",
                    "scenes/test.yaml:1:51: strands[0].name: got '3.5', expected 1 to 64 of the characters "
                    "A-Z a-z 0-9 _ -" );
}

TEST( numbers_have_points_whatever_the_locale_of_the_host )
{
    enter_comma_locale();
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    static const char text[] = "wisp: 1\ndt: 0.25\n", bad[] = "wisp: 1\nworkers: 99\n";
    wisp_status status = parse( text, strlen( text ), &scene, &error );
    float seconds = scene.dt;
    wisp_scene_release( &scene );
    wisp_status refusal = parse( bad, strlen( bad ), &scene, &error );
    char point = *localeconv()->decimal_point;
    setlocale( LC_ALL, "C" );

    assert_int_equal( status, WISP_OK );
    assert_true( seconds == 0.25f );
    assert_int_equal( refusal, WISP_BAD_INPUT );
    // and the host gets its own back, after success and after a rejection
    assert_int_equal( point, ',' );
}

// ---- steps that vary ----

TEST( factors_of_steps_repeat )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = good( "wisp: 1\ndt: 0.25\ndt_factors: [1, 2, 0.5]\nsteps: 7\n" );
    static const float lengths[] = { 0.25f, 0.5f, 0.125f, 0.25f, 0.5f, 0.125f, 0.25f };
    double time = 0.0; // sums of powers of two are exact
    for ( int step = 0; step < scene.steps; ++step )
    {
        assert_true( wisp_scene_step_length( &scene, step ) == lengths[step] );
        assert_true( wisp_scene_step_time( &scene, step ) == time );
        assert_true( wisp_scene_step_at( &scene, (float)time ) == step );
        time += (double)lengths[step];
    }
}

TEST( an_event_at_a_time_comes_before_the_step_that_begins_then_or_later )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good( "wisp: 1\ndt: 0.25\ndt_factors: [1, 2, 0.5]\nsteps: 7\n"
                             "surfaces:\n  - { name: a, generate: { shape: plane } }\n"
                             "events:\n  - { time: 0.8, surface: a, velocity: [1, 0, 0] }\n"
                             "  - { time: 1.125, surface: a, velocity: [1, 0, 0] }\n" );
    assert_int_equal( scene.events[0].step, 3 ); // steps begin at 0, 0.25, 0.75, 0.875, 1.125
    assert_int_equal( scene.events[1].step, 4 );
}

// ---- limits ----

static char* repeat( const char* head, const char* part, size_t size )
{
    char* text = checked_malloc( size + 1 );
    size_t at = strlen( head ), length = strlen( part );
    memcpy( text, head, at );
    for ( ; at < size; ++at )
    {
        text[at] = part[( at - strlen( head ) ) % length];
    }
    text[size] = 0;
    return text;
}

TEST( what_is_too_much_is_refused_where_it_becomes_too_much )
{
    const size_t most = (size_t)16 << 20;
    static const struct
    {
        const char *head, *part;
        size_t over; // bytes beyond the most that is read
        const char* message;
    } hostile[] = {
        { "wisp: 1\n", "\n", 1, "scenes/test.yaml: expected at most 16 MiB" },
        { "wisp: 1\nstrands: ", "[", 0, "scenes/test.yaml:2:41: expected at most 32 levels of lists and mappings" },
        { "wisp: 1\nstrands:\n", "- ", 0, "scenes/test.yaml:3:63: expected at most 32 levels of lists and mappings" },
        // A root, the 1, the list and 1048573 items are 1048576 values.
        { "wisp: 1\nstrands: [", "1,", 0, "scenes/test.yaml:2:2097157: expected at most 1048576 values" },
    };
    for ( int i = 0; i < WISP_COUNT( hostile ); ++i )
    {
        SCOPED( free_local ) char* text = repeat( hostile[i].head, hostile[i].part, most + hostile[i].over );
        demand_refusal( text, hostile[i].message );
    }
}

TEST( a_scene_of_16_mebibytes_and_not_one_more_is_read )
{
    SCOPED( free_local ) char* text = repeat( "wisp: 1\n", "\n", (size_t)16 << 20 );
    SCOPED( wisp_scene_release ) wisp_scene scene = good( text );
    assert_int_equal( scene.steps, 1 );
}

TEST( a_list_of_32_levels_is_only_refused_for_what_it_is )
{
    char text[128] = "wisp: 1\nsteps: ";
    memset( text + strlen( text ), '[', 31 );
    memset( text + strlen( text ), ']', 31 );
    demand_refusal( text, "scenes/test.yaml:2:8: steps: got a list, expected a whole number" );
}

TEST( a_long_name_keeps_its_end_in_the_message )
{
    char name[1200];
    memset( name, 'd', sizeof name );
    memcpy( name + sizeof name - 12, "/scene.yaml", 12 );
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_scene_parse( "wisp: 2", 7, name, &scene, &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "/scene.yaml:1:7: wisp: got version 2" ) );
}

TEST( numbers_are_checked_as_the_module_sees_them )
{
    // 3.14159265358979 rounds up to the float above pi, which is the float that the module compares with.
    SCOPED( wisp_scene_release )
    wisp_scene scene =
        good( "wisp: 1\nstrands:\n  - { name: a, generate: {}, frozen_hair: { freeze: { max_bend_angle: "
              "3.14159265358979 }, align: { intensity: 1.00000000001 } } }\n" );
    assert_true( scene.strands[0].frozen_hair.max_bend_angle == 3.14159274f );
    assert_true( scene.strands[0].frozen_hair.intensity == 1.0f );
}

// ---- nearest.h ----

TEST( the_nearest_word_is_the_one_that_was_meant )
{
    static const char* const words[] = { "radius", "iterations", "step", "gap", "guard" };
    static const struct
    {
        const char *typed, *meant;
    } pairs[] = {
        { "raduis", "radius" }, // a swap counts once
        { "RADIUS", "radius" }, // capitals do not count
        { "iteration", "iterations" },
        { "itterattions", "iterations" },
        { "stop", "step" },
        { "gaurd", "guard" },
        { "gap", "gap" },
        { "ga", "gap" },
        { "mass", NULL }, // half of its letters differ
        { "p", NULL },
        { "", NULL },
    };
    for ( int i = 0; i < WISP_COUNT( pairs ); ++i )
    {
        const char* near = nearest_word( pairs[i].typed, words, WISP_COUNT( words ) );
        assert_int_equal( near == NULL, pairs[i].meant == NULL );
        if ( near )
        {
            assert_string_equal( near, pairs[i].meant );
        }
    }
    assert_null( nearest_word( "radius", words, 0 ) );
}

TEST( of_words_equally_near_the_first_is_taken )
{
    static const char* const words[] = { "cat", "bat" };
    assert_ptr_equal( nearest_word( "hat", words, 2 ), words[0] );
}

TEST( a_word_longer_than_any_key_is_near_nothing )
{
    SCOPED( free_local ) char* word = repeat( "", "h", 1 << 20 );
    char almost[66];
    memset( almost, 'h', 64 );
    almost[64] = 0;
    const char* words[] = { almost };
    assert_null( nearest_word( word, words, 1 ) );
    word[63] = 0;
    assert_ptr_equal( nearest_word( word, words, 1 ), almost );
}

static const char DOCUMENT[] = WISP_SOURCE_ROOT "/docs/scenes.md";

// @return text for free()
// Not inlined: gcc 12 would mistake the stream's buffer for the local that held its address.
__attribute__( ( noinline ) ) static char* keys_of( const char* block, int* count )
{
    char* text = NULL;
    size_t size = 0;
    FILE* stream = open_memstream( &text, &size );
    assert_non_null( stream );
    *count = wisp_scene_write_keys( stream, block );
    fclose( stream );
    return text;
}

static char* read_document( void )
{
    size_t size;
    return read_bytes( DOCUMENT, &size );
}

// ---- the document ----

TEST( the_document_has_the_keys_of_the_tables )
{
    static const char begin_mark[] = "<!-- keys: begin -->\n", end_mark[] = "<!-- keys: end -->\n";
    int count = 0;
    SCOPED( free_local ) char *document = read_document(), *keys = keys_of( NULL, &count );
    char* begin = strstr( document, begin_mark );
    assert_non_null( begin );
    begin += strlen( begin_mark );
    char* end = strstr( begin, end_mark );
    assert_non_null( end );
    *end = 0;
    if ( strcmp( begin, keys ) != 0 )
    {
        fail_msg( "docs/scenes.md differs from the tables of the reader; run ./dev docs" );
    }
}

TEST( every_example_of_the_document_is_a_scene )
{
    static const char fence[] = "```yaml\n";
    SCOPED( free_local ) char* document = read_document();
    int examples = 0;
    for ( char* at = strstr( document, fence ); at; at = strstr( at, fence ) )
    {
        at += strlen( fence );
        char* end = strstr( at, "```" );
        assert_non_null( end );
        wisp_scene scene;
        wisp_error error = { .status = WISP_OK };
        if ( wisp_scene_parse( at, (size_t)( end - at ), "example", &scene, &error ) != WISP_OK )
        {
            fail_msg( "example %d is refused: %s", examples, error.message );
        }
        wisp_scene_release( &scene );
        ++examples;
        at = end + 3;
    }
    assert_true( examples >= 5 );
}

// ---- the text ----

TEST( every_key_has_a_message )
{
    int count = 0, keys = 0;
    SCOPED( free_local ) char* text = keys_of( NULL, &count );
    assert_true( count > 30 );
    assert_null( strstr( text, "(null)" ) );
    for ( char* line = strtok( text, "\n" ); line; line = strtok( NULL, "\n" ) )
    {
        if ( strncmp( line, "- `", 3 ) == 0 )
        {
            const char* message = strstr( line, "): " );
            assert_non_null( message );
            assert_true( line[strlen( line ) - 1] == '.' );
            ++keys;
        }
    }
    assert_true( keys > 250 );
}

TEST( a_block_is_written_with_the_blocks_in_it )
{
    int count = 0;
    SCOPED( free_local ) char* text = keys_of( "frozen_hair", &count );
    assert_int_equal( count, 4 );
    assert_non_null( strstr( text, "### `strands[].frozen_hair`\n" ) );
    assert_non_null( strstr( text, "### `strands[].frozen_hair.clump`\n" ) );
    assert_null( strstr( text, "### `strands[]`\n" ) );
    free( text );
    text = keys_of( "surfaces.cloth", &count );
    assert_int_equal( count, 1 );
    free( text );
    text = keys_of( "scene", &count );
    assert_int_equal( count, 1 );
}

TEST( an_unknown_block_writes_nothing )
{
    int count = 1;
    SCOPED( free_local ) char* text = keys_of( "clot", &count );
    assert_int_equal( count, 0 );
    assert_string_equal( text, "" );
}

TEST( a_default_is_that_of_the_module )
{
    int count = 0;
    char expected[100], *text = keys_of( "surfaces.balloon", &count );
    snprintf( expected, sizeof expected, "- `edge_stiffness` (number, N/m, 1e-6 .. 1e12, default %g):",
              (double)wisp_default_balloon_def().edge_stiffness );
    assert_non_null( strstr( text, expected ) );
    free( text );
}

// ---- what is gone ----

TEST( what_is_gone_is_found_in_its_own_block )
{
    const char* use = scene_find_removed( "strands[3].dynamics", "leader_correction", false );
    assert_non_null( use );
    assert_null( scene_find_removed( "strands[3].frozen_hair", "leader_correction", false ) );
    assert_null( scene_find_removed( "strands[3].dynamics.leader_correction", "leader_correction", true ) );
    assert_non_null( scene_find_removed( "strands[3].dynamics.stretch", "follow", true ) );
    assert_non_null( scene_find_removed( "strands[3].dynamics.stretch[2]", "follow", true ) );
    assert_null( scene_find_removed( "strands[3].dynamics.stretch", "fellow", true ) );
    assert_null( scene_find_removed( "strands[3].dynamics.bending", "follow", true ) );
    assert_null( scene_find_removed( "stretch", "follow", true ) );
    assert_null( scene_find_removed( "", "leader_correction", false ) );
}

TEST( copies_stand_in_a_grid_near_the_origin_of_a_far_scene )
{
    char text[1200] = "{ wisp: 1, dt_factors: [1", name[WISP_SCENE_MAX_NAME + 1] = { 0 };
    memset( name, 'a', WISP_SCENE_MAX_NAME ); // as long as it may be, and so is the list
    for ( int i = 1; i < WISP_SCENE_MAX_DT_FACTORS; ++i )
    {
        strcat( text, ", 1" );
    }
    sprintf(
        text + strlen( text ),
        "], surfaces: [ { name: b, generate: { shape: plane }, transform: { translate: [80, 96, -80] }, copies: { "
        "count: 4, columns: 2, spacing: [1, 2, 3] } }, { name: %s, generate: { shape: plane } } ] }",
        name );
    SCOPED( wisp_scene_release ) wisp_scene scene = parsed( text );
    assert_int_equal( scene.surface_count, 5 );
    assert_vector( scene.surfaces[1].pose.translation, -80.0f, -96.0f, 80.0f );
    assert_vector( scene.surfaces[4].pose.translation, 1.0f, 2.0f, 3.0f );
    assert_string_equal( scene.surfaces[4].name, "b-4" );
}
