// Balloons of helium with loads from a little below what they lift to a little above: which of them rise.
#include "validate_balloons.h"

#include "validate_helium.h"
#include "validate_world.h"

#include <math.h>

enum
{
    MAX_SETTINGS = 48,
    LADDER = 31,
    USUAL_SUBSTEPS = 20,
    STEPS = 60,
};

#define FILL 1.2                  // V_0 / V_rest
#define SLACK_FILL 1.0            // without pressure
#define DAMPING 10.0f             // 1/s
static const double RUNG = 0.002; // half of the distance between two loads, in that of the mesh: from 0.94 to 1.06

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
    status = status == WISP_OK ? wisp_set_damping( w->world, balloon, DAMPING ) : status;
    status = status == WISP_OK ? wisp_set_balloon( w->world, balloon, &setting->def ) : status;
    return status == WISP_OK ? validate_world_add( w, balloon, WISP_SURFACE_POINTS, body->mesh.vertex_count )
                             : status;
}

// Balloons in one world, each with its load in its skin.
static wisp_status create( const validate_helium_body* body, const balloon_setting* setting, validate_world* out,
                           wisp_error* error )
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
static wisp_status measure( validate_world* w, const validate_helium_sphere* sphere, const validate_helium_body* body,
                            accuracy_run* out, wisp_error* error )
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

static wisp_status run( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    const validate_helium_way* way = (const validate_helium_way*)context + setting;
    balloon_setting balloon = validate_helium_setting( way, workers );
    balloon.def.drag_coefficient = 0.0f;
    const validate_helium_sphere sphere = validate_helium_theory( &balloon );
    validate_helium_body body;
    validate_world world = { .world = NULL };
    wisp_status status = validate_helium_make( way, &body, error );
    status = status == WISP_OK ? create( &body, &balloon, &world, error ) : status;
    status = status == WISP_OK ? validate_world_step( &world, STEPS, out, error ) : status;
    status = status == WISP_OK ? validate_world_finish( &world, out, error ) : status;
    status = status == WISP_OK && is_observed && out->halted_at == 0 ? measure( &world, &sphere, &body, out, error )
                                                                     : status;
    validate_world_release( &world );
    validate_helium_free( &body );
    return status;
}

// ---- settings ----

static void put( accuracy_scene* out, validate_helium_way way, const char* by, const char* parameter_name,
                 double parameter )
{
    char method[48], series[96];
    validate_helium_name( &way, method, sizeof method );
    snprintf( series, sizeof series, "%s, fill %g, by %s", method, way.fill, by );
    ( (validate_helium_way*)out->context )[out->setting_count] = way;
    accuracy_setting* setting =
        accuracy_put_setting( out, "%s, fill %g, level %d, %d substeps", method, way.fill, way.level, way.substeps );
    accuracy_join_series( setting, series, parameter_name, parameter, NAN );
}

static void put_levels( accuracy_scene* out, validate_helium_way way )
{
    for ( int level = 0; level <= 3; ++level )
    {
        way.level = level;
        put( out, way, "mesh", "edge / R", validate_sphere_edge( level ) );
    }
}

// A mesh of few vertices: the heavier they are, the sooner the gas is in balance.
static void put_substeps( accuracy_scene* out, validate_helium_way way )
{
    static const int substeps[] = { 5, 80, 320 };
    way.level = 1;
    for ( int i = 0; i < WISP_COUNT( substeps ); ++i )
    {
        way.substeps = substeps[i];
        put( out, way, "substeps", "substep, s", (double)ACCURACY_FRAME / substeps[i] );
    }
}

static void put_settings( accuracy_scene* out )
{
    validate_helium_way way = {
        .substeps = USUAL_SUBSTEPS, .fill = FILL, .skin = WISP_SOLVER_XPBD, .volume = WISP_SOLVER_XPBD
    };
    put_levels( out, way );
    put_substeps( out, way );
    way.fill = SLACK_FILL;
    put_levels( out, way );
    way.fill = FILL;
    way.volume = WISP_SOLVER_PBD;
    put_levels( out, way );
    way.skin = WISP_SOLVER_PBD;
    put_levels( out, way );
}

wisp_status validate_lift_off( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)options;
    (void)seconds;
    *out = ( accuracy_scene ){
        .reference = "the weight of the air that the mesh displaces in balance, less that of its helium",
        .uncertainty = 100.0 * RUNG,
        .note =
            "a mesh has less volume than a sphere: `against the sphere` has that too. The engine's helium has the "
            "density that it would have at the pressure of the atmosphere, which lifts 0.4 % too much at fill 1.2. "
            "Fill 1 has no pressure: compare its settings among themselves.",
        .error_name = "load against theory",
        .error_unit = "%",
        .measure_names = { "load g", "theory g", "against the sphere %" },
        .measure_count = 3,
        .run = run,
    };
    const wisp_status status =
        accuracy_begin_scene( out, MAX_SETTINGS * sizeof( validate_helium_way ), MAX_SETTINGS, error );
    if ( status == WISP_OK )
    {
        put_settings( out );
    }
    return status;
}
