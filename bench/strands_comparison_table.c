// The tables of the race of strands: ours beside other engines, and the kernels alone.
#include "rows_chart.h"
#include "strands_comparison.h"

#include <math.h>
#include <string.h>

/// What others needed on the reference machine (performance notes: two virtual cores of an AVX-512 Xeon at about 3.4
/// GHz, gcc 12.2), each with its best settings for ten passes a step. They cannot be taken again here. NaN: not
/// measured.
typedef struct peer_times
{
    int strands;
    double nvcloth[2]; ///< ms, one and two threads: distances and bends, ten passes
    double rods[2];    ///< ms, PositionBasedDynamics, Cosserat rods
    double jolt[2];    ///< ms, Jolt 5.5, rods
    double bullet;     ///< ms, Bullet 3.24, chains, one thread
} peer_times;

static const peer_times peers[] = {
    { 100, { 0.149, 0.079 }, { NAN, NAN }, { NAN, NAN }, NAN },
    { 500, { 0.716, 0.376 }, { NAN, NAN }, { NAN, NAN }, NAN },
    { 2000, { 3.09, 1.52 }, { 38.9, 22.1 }, { 20.0, 14.0 }, 15.8 },
    { 10000, { 15.6, 8.4 }, { NAN, NAN }, { 114.0, 73.0 }, NAN },
};

// What is claimed, and at which sizes.
#define CLAIM_RATIO 4.0
#define CLAIM_STRETCH 1e-4 // mean
#define CLAIM_KERNEL_SIZE 2000
#define CLAIM_STRETCH_NS 1.2
#define CLAIM_SUBSTEP_NS 2.5
#define CLAIM_SCALING 1.8

static const peer_times* find_peer( int strands )
{
    for ( int i = 0; i < WISP_COUNT( peers ); ++i )
    {
        if ( peers[i].strands == strands )
        {
            return &peers[i];
        }
    }
    return NULL;
}

static double ns( int strands, int substeps, double ms )
{
    return 1e6 * ms / ( (double)strands * STRANDS_VERTICES * substeps );
}

// ---- the race ----

static int begin_table( const strands_plan* plan, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "strands" );
    cells_put( &row, "solver" );
    cells_put( &row, "substeps" );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        cells_put( &row, "%d %s ms", plan->workers[w], bench_workers_word( plan->workers[w] ) );
        cells_put( &row, "p10 .. p90" );
        cells_put( &row, "%d %s ns per vertex and substep", plan->workers[w],
                   bench_workers_word( plan->workers[w] ) );
    }
    cells_put( &row, "stretch %%, max / mean" );
    cells_put( &row, "error %%" );
    cells_put( &row, "strand resets" );
    cells_put( &row, "hash" );
    cells_put( &row, "NvCloth 1 / 2 threads ms*" );
    cells_put( &row, "PBD rods 1 / 2 threads ms*" );
    cells_put( &row, "Jolt rods 1 / 2 threads ms*" );
    cells_put( &row, "Bullet chains ms*" );
    return cells_begin_table( &row, "Strands x 20 vertices, root pinned, horizontal start, 1/60 s, stretch + bend",
                              out );
}

static void put_times( const strands_plan* plan, int strands, int substeps, const strands_line* line, cells* row )
{
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        const stats_summary* ms = &line->ms[w];
        if ( line->halted_at > 0 )
        {
            cells_put( row, "halted at step %d", line->halted_at );
            cells_put( row, "-" );
            cells_put( row, "-" );
            continue;
        }
        cells_put_number( row, ms->median, 4 );
        cells_put( row, "%.4f .. %.4f", ms->p10, ms->p90 );
        cells_put_number( row, ns( strands, substeps, ms->median ), 2 );
    }
}

static void put_errors( const strands_line* line, cells* row )
{
    cells_put_pair( row, 100.0 * line->stretch_max, 5, 100.0 * line->stretch_mean, 5 );
    cells_put_number( row, 100.0 * line->error, 4 );
}

static void put_peers( const peer_times* peer, cells* row )
{
    cells_put_pair( row, peer ? peer->nvcloth[0] : NAN, 3, peer ? peer->nvcloth[1] : NAN, 3 );
    cells_put_pair( row, peer ? peer->rods[0] : NAN, 1, peer ? peer->rods[1] : NAN, 1 );
    cells_put_pair( row, peer ? peer->jolt[0] : NAN, 1, peer ? peer->jolt[1] : NAN, 1 );
    cells_put_number( row, peer ? peer->bullet : NAN, 1 );
}

