// ns per constraint and pass, compared with the scalar C version that walks the links in the order of the mesh.
#include "cloth_bench.h"
#include "rows_chart.h"
#include "bench_timing.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Targets of the table, at one size and over all sizes.
#define CLAIM_SIZE 128
#define CLAIM_RATIO_ONE 8.0
#define CLAIM_RATIO_MANY 12.0
#define CLAIM_FLAT 1.4

#define SAMPLES_MAX 300
// Every step of scalar C starts from the state of the engine after this many steps: the timed work is then valid,
// whatever the order of the mesh does to the scene in the long run.
#define START_STEPS 12

enum
{
    PLAIN_STEP,
    PLAIN_PASS,
    OURS,
    VARIANTS_MAX = OURS + SCENARIO_IMPLEMENTATIONS_MAX,
};

static const cloth_setting setting = { 10, 1 };

/// Scalar C, and the state that each of its steps starts from.
typedef struct plain_comparison
{
    plain_cloth cloth;
    wisp_vec3 *position, *velocity;
} plain_comparison;

typedef struct comparison_line
{
    int n, vertices, links;
    stats_summary ms[VARIANTS_MAX];
    double links_ms[SCENARIO_IMPLEMENTATIONS_MAX];
    double error, tolerance; ///< m; NaN if no double precision step was made
    uint64_t hash;
} comparison_line;

typedef struct comparison
{
    cloth_scene scene;
    wisp_fabric* fabric;
    surface_implementation implementations[SCENARIO_IMPLEMENTATIONS_MAX];
    plain_comparison plain;
    bench_variant variants[VARIANTS_MAX];
} comparison;

// ---- scalar C ----

static void set_back( plain_comparison* plain )
{
    size_t bytes = (size_t)plain->cloth.vertex_count * sizeof( wisp_vec3 );
    memcpy( plain->cloth.position, plain->position, bytes );
    memcpy( plain->cloth.velocity, plain->velocity, bytes );
}

static wisp_status step_plain( void* context, wisp_error* error )
{
    (void)error;
    plain_comparison* plain = context;
    set_back( plain );
    plain_cloth_step( &plain->cloth, CLOTH_STEP );
    return WISP_OK;
}

static wisp_status pass_plain( void* context, wisp_error* error )
{
    (void)error;
    plain_comparison* plain = context;
    set_back( plain );
    for ( int pass = 0; pass < setting.substeps; ++pass )
    {
        plain_cloth_project( &plain->cloth );
    }
    return WISP_OK;
}

static wisp_status enter_plain( const cloth_scene* scene, plain_comparison* plain, wisp_error* error )
{
    const wisp_mesh* mesh = &scene->mesh;
    size_t vertices = (size_t)mesh->vertex_count;
    plain->position = calloc( vertices, sizeof( wisp_vec3 ) );
    plain->velocity = calloc( vertices, sizeof( wisp_vec3 ) );
    if ( !plain->position || !plain->velocity ||
         !plain_cloth_create( &plain->cloth, mesh->points, mesh->vertex_count, mesh->triangles, mesh->triangle_count,
                              1.0f, CLOTH_BEND_STIFFNESS ) )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the scalar C version of %d vertices",
                          mesh->vertex_count );
    }
    plain_cloth_pin( &plain->cloth, scene->pins[0] );
    plain_cloth_pin( &plain->cloth, scene->pins[1] );
    plain->cloth.substeps = setting.substeps;
    return WISP_OK;
}

static void leave_plain( plain_comparison* plain )
{
    plain_cloth_destroy( &plain->cloth );
    free( plain->position );
    free( plain->velocity );
}

static bool is_plain_finite( const plain_comparison* plain )
{
    for ( int i = 0; i < plain->cloth.vertex_count; ++i )
    {
        wisp_vec3 p = plain->cloth.position[i];
        if ( !isfinite( p.x ) || !isfinite( p.y ) || !isfinite( p.z ) )
        {
            return false;
        }
    }
    return true;
}

// ---- entering ----

