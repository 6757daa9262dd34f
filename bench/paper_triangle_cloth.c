// Table 1 of Noh and Jung: cloths fall onto a ball, worker counts step by step in turns, in one run.
#include "paper_triangle.h"

#include "triangle_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Below this time in seconds all cloths make fewer steps, and the two largest, which take 25 s alone, are left out.
#define FULL_SECONDS 25.0
// Implementations alternate after about this time.
#define TURN_MS 20.0
#define SOLVING_PASS "implicit_cloth.step"

triangle_plan triangle_default_plan( const bench_options* options )
{
    const bool is_full = bench_seconds( options ) >= FULL_SECONDS;
    const int few = 21; // three steps on the ball
    const int all = is_full ? 300 : 100;
    return ( triangle_plan ){
        .drops = { { TRIANGLE_VERTICES, 200.0f, 1014.0, all, true, true },
                   { 0, 200.0f, 516.0, all, true, false },
                   { TRIANGLE_VERTICES, 100.0f, 1014.0, all, true, false },
                   { 0, 100.0f, 516.0, all, true, false },
                   { 4000, 200.0f, NAN, few, false, true },
                   { 10000, 200.0f, NAN, is_full ? 80 : 30, true, true },
                   { 40000, 200.0f, NAN, few, false, true },
                   { 100000, 200.0f, NAN, few, true, true } },
        .drop_count = is_full ? 8 : 6,
        .touch_step = 18,
        .growth_steps = few - 18,
        .workers = { 1, options->workers },
        .worker_count = options->workers > 1 ? 2 : 1,
        .options = options,
    };
}

// ---- implementations ----

// Timed implementations have no statistics, which would cost time; another one, with all workers, has them and is not
// timed.
enum
{
    IMPLEMENTATIONS_MAX = TRIANGLE_WORKERS_MAX + 1,
};

typedef struct drop_run
{
    triangle_scene scene;
    surface_implementation implementations[IMPLEMENTATIONS_MAX]; // the last one has the statistics
    int timed_count;
    double *ms, *pass_ms; // [worker][step]
    int* iterations;      // [step]
    wisp_implicit_cloth_stats stats;
} drop_run;

static wisp_status enter( const triangle_plan* plan, const triangle_drop* drop, drop_run* run, wisp_error* error )
{
    run->timed_count = drop->is_timed ? plan->worker_count : 0;
    const size_t samples = (size_t)TRIANGLE_WORKERS_MAX * (size_t)drop->steps;
    run->ms = calloc( samples, sizeof( double ) );
    run->pass_ms = calloc( samples, sizeof( double ) );
    run->iterations = calloc( (size_t)drop->steps, sizeof( int ) );
    if ( !run->ms || !run->pass_ms || !run->iterations )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the samples of %d steps", drop->steps );
    }
    wisp_status status = triangle_scene_make( drop->vertices, &run->scene, error );
    triangle_setting setting = triangle_default_setting();
    setting.cloth.stretch_stiffness = drop->stretch_stiffness;
    setting.cloth.max_newton_iterations = 1; // Noh and Jung solve once per step, for any mesh
    for ( int e = 0; e <= run->timed_count && status == WISP_OK; ++e )
    {
        setting.requests_stats = e == run->timed_count;
        setting.workers = plan->workers[setting.requests_stats ? plan->worker_count - 1 : e];
        status = triangle_enter( &run->scene, &setting, &run->implementations[e], error );
    }
    return status;
}

static void leave( drop_run* run )
{
    for ( int e = 0; e < IMPLEMENTATIONS_MAX; ++e )
    {
        surface_implementation_destroy( &run->implementations[e] );
    }
    triangle_scene_free( &run->scene );
    free( run->ms );
    free( run->pass_ms );
    free( run->iterations );
}

// ---- steps ----

static double last_pass_ms( const surface_implementation* implementation )
{
    const wisp_profile profile = wisp_world_profile( implementation->world );
    for ( int i = 0; i < profile.count; ++i )
    {
        if ( strcmp( profile.lines[i].pass, SOLVING_PASS ) == 0 )
        {
            return 1e3 * profile.lines[i].seconds;
        }
    }
    return NAN;
}

static wisp_status timed_step( const triangle_drop* drop, drop_run* run, int e, int step, wisp_error* error )
{
    const size_t at = (size_t)e * (size_t)drop->steps + (size_t)step;
    const double start = wisp_clock_seconds();
    wisp_status status = surface_implementation_step( &run->implementations[e], error );
    run->ms[at] = 1e3 * ( wisp_clock_seconds() - start );
    run->pass_ms[at] = last_pass_ms( &run->implementations[e] );
    return status == WISP_OK ? surface_implementation_keep_profile( &run->implementations[e] ) : status;
}

static wisp_status watched_step( drop_run* run, int step, wisp_error* error )
{
    surface_implementation* implementation = &run->implementations[run->timed_count];
    wisp_status status = surface_implementation_step( implementation, error );
    if ( status == WISP_OK )
    {
        status = wisp_read_implicit_cloth_stats( implementation->world, implementation->entity, &run->stats );
        status = status == WISP_OK ? status : bench_world_fail( implementation->world, status, error );
        run->iterations[step] = run->stats.iterations;
    }
    return status;
}