static void add_line( const strands_plan* plan, const strands_comparison_size* size, int s, int table, results* out )
{
    const strands_setting* setting = &strands_comparison_settings[s];
    const strands_line* line = &size->ours[s];
    cells row = { .count = 0 };
    cells_put( &row, "%d", size->strands );
    cells_put( &row, "%s", setting->name );
    cells_put( &row, "%d", setting->substeps );
    put_times( plan, size->strands, setting->substeps, line, &row );
    put_errors( line, &row );
    cells_put( &row, "%llu", (unsigned long long)line->laid );
    cells_put_hash( &row, line->hash );
    put_peers( setting->bend == WISP_STRAND_BEND_LINKS && s == 0 ? find_peer( size->strands ) : NULL, &row );
    cells_end_row( &row, table, out );
}

// ---- rows for machines ----

static void put_row( int strands, const char* variant, int substeps, const strands_line* line, int w, int workers,
                     results* out )
{
    results_row* row = results_add_row( out, "strands.race", variant );
    if ( !row )
    {
        return;
    }
    results_put( &row->size, "strands", strands );
    results_put( &row->size, "vertices", (double)strands * STRANDS_VERTICES );
    results_put( &row->size, "substeps", substeps );
    row->workers = workers;
    results_put_times( row, &line->ms[w] );
    snprintf( row->error_reference, sizeof( row->error_reference ), "%d substeps", STRANDS_REFERENCE_SUBSTEPS );
    results_put( &row->error, "stretch_max", line->stretch_max );
    results_put( &row->error, "stretch_mean", line->stretch_mean );
    results_put( &row->error, "rms_share_of_length", line->error );
    row->hash = line->hash;
    row->has_hash = true;
}

static void put_rows( const strands_plan* plan, const strands_comparison_size* size, results* out )
{
    for ( int s = 0; s < size->setting_count; ++s )
    {
        for ( int w = 0; w < plan->worker_count; ++w )
        {
            const strands_setting* setting = &strands_comparison_settings[s];
            put_row( size->strands, setting->name, setting->substeps, &size->ours[s], w, plan->workers[w], out );
            const strands_kernel_times* kernels = &size->kernels[s];
            for ( int p = 0; p < kernels->pass_count && out->row_count > 0; ++p )
            {
                results_put( &out->rows[out->row_count - 1].stages, kernels->passes[p].name,
                             1e3 * kernels->passes[p].seconds[w] );
            }
        }
    }
}

// ---- kernels ----

static void add_kernels( const strands_plan* plan, const strands_comparison_size* size, results* out )
{
    cells header = { .count = 0 };
    cells_put( &header, "solver" );
    cells_put( &header, "substeps" );
    cells_put( &header, "pass" );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        cells_put( &header, "%d %s ns", plan->workers[w], bench_workers_word( plan->workers[w] ) );
    }
    char title[160];
    snprintf( title, sizeof( title ), "Kernels alone: ns per vertex and substep, %d strands x 20, from the profile",
              size->strands );
    int table = cells_begin_table( &header, title, out );
    for ( int s = 0; s < size->setting_count; ++s )
    {
        const strands_setting* setting = &strands_comparison_settings[s];
        const strands_kernel_times* kernels = &size->kernels[s];
        for ( int p = 0; p <= kernels->pass_count; ++p )
        {
            bool is_sum = p == kernels->pass_count;
            cells row = { .count = 0 };
            cells_put( &row, "%s", setting->name );
            cells_put( &row, "%d", setting->substeps );
            cells_put( &row, "%s", is_sum ? "the whole step" : kernels->passes[p].name );
            for ( int w = 0; w < plan->worker_count; ++w )
            {
                double ms = is_sum ? size->ours[s].ms[w].median : 1e3 * kernels->passes[p].seconds[w];
                cells_put_number( &row, ns( size->strands, setting->substeps, ms ), 3 );
            }
            cells_end_row( &row, table, out );
        }
    }
}

static double pass_ns( const strands_comparison_size* size, int setting, const char* name, int w )
{
    const strands_kernel_times* kernels = &size->kernels[setting];
    for ( int p = 0; p < kernels->pass_count; ++p )
    {
        if ( strcmp( kernels->passes[p].name, name ) == 0 )
        {
            return ns( size->strands, strands_comparison_settings[setting].substeps,
                       1e3 * kernels->passes[p].seconds[w] );
        }
    }
    return NAN;
}

// ---- claims ----

static void claim_kernels( const strands_plan* plan, const strands_comparison_size* size, results* out )
{
    char claim[160];
    for ( int s = 0; s < size->setting_count; ++s )
    {
        const strands_setting* setting = &strands_comparison_settings[s];
        // passes end early where strands are exact, so one is measured where no second is allowed
        if ( setting->stretch == WISP_STRAND_STRETCH_DIRECT && setting->passes == 1 )
        {
            double stretch = pass_ns( size, s, "strands.stretch", 0 );
            snprintf(
                claim, sizeof( claim ),
                "%d strands, 1 worker: a Newton pass of the tridiagonal stretch costs at most %.1f ns per vertex",
                size->strands, CLAIM_STRETCH_NS );
            results_add_claim( out, stretch <= CLAIM_STRETCH_NS, claim, stretch, " ns" );
        }
        double whole = ns( size->strands, setting->substeps, size->ours[s].ms[0].median );
        snprintf( claim, sizeof( claim ),
                  "%d strands, 1 worker, %s, %d substeps: a whole substep costs at most %.1f ns per vertex",
                  size->strands, setting->name, setting->substeps, CLAIM_SUBSTEP_NS );
        results_add_claim( out, whole <= CLAIM_SUBSTEP_NS, claim, whole, " ns" );
    }
    if ( plan->worker_count > 1 )
    {
        double scaling = size->ours[0].ms[0].median / size->ours[0].ms[1].median;
        snprintf( claim, sizeof( claim ), "%d strands: %d workers are %.1f times faster than one", size->strands,
                  plan->workers[1], CLAIM_SCALING );
        results_add_claim( out, scaling >= CLAIM_SCALING, claim, scaling, " times" );
    }
}

