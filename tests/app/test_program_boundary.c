// The built program, whose path is the first argument, reports boundary points and contact, writes the points, and
// draws them.
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

static const char two_balls_scene[] = "wisp: 1\n"
                                      "steps: 3\n"
                                      "substeps: 4\n"
                                      "contact: { compute: [stats, intersections] }\n"
                                      "surfaces:\n"
                                      "  - name: left\n"
                                      "    generate: { shape: icosphere, level: 2, radius: 0.2 }\n"
                                      "    balloon: { gas_ratio: 1.1, buoyancy: false }\n"
                                      "    boundary: { spacing: 0.02 }\n"
                                      "    contact: {}\n"
                                      "  - name: right\n"
                                      "    instance_of: left\n"
                                      "    transform: { translate: [0.45, 0, 0] }\n"
                                      "    balloon: { gas_ratio: 1.1, buoyancy: false }\n"
                                      "    boundary: {}\n"
                                      "    contact: {}\n";

static const char plain_scene[] = "wisp: 1\n"
                                  "steps: 2\n"
                                  "surfaces:\n"
                                  "  - { name: cloth, generate: { shape: plane, columns: 4, rows: 4 }, cloth: {} }\n";

// A cloth that hangs through a level one, both without contact.
static const char through_scene[] =
    "wisp: 1\n"
    "steps: 3\n"
    "surfaces:\n"
    "  - name: level\n"
    "    generate: { shape: plane, columns: 6, rows: 6, spacing: 0.1 }\n"
    "    pins: [0, 5, 30, 35]\n"
    "    cloth: {}\n"
    "  - name: upright\n"
    "    generate: { shape: plane, columns: 6, rows: 6, spacing: 0.1 }\n"
    "    transform: { rotate: { axis: [1, 0, 0], degrees: 80 }, translate: [0.033, 0, 0] }\n"
    "    pins: [0, 5]\n"
    "    cloth: {}\n";

static int enter_folder( void** state )
{
    static const text_file files[] = { { "ball.yaml", ball_scene },
                                       { "two.yaml", two_balls_scene },
                                       { "plain.yaml", plain_scene },
                                       { "through.yaml", through_scene } };
    return enter_folder_with( state, files, WISP_COUNT( files ) );
}

static void run_well( const char* command )
{
    run_ok( command );
    assert_string_equal( result.err, "" );
}

// ---- reports ----

TEST( a_run_tells_how_many_points_there_are_and_how_much_was_resampled )
{
    run_well( "run ball.yaml" );
    const char* line = strstr( result.out, "ball: " );
    assert_non_null( line );
    int points = 0, edge_points = 0, inner_points = 0, elements = 0;
    double fraction = -1.0;
    assert_int_equal(
        sscanf( line, "ball: %d boundary points: %d on edges, %d in triangles; resampled %lf %% of %d elements",
                &points, &edge_points, &inner_points, &fraction, &elements ),
        5 );
    assert_true( points > 500 && points == edge_points + inner_points );
    assert_true( fraction >= 0.0 && fraction <= 100.0 );
    // 480 edges and 320 triangles
    assert_int_equal( elements, 800 );
    assert_non_null( strstr( result.out, "boundary points, whole run: " ) );
    assert_null( strstr( result.out, "contact" ) );
}

TEST( a_run_tells_of_contact_where_stats_are_requested )
{
    run_well( "run two.yaml" );
    assert_non_null( strstr( result.out, "contact: 2 entities, " ) );
    assert_non_null( strstr( result.out, ", 0 intersections, " ) );
    run_well( "run plain.yaml" );
    assert_null( strstr( result.out, "contact" ) );
    assert_null( strstr( result.out, "oundary" ) );
}

