// Moving strands in C: what changes while they move, the hold that is read, far from the origin, closed loops against the oracle,
// and what is refused. What theory says of strands is in tests/claims.
#include "saved_world.h"
#include "strand_section_fixture.h"

#include "oracle/strand_oracle.h"

static const float FRAME = 1.0f / 60.0f;
static const wisp_transform NOWHERE = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };

static wisp_strand_dynamics_def default_def( void )
{
    return undamped_hair();
}

// ---- lengths and shapes ----

// Groups run all their substeps at once; in each step another one of them is timed.
TEST( every_pass_of_strands_has_its_time_in_every_step )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 3, 2, 1 );
    const wisp_strand_dynamics_def def = default_def();
    add_moving( s.world, 160, 20, straight_out, 0.1f, &def );
    for ( int step = 0; step < 4; ++step )
    {
        strand_steps( s.world, 1, FRAME );
        const wisp_profile p = wisp_world_profile( s.world );
        double sum = 0.0;
        for ( int i = 0; i < p.count; ++i )
        {
            assert_true( p.lines[i].items == 0 || p.lines[i].seconds > 0.0 );
            sum += p.lines[i].seconds;
        }
        assert_true( p.count > 4 && sum <= p.seconds * ( 1.0 + 1e-12 ) );
    }
}

TEST( changing_how_strands_move_leaves_them_where_they_are )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 4, 2, 1 );
    wisp_strand_dynamics_def def = default_def();
    const wisp_entity e = add_moving( s.world, 5, 10, straight_out, 0.1f, &def );
    for ( int k = 0; k < 12; ++k )
    {
        wisp_vec3 before[50];
        strand_steps( s.world, 3, FRAME );
        memcpy( before, strand_points( s.world, e ), sizeof( before ) );
        // links for a short step only: what they stretch in a long one would be corrected at once
        def.stretch = k % 2 == 0 ? WISP_STRAND_STRETCH_LINKS : WISP_STRAND_STRETCH_DIRECT;
        def.bending = ( k + 1 ) / 3 % 2 == 0 ? WISP_STRAND_BEND_ROD : WISP_STRAND_BEND_NONE;
        def.rest = (wisp_strand_rest)( k % 2 * 2 );
        def.damping = (float)( k % 2 );
        assert_int_equal( wisp_set_strand_dynamics( s.world, e, &def ), WISP_OK );
        strand_steps( s.world, 1, 1e-5f );
        for ( int v = 0; v < 50; ++v )
        {
            // nothing here is faster than 10 m/s
            assert_true( vec_distance( strand_points( s.world, e )[v], before[v] ) < 1e-4 );
        }
        def.stretch = WISP_STRAND_STRETCH_DIRECT;
        assert_int_equal( wisp_set_strand_dynamics( s.world, e, &def ), WISP_OK );
    }
    assert_false( wisp_is_halted( s.world, e ) );
}

TEST( strands_of_no_and_of_one_vertex_step )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 2, 1, 1 );
    const int ones[] = { 1, 1, 0 }, none = 0;
    const wisp_strand_dynamics_def def = default_def();
    const wisp_strand_grid_def grid = wisp_default_strand_grid_def();
    const wisp_entity e[2] = { add_strands( s.world, ones, 3, straight_out, 0.1f ),
                               add_strands( s.world, &none, 1, straight_out, 0.1f ) };
    for ( int k = 0; k < 2; ++k )
    {
        assert_int_equal( wisp_set_strand_dynamics( s.world, e[k], &def ), WISP_OK );
        assert_int_equal( wisp_set_strand_grid( s.world, e[k], &grid ), WISP_OK );
        assert_int_equal( wisp_request( s.world, e[k], WISP_STRAND_POINTS ), WISP_OK );
        assert_int_equal( wisp_request( s.world, e[k], WISP_MOTION_STATS ), WISP_OK );
    }
    const wisp_transform pose = { NOWHERE.rotation, { 1.0f, 2.0f, 3.0f } };
    assert_int_equal( wisp_move_strand_head( s.world, e[0], pose ), WISP_OK );
    strand_steps( s.world, 2, FRAME );
    assert_true( strand_points( s.world, e[0] )[1].y == 2.0f );
    assert_true( motion_stats_of( s.world, e[1] ).mass == 0.0 );
}

