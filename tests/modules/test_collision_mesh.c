// Triangle meshes as bodies and as sheets, through Embree; without it the tests of meshes are skipped. Tapered capsules, convex
// polyhedra and height fields as bodies: as the shapes that they generalise, at any speed, for surfaces and strands, and
// what is refused.
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

// A square sheet of side 2 in the plane y = 0 of its frame.
static wisp_entity add_sheet( wisp_world* world, wisp_collider_def* def )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 3, 1.0f );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ -1.0f, 0.0f, -1.0f } );
    *def = mesh_body( &mesh );
    def->double_sided = true;
    return add_collider( world, def );
}

TEST( cloth_lies_on_a_mesh_as_on_the_closed_form )
{
    wisp_motion_stats result[2];
    for ( int k = 0; k < 2; ++k )
    {
        SCOPED( close_local ) hosted* h = new_colliding( 4, 4, 1 );
        add_ball( h->world, k == 1, 1.0f );
        wisp_entity e = add_cloth( h->world, 13, 0.7f, ( wisp_vec3 ){ 0.0f, 0.4f, 0.0f }, GRAVITY );
        for ( int n = 0; n < 300; ++n )
        {
            run_for( h->world, DT, 1 );
            const wisp_collision_stats stats = collision_of( h->world, e );
            // rounding in closed form; on a mesh also the offset from the plane of a neighbouring face
            assert_true( stats.penetration <= 0.05f * 0.0166f );
        }
        assert_true( collision_of( h->world, e ).penetration <= 0.01f * 0.0166f );
        assert_true( collision_of( h->world, e ).contacts > 30 );
        result[k] = motion_stats_of( h->world, e );
    }
    // faces of the mesh lie up to 0.3 (1 - cos( 90 / 32 degrees )), 4e-4 m, inside the ball; cloth folds freely
    assert_near( result[0].centre[1], result[1].centre[1], 0.02 );
    assert_near( result[0].centre[0], result[1].centre[0], 0.02 );
    assert_near( result[0].centre[2], result[1].centre[2], 0.02 );
}

TEST( results_on_a_mesh_scale_with_the_scene )
{
    const float scales[] = { 1.0f, 0.01f, 100.0f };
    double height[3];
    for ( int k = 0; k < 3; ++k )
    {
        SCOPED( close_local ) hosted* h = new_colliding( 4, 4, 1 );
        add_ball( h->world, true, scales[k] );
        wisp_entity e = add_cloth( h->world, 9, 0.5f * scales[k], ( wisp_vec3 ){ 0.0f, 0.4f * scales[k], 0.0f },
                                   GRAVITY * scales[k] );
        run_for( h->world, DT, 90 );
        assert_true( collision_of( h->world, e ).contacts > 20 );
        assert_true( collision_of( h->world, e ).penetration <= 0.01f * 0.0178f * scales[k] );
        height[k] = motion_stats_of( h->world, e ).centre[1] / (double)scales[k];
    }
    assert_near( height[1], height[0], 0.01 );
    assert_near( height[2], height[0], 0.01 );
}

COLLISION_TEST( a_sheet_at_100_m_s_sweeps_particles_along )
{
    wisp_collider_def def;
    wisp_entity double_sided = add_sheet( h->world, &def );
    wisp_entity e = add_cloth( h->world, 7, 0.6f, ( wisp_vec3 ){ 0.03f, 0.7f, 0.02f }, 0.0f );
    for ( int n = 1; n <= 5; ++n )
    {
        // rotating as it moves
        const wisp_transform pose = { about_z( 0.05 * n ), { 0.0f, 100.0f * DT * (float)n, 0.0f } };
        assert_int_equal( wisp_move_collider( h->world, double_sided, pose ), WISP_OK );
        run_for( h->world, DT, 1 );
        const wisp_view view = view_of( h->world, e, WISP_SURFACE_POINTS );
        for ( int v = 0; v < view.count; ++v )
        {
            assert_true( wisp_transform_to_local( pose, ( (const wisp_vec3*)view.data )[v] ).y > 0.0f );
        }
    }
}

// Constraints move particles after the search for contacts; those that they pull through a sheet are caught.
TEST( cloth_that_is_torn_through_a_sheet_by_its_pins_stays_on_its_side )
{
    SCOPED( close_local ) hosted* h = new_colliding( 1, 20, 1 );
    wisp_collider_def def;
    add_sheet( h->world, &def );
    wisp_entity e = add_cloth( h->world, 7, 0.6f, ( wisp_vec3 ){ 0.03f, 0.2f, 0.02f }, GRAVITY );
    const int32_t pin = 24;
    assert_int_equal( wisp_pin( h->world, e, &pin, 1 ), WISP_OK );
    wisp_vec3 target = point_of( h->world, e, pin );
    run_for( h->world, DT, 2 );
    target = point_of( h->world, e, pin );
    for ( int n = 0; n < 30; ++n )
    {
        target.y = n % 2 == 0 ? -0.8f : 0.2f;
        assert_int_equal( wisp_move_pins( h->world, e, &pin, &target, 1 ), WISP_OK );
        run_for( h->world, DT, 1 );
        for ( int v = 0; v < 49; ++v )
        {
            const wisp_vec3 p = point_of( h->world, e, v );
            assert_true( v == pin || p.y > 0.0f || fabsf( p.x ) > 1.0f || fabsf( p.z ) > 1.0f );
        }
    }
}

