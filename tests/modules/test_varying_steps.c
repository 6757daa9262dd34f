// Steps whose length varies: a long one is as many usual ones, and snapshots. What rests at any is in tests/claims/uneven.yaml.
#include "effects_fixture.h"

static float from_20_to_1000_hz( int number )
{
    return 0.05f * powf( 0.02f, test_random_float( number, 77, 0.0f, 1.0f ) );
}

typedef struct subject
{
    const char* name;
    effect_setup* add;
} subject;

static const subject SUBJECTS[] = {
    { "cloth with bend links", cloth_of_links },
    { "cloth with dihedral bending", dihedral_cloth },
    { "cloth with isometric bending", isometric_cloth },
    { "implicit cloth", implicit_cloth },
    { "balloon", balloon },
    { "strands of links", hair_of_links },
    { "strands of rods", hair_of_rods },
};

static void open_for_long_steps( hosted* h, int longest )
{
    OPEN( h, EFFECTS, .substeps = 10, .longest_step = longest );
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
        assert_status( h.world, wisp_world_step( h.world, from_20_to_1000_hz( i ) ), WISP_OK );
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
            assert_status( h.world, wisp_world_step( h.world, from_20_to_1000_hz( i ) ), WISP_OK );
        }
        hashes[k] = wisp_world_hash( h.world );
    }
    assert_true( hashes[0] == hashes[1] );
    memset( bytes + full - sizeof( step_clock ), 0xff, sizeof( step_clock ) );
    assert_status( h.world, wisp_world_restore( h.world, bytes, full ), WISP_BAD_INPUT );
    assert_true( wisp_world_hash( h.world ) == hashes[1] );
}
