// Edges and triangles of surfaces against meshes and surfaces as colliders: needles, blades, box edges, moving surfaces, and the
// distances by which they are found.
#include "collision_fixture.h"
#include "feature_contacts.h"
#include "oracle/mesh_gap_oracle.h"
#include "wisp/module/random.h"

static const float DT = 1.0f / 60.0f;
static const float CELL = 0.02f;
static const float THICKNESS = 0.005f;
static const float GRAVITY = 9.8f;

enum
{
    SIDE = 21, // vertices
    MOST_POINTS = 600,
    MOST_CORNERS = 121, // of a collider
};

// ---- distances ----

static wisp_vec3 random_point( uint32_t number )
{
    const wisp_random_key key = wisp_random_make_key( 7, 0, 0 );
    return ( wisp_vec3 ){ wisp_random_unit_float( key, number, 0, 0 ), wisp_random_unit_float( key, number, 1, 0 ),
                          wisp_random_unit_float( key, number, 2, 0 ) };
}

static void closest_points_are_those_of_the_oracle( void** state )
{
    (void)state;
    for ( uint32_t n = 0; n < 2000; ++n )
    {
        wisp_vec3 p[5];
        double3 q[5];
        for ( uint32_t k = 0; k < 5; ++k )
        {
            p[k] = random_point( 5 * n + k );
            p[k].y *= n % 4 == 0 ? 0.0f : 1.0f; // in a plane, where they may cross
        }
        p[4] = n % 5 == 0 ? p[3] : p[4]; // a feature without length
        p[1] = n % 7 == 0 ? collision_add_scaled( p[0], 0.5f, collision_sub( p[4], p[3] ) ) : p[1]; // parallel
        for ( int k = 0; k < 5; ++k )
        {
            q[k] = double3_widen( p[k] );
        }
        float weights[3], along;
        const double edges = collision_closest_feature( p, 2, p + 3, weights, &along );
        const double3 a = double3_blend( q[0], q[1], (double)weights[1] ),
                      b = double3_blend( q[3], q[4], (double)along );
        assert_true( fabs( edges - mesh_gap_oracle_segments( q, q + 3 ) ) < 1e-7 );
        assert_true( fabs( double3_distance( a, b ) - edges ) < 1e-6 );
        const wisp_vec3 point[2] = { p[3], p[3] };
        const double face = collision_closest_feature( p, 3, point, weights, &along );
        double3 c = { 0.0, 0.0, 0.0 };
        for ( int k = 0; k < 3; ++k )
        {
            c = double3_add_scaled( c, (double)weights[k], q[k] );
        }
        assert_true( fabs( face - mesh_gap_oracle_triangle( q, q[3] ) ) < 1e-7 );
        assert_true( fabs( double3_distance( c, q[3] ) - face ) < 1e-6 );
    }
}

// ---- meshes ----

static test_mesh new_mesh( const wisp_vec3* points, int point_count, const int32_t* triangles, int triangle_count )
{
    test_mesh m = { calloc( (size_t)point_count, sizeof( wisp_vec3 ) ),
                    calloc( 3 * (size_t)triangle_count, sizeof( int32_t ) ), point_count, triangle_count };
    memcpy( m.points, points, (size_t)point_count * sizeof( wisp_vec3 ) );
    memcpy( m.triangles, triangles, 3 * (size_t)triangle_count * sizeof( int32_t ) );
    return m;
}

// A bar along y from -length to 0, with three sides, that ends in a tip or in an edge across.
static test_mesh spike( float radius, float length )
{
    wisp_vec3 points[7];
    for ( int k = 0; k < 3; ++k )
    {
        const float angle = 2.0943951f * (float)k + 0.3f;
        points[k] = ( wisp_vec3 ){ radius * cosf( angle ), -length, radius * sinf( angle ) };
        points[3 + k] = ( wisp_vec3 ){ points[k].x, -2.0f * radius, points[k].z };
    }
    points[6] = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    const int32_t triangles[10][3] = { { 0, 1, 2 }, { 0, 3, 1 }, { 1, 3, 4 }, { 1, 4, 2 }, { 2, 4, 5 },
                                       { 2, 5, 0 }, { 0, 5, 3 }, { 3, 6, 4 }, { 4, 6, 5 }, { 5, 6, 3 } };
    return new_mesh( points, 7, &triangles[0][0], 10 );
}

