// The third stage of the engine, clump, against the double oracle: every switch, zero to twelve iterations, lists
// that must be rebuilt, limits that must be reported (frozen_hair_shadow.h describes the tolerances).
#include "clumping.h"
#include "frozen_hair_shadow.h"

static void say( const char* what, hair_shadow s )
{
    print_message( "           %s: %.2g m off, %.0f %% of the tolerance, %llu neighbours, %u searches, %llu late\n",
                   what, s.offset, 100.0 * s.fraction, (unsigned long long)s.neighbours, (unsigned)s.searches,
                   (unsigned long long)s.late );
}

// Strands 4 mm apart, so that a vertex has some thirty neighbours within the default radius of 1 cm.
static hair_groom dense( hair_shape shape, int dimension )
{
    return hair_groom_create( shape, dimension, 25, 10, 0.004f );
}

static uint64_t count_neighbours( const hair_groom* groom, const wisp_vec3* points, float radius )
{
    uint64_t count = 0;
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        for ( int v = groom->offsets[s]; v < groom->offsets[s + 1]; ++v )
        {
            for ( int q = 0; q < groom->vertex_count; ++q )
            {
                bool own = q >= groom->offsets[s] && q < groom->offsets[s + 1];
                double r = hair_distance( points[v], points[q] );
                count += own == false && r > 0.0 && r < (double)radius ? 1 : 0;
            }
        }
    }
    return count;
}

// ---- every switch ----

static void follow_gap( wisp_gap gap )
{
    hair_shadow worst = { 0 };
    for ( int n = 0; n < 8; ++n )
    {
        SCOPED( hair_groom_destroy )
        hair_groom groom = dense( ( n & 1 ) != 0 ? HAIR_CURLY : HAIR_WAVY, ( n & 2 ) != 0 ? 3 : 2 );
        wisp_frozen_hair_def def = hair_clump_only();
        def.gap = gap;
        def.min_lambda = ( n & 4 ) != 0 ? 0.3f : 0.0f;
        def.clump_iterations = 4;
        hair_shadow shadow = hair_follow( NULL, &groom, &def, n % 3 );
        assert_int_equal( shadow.capped, 0 );
        worst.offset = fmax( worst.offset, shadow.offset );
        worst.fraction = fmax( worst.fraction, shadow.fraction );
        worst.neighbours += shadow.neighbours;
        worst.searches += shadow.searches;
    }
    say( gap == WISP_GAP_NONE ? "no brake" : "brake", worst );
}

TEST( braked_hair_follows_the_oracle )
{
    follow_gap( WISP_GAP_ABSOLUTE );
}

TEST( hair_without_a_brake_follows_the_oracle )
{
    follow_gap( WISP_GAP_NONE );
}

// ---- iterations and searches ----

TEST( up_to_twelve_iterations_follow_the_oracle )
{
    for ( int n = 0; n < 4; ++n )
    {
        SCOPED( hair_groom_destroy ) hair_groom groom = dense( n < 2 ? HAIR_WAVY : HAIR_STRAIGHT, 2 + n % 2 );
        wisp_frozen_hair_def def = hair_clump_only();
        def.clump_iterations = 12;
        def.clump_step_length = 0.002f;
        say( n % 2 == 0 ? "2D" : "3D", hair_follow( NULL, &groom, &def, 0 ) );
        def.clump_iterations = 0;
        SCOPED( free_local ) wisp_vec3* points = hair_run( NULL, &groom, &def );
        assert_true( hair_same_bits( points, groom.points, groom.vertex_count ) );
    }
}

// With many neighbours the pull is many steps long, and vertices leave the search margin of their lists repeatedly.
TEST( a_strong_pull_searches_again_and_still_follows_the_oracle )
{
    for ( int n = 0; n < 8; ++n )
    {
        SCOPED( hair_groom_destroy ) hair_groom groom = dense( HAIR_CURLY, 2 + n % 2 );
        wisp_frozen_hair_def def = hair_clump_only();
        def.min_distance = 0.0f;
        def.clump_radius = 0.02f;
        def.clump_step_length = ( n & 2 ) != 0 ? 0.0005f : 0.0002f;
        def.clump_iterations = 8;
        def.gap = (wisp_gap)( n / 4 );
        def.max_neighbours = 4096;
        hair_shadow shadow = hair_follow( NULL, &groom, &def, 0 );
        say( n < 4 ? "brake" : "no brake", shadow );
        assert_in_range( shadow.searches, 2, 8 );
        assert_int_equal( shadow.capped, 0 );
    }
}

