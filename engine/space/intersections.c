// Intersections of edges with triangles. Overlapping boxes give candidates, and exact predicates decide. Candidates
// are tested in blocks of a fixed size. Each block stores its results from its first candidate on. Blocks are then
// joined in order of edges and their triangles.
#include "wisp/module/definition.h"
#include "wisp/module/intersections.h"

#include <math.h>
#include <string.h>

enum
{
    INTERSECTIONS_BOX_GRAIN = 1024,
    INTERSECTIONS_PAIR_GRAIN = 1024, // candidates per block
};

// Indices of the buffers.
enum
{
    INTERSECTIONS_EDGE_BOXES,
    INTERSECTIONS_TRIANGLE_BOXES,
    INTERSECTIONS_BLOCKS,
    INTERSECTIONS_LIST,
};

typedef struct intersection_search
{
    const wisp_intersection_args* args;
    wisp_aabb *edge_boxes, *triangle_boxes;
    const wisp_aabb_pairs* pairs;
    wisp_intersection* list; // [pair_count] each block writes from its first candidate on
    int32_t* kept;           // [block] number of results
} intersection_search;

size_t wisp_intersections_bytes( const wisp_intersections* intersections )
{
    return wisp_buffer_bytes( intersections->buffers, WISP_COUNT( intersections->buffers ) ) +
           wisp_aabb_pairs_bytes( &intersections->pairs );
}

void wisp_intersections_release( wisp_intersections* intersections, const wisp_allocator* allocator )
{
    for ( int i = 0; i < WISP_COUNT( intersections->buffers ); ++i )
    {
        wisp_buffer_release( intersections->buffers + i, allocator );
    }
    wisp_aabb_pairs_release( &intersections->pairs, allocator );
    *intersections = ( wisp_intersections ){ 0 };
}

// ---- candidates ----

