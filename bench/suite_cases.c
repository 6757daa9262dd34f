// Cases that are suites, and what they claim of their rows.
#include "suite_cases.h"

#include "accuracy/accuracy.h"
#include "bench.h"
#include "bench_output.h"
#include "program_data.h"
#include "suite_study.h"
#include "surfaces.h"
#include "render.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- cloth ----

wisp_status cloth_bench( const bench_options* options, results* out, wisp_error* error )
{
    return suite_bench_folder( "cloth", bench_seconds( options ), options, out, error );
}

// ---- figures ----

// Figures of the papers: rows with checks, and what the accuracy of an implicit step costs.

wisp_status figures_bench( const bench_options* options, results* out, wisp_error* error )
{
    return suite_bench_folder( "figures", bench_seconds( options ), options, out, error );
}

// ---- balloon ----

// The case `balloon`: the suites in data/suites/balloon, and what their rows must keep.

#define CLAIM_FLAT 1.4
#define CLAIM_VOLUME_NS 2.0
#define CLAIM_VOLUME_TRIANGLES 5000
// Time goes with vertices to this power, at least and at most. A fitted line of time would tell nothing: its coefficient of
// determination is that of the largest mesh alone.
#define LEAST_POWER 0.85
#define MOST_POWER 1.15

// The skin compresses the gas, at fill 1.2 by 2.5 % of its volume; the volume itself must be within 1 %.
#define TOLERATED_VOLUME 3.5 // %

enum
{
    SIZES_MAX = 8,
};

static const char sizes_suite[] = "suite.sizes", sphere_rows[] = "sphere, vertices=";

// @return 0: a row of another suite
static double vertices_of( const results_row* row )
{
    const size_t length = strlen( sphere_rows );
    return strcmp( row->name, sizes_suite ) == 0 && strncmp( row->variant, sphere_rows, length ) == 0
               ? strtod( row->variant + length, NULL )
               : 0.0;
}

static double ns_a_vertex( const results_row* row )
{
    return 1e6 * row->ms_median / ( vertices_of( row ) * BALLOON_SUBSTEPS );
}

static double triangles_of( const results_row* row )
{
    return 2.0 * vertices_of( row ) - 4.0; // closed, without holes
}

static double ns_a_triangle( const results_row* row )
{
    double ms = NAN;
    for ( int i = 0; i < row->stages.count; ++i )
    {
        ms = strcmp( row->stages.items[i].name, "balloon.volume" ) == 0 ? row->stages.items[i].value : ms;
    }
    return 1e6 * ms / ( triangles_of( row ) * BALLOON_SUBSTEPS * BALLOON_ITERATIONS );
}

// ---- claims and checks ----

static void claim_flatness( int first_row, int workers, results* out )
{
    double least = INFINITY, most = 0.0, vertices[SIZES_MAX], ms[SIZES_MAX]; // logarithms
    int count = 0;
    for ( int i = first_row; i < out->row_count && count < SIZES_MAX; ++i )
    {
        const results_row* row = &out->rows[i];
        if ( vertices_of( row ) > 0.0 && row->workers == workers )
        {
            least = fmin( least, ns_a_vertex( row ) );
            most = fmax( most, ns_a_vertex( row ) );
            vertices[count] = log( vertices_of( row ) );
            ms[count++] = log( row->ms_p10 ); // of the steps that others on the machine disturbed least
        }
    }
    char claim[160];
    snprintf( claim, sizeof claim, "balloon, ns per vertex and substep with %d %s are flat within %.0f %%", workers,
              bench_workers_word( workers ), 100.0 * ( CLAIM_FLAT - 1.0 ) );
    results_add_claim( out, most <= CLAIM_FLAT * least, claim, 100.0 * ( most / least - 1.0 ), " % apart" );
    if ( count > 2 )
    {
        const double power = stats_fit_line( vertices, ms, count ).slope;
        const bool is_linear = power > LEAST_POWER && power < MOST_POWER;
        snprintf( claim, sizeof claim, "balloon, time with %d %s goes with vertices to the power %.2f to %.2f",
                  workers, bench_workers_word( workers ), LEAST_POWER, MOST_POWER );
        results_add_claim( out, is_linear, claim, power, "" );
    }
}

