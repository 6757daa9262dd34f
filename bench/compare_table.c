// Tables and rows of a comparison.
#include "compare_bench.h"

#include "cells.h"

#include <math.h>

// ---- all variants ----

static void put_rest( const compare_scene* scene, const compare_observation* rest, double distance, cells* row )
{
    const double none = scene->physics.has_ball ? 0.0 : (double)TRIANGLE_HEIGHT;
    cells_put_number( row, rest ? 1e3 * ( rest->hem - none ) : NAN, 2 );
    cells_put_number( row, rest ? 1e2 * rest->strain : NAN, 3 );
    cells_put_number( row, rest ? rest->energy : NAN, 4 );
    cells_put_number( row, 1e3 * distance, 2 );
}

static int begin_table( const compare_plan* plan, const compare_scene* scene, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "solver" );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        cells_put( &row, "%d %s ms", plan->workers[w], bench_workers_word( plan->workers[w] ) );
        cells_put( &row, "p10 .. p90" );
    }
    cells_put( &row, "RMS error mm" );
    cells_put( &row, "largest RMS error mm" );
    cells_put( &row, "%s", scene->physics.has_ball ? "hem mm" : "sag mm" );
    cells_put( &row, "strain %%" );
    cells_put( &row, "energy J" );
    cells_put( &row, "rest RMS mm" );
    cells_put( &row, "hash" );
    char title[160];
    snprintf( title, sizeof( title ),
              "Comparison `%s`: ms per frame, distance to the reference from %.2f to %.2f s, and values at %g s",
              scene->physics.name, (double)COMPARE_OBSERVATION_SECONDS,
              (double)COMPARE_OBSERVATION_SECONDS * ( scene->physics.observation_count - 1 ),
              (double)scene->physics.rest_seconds );
    return cells_begin_table( &row, title, out );
}

static void add_reference_line( const compare_plan* plan, const compare_scene* scene,
                                const compare_reference* reference, int table, results* out )
{
    cells row = { .count = 0 };
    double square = 0.0, worst = 0.0;
    for ( int k = 1; k < scene->physics.observation_count; ++k )
    {
        square += reference->observations[k].uncertainty * reference->observations[k].uncertainty /
                  ( scene->physics.observation_count - 1 );
        worst = fmax( worst, reference->observations[k].uncertainty );
    }
    cells_put( &row, "Newton in double 1/%g (uncertainty)", reference->rate );
    for ( int w = 0; w < 2 * plan->worker_count; ++w )
    {
        cells_put( &row, "-" );
    }
    cells_put_number( &row, 1e3 * sqrt( square ), 3 );
    cells_put_number( &row, 1e3 * worst, 3 );
    const compare_reference_observation* rest = &reference->observations[reference->observation_count - 1];
    put_rest( scene, &rest->observation, rest->uncertainty, &row );
    cells_put( &row, "-" );
    cells_end_row( &row, table, out );
}

static void add_line( const compare_plan* plan, const compare_scene* scene, const compare_variant* variant,
                      const compare_stats* f, int table, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "%s%s", variant->name, variant->is_limit ? " (the model)" : "" );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        if ( f->ms[w].count == 0 )
        {
            if ( f->halted_at > 0 )
            {
                cells_put( &row, "halted at step %d", f->halted_at );
            }
            else
            {
                cells_put( &row, "-" );
            }
            cells_put( &row, "-" );
            continue;
        }
        cells_put_number( &row, f->ms[w].median, 3 );
        cells_put( &row, "%.3f .. %.3f", f->ms[w].p10, f->ms[w].p90 );
    }
    cells_put_number( &row, 1e3 * f->path, 3 );
    cells_put_number( &row, 1e3 * f->worst, 3 );
    put_rest( scene, f->has_rest ? &f->rest : NULL, f->has_rest ? f->rest_distance : NAN, &row );
    cells_put_hash( &row, f->hash );
    cells_end_row( &row, table, out );
}

static void put_finite( results_values* values, const char* name, double value )
{
    if ( isfinite( value ) )
    {
        results_put( values, name, value );
    }
}

static void put_errors( const compare_stats* f, results_values* error )
{
    put_finite( error, "path_rms_m", f->path );
    put_finite( error, "worst_observation_rms_m", f->worst );
    if ( f->has_rest )
    {
        put_finite( error, "rest_rms_m", f->rest_distance );
        put_finite( error, "rest_height_m", f->rest.hem );
        put_finite( error, "rest_strain", f->rest.strain );
        put_finite( error, "rest_energy_J", f->rest.energy );
    }
    if ( f->halted_at > 0 )
    {
        results_put( error, "halted_at_step", f->halted_at );
    }
}

