// Contact between two small bodies against the oracle, and the fields of a definition: friction, recovery, gaps,
// layers, self-contact, pins, and participants that are added, removed and halted. Invalid contact is rejected with one
// message that names the error, and a rejection changes nothing; NaN in one participant never reaches another.
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
        double impulse[3];
        assert_status( m.h.world, wisp_read_contact_impulse( m.h.world, m.body[0], impulse ), WISP_OK );
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

TEST( momentum_is_kept_and_forces_are_opposite )
{
    for ( int n = 0; n < 60; n += 3 ) // those without pins
    {
        meeting m;
        open_meeting( &m, n, n % 2 == 1, 2 );
        double before[3] = { 0 }, after[3], impulse[2][3];
        for ( int i = 0; i < 6; ++i )
        {
            const double mass = 1.0 / (double)place_of( m.h.world, m.body[i / 3], i % 3 )[3];
            for ( int k = 0; k < 3; ++k )
            {
                before[k] += mass * (double)velocity_of( m.h.world, m.body[i / 3], i % 3 )[k];
            }
        }
        run_steps( m.h.world, 1, DT );
        momentum_of( m.h.world, m.body, 2, after );
        const wisp_contact_stats f = contact_stats( m.h.world );
        for ( int b = 0; b < 2; ++b )
        {
            assert_status( m.h.world, wisp_read_contact_impulse( m.h.world, m.body[b], impulse[b] ), WISP_OK );
        }
        for ( int k = 0; k < 3; ++k )
        {
            // a rounding of positions (6e-8 m) over the step, times 0.3 kg
            assert_near( after[k], before[k], 1e-5 );
            assert_near( impulse[0][k] + impulse[1][k], 0.0, 1e-15 );
            assert_near( f.net_impulse[k], 0.0, 1e-15 );
        }
        close_world( &m.h );
    }
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

// Gravity is tilted by an angle whose tangent is a fraction of mu. Below one the sheet holds; above, m a = g (sin -
// mu cos).
TEST( friction_is_that_of_coulomb )
{
    static const float SHARES[] = { 0.5f, 0.9f, 1.2f, 2.0f };
    const double mu = 0.4, g = 9.81, seconds = 0.5;
    for ( int i = 0; i < WISP_COUNT( SHARES ); ++i )
    {
        SCOPED( close_world ) hosted h;
        wisp_entity sheets[2];
        wisp_contact_def rough = contact_of( THICK ), half = rough;
        rough.friction = 0.8f; // the geometric mean is 0.4
        half.friction = 0.2f;
        open_sheets( &h, sheets, 1.0001f * THICK, &rough, &half );
        const double angle = atan( (double)SHARES[i] * mu );
        const wisp_vec3 gravity = { (float)( g * sin( angle ) ), (float)( -g * cos( angle ) ), 0.0f };
        assert_status( h.world, wisp_set_damping( h.world, sheets[1], 0.0f ), WISP_OK );
        assert_status( h.world, wisp_set_gravity( h.world, sheets[1], gravity ), WISP_OK );
        const double start = mean_of( h.world, sheets[1], 0 );
        run_steps( h.world, (int)( seconds / (double)DT + 0.5 ), DT );
        const double slid = mean_of( h.world, sheets[1], 0 ) - start;
        const double pull = fmax( 0.0, g * ( sin( angle ) - mu * cos( angle ) ) );
        // one substep more or less of acceleration, and the slip before it came to rest
        assert_near( slid, 0.5 * pull * seconds * seconds, 0.03 * pull * seconds * seconds + 1e-4 );
    }
}

TEST( what_is_too_near_is_parted_slowly_and_gets_no_velocity )
{
    SCOPED( close_world ) hosted h;
    wisp_entity sheets[2];
    wisp_contact_def def = contact_of( THICK );
    def.max_push_out_speed = 0.125f;
    open_sheets( &h, sheets, 0.25f * THICK, &def, &def );
    for ( int i = 1; i <= 12; ++i )
    {
        run_steps( h.world, 1, DT );
        const double expected = fmin( 0.25 * (double)THICK + 0.125 * i * (double)DT, (double)THICK );
        assert_near( mean_of( h.world, sheets[1], 1 ), expected, 1e-5 );
        assert_true( motion_stats_of( h.world, sheets[1] ).speed_max < 1e-4 ); // roundings over a substep
    }
}

TEST( resting_sheets_keep_half_of_the_sum_of_their_thicknesses_and_lie_still )
{
    static const float PAIRS[][2] = { { 1.0f, 1.0f }, { 0.5f, 1.5f }, { 2.0f, 1.0f } };
    for ( int i = 0; i < WISP_COUNT( PAIRS ); ++i )
    {
        SCOPED( close_world ) hosted h;
        wisp_entity sheets[2];
        const wisp_contact_def lower = contact_of( PAIRS[i][0] * THICK ), upper = contact_of( PAIRS[i][1] * THICK );
        open_sheets( &h, sheets, 4.0f * THICK, &lower, &upper );
        assert_status( h.world, wisp_set_gravity( h.world, sheets[1], EARTH ), WISP_OK );
        run_steps( h.world, 100, DT );
        const double gap = 0.5 * (double)( PAIRS[i][0] + PAIRS[i][1] ) * (double)THICK;
        for ( int n = 0; n < 100; ++n )
        {
            run_steps( h.world, 1, DT );
            assert_near( mean_of( h.world, sheets[1], 1 ), gap, 0.001 * gap );
            // a hundredth of the velocity that gravity adds in a step: the contact force is constant
            assert_true( motion_stats_of( h.world, sheets[1] ).speed_max < 1e-3 );
        }
        const wisp_contact_stats f = contact_stats( h.world );
        assert_near( (double)f.min_gap, 1.0, 1e-3 );
        double impulse[3];
        const double weight = motion_stats_of( h.world, sheets[1] ).mass * 9.81;
        assert_status( h.world, wisp_read_contact_impulse( h.world, sheets[1], impulse ), WISP_OK );
        assert_near( impulse[1], weight * (double)DT, 0.01 * weight * (double)DT );
    }
}

static bool falls_through( const wisp_contact_def* lower, const wisp_contact_def* upper )
{
    SCOPED( close_world ) hosted h;
    wisp_entity sheets[2];
    open_sheets( &h, sheets, 2.0f * THICK, lower, upper );
    assert_status( h.world, wisp_set_gravity( h.world, sheets[1], EARTH ), WISP_OK );
    run_steps( h.world, 30, DT );
    return mean_of( h.world, sheets[1], 1 ) < 0.0;
}

TEST( layers_and_masks_say_who_meets )
{
    const struct
    {
        uint32_t layers[2], masks[2];
        bool meets;
    } rows[] = {
        { { 1, 1 }, { UINT32_MAX, UINT32_MAX }, true },
        { { 1, 2 }, { 2, 1 }, true },
        { { 1, 2 }, { 1, 2 }, false },
        { { 1, 2 }, { 2, 2 }, false },
        { { 1, 2 }, { 1, 1 }, false },
        { { 6, 0x80000000u }, { 0x80000000u, 2 }, true },
        { { 0, 1 }, { UINT32_MAX, UINT32_MAX }, false },
    };
    for ( int i = 0; i < WISP_COUNT( rows ); ++i )
    {
        wisp_contact_def defs[2] = { contact_of( THICK ), contact_of( THICK ) };
        for ( int k = 0; k < 2; ++k )
        {
            defs[k].layers = rows[i].layers[k];
            defs[k].mask = rows[i].masks[k];
        }
        assert_int_equal( falls_through( defs, defs + 1 ), rows[i].meets == false );
    }
    wisp_contact_def on = contact_of( THICK ), off = on;
    off.enabled = false;
    assert_false( falls_through( &on, &on ) );
    assert_true( falls_through( &on, &off ) );
}

// Two primitives of one surface, the upper one moving down.
static bool passes_itself( bool self )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 4, 1, 1 );
    test_mesh m = level_sheet( 4, 0.3f, ( wisp_vec3 ){ 0 } ),
              two = { calloc( 32, sizeof( wisp_vec3 ) ), calloc( 108, sizeof( int32_t ) ), 32, 36 };
    for ( int v = 0; v < 32; ++v )
    {
        const wisp_vec3 p = m.points[v % 16];
        two.points[v] = ( wisp_vec3 ){ p.x + 0.013f * (float)( v / 16 ), 0.05f * (float)( v / 16 ), p.z };
    }
    for ( int i = 0; i < 108; ++i )
    {
        two.triangles[i] = m.triangles[i % 54] + 16 * ( i / 54 );
    }
    test_mesh_free( &m );
    const wisp_entity e = add_mesh( h.world, &two, NULL, 0, 0.1f );
    wisp_contact_def def = contact_of( THICK );
    def.self = self;
    set_contact( h.world, e, &def );
    for ( int v = 16; v < 32; ++v )
    {
        velocity_of( h.world, e, v )[1] = -1.0f;
    }
    run_steps( h.world, 20, DT );
    const float lower = place_of( h.world, e, 5 )[1], upper = place_of( h.world, e, 21 )[1];
    return upper < lower;
}

