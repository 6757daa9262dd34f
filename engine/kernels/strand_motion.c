// Time integration of strands, sixteen at a time: prediction, velocity, damping towards a rigid motion, air.
#include "kernel_isa.h"

static const size_t STRIDE = 3 * WISP_LANES;

// Values shared by all rows of a substep.
typedef struct motion_terms
{
    lane16 dt, inverse_dt; // s, 1/s
    lane16v gain;          // m/s, dt times acceleration, of free vertices
} motion_terms;

static motion_terms motion_terms_of( const wisp_strand_motion_args* args )
{
    const lane16 dt = lane16_set1( args->dt );
    return ( motion_terms ){ dt, lane16_set1( 1.0f / args->dt ),
                             lane16v_scale( lane16v_set1( args->acceleration ), dt ) };
}

LANE_INLINE lane16m is_free_row( const wisp_strand_motion_args* args, int row )
{
    return lane16_lt( lane16_zero(), lane16_load( args->inverse_mass + (size_t)row * WISP_LANES ) );
}

// Computes v + (p - (previous + dt v)) / dt: only the change by constraints is added, to keep precision far from
// the origin.
LANE_INLINE lane16v velocity_of_row( const wisp_strand_motion_args* args, const motion_terms* terms, int row,
                                     lane16m is_free )
{
    const size_t at = (size_t)row * STRIDE;
    const lane16v v = lane16v_load( args->velocity + at );
    const lane16v predicted = lane16v_mul_add( lane16v_load( args->previous + at ), terms->dt, v );
    const lane16v moved = lane16v_sub( lane16v_load( args->position + at ), predicted );
    return lane16v_select( is_free, lane16v_mul_add( v, terms->inverse_dt, moved ), v );
}

// Moves pinned roots to their prescribed positions and sets their velocity to match.
LANE_INLINE void predict_root( const wisp_strand_motion_args* args, const motion_terms* terms, lane16v gain,
                               int group, lane16m is_free, lane16v v )
{
    const size_t at = (size_t)args->group_row[group] * STRIDE;
    const lane16v p = lane16v_load( args->position + at );
    const lane16v root = args->root != NULL ? lane16v_load( args->root + (size_t)group * STRIDE ) : p;
    const lane16v flies = lane16v_add( v, gain ),
                  carried = lane16v_scale( lane16v_sub( root, p ), terms->inverse_dt );
    lane16v_store( args->previous + at, p );
    lane16v_store( args->velocity + at, lane16v_select( is_free, flies, carried ) );
    lane16v_store( args->position + at, lane16v_select( is_free, lane16v_mul_add( p, terms->dt, flies ), root ) );
}

// Predicts a row. Pinned vertices other than roots are already at their end positions; their velocity gives their
// start.
LANE_INLINE void predict_row( const wisp_strand_motion_args* args, const motion_terms* terms, lane16v gain, int row,
                              lane16m is_free, lane16v v )
{
    const size_t at = (size_t)row * STRIDE;
    const lane16 zero = lane16_zero();
    const lane16v none = { zero, zero, zero };
    const lane16v p = lane16v_load( args->position + at );
    const lane16v gained = lane16v_add( v, lane16v_select( is_free, gain, none ) );
    const lane16v path = lane16v_scale( gained, terms->dt );
    const lane16v start = lane16v_select( is_free, p, lane16v_sub( p, path ) );
    lane16v_store( args->previous + at, start );
    lane16v_store( args->velocity + at, gained );
    lane16v_store( args->position + at, lane16v_add( start, path ) );
}

// Predicts all rows. With `takes_velocity`, velocities of the last substep are computed first.
LANE_INLINE void predict_groups( const wisp_strand_motion_args* args, int begin, int end, bool takes_velocity )
{
    const motion_terms terms = motion_terms_of( args );
    for ( int g = begin; g < end; ++g )
    {
        const lane16v gain =
            args->acceleration_scale != NULL
                ? lane16v_scale( terms.gain, lane16_load( args->acceleration_scale + (size_t)g * WISP_LANES ) )
                : terms.gain;
        const int first = args->group_row[g];
        const lane16m is_free = is_free_row( args, first );
        predict_root( args, &terms, gain, g, is_free,
                      takes_velocity ? velocity_of_row( args, &terms, first, is_free )
                                     : lane16v_load( args->velocity + (size_t)first * STRIDE ) );
        for ( int row = first + 1; row < args->group_row[g + 1]; ++row )
        {
            const lane16m free = is_free_row( args, row );
            predict_row( args, &terms, gain, row, free,
                         takes_velocity ? velocity_of_row( args, &terms, row, free )
                                        : lane16v_load( args->velocity + (size_t)row * STRIDE ) );
        }
    }
}

void KERNEL( strand_predict )( const wisp_strand_motion_args* args, int begin, int end )
{
    const wisp_strand_motion_args mine = *args;
    predict_groups( &mine, begin, end, false );
}