// The stretch is no matter of speed: it must hold everywhere.
static void check_stretch( const strands_comparison_size* size, results* out )
{
    if ( !( size->ours[0].stretch_mean < CLAIM_STRETCH ) )
    {
        results_add_failure( out, "%d strands, %s: mean stretch of %.4f %%, more than %.2f %%.", size->strands,
                             strands_comparison_settings[0].name, 100.0 * size->ours[0].stretch_mean,
                             100.0 * CLAIM_STRETCH );
    }
}

static void claim_peers( const strands_plan* plan, const strands_comparison_size* size, results* out )
{
    const peer_times* peer = find_peer( size->strands );
    if ( peer && plan->worker_count > 1 && ( size->strands == 2000 || size->strands == 10000 ) )
    {
        double ratio = peer->nvcloth[1] / size->ours[0].ms[1].median;
        char claim[160];
        snprintf( claim, sizeof( claim ),
                  "%d strands, %s, %d workers: at least %.0f times faster than NvCloth with 2 threads", size->strands,
                  strands_comparison_settings[0].name, plan->workers[1], CLAIM_RATIO );
        results_add_claim( out, ratio >= CLAIM_RATIO, claim, ratio, " times" );
    }
}

static void add_notes( const strands_plan* plan, results* out )
{
    results_add_note( out, "* on another machine: two virtual cores of an AVX-512 Xeon at 3.4 GHz, gcc 12.2, best "
                           "settings of each engine for ten passes per step of 1/60 s." );
    results_add_note( out, "* NvCloth's strands stretch 7.6 %% at most and 2.4 %% in the mean. Claims against "
                           "NvCloth compare with these constants and hold on that machine only." );
    results_add_note( out,
                      "Strands: every strand has its own direction, %.2f m per segment, hair of 80 um. Stretch is "
                      "the mean of samples every 5 steps of up to %d steps.",
                      (double)STRANDS_SPACING, plan->scenario_steps );
    results_add_note( out,
                      "Strands: the reference is the same scene with direct stretch and the same bend, %d substeps, "
                      "at %d steps of 1/60 s (later the motion is chaotic): root mean square distance of the first "
                      "%d strands in %% of their length.",
                      STRANDS_REFERENCE_SUBSTEPS, STRANDS_REFERENCE_STEPS, STRANDS_REFERENCE_STRANDS );
}

// ---- charts ----

static double strands_of( const results_row* row )
{
    return rows_size( row, "strands" );
}

static void add_charts( const strands_plan* plan, int first_row, results* out )
{
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        char title[160];
        snprintf( title, sizeof( title ), "Strands x 20 vertices with %d %s: time against size", plan->workers[w],
                  bench_workers_word( plan->workers[w] ) );
        rows_chart_add( &( rows_chart ){ .first_row = first_row,
                                         .name = "strands.race",
                                         .workers = plan->workers[w],
                                         .also = "substeps",
                                         .also_unit = "substeps",
                                         .title = title,
                                         .x_label = "strands",
                                         .y_label = "ms per step",
                                         .x = strands_of,
                                         .y = rows_ms,
                                         .caption = "Along a line of slope 1 the cost per strand is constant." },
                        out );
    }
}

void strands_comparison_write( const strands_plan* plan, const strands_comparison_size* sizes, int count,
                               results* out )
{
    const int first_row = out->row_count;
    int table = begin_table( plan, out );
    for ( int i = 0; i < count; ++i )
    {
        for ( int s = 0; s < sizes[i].setting_count; ++s )
        {
            add_line( plan, &sizes[i], s, table, out );
        }
        put_rows( plan, &sizes[i], out );
        check_stretch( &sizes[i], out );
        claim_peers( plan, &sizes[i], out );
    }
    for ( int i = 0; i < count; ++i )
    {
        if ( sizes[i].strands == CLAIM_KERNEL_SIZE || count == 1 )
        {
            add_kernels( plan, &sizes[i], out );
            claim_kernels( plan, &sizes[i], out );
        }
    }
    add_charts( plan, first_row, out );
    add_notes( plan, out );
}
