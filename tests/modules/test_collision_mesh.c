// Triangle meshes, tapered capsules, convex polyhedra and height fields as bodies: their memory, and what is refused. Motion is in
// tests/claims/collision.yaml.
#include "collision_fixture.h"

#include "strands.h"

#include "wisp/module/shapes.h"

// ---- meshes ----

static const float GRAVITY = 9.8f;
static const float DT = 1.0f / 60.0f;

// A ball of radius 0.3 in closed form or as 8 4^level triangles.
static wisp_entity add_ball( wisp_world* world, bool as_mesh, float scale )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_SPHERE;
    def.radius = 0.3f * scale;
    if ( as_mesh == false )
    {
        return add_collider( world, &def );
    }
    SCOPED( test_mesh_free ) test_mesh mesh = test_ball( 4 );
    move_mesh( &mesh, 0.3f * scale, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    def = mesh_body( &mesh );
    return add_collider( world, &def );
}

COLLISION_TEST( trees_go_with_their_bodies )
{
    wisp_entity e = add_cloth( h->world, 5, 0.4f, ( wisp_vec3 ){ 0.0f, 0.4f, 0.0f }, GRAVITY );
    run_for( h->world, DT, 1 );
    wisp_entity first = add_ball( h->world, true, 1.0f );
    assert_int_equal( wisp_remove( h->world, first ), WISP_OK );
    size_t before = wisp_world_memory( h->world );
    for ( int n = 0; n < 5; ++n )
    {
        wisp_entity ball = add_ball( h->world, true, 1.0f );
        assert_true( wisp_world_memory( h->world ) > before + 1000 );
        run_for( h->world, DT, 2 );
        assert_int_equal( wisp_remove( h->world, ball ), WISP_OK );
    }
    run_for( h->world, DT, 60 );
    assert_true( motion_stats_of( h->world, e ).centre[1] < -1.0 );
    add_ball( h->world, true, 1.0f ); // and the rest is freed with the world
}

static void assert_refused( wisp_world* world, const wisp_collider_def* def, const char* word )
{
    wisp_entity e;
    size_t before = wisp_world_memory( world );
    assert_int_equal( wisp_add_collider( world, def, &e ), WISP_BAD_INPUT );
    assert_int_equal( e.index, 0 );
    assert_one_message( wisp_world_message( world ) );
    assert_contains( wisp_world_message( world ), word );
    assert_int_equal( wisp_world_memory( world ), before );
}

COLLISION_TEST( impossible_meshes_are_refused )
{
    wisp_entity unused;
    wisp_collider_def plane = wisp_default_collider_def();
    assert_int_equal( wisp_add_collider( h->world, &plane, &unused ), WISP_OK ); // the list of bodies exists now
    SCOPED( test_mesh_free ) test_mesh ball = test_ball( 1 );
    wisp_collider_def def = mesh_body( &ball );
    def.triangle_count -= 1;
    assert_refused( h->world, &def, "3 open edges" );
    def.triangle_count = 0;
    assert_refused( h->world, &def, "triangle" );
    def = mesh_body( &ball );
    def.points = NULL;
    assert_refused( h->world, &def, "point" );
    def = mesh_body( &ball );
    ball.points[5].y = NAN;
    assert_refused( h->world, &def, "point 5" );
    test_mesh_free( &ball );
    ball = test_ball( 1 );
    def = mesh_body( &ball );
    ball.triangles[4] = 99;
    assert_refused( h->world, &def, "99" );
    test_mesh_free( &ball );
    ball = test_ball( 1 );
    def = mesh_body( &ball );
    for ( int t = 0; t < ball.triangle_count; ++t )
    {
        int32_t* corners = ball.triangles + 3 * (size_t)t;
        int32_t first = corners[0];
        corners[0] = corners[1];
        corners[1] = first;
    }
    assert_refused( h->world, &def, "inwards" );
}

// ---- solids ----

static const float HEIGHTS[25] = { 0.1f,  0.0f, 0.0f, 0.05f, 0.1f, 0.0f, 0.0f, 0.1f, 0.0f, 0.0f, 0.0f, 0.1f, 0.2f,
                                   0.05f, 0.0f, 0.0f, 0.0f,  0.1f, 0.0f, 0.0f, 0.1f, 0.0f, 0.0f, 0.0f, 0.1f };
static const wisp_vec3 CORNERS[8] = { { -0.3f, -0.2f, -0.25f }, { 0.3f, -0.2f, -0.25f }, { -0.3f, 0.2f, -0.25f },
                                      { 0.3f, 0.2f, -0.25f },   { -0.3f, -0.2f, 0.25f }, { 0.3f, -0.2f, 0.25f },
                                      { -0.3f, 0.2f, 0.25f },   { 0.3f, 0.2f, 0.25f } };

static wisp_collider_def solid_of( wisp_collider_kind kind )
{
    wisp_collider_def def = body_of( kind );
    def.top_radius = 0.15f;
    def.bottom_radius = 0.3f;
    def.points = CORNERS;
    def.point_count = 8;
    def.heights = HEIGHTS;
    def.height_count_x = def.height_count_z = 5;
    def.spacing = 0.4f;
    return def;
}

static const wisp_collider_kind KINDS[] = { WISP_COLLIDER_TAPERED_CAPSULE, WISP_COLLIDER_CONVEX,
                                            WISP_COLLIDER_HEIGHT_FIELD };

COLLISION_TEST( a_wrong_solid_is_refused_and_costs_nothing )
{
    static const float bad_heights[4] = { 0.0f, 0.0f, NAN, 0.0f };
    wisp_collider_def rows[8];
    const char* words[8] = { "top_radius", "bottom_radius",  "half_length", "lie in a plane",
                             "0 points",   "height_count_x", "spacing",     "height 0 of row 1" };
    for ( int i = 0; i < 8; ++i )
    {
        rows[i] = solid_of( i < 3 ? WISP_COLLIDER_TAPERED_CAPSULE
                                  : ( i < 5 ? WISP_COLLIDER_CONVEX : WISP_COLLIDER_HEIGHT_FIELD ) );
    }
    rows[0].top_radius = 0.0f;
    rows[1].bottom_radius = NAN;
    rows[2].half_length = -1.0f;
    rows[3].point_count = 4; // a face of the box
    rows[4].point_count = 0;
    rows[5].height_count_x = 1;
    rows[6].spacing = 0.0f;
    rows[7].heights = bad_heights;
    rows[7].height_count_x = rows[7].height_count_z = 2;
    for ( int i = 0; i < 8; ++i )
    {
        wisp_entity e;
        assert_int_equal( wisp_add_collider( h->world, rows + i, &e ), WISP_BAD_INPUT );
        assert_one_message( wisp_world_message( h->world ) );
        if ( strstr( wisp_world_message( h->world ), words[i] ) == NULL )
        {
            fail_msg( "'%s' does not name '%s'", wisp_world_message( h->world ), words[i] );
        }
    }
    // what is added is freed: the fixture counts memory
    for ( int k = 0; k < WISP_COUNT( KINDS ); ++k )
    {
        const wisp_collider_def def = solid_of( KINDS[k] );
        const wisp_entity e = add_collider( h->world, &def );
        assert_true( k % 2 == 0 || wisp_remove( h->world, e ) == WISP_OK );
    }
}
