// Teleports: an entity that is moved at once continues as if it had always been there.
#include "effects_fixture.h"

enum
{
    BEFORE = 30, // steps
    AFTER = 10,
};

// A half turn about the axis of gravity, then 9 m. All of it is exact in floats as long as positions are.
static const wisp_transform MOTION = { { 0.0f, 1.0f, 0.0f, 0.0f }, { 4.0f, 0.0f, 8.0f } };

static void open_effects( hosted* h, int workers )
{
    *h = ( hosted ){ 0 };
    h->def = hosted_def( h );
    h->def.modules = EFFECTS;
    h->def.module_count = WISP_COUNT( EFFECTS );
    h->def.substeps = 8;
    h->def.workers = workers;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
}

static void make_steps( hosted* h, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        assert_status( h->world, wisp_world_step( h->world, 1.0f / 60.0f ), WISP_OK );
    }
}

static wisp_component points_of( wisp_world* world, wisp_entity e )
{
    return wisp_world_has( world, e, WISP_PARTICLE_MASS ) ? WISP_SURFACE_POINTS : WISP_STRAND_POINTS;
}

static wisp_view host_view( hosted* h, wisp_entity e )
{
    wisp_view view;
    assert_status( h->world, wisp_world_view( h->world, e, points_of( h->world, e ), &view ), WISP_OK );
    return view;
}

static void request_points( hosted* h, wisp_entity e )
{
    assert_status( h->world, wisp_request( h->world, e, points_of( h->world, e ) ), WISP_OK );
    assert_status( h->world, wisp_request( h->world, e, WISP_MOTION_STATS ), WISP_OK );
}

// Largest distance of the points of an entity to those of a twin that was not teleported but is carried there now.
static double distance_to_twin( hosted* h, wisp_entity e, hosted* twin, wisp_entity original )
{
    const wisp_view a = host_view( h, e ), b = host_view( twin, original );
    double most = 0.0;
    for ( int i = 0; i < a.count; ++i )
    {
        most = fmax( most, vec_distance( ( (const wisp_vec3*)a.data )[i],
                                         wisp_transform_to_world( MOTION, ( (const wisp_vec3*)b.data )[i] ) ) );
    }
    return most;
}

static wisp_entity second_order_cloth( wisp_world* world )
{
    const wisp_entity e = implicit_cloth( world );
    wisp_implicit_cloth_def def = wisp_default_implicit_cloth_def();
    def.integrator = WISP_INTEGRATOR_BDF2;
    assert_status( world, wisp_set_implicit_cloth( world, e, &def ), WISP_OK );
    return e;
}

static const struct
{
    const char* name;
    effect_setup* add;
} KINDS[] = {
    { "cloth with bend links", cloth_of_links },
    { "cloth with dihedral bending", dihedral_cloth },
    { "implicit cloth", implicit_cloth },
    { "implicit cloth of second order", second_order_cloth },
    { "balloon", balloon },
    { "strands of links", hair_of_links },
    { "strands of rods", hair_of_rods },
};

TEST( an_entity_goes_on_as_if_it_had_been_there )
{
    for ( int k = 0; k < WISP_COUNT( KINDS ); ++k )
    {
        hosted twin, h;
        open_effects( &twin, 1 );
        open_effects( &h, 1 );
        const wisp_entity original = KINDS[k].add( twin.world ), e = KINDS[k].add( h.world );
        request_points( &twin, original );
        request_points( &h, e );
        make_steps( &twin, BEFORE );
        make_steps( &h, BEFORE );
        assert_status( h.world, wisp_teleport( h.world, e, MOTION, true ), WISP_OK );
        const double at_once = distance_to_twin( &h, e, &twin, original );
        make_steps( &twin, AFTER );
        make_steps( &h, AFTER );
        const double later = distance_to_twin( &h, e, &twin, original );
        // Cloth that buckles makes millimetres of the rounding at the new place in these steps.
        if ( !( at_once < 3e-6 && later < 5e-3 ) )
        {
            fail_msg( "%s: %.3g m from its twin at once, %.3g m after %d steps", KINDS[k].name, at_once, later,
                      AFTER );
        }
        close_world( &h );
        close_world( &twin );
    }
}

static double sum_of_speeds( wisp_world* world, wisp_entity e )
{
    const bool is_surface = wisp_world_has( world, e, WISP_PARTICLE_MASS );
    const float* v = wisp_world_column( world, e, is_surface ? WISP_PARTICLE_VELOCITY : WISP_STRAND_VELOCITY, 0 );
    const int count = is_surface ? 4 * wisp_world_fabric( world, e )->slot_count
                                 : 3 * WISP_LANES * wisp_world_strands( world, e )->row_count;
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        sum += fabs( (double)v[i] );
    }
    return sum;
}

