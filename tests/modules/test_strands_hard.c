// Strands under conditions that have broken engines: heads that jump and spin, strands of a point, masses and
// stiffness far apart, long steps, scenes of a tenth of a millimetre and of a hundred metres, NaN.
#include "strands_fixture.h"

static const float FRAME = 1.0f / 60.0f;
static const wisp_vec3 UP = { 0.0f, 1.0f, 0.0f };
static const double GRAVITY = 9.81;

enum
{
    STRANDS = 5,
    REST_FRAMES = 30, // s of a head at rest, in which strands recover their lengths
    VERTICES_MAX = 20,
    POINTS_MAX = STRANDS * VERTICES_MAX,
};

// ---- solvers ----

typedef struct way
{
    const char* name;
    wisp_strand_stretch stretch;
    wisp_strand_bend bend;
    wisp_strand_rest rest;
    strand_curve* curve;
    wisp_integrator integrator;
} way;

static const way WAYS[] = {
    { "straight rod", WISP_STRAND_STRETCH_DIRECT, WISP_STRAND_BEND_ROD, WISP_STRAND_REST_STRAIGHT, straight_out,
      WISP_INTEGRATOR_EULER },
    { "balanced curl", WISP_STRAND_STRETCH_DIRECT, WISP_STRAND_BEND_ROD, WISP_STRAND_REST_SAG_FREE, curl_down,
      WISP_INTEGRATOR_EULER },
    { "direct, bend links", WISP_STRAND_STRETCH_DIRECT, WISP_STRAND_BEND_LINKS, WISP_STRAND_REST_SHAPE, curl_down,
      WISP_INTEGRATOR_EULER },
    { "straight rod, bdf2", WISP_STRAND_STRETCH_DIRECT, WISP_STRAND_BEND_ROD, WISP_STRAND_REST_STRAIGHT, straight_out,
      WISP_INTEGRATOR_BDF2 },
    { "balanced curl, bdf2", WISP_STRAND_STRETCH_DIRECT, WISP_STRAND_BEND_ROD, WISP_STRAND_REST_SAG_FREE, curl_down,
      WISP_INTEGRATOR_BDF2 },
    { "direct, bend links, bdf2", WISP_STRAND_STRETCH_DIRECT, WISP_STRAND_BEND_LINKS, WISP_STRAND_REST_SHAPE,
      curl_down, WISP_INTEGRATOR_BDF2 },
    { "links", WISP_STRAND_STRETCH_LINKS, WISP_STRAND_BEND_LINKS, WISP_STRAND_REST_SHAPE, curl_down,
      WISP_INTEGRATOR_EULER },
};

static const int SUBSTEPS[] = { 1, 4, 10 };

// ---- hard cases ----

/// The pose of the head at the end of a frame; `size` is the length of the strands, m.
typedef wisp_transform head_motion( int frame, float size );

/// Mass of a vertex relative to the first one.
typedef double mass_profile( int i, int count );

typedef struct hard_case
{
    const char* name;
    head_motion* motion;
    int motion_frames; // after that it rests
    int vertices;
    float seconds;  // s per frame; 0: 1/60
    float rigidity; // EI and GJ, N m^2; 0: the default's, negative: none
    float scale;    // of all lengths, with masses of the same material; 0: 1
    float teleport; // 0: the default's
    float whip;     // factor of the tolerated speed, for a strand whose tip is light; 0: 1
    int collapsed;  // segments from the root on that have no length
    mass_profile* masses;
    bool pumps_direct;    // the direct solve gains energy between light and heavy: speed and energy are not checked
    bool outweighs_links; // one sweep of links does not hold far heavier vertices: lengths are not checked
} hard_case;

static wisp_transform nod( int frame, float size )
{
    const float t = fminf( (float)frame / 6.0f, 1.0f );
    return head_at( t, ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f }, ( wisp_vec3 ){ 0.5f * size * t, 0.2f * size * t, 0.0f } );
}

static wisp_transform hundred_metres( int frame, float size )
{
    (void)size;
    return head_at( 0.5f, UP, ( wisp_vec3 ){ frame > 0 ? 100.0f : 0.0f, 0.0f, 0.0f } );
}

