// The scene `balloon_flight`: a balloon without symmetry that is released.
#include "accuracy/scene_tools.h"

#include "oracle/balloon_oracle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A balloon without symmetry that is released, for the scene `balloon_flight`: the body, a flight of the engine, one of
// the oracle, and the distance between two flights.

#define FLIGHT_STEPS 20
#define FLIGHT_FILL 1.2f

// Positions of a balloon after every step.
typedef struct flight_path
{
    double centre[FLIGHT_STEPS + 1][3]; // m
    double speed, spin, volume;         // at the end: m/s, rad/s, m^3
    double impulse_missing;             // N s, between the momentum and the integral of the forces
    double impulse;                     // N s, largest change of momentum
} flight_path;

typedef struct flight_body
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    wisp_vec3* full; // [vertex_count] start of the flights: at rest and filled
    int outlet;      // vertex
} flight_body;

#define FLIGHT_MEASURES                                                                                              \
    {                                                                                                                \
        "speed m/s", "speed error %", "spin rad/s", "volume error %", "momentum not closed %"                        \
    }
#define FLIGHT_MEASURE_COUNT 5

// ---- flights of the engine ----

// Fills a balloon, brings it to rest and releases it.

enum
{
    LEVEL = 1, // 42 vertices
    FILL_STEPS = 60,
    FILL_SUBSTEPS = 640,
};

#define FILL_DAMPING 45.0f
// The outlet is so small that gas is left at the end of the flight; how the jet ends is not part of the scene.
#define OUTLET_AREA 1e-5f

static double length( const double a[3] )
{
    return sqrt( a[0] * a[0] + a[1] * a[1] + a[2] * a[2] );
}

// Root mean square over the steps, m.
static double flight_distance( const flight_path* a, const flight_path* b )
{
    double sum = 0.0;
    for ( int s = 1; s <= FLIGHT_STEPS; ++s )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const double d = a->centre[s][k] - b->centre[s][k];
            sum += d * d / FLIGHT_STEPS;
        }
    }
    return sqrt( sum );
}

// ---- bodies ----

// Fill it in short substeps and let it come to rest.
static wisp_status fill( flight_body* body, wisp_error* error )
{
    balloon_setting setting = balloon_setting_in_vacuum();
    setting.def.gas_ratio = FLIGHT_FILL;
    setting.damping = FILL_DAMPING;
    setting.substeps = FILL_SUBSTEPS;
    setting.iterations = 1;
    setting.seconds = ACCURACY_FRAME;
    surface_implementation implementation = { 0 };
    const wisp_vec3* points = NULL;
    wisp_status status = balloon_implementation_create( body->fabric, &setting, &implementation, error );
    for ( int s = 0; s < FILL_STEPS && status == WISP_OK; ++s )
    {
        status = surface_implementation_step( &implementation, error );
    }
    status = status == WISP_OK ? surface_implementation_points( &implementation, &points, error ) : status;
    if ( status == WISP_OK )
    {
        memcpy( body->full, points, (size_t)body->mesh.vertex_count * sizeof( wisp_vec3 ) );
    }
    surface_implementation_destroy( &implementation );
    return status;
}

// Make a balloon, fill it and let it come to rest.
// @param out to be given to flight_free_body() even after a failure
static wisp_status flight_make_body( flight_body* out, wisp_error* error )
{
    const balloon_setting setting = balloon_default_setting();
    *out = ( flight_body ){ .fabric = NULL };
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PEAR );
    generator.radius = BALLOON_RADIUS;
    generator.level = LEVEL;
    wisp_status status = wisp_mesh_generate( &generator, &out->mesh, error );
    status = status == WISP_OK ? balloon_cook( &out->mesh, &setting, &out->fabric, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    // next to the centre, so that the jet turns the body
    out->outlet = balloon_mesh_extreme( &out->mesh, ( wisp_vec3 ){ 1.0f, 0.5f, 0.2f } );
    out->full = malloc( (size_t)out->mesh.vertex_count * sizeof( wisp_vec3 ) );
    return out->full ? fill( out, error ) : wisp_fail( error, WISP_NO_MEMORY, "no memory for a full balloon" );
}

