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
    lane8 quarter_density, drag, lift;
} air_lanes;

// Sums of a vertex: force and the lift in it, in N, and the rate of drag in N s/m.
typedef struct air_sum
{
    lane8v force, lift;
    lane8 rate;
} air_sum;

LANE_INLINE lane8v load_corner( const float* xyzw, const int32_t* slot_x4 )
{
    lane8v v;
    lane8_load_xyz( xyzw, slot_x4, &v.x, &v.y, &v.z );
    return v;
}

// Adds one triangle. Triangles without area, without relative wind, or with a corner that is not finite, add
// nothing.
LANE_INLINE void add_triangle( const air_lanes* air, lane8v cross, lane8v mean, air_sum* sum )
{
    const lane8 one = lane8_set1( 1.0f ), tiny = lane8_set1( 1e-30f ), zero = lane8_zero();
    const lane8 third = lane8_set1( 1.0f / 3.0f );
    const lane8v u = lane8v_sub( air->wind, mean );
    const lane8 raw_area = lane8v_length( cross ), raw_speed = lane8v_length( u );
    const lane8 most = lane8_set1( FLT_MAX );
    const lane8m has_area = lane8m_and( lane8_ge( raw_area, tiny ), lane8_le( raw_area, most ) );
    const lane8m has_wind = lane8m_and( lane8_ge( raw_speed, tiny ), lane8_le( raw_speed, most ) );
    const lane8m valid = lane8m_and( has_area, has_wind );
    const lane8 twice_area = lane8_select( valid, raw_area, one ), speed = lane8_select( valid, raw_speed, one );

    const lane8 facing = lane8_div( lane8v_dot( u, cross ), twice_area ); // u . n, m/s
    const lane8m is_behind = lane8_lt( facing, zero );
    const lane8 size = lane8_select( is_behind, lane8_sub( zero, facing ), facing );
    const lane8 side = lane8_select( is_behind, lane8_set1( -1.0f ), one );
    const lane8v n = lane8v_scale( cross, lane8_div( side, twice_area ) );
    const lane8 pressure = lane8_mul( lane8_mul( air->quarter_density, twice_area ), size ); // 1/2 rho A |u . n|
    const lane8v across = lane8v_sub( lane8v_scale( n, speed ), lane8v_scale( u, lane8_div( size, speed ) ) );
    const lane8v lift = lane8v_scale( across, lane8_mul( pressure, air->lift ) );
    const lane8v force = lane8v_add( lane8v_scale( u, lane8_mul( pressure, air->drag ) ), lift );
    const lane8 rate = lane8_mul( pressure, lane8_add( air->drag, air->lift ) );

    const lane8v nothing = { zero, zero, zero };
    sum->force = lane8v_add( sum->force, lane8v_scale( lane8v_select( valid, force, nothing ), third ) );
    sum->lift = lane8v_add( sum->lift, lane8v_scale( lane8v_select( valid, lift, nothing ), third ) );
    sum->rate = lane8_add( sum->rate, lane8_div( lane8_select( valid, rate, zero ), lane8_set1( 3.0f ) ) );
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

// Applies the force. Explicit drag can reverse the velocity of a light vertex in one step; a factor implicit in the
// rate keeps it below the wind's.
void KERNEL( ring_air )( const wisp_ring_air_args* args, int begin, int end )
{
    const lane8 one = lane8_set1( 1.0f ), zero = lane8_zero(), third = lane8_set1( 1.0f / 3.0f );
    const lane8 dt = lane8_set1( args->dt );
    const lane8v nothing = { zero, zero, zero };
    const air_lanes air = { lane8v_set1( args->wind ), lane8_set1( 0.25f * args->density ), lane8_set1( args->drag ),
                            lane8_set1( args->lift ) };
    for ( int slice = begin; slice < end; ++slice )
    {
        lane8v point, old;
        lane8 weight, rest;
        lane8_load_xyzw_contiguous( args->position + (size_t)slice * 32, &point.x, &point.y, &point.z, &weight );
        lane8_load_xyzw_contiguous( args->old_velocity + (size_t)slice * 32, &old.x, &old.y, &old.z, &rest );
        air_sum sum = { nothing, nothing, zero };
        lane8v edge = nothing, velocity = old;
        for ( int e = args->ring_begin[slice]; e < args->ring_begin[slice + 1]; ++e )
        {
            const lane8v next = lane8v_sub( load_corner( args->position, args->ring_x4[e] ), point );
            const lane8v next_velocity = load_corner( args->old_velocity, args->ring_x4[e] );
            const lane8v mean = lane8v_add( lane8v_scale( lane8v_add( old, velocity ), third ),
                                            lane8v_scale( next_velocity, third ) );
            add_triangle( &air, lane8v_cross( edge, next ), mean, &sum );
            edge = next;
            velocity = next_velocity;
        }
        const lane8m moves = lane8_lt( zero, weight );
        const lane8 reach = lane8_select( moves, lane8_mul( dt, weight ), zero );
        const lane8 change = lane8_div( reach, lane8_add( one, lane8_mul( reach, sum.rate ) ) );
        lane8v blown = lane8v_add( old, lane8v_scale( sum.force, change ) );
        if ( args->lift > 0.0f )
        {
            blown = keep_energy( &air, blown, lane8v_scale( sum.lift, change ) );
        }
        const lane8v new_velocity = lane8v_select( moves, blown, old );
        lane8_store_xyzw_contiguous( args->velocity + (size_t)slice * 32, new_velocity.x, new_velocity.y,
                                     new_velocity.z, rest );
    }
}
