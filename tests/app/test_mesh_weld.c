// Welding and flipping: against a comparison of all pairs in double precision, what is counted, what is refused.
#define _XOPEN_SOURCE 700

#include "mesh_fixture.h"

#include <float.h>
#include <math.h>

#include "wisp/module/random.h"

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
    wisp_mesh mesh = fixture_mesh( before->points, before->vertex_count, before->triangles, before->triangle_count );
    wisp_mesh_repairs repairs;
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
    wisp_mesh_repairs_release( &repairs );
    wisp_mesh_release( &mesh );
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
        wisp_mesh mesh = random_mesh( (uint64_t)i + 1, cases[i].stretch );
        assert_welded_as_by_the_oracle( &mesh, cases[i].distance );
        wisp_mesh_release( &mesh );
    }
}

TEST( a_chain_does_not_drift_together )
{
    // Each is near the one before; every other one stays.
    const wisp_vec3 points[] = { { 0, 0, 0 }, { 0.8f, 0, 0 }, { 1.6f, 0, 0 }, { 2.4f, 0, 0 }, { 0, 5, 0 } };
    const int32_t triangles[] = { 0, 2, 4, 1, 3, 4, 0, 1, 4 }, expected[] = { 0, 0, 1, 1, 2 };
    wisp_mesh mesh = fixture_mesh( points, 5, triangles, 3 );
    wisp_mesh_repairs repairs;
    assert_int_equal( wisp_mesh_repair_within( &mesh, WISP_MESH_WELD, 1.0f, &repairs, NULL ), WISP_OK );
    assert_memory_equal( repairs.became, expected, sizeof expected );
    assert_int_equal( repairs.vertices_welded, 2 );
    assert_int_equal( repairs.collapsed_dropped, 1 );
    assert_int_equal( mesh.triangle_count, 2 );
    wisp_mesh_repairs_release( &repairs );
    wisp_mesh_release( &mesh );
}

TEST( what_is_as_far_as_the_distance_is_near )
{
    const wisp_vec3 points[] = { { 0, 0, 0 }, { 0.5f, 0, 0 }, { 1, 0, 0 }, { 0, 5, 0 } };
    const int32_t triangles[] = { 0, 2, 3, 1, 2, 3 }, expected[] = { 0, 0, 1, 2 };
    wisp_mesh mesh = fixture_mesh( points, 4, triangles, 2 );
    wisp_mesh_repairs repairs;
    assert_int_equal( wisp_mesh_repair_within( &mesh, WISP_MESH_WELD, 0.5f, &repairs, NULL ), WISP_OK );
    assert_memory_equal( repairs.became, expected, sizeof expected );
    wisp_mesh_repairs_release( &repairs );
    wisp_mesh_release( &mesh );
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
    wisp_mesh mesh = split_tetrahedron( 1e-6f );
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_false( r.closed );
    char text[4000] = "";
    FILE* stream = fmemopen( text, sizeof text, "w" );
    assert_non_null( stream );
    assert_int_equal( wisp_mesh_info( stream, &mesh, "split" ), WISP_OK );
    fclose( stream );
    assert_contains( text, "  note: vertices that the repair `weld` merges into others: 8\n" );
    wisp_mesh_repairs repairs;
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
    wisp_mesh_repairs_release( &repairs );
    wisp_mesh_release( &mesh );
}

TEST( other_repairs_find_the_welded_mesh )
{
    // The same triangle twice with corners of its own, one that names a vertex twice from the start, a vertex of none.
    const wisp_vec3 points[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 0 },
                                 { 1, 0, 0 }, { 0, 1, 0 }, { 7, 7, 7 }, { 1, 1, 0 } };
    const int32_t triangles[] = { 0, 1, 2, 3, 4, 5, 1, 1, 7, 1, 7, 2 };
    wisp_mesh mesh = fixture_mesh( points, 8, triangles, 4 );
    wisp_mesh_repairs repairs;
    const int what = WISP_MESH_WELD | WISP_MESH_REPAIR_ALL;
    const int32_t became[] = { 0, 1, 2, 0, 1, 2, -1, 3 };
    assert_int_equal( wisp_mesh_repair( &mesh, what, &repairs, NULL ), WISP_OK );
    assert_int_equal( repairs.vertices_welded, 3 );
    assert_int_equal( repairs.collapsed_dropped, 0 );
    assert_int_equal( repairs.degenerates_dropped, 1 );
    assert_int_equal( repairs.duplicates_dropped, 1 );
    assert_int_equal( repairs.unreferenced_dropped, 1 );
    assert_memory_equal( repairs.became, became, sizeof became );
    wisp_mesh_repairs_release( &repairs );
    wisp_mesh_release( &mesh );
}

