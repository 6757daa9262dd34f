/// Frames of segments in lanes: quaternions x y z w, with the z axis along the segment.
#pragma once

#include "kernel_isa.h"

typedef struct frame16
{
    lane16 x, y, z, w;
} frame16;

LANE_INLINE frame16 frame16_load( const float* rows )
{
    return ( frame16 ){ lane16_load( rows ), lane16_load( rows + WISP_LANES ), lane16_load( rows + 2 * WISP_LANES ),
                        lane16_load( rows + 3 * WISP_LANES ) };
}

LANE_INLINE void frame16_store( float* rows, frame16 q )
{
    lane16_store( rows, q.x );
    lane16_store( rows + WISP_LANES, q.y );
    lane16_store( rows + 2 * WISP_LANES, q.z );
    lane16_store( rows + 3 * WISP_LANES, q.w );
}

LANE_INLINE frame16 frame16_scale( frame16 q, lane16 s )
{
    return ( frame16 ){ lane16_mul( q.x, s ), lane16_mul( q.y, s ), lane16_mul( q.z, s ), lane16_mul( q.w, s ) };
}

LANE_INLINE frame16 frame16_add( frame16 a, frame16 b )
{
    return ( frame16 ){ lane16_add( a.x, b.x ), lane16_add( a.y, b.y ), lane16_add( a.z, b.z ),
                        lane16_add( a.w, b.w ) };
}

LANE_INLINE lane16 frame16_dot( frame16 a, frame16 b )
{
    const lane16 xy = lane16_add( lane16_mul( a.x, b.x ), lane16_mul( a.y, b.y ) );
    return lane16_add( xy, lane16_add( lane16_mul( a.z, b.z ), lane16_mul( a.w, b.w ) ) );
}

LANE_INLINE frame16 frame16_select( lane16m m, frame16 a, frame16 b )
{
    return ( frame16 ){ lane16_select( m, a.x, b.x ), lane16_select( m, a.y, b.y ), lane16_select( m, a.z, b.z ),
                        lane16_select( m, a.w, b.w ) };
}

/// Multiply quaternions: the rotation b, then a.
LANE_INLINE frame16 frame16_multiply( frame16 a, frame16 b )
{
    const lane16v u = { a.x, a.y, a.z }, v = { b.x, b.y, b.z };
    const lane16v turned = lane16v_mul_add( lane16v_mul_add( lane16v_cross( u, v ), a.w, v ), b.w, u );
    return ( frame16 ){ turned.x, turned.y, turned.z, lane16_sub( lane16_mul( a.w, b.w ), lane16v_dot( u, v ) ) };
}

/// Rotate v by a quaternion of any length, times its squared length: (w^2 - u.u) v + 2 (u.v) u + 2 w (u x v).
LANE_INLINE lane16v frame16_turn( frame16 q, lane16v v )
{
    const lane16v u = { q.x, q.y, q.z };
    const lane16 along = lane16v_dot( u, v ), own = lane16_sub( lane16_mul( q.w, q.w ), lane16v_dot( u, u ) );
    const lane16v turned = lane16v_mul_add( lane16v_scale( v, own ), lane16_add( along, along ), u );
    return lane16v_mul_add( turned, lane16_add( q.w, q.w ), lane16v_cross( u, v ) );
}

/// Compute the z axis of a quaternion of any length, times its squared length.
LANE_INLINE lane16v frame16_z( frame16 q )
{
    const lane16 two = lane16_set1( 2.0f );
    const lane16 xz = lane16_mul( q.x, q.z ), wy = lane16_mul( q.w, q.y );
    const lane16 yz = lane16_mul( q.y, q.z ), wx = lane16_mul( q.w, q.x );
    const lane16 tilt = lane16_add( lane16_mul( q.x, q.x ), lane16_mul( q.y, q.y ) );
    const lane16 stand = lane16_add( lane16_mul( q.z, q.z ), lane16_mul( q.w, q.w ) );
    return ( lane16v ){ lane16_mul( two, lane16_add( xz, wy ) ), lane16_mul( two, lane16_sub( yz, wx ) ),
                        lane16_sub( stand, tilt ) };
}

/// Normalise a quaternion; one without a finite length above 0 becomes `otherwise`.
LANE_INLINE frame16 frame16_normalise( frame16 q, frame16 otherwise )
{
    const lane16 squared = frame16_dot( q, q );
    const lane16m has_length =
        lane16m_and( lane16_lt( lane16_set1( FLT_MIN ), squared ), lane16_lt( squared, lane16_set1( FLT_MAX ) ) );
    const lane16 inverse = lane16_div( lane16_set1( 1.0f ), lane16_sqrt( squared ) );
    return frame16_select( has_length, frame16_scale( q, inverse ), otherwise );
}

/// Transport a frame by the smallest rotation that takes its z axis to the direction of e, and normalise it. If e
/// has the opposite direction, no smallest rotation exists, and the frame turns about its x axis.
/// @param length of e, above 0
LANE_INLINE frame16 frame16_transport( frame16 q, lane16v e, lane16 length )
{
    const lane16 zero = lane16_zero();
    const lane16v z = frame16_z( q ), axis = lane16v_cross( z, e );
    const lane16 whole = lane16_mul( frame16_dot( q, q ), length );
    const frame16 swing = { axis.x, axis.y, axis.z, lane16_add( whole, lane16v_dot( z, e ) ) };
    const frame16 about_x = { q.w, q.z, lane16_neg( q.y ), lane16_neg( q.x ) };
    const lane16m turns_back = lane16_lt( swing.w, lane16_mul( lane16_set1( 1e-6f ), whole ) );
    const frame16 transported = frame16_select( turns_back, about_x, frame16_multiply( swing, q ) );
    return frame16_normalise( transported, ( frame16 ){ zero, zero, zero, lane16_set1( 1.0f ) } );
}
