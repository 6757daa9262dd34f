// Lanes against scalars. Built once per backend of lane.h; a build for instructions that this processor lacks is skipped.
#include "math_fixture.h"

// The intermediate product goes through memory, so that no compiler fuses the oracle.
static float two_roundings( float a, float b, float c )
{
    volatile float product = a * b;
    return product + c;
}

static int32_t truncated( float a )
{
    return a >= -2147483648.0f && a < 2147483648.0f ? (int32_t)a : INT32_MIN;
}

static float scalar_sine( float x )
{
    float sine, cosine;
    trig_sincos( x, &sine, &cosine );
    return sine;
}

static float scalar_cosine( float x )
{
    float sine, cosine;
    trig_sincos( x, &sine, &cosine );
    return cosine;
}

#define LANE_P lane8
#define LANE_COUNT 8
#include "test_math_lanes.h"
#undef LANE_P
#undef LANE_COUNT

#define LANE_P lane16
#define LANE_COUNT 16
#include "test_math_lanes.h"
#undef LANE_P
#undef LANE_COUNT

// ---- what only eight lanes have

TEST( quads_are_loaded_by_index_and_transposed )
{
    _Alignas( 16 ) float xyzw[4 * 40];
    memcpy( xyzw, ordinary, sizeof xyzw );
    for ( int round = 0; round < 40; ++round )
    {
        int32_t index[8];
        for ( int l = 0; l < 8; ++l )
        {
            index[l] = 4 * ( ( round * 17 + l * l * 11 ) % 40 );
        }
        lane8 x, y, z, w, x3, y3, z3;
        lane8_load_xyzw( xyzw, index, &x, &y, &z, &w );
        lane8_load_xyz( xyzw, index, &x3, &y3, &z3 );
        float got[7][8];
        lane8_storeu( got[0], x );
        lane8_storeu( got[1], y );
        lane8_storeu( got[2], z );
        lane8_storeu( got[3], w );
        lane8_storeu( got[4], x3 );
        lane8_storeu( got[5], y3 );
        lane8_storeu( got[6], z3 );
        for ( int row = 0; row < 7; ++row )
        {
            for ( int l = 0; l < 8; ++l )
            {
                assert_same_bits( got[row][l], xyzw[index[l] + row % 4], 8 * row + l );
            }
        }
    }
}

TEST( rows_and_lanes_change_places )
{
    lane8i rows[8];
    for ( int l = 0; l < 8; ++l )
    {
        rows[l] = lane8i_add( lane8i_set1( 100 * l ), lane8i_iota() );
    }
    lane8i_transpose( rows );
    for ( int l = 0; l < 8; ++l )
    {
        int32_t got[8];
        lane8i_storeu( got, rows[l] );
        for ( int k = 0; k < 8; ++k )
        {
            assert_int_equal( got[k], 100 * k + l );
        }
    }
}

TEST( quads_are_stored_in_lane_order )
{
    _Alignas( 16 ) float xyzw[4 * 10];
    for ( int k = 0; k < 40; ++k )
    {
        xyzw[k] = -7.0f;
    }
    lane8_store_xyzw_contiguous( xyzw + 4, lane8_loadu( ordinary ), lane8_loadu( ordinary + 8 ),
                                 lane8_loadu( ordinary + 16 ), lane8_loadu( ordinary + 24 ) );
    for ( int k = 0; k < 40; ++k )
    {
        bool outside = k < 4 || k >= 36;
        assert_same_bits( xyzw[k], outside ? -7.0f : ordinary[( k - 4 ) % 4 * 8 + ( k - 4 ) / 4], k );
    }
}

TEST( contiguous_quads_are_loaded_in_lane_order )
{
    _Alignas( 16 ) float xyzw[4 * 8];
    memcpy( xyzw, ordinary, sizeof xyzw );
    lane8 q[4];
    lane8_load_xyzw_contiguous( xyzw, q + 0, q + 1, q + 2, q + 3 );
    for ( int row = 0; row < 4; ++row )
    {
        float got[8];
        lane8_storeu( got, q[row] );
        for ( int l = 0; l < 8; ++l )
        {
            assert_same_bits( got[l], xyzw[4 * l + row], 8 * row + l );
        }
    }
}

// Where quads of lane l are in rows: row l % 4, from number 4 (l / 4).
TEST( rows_of_quads_are_loaded_and_stored_by_index )
{
    _Alignas( 16 ) float from[4 * 40], to[4 * 40];
    memcpy( from, ordinary, sizeof from );
    for ( int round = 0; round < 40; ++round )
    {
        int32_t index[8], target[8];
        for ( int l = 0; l < 8; ++l )
        {
            index[l] = 4 * ( ( round * 17 + l * l * 11 ) % 40 );
            target[l] = 4 * ( ( round * 7 + l * 3 ) % 40 );
        }
        for ( int k = 0; k < 160; ++k )
        {
            to[k] = -7.0f;
        }
        lane8 q[4];
        lane8_load_quads( from, index, q );
        lane8_store_quads( to, target, q );
        float got[4][8], expected[4 * 40];
        for ( int k = 0; k < 160; ++k )
        {
            expected[k] = -7.0f;
        }
        for ( int row = 0; row < 4; ++row )
        {
            lane8_storeu( got[row], q[row] );
        }
        for ( int l = 0; l < 8; ++l )
        {
            for ( int k = 0; k < 4; ++k )
            {
                assert_same_bits( got[l % 4][4 * ( l / 4 ) + k], from[index[l] + k], l );
                expected[target[l] + k] = from[index[l] + k];
            }
        }
        for ( int k = 0; k < 160; ++k )
        {
            assert_same_bits( to[k], expected[k], k );
        }

        lane8_load_xyzw( from, index, q + 0, q + 1, q + 2, q + 3 );
        lane8_store_xyzw( to, target, q[0], q[1], q[2], q[3] );
        for ( int k = 0; k < 160; ++k )
        {
            assert_same_bits( to[k], expected[k], k );
        }
    }
}

