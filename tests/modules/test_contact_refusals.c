// Invalid contact is rejected with one message that names the error, and a rejection changes nothing; NaN in one
// participant never reaches another.
#include "contact_fixture.h"

static int open_refusing( void** state )
{
    hosted* h = checked_calloc( 1, sizeof( hosted ) );
    open_contact( h, 2, 1, 1 );
    *state = h;
    return 0;
}

#define CONTACT_TEST( test ) TEST_WITH( test, open_refusing, close_hosted )

static wisp_entity add_small( wisp_world* world, float height )
{
    test_mesh mesh = level_sheet( 4, 0.3f, ( wisp_vec3 ){ 0.0f, height, 0.0f } );
    return add_draping( world, &mesh, NULL, 0, EARTH );
}

static void assert_participant_refused( hosted* h, wisp_entity e, const wisp_contact_def* def, wisp_status expected,
                                        const char* word )
{
    const int passes = wisp_world_plan_passes( h->world ); // which compiles the plan
    const uint64_t before = wisp_world_hash( h->world );
    expect_refusal( h->world, wisp_set_contact( h->world, e, def ), expected, word );
    assert_true( wisp_world_hash( h->world ) == before );
    assert_int_equal( wisp_world_plan_passes( h->world ), passes );
}

CONTACT_TEST( every_number_of_a_participant_has_its_range )
{
    hosted* h = *state;
    const wisp_entity e = add_small( h->world, 0.0f );
    const wisp_contact_def good = wisp_default_contact_def();
    const struct
    {
        const char* name;
        size_t at;
    } fields[] = {
        { "thickness", offsetof( wisp_contact_def, thickness ) },
        { "friction", offsetof( wisp_contact_def, friction ) },
        { "max_push_out_speed", offsetof( wisp_contact_def, max_push_out_speed ) },
    };
    static const float BAD[] = { -1e-9f, 1.1e6f, NAN, INFINITY, -INFINITY };
    for ( int was_participant = 0; was_participant < 2; ++was_participant )
    {
        for ( int i = 0; i < WISP_COUNT( fields ); ++i )
        {
            for ( int k = 0; k < WISP_COUNT( BAD ); ++k )
            {
                wisp_contact_def def = good;
                memcpy( (char*)&def + fields[i].at, BAD + k, sizeof( float ) );
                assert_participant_refused( h, e, &def, WISP_BAD_INPUT, fields[i].name );
            }
        }
        set_contact( h->world, e, &good );
    }
}

CONTACT_TEST( every_number_of_the_settings_has_its_range )
{
    hosted* h = *state;
    const wisp_entity e = add_small( h->world, 0.0f );
    const wisp_contact_def participant = wisp_default_contact_def();
    set_contact( h->world, e, &participant );
    const uint64_t before = wisp_world_hash( h->world );
    static const float MARGINS[] = { 0.0f, -1.0f, 101.0f, NAN, INFINITY },
                       SPACINGS[] = { -1e-9f, 1.1e6f, NAN, INFINITY };
    const wisp_contact_settings good = wisp_default_contact_settings();
    for ( int i = 0; i < WISP_COUNT( MARGINS ); ++i )
    {
        wisp_contact_settings def = good;
        def.margin = MARGINS[i];
        expect_refusal( h->world, wisp_set_contact_settings( h->world, &def ), WISP_BAD_INPUT, "margin" );
    }
    for ( int i = 0; i < WISP_COUNT( SPACINGS ); ++i )
    {
        wisp_contact_settings def = good;
        def.particle_spacing = SPACINGS[i];
        expect_refusal( h->world, wisp_set_contact_settings( h->world, &def ), WISP_BAD_INPUT, "particle_spacing" );
    }
    wisp_contact_settings def = good;
    def.primitives = WISP_CONTACT_PRIMITIVES_COUNT;
    expect_refusal( h->world, wisp_set_contact_settings( h->world, &def ), WISP_BAD_INPUT, "features" );
    assert_true( wisp_world_hash( h->world ) == before );
    run_steps( h->world, 2, 0.01f );
}

