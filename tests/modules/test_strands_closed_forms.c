// Strands against closed forms: pendulums, chains, catenaries, rods, air; and independence of the frame rate and of
// the number of vertices.
#include "strands_fixture.h"

static const float FRAME = 1.0f / 60.0f;
static const double GRAVITY = 9.81;

enum
{
    VERTICES_MAX = 96,
    SUBSTEPS = 10, // from here on the direct solve is compared with the closed forms
};

// ---- one strand ----

/// One strand with a shape of its own in a separate world.
typedef struct single
{
    hosted s;
    wisp_entity e;
    int count;
} single;

// A chain or a rod, straight without load; a form changes the fields that it needs.
static wisp_strand_dynamics_def plain_def( wisp_strand_bend bend )
{
    wisp_strand_dynamics_def def = undamped_hair();
    def.bending = bend;
    def.rest = WISP_STRAND_REST_STRAIGHT;
    return def;
}

// Close with close_single().
static void open_single( single* one, const wisp_vec3* points, int count, int substeps,
                         const wisp_strand_dynamics_def* dynamics )
{
    one->count = count;
    const int32_t offsets[2] = { 0, count };
    open_strands( &one->s, substeps, 1, 1 );
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = 1;
    assert_int_equal( wisp_add_strands( one->s.world, &def, &one->e ), WISP_OK );
    if ( wisp_set_strand_dynamics( one->s.world, one->e, dynamics ) != WISP_OK )
    {
        fail_msg( "no dynamics: %s", wisp_world_message( one->s.world ) );
    }
    assert_int_equal( wisp_request( one->s.world, one->e, WISP_STRAND_POINTS ), WISP_OK );
}

static void close_single( single* one )
{
    assert_false( wisp_is_halted( one->s.world, one->e ) );
    close_world( &one->s );
}

static void lay_straight( wisp_vec3 direction, double length, int count, wisp_vec3* points )
{
    for ( int v = 0; v < count; ++v )
    {
        const float along = (float)( length * v / ( count - 1 ) );
        points[v] = ( wisp_vec3 ){ along * direction.x, along * direction.y, along * direction.z };
    }
}

static wisp_vec3 tip_of( const single* one )
{
    return strand_points( one->s.world, one->e )[one->count - 1];
}

// ---- swings ----

/// Times at which a value passes through 0, by linear interpolation between frames, and the largest values between
/// them.
typedef struct intersections
{
    double last, time[3], peak[2];
    int count;
} intersections;

static void feed( intersections* c, int step, double value )
{
    if ( c->count < 3 && step > 0 && ( c->last < 0.0 ) != ( value < 0.0 ) )
    {
        c->time[c->count++] = (double)FRAME * ( step - 1 + c->last / ( c->last - value ) );
    }
    if ( c->count == 1 || c->count == 2 )
    {
        c->peak[c->count - 1] = fmax( c->peak[c->count - 1], fabs( value ) );
    }
    c->last = value;
}

/// Component of a strand that swings about 0; `slope` is the direction of growth, x over y.
typedef double swing_reader( wisp_vec3 tip, double slope );

static double read_angle( wisp_vec3 tip, double slope )
{
    (void)slope;
    return atan2( (double)tip.x, -(double)tip.y );
}

static double read_sideways( wisp_vec3 tip, double slope )
{
    return (double)tip.x - slope * (double)tip.y;
}

// Released, until the value is back at 0 from the same side.
static intersections swing( single* one, const wisp_vec3* start, swing_reader* read, double slope )
{
    intersections c = { 0 };
    feed( &c, 0, read( start[one->count - 1], slope ) );
    for ( int step = 1; step <= 900 && c.count < 3; ++step )
    {
        strand_steps( one->s.world, 1, FRAME );
        feed( &c, step, read( tip_of( one ), slope ) );
    }
    assert_int_equal( c.count, 3 );
    return c;
}

static double period_of( const intersections* c )
{
    return c->time[2] - c->time[0];
}

static const double SWING_LENGTH = 0.2; // m, of a hair

