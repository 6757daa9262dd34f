// Cloth that folds on a ball, is crumpled by wind and by its pins, and is hit by a fast ball: no triangle passes
// through another at any sampled step, and contact adds no energy. Intersections are counted exactly. Piles of sheets on a
// floor: bodies win over contact, heavy layers do not crush light ones, and their weight reaches the friction below.
#include "contact_fixture.h"

enum
{
    SUBSTEPS = 10,
    STARTS = 5, // jittered; each must pass
};

typedef struct folding
{
    hosted h;
    wisp_entity cloth, ball;
    int steps;
} folding;

// n x n vertices per metre, level, above a ball that moves back and forth over a plane. @param start jitter of the
// start
static void open_folding( folding* f, int n, int start, bool displacement_limit, bool touches )
{
    *f = ( folding ){ 0 };
    open_contact( &f->h, SUBSTEPS, 1, 1 );
    wisp_world* w = f->h.world;
    const wisp_vec3 off = { test_random_float( start, 1, -0.05f, 0.05f ), test_random_float( start, 2, 0.0f, 0.05f ),
                            test_random_float( start, 3, -0.05f, 0.05f ) };
    test_mesh mesh = level_sheet( n, 1.0f, ( wisp_vec3 ){ off.x, 0.55f + off.y, off.z } );
    f->cloth = add_draping( w, &mesh, NULL, 0, EARTH );
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.radius = 0.15f;
    ball.pose.translation = ( wisp_vec3 ){ 0.05f, 0.3f, 0.02f };
    assert_status( w, wisp_add_collider( w, &ball, &f->ball ), WISP_OK );
    add_floor( w, ( wisp_vec3 ){ 0 }, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    set_collision( w, f->cloth );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.level = displacement_limit ? WISP_CONTACT_EXACT : WISP_CONTACT_TRIANGLES;
    assert_status( w, wisp_set_contact_settings( w, &settings ), WISP_OK );
    const wisp_contact_def def = wisp_default_contact_def();
    if ( touches )
    {
        set_contact( w, f->cloth, &def );
        request_stats( w );
    }
}

static void fold( folding* f, int steps )
{
    for ( int i = 0; i < steps; ++i )
    {
        f->steps += 1;
        const float t = FRAME * (float)f->steps;
        const wisp_transform pose = { { 0.0f, 0.0f, 0.0f, 1.0f },
                                      { 0.05f + 0.15f * sinf( 3.0f * t ), 0.3f, 0.02f + 0.15f * sinf( 2.0f * t ) } };
        assert_status( f->h.world, wisp_move_collider( f->h.world, f->ball, pose ), WISP_OK );
        run_steps( f->h.world, 1, FRAME );
    }
}

TEST( a_folded_cloth_has_not_crossed_itself_after_five_seconds )
{
    folding f;
    open_folding( &f, 33, 0, true, true );
    int pressed = 0;
    for ( int s = 0; s < 60; ++s )
    {
        fold( &f, 5 );
        const wisp_contact_stats stats = contact_stats( f.h.world );
        assert_int_equal( stats.intersections, 0 );
        pressed += stats.contacts > 0 ? 1 : 0;
        if ( s % 12 == 11 )
        {
            assert_int_equal( count_passing( f.h.world, f.cloth, f.cloth ), 0 );
        }
    }
    assert_true( pressed > 10 );
    assert_true( is_finite( f.h.world, f.cloth ) );
    close_world( &f.h );
}

// Without contact something intersects in this scene.
TEST( without_contact_the_same_cloth_crosses_itself )
{
    folding f;
    open_folding( &f, 33, 0, true, false );
    int most = 0;
    for ( int s = 0; s < 12; ++s )
    {
        fold( &f, 10 );
        const int passing = count_passing( f.h.world, f.cloth, f.cloth );
        most = passing > most ? passing : most;
    }
    assert_true( most > 20 );
    close_world( &f.h );
}

TEST( no_jittered_start_crosses )
{
    for ( int start = 1; start <= STARTS; ++start )
    {
        folding f;
        open_folding( &f, 21, start, true, true );
        for ( int s = 0; s < 18; ++s )
        {
            fold( &f, 5 );
            if ( contact_stats( f.h.world ).intersections != 0 )
            {
                fail_msg( "start %d: %d intersections in step %d", start, contact_stats( f.h.world ).intersections,
                          f.steps );
            }
        }
        assert_int_equal( count_passing( f.h.world, f.cloth, f.cloth ), 0 );
        close_world( &f.h );
    }
}

// ---- crumpling ----

// A cloth that hangs by two corners, which are shaken at 2 m/s, while wind pushes it with several times its weight.
static int crumple( int n, int start, bool displacement_limit, int substeps, int steps )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, substeps, 1, 1 );
    test_mesh mesh = hanging_mesh( n, n, 0.6f / (float)( n - 1 ), 0.6f / (float)( n - 1 ) );
    const int32_t pins[2] = { 0, n - 1 };
    const wisp_vec3 corners[2] = { mesh.points[0], mesh.points[n - 1] };
    const wisp_entity e = add_mesh( h.world, &mesh, pins, 2, 0.15f );
    SET( h.world, e, cloth, d.drag_coefficient = 1.0f, d.lift_coefficient = 0.5f,
         d.wind = ( wisp_vec3 ){ 2.0f, 1.0f, 3.5f } );
    assert_status( h.world, wisp_set_gravity( h.world, e, EARTH ), WISP_OK );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.level = displacement_limit ? WISP_CONTACT_EXACT : WISP_CONTACT_TRIANGLES;
    assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
    const wisp_contact_def def = wisp_default_contact_def();
    set_contact( h.world, e, &def );
    request_stats( h.world );
    int most = 0;
    for ( int s = 0; s < steps; ++s )
    {
        const float t = FRAME * (float)( s + 1 );
        wisp_vec3 targets[2];
        for ( int k = 0; k < 2; ++k )
        {
            // the corners move back and forth together, and come close to each other
            const float angle = 9.0f * t + test_random_float( start, 0, 0.0f, 0.5f );
            targets[k] =
                ( wisp_vec3 ){ corners[k].x + ( k == 0 ? 0.12f : -0.12f ) * ( 1.0f - cosf( angle ) ),
                               corners[k].y + 0.1f * sinf( 2.0f * angle ), corners[k].z + 0.2f * sinf( angle ) };
        }
        assert_status( h.world, wisp_move_pins( h.world, e, pins, targets, 2 ), WISP_OK );
        run_steps( h.world, 1, FRAME );
        const int intersections = contact_stats( h.world ).intersections;
        most = intersections > most ? intersections : most;
        if ( s % 30 == 29 )
        {
            assert_int_equal( count_passing( h.world, e, e ), intersections );
        }
    }
    assert_true( is_finite( h.world, e ) );
    return most;
}

