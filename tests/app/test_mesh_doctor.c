// The doctor: each defect found with its count, each repair, and the printed text. Welding and flipping: against a
// comparison of all pairs in double precision, what is counted, what is refused.
#define _XOPEN_SOURCE 700

#include "mesh_fixture.h"

#include "wisp/module/random.h"

// ---- defects ----

TEST( a_sound_tetrahedron_has_its_stats_and_no_finding )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_tetrahedron();
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_int_equal( r.edge_count, 6 );
    assert_int_equal( r.euler_characteristic, 2 );
    assert_int_equal( r.component_count, 1 );
    assert_true( r.closed && r.components[0].closed && r.components[0].consistent );
    // three right triangles and an equilateral one of side sqrt 2; exact but for the last square root
    assert_true( fabs( r.area - ( 1.5 + sqrt( 3.0 ) / 2.0 ) ) < 1e-15 );
    assert_true( fabs( r.volume - 1.0 / 6.0 ) < 1e-15 );
    assert_true( r.min_edge == 1.0 && r.max_edge == sqrt( 2.0 ) );
    assert_true( fabs( r.edge_mean - ( 1.0 + sqrt( 2.0 ) ) / 2.0 ) < 1e-15 );
    assert_true( r.lowest.x == 0.0f && r.highest.z == 1.0f );
    int all = WISP_MESH_CLOSED | WISP_MESH_ORIENTED | WISP_MESH_MANIFOLD | WISP_MESH_CLEAN | WISP_MESH_ONE_COMPONENT;
    assert_int_equal( wisp_mesh_require( &r, all, "tetrahedron", NULL ), WISP_OK );
}

TEST( volume_and_area_do_not_depend_on_the_distance_from_the_origin )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_tetrahedron();
    for ( int v = 0; v < 4; ++v )
    {
        mesh.points[v].x += 1048576.0f;
        mesh.points[v].y -= 2097152.0f;
    }
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    // powers of two: the shifted floats are exact
    assert_true( fabs( r.volume - 1.0 / 6.0 ) < 1e-15 );
}

TEST( a_missing_triangle_leaves_three_border_edges_in_one_loop )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_tetrahedron();
    mesh.triangle_count = 3;
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_finding( &r.open_edges, 3, 1, 2 );
    assert_int_equal( r.open_edges.first[2], 2 );
    assert_int_equal( r.open_edges.second[2], 3 );
    assert_int_equal( r.open_loop_count, 1 );
    assert_false( r.closed );
    assert_true( r.volume == 0.0 );
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_require( &r, WISP_MESH_CLOSED, "hole.obj", &error ), WISP_BAD_INPUT );
    assert_string_equal( error.message, "hole.obj: open edges: 3, the first is edge of vertices 1 and 2" );
}

static void swap_corners( wisp_mesh* mesh, int t )
{
    int32_t* c = mesh->triangles + 3 * t;
    int32_t second = c[1];
    c[1] = c[2];
    c[2] = second;
}

TEST( a_turned_triangle_disagrees_along_its_three_edges )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_tetrahedron();
    swap_corners( &mesh, 1 );
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_finding( &r.windings, 3, 0, 1 );
    assert_true( r.components[0].closed && !r.components[0].consistent );
    assert_int_equal( r.inside_out.count, 0 );
}

TEST( a_shell_turned_inside_out_is_named )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_tetrahedron();
    for ( int t = 0; t < 4; ++t )
    {
        swap_corners( &mesh, t );
    }
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_finding( &r.inside_out, 1, 0, 0 );
    assert_int_equal( r.windings.count, 0 );
    assert_true( fabs( r.volume + 1.0 / 6.0 ) < 1e-15 );
}

TEST( an_edge_of_three_triangles_is_named )
{
    const int32_t triangles[] = { 0, 1, 2, 1, 0, 3, 0, 1, 4 };
    const wisp_vec3 points[] = { { 0, 0, 0 }, { 0, 1, 0 }, { 1, 0, 0 }, { 0, 0, 1 }, { -1, 0, 0 } };
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_mesh( points, 5, triangles, 3 );
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_finding( &r.nonmanifold_edges, 1, 0, 1 );
    assert_int_equal( r.nonmanifold_vertices.count, 0 );
    assert_int_equal( r.open_edges.count, 6 );
    assert_int_equal( r.component_count, 1 );
}