// ---- heads and surfaces ----

TEST( roots_stay_on_the_triangles_of_a_surface_and_remain_when_it_goes )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 2, 1, 1 );
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 5, 0.05f );
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface_def = support_weightless_surface_def();
    const wisp_entity surface = test_surface_of( s.world, &fabric, surface_def );
    const wisp_strand_dynamics_def def = default_def();
    const wisp_entity e = add_moving( s.world, 3, 10, straight_down, 0.1f, &def );
    assert_int_equal( wisp_root_strands( s.world, e, surface ), WISP_OK );
    assert_int_equal( wisp_request( s.world, surface, WISP_SURFACE_POINTS ), WISP_OK );
    assert_int_equal( wisp_set_gravity( s.world, surface, ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f } ), WISP_OK );
    strand_steps( s.world, 10, FRAME );
    const float height = ( (const wisp_vec3*)view_of( s.world, surface, WISP_SURFACE_POINTS ).data )[0].y;
    assert_true( height < -0.01f );
    for ( int k = 0; k < 3; ++k )
    {
        // the surface falls flat, and its weights sum to 1 up to a rounding
        assert_true( fabsf( strand_points( s.world, e )[10 * k].y - height ) < 1e-7f );
    }
    assert_true( plan_says( s.world, "strands.anchors", "item loop" ) );
    assert_int_equal( wisp_move_strand_head( s.world, e, NOWHERE ), WISP_CONFLICT );
    const wisp_vec3 root = strand_points( s.world, e )[10];
    assert_int_equal( wisp_remove( s.world, surface ), WISP_OK );
    strand_steps( s.world, 3, FRAME );
    assert_memory_equal( strand_points( s.world, e ) + 10, &root, sizeof( root ) );
}

TEST( friction_on_the_grid_keeps_momentum_and_takes_relative_motion )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 1, 1, 1 );
    wisp_strand_dynamics_def def = default_def();
    def.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    def.bending = WISP_STRAND_BEND_NONE;
    const wisp_entity e = add_moving( s.world, 2, 2, straight_down, 0.1f, &def );
    wisp_strand_grid_def grid = wisp_default_strand_grid_def();
    grid.friction = 1.0f;
    grid.cell_size = 1.0f;
    assert_int_equal( wisp_set_strand_grid( s.world, e, &grid ), WISP_OK );
    assert_int_equal( wisp_request( s.world, e, WISP_MOTION_STATS ), WISP_OK );
    float* velocity = wisp_world_column( s.world, e, WISP_STRAND_VELOCITY, 0 );
    velocity[3 * WISP_LANES] = 0.01f; // the tip of the first strand, along x
    strand_steps( s.world, 1, 1e-4f );
    const wisp_motion_stats q = motion_stats_of( s.world, e );
    const double mass = 0.5 * 0.1 * 6.5e-6;
    // both tips share the corners of one cell. 1 - (1 - 1)^(60 dt) is 1, so both move with the mean of the momentum
    assert_true( fabs( q.momentum[0] / ( mass * 0.01 ) - 1.0 ) < 1e-3 );
    assert_true( fabs( q.speed_max / 0.005 - 1.0 ) < 1e-2 );
    grid.enabled = false;
    assert_int_equal( wisp_set_strand_grid( s.world, e, &grid ), WISP_OK );
    assert_true( plan_says( s.world, "strands.grid", "absent" ) );
}

// ---- the plan ----

