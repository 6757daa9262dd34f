// `wisp plan`: its three forms agree with each other, and each has the syntax of its format. `wisp view`: the page holds the
// scene, its files and the hashes of a native run. The page itself is tested in a browser by `./dev web test`; here a short
// one takes its place.
#include "program_fixture.h"

#include <jansson.h>
#include <sys/stat.h>
#include <unistd.h>

static const char hair_scene[] =
    "wisp: 1\n"
    "steps: 3\n"
    "strands:\n"
    "  - name: hair\n"
    "    generate: { shape: wavy, dimension: 2, strands: 40, vertices: 20, spacing: 0.001 }\n"
    "    frozen_hair:\n"
    "      freeze: {}\n"
    "      align: { cursor: [0, -0.3, 0] }\n"
    "    appearance: {}\n"
    "    compute: [points, width]\n";

static json_t* read_json( const char* command )
{
    run_ok( command );
    assert_string_equal( result.err, "" );
    json_error_t error;
    json_t* root = json_loads( result.out, JSON_REJECT_DUPLICATES, &error );
    if ( root == NULL )
    {
        fail_msg( "line %d: %s", error.line, error.text );
    }
    return root;
}

static const char* word( const json_t* object, const char* key )
{
    return json_string_value( json_object_get( object, key ) );
}

static json_t* find( const json_t* array, const char* name )
{
    for ( size_t i = 0; i < json_array_size( array ); ++i )
    {
        json_t* item = json_array_get( array, i );
        if ( strcmp( word( item, "name" ), name ) == 0 )
        {
            return item;
        }
    }
    fail_msg( "nothing is called %s", name );
    return NULL;
}

static double sum_of( const json_t* passes, const char* key, int* count )
{
    double sum = 0.0;
    *count = 0;
    for ( size_t i = 0; i < json_array_size( passes ); ++i )
    {
        const json_t* value = json_object_get( json_array_get( passes, i ), key );
        assert_non_null( value );
        assert_true( json_is_null( value ) || isfinite( json_number_value( value ) ) );
        *count += json_is_null( value ) ? 0 : 1;
        sum += json_number_value( value );
    }
    return sum;
}

TEST( shares_of_the_json_form_sum_to_one )
{
    json_t* root = read_json( "plan hair.yaml --format json --steps 4" );
    const json_t* passes = json_object_get( root, "passes" );
    const int kept = (int)json_integer_value( json_object_get( root, "active" ) );
    assert_int_equal( json_integer_value( json_object_get( root, "wisp_plan" ) ), 2 );
    assert_int_equal( kept, 6 ); // command, start, freeze, align, vertices in the user's order, width
    const char* const keys[] = { "predicted_fraction", "measured_fraction" };
    for ( int i = 0; i < WISP_COUNT( keys ); ++i )
    {
        int count = 0;
        // a handful of quotients, each rounded once, and their text has all digits
        assert_true( fabs( sum_of( passes, keys[i], &count ) - 1.0 ) < 1e-12 );
        assert_int_equal( count, kept );
    }
    const json_t* measured = json_object_get( root, "measured" );
    assert_int_equal( json_integer_value( json_object_get( measured, "steps" ) ), 4 );
    assert_int_equal( json_integer_value( json_object_get( measured, "plan_changes" ) ), 0 );
    json_decref( root );
}

TEST( without_steps_nothing_is_measured_and_all_else_is_told )
{
    json_t* root = read_json( "plan hair.yaml --format json --steps 0" );
    int count = 0;
    sum_of( json_object_get( root, "passes" ), "measured_fraction", &count );
    assert_int_equal( count, 0 );
    assert_true( json_is_null( json_object_get( root, "measured" ) ) );
    assert_true( fabs( sum_of( json_object_get( root, "passes" ), "predicted_fraction", &count ) - 1.0 ) < 1e-12 );
    json_decref( root );
    run_ok( "plan hair.yaml --steps 0" );
    assert_null( strstr( result.out, "measured 0" ) );
    assert_non_null( strstr( result.out, "nothing was measured: --steps 0" ) );
}