TEST( two_tetrahedra_that_touch_in_a_vertex_are_two_shells_and_two_fans )
{
    const int32_t triangles[] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 3, 5, 4, 3, 4, 6, 3, 6, 5, 4, 5, 6 };
    const wisp_vec3 points[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 },
                                 { 2, 0, 1 }, { 0, 2, 1 }, { 0, 0, 3 } };
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_mesh( points, 7, triangles, 8 );
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_finding( &r.nonmanifold_vertices, 1, 3, 2 );
    assert_int_equal( r.nonmanifold_edges.count, 0 );
    assert_int_equal( r.component_count, 2 );
    assert_int_equal( r.components[1].first_triangle, 4 );
    assert_int_equal( r.components[1].triangle_count, 4 );
    assert_true( fabs( r.components[0].volume - 1.0 / 6.0 ) < 1e-15 );
    assert_true( fabs( r.components[1].volume - 8.0 / 6.0 ) < 1e-14 );
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_require( &r, WISP_MESH_ONE_COMPONENT, "two", &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "two: got 2 components, expected one; the second starts with triangle 4" );
    assert_int_equal( wisp_mesh_require( &r, WISP_MESH_MANIFOLD, "two", &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "the first is vertex 3, fans 2" );
}

TEST( duplicates_are_found_whatever_their_first_corner_and_winding )
{
    const int32_t triangles[] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 3, 1, 0, 2, 0, 1 };
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_mesh( fixture_corners, 4, triangles, 6 );
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_finding( &r.duplicates, 2, 4, 1 );
    assert_int_equal( r.duplicates.first[1], 5 );
    assert_int_equal( r.duplicates.second[1], 0 );
}

TEST( triangles_without_area_and_vertices_without_triangle_are_named )
{
    // vertex 3 is in the middle of 0 and 1; 0.1 + 0.2 style rounding keeps vertex 6 a little off its line
    const wisp_vec3 points[] = { { 0, 0, 0 }, { 2, 0, 0 },       { 0, 1, 0 },       { 1, 0, 0 },
                                 { 5, 5, 5 }, { 3, 0.3f, 0.9f }, { 1, 0.1f, 0.3f }, { 7, 0.7f, 2.1f } };
    const int32_t triangles[] = { 0, 1, 2, 0, 3, 1, 2, 2, 1, 5, 6, 7 };
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_mesh( points, 8, triangles, 4 );
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_finding( &r.degenerates, 3, 1, 0 );
    assert_int_equal( r.degenerates.first[1], 2 );
    assert_int_equal( r.degenerates.first[2], 3 );
    assert_finding( &r.unreferenced, 1, 4, 0 );
    // a triangle with a repeated vertex belongs to no shell
    assert_int_equal( r.component_count, 2 );
}

TEST( a_report_lists_the_first_and_counts_the_rest )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_tetrahedron();
    wisp_vec3* more = realloc( mesh.points, 104 * sizeof *more );
    assert_non_null( more );
    memset( more + 4, 0, 100 * sizeof *more );
    mesh.points = more;
    mesh.vertex_count = 104;
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_finding( &r.unreferenced, 100, 4, 0 );
    assert_int_equal( r.unreferenced.first[WISP_MESH_LISTED - 1], 4 + WISP_MESH_LISTED - 1 );
    assert_int_equal( r.euler_characteristic, 2 );
}

TEST( a_malformed_mesh_is_refused_and_reports_nothing )
{
    wisp_mesh mesh = fixture_tetrahedron(), empty = { 0 };
    wisp_mesh_repairs repairs;
    wisp_mesh_diagnostics r;
    wisp_error error = { .status = WISP_OK };
    mesh.triangles[4] = -1;
    assert_int_equal( wisp_mesh_examine( &mesh, &r, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "triangle 1: corner 1: got vertex -1, expected 0 .. 3" );
    assert_int_equal( r.vertex_count, 0 );
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_REPAIR_ALL, &repairs, &error ), WISP_BAD_INPUT );
    mesh.triangles[4] = 1;
    mesh.points[2].z = NAN;
    assert_int_equal( wisp_mesh_examine( &mesh, &r, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "vertex 2: z is NaN" );
    assert_int_equal( wisp_mesh_examine( &empty, &r, &error ), WISP_BAD_INPUT );
    wisp_mesh_release( &mesh );
}