static void flight_free_body( flight_body* body )
{
    wisp_fabric_release( body->fabric );
    wisp_mesh_release( &body->mesh );
    free( body->full );
    *body = ( flight_body ){ .fabric = NULL };
}

// ---- a flight ----

// Settings of a flight: in air, with an open outlet next to the centre.
static balloon_setting flight_setting( int substeps, int iterations )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.gas_ratio = FLIGHT_FILL;
    setting.def.outlet_count = 1;
    setting.def.outlet_area = OUTLET_AREA;
    setting.def.outlet_open = true;
    setting.substeps = substeps;
    setting.iterations = iterations;
    setting.seconds = ACCURACY_FRAME;
    return setting;
}

// Forces are those of the last substep of each step, integrated by the trapezium rule; the first step uses only its
// own. The remainder is the error of that sum and momentum that the solver adds or removes.
static void close_momentum( const wisp_motion_stats* seen, const wisp_balloon_stats* forces, double before[3],
                            double sum[3], int step, flight_path* path )
{
    double missing[3], now[3];
    for ( int k = 0; k < 3; ++k )
    {
        now[k] = forces->gravity[k] + forces->buoyancy[k] + forces->drag[k] + forces->jet[k];
        sum[k] += (double)ACCURACY_FRAME * ( step == 1 ? now[k] : 0.5 * ( before[k] + now[k] ) );
        before[k] = now[k];
        missing[k] = seen->momentum[k] - sum[k];
    }
    path->impulse_missing = length( missing );
    path->impulse = fmax( path->impulse, length( seen->momentum ) );
}

static wisp_status observe_balloon( surface_implementation* implementation, int step, double before[3], double sum[3],
                                    flight_path* path, wisp_error* error )
{
    wisp_motion_stats seen = { 0 };
    wisp_balloon_stats forces = { 0 };
    wisp_status status = accuracy_read_motion_stats( implementation, &seen, error );
    status = status == WISP_OK ? balloon_implementation_read( implementation, &forces, error ) : status;
    if ( status == WISP_OK )
    {
        memcpy( path->centre[step], seen.centre, sizeof( seen.centre ) );
        path->speed = length( seen.momentum ) / seen.mass;
        path->spin = length( forces.angular_velocity );
        path->volume = seen.volume;
        close_momentum( &seen, &forces, before, sum, step, path );
    }
    return status;
}

// Release the balloon. @param path receives its positions; null: not sampled
static wisp_status flight_fly( const flight_body* body, balloon_setting setting, int workers, accuracy_run* out,
                               flight_path* path, wisp_error* error )
{
    setting.points = body->full;
    setting.def.outlet[0] = body->outlet;
    setting.workers = workers;
    surface_implementation implementation = { 0 };
    wisp_status status = balloon_implementation_create( body->fabric, &setting, &implementation, error );
    if ( status == WISP_OK )
    {
        status = wisp_request_balloon_stats( implementation.world, implementation.entity, path != NULL );
        status = status == WISP_OK ? accuracy_request_motion_stats( &implementation, path != NULL, error )
                                   : bench_world_fail( implementation.world, status, error );
    }
    double before[3] = { 0.0 }, sum[3] = { 0.0 };
    for ( int step = 1; step <= FLIGHT_STEPS && implementation.halted_at == 0 && status == WISP_OK; ++step )
    {
        status = accuracy_step_surface( &implementation, 1, out, error );
        if ( status == WISP_OK && path )
        {
            status = observe_balloon( &implementation, step, before, sum, path, error );
        }
    }
    status = status == WISP_OK ? accuracy_end_surface( &implementation, out, error ) : status;
    surface_implementation_destroy( &implementation );
    return status;
}

// ---- the distance to the reference ----

// Put the distance to the reference, in mm, and the measures below into a sampled run.
static void flight_judge( const flight_path* path, const flight_path* reference, accuracy_run* out )
{
    out->error = 1e3 * flight_distance( path, reference );
    out->measures[0] = path->speed;
    out->measures[1] = 100.0 * ( path->speed / reference->speed - 1.0 );
    out->measures[2] = path->spin;
    out->measures[3] = 100.0 * ( path->volume / reference->volume - 1.0 );
    out->measures[4] = 100.0 * path->impulse_missing / path->impulse;
}

