#include "seam_oracle.h"

double seam_oracle_close( double rest, double distance, double step )
{
    return fabs( rest - distance ) <= step ? distance : rest > distance ? rest - step : rest + step;
}

void seam_oracle_project( seam_oracle_pair* pair, double3* a, double3* b, const double w[2], double alpha )
{
    const double3 d = double3_sub( *a, *b );
    const double length = double3_length( d ), sum = w[0] + w[1];
    if ( sum == 0.0 || ( pair->rest > 0.0 && length == 0.0 ) )
    {
        return;
    }
    double3 change;
    if ( pair->rest > 0.0 )
    {
        const double3 n = double3_scale( 1.0 / length, d );
        const double C = length - pair->rest, lambda = double3_dot( n, pair->lambda );
        change = double3_scale( -( C + alpha * lambda ) / ( sum + alpha ), n );
    }
    else
    {
        change = double3_scale( -1.0 / ( sum + alpha ), double3_add_scaled( d, alpha, pair->lambda ) );
    }
    pair->lambda = double3_add( pair->lambda, change );
    *a = double3_add_scaled( *a, w[0], change );
    *b = double3_add_scaled( *b, -w[1], change );
}

double seam_oracle_force( const seam_oracle_pair* pair, double dt )
{
    return double3_length( pair->lambda ) / ( dt * dt );
}
