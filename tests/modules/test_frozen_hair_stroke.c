// Strokes of frozen hair: many commands in a row, of which each strand keeps the last one that reached it.
#include "frozen_hair_mover.h"

#include <math.h>

static wisp_frozen_hair_def stroke_def( void )
{
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    def.base = WISP_FROZEN_BASE_STROKE;
    def.reach = 0.05f;
    return def;
}

// A cursor that wanders over the tips of a groom.
static wisp_vec3 path( const hair_groom* groom, int command, int commands )
{
    const int strand = command * ( groom->strand_count - 1 ) / ( commands > 1 ? commands - 1 : 1 );
    const wisp_vec3 tip = groom->points[groom->offsets[strand + 1] - 1];
    const double angle = 2.4 * command;
    return ( wisp_vec3 ){ tip.x + 0.02f * (float)sin( angle ), tip.y + 0.03f * (float)cos( angle ), tip.z };
}

static wisp_vec3* run_stroke( const hair_groom* groom, const wisp_frozen_hair_def* def, int commands )
{
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    const wisp_entity hair = hair_add_frozen( world, groom, def );
    for ( int n = 0; n < commands; ++n )
    {
        hair_command( world, hair, path( groom, n, commands ) );
        hair_step( world );
    }
    wisp_vec3* points = hair_points( world, hair, groom->vertex_count );
    return points;
}

// ---- against the oracle ----

typedef struct oracle_stroke
{
    frozen_oracle_stroke kept;
    bool* unsure; // [strand] a tip was so near to the edge of the reach that rounding decides
} oracle_stroke;

static oracle_stroke new_stroke( int strands )
{
    oracle_stroke s = { .kept = { .target = calloc( (size_t)strands, sizeof( double3 ) ),
                                  .intensity = calloc( (size_t)strands, sizeof( double ) ),
                                  .axis = double3_make( 0.0, 0.0, 1.0 ) },
                        .unsure = calloc( (size_t)strands, sizeof( bool ) ) };
    assert_true( s.kept.target && s.kept.intensity && s.unsure );
    return s;
}

static void free_stroke( oracle_stroke* s )
{
    free( s->kept.target );
    free( s->kept.intensity );
    free( s->unsure );
}

// Freeze and align of one update in double precision. @param seen the engine's points before it
static void oracle_update( hair_oracle* o, oracle_stroke* s, bool sweeps, const wisp_vec3* seen, double3* out )
{
    SCOPED( free_local ) double3* p = hair_new_points( o->vertex_count );
    frozen_oracle_deform( &o->hair, &o->options, p );
    for ( int strand = 0; strand < o->hair.strand_count; ++strand )
    {
        for ( int v = o->hair.offsets[strand]; v < o->hair.offsets[strand + 1]; ++v )
        {
            const double d = double3_distance( double3_widen( seen[v] ), o->options.cursor );
            s->unsure[strand] = s->unsure[strand] || fabs( d - o->options.cursor_radius ) < 1e-5;
        }
        frozen_oracle_align_in_stroke( &o->hair, &o->options, &s->kept, sweeps, strand, p, out );
    }
}

// Parameters of update n: all that a user may change in a stroke, and updates that are no commands.
static wisp_frozen_hair_def changed_def( int n, int variant )
{
    wisp_frozen_hair_def def = stroke_def();
    def.clump = false;
    def.reach_nearest = variant % 2 == 1;
    def.intensity = (float)( n % 5 ) * 0.25f;
    def.reach = 0.02f + 0.01f * (float)( n % 4 );
    def.stretch_stiffness = def.bend_stiffness = n % 7 > 3 ? 3.0f : 7.0f;
    def.seed = n > 20 ? 2 : 1;
    return def;
}