static test_mesh box( wisp_vec3 half )
{
    wisp_vec3 points[8];
    for ( int k = 0; k < 8; ++k )
    {
        points[k] = ( wisp_vec3 ){ k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z };
    }
    const int32_t triangles[12][3] = { { 0, 2, 1 }, { 1, 2, 3 }, { 4, 5, 6 }, { 5, 7, 6 }, { 0, 1, 4 }, { 1, 5, 4 },
                                       { 2, 6, 3 }, { 3, 6, 7 }, { 0, 4, 2 }, { 2, 4, 6 }, { 1, 3, 5 }, { 3, 7, 5 } };
    return new_mesh( points, 8, &triangles[0][0], 12 );
}

// Two triangles in the plane z = 0, below y = 0.
static test_mesh blade( float half, float depth )
{
    const wisp_vec3 points[4] = { { -half, -depth, 0 }, { half, -depth, 0 }, { half, 0, 0 }, { -half, 0, 0 } };
    const int32_t triangles[2][3] = { { 0, 1, 2 }, { 0, 2, 3 } };
    return new_mesh( points, 4, &triangles[0][0], 2 );
}

static void each_edge_of_a_box_is_found_once_and_no_diagonal_of_its_faces( void** state )
{
    (void)state;
    test_mesh m = box( ( wisp_vec3 ){ 1.0f, 2.0f, 3.0f } );
    const float all[2] = { -9.0f, 9.0f }, lower[3] = { all[0], all[0], all[0] },
                upper[3] = { all[1], all[1], all[1] }, above[3] = { all[0], 1.9f, all[0] };
    for ( int deforms = 0; deforms < 2; ++deforms )
    {
        const wisp_collision_mesh_def def = { .points = m.points,
                                              .triangles = m.triangles,
                                              .point_count = m.vertex_count,
                                              .triangle_count = m.triangle_count,
                                              .deforms = deforms == 1 };
        wisp_collision_mesh* mesh;
        int32_t found[64];
        assert_int_equal( wisp_collision_mesh_create( &def, NULL, &mesh, NULL ), WISP_OK );
        if ( deforms )
        {
            assert_int_equal( wisp_collision_mesh_update( mesh, NULL, m.points, NULL, NULL ), WISP_OK );
        }
        assert_int_equal( wisp_collision_mesh_find_features( mesh, lower, upper, false, found, 64 ), 0 );
        const size_t bytes = wisp_collision_mesh_bytes( mesh );
        assert_int_equal( wisp_collision_mesh_prepare_features( mesh, NULL ), WISP_OK );
        assert_true( wisp_collision_mesh_bytes( mesh ) > bytes );
        assert_int_equal( wisp_collision_mesh_prepare_features( mesh, NULL ), WISP_OK ); // once is enough
        const int edges = wisp_collision_mesh_find_features( mesh, lower, upper, false, found, 64 );
        assert_int_equal( edges, deforms ? 18 : 12 ); // what deforms may bend
        int ridges = 0;
        for ( int i = 0; i < edges; ++i )
        {
            const wisp_mesh_sides sides = wisp_collision_mesh_sides( mesh, found[i], false, 1.0f );
            assert_false( sides.behind );
            ridges += sides.in_front;
        }
        assert_int_equal( ridges, 12 );
        assert_int_equal( wisp_collision_mesh_find_features( mesh, lower, upper, true, found, 64 ), 8 );
        assert_int_equal( wisp_collision_mesh_find_features( mesh, lower, upper, true, found, 5 ), 5 );
        const int upper_edges = wisp_collision_mesh_find_features( mesh, above, upper, false, found, 64 );
        assert_true( upper_edges >= 4 && upper_edges < edges + 1 );
        wisp_collision_mesh_release( mesh );
    }
    test_mesh_free( &m );
}

// ---- one edge and a mesh ----

// Meet a mesh with a segment along x at a height, at rest. @return how many meetings
static int meet( const test_mesh* mesh, bool double_sided, float y, float z, collision_meeting* out )
{
    const wisp_collision_mesh_def def = { .points = mesh->points,
                                          .triangles = mesh->triangles,
                                          .point_count = mesh->vertex_count,
                                          .triangle_count = mesh->triangle_count };
    collision_body body = { .double_sided = double_sided };
    const collision_view view = { .body = &body, .thickness = 0.02f };
    assert_int_equal( wisp_collision_mesh_create( &def, NULL, &body.tree, NULL ), WISP_OK );
    assert_int_equal( wisp_collision_mesh_prepare_features( body.tree, NULL ), WISP_OK );
    const primitive_path path = { .corner_count = 2,
                                  .from = { { -1, y, z }, { 1, y, z } },
                                  .to = { { -1, y, z }, { 1, y, z } } };
    const int found = collision_meet_features( &view, &path, out );
    wisp_collision_mesh_release( body.tree );
    return found;
}