// ---- flights of the oracle ----

// The flight of a released balloon by the oracle, which solves the same equations one by one in double precision.

static double3 widen( wisp_vec3 p )
{
    return double3_make( (double)p.x, (double)p.y, (double)p.z );
}

static void observe_oracle( const balloon_oracle* oracle, int step, flight_path* out )
{
    double3 momentum = { 0.0, 0.0, 0.0 }, centre = momentum;
    for ( int i = 0; i < oracle->vertex_count; ++i )
    {
        const double fraction = oracle->mass[i] / oracle->total_mass;
        centre = double3_add( centre, double3_scale( fraction, oracle->x[i] ) );
        momentum = double3_add( momentum, double3_scale( fraction, oracle->v[i] ) );
    }
    out->centre[step][0] = centre.x;
    out->centre[step][1] = centre.y;
    out->centre[step][2] = centre.z;
    out->speed = double3_length( momentum );
    out->spin = double3_length( oracle->omega );
    out->volume = balloon_oracle_present_volume( oracle );
}

static wisp_status make_oracle( const flight_body* body, int substeps, balloon_oracle* out, wisp_error* error )
{
    const int count = body->mesh.vertex_count;
    double3* points = calloc( (size_t)count, sizeof( double3 ) );
    if ( !points )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a balloon in double precision" );
    }
    for ( int i = 0; i < count; ++i )
    {
        points[i] = widen( body->mesh.points[i] );
    }
    const balloon_mesh mesh = { count, body->mesh.triangle_count, points, body->mesh.triangles };
    const balloon_setting setting = flight_setting( substeps, 1 );
    balloon_oracle_options options = balloon_oracle_default_options();
    options.dt = (double)ACCURACY_FRAME;
    options.substeps = setting.substeps;
    options.iterations = setting.iterations;
    options.outlet_area = (double)setting.def.outlet_area;
    options.outlet_open = true;
    const wisp_status status =
        balloon_oracle_create_from_mesh( &mesh, (double)setting.area_density, body->outlet, &options, out, error );
    free( points );
    if ( status == WISP_OK )
    {
        out->gas_volume = (double)setting.def.gas_ratio * out->rest_volume;
        for ( int i = 0; i < count; ++i )
        {
            out->x[i] = widen( body->full[i] );
        }
    }
    return status;
}

// The same flight in double precision, by the oracle, with one iteration of each substep.
static wisp_status flight_fly_oracle( const flight_body* body, int substeps, flight_path* path, wisp_error* error )
{
    balloon_oracle oracle;
    const wisp_status status = make_oracle( body, substeps, &oracle, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int step = 1; step <= FLIGHT_STEPS; ++step )
    {
        balloon_oracle_step( &oracle );
        observe_oracle( &oracle, step, path );
    }
    balloon_oracle_destroy( &oracle );
    return WISP_OK;
}

// ---- the scene ----

// A full balloon without symmetry is released: jet, spin, drag and buoyancy. The path of its centre is compared with
// a flight of the oracle, which solves the same equations in double precision. The engine cannot be the reference: the
// displacement by gravity in such a short substep is below the rounding of a float. Every flight starts from the same
// shape, a balloon at rest, filled at small substeps. A start out of balance would ring, for a time that depends only
// on the substep.

enum
{
    USUAL_SUBSTEPS = 10,
    ORDERLY_SUBSTEPS = 20,
    FINEST_SUBSTEPS = 160,
    REFERENCE_SUBSTEPS = 5120,
    SETTINGS_MAX = 40,
};

typedef struct flight_scene
{
    flight_body body;
    flight_path reference;
    balloon_setting settings[SETTINGS_MAX];
} flight_scene;

// ---- settings ----

