// Table 1 of Noh and Jung: triangle cloth, next to the times of the paper; and the case `paper`.
#include "paper_triangle.h"

#include "bench.h"
#include "bench_output.h"
#include "surfaces.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- measurements ----

// Table 1 of Noh and Jung: cloths fall onto a ball, worker counts step by step in turns, in one run.

// Below this time in seconds all cloths make fewer steps, and the largest is left out.
#define TRIANGLE_FULL_SECONDS 25.0
// Implementations alternate after about this time.
#define TURN_MS 20.0
#define SOLVING_PASS "implicit_cloth.step"

triangle_plan triangle_default_plan( const bench_options* options )
{
    const bool is_full = bench_seconds( options ) >= TRIANGLE_FULL_SECONDS;
    const int few = 21; // three steps on the ball
    const int all = is_full ? 300 : 100;
    return ( triangle_plan ){
        .drops = { { TRIANGLE_VERTICES, 200.0f, 1014.0, all },
                   { 0, 200.0f, 516.0, all },
                   { TRIANGLE_VERTICES, 100.0f, 1014.0, all },
                   { 0, 100.0f, 516.0, all },
                   { 10000, 200.0f, NAN, is_full ? 80 : 30 },
                   { 100000, 200.0f, NAN, few } },
        .drop_count = is_full ? 6 : 5,
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

static wisp_status enter_drop( const triangle_plan* plan, const triangle_drop* drop, drop_run* run,
                               wisp_error* error )
{
    run->timed_count = plan->worker_count;
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

static void leave_drop( drop_run* run )
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

static wisp_status time_drop( const triangle_drop* drop, drop_run* run, int e, int step, wisp_error* error )
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
    const double last = step > 0 ? run->ms[step - 1] : TURN_MS;
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
                    e < run->timed_count ? time_drop( drop, run, e, step, error ) : watched_step( run, step, error );
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

static double mean_iterations( const drop_run* run, int steps )
{
    double sum = 0.0;
    for ( int step = 0; step < steps; ++step )
    {
        sum += run->iterations[step];
    }
    return sum / steps;
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

static void conclude_iterations( const triangle_drop* drop, const drop_run* run, triangle_line* line )
{
    line->iterations_mean = mean_iterations( run, drop->steps );
    for ( int step = 0; step < drop->steps; ++step )
    {
        const int n = run->iterations[step];
        line->max_iterations = n > line->max_iterations ? n : line->max_iterations;
    }
}

static void check_drop( const triangle_plan* plan, const drop_run* run, const triangle_line* line, int e,
                        uint64_t hash, results* out )
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

static wisp_status conclude_drop( const triangle_plan* plan, drop_run* run, triangle_line* line, results* out,
                                  wisp_error* error )
{
    line->vertices = run->scene.fabric->vertex_count;
    line->stretch_links = run->stats.stretch_links;
    line->bend_links = run->stats.bend_links;
    line->contacts = run->stats.sticking + run->stats.sliding + run->stats.landing;
    const wisp_world* watched = run->implementations[run->timed_count].world;
    line->unsolved = wisp_world_counter( watched, WISP_COUNT_NOT_CONVERGED );
    line->indefinite = wisp_world_counter( watched, WISP_COUNT_INDEFINITE );
    conclude_iterations( line->drop, run, line );
    wisp_status status = conclude_times( line->drop, run, line, error );
    for ( int e = 0; e <= run->timed_count && status == WISP_OK; ++e )
    {
        uint64_t hash = 0;
        status = surface_implementation_hash( &run->implementations[e], &hash, error );
        line->hash = e == 0 ? hash : line->hash;
        if ( status == WISP_OK )
        {
            check_drop( plan, run, line, e, hash, out );
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
    row->hash = line->hash;
    row->has_hash = true;
    row->workers = plan->workers[w];
    results_put( &row->size, "ms_mean", line->mean_ms[w] );
    results_put( &row->size, "ns_a_vertex_and_iteration", line->iteration_ns[w] );
    results_put_times( row, &line->ms[w] );
    for ( int i = 0; i < profile->pass_count; ++i )
    {
        results_put( &row->stages, profile->passes[i].name, 1e3 * profile_samples_median( profile, i ) );
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
}

// ---- the report ----

// The tables of the triangle cloth: Table 1 of Noh and Jung, triangles against quads.

// Targets of this table.
#define SOURCE_RATIO 1.28         // per particle: 1.058 ms of triangles over 0.826 ms of quads
#define CLAIM_LARGE 10000         // from this many vertices on, an iteration costs at most ...
#define CLAIM_ITERATION_NS 20.0   // ... with 1 worker, per vertex
#define CLAIM_ITERATION_NS_2 12.0 // ... with 2

static int links_of( const triangle_line* line )
{
    return line->stretch_links + line->bend_links;
}

static const char* mesh_of( const triangle_line* line )
{
    return line->drop->vertices > 0 ? "triangles" : "quads";
}

// ---- Table 1 ----

static int begin_table( const triangle_plan* plan, results* out )
{
    results_cells row = { .count = 0 };
    cells_put( &row, "mesh\tvertices\tlinks\tk_s N/m\tsteps\tNoh and Jung s per frame" );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        cells_put( &row, "%d %s ms mean\t%d %s ms median\tFPS", plan->workers[w],
                   bench_workers_word( plan->workers[w] ), plan->workers[w], bench_workers_word( plan->workers[w] ) );
    }
    cells_put( &row, "speedup over Noh and Jung\titerations, mean / max" );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        cells_put( &row, "%d %s ns per vertex, iteration", plan->workers[w], bench_workers_word( plan->workers[w] ) );
    }
    cells_put( &row, "us per vertex\tns per link\tcontacts at the end\tunsolved / indefinite\thash" );
    return cells_begin_table( &row,
                              "Triangle cloth, Noh and Jung, Table 1: 1 m x 1 m falls onto a ball, whole step with "
                              "collision, dt 0.01 s, one solve",
                              out );
}

static void add_line( const triangle_plan* plan, const triangle_line* line, int table, results* out )
{
    results_cells row = { .count = 0 };
    cells_put( &row, "%s\t%d\t%d\t%.0f\t%d\t%.3f", mesh_of( line ), line->vertices, links_of( line ),
               (double)line->drop->stretch_stiffness, line->drop->steps, 1e-3 * line->drop->source_ms );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        cells_put( &row, "%.3f\t%.3f\t%.0f", line->mean_ms[w], line->ms[w].median, 1e3 / line->mean_ms[w] );
    }
    cells_put( &row, "%.0f\t%.1f / %d", line->drop->source_ms / line->mean_ms[0], line->iterations_mean,
               line->max_iterations );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        cells_put( &row, "%.1f", line->iteration_ns[w] );
    }
    cells_put( &row, "%.3f\t%.1f\t%d\t%llu / %llu\t%016llx", 1e3 * line->mean_ms[0] / line->vertices,
               1e6 * line->mean_ms[0] / links_of( line ), line->contacts, (unsigned long long)line->unsolved,
               (unsigned long long)line->indefinite, (unsigned long long)line->hash );
    cells_end_row( &row, table, out );
}

// ---- triangles and quads ----

static const triangle_line* find_quads( const triangle_plan* plan, const triangle_line* lines,
                                        const triangle_line* triangles )
{
    for ( int i = 0; i < plan->drop_count; ++i )
    {
        const bool is_same = lines[i].drop->stretch_stiffness == triangles->drop->stretch_stiffness;
        if ( lines[i].drop->vertices == 0 && is_same )
        {
            return &lines[i];
        }
    }
    return NULL;
}

static void add_ratio( const triangle_plan* plan, const triangle_line* triangles, const triangle_line* quads, int w,
                       int table, results* out )
{
    const double a = triangles->mean_ms[w], b = quads->mean_ms[w];
    const double a_vertex = 1e3 * a / triangles->vertices, b_vertex = 1e3 * b / quads->vertices;
    const double a_link = 1e6 * a / links_of( triangles ), b_link = 1e6 * b / links_of( quads );
    const double source_a = triangles->drop->source_ms / triangles->vertices;
    const double source_b = quads->drop->source_ms / quads->vertices;
    results_cells row = { .count = 0 };
    cells_put( &row, "%.0f\t%d", (double)triangles->drop->stretch_stiffness, plan->workers[w] );
    cells_put_pair( &row, a_vertex, 3, b_vertex, 3 );
    cells_put( &row, "%.2f\t%.2f", a_vertex / b_vertex, source_a / source_b );
    cells_put_pair( &row, a_link, 1, b_link, 1 );
    cells_put( &row, "%.2f", a_link / b_link );
    cells_put_pair( &row, (double)links_of( triangles ) / triangles->vertices, 1,
                    (double)links_of( quads ) / quads->vertices, 1 );
    cells_put_pair( &row, triangles->iterations_mean, 1, quads->iterations_mean, 1 );
    cells_end_row( &row, table, out );
}

static void add_ratios( const triangle_plan* plan, const triangle_line* lines, results* out )
{
    const int table = results_begin_table( out, "Triangles / quads: mean time of a step over the whole run",
                                           "k_s N/m\tworkers\tus per vertex\tratio\tratio, Noh and Jung\tns per "
                                           "link\tratio\tlinks per vertex\titerations" );
    for ( int i = 0; i < plan->drop_count; ++i )
    {
        const triangle_line* line = &lines[i];
        const bool is_source = line->drop->vertices > 0 && isfinite( line->drop->source_ms );
        const triangle_line* quads = is_source ? find_quads( plan, lines, line ) : NULL;
        for ( int w = 0; w < plan->worker_count && quads; ++w )
        {
            add_ratio( plan, line, quads, w, table, out );
        }
    }
}

// ---- the messages ----

static void claim_iterations( const triangle_plan* plan, const triangle_line* line, results* out )
{
    for ( int w = 0; w < plan->worker_count && line->vertices >= CLAIM_LARGE; ++w )
    {
        const double most = plan->workers[w] == 1   ? CLAIM_ITERATION_NS
                            : plan->workers[w] == 2 ? CLAIM_ITERATION_NS_2
                                                    : NAN;
        if ( isfinite( most ) )
        {
            char claim[160];
            snprintf( claim, sizeof( claim ), "%d vertices, %d %s: an iteration costs at most %.0f ns per vertex",
                      line->vertices, plan->workers[w], bench_workers_word( plan->workers[w] ), most );
            results_add_claim( out, line->iteration_ns[w] <= most, claim, line->iteration_ns[w], " ns" );
        }
    }
}

static void add_reading( const triangle_plan* plan, const triangle_line* lines, results* out )
{
    results_add_note( out,
                      "Noh and Jung: Core 2 Duo without a clock rate; masses, lengths, ball and solver are not "
                      "given. Per step of 0.01 s with collision: 1.014 s for 958 particles, 0.516 s for 625. Compare "
                      "the ratio per particle, %.2f, not absolute times.",
                      SOURCE_RATIO );
    results_add_note( out, "Wisp: 0.2 kg/m^2, k_b 1e-6 N m^2, k_d 0.02 N s/m, ball of radius 0.25 m, margin 5 mm, "
                           "friction 0.3 and 0.2, tolerance 1e-4, one substep, steps from the start of the fall." );
    results_add_note(
        out, "Times are of all steps; us per vertex, ns per link and speedup over Noh and Jung are means with 1 "
             "worker. Iterations come from a separate run with statistics, whose hash must be the same." );
    results_add_note( out, "ns per vertex and iteration: the whole solver pass with assembly; the median over steps "
                           "with at least a quarter of the most iterations." );
    for ( int i = 0; i < plan->drop_count; ++i )
    {
        if ( lines[i].unsolved + lines[i].indefinite > 0 )
        {
            results_add_note( out,
                              "%d vertices, k_s %.0f: %llu solves ended unconverged, %llu met negative curvature.",
                              lines[i].vertices, (double)lines[i].drop->stretch_stiffness,
                              (unsigned long long)lines[i].unsolved, (unsigned long long)lines[i].indefinite );
        }
    }
}

static double paper_ms_of( const results_row* row )
{
    // Noh and Jung state one time, the mean.
    return strcmp( row->variant, "source" ) == 0 ? row->ms_median : rows_size( row, "ms_mean" );
}

static void add_chart( results* out )
{
    rows_chart_add( &( rows_chart ){ .name = "paper.triangle_cloth",
                                     .also = "stretch_stiffness",
                                     .also_unit = "N/m",
                                     .title = "Triangle cloth that falls onto a ball: time against size",
                                     .x_label = "vertices",
                                     .y_label = "ms per step, mean",
                                     .x = rows_vertices,
                                     .y = paper_ms_of },
                    out );
}

// Tables, rows and messages.
static void triangle_report( const triangle_plan* plan, const triangle_line* lines, results* out )
{
    const int table = begin_table( plan, out );
    for ( int i = 0; i < plan->drop_count; ++i )
    {
        add_line( plan, &lines[i], table, out );
    }
    add_ratios( plan, lines, out );
    for ( int i = 0; i < plan->drop_count; ++i )
    {
        claim_iterations( plan, &lines[i], out );
    }
    add_chart( out );
    add_reading( plan, lines, out );
}

// ---- all cloths ----

static wisp_status drop_one( const triangle_plan* plan, triangle_line* line, results* out, wisp_error* error )
{
    drop_run run = { .timed_count = 0 };
    wisp_status status = enter_drop( plan, line->drop, &run, error );
    status = status == WISP_OK ? take_turns( line->drop, &run, error ) : status;
    status = status == WISP_OK ? conclude_drop( plan, &run, line, out, error ) : status;
    if ( status == WISP_OK )
    {
        add_rows( plan, &run, line, out );
    }
    leave_drop( &run );
    return status;
}

// Run the falling cloths. @param lines [drop_count]
static wisp_status triangle_drop_all( const triangle_plan* plan, triangle_line* lines, results* out,
                                      wisp_error* error )
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

// The plan of the case.
static wisp_status paper_triangle_cloth( const bench_options* options, results* out, wisp_error* error )
{
    const triangle_plan plan = triangle_default_plan( options );
    const wisp_status status = paper_triangle_run( &plan, out, error );
    if ( status == WISP_OK && bench_seconds( options ) < TRIANGLE_FULL_SECONDS )
    {
        results_add_note( out,
                          "Triangle cloth: short of time, 100 000 vertices are left out, and the cloth "
                          "falls for %d steps instead of 300.",
                          plan.drops[0].steps );
    }
    return status;
}

// ---- the case `paper` ----

// The case `paper`: the tables of Kim 2026 and of Noh and Jung, in turn, each with a part of the time.

bench_case_fn paper_frozen_hair;

static const struct paper_part
{
    bench_case_fn* run;
    double fraction; // of the time
} parts[] = {
    { paper_frozen_hair, 0.55 },
    { paper_triangle_cloth, 0.45 },
};

// A part reports its own progress.
typedef struct part_progress
{
    const bench_options* whole;
    double begin, fraction;
} part_progress;

static void pass_on( void* user, double fraction, const char* what )
{
    const part_progress* part = user;
    bench_progress( part->whole, part->begin + part->fraction * fraction, what );
}

wisp_status paper_bench( const bench_options* options, results* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    part_progress progress = { .whole = options };
    for ( int i = 0; i < WISP_COUNT( parts ) && status == WISP_OK; ++i )
    {
        progress.fraction = parts[i].fraction;
        bench_options part = *options;
        part.seconds = parts[i].fraction * bench_seconds( options );
        part.progress = pass_on;
        part.progress_user = &progress;
        status = parts[i].run( &part, out, error );
        progress.begin += progress.fraction;
    }
    return status;
}