TEST( points_alone_keep_the_whole_chain_in_the_item_loop )
{
    static const char* const LOOP[] = {
        "strands.roots",   "strands.pins",       "strands.damping", "strands.air",
        "strands.predict", "strands.rod_curved", "strands.stretch", "strands.velocity"
    };
    SCOPED( close_world ) hosted s;
    open_strands( &s, 2, 1, 1 );
    wisp_strand_dynamics_def def = default_def();
    const int32_t pin = 3;
    def.pins = &pin;
    def.pin_count = 1;
    def.damping = 1.0f;
    def.drag_coefficient = 1.0f;
    add_moving( s.world, 2, 8, straight_out, 0.1f, &def );
    for ( int i = 0; i < WISP_COUNT( LOOP ); ++i )
    {
        if ( plan_says( s.world, LOOP[i], "item loop" ) == false )
        {
            fail_msg( "%s is not in the item loop", LOOP[i] );
        }
    }
    assert_true( plan_says( s.world, "strands.state_check", "after" ) );
    assert_true( plan_says( s.world, "strands.factor", "before" ) );
}

// ---- soft hair ----

// Straight or wavy hair that sticks out.
static wisp_vec3 wave_out( int strand, int i, int count, float length )
{
    const float t = (float)i / (float)( count - 1 );
    return ( wisp_vec3 ){ length * t, strand == 0 ? 0.0f : 0.002f * sinf( 9.0f * t ), 0.01f * (float)strand };
}

// A wavy hair that sags holds its shape when it is cut to the length that is read, or made of the rigidity; not with a tenth more or less.
static int count_sagging( float length, float rigidity, wisp_strand_hold* hold )
{
    hosted s;
    open_strands( &s, 10, 1, 1 );
    wisp_strand_dynamics_def def = undamped_hair();
    def.bend_rigidity = rigidity;
    const wisp_entity e = add_moving( s.world, 1, 24, wave_out, length, &def );
    strand_steps( s.world, 1, 1.0f / 60.0f );
    assert_int_equal( wisp_read_strand_hold( s.world, e, hold ), WISP_OK );
    close_world( &s );
    return hold->sagging;
}

TEST( the_length_and_the_rigidity_that_hold_are_read )
{
    const float lengths[] = { 0.2f, 0.4f, 1.0f };
    for ( int k = 0; k < WISP_COUNT( lengths ); ++k )
    {
        wisp_strand_hold soft, other;
        assert_int_equal( count_sagging( lengths[k], 8e-9f, &soft ), 1 );
        assert_near( (double)soft.max_length, 0.104, 0.002 );
        assert_int_equal( count_sagging( 0.99f * soft.max_length, 8e-9f, &other ), 0 );
        assert_int_equal( count_sagging( 1.1f * soft.max_length, 8e-9f, &other ), 1 );
        assert_int_equal( count_sagging( lengths[k], 1.01f * soft.bend_rigidity, &other ), 0 );
        assert_int_equal( count_sagging( lengths[k], 0.9f * soft.bend_rigidity, &other ), 1 );
    }
}

// ---- loops ----

static const double PI = 3.14159265358979323846;

enum
{
    RING = 49, // vertices, the last of which is the first
};

// A ring of 1 m in the xy plane around the origin.
static void lay_ring( int count, wisp_vec3* points )
{
    const double step = 2.0 * PI / ( count - 1 ), radius = 0.5 / ( ( count - 1 ) * sin( 0.5 * step ) );
    for ( int i = 0; i < count; ++i )
    {
        const double a = step * ( i % ( count - 1 ) );
        points[i] = ( wisp_vec3 ){ (float)( radius * cos( a ) ), (float)( radius * sin( a ) ), 0.0f };
    }
}

static wisp_strand_dynamics_def ring_def( float bend_rigidity, float twist_rigidity )
{
    wisp_strand_dynamics_def def = rod_def( bend_rigidity, twist_rigidity );
    def.closed = true;
    return def;
}

// A crooked loop of uneven segments.
static void lay_loop( int count, wisp_vec3* points )
{
    for ( int i = 0; i < count; ++i )
    {
        const double a = 2.0 * PI * ( i % ( count - 1 ) + 0.3 * sin( 5.0 * ( i % ( count - 1 ) ) ) ) / ( count - 1 );
        points[i] = ( wisp_vec3 ){ 0.1f * (float)( cos( a ) + 0.15 * cos( 3.0 * a ) ), 0.08f * (float)sin( a ),
                                   0.02f * (float)sin( 2.0 * a + 0.4 ) };
    }
}

