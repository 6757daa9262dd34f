// Measure cost and error of guides and ghosts (extension, not in Park and Kim 2024): all strands simulated against 1,
// 4 and 16 ghosts a guide.
#include "strands_bench.h"
#include "strands_head.h"
#include "bench_timing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int ratios[] = { 1, 4, 16 };

#define ROWS_MAX ( 1 + WISP_COUNT( ratios ) )
#define IMPLEMENTATIONS_MAX ( ROWS_MAX * STRANDS_WORKERS_MAX )
#define SAMPLES_MAX 60
#define OBSERVATION_STEPS 5
#define CLAIM_FRAME_MS 5.0
#define MILLION 1000000

/// One way to move the hair: ratio 0 simulates every strand.
typedef struct guides_row
{
    int ratio;
    strands_shape guides;
    double rms, rms_still; // m, to the full simulation: with the ghosts' own sway, and without
    double follow_ms[STRANDS_WORKERS_MAX];
    stats_summary ms[STRANDS_WORKERS_MAX];
    uint64_t hash;
} guides_row;

typedef struct guides_run
{
    int side;
    int first_worker; // of the plan's: a large head is cooked for a long time, so that not all may be wanted
    int worker_count; // from there on
    bool has_still;   // ghosts without sway are compared too
    strands_shape hair;
    guides_row rows[ROWS_MAX];
    int row_count;
    hair_head heads[IMPLEMENTATIONS_MAX]; // [row][worker]
    wisp_vec3* path;                      // [observation][vertex] of the full simulation
    int observation_count;
} guides_run;

static hair_head_generator make_generator( const guides_run* run, const guides_row* row, int workers, bool sways )
{
    hair_head_generator generator = hair_head_default_generator( row->ratio > 0 ? &row->guides : &run->hair );
    generator.ghosts = row->ratio > 0 ? &run->hair : NULL;
    generator.workers = workers;
    if ( !sways )
    {
        generator.follow.elastic = WISP_GHOST_ELASTIC_OFF;
        generator.follow.tip_gain = 0.0f;
        generator.follow.centre_gain = 0.0f;
    }
    return generator;
}

// ---- distance to the full simulation ----

// Shake the head; keep the path if it is that of the full simulation, else compare with it.
static wisp_status shake( guides_run* run, hair_head* head, bool keeps, double* rms, wisp_error* error )
{
    int count = strands_shape_size( &run->hair );
    double squares = 0.0;
    wisp_status status = WISP_OK;
    for ( int observation = 0; observation < run->observation_count && status == WISP_OK; ++observation )
    {
        const wisp_vec3* points = NULL;
        wisp_vec3* there = run->path + (size_t)observation * (size_t)count;
        for ( int s = 0; s < OBSERVATION_STEPS && status == WISP_OK; ++s )
        {
            status = hair_head_step( head, error );
        }
        status = status == WISP_OK ? hair_head_points( head, &points, error ) : status;
        if ( status == WISP_OK && keeps )
        {
            memcpy( there, points, (size_t)count * sizeof( wisp_vec3 ) );
        }
        if ( status == WISP_OK )
        {
            double distance = strands_rms_distance( points, there, count );
            squares += distance * distance;
        }
    }
    *rms = sqrt( squares / run->observation_count );
    return status;
}

static wisp_status shake_without_sway( guides_run* run, guides_row* row, wisp_error* error )
{
    hair_head head = { 0 };
    const hair_head_generator generator = make_generator( run, row, 1, false );
    wisp_status status = hair_head_create( &generator, &head, error );
    status = status == WISP_OK ? shake( run, &head, false, &row->rms_still, error ) : status;
    hair_head_destroy( &head );
    return status;
}

static wisp_status judge( const strands_plan* plan, guides_run* run, results* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < run->row_count * run->worker_count && status == WISP_OK; ++i )
    {
        guides_row* row = &run->rows[i / run->worker_count];
        bool is_first = i % run->worker_count == 0;
        double rms = 0.0;
        uint64_t hash = 0;
        status = shake( run, &run->heads[i], i == 0, &rms, error );
        status = status == WISP_OK ? hair_head_hash( &run->heads[i], &hash, error ) : status;
        row->rms = is_first ? rms : row->rms;
        row->hash = is_first ? hash : row->hash;
        if ( status == WISP_OK && hash != row->hash )
        {
            results_add_failure( out, "%d strands, 1:%d: %d workers give hash %016llx, %d gives %016llx.",
                                 run->hair.strand_count, row->ratio,
                                 plan->workers[run->first_worker + i % run->worker_count], (unsigned long long)hash,
                                 plan->workers[run->first_worker], (unsigned long long)row->hash );
        }
        row->rms_still = run->has_still ? row->rms_still : NAN;
        if ( status == WISP_OK && is_first && row->ratio > 0 && run->has_still )
        {
            status = shake_without_sway( run, row, error );
        }
    }
    return status;
}

