// Two extensions of Kim 2026. Width and colour of every vertex for stylised export, in the user's order, written only where
// requested. The environment drives the stiffness of strands: monotone in temperature and wetness, without a pass where
// there is no environment, and without influence on when a shape changes.
#include "frozen_hair_engine_fixture.h"

static const double u = HAIR_ROUNDING;

static const int lengths[] = { 3, 0, 17, 1, 40, 2, 20 };

static hair_groom mixed_groom( void )
{
    int counts[45];
    for ( int s = 0; s < 45; ++s )
    {
        counts[s] = lengths[s * 3 % WISP_COUNT( lengths )];
    }
    return hair_groom_create_mixed( HAIR_WAVY, 3, 45, counts, 0.005f );
}

static void set_look( wisp_world* world, wisp_entity entity, const wisp_strand_appearance_def* def )
{
    assert_int_equal( wisp_set_strand_appearance( world, entity, def ), WISP_OK );
}

static const void* view( wisp_world* world, wisp_entity entity, wisp_component component, int count, size_t stride )
{
    wisp_view view;
    assert_int_equal( wisp_world_view( world, entity, component, &view ), WISP_OK );
    assert_int_equal( view.count, count );
    assert_int_equal( view.stride, stride );
    return view.data;
}

// A world with a groom whose width and colour are requested.
static wisp_world* painted( const hair_groom* groom, const wisp_strand_appearance_def* appearance, wisp_entity* out )
{
    wisp_world* world = hair_world_create( NULL );
    *out = hair_add( world, groom );
    set_look( world, *out, appearance );
    assert_int_equal( wisp_request( world, *out, WISP_POINT_WIDTH ), WISP_OK );
    assert_int_equal( wisp_request( world, *out, WISP_POINT_COLOUR ), WISP_OK );
    hair_step( world );
    return world;
}

static void check_vertex( const wisp_strand_appearance_def* d, double t, float width, wisp_vec3 colour )
{
    double w0 = (double)d->root_width, w1 = (double)d->tip_width;
    hair_assert_close( (double)width, w0 + t * ( w1 - w0 ), 6.0 * u * fmax( w0, w1 ) );

    // Schlick's bias; its denominator is at least as large as the bias, which multiplies the rounding
    double bias = (double)d->colour_bias, weight = t / ( ( 1.0 / bias - 2.0 ) * ( 1.0 - t ) + 1.0 );
    double tolerance = 8.0 * u * ( 1.0 + fabs( 1.0 / bias - 2.0 ) / fmin( 1.0, 1.0 / bias - 1.0 ) );
    const double a[] = { (double)d->root_colour.x, (double)d->root_colour.y, (double)d->root_colour.z };
    const double b[] = { (double)d->tip_colour.x, (double)d->tip_colour.y, (double)d->tip_colour.z };
    const double c[] = { (double)colour.x, (double)colour.y, (double)colour.z };
    for ( int channel = 0; channel < 3; ++channel )
    {
        hair_assert_close( c[channel], a[channel] + weight * ( b[channel] - a[channel] ), tolerance );
        assert_true( c[channel] >= fmin( a[channel], b[channel] ) - tolerance );
        assert_true( c[channel] <= fmax( a[channel], b[channel] ) + tolerance );
    }
}

TEST( width_and_colour_run_from_root_to_tip_of_every_strand )
{
    const float biases[] = { 0.5f, 0.2f, 0.8f, 0.001f, 0.999f };
    SCOPED( hair_groom_destroy ) hair_groom groom = mixed_groom();
    for ( int n = 0; n < WISP_COUNT( biases ); ++n )
    {
        wisp_strand_appearance_def appearance = wisp_default_strand_appearance_def();
        appearance.colour_bias = biases[n];
        appearance.root_width = n == 2 ? 0.0f : appearance.root_width;
        wisp_entity entity;
        SCOPED( destroy_local ) wisp_world* world = painted( &groom, &appearance, &entity );
        const float* width = view( world, entity, WISP_POINT_WIDTH, groom.vertex_count, sizeof( float ) );
        const wisp_vec3* colour = view( world, entity, WISP_POINT_COLOUR, groom.vertex_count, sizeof( wisp_vec3 ) );
        for ( int s = 0; s < groom.strand_count; ++s )
        {
            int first = groom.offsets[s], count = groom.offsets[s + 1] - first;
            for ( int i = 0; i < count; ++i )
            {
                // a strand of one vertex is all root
                double t = count > 1 ? (double)i / ( count - 1 ) : 0.0;
                check_vertex( &appearance, t, width[first + i], colour[first + i] );
            }
        }
    }
}

