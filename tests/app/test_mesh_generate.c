// Generated meshes: counts, closedness, winding, sizes, and properties of the irregular plane. Flat pieces with a Delaunay
// triangulation: exact counts, exact circles, spacing, seeds, outlines, refusals.
#include "delaunay_fixture.h"
#include "mesh_fixture.h"

static const double PI = 3.14159265358979323846;

enum
{
    SOUND = WISP_MESH_ORIENTED | WISP_MESH_MANIFOLD | WISP_MESH_CLEAN | WISP_MESH_ONE_COMPONENT,
};

// Generate, examine and check; the mesh is freed afterwards.
static wisp_mesh_diagnostics sound_report( const wisp_mesh_generator* generator, int demands )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_made( generator );
    wisp_mesh_diagnostics report = fixture_report( &mesh );
    wisp_error error = { .status = WISP_OK };
    if ( wisp_mesh_require( &report, demands, "made", &error ) != WISP_OK )
    {
        fail_msg( "shape %d: %s", (int)generator->shape, error.message );
    }
    return report;
}

TEST( every_default_generator_makes_a_sound_mesh )
{
    for ( int shape = 0; shape < WISP_MESH_SHAPE_COUNT; ++shape )
    {
        wisp_mesh_generator generator = wisp_default_mesh_generator( (wisp_mesh_shape)shape );
        bool closed = shape >= WISP_MESH_ICOSPHERE && shape != WISP_MESH_TUBE;
        bool hollow = shape == WISP_MESH_TUBE || shape == WISP_MESH_TORUS;
        wisp_mesh_diagnostics report = sound_report( &generator, SOUND | ( closed ? WISP_MESH_CLOSED : 0 ) );
        assert_int_equal( report.euler_characteristic, hollow ? 0 : closed ? 2 : 1 );
        assert_int_equal( report.open_loop_count, closed ? 0 : shape == WISP_MESH_TUBE ? 2 : 1 );
        assert_true( closed ? report.volume > 0.0 : report.volume == 0.0 );
    }
}

TEST( an_icosphere_has_the_vertices_of_its_level_all_on_the_sphere )
{
    static const int counts[] = { 12, 42, 162, 642, 2562, 10242, 40962, 163842 };
    for ( int level = 0; level < WISP_COUNT( counts ); ++level )
    {
        wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_ICOSPHERE );
        generator.level = level;
        generator.radius = 2.0f;
        SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_made( &generator );
        assert_int_equal( mesh.vertex_count, counts[level] );
        assert_int_equal( mesh.triangle_count, 2 * counts[level] - 4 );
        for ( int v = 0; v < mesh.vertex_count; ++v )
        {
            wisp_vec3 p = mesh.points[v];
            double x = (double)p.x, y = (double)p.y, z = (double)p.z;
            // each coordinate is rounded to a float once
            assert_true( fabs( sqrt( x * x + y * y + z * z ) - 2.0 ) < 2.0 * (double)FLT_EPSILON );
        }
    }
}

TEST( round_shapes_have_the_counts_of_their_segments )
{
    static const struct
    {
        wisp_mesh_shape shape;
        int segments, rings, length_segments, vertices, triangles, open_edges;
    } cases[] = {
        { WISP_MESH_UV_SPHERE, 30, 30, 1, 872, 1740, 0 },
        { WISP_MESH_TORUS, 7, 5, 1, 35, 70, 0 },
        { WISP_MESH_CAPSULE, 6, 3, 4, 6 * 9 + 2, 2 * 6 * 9, 0 },
        { WISP_MESH_TUBE, 5, 1, 3, 20, 30, 10 },
    };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        wisp_mesh_generator generator = wisp_default_mesh_generator( cases[i].shape );
        generator.segments = cases[i].segments;
        generator.rings = cases[i].rings;
        generator.length_segments = cases[i].length_segments;
        const wisp_mesh_diagnostics report =
            sound_report( &generator, SOUND | ( cases[i].open_edges == 0 ? WISP_MESH_CLOSED : 0 ) );
        assert_int_equal( report.vertex_count, cases[i].vertices );
        assert_int_equal( report.triangle_count, cases[i].triangles );
        assert_int_equal( report.open_edges.count, cases[i].open_edges );
        assert_int_equal( 2 * report.edge_count, 3 * cases[i].triangles + cases[i].open_edges );
    }
}