static void add( accuracy_scene* scene, int substeps, int iterations, const char* name )
{
    flight_scene* own = scene->context;
    own->settings[scene->setting_count] = flight_setting( substeps, iterations );
    accuracy_put_setting( scene, "%s", name );
}

// Forces are evaluated at the beginning of a substep and velocities from the positions at its end: first order,
// provided that the skin relaxes within a substep. Coarser substeps are therefore outside the series.
static void add_substeps( accuracy_scene* scene )
{
    static const int substeps[] = { 5, USUAL_SUBSTEPS, 20, 40, 80, FINEST_SUBSTEPS };
    static const int iterations[] = { 1, 4 };
    for ( int k = 0; k < WISP_COUNT( iterations ); ++k )
    {
        for ( int i = 0; i < WISP_COUNT( substeps ); ++i )
        {
            char series[48], name[64];
            snprintf( series, sizeof( series ), "kick, max drag, n x %d", iterations[k] );
            snprintf( name, sizeof( name ), "kick, max drag, %d x %d", substeps[i], iterations[k] );
            add( scene, substeps[i], iterations[k], name );
            accuracy_setting* setting = &scene->settings[scene->setting_count - 1];
            snprintf( setting->method, sizeof( setting->method ), "%s", series );
            accuracy_join_series( setting, substeps[i] >= ORDERLY_SUBSTEPS ? series : "", "substep, s",
                                  (double)ACCURACY_FRAME / substeps[i], 1.0 );
        }
    }
}

// ---- runs ----

static wisp_status run( void* context, int index, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    const flight_scene* scene = context;
    flight_path path = { .speed = NAN };
    wisp_status status =
        flight_fly( &scene->body, scene->settings[index], workers, out, is_observed ? &path : NULL, error );
    if ( status == WISP_OK && is_observed && out->halted_at == 0 )
    {
        flight_judge( &path, &scene->reference, out );
    }
    return status;
}

// ---- the reference ----

static wisp_status make_reference( flight_scene* own, accuracy_scene* out, wisp_error* error )
{
    flight_path coarser = { .speed = NAN };
    wisp_status status = flight_fly_oracle( &own->body, REFERENCE_SUBSTEPS, &own->reference, error );
    status = status == WISP_OK ? flight_fly_oracle( &own->body, REFERENCE_SUBSTEPS / 2, &coarser, error ) : status;
    if ( status == WISP_OK )
    {
        snprintf( out->reference, sizeof( out->reference ), "the same flight in double precision, with %d substeps",
                  REFERENCE_SUBSTEPS );
        out->uncertainty = 1e3 * flight_distance( &coarser, &own->reference );
    }
    return status;
}

// ---- the scene ----

static void destroy( void* context )
{
    flight_scene* scene = context;
    flight_free_body( &scene->body );
    free( scene );
}

wisp_status accuracy_balloon_flight( const bench_options* options, double seconds, accuracy_scene* out,
                                     wisp_error* error )
{
    (void)options;
    (void)seconds; // it is fast
    *out = ( accuracy_scene ){
        .note = "other forms of drag, spin and pressure give other flights; their error is the difference of the "
                "model. Momentum closes up to forces evaluated once per step and float rounding.",
        .error_name = "distance of the centre's path",
        .error_unit = "mm",
        .measure_names = FLIGHT_MEASURES,
        .measure_count = FLIGHT_MEASURE_COUNT,
        .settings = calloc( SETTINGS_MAX, sizeof( accuracy_setting ) ),
        .context = calloc( 1, sizeof( flight_scene ) ),
        .run = run,
        .destroy = destroy,
    };
    wisp_status status = WISP_OK;
    if ( !out->settings || !out->context )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the settings of balloon_flight" );
    }
    flight_scene* scene = out->context;
    status = status == WISP_OK ? flight_make_body( &scene->body, error ) : status;
    status = status == WISP_OK ? make_reference( scene, out, error ) : status;
    if ( status != WISP_OK )
    {
        if ( out->context )
        {
            destroy( out->context );
        }
        free( out->settings );
        *out = ( accuracy_scene ){ .setting_count = 0 };
        return status;
    }
    add_substeps( out );
    return WISP_OK;
}
