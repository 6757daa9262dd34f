// Closed rods against closed forms: a ring at rest, in free fall and between two loads, and twisted out of its plane; chains
// that are closed; roots that are free; what is refused.
#include "strand_section_fixture.h"

#include "oracle/strand_oracle.h"

static const float FRAME = 1.0f / 60.0f;
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

static double farthest_from( const rod_world* rod, const wisp_vec3* points )
{
    double most = 0.0;
    for ( int i = 0; i < rod->count; ++i )
    {
        most = fmax( most, vec_distance( rod_point( rod, i ), points[i] ) );
    }
    return most;
}

// ---- against the oracle ----

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

// ---- at rest ----

TEST( a_ring_stays_where_it_is )
{
    for ( int k = 0; k < 2; ++k )
    {
        wisp_vec3 points[RING];
        lay_ring( RING, points );
        wisp_strand_dynamics_def def = ring_def( 1.0f, 1.0f );
        def.rest = k == 0 ? WISP_STRAND_REST_SHAPE : WISP_STRAND_REST_STRAIGHT;
        rod_world rod;
        open_rod( &rod, points, RING, 8, &def );
        strand_steps( rod.s.world, 120, FRAME );
        // rounding leaves it a velocity, which nothing holds
        assert_true( farthest_from( &rod, points ) < ( k == 0 ? 1e-5 : 2e-4 ) );
        close_rod( &rod );
    }
}

// Nothing holds it, so it falls as a body, whatever it is made of.
TEST( a_ring_falls_freely )
{
    enum
    {
        STEPS = 60,
        SUBSTEPS = 8,
    };
    for ( int k = 0; k < 3; ++k )
    {
        wisp_vec3 points[RING];
        lay_ring( RING, points );
        wisp_strand_dynamics_def def = ring_def( 1e-3f, 1e-3f );
        def.rest = k == 0 ? WISP_STRAND_REST_SHAPE : WISP_STRAND_REST_STRAIGHT;
        def.bending = k == 2 ? WISP_STRAND_BEND_NONE : WISP_STRAND_BEND_ROD;
        def.gravity = ( wisp_vec3 ){ 0.0f, -9.81f, 0.0f };
        rod_world rod;
        open_rod( &rod, points, RING, SUBSTEPS, &def );
        assert_int_equal( wisp_request( rod.s.world, rod.e, WISP_MOTION_STATS ), WISP_OK );
        strand_steps( rod.s.world, STEPS, FRAME );
        wisp_motion_stats stats;
        assert_int_equal( wisp_read_motion_stats( rod.s.world, rod.e, &stats ), WISP_OK );
        assert_fraction( stats.mass, 1.0, 1e-5, "mass of a metre, kg" );
        assert_fraction( stats.momentum[1], -9.81 * STEPS * (double)FRAME, 1e-4, "momentum, N s" );
        for ( int i = 0; i < RING; ++i )
        {
            // the sum of substeps by Euler
            points[i].y -= 9.81f * 0.5f * FRAME * FRAME * (float)STEPS * ( (float)STEPS + 1.0f / (float)SUBSTEPS );
        }
        assert_true( farthest_from( &rod, points ) < 2e-3 );
        assert_true( stats.strain_max < 1e-4 );
        assert_int_equal( wisp_world_counter( rod.s.world, WISP_COUNT_STRAND_RESET ), 0 );
        close_rod( &rod );
    }
}

// A crooked loop of uneven segments that is stiffer than can be solved is softened, and flies on in its shape. In free fall nothing
// bends it but its own rounding.
TEST( loops_as_stiff_as_can_be_keep_their_shape )
{
    const float rigidities[] = { 1.0f, 1e4f, 1e12f };
    for ( int k = 0; k < 2 * WISP_COUNT( rigidities ); ++k )
    {
        wisp_vec3 points[RING];
        lay_loop( 24, points );
        if ( k % 2 == 1 ) // a segment of a hundredth behind a long one
        {
            for ( int i = 0; i < 3; ++i )
            {
                float *a = &points[6].x + i, *b = &points[7].x + i;
                *a = 0.01f * *a + 0.99f * *b;
            }
        }
        const float rigidity = rigidities[k / 2];
        wisp_strand_dynamics_def def = ring_def( rigidity, 0.75f * rigidity );
        def.rest = WISP_STRAND_REST_SHAPE;
        rod_world rod;
        open_rod( &rod, points, 24, 4, &def );
        float* velocity = wisp_world_column( rod.s.world, rod.e, WISP_STRAND_VELOCITY, 0 );
        for ( int i = 0; i < 24; ++i )
        {
            velocity[(size_t)( 3 * i ) * WISP_LANES] = 0.01f * sinf( 5.0f * (float)( i % 23 ) );
        }
        strand_steps( rod.s.world, 120, FRAME );
        // it turns by a millimetre or two
        assert_true( farthest_from( &rod, points ) < 0.01 );
        close_rod( &rod );
    }
}

// ---- closed forms ----

