// Air on the triangles around a vertex: drag along the relative wind and lift perpendicular to it, proportional to
// the projected area. A triangle of area A with unit normal n and mean velocity v, u = wind - v, has the force
//
//   F = 1/2 rho A |u . n| ( C_d u + C_l ( |u| n' - (u . n') / |u| u ) ),   n' = n or -n, with u . n' >= 0,
//
// so drag is 1/2 rho C_d A |u|^2 if u is along n, and lift is perpendicular to u. Each vertex sums a third of the
// forces of its triangles over its ring: no scatter, and sums are in ring order.
#include "kernel_isa.h"

#define LANE_P lane8
#include "air_text.h"
#undef LANE_P

#define LANE_P lane16
#include "air_text.h"
#undef LANE_P

// A corner of a triangle next to a vertex.
typedef struct air_corner
{
    lane8v edge; // from the vertex
    lane8v velocity;
} air_corner;

LANE_INLINE air_corner load_corner( const wisp_ring_air_args* args, lane8v point, int entry )
{
    const int32_t* slot_x4 = args->ring_x4[entry];
    air_corner c;
    lane8_load_xyz( args->position, slot_x4, &c.edge.x, &c.edge.y, &c.edge.z );
    lane8_load_xyz( args->old_velocity, slot_x4, &c.velocity.x, &c.velocity.y, &c.velocity.z );
    c.edge = lane8v_sub( c.edge, point );
    return c;
}

// @param own three times the wind without the velocity of the vertex
LANE_INLINE lane8_air_sum walk_ring( const wisp_ring_air_args* args, int slice, lane8v point, lane8v own, bool lifts )
{
    const lane8v nothing = { lane8_zero(), lane8_zero(), lane8_zero() };
    const int begin = args->ring_begin[slice], end = args->ring_begin[slice + 1];
    lane8_air_sum sum = { nothing, nothing, lane8_zero() };
    air_corner last = begin < end ? load_corner( args, point, begin ) : ( air_corner ){ nothing, nothing };
    for ( int e = begin + 1; e < end; ++e )
    {
        const air_corner next = load_corner( args, point, e );
        const lane8v u = lane8v_sub( lane8v_sub( own, last.velocity ), next.velocity );
        lane8_add_triangle( lane8v_cross( last.edge, next.edge ), u, lifts, &sum );
        last = next;
    }
    return sum;
}

// Factors of the vertices of a slice.
LANE_INLINE lane8_air scale_air( const wisp_ring_air_args* args, const lane8_air* all, int slice )
{
    const lane8 one = lane8_set1( 1.0f );
    const lane8 drag = args->drag_factor != NULL ? lane8_loadu( args->drag_factor + (size_t)slice * 8 ) : one;
    const lane8 lift = args->lift_factor != NULL ? lane8_loadu( args->lift_factor + (size_t)slice * 8 ) : one;
    const lane8 once = lane8_set1( args->density / 36.0f );
    lane8_air air = *all;
    air.drag = lane8_mul( drag, air.drag );
    air.lift = lane8_mul( lift, air.lift );
    air.rate = lane8_mul(
        once, lane8_add( lane8_mul( drag, lane8_set1( args->drag ) ), lane8_mul( lift, lane8_set1( args->lift ) ) ) );
    return air;
}

// @param mapped vertices have factors of the coefficients
LANE_INLINE void blow( const wisp_ring_air_args* args, int begin, int end, bool lifts, bool mapped )
{
    const lane8 dt = lane8_set1( args->dt );
    const lane8m every = lane8_le( dt, dt );
    // a third of 1/2 rho, of sums with twice the area and with three times the wind, squared or once
    const float twice = args->density / 108.0f, once = args->density / 36.0f;
    const lane8_air all = { lane8v_set1( args->wind ), lane8_set1( twice * args->drag ),
                            lane8_set1( twice * args->lift ), lane8_set1( once * ( args->drag + args->lift ) ) };
    const lane8v wind_x3 = lane8v_scale( all.wind, lane8_set1( 3.0f ) );
    for ( int slice = begin; slice < end; ++slice )
    {
        const lane8_air air = mapped ? scale_air( args, &all, slice ) : all;
        lane8v point, old;
        lane8 weight, rest;
        lane8_load_xyzw_contiguous( args->position + (size_t)slice * 32, &point.x, &point.y, &point.z, &weight );
        lane8_load_xyzw_contiguous( args->old_velocity + (size_t)slice * 32, &old.x, &old.y, &old.z, &rest );
        const lane8_air_sum sum = walk_ring( args, slice, point, lane8v_sub( wind_x3, old ), lifts );
        const lane8v new_velocity = lane8_blow( &air, old, weight, dt, &sum, lifts, every );
        lane8_store_xyzw_contiguous( args->velocity + (size_t)slice * 32, new_velocity.x, new_velocity.y,
                                     new_velocity.z, rest );
    }
}