// Roofs with ridges along z at x = 0, 0.2, 0.4 ... and heights that differ; valleys between them.
static test_mesh roofs( const float* heights, int count )
{
    wisp_vec3 points[32];
    int32_t triangles[64][3];
    for ( int i = 0; i <= 2 * count; ++i )
    {
        const float x = 0.1f * (float)i - 0.1f, y = i % 2 == 1 ? heights[i / 2] : -0.1f;
        points[2 * i] = ( wisp_vec3 ){ x, y, -0.5f };
        points[2 * i + 1] = ( wisp_vec3 ){ x, y, 0.5f };
    }
    for ( int i = 0; i < 2 * count; ++i )
    {
        const int32_t a = 2 * i;
        memcpy( triangles[2 * i], ( int32_t[] ){ a, a + 1, a + 2 }, sizeof triangles[0] );
        memcpy( triangles[2 * i + 1], ( int32_t[] ){ a + 1, a + 3, a + 2 }, sizeof triangles[0] );
    }
    return new_mesh( points, 4 * count + 2, &triangles[0][0], 4 * count );
}

static void the_two_nearest_ridges_are_met_and_no_valley( void** state )
{
    (void)state;
    static const float heights[4] = { 0.011f, 0.018f, 0.005f, 0.014f };
    test_mesh m = roofs( heights, 4 );
    collision_meeting out[COLLISION_PRIMITIVE_CONTACTS];
    assert_int_equal( meet( &m, true, 0.025f, 0.03f, out ), 2 );
    assert_float_equal( out[0].deepest.surface.distance, 0.025f - 0.018f, 1e-6f );
    assert_float_equal( out[1].deepest.surface.distance, 0.025f - 0.014f, 1e-6f );
    assert_float_equal( out[0].deepest.surface.point.x, 0.2f, 1e-6f );
    assert_float_equal( out[0].deepest.surface.normal.y, 1.0f, 1e-6f );
    assert_float_equal( out[0].deepest.weights[1], 0.6f, 1e-6f );
    // above a valley of this side, which is a ridge from below
    assert_int_equal( meet( &m, true, -0.13f, 0.03f, out ), 2 );
    assert_float_equal( out[0].deepest.surface.normal.y, -1.0f, 1e-6f );
    test_mesh_free( &m );
    static const float deep[1] = { -0.3f };
    m = roofs( deep, 1 ); // one valley: its border is met, and the valley is not
    const int found = meet( &m, true, -0.29f, 0.0f, out );
    for ( int i = 0; i < found; ++i )
    {
        assert_true( fabsf( out[i].deepest.surface.point.x ) > 0.05f );
    }
    test_mesh_free( &m );
}

static void a_closed_mesh_is_met_from_outside_alone( void** state )
{
    (void)state;
    test_mesh m = box( ( wisp_vec3 ){ 0.3f, 0.1f, 0.1f } );
    collision_meeting out[COLLISION_PRIMITIVE_CONTACTS];
    // across the edges at x = 0.3 and x = -0.3 it would lie in the face: above it both are met, below it none
    assert_int_equal( meet( &m, false, 0.11f, 0.02f, out ), 2 );
    assert_float_equal( out[0].deepest.surface.distance, 0.01f, 1e-6f );
    assert_int_equal( meet( &m, false, 0.09f, 0.02f, out ), 0 );
    assert_int_equal( meet( &m, true, 0.09f, 0.02f, out ), 0 ); // from behind they are valleys
    test_mesh_free( &m );
}

// ---- height fields ----

