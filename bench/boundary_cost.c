// Measure the number of points for a spacing, their cost, and how densely they cover the surface.
#include "boundary_cover.h"
#include "boundary_bench.h"
#include "rows_chart.h"
#include "bench_timing.h"

#include <math.h>

enum
{
    SAMPLES_MAX = 200,
    ROUNDS_MIN = 3,
    IN_PLACE = 0,  // case A everywhere
    RESAMPLED = 1, // case B everywhere
    WAYS = 2,
    VARIANTS = WAYS * BOUNDARY_WORKERS_MAX,
};

static const char* const way_names[WAYS] = { "in place", "resampled" };

// Expected counts on edges and inside triangles, by an independent script in double precision.
static const struct
{
    float spacing;
    int even[2], exact[2];
} contract[] = {
    { 0.2f, { 930, 0 }, { 3360, 0 } },
    { 0.1f, { 5160, 300 }, { 7710, 3480 } },
    { 0.05f, { 14730, 11640 }, { 17340, 21360 } },
    { 0.025f, { 32670, 79320 }, { 35280, 103560 } },
};

/// Results for one spacing and one rule.
typedef struct layer_cost
{
    const layer_law* law;
    float spacing;
    layer_check check;
    layer_cover cover;
    stats_summary ms[WAYS][BOUNDARY_WORKERS_MAX]; // of the pass that computes the points
    size_t bytes;
    uint64_t hash;
    bool same_hash; // of every implementation and worker count
} layer_cost;

typedef struct cost_run
{
    const boundary_plan* plan;
    results* out;
    wisp_mesh mesh;
    wisp_fabric* fabric;
    layer_implementation implementations[VARIANTS];
    layer_cost costs[LAYER_LAWS * BOUNDARY_SIZES_MAX];
    int count;
    double area; // m^2
} cost_run;

static int points_of( const layer_cost* cost )
{
    return cost->check.edge_points + cost->check.inner_points;
}

// ---- measuring ----

static wisp_status enter_all( cost_run* run, const layer_cost* cost, bench_variant* variants, wisp_error* error )
{
    const boundary_plan* plan = run->plan;
    const wisp_boundary_def def = layer_def( cost->law, cost->spacing );
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WAYS * plan->worker_count && status == WISP_OK; ++i )
    {
        status = layer_enter( run->fabric, &def, plan->workers[i / WAYS], run->implementations + i, error );
        run->implementations[i].is_resampled = i % WAYS == RESAMPLED;
        variants[i] = ( bench_variant ){ .name = way_names[i % WAYS],
                                         .step = layer_step,
                                         .after = layer_keep_profile,
                                         .context = run->implementations + i };
    }
    return status;
}

static void read_times( cost_run* run, layer_cost* cost )
{
    for ( int i = 0; i < WAYS * run->plan->worker_count; ++i )
    {
        cost->ms[i % WAYS][i / WAYS] = layer_pass_ms( &run->implementations[i].surface, "boundary.points" );
    }
}

static wisp_status observe( cost_run* run, layer_cost* cost, wisp_error* error )
{
    const wisp_boundary_def def = layer_def( cost->law, cost->spacing );
    surface_implementation* first = &run->implementations[0].surface;
    wisp_boundary_stats stats;
    wisp_boundary_view view;
    wisp_status status = layer_compare( first, &run->mesh, &def, &cost->check, error );
    status = status == WISP_OK ? layer_read_stats( first, &stats, error ) : status;
    cost->bytes = status == WISP_OK ? stats.bytes : 0;
    cost->same_hash = true;
    for ( int i = 0; i < WAYS * run->plan->worker_count && status == WISP_OK; ++i )
    {
        status = layer_read( &run->implementations[i].surface, &view, error );
        const uint64_t hash = status == WISP_OK ? layer_hash( &view ) : 0;
        cost->hash = i == 0 ? hash : cost->hash;
        cost->same_hash = cost->same_hash && hash == cost->hash;
    }
    return status == WISP_OK ? layer_find_cover( &view, &run->mesh, &cost->cover, error ) : status;
}

static wisp_status measure( cost_run* run, layer_cost* cost, double seconds, wisp_error* error )
{
    bench_variant variants[VARIANTS] = { { 0 } };
    const int count = WAYS * run->plan->worker_count;
    const bench_effort effort = { seconds, ROUNDS_MIN, SAMPLES_MAX };
    wisp_status status = enter_all( run, cost, variants, error );
    if ( status == WISP_OK )
    {
        status = bench_interleave( variants, count, &effort, error );
        bench_free_samples( variants, count );
    }
    if ( status == WISP_OK )
    {
        read_times( run, cost );
        status = observe( run, cost, error );
    }
    for ( int i = 0; i < count; ++i )
    {
        surface_implementation_destroy( &run->implementations[i].surface );
    }
    return status;
}

// ---- rows ----

