// Balloons that press on each other (not in the balloon paper): no overlap, a flat contact, opposite forces that
// carry the load; on the floor, under cloth, and ten of them at rest in a box.
//
// Criterion of rest: over the last second no centre moves by more than a hundredth of the radius, and the root mean
// square speed (from the kinetic energy) stays below 3 cm/s, a fiftieth of the falling speed. Skins of few iterations
// never come quite to rest, with contact or without.
#include "contact_fixture.h"

static const float RADIUS = 0.15f; // m

enum
{
    SUBSTEPS = 10,
    STARTS = 5, // jittered; each must pass
};

// ---- a pressed pair ----

typedef struct pressed
{
    hosted h;
    wisp_entity b[2];
    double load; // N
} pressed;

// Two balloons whose gravities point at each other along x, in a smooth shaft, because pressed balloons slip aside.
static void open_pressed( pressed* p, int start, float gravity, int level )
{
    *p = ( pressed ){ 0 };
    open_contact( &p->h, SUBSTEPS, 1, 1 );
    for ( int k = 0; k < 2; ++k )
    {
        const float side = k == 0 ? -1.0f : 1.0f, off = start > 0 ? 0.02f * RADIUS : 0.0f;
        test_mesh mesh = ball_of( level, RADIUS,
                                  ( wisp_vec3 ){ side * 1.06f * RADIUS, test_random_float( start, 2 * k, -off, off ),
                                                 test_random_float( start, 2 * k + 1, -off, off ) } );
        p->b[k] = add_balloon( p->h.world, &mesh, ( wisp_vec3 ){ -side * gravity, 0.0f, 0.0f } );
        assert_status( p->h.world, wisp_set_damping( p->h.world, p->b[k], 20.0f ), WISP_OK );
        SET( p->h.world, p->b[k], collision, d.friction_scale = 0.0f, d.thickness = 0.001f );
        wisp_contact_def def = wisp_default_contact_def();
        def.thickness = 0.05f * RADIUS;
        set_contact( p->h.world, p->b[k], &def );
    }
    for ( int k = 0; k < 4; ++k )
    {
        const wisp_vec3 up = { 0.0f, k == 0 ? 1.0f : ( k == 1 ? -1.0f : 0.0f ),
                               k == 2 ? 1.0f : ( k == 3 ? -1.0f : 0.0f ) };
        add_floor( p->h.world, ( wisp_vec3 ){ 0.0f, -1.1f * RADIUS * up.y, -1.1f * RADIUS * up.z }, up );
    }
    request_stats( p->h.world );
}

static double deepest_overlap( wisp_world* world, const wisp_entity b[2] )
{
    double deepest = 0.0;
    for ( int k = 0; k < 2; ++k )
    {
        const int count = wisp_world_fabric( world, b[k] )->vertex_count;
        for ( int v = 0; v < count; ++v )
        {
            deepest = fmax( deepest, depth_inside( world, b[1 - k], place_of( world, b[k], v ) ) );
        }
    }
    return deepest;
}

// Two balls at this distance would intersect in a circle. The patch is the part of a balloon within 0.6 of its radius
// about the line between the centres, on the side of the other.
typedef struct patch
{
    int count;
    double spread, radius; // m, along that line and across it
} patch;

static patch patch_of( wisp_world* world, const wisp_entity b[2] )
{
    double centre[3], along[3], length = 0.0, lower = INFINITY, upper = -INFINITY;
    for ( int k = 0; k < 3; ++k )
    {
        centre[k] = mean_of( world, b[0], k );
        along[k] = mean_of( world, b[1], k ) - centre[k];
        length = hypot( length, along[k] );
    }
    const double ball = cbrt( 3.0 * motion_stats_of( world, b[0] ).volume / ( 4.0 * 3.14159265 ) );
    patch p = { .radius = 0.6 * sqrt( fmax( 0.0, ball * ball - 0.25 * length * length ) ) };
    for ( int v = 0; v < wisp_world_fabric( world, b[0] )->vertex_count; ++v )
    {
        const float* at = place_of( world, b[0], v );
        double height = 0.0, squared = 0.0;
        for ( int k = 0; k < 3; ++k )
        {
            const double d = (double)at[k] - centre[k];
            height += d * along[k] / length;
            squared += d * d;
        }
        if ( height > 0.0 && squared - height * height < p.radius * p.radius )
        {
            p.count += 1;
            lower = fmin( lower, height );
            upper = fmax( upper, height );
        }
    }
    p.spread = upper - lower;
    return p;
}

