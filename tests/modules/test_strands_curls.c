// Curled rods that hang in balance, at few substeps and at many: they stay in place, nothing gains energy, and curls
// that a substep cannot hold are reported.
#include "strands_fixture.h"

static const float FRAME = 1.0f / 60.0f;

enum
{
    STRANDS = 4,
    FRAMES = 120,
    NOD_FRAMES = 18,
};

static const float HEIGHT = 0.16f;     // m
static const double RADIUS = 0.005;    // m
static const double PITCH = 0.02;      // m per turn
static const double GRAVITY = 9.81;    // m/s^2
static const double THICKNESS = 80e-6; // m, of a hair

static const int SUBSTEPS[] = { 2, 4, 8, 16 };
static const int COUNTS[] = { 32, 96 };

// A helix that hangs, eight turns of 1 cm across; each strand is turned by an angle of its own.
static wisp_vec3 curls( int strand, int i, int count, float height )
{
    const double down = (double)height * i / ( count - 1 );
    const double angle = 6.283185307179586 * down / PITCH + 2.399963229728653 * strand;
    return ( wisp_vec3 ){ (float)( RADIUS * cos( angle ) ), (float)-down, (float)( RADIUS * sin( angle ) ) };
}

static double arc_length( void )
{
    const double turns = (double)HEIGHT / PITCH, round = 6.283185307179586 * RADIUS;
    return turns * sqrt( round * round + PITCH * PITCH );
}

typedef struct course
{
    double drift;  // m, the farthest at the end
    double speed;  // m/s, the fastest at the end of any sampled frame
    double energy; // J, largest rise of kinetic and potential energy above the start
    double weight; // N, of all strands
    uint64_t lightened;
} course;

// Kinetic and potential energy of every vertex that moves.
static double look( wisp_world* world, wisp_entity e, course* c )
{
    const wisp_strand_topology* t = wisp_world_strands( world, e );
    const float* x = wisp_world_column( world, e, WISP_STRAND_POSITION, 0 );
    const float* v = wisp_world_column( world, e, WISP_STRAND_VELOCITY, 0 );
    const float* w = wisp_world_column( world, e, WISP_STRAND_INVERSE_MASS, 0 );
    double energy = 0.0, mass = 0.0;
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        for ( int i = 1; i < t->lane_count[lane]; ++i )
        {
            const size_t row = (size_t)( t->group_row[lane / WISP_LANES] + i );
            const size_t at = row * 3 * WISP_LANES + (size_t)( lane % WISP_LANES );
            const double m = 1.0 / (double)w[row * WISP_LANES + (size_t)( lane % WISP_LANES )];
            const wisp_vec3 u = { v[at], v[at + WISP_LANES], v[at + 2 * WISP_LANES] };
            const double speed = vec_distance( u, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
            c->speed = fmax( c->speed, speed );
            energy += m * ( 0.5 * speed * speed + GRAVITY * (double)x[at + WISP_LANES] );
            mass += m;
        }
    }
    c->weight = mass * GRAVITY;
    return energy;
}

// Back and forth by a fifth of a radian and 2 cm, in 0.3 s.
static wisp_transform nod( int frame )
{
    const float there = fminf( (float)frame / 6.0f, 1.0f ), back = fmaxf( 0.0f, (float)( frame - 12 ) / 6.0f );
    const float t = 0.2f * ( there - back );
    return head_at( t, ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f }, ( wisp_vec3 ){ 0.1f * t, 0.04f * t, 0.0f } );
}

static course run( int vertices, int substeps, const wisp_strand_dynamics_def* def, int nod_frames )
{
    hosted s;
    open_strands( &s, substeps, 1, 1 );
    const wisp_entity e = add_moving( s.world, STRANDS, vertices, curls, HEIGHT, def );
    course c = { .drift = 0.0 };
    for ( int frame = 1; frame <= nod_frames; ++frame )
    {
        assert_int_equal( wisp_move_strand_head( s.world, e, nod( frame ) ), WISP_OK );
        strand_steps( s.world, 1, FRAME );
    }
    const double start = look( s.world, e, &c );
    c.speed = 0.0;
    for ( int frame = 0; frame < FRAMES; ++frame )
    {
        strand_steps( s.world, 1, FRAME );
        c.energy = fmax( c.energy, look( s.world, e, &c ) - start );
    }
    c.drift = drift_from( s.world, e, STRANDS, vertices, curls, HEIGHT );
    c.lightened = wisp_world_counter( s.world, WISP_COUNT_GRAVITY_SCALED );
    close_world( &s );
    return c;
}

TEST( balanced_curls_stay_at_any_number_of_substeps )
{
    const wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    for ( int k = 0; k < WISP_COUNT( SUBSTEPS ) * WISP_COUNT( COUNTS ); ++k )
    {
        const int vertices = COUNTS[k % WISP_COUNT( COUNTS )], substeps = SUBSTEPS[k / WISP_COUNT( COUNTS )];
        const course c = run( vertices, substeps, &def, 0 );
        print_message( "%d vertices, %d substeps: %.2g mm, %.2g m/s, %.2g J\n", vertices, substeps, 1e3 * c.drift,
                       c.speed, c.energy );
        // the balance is a fixed point of a substep of any length: without damping, rounding of positions by 7e-9 m
        // causes motion below the thickness of the hair, and a rise below that
        if ( !( c.drift < THICKNESS && c.energy < c.weight * THICKNESS ) )
        {
            fail_msg( "%d vertices, %d substeps: %.3g m from the start, %.3g J above it", vertices, substeps, c.drift,
                      c.energy );
        }
    }
}

TEST( curls_that_a_nod_has_moved_stay_slower_than_a_fall )
{
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    def.damping = 1.0f;
    // the speed of a fall through the length of a strand; the head has moved it at 0.2 m/s
    const double fall = sqrt( 2.0 * GRAVITY * arc_length() );
    for ( int k = 0; k < WISP_COUNT( SUBSTEPS ) * WISP_COUNT( COUNTS ); ++k )
    {
        const int vertices = COUNTS[k % WISP_COUNT( COUNTS )], substeps = SUBSTEPS[k / WISP_COUNT( COUNTS )];
        const course c = run( vertices, substeps, &def, NOD_FRAMES );
        print_message( "%d vertices, %d substeps, nodded: %.2g m/s\n", vertices, substeps, c.speed );
        if ( !( c.speed < fall ) )
        {
            fail_msg( "%d vertices, %d substeps: %.3g m/s", vertices, substeps, c.speed );
        }
        assert_true( c.speed > 0.05 ); // they do move
    }
}

TEST( curls_that_feel_less_than_their_weight_are_counted )
{
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    // once for every length of a substep
    assert_int_equal( run( 32, 8, &def, 0 ).lightened, STRANDS );
    assert_int_equal( run( 32, 32, &def, 0 ).lightened, 0 );
    // a strand that sags anyway carries all of it
    def.rest = WISP_STRAND_REST_SHAPE;
    const course sagging = run( 32, 8, &def, 0 );
    assert_int_equal( sagging.lightened, 0 );
    assert_true( sagging.drift > 0.1 * (double)HEIGHT );
}