TEST( the_largest_floats_do_not_overflow_the_stats )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_tetrahedron();
    for ( int v = 0; v < 4; ++v )
    {
        wisp_vec3 p = fixture_corners[v];
        mesh.points[v] =
            ( wisp_vec3 ){ ( 2 * p.x - 1 ) * 3.4e38f, ( 2 * p.y - 1 ) * 3.4e38f, ( 2 * p.z - 1 ) * 3.4e38f };
    }
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_int_equal( r.degenerates.count, 0 );
    assert_true( isfinite( r.volume ) && isfinite( r.area ) && isfinite( r.edge_mean ) && r.volume > 0.0 );
}

// ---- hostile sizes ----

// All triangles around one edge: pairwise comparison of neighbours would take hours.
TEST( a_hundred_thousand_triangles_around_one_edge_are_examined_and_repaired )
{
    enum
    {
        COUNT = 100000
    };
    SCOPED( wisp_mesh_release )
    wisp_mesh mesh = { .points = calloc( COUNT + 2, sizeof( wisp_vec3 ) ),
                       .triangles = calloc( 3 * COUNT, sizeof( int32_t ) ),
                       .vertex_count = COUNT + 2,
                       .triangle_count = COUNT };
    assert_non_null( mesh.points );
    assert_non_null( mesh.triangles );
    mesh.points[1].y = 1.0f;
    for ( int t = 0; t < COUNT; ++t )
    {
        mesh.points[t + 2] = ( wisp_vec3 ){ 1.0f + (float)t, 0.5f, (float)( t % 7 ) };
        mesh.triangles[3 * t + 1] = 1;
        mesh.triangles[3 * t + 2] = t + 2;
    }
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_finding( &r.nonmanifold_edges, 1, 0, 1 );
    assert_int_equal( r.open_edges.count, 2 * COUNT );
    assert_int_equal( r.open_loop_count, 1 );
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs;
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_REPAIR_ALL, &repairs, NULL ), WISP_OK );
    assert_int_equal( repairs.kept_count, COUNT + 2 );
}

// ---- repairs ----

static wisp_mesh_repairs repaired( wisp_mesh* mesh, int what )
{
    wisp_mesh_repairs repairs;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_mesh_repair( mesh, what, &repairs, &error ), error );
    return repairs;
}

TEST( a_sound_mesh_is_not_changed_by_any_repair )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_tetrahedron(), before = fixture_tetrahedron();
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs = repaired( &mesh, WISP_MESH_REPAIR_ALL );
    assert_same_mesh( &mesh, &before );
    assert_int_equal( repairs.degenerates_dropped + repairs.duplicates_dropped + repairs.triangles_turned, 0 );
    assert_int_equal( repairs.unreferenced_dropped, 0 );
    assert_int_equal( repairs.kept_count, 4 );
}

TEST( winding_is_repaired_outwards_whatever_was_turned )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_TORUS );
    SCOPED( wisp_mesh_release ) wisp_mesh sound = fixture_made( &generator ), mesh = fixture_made( &generator );
    for ( int seed = 1; seed < 4; ++seed )
    {
        int turned = 0;
        for ( int t = 0; t < mesh.triangle_count; ++t )
        {
            // more than half, less than half, all
            bool turn = seed == 3 || ( seed == 1 ? t % 3 != 0 : t % 5 == 0 );
            turn ? swap_corners( &mesh, t ) : (void)0;
            turned += turn;
        }
        SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs = repaired( &mesh, WISP_MESH_TURN_TRIANGLES );
        assert_int_equal( repairs.triangles_turned, turned );
        assert_same_mesh( &mesh, &sound );
    }
}

TEST( an_open_mesh_keeps_the_winding_of_most_of_its_triangles )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_ALTERNATING );
    SCOPED( wisp_mesh_release ) wisp_mesh sound = fixture_made( &generator ), mesh = fixture_made( &generator );
    // the flood starts with triangle 0, which is one of the reversed ones
    for ( int t = 0; t < 700; ++t )
    {
        swap_corners( &mesh, t );
    }
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs = repaired( &mesh, WISP_MESH_TURN_TRIANGLES );
    assert_int_equal( repairs.triangles_turned, 700 );
    assert_same_mesh( &mesh, &sound );
}