// The bound of the tension that a straight rod starts with (modules/strands/rod_factors.c).
static void bound_tension( strand_oracle* strand, double gravity, double dt )
{
    double whole = 0.0;
    for ( int i = 1; i < strand->count; ++i )
    {
        whole += strand->weight[i] > 0.0 ? strand->mass[i] : 0.0;
    }
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const double* w = strand->weight;
        const double a = w[s] > 0.0 ? strand->mass[s] : INFINITY, b = w[s + 1] > 0.0 ? strand->mass[s + 1] : INFINITY;
        const double mass = fmin( a, b ), l = strand->length[s];
        const double rigidity = 0.5 * strand->stiffness[s] * ( ( s > 0 ? strand->length[s - 1] : 0.0 ) + l );
        strand->max_tension[s] = fmin( 4.0 * gravity * whole, 0.125 * mass * l / ( dt * dt ) ) +
                                 fmin( rigidity / ( l * l ), sqrt( 0.02 * rigidity * mass / l ) / dt );
    }
}

typedef struct loop_case
{
    const char* name;
    wisp_strand_bend bending;
    wisp_strand_rest rest;
    float rigidity, twist, damping;
    int count;
    bool pinned;
    double tolerance; // m
} loop_case;

static void make_oracle( strand_oracle* strand, const loop_case* c, const wisp_vec3* points,
                         const wisp_strand_dynamics_def* def, double dt )
{
    double3 wide[RING];
    for ( int i = 0; i < c->count; ++i )
    {
        wide[i] = double3_widen( points[i] );
    }
    assert_true( strand_oracle_shape( strand, wide, c->count ) );
    strand_oracle_weigh( strand, (double)def->line_density, false );
    strand_oracle_stiffen( strand, (double)def->bend_rigidity, (double)def->twist_rigidity, true, 0.0 );
    strand->closed = true;
    c->rest == WISP_STRAND_REST_SHAPE ? strand_oracle_rest_shape( strand ) : strand_oracle_rest_straight( strand );
    strand_oracle_close( strand, (double)c->twist );
    for ( int k = 0; k < def->pin_count; ++k )
    {
        strand_oracle_pin( strand, def->pins[k] );
        strand_oracle_pin( strand, def->pins[k] == 0 ? c->count - 1 : def->pins[k] );
    }
    bound_tension( strand, 9.81, dt );
}

static void run_loop( const loop_case* c )
{
    enum
    {
        SUBSTEPS = 8,
        STEPS = 3,
    };
    static const int32_t PINS[2] = { 0, 5 };
    static strand_oracle strand;
    const double dt = 1.0 / 1920.0;
    wisp_vec3 points[RING];
    lay_loop( c->count, points );
    wisp_strand_dynamics_def def = ring_def( c->rigidity, 0.75f * c->rigidity );
    def.line_density = 1.0f;
    def.rest = c->rest;
    def.bending = c->bending;
    def.bend_damping = c->damping;
    def.closing_twist = c->twist;
    def.gravity = ( wisp_vec3 ){ 0.0f, -9.81f, 0.0f };
    def.stretch_passes = 16;
    def.pins = PINS;
    def.pin_count = c->pinned ? 2 : 0;
    rod_world rod;
    open_rod( &rod, points, c->count, SUBSTEPS, &def );
    make_oracle( &strand, c, points, &def, dt );
    float* velocity = wisp_world_column( rod.s.world, rod.e, WISP_STRAND_VELOCITY, 0 );
    for ( int i = 0; i < c->count; ++i )
    {
        const int at = i % ( c->count - 1 );
        const double scale = strand.weight[i] > 0.0 ? 0.3 : 0.0;
        const wisp_vec3 v = { (float)( scale * sin( 3.0 * at ) ), (float)( scale * cos( 2.0 * at ) ),
                              (float)( scale * sin( 1.0 + at ) ) };
        strand.velocity[i] = double3_widen( v );
        velocity[(size_t)( 3 * i ) * WISP_LANES] = v.x;
        velocity[(size_t)( 3 * i + 1 ) * WISP_LANES] = v.y;
        velocity[(size_t)( 3 * i + 2 ) * WISP_LANES] = v.z;
    }
    strand_oracle_settings settings = strand_oracle_default_settings( dt );
    settings.bending = c->bending == WISP_STRAND_BEND_ROD ? STRAND_ORACLE_BENDING_ROD : STRAND_ORACLE_BENDING_NONE;
    settings.passes = 8;
    settings.bend_damping = (double)c->damping;
    settings.looks_back = true;
    for ( int step = 0; step < STEPS; ++step )
    {
        strand_steps( rod.s.world, 1, (float)( SUBSTEPS * dt ) );
        for ( int k = 0; k < SUBSTEPS; ++k )
        {
            if ( c->rest == WISP_STRAND_REST_SHAPE )
            {
                memset( strand.tension, 0, sizeof( strand.tension ) );
            }
            strand_oracle_substep( &strand, &settings, NULL );
        }
    }
    double most = 0.0;
    for ( int i = 0; i < c->count; ++i )
    {
        most = fmax( most, double3_distance( double3_widen( rod_point( &rod, i ) ), strand.position[i] ) );
    }
    if ( !( most <= c->tolerance ) )
    {
        fail_msg( "%s: %g m from the oracle, tolerated %g m", c->name, most, c->tolerance );
    }
    close_rod( &rod );
}

