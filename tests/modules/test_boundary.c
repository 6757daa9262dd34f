// Boundary particles in a world: passive, present only when requested, and correct whatever happens to the surface.
#include "saved_world.h"
#include "boundary_fixture.h"

static uint64_t points_hash( ball_world* b, wisp_entity e )
{
    return hash_of( b->world, e, WISP_SURFACE_POINTS );
}

// ---- passive ----

TEST( a_surface_moves_the_same_with_and_without_a_layer )
{
    SCOPED( ball_close ) ball_world *with = ball_open( 3, 2, NULL ), *without = ball_open( 3, 2, NULL );
    wisp_boundary_def def = ball_layer( 0.05f );
    def.strain_gain = 5.0f;
    set_layer( with, with->ball, &def );
    for ( int i = 0; i < 20; ++i )
    {
        ball_steps( with, 1 );
        ball_steps( without, 1 );
        assert_true( points_hash( with, with->ball ) == points_hash( without, without->ball ) );
    }
}

// ---- outputs ----

TEST( elements_are_in_the_users_numbers )
{
    SCOPED( ball_close ) ball_world* b = ball_open( 2, 1, NULL );
    const wisp_boundary_def def = ball_layer( 0.1f );
    set_layer( b, b->ball, &def );
    ball_steps( b, 3 );
    const wisp_boundary_view view = layer_of( b, b->ball );
    const wisp_samples* s = view.samples;
    assert_int_equal( view.edge_count, 3 * b->mesh.triangle_count / 2 );
    for ( int e = 0; e < view.edge_count; ++e )
    {
        const int32_t* edge = view.edges + 2 * e;
        assert_true( edge[0] < edge[1] );
        assert_true( e == 0 || edge[0] > edge[-2] || ( edge[0] == edge[-2] && edge[1] > edge[-1] ) );
        for ( int p = s->begin[e]; p < s->begin[e + 1]; ++p )
        {
            assert_int_equal( view.slot_vertex[s->parents[p][0] / 4], edge[0] );
            assert_int_equal( view.slot_vertex[s->parents[p][1] / 4], edge[1] );
        }
    }
    int inner = 0;
    for ( int t = 0; t < b->mesh.triangle_count; ++t )
    {
        const int element = view.edge_count + t;
        for ( int p = s->begin[element]; p < s->begin[element + 1]; ++p, ++inner )
        {
            for ( int k = 0; k < 3; ++k )
            {
                assert_int_equal( view.slot_vertex[s->parents[p][k] / 4], b->mesh.triangles[3 * t + k] );
            }
        }
    }
    const wisp_boundary_stats f = stats_of( b, b->ball );
    assert_true( inner > 0 );
    assert_int_equal( f.inner_points, inner );
    assert_int_equal( f.points, s->count );
    assert_int_equal( f.edge_points + f.inner_points, f.points );
    assert_int_equal( f.elements, view.edge_count + b->mesh.triangle_count );
    assert_true( f.bytes > (size_t)f.points * 64 );
    assert_true( f.requested == (double)f.points );
}

TEST( normals_of_a_ball_point_away_from_its_centre )
{
    // the error of vertex normals of this mesh comes from the unevenness of its triangles, which falls with the
    // length of edges: measured 0.030 and 0.016
    double largest[2] = { 0.0, 0.0 };
    for ( int i = 0; i < 2; ++i )
    {
        SCOPED( ball_close ) ball_world* b = ball_open( 3 + i, 1, NULL );
        const wisp_boundary_def def = ball_layer( 0.02f );
        assert_int_equal( wisp_set_gravity( b->world, b->ball, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ), WISP_OK );
        set_layer( b, b->ball, &def );
        ball_steps( b, 1 );
        const wisp_samples* s = layer_of( b, b->ball ).samples;
        for ( int p = 0; p < s->count; ++p )
        {
            const float *y = s->xyzw + 4 * p, *n = s->normals + 4 * p;
            const double length = sqrt( (double)( y[0] * y[0] + y[1] * y[1] + y[2] * y[2] ) );
            double gap = 0.0;
            for ( int k = 0; k < 3; ++k )
            {
                gap += pow( (double)y[k] / length - (double)n[k], 2.0 );
            }
            largest[i] = fmax( largest[i], sqrt( gap ) );
        }
    }
    assert_true( largest[0] < 0.035 );
    assert_true( largest[1] < 0.6 * largest[0] );
}

TEST( the_default_spacing_is_half_of_the_mean_edge )
{
    SCOPED( ball_close ) ball_world *by_default = ball_open( 2, 1, NULL ), *by_value = ball_open( 2, 1, NULL );
    const wisp_fabric* f = wisp_world_fabric( by_value->world, by_value->ball );
    double sum = 0.0;
    for ( int e = 0; e < f->edge_count; ++e )
    {
        const wisp_vec3 a = f->rest[f->edges[2 * e]], b = f->rest[f->edges[2 * e + 1]];
        sum += sqrt( pow( (double)b.x - (double)a.x, 2.0 ) + pow( (double)b.y - (double)a.y, 2.0 ) +
                     pow( (double)b.z - (double)a.z, 2.0 ) );
    }
    const wisp_boundary_def none = wisp_default_boundary_def(),
                            half = ball_layer( (float)( 0.5 * sum / f->edge_count ) );
    set_layer( by_default, by_default->ball, &none );
    set_layer( by_value, by_value->ball, &half );
    ball_steps( by_default, 1 );
    ball_steps( by_value, 1 );
    assert_true( stats_of( by_value, by_value->ball ).edge_points > 50 );
    assert_true( layer_hash( by_default, by_default->ball ) == layer_hash( by_value, by_value->ball ) );
}

// ---- changes of the surface ----

