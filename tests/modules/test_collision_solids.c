// Tapered capsules, convex polyhedra and height fields as bodies: as the shapes that they generalise, at any speed, for surfaces and
// strands, and what is refused.
#include "collision_fixture.h"
#include "strands.h"

#include "wisp/module/shapes.h"

static const float DT = 1.0f / 60.0f;

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
        hosted* h = new_colliding( 2, 1, 1 );
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
        int contacts = 0;
        for ( int s = 0; s < steps; ++s )
        {
            run_for( h->world, DT, 1 );
            const int now = collision_of( h->world, patch ).contacts;
            contacts = now > contacts ? now : contacts;
            const wisp_view v = view_of( h->world, patch, WISP_SURFACE_POINTS );
            for ( int i = 0; i < v.count; ++i )
            {
                const wisp_vec3 p = ( (const wisp_vec3*)v.data )[i];
                wisp_surface_point at;
                assert_true( wisp_shape_closest( &shape, p, &at ) );
                // in front, and above or deflected outwards: not out at the other side
                assert_true( at.distance > 0.005f && ( p.y > -0.05f || sqrtf( p.x * p.x + p.z * p.z ) > 0.3f ) );
            }
        }
        assert_true( contacts > 20 );
        wisp_convex_release( convex );
        free_colliding( h );
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
        hosted* h = checked_calloc( 1, sizeof( hosted ) );
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
        const wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
        assert_int_equal( wisp_set_strand_dynamics( h->world, hair, &dynamics ), WISP_OK );
        wisp_collision_def collision = wisp_default_collision_def();
        collision.thickness = 0.01f;
        assert_int_equal( wisp_set_collision( h->world, hair, &collision ), WISP_OK );
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
        free_colliding( h );
    }
}

COLLISION_TEST( a_wrong_solid_is_refused_and_costs_nothing )
{
    hosted* h = *state;
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
