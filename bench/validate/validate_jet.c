// A full balloon without weight and without air empties through an outlet: the speed that its jet gives it.
#include "validate/validate.h"

#include "accuracy/scene_tools.h"
#include "validate/validate_balloons.h"
#include "validate/validate_bodies.h"
#include "oracle/balloon_oracle.h"
#include "oracle/balloon_meshes.h"

#include <math.h>
#include <stdlib.h>

enum
{
    USUAL_SUBSTEPS = 40,
    FINE_SUBSTEPS = 80,
};

#define FILL 1.2          // V_0 / V_rest
#define SKIN_DENSITY 0.1f // kg/m^2
// It empties in 0.3 s, some hundred periods of the skin, and within a metre of the origin: farther away, with shorter substeps, or with a
// weaker jet, floats round off what a substep adds to a position.
#define OUTLET_AREA 1.6e-4 // m^2

// ---- theory ----

static double pressure_of( const void* context, double gas_volume )
{
    const full_sphere* body = context;
    return balloon_equilibrium_at( body->fabric, &body->setting.def, gas_volume / body->balance.volume, false )
        .pressure;
}

static balloon_theory_flow theory_of( const full_sphere* body, double mass, double to_ratio )
{
    const wisp_balloon_def* def = &body->setting.def;
    const balloon_theory_jet jet = {
        .pressure = pressure_of,
        .context = body,
        .density = balloon_oracle_density( (double)def->atmospheric_pressure, (double)def->gas_molar_mass,
                                           (double)def->temperature ),
        .mass = mass,
        .area = (double)def->outlet_area,
    };
    return balloon_theory_empty( &jet, FILL * body->balance.volume, to_ratio * body->balance.volume );
}

// ---- a run ----

static wisp_status make_body( const full_way* w, int workers, full_sphere* out, wisp_error* error )
{
    balloon_setting setting = balloon_setting_in_vacuum();
    setting.def.outlet_count = 1;
    setting.def.outlet_area = (float)w->outlet;
    setting.def.outlet_open = true;
    setting.area_density = SKIN_DENSITY;
    return full_sphere_make( w, setting, workers, out, error );
}

// What is seen of the gas from step to step.
typedef struct gas_watch
{
    double fill; // V_0 / V_rest at the last step
    double half; // s, when half of the gas that was added was gone; NaN: not yet
} gas_watch;

static void watch_gas( const wisp_balloon_stats* seen, int step, gas_watch* watch )
{
    const double fill = seen->target_volume / seen->rest_volume, half = 0.5 * ( 1.0 + FILL );
    if ( isnan( watch->half ) && fill <= half )
    {
        const double part = ( watch->fill - half ) / ( watch->fill - fill );
        watch->half = (double)ACCURACY_FRAME * ( step - 1 + part );
    }
    watch->fill = fill;
}

static wisp_status fly( surface_implementation* balloon, int steps, bool is_observed, gas_watch* watch,
                        accuracy_run* out, wisp_error* error )
{
    wisp_status status = wisp_request_balloon_stats( balloon->world, balloon->entity, is_observed );
    status = status == WISP_OK ? accuracy_request_motion_stats( balloon, is_observed, error )
                               : bench_world_fail( balloon->world, status, error );
    for ( int step = 1; step <= steps && status == WISP_OK && balloon->halted_at == 0; ++step )
    {
        wisp_balloon_stats seen = { 0 };
        status = accuracy_step_surface( balloon, 1, out, error );
        status = status == WISP_OK && is_observed ? balloon_implementation_read( balloon, &seen, error ) : status;
        if ( status == WISP_OK && is_observed )
        {
            watch_gas( &seen, step, watch );
        }
    }
    return status == WISP_OK ? accuracy_end_surface( balloon, out, error ) : status;
}

