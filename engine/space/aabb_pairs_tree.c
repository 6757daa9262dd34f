// Search by an Embree tree over the boxes. Only boxes that can overlap another one are inserted: Embree drops boxes
// that are not finite, and then loses their neighbours in a refit. When the set changes, the tree is rebuilt. A
// sphere around the query finds candidates; this file tests their overlap.
#include "box_search.h"

#include "embree_compat.h"

#include "alloc.h"

#if WISP_HAS_EMBREE

#include <string.h>

struct wisp_aabb_tree
{
    const wisp_aabb* boxes;
    RTCDevice device;
    RTCScene scene;
    RTCGeometry geometry;
    wisp_buffer items; ///< [item_count] boxes in the tree, in increasing order
    int item_count;
    bool is_built;
    double tested_when_new;     ///< boxes tested per result, 0 while unknown
    double tested_now;          ///< boxes tested per result in the last call
    atomic_int fault;           ///< first error of Embree since the last check
    _Atomic int64_t node_bytes; ///< memory allocated by Embree
    int build_count, refit_count;
};

// Clamps to the range of Embree, which drops boxes beyond 1.8e18. Clamping is monotonic, so overlaps remain.
static float clamp_far( float c )
{
    return fminf( fmaxf( c, -1e18f ), 1e18f );
}

static void find_box( const struct RTCBoundsFunctionArguments* arguments )
{
    const struct wisp_aabb_tree* tree = arguments->geometryUserPtr;
    const wisp_aabb* box = tree->boxes + ( (const int32_t*)tree->items.data )[arguments->primID];
    struct RTCBounds* out = arguments->bounds_o;
    out->lower_x = clamp_far( box->lower[0] );
    out->lower_y = clamp_far( box->lower[1] );
    out->lower_z = clamp_far( box->lower[2] );
    out->upper_x = clamp_far( box->upper[0] );
    out->upper_y = clamp_far( box->upper[1] );
    out->upper_z = clamp_far( box->upper[2] );
}

// ---- creation ----

static void note_fault( void* user, enum RTCError code, const char* text )
{
    (void)text;
    struct wisp_aabb_tree* tree = user;
    int none = 0;
    atomic_compare_exchange_strong( &tree->fault, &none, (int)code );
}

static bool watch_memory( void* user, ssize_t bytes, bool is_taken )
{
    (void)is_taken;
    struct wisp_aabb_tree* tree = user;
    atomic_fetch_add( &tree->node_bytes, (int64_t)bytes );
    return true;
}

static wisp_status take_fault( struct wisp_aabb_tree* tree, const char* what, wisp_error* error )
{
    int fault = atomic_exchange( &tree->fault, 0 );
    if ( fault == (int)RTC_ERROR_NONE )
    {
        return WISP_OK;
    }
    if ( fault == (int)RTC_ERROR_OUT_OF_MEMORY )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "Embree: out of memory to %s a tree of %d boxes", what,
                          tree->item_count );
    }
    return wisp_fail( error, WISP_CONFLICT, "Embree: cannot %s a tree of %d boxes, error %d", what, tree->item_count,
                      fault );
}

static wisp_status open_device( struct wisp_aabb_tree* tree, wisp_error* error )
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
        return wisp_fail( error, WISP_CONFLICT, "Embree: built without user geometry, which boxes need" );
    }
    tree->scene = rtcNewScene( tree->device );
    tree->geometry = rtcNewGeometry( tree->device, RTC_GEOMETRY_TYPE_USER );
    if ( tree->scene != NULL && tree->geometry != NULL )
    {
        rtcSetSceneFlags( tree->scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC );
        rtcSetSceneBuildQuality( tree->scene, RTC_BUILD_QUALITY_LOW );
        rtcSetGeometryBuildQuality( tree->geometry, RTC_BUILD_QUALITY_REFIT );
        rtcSetGeometryUserData( tree->geometry, tree );
        rtcSetGeometryBoundsFunction( tree->geometry, find_box, NULL );
    }
    return take_fault( tree, "make", error );
}

