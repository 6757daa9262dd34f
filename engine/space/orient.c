// Exact orientation predicate: the side of a plane on which a point lies. A filter in double precision decides in
// nearly all cases; the rest is computed in integers, without rounding.
//
// A finite float is a multiple of 2^-149 with magnitude below 2^128, so the determinant is an integer of at most
// 838 bits, and the result is exact for all inputs. The filter neither overflows nor underflows: a product of three
// differences lies between 2^-447 and 2^388. Subnormal floats count with their value. If the host flushes
// subnormals to zero, the result may be that for zeros.
#include "solid.h"
#include "wisp/module/intersections.h"

#include <math.h>
#include <string.h>

// ---- integers ----

enum
{
    FLOAT_FRACTION_BITS = 23,
    FLOAT_LOWEST_POWER = -149,
    FLOAT_BITS = 277,                                   // from 2^-149 up to below 2^128
    MAX_WHOLE_LIMBS = ( 3 * FLOAT_BITS + 7 + 31 ) / 32, // see limbs_for()
};

// An integer in two's complement, lowest limb first. Sums and products drop overflow, which is correct as long as
// the final result fits.
typedef struct whole
{
    uint32_t limb[MAX_WHOLE_LIMBS];
} whole;

static void whole_subtract( whole* out, const whole* a, const whole* b, int limbs )
{
    uint64_t carry = 1; // a - b = a + ~b + 1
    for ( int i = 0; i < limbs; ++i )
    {
        carry += (uint64_t)a->limb[i] + (uint32_t)~b->limb[i];
        out->limb[i] = (uint32_t)carry;
        carry >>= 32;
    }
}

static void whole_add_product( whole* sum, const whole* a, const whole* b, int limbs )
{
    for ( int i = 0; i < limbs; ++i )
    {
        uint64_t carry = 0;
        for ( int k = 0; i + k < limbs; ++k )
        {
            // the largest product plus two limbs fits exactly
            carry += (uint64_t)a->limb[i] * b->limb[k] + sum->limb[i + k];
            sum->limb[i + k] = (uint32_t)carry;
            carry >>= 32;
        }
    }
}

static int whole_sign( const whole* a, int limbs )
{
    if ( a->limb[limbs - 1] >> 31 != 0 )
    {
        return -1;
    }
    for ( int i = 0; i < limbs; ++i )
    {
        if ( a->limb[i] != 0 )
        {
            return 1;
        }
    }
    return 0;
}

// ---- floats as integers ----

// A finite float, split into magnitude 2^power with an odd magnitude, or 0 for zero.
typedef struct float_parts
{
    uint32_t magnitude;
    int power, bits; // of the magnitude
    bool negative;
} float_parts;

static float_parts decompose( float value )
{
    uint32_t word;
    memcpy( &word, &value, sizeof( word ) );
    const uint32_t fraction = word & ( ( 1u << FLOAT_FRACTION_BITS ) - 1 );
    const int exponent = (int)( word >> FLOAT_FRACTION_BITS & 0xff );
    float_parts parts = {
        .magnitude = exponent == 0 ? fraction : fraction | 1u << FLOAT_FRACTION_BITS,
        .power = FLOAT_LOWEST_POWER + ( exponent == 0 ? 0 : exponent - 1 ),
        .negative = word >> 31 != 0,
    };
    for ( ; parts.magnitude != 0 && ( parts.magnitude & 1 ) == 0; ++parts.power )
    {
        parts.magnitude >>= 1;
    }
    for ( uint32_t rest = parts.magnitude; rest != 0; rest >>= 1 )
    {
        ++parts.bits;
    }
    return parts;
}

// Converts a float to an integer multiple of 2^unit.
static whole whole_from( const float_parts* parts, int unit, int limbs )
{
    whole value = { { 0 } };
    if ( parts->magnitude == 0 )
    {
        return value;
    }
    const int shift = parts->power - unit, limb = shift / 32;
    const uint64_t shifted = (uint64_t)parts->magnitude << shift % 32;
    value.limb[limb] = (uint32_t)shifted;
    if ( limb + 1 < limbs )
    {
        value.limb[limb + 1] = (uint32_t)( shifted >> 32 );
    }
    if ( parts->negative )
    {
        const whole zero = { { 0 } };
        whole_subtract( &value, &zero, &value, limbs );
    }
    return value;
}

// Returns the number of limbs for coordinates below 2^span: differences are below 2^(span + 1), products of three
// below 2^(3 span + 3), sums of six products below 2^(3 span + 6), plus a sign.
static int limbs_for( int span )
{
    return ( 3 * span + 7 + 31 ) / 32;
}

// ---- the determinant ----

// Finds the lowest and the highest power of two among nonzero coordinates.
// @return false if all are zero
static bool find_span( float_parts parts[4][3], int* lowest, int* span )
{
    int lower = INT32_MAX, upper = INT32_MIN;
    for ( int i = 0; i < 4 * 3; ++i )
    {
        const float_parts* part = &parts[i / 3][i % 3];
        if ( part->magnitude != 0 )
        {
            lower = part->power < lower ? part->power : lower;
            upper = part->power + part->bits > upper ? part->power + part->bits : upper;
        }
    }
    *lowest = lower;
    *span = lower <= upper ? upper - lower : 0;
    return lower <= upper;
}