static wisp_transform there_and_back( int frame, float size )
{
    (void)size;
    return head_at( 0.0f, UP, ( wisp_vec3 ){ frame % 2 == 1 ? 100.0f : 0.0f, 0.0f, 0.0f } );
}

static wisp_transform spin( int frame, float size )
{
    (void)size;
    return head_at( 100.0f / 60.0f * (float)frame, UP, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
}

static wisp_transform shake( int frame, float size )
{
    const wisp_vec3 axis = { test_random_float( frame, 0, -1.0f, 1.0f ), test_random_float( frame, 1, -1.0f, 1.0f ),
                             test_random_float( frame, 2, -1.0f, 1.0f ) };
    const wisp_vec3 place = { test_random_float( frame, 3, -1.7f, 1.7f ) * size,
                              test_random_float( frame, 4, -1.7f, 1.7f ) * size,
                              test_random_float( frame, 5, -1.7f, 1.7f ) * size };
    return wisp_transform_make( ( wisp_quat ){ axis.x, axis.y, axis.z, test_random_float( frame, 6, -1.0f, 1.0f ) },
                                place );
}

static double falling_masses( int i, int count )
{
    return pow( 10.0, -6.0 * i / ( count - 1 ) );
}

static double rising_masses( int i, int count )
{
    return pow( 10.0, 6.0 * i / ( count - 1 ) ) * 1e-6;
}

static double alternating_masses( int i, int count )
{
    (void)count;
    return i % 2 == 0 ? 1.0 : 1e-6;
}

static const hard_case CASES[] = {
    { .name = "nod", .motion = nod, .motion_frames = 6, .vertices = 20 },
    { .name = "teleport 100 m", .motion = hundred_metres, .motion_frames = 1, .vertices = 20 },
    { .name = "teleport, back and forth", .motion = there_and_back, .motion_frames = 10, .vertices = 20 },
    { .name = "dragged 100 m", .motion = hundred_metres, .motion_frames = 1, .vertices = 20, .teleport = 1e6f },
    { .name = "spin", .motion = spin, .motion_frames = 30, .vertices = 20 },
    { .name = "1 vertex", .motion = spin, .motion_frames = 30, .vertices = 1 },
    { .name = "2 vertices", .motion = spin, .motion_frames = 30, .vertices = 2 },
    { .name = "zero segments",
      .motion = nod,
      .motion_frames = 6,
      .vertices = 20,
      .collapsed = 5,
      .outweighs_links = true },
    { .name = "a point", .motion = nod, .motion_frames = 6, .vertices = 20, .collapsed = 19 },
    { .name = "stiffness 0", .motion = nod, .motion_frames = 6, .vertices = 20, .rigidity = -1.0f },
    { .name = "stiffness 1e12", .motion = nod, .motion_frames = 6, .vertices = 20, .rigidity = 1e12f },
    { .name = "1/5 s", .motion = nod, .motion_frames = 6, .vertices = 20, .seconds = 0.2f },
    { .name = "falling masses",
      .motion = nod,
      .motion_frames = 6,
      .vertices = 20,
      .masses = falling_masses,
      .whip = 4.0f },
    { .name = "rising masses",
      .motion = nod,
      .motion_frames = 6,
      .vertices = 20,
      .masses = rising_masses,
      .pumps_direct = true,
      .outweighs_links = true },
    { .name = "alternating masses",
      .motion = nod,
      .motion_frames = 6,
      .vertices = 20,
      .masses = alternating_masses,
      .pumps_direct = true },
    { .name = "scale 1e-3", .motion = nod, .motion_frames = 6, .vertices = 20, .scale = 1e-3f },
    { .name = "scale 1e3", .motion = nod, .motion_frames = 6, .vertices = 20, .scale = 1e3f },
};

// ---- a cell of the matrix ----

typedef struct cell
{
    const hard_case* hard;
    const way* way;
    int substeps;
    hosted s;
    wisp_entity e;
    wisp_strand_dynamics_def def;
    wisp_vec3 rest[POINTS_MAX];
    float masses[POINTS_MAX];
    double size, seconds; // m, of a strand; s, of a frame
    double head_speed;    // m/s, the largest speed of a vertex of a rigid strand on the head, without jumps
    double speed;         // m/s, the fastest vertex
    double strain;        // the largest error in the last frame, relative to that of rounding
    double energy;        // J
    char why[200];        // the first failure; empty: none
} cell;

static double scale_of( const hard_case* hard )
{
    return hard->scale > 0.0f ? (double)hard->scale : 1.0;
}

static void lay_cell( cell* c )
{
    const hard_case* hard = c->hard;
    const float scale = (float)scale_of( hard );
    for ( int i = 0; i < STRANDS * hard->vertices; ++i )
    {
        const int v = i % hard->vertices;
        const wisp_vec3 p =
            c->way->curve( i / hard->vertices, v > hard->collapsed ? v - hard->collapsed : 0, hard->vertices, 0.1f );
        c->rest[i] = ( wisp_vec3 ){ scale * p.x, scale * p.y, scale * p.z };
        c->masses[i] = hard->masses != NULL ? (float)( 6.5e-7 * hard->masses( v, hard->vertices ) ) : 0.0f;
    }
}

// A scaled strand has the same slenderness and material: mass per length scales with the square, rigidity with the
// fourth power.
static wisp_strand_dynamics_def def_of( const cell* c )
{
    const hard_case* hard = c->hard;
    const float square = (float)( scale_of( hard ) * scale_of( hard ) );
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    def.stretch = c->way->stretch;
    def.integrator = c->way->integrator;
    def.bending = c->way->bend;
    def.rest = c->way->rest;
    def.stretch_tolerance = 1e-3f;
    def.line_density *= square;
    def.bend_rigidity = hard->rigidity == 0.0f ? square * square * def.bend_rigidity : fmaxf( hard->rigidity, 0.0f );
    def.twist_rigidity =
        hard->rigidity == 0.0f ? square * square * def.twist_rigidity : fmaxf( hard->rigidity, 0.0f );
    def.teleport = hard->teleport > 0.0f ? hard->teleport : def.teleport;
    def.vertex_masses = hard->masses != NULL ? c->masses : NULL;
    return def;
}

static void open_cell( cell* c )
{
    int32_t offsets[STRANDS + 1];
    for ( int i = 0; i <= STRANDS; ++i )
    {
        offsets[i] = i * c->hard->vertices;
    }
    c->size = 0.1 * scale_of( c->hard );
    c->seconds = c->hard->seconds > 0.0f ? (double)c->hard->seconds : (double)FRAME;
    lay_cell( c );
    open_strands( &c->s, c->substeps, 1, 1 );
    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = c->rest;
    strands.offsets = offsets;
    strands.strand_count = STRANDS;
    assert_int_equal( wisp_add_strands( c->s.world, &strands, &c->e ), WISP_OK );
    c->def = def_of( c );
    assert_int_equal( wisp_set_strand_dynamics( c->s.world, c->e, &c->def ), WISP_OK );
    assert_int_equal( wisp_request( c->s.world, c->e, WISP_STRAND_POINTS ), WISP_OK );
    assert_int_equal( wisp_request( c->s.world, c->e, WISP_MOTION_STATS ), WISP_OK );
}

static void blame( cell* c, int frame, const char* what, double measured, double bound )
{
    if ( c->why[0] == '\0' )
    {
        snprintf( c->why, sizeof( c->why ), "%s, %s, %d substeps, frame %d: %s is %.4g, tolerated %.4g",
                  c->hard->name, c->way->name, c->substeps, frame, what, measured, bound );
    }
}

static double largest_coordinate( wisp_vec3 p )
{
    return fmax( fabs( (double)p.x ), fmax( fabs( (double)p.y ), fabs( (double)p.z ) ) );
}

// Relative length error of strand i, per segment; for links relative to the mean one. NaN if a coordinate is.
static double strain_of( const cell* c, const wisp_vec3* points, int strand )
{
    const int count = c->hard->vertices;
    const wisp_vec3 *rest = c->rest + (size_t)strand * (size_t)count, *p = points + (size_t)strand * (size_t)count;
    double whole = 0.0, worst = 0.0;
    for ( int v = 0; v + 1 < count; ++v )
    {
        whole += vec_distance( rest[v], rest[v + 1] );
    }
    for ( int v = 0; v + 1 < count && whole > 0.0; ++v )
    {
        // a segment without a length gets a thousandth of the mean one
        const double mean = whole / ( count - 1 ), length = fmax( vec_distance( rest[v], rest[v + 1] ), 1e-3 * mean );
        const double rounding = 4.0 * FLT_EPSILON * ( largest_coordinate( p[v] ) + length );
        const double off = fabs( vec_distance( p[v], p[v + 1] ) - length ) - rounding;
        const double strain = off / ( c->way->stretch == WISP_STRAND_STRETCH_LINKS ? mean : length );
        worst = strain <= worst || isnan( worst ) ? worst : strain;
    }
    return worst;
}

// The direct solve resets strands beyond the definition's tolerance. One sweep of
// links leaves an error due to the accelerations of a substep: at most a dt^2 for every link that hangs on the first,
// a of gravity and twice the centripetal acceleration of a strand at that speed.
static double tolerated_strain( const cell* c )
{
    if ( c->way->stretch != WISP_STRAND_STRETCH_LINKS )
    {
        return 1e-3;
    }
    const double dt = c->seconds / c->substeps, segments = fmax( c->hard->vertices - 1, 1 );
    const double acceleration = GRAVITY + 2.0 * c->speed * c->speed / c->size;
    return segments * segments * acceleration * dt * dt / c->size;
}

// Energy of an elastic rod that is straight at rest, from the clamp on: EI / (2 L_i) |t_i - t_{i-1}|^2. EI is lowered
// as the module's README describes.
static double straight_energy( const cell* c, const wisp_vec3* points, wisp_transform head )
{
    const int count = c->hard->vertices;
    const double l = c->size / fmax( count - 1, 1 ), dt = c->seconds / c->substeps;
    const double most = 6e4 * (double)c->def.line_density * l * l * l * l / ( dt * dt );
    const double rigidity = fmin( (double)c->def.bend_rigidity, most );
    double sum = 0.0;
    for ( int i = 0; i < STRANDS; ++i )
    {
        wisp_vec3 before = wisp_quat_rotate( head.rotation, ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f } );
        for ( int v = 0; v + 1 < count; ++v )
        {
            const wisp_vec3 p = points[i * count + v], q = points[i * count + v + 1];
            const float inverse = (float)( 1.0 / l );
            const wisp_vec3 t = { inverse * ( q.x - p.x ), inverse * ( q.y - p.y ), inverse * ( q.z - p.z ) };
            const double turn = vec_distance( t, before );
            sum += 0.5 * rigidity / ( v > 0 ? l : 0.5 * l ) * turn * turn;
            before = t;
        }
    }
    return sum;
}