TEST( a_run_counts_intersections_and_moves_no_vertex_by_that )
{
    run_well( "run two.yaml -v" ); // by the key of the scene
    assert_non_null( strstr( result.out, "intersections  none in 3 steps" ) );
    assert_null( strstr( result.out, "Intersections" ) );
    run_well( "run plain.yaml --intersections" );
    assert_non_null( strstr( result.out, "intersections  none in 2 steps" ) );
    run_well( "run through.yaml --record alone.obj" );
    assert_null( strstr( result.out, "ntersections" ) );
    run_well( "run through.yaml --record seen.obj --intersections -v" );
    size_t size, seen_size;
    char *alone = read_bytes( "alone_0004.obj", &size ), *seen = read_bytes( "seen_0004.obj", &seen_size );
    assert_int_equal( size, seen_size );
    assert_memory_equal( alone, seen, size );
    free( alone );
    free( seen );
    const char* line = strstr( result.out, "intersections  in 3 of 3 steps; at most " );
    const char* row = strstr( result.out, "level  upright" );
    int most = 0, at = 0, left = 0, of_pair[4] = { 0 };
    assert_non_null( line );
    assert_non_null( row );
    assert_int_equal(
        sscanf( line, "intersections in 3 of 3 steps; at most %d, in step %d; %d at the end", &most, &at, &left ),
        3 );
    assert_int_equal( sscanf( row, "level upright %d %d %d %d", of_pair, of_pair + 1, of_pair + 2, of_pair + 3 ), 4 );
    assert_true( most > 0 && left > 0 && most >= left && at >= 1 && at <= 3 );
    assert_true( of_pair[0] == 3 && of_pair[1] == most && of_pair[2] == at && of_pair[3] == left );
    run_well( "run through.yaml --intersections --format json" );
    char text[60];
    snprintf( text, sizeof text, "\"max_intersections\": %d", most );
    assert_non_null( strstr( result.out, text ) );
    assert_non_null( strstr( result.out, "\"steps_with_intersections\": 3" ) );
}

TEST( machines_get_a_row_a_step )
{
    run_well( "run two.yaml --format json" );
    static const char* const words[] = { "\"step 1\"",
                                         "\"step 2\"",
                                         "\"step 3\"",
                                         "\"boundary_points\"",
                                         "\"boundary_edge_points\"",
                                         "\"boundary_changed_fraction\"",
                                         "\"boundary_changed_fraction_of_run\"",
                                         "\"contacts\"",
                                         "\"contact_intersections\": 0" };
    for ( int i = 0; i < WISP_COUNT( words ); ++i )
    {
        assert_non_null( strstr( result.out, words[i] ) );
    }
    assert_null( strstr( result.out, "\"step 4\"" ) );
    run_well( "run plain.yaml --format json" );
    assert_null( strstr( result.out, "\"step 1\"" ) );
    run_well( "run two.yaml --format json --output two.json" );
    run_well( "info two.json" );
    assert_non_null( strstr( result.out, "results, 4 rows" ) );
    assert_non_null( strstr( result.out, "two.yaml/step 2" ) );
}

TEST( a_scene_is_described_with_its_layers_and_contacts )
{
    run_well( "info two.yaml" );
    assert_non_null(
        strstr( result.out, "    contact and self contact: thickness a quarter of the mean edge, friction " ) );
    assert_non_null( strstr( result.out, "    boundary points: even, spacing 0.02 m" ) );
    assert_non_null( strstr( result.out, "    boundary points: even, spacing half of the mean edge" ) );
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

TEST( several_surfaces_are_a_file_each )
{
    run_well( "run two.yaml --boundary both.ply" );
    assert_non_null( strstr( result.out, "6 files" ) );
    assert_true( exists( "both_left_0002.ply" ) && exists( "both_right_0004.ply" ) );
}

TEST( points_that_cannot_be_written_are_refused )
{
    assert_refused( "run plain.yaml --boundary a.ply", "plain.yaml has no surface with the key 'boundary'" );
    assert_refused( "run ball.yaml --boundary no_folder/a.ply", "no_folder/a_0002.ply" );
}

TEST( a_place_where_bench_can_have_no_folder_is_refused_before_anything_is_measured )
{
    assert_refused( "bench figures --quick --pictures ball.yaml", "ball.yaml: cannot make a folder" );
    assert_refused( "bench figures --quick --pictures absent/pictures", "absent/pictures: cannot make a folder" );
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

TEST( points_of_what_has_none_are_refused )
{
    run_well( "render plain.yaml -o plain.png" SMALL );
    run_well( "render plain.yaml --boundary none -o plain.png" SMALL );
    assert_refused( "render plain.yaml --boundary class -o a.png", "plain.yaml: has no boundary points" );
    assert_refused( "render plain.yaml --normals -o a.png", "plain.yaml: has no boundary points" );
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