TEST( a_flipped_mesh_is_inside_out_and_flipping_twice_changes_nothing )
{
    wisp_mesh before = fixture_tetrahedron(), mesh = fixture_tetrahedron();
    wisp_mesh_repairs repairs;
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_FLIP, &repairs, NULL ), WISP_OK );
    assert_int_equal( repairs.triangles_flipped, 4 );
    assert_int_equal( repairs.triangles_turned, 0 );
    wisp_mesh_diagnostics r = fixture_report( &mesh );
    assert_true( fabs( r.volume + 1.0 / 6.0 ) < 1e-15 );
    wisp_mesh_repairs_release( &repairs );
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_FLIP, &repairs, NULL ), WISP_OK );
    assert_same_mesh( &before, &mesh );
    wisp_mesh_repairs_release( &repairs );
    wisp_mesh_release( &mesh );
    wisp_mesh_release( &before );
}

TEST( attributes_are_those_of_the_vertex_that_stays )
{
    static const char text[] =
        "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1 0 0 1 1 1\nv 1 1 0 0 0 0\nv 0 1 0 1 1 1\n"
        "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 0.5\nf 1/1 2/2 3/3\nf 4/4 5/1 6/3\n";
    wisp_mesh mesh;
    wisp_error error = { 0 };
    wisp_mesh_repairs repairs;
    assert_ok( wisp_mesh_read_obj( text, strlen( text ), "two.obj", &mesh, &error ), error );
    assert_ok( wisp_mesh_repair( &mesh, WISP_MESH_WELD, &repairs, &error ), error );
    assert_int_equal( mesh.vertex_count, 4 );
    assert_true( mesh.colours[1].x == 0.0f && mesh.colours[1].y == 1.0f );
    assert_true( mesh.uvs[2] == 1.0f && mesh.uvs[5] == 1.0f && mesh.uvs[6] == 0.0f );
    assert_int_equal( mesh.uv_seam_count, 1 );
    wisp_mesh_repairs_release( &repairs );
    wisp_mesh_release( &mesh );
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
        wisp_mesh mesh = fixture_tetrahedron();
        wisp_error error = { 0 };
        wisp_mesh_repairs repairs;
        assert_int_equal( wisp_mesh_repair_within( &mesh, WISP_MESH_WELD, cases[i].distance, &repairs, &error ),
                          WISP_BAD_INPUT );
        assert_string_equal( error.message, cases[i].message );
        assert_null( repairs.became );
        assert_int_equal( mesh.triangle_count, 4 );
        wisp_mesh_release( &mesh );
    }
}

TEST( the_largest_and_the_smallest_floats_are_welded )
{
    const wisp_vec3 points[] = { { -FLT_MAX, 0, 0 }, { FLT_MAX, 0, 0 }, { 0, FLT_MAX, 0 }, { 0, FLT_MAX, 0 } };
    const int32_t triangles[] = { 0, 1, 2, 1, 0, 3 };
    wisp_mesh mesh = fixture_mesh( points, 4, triangles, 2 );
    wisp_mesh_repairs repairs;
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_WELD, &repairs, NULL ), WISP_OK );
    assert_int_equal( repairs.vertices_welded, 1 );
    wisp_mesh_repairs_release( &repairs );
    wisp_mesh_release( &mesh );
    // all in one place: nothing would be left
    const wisp_vec3 dot[] = { { 1, 1, 1 }, { 1, 1, 1 }, { 1, 1, 1 } };
    mesh = fixture_mesh( dot, 3, triangles, 1 );
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_WELD, &repairs, NULL ), WISP_BAD_INPUT );
    wisp_mesh_release( &mesh );
}