/// The curl of the fixture; a helix of radius r that grows by p per radian has the curvature r / (r^2 + p^2).
typedef struct curl_shape
{
    double curvature, length; // 1/m, m
} curl_shape;

static curl_shape curl_of( const cell* c )
{
    const double r = 0.1 * c->size, p = 0.6 * c->size / 12.566;
    return ( curl_shape ){ r / ( r * r + p * p ), 12.566 * sqrt( r * r + p * p ) };
}

// A curled rod is softened where dt^2 EI curvature^4 / line density is above 0.08. Its cooked shape is then no longer
// the balance, and it keeps moving, so speed and energy are checked only without softening.
static bool is_softened( const cell* c )
{
    const double dt = c->seconds / c->substeps, square = curl_of( c ).curvature * curl_of( c ).curvature;
    return dt * dt * (double)c->def.bend_rigidity * square * square > 0.08 * (double)c->def.line_density;
}

// Energy released by straightening a curl.
static double curl_energy( const cell* c )
{
    const curl_shape k = curl_of( c );
    return STRANDS * 0.5 * (double)c->def.bend_rigidity * k.curvature * k.curvature * k.length;
}

// J. In addition to the stored energy of the strands, tension carried into the next substep and strand resets add a
// little. A substep does not resolve the height of a fall within it.
static double tolerated_rise( const cell* c, double mass )
{
    const double weight = mass * GRAVITY * c->size, dt = c->seconds / c->substeps;
    const double curl = c->way->rest == WISP_STRAND_REST_SAG_FREE ? curl_energy( c ) : 0.0;
    return weight * ( 0.2 + GRAVITY * dt * dt / c->size ) + curl;
}