TEST( rows_of_quads_become_lanes_and_back )
{
    lane8 q[4], spread[4];
    float rows[4][8], got[8];
    memcpy( rows, ordinary, sizeof rows );
    for ( int row = 0; row < 4; ++row )
    {
        q[row] = lane8_loadu( rows[row] );
    }
    lane8_spread_xyz( q[1], spread );
    for ( int row = 0; row < 4; ++row )
    {
        lane8_storeu( got, spread[row] );
        for ( int l = 0; l < 8; ++l )
        {
            assert_same_bits( got[l], l % 4 < 3 ? rows[1][row + l / 4 * 4] : 0.0f, 8 * row + l );
        }
        const lane8 numbers[4] = { lane8_spread_first( q[row] ), lane8_spread_second( q[row] ),
                                   lane8_spread_third( q[row] ), lane8_spread_last( q[row] ) };
        for ( int k = 0; k < 4; ++k )
        {
            lane8_storeu( got, numbers[k] );
            for ( int l = 0; l < 8; ++l )
            {
                assert_same_bits( got[l], rows[row][l / 4 * 4 + k], 8 * row + l );
            }
        }
    }
    lane8_transpose_quads( q );
    for ( int row = 0; row < 4; ++row )
    {
        lane8_storeu( got, q[row] );
        for ( int l = 0; l < 8; ++l )
        {
            assert_same_bits( got[l], rows[l % 4][l / 4 * 4 + row], 8 * row + l );
        }
    }
    lane8_transpose_quads( q );
    for ( int row = 0; row < 4; ++row )
    {
        lane8_storeu( got, q[row] );
        for ( int l = 0; l < 8; ++l )
        {
            assert_same_bits( got[l], rows[row][l], 8 * row + l );
        }
    }
}

TEST( compressing_keeps_the_order_of_the_chosen_lanes )
{
    const int32_t values[8] = { 100, -101, 102, 103, INT32_MIN, 105, INT32_MAX, 107 };
    for ( uint32_t bits = 0; bits < 256; ++bits )
    {
        int32_t out[10] = { 1, 1, 1, 1, 1, 1, 1, 1, 1, 1 };
        int count = lane8i_compress_store( out + 1, lane8i_loadu( values ), bits );
        int expected = 0;
        for ( int l = 0; l < 8; ++l )
        {
            if ( bits >> l & 1u )
            {
                expected += 1;
                assert_same_int( out[expected], values[l], (int)bits );
            }
        }
        assert_same_int( count, expected, (int)bits );
        assert_same_int( out[0], 1, (int)bits );
        assert_same_int( out[9], 1, (int)bits );
    }
}

TEST( floats_are_compressed_as_integers_are )
{
    const float values[8] = { -0.0f, 1.5f, INFINITY, -3.0f, 1e-40f, 5.0f, -INFINITY, 7.0f };
    for ( uint32_t bits = 0; bits < 256; ++bits )
    {
        float out[8];
        const int count = lane8_compress_store( out, lane8_loadu( values ), bits );
        int expected = 0;
        for ( int l = 0; l < 8; ++l )
        {
            if ( bits >> l & 1u )
            {
                assert_same_bits( out[expected], values[l], (int)bits );
                expected += 1;
            }
        }
        assert_same_int( count, expected, (int)bits );
    }
}

TEST( lanes_are_summed_as_doubles )
{
    const float values[8] = { 1e8f, 1.0f, -1e8f, 0.25f, 3.0f, 1e-3f, -2.0f, 7.0f };
    double sum = 0.0;
    for ( int l = 0; l < 8; ++l )
    {
        sum += (double)values[l];
    }
    assert_true( lane8_sum_doubles( lane8_loadu( values ) ) == sum );
}

TEST( sixteen_lanes_are_two_eights )
{
    float numbers[16], got[16];
    int32_t integers[16], got_integers[16];
    for ( int l = 0; l < 16; ++l )
    {
        numbers[l] = 1.5f + (float)l;
        integers[l] = 100 - l;
    }
    lane16_storeu( got, lane16_join( lane8_loadu( numbers ), lane8_loadu( numbers + 8 ) ) );
    lane16i_storeu( got_integers, lane16i_join( lane8i_loadu( integers ), lane8i_loadu( integers + 8 ) ) );
    assert_memory_equal( got, numbers, sizeof( got ) );
    assert_memory_equal( got_integers, integers, sizeof( got_integers ) );
}

TEST_OBSTACLE( missing_backend )

TEST_GROUP( fill_operands, NULL )