TEST( an_active_pass_of_the_json_form_has_its_reasons_and_its_place )
{
    json_t* root = read_json( "plan hair.yaml --format json" );
    const json_t* freeze = find( json_object_get( root, "passes" ), "frozen_hair.freeze" );
    assert_string_equal( word( freeze, "state" ), "active" );
    assert_string_equal( word( freeze, "module" ), "frozen_hair" );
    assert_string_equal( word( freeze, "stage" ), "shape" );
    const json_t* place = json_object_get( freeze, "place" );
    assert_string_equal( word( place, "loop" ), "after" );
    assert_int_equal( json_integer_value( json_object_get( place, "items" ) ), 3 ); // 40 strands, 16 per group
    assert_true( json_integer_value( json_object_get( place, "bytes" ) ) > 0 );
    const json_t* reasons = json_object_get( freeze, "reasons" );
    assert_true( json_array_size( reasons ) > 0 );
    assert_string_equal( word( json_array_get( reasons, 0 ), "component" ), "strand.position" );
    const json_t* width = find( json_object_get( root, "passes" ), "strand_appearance.width" );
    const json_t* reason = json_array_get( json_object_get( width, "reasons" ), 0 );
    assert_string_equal( word( reason, "component" ), "point.width" );
    assert_true( json_is_null( json_object_get( reason, "reader" ) ) ); // a request of the scene
    json_decref( root );
}

TEST( every_absent_module_and_pass_has_its_reason_in_every_form )
{
    json_t* root = read_json( "plan hair.yaml --format json" );
    const json_t* modules = json_object_get( root, "modules" );
    assert_string_equal( word( find( modules, "balloon" ), "missing" ), "balloon.gas" );
    assert_true( json_is_true( json_object_get( find( modules, "frozen_hair" ), "present" ) ) );
    static const char* const FORMS[] = { "plan hair.yaml --verbose", "plan hair.yaml --format dot" };
    for ( int form = 0; form < WISP_COUNT( FORMS ); ++form )
    {
        run_ok( FORMS[form] );
        for ( size_t i = 0; i < json_array_size( modules ); ++i )
        {
            const json_t* m = json_array_get( modules, i );
            const bool is_present = json_is_true( json_object_get( m, "present" ) );
            assert_non_null( strstr( result.out, word( m, "name" ) ) );
            assert_true( is_present || strstr( result.out, word( m, "because" ) ) != NULL );
        }
    }
    const json_t* clump = find( json_object_get( root, "passes" ), "frozen_hair.clump" );
    assert_string_equal( word( clump, "state" ), "missing" );
    assert_string_equal( json_string_value( json_array_get( json_object_get( clump, "missing" ), 0 ) ),
                         "frozen_hair.clump" );
    assert_true( json_is_null( json_object_get( clump, "place" ) ) );
    json_decref( root );
}

TEST( the_verbose_text_names_each_pass_of_the_json_form )
{
    json_t* root = read_json( "plan hair.yaml --format json" );
    run_ok( "plan hair.yaml --verbose" );
    const json_t* passes = json_object_get( root, "passes" );
    for ( size_t i = 0; i < json_array_size( passes ); ++i )
    {
        char line[512];
        snprintf( line, sizeof( line ), " %s ", word( json_array_get( passes, i ), "name" ) );
        assert_non_null( strstr( result.out, line ) );
    }
    assert_non_null( strstr( result.out, word( root, "hash" ) ) );
    assert_non_null( strstr( result.out, "measured on one worker: 10 steps" ) );
    json_decref( root );
}