static double tolerated_speed( const cell* c )
{
    const double dt = c->seconds / c->substeps;
    // links keep the velocity of one substep of falling, because one sweep leaves an error
    const double kept = c->way->stretch == WISP_STRAND_STRETCH_DIRECT ? 0.0 : GRAVITY * dt;
    // a head that spins makes strands faster than itself, as does Euler from 160 substeps on (11 m/s, spin); fewer damp it
    const double order = c->way->integrator == WISP_INTEGRATOR_BDF2 ? 2.5 : 1.0;
    const double whip = order * ( c->hard->whip > 0.0f ? (double)c->hard->whip : 1.0 );
    // twice the head's, and twice that of a fall over two lengths
    return whip * ( 2.0 * c->head_speed + 4.0 * sqrt( GRAVITY * c->size ) + kept );
}

static wisp_transform move_cell( cell* c, int frame )
{
    const int last = c->hard->motion_frames;
    const wisp_transform pose = c->hard->motion( frame < last ? frame : last, (float)c->size );
    const wisp_transform before =
        frame > 1 ? c->hard->motion( frame - 1 < last ? frame - 1 : last, (float)c->size )
                  : wisp_transform_make( ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 1.0f }, ( wisp_vec3 ){ 0 } );
    assert_int_equal( wisp_move_strand_head( c->s.world, c->e, pose ), WISP_OK );
    strand_steps( c->s.world, 1, (float)c->seconds );
    const bool jumps = vec_distance( pose.translation, before.translation ) > (double)c->def.teleport * c->size;
    for ( int v = 0; v < c->hard->vertices && jumps == false; ++v )
    {
        const wisp_vec3 from = wisp_transform_to_world( before, c->rest[v] ),
                        to = wisp_transform_to_world( pose, c->rest[v] );
        c->head_speed = fmax( c->head_speed, vec_distance( from, to ) / c->seconds );
    }
    return pose;
}

