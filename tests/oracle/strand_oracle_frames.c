// Rotations and transported frames.
#include "strand_oracle_rod.h"

strand_oracle_quaternion strand_oracle_product( strand_oracle_quaternion a, strand_oracle_quaternion b )
{
    const double3 u = { a.x, a.y, a.z }, v = { b.x, b.y, b.z };
    const double3 sum = double3_add_scaled( double3_add_scaled( double3_cross( u, v ), a.w, v ), b.w, u );
    return ( strand_oracle_quaternion ){ sum.x, sum.y, sum.z, a.w * b.w - double3_dot( u, v ) };
}

double3 strand_oracle_turned( strand_oracle_quaternion q, double3 v )
{
    const double3 u = { q.x, q.y, q.z };
    const double3 across = double3_scale( 2.0, double3_cross( u, v ) );
    return double3_add( double3_add_scaled( v, q.w, across ), double3_cross( u, across ) );
}

strand_oracle_quaternion strand_oracle_smallest( double3 from, double3 to )
{
    const strand_oracle_quaternion none = { 0.0, 0.0, 0.0, 1.0 };
    const double3 axis = double3_cross( from, to );
    const double cosine = double3_dot( from, to );
    if ( 1.0 + cosine > 1e-12 )
    {
        return quaternion_normalised( ( strand_oracle_quaternion ){ axis.x, axis.y, axis.z, 1.0 + cosine }, none );
    }
    const bool min_x_is = fabs( from.x ) <= fabs( from.y ) && fabs( from.x ) <= fabs( from.z );
    const bool min_y_is = fabs( from.y ) <= fabs( from.z );
    const double3 across =
        double3_make( min_x_is ? 1.0 : 0.0, !min_x_is && min_y_is ? 1.0 : 0.0, !min_x_is && !min_y_is ? 1.0 : 0.0 );
    const double3 turn = double3_add_scaled( across, -double3_dot( across, from ), from );
    return quaternion_normalised( ( strand_oracle_quaternion ){ turn.x, turn.y, turn.z, 0.0 }, none );
}

strand_oracle_quaternion strand_oracle_carried( strand_oracle_quaternion frame, double3 e )
{
    const double length = double3_length( e );
    if ( !( length > 1e-15 ) )
    {
        return frame;
    }
    const double3 z = strand_oracle_turned( frame, rod_z );
    const strand_oracle_quaternion swing = strand_oracle_smallest( z, double3_scale( 1.0 / length, e ) );
    return quaternion_normalised( strand_oracle_product( swing, frame ), frame );
}
