// Steps whose length varies: what rests at constant steps rests, and nothing gains energy.
#include "effects_fixture.h"

// ---- sequences of steps ----

typedef double sequence( int number );

static double uniform( int number )
{
    return (double)test_random_float( number, 77, 0.0f, 1.0f );
}

static double ten_percent_about_60_hz( int number )
{
    return ( 0.9 + 0.2 * uniform( number ) ) / 60.0;
}

static double from_30_to_120_hz( int number )
{
    return 1.0 / ( 30.0 + 90.0 * uniform( number ) );
}

static double from_24_to_240_hz( int number )
{
    return 1.0 / ( 24.0 + 216.0 * uniform( number ) );
}

static double from_20_to_1000_hz( int number )
{
    return 0.05 * pow( 0.02, uniform( number ) );
}

static double in_turns_of_30_and_120_hz( int number )
{
    return number % 2 == 0 ? 1.0 / 30.0 : 1.0 / 120.0;
}

static double sixty_hz_with_hitches( int number )
{
    return number % 41 == 40 ? 0.2 : 1.0 / 60.0;
}

static sequence* const SEQUENCES[] = { ten_percent_about_60_hz, from_30_to_120_hz,         from_24_to_240_hz,
                                       from_20_to_1000_hz,      in_turns_of_30_and_120_hz, sixty_hz_with_hitches };

typedef struct subject
{
    const char* name;
    effect_setup* add;
    double rest; // m/s, beyond which it does not rest
} subject;

// Twice what the subject has at constant steps, or a centimetre per second.
static const subject SUBJECTS[] = {
    { "cloth with bend links", cloth_of_links, 0.01 },
    { "cloth with dihedral bending", dihedral_cloth, 0.01 },
    { "cloth with isometric bending", isometric_cloth, 0.01 },
    { "implicit cloth", implicit_cloth, 0.01 },
    { "balloon", balloon, 0.01 },
    { "strands of links", hair_of_links, 0.01 },
    { "strands of rods", hair_of_rods, 0.01 },
};

typedef struct outcome
{
    double speed;  // m/s, largest after 8 s
    double energy; // J, largest
    double fall;   // J, potential energy lost
    uint64_t hash;
} outcome;

// Run a sequence; with `is_constant` at the length of its first step.
static outcome run( const subject* s, sequence* dt_of, bool is_constant, int substeps, int workers )
{
    hosted h = { 0 };
    h.def = hosted_def( &h );
    h.def.modules = EFFECTS;
    h.def.module_count = WISP_COUNT( EFFECTS );
    h.def.substeps = substeps;
    h.def.workers = workers;
    assert_int_equal( wisp_world_create( &h.def, &h.world, NULL ), WISP_OK );
    const wisp_entity e = s->add( h.world );
    assert_status( h.world, wisp_request( h.world, e, WISP_MOTION_STATS ), WISP_OK );
    outcome out = { .energy = -INFINITY };
    double time = 0.0;
    for ( int i = 0; time < 9.0; ++i )
    {
        const float dt = (float)dt_of( is_constant ? 0 : i );
        time += (double)dt;
        assert_status( h.world, wisp_world_step( h.world, dt ), WISP_OK );
        const wisp_motion_stats m = motion_stats_of( h.world, e );
        out.energy = fmax( out.energy, m.kinetic_energy + m.potential_energy );
        out.fall = -m.potential_energy;
        out.speed = time > 8.0 ? fmax( out.speed, m.speed_max ) : 0.0;
    }
    assert_false( wisp_is_halted( h.world, e ) );
    out.hash = wisp_world_hash( h.world );
    wisp_world_destroy( h.world );
    assert_host_memory_is_released( &h.host );
    return out;
}

TEST( what_rests_at_constant_steps_rests_at_any )
{
    const int substeps[] = { 8, 20 };
    for ( int n = 0; n < WISP_COUNT( SUBJECTS ); ++n )
    {
        for ( int k = 0; k < ( n == 0 ? 2 : 1 ); ++k )
        {
            const subject* s = SUBJECTS + n;
            for ( int q = k == 0 ? 0 : 2; q < ( k == 0 ? WISP_COUNT( SEQUENCES ) : 4 ); ++q )
            {
                const outcome still = run( s, SEQUENCES[q], true, substeps[k], 1 );
                const outcome o = run( s, SEQUENCES[q], false, substeps[k], 1 );
                if ( !( o.speed < fmax( s->rest, 2.0 * still.speed ) ) ||
                     !( o.energy < still.energy + 0.05 * fmax( still.fall, still.energy ) + 1e-7 ) )
                {
                    fail_msg(
                        "%s, %d substeps, sequence %d: %.4g m/s at rest (%.4g at constant steps), energy %.4g J "
                        "(%.4g)",
                        s->name, substeps[k], q, o.speed, still.speed, o.energy, still.energy );
                }
            }
        }
    }
}

