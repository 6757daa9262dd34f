// Pins that go along with another surface.
#include "collision_fixture.h"

#include "attachments_state.h"

static const float DT = 1.0f / 60.0f;

enum
{
    SIDE = 4, // vertices along a side of the base
};

static hosted* open_attached( int substeps, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_attachments_module, &wisp_cloth_module,
                                                  &wisp_collision_module };
    hosted* h = checked_calloc( 1, sizeof( hosted ) );
    h->def = hosted_def( h );
    h->def.modules = MODULES;
    h->def.module_count = WISP_COUNT( MODULES );
    h->def.substeps = substeps;
    h->def.workers = workers;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
    return h;
}

static int count_attached( wisp_world* world, wisp_entity surface )
{
    const attachments_state* state = wisp_world_module_state( world, "attachments" );
    const attachments_place* place = wisp_world_column( world, surface, state->place, 0 );
    int count = 0;
    for ( int slot = 0; place != NULL && slot < wisp_world_fabric( world, surface )->slot_count; ++slot )
    {
        count += place[slot].to.index != 0 ? 1 : 0;
    }
    return count;
}

// A kinematic sheet of 0.3 m in the plane y = 0.
typedef struct base
{
    wisp_entity surface;
    test_mesh mesh;
    int32_t all[SIDE * SIDE];
    wisp_vec3 targets[SIDE * SIDE];
} base;

static base add_base( wisp_world* world )
{
    base b = { .mesh = test_plane( SIDE, 0.1f ) };
    for ( int v = 0; v < SIDE * SIDE; ++v )
    {
        b.all[v] = v;
    }
    wisp_fabric_def fabric = test_fabric_def( &b.mesh );
    wisp_surface_def def = support_weightless_surface_def();
    def.pins = b.all;
    def.pin_count = SIDE * SIDE;
    b.surface = test_surface_of( world, &fabric, def );
    return b;
}

static void pose_base( wisp_world* world, base* b, wisp_transform pose, float stretch )
{
    for ( int v = 0; v < SIDE * SIDE; ++v )
    {
        const wisp_vec3 p = b->mesh.points[v];
        b->targets[v] = wisp_transform_to_world( pose, ( wisp_vec3 ){ stretch * p.x, p.y, p.z } );
    }
    assert_int_equal( wisp_move_pins( world, b->surface, b->all, b->targets, SIDE * SIDE ), WISP_OK );
}

// A triangle whose first vertex is 5 cm above the base.
static wisp_entity add_pinned( wisp_world* world, wisp_vec3 at )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_triangle( at, 0.1f );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def def = support_weightless_surface_def();
    wisp_entity e = test_surface_of( world, &fabric, def );
    assert_int_equal( wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    return e;
}

static wisp_vec3 first_point( wisp_world* world, wisp_entity e )
{
    wisp_view view;
    assert_int_equal( wisp_world_view( world, e, WISP_SURFACE_POINTS, &view ), WISP_OK );
    return *(const wisp_vec3*)view.data;
}

static void assert_at( wisp_world* world, wisp_entity e, wisp_vec3 expected )
{
    const wisp_vec3 p = first_point( world, e );
    assert_near( (double)p.x, (double)expected.x, 2e-6 );
    assert_near( (double)p.y, (double)expected.y, 2e-6 );
    assert_near( (double)p.z, (double)expected.z, 2e-6 );
}

static const wisp_vec3 PIN = { 0.12f, 0.05f, 0.17f };
static const int32_t FIRST[] = { 0 };

TEST( a_pin_goes_along_with_a_rigid_motion )
{
    SCOPED( close_local ) hosted* h = open_attached( 4, 1 );
    base b = add_base( h->world );
    wisp_entity e = add_pinned( h->world, PIN );
    assert_int_equal( wisp_attach_pins( h->world, e, FIRST, 1, b.surface ), WISP_OK );
    assert_int_equal( count_attached( h->world, e ), 1 );
    for ( int n = 0; n < 20; ++n )
    {
        const wisp_transform pose = { about_z( 0.1 * n ), { 0.02f * (float)n, 0.1f, -0.03f * (float)n } };
        pose_base( h->world, &b, pose, 1.0f );
        run_for( h->world, DT, 1 );
        assert_at( h->world, e, wisp_transform_to_world( pose, PIN ) );
    }
    test_mesh_free( &b.mesh );
}

