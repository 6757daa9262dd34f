// Balloons of helium.
#include "validate/validate.h"

#include "validate/validate_balloons.h"
#include "validate/validate_bodies.h"

#include "oracle/balloon_oracle.h"
#include "oracle/balloon_meshes.h"

#include <math.h>
#include <stdlib.h>

// ---- spheres of helium ----

#define VALIDATE_HELIUM_GRAVITY 9.81 // m/s^2

enum
{
    HELIUM_LEVELS = 4,
    HELIUM_SUBSTEPS = 3,
};

typedef struct validate_helium_way
{
    int level, substeps;      // of the icosphere; of 1/60 s
    double fill;              // V_0 / V_rest
    wisp_solver skin, volume; // what solves them
} validate_helium_way;

// A smooth sphere of the same skin, filled with an ideal gas: p V = n R T.
typedef struct validate_helium_sphere
{
    double scale, radius; // of the full sphere in the one at rest; m
    double air, helium;   // kg/m^3, at the pressure of the atmosphere
    double
        lift; // kg that it can carry, its skin included (Archimedes). The gas weighs what it did before it was squeezed
} validate_helium_sphere;

typedef struct validate_helium_body
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    wisp_vec3* points; // full, in balance
    double area;       // m^2, at rest
    double lift;       // kg that the mesh can carry, as validate_helium_sphere.lift
} validate_helium_body;

// A default balloon in air at rest.
static balloon_setting validate_helium_setting( const validate_helium_way* way, int workers )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.gas_ratio = (float)way->fill;
    setting.def.solver = way->skin;
    setting.def.volume = way->volume;
    setting.gravity = ( wisp_vec3 ){ 0.0f, (float)-VALIDATE_HELIUM_GRAVITY, 0.0f };
    setting.substeps = way->substeps;
    setting.iterations = 1;
    setting.workers = workers;
    setting.seconds = ACCURACY_FRAME;
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

// @param out to be freed, also after a failure
static wisp_status validate_helium_make( const validate_helium_way* way, validate_helium_body* out,
                                         wisp_error* error )
{
    const balloon_setting setting = validate_helium_setting( way, 1 );
    const validate_helium_sphere sphere = validate_helium_theory( &setting );
    *out = ( validate_helium_body ){ .fabric = NULL };
    wisp_status status = balloon_mesh_sphere( way->level, BALLOON_RADIUS, &out->mesh, error );
    status = status == WISP_OK ? balloon_cook( &out->mesh, &setting, &out->fabric, error ) : status;
    if ( status == WISP_OK )
    {
        const balloon_equilibrium full = balloon_equilibrium_of( out->fabric, &setting.def, false );
        for ( int i = 0; i < out->fabric->slot_count; ++i )
        {
            out->area += (double)out->fabric->area[i];
        }
        out->lift = lift_of( &sphere, full.volume, full.scale, (double)setting.def.gas_ratio );
        out->points = balloon_scaled_points( &out->mesh, full.scale );
        status = out->points != NULL ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a full balloon" );
    }
    return status;
}

static void validate_helium_free( validate_helium_body* body )
{
    wisp_fabric_release( body->fabric );
    wisp_mesh_release( &body->mesh );
    free( body->points );
    *body = ( validate_helium_body ){ .fabric = NULL };
}

// A setting: "xpbd skin, pbd gas, fill 1.2, level 3, 20 substeps". @param what of the scene, such as "fill 1.2"
static void put_helium( accuracy_scene* out, const validate_helium_way* way, const char* what, const char* by,
                        const char* parameter_name, double parameter )
{
    char method[64], series[96];
    snprintf( method, sizeof method, "%s skin, %s gas, %s", way->skin == WISP_SOLVER_XPBD ? "xpbd" : "pbd",
              way->volume == WISP_SOLVER_XPBD ? "xpbd" : "pbd", what );
    snprintf( series, sizeof series, "%s, by %s", method, by );
    ( (validate_helium_way*)validate_own( out->context ) )[out->setting_count] = *way;
    accuracy_setting* setting =
        accuracy_put_setting( out, "%s, level %d, %d substeps", method, way->level, way->substeps );
    accuracy_join_series( setting, series, parameter_name, parameter, NAN );
}

static void put_helium_levels( accuracy_scene* out, validate_helium_way way, const char* what, int first )
{
    for ( way.level = first; way.level < first + HELIUM_LEVELS; ++way.level )
    {
        put_helium( out, &way, what, "mesh", "edge / R", validate_sphere_edge( way.level ) );
    }
}