static void add_rows( const cost_run* run, const layer_cost* cost, results* out )
{
    for ( int i = 0; i < WAYS * run->plan->worker_count; ++i )
    {
        char variant[64];
        snprintf( variant, sizeof( variant ), "%s, %s", cost->law->name, way_names[i % WAYS] );
        const stats_summary* ms = &cost->ms[i % WAYS][i / WAYS];
        results_row* row = results_add_row( out, "boundary", variant );
        if ( row != NULL )
        {
            row->workers = run->plan->workers[i / WAYS];
            results_put_times( row, ms );
            row->hash = cost->hash;
            row->has_hash = true;
            results_put( &row->size, "points", points_of( cost ) );
            results_put( &row->size, "edge_points", cost->check.edge_points );
            results_put( &row->size, "spacing_m", (double)cost->spacing );
            results_put( &row->size, "bytes", (double)cost->bytes );
            results_put( &row->stages, "boundary.points", ms->median );
            snprintf( row->error_reference, sizeof( row->error_reference ), "oracle" );
            results_put( &row->error, "place_m", cost->check.farthest );
            results_put( &row->error, "gap_m", cost->cover.gap );
            results_put( &row->error, "cover_m", cost->cover.reach );
        }
    }
}

// @return null without an expected count
static const int* contract_counts( const layer_cost* cost )
{
    for ( int i = 0; i < WISP_COUNT( contract ); ++i )
    {
        if ( contract[i].spacing == cost->spacing && cost->law->rounding == WISP_ROUND_DOWN )
        {
            return cost->law->policy == WISP_SPACING_EVEN ? contract[i].even : contract[i].exact;
        }
    }
    return NULL;
}

static void add_counts( const cost_run* run, const layer_cost* cost, int table, results* out )
{
    const layer_check* c = &cost->check;
    const int* printed = contract_counts( cost );
    const int oracle[2] = { c->edge_expected, c->inner_expected };
    const int* expected = printed != NULL ? printed : oracle;
    const bool exact = c->edge_points == expected[0] && c->inner_points == expected[1] && layer_check_is_met( c );
    const double d = (double)cost->spacing;
    cells row = { .count = 0 };
    cells_put( &row, "%g", d );
    cells_put( &row, "%s", cost->law->name );
    cells_put( &row, "%d", c->edge_points );
    cells_put( &row, "%d", c->inner_points );
    cells_put( &row, "%d / %d", expected[0], expected[1] );
    cells_put( &row, "%s", printed != NULL ? "contract" : "oracle" );
    cells_put( &row, "%s", exact ? "yes" : "NO" );
    cells_put_number( &row, 1e6 * c->farthest, 2 );
    cells_put_number( &row, c->inner_points * d * d / run->area, 2 );
    cells_put_hash( &row, cost->hash );
    cells_put( &row, "%s", cost->same_hash ? "yes" : "NO" );
    cells_end_row( &row, table, out );
    if ( !exact || !cost->same_hash )
    {
        results_add_failure( out, "Cost of points: at d = %g m, %s, %s.", d, cost->law->name,
                             exact ? "points depend on the number of workers, or on whether they were sampled again"
                                   : "are not those expected" );
    }
}

static void add_costs( const cost_run* run, const layer_cost* cost, int table, results* out )
{
    const int workers = run->plan->worker_count;
    const double ns = 1e6 / fmax( points_of( cost ), 1.0 );
    cells row = { .count = 0 };
    cells_put( &row, "%g", (double)cost->spacing );
    cells_put( &row, "%s", cost->law->name );
    cells_put( &row, "%d", points_of( cost ) );
    for ( int i = 0; i < WAYS * BOUNDARY_WORKERS_MAX; ++i )
    {
        const int way = i / BOUNDARY_WORKERS_MAX, w = i % BOUNDARY_WORKERS_MAX;
        cells_put_number( &row, w < workers ? ns * cost->ms[way][w].median : NAN, 2 );
    }
    cells_put_number( &row, cost->ms[RESAMPLED][0].median / cost->ms[IN_PLACE][0].median, 2 );
    cells_put_number( &row, workers > 1 ? cost->ms[IN_PLACE][0].median / cost->ms[IN_PLACE][1].median : NAN, 2 );
    cells_put_number( &row, (double)cost->bytes / fmax( points_of( cost ), 1.0 ), 0 );
    cells_put_number( &row, 1e-6 * (double)cost->bytes, 2 );
    cells_end_row( &row, table, out );
}

static void add_accuracy( const layer_cost* cost, int table, results* out )
{
    const double d = (double)cost->spacing;
    const bool covers = cost->law->rounding == WISP_ROUND_UP || cost->law->policy == WISP_SPACING_EXACT;
    // the last gap is a difference of rounded positions; even spacing rounded down has gaps below 2 d
    const bool met = cost->cover.gap <= ( covers ? 1.0 : 2.0 ) * d + 1e-5;
    cells row = { .count = 0 };
    cells_put( &row, "%g", d );
    cells_put( &row, "%s", cost->law->name );
    cells_put_number( &row, 1e3 * cost->cover.gap, 2 );
    cells_put_number( &row, cost->cover.gap / d, 3 );
    cells_put_number( &row, 1e3 * cost->cover.reach, 2 );
    cells_put_number( &row, cost->cover.reach / d, 3 );
    cells_put( &row, "%d", points_of( cost ) );
    cells_put_number( &row, cost->ms[IN_PLACE][0].median, 4 );
    cells_put_number( &row, cost->ms[RESAMPLED][0].median, 4 );
    cells_put_number( &row, 1e-6 * (double)cost->bytes, 2 );
    cells_put( &row, "%s", met ? "yes" : "NO" );
    cells_end_row( &row, table, out );
    if ( !met )
    {
        results_add_failure( out, "Coverage: a gap of %.4f m on an edge at d = %g m, %s.", cost->cover.gap, d,
                             cost->law->name );
    }
}