TEST( a_pressed_pair_is_flat_and_does_not_overlap )
{
    for ( int start = 0; start <= STARTS; ++start )
    {
        pressed p;
        open_pressed( &p, start, 40.0f, 3 );
        for ( int s = 0; s < 9; ++s )
        {
            run_steps( p.h.world, 10, FRAME );
            const wisp_contact_stats f = contact_stats( p.h.world );
            assert_int_equal( f.intersections, 0 );
            assert_true( deepest_overlap( p.h.world, p.b ) <= 0.01 * (double)RADIUS );
        }
        assert_int_equal( count_all_passing( p.h.world, p.b, 2 ), 0 );
        assert_true( (double)contact_stats( p.h.world ).min_gap > 0.98 );
        const patch flat = patch_of( p.h.world, p.b );
        // a patch of several vertices, whose height is at most a third of that of the original cap, and a fiftieth of
        // the radius
        const double cap = flat.radius * flat.radius / ( 2.0 * 1.1 * (double)RADIUS );
        if ( flat.count < 3 || flat.spread > cap / 3.0 || flat.spread > 0.02 * (double)RADIUS )
        {
            fail_msg( "start %d: %d vertices of the patch, %.3g m high and %.3g m wide", start, flat.count,
                      flat.spread, flat.radius );
        }
        close_world( &p.h );
    }
}

TEST( forces_of_a_pressed_pair_are_opposite_and_carry_the_load )
{
    for ( int n = 0; n < 3; ++n )
    {
        pressed p;
        const float gravity = 10.0f * (float)( 1 << n );
        open_pressed( &p, 0, gravity, 3 );
        run_steps( p.h.world, 90, FRAME );
        double sum[2] = { 0 };
        for ( int s = 0; s < 30; ++s )
        {
            run_steps( p.h.world, 1, FRAME );
            double impulse[2][3];
            for ( int k = 0; k < 2; ++k )
            {
                assert_status( p.h.world, wisp_read_contact_impulse( p.h.world, p.b[k], impulse[k] ), WISP_OK );
                sum[k] += impulse[k][0];
            }
            for ( int k = 0; k < 3; ++k )
            {
                // both sums are of the same numbers in the same order
                assert_near( impulse[0][k] + impulse[1][k], 0.0, 1e-12 * fabs( impulse[0][0] ) );
                assert_near( contact_stats( p.h.world ).net_impulse[k], 0.0, 1e-12 * fabs( impulse[0][0] ) );
            }
        }
        const double load = motion_stats_of( p.h.world, p.b[0] ).mass * (double)gravity * 30.0 * (double)FRAME;
        // the residual swinging is the rest
        assert_near( sum[0], -load, 0.01 * load );
        assert_near( sum[1], load, 0.01 * load );
        close_world( &p.h );
    }
}

// After a long time the contact force is constant, without jitter.
TEST( a_balloon_that_rests_on_a_sheet_does_not_tremble )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, SUBSTEPS, 1, 1 );
    test_mesh ball = ball_of( 2, RADIUS, ( wisp_vec3 ){ 0.01f, 1.06f * RADIUS, 0.02f } ),
              double_sided = level_sheet( 11, 1.0f, ( wisp_vec3 ){ 0 } );
    const wisp_entity b = add_balloon( h.world, &ball, EARTH ), e = add_pinned( h.world, &double_sided );
    assert_status( h.world, wisp_set_damping( h.world, b, 20.0f ), WISP_OK );
    wisp_contact_def def = wisp_default_contact_def();
    def.thickness = 0.05f * RADIUS;
    set_contact( h.world, b, &def );
    set_contact( h.world, e, &def );
    request_stats( h.world );
    run_steps( h.world, 300, FRAME ); // it rolls onto a face first
    for ( int s = 0; s < 60; ++s )
    {
        run_steps( h.world, 1, FRAME );
        const wisp_motion_stats q = motion_stats_of( h.world, b );
        double impulse[3];
        assert_status( h.world, wisp_read_contact_impulse( h.world, b, impulse ), WISP_OK );
        // gravity gives 0.16 m/s in a step: all motion is below a hundredth of that
        assert_true( sqrt( 2.0 * q.kinetic_energy / q.mass ) < 0.0016 );
        assert_near( impulse[1], q.mass * 9.81 * (double)FRAME, 0.01 * q.mass * 9.81 * (double)FRAME );
    }
}

