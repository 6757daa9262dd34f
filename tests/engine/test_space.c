// Neighbours against brute force, for every instruction set that runs here and any number of workers; the grid against a
// naive sort.
#include "support.h"

#include "jobs.h"
#include "kernel_tables.h"

#include "wisp/module/space.h"

// ---- clouds ----

typedef enum cloud_shape
{
    CLOUD_BALL,      // uniform in a cube around the origin
    CLOUD_SHEET,     // the same with z = 0
    CLOUD_NEGATIVE,  // a cube far on the negative side
    CLOUD_CLUSTERS,  // dense clusters far apart
    CLOUD_LINE,      // along a diagonal
    CLOUD_AXIS,      // along y alone
    CLOUD_ONE_POINT, // all items coincide
    CLOUD_LATTICE,   // a cubic lattice of a quarter: distances of exactly the radius, items exactly on cells' borders
    CLOUD_SPREAD,    // two clusters a million apart, so that cells must widen
    CLOUD_SHAPE_COUNT,
} cloud_shape;

typedef struct cloud
{
    int count;
    float* xyzw;
} cloud;

static wisp_vec3 cloud_point( cloud_shape shape, int i, int count )
{
    wisp_vec3 u = { test_random_float( i, 0, -1.0f, 1.0f ), test_random_float( i, 1, -1.0f, 1.0f ),
                    test_random_float( i, 2, -1.0f, 1.0f ) };
    float t = (float)i / (float)count;
    switch ( shape )
    {
        case CLOUD_SHEET:
            return ( wisp_vec3 ){ u.x, u.y, 0.0f };
        case CLOUD_NEGATIVE:
            return ( wisp_vec3 ){ u.x - 900.0f, u.y - 700.0f, u.z - 800.0f };
        case CLOUD_CLUSTERS:
        {
            float heap = (float)( i % 5 );
            return ( wisp_vec3 ){ 7.0f * heap + 0.1f * u.x, -3.0f * heap + 0.1f * u.y, 0.1f * u.z };
        }
        case CLOUD_LINE:
            return ( wisp_vec3 ){ 5.0f * t, 5.0f * t, -5.0f * t };
        case CLOUD_AXIS:
            return ( wisp_vec3 ){ 2.0f, 9.0f * u.y, 2.0f };
        case CLOUD_ONE_POINT:
            return ( wisp_vec3 ){ 0.3f, -0.4f, 0.5f };
        case CLOUD_LATTICE:
            return ( wisp_vec3 ){ 0.25f * (float)( i % 9 ), 0.25f * (float)( i / 9 % 9 ), 0.25f * (float)( i / 81 ) };
        case CLOUD_SPREAD:
            return ( wisp_vec3 ){ ( i % 2 == 0 ? -5e5f : 5e5f ) + u.x, u.y, i % 7 == 0 ? 3e5f : u.z };
        default:
            return u;
    }
}

// Owners of about four items each, so that some near items are the query's own.
static cloud make_cloud( cloud_shape shape, int count )
{
    cloud c = { count, calloc( 4 * (size_t)count + 4, sizeof( float ) ) };
    assert_non_null( c.xyzw );
    for ( int i = 0; i < count; ++i )
    {
        wisp_vec3 p = cloud_point( shape, i, count );
        int32_t owner = test_random( i, 3, count / 4 + 1 );
        memcpy( c.xyzw + 4 * (size_t)i, &p, sizeof( p ) );
        memcpy( c.xyzw + 4 * (size_t)i + 3, &owner, sizeof( owner ) );
    }
    return c;
}

static int32_t owner_of( const float* quad )
{
    int32_t owner;
    memcpy( &owner, quad + 3, sizeof( owner ) );
    return owner;
}

// The radius at which every shape has items near each other, also where cells had to be widened.
static float cloud_radius( cloud_shape shape )
{
    return shape == CLOUD_CLUSTERS ? 0.04f : ( shape == CLOUD_LATTICE ? 0.25f : 0.125f );
}

// ---- builds, with an active pool of workers ----

static const int COUNTS[] = { 0, 1, 7, 8, 9, 100, 1000, 5000 };
static const int WORKER_COUNTS[] = { 1, 2, 3, 8 };

static const wisp_kernels* baseline( void )
{
    return kernels_select( "baseline", NULL );
}