void KERNEL( ring_air )( const wisp_ring_air_args* args, int begin, int end )
{
    const bool mapped = args->drag_factor != NULL || args->lift_factor != NULL;
    if ( mapped )
    {
        blow( args, begin, end, true, true );
    }
    else if ( args->lift > 0.0f )
    {
        blow( args, begin, end, true, false );
    }
    else
    {
        blow( args, begin, end, false, false );
    }
}

// ---- instances side by side ----

enum
{
    LANES = WISP_INSTANCE_LANES,
    ROW = 4 * LANES,
    VECTOR = 3 * LANES,
};

// Walk the fan of a vertex. Its padding repeats the last neighbour, whose triangles would add nothing.
LANE_INLINE lane16_air_sum walk_fan( const wisp_instances_air_args* air, const wisp_instances_args* args, int slot,
                                     lane16v own, bool lifts )
{
    const lane16v nothing = { lane16_zero(), lane16_zero(), lane16_zero() };
    const int begin = air->ring_begin[slot / 8], end = air->ring_begin[slot / 8 + 1];
    lane16_air_sum sum = { nothing, nothing, lane16_zero() };
    const lane16v point = lane16v_load( args->position + (size_t)slot * ROW );
    lane16v last_edge = nothing, last_velocity = nothing;
    for ( int e = begin; e < end; ++e )
    {
        const int32_t x4 = air->ring_x4[e][slot % 8];
        if ( e > begin && x4 == air->ring_x4[e - 1][slot % 8] )
        {
            continue;
        }
        const lane16v edge = lane16v_sub( lane16v_load( args->position + (size_t)x4 * LANES ), point ),
                      velocity = lane16v_load( air->old_velocity + (size_t)( x4 / 4 ) * VECTOR );
        if ( e > begin )
        {
            const lane16v u = lane16v_sub( lane16v_sub( own, last_velocity ), velocity );
            lane16_add_triangle( lane16v_cross( last_edge, edge ), u, lifts, &sum );
        }
        last_edge = edge;
        last_velocity = velocity;
    }
    return sum;
}

LANE_INLINE void blow_instances( const wisp_instances_air_args* air, const wisp_instances_args* args, bool lifts )
{
    const lane16 dt = lane16_set1( args->dt ), density = lane16_loadu( air->density ),
                 drag = lane16_loadu( air->drag ), lift = lane16_loadu( air->lift );
    const lane16 twice = lane16_div( density, lane16_set1( 108.0f ) ),
                 once = lane16_div( density, lane16_set1( 36.0f ) );
    const lane16_air all = { { lane16_loadu( air->wind ), lane16_loadu( air->wind + LANES ),
                               lane16_loadu( air->wind + 2 * LANES ) },
                             lane16_mul( twice, drag ),
                             lane16_mul( twice, lift ),
                             lane16_mul( once, lane16_add( drag, lift ) ) };
    const lane16m lifting = lane16_lt( lane16_zero(), lift );
    const lane16v wind_x3 = lane16v_scale( all.wind, lane16_set1( 3.0f ) );
    for ( int slot = 0; slot < args->slot_count; ++slot )
    {
        const lane16v old = lane16v_load( air->old_velocity + (size_t)slot * VECTOR );
        const lane16 weight = lane16_load( args->position + (size_t)slot * ROW + 3 * LANES );
        const lane16_air_sum sum = walk_fan( air, args, slot, lane16v_sub( wind_x3, old ), lifts );
        lane16v_store( args->velocity + (size_t)slot * VECTOR,
                       lane16_blow( &all, old, weight, dt, &sum, lifts, lifting ) );
    }
}

void KERNEL( instances_air )( const wisp_instances_args* args, const wisp_instances_air_args* air )
{
    bool lifts = false;
    for ( int lane = 0; lane < LANES; ++lane )
    {
        lifts = lifts || air->lift[lane] > 0.0f;
    }
    lifts ? blow_instances( air, args, true ) : blow_instances( air, args, false );
}