// What moves before the teleport moves after it only by what forces do in a step: far less than it did.
TEST( velocities_can_end )
{
    for ( int k = 0; k < WISP_COUNT( KINDS ); ++k )
    {
        hosted h;
        open_effects( &h, 1 );
        const wisp_entity e = KINDS[k].add( h.world );
        request_points( &h, e );
        make_steps( &h, 2 );
        const double before = sum_of_speeds( h.world, e );
        assert_status( h.world, wisp_teleport( h.world, e, MOTION, false ), WISP_OK );
        assert_true( sum_of_speeds( h.world, e ) == 0.0 );
        make_steps( &h, 1 );
        const double after = sum_of_speeds( h.world, e );
        if ( !( after < 0.7 * before ) )
        {
            fail_msg( "%s: sum of speeds %.3g m/s before, %.3g m/s after a step", KINDS[k].name, before, after );
        }
        close_world( &h );
    }
}

// A sheet on a ball, teleported with it, lies on it as before; contact of two sheets goes along too.
static wisp_entity lay_on_ball( wisp_world* world, wisp_entity* ball, wisp_entity* upper )
{
    test_mesh mesh = test_plane( 13, 0.05f );
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_entity sheets[2];
    for ( int i = 0; i < 2; ++i )
    {
        for ( int v = 0; v < mesh.vertex_count; ++v )
        {
            mesh.points[v].x -= i == 0 ? 0.3f : 0.0f;
            mesh.points[v].z -= i == 0 ? 0.3f : 0.0f;
            mesh.points[v].y = 0.02f + 0.02f * (float)i;
        }
        sheets[i] = test_surface_of( world, &fabric, support_weightless_surface_def() );
        const wisp_cloth_def cloth = wisp_default_cloth_def();
        const wisp_collision_def collision = wisp_default_collision_def();
        const wisp_contact_def contact = wisp_default_contact_def();
        assert_status( world, wisp_set_cloth( world, sheets[i], &cloth ), WISP_OK );
        assert_status( world, wisp_set_gravity( world, sheets[i], EARTH ), WISP_OK );
        assert_status( world, wisp_set_collision( world, sheets[i], &collision ), WISP_OK );
        assert_status( world, wisp_set_contact( world, sheets[i], &contact ), WISP_OK );
    }
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_SPHERE;
    def.radius = 0.2f;
    def.pose.translation = ( wisp_vec3 ){ 0.0f, -0.2f, 0.0f };
    assert_status( world, wisp_add_collider( world, &def, ball ), WISP_OK );
    test_mesh_free( &mesh );
    *upper = sheets[1];
    return sheets[0];
}

TEST( bodies_and_what_lies_on_them_go_together )
{
    hosted twin, h;
    open_effects( &twin, 1 );
    open_effects( &h, 1 );
    wisp_entity balls[2], uppers[2], lowers[2];
    lowers[0] = lay_on_ball( twin.world, &balls[0], &uppers[0] );
    lowers[1] = lay_on_ball( h.world, &balls[1], &uppers[1] );
    const wisp_entity moved[3] = { balls[1], uppers[1], lowers[1] };
    request_points( &twin, lowers[0] );
    request_points( &h, lowers[1] );
    make_steps( &twin, BEFORE );
    make_steps( &h, BEFORE );
    for ( int i = 0; i < 3; ++i )
    {
        assert_status( h.world, wisp_teleport( h.world, moved[i], MOTION, true ), WISP_OK );
    }
    make_steps( &twin, 5 );
    make_steps( &h, 5 );
    assert_true( distance_to_twin( &h, lowers[1], &twin, lowers[0] ) < 2e-3 );
    close_world( &h );
    close_world( &twin );
}

// A collider that passes through a sheet in a teleport does not touch it, and gives it no velocity.
TEST( a_collider_meets_nothing_on_its_way )
{
    hosted h;
    open_effects( &h, 1 );
    const wisp_entity e = cloth_of_links( h.world );
    const wisp_collision_def collision = wisp_default_collision_def();
    assert_status( h.world, wisp_set_collision( h.world, e, &collision ), WISP_OK );
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_SPHERE;
    def.radius = 0.1f;
    def.pose.translation = ( wisp_vec3 ){ 0.5f, 0.0f, -3.0f };
    wisp_entity ball;
    assert_status( h.world, wisp_add_collider( h.world, &def, &ball ), WISP_OK );
    request_points( &h, e );
    make_steps( &h, 600 );
    const double rest = motion_stats_of( h.world, e ).speed_max;
    const wisp_transform across = { { 0, 0, 0, 1 }, { 0.0f, -0.5f, 9.0f } };
    assert_status( h.world, wisp_teleport( h.world, ball, across, true ), WISP_OK );
    make_steps( &h, 2 );
    assert_true( motion_stats_of( h.world, e ).speed_max < rest + 1e-3 );
    close_world( &h );
}