TEST( the_smallest_round_shapes_are_sound_too )
{
    static const wisp_mesh_shape shapes[] = { WISP_MESH_UV_SPHERE, WISP_MESH_TORUS, WISP_MESH_CAPSULE,
                                              WISP_MESH_TUBE };
    static const int rings[] = { 2, 3, 1, 1 };
    for ( int i = 0; i < WISP_COUNT( shapes ); ++i )
    {
        wisp_mesh_generator generator = wisp_default_mesh_generator( shapes[i] );
        generator.segments = 3;
        generator.rings = rings[i];
        generator.length_segments = 1;
        sound_report( &generator, SOUND | ( shapes[i] == WISP_MESH_TUBE ? 0 : WISP_MESH_CLOSED ) );
    }
}

TEST( fine_shapes_come_near_the_volumes_of_smooth_ones )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_UV_SPHERE );
    generator.segments = 200, generator.rings = 100, generator.length_segments = 50;
    // with a = 2 pi / 200, chords around the axis lose a^2 / 6 of the volume and chords along a meridian a^2 / 4
    double tolerance = 4.2e-4;
    assert_true( fabs( sound_report( &generator, SOUND ).volume / ( PI / 6.0 ) - 1.0 ) < tolerance );
    generator.shape = WISP_MESH_CAPSULE;
    assert_true( fabs( sound_report( &generator, SOUND ).volume / ( PI / 6.0 + PI / 4.0 ) - 1.0 ) < tolerance );
    generator.shape = WISP_MESH_TUBE;
    assert_true( fabs( sound_report( &generator, SOUND ).area / PI - 1.0 ) < tolerance );
    generator.shape = WISP_MESH_TORUS;
    generator.rings = 200;
    assert_true( fabs( sound_report( &generator, SOUND ).volume / ( 2.0 * PI * PI * 0.5 * 0.04 ) - 1.0 ) <
                 tolerance );
}

TEST( a_pear_has_its_centre_off_the_origin_and_all_three_extents_differ )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PEAR );
    wisp_mesh_diagnostics r = sound_report( &generator, SOUND | WISP_MESH_CLOSED );
    float x = r.highest.x - r.lowest.x, y = r.highest.y - r.lowest.y, z = r.highest.z - r.lowest.z;
    assert_true( y > 1.1f * x && x > 1.1f * z );
    assert_true( r.highest.x + r.lowest.x > 0.1f * generator.radius );
}

// ---- planes ----

TEST( a_regular_plane_is_numbered_row_by_row_and_looks_up )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_REGULAR );
    generator.columns = 3, generator.rows = 2, generator.spacing = 2.0f;
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_made( &generator );
    const wisp_vec3 points[] = { { -2, 0, -1 }, { 0, 0, -1 }, { 2, 0, -1 }, { -2, 0, 1 }, { 0, 0, 1 }, { 2, 0, 1 } };
    const int32_t triangles[] = { 0, 3, 4, 0, 4, 1, 1, 4, 5, 1, 5, 2 };
    assert_int_equal( mesh.vertex_count, 6 );
    assert_memory_equal( mesh.points, points, sizeof points );
    assert_int_equal( mesh.triangle_count, 4 );
    assert_memory_equal( mesh.triangles, triangles, sizeof triangles );
}

TEST( an_alternating_plane_turns_every_other_diagonal )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_ALTERNATING );
    generator.columns = generator.rows = 3;
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_made( &generator );
    const int32_t triangles[] = { 0, 3, 4, 0, 4, 1, 1, 4, 2, 2, 4, 5, 3, 6, 4, 4, 6, 7, 4, 7, 8, 4, 8, 5 };
    assert_int_equal( mesh.triangle_count, 8 );
    assert_memory_equal( mesh.triangles, triangles, sizeof triangles );
}

// Twice the area in the plane, seen from above.
static double cross( const wisp_mesh* mesh, int a, int b, int c )
{
    const wisp_vec3* p = mesh->points;
    return ( (double)p[b].z - (double)p[a].z ) * ( (double)p[c].x - (double)p[a].x ) -
           ( (double)p[b].x - (double)p[a].x ) * ( (double)p[c].z - (double)p[a].z );
}