static wisp_status create( struct wisp_aabb_tree** out, const wisp_allocator* allocator, wisp_error* error )
{
    struct wisp_aabb_tree* tree = base_allocate( allocator, sizeof( *tree ), BASE_BUFFER_ALIGNMENT );
    if ( tree == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for a tree of boxes" );
    }
    memset( (void*)tree, 0, sizeof( *tree ) );
    wisp_status status = open_device( tree, error );
    if ( status != WISP_OK )
    {
        box_tree_release( tree, allocator );
        return status;
    }
    *out = tree;
    return WISP_OK;
}

void box_tree_release( struct wisp_aabb_tree* tree, const wisp_allocator* allocator )
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
    wisp_buffer_release( &tree->items, allocator );
    base_release( allocator, tree, sizeof( *tree ) );
}

bool box_tree_exists( void )
{
    return true;
}

size_t box_tree_bytes( const struct wisp_aabb_tree* tree, size_t* outside )
{
    if ( tree == NULL )
    {
        return 0;
    }
    int64_t nodes = atomic_load( &tree->node_bytes );
    *outside += nodes > 0 ? (size_t)nodes : 0;
    return sizeof( *tree ) + tree->items.size;
}

void box_tree_counts( const struct wisp_aabb_tree* tree, int* build_count, int* refit_count )
{
    *build_count = tree != NULL ? tree->build_count : 0;
    *refit_count = tree != NULL ? tree->refit_count : 0;
}

// ---- updates ----

// Lists the boxes to insert.
// @return whether the set has changed
static bool list_items( struct wisp_aabb_tree* tree, const wisp_aabb_args* args )
{
    int32_t* items = tree->items.data;
    int count = 0;
    bool is_other = false;
    for ( int i = 0; i < args->box_count; ++i )
    {
        if ( box_is_valid( args->boxes + i ) )
        {
            is_other = is_other || count >= tree->item_count || items[count] != i;
            items[count++] = i;
        }
    }
    is_other = is_other || count != tree->item_count;
    tree->item_count = count;
    return is_other;
}

// Tests whether the tree has decayed: 1.5 times as many boxes tested per result as after the build.
static bool has_decayed( const struct wisp_aabb_tree* tree )
{
    return tree->tested_when_new > 0.0 && tree->tested_now > 1.5 * tree->tested_when_new;
}

void box_tree_note( struct wisp_aabb_tree* tree, uint64_t tested, uint64_t answers )
{
    tree->tested_now = answers > 0 ? (double)tested / (double)answers : 0.0;
    tree->tested_when_new = tree->tested_when_new > 0.0 ? tree->tested_when_new : tree->tested_now;
}

static void commit( struct wisp_aabb_tree* tree, bool rebuild )
{
    if ( rebuild )
    {
        // a newly attached geometry cannot be refitted
        if ( tree->is_built )
        {
            rtcDetachGeometry( tree->scene, 0 );
        }
        rtcSetGeometryUserPrimitiveCount( tree->geometry, (unsigned)tree->item_count );
        rtcAttachGeometryByID( tree->scene, tree->geometry, 0 );
    }
    rtcCommitGeometry( tree->geometry );
    rtcCommitScene( tree->scene );
}

wisp_status box_tree_update( struct wisp_aabb_tree** out, const wisp_allocator* allocator, const wisp_aabb_args* args,
                             wisp_error* error )
{
    wisp_status status = *out == NULL ? create( out, allocator, error ) : WISP_OK;
    if ( status != WISP_OK )
    {
        return status;
    }
    struct wisp_aabb_tree* tree = *out;
    if ( tree->items.size < (size_t)args->box_count * sizeof( int32_t ) )
    {
        tree->item_count = 0; // the list is overwritten
        if ( !wisp_buffer_reserve( &tree->items, allocator, (size_t)args->box_count * sizeof( int32_t ) ) )
        {
            return wisp_fail( error, WISP_NO_MEMORY, "out of memory for a tree of %d boxes", args->box_count );
        }
    }
    bool is_other = list_items( tree, args );
    bool rebuild = is_other || !tree->is_built || has_decayed( tree );
    if ( tree->item_count == 0 )
    {
        return WISP_OK; // no queries
    }
    tree->boxes = args->boxes;
    commit( tree, rebuild );
    status = take_fault( tree, rebuild ? "build" : "refit", error );
    tree->is_built = true;
    if ( status != WISP_OK )
    {
        tree->item_count = 0; // forces a rebuild in the next call
        return status;
    }
    tree->tested_when_new = rebuild ? 0.0 : tree->tested_when_new;
    tree->build_count += rebuild ? 1 : 0;
    tree->refit_count += rebuild ? 0 : 1;
    return WISP_OK;
}

