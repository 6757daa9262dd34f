#include "motion_oracle.h"

#include <math.h>

// Displacement along the gradient of a constraint C <= 0 that is violated by `excess`.
static double respond( motion_oracle* m, int k, double excess, double w, bool keeps_lambda )
{
    if ( keeps_lambda && m->alpha[k] > 0.0 )
    {
        const double change = ( excess - m->alpha[k] * m->lambda[k] ) / ( w + m->alpha[k] );
        const double after = fmax( 0.0, m->lambda[k] + change );
        const double moved = w * ( after - m->lambda[k] );
        m->lambda[k] = after;
        return moved;
    }
    const double fraction = m->alpha[k] > 0.0 ? w / ( w + m->alpha[k] ) : m->stiffness[k];
    return fraction * fmax( 0.0, excess );
}

static double3 hold_near( motion_oracle* m, double3 x, double w, bool keeps_lambda )
{
    const double3 e = double3_sub( x, m->target );
    const double length = double3_length( e );
    if ( isinf( m->max_distance ) || length == 0.0 )
    {
        return x;
    }
    const double moved = respond( m, 0, length - m->max_distance, w, keeps_lambda );
    return double3_add( x, double3_scale( -moved / length, e ) );
}

static double3 stop_behind( motion_oracle* m, double3 x, double w, bool keeps_lambda )
{
    const double length = double3_length( m->normal );
    if ( isinf( m->backstop_distance ) || length == 0.0 )
    {
        return x;
    }
    const double3 n = double3_scale( 1.0 / length, m->normal );
    if ( isinf( m->backstop_radius ) )
    {
        const double depth = -( double3_dot( double3_sub( x, m->target ), n ) + m->backstop_distance );
        return double3_add( x, double3_scale( respond( m, 1, depth, w, keeps_lambda ), n ) );
    }
    const double behind = m->backstop_distance + m->backstop_radius;
    const double3 a = double3_sub( x, double3_add( m->target, double3_scale( -behind, n ) ) );
    const double rho = double3_length( a );
    const double moved = respond( m, 1, m->backstop_radius - rho, w, keeps_lambda );
    return double3_add( x, rho > 0.0 ? double3_scale( moved / rho, a ) : double3_scale( moved, n ) );
}

double3 motion_oracle_project( motion_oracle* m, double3 x, double w, bool keeps_lambda )
{
    return w > 0.0 ? stop_behind( m, hold_near( m, x, w, keeps_lambda ), w, keeps_lambda ) : x;
}
