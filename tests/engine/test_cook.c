// Strands into lanes and back to the user's order, for every mix of lengths.
#include "support.h"

#include "cook_strands.h"

// ---- mixes of lengths ----

typedef enum mix
{
    MIX_EQUAL,  // all of four vertices
    MIX_RANDOM, // 0 to 40
    MIX_RISING, // 0, 1, 2 .. 40, 0, 1 ..
    MIX_FALLING,
    MIX_EMPTY, // no vertex at all
    MIX_LONE,  // one long strand among empty ones
    MIX_COUNT,
} mix;

static const int STRAND_COUNTS[] = { 0, 1, 2, 15, 16, 17, 31, 32, 33, 100, 1000 };

static int length_of( mix m, int strand, int strand_count )
{
    switch ( m )
    {
        case MIX_EQUAL:
            return 4;
        case MIX_RANDOM:
            return test_random( strand, strand_count, 41 );
        case MIX_RISING:
            return strand % 41;
        case MIX_FALLING:
            return 40 - strand % 41;
        case MIX_LONE:
            return strand == strand_count / 2 ? 40 : 0;
        default:
            return 0;
    }
}

static test_strands make_mix( mix m, int strand_count )
{
    SCOPED( free_local ) int* lengths = checked_calloc( (size_t)strand_count + 1, sizeof( int ) );
    for ( int s = 0; s < strand_count; ++s )
    {
        lengths[s] = length_of( m, s, strand_count );
    }
    return test_strands_make( lengths, strand_count );
}

static int length( const test_strands* s, int strand )
{
    return s->offsets[strand + 1] - s->offsets[strand];
}

// ---- every mix, cooked ----

typedef void check_fn( const test_strands* user, const wisp_strand_topology* t, const float* rows );

// Cook and pack every mix, run the check, and verify that all memory is freed.
static void check_every_mix( check_fn* check )
{
    for ( int m = 0; m < MIX_COUNT; ++m )
    {
        for ( int i = 0; i < WISP_COUNT( STRAND_COUNTS ); ++i )
        {
            test_host host = { 0 };
            wisp_allocator allocator = test_host_allocator( &host );
            test_strands user = make_mix( (mix)m, STRAND_COUNTS[i] );
            cook_strands* cooked = cook_strands_create( &allocator, user.offsets, user.strand_count, 3 );
            assert_non_null( cooked );
            const wisp_strand_topology* t = &cooked->topology;
            size_t floats = (size_t)t->row_count * 3 * WISP_LANES;
            float* rows = checked_malloc( ( floats + 1 ) * sizeof( float ) );
            memset( rows, 0xa5, floats * sizeof( float ) );
            cook_strands_pack( t, user.points, rows );
            check( &user, t, rows );
            free( rows );
            cook_strands_release( cooked );
            test_strands_free( &user );
            assert_host_memory_is_released( &host );
        }
    }
}

static wisp_vec3 lane_point( const float* rows, int row, int lane )
{
    const float* p = rows + (size_t)row * 3 * WISP_LANES + lane;
    return ( wisp_vec3 ){ p[0], p[WISP_LANES], p[2 * WISP_LANES] };
}

static bool same_point( wisp_vec3 a, wisp_vec3 b )
{
    return memcmp( &a, &b, sizeof( a ) ) == 0;
}

static void check_counts( const test_strands* user, const wisp_strand_topology* t, const float* rows )
{
    (void)rows;
    int with_vertices = 0;
    for ( int s = 0; s < user->strand_count; ++s )
    {
        with_vertices += length( user, s ) > 0 ? 1 : 0;
    }
    assert_int_equal( t->strand_count, user->strand_count );
    assert_int_equal( t->vertex_count, user->vertex_count );
    assert_int_equal( t->group_count, ( with_vertices + 15 ) / 16 );
    assert_int_equal( t->dimension, 3 );
    assert_memory_equal( t->offsets, user->offsets, ( (size_t)user->strand_count + 1 ) * sizeof( int32_t ) );
}

TEST( the_topology_counts_what_the_user_gave )
{
    check_every_mix( check_counts );
}

static void check_permutation( const test_strands* user, const wisp_strand_topology* t, const float* rows )
{
    (void)rows;
    SCOPED( free_local ) int* lanes_of = checked_calloc( (size_t)user->strand_count + 1, sizeof( int ) );
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        int strand = t->lane_strand[i];
        assert_in_range( strand + 1, 0, user->strand_count );
        assert_int_equal( t->lane_count[i], strand < 0 ? 0 : length( user, strand ) );
        lanes_of[strand < 0 ? user->strand_count : strand] += 1;
    }
    for ( int s = 0; s < user->strand_count; ++s )
    {
        assert_int_equal( lanes_of[s], length( user, s ) > 0 ? 1 : 0 );
    }
}

TEST( every_strand_with_vertices_has_exactly_one_lane )
{
    check_every_mix( check_permutation );
}

static void check_empty_lanes( const test_strands* user, const wisp_strand_topology* t, const float* rows )
{
    (void)user, (void)rows;
    bool ended = false;
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        ended = ended || t->lane_strand[i] < 0;
        assert_int_equal( ended, t->lane_strand[i] < 0 );
    }
}

TEST( empty_lanes_are_the_last_ones )
{
    check_every_mix( check_empty_lanes );
}