// Barycentric coordinates follow the stretch, the offset along the normal stays.
TEST( a_pin_goes_along_with_a_stretch )
{
    SCOPED( close_local ) hosted* h = open_attached( 3, 1 );
    base b = add_base( h->world );
    wisp_entity e = add_pinned( h->world, PIN );
    assert_int_equal( wisp_attach_pins( h->world, e, FIRST, 1, b.surface ), WISP_OK );
    const wisp_transform none = { { 0, 0, 0, 1 }, { 0, 0, 0 } };
    pose_base( h->world, &b, none, 2.0f );
    run_for( h->world, DT, 1 );
    assert_at( h->world, e, ( wisp_vec3 ){ 2.0f * PIN.x, PIN.y, PIN.z } );
    // nothing is said, so nothing moves
    run_for( h->world, DT, 5 );
    assert_at( h->world, e, ( wisp_vec3 ){ 2.0f * PIN.x, PIN.y, PIN.z } );
    test_mesh_free( &b.mesh );
}

// Vertices that are free count as moving on: in free flight that is where they go.
TEST( a_pin_goes_along_with_a_surface_that_flies )
{
    SCOPED( close_local ) hosted* h = open_attached( 5, 1 );
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( SIDE, 0.1f );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_entity flying = test_surface_of( h->world, &fabric, support_weightless_surface_def() );
    wisp_entity e = add_pinned( h->world, PIN );
    assert_int_equal( wisp_set_velocity( h->world, flying, ( wisp_vec3 ){ 0.3f, 0.6f, 0.0f }, ( wisp_vec3 ){ 0 } ),
                      WISP_OK );
    assert_int_equal( wisp_attach_pins( h->world, e, FIRST, 1, flying ), WISP_OK );
    run_for( h->world, DT, 30 );
    assert_at( h->world, e, ( wisp_vec3 ){ PIN.x + 0.15f, PIN.y + 0.3f, PIN.z } );
}

TEST( detached_and_unpinned_vertices_stay_behind )
{
    SCOPED( close_local ) hosted* h = open_attached( 2, 1 );
    base b = add_base( h->world );
    wisp_entity e = add_pinned( h->world, PIN );
    const int32_t two[] = { 0, 1 };
    assert_int_equal( wisp_attach_pins( h->world, e, two, 2, b.surface ), WISP_OK );
    assert_int_equal( wisp_detach_pins( h->world, e, FIRST, 1 ), WISP_OK );
    assert_int_equal( count_attached( h->world, e ), 1 );
    const wisp_transform up = { { 0, 0, 0, 1 }, { 0, 1, 0 } };
    pose_base( h->world, &b, up, 1.0f );
    run_for( h->world, DT, 1 );
    assert_at( h->world, e, PIN );
    assert_int_equal( wisp_unpin( h->world, e, two + 1, 1 ), WISP_OK );
    run_for( h->world, DT, 1 );
    assert_int_equal( count_attached( h->world, e ), 0 );
    test_mesh_free( &b.mesh );
}

TEST( pins_stay_when_the_other_surface_is_removed )
{
    SCOPED( close_local ) hosted* h = open_attached( 2, 1 );
    base b = add_base( h->world );
    wisp_entity e = add_pinned( h->world, PIN );
    assert_int_equal( wisp_attach_pins( h->world, e, FIRST, 1, b.surface ), WISP_OK );
    run_for( h->world, DT, 1 );
    assert_int_equal( wisp_remove( h->world, b.surface ), WISP_OK );
    assert_int_equal( count_attached( h->world, e ), 0 );
    run_for( h->world, DT, 2 );
    assert_at( h->world, e, PIN );
    assert_int_equal( wisp_remove( h->world, e ), WISP_OK );
    run_for( h->world, DT, 1 );
    test_mesh_free( &b.mesh );
}

TEST( wrong_attachments_are_refused )
{
    SCOPED( close_local ) hosted* h = open_attached( 2, 1 );
    base b = add_base( h->world ), c = add_base( h->world );
    wisp_entity e = add_pinned( h->world, PIN );
    const int32_t beyond[] = { 3 };
    assert_int_equal( wisp_attach_pins( h->world, e, beyond, 1, b.surface ), WISP_BAD_INPUT );
    assert_non_null( strstr( wisp_world_message( h->world ), "vertex 3" ) );
    assert_int_equal( wisp_attach_pins( h->world, e, NULL, 1, b.surface ), WISP_BAD_INPUT );
    assert_int_equal( wisp_attach_pins( h->world, e, FIRST, 1, e ), WISP_CONFLICT );
    assert_int_equal( wisp_attach_pins( h->world, e, FIRST, 1, ( wisp_entity ){ 0, 0 } ), WISP_STALE_ID );
    assert_int_equal( count_attached( h->world, e ), 0 );
    // chains
    assert_int_equal( wisp_attach_pins( h->world, e, FIRST, 1, b.surface ), WISP_OK );
    assert_int_equal( wisp_attach_pins( h->world, c.surface, FIRST, 1, e ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( h->world ), "attached pins itself" ) );
    assert_int_equal( wisp_attach_pins( h->world, b.surface, FIRST, 1, c.surface ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( h->world ), "other pins are attached" ) );
    run_for( h->world, DT, 1 );
    test_mesh_free( &b.mesh );
    test_mesh_free( &c.mesh );
}