TEST( cloth_that_is_crumpled_by_wind_and_shaken_pins_does_not_cross )
{
    for ( int start = 0; start < 3; ++start )
    {
        assert_int_equal( crumple( 21, start, true, SUBSTEPS, 90 ), 0 );
    }
}

// ---- shots ----

// A ball of 0.1 m flies into a sheet that is held along its border. It moves up to 1.7 m per step.
static void shoot( float speed )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, SUBSTEPS, 2, 1 );
    enum
    {
        SIDE = 17,
    };
    test_mesh double_sided = level_sheet( SIDE, 1.0f, ( wisp_vec3 ){ 0 } ),
              ball = ball_of( 2, 0.1f, ( wisp_vec3 ){ 0.03f, 0.5f, 0.02f } );
    int32_t border[4 * SIDE];
    int count = 0;
    for ( int v = 0; v < SIDE * SIDE; ++v )
    {
        const bool is_border = v % SIDE == 0 || v % SIDE == SIDE - 1 || v / SIDE == 0 || v / SIDE == SIDE - 1;
        border[count] = v;
        count += is_border ? 1 : 0;
    }
    const wisp_entity cloth = add_draping( h.world, &double_sided, border, count, ( wisp_vec3 ){ 0 } );
    const wisp_entity shot = add_draping( h.world, &ball, NULL, 0, ( wisp_vec3 ){ 0 } );
    const wisp_contact_def def = wisp_default_contact_def();
    set_contact( h.world, cloth, &def );
    set_contact( h.world, shot, &def );
    request_stats( h.world );
    assert_status( h.world,
                   wisp_set_velocity( h.world, shot, ( wisp_vec3 ){ 0.0f, -speed, 0.0f }, ( wisp_vec3 ){ 0 } ),
                   WISP_OK );
    int pressed = 0;
    for ( int s = 0; s < 60; ++s )
    {
        run_steps( h.world, 1, FRAME );
        const wisp_contact_stats f = contact_stats( h.world );
        assert_int_equal( f.intersections, 0 );
        pressed += f.impulse > 0.0 ? 1 : 0;
        // a sheet that is held along its border is a wall: what is above it without a intersection has not passed
        const double middle = (double)place_of( h.world, cloth, SIDE * SIDE / 2 )[1];
        assert_true( mean_of( h.world, shot, 1 ) > middle );
    }
    assert_true( pressed > 0 );
    const wisp_entity both[2] = { cloth, shot };
    assert_int_equal( count_all_passing( h.world, both, 2 ), 0 );
}