static void look_at_cell( cell* c, int frame )
{
    const wisp_transform pose = move_cell( c, frame );
    if ( wisp_is_halted( c->s.world, c->e ) )
    {
        blame( c, frame, "halted", 1.0, 0.0 );
        return;
    }
    const wisp_vec3* points = strand_points( c->s.world, c->e );
    c->strain = 0.0;
    for ( int i = 0; i < STRANDS; ++i )
    {
        const double strain = strain_of( c, points, i );
        c->strain = strain <= c->strain || isnan( c->strain ) ? c->strain : strain;
    }
    const wisp_motion_stats q = motion_stats_of( c->s.world, c->e );
    c->energy = q.kinetic_energy + q.potential_energy;
    if ( c->way->rest == WISP_STRAND_REST_STRAIGHT && c->hard->collapsed == 0 )
    {
        c->energy += straight_energy( c, points, pose );
    }
    c->speed = q.speed_max;
    if ( !( isfinite( c->energy ) && isfinite( c->strain ) && isfinite( q.speed_max ) ) )
    {
        blame( c, frame, "a number that should be finite", c->energy, 0.0 );
    }
    // links take longer; the other solvers must have their lengths in every frame
    if ( c->way->stretch != WISP_STRAND_STRETCH_LINKS && !( c->strain <= tolerated_strain( c ) ) )
    {
        blame( c, frame, "strain", c->strain, tolerated_strain( c ) );
    }
}

static void look_at_the_end( cell* c, int frame, double rise )
{
    const wisp_motion_stats q = motion_stats_of( c->s.world, c->e );
    const bool is_links = c->way->stretch == WISP_STRAND_STRETCH_LINKS;
    if ( !( is_links && c->hard->outweighs_links ) && !( c->strain <= tolerated_strain( c ) ) )
    {
        blame( c, frame, "strain", c->strain, tolerated_strain( c ) );
    }
    const bool is_curl = c->way->rest == WISP_STRAND_REST_SAG_FREE && c->way->bend == WISP_STRAND_BEND_ROD;
    const bool is_direct = c->way->stretch == WISP_STRAND_STRETCH_DIRECT;
    if ( ( is_curl && is_softened( c ) ) || ( is_direct && c->hard->pumps_direct ) )
    {
        return;
    }
    if ( !( q.speed_max <= tolerated_speed( c ) ) )
    {
        blame( c, frame, "speed, m/s,", q.speed_max, tolerated_speed( c ) );
    }
    if ( !( rise <= tolerated_rise( c, q.mass ) ) )
    {
        blame( c, frame, "rise of energy, J,", rise, tolerated_rise( c, q.mass ) );
    }
}