// The triangles of a field, which face upwards.
static test_mesh mesh_of_field( const wisp_height_field* f )
{
    const int nx = f->count_x, nz = f->count_z;
    wisp_vec3 points[MOST_POINTS];
    int32_t triangles[2 * MOST_POINTS][3];
    int count = 0;
    for ( int v = 0; v < nx * nz; ++v )
    {
        points[v] = ( wisp_vec3 ){ f->spacing * ( (float)( v % nx ) - 0.5f * (float)( nx - 1 ) ), f->heights[v],
                                   f->spacing * ( (float)( v / nx ) - 0.5f * (float)( nz - 1 ) ) };
        if ( v % nx + 1 < nx && v / nx + 1 < nz )
        {
            memcpy( triangles[count++], ( int32_t[] ){ v, v + nx, v + nx + 1 }, sizeof triangles[0] );
            memcpy( triangles[count++], ( int32_t[] ){ v, v + nx + 1, v + 1 }, sizeof triangles[0] );
        }
    }
    return new_mesh( points, nx * nz, &triangles[0][0], count );
}

static bool is_same_place( const wisp_mesh_feature* a, const wisp_mesh_feature* b )
{
    const float near = 1e-5f;
    return ( collision_length( collision_sub( a->from[0], b->from[0] ) ) < near &&
             collision_length( collision_sub( a->from[1], b->from[1] ) ) < near ) ||
           ( collision_length( collision_sub( a->from[0], b->from[1] ) ) < near &&
             collision_length( collision_sub( a->from[1], b->from[0] ) ) < near );
}

// Within a box, the edges of a field that stick out are those that stick out of the mesh of its triangles, with the same normals.
static void a_height_field_has_the_edges_and_corners_of_its_triangles( void** state )
{
    (void)state;
    float heights[9 * 7];
    for ( uint32_t v = 0; v < 63; ++v )
    {
        heights[v] = v % 5 == 0 ? 0.05f : 0.2f * random_point( v ).x;
    }
    const wisp_height_field field = { heights, 9, 7, 0.1f };
    test_mesh m = mesh_of_field( &field );
    const wisp_collision_mesh_def def = { .points = m.points,
                                          .triangles = m.triangles,
                                          .point_count = m.vertex_count,
                                          .triangle_count = m.triangle_count,
                                          .search = WISP_MESH_SEARCH_TREE };
    wisp_collision_mesh* mesh = NULL;
    assert_int_equal( wisp_collision_mesh_create( &def, NULL, &mesh, NULL ), WISP_OK );
    assert_int_equal( wisp_collision_mesh_prepare_features( mesh, NULL ), WISP_OK );
    const float lower[3] = { -0.25f, 0.06f, -0.15f }, upper[3] = { 0.2f, 0.15f, 0.18f };
    for ( int corners = 0; corners < 2; ++corners )
    {
        int32_t own[400], others[400];
        const int count = wisp_height_field_find_features( &field, lower, upper, corners == 1, own, 400 );
        const int other_count = wisp_collision_mesh_find_features( mesh, lower, upper, corners == 1, others, 400 );
        int matched = 0, expected = 0;
        for ( int k = 0; k < other_count; ++k )
        {
            const wisp_mesh_feature g = wisp_collision_mesh_feature( mesh, others[k], corners == 1, 0.0f, 1.0f );
            const wisp_mesh_sides sides = wisp_collision_mesh_sides( mesh, others[k], corners == 1, 1.0f );
            // the mesh looks at boxes of triangles, and keeps corners with a valley alone
            const bool is_near =
                fminf( g.from[0].x, g.from[1].x ) <= upper[0] && fmaxf( g.from[0].x, g.from[1].x ) >= lower[0] &&
                fminf( g.from[0].y, g.from[1].y ) <= upper[1] && fmaxf( g.from[0].y, g.from[1].y ) >= lower[1] &&
                fminf( g.from[0].z, g.from[1].z ) <= upper[2] && fmaxf( g.from[0].z, g.from[1].z ) >= lower[2];
            expected += is_near && sides.in_front && corners == 0 ? 1 : 0;
            for ( int i = 0; i < count; ++i )
            {
                const wisp_mesh_feature f = wisp_height_field_feature( &field, own[i] );
                const wisp_mesh_sides mine = wisp_height_field_sides( &field, own[i] );
                if ( is_same_place( &f, &g ) )
                {
                    matched += 1;
                    assert_true( is_near && sides.in_front && mine.in_front && mine.behind == false );
                    // corners are weighted by angles there, and not here
                    assert_true( collision_dot( mine.normal, sides.normal ) > ( corners == 1 ? 0.8f : 0.999999f ) );
                }
            }
        }
        assert_int_equal( matched, count );
        assert_true( count > 5 && ( corners == 1 || count == expected ) );
        assert_int_equal( wisp_height_field_find_features( &field, lower, upper, corners == 1, own, 3 ), 3 );
    }
    wisp_collision_mesh_release( mesh );
    test_mesh_free( &m );
}

