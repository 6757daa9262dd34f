// The margin of the search changes the time and not one bit; and boundary particles as contact primitives:
// their contact, and what passes between them.
#include "contact_fixture.h"

#include "oracle/contact_oracle.h"

typedef struct scene_counts
{
    int candidates; // at the end
    int searches;
} scene_counts;

// A cloth that falls on a balloon on a sheet, so that there are points of all kinds.
static void add_heap( wisp_world* world )
{
    test_mesh ball = ball_of( 2, 0.1f, ( wisp_vec3 ){ 0.01f, 0.12f, 0.02f } ),
              double_sided = level_sheet( 7, 0.5f, ( wisp_vec3 ){ 0 } ),
              cloth = level_sheet( 11, 0.4f, ( wisp_vec3 ){ 0.0f, 0.26f, 0.0f } );
    const wisp_entity e[3] = { add_pinned( world, &double_sided ), add_balloon( world, &ball, EARTH ),
                               add_draping( world, &cloth, NULL, 0, EARTH ) };
    const wisp_contact_def def = wisp_default_contact_def();
    for ( int i = 0; i < 3; ++i )
    {
        set_contact( world, e[i], &def );
    }
    request_stats( world );
}

// @return the hash of all state
static uint64_t run_scene( wisp_contact_primitives primitives, float margin, scene_counts* counts )
{
    hosted h;
    *counts = ( scene_counts ){ 0 };
    open_contact( &h, 8, 1, 1 );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.primitives = primitives;
    settings.margin = margin;
    settings.particle_spacing = 0.02f;
    assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
    add_heap( h.world );
    for ( int step = 0; step < 30; ++step )
    {
        run_steps( h.world, 1, FRAME );
        const wisp_contact_stats f = contact_stats( h.world );
        counts->candidates = (int)f.candidates;
        counts->searches += f.searches;
    }
    assert_true( contact_stats( h.world ).contacts > 0 );
    const uint64_t hash = wisp_world_hash( h.world );
    close_world( &h );
    return hash;
}

TEST( how_far_pairs_are_looked_for_does_not_change_a_bit )
{
    static const float MARGINS[] = { 0.05f, 0.3f, 1.0f, 6.0f, 30.0f };
    for ( int primitives = 0; primitives < WISP_CONTACT_PRIMITIVES_COUNT; ++primitives )
    {
        uint64_t first = 0;
        scene_counts counts[WISP_COUNT( MARGINS )];
        for ( int i = 0; i < WISP_COUNT( MARGINS ); ++i )
        {
            const uint64_t hash = run_scene( (wisp_contact_primitives)primitives, MARGINS[i], counts + i );
            first = i == 0 ? hash : first;
            assert_true( hash == first );
        }
        // and it does change the candidates: far more pairs, far less often
        assert_true( counts[4].candidates > 2 * counts[0].candidates );
        assert_true( counts[4].searches < counts[0].searches );
    }
}