/// Builds run inside an entered pool, as in a step.
typedef struct space
{
    test_host host;
    wisp_allocator allocator;
    jobs_pool* pool;
    const wisp_kernels* kernels;
    wisp_grid grid;
    wisp_neighbours found;
    // of the running build
    const cloud* items;
    float cell;
    int fine; // 0 is 1
    const wisp_neighbour_query* query;
    wisp_status status;
} space;

static space* space_open( int workers, const wisp_kernels* kernels )
{
    space* s = checked_calloc( 1, sizeof( space ) );
    s->allocator = test_host_allocator( &s->host );
    s->pool = jobs_create( &s->allocator, workers, NULL, NULL );
    s->kernels = kernels;
    return s;
}

static void space_close( space** local )
{
    space* s = *local;
    wisp_grid_release( &s->grid, &s->allocator );
    wisp_neighbours_release( &s->found, &s->allocator );
    jobs_destroy( s->pool );
    assert_host_memory_is_released( &s->host );
    free( s );
}

static void run_grid_build( void* context )
{
    space* s = context;
    int fine = s->fine > 0 ? s->fine : 1;
    s->status = wisp_grid_build( &s->grid, jobs_everyone( s->pool ), s->items->xyzw, s->items->count, s->cell, fine );
}

static wisp_status build_grid( space* s, const cloud* items, float cell )
{
    s->items = items;
    s->cell = cell;
    jobs_enter( s->pool, run_grid_build, s );
    return s->status;
}

static void run_search( void* context )
{
    space* s = context;
    s->status = wisp_neighbours_build( &s->found, jobs_everyone( s->pool ), s->kernels, &s->grid, s->query );
}

static wisp_status search( space* s, const wisp_neighbour_query* query )
{
    s->query = query;
    jobs_enter( s->pool, run_search, s );
    return s->status;
}

enum
{
    NO_LIMIT = 5000,
    MAX_ONE_POINT = 300, // every item is every other's neighbour
};

static int count_of( cloud_shape shape, int i )
{
    return shape == CLOUD_ONE_POINT && COUNTS[i] > MAX_ONE_POINT ? MAX_ONE_POINT : COUNTS[i];
}

// ---- brute force ----

// Neighbours of one query in slot order, and their number.
typedef struct naive_list
{
    int near_count, skin_count;
    int32_t near[NO_LIMIT], skin[NO_LIMIT];
} naive_list;

// Distances are summed x, y, z in single precision without fused operations, as in the engine, so that an item
// exactly on the border is treated the same.
static void search_naively( const wisp_grid* g, const wisp_neighbour_query* query, int q, naive_list* list )
{
    const float* p = query->xyzw + 4 * (size_t)q;
    const int32_t owner = owner_of( p );
    const float near2 = query->near_radius * query->near_radius, shell2 = query->skin_radius * query->skin_radius;
    list->near_count = list->skin_count = 0;
    for ( int slot = 0; slot < g->count; ++slot )
    {
        float x = g->x[slot] - p[0], y = g->y[slot] - p[1], z = g->z[slot] - p[2];
        float d2 = x * x + y * y;
        d2 = d2 + z * z;
        int32_t number = query->rename != NULL ? query->rename[slot] : slot;
        if ( g->owner[slot] != owner && d2 < near2 )
        {
            list->near[list->near_count++] = number;
        }
        else if ( g->owner[slot] != owner && d2 < shell2 )
        {
            list->skin[list->skin_count++] = number;
        }
    }
}

static int at_most( int count, int limit )
{
    return count < limit ? count : limit;
}

// Wrong entries of one lane: the first `limit` near ones in order, as many of the shell after them, then the query's
// own number to the slice's end.
static int wrong_entries( const wisp_neighbours* found, int q, const naive_list* expected, int limit )
{
    const wisp_neighbour_list* list = &found->all;
    int slice = q / WISP_SLICE, lane = q % WISP_SLICE;
    int near = at_most( expected->near_count, limit ), kept = near + at_most( expected->skin_count, limit );
    const int32_t* entries = list->entries + (size_t)list->begin[slice] * WISP_SLICE + lane;
    int wrong = list->length[slice] < kept ? 1 : 0;
    for ( int k = 0; k < list->length[slice]; ++k )
    {
        int number = k < near ? expected->near[k] : ( k < kept ? expected->skin[k - near] : q );
        wrong += entries[(size_t)k * WISP_SLICE] != 4 * number ? 1 : 0;
    }
    wrong += found->near_count[q] != near ? 1 : 0;
    wrong += found->near.begin[slice] != list->begin[slice] || found->near.entries != list->entries ? 1 : 0;
    wrong += found->near.length[slice] < near ? 1 : 0;
    return wrong;
}

