// Membranes: a strip under its own weight and a balloon against closed forms, wrinkles, momenta, bits, what is refused.
#include "cloth_fixture.h"

#include "balloon.h"
#include "implicit_cloth.h"
#include "membrane.h"
#include "oracle/membrane_oracle.h"
#include "tearing.h"

enum
{
    CELLS = 40, // along a strip, two across
    ROWS = CELLS + 1,
};

static const float CELL = 0.01f, FRAME = 1.0f / 60.0f;

static hosted* open_membranes( int substeps, int iterations, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_membrane_module, &wisp_balloon_module, &wisp_cloth_module,
                                                  &wisp_implicit_cloth_module, &wisp_tearing_module };
    return new_hosted( MODULES, WISP_COUNT( MODULES ), substeps, iterations, workers );
}

static wisp_membrane_def rubber( float stiffness, bool tension_field )
{
    wisp_membrane_def def = wisp_default_membrane_def();
    def.thickness = 1e-4f;
    def.shear_modulus = stiffness / def.thickness;
    def.tension_field = tension_field;
    return def;
}

static test_mesh make_strip( void )
{
    return hanging_mesh( 3, ROWS, CELL, CELL );
}

static test_mesh make_sphere( int level, float radius )
{
    test_mesh m = test_ball( level );
    for ( int v = 0; v < m.vertex_count; ++v )
    {
        m.points[v] = ( wisp_vec3 ){ radius * m.points[v].x, radius * m.points[v].y, radius * m.points[v].z };
    }
    return m;
}

static wisp_entity add_membrane( wisp_world* world, const test_mesh* mesh, wisp_surface_def surface,
                                 wisp_membrane_def membrane )
{
    const wisp_fabric_def fabric = test_fabric_def( mesh );
    const wisp_entity e = test_surface_of( world, &fabric, surface );
    assert_status( world, wisp_set_membrane( world, e, &membrane ), WISP_OK );
    assert_status( world, wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    return e;
}

// ---- closed forms ----

// Length of a strip that hangs: at X below its top the tension per width is w g (L - X) = G ( s - 1 / s^2 ).
static double hanging_length( double stiffness, double weight, double length )
{
    enum
    {
        PARTS = 2000,
    };
    double sum = 0.0;
    for ( int i = 0; i < PARTS; ++i )
    {
        const double load = weight * length * ( i + 0.5 ) / PARTS;
        double low = 1.0, high = 100.0;
        for ( int k = 0; k < 60; ++k )
        {
            const double s = 0.5 * ( low + high );
            low = membrane_oracle_strip_tension( stiffness, s ) < load ? s : low;
            high = membrane_oracle_strip_tension( stiffness, s ) < load ? high : s;
        }
        sum += low * length / PARTS;
    }
    return sum;
}

TEST( a_strip_hangs_as_long_as_its_weight_pulls )
{
    static const int32_t PINS[] = { 0, 1, 2 };
    for ( int iterations = 1; iterations <= 4; iterations += 3 )
    {
        for ( int field = 0; field < 2; ++field )
        {
            SCOPED( close_local ) hosted* h = open_membranes( 40 / iterations, iterations, 1 );
            SCOPED( test_mesh_free ) test_mesh mesh = make_strip();
            wisp_surface_def surface = support_weightless_surface_def();
            surface.area_density = 0.2f;
            surface.gravity = ( wisp_vec3 ){ 0.0f, -9.81f, 0.0f };
            surface.pins = PINS;
            surface.pin_count = WISP_COUNT( PINS );
            const wisp_entity e = add_membrane( h->world, &mesh, surface, rubber( 0.5f, field == 1 ) );
            assert_status( h->world, wisp_set_damping( h->world, e, 4.0f ), WISP_OK );
            run_steps( h->world, 240, FRAME );
            const double length = -(double)point_of( h->world, e, 3 * CELLS + 1 ).y;
            const double expected = hanging_length( 0.5, 0.2 * 9.81, (double)CELL * CELLS );
            // 0.57 m from 0.4 m; the top cannot narrow
            assert_true( expected > 0.5 );
            assert_true( fabs( length / expected - 1.0 ) < 0.01 );
        }
    }
}

// A balloon of rubber on both sides of its limit point.
TEST( a_balloon_holds_the_pressure_of_rubber )
{
    for ( int size = 0; size < 2; ++size )
    {
        SCOPED( close_local ) hosted* h = open_membranes( 40, 1, 1 );
        SCOPED( test_mesh_free ) test_mesh mesh = make_sphere( 4, 0.05f );
        wisp_surface_def surface = support_weightless_surface_def();
        surface.area_density = 2.0f; // heavy, so that few substeps are enough
        const wisp_entity e = add_membrane( h->world, &mesh, surface, rubber( 80.0f, size == 1 ) );
        SET( h->world, e, balloon, d.buoyancy = false, d.drag_coefficient = 0.0f );
        assert_status( h->world, wisp_request_balloon_stats( h->world, e, true ), WISP_OK );
        assert_status( h->world, wisp_set_damping( h->world, e, 20.0f ), WISP_OK );
        const float gas = size == 0 ? 1.8f : 8.0f;
        for ( int i = 1; i <= 40; ++i )
        {
            assert_status( h->world,
                           wisp_set_balloon_gas_ratio( h->world, e, 1.0f + ( gas - 1.0f ) * (float)i / 40.0f ),
                           WISP_OK );
            run_steps( h->world, 1, FRAME );
        }
        run_steps( h->world, 60, FRAME );
        wisp_balloon_stats seen;
        assert_status( h->world, wisp_read_balloon_stats( h->world, e, &seen ), WISP_OK );
        const double s = cbrt( seen.volume / seen.rest_volume ),
                     radius = cbrt( seen.rest_volume * 3.0 / ( 4.0 * 3.14159265358979323846 ) );
        assert_true( size == 0 ? s > 1.15 && s < 1.25 : s > 1.9 && s < 2.05 );
        const double expected = membrane_oracle_sphere_pressure( 80.0, radius, s );
        assert_true( fabs( seen.pressure / expected - 1.0 ) < 0.02 );
    }
}

// ---- wrinkles ----

// Pushed together to four fifths between its ends, a strip without compression has nothing that moves it.
TEST( a_tension_field_holds_no_compression )
{
    static const int32_t PINS[] = { 0, 1, 2, 3 * CELLS, 3 * CELLS + 1, 3 * CELLS + 2 };
    for ( int field = 0; field < 2; ++field )
    {
        SCOPED( close_local ) hosted* h = open_membranes( 4, 1, 1 );
        SCOPED( test_mesh_free ) test_mesh mesh = make_strip();
        wisp_vec3 near[3 * ROWS];
        for ( int v = 0; v < mesh.vertex_count; ++v )
        {
            near[v] = ( wisp_vec3 ){ 0.8f * mesh.points[v].x, 0.8f * mesh.points[v].y, 0.0f };
        }
        wisp_surface_def surface = support_weightless_surface_def();
        surface.points = near;
        surface.area_density = 0.2f;
        surface.pins = PINS;
        surface.pin_count = WISP_COUNT( PINS );
        const wisp_entity e = add_membrane( h->world, &mesh, surface, rubber( 10.0f, field == 1 ) );
        run_steps( h->world, 2, FRAME );
        float largest = 0.0f;
        for ( int v = 0; v < mesh.vertex_count; ++v )
        {
            largest = fmaxf( largest, fabsf( point_of( h->world, e, v ).x - near[v].x ) );
        }
        assert_true( field == 1 ? largest == 0.0f : largest > 1e-4f );
    }
}

// ---- all of it ----

// Substeps of 1/600 s take (5/s h)^2 / 2 of the angular momentum each, as of any body that turns.
TEST( a_free_membrane_keeps_its_momenta )
{
    SCOPED( close_local ) hosted* h = open_membranes( 10, 1, 2 );
    SCOPED( test_mesh_free ) test_mesh mesh = make_sphere( 3, 0.1f );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.area_density = 0.2f;
    const wisp_entity e = add_membrane( h->world, &mesh, surface, rubber( 100.0f, false ) );
    assert_status( h->world,
                   wisp_set_velocity( h->world, e, ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f }, ( wisp_vec3 ){ 0, 5.0f, 0 } ),
                   WISP_OK );
    assert_status( h->world, wisp_request( h->world, e, WISP_MOTION_STATS ), WISP_OK );
    run_steps( h->world, 1, FRAME );
    const wisp_motion_stats first = motion_stats_of( h->world, e );
    run_steps( h->world, 30, FRAME );
    const wisp_motion_stats last = motion_stats_of( h->world, e );
    for ( int i = 0; i < 3; ++i )
    {
        assert_true( fabs( last.momentum[i] - first.momentum[i] ) < 1e-4 * fabs( first.momentum[0] ) );
        assert_true( fabs( last.angular_momentum[i] - first.angular_momentum[i] ) <
                     0.03 * fabs( first.angular_momentum[1] ) );
    }
}

