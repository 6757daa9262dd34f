// Lanes, also of doubles, against scalars; trigonometry against double precision, rotations against their defining properties.
// Built once per backend of lane.h and lane_double.h, whose flags must not change a bit of scalars either; a build for
// instructions that this processor lacks is skipped.
#include "unit.h"

#include "lane.h"
#include "lane_double_vec.h"
#include "lane_random.h"
#include "lane_trig.h"
#include "lane_vec.h"
#include "trig.h"
#include "wisp/module/vec.h"

static uint32_t bits_of( float value )
{
    uint32_t bits;
    memcpy( &bits, &value, sizeof bits );
    return bits;
}

static float float_of( uint32_t bits )
{
    float value;
    memcpy( &value, &bits, sizeof value );
    return value;
}

#define assert_same_bits( actual, expected, k ) check_bits( actual, expected, k, false, __LINE__ )
#define assert_same_value( actual, expected, k ) check_bits( actual, expected, k, true, __LINE__ )
#define assert_same_int( actual, expected, k ) check_int( actual, expected, k, __LINE__ )

// Equal bits; for a NaN made by arithmetic, any NaN is accepted.
static void check_bits( float actual, float expected, int k, bool any_nan, int line )
{
    if ( bits_of( actual ) != bits_of( expected ) && !( any_nan && isnan( actual ) && isnan( expected ) ) )
    {
        fail_msg( "line %d, operand %d: %a (%08x), expected %a (%08x)", line, k, (double)actual, bits_of( actual ),
                  (double)expected, bits_of( expected ) );
    }
}

static void check_int( int32_t actual, int32_t expected, int k, int line )
{
    if ( actual != expected )
    {
        fail_msg( "line %d, operand %d: %d, expected %d", line, k, actual, expected );
    }
}

// ---- operands

static const float special[] = {
    0.0f,
    -0.0f,
    1.0f,
    -1.0f,
    0.5f,
    -0.5f,
    0.1f,
    2.5f,
    -3.7f,
    255.99998f,
    -0x1.fffffep-1f,
    0x1.fffffep22f,
    -0x1.fffffep22f,
    0x1p23f,
    -0x1.000002p23f,
    0x1.fffffep30f,
    0x1p31f,
    -0x1p31f,
    -0x1.000002p31f,
    1e10f,
    -1e20f,
    FLT_MAX,
    -FLT_MAX,
    FLT_MIN,
    -FLT_MIN,
    0x1p-149f,
    -0x1p-149f,
    0x1.fffffcp-127f,
    INFINITY,
    -INFINITY,
    NAN,
    -NAN,
};

#define SPECIAL_COUNT 32
#define OPERAND_COUNT ( SPECIAL_COUNT * SPECIAL_COUNT + 4096 )
#define ORDINARY_COUNT 4096

_Static_assert( sizeof special / sizeof special[0] == SPECIAL_COUNT,
                "every special number is paired with every other" );

static float operand_a[OPERAND_COUNT]; // all pairs of special numbers, then random bits: every exponent, many NaNs
static float operand_b[OPERAND_COUNT];
static float operand_c[OPERAND_COUNT];
static float ordinary[ORDINARY_COUNT]; // within [-1, 1], [-10, 10], [-100, 100] ... [-10000, 10000] in turn

static int fill_operands( void** state )
{
    (void)state;
    puts( "backend: " LANE_BACKEND );
    wisp_random_key key = wisp_random_make_key( 1, 2, 3 );
    for ( int k = 0; k < OPERAND_COUNT; ++k )
    {
        bool pair = k < SPECIAL_COUNT * SPECIAL_COUNT;
        uint64_t bits = wisp_random_bits( key, (uint32_t)k, 0, 0 );
        operand_a[k] = pair ? special[k / SPECIAL_COUNT] : float_of( (uint32_t)bits );
        operand_b[k] = pair ? special[k % SPECIAL_COUNT] : float_of( (uint32_t)( bits >> 32 ) );
        operand_c[k] = pair ? special[k * 7 % SPECIAL_COUNT] : wisp_random_unit_float( key, (uint32_t)k, 1, 0 );

        // Signalling NaNs change when they are copied through a register; the quiet bit keeps the bits comparable.
        operand_a[k] = isnan( operand_a[k] ) ? float_of( bits_of( operand_a[k] ) | 0x400000u ) : operand_a[k];
        operand_b[k] = isnan( operand_b[k] ) ? float_of( bits_of( operand_b[k] ) | 0x400000u ) : operand_b[k];
    }
    const float range[] = { 1.0f, 10.0f, 100.0f, 1000.0f, 10000.0f };
    for ( int k = 0; k < ORDINARY_COUNT; ++k )
    {
        ordinary[k] = range[k % 5] * ( 2.0f * wisp_random_unit_float( key, (uint32_t)k, 2, 0 ) - 1.0f );
    }
    return 0;
}

// Unit to a few roundings: the directions of a spiral over the sphere, its poles included.
#define DIRECTION_COUNT 1000

