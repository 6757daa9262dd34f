// Intersections of whole shapes: results equal brute force in integers, for every search and number of workers.
// Points lie on a lattice of 2^-10, so that all of it is exact.
#include "intersections_fixture.h"

#include "jobs.h"

enum
{
    LATTICE_POWER = -10,
    LATTICE = 1 << -LATTICE_POWER, // steps per metre
};

// ---- contact meshes ----

typedef struct contact_mesh
{
    int point_count, edge_count, triangle_count;
    whole_point* points;
    float* xyzw;
    int32_t *edges, *triangles;
} contact_mesh;

static contact_mesh contact_mesh_reserve( int points, int triangles )
{
    contact_mesh s = { .points = calloc( (size_t)points + 1, sizeof( whole_point ) ),
                       .edges = calloc( 6 * (size_t)triangles + 2, sizeof( int32_t ) ),
                       .triangles = calloc( 3 * (size_t)triangles + 3, sizeof( int32_t ) ) };
    assert_true( s.points != NULL && s.edges != NULL && s.triangles != NULL );
    return s;
}

static void contact_mesh_free( contact_mesh* s )
{
    free( s->points );
    free( s->xyzw );
    free( s->edges );
    free( s->triangles );
}

static int32_t add_point( contact_mesh* s, double x, double y, double z )
{
    const double at[3] = { x, y, z };
    for ( int axis = 0; axis < 3; ++axis )
    {
        s->points[s->point_count].at[axis] = (int32_t)lround( at[axis] * LATTICE );
    }
    return s->point_count++;
}

static void add_triangle( contact_mesh* s, int32_t a, int32_t b, int32_t c )
{
    const int32_t corners[3] = { a, b, c };
    memcpy( s->triangles + 3 * (size_t)s->triangle_count++, corners, sizeof( corners ) );
}

static void add_edge( contact_mesh* s, int32_t a, int32_t b )
{
    s->edges[2 * (size_t)s->edge_count] = a;
    s->edges[2 * (size_t)s->edge_count++ + 1] = b;
}

// Squares of a grid of points that has `rows` rows of `columns` from `first` on; closed grids return to their start.
static void add_grid( contact_mesh* s, int32_t first, int columns, int rows, bool closed )
{
    for ( int r = 0; r < ( closed ? rows : rows - 1 ); ++r )
    {
        for ( int c = 0; c < ( closed ? columns : columns - 1 ); ++c )
        {
            const int right = ( c + 1 ) % columns, below = ( r + 1 ) % rows;
            const int32_t p = first + r * columns + c, q = first + r * columns + right,
                          t = first + below * columns + c, u = first + below * columns + right;
            add_triangle( s, p, q, u );
            add_triangle( s, p, u, t );
            add_edge( s, p, q );
            add_edge( s, p, t );
            add_edge( s, p, u );
        }
    }
}

static void add_torus( contact_mesh* s, double middle_x, bool upright, double ring, double tube )
{
    enum
    {
        AROUND = 40,
        ACROSS = 16,
    };
    const int32_t first = s->point_count;
    for ( int i = 0; i < AROUND * ACROSS; ++i )
    {
        // turned a little, so that two of them do not mirror each other
        const double u = 6.283185307179586 * ( i / ACROSS + 0.3 ) / AROUND,
                     v = 6.283185307179586 * ( i % ACROSS + ( upright ? 0.2 : 0.4 ) ) / ACROSS;
        const double r = ring + tube * cos( v ), h = tube * sin( v );
        add_point( s, middle_x + r * cos( u ), upright ? h : r * sin( u ), upright ? r * sin( u ) : h );
    }
    add_grid( s, first, ACROSS, AROUND, true );
}

static void add_ball( contact_mesh* s, double radius )
{
    enum
    {
        COLUMNS = 24,
        ROWS = 14,
    };
    const int32_t first = s->point_count;
    for ( int i = 0; i < COLUMNS * ROWS; ++i )
    {
        const double u = 6.283185307179586 * ( i % COLUMNS ) / COLUMNS,
                     v = 0.15 + 2.84 * ( i / COLUMNS ) / ( ROWS - 1 );
        add_point( s, radius * sin( v ) * cos( u ), radius * sin( v ) * sin( u ), radius * cos( v ) );
    }
    add_grid( s, first, COLUMNS, ROWS, false );
}

