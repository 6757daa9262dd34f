// Width and colour of every vertex for stylised export (extension of Kim 2026), in the user's order, written only
// where requested.
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
    hair_groom groom = mixed_groom();
    for ( int n = 0; n < WISP_COUNT( biases ); ++n )
    {
        wisp_strand_appearance_def appearance = wisp_default_strand_appearance_def();
        appearance.colour_bias = biases[n];
        appearance.root_width = n == 2 ? 0.0f : appearance.root_width;
        wisp_entity entity;
        wisp_world* world = painted( &groom, &appearance, &entity );
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
        wisp_world_destroy( world );
    }
    hair_groom_destroy( &groom );
}

TEST( the_bias_moves_the_colour_and_one_half_leaves_it_linear )
{
    hair_groom groom = hair_groom_create( HAIR_WAVY, 2, 1, 21, 0.005f );
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
    hair_groom_destroy( &groom );
}

static int passes_with( wisp_component first, wisp_component second )
{
    hair_groom groom = mixed_groom();
    wisp_strand_appearance_def appearance = wisp_default_strand_appearance_def();
    wisp_world* world = hair_world_create( NULL );
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
    wisp_world_destroy( world );
    hair_groom_destroy( &groom );
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
    hair_groom groom = mixed_groom();
    wisp_world* world = hair_world_create( NULL );
    wisp_entity entity = hair_add( world, &groom );
    assert_int_equal( wisp_request( world, entity, WISP_POINT_WIDTH ), WISP_OK );
    assert_int_equal( wisp_world_step( world, 0.01f ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( world ), "point.width" ) );
    wisp_strand_appearance_def appearance = wisp_default_strand_appearance_def();
    set_look( world, entity, &appearance );
    hair_step( world );
    wisp_world_destroy( world );
    hair_groom_destroy( &groom );
}

TEST( a_new_look_is_painted_at_the_next_step_and_hair_may_move_meanwhile )
{
    hair_groom groom = mixed_groom();
    wisp_strand_appearance_def appearance = wisp_default_strand_appearance_def();
    wisp_entity entity;
    wisp_world* world = painted( &groom, &appearance, &entity );
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
    wisp_vec3* painted_colour = checked_calloc( (size_t)groom.vertex_count, sizeof( wisp_vec3 ) );
    memcpy( painted_colour, colour, (size_t)groom.vertex_count * sizeof( wisp_vec3 ) );
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    hair_set( world, entity, &def );
    hair_step( world );
    wisp_vec3* alone = hair_run( NULL, &groom, &def );
    assert_true( hair_same_bits( hair_view( world, entity, groom.vertex_count ), alone, groom.vertex_count ) );
    colour = view( world, entity, WISP_POINT_COLOUR, groom.vertex_count, sizeof( wisp_vec3 ) );
    assert_true( hair_same_bits( colour, painted_colour, groom.vertex_count ) );
    free( painted_colour );
    free( alone );
    wisp_world_destroy( world );
    hair_groom_destroy( &groom );
}

TEST( a_look_that_cannot_be_is_refused )
{
    hair_groom groom = mixed_groom();
    wisp_strand_appearance_def good = wisp_default_strand_appearance_def(), bad[8];
    const char* const messages[] = { "widths",      "widths",      "widths",     "colour_bias",
                                     "colour_bias", "root_colour", "tip_colour", "tip_colour" };
    for ( int n = 0; n < WISP_COUNT( bad ); ++n )
    {
        bad[n] = good;
    }
    bad[0].root_width = -1e-6f;
    bad[1].tip_width = NAN;
    bad[2].tip_width = 2.0f;
    bad[3].colour_bias = 0.0f;
    bad[4].colour_bias = 1.0f;
    bad[5].root_colour.y = 1.5f;
    bad[6].tip_colour.z = -0.1f;
    bad[7].tip_colour.x = NAN;
    wisp_entity entity;
    wisp_world* world = painted( &groom, &good, &entity );
    uint64_t hash = wisp_world_hash( world );
    for ( int n = 0; n < WISP_COUNT( bad ); ++n )
    {
        assert_int_equal( wisp_set_strand_appearance( world, entity, bad + n ), WISP_BAD_INPUT );
        assert_non_null( strstr( wisp_world_message( world ), messages[n] ) );
        hair_step( world );
        assert_int_equal( wisp_world_hash( world ), hash );
    }
    const wisp_entity nobody = { 99, 0 };
    assert_int_equal( wisp_set_strand_appearance( world, nobody, &good ), WISP_STALE_ID );
    wisp_world_destroy( world );
    hair_groom_destroy( &groom );
}

TEST( any_number_of_workers_paints_the_same )
{
    hair_groom groom = hair_groom_create( HAIR_CURLY, 3, 700, 20, 0.005f );
    wisp_strand_appearance_def appearance = wisp_default_strand_appearance_def();
    appearance.colour_bias = 0.3f;
    const int workers[] = { 1, 2, 5, 64 };
    uint64_t first[2] = { 0, 0 };
    for ( int n = 0; n < WISP_COUNT( workers ); ++n )
    {
        const hair_host host = { .workers = workers[n] };
        wisp_world* world = hair_world_create( &host );
        wisp_entity entity = hair_add( world, &groom );
        set_look( world, entity, &appearance );
        assert_int_equal( wisp_request( world, entity, WISP_POINT_WIDTH ), WISP_OK );
        assert_int_equal( wisp_request( world, entity, WISP_POINT_COLOUR ), WISP_OK );
        hair_step( world );
        uint64_t hash[2];
        assert_int_equal( wisp_world_hash_column( world, entity, WISP_POINT_WIDTH, hash ), WISP_OK );
        assert_int_equal( wisp_world_hash_column( world, entity, WISP_POINT_COLOUR, hash + 1 ), WISP_OK );
        if ( n == 0 )
        {
            memcpy( first, hash, sizeof( first ) );
        }
        assert_memory_equal( hash, first, sizeof( first ) );
        wisp_world_destroy( world );
    }
    hair_groom_destroy( &groom );
}