TEST( instances_have_layers_of_their_own )
{
    SCOPED( ball_close ) ball_world* b = ball_open( 2, 2, NULL );
    wisp_entity twin, bare;
    assert_int_equal( wisp_add_instance( b->world, b->ball, NULL, &twin ), WISP_OK );
    assert_int_equal( wisp_add_instance( b->world, b->ball, NULL, &bare ), WISP_OK );
    const wisp_boundary_def coarse = ball_layer( 0.1f ), fine = ball_layer( 0.05f );
    set_layer( b, twin, &fine );
    set_layer( b, b->ball, &coarse );
    ball_steps( b, 2 );
    assert_true( stats_of( b, twin ).points > 2 * stats_of( b, b->ball ).points );
    wisp_boundary_view view;
    assert_int_equal( wisp_read_boundary( b->world, bare, &view ), WISP_CONFLICT );
    assert_one_message( wisp_world_message( b->world ) );

    // rows close up over removed ones, and the rest stays correct
    SCOPED( ball_close ) ball_world* alone = ball_open( 2, 1, NULL );
    wisp_entity only;
    assert_int_equal( wisp_add_instance( alone->world, alone->ball, NULL, &only ), WISP_OK );
    set_layer( alone, only, &fine );
    ball_steps( alone, 2 );
    assert_int_equal( wisp_remove( b->world, b->ball ), WISP_OK );
    ball_steps( b, 1 );
    ball_steps( alone, 1 );
    assert_true( layer_hash( b, twin ) == layer_hash( alone, only ) );
    assert_int_equal( wisp_read_boundary( b->world, b->ball, &view ), WISP_STALE_ID );
}

// Frame 0 of a film. What is read does not change what the steps do.
TEST( a_layer_can_be_read_before_the_first_step )
{
    ball_world* b[2];
    wisp_boundary_def def = ball_layer( 0.03f );
    def.hysteresis = 0.4f;
    def.curvature_gain = 2.0f;
    for ( int i = 0; i < 2; ++i )
    {
        b[i] = ball_open( 3, 1, NULL );
        assert_int_equal( wisp_set_gravity( b[i]->world, b[i]->ball, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ), WISP_OK );
        set_layer( b[i], b[i]->ball, &def );
    }
    assert_true( wisp_world_plan_passes( b[0]->world ) > 0 ); // which attaches columns
    const uint64_t start = wisp_world_hash( b[0]->world );
    const int points = stats_of( b[0], b[0]->ball ).points;
    assert_true( points > 1000 );
    const wisp_samples* s = layer_of( b[0], b[0]->ball ).samples;
    assert_int_equal( s->count, points );
    for ( int p = 0; p < s->count; ++p )
    {
        // normals differ by up to 0.030 from the direction (normals_of_a_ball_point_away_from_its_centre)
        const float *y = s->xyzw + 4 * p, *n = s->normals + 4 * p;
        assert_true( y[0] * n[0] + y[1] * n[1] + y[2] * n[2] > 0.97f );
    }
    assert_true( wisp_world_hash( b[0]->world ) == start );
    for ( int step = 0; step < 4; ++step )
    {
        ball_steps( b[0], 1 );
        ball_steps( b[1], 1 );
        assert_true( layer_hash( b[0], b[0]->ball ) == layer_hash( b[1], b[1]->ball ) );
        assert_true( wisp_world_hash( b[0]->world ) == wisp_world_hash( b[1]->world ) );
        // without forces the ball stays, so its points are those of the start
        assert_int_equal( stats_of( b[0], b[0]->ball ).points, points );
    }
    ball_close( b );
    ball_close( b + 1 );
}

// With hysteresis the counts of a layer depend on those before, which a restored world has and a read must not lose.
TEST( a_read_after_a_restore_into_a_new_world_keeps_the_counts )
{
    ball_world* b[2];
    wisp_boundary_def def = ball_layer( 0.03f );
    def.hysteresis = 0.4f;
    for ( int i = 0; i < 2; ++i )
    {
        b[i] = ball_open( 3, 1, NULL );
        set_layer( b[i], b[i]->ball, &def );
    }
    ball_steps( b[0], 12 );
    saved_world saved = save_world( b[0]->world );
    assert_true( wisp_world_plan_passes( b[1]->world ) > 0 ); // which attaches columns
    assert_int_equal( wisp_world_restore( b[1]->world, saved.bytes, saved.size ), WISP_OK );
    const uint64_t start = wisp_world_hash( b[1]->world );
    assert_true( stats_of( b[1], b[1]->ball ).points > 1000 );
    assert_true( wisp_world_hash( b[1]->world ) == start );
    for ( int step = 0; step < 3; ++step )
    {
        ball_steps( b[0], 1 );
        ball_steps( b[1], 1 );
        // the number of resampled elements of the first step depends on the path
        assert_true( step == 0 || layer_hash( b[0], b[0]->ball ) == layer_hash( b[1], b[1]->ball ) );
        assert_true( wisp_world_hash( b[0]->world ) == wisp_world_hash( b[1]->world ) );
    }
    free( saved.bytes );
    ball_close( b );
    ball_close( b + 1 );
}

// ---- refusals ----

TEST( what_a_layer_cannot_be_is_refused_by_name )
{
    SCOPED( ball_close ) ball_world* b = ball_open( 2, 1, NULL );
    const int passes = wisp_world_plan_passes( b->world );
    wisp_boundary_def def = ball_layer( 0.1f );
    def.min_spacing = 2.0f;
    def.max_spacing = 1.0f;
    expect_refusal( b->world, wisp_set_boundary( b->world, b->ball, &def ), WISP_BAD_INPUT,
                    "expected at most max_spacing" );
    assert_int_equal( wisp_world_plan_passes( b->world ), passes );
}