static double smallest_angle_degrees( const wisp_mesh* mesh, int t )
{
    const int32_t* c = mesh->triangles + 3 * t;
    double least = 180.0;
    for ( int k = 0; k < 3; ++k )
    {
        wisp_vec3 a = mesh->points[c[k]], b = mesh->points[c[( k + 1 ) % 3]], d = mesh->points[c[( k + 2 ) % 3]];
        double ux = (double)( b.x - a.x ), uz = (double)( b.z - a.z );
        double vx = (double)( d.x - a.x ), vz = (double)( d.z - a.z );
        least = fmin( least, atan2( fabs( uz * vx - ux * vz ), ux * vx + uz * vz ) * 180.0 / PI );
    }
    return least;
}

// Whether vertex v is inside the circle around triangle t, from the circle's centre rather than from a determinant,
// and for all vertices rather than for neighbours.
static bool circle_holds( const wisp_mesh* mesh, int t, int v )
{
    const int32_t* c = mesh->triangles + 3 * t;
    const wisp_vec3* p = mesh->points;
    double bx = (double)p[c[1]].x - (double)p[c[0]].x, bz = (double)p[c[1]].z - (double)p[c[0]].z;
    double dx = (double)p[c[2]].x - (double)p[c[0]].x, dz = (double)p[c[2]].z - (double)p[c[0]].z;
    double scale = 2.0 * ( bx * dz - bz * dx ), b2 = bx * bx + bz * bz, d2 = dx * dx + dz * dz;
    double x = ( dz * b2 - bz * d2 ) / scale, z = ( bx * d2 - dx * b2 ) / scale;
    double vx = (double)p[v].x - (double)p[c[0]].x - x, vz = (double)p[v].z - (double)p[c[0]].z - z;
    // the generator counts points within 1e-9 of a circle as on it
    return vx * vx + vz * vz < ( x * x + z * z ) * ( 1.0 - 1e-6 );
}

static void assert_irregular_is_sound( const wisp_mesh_generator* generator )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_made( generator );
    wisp_mesh_diagnostics report = fixture_report( &mesh );
    assert_int_equal( wisp_mesh_require( &report, SOUND, "plane", NULL ), WISP_OK );
    assert_int_equal( report.euler_characteristic, 1 );
    double width = ( generator->columns - 1 ) * (double)generator->spacing;
    double depth = ( generator->rows - 1 ) * (double)generator->spacing, area = 0.0;
    for ( int t = 0; t < mesh.triangle_count; ++t )
    {
        const int32_t* c = mesh.triangles + 3 * t;
        assert_true( cross( &mesh, c[0], c[1], c[2] ) > 0.0 );
        area += 0.5 * cross( &mesh, c[0], c[1], c[2] );
    }
    // no triangle is reversed and the areas sum to that of the rectangle: they cover it once
    assert_true( fabs( area / ( width * depth ) - 1.0 ) < 1e-5 );
}

TEST( an_irregular_plane_covers_its_rectangle_once_for_many_seeds_and_counts )
{
    for ( int seed = 0; seed < 60; ++seed )
    {
        wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_IRREGULAR );
        generator.seed = (uint64_t)seed;
        generator.columns = 3 + seed % 17;
        generator.rows = 2 + seed % 23;
        generator.vertex_count = seed % 4 == 0 ? 0 : generator.columns * generator.rows * ( 6 + seed % 7 ) / 8;
        if ( generator.vertex_count / generator.rows < 2 )
        {
            generator.vertex_count = 0;
        }
        assert_irregular_is_sound( &generator );
    }
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_IRREGULAR );
    generator.columns = generator.rows = 300;
    generator.vertex_count = 300 * 300 + 151;
    assert_irregular_is_sound( &generator );
    generator.jitter = 0.0f;
    assert_irregular_is_sound( &generator );
}

