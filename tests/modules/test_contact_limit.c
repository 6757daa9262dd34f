// The displacement limit: what is hurled does not pass, and nothing but the limit prevents it.
#include "contact_fixture.h"

#include "contact_state.h"

typedef struct hurled
{
    int intersections; // edges through triangles, largest of all steps
    float min_gap;     // thicknesses, smallest of all steps
} hurled;

// Hurl three tilted sheets onto a plate that is pinned, by a few thicknesses per substep.
static hurled hurl( float speed, bool displacement_limit )
{
    hosted h;
    open_contact( &h, 10, 1, 1 );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.displacement_limit = displacement_limit;
    assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
    const wisp_contact_def def = contact_of( 0.01f );
    wisp_entity all[4];
    for ( int i = 0; i < 4; ++i )
    {
        test_mesh mesh = level_sheet( i == 0 ? 15 : 11, i == 0 ? 0.7f : 0.5f, ( wisp_vec3 ){ 0, 0, 0 } );
        for ( int v = 0; v < mesh.vertex_count && i > 0; ++v )
        {
            const wisp_vec3 p = mesh.points[v];
            const float angle = 0.5f * (float)i;
            mesh.points[v] = ( wisp_vec3 ){ p.x * cosf( angle ), 0.4f * (float)i + p.x * sinf( angle ), p.z };
        }
        all[i] =
            i == 0 ? add_pinned( h.world, &mesh ) : add_draping( h.world, &mesh, NULL, 0, ( wisp_vec3 ){ 0, 0, 0 } );
        set_contact( h.world, all[i], &def );
        if ( i > 0 )
        {
            assert_status( h.world,
                           wisp_set_velocity( h.world, all[i], ( wisp_vec3 ){ 0, -speed, 0 }, ( wisp_vec3 ){ 0 } ),
                           WISP_OK );
        }
    }
    request_stats( h.world );
    hurled out = { 0, INFINITY };
    for ( int i = 0; i < 20; ++i )
    {
        assert_status( h.world, wisp_world_step( h.world, FRAME ), WISP_OK );
        const wisp_contact_stats stats = contact_stats( h.world );
        out.intersections = stats.intersections > out.intersections ? stats.intersections : out.intersections;
        out.min_gap = fminf( out.min_gap, stats.min_gap );
    }
    assert_int_equal( count_all_passing( h.world, all, 4 ), contact_stats( h.world ).intersections );
    close_world( &h );
    return out;
}

// The limit keeps a tenth of the thickness, and there is nothing else that would: without it the sheets pass.
TEST( sheets_hurled_onto_a_plate_need_the_displacement_limit )
{
    const float speeds[] = { 20.0f, 60.0f }; // m/s: 3 and 10 thicknesses per substep
    for ( int k = 0; k < WISP_COUNT( speeds ); ++k )
    {
        const hurled limited = hurl( speeds[k], true ), unlimited = hurl( speeds[k], false );
        assert_int_equal( limited.intersections, 0 );
        if ( !( limited.min_gap >= 0.09f ) || !( unlimited.intersections > 20 ) )
        {
            fail_msg( "%g m/s: with the limit a gap of %.3g thicknesses, without it %d intersections",
                      (double)speeds[k], (double)limited.min_gap, unlimited.intersections );
        }
    }
}

// ---- a cloth that a jump collapsed ----

enum
{
    COLLAPSED_SIDE = 11,
    COLLAPSED_SUBSTEPS = 10,
    MAX_PAIRS_PER_POINT = 64, // in a substep: as many as are found before displacements are shortened
    MAX_TESTS_PER_PAIR = 6,   // of the displacement limit; tests of all pairs in each round would be 7
};

typedef struct work_done
{
    double pairs; // largest mean of a step, per point and substep
    double tests; // of the limit, per pair: of the whole run
} work_done;

// A sheet hangs by a corner that jumps by several times its size, so that all of it is pulled through itself.
static void collapse( hosted* h, wisp_entity* e )
{
    open_contact( h, COLLAPSED_SUBSTEPS, 1, 1 );
    test_mesh mesh = level_sheet( COLLAPSED_SIDE, 0.2f, ( wisp_vec3 ){ 0 } );
    const int32_t pin = 0;
    const wisp_vec3 start = mesh.points[0];
    *e = add_draping( h->world, &mesh, &pin, 1, EARTH );
    const wisp_contact_def def = contact_of( 0.004f );
    set_contact( h->world, *e, &def );
    request_stats( h->world );
    for ( int step = 0; step < 12; ++step )
    {
        const wisp_vec3 target = { start.x + 0.3f * (float)( step % 3 ), 0.3f * (float)( step % 2 ),
                                   start.z - 0.2f * (float)( step % 5 ) };
        assert_status( h->world, wisp_move_pins( h->world, *e, &pin, &target, 1 ), WISP_OK );
        run_steps( h->world, 1, FRAME );
    }
}

// The pairs and tests of one step, of which only the last substep is seen.
static void add_work( wisp_world* world, work_done* work, double* all_pairs, double* all_tests )
{
    contact_state* state;
    assert_status( world, contact_find_state( world, &state ), WISP_OK );
    const double pairs = state->constraints.row_count;
    work->pairs = fmax( work->pairs, pairs / state->contact_mesh.point_count );
    *all_pairs += COLLAPSED_SUBSTEPS * pairs;
    *all_tests += (double)state->limit.tests;
    work->tests = *all_pairs > 0.0 ? *all_tests / *all_pairs : 0.0;
}

TEST( a_cloth_that_a_jump_collapsed_unfolds_and_has_few_pairs )
{
    hosted h;
    wisp_entity e;
    collapse( &h, &e );
    work_done work = { 0 };
    double pairs = 0.0, tests = 0.0;
    for ( int step = 0; step < 180; ++step )
    {
        run_steps( h.world, 1, FRAME );
        add_work( h.world, &work, &pairs, &tests );
    }
    if ( !( work.pairs < MAX_PAIRS_PER_POINT && work.tests < MAX_TESTS_PER_PAIR ) )
    {
        fail_msg( "%g pairs of a point, %g tests of a pair", work.pairs, work.tests );
    }
    assert_true( motion_stats_of( h.world, e ).strain_max < 0.2 );
    assert_int_equal( contact_stats( h.world ).intersections, 0 );
    close_world( &h );
}
