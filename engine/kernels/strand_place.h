/// Places of strand vertices in two floats. A vertex is at position + low: low holds the digits that position lacks, so
/// that steps far below its last digit add up. In a substep a free vertex moves from start to start + ( low + dt v ),
/// and differences are formed part by part. So the velocity alone says how far a vertex moved, and is never made of
/// rounded positions. A pinned vertex is at its end, position + low, throughout.
#pragma once

#include "kernel_isa.h"

/// Columns of a substep.
typedef struct place_columns
{
    const float* position;     // [row][3][16] m, at the start of the substep, or predicted if there is `previous`
    const float* previous;     // [row][3][16] m, at the start of the substep; null: nothing else moves the vertices
    const float* low;          // [row][3][16] m
    const float* velocity;     // [row][3][16] m/s
    const float* inverse_mass; // [row][16] 1/kg
} place_columns;

/// A row of vertices in a substep: they are at start + moved.
typedef struct place16
{
    lane16v start, moved; // m; moved = low + dt velocity
    lane16v low, velocity;
    lane16 inverse_mass;
} place16;

LANE_INLINE lane16v place16_moved( lane16v low, lane16v velocity, lane16 inverse_mass, lane16 dt )
{
    const lane16 zero = lane16_zero();
    return lane16v_mul_add( low, lane16_select( lane16_lt( zero, inverse_mass ), dt, zero ), velocity );
}

/// Load a row. @param is_predicted there is `previous`
LANE_INLINE place16 place16_load( const place_columns* c, int row, lane16 dt, bool is_predicted )
{
    const size_t at = (size_t)row * 3 * WISP_LANES;
    const lane16v low = lane16v_load( c->low + at ), velocity = lane16v_load( c->velocity + at );
    const lane16 w = lane16_load( c->inverse_mass + (size_t)row * WISP_LANES );
    const lane16m is_free = lane16_lt( lane16_zero(), w );
    lane16v start = lane16v_load( c->position + at );
    if ( is_predicted )
    {
        start = lane16v_select( is_free, lane16v_load( c->previous + at ), start );
    }
    return ( place16 ){ start, place16_moved( low, velocity, w, dt ), low, velocity, w };
}

/// Compute what other passes did to the position, such as contacts. The sum is formed as by the pass that wrote the
/// position, so the difference is exactly 0 where no other pass moved the vertex.
LANE_INLINE lane16v place16_correction( const place_columns* c, int row, const place16* p )
{
    const lane16v position = lane16v_load( c->position + (size_t)row * 3 * WISP_LANES );
    return lane16v_sub( position, lane16v_add( p->start, p->moved ) );
}

/// Compute the vector from b to a.
LANE_INLINE lane16v place16_sub( const place16* a, const place16* b )
{
    return lane16v_add( lane16v_sub( a->start, b->start ), lane16v_sub( a->moved, b->moved ) );
}

/// Compute the part of start + moved that does not fit `end`, its rounded sum.
LANE_INLINE lane16v place16_remainder( lane16v start, lane16v moved, lane16v end )
{
    return lane16v_sub( moved, lane16v_sub( end, start ) );
}

/// Take the corrections by other passes in a group: velocities, and the vectors from the next row to each row.
LANE_INLINE void place16_take_all( const place_columns* c, float* velocity, float* segment, int first, int last,
                                   lane16 step, lane16 inverse_step )
{
    lane16v before = { lane16_zero(), lane16_zero(), lane16_zero() };
    for ( int row = first; row < last; ++row )
    {
        const size_t at = (size_t)row * 3 * WISP_LANES;
        const place16 p = place16_load( c, row, step, true );
        const lane16v correction = place16_correction( c, row, &p );
        lane16v_store( velocity + at, lane16v_mul_add( p.velocity, inverse_step, correction ) );
        if ( row > first )
        {
            float* behind = segment + at - 3 * WISP_LANES;
            lane16v_store( behind, lane16v_add( lane16v_load( behind ), lane16v_sub( before, correction ) ) );
        }
        before = correction;
    }
}

/// Let a predicted position follow its velocity.
LANE_INLINE void place16_follow( const place_columns* c, float* position, int row, lane16 dt )
{
    const place16 p = place16_load( c, row, dt, true );
    lane16v_store( position + (size_t)row * 3 * WISP_LANES, lane16v_add( p.start, p.moved ) );
}
