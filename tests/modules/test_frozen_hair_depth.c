// Frozen hair in 2.5D: with a limit of depth, vertices keep their z or move along it by little, strands turn and clump
// within their layers, and without one nothing of it exists.
#include "frozen_hair_mover.h"
#include "frozen_hair_shadow.h"

static const double u = HAIR_ROUNDING;

// Soft strands in space and a cursor that is not in their layers, so that every stage would move them along z.
static wisp_frozen_hair_def soft_def( float limit )
{
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    def.stretch_stiffness = def.bend_stiffness = 2.0f;
    def.cursor = ( wisp_vec3 ){ 0.1f, -0.1f, 0.4f };
    def.reach = 1.0f;
    def.max_depth_change = limit;
    return def;
}

// After some commands.
static wisp_vec3* run_commands( const hair_groom* groom, const wisp_frozen_hair_def* def, int commands )
{
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    const wisp_entity hair = hair_add_frozen( world, groom, def );
    for ( int n = 0; n < commands; ++n )
    {
        hair_command( world, hair, def->cursor );
        hair_step( world );
    }
    wisp_vec3* points = hair_points( world, hair, groom->vertex_count );
    return points;
}

typedef struct depth_change
{
    double most; // m
    int at_limit;
} depth_change;

static depth_change measure_depth( const wisp_vec3* base, const wisp_vec3* out, int count, double limit )
{
    depth_change c = { 0.0, 0 };
    for ( int v = 0; v < count; ++v )
    {
        const double change = fabs( (double)out[v].z - (double)base[v].z );
        c.most = fmax( c.most, change );
        c.at_limit += fabs( change - limit ) < 1e-7;
    }
    return c;
}

TEST( vertices_move_along_z_by_no_more_than_the_limit )
{
    const float limits[] = { 0.0f, 5e-4f, 3e-3f };
    for ( int n = 0; n < 3 * 3 * WISP_COUNT( limits ); ++n )
    {
        const float limit = limits[n / 9];
        SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( (hair_shape)( n % 3 ), 3, 49, 20, 0.004f );
        wisp_frozen_hair_def def = soft_def( limit );
        def.base = (wisp_frozen_base)( n / 3 % WISP_FROZEN_BASE_COUNT );
        SCOPED( free_local ) wisp_vec3* out = run_commands( &groom, &def, 3 );

        // both ends of the range are rounded, of coordinates below 0.1 m
        const depth_change kept = measure_depth( groom.points, out, groom.vertex_count, (double)limit );
        assert_true( kept.most <= (double)limit + ( limit > 0.0f ? 2.0 * u * 0.1 : 0.0 ) );
        assert_true( n % 3 != HAIR_CURLY || kept.at_limit > 49 );
        free( out );
        def.max_depth_change = -1.0f;
        out = run_commands( &groom, &def, 3 );
        assert_true( measure_depth( groom.points, out, groom.vertex_count, 0.0 ).most > 0.01 );
    }
}

// ---- a layer is a plane ----

// Strands in three planes, 5 cm apart.
static hair_groom layered( hair_shape shape, int dimension )
{
    hair_groom groom = hair_groom_create( shape, 2, 60, 20, 0.002f );
    groom.dimension = dimension;
    for ( int s = 0; s < 60; ++s )
    {
        for ( int v = groom.offsets[s]; v < groom.offsets[s + 1] && dimension == 3; ++v )
        {
            groom.points[v].z = 0.05f * (float)( s % 3 );
        }
    }
    return groom;
}

