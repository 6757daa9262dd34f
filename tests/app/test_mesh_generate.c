// Generated meshes: counts, closedness, winding, sizes, and properties of the irregular plane.
#include "mesh_fixture.h"

static const double PI = 3.14159265358979323846;

enum
{
    SOUND = WISP_MESH_ORIENTED | WISP_MESH_MANIFOLD | WISP_MESH_CLEAN | WISP_MESH_ONE_COMPONENT,
};

// Generate, examine and check; the mesh is freed afterwards.
static wisp_mesh_diagnostics sound_report( const wisp_mesh_generator* generator, int demands )
{
    wisp_mesh mesh = fixture_made( generator );
    wisp_mesh_diagnostics report = fixture_report( &mesh );
    wisp_error error = { .status = WISP_OK };
    if ( wisp_mesh_require( &report, demands, "made", &error ) != WISP_OK )
    {
        fail_msg( "shape %d: %s", (int)generator->shape, error.message );
    }
    wisp_mesh_release( &mesh );
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
        wisp_mesh mesh = fixture_made( &generator );
        assert_int_equal( mesh.vertex_count, counts[level] );
        assert_int_equal( mesh.triangle_count, 2 * counts[level] - 4 );
        for ( int v = 0; v < mesh.vertex_count; ++v )
        {
            wisp_vec3 p = mesh.points[v];
            double x = (double)p.x, y = (double)p.y, z = (double)p.z;
            // each coordinate is rounded to a float once
            assert_true( fabs( sqrt( x * x + y * y + z * z ) - 2.0 ) < 2.0 * (double)FLT_EPSILON );
        }
        wisp_mesh_release( &mesh );
    }
}

TEST( round_shapes_have_the_counts_of_their_segments )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_UV_SPHERE );
    generator.segments = generator.rings = 30;
    wisp_mesh_diagnostics report = sound_report( &generator, SOUND | WISP_MESH_CLOSED );
    assert_int_equal( report.vertex_count, 872 );
    assert_int_equal( report.triangle_count, 1740 );
    assert_int_equal( report.edge_count, 2610 );

    generator = wisp_default_mesh_generator( WISP_MESH_TORUS );
    generator.segments = 7, generator.rings = 5;
    report = sound_report( &generator, SOUND | WISP_MESH_CLOSED );
    assert_int_equal( report.vertex_count, 35 );
    assert_int_equal( report.triangle_count, 70 );

    generator = wisp_default_mesh_generator( WISP_MESH_CAPSULE );
    generator.segments = 6, generator.rings = 3, generator.length_segments = 4;
    report = sound_report( &generator, SOUND | WISP_MESH_CLOSED );
    assert_int_equal( report.vertex_count, 6 * 9 + 2 );
    assert_int_equal( report.triangle_count, 2 * 6 * 9 );

    generator = wisp_default_mesh_generator( WISP_MESH_TUBE );
    generator.segments = 5, generator.length_segments = 3;
    report = sound_report( &generator, SOUND );
    assert_int_equal( report.vertex_count, 20 );
    assert_int_equal( report.triangle_count, 30 );
    assert_int_equal( report.open_edges.count, 10 );
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

// ---- planes ----------------------------------------------------------------------------------------------------

TEST( a_regular_plane_is_numbered_row_by_row_and_looks_up )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_REGULAR );
    generator.columns = 3, generator.rows = 2, generator.spacing = 2.0f;
    wisp_mesh mesh = fixture_made( &generator );
    const wisp_vec3 points[] = { { -2, 0, -1 }, { 0, 0, -1 }, { 2, 0, -1 }, { -2, 0, 1 }, { 0, 0, 1 }, { 2, 0, 1 } };
    const int32_t triangles[] = { 0, 3, 4, 0, 4, 1, 1, 4, 5, 1, 5, 2 };
    assert_int_equal( mesh.vertex_count, 6 );
    assert_memory_equal( mesh.points, points, sizeof points );
    assert_int_equal( mesh.triangle_count, 4 );
    assert_memory_equal( mesh.triangles, triangles, sizeof triangles );
    wisp_mesh_release( &mesh );
}

TEST( an_alternating_plane_turns_every_other_diagonal )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_ALTERNATING );
    generator.columns = generator.rows = 3;
    wisp_mesh mesh = fixture_made( &generator );
    const int32_t triangles[] = { 0, 3, 4, 0, 4, 1, 1, 4, 2, 2, 4, 5, 3, 6, 4, 4, 6, 7, 4, 7, 8, 4, 8, 5 };
    assert_int_equal( mesh.triangle_count, 8 );
    assert_memory_equal( mesh.triangles, triangles, sizeof triangles );
    wisp_mesh_release( &mesh );
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
    wisp_mesh mesh = fixture_made( generator );
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
    wisp_mesh_release( &mesh );
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
    wisp_mesh mesh = fixture_made( &generator );
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
    wisp_mesh_release( &mesh );
}

TEST( an_irregular_plane_keeps_a_straight_border )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_IRREGULAR );
    wisp_mesh mesh = fixture_made( &generator );
    wisp_mesh_diagnostics report = fixture_report( &mesh );
    assert_int_equal( report.open_edges.count, 4 * 31 );
    for ( int k = 0; k < 32; ++k )
    {
        assert_true( mesh.points[k].z == mesh.points[0].z && mesh.points[31 * 32 + k].z == -mesh.points[0].z );
        assert_true( mesh.points[32 * k].x == mesh.points[0].x && mesh.points[32 * k + 31].x == -mesh.points[0].x );
    }
    wisp_mesh_release( &mesh );
}

TEST( a_seed_decides_an_irregular_plane_and_nothing_else_does )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_IRREGULAR );
    wisp_mesh first = fixture_made( &generator ), second = fixture_made( &generator );
    assert_same_mesh( &first, &second );
    wisp_mesh_release( &second );
    generator.seed = 2;
    second = fixture_made( &generator );
    assert_memory_not_equal( first.points, second.points, (size_t)first.vertex_count * sizeof *first.points );
    wisp_mesh_release( &first );
    wisp_mesh_release( &second );
}

// ---- refusals --------------------------------------------------------------------------------------------------

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
    r.shape = WISP_MESH_SHAPE_COUNT, demand_refusal( r, "shape: got 12" );
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
