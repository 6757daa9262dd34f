#include "paper.h"
#include "paper_implementations.h"
#include "bench_timing.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// The oracle tests all pairs: 10 000 vertices take it seconds, a million would take it days.
#define ORACLE_VERTICES_MAX 10000
#define ORACLE_VERTICES_QUICK 6000
// All worker counts are compared at one event of the command, whatever the events of their timed steps.
#define COMPARED_EVENT 7
#define SAMPLES_MAX 400

typedef struct paper_size
{
    int strands;
    double source_ms, source_fps;     ///< NaN: not in Kim 2026
    double quick_weight, full_weight; ///< of the time left for this size and the larger ones; 0: left out
} paper_size;

static const paper_size sizes[PAPER_SIZES] = {
    { 100, 6.8, 147.0, 1.0, 1.0 }, { 300, 16.5, 60.0, 1.0, 1.0 }, { 500, 28.7, 35.0, 1.0, 1.0 },
    { 2000, NAN, NAN, 1.0, 1.0 },  { 10000, NAN, NAN, 2.0, 2.0 }, { 50000, NAN, NAN, 0.0, 4.0 },
};

/// All data of one size while it is measured.
typedef struct paper_comparison
{
    paper_scene scene;
    paper_world worlds[PAPER_VARIANTS_MAX]; ///< by worker count
    bench_variant variants[PAPER_VARIANTS_MAX];
    double* oracle; ///< [vertices][3] or null
} paper_comparison;

// ---- implementations ----

static wisp_status enter( const paper_table* table, int strands, paper_comparison* comparison, wisp_error* error )
{
    wisp_status status = paper_scene_make( strands, &comparison->scene, error );
    for ( int v = 0; v < table->variant_count && status == WISP_OK; ++v )
    {
        status = paper_world_create( &comparison->scene, table->workers[v], &comparison->worlds[v], error );
        comparison->variants[v] = ( bench_variant ){
            .name = "wisp", .step = paper_world_step, .after = paper_world_after, .context = &comparison->worlds[v]
        };
    }
    return status;
}

static void leave( const paper_table* table, paper_comparison* comparison )
{
    bench_free_samples( comparison->variants, table->variant_count );
    for ( int v = 0; v < table->variant_count; ++v )
    {
        paper_world_destroy( &comparison->worlds[v] );
    }
    paper_scene_free( &comparison->scene );
    free( comparison->oracle );
}

// ---- errors and hashes ----

static double largest_distance( const paper_comparison* comparison, const wisp_vec3* points )
{
    double largest = 0.0;
    for ( int i = 0; i < comparison->scene.groom.vertex_count; ++i )
    {
        const double* reference = comparison->oracle + 3 * (size_t)i;
        double dx = (double)points[i].x - reference[0];
        double dy = (double)points[i].y - reference[1];
        double dz = (double)points[i].z - reference[2];
        double distance = sqrt( dx * dx + dy * dy + dz * dz );

        // Not fmax, which would ignore a NaN.
        largest = distance <= largest ? largest : distance;
    }
    return largest;
}

static wisp_status run_oracle( paper_comparison* comparison, wisp_error* error )
{
    comparison->oracle = malloc( 3 * (size_t)comparison->scene.groom.vertex_count * sizeof( double ) );
    return comparison->oracle ? paper_oracle_run( &comparison->scene, COMPARED_EVENT, comparison->oracle, error )
                              : wisp_fail( error, WISP_NO_MEMORY, "no memory for the oracle's points" );
}

// All worker counts run the same event.
static wisp_status judge( const paper_table* table, paper_comparison* comparison, paper_line* line, results* out,
                          wisp_error* error )
{
    line->tolerance = PAPER_TOLERATED_ROUNDINGS * (double)FLT_EPSILON * comparison->scene.extent;
    wisp_status status = line->vertices <= table->oracle_vertices_max ? run_oracle( comparison, error ) : WISP_OK;
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int v = 0; v < table->variant_count; ++v )
    {
        const wisp_vec3* points;
        uint64_t hash;
        status = paper_world_replay( &comparison->worlds[v], COMPARED_EVENT, &points, &hash, error );
        if ( status != WISP_OK )
        {
            return status;
        }
        line->error[v] = comparison->oracle ? largest_distance( comparison, points ) : NAN;
        line->hash = v == 0 ? hash : line->hash;
        if ( hash != line->hash )
        {
            results_add_failure( out, "%d strands: %d workers give hash %016llx, %d worker gives %016llx.",
                                 line->strands, table->workers[v], (unsigned long long)hash, table->workers[0],
                                 (unsigned long long)line->hash );
        }
    }
    return WISP_OK;
}