// Computes the sign of (b - a) x (c - a) . (d - a) in integers with as many limbs as the coordinates require; 0 for NaN and infinity.
static int side_in_whole_numbers( const float* const points[4] )
{
    float_parts parts[4][3];
    for ( int i = 0; i < 4 * 3; ++i )
    {
        if ( !isfinite( points[i / 3][i % 3] ) )
        {
            return 0;
        }
        parts[i / 3][i % 3] = decompose( points[i / 3][i % 3] );
    }
    int unit, span;
    if ( !find_span( parts, &unit, &span ) )
    {
        return 0;
    }
    const int limbs = limbs_for( span );
    whole from_a[3][3];
    for ( int axis = 0; axis < 3; ++axis )
    {
        const whole a = whole_from( &parts[0][axis], unit, limbs );
        for ( int i = 0; i < 3; ++i )
        {
            const whole p = whole_from( &parts[i + 1][axis], unit, limbs );
            whole_subtract( &from_a[i][axis], &p, &a, limbs );
        }
    }
    whole determinant = { { 0 } };
    for ( int axis = 0; axis < 3; ++axis )
    {
        const int next = ( axis + 1 ) % 3, last = ( axis + 2 ) % 3;
        whole plus = { { 0 } }, minus = { { 0 } }, normal;
        whole_add_product( &plus, &from_a[0][next], &from_a[1][last], limbs );
        whole_add_product( &minus, &from_a[0][last], &from_a[1][next], limbs );
        whole_subtract( &normal, &plus, &minus, limbs );
        whole_add_product( &determinant, &normal, &from_a[2][axis], limbs );
    }
    return whole_sign( &determinant, limbs );
}

// Error bound of the filter. Each of the six products has at most eight roundings (three differences, two
// multiplications, three sums). So the error is below 8.1 u of the sum of their magnitudes, with u = 2^-53, and the
// error of that sum is as small. Twice the bound also covers the rounding of the bound itself.
static const double filter_error = 0x1p-49;

// Returns the sign of the determinant; 0 if rounding may have changed it, or for NaN or infinity.
static int side_in_doubles( const float* a, const float* b, const float* c, const float* d )
{
    double ab[3], ac[3], ad[3], determinant = 0.0, magnitude = 0.0;
    for ( int axis = 0; axis < 3; ++axis )
    {
        ab[axis] = (double)b[axis] - (double)a[axis];
        ac[axis] = (double)c[axis] - (double)a[axis];
        ad[axis] = (double)d[axis] - (double)a[axis];
    }
    for ( int axis = 0; axis < 3; ++axis )
    {
        const int next = ( axis + 1 ) % 3, last = ( axis + 2 ) % 3;
        const double plus = ab[next] * ac[last], minus = ab[last] * ac[next];
        determinant += ( plus - minus ) * ad[axis];
        magnitude += ( fabs( plus ) + fabs( minus ) ) * fabs( ad[axis] );
    }
    const double error = filter_error * magnitude;
    return determinant > error ? 1 : determinant < -error ? -1 : 0;
}

int space_side_of_plane( const float* a, const float* b, const float* c, const float* d )
{
    const int side = side_in_doubles( a, b, c, d );
    return side != 0 ? side : side_in_whole_numbers( ( const float* const[4] ){ a, b, c, d } );
}

// Tests whether a plane across the line between the centres parts a segment from a triangle. Primitives of a flat sheet lie in one
// plane, which takes whole numbers to see, and most of them are apart. The margin is far above ten roundings.
static bool are_apart( const float* const points[5] )
{
    double line[3], at[5] = { 0.0 }, magnitude = 0.0;
    for ( int axis = 0; axis < 3; ++axis )
    {
        line[axis] = 3.0 * ( (double)points[0][axis] + (double)points[1][axis] ) -
                     2.0 * ( (double)points[2][axis] + (double)points[3][axis] + (double)points[4][axis] );
        for ( int i = 0; i < 5; ++i )
        {
            const double along = line[axis] * ( (double)points[i][axis] - (double)points[2][axis] );
            at[i] += along;
            magnitude += fabs( along );
        }
    }
    return fmin( at[0], at[1] ) - fmax( at[2], fmax( at[3], at[4] ) ) > 0x1p-40 * magnitude;
}

bool wisp_segment_intersects( const float* p, const float* q, const float* a, const float* b, const float* c )
{
    const int likely = side_in_doubles( a, b, c, p );
    const bool is_clear = likely != 0 || are_apart( ( const float* const[5] ){ p, q, a, b, c } );
    const int side = is_clear ? likely : space_side_of_plane( a, b, c, p );
    // the ends are on different sides of the plane; a point that is not finite is on neither
    if ( side == 0 || space_side_of_plane( a, b, c, q ) != -side )
    {
        return false;
    }
    // the line passes through the triangle: seen along the line, its edges turn the same way
    const int turn = space_side_of_plane( p, q, a, b );
    return turn != 0 && space_side_of_plane( p, q, b, c ) == turn && space_side_of_plane( p, q, c, a ) == turn;
}
