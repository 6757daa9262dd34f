#include "rod_theory.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

double rod_ring_twist( double ratio )
{
    return 2.0 * PI * sqrt( 3.0 ) / ratio;
}

double rod_straight_moment( double tension, double weight )
{
    return 2.0 * sqrt( tension + 0.5 * weight + PI * PI );
}

rod_writhe rod_writhe_of( double angle, double shortening, double ratio )
{
    const double t = cos( 0.5 * angle ), q = sin( 0.5 * angle ), wave = 4.0 * q / shortening, moment = 2.0 * t * wave;
    return ( rod_writhe ){
        .tension = wave * wave,
        .moment = moment,
        .rotation = moment / ratio + 2.0 * angle,
    };
}

rod_writhe rod_writhe_limit( double shortening, double ratio )
{
    return rod_writhe_of( acos( -0.5 * shortening * ratio ), shortening, ratio );
}