static void add_rows( const compare_plan* plan, const compare_scene* scene, const compare_variant* variant,
                      const compare_stats* f, results* out )
{
    char name[64];
    snprintf( name, sizeof( name ), "cloth.compare.%s", scene->physics.name );
    for ( int w = 0; w < ( variant->is_limit ? 1 : plan->worker_count ); ++w )
    {
        results_row* row = results_add_row( out, name, variant->name );
        if ( !row )
        {
            return;
        }
        results_put( &row->size, "vertices", scene->base.mesh.vertex_count );
        results_put( &row->size, "edges", scene->edge_count );
        results_put( &row->size, "substeps_a_second",
                     variant->method == COMPARE_IMPLICIT ? variant->rate : 60 * variant->substeps );
        row->workers = plan->workers[w];
        row->ms_median = f->ms[w].median;
        row->ms_p10 = f->ms[w].p10;
        row->ms_p90 = f->ms[w].p90;
        row->steps = f->ms[w].count;
        snprintf( row->error_reference, sizeof( row->error_reference ), "Newton in double" );
        put_errors( f, &row->error );
        row->hash = f->hash;
        row->has_hash = true;
    }
}

void compare_add_table( const compare_plan* plan, const compare_scene* scene, const compare_reference* reference,
                        const compare_stats* stats, results* out )
{
    const int table = begin_table( plan, scene, out );
    add_reference_line( plan, scene, reference, table, out );
    for ( int i = 0; i < plan->variant_count; ++i )
    {
        add_line( plan, scene, &plan->variants[i], &stats[i], table, out );
        add_rows( plan, scene, &plan->variants[i], &stats[i], out );
    }
}

// ---- summaries ----

// The faster worker count: with two cores, one may stay idle.
static double fastest( const compare_plan* plan, const compare_stats* f )
{
    double ms = INFINITY;
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        ms = fmin( ms, f->ms[w].count > 0 ? f->ms[w].median : INFINITY );
    }
    return ms;
}

// The fastest variant of a method whose error is not above the limit, or the most accurate one whose time is not. -1:
// none.
static int best_of( const compare_plan* plan, const compare_stats* stats, compare_method method, bool by_time,
                    double limit )
{
    int best = -1;
    double least = INFINITY;
    for ( int i = 0; i < plan->variant_count; ++i )
    {
        const double ms = fastest( plan, &stats[i] ), error = stats[i].path;
        const double value = by_time ? ms : error, limited = by_time ? error : ms;
        const bool takes_part = plan->variants[i].method == method && !plan->variants[i].is_limit;
        if ( takes_part && limited <= limit && value < least )
        {
            best = i;
            least = value;
        }
    }
    return best;
}

static void put_best( const compare_plan* plan, const compare_stats* stats, int best, bool by_time, cells* row )
{
    if ( best < 0 )
    {
        cells_put( row, "-" );
        cells_put( row, "-" );
        return;
    }
    cells_put_number( row, by_time ? fastest( plan, &stats[best] ) : 1e3 * stats[best].path, 3 );
    cells_put( row, "%s", plan->variants[best].name );
}

static void add_summary( const compare_plan* plan, const compare_scene* scene, const compare_stats* stats,
                         bool by_time, results* out )
{
    static const double budgets_ms[] = { 0.5, 1.0, 2.0, 4.0 }, targets_mm[] = { 10.0, 3.0, 1.0, 0.3 };
    cells row = { .count = 0 };
    cells_put( &row, "%s, at most", by_time ? "RMS mm" : "ms per frame" );
    for ( int m = 0; m < COMPARE_METHOD_COUNT; ++m )
    {
        cells_put( &row, "%s %s", compare_method_names[m], by_time ? "ms" : "RMS mm" );
        cells_put( &row, "with" );
    }
    char title[160];
    snprintf( title, sizeof( title ), "Comparison `%s`, at equal %s: %s", scene->physics.name,
              by_time ? "error" : "time",
              by_time ? "the fastest way that is near enough" : "the nearest way that is fast enough" );
    const int table = cells_begin_table( &row, title, out );
    for ( int i = 0; i < 4; ++i )
    {
        cells line = { .count = 0 };
        cells_put( &line, "%g", by_time ? targets_mm[i] : budgets_ms[i] );
        for ( int m = 0; m < COMPARE_METHOD_COUNT; ++m )
        {
            const double limit = by_time ? 1e-3 * targets_mm[i] : budgets_ms[i];
            put_best( plan, stats, best_of( plan, stats, (compare_method)m, by_time, limit ), by_time, &line );
        }
        cells_end_row( &line, table, out );
    }
}

void compare_add_summaries( const compare_plan* plan, const compare_scene* scene, const compare_stats* stats,
                            results* out )
{
    add_summary( plan, scene, stats, false, out );
    add_summary( plan, scene, stats, true, out );
}
