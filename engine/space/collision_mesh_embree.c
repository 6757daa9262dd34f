// Search by Embree. Embree finds candidates in single precision; mesh_search.h selects the closest or first.
// Rounding must not lose a candidate, or results would depend on how the tree was built. Embree's own triangle test
// accepts hits outside the boxes above it, so some are lost. Therefore this is a user geometry. Its boxes are
// widened by more than the rounding of a ray and its traversal (about 1e-6 of the largest coordinate, because rays
// are clipped to the mesh first).
#include "collision_mesh_embree.h"

#include "embree_compat.h"

#include "alloc.h"

#if WISP_HAS_EMBREE

#include <stdatomic.h>
#include <string.h>

struct embree_tree
{
    const mesh_surface* surface;
    RTCDevice device;
    RTCScene scene;
    RTCGeometry geometry;
    atomic_int fault;           ///< first error of Embree since the last check
    _Atomic int64_t node_bytes; ///< memory allocated by Embree
    int64_t max_node_bytes;     ///< 0: no limit
};

// ---- boxes ----

static float find_widening( const mesh_surface* s )
{
    return (float)( MESH_WIDENING * s->largest + MIN_SEARCH_SLACK );
}

static void find_box( const struct RTCBoundsFunctionArguments* arguments )
{
    const embree_tree* tree = arguments->geometryUserPtr;
    float lower[3], upper[3], widening = find_widening( tree->surface );
    mesh_surface_box( tree->surface, (int32_t)arguments->primID, lower, upper );
    for ( int k = 0; k < 3; ++k )
    {
        lower[k] -= widening;
        upper[k] += widening;
    }
    struct RTCBounds* box = arguments->bounds_o;
    box->lower_x = lower[0];
    box->lower_y = lower[1];
    box->lower_z = lower[2];
    box->upper_x = upper[0];
    box->upper_y = upper[1];
    box->upper_z = upper[2];
}

// ---- creation ----

static void note_fault( void* user, enum RTCError code, const char* text )
{
    (void)text;
    embree_tree* tree = user;
    int none = 0;
    atomic_compare_exchange_strong( &tree->fault, &none, (int)code );
}

static bool watch_memory( void* user, ssize_t bytes, bool is_taken )
{
    embree_tree* tree = user;
    int64_t sum = atomic_fetch_add( &tree->node_bytes, (int64_t)bytes ) + (int64_t)bytes;
    bool is_allowed = bytes <= 0 || tree->max_node_bytes == 0 || sum <= tree->max_node_bytes;
    if ( !is_allowed && !is_taken )
    {
        atomic_fetch_sub( &tree->node_bytes, (int64_t)bytes ); // Embree does not report the release
    }
    return is_allowed;
}

static wisp_status take_fault( embree_tree* tree, wisp_error* error )
{
    int fault = atomic_exchange( &tree->fault, 0 );
    if ( fault == (int)RTC_ERROR_NONE )
    {
        return WISP_OK;
    }
    if ( fault == (int)RTC_ERROR_OUT_OF_MEMORY )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "Embree: out of memory to build a collider of %d triangles",
                          tree->surface->triangle_count );
    }
    return wisp_fail( error, WISP_CONFLICT, "Embree: cannot build a collider of %d triangles, error %d",
                      tree->surface->triangle_count, fault );
}

static void collect_intersection( const struct RTCIntersectFunctionNArguments* arguments );

static wisp_status open_device( embree_tree* tree, wisp_error* error )
{
    // one thread, the caller's: Embree's own threads would compete with the engine's workers
    tree->device = rtcNewDevice( "threads=1" );
    if ( tree->device == NULL )
    {
        return wisp_fail( error, WISP_CONFLICT, "Embree: cannot start, error %d", (int)rtcGetDeviceError( NULL ) );
    }
    rtcSetDeviceErrorFunction( tree->device, note_fault, tree );
    rtcSetDeviceMemoryMonitorFunction( tree->device, watch_memory, tree );
    if ( rtcGetDeviceProperty( tree->device, RTC_DEVICE_PROPERTY_USER_GEOMETRY_SUPPORTED ) == 0 )
    {
        return wisp_fail( error, WISP_CONFLICT, "Embree: built without user geometry, which mesh colliders need" );
    }
    return WISP_OK;
}

