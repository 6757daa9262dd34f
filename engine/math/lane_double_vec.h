/// wisp/module/vec.h in lanes of doubles: eight vectors, one a lane, operation by operation as there.
///
///   lane8dv_set1( const double[3] )
///   lane8dv_widen( lane8v ) lane8dv_narrow( a )   exact; round to nearest
///   lane8dv_add lane8dv_sub lane8dv_scale lane8dv_cross lane8dv_length lane8dv_select
#pragma once

#include "lane_double.h"
#include "lane_vec.h"

typedef struct lane8dv
{
    lane8d x, y, z;
} lane8dv;

LANE_INLINE lane8dv lane8dv_set1( const double a[3] )
{
    return ( lane8dv ){ lane8d_set1( a[0] ), lane8d_set1( a[1] ), lane8d_set1( a[2] ) };
}

LANE_INLINE lane8dv lane8dv_widen( lane8v a )
{
    return ( lane8dv ){ lane8d_widen( a.x ), lane8d_widen( a.y ), lane8d_widen( a.z ) };
}

LANE_INLINE lane8v lane8dv_narrow( lane8dv a )
{
    return ( lane8v ){ lane8d_narrow( a.x ), lane8d_narrow( a.y ), lane8d_narrow( a.z ) };
}

LANE_INLINE lane8dv lane8dv_add( lane8dv a, lane8dv b )
{
    return ( lane8dv ){ lane8d_add( a.x, b.x ), lane8d_add( a.y, b.y ), lane8d_add( a.z, b.z ) };
}

LANE_INLINE lane8dv lane8dv_sub( lane8dv a, lane8dv b )
{
    return ( lane8dv ){ lane8d_sub( a.x, b.x ), lane8d_sub( a.y, b.y ), lane8d_sub( a.z, b.z ) };
}

LANE_INLINE lane8dv lane8dv_scale( lane8dv a, lane8d s )
{
    return ( lane8dv ){ lane8d_mul( a.x, s ), lane8d_mul( a.y, s ), lane8d_mul( a.z, s ) };
}

LANE_INLINE lane8dv lane8dv_cross( lane8dv a, lane8dv b )
{
    return ( lane8dv ){
        lane8d_sub( lane8d_mul( a.y, b.z ), lane8d_mul( a.z, b.y ) ),
        lane8d_sub( lane8d_mul( a.z, b.x ), lane8d_mul( a.x, b.z ) ),
        lane8d_sub( lane8d_mul( a.x, b.y ), lane8d_mul( a.y, b.x ) ),
    };
}

LANE_INLINE lane8d lane8dv_length( lane8dv a )
{
    return lane8d_sqrt(
        lane8d_add( lane8d_add( lane8d_mul( a.x, a.x ), lane8d_mul( a.y, a.y ) ), lane8d_mul( a.z, a.z ) ) );
}

LANE_INLINE lane8dv lane8dv_select( lane8dm m, lane8dv a, lane8dv b )
{
    return ( lane8dv ){ lane8d_select( m, a.x, b.x ), lane8d_select( m, a.y, b.y ), lane8d_select( m, a.z, b.z ) };
}