// No list is longer than the longest lane of its slice.
static bool is_too_long( const wisp_neighbours* found, int slice )
{
    int near = 0;
    for ( int l = 0; l < WISP_SLICE; ++l )
    {
        near = found->near_count[slice * WISP_SLICE + l] > near ? found->near_count[slice * WISP_SLICE + l] : near;
    }
    const wisp_neighbour_list* list = &found->all;
    bool used = list->length[slice] == 0;
    for ( int l = 0; l < WISP_SLICE && used == false; ++l )
    {
        const size_t last = (size_t)list->begin[slice] + (size_t)list->length[slice] - 1;
        used = list->entries[last * WISP_SLICE + (size_t)l] != 4 * ( slice * WISP_SLICE + l );
    }
    return used == false || found->near.length[slice] != near;
}

static size_t entries_of_all( const wisp_neighbour_list* list, int slices )
{
    size_t sum = 0;
    for ( int s = 0; s < slices; ++s )
    {
        sum += (size_t)list->length[s];
    }
    return sum;
}

// @return number of neighbours, near and in the shell, by brute force
static int64_t assert_found_by_brute_force( const space* s, const wisp_neighbour_query* query )
{
    naive_list* list = checked_malloc( sizeof( naive_list ) );
    int wrong = 0;
    int64_t pairs = 0;
    uint64_t capped = 0;
    for ( int q = 0; q < query->query_count; ++q )
    {
        search_naively( &s->grid, query, q, list );
        wrong += wrong_entries( &s->found, q, list, query->limit );
        capped += list->near_count > query->limit || list->skin_count > query->limit ? 1 : 0;
        pairs += list->near_count + list->skin_count;
    }
    free( list );
    for ( int slice = 0; slice < s->found.slice_count && query->rename == NULL; ++slice )
    {
        wrong += is_too_long( &s->found, slice ) ? 1 : 0;
    }
    assert_int_equal( wrong, 0 );
    assert_int_equal( s->found.capped, capped );
    assert_int_equal( s->found.slice_count, ( query->query_count + 7 ) / 8 );
    assert_int_equal( s->found.entries, entries_of_all( &s->found.all, s->found.slice_count ) );
    return pairs;
}

// The grid's own items as queries, in slot order.
static float* quads_by_slot( const wisp_grid* g, const cloud* c )
{
    float* xyzw = checked_calloc( 4 * (size_t)g->count + 4, sizeof( float ) );
    for ( int slot = 0; slot < g->count; ++slot )
    {
        memcpy( xyzw + 4 * (size_t)slot, c->xyzw + 4 * (size_t)g->item[slot], 4 * sizeof( float ) );
    }
    return xyzw;
}

// Query the neighbours of every item. @return number found
static int64_t check_cloud( space* s, const cloud* c, float radius, float skin, int limit )
{
    assert_int_equal( build_grid( s, c, skin > radius ? skin : radius ), WISP_OK );
    SCOPED( free_local ) float* xyzw = quads_by_slot( &s->grid, c );
    wisp_neighbour_query query = {
        .xyzw = xyzw,
        .query_count = c->count,
        .near_radius = radius,
        .skin_radius = skin,
        .limit = limit,
    };
    assert_int_equal( search( s, &query ), WISP_OK );
    return assert_found_by_brute_force( s, &query );
}

static void check_every_cloud( space* s, int first_count, int last_count )
{
    for ( int shape = 0; shape < CLOUD_SHAPE_COUNT; ++shape )
    {
        float radius = cloud_radius( (cloud_shape)shape );
        for ( int i = first_count; i <= last_count; ++i )
        {
            cloud c = make_cloud( (cloud_shape)shape, count_of( (cloud_shape)shape, i ) );
            s->fine = 1 + i % 4;
            int64_t alone = check_cloud( s, &c, radius, 0.0f, NO_LIMIT );
            s->fine = 4 - i % 4;
            int64_t with_shell = check_cloud( s, &c, radius, 1.25f * radius, NO_LIMIT );
            // a check without neighbours would show nothing; on the lattice everything but the shell is empty
            assert_true( c.count < 1000 || shape == CLOUD_LATTICE || alone > 0 );
            assert_true( c.count < 1000 || with_shell > alone || shape == CLOUD_ONE_POINT );
            free( c.xyzw );
        }
    }
}