TEST( an_irregular_plane_of_958_vertices_is_delaunay_and_well_shaped )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_IRREGULAR );
    generator.columns = generator.rows = 31;
    generator.vertex_count = 958;
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_made( &generator );
    assert_int_equal( mesh.vertex_count, 958 );
    double least = 180.0, sum = 0.0;
    for ( int t = 0; t < mesh.triangle_count; ++t )
    {
        for ( int v = 0; v < mesh.vertex_count; ++v )
        {
            assert_false( circle_holds( &mesh, t, v ) );
        }
        double angle = smallest_angle_degrees( &mesh, t );
        least = fmin( least, angle );
        sum += angle;
    }
    // a square cut in two has 45 degrees; shifts of a fifth on both ends of an edge leave at least half of that
    assert_true( least > 20.0 );
    assert_true( sum / mesh.triangle_count > 38.0 );
}

TEST( an_irregular_plane_keeps_a_straight_border )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_IRREGULAR );
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_made( &generator );
    wisp_mesh_diagnostics report = fixture_report( &mesh );
    assert_int_equal( report.open_edges.count, 4 * 31 );
    for ( int k = 0; k < 32; ++k )
    {
        assert_true( mesh.points[k].z == mesh.points[0].z && mesh.points[31 * 32 + k].z == -mesh.points[0].z );
        assert_true( mesh.points[32 * k].x == mesh.points[0].x && mesh.points[32 * k + 31].x == -mesh.points[0].x );
    }
}

TEST( a_seed_decides_an_irregular_plane_and_nothing_else_does )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_IRREGULAR );
    SCOPED( wisp_mesh_release ) wisp_mesh first = fixture_made( &generator ), second = fixture_made( &generator );
    assert_same_mesh( &first, &second );
    wisp_mesh_release( &second );
    generator.seed = 2;
    second = fixture_made( &generator );
    assert_memory_not_equal( first.points, second.points, (size_t)first.vertex_count * sizeof *first.points );
}

// ---- refusals ----

static void demand_refusal( wisp_mesh_generator generator, const char* words )
{
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_generate( &generator, &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, words );
    assert_null( mesh.points );
    assert_null( mesh.triangles );
}

TEST( a_generator_that_cannot_be_made_is_refused_by_the_name_of_its_value )
{
    wisp_mesh_generator plane = wisp_default_mesh_generator( WISP_MESH_PLANE_IRREGULAR ), r = plane;
    r.shape = WISP_MESH_SHAPE_COUNT, demand_refusal( r, "shape: got 11" );
    r = plane, r.columns = 1, demand_refusal( r, "columns: got 1" );
    r = plane, r.rows = -5, demand_refusal( r, "rows: got -5" );
    r = plane, r.columns = r.rows = 1 << 20, demand_refusal( r, "1048576 times 1048576 vertices" );
    r = plane, r.vertex_count = 63, demand_refusal( r, "vertex count: got 63" );
    r = plane, r.vertex_count = 1 << 26, demand_refusal( r, "vertex count: got 67108864" );
    r = plane, r.spacing = 0.0f, demand_refusal( r, "spacing: got 0" );
    r = plane, r.jitter = 0.5f, demand_refusal( r, "jitter: got 0.5" );
    r = plane, r.jitter = NAN, demand_refusal( r, "jitter: got nan" );
    r = wisp_default_mesh_generator( WISP_MESH_ICOSPHERE ), r.level = 11, demand_refusal( r, "level: got 11" );
    r = wisp_default_mesh_generator( WISP_MESH_PEAR ), r.radius = -1.0f, demand_refusal( r, "radius: got -1" );
    r = wisp_default_mesh_generator( WISP_MESH_TORUS ), r.tube_radius = 0.5f,
    demand_refusal( r, "tube radius: got 0.5" );
    r = wisp_default_mesh_generator( WISP_MESH_TORUS ), r.rings = 2, demand_refusal( r, "rings: got 2" );
    r = wisp_default_mesh_generator( WISP_MESH_UV_SPHERE ), r.segments = 2, demand_refusal( r, "segments: got 2" );
    r = wisp_default_mesh_generator( WISP_MESH_TUBE ), r.length = INFINITY, demand_refusal( r, "length: got inf" );
    r = wisp_default_mesh_generator( WISP_MESH_CAPSULE ), r.length_segments = 0;
    demand_refusal( r, "length segments: got 0" );
}

// Default generators, seed 1: their hash_of() with every compiler.
static const uint64_t HASH_SQUARE = 0x560ead8ca2e4c670u;
static const uint64_t HASH_GARMENT = 0x913cc0963555b524u;

