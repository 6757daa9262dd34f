// The built program, whose path is the first argument, writes and draws boundary points; what it says of
// them is in transcripts/boundary.t.
#include "png_fixture.h"
#include "program_fixture.h"

#include "mesh.h"

static const char ball_scene[] = "wisp: 1\n"
                                 "steps: 4\n"
                                 "substeps: 4\n"
                                 "surfaces:\n"
                                 "  - name: ball\n"
                                 "    generate: { shape: icosphere, level: 2, radius: 0.2 }\n"
                                 "    balloon: { gas_ratio: 1.2, buoyancy: false }\n"
                                 "    boundary: { spacing: 0.015 }\n";

static int enter_folder( void** state )
{
    static const text_file files[] = { { "ball.yaml", ball_scene } };
    return enter_folder_with( state, files, WISP_COUNT( files ) );
}

static void run_well( const char* command )
{
    run_ok( command );
    assert_string_equal( result.err, "" );
}

// ---- files ----

TEST( files_hold_the_vertices_and_behind_them_the_points )
{
    run_well( "run ball.yaml --boundary layer.ply --every 2" );
    assert_non_null( strstr( result.out, "boundary points written: 2 files, the last is layer_0003.ply" ) );
    assert_true( exists( "layer_0002.ply" ) && exists( "layer_0003.ply" ) );
    assert_false( exists( "layer_0001.ply" ) || exists( "layer_0004.ply" ) || exists( "layer.ply" ) );
    int points = 0;
    assert_int_equal( sscanf( strstr( result.out, "ball: " ), "ball: %d", &points ), 1 );
    wisp_mesh mesh;
    wisp_error error = { 0 };
    assert_int_equal( wisp_mesh_read( "layer_0003.ply", &mesh, &error ), WISP_OK );
    assert_int_equal( mesh.vertex_count, 162 + points );
    assert_int_equal( mesh.triangle_count, 320 );
    float least = INFINITY, most = 0.0f;
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        const wisp_vec3 p = mesh.points[v];
        const float radius = sqrtf( p.x * p.x + p.y * p.y + p.z * p.z );
        // The middle of a triangle of level 2, 0.18 rad from its corners, lies 1.7 % below them.
        assert_true( v < 162 || ( radius > 0.97f * least && radius <= most ) );
        least = fminf( least, radius );
        most = fmaxf( most, radius );
    }
    wisp_mesh_release( &mesh );
    run_well( "info layer_0003.ply" );
    assert_non_null( strstr( result.out, "unreferenced vertices" ) );
}

// Rows of the vertices: place, normal, element.
TEST( normals_of_a_file_are_unit_and_points_lie_on_elements )
{
    enum
    {
        VERTICES = 162,
        ELEMENTS = 480 + 320,
    };
    run_well( "run ball.yaml --boundary unit.ply" );
    FILE* file = fopen( "unit_0003.ply", "rb" );
    assert_non_null( file );
    char line[200] = "";
    int count = 0;
    while ( strcmp( line, "end_header\n" ) != 0 )
    {
        assert_non_null( fgets( line, sizeof( line ), file ) );
        (void)sscanf( line, "element vertex %d", &count );
    }
    assert_true( count > 2 * VERTICES );
    int last = 0;
    for ( int v = 0; v < count; ++v )
    {
        float row[6];
        int32_t element;
        assert_int_equal( fread( row, sizeof( float ), 6, file ), 6 );
        assert_int_equal( fread( &element, sizeof( element ), 1, file ), 1 );
        const double x = (double)row[3], y = (double)row[4], z = (double)row[5];
        assert_true( fabs( sqrt( x * x + y * y + z * z ) - 1.0 ) < 1e-6 ); // roundings of floats
        // edges first, then triangles
        assert_true( v < VERTICES ? element == -1 : element >= last && element < ELEMENTS );
        last = v < VERTICES ? 0 : element;
    }
    assert_true( last >= 480 ); // the last points are inside triangles
    assert_int_equal( fclose( file ), 0 );
}

// ---- pictures ----

// Pixels that differ by more than noise; with the same camera and seed there is no noise.
static int count_differing( const char* a, const char* b )
{
    picture p = read_picture( a ), q = read_picture( b );
    assert_true( p.width == q.width && p.height == q.height );
    int count = 0;
    for ( int i = 0; i < p.width * p.height; ++i )
    {
        count += memcmp( p.rgb + 3 * i, q.rgb + 3 * i, 3 ) != 0;
    }
    free( p.rgb );
    free( q.rgb );
    return count;
}

#define SMALL " --size 120x90 --samples 1"

TEST( points_are_drawn_unless_nobody_requests_them )
{
    run_well( "render ball.yaml -o drawn.png" SMALL );
    run_well( "render ball.yaml --boundary normal -o normal.png" SMALL );
    run_well( "render ball.yaml --boundary none -o none.png" SMALL );
    run_well( "render ball.yaml --boundary class -o class.png" SMALL );
    run_well( "render ball.yaml --normals -o lines.png" SMALL );
    run_well( "render ball.yaml --normals --boundary none -o bare.png" SMALL );
    assert_int_equal( count_differing( "drawn.png", "normal.png" ), 0 );
    // balls of 0.3 spacings cover about a quarter of the ball, which has some 3000 of the pixels
    assert_true( count_differing( "drawn.png", "none.png" ) > 300 );
    assert_true( count_differing( "drawn.png", "class.png" ) > 300 );
    assert_true( count_differing( "drawn.png", "lines.png" ) > 30 );
    assert_true( count_differing( "none.png", "bare.png" ) > 30 );
    assert_true( count_differing( "lines.png", "bare.png" ) > 300 );
}

TEST( the_start_shows_its_points )
{
    run_well( "render ball.yaml --frame 0 -o start.png" SMALL );
    run_well( "render ball.yaml --frame 0 --boundary none -o empty.png" SMALL );
    assert_true( count_differing( "start.png", "empty.png" ) > 100 );
    // back from the second frame to the first one: the scene starts again
    run_well( "render ball.yaml --frames 0:2 -o film.png" SMALL );
    assert_true( exists( "film_0003.png" ) );
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
