// Full balloons, and those of helium: what they lift, and how fast they rise.
#include "validate/validate.h"

#include "validate/validate_balloons.h"
#include "validate/validate_bodies.h"

#include "oracle/balloon_oracle.h"
#include "oracle/balloon_meshes.h"

#include <math.h>
#include <stdlib.h>

// ---- full spheres ----

static void set_way( const full_way* way, int workers, balloon_setting* setting )
{
    setting->def.gas_ratio = (float)way->fill;
    setting->def.solver = way->skin;
    setting->def.volume = way->volume;
    setting->substeps = way->substeps;
    setting->iterations = 1;
    setting->workers = workers;
    setting->seconds = ACCURACY_FRAME;
}

wisp_status full_sphere_make( const full_way* way, balloon_setting setting, int workers, full_sphere* out,
                              wisp_error* error )
{
    set_way( way, workers, &setting );
    *out = ( full_sphere ){ .setting = setting };
    WISP_TRY( balloon_mesh_sphere( way->level, BALLOON_RADIUS, &out->mesh, error ) );
    WISP_TRY( balloon_cook( &out->mesh, &setting, &out->fabric, error ) );
    out->balance = balloon_equilibrium_of( out->fabric, &setting.def, false );
    for ( int i = 0; i < out->fabric->slot_count; ++i )
    {
        out->area += (double)out->fabric->area[i];
    }
    out->points = balloon_scaled_points( &out->mesh, out->balance.scale );
    out->setting.points = out->points;
    return out->points != NULL ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a full balloon" );
}

void full_sphere_free( full_sphere* sphere )
{
    wisp_fabric_release( sphere->fabric );
    wisp_mesh_release( &sphere->mesh );
    free( sphere->points );
}

void full_way_put( accuracy_scene* out, full_way way, const char* what, const char* by, const char* parameter_name,
                   double parameter )
{
    char method[64], series[96], outlet[32] = "";
    snprintf( method, sizeof method, "%s skin, %s gas, %s", way.skin == WISP_SOLVER_XPBD ? "xpbd" : "pbd",
              way.volume == WISP_SOLVER_XPBD ? "xpbd" : "pbd", what );
    snprintf( series, sizeof series, "%s, by %s", method, by );
    if ( way.outlet > 0.0 )
    {
        snprintf( outlet, sizeof outlet, ", %g mm2", 1e6 * way.outlet );
    }
    ( (full_way*)validate_own( out->context ) )[out->setting_count] = way;
    accuracy_setting* setting =
        accuracy_put_setting( out, "%s, level %d, %d substeps%s", method, way.level, way.substeps, outlet );
    accuracy_join_series( setting, by[0] != '\0' ? series : "", parameter_name, parameter, NAN );
}

void full_way_put_levels( accuracy_scene* out, full_way way, const char* what, int first, int count )
{
    for ( way.level = first; way.level < first + count; ++way.level )
    {
        full_way_put( out, way, what, "mesh", "edge / R", validate_sphere_edge( way.level ) );
    }
}

void full_way_put_substeps( accuracy_scene* out, full_way way, const char* what, const int* substeps )
{
    for ( ; *substeps > 0; ++substeps )
    {
        way.substeps = *substeps;
        full_way_put( out, way, what, "substeps", "substep, s", (double)ACCURACY_FRAME / *substeps );
    }
}

// ---- spheres of helium ----

#define VALIDATE_HELIUM_GRAVITY 9.81 // m/s^2

enum
{
    HELIUM_LEVELS = 4,
};

// A smooth sphere of the same skin, filled with an ideal gas: p V = n R T.
typedef struct validate_helium_sphere
{
    double scale, radius; // of the full sphere in the one at rest; m
    double air, helium;   // kg/m^3, at the pressure of the atmosphere
    double
        lift; // kg that it can carry, its skin included (Archimedes). The gas weighs what it did before it was squeezed
} validate_helium_sphere;

// A default balloon in air at rest.
static balloon_setting validate_helium_setting( const full_way* way, int workers )
{
    balloon_setting setting = balloon_default_setting();
    setting.gravity = ( wisp_vec3 ){ 0.0f, (float)-VALIDATE_HELIUM_GRAVITY, 0.0f };
    set_way( way, workers, &setting );
    return setting;
}

