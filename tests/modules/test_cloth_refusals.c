// Invalid cloth is rejected with one message that names the error, and a rejection changes nothing.
#include "cloth_fixture.h"

static wisp_entity add_plain( hosted* h, bool cross, bool hinges, bool attached )
{
    test_mesh mesh = test_plane( 4, 0.1f );
    const int32_t pin = 0;
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = cross;
    fabric.hinges = hinges;
    fabric.attachments = &pin;
    fabric.attachment_count = attached ? 1 : 0;
    wisp_entity e = test_surface_of( h->world, &fabric, support_weightless_surface_def() );
    test_mesh_free( &mesh );
    return e;
}

static void assert_refused( hosted* h, wisp_entity e, const wisp_cloth_def* def, wisp_status expected,
                            const char* word )
{
    uint64_t before = wisp_world_hash( h->world );
    int passes = wisp_world_plan_passes( h->world );
    expect_refusal( h->world, wisp_set_cloth( h->world, e, def ), expected, word );
    assert_int_equal( wisp_world_hash( h->world ), before );
    assert_int_equal( wisp_world_plan_passes( h->world ), passes );
}

WORLD_TEST( every_number_has_its_range )
{
    hosted* h = *state;
    wisp_entity e = add_plain( h, true, true, false );
    const wisp_cloth_def good = wisp_default_cloth_def();
    assert_status( h->world, wisp_set_cloth( h->world, e, &good ), WISP_OK );
#define FIELD( name, lower, upper )                                                                                  \
    {                                                                                                                \
#name, offsetof( wisp_cloth_def, name ), lower, upper                                                        \
    }
    const struct
    {
        const char* name;
        size_t at;
        float lower, upper; // just out of range
    } fields[] = {
        FIELD( warp_compliance, -1e-9f, 1.1e12f ),  FIELD( weft_compliance, -1e-9f, 1.1e12f ),
        FIELD( shear_compliance, -1e-9f, 1.1e12f ), FIELD( stretch_stiffness, -1e-9f, 1.0001f ),
        FIELD( shear_stiffness, -1e-9f, 1.0001f ),  FIELD( bend_stiffness, -1e-9f, 1.0001f ),
        FIELD( bend_compliance, -1e-9f, 1.1e12f ),  FIELD( bend_rigidity, 0.0f, 1.1e12f ),
        FIELD( internal_damping, -1e-9f, 1.1e9f ),  FIELD( air_density, -1e-9f, 1.1e6f ),
        FIELD( drag_coefficient, -1e-9f, 1.1e6f ),  FIELD( lift_coefficient, -1e-9f, 1.1e6f ),
        FIELD( tether_slack, 0.999f, 1.1e6f ),
    };
#undef FIELD
    for ( int i = 0; i < WISP_COUNT( fields ); ++i )
    {
        const float bad[] = { fields[i].lower, fields[i].upper, NAN, INFINITY, -INFINITY };
        for ( int k = 0; k < WISP_COUNT( bad ); ++k )
        {
            wisp_cloth_def def = good;
            memcpy( (char*)&def + fields[i].at, bad + k, sizeof( float ) );
            assert_refused( h, e, &def, WISP_BAD_INPUT, fields[i].name );
        }
    }
}

WORLD_TEST( every_choice_is_one_of_the_list )
{
    hosted* h = *state;
    wisp_entity e = add_plain( h, true, true, false );
    wisp_cloth_def def = wisp_default_cloth_def();
    def.solver = WISP_SOLVER_COUNT;
    assert_refused( h, e, &def, WISP_BAD_INPUT, "solver" );
    def = wisp_default_cloth_def();
    def.bending = WISP_CLOTH_BENDING_COUNT;
    assert_refused( h, e, &def, WISP_BAD_INPUT, "bending" );
    const int passes[] = { -1, 66, INT32_MAX };
    for ( int i = 0; i < WISP_COUNT( passes ); ++i )
    {
        def = wisp_default_cloth_def();
        def.coarse_substeps = passes[i] - 1;
        assert_refused( h, e, &def, WISP_BAD_INPUT, "coarse_substeps" );
        def = wisp_default_cloth_def();
        def.coarse_passes = passes[i];
        assert_refused( h, e, &def, WISP_BAD_INPUT, "coarse_passes" );
    }
    def = wisp_default_cloth_def();
    def.coarse_substeps = 1;
    def.solver = WISP_SOLVER_PBD;
    assert_refused( h, e, &def, WISP_CONFLICT, "coarse sheets need the solver xpbd" );
}

