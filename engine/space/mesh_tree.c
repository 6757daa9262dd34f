#include "embree_compat.h"
#include "mesh_surface.h"

#include "alloc.h"

#if WISP_HAS_EMBREE

#include <stdatomic.h>
#include <string.h>

// Embree keeps boxes and finds candidates in single precision; what is closest, or crossed first, is decided by
// mesh_triangle.h. No candidate may be lost to rounding, or answers would depend on the boxes and so on how the tree was
// built. Its own triangles lose some: their test is more generous than the boxes in front of it. Hence a geometry of our
// own, whose boxes are widened by more than all roundings of a ray and its traversal come to (some 1e-6 of the largest
// coordinate, because rays are clipped to the mesh first).
static const double WIDENING = 4e-6;     // of the mesh's largest coordinate
static const double RAY_SLACK = 1e-5;    // the same for the ends of rays
static const double SLACK = 1e-6;        // of a radius
static const double SLACK_LEAST = 1e-18; // m; its square is still a normal float
static const double FARTHEST = 4e9;      // m, beyond any distance within the reach

enum
{
    DECAY_QUERIES = 64, // fewer than these do not tell how well a tree does
};

struct wisp_mesh_tree
{
    mesh_surface surface;
    RTCDevice device;
    RTCScene scene;
    RTCGeometry geometry;
    bool deforms;
    bool is_lost;               ///< an update failed and so did the way back: nothing is found until one succeeds
    float* spare;               ///< [point_count][4] where points were, should an update fail; null for a rigid mesh
    double tested_when_new;     ///< triangles a query, 0 while not known
    atomic_int fault;           ///< first error of Embree since it was last looked at
    _Atomic int64_t node_bytes; ///< Embree's own
    int64_t node_bytes_most;    ///< 0: no limit
    _Atomic uint64_t asked, tested; ///< closest points, since the last update
    int open_edge_count, flat_triangle_count, build_count, refit_count;
};

// ---- boxes ----

static float find_widening( const mesh_surface* s )
{
    return (float)( WIDENING * s->largest + SLACK_LEAST );
}

static void find_box( const struct RTCBoundsFunctionArguments* arguments )
{
    const wisp_mesh_tree* tree = arguments->geometryUserPtr;
    const mesh_surface* s = &tree->surface;
    const int32_t* number = s->triangles + 3 * (size_t)arguments->primID;
    const float *a = s->quads + 4 * (size_t)number[0], *b = s->quads + 4 * (size_t)number[1],
                *c = s->quads + 4 * (size_t)number[2];
    float low[3], high[3], widening = find_widening( s );
    for ( int k = 0; k < 3; ++k )
    {
        low[k] = fminf( a[k], fminf( b[k], c[k] ) ) - widening;
        high[k] = fmaxf( a[k], fmaxf( b[k], c[k] ) ) + widening;
    }
    struct RTCBounds* box = arguments->bounds_o;
    box->lower_x = low[0];
    box->lower_y = low[1];
    box->lower_z = low[2];
    box->upper_x = high[0];
    box->upper_y = high[1];
    box->upper_z = high[2];
}

// ---- life ----

static void note_fault( void* user, enum RTCError code, const char* text )
{
    (void)text;
    wisp_mesh_tree* tree = user;
    int none = 0;
    atomic_compare_exchange_strong( &tree->fault, &none, (int)code );
}

static bool watch_memory( void* user, ssize_t bytes, bool is_taken )
{
    wisp_mesh_tree* tree = user;
    int64_t sum = atomic_fetch_add( &tree->node_bytes, (int64_t)bytes ) + (int64_t)bytes;
    bool is_fine = bytes <= 0 || tree->node_bytes_most == 0 || sum <= tree->node_bytes_most;
    if ( !is_fine && !is_taken )
    {
        atomic_fetch_sub( &tree->node_bytes, (int64_t)bytes ); // a block that is refused is never given back
    }
    return is_fine;
}

static wisp_status take_fault( wisp_mesh_tree* tree, const char* what, wisp_error* error )
{
    int fault = atomic_exchange( &tree->fault, 0 );
    if ( fault == (int)RTC_ERROR_NONE )
    {
        return WISP_OK;
    }
    if ( fault == (int)RTC_ERROR_OUT_OF_MEMORY )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "Embree has no memory to %s a collider of %d triangles", what,
                          tree->surface.triangle_count );
    }
    return wisp_fail( error, WISP_CONFLICT, "Embree cannot %s a collider of %d triangles: its error number is %d",
                      what, tree->surface.triangle_count, fault );
}

