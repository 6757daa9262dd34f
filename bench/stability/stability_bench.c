// The case `stability`: hard cases of every solver, and suites whose rows have checks.
#include "stability/stability_bench.h"

#include "bench_output.h"
#include "interruption.h"
#include "program_data.h"

#include "wisp/explain.h"

#include <math.h>
#include <string.h>

// ---- suites with checks ----

int stability_begin_table( const char* title, results* out )
{
    return results_begin_table(
        out, title,
        "cell\tverdict\tstrain %\tof at most\tsteps\tenergy J\tof at most\trest mm/s\tof at most\t"
        "without\tengine\thash" );
}

// Checks that no limit of this run is known for.
static void put_without( const suite_outcome* o, results_cells* row )
{
    char words[80] = "";
    for ( int i = 0; i < STABILITY_CHECK_COUNT; ++i )
    {
        const size_t used = strlen( words );
        if ( o->without_limit & stability_bit( (stability_check)i ) )
        {
            snprintf( words + used, sizeof words - used, "%s%s", used > 0 ? " " : "", stability_check_names[i] );
        }
    }
    cells_put( row, "%s", words[0] ? words : "-" );
}

// Actions of the engine according to its counters.
static void put_engine( const suite_outcome* o, results_cells* row )
{
    if ( o->resets > 0 )
    {
        cells_put( row, "reset %llu", (unsigned long long)o->resets );
    }
    else if ( o->not_converged > 0 )
    {
        cells_put( row, "unsolved %llu", (unsigned long long)o->not_converged );
    }
    else if ( o->degenerate > 0 )
    {
        cells_put( row, "undirected %llu", (unsigned long long)o->degenerate );
    }
    else
    {
        cells_put( row, "-" );
    }
}

static void put_verdict( const suite_outcome* o, bool is_known, results_cells* row )
{
    if ( o->verdict.check != STABILITY_HOLDS )
    {
        cells_put( row, is_known ? "limit: %s" : "FAILED: %s", stability_check_names[o->verdict.check] );
    }
    else if ( o->is_refused )
    {
        cells_put( row, "refused, as expected" );
    }
    else if ( o->figures.recovery > 0.0 )
    {
        cells_put( row, "recovered in %.2g s", o->figures.recovery );
    }
    else
    {
        cells_put( row, "pass" );
    }
}

static void add_outcome_line( int table, const char* label, const suite_outcome* o, bool is_known, results* out )
{
    const stability_figures* f = &o->figures;
    results_cells row = { .count = 0 };
    cells_put( &row, "%s", label );
    put_verdict( o, is_known, &row );
    cells_put( &row, "%.3g\t%.3g\t%d\t%.3g\t%.3g\t%.3g\t%.3g", 100.0 * f->strain, 100.0 * f->strain_limit, o->steps,
               f->energy, f->energy_limit, 1e3 * f->rest, 1e3 * f->rest_limit );
    put_without( o, &row );
    put_engine( o, &row );
    cells_put( &row, "%016llx", (unsigned long long)o->hash );
    cells_end_row( &row, table, out );
}

static void add_outcome_row( const char* label, const suite_outcome* o, results* out )
{
    const stability_figures* f = &o->figures;
    results_row* row = results_add_row( out, "stability", label );
    if ( row == NULL )
    {
        return;
    }
    row->workers = 1;
    row->steps = o->steps;
    snprintf( row->error_reference, sizeof( row->error_reference ), "the limits of app/stability" );
    results_put( &row->error, "broke", o->verdict.check );
    results_put( &row->error, "strain", f->strain );
    results_put( &row->error, "strain_limit", f->strain_limit );
    results_put( &row->error, "recovery_s", f->recovery );
    results_put( &row->error, "energy_rise_j", f->energy );
    results_put( &row->error, "energy_limit_j", f->energy_limit );
    results_put( &row->error, "rest_m_s", f->rest );
    results_put( &row->error, "rest_limit_m_s", f->rest_limit );
    row->hash = o->hash;
    row->has_hash = true;
}

