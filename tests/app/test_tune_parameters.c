// Parameters to tune in a scene: which exist, which fields they set, and their effect on the file.
#include "files.h"

#include "tune_parameters.h"

#define MAKE "    generate: { shape: plane, columns: 3, rows: 3, spacing: 0.1 }\n"

static const char cloths[] = "wisp: 1\n"
                             "substeps: 12\n"
                             "surfaces:\n"
                             "  - name: hanging\n" MAKE "    pins: [0]\n"
                             "    cloth:\n"
                             "      tethers: true\n"
                             "      coarse_substeps: 3 # of mine\n"
                             "  - name: falling\n" MAKE "    cloth: {}\n"
                             "  - { name: copy, instance_of: hanging, pins: [0], cloth: {} }\n"
                             "  - { name: loose, instance_of: hanging, cloth: {} }\n";

static const char implicit[] = "wisp: 1\n"
                               "surfaces:\n"
                               "  - name: a\n" MAKE "    implicit: { tolerance: 0.003, newton_iterations: 3 }\n"
                               "  - name: b\n" MAKE "    implicit: {}\n";

static const char strands[] =
    "wisp: 1\n"
    "substeps: 1\n"
    "strands:\n"
    "  - { name: still, generate: { strands: 2, vertices: 4 } }\n"
    "  - { name: chain, generate: { strands: 2, vertices: 4 }, dynamics: { stretch: links } }\n"
    "  - name: hair\n"
    "    generate: { strands: 2, vertices: 4 }\n"
    "    dynamics:\n"
    "      stretch_passes: 5 # of mine\n"
    "      damping: 1\n"
    "  - { name: other, generate: { strands: 2, vertices: 4 }, dynamics: {} }\n";

/// All parameters, none with an own value that would be tried anyway.
static const char everything[] =
    "wisp: 1\n"
    "substeps: 3\n"
    "iterations: 3\n"
    "surfaces:\n"
    "  - name: a\n" MAKE "    pins: [0]\n"
    "    cloth: { tethers: true, coarse_substeps: 3 }\n"
    "  - name: b\n" MAKE "    implicit: { tolerance: 0.003, newton_iterations: 3 }\n"
    "strands:\n"
    "  - { name: hair, generate: { strands: 2, vertices: 4 }, dynamics: { stretch_passes: 5 } }\n";

static wisp_scene parse( const char* text )
{
    wisp_scene scene;
    wisp_error error = { 0 };
    assert_ok( wisp_scene_parse( text, strlen( text ), "scene.yaml", &scene, &error ), error );
    return scene;
}

static void assert_parameter( const tune_parameters* parameters, int k, const char* name, const double* values,
                              int count )
{
    assert_true( k < parameters->count );
    assert_string_equal( parameters->parameters[k].name, name );
    assert_int_equal( parameters->parameters[k].value_count, count );
    for ( int i = 0; i < count; ++i )
    {
        assert_true( (float)parameters->parameters[k].values[i] == (float)values[i] );
    }
}

TEST( a_scene_of_cloth_has_its_parameters_with_its_own_values_among_them )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = parse( cloths );
    tune_parameters parameters;
    assert_int_equal( tune_parameters_find( &scene, &parameters, NULL ), WISP_OK );
    assert_int_equal( parameters.count, 4 );
    assert_parameter( &parameters, 0, "substeps", ( const double[] ){ 1, 2, 4, 8, 12, 16 }, 6 );
    assert_parameter( &parameters, 1, "iterations", ( const double[] ){ 1, 2, 4 }, 3 );
    assert_parameter( &parameters, 2, "cloth.tethers", ( const double[] ){ 1, 0 }, 2 );
    assert_parameter( &parameters, 3, "cloth.coarse_substeps", ( const double[] ){ 1, 2, 3, 0 }, 4 );
    assert_true( parameters.parameters[2].is_unordered && parameters.parameters[3].is_unordered );
    assert_false( parameters.parameters[0].is_unordered || parameters.parameters[1].is_unordered );
}

