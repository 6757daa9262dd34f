// Points on a mesh: their counts (boundary particle paper) and positions, and that the path to them does not matter.
#include "support.h"

#include "jobs.h"
#include "kernel_tables.h"

#include "wisp/module/sampling.h"

typedef struct samples_mesh
{
    int vertex_count, edge_count, triangle_count;
    float *position, *normal; // [vertex][4]
    int32_t *edges, *triangles;
} samples_mesh;

static void* samples_array( size_t count, size_t row )
{
    void* memory = aligned_alloc( 64, ( count * row + 64 ) / 64 * 64 );
    assert_non_null( memory );
    memset( memory, 0, ( count * row + 64 ) / 64 * 64 );
    return memory;
}

static int samples_compare_edges( const void* a, const void* b )
{
    const int32_t *p = a, *q = b;
    return p[0] != q[0] ? p[0] - q[0] : p[1] - q[1];
}

/// Edges of the triangles, each once, lower end first, rising.
static void samples_find_edges( samples_mesh* m )
{
    SCOPED( free_local ) int32_t* all = samples_array( (size_t)m->triangle_count * 3, 2 * sizeof( int32_t ) );
    for ( int side = 0; side < 3 * m->triangle_count; ++side )
    {
        const int32_t a = m->triangles[side], b = m->triangles[side / 3 * 3 + ( side + 1 ) % 3];
        all[2 * side] = a < b ? a : b;
        all[2 * side + 1] = a < b ? b : a;
    }
    qsort( all, (size_t)m->triangle_count * 3, 2 * sizeof( int32_t ), samples_compare_edges );
    m->edges = samples_array( (size_t)m->triangle_count * 3, 2 * sizeof( int32_t ) );
    for ( int side = 0; side < 3 * m->triangle_count; ++side )
    {
        if ( side == 0 || memcmp( all + 2 * side, all + 2 * side - 2, 2 * sizeof( int32_t ) ) != 0 )
        {
            memcpy( m->edges + 2 * m->edge_count++, all + 2 * side, 2 * sizeof( int32_t ) );
        }
    }
}

static samples_mesh samples_mesh_of( const wisp_vec3* points, int vertex_count, const int32_t* triangles,
                                     int triangle_count )
{
    samples_mesh m = { .vertex_count = vertex_count, .triangle_count = triangle_count };
    m.position = samples_array( (size_t)vertex_count, 4 * sizeof( float ) );
    m.normal = samples_array( (size_t)vertex_count, 4 * sizeof( float ) );
    m.triangles = samples_array( (size_t)triangle_count * 3, sizeof( int32_t ) );
    memcpy( m.triangles, triangles, (size_t)triangle_count * 3 * sizeof( int32_t ) );
    for ( int v = 0; v < vertex_count; ++v )
    {
        const float quad[4] = { points[v].x, points[v].y, points[v].z, 1.0f }, up[4] = { 0.0f, 0.0f, 1.0f, 0.0f };
        memcpy( m.position + 4 * v, quad, sizeof( quad ) );
        memcpy( m.normal + 4 * v, up, sizeof( up ) );
    }
    samples_find_edges( &m );
    return m;
}

