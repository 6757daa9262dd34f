// Gusts: velocities that triangles facing them pass to their vertices, against the oracle's wind key of the boundary particle
// paper's program, and in the language of scenes.
#include "boundary_fixture.h"
#include "boundary_oracle_fixture.h"

static const wisp_vec3 GUST = { 0.5f, 0.25f, 0.5f }; // m/s, of that program

static const float* column_of( ball_world* b, wisp_component component )
{
    return wisp_world_column( b->world, b->ball, component, 0 );
}

// A ball that has fallen for a while, so that positions and velocities are of no special kind.
static ball_world* fallen_ball( void )
{
    ball_world* b = ball_open( 3, 1, NULL );
    ball_steps( b, 7 );
    return b;
}

static boundary_oracle_balloon oracle_of( ball_world* b, bool per_triangle )
{
    const wisp_fabric* f = wisp_world_fabric( b->world, b->ball );
    const float *x = column_of( b, WISP_PARTICLE_POSITION ), *v = column_of( b, WISP_PARTICLE_VELOCITY );
    double3* points = checked_calloc( (size_t)f->vertex_count, sizeof( double3 ) );
    for ( int i = 0; i < f->vertex_count; ++i )
    {
        points[i] = double3_from( x + 4 * (size_t)f->vertex_slot[i] );
    }
    balloon_mesh mesh = mesh_of( points, f->vertex_count, b->mesh.triangles, b->mesh.triangle_count );
    boundary_oracle_balloon balloon;
    assert_true( boundary_oracle_balloon_create( &mesh, &balloon ) );
    for ( int i = 0; i < f->vertex_count; ++i )
    {
        const size_t slot = 4 * (size_t)f->vertex_slot[i];
        balloon.v[i] = double3_from( v + slot );
        balloon.w[i] = (double)x[slot + 3];
    }
    balloon.options.gust_per_face = per_triangle;
    balloon_mesh_destroy( &mesh );
    free( points );
    return balloon;
}

TEST( a_gust_is_that_of_the_oracle )
{
    for ( int per_triangle = 0; per_triangle < 2; ++per_triangle )
    {
        ball_world* b = fallen_ball();
        const wisp_fabric* f = wisp_world_fabric( b->world, b->ball );
        boundary_oracle_balloon balloon = oracle_of( b, per_triangle == 1 );
        const int hits = boundary_oracle_balloon_gust( &balloon, double3_widen( GUST ) );
        int missed = 0, pinned = 0, most = 0;
        assert_int_equal( wisp_apply_gust( b->world, b->ball, GUST, per_triangle == 1 ), WISP_OK );
        const float* v = column_of( b, WISP_PARTICLE_VELOCITY );
        for ( int i = 0; i < f->vertex_count; ++i )
        {
            const double3 found = double3_from( v + 4 * (size_t)f->vertex_slot[i] );
            // a product and a sum in floats
            const double rounding = 0x1p-23 * ( 1.0 + balloon.hits[i] + double3_length( balloon.v[i] ) );
            assert_close( double3_distance( found, balloon.v[i] ), 0.0, rounding );
            missed += balloon.hits[i] == 0 ? 1 : 0;
            pinned += balloon.w[i] == 0.0 ? 1 : 0;
            most = balloon.hits[i] > most ? balloon.hits[i] : most;
        }
        assert_int_equal( pinned, 2 );
        assert_true( hits > f->vertex_count / 3 && missed > f->vertex_count / 4 );
        assert_int_equal( most, per_triangle == 1 ? 6 : 1 );
        boundary_oracle_balloon_destroy( &balloon );
        ball_close( b );
    }
}

