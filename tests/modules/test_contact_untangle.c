// Surfaces that start crossed, or are moved through each other by the user, are drawn apart. Intersections are told by pair; what bursts or
// collapses does not pass through itself, and has few pairs. Surfaces that pins drive through each other, lie in one plane or are hurled
// are in tests/claims/untangling.yaml.
#include "contact_fixture.h"
#include "contact_state.h"

// ---- untangle ----

enum
{
    SIDE = 15,
    SUBSTEPS = 10,
};

typedef struct tangle
{
    hosted h;
    wisp_entity c[2];
} tangle;

// A level cloth that is held at its corners, and one that hangs by its upper corners and dips through it.
static void open_tangle( tangle* t, float dip, int start )
{
    *t = ( tangle ){ 0 };
    open_contact( &t->h, SUBSTEPS, 1, 1 );
    for ( int k = 0; k < 2; ++k )
    {
        test_mesh mesh = level_sheet( SIDE, 1.0f, ( wisp_vec3 ){ 0 } );
        for ( int v = 0; v < mesh.vertex_count && k == 1; ++v )
        {
            const wisp_vec3 p = mesh.points[v];
            mesh.points[v] = ( wisp_vec3 ){ 0.9f * p.x + test_random_float( start, 1, -0.02f, 0.02f ),
                                            p.z + 0.5f - dip, test_random_float( start, 2, -0.02f, 0.02f ) };
        }
        const int last = SIDE * SIDE - 1;
        const int32_t corners[4] = { last, last - SIDE + 1, 0, SIDE - 1 };
        t->c[k] = add_draping( t->h.world, &mesh, corners, k == 0 ? 4 : 2, ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f } );
        const wisp_contact_def def = wisp_default_contact_def();
        set_contact( t->h.world, t->c[k], &def );
    }
    request_stats( t->h.world );
}

// Apart at first; then the user moves it through, vertex by vertex, as in a film cut.
TEST( what_the_user_puts_through_is_drawn_apart )
{
    tangle t;
    open_tangle( &t, -0.1f, 0 );
    run_steps( t.h.world, 3, FRAME );
    assert_int_equal( contact_stats( t.h.world ).intersections, 0 );
    float* column = wisp_world_column( t.h.world, t.c[1], WISP_PARTICLE_POSITION, 0 );
    for ( int v = 0; v < SIDE * SIDE; ++v )
    {
        column[4 * v + 1] -= 0.2f;
    }
    run_steps( t.h.world, 1, FRAME );
    assert_true( contact_stats( t.h.world ).intersections > 0 );
    run_steps( t.h.world, 75, FRAME );
    assert_int_equal( contact_stats( t.h.world ).intersections, 0 );
    close_world( &t.h );
}

static int intersections_between( wisp_world* world, wisp_entity a, wisp_entity b )
{
    int count = -1, mirrored = -1;
    assert_status( world, wisp_read_contact_intersections( world, a, b, &count ), WISP_OK );
    assert_status( world, wisp_read_contact_intersections( world, b, a, &mirrored ), WISP_OK );
    assert_int_equal( count, mirrored );
    return count;
}

static wisp_entity add_upright( wisp_world* world, float x )
{
    test_mesh mesh = level_sheet( 5, 0.5f, ( wisp_vec3 ){ 0 } );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        const wisp_vec3 p = mesh.points[v];
        mesh.points[v] = ( wisp_vec3 ){ x, 0.9f * p.x + 0.011f, p.z + 0.013f };
    }
    return add_pinned( world, &mesh );
}