/// The reference: 872 vertices, 1740 triangles and 2610 edges for 30 slices and 30 stacks. Poles on the y axis.
static samples_mesh samples_sphere( int slices, int stacks, double radius )
{
    const double pi = 3.14159265358979323846;
    const int vertex_count = slices * ( stacks - 1 ) + 2, top = vertex_count - 2, bottom = vertex_count - 1;
    SCOPED( free_local ) wisp_vec3* points = samples_array( (size_t)vertex_count, sizeof( wisp_vec3 ) );
    SCOPED( free_local ) int32_t* triangles = samples_array( (size_t)slices * (size_t)stacks * 6, sizeof( int32_t ) );
    int count = 0;
    for ( int v = 0; v < vertex_count - 2; ++v )
    {
        const double down = pi * ( v / slices + 1 ) / stacks, around = 2.0 * pi * ( v % slices ) / slices;
        points[v] = ( wisp_vec3 ){ (float)( radius * sin( down ) * cos( around ) ), (float)( radius * cos( down ) ),
                                   (float)( radius * sin( down ) * sin( around ) ) };
    }
    points[top] = ( wisp_vec3 ){ 0.0f, (float)radius, 0.0f };
    points[bottom] = ( wisp_vec3 ){ 0.0f, (float)-radius, 0.0f };
    for ( int s = 0; s < slices; ++s )
    {
        const int next = ( s + 1 ) % slices, last = slices * ( stacks - 2 );
        for ( int k = 0; k + 2 < stacks; ++k )
        {
            const int a = k * slices + s, b = k * slices + next;
            const int32_t two[6] = { a, b, b + slices, a, b + slices, a + slices };
            memcpy( triangles + 3 * count, two, sizeof( two ) );
            count += 2;
        }
        const int32_t caps[6] = { top, next, s, last + s, last + next, bottom };
        memcpy( triangles + 3 * count, caps, sizeof( caps ) );
        count += 2;
    }
    samples_mesh m = samples_mesh_of( points, vertex_count, triangles, count );
    for ( int v = 0; v < vertex_count; ++v )
    {
        for ( int k = 0; k < 3; ++k )
        {
            m.normal[4 * v + k] = m.position[4 * v + k] / (float)radius;
        }
    }
    return m;
}

static void samples_mesh_free( samples_mesh* m )
{
    free( m->position );
    free( m->normal );
    free( m->edges );
    free( m->triangles );
}

// ---- a layer, with an active pool of workers ----

typedef struct layer
{
    test_host host;
    wisp_allocator allocator;
    jobs_pool* pool;
    wisp_samples samples;
    wisp_samples_args args;
    wisp_status status;
} layer;

static layer* layer_open( const samples_mesh* m, float spacing, int workers )
{
    layer* l = checked_calloc( 1, sizeof( layer ) );
    l->allocator = test_host_allocator( &l->host );
    l->pool = jobs_create( &l->allocator, workers, NULL, NULL );
    const size_t edges = (size_t)m->edge_count, triangles = (size_t)m->triangle_count;
    l->args = ( wisp_samples_args ){
        .position = m->position,
        .normal = m->normal,
        .edges = m->edges,
        .edge_count = m->edge_count,
        .triangles = m->triangles,
        .triangle_count = m->triangle_count,
        .spacing = spacing,
        .limit = 1000000,
        .edge_length = samples_array( edges, sizeof( float ) ),
        .edge_points = samples_array( edges, sizeof( int32_t ) ),
        .triangle_extent = samples_array( triangles, 2 * sizeof( float ) ),
        .triangle_axis = samples_array( triangles, sizeof( int32_t ) ),
        .triangle_points = samples_array( triangles, sizeof( int32_t ) ),
    };
    return l;
}

static void layer_close( layer** local )
{
    layer* l = *local;
    free( l->args.edge_length );
    free( l->args.edge_points );
    free( l->args.triangle_extent );
    free( l->args.triangle_axis );
    free( l->args.triangle_points );
    wisp_samples_release( &l->samples, &l->allocator );
    jobs_destroy( l->pool );
    assert_host_memory_is_released( &l->host );
    free( l );
}

static void layer_run( void* context )
{
    layer* l = context;
    l->status = wisp_samples_update( &l->samples, jobs_everyone( l->pool ), kernels_select( NULL, NULL ), &l->args );
}

static wisp_status layer_try( layer* l )
{
    jobs_enter( l->pool, layer_run, l );
    return l->status;
}

static void layer_update( layer* l )
{
    assert_int_equal( layer_try( l ), WISP_OK );
}

/// Every array of two layers has the same bits.
static void assert_same_points( const wisp_samples* a, const wisp_samples* b, int elements )
{
    const size_t bytes = (size_t)a->count * 4 * sizeof( float );
    assert_int_equal( a->count, b->count );
    assert_int_equal( a->edge_count, b->edge_count );
    assert_memory_equal( a->begin, b->begin, ( (size_t)elements + 1 ) * sizeof( int32_t ) );
    if ( bytes > 0 )
    {
        assert_memory_equal( a->xyzw, b->xyzw, bytes );
        assert_memory_equal( a->normals, b->normals, bytes );
        assert_memory_equal( a->parents, b->parents, bytes );
        assert_memory_equal( a->weights, b->weights, bytes );
    }
}

