// Drag of air at rest on vertices, each with the area vector and the area of its part of the surface.
#include "kernel_isa.h"

#include "lane_double_vec.h"

// Limits an explicit step so that drag never reverses a velocity.
LANE_INLINE lane8v force_on( const wisp_vertex_drag_args* args, int slot, lane8v velocity, lane8 dt_w )
{
    const lane8 zero = lane8_zero(), one = lane8_set1( 1.0f );
    const lane8v vector = lane8v_load( args->vectors + (size_t)slot * 3 ), nothing = { zero, zero, zero };
    const lane8 area = lane8_loadu( args->areas + slot );
    const lane8 speed = lane8v_length( velocity ), size = lane8v_length( vector );
    // at rest, or a normal that cancels
    const lane8m large =
        lane8m_and( lane8_ge( size, lane8_mul( lane8_set1( 1e-12f ), area ) ), lane8_gt( size, zero ) );
    const lane8m acts = lane8m_and( lane8_gt( speed, zero ), large );
    const lane8 along = lane8_div( lane8v_dot( velocity, vector ), lane8_mul( speed, size ) );
    const lane8 c = lane8_mul( lane8_mul( lane8_set1( args->half_density_drag ), area ), lane8_max( along, zero ) );
    const lane8 flow = lane8_mul( c, speed ), limit = lane8_add( one, lane8_mul( flow, dt_w ) );
    return lane8v_select( acts, lane8v_scale( velocity, lane8_neg( lane8_div( flow, limit ) ) ), nothing );
}

LANE_INLINE lane8v load_velocity( const wisp_vertex_drag_args* args, int slot, lane8* last )
{
    lane8v v;
    lane8_load_xyzw_contiguous( args->velocity + (size_t)slot * 4, &v.x, &v.y, &v.z, last );
    return v;
}

LANE_INLINE lane8 load_dt_w( const wisp_vertex_drag_args* args, int slot )
{
    lane8v at;
    lane8 w;
    lane8_load_xyzw_contiguous( args->position + (size_t)slot * 4, &at.x, &at.y, &at.z, &w );
    return lane8_mul( lane8_set1( args->dt ), w );
}

void KERNEL( vertex_drag )( const wisp_vertex_drag_args* args, int begin, int end )
{
    const wisp_vertex_drag_args mine = *args;
    for ( int slot = begin; slot < end; slot += 8 )
    {
        lane8 last;
        const lane8v v = load_velocity( &mine, slot, &last );
        const lane8 dt_w = load_dt_w( &mine, slot );
        const lane8v next = lane8v_mul_add( v, dt_w, force_on( &mine, slot, v, dt_w ) );
        lane8_store_xyzw_contiguous( mine.velocity + (size_t)slot * 4, next.x, next.y, next.z, last );
    }
}

void KERNEL( sum_vertex_drag )( const wisp_vertex_drag_args* args, int begin, int end, double sum[3] )
{
    const wisp_vertex_drag_args mine = *args;
    lane8dv total = lane8dv_set1( ( double[3] ){ 0.0, 0.0, 0.0 } );
    for ( int slot = begin; slot < end; slot += 8 )
    {
        lane8 last;
        const lane8v v = load_velocity( &mine, slot, &last );
        total = lane8dv_add( total, lane8dv_widen( force_on( &mine, slot, v, load_dt_w( &mine, slot ) ) ) );
    }
    sum[0] = lane8d_sum_ordered( total.x );
    sum[1] = lane8d_sum_ordered( total.y );
    sum[2] = lane8d_sum_ordered( total.z );
}