TEST( the_bias_moves_the_colour_and_one_half_leaves_it_linear )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 2, 1, 21, 0.005f );
    double middle[3];
    const float biases[] = { 0.25f, 0.5f, 0.75f };
    for ( int n = 0; n < 3; ++n )
    {
        wisp_strand_appearance_def appearance = wisp_default_strand_appearance_def();
        appearance.colour_bias = biases[n];
        appearance.root_colour = ( wisp_vec3 ){ 0, 0, 0 };
        appearance.tip_colour = ( wisp_vec3 ){ 1, 1, 1 };
        wisp_entity entity;
        wisp_world* world = painted( &groom, &appearance, &entity );
        const wisp_vec3* colour = view( world, entity, WISP_POINT_COLOUR, 21, sizeof( wisp_vec3 ) );
        middle[n] = (double)colour[10].x;
        wisp_world_destroy( world );

        // by definition the bias is the weight half way up
        hair_assert_close( middle[n], (double)biases[n], 8.0 * u );
    }
}

static int passes_with( wisp_component first, wisp_component second )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = mixed_groom();
    wisp_strand_appearance_def appearance = wisp_default_strand_appearance_def();
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    wisp_entity entity = hair_add( world, &groom );
    set_look( world, entity, &appearance );
    assert_int_equal( wisp_cancel_request( world, entity, WISP_STRAND_POINTS ), WISP_OK );
    assert_true( first == 0 || wisp_request( world, entity, first ) == WISP_OK );
    assert_true( second == 0 || wisp_request( world, entity, second ) == WISP_OK );
    int passes = wisp_world_plan_passes( world );
    wisp_view unused;
    hair_step( world );
    assert_int_equal( wisp_world_view( world, entity, WISP_POINT_WIDTH, &unused ) == WISP_OK,
                      first == WISP_POINT_WIDTH || second == WISP_POINT_WIDTH );
    return passes;
}

TEST( an_attribute_that_nobody_requests_is_not_written )
{
    assert_int_equal( passes_with( 0, 0 ), 0 );
    assert_int_equal( passes_with( WISP_POINT_WIDTH, 0 ), 1 );
    assert_int_equal( passes_with( WISP_POINT_COLOUR, 0 ), 1 );
    assert_int_equal( passes_with( WISP_POINT_WIDTH, WISP_POINT_COLOUR ), 2 );
}

TEST( a_request_without_a_look_is_a_conflict_that_names_it )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = mixed_groom();
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    wisp_entity entity = hair_add( world, &groom );
    assert_int_equal( wisp_request( world, entity, WISP_POINT_WIDTH ), WISP_OK );
    assert_int_equal( wisp_world_step( world, 0.01f ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( world ), "point.width" ) );
    wisp_strand_appearance_def appearance = wisp_default_strand_appearance_def();
    set_look( world, entity, &appearance );
    hair_step( world );
}

TEST( a_new_look_is_painted_at_the_next_step_and_hair_may_move_meanwhile )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = mixed_groom();
    wisp_strand_appearance_def appearance = wisp_default_strand_appearance_def();
    wisp_entity entity;
    SCOPED( destroy_local ) wisp_world* world = painted( &groom, &appearance, &entity );
    appearance.root_width = 1e-3f;
    appearance.tip_colour = ( wisp_vec3 ){ 0.25f, 0.5f, 0.75f };
    set_look( world, entity, &appearance );
    hair_step( world );
    const float* width = view( world, entity, WISP_POINT_WIDTH, groom.vertex_count, sizeof( float ) );
    const wisp_vec3* colour = view( world, entity, WISP_POINT_COLOUR, groom.vertex_count, sizeof( wisp_vec3 ) );
    int tip = groom.offsets[1] - 1; // of the first strand, which has three vertices
    assert_true( width[0] == 1e-3f );
    check_vertex( &appearance, 1.0, width[tip], colour[tip] );

    // frozen hair on the same strands: appearance does not affect their shape, nor the other way round
    SCOPED( free_local )
    wisp_vec3* painted_colour = checked_calloc( (size_t)groom.vertex_count, sizeof( wisp_vec3 ) );
    memcpy( painted_colour, colour, (size_t)groom.vertex_count * sizeof( wisp_vec3 ) );
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    hair_set( world, entity, &def );
    hair_step( world );
    SCOPED( free_local ) wisp_vec3* alone = hair_run( NULL, &groom, &def );
    assert_true( hair_same_bits( hair_view( world, entity, groom.vertex_count ), alone, groom.vertex_count ) );
    colour = view( world, entity, WISP_POINT_COLOUR, groom.vertex_count, sizeof( wisp_vec3 ) );
    assert_true( hair_same_bits( colour, painted_colour, groom.vertex_count ) );
}

