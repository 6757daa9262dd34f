// What may be tuned in a scene: which knobs it has, what they turn in memory, and what they change in the file.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "tune_knobs.h"

#include <stdlib.h>
#include <string.h>

#define MAKE "    make: { shape: plane, columns: 3, rows: 3, spacing: 0.1 }\n"

static const char cloths[] = "wisp: 1\n"
                             "substeps: 12\n"
                             "surfaces:\n"
                             "  - name: hanging\n" MAKE "    pins: [0]\n"
                             "    levels: 2\n"
                             "    cloth: { tethers: true, level_passes: 4 }\n"
                             "  - name: falling\n" MAKE "    cloth: {}\n"
                             "  - { name: copy, instance_of: hanging, cloth: {} }\n";

static const char implicit[] = "wisp: 1\n"
                               "surfaces:\n"
                               "  - name: a\n" MAKE "    implicit: { tolerance: 0.003, newton_repeats: 3 }\n"
                               "  - name: b\n" MAKE "    implicit: {}\n";

static wisp_scene parse( const char* text )
{
    wisp_scene scene;
    wisp_error error = { 0 };
    if ( wisp_scene_parse( text, strlen( text ), "scene.yaml", &scene, &error ) != WISP_OK )
    {
        fail_msg( "%s", error.sentence );
    }
    return scene;
}

static void assert_knob( const tune_knobs* knobs, int k, const char* name, const double* values, int count )
{
    assert_true( k < knobs->count );
    assert_string_equal( knobs->knobs[k].name, name );
    assert_int_equal( knobs->knobs[k].value_count, count );
    for ( int i = 0; i < count; ++i )
    {
        assert_true( (float)knobs->knobs[k].values[i] == (float)values[i] );
    }
}

static void a_scene_of_cloth_has_its_knobs_with_its_own_values_among_them( void** state )
{
    (void)state;
    wisp_scene scene = parse( cloths );
    tune_knobs knobs;
    assert_int_equal( tune_knobs_find( &scene, &knobs, NULL ), WISP_OK );
    assert_int_equal( knobs.count, 4 );
    assert_knob( &knobs, 0, "substeps", ( const double[] ){ 1, 2, 4, 8, 12, 16 }, 6 );
    assert_knob( &knobs, 1, "iterations", ( const double[] ){ 1, 2, 4 }, 3 );
    assert_knob( &knobs, 2, "cloth.tethers", ( const double[] ){ 1, 0 }, 2 );
    assert_knob( &knobs, 3, "cloth.level_passes", ( const double[] ){ 4, 0 }, 2 );
    assert_true( knobs.knobs[2].is_unordered && knobs.knobs[3].is_unordered );
    assert_false( knobs.knobs[0].is_unordered || knobs.knobs[1].is_unordered );
    wisp_scene_release( &scene );
}

static void a_scene_of_implicit_cloth_has_other_knobs( void** state )
{
    (void)state;
    wisp_scene scene = parse( implicit );
    tune_knobs knobs;
    assert_int_equal( tune_knobs_find( &scene, &knobs, NULL ), WISP_OK );
    assert_int_equal( knobs.count, 3 );
    assert_knob( &knobs, 1, "implicit.tolerance", ( const double[] ){ 0.1, 0.01, 0.003, 0.001, 0.0001 }, 5 );
    assert_knob( &knobs, 2, "implicit.newton_repeats", ( const double[] ){ 1, 2, 3, 4 }, 4 );
    wisp_scene_release( &scene );
}