// Weight of the air displaced, without that of the gas.
static double lift_of( const validate_helium_sphere* sphere, double rest_volume, double scale, double fill )
{
    return rest_volume * ( sphere->air * scale * scale * scale - sphere->helium * fill );
}

static validate_helium_sphere validate_helium_theory( const balloon_setting* setting )
{
    const wisp_balloon_def* def = &setting->def;
    const double atmosphere = (double)def->atmospheric_pressure, kelvin = (double)def->temperature;
    const balloon_theory_sphere skin = { .radius = (double)BALLOON_RADIUS,
                                         .edge_stiffness = (double)def->edge_stiffness,
                                         .bend_link_stiffness = (double)def->bend_link_stiffness,
                                         .atmosphere = atmosphere,
                                         .gas_ratio = (double)def->gas_ratio };
    validate_helium_sphere sphere = {
        .scale = balloon_theory_sphere_scale( &skin ),
        .air = balloon_oracle_density( atmosphere, (double)def->air_molar_mass, kelvin ),
        .helium = balloon_oracle_density( atmosphere, (double)def->gas_molar_mass, kelvin ),
    };
    sphere.radius = sphere.scale * skin.radius;
    sphere.lift = lift_of( &sphere, 4.0 / 3.0 * VALIDATE_PI * pow( skin.radius, 3.0 ), sphere.scale, skin.gas_ratio );
    return sphere;
}

// kg that the mesh of a full sphere can carry, as validate_helium_sphere.lift.
static double lift_of_mesh( const full_sphere* full )
{
    const validate_helium_sphere smooth = validate_helium_theory( &full->setting );
    return lift_of( &smooth, full->balance.volume, full->balance.scale, (double)full->setting.def.gas_ratio );
}

// ---- lift ----

// Balloons of helium with loads from a little below what they lift to a little above: which of them rise.

enum
{
    LADDER = 31,
    LIFT_SUBSTEPS = 20,
    LIFT_STEPS = 60,
};

#define LIFT_FILL 1.2      // V_0 / V_rest
#define SLACK_FILL 1.0     // without pressure
#define LIFT_DAMPING 10.0f // 1/s
#define RUNG 0.002         // half of the distance between two loads, in that of the mesh: from 0.94 to 1.06

// ---- a ladder ----

static wisp_status add_balloon( validate_world* w, const full_sphere* full, double mass )
{
    wisp_entity balloon;
    wisp_surface_def def = wisp_default_surface_def();
    def.fabric = full->fabric;
    def.points = full->points;
    def.area_density = (float)( mass / full->area );
    def.gravity = full->setting.gravity;
    wisp_status status = wisp_add_surface( w->world, &def, &balloon );
    status = status == WISP_OK ? wisp_set_damping( w->world, balloon, LIFT_DAMPING ) : status;
    status = status == WISP_OK ? wisp_set_balloon( w->world, balloon, &full->setting.def ) : status;
    return status == WISP_OK ? validate_world_add( w, balloon, WISP_SURFACE_POINTS, full->mesh.vertex_count )
                             : status;
}

// Balloons in one world, each with its load in its skin.
static wisp_status create_ladder( const full_sphere* full, validate_world* out, wisp_error* error )
{
    const wisp_module* const modules[] = { &wisp_balloon_module };
    const bench_world_def def = { modules, 1, full->setting.workers, full->setting.substeps,
                                  full->setting.iterations };
    WISP_TRY( validate_world_create( &def, out, error ) );
    for ( int i = 0; i < LADDER; ++i )
    {
        const double mass = lift_of_mesh( full ) * ( 1.0 + 2.0 * RUNG * ( i - LADDER / 2 ) );
        const wisp_status status = add_balloon( out, full, mass );
        WISP_TRY( status == WISP_OK ? WISP_OK : bench_world_fail( out->world, status, error ) );
        WISP_TRY( validate_world_watch( out, i, error ) );
    }
    return WISP_OK;
}