// ---- environment ----

static wisp_environment_def environment_with( int count, const float* ice, const float* stiffness )
{
    wisp_environment_def def = wisp_default_environment_def();
    def.point_count = count;
    memcpy( def.ice, ice, (size_t)count * sizeof( float ) );
    memcpy( def.stiffness, stiffness, (size_t)count * sizeof( float ) );
    return def;
}

// Curves of every kind: the default, falling, flat in parts, steep, of two and of eight points.
static int make_curves( wisp_environment_def out[6] )
{
    const float two[] = { 0.0f, 1.0f }, four[] = { 0.0f, 0.2f, 0.7f, 1.0f };
    const float eight[] = { 0.0f, 0.01f, 0.02f, 0.3f, 0.5f, 0.51f, 0.99f, 1.0f };
    out[0] = wisp_default_environment_def();
    out[1] = environment_with( 2, two, ( const float[] ){ 900.0f, 0.5f } );
    out[2] = environment_with( 4, four, ( const float[] ){ 2.0f, 2.0f, 9.0f, 9.0f } );
    out[3] = environment_with( 4, four, ( const float[] ){ 1.0f, 1.1f, 1000.0f, 1001.0f } );
    out[4] = environment_with( 8, eight, ( const float[] ){ 1e-3f, 1.0f, 1.0f, 2.0f, 3.0f, 500.0f, 501.0f, 1e6f } );
    out[5] = environment_with( 8, eight, ( const float[] ){ 80.0f, 70.0f, 60.0f, 8.0f, 7.0f, 6.0f, 0.2f, 0.1f } );
    return 6;
}

static double ice_of( const wisp_environment_def* d, float temperature, float wetness )
{
    double t = fmin( fmax( ( (double)d->freezing_celsius - (double)temperature ) / (double)d->span, 0.0 ), 1.0 );
    return (double)wetness * t * t * ( 3.0 - 2.0 * t );
}

// An interpolation of increasing data must not overshoot. Rounding may: by a few u of the largest stiffness nearby.
TEST( stiffness_is_monotone_in_temperature_and_in_wetness )
{
    wisp_environment_def curves[6];
    const int count = make_curves( curves );
    for ( int n = 0; n < count; ++n )
    {
        const wisp_environment_def* d = curves + n;
        const double sign = d->stiffness[d->point_count - 1] >= d->stiffness[0] ? 1.0 : -1.0;
        for ( int a = 0; a <= 40; ++a )
        {
            double colder = -INFINITY, wetter = -INFINITY;
            for ( int b = 0; b <= 400; ++b )
            {
                float by_cold = wisp_environment_stiffness( d, 5.0f - 0.05f * (float)b, 0.025f * (float)a );
                float by_wet = wisp_environment_stiffness( d, 2.0f - 0.4f * (float)a, 0.0025f * (float)b );
                double slack = 16.0 * u * fmax( (double)by_cold, (double)by_wet );
                assert_true( sign * (double)by_cold >= colder - slack );
                assert_true( sign * (double)by_wet >= wetter - slack );
                colder = sign * (double)by_cold;
                wetter = sign * (double)by_wet;
            }
        }
    }
}

TEST( the_curve_passes_through_its_points_and_stays_between_them )
{
    wisp_environment_def curves[6];
    const int count = make_curves( curves );
    for ( int n = 0; n < count; ++n )
    {
        const wisp_environment_def* d = curves + n;
        for ( int i = 0; i < d->point_count; ++i )
        {
            // at deep frost all wetness becomes ice, so wetness is the curve's abscissa
            float k = wisp_environment_stiffness( d, -100.0f, d->ice[i] );
            hair_assert_close( (double)k / (double)d->stiffness[i], 1.0, 8.0 * u );
        }
        for ( int b = 0; b <= 1000; ++b )
        {
            float ice = 0.001f * (float)b, k = wisp_environment_stiffness( d, -100.0f, ice );
            int i = 0;
            while ( i < d->point_count - 2 && ice > d->ice[i + 1] )
            {
                ++i;
            }
            float lower = fminf( d->stiffness[i], d->stiffness[i + 1] ),
                  upper = fmaxf( d->stiffness[i], d->stiffness[i + 1] );
            assert_true( k >= lower && k <= upper );
        }
    }

    // two points make a straight line of the ice, which follows the smooth step
    const wisp_environment_def line = wisp_default_environment_def();
    for ( int b = 0; b <= 100; ++b )
    {
        float temperature = 1.0f - 0.12f * (float)b, wetness = 0.01f * (float)( b * 37 % 101 );
        double expected = 1.0 + 19.0 * ice_of( &line, temperature, wetness );
        hair_assert_close( (double)wisp_environment_stiffness( &line, temperature, wetness ), expected,
                           20.0 * 10.0 * u );
    }
}

