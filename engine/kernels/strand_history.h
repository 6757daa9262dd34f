/// What kernels do with the history of strands that integrate with BDF2 (wisp_strand_history).
#pragma once

#include "strand_place.h"

/// Find the length of a step of second order.
static inline float history16_short( float dt )
{
    return dt * ( 2.0f / 3.0f );
}

/// Find the length of the implicit step of each strand of a group. @param first its first row
LANE_INLINE lane16 history16_dt( const wisp_strand_history* history, int first, float dt )
{
    const lane16 whole = lane16_set1( dt );
    if ( history->step == NULL )
    {
        return whole;
    }
    const lane16 shorter = lane16_set1( history16_short( dt ) );
    const lane16 step = lane16_load( history->step + (size_t)first * WISP_LANES );
    return lane16_select( lane16_eq( step, shorter ), shorter, whole );
}

/// Columns that change where a substep becomes one of Euler.
typedef struct restarted_columns
{
    float* position; // null: it stays at the start of the substep
    float *low, *velocity;
} restarted_columns;

/// Make the substep of some strands one of Euler. They stay where they are, but did not come there from a shifted start:
/// the velocity is that of the whole way. So a vertex that a body holds does not bounce off it. The next substep has no
/// history to look back on.
static inline void history16_break( const wisp_strand_history* history, const place_columns* c,
                                    const restarted_columns* out, int first, int last, float dt, lane16m lanes )
{
    const lane16 zero = lane16_zero(), whole = lane16_set1( dt ), inverse = lane16_set1( 1.0f / dt );
    const lane16v none = { zero, zero, zero };
    float* step = history->step + (size_t)first * WISP_LANES;
    const lane16 own = history16_dt( history, first, dt ), ratio = lane16_mul( own, inverse );
    const lane16m second = lane16m_and( lanes, lane16_lt( own, whole ) );
    lane16_store( step, lane16_select( lanes, lane16_set1( -2.0f * dt ), lane16_load( step ) ) );
    const lane16 changed = history16_dt( history, first, dt );
    for ( int row = first; row < last && lane16m_any( second ); ++row )
    {
        const size_t at = (size_t)row * 3 * WISP_LANES;
        const lane16m moves =
            lane16m_and( second, lane16_lt( zero, lane16_load( c->inverse_mass + (size_t)row * WISP_LANES ) ) );
        const lane16v shift = lane16v_load( history->displacement + at ), low = lane16v_load( out->low + at );
        const lane16v v = lane16v_load( out->velocity + at );
        const lane16v slowed = lane16v_mul_add( lane16v_scale( v, ratio ), inverse, shift );
        lane16v_store( out->velocity + at, lane16v_select( moves, slowed, v ) );
        lane16v_store( out->low + at, lane16v_select( moves, lane16v_sub( low, shift ), low ) );
        lane16v_store( history->displacement + at, lane16v_select( moves, none, shift ) );
        if ( out->position != NULL )
        {
            place16_follow( c, out->position, row, changed );
        }
    }
}

/// Select the strands of a group that other passes moved.
static inline lane16m history16_find_moved( const place_columns* c, int first, int last, lane16 dt )
{
    const lane16 zero = lane16_zero();
    lane16m moved = lane16_lt( zero, zero );
    for ( int row = first; row < last; ++row )
    {
        const place16 p = place16_load( c, row, dt, true );
        const lane16v correction = place16_correction( c, row, &p );
        const lane16 size = lane16_add( lane16_add( lane16_abs( correction.x ), lane16_abs( correction.y ) ),
                                        lane16_abs( correction.z ) );
        moved = lane16m_or( moved, lane16_lt( zero, size ) );
    }
    return moved;
}

/// Let predicted positions of a group follow their velocities.
static inline void history16_follow_all( const place_columns* c, float* position, int first, int last, lane16 dt )
{
    for ( int row = first; row < last; ++row )
    {
        place16_follow( c, position, row, dt );
    }
}