static wisp_vec3 direction( int k )
{
    double z = 1.0 - 2.0 * k / ( DIRECTION_COUNT - 1 ), turn = 2.399963229728653 * k, radius = sqrt( 1.0 - z * z );
    return ( wisp_vec3 ){ (float)( radius * cos( turn ) ), (float)( radius * sin( turn ) ), (float)z };
}

// ---- the program

static bool processor_has_what_this_was_built_for( void )
{
#if defined( __AVX512F__ )
    return __builtin_cpu_supports( "avx512f" ) && __builtin_cpu_supports( "avx512vl" ) &&
           __builtin_cpu_supports( "avx512bw" ) && __builtin_cpu_supports( "avx512dq" );
#elif defined( __AVX2__ )
    return __builtin_cpu_supports( "avx2" );
#else
    return true;
#endif
}

/// @return why the backend of this build cannot run here, or NULL
static const char* missing_backend( void )
{
    return processor_has_what_this_was_built_for() ? NULL
                                                   : "built for " LANE_BACKEND ", which this processor does not have";
}

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

// Two unit vectors that complete the unit vector t to a right-handed orthonormal frame (Duff et al. 2017). b1 x b2 = t.
static void basis( wisp_vec3 t, wisp_vec3* b1, wisp_vec3* b2 )
{
    float sign = t.z >= 0.0f ? 1.0f : -1.0f;
    float a = -1.0f / ( sign + t.z );
    float b = t.x * t.y * a;
    *b1 = wisp_v3( 1.0f + sign * t.x * t.x * a, sign * b, -sign * t.x );
    *b2 = wisp_v3( b, sign + t.y * t.y * a, -t.y );
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

// ---- lanes of doubles ----

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

// ---- trigonometry

static void check_sincos( float x )
{
    float sine, cosine;
    trig_sincos( x, &sine, &cosine );
    double sine_error = fabs( (double)sine - sin( (double)x ) );
    double cosine_error = fabs( (double)cosine - cos( (double)x ) );
    if ( !( sine_error <= (double)TRIG_SINCOS_ERROR && cosine_error <= (double)TRIG_SINCOS_ERROR ) )
    {
        fail_msg( "x = %.9g: sine off by %g, cosine by %g", (double)x, sine_error, cosine_error );
    }
}

// Every 499th float, so that all exponents occur, and the neighbourhood of the largest error of all floats.
TEST( sine_and_cosine_keep_their_bound )
{
    uint32_t last = bits_of( TRIG_SINCOS_RANGE );
    for ( uint32_t bits = bits_of( 0x1p-20f ); bits <= last; bits += 499 )
    {
        check_sincos( float_of( bits ) );
        check_sincos( -float_of( bits ) );
    }
    check_sincos( 2100.9021f );
    check_sincos( 3.90851426f );
    check_sincos( TRIG_SINCOS_RANGE );
    check_sincos( 0x1p-149f );
    check_sincos( 0.0f );
}

TEST( sine_and_cosine_stay_bounded_beyond_their_range )
{
    for ( int k = 0; k < OPERAND_COUNT; ++k )
    {
        float sine, cosine;
        trig_sincos( operand_a[k], &sine, &cosine );
        if ( isnan( operand_a[k] ) )
        {
            assert_true( isnan( sine ) && isnan( cosine ) );
        }
        else
        {
            assert_true( fabsf( sine ) <= 1.0f && fabsf( cosine ) <= 1.0f );
        }
    }
}

static void check_atan2( float y, float x )
{
    double error = fabs( (double)trig_atan2( y, x ) - atan2( (double)y, (double)x ) );
    if ( !( error <= (double)TRIG_ATAN2_ERROR ) )
    {
        fail_msg( "y = %.9g, x = %.9g: angle off by %g", (double)y, (double)x, error );
    }
}

TEST( arc_tangent_keeps_its_bound )
{
    wisp_random_key key = wisp_random_make_key( 4, 5, 6 );
    for ( uint32_t k = 0; k < 500000; ++k )
    {
        float y = 2.0f * wisp_random_unit_float( key, k, 0, 0 ) - 1.0f;
        float x = 2.0f * wisp_random_unit_float( key, k, 1, 0 ) - 1.0f;
        check_atan2( y, x );
        check_atan2( ldexpf( y, -(int)( k % 30 ) ), x );
    }
    check_atan2( 0.471258193f, -0.216977909f );
    check_atan2( 1e-40f, 2e-40f );
    check_atan2( 1e37f, -1e37f );
    check_atan2( 0x1p-149f, -0x1p-149f );
}

TEST( arc_tangent_knows_its_quadrants )
{
    const float quarter = 0.785398163f, half = 1.57079633f, whole = 3.14159265f;
    assert_same_bits( trig_atan2( 0.0f, 1.0f ), 0.0f, 0 );
    assert_same_bits( trig_atan2( 1.0f, 0.0f ), half, 0 );
    assert_same_bits( trig_atan2( 1.0f, -0.0f ), half, 0 );
    assert_same_bits( trig_atan2( 0.0f, -1.0f ), whole, 0 );
    assert_same_bits( trig_atan2( -0.0f, -1.0f ), -whole, 0 );
    assert_same_bits( trig_atan2( -1.0f, 0.0f ), -half, 0 );
    assert_same_bits( trig_atan2( 2.0f, 2.0f ), quarter, 0 );
    assert_same_bits( trig_atan2( -2.0f, 2.0f ), -quarter, 0 );
    assert_true( trig_atan2( 2.0f, -2.0f ) > half && trig_atan2( -2.0f, -2.0f ) < -half );
}

TEST( the_angle_of_the_origin_is_zero )
{
    for ( int k = 0; k < 4; ++k )
    {
        assert_true( trig_atan2( k & 1 ? -0.0f : 0.0f, k & 2 ? -0.0f : 0.0f ) == 0.0f );
    }
    assert_true( isnan( trig_atan2( NAN, 1.0f ) ) );
    assert_true( isnan( trig_atan2( 1.0f, NAN ) ) );
}

// ---- vectors

// Each entry of a product of unit vectors rounds a handful of times, each time by FLT_EPSILON / 2 at most.
static const float few_roundings = 6.0f * FLT_EPSILON;

static void assert_close( float actual, float expected )
{
    if ( !( fabsf( actual - expected ) <= few_roundings ) )
    {
        fail_msg( "%.9g, expected %.9g", (double)actual, (double)expected );
    }
}

static void assert_close_v3( wisp_vec3 actual, wisp_vec3 expected )
{
    assert_close( actual.x, expected.x );
    assert_close( actual.y, expected.y );
    assert_close( actual.z, expected.z );
}

TEST( a_basis_is_orthonormal_and_right_handed )
{
    for ( int k = 0; k < DIRECTION_COUNT; ++k )
    {
        wisp_vec3 t = direction( k ), b1, b2;
        basis( t, &b1, &b2 );
        assert_close( wisp_v3_length( b1 ), 1.0f );
        assert_close( wisp_v3_length( b2 ), 1.0f );
        assert_close( wisp_v3_dot( b1, b2 ), 0.0f );
        assert_close( wisp_v3_dot( b1, t ), 0.0f );
        assert_close( wisp_v3_dot( b2, t ), 0.0f );
        assert_close_v3( wisp_v3_cross( b1, b2 ), t );
    }
}

TEST( a_rotation_keeps_lengths_and_angles )
{
    for ( int k = 0; k < DIRECTION_COUNT; ++k )
    {
        float sine, cosine;
        trig_sincos( 0.01f * (float)k, &sine, &cosine );
        wisp_vec3 axis = direction( k ), v = direction( ( k * 7 ) % DIRECTION_COUNT );
        wisp_vec3 other = direction( ( k * 13 + 5 ) % DIRECTION_COUNT );
        wisp_vec3 turned = wisp_v3_rotate( axis, sine, cosine, v );
        wisp_vec3 other_turned = wisp_v3_rotate( axis, sine, cosine, other );

        assert_close( wisp_v3_length( turned ), 1.0f );
        assert_close( wisp_v3_dot( turned, other_turned ), wisp_v3_dot( v, other ) );
        assert_close( wisp_v3_dot( turned, axis ), wisp_v3_dot( v, axis ) );
        assert_close_v3( wisp_v3_rotate( axis, -sine, cosine, turned ), v );
        assert_close_v3( wisp_v3_rotate( axis, sine, cosine, axis ), axis );
    }
}

TEST( a_rotation_turns_counter_clockwise_by_its_angle )
{
    const wisp_vec3 x = { 1.0f, 0.0f, 0.0f }, y = { 0.0f, 1.0f, 0.0f }, z = { 0.0f, 0.0f, 1.0f };
    assert_close_v3( wisp_v3_rotate( z, 1.0f, 0.0f, x ), y );
    assert_close_v3( wisp_v3_rotate( x, 1.0f, 0.0f, y ), z );
    assert_close_v3( wisp_v3_rotate( y, 1.0f, 0.0f, z ), x );
    assert_close_v3( wisp_v3_rotate( z, 0.6f, 0.8f, x ), ( wisp_vec3 ){ 0.8f, 0.6f, 0.0f } );
}

TEST( what_has_no_direction_gets_the_fallback )
{
    const wisp_vec3 fallback = { 0.0f, 0.0f, 1.0f };
    const float lost[] = { 0.0f, -0.0f, 1e-20f, 1e20f, INFINITY, NAN };
    for ( int k = 0; k < WISP_COUNT( lost ); ++k )
    {
        assert_close_v3( wisp_v3_normalize_or( ( wisp_vec3 ){ lost[k], 0.0f, 0.0f }, fallback ), fallback );
    }
    const float kept[] = { 1.2e-19f, 1e-9f, 1.0f, 1.8e19f };
    for ( int k = 0; k < WISP_COUNT( kept ); ++k )
    {
        assert_close_v3( wisp_v3_normalize_or( ( wisp_vec3 ){ 0.0f, -kept[k], 0.0f }, fallback ),
                         ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f } );
    }
}

TEST_OBSTACLE( missing_backend )
TEST_GROUP( fill_operands, NULL )