TEST( loops_go_with_the_oracle )
{
    const loop_case cases[] = {
        { "chain", WISP_STRAND_BEND_NONE, WISP_STRAND_REST_STRAIGHT, 1e-2f, 0.0f, 0.0f, 14, false, 5e-8 },
        { "chain, pinned", WISP_STRAND_BEND_NONE, WISP_STRAND_REST_STRAIGHT, 1e-2f, 0.0f, 0.0f, 14, true, 5e-8 },
        { "triangle", WISP_STRAND_BEND_ROD, WISP_STRAND_REST_SHAPE, 1e-3f, 0.0f, 0.0f, 4, false, 5e-8 },
        { "shape", WISP_STRAND_BEND_ROD, WISP_STRAND_REST_SHAPE, 1e-3f, 0.0f, 0.0f, 14, false, 5e-8 },
        { "shape, twisted", WISP_STRAND_BEND_ROD, WISP_STRAND_REST_SHAPE, 1e-3f, 3.0f, 0.0f, 14, false, 5e-8 },
        { "shape, damped", WISP_STRAND_BEND_ROD, WISP_STRAND_REST_SHAPE, 1e-3f, 0.0f, 1e-3f, 14, false, 5e-8 },
        { "straight", WISP_STRAND_BEND_ROD, WISP_STRAND_REST_STRAIGHT, 1e-3f, 0.0f, 0.0f, 24, false, 5e-8 },
        { "straight, twisted", WISP_STRAND_BEND_ROD, WISP_STRAND_REST_STRAIGHT, 1e-3f, -4.0f, 0.0f, 24, false, 5e-8 },
        { "straight, pinned", WISP_STRAND_BEND_ROD, WISP_STRAND_REST_STRAIGHT, 1e-3f, 1.0f, 0.0f, 24, true, 5e-8 },
        { "stiff, pinned", WISP_STRAND_BEND_ROD, WISP_STRAND_REST_SHAPE, 0.3f, 0.0f, 0.0f, 14, true, 5e-8 },
    };
    for ( int k = 0; k < WISP_COUNT( cases ); ++k )
    {
        run_loop( cases + k );
    }
}