// A sheet rolled into a curl that goes through itself.
static void add_curl( contact_mesh* s )
{
    enum
    {
        WIDE = 14,
        LONG = 60,
    };
    const int32_t first = s->point_count;
    for ( int i = 0; i < WIDE * LONG; ++i )
    {
        const double t = 2.0 * ( i / WIDE ) / ( LONG - 1 ) - 1.0, w = ( i % WIDE ) / ( WIDE - 1.0 ) + 0.03 * t;
        add_point( s, 1.5 * ( t * t * t - 0.4 * t ), t * t, w );
    }
    add_grid( s, first, WIDE, LONG, false );
}

static void add_heap( contact_mesh* s, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        int32_t corner[5];
        for ( int k = 0; k < 5; ++k )
        {
            corner[k] = s->point_count;
            const whole_point middle = whole_random( i, 9, 2 * LATTICE ),
                              off = whole_random( 5 * i + k, 8, LATTICE / 4 );
            for ( int axis = 0; axis < 3; ++axis )
            {
                s->points[s->point_count].at[axis] = middle.at[axis] + off.at[axis];
            }
            ++s->point_count;
        }
        add_triangle( s, corner[0], corner[1], corner[2] );
        add_edge( s, corner[3], corner[4] );
    }
}

// Needles through a plate of two triangles, away from its diagonal.
static void add_needles( contact_mesh* s, int count )
{
    const int32_t a = add_point( s, 0, 0, 0 ), b = add_point( s, 1, 0, 0 ), c = add_point( s, 1, 1, 0 ),
                  d = add_point( s, 0, 1, 0 );
    add_triangle( s, a, b, c );
    add_triangle( s, a, c, d );
    for ( int i = 0; i < count; ++i )
    {
        const double x = ( i + 1 ) / ( count + 2.0 ), y = i % 2 == 0 ? 0.5 * x : 0.5 + 0.5 * x;
        add_edge( s, add_point( s, x, y, -0.1 ), add_point( s, x, y, 0.2 ) );
    }
}

typedef enum shape
{
    LINKED,  // two tori like links of a chain, apart
    PIERCED, // the same, so thick that they pass through each other
    CURL,
    NESTED, // balls in balls
    HEAP,   // triangles and edges at random
    NEEDLES,
    SHAPES,
} shape;

enum
{
    NEEDLE_COUNT = 300,
};

static contact_mesh contact_mesh_make( shape what )
{
    contact_mesh s = contact_mesh_reserve( 6000, 6000 );
    switch ( what )
    {
        case LINKED:
        case PIERCED:
            add_torus( &s, 0.0, false, 1.0, what == LINKED ? 0.2 : 0.55 );
            add_torus( &s, 1.0, true, 1.0, what == LINKED ? 0.2 : 0.55 );
            break;
        case CURL:
            add_curl( &s );
            break;
        case NESTED:
            add_ball( &s, 1.0 );
            add_ball( &s, 1.1 );
            add_ball( &s, 1.25 );
            break;
        case HEAP:
            add_heap( &s, 1000 );
            break;
        default:
            add_needles( &s, NEEDLE_COUNT );
            break;
    }
    s.xyzw = checked_calloc( 4 * (size_t)s.point_count, sizeof( float ) );
    for ( int i = 0; i < s.point_count; ++i )
    {
        float* quad = s.xyzw + 4 * (size_t)i;
        for ( int axis = 0; axis < 3; ++axis )
        {
            quad[axis] = ldexpf( (float)s.points[i].at[axis], LATTICE_POWER );
        }
        quad[3] = NAN; // not read
    }
    return s;
}

static bool contact_mesh_shares( const contact_mesh* s, int edge, int triangle )
{
    const int32_t *e = s->edges + 2 * (size_t)edge, *t = s->triangles + 3 * (size_t)triangle;
    return t[0] == e[0] || t[0] == e[1] || t[1] == e[0] || t[1] == e[1] || t[2] == e[0] || t[2] == e[1];
}

// Every edge and every triangle. @return [*count]
static wisp_intersection* contact_mesh_brute( const contact_mesh* s, int* count )
{
    wisp_intersection* list =
        checked_calloc( (size_t)s->edge_count * (size_t)s->triangle_count + 1, sizeof( *list ) );
    *count = 0;
    for ( int e = 0; e < s->edge_count; ++e )
    {
        for ( int t = 0; t < s->triangle_count; ++t )
        {
            const int32_t *edge = s->edges + 2 * (size_t)e, *corner = s->triangles + 3 * (size_t)t;
            if ( !contact_mesh_shares( s, e, t ) &&
                 whole_meet( s->points[edge[0]], s->points[edge[1]], s->points[corner[0]], s->points[corner[1]],
                             s->points[corner[2]] ) == WHOLE_CROSS )
            {
                list[( *count )++] = ( wisp_intersection ){ e, t };
            }
        }
    }
    return list;
}