// ---- counts ----

TEST( edges_have_the_counts_of_their_lengths )
{
    // of half a metre: 0.3, 1, 1.5, 2 and 3.7 spacings (section 2.1), all of them floats
    const float lengths[] = { 0.15f, 0.5f, 0.75f, 1.0f, 1.85f };
    const int even[] = { 0, 0, 0, 1, 2 }, exact[] = { 0, 0, 1, 1, 3 }, up[] = { 0, 0, 1, 1, 3 },
              near[] = { 0, 0, 1, 1, 3 };
    for ( int i = 0; i < WISP_COUNT( lengths ); ++i )
    {
        const wisp_vec3 points[3] = { { 0.0f, 0.0f, 0.0f }, { lengths[i], 0.0f, 0.0f }, { 0.0f, 1e-3f, 0.0f } };
        SCOPED( samples_mesh_free ) samples_mesh m = samples_mesh_of( points, 3, ( const int32_t[3] ){ 0, 1, 2 }, 1 );
        const int* expected[] = { even, exact, up, near };
        for ( int k = 0; k < WISP_COUNT( expected ); ++k )
        {
            SCOPED( layer_close ) layer* l = layer_open( &m, 0.5f, 1 );
            l->args.policy = k == 1 ? WISP_SPACING_EXACT : WISP_SPACING_EVEN;
            l->args.rounding = k == 2 ? WISP_ROUND_UP : ( k == 3 ? WISP_ROUND_NEAREST : WISP_ROUND_DOWN );
            layer_update( l );
            assert_int_equal( l->args.edge_points[0], expected[k][i] );
            assert_int_equal( l->samples.begin[1] - l->samples.begin[0], expected[k][i] );
        }
    }
}

// ---- positions ----

static double distance_of( const float* a, const float* b )
{
    double sum = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        sum += ( (double)a[k] - (double)b[k] ) * ( (double)a[k] - (double)b[k] );
    }
    return sqrt( sum );
}

// ---- independence of the history ----

// Swell and shear, so that some steps change no element, some a few and some many.
static void deform( const float* rest, samples_mesh* m, int step )
{
    const float amounts[] = { 0.0f, 1e-7f, 1e-4f, 3e-2f, 1e-3f, 0.2f, 0.2001f, 1e-5f, 0.0f };
    const float s = amounts[step % WISP_COUNT( amounts )];
    for ( int v = 0; v < m->vertex_count; ++v )
    {
        const float *p = rest + 4 * v, to[3] = { p[0] * ( 1.0f + s ) + s * p[1], p[1], p[2] * ( 1.0f - s * p[0] ) };
        memcpy( m->position + 4 * v, to, sizeof( to ) );
    }
}

static float* copy_of_positions( const samples_mesh* m )
{
    float* rest = samples_array( (size_t)m->vertex_count, 4 * sizeof( float ) );
    memcpy( rest, m->position, (size_t)m->vertex_count * 4 * sizeof( float ) );
    return rest;
}

TEST( only_what_changes_is_resampled )
{
    SCOPED( samples_mesh_free ) samples_mesh m = samples_sphere( 30, 30, 2.5 );
    SCOPED( layer_close ) layer* l = layer_open( &m, 0.05f, 1 );
    layer_update( l );
    const int before = l->samples.count;
    layer_update( l );
    assert_int_equal( l->samples.changed_elements, 0 );
    m.position[4 * 400] *= 1.1f; // one vertex: six edges and six triangles at most
    layer_update( l );
    assert_in_range( l->samples.changed_elements, 1, 12 );
    assert_int_not_equal( l->samples.count, before );
}

// ---- memory of counts ----

static samples_mesh one_triangle( float length )
{
    const wisp_vec3 points[3] = { { 0.0f, 0.0f, 0.0f }, { length, 0.0f, 0.0f }, { 0.5f * length, 3.0f, 0.0f } };
    return samples_mesh_of( points, 3, ( const int32_t[3] ){ 0, 1, 2 }, 1 );
}