TEST( what_is_fast_does_not_pass_through )
{
    static const float SPEEDS[] = { 5.0f, 30.0f, 100.0f };
    for ( int i = 0; i < WISP_COUNT( SPEEDS ); ++i )
    {
        shoot( SPEEDS[i] );
    }
}

// ---- energy ----

typedef struct closed_system
{
    hosted h;
    wisp_entity sheets[2];
} closed_system;

// Two free sheets without gravity that fly at each other with random velocities. Loose particles have only kinetic
// energy, so only contact could add any.
static void open_closed( closed_system* c, int start, bool woven, float friction )
{
    open_contact( &c->h, 4, 2, 1 );
    wisp_world* w = c->h.world;
    for ( int k = 0; k < 2; ++k )
    {
        test_mesh mesh =
            level_sheet( 7, 0.3f, ( wisp_vec3 ){ 0.017f * (float)k, 0.06f * (float)k, 0.011f * (float)k } );
        c->sheets[k] = add_mesh( w, &mesh, NULL, 0, k == 0 ? 0.1f : 0.3f );
        wisp_cloth_def cloth = wisp_default_cloth_def();
        if ( woven )
        {
            assert_status( w, wisp_set_cloth( w, c->sheets[k], &cloth ), WISP_OK );
        }
        wisp_contact_def def = wisp_default_contact_def();
        def.friction = friction;
        def.self = woven; // loose particles are no surface: a triangle may fold within its own plane
        set_contact( w, c->sheets[k], &def );
        for ( int v = 0; v < 49; ++v )
        {
            float* velocity = velocity_of( w, c->sheets[k], v );
            velocity[0] = test_random_float( start, 6 * v + 3 * k, -0.3f, 0.3f );
            velocity[1] = test_random_float( start, 6 * v + 3 * k + 1, -0.3f, 0.3f ) + ( k == 0 ? 1.0f : -1.0f );
            velocity[2] = test_random_float( start, 6 * v + 3 * k + 2, -0.3f, 0.3f );
        }
    }
    request_stats( w );
}

static double start_energy( closed_system* c )
{
    double sum = 0.0;
    for ( int k = 0; k < 2; ++k )
    {
        for ( int v = 0; v < 49; ++v )
        {
            const float* u = velocity_of( c->h.world, c->sheets[k], v );
            const double squared =
                (double)u[0] * (double)u[0] + (double)u[1] * (double)u[1] + (double)u[2] * (double)u[2];
            sum += 0.5 * squared / (double)place_of( c->h.world, c->sheets[k], v )[3];
        }
    }
    return sum;
}

TEST( loose_sheets_never_gain_energy )
{
    for ( int start = 0; start < STARTS; ++start )
    {
        closed_system c;
        open_closed( &c, start, false, start % 2 == 0 ? 0.0f : 0.5f );
        const double first = start_energy( &c );
        double last = first;
        for ( int s = 0; s < 60; ++s )
        {
            run_steps( c.h.world, 1, FRAME / 4.0f );
            const double now = energy_of( c.h.world, c.sheets, 2 );
            // velocities are differences of positions over a substep of a millisecond: 1e-4 m/s of rounding each
            if ( now > last + 2e-4 * first )
            {
                fail_msg( "start %d, step %d: %.9g J after %.9g J", start, s, now, last );
            }
            last = now;
        }
        assert_true( last < 0.9 * first );
        close_world( &c.h );
    }
}