// T = 4 sqrt(L/g) K(sin(a/2)), the complete elliptic integral by the mean of arithmetic and geometric means.
static double pendulum_period( double amplitude )
{
    double a = 1.0, b = cos( 0.5 * amplitude );
    for ( int i = 0; i < 8; ++i )
    {
        const double mean = 0.5 * ( a + b );
        b = sqrt( a * b );
        a = mean;
    }
    return 6.283185307179586 * sqrt( SWING_LENGTH / GRAVITY ) / a;
}

TEST( a_pendulum_has_the_period_of_the_amplitude_it_swings )
{
    static const double DEGREES[] = { 10.0, 30.0, 60.0, 90.0 };
    for ( int i = 0; i < WISP_COUNT( DEGREES ); ++i )
    {
        const double angle = DEGREES[i] * 0.017453292519943295;
        wisp_vec3 points[2];
        lay_straight( ( wisp_vec3 ){ (float)sin( angle ), (float)-cos( angle ), 0.0f }, SWING_LENGTH, 2, points );
        wisp_strand_dynamics_def def = plain_def( WISP_STRAND_BEND_NONE );
        def.vertex_mass = 1.0f;
        single one;
        open_single( &one, points, 2, SUBSTEPS, &def );
        const intersections c = swing( &one, points, read_angle, 0.0 );
        // a swing loses a little of its amplitude, so the period is that of the mean of the two peaks around it
        assert_fraction( period_of( &c ), pendulum_period( 0.5 * ( c.peak[0] + c.peak[1] ) ), 1e-3, "pendulum, s" );
        // and it loses at most a tenth of the amplitude
        assert_true( c.peak[1] > 0.9 * angle && c.peak[0] < 1.001 * angle );
        close_single( &one );
    }
}

// The shape of the slowest mode of n equal masses, largest value 1, by inverse iteration: link i pulls with n - i
// weights, and the sum of the forces below a link is its pull times its slope.
static void chain_mode( int n, double* u )
{
    for ( int i = 0; i < n; ++i )
    {
        u[i] = i + 1.0;
    }
    for ( int iteration = 0; iteration < 60; ++iteration )
    {
        double below = 0.0, slopes[VERTICES_MAX], sum = 0.0;
        for ( int i = n - 1; i >= 0; --i )
        {
            below += u[i];
            slopes[i] = below / ( n - i );
        }
        for ( int i = 0; i < n; ++i )
        {
            sum += slopes[i];
            u[i] = sum;
        }
        for ( int i = 0; i < n; ++i )
        {
            u[i] /= sum;
        }
    }
}

// Vertices at equal distances, displaced sideways from the line that hangs down from the origin.
static void lay_mode( const double* sideways, double amplitude, double segment, int count, wisp_vec3* points )
{
    double x = 0.0, y = 0.0;
    points[0] = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    for ( int v = 1; v < count; ++v )
    {
        const double to = amplitude * sideways[v], dx = to - x;
        y -= sqrt( segment * segment - dx * dx );
        x = to;
        points[v] = ( wisp_vec3 ){ (float)x, (float)y, 0.0f };
    }
}

TEST( hanging_chains_swing_with_the_roots_of_laguerre_polynomials )
{
    static const struct
    {
        int masses;
        double period; // of the slowest mode, in sqrt(L/g)
    } CHAINS[] = { { 2, 5.804906 }, { 10, 5.352609 }, { 32, 5.265950 } };
    for ( int i = 0; i < WISP_COUNT( CHAINS ); ++i )
    {
        const int n = CHAINS[i].masses;
        double mode[VERTICES_MAX] = { 0.0 };
        wisp_vec3 points[VERTICES_MAX];
        chain_mode( n, mode + 1 );
        // a pendulum that swings a fiftieth of its length has a period that is 3e-5 longer
        lay_mode( mode, 0.02 * SWING_LENGTH, SWING_LENGTH / n, n + 1, points );
        wisp_strand_dynamics_def def = plain_def( WISP_STRAND_BEND_NONE );
        def.vertex_mass = 1.0f;
        single one;
        open_single( &one, points, n + 1, SUBSTEPS, &def );
        const intersections c = swing( &one, points, read_sideways, 0.0 );
        assert_fraction( period_of( &c ), CHAINS[i].period * sqrt( SWING_LENGTH / GRAVITY ), 5e-3, "chain, s" );
        close_single( &one );
    }
}

