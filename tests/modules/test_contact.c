// Contact between two small bodies against the oracle, and participants that are added, removed and halted; the fields of a
// definition are in tests/claims/contact.yaml. Invalid contact is rejected with one message that names the error, and a
// rejection changes nothing; NaN in one participant never reaches another.
#include "contact_fixture.h"
#include "contact_mesh.h"

#include "oracle/contact_oracle.h"

static const float DT = 0.01f;        // s
static const float THICK = 0.015625f; // m

// ---- two triangles that meet in one pair ----

typedef struct meeting
{
    hosted h;
    wisp_entity body[2];
    bool is_edges;
} meeting;

static test_mesh three( wisp_vec3 a, wisp_vec3 b, wisp_vec3 c, int n )
{
    test_mesh m = triangle_mesh( a, b, c );
    for ( int v = 0; v < 3; ++v )
    {
        m.points[v].x += test_random_float( n, 10 + v, -0.05f, 0.05f );
        m.points[v].z += test_random_float( n, 20 + v, -0.05f, 0.05f );
    }
    return m;
}

// A vertex above the middle of a triangle, or an edge across another; all other pairs are far apart. Masses differ,
// some vertices are pinned, the upper body moves down and slides.
static void open_meeting( meeting* m, int n, bool is_edges, int iterations )
{
    *m = ( meeting ){ .is_edges = is_edges };
    open_contact( &m->h, 1, iterations, 1 );
    wisp_world* w = m->h.world;
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.level = WISP_CONTACT_TRIANGLES; // bodies of one triangle rotate: a limit would cut them
    assert_status( w, wisp_set_contact_settings( w, &settings ), WISP_OK );
    const float height = THICK * test_random_float( n, 1, 0.6f, 1.4f );
    test_mesh upper = is_edges ? three( ( wisp_vec3 ){ -0.5f, height, 0.0f }, ( wisp_vec3 ){ 0.5f, height, 0.0f },
                                        ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, n )
                               : three( ( wisp_vec3 ){ 0.0f, height, 0.0f }, ( wisp_vec3 ){ -0.1f, 1.0f, 0.1f },
                                        ( wisp_vec3 ){ 0.2f, 1.0f, -0.1f }, n );
    test_mesh lower = is_edges ? three( ( wisp_vec3 ){ 0.0f, 0.0f, -0.5f }, ( wisp_vec3 ){ 0.0f, 0.0f, 0.5f },
                                        ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f }, n + 1000 )
                               : three( ( wisp_vec3 ){ -0.5f, 0.0f, -0.4f }, ( wisp_vec3 ){ 0.0f, 0.0f, 0.6f },
                                        ( wisp_vec3 ){ 0.5f, 0.0f, -0.4f }, n + 1000 );
    const int32_t pins[2] = { test_random( n, 2, 3 ), test_random( n, 3, 3 ) };
    m->body[0] = add_mesh( w, &upper, pins, n % 3 == 1 ? 1 : 0, 0.2f );
    m->body[1] = add_mesh( w, &lower, pins + 1, n % 3 == 2 ? 1 : 0, 0.4f );
    wisp_contact_def def = contact_of( THICK );
    def.max_push_out_speed = 1e-9f; // contact alone
    def.friction = test_random_float( n, 4, 0.0f, 2.0f );
    set_contact( w, m->body[0], &def );
    def.friction *= 0.5f;
    set_contact( w, m->body[1], &def );
    request_stats( w );
    for ( int v = 0; v < 3; ++v )
    {
        const bool is_held = n % 3 == 1 && v == pins[0];
        float* velocity = velocity_of( w, m->body[0], v );
        velocity[0] = is_held ? 0.0f : test_random_float( n, 30 + v, -1.0f, 1.0f );
        velocity[1] = is_held ? 0.0f : test_random_float( n, 40 + v, -3.0f, 0.5f );
        velocity[2] = is_held ? 0.0f : test_random_float( n, 50 + v, -1.0f, 1.0f );
    }
}

