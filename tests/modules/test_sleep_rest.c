// Sleep: when entities fall asleep, what they forget of how they moved, what snapshots of them hold, the same bits for any
// number of workers, and what is refused. Who wakes whom: the search along an axis finds what a comparison of all pairs
// finds.
#include "saved_world.h"
#include "sleep_fixture.h"
#include "support.h"

#include "world.h"

#include "wisp/module/random.h"

static const float TEN_FRAMES = 10.0f / 60.0f;

// ---- when ----

TEST( what_is_halted_does_not_fall_asleep )
{
    SCOPED( close_world ) hosted h;
    open_stage( &h, 1 );
    const wisp_entity lower = add_sheet( h.world, ( wisp_vec3 ){ 0.0f, 0.02f, 0.0f }, true );
    const wisp_entity upper = add_sheet( h.world, ( wisp_vec3 ){ 0.05f, 0.04f, 0.02f }, false ); // keeps it awake
    const wisp_contact_def contact = contact_of( 0.01f );
    set_contact( h.world, lower, &contact );
    set_contact( h.world, upper, &contact );
    run_steps( h.world, 120, FRAME );
    assert_false( wisp_is_asleep( h.world, lower ) );
    float* velocity = wisp_world_column( h.world, lower, WISP_PARTICLE_VELOCITY, 0 );
    velocity[0] = NAN;
    assert_status( h.world, wisp_remove( h.world, upper ), WISP_OK );
    for ( int i = 0; i < 5; ++i )
    {
        run_steps( h.world, 1, FRAME );
        assert_true( wisp_is_halted( h.world, lower ) );
        assert_false( wisp_is_asleep( h.world, lower ) );
    }
}

// ---- what they forget ----

// Any speed is slow enough: it falls asleep on its way, after ten steps.
static void sleep_on_the_way( wisp_world* world, wisp_entity e )
{
    SET( world, e, sleep, d.max_speed = 1e3f, d.seconds = TEN_FRAMES );
    run_steps( world, 9, FRAME );
    assert_false( wisp_is_asleep( world, e ) );
    run_steps( world, 4, FRAME );
    assert_true( wisp_is_asleep( world, e ) );
}

// What starts at rest falls by g dt^2 / 2 in a step, and by less than g dt^2 in the substeps of one. At 1.6 m/s it would go on by 27 mm.
static const double FROM_REST = 9.81 / 3600.0;

TEST( implicit_cloth_wakes_without_the_velocities_that_it_had )
{
    SCOPED( close_world ) hosted h;
    open_stage( &h, 1 );
    test_mesh mesh = level_sheet( 6, 0.2f, ( wisp_vec3 ){ 0.0f, 3.0f, 0.0f } );
    const wisp_entity sheet = add_mesh( h.world, &mesh, NULL, 0, 0.15f );
    wisp_implicit_cloth_def def = wisp_default_implicit_cloth_def();
    def.integrator = WISP_INTEGRATOR_BDF2;
    def.stretch_stiffness = 1.0f;  // soft enough for it
    def.max_newton_iterations = 1; // no second try of what gains energy
    assert_status( h.world, wisp_set_implicit_cloth( h.world, sheet, &def ), WISP_OK );
    assert_status( h.world, wisp_set_gravity( h.world, sheet, EARTH ), WISP_OK );
    sleep_on_the_way( h.world, sheet );
    const double before = (double)place_of( h.world, sheet, 0 )[1];
    assert_true( before < 2.9 ); // it was fast
    assert_status( h.world, wisp_set_gravity( h.world, sheet, ( wisp_vec3 ){ 0.0f, -9.8f, 0.0f } ), WISP_OK );
    assert_wakes( h.world, sheet );
    const double fallen = before - (double)place_of( h.world, sheet, 0 )[1];
    assert_true( fallen > 0.5 * FROM_REST && fallen < 0.7 * FROM_REST ); // 5 / 8 of it in four substeps of Euler
}