TEST( a_scene_of_implicit_cloth_has_other_parameters )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = parse( implicit );
    tune_parameters parameters;
    assert_int_equal( tune_parameters_find( &scene, &parameters, NULL ), WISP_OK );
    assert_int_equal( parameters.count, 3 );
    assert_parameter( &parameters, 1, "implicit.tolerance", ( const double[] ){ 0.1, 0.01, 0.003, 0.001, 0.0001 },
                      5 );
    assert_parameter( &parameters, 2, "implicit.newton_iterations", ( const double[] ){ 1, 2, 3, 4 }, 4 );
}

TEST( strands_with_the_direct_solve_have_their_passes )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = parse( strands );
    tune_parameters parameters;
    assert_int_equal( tune_parameters_find( &scene, &parameters, NULL ), WISP_OK );
    assert_int_equal( parameters.count, 3 );
    assert_parameter( &parameters, 2, "dynamics.stretch_passes", ( const double[] ){ 1, 2, 5, 8 }, 4 );
    assert_false( parameters.parameters[2].is_unordered );
    const int links = scene.strands[1].dynamics.stretch_passes;
    tune_parameters_set( &parameters, ( const int[] ){ 0, 0, 1 }, &scene );
    assert_int_equal( scene.strands[1].dynamics.stretch_passes, links );
    assert_int_equal( scene.strands[2].dynamics.stretch_passes, 2 );
    assert_int_equal( scene.strands[3].dynamics.stretch_passes, 2 );
}

TEST( a_scene_of_everything_keeps_ends_and_its_own_values_and_can_be_searched )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = parse( everything );
    tune_parameters parameters;
    assert_int_equal( tune_parameters_find( &scene, &parameters, NULL ), WISP_OK );
    assert_int_equal( parameters.count, 7 );
    static const double expected[7][3] = { { 1, 3, 16 },           { 1, 3, 4 }, { 1, 1, 0 }, { 1, 3, 0 },
                                           { 0.1, 0.003, 0.0001 }, { 1, 3, 4 }, { 1, 5, 8 } };
    int settings = 1;
    for ( int k = 0; k < 7; ++k )
    {
        const int last = parameters.parameters[k].value_count - 1;
        settings *= last + 1;
        assert_true( parameters.parameters[k].values[0] == expected[k][0] );
        assert_true( parameters.parameters[k].values[last] == expected[k][2] );
        bool has_own = false;
        for ( int i = 0; i <= last; ++i )
        {
            has_own |= (float)parameters.parameters[k].values[i] == (float)expected[k][1];
        }
        assert_true( has_own );
    }
    assert_in_range( settings, TUNE_MAX_SETTINGS / 2, TUNE_MAX_SETTINGS );
}

TEST( a_choice_is_set_on_every_surface_that_has_the_field )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = parse( cloths );
    tune_parameters parameters;
    assert_int_equal( tune_parameters_find( &scene, &parameters, NULL ), WISP_OK );
    tune_parameters_set( &parameters, ( const int[] ){ 2, 1, 1, 3 }, &scene );
    assert_int_equal( scene.substeps, 4 );
    assert_int_equal( scene.iterations, 2 );
    for ( int i = 0; i < 4; ++i )
    {
        assert_false( scene.surfaces[i].cloth.tethers );
        assert_int_equal( scene.surfaces[i].cloth.coarse_substeps, 0 );
    }
    tune_parameters_set( &parameters, ( const int[] ){ 2, 1, 0, 1 }, &scene );
    for ( int i = 0; i < 4; ++i )
    {
        assert_int_equal( scene.surfaces[i].cloth.tethers, i % 2 == 0 ); // others hang from nothing
        assert_int_equal( scene.surfaces[i].cloth.coarse_substeps, 2 );
    }
    wisp_scene_release( &scene );

    scene = parse( implicit );
    assert_int_equal( tune_parameters_find( &scene, &parameters, NULL ), WISP_OK );
    tune_parameters_set( &parameters, ( const int[] ){ 0, 1, 3 }, &scene );
    for ( int i = 0; i < 2; ++i )
    {
        assert_true( scene.surfaces[i].implicit.tolerance == 0.01f );
        assert_int_equal( scene.surfaces[i].implicit.newton_iterations, 4 );
    }
}

