// Strands against a balloon and against cloth: they stay outside, forces are opposite and equal, and lengths are
// kept.
#include "contact_fixture.h"

enum
{
    STRANDS = 12,
    VERTICES = 14,
    SUBSTEPS = 10,
};

static const float LENGTH = 0.4f; // m, of a strand

// Strands side by side along z, straight out along x from a head at `root`.
static wisp_entity add_rake( wisp_world* world, wisp_vec3 root, float apart )
{
    wisp_vec3 points[STRANDS * VERTICES];
    int32_t offsets[STRANDS + 1] = { 0 };
    for ( int s = 0; s < STRANDS; ++s )
    {
        offsets[s + 1] = offsets[s] + VERTICES;
        for ( int i = 0; i < VERTICES; ++i )
        {
            points[s * VERTICES + i] = ( wisp_vec3 ){ root.x + LENGTH * (float)i / (float)( VERTICES - 1 ), root.y,
                                                      root.z + apart * ( (float)s - 0.5f * (float)( STRANDS - 1 ) ) };
        }
    }
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = STRANDS;
    wisp_entity e;
    assert_status( world, wisp_add_strands( world, &def, &e ), WISP_OK );
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.bending = WISP_STRAND_BEND_NONE;
    dynamics.line_density = 0.01f; // threads of 10 g per metre
    dynamics.damping = 1.0f;
    assert_status( world, wisp_set_strand_dynamics( world, e, &dynamics ), WISP_OK );
    assert_status( world, wisp_request( world, e, WISP_STRAND_POINTS ), WISP_OK );
    assert_status( world, wisp_request( world, e, WISP_MOTION_STATS ), WISP_OK );
    return e;
}

static void assert_lengths( wisp_world* world, wisp_entity strands )
{
    // The direct solve holds lengths within a hundredth. In this world contact runs after strands, so a push at the
    // end of a substep stretches a segment by part of the restored gap: where strands land, by twice as much.
    assert_true( motion_stats_of( world, strands ).strain_max < 0.03 );
    assert_int_equal( wisp_world_counter( world, WISP_COUNT_HALTED ), 0 );
}

// Number of vertices inside a surface, or segments through it.
static int count_inside( wisp_world* world, wisp_entity strands, wisp_entity closed )
{
    const wisp_vec3* p = view_of( world, strands, WISP_STRAND_POINTS ).data;
    int count = 0;
    for ( int i = 0; i < STRANDS * VERTICES; ++i )
    {
        const float at[3] = { p[i].x, p[i].y, p[i].z };
        count += depth_inside( world, closed, at ) > 0.0 ? 1 : 0;
    }
    return count;
}

static int count_segments_through( wisp_world* world, wisp_entity strands, wisp_entity surface )
{
    const wisp_vec3* p = view_of( world, strands, WISP_STRAND_POINTS ).data;
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    const float* x = wisp_world_column( world, surface, WISP_PARTICLE_POSITION, 0 );
    int count = 0;
    for ( int i = 0; i < STRANDS * VERTICES; ++i )
    {
        for ( int t = 0; t < f->triangle_count && i % VERTICES > 0; ++t )
        {
            const int32_t* c = f->triangles + 3 * (size_t)t;
            const float from[3] = { p[i - 1].x, p[i - 1].y, p[i - 1].z }, to[3] = { p[i].x, p[i].y, p[i].z };
            count +=
                wisp_segment_intersects( from, to, x + 4 * (size_t)c[0], x + 4 * (size_t)c[1], x + 4 * (size_t)c[2] )
                    ? 1
                    : 0;
        }
    }
    return count;
}

// Strands fall on a ball whose lower half is held.
TEST( strands_lie_on_a_balloon_and_not_in_it )
{
    hosted h;
    open_contact( &h, SUBSTEPS, 1, 1 );
    test_mesh mesh = ball_of( 3, 0.15f, ( wisp_vec3 ){ 0.02f, 0.0f, 0.01f } );
    const wisp_entity ball = add_balloon( h.world, &mesh, ( wisp_vec3 ){ 0 } );
    for ( int v = 0; v < wisp_world_fabric( h.world, ball )->vertex_count; ++v )
    {
        const int count = place_of( h.world, ball, v )[1] < 0.0f ? 1 : 0;
        assert_status( h.world, wisp_pin( h.world, ball, &v, count ), WISP_OK );
    }
    const wisp_entity strands = add_rake( h.world, ( wisp_vec3 ){ -0.2f, 0.25f, 0.0f }, 0.02f );
    wisp_contact_def def = wisp_default_contact_def();
    def.thickness = 0.01f;
    set_contact( h.world, ball, &def );
    set_contact( h.world, strands, &def );
    request_stats( h.world );
    int pressed = 0;
    for ( int s = 0; s < 90; ++s )
    {
        run_steps( h.world, 1, FRAME );
        const wisp_contact_stats f = contact_stats( h.world );
        assert_int_equal( f.intersections, 0 );
        pressed += f.contacts > 0 ? 1 : 0;
        double impulse[2][3];
        assert_status( h.world, wisp_read_contact_impulse( h.world, ball, impulse[0] ), WISP_OK );
        assert_status( h.world, wisp_read_contact_impulse( h.world, strands, impulse[1] ), WISP_OK );
        for ( int k = 0; k < 3; ++k )
        {
            assert_near( impulse[0][k] + impulse[1][k], 0.0, 1e-12 );
        }
        assert_lengths( h.world, strands );
        if ( s % 10 == 9 )
        {
            assert_int_equal( count_inside( h.world, strands, ball ), 0 );
            assert_int_equal( count_segments_through( h.world, strands, ball ), 0 );
        }
    }
    assert_true( pressed > 60 );
    // they hang over it: without it, their tips would be below their roots by their length
    const wisp_vec3* p = view_of( h.world, strands, WISP_STRAND_POINTS ).data;
    assert_true( p[STRANDS / 2 * VERTICES + VERTICES / 2].y > 0.1f );
    close_world( &h );
}