TEST( a_layer_freezes_and_aligns_as_hair_in_the_plane_bit_for_bit )
{
    for ( int n = 0; n < 12; ++n )
    {
        SCOPED( hair_groom_destroy )
        hair_groom flat = layered( (hair_shape)( n % 3 ), 2 ), deep = layered( (hair_shape)( n % 3 ), 3 );
        wisp_frozen_hair_def def = soft_def( 0.0f );
        def.clump = false;
        def.reach = 0.1f;
        def.reach_nearest = n / 3 % 2 == 1;
        def.base = n / 6 == 1 ? WISP_FROZEN_BASE_STROKE : WISP_FROZEN_BASE_REST;
        SCOPED( free_local ) wisp_vec3* b = run_commands( &deep, &def, 2 );
        def.max_depth_change = n / 3 % 2 == 0 ? -1.0f : 0.0f; // in the plane a limit changes nothing
        SCOPED( free_local ) wisp_vec3* a = run_commands( &flat, &def, 2 );
        int turned = 0;
        for ( int v = 0; v < flat.vertex_count; ++v )
        {
            assert_true( a[v].x == b[v].x && a[v].y == b[v].y && a[v].z == 0.0f && b[v].z == deep.points[v].z );
            turned += hair_distance( a[v], flat.points[v] ) > 0.01;
        }
        assert_true( turned > 60 );
    }
}

// Opposite to the cursor, a strand turns within its layer too.
TEST( a_strand_that_points_away_turns_within_its_layer )
{
    const int counts[] = { 3 };
    const wisp_vec3 points[] = { { 0, 0, 0.2f }, { 0, -0.1f, 0.2f }, { 0, -0.2f, 0.2f } };
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_from( 3, 1, counts, points );
    wisp_frozen_hair_def def = hair_align_only( ( wisp_vec3 ){ 0.0f, 0.3f, -0.7f } );
    def.intensity = 0.5f;
    def.max_depth_change = 0.0f;
    SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
    hair_assert_close( hair_distance( out[2], ( wisp_vec3 ){ 0.0f, 0.2f, 0.2f } ), 0.0, 60.0 * u * 0.2 );
    assert_true( fabs( (double)out[1].x ) > 0.05 && out[1].z == 0.2f && out[2].z == 0.2f );
}

// ---- against the oracle and closed forms ----

// Along z a segment cannot keep a shorter length at its depth, and has no x and y to keep a longer one with.
TEST( segments_along_z_stay_finite_and_are_as_long_as_their_depth )
{
    enum
    {
        strands = 40
    };
    static wisp_vec3 points[3 * strands];
    int counts[strands];
    for ( int v = 0; v < 3 * strands; ++v )
    {
        points[v] = ( wisp_vec3 ){ 0.01f * (float)( v / 3 ), 0.0f, 0.01f * (float)( v % 3 ) };
        counts[v / 3] = 3;
    }
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_from( 3, strands, counts, points );
    for ( int bends = 0; bends <= 1; ++bends )
    {
        wisp_frozen_hair_def def = hair_freeze_only();
        def.stretch_stiffness = 2.0f;
        def.bend_stiffness = bends ? 20.0f : 1e12f;
        def.max_depth_change = 0.0f;
        SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
        hair_assert_finite( out, 3 * strands );
        int shorter = 0;
        for ( int v = 0; v < 3 * strands; ++v )
        {
            assert_true( out[v].z == points[v].z );
            shorter += v % 3 == 1 && hair_distance( out[v], out[v - 1] ) < 0.01 + 1e-8;
        }
        assert_true( bends ? shorter > 10 && shorter < strands : shorter == strands );
    }
}