static void check_order( const test_strands* user, const wisp_strand_topology* t, const float* rows )
{
    (void)rows;
    for ( int i = 1; i < t->group_count * WISP_LANES && t->lane_strand[i] >= 0; ++i )
    {
        int before = length( user, t->lane_strand[i - 1] ), here = length( user, t->lane_strand[i] );
        assert_true( before > here || ( before == here && t->lane_strand[i - 1] < t->lane_strand[i] ) );
    }
}

TEST( longer_strands_come_first_and_equal_ones_in_the_users_order )
{
    check_every_mix( check_order );
}

static void check_rows( const test_strands* user, const wisp_strand_topology* t, const float* rows )
{
    (void)user, (void)rows;
    assert_int_equal( t->group_row[0], 0 );
    for ( int g = 0; g < t->group_count; ++g )
    {
        int longest = 0;
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            int count = t->lane_count[g * WISP_LANES + lane];
            longest = count > longest ? count : longest;
        }
        assert_int_equal( t->group_row[g + 1] - t->group_row[g], longest );
    }
    assert_int_equal( t->row_count, t->group_row[t->group_count] );
}

TEST( a_group_has_as_many_rows_as_its_longest_strand )
{
    check_every_mix( check_rows );
}

static void check_round_trip( const test_strands* user, const wisp_strand_topology* t, const float* rows )
{
    SCOPED( free_local ) wisp_vec3* back = checked_calloc( (size_t)user->vertex_count + 1, sizeof( wisp_vec3 ) );
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        for ( int v = 0; v < t->lane_count[i]; ++v )
        {
            back[t->offsets[t->lane_strand[i]] + v] =
                lane_point( rows, t->group_row[i / WISP_LANES] + v, i % WISP_LANES );
        }
    }
    assert_memory_equal( back, user->points, (size_t)user->vertex_count * sizeof( wisp_vec3 ) );
}

TEST( lanes_lead_back_to_the_users_points_bit_for_bit )
{
    check_every_mix( check_round_trip );
}

static void check_padding( const test_strands* user, const wisp_strand_topology* t, const float* rows )
{
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        int group = i / WISP_LANES, strand = t->lane_strand[i];
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        tip = strand >= 0 ? user->points[user->offsets[strand + 1] - 1] : tip;
        for ( int row = t->group_row[group] + t->lane_count[i]; row < t->group_row[group + 1]; ++row )
        {
            assert_true( same_point( lane_point( rows, row, i % WISP_LANES ), tip ) );
        }
    }
}

TEST( behind_a_tip_lanes_repeat_it_and_without_a_strand_they_are_zero )
{
    check_every_mix( check_padding );
}

TEST( strands_of_equal_length_waste_at_most_fifteen_lanes )
{
    for ( int i = 0; i < WISP_COUNT( STRAND_COUNTS ); ++i )
    {
        SCOPED( test_strands_free ) test_strands user = make_mix( MIX_EQUAL, STRAND_COUNTS[i] );
        cook_strands* cooked = cook_strands_create( NULL, user.offsets, user.strand_count, 2 );
        assert_non_null( cooked );
        assert_int_equal( cooked->topology.dimension, 2 );
        int wasted = cooked->topology.row_count * WISP_LANES - user.vertex_count;
        assert_in_range( wasted, 0, 15 * 4 );
        cook_strands_release( cooked );
    }
}

// ---- memory ----

TEST( the_offsets_of_the_user_may_die_after_cooking )
{
    SCOPED( test_strands_free ) test_strands user = make_mix( MIX_RISING, 33 );
    cook_strands* cooked = cook_strands_create( NULL, user.offsets, user.strand_count, 3 );
    assert_non_null( cooked );
    assert_ptr_not_equal( cooked->topology.offsets, user.offsets );
    memset( user.offsets, 0xff, 34 * sizeof( int32_t ) );
    assert_int_equal( cooked->topology.offsets[33], 33 * 32 / 2 );
    cook_strands_release( cooked );
}

TEST( a_topology_dies_with_its_last_instance )
{
    test_host host = { 0 };
    wisp_allocator allocator = test_host_allocator( &host );
    test_strands user = make_mix( MIX_RANDOM, 20 );
    cook_strands* cooked = cook_strands_create( &allocator, user.offsets, user.strand_count, 3 );
    assert_non_null( cooked );
    assert_int_equal( atomic_load( &host.blocks ), 1 );
    cook_strands_retain( cooked );
    cook_strands_retain( cooked );
    cook_strands_release( cooked );
    cook_strands_release( cooked );
    assert_int_equal( atomic_load( &host.blocks ), 1 );
    cook_strands_release( cooked );
    cook_strands_release( NULL );
    test_strands_free( &user );
    assert_host_memory_is_released( &host );
}

TEST( cooking_without_memory_is_null_and_leaks_nothing )
{
    test_strands user = make_mix( MIX_RANDOM, 100 );
    int failures = 0;
    for ( int n = 1; failures == n - 1; ++n )
    {
        test_host host = { 0 };
        wisp_allocator allocator = test_host_allocator( &host );
        test_host_refuse( &host, n, false );
        cook_strands* cooked = cook_strands_create( &allocator, user.offsets, user.strand_count, 3 );
        failures += cooked == NULL ? 1 : 0;
        cook_strands_release( cooked );
        assert_host_memory_is_released( &host );
    }
    test_strands_free( &user );
    assert_true( failures > 0 );
}