// ---- neighbours ----

TEST( baseline_finds_what_brute_force_finds )
{
    SCOPED( space_close ) space* s = space_open( 1, baseline() );
    check_every_cloud( s, 0, WISP_COUNT( COUNTS ) - 1 );
}

TEST( every_instruction_set_finds_what_brute_force_finds )
{
    static const char* const ISAS[] = { "avx2", "avx512" };
    for ( int i = 0; i < WISP_COUNT( ISAS ); ++i )
    {
        const wisp_kernels* kernels = kernels_select( ISAS[i], NULL );
        if ( strcmp( kernels->isa, ISAS[i] ) == 0 )
        {
            SCOPED( space_close ) space* s = space_open( 1, kernels );
            check_every_cloud( s, 0, WISP_COUNT( COUNTS ) - 1 );
        }
    }
}

TEST( any_number_of_workers_finds_what_brute_force_finds )
{
    for ( int w = 1; w < WISP_COUNT( WORKER_COUNTS ); ++w )
    {
        SCOPED( space_close ) space* s = space_open( WORKER_COUNTS[w], kernels_select( NULL, NULL ) );
        check_every_cloud( s, 5, 6 );
    }
}

TEST( an_item_at_exactly_the_radius_is_outside_and_one_just_nearer_is_inside )
{
    // 3, 4, 5: all numbers here, and their squares, are exact in single precision
    float xyzw[] = { 0.0f, 0.0f, 0.0f, 0.0f, 0.75f, 1.0f, 0.0f, 0.0f, -0.75f, 0.0f, 0.99f, 0.0f };
    for ( int32_t i = 0; i < 3; ++i )
    {
        memcpy( xyzw + 4 * i + 3, &i, sizeof( i ) );
    }
    cloud c = { 3, xyzw };
    SCOPED( space_close ) space* s = space_open( 1, baseline() );
    assert_int_equal( check_cloud( s, &c, 1.25f, 0.0f, NO_LIMIT ), 2 );
    assert_int_equal( check_cloud( s, &c, 1.25f, 1.5f, NO_LIMIT ), 4 );
    assert_int_equal( s->found.near.length[0], 1 );
    assert_int_equal( s->found.all.length[0], 2 );
}

enum
{
    BORDER_ITEMS = 4002, // two at the ends, the others in pairs
};

// Pairs across the cells of a long line: one item within a few roundings of a cell's border, the other as far off as
// the radius allows. Rounding puts some of them into the wrong cell.
static void place_on_borders( cloud* c, const wisp_grid* g, float radius )
{
    for ( int i = 2; i < c->count; i += 2 )
    {
        double border =
            (double)g->origin[0] + (double)g->cell / g->subdivisions * test_random( i, 0, g->dims[0] - 2 );
        float x = (float)border;
        for ( int k = test_random( i, 1, 7 ); k > 0; --k )
        {
            x = nextafterf( x, i % 4 == 0 ? -INFINITY : INFINITY );
        }
        float other = x + radius;
        while ( ( other - x ) * ( other - x ) >= radius * radius )
        {
            other = nextafterf( other, -INFINITY );
        }
        c->xyzw[4 * i] = x;
        c->xyzw[4 * i + 4] = other;
    }
}

TEST( items_on_the_borders_of_cells_find_each_other )
{
    // found by search: with these numbers thousands of pairs are missed if cells are exactly as wide as the radius
    const float radius = 0.201205894f, first = -641.421692f, last = 140.0f;
    cloud c = make_cloud( CLOUD_ONE_POINT, BORDER_ITEMS );
    for ( int32_t i = 0; i < c.count; ++i )
    {
        c.xyzw[4 * i] = i % 2 == 0 ? first : last;
        memcpy( c.xyzw + 4 * i + 3, &i, sizeof( i ) );
    }
    SCOPED( space_close ) space* s = space_open( 1, baseline() );
    // the ends determine the cells, so that they stay the same when the others move
    for ( s->fine = 1; s->fine <= 4; ++s->fine )
    {
        assert_int_equal( build_grid( s, &c, radius ), WISP_OK );
        place_on_borders( &c, &s->grid, radius );
        assert_true( check_cloud( s, &c, radius, 0.0f, NO_LIMIT ) >= BORDER_ITEMS - 2 );
    }
    free( c.xyzw );
}

