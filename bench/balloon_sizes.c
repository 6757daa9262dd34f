// Time against vertices: cost is proportional to the number of triangles, and volume is cheap compared with the skin.
#include "balloon_bench.h"
#include "balloon_readings.h"
#include "rows_chart.h"
#include "bench_timing.h"

#include <math.h>

#define CLAIM_FLAT 1.4
#define CLAIM_VOLUME_NS 2.0
#define CLAIM_VOLUME_TRIANGLES 5000
#define CLAIM_R_SQUARED 0.98

#define SAMPLES_MAX 200
// Steps before times are taken and before hashes are compared: the skin has swollen by then.
#define START_STEPS 3
#define FILL 1.2f

typedef struct size_line
{
    int vertices, triangles;
    stats_summary ms[SCENARIO_IMPLEMENTATIONS_MAX];
    double volume_ms[SCENARIO_IMPLEMENTATIONS_MAX]; ///< of the pass that holds the volume
    balloon_readings read;
    double bytes; ///< per vertex
    uint64_t hash;
} size_line;

typedef struct size_comparison
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    balloon_setting setting;
    surface_implementation implementations[SCENARIO_IMPLEMENTATIONS_MAX];
    bench_variant variants[SCENARIO_IMPLEMENTATIONS_MAX];
} size_comparison;

// Statistics add passes, so they are requested only after the times are taken.
static wisp_status enter( const balloon_plan* plan, int level, size_comparison* comparison, wisp_error* error )
{
    comparison->setting = balloon_setting_in_vacuum();
    comparison->setting.def.gas_ratio = FILL;
    comparison->setting.damping = 5.0f;
    wisp_status status = balloon_mesh_sphere( level, BALLOON_RADIUS, &comparison->mesh, error );
    status = status == WISP_OK ? balloon_cook( &comparison->mesh, &comparison->setting, &comparison->fabric, error )
                               : status;
    for ( int e = 0; e < plan->worker_count && status == WISP_OK; ++e )
    {
        comparison->setting.workers = plan->workers[e];
        surface_implementation* implementation = &comparison->implementations[e];
        status = balloon_implementation_create( comparison->fabric, &comparison->setting, implementation, error );
        if ( status == WISP_OK )
        {
            status = wisp_request_balloon_stats( implementation->world, implementation->entity, false );
        }
        comparison->variants[e] = ( bench_variant ){ .name = "wisp",
                                                     .step = surface_implementation_step,
                                                     .after = surface_implementation_keep_profile,
                                                     .context = implementation };
    }
    return status;
}

static void leave( const balloon_plan* plan, size_comparison* comparison )
{
    bench_free_samples( comparison->variants, plan->worker_count );
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        surface_implementation_destroy( &comparison->implementations[e] );
    }
    wisp_fabric_release( comparison->fabric );
    wisp_mesh_release( &comparison->mesh );
}

static wisp_status judge( const balloon_plan* plan, size_comparison* comparison, size_line* line, results* out,
                          wisp_error* error )
{
    uint64_t hashes[SCENARIO_IMPLEMENTATIONS_MAX] = { 0 };
    wisp_status status = WISP_OK;
    for ( int e = 0; e < plan->worker_count && status == WISP_OK; ++e )
    {
        for ( int s = 0; s < START_STEPS && status == WISP_OK; ++s )
        {
            status = surface_implementation_step( &comparison->implementations[e], error );
        }
        status = status == WISP_OK ? surface_implementation_hash( &comparison->implementations[e], &hashes[e], error )
                                   : status;
    }
    if ( status == WISP_OK )
    {
        char what[64];
        snprintf( what, sizeof( what ), "balloon of %d vertices", line->vertices );
        scenario_check_hashes( comparison->implementations, plan->worker_count, hashes, what, out );
        line->hash = hashes[0];
    }
    return status;
}

static void check( const size_comparison* comparison, const size_line* line, results* out )
{
    if ( !( fabs( line->read.volume_error ) <= BALLOON_TOLERATED_VOLUME ) )
    {
        results_add_failure( out,
                             "balloon of %d vertices: the volume differs from V_0 by %.2f %%, more than %.1f %%.",
                             line->vertices, 100.0 * line->read.volume_error, 100.0 * BALLOON_TOLERATED_VOLUME );
    }
    if ( comparison->implementations[0].halted_at > 0 )
    {
        results_add_failure( out, "balloon of %d vertices: halted at step %d.", line->vertices,
                             comparison->implementations[0].halted_at );
    }
}