// ---- queries ----

typedef struct tree_walk
{
    const struct wisp_aabb_tree* tree;
    box_question* question;
    wisp_aabb query;
} tree_walk;

static bool compare_box( struct RTCPointQueryFunctionArguments* arguments )
{
    const tree_walk* walk = arguments->userPtr;
    wisp_aabb_group* g = &walk->question->group;
    int32_t item = ( (const int32_t*)walk->tree->items.data )[arguments->primID];
    bool is_hit = item > g->above[0] && wisp_aabb_overlaps( &walk->query, walk->tree->boxes + item );
    g->found[0][g->found_count[0]] = item;
    g->found_count[0] += is_hit ? 1 : 0;
    ++walk->question->tested;
    return false;
}

// Runs a point query. The sphere exceeds its box by more than the rounding error; the square of its radius is
// finite.
void box_tree_find( const struct wisp_aabb_tree* tree, box_question* question )
{
    if ( tree->item_count == 0 )
    {
        return;
    }
    tree_walk walk = { .tree = tree, .question = question };
    memcpy( &walk.query, question->group.box[0], sizeof( walk.query ) );
    float middle[3], reach[3];
    for ( int k = 0; k < 3; ++k )
    {
        float lower = clamp_far( walk.query.lower[k] ), upper = clamp_far( walk.query.upper[k] );
        middle[k] = 0.5f * lower + 0.5f * upper;
        reach[k] = fmaxf( upper - middle[k], middle[k] - lower );
    }
    float squared = reach[0] * reach[0] + reach[1] * reach[1] + reach[2] * reach[2];
    struct RTCPointQuery ball = { .x = middle[0],
                                  .y = middle[1],
                                  .z = middle[2],
                                  .time = 0.0f,
                                  .radius = sqrtf( squared ) * ( 1.0f + 4e-6f ) + 1e-18f };
    struct RTCPointQueryContext context;
    rtcInitPointQueryContext( &context );
    rtcPointQuery( tree->scene, &ball, &context, compare_box, &walk );
}

#else

bool box_tree_exists( void )
{
    return false;
}

wisp_status box_tree_update( struct wisp_aabb_tree** tree, const wisp_allocator* allocator,
                             const wisp_aabb_args* args, wisp_error* error )
{
    (void)tree;
    (void)allocator;
    (void)args;
    return wisp_fail( error, WISP_CONFLICT, "this library was built without Embree" );
}

void box_tree_find( const struct wisp_aabb_tree* tree, box_question* question )
{
    (void)tree;
    (void)question;
}

void box_tree_note( struct wisp_aabb_tree* tree, uint64_t tested, uint64_t answers )
{
    (void)tree;
    (void)tested;
    (void)answers;
}

void box_tree_counts( const struct wisp_aabb_tree* tree, int* build_count, int* refit_count )
{
    (void)tree;
    *build_count = *refit_count = 0;
}

size_t box_tree_bytes( const struct wisp_aabb_tree* tree, size_t* outside )
{
    (void)outside;
    (void)tree;
    return 0;
}

void box_tree_release( struct wisp_aabb_tree* tree, const wisp_allocator* allocator )
{
    WISP_ASSERT( tree == NULL );
    (void)tree;
    (void)allocator;
}

#endif