// ---- floor and box ----

typedef struct box_of
{
    hosted h;
    wisp_entity b[16];
    int count;
} box_of;

// Balloons above each other in a shaft, none in the middle.
static void open_box( box_of* x, int count, int level, int start, bool walls, int substeps )
{
    *x = ( box_of ){ .count = count };
    open_contact( &x->h, substeps, 1, 1 );
    for ( int k = 0; k < count; ++k )
    {
        const wisp_vec3 centre = {
            walls ? 0.02f * (float)( k % 3 ) - 0.02f + test_random_float( start, 3 * k, -0.01f, 0.01f ) : 0.0f,
            RADIUS * ( 1.3f + 2.3f * (float)k ) + test_random_float( start, 3 * k + 1, 0.0f, 0.01f ),
            walls ? 0.02f * (float)( 7 * k % 5 ) - 0.04f + test_random_float( start, 3 * k + 2, -0.01f, 0.01f ) : 0.0f
        };
        test_mesh mesh = ball_of( level, RADIUS, centre );
        x->b[k] = add_balloon( x->h.world, &mesh, EARTH );
        assert_status( x->h.world, wisp_set_damping( x->h.world, x->b[k], 2.0f ), WISP_OK );
        set_collision( x->h.world, x->b[k] );
        const wisp_contact_def def = wisp_default_contact_def();
        set_contact( x->h.world, x->b[k], &def );
    }
    add_floor( x->h.world, ( wisp_vec3 ){ 0 }, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    for ( int k = 0; k < 4 && walls; ++k )
    {
        const wisp_vec3 up = { k == 0 ? 1.0f : ( k == 1 ? -1.0f : 0.0f ), 0.0f,
                               k == 2 ? 1.0f : ( k == 3 ? -1.0f : 0.0f ) };
        add_floor( x->h.world, ( wisp_vec3 ){ -0.25f * up.x, 0.0f, -0.25f * up.z }, up );
    }
    request_stats( x->h.world );
}

static double speed_of( box_of* x )
{
    double energy = 0.0, mass = 0.0;
    for ( int k = 0; k < x->count; ++k )
    {
        const wisp_motion_stats q = motion_stats_of( x->h.world, x->b[k] );
        energy += q.kinetic_energy;
        mass += q.mass;
    }
    return sqrt( 2.0 * energy / mass );
}

static void assert_nothing_overlaps( box_of* x )
{
    assert_int_equal( contact_stats( x->h.world ).intersections, 0 );
    for ( int k = 0; k < x->count; ++k )
    {
        for ( int l = 0; l < x->count; ++l )
        {
            const float* first = place_of( x->h.world, x->b[k], 0 );
            assert_true( k == l || depth_inside( x->h.world, x->b[l], first ) == 0.0 );
        }
        assert_true( is_finite( x->h.world, x->b[k] ) );
    }
}

TEST( a_balloon_on_a_floor_carries_another )
{
    box_of x;
    open_box( &x, 2, 2, 0, true, SUBSTEPS );
    wisp_collision_def smooth = wisp_default_collision_def();
    smooth.friction_scale = 0.0f; // so that walls carry nothing
    for ( int k = 0; k < 2; ++k )
    {
        assert_status( x.h.world, wisp_set_collision( x.h.world, x.b[k], &smooth ), WISP_OK );
    }
    run_steps( x.h.world, 240, FRAME );
    assert_nothing_overlaps( &x );
    double mean = 0.0;
    for ( int s = 0; s < 30; ++s )
    {
        double impulse[3];
        run_steps( x.h.world, 1, FRAME );
        assert_status( x.h.world, wisp_read_contact_impulse( x.h.world, x.b[1], impulse ), WISP_OK );
        mean += impulse[1] / 30.0;
    }
    const double weight = motion_stats_of( x.h.world, x.b[1] ).mass * 9.81 * (double)FRAME;
    assert_near( mean, weight, 0.02 * weight );
    run_steps( x.h.world, 120, FRAME );
    assert_true( speed_of( &x ) < 0.0015 );
    close_world( &x.h );
}

static void settle_stack( int count, int level, int start, int steps )
{
    box_of x;
    open_box( &x, count, level, start, true, 20 );
    for ( int k = 0; k < count; ++k )
    {
        wisp_balloon_def soft = wisp_default_balloon_def();
        soft.gas_ratio = 1.05f;
        soft.buoyancy = false;
        assert_status( x.h.world, wisp_set_balloon( x.h.world, x.b[k], &soft ), WISP_OK );
    }
    for ( int s = 0; s < steps; s += 30 )
    {
        run_steps( x.h.world, 30, FRAME );
        if ( contact_stats( x.h.world ).intersections != 0 )
        {
            fail_msg( "start %d: %d intersections in step %d", start, contact_stats( x.h.world ).intersections,
                      s + 30 );
        }
    }
    double centre[16][3];
    for ( int k = 0; k < count; ++k )
    {
        memcpy( centre[k], motion_stats_of( x.h.world, x.b[k] ).centre, sizeof( centre[k] ) );
    }
    for ( int s = 0; s < 60; ++s )
    {
        run_steps( x.h.world, 1, FRAME );
        if ( speed_of( &x ) >= 0.02 )
        {
            fail_msg( "start %d: %.3g m/s in step %d", start, speed_of( &x ), steps + s );
        }
    }
    for ( int k = 0; k < count; ++k )
    {
        const wisp_motion_stats q = motion_stats_of( x.h.world, x.b[k] );
        const double off =
            hypot( hypot( q.centre[0] - centre[k][0], q.centre[1] - centre[k][1] ), q.centre[2] - centre[k][2] );
        if ( off > 0.03 * (double)RADIUS )
        {
            fail_msg( "start %d: balloon %d moved by %.3g m", start, k, off );
        }
    }
    assert_nothing_overlaps( &x );
    close_world( &x.h );
}

TEST( a_stack_of_ten_comes_to_rest )
{
    for ( int start = 0; start < STARTS; ++start )
    {
        settle_stack( 10, 2, start, 270 ); // one of them falls into its last place after four seconds
    }
}

// ---- cloth ----

TEST( cloth_that_falls_on_a_balloon_lies_around_it )
{
    for ( int start = 0; start < 2; ++start )
    {
        box_of x;
        open_box( &x, 1, 3, start, false, SUBSTEPS );
        test_mesh double_sided = level_sheet(
            15, 0.5f, ( wisp_vec3 ){ test_random_float( start, 90, -0.02f, 0.02f ), 2.5f * RADIUS, 0.01f } );
        const wisp_entity cloth = add_draping( x.h.world, &double_sided, NULL, 0, EARTH );
        const wisp_contact_def def = wisp_default_contact_def();
        set_contact( x.h.world, cloth, &def );
        set_collision( x.h.world, cloth );
        const wisp_entity both[2] = { x.b[0], cloth };
        for ( int v = 0; v < wisp_world_fabric( x.h.world, x.b[0] )->vertex_count; ++v )
        {
            const bool is_low = place_of( x.h.world, x.b[0], v )[1] < 0.5f * RADIUS; // it would roll away
            assert_status( x.h.world, wisp_pin( x.h.world, x.b[0], &v, is_low ? 1 : 0 ), WISP_OK );
        }
        for ( int s = 0; s < 10; ++s )
        {
            run_steps( x.h.world, 9, FRAME );
            assert_int_equal( contact_stats( x.h.world ).intersections, 0 );
            for ( int v = 0; v < 15 * 15; ++v )
            {
                assert_true( depth_inside( x.h.world, x.b[0], place_of( x.h.world, cloth, v ) ) == 0.0 );
            }
        }
        assert_int_equal( count_all_passing( x.h.world, both, 2 ), 0 );
        // it hangs on the balloon, its border lower than its middle
        assert_true( place_of( x.h.world, cloth, 7 * 15 + 7 )[1] > 1.5f * RADIUS );
        assert_true( mean_of( x.h.world, cloth, 1 ) < (double)place_of( x.h.world, cloth, 7 * 15 + 7 )[1] - 0.05 );
        close_world( &x.h );
    }
}
