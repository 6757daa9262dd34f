// Pairs of boxes: for every number of workers and instruction set, the pairs are those of a double loop, in
// its order.
#include "support.h"

#include "box_search.h"
#include "jobs.h"
#include "kernel_tables.h"

enum
{
    MAX_BOXES = 700,
};

typedef enum box_shape
{
    BOXES_RANDOM,
    BOXES_CLUSTERED,  // clusters far apart, so that cells must widen
    BOXES_SHEET,      // flat, exactly in a plane
    BOXES_FOLDED,     // three layers
    BOXES_UNEVEN,     // sizes from 1 to 1000
    BOXES_COINCIDENT, // all the same
    BOXES_POINTS,     // without size, some at the same position
    BOXES_LATTICE,    // faces that touch exactly
    BOXES_HUGE,       // a few that reach to the largest floats
    BOXES_WRONG,      // some with NaN, or lower above upper
    BOXES_NONE_RIGHT,
    BOXES_SHAPE_COUNT,
} box_shape;

static wisp_aabb box_at( float x, float y, float z, float size_x, float size_y, float size_z )
{
    return ( wisp_aabb ){ { x, y, z }, { x + size_x, y + size_y, z + size_z } };
}

static float any( int i, int draw, float lower, float upper )
{
    return test_random_float( i, draw, lower, upper );
}

static wisp_aabb spoil( wisp_aabb box, int i )
{
    const float bad[] = { NAN, -NAN, INFINITY, -INFINITY };
    if ( i % 5 == 4 )
    {
        box.lower[i % 3] = nextafterf( box.upper[i % 3], INFINITY );
    }
    else
    {
        ( i % 2 == 0 ? box.lower : box.upper )[i / 2 % 3] = bad[i % 4];
    }
    return box;
}

static wisp_aabb make_box( box_shape shape, int i, int seed )
{
    float x = any( i, seed, 0.0f, 1.0f ), y = any( i, seed + 1, 0.0f, 1.0f ), z = any( i, seed + 2, 0.0f, 1.0f );
    float size = any( i, seed + 3, 0.02f, 0.12f ), uneven = 0.0005f * powf( 1000.0f, any( i, seed + 4, 0.0f, 1.0f ) );
    wisp_aabb plain = box_at( x, y, z, size, 0.1f - 0.5f * size, size );
    switch ( shape )
    {
        case BOXES_CLUSTERED:
            return box_at( 1e4f * (float)( i % 5 ) + x, -2e5f * (float)( i % 3 ) + y, z, 0.05f, 0.05f, 0.05f );
        case BOXES_SHEET:
            return box_at( x, 2.5f, z, 0.5f * size, 0.0f, 0.5f * size );
        case BOXES_FOLDED:
            return box_at( x, 0.01f * (float)( i % 3 ), z, 0.05f, 0.005f + 0.1f * size, 0.05f );
        case BOXES_UNEVEN:
            return box_at( x - 0.5f, y - 0.5f, z - 0.5f, uneven, uneven, uneven );
        case BOXES_COINCIDENT:
            return box_at( -3.0f, 4.0f, 1.0f, 0.1f, 0.2f, 0.0f );
        case BOXES_POINTS:
            return box_at( 0.25f * floorf( 8.0f * x ), y < 0.5f ? 1.0f : 2.0f, floorf( 4.0f * z ), 0.0f, 0.0f, 0.0f );
        case BOXES_LATTICE:
            return box_at( (float)( i % 9 ), (float)( i / 9 % 9 ), (float)( i / 81 ), 1.0f, 1.0f, 1.0f );
        case BOXES_HUGE:
            return i % 37 != 5  ? plain
                   : i % 2 == 0 ? ( wisp_aabb ){ { -FLT_MAX, -1e30f, z }, { x, FLT_MAX, FLT_MAX } }
                                : box_at( i % 3 == 0 ? -3e38f : 2e19f, y, -1e18f, 1e38f, 1e-30f, 1e20f );
        case BOXES_WRONG:
            return i % 4 == 1 ? spoil( plain, i ) : plain;
        case BOXES_NONE_RIGHT:
            return spoil( plain, i );
        default:
            return plain;
    }
}

static void make_boxes( wisp_aabb* boxes, box_shape shape, int count, int seed )
{
    for ( int i = 0; i < count; ++i )
    {
        boxes[i] = make_box( shape, i, seed );
    }
}

// ---- reference ----

typedef struct right_pairs
{
    int32_t* begin;
    int32_t* item;
    size_t count;
} right_pairs;