TEST( shells_that_share_an_edge_are_turned_outwards_one_by_one )
{
    // two tetrahedra on the edge 0-1, the second one reversed
    const wisp_vec3 points[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0, -1, 0 }, { 0, 0, -1 } };
    const int32_t triangles[] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 0, 1, 4, 0, 5, 1, 0, 4, 5, 1, 5, 4 };
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_mesh( points, 6, triangles, 8 );
    wisp_mesh_diagnostics before = fixture_report( &mesh );
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs = repaired( &mesh, WISP_MESH_TURN_TRIANGLES );
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_finding( &r.nonmanifold_edges, 1, 0, 1 );
    assert_true( fabs( before.volume ) < 1e-15 );
    assert_int_equal( repairs.triangles_turned, 4 );
    assert_true( fabs( r.volume - 2.0 / 6.0 ) < 1e-15 );
}

TEST( a_moebius_strip_is_refused_by_an_edge_and_stays_as_it_was )
{
    enum
    {
        PARTS = 5
    };
    wisp_vec3 points[2 * PARTS];
    int32_t triangles[6 * PARTS];
    for ( int i = 0; i < PARTS; ++i )
    {
        points[2 * i] = ( wisp_vec3 ){ (float)i, 0, (float)( i * i ) };
        points[2 * i + 1] = ( wisp_vec3 ){ (float)i, 1, (float)( i * i ) };
        // the last part is joined to the first one with reversed winding
        int next = i + 1 < PARTS ? 2 * i + 2 : 1, above = i + 1 < PARTS ? 2 * i + 3 : 0;
        const int32_t two[] = { 2 * i, next, above, 2 * i, above, 2 * i + 1 };
        memcpy( triangles + 6 * i, two, sizeof two );
    }
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_mesh( points, 2 * PARTS, triangles, 2 * PARTS );
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_finding( &r.windings, 1, 0, 1 );
    assert_int_equal( r.open_loop_count, 1 );
    assert_int_equal( r.euler_characteristic, 0 );
    wisp_mesh_repairs repairs;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_REPAIR_ALL, &repairs, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "one-sided: triangles" );
    assert_contains( error.message, "along the edge of vertices" );
    assert_null( repairs.kept );
    assert_memory_equal( mesh.triangles, triangles, sizeof triangles );
    assert_memory_equal( mesh.points, points, sizeof points );
}

static wisp_mesh ill_mesh( void )
{
    // vertices 0 and 5 are unreferenced; triangle 1 repeats 0, triangle 3 has a repeated vertex
    const wisp_vec3 points[] = { { 9, 9, 9 }, { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 8, 8, 8 } };
    const int32_t triangles[] = { 1, 3, 2, 2, 3, 1, 1, 2, 4, 4, 4, 1, 1, 4, 3, 2, 4, 3 };
    return fixture_mesh( points, 6, triangles, 6 );
}

TEST( what_is_not_queried_for_is_not_repaired )
{
    static const struct
    {
        int what, degenerates, duplicates, turned, unreferenced;
    } cases[] = {
        { 0, 0, 0, 0, 0 },
        { WISP_MESH_DROP_DEGENERATES, 1, 0, 0, 0 },
        { WISP_MESH_DROP_DUPLICATES, 0, 1, 0, 0 },
        { WISP_MESH_DROP_UNREFERENCED, 0, 0, 0, 2 },
        { WISP_MESH_DROP_DUPLICATES | WISP_MESH_TURN_TRIANGLES, 0, 1, 1, 0 },
        { WISP_MESH_REPAIR_ALL, 1, 1, 1, 2 },
    };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        SCOPED( wisp_mesh_release ) wisp_mesh mesh = ill_mesh();
        SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs = repaired( &mesh, cases[i].what );
        assert_int_equal( repairs.degenerates_dropped, cases[i].degenerates );
        assert_int_equal( repairs.duplicates_dropped, cases[i].duplicates );
        assert_int_equal( repairs.triangles_turned, cases[i].turned );
        assert_int_equal( repairs.unreferenced_dropped, cases[i].unreferenced );
        assert_int_equal( mesh.triangle_count, 6 - cases[i].degenerates - cases[i].duplicates );
        assert_int_equal( mesh.vertex_count, 6 - cases[i].unreferenced );
    }
}

TEST( everything_repaired_keeps_its_order_and_tells_where_vertices_went )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = ill_mesh();
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs = repaired( &mesh, WISP_MESH_REPAIR_ALL );
    const int32_t kept[] = { 1, 2, 3, 4 };
    const int32_t triangles[] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };
    assert_int_equal( repairs.kept_count, 4 );
    assert_memory_equal( repairs.kept, kept, sizeof kept );
    assert_memory_equal( mesh.points, fixture_corners, sizeof fixture_corners );
    assert_memory_equal( mesh.triangles, triangles, sizeof triangles );
}

