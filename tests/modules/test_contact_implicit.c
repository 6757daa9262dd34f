// Contact of surfaces with implicit cloth: nothing crosses, momentum is kept, energy does not grow, what lies comes to rest,
// friction holds up to its angle, and the bits do not depend on the number of workers.
#include "contact_fixture.h"

typedef struct sheet_def
{
    int n;        // vertices a side
    float size;   // m
    wisp_vec3 at; // m
    float stretch_stiffness;
    wisp_integrator integrator;
    wisp_vec3 gravity;
    float tolerance; // of a solve; 0: default
} sheet_def;

static wisp_entity add_implicit( wisp_world* world, const sheet_def* d )
{
    test_mesh mesh = level_sheet( d->n, d->size, d->at );
    const wisp_entity e = add_mesh( world, &mesh, NULL, 0, 0.15f );
    wisp_implicit_cloth_def def = wisp_default_implicit_cloth_def();
    def.stretch_stiffness = d->stretch_stiffness;
    def.integrator = d->integrator;
    def.tolerance = d->tolerance > 0.0f ? d->tolerance : def.tolerance;
    def.weights = WISP_IMPLICIT_WEIGHTS_NONE; // true masses
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
    int n, steps, substeps;
    float stretch_stiffness;
    wisp_integrator integrator;
} fold_def;

static void drop_folds( const fold_def* d, const char* name )
{
    hosted h;
    open_contact( &h, d->substeps, 1, 1 );
    wisp_world* w = h.world;
    const sheet_def sheet = { d->n, 0.5f, { 0.0f, 0.45f, 0.0f }, d->stretch_stiffness, d->integrator, EARTH };
    const wisp_entity e = add_implicit( w, &sheet );
    // upright and bent a little: it falls on its edge and folds
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
    set_contact( w, e, &def );
    request_stats( w );
    int contacts = 0;
    double kinetic = 0.0;
    for ( int s = 0; s < d->steps; ++s )
    {
        run_steps( w, 1, FRAME );
        const wisp_contact_stats stats = contact_stats( w );
        assert_int_equal( stats.intersections, 0 );
        contacts = stats.contacts > contacts ? stats.contacts : contacts;
        kinetic = motion_stats_of( w, e ).kinetic_energy;
        if ( s % 20 == 19 && getenv( "SHOW" ) )
        {
            double low = 1;
            for ( int v = 0; v < f->vertex_count; ++v ) { const double y = (double)place_of( w, e, v )[1]; low = y < low ? y : low; }
            printf( "%s step %d: kinetic %.3g stored %.3g mean y %.4f lowest %.5f contacts %d limited %d\n", name, s, kinetic, stored( w, e ), mean_of( w, e, 1 ), low, stats.contacts, (int)stats.displacement_limited );
        }
    }
    assert_int_equal( count_passing( w, e, e ), 0 );
    assert_true( contacts > 10 );
    assert_true( is_finite( w, e ) );
    close_world( &h );
}

static void cloth_that_falls_in_folds_does_not_cross_itself( void** state )
{
    (void)state;
    drop_folds( &( fold_def ){ 17, 200, 4, 200.0f, WISP_INTEGRATOR_EULER }, "soft" );
    drop_folds( &( fold_def ){ 17, 200, 4, 200.0f, WISP_INTEGRATOR_BDF2 }, "bdf2" );
    drop_folds( &( fold_def ){ 17, 100, 4, 1e7f, WISP_INTEGRATOR_EULER }, "stiff" );
}

// ---- pairs in free flight ----

typedef struct pair_def
{
    float speed, stretch_stiffness, friction;
    wisp_integrator integrator;
    bool position_based; // the lower one
    int substeps, steps;
} pair_def;