static void judge_outcome( const char* label, const suite_outcome* o, int known, stability_counts* t, results* out )
{
    const stability_check broke = o->verdict.check;
    const bool is_as_known = (int)broke == known;
    if ( broke != STABILITY_HOLDS && !is_as_known )
    {
        results_add_failure( out, "stability, %s: breaks %s: %s", label, stability_check_names[broke],
                             o->verdict.message );
    }
    else if ( !is_as_known )
    {
        results_add_failure( out, "stability, %s: holds now; remove it from what is known to break", label );
    }
    t->failed += is_as_known ? 0 : 1;
    t->known += broke != STABILITY_HOLDS && is_as_known ? 1 : 0;
    t->held += broke == STABILITY_HOLDS && o->figures.recovery == 0.0 && !o->is_refused ? 1 : 0;
    t->recovered += broke == STABILITY_HOLDS && o->figures.recovery > 0.0 ? 1 : 0;
    t->refused += broke == STABILITY_HOLDS && o->is_refused ? 1 : 0;
    t->not_finite += broke == STABILITY_FINITE ? 1 : 0;
    t->without_limit += o->without_limit != 0 && !o->is_refused ? 1 : 0;
    ++t->rows;
}

void stability_add( int table, const char* label, const suite_outcome* outcome, int known, stability_counts* tally,
                    results* out )
{
    add_outcome_line( table, label, outcome, known >= 0, out );
    add_outcome_row( label, outcome, out );
    judge_outcome( label, outcome, known, tally, out );
}

static bool is_due( const suite_row* row, const bench_options* options )
{
    return row->checks != 0 && ( row->is_long ? options->longest : !options->quick || !row->is_slow );
}

// Rows of a name that must agree, so far.
typedef struct agreement
{
    const suite_row* first;
    double lower, upper;
} agreement;

static void end_agreement( agreement* a, stability_counts* tally, results* out )
{
    if ( a->first && a->first->agree > 0.0 )
    {
        results_add_note( out, "stability, %s: rows hang %.4f to %.4f of their size deep", a->first->name, a->lower,
                          a->upper );
        if ( !( a->upper - a->lower <= a->first->agree ) )
        {
            ++tally->failed;
            results_add_failure( out, "stability, %s: rows differ by %.4f of their size, and %.4g is allowed",
                                 a->first->name, a->upper - a->lower, a->first->agree );
        }
    }
    *a = ( agreement ){ .lower = INFINITY, .upper = -INFINITY };
}

static void compare_depth( agreement* a, const suite_row* row, double depth, stability_counts* tally, results* out )
{
    if ( a->first == NULL || strcmp( a->first->name, row->name ) != 0 )
    {
        end_agreement( a, tally, out );
        a->first = row;
    }
    a->lower = fmin( a->lower, depth );
    a->upper = fmax( a->upper, depth );
}

wisp_status stability_bench_suite( const wisp_suite* suite, const bench_options* options, stability_counts* tally,
                                   results* out, wisp_error* error )
{
    suite_twins twins = { 0 };
    wisp_status status = WISP_OK;
    const char* name = NULL;
    agreement together = { .lower = INFINITY, .upper = -INFINITY };
    int table = -1;
    for ( int i = 0; i < suite->row_count && status == WISP_OK; ++i )
    {
        const suite_row* row = &suite->rows[i];
        char label[SUITE_MAX_LABEL], title[SUITE_MAX_NAME + 200];
        if ( !is_due( row, options ) )
        {
            continue;
        }
        // a sweep has a table of its own
        if ( table < 0 || ( row->variant[0] && strcmp( row->name, name ) != 0 ) )
        {
            snprintf( title, sizeof title, "Stability, %s%s%s", suite->title[0] ? suite->title : suite->name,
                      row->variant[0] ? ": " : "", row->variant[0] ? row->name : "" );
            table = stability_begin_table( title, out );
        }
        name = row->name;
        suite_label( row, label );
        bench_progress( options, (double)i / suite->row_count, label );
        suite_outcome outcome;
        status = suite_judge_row( row, &twins, &outcome, error );
        status = status == WISP_OK ? interruption_check( error ) : status;
        if ( status == WISP_OK )
        {
            stability_add( table, label, &outcome, row->known, tally, out );
            compare_depth( &together, row, outcome.depth, tally, out );
        }
    }
    end_agreement( &together, tally, out );
    suite_twins_release( &twins );
    return status;
}

void stability_note( const stability_counts* t, const char* name, results* out )
{
    char line[300] = "";
    results_append_count( line, sizeof line, t->held, "hold" );
    results_append_count( line, sizeof line, t->recovered, "recover" );
    results_append_count( line, sizeof line, t->refused, "are refused as they should be" );
    results_append_count( line, sizeof line, t->known, "break as known" );
    results_append_count( line, sizeof line, t->failed, "fail" );
    results_append_count( line, sizeof line, t->not_finite, "have NaN or infinity" );
    results_add_note( out, "%s: %d cells: %s", name, t->rows, line[0] ? line + 2 : "none ran" );
    if ( t->without_limit > 0 )
    {
        results_add_note( out,
                          "%s: in %d cells no limit is known of what stands under `without`; give one, such as "
                          "checks: [all, { strain: 0.1 }]",
                          name, t->without_limit );
    }
}