TEST( a_clamped_rod_swings_with_the_frequency_of_a_cantilever )
{
    enum
    {
        COUNT = 64
    };
    const double b = 1.8751040687, sigma = 0.7340955138; // of the first mode
    double mode[COUNT];
    for ( int v = 0; v < COUNT; ++v )
    {
        const double s = b * v / ( COUNT - 1 );
        mode[v] = 0.5 * ( cosh( s ) - cos( s ) - sigma * ( sinh( s ) - sin( s ) ) );
    }
    wisp_vec3 points[COUNT];
    lay_mode( mode, 0.02 * SWING_LENGTH, SWING_LENGTH / ( COUNT - 1 ), COUNT, points );
    wisp_strand_dynamics_def def = plain_def( WISP_STRAND_BEND_ROD );
    // stiff enough for one swing a second: w = b^2 sqrt(EI / (mu L^4))
    const double rate = 6.283185307179586 * SWING_LENGTH * SWING_LENGTH / ( b * b );
    def.bend_rigidity = (float)( (double)def.line_density * rate * rate );
    def.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    single one;
    open_single( &one, points, COUNT, SUBSTEPS, &def );
    // the clamp has the direction of the first segment, about which the tip swings
    const intersections c = swing( &one, points, read_sideways, (double)points[1].x / (double)points[1].y );
    assert_fraction( 1.0 / period_of( &c ), 1.0, 2e-2, "cantilever, Hz" );
    close_single( &one );
}

// ---- at rest ----

TEST( the_tension_of_a_chain_is_the_weight_below )
{
    enum
    {
        COUNT = 20,
        STEPS = 60
    };
    wisp_vec3 points[COUNT];
    lay_straight( ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f }, SWING_LENGTH, COUNT, points );
    wisp_strand_dynamics_def def = plain_def( WISP_STRAND_BEND_NONE );
    def.vertex_mass = 1.0f;
    single one;
    open_single( &one, points, COUNT, SUBSTEPS, &def );
    double sums[COUNT] = { 0.0 };
    for ( int i = 0; i < STEPS; ++i )
    {
        float tension[COUNT];
        strand_steps( one.s.world, 1, FRAME );
        assert_int_equal( wisp_read_strand_tension( one.s.world, one.e, tension ), WISP_OK );
        for ( int v = 0; v < COUNT; ++v )
        {
            // rounding of positions over dt^2 is a force that differs between steps; the mean is not affected
            sums[v] += (double)tension[v] / STEPS;
        }
    }
    for ( int v = 0; v + 1 < COUNT; ++v )
    {
        assert_fraction( sums[v], GRAVITY * ( COUNT - 1 - v ), 1e-3, "tension, N" );
    }
    close_single( &one );
}

// Distance of the tip of a clamped rod from the elastica, in lengths.
static double miss_of_elastica( double load, double drop, double reach, int count )
{
    wisp_vec3 points[VERTICES_MAX];
    lay_straight( ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f }, SWING_LENGTH, count, points );
    wisp_strand_dynamics_def def = plain_def( WISP_STRAND_BEND_ROD );
    const double length_3 = SWING_LENGTH * SWING_LENGTH * SWING_LENGTH;
    def.bend_rigidity = (float)( (double)def.line_density * GRAVITY * length_3 / load );
    def.damping = 6.0f;
    single one;
    open_single( &one, points, count, SUBSTEPS, &def );
    strand_steps( one.s.world, 360, FRAME );
    const double miss =
        hypot( (double)tip_of( &one ).x / SWING_LENGTH - reach, (double)tip_of( &one ).y / SWING_LENGTH + drop );
    close_single( &one );
    return miss;
}