// Turns of short steps have many, so that the caches are rarely refilled.
static int turn_length( const drop_run* run, int step )
{
    const double last = step > 0 && run->timed_count > 0 ? run->ms[step - 1] : TURN_MS;
    return (int)fmin( fmax( TURN_MS / fmax( last, 1e-3 ), 1.0 ), 30.0 );
}

static wisp_status take_turns( const triangle_drop* drop, drop_run* run, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int first = 0, end; first < drop->steps && status == WISP_OK; first = end )
    {
        end = first + turn_length( run, first );
        end = end < drop->steps ? end : drop->steps;
        for ( int e = 0; e <= run->timed_count; ++e )
        {
            for ( int step = first; step < end && status == WISP_OK; ++step )
            {
                status =
                    e < run->timed_count ? timed_step( drop, run, e, step, error ) : watched_step( run, step, error );
            }
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
    return count > 0 ? sum / count : NAN;
}

static double mean_iterations( const drop_run* run, int begin, int end )
{
    double sum = 0.0;
    for ( int step = begin; step < end; ++step )
    {
        sum += run->iterations[step];
    }
    return end > begin ? sum / ( end - begin ) : NAN;
}

// While the cloth falls there is nothing to iterate for, and the pass costs only the work around a solve.
static double median_iteration_ns( const drop_run* run, const double* pass_ms, int vertices, int steps,
                                   wisp_error* error, wisp_status* status )
{
    double* ns = malloc( (size_t)steps * sizeof( double ) );
    if ( !ns )
    {
        *status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a median of %d steps", steps );
        return NAN;
    }
    int most = 0, count = 0;
    for ( int step = 0; step < steps; ++step )
    {
        most = run->iterations[step] > most ? run->iterations[step] : most;
    }
    for ( int step = 0; step < steps; ++step )
    {
        if ( run->iterations[step] > 0 && 4 * run->iterations[step] >= most )
        {
            ns[count++] = 1e6 * pass_ms[step] / ( (double)run->iterations[step] * vertices );
        }
    }
    const double median = stats_summarise( ns, count ).median;
    free( ns );
    return median;
}

static wisp_status conclude_times( const triangle_drop* drop, drop_run* run, triangle_line* line, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int w = 0; w < TRIANGLE_WORKERS_MAX && status == WISP_OK; ++w )
    {
        const bool has = w < run->timed_count;
        double *ms = run->ms + (size_t)w * (size_t)drop->steps,
               *pass = run->pass_ms + (size_t)w * (size_t)drop->steps;
        line->mean_ms[w] = has ? mean( ms, drop->steps ) : NAN;
        line->pass_ms[w] = has ? mean( pass, drop->steps ) : NAN;
        line->iteration_ns[w] =
            has ? median_iteration_ns( run, pass, line->vertices, drop->steps, error, &status ) : NAN;
        line->ms[w] = stats_summarise( ms, has ? drop->steps : 0 );
    }
    return status;
}

static void conclude_iterations( const triangle_plan* plan, const triangle_drop* drop, const drop_run* run,
                                 triangle_line* line )
{
    line->iterations_mean = mean_iterations( run, 0, drop->steps );
    for ( int step = 0; step < drop->steps; ++step )
    {
        const int n = run->iterations[step];
        line->max_iterations = n > line->max_iterations ? n : line->max_iterations;
    }
    const int begin = plan->touch_step, end = begin + plan->growth_steps;
    line->growth_mean = end <= drop->steps ? mean_iterations( run, begin, end ) : NAN;
}

static void check( const triangle_plan* plan, const drop_run* run, const triangle_line* line, int e, uint64_t hash,
                   results* out )
{
    const bool is_watched = e == run->timed_count;
    const int workers = plan->workers[is_watched ? plan->worker_count - 1 : e];
    if ( hash != line->hash )
    {
        results_add_failure( out, "Cloth of %d vertices, k_s %.0f: %d %s%s give hash %016llx, %d gives %016llx.",
                             line->vertices, (double)line->drop->stretch_stiffness, workers,
                             bench_workers_word( workers ), is_watched ? " with statistics" : "",
                             (unsigned long long)hash, plan->workers[0], (unsigned long long)line->hash );
    }
    if ( run->implementations[e].halted_at > 0 )
    {
        results_add_failure( out, "Cloth of %d vertices, k_s %.0f: halted at step %d.", line->vertices,
                             (double)line->drop->stretch_stiffness, run->implementations[e].halted_at );
    }
}