static void claim_volume( int first_row, results* out )
{
    double most = 0.0;
    for ( int i = first_row; i < out->row_count; ++i )
    {
        const results_row* row = &out->rows[i];
        const bool counts = row->workers == 1 && triangles_of( row ) > CLAIM_VOLUME_TRIANGLES;
        most = counts ? fmax( most, ns_a_triangle( row ) ) : most;
    }
    if ( most > 0.0 )
    {
        char claim[160];
        snprintf( claim, sizeof claim, "volume, gradient and push, with 1 worker above %d triangles is under %.0f ns",
                  CLAIM_VOLUME_TRIANGLES, CLAIM_VOLUME_NS );
        results_add_claim( out, most < CLAIM_VOLUME_NS, claim, most, " ns a triangle" );
    }
}

static void check_volume( const results_row* row, results* out )
{
    const double volume = rows_error( row, "volume_error_percent" ), halted = rows_error( row, "halted_at_step" );
    if ( strcmp( row->name, sizes_suite ) == 0 && ( !( fabs( volume ) <= TOLERATED_VOLUME ) || halted > 0.0 ) )
    {
        results_add_failure( out,
                             "Balloon, %s: the volume differs from that of the gas by %.2f %%, or it was halted.",
                             row->variant, volume );
    }
}

void balloon_conclude( int first_row, int workers, results* out )
{
    claim_volume( first_row, out );
    claim_flatness( first_row, 1, out );
    if ( workers > 1 )
    {
        claim_flatness( first_row, workers, out );
    }
    for ( int i = first_row; i < out->row_count; ++i )
    {
        check_volume( &out->rows[i], out );
    }
}

bench_case_fn balloon_bench;

wisp_status balloon_bench( const bench_options* options, results* out, wisp_error* error )
{
    const int first_row = out->row_count;
    const wisp_status status = suite_bench_folder( "balloon", 0.8 * bench_seconds( options ), options, out, error );
    if ( status == WISP_OK )
    {
        balloon_conclude( first_row, options->workers, out );
    }
    return status;
}

// ---- contact ----

// The case `contact`: the suites in data/suites/contact, of what accuracy costs, and how balloons press on each other (extensions, not in
// the papers).

// From this time in seconds on, the cloth folds on a fine mesh, too.
#define FINE_SECONDS 240.0

// ---- what contact promises ----

/// The most that a value of some rows may be.
typedef struct promise
{
    const char *suite, *beginning, *value; ///< of the rows' name, of their variant, of the error; "": all variants
    double most;
} promise;

static const promise promises[] = {
    { "suite.levels", "fold, exact", "max_intersections", 0.0 },
    { "suite.levels", "stack, exact", "max_intersections", 0.0 },
    { "suite.levels", "towel, exact", "max_intersections", 0.0 },
    { "suite.cost", "exact, margin=", "max_intersections", 0.0 },
    { "suite.motion", "ball", "max_intersections", 0.0 },
    { "suite.motion", "a quarter", "max_intersections", 0.0 },
    { "suite.motion", "half", "max_intersections", 0.0 },
    { "suite.motion", "its pace", "max_intersections", 0.0 },
    { "suite.motion", "twice", "max_intersections", 0.0 },
    { "suite.fine", "exact", "max_intersections", 0.0 },
    { "suite.pair", "exact", "max_overlap_mm", 1.5 }, // a hundredth of the radius
    { "suite.stack", "exact", "max_overlap_mm", 1.5 },
    { "suite.cost", "", "halted_at_step", 0.0 },
    { "suite.motion", "", "halted_at_step", 0.0 },
    { "suite.pair", "", "halted_at_step", 0.0 },
    { "suite.stack", "", "halted_at_step", 0.0 },
    { "suite.fine", "", "halted_at_step", 0.0 },
    // each row gives one side what it takes from the other; sums of a hundred thousand products in double remain
    { "suite.pair", "", "net_impulse_N_s", 1e-9 },
    { "suite.stack", "", "net_impulse_N_s", 1e-9 },
};