// The oracle's substep: the pair where it was apart, then contact as many times as there are iterations.
static contact_oracle_contact expect_places( const meeting* m, int n, int iterations, double3 x[6], double3 before[6],
                                             double w[6] )
{
    for ( int i = 0; i < 6; ++i )
    {
        const float* at = place_of( m->h.world, m->body[i / 3], i % 3 );
        before[i] = double3_from( at );
        w[i] = (double)at[3];
        const double3 v = double3_from( velocity_of( m->h.world, m->body[i / 3], i % 3 ) );
        x[i] = w[i] > 0.0 ? double3_add( before[i], double3_scale( (double)DT, v ) ) : before[i];
    }
    const contact_oracle_closest c = m->is_edges ? contact_oracle_segments( before, before + 3 )
                                                 : contact_oracle_point_triangle( before[0], before + 3 );
    const double friction = (double)test_random_float( n, 4, 0.0f, 2.0f );
    contact_oracle_contact contact = { .normal = c.normal,
                                       .gap = fmin( c.distance, (double)THICK ),
                                       .friction = sqrt( friction * 0.5 * friction ) };
    contact.a.count = m->is_edges ? 2 : 1;
    contact.b.count = m->is_edges ? 2 : 3;
    for ( int i = 0; i < 3; ++i )
    {
        contact.a.vertex[i] = i;
        contact.b.vertex[i] = 3 + i;
        contact.a.weight[i] = c.a[i];
        contact.b.weight[i] = c.b[i];
    }
    for ( int i = 0; i < iterations; ++i )
    {
        contact_oracle_push( &contact, w, x );
        contact_oracle_rub( &contact, w, before, x );
    }
    return contact;
}

TEST( a_pair_moves_as_the_oracle_has_it )
{
    int pushed = 0, free = 0;
    for ( int n = 0; n < 120; ++n )
    {
        const int iterations = 1 + n % 4;
        meeting m;
        open_meeting( &m, n, n % 2 == 1, iterations );
        double3 x[6], before[6];
        double w[6];
        const contact_oracle_contact c = expect_places( &m, n, iterations, x, before, w );
        run_steps( m.h.world, 1, DT );
        for ( int i = 0; i < 6; ++i )
        {
            // positions are of about one metre: several roundings of a float
            const double off = double3_distance( double3_from( place_of( m.h.world, m.body[i / 3], i % 3 ) ), x[i] );
            assert_near( off, 0.0, 4e-6 );
        }
        const wisp_contact_stats f = contact_stats( m.h.world );
        assert_int_equal( f.contacts, c.lambda > 1e-9 ? 1 : 0 );
        double impulse[3], other[3];
        assert_status( m.h.world, wisp_read_contact_impulse( m.h.world, m.body[0], impulse ), WISP_OK );
        assert_status( m.h.world, wisp_read_contact_impulse( m.h.world, m.body[1], other ), WISP_OK );
        for ( int k = 0; k < 3; ++k )
        {
            assert_near( impulse[k] + other[k], 0.0, 1e-15 );
            assert_near( f.net_impulse[k], 0.0, 1e-15 );
        }
        const double3 requested =
            double3_scale( 1.0 / (double)DT, double3_add( double3_scale( c.lambda, c.normal ), c.rubbed ) );
        const double3 got = double3_make( impulse[0], impulse[1], impulse[2] );
        // of a push of a rounding of positions in a step, with the masses of these bodies
        assert_near( double3_distance( got, requested ), 0.0, 1e-4 );
        pushed += c.lambda > 0.0 ? 1 : 0;
        free += c.lambda == 0.0 ? 1 : 0;
        close_world( &m.h );
    }
    assert_true( pushed > 60 && free > 5 );
}

// ---- sheets ----