TEST( a_heavy_rod_bends_as_the_elastica )
{
    static const struct
    {
        double load, drop, reach; // G = weight per length L^3 / EI; H / L and W / L
    } FORMS[] = { { 1.0, 0.12347140, 0.99124640 },
                  { 10.0, 0.70019972, 0.65635376 },
                  { 100.0, 0.93752394, 0.15922338 } };
    for ( int i = 0; i < WISP_COUNT( FORMS ); ++i )
    {
        const double coarse = miss_of_elastica( FORMS[i].load, FORMS[i].drop, FORMS[i].reach, 16 );
        const double fine = miss_of_elastica( FORMS[i].load, FORMS[i].drop, FORMS[i].reach, 64 );
        print_message( "           G = %.0f: %.2e of the length with 16 vertices, %.2e with 64\n", FORMS[i].load,
                       coarse, fine );
        assert_true( fine < 1e-3 );
        // second order in segments
        assert_true( fabs( log( coarse / fine ) / log( 63.0 / 15.0 ) - 2.0 ) < 0.2 );
    }
}

// ---- falling heads ----

/// A head that falls from rest for half a second, and the final distance of its strands from their shape.
typedef struct fall
{
    strand_curve* curve;
    wisp_strand_bend bend;
    int rate; // frames per second
    double bound;
} fall;

static double drift_after( const fall* f )
{
    hosted s;
    open_strands( &s, 1, 1, 1 );
    wisp_strand_dynamics_def def = undamped_hair();
    def.bending = f->bend;
    def.rest = WISP_STRAND_REST_SHAPE;
    const wisp_entity e = add_moving( s.world, 5, 20, f->curve, 0.1f, &def );
    const double dt = 1.0 / f->rate;
    double depth = 0.0;
    for ( int step = 1; step <= f->rate / 2; ++step )
    {
        // by the integrator of a vertex: v += dt g, y += dt v
        depth = -0.5 * GRAVITY * dt * dt * step * ( step + 1 );
        const wisp_transform pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, (float)depth, 0.0f } };
        assert_int_equal( wisp_move_strand_head( s.world, e, pose ), WISP_OK );
        strand_steps( s.world, 1, (float)dt );
    }
    double farthest = 0.0;
    for ( int v = 0; v < 100; ++v )
    {
        wisp_vec3 at = f->curve( v / 20, v % 20, 20, 0.1f );
        at.y += (float)depth;
        farthest = fmax( farthest, vec_distance( strand_points( s.world, e )[v], at ) );
    }
    close_world( &s );
    return farthest;
}

TEST( strands_whose_head_falls_freely_keep_their_shape )
{
    // the head's path is rounded to 6e-8 m at 1 m, which remains as a velocity; a curled rod first has the tension of
    // a hanging one, which the length solve removes at an error of first order in the step
    static const fall FALLS[] = { { straight_out, WISP_STRAND_BEND_NONE, 60, 5e-6 },
                                  { straight_out, WISP_STRAND_BEND_ROD, 60, 5e-6 },
                                  { curl_down, WISP_STRAND_BEND_NONE, 60, 5e-6 },
                                  { curl_down, WISP_STRAND_BEND_ROD, 960, 1e-4 } };
    for ( int k = 0; k < WISP_COUNT( FALLS ); ++k )
    {
        const double drift = drift_after( FALLS + k );
        if ( !( drift < FALLS[k].bound ) )
        {
            fail_msg( "case %d: a vertex drifts %.3g m from its shape", k, drift );
        }
    }
}

// 1/2 rho C_d d: the drag across a strand over length and squared speed.
static double drag_of( const wisp_strand_dynamics_def* def )
{
    return 0.5 * (double)def->air_density * (double)def->drag_coefficient * (double)def->diameter;
}

TEST( a_level_strand_falls_no_faster_than_its_drag_lets_it )
{
    wisp_strand_dynamics_def def = plain_def( WISP_STRAND_BEND_NONE );
    def.drag_coefficient = 1.0f;
    wisp_vec3 points[20];
    lay_straight( ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f }, 0.1, 20, points );
    single one;
    open_single( &one, points, 20, SUBSTEPS, &def );
    // v = v_t tanh(g t / v_t): a head that falls like this never pulls on a level strand, which stays level with it
    const double terminal = sqrt( (double)def.line_density * GRAVITY / drag_of( &def ) );
    double y = 0.0;
    for ( int step = 1; step <= 30; ++step )
    {
        y = -terminal * terminal / GRAVITY * log( cosh( GRAVITY * (double)FRAME * step / terminal ) );
        const wisp_transform pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, (float)y, 0.0f } };
        assert_int_equal( wisp_move_strand_head( one.s.world, one.e, pose ), WISP_OK );
        strand_steps( one.s.world, 1, FRAME );
    }
    const double fell = -(double)tip_of( &one ).y;
    // half a second in it falls at 99.98 % of v_t; without air it would be at 2.3 times that depth
    assert_fraction( fell, -y, 1e-2, "depth of a tip, m" );
    close_single( &one );
}