// ---- times ----

static double follow_ms( hair_head* head )
{
    double sum = 0.0;
    for ( int i = 0; i < head->profile.pass_count; ++i )
    {
        const char* name = head->profile.passes[i].name;
        bool is_ours = strncmp( name, "guide", 5 ) == 0 || strncmp( name, "ghost", 5 ) == 0;
        sum += is_ours ? 1e3 * profile_samples_median( &head->profile, i ) : 0.0;
    }
    return sum;
}

static wisp_status measure( const strands_plan* plan, guides_run* run, wisp_error* error )
{
    bench_variant variants[IMPLEMENTATIONS_MAX] = { { 0 } };
    int count = run->row_count * run->worker_count;
    for ( int i = 0; i < count; ++i )
    {
        variants[i] = ( bench_variant ){
            .name = "head", .step = hair_head_step, .after = hair_head_keep_profile, .context = &run->heads[i]
        };
    }
    const bench_effort effort = { .seconds = 0.06 * bench_seconds( plan->options ),
                                  .rounds_min = 3,
                                  .samples_max = SAMPLES_MAX };
    wisp_status status = bench_interleave( variants, count, &effort, error );
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        guides_row* row = &run->rows[i / run->worker_count];
        row->ms[run->first_worker + i % run->worker_count] = bench_summarise( &variants[i] );
        row->follow_ms[run->first_worker + i % run->worker_count] = follow_ms( &run->heads[i] );
    }
    bench_free_samples( variants, count );
    return status;
}

// ---- the table ----

static int begin_table( const strands_plan* plan, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "strands x 20" );
    cells_put( &row, "guides : ghosts" );
    cells_put( &row, "guides" );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        cells_put( &row, "%d %s ms", plan->workers[w], bench_workers_word( plan->workers[w] ) );
        cells_put( &row, "%d %s ghosts ms", plan->workers[w], bench_workers_word( plan->workers[w] ) );
        cells_put( &row, "%d %s fraction of all", plan->workers[w], bench_workers_word( plan->workers[w] ) );
    }
    cells_put( &row, "RMS error mm" );
    cells_put( &row, "RMS error without sway mm" );
    cells_put( &row, "hash" );
    return cells_begin_table(
        &row, "Guides and ghosts against full simulation (extension of Park and Kim 2024), head shaken", out );
}

static void add_line( const strands_plan* plan, const guides_run* run, const guides_row* row, int table,
                      results* out )
{
    cells line = { .count = 0 };
    bool has_ghosts = row->ratio > 0;
    cells_put( &line, "%d", run->hair.strand_count );
    cells_put( &line, has_ghosts ? "1 : %d" : "all simulated", row->ratio );
    cells_put( &line, "%d", has_ghosts ? row->guides.strand_count : run->hair.strand_count );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        bool is_known = w >= run->first_worker;
        cells_put_number( &line, is_known ? row->ms[w].median : NAN, 3 );
        cells_put_number( &line, is_known && has_ghosts ? row->follow_ms[w] : NAN, 3 );
        cells_put_number( &line, is_known ? row->ms[w].median / run->rows[0].ms[w].median : NAN, 3 );
    }
    cells_put_number( &line, has_ghosts ? 1e3 * row->rms : 0.0, 3 );
    cells_put_number( &line, has_ghosts ? 1e3 * row->rms_still : NAN, 3 );
    cells_put_hash( &line, row->hash );
    cells_end_row( &line, table, out );
    for ( int w = run->first_worker; w < plan->worker_count; ++w )
    {
        results_row* machine = results_add_row( out, "strands.guides", has_ghosts ? "guides" : "all" );
        if ( !machine )
        {
            return;
        }
        results_put( &machine->size, "strands", run->hair.strand_count );
        results_put( &machine->size, "ratio", row->ratio );
        machine->workers = plan->workers[w];
        results_put_times( machine, &row->ms[w] );
        results_put( &machine->stages, "ghosts", row->follow_ms[w] );
        snprintf( machine->error_reference, sizeof( machine->error_reference ), "all simulated" );
        results_put( &machine->error, "rms_m", row->rms );
        if ( isfinite( row->rms_still ) )
        {
            results_put( &machine->error, "rms_without_sway_m", row->rms_still );
        }
        machine->hash = row->hash;
        machine->has_hash = true;
    }
}

