// Picking with a mouse, and the nearest place to a point.
#include "support.h"

#include "create.h"
#include "pick.h"
#include "wisp/generate.h"

enum
{
    COLUMNS = 13,
    ROWS = 9,
};

static wisp_vec3 points[WISP_GRID_VERTICES( COLUMNS, ROWS )], strand_points[4 * 5];
static int32_t triangles[WISP_GRID_TRIANGLES( COLUMNS, ROWS )][3], offsets[5];

typedef struct scene
{
    wisp_world* world;
    wisp_entity cloth, hair, ball;
} scene;

// A grid of 1.2 m x 0.8 m in y = 0, four strands that hang 3 m aside, and a ball.
static scene new_scene( void )
{
    scene s;
    wisp_world_def def = wisp_default_world_def();
    wisp_create_cloth_def cloth = wisp_default_create_cloth_def();
    wisp_create_hair_def hair = wisp_default_create_hair_def();
    wisp_collider_def ball = wisp_default_collider_def();
    assert_int_equal( wisp_generate_grid( COLUMNS, ROWS, 0.1f, 0.1f, points, &triangles[0][0], NULL ), WISP_OK );
    assert_int_equal( wisp_generate_strand_rows( 2, 2, 0.1f, 5, 0.2f, strand_points, offsets, NULL ), WISP_OK );
    for ( int i = 0; i < WISP_COUNT( strand_points ); ++i )
    {
        strand_points[i].x += 3.0f;
    }
    def.modules = wisp_all_modules( &def.module_count );
    cloth.points = points, cloth.vertex_count = WISP_COUNT( points );
    cloth.triangles = &triangles[0][0], cloth.triangle_count = WISP_COUNT( triangles );
    hair.points = strand_points, hair.offsets = offsets, hair.strand_count = 4;
    ball.kind = WISP_COLLIDER_SPHERE;
    assert_int_equal( wisp_world_create( &def, &s.world, NULL ), WISP_OK );
    assert_int_equal( wisp_create_cloth( s.world, &cloth, &s.cloth ), WISP_OK );
    assert_int_equal( wisp_create_hair( s.world, &hair, &s.hair ), WISP_OK );
    assert_int_equal( wisp_add_collider( s.world, &ball, &s.ball ), WISP_OK );
    return s;
}

static wisp_hit pick( const scene* s, wisp_entity entity, wisp_vec3 from, wisp_vec3 to, float radius )
{
    wisp_hit out;
    assert_int_equal( wisp_pick( s->world, entity, from, to, radius, &out ), WISP_OK );
    return out;
}

TEST( a_way_meets_the_first_and_a_point_the_nearest )
{
    scene s = new_scene();
    const wisp_vec3 above = { 0.03f, 1.0f, 0.02f }, below = { 0.03f, -1.0f, 0.02f }, near = { 0.03f, 0.2f, 0.02f },
                    beside = { 0.7f, 0.0f, 0.0f };
    wisp_hit hit = pick( &s, s.cloth, above, below, 0.0f );
    assert_int_equal( hit.vertex, ROWS / 2 * COLUMNS + COLUMNS / 2 ); // the middle
    assert_true( fabsf( hit.point.y ) < 1e-6f && fabsf( hit.distance - 1.0f ) < 1e-6f );
    bool is_corner = false;
    for ( int c = 0; c < 3; ++c )
    {
        is_corner = is_corner || triangles[hit.triangle][c] == hit.vertex;
    }
    assert_true( is_corner );
    assert_int_equal( pick( &s, s.cloth, above, near, 0.0f ).vertex, -1 ); // ends before it
    assert_int_equal( pick( &s, s.cloth, ( wisp_vec3 ){ 2.0f, 1.0f, 0.0f }, below, 0.0f ).vertex, -1 );
    hit = pick( &s, s.cloth, near, near, 0.3f );
    assert_true( hit.triangle >= 0 && fabsf( hit.distance - 0.2f ) < 1e-6f && fabsf( hit.point.x - 0.03f ) < 1e-6f );
    assert_int_equal( pick( &s, s.cloth, near, near, 0.1f ).vertex, -1 );
    hit = pick( &s, s.cloth, beside, beside, 0.3f ); // the nearest is on the rim
    assert_true( hit.triangle >= 0 && fabsf( hit.distance - 0.1f ) < 1e-6f );
    assert_int_equal( hit.vertex, ROWS / 2 * COLUMNS + COLUMNS - 1 );

    // 5 mm beside the third vertex of the first strand
    const wisp_vec3 v = strand_points[2];
    const wisp_vec3 before = { v.x + 0.005f, v.y, v.z - 1.0f }, behind = { v.x + 0.005f, v.y, v.z + 1.0f };
    hit = pick( &s, s.hair, before, behind, 0.01f );
    assert_true( hit.vertex == 2 && hit.triangle == -1 && fabsf( hit.point.x - v.x ) < 1e-6f );
    assert_int_equal( pick( &s, s.hair, before, behind, 0.001f ).vertex, -1 );
    wisp_hit out;
    expect_refusal( s.world, wisp_pick( s.world, s.cloth, above, below, -1.0f, &out ), WISP_BAD_INPUT, "radius" );
    expect_refusal( s.world, wisp_pick( s.world, s.ball, above, below, 0.0f, &out ), WISP_CONFLICT, "neither" );
    wisp_world_destroy( s.world );
}