// A stick that is thrown keeps its momentum and turns about its centre.
TEST( a_stick_with_a_free_root_flies_as_a_body )
{
    enum
    {
        COUNT = 9,
        STEPS = 60,
    };
    wisp_vec3 points[COUNT];
    lay_rod( ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f }, 0.4f, COUNT, points );
    wisp_strand_dynamics_def def = rod_def( 1.0f, 1.0f );
    def.free_roots = true;
    def.gravity = ( wisp_vec3 ){ 0.0f, -9.81f, 0.0f };
    rod_world rod;
    open_rod( &rod, points, COUNT, 16, &def );
    assert_int_equal( wisp_request( rod.s.world, rod.e, WISP_MOTION_STATS ), WISP_OK );
    float* velocity = wisp_world_column( rod.s.world, rod.e, WISP_STRAND_VELOCITY, 0 );
    for ( int i = 0; i < COUNT; ++i )
    {
        velocity[(size_t)( 3 * i + 1 ) * WISP_LANES] = 2.0f * ( points[i].x - 0.2f ); // 2 rad/s
        velocity[(size_t)( 3 * i + 2 ) * WISP_LANES] = 1.0f;
    }
    wisp_motion_stats first, last;
    strand_steps( rod.s.world, 1, FRAME );
    assert_int_equal( wisp_read_motion_stats( rod.s.world, rod.e, &first ), WISP_OK );
    strand_steps( rod.s.world, STEPS - 1, FRAME );
    assert_int_equal( wisp_read_motion_stats( rod.s.world, rod.e, &last ), WISP_OK );
    assert_fraction( last.mass, 0.4, 1e-5, "mass, kg" );
    assert_fraction( last.momentum[1], -9.81 * 0.4 * STEPS * (double)FRAME, 1e-4, "momentum down, N s" );
    assert_fraction( last.momentum[2], 0.4, 1e-4, "momentum forward, N s" );
    assert_fraction( last.angular_momentum[2], first.angular_momentum[2], 0.02, "angular momentum, N m s" );
    assert_fraction( vec_distance( rod_point( &rod, 0 ), rod_point( &rod, COUNT - 1 ) ), 0.4, 1e-4, "length, m" );
    close_rod( &rod );
}

TEST( loops_that_cannot_be_are_refused )
{
    wisp_vec3 points[RING];
    lay_ring( RING, points );
    const wisp_strand_dynamics_def good = ring_def( 1.0f, 1.0f );
    wisp_strand_dynamics_def bad[9] = { good, good, good, good, good, good, good, good, good };
    const char* const words[9] = { "closed with rest sag_free",
                                   "closed needs stretch direct",
                                   "closed needs stretch direct",
                                   "closed needs stretch direct",
                                   "closed needs stretch direct",
                                   "closing_twist needs closed and bending rod",
                                   "closing_twist",
                                   "closing_twist needs closed and bending rod",
                                   "free_roots with rest sag_free" };
    bad[0].rest = WISP_STRAND_REST_SAG_FREE;
    bad[1].stretch = WISP_STRAND_STRETCH_LINKS;
    bad[2].bending = WISP_STRAND_BEND_LINKS;
    bad[3].integrator = WISP_INTEGRATOR_BDF2;
    bad[4].edgewise_rigidity = 2.0f;
    bad[5].closed = false;
    bad[5].closing_twist = 1.0f;
    bad[6].closing_twist = NAN;
    bad[7].closing_twist = 1.0f;
    bad[7].bending = WISP_STRAND_BEND_NONE;
    bad[8].closed = false;
    bad[8].free_roots = true;
    bad[8].rest = WISP_STRAND_REST_SAG_FREE;
    rod_world rod;
    open_rod( &rod, points, RING, 1, &good );
    for ( int i = 0; i < WISP_COUNT( bad ); ++i )
    {
        assert_int_equal( wisp_set_strand_dynamics( rod.s.world, rod.e, bad + i ), WISP_BAD_INPUT );
        if ( strstr( wisp_world_message( rod.s.world ), words[i] ) == NULL )
        {
            fail_msg( "%d: %s", i, wisp_world_message( rod.s.world ) );
        }
    }
    assert_int_equal( wisp_hold_strand_tip( rod.s.world, rod.e, 0, WISP_STRAND_TIP_PINNED ), WISP_CONFLICT );
    strand_steps( rod.s.world, 1, FRAME );
    close_rod( &rod );

    points[RING - 1].x += 0.1f; // its ends are apart
    wisp_strand_dynamics_def open = good;
    open.closed = false;
    open_rod( &rod, points, RING, 1, &open );
    assert_int_equal( wisp_set_strand_dynamics( rod.s.world, rod.e, &good ), WISP_BAD_INPUT );
    assert_string_equal(
        wisp_world_message( rod.s.world ),
        "strands: strand 0 is no loop, closed needs at least four vertices and the last on the first" );
    hold_tip( &rod, WISP_STRAND_TIP_PINNED );
    open.free_roots = true;
    assert_int_equal( wisp_set_strand_dynamics( rod.s.world, rod.e, &open ), WISP_CONFLICT );
    strand_steps( rod.s.world, 1, FRAME );
    close_rod( &rod );
}