TEST( a_mesh_of_nothing_but_faults_is_refused )
{
    const int32_t triangles[] = { 0, 0, 1, 2, 2, 2 };
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_mesh( fixture_corners, 4, triangles, 2 );
    wisp_mesh_repairs repairs;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_REPAIR_ALL, &repairs, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "the repair removes all 2 triangles" );
    assert_int_equal( mesh.triangle_count, 2 );
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_int_equal( r.degenerates.count, 2 );
    assert_int_equal( r.component_count, 0 );
    assert_false( r.closed );
}

// ---- words ----

typedef struct printed
{
    char* text;
    size_t size;
    FILE* stream;
} printed;

static void begin_printing( printed* p )
{
    p->stream = open_memstream( &p->text, &p->size );
    assert_non_null( p->stream );
}

TEST( a_sound_mesh_is_described_in_few_lines )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_tetrahedron();
    printed p;
    begin_printing( &p );
    assert_int_equal( wisp_mesh_info( p.stream, &mesh, "four.obj" ), WISP_OK );
    fclose( p.stream );
    assert_string_equal( p.text, "four.obj: closed mesh of triangles\n"
                                 "  vertices             4\n"
                                 "  triangles            4\n"
                                 "  edges                6\n"
                                 "  Euler characteristic 2\n"
                                 "  bounds               x 0 .. 1, y 0 .. 1, z 0 .. 1 m\n"
                                 "  edge length          min 1, mean 1.20711, max 1.41421 m\n"
                                 "  area                 2.36603 m^2\n"
                                 "  volume               0.166667 m^3\n"
                                 "  components           1\n"
                                 "  no defects\n" );
    free( p.text );
}

TEST( every_defect_is_printed_by_its_number )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = ill_mesh();
    mesh.triangle_count = 5;
    printed p;
    begin_printing( &p );
    assert_int_equal( wisp_mesh_info( p.stream, &mesh, "ill.obj" ), WISP_OK );
    fclose( p.stream );
    assert_contains( p.text, "ill.obj: open mesh of triangles\n" );
    assert_contains( p.text, "  note: open edges: 2 in 1 loop\n    edge of vertices 2 and 4\n" );
    assert_contains( p.text, "  wrong: duplicate triangles: 1\n    triangle 1, as triangle 0\n" );
    assert_contains( p.text, "  wrong: triangles without area: 1\n    triangle 3\n" );
    assert_contains( p.text, "  wrong: unreferenced vertices: 2\n    vertex 0\n    vertex 5\n" );
    assert_null( strstr( p.text, "nothing is wrong" ) );
    free( p.text );
}

TEST( a_mesh_that_cannot_be_examined_prints_one_message )
{
    wisp_mesh empty = { 0 };
    printed p;
    begin_printing( &p );
    assert_int_equal( wisp_mesh_info( p.stream, &empty, "none.obj" ), WISP_BAD_INPUT );
    fclose( p.stream );
    assert_string_equal( p.text, "none.obj: mesh: the mesh is empty: 0 vertices, 0 triangles\n" );
    free( p.text );
}

TEST( every_repair_is_said_out_loud )
{
    wisp_mesh_repairs all = { .degenerates_dropped = 1,
                              .duplicates_dropped = 2,
                              .triangles_turned = 3,
                              .unreferenced_dropped = 1,
                              .vertices_welded = 5,
                              .collapsed_dropped = 1,
                              .triangles_flipped = 7 };
    wisp_mesh_repairs none = { 0 };
    printed p;
    begin_printing( &p );
    wisp_mesh_print_repairs( p.stream, &all, "a" );
    wisp_mesh_print_repairs( p.stream, &none, "b" );
    fclose( p.stream );
    assert_string_equal( p.text, "a: 5 vertices were merged into others\n"
                                 "a: 1 triangle that collapsed was removed\n"
                                 "a: 1 triangle without area was removed\n"
                                 "a: 2 duplicate triangles were removed\n"
                                 "a: 3 triangles were turned over\n"
                                 "a: 7 triangles were flipped\n"
                                 "a: 1 unreferenced vertex was removed\n"
                                 "b: nothing to repair\n" );
    free( p.text );
}