// Independent of the engine's own comparison.
static bool is_right_box( const wisp_aabb* b )
{
    return isfinite( b->lower[0] ) && isfinite( b->lower[1] ) && isfinite( b->lower[2] ) && isfinite( b->upper[0] ) &&
           isfinite( b->upper[1] ) && isfinite( b->upper[2] ) && b->lower[0] <= b->upper[0] &&
           b->lower[1] <= b->upper[1] && b->lower[2] <= b->upper[2];
}

static bool is_right_pair( const wisp_aabb* a, const wisp_aabb* b )
{
    return is_right_box( a ) && is_right_box( b ) && a->lower[0] <= b->upper[0] && b->lower[0] <= a->upper[0] &&
           a->lower[1] <= b->upper[1] && b->lower[1] <= a->upper[1] && a->lower[2] <= b->upper[2] &&
           b->lower[2] <= a->upper[2];
}

static right_pairs find_right_pairs( const wisp_aabb_args* args )
{
    const bool is_self = args->queries == NULL;
    const wisp_aabb* queries = is_self ? args->boxes : args->queries;
    const int count = is_self ? args->box_count : args->query_count;
    right_pairs right = { calloc( (size_t)count + 1, sizeof( int32_t ) ),
                          calloc( (size_t)count * (size_t)args->box_count + 1, sizeof( int32_t ) ), 0 };
    assert_true( right.begin != NULL && right.item != NULL );
    for ( int a = 0; a < count; ++a )
    {
        for ( int b = is_self ? a + 1 : 0; b < args->box_count; ++b )
        {
            if ( is_right_pair( queries + a, args->boxes + b ) )
            {
                right.item[right.count++] = b;
            }
        }
        right.begin[a + 1] = (int32_t)right.count;
    }
    return right;
}

static void free_right_pairs( right_pairs* right )
{
    free( right->begin );
    free( right->item );
}

// ---- searches, with an active pool of workers ----

typedef struct finder
{
    test_host host;
    wisp_allocator allocator;
    jobs_pool* pool;
    wisp_aabb_pairs pairs;
    const wisp_aabb_args* args;
    wisp_error error;
    wisp_status status;
} finder;

static finder* finder_open( int workers )
{
    finder* f = checked_calloc( 1, sizeof( finder ) );
    f->allocator = test_host_allocator( &f->host );
    f->pool = jobs_create( &f->allocator, workers, NULL, NULL );
    return f;
}

static void finder_close( finder** local )
{
    finder* f = *local;
    wisp_aabb_pairs_release( &f->pairs, &f->allocator );
    jobs_destroy( f->pool );
    assert_host_memory_is_released( &f->host );
    free( f );
}

static void run_find( void* context )
{
    finder* f = context;
    f->status = wisp_aabb_pairs_find( &f->pairs, jobs_everyone( f->pool ), f->args, &f->error );
}

static wisp_status find( finder* f, const wisp_aabb_args* args )
{
    f->args = args;
    jobs_enter( f->pool, run_find, f );
    return f->status;
}

static void assert_right( const wisp_aabb_pairs* pairs, const wisp_aabb_args* args, const right_pairs* right )
{
    int queries = args->queries == NULL ? args->box_count : args->query_count;
    assert_int_equal( pairs->query_count, queries );
    assert_int_equal( pairs->pair_count, right->count );
    assert_memory_equal( pairs->begin, right->begin, ( (size_t)queries + 1 ) * sizeof( int32_t ) );
    if ( right->count > 0 )
    {
        assert_memory_equal( pairs->item, right->item, right->count * sizeof( int32_t ) );
    }
}

static void find_right( finder* f, const wisp_aabb_args* args )
{
    SCOPED( free_right_pairs ) right_pairs right = find_right_pairs( args );
    assert_int_equal( find( f, args ), WISP_OK );
    assert_right( &f->pairs, args, &right );
}

static int list_tables( const wisp_kernels* tables[4] )
{
    const char* const names[] = { "baseline", "avx2", "avx512" };
    int count = 0;
    tables[count++] = NULL;
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        const wisp_kernels* table = kernels_select( names[i], NULL );
        if ( table != tables[count - 1] )
        {
            tables[count++] = table;
        }
    }
    return count;
}

// ---- the tests ----

// One finder for all, so that buffers of one scene are reused for the next.
static void check_everything( finder* f, const wisp_aabb* queries, int query_count, const wisp_aabb* boxes,
                              int count )
{
    const wisp_kernels* tables[4];
    const int table_count = list_tables( tables );
    wisp_aabb_args args = { .queries = queries, .query_count = query_count, .boxes = boxes, .box_count = count };
    SCOPED( free_right_pairs ) right_pairs right = find_right_pairs( &args );
    for ( int t = 0; t < table_count; ++t )
    {
        args.kernels = tables[t];
        assert_int_equal( find( f, &args ), WISP_OK );
        assert_right( &f->pairs, &args, &right );
    }
}