static void check_errors( const paper_table* table, const paper_comparison* comparison, const paper_line* line,
                          results* out )
{
    for ( int v = 0; v < table->variant_count; ++v )
    {
        if ( comparison->oracle && !( line->error[v] <= line->tolerance ) )
        {
            results_add_failure(
                out, "%d strands: %d workers are %.3g m from the double oracle, more than the tolerated %.3g m.",
                line->strands, table->workers[v], line->error[v], line->tolerance );
        }
    }
}

// After hundreds of other commands the same event from rest must still give the same bits.
static wisp_status check_repeat( const paper_table* table, paper_comparison* comparison, const paper_line* line,
                                 results* out, wisp_error* error )
{
    for ( int v = 0; v < table->variant_count; ++v )
    {
        const wisp_vec3* points;
        uint64_t hash;
        wisp_status status = paper_world_replay( &comparison->worlds[v], COMPARED_EVENT, &points, &hash, error );
        if ( status != WISP_OK )
        {
            return status;
        }
        if ( hash != line->hash )
        {
            results_add_failure( out,
                                 "%d strands, %d workers: event %d gave hash %016llx before the timed steps and "
                                 "%016llx after them.",
                                 line->strands, table->workers[v], COMPARED_EVENT, (unsigned long long)line->hash,
                                 (unsigned long long)hash );
        }
    }
    return WISP_OK;
}

// ---- times ----

static wisp_status time_comparison( const paper_table* table, paper_comparison* comparison, paper_line* line,
                                    bool quick, double seconds, wisp_error* error )
{
    const bench_effort effort = { .seconds = seconds, .rounds_min = quick ? 1 : 3, .samples_max = SAMPLES_MAX };
    wisp_status status = bench_interleave( comparison->variants, table->variant_count, &effort, error );
    for ( int v = 0; v < table->variant_count && status == WISP_OK; ++v )
    {
        line->ms[v] = bench_summarise( &comparison->variants[v] );
    }
    return status;
}

static void find_fractions( profile_samples* profile, double step_ms, double fraction[3] )
{
    static const char* const stages[3] = { ".freeze", ".align", ".clump" };
    for ( int stage = 0; stage < 3; ++stage )
    {
        fraction[stage] = 0.0;
        for ( int i = 0; i < profile->pass_count; ++i )
        {
            if ( strstr( profile->passes[i].name, stages[stage] ) )
            {
                fraction[stage] += 1e3 * profile_samples_median( profile, i ) / step_ms;
            }
        }
    }
}

static wisp_status describe( const paper_table* table, paper_comparison* comparison, paper_line* line,
                             wisp_error* error )
{
    paper_world* widest = &comparison->worlds[table->variant_count - 1];
    find_fractions( &widest->profile, line->ms[table->variant_count - 1].median, line->fraction );
    line->bytes = (double)wisp_world_memory( widest->world ) / line->vertices;

    wisp_frozen_hair_stats report;
    wisp_status status = wisp_read_frozen_hair_stats( widest->world, widest->hair, &report );
    if ( status != WISP_OK )
    {
        return bench_world_fail( widest->world, status, error );
    }
    line->neighbours = (double)report.neighbours / line->vertices;
    return report.capped == 0
               ? WISP_OK
               : wisp_fail( error, WISP_CONFLICT, "%d strands: %llu vertices ran into the neighbour limit",
                            line->strands, (unsigned long long)report.capped );
}

// ---- rows ----

