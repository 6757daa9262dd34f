// Table 1 of Noh and Jung: triangle cloth falls onto a ball; and the case `paper`.
#include "accuracy/scene_tools.h"
#include "bench_output.h"
#include "surfaces.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- cloths ----

// A run is a fall, whose mean step is its time, as Noh and Jung state one time, the mean.

#define FULL_SECONDS 25.0 // below it all cloths make fewer steps, and the largest is left out
#define SOLVING_PASS "implicit_cloth.step"

typedef struct drop
{
    int vertices; // of an irregular triangle mesh; 0: the quad mesh of Noh and Jung
    float stretch_stiffness;
    int steps;
} drop;

enum
{
    DROPS = 6,
    PLAIN = 0,
    WATCHED = 1, // with statistics, which cost time
};

typedef struct drop_run
{
    triangle_scene scene;
    surface_implementation cloths[2];
    double mean_ms;
    double* ns;      // [step] of the solving pass, per vertex and iteration
    int* iterations; // [step]
    wisp_implicit_cloth_stats stats;
} drop_run;

static wisp_status enter_drop( const drop* d, int workers, bool is_observed, drop_run* run, wisp_error* error )
{
    run->ns = calloc( (size_t)d->steps, sizeof( double ) );
    run->iterations = calloc( (size_t)d->steps, sizeof( int ) );
    wisp_status status = run->ns != NULL && run->iterations != NULL
                             ? triangle_scene_make( d->vertices, &run->scene, error )
                             : wisp_fail( error, WISP_NO_MEMORY, "no memory for the samples of %d steps", d->steps );
    triangle_setting setting = triangle_default_setting();
    setting.cloth.stretch_stiffness = d->stretch_stiffness;
    setting.cloth.max_newton_iterations = 1; // Noh and Jung solve once per step, for any mesh
    setting.workers = workers;
    for ( int k = PLAIN; k <= ( is_observed ? WATCHED : PLAIN ) && status == WISP_OK; ++k )
    {
        setting.requests_stats = k == WATCHED;
        status = triangle_enter( &run->scene, &setting, &run->cloths[k], error );
    }
    return status;
}

static void leave_drop( drop_run* run )
{
    surface_implementation_destroy( &run->cloths[PLAIN] );
    surface_implementation_destroy( &run->cloths[WATCHED] );
    triangle_scene_free( &run->scene );
    free( run->ns );
    free( run->iterations );
}

static double last_pass_ns( const surface_implementation* cloth )
{
    const wisp_profile profile = wisp_world_profile( cloth->world );
    double seconds = NAN;
    for ( int i = 0; i < profile.count; ++i )
    {
        seconds = strcmp( profile.lines[i].pass, SOLVING_PASS ) == 0 ? profile.lines[i].seconds : seconds;
    }
    return 1e9 * seconds;
}

static wisp_status watch_step( drop_run* run, int step, wisp_error* error )
{
    surface_implementation* cloth = &run->cloths[WATCHED];
    wisp_status status = surface_implementation_step( cloth, error );
    if ( status == WISP_OK )
    {
        status = wisp_read_implicit_cloth_stats( cloth->world, cloth->entity, &run->stats );
        status = status == WISP_OK ? status : bench_world_fail( cloth->world, status, error );
        run->iterations[step] = run->stats.iterations;
        run->ns[step] = last_pass_ns( &run->cloths[PLAIN] ) /
                        fmax( (double)run->stats.iterations * run->scene.fabric->vertex_count, 1.0 );
    }
    return status;
}

static wisp_status fall( const drop* d, bool is_observed, drop_run* run, wisp_error* error )
{
    wisp_status status = WISP_OK;
    double seconds = 0.0;
    for ( int step = 0; step < d->steps && status == WISP_OK; ++step )
    {
        const double begin = wisp_clock_seconds();
        status = surface_implementation_step( &run->cloths[PLAIN], error );
        seconds += wisp_clock_seconds() - begin;
        status = status == WISP_OK && is_observed ? watch_step( run, step, error ) : status;
    }
    run->mean_ms = 1e3 * seconds / d->steps;
    return status;
}

// ---- what is measured ----

enum
{
    ITERATIONS_MEAN,
    ITERATIONS_MOST,
    ITERATION_NS,
    CONTACTS,
    LINKS,
    UNSOLVED,
    INDEFINITE,
    DROP_MEASURES,
};

// While the cloth falls there is nothing to iterate for, and the pass costs only the work around a solve.
static double median_ns( const drop* d, drop_run* run, int most )
{
    int count = 0;
    for ( int step = 0; step < d->steps; ++step )
    {
        if ( run->iterations[step] > 0 && 4 * run->iterations[step] >= most )
        {
            run->ns[count++] = run->ns[step];
        }
    }
    return stats_summarise( run->ns, count ).median;
}