TEST( freezing_and_aligning_with_a_limit_follow_the_oracle )
{
    double most = 0.0;
    for ( int n = 0; n < 3 * 3 * 2; ++n )
    {
        const float limits[] = { 0.0f, 5e-4f, 3e-3f };
        SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( (hair_shape)( n % 3 ), 3, 30, 20, 0.008f );
        wisp_frozen_hair_def def = soft_def( limits[n / 3 % 3] );
        def.stretch_stiffness = def.bend_stiffness = 7.0f;
        def.clump = false;
        def.reach = n / 9 == 1 ? 0.12f : 1.0f;
        SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
        SCOPED( hair_oracle_destroy ) hair_oracle oracle = hair_oracle_create( &groom, &def, 0 );
        SCOPED( free_local ) double3* expected = hair_new_points( groom.vertex_count );
        assert_int_equal( frozen_oracle_run( &oracle.hair, &oracle.options, NULL, expected ), WISP_OK );
        for ( int v = 0; v < groom.vertex_count; ++v )
        {
            most = fmax( most, double3_distance( expected[v], double3_widen( out[v] ) ) );
        }
    }
    // an angle within 1e-6 rad on strands of 0.14 m, coordinates of 0.5 m, and roots of differences of squares
    print_message( "           %.2g m off\n", most );
    assert_true( most < 1e-6 );
}

TEST( clumping_with_a_limit_follows_the_oracle )
{
    double fraction = 0.0;
    for ( int n = 0; n < 6; ++n )
    {
        SCOPED( hair_groom_destroy )
        hair_groom groom = hair_groom_create( n % 3 == 0 ? HAIR_WAVY : HAIR_CURLY, 3, 25, 10, 0.004f );
        wisp_frozen_hair_def def = hair_clump_only();
        def.gap = (wisp_gap)( n / 3 );
        def.max_depth_change = 0.0f;
        const hair_shadow shadow = hair_follow( NULL, &groom, &def, 0 );
        assert_true( shadow.neighbours > 1000 );
        fraction = fmax( fraction, shadow.fraction );
    }
    print_message( "           %.0f %% of the tolerance\n", 100.0 * fraction );
    assert_true( fraction > 0.0 );
}

// ---- moved strands, and none ----

TEST( depth_is_counted_from_where_a_head_moved_the_strands )
{
    const wisp_transform pose = { { 0.70710678f, 0.0f, 0.0f, 0.70710678f }, { 0.1f, 0.0f, 0.5f } };
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_CURLY, 3, 49, 20, 0.004f );
    wisp_frozen_hair_def def = soft_def( 1e-3f );
    def.update_on = WISP_FROZEN_UPDATE_FRAME;
    SCOPED( destroy_local ) wisp_world* world;
    const wisp_entity hair = moved_hair( &world, &groom, &def, pose );
    hair_step( world );
    SCOPED( free_local ) wisp_vec3* moved = checked_calloc( (size_t)groom.vertex_count, sizeof( wisp_vec3 ) );
    for ( int v = 0; v < groom.vertex_count; ++v )
    {
        moved[v] = wisp_transform_to_world( pose, groom.points[v] );
    }
    const wisp_vec3* out = hair_view( world, hair, groom.vertex_count );
    const depth_change c = measure_depth( moved, out, groom.vertex_count, 1e-3 );
    assert_true( c.most < 1e-3 + 8.0 * u && c.at_limit > 49 );
    assert_true( measure_depth( groom.points, out, groom.vertex_count, 0.0 ).most > 0.3 );
}

TEST( a_limit_that_is_taken_away_leaves_no_pass_and_no_bit )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_CURLY, 3, 30, 20, 0.005f );
    wisp_frozen_hair_def def = soft_def( -1.0f );
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    const wisp_entity hair = hair_add_frozen( world, &groom, &def );
    hair_step( world );
    const uint64_t hash = wisp_world_hash( world );
    const int passes = wisp_world_plan_passes( world );
    def.max_depth_change = 0.001f;
    hair_set( world, hair, &def );
    assert_int_equal( wisp_world_plan_passes( world ), passes + 1 );
    hair_step( world );
    assert_true( wisp_world_hash( world ) != hash );
    def.max_depth_change = -1.0f;
    hair_set( world, hair, &def );
    assert_int_equal( wisp_world_plan_passes( world ), passes );
    assert_int_equal( wisp_replay_frozen_hair( world, hair, def.cursor, 0 ), WISP_OK );
    hair_step( world );
    assert_int_equal( wisp_world_hash( world ), hash );
}