// A strand that starts level and swings down.
static wisp_entity add_strand( wisp_world* world )
{
    const int32_t offsets[] = { 0, 6 };
    wisp_vec3 points[6];
    for ( int i = 0; i < 6; ++i )
    {
        points[i] = ( wisp_vec3 ){ 0.1f * (float)i, 3.0f, 0.0f };
    }
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = 1;
    wisp_entity hair;
    assert_status( world, wisp_add_strands( world, &def, &hair ), WISP_OK );
    SET( world, hair, strand_dynamics, d.integrator = WISP_INTEGRATOR_BDF2, d.bending = WISP_STRAND_BEND_NONE );
    assert_status( world, wisp_request( world, hair, WISP_STRAND_POINTS ), WISP_OK );
    return hair;
}

TEST( hair_wakes_without_the_velocities_that_it_had )
{
    SCOPED( close_world ) hosted h;
    open_stage( &h, 1 );
    const wisp_entity hair = add_strand( h.world );
    sleep_on_the_way( h.world, hair );
    const wisp_vec3 before = ( (const wisp_vec3*)view_of( h.world, hair, WISP_STRAND_POINTS ).data )[5];
    assert_true( before.y < 2.9f );
    assert_status( h.world, wisp_set_strand_gravity( h.world, hair, ( wisp_vec3 ){ 0.0f, -9.8f, 0.0f } ), WISP_OK );
    assert_wakes( h.world, hair );
    const wisp_vec3 after = ( (const wisp_vec3*)view_of( h.world, hair, WISP_STRAND_POINTS ).data )[5];
    assert_true( hypot( (double)( after.x - before.x ), (double)( after.y - before.y ) ) < FROM_REST );
}

// What fails before the step that ends its fall asleep is restored to what the host saw last: without a velocity.
TEST( what_fails_as_it_wakes_is_restored_at_rest )
{
    SCOPED( close_world ) hosted h;
    open_stage( &h, 1 );
    const wisp_entity sheet = add_sheet( h.world, ( wisp_vec3 ){ 0.0f, 3.0f, 0.0f }, false ),
                      hair = add_strand( h.world );
    wisp_sleep_def sleep = wisp_default_sleep_def();
    sleep.max_speed = 1e3f;
    sleep.seconds = TEN_FRAMES;
    assert_status( h.world, wisp_set_sleep( h.world, sheet, &sleep ), WISP_OK );
    assert_status( h.world, wisp_set_sleep( h.world, hair, &sleep ), WISP_OK );
    run_steps( h.world, 10, FRAME );
    assert_true( wisp_is_asleep( h.world, sheet ) && wisp_is_asleep( h.world, hair ) );
    const int rows = wisp_world_strands( h.world, hair )->row_count;
    const struct
    {
        wisp_entity entity;
        float* velocity;
        int count, damaged;
    } failing[] = { { sheet, wisp_world_column( h.world, sheet, WISP_PARTICLE_VELOCITY, 0 ), 4 * SIDE * SIDE, 0 },
                    { hair, wisp_world_column( h.world, hair, WISP_STRAND_VELOCITY, 0 ), rows * 3 * WISP_LANES,
                      3 * 3 * WISP_LANES } };
    for ( int i = 0; i < WISP_COUNT( failing ); ++i )
    {
        failing[i].velocity[failing[i].damaged] = NAN;
    }
    run_steps( h.world, 1, FRAME );
    for ( int i = 0; i < WISP_COUNT( failing ); ++i )
    {
        assert_true( wisp_is_halted( h.world, failing[i].entity ) );
        for ( int k = 0; k < failing[i].count; ++k )
        {
            assert_true( failing[i].velocity[k] == 0.0f );
        }
    }
}

// ---- snapshots ----

TEST( a_snapshot_leaves_the_hash_of_what_sleeps )
{
    bed b;
    open_bed( &b, 1 );
    assert_status( b.world, wisp_set_gravity( b.world, b.sheet, EARTH ), WISP_OK ); // changes nothing
    const uint64_t before = wisp_world_hash( b.world );
    free( save_world( b.world ).bytes );
    assert_true( wisp_world_hash( b.world ) == before );
    close_world( &b.h );
}

// ---- a crowd ----