TEST( a_stroke_with_changing_parameters_follows_the_oracle )
{
    for ( int variant = 0; variant < 12; ++variant )
    {
        SCOPED( hair_groom_destroy )
        hair_groom groom = hair_groom_create( (hair_shape)( variant % 3 ), 2 + variant / 6, 60, 20, 0.004f );
        wisp_frozen_hair_def def = changed_def( 0, variant );
        SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
        const wisp_entity hair = hair_add_frozen( world, &groom, &def );
        hair_step( world );
        SCOPED( free_stroke ) oracle_stroke s = new_stroke( 60 );
        int reached = 0, unsure = 0;
        for ( int n = 0; n < 30; ++n )
        {
            def = changed_def( n, variant );
            const bool sweeps = n % 6 != 5;
            hair_set( world, hair, &def );
            hair_step( world ); // the shape that the cursor meets
            SCOPED( free_local ) wisp_vec3* seen = hair_points( world, hair, groom.vertex_count );
            def.cursor = path( &groom, n, 30 );
            if ( sweeps )
            {
                hair_command( world, hair, def.cursor );
            }
            hair_step( world );
            SCOPED( hair_oracle_destroy ) hair_oracle o = hair_oracle_create( &groom, &def, 0 );
            SCOPED( free_local ) double3* expected = hair_new_points( groom.vertex_count );
            oracle_update( &o, &s, sweeps, seen, expected );
            const wisp_vec3* points = hair_view( world, hair, groom.vertex_count );
            for ( int v = 0; v < groom.vertex_count; ++v )
            {
                // coordinates below 0.5 m round by 3e-8, an angle by 1e-6 rad on a strand of 0.14 m
                if ( !s.unsure[v / 20] )
                {
                    hair_assert_close( double3_distance( double3_widen( points[v] ), expected[v] ), 0.0, 1e-6 );
                }
            }
        }
        for ( int strand = 0; strand < 60; ++strand )
        {
            reached += double3_length( s.kept.target[strand] ) > 0.0;
            unsure += s.unsure[strand];
        }
        assert_true( reached == 60 && unsure < 20 );
    }
}

// ---- parameters in the middle of a stroke ----

TEST( clumping_is_on_the_result_and_is_not_fed_back )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 3, 60, 20, 0.004f );
    wisp_frozen_hair_def def = stroke_def();
    SCOPED( free_local ) wisp_vec3* always = run_stroke( &groom, &def, 30 );
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    def.clump = false;
    const wisp_entity hair = hair_add_frozen( world, &groom, &def );
    for ( int n = 0; n < 30; ++n )
    {
        hair_command( world, hair, path( &groom, n, 30 ) );
        hair_step( world );
    }
    SCOPED( free_local ) wisp_vec3* unclumped = hair_points( world, hair, 1200 );
    def.clump = true;
    hair_set( world, hair, &def );
    hair_step( world );
    assert_true( hair_same_bits( hair_view( world, hair, 1200 ), always, 1200 ) );
    assert_false( hair_same_bits( unclumped, always, 1200 ) );
}

// ---- beginning, repeating, undoing ----

TEST( a_new_stroke_forgets_alignment_and_draws_other_noise )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 2, 40, 20, 0.004f );
    wisp_frozen_hair_def def = stroke_def();
    def.reach = 1.0f;
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    const wisp_entity hair = hair_add_frozen( world, &groom, &def );
    hair_step( world );
    SCOPED( free_local ) wisp_vec3* unswept = hair_points( world, hair, 800 );
    hair_command( world, hair, ( wisp_vec3 ){ 0.2f, 0.0f, 0.0f } );
    hair_step( world );
    SCOPED( free_local ) wisp_vec3* swept = hair_points( world, hair, 800 );
    assert_int_equal( wisp_begin_frozen_hair_stroke( world, hair ), WISP_OK );
    hair_step( world );
    SCOPED( free_local ) wisp_vec3* again = hair_points( world, hair, 800 );
    int same_noise = 0;
    for ( int v = 0; v < 800; ++v )
    {
        // both without alignment, with other noise: 7 mm segments differ by a seventh of that at most each
        assert_true( hair_distance( again[v], unswept[v] ) < 0.04 );
        same_noise += v % 20 > 0 && hair_same_bits( again + v, unswept + v, 1 );
    }
    assert_int_equal( same_noise, 0 );

    // by the number of its first update a stroke is drawn again
    assert_int_equal( wisp_replay_frozen_hair( world, hair, ( wisp_vec3 ){ 0.2f, 0.0f, 0.0f }, 0 ), WISP_OK );
    hair_step( world );
    assert_true( hair_same_bits( hair_view( world, hair, 800 ), swept, 800 ) );

    // another base ends a stroke
    def.base = WISP_FROZEN_BASE_REST;
    hair_set( world, hair, &def );
    def.base = WISP_FROZEN_BASE_STROKE;
    hair_set( world, hair, &def );
    def.clump = false;
    hair_step( world );
    for ( int v = 0; v < 800; ++v )
    {
        assert_true( hair_distance( hair_view( world, hair, 800 )[v], unswept[v] ) < 0.04 );
    }
}