// Four tents over one triangle, which face down. Each of its sides has four triangles, but no tent is closed, so each goes on facing the way
// of its triangles.
TEST( sheets_that_share_their_border_are_open )
{
    wisp_vec3 points[7] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } };
    int32_t triangles[36];
    for ( int f = 0; f < 4; ++f )
    {
        const int32_t top = 3 + f, tent[9] = { 1, 0, top, 2, 1, top, 0, 2, top };
        points[top] = ( wisp_vec3 ){ 0.3f, 0.3f, 1.0f + (float)f };
        memcpy( triangles + 9 * f, tent, sizeof tent );
    }
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_mesh( points, 7, triangles, 12 );
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs;
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_TURN_TRIANGLES, &repairs, NULL ), WISP_OK );
    assert_int_equal( repairs.triangles_turned, 0 );
    assert_memory_equal( mesh.triangles, triangles, sizeof triangles );
}

// ---- welding and flipping ----

enum
{
    MANY = 3000,
};

// Every vertex for itself, in the order of the file: the lowest earlier one that stays and is near, compared one by one.
static void oracle( const wisp_vec3* points, int count, double distance, int32_t* became )
{
    for ( int v = 0; v < count; ++v )
    {
        became[v] = v;
        for ( int w = 0; w < v && became[v] == v; ++w )
        {
            const double x = (double)points[w].x - (double)points[v].x, y = (double)points[w].y - (double)points[v].y,
                         z = (double)points[w].z - (double)points[v].z;
            if ( became[w] == w && x * x + y * y + z * z <= distance * distance )
            {
                became[v] = w;
            }
        }
    }
}

// A strip of triangles over random points, dense enough that many are near others.
static wisp_mesh random_mesh( uint64_t seed, float stretch )
{
    static wisp_vec3 points[MANY];
    static int32_t triangles[3 * ( MANY - 2 )];
    const wisp_random_key key = wisp_random_make_key( seed, 0, 0 );
    for ( uint32_t v = 0; v < MANY; ++v )
    {
        points[v] = ( wisp_vec3 ){ stretch * (float)wisp_random_unit( key, v, 0, 0 ) - 0.3f,
                                   (float)wisp_random_unit( key, v, 1, 0 ), (float)wisp_random_unit( key, v, 2, 0 ) };
    }
    for ( int t = 0; t < MANY - 2; ++t )
    {
        triangles[3 * t] = t;
        triangles[3 * t + 1] = t + 1;
        triangles[3 * t + 2] = t + 2;
    }
    return fixture_mesh( points, MANY, triangles, MANY - 2 );
}

static void assert_welded_as_by_the_oracle( const wisp_mesh* before, float distance )
{
    static int32_t became[MANY], number[MANY];
    SCOPED( wisp_mesh_release )
    wisp_mesh mesh = fixture_mesh( before->points, before->vertex_count, before->triangles, before->triangle_count );
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs;
    wisp_error error = { 0 };
    oracle( before->points, before->vertex_count, (double)distance, became );
    assert_ok( wisp_mesh_repair_within( &mesh, WISP_MESH_WELD, distance, &repairs, &error ), error );
    int kept = 0, triangles = 0;
    for ( int v = 0; v < before->vertex_count; ++v )
    {
        number[v] = became[v] == v ? kept : number[became[v]];
        if ( became[v] == v )
        {
            assert_int_equal( repairs.kept[kept], v );
            assert_memory_equal( &mesh.points[kept], &before->points[v], sizeof *mesh.points );
            ++kept;
        }
        assert_int_equal( repairs.became[v], number[v] );
    }
    for ( int t = 0; t < before->triangle_count; ++t )
    {
        const int32_t* c = before->triangles + 3 * t;
        const int32_t to[3] = { number[c[0]], number[c[1]], number[c[2]] };
        if ( to[0] != to[1] && to[1] != to[2] && to[2] != to[0] )
        {
            assert_memory_equal( mesh.triangles + 3 * triangles, to, sizeof to );
            ++triangles;
        }
    }
    assert_true( kept < before->vertex_count );
    assert_int_equal( mesh.vertex_count, kept );
    assert_int_equal( repairs.kept_count, kept );
    assert_int_equal( repairs.original_count, before->vertex_count );
    assert_int_equal( repairs.vertices_welded, before->vertex_count - kept );
    assert_int_equal( mesh.triangle_count, triangles );
    assert_int_equal( repairs.collapsed_dropped, before->triangle_count - triangles );
    assert_int_equal( repairs.unreferenced_dropped + repairs.degenerates_dropped + repairs.duplicates_dropped, 0 );
}

