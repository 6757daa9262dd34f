// Contact of surfaces with implicit cloth: nothing crosses, momentum is kept, energy does not grow, what lies comes to rest,
// friction holds up to its angle. Bits are compared in test_contact_determinism.c.
#include "contact_fixture.h"

#include "wisp/moving_frame.h"

typedef struct sheet_def
{
    int n;        // vertices a side
    float size;   // m
    wisp_vec3 at; // m
    float stretch_stiffness;
    wisp_integrator integrator;
    wisp_vec3 gravity;
    float tolerance; // of a solve; 0: default
    float density;   // kg/m^2; 0: 0.15
} sheet_def;

static wisp_entity add_implicit( wisp_world* world, const sheet_def* d )
{
    test_mesh mesh = level_sheet( d->n, d->size, d->at );
    const wisp_entity e = add_mesh( world, &mesh, NULL, 0, d->density > 0.0f ? d->density : 0.15f );
    wisp_implicit_cloth_def def = wisp_default_implicit_cloth_def();
    def.stretch_stiffness = d->stretch_stiffness;
    def.integrator = d->integrator;
    def.tolerance = d->tolerance > 0.0f ? d->tolerance : def.tolerance;
    def.stiffness_model = WISP_IMPLICIT_STIFFNESS_LINK; // rounds less than a plate
    assert_status( world, wisp_set_implicit_cloth( world, e, &def ), WISP_OK );
    assert_status( world, wisp_request_implicit_cloth_stats( world, e, true ), WISP_OK );
    assert_status( world, wisp_set_gravity( world, e, d->gravity ), WISP_OK );
    return e;
}

static void set_speed( wisp_world* world, wisp_entity e, wisp_vec3 v )
{
    for ( int i = 0; i < wisp_world_fabric( world, e )->vertex_count; ++i )
    {
        memcpy( velocity_of( world, e, i ), &v, sizeof( v ) );
    }
}

static double stored( wisp_world* world, wisp_entity e )
{
    wisp_implicit_cloth_stats s;
    assert_status( world, wisp_read_implicit_cloth_stats( world, e, &s ), WISP_OK );
    return s.stretch_energy + s.bend_energy;
}

// ---- folds ----

typedef struct fold_def
{
    float stretch_stiffness;
    wisp_integrator integrator;
    bool touches;
    int steps;
} fold_def;

// A sheet that stands on the ground, a little bent, falls into folds. @return intersections at the end
static int drop_folds( const fold_def* d )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 4, 1, 1 );
    wisp_world* w = h.world;
    const sheet_def sheet = { .n = 13,
                              .size = 0.5f,
                              .stretch_stiffness = d->stretch_stiffness,
                              .integrator = d->integrator,
                              .gravity = EARTH };
    const wisp_entity e = add_implicit( w, &sheet );
    const wisp_fabric* f = wisp_world_fabric( w, e );
    float* x = wisp_world_column( w, e, WISP_PARTICLE_POSITION, 0 );
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        float* p = x + 4 * (size_t)f->vertex_slot[v];
        const float up = p[0] + 0.25f;
        p[0] = 0.02f * sinf( 9.0f * up ) + 0.01f * p[2];
        p[1] = 0.02f + up;
    }
    add_floor( w, ( wisp_vec3 ){ 0 }, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    set_collision( w, e );
    const wisp_contact_def def = wisp_default_contact_def();
    if ( d->touches )
    {
        set_contact( w, e, &def );
        request_stats( w );
    }
    int contacts = 0, crossings = 0;
    for ( int s = 0; s < d->steps; ++s )
    {
        run_steps( w, 1, FRAME );
        const wisp_contact_stats stats = d->touches ? contact_stats( w ) : ( wisp_contact_stats ){ 0 };
        assert_int_equal( stats.intersections, 0 );
        contacts = stats.contacts > contacts ? stats.contacts : contacts;
        if ( s % 40 == 39 )
        {
            crossings += count_passing( w, e, e );
        }
    }
    assert_true( d->touches == false || contacts > 30 );
    assert_true( is_finite( w, e ) );
    return crossings;
}

TEST( soft_cloth_that_falls_in_folds_does_not_cross_itself )
{
    fold_def d = { 200.0f, WISP_INTEGRATOR_EULER, true, 120 };
    assert_int_equal( drop_folds( &d ), 0 );
    d.integrator = WISP_INTEGRATOR_BDF2;
    assert_int_equal( drop_folds( &d ), 0 );
    d.touches = false; // it would
    assert_true( drop_folds( &d ) > 10 );
}

// k h^2 / m is above 1e6.
TEST( stiff_cloth_that_falls_in_folds_does_not_cross_itself )
{
    assert_int_equal( drop_folds( &( fold_def ){ 2e7f, WISP_INTEGRATOR_EULER, true, 80 } ), 0 );
}

// ---- pairs in free flight ----