static wisp_status run_line( const balloon_plan* plan, int level, double seconds, size_comparison* comparison,
                             size_line* line, results* out, wisp_error* error )
{
    wisp_status status = enter( plan, level, comparison, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    line->vertices = comparison->mesh.vertex_count;
    line->triangles = comparison->mesh.triangle_count;
    status = judge( plan, comparison, line, out, error );
    const bench_effort effort = { .seconds = seconds, .rounds_min = 2, .samples_max = SAMPLES_MAX };
    if ( status == WISP_OK )
    {
        status = bench_interleave( comparison->variants, plan->worker_count, &effort, error );
    }
    for ( int e = 0; e < plan->worker_count && status == WISP_OK; ++e )
    {
        line->ms[e] = bench_summarise( &comparison->variants[e] );
        line->volume_ms[e] = surface_implementation_pass_ms( &comparison->implementations[e], "balloon.volume" );
    }
    line->bytes = (double)wisp_world_memory( comparison->implementations[0].world ) / line->vertices;
    status = status == WISP_OK
                 ? balloon_read_all( &comparison->implementations[0], &comparison->setting, &line->read, error )
                 : status;
    if ( status == WISP_OK )
    {
        check( comparison, line, out );
    }
    return status;
}

// ---- rows and cells ----

static double ns_a_vertex( const size_line* line, int e )
{
    return 1e6 * line->ms[e].median / ( (double)line->vertices * BALLOON_SUBSTEPS );
}

static double ns_a_triangle( const size_line* line, int e )
{
    return 1e6 * line->volume_ms[e] / ( (double)line->triangles * BALLOON_SUBSTEPS * BALLOON_ITERATIONS );
}

static void add_rows( const balloon_plan* plan, const size_comparison* comparison, const size_line* line,
                      results* out )
{
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        results_row* row = results_add_row( out, "balloon", "icosphere" );
        if ( !row )
        {
            return;
        }
        results_put( &row->size, "vertices", line->vertices );
        results_put( &row->size, "triangles", line->triangles );
        results_put( &row->size, "bytes_a_vertex", line->bytes );
        row->workers = plan->workers[e];
        results_put_times( row, &line->ms[e] );
        profile_samples profile = comparison->implementations[e].profile;
        for ( int i = 0; i < profile.pass_count; ++i )
        {
            results_put( &row->stages, profile.passes[i].name, 1e3 * profile_samples_median( &profile, i ) );
        }
        snprintf( row->error_reference, sizeof( row->error_reference ), "closed form" );
        results_put( &row->error, "volume_stiffness", line->read.volume_error );
        results_put( &row->error, "closed_form_Pa", line->read.closed_form );
        results_put( &row->error, "virial_Pa", line->read.pressure[WISP_BALLOON_PRESSURE_VIRIAL] );
        results_put( &row->error, "multiplier_Pa", line->read.pressure[WISP_BALLOON_PRESSURE_MULTIPLIER] );
        results_put( &row->error, "gas_Pa", line->read.pressure[WISP_BALLOON_PRESSURE_GAS] );
        row->hash = line->hash;
        row->has_hash = true;
    }
}

static int begin_table( const balloon_plan* plan, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "vertices" );
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        cells_put( &row, "%d %s ms", plan->workers[e], bench_workers_word( plan->workers[e] ) );
        cells_put( &row, "p10 .. p90" );
        cells_put( &row, "%d %s ns per vertex and substep", plan->workers[e],
                   bench_workers_word( plan->workers[e] ) );
        cells_put( &row, "%d %s volume ns per triangle", plan->workers[e], bench_workers_word( plan->workers[e] ) );
    }
    cells_put( &row, "volume error %%" );
    cells_put( &row, "gas Pa" );
    cells_put( &row, "multiplier Pa" );
    cells_put( &row, "virial Pa" );
    cells_put( &row, "closed form Pa" );
    cells_put( &row, "bytes per vertex" );
    cells_put( &row, "samples" );
    cells_put( &row, "hash" );
    return cells_begin_table( &row, "Balloon: icospheres of 0.15 m filled to 1.2 times their volume, 10 x 2", out );
}

static void add_line( const balloon_plan* plan, const size_line* line, int table, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "%d", line->vertices );
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        cells_put_number( &row, line->ms[e].median, 3 );
        cells_put( &row, "%.3f .. %.3f", line->ms[e].p10, line->ms[e].p90 );
        cells_put_number( &row, ns_a_vertex( line, e ), 1 );
        cells_put_number( &row, ns_a_triangle( line, e ), 2 );
    }
    cells_put_number( &row, 100.0 * line->read.volume_error, 3 );
    cells_put_number( &row, line->read.pressure[WISP_BALLOON_PRESSURE_GAS], 0 );
    cells_put_number( &row, line->read.pressure[WISP_BALLOON_PRESSURE_MULTIPLIER], 0 );
    cells_put_number( &row, line->read.pressure[WISP_BALLOON_PRESSURE_VIRIAL], 0 );
    cells_put_number( &row, line->read.closed_form, 0 );
    cells_put_number( &row, line->bytes, 0 );
    cells_put( &row, "%d", line->ms[0].count );
    cells_put_hash( &row, line->hash );
    cells_end_row( &row, table, out );
}