TEST( hysteresis_keeps_counts_until_lengths_are_well_beyond )
{
    SCOPED( samples_mesh_free ) samples_mesh m = one_triangle( 2.1f );
    SCOPED( layer_close ) layer* l = layer_open( &m, 1.0f, 1 );
    l->args.hysteresis = 0.2f;
    const float lengths[] = { 2.1f, 1.9f, 1.81f, 1.79f, 1.95f, 2.1f, 2.19f, 2.21f, 1.95f };
    const int expected[] = { 1, 1, 1, 0, 0, 0, 0, 1, 1 };
    for ( int i = 0; i < WISP_COUNT( lengths ); ++i )
    {
        m.position[4] = lengths[i];
        m.position[8] = 0.5f * lengths[i];
        layer_update( l );
        assert_int_equal( l->args.edge_points[0], expected[i] );
    }
}

TEST( a_state_put_back_brings_its_points_back )
{
    SCOPED( samples_mesh_free ) samples_mesh m = samples_sphere( 14, 13, 1.0 );
    SCOPED( free_local ) float* rest = copy_of_positions( &m );
    SCOPED( layer_close ) layer *through = layer_open( &m, 0.05f, 1 ), *back = layer_open( &m, 0.05f, 1 );
    through->args.hysteresis = back->args.hysteresis = 0.4f;
    for ( int step = 0; step < 4; ++step )
    {
        deform( rest, &m, step );
        layer_update( through );
    }
    const size_t edges = (size_t)m.edge_count * sizeof( int32_t ),
                 triangles = (size_t)m.triangle_count * sizeof( int32_t );
    deform( rest, &m, 5 );
    layer_update( back ); // used memory of another layer
    memcpy( back->args.edge_length, through->args.edge_length, edges );
    memcpy( back->args.edge_points, through->args.edge_points, edges );
    memcpy( back->args.triangle_extent, through->args.triangle_extent, 2 * triangles );
    memcpy( back->args.triangle_axis, through->args.triangle_axis, triangles );
    memcpy( back->args.triangle_points, through->args.triangle_points, triangles );
    for ( int step = 3; step < 7; ++step )
    {
        deform( rest, &m, step );
        layer_update( through );
        layer_update( back );
        assert_same_points( &through->samples, &back->samples, m.edge_count + m.triangle_count );
        assert_memory_equal( through->args.edge_length, back->args.edge_length, edges );
        assert_memory_equal( through->args.triangle_extent, back->args.triangle_extent, 2 * triangles );
        assert_memory_equal( through->args.edge_points, back->args.edge_points, edges );
    }
}

// ---- limits ----

TEST( a_layer_beyond_its_limit_stays_as_it_was_and_follows )
{
    SCOPED( samples_mesh_free ) samples_mesh m = samples_sphere( 14, 13, 1.0 );
    SCOPED( layer_close ) layer* l = layer_open( &m, 0.05f, 1 );
    layer_update( l );
    const int count = l->samples.count;
    const int64_t bytes = atomic_load( &l->host.bytes );
    l->args.limit = count + 10;
    const float spacings[] = { 0.04f, 1e-6f, 1e-20f };
    for ( int i = 0; i < WISP_COUNT( spacings ); ++i )
    {
        l->args.spacing = spacings[i];
        m.position[4 * 30] += 0.01f;
        layer_update( l );
        assert_true( l->samples.refused );
        assert_true( l->samples.requested > (double)l->args.limit );
        assert_int_equal( l->samples.count, count );
        assert_int_equal( atomic_load( &l->host.bytes ), bytes );
    }
    const float* parent = m.position + l->samples.parents[0][0];
    assert_true( distance_of( l->samples.xyzw, parent ) < 1.0 );
    l->args.spacing = 0.06f;
    layer_update( l );
    assert_false( l->samples.refused );
    assert_true( l->samples.count < count );
}

