// Forces on strands before a prediction, sixteen at a time: damping towards a rigid motion, air.
#include "strand_history.h"

static const size_t STRIDE = 3 * WISP_LANES;

void KERNEL( strand_damp )( const wisp_strand_damp_args* args, int begin, int end )
{
    const wisp_strand_damp_args mine = *args;
    const lane16v linear = lane16v_set1( mine.linear ), angular = lane16v_set1( mine.angular );
    const lane16v centre = lane16v_set1( mine.centre );
    const lane16 one = lane16_set1( 1.0f ), rate = lane16_set1( mine.rate );
    for ( int g = begin; g < end; ++g )
    {
        const lane16 dt = history16_dt( &mine.history, mine.group_row[g], mine.dt );
        const lane16 keep = lane16_div( one, lane16_add( one, lane16_mul( rate, dt ) ) );
        for ( int row = mine.group_row[g]; row < mine.group_row[g + 1]; ++row )
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
}

// Applies drag to half of the two segments at a vertex, in the direction from neighbour to neighbour. With a = drag
// L |u| w dt of the normal wind u, the vertex gains a / (1 + a) of u, however strong the wind.
void KERNEL( strand_air )( const wisp_strand_air_args* args, int begin, int end )
{
    const wisp_strand_air_args mine = *args;
    const lane16 zero = lane16_zero(), one = lane16_set1( 1.0f ), tiny = lane16_set1( 1e-30f );
    const lane16 half_drag = lane16_set1( 0.5f * mine.drag );
    const lane16v wind = lane16v_set1( mine.wind );
    for ( int g = begin; g < end; ++g )
    {
        const lane16 half_drag_dt =
            lane16_mul( half_drag, history16_dt( &mine.history, mine.group_row[g], mine.dt ) );
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