typedef struct pair_def
{
    float speed, stretch_stiffness;
    wisp_integrator integrator;
    bool position_based; // the lower one
    double momentum;     // allowed change, relative to the first momentum
    double energy;       // allowed, relative to the first energy; without what links store if they are stiff
} pair_def;

// A sheet flies into one that stands still.
static void fly( const pair_def* d )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 4, 1, 1 );
    wisp_world* w = h.world;
    // the error of a solve is the only one in the momentum
    sheet_def upper = {
        13, 0.4f, { 0.03f, 0.05f, 0.02f }, d->stretch_stiffness, d->integrator, { 0.0f, 0.0f, 0.0f }, 1e-7f, 0.0f
    };
    sheet_def lower = upper;
    lower.n = 11;
    lower.size = 0.5f;
    lower.at = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    wisp_entity both[2] = { add_implicit( w, &upper ) };
    if ( d->position_based )
    {
        test_mesh mesh = level_sheet( lower.n, lower.size, lower.at );
        both[1] = add_draping( w, &mesh, NULL, 0, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    }
    else
    {
        both[1] = add_implicit( w, &lower );
    }
    set_speed( w, both[0], ( wisp_vec3 ){ 0.2f * d->speed, -d->speed, 0.0f } );
    const wisp_contact_def def = wisp_default_contact_def();
    set_contact( w, both[0], &def );
    set_contact( w, both[1], &def );
    request_stats( w );
    const double mass = 0.15 * 0.16, speed = (double)d->speed, energy = 0.5 * mass * 1.04 * speed * speed;
    const double begin[3] = { 0.2 * mass * speed, -mass * speed, 0.0 };
    double impulse = 0.0;
    for ( int s = 0; s < 40; ++s )
    {
        run_steps( w, 1, FRAME );
        const wisp_contact_stats stats = contact_stats( w );
        assert_int_equal( stats.intersections, 0 );
        impulse += stats.impulse;
        double now[3];
        momentum_of( w, both, 2, now );
        for ( int k = 0; k < 3; ++k )
        {
            assert_true( fabs( now[k] - begin[k] ) < d->momentum * mass * speed );
        }
        const double links = d->stretch_stiffness > 1e3f ? 0.0 : stored( w, both[0] );
        assert_true( energy_of( w, both, 2 ) + links < d->energy * energy );
    }
    assert_true( impulse > 0.0 );
    assert_int_equal( count_all_passing( w, both, 2 ), 0 );
}

// Positions are rounded to 1e-8 m, which is 2e-6 m/s in a substep: it matters more in slow flight.
TEST( a_pair_in_free_flight_keeps_its_momentum )
{
    fly( &( pair_def ){ 1.0f, 200.0f, WISP_INTEGRATOR_EULER, false, 3e-5, 1.001 } );
    fly( &( pair_def ){ 3.0f, 200.0f, WISP_INTEGRATOR_EULER, false, 1e-5, 1.001 } );
    fly( &( pair_def ){ 3.0f, 200.0f, WISP_INTEGRATOR_BDF2, false, 1e-5, 1.001 } );
}

TEST( implicit_cloth_meets_position_based_cloth )
{
    fly( &( pair_def ){ 3.0f, 200.0f, WISP_INTEGRATOR_EULER, true, 1e-5, 1.001 } );
}

// The displacement limit moves points here, by equal and opposite impulses.
TEST( at_ten_metres_per_second_nothing_crosses_or_gains_energy )
{
    fly( &( pair_def ){ 10.0f, 200.0f, WISP_INTEGRATOR_EULER, false, 1e-5, 1.001 } );
    fly( &( pair_def ){ 10.0f, 200.0f, WISP_INTEGRATOR_BDF2, false, 2e-5, 1.001 } );
    fly( &( pair_def ){ 10.0f, 1e7f, WISP_INTEGRATOR_EULER, false, 0.05, 1.001 } );
}

// ---- friction ----

// A sheet on a fixed one, in gravity that is tilted by an angle with this tangent; friction 0.3.
// @return m/s, mean speed after half a second
static double slide( float tangent )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 4, 1, 1 );
    wisp_world* w = h.world;
    const float size = sqrtf( 1.0f + tangent * tangent );
    test_mesh mesh = level_sheet( 9, 2.0f, ( wisp_vec3 ){ 0.5f, 0.0f, 0.0f } );
    const wisp_entity ground = add_pinned( w, &mesh );
    const sheet_def sheet = { .n = 9,
                              .size = 0.3f,
                              .at = { 0.0f, 0.012f, 0.0f },
                              .stretch_stiffness = 500.0f,
                              .gravity = { 9.81f * tangent / size, -9.81f / size, 0.0f } };
    const wisp_entity e = add_implicit( w, &sheet );
    wisp_contact_def rough = contact_of( 0.01f );
    rough.friction = 0.3f;
    set_contact( w, ground, &rough );
    set_contact( w, e, &rough );
    run_steps( w, 30, FRAME );
    const wisp_motion_stats stats = motion_stats_of( w, e );
    return stats.momentum[0] / stats.mass;
}