TEST( items_of_the_querys_owner_are_left_out )
{
    cloud c = make_cloud( CLOUD_ONE_POINT, 100 );
    for ( int32_t i = 0, owner = 5; i < c.count; ++i )
    {
        memcpy( c.xyzw + 4 * i + 3, &owner, sizeof( owner ) );
    }
    SCOPED( space_close ) space* s = space_open( 1, baseline() );
    assert_int_equal( check_cloud( s, &c, 1.0f, 2.0f, NO_LIMIT ), 0 );
    assert_int_equal( s->found.entries, 0 );
    free( c.xyzw );
}

TEST( a_limit_keeps_the_first_in_order_and_counts_the_queries_that_meet_it )
{
    static const int LIMITS[] = { 1, 2, 7, 8, 9, 20 };
    cloud c = make_cloud( CLOUD_BALL, 1000 );
    for ( int i = 0; i < WISP_COUNT( LIMITS ); ++i )
    {
        SCOPED( space_close ) space* s = space_open( 2, kernels_select( NULL, NULL ) );
        check_cloud( s, &c, 0.35f, 0.0f, LIMITS[i] );
        assert_true( s->found.capped > 0 );
        check_cloud( s, &c, 0.25f, 0.35f, LIMITS[i] );
        assert_true( s->found.capped > 0 );
    }
    free( c.xyzw );
}

TEST( a_list_that_just_fits_its_limit_is_not_counted )
{
    cloud c = make_cloud( CLOUD_ONE_POINT, 17 );
    for ( int32_t i = 0; i < c.count; ++i )
    {
        memcpy( c.xyzw + 4 * i + 3, &i, sizeof( i ) );
    }
    SCOPED( space_close ) space* s = space_open( 1, baseline() );
    check_cloud( s, &c, 1.0f, 0.0f, 16 );
    assert_int_equal( s->found.capped, 0 );
    check_cloud( s, &c, 1.0f, 0.0f, 15 );
    assert_int_equal( s->found.capped, 17 );
    free( c.xyzw );
}

TEST( slots_are_reported_under_their_new_names )
{
    cloud c = make_cloud( CLOUD_BALL, 1000 );
    SCOPED( space_close ) space* s = space_open( 2, kernels_select( NULL, NULL ) );
    assert_int_equal( build_grid( s, &c, 0.2f ), WISP_OK );
    wisp_neighbour_query query = {
        .xyzw = c.xyzw, // in the items' order
        .query_count = c.count,
        .near_radius = 0.2f,
        .skin_radius = 0.24f,
        .limit = NO_LIMIT,
        .rename = s->grid.item,
    };
    assert_int_equal( search( s, &query ), WISP_OK );
    assert_true( assert_found_by_brute_force( s, &query ) > 1000 );
    free( c.xyzw );
}

TEST( a_radius_wider_or_narrower_than_the_cells_finds_the_same )
{
    cloud c = make_cloud( CLOUD_BALL, 500 );
    SCOPED( space_close ) space* s = space_open( 2, kernels_select( NULL, NULL ) );
    static const float CELLS[] = { 0.01f, 0.06f, 0.3f, 0.9f, 50.0f };
    for ( int i = 0; i < WISP_COUNT( CELLS ); ++i )
    {
        s->fine = 1 + i % 3;
        assert_int_equal( build_grid( s, &c, CELLS[i] ), WISP_OK );
        wisp_neighbour_query query = { c.xyzw, c.count, 0.3f, 0.4f, NO_LIMIT, s->grid.item };
        assert_int_equal( search( s, &query ), WISP_OK );
        assert_true( assert_found_by_brute_force( s, &query ) > 500 );
    }
    free( c.xyzw );
}