// Between these a few vertices exceed the search margin, and the pairs missing from the lists are found one by one.
TEST( pairs_that_come_near_from_beyond_the_lists_are_found_one_by_one )
{
    for ( int n = 0; n < 2; ++n )
    {
        SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_CURLY, 2, 60, 12, 0.004f );
        wisp_frozen_hair_def def = hair_clump_only();
        def.min_distance = 0.0f;
        def.clump_radius = 0.02f;
        def.clump_step_length = 0.001f;
        def.clump_iterations = n == 0 ? 4 : 8;
        hair_shadow shadow = hair_follow( NULL, &groom, &def, 0 );
        say( "from beyond the lists", shadow );
        assert_in_range( shadow.late, 2, 200 );
    }
}

TEST( lists_of_slow_hair_outlive_an_iteration )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = dense( HAIR_WAVY, 3 );
    wisp_frozen_hair_def def = hair_clump_only();
    def.clump_step_length = 1e-6f;
    def.clump_iterations = 6;
    hair_shadow shadow = hair_follow( NULL, &groom, &def, 0 );
    assert_in_range( shadow.searches, 1, 5 );
}

// ---- radius ----

TEST( radii_from_nothing_near_to_everything_near_follow_the_oracle )
{
    const float radius[] = { 0.001f, 0.0039f, 0.025f, 0.08f, 3.0f };
    for ( int n = 0; n < 2 * WISP_COUNT( radius ); ++n )
    {
        SCOPED( hair_groom_destroy ) hair_groom groom = dense( HAIR_WAVY, 2 + n % 2 );
        wisp_frozen_hair_def def = hair_clump_only();
        def.clump_radius = radius[n / 2];
        def.clump_step_length = 0.0005f;
        def.max_neighbours = 512;
        hair_shadow shadow = hair_follow( NULL, &groom, &def, 0 );
        say( "radius", shadow );
        assert_int_equal( shadow.capped, 0 );
    }
}

// For every number of vertices modulo the eight that are searched at once, and from few neighbours to all.
TEST( the_report_counts_exactly_the_pairs_within_the_radius )
{
    const float radius[] = { 0.004f, 0.01f, 0.08f, 3.0f };
    for ( int n = 0; n < 2 * 8 * WISP_COUNT( radius ); ++n )
    {
        int vertices = 17 + n / 2 % 8;
        SCOPED( hair_groom_destroy )
        hair_groom groom = hair_groom_create( HAIR_CURLY, 2 + n % 2, 9, vertices, 0.004f );
        wisp_frozen_hair_def def = hair_clump_only();
        def.clump_radius = radius[n / 16];
        SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
        wisp_entity entity = hair_add_frozen( world, &groom, &def );
        hair_step( world );
        uint64_t expected = count_neighbours( &groom, groom.points, def.clump_radius );
        if ( def.clump_radius > 1.0f )
        {
            assert_int_equal( expected, 9 * vertices * 8 * vertices ); // all vertices of all other strands
        }
        assert_int_equal( hair_stats( world, entity ).neighbours, expected );
        assert_int_equal( wisp_world_counter( world, WISP_COUNT_NEIGHBOURS ), expected );
    }
}

// Far from the origin a float is coarse: 2^-15 m at half a kilometre. The tolerance includes that.
TEST( hair_far_from_the_origin_follows_the_oracle )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = dense( HAIR_CURLY, 3 );
    for ( int v = 0; v < groom.vertex_count; ++v )
    {
        groom.points[v].x += 500.0f;
        groom.points[v].z -= 300.0f;
    }
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    def.cursor = ( wisp_vec3 ){ 500.09f, -0.05f, -299.9f };
    say( "half a kilometre away", hair_follow( NULL, &groom, &def, 0 ) );
}

TEST( hair_too_sparse_for_its_radius_is_reported_and_stays )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 3, 64, 10, 5.0f );
    wisp_frozen_hair_def def = hair_clump_only();
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    wisp_entity entity = hair_add_frozen( world, &groom, &def );
    hair_step( world );
    wisp_frozen_hair_stats report = hair_stats( world, entity );
    assert_int_equal( report.coarse_grid, 1 );
    assert_int_equal( report.neighbours, 0 );
    assert_int_equal( wisp_world_counter( world, WISP_COUNT_COARSE_GRIDS ), 1 );
    assert_true( hair_same_bits( hair_view( world, entity, 640 ), groom.points, 640 ) );
}

// ---- limits and degenerate places ----

TEST( a_neighbour_limit_that_is_reached_is_counted_and_reported )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = dense( HAIR_WAVY, 3 );
    wisp_frozen_hair_def def = hair_clump_only();
    def.max_neighbours = 5;
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    wisp_entity entity = hair_add_frozen( world, &groom, &def );
    hair_step( world );
    wisp_frozen_hair_stats report = hair_stats( world, entity );
    uint64_t all = count_neighbours( &groom, groom.points, def.clump_radius );

    // in this dense groom every vertex has more than five neighbours
    assert_in_range( report.capped, 250, 250 * report.searches );
    assert_int_equal( wisp_world_counter( world, WISP_COUNT_CAPPED ), report.capped );
    assert_in_range( report.neighbours, 1, 250 * 5 );
    assert_true( report.neighbours < all );
    hair_assert_finite( hair_view( world, entity, 250 ), 250 );

    // a limit that is not reached leaves the report empty
    def.max_neighbours = 256;
    hair_set( world, entity, &def );
    hair_step( world );
    report = hair_stats( world, entity );
    assert_int_equal( report.capped, 0 );
    assert_int_equal( report.neighbours, all );
}

