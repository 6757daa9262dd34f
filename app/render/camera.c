// Bounds, and the camera that frames them.
#include "render.h"

#include "check.h"
#include "trace.h"
#include "wisp/module/definition.h"
#include "wisp/module/vec.h"

static const float DEGREE = 0.01745329252f; // radians

enum
{
    SWEEP_POINTS = 32, // on the circle that a turning box sweeps; 1 % wider than the circle closes the gaps
};

// ---- bounds ----------------------------------------------------------------------------------------------------

static void grow( render_bounds* bounds, wisp_vec3 p, float radius )
{
    wisp_vec3 lower = { p.x - radius, p.y - radius, p.z - radius };
    wisp_vec3 upper = { p.x + radius, p.y + radius, p.z + radius };
    *bounds = render_bounds_union( *bounds, ( render_bounds ){ lower, upper, true } );
}

render_bounds render_bounds_union( render_bounds a, render_bounds b )
{
    if ( !a.is_filled || !b.is_filled )
    {
        return a.is_filled ? a : b;
    }
    return ( render_bounds ){
        .lower = { fminf( a.lower.x, b.lower.x ), fminf( a.lower.y, b.lower.y ), fminf( a.lower.z, b.lower.z ) },
        .upper = { fmaxf( a.upper.x, b.upper.x ), fmaxf( a.upper.y, b.upper.y ), fmaxf( a.upper.z, b.upper.z ) },
        .is_filled = true,
    };
}

// Unreferenced vertices are invisible and must not move the camera away.
static void grow_by_mesh( render_bounds* bounds, const render_mesh* mesh )
{
    for ( size_t k = 0; k < 3 * (size_t)mesh->triangle_count; ++k )
    {
        grow( bounds, mesh->points[mesh->triangles[k]], 0.0f );
    }
}

static void grow_by_curves( render_bounds* bounds, const render_curves* curves )
{
    for ( int v = 0; v < curves->offsets[curves->strand_count]; ++v )
    {
        grow( bounds, curves->points[v], curves->radii != NULL ? curves->radii[v] : curves->radius );
    }
}

static void grow_by_points( render_bounds* bounds, const render_points* points )
{
    for ( int i = 0; i < points->count; ++i )
    {
        grow( bounds, points->points[i], points->radius );
    }
}

wisp_status render_scene_bounds( const render_scene* scene, render_bounds* bounds, wisp_error* error )
{
    WISP_TRY( check_scene( scene, error ) );
    *bounds = ( render_bounds ){ .is_filled = false };
    for ( int i = 0; i < scene->mesh_count; ++i )
    {
        grow_by_mesh( bounds, &scene->meshes[i] );
    }
    for ( int i = 0; i < scene->curves_count; ++i )
    {
        grow_by_curves( bounds, &scene->curves[i] );
    }
    for ( int i = 0; i < scene->points_count; ++i )
    {
        grow_by_points( bounds, &scene->points[i] );
    }
    return WISP_OK;
}

// ---- framing ---------------------------------------------------------------------------------------------------

render_view render_default_view( void )
{
    return ( render_view ){
        .azimuth_degrees = 32.0f,
        .elevation_degrees = 16.0f,
        .fov_degrees = 28.0f,
        .margin = 0.04f,
    };
}

static wisp_status check_view( const render_bounds* bounds, const render_view* view, float aspect, wisp_error* error )
{
    const float corners[] = { bounds->lower.x, bounds->lower.y, bounds->lower.z,
                              bounds->upper.x, bounds->upper.y, bounds->upper.z };
    for ( int k = 0; k < 6 && bounds->is_filled; ++k )
    {
        if ( !( fabsf( corners[k] ) <= 2.0f * RENDER_FARTHEST ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "camera: the bounds hold %g, which is not within %g m",
                              (double)corners[k], 2.0 * (double)RENDER_FARTHEST );
        }
    }
    const struct
    {
        const char* name;
        float value, least, most;
    } ranges[] = {
        { "azimuth", view->azimuth_degrees, -1e6f, 1e6f },
        { "elevation", view->elevation_degrees, -89.0f, 89.0f },
        { "angle of view", view->fov_degrees, 1.0f, 150.0f },
        { "margin", view->margin, 0.0f, 0.4f },
        { "aspect", aspect, 0.01f, 100.0f },
    };
    for ( int i = 0; i < WISP_COUNT( ranges ); ++i )
    {
        if ( !( ranges[i].value >= ranges[i].least && ranges[i].value <= ranges[i].most ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "camera: %s is %g and must be in %g .. %g", ranges[i].name,
                              (double)ranges[i].value, (double)ranges[i].least, (double)ranges[i].most );
        }
    }
    return WISP_OK;
}