static void collect_crossing( const struct RTCIntersectFunctionNArguments* arguments );

static wisp_status open_device( wisp_mesh_tree* tree, wisp_error* error )
{
    // One thread, the caller's: Embree's own would fight with the engine's workers.
    tree->device = rtcNewDevice( "threads=1" );
    if ( tree->device == NULL )
    {
        return wisp_fail( error, WISP_CONFLICT, "Embree does not start: its error number is %d",
                          (int)rtcGetDeviceError( NULL ) );
    }
    rtcSetDeviceErrorFunction( tree->device, note_fault, tree );
    rtcSetDeviceMemoryMonitorFunction( tree->device, watch_memory, tree );
    if ( rtcGetDeviceProperty( tree->device, RTC_DEVICE_PROPERTY_USER_GEOMETRY_SUPPORTED ) == 0 )
    {
        return wisp_fail( error, WISP_CONFLICT,
                          "this Embree was built without user geometry, which mesh colliders need" );
    }
    return WISP_OK;
}

static wisp_status build_scene( wisp_mesh_tree* tree, wisp_error* error )
{
    const mesh_surface* s = &tree->surface;
    tree->scene = rtcNewScene( tree->device );
    tree->geometry = rtcNewGeometry( tree->device, RTC_GEOMETRY_TYPE_USER );
    if ( tree->scene != NULL && tree->geometry != NULL )
    {
        RTCGeometry g = tree->geometry;
        rtcSetSceneFlags( tree->scene,
                          tree->deforms ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_ROBUST );
        rtcSetSceneBuildQuality( tree->scene, tree->deforms ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM );
        rtcSetGeometryBuildQuality( g, tree->deforms ? RTC_BUILD_QUALITY_REFIT : RTC_BUILD_QUALITY_MEDIUM );
        rtcSetGeometryUserPrimitiveCount( g, (unsigned)s->triangle_count );
        rtcSetGeometryMask( g, 0xffffffffu ); // version 4 has another default than version 3
        rtcSetGeometryUserData( g, tree );
        rtcSetGeometryBoundsFunction( g, find_box, NULL );
        rtcSetGeometryIntersectFunction( g, collect_crossing );
        rtcCommitGeometry( g );
        rtcAttachGeometryByID( tree->scene, g, 0 );
        rtcCommitScene( tree->scene );
    }
    tree->build_count = 1;
    return take_fault( tree, "build", error );
}

static size_t spare_bytes( const wisp_mesh_tree* tree )
{
    return (size_t)tree->surface.point_count * 4 * sizeof( float );
}

wisp_status wisp_mesh_tree_create( const wisp_mesh_tree_def* def, const wisp_allocator* allocator,
                                   wisp_mesh_tree** out, wisp_error* error )
{
    *out = NULL;
    mesh_surface surface;
    wisp_status status = mesh_surface_build( &surface, def, allocator, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_mesh_tree* tree = base_allocate( &surface.allocator, sizeof( *tree ), BASE_BUFFER_ALIGNMENT );
    if ( tree == NULL )
    {
        mesh_surface_release( &surface );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a mesh collider" );
    }
    memset( tree, 0, sizeof( *tree ) );
    tree->surface = surface;
    tree->deforms = def->deforms;
    tree->node_bytes_most = def->memory_limit < INT64_MAX ? (int64_t)def->memory_limit : INT64_MAX;
    if ( def->deforms )
    {
        tree->spare = base_allocate( &surface.allocator, spare_bytes( tree ), BASE_BUFFER_ALIGNMENT );
        status = tree->spare != NULL ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a mesh collider" );
    }
    status = status == WISP_OK ? open_device( tree, error ) : status;
    status = status == WISP_OK ? build_scene( tree, error ) : status;
    if ( status != WISP_OK )
    {
        wisp_mesh_tree_release( tree );
        return status;
    }
    tree->open_edge_count = mesh_surface_count_open_edges( &tree->surface );
    tree->flat_triangle_count = mesh_surface_count_flat_triangles( &tree->surface );
    *out = tree;
    return WISP_OK;
}

void wisp_mesh_tree_release( wisp_mesh_tree* tree )
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
    wisp_allocator allocator = tree->surface.allocator;
    base_release( &allocator, tree->spare, spare_bytes( tree ) );
    mesh_surface_release( &tree->surface );
    base_release( &allocator, tree, sizeof( *tree ) );
}