// Queries that are no items of the grid: inside, outside, far away, on the other side of the origin.
static void assert_strangers_find_their_neighbours( cloud_shape shape )
{
    cloud c = make_cloud( shape, 1000 ), strangers = make_cloud( CLOUD_BALL, 203 );
    for ( int32_t i = 0, owner = -1; i < strangers.count; ++i )
    {
        float scale = i % 10 == 0 ? 1e6f : ( i % 3 == 0 ? 1.2f : 0.9f );
        strangers.xyzw[4 * i] *= scale;
        strangers.xyzw[4 * i + 1] *= scale;
        strangers.xyzw[4 * i + 2] *= scale;
        memcpy( strangers.xyzw + 4 * i + 3, &owner, sizeof( owner ) );
    }
    space* s = space_open( 2, kernels_select( NULL, NULL ) );
    assert_int_equal( build_grid( s, &c, 0.2f ), WISP_OK );
    wisp_neighbour_query query = { strangers.xyzw, strangers.count, 0.2f, 0.25f, NO_LIMIT, NULL };
    assert_int_equal( search( s, &query ), WISP_OK );
    int64_t found = assert_found_by_brute_force( s, &query );
    free( c.xyzw );
    free( strangers.xyzw );
    space_close( &s );
    assert_true( found > 0 );
}

TEST( queries_that_are_no_items_find_their_neighbours )
{
    assert_strangers_find_their_neighbours( CLOUD_BALL );
}

TEST( queries_beside_a_flat_cloud_find_their_neighbours )
{
    assert_strangers_find_their_neighbours( CLOUD_SHEET );
}

TEST( no_query_and_no_item_find_nothing )
{
    cloud none = make_cloud( CLOUD_BALL, 0 ), some = make_cloud( CLOUD_BALL, 20 );
    SCOPED( space_close ) space* s = space_open( 2, baseline() );
    assert_int_equal( build_grid( s, &none, 0.1f ), WISP_OK );
    wisp_neighbour_query query = { some.xyzw, some.count, 1.0f, 2.0f, NO_LIMIT, NULL };
    assert_int_equal( search( s, &query ), WISP_OK );
    assert_int_equal( assert_found_by_brute_force( s, &query ), 0 );

    assert_int_equal( build_grid( s, &some, 0.1f ), WISP_OK );
    query.query_count = 0;
    assert_int_equal( search( s, &query ), WISP_OK );
    assert_int_equal( s->found.slice_count, 0 );
    assert_int_equal( s->found.entries, 0 );
    free( none.xyzw );
    free( some.xyzw );
}

// ---- memory ----

// A large cloud after a small one, so that warm buffers must grow too. @return the first status that is not OK
static wisp_status build_two( space* s, const cloud* small, const cloud* large )
{
    const cloud* clouds[] = { small, large };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < 2 && status == WISP_OK; ++i )
    {
        status = build_grid( s, clouds[i], 0.25f );
        wisp_neighbour_query query = { clouds[i]->xyzw, clouds[i]->count, 0.2f, 0.25f, NO_LIMIT, s->grid.item };
        status = status == WISP_OK ? search( s, &query ) : status;
    }
    return status;
}

TEST( a_build_without_memory_says_so_and_the_next_one_works )
{
    cloud small = make_cloud( CLOUD_BALL, 30 ), large = make_cloud( CLOUD_BALL, 2000 );
    int failures = 0;
    bool refused = true;
    for ( int n = 1; refused; ++n )
    {
        SCOPED( space_close ) space* s = space_open( 2, baseline() );
        test_host_refuse( &s->host, n, false );
        wisp_status status = build_two( s, &small, &large );
        refused = test_host_has_refused( &s->host );
        test_host_refuse( &s->host, 0, false );
        assert_true( status == WISP_OK || ( refused && status == WISP_NO_MEMORY ) );
        failures += status == WISP_NO_MEMORY ? 1 : 0;
        assert_true( check_cloud( s, &large, 0.2f, 0.25f, NO_LIMIT ) > 0 );
    }
    assert_true( failures >= 7 ); // four buffers of the grid and three of the lists, and their growth
    free( small.xyzw );
    free( large.xyzw );
}

// ---- the grid ----

static int cell_of( const wisp_grid* g, const float* quad )
{
    int cell[3];
    for ( int axis = 0; axis < 3; ++axis )
    {
        int c = (int)( ( quad[axis] - g->origin[axis] ) * g->inverse_cell[axis] );
        cell[axis] = c < 0 ? 0 : ( c >= g->dims[axis] ? g->dims[axis] - 1 : c );
    }
    const int *a = g->axis, *d = g->dims;
    return ( cell[a[2]] * d[a[1]] + cell[a[1]] ) * d[a[0]] + cell[a[0]];
}

typedef struct keyed_item
{
    int cell, item;
} keyed_item;

static int by_cell_then_item( const void* a, const void* b )
{
    const keyed_item *l = a, *r = b;
    return l->cell != r->cell ? ( l->cell < r->cell ? -1 : 1 ) : ( l->item > r->item ) - ( l->item < r->item );
}