TEST( near_vertices_become_the_lowest_that_stays )
{
    // From few that are near to crowds; stretched along an axis, so that most cells have neighbours along z.
    static const struct
    {
        float distance, stretch;
    } cases[] = { { 0.02f, 1.0f }, { 0.1f, 1.0f }, { 0.4f, 1.0f }, { 0.01f, 0.0f }, { 0.05f, 100.0f } };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        SCOPED( wisp_mesh_release ) wisp_mesh mesh = random_mesh( (uint64_t)i + 1, cases[i].stretch );
        assert_welded_as_by_the_oracle( &mesh, cases[i].distance );
    }
}

TEST( a_chain_does_not_drift_together )
{
    // Each is near the one before; every other one stays.
    const wisp_vec3 points[] = { { 0, 0, 0 }, { 0.8f, 0, 0 }, { 1.6f, 0, 0 }, { 2.4f, 0, 0 }, { 0, 5, 0 } };
    const int32_t triangles[] = { 0, 2, 4, 1, 3, 4, 0, 1, 4 }, expected[] = { 0, 0, 1, 1, 2 };
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_mesh( points, 5, triangles, 3 );
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs;
    assert_int_equal( wisp_mesh_repair_within( &mesh, WISP_MESH_WELD, 1.0f, &repairs, NULL ), WISP_OK );
    assert_memory_equal( repairs.became, expected, sizeof expected );
    assert_int_equal( repairs.vertices_welded, 2 );
    assert_int_equal( repairs.collapsed_dropped, 1 );
    assert_int_equal( mesh.triangle_count, 2 );
}

TEST( what_is_as_far_as_the_distance_is_near )
{
    const wisp_vec3 points[] = { { 0, 0, 0 }, { 0.5f, 0, 0 }, { 1, 0, 0 }, { 0, 5, 0 } };
    const int32_t triangles[] = { 0, 2, 3, 1, 2, 3 }, expected[] = { 0, 0, 1, 2 };
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_mesh( points, 4, triangles, 2 );
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs;
    assert_int_equal( wisp_mesh_repair_within( &mesh, WISP_MESH_WELD, 0.5f, &repairs, NULL ), WISP_OK );
    assert_memory_equal( repairs.became, expected, sizeof expected );
}

// Four triangles with corners of their own, as a renderer has them, and rounded.
static wisp_mesh split_tetrahedron( float noise )
{
    wisp_vec3 points[12];
    int32_t triangles[12];
    for ( int c = 0; c < 12; ++c )
    {
        points[c] = fixture_corners[fixture_tetrahedron_faces[c]];
        points[c].x += noise * (float)( c % 3 );
        triangles[c] = c;
    }
    return fixture_mesh( points, 12, triangles, 4 );
}

TEST( a_split_mesh_is_closed_again )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = split_tetrahedron( 1e-6f );
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_false( r.closed );
    char text[4000] = "";
    FILE* stream = fmemopen( text, sizeof text, "w" );
    assert_non_null( stream );
    assert_int_equal( wisp_mesh_info( stream, &mesh, "split" ), WISP_OK );
    fclose( stream );
    assert_contains( text, "  note: vertices that the repair `weld` merges into others: 8\n" );
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs;
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_WELD, &repairs, NULL ), WISP_OK );
    assert_int_equal( repairs.vertices_welded, 8 );
    r = fixture_report( &mesh );
    assert_true( r.closed && r.component_count == 1 && r.volume > 0.166 );
    wisp_mesh_repairs_release( &repairs );
    wisp_mesh_release( &mesh );
    // beyond a hundred-thousandth of its size
    mesh = split_tetrahedron( 1e-4f );
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_WELD, &repairs, NULL ), WISP_OK );
    r = fixture_report( &mesh );
    assert_false( r.closed );
}