static double ns_of( const results_row* row )
{
    return 1e6 * row->ms_median / ( rows_vertices( row ) * BALLOON_SUBSTEPS );
}

static void add_chart( int first_row, results* out )
{
    rows_chart_add( &( rows_chart ){ .first_row = first_row,
                                     .name = "balloon",
                                     .title = "Balloon: cost per vertex by size",
                                     .x_label = "vertices",
                                     .y_label = "ns per vertex and substep",
                                     .x = rows_vertices,
                                     .y = ns_of,
                                     .y_linear = true },
                    out );
}

// ---- checks ----

static void claim_flatness( const balloon_plan* plan, const size_line* lines, int e, results* out )
{
    double least = INFINITY, most = 0.0, vertices[BALLOON_SIZES_MAX], ms[BALLOON_SIZES_MAX];
    for ( int i = 0; i < plan->level_count; ++i )
    {
        least = fmin( least, ns_a_vertex( &lines[i], e ) );
        most = fmax( most, ns_a_vertex( &lines[i], e ) );
        vertices[i] = lines[i].vertices;
        ms[i] = lines[i].ms[e].median;
    }
    char claim[160];
    snprintf( claim, sizeof( claim ), "balloon, ns per vertex and substep with %d worker%s are flat within %.0f %%",
              plan->workers[e], plan->workers[e] == 1 ? "" : "s", 100.0 * ( CLAIM_FLAT - 1.0 ) );
    results_add_claim( out, most <= CLAIM_FLAT * least, claim, 100.0 * ( most / least - 1.0 ), " % apart" );
    if ( plan->level_count > 2 )
    {
        double r_squared = stats_fit_line( vertices, ms, plan->level_count ).r_squared;
        snprintf( claim, sizeof( claim ), "balloon, time against vertices with %d worker%s is a line, R^2 above %.2f",
                  plan->workers[e], plan->workers[e] == 1 ? "" : "s", CLAIM_R_SQUARED );
        results_add_claim( out, r_squared > CLAIM_R_SQUARED, claim, r_squared, "" );
    }
}

static void claim_volume( const balloon_plan* plan, const size_line* lines, results* out )
{
    double most = 0.0;
    for ( int i = 0; i < plan->level_count; ++i )
    {
        most = lines[i].triangles > CLAIM_VOLUME_TRIANGLES ? fmax( most, ns_a_triangle( &lines[i], 0 ) ) : most;
    }
    if ( most > 0.0 )
    {
        char claim[160];
        snprintf( claim, sizeof( claim ),
                  "volume, gradient and push, with 1 worker above %d triangles is under %.0f ns",
                  CLAIM_VOLUME_TRIANGLES, CLAIM_VOLUME_NS );
        results_add_claim( out, most < CLAIM_VOLUME_NS, claim, most, " ns a triangle" );
    }
}

wisp_status balloon_sizes( const balloon_plan* plan, results* out, wisp_error* error )
{
    size_line lines[BALLOON_SIZES_MAX] = { { 0 } };
    double deadline = wisp_clock_seconds() + plan->seconds;
    wisp_status status = WISP_OK;
    const int first_row = out->row_count;
    int table = begin_table( plan, out );
    for ( int i = 0; i < plan->level_count && status == WISP_OK; ++i )
    {
        size_comparison comparison = { 0 };
        double left = fmax( deadline - wisp_clock_seconds(), 0.0 ) / ( plan->level_count - i );
        status = run_line( plan, plan->levels[i], left, &comparison, &lines[i], out, error );
        if ( status == WISP_OK )
        {
            add_rows( plan, &comparison, &lines[i], out );
            add_line( plan, &lines[i], table, out );
        }
        leave( plan, &comparison );
    }
    if ( status == WISP_OK )
    {
        add_chart( first_row, out );
        claim_volume( plan, lines, out );
        for ( int e = 0; e < plan->worker_count; ++e )
        {
            claim_flatness( plan, lines, e, out );
        }
        results_add_note( out, "Balloon: volume and pressure are read after the timed steps, with one worker. Fine "
                               "meshes have run fewer steps and keep errors that travel one edge per pass." );
        results_add_note( out, "Balloon: the closed form is that of the mesh scaled to its computed volume." );
    }
    return status;
}