static void add_row( const paper_table* table, const paper_comparison* comparison, const paper_line* line, int v,
                     results* out )
{
    results_row* row = results_add_row( out, "paper", "wisp" );
    if ( !row )
    {
        return;
    }
    results_put( &row->size, "strands", line->strands );
    results_put( &row->size, "vertices", line->vertices );
    results_put( &row->size, "neighbours_a_vertex", line->neighbours );
    row->workers = table->workers[v];
    results_put_times( row, &line->ms[v] );
    if ( isfinite( line->error[v] ) )
    {
        snprintf( row->error_reference, sizeof( row->error_reference ), "oracle" );
        results_put( &row->error, "max_m", line->error[v] );
        results_put( &row->error, "max_in_clump_radii", line->error[v] / table->clump_radius );
        results_put( &row->error, "tolerance_m", line->tolerance );
    }
    profile_samples profile = comparison->worlds[v].profile;
    for ( int i = 0; i < profile.pass_count; ++i )
    {
        results_put( &row->stages, profile.passes[i].name, 1e3 * profile_samples_median( &profile, i ) );
    }
    results_put( &row->size, "bytes_a_vertex",
                 (double)wisp_world_memory( comparison->worlds[v].world ) / line->vertices );
    row->hash = line->hash;
    row->has_hash = true;
}

static void add_rows( const paper_table* table, const paper_comparison* comparison, const paper_line* line,
                      results* out )
{
    results_row* source = isfinite( line->source_ms ) ? results_add_row( out, "paper", "source" ) : NULL;
    if ( source )
    {
        results_put( &source->size, "strands", line->strands );
        results_put( &source->size, "vertices", line->vertices );
        source->ms_median = line->source_ms;
    }
    for ( int v = 0; v < table->variant_count; ++v )
    {
        add_row( table, comparison, line, v, out );
    }
}

// ---- the case ----

static wisp_status run_comparison( const paper_table* table, paper_comparison* comparison, paper_line* line,
                                   bool quick, double deadline, double fraction, results* out, wisp_error* error )
{
    wisp_status status = enter( table, line->strands, comparison, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    line->vertices = comparison->scene.groom.vertex_count;
    status = judge( table, comparison, line, out, error );
    if ( status == WISP_OK )
    {
        check_errors( table, comparison, line, out );
        double left = fmax( fraction * ( deadline - wisp_clock_seconds() ), 0.0 );
        status = time_comparison( table, comparison, line, quick, left, error );
    }
    if ( status == WISP_OK )
    {
        status = check_repeat( table, comparison, line, out, error );
    }
    if ( status == WISP_OK )
    {
        status = describe( table, comparison, line, error );
    }
    if ( status == WISP_OK )
    {
        add_rows( table, comparison, line, out );
    }
    return status;
}

// The fraction of the remaining time for a size, with the larger ones still to come.
static double fraction_of_rest( int size, bool quick )
{
    double sum = 0.0;
    for ( int i = size; i < PAPER_SIZES; ++i )
    {
        sum += quick ? sizes[i].quick_weight : sizes[i].full_weight;
    }
    return ( quick ? sizes[size].quick_weight : sizes[size].full_weight ) / sum;
}

static paper_table empty_table( const bench_options* options )
{
    paper_table table = { .variant_count = options->workers > 1 ? 2 : 1,
                          .workers = { 1, options->workers },
                          .oracle_vertices_max = options->quick ? ORACLE_VERTICES_QUICK : ORACLE_VERTICES_MAX };
    for ( int i = 0; i < PAPER_SIZES; ++i )
    {
        table.size_count += options->quick && !( sizes[i].quick_weight > 0.0 ) ? 0 : 1;
        table.lines[i].strands = sizes[i].strands;
        table.lines[i].source_ms = sizes[i].source_ms;
        table.lines[i].source_fps = sizes[i].source_fps;
    }
    return table;
}

wisp_status paper_frozen_hair( const bench_options* options, results* out, wisp_error* error )
{
    paper_table table = empty_table( options );
    double deadline = wisp_clock_seconds() + bench_seconds( options );
    wisp_status status = WISP_OK;
    for ( int i = 0; i < table.size_count && status == WISP_OK; ++i )
    {
        char what[64];
        snprintf( what, sizeof( what ), "paper, %d strands", sizes[i].strands );
        bench_progress( options, (double)i / table.size_count, what );

        paper_comparison comparison = { 0 };
        status = run_comparison( &table, &comparison, &table.lines[i], options->quick, deadline,
                                 fraction_of_rest( i, options->quick ), out, error );
        if ( status == WISP_OK )
        {
            table.clump_radius = (double)comparison.scene.def.clump_radius;
        }
        leave( &table, &comparison );
    }
    if ( status == WISP_OK )
    {
        paper_report( &table, out );
    }
    return status;
}
