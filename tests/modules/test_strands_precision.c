// Strands keep their motion far from the origin and in short substeps, where positions have too few digits for it.
#include "strands_fixture.h"

static const float FRAME = 1.0f / 60.0f;

enum
{
    VERTICES = 20,
    FRAMES = 60,
};

// ---- far from the origin ----

typedef struct swing_case
{
    const char* name;
    wisp_strand_bend bend;
    wisp_strand_rest rest;
    bool shaken;   // the head moves
    bool collides; // a ball somewhere else, so that passes do not run together
} swing_case;

static const swing_case SWINGS[] = {
    { "chain", WISP_STRAND_BEND_NONE, WISP_STRAND_REST_STRAIGHT, false, false },
    { "links", WISP_STRAND_BEND_LINKS, WISP_STRAND_REST_STRAIGHT, false, false },
    { "rod", WISP_STRAND_BEND_ROD, WISP_STRAND_REST_STRAIGHT, false, false },
    { "rod with a rest shape", WISP_STRAND_BEND_ROD, WISP_STRAND_REST_SHAPE, false, false },
    { "chain, shaken", WISP_STRAND_BEND_NONE, WISP_STRAND_REST_STRAIGHT, true, false },
    { "chain beside a ball", WISP_STRAND_BEND_NONE, WISP_STRAND_REST_STRAIGHT, false, true },
    { "links beside a ball", WISP_STRAND_BEND_LINKS, WISP_STRAND_REST_STRAIGHT, false, true },
    { "rod beside a ball", WISP_STRAND_BEND_ROD, WISP_STRAND_REST_SHAPE, false, true },
};

static const float LENGTH = 0.3f;

static void move_to( hosted* s, wisp_entity e, float far, float shake )
{
    const wisp_transform pose =
        head_at( 0.0f, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, ( wisp_vec3 ){ far + shake, -0.7f * far, 0.3f * far } );
    assert_int_equal( wisp_move_strand_head( s->world, e, pose ), WISP_OK );
}

static void add_ball( hosted* s, wisp_entity e )
{
    const wisp_collision_def collision = wisp_default_collision_def();
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.pose.translation.y = 30.0f;
    wisp_entity collider;
    assert_int_equal( wisp_add_collider( s->world, &ball, &collider ), WISP_OK );
    assert_int_equal( wisp_set_collision( s->world, e, &collision ), WISP_OK );
}

// Let a strand swing that starts level. @param points receives [FRAMES][VERTICES] relative to the root
static void swing_at( const swing_case* c, float far, int substeps, wisp_vec3* points )
{
    hosted s;
    open_strands( &s, substeps, 1, 1 );
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    def.bending = c->bend;
    def.rest = c->rest;
    const wisp_entity e = add_moving( s.world, 1, VERTICES, straight_out, LENGTH, &def );
    if ( c->collides )
    {
        add_ball( &s, e );
    }
    for ( int frame = 0; frame < FRAMES; ++frame )
    {
        move_to( &s, e, far, c->shaken ? 0.05f * sinf( 0.3f * (float)frame ) : 0.0f );
        strand_steps( s.world, 1, FRAME );
        const wisp_vec3* now = strand_points( s.world, e );
        for ( int i = 0; i < VERTICES; ++i )
        {
            points[frame * VERTICES + i] =
                ( wisp_vec3 ){ now[i].x - now[0].x, now[i].y - now[0].y, now[i].z - now[0].z };
        }
    }
    assert_false( wisp_is_halted( s.world, e ) );
    close_world( &s );
}

// The root mean square of what the swing far out differs by, in lengths.
static double difference_at( const swing_case* c, float far, int substeps )
{
    static wisp_vec3 here[FRAMES * VERTICES], there[FRAMES * VERTICES];
    swing_at( c, 0.0f, substeps, here );
    swing_at( c, far, substeps, there );
    double sum = 0.0;
    for ( int i = 0; i < FRAMES * VERTICES; ++i )
    {
        const double d = vec_distance( here[i], there[i] );
        sum += d * d;
    }
    return sqrt( sum / ( FRAMES * VERTICES ) ) / (double)LENGTH;
}