TEST( the_short_text_has_a_line_for_each_active_pass_and_absent_module )
{
    json_t* root = read_json( "plan hair.yaml --format json" );
    run_ok( "plan hair.yaml" );
    const json_t* passes = json_object_get( root, "passes" );
    for ( size_t i = 0; i < json_array_size( passes ); ++i )
    {
        char name[128];
        const bool is_active = strcmp( word( json_array_get( passes, i ), "state" ), "active" ) == 0;
        snprintf( name, sizeof( name ), " %s ", word( json_array_get( passes, i ), "name" ) );
        assert_true( ( strstr( result.out, name ) != NULL ) == is_active );
    }
    assert_non_null( strstr( result.out, "requested by the scene\n" ) );
    assert_non_null( strstr( result.out, "read by frozen_hair.align" ) );
    assert_non_null( strstr( result.out, "needs component balloon.gas, which no entity has\n" ) );
    // every line ends in a newline
    for ( const char* line = result.out; *line; line += strcspn( line, "\n" ) + 1 )
    {
        assert_true( strcspn( line, "\n" ) <= 100 );
    }
    json_decref( root );
}

// ---- graphs ----

// Reads one quoted string. @return the position after its closing quote
static const char* skip_string( const char* at )
{
    for ( ++at; *at != '"'; ++at )
    {
        assert_true( *at != '\0' && *at != '\n' );
        at += *at == '\\' ? 1 : 0;
    }
    return at + 1;
}

static void assert_balanced( const char* dot )
{
    int braces = 0, brackets = 0;
    for ( const char* at = dot; *at; )
    {
        braces += *at == '{' ? 1 : *at == '}' ? -1 : 0;
        brackets += *at == '[' ? 1 : *at == ']' ? -1 : 0;
        assert_true( braces >= 0 && brackets >= 0 && brackets <= 1 );
        at = *at == '"' ? skip_string( at ) : at + 1;
    }
    assert_int_equal( braces, 0 );
    assert_int_equal( brackets, 0 );
}

TEST( a_graph_is_balanced_and_names_each_kept_pass_once )
{
    json_t* root = read_json( "plan hair.yaml --format json" );
    run_ok( "plan hair.yaml --format dot" );
    assert_int_equal( strncmp( result.out, "digraph wisp_plan {", 19 ), 0 );
    assert_balanced( result.out );
    const json_t* passes = json_object_get( root, "passes" );
    for ( size_t i = 0; i < json_array_size( passes ); ++i )
    {
        char node[128];
        snprintf( node, sizeof( node ), "\"%s\" [label=", word( json_array_get( passes, i ), "name" ) );
        const bool is_kept = strcmp( word( json_array_get( passes, i ), "state" ), "active" ) == 0;
        const char* first = strstr( result.out, node );
        // an edge ends in the same words, but never begins a line of its own cluster
        char line[144];
        snprintf( line, sizeof( line ), "      %s", node );
        assert_true( ( strstr( result.out, line ) != NULL ) == is_kept );
        assert_true( is_kept || first == NULL );
    }
    assert_non_null( strstr( result.out, "\"frozen_hair.freeze\" -> \"frozen_hair.align\"" ) );
    assert_non_null( strstr( result.out, "label=\"after\"" ) );
    assert_non_null( strstr( result.out, "label=\"shape\"" ) );
    json_decref( root );
}

TEST( a_quote_in_a_name_does_not_end_a_string_of_the_graph )
{
    run_ok( "plan quo\"te.yaml --format dot --steps 0" );
    assert_balanced( result.out );
    assert_non_null( strstr( result.out, "quo\\\"te.yaml" ) );
    json_t* root = read_json( "plan quo\"te.yaml --format json --steps 0" );
    assert_non_null( strstr( word( root, "scene" ), "quo\"te.yaml" ) );
    json_decref( root );
}

// ---- scenes of the tree, and invalid arguments ----

TEST( an_empty_scene_has_a_plan_in_every_form )
{
    json_t* root = read_json( "plan " WISP_SOURCE_ROOT "/data/scenes/empty.yaml --format json" );
    assert_int_equal( json_integer_value( json_object_get( root, "active" ) ), 0 );
    int count = 0;
    sum_of( json_object_get( root, "passes" ), "measured_fraction", &count );
    assert_int_equal( count, 0 );
    json_decref( root );
    run_ok( "plan " WISP_SOURCE_ROOT "/data/scenes/empty.yaml --format dot" );
    assert_balanced( result.out );
}