// ---- searches, with an active pool of workers ----

typedef struct searcher
{
    test_host host;
    wisp_allocator allocator;
    jobs_pool* pool;
    wisp_intersections found;
    wisp_error error;
    // of the running search
    wisp_intersection_args args;
    wisp_status status;
} searcher;

static searcher* searcher_open( int workers )
{
    searcher* s = checked_calloc( 1, sizeof( searcher ) );
    s->allocator = test_host_allocator( &s->host );
    s->pool = jobs_create( &s->allocator, workers, NULL, NULL );
    assert_non_null( s->pool );
    return s;
}

static void searcher_close( searcher** local )
{
    searcher* s = *local;
    wisp_intersections_release( &s->found, &s->allocator );
    assert_null( s->found.list );
    jobs_destroy( s->pool );
    assert_host_memory_is_released( &s->host );
    free( s );
}

static void run_search( void* context )
{
    searcher* s = context;
    s->status = wisp_intersections_find( &s->found, jobs_everyone( s->pool ), &s->args, &s->error );
}

static wisp_status search( searcher* s, const contact_mesh* items )
{
    s->args = ( wisp_intersection_args ){ items->xyzw,      items->edges,          items->edge_count,
                                          items->triangles, items->triangle_count, NULL };
    s->error = ( wisp_error ){ 0 };
    jobs_enter( s->pool, run_search, s );
    return s->status;
}

static void assert_list( const searcher* s, const wisp_intersection* expected, int count )
{
    assert_int_equal( s->found.count, count );
    for ( int i = 0; i < count; ++i )
    {
        assert_int_equal( s->found.list[i].edge, expected[i].edge );
        assert_int_equal( s->found.list[i].triangle, expected[i].triangle );
    }
}

static void assert_found( const searcher* s, const wisp_intersection* expected, int count )
{
    assert_int_equal( s->status, WISP_OK );
    assert_list( s, expected, count );
}

// ---- what is found ----

TEST( the_search_finds_what_brute_force_finds_whoever_works )
{
    searcher* searchers[9] = { NULL };
    for ( int workers = 1; workers <= 8; ++workers )
    {
        searchers[workers] = searcher_open( workers );
    }
    for ( int what = 0; what < SHAPES; ++what )
    {
        SCOPED( contact_mesh_free ) contact_mesh s = contact_mesh_make( (shape)what );
        int count;
        SCOPED( free_local ) wisp_intersection* expected = contact_mesh_brute( &s, &count );
        for ( int workers = 1; workers <= 8; ++workers )
        {
            search( searchers[workers], &s );
            assert_found( searchers[workers], expected, count );
        }
    }
    for ( int workers = 1; workers <= 8; ++workers )
    {
        searcher_close( searchers + workers );
    }
}

static int count_of( shape what )
{
    SCOPED( contact_mesh_free ) contact_mesh s = contact_mesh_make( what );
    SCOPED( searcher_close ) searcher* r = searcher_open( 2 );
    assert_int_equal( search( r, &s ), WISP_OK );
    const int count = r->found.count;
    return count;
}

TEST( links_of_a_chain_and_balls_in_balls_do_not_cross )
{
    assert_int_equal( count_of( LINKED ), 0 );
    assert_int_equal( count_of( NESTED ), 0 );
}

TEST( each_needle_through_a_plate_crosses_once )
{
    assert_int_equal( count_of( NEEDLES ), NEEDLE_COUNT );
}

TEST( thick_tori_and_a_sheet_through_itself_cross )
{
    assert_true( count_of( PIERCED ) > 100 );
    assert_true( count_of( CURL ) > 20 );
}

// A closed curve leaves a closed surface as often as it enters it: the ring of a torus' edges crosses the other torus
// an even number of times. Only edges that close a ring across the tube are considered: every third edge, sixteen per
// ring.
TEST( a_closed_ring_crosses_a_closed_surface_an_even_number_of_times )
{
    SCOPED( contact_mesh_free ) contact_mesh s = contact_mesh_make( PIERCED );
    SCOPED( searcher_close ) searcher* r = searcher_open( 2 );
    assert_int_equal( search( r, &s ), WISP_OK );
    SCOPED( free_local ) int* of_ring = checked_calloc( (size_t)s.edge_count, sizeof( int ) );
    for ( int i = 0; i < r->found.count; ++i )
    {
        const int edge = r->found.list[i].edge;
        of_ring[edge / 3 / 16] += edge % 3 == 0 ? 1 : 0;
    }
    int crossed = 0;
    for ( int ring = 0; ring < s.edge_count / 3 / 16; ++ring )
    {
        assert_int_equal( of_ring[ring] % 2, 0 );
        crossed += of_ring[ring] > 0 ? 1 : 0;
    }
    assert_true( crossed > 10 );
}