WORLD_TEST( directions_and_winds_are_finite )
{
    hosted* h = *state;
    wisp_entity e = add_plain( h, true, true, false );
    const wisp_vec3 warps[] = { { 0 }, { NAN, 0.0f, 1.0f }, { 0.0f, INFINITY, 0.0f }, { 1e-7f, 0.0f, 0.0f } };
    for ( int i = 0; i < WISP_COUNT( warps ); ++i )
    {
        wisp_cloth_def def = wisp_default_cloth_def();
        def.warp = warps[i];
        assert_refused( h, e, &def, WISP_BAD_INPUT, "warp" );
    }
    const wisp_vec3 winds[] = { { NAN, 0.0f, 0.0f }, { 0.0f, 0.0f, -INFINITY }, { 1.1e5f, 0.0f, 0.0f } };
    wisp_cloth_def airy = wisp_default_cloth_def();
    airy.drag_coefficient = 1.0f;
    assert_status( h->world, wisp_set_cloth( h->world, e, &airy ), WISP_OK );
    for ( int i = 0; i < WISP_COUNT( winds ); ++i )
    {
        wisp_cloth_def def = airy;
        def.wind = winds[i];
        assert_refused( h, e, &def, WISP_BAD_INPUT, "wind" );
        assert_int_equal( wisp_set_cloth_wind( h->world, e, winds[i] ), WISP_BAD_INPUT );
        assert_non_null( strstr( wisp_world_message( h->world ), "wind" ) );
    }
}

WORLD_TEST( a_fabric_must_have_what_the_cloth_needs )
{
    hosted* h = *state;
    wisp_entity bare = add_plain( h, false, false, true ), loose = add_plain( h, true, true, false );
    wisp_cloth_def def = wisp_default_cloth_def();
    assert_refused( h, bare, &def, WISP_CONFLICT, "bend links" );
    def.bending = WISP_CLOTH_BENDING_DIHEDRAL;
    assert_refused( h, bare, &def, WISP_CONFLICT, "hinges" );
    def.bending = WISP_CLOTH_BENDING_ISOMETRIC;
    assert_refused( h, bare, &def, WISP_CONFLICT, "hinges" );
    def.bending = WISP_CLOTH_BENDING_NONE;
    def.tethers = true;
    assert_refused( h, bare, &def, WISP_CONFLICT, "tethers" );
    assert_refused( h, loose, &def, WISP_CONFLICT, "attachments" );
    def.tethers = false;
    assert_status( h->world, wisp_set_cloth( h->world, bare, &def ), WISP_OK );
}

WORLD_TEST( what_is_no_living_surface_is_refused )
{
    hosted* h = *state;
    const wisp_cloth_def def = wisp_default_cloth_def();
    wisp_entity hair = test_add_strands( h->world, 3, 4 ), gone = add_plain( h, true, true, false );
    assert_refused( h, hair, &def, WISP_CONFLICT, "not a surface" );
    assert_int_equal( wisp_set_cloth_wind( h->world, hair, ( wisp_vec3 ){ 0 } ), WISP_CONFLICT );
    assert_status( h->world, wisp_remove( h->world, gone ), WISP_OK );
    assert_refused( h, gone, &def, WISP_STALE_ID, "does not exist" );
    assert_int_equal( wisp_set_cloth_wind( h->world, gone, ( wisp_vec3 ){ 0 } ), WISP_STALE_ID );
}

TEST( a_world_without_the_module_says_so )
{
    hosted h = { 0 };
    h.def = hosted_def( &h );
    h.def.modules = NULL;
    h.def.module_count = 0;
    assert_int_equal( wisp_world_create( &h.def, &h.world, NULL ), WISP_OK );
    wisp_entity e = add_plain( &h, true, true, false );
    const wisp_cloth_def def = wisp_default_cloth_def();
    assert_refused( &h, e, &def, WISP_CONFLICT, "module cloth: not registered" );
    close_world( &h );
}

// From one kind of cloth to one that needs all other components, with each request for memory refused in turn.
TEST( a_change_without_memory_leaves_the_old_cloth )
{
    int refusals = 0;
    for ( int64_t n = 1; n < 100; ++n )
    {
        hosted h;
        open_world( &h, 1, 1 );
        wisp_entity e = add_plain( &h, true, true, false );
        const wisp_cloth_def old = wisp_default_cloth_def();
        assert_status( h.world, wisp_set_cloth( h.world, e, &old ), WISP_OK );
        wisp_cloth_def other = old;
        other.solver = WISP_SOLVER_PBD;
        other.bending = WISP_CLOTH_BENDING_DIHEDRAL;
        other.drag_coefficient = other.internal_damping = 1.0f;
        uint64_t before = wisp_world_hash( h.world );
        test_host_refuse( &h.host, n, false );
        wisp_status status = wisp_set_cloth( h.world, e, &other );
        bool refused = test_host_has_refused( &h.host );
        test_host_refuse( &h.host, 0, false );
        if ( refused )
        {
            assert_int_equal( status, WISP_NO_MEMORY );
            assert_int_equal( wisp_world_hash( h.world ), before );
            assert_true( wisp_world_has( h.world, e, WISP_LINK_COMPLIANCE ) );
            assert_false( wisp_world_has( h.world, e, WISP_HINGE_REST ) );
            refusals += 1;
        }
        assert_status( h.world, wisp_set_cloth( h.world, e, &other ), WISP_OK );
        run_steps( h.world, 2, 0.01f );
        close_world( &h );
        if ( refused == false )
        {
            break;
        }
    }
    assert_in_range( refusals, 5, 98 ); // at least one per column
}