enum
{
    PAPER_COUNT = 958, // vertices of the cloth whose time Noh and Jung publish
};

static wisp_mesh_generator generator_of( wisp_mesh_shape shape, int vertex_count, uint64_t seed )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( shape );
    generator.vertex_count = vertex_count;
    generator.seed = seed;
    return generator;
}

static wisp_mesh made( wisp_mesh_shape shape, int vertex_count, uint64_t seed )
{
    wisp_mesh_generator generator = generator_of( shape, vertex_count, seed );
    return fixture_made( &generator );
}

// The positions of a mesh's vertices; the plane's first coordinate is z, so that y points at the viewer. To be freed.
static delaunay_point* places_of( const wisp_mesh* mesh )
{
    SCOPED( free_local ) double* coordinates = malloc( (size_t)mesh->vertex_count * 2 * sizeof *coordinates );
    delaunay_point* places = malloc( (size_t)mesh->vertex_count * sizeof *places );
    assert_true( coordinates != NULL && places != NULL );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        assert_true( mesh->points[v].y == 0.0f );
        coordinates[2 * v] = (double)mesh->points[v].z;
        coordinates[2 * v + 1] = (double)mesh->points[v].x;
    }
    assert_int_equal( delaunay_snap( coordinates, mesh->vertex_count, places, "mesh", NULL ), WISP_OK );
    return places;
}

// Covered once, connected, Delaunay and without a defect. The border has the first numbers.
static void assert_mesh_sound( const wisp_mesh* mesh, bool every_circle )
{
    wisp_mesh_diagnostics report = fixture_report( mesh );
    wisp_error error = { .status = WISP_OK };
    if ( wisp_mesh_require( &report, SOUND, "mesh", &error ) != WISP_OK )
    {
        fail_msg( "%d vertices: %s", mesh->vertex_count, error.message );
    }
    assert_int_equal( report.euler_characteristic, 1 );
    assert_int_equal( report.open_loop_count, 1 );
    SCOPED( free_local ) delaunay_point* places = places_of( mesh );
    fixture_net net = { places, mesh->vertex_count, report.open_edges.count, mesh->triangles, mesh->triangle_count };
    assert_int_equal( net.triangle_count, delaunay_triangle_count( net.count, net.outline_count ) );
    assert_covers( &net );
    assert_joined_and_delaunay( &net );
    if ( every_circle )
    {
        assert_empty_circles( &net );
    }
}

// FNV-1a over points and triangles.
static uint64_t hash_of( const wisp_mesh* mesh )
{
    uint64_t hash = 0xcbf29ce484222325u;
    const unsigned char* bytes[] = { (const unsigned char*)mesh->points, (const unsigned char*)mesh->triangles };
    size_t sizes[] = { (size_t)mesh->vertex_count * sizeof *mesh->points,
                       (size_t)mesh->triangle_count * 3 * sizeof *mesh->triangles };
    for ( int part = 0; part < 2; ++part )
    {
        for ( size_t i = 0; i < sizes[part]; ++i )
        {
            hash = ( hash ^ bytes[part][i] ) * 0x100000001b3u;
        }
    }
    return hash;
}

// ---- the square ----

TEST( a_square_of_958_vertices_is_delaunay_for_many_seeds )
{
    for ( uint64_t seed = 0; seed < 8; ++seed )
    {
        SCOPED( wisp_mesh_release ) wisp_mesh mesh = made( WISP_MESH_DELAUNAY, PAPER_COUNT, seed );
        assert_int_equal( mesh.vertex_count, PAPER_COUNT );
        assert_mesh_sound( &mesh, true );
        wisp_mesh_diagnostics report = fixture_report( &mesh );
        assert_true( report.lowest.x == -0.5f && report.lowest.z == -0.5f );
        assert_true( report.highest.x == 0.5f && report.highest.z == 0.5f );
        // every triangle's area was compared with the square's in integers; these are floats of it
        assert_true( fabs( report.area - 1.0 ) < 1e-6 );
    }
}