static wisp_status enter( const cloth_plan* plan, int n, comparison* r, wisp_error* error )
{
    wisp_status status = cloth_scene_make( n, false, &r->scene, error );
    status = status == WISP_OK ? cloth_cook( &r->scene, &r->fabric, error ) : status;
    for ( int e = 0; e < plan->worker_count && status == WISP_OK; ++e )
    {
        status = cloth_implementation_create( &r->scene, r->fabric, &setting, plan->workers[e],
                                              &r->implementations[e], error );
        r->variants[OURS + e] = ( bench_variant ){ .name = "wisp",
                                                   .step = surface_implementation_step,
                                                   .after = surface_implementation_keep_profile,
                                                   .context = &r->implementations[e] };
    }
    status = status == WISP_OK ? enter_plain( &r->scene, &r->plain, error ) : status;
    r->variants[PLAIN_STEP] = ( bench_variant ){ .name = "plain", .step = step_plain, .context = &r->plain };
    r->variants[PLAIN_PASS] = ( bench_variant ){ .name = "plain pass", .step = pass_plain, .context = &r->plain };
    return status;
}

static void leave( const cloth_plan* plan, comparison* r )
{
    bench_free_samples( r->variants, OURS + plan->worker_count );
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        surface_implementation_destroy( &r->implementations[e] );
    }
    leave_plain( &r->plain );
    wisp_fabric_release( r->fabric );
    cloth_scene_free( &r->scene );
}

// ---- errors and hashes ----

static double farthest_coordinate( const wisp_mesh* mesh )
{
    double farthest = 0.0;
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        farthest = fmax( farthest, fmax( fabs( (double)mesh->points[i].x ), fabs( (double)mesh->points[i].z ) ) );
    }
    return farthest;
}

void cloth_check_error( double error, double tolerance, const char* what, results* out )
{
    if ( !( error <= tolerance ) )
    {
        results_add_failure( out, "%s: the error is %.3g m, more than the tolerated %.3g m.", what, error,
                             tolerance );
    }
}

static wisp_status judge_step( comparison* r, comparison_line* line, results* out, wisp_error* error )
{
    cloth_reference reference;
    wisp_status status = cloth_reference_create( &r->scene, r->fabric, &reference, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    cloth_reference_step( &reference, setting.substeps );
    const wisp_vec3* points;
    status = surface_implementation_points( &r->implementations[0], &points, error );
    if ( status == WISP_OK )
    {
        char what[64];
        snprintf( what, sizeof( what ), "cloth %d, one step against double precision", line->n );
        line->error = cloth_reference_distance( &reference, points );
        line->tolerance = CLOTH_TOLERATED_ROUNDINGS * (double)FLT_EPSILON * farthest_coordinate( &r->scene.mesh );
        cloth_check_error( line->error, line->tolerance, what, out );
    }
    cloth_reference_destroy( &reference );
    return status;
}

static wisp_status step_all( const cloth_plan* plan, comparison* r, int steps, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        for ( int s = 0; s < steps && status == WISP_OK; ++s )
        {
            status = surface_implementation_step( &r->implementations[e], error );
        }
    }
    return status;
}

// One step for the oracle, the others for the start state of scalar C.
static wisp_status judge( const cloth_plan* plan, comparison* r, comparison_line* line, results* out,
                          wisp_error* error )
{
    wisp_status status = step_all( plan, r, 1, error );
    if ( status == WISP_OK && line->vertices <= plan->oracle_vertices_max )
    {
        status = judge_step( r, line, out, error );
    }
    status = status == WISP_OK ? step_all( plan, r, START_STEPS - 1, error ) : status;
    uint64_t hashes[SCENARIO_IMPLEMENTATIONS_MAX];
    for ( int e = 0; e < plan->worker_count && status == WISP_OK; ++e )
    {
        status = surface_implementation_hash( &r->implementations[e], &hashes[e], error );
    }
    const wisp_vec3* points;
    status = status == WISP_OK ? surface_implementation_points( &r->implementations[0], &points, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    char what[64];
    snprintf( what, sizeof( what ), "cloth %d", line->n );
    scenario_check_hashes( r->implementations, plan->worker_count, hashes, what, out );
    line->hash = hashes[0];
    memcpy( r->plain.position, points, (size_t)line->vertices * sizeof( wisp_vec3 ) );
    surface_implementation_velocities( &r->implementations[0], r->plain.velocity );
    return WISP_OK;
}

static void check_after( const cloth_plan* plan, const comparison* r, const comparison_line* line, results* out )
{
    if ( !is_plain_finite( &r->plain ) )
    {
        results_add_failure( out, "cloth %d: scalar C is not finite after one step.", line->n );
    }
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        if ( r->implementations[e].halted_at > 0 )
        {
            results_add_failure( out, "cloth %d: the engine with %d %s halted the cloth at step %d.", line->n,
                                 plan->workers[e], bench_workers_word( plan->workers[e] ),
                                 r->implementations[e].halted_at );
        }
    }
}