TEST( a_stroke_that_is_none_is_refused )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 2, 10, 20, 0.004f );
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    const wisp_entity bare = hair_add( world, &groom ), hair = hair_add_frozen( world, &groom, &def );
    const wisp_entity none = { 0, 0 };
    hair_step( world );
    const uint64_t hash = wisp_world_hash( world );
    assert_int_equal( wisp_begin_frozen_hair_stroke( world, hair ), WISP_CONFLICT );
    assert_contains( wisp_world_message( world ), "base of its frozen hair is not 'stroke'" );
    assert_int_equal( wisp_begin_frozen_hair_stroke( world, bare ), WISP_CONFLICT );
    assert_contains( wisp_world_message( world ), "no frozen hair" );
    assert_int_equal( wisp_begin_frozen_hair_stroke( world, none ), WISP_STALE_ID );
    hair_step( world );
    assert_int_equal( wisp_world_hash( world ), hash );
}

// ---- strands that another module moves ----

// How a head may turn: about the direction in which its strands hang, among others, and by almost half a turn.
static const wisp_transform poses[] = {
    { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } },
    { { 0.0f, 0.0f, 0.70710678f, 0.70710678f }, { 0.1f, 0.2f, 0.0f } },
    { { 0.0f, 0.0f, -0.99619470f, 0.08715574f }, { 0.0f, 0.1f, 0.0f } },
    { { 0.0f, 0.70710678f, 0.0f, 0.70710678f }, { 0.0f, 0.0f, 0.3f } },
    { { 0.0f, 0.99619470f, 0.0f, 0.08715574f }, { 0.0f, 0.0f, 0.0f } },
    { { 0.5f, -0.5f, 0.5f, 0.5f }, { -0.2f, 0.0f, 0.1f } },
};

// A stroke on a head that turns is the stroke on one that stands, turned along. In space, bends of straight strands have
// random axes in the world, so the strands are wavy or hardly bend.
TEST( a_stroke_turns_along_with_the_head )
{
    for ( int n = 0; n < 4 * WISP_COUNT( poses ); ++n )
    {
        const int dimension = 2 + n % 2;
        const wisp_transform pose = poses[n / 4];
        if ( dimension == 2 && pose.rotation.y != 0.0f )
        {
            continue;
        }
        SCOPED( hair_groom_destroy )
        hair_groom groom = hair_groom_create( n / 2 % 2 ? HAIR_WAVY : HAIR_STRAIGHT, dimension, 49, 20, 0.008f );
        wisp_frozen_hair_def def = stroke_def();
        def.update_on = WISP_FROZEN_UPDATE_FRAME;
        def.clump = false;
        def.bend_stiffness = 1e9f;
        SCOPED( destroy_local ) wisp_world *still, *moved;
        const wisp_entity a = moved_hair( &still, &groom, &def, poses[0] ),
                          b = moved_hair( &moved, &groom, &def, poses[0] );
        for ( int k = 0; k < 12; ++k )
        {
            // the second half of the stroke is swept with the head turned, with the cursor at the same place of the head
            const wisp_vec3 cursor = path( &groom, k, 12 );
            hair_command( still, a, cursor );
            hair_step( still );
            set_pose( moved, b, k < 6 ? poses[0] : pose );
            hair_command( moved, b, k < 6 ? cursor : wisp_transform_to_world( pose, cursor ) );
            hair_step( moved );
        }
        int turned = 0;
        for ( int v = 0; v < groom.vertex_count; ++v )
        {
            // directions of 0.14 m are stored, turned and used as floats; the quaternion has their digits, too
            const wisp_vec3 expected = wisp_transform_to_world( pose, hair_view( still, a, groom.vertex_count )[v] );
            hair_assert_close( hair_distance( expected, hair_view( moved, b, groom.vertex_count )[v] ), 0.0, 1e-6 );
            turned += hair_distance( hair_view( still, a, groom.vertex_count )[v], groom.points[v] ) > 0.04;
        }
        assert_true( turned > 20 );
    }
}
