#include "mesh_bvh.h"

#include "alloc.h"
#include "lane.h"
#include "lane_vec.h"

#include <float.h>
#include <string.h>

enum
{
    REFIT_GRAIN = 64, // groups of leaves per block
};

// ---- order ----

// Doubled centres of triangles, and the order that is sorted.
typedef struct splitter
{
    float ( *centre )[3];
    int32_t* order;
} splitter;

static int find_longest_axis( const splitter* s, int begin, int end )
{
    float lower[3], upper[3];
    memcpy( lower, s->centre[s->order[begin]], sizeof( lower ) );
    memcpy( upper, lower, sizeof( upper ) );
    for ( int i = begin + 1; i < end; ++i )
    {
        const float* c = s->centre[s->order[i]];
        for ( int k = 0; k < 3; ++k )
        {
            lower[k] = fminf( lower[k], c[k] );
            upper[k] = fmaxf( upper[k], c[k] );
        }
    }
    int axis = 0;
    for ( int k = 1; k < 3; ++k )
    {
        axis = upper[k] - lower[k] > upper[axis] - lower[axis] ? k : axis;
    }
    return axis;
}

// Orders triangles along an axis, equals by their index.
static bool is_before( const splitter* s, int axis, int32_t a, int32_t b )
{
    const float x = s->centre[a][axis], y = s->centre[b][axis];
    return x < y || ( x == y && a < b );
}

static void exchange( int32_t* a, int32_t* b )
{
    const int32_t kept = *a;
    *a = *b;
    *b = kept;
}

// Partition so that what is before `middle` is before all others along the axis (Hoare 1961).
static void select_middle( const splitter* s, int axis, int begin, int end, int middle )
{
    int first = begin, last = end - 1;
    while ( first < last )
    {
        const int32_t pivot = s->order[first + ( last - first ) / 2];
        int i = first, j = last;
        while ( i <= j )
        {
            while ( is_before( s, axis, s->order[i], pivot ) )
            {
                ++i;
            }
            while ( is_before( s, axis, pivot, s->order[j] ) )
            {
                --j;
            }
            if ( i <= j )
            {
                exchange( s->order + i++, s->order + j-- );
            }
        }
        if ( middle > j && middle < i )
        {
            return;
        }
        first = middle >= i ? i : first;
        last = middle <= j ? j : last;
    }
}

// Split a range at a multiple of the size of its children, which is 8 to some power, so that only the last child of a level
// is smaller.
static void split( const splitter* s, int begin, int end )
{
    const int count = end - begin;
    if ( count <= MESH_BVH_WIDTH )
    {
        return;
    }
    int64_t child = MESH_BVH_WIDTH;
    while ( child * MESH_BVH_WIDTH < count )
    {
        child *= MESH_BVH_WIDTH;
    }
    const int64_t children = ( count + child - 1 ) / child;
    const int middle = begin + (int)( children / 2 * child );
    select_middle( s, find_longest_axis( s, begin, end ), begin, end, middle );
    split( s, begin, middle );
    split( s, middle, end );
}

// ---- construction ----

static size_t leaves_of( const mesh_surface* s )
{
    return ( (size_t)s->triangle_count + MESH_BVH_WIDTH - 1 ) / MESH_BVH_WIDTH;
}

static size_t triangle_bytes( const mesh_bvh* bvh )
{
    return leaves_of( bvh->surface ) * MESH_BVH_WIDTH * sizeof( int32_t );
}

static size_t leaf_bytes( const mesh_bvh* bvh )
{
    return leaves_of( bvh->surface ) * sizeof( mesh_bvh_leaf );
}

static size_t group_bytes( const mesh_bvh* bvh )
{
    return (size_t)bvh->first[bvh->level_count] * sizeof( mesh_bvh_group );
}

static void lay_out_levels( mesh_bvh* bvh )
{
    size_t count = leaves_of( bvh->surface );
    bvh->level_count = 0;
    bvh->first[0] = 0;
    for ( bool is_root = false; is_root == false; count = ( count + MESH_BVH_WIDTH - 1 ) / MESH_BVH_WIDTH )
    {
        is_root = count == 1;
        bvh->first[bvh->level_count + 1] = bvh->first[bvh->level_count] + (int)count;
        bvh->level_count += 1;
    }
}