TEST( a_sheet_slides_on_a_slope_that_is_steeper_than_its_friction )
{
    assert_true( fabs( slide( 0.28f ) ) < 1e-4 );
    // v = g ( sin - mu cos ) t, from the landing at about 0.02 s on
    const double expected = 9.81 / sqrt( 1.0 + 0.4 * 0.4 ) * ( 0.4 - 0.3 ) * 0.48;
    assert_true( fabs( slide( 0.4f ) - expected ) < 0.15 * expected );
}

// ---- rest ----

typedef struct pile_def
{
    int layers;
    float top_density; // kg/m^2
    wisp_integrator integrator;
    int steps;
} pile_def;

typedef struct pile_end
{
    double speed, lowest; // m/s, m
} pile_end;

static pile_end pile_up( const pile_def* d )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 4, 1, 1 );
    wisp_world* w = h.world;
    add_floor( w, ( wisp_vec3 ){ 0 }, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    wisp_entity e[4];
    const wisp_contact_def def = wisp_default_contact_def();
    for ( int i = 0; i < d->layers; ++i )
    {
        const sheet_def sheet = { .n = 11 - i % 3,
                                  .size = 0.3f,
                                  .at = { 0.01f * (float)( i % 2 ), 0.02f + 0.02f * (float)i,
                                          0.013f * (float)( i % 3 ) },
                                  .stretch_stiffness = 200.0f,
                                  .integrator = d->integrator,
                                  .gravity = EARTH,
                                  .density = i + 1 == d->layers ? d->top_density : 0.15f };
        e[i] = add_implicit( w, &sheet );
        set_collision( w, e[i] );
        set_contact( w, e[i], &def );
    }
    request_stats( w );
    pile_end end = { 0.0, INFINITY };
    for ( int s = 0; s < d->steps; ++s )
    {
        run_steps( w, 1, FRAME );
        assert_int_equal( contact_stats( w ).intersections, 0 );
        for ( int i = 0; i < d->layers && s > d->steps - 20; ++i )
        {
            end.speed = fmax( end.speed, motion_stats_of( w, e[i] ).speed_max );
        }
        for ( int v = 0; v < wisp_world_fabric( w, e[0] )->vertex_count; ++v )
        {
            end.lowest = fmin( end.lowest, (double)place_of( w, e[0], v )[1] );
        }
    }
    return end;
}

// A substep of gravity gives 0.04 m/s, which contact takes.
TEST( two_layers_come_to_rest )
{
    assert_true( pile_up( &( pile_def ){ 2, 0.15f, WISP_INTEGRATOR_EULER, 100 } ).speed < 0.03 );
    assert_true( pile_up( &( pile_def ){ 2, 0.15f, WISP_INTEGRATOR_BDF2, 100 } ).speed < 0.03 );
}

// Half a margin of the lower layer is 3.75 mm.
TEST( a_heavy_layer_does_not_press_a_light_one_into_the_ground )
{
    const pile_end end = pile_up( &( pile_def ){ 2, 3.0f, WISP_INTEGRATOR_EULER, 60 } );
    assert_true( end.lowest > 0.0037 );
}

// ---- largest speed ----

TEST( no_vertex_of_implicit_cloth_is_faster_than_the_largest_speed )
{
    for ( int i = 0; i < 4; ++i )
    {
        SCOPED( close_world ) hosted h;
        open_contact( &h, 4, 1, 1 );
        wisp_world* w = h.world;
        const sheet_def sheet = { .n = 9,
                                  .size = 0.3f,
                                  .at = { 0.0f, 0.05f, 0.0f },
                                  .stretch_stiffness = 200.0f,
                                  .integrator = i % 2 == 0 ? WISP_INTEGRATOR_EULER : WISP_INTEGRATOR_BDF2,
                                  .gravity = EARTH };
        const wisp_entity e = add_implicit( w, &sheet );
        assert_status( w, wisp_set_max_speed( w, e, 0.5f ), WISP_OK );
        if ( i >= 2 ) // pushed by what moves faster
        {
            test_mesh mesh = level_sheet( 9, 0.3f, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
            const wisp_entity other = add_draping( w, &mesh, NULL, 0, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
            set_speed( w, other, ( wisp_vec3 ){ 0.0f, 5.0f, 0.0f } );
            const wisp_contact_def def = wisp_default_contact_def();
            set_contact( w, e, &def );
            set_contact( w, other, &def );
        }
        double fastest = 0.0;
        for ( int s = 0; s < 20; ++s )
        {
            run_steps( w, 1, FRAME );
            fastest = fmax( fastest, motion_stats_of( w, e ).speed_max );
        }
        assert_true( fastest < 0.5001 && fastest > 0.49 );
        assert_true( wisp_world_counter( w, WISP_COUNT_SPEED_LIMITED ) > 0 );
    }
}
