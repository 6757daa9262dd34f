// Frozen hair keeps its shape between commands (Kim 2026, section III.3): frames without a command change no bit, whatever
// else the world does, and a command changes what it reaches and leaves what was shaped before.
#include "frozen_hair_mover.h"

enum
{
    STRANDS = 80,
    VERTICES = 20,
    COUNT = STRANDS * VERTICES,
};

static wisp_frozen_hair_def stroke_def( void )
{
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    def.base = WISP_FROZEN_BASE_STROKE;
    def.reach = 0.06f;
    return def;
}

// Strands in the plane over 32 cm, so that the two ends are far out of each other's reach.
static hair_groom wide_groom( void )
{
    return hair_groom_create( HAIR_WAVY, 2, STRANDS, VERTICES, 0.004f );
}

// Ten commands over the tips of strands [first, last), each turned to its right.
static void sweep( wisp_world* world, wisp_entity hair, const hair_groom* groom, int first, int last )
{
    for ( int n = 0; n < 10; ++n )
    {
        const wisp_vec3 tip = groom->points[( first + ( last - first ) * n / 10 ) * VERTICES + VERTICES - 1];
        hair_command( world, hair, ( wisp_vec3 ){ tip.x + 0.04f, tip.y + 0.02f, tip.z } );
        hair_step( world );
    }
}

static int count_changed( const wisp_vec3* a, const wisp_vec3* b, int first, int last )
{
    int changed = 0;
    for ( int s = first; s < last; ++s )
    {
        changed += !hair_same_bits( a + s * VERTICES, b + s * VERTICES, VERTICES );
    }
    return changed;
}

TEST( frames_without_a_command_change_no_bit_after_any_command )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = wide_groom();
    for ( int base = WISP_FROZEN_BASE_REST; base < WISP_FROZEN_BASE_COUNT; ++base )
    {
        wisp_frozen_hair_def def = stroke_def();
        def.base = (wisp_frozen_base)base;
        SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
        const wisp_entity hair = hair_add_frozen( world, &groom, &def );
        for ( int command = 0; command < 4; ++command )
        {
            sweep( world, hair, &groom, 20 * command, 20 * command + 20 );
            SCOPED( free_local ) wisp_vec3* shaped = hair_points( world, hair, COUNT );
            const uint64_t hash = wisp_world_hash( world );
            for ( int frame = 0; frame < 30; ++frame )
            {
                hair_step( world );
                assert_true( hair_same_bits( hair_view( world, hair, COUNT ), shaped, COUNT ) );
            }
            assert_int_equal( wisp_world_hash( world ), hash );
        }
    }
}

TEST( a_second_stroke_elsewhere_leaves_what_the_first_shaped )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = wide_groom();
    wisp_frozen_hair_def def = stroke_def();
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    const wisp_entity hair = hair_add_frozen( world, &groom, &def );
    hair_step( world );
    SCOPED( free_local ) wisp_vec3* before = hair_points( world, hair, COUNT );
    sweep( world, hair, &groom, 0, 20 );
    SCOPED( free_local ) wisp_vec3* first = hair_points( world, hair, COUNT );
    assert_true( count_changed( before, first, 0, 20 ) == 20 );
    for ( int frame = 0; frame < 10; ++frame )
    {
        hair_step( world );
    }
    sweep( world, hair, &groom, 60, 80 );
    const wisp_vec3* second = hair_view( world, hair, COUNT );

    // neighbours of swept strands clump with them, 1 cm and so three strands further on each iteration
    assert_int_equal( count_changed( first, second, 0, 30 ), 0 );
    assert_int_equal( count_changed( first, second, 60, 80 ), 20 );

    // from rest, the second would have undone the first
    def.base = WISP_FROZEN_BASE_REST;
    hair_set( world, hair, &def );
    sweep( world, hair, &groom, 60, 80 );
    assert_int_equal( count_changed( first, hair_view( world, hair, COUNT ), 0, 20 ), 20 );
}

// ---- a head that moves ----

static double most_apart( const wisp_vec3* still, const wisp_vec3* moved, wisp_transform pose )
{
    double most = 0.0;
    for ( int v = 0; v < COUNT; ++v )
    {
        most = fmax( most, hair_distance( wisp_transform_to_world( pose, still[v] ), moved[v] ) );
    }
    return most;
}

// A head that turns about its vertical axis and nods, and is back after thirty frames.
static wisp_transform pose_at( int frame )
{
    const float half = 0.02f * (float)( frame < 15 ? frame : 30 - frame );
    return wisp_transform_make( ( wisp_quat ){ 0.0f, 3.0f * sinf( half ), sinf( half ), cosf( half ) },
                                ( wisp_vec3 ){ 0.5f * half, half, 0.0f } );
}

// The shape stays on the head in each frame of a move, is the same bits where the head is back, and a stroke on the moved head
// leaves the first one.
TEST( a_shape_follows_a_moving_head_and_is_the_same_when_it_is_back )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = wide_groom();
    groom.dimension = 3;
    wisp_frozen_hair_def def = stroke_def();
    def.bend_stiffness = 1e9f;                // first segments bend about random axes in the world
    def.update_on = WISP_FROZEN_UPDATE_FRAME; // as for all strands that another module moves
    def.clump = false;                        // its neighbours are added by cells of the world
    SCOPED( destroy_local ) wisp_world* world;
    const wisp_entity hair = moved_hair( &world, &groom, &def, pose_at( 0 ) );
    sweep( world, hair, &groom, 0, 20 );
    SCOPED( free_local ) wisp_vec3* shaped = hair_points( world, hair, COUNT );
    assert_true( most_apart( groom.points, shaped, pose_at( 0 ) ) > 0.05 );
    double moved = 0.0;
    for ( int frame = 1; frame <= 30; ++frame )
    {
        set_pose( world, hair, pose_at( frame ) );
        hair_step( world );

        // vectors of 0.14 m are stored, turned and used as floats, on coordinates below 0.6 m
        const wisp_vec3* now = hair_view( world, hair, COUNT );
        hair_assert_close( most_apart( shaped, now, pose_at( frame ) ), 0.0, 1e-6 );
        moved = fmax( moved, most_apart( shaped, now, pose_at( 0 ) ) );
    }
    assert_true( moved > 0.1 );
    assert_true( hair_same_bits( hair_view( world, hair, COUNT ), shaped, COUNT ) );

    set_pose( world, hair, pose_at( 10 ) );
    for ( int n = 0; n < 10; ++n )
    {
        const wisp_vec3 tip = groom.points[( 60 + 2 * n ) * VERTICES + VERTICES - 1];
        hair_command( world, hair,
                      wisp_transform_to_world( pose_at( 10 ), ( wisp_vec3 ){ tip.x + 0.04f, tip.y + 0.02f, 0.0f } ) );
        hair_step( world );
    }
    set_pose( world, hair, pose_at( 30 ) );
    hair_step( world );
    const wisp_vec3* both = hair_view( world, hair, COUNT );
    assert_int_equal( count_changed( shaped, both, 0, 40 ), 0 );
    assert_int_equal( count_changed( shaped, both, 60, 80 ), 20 );
}
