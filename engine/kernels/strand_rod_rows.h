// Rods, part of strand_rod.c: the scratch of a row, segments and their directions, and the two bands of factors.
#pragma once

#include "strand_frame.h"
#include "strand_history.h"
#include "strand_loop.h"

static const size_t STRIDE = 3 * WISP_LANES;
static const size_t QUATERNION = 4 * WISP_LANES;

// Offsets in the scratch of a row.
enum
{
    ROW = 15 * WISP_LANES,
    REST_VECTOR = 0,            // w_i k_i in world space, [3]
    TURNED = 3 * WISP_LANES,    // z x w_i k_i, [3]
    MOMENT = 6 * WISP_LANES,    // T_i
    SLOPE = 7 * WISP_LANES,     // second derivative of the bending energy by a rotation of the middle frame
    LOAD = 8 * WISP_LANES,      // b_i
    COUPLING = 9 * WISP_LANES,  // of the twist
    RATIO = 10 * WISP_LANES,    // r_i
    TURN = 11 * WISP_LANES,     // rotation of a segment about itself, rad
    BINORMAL = 12 * WISP_LANES, // kb_i, [3]
    TURNING =
        12 * WISP_LANES,     // twice what twist and rest curvature add to the gradient by the segment from this row,
                             // times its length, [3]; reuses kb_i
    FACTOR = 3 * WISP_LANES, // of strands of both orders, [3]; reuses z x w_i k_i
    SOLVED = 6 * WISP_LANES, // y of the bending solve, [3]; reuses T_i, slope and load
};

// Offsets in the scratch of a row of rods with an elliptic section.
enum
{
    SECTION_ROW = 8 * WISP_LANES,
    SOFT = 0,                // s_i in world space, [3]
    EDGE = 3 * WISP_LANES,   // z x s_i, [3]
    ACROSS = 6 * WISP_LANES, // C_i . s_i
    ALONG = 7 * WISP_LANES,  // (t_i - t_{i-1}) . (z x s_i), its derivative by a rotation of the middle frame
};

// The length of the implicit step of each strand of a group.
typedef struct step_lanes
{
    lane16 dt, inverse_dt; // s, 1/s
    lane16m first_order;   // strands whose factors are first_order_factor
} step_lanes;

static step_lanes step_of( const wisp_strand_rod_args* args, int group )
{
    const lane16 whole = lane16_set1( args->dt ), zero = lane16_zero();
    if ( args->history.step == NULL )
    {
        return ( step_lanes ){ whole, lane16_set1( 1.0f / args->dt ), lane16_lt( zero, zero ) };
    }
    const lane16 dt = history16_dt( &args->history, args->group_row[group], args->dt );
    return ( step_lanes ){ dt, lane16_div( lane16_set1( 1.0f ), dt ), lane16_eq( dt, whole ) };
}

LANE_INLINE lane16 lanes_of( const float* column, int row )
{
    return lane16_load( column + (size_t)row * WISP_LANES );
}

LANE_INLINE place_columns columns_of( const wisp_strand_rod_args* args )
{
    return ( place_columns ){ args->position, args->previous, args->low, args->velocity, args->inverse_mass };
}

// Returns the vector of a segment, from the next row to this one, as the rod moves it.
LANE_INLINE float* segment_of( const wisp_strand_rod_args* args, int row )
{
    return args->segment + (size_t)row * STRIDE;
}

// Computes the direction of a segment from its vector and its rest length.
LANE_INLINE lane16v direction_of( const wisp_strand_rod_args* args, int row, lane16v segment )
{
    return lane16v_scale( segment, lane16_neg( lanes_of( args->inverse_length, row ) ) );
}

// Computes the direction of a segment from its frame, of any length.
LANE_INLINE lane16v direction_of_frame( frame16 q )
{
    return lane16v_scale( frame16_z( q ), lane16_div( lane16_set1( 1.0f ), frame16_dot( q, q ) ) );
}

// Returns the scratch of a row's section.
LANE_INLINE float* section_of( const wisp_strand_rod_args* args, int row, int first )
{
    return args->section_scratch + (size_t)( row - first ) * SECTION_ROW;
}