// ---- the file ----

static void assert_edits( const char* text, const int* configuration, const wisp_scene_edit* expected,
                          int expected_count )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = parse( text );
    tune_parameters parameters;
    wisp_scene_edit* edits;
    int count;
    assert_int_equal( tune_parameters_find( &scene, &parameters, NULL ), WISP_OK );
    assert_int_equal( tune_parameters_edits( &parameters, configuration, &scene, &edits, &count, NULL ), WISP_OK );
    assert_int_equal( count, expected_count );
    for ( int i = 0; i < count; ++i )
    {
        assert_string_equal( edits[i].key, expected[i].key );
        assert_string_equal( edits[i].value, expected[i].value );
        assert_int_equal( edits[i].index, expected[i].index );
        assert_string_equal( edits[i].list ? edits[i].list : "", expected[i].list ? expected[i].list : "" );
        assert_string_equal( edits[i].block ? edits[i].block : "", expected[i].block ? expected[i].block : "" );
    }
    free( edits );
    assert_int_equal( tune_parameters_agree( &parameters, configuration, &scene ), count == 0 );
    tune_parameters_set( &parameters, configuration, &scene );
    assert_true( tune_parameters_agree( &parameters, configuration, &scene ) );
}

TEST( only_what_differs_is_edited )
{
    static const wisp_scene_edit of_cloths[] = {
        { NULL, 0, NULL, "substeps", "1" },
        { "surfaces", 0, "cloth", "tethers", "false" },
        { "surfaces", 1, "cloth", "coarse_substeps", "3" },
        { "surfaces", 2, "cloth", "coarse_substeps", "3" },
        { "surfaces", 3, "cloth", "coarse_substeps", "3" },
    };
    assert_edits( cloths, ( const int[] ){ 0, 0, 1, 2 }, of_cloths, WISP_COUNT( of_cloths ) );
    static const wisp_scene_edit of_strands[] = { { "strands", 3, "dynamics", "stretch_passes", "5" } };
    assert_edits( strands, ( const int[] ){ 0, 0, 2 }, of_strands, WISP_COUNT( of_strands ) );
}

TEST( coarse_sheets_that_are_off_are_so_in_the_file )
{
    static const wisp_scene_edit expected[] = {
        { NULL, 0, NULL, "substeps", "1" },
        { "surfaces", 2, "cloth", "tethers", "true" },
        { "surfaces", 0, "cloth", "coarse_substeps", "0" },
        { "surfaces", 1, "cloth", "coarse_substeps", "0" },
        { "surfaces", 2, "cloth", "coarse_substeps", "0" },
        { "surfaces", 3, "cloth", "coarse_substeps", "0" },
    };
    assert_edits( cloths, ( const int[] ){ 0, 0, 0, 3 }, expected, WISP_COUNT( expected ) );
}

/// Write a configuration of one parameter, the others at their first value, and read it back. @param out receives the
/// file
static void write_choice( const char* text, int parameter, int value, char* out, size_t size )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = parse( text ), written;
    tune_parameters parameters;
    SCOPED( free_local ) wisp_scene_edit* edits;
    int count, configuration[TUNE_MAX_PARAMETERS] = { 0 };
    wisp_error error = { 0 };
    assert_int_equal( tune_parameters_find( &scene, &parameters, NULL ), WISP_OK );
    configuration[parameter] = value;
    assert_int_equal( tune_parameters_edits( &parameters, configuration, &scene, &edits, &count, NULL ), WISP_OK );
    write_text( "tune_parameters_from.yaml", text );
    assert_ok( wisp_scene_edit_file( "tune_parameters_from.yaml", edits, count, "tune_parameters_to.yaml", &error ),
               error );
    assert_ok( wisp_scene_read( "tune_parameters_to.yaml", &written, &error ), error );
    assert_true( tune_parameters_agree( &parameters, configuration, &written ) );
    read_text( "tune_parameters_to.yaml", out, size );
    remove( "tune_parameters_from.yaml" );
    remove( "tune_parameters_to.yaml" );
}