// Of a free sheet: every vertex belongs to a triangle that the gust meets, from one side. A step of any length moves it by the
// gust times the step.
TEST( a_gust_does_not_depend_on_the_step_and_meets_one_side_of_a_sheet )
{
    static const float STEPS[] = { 1.0f / 240.0f, 1.0f / 20.0f };
    for ( int n = 0; n < 4; ++n )
    {
        const bool from_the_front = n < 2;
        ball_world* b = ball_open( 1, 1, NULL );
        test_mesh sheet = test_plane( 5, 0.1f );
        const wisp_fabric_def fabric = test_fabric_def( &sheet );
        const wisp_entity e = test_surface_of( b->world, &fabric, support_weightless_surface_def() );
        // normals of the sheet are along +y
        const wisp_vec3 gust = { 0.25f, from_the_front ? -0.5f : 0.5f, 0.0f };
        assert_int_equal( wisp_request( b->world, e, WISP_SURFACE_POINTS ), WISP_OK );
        assert_int_equal( wisp_apply_gust( b->world, e, gust, false ), WISP_OK );
        const float dt = STEPS[n % 2];
        assert_int_equal( wisp_world_step( b->world, dt ), WISP_OK );
        for ( int i = 0; i < sheet.vertex_count; ++i )
        {
            const wisp_vec3 p = point_of( b->world, e, i ), start = sheet.points[i];
            const double fraction = from_the_front ? (double)dt : 0.0;
            // two substeps, each a rounding of a coordinate below 0.5 m
            assert_close( (double)p.x - (double)start.x, fraction * (double)gust.x, 0x1p-24 );
            assert_close( (double)p.y - (double)start.y, fraction * (double)gust.y, 0x1p-24 );
        }
        test_mesh_free( &sheet );
        ball_close( b );
    }
}

TEST( a_gust_that_cannot_be_is_refused_by_name )
{
    ball_world* b = fallen_ball();
    const uint64_t before = wisp_world_hash( b->world );
    expect_refusal( b->world, wisp_apply_gust( b->world, b->ball, ( wisp_vec3 ){ 0.0f, NAN, 0.0f }, false ),
                    WISP_BAD_INPUT, "gust: got (0, nan, 0) m/s" );
    expect_refusal( b->world, wisp_apply_gust( b->world, b->ball, ( wisp_vec3 ){ 2e6f, 0.0f, 0.0f }, true ),
                    WISP_BAD_INPUT, "at most 1e6 m/s" );
    const wisp_entity strands = test_add_strands( b->world, 2, 3 );
    expect_refusal( b->world, wisp_apply_gust( b->world, strands, GUST, false ), WISP_CONFLICT, "not a surface" );
    assert_int_equal( wisp_remove( b->world, strands ), WISP_OK );
    test_host_refuse( &b->host, 1, true );
    expect_refusal( b->world, wisp_apply_gust( b->world, b->ball, GUST, false ), WISP_NO_MEMORY, "gust" );
    test_host_refuse( &b->host, 0, false );
    assert_true( wisp_world_hash( b->world ) == before );
    assert_int_equal( wisp_apply_gust( b->world, b->ball, GUST, false ), WISP_OK );
    assert_true( wisp_world_hash( b->world ) != before );
    ball_close( b );
}

TEST( no_gust_changes_no_bit_and_gusts_that_add_up_have_a_limit )
{
    ball_world* b = fallen_ball();
    const uint64_t before = wisp_world_hash( b->world );
    assert_int_equal( wisp_apply_gust( b->world, b->ball, ( wisp_vec3 ){ 0.0f, -0.0f, 0.0f }, true ), WISP_OK );
    assert_true( wisp_world_hash( b->world ) == before );
    // six triangles meet at a vertex, so that it would get more than the limit; and so would a second gust
    const wisp_vec3 storm = { 9e5f, 0.0f, 0.0f };
    expect_refusal( b->world, wisp_apply_gust( b->world, b->ball, storm, true ), WISP_BAD_INPUT,
                    "would be faster than 1e6 m/s" );
    assert_true( wisp_world_hash( b->world ) == before );
    assert_int_equal( wisp_apply_gust( b->world, b->ball, storm, false ), WISP_OK );
    expect_refusal( b->world, wisp_apply_gust( b->world, b->ball, storm, false ), WISP_BAD_INPUT,
                    "would be faster than 1e6 m/s" );
    ball_close( b );
}