TEST( grids_find_the_pairs_of_a_double_loop )
{
    const int counts[] = { 0, 1, 2, 7, 8, 9, 17, 100, MAX_BOXES };
    const int workers[] = { 1, 3 };
    static wisp_aabb boxes[MAX_BOXES], queries[MAX_BOXES], points[MAX_BOXES];
    for ( int w = 0; w < WISP_COUNT( workers ); ++w )
    {
        SCOPED( finder_close ) finder* f = finder_open( workers[w] );
        for ( int shape = 0; shape < BOXES_SHAPE_COUNT; ++shape )
        {
            for ( int c = 0; c < WISP_COUNT( counts ); ++c )
            {
                const int count = counts[c];
                make_boxes( boxes, (box_shape)shape, count, 0 );
                make_boxes( queries, (box_shape)shape, count, 10 );
                for ( int i = 0; i < count; ++i )
                {
                    points[i] = boxes[( 7 * i ) % count];
                    memcpy( points[i].upper, points[i].lower, sizeof( points[i].lower ) );
                }
                check_everything( f, NULL, 0, boxes, count );
                check_everything( f, queries, count, boxes, count );
                check_everything( f, points, count, boxes, count / 2 );
                check_everything( f, queries, count, boxes, 0 );
            }
        }
    }
}

// Pairs whose indices add up to a multiple of three, moved to the front in reverse.
static int keep_thirds( const void* context, int query, int32_t* items, int count )
{
    const int* offset = context;
    int kept = 0;
    for ( int i = 0; i < count; ++i )
    {
        const int32_t item = items[i];
        items[i] = items[kept];
        items[kept] = item;
        kept += ( query + item + *offset ) % 3 == 0 ? 1 : 0;
    }
    for ( int i = 0; i < kept / 2; ++i )
    {
        const int32_t item = items[i];
        items[i] = items[kept - 1 - i];
        items[kept - 1 - i] = item;
    }
    return kept;
}

static right_pairs find_right_thirds( const wisp_aabb_args* args, int offset )
{
    right_pairs right = find_right_pairs( args );
    const int count = args->queries == NULL ? args->box_count : args->query_count;
    size_t kept = 0;
    for ( int a = 0, k = 0; a < count; ++a )
    {
        const int end = right.begin[a + 1];
        for ( ; k < end; ++k )
        {
            right.item[kept] = right.item[k];
            kept += ( a + right.item[k] + offset ) % 3 == 0 ? 1 : 0;
        }
        right.begin[a + 1] = (int32_t)kept;
    }
    right.count = kept;
    return right;
}

TEST( a_filter_keeps_what_it_requests_in_order )
{
    static wisp_aabb boxes[MAX_BOXES], queries[MAX_BOXES];
    const int offset = 1;
    SCOPED( finder_close ) finder* f = finder_open( 2 );
    for ( int shape = 0; shape < BOXES_SHAPE_COUNT; ++shape )
    {
        make_boxes( boxes, (box_shape)shape, MAX_BOXES, 0 );
        make_boxes( queries, (box_shape)shape, MAX_BOXES, 10 );
        for ( int s = 0; s < 2; ++s )
        {
            const wisp_aabb_args args = {
                .queries = s == 0 ? NULL : queries,
                .query_count = s == 0 ? 0 : MAX_BOXES,
                .boxes = boxes,
                .box_count = MAX_BOXES,
                .kernels = kernels_select( NULL, NULL ),
                .filter = keep_thirds,
                .filter_context = &offset,
            };
            SCOPED( free_right_pairs ) right_pairs right = find_right_thirds( &args, offset );
            assert_int_equal( find( f, &args ), WISP_OK );
            assert_right( &f->pairs, &args, &right );
        }
    }
}

TEST( other_queries_reuse_the_grid )
{
    static wisp_aabb boxes[MAX_BOXES], queries[MAX_BOXES], moved[MAX_BOXES];
    SCOPED( finder_close ) finder* f = finder_open( 2 );
    for ( int shape = 0; shape < BOXES_SHAPE_COUNT; ++shape )
    {
        make_boxes( boxes, (box_shape)shape, MAX_BOXES, 0 );
        make_boxes( queries, (box_shape)shape, MAX_BOXES, 10 );
        make_boxes( moved, (box_shape)shape, MAX_BOXES, 20 );
        wisp_aabb_args args = { .boxes = boxes, .box_count = MAX_BOXES, .kernels = kernels_select( NULL, NULL ) };
        find_right( f, &args );
        args.reuse = true;
        args.queries = queries;
        args.query_count = MAX_BOXES / 5;
        find_right( f, &args );
        args.queries = moved;
        args.query_count = MAX_BOXES;
        find_right( f, &args );
    }
}