static double points_in( const results_row* row )
{
    return rows_size( row, "points" );
}

static void add_chart( const cost_run* run, int first_row, results* out )
{
    const int w = run->plan->workers[run->plan->worker_count - 1];
    char title[160];
    snprintf( title, sizeof( title ), "Boundary points of a sphere with %d worker%s: time against points", w,
              w == 1 ? "" : "s" );
    rows_chart_add( &( rows_chart ){ .first_row = first_row,
                                     .name = "boundary",
                                     .workers = w,
                                     .title = title,
                                     .x_label = "points",
                                     .y_label = "ms per step, the pass alone",
                                     .x = points_in,
                                     .y = rows_ms },
                    out );
}

static void write_tables( const cost_run* run, results* out )
{
    const int first_row = out->row_count;
    static const char* const counts[] = {
        "d",    "spacing", "edge", "inner", "expected", "by", "exact", "error to oracle, um", "inner d^2 / area",
        "hash", "same"
    };
    const int w = run->plan->workers[run->plan->worker_count - 1];
    char in_place[40], resampled[40], title[160];
    snprintf( in_place, sizeof( in_place ), "in place, %d workers", w );
    snprintf( resampled, sizeof( resampled ), "resampled, %d workers", w );
    const char* const costs[] = { "d",
                                  "spacing",
                                  "points",
                                  "in place",
                                  in_place,
                                  "resampled",
                                  resampled,
                                  "resampled / in place",
                                  "1 worker / more",
                                  "bytes per point",
                                  "MB" };
    static const char* const accuracy[] = { "d",         "spacing", "gap, mm",     "gap / d",      "cover, mm",
                                            "cover / d", "points",  "in place ms", "resampled ms", "MB",
                                            "met" };
    int table =
        results_add_table( out, "Points of the reference sphere by spacing, m", WISP_COUNT( counts ), counts );
    for ( int i = 0; i < run->count; ++i )
    {
        add_rows( run, run->costs + i, out );
        add_counts( run, run->costs + i, table, out );
    }
    snprintf(
        title, sizeof( title ),
        "Cost of points: ns per point, medians of the pass that makes them, 1 worker where not stated; memory" );
    table = results_add_table( out, title, WISP_COUNT( costs ), costs );
    for ( int i = 0; i < run->count; ++i )
    {
        add_costs( run, run->costs + i, table, out );
    }
    table = results_add_table( out,
                               "Coverage against cost: the largest gap along edges, and the largest distance from a "
                               "place on a triangle to its points; 1 worker",
                               WISP_COUNT( accuracy ), accuracy );
    for ( int i = 0; i < run->count; ++i )
    {
        add_accuracy( run->costs + i, table, out );
    }
    add_chart( run, first_row, out );
    results_add_note( out, "Cost of points: in place: no count changes (case A). resampled: every element is sampled "
                           "again in every step (case B). bytes: the whole layer, points twice." );
    results_add_note( out, "Coverage: distances are measured at 325 places of each triangle. same: points, normals "
                           "and recipes have one hash in both cases and for every worker count." );
}

static double area_of( const wisp_mesh* mesh, wisp_error* error )
{
    wisp_mesh_diagnostics report;
    return wisp_mesh_examine( mesh, &report, error ) == WISP_OK ? report.area : NAN;
}

wisp_status boundary_costs( const boundary_plan* plan, results* out, wisp_error* error )
{
    cost_run run = { .plan = plan, .out = out };
    wisp_status status = layer_sphere( LAYER_SEGMENTS, LAYER_RADIUS, &run.mesh, error );
    status = status == WISP_OK ? layer_cook( &run.mesh, &run.fabric, error ) : status;
    run.area = status == WISP_OK ? area_of( &run.mesh, error ) : NAN;
    const int count = plan->spacing_count * LAYER_LAWS;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        bench_progress( plan->options, 0.15 + 0.45 * i / count, "boundary, costs" );
        layer_cost* cost = run.costs + i;
        *cost = ( layer_cost ){ .law = layer_laws + i % LAYER_LAWS, .spacing = plan->spacings[i / LAYER_LAWS] };
        status = measure( &run, cost, plan->cost_seconds / count, error );
        run.count += 1;
    }
    if ( status == WISP_OK )
    {
        write_tables( &run, out );
    }
    wisp_fabric_release( run.fabric );
    wisp_mesh_release( &run.mesh );
    return status;
}