static void add_claim( const strands_plan* plan, const guides_run* run, results* out )
{
    const guides_row* row = &run->rows[run->row_count - 1];
    int vertices = strands_shape_size( &run->hair );
    if ( vertices >= MILLION && plan->worker_count > 1 )
    {
        char claim[160];
        snprintf( claim, sizeof( claim ),
                  "%d ghost vertices per frame, 1 : %d with %d workers, guides included: under %.0f ms", vertices,
                  row->ratio, plan->workers[1], CLAIM_FRAME_MS );
        results_add_claim( out, row->ms[1].median < CLAIM_FRAME_MS, claim, row->ms[1].median, " ms" );
        snprintf( claim, sizeof( claim ),
                  "%d ghost vertices per frame with %d workers, the ghosts alone: under %.0f ms", vertices,
                  plan->workers[1], CLAIM_FRAME_MS );
        results_add_claim( out, row->follow_ms[1] < CLAIM_FRAME_MS, claim, row->follow_ms[1], " ms" );
    }
}

// ---- one head ----

static wisp_status enter( const strands_plan* plan, int min_ratio, int steps, guides_run* run, wisp_error* error )
{
    wisp_status status = hair_head_make_hair( run->side, STRANDS_VERTICES, &run->hair, error );
    run->row_count = 1;
    for ( int i = 0; i < WISP_COUNT( ratios ) && status == WISP_OK; ++i )
    {
        if ( ratios[i] >= min_ratio )
        {
            guides_row* row = &run->rows[run->row_count++];
            row->ratio = ratios[i];
            status = hair_head_make_guides( &run->hair, row->ratio, &row->guides, error );
        }
    }
    for ( int i = 0; i < run->row_count * run->worker_count && status == WISP_OK; ++i )
    {
        const hair_head_generator generator = make_generator(
            run, &run->rows[i / run->worker_count], plan->workers[run->first_worker + i % run->worker_count], true );
        status = hair_head_create( &generator, &run->heads[i], error );
    }
    run->observation_count = steps / OBSERVATION_STEPS;
    size_t count = (size_t)run->observation_count * (size_t)strands_shape_size( &run->hair );
    run->path = status == WISP_OK ? malloc( count * sizeof( wisp_vec3 ) ) : NULL;
    return status == WISP_OK && !run->path ? wisp_fail( error, WISP_NO_MEMORY, "no memory for a path" ) : status;
}

static void leave( guides_run* run )
{
    for ( int i = 0; i < IMPLEMENTATIONS_MAX; ++i )
    {
        hair_head_destroy( &run->heads[i] );
    }
    for ( int i = 0; i < ROWS_MAX; ++i )
    {
        strands_shape_free( &run->rows[i].guides );
    }
    strands_shape_free( &run->hair );
    free( run->path );
}

wisp_status strands_guides( const strands_plan* plan, results* out, wisp_error* error )
{
    int table = begin_table( plan, out );
    wisp_status status = WISP_OK;
    for ( int h = 0; h < plan->head_count && status == WISP_OK; ++h )
    {
        bench_progress( plan->options, 0.75 + 0.1 * h, "guides and ghosts" );
        guides_run* run = calloc( 1, sizeof( guides_run ) );
        if ( !run )
        {
            return wisp_fail( error, WISP_NO_MEMORY, "no memory for a head" );
        }
        run->side = plan->head_sides[h];
        bool is_large = h > 0;
        run->first_worker = is_large ? plan->large_first_worker : 0;
        run->worker_count = plan->worker_count - run->first_worker;
        run->has_still = !is_large;
        status = enter( plan, is_large ? plan->head_ratios_min : 0,
                        is_large ? OBSERVATION_STEPS * 2 : plan->head_steps, run, error );
        status = status == WISP_OK ? judge( plan, run, out, error ) : status;
        status = status == WISP_OK ? measure( plan, run, error ) : status;
        for ( int i = 0; i < run->row_count && status == WISP_OK; ++i )
        {
            add_line( plan, run, &run->rows[i], table, out );
        }
        if ( status == WISP_OK )
        {
            add_claim( plan, run, out );
        }
        leave( run );
        free( run );
    }
    results_add_note( out, "Guides: rods with ten substeps on a head that is moved and turned from side to side. "
                           "Every strand has its own length and wave; a guide is the mean of its ghosts." );
    results_add_note( out,
                      "Guides: RMS is the root mean square distance of all vertices to full simulation, over samples "
                      "every %d steps. `without sway` has no weights: the rest is the error of the guides. Times "
                      "include guides and vertices in the user's order.",
                      OBSERVATION_STEPS );
    return status;
}
