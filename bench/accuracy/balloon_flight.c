// A full body without symmetry is let go: jet, spin, drag and buoyancy. Where its centre flies is compared with the flight of
// the oracle, which is the same equations in double precision, at 16 times the finest substeps; of finer meshes, with that of
// one that is finer still. The engine itself is no truth at such substeps: what gravity adds to a place within one is below
// the rounding of a float. Every flight begins with the same shape, that of a balloon at rest which has been filled at small
// substeps: what begins out of balance rings, and nothing but the length of the substeps decides how long.
#include "accuracy_surface.h"

#include "balloon_scene.h"

#include "oracle/balloon_oracle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    LEVELS = 4,
    FIRST_LEVEL = 1, // 42, 162, 642, 2562 vertices; the finest is the truth of the meshes
    USUAL_LEVEL = 0, // in the list of levels
    USUAL_SUBSTEPS = 10,
    FINEST_SUBSTEPS = 160,
    TRUTH_SUBSTEPS = 16 * FINEST_SUBSTEPS,
    FILL_STEPS = 60,
    FILL_SUBSTEPS = 640,
    FLIGHT_STEPS = 20,
    SETTINGS_MAX = 40,
};

#define FILL 1.2f
#define FILL_DAMPING 45.0f
// The outlet is small enough that gas is left when the flight ends: how it stops is no part of this.
#define OUTLET_AREA 1e-5f

/// Where a balloon was, after every step.
typedef struct flight_path
{
    double centre[FLIGHT_STEPS + 1][3];
    double speed, spin, volume; // in the end: m/s, rad/s, m^3
    double impulse_missing;     // N s, of the forces' integral, see close_momentum()
    double impulse;             // N s, largest change of momentum
} flight_path;

typedef struct flight_setting
{
    balloon_setting balloon;
    int level;
    const flight_path* truth;
} flight_setting;

typedef struct flight_body
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    wisp_vec3* full; // [vertex_count] where flights begin
    int outlet;
} flight_body;

typedef struct flight_scene
{
    flight_body bodies[LEVELS];
    flight_path by_substeps, by_mesh; // the truths
    flight_setting settings[SETTINGS_MAX];
} flight_scene;

// ---- bodies ----

// Finer meshes keep the vertices of coarser ones, so that the outlet stays where it is.
static int nearest_vertex( const wisp_mesh* mesh, wisp_vec3 place )
{
    int best = 0;
    float least = INFINITY;
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        const float x = mesh->points[i].x - place.x, y = mesh->points[i].y - place.y, z = mesh->points[i].z - place.z;
        const float distance = x * x + y * y + z * z;
        best = distance < least ? i : best;
        least = fminf( least, distance );
    }
    return best;
}

static wisp_status fill_up( flight_body* body, int substeps, wisp_error* error )
{
    balloon_setting setting = balloon_setting_in_vacuum();
    setting.def.fill = FILL;
    setting.damping = FILL_DAMPING;
    setting.substeps = substeps;
    setting.iterations = 1;
    setting.seconds = ACCURACY_FRAME;
    surface_entrant entrant = { 0 };
    const wisp_vec3* points = NULL;
    wisp_status status = balloon_entrant_create( body->fabric, &setting, &entrant, error );
    for ( int s = 0; s < FILL_STEPS && status == WISP_OK; ++s )
    {
        status = surface_entrant_step( &entrant, error );
    }
    status = status == WISP_OK ? surface_entrant_points( &entrant, &points, error ) : status;
    if ( status == WISP_OK )
    {
        memcpy( body->full, points, (size_t)body->mesh.vertex_count * sizeof( wisp_vec3 ) );
    }
    surface_entrant_destroy( &entrant );
    return status;
}

static wisp_status make_body( int level, const flight_body* coarsest, flight_body* out, wisp_error* error )
{
    wisp_mesh_recipe recipe = wisp_default_mesh_recipe( WISP_MESH_PEAR );
    recipe.radius = BALLOON_RADIUS;
    recipe.level = level;
    wisp_status status = wisp_mesh_make( &recipe, &out->mesh, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const int outlet = balloon_mesh_extreme( &coarsest->mesh, ( wisp_vec3 ){ 1.0f, 0.5f, 0.2f } );
    out->outlet = nearest_vertex( &out->mesh, coarsest->mesh.points[outlet] );
    const balloon_setting setting = balloon_default_setting();
    status = balloon_cook( &out->mesh, &setting, &out->fabric, error );
    out->full = malloc( (size_t)out->mesh.vertex_count * sizeof( wisp_vec3 ) );
    if ( status == WISP_OK && !out->full )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a full balloon" );
    }
    // fine meshes are compared with each other, at substeps that leave them stiff: those they are filled with
    const int substeps = level == FIRST_LEVEL + USUAL_LEVEL ? FILL_SUBSTEPS : USUAL_SUBSTEPS;
    return status == WISP_OK ? fill_up( out, substeps, error ) : status;
}