// ---- invalid states ----

TEST( wrong_definitions_are_refused_and_change_nothing )
{
    SCOPED( close_world ) hosted s;
    open_strands( &s, 1, 1, 1 );
    const wisp_strand_dynamics_def good = default_def();
    const wisp_entity e = add_moving( s.world, 2, 5, straight_out, 0.1f, &good );
    strand_steps( s.world, 1, FRAME );
    const uint64_t hash = wisp_world_hash( s.world );
    wisp_strand_dynamics_def bad[2] = { good, good };
    const int32_t pin = 10;
    float masses[10] = { 1e-6f };
    bad[0].pins = &pin;
    bad[0].pin_count = 1;
    bad[1].vertex_masses = masses;
    static const char* const NAMED[2] = { "pin 0 is vertex 10", "mass of vertex 1" };
    for ( int i = 0; i < WISP_COUNT( bad ); ++i )
    {
        assert_int_equal( wisp_set_strand_dynamics( s.world, e, bad + i ), WISP_BAD_INPUT );
        assert_non_null( strstr( wisp_world_message( s.world ), NAMED[i] ) );
    }
    float tension[10];
    assert_int_equal( wisp_set_strand_wind( s.world, e, ( wisp_vec3 ){ NAN, 0.0f, 0.0f } ), WISP_BAD_INPUT );
    assert_int_equal( wisp_root_strands( s.world, e, e ), WISP_CONFLICT );
    assert_int_equal( wisp_move_strand_head( s.world, e, ( wisp_transform ){ { 0, 0, 0, 1 }, { NAN, 0, 0 } } ),
                      WISP_BAD_INPUT );
    assert_true( wisp_world_hash( s.world ) == hash );
    const int count = 3;
    const wisp_entity still = add_strands( s.world, &count, 1, straight_out, 0.1f );
    assert_int_equal( wisp_read_strand_tension( s.world, still, tension ), WISP_CONFLICT );
}

TEST( a_nan_in_one_position_halts_that_entity_alone )
{
    uint64_t hashes[2][4];
    for ( int k = 0; k < 2; ++k )
    {
        SCOPED( close_world ) hosted s;
        open_strands( &s, 4, 1, 1 );
        const wisp_strand_dynamics_def def = undamped_hair();
        // more than one group each
        const wisp_entity sound = add_moving( s.world, 20, 12, straight_out, 0.1f, &def );
        const wisp_entity sick = add_moving( s.world, 20, 12, curl_down, 0.1f, &def );
        strand_steps( s.world, 3, FRAME );
        if ( k == 1 )
        {
            float* position = wisp_world_column( s.world, sick, WISP_STRAND_POSITION, 0 );
            position[5 * 3 * WISP_LANES + 2] = NAN; // x of vertex 5 of the strand in lane 2
        }
        for ( int i = 0; i < 4; ++i )
        {
            strand_steps( s.world, 5, FRAME );
            assert_int_equal( wisp_world_hash_column( s.world, sound, WISP_STRAND_POINTS, &hashes[k][i] ), WISP_OK );
        }
        assert_int_equal( wisp_is_halted( s.world, sick ), k == 1 );
        assert_false( wisp_is_halted( s.world, sound ) );
        assert_int_equal( wisp_world_counter( s.world, WISP_COUNT_HALTED ), k );
        const wisp_vec3* p = strand_points( s.world, sick );
        for ( int v = 0; v < 240; ++v )
        {
            assert_true( isfinite( p[v].x + p[v].y + p[v].z ) );
        }
    }
    assert_memory_equal( hashes[0], hashes[1], sizeof( hashes[0] ) );
}