// A sheet of two triangles that cannot move, and a smaller free one at a given height above it.
static void open_sheets( hosted* h, wisp_entity sheets[2], float height, const wisp_contact_def* lower,
                         const wisp_contact_def* upper )
{
    open_contact( h, 4, 2, 1 );
    test_mesh a = level_sheet( 2, 4.0f, ( wisp_vec3 ){ 0 } ),
              b = level_sheet( 4, 0.3f, ( wisp_vec3 ){ 0.11f, height, 0.07f } );
    sheets[0] = add_pinned( h->world, &a );
    sheets[1] = add_draping( h->world, &b, NULL, 0, ( wisp_vec3 ){ 0 } );
    set_contact( h->world, sheets[0], lower );
    set_contact( h->world, sheets[1], upper );
    request_stats( h->world );
}

// ---- participants are added and removed ----

// A sheet that rests on another.
static void open_resting( hosted* h, wisp_entity sheets[2] )
{
    const wisp_contact_def def = contact_of( THICK );
    open_sheets( h, sheets, 1.1f * THICK, &def, &def );
    assert_status( h->world, wisp_set_gravity( h->world, sheets[1], EARTH ), WISP_OK );
    run_steps( h->world, 20, DT );
    assert_near( mean_of( h->world, sheets[1], 1 ), (double)THICK, 1e-3 * (double)THICK );
}

static void assert_free_fall( hosted* h, wisp_entity e )
{
    const double start = mean_of( h->world, e, 1 );
    run_steps( h->world, 20, DT );
    // 0.2 s: 0.196 m, and half a substep more
    assert_near( start - mean_of( h->world, e, 1 ), 0.196, 0.01 );
}

TEST( what_lay_on_a_participant_falls_when_that_is_removed_or_leaves )
{
    for ( int way = 0; way < 3; ++way )
    {
        SCOPED( close_world ) hosted h;
        wisp_entity sheets[2];
        open_resting( &h, sheets );
        wisp_contact_def off = contact_of( THICK );
        off.enabled = false;
        assert_status( h.world,
                       way == 0   ? wisp_remove( h.world, sheets[0] )
                       : way == 1 ? wisp_unset_contact( h.world, sheets[0] )
                                  : wisp_set_contact( h.world, sheets[0], &off ),
                       WISP_OK );
        assert_free_fall( &h, sheets[1] );
        assert_int_equal( contact_stats( h.world ).participants, 1 );
        assert_status( h.world, wisp_unset_contact( h.world, sheets[1] ), WISP_OK );
        run_steps( h.world, 1, DT );
        assert_int_equal( count_passes_named( h.world, "contact.push" ), 0 );
        assert_int_equal( count_passes_named( h.world, "contact.find" ), 0 );
    }
}

TEST( a_participant_that_comes_later_is_met )
{
    SCOPED( close_world ) hosted h;
    wisp_entity sheets[2];
    open_resting( &h, sheets );
    test_mesh mesh = level_sheet( 5, 0.25f, ( wisp_vec3 ){ 0.1f, 3.0f * THICK, 0.05f } );
    const wisp_entity third = add_draping( h.world, &mesh, NULL, 0, EARTH );
    const wisp_contact_def def = contact_of( THICK );
    run_steps( h.world, 2, DT );
    set_contact( h.world, third, &def );
    run_steps( h.world, 100, DT );
    assert_near( mean_of( h.world, sheets[1], 1 ), (double)THICK, 0.01 * (double)THICK );
    assert_near( mean_of( h.world, third, 1 ), 2.0 * (double)THICK, 0.02 * (double)THICK );
    assert_int_equal( contact_stats( h.world ).participants, 3 );
}

