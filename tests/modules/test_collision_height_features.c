// Edges and triangles of surfaces against height fields: which edges and corners stick out, peaks and ridges under a sheet.
#include "collision_sheet_fixture.h"
#include "collision_vectors.h"
#include "wisp/module/collision_mesh.h"

// ---- edges and corners ----

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
    return ( wisp_v3_length( wisp_v3_sub( a->from[0], b->from[0] ) ) < near &&
             wisp_v3_length( wisp_v3_sub( a->from[1], b->from[1] ) ) < near ) ||
           ( wisp_v3_length( wisp_v3_sub( a->from[0], b->from[1] ) ) < near &&
             wisp_v3_length( wisp_v3_sub( a->from[1], b->from[0] ) ) < near );
}

// Within a box, the edges of a field that stick out are those that stick out of the mesh of its triangles, with the same normals.
TEST( a_height_field_has_the_edges_and_corners_of_its_triangles )
{
    float heights[9 * 7];
    for ( uint32_t v = 0; v < 63; ++v )
    {
        heights[v] = v % 5 == 0 ? 0.05f : 0.2f * random_point( v ).x;
    }
    const wisp_height_field field = { heights, 9, 7, 0.1f };
    SCOPED( test_mesh_free ) test_mesh m = mesh_of_field( &field );
    const wisp_collision_mesh_def def = { .points = m.points,
                                          .triangles = m.triangles,
                                          .point_count = m.vertex_count,
                                          .triangle_count = m.triangle_count };
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
                    assert_true( wisp_v3_dot( mine.normal, sides.normal ) > ( corners == 1 ? 0.8f : 0.999999f ) );
                }
            }
        }
        assert_int_equal( matched, count );
        assert_true( count > 5 && ( corners == 1 || count == expected ) );
        assert_int_equal( wisp_height_field_find_features( &field, lower, upper, corners == 1, own, 3 ), 3 );
    }
    wisp_collision_mesh_release( mesh );
}

// ---- a sheet and a ground ----

// A ground with one sample that is 4 cm higher than the others, and with a ridge of such samples.
TEST( no_peak_and_no_ridge_of_a_height_field_shows_through_a_sheet )
{
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
