// Elastic rods, sixteen strands at a time. Bending is implicit in the positions, by one pentadiagonal solve. Twist
// is in equilibrium, by a tridiagonal solve. Frames are transported (discrete elastic rods of Bergou et al. 2008
// and 2010, with the rest curvature fixed during a substep). The equations are in modules/strands/rod_factors.c and
// rod_factors.c.
#include "strand_rod_twist.h"

// ---- tension ----

static void pull( const wisp_strand_rod_args* args, const step_lanes* step, int group, int first, int last )
{
    const lane16 zero = lane16_zero(), minus_dt2 = lane16_mul( lane16_neg( step->dt ), step->dt );
    const lane16 back = acceleration_offset( args, step, group );
    lane16v before = { zero, zero, zero }, moved_before = before;
    for ( int row = first; row < last; ++row )
    {
        lane16v behind = { zero, zero, zero };
        if ( row + 1 < last )
        {
            const lane16 most = lanes_of( args->max_tension, row );
            float* at = args->tension + (size_t)row * WISP_LANES;
            const lane16 tension = lane16_max( lane16_neg( most ), lane16_min( most, lane16_load( at ) ) );
            const lane16 fraction = lane16_mul( tension, lanes_of( args->inverse_length, row ) );
            lane16_store( at, tension );
            behind = lane16v_scale( unaccelerated( args, row, back ), lane16_mul( fraction, minus_dt2 ) );
        }
        const lane16v moved = lane16v_scale( lane16v_sub( behind, before ), lanes_of( args->inverse_mass, row ) );
        accelerate( args, step, row, moved );
        if ( row > first )
        {
            stretch_segment( args, row - 1, moved_before, moved );
        }
        before = behind;
        moved_before = moved;
    }
}

// ---- bending ----

// Computes the moment M_i of a vertex between directions a and b, times dt^2; `rate` is its change, times damping dt.
// An elliptic section leaves out a part of it along the soft axis, at the positions of the frames, so that an equilibrium
// of the equations is one of the substep too.
LANE_INLINE lane16v bend_vertex( const wisp_strand_rod_args* args, lane16 dt2, int row, int first, lane16v a,
                                 lane16v b, lane16v rate )
{
    const float* scratch = args->scratch + (size_t)( row - first ) * ROW;
    lane16v c = lane16v_sub( b, a );
    if ( args->frame != NULL )
    {
        c = lane16v_sub( c, lane16v_load( scratch + REST_VECTOR ) );
    }
    lane16v moment = lane16v_mul_add( rate, dt2, c );
    if ( args->flatness > 0.0f )
    {
        const float* section = section_of( args, row, first );
        const lane16v soft = lane16v_load( section + SOFT );
        const lane16 rest = lane16_mul( dt2, lane16_load( section + ACROSS ) );
        moment = lane16v_sub( moment, lane16v_scale( soft, lane16_add( rest, lane16v_dot( rate, soft ) ) ) );
    }
    return lane16v_scale( moment, lanes_of( args->stiffness, row ) );
}

// Computes the direction behind a vertex: of the segment from its row, or of a tip that is held.
LANE_INLINE lane16v direction_behind( const wisp_strand_rod_args* args, int row, int last )
{
    if ( args->tip == NULL )
    {
        return direction_of( args, row, lane16v_load( segment_of( args, row ) ) );
    }
    const lane16v tip = lane16v_load( args->tip + (size_t)row * STRIDE );
    return row + 1 < last ? lane16v_select( lane16_lt( lane16_zero(), lanes_of( args->inverse_length, row ) ),
                                            direction_of( args, row, lane16v_load( segment_of( args, row ) ) ), tip )
                          : tip;
}

// Computes the change of a segment's direction since the start of the substep.
LANE_INLINE lane16v change_of( const wisp_strand_rod_args* args, const step_lanes* step, int row )
{
    const size_t at = (size_t)row * STRIDE;
    const lane16v v = lane16v_load( args->velocity + at ), next = lane16v_load( args->velocity + at + STRIDE );
    const lane16 fraction = lane16_mul( step->dt, lanes_of( args->inverse_length, row ) );
    return lane16v_scale( lane16v_sub( next, v ), fraction );
}

// Rows of 1/pivot, L(i, i-1), L(i, i-2) of a group.
typedef struct factor_rows
{
    const float* first; // [3][16]
    size_t stride;      // floats
} factor_rows;

// Selects the factors of each strand. Where orders are mixed, they are put together in scratch.
static factor_rows factors_of( const wisp_strand_rod_args* args, const step_lanes* step, int first, int last )
{
    const size_t at = (size_t)first * STRIDE;
    if ( lane16m_any( step->first_order ) == false )
    {
        return ( factor_rows ){ args->factor + at, STRIDE };
    }
    if ( lane16m_all( step->first_order ) )
    {
        return ( factor_rows ){ args->first_order_factor + at, STRIDE };
    }
    for ( int row = first; row < last; ++row )
    {
        const size_t own = (size_t)row * STRIDE;
        lane16v_store( args->scratch + (size_t)( row - first ) * ROW + FACTOR,
                       lane16v_select( step->first_order, lane16v_load( args->first_order_factor + own ),
                                       lane16v_load( args->factor + own ) ) );
    }
    return ( factor_rows ){ args->scratch + FACTOR, ROW };
}

