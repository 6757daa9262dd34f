// Which edges pass through which triangles. Overlapping boxes give candidates; exact signs decide. Candidates
// are tested in blocks of a fixed size. Each block keeps its results in the places of its candidates, and the blocks are then
// joined in order, which is that of the edges and their triangles.
#include "wisp/module/crossings.h"

#include <math.h>
#include <string.h>

enum
{
    CROSSINGS_BOX_GRAIN = 1024,
    CROSSINGS_PAIR_GRAIN = 1024, // candidates a block
};

// Places of the buffers.
enum
{
    CROSSINGS_EDGE_BOXES,
    CROSSINGS_TRIANGLE_BOXES,
    CROSSINGS_BLOCKS,
    CROSSINGS_LIST,
};

typedef struct crossing_search
{
    const wisp_crossing_job* job;
    wisp_box *edge_boxes, *triangle_boxes;
    const wisp_box_pairs* pairs;
    wisp_crossing* list; // [pair_count] a block's own, from its first candidate on
    int32_t* kept;       // [block]
} crossing_search;

void wisp_crossings_release( wisp_crossings* crossings, const wisp_allocator* allocator )
{
    for ( int i = 0; i < WISP_COUNT( crossings->buffers ); ++i )
    {
        wisp_buffer_release( crossings->buffers + i, allocator );
    }
    wisp_box_pairs_release( &crossings->pairs, allocator );
    *crossings = ( wisp_crossings ){ 0 };
}

// ---- candidates ----

// The box of a few points; an empty one when any coordinate is not finite.
static wisp_box box_of( const float* quads, const int32_t* corners, int count )
{
    static const wisp_box empty = { { 1.0f, 1.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };
    wisp_box box;
    for ( int axis = 0; axis < 3; ++axis )
    {
        float low = INFINITY, high = -INFINITY;
        for ( int i = 0; i < count; ++i )
        {
            const float x = quads[4 * (size_t)corners[i] + (size_t)axis];
            if ( !isfinite( x ) )
            {
                return empty;
            }
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        box.low[axis] = low;
        box.high[axis] = high;
    }
    return box;
}

static void box_edges( void* context, int begin, int end, int worker )
{
    (void)worker;
    const crossing_search* s = context;
    for ( int i = begin; i < end; ++i )
    {
        s->edge_boxes[i] = box_of( s->job->quads, s->job->edges + 2 * (size_t)i, 2 );
    }
}

static void box_triangles( void* context, int begin, int end, int worker )
{
    (void)worker;
    const crossing_search* s = context;
    for ( int i = begin; i < end; ++i )
    {
        s->triangle_boxes[i] = box_of( s->job->quads, s->job->triangles + 3 * (size_t)i, 3 );
    }
}

static wisp_status find_candidates( wisp_crossings* crossings, const wisp_parallel* parallel, crossing_search* s,
                                    wisp_error* error )
{
    const wisp_crossing_job* job = s->job;
    const wisp_allocator* allocator = wisp_parallel_allocator( parallel );
    wisp_buffer *edges = crossings->buffers + CROSSINGS_EDGE_BOXES,
                *triangles = crossings->buffers + CROSSINGS_TRIANGLE_BOXES;
    // at least one box: without edges the askers must not become null, which means something else
    if ( !wisp_buffer_reserve( edges, allocator, ( (size_t)job->edge_count + 1 ) * sizeof( wisp_box ) ) ||
         !wisp_buffer_reserve( triangles, allocator, ( (size_t)job->triangle_count + 1 ) * sizeof( wisp_box ) ) )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to look for crossings of %d edges and %d triangles",
                          job->edge_count, job->triangle_count );
    }
    s->edge_boxes = edges->data;
    s->triangle_boxes = triangles->data;
    wisp_parallel_for( parallel, job->edge_count, CROSSINGS_BOX_GRAIN, box_edges, s );
    wisp_parallel_for( parallel, job->triangle_count, CROSSINGS_BOX_GRAIN, box_triangles, s );
    const wisp_box_job boxes = {
        .askers = s->edge_boxes,
        .asker_count = job->edge_count,
        .boxes = s->triangle_boxes,
        .box_count = job->triangle_count,
        .search = job->search,
    };
    return wisp_box_pairs_find( &crossings->pairs, parallel, &boxes, error );
}

