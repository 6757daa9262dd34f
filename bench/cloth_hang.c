// The hanging cloth compared with other engines. Their times cannot be measured here: they are constants with a
// reference.
#include "cloth_bench.h"
#include "rows_chart.h"

#include <math.h>
#include <stdlib.h>

/// Times of others on the reference machine (performance notes: two virtual cores of an AVX-512 Xeon at about 3.4
/// GHz, gcc 12.2), each with its best settings for ten passes per step. NaN: not measured.
typedef struct peer_times
{
    int n;
    double nvcloth, nvcloth_wide; ///< ms, one thread: unmodified (SSE2), and a port to eight lanes
    double pbd[2];                ///< ms, PositionBasedDynamics 1 x 10, one and two threads
    double jolt[2];               ///< ms, Jolt 5.5, ten substeps, one and two threads
    double nvcloth_stretch[2];    ///< %, max and mean
    double pbd_stretch[2];
} peer_times;

static const peer_times peers[] = {
    { 32, 0.165, 0.109, { 0.82, 1.04 }, { 0.62, 0.52 }, { 21.0, 0.63 }, { 181.0, 4.7 } },
    { 64, 0.686, 0.459, { 4.74, 3.78 }, { 1.80, 1.44 }, { 80.0, 1.08 }, { 712.0, 10.2 } },
    { 128, 2.85, 1.88, { 24.5, 13.8 }, { 7.7, 6.1 }, { 406.0, 2.95 }, { 3797.0, 26.8 } },
    { 256, 12.7, 7.25, { 132.0, 76.5 }, { 35.0, 25.0 }, { NAN, NAN }, { NAN, NAN } },
};

static const cloth_setting setting = { "10 substeps", 10, 1, false, false, WISP_SOLVE_ORDER_COLOUR, 0 };

// Scalar C runs through the whole scenario only up to here: it takes seconds beyond.
#define PLAIN_SIZE_MAX 64

static int begin_table( const cloth_plan* plan, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "n" );
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        cells_put( &row, "%d %s ms", plan->workers[e], bench_workers_word( plan->workers[e] ) );
        cells_put( &row, "p10 .. p90" );
    }
    cells_put( &row, "stretch %%, max / mean" );
    cells_put( &row, "kinetic J" );
    cells_put( &row, "energy lost %%" );
    cells_put( &row, "hash" );
    cells_put( &row, "NvCloth, 8-wide ms*" );
    cells_put( &row, "its stretch %%*" );
    cells_put( &row, "PBD 1 / 2 threads ms*" );
    cells_put( &row, "its stretch %%*" );
    cells_put( &row, "Jolt 1 / 2 threads ms*" );
    return cells_begin_table( &row, "Hanging cloth n x n, 10 substeps of one pass, 60 + 100 steps of 1/60 s", out );
}

static const peer_times* find_times( int n )
{
    static const peer_times none = { 0, NAN, NAN, { NAN, NAN }, { NAN, NAN }, { NAN, NAN }, { NAN, NAN } };
    const peer_times* found = &none;
    for ( int i = 0; i < WISP_COUNT( peers ); ++i )
    {
        found = peers[i].n == n ? &peers[i] : found;
    }
    return found;
}

bool cloth_find_peer( int n, cloth_peer* out )
{
    const peer_times* peer = find_times( n );
    *out = ( cloth_peer ){ peer->nvcloth, peer->nvcloth_stretch[0], peer->nvcloth_stretch[1] };
    return isfinite( out->stretch_mean );
}

static void put_peers( int n, cells* row )
{
    const peer_times* peer = find_times( n );
    cells_put_pair( row, peer->nvcloth, 3, peer->nvcloth_wide, 3 );
    cells_put_pair( row, peer->nvcloth_stretch[0], 0, peer->nvcloth_stretch[1], 2 );
    cells_put_pair( row, peer->pbd[0], 2, peer->pbd[1], 2 );
    cells_put_pair( row, peer->pbd_stretch[0], 0, peer->pbd_stretch[1], 1 );
    cells_put_pair( row, peer->jolt[0], 2, peer->jolt[1], 2 );
}

static void add_line( const cloth_plan* plan, int n, const scenario_stats* f, int table, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "%d", n );
    scenario_put_times( f, plan->worker_count, &row );
    cells_put_pair( &row, 100.0 * f->stretch_max, 1, 100.0 * f->stretch_mean, 3 );
    cells_put_number( &row, f->kinetic, 0 );
    cells_put_number( &row, 100.0 * f->energy_lost, 2 );
    cells_put_hash( &row, f->hash[0] );
    put_peers( n, &row );
    cells_end_row( &row, table, out );
}