static wisp_status measure_drop( const drop* d, drop_run* run, accuracy_run* out, wisp_error* error )
{
    const wisp_world* world = run->cloths[WATCHED].world;
    double sum = 0.0;
    int most = 0;
    for ( int step = 0; step < d->steps; ++step )
    {
        sum += run->iterations[step];
        most = run->iterations[step] > most ? run->iterations[step] : most;
    }
    out->measures[ITERATIONS_MEAN] = sum / d->steps;
    out->measures[ITERATIONS_MOST] = most;
    out->measures[ITERATION_NS] = median_ns( d, run, most );
    out->measures[CONTACTS] = run->stats.sticking + run->stats.sliding + run->stats.landing;
    out->measures[LINKS] = run->stats.stretch_links + run->stats.bend_links;
    out->measures[UNSOLVED] = (double)wisp_world_counter( world, WISP_COUNT_NOT_CONVERGED );
    out->measures[INDEFINITE] = (double)wisp_world_counter( world, WISP_COUNT_INDEFINITE );
    uint64_t hash = 0;
    const wisp_status status = surface_implementation_hash( &run->cloths[WATCHED], &hash, error );
    return status != WISP_OK || hash == out->hash
               ? status
               : wisp_fail( error, WISP_CONFLICT, "statistics change the points of %d vertices",
                            run->scene.fabric->vertex_count );
}

static wisp_status run_drop( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                             wisp_error* error )
{
    const drop* d = (const drop*)context + setting;
    drop_run run = { .mean_ms = 0.0 };
    wisp_status status = enter_drop( d, workers, is_observed, &run, error );
    status = status == WISP_OK ? fall( d, is_observed, &run, error ) : status;
    status = status == WISP_OK ? accuracy_keep_ms( out, run.mean_ms ) : status;
    if ( status == WISP_OK )
    {
        out->work = ( accuracy_work ){ .vertices = run.scene.fabric->vertex_count, .substeps = 1 };
        out->halted_at = run.cloths[PLAIN].halted_at;
        status = surface_implementation_hash( &run.cloths[PLAIN], &out->hash, error );
    }
    status = status == WISP_OK && is_observed ? measure_drop( d, &run, out, error ) : status;
    leave_drop( &run );
    return status;
}

static const double drop_paper_ms[DROPS] = { 1014.0, 516.0 };

static wisp_status make_drops( const void* subject, const bench_options* options, double seconds, accuracy_scene* out,
                               wisp_error* error )
{
    (void)subject;
    (void)options;
    const bool is_full = seconds >= FULL_SECONDS;
    const int all = is_full ? 300 : 100, few = 21; // three steps on the ball
    const drop drops[DROPS] = { { TRIANGLE_VERTICES, 200.0f, all },   { 0, 200.0f, all },
                                { TRIANGLE_VERTICES, 100.0f, all },   { 0, 100.0f, all },
                                { 10000, 200.0f, is_full ? 80 : 30 }, { 100000, 200.0f, few } };
    *out = ( accuracy_scene ){
        .measure_names = { "iterations, mean", "iterations, most", "ns per vertex and iteration",
                           "contacts at the end", "links", "unsolved", "indefinite" },
        .measure_count = DROP_MEASURES,
        .has_no_rivals = true,
        .paper_ms = drop_paper_ms,
        .note =
            "1 m x 1 m falls onto a ball of radius 0.25 m: 0.2 kg/m^2, k_b 1e-6 N m^2, k_d 0.02 N s/m, margin 5 mm, "
            "friction 0.3 and 0.2, tolerance 1e-4, one substep and one solve in 0.01 s. Times are means of a fall "
            "from "
            "its start. Iterations are of the same fall with statistics; ns are the median over steps with at least "
            "a quarter of the most. Noh and Jung had a Core 2 Duo without a clock rate: compare the ratio per "
            "particle, 1.28. Short of time, 100 000 vertices are left out, and cloth falls for 100 steps, not 300.",
        .run = run_drop,
    };
    const wisp_status status = accuracy_begin_scene( out, sizeof drops, DROPS, error );
    for ( int i = 0; i < DROPS - ( is_full ? 0 : 1 ) && status == WISP_OK; ++i )
    {
        ( (drop*)out->context )[i] = drops[i];
        const int vertices = drops[i].vertices > 0 ? drops[i].vertices : TRIANGLE_QUAD_SIDE * TRIANGLE_QUAD_SIDE;
        accuracy_put_setting( out, "%s, %d vertices, k_s %g", drops[i].vertices > 0 ? "triangles" : "quads", vertices,
                              (double)drops[i].stretch_stiffness );
    }
    return status;
}

// From 10 000 vertices on an iteration costs at most 20 ns per vertex.
static void claim_iterations( int first_row, results* out )
{
    for ( int i = first_row; i < out->row_count; ++i )
    {
        const results_row* row = &out->rows[i];
        for ( int k = 0; k < row->error.count && row->workers == 1 && rows_vertices( row ) >= 10000.0; ++k )
        {
            if ( strncmp( row->error.items[k].name, "ns_per", 6 ) == 0 )
            {
                const double ns = row->error.items[k].value;
                char claim[256];
                snprintf( claim, sizeof claim, "%s: an iteration costs at most 20 ns per vertex", row->variant );
                results_add_claim( out, ns <= 20.0, claim, ns, " ns" );
            }
        }
    }
}

static wisp_status paper_triangle_cloth( const bench_options* options, results* out, wisp_error* error )
{
    const accuracy_entry entry = { "triangle_cloth", "triangle cloth, Table 1 of Noh and Jung", make_drops, NULL,
                                   NULL };
    const int first_row = out->row_count;
    const wisp_status status = accuracy_bench_run( &entry, 1, bench_seconds( options ), options, out, error );
    claim_iterations( first_row, out );
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