TEST( what_shares_a_point_does_not_count )
{
    // an edge through the inside, and two from a corner
    float xyzw[6][4] = { { 0.0f, 0.0f, 0.0f, 0.0f },  { 4.0f, 0.0f, 0.0f, 0.0f }, { 0.0f, 4.0f, 0.0f, 0.0f },
                         { 1.0f, 1.0f, -1.0f, 0.0f }, { 1.0f, 1.0f, 1.0f, 0.0f }, { 0.0f, 0.0f, 0.0f, 0.0f } };
    int32_t edges[] = { 3, 4, 0, 4, 5, 4 }, triangles[] = { 0, 1, 2 };
    const contact_mesh s = {
        .xyzw = xyzw[0], .edges = edges, .edge_count = 3, .triangles = triangles, .triangle_count = 1
    };
    SCOPED( searcher_close ) searcher* r = searcher_open( 1 );
    // the third edge begins on the corner under another number: it touches without crossing
    search( r, &s );
    assert_found( r, ( wisp_intersection[] ){ { 0, 0 } }, 1 );
}

TEST( what_is_not_finite_crosses_nothing_and_hides_nothing )
{
    static const float bad[] = { NAN, INFINITY, -INFINITY };
    SCOPED( contact_mesh_free ) contact_mesh s = contact_mesh_make( PIERCED );
    for ( int i = 0; i < s.point_count; i += 11 )
    {
        s.xyzw[4 * (size_t)i + (size_t)( i % 3 )] = bad[i % 7 % 3];
    }
    int count, kept = 0;
    SCOPED( free_local ) wisp_intersection* expected = contact_mesh_brute( &s, &count );
    for ( int i = 0; i < count; ++i )
    {
        bool is_finite = true;
        for ( int k = 0; k < 5; ++k )
        {
            const int32_t point = k < 2 ? s.edges[2 * (size_t)expected[i].edge + (size_t)k]
                                        : s.triangles[3 * (size_t)expected[i].triangle + (size_t)k - 2];
            is_finite = is_finite && point % 11 != 0;
        }
        if ( is_finite )
        {
            expected[kept++] = expected[i];
        }
    }
    assert_true( kept > 20 && kept < count );
    SCOPED( searcher_close ) searcher* r = searcher_open( 3 );
    search( r, &s );
    assert_found( r, expected, kept );
}

TEST( nothing_crosses_nothing )
{
    SCOPED( contact_mesh_free ) contact_mesh s = contact_mesh_make( HEAP );
    SCOPED( searcher_close ) searcher* r = searcher_open( 2 );
    const int edge_count = s.edge_count, triangle_count = s.triangle_count;
    for ( int empty = 1; empty < 4; ++empty )
    {
        s.edge_count = ( empty & 1 ) != 0 ? 0 : edge_count;
        s.triangle_count = ( empty & 2 ) != 0 ? 0 : triangle_count;
        search( r, &s );
        assert_found( r, NULL, 0 );
    }
}

// ---- memory ----

// Whichever request is refused, the call either reports it and keeps the previous intersections, or succeeds without.
TEST( without_memory_the_last_intersections_stay )
{
    SCOPED( contact_mesh_free ) contact_mesh few = contact_mesh_make( NEEDLES ), many = contact_mesh_make( HEAP );
    int few_count, many_count, failed = 0, n = 0;
    SCOPED( free_local )
    wisp_intersection *of_few = contact_mesh_brute( &few, &few_count ),
                      *of_many = contact_mesh_brute( &many, &many_count );
    for ( bool was_refused = true; was_refused; )
    {
        SCOPED( searcher_close ) searcher* r = searcher_open( 2 );
        search( r, &few );
        test_host_refuse( &r->host, ++n, false );
        search( r, &many );
        was_refused = test_host_has_refused( &r->host );
        test_host_refuse( &r->host, 0, false );
        if ( r->status != WISP_OK )
        {
            assert_true( was_refused );
            assert_int_equal( r->status, WISP_NO_MEMORY );
            assert_one_message( r->error.message );
            assert_list( r, of_few, few_count );
            search( r, &many );
            ++failed;
        }
        assert_found( r, of_many, many_count );
    }
    assert_true( failed >= 4 ); // boxes of edges, boxes of triangles, blocks, the list
}