static void sort_triangles( mesh_bvh* bvh, float ( *centre )[3] )
{
    const mesh_surface* s = bvh->surface;
    const int padded = (int)leaves_of( s ) * MESH_BVH_WIDTH;
    for ( int32_t t = 0; t < s->triangle_count; ++t )
    {
        float lower[3], upper[3];
        mesh_surface_box( s, t, lower, upper );
        for ( int k = 0; k < 3; ++k )
        {
            centre[t][k] = lower[k] + upper[k];
        }
        bvh->triangle[t] = t;
    }
    for ( int i = s->triangle_count; i < padded; ++i )
    {
        bvh->triangle[i] = -1;
    }
    split( &( splitter ){ centre, bvh->triangle }, 0, s->triangle_count );
}

wisp_status mesh_bvh_build( mesh_bvh* bvh, const mesh_surface* surface, wisp_error* error )
{
    *bvh = ( mesh_bvh ){ .surface = surface };
    lay_out_levels( bvh );
    const wisp_allocator* allocator = &surface->allocator;
    const size_t centre_bytes = (size_t)surface->triangle_count * 3 * sizeof( float );
    float( *centre )[3] = base_allocate( allocator, centre_bytes, BASE_BUFFER_ALIGNMENT );
    bvh->triangle = base_allocate( allocator, triangle_bytes( bvh ), BASE_BUFFER_ALIGNMENT );
    bvh->leaves = base_allocate( allocator, leaf_bytes( bvh ), BASE_BUFFER_ALIGNMENT );
    bvh->groups = base_allocate( allocator, group_bytes( bvh ), BASE_BUFFER_ALIGNMENT );
    const bool enough = centre != NULL && bvh->triangle != NULL && bvh->leaves != NULL && bvh->groups != NULL;
    if ( enough )
    {
        sort_triangles( bvh, centre );
        mesh_bvh_refit( bvh, NULL );
        bvh->refit_count = 0;
    }
    else
    {
        mesh_bvh_release( bvh );
    }
    base_release( allocator, centre, centre_bytes );
    return enough ? WISP_OK
                  : wisp_fail( error, WISP_NO_MEMORY, "out of memory for a mesh collider of %d triangles",
                               surface->triangle_count );
}

void mesh_bvh_release( mesh_bvh* bvh )
{
    if ( bvh->surface != NULL )
    {
        base_release( &bvh->surface->allocator, bvh->triangle, triangle_bytes( bvh ) );
        base_release( &bvh->surface->allocator, bvh->leaves, leaf_bytes( bvh ) );
        base_release( &bvh->surface->allocator, bvh->groups, group_bytes( bvh ) );
    }
    *bvh = ( mesh_bvh ){ 0 };
}

size_t mesh_bvh_bytes( const mesh_bvh* bvh )
{
    return triangle_bytes( bvh ) + leaf_bytes( bvh ) + group_bytes( bvh );
}

// ---- refit ----

static void clear_child( mesh_bvh_group* group, int child )
{
    for ( int k = 0; k < 3; ++k )
    {
        group->lower[k][child] = FLT_MAX;
        group->upper[k][child] = -FLT_MAX;
    }
}

// Load one corner of eight triangles as lanes.
LANE_INLINE lane8v load_corners( const float* xyzw, const int32_t* quads )
{
    lane8v p;
    lane8_load_xyz( xyzw, quads, &p.x, &p.y, &p.z );
    return p;
}

LANE_INLINE void store_corner( float ( *to )[MESH_BVH_WIDTH], lane8v v )
{
    lane8_storeu( to[0], v.x );
    lane8_storeu( to[1], v.y );
    lane8_storeu( to[2], v.z );
}

LANE_INLINE lane8v smaller( lane8v a, lane8v b )
{
    return ( lane8v ){ lane8_min( a.x, b.x ), lane8_min( a.y, b.y ), lane8_min( a.z, b.z ) };
}

LANE_INLINE lane8v larger( lane8v a, lane8v b )
{
    return ( lane8v ){ lane8_max( a.x, b.x ), lane8_max( a.y, b.y ), lane8_max( a.z, b.z ) };
}