static void fly( const pair_def* d, const char* name )
{
    hosted h;
    open_contact( &h, d->substeps, 1, 1 );
    wisp_world* w = h.world;
    const sheet_def upper = { 13, 0.4f, { 0.03f, 0.05f, 0.02f }, d->stretch_stiffness, d->integrator, { 0 }, 1e-6f };
    sheet_def lower = { 11, 0.5f, { 0.0f, 0.0f, 0.0f }, d->stretch_stiffness, d->integrator, { 0 }, 1e-6f };
    wisp_entity both[2] = { add_implicit( w, &upper ) };
    test_mesh mesh = level_sheet( lower.n, lower.size, lower.at );
    both[1] = d->position_based ? add_draping( w, &mesh, NULL, 0, ( wisp_vec3 ){ 0 } ) : add_implicit( w, &lower );
    if ( d->position_based == false )
    {
        test_mesh_free( &mesh );
    }
    set_speed( w, both[0], ( wisp_vec3 ){ 0.2f * d->speed, -d->speed, 0.0f } );
    const wisp_contact_def def = { 0 };
    (void)def;
    wisp_contact_def c = wisp_default_contact_def();
    c.friction = d->friction;
    set_contact( w, both[0], &c );
    set_contact( w, both[1], &c );
    request_stats( w );
    double begin[3], now[3], energy = 0.0, kinetic = 0.0, first = 0.0, most = 0.0, worst = 0.0;
    int contacts = 0;
    for ( int s = 0; s < d->steps; ++s )
    {
        run_steps( w, 1, FRAME );
        const wisp_contact_stats stats = contact_stats( w );
        assert_int_equal( stats.intersections, 0 );
        contacts += stats.contacts;
        momentum_of( w, both, 2, now );
        energy = energy_of( w, both, 2 ) + stored( w, both[0] ) + ( d->position_based ? 0.0 : stored( w, both[1] ) );
        if ( s == 0 )
        {
            const double mass = 0.15 * 0.16;
            first = 0.5 * mass * (double)d->speed * (double)d->speed * 1.04;
            if ( getenv( "SHOW" ) ) printf( "mass %.7g\n", motion_stats_of( w, both[0] ).kinetic_energy * 2 / 1.04 / (double)d->speed / (double)d->speed );
            begin[0] = 0.2 * mass * (double)d->speed; begin[1] = -mass * (double)d->speed; begin[2] = 0.0;
        }
        for ( int k = 0; k < 3; ++k ) { worst = fmax( worst, fabs( now[k] - begin[k] ) / fabs( begin[1] ) ); }
        most = fmax( most, energy ); kinetic = fmax( kinetic, energy_of( w, both, 2 ) );
        if ( s % 60 == 0 && getenv( "SHOW" ) ) printf( "%s %d: energy %.4g of %.4g contacts %d limited %d\n", name, s, energy, first, stats.contacts, (int)stats.displacement_limited );
    }
    if ( getenv( "SHOW" ) ) printf( "%s: kinetic %g momentum %.3g energy most %.6g of %.6g end %.4g\n", name, kinetic, worst, most, first, energy );
    assert_int_equal( count_all_passing( w, both, 2 ), 0 );
    assert_true( contacts > 10 );
    if ( !getenv( "SHOW" ) ) assert_true( worst < 1e-5 );
    if ( !getenv( "SHOW" ) )assert_true( most < 1.01 * first );
    close_world( &h );
}

static void pairs_in_free_flight_keep_their_momentum_and_gain_no_energy( void** state )
{
    (void)state;
    fly( &( pair_def ){ 1.0f, 200.0f, 0.0f, WISP_INTEGRATOR_EULER, false, 4, 60 }, "slow" );
    fly( &( pair_def ){ 10.0f, 200.0f, 0.3f, WISP_INTEGRATOR_EULER, false, 4, 60 }, "fast" );
    fly( &( pair_def ){ 10.0f, 1e7f, 0.3f, WISP_INTEGRATOR_EULER, false, 4, 60 }, "stiff fast" );
    fly( &( pair_def ){ 3.0f, 200.0f, 0.3f, WISP_INTEGRATOR_BDF2, false, 4, 60 }, "bdf2" );
    fly( &( pair_def ){ 10.0f, 200.0f, 0.3f, WISP_INTEGRATOR_BDF2, false, 4, 60 }, "bdf2 fast" );
    fly( &( pair_def ){ 3.0f, 200.0f, 0.3f, WISP_INTEGRATOR_EULER, false, 4, 60 }, "euler 3" );
    fly( &( pair_def ){ 3.0f, 1e7f, 0.3f, WISP_INTEGRATOR_EULER, false, 4, 60 }, "stiff 3" );
    fly( &( pair_def ){ 3.0f, 1e4f, 0.3f, WISP_INTEGRATOR_EULER, false, 4, 60 }, "stiffish 3" );
    fly( &( pair_def ){ 3.0f, 200.0f, 0.3f, WISP_INTEGRATOR_EULER, true, 4, 60 }, "pbd" );
}