TEST( a_scene_with_substeps_has_loops_and_what_comes_round_is_dashed )
{
    run_ok( "plan " WISP_SOURCE_ROOT "/data/scenes/hanging_cloth.yaml --format dot --steps 1" );
    assert_balanced( result.out );
    static const char* const LOOPS[] = { "substep", "iteration", "substep end", "after" };
    for ( int i = 0; i < WISP_COUNT( LOOPS ); ++i )
    {
        char label[40];
        snprintf( label, sizeof( label ), "label=\"%s\"", LOOPS[i] );
        assert_non_null( strstr( result.out, label ) );
    }
    assert_non_null( strstr( result.out, "style=dashed, constraint=false" ) );
}

TEST( what_runs_together_is_told_in_every_form )
{
#define CHAINS "plan " WISP_SOURCE_ROOT "/data/scenes/chain_links.yaml --steps 1 --format "
    json_t* root = read_json( CHAINS "json" );
    const json_t* passes = json_object_get( root, "passes" );
    const json_t* stretch = json_object_get( find( passes, "strands.stretch" ), "place" );
    assert_string_equal( word( stretch, "fusion" ), "strands.substeps" );
    // of strands whose lengths are kept by links
    const json_t* links = json_object_get( find( passes, "strands.links" ), "place" );
    assert_true( json_is_null( json_object_get( links, "fusion" ) ) );
    json_decref( root );
    run( CHAINS "text --verbose" );
    assert_non_null( strstr( result.out, "strands.stretch          (fused) (in strands.substeps)" ) );
    run( CHAINS "dot" );
    assert_balanced( result.out );
    assert_non_null( strstr( result.out, "fused, in strands.substeps" ) );
#undef CHAINS
}

// ---- view ----

#define PLACE "<script type=\"application/json\" id=\"wisp-data\">"

static const char square_scene[] = "wisp: 1\n"
                                   "steps: 130\n"
                                   "surfaces:\n"
                                   "  - name: \"cloth\"  # </script><!--\n"
                                   "    file: ../meshes/square.obj\n"
                                   "    pins: [0]\n"
                                   "    cloth: {}\n";
static const char square[] = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3\nf 1 3 4\n";

// The data of a page, which must be all between their place and the next end of a script.
static json_t* data_of( const char* path )
{
    size_t size;
    SCOPED( free_local ) char* page = read_bytes( path, &size );
    const char* begin = strstr( page, PLACE );
    assert_non_null( begin );
    begin += sizeof PLACE - 1;
    const char* end = strstr( begin, "</script>" );
    assert_non_null( end );
    assert_string_equal( end, "</script><p>after</p></html>" );
    json_error_t error;
    json_t* data = json_loadb( begin, (size_t)( end - begin ), JSON_REJECT_DUPLICATES, &error );
    if ( data == NULL )
    {
        fail_msg( "%s", error.text );
    }
    return data;
}

static void decode( const char* text, char* out, size_t size )
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    unsigned bits = 0;
    size_t count = 0, length = 0;
    for ( const char* at = text; *at && *at != '='; ++at )
    {
        bits = bits << 6 | (unsigned)( strchr( letters, *at ) - letters );
        if ( ++count % 4 != 1 )
        {
            assert_true( length + 1 < size );
            out[length++] = (char)( bits >> ( 6 - 2 * ( ( count - 1 ) % 4 ) ) & 255 );
        }
    }
    out[length] = '\0';
}

static void assert_file( const json_t* data, const char* name, const char* content )
{
    char text[2000];
    const json_t* file = json_object_get( json_object_get( data, "files" ), name );
    assert_non_null( file );
    decode( json_string_value( file ), text, sizeof text );
    assert_string_equal( text, content );
}