static void assert_sorted_naively( const wisp_grid* g, const cloud* c )
{
    keyed_item* keys = checked_calloc( (size_t)c->count + 1, sizeof( keyed_item ) );
    for ( int i = 0; i < c->count; ++i )
    {
        keys[i] = ( keyed_item ){ cell_of( g, c->xyzw + 4 * (size_t)i ), i };
    }
    qsort( keys, (size_t)c->count, sizeof( *keys ), by_cell_then_item );
    int cells = g->dims[0] * g->dims[1] * g->dims[2], wrong = g->count != c->count ? 1 : 0;
    for ( int slot = 0; slot < c->count; ++slot )
    {
        const keyed_item key = keys[slot];
        const float* q = c->xyzw + 4 * (size_t)key.item;
        wrong += g->item[slot] != key.item || g->owner[slot] != owner_of( q ) ? 1 : 0;
        wrong += g->x[slot] != q[0] || g->y[slot] != q[1] || g->z[slot] != q[2] ? 1 : 0;
        wrong += slot < g->cell_begin[key.cell] || slot >= g->cell_begin[key.cell + 1] ? 1 : 0;
    }
    for ( int cell = 0; cell < cells; ++cell )
    {
        wrong += g->cell_begin[cell] > g->cell_begin[cell + 1] ? 1 : 0;
    }
    free( keys );
    assert_int_equal( wrong, 0 );
    assert_int_equal( g->cell_begin[0], 0 );
    assert_int_equal( g->cell_begin[cells], c->count );
}

TEST( slots_are_the_items_sorted_by_cell_and_number )
{
    for ( int w = 0; w < WISP_COUNT( WORKER_COUNTS ); ++w )
    {
        SCOPED( space_close ) space* s = space_open( WORKER_COUNTS[w], baseline() );
        for ( int shape = 0; shape < CLOUD_SHAPE_COUNT; ++shape )
        {
            for ( int i = 0; i < WISP_COUNT( COUNTS ); ++i )
            {
                cloud c = make_cloud( (cloud_shape)shape, COUNTS[i] );
                assert_int_equal( build_grid( s, &c, cloud_radius( (cloud_shape)shape ) ), WISP_OK );
                assert_sorted_naively( &s->grid, &c );
                free( c.xyzw );
            }
        }
    }
}

TEST( many_blocks_of_items_are_sorted_alike )
{
    cloud c = make_cloud( CLOUD_BALL, 30000 );
    for ( int w = 0; w < WISP_COUNT( WORKER_COUNTS ); ++w )
    {
        SCOPED( space_close ) space* s = space_open( WORKER_COUNTS[w], baseline() );
        s->fine = 1 + w % 4;
        assert_int_equal( build_grid( s, &c, 0.05f ), WISP_OK );
        assert_sorted_naively( &s->grid, &c );
    }
    free( c.xyzw );
}

// Distance of an item from its cell, m; rounding may put it there.
static double outside_cell( const wisp_grid* g, const float* quad )
{
    int rest = cell_of( g, quad );
    double most = 0.0;
    for ( int i = 0; i < 3; ++i )
    {
        int axis = g->axis[i], place = rest % g->dims[axis];
        rest /= g->dims[axis];
        double edge = (double)g->cell / ( i == 0 ? g->subdivisions : 1 );
        double lower = (double)g->origin[axis] + place * edge, upper = lower + edge;
        most = fmax( most, fmax( lower - (double)quad[axis], (double)quad[axis] - upper ) );
    }
    return most;
}

TEST( an_item_lies_in_its_cell_or_no_further_off_than_the_slack )
{
    SCOPED( space_close ) space* s = space_open( 2, baseline() );
    for ( int shape = 0; shape < CLOUD_SHAPE_COUNT; ++shape )
    {
        cloud c = make_cloud( (cloud_shape)shape, 5000 );
        s->fine = 1 + shape % 4;
        assert_int_equal( build_grid( s, &c, cloud_radius( (cloud_shape)shape ) ), WISP_OK );
        double most = 0.0;
        for ( int i = 0; i < c.count; ++i )
        {
            most = fmax( most, outside_cell( &s->grid, c.xyzw + 4 * (size_t)i ) );
        }
        assert_true( most <= (double)s->grid.rounding_margin );
        free( c.xyzw );
    }
}