TEST( what_starts_inside_a_mesh_leaves_without_flying_off )
{
    SCOPED( close_local ) hosted* h = new_colliding( 1, 8, 1 );
    add_ball( h->world, true, 1.0f );
    wisp_entity e = add_cloth( h->world, 9, 0.24f, ( wisp_vec3 ){ 0.0f, 0.1f, 0.0f }, 0.0f );
    float edge = 0.03f * ( 2.0f + sqrtf( 2.0f ) ) / 3.0f;
    run_for( h->world, DT, 240 );
    assert_true( collision_of( h->world, e ).penetration < 0.1f * edge );
    const wisp_motion_stats q = motion_stats_of( h->world, e );
    // at most at the limit of ten edges a second
    assert_true( fabs( q.momentum[1] ) / q.mass < 10.0 * (double)edge );
    assert_true( q.centre[1] > 0.2 && q.centre[1] < 2.0 );
}

TEST( a_mesh_that_moves_is_answered_in_its_own_frame )
{
    double height[2];
    for ( int k = 0; k < 2; ++k )
    {
        SCOPED( close_local ) hosted* h = new_colliding( 2, 4, 1 );
        wisp_entity ball = add_ball( h->world, k == 1, 1.0f );
        wisp_entity e = add_cloth( h->world, 9, 0.4f, ( wisp_vec3 ){ 0.0f, 0.35f, 0.0f }, GRAVITY );
        for ( int n = 1; n <= 60; ++n )
        {
            const wisp_transform pose = { about_z( 0.004 * n ), { 0.0f, 0.02f * (float)n, 0.0f } };
            assert_int_equal( wisp_move_collider( h->world, ball, pose ), WISP_OK );
            run_for( h->world, DT, 1 );
            assert_true( collision_of( h->world, e ).penetration < 0.05f * 0.0142f );
        }
        height[k] = motion_stats_of( h->world, e ).centre[1];
        assert_true( height[k] > 1.2 );
    }
    assert_near( height[0], height[1], 0.02 );
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

// The shape of a body, for distances.
static wisp_shape shape_of( const wisp_collider_def* def, wisp_convex** convex )
{
    *convex = NULL;
    wisp_shape shape = { .kind = WISP_SHAPE_TAPERED_CAPSULE,
                         .half_length = def->half_length,
                         .top_radius = def->top_radius,
                         .bottom_radius = def->bottom_radius };
    if ( def->kind == WISP_COLLIDER_CONVEX )
    {
        assert_int_equal( wisp_convex_create( def->points, def->point_count, NULL, convex, NULL ), WISP_OK );
        shape = ( wisp_shape ){ .kind = WISP_SHAPE_CONVEX, .convex = *convex };
    }
    if ( def->kind == WISP_COLLIDER_HEIGHT_FIELD )
    {
        shape = ( wisp_shape ){ .kind = WISP_SHAPE_HEIGHT_FIELD,
                                .height_field = { def->heights, def->height_count_x, def->height_count_z,
                                                  def->spacing } };
    }
    return shape;
}

static const wisp_collider_kind KINDS[] = { WISP_COLLIDER_TAPERED_CAPSULE, WISP_COLLIDER_CONVEX,
                                            WISP_COLLIDER_HEIGHT_FIELD };

TEST( nothing_passes_at_any_speed )
{
    const float speeds[] = { 1.0f, 30.0f, 300.0f, 3000.0f };
    for ( int n = 0; n < 3 * WISP_COUNT( speeds ); ++n )
    {
        const float speed = speeds[n / 3];
        SCOPED( close_local ) hosted* h = new_colliding( 2, 1, 1 );
        const wisp_collider_def def = solid_of( KINDS[n % 3] );
        wisp_convex* convex;
        const wisp_shape shape = shape_of( &def, &convex );
        add_collider( h->world, &def );
        // free particles above the body, all within its width
        test_mesh mesh = test_plane( 9, 0.02f );
        move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ -0.08f, 0.6f, -0.08f } );
        wisp_collision_def collision = wisp_default_collision_def();
        collision.thickness = 0.01f;
        const wisp_entity patch = add_colliding( h->world, &mesh, &collision );
        test_mesh_free( &mesh );
        assert_int_equal( wisp_set_velocity( h->world, patch, ( wisp_vec3 ){ 0.0f, -speed, 0.0f },
                                             ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ),
                          WISP_OK );
        const int steps = 1 + (int)( 0.8f / ( speed * DT ) );
        int stopped = 0;
        for ( int s = 0; s < steps; ++s )
        {
            run_for( h->world, DT, 1 );
            const wisp_view v = view_of( h->world, patch, WISP_SURFACE_POINTS );
            const float alone = 0.6f - speed * DT * (float)( s + 1 );
            stopped = 0;
            for ( int i = 0; i < v.count; ++i )
            {
                stopped += ( (const wisp_vec3*)v.data )[i].y > alone + 0.005f ? 1 : 0;
                const wisp_vec3 p = ( (const wisp_vec3*)v.data )[i];
                wisp_surface_point at;
                assert_true( wisp_shape_closest( &shape, p, &at ) );
                // in front, and above or deflected outwards: not out at the other side
                assert_true( at.distance > 0.005f && ( p.y > -0.05f || sqrtf( p.x * p.x + p.z * p.z ) > 0.3f ) );
            }
        }
        assert_true( stopped > 20 );
        wisp_convex_release( convex );
    }
}

