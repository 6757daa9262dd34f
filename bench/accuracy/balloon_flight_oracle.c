// The flight of a released balloon by the oracle, which solves the same equations one by one in double precision.
#include "balloon_flight_run.h"

#include "oracle/balloon_oracle.h"

#include <stdlib.h>

static double3 widen( wisp_vec3 p )
{
    return double3_make( (double)p.x, (double)p.y, (double)p.z );
}

static void observe( const balloon_oracle* oracle, int step, flight_path* out )
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

wisp_status flight_fly_oracle( const flight_body* body, int substeps, flight_path* path, wisp_error* error )
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
        observe( &oracle, step, path );
    }
    balloon_oracle_destroy( &oracle );
    return WISP_OK;
}