TEST( a_snapshot_of_sleep_goes_on_in_another_world )
{
    bed a, b;
    open_bed( &a, 1 );
    set_gravity( &a ); // a change that waits for the next step
    saved_world saved = save_world( a.world );
    open_bed( &b, 2 );
    set_velocity( &b );
    run_steps( b.world, 3, FRAME );
    assert_status( b.world, wisp_world_restore( b.world, saved.bytes, saved.size ), WISP_OK );
    free( saved.bytes );
    assert_true( wisp_is_asleep( b.world, b.sheet ) );
    assert_true( wisp_world_hash( a.world ) == wisp_world_hash( b.world ) );
    run_steps( a.world, 5, FRAME );
    run_steps( b.world, 5, FRAME );
    assert_false( wisp_is_asleep( b.world, b.sheet ) );
    assert_true( hash_of( a.world, a.sheet, WISP_SURFACE_POINTS ) ==
                 hash_of( b.world, b.sheet, WISP_SURFACE_POINTS ) );
    close_world( &a.h );
    close_world( &b.h );
}

enum
{
    CROWD = 9,
};

// Sheets that hang from a pin and come to rest one after another. Several have substep loops of their own.
static void run_crowd( int first, int count, int workers, uint64_t hashes[CROWD], int asleep[CROWD] )
{
    SCOPED( close_world ) hosted h;
    open_stage( &h, workers );
    wisp_entity sheets[CROWD];
    for ( int i = first; i < first + count; ++i )
    {
        const int32_t pins[] = { 0, 5 };
        test_mesh mesh = hanging_mesh( 6, 6, 0.05f, 0.05f );
        for ( int v = 0; v < mesh.vertex_count; ++v )
        {
            mesh.points[v].z = 0.02f * (float)( v / 6 ) * (float)( i % 3 );
        }
        sheets[i] = add_draping( h.world, &mesh, pins, 2, EARTH );
        assert_status( h.world, wisp_set_damping( h.world, sheets[i], 2.0f + (float)i ), WISP_OK );
        let_sleep( h.world, sheets[i] );
    }
    run_steps( h.world, 130, FRAME );
    for ( int i = first; i < first + count; ++i )
    {
        hashes[i] = hash_of( h.world, sheets[i], WISP_SURFACE_POINTS );
        asleep[i] = wisp_is_asleep( h.world, sheets[i] ) ? 1 : 0;
    }
}

TEST( a_crowd_of_which_some_sleep_has_the_bits_of_each_alone )
{
    uint64_t alone[CROWD], together[CROWD], with_workers[CROWD];
    int asleep[CROWD], asleep_together[CROWD], sum = 0;
    for ( int i = 0; i < CROWD; ++i )
    {
        run_crowd( i, 1, 1, alone, asleep );
        sum += asleep[i];
    }
    assert_true( sum > 0 && sum < CROWD );
    run_crowd( 0, CROWD, 1, together, asleep_together );
    run_crowd( 0, CROWD, 3, with_workers, asleep_together );
    for ( int i = 0; i < CROWD; ++i )
    {
        assert_int_equal( asleep[i], asleep_together[i] );
        assert_true( alone[i] == together[i] );
        assert_true( alone[i] == with_workers[i] );
    }
}

static uint64_t fall_for( int steps, bool sleeps, int* passes )
{
    SCOPED( close_world ) hosted h;
    open_stage( &h, 1 );
    const wisp_entity e = add_sheet( h.world, ( wisp_vec3 ){ 0.0f, 0.3f, 0.0f }, sleeps );
    run_steps( h.world, steps, FRAME );
    assert_false( wisp_is_asleep( h.world, e ) );
    const uint64_t hash = hash_of( h.world, e, WISP_SURFACE_POINTS );
    *passes = wisp_world_plan_passes( h.world );
    return hash;
}

TEST( what_never_sleeps_has_the_same_bits_and_one_pass_more )
{
    int with, without;
    assert_true( fall_for( 40, true, &with ) == fall_for( 40, false, &without ) );
    assert_int_equal( with, without + 1 );
}

TEST( what_cannot_sleep_is_refused )
{
    bed b;
    open_bed( &b, 1 );
    const uint64_t before = wisp_world_hash( b.world );
    wisp_sleep_def def = wisp_default_sleep_def();
    expect_refusal( b.world, wisp_set_sleep( b.world, b.ball, &def ), WISP_CONFLICT, "is neither a surface nor" );
    assert_true( wisp_is_asleep( b.world, b.sheet ) );
    assert_true( wisp_world_hash( b.world ) == before );
    assert_false( wisp_is_asleep( b.world, ( wisp_entity ){ 99, 1 } ) );
    assert_false( wisp_is_asleep( NULL, b.sheet ) );
    close_world( &b.h );
}