TEST( every_count_is_met_exactly )
{
    for ( int count = 4; count < 300; ++count )
    {
        wisp_mesh_generator generator = generator_of( WISP_MESH_DELAUNAY, count, (uint64_t)count );
        generator.depth = 0.01f * (float)( 1 + count % 7 * 37 );
        wisp_mesh mesh = fixture_made( &generator );
        assert_int_equal( mesh.vertex_count, count );
        assert_mesh_sound( &mesh, count % 16 == 0 );
        wisp_mesh_release( &mesh );
        if ( count >= 64 )
        {
            mesh = made( WISP_MESH_GARMENT, count, (uint64_t)count );
            assert_int_equal( mesh.vertex_count, count );
            assert_mesh_sound( &mesh, count % 16 == 0 );
            wisp_mesh_release( &mesh );
        }
    }
}

TEST( ten_thousand_and_a_hundred_thousand_vertices_are_delaunay_too )
{
    static const int counts[] = { 10000, 100000 };
    for ( int i = 0; i < 2 * WISP_COUNT( counts ); ++i )
    {
        SCOPED( wisp_mesh_release )
        wisp_mesh mesh = made( i % 2 ? WISP_MESH_GARMENT : WISP_MESH_DELAUNAY, counts[i / 2], 5 );
        assert_int_equal( mesh.vertex_count, counts[i / 2] );
        assert_mesh_sound( &mesh, false );
    }
}

TEST( the_longest_strips_are_made )
{
    wisp_mesh_generator generator = generator_of( WISP_MESH_DELAUNAY, 20000, 1 );
    generator.width = 1e-3f;
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_made( &generator );
    assert_mesh_sound( &mesh, false );
    wisp_mesh_release( &mesh );
    generator.width = 1e6f, generator.depth = 1e3f, generator.vertex_count = 101;
    mesh = fixture_made( &generator );
    assert_mesh_sound( &mesh, true );
}

TEST( triangles_of_a_square_are_neither_thin_nor_of_very_different_size )
{
    for ( uint64_t seed = 0; seed < 20; ++seed )
    {
        SCOPED( wisp_mesh_release ) wisp_mesh mesh = made( WISP_MESH_DELAUNAY, PAPER_COUNT, seed );
        wisp_mesh_diagnostics report = fixture_report( &mesh );
        for ( int t = 0; t < mesh.triangle_count; ++t )
        {
            assert_true( smallest_angle_degrees( &mesh, t ) > 20.0 );
        }
        // Edges are at least as long as the darts' distance d, or on the border as most of the spacing h, and a
        // circle wider than h would have accepted another dart: an angle is at least asin( d / 2 h ), and d ends
        // between 0.75 and 0.8 h.
        assert_true( report.min_edge > 0.5 * report.edge_mean && report.max_edge < 2.0 * report.edge_mean );
    }
}

TEST( the_border_of_a_square_is_even_and_comes_first )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = made( WISP_MESH_DELAUNAY, PAPER_COUNT, 1 );
    int border = fixture_report( &mesh ).open_edges.count;
    assert_true( border % 4 == 0 );
    for ( int v = 0; v < border; ++v )
    {
        float along = -0.5f + (float)( v % ( border / 4 ) ) / ( 0.25f * (float)border );
        // counter-clockwise seen from above, from the corner of lowest x and z along z
        const wisp_vec3 sides[] = {
            { -0.5f, 0, along }, { along, 0, 0.5f }, { 0.5f, 0, -along }, { -along, 0, -0.5f }
        };
        wisp_vec3 expected = sides[4 * v / border];
        // two roundings of a float below 1
        assert_true( fabsf( mesh.points[v].x - expected.x ) < 2e-7f );
        assert_true( fabsf( mesh.points[v].z - expected.z ) < 2e-7f );
    }
}

TEST( a_seed_decides_the_inside_and_nothing_else_does )
{
    wisp_mesh first = made( WISP_MESH_DELAUNAY, PAPER_COUNT, 1 ), again = made( WISP_MESH_DELAUNAY, PAPER_COUNT, 1 );
    assert_same_mesh( &first, &again );
    // the same on every machine and with every compiler
    assert_true( hash_of( &first ) == HASH_SQUARE );
    SCOPED( wisp_mesh_release ) wisp_mesh other = made( WISP_MESH_DELAUNAY, PAPER_COUNT, 2 );
    assert_true( hash_of( &other ) != HASH_SQUARE );
    int border = fixture_report( &first ).open_edges.count;
    assert_memory_equal( first.points, other.points, (size_t)border * sizeof *first.points );
    wisp_mesh_release( &first );
    wisp_mesh_release( &again );
    wisp_mesh_release( &other );
    other = made( WISP_MESH_GARMENT, PAPER_COUNT, 1 );
    assert_true( hash_of( &other ) == HASH_GARMENT );
}