static void run_cell( cell* c )
{
    open_cell( c );
    const int last = c->hard->motion_frames + REST_FRAMES;
    double energy = 0.0;
    for ( int frame = 1; frame <= last && c->why[0] == '\0'; ++frame )
    {
        look_at_cell( c, frame );
        energy = frame == c->hard->motion_frames ? c->energy : energy;
    }
    if ( c->why[0] == '\0' )
    {
        look_at_the_end( c, last, c->energy - energy );
    }
    close_world( &c->s );
}

// Print the failure of each cell. @return number of cells that fail
static int run_cases( const way* w, int substeps )
{
    int failures = 0;
    for ( int k = 0; k < WISP_COUNT( CASES ); ++k )
    {
        cell c = { .hard = CASES + k, .way = w, .substeps = substeps };
        run_cell( &c );
        if ( c.why[0] != '\0' )
        {
            print_error( "%s\n", c.why );
            failures += 1;
        }
    }
    return failures;
}

TEST( whatever_the_head_does_strands_stay_finite_and_are_back_at_their_lengths )
{
    int failures = 0;
    for ( int k = 0; k < WISP_COUNT( WAYS ) * WISP_COUNT( SUBSTEPS ); ++k )
    {
        failures += run_cases( WAYS + k / WISP_COUNT( SUBSTEPS ), SUBSTEPS[k % WISP_COUNT( SUBSTEPS )] );
    }
    assert_int_equal( failures, 0 );
}

TEST( curls_in_substeps_that_do_not_soften_them_gain_no_energy_either )
{
    const way* curl = WAYS + 1;
    cell nodding = { .hard = CASES, .way = curl, .substeps = 40, .size = 0.1, .seconds = (double)FRAME };
    nodding.def = def_of( &nodding );
    assert_false( is_softened( &nodding ) );
    assert_int_equal( run_cases( curl, nodding.substeps ), 0 );
}

// ---- random poses ----

TEST( after_random_poses_of_the_head_strands_come_back_and_slow_down )
{
    enum
    {
        POSES = 30,
        REST = 60
    };
    const hard_case hard = {
        .name = "random poses", .motion = shake, .motion_frames = POSES, .vertices = 20, .teleport = 1e6f
    };
    for ( int k = 0; k < WISP_COUNT( WAYS ) * WISP_COUNT( SUBSTEPS ); ++k )
    {
        cell c = { .hard = &hard,
                   .way = WAYS + k / WISP_COUNT( SUBSTEPS ),
                   .substeps = SUBSTEPS[k % WISP_COUNT( SUBSTEPS )] };
        open_cell( &c );
        double fast = 0.0;
        for ( int frame = 1; frame <= POSES + REST && c.why[0] == '\0'; ++frame )
        {
            look_at_cell( &c, frame );
            fast = frame == POSES ? motion_stats_of( c.s.world, c.e ).speed_max : fast;
        }
        const double slow = motion_stats_of( c.s.world, c.e ).speed_max;
        if ( !( c.strain <= tolerated_strain( &c ) ) )
        {
            blame( &c, POSES + REST, "strain", c.strain, tolerated_strain( &c ) );
        }
        // only the solver removes energy
        if ( !( slow < 0.5 * fast ) )
        {
            blame( &c, POSES + REST, "speed, m/s,", slow, 0.5 * fast );
        }
        close_world( &c.s );
        if ( c.why[0] != '\0' )
        {
            fail_msg( "%s", c.why );
        }
    }
}

// ---- NaN ----

TEST( a_nan_in_one_position_halts_that_entity_alone )
{
    uint64_t hashes[2][4];
    for ( int k = 0; k < 2; ++k )
    {
        hosted s;
        open_strands( &s, 4, 1, 1 );
        const wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
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
        for ( int v = 0; v < 240; ++v )
        {
            assert_true( isfinite( largest_coordinate( strand_points( s.world, sick )[v] ) ) );
        }
        close_world( &s );
    }
    assert_memory_equal( hashes[0], hashes[1], sizeof( hashes[0] ) );
}