// The largest distance between points of two cloths on bodies that are the same.
static float difference_of( const wisp_collider_def* a, const wisp_collider_def* b )
{
    hosted* h[2];
    wisp_entity cloth[2];
    for ( int i = 0; i < 2; ++i )
    {
        h[i] = new_colliding( 8, 1, 1 );
        add_collider( h[i]->world, i == 0 ? a : b );
        cloth[i] = add_cloth( h[i]->world, 13, 0.9f, ( wisp_vec3 ){ 0.03f, 0.5f, 0.02f }, 9.8f );
        run_for( h[i]->world, DT, 20 );
        assert_true( collision_of( h[i]->world, cloth[i] ).contacts > 0 );
    }
    const wisp_view u = view_of( h[0]->world, cloth[0], WISP_SURFACE_POINTS ),
                    v = view_of( h[1]->world, cloth[1], WISP_SURFACE_POINTS );
    float most = 0.0f;
    for ( int i = 0; i < 3 * u.count; ++i )
    {
        most = fmaxf( most, fabsf( ( (const float*)u.data )[i] - ( (const float*)v.data )[i] ) );
    }
    free_colliding( h[0] );
    free_colliding( h[1] );
    return most;
}

TEST( special_cases_move_a_cloth_as_the_plain_shapes_do )
{
    wisp_collider_def tapered = solid_of( WISP_COLLIDER_TAPERED_CAPSULE ), capsule = body_of( WISP_COLLIDER_CAPSULE );
    tapered.top_radius = tapered.bottom_radius = capsule.radius;
    assert_float_equal( difference_of( &tapered, &capsule ), 0.0f, 0.0f );
    const wisp_collider_def convex = solid_of( WISP_COLLIDER_CONVEX ), box = body_of( WISP_COLLIDER_BOX );
    // roundings of 1e-7 grow while it slides
    assert_float_equal( difference_of( &convex, &box ), 0.0f, 1e-4f );
    static const float level[4] = { 0.1f, 0.1f, 0.1f, 0.1f };
    wisp_collider_def field = solid_of( WISP_COLLIDER_HEIGHT_FIELD ), plane = body_of( WISP_COLLIDER_PLANE );
    field.heights = level;
    field.height_count_x = field.height_count_z = 2;
    plane.pose.translation.y = 0.1f;
    assert_float_equal( difference_of( &field, &plane ), 0.0f, 1e-4f );
}

TEST( hair_stays_out )
{
    static const wisp_module* const MODULES[] = { &wisp_strands_module, &wisp_collision_module };
    for ( int k = 0; k < WISP_COUNT( KINDS ); ++k )
    {
        SCOPED( close_local ) hosted* h = checked_calloc( 1, sizeof( hosted ) );
        h->def = hosted_def( h );
        h->def.modules = MODULES;
        h->def.module_count = WISP_COUNT( MODULES );
        h->def.substeps = 10;
        assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
        const wisp_collider_def def = solid_of( KINDS[k] );
        add_collider( h->world, &def );
        wisp_vec3 points[17][21];
        int32_t offsets[18] = { 0 };
        for ( int i = 0; i < 17 * 21; ++i )
        {
            points[i / 21][i % 21] =
                ( wisp_vec3 ){ -0.5f + 0.03f * (float)( i % 21 ), 0.4f, 0.01f * (float)( i / 21 - 8 ) };
            offsets[i / 21 + 1] = 21 * ( i / 21 + 1 );
        }
        wisp_strands_def strands = wisp_default_strands_def();
        strands.points = points[0];
        strands.offsets = offsets;
        strands.strand_count = 17;
        wisp_entity hair;
        assert_int_equal( wisp_add_strands( h->world, &strands, &hair ), WISP_OK );
        SET_DEFAULT( h->world, hair, strand_dynamics );
        SET( h->world, hair, collision, d.thickness = 0.01f );
        assert_int_equal( wisp_request_collision_stats( h->world, hair, true ), WISP_OK );
        int contacts = 0;
        for ( int n = 0; n < 90; ++n )
        {
            run_for( h->world, DT, 1 );
            const wisp_collision_stats s = collision_of( h->world, hair );
            contacts = s.contacts > contacts ? s.contacts : contacts;
            assert_true( s.penetration < 0.01f ); // less than the thickness: outside
        }
        assert_true( contacts > 17 );
    }
}

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
