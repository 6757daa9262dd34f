// Origins: what moves far from the origin of the world moves bit for bit as near it, or as calmly where the host gives coordinates that
// are far away; entities that come near each other meet; what a world says of places is in the host's coordinates.
#include "effects_fixture.h"
#include "saved_world.h"

#include "attachments.h"
#include "seams.h"
#include "wisp/moving_frame.h"
#include "wisp/sleep.h"

static const float FRAME = 1.0f / 60.0f; // s
static const double HOME[3] = { 0.0, 0.0, 0.0 }, FAR[3] = { 20480.0, 0.0, -20480.0 };
static const wisp_quat STRAIGHT = { 0.0f, 0.0f, 0.0f, 1.0f };

enum
{
    SIDE = 13, // vertices along a side of a sheet of 0.6 m
};

static void open_far( hosted* h, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_attachments_module, &wisp_seams_module,
                                                  &wisp_cloth_module,       &wisp_implicit_cloth_module,
                                                  &wisp_balloon_module,     &wisp_strands_module,
                                                  &wisp_collision_module,   &wisp_contact_module };
    OPEN( h, MODULES, .substeps = 8, .workers = workers );
}

static wisp_component points_of( wisp_world* world, wisp_entity e )
{
    return wisp_has_strands( world, e ) ? WISP_STRAND_POINTS : WISP_SURFACE_POINTS;
}

static wisp_entity put( wisp_world* world, wisp_entity e, const double origin[3] )
{
    assert_status( world, wisp_set_origin( world, e, origin ), WISP_OK );
    if ( wisp_has_strands( world, e ) || wisp_world_fabric( world, e ) != NULL )
    {
        assert_status( world, wisp_request( world, e, points_of( world, e ) ), WISP_OK );
        assert_status( world, wisp_request( world, e, WISP_MOTION_STATS ), WISP_OK );
    }
    return e;
}

// A sheet of cloth that collides, is in contact and damped.
static wisp_entity add_sheet( wisp_world* world, wisp_vec3 middle )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( SIDE, 0.05f );
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_vec3 points[SIDE * SIDE];
    for ( int v = 0; v < SIDE * SIDE; ++v )
    {
        points[v] =
            ( wisp_vec3 ){ middle.x + ( mesh.points[v].x - 0.3f ), middle.y, middle.z + ( mesh.points[v].z - 0.3f ) };
    }
    wisp_surface_def surface = support_weightless_surface_def();
    surface.points = points;
    const wisp_entity e = test_surface_of( world, &fabric, surface );
    const wisp_cloth_def cloth = wisp_default_cloth_def();
    const wisp_collision_def collision = wisp_default_collision_def();
    const wisp_contact_def contact = wisp_default_contact_def();
    assert_status( world, wisp_set_cloth( world, e, &cloth ), WISP_OK );
    assert_status( world, wisp_set_gravity( world, e, EARTH ), WISP_OK );
    assert_status( world, wisp_set_damping( world, e, 1.0f ), WISP_OK );
    assert_status( world, wisp_set_collision( world, e, &collision ), WISP_OK );
    assert_status( world, wisp_set_contact( world, e, &contact ), WISP_OK );
    return e;
}

static wisp_entity add_body( wisp_world* world, wisp_collider_kind kind, wisp_vec3 at )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = kind;
    def.radius = 0.2f;
    def.half_extent = ( wisp_vec3 ){ 0.2f, 0.1f, 0.15f };
    def.pose.translation = at;
    wisp_entity e;
    assert_status( world, wisp_add_collider( world, &def, &e ), WISP_OK );
    return e;
}

static uint64_t hash_at( wisp_world* world, wisp_entity e )
{
    uint64_t hash = 0;
    assert_status( world, wisp_world_hash_column( world, e, points_of( world, e ), &hash ), WISP_OK );
    return hash;
}

static wisp_motion_stats motion_of( wisp_world* world, wisp_entity e )
{
    wisp_motion_stats stats;
    assert_status( world, wisp_read_motion_stats( world, e, &stats ), WISP_OK );
    return stats;
}