size_t wisp_mesh_tree_bytes( const wisp_mesh_tree* tree )
{
    int64_t nodes = atomic_load( &tree->node_bytes );
    return sizeof( *tree ) + tree->surface.bytes + ( tree->spare != NULL ? spare_bytes( tree ) : 0 ) +
           ( nodes > 0 ? (size_t)nodes : 0 );
}

wisp_mesh_tree_facts wisp_mesh_tree_get_facts( const wisp_mesh_tree* tree )
{
    return ( wisp_mesh_tree_facts ){ tree->open_edge_count, tree->flat_triangle_count, tree->build_count,
                                     tree->refit_count };
}

// ---- updates ----

static wisp_status commit( wisp_mesh_tree* tree, bool rebuild, wisp_error* error )
{
    if ( rebuild )
    {
        // what was attached anew cannot be refitted
        rtcDetachGeometry( tree->scene, 0 );
        rtcAttachGeometryByID( tree->scene, tree->geometry, 0 );
    }
    rtcCommitGeometry( tree->geometry );
    rtcCommitScene( tree->scene );
    return take_fault( tree, rebuild ? "rebuild" : "refit", error );
}

// Triangles a query looked at, against those when the tree was new. The first update with enough queries behind it sets
// the measure.
static bool has_decayed( wisp_mesh_tree* tree )
{
    uint64_t asked = atomic_exchange( &tree->asked, 0 ), tested = atomic_exchange( &tree->tested, 0 );
    if ( asked < DECAY_QUERIES )
    {
        return false;
    }
    double mean = (double)tested / (double)asked;
    if ( tree->tested_when_new == 0.0 )
    {
        tree->tested_when_new = mean;
        return false;
    }
    return mean > 1.5 * tree->tested_when_new;
}