// Links store energy and release it; it was there at the start, and the tolerance is a thousandth of it.
TEST( woven_sheets_never_have_more_energy_than_at_the_start )
{
    for ( int start = 0; start < STARTS; ++start )
    {
        closed_system c;
        open_closed( &c, start, true, start % 2 == 0 ? 0.0f : 0.5f );
        const double first = start_energy( &c );
        for ( int s = 0; s < 60; ++s )
        {
            run_steps( c.h.world, 1, FRAME / 2.0f );
            const double now = energy_of( c.h.world, c.sheets, 2 );
            if ( now > 1.001 * first )
            {
                fail_msg( "start %d, step %d: %.9g J, it had %.9g J", start, s, now, first );
            }
        }
        assert_int_equal( contact_stats( c.h.world ).intersections, 0 );
        close_world( &c.h );
    }
}

// ---- piles ----

enum
{
    SIDE = 9, // vertices of a sheet
    MIDDLE = SIDE * SIDE / 2,
    MAX_SHEETS = 10,
    SECONDS = 3,
};

static const float THICKNESS = 0.01f; // m
static const float SPACING = 0.05f;   // m; sheets keep a quarter of it from the floor

// m, between the middles of two sheets: their turned corners hang over and down.
static const double LEAST_GAP = 0.0095;

typedef struct pile
{
    hosted h;
    wisp_entity sheets[MAX_SHEETS];
    int count;
} pile;

static void add_sheet( pile* p, float density, wisp_vec3 gravity, float friction )
{
    const int number = p->count++;
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( SIDE, SPACING );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        // Meshes that lie on each other vertex by vertex would be a special case.
        const float angle = 0.37f * (float)number, x = mesh.points[v].x - 0.2f, z = mesh.points[v].z - 0.2f;
        mesh.points[v] = ( wisp_vec3 ){ x * cosf( angle ) - z * sinf( angle ), 0.014f + 0.012f * (float)number,
                                        x * sinf( angle ) + z * cosf( angle ) };
    }
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.area_density = density;
    const wisp_entity e = p->sheets[number] = test_surface_of( p->h.world, &fabric, surface );
    const wisp_cloth_def cloth = wisp_default_cloth_def();
    wisp_contact_def contact = contact_of( THICKNESS );
    contact.friction = friction;
    assert_status( p->h.world, wisp_set_cloth( p->h.world, e, &cloth ), WISP_OK );
    assert_status( p->h.world, wisp_set_gravity( p->h.world, e, gravity ), WISP_OK );
    assert_status( p->h.world, wisp_set_damping( p->h.world, e, 0.5f ), WISP_OK );
    assert_status( p->h.world, wisp_request( p->h.world, e, WISP_MOTION_STATS ), WISP_OK );
    set_collision( p->h.world, e );
    assert_status( p->h.world, wisp_request_collision_stats( p->h.world, e, true ), WISP_OK );
    set_contact( p->h.world, e, &contact );
}

// A pile whose layers have these densities, the lowest first. @param slope tangent of the angle of the floor
static void open_pile( pile* p, const float* densities, int count, float slope, float friction, int iterations )
{
    *p = ( pile ){ .count = 0 };
    open_contact( &p->h, 10, iterations, 2 );
    const float along = 9.81f / sqrtf( 1.0f + slope * slope );
    add_floor( p->h.world, ( wisp_vec3 ){ 0, 0, 0 }, ( wisp_vec3 ){ 0, 1, 0 } );
    for ( int i = 0; i < count; ++i )
    {
        add_sheet( p, densities[i], ( wisp_vec3 ){ along * slope, -along, 0 }, friction );
    }
    request_stats( p->h.world );
}

static void run_pile( pile* p, int steps )
{
    for ( int i = 0; i < steps; ++i )
    {
        assert_status( p->h.world, wisp_world_step( p->h.world, FRAME ), WISP_OK );
    }
}

// m, how far the sheet is inside what it keeps from the floor.
static double depth_of( pile* p, int sheet )
{
    wisp_collision_stats stats;
    assert_status( p->h.world, wisp_read_collision_stats( p->h.world, p->sheets[sheet], &stats ), WISP_OK );
    return (double)stats.penetration;
}

