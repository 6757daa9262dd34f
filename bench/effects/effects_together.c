// Effects in worlds of their own, and together in one: their costs add up, and each keeps its bits.
#include "effects/effects_bench.h"

#include "cells.h"
#include "machine.h"
#include "stats.h"
#include "bench_timing.h"

#include <math.h>
#include <stdlib.h>

#define PARTS 4
#define TOLERANCE 0.10 ///< tolerance relative to the sum

static const char* const part_names[PARTS] = { "cloth", "balloon", "strands", "frozen_hair" };

// A world, and the processor time of its last steps. It has one worker, so that is the whole cost of a step, without
// other processes.
typedef struct implementation_world
{
    effect_world* world;
    double* ms; // [room], the oldest are overwritten
    int count, room;
} implementation_world;

// Implementations 0 to PARTS - 1 are alone, the last one is all of them.
typedef struct gathering
{
    int effects[PARTS];
    implementation_world worlds[PARTS + 1];
    bench_variant variants[PARTS + 1];
    stats_summary ms[PARTS + 1], processor[PARTS + 1];
    uint64_t alone[PARTS], beside[PARTS]; // hashes of the same entity
    int passes[PARTS + 1];
} gathering;

static wisp_status timed_step( void* context, wisp_error* error )
{
    implementation_world* implementation = context;
    const double start = machine_cpu_seconds();
    const wisp_status status = effect_world_step( implementation->world, error );
    implementation->ms[implementation->count++ % implementation->room] = 1e3 * ( machine_cpu_seconds() - start );
    return status;
}

static wisp_status open_world( const effects_plan* plan, gathering* g, int implementation, wisp_error* error )
{
    const bool is_all = implementation == PARTS;
    const effect_world_def def = {
        .all = plan->all,
        .chosen = g->effects + ( is_all ? 0 : implementation ),
        .count = is_all ? PARTS : 1,
        .is_on = true,
        .size = plan->together,
    };
    wisp_status status = effect_world_open( &def, &g->worlds[implementation].world, error );
    effect_world* world = g->worlds[implementation].world;
    g->worlds[implementation].room = plan->samples_max;
    g->worlds[implementation].ms = malloc( (size_t)plan->samples_max * sizeof( double ) );
    if ( status == WISP_OK && g->worlds[implementation].ms == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the times of effects together" );
    }
    for ( int i = 0; i < plan->steps && status == WISP_OK; ++i )
    {
        status = effect_world_step( world, error );
    }
    for ( int i = 0; i < def.count && status == WISP_OK; ++i )
    {
        status = effect_world_hash( world, i, is_all ? g->beside + i : g->alone + implementation, error );
    }
    char names[EFFECT_PLAN_MAX];
    status = status == WISP_OK ? effect_world_plan( world, names, g->passes + implementation, error ) : status;
    g->variants[implementation] = ( bench_variant ){
        .name = is_all ? "together" : part_names[implementation],
        .step = timed_step,
        .context = g->worlds + implementation,
    };
    return status;
}

static void add_line( gathering* g, int implementation, double sum, int table, results* out )
{
    const int vertices = scene_world_vertices( &g->worlds[implementation].world->world );
    cells row = { 0 };
    cells_put( &row, "%s", g->variants[implementation].name );
    cells_put( &row, "%d", vertices );
    cells_put( &row, "%d", g->passes[implementation] );
    cells_put_number( &row, g->ms[implementation].median, 4 );
    cells_put_number( &row, 100.0 * g->ms[implementation].median / sum, 1 );
    cells_put_number( &row, g->processor[implementation].median, 4 );
    cells_put( &row, "%s",
               implementation == PARTS                                 ? "-"
               : g->alone[implementation] == g->beside[implementation] ? "yes"
                                                                       : "NO" );
    cells_end_row( &row, table, out );

    char variant[64];
    snprintf( variant, sizeof( variant ), "together: %s",
              implementation == PARTS ? "all" : part_names[implementation] );
    results_row* record = results_add_row( out, "effects", variant );
    if ( record != NULL )
    {
        results_put( &record->size, "vertices", vertices );
        results_put( &record->size, "passes", g->passes[implementation] );
        record->workers = 1;
        results_put_times( record, &g->ms[implementation] );
        record->hash = implementation == PARTS ? 0 : g->alone[implementation];
        record->has_hash = implementation < PARTS;
    }
}

static void conclude( gathering* g, results* out )
{
    static const char* const HEADER[] = {
        "world", "vertices", "passes", "ms", "% of the sum", "ms of the processor", "same bits in one world"
    };
    const int table = results_add_table( out, "Effects: a world of four, and each alone, one worker",
                                         WISP_COUNT( HEADER ), HEADER );
    double sum = 0.0, processor = 0.0;
    for ( int i = 0; i < PARTS; ++i )
    {
        sum += g->ms[i].median;
        processor += g->processor[i].median;
    }
    for ( int i = 0; i <= PARTS; ++i )
    {
        add_line( g, i, sum, table, out );
    }
    for ( int i = 0; i < PARTS; ++i )
    {
        if ( g->alone[i] != g->beside[i] )
        {
            results_add_failure( out, "Effects: %s moves differently in one world with others than alone",
                                 part_names[i] );
        }
    }
    const double ratio = g->ms[PARTS].median / sum, used = g->processor[PARTS].median / processor;
    results_add_note( out,
                      "Effects: four alone take %.4f ms in sum, in one world %.4f ms: %.3f of the sum, and %.3f by "
                      "processor time%s",
                      sum, g->ms[PARTS].median, ratio, used,
                      fabs( ratio - 1.0 ) <= TOLERANCE
                          ? "."
                          : ". More than a tenth from 1 is no defect on a shared machine, or where caches hold one "
                            "of them but not all four." );
}

wisp_status effects_together( const effects_plan* plan, results* out, wisp_error* error )
{
    bench_progress( plan->options, 0.7, "effects together" );
    gathering g = { 0 };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < PARTS; ++i )
    {
        g.effects[i] = effects_find( plan->all, part_names[i] );
        WISP_ASSERT( g.effects[i] >= 0 );
    }
    for ( int i = 0; i <= PARTS && status == WISP_OK; ++i )
    {
        status = open_world( plan, &g, i, error );
    }
    const bench_effort effort = { .seconds = 0.5 * plan->seconds, .rounds_min = 3, .samples_max = plan->samples_max };
    status = status == WISP_OK ? bench_interleave( g.variants, PARTS + 1, &effort, error ) : status;
    for ( int i = 0; i <= PARTS && status == WISP_OK; ++i )
    {
        const int kept = g.worlds[i].count < g.worlds[i].room ? g.worlds[i].count : g.worlds[i].room;
        g.ms[i] = bench_summarise( &g.variants[i] );
        g.processor[i] = stats_summarise( g.worlds[i].ms, kept );
    }
    if ( status == WISP_OK )
    {
        snprintf( out->machine.isa, sizeof( out->machine.isa ), "%s",
                  wisp_world_isa( g.worlds[PARTS].world->world.world ) );
        conclude( &g, out );
    }
    bench_free_samples( g.variants, PARTS + 1 );
    for ( int i = 0; i <= PARTS; ++i )
    {
        effect_world_close( g.worlds[i].world );
        free( g.worlds[i].ms );
    }
    return status;
}