static double rms_speed( wisp_world* world, wisp_entity e )
{
    const wisp_motion_stats stats = motion_of( world, e );
    return sqrt( 2.0 * stats.kinetic_energy / stats.mass );
}

// ---- bit for bit ----

enum
{
    EFFECTS_COUNT = 7,
    SHEETS = 3,
    PLACED = EFFECTS_COUNT + SHEETS,
};

// Each effect, two sheets that fall on each other and on a ball that moves, one that is sewn to the lower, a tilted plane, and hair that
// turns with its head.
static void run_stage( const double origin[3], int workers, uint64_t hashes[PLACED], wisp_reaction* reaction )
{
    static effect_setup* const ADD[EFFECTS_COUNT] = { cloth_of_links, dihedral_cloth, isometric_cloth, implicit_cloth,
                                                      balloon,        hair_of_links,  hair_of_rods };
    SCOPED( close_world ) hosted h;
    wisp_entity e[PLACED];
    open_far( &h, workers );
    for ( int i = 0; i < EFFECTS_COUNT; ++i )
    {
        e[i] = put( h.world, ADD[i]( h.world ), origin );
        SET_DEFAULT( h.world, e[i], collision );
    }
    for ( int i = 0; i < SHEETS; ++i )
    {
        e[EFFECTS_COUNT + i] =
            put( h.world, add_sheet( h.world, ( wisp_vec3 ){ i == 2 ? 0.6f : 0.0f, i == 1 ? 0.05f : 0.02f, 0.0f } ),
                 origin );
    }
    wisp_seam_def seam = wisp_default_seam_def();
    seam.a = e[EFFECTS_COUNT];
    seam.b = e[EFFECTS_COUNT + 2];
    seam.within = 0.01f;
    wisp_entity sewn;
    assert_status( h.world, wisp_add_seam( h.world, &seam, &sewn ), WISP_OK );
    const wisp_entity ball =
        put( h.world, add_body( h.world, WISP_COLLIDER_SPHERE, ( wisp_vec3 ){ 0.0f, -0.2f, 0.0f } ), origin );
    assert_status( h.world, wisp_request_reaction( h.world, ball, true ), WISP_OK );
    (void)add_body( h.world, WISP_COLLIDER_PLANE, ( wisp_vec3 ){ 0.0f, -0.5f, 0.0f } ); // at home: it is endless
    for ( int i = 0; i < 40; ++i )
    {
        const wisp_transform pose = {
            wisp_transform_make( ( wisp_quat ){ 0.0f, 0.01f * (float)i, 0.0f, 1.0f }, ( wisp_vec3 ){ 0 } ).rotation,
            { 0.003f * (float)i, -0.2f, 0.001f * (float)i }
        };
        assert_status( h.world, wisp_move_collider( h.world, ball, pose ), WISP_OK );
        assert_status( h.world, wisp_move_strand_head( h.world, e[EFFECTS_COUNT - 1], pose ), WISP_OK );
        run_steps( h.world, 1, FRAME );
    }
    for ( int i = 0; i < PLACED; ++i )
    {
        hashes[i] = hash_at( h.world, e[i] );
    }
    assert_status( h.world, wisp_read_reaction( h.world, ball, reaction ), WISP_OK );
}

TEST( what_is_placed_far_away_moves_bit_for_bit_as_at_home )
{
    uint64_t home[PLACED], away[PLACED];
    wisp_reaction reactions[2];
    run_stage( HOME, 1, home, reactions );
    const double places[][3] = { { 20480.0, 0.0, -20480.0 }, { 20000.0, 0.0, 1234.5 }, { -3e8, 0.0, 0.1 } };
    for ( int k = 0; k < WISP_COUNT( places ); ++k )
    {
        run_stage( places[k], 1 + 2 * k, away, reactions + 1 );
        for ( int i = 0; i < PLACED; ++i )
        {
            if ( home[i] != away[i] )
            {
                fail_msg( "entity %d at (%g, %g, %g) moves otherwise", i, places[k][0], places[k][1], places[k][2] );
            }
        }
        assert_memory_equal( reactions, reactions + 1, sizeof( *reactions ) );
    }
    assert_true( reactions[0].impulse.y < 0.0f );
}

// ---- coordinates far away ----