TEST( a_string_in_the_wind_leans_until_its_weight_across_is_the_drag )
{
    // from 1.5 m/s on the string flutters about its lean, and somewhat below it: so does a flag
    static const struct
    {
        float wind;
        int frames; // of which the mean is taken
        double flutter;
    } WINDS[] = { { 0.5f, 1, 0.0 }, { 1.0f, 1, 0.0 }, { 3.0f, 900, 0.02 } };
    for ( int i = 0; i < WISP_COUNT( WINDS ); ++i )
    {
        wisp_strand_dynamics_def def = plain_def( WISP_STRAND_BEND_NONE );
        def.drag_coefficient = 1.0f;
        def.damping = 4.0f;
        def.wind = ( wisp_vec3 ){ WINDS[i].wind, 0.0f, 0.0f };
        wisp_vec3 points[20];
        lay_straight( ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f }, 0.1, 20, points );
        single one;
        open_single( &one, points, 20, 40, &def );
        strand_steps( one.s.world, 300, FRAME );
        double lean = (double)tip_of( &one ).x;
        for ( int frame = 1; frame < WINDS[i].frames; ++frame )
        {
            strand_steps( one.s.world, 1, FRAME );
            lean += (double)tip_of( &one ).x;
        }
        // weight sin(a) = drag (wind cos(a))^2 on every piece alike, so the string is straight
        const double wind = (double)WINDS[i].wind;
        const double ratio = drag_of( &def ) * wind * wind / ( (double)def.line_density * GRAVITY );
        const double sine = ( sqrt( 1.0 + 4.0 * ratio * ratio ) - 1.0 ) / ( 2.0 * ratio );
        // an implicit substep takes dt / (dt + t) of the wind instead of dt / t, t = line density / (drag wind
        // cos(a))
        const double cosine = sqrt( 1.0 - sine * sine ), dt = (double)FRAME / 40.0;
        const double missing = dt * drag_of( &def ) * wind * cosine / (double)def.line_density;
        assert_fraction( lean / ( 0.1 * WINDS[i].frames ), sine, missing + 1e-4 + WINDS[i].flutter,
                         "lean of a string" );
        close_single( &one );
    }
}

// ---- a fixed point ----

static void keep_points( wisp_world* world, wisp_entity e, int count, wisp_vec3* points )
{
    memcpy( points, strand_points( world, e ), (size_t)count * sizeof( wisp_vec3 ) );
}

typedef struct resting
{
    strand_curve* curve;
    wisp_strand_rest rest;
    float damping;
    int substeps;
} resting;

// The largest distance of a vertex from its position in 2 s, after 5 s of rest.
static double wavering_of( const resting* r )
{
    hosted s;
    open_strands( &s, r->substeps, 1, 1 );
    wisp_strand_dynamics_def def = undamped_hair();
    def.rest = r->rest;
    def.damping = r->damping;
    const wisp_entity e = add_moving( s.world, 5, 20, r->curve, 0.1f, &def );
    strand_steps( s.world, 300, FRAME );
    wisp_vec3 before[100];
    keep_points( s.world, e, WISP_COUNT( before ), before );
    double farthest = 0.0;
    for ( int step = 0; step < 120; ++step )
    {
        strand_steps( s.world, 1, FRAME );
        for ( int v = 0; v < WISP_COUNT( before ); ++v )
        {
            farthest = fmax( farthest, vec_distance( strand_points( s.world, e )[v], before[v] ) );
        }
    }
    assert_false( wisp_is_halted( s.world, e ) );
    close_world( &s );
    return farthest;
}

static void assert_rests( const resting* cases, int count, double bound )
{
    for ( int k = 0; k < count; ++k )
    {
        const double farthest = wavering_of( cases + k );
        if ( !( farthest < bound ) )
        {
            fail_msg( "case %d, %d substeps: a resting vertex moves %.3g m", k, cases[k].substeps, farthest );
        }
    }
}