static void a_choice_is_set_on_every_surface_that_has_the_field( void** state )
{
    (void)state;
    wisp_scene scene = parse( cloths );
    tune_knobs knobs;
    assert_int_equal( tune_knobs_find( &scene, &knobs, NULL ), WISP_OK );
    tune_knobs_set( &knobs, ( const int[] ){ 2, 1, 1, 1 }, &scene );
    assert_int_equal( scene.substeps, 4 );
    assert_int_equal( scene.iterations, 2 );
    assert_false( scene.surfaces[0].cloth.tethers );
    assert_int_equal( scene.surfaces[0].cloth.level_passes, 0 );
    tune_knobs_set( &knobs, ( const int[] ){ 2, 1, 0, 0 }, &scene );
    assert_true( scene.surfaces[0].cloth.tethers );
    assert_int_equal( scene.surfaces[0].cloth.level_passes, 4 );
    assert_int_equal( scene.surfaces[0].levels, 2 );
    assert_int_equal( scene.surfaces[1].cloth.level_passes, 4 );
    assert_int_equal( scene.surfaces[1].levels, 3 );
    assert_false( scene.surfaces[1].cloth.tethers ); // it hangs by nothing
    assert_int_equal( scene.surfaces[2].cloth.level_passes, 0 );
    wisp_scene_release( &scene );

    scene = parse( implicit );
    assert_int_equal( tune_knobs_find( &scene, &knobs, NULL ), WISP_OK );
    tune_knobs_set( &knobs, ( const int[] ){ 0, 1, 3 }, &scene );
    for ( int i = 0; i < 2; ++i )
    {
        assert_true( scene.surfaces[i].implicit.tolerance == 0.01f );
        assert_int_equal( scene.surfaces[i].implicit.newton_repeats, 4 );
    }
    wisp_scene_release( &scene );
}

static void only_what_differs_is_edited( void** state )
{
    (void)state;
    wisp_scene scene = parse( cloths );
    tune_knobs knobs;
    wisp_scene_edit* edits;
    int count;
    assert_int_equal( tune_knobs_find( &scene, &knobs, NULL ), WISP_OK );
    assert_int_equal( tune_knobs_edits( &knobs, ( const int[] ){ 0, 0, 1, 0 }, &scene, &edits, &count, NULL ),
                      WISP_OK );
    static const wisp_scene_edit expected[] = {
        { NULL, 0, NULL, "substeps", "1" },
        { "surfaces", 0, "cloth", "tethers", "false" },
        { "surfaces", 1, "cloth", "level_passes", "4" },
        { "surfaces", 1, NULL, "levels", "3" },
    };
    assert_int_equal( count, WISP_COUNT( expected ) );
    for ( int i = 0; i < count; ++i )
    {
        assert_string_equal( edits[i].key, expected[i].key );
        assert_string_equal( edits[i].value, expected[i].value );
        assert_int_equal( edits[i].index, expected[i].index );
        assert_true( ( edits[i].list != NULL ) == ( expected[i].list != NULL ) );
        assert_true( ( edits[i].block != NULL ) == ( expected[i].block != NULL ) );
    }
    free( edits );
    assert_false( tune_knobs_agree( &knobs, ( const int[] ){ 0, 0, 1, 0 }, &scene ) );
    tune_knobs_set( &knobs, ( const int[] ){ 0, 0, 1, 0 }, &scene );
    assert_true( tune_knobs_agree( &knobs, ( const int[] ){ 0, 0, 1, 0 }, &scene ) );
    wisp_scene_release( &scene );
}

static void a_scene_where_nothing_moves_has_no_knobs( void** state )
{
    (void)state;
    wisp_scene scene = parse( "wisp: 1\n" );
    tune_knobs knobs;
    wisp_error error = { 0 };
    assert_int_equal( tune_knobs_find( &scene, &knobs, &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.sentence, "scene.yaml: nothing in the scene moves" ) );
    wisp_scene_release( &scene );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_scene_of_cloth_has_its_knobs_with_its_own_values_among_them ),
        cmocka_unit_test( a_scene_of_implicit_cloth_has_other_knobs ),
        cmocka_unit_test( a_choice_is_set_on_every_surface_that_has_the_field ),
        cmocka_unit_test( only_what_differs_is_edited ),
        cmocka_unit_test( a_scene_where_nothing_moves_has_no_knobs ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