static void check_promise( const promise* p, const results_row* row, results* out )
{
    const double value = rows_error( row, p->value );
    if ( strcmp( row->name, p->suite ) == 0 && strncmp( row->variant, p->beginning, strlen( p->beginning ) ) == 0 &&
         value > p->most )
    {
        results_add_failure( out, "Contact, %s, %s, %d %s: %s is %.3g, expected at most %g.", row->name, row->variant,
                             row->workers, bench_workers_word( row->workers ), p->value, value, p->most );
    }
}

void contact_check_suites( int first_row, results* out )
{
    for ( int i = first_row; i < out->row_count; ++i )
    {
        for ( int k = 0; k < WISP_COUNT( promises ); ++k )
        {
            check_promise( &promises[k], &out->rows[i], out );
        }
    }
}

// ---- suites ----

static double mean_ms_of( const results_row* row )
{
    for ( int i = 0; i < row->stages.count; ++i )
    {
        if ( strcmp( row->stages.items[i].name, "mean" ) == 0 )
        {
            return row->stages.items[i].value;
        }
    }
    return NAN;
}

static double intersected_steps_of( const results_row* row )
{
    return rows_error( row, "steps_with_intersections" );
}

static void add_contact_chart( int workers, int first_row, results* out )
{
    rows_chart_add( &( rows_chart ){ .first_row = first_row,
                                     .name = "suite.cost",
                                     .workers = workers,
                                     .title = "Contact, the cost of accuracy: a cloth that folds on itself",
                                     .x_label = "ms per step, mean",
                                     .y_label = "steps that end with intersections",
                                     .caption = "Ringed: no other way is both faster and more accurate.",
                                     .x = mean_ms_of,
                                     .y = intersected_steps_of,
                                     .y_linear = true,
                                     .is_front = true },
                    out );
}

bench_case_fn contact_bench;

wisp_status contact_bench( const bench_options* options, results* out, wisp_error* error )
{
    const int first_row = out->row_count;
    // the last one is left out where there is not enough time
    static const char* const names[] = { "levels", "cost", "motion", "pair", "stack", "fine" };
    const bool is_fine = bench_seconds( options ) >= FINE_SECONDS;
    const wisp_status status = suite_bench_names( "contact", names, WISP_COUNT( names ) - ( is_fine ? 0 : 1 ),
                                                  0.6 * bench_seconds( options ), options, out, error );
    if ( status == WISP_OK )
    {
        contact_check_suites( first_row, out );
        add_contact_chart( options->workers > 1 ? options->workers : 1, first_row, out );
    }
    if ( status == WISP_OK && !is_fine )
    {
        results_add_note( out, "Contact: the fine cloth, data/suites/contact/fine.yaml, needs --seconds %g.",
                          FINE_SECONDS );
    }
    return status;
}

// ---- strands ----

// The case `strands`: the suites in data/suites/strands, by size, settings and energy; guides and ghosts against full simulation
// (extension, not in Park and Kim 2024).

// Below this time in seconds the largest suite is left out.
#define MILLION_SECONDS 40.0

#define CLAIM_FRAME_MS 5.0