// A place without a triangle gets the first triangle of the leaf, and an empty box.
static void refit_leaf( const mesh_bvh* bvh, int leaf, float widening )
{
    const mesh_surface* s = bvh->surface;
    const int32_t* triangle = bvh->triangle + leaf * MESH_BVH_WIDTH;
    mesh_bvh_leaf* kept = bvh->leaves + leaf;
    lane8v lower = lane8v_set1( ( wisp_vec3 ){ INFINITY, INFINITY, INFINITY } ),
           upper = lane8v_set1( ( wisp_vec3 ){ -INFINITY, -INFINITY, -INFINITY } );
    lane8 farthest = lane8_zero();
    for ( size_t corner = 0; corner < 3; ++corner )
    {
        int32_t quads[MESH_BVH_WIDTH];
        for ( int child = 0; child < MESH_BVH_WIDTH; ++child )
        {
            const size_t t = (size_t)( triangle[child] >= 0 ? triangle[child] : triangle[0] );
            quads[child] = 4 * s->triangles[3 * t + corner];
        }
        const lane8v end = load_corners( s->xyzw, quads ),
                     start = s->start != NULL ? load_corners( s->start, quads ) : end,
                     displacement = lane8v_sub( end, start );
        store_corner( kept->start + 3 * corner, start );
        store_corner( kept->displacement + 3 * corner, displacement );
        lower = smaller( lower, smaller( start, end ) );
        upper = larger( upper, larger( start, end ) );
        farthest = lane8_max( farthest, lane8v_dot( displacement, displacement ) );
    }
    lane8_storeu( kept->shift, lane8_mul( lane8_set1( 1.00001f ), lane8_sqrt( farthest ) ) );
    const lane8v wide = lane8v_set1( ( wisp_vec3 ){ widening, widening, widening } );
    mesh_bvh_group* group = bvh->groups + leaf;
    store_corner( group->lower, lane8v_sub( lower, wide ) );
    store_corner( group->upper, lane8v_add( upper, wide ) );
    for ( int child = 0; child < MESH_BVH_WIDTH; ++child )
    {
        if ( triangle[child] < 0 )
        {
            clear_child( group, child );
        }
    }
}

static void refit_leaves( void* context, int begin, int end, int worker )
{
    (void)worker;
    const mesh_bvh* bvh = context;
    const float widening = (float)( MESH_WIDENING * bvh->surface->largest + MIN_SEARCH_SLACK );
    for ( int leaf = begin; leaf < end; ++leaf )
    {
        refit_leaf( bvh, leaf, widening );
    }
}

static float least_of( const float* v )
{
    float least = v[0];
    for ( int i = 1; i < MESH_BVH_WIDTH; ++i )
    {
        least = v[i] < least ? v[i] : least;
    }
    return least;
}

static float most_of( const float* v )
{
    float most = v[0];
    for ( int i = 1; i < MESH_BVH_WIDTH; ++i )
    {
        most = v[i] > most ? v[i] : most;
    }
    return most;
}

// Bound the children of the groups of a level by the groups below.
static void refit_level( mesh_bvh* bvh, int level )
{
    const mesh_bvh_group* below = bvh->groups + bvh->first[level - 1];
    const int count = bvh->first[level] - bvh->first[level - 1];
    const int padded = ( bvh->first[level + 1] - bvh->first[level] ) * MESH_BVH_WIDTH;
    for ( int i = 0; i < padded; ++i )
    {
        mesh_bvh_group* group = bvh->groups + bvh->first[level] + i / MESH_BVH_WIDTH;
        const int child = i % MESH_BVH_WIDTH;
        if ( i >= count )
        {
            clear_child( group, child );
            continue;
        }
        for ( int k = 0; k < 3; ++k )
        {
            group->lower[k][child] = least_of( below[i].lower[k] );
            group->upper[k][child] = most_of( below[i].upper[k] );
        }
    }
}

void mesh_bvh_refit( mesh_bvh* bvh, const wisp_parallel* parallel )
{
    const int leaves = bvh->first[1];
    if ( parallel != NULL )
    {
        wisp_parallel_for( parallel, leaves, REFIT_GRAIN, refit_leaves, bvh );
    }
    else
    {
        refit_leaves( bvh, 0, leaves, 0 );
    }
    for ( int level = 1; level < bvh->level_count; ++level )
    {
        refit_level( bvh, level );
    }
    bvh->refit_count += 1;
}