// ---- a flight ----

static double length( const double a[3] )
{
    return sqrt( a[0] * a[0] + a[1] * a[1] + a[2] * a[2] );
}

// Forces are those of the last substep of each step, here summed by trapezia from step to step; the first step has its own
// alone. What is missing is that sum's error, and whatever the solver gives or takes.
static void close_momentum( const wisp_quality* seen, const wisp_balloon_figures* forces, double before[3],
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

static wisp_status look( surface_entrant* entrant, int step, double before[3], double sum[3], flight_path* path,
                         wisp_error* error )
{
    wisp_quality seen = { 0 };
    wisp_balloon_figures forces = { 0 };
    wisp_status status = accuracy_read_quality( entrant, &seen, error );
    status = status == WISP_OK ? balloon_entrant_read( entrant, &forces, error ) : status;
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

// @param path null: nobody looks
static wisp_status fly( const flight_scene* scene, const flight_setting* what, int workers, accuracy_run* out,
                        flight_path* path, wisp_error* error )
{
    const flight_body* body = &scene->bodies[what->level];
    balloon_setting setting = what->balloon;
    setting.points = body->full;
    setting.def.outlet[0] = body->outlet;
    setting.workers = workers;
    surface_entrant entrant = { 0 };
    wisp_status status = balloon_entrant_create( body->fabric, &setting, &entrant, error );
    if ( status == WISP_OK )
    {
        status = wisp_want_balloon_figures( entrant.world, entrant.entity, path != NULL );
        status = status == WISP_OK ? accuracy_want_quality( &entrant, path != NULL, error )
                                   : surface_entrant_fail( &entrant, status, error );
    }
    double before[3] = { 0.0 }, sum[3] = { 0.0 };
    for ( int step = 1; step <= FLIGHT_STEPS && entrant.halted_at == 0 && status == WISP_OK; ++step )
    {
        status = accuracy_step_surface( &entrant, 1, out, error );
        if ( status == WISP_OK && path )
        {
            status = look( &entrant, step, before, sum, path, error );
        }
    }
    status = status == WISP_OK ? cloth_settings_end( &entrant, out, error ) : status;
    surface_entrant_destroy( &entrant );
    return status;
}

// ---- settings ----

static balloon_setting usual_balloon( int substeps, int iterations )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.fill = FILL;
    setting.def.outlet_count = 1;
    setting.def.outlet_area = OUTLET_AREA;
    setting.def.outlet_open = true;
    setting.substeps = substeps;
    setting.iterations = iterations;
    setting.seconds = ACCURACY_FRAME;
    return setting;
}

static flight_setting* add( accuracy_scene* scene, int substeps, int iterations, const char* series,
                            const char* knob_name, double knob, double order, const char* name )
{
    flight_scene* own = scene->context;
    flight_setting* what = &own->settings[scene->setting_count];
    *what = ( flight_setting ){ usual_balloon( substeps, iterations ), USUAL_LEVEL, &own->by_substeps };
    cloth_settings_join( cloth_settings_add( scene, "%s", name ), series, knob_name, knob, order );
    return what;
}

// Forces are taken at the beginning of a substep and velocities from the places at its end: first order.
static void add_substeps( accuracy_scene* scene )
{
    static const int substeps[] = { 5, USUAL_SUBSTEPS, 20, 40, 80, FINEST_SUBSTEPS };
    static const int iterations[] = { 1, 4 };
    for ( int k = 0; k < WISP_COUNT( iterations ); ++k )
    {
        for ( int i = 0; i < WISP_COUNT( substeps ); ++i )
        {
            char series[48], name[64];
            snprintf( series, sizeof( series ), "kick, max drag, %d iterations", iterations[k] );
            snprintf( name, sizeof( name ), "kick, max drag, %d x %d", substeps[i], iterations[k] );
            add( scene, substeps[i], iterations[k], iterations[k] == 1 ? "kick, max drag, 1 iteration" : series,
                 "substep, s", (double)ACCURACY_FRAME / substeps[i], 1.0, name );
        }
    }
}

// No order: at the same substeps a finer mesh is stiffer than they can follow, so that two errors fall against each other.
static void add_meshes( accuracy_scene* scene )
{
    flight_scene* own = scene->context;
    for ( int level = 0; level + 1 < LEVELS; ++level )
    {
        char name[64];
        snprintf( name, sizeof( name ), "%d vertices, %d x 1, against %d", own->bodies[level].mesh.vertex_count,
                  USUAL_SUBSTEPS, own->bodies[LEVELS - 1].mesh.vertex_count );
        // the edge of an icosahedron of radius 1 is 1.05, and every level halves it
        flight_setting* what = add( scene, USUAL_SUBSTEPS, 1, "mesh", "edge, m",
                                    1.05 * (double)BALLOON_RADIUS / ( 1 << ( level + FIRST_LEVEL ) ), NAN, name );
        what->level = level;
        what->truth = &own->by_mesh;
    }
}

static void add_forms( accuracy_scene* scene )
{
    static const char* const drags[] = { "max", "abs", "signed", "normal" };
    static const char* const spins[] = { "kick", "printed", "none" };
    static const char* const readings[] = { "virial", "multiplier", "gas law" };
    char name[64];
    for ( int d = WISP_BALLOON_DRAG_ABS; d < WISP_BALLOON_DRAG_COUNT; ++d )
    {
        snprintf( name, sizeof( name ), "kick, %s drag, %d x 1", drags[d], USUAL_SUBSTEPS );
        add( scene, USUAL_SUBSTEPS, 1, "", "", NAN, NAN, name )->balloon.def.drag = (wisp_balloon_drag)d;
    }
    for ( int s = WISP_BALLOON_SPIN_PRINTED; s < WISP_BALLOON_SPIN_COUNT; ++s )
    {
        snprintf( name, sizeof( name ), "spin %s, max drag, %d x 1", spins[s], USUAL_SUBSTEPS );
        add( scene, USUAL_SUBSTEPS, 1, "", "", NAN, NAN, name )->balloon.def.spin = (wisp_balloon_spin)s;
    }
    for ( int r = WISP_BALLOON_PRESSURE_MULTIPLIER; r < WISP_BALLOON_PRESSURE_COUNT; ++r )
    {
        snprintf( name, sizeof( name ), "pressure by %s, %d x 1", readings[r], USUAL_SUBSTEPS );
        add( scene, USUAL_SUBSTEPS, 1, "", "", NAN, NAN, name )->balloon.def.pressure = (wisp_balloon_pressure)r;
    }
    snprintf( name, sizeof( name ), "angular momentum not kept, %d x 1", USUAL_SUBSTEPS );
    add( scene, USUAL_SUBSTEPS, 1, "", "", NAN, NAN, name )->balloon.def.keep_angular_momentum = false;
}

// ---- runs ----

static double path_error( const flight_path* a, const flight_path* b )
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

static wisp_status run( void* context, int index, int workers, bool is_looked_at, accuracy_run* out,
                        wisp_error* error )
{
    const flight_scene* scene = context;
    const flight_setting* what = &scene->settings[index];
    flight_path path = { .speed = NAN };
    wisp_status status = fly( scene, what, workers, out, is_looked_at ? &path : NULL, error );
    if ( status == WISP_OK && is_looked_at && out->halted_at == 0 )
    {
        const flight_path* truth = what->truth;
        out->error = 1e3 * path_error( &path, truth );
        out->measures[0] = path.speed;
        out->measures[1] = 100.0 * ( path.speed / truth->speed - 1.0 );
        out->measures[2] = path.spin;
        out->measures[3] = 100.0 * ( path.volume / truth->volume - 1.0 );
        out->measures[4] = 100.0 * path.impulse_missing / path.impulse;
    }
    return status;
}

// ---- truths ----

static double3 to_double( wisp_vec3 p )
{
    return ( double3 ){ (double)p.x, (double)p.y, (double)p.z };
}

static void look_at_oracle( const balloon_oracle* oracle, int step, flight_path* out )
{
    double momentum[3] = { 0.0 }, centre[3] = { 0.0 };
    for ( int i = 0; i < oracle->vertex_count; ++i )
    {
        const double m = oracle->mass[i] / oracle->total_mass;
        const double3 x = oracle->x[i], v = oracle->v[i];
        centre[0] += m * x.x;
        centre[1] += m * x.y;
        centre[2] += m * x.z;
        momentum[0] += m * v.x;
        momentum[1] += m * v.y;
        momentum[2] += m * v.z;
    }
    memcpy( out->centre[step], centre, sizeof( centre ) );
    out->speed = length( momentum );
    out->spin = sqrt( double3_dot( oracle->omega, oracle->omega ) );
    out->volume = balloon_oracle_present_volume( oracle );
}

static wisp_status fly_oracle( const flight_body* body, flight_path* out, wisp_error* error )
{
    const int count = body->mesh.vertex_count;
    double3* points = malloc( (size_t)count * sizeof( double3 ) );
    if ( !points )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a balloon in double precision" );
    }
    for ( int i = 0; i < count; ++i )
    {
        points[i] = to_double( body->mesh.points[i] );
    }
    const balloon_mesh mesh = { count, body->mesh.triangle_count, points, body->mesh.triangles };
    balloon_oracle_options options = balloon_oracle_default_options();
    options.dt = (double)ACCURACY_FRAME;
    options.substeps = TRUTH_SUBSTEPS;
    options.iterations = 1;
    options.outlet_area = (double)OUTLET_AREA;
    options.outlet_open = true;
    balloon_oracle oracle;
    wisp_status status = balloon_oracle_create_from_mesh( &mesh, (double)BALLOON_AREA_DENSITY, body->outlet, &options,
                                                          &oracle, error );
    free( points );
    if ( status != WISP_OK )
    {
        return status;
    }
    oracle.gas_volume = (double)FILL * oracle.rest_volume;
    for ( int i = 0; i < count; ++i )
    {
        oracle.x[i] = to_double( body->full[i] );
    }
    for ( int step = 1; step <= FLIGHT_STEPS; ++step )
    {
        balloon_oracle_step( &oracle );
        look_at_oracle( &oracle, step, out );
    }
    balloon_oracle_destroy( &oracle );
    return WISP_OK;
}