// Returns the row behind the last one at which a strand of the group bends.
LANE_INLINE int bending_end( const wisp_strand_rod_args* args, int last )
{
    return args->tip != NULL ? last : last - 1;
}

LANE_INLINE lane16 free_offset( const wisp_strand_rod_args* args, int row, lane16 offset )
{
    const lane16 zero = lane16_zero();
    return lane16_select( lane16_lt( zero, lanes_of( args->inverse_mass, row ) ), offset, zero );
}

// Computes the vector of a segment without the acceleration of this substep: at rest this is the current one. It
// differs only where one of the two vertices is pinned.
LANE_INLINE lane16v unaccelerated( const wisp_strand_rod_args* args, int row, lane16 offset )
{
    const lane16 change = lane16_sub( free_offset( args, row, offset ), free_offset( args, row + 1, offset ) );
    return lane16v_mul_add( lane16v_load( segment_of( args, row ) ), change, lane16v_set1( args->acceleration ) );
}

// Returns the displacement by the acceleration, scaled per strand.
LANE_INLINE lane16 acceleration_offset( const wisp_strand_rod_args* args, const step_lanes* step, int group )
{
    const lane16 minus_dt2 = lane16_mul( lane16_neg( step->dt ), step->dt );
    return args->acceleration_scale != NULL ? lane16_mul( minus_dt2, lanes_of( args->acceleration_scale, group ) )
                                            : minus_dt2;
}

// Adds a displacement of a row to its velocity.
LANE_INLINE void accelerate( const wisp_strand_rod_args* args, const step_lanes* step, int row, lane16v moved )
{
    float* velocity = args->velocity + (size_t)row * STRIDE;
    const lane16v v = lane16v_load( velocity );
    const lane16m is_free = lane16_lt( lane16_zero(), lanes_of( args->inverse_mass, row ) );
    const lane16v faster = lane16v_mul_add( v, step->inverse_dt, moved );
    lane16v_store( velocity, lane16v_select( is_free, faster, v ) );
}

// Changes a segment by the displacements of its vertices.
LANE_INLINE void stretch_segment( const wisp_strand_rod_args* args, int row, lane16v moved, lane16v moved_next )
{
    float* segment = segment_of( args, row );
    lane16v_store( segment, lane16v_add( lane16v_load( segment ), lane16v_sub( moved, moved_next ) ) );
}

// ---- the two bands of a factor ----

// The last two rows of a forward substitution.
typedef struct forward_sweep
{
    lane16v y1, y2;
} forward_sweep;

// Eliminates a row. @param factor 1/pivot, L(i, i-1), L(i, i-2)
LANE_INLINE lane16v forward_row( forward_sweep* sweep, const float* factor, lane16v right )
{
    lane16v y = lane16v_sub( right, lane16v_scale( sweep->y1, lane16_load( factor + WISP_LANES ) ) );
    y = lane16v_sub( y, lane16v_scale( sweep->y2, lane16_load( factor + 2 * WISP_LANES ) ) );
    sweep->y2 = sweep->y1;
    sweep->y1 = y;
    return y;
}

// The two rows behind, and their bands.
typedef struct backward_sweep
{
    lane16v x1, x2;
    lane16 first_band, second_band, second_band_behind;
} backward_sweep;

LANE_INLINE backward_sweep backward_begin( void )
{
    const lane16 zero = lane16_zero();
    return ( backward_sweep ){ { zero, zero, zero }, { zero, zero, zero }, zero, zero, zero };
}

// Substitutes back a row y.
LANE_INLINE lane16v backward_row( backward_sweep* sweep, const float* factor, lane16v y )
{
    lane16v x = lane16v_scale( y, lane16_load( factor ) );
    x = lane16v_sub( x, lane16v_scale( sweep->x1, sweep->first_band ) );
    x = lane16v_sub( x, lane16v_scale( sweep->x2, sweep->second_band_behind ) );
    sweep->second_band_behind = sweep->second_band;
    sweep->first_band = lane16_load( factor + WISP_LANES );
    sweep->second_band = lane16_load( factor + 2 * WISP_LANES );
    sweep->x2 = sweep->x1;
    sweep->x1 = x;
    return x;
}
