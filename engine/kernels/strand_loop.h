/// Strands whose last vertex is their first. The rows of both have the same mass, and the same place and velocity from
/// the start of a kernel to its end; other passes may move them apart.
#pragma once

#include "strand_place.h"
#include "kernel_isa.h"

/// Select lanes whose last segment is that from `row` to the next one.
/// @param measure [row][16] of the segment from a row to the next, above 0; 0 beyond the last
LANE_INLINE lane16m loop16_ends( const float* measure, int row )
{
    const lane16 zero = lane16_zero();
    const lane16 own = lane16_load( measure + (size_t)row * WISP_LANES ),
                 next = lane16_load( measure + (size_t)( row + 1 ) * WISP_LANES );
    return lane16m_and( lane16_lt( zero, own ), lane16_le( next, zero ) );
}

/// Gather three floats a row of the last segment of each lane.
LANE_INLINE lane16v loop16_gather( const float* measure, const float* rows, int first, int last )
{
    lane16v out = { lane16_zero(), lane16_zero(), lane16_zero() };
    for ( int row = first; row + 1 < last; ++row )
    {
        out = lane16v_select( loop16_ends( measure, row ), lane16v_load( rows + (size_t)row * 3 * WISP_LANES ), out );
    }
    return out;
}

/// Columns of a kernel that it writes.
typedef struct loop_columns
{
    place_columns read;
    float *position, *previous, *low, *velocity;
} loop_columns;

/// Make the last vertex of each loop its first.
LANE_INLINE void loop16_copy( const loop_columns* c, const float* measure, int first, int last )
{
    const size_t stride = 3 * WISP_LANES, from = (size_t)first * stride;
    for ( int row = first; row + 1 < last; ++row )
    {
        const lane16m ends = loop16_ends( measure, row );
        float* const columns[] = { c->position, c->previous, c->low, c->velocity };
        for ( int k = 0; lane16m_any( ends ) && k < 4; ++k )
        {
            if ( columns[k] != NULL )
            {
                float* at = columns[k] + (size_t)( row + 1 ) * stride;
                lane16v_store( at, lane16v_select( ends, lane16v_load( columns[k] + from ), lane16v_load( at ) ) );
            }
        }
    }
}

/// Put the last vertex of each loop where its first is, with the mean of what other passes made of both velocities.
LANE_INLINE void loop16_join( const loop_columns* c, const float* measure, int first, int last, lane16 dt )
{
    const size_t stride = 3 * WISP_LANES, from = (size_t)first * stride;
    const lane16v end = loop16_gather( measure, c->velocity + stride, first, last );
    const lane16v own = lane16v_load( c->velocity + from );
    const lane16v mean = lane16v_mul_add( own, lane16_set1( 0.5f ), lane16v_sub( end, own ) );
    lane16v_store( c->velocity + from, mean );
    if ( c->previous != NULL )
    {
        place16_follow( &c->read, c->position, first, dt );
    }
    loop16_copy( c, measure, first, last );
}

// ---- chains of strands ----

// A recurrence along a strand has to finish each row before the next. Where sixteen lanes fit one register, two
// groups are interleaved so that their latencies overlap. Where they need several registers, these overlap by
// themselves.

#define CHAINS ( LANE16_REGISTERS == 1 ? 2 : 1 )

/// Return how many groups from `g` on can be interleaved: CHAINS if all have the same number of rows, otherwise
/// one.
static inline int strand_groups_alike( const int32_t* group_row, int g, int end )
{
    if ( CHAINS > 1 && g + CHAINS <= end && group_row[g + 2] - group_row[g + 1] == group_row[g + 1] - group_row[g] )
    {
        return CHAINS;
    }
    return 1;
}