// Each two are told apart, as brute force does. Nothing can part the two pinned sheets, so what they share is not counted.
TEST( intersections_are_told_by_pair )
{
    tangle t;
    open_tangle( &t, 0.1f, 1 );
    test_mesh level = level_sheet( 9, 0.5f, ( wisp_vec3 ){ 0.07f, -0.01f, 0.0f } );
    const wisp_entity all[4] = { t.c[0], t.c[1], add_pinned( t.h.world, &level ), add_upright( t.h.world, 0.2f ) };
    wisp_contact_def def = wisp_default_contact_def();
    def.mask = 0; // these are only looked at
    set_contact( t.h.world, all[2], &def );
    set_contact( t.h.world, all[3], &def );
    run_steps( t.h.world, 1, FRAME );
    assert_true( count_passing( t.h.world, all[2], all[3] ) > 0 );
    int sum = 0;
    for ( int i = 0; i < 4; ++i )
    {
        for ( int k = i; k < 4; ++k )
        {
            const int brute = count_passing( t.h.world, all[i], all[k] ) +
                              ( i == k ? 0 : count_passing( t.h.world, all[k], all[i] ) );
            const int found = intersections_between( t.h.world, all[i], all[k] );
            assert_int_equal( found, i >= 2 ? 0 : brute );
            sum += found;
        }
    }
    assert_true( intersections_between( t.h.world, all[0], all[1] ) > 0 );
    assert_true( intersections_between( t.h.world, all[0], all[3] ) > 0 );
    assert_int_equal( sum, contact_stats( t.h.world ).intersections );
    // what has changed since the step is not told
    int count;
    assert_status( t.h.world, wisp_unset_contact( t.h.world, all[3] ), WISP_OK );
    assert_int_equal( wisp_read_contact_intersections( t.h.world, all[0], all[3], &count ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( t.h.world ), "takes no part" ) );
    assert_int_equal( wisp_read_contact_intersections( t.h.world, all[0], all[1], &count ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( t.h.world ), "have changed" ) );
    assert_status( t.h.world, wisp_request_contact_stats( t.h.world, true, false ), WISP_OK );
    run_steps( t.h.world, 1, FRAME );
    assert_int_equal( wisp_read_contact_intersections( t.h.world, all[0], all[1], &count ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( t.h.world ), "not counted" ) );
    close_world( &t.h );
}

// ---- one plane ----

// ---- the displacement limit ----

typedef struct hurled
{
    int intersections; // edges through triangles, largest of all steps
    float min_gap;     // thicknesses, smallest of all steps
} hurled;

// A thousand clusters of which each overlaps most others are too many pairs: margins halve until the list fits, and the
// displacement limit holds points within them.
TEST( a_sheet_that_bursts_does_not_pass_through_itself )
{
    enum
    {
        BURST_SIDE = 68, // 8 978 triangles, 1 123 clusters
    };
    uint64_t hashes[2];
    for ( int i = 0; i < 2; ++i )
    {
        SCOPED( close_world ) hosted h;
        open_contact( &h, 1, 1, 1 + 2 * i );
        test_mesh mesh = level_sheet( BURST_SIDE, 0.67f, ( wisp_vec3 ){ 0 } );
        const wisp_entity e = add_draping( h.world, &mesh, NULL, 0, ( wisp_vec3 ){ 0 } );
        const wisp_contact_def def = contact_of( 0.004f );
        set_contact( h.world, e, &def );
        request_stats( h.world );
        for ( int v = 0; v < BURST_SIDE * BURST_SIDE; ++v )
        {
            for ( int k = 0; k < 3; ++k )
            {
                velocity_of( h.world, e, v )[k] = test_random_float( v, k, -100.0f, 100.0f );
            }
        }
        run_steps( h.world, 1, FRAME );
        const wisp_contact_stats stats = contact_stats( h.world );
        if ( stats.intersections != 0 || !( stats.min_gap >= 0.09f ) )
        {
            fail_msg( "%d intersections, a gap of %.3g thicknesses", stats.intersections, (double)stats.min_gap );
        }
        hashes[i] = wisp_world_hash( h.world );
    }
    assert_true( hashes[0] == hashes[1] );
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
    double all_pairs, all_tests;
} work_done;