// The host gives coordinates of floats: they are multiples of 2 mm at 20 km, so the start is another one, and rest as calm as at home.
TEST( cloth_at_rest_far_away_is_as_calm_as_at_home )
{
    double home = 0.0;
    static const wisp_vec3 PLACES[] = { { 0.0f, 0.0f, 0.0f },
                                        { 1000.0f, 0.0f, 0.0f },
                                        { 5000.0f, 0.0f, 3000.0f },
                                        { 20000.0f, 0.0f, 20000.0f },
                                        { 0.0f, 9000.0f, 77.0f } };
    for ( int k = 0; k < WISP_COUNT( PLACES ); ++k )
    {
        SCOPED( close_world ) hosted h;
        open_far( &h, 1 );
        const wisp_vec3 at = PLACES[k];
        const wisp_entity e = put( h.world, add_sheet( h.world, ( wisp_vec3 ){ at.x, at.y + 0.15f, at.z } ), HOME );
        (void)add_body( h.world, WISP_COLLIDER_BOX, at );
        run_steps( h.world, 240, FRAME );
        double speed = 0.0;
        for ( int i = 0; i < 60; ++i )
        {
            run_steps( h.world, 1, FRAME );
            speed = fmax( speed, rms_speed( h.world, e ) );
        }
        home = k == 0 ? fmax( speed, 1e-4 ) : home;
        if ( !( speed <= 2.0 * home ) )
        {
            fail_msg( "at (%g, %g, %g): %g m/s, at home %g", (double)at.x, (double)at.y, (double)at.z, speed, home );
        }
        wisp_memory_part parts[160];
        size_t bytes = 0;
        for ( int i = wisp_world_memory_parts( h.world, parts, WISP_COUNT( parts ) ) - 1; i >= 0; --i )
        {
            bytes += parts[i].kind != WISP_MEMORY_OUTSIDE ? parts[i].capacity : 0;
        }
        assert_true( bytes == wisp_world_memory( h.world ) );
        const wisp_motion_stats stats = motion_of( h.world, e );
        assert_near( stats.centre[0], (double)at.x, 0.02 );
        assert_near( stats.centre[2], (double)at.z, 0.02 );
    }
}

// Cloth that hangs by two pins is carried along for kilometres, and comes to rest as where it began.
TEST( an_origin_follows_what_moves )
{
    double speeds[2];
    for ( int k = 0; k < 2; ++k )
    {
        SCOPED( close_world ) hosted h;
        open_far( &h, 1 );
        const wisp_entity e = put( h.world, cloth_of_links( h.world ), HOME ),
                          hair = put( h.world, hair_of_rods( h.world ), HOME );
        wisp_view view;
        run_steps( h.world, 1, FRAME );
        assert_status( h.world, wisp_world_view( h.world, e, WISP_SURFACE_POINTS, &view ), WISP_OK );
        const int32_t pins[2] = { 0, 20 };
        const wisp_vec3 from[2] = { ( (const wisp_vec3*)view.data )[0], ( (const wisp_vec3*)view.data )[20] };
        for ( int i = 1; i <= 300; ++i )
        {
            const float x = k == 0 ? 0.0f : 32.0f * (float)i;
            const wisp_vec3 to[2] = { { from[0].x + x, from[0].y, from[0].z },
                                      { from[1].x + x, from[1].y, from[1].z } };
            assert_status( h.world, wisp_move_pins( h.world, e, pins, to, 2 ), WISP_OK );
            assert_status( h.world,
                           wisp_move_strand_head( h.world, hair, ( wisp_transform ){ STRAIGHT, { x, 0.0f, 0.0f } } ),
                           WISP_OK );
            run_steps( h.world, 1, FRAME );
        }
        run_steps( h.world, 600, FRAME );
        speeds[k] = rms_speed( h.world, e );
        assert_near( motion_of( h.world, hair ).centre[0], k == 0 ? 0.0 : 9600.0, 0.2 );
        assert_true( rms_speed( h.world, hair ) < 1e-3 );
    }
    if ( !( speeds[1] <= 2.0 * fmax( speeds[0], 1e-5 ) ) ) // m/s: less than that is rounding
    {
        fail_msg( "%g m/s, at home %g", speeds[1], speeds[0] );
    }
}