// ---- a sheet and a mesh ----

typedef struct setting
{
    wisp_collision_features features;
    bool is_held, double_sided, follows, by_voxels;
    const wisp_height_field* field; // that the collider is, in place of a mesh; null: it is one
    float gravity;
    int workers;
    wisp_quat rotation;
} setting;

typedef struct sheet
{
    hosted* h;
    wisp_entity surface, body, skin;
    test_mesh mesh, collider;
    setting with;
    wisp_vec3 place; // of the collider
} sheet;

// In a direction and at a place that no edge of the sheet has.
static const wisp_quat TURNED = { 0.0f, 0.18f, 0.0f, 0.98367f };

static wisp_vec3 place_of( const sheet* s, wisp_vec3 p )
{
    return wisp_transform_to_world( wisp_transform_make( s->with.rotation, s->place ), p );
}

static void move_to( sheet* s, float height )
{
    s->place.y = height;
    if ( s->with.follows == false )
    {
        const wisp_transform pose = wisp_transform_make( s->with.rotation, s->place );
        assert_int_equal( wisp_move_collider( s->h->world, s->body, pose ), WISP_OK );
        return;
    }
    wisp_vec3 targets[8];
    int32_t all[8];
    for ( int v = 0; v < s->collider.vertex_count; ++v )
    {
        all[v] = v;
        targets[v] = place_of( s, s->collider.points[v] );
    }
    assert_int_equal( wisp_move_pins( s->h->world, s->skin, all, targets, s->collider.vertex_count ), WISP_OK );
}

static void add_skin( sheet* s )
{
    test_mesh placed =
        new_mesh( s->collider.points, s->collider.vertex_count, s->collider.triangles, s->collider.triangle_count );
    int32_t all[8];
    for ( int v = 0; v < placed.vertex_count; ++v )
    {
        all[v] = v;
        placed.points[v] = place_of( s, placed.points[v] );
    }
    wisp_fabric_def fabric = test_fabric_def( &placed );
    wisp_surface_def def = support_weightless_surface_def();
    def.pins = all;
    def.pin_count = placed.vertex_count;
    s->skin = test_surface_of( s->h->world, &fabric, def );
    test_mesh_free( &placed );
}

// A sheet of cells of 2 cm in the plane y = 0, held at its border or free, and a mesh whose highest point is at a height.
static sheet new_sheet( test_mesh collider, float height, setting with )
{
    sheet s = { .h = new_colliding( 10, 1, with.workers > 0 ? with.workers : 1 ),
                .collider = collider,
                .with = with };
    const float half = 0.5f * CELL * (float)( SIDE - 1 );
    s.place = ( wisp_vec3 ){ half + 0.003f, height, half + 0.0045f };
    wisp_collider_def def = mesh_body( &collider );
    if ( with.follows )
    {
        add_skin( &s );
        def = wisp_default_collider_def();
        def.kind = WISP_COLLIDER_SURFACE;
        def.surface = s.skin;
    }
    else
    {
        def.pose = wisp_transform_make( with.rotation, s.place );
        def.search = with.by_voxels ? WISP_MESH_SEARCH_VOXELS : WISP_MESH_SEARCH_TREE;
    }
    if ( with.field != NULL )
    {
        def = wisp_default_collider_def();
        def.kind = WISP_COLLIDER_HEIGHT_FIELD;
        def.heights = with.field->heights;
        def.height_count_x = with.field->count_x;
        def.height_count_z = with.field->count_z;
        def.spacing = with.field->spacing;
        def.pose = wisp_transform_make( with.rotation, s.place );
    }
    def.double_sided = with.double_sided;
    s.body = add_collider( s.h->world, &def );
    s.mesh = test_plane( SIDE, CELL );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = THICKNESS;
    collision.features = with.features;
    s.surface = add_colliding( s.h->world, &s.mesh, &collision );
    wisp_cloth_def cloth = wisp_default_cloth_def();
    assert_int_equal( wisp_set_cloth( s.h->world, s.surface, &cloth ), WISP_OK );
    give_gravity( s.h->world, s.surface, with.gravity );
    for ( int32_t v = 0; with.is_held && v < s.mesh.vertex_count; ++v )
    {
        const int i = v % SIDE, k = v / SIDE;
        if ( i == 0 || k == 0 || i == SIDE - 1 || k == SIDE - 1 )
        {
            assert_int_equal( wisp_pin( s.h->world, s.surface, &v, 1 ), WISP_OK );
        }
    }
    return s;
}