CONTACT_TEST( who_cannot_take_part_is_told )
{
    hosted* h = *state;
    const wisp_contact_def def = wisp_default_contact_def();
    const wisp_entity solved = add_small( h->world, 0.0f ), gone = add_small( h->world, 1.0f );
    const wisp_entity still = test_add_strands( h->world, 3, 4 );
    assert_participant_refused( h, still, &def, WISP_CONFLICT, "dynamics" );
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    wisp_entity body;
    assert_status( h->world, wisp_add_collider( h->world, &ball, &body ), WISP_OK );
    assert_participant_refused( h, body, &def, WISP_CONFLICT, "not a surface" );
    assert_status( h->world, wisp_remove( h->world, gone ), WISP_OK );
    assert_participant_refused( h, gone, &def, WISP_STALE_ID, "does not exist" );
    set_contact( h->world, solved, &def );
    run_steps( h->world, 1, 0.01f );
}

CONTACT_TEST( stats_that_were_not_requested_are_not_there )
{
    hosted* h = *state;
    wisp_contact_stats f;
    double impulse[3];
    const wisp_entity e = add_small( h->world, 0.0f ), other = add_small( h->world, 1.0f );
    const wisp_contact_def def = wisp_default_contact_def();
    expect_refusal( h->world, wisp_read_contact_stats( h->world, &f ), WISP_CONFLICT, "not requested" );
    set_contact( h->world, e, &def );
    run_steps( h->world, 1, 0.01f );
    expect_refusal( h->world, wisp_read_contact_stats( h->world, &f ), WISP_CONFLICT, "not requested" );
    assert_status( h->world, wisp_request_contact_stats( h->world, true, false ), WISP_OK );
    expect_refusal( h->world, wisp_read_contact_stats( h->world, &f ), WISP_CONFLICT, "no step" );
    run_steps( h->world, 1, 0.01f );
    assert_status( h->world, wisp_read_contact_stats( h->world, &f ), WISP_OK );
    assert_int_equal( f.intersections, -1 );
    assert_int_equal( f.participants, 1 );
    expect_refusal( h->world, wisp_read_contact_impulse( h->world, other, impulse ), WISP_CONFLICT, "no part" );
    assert_status( h->world, wisp_request_contact_stats( h->world, false, false ), WISP_OK );
    run_steps( h->world, 1, 0.01f );
    expect_refusal( h->world, wisp_read_contact_stats( h->world, &f ), WISP_CONFLICT, "not requested" );
    assert_int_equal( count_passes_named( h->world, "contact.stats" ), 0 );
    // requested before there was a participant
    assert_status( h->world, wisp_unset_contact( h->world, e ), WISP_OK );
    assert_status( h->world, wisp_request_contact_stats( h->world, true, true ), WISP_OK );
    set_contact( h->world, other, &def );
    run_steps( h->world, 1, 0.01f );
    assert_status( h->world, wisp_read_contact_stats( h->world, &f ), WISP_OK );
    assert_int_equal( f.intersections, 0 );
    assert_status( h->world, wisp_unset_contact( h->world, e ), WISP_OK ); // has no part in contact any more
}

TEST( a_world_without_the_module_says_so )
{
    hosted h = { 0 };
    h.def = hosted_def( &h );
    assert_int_equal( wisp_world_create( &h.def, &h.world, NULL ), WISP_OK );
    const wisp_entity e = add_small( h.world, 0.0f );
    const wisp_contact_def def = wisp_default_contact_def();
    const wisp_contact_settings settings = wisp_default_contact_settings();
    wisp_contact_stats f;
    double impulse[3];
    expect_refusal( h.world, wisp_set_contact( h.world, e, &def ), WISP_CONFLICT, "not registered" );
    expect_refusal( h.world, wisp_unset_contact( h.world, e ), WISP_CONFLICT, "not registered" );
    expect_refusal( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_CONFLICT, "not registered" );
    expect_refusal( h.world, wisp_request_contact_stats( h.world, true, true ), WISP_CONFLICT, "not registered" );
    expect_refusal( h.world, wisp_read_contact_stats( h.world, &f ), WISP_CONFLICT, "not registered" );
    expect_refusal( h.world, wisp_read_contact_impulse( h.world, e, impulse ), WISP_CONFLICT, "not registered" );
    int count;
    expect_refusal( h.world, wisp_read_contact_intersections( h.world, e, e, &count ), WISP_CONFLICT,
                    "not registered" );
    close_world( &h );
}