TEST( a_page_holds_the_scene_and_the_files_that_it_reads )
{
    run_ok( "view scenes/square.yaml -o page.html --steps 0" );
    json_t* data = data_of( "page.html" );
    assert_string_equal( json_string_value( json_object_get( data, "kind" ) ), "scene" );
    assert_string_equal( json_string_value( json_object_get( data, "name" ) ), "square.yaml" );
    assert_string_equal( json_string_value( json_object_get( data, "title" ) ), "square" );
    assert_int_equal( json_object_size( json_object_get( data, "files" ) ), 2 );
    assert_file( data, "square.yaml", square_scene );
    assert_file( data, "../meshes/square.obj", square );
    json_decref( data );
}

TEST( hashes_of_a_page_are_those_of_wisp_run )
{
    run_ok( "view scenes/square.yaml -o page.html" );
    json_t* data = data_of( "page.html" );
    const json_t* hashes = json_object_get( data, "hashes" );
    const json_t* values = json_object_get( hashes, "values" );
    assert_int_equal( json_integer_value( json_object_get( hashes, "every" ) ), 60 );
    assert_int_equal( json_array_size( values ), 2 ); // of 130 steps
    for ( int i = 0; i < 2; ++i )
    {
        char command[80];
        snprintf( command, sizeof command, "run scenes/square.yaml --steps %d", 60 * ( i + 1 ) );
        run_ok( command );
        assert_non_null( strstr( result.out, json_string_value( json_array_get( values, (size_t)i ) ) ) );
    }
    json_decref( data );
}

TEST( a_page_of_a_recording_holds_its_bytes )
{
    run_ok( "run scenes/square.yaml --steps 3 --record run.wisp" );
    run_ok( "view run.wisp -o page.html" );
    json_t* data = data_of( "page.html" );
    assert_string_equal( json_string_value( json_object_get( data, "kind" ) ), "recording" );
    const json_t* file = json_object_get( json_object_get( data, "files" ), "run.wisp" );
    size_t size;
    free( read_bytes( "run.wisp", &size ) );
    assert_int_equal( json_string_length( file ), ( size + 2 ) / 3 * 4 );
    json_decref( data );
}

TEST( wrong_input_is_refused_and_writes_nothing )
{
    assert_refused( "view wrong.txt -o none.html",
                    "wrong.txt: got another kind of file, expected a scene or a recording" );
    assert_refused( "view \xff.yaml -o none.html", "No such file" );
    write_text( "bad\xff.yaml", "wisp: 1\n" );
    assert_refused( "view bad\xff.yaml -o none.html", "not UTF-8" );
    run_ok( "run scenes/square.yaml --steps 3 --record run.wisp" );
    assert_refused( "view run.wisp --steps 3 -o none.html", "a recording is played, not simulated" );
    write_text( "viewer.html", "<html></html>" );
    assert_refused( "view scenes/square.yaml -o none.html --steps 0", "the page has no place for data" );
    remove( "viewer.html" );
    assert_refused( "view scenes/square.yaml -o none.html --steps 0", "'./dev web' builds it" );
    assert_int_not_equal( access( "none.html", F_OK ), 0 );
}

static int enter_folder( void** state )
{
    static const text_file files[] = {
        { "viewer.html", "<html>" PLACE "null</script><p>after</p></html>" },
        { "wrong.txt", "nothing" },
        { "hair.yaml", hair_scene },
        { "quo\"te.yaml", hair_scene },
    };
    if ( enter_folder_with( state, files, WISP_COUNT( files ) ) != 0 )
    {
        return -1;
    }
    static const text_file inner[] = { { "scenes/square.yaml", square_scene }, { "meshes/square.obj", square } };
    mkdir( "scenes", 0777 );
    mkdir( "meshes", 0777 );
    for ( int i = 0; i < WISP_COUNT( inner ); ++i )
    {
        write_text( inner[i].name, inner[i].text );
    }
    setenv( "WISP_DATA", ".", 1 );
    return 0;
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