// Directions of the picture: towards its right edge, its upper edge, and the camera.
typedef struct view_frame
{
    wisp_vec3 right, up, back;
} view_frame;

static view_frame frame_of( const render_view* view )
{
    float azimuth = DEGREE * fmodf( view->azimuth_degrees, 360.0f );
    float elevation = DEGREE * view->elevation_degrees;
    float c = cosf( azimuth ), s = sinf( azimuth ), ce = cosf( elevation ), se = sinf( elevation );
    return ( view_frame ){ { c, 0.0f, -s }, { -s * se, ce, -c * se }, { s * ce, se, c * ce } };
}

// Bounds of the content, around the middle of the box: its corners, or two circles if it will turn.
static int outline( const render_bounds* box, bool is_turntable, wisp_vec3* points )
{
    wisp_vec3 half = wisp_v3_scale( wisp_v3_sub( box->upper, box->lower ), 0.5f );
    if ( !is_turntable )
    {
        for ( int k = 0; k < 8; ++k )
        {
            points[k] = ( wisp_vec3 ){ k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z };
        }
        return 8;
    }
    float radius = 1.01f * sqrtf( half.x * half.x + half.z * half.z );
    for ( int k = 0; k < SWEEP_POINTS; ++k )
    {
        float angle = 360.0f * DEGREE * (float)k / SWEEP_POINTS;
        wisp_vec3 p = { radius * cosf( angle ), half.y, radius * sinf( angle ) };
        points[2 * k] = p;
        points[2 * k + 1] = ( wisp_vec3 ){ p.x, -p.y, p.z };
    }
    return 2 * SWEEP_POINTS;
}

// One axis of the picture. A point at x sideways and z towards the camera is inside if |x - c| <= (D - z) t. The
// smallest D is where both edges touch: A = max( x/t + z ), B = max( -x/t + z ), D = (A + B)/2 and c = t (A - B)/2.
typedef struct axis_fit
{
    float distance, centre;
} axis_fit;

static axis_fit fit_axis( const wisp_vec3* points, int count, wisp_vec3 aside, wisp_vec3 back, float tangent )
{
    float a = -INFINITY, b = -INFINITY;
    for ( int k = 0; k < count; ++k )
    {
        float x = wisp_v3_dot( points[k], aside ) / tangent, z = wisp_v3_dot( points[k], back );
        a = fmaxf( a, x + z );
        b = fmaxf( b, z - x );
    }
    return ( axis_fit ){ 0.5f * ( a + b ), 0.5f * tangent * ( a - b ) };
}

wisp_status render_frame_camera( const render_bounds* bounds, const render_view* view, float aspect,
                                 render_camera* camera, wisp_error* error )
{
    WISP_TRY( check_view( bounds, view, aspect, error ) );
    render_bounds box = *bounds;
    if ( !box.is_filled )
    {
        box = ( render_bounds ){ { -0.5f, -0.5f, -0.5f }, { 0.5f, 0.5f, 0.5f }, true };
    }
    view_frame frame = frame_of( view );
    wisp_vec3 points[2 * SWEEP_POINTS];
    int count = outline( &box, view->is_turntable, points );
    float tangent = tanf( 0.5f * DEGREE * view->fov_degrees ) * ( 1.0f - 2.0f * view->margin );
    axis_fit across = fit_axis( points, count, frame.right, frame.back, tangent * aspect );
    axis_fit along = fit_axis( points, count, frame.up, frame.back, tangent );

    // A single point has no size; the camera keeps a distance all the same.
    float distance = fmaxf( fmaxf( across.distance, along.distance ), 1e-3f );
    wisp_vec3 middle = wisp_v3_scale( wisp_v3_add( box.lower, box.upper ), 0.5f );
    wisp_vec3 target =
        wisp_v3_mul_add( wisp_v3_mul_add( middle, across.centre, frame.right ), along.centre, frame.up );
    *camera = ( render_camera ){
        .eye = wisp_v3_mul_add( target, distance, frame.back ),
        .target = target,
        .up = { 0.0f, 1.0f, 0.0f },
        .fov_degrees = view->fov_degrees,
    };
    return WISP_OK;
}

// ---- what stands between the camera and points ----

// What stands between the camera and points.

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
        wisp_vec3 line = wisp_v3_sub( points[i], camera->eye );
        float length = wisp_v3_length( line );
        trace_ray ray = { camera->eye, wisp_v3_normalize_or( line, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ),
                          almost * length };
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