TEST( a_surface_meets_itself_unless_told_not_to )
{
    assert_false( passes_itself( true ) );
    assert_true( passes_itself( false ) );
}

TEST( pins_push_and_are_not_pushed )
{
    SCOPED( close_world ) hosted h;
    wisp_entity sheets[2];
    const wisp_contact_def def = contact_of( THICK );
    open_sheets( &h, sheets, 1.5f * THICK, &def, &def );
    const int32_t all[4] = { 0, 1, 2, 3 };
    wisp_vec3 targets[4];
    for ( int i = 1; i <= 25; ++i )
    {
        for ( int v = 0; v < 4; ++v )
        {
            const float* at = place_of( h.world, sheets[0], v );
            targets[v] = ( wisp_vec3 ){ at[0], 0.5f * (float)i * DT, at[2] };
        }
        assert_status( h.world, wisp_move_pins( h.world, sheets[0], all, targets, 4 ), WISP_OK );
        run_steps( h.world, 1, DT );
        for ( int v = 0; v < 4; ++v )
        {
            assert_memory_equal( place_of( h.world, sheets[0], v ), targets + v, sizeof( targets[v] ) );
        }
        assert_true( mean_of( h.world, sheets[1], 1 ) > (double)targets[0].y + 0.99 * (double)THICK );
    }
    // it keeps the velocity of the push: nothing bounces
    assert_near( motion_stats_of( h.world, sheets[1] ).momentum[1] / motion_stats_of( h.world, sheets[1] ).mass, 0.5,
                 0.01 );
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

TEST( instances_meet_like_all_others )
{
    SCOPED( close_world ) hosted h;
    wisp_entity sheets[3];
    open_resting( &h, sheets );
    assert_status( h.world, wisp_add_instance( h.world, sheets[1], NULL, sheets + 2 ), WISP_OK );
    const wisp_contact_def def = contact_of( THICK );
    SET_DEFAULT( h.world, sheets[2], cloth );
    assert_status( h.world, wisp_set_gravity( h.world, sheets[2], EARTH ), WISP_OK );
    float* column = wisp_world_column( h.world, sheets[2], WISP_PARTICLE_POSITION, 0 );
    for ( int v = 0; v < 16; ++v )
    {
        column[4 * v + 1] = 4.0f * THICK;
    }
    set_contact( h.world, sheets[2], &def );
    run_steps( h.world, 100, DT );
    assert_near( mean_of( h.world, sheets[1], 1 ), (double)THICK, 0.01 * (double)THICK );
    assert_near( mean_of( h.world, sheets[2], 1 ), 2.0 * (double)THICK, 0.02 * (double)THICK );
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

// If the thickness exceeds its edges, a sheet is not pushed apart anywhere: it keeps its rest distances. When bent
// round, it does not.
TEST( a_participant_that_is_thinner_at_rest_than_its_thickness_lies_still )
{
    for ( int bent = 0; bent < 2; ++bent )
    {
        SCOPED( close_world ) hosted h;
        open_contact( &h, 2, 1, 1 );
        test_mesh sheet = level_sheet( 9, 0.4f, ( wisp_vec3 ){ 0 } );
        const wisp_entity e = add_draping( h.world, &sheet, NULL, 0, ( wisp_vec3 ){ 0 } );
        float before[81][3], *column = wisp_world_column( h.world, e, WISP_PARTICLE_POSITION, 0 );
        assert_non_null( column );
        for ( int v = 0; v < 81; ++v )
        {
            float* at = column + (size_t)wisp_world_fabric( h.world, e )->vertex_slot[v] * 4;
            if ( bent != 0 ) // over itself, half of the thickness above
            {
                at[1] = at[0] > 0.0f ? 0.06f * fminf( at[0] / 0.05f, 1.0f ) : 0.0f;
                at[0] = at[0] > 0.0f ? -at[0] : at[0];
            }
            memcpy( before[v], at, sizeof( before[v] ) );
        }
        const wisp_contact_def def = contact_of( 0.12f );
        set_contact( h.world, e, &def );
        request_stats( h.world );
        double most = 0.0;
        for ( int step = 0; step < 10; ++step )
        {
            run_steps( h.world, 1, DT );
        }
        for ( int v = 0; v < 81; ++v )
        {
            const float* at = place_of( h.world, e, v );
            most = fmax( most, fabs( (double)( at[1] - before[v][1] ) ) );
        }
        assert_true( bent == 0 ? most < 1e-6 && contact_stats( h.world ).contacts == 0 : most > 0.01 );
    }
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