TEST( strands_swing_far_out_as_at_the_origin )
{
    // positions are written with 4e-6 m at 100 m and 3e-5 m at 1 km, 1e-5 and 1e-4 of the length
    static const struct
    {
        float far;
        int substeps;
        double tolerance;
    } PLACES[] = { { 100.0f, 10, 1e-3 }, { 100.0f, 40, 1e-3 }, { 1000.0f, 10, 2e-2 }, { 1000.0f, 16, 2e-2 } };
    int failures = 0;
    for ( int i = 0; i < WISP_COUNT( SWINGS ) * WISP_COUNT( PLACES ); ++i )
    {
        const swing_case* c = SWINGS + i / WISP_COUNT( PLACES );
        const int k = i % WISP_COUNT( PLACES );
        const double difference = difference_at( c, PLACES[k].far, PLACES[k].substeps );
        print_message( "%s: %g m out, %d substeps: %.2g\n", c->name, (double)PLACES[k].far, PLACES[k].substeps,
                       difference );
        failures += difference <= PLACES[k].tolerance ? 0 : 1; // so that NaN fails
    }
    assert_int_equal( failures, 0 );
}

// ---- short substeps ----

// The energy that a pendulum of 1 m has lost in three periods, of that which it was let go with at 60 degrees.
static double lost_energy( float far, int substeps )
{
    const double angle = 1.0471975511965976;
    const wisp_vec3 points[2] = { { 0.0f, 0.0f, 0.0f }, { (float)sin( angle ), (float)-cos( angle ), 0.0f } };
    const int32_t offsets[2] = { 0, 2 };
    hosted s;
    open_strands( &s, substeps, 1, 1 );
    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = points;
    strands.offsets = offsets;
    strands.strand_count = 1;
    wisp_entity e;
    assert_int_equal( wisp_add_strands( s.world, &strands, &e ), WISP_OK );
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    def.bending = WISP_STRAND_BEND_NONE;
    def.vertex_mass = 1.0f;
    assert_int_equal( wisp_set_strand_dynamics( s.world, e, &def ), WISP_OK );
    assert_int_equal( wisp_request( s.world, e, WISP_STRAND_POINTS ), WISP_OK );
    move_to( &s, e, far, 0.0f );
    double peak = 0.0, last = angle;
    for ( int swings = 0, frame = 0; swings < 6 && frame < 600; ++frame )
    {
        strand_steps( s.world, 1, FRAME );
        const wisp_vec3* p = strand_points( s.world, e );
        const double now = atan2( (double)p[1].x - (double)p[0].x, (double)p[0].y - (double)p[1].y );
        swings += ( now < 0.0 ) != ( last < 0.0 ) ? 1 : 0;
        peak = ( now < 0.0 ) != ( last < 0.0 ) ? 0.0 : fmax( peak, fabs( now ) );
        last = now;
    }
    // the last frame is the first one after the sixth pass through the bottom; let it rise once more
    for ( int frame = 0; frame < 60; ++frame )
    {
        strand_steps( s.world, 1, FRAME );
        const wisp_vec3* p = strand_points( s.world, e );
        peak = fmax( peak, fabs( atan2( (double)p[1].x - (double)p[0].x, (double)p[0].y - (double)p[1].y ) ) );
    }
    close_world( &s );
    return 1.0 - ( 1.0 - cos( peak ) ) / ( 1.0 - cos( angle ) );
}

TEST( a_pendulum_loses_less_energy_in_shorter_substeps )
{
    static const float PLACES[] = { 0.0f, 100.0f, 1000.0f };
    for ( int i = 0; i < WISP_COUNT( PLACES ); ++i )
    {
        double before = lost_energy( PLACES[i], 10 );
        for ( int substeps = 20; substeps <= 640; substeps *= 2 )
        {
            const double lost = lost_energy( PLACES[i], substeps );
            print_message( "%g m out, %d substeps: %.3f %% of the energy lost\n", (double)PLACES[i], substeps,
                           100.0 * lost );
            // an implicit substep loses energy in proportion to its length; peaks are seen to 0.05 % at 60 Hz
            assert_true( lost > 0.0 && lost < 0.55 * before + 5e-4 );
            before = lost;
        }
    }
}
