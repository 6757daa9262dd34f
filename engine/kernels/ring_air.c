// Air on the triangles around a vertex: drag along the relative wind and lift perpendicular to it, proportional to
// the projected area. A triangle of area A with unit normal n and mean velocity v, u = wind - v, has the force
//
//   F = 1/2 rho A |u . n| ( C_d u + C_l ( |u| n' - (u . n') / |u| u ) ),   n' = n or -n, with u . n' >= 0,
//
// so drag is 1/2 rho C_d A |u|^2 if u is along n, and lift is perpendicular to u. Each vertex sums a third of the
// forces of its triangles over its ring: no scatter, and sums are in ring order.
#include "kernel_isa.h"

typedef struct air_lanes
{
    lane8v wind;
    lane8 drag, lift, rate; // factors of the sums, of C_d, C_l and both
} air_lanes;

// Sums over the triangles of a vertex, without the factors of air_lanes.
typedef struct air_sum
{
    lane8v drag, lift;
    lane8 flow; // m^3/s, the rate of drag
} air_sum;

// Adds one triangle. With c = 2 A n, a triangle of any area has 2 A |u . n| = |c . u| and the lift
//
//   2 A |u . n| ( |u| n' - (u . n') / |u| u ) = (c . u) / (|c| |u|) ( |u|^2 c - (c . u) u )
//
// so drag needs no root, and lift one root and one division. Here u is three times the relative wind. Triangles with
// a corner that is not finite add nothing.
LANE_INLINE void add_triangle( lane8v c, lane8v u, bool lifts, air_sum* sum )
{
    const lane8 one = lane8_set1( 1.0f ), zero = lane8_zero();
    lane8 uu = lane8v_dot( u, u ), squares = lane8_mul( lane8v_dot( c, c ), uu );
    const lane8m finite = lane8_le( squares, lane8_set1( FLT_MAX ) );
    if ( lane8m_all( finite ) == false ) // hardly ever
    {
        const lane8v nothing = { zero, zero, zero };
        c = lane8v_select( finite, c, nothing );
        u = lane8v_select( finite, u, nothing );
        uu = lane8_select( finite, uu, zero );
        squares = lane8_select( finite, squares, zero );
    }
    const lane8 through = lane8v_dot( c, u ), flow = lane8_abs( through );
    sum->drag = lane8v_mul_add( sum->drag, flow, u );
    sum->flow = lane8_add( sum->flow, flow );
    if ( lifts )
    {
        const lane8m flows = lane8_ge( squares, lane8_set1( FLT_MIN ) );
        squares = lane8_select( flows, squares, one );
        const lane8 cosine = lane8_mul( lane8_div( through, squares ), lane8_sqrt( squares ) ); // side by side
        const lane8v across = lane8v_sub( lane8v_scale( c, uu ), lane8v_scale( u, through ) );
        sum->lift = lane8v_mul_add( sum->lift, cosine, across );
    }
}

// Lift is perpendicular to the relative wind and does no work in its frame. An explicit step across a velocity lengthens it all the
// same, by the square of the step, which makes a light vertex faster and faster: take that square out of the relative speed.
LANE_INLINE lane8v keep_energy( const air_lanes* air, lane8v velocity, lane8v step )
{
    const lane8 zero = lane8_zero();
    const lane8v relative = lane8v_sub( velocity, air->wind );
    const lane8 square = lane8v_dot( relative, relative );
    const lane8m moves = lane8_lt( zero, square );
    const lane8 left = lane8_max( lane8_sub( square, lane8v_dot( step, step ) ), zero );
    const lane8 kept = lane8_sqrt( lane8_div( left, lane8_select( moves, square, lane8_set1( 1.0f ) ) ) );
    return lane8v_add( air->wind, lane8v_scale( relative, kept ) );
}

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
LANE_INLINE air_sum walk_ring( const wisp_ring_air_args* args, int slice, lane8v point, lane8v own, bool lifts )
{
    const lane8v nothing = { lane8_zero(), lane8_zero(), lane8_zero() };
    const int begin = args->ring_begin[slice], end = args->ring_begin[slice + 1];
    air_sum sum = { nothing, nothing, lane8_zero() };
    air_corner last = begin < end ? load_corner( args, point, begin ) : ( air_corner ){ nothing, nothing };
    for ( int e = begin + 1; e < end; ++e )
    {
        const air_corner next = load_corner( args, point, e );
        const lane8v u = lane8v_sub( lane8v_sub( own, last.velocity ), next.velocity );
        add_triangle( lane8v_cross( last.edge, next.edge ), u, lifts, &sum );
        last = next;
    }
    return sum;
}

// Factors of the vertices of a slice.
LANE_INLINE air_lanes scale_air( const wisp_ring_air_args* args, const air_lanes* all, int slice )
{
    const lane8 one = lane8_set1( 1.0f );
    const lane8 drag = args->drag_factor != NULL ? lane8_loadu( args->drag_factor + (size_t)slice * 8 ) : one;
    const lane8 lift = args->lift_factor != NULL ? lane8_loadu( args->lift_factor + (size_t)slice * 8 ) : one;
    const lane8 once = lane8_set1( args->density / 36.0f );
    air_lanes air = *all;
    air.drag = lane8_mul( drag, air.drag );
    air.lift = lane8_mul( lift, air.lift );
    air.rate = lane8_mul(
        once, lane8_add( lane8_mul( drag, lane8_set1( args->drag ) ), lane8_mul( lift, lane8_set1( args->lift ) ) ) );
    return air;
}

// Applies the force. Explicit drag can reverse the velocity of a light vertex in one step; a factor implicit in the
// rate keeps it below the wind's.
// @param mapped vertices have factors of the coefficients
LANE_INLINE void blow( const wisp_ring_air_args* args, int begin, int end, bool lifts, bool mapped )
{
    const lane8 one = lane8_set1( 1.0f ), zero = lane8_zero(), dt = lane8_set1( args->dt );
    // a third of 1/2 rho, of sums with twice the area and with three times the wind, squared or once
    const float twice = args->density / 108.0f, once = args->density / 36.0f;
    const air_lanes all = { lane8v_set1( args->wind ), lane8_set1( twice * args->drag ),
                            lane8_set1( twice * args->lift ), lane8_set1( once * ( args->drag + args->lift ) ) };
    const lane8v wind_x3 = lane8v_scale( all.wind, lane8_set1( 3.0f ) );
    for ( int slice = begin; slice < end; ++slice )
    {
        const air_lanes air = mapped ? scale_air( args, &all, slice ) : all;
        lane8v point, old;
        lane8 weight, rest;
        lane8_load_xyzw_contiguous( args->position + (size_t)slice * 32, &point.x, &point.y, &point.z, &weight );
        lane8_load_xyzw_contiguous( args->old_velocity + (size_t)slice * 32, &old.x, &old.y, &old.z, &rest );
        const air_sum sum = walk_ring( args, slice, point, lane8v_sub( wind_x3, old ), lifts );
        const lane8m moves = lane8_lt( zero, weight );
        const lane8 reach = lane8_select( moves, lane8_mul( dt, weight ), zero );
        const lane8 change =
            lane8_div( reach, lane8_add( one, lane8_mul( reach, lane8_mul( air.rate, sum.flow ) ) ) );
        lane8v blown = lane8v_mul_add( old, lane8_mul( change, air.drag ), sum.drag );
        if ( lifts )
        {
            const lane8v step = lane8v_scale( sum.lift, lane8_mul( change, air.lift ) );
            blown = keep_energy( &air, lane8v_add( blown, step ), step );
        }
        const lane8v new_velocity = lane8v_select( moves, blown, old );
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