TEST( straight_rods_at_rest_are_fixed_points )
{
    static const resting STRAIGHT[] = { { straight_down, WISP_STRAND_REST_STRAIGHT, 0.0f, 1 },
                                        { straight_down, WISP_STRAND_REST_STRAIGHT, 0.0f, 4 },
                                        { straight_down, WISP_STRAND_REST_STRAIGHT, 0.0f, 16 },
                                        { straight_out, WISP_STRAND_REST_SAG_FREE, 0.0f, 4 },
                                        { straight_out, WISP_STRAND_REST_SAG_FREE, 0.0f, 16 } };
    // a hair is a thousand times as thick; positions of 0.1 m are rounded to 7e-9 m
    assert_rests( STRAIGHT, WISP_COUNT( STRAIGHT ), 1e-7 );
}

TEST( rods_that_are_bent_at_rest_waver_by_less_than_a_sixteenth_of_their_thickness )
{
    static const resting BENT[] = { { straight_out, WISP_STRAND_REST_STRAIGHT, 6.0f, 4 },
                                    { straight_out, WISP_STRAND_REST_STRAIGHT, 6.0f, 16 },
                                    { curl_down, WISP_STRAND_REST_SAG_FREE, 6.0f, 16 } };
    // rounding of positions by 7e-9 m is a force, over dt^2, that differs between substeps and shakes vertices that
    // are off the axis of their segments
    assert_rests( BENT, WISP_COUNT( BENT ), 5e-6 );
}

// ---- independence ----

static wisp_vec3 tip_at_rest( int rate, int count, int substeps )
{
    wisp_vec3 points[VERTICES_MAX];
    lay_straight( ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f }, 0.1, count, points );
    wisp_strand_dynamics_def def = plain_def( WISP_STRAND_BEND_ROD );
    def.damping = 6.0f;
    single one;
    open_single( &one, points, count, substeps, &def );
    strand_steps( one.s.world, 4 * rate, 1.0f / (float)rate );
    const wisp_vec3 tip = tip_of( &one );
    close_single( &one );
    return tip;
}

TEST( a_hair_hangs_the_same_at_every_frame_rate )
{
    static const int RATES[] = { 30, 60, 120, 240 }, SUBSTEP_COUNTS[] = { 1, 4 };
    const wisp_vec3 converged = tip_at_rest( 240, 20, 16 );
    for ( int k = 0; k < WISP_COUNT( RATES ) * WISP_COUNT( SUBSTEP_COUNTS ); ++k )
    {
        const wisp_vec3 tip = tip_at_rest( RATES[k % 4], 20, SUBSTEP_COUNTS[k / 4] );
        // of the length; a hair of 0.1 m sags by G = 8
        if ( !( vec_distance( tip, converged ) < 0.01 * 0.1 ) )
        {
            fail_msg( "%d frames a second of %d substeps: the tip is %.3g m from where it converges", RATES[k % 4],
                      SUBSTEP_COUNTS[k / 4], vec_distance( tip, converged ) );
        }
    }
}

TEST( a_hair_hangs_the_same_with_any_number_of_vertices )
{
    static const int COUNTS[] = { 10, 20, 40, 80 };
    wisp_vec3 tips[WISP_COUNT( COUNTS )];
    for ( int k = 0; k < WISP_COUNT( COUNTS ); ++k )
    {
        tips[k] = tip_at_rest( 60, COUNTS[k], SUBSTEPS );
    }
    for ( int k = 0; k < WISP_COUNT( COUNTS ) * WISP_COUNT( COUNTS ); ++k )
    {
        const double apart = vec_distance( tips[k % 4], tips[k / 4] );
        if ( !( apart < 0.03 * 0.1 ) )
        {
            fail_msg( "%d and %d vertices: the tips are %.3g m apart", COUNTS[k % 4], COUNTS[k / 4], apart );
        }
    }
    // and the remainder falls with the number of vertices
    assert_true( vec_distance( tips[2], tips[3] ) < vec_distance( tips[0], tips[1] ) );
}
