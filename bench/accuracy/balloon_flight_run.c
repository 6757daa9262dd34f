// Fills a balloon, brings it to rest and releases it.
#include "balloon_flight_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    FILL_STEPS = 60,
    FIRST_LEVEL = 1, // all finer meshes contain its vertices
};

#define FILL_DAMPING 45.0f
// The outlet is so small that gas is left at the end of the flight; how the jet ends is not part of the scene.
#define OUTLET_AREA 1e-5f

static double length( const double a[3] )
{
    return sqrt( a[0] * a[0] + a[1] * a[1] + a[2] * a[2] );
}

double flight_distance( const flight_path* a, const flight_path* b )
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

wisp_status flight_fill_body( flight_body* body, int substeps, wisp_error* error )
{
    balloon_setting setting = balloon_setting_in_vacuum();
    setting.def.gas_ratio = FLIGHT_FILL;
    setting.damping = FILL_DAMPING;
    setting.substeps = substeps;
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

static wisp_status make_pear( int level, wisp_mesh* out, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PEAR );
    generator.radius = BALLOON_RADIUS;
    generator.level = level;
    return wisp_mesh_generate( &generator, out, error );
}

// Next to the centre, at a vertex of the coarsest mesh.
static wisp_status find_outlet( flight_body* body, wisp_error* error )
{
    wisp_mesh coarse = { 0 };
    wisp_status status = make_pear( FIRST_LEVEL, &coarse, error );
    if ( status == WISP_OK )
    {
        const int vertex = balloon_mesh_extreme( &coarse, ( wisp_vec3 ){ 1.0f, 0.5f, 0.2f } );
        body->outlet = nearest_vertex( &body->mesh, coarse.points[vertex] );
    }
    wisp_mesh_release( &coarse );
    return status;
}

wisp_status flight_make_body( int level, flight_body* out, wisp_error* error )
{
    const balloon_setting setting = balloon_default_setting();
    *out = ( flight_body ){ .fabric = NULL };
    wisp_status status = make_pear( level, &out->mesh, error );
    status = status == WISP_OK ? find_outlet( out, error ) : status;
    status = status == WISP_OK ? balloon_cook( &out->mesh, &setting, &out->fabric, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    out->full = malloc( (size_t)out->mesh.vertex_count * sizeof( wisp_vec3 ) );
    return out->full ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a full balloon" );
}

void flight_free_body( flight_body* body )
{
    wisp_fabric_release( body->fabric );
    wisp_mesh_release( &body->mesh );
    free( body->full );
    *body = ( flight_body ){ .fabric = NULL };
}

// ---- a flight ----

balloon_setting flight_setting( int substeps, int iterations )
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

static wisp_status observe( surface_implementation* implementation, int step, double before[3], double sum[3],
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

wisp_status flight_fly( const flight_body* body, balloon_setting setting, int workers, accuracy_run* out,
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
            status = observe( &implementation, step, before, sum, path, error );
        }
    }
    status = status == WISP_OK ? accuracy_end_surface( &implementation, out, error ) : status;
    surface_implementation_destroy( &implementation );
    return status;
}

// ---- the reference ----

static accuracy_reference reference_of( const char* scene, const flight_body* body, int number_count )
{
    const balloon_setting setting = flight_setting( 1, 1 );
    accuracy_reference reference = { .number_count = number_count };
    snprintf( reference.scene, sizeof( reference.scene ), "%s", scene );
    accuracy_reference_put( &reference, "vertices", body->mesh.vertex_count );
    accuracy_reference_put( &reference, "outlet at vertex", body->outlet );
    accuracy_reference_put( &reference, "outlet, m2", (double)setting.def.outlet_area );
    accuracy_reference_put( &reference, "area density, kg/m2", (double)setting.area_density );
    accuracy_reference_put( &reference, "fill", (double)setting.def.gas_ratio );
    accuracy_reference_put( &reference, "stiffness of edges, N/m", (double)setting.def.edge_stiffness );
    accuracy_reference_put( &reference, "stiffness across edges, N/m", (double)setting.def.bend_link_stiffness );
    accuracy_reference_put( &reference, "atmosphere, Pa", (double)setting.def.atmospheric_pressure );
    accuracy_reference_put( &reference, "drag", (double)setting.def.drag_coefficient );
    accuracy_reference_put( &reference, "gravity, m/s2", -(double)setting.gravity.y );
    accuracy_reference_put( &reference, "steps a second", 1.0 / (double)ACCURACY_FRAME );
    accuracy_reference_put( &reference, "steps", FLIGHT_STEPS );
    accuracy_reference_put_start( &reference, body->mesh.points, body->mesh.vertex_count );
    return reference;
}

accuracy_reference flight_reference( const flight_body* body )
{
    return reference_of( "balloon_flight", body, FLIGHT_NUMBERS + 3 * body->mesh.vertex_count );
}

const int flight_paces[FLIGHT_PACES] = { 10, 40 };

accuracy_reference flight_meshes_reference( const flight_body* finest )
{
    accuracy_reference reference = reference_of( "balloon_meshes", finest, FLIGHT_PACES * FLIGHT_NUMBERS );
    accuracy_reference_put( &reference, "substeps that fill it", FLIGHT_MESHES_FILL );
    for ( int pace = 0; pace < FLIGHT_PACES; ++pace )
    {
        char name[40];
        snprintf( name, sizeof( name ), "substeps of flight %d", pace + 1 );
        accuracy_reference_put( &reference, name, flight_paces[pace] );
    }
    return reference;
}

void flight_put_path( const flight_path* path, double* numbers )
{
    memcpy( numbers, path->centre[1], 3 * FLIGHT_STEPS * sizeof( double ) );
    numbers += 3 * FLIGHT_STEPS;
    numbers[0] = path->speed;
    numbers[1] = path->spin;
    numbers[2] = path->volume;
}

flight_path flight_take_path( const double* numbers )
{
    flight_path path = { .impulse = NAN, .impulse_missing = NAN };
    memcpy( path.centre[1], numbers, 3 * FLIGHT_STEPS * sizeof( double ) );
    numbers += 3 * FLIGHT_STEPS;
    path.speed = numbers[0];
    path.spin = numbers[1];
    path.volume = numbers[2];
    return path;
}

void flight_judge( const flight_path* path, const flight_path* reference, accuracy_run* out )
{
    out->error = 1e3 * flight_distance( path, reference );
    out->measures[0] = path->speed;
    out->measures[1] = 100.0 * ( path->speed / reference->speed - 1.0 );
    out->measures[2] = path->spin;
    out->measures[3] = 100.0 * ( path->volume / reference->volume - 1.0 );
    out->measures[4] = 100.0 * path->impulse_missing / path->impulse;
}