// Computes G_i - G_{i-1} with the gradient G_s = (M_s - M_{s+1} + turning_s / 2) / l_s by e_s. In the same sweep, y
// is that after forward substitution with the two bands of L.
static void load_and_eliminate( const wisp_strand_rod_args* args, const step_lanes* step, const factor_rows* factors,
                                int group, int first, int last )
{
    const lane16 zero = lane16_zero(), dt2 = lane16_mul( step->dt, step->dt );
    const lane16 half_dt2 = lane16_mul( lane16_mul( lane16_set1( 0.5f ), step->dt ), step->dt );
    const lane16 damping = lane16_mul( lane16_set1( args->damping ), step->dt );
    const lane16v none = { zero, zero, zero };
    lane16v t = direction_of( args, first, lane16v_load( segment_of( args, first ) ) );
    lane16v change = args->damping > 0.0f ? change_of( args, step, first ) : none;
    lane16v own = bend_vertex( args, dt2, first, first, frame16_z( clamp_frame( args, group ) ), t,
                               lane16v_scale( change, damping ) );
    lane16v before = none;
    forward_sweep sweep = { none, none };
    for ( int row = first; row < last; ++row )
    {
        float* at = args->scratch + (size_t)( row - first ) * ROW;
        lane16v gradient = none;
        if ( row + 1 < last )
        {
            lane16v next = none;
            if ( row + 1 < bending_end( args, last ) )
            {
                const lane16v u = direction_behind( args, row + 1, last );
                const lane16v now = args->damping > 0.0f && row + 2 < last ? change_of( args, step, row + 1 ) : none;
                const lane16v rate = lane16v_scale( lane16v_sub( now, change ), damping );
                next = bend_vertex( args, dt2, row + 1, first, t, u, rate );
                t = u;
                change = now;
            }
            gradient = lane16v_sub( own, next );
            if ( args->frame != NULL )
            {
                gradient = lane16v_mul_add( gradient, half_dt2, lane16v_load( at + TURNING ) );
            }
            gradient = lane16v_scale( gradient, lanes_of( args->inverse_length, row ) );
            own = next;
        }
        const float* factor = factors->first + (size_t)( row - first ) * factors->stride;
        lane16v_store( at + SOLVED, forward_row( &sweep, factor, lane16v_sub( gradient, before ) ) );
        before = gradient;
    }
}

// Substitutes back from the tip; velocities take the displacements, and predicted positions follow.
LANE_INLINE void substitute( const wisp_strand_rod_args* args, const step_lanes* step, const factor_rows* factors,
                             int first, int last, bool is_predicted )
{
    const place_columns c = columns_of( args );
    backward_sweep sweep = backward_begin();
    for ( int row = last - 1; row >= first; --row )
    {
        const float* factor = factors->first + (size_t)( row - first ) * factors->stride;
        const lane16v behind = sweep.x1;
        const lane16v x =
            backward_row( &sweep, factor, lane16v_load( args->scratch + (size_t)( row - first ) * ROW + SOLVED ) );
        accelerate( args, step, row, x );
        if ( row + 1 < last )
        {
            stretch_segment( args, row, x, behind );
        }
        if ( is_predicted )
        {
            place16_follow( &c, args->position, row, step->dt );
        }
    }
}

#include "strand_rod_closed.h"

static void bend_group( const wisp_strand_rod_args* args, int group, int first, int last )
{
    const step_lanes step = step_of( args, group );
    if ( args->response != NULL )
    {
        bend_closed_group( args, &step, group, first, last );
        return;
    }
    if ( args->frame != NULL )
    {
        const bool folds = measure_frames( args, &step, group, first, last );
        balance_twist( args, first, last );
        turn_vertices( args, group, first, last, turn_segments( args, first, last ), folds );
    }
    pull( args, &step, group, first, last );
    const factor_rows factors = factors_of( args, &step, first, last );
    load_and_eliminate( args, &step, &factors, group, first, last );
    if ( args->previous != NULL )
    {
        substitute( args, &step, &factors, first, last, true );
    }
    else
    {
        substitute( args, &step, &factors, first, last, false );
    }
}

void KERNEL( strand_rod )( const wisp_strand_rod_args* args, int begin, int end )
{
    const wisp_strand_rod_args mine = *args;
    for ( int g = begin; g < end; ++g )
    {
        const int first = mine.group_row[g], last = mine.group_row[g + 1];
        if ( last - first < 2 )
        {
            continue;
        }
        bend_group( &mine, g, first, last );
    }
}