static wisp_status conclude( const triangle_plan* plan, drop_run* run, triangle_line* line, results* out,
                             wisp_error* error )
{
    line->vertices = run->scene.fabric->vertex_count;
    line->stretch_links = run->stats.stretch_links;
    line->bend_links = run->stats.bend_links;
    line->contacts = run->stats.sticking + run->stats.sliding + run->stats.landing;
    const wisp_world* watched = run->implementations[run->timed_count].world;
    line->unsolved = wisp_world_counter( watched, WISP_COUNT_NOT_CONVERGED );
    line->indefinite = wisp_world_counter( watched, WISP_COUNT_INDEFINITE );
    conclude_iterations( plan, line->drop, run, line );
    wisp_status status = conclude_times( line->drop, run, line, error );
    for ( int e = 0; e <= run->timed_count && status == WISP_OK; ++e )
    {
        uint64_t hash = 0;
        status = surface_implementation_hash( &run->implementations[e], &hash, error );
        line->hash = e == 0 ? hash : line->hash;
        if ( status == WISP_OK )
        {
            check( plan, run, line, e, hash, out );
        }
    }
    return status;
}

// ---- rows for machines ----

static void add_row( const triangle_plan* plan, const triangle_line* line, const char* variant, int w,
                     profile_samples* profile, results* out )
{
    results_row* row = results_add_row( out, "paper.triangle_cloth", variant );
    if ( !row )
    {
        return;
    }
    results_put( &row->size, "vertices", line->vertices );
    results_put( &row->size, "links", line->stretch_links + line->bend_links );
    results_put( &row->size, "stretch_stiffness", (double)line->drop->stretch_stiffness );
    results_put( &row->size, "steps", line->drop->steps );
    results_put( &row->size, "iterations_mean", line->iterations_mean );
    results_put( &row->size, "max_iterations", line->max_iterations );
    results_put( &row->size, "contacts", line->contacts );
    results_put( &row->size, "unsolved", (double)line->unsolved );
    results_put( &row->size, "indefinite", (double)line->indefinite );
    if ( isfinite( line->growth_mean ) )
    {
        results_put( &row->size, "iterations_growth", line->growth_mean );
    }
    row->hash = line->hash;
    row->has_hash = true;
    row->workers = plan->workers[w];
    if ( profile )
    {
        results_put( &row->size, "ms_mean", line->mean_ms[w] );
        results_put( &row->size, "ns_a_vertex_and_iteration", line->iteration_ns[w] );
        results_put_times( row, &line->ms[w] );
        for ( int i = 0; i < profile->pass_count; ++i )
        {
            results_put( &row->stages, profile->passes[i].name, 1e3 * profile_samples_median( profile, i ) );
        }
    }
}

static void add_rows( const triangle_plan* plan, drop_run* run, const triangle_line* line, results* out )
{
    const char* variant = line->drop->vertices > 0 ? "triangles" : "quads";
    results_row* source =
        isfinite( line->drop->source_ms ) ? results_add_row( out, "paper.triangle_cloth", "source" ) : NULL;
    if ( source )
    {
        results_put( &source->size, "vertices", line->vertices );
        results_put( &source->size, "stretch_stiffness", (double)line->drop->stretch_stiffness );
        source->ms_median = line->drop->source_ms;
    }
    for ( int w = 0; w < run->timed_count; ++w )
    {
        add_row( plan, line, variant, w, &run->implementations[w].profile, out );
    }
    if ( run->timed_count == 0 )
    {
        add_row( plan, line, variant, plan->worker_count - 1, NULL, out );
    }
}

// ---- all cloths ----

static wisp_status drop_one( const triangle_plan* plan, triangle_line* line, results* out, wisp_error* error )
{
    drop_run run = { .timed_count = 0 };
    wisp_status status = enter( plan, line->drop, &run, error );
    status = status == WISP_OK ? take_turns( line->drop, &run, error ) : status;
    status = status == WISP_OK ? conclude( plan, &run, line, out, error ) : status;
    if ( status == WISP_OK )
    {
        add_rows( plan, &run, line, out );
    }
    leave( &run );
    return status;
}

wisp_status triangle_drop_all( const triangle_plan* plan, triangle_line* lines, results* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < plan->drop_count && status == WISP_OK; ++i )
    {
        bench_progress( plan->options, (double)i / plan->drop_count, "triangle cloth on a ball" );
        lines[i] = ( triangle_line ){ .drop = &plan->drops[i] };
        status = drop_one( plan, &lines[i], out, error );
    }
    return status;
}

wisp_status paper_triangle_run( const triangle_plan* plan, results* out, wisp_error* error )
{
    triangle_line lines[TRIANGLE_ROWS_MAX] = { { .drop = NULL } };
    const wisp_status status = triangle_drop_all( plan, lines, out, error );
    if ( status == WISP_OK )
    {
        triangle_report( plan, lines, out );
    }
    return status;
}

wisp_status paper_triangle_cloth( const bench_options* options, results* out, wisp_error* error )
{
    const triangle_plan plan = triangle_default_plan( options );
    const wisp_status status = paper_triangle_run( &plan, out, error );
    if ( status == WISP_OK && bench_seconds( options ) < FULL_SECONDS )
    {
        results_add_note( out,
                          "Triangle cloth: short of time, 40 000 and 100 000 vertices are left out, and the cloth "
                          "falls for %d steps instead of 300.",
                          plan.drops[0].steps );
    }
    return status;
}