// ---- times ----

static wisp_status run_line( const cloth_plan* plan, comparison* r, comparison_line* line, double seconds,
                             results* out, wisp_error* error )
{
    wisp_status status = enter( plan, line->n, r, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    line->vertices = r->fabric->vertex_count;
    line->links = r->fabric->link_count;
    line->error = NAN;
    status = judge( plan, r, line, out, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const bench_effort effort = { .seconds = seconds, .rounds_min = 2, .samples_max = SAMPLES_MAX };
    int count = OURS + plan->worker_count;
    status = bench_interleave( r->variants, count, &effort, error );
    for ( int v = 0; v < count && status == WISP_OK; ++v )
    {
        line->ms[v] = bench_summarise( &r->variants[v] );
    }
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        line->links_ms[e] = surface_implementation_pass_ms( &r->implementations[e], "links." );
    }
    check_after( plan, r, line, out );
    return status;
}

static double ns( const comparison_line* line, double ms )
{
    return 1e6 * ms / ( (double)line->links * setting.substeps );
}

// ---- rows and cells ----

static void put_times( const comparison_line* line, int v, results_row* row )
{
    results_put( &row->size, "vertices", line->vertices );
    results_put( &row->size, "links", line->links );
    results_put_times( row, &line->ms[v] );
}

static void add_rows( const cloth_plan* plan, const comparison* r, const comparison_line* line, results* out )
{
    for ( int v = 0; v < OURS; ++v )
    {
        results_row* row = results_add_row( out, "cloth.race", r->variants[v].name );
        if ( row )
        {
            put_times( line, v, row );
            row->workers = 1;
        }
    }
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        results_row* row = results_add_row( out, "cloth.race", "wisp" );
        if ( row )
        {
            put_times( line, OURS + e, row );
            row->workers = plan->workers[e];
            results_put( &row->stages, "links", line->links_ms[e] );
            if ( isfinite( line->error ) )
            {
                snprintf( row->error_reference, sizeof( row->error_reference ), "double" );
                results_put( &row->error, "max_m", line->error );
                results_put( &row->error, "tolerance_m", line->tolerance );
            }
            row->hash = line->hash;
            row->has_hash = true;
        }
    }
}

static int begin_table( const cloth_plan* plan, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "n" );
    cells_put( &row, "links" );
    cells_put( &row, "scalar links" );
    cells_put( &row, "scalar step" );
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        cells_put( &row, "%d %s links", plan->workers[e], bench_workers_word( plan->workers[e] ) );
        cells_put( &row, "p10 .. p90 step" );
        cells_put( &row, "%d %s step", plan->workers[e], bench_workers_word( plan->workers[e] ) );
        cells_put( &row, "%d %s speedup, links", plan->workers[e], bench_workers_word( plan->workers[e] ) );
        cells_put( &row, "%d %s speedup, step", plan->workers[e], bench_workers_word( plan->workers[e] ) );
    }
    cells_put( &row, "error m" );
    cells_put( &row, "samples" );
    cells_put( &row, "hash" );
    return cells_begin_table( &row, "Cloth against scalar C in mesh order: ns per constraint and pass, 10 substeps",
                              out );
}

static void add_line( const cloth_plan* plan, const comparison_line* line, int table, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "%d", line->n );
    cells_put( &row, "%d", line->links );
    cells_put_number( &row, ns( line, line->ms[PLAIN_PASS].median ), 2 );
    cells_put_number( &row, ns( line, line->ms[PLAIN_STEP].median ), 2 );
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        const stats_summary* step = &line->ms[OURS + e];
        cells_put_number( &row, ns( line, line->links_ms[e] ), 2 );
        cells_put( &row, "%.2f .. %.2f", ns( line, step->p10 ), ns( line, step->p90 ) );
        cells_put_number( &row, ns( line, step->median ), 2 );
        cells_put_number( &row, line->ms[PLAIN_PASS].median / line->links_ms[e], 1 );
        cells_put_number( &row, line->ms[PLAIN_STEP].median / step->median, 1 );
    }
    cells_put( &row, isfinite( line->error ) ? "%.1e" : "-", line->error );
    cells_put( &row, "%d", line->ms[OURS].count );
    cells_put_hash( &row, line->hash );
    cells_end_row( &row, table, out );
}