TEST( above_freezing_and_when_dry_there_is_no_ice )
{
    const wisp_environment_def d = wisp_default_environment_def();
    assert_true( wisp_environment_stiffness( &d, 0.0f, 1.0f ) == d.stiffness[0] );
    assert_true( wisp_environment_stiffness( &d, 35.0f, 1.0f ) == d.stiffness[0] );
    assert_true( wisp_environment_stiffness( &d, -40.0f, 0.0f ) == d.stiffness[0] );
    assert_true( wisp_environment_stiffness( &d, -10.0f, 1.0f ) == d.stiffness[1] );
    assert_true( wisp_environment_stiffness( &d, -200.0f, 1.0f ) == d.stiffness[1] );
}

static wisp_entity hair_in( wisp_world* world, const hair_groom* groom, const wisp_environment_def* environment )
{
    wisp_frozen_hair_def def = hair_freeze_only();
    def.stretch_stiffness = def.bend_stiffness = 500.0f;
    wisp_entity entity = hair_add_frozen( world, groom, &def );
    assert_int_equal( wisp_set_environment( world, entity, environment ), WISP_OK );
    return entity;
}

static void expect_stiffness( wisp_world* world, wisp_entity entity, const hair_groom* groom, float stiffness )
{
    wisp_frozen_hair_def def = hair_freeze_only();
    def.stretch_stiffness = def.bend_stiffness = stiffness;
    SCOPED( free_local ) wisp_vec3* expected = hair_run( NULL, groom, &def );
    assert_true( hair_same_bits( hair_view( world, entity, groom->vertex_count ), expected, groom->vertex_count ) );
}

TEST( hair_in_a_environment_looks_like_hair_of_that_stiffness )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_CURLY, 3, 37, 20, 0.005f );
    for ( int n = 0; n <= 10; ++n )
    {
        wisp_environment_def environment = wisp_default_environment_def();
        environment.temperature_celsius = 1.0f - 1.3f * (float)n;
        environment.wetness = 0.3f + 0.07f * (float)n;
        SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
        wisp_entity entity = hair_in( world, &groom, &environment );
        hair_step( world );
        expect_stiffness(
            world, entity, &groom,
            wisp_environment_stiffness( &environment, environment.temperature_celsius, environment.wetness ) );
    }
}

// The environment alone moves no hair.
TEST( weather_changes_a_look_only_with_the_next_command )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 3, 37, 20, 0.005f );
    wisp_environment_def mild = wisp_default_environment_def(), cold = mild;
    mild.temperature_celsius = -2.0f;
    cold.temperature_celsius = -9.0f;
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    wisp_entity entity = hair_in( world, &groom, &mild );
    hair_step( world );
    SCOPED( free_local ) wisp_vec3* look = hair_points( world, entity, groom.vertex_count );
    assert_int_equal( wisp_set_environment( world, entity, &cold ), WISP_OK );
    for ( int n = 0; n < 3; ++n )
    {
        hair_step( world );
        assert_true( hair_same_bits( hair_view( world, entity, groom.vertex_count ), look, groom.vertex_count ) );
    }
    assert_int_equal( wisp_replay_frozen_hair( world, entity, ( wisp_vec3 ){ 0, 0, 0 }, 0 ), WISP_OK );
    hair_step( world );
    assert_false( hair_same_bits( hair_view( world, entity, groom.vertex_count ), look, groom.vertex_count ) );
    expect_stiffness( world, entity, &groom,
                      wisp_environment_stiffness( &cold, cold.temperature_celsius, cold.wetness ) );

    // a stiffness that is set later does not replace the environment's
    wisp_frozen_hair_def soft = hair_freeze_only();
    soft.stretch_stiffness = soft.bend_stiffness = 0.5f;
    hair_set( world, entity, &soft );
    assert_int_equal( wisp_replay_frozen_hair( world, entity, ( wisp_vec3 ){ 0, 0, 0 }, 0 ), WISP_OK );
    hair_step( world );
    expect_stiffness( world, entity, &groom,
                      wisp_environment_stiffness( &cold, cold.temperature_celsius, cold.wetness ) );
}