// ---- near and apart ----

// Two sheets in contact, 20 km apart, move as each would alone, and meet nothing although their rows are alike.
TEST( what_is_apart_meets_nothing )
{
    uint64_t alone = 0, together[2];
    for ( int k = 0; k < 2; ++k )
    {
        SCOPED( close_world ) hosted h;
        open_far( &h, 1 );
        const wisp_entity e = put( h.world, add_sheet( h.world, ( wisp_vec3 ){ 0.0f, 0.15f, 0.0f } ), HOME );
        (void)add_body( h.world, WISP_COLLIDER_BOX, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
        const wisp_entity other =
            k == 0 ? e : put( h.world, add_sheet( h.world, ( wisp_vec3 ){ 0.0f, 0.15f, 0.0f } ), FAR );
        if ( k == 1 )
        {
            put( h.world, add_body( h.world, WISP_COLLIDER_BOX, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ), FAR );
        }
        run_steps( h.world, 40, FRAME );
        alone = k == 0 ? hash_at( h.world, e ) : alone;
        together[0] = hash_at( h.world, e );
        together[1] = hash_at( h.world, other );
    }
    assert_true( together[0] == alone && together[1] == alone );
}

static double lowest_of( wisp_world* world, wisp_entity e )
{
    wisp_view view;
    assert_status( world, wisp_world_view( world, e, WISP_SURFACE_POINTS, &view ), WISP_OK );
    double lowest = INFINITY;
    for ( int i = 0; i < view.count; ++i )
    {
        lowest = fmin( lowest, (double)( (const wisp_vec3*)view.data )[i].y );
    }
    return lowest;
}

// The host gives one sheet by its place and the other by coordinates; the upper one comes down from where their origins differ.
TEST( what_comes_near_is_met )
{
    SCOPED( close_world ) hosted h;
    open_far( &h, 2 );
    (void)add_body( h.world, WISP_COLLIDER_PLANE, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    const double place[3] = { 4000.0, 0.0, 0.0 };
    const wisp_entity lower = put( h.world, add_sheet( h.world, ( wisp_vec3 ){ 0.0f, 0.01f, 0.0f } ), place );
    const wisp_entity upper = put( h.world, add_sheet( h.world, ( wisp_vec3 ){ 4000.0f, 100.0f, 0.0f } ), HOME );
    assert_status(
        h.world,
        wisp_set_velocity( h.world, upper, ( wisp_vec3 ){ 0.0f, -30.0f, 0.0f }, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ),
        WISP_OK );
    assert_status( h.world, wisp_set_damping( h.world, upper, 0.0f ), WISP_OK );
    run_steps( h.world, 200, FRAME );
    assert_status( h.world, wisp_set_damping( h.world, upper, 2.0f ), WISP_OK );
    run_steps( h.world, 200, FRAME );
    const float thickness = 0.25f * 0.05f; // m, the default of contact
    assert_true( lowest_of( h.world, upper ) > lowest_of( h.world, lower ) + 0.5 * (double)thickness );
    assert_true( lowest_of( h.world, upper ) < 0.2 );
}

// A moving surface that is a collider carries a sheet along, and so it does what is attached to it, for kilometres.
TEST( what_is_tied_goes_along )
{
    SCOPED( close_world ) hosted h;
    open_far( &h, 1 );
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 4, 0.2f );
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    int32_t all[16];
    wisp_vec3 targets[16];
    for ( int v = 0; v < 16; ++v )
    {
        all[v] = v;
        mesh.points[v].x -= 0.3f;
        mesh.points[v].z -= 0.3f;
    }
    wisp_surface_def def = support_weightless_surface_def();
    def.pins = all;
    def.pin_count = 16;
    def.points = mesh.points;
    const wisp_entity base = put( h.world, test_surface_of( h.world, &fabric, def ), HOME );
    const wisp_entity flag = put( h.world, add_sheet( h.world, ( wisp_vec3 ){ 0.3f, 0.05f, 0.0f } ), HOME );
    const int32_t pins[2] = { 0, SIDE - 1 };
    // with contact a sheet that is dragged by 16 m a frame would test all its primitives against each other
    assert_status( h.world, wisp_unset_contact( h.world, flag ), WISP_OK );
    assert_status( h.world, wisp_attach_pins( h.world, flag, pins, 2, base ), WISP_OK );
    for ( int i = 1; i <= 100; ++i )
    {
        for ( int v = 0; v < 16; ++v )
        {
            targets[v] = ( wisp_vec3 ){ mesh.points[v].x + 16.0f * (float)i, mesh.points[v].y, mesh.points[v].z };
        }
        assert_status( h.world, wisp_move_pins( h.world, base, all, targets, 16 ), WISP_OK );
        run_steps( h.world, 1, FRAME );
    }
    wisp_view view, of_base;
    assert_status( h.world, wisp_world_view( h.world, flag, WISP_SURFACE_POINTS, &view ), WISP_OK );
    assert_status( h.world, wisp_world_view( h.world, base, WISP_SURFACE_POINTS, &of_base ), WISP_OK );
    const wisp_vec3 pin = ( (const wisp_vec3*)view.data )[0], corner = ( (const wisp_vec3*)of_base.data )[0];
    // a float at 1600 m has digits of 1.2e-4 m
    assert_near( (double)pin.x - (double)corner.x, 0.3, 4e-4 );
    assert_near( (double)pin.y, 0.05, 4e-4 );
}

// ---- what a world says ----

// A long teleport takes the origin along: velocities go on bit for bit, and views show the place at once.
TEST( a_long_teleport_keeps_the_digits )
{
    float* velocities[2];
    size_t bytes = 0;
    for ( int k = 0; k < 2; ++k )
    {
        SCOPED( close_world ) hosted h;
        open_far( &h, 1 );
        const wisp_entity e = put( h.world, dihedral_cloth( h.world ), HOME );
        run_steps( h.world, 10, FRAME );
        const double before = motion_of( h.world, e ).centre[0];
        if ( k == 1 )
        {
            const wisp_transform way = { STRAIGHT, { 20480.0f, 0.0f, -8192.0f } };
            assert_status( h.world, wisp_teleport( h.world, e, way, true ), WISP_OK );
        }
        wisp_view view;
        assert_status( h.world, wisp_world_view( h.world, e, WISP_SURFACE_POINTS, &view ), WISP_OK );
        assert_near( (double)( (const wisp_vec3*)view.data )[0].z, k == 0 ? 0.0 : -8192.0, 1.5 );
        run_steps( h.world, 10, FRAME );
        assert_near( motion_of( h.world, e ).centre[0] - before, k == 0 ? 0.0 : 20480.0, 0.2 );
        bytes = (size_t)wisp_world_fabric( h.world, e )->slot_count * 4 * sizeof( float );
        velocities[k] = checked_malloc( bytes );
        memcpy( velocities[k], wisp_world_column( h.world, e, WISP_PARTICLE_VELOCITY, 0 ), bytes );
    }
    assert_memory_equal( velocities[0], velocities[1], bytes );
    free( velocities[0] );
    free( velocities[1] );
}

TEST( a_snapshot_holds_where_rows_are )
{
    SCOPED( close_world ) hosted h;
    open_far( &h, 1 );
    const wisp_entity e = put( h.world, add_sheet( h.world, ( wisp_vec3 ){ 3000.0f, 0.15f, 0.0f } ), HOME );
    (void)add_body( h.world, WISP_COLLIDER_BOX, ( wisp_vec3 ){ 3000.0f, 0.0f, 0.0f } );
    saved_world at_start = save_world( h.world );
    run_steps( h.world, 20, FRAME );
    saved_world saved = save_world( h.world );
    run_steps( h.world, 20, FRAME );
    const uint64_t hash = hash_at( h.world, e );
    assert_status( h.world, wisp_world_restore( h.world, saved.bytes, saved.size ), WISP_OK );
    run_steps( h.world, 20, FRAME );
    assert_true( hash_at( h.world, e ) == hash );
    assert_status( h.world, wisp_world_restore( h.world, at_start.bytes, at_start.size ), WISP_OK );
    run_steps( h.world, 40, FRAME );
    assert_true( hash_at( h.world, e ) == hash );
    free( saved.bytes );
    free( at_start.bytes );
}

TEST( a_place_is_checked_and_read_back )
{
    SCOPED( close_world ) hosted h;
    open_far( &h, 1 );
    const wisp_entity e = cloth_of_links( h.world );
    double place[3] = { 1.0, 1.0, 1.0 };
    assert_status( h.world, wisp_read_origin( h.world, e, place ), WISP_OK );
    assert_memory_equal( place, HOME, sizeof( place ) );
    assert_status( h.world, wisp_set_origin( h.world, e, FAR ), WISP_OK );
    assert_status( h.world, wisp_read_origin( h.world, e, place ), WISP_OK );
    assert_memory_equal( place, FAR, sizeof( place ) );
    const double bad[3] = { 0.0, (double)NAN, 0.0 };
    assert_status( h.world, wisp_set_origin( h.world, e, bad ), WISP_BAD_INPUT );
    assert_status( h.world, wisp_set_origin( h.world, e, NULL ), WISP_BAD_INPUT );
    assert_status( h.world, wisp_read_origin( h.world, e, NULL ), WISP_BAD_INPUT );
    assert_status( h.world, wisp_set_origin( h.world, ( wisp_entity ){ 99, 1 }, FAR ), WISP_STALE_ID );
    assert_status( h.world, wisp_read_origin( h.world, ( wisp_entity ){ 99, 1 }, place ), WISP_STALE_ID );
    assert_memory_equal( place, HOME, sizeof( place ) );
}

// What sleeps on a body wakes when one of them is put elsewhere.
TEST( what_sleeps_wakes_when_it_is_placed )
{
    SCOPED( close_world ) hosted h;
    open_far( &h, 1 );
    const wisp_entity e = put( h.world, add_sheet( h.world, ( wisp_vec3 ){ 0.0f, 0.15f, 0.0f } ), FAR );
    put( h.world, add_body( h.world, WISP_COLLIDER_BOX, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ), FAR );
    SET( h.world, e, sleep, d.max_speed = 0.1f );
    run_steps( h.world, 600, FRAME );
    assert_true( wisp_is_asleep( h.world, e ) );
    assert_status( h.world, wisp_set_origin( h.world, e, HOME ), WISP_OK );
    run_steps( h.world, 1, FRAME );
    assert_false( wisp_is_asleep( h.world, e ) );
}

// What flies past a sheet at rest takes the origin of both along and does not wake it.
TEST( what_sleeps_sleeps_on_while_its_origin_moves )
{
    SCOPED( close_world ) hosted h;
    open_far( &h, 1 );
    const wisp_vec3 none = { 0.0f, 0.0f, 0.0f }, down = { 0.0f, -30.0f, 0.0f };
    const wisp_entity other = put( h.world, add_sheet( h.world, ( wisp_vec3 ){ 500.0f, 60.0f, 2.0f } ), HOME );
    assert_status( h.world, wisp_set_gravity( h.world, other, none ), WISP_OK );
    assert_status( h.world, wisp_set_damping( h.world, other, 0.0f ), WISP_OK );
    const wisp_entity e = put( h.world, add_sheet( h.world, ( wisp_vec3 ){ 500.0f, 0.15f, 0.0f } ), HOME );
    (void)add_body( h.world, WISP_COLLIDER_BOX, ( wisp_vec3 ){ 500.0f, 0.0f, 0.0f } );
    SET( h.world, e, sleep, d.max_speed = 0.1f );
    run_steps( h.world, 600, FRAME );
    assert_true( wisp_is_asleep( h.world, e ) );
    assert_status( h.world, wisp_set_velocity( h.world, other, down, none ), WISP_OK );
    const wisp_vec3 before = wisp_world_offset( h.world, e );
    bool has_moved = false;
    for ( int i = 0; i < 200; ++i )
    {
        run_steps( h.world, 1, FRAME );
        has_moved = has_moved || wisp_world_offset( h.world, e ).y != before.y;
        assert_true( wisp_is_asleep( h.world, e ) );
    }
    assert_true( has_moved );
    assert_true( motion_of( h.world, other ).centre[1] < -30.0 );
}
