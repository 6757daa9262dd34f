// A balloon of helium rises until the drag of the air holds its lift: the speed of ascent.
#include "validate_balloons.h"

#include "oracle/balloon_theory.h"
#include "validate_helium.h"

#include <math.h>

enum
{
    MAX_SETTINGS = 48,
    USUAL_LEVEL = 3, // 642 vertices
    USUAL_SUBSTEPS = 20,
    STEPS = 180, // 3 s, more than ten times what it needs to reach two thirds of the speed
};

#define FILL 1.05                       // V_0 / V_rest: under pressure, so it stays round
#define LOAD 0.6                        // mass, in what it lifts
static const double VISCOSITY = 1.5e-5; // m^2/s, of air at 20 degrees, for Reynolds' number
static const double SPHERE_DRAG = 0.47; // measured of spheres at Reynolds' numbers of 1e3 to 1e5 (Hoerner 1965)

// ---- a run ----

static void measure( const validate_helium_way* way, const balloon_setting* setting, double mass,
                     const wisp_motion_stats* seen, accuracy_run* out )
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

static wisp_status run( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    const validate_helium_way* way = (const validate_helium_way*)context + setting;
    balloon_setting balloon = validate_helium_setting( way, workers );
    // that of the smooth sphere, so that meshes differ in their shape alone
    const double mass = LOAD * validate_helium_theory( &balloon ).lift;
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
    status = status == WISP_OK ? accuracy_step_surface( &flying, STEPS, out, error ) : status;
    status = status == WISP_OK ? accuracy_end_surface( &flying, out, error ) : status;
    if ( status == WISP_OK && is_observed && out->halted_at == 0 )
    {
        status = accuracy_read_motion_stats( &flying, &seen, error );
        measure( way, &balloon, mass, &seen, out );
    }
    surface_implementation_destroy( &flying );
    validate_helium_free( &body );
    return status;
}

// ---- settings ----

static void put( accuracy_scene* out, validate_helium_way way, const char* by, const char* parameter_name,
                 double parameter )
{
    char method[64], series[96];
    validate_helium_name( &way, method, sizeof method );
    snprintf( series, sizeof series, "%s, drag max, by %s", method, by );
    ( (validate_helium_way*)out->context )[out->setting_count] = way;
    accuracy_setting* setting =
        accuracy_put_setting( out, "%s, drag max, level %d, %d substeps", method, way.level, way.substeps );
    accuracy_join_series( setting, series, parameter_name, parameter, NAN );
}

static void put_levels( accuracy_scene* out, validate_helium_way way )
{
    for ( int level = 1; level <= 4; ++level )
    {
        way.level = level;
        put( out, way, "mesh", "edge / R", validate_sphere_edge( level ) );
    }
}

static void put_substeps( accuracy_scene* out, validate_helium_way way )
{
    static const int substeps[] = { 5, 10, 40 };
    way.level = USUAL_LEVEL;
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
    way.volume = WISP_SOLVER_PBD;
    put_substeps( out, way );
    way.skin = WISP_SOLVER_PBD;
    put_substeps( out, way );
}

wisp_status validate_rising_balloon( const bench_options* options, double seconds, accuracy_scene* out,
                                     wisp_error* error )
{
    (void)options;
    (void)seconds;
    *out = ( accuracy_scene ){
        .reference = "1/2 rho C pi R^2 v^2 = lift - weight, for a smooth sphere",
        .note = "C is the coefficient of the scene, 0.5.",
        .error_name = "speed against theory",
        .error_unit = "%",
        .measure_names = { "speed m/s", "theory m/s", "C of the sphere", "m/s with C = 0.47", "Reynolds" },
        .measure_count = 5,
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