static void free_sheet( sheet* s )
{
    test_mesh_free( &s->mesh );
    test_mesh_free( &s->collider );
    free_colliding( s->h );
}

// m; -1 if the sheet and the mesh cross.
static double gap_of( const sheet* s )
{
    static double3 points[MOST_POINTS];
    double3 corners[MOST_CORNERS];
    assert_true( s->mesh.vertex_count <= MOST_POINTS && s->collider.vertex_count <= MOST_CORNERS );
    for ( int v = 0; v < s->mesh.vertex_count; ++v )
    {
        points[v] = double3_widen( point_of( s->h->world, s->surface, v ) );
    }
    for ( int v = 0; v < s->collider.vertex_count; ++v )
    {
        corners[v] = double3_widen( place_of( s, s->collider.points[v] ) );
    }
    const mesh_gap_oracle_mesh a = { points, s->mesh.triangles, s->mesh.triangle_count },
                               b = { corners, s->collider.triangles, s->collider.triangle_count };
    return mesh_gap_oracle_find( &a, &b );
}

// Move a collider up by a rise at a speed, and on for some steps. @return the least gap on the way
static double rise( sheet* s, float from, float by, float speed, int more )
{
    double least = INFINITY;
    const int steps = (int)ceilf( by / ( speed * DT ) );
    for ( int n = 1; n <= steps + more; ++n )
    {
        move_to( s, from + fminf( by, speed * DT * (float)n ) );
        run_for( s->h->world, DT, 1 );
        least = n % 5 == 0 || n <= steps ? fmin( least, gap_of( s ) ) : least;
    }
    return least;
}

static double spike_gap( setting with, float speed, float by )
{
    const float from = speed < 1.0f ? -0.02f : -0.1f;
    sheet s = new_sheet( spike( 0.001f, 0.3f ), from, with );
    const double least = rise( &s, from, by, speed, 10 );
    free_sheet( &s );
    return least;
}

static void a_spike_of_a_millimetre_does_not_pass_a_held_sheet_under_load( void** state )
{
    (void)state;
    const setting with = { WISP_COLLISION_ALL, .is_held = true, .gravity = 10.0f * GRAVITY, .rotation = TURNED };
    const double gap = spike_gap( with, 0.06f, 0.04f );

    assert_true( gap > 0.7 * (double)THICKNESS );
    setting vertices = with;
    vertices.features = WISP_COLLISION_VERTICES;
    assert_true( spike_gap( vertices, 0.06f, 0.04f ) < 0.0 );
}

static void a_spike_that_moves_does_not_pass_at_any_speed( void** state )
{
    (void)state;
    static const float speeds[] = { 0.5f, 5.0f, 20.0f };
    for ( int k = 0; k < 3; ++k )
    {
        const setting with = { WISP_COLLISION_ALL, .rotation = TURNED };
        const double gap = spike_gap( with, speeds[k], k == 0 ? 0.06f : k == 1 ? 0.2f : 0.34f );

        assert_true( gap > 0.5 * (double)THICKNESS );
    }
}

// A ground with one sample that is 4 cm higher than the others, and with a ridge of such samples.
static void no_peak_and_no_ridge_of_a_height_field_shows_through_a_sheet( void** state )
{
    (void)state;
    for ( int k = 0; k < 4; ++k )
    {
        float heights[11 * 11];
        for ( int v = 0; v < 121; ++v )
        {
            const bool is_top = k < 2 ? v == 60 : v / 11 == 5 && v % 11 > 1 && v % 11 < 9;
            heights[v] = is_top ? 0.0f : -0.04f;
        }
        const wisp_height_field field = { heights, 11, 11, 0.012f };
        const setting with = { .features = k % 2 == 0 ? WISP_COLLISION_ALL : WISP_COLLISION_VERTICES,
                               .is_held = true,
                               .field = &field,
                               .gravity = 10.0f * GRAVITY,
                               .rotation = TURNED };
        sheet s = new_sheet( mesh_of_field( &field ), -0.02f, with );
        const double gap = rise( &s, -0.02f, 0.035f, 0.06f, 10 );
        free_sheet( &s );
        assert_true( k % 2 == 0 ? gap > 0.7 * (double)THICKNESS : gap < 0.0 );
    }
}