static wisp_entity root_on( wisp_world* world, wisp_entity surface )
{
    wisp_vec3 points[8];
    for ( int v = 0; v < 8; ++v )
    {
        points[v] = ( wisp_vec3 ){ 0.4f + 0.2f * (float)( v / 4 ), -0.02f * (float)( v % 4 ), 0.4f };
    }
    const int32_t offsets[] = { 0, 4, 8 };
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = 2;
    wisp_entity e;
    const wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    assert_status( world, wisp_add_strands( world, &def, &e ), WISP_OK );
    assert_status( world, wisp_set_strand_dynamics( world, e, &dynamics ), WISP_OK );
    assert_status( world, wisp_root_strands( world, e, surface ), WISP_OK );
    return e;
}

TEST( strands_on_a_surface_go_along )
{
    hosted twin, h;
    open_effects( &twin, 1 );
    open_effects( &h, 1 );
    const wisp_entity on[2] = { cloth_of_links( twin.world ), cloth_of_links( h.world ) };
    const wisp_entity hairs[2] = { root_on( twin.world, on[0] ), root_on( h.world, on[1] ) };
    request_points( &twin, hairs[0] );
    request_points( &h, hairs[1] );
    make_steps( &twin, BEFORE );
    make_steps( &h, BEFORE );
    expect_refusal( h.world, wisp_teleport( h.world, hairs[1], MOTION, true ), WISP_CONFLICT, "rooted in a surface" );
    assert_status( h.world, wisp_teleport( h.world, on[1], MOTION, true ), WISP_OK );
    assert_true( distance_to_twin( &h, hairs[1], &twin, hairs[0] ) < 3e-6 );
    make_steps( &twin, AFTER );
    make_steps( &h, AFTER );
    assert_true( distance_to_twin( &h, hairs[1], &twin, hairs[0] ) < 1e-3 );
    close_world( &h );
    close_world( &twin );
}

// Views between two steps are on neither side of the gap.
TEST( views_are_not_interpolated_across_a_teleport )
{
    hosted h;
    open_effects( &h, 1 );
    const wisp_entity e = cloth_of_links( h.world );
    request_points( &h, e );
    assert_status( h.world, wisp_world_advance( h.world, 2.5f / 60.0f, 1.0f / 60.0f, NULL, NULL ), WISP_OK );
    assert_status( h.world, wisp_teleport( h.world, e, MOTION, true ), WISP_OK );
    assert_status( h.world, wisp_world_advance( h.world, 0.1f / 60.0f, 1.0f / 60.0f, NULL, NULL ), WISP_OK );
    assert_true( vec_distance( point_of( h.world, e, 0 ),
                               wisp_transform_to_world( MOTION, ( wisp_vec3 ){ 0, 0, 0 } ) ) < 1e-5 );
    close_world( &h );
}

TEST( wrong_teleports_change_nothing )
{
    hosted h;
    open_effects( &h, 1 );
    const wisp_entity e = cloth_of_links( h.world );
    wisp_vec3 points[2] = { { 0, 0, 0 }, { 0, -0.1f, 0 } };
    const int32_t offsets[] = { 0, 2 };
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = 1;
    wisp_entity still;
    assert_status( h.world, wisp_add_strands( h.world, &def, &still ), WISP_OK );
    request_points( &h, e );
    make_steps( &h, 2 );
    const uint64_t hash = wisp_world_hash( h.world );
    wisp_transform wrong = MOTION;
    wrong.translation.x = NAN;
    expect_refusal( h.world, wisp_teleport( h.world, e, wrong, true ), WISP_BAD_INPUT, "expected at most 1e6 m" );
    wrong.translation.x = -999999.9f;
    expect_refusal( h.world, wisp_teleport( h.world, e, wrong, true ), WISP_BAD_INPUT, "a vertex would be at" );
    wrong = ( wisp_transform ){ 0 };
    expect_refusal( h.world, wisp_teleport( h.world, e, wrong, true ), WISP_BAD_INPUT, "is not a rotation" );
    expect_refusal( h.world, wisp_teleport( h.world, still, MOTION, true ), WISP_CONFLICT, "nor strands that move" );
    expect_refusal( h.world, wisp_teleport( h.world, ( wisp_entity ){ 99, 1 }, MOTION, true ), WISP_STALE_ID,
                    "does not exist" );
    assert_true( wisp_world_hash( h.world ) == hash );
    close_world( &h );
}