// Computes the box of some points; empty if a coordinate is not finite.
static wisp_aabb box_of( const float* xyzw, const int32_t* corners, int count )
{
    static const wisp_aabb empty = { { 1.0f, 1.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };
    wisp_aabb box;
    for ( int axis = 0; axis < 3; ++axis )
    {
        float lower = INFINITY, upper = -INFINITY;
        for ( int i = 0; i < count; ++i )
        {
            const float x = xyzw[4 * (size_t)corners[i] + (size_t)axis];
            if ( !isfinite( x ) )
            {
                return empty;
            }
            lower = x < lower ? x : lower;
            upper = x > upper ? x : upper;
        }
        box.lower[axis] = lower;
        box.upper[axis] = upper;
    }
    return box;
}

// Edges, then triangles.
static void box_primitives( void* context, int begin, int end, int worker )
{
    (void)worker;
    const intersection_search* s = context;
    const wisp_intersection_args* args = s->args;
    for ( int i = begin; i < end; ++i )
    {
        const int t = i - args->edge_count;
        *( t < 0 ? s->edge_boxes + i : s->triangle_boxes + t ) =
            t < 0 ? box_of( args->xyzw, args->edges + 2 * (size_t)i, 2 )
                  : box_of( args->xyzw, args->triangles + 3 * (size_t)t, 3 );
    }
}

static wisp_status find_candidates( wisp_intersections* intersections, const wisp_parallel* parallel,
                                    intersection_search* s, wisp_error* error )
{
    const wisp_intersection_args* args = s->args;
    const wisp_allocator* allocator = wisp_parallel_allocator( parallel );
    wisp_buffer *edges = intersections->buffers + INTERSECTIONS_EDGE_BOXES,
                *triangles = intersections->buffers + INTERSECTIONS_TRIANGLE_BOXES;
    // at least one box: null queries would mean that the boxes query each other
    if ( !wisp_buffer_reserve( edges, allocator, ( (size_t)args->edge_count + 1 ) * sizeof( wisp_aabb ) ) ||
         !wisp_buffer_reserve( triangles, allocator, ( (size_t)args->triangle_count + 1 ) * sizeof( wisp_aabb ) ) )
    {
        return wisp_fail( error, WISP_NO_MEMORY,
                          "out of memory to look for intersections of %d edges and %d triangles", args->edge_count,
                          args->triangle_count );
    }
    s->edge_boxes = edges->data;
    s->triangle_boxes = triangles->data;
    wisp_parallel_for( parallel, args->edge_count + args->triangle_count, INTERSECTIONS_BOX_GRAIN, box_primitives,
                       s );
    const wisp_aabb_args boxes = {
        .queries = s->edge_boxes,
        .query_count = args->edge_count,
        .boxes = s->triangle_boxes,
        .box_count = args->triangle_count,
        .kernels = args->kernels,
    };
    return wisp_aabb_pairs_find( &intersections->pairs, parallel, &boxes, error );
}

// ---- tests ----

// Tests for a shared point. Such an edge touches the plane exactly; comparing indices is cheaper than the
// predicate.
static bool share_a_point( const int32_t* edge, const int32_t* triangle )
{
    for ( int i = 0; i < 3; ++i )
    {
        if ( triangle[i] == edge[0] || triangle[i] == edge[1] )
        {
            return true;
        }
    }
    return false;
}

static bool crosses( const wisp_intersection_args* args, int edge, int triangle )
{
    const int32_t *e = args->edges + 2 * (size_t)edge, *t = args->triangles + 3 * (size_t)triangle;
    if ( share_a_point( e, t ) )
    {
        return false;
    }
    const float* corner[5];
    for ( int i = 0; i < 5; ++i )
    {
        corner[i] = args->xyzw + 4 * (size_t)( i < 2 ? e[i] : t[i - 2] );
    }
    return wisp_segment_intersects( corner[0], corner[1], corner[2], corner[3], corner[4] );
}

// Finds the edge of a candidate: the last edge whose first candidate is not after it.
static int edge_of( const wisp_aabb_pairs* pairs, int pair )
{
    int lower = 0, upper = pairs->query_count;
    while ( upper - lower > 1 )
    {
        const int middle = lower + ( upper - lower ) / 2;
        if ( pairs->begin[middle] <= pair )
        {
            lower = middle;
        }
        else
        {
            upper = middle;
        }
    }
    return lower;
}

static void decide( void* context, int begin, int end, int worker )
{
    (void)worker;
    intersection_search* s = context;
    int edge = edge_of( s->pairs, begin ), kept = 0;
    for ( int pair = begin; pair < end; ++pair )
    {
        for ( ; s->pairs->begin[edge + 1] <= pair; ++edge )
        {
        }
        const int triangle = s->pairs->item[pair];
        if ( crosses( s->args, edge, triangle ) )
        {
            s->list[begin + kept++] = ( wisp_intersection ){ edge, triangle };
        }
    }
    s->kept[begin / INTERSECTIONS_PAIR_GRAIN] = kept;
}

// Closes the gaps between blocks.
static int push_together( const intersection_search* s, int block_count )
{
    int count = 0;
    for ( int block = 0; block < block_count; ++block )
    {
        const wisp_intersection* first = s->list + (size_t)block * INTERSECTIONS_PAIR_GRAIN;
        memmove( s->list + count, first, (size_t)s->kept[block] * sizeof( *first ) );
        count += s->kept[block];
    }
    return count;
}

wisp_status wisp_intersections_find( wisp_intersections* intersections, const wisp_parallel* parallel,
                                     const wisp_intersection_args* args, wisp_error* error )
{
    const wisp_allocator* allocator = wisp_parallel_allocator( parallel );
    intersection_search s = { .args = args, .pairs = &intersections->pairs };
    WISP_TRY( find_candidates( intersections, parallel, &s, error ) );
    // the last result stays valid until this one is complete; the number of results fits an int, as that of pairs
    // does
    const size_t pair_count = intersections->pairs.pair_count;
    const size_t block_count =
        pair_count / INTERSECTIONS_PAIR_GRAIN + ( pair_count % INTERSECTIONS_PAIR_GRAIN > 0 ? 1 : 0 );
    if ( !wisp_buffer_reserve( intersections->buffers + INTERSECTIONS_BLOCKS, allocator,
                               block_count * sizeof( int32_t ) ) ||
         !wisp_buffer_reserve( intersections->buffers + INTERSECTIONS_LIST, allocator,
                               pair_count * sizeof( wisp_intersection ) ) )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for intersections among %zu candidates", pair_count );
    }
    s.kept = intersections->buffers[INTERSECTIONS_BLOCKS].data;
    s.list = intersections->buffers[INTERSECTIONS_LIST].data;
    wisp_parallel_for( parallel, (int)pair_count, INTERSECTIONS_PAIR_GRAIN, decide, &s );
    intersections->count = push_together( &s, (int)block_count );
    intersections->list = s.list;
    return WISP_OK;
}