wisp_status wisp_mesh_tree_update( wisp_mesh_tree* tree, const wisp_vec3* points, wisp_error* error )
{
    if ( !tree->deforms )
    {
        return wisp_fail( error, WISP_CONFLICT, "this mesh collider was made rigid: its points cannot move" );
    }
    wisp_status status = mesh_surface_check_points( points, tree->surface.point_count, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    memcpy( tree->spare, tree->surface.quads, spare_bytes( tree ) );
    mesh_surface_set_points( &tree->surface, points );
    bool rebuild = has_decayed( tree ) || tree->is_lost;
    status = commit( tree, rebuild, error );
    if ( status == WISP_OK )
    {
        tree->is_lost = false;
        tree->tested_when_new = rebuild ? 0.0 : tree->tested_when_new;
        tree->build_count += rebuild ? 1 : 0;
        tree->refit_count += rebuild ? 0 : 1;
        return WISP_OK;
    }

    // back to what was; should there be no memory even for that, better nothing than something wrong
    memcpy( tree->surface.quads, tree->spare, spare_bytes( tree ) );
    mesh_surface_find_extent( &tree->surface );
    tree->is_lost = tree->is_lost || commit( tree, true, NULL ) != WISP_OK;
    return status;
}

// ---- closest points ----

static bool is_reachable( wisp_vec3 p )
{
    const float r = WISP_MESH_TREE_REACH; // false for NaN
    return fabsf( p.x ) <= r && fabsf( p.y ) <= r && fabsf( p.z ) <= r;
}

typedef struct closest_search
{
    const mesh_surface* surface;
    double3 point;
    int32_t triangle; ///< -1 while nothing is found
    uint64_t tested;
    triangle_nearest best;
} closest_search;

static float searched_radius( double distance )
{
    return (float)( distance * ( 1.0 + SLACK ) + SLACK_LEAST );
}

// One triangle: the least pair of distance and number wins, which no order of calls can change.
static bool measure_triangle( struct RTCPointQueryFunctionArguments* arguments )
{
    closest_search* search = arguments->userPtr;
    int32_t triangle = (int32_t)arguments->primID;
    triangle_corners t = triangle_load( search->surface->quads, search->surface->triangles, triangle );
    triangle_nearest nearest;
    triangle_find_nearest( &nearest, &t, search->point );
    ++search->tested;
    bool is_closer = nearest.squared < search->best.squared;
    bool is_first =
        nearest.squared == search->best.squared && ( search->triangle < 0 || triangle < search->triangle );
    if ( !is_closer && !is_first )
    {
        return false;
    }
    search->best = nearest;
    search->triangle = triangle;

    float radius = searched_radius( sqrt( nearest.squared ) );
    bool is_smaller = radius < arguments->query->radius;
    arguments->query->radius = is_smaller ? radius : arguments->query->radius;
    return is_smaller;
}

static bool find_closest( wisp_mesh_tree* tree, const wisp_mesh_query* query, wisp_mesh_nearest* out,
                          uint64_t* tested )
{
    double radius = fmin( (double)query->radius, FARTHEST );
    closest_search search = { .surface = &tree->surface,
                              .point = double3_widen( query->point ),
                              .triangle = -1,
                              .best = { .squared = radius * radius } };
    struct RTCPointQuery ball = { .x = query->point.x,
                                  .y = query->point.y,
                                  .z = query->point.z,
                                  .time = 0.0f,
                                  .radius = searched_radius( radius ) };
    struct RTCPointQueryContext context;
    rtcInitPointQueryContext( &context );
    rtcPointQuery( tree->scene, &ball, &context, measure_triangle, &search );
    *tested += search.tested;
    if ( search.triangle >= 0 )
    {
        mesh_surface_describe( &tree->surface, search.triangle, &search.best, search.point, out );
    }
    return search.triangle >= 0;
}

static void add_work( wisp_mesh_work* sum, const wisp_mesh_work* work )
{
    if ( sum != NULL )
    {
        sum->asked += work->asked;
        sum->answered += work->answered;
        sum->refused += work->refused;
        sum->tested += work->tested;
    }
}

void wisp_mesh_tree_closest( wisp_mesh_tree* tree, const wisp_mesh_query* queries, int count,
                             wisp_mesh_nearest* nearest, wisp_mesh_work* sum )
{
    wisp_mesh_work work = { .asked = (uint64_t)( count > 0 ? count : 0 ) };
    for ( int i = 0; i < count; ++i )
    {
        nearest[i] = ( wisp_mesh_nearest ){ .triangle = -1 };
        if ( !is_reachable( queries[i].point ) || !( queries[i].radius >= 0.0f ) || tree->is_lost )
        {
            ++work.refused;
            continue;
        }
        work.answered += find_closest( tree, queries + i, nearest + i, &work.tested ) ? 1 : 0;
    }
    atomic_fetch_add_explicit( &tree->asked, work.asked - work.refused, memory_order_relaxed );
    atomic_fetch_add_explicit( &tree->tested, work.tested, memory_order_relaxed );
    add_work( sum, &work );
}

// ---- paths ----

typedef struct sweep_search
{
    embree_context context; ///< first: Embree hands its address back
    const mesh_surface* surface;
    double3 from, to;
    double length, begin,
        slack;        ///< m: of the path, from its start to the ray's, and by which the ray outlasts a crossing
    int32_t triangle; ///< -1 while nothing is found
    uint64_t tested;
    triangle_crossing best;
} sweep_search;

// One triangle: the least pair of time and number wins. The ray then ends a little behind the crossing, so that all
// which are as early stay candidates.
static void collect_crossing( const struct RTCIntersectFunctionNArguments* arguments )
{
    sweep_search* search = (sweep_search*)(void*)arguments->context;
    int32_t triangle = (int32_t)arguments->primID;
    triangle_corners t = triangle_load( search->surface->quads, search->surface->triangles, triangle );
    triangle_crossing crossing;
    ++search->tested;
    if ( !triangle_cross( &t, search->from, search->to, &crossing ) )
    {
        return;
    }
    bool is_first = search->triangle < 0 || crossing.time < search->best.time ||
                    ( crossing.time == search->best.time && triangle < search->triangle );
    if ( is_first )
    {
        search->triangle = triangle;
        search->best = crossing;
        struct RTCRay* ray = &( (struct RTCRayHit*)(void*)arguments->rayhit )->ray;
        float end = (float)fmax( crossing.time * search->length - search->begin + search->slack, 0.0 );
        ray->tfar = fminf( ray->tfar, end );
    }
}

// The part of a path that runs through the mesh's box, as fractions. @return false if there is none
static bool clip( const sweep_search* search, double* begin, double* end )
{
    const mesh_surface* s = search->surface;
    const double from[3] = { search->from.x, search->from.y, search->from.z };
    const double to[3] = { search->to.x, search->to.y, search->to.z };
    *begin = 0.0;
    *end = 1.0;
    for ( int k = 0; k < 3; ++k )
    {
        double low = (double)s->low[k] - search->slack - from[k], high = (double)s->high[k] + search->slack - from[k];
        double step = to[k] - from[k];
        if ( step == 0.0 )
        {
            *end = low > 0.0 || high < 0.0 ? -1.0 : *end;
            continue;
        }
        *begin = fmax( *begin, ( step > 0.0 ? low : high ) / step );
        *end = fmin( *end, ( step > 0.0 ? high : low ) / step );
    }
    return *begin <= *end;
}

// A ray of unit direction along the clipped path. It outlasts the path at its end; at its beginning the widened boxes
// do the same.
static struct RTCRay make_ray( sweep_search* search, double begin, double end )
{
    double3 step = double3_sub( search->to, search->from );
    search->length = sqrt( double3_dot( step, step ) );
    search->begin = begin * search->length;
    double3 origin = double3_mul_add( search->from, begin, step );
    double3 direction = double3_scale( step, 1.0 / search->length );
    return ( struct RTCRay ){ .org_x = (float)origin.x,
                              .org_y = (float)origin.y,
                              .org_z = (float)origin.z,
                              .tnear = 0.0f,
                              .dir_x = (float)direction.x,
                              .dir_y = (float)direction.y,
                              .dir_z = (float)direction.z,
                              .tfar = (float)( ( end - begin ) * search->length + search->slack ),
                              .mask = 0xffffffffu };
}

static void describe_crossing( const sweep_search* search, wisp_mesh_hit* hit )
{
    const triangle_crossing* c = &search->best;
    triangle_corners t = triangle_load( search->surface->quads, search->surface->triangles, search->triangle );
    double3 normal = double3_unit_or_zero( triangle_normal( &t ) );
    double side = c->from_front ? 1.0 : -1.0;
    *hit = ( wisp_mesh_hit ){
        .triangle = search->triangle,
        .time = (float)c->time,
        .side = (float)side,
        .point = double3_narrow( double3_mul_add( search->from, c->time, double3_sub( search->to, search->from ) ) ),
        .normal = double3_narrow( double3_scale( normal, side ) ),
        .weights = { (float)c->weights[0], (float)c->weights[1], (float)c->weights[2] },
    };
}

static bool find_crossing( wisp_mesh_tree* tree, const wisp_mesh_path* path, wisp_mesh_hit* hit,
                           wisp_mesh_work* work )
{
    sweep_search search = { .surface = &tree->surface,
                            .from = double3_widen( path->from ),
                            .to = double3_widen( path->to ),
                            .slack = RAY_SLACK * tree->surface.largest + SLACK_LEAST,
                            .triangle = -1 };
    double begin, end;
    if ( !clip( &search, &begin, &end ) )
    {
        return false;
    }
    struct RTCRayHit ray = { .ray = make_ray( &search, begin, end ), .hit = { .geomID = RTC_INVALID_GEOMETRY_ID } };
    if ( !embree_is_ray_fine( &ray.ray ) )
    {
        ++work->refused;
        return false;
    }
    embree_init_context( &search.context );
    embree_intersect( tree->scene, &search.context, &ray );
    work->tested += search.tested;
    if ( search.triangle >= 0 )
    {
        describe_crossing( &search, hit );
    }
    return search.triangle >= 0;
}

static bool has_length( const wisp_mesh_path* path )
{
    return path->from.x != path->to.x || path->from.y != path->to.y || path->from.z != path->to.z;
}

void wisp_mesh_tree_sweep( wisp_mesh_tree* tree, const wisp_mesh_path* paths, int count, wisp_mesh_hit* hits,
                           wisp_mesh_work* sum )
{
    wisp_mesh_work work = { .asked = (uint64_t)( count > 0 ? count : 0 ) };
    for ( int i = 0; i < count; ++i )
    {
        hits[i] = ( wisp_mesh_hit ){ .triangle = -1 };
        if ( !is_reachable( paths[i].from ) || !is_reachable( paths[i].to ) || tree->is_lost )
        {
            ++work.refused;
        }
        else if ( has_length( paths + i ) )
        {
            work.answered += find_crossing( tree, paths + i, hits + i, &work ) ? 1 : 0;
        }
    }
    add_work( sum, &work );
}

#endif