TEST( other_repairs_find_the_welded_mesh )
{
    // The same triangle twice with corners of its own, one that names a vertex twice from the start, a vertex of none.
    const wisp_vec3 points[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 0 },
                                 { 1, 0, 0 }, { 0, 1, 0 }, { 7, 7, 7 }, { 1, 1, 0 } };
    const int32_t triangles[] = { 0, 1, 2, 3, 4, 5, 1, 1, 7, 1, 7, 2 };
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_mesh( points, 8, triangles, 4 );
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs;
    const int what = WISP_MESH_WELD | WISP_MESH_REPAIR_ALL;
    const int32_t became[] = { 0, 1, 2, 0, 1, 2, -1, 3 };
    assert_int_equal( wisp_mesh_repair( &mesh, what, &repairs, NULL ), WISP_OK );
    assert_int_equal( repairs.vertices_welded, 3 );
    assert_int_equal( repairs.collapsed_dropped, 0 );
    assert_int_equal( repairs.degenerates_dropped, 1 );
    assert_int_equal( repairs.duplicates_dropped, 1 );
    assert_int_equal( repairs.unreferenced_dropped, 1 );
    assert_memory_equal( repairs.became, became, sizeof became );
}

TEST( a_flipped_mesh_is_inside_out_and_flipping_twice_changes_nothing )
{
    SCOPED( wisp_mesh_release ) wisp_mesh before = fixture_tetrahedron(), mesh = fixture_tetrahedron();
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs;
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_FLIP, &repairs, NULL ), WISP_OK );
    assert_int_equal( repairs.triangles_flipped, 4 );
    assert_int_equal( repairs.triangles_turned, 0 );
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_true( fabs( r.volume + 1.0 / 6.0 ) < 1e-15 );
    wisp_mesh_repairs_release( &repairs );
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_FLIP, &repairs, NULL ), WISP_OK );
    assert_same_mesh( &before, &mesh );
}

TEST( attributes_are_those_of_the_vertex_that_stays )
{
    static const char text[] =
        "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1 0 0 1 1 1\nv 1 1 0 0 0 0\nv 0 1 0 1 1 1\n"
        "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 0.5\nf 1/1 2/2 3/3\nf 4/4 5/1 6/3\n";
    SCOPED( wisp_mesh_release ) wisp_mesh mesh;
    wisp_error error = { 0 };
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs;
    assert_ok( wisp_mesh_read_obj( text, strlen( text ), "two.obj", &mesh, &error ), error );
    assert_ok( wisp_mesh_repair( &mesh, WISP_MESH_WELD, &repairs, &error ), error );
    assert_int_equal( mesh.vertex_count, 4 );
    assert_true( mesh.colours[1].x == 0.0f && mesh.colours[1].y == 1.0f );
    assert_true( mesh.uvs[2] == 1.0f && mesh.uvs[5] == 1.0f && mesh.uvs[6] == 0.0f );
    assert_int_equal( mesh.uv_seam_count, 1 );
}

TEST( what_cannot_be_welded_is_refused )
{
    static const struct
    {
        float distance;
        const char* message;
    } cases[] = {
        { -1.0f, "mesh: got -1 m as the distance to weld, expected 0 or more" },
        { NAN, "mesh: got nan m as the distance to weld, expected 0 or more" },
        { INFINITY, "mesh: got inf m as the distance to weld, expected 0 or more" },
        { 1e-10f, "mesh: got 1e-10 m as the distance to weld, expected at least a billionth of its size, 1e-09 m" },
        { 10.0f, "mesh: the repair removes all 4 triangles" },
    };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_tetrahedron();
        wisp_error error = { 0 };
        wisp_mesh_repairs repairs;
        assert_int_equal( wisp_mesh_repair_within( &mesh, WISP_MESH_WELD, cases[i].distance, &repairs, &error ),
                          WISP_BAD_INPUT );
        assert_string_equal( error.message, cases[i].message );
        assert_null( repairs.became );
        assert_int_equal( mesh.triangle_count, 4 );
    }
}

TEST( the_largest_and_the_smallest_floats_are_welded )
{
    const wisp_vec3 points[] = { { -FLT_MAX, 0, 0 }, { FLT_MAX, 0, 0 }, { 0, FLT_MAX, 0 }, { 0, FLT_MAX, 0 } };
    const int32_t triangles[] = { 0, 1, 2, 1, 0, 3 };
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_mesh( points, 4, triangles, 2 );
    wisp_mesh_repairs repairs;
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_WELD, &repairs, NULL ), WISP_OK );
    assert_int_equal( repairs.vertices_welded, 1 );
    wisp_mesh_repairs_release( &repairs );
    wisp_mesh_release( &mesh );
    // all in one place: nothing would be left
    const wisp_vec3 dot[] = { { 1, 1, 1 }, { 1, 1, 1 }, { 1, 1, 1 } };
    mesh = fixture_mesh( dot, 3, triangles, 1 );
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_WELD, &repairs, NULL ), WISP_BAD_INPUT );
}