static void open_for_long_steps( hosted* h, int longest )
{
    *h = ( hosted ){ 0 };
    h->def = hosted_def( h );
    h->def.modules = EFFECTS;
    h->def.module_count = WISP_COUNT( EFFECTS );
    h->def.substeps = 10;
    h->def.longest_step = longest;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
}

// Run usual steps, then `longest` of them or one step of ten seconds, then usual ones again.
static uint64_t run_past_a_hitch( const subject* s, bool has_hitch, int longest )
{
    hosted h;
    open_for_long_steps( &h, longest );
    const wisp_entity e = s->add( h.world );
    const wisp_contact_def contact = wisp_default_contact_def();
    if ( s == SUBJECTS )
    {
        assert_status( h.world, wisp_set_contact( h.world, e, &contact ), WISP_OK );
    }
    assert_status( h.world, wisp_request( h.world, e, WISP_MOTION_STATS ), WISP_OK );
    for ( int i = 0; i < 20 + ( has_hitch ? 1 : longest ) + 20; ++i )
    {
        const float dt = has_hitch && i == 20 ? 10.0f : 1.0f / 60.0f;
        assert_status( h.world, wisp_world_step( h.world, dt ), WISP_OK );
    }
    assert_int_equal( wisp_world_counter( h.world, WISP_COUNT_CUT_STEPS ), has_hitch && longest < 600 ? 1 : 0 );
    const uint64_t hash = wisp_world_hash( h.world );
    wisp_world_destroy( h.world );
    return hash;
}

// A long step is so many usual ones, bit for bit, and leaves nothing behind.
TEST( a_long_step_is_that_of_as_many_usual_ones )
{
    const int longest[] = { 8, 600 };
    for ( int n = 0; n < WISP_COUNT( SUBJECTS ); ++n )
    {
        for ( int k = 0; k < WISP_COUNT( longest ); ++k )
        {
            if ( run_past_a_hitch( SUBJECTS + n, true, longest[k] ) !=
                 run_past_a_hitch( SUBJECTS + n, false, longest[k] ) )
            {
                fail_msg( "%s: a step of 10 s, cut to %d, is not that of usual ones", SUBJECTS[n].name, longest[k] );
            }
        }
    }
}

enum
{
    LONG = 120, // usual steps
};

// A floor rises by 1 m, and the pins of a cloth above it go 1 m aside, in one long step or in many. @return the impulse on the floor
static double push( bool is_one_step, wisp_vec3* points, int count )
{
    hosted h;
    open_for_long_steps( &h, 1000 );
    const wisp_entity e = cloth_of_links( h.world );
    const wisp_collision_def collision = wisp_default_collision_def();
    wisp_collider_def floor = wisp_default_collider_def();
    floor.kind = WISP_COLLIDER_PLANE;
    floor.pose.translation.y = -1.5f;
    wisp_entity body;
    assert_status( h.world, wisp_add_collider( h.world, &floor, &body ), WISP_OK );
    assert_status( h.world, wisp_set_collision( h.world, e, &collision ), WISP_OK );
    assert_status( h.world, wisp_request_reaction( h.world, body, true ), WISP_OK );
    assert_status( h.world, wisp_request( h.world, e, WISP_SURFACE_POINTS ), WISP_OK );
    assert_status( h.world, wisp_world_step( h.world, 1.0f / 60.0f ), WISP_OK );
    const int32_t pins[2] = { 0, 20 };
    double impulse = 0.0;
    for ( int i = 1; i <= LONG + 60; i += is_one_step && i == 1 ? LONG : 1 )
    {
        const float part = is_one_step || i > LONG ? 1.0f : (float)i / (float)LONG;
        const wisp_vec3 targets[2] = { { 0.0f, 0.0f, part }, { 1.0f, 0.0f, part } };
        floor.pose.translation.y = part - 1.5f;
        assert_status( h.world, wisp_move_pins( h.world, e, pins, targets, 2 ), WISP_OK );
        assert_status( h.world, wisp_move_collider( h.world, body, floor.pose ), WISP_OK );
        assert_status( h.world, wisp_world_step( h.world, ( is_one_step && i == 1 ? (float)LONG : 1.0f ) / 60.0f ),
                       WISP_OK );
        wisp_reaction r;
        assert_status( h.world, wisp_read_reaction( h.world, body, &r ), WISP_OK );
        impulse += i <= LONG ? (double)r.impulse.y : 0.0;
    }
    const wisp_view view = view_of( h.world, e, WISP_SURFACE_POINTS );
    memcpy( points, view.data, (size_t)count * sizeof( wisp_vec3 ) );
    wisp_world_destroy( h.world );
    return impulse;
}

