// A cloth that hangs by two corners, solved by the engine and by scalar C in turns: the same links, forces, tolerance
// and steps, one worker each.
#include "paper_triangle.h"

#include "plain/implicit_cloth_plain.h"
#include "triangle_scene.h"

#include <math.h>
#include <stdlib.h>

// Steps of a turn: so few that a disturbance affects both.
#define TURN_STEPS 5

typedef struct hang_comparison
{
    triangle_scene scene;
    int32_t pins[2];
    surface_implementation ours, watched; // sampled: with statistics, and not timed
    plain_implicit_cloth plain;
    double *ms, *plain_ms; // [step]
    double iterations, plain_iterations;
    int64_t plain_unsolved;
    int links;
} hang_comparison;

// The ends of the side of smallest z.
static void find_corners( const wisp_mesh* mesh, int32_t pins[2] )
{
    pins[0] = pins[1] = 0;
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        const wisp_vec3 p = mesh->points[v];
        const wisp_vec3 left = mesh->points[pins[0]], right = mesh->points[pins[1]];
        pins[0] = p.x + p.z < left.x + left.z ? v : pins[0];
        pins[1] = p.x - p.z > right.x - right.z ? v : pins[1];
    }
}

static wisp_status make_plain( const wisp_mesh* mesh, const wisp_implicit_cloth_def* def, const int32_t pins[2],
                               plain_implicit_cloth* out, wisp_error* error )
{
    const bool ramps_alike = !( def->compression_stiffness > 0.0f );
    const plain_implicit_material material = {
        .stretch_stiffness = def->stretch_stiffness,
        .bend_stiffness = def->bend_stiffness,
        .compression_stiffness = ramps_alike ? def->stretch_stiffness : def->compression_stiffness,
        .damping = def->link_damping,
        .area_density = TRIANGLE_DENSITY,
        .gravity = { 0.0f, -TRIANGLE_GRAVITY, 0.0f },
        .tolerance = def->tolerance,
    };
    if ( !plain_implicit_cloth_create( out, mesh->points, mesh->vertex_count, mesh->triangles, mesh->triangle_count,
                                       &material ) )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the scalar C version of %d vertices",
                          mesh->vertex_count );
    }
    plain_implicit_cloth_pin( out, pins[0] );
    plain_implicit_cloth_pin( out, pins[1] );
    return WISP_OK;
}

static wisp_status enter( int vertices, int steps, hang_comparison* comparison, wisp_error* error )
{
    comparison->ms = calloc( (size_t)steps, sizeof( double ) );
    comparison->plain_ms = calloc( (size_t)steps, sizeof( double ) );
    if ( !comparison->ms || !comparison->plain_ms )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the samples of %d steps", steps );
    }
    wisp_status status = triangle_scene_make( vertices, &comparison->scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    find_corners( &comparison->scene.mesh, comparison->pins );
    triangle_setting setting = triangle_default_setting();
    setting.has_ball = false;
    setting.cloth.max_newton_iterations = 1; // scalar C solves once per step
    setting.pins = comparison->pins;
    setting.pin_count = 2;
    status = triangle_enter( &comparison->scene, &setting, &comparison->ours, error );
    setting.requests_stats = true;
    status = status == WISP_OK ? triangle_enter( &comparison->scene, &setting, &comparison->watched, error ) : status;
    return status == WISP_OK
               ? make_plain( &comparison->scene.mesh, &setting.cloth, comparison->pins, &comparison->plain, error )
               : status;
}

static void leave( hang_comparison* comparison )
{
    plain_implicit_cloth_destroy( &comparison->plain );
    surface_implementation_destroy( &comparison->ours );
    surface_implementation_destroy( &comparison->watched );
    triangle_scene_free( &comparison->scene );
    free( comparison->ms );
    free( comparison->plain_ms );
}

// ---- steps ----

static void step_plain( hang_comparison* comparison, int step )
{
    const double start = wisp_clock_seconds();
    plain_implicit_cloth_step( &comparison->plain, comparison->ours.generator.seconds );
    comparison->plain_ms[step] = 1e3 * ( wisp_clock_seconds() - start );
    comparison->plain_iterations += comparison->plain.iterations;
    comparison->plain_unsolved += comparison->plain.is_solved ? 0 : 1;
}

static wisp_status step_ours( hang_comparison* comparison, int step, wisp_error* error )
{
    const double start = wisp_clock_seconds();
    wisp_status status = surface_implementation_step( &comparison->ours, error );
    comparison->ms[step] = 1e3 * ( wisp_clock_seconds() - start );
    return status == WISP_OK ? surface_implementation_keep_profile( &comparison->ours ) : status;
}

static wisp_status step_watched( hang_comparison* comparison, wisp_error* error )
{
    wisp_implicit_cloth_stats stats = { .iterations = 0 };
    wisp_status status = surface_implementation_step( &comparison->watched, error );
    if ( status == WISP_OK )
    {
        status = wisp_read_implicit_cloth_stats( comparison->watched.world, comparison->watched.entity, &stats );
        status = status == WISP_OK ? status : bench_world_fail( comparison->watched.world, status, error );
    }
    comparison->iterations += stats.iterations;
    comparison->links = stats.stretch_links + stats.bend_links;
    return status;
}