// Strands fall on a free balloon: its momentum must be the one that contact reports.
TEST( a_balloon_gets_the_momentum_that_strands_give_it )
{
    hosted h;
    open_contact( &h, SUBSTEPS, 1, 1 );
    test_mesh mesh = ball_of( 2, 0.15f, ( wisp_vec3 ){ 0.02f, 0.0f, 0.01f } );
    const wisp_entity ball = add_balloon( h.world, &mesh, ( wisp_vec3 ){ 0 } );
    const wisp_entity strands = add_rake( h.world, ( wisp_vec3 ){ -0.2f, 0.2f, 0.0f }, 0.02f );
    wisp_balloon_def vacuum = wisp_default_balloon_def();
    vacuum.gas_ratio = 1.3f;
    vacuum.buoyancy = false;
    vacuum.drag_coefficient = 0.0f;
    assert_status( h.world, wisp_set_balloon( h.world, ball, &vacuum ), WISP_OK );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.displacement_limit = false; // which limits displacements, and is no force
    assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
    wisp_contact_def def = wisp_default_contact_def();
    def.thickness = 0.02f;
    set_contact( h.world, ball, &def );
    set_contact( h.world, strands, &def );
    request_stats( h.world );
    double given[3] = { 0 };
    for ( int s = 0; s < 45; ++s )
    {
        run_steps( h.world, 1, FRAME );
        double impulse[3];
        assert_status( h.world, wisp_read_contact_impulse( h.world, ball, impulse ), WISP_OK );
        for ( int k = 0; k < 3; ++k )
        {
            given[k] += impulse[k];
        }
    }
    const wisp_motion_stats q = motion_stats_of( h.world, ball );
    assert_true( given[1] < -0.001 );
    for ( int k = 0; k < 3; ++k )
    {
        // the sum of 45 x 10 substeps, each of which rounds positions to 1e-8 m
        assert_near( q.momentum[k], given[k], 0.01 * fabs( given[1] ) );
    }
    close_world( &h );
}

TEST( strands_lie_on_cloth_and_do_not_pass )
{
    hosted h;
    open_contact( &h, SUBSTEPS, 1, 1 );
    test_mesh mesh = level_sheet( 11, 0.6f, ( wisp_vec3 ){ 0 } );
    const int32_t corners[4] = { 0, 10, 110, 120 };
    const wisp_entity cloth = add_draping( h.world, &mesh, corners, 4, EARTH );
    const wisp_entity strands = add_rake( h.world, ( wisp_vec3 ){ -0.25f, 0.1f, 0.003f }, 0.03f );
    wisp_contact_def def = wisp_default_contact_def();
    def.thickness = 0.012f;
    set_contact( h.world, cloth, &def );
    set_contact( h.world, strands, &def );
    request_stats( h.world );
    int pressed = 0;
    for ( int s = 0; s < 120; ++s )
    {
        run_steps( h.world, 1, FRAME );
        const wisp_contact_stats f = contact_stats( h.world );
        assert_int_equal( f.intersections, 0 );
        pressed += f.contacts > 0 ? 1 : 0;
        assert_lengths( h.world, strands );
        if ( s % 20 == 19 )
        {
            assert_int_equal( count_segments_through( h.world, strands, cloth ), 0 );
        }
    }
    assert_true( pressed > 90 );
    close_world( &h );
}

// Passes for strands exist while strands take part, and only then.
TEST( without_strands_there_are_no_passes_of_strands )
{
    hosted h;
    open_contact( &h, 1, 1, 1 );
    test_mesh mesh = level_sheet( 4, 0.3f, ( wisp_vec3 ){ 0 } );
    const wisp_entity cloth = add_draping( h.world, &mesh, NULL, 0, EARTH );
    const wisp_entity strands = add_rake( h.world, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, 0.02f );
    const wisp_contact_def def = wisp_default_contact_def();
    set_contact( h.world, cloth, &def );
    run_steps( h.world, 1, FRAME );
    assert_int_equal( count_passes_named( h.world, "contact.push" ), 1 );
    assert_int_equal( count_passes_named( h.world, "contact.push_strands" ), 0 );
    set_contact( h.world, strands, &def );
    run_steps( h.world, 1, FRAME );
    assert_int_equal( count_passes_named( h.world, "contact.push" ), 0 );
    assert_int_equal( count_passes_named( h.world, "contact.push_strands" ), 1 );
    assert_status( h.world, wisp_unset_contact( h.world, strands ), WISP_OK );
    run_steps( h.world, 1, FRAME );
    assert_int_equal( count_passes_named( h.world, "contact.push" ), 1 );
    assert_int_equal( count_passes_named( h.world, "contact.push_strands" ), 0 );
    assert_int_equal( count_passes_named( h.world, "contact.keep_strands" ), 0 );
    close_world( &h );
}