static void add_claims( const results_row* row, results* out )
{
    static const char claim[] = "a million ghost vertices per frame, 1 : 16, 2 workers";
    char text[160];
    double ghosts = 0.0;
    for ( int i = 0; i < row->stages.count; ++i )
    {
        ghosts += strncmp( row->stages.items[i].name, "guide_hair.", 11 ) == 0 ? row->stages.items[i].value : 0.0;
    }
    snprintf( text, sizeof text, "%s, guides included: under %.0f ms", claim, CLAIM_FRAME_MS );
    results_add_claim( out, row->ms_median < CLAIM_FRAME_MS, text, row->ms_median, " ms" );
    snprintf( text, sizeof text, "%s, the ghosts alone: under %.0f ms", claim, CLAIM_FRAME_MS );
    results_add_claim( out, ghosts < CLAIM_FRAME_MS, text, ghosts, " ms" );
}

void strands_claim_million( int first_row, results* out )
{
    for ( int i = first_row; i < out->row_count; ++i )
    {
        const results_row* row = &out->rows[i];
        if ( strcmp( row->name, "accuracy.million" ) == 0 && strcmp( row->variant, "1 : 16" ) == 0 &&
             row->workers == 2 )
        {
            add_claims( row, out );
        }
    }
}

bench_case_fn strands_bench;

wisp_status strands_bench( const bench_options* options, results* out, wisp_error* error )
{
    static const char* const names[] = {
        "sizes", "bend_links", "rods", "energy", "guides", "guides_16384", "million"
    };
    const int first_row = out->row_count;
    const bool is_full = bench_seconds( options ) >= MILLION_SECONDS;
    const wisp_status status = suite_bench_names( "strands", names, WISP_COUNT( names ) - ( is_full ? 0 : 1 ),
                                                  0.75 * bench_seconds( options ), options, out, error );
    strands_claim_million( first_row, out );
    if ( !is_full )
    {
        results_add_note( out, "Strands: short of time, the head with a million vertices is left out." );
    }
    return status;
}

// ---- scenes ----

// The case `scenes`: whole steps of the scenes of data/suites/scenes.yaml, and what two workers give to loops that share nothing.

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
        results_cells row = { .count = 0 };
        cells_put( &row, "%s, %s", loops[i][0].name, when );
        for ( int w = 0; w < WORKERS; ++w )
        {
            char variant[64];
            cells_put( &row, "%.3f", ms[i][w].median );
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
        cells_put( &row, "%.2f", ms[i][0].median / ms[i][1].median );
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
    uint64_t* words = malloc( BLOCKS * WORDS_EACH * sizeof *words );
    if ( words == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a loop that reads 64 MiB" );
    }
    for ( size_t i = 0; i < BLOCKS * WORDS_EACH; ++i )
    {
        words[i] = i;
    }
    const int table = results_begin_table( out, "What two workers give to trivial loops that share nothing",
                                           "loop\t1 worker ms\t2 workers ms\tspeed-up" );
    bench_options rest = *options;
    rest.seconds = bench_seconds( options ) - 3.0 > 0.0 ? bench_seconds( options ) - 3.0 : 1e-3;
    program_data_path( "suites/scenes.yaml", path, sizeof path );
    wisp_status status = measure_loops( words, "before the scenes", table, out, error );
    status = status == WISP_OK ? suite_bench( path, &rest, out, error ) : status;
    status = status == WISP_OK ? measure_loops( words, "after the scenes", table, out, error ) : status;
    free( words );
    return status;
}

// ---- effects ----

// The case `effects`: what each effect adds to the links of the same cloth. The case `character`: the dressed figure without each effect.

bench_case_fn effects_bench, character_bench;

static wisp_status bench_file( const char* name, const bench_options* options, results* out, wisp_error* error )
{
    char path[1024];
    program_data_path( name, path, sizeof path );
    return suite_bench( path, options, out, error );
}

wisp_status effects_bench( const bench_options* options, results* out, wisp_error* error )
{
    return bench_file( "suites/effect_costs.yaml", options, out, error );
}

wisp_status character_bench( const bench_options* options, results* out, wisp_error* error )
{
    return bench_file( "suites/character.yaml", options, out, error );
}
