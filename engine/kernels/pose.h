// Rigid transforms in lanes, with the operations of wisp/shapes.h in the same order.
#pragma once

#include "kernel_isa.h"

LANE_INLINE lane8v pose_rotate( wisp_quat rotation, lane8v v )
{
    const lane8v q = lane8v_set1( ( wisp_vec3 ){ rotation.x, rotation.y, rotation.z } );
    const lane8v t = lane8v_scale( lane8v_cross( q, v ), lane8_set1( 2.0f ) );
    return lane8v_add( lane8v_add( v, lane8v_scale( t, lane8_set1( rotation.w ) ) ), lane8v_cross( q, t ) );
}

// A rotation by nothing changes nothing but the sign of zeros: with a negative zero it is computed all the same, so
// that the bits are those of pose_rotate().
LANE_INLINE bool pose_is_turned( wisp_quat q )
{
    return !( q.x == 0.0f && q.y == 0.0f && q.z == 0.0f && q.w == 1.0f );
}

LANE_INLINE lane8v pose_rotate_if( bool is_turned, wisp_quat rotation, lane8v v )
{
    const lane8i negative_zero = lane8i_set1( INT32_MIN );
    const lane8m x = lane8i_eq( lane8_cast_int( v.x ), negative_zero ),
                 y = lane8i_eq( lane8_cast_int( v.y ), negative_zero ),
                 z = lane8i_eq( lane8_cast_int( v.z ), negative_zero );
    return is_turned || lane8m_any( lane8m_or( lane8m_or( x, y ), z ) ) ? pose_rotate( rotation, v ) : v;
}

LANE_INLINE lane8v pose_to_world( wisp_transform pose, bool is_turned, lane8v local )
{
    return lane8v_add( pose_rotate_if( is_turned, pose.rotation, local ), lane8v_set1( pose.translation ) );
}

LANE_INLINE lane8v pose_to_local( wisp_transform pose, bool is_turned, lane8v world )
{
    const wisp_quat q = pose.rotation;
    return pose_rotate_if( is_turned, ( wisp_quat ){ -q.x, -q.y, -q.z, q.w },
                           lane8v_sub( world, lane8v_set1( pose.translation ) ) );
}
