// The case `scenes`: whole steps of the scenes of data/suites/scenes.yaml, and what two workers give to loops that share nothing.
#include "accuracy/accuracy.h"
#include "bench_timing.h"
#include "cells.h"
#include "program_data.h"
#include "render.h"

#include <stdlib.h>

bench_case_fn scenes_bench;

enum
{
    BLOCKS = 32,
    ROUNDS = 24,
    LOOPS = 3,
    CHAINS = 8,
    WORKERS = 2,
};

// A loop that any number of workers can share: each block is of its own words, and gives a number that says it was done. One
// chain of operations waits for each result; several fill the units of a core. Where two workers are two threads of one core,
// they do twice the work of the former, but not of the latter, and steps of scenes are like the latter.
typedef struct loop
{
    const char* name;
    const uint64_t* words; // [BLOCKS][words_each]; null: the loop computes without memory
    size_t words_each;
    int turns_each;
    bool fills; // with CHAINS chains, else one
    int workers;
    uint64_t sums[BLOCKS];
} loop;

// Words of a block, 64 MiB in all: more than caches hold.
static const size_t WORDS_EACH = ( (size_t)64 << 20 ) / sizeof( uint64_t ) / BLOCKS;
static const int TURNS_EACH = 100000;

static void run_block( void* context, int block, int worker )
{
    (void)worker;
    loop* l = context;
    uint64_t chains[CHAINS], sum = 0;
    const int chain_count = l->fills ? CHAINS : 1;
    for ( int c = 0; c < chain_count; ++c )
    {
        chains[c] = (uint64_t)( CHAINS * block + c + 1 );
    }
    for ( int i = 0; i < l->turns_each; ++i )
    {
        for ( int c = 0; c < chain_count; ++c )
        {
            chains[c] = chains[c] * 6364136223846793005u + 1442695040888963407u;
        }
    }
    for ( int c = 0; c < chain_count; ++c )
    {
        sum += chains[c];
    }
    for ( size_t i = 0; i < l->words_each; ++i )
    {
        sum += l->words[(size_t)block * l->words_each + i];
    }
    l->sums[block] = sum;
}

static wisp_status step_loop( void* context, wisp_error* error )
{
    (void)error;
    loop* l = context;
    threads_parallel_for( &l->workers, BLOCKS, run_block, l );
    return WISP_OK;
}

static uint64_t sum_of( const loop* l )
{
    uint64_t sum = 0;
    for ( int i = 0; i < BLOCKS; ++i )
    {
        sum = sum * 31 + l->sums[i];
    }
    return sum;
}

static void add_loops( loop loops[LOOPS][WORKERS], stats_summary ms[LOOPS][WORKERS], const char* when, int table,
                       results* out )
{
    for ( int i = 0; i < LOOPS; ++i )
    {
        cells row = { .count = 0 };
        cells_put( &row, "%s, %s", loops[i][0].name, when );
        for ( int w = 0; w < WORKERS; ++w )
        {
            char variant[64];
            cells_put_number( &row, ms[i][w].median, 3 );
            snprintf( variant, sizeof variant, "%s, %s", loops[i][w].name, when );
            results_row* machine = results_add_row( out, "scenes.loop", variant );
            if ( machine )
            {
                machine->workers = loops[i][w].workers;
                results_put_times( machine, &ms[i][w] );
                machine->hash = sum_of( &loops[i][w] );
                machine->has_hash = true;
            }
        }
        cells_put_number( &row, ms[i][0].median / ms[i][1].median, 2 );
        cells_end_row( &row, table, out );
        if ( sum_of( &loops[i][0] ) != sum_of( &loops[i][1] ) )
        {
            results_add_failure( out, "scenes: the loop '%s' has another sum with two workers", loops[i][0].name );
        }
    }
}

// One worker and two take turns in each loop.
static wisp_status measure_loops( const uint64_t* words, const char* when, int table, results* out,
                                  wisp_error* error )
{
    loop loops[LOOPS][WORKERS];
    bench_variant variants[LOOPS * WORKERS];
    stats_summary ms[LOOPS][WORKERS];
    const bench_effort effort = { .seconds = 1.0, .rounds_min = 3, .samples_max = ROUNDS };
    for ( int w = 0; w < WORKERS; ++w )
    {
        loops[0][w] = ( loop ){ .name = "arithmetic that waits", .turns_each = TURNS_EACH, .workers = w + 1 };
        loops[1][w] = ( loop ){
            .name = "arithmetic that fills a core", .turns_each = TURNS_EACH, .fills = true, .workers = w + 1
        };
        loops[2][w] =
            ( loop ){ .name = "reads of 64 MiB", .words = words, .words_each = WORDS_EACH, .workers = w + 1 };
    }
    for ( int i = 0; i < LOOPS * WORKERS; ++i )
    {
        loop* l = &loops[i / WORKERS][i % WORKERS];
        variants[i] = ( bench_variant ){ .name = l->name, .step = step_loop, .context = l };
    }
    const wisp_status status = bench_interleave( variants, LOOPS * WORKERS, &effort, error );
    for ( int i = 0; i < LOOPS * WORKERS && status == WISP_OK; ++i )
    {
        ms[i / WORKERS][i % WORKERS] = bench_summarise( &variants[i] );
    }
    if ( status == WISP_OK )
    {
        add_loops( loops, ms, when, table, out );
    }
    bench_free_samples( variants, LOOPS * WORKERS );
    return status;
}

wisp_status scenes_bench( const bench_options* options, results* out, wisp_error* error )
{
    char path[1024];
    cells header = { .count = 0 };
    uint64_t* words = malloc( BLOCKS * WORDS_EACH * sizeof *words );
    if ( words == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a loop that reads 64 MiB" );
    }
    for ( size_t i = 0; i < BLOCKS * WORDS_EACH; ++i )
    {
        words[i] = i;
    }
    cells_put( &header, "loop" );
    cells_put( &header, "1 worker ms" );
    cells_put( &header, "2 workers ms" );
    cells_put( &header, "speed-up" );
    const int table = cells_begin_table( &header, "What two workers give to trivial loops that share nothing", out );
    bench_options rest = *options;
    rest.seconds = bench_seconds( options ) - 3.0 > 0.0 ? bench_seconds( options ) - 3.0 : 1e-3;
    program_data_path( "suites/scenes.yaml", path, sizeof path );
    wisp_status status = measure_loops( words, "before the scenes", table, out, error );
    status = status == WISP_OK ? suite_bench( path, &rest, out, error ) : status;
    status = status == WISP_OK ? measure_loops( words, "after the scenes", table, out, error ) : status;
    free( words );
    return status;
}