static wisp_status fly_finest_mesh( flight_scene* scene, wisp_error* error )
{
    const flight_setting what = { usual_balloon( USUAL_SUBSTEPS, 1 ), LEVELS - 1, NULL };
    accuracy_run times = { .error = NAN };
    wisp_status status = fly( scene, &what, 1, &times, &scene->by_mesh, error );
    if ( status == WISP_OK && times.halted_at != 0 )
    {
        status = wisp_fail( error, WISP_BAD_INPUT, "the finest mesh of balloon_flight was halted at step %d",
                            times.halted_at );
    }
    free( times.ms );
    return status;
}

// ---- the scene ----

static void destroy( void* context )
{
    flight_scene* scene = context;
    for ( int level = 0; level < LEVELS; ++level )
    {
        wisp_fabric_release( scene->bodies[level].fabric );
        wisp_mesh_release( &scene->bodies[level].mesh );
        free( scene->bodies[level].full );
    }
    free( scene );
}

static wisp_status make( flight_scene* scene, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int level = 0; level < LEVELS && status == WISP_OK; ++level )
    {
        status = make_body( level + FIRST_LEVEL, &scene->bodies[0], &scene->bodies[level], error );
    }
    status = status == WISP_OK ? fly_oracle( &scene->bodies[USUAL_LEVEL], &scene->by_substeps, error ) : status;
    return status == WISP_OK ? fly_finest_mesh( scene, error ) : status;
}

wisp_status accuracy_balloon_flight( const bench_options* options, double seconds, accuracy_scene* out,
                                     wisp_error* error )
{
    (void)options;
    (void)seconds; // it is short, and its truth has to be the same
    *out = ( accuracy_scene ){
        .truth =
            "16 times the finest substeps, in double precision (2560 x 1); of finer meshes: 2562 vertices, 10 x 1",
        .doubt = 0.5, // at 20 480 substeps in double precision the path is 0.47 mm elsewhere
        .note =
            "drag, spin and pressure of other forms are other flights, and their error is what the form makes of it. "
            "Momentum is closed up to forces being known once a step, and up to rounding: what gravity adds to a "
            "place in 1/9600 s is less than a float of it can hold.",
        .error_name = "distance of the centre's path",
        .error_unit = "mm",
        .measure_names = { "speed m/s", "speed error %", "spin rad/s", "volume error %", "momentum not closed %" },
        .measure_count = 5,
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
    status = status == WISP_OK ? make( out->context, error ) : status;
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
    add_meshes( out );
    add_forms( out );
    return WISP_OK;
}