static bool ran( wisp_world* world, const char* pass )
{
    wisp_profile profile = wisp_world_profile( world );
    for ( int i = 0; i < profile.count; ++i )
    {
        if ( strcmp( profile.lines[i].pass, pass ) == 0 )
        {
            return profile.lines[i].items > 0;
        }
    }
    return false;
}

TEST( without_a_environment_there_is_no_pass_and_with_one_it_runs_once )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 3, 20, 10, 0.005f );
    wisp_frozen_hair_def def = hair_freeze_only();
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    wisp_entity entity = hair_add_frozen( world, &groom, &def );
    assert_int_equal( wisp_world_plan_passes( world ), 4 );
    wisp_environment_def environment = wisp_default_environment_def();
    assert_int_equal( wisp_set_environment( world, entity, &environment ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( world ), 5 );
    hair_step( world );
    assert_true( ran( world, "environment.stiffness" ) );
    hair_step( world );
    assert_false( ran( world, "environment.stiffness" ) );
    wisp_world_destroy( world );

    // the environment pass does not run if nothing reads the stiffness: align alone does not
    world = hair_world_create( NULL );
    def = hair_align_only( ( wisp_vec3 ){ 1, 0, 0 } );
    entity = hair_add_frozen( world, &groom, &def );
    assert_int_equal( wisp_set_environment( world, entity, &environment ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( world ), 4 );
}

TEST( a_environment_belongs_to_one_groom )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 3, 20, 10, 0.005f );
    wisp_environment_def environment = wisp_default_environment_def();
    wisp_frozen_hair_def def = hair_freeze_only();
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    wisp_entity frosty = hair_in( world, &groom, &environment ), plain = hair_add_frozen( world, &groom, &def );
    hair_step( world );
    expect_stiffness(
        world, frosty, &groom,
        wisp_environment_stiffness( &environment, environment.temperature_celsius, environment.wetness ) );
    expect_stiffness( world, plain, &groom, 7.0f );
}

TEST( an_environment_that_cannot_be_is_refused )
{
    const float ice[] = { 0.0f, 0.5f, 1.0f }, rising[] = { 1.0f, 2.0f, 3.0f };
    const struct
    {
        const char* message;
        wisp_environment_def def;
    } bad[] = {
        { "stiffness[1]: got 0", { .wetness = 1, .span = 10, .stiffness = { 1, 0, 3 } } },
        { "curve point 2", { .wetness = 1, .span = 10, .stiffness = { 1, 3, 2 } } },
        { "ice of curve point 1", { .wetness = 1, .span = 10, .ice = { 0, 0, 1 } } },
        { "ice of curve point 2", { .wetness = 1, .span = 10, .ice = { 0, 0.5f, 0.9f } } },
        { "ice of curve point 0", { .wetness = 1, .span = 10, .ice = { 0.1f, 0.5f, 1 } } },
    };
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 3, 5, 10, 0.005f );
    wisp_frozen_hair_def hair = hair_freeze_only();
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    wisp_entity entity = hair_add_frozen( world, &groom, &hair );
    hair_step( world );
    uint64_t hash = wisp_world_hash( world );
    for ( int n = 0; n < WISP_COUNT( bad ); ++n )
    {
        wisp_environment_def def = bad[n].def;
        def.size = wisp_default_environment_def().size;
        def.point_count = def.point_count == 0 ? 3 : def.point_count;
        if ( def.ice[1] == 0.0f && def.ice[2] == 0.0f )
        {
            memcpy( def.ice, ice, sizeof( ice ) );
        }
        if ( def.stiffness[0] == 0.0f )
        {
            memcpy( def.stiffness, rising, sizeof( rising ) );
        }
        assert_int_equal( wisp_set_environment( world, entity, &def ), WISP_BAD_INPUT );
        assert_contains( wisp_world_message( world ), bad[n].message );
        hair_step( world );
        assert_int_equal( wisp_world_hash( world ), hash );
    }
    const wisp_entity nobody = { 99, 0 };
    wisp_environment_def good = wisp_default_environment_def();
    assert_int_equal( wisp_set_environment( world, nobody, &good ), WISP_STALE_ID );
}