TEST( the_number_of_workers_does_not_show )
{
    static wisp_aabb boxes[5 * MAX_BOXES];
    const int count = WISP_COUNT( boxes ), workers[] = { 1, 2, 3, 8 };
    for ( int shape = 0; shape < BOXES_SHAPE_COUNT; ++shape )
    {
        if ( shape == BOXES_COINCIDENT || shape == BOXES_LATTICE )
        {
            continue; // six million pairs each way; a lattice ends at 729
        }
        make_boxes( boxes, (box_shape)shape, count, 20 );
        const wisp_aabb_args args = { .boxes = boxes, .box_count = count, .kernels = kernels_select( NULL, NULL ) };
        SCOPED( free_right_pairs ) right_pairs right = find_right_pairs( &args );
        uint64_t tested = 0;
        for ( int w = 0; w < WISP_COUNT( workers ); ++w )
        {
            SCOPED( finder_close ) finder* f = finder_open( workers[w] );
            assert_int_equal( find( f, &args ), WISP_OK );
            assert_right( &f->pairs, &args, &right );
            tested = w == 0 ? f->pairs.tested : tested;
            assert_int_equal( f->pairs.tested, tested );
        }
    }
}

TEST( a_grid_compares_far_fewer_boxes_than_there_are )
{
    // a single grid cannot handle sizes from 1 to 1000 and huge boxes among small ones
    const box_shape shapes[] = { BOXES_RANDOM, BOXES_SHEET, BOXES_UNEVEN, BOXES_HUGE };
    static wisp_aabb boxes[5 * MAX_BOXES];
    const uint64_t count = WISP_COUNT( boxes );
    for ( int i = 0; i < WISP_COUNT( shapes ); ++i )
    {
        SCOPED( finder_close ) finder* f = finder_open( 1 );
        make_boxes( boxes, shapes[i], (int)count, 30 );
        find_right( f, &( wisp_aabb_args ){ .boxes = boxes, .box_count = (int)count } );
        // in both directions, with a margin around each box: the largest boxes alone leave an eighth of all
        assert_true( f->pairs.tested < count * count / 8 + 12 * f->pairs.pair_count );
    }
}

TEST( more_pairs_than_the_limit_are_refused_before_memory_is_taken )
{
    static wisp_aabb boxes[MAX_BOXES];
    make_boxes( boxes, BOXES_COINCIDENT, MAX_BOXES, 0 );
    const size_t all = (size_t)MAX_BOXES * ( MAX_BOXES - 1 ) / 2;
    SCOPED( finder_close ) finder* f = finder_open( 2 );
    wisp_aabb_args args = { .boxes = boxes, .box_count = MAX_BOXES, .limit = all - 1 };
    assert_int_equal( find( f, &args ), WISP_BAD_INPUT );
    char numbers[2][32];
    snprintf( numbers[0], sizeof( numbers[0] ), "%zu", all );
    snprintf( numbers[1], sizeof( numbers[1] ), "%zu", all - 1 );
    assert_non_null( strstr( f->error.message, numbers[0] ) );
    assert_non_null( strstr( f->error.message, numbers[1] ) );
    assert_int_equal( f->pairs.pair_count, 0 );
    assert_int_equal( f->pairs.query_count, 0 );
    for ( int i = 0; i < WISP_COUNT( f->pairs.buffers ); ++i )
    {
        assert_true( f->pairs.buffers[i].size < all );
    }
    args.limit = all;
    find_right( f, &args );
}

TEST( without_memory_it_says_so_and_works_again_with_it )
{
    static wisp_aabb boxes[MAX_BOXES];
    make_boxes( boxes, BOXES_UNEVEN, MAX_BOXES, 0 );
    const wisp_aabb_args args = { .boxes = boxes, .box_count = MAX_BOXES };
    bool was_refused = true;
    for ( int64_t refused = 1; was_refused; ++refused )
    {
        SCOPED( finder_close ) finder* f = finder_open( 1 );
        f->host.refuse = atomic_load( &f->host.queried ) + refused;
        f->host.refuse_rest = true;
        wisp_status status = find( f, &args );
        was_refused = status != WISP_OK;
        assert_true( status == WISP_OK || status == WISP_NO_MEMORY );
        f->host.refuse = 0;
        find_right( f, &args );
    }
}