static wisp_status take_turns( int steps, hang_comparison* comparison, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int first = 0, end; first < steps && status == WISP_OK; first = end )
    {
        end = first + TURN_STEPS < steps ? first + TURN_STEPS : steps;
        for ( int step = first; step < end; ++step )
        {
            step_plain( comparison, step );
        }
        for ( int step = first; step < end && status == WISP_OK; ++step )
        {
            status = step_ours( comparison, step, error );
        }
        for ( int step = first; step < end && status == WISP_OK; ++step )
        {
            status = step_watched( comparison, error );
        }
    }
    return status;
}

// ---- results ----

static double mean( const double* values, int count )
{
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        sum += values[i];
    }
    return sum / count;
}

static void measure_distance( const plain_implicit_cloth* plain, const wisp_vec3* points, triangle_hang* out )
{
    double squares = 0.0, most = 0.0;
    for ( int i = 0; i < plain->vertex_count; ++i )
    {
        const wisp_vec3 p = points[i], q = plain->position[i];
        const double x = (double)p.x - (double)q.x, y = (double)p.y - (double)q.y, z = (double)p.z - (double)q.z;
        const double square = x * x + y * y + z * z;

        // Not fmax, which would ignore a NaN.
        most = square <= most ? most : square;
        squares += square;
    }
    out->max_distance = sqrt( most );
    out->distance_rms = sqrt( squares / plain->vertex_count );
}

static wisp_status conclude( hang_comparison* comparison, triangle_hang* hang, results* out, wisp_error* error )
{
    const wisp_vec3* points = NULL;
    uint64_t watched_hash = 0;
    wisp_status status = surface_implementation_points( &comparison->ours, &points, error );
    status = status == WISP_OK ? surface_implementation_hash( &comparison->ours, &hang->hash, error ) : status;
    status = status == WISP_OK ? surface_implementation_hash( &comparison->watched, &watched_hash, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( watched_hash != hang->hash )
    {
        results_add_failure( out, "Hanging cloth of %d vertices: with statistics hash %016llx, without %016llx.",
                             hang->vertices, (unsigned long long)watched_hash, (unsigned long long)hang->hash );
    }
    measure_distance( &comparison->plain, points, hang );
    hang->links = comparison->links;
    hang->iterations = comparison->iterations / hang->steps;
    hang->plain_iterations = comparison->plain_iterations / hang->steps;
    hang->plain_unsolved = comparison->plain_unsolved;
    hang->unsolved = wisp_world_counter( comparison->ours.world, WISP_COUNT_NOT_CONVERGED );
    hang->indefinite = wisp_world_counter( comparison->ours.world, WISP_COUNT_INDEFINITE );
    hang->mean_ms = mean( comparison->ms, hang->steps );
    hang->plain_mean_ms = mean( comparison->plain_ms, hang->steps );
    hang->ms = stats_summarise( comparison->ms, hang->steps );
    hang->plain_ms = stats_summarise( comparison->plain_ms, hang->steps );
    return WISP_OK;
}

static results_row* begin_row( const triangle_hang* hang, const char* variant, const stats_summary* ms,
                               double mean_ms, double iterations, results* out )
{
    results_row* row = results_add_row( out, "paper.triangle_hang", variant );
    if ( row )
    {
        results_put( &row->size, "vertices", hang->vertices );
        results_put( &row->size, "links", hang->links );
        results_put( &row->size, "steps", hang->steps );
        results_put( &row->size, "iterations_mean", iterations );
        results_put( &row->size, "ms_mean", mean_ms );
        row->workers = 1;
        results_put_times( row, ms );
    }
    return row;
}

static void add_rows( hang_comparison* comparison, const triangle_hang* hang, results* out )
{
    begin_row( hang, "plain", &hang->plain_ms, hang->plain_mean_ms, hang->plain_iterations, out );
    results_row* row = begin_row( hang, "wisp", &hang->ms, hang->mean_ms, hang->iterations, out );
    if ( row )
    {
        profile_samples profile = comparison->ours.profile;
        for ( int i = 0; i < profile.pass_count; ++i )
        {
            results_put( &row->stages, profile.passes[i].name, 1e3 * profile_samples_median( &profile, i ) );
        }
        snprintf( row->error_reference, sizeof( row->error_reference ), "plain" );
        results_put( &row->error, "max_m", hang->max_distance );
        results_put( &row->error, "rms_m", hang->distance_rms );
        row->hash = hang->hash;
        row->has_hash = true;
    }
}

static wisp_status comparison_one( int vertices, int steps, triangle_hang* hang, results* out, wisp_error* error )
{
    hang_comparison comparison = { .links = 0 };
    *hang = ( triangle_hang ){ .vertices = vertices, .steps = steps };
    wisp_status status = enter( vertices, steps, &comparison, error );
    status = status == WISP_OK ? take_turns( steps, &comparison, error ) : status;
    status = status == WISP_OK ? conclude( &comparison, hang, out, error ) : status;
    if ( status == WISP_OK )
    {
        add_rows( &comparison, hang, out );
    }
    leave( &comparison );
    return status;
}

wisp_status triangle_hang_all( const triangle_plan* plan, triangle_hang* hangs, results* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < plan->hang_count && status == WISP_OK; ++i )
    {
        bench_progress( plan->options, 0.8 + 0.2 * i / plan->hang_count, "triangle cloth against scalar C" );
        status = comparison_one( plan->hangs[i].vertices, plan->hangs[i].steps, &hangs[i], out, error );
    }
    return status;
}