TEST( whatever_coarse_substeps_are_chosen_the_file_can_say_it )
{
    char text[2000], expected[80];
    for ( int value = 0; value < 4; ++value )
    {
        write_choice( cloths, 3, value, text, sizeof text );
        snprintf( expected, sizeof expected, "      coarse_substeps: %d # of mine\n", ( value + 1 ) % 4 );
        assert_non_null( strstr( text, expected ) );
    }
}

// With a block of contact and without one.
TEST( whatever_level_of_contact_is_chosen_the_file_can_say_it )
{
    static const char sheet[] = "surfaces:\n  - name: a\n" MAKE "    contact: {}\n    cloth: { solver: pbd }\n";
    static const char* const blocks[] = { "wisp: 1\n", "wisp: 1\ncontact: { margin: 0.5 }\n" };
    static const char* const levels[] = { "level: triangles", "level: spheres" };
    for ( int i = 0; i < 4; ++i )
    {
        char scene[400], text[800];
        snprintf( scene, sizeof scene, "%s%s", blocks[i / 2], sheet );
        write_choice( scene, 2, i % 2, text, sizeof text );
        assert_non_null( strstr( text, levels[i % 2] ) );
    }
}

TEST( cloth_by_pbd_has_no_coarse_substeps_to_tune )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = parse( "wisp: 1\nsurfaces:\n  - name: a\n" MAKE "    cloth: { solver: pbd }\n" );
    tune_parameters parameters;
    assert_int_equal( tune_parameters_find( &scene, &parameters, NULL ), WISP_OK );
    assert_int_equal( parameters.count, 2 );
    assert_string_equal( parameters.parameters[1].name, "iterations" );
    wisp_scene_release( &scene );

    // next to cloth by xpbd, only that is changed
    scene = parse( "wisp: 1\nsurfaces:\n  - name: a\n" MAKE "    cloth: { solver: pbd }\n  - name: b\n" MAKE
                   "    cloth: {}\n" );
    assert_int_equal( tune_parameters_find( &scene, &parameters, NULL ), WISP_OK );
    assert_parameter( &parameters, 2, "cloth.coarse_substeps", ( const double[] ){ 1, 2, 0 }, 3 );
    tune_parameters_set( &parameters, ( const int[] ){ 0, 0, 1 }, &scene );
    assert_int_equal( scene.surfaces[0].cloth.coarse_substeps, 0 );
    assert_int_equal( scene.surfaces[1].cloth.coarse_substeps, 2 );
}

TEST( values_are_reported_as_the_file_has_them )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = parse( cloths );
    tune_parameters parameters;
    char text[32];
    assert_int_equal( tune_parameters_find( &scene, &parameters, NULL ), WISP_OK );
    tune_parameters_text( parameters.fields[3], 0.0, text, sizeof text );
    assert_string_equal( text, "0" );
    tune_parameters_text( parameters.fields[3], 2.0, text, sizeof text );
    assert_string_equal( text, "2" );
    tune_parameters_text( parameters.fields[2], 1.0, text, sizeof text );
    assert_string_equal( text, "true" );
}

TEST( a_scene_where_nothing_moves_has_no_parameters )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = parse( "wisp: 1\n" );
    tune_parameters parameters;
    wisp_error error = { 0 };
    assert_int_equal( tune_parameters_find( &scene, &parameters, &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "scene.yaml: nothing in the scene moves" ) );
}
