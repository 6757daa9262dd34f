// Residual against passes and time: the solve order determines how far an error travels in one pass.
#include "cloth_bench.h"

#include <math.h>
#include <stdlib.h>

// Distance of the cloth from its pins at the start.
#define PULLED 1.02f
#define REPEATS 5

static const int passes[] = { 1, 4, 16, 64, 256 };

enum
{
    PASS_COUNTS = WISP_COUNT( passes ),
};

typedef struct sweep_stats
{
    double ms[PASS_COUNTS];       ///< of all passes over links
    double residual[PASS_COUNTS]; ///< mean |l/l0 - 1| after them
    double largest[PASS_COUNTS];
} sweep_stats;

static wisp_vec3* pulled_points( const cloth_scene* scene )
{
    const wisp_mesh* mesh = &scene->mesh;
    wisp_vec3* points = malloc( (size_t)mesh->vertex_count * sizeof( wisp_vec3 ) );
    float held = mesh->points[scene->pins[0]].z;
    for ( int i = 0; points && i < mesh->vertex_count; ++i )
    {
        points[i] = mesh->points[i];
        points[i].z = held + PULLED * ( points[i].z - held );
    }
    return points;
}

// The same step repeatedly, from the same state. Columns requested by the plan alone exist once it is compiled.
static wisp_status repeat_step( surface_implementation* implementation, wisp_error* error )
{
    if ( wisp_world_plan_passes( implementation->world ) < 0 )
    {
        return bench_world_fail( implementation->world, WISP_CONFLICT, error );
    }
    size_t size = wisp_world_snapshot_size( implementation->world );
    void* start = malloc( size );
    wisp_status status = start ? wisp_world_snapshot( implementation->world, start, size )
                               : wisp_fail( error, WISP_NO_MEMORY, "no memory for a snapshot of the sweeps' cloth" );
    for ( int i = 0; i < REPEATS && status == WISP_OK; ++i )
    {
        status = wisp_world_restore( implementation->world, start, size );
        if ( status != WISP_OK )
        {
            bench_world_fail( implementation->world, status, error );
            break;
        }
        status = surface_implementation_step( implementation, error );
        status = status == WISP_OK ? surface_implementation_keep_profile( implementation ) : status;
    }
    free( start );
    return status;
}

static wisp_status run_sweep( const cloth_scene* scene, wisp_solve_order solve_order, const wisp_vec3* points,
                              sweep_stats* out, wisp_error* error )
{
    cloth_setting setting = { "sweep", 1, 1, false, false, solve_order, 0 };
    wisp_fabric* fabric = NULL;
    wisp_status status = cloth_cook( scene, &setting, &fabric, error );
    for ( int i = 0; i < PASS_COUNTS && status == WISP_OK; ++i )
    {
        surface_implementation implementation = { 0 };
        setting.iterations = passes[i];
        status = cloth_implementation_create( scene, fabric, &setting, points, 1, &implementation, error );
        status = status == WISP_OK ? repeat_step( &implementation, error ) : status;
        if ( status == WISP_OK )
        {
            surface_observation observation = surface_implementation_observe( &implementation );
            out->ms[i] = surface_implementation_pass_ms( &implementation, "links." );
            out->residual[i] = observation.stretch_mean;
            out->largest[i] = observation.stretch_max;
        }
        surface_implementation_destroy( &implementation );
    }
    wisp_fabric_release( fabric );
    return status;
}

// ---- scalar C ----

static void observe_plain( const plain_cloth* cloth, double* mean, double* largest )
{
    *mean = *largest = 0.0;
    for ( int i = 0; i < cloth->edge_count; ++i )
    {
        wisp_vec3 a = cloth->position[cloth->links[i].a], b = cloth->position[cloth->links[i].b];
        double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
        double stretch = fabs( sqrt( x * x + y * y + z * z ) / (double)cloth->links[i].rest - 1.0 );
        *largest = stretch <= *largest ? *largest : stretch;
        *mean += stretch / cloth->edge_count;
    }
}