static wisp_status hang( const cloth_plan* plan, const cloth_scene* scene, wisp_fabric* fabric, int table,
                         results* out, wisp_error* error )
{
    surface_implementation implementations[SCENARIO_IMPLEMENTATIONS_MAX] = { { 0 } };
    scenario_stats stats;
    wisp_status status = WISP_OK;
    for ( int e = 0; e < plan->worker_count && status == WISP_OK; ++e )
    {
        status = cloth_implementation_create( scene, fabric, &setting, NULL, plan->workers[e], &implementations[e],
                                              error );
    }
    if ( status == WISP_OK )
    {
        status = scenario_run( implementations, plan->worker_count, &plan->scenario, NULL, NULL, &stats, error );
    }
    if ( status == WISP_OK )
    {
        char what[64];
        snprintf( what, sizeof( what ), "hanging cloth %d", scene->n );
        scenario_check_hashes( implementations, plan->worker_count, stats.hash, what, out );
        scenario_add_rows( implementations, plan->worker_count, &stats, "cloth.hang", setting.name, "rest lengths",
                           out );
        add_line( plan, scene->n, &stats, table, out );
        if ( stats.halted_at > 0 )
        {
            results_add_failure( out, "%s: halted at step %d.", what, stats.halted_at );
        }
    }
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        surface_implementation_destroy( &implementations[e] );
    }
    return status;
}

// ---- scalar C through the scenario ----

static double plain_stretch( const plain_cloth* cloth )
{
    double largest = 0.0;
    for ( int i = 0; i < cloth->edge_count; ++i )
    {
        wisp_vec3 a = cloth->position[cloth->links[i].a], b = cloth->position[cloth->links[i].b];
        double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
        double stretch = fabs( sqrt( x * x + y * y + z * z ) / (double)cloth->links[i].rest - 1.0 );
        largest = stretch <= largest ? largest : stretch;
    }
    return largest;
}

// A cloth a thousand times its proper length is lost, finite or not.
#define LOST_STRETCH 1e3

static wisp_status follow_plain( const cloth_plan* plan, const cloth_scene* scene, results* out, wisp_error* error )
{
    plain_cloth cloth;
    if ( !plain_cloth_create( &cloth, scene->mesh.points, scene->mesh.vertex_count, scene->mesh.triangles,
                              scene->mesh.triangle_count, 1.0f, CLOTH_BEND_STIFFNESS ) )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the scalar C version of %d vertices",
                          scene->mesh.vertex_count );
    }
    plain_cloth_pin( &cloth, scene->pins[0] );
    plain_cloth_pin( &cloth, scene->pins[1] );
    cloth.substeps = setting.substeps;
    int steps = plan->scenario.warm_steps + plan->scenario.measured_steps, lost_at = 0;
    for ( int step = 1; step <= steps && lost_at == 0; ++step )
    {
        plain_cloth_step( &cloth, CLOTH_STEP );
        lost_at = plain_stretch( &cloth ) < LOST_STRETCH ? 0 : step;
    }
    if ( lost_at > 0 )
    {
        results_add_note( out, "Scalar C in mesh order, n = %d: blew up at step %d.", scene->n, lost_at );
    }
    else
    {
        results_add_note( out, "Scalar C in mesh order, n = %d: largest stretch %.1f %% at the end.", scene->n,
                          100.0 * plain_stretch( &cloth ) );
    }
    plain_cloth_destroy( &cloth );
    return WISP_OK;
}

wisp_status cloth_hang( const cloth_plan* plan, results* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    const int first_row = out->row_count;
    int table = begin_table( plan, out );
    for ( int i = 0; i < plan->hang_count && status == WISP_OK; ++i )
    {
        cloth_scene scene = { 0 };
        wisp_fabric* fabric = NULL;
        status = cloth_scene_make( plan->hang_sizes[i], false, &scene, error );
        status = status == WISP_OK ? cloth_cook( &scene, &setting, &fabric, error ) : status;
        status = status == WISP_OK ? hang( plan, &scene, fabric, table, out, error ) : status;
        if ( status == WISP_OK && scene.n <= PLAIN_SIZE_MAX )
        {
            status = follow_plain( plan, &scene, out, error );
        }
        wisp_fabric_release( fabric );
        cloth_scene_free( &scene );
    }
    rows_chart_add( &( rows_chart ){ .first_row = first_row,
                                     .name = "cloth.hang",
                                     .title = "Hanging cloth, 10 substeps: time against size",
                                     .x_label = "vertices",
                                     .y_label = "ms per step",
                                     .x = rows_vertices,
                                     .y = rows_ms },
                    out );
    results_add_note( out,
                      "* on the reference machine: two virtual cores of an AVX-512 Xeon at 3.4 GHz, gcc 12.2, best "
                      "settings of each engine for ten passes per step. The largest NvCloth is 255 x 255." );
    results_add_note(
        out,
        "* NvCloth: 10 iterations; PositionBasedDynamics: 1 step of 10; Jolt 5.5: 10 substeps, 0.001 kg per vertex, "
        "damping 0.1/s. At zero compliance Jolt's cloth of 64 and 128 blows up at every substep count." );
    results_add_note( out,
                      "Hanging cloth: stretch is the mean of samples every %d steps. The scene has no damping, so "
                      "the potential energy lost of that released in the first %d steps is the solver's.",
                      plan->scenario.turn_steps, plan->scenario.warm_steps );
    return status;
}