TEST( cells_are_as_wide_as_requested_unless_there_would_be_too_many )
{
    SCOPED( space_close ) space* s = space_open( 1, baseline() );
    for ( int shape = 0; shape < CLOUD_SHAPE_COUNT; ++shape )
    {
        cloud c = make_cloud( (cloud_shape)shape, 5000 );
        float requested = cloud_radius( (cloud_shape)shape );
        assert_int_equal( build_grid( s, &c, requested ), WISP_OK );
        const wisp_grid* g = &s->grid;
        assert_true( g->cell >= requested );
        // four cells per item, and a few that a handful of items may have
        assert_true( (double)g->dims[0] * g->dims[1] * g->dims[2] <= 4.0 * c.count + 64.0 );
        bool sparse = shape == CLOUD_SPREAD || shape == CLOUD_CLUSTERS || shape == CLOUD_LINE;
        assert_int_equal( g->is_widened, sparse );
        free( c.xyzw );
    }
}

// Axes with more than one cell come first, the fewest cells fastest.
static int cells_of_rank( const wisp_grid* g, int i )
{
    int cells = g->dims[g->axis[i]];
    return cells > 1 ? cells : INT32_MAX;
}

TEST( the_axis_with_the_fewest_cells_is_the_fastest )
{
    SCOPED( space_close ) space* s = space_open( 1, baseline() );
    for ( int shape = 0; shape < CLOUD_SHAPE_COUNT; ++shape )
    {
        cloud c = make_cloud( (cloud_shape)shape, 1000 );
        assert_int_equal( build_grid( s, &c, cloud_radius( (cloud_shape)shape ) ), WISP_OK );
        const wisp_grid* g = &s->grid;
        assert_int_equal( 1 << g->axis[0] | 1 << g->axis[1] | 1 << g->axis[2], 7 );
        assert_true( cells_of_rank( g, 0 ) <= cells_of_rank( g, 1 ) &&
                     cells_of_rank( g, 1 ) <= cells_of_rank( g, 2 ) );
        free( c.xyzw );
    }
}

TEST( cells_along_the_fastest_axis_are_cut_unless_there_would_be_too_many )
{
    SCOPED( space_close ) space* s = space_open( 1, baseline() );
    for ( int shape = 0; shape < CLOUD_SHAPE_COUNT; ++shape )
    {
        cloud c = make_cloud( (cloud_shape)shape, 5000 );
        s->fine = 1;
        assert_int_equal( build_grid( s, &c, cloud_radius( (cloud_shape)shape ) ), WISP_OK );
        const wisp_grid cubes = s->grid;
        s->fine = 4;
        assert_int_equal( build_grid( s, &c, cloud_radius( (cloud_shape)shape ) ), WISP_OK );
        const wisp_grid* g = &s->grid;
        assert_memory_equal( g->axis, cubes.axis, sizeof( cubes.axis ) );
        assert_int_equal( g->dims[g->axis[1]], cubes.dims[g->axis[1]] );
        assert_int_equal( g->dims[g->axis[2]], cubes.dims[g->axis[2]] );
        int cut = g->dims[g->axis[0]], whole = cubes.dims[g->axis[0]];
        double rows = (double)g->dims[g->axis[1]] * g->dims[g->axis[2]], most = 4.0 * c.count + 64.0;
        assert_in_range( g->subdivisions, 1, 4 );
        assert_in_range( cut, g->subdivisions * ( whole - 1 ) + 1, g->subdivisions * whole );
        assert_true( rows * cut <= most );
        // a cut less than requested has a reason
        assert_true( g->subdivisions == 4 || rows * ( g->subdivisions + 1 ) * whole > most );
        free( c.xyzw );
    }
}

TEST( slots_behind_the_last_may_be_read )
{
    SCOPED( space_close ) space* s = space_open( 1, baseline() );
    cloud c = make_cloud( CLOUD_BALL, 33 );
    assert_int_equal( build_grid( s, &c, 0.1f ), WISP_OK );
    float sum = 0.0f;
    for ( int slot = 33; slot < 33 + 16; ++slot )
    {
        sum += s->grid.x[slot] + s->grid.y[slot] + s->grid.z[slot];
        sum += (float)( s->grid.item[slot] + s->grid.owner[slot] );
    }
    assert_true( sum == 0.0f ); // and they are never left to chance
    free( c.xyzw );
}