static wisp_status run_plain( const cloth_scene* scene, const wisp_vec3* points, sweep_stats* out, wisp_error* error )
{
    plain_cloth cloth;
    const wisp_mesh* mesh = &scene->mesh;
    if ( !plain_cloth_create( &cloth, mesh->points, mesh->vertex_count, mesh->triangles, mesh->triangle_count, 1.0f,
                              CLOTH_BEND_STIFFNESS ) )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the scalar C version" );
    }
    plain_cloth_pin( &cloth, scene->pins[0] );
    plain_cloth_pin( &cloth, scene->pins[1] );
    for ( int i = 0; i < PASS_COUNTS; ++i )
    {
        for ( int v = 0; v < mesh->vertex_count; ++v )
        {
            cloth.position[v] = points[v];
            cloth.velocity[v] = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
        }
        cloth.passes = passes[i];
        double start = wisp_clock_seconds();
        plain_cloth_step( &cloth, CLOTH_STEP );
        out->ms[i] = 1e3 * ( wisp_clock_seconds() - start );
        observe_plain( &cloth, &out->residual[i], &out->largest[i] );
    }
    plain_cloth_destroy( &cloth );
    return WISP_OK;
}

// ---- the table ----

// The time at which a sweep reaches a residual, by linear interpolation of logarithms; NaN if it never does.
static double time_to_reach( const sweep_stats* f, double residual )
{
    for ( int i = 1; i < PASS_COUNTS; ++i )
    {
        if ( f->residual[i] <= residual && f->residual[i - 1] >= residual && f->residual[i - 1] > f->residual[i] )
        {
            double fraction = log( f->residual[i - 1] / residual ) / log( f->residual[i - 1] / f->residual[i] );
            return exp( log( f->ms[i - 1] ) + fraction * log( f->ms[i] / f->ms[i - 1] ) );
        }
    }
    return NAN;
}

static void add_table( const cloth_scene* scene, const sweep_stats stats[3], results* out )
{
    static const char* const names[3] = { "scalar C", "colours", "list" };
    char title[160];
    snprintf( title, sizeof( title ),
              "Residual after k passes of one step, n = %d pulled by %.0f %%: ms and stretch max / mean %%, 1 worker",
              scene->n, 100.0 * ( (double)PULLED - 1.0 ) );
    cells header = { .count = 0 };
    cells_put( &header, "k" );
    for ( int s = 0; s < 3; ++s )
    {
        cells_put( &header, "%s ms", names[s] );
        cells_put( &header, "%s %%", names[s] );
    }
    int table = cells_begin_table( &header, title, out );
    for ( int i = 0; i < PASS_COUNTS; ++i )
    {
        cells row = { .count = 0 };
        cells_put( &row, "%d", passes[i] );
        for ( int s = 0; s < 3; ++s )
        {
            cells_put_number( &row, stats[s].ms[i], 3 );
            cells_put_pair( &row, 100.0 * stats[s].largest[i], 2, 100.0 * stats[s].residual[i], 4 );
        }
        cells_end_row( &row, table, out );
    }
    double requested = stats[1].residual[3];
    results_add_note( out,
                      "Error against time: colours reach their mean residual after %d passes in %.2f ms, the list in "
                      "%.2f ms, scalar C in the order of the mesh in %.2f ms.",
                      passes[3], stats[1].ms[3], time_to_reach( &stats[2], requested ),
                      time_to_reach( &stats[0], requested ) );
}

wisp_status cloth_sweeps( const cloth_plan* plan, results* out, wisp_error* error )
{
    cloth_scene scene = { 0 };
    sweep_stats stats[3] = { { { 0 }, { 0 }, { 0 } } };
    wisp_status status = cloth_scene_make( plan->sweep_size, false, &scene, error );
    wisp_vec3* points = status == WISP_OK ? pulled_points( &scene ) : NULL;
    if ( status == WISP_OK && !points )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the pulled cloth" );
    }
    status = status == WISP_OK ? run_plain( &scene, points, &stats[0], error ) : status;
    status = status == WISP_OK ? run_sweep( &scene, WISP_SOLVE_ORDER_COLOUR, points, &stats[1], error ) : status;
    status = status == WISP_OK ? run_sweep( &scene, WISP_SOLVE_ORDER_LIST, points, &stats[2], error ) : status;
    if ( status == WISP_OK )
    {
        add_table( &scene, stats, out );
    }
    free( points );
    cloth_scene_free( &scene );
    return status;
}