// @param way with its level
static void put_helium_substeps( accuracy_scene* out, validate_helium_way way, const char* what,
                                 const int substeps[HELIUM_SUBSTEPS] )
{
    for ( int i = 0; i < HELIUM_SUBSTEPS; ++i )
    {
        way.substeps = substeps[i];
        put_helium( out, &way, what, "substeps", "substep, s", (double)ACCURACY_FRAME / substeps[i] );
    }
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

static wisp_status add_balloon( validate_world* w, const validate_helium_body* body, const balloon_setting* setting,
                                double mass )
{
    wisp_entity balloon;
    wisp_surface_def def = wisp_default_surface_def();
    def.fabric = body->fabric;
    def.points = body->points;
    def.area_density = (float)( mass / body->area );
    def.gravity = setting->gravity;
    wisp_status status = wisp_add_surface( w->world, &def, &balloon );
    status = status == WISP_OK ? wisp_set_damping( w->world, balloon, LIFT_DAMPING ) : status;
    status = status == WISP_OK ? wisp_set_balloon( w->world, balloon, &setting->def ) : status;
    return status == WISP_OK ? validate_world_add( w, balloon, WISP_SURFACE_POINTS, body->mesh.vertex_count )
                             : status;
}

// Balloons in one world, each with its load in its skin.
static wisp_status create_ladder( const validate_helium_body* body, const balloon_setting* setting,
                                  validate_world* out, wisp_error* error )
{
    const wisp_module* const modules[] = { &wisp_balloon_module };
    const bench_world_def def = { modules, 1, setting->workers, setting->substeps, setting->iterations };
    wisp_status status = validate_world_create( &def, out, error );
    for ( int i = 0; i < LADDER && status == WISP_OK; ++i )
    {
        const double mass = body->lift * ( 1.0 + 2.0 * RUNG * ( i - LADDER / 2 ) );
        status = add_balloon( out, body, setting, mass );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( out->world, status, error );
        status = status == WISP_OK ? validate_world_watch( out, i, error ) : status;
    }
    return status;
}

// Damping takes the start away, so a balloon moves the way the force on it points. What it lifts is between the heaviest load that rises
// and the next one.
static wisp_status measure_lift( validate_world* w, const validate_helium_sphere* sphere,
                                 const validate_helium_body* body, accuracy_run* out, wisp_error* error )
{
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
        out->measures[1] = 1e3 * body->lift;
        out->measures[2] = is_found ? 100.0 * ( found / sphere->lift - 1.0 ) : NAN;
        out->error = 100.0 * fabs( found / body->lift - 1.0 );
    }
    return status;
}

static wisp_status run_lift( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                             wisp_error* error )
{
    const validate_helium_way* way = (const validate_helium_way*)validate_own( context ) + setting;
    balloon_setting balloon = validate_helium_setting( way, workers );
    balloon.def.drag_coefficient = 0.0f;
    const validate_helium_sphere sphere = validate_helium_theory( &balloon );
    validate_helium_body body;
    validate_world world = { .is_observed = true, .run = out };
    wisp_status status = validate_helium_make( way, &body, error );
    status = status == WISP_OK ? create_ladder( &body, &balloon, &world, error ) : status;
    status = status == WISP_OK ? validate_world_step( &world, LIFT_STEPS, error ) : status;
    status = status == WISP_OK ? validate_world_finish( &world, error ) : status;
    status = status == WISP_OK && is_observed && out->halted_at == 0
                 ? measure_lift( &world, &sphere, &body, out, error )
                 : status;
    validate_world_release( &world );
    validate_helium_free( &body );
    return status;
}

// ---- settings ----

static void put_lifts( accuracy_scene* out )
{
    // a mesh of few vertices: the heavier they are, the sooner the gas is in balance
    static const int substeps[HELIUM_SUBSTEPS] = { 5, 80, 320 };
    validate_helium_way way = {
        .level = 1, .substeps = LIFT_SUBSTEPS, .fill = LIFT_FILL, .skin = WISP_SOLVER_XPBD, .volume = WISP_SOLVER_XPBD
    };
    put_helium_levels( out, way, "fill 1.2", 0 );
    put_helium_substeps( out, way, "fill 1.2", substeps );
    way.fill = SLACK_FILL;
    put_helium_levels( out, way, "fill 1", 0 );
    way.fill = LIFT_FILL;
    way.volume = WISP_SOLVER_PBD;
    put_helium_levels( out, way, "fill 1.2", 0 );
    way.skin = WISP_SOLVER_PBD;
    put_helium_levels( out, way, "fill 1.2", 0 );
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
    .own_size = VALIDATE_MAX_SETTINGS * sizeof( validate_helium_way ),
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
    const validate_helium_way* way = (const validate_helium_way*)validate_own( context ) + setting;
    balloon_setting balloon = validate_helium_setting( way, workers );
    // that of the smooth sphere, so that meshes differ in their shape alone
    const double mass = RISE_LOAD * validate_helium_theory( &balloon ).lift;
    validate_helium_body body;
    surface_implementation flying = { 0 };
    wisp_motion_stats seen = { 0 };
    wisp_status status = validate_helium_make( way, &body, error );
    if ( status == WISP_OK )
    {
        balloon.points = body.points;
        balloon.area_density = (float)( mass / body.area );
        status = balloon_implementation_create( body.fabric, &balloon, &flying, error );
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
    validate_helium_free( &body );
    return status;
}

// ---- settings ----

static void put_rises( accuracy_scene* out )
{
    static const int substeps[HELIUM_SUBSTEPS] = { 5, 10, 40 };
    validate_helium_way way = { .level = RISE_LEVEL,
                                .substeps = RISE_SUBSTEPS,
                                .fill = RISE_FILL,
                                .skin = WISP_SOLVER_XPBD,
                                .volume = WISP_SOLVER_XPBD };
    put_helium_levels( out, way, "drag max", 1 );
    put_helium_substeps( out, way, "drag max", substeps );
    way.volume = WISP_SOLVER_PBD;
    put_helium_substeps( out, way, "drag max", substeps );
    way.skin = WISP_SOLVER_PBD;
    put_helium_substeps( out, way, "drag max", substeps );
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
    .own_size = VALIDATE_MAX_SETTINGS * sizeof( validate_helium_way ),
    .put = put_rises,
};