// Each request for memory is refused in turn, in the call and in the first step after it.
TEST( without_memory_nothing_changes_and_nothing_is_lost )
{
    int in_call = 0, in_step = 0;
    bool refused = true;
    for ( int64_t n = 1; n < 400 && refused; ++n )
    {
        hosted h;
        open_contact( &h, 2, 1, 1 );
        const wisp_entity e[2] = { add_small( h.world, 0.0f ), add_small( h.world, 0.03f ) };
        const wisp_contact_def def = wisp_default_contact_def();
        run_steps( h.world, 1, 0.01f );
        const uint64_t before = wisp_world_hash( h.world );
        test_host_refuse( &h.host, n, false );
        wisp_status status = wisp_set_contact( h.world, e[1], &def );
        if ( status != WISP_OK )
        {
            assert_int_equal( status, WISP_NO_MEMORY );
            assert_one_message( wisp_world_message( h.world ) );
            assert_true( wisp_world_hash( h.world ) == before );
            in_call += 1;
        }
        else
        {
            status = wisp_world_step( h.world, 0.01f );
            assert_true( status == WISP_OK || status == WISP_NO_MEMORY );
            in_step += status == WISP_NO_MEMORY ? 1 : 0;
        }
        refused = test_host_has_refused( &h.host );
        test_host_refuse( &h.host, 0, false );
        set_contact( h.world, e[1], &def );
        set_contact( h.world, e[0], &def );
        request_stats( h.world );
        run_steps( h.world, 3, 0.01f );
        assert_int_equal( contact_stats( h.world ).participants, 2 );
        assert_true( is_finite( h.world, e[0] ) && is_finite( h.world, e[1] ) );
        close_world( &h );
    }
    assert_true( in_call > 0 && in_step > 10 );
}

// One vertex of one of three stacked sheets becomes NaN, in its position or its velocity: that sheet is halted, and
// the others stay finite in every step.
TEST( a_participant_that_goes_wrong_takes_nobody_along )
{
    static const float WRONG[] = { NAN, INFINITY, -INFINITY, 3e38f };
    for ( int n = 0; n < 2 * WISP_COUNT( WRONG ); ++n )
    {
        hosted h;
        open_contact( &h, 4, 2, 1 );
        test_mesh floor = level_sheet( 3, 1.0f, ( wisp_vec3 ){ 0 } );
        const wisp_entity e[4] = { add_pinned( h.world, &floor ), add_small( h.world, 0.03f ),
                                   add_small( h.world, 0.06f ), add_small( h.world, 0.09f ) };
        const wisp_contact_def def = contact_of( 0.02f );
        for ( int i = 0; i < 4; ++i )
        {
            set_contact( h.world, e[i], &def );
        }
        run_steps( h.world, 30, 0.01f );
        float* column =
            wisp_world_column( h.world, e[2], n % 2 == 0 ? WISP_PARTICLE_VELOCITY : WISP_PARTICLE_POSITION, 0 );
        column[4 * 5 + n % 3] = WRONG[n / 2];
        for ( int s = 0; s < 30; ++s )
        {
            run_steps( h.world, 1, 0.01f );
            for ( int i = 0; i < 4; ++i )
            {
                assert_true( is_finite( h.world, e[i] ) );
                assert_int_equal( wisp_is_halted( h.world, e[i] ), i == 2 );
            }
            assert_true( motion_stats_of( h.world, e[1] ).speed_max < 5.0 &&
                         motion_stats_of( h.world, e[3] ).speed_max < 5.0 );
        }
        close_world( &h );
    }
}