TEST( without_memory_points_are_those_of_the_last_call )
{
    SCOPED( samples_mesh_free ) samples_mesh m = samples_sphere( 14, 13, 1.0 );
    SCOPED( layer_close ) layer* l = layer_open( &m, 0.05f, 1 );
    test_host_refuse( &l->host, 1, true );
    assert_int_equal( layer_try( l ), WISP_NO_MEMORY );
    test_host_refuse( &l->host, 2, true );
    assert_int_equal( layer_try( l ), WISP_NO_MEMORY );
    test_host_refuse( &l->host, 0, false );
    layer_update( l );
    const int count = l->samples.count;
    const int32_t points = l->args.edge_points[3];
    l->args.spacing = 0.01f;
    test_host_refuse( &l->host, 1, true );
    assert_int_equal( layer_try( l ), WISP_NO_MEMORY );
    assert_int_equal( l->samples.count, count );
    assert_int_equal( l->args.edge_points[3], points );
    test_host_refuse( &l->host, 0, false );
    layer_update( l );
    assert_true( l->samples.count > 4 * count );
}

// ---- degenerate meshes ----

TEST( triangles_without_area_and_edges_without_length_have_no_points )
{
    const wisp_vec3 flat[3] = { { 0.0f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 3.0f, 0.0f, 0.0f } };
    const wisp_vec3 folded[3] = { { 1.0f, 1.0f, 0.0f }, { 1.0f, 1.0f, 0.0f }, { 4.0f, 1.0f, 0.0f } };
    const wisp_vec3* shapes[] = { flat, folded };
    const int expected[2][3] = { { 9, 29, 19 }, { 0, 29, 29 } }; // edges 0-1, 0-2 and 1-2
    for ( int i = 0; i < 2; ++i )
    {
        for ( int policy = 0; policy < WISP_SPACING_COUNT; ++policy )
        {
            SCOPED( samples_mesh_free )
            samples_mesh m = samples_mesh_of( shapes[i], 3, ( const int32_t[3] ){ 0, 1, 2 }, 1 );
            SCOPED( layer_close ) layer* l = layer_open( &m, 0.1f * ( 1.0f - 1e-6f ), 1 );
            l->args.policy = (wisp_spacing)policy;
            for ( int step = 0; step < 2; ++step )
            {
                layer_update( l );
                assert_int_equal( l->args.triangle_points[0], 0 );
                for ( int e = 0; e < 3; ++e )
                {
                    const int points =
                        policy == WISP_SPACING_EVEN || expected[i][e] == 0 ? expected[i][e] : expected[i][e] + 1;
                    assert_int_equal( l->args.edge_points[e], points );
                }
            }
        }
    }
}

TEST( the_lowest_of_equally_short_sides_is_the_axis )
{
    // legs of a right triangle, rotated through its corners
    const wisp_vec3 points[3] = { { 0.0f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 0.0f, 1.0f, 0.0f } };
    const int32_t corners[3][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 } };
    const int axis[3] = { 0, 1, 0 };
    for ( int i = 0; i < 3; ++i )
    {
        SCOPED( samples_mesh_free ) samples_mesh m = samples_mesh_of( points, 3, corners[i], 1 );
        SCOPED( layer_close ) layer* l = layer_open( &m, 0.25f, 1 );
        layer_update( l );
        assert_int_equal( l->args.triangle_axis[0], axis[i] );
        // lines at 1/4, 1/2 and 3/4 of the height, of 3, 2 and 1 spacings
        assert_int_equal( l->args.triangle_points[0], 2 + 1 );
    }
}

TEST( a_layer_without_normals_has_places_alone )
{
    SCOPED( samples_mesh_free ) samples_mesh m = samples_sphere( 14, 13, 1.0 );
    SCOPED( layer_close ) layer *with = layer_open( &m, 0.05f, 1 ), *without = layer_open( &m, 0.05f, 1 );
    without->args.normal = NULL;
    layer_update( with );
    layer_update( without );
    assert_null( without->samples.normals );
    assert_memory_equal( with->samples.xyzw, without->samples.xyzw,
                         (size_t)with->samples.count * 4 * sizeof( float ) );
    without->args.normal = m.normal;
    layer_update( without );
    assert_same_points( &with->samples, &without->samples, m.edge_count + m.triangle_count );
}