// The middle one of three falling sheets is halted; the one above lands on it. After the halt ends the middle one
// falls itself.
TEST( a_halted_participant_stands_and_is_met_again_when_it_is_resumed )
{
    SCOPED( close_world ) hosted h;
    wisp_entity sheets[2];
    open_resting( &h, sheets );
    test_mesh middle_mesh = level_sheet( 4, 0.3f, ( wisp_vec3 ){ 0.11f, 20.0f * THICK, 0.07f } ),
              upper_mesh = level_sheet( 4, 0.25f, ( wisp_vec3 ){ 0.1f, 24.0f * THICK, 0.07f } );
    const wisp_entity middle = add_draping( h.world, &middle_mesh, NULL, 0, EARTH ),
                      upper = add_draping( h.world, &upper_mesh, NULL, 0, EARTH );
    const wisp_contact_def def = contact_of( THICK );
    set_contact( h.world, middle, &def );
    set_contact( h.world, upper, &def );
    run_steps( h.world, 1, DT );
    velocity_of( h.world, middle, 3 )[0] = NAN;
    run_steps( h.world, 1, DT );
    assert_true( wisp_is_halted( h.world, middle ) );
    const uint64_t stands = hash_of( h.world, middle, WISP_SURFACE_POINTS );
    run_steps( h.world, 100, DT );
    assert_true( hash_of( h.world, middle, WISP_SURFACE_POINTS ) == stands );
    assert_near( mean_of( h.world, upper, 1 ) - mean_of( h.world, middle, 1 ), (double)THICK, 0.01 * (double)THICK );
    assert_near( mean_of( h.world, sheets[1], 1 ), (double)THICK, 0.01 * (double)THICK );
    assert_status( h.world, wisp_resume( h.world, middle ), WISP_OK );
    run_steps( h.world, 60, DT ); // longer, and a smaller sheet slides off
    assert_near( mean_of( h.world, middle, 1 ), 2.0 * (double)THICK, 0.02 * (double)THICK );
    assert_near( mean_of( h.world, upper, 1 ), 3.0 * (double)THICK, 0.03 * (double)THICK );
}

// ---- refusals ----

static int open_refusing( void** state )
{
    hosted* h = checked_calloc( 1, sizeof( hosted ) );
    open_contact( h, 2, 1, 1 );
    *state = h;
    return 0;
}

#define CONTACT_TEST( test ) HOSTED_TEST( test, open_refusing )

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

CONTACT_TEST( who_cannot_take_part_is_told )
{
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
    SCOPED( close_world ) hosted h = { 0 };
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
}

// One vertex of one of three stacked sheets becomes NaN, in its position or its velocity: that sheet is halted, and
// the others stay finite in every step.
TEST( a_participant_that_goes_wrong_takes_nobody_along )
{
    static const float WRONG[] = { NAN, INFINITY, -INFINITY, 3e38f };
    for ( int n = 0; n < 2 * WISP_COUNT( WRONG ); ++n )
    {
        SCOPED( close_world ) hosted h;
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
    }
}

// ---- the default thickness ----

// Return the thickness that a sheet gets by default, m. Its first columns are `narrow` m apart and the others 5 cm.
static double default_thickness_of( float narrow, double* mean_edge, int* warnings )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 4, 1, 1 );
    test_mesh mesh = level_sheet( 11, 0.5f, ( wisp_vec3 ){ 0 } );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        const float column = ( mesh.points[v].x + 0.25f ) / 0.05f;
        mesh.points[v].x = column < 3.5f ? narrow * column : narrow * 4.0f + 0.05f * ( column - 4.0f );
    }
    const wisp_entity e = add_draping( h.world, &mesh, NULL, 0, ( wisp_vec3 ){ 0 } );
    const wisp_contact_def def = contact_of( 0.0f );
    set_contact( h.world, e, &def );
    const wisp_fabric* f = wisp_world_fabric( h.world, e );
    *mean_edge = 0.0;
    for ( int i = 0; i < f->edge_count; ++i )
    {
        *mean_edge += double3_distance( double3_widen( f->rest[f->edges[2 * i]] ),
                                        double3_widen( f->rest[f->edges[2 * i + 1]] ) ) /
                      f->edge_count;
    }
    const contact_settings* settings =
        wisp_world_column( h.world, e, wisp_world_find_component( h.world, "contact.settings" ), 0 );
    const double thickness = (double)settings->thickness;
    *warnings = h.log.count;
    return thickness;
}