void KERNEL( strand_advance )( const wisp_strand_motion_args* args, int begin, int end )
{
    const wisp_strand_motion_args mine = *args;
    predict_groups( &mine, begin, end, true );
}

void KERNEL( strand_velocity )( const wisp_strand_motion_args* args, int begin, int end )
{
    const wisp_strand_motion_args mine = *args;
    const motion_terms terms = motion_terms_of( &mine );
    for ( int row = mine.group_row[begin]; row < mine.group_row[end]; ++row )
    {
        lane16v_store( mine.velocity + (size_t)row * STRIDE,
                       velocity_of_row( &mine, &terms, row, is_free_row( &mine, row ) ) );
    }
}

LANE_INLINE lane16m is_within( const float* row, lane16 bound )
{
    const lane16v v = lane16v_load( row );
    return lane16m_and( lane16m_and( lane16_le( lane16_abs( v.x ), bound ), lane16_le( lane16_abs( v.y ), bound ) ),
                        lane16_le( lane16_abs( v.z ), bound ) );
}

int KERNEL( strand_find_out_of_bounds )( const wisp_strand_bound_args* args, int begin, int end )
{
    const wisp_strand_bound_args mine = *args;
    const lane16 bound = lane16_set1( mine.bound );
    for ( int row = begin; row < end; ++row )
    {
        const size_t at = (size_t)row * STRIDE;
        const lane16m within =
            lane16m_and( is_within( mine.position + at, bound ), is_within( mine.velocity + at, bound ) );
        if ( lane16m_all( within ) == false )
        {
            return row;
        }
    }
    return end;
}

void KERNEL( strand_damp )( const wisp_strand_damp_args* args, int begin, int end )
{
    const wisp_strand_damp_args mine = *args;
    const lane16v linear = lane16v_set1( mine.linear ), angular = lane16v_set1( mine.angular );
    const lane16v centre = lane16v_set1( mine.centre );
    const lane16 keep = lane16_set1( mine.retained_fraction );
    for ( int row = mine.group_row[begin]; row < mine.group_row[end]; ++row )
    {
        const size_t at = (size_t)row * STRIDE;
        const lane16v v = lane16v_load( mine.velocity + at );
        const lane16v arm = lane16v_sub( lane16v_load( mine.position + at ), centre );
        const lane16v rigid = lane16v_add( linear, lane16v_cross( angular, arm ) );
        const lane16v damped = lane16v_mul_add( rigid, keep, lane16v_sub( v, rigid ) );
        const lane16m is_free =
            lane16_lt( lane16_zero(), lane16_load( mine.inverse_mass + (size_t)row * WISP_LANES ) );
        lane16v_store( mine.velocity + at, lane16v_select( is_free, damped, v ) );
    }
}

// Applies drag to half of the two segments at a vertex, in the direction from neighbour to neighbour. With a = drag
// L |u| w dt of the normal wind u, the vertex gains a / (1 + a) of u, however strong the wind.
void KERNEL( strand_air )( const wisp_strand_air_args* args, int begin, int end )
{
    const wisp_strand_air_args mine = *args;
    const lane16 zero = lane16_zero(), one = lane16_set1( 1.0f ), tiny = lane16_set1( 1e-30f );
    const lane16 half_drag_dt = lane16_set1( 0.5f * mine.drag * mine.dt );
    const lane16v wind = lane16v_set1( mine.wind );
    for ( int g = begin; g < end; ++g )
    {
        const int first = mine.group_row[g], last = mine.group_row[g + 1] - 1;
        lane16 length_before = zero;
        for ( int row = first; row <= last; ++row )
        {
            const size_t at = (size_t)row * STRIDE, lanes = (size_t)row * WISP_LANES;
            const lane16 length = lane16_load( mine.length + lanes );
            const lane16v from = lane16v_load( mine.position + ( row > first ? at - STRIDE : at ) );
            const lane16v to = lane16v_load( mine.position + ( row < last ? at + STRIDE : at ) );
            const lane16v own = lane16v_load( mine.position + at );
            const lane16v along = lane16v_sub( lane16v_select( lane16_lt( zero, length ), to, own ), from );
            const lane16v v = lane16v_load( mine.velocity + at ), u = lane16v_sub( wind, v );
            const lane16 fraction =
                lane16_div( lane16v_dot( u, along ), lane16_max( lane16v_dot( along, along ), tiny ) );
            const lane16v across = lane16v_sub( u, lane16v_scale( along, fraction ) );
            const lane16 reach = lane16_mul( half_drag_dt, lane16_add( length_before, length ) );
            const lane16 weight = lane16_load( mine.inverse_mass + lanes );
            const lane16 a = lane16_mul( lane16_mul( reach, weight ), lane16v_length( across ) );
            lane16v_store( mine.velocity + at, lane16v_mul_add( v, lane16_div( a, lane16_add( one, a ) ), across ) );
            length_before = length;
        }
    }
}