// Damping takes the start away, so a balloon moves the way the force on it points. What it lifts is between the heaviest load that rises
// and the next one.
static wisp_status measure_lift( validate_world* w, const full_sphere* full, wisp_error* error )
{
    accuracy_run* out = w->run;
    const double exact = lift_of_mesh( full ), smooth = validate_helium_theory( &full->setting ).lift;
    double masses[LADDER];
    int sinks = LADDER; // the first one
    wisp_status status = WISP_OK;
    for ( int i = 0; i < LADDER && status == WISP_OK; ++i )
    {
        wisp_motion_stats seen = { 0 };
        status = validate_world_motion( w, i, &seen, error );
        masses[i] = seen.mass;
        sinks = sinks == LADDER && seen.momentum[1] <= 0.0 ? i : sinks;
    }
    if ( status == WISP_OK )
    {
        const bool is_found = sinks > 0 && sinks < LADDER;
        // beyond the ladder the error is at least that of its end
        const double found =
            is_found ? 0.5 * ( masses[sinks - 1] + masses[sinks] ) : masses[sinks > 0 ? LADDER - 1 : 0];
        out->measures[0] = is_found ? 1e3 * found : NAN;
        out->measures[1] = 1e3 * exact;
        out->measures[2] = is_found ? 100.0 * ( found / smooth - 1.0 ) : NAN;
        out->error = 100.0 * fabs( found / exact - 1.0 );
    }
    return status;
}

static wisp_status run_lift( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                             wisp_error* error )
{
    const full_way* way = (const full_way*)validate_own( context ) + setting;
    balloon_setting balloon = validate_helium_setting( way, workers );
    balloon.def.drag_coefficient = 0.0f;
    full_sphere full;
    validate_world world = { .is_observed = true, .run = out };
    wisp_status status = full_sphere_make( way, balloon, workers, &full, error );
    status = status == WISP_OK ? create_ladder( &full, &world, error ) : status;
    status = status == WISP_OK ? validate_world_step( &world, LIFT_STEPS, error ) : status;
    status = status == WISP_OK ? validate_world_finish( &world, error ) : status;
    status = status == WISP_OK && is_observed && out->halted_at == 0 ? measure_lift( &world, &full, error ) : status;
    validate_world_release( &world );
    full_sphere_free( &full );
    return status;
}

// ---- settings ----

static void put_lifts( accuracy_scene* out )
{
    // a mesh of few vertices: the heavier they are, the sooner the gas is in balance
    static const int substeps[] = { 5, 80, 320, 0 };
    full_way way = {
        .level = 1, .substeps = LIFT_SUBSTEPS, .fill = LIFT_FILL, .skin = WISP_SOLVER_XPBD, .volume = WISP_SOLVER_XPBD
    };
    full_way_put_levels( out, way, "fill 1.2", 0, HELIUM_LEVELS );
    full_way_put_substeps( out, way, "fill 1.2", substeps );
    way.fill = SLACK_FILL;
    full_way_put_levels( out, way, "fill 1", 0, HELIUM_LEVELS );
    way.fill = LIFT_FILL;
    way.volume = WISP_SOLVER_PBD;
    full_way_put_levels( out, way, "fill 1.2", 0, HELIUM_LEVELS );
    way.skin = WISP_SOLVER_PBD;
    full_way_put_levels( out, way, "fill 1.2", 0, HELIUM_LEVELS );
}

const validate_case validate_lift_off = {
    .name = "lift_off",
    .title = "helium balloons lift what the air they displace weighs",
    .scene = { .reference = "the weight of the air that the mesh displaces in balance, less that of its helium",
               .uncertainty = 100.0 * RUNG,
               .note = "a mesh has less volume than a sphere: `against the sphere` has that too. The engine's helium "
                       "has the "
                       "density that it would have at the pressure of the atmosphere, which lifts 0.4 % too much at "
                       "fill 1.2. "
                       "Fill 1 has no pressure: compare its settings among themselves.",
               .error_name = "load against theory",
               .error_unit = "%",
               .measure_names = { "load g", "theory g", "against the sphere %" },
               .measure_count = 3,
               .run = run_lift },
    .own_size = VALIDATE_MAX_SETTINGS * sizeof( full_way ),
    .put = put_lifts,
};

// ---- the speed of ascent ----

// A balloon of helium rises until the drag of the air holds its lift: the speed of ascent.

enum
{
    RISE_LEVEL = 3, // 642 vertices
    RISE_SUBSTEPS = 20,
    RISE_STEPS = 180, // 3 s, more than ten times what it needs to reach two thirds of the speed
};