// ---- the garment ----

TEST( a_garment_has_vertices_of_valence_5_7_and_8_inside )
{
    for ( uint64_t seed = 1; seed <= 5; ++seed )
    {
        SCOPED( wisp_mesh_release ) wisp_mesh mesh = made( WISP_MESH_GARMENT, PAPER_COUNT, seed );
        int valences[PAPER_COUNT] = { 0 }, counts[64] = { 0 };
        int border = fixture_report( &mesh ).open_edges.count;
        for ( int h = 0; h < 3 * mesh.triangle_count; ++h )
        {
            ++valences[mesh.triangles[h]];
        }
        for ( int v = border; v < mesh.vertex_count; ++v )
        {
            assert_true( valences[v] >= 3 && valences[v] < WISP_COUNT( counts ) );
            ++counts[valences[v]];
        }
        assert_true( counts[5] > 50 && counts[6] > 100 && counts[7] > 50 && counts[8] > 10 );
    }
}

static double border_edge( const wisp_mesh* mesh, int border, int v )
{
    wisp_vec3 a = mesh->points[v], b = mesh->points[( v + 1 ) % border];
    return hypot( (double)b.x - (double)a.x, (double)b.z - (double)a.z );
}

TEST( the_curves_of_a_garment_are_denser_than_its_hem )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = made( WISP_MESH_GARMENT, PAPER_COUNT, 1 );
    assert_mesh_sound( &mesh, true );
    int border = fixture_report( &mesh ).open_edges.count;
    double hem = 0.0, curve = 0.0;
    for ( int v = 0; v < border; ++v )
    {
        wisp_vec3 a = mesh.points[v], b = mesh.points[( v + 1 ) % border];
        double length = border_edge( &mesh, border, v );
        bool on_hem = a.z == 0.35f && b.z == 0.35f;
        bool on_neckline = fabsf( a.x ) < 0.15f * 0.55f && a.z < 0.0f;
        hem = on_hem ? fmax( hem, length ) : hem;
        curve = on_neckline ? fmax( curve, length ) : curve;
    }
    // three times as dense, and pieces are whole: the last of them may be up to a half shorter
    assert_true( hem > 0.0 && curve > 0.0 && curve < 0.5 * hem );
    wisp_mesh_diagnostics report = fixture_report( &mesh );
    assert_true( report.highest.x == -report.lowest.x && report.highest.z == -report.lowest.z );
}

// ---- custom outlines ----

static const wisp_mesh_corner L_SHAPE[] = { { 0, 0, 1 }, { 0, 3, 1 }, { 1, 3, 1 },
                                            { 1, 1, 8 }, { 4, 1, 1 }, { 4, 0, 1 } };

TEST( an_outline_with_a_notch_is_filled_and_keeps_its_corners )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh;
    assert_int_equal( wisp_mesh_generate_flat( L_SHAPE, WISP_COUNT( L_SHAPE ), 700, 1, &mesh, NULL ), WISP_OK );
    assert_int_equal( mesh.vertex_count, 700 );
    assert_mesh_sound( &mesh, true );
    assert_true( fabs( fixture_report( &mesh ).area - 6.0 ) < 1e-5 );
    for ( int c = 0; c < WISP_COUNT( L_SHAPE ); ++c )
    {
        int found = 0;
        for ( int v = 0; v < mesh.vertex_count; ++v )
        {
            found += mesh.points[v].x == L_SHAPE[c].x && mesh.points[v].z == L_SHAPE[c].z;
        }
        assert_int_equal( found, 1 );
    }
}