// A lying bar: its edges meet those of the sheet. Turned from y to z.
static void a_bar_of_a_millimetre_does_not_pass_at_any_speed( void** state )
{
    (void)state;
    static const float speeds[] = { 0.5f, 5.0f, 20.0f };
    for ( int k = 0; k < 3; ++k )
    {
        const setting with = { WISP_COLLISION_ALL,
                               .rotation = { 0.69f, 0.08f, 0.12f, 0.709f } }; // about x, and a bit about the others
        setting scaled = with;
        const wisp_quat q = with.rotation;
        const float length = sqrtf( q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w );
        scaled.rotation = ( wisp_quat ){ q.x / length, q.y / length, q.z / length, q.w / length };
        const float from = -0.1f;
        sheet s = new_sheet( spike( 0.001f, 0.15f ), from, scaled );
        const double gap = rise( &s, from, k == 0 ? 0.14f : k == 1 ? 0.2f : 0.34f, speeds[k], 10 );

        assert_true( gap > 0.5 * (double)THICKNESS );
        free_sheet( &s );
    }
}

static void a_blade_with_two_sides_does_not_cut( void** state )
{
    (void)state;
    const setting with = { WISP_COLLISION_ALL, .is_held = true, .double_sided = true, .gravity = 10.0f * GRAVITY,
                           .rotation = TURNED };
    sheet s = new_sheet( blade( 0.055f, 0.1f ), -0.02f, with );
    const double gap = rise( &s, -0.02f, 0.04f, 0.06f, 10 );

    assert_true( gap > 0.5 * (double)THICKNESS );
    free_sheet( &s );
}

static double drape( wisp_collision_features features )
{
    const setting with = { features, .gravity = GRAVITY, .rotation = { 0.0f, 0.149438f, 0.0f, 0.988771f } };
    sheet s = new_sheet( box( ( wisp_vec3 ){ 0.1f, 0.05f, 0.08f } ), -0.06f, with );
    assert_int_equal( wisp_set_damping( s.h->world, s.surface, 2.0f ), WISP_OK );
    double least = INFINITY;
    for ( int n = 1; n <= 60; ++n )
    {
        run_for( s.h->world, DT, 1 );
        least = n > 20 && n % 10 == 0 ? fmin( least, gap_of( &s ) ) : least;
    }
    free_sheet( &s );
    return least;
}

static void no_edge_of_a_box_of_triangles_shows_through_a_draped_sheet( void** state )
{
    (void)state;
    const double gap = drape( WISP_COLLISION_ALL );

    assert_true( gap > 0.8 * (double)THICKNESS );
    assert_true( drape( WISP_COLLISION_VERTICES ) < 0.0 );
}

// The same spike as a surface whose vertices are moved: its points move along lines within a step.
static void a_surface_that_is_moved_does_not_pass( void** state )
{
    (void)state;
    static const float speeds[] = { 0.5f, 5.0f, 20.0f };
    for ( int k = 0; k < 3; ++k )
    {
        const setting with = { WISP_COLLISION_ALL, .follows = true, .rotation = TURNED };
        const double gap = spike_gap( with, speeds[k], k == 0 ? 0.06f : k == 1 ? 0.2f : 0.34f );

        assert_true( gap > 0.5 * (double)THICKNESS );
    }
    const setting held = { WISP_COLLISION_ALL, .is_held = true, .follows = true, .gravity = 10.0f * GRAVITY,
                           .rotation = TURNED };
    const double gap = spike_gap( held, 0.06f, 0.04f );

    assert_true( gap > 0.7 * (double)THICKNESS );
}

