/// Operands for tests of mathematics, and the processor features that the tested backend needs.
#pragma once

#include "unit.h"

#include "lane.h"
#include "lane_random.h"
#include "lane_trig.h"
#include "lane_vec.h"
#include "trig.h"
#include "vec.h"

static inline uint32_t bits_of( float value )
{
    uint32_t bits;
    memcpy( &bits, &value, sizeof bits );
    return bits;
}

static inline float float_of( uint32_t bits )
{
    float value;
    memcpy( &value, &bits, sizeof value );
    return value;
}

#define assert_same_bits( actual, expected, k ) check_bits( actual, expected, k, false, __LINE__ )
#define assert_same_value( actual, expected, k ) check_bits( actual, expected, k, true, __LINE__ )
#define assert_same_int( actual, expected, k ) check_int( actual, expected, k, __LINE__ )

// Equal bits; for a NaN made by arithmetic, any NaN is accepted.
static inline void check_bits( float actual, float expected, int k, bool any_nan, int line )
{
    if ( bits_of( actual ) != bits_of( expected ) && !( any_nan && isnan( actual ) && isnan( expected ) ) )
    {
        fail_msg( "line %d, operand %d: %a (%08x), expected %a (%08x)", line, k, (double)actual, bits_of( actual ),
                  (double)expected, bits_of( expected ) );
    }
}

static inline void check_int( int32_t actual, int32_t expected, int k, int line )
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

static inline int fill_operands( void** state )
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

static inline wisp_vec3 direction( int k )
{
    double z = 1.0 - 2.0 * k / ( DIRECTION_COUNT - 1 ), turn = 2.399963229728653 * k, radius = sqrt( 1.0 - z * z );
    return ( wisp_vec3 ){ (float)( radius * cos( turn ) ), (float)( radius * sin( turn ) ), (float)z };
}

// ---- the program

static inline bool processor_has_what_this_was_built_for( void )
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
static inline const char* missing_backend( void )
{
    return processor_has_what_this_was_built_for() ? NULL
                                                   : "built for " LANE_BACKEND ", which this processor does not have";
}