TEST( a_heavy_sheet_does_not_push_a_light_one_into_the_floor )
{
    const float ratios[] = { 1.0f, 100.0f, 1e4f };
    for ( int k = 0; k < WISP_COUNT( ratios ); ++k )
    {
        const float densities[] = { 0.1f, 0.1f * ratios[k] };
        pile p;
        open_pile( &p, densities, 2, 0.0f, 0.3f, 1 );
        double deepest = 0.0;
        for ( int i = 0; i < 60 * SECONDS; ++i )
        {
            run_pile( &p, 1 );
            deepest = fmax( deepest, depth_of( &p, 0 ) );
        }
        const double gap = (double)place_of( p.h.world, p.sheets[1], MIDDLE )[1] -
                           (double)place_of( p.h.world, p.sheets[0], MIDDLE )[1];
        const double speed = motion_stats_of( p.h.world, p.sheets[1] ).speed_max;
        if ( !( deepest < 0.1 * (double)THICKNESS && gap > LEAST_GAP && speed < 0.01 ) )
        {
            fail_msg( "ratio %g: %.3g m inside the floor, %.3g m apart, %.3g m/s after %d s", (double)ratios[k],
                      deepest, gap, speed, SECONDS );
        }
        assert_int_equal( contact_stats( p.h.world ).intersections, 0 );
        close_world( &p.h );
    }
}

TEST( ten_sheets_keep_their_thickness )
{
    const float densities[MAX_SHEETS] = { 0.2f, 0.2f, 0.2f, 0.2f, 0.2f, 0.2f, 0.2f, 0.2f, 0.2f, 0.2f };
    pile p;
    open_pile( &p, densities, MAX_SHEETS, 0.0f, 0.3f, 1 );
    run_pile( &p, 60 * SECONDS );
    assert_true( depth_of( &p, 0 ) < 0.1 * (double)THICKNESS );
    for ( int i = 1; i < MAX_SHEETS; ++i )
    {
        assert_true( (double)place_of( p.h.world, p.sheets[i], MIDDLE )[1] -
                         (double)place_of( p.h.world, p.sheets[i - 1], MIDDLE )[1] >
                     LEAST_GAP );
    }
    const wisp_contact_stats stats = contact_stats( p.h.world );
    assert_true( stats.min_gap > 0.8f );
    assert_int_equal( stats.intersections, 0 );
    close_world( &p.h );
}

// The light sheet has friction 0.5 with the floor only under the weight of the heavy one, which pulls it down the slope.
TEST( the_weight_above_holds_the_lowest_layer_on_a_slope )
{
    const float densities[] = { 0.1f, 10.0f };
    for ( int iterations = 1; iterations <= 2; ++iterations )
    {
        pile p;
        open_pile( &p, densities, 2, 0.4f, 0.8f, iterations );
        run_pile( &p, 60 );
        const double before[2] = { mean_of( p.h.world, p.sheets[0], 0 ), mean_of( p.h.world, p.sheets[1], 0 ) };
        run_pile( &p, 150 );
        const double lower = mean_of( p.h.world, p.sheets[0], 0 ) - before[0],
                     upper = mean_of( p.h.world, p.sheets[1], 0 ) - before[1];
        if ( !( fabs( lower ) < 2e-3 && fabs( upper ) < 2e-3 ) )
        {
            fail_msg( "in 2.5 s the lower sheet slid by %.3g m, the upper one by %.3g m", lower, upper );
        }
        close_world( &p.h );
    }
}

// On a slope above the angle of friction of the floor, the pile slides as the law of Coulomb says: a = g (sin - mu cos).
TEST( a_pile_slides_where_friction_is_too_low )
{
    const float densities[] = { 0.1f, 10.0f };
    for ( int iterations = 1; iterations <= 2; ++iterations )
    {
        pile p;
        open_pile( &p, densities, 2, 0.8f, 2.0f, iterations );
        run_pile( &p, 30 );
        const double cosine = 1.0 / sqrt( 1.0 + 0.64 ), start = motion_stats_of( p.h.world, p.sheets[1] ).momentum[0];
        run_pile( &p, 30 );
        const wisp_motion_stats stats = motion_stats_of( p.h.world, p.sheets[1] );
        const double gained = ( stats.momentum[0] - start ) / stats.mass;
        // Between 0.5 and 1 s, with damping of 0.5 1/s.
        const double expected = 9.81 * cosine * ( 0.8 - 0.5 ) * ( exp( -0.25 ) - exp( -0.5 ) ) / 0.5;
        assert_near( gained, expected, 0.05 * expected );
        close_world( &p.h );
    }
}