// A blade that rises at 0.5 m/s and goes aside at 0.25 m/s: friction of its edge gives the sheet half as much momentum aside. A rigid one
// and one whose points move do the same.
static void the_edge_of_a_blade_drags_a_sheet_along( void** state )
{
    (void)state;
    for ( int follows = 0; follows < 2; ++follows )
    {
        const setting with = { WISP_COLLISION_ALL, .double_sided = true, .follows = follows == 1,
                               .rotation = TURNED };
        sheet s = new_sheet( blade( 0.15f, 0.1f ), -0.02f, with );
        for ( int n = 1; n <= 12; ++n )
        {
            s.place.x += 0.25f * DT;
            move_to( &s, -0.02f + 0.5f * DT * (float)n );
            run_for( s.h->world, DT, 1 );
        }
        const wisp_motion_stats q = motion_stats_of( s.h->world, s.surface );
        assert_true( q.momentum[1] > 0.0 );
        assert_true( q.momentum[0] > 0.3 * q.momentum[1] && q.momentum[0] < 0.6 * q.momentum[1] );
        free_sheet( &s );
    }
}

// ---- the rest ----

static uint64_t hash_after( bool follows, bool by_voxels, int workers )
{
    const setting with = { WISP_COLLISION_ALL,     .gravity = GRAVITY, .follows = follows,
                           .by_voxels = by_voxels, .workers = workers, .rotation = TURNED };
    sheet s = new_sheet( box( ( wisp_vec3 ){ 0.06f, 0.05f, 0.06f } ), -0.06f, with );
    for ( int n = 1; n <= 15; ++n )
    {
        move_to( &s, -0.06f + 0.004f * (float)n );
        run_for( s.h->world, DT, 1 );
    }
    const uint64_t hash = wisp_world_hash( s.h->world );
    free_sheet( &s );
    return hash;
}

static void workers_and_the_search_change_no_bit( void** state )
{
    (void)state;
    for ( int follows = 0; follows < 2; ++follows )
    {
        const uint64_t expected = hash_after( follows, false, 1 );
        for ( int workers = 2; workers <= 5; ++workers )
        {
            assert_true( hash_after( follows, false, workers ) == expected );
        }
    }
    assert_true( hash_after( false, true, 2 ) == hash_after( false, false, 1 ) );
}

static void without_memory_for_edges_nothing_changes( void** state )
{
    (void)state;
    const setting with = { WISP_COLLISION_VERTICES, .rotation = TURNED };
    sheet s = new_sheet( box( ( wisp_vec3 ){ 0.06f, 0.05f, 0.06f } ), -0.06f, with );
    run_for( s.h->world, DT, 1 );
    const int passes = wisp_world_plan_passes( s.h->world );
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = THICKNESS;
    collision.features = WISP_COLLISION_ALL;
    bool done = false;
    for ( int n = 1; done == false && n < 100; ++n )
    {
        test_host_refuse( &s.h->host, n, true );
        done = wisp_set_collision( s.h->world, s.surface, &collision ) == WISP_OK;
        test_host_refuse( &s.h->host, 0, false );
        assert_int_equal( wisp_world_plan_passes( s.h->world ), done ? passes + 2 : passes );
        run_for( s.h->world, DT, 1 );
    }
    assert_true( done );
    const int64_t queried = atomic_load( &s.h->host.queried );
    run_for( s.h->world, DT, 5 );
    assert_int_equal( atomic_load( &s.h->host.queried ), queried );
    free_sheet( &s );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( closest_points_are_those_of_the_oracle ),
        cmocka_unit_test( each_edge_of_a_box_is_found_once_and_no_diagonal_of_its_faces ),
        cmocka_unit_test( the_two_nearest_ridges_are_met_and_no_valley ),
        cmocka_unit_test( a_closed_mesh_is_met_from_outside_alone ),
        cmocka_unit_test( a_height_field_has_the_edges_and_corners_of_its_triangles ),
        cmocka_unit_test( no_peak_and_no_ridge_of_a_height_field_shows_through_a_sheet ),
        cmocka_unit_test( a_spike_of_a_millimetre_does_not_pass_a_held_sheet_under_load ),
        cmocka_unit_test( a_spike_that_moves_does_not_pass_at_any_speed ),
        cmocka_unit_test( a_bar_of_a_millimetre_does_not_pass_at_any_speed ),
        cmocka_unit_test( a_blade_with_two_sides_does_not_cut ),
        cmocka_unit_test( no_edge_of_a_box_of_triangles_shows_through_a_draped_sheet ),
        cmocka_unit_test( a_surface_that_is_moved_does_not_pass ),
        cmocka_unit_test( the_edge_of_a_blade_drags_a_sheet_along ),
        cmocka_unit_test( workers_and_the_search_change_no_bit ),
        cmocka_unit_test( without_memory_for_edges_nothing_changes ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