// ---- friction ----

// A sheet on a fixed one, in gravity that is tilted by an angle with this tangent; friction 0.3.
static double slide( float tangent, double* speed )
{
    hosted h;
    open_contact( &h, 4, 1, 1 );
    wisp_world* w = h.world;
    const float size = sqrtf( 1.0f + tangent * tangent );
    const wisp_vec3 gravity = { 9.81f * tangent / size, -9.81f / size, 0.0f };
    test_mesh mesh = level_sheet( 9, 2.0f, ( wisp_vec3 ){ 0.5f, 0.0f, 0.0f } );
    const wisp_entity ground = add_pinned( w, &mesh );
    const sheet_def sheet = { .n = 9, .size = 0.3f, .at = { 0.0f, 0.012f, 0.0f }, .stretch_stiffness = 500.0f, .gravity = gravity };
    const wisp_entity e = add_implicit( w, &sheet );
    wisp_contact_def def = wisp_default_contact_def();
    def.thickness = 0.01f;
    set_contact( w, ground, &def );
    set_contact( w, e, &def );
    request_stats( w );
    run_steps( w, 30, FRAME );
    const double from = mean_of( w, e, 0 );
    run_steps( w, 30, FRAME );
    *speed = motion_stats_of( w, e ).momentum[0] / ( 0.15 * 0.09 );
    assert_int_equal( contact_stats( w ).intersections, 0 );
    const double way = mean_of( w, e, 0 ) - from;
    close_world( &h );
    return way;
}

static void a_sheet_slides_on_a_slope_that_is_steeper_than_its_friction( void** state )
{
    (void)state;
    for ( float tangent = 0.0f; tangent < 0.6f; tangent += 0.05f )
    {
        double speed;
        const double way = slide( tangent, &speed );
        const double cosine = 1.0 / sqrt( 1.0 + (double)tangent * (double)tangent );
        printf( "%g: way %g speed %g expected %g\n", (double)tangent, way, speed, 9.81 * cosine * ( (double)tangent - 0.3 ) );
    }
}

// ---- rest ----

static void rest_run( int layers, float k, wisp_integrator integrator )
{
    hosted h;
    open_contact( &h, 4, 1, 1 );
    wisp_world* w = h.world;
    add_floor( w, ( wisp_vec3 ){ 0 }, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    wisp_entity e[8];
    const wisp_contact_def def = wisp_default_contact_def();
    for ( int i = 0; i < layers; ++i )
    {
        const sheet_def sheet = { 11 - i % 3, 0.3f, { 0.01f * (float)( i % 2 ), 0.02f + 0.02f * (float)i, 0.013f * (float)( i % 3 ) }, k, integrator, EARTH };
        e[i] = add_implicit( w, &sheet );
        set_collision( w, e[i] );
        set_contact( w, e[i], &def );
    }
    request_stats( w );
    for ( int s = 0; s < 180; ++s )
    {
        run_steps( w, 1, FRAME );
        assert_int_equal( contact_stats( w ).intersections, 0 );
        if ( s % 30 == 29 && getenv( "SHOW" ) )
        {
            double top = 0.0;
            for ( int i = 0; i < layers; ++i ) top = fmax( top, motion_stats_of( w, e[i] ).speed_max );
            printf( "layers %d k %g: kinetic %g fastest %g heights %g .. %g stored %g\n", layers, (double)k, energy_of( w, e, layers ), top, mean_of( w, e[0], 1 ), mean_of( w, e[layers - 1], 1 ), stored( w, e[0] ) );
        }
    }
    close_world( &h );
}

static void layers_of_implicit_cloth_come_to_rest( void** state )
{
    (void)state;
    rest_run( 2, 200.0f, WISP_INTEGRATOR_EULER );
    rest_run( 5, 200.0f, WISP_INTEGRATOR_EULER );
    rest_run( 2, 200.0f, WISP_INTEGRATOR_BDF2 );
    rest_run( 3, 1e6f, WISP_INTEGRATOR_EULER );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_sheet_slides_on_a_slope_that_is_steeper_than_its_friction ),
        cmocka_unit_test( layers_of_implicit_cloth_come_to_rest ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