static wisp_status build_scene( embree_tree* tree, wisp_error* error )
{
    tree->scene = rtcNewScene( tree->device );
    tree->geometry = rtcNewGeometry( tree->device, RTC_GEOMETRY_TYPE_USER );
    if ( tree->scene != NULL && tree->geometry != NULL )
    {
        RTCGeometry g = tree->geometry;
        rtcSetSceneFlags( tree->scene, RTC_SCENE_FLAG_ROBUST );
        rtcSetSceneBuildQuality( tree->scene, RTC_BUILD_QUALITY_MEDIUM );
        rtcSetGeometryBuildQuality( g, RTC_BUILD_QUALITY_MEDIUM );
        rtcSetGeometryUserPrimitiveCount( g, (unsigned)tree->surface->triangle_count );
        rtcSetGeometryMask( g, 0xffffffffu ); // versions 3 and 4 have different defaults
        rtcSetGeometryUserData( g, tree );
        rtcSetGeometryBoundsFunction( g, find_box, NULL );
        rtcSetGeometryIntersectFunction( g, collect_intersection );
        rtcCommitGeometry( g );
        rtcAttachGeometryByID( tree->scene, g, 0 );
        rtcCommitScene( tree->scene );
    }
    return take_fault( tree, error );
}

wisp_status embree_tree_create( const mesh_surface* surface, const wisp_collision_mesh_def* def, embree_tree** out,
                                wisp_error* error )
{
    *out = NULL;
    embree_tree* tree = base_allocate( &surface->allocator, sizeof( *tree ), BASE_BUFFER_ALIGNMENT );
    if ( tree == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for a mesh collider" );
    }
    memset( tree, 0, sizeof( *tree ) );
    tree->surface = surface;
    tree->max_node_bytes = def->memory_limit < INT64_MAX ? (int64_t)def->memory_limit : INT64_MAX;
    wisp_status status = open_device( tree, error );
    status = status == WISP_OK ? build_scene( tree, error ) : status;
    if ( status != WISP_OK )
    {
        embree_tree_release( tree );
        return status;
    }
    *out = tree;
    return WISP_OK;
}

void embree_tree_release( embree_tree* tree )
{
    if ( tree == NULL )
    {
        return;
    }
    if ( tree->geometry != NULL )
    {
        rtcReleaseGeometry( tree->geometry );
    }
    if ( tree->scene != NULL )
    {
        rtcReleaseScene( tree->scene );
    }
    if ( tree->device != NULL )
    {
        rtcReleaseDevice( tree->device );
    }
    base_release( &tree->surface->allocator, tree, sizeof( *tree ) );
}

size_t embree_tree_outside_bytes( const embree_tree* tree )
{
    int64_t nodes = atomic_load( &tree->node_bytes );
    return nodes > 0 ? (size_t)nodes : 0;
}

size_t embree_tree_bytes( const embree_tree* tree )
{
    return sizeof( *tree ) + embree_tree_outside_bytes( tree );
}

// ---- closest points ----

static bool measure_triangle( struct RTCPointQueryFunctionArguments* arguments )
{
    mesh_closest* search = arguments->userPtr;
    const int32_t triangle = (int32_t)arguments->primID;
    if ( triangle == search->triangle || !mesh_closest_propose( search, triangle ) )
    {
        return false;
    }
    float radius = (float)mesh_closest_radius( search );
    bool is_smaller = radius < arguments->query->radius;
    arguments->query->radius = is_smaller ? radius : arguments->query->radius;
    return is_smaller;
}