TEST( a_border_may_take_all_vertices )
{
    wisp_mesh_corner corners[WISP_COUNT( L_SHAPE )];
    memcpy( corners, L_SHAPE, sizeof corners );
    for ( int c = 0; c < WISP_COUNT( corners ); ++c )
    {
        corners[c].density = 16.0f;
    }
    for ( int count = WISP_COUNT( corners ); count < 120; ++count )
    {
        SCOPED( wisp_mesh_release ) wisp_mesh mesh;
        assert_int_equal( wisp_mesh_generate_flat( corners, WISP_COUNT( corners ), count, 1, &mesh, NULL ), WISP_OK );
        assert_int_equal( mesh.vertex_count, count );
        assert_mesh_sound( &mesh, true );
    }
}

// ---- refusals ----

static void demand_flat_refusal( const wisp_mesh_corner* corners, int corner_count, int vertex_count,
                                 const char* words )
{
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_generate_flat( corners, corner_count, vertex_count, 1, &mesh, &error ),
                      WISP_BAD_INPUT );
    assert_contains( error.message, words );
    assert_null( mesh.points );
    assert_null( mesh.triangles );
}

TEST( an_outline_that_cannot_be_filled_is_refused_by_its_corner )
{
    const wisp_mesh_corner intersection[] = { { 0, 0, 1 },  { 2, 3, 1 }, { 1, 3, 1 },
                                              { 1, -1, 1 }, { 5, 2, 1 }, { 5, 0, 1 } };
    demand_flat_refusal( intersection, 6, 100, "the outline crosses itself: from point " );
    const wisp_mesh_corner clockwise[] = { { 0, 0, 1 }, { 1, 0, 1 }, { 1, 1, 1 } };
    demand_flat_refusal( clockwise, 3, 100, "runs clockwise" );
    const wisp_mesh_corner twice[] = { { 0, 0, 1 }, { 0, 1, 1 }, { 1, 1, 1 }, { 1, 1, 1 } };
    demand_flat_refusal( twice, 4, 100, "points 2 and 3 are at the same place" );
    const wisp_mesh_corner thin[] = { { 0, 0, 1 }, { 0, 1, 1 }, { 2000, 1, 1 } };
    demand_flat_refusal( thin, 3, 100, "is too slender" );
    const wisp_mesh_corner line[] = { { 0, 0, 1 }, { 1, 1, 1 }, { 2, 2, 1 } };
    demand_flat_refusal( line, 3, 100, "an area of 0 m^2" );
    const wisp_mesh_corner point[] = { { 1, 1, 1 }, { 1, 1, 1 }, { 1, 1, 1 } };
    demand_flat_refusal( point, 3, 100, "the 3 points span 0" );
    demand_flat_refusal( L_SHAPE, 6, 5, "5 vertices, 6 of them corners" );
    demand_flat_refusal( L_SHAPE, 2, 5, "5 vertices, 2 of them corners" );
    demand_flat_refusal( L_SHAPE, 6, WISP_MESH_VERTEX_CAP + 1, "67108865 vertices" );
    wisp_mesh_corner bad[6];
    memcpy( bad, L_SHAPE, sizeof bad );
    bad[4].z = NAN, demand_flat_refusal( bad, 6, 100, "corner 4: got (4, nan)" );
    bad[4].z = 2e6f, demand_flat_refusal( bad, 6, 100, "corner 4: got (4, 2e+06)" );
    bad[4].z = 1, bad[2].density = 0.5f, demand_flat_refusal( bad, 6, 100, "density of corner 2: got 0.5" );
    bad[2].density = NAN, demand_flat_refusal( bad, 6, 100, "density of corner 2: got nan" );
}

TEST( a_flat_generator_that_cannot_be_made_is_refused_by_the_name_of_its_value )
{
    wisp_mesh_generator r = wisp_default_mesh_generator( WISP_MESH_DELAUNAY );
    r.vertex_count = 3, demand_refusal( r, "vertex count: got 3, expected 4 .. 67108864" );
    r.vertex_count = 958, r.width = 0.0f, demand_refusal( r, "width: got 0" );
    r.width = NAN, demand_refusal( r, "width: got nan" );
    r.width = 1.0f, r.depth = 0.9e-3f, demand_refusal( r, "depth: got 0.0009, expected 0.001 .. 1000" );
    r = wisp_default_mesh_generator( WISP_MESH_GARMENT );
    r.vertex_count = 63, demand_refusal( r, "vertex count: got 63, expected 64 .. 67108864" );
}
