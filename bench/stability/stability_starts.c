#include "stability_starts.h"

#include "wisp/module/random.h"

#include <float.h>
#include <math.h>

const char* const stability_start_names[STABILITY_START_COUNT] = {
    "rest", "random", "plane", "point", "inside out", "ten twists",
};

#define TWISTS 10.0
#define FULL_TURN 6.283185307179586

stability_box stability_box_of( const wisp_vec3* points, int count )
{
    stability_box box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY }, { 0 }, 0.0 };
    for ( int i = 0; i < count; ++i )
    {
        const double p[3] = { (double)points[i].x, (double)points[i].y, (double)points[i].z };
        for ( int k = 0; k < 3; ++k )
        {
            box.lower[k] = fmin( box.lower[k], p[k] );
            box.upper[k] = fmax( box.upper[k], p[k] );
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        box.middle[k] = 0.5 * ( box.lower[k] + box.upper[k] );
        box.size = fmax( box.size, box.upper[k] - box.lower[k] );
    }
    return box;
}

static wisp_vec3 vec3_of( const double p[3] )
{
    return ( wisp_vec3 ){ (float)p[0], (float)p[1], (float)p[2] };
}

static wisp_vec3 anywhere( const stability_box* box, int vertex )
{
    const wisp_random_key key = wisp_random_make_key( 20, 0, 0 );
    double p[3];
    for ( int k = 0; k < 3; ++k )
    {
        p[k] = box->middle[k] + box->size * ( wisp_random_unit( key, (uint32_t)vertex, (uint32_t)k, 0 ) - 0.5 );
    }
    return vec3_of( p );
}

// Turned about the vertical through the middle, in proportion to the depth.
static wisp_vec3 twist( const stability_box* box, wisp_vec3 p )
{
    const double height = fmax( box->upper[1] - box->lower[1], DBL_MIN );
    const double angle = FULL_TURN * TWISTS * ( box->upper[1] - (double)p.y ) / height;
    const double x = (double)p.x - box->middle[0], z = (double)p.z - box->middle[2];
    const double turned[3] = { box->middle[0] + cos( angle ) * x + sin( angle ) * z, (double)p.y,
                               box->middle[2] - sin( angle ) * x + cos( angle ) * z };
    return vec3_of( turned );
}

void stability_place( stability_start start, const stability_box* box, const double origin[3], const wisp_vec3* rest,
                      int count, wisp_vec3* out )
{
    for ( int i = 0; i < count; ++i )
    {
        const double mirrored[3] = { 2.0 * origin[0] - (double)rest[i].x, 2.0 * origin[1] - (double)rest[i].y,
                                     2.0 * origin[2] - (double)rest[i].z };
        switch ( start )
        {
            case STABILITY_START_RANDOM:
                out[i] = anywhere( box, i );
                break;
            case STABILITY_START_PLANE:
                out[i] = ( wisp_vec3 ){ rest[i].x, (float)box->middle[1], rest[i].z };
                break;
            case STABILITY_START_POINT:
                out[i] = vec3_of( box->middle );
                break;
            case STABILITY_START_INSIDE_OUT:
                out[i] = vec3_of( mirrored );
                break;
            case STABILITY_START_TWISTS:
                out[i] = twist( box, rest[i] );
                break;
            case STABILITY_START_REST:
            case STABILITY_START_COUNT:
                out[i] = rest[i];
                break;
        }
    }
}

double stability_distance( wisp_vec3 a, wisp_vec3 b )
{
    const double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
    return sqrt( x * x + y * y + z * z );
}

double stability_farthest( const wisp_vec3* a, const wisp_vec3* b, int count )
{
    double farthest = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        const double distance = stability_distance( a[i], b[i] );
        farthest = distance <= farthest || isnan( farthest ) ? farthest : distance;
    }
    return farthest;
}

int stability_frames( double seconds, double step )
{
    return (int)fmax( 1.0, ceil( seconds / step - 1e-6 ) );
}

// The period of a swing depends on the size: larger bodies run longer, up to four times.
double stability_duration( double scale )
{
    return STABILITY_SECONDS * fmin( fmax( 1.0, sqrt( scale ) ), 4.0 );
}

// A hundredth of the speed of a fall through its own size counts as rest. Speeds below the rounding of a coordinate
// in a substep are not resolved. Bodies that swing too slowly for the duration need not come to rest.
static double jitter_of( double size, double scale, double substep )
{
    const double rounding = 8.0 * (double)FLT_EPSILON * size / substep;
    return scale > 16.0 ? INFINITY : fmax( 0.01 * sqrt( (double)STABILITY_GRAVITY * size ), rounding );
}

stability_limits stability_usual_limits( double size, double scale, double step, double substep )
{
    const double seconds = stability_duration( scale );
    const int all = stability_frames( seconds, step );
    return ( stability_limits ){
        .energy = INFINITY,
        .jitter = jitter_of( size, scale, substep ),
        .breach = 0.0,
        .recovery_frames = scale > 16.0 ? all : stability_frames( 0.6 * seconds, step ),
        .still_frames = stability_frames( 0.05 * seconds, step ) + 1,
        .speed = INFINITY,
        .strain = INFINITY,
    };
}