static void measure( const full_sphere* body, const wisp_motion_stats* seen, const gas_watch* watch,
                     accuracy_run* out )
{
    const double* p = seen->momentum;
    const double speed = sqrt( p[0] * p[0] + p[1] * p[1] + p[2] * p[2] ) / seen->mass;
    const double exact = theory_of( body, seen->mass, 1.0 ).speed;
    const double half = theory_of( body, seen->mass, 0.5 * ( 1.0 + FILL ) ).seconds;
    out->measures[0] = speed;
    out->measures[1] = exact;
    out->measures[2] = 100.0 * ( watch->half / half - 1.0 );
    out->measures[3] = 100.0 * ( watch->fill - 1.0 ) / ( FILL - 1.0 );
    out->error = 100.0 * fabs( speed / exact - 1.0 );
}

// A tenth longer than theory needs to empty it.
static wisp_status run_jet( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                            wisp_error* error )
{
    const full_way* w = (const full_way*)validate_own( context ) + setting;
    full_sphere body;
    surface_implementation balloon = { 0 };
    wisp_motion_stats seen = { 0 };
    gas_watch watch = { .fill = FILL, .half = NAN };
    wisp_status status = make_body( w, workers, &body, error );
    if ( status == WISP_OK )
    {
        body.setting.def.outlet[0] = balloon_mesh_extreme( &body.mesh, ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f } );
        const int steps = (int)ceil( 1.1 * theory_of( &body, 1.0, 1.0 ).seconds / (double)ACCURACY_FRAME );
        status = balloon_implementation_create( body.fabric, &body.setting, &balloon, error );
        status = status == WISP_OK ? fly( &balloon, steps, is_observed, &watch, out, error ) : status;
    }
    if ( status == WISP_OK && is_observed && out->halted_at == 0 )
    {
        status = accuracy_read_motion_stats( &balloon, &seen, error );
        measure( &body, &seen, &watch, out );
    }
    surface_implementation_destroy( &balloon );
    full_sphere_free( &body );
    return status;
}

// ---- settings ----

static void put_jets( accuracy_scene* out )
{
    static const int substeps[] = { 5, 10, 20, 40, 80, 0 };
    static const double outlets[] = { 2.0, 0.5, 0.25 };
    const char* what = "virial pressure";
    const full_way usual = { .substeps = USUAL_SUBSTEPS,
                             .fill = FILL,
                             .outlet = OUTLET_AREA,
                             .skin = WISP_SOLVER_XPBD,
                             .volume = WISP_SOLVER_XPBD };
    full_way w = usual;
    full_way_put_substeps( out, w, what, substeps );
    w.volume = WISP_SOLVER_PBD;
    full_way_put_substeps( out, w, what, substeps );
    w.skin = WISP_SOLVER_PBD;
    full_way_put_substeps( out, w, what, substeps );
    w = usual;
    w.substeps = FINE_SUBSTEPS;
    full_way_put_levels( out, w, what, 1, 3 );
    w = usual;
    for ( int i = 0; i < WISP_COUNT( outlets ); ++i )
    {
        w.outlet = outlets[i] * OUTLET_AREA;
        full_way_put( out, w, what, "outlet", "outlet, m2", w.outlet );
    }
    // 5 s, 8 m and 48 000 substeps: more than floats can do
    w.outlet = OUTLET_AREA / 16.0;
    w.substeps = 4 * USUAL_SUBSTEPS;
    full_way_put( out, w, what, "", "", NAN );
}

const validate_case validate_jet = {
    .name = "jet",
    .title = "a balloon empties through an outlet: the speed it gets",
    .scene = { .reference = "rho / m times the integral of Bernoulli's speed over the gas that leaves, at the "
                            "balance of the mesh",
               .note = "level 0 is an icosahedron, whose balance is exact. The engine shuts an outlet at 1e-4 of the "
                       "atmosphere, and its gas has a constant compliance: that takes 0.02 and 0.13 % of the speed. "
                       "At 10 mm2 "
                       "and 160 substeps the rounding of floats is larger than what the jet adds in a substep.",
               .error_name = "speed against theory",
               .error_unit = "%",
               .measure_names = { "speed m/s", "theory m/s", "time of half the gas, error %", "gas left %" },
               .measure_count = 4,
               .run = run_jet },
    .own_size = VALIDATE_MAX_SETTINGS * sizeof( full_way ),
    .put = put_jets,
};
