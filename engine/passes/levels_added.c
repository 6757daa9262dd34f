// What second order adds to the velocities of the coarsest rows: limited by what the surface did, and by what is added to the
// neighbours of a row.
#include "levels.h"

#include <string.h>

// Fraction of the change of a velocity that is rounding, where first order has none.
#define ROUNDING_FRACTION 1e-4f

// Limits what second order adds to a velocity, d, by what the surface did: half of the change of its mean velocity since its last
// substep, c. Both are half of the acceleration times dt where the surface follows the sheet. A row gets the fraction
// 2 c . d / d^2, within 0 and 1. It gets nothing where the surface did not follow: in contact, in folds, or at rest where both
// do not quite agree; second order would give it a velocity there that it does not have.
static float fraction_of( const float d[3], const float c[3] )
{
    const float d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], c2 = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
    const float both = 2.0f * ( c[0] * d[0] + c[1] * d[1] + c[2] * d[2] );
    return both >= d2 || d2 <= ROUNDING_FRACTION * ROUNDING_FRACTION * c2 ? 1.0f : both > 0.0f ? both / d2 : 0.0f;
}

// Sums of a row and its neighbours, [row][4]: the last one counts them.
static void sum_neighbours( const wisp_fabric_level* level, const float* value, float* sum )
{
    memcpy( sum, value, 4 * (size_t)level->row_count * sizeof( float ) );
    for ( int row = 0; row < level->row_count; ++row )
    {
        sum[4 * row + 3] = 1.0f;
    }
    for ( int i = 0; i < level->schedule.slot_count; ++i )
    {
        const float fraction = level->fraction[i]; // 0 pads
        float *a = sum + level->a_x4[i], *b = sum + level->b_x4[i];
        const float *at_a = value + level->a_x4[i], *at_b = value + level->b_x4[i];
        for ( int k = 0; k < 3; ++k )
        {
            a[k] += fraction * at_b[k];
            b[k] += fraction * at_a[k];
        }
        a[3] += fraction;
        b[3] += fraction;
    }
}

// Parts of what is added to a row that the mean over it and its neighbours has at least for it to keep any, and all.
#define SHARED_BY_SOME 0.3f
#define SHARED_BY_ALL 0.6f

// The fraction that a row keeps of what is added to it, by the mean over it and its neighbours. A corner that gets it alone would
// be driven to and fro by what the sheets do to it.
static float shared_fraction( const float added[3], const float sum[4] )
{
    const float a2 = added[0] * added[0] + added[1] * added[1] + added[2] * added[2];
    const float both = ( sum[0] * added[0] + sum[1] * added[1] + sum[2] * added[2] ) / sum[3];
    return both >= SHARED_BY_ALL * a2   ? 1.0f
           : both > SHARED_BY_SOME * a2 ? ( both / a2 - SHARED_BY_SOME ) / ( SHARED_BY_ALL - SHARED_BY_SOME )
                                        : 0.0f;
}

bool levels_find_added( const wisp_fabric_level* level, const float* velocity, float* const motion[5], float* sum,
                        float* added )
{
    const float *end = motion[0], *mean = motion[3];
    float *change = motion[1], *lag = motion[2], *before = motion[4];
    double whole = 0.0, left = 0.0;
    memset( added, 0, 4 * (size_t)level->row_count * sizeof( float ) );
    for ( int row = 0; row < level->vertex_count; ++row )
    {
        const float* v = velocity + level->slot_x4[row];
        float d[3], c[3];
        for ( int k = 0, i = 4 * row; k < 3; ++k, ++i )
        {
            d[k] = end[i] - mean[i];
            c[k] = 0.5f * ( v[k] - before[i] );
            before[i] = v[k];
        }
        const float fraction = fraction_of( d, c );
        for ( int k = 0, i = 4 * row; k < 3; ++k, ++i )
        {
            added[i] = fraction * d[k];
            change[i] *= fraction;
            lag[i] *= fraction;
            whole += (double)( d[k] * d[k] );
        }
    }
    sum_neighbours( level, added, sum );
    for ( int row = 0; row < level->vertex_count; ++row )
    {
        const float fraction = shared_fraction( added + 4 * row, sum + 4 * row );
        for ( int i = 4 * row; i < 4 * row + 3; ++i )
        {
            added[i] *= fraction;
            left += (double)( added[i] * added[i] );
        }
    }
    return whole > 0.0 && left >= 0.25 * whole;
}