TEST( the_default_thickness_is_below_the_shortest_edge )
{
    double mean;
    int warnings;
    const double even = default_thickness_of( 0.05f, &mean, &warnings );
    assert_near( even, 0.25 * mean, 1e-8 );
    assert_int_equal( warnings, 0 );
    const double uneven = default_thickness_of( 0.004f, &mean, &warnings );
    assert_near( uneven, 0.9 * 0.004, 1e-8 );
    assert_int_equal( warnings, 0 );
    const double slivers = default_thickness_of( 1e-5f, &mean, &warnings ); // there is no thickness to be had
    assert_near( slivers, 0.025 * mean, 1e-8 );
    assert_int_equal( warnings, 1 );
}

// ---- who is out of reach ----

typedef struct meeting_far
{
    hosted h;
    wisp_entity plate, sheet;
    int most_points; // of the contact mesh, in all steps
} meeting_far;

// A sheet flies down to a plate, neither of which meets itself.
static void open_far( meeting_far* m, float height, float speed, int workers )
{
    open_contact( &m->h, 8, 1, workers );
    test_mesh plate = level_sheet( 15, 0.7f, ( wisp_vec3 ){ 0 } ),
              sheet = level_sheet( 11, 0.5f, ( wisp_vec3 ){ 0.013f, height, 0.017f } );
    wisp_contact_def def = contact_of( 0.01f );
    def.self = false;
    m->plate = add_pinned( m->h.world, &plate );
    m->sheet = add_draping( m->h.world, &sheet, NULL, 0, ( wisp_vec3 ){ 0 } );
    set_contact( m->h.world, m->plate, &def );
    set_contact( m->h.world, m->sheet, &def );
    assert_status( m->h.world,
                   wisp_set_velocity( m->h.world, m->sheet, ( wisp_vec3 ){ 0, -speed, 0 }, ( wisp_vec3 ){ 0 } ),
                   WISP_OK );
    request_stats( m->h.world );
    m->most_points = 0;
}

static void fly( meeting_far* m, int steps )
{
    for ( int i = 0; i < steps; ++i )
    {
        run_steps( m->h.world, 1, FRAME );
        const int points = contact_stats( m->h.world ).points;
        m->most_points = points > m->most_points ? points : m->most_points;
    }
}

// The contact mesh is empty until the sheet comes near, at any speed, and nothing passes then.
TEST( who_is_out_of_reach_is_in_no_mesh_and_nobody_passes )
{
    static const float SPEEDS[] = { 0.5f, 5.0f, 40.0f }; // m/s
    for ( int i = 0; i < WISP_COUNT( SPEEDS ); ++i )
    {
        uint64_t hashes[2];
        for ( int k = 0; k < 2; ++k )
        {
            const float height = 30.4f * SPEEDS[i] * FRAME; // reached in the 31st step
            meeting_far m;
            open_far( &m, height, SPEEDS[i], 1 + 2 * k );
            fly( &m, 24 );
            assert_int_equal( m.most_points, 0 );
            assert_int_equal( contact_stats( m.h.world ).intersections, 0 );
            fly( &m, 16 );
            assert_int_equal( m.most_points, 15 * 15 + 11 * 11 );
            assert_int_equal( contact_stats( m.h.world ).intersections, 0 );
            assert_true( mean_of( m.h.world, m.sheet, 1 ) > 0.0 );
            hashes[k] = wisp_world_hash( m.h.world );
            close_world( &m.h );
        }
        assert_true( hashes[0] == hashes[1] );
    }
}

// Who was near and went away is left out again.
TEST( who_goes_away_leaves_the_mesh )
{
    meeting_far m;
    open_far( &m, 0.006f, 0.0f, 1 );
    fly( &m, 4 );
    assert_int_equal( contact_stats( m.h.world ).points, 15 * 15 + 11 * 11 );
    assert_status( m.h.world,
                   wisp_set_velocity( m.h.world, m.sheet, ( wisp_vec3 ){ 0, 2.0f, 0 }, ( wisp_vec3 ){ 0 } ),
                   WISP_OK );
    fly( &m, 20 );
    assert_int_equal( contact_stats( m.h.world ).points, 0 );
    close_world( &m.h );
}