void embree_tree_find_closest( const embree_tree* tree, mesh_closest* search )
{
    // the input point is in floats
    struct RTCPointQuery ball = { .x = (float)search->point.x,
                                  .y = (float)search->point.y,
                                  .z = (float)search->point.z,
                                  .time = 0.0f,
                                  .radius = (float)mesh_closest_radius( search ) };
    struct RTCPointQueryContext context;
    rtcInitPointQueryContext( &context );
    rtcPointQuery( tree->scene, &ball, &context, measure_triangle, search );
}

// ---- paths ----

typedef struct ray_search
{
    embree_context context; ///< must be first: Embree returns its address
    mesh_cast* sweep;
    double begin; ///< m, start of the ray along the path
} ray_search;

// Ends the ray slightly beyond the intersection, so that equally early ones stay candidates.
static void collect_intersection( const struct RTCIntersectFunctionNArguments* arguments )
{
    ray_search* search = (ray_search*)(void*)arguments->context;
    mesh_cast* sweep = search->sweep;
    if ( mesh_cast_propose( sweep, (int32_t)arguments->primID ) )
    {
        struct RTCRay* ray = &( (struct RTCRayHit*)(void*)arguments->rayhit )->ray;
        float end = (float)fmax( sweep->best.time * sweep->length - search->begin + sweep->slack, 0.0 );
        ray->tfar = fminf( ray->tfar, end );
    }
}

// Sets up a ray of unit direction along the clipped path. The ray is longer than the path at its end; at its start
// the widened boxes have the same effect.
static struct RTCRay make_ray( const mesh_cast* sweep, double begin, double end )
{
    double3 step = double3_sub( sweep->to, sweep->from );
    double3 origin = double3_mul_add( sweep->from, begin, step );
    double3 direction = double3_scale( step, 1.0 / sweep->length );
    return ( struct RTCRay ){ .org_x = (float)origin.x,
                              .org_y = (float)origin.y,
                              .org_z = (float)origin.z,
                              .tnear = 0.0f,
                              .dir_x = (float)direction.x,
                              .dir_y = (float)direction.y,
                              .dir_z = (float)direction.z,
                              .tfar = (float)( ( end - begin ) * sweep->length + sweep->slack ),
                              .mask = 0xffffffffu };
}

bool embree_tree_find_intersection( const embree_tree* tree, mesh_cast* sweep )
{
    double begin, end;
    if ( !mesh_cast_clip( sweep, &begin, &end ) )
    {
        return true;
    }
    struct RTCRayHit ray = { .ray = make_ray( sweep, begin, end ), .hit = { .geomID = RTC_INVALID_GEOMETRY_ID } };
    if ( !embree_is_ray_fine( &ray.ray ) )
    {
        return false;
    }
    ray_search search = { .sweep = sweep, .begin = begin * sweep->length };
    embree_init_context( &search.context );
    embree_intersect( tree->scene, &search.context, &ray );
    return true;
}

bool embree_tree_exists( void )
{
    return true;
}

#else

bool embree_tree_exists( void )
{
    return false;
}

wisp_status embree_tree_create( const mesh_surface* surface, const wisp_collision_mesh_def* def, embree_tree** tree,
                                wisp_error* error )
{
    (void)surface;
    (void)def;
    *tree = NULL;
    return wisp_fail( error, WISP_CONFLICT, "mesh collider: this library was built without Embree" );
}

void embree_tree_release( embree_tree* tree )
{
    WISP_ASSERT( tree == NULL );
    (void)tree;
}

void embree_tree_find_closest( const embree_tree* tree, mesh_closest* search )
{
    (void)tree;
    (void)search;
}

bool embree_tree_find_intersection( const embree_tree* tree, mesh_cast* search )
{
    (void)tree;
    (void)search;
    return false;
}

size_t embree_tree_bytes( const embree_tree* tree )
{
    (void)tree;
    return 0;
}

size_t embree_tree_outside_bytes( const embree_tree* tree )
{
    (void)tree;
    return 0;
}

#endif