// ---- decisions ----

// An edge that ends on a corner touches the plane, exactly; to compare numbers is cheaper than to find that out.
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

static bool crosses( const wisp_crossing_job* job, int edge, int triangle )
{
    const int32_t *e = job->edges + 2 * (size_t)edge, *t = job->triangles + 3 * (size_t)triangle;
    if ( share_a_point( e, t ) )
    {
        return false;
    }
    const float* corner[5];
    for ( int i = 0; i < 5; ++i )
    {
        corner[i] = job->quads + 4 * (size_t)( i < 2 ? e[i] : t[i - 2] );
    }
    return wisp_segment_crosses( corner[0], corner[1], corner[2], corner[3], corner[4] );
}

// Edge of a candidate: the last whose candidates begin at or before it.
static int edge_of( const wisp_box_pairs* pairs, int pair )
{
    int low = 0, high = pairs->asker_count;
    while ( high - low > 1 )
    {
        const int middle = low + ( high - low ) / 2;
        if ( pairs->begin[middle] <= pair )
        {
            low = middle;
        }
        else
        {
            high = middle;
        }
    }
    return low;
}

static void decide( void* context, int begin, int end, int worker )
{
    (void)worker;
    crossing_search* s = context;
    int edge = edge_of( s->pairs, begin ), kept = 0;
    for ( int pair = begin; pair < end; ++pair )
    {
        for ( ; s->pairs->begin[edge + 1] <= pair; ++edge )
        {
        }
        const int triangle = s->pairs->item[pair];
        if ( crosses( s->job, edge, triangle ) )
        {
            s->list[begin + kept++] = ( wisp_crossing ){ edge, triangle };
        }
    }
    s->kept[begin / CROSSINGS_PAIR_GRAIN] = kept;
}

// Close the gaps between blocks.
static int push_together( const crossing_search* s, int block_count )
{
    int count = 0;
    for ( int block = 0; block < block_count; ++block )
    {
        const wisp_crossing* first = s->list + (size_t)block * CROSSINGS_PAIR_GRAIN;
        memmove( s->list + count, first, (size_t)s->kept[block] * sizeof( *first ) );
        count += s->kept[block];
    }
    return count;
}

wisp_status wisp_crossings_find( wisp_crossings* crossings, const wisp_parallel* parallel,
                                 const wisp_crossing_job* job, wisp_error* error )
{
    const wisp_allocator* allocator = wisp_parallel_allocator( parallel );
    crossing_search s = { .job = job, .pairs = &crossings->pairs };
    const wisp_status status = find_candidates( crossings, parallel, &s, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    // the list of the last call is not touched before everything is there; pairs are numbered by ints, so are these
    const size_t pair_count = crossings->pairs.pair_count;
    const size_t block_count = pair_count / CROSSINGS_PAIR_GRAIN + ( pair_count % CROSSINGS_PAIR_GRAIN > 0 ? 1 : 0 );
    if ( !wisp_buffer_reserve( crossings->buffers + CROSSINGS_BLOCKS, allocator, block_count * sizeof( int32_t ) ) ||
         !wisp_buffer_reserve( crossings->buffers + CROSSINGS_LIST, allocator,
                               pair_count * sizeof( wisp_crossing ) ) )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for crossings among %zu candidates", pair_count );
    }
    s.kept = crossings->buffers[CROSSINGS_BLOCKS].data;
    s.list = crossings->buffers[CROSSINGS_LIST].data;
    wisp_parallel_for( parallel, (int)pair_count, CROSSINGS_PAIR_GRAIN, decide, &s );
    crossings->count = push_together( &s, (int)block_count );
    crossings->list = s.list;
    return WISP_OK;
}