// Targets go steadily, and impulses are those of the whole step. Roundings of targets grow with the creases of the cloth.
TEST( a_long_step_moves_pins_and_colliders_as_many_usual_ones_do )
{
    static wisp_vec3 one[21 * 21], many[21 * 21];
    const double a = push( true, one, 21 * 21 ), b = push( false, many, 21 * 21 );
    assert_near( a, b, 1e-3 * fabs( b ) );
    double farthest = 0.0;
    for ( int i = 0; i < 21 * 21; ++i )
    {
        farthest = fmax( farthest, vec_distance( one[i], many[i] ) );
    }
    assert_true( farthest < 1e-3 ); // of 1 m
}

// A snapshot between two uneven steps holds the time that no substep has covered yet.
TEST( a_snapshot_goes_on_at_varying_steps )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, 4, 1 );
    const wisp_entity e = cloth_of_links( h.world );
    assert_status( h.world, wisp_request( h.world, e, WISP_SURFACE_POINTS ), WISP_OK );
    uint64_t hashes[2];
    const size_t size = wisp_world_snapshot_size( h.world );
    for ( int i = 0; i < 33; ++i )
    {
        assert_status( h.world, wisp_world_step( h.world, (float)from_20_to_1000_hz( i ) ), WISP_OK );
    }
    SCOPED( free_local ) char* bytes = malloc( wisp_world_snapshot_size( h.world ) );
    const size_t full = wisp_world_snapshot_size( h.world );
    assert_true( bytes != NULL && full >= size );
    assert_status( h.world, wisp_world_snapshot( h.world, bytes, full ), WISP_OK );
    for ( int k = 0; k < 2; ++k )
    {
        assert_status( h.world, wisp_world_restore( h.world, bytes, full ), WISP_OK );
        for ( int i = 33; i < 50; ++i )
        {
            assert_status( h.world, wisp_world_step( h.world, (float)from_20_to_1000_hz( i ) ), WISP_OK );
        }
        hashes[k] = wisp_world_hash( h.world );
    }
    assert_true( hashes[0] == hashes[1] );
    memset( bytes + full - sizeof( step_clock ), 0xff, sizeof( step_clock ) );
    assert_status( h.world, wisp_world_restore( h.world, bytes, full ), WISP_BAD_INPUT );
    assert_true( wisp_world_hash( h.world ) == hashes[1] );
}

// Pins that are moved at 1 m/s are at most a substep behind their targets, and their cloth with them.
TEST( pins_keep_up_at_varying_steps )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, 8, 1 );
    const wisp_entity e = cloth_of_links( h.world );
    assert_status( h.world, wisp_request( h.world, e, WISP_SURFACE_POINTS ), WISP_OK );
    const int32_t pins[2] = { 0, 20 };
    double time = 0.0;
    for ( int i = 0; i < 300; ++i )
    {
        const float dt = (float)from_30_to_120_hz( i );
        time += (double)dt;
        const wisp_vec3 targets[2] = { { (float)time, 0, 0 }, { (float)time + 1.0f, 0, 0 } };
        assert_status( h.world, wisp_move_pins( h.world, e, pins, targets, 2 ), WISP_OK );
        assert_status( h.world, wisp_world_step( h.world, dt ), WISP_OK );
        assert_near( (double)point_of( h.world, e, 0 ).x, time, 5e-3 );
        assert_true( fabs( (double)velocity_of( h.world, e, 20 )[0] ) < 1.2 );
    }
}