// A chain of 1 m that hangs from two of its vertices: two catenaries of half a metre.
TEST( a_closed_chain_hangs_as_two_catenaries )
{
    enum
    {
        COUNT = 65,
    };
    static const int32_t PINS[2] = { 0, 32 };
    wisp_vec3 points[COUNT];
    lay_ring( COUNT, points );
    wisp_strand_dynamics_def def = ring_def( 0.0f, 0.0f );
    def.bending = WISP_STRAND_BEND_NONE;
    def.gravity = ( wisp_vec3 ){ 0.0f, -9.81f, 0.0f };
    def.damping = 3.0f;
    def.pins = PINS;
    def.pin_count = 2;
    rod_world rod;
    open_rod( &rod, points, COUNT, 8, &def );
    strand_steps( rod.s.world, 600, FRAME );
    // sinh( x ) / x = length / span, sag = a ( cosh( x ) - 1 )
    const double span = (double)( points[0].x - points[32].x );
    double x = 3.0;
    for ( int i = 0; i < 50; ++i )
    {
        x -= ( sinh( x ) - 0.5 / span * x ) / ( cosh( x ) - 0.5 / span );
    }
    const double sag = 0.5 * span / x * ( cosh( x ) - 1.0 );
    assert_fraction( -(double)rod_point( &rod, 16 ).y, sag, 2e-3, "sag of one half, m" );
    assert_fraction( -(double)rod_point( &rod, 48 ).y, sag, 2e-3, "sag of the other half, m" );
    assert_true( vec_distance( rod_point( &rod, COUNT - 1 ), rod_point( &rod, 0 ) ) == 0.0 );
    close_rod( &rod );
}

// Hang a ring from its joint, with a weight opposite. @return how far that is below
static double loaded_height( float load )
{
    static const int32_t PINS[1] = { 0 };
    enum
    {
        COUNT = 97,
        BOTTOM = 48,
    };
    wisp_vec3 points[COUNT];
    float masses[COUNT];
    lay_ring( COUNT, points );
    for ( int i = 0; i < COUNT; ++i )
    {
        masses[i] = i == BOTTOM ? 100.0f : 0.02f; // hardly a load beside the weight
        points[i] = ( wisp_vec3 ){ points[i].y, points[i].x, 0.0f };
    }
    wisp_strand_dynamics_def def = ring_def( 1.0f, 1.0f );
    def.rest = WISP_STRAND_REST_SHAPE;
    def.vertex_masses = masses;
    def.gravity = ( wisp_vec3 ){ 0.0f, -0.01f * load, 0.0f };
    def.damping = 6.0f;
    def.pins = PINS;
    def.pin_count = 1;
    rod_world rod;
    open_rod( &rod, points, COUNT, 64, &def );
    strand_steps( rod.s.world, 400, FRAME );
    const double height = (double)rod_point( &rod, 0 ).y - (double)rod_point( &rod, BOTTOM ).y;
    close_rod( &rod );
    return height;
}

// ( pi/4 - 2/pi ) P R^3 / EI (Timoshenko, Strength of Materials) between two opposed forces. The ring turns freely about
// the joint that it hangs from.
TEST( a_ring_between_two_forces_is_drawn_out_as_by_the_closed_form )
{
    const double radius = 0.5 / PI, more = loaded_height( 0.25f ) - loaded_height( 0.0f );
    assert_fraction( more, 0.25 * ( PI / 4.0 - 2.0 / PI ) * pow( radius, 3.0 ), 0.03, "ring drawn out, m" );
}

// How thick a loop is across the plane of its area vector, m.
static double thickness_of( const rod_world* rod )
{
    double area[3] = { 0.0, 0.0, 0.0 }, low = INFINITY, high = -INFINITY;
    for ( int i = 0; i + 1 < rod->count; ++i )
    {
        const wisp_vec3 p = rod_point( rod, i ), q = rod_point( rod, i + 1 );
        area[0] += (double)p.y * (double)q.z - (double)p.z * (double)q.y;
        area[1] += (double)p.z * (double)q.x - (double)p.x * (double)q.z;
        area[2] += (double)p.x * (double)q.y - (double)p.y * (double)q.x;
    }
    const double whole = sqrt( area[0] * area[0] + area[1] * area[1] + area[2] * area[2] );
    for ( int i = 0; i + 1 < rod->count; ++i )
    {
        const wisp_vec3 p = rod_point( rod, i );
        const double height = ( (double)p.x * area[0] + (double)p.y * area[1] + (double)p.z * area[2] ) / whole;
        low = fmin( low, height );
        high = fmax( high, height );
    }
    return high - low;
}

// The thickest that a ring of a straight rod becomes that was twisted by so much before it was joined, and which is a
// millimetre out of its plane at first.
static double out_of_plane( double twist, double twist_rigidity )
{
    wisp_vec3 points[RING];
    lay_ring( RING, points );
    for ( int i = 0; i < RING; ++i )
    {
        points[i].z = 1e-3f * (float)cos( 4.0 * PI * ( i % ( RING - 1 ) ) / ( RING - 1 ) );
    }
    wisp_strand_dynamics_def def = ring_def( 1.0f, (float)twist_rigidity );
    def.closing_twist = (float)twist;
    def.damping = 1.0f;
    rod_world rod;
    open_rod( &rod, points, RING, 32, &def );
    double most = 0.0;
    for ( int i = 0; i < 480; ++i )
    {
        strand_steps( rod.s.world, 1, FRAME );
        most = fmax( most, thickness_of( &rod ) );
    }
    close_rod( &rod );
    return most;
}

// 2 pi sqrt( 3 ) EI / GJ (Michell 1889; Zajac 1962; Goriely 2006). Beyond it the ring folds over to an eight; without contact
// it passes through itself, which takes two turns of twist off.
TEST( a_free_ring_leaves_its_plane_at_the_twist_of_michell )
{
    const double ratios[] = { 1.0, 1.5 }; // GJ / EI
    for ( int i = 0; i < WISP_COUNT( ratios ); ++i )
    {
        const double critical = 2.0 * PI * sqrt( 3.0 ) / ratios[i];
        assert_true( out_of_plane( 0.98 * critical, ratios[i] ) < 0.002 );
        assert_true( out_of_plane( 1.02 * critical, ratios[i] ) > 0.05 );
    }
}

// ---- roots that are free ----

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

// ---- refusals and passes ----

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