// A sheet and its first row, of which the first points are pins.
typedef struct pinned_sheet
{
    wisp_entity entity;
    int pins;
    wisp_vec3 row[COLLAPSED_SIDE];
} pinned_sheet;

static void hang( hosted* h, pinned_sheet* sheet )
{
    static const int32_t PINS[COLLAPSED_SIDE] = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10 };
    open_contact( h, COLLAPSED_SUBSTEPS, 1, 1 );
    test_mesh mesh = level_sheet( COLLAPSED_SIDE, 0.2f, ( wisp_vec3 ){ 0 } );
    memcpy( sheet->row, mesh.points, sizeof( sheet->row ) );
    sheet->entity = add_draping( h->world, &mesh, PINS, sheet->pins, EARTH );
    const wisp_contact_def def = contact_of( 0.004f );
    set_contact( h->world, sheet->entity, &def );
    request_stats( h->world );
}

static void drag( hosted* h, const pinned_sheet* sheet, wisp_vec3 by )
{
    for ( int32_t pin = 0; pin < sheet->pins; ++pin )
    {
        const wisp_vec3 from = sheet->row[pin], target = { from.x + by.x, from.y + by.y, from.z + by.z };
        assert_status( h->world, wisp_move_pins( h->world, sheet->entity, &pin, &target, 1 ), WISP_OK );
    }
    run_steps( h->world, 1, FRAME );
}

// The pairs and tests of one step, of which only the last substep is seen.
static void add_work( wisp_world* world, work_done* work )
{
    contact_state* state = wisp_world_module_state( world, "contact" );
    const double pairs = state->constraints.row_count;
    work->pairs = fmax( work->pairs, pairs / state->contact_mesh.point_count );
    work->all_pairs += COLLAPSED_SUBSTEPS * pairs;
    work->all_tests += (double)state->limit.tests;
    work->tests = work->all_pairs > 0.0 ? work->all_tests / work->all_pairs : 0.0;
}

TEST( a_cloth_that_a_jump_collapsed_unfolds_and_has_few_pairs )
{
    SCOPED( close_world ) hosted h;
    pinned_sheet sheet = { .pins = 1 };
    hang( &h, &sheet );
    for ( int step = 0; step < 12; ++step ) // by several times its size, so that all of it is pulled through itself
    {
        drag( &h, &sheet,
              ( wisp_vec3 ){ 0.3f * (float)( step % 3 ), 0.3f * (float)( step % 2 ), -0.2f * (float)( step % 5 ) } );
    }
    work_done work = { 0 };
    for ( int step = 0; step < 180; ++step )
    {
        run_steps( h.world, 1, FRAME );
        add_work( h.world, &work );
    }
    if ( !( work.pairs < MAX_PAIRS_PER_POINT && work.tests < MAX_TESTS_PER_PAIR ) )
    {
        fail_msg( "%g pairs of a point, %g tests of a pair", work.pairs, work.tests );
    }
    assert_true( motion_stats_of( h.world, sheet.entity ).strain_max < 0.2 );
    assert_int_equal( contact_stats( h.world ).intersections, 0 );
}

// Where pins go 16 m in each step displacements are cut, and what is near is a pair: rounds that part them lead nowhere.
TEST( a_cloth_that_pins_drag_away_is_limited_in_few_rounds )
{
    SCOPED( close_world ) hosted h;
    pinned_sheet sheet = { .pins = COLLAPSED_SIDE };
    hang( &h, &sheet );
    work_done work = { 0 };
    for ( int step = 0; step < 12; ++step )
    {
        drag( &h, &sheet, ( wisp_vec3 ){ 16.0f * (float)step, 0.0f, 0.0f } );
        add_work( h.world, &work );
    }
    if ( !( work.tests < MAX_TESTS_PER_PAIR ) )
    {
        fail_msg( "%g tests of a pair", work.tests );
    }
}
