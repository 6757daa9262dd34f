// Lanes of doubles against scalars, for every backend of lane_double.h.
#include "math_fixture.h"

#include "lane_double_vec.h"

#define EACH_EIGHT( k, count ) for ( int k = 0; k + 8 <= ( count ); k += 8 )

static void assert_same_double( double found, double expected, int k )
{
    uint64_t bits[2];
    memcpy( bits, &found, sizeof( double ) );
    memcpy( bits + 1, &expected, sizeof( double ) );
    if ( bits[0] != bits[1] && !( isnan( found ) && isnan( expected ) ) )
    {
        fail_msg( "operand %d: %a, expected %a", k, found, expected );
    }
}

// Doubles with more digits than a float.
static double first_of( int k )
{
    return (double)operand_a[k] / 3.0;
}

static double second_of( int k )
{
    return (double)operand_b[k] / 7.0;
}

TEST( arithmetic_is_the_scalar_arithmetic )
{
    EACH_EIGHT( k, OPERAND_COUNT )
    {
        const lane8d a = lane8d_div( lane8d_widen( lane8_loadu( operand_a + k ) ), lane8d_set1( 3.0 ) );
        const lane8d b = lane8d_div( lane8d_widen( lane8_loadu( operand_b + k ) ), lane8d_set1( 7.0 ) );
        const lane8dm less = lane8d_lt( a, b );
        double got[8][8];
        lane8d_storeu( got[0], lane8d_add( a, b ) );
        lane8d_storeu( got[1], lane8d_sub( a, b ) );
        lane8d_storeu( got[2], lane8d_mul( a, b ) );
        lane8d_storeu( got[3], lane8d_div( a, b ) );
        lane8d_storeu( got[4], lane8d_sqrt( a ) );
        lane8d_storeu( got[5], lane8d_abs( a ) );
        lane8d_storeu( got[6], lane8d_select( less, a, b ) );
        lane8d_storeu( got[7], a );
        for ( int l = 0; l < 8; ++l )
        {
            const double x = first_of( k + l ), y = second_of( k + l );
            assert_same_double( got[0][l], x + y, k + l );
            assert_same_double( got[1][l], x - y, k + l );
            assert_same_double( got[2][l], x * y, k + l );
            assert_same_double( got[3][l], x / y, k + l );
            assert_same_double( got[4][l], sqrt( x ), k + l );
            assert_same_double( got[5][l], fabs( x ), k + l );
            assert_same_double( got[6][l], x < y ? x : y, k + l );
            assert_same_double( got[7][l], x, k + l );
            assert_true( ( lane8dm_bits( less ) >> l & 1u ) == ( x < y ? 1u : 0u ) );
        }
    }
}

TEST( doubles_are_rounded_to_floats )
{
    EACH_EIGHT( k, ORDINARY_COUNT )
    {
        const lane8d third = lane8d_div( lane8d_widen( lane8_loadu( ordinary + k ) ), lane8d_set1( 3.0 ) );
        float got[8];
        lane8_storeu( got, lane8d_narrow( third ) );
        for ( int l = 0; l < 8; ++l )
        {
            assert_same_bits( got[l], (float)( (double)ordinary[k + l] / 3.0 ), k + l );
        }
    }
}

TEST( a_sum_folds_the_upper_half_onto_the_lower )
{
    EACH_EIGHT( k, ORDINARY_COUNT )
    {
        double each[8];
        const lane8d third = lane8d_div( lane8d_widen( lane8_loadu( ordinary + k ) ), lane8d_set1( 3.0 ) );
        lane8d_storeu( each, third );
        for ( int half = 4; half > 0; half /= 2 )
        {
            for ( int l = 0; l < half; ++l )
            {
                each[l] += each[l + half];
            }
        }
        assert_same_double( lane8d_sum_ordered( third ), each[0], k );
    }
}

TEST( vectors_are_the_scalar_ones )
{
    const double shift[3] = { 0.1, 0.2, 0.3 };
    EACH_EIGHT( k, ORDINARY_COUNT - 48 )
    {
        lane8v rows[2];
        double a[3], b[3], got[4][8];
        for ( int r = 0; r < 2; ++r )
        {
            const float* at = ordinary + k + 24 * r;
            rows[r] = ( lane8v ){ lane8_loadu( at ), lane8_loadu( at + 8 ), lane8_loadu( at + 16 ) };
        }
        const lane8dv v = lane8dv_sub( lane8dv_widen( rows[0] ), lane8dv_set1( shift ) );
        const lane8dv w = lane8dv_add( lane8dv_widen( rows[1] ), lane8dv_scale( v, lane8d_set1( 0.7 ) ) );
        const lane8dv cross = lane8dv_cross( v, w );
        lane8d_storeu( got[0], cross.x );
        lane8d_storeu( got[1], cross.y );
        lane8d_storeu( got[2], cross.z );
        lane8d_storeu( got[3], lane8dv_length( v ) );
        for ( int l = 0; l < 8; ++l )
        {
            for ( int i = 0; i < 3; ++i )
            {
                const float* at = ordinary + k + 8 * i + l;
                a[i] = (double)at[0] - shift[i];
                b[i] = (double)at[24] + a[i] * 0.7;
            }
            assert_same_double( got[0][l], a[1] * b[2] - a[2] * b[1], k + l );
            assert_same_double( got[1][l], a[2] * b[0] - a[0] * b[2], k + l );
            assert_same_double( got[2][l], a[0] * b[1] - a[1] * b[0], k + l );
            assert_same_double( got[3][l], sqrt( a[0] * a[0] + a[1] * a[1] + a[2] * a[2] ), k + l );
        }
    }
}

TEST_OBSTACLE( missing_backend )
TEST_GROUP( fill_operands, NULL )