// ---- the case ----

// The case `stability`: the suites of data/suites/stability, and a comparison that no suite can say.

// ---- costs ----

#define STEPS 60

// A hanging cloth, and others that share its fabric.
static const char* const scene_head = "wisp: 1\n"
                                      "steps: 60\n"
                                      "surfaces:\n"
                                      "  - name: cloth\n"
                                      "    generate: { shape: alternating_plane, columns: 12, rows: 12 }\n"
                                      "    pins: [0, 11]\n"
                                      "    cloth: { internal_damping: 0 }\n";

typedef struct costs
{
    uint64_t hash; ///< of the first cloth
    size_t bytes;
    int passes;
} costs;

static wisp_status run_copies( int more, costs* out, wisp_error* error )
{
    char text[1000];
    snprintf( text, sizeof text, "%s", scene_head );
    for ( int i = 0; i < more; ++i )
    {
        const size_t used = strlen( text );
        snprintf( text + used, sizeof text - used,
                  "  - { name: copy%d, instance_of: cloth, cloth: { internal_damping: 0 } }\n", i );
    }
    wisp_scene scene;
    scene_world world;
    const scene_world_options options = { .workers = 1, .is_quiet = true };
    wisp_status status = wisp_scene_parse( text, strlen( text ), "costs", &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = scene_world_create( &scene, &options, &world, error );
    if ( status == WISP_OK )
    {
        for ( int i = 0; i < STEPS && status == WISP_OK; ++i )
        {
            status = scene_world_step( &world, error );
        }
        (void)wisp_world_hash_column( world.world, world.surfaces[0].entity, WISP_SURFACE_POINTS, &out->hash );
        out->bytes = wisp_world_memory( world.world );
        out->passes = wisp_world_plan_passes( world.world );
        scene_world_destroy( &world );
    }
    wisp_scene_release( &scene );
    return status;
}

// A second cloth changes no bit of the first, adds no pass, and only its own memory.
static wisp_status costs_add_up( stability_counts* tally, results* out, wisp_error* error )
{
    costs c[3] = { { 0 } };
    wisp_status status = WISP_OK;
    for ( int more = 0; more < 3 && status == WISP_OK; ++more )
    {
        status = run_copies( more, &c[more], error );
    }
    const double first = (double)c[1].bytes - (double)c[0].bytes, second = (double)c[2].bytes - (double)c[1].bytes;
    const bool holds =
        c[0].hash == c[1].hash && c[0].hash == c[2].hash && c[0].passes == c[2].passes && second <= 1.05 * first;
    suite_outcome outcome = { .verdict = { .check = holds ? STABILITY_HOLDS : STABILITY_BITS },
                              .steps = STEPS,
                              .hash = c[0].hash };
    snprintf( outcome.verdict.message, sizeof outcome.verdict.message,
              "%d passes with one and %d with three, %.0f and %.0f bytes more", c[0].passes, c[2].passes, first,
              second );
    if ( status == WISP_OK )
    {
        const int table = stability_begin_table( "Stability, costs", out );
        stability_add( table, "failure 7: costs add up", &outcome, STABILITY_HOLDS, tally, out );
        results_add_note( out, "stability, failure 7: costs add up: %s", outcome.verdict.message );
    }
    return status;
}

// ---- the case ----

wisp_status stability_bench( const bench_options* options, results* out, wisp_error* error )
{
    static const char* const suites[] = { "cloth",  "balloons",  "strands",  "drives",   "near",
                                          "meshes", "followers", "failures", "together", "coarse" };
    stability_counts tally = { 0 };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( suites ) && status == WISP_OK; ++i )
    {
        char inner[64], path[1024];
        wisp_suite suite;
        snprintf( inner, sizeof inner, "suites/stability/%s.yaml", suites[i] );
        program_data_path( inner, path, sizeof path );
        status = suite_read( path, &suite, error );
        status = status == WISP_OK ? stability_bench_suite( &suite, options, &tally, out, error ) : status;
        suite_release( &suite );
    }
    status = status == WISP_OK ? costs_add_up( &tally, out, error ) : status;
    stability_note( &tally, "stability", out );
    return status;
}