TEST( strands_in_one_place_have_no_direction_and_stay )
{
    enum
    {
        copies = 9,
        vertices = 12
    };
    SCOPED( hair_groom_destroy ) hair_groom one = hair_groom_create( HAIR_CURLY, 3, 1, vertices, 0.0f );
    wisp_vec3 points[copies * vertices];
    int counts[copies];
    for ( int n = 0; n < copies; ++n )
    {
        memcpy( points + n * vertices, one.points, sizeof( wisp_vec3 ) * vertices );
        counts[n] = vertices;
    }
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_from( 3, copies, counts, points );
    wisp_frozen_hair_def def = hair_clump_only();
    def.clump_radius = 0.003f; // less than a segment: only coincident vertices are near
    for ( int gap = WISP_GAP_ABSOLUTE; gap < WISP_GAP_COUNT; ++gap )
    {
        def.gap = (wisp_gap)gap;
        SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
        assert_true( hair_same_bits( out, points, copies * vertices ) );
    }

    // with the neighbours of a neighbour within reach they move, all together, as the oracle does
    def.clump_radius = 0.009f;
    say( "nine in one place", hair_follow( NULL, &groom, &def, 0 ) );
}

TEST( a_step_of_zero_leaves_every_vertex )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = dense( HAIR_WAVY, 3 );
    wisp_frozen_hair_def def = hair_clump_only();
    def.clump_step_length = 0.0f;
    SCOPED( free_local ) wisp_vec3* points = hair_run( NULL, &groom, &def );
    assert_true( hair_same_bits( points, groom.points, groom.vertex_count ) );
}

// Eq. 17-19, the guard: steps of many distances, of which each ends at the smallest distance, in its order.
TEST( under_the_guard_no_pair_comes_closer_than_allowed )
{
    for ( int n = 0; n < 4; ++n )
    {
        SCOPED( hair_groom_destroy )
        hair_groom groom = hair_groom_create( n % 2 == 0 ? HAIR_WAVY : HAIR_CURLY, 2 + n / 2, 36, 12, 0.003f );
        SCOPED( free_local ) double3* start = hair_widen_all( groom.points, groom.vertex_count );
        const double least = fmin( measure_clumping( start, groom.vertex_count, 12, 0.003 ).nearest_gap, 0.0006 );
        wisp_frozen_hair_def def = hair_clump_only();
        def.gap = WISP_GAP_NONE;
        def.clump_step_length = 0.05f;
        def.min_distance = 0.0006f;
        for ( def.clump_iterations = 1; def.clump_iterations <= 12; ++def.clump_iterations )
        {
            SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
            SCOPED( free_local ) double3* wide = hair_widen_all( out, groom.vertex_count );
            // an iteration may round each of the two coordinates, of up to 0.25 m, once more
            assert_true( measure_clumping( wide, groom.vertex_count, 12, 0.003 ).nearest_gap >=
                         least - 4.0 * HAIR_ROUNDING * 0.25 * def.clump_iterations );
        }
    }
    const wisp_vec3 points[] = { { 0, 1, 0 }, { -0.0005f, 0, 0 }, { 0, 2, 0 }, { 0.0005f, 0, 0 } };
    SCOPED( hair_groom_destroy ) hair_groom pair = hair_groom_from( 3, 2, ( const int[] ){ 2, 2 }, points );
    wisp_frozen_hair_def def = hair_clump_only();
    def.gap = WISP_GAP_NONE;
    def.clump_iterations = 1;
    def.clump_step_length = 0.05f;
    def.min_distance = 0.0002f;
    SCOPED( free_local ) wisp_vec3* kept = hair_run( NULL, &pair, &def );
    hair_assert_close( (double)kept[3].x - (double)kept[1].x, 0.0002, 8.0 * HAIR_ROUNDING * 0.001 );
}

// A guard distance above every distance allows no motion.
TEST( a_guard_distance_beyond_the_radius_stops_everything )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = dense( HAIR_WAVY, 3 );
    wisp_frozen_hair_def def = hair_clump_only();
    def.min_distance = 0.02f;
    SCOPED( free_local ) wisp_vec3* points = hair_run( NULL, &groom, &def );
    assert_true( hair_same_bits( points, groom.points, groom.vertex_count ) );
}
