// What stands between the camera and points.
#include "check.h"
#include "trace.h"
#include "vec.h"

wisp_status render_find_hiding( const render_scene* scene, const render_camera* camera, const wisp_vec3* points,
                                int count, int* bodies, wisp_error* error )
{
    wisp_status status = check_camera( camera, error );
    status = status == WISP_OK ? check_scene( scene, error ) : status;
    const trace_widening none = { camera->eye, 0.0f };
    trace_tree* tree = NULL;
    status = status == WISP_OK ? trace_build( scene, &none, &tree, error ) : status;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        // A little shorter than the line, so that the surface the point lies on does not hide it.
        const float almost = 0.999f;
        wisp_vec3 line = v3_sub( points[i], camera->eye );
        float length = v3_length( line );
        trace_ray ray = { camera->eye, v3_normalize_or( line, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ), almost * length };
        trace_hit hit;
        if ( !isfinite( length ) )
        {
            status = wisp_fail( error, WISP_BAD_INPUT, "point %d is not finite", i );
            break;
        }
        bodies[i] = length > 0.0f && trace_nearest( tree, &ray, &hit ) ? hit.body : -1;
    }
    trace_release( tree );
    return status;
}