#define RISE_FILL 1.05                  // V_0 / V_rest: under pressure, so it stays round
#define RISE_LOAD 0.6                   // mass, in what it lifts
static const double VISCOSITY = 1.5e-5; // m^2/s, of air at 20 degrees, for Reynolds' number
static const double SPHERE_DRAG = 0.47; // measured of spheres at Reynolds' numbers of 1e3 to 1e5 (Hoerner 1965)

// ---- a run ----

static void measure_rise( const balloon_setting* setting, double mass, const wisp_motion_stats* seen,
                          accuracy_run* out )
{
    const validate_helium_sphere sphere = validate_helium_theory( setting );
    const double force = VALIDATE_HELIUM_GRAVITY * ( sphere.lift - mass );
    const double coefficient = (double)setting->def.drag_coefficient;
    const double exact = balloon_theory_terminal_speed( force, sphere.air, coefficient, sphere.radius );
    const double speed = seen->momentum[1] / seen->mass;
    out->measures[0] = speed;
    out->measures[1] = exact;
    out->measures[2] = coefficient;
    out->measures[3] = balloon_theory_terminal_speed( force, sphere.air, SPHERE_DRAG, sphere.radius );
    out->measures[4] = 2.0 * sphere.radius * speed / VISCOSITY;
    out->error = 100.0 * fabs( speed / exact - 1.0 );
}

static wisp_status run_rise( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                             wisp_error* error )
{
    const full_way* way = (const full_way*)validate_own( context ) + setting;
    const balloon_setting balloon = validate_helium_setting( way, workers );
    // that of the smooth sphere, so that meshes differ in their shape alone
    const double mass = RISE_LOAD * validate_helium_theory( &balloon ).lift;
    full_sphere full;
    surface_implementation flying = { 0 };
    wisp_motion_stats seen = { 0 };
    wisp_status status = full_sphere_make( way, balloon, workers, &full, error );
    if ( status == WISP_OK )
    {
        full.setting.area_density = (float)( mass / full.area );
        status = balloon_implementation_create( full.fabric, &full.setting, &flying, error );
    }
    if ( status == WISP_OK )
    {
        status = wisp_request_balloon_stats( flying.world, flying.entity, false );
        status = status == WISP_OK ? accuracy_request_motion_stats( &flying, is_observed, error )
                                   : bench_world_fail( flying.world, status, error );
    }
    status = status == WISP_OK ? accuracy_step_surface( &flying, RISE_STEPS, out, error ) : status;
    status = status == WISP_OK ? accuracy_end_surface( &flying, out, error ) : status;
    if ( status == WISP_OK && is_observed && out->halted_at == 0 )
    {
        status = accuracy_read_motion_stats( &flying, &seen, error );
        measure_rise( &balloon, mass, &seen, out );
    }
    surface_implementation_destroy( &flying );
    full_sphere_free( &full );
    return status;
}

// ---- settings ----

static void put_rises( accuracy_scene* out )
{
    static const int substeps[] = { 5, 10, 40, 0 };
    full_way way = { .level = RISE_LEVEL,
                     .substeps = RISE_SUBSTEPS,
                     .fill = RISE_FILL,
                     .skin = WISP_SOLVER_XPBD,
                     .volume = WISP_SOLVER_XPBD };
    full_way_put_levels( out, way, "drag max", 1, HELIUM_LEVELS );
    full_way_put_substeps( out, way, "drag max", substeps );
    way.volume = WISP_SOLVER_PBD;
    full_way_put_substeps( out, way, "drag max", substeps );
    way.skin = WISP_SOLVER_PBD;
    full_way_put_substeps( out, way, "drag max", substeps );
}

const validate_case validate_rising_balloon = {
    .name = "rising_balloon",
    .title = "helium balloons rise at the speed at which drag holds their lift",
    .scene = { .reference = "1/2 rho C pi R^2 v^2 = lift - weight, for a smooth sphere",
               .note = "C is the coefficient of the scene, 0.5.",
               .error_name = "speed against theory",
               .error_unit = "%",
               .measure_names = { "speed m/s", "theory m/s", "C of the sphere", "m/s with C = 0.47", "Reynolds" },
               .measure_count = 5,
               .run = run_rise },
    .own_size = VALIDATE_MAX_SETTINGS * sizeof( full_way ),
    .put = put_rises,
};