TEST( what_cannot_be_is_refused )
{
    SCOPED( close_local ) hosted* h = open_membranes( 2, 1, 1 );
    wisp_world* w = h->world;
    SCOPED( test_mesh_free ) test_mesh mesh = make_sphere( 1, 0.1f );
    const wisp_surface_def surface = support_weightless_surface_def();
    const wisp_entity e = add_membrane( w, &mesh, surface, rubber( 10.0f, false ) );
    wisp_membrane_def def = wisp_default_membrane_def();
    wisp_cloth_def cloth = wisp_default_cloth_def();
    expect_refusal( w, wisp_set_cloth( w, e, &cloth ), WISP_CONFLICT, "bending by links" );
    const wisp_implicit_cloth_def implicit = wisp_default_implicit_cloth_def();
    expect_refusal( w, wisp_set_implicit_cloth( w, e, &implicit ), WISP_CONFLICT, "membrane" );
    wisp_tearing_def tearing = wisp_default_tearing_def();
    tearing.strength = 1.0f;
    expect_refusal( w, wisp_set_tearing( w, e, &tearing ), WISP_CONFLICT, "is no cloth" );
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    const wisp_entity linked = test_surface_of( w, &fabric, surface );
    assert_status( w, wisp_set_cloth( w, linked, &cloth ), WISP_OK );
    expect_refusal( w, wisp_set_membrane( w, linked, &def ), WISP_CONFLICT, "before cloth or balloon" );
    assert_status( w, wisp_set_membrane( w, e, NULL ), WISP_OK );
    assert_status( w, wisp_set_cloth( w, e, &cloth ), WISP_OK );
    run_steps( w, 1, FRAME );
}