// A soft cloth that falls over a rotating ball and winds around it. @return the ball
static wisp_entity add_folding( wisp_world* world )
{
    test_mesh mesh = level_sheet( 48, 1.0f, ( wisp_vec3 ){ 0.0f, 0.6f, 0.0f } );
    const wisp_entity e = add_draping( world, &mesh, NULL, 0, EARTH );
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bend_compliance = 0.5f;
    cloth.internal_damping = 1.0f;
    assert_status( world, wisp_set_cloth( world, e, &cloth ), WISP_OK );
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.radius = 0.15f;
    ball.pose.translation = ( wisp_vec3 ){ 0.045f, 0.3f, 0.015f };
    wisp_entity body;
    assert_status( world, wisp_add_collider( world, &ball, &body ), WISP_OK );
    add_floor( world, ( wisp_vec3 ){ 0 }, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    set_collision( world, e );
    const wisp_contact_def def = wisp_default_contact_def();
    set_contact( world, e, &def );
    assert_status( world, wisp_request_contact_stats( world, true, false ), WISP_OK );
    return body;
}

static void swing( wisp_world* world, wisp_entity ball, float t )
{
    wisp_transform pose = wisp_default_collider_def().pose;
    pose.translation =
        ( wisp_vec3 ){ 0.15f * ( 0.3f + sinf( 3.0f * t ) ), 0.3f, 0.15f * ( 0.1f + sinf( 2.0f * t ) ) };
    assert_status( world, wisp_move_collider( world, ball, pose ), WISP_OK );
}

// Cached bounds of clusters do not hold where a snapshot puts points elsewhere, so all pairs are tested
// again. A scene that is restored into another world in every substep, from one substep on, must continue as one with cached
// bounds. The smaller the margin, the more pairs are new in a list.
static void check_remembered( bool folds, int steps, float seconds )
{
    hosted h, other;
    hosted* const both[2] = { &h, &other };
    wisp_entity ball = { 0 }; // the same in both worlds
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.margin = 0.01f;
    for ( int w = 0; w < 2; ++w )
    {
        open_contact( both[w], 1, 1, 1 );
        assert_status( both[w]->world, wisp_set_contact_settings( both[w]->world, &settings ), WISP_OK );
        if ( folds )
        {
            ball = add_folding( both[w]->world );
            swing( both[w]->world, ball, 0.0f );
        }
        else
        {
            add_heap( both[w]->world );
        }
        run_steps( both[w]->world, 1, seconds );
    }
    const size_t size = wisp_world_snapshot_size( h.world );
    void* bytes = checked_malloc( size );
    int contacts = 0, searches = 0;
    for ( int step = 0; step < steps; ++step )
    {
        assert_status( h.world, wisp_world_snapshot( h.world, bytes, size ), WISP_OK );
        run_steps( other.world, 1, seconds );
        assert_status( other.world, wisp_world_restore( other.world, bytes, size ), WISP_OK );
        for ( int w = 0; w < 2; ++w )
        {
            if ( folds )
            {
                swing( both[w]->world, ball, seconds * (float)( step + 1 ) );
            }
            run_steps( both[w]->world, 1, seconds );
        }
        assert_true( wisp_world_hash( h.world ) == wisp_world_hash( other.world ) );
        assert_true( contact_stats( other.world ).searches > 0 );
        searches += contact_stats( h.world ).searches > 0 ? 1 : 0;
        contacts += contact_stats( h.world ).contacts;
    }
    assert_true( contacts > steps && searches > 0 && 2 * searches < steps );
    free( bytes );
    close_world( &h );
    close_world( &other );
}

TEST( what_is_remembered_does_not_change_a_bit )
{
    check_remembered( false, 120, FRAME / 8.0f );
    check_remembered( true, 320, FRAME / 10.0f );
}

// Between a floor and a sheet that spins far above it, whose pair is listed from the start, another sheet descends
// slowly: its pair with the floor is new in a list, before the other.
TEST( a_pair_that_is_new_in_a_list_has_nothing_of_the_next )
{
    static const float TURN = 20.0f, FALL = 0.4f, SUBSTEP = 0.01f, GAP = 0.01f; // rad/s, m/s, s, m
    hosted h;
    open_contact( &h, 1, 1, 1 );
    test_mesh floor = level_sheet( 3, 0.3f, ( wisp_vec3 ){ 0 } ),
              falling = level_sheet( 3, 0.2f, ( wisp_vec3 ){ 0.0f, 0.1f, 0.0f } ),
              spinning = level_sheet( 3, 0.2f, ( wisp_vec3 ){ 0.0f, 0.15f, 0.0f } );
    const wisp_vec3 none = { 0 };
    const wisp_entity e[3] = { add_pinned( h.world, &floor ), add_draping( h.world, &falling, NULL, 0, none ),
                               add_draping( h.world, &spinning, NULL, 0, none ) };
    const wisp_contact_def def = contact_of( GAP );
    for ( int i = 0; i < 3; ++i )
    {
        set_contact( h.world, e[i], &def );
    }
    for ( int v = 0; v < 9; ++v )
    {
        const float* p = place_of( h.world, e[2], v );
        float* turning = velocity_of( h.world, e[2], v );
        turning[0] = TURN * p[2];
        turning[2] = -TURN * p[0];
        velocity_of( h.world, e[1], v )[1] = -FALL;
    }
    run_steps( h.world, 50, SUBSTEP );
    assert_true( mean_of( h.world, e[1], 1 ) > 0.99 * (double)GAP );
    close_world( &h );
}

// ---- boundary particles ----

static const float DT = 0.01f, THICK = 0.125f;

typedef struct six
{
    hosted h;
    wisp_entity body[2];
    double3 before[6], predicted[6], after[6];
    double w[6];
} six;

static void read_places( six* s, double3* out )
{
    for ( int i = 0; i < 6; ++i )
    {
        const float* at = place_of( s->h.world, s->body[i / 3], i % 3 );
        out[i] = double3_make( (double)at[0], (double)at[1], (double)at[2] );
    }
}

// Two triangles, one rotated and above the other, approach each other.
static void open_six( six* s, int n )
{
    *s = ( six ){ 0 };
    open_contact( &s->h, 1, 1, 1 );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.primitives = WISP_CONTACT_PARTICLES;
    settings.particle_spacing = 0.2f;
    assert_status( s->h.world, wisp_set_contact_settings( s->h.world, &settings ), WISP_OK );
    for ( int k = 0; k < 2; ++k )
    {
        wisp_vec3 p[3];
        for ( int v = 0; v < 3; ++v )
        {
            const float angle = 2.0944f * (float)v + test_random_float( n, 10 * k + v, -0.4f, 0.4f ) + (float)k;
            p[v] = ( wisp_vec3 ){ 0.5f * cosf( angle ) + test_random_float( n, 30 + k, -0.1f, 0.1f ),
                                  k == 0 ? THICK * test_random_float( n, 40 + v, 1.1f, 1.3f ) : 0.0f,
                                  0.5f * sinf( angle ) + test_random_float( n, 50 + k, -0.1f, 0.1f ) };
        }
        test_mesh mesh = triangle_mesh( p[0], p[1], p[2] );
        s->body[k] = add_mesh( s->h.world, &mesh, NULL, 0, k == 0 ? 0.2f : 0.5f );
        wisp_contact_def def = contact_of( THICK );
        def.max_push_out_speed = 1e-9f; // contact alone
        set_contact( s->h.world, s->body[k], &def );
    }
    request_stats( s->h.world );
    read_places( s, s->before );
    for ( int i = 0; i < 6; ++i )
    {
        float* velocity = velocity_of( s->h.world, s->body[i / 3], i % 3 );
        velocity[1] = test_random_float( n, 60 + i, 0.0f, 4.0f ) * ( i < 3 ? -1.0f : 1.0f );
        s->w[i] = (double)place_of( s->h.world, s->body[i / 3], i % 3 )[3];
        s->predicted[i] = double3_add( s->before[i], double3_make( 0.0, (double)( velocity[1] * DT ), 0.0 ) );
    }
    run_steps( s->h.world, 1, DT );
    read_places( s, s->after );
}

// Displacements give the weights: a parent moves by its own weight times its inverse mass. With these weights, the
// oracle must push as far, along the line between the two points at their initial positions.
static bool check_six( const six* s )
{
    contact_oracle_contact c = { .a = { .count = 3, .vertex = { 0, 1, 2 } },
                                 .b = { .count = 3, .vertex = { 3, 4, 5 } },
                                 .gap = (double)THICK };
    double3 sums[2] = { { 0 } }, ways[6];
    for ( int i = 0; i < 6; ++i )
    {
        ways[i] = double3_scale( 1.0 / s->w[i], double3_sub( s->after[i], s->predicted[i] ) );
        sums[i / 3] = double3_add( sums[i / 3], ways[i] );
    }
    const double length = double3_length( sums[0] );
    // of a push of a millimetre, known to six digits
    assert_near( double3_length( double3_add( sums[0], sums[1] ) ), 0.0, 1e-6 * fmax( length, 1.0 ) );
    if ( length * s->w[0] < 1e-3 )
    {
        return false;
    }
    c.normal = double3_scale( 1.0 / length, sums[0] );
    for ( int i = 0; i < 3; ++i )
    {
        c.a.weight[i] = double3_dot( ways[i], c.normal ) / length;
        c.b.weight[i] = -double3_dot( ways[3 + i], c.normal ) / length;
        assert_true( c.a.weight[i] > -1e-3 && c.b.weight[i] > -1e-3 );
    }
    const double3 between =
        double3_sub( contact_oracle_point_of( &c.a, s->before ), contact_oracle_point_of( &c.b, s->before ) );
    const double distance = double3_length( between );
    assert_near( double3_distance( double3_scale( 1.0 / distance, between ), c.normal ), 0.0, 0.02 );
    c.gap = fmin( c.gap, distance );
    double3 x[6];
    memcpy( x, s->predicted, sizeof( x ) );
    contact_oracle_push( &c, s->w, x );
    for ( int i = 0; i < 6; ++i )
    {
        // weights come from displacements of millimetres, known to 1e-7 m
        assert_near( double3_distance( x[i], s->after[i] ), 0.0, 2e-5 );
    }
    return c.a.weight[0] > 0.05 && c.a.weight[1] > 0.05 && c.a.weight[2] > 0.05;
}

TEST( a_boundary_particle_moves_its_parents_by_their_weights )
{
    int checked = 0, inner = 0;
    for ( int n = 0; n < 250; ++n )
    {
        six s;
        open_six( &s, n );
        double momentum[3];
        momentum_of( s.h.world, s.body, 2, momentum );
        double expected = 0.0;
        for ( int i = 0; i < 6; ++i )
        {
            expected += ( s.predicted[i].y - s.before[i].y ) / ( s.w[i] * (double)DT );
        }
        // a rounding of positions (6e-8 m) over the step, times 0.3 kg
        assert_near( momentum[1], expected, 1e-5 );
        assert_near( momentum[0], 0.0, 1e-5 );
        if ( contact_stats( s.h.world ).contacts == 1 )
        {
            checked += 1;
            inner += check_six( &s ) ? 1 : 0;
        }
        close_world( &s.h );
    }
    assert_true( checked > 30 && inner > 3 );
}

// A needle falls on a sheet: it passes between particles whose spacing is that of its edges, but not where they are
// closer.
static bool needle_passes( wisp_contact_primitives primitives, float spacing )
{
    hosted h;
    open_contact( &h, 4, 1, 1 );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.primitives = primitives;
    settings.particle_spacing = spacing;
    assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
    test_mesh double_sided = level_sheet( 3, 1.0f, ( wisp_vec3 ){ 0 } ),
              needle = triangle_mesh( ( wisp_vec3 ){ 0.13f, 0.03f, 0.31f }, ( wisp_vec3 ){ 0.14f, 0.13f, 0.31f },
                                      ( wisp_vec3 ){ 0.13f, 0.13f, 0.32f } );
    const wisp_entity a = add_pinned( h.world, &double_sided ), b = add_draping( h.world, &needle, NULL, 0, EARTH );
    const wisp_contact_def def = contact_of( 0.02f );
    set_contact( h.world, a, &def );
    set_contact( h.world, b, &def );
    request_stats( h.world );
    run_steps( h.world, 30, DT );
    assert_int_equal( contact_stats( h.world ).participants, 2 );
    const bool passed = mean_of( h.world, b, 1 ) < 0.0;
    close_world( &h );
    return passed;
}

TEST( what_is_finer_than_the_spacing_passes )
{
    assert_true( needle_passes( WISP_CONTACT_PARTICLES, 0.5f ) );
    assert_false( needle_passes( WISP_CONTACT_PARTICLES, 0.01f ) );
    assert_false( needle_passes( WISP_CONTACT_TRIANGLES, 0.5f ) );
}

TEST( more_particles_stand_on_a_finer_spacing )
{
    int points[3];
    for ( int i = 0; i < 3; ++i )
    {
        hosted h;
        open_contact( &h, 1, 1, 1 );
        wisp_contact_settings settings = wisp_default_contact_settings();
        settings.primitives = WISP_CONTACT_PARTICLES;
        settings.particle_spacing = i == 2 ? 0.0f : 0.1f / (float)( 1 + i ); // of the last: the thickness, 0.0125 m
        assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
        test_mesh double_sided = level_sheet( 3, 0.5f, ( wisp_vec3 ){ 0 } );
        const wisp_entity e = add_draping( h.world, &double_sided, NULL, 0, EARTH );
        const wisp_contact_def def = contact_of( 0.0125f );
        set_contact( h.world, e, &def );
        request_stats( h.world );
        run_steps( h.world, 1, DT );
        points[i] = contact_stats( h.world ).points;
        close_world( &h );
    }
    assert_true( points[0] > 9 && points[1] > 2 * points[0] && points[2] > 2 * points[1] );
}

// A fast sheet has a large search margin. After it stops, the search runs once more with a smaller margin.
TEST( what_has_stopped_is_not_looked_for_far_around )
{
    static const float SPEED = 2.6f, GAP = 0.02f;             // m/s, m
    const float START = 0.12f + 8.0f * ( SPEED - 0.8f ) * DT; // m
    hosted h;
    open_contact( &h, 1, 1, 1 );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.primitives = WISP_CONTACT_PARTICLES;
    settings.particle_spacing = GAP;
    settings.margin = 0.05f;
    assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
    test_mesh floor = level_sheet( 4, 0.5f, ( wisp_vec3 ){ 0 } ),
              falling = level_sheet( 4, 0.4f, ( wisp_vec3 ){ 0.01f, START, 0.02f } );
    const wisp_entity e[2] = { add_pinned( h.world, &floor ),
                               add_draping( h.world, &falling, NULL, 0, ( wisp_vec3 ){ 0 } ) };
    const wisp_contact_def def = contact_of( GAP );
    for ( int i = 0; i < 2; ++i )
    {
        set_contact( h.world, e[i], &def );
    }
    request_stats( h.world );
    int64_t candidates[2];
    int searches = 0;
    for ( int step = 0; step < 60; ++step )
    {
        for ( int v = 0; v < 16; ++v )
        {
            velocity_of( h.world, e[1], v )[1] = step < 8 ? -SPEED : 0.0f;
        }
        run_steps( h.world, 1, DT );
        candidates[step < 8 ? 0 : 1] = (int64_t)contact_stats( h.world ).candidates;
        searches += step < 8 ? 0 : contact_stats( h.world ).searches;
    }
    assert_near( mean_of( h.world, e[1], 1 ), (double)START - 8.0 * (double)( SPEED * DT ), 1e-5 );
    assert_true( candidates[0] > 1000 );
    assert_int_equal( candidates[1], 0 );
    assert_int_equal( searches, 1 );
    close_world( &h );
}

// Candidates grow with the square of the search margin, and the search repeats as soon as it is used up.
TEST( fast_particles_have_few_candidates )
{
    enum
    {
        MAX_PER_PARTICLE = 50, // 27 are found; a margin of four substeps gives 217
    };
    hosted h;
    open_contact( &h, 10, 1, 1 );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.primitives = WISP_CONTACT_PARTICLES;
    assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
    test_mesh floor = level_sheet( 4, 0.2f, ( wisp_vec3 ){ 0, -1.0f, 0 } ),
              turning = level_sheet( 6, 0.2f, ( wisp_vec3 ){ 0 } );
    const wisp_entity pinned = add_pinned( h.world, &floor ),
                      free = add_draping( h.world, &turning, NULL, 0, ( wisp_vec3 ){ 0 } );
    const wisp_contact_def def = contact_of( 0.004f );
    set_contact( h.world, pinned, &def );
    set_contact( h.world, free, &def );
    assert_status( h.world, wisp_set_velocity( h.world, free, ( wisp_vec3 ){ 4, 0, 0 }, ( wisp_vec3 ){ 0, 5, 0 } ),
                   WISP_OK );
    request_stats( h.world );
    for ( int step = 0; step < 10; ++step )
    {
        run_steps( h.world, 1, FRAME );
        const wisp_contact_stats stats = contact_stats( h.world );
        if ( stats.candidates > (int64_t)MAX_PER_PARTICLE * stats.points )
        {
            fail_msg( "%d candidates of %d particles", (int)stats.candidates, stats.points );
        }
    }
    close_world( &h );
}