// ---- who wakes whom ----

enum
{
    MOST = 400,
};

static float pair_reach( const sleep_box* a, const sleep_box* b )
{
    float longest = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        longest = fmaxf( longest, a->bounds.upper[k] - a->bounds.lower[k] );
    }
    return a->reach + b->reach + 1e-3f * longest;
}

// All pairs, over and over.
static void stir_slowly( sleep_box* boxes, int count )
{
    for ( bool changed = true; changed; )
    {
        changed = false;
        for ( int i = 0; i < count; ++i )
        {
            for ( int k = 0; k < count && boxes[i].is_still && boxes[i].reach >= 0.0f; ++k )
            {
                const bool stirs =
                    boxes[k].is_still == false && boxes[k].reach >= 0.0f &&
                    wisp_bounds_touch( &boxes[i].bounds, &boxes[k].bounds, pair_reach( boxes + i, boxes + k ) );
                boxes[i].is_still = stirs ? false : boxes[i].is_still;
                changed = changed || stirs;
            }
        }
    }
}

// Boxes of several sizes in a room that is longer along one axis; some act on none, and few are not still.
static void make_boxes( uint64_t seed, int count, float room, sleep_box* out )
{
    const wisp_random_key key = wisp_random_make_key( seed, 0, 0 );
    for ( int i = 0; i < count; ++i )
    {
        float u[9];
        for ( uint32_t k = 0; k < 9; ++k )
        {
            u[k] = wisp_random_unit_float( key, (uint32_t)i, k, 0 );
        }
        out[i].reach = u[6] < 0.1f ? -1.0f : 0.2f * u[6];
        out[i].is_still = u[7] > 0.03f;
        for ( int k = 0; k < 3; ++k )
        {
            const float at = room * u[k] * ( k == (int)( seed % 3 ) ? 10.0f : 1.0f );
            const float size = u[8] > 0.95f ? room : u[3 + k];
            out[i].bounds.lower[k] = at;
            out[i].bounds.upper[k] = i % 7 == 0 ? at : at + size; // some are points
        }
    }
}

TEST( a_search_along_an_axis_stirs_whom_all_pairs_stir )
{
    static sleep_box found[MOST], expected[MOST];
    SCOPED( free_local ) void* room = checked_calloc( sleep_wake_bytes( MOST ), 1 );
    int stirred = 0, left = 0;
    for ( uint64_t seed = 0; seed < 60; ++seed )
    {
        const int count = seed < 3 ? (int)seed : MOST - (int)( 5 * seed );
        make_boxes( seed, count, 4.0f + 0.5f * (float)( seed % 10 ), found );
        memcpy( expected, found, sizeof found );
        sleep_wake_touched( found, count, room );
        const sleep_box* before = expected;
        for ( int i = 0; i < count; ++i )
        {
            stirred += before[i].is_still && !found[i].is_still;
            left += found[i].is_still && found[i].reach >= 0.0f;
        }
        stir_slowly( expected, count );
        for ( int i = 0; i < count; ++i )
        {
            assert_int_equal( found[i].is_still, expected[i].is_still );
        }
    }
    assert_true( stirred > 1000 && left > 1000 );
}

TEST( a_chain_is_stirred_from_its_end_in_any_order )
{
    static sleep_box boxes[MOST];
    SCOPED( free_local ) void* room = checked_calloc( sleep_wake_bytes( MOST ), 1 );
    for ( int way = 0; way < 2; ++way )
    {
        for ( int i = 0; i < MOST; ++i )
        {
            const float at = (float)( way == 0 ? i : MOST - 1 - i );
            boxes[i] = ( sleep_box ){ .bounds = { { at, 0, 0 }, { at + 1.0f, 1, 1 } }, .is_still = i > 0 };
        }
        boxes[MOST - 2].bounds.upper[0] = boxes[MOST - 2].bounds.lower[0] + 0.9f; // a gap on one side
        boxes[MOST - 2].bounds.lower[0] += 0.1f;
        sleep_wake_touched( boxes, MOST, room );
        for ( int i = 0; i < MOST; ++i )
        {
            assert_int_equal( boxes[i].is_still, i >= MOST - 2 );
        }
    }
}