// ---- checks ----

static void claim_flatness( const cloth_plan* plan, const comparison_line* lines, int e, results* out )
{
    double least = INFINITY, most = 0.0;
    for ( int i = 0; i < plan->comparison_count; ++i )
    {
        least = fmin( least, ns( &lines[i], lines[i].links_ms[e] ) );
        most = fmax( most, ns( &lines[i], lines[i].links_ms[e] ) );
    }
    char claim[160];
    snprintf( claim, sizeof( claim ), "ns per constraint and pass with %d %s are flat within %.0f %% over all sizes",
              plan->workers[e], bench_workers_word( plan->workers[e] ), 100.0 * ( CLAIM_FLAT - 1.0 ) );
    results_add_claim( out, most <= CLAIM_FLAT * least, claim, 100.0 * ( most / least - 1.0 ), " % apart" );
}

static void claim_ratio( const cloth_plan* plan, const comparison_line* line, int e, results* out )
{
    double least = plan->workers[e] == 1 ? CLAIM_RATIO_ONE : CLAIM_RATIO_MANY;
    double ratio = line->ms[PLAIN_PASS].median / line->links_ms[e];
    char claim[160];
    snprintf( claim, sizeof( claim ),
              "n = %d with %d %s: a pass over the links is at least %.0f times faster than scalar C", line->n,
              plan->workers[e], bench_workers_word( plan->workers[e] ), least );
    results_add_claim( out, ratio >= least, claim, ratio, " times" );
}

static double ns_of( const results_row* row )
{
    return 1e6 * row->ms_median / ( rows_size( row, "links" ) * setting.substeps );
}

static void add_chart( int first_row, results* out )
{
    rows_chart_add( &( rows_chart ){ .first_row = first_row,
                                     .name = "cloth.race",
                                     .title = "Cloth against scalar C: time per constraint and pass of a step",
                                     .x_label = "vertices",
                                     .y_label = "ns per constraint and pass",
                                     .x = rows_vertices,
                                     .y = ns_of,
                                     .y_linear = true },
                    out );
}

static void add_claims( const cloth_plan* plan, const comparison_line* lines, results* out )
{
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        for ( int i = 0; i < plan->comparison_count; ++i )
        {
            if ( lines[i].n == CLAIM_SIZE )
            {
                claim_ratio( plan, &lines[i], e, out );
            }
        }
        claim_flatness( plan, lines, e, out );
    }
    results_add_note(
        out, "Cloth against scalar C: `links` is the pass over the links alone: ten passes in a row of scalar C, the "
             "profile of Wisp. `step` is a whole step over the same number of links and passes." );
    results_add_note( out,
                      "Cloth against scalar C: every step of scalar C starts from the state of Wisp after %d steps. "
                      "The error is the largest distance to the same step in double precision, at most %.0f float "
                      "roundings of the farthest coordinate.",
                      START_STEPS, CLOTH_TOLERATED_ROUNDINGS );
}

wisp_status cloth_comparison( const cloth_plan* plan, results* out, wisp_error* error )
{
    comparison_line lines[CLOTH_SIZES_MAX] = { { 0 } };
    double deadline = wisp_clock_seconds() + plan->comparison_seconds;
    wisp_status status = WISP_OK;
    const int first_row = out->row_count;
    int table = begin_table( plan, out );
    for ( int i = 0; i < plan->comparison_count && status == WISP_OK; ++i )
    {
        comparison r = { 0 };
        lines[i].n = plan->comparison_sizes[i];
        double left = fmax( deadline - wisp_clock_seconds(), 0.0 ) / ( plan->comparison_count - i );
        status = run_line( plan, &r, &lines[i], left, out, error );
        if ( status == WISP_OK )
        {
            add_rows( plan, &r, &lines[i], out );
            add_line( plan, &lines[i], table, out );
        }
        leave( plan, &r );
    }
    if ( status == WISP_OK )
    {
        add_chart( first_row, out );
        add_claims( plan, lines, out );
    }
    return status;
}
