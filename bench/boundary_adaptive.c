// Adaptive spacing (extension, not in the boundary particle paper): one spacing compared with as many points that are
// closer where the body is curved. The measure is the turn of the normal from one point of an edge to the next.
#include "boundary_bench.h"
#include "bench_timing.h"

#include "oracle/boundary_oracle.h"

#include <math.h>
#include <stdlib.h>

enum
{
    GAINS = 3,
    HALVINGS = 14, // of the interval in which the spacing with as many points is searched
    SAMPLES_MAX = 200,
    ROUNDS_MIN = 3,
    PAIR = 2, // by curvature, and at one spacing
};

static const float gains[GAINS] = { 2.0f, 6.0f, 12.0f }; // 1/rad
static const float WIDEST = 0.008f;                      // m, on flat parts
static const float NARROWEST = 0.0005f;
static const double DEGREES = 57.29577951308232;

typedef struct body
{
    const boundary_plan* plan;
    wisp_mesh mesh;
    const char* name;
    wisp_fabric* fabric;
    double3* normals; // [vertex_count]
} body;

typedef struct turns
{
    double mean, p99, most; // degrees per gap
} turns;

static wisp_status find_normals( body* b, wisp_error* error )
{
    const size_t bytes = (size_t)b->mesh.vertex_count * sizeof( double3 );
    double3* points = malloc( bytes );
    b->normals = malloc( bytes );
    if ( points == NULL || b->normals == NULL )
    {
        free( points );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for normals" );
    }
    for ( int v = 0; v < b->mesh.vertex_count; ++v )
    {
        const wisp_vec3 p = b->mesh.points[v];
        points[v] = double3_make( (double)p.x, (double)p.y, (double)p.z );
    }
    boundary_oracle_vertex_normals( points, b->mesh.vertex_count, b->mesh.triangles, b->mesh.triangle_count,
                                    b->normals );
    free( points );
    return WISP_OK;
}

static double angle_between( double3 a, double3 b )
{
    const double3 c = double3_cross( a, b );
    return DEGREES * atan2( sqrt( double3_dot( c, c ) ), double3_dot( a, b ) );
}

static int compare_doubles( const void* a, const void* b )
{
    const double x = *(const double*)a, y = *(const double*)b;
    return ( x > y ) - ( x < y );
}

static wisp_status find_turns( const body* b, const wisp_boundary_view* view, turns* out, wisp_error* error )
{
    const wisp_samples* s = view->samples;
    int count = 0;
    double sum = 0.0;
    double* all = malloc( (size_t)( s->edge_count + view->edge_count ) * sizeof( double ) );
    if ( all == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for angles" );
    }
    for ( int e = 0; e < view->edge_count; ++e )
    {
        double3 last = b->normals[view->edges[2 * e]];
        for ( int p = s->begin[e]; p <= s->begin[e + 1]; ++p )
        {
            const float* n = s->normals + 4 * (size_t)p;
            const double3 next = p < s->begin[e + 1] ? double3_make( (double)n[0], (double)n[1], (double)n[2] )
                                                     : b->normals[view->edges[2 * e + 1]];
            all[count++] = angle_between( last, next );
            sum += all[count - 1];
            last = next;
        }
    }
    qsort( all, (size_t)count, sizeof( double ), compare_doubles );
    *out = ( turns ){ sum / count, stats_quantile( all, count, 0.99 ), all[count - 1] };
    free( all );
    return WISP_OK;
}

// ---- a pair ----

static wisp_status count_points( layer_implementation* implementation, int* points, wisp_error* error )
{
    wisp_boundary_stats stats = { 0 };
    wisp_status status = layer_set( &implementation->surface, &implementation->def, error );
    status = status == WISP_OK ? layer_step( implementation, error ) : status;
    status = status == WISP_OK ? layer_read_stats( &implementation->surface, &stats, error ) : status;
    *points = stats.points;
    return status;
}

// The spacing with as many points as another layer, or nearly.
static wisp_status match( layer_implementation* implementation, int requested, float* spacing, wisp_error* error )
{
    float lower = NARROWEST, upper = WIDEST;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < HALVINGS && status == WISP_OK; ++i )
    {
        int points = 0;
        implementation->def.spacing = sqrtf( lower * upper );
        status = count_points( implementation, &points, error );
        lower = points >= requested ? implementation->def.spacing : lower;
        upper = points >= requested ? upper : implementation->def.spacing;
    }
    *spacing = lower;
    return status;
}

// In a separate world that is closed again, so that the timed one has no memory of larger layers.
static wisp_status find_spacing( const body* b, int requested, float* spacing, wisp_error* error )
{
    const wisp_boundary_def def = layer_def( &layer_laws[0], WIDEST );
    layer_implementation implementation;
    wisp_status status = layer_enter( b->fabric, &def, 1, &implementation, error );
    if ( status == WISP_OK )
    {
        status = match( &implementation, requested, spacing, error );
        surface_implementation_destroy( &implementation.surface );
    }
    return status;
}

static wisp_status enter_pair( const body* b, float gain, layer_implementation pair[PAIR], wisp_error* error )
{
    wisp_boundary_def def = layer_def( &layer_laws[0], WIDEST );
    def.curvature_gain = gain;
    def.min_spacing = NARROWEST;
    def.max_spacing = WIDEST;
    int points = 0;
    float spacing = WIDEST;
    wisp_status status = layer_enter( b->fabric, &def, 1, pair, error );
    status = status == WISP_OK ? count_points( pair, &points, error ) : status;
    status = status == WISP_OK ? find_spacing( b, points, &spacing, error ) : status;
    def = layer_def( &layer_laws[0], spacing );
    return status == WISP_OK ? layer_enter( b->fabric, &def, 1, pair + 1, error ) : status;
}

static wisp_status time_pair( const body* b, layer_implementation pair[PAIR], wisp_error* error )
{
    bench_variant variants[PAIR] = { { 0 } };
    const bench_effort effort = { b->plan->adaptive_seconds / GAINS, ROUNDS_MIN, SAMPLES_MAX };
    for ( int k = 0; k < PAIR; ++k )
    {
        variants[k] = ( bench_variant ){
            .name = "layer", .step = layer_step, .after = layer_keep_profile, .context = pair + k
        };
    }
    wisp_status status = bench_interleave( variants, PAIR, &effort, error );
    bench_free_samples( variants, PAIR );
    return status;
}

static void add_row( layer_implementation* implementation, const char* name, const wisp_boundary_stats* stats,
                     const turns* turn, const char* met, int table, results* out )
{
    const stats_summary ms = layer_pass_ms( &implementation->surface, "boundary.points" );
    const stats_summary spacing = layer_pass_ms( &implementation->surface, "boundary.spacing" );
    cells row = { .count = 0 };
    cells_put( &row, "%s", name );
    cells_put_number( &row, 1e3 * (double)implementation->def.spacing, 3 );
    cells_put( &row, "%d", stats->edge_points );
    cells_put( &row, "%d", stats->inner_points );
    cells_put_number( &row, turn->mean, 2 );
    cells_put_number( &row, turn->p99, 2 );
    cells_put_number( &row, turn->most, 2 );
    cells_put_number( &row, ms.median, 4 );
    cells_put_number( &row, spacing.median, 4 );
    cells_put_number( &row, (double)stats->bytes / stats->points, 0 );
    cells_put( &row, "%s", met );
    cells_end_row( &row, table, out );
    results_row* line = results_add_row( out, "boundary", name );
    if ( line != NULL )
    {
        line->workers = 1;
        results_put_times( line, &ms );
        results_put( &line->size, "points", stats->points );
        results_put( &line->size, "spacing_m", (double)implementation->def.spacing );
        results_put( &line->stages, "boundary.points", ms.median );
        results_put( &line->stages, "boundary.spacing", spacing.median );
        snprintf( line->error_reference, sizeof( line->error_reference ), "vertex normals" );
        results_put( &line->error, "turn_mean_degrees", turn->mean );
        results_put( &line->error, "turn_p99_degrees", turn->p99 );
    }
}

static wisp_status run_gain( const body* b, float gain, int table, results* out, wisp_error* error )
{
    layer_implementation pair[PAIR] = { { .amplitude = 0.0 } };
    wisp_boundary_stats stats[PAIR];
    turns turn[PAIR];
    wisp_status status = enter_pair( b, gain, pair, error );
    status = status == WISP_OK ? time_pair( b, pair, error ) : status;
    for ( int k = 0; k < PAIR && status == WISP_OK; ++k )
    {
        wisp_boundary_view view;
        status = layer_read( &pair[k].surface, &view, error );
        status = status == WISP_OK ? layer_read_stats( &pair[k].surface, stats + k, error ) : status;
        status = status == WISP_OK ? find_turns( b, &view, turn + k, error ) : status;
    }
    if ( status == WISP_OK )
    {
        char name[40];
        const bool met = turn[0].p99 < turn[1].p99 && stats[0].points <= stats[1].points;
        snprintf( name, sizeof( name ), "curvature, gain %g", (double)gain );
        add_row( pair, name, stats, turn, met ? "yes" : "NO", table, out );
        add_row( pair + 1, "as many at one spacing", stats + 1, turn + 1, "", table, out );
        if ( !met )
        {
            results_add_failure( out,
                                 "Adaptive spacing: with a gain of %g normals turn no less than at uniform spacing.",
                                 (double)gain );
        }
    }
    surface_implementation_destroy( &pair[0].surface );
    surface_implementation_destroy( &pair[1].surface );
    return status;
}

wisp_status boundary_adaptive( const boundary_plan* plan, results* out, wisp_error* error )
{
    static const char* const header[] = { "spacing",   "d, mm", "edge",        "inner",      "turn, mean",
                                          "p99",       "most",  "in place ms", "spacing ms", "bytes per point",
                                          "turns less" };
    body b = { .plan = plan };
    wisp_status status = balloon_mesh_figure( &b.mesh, &b.name, error );
    status = status == WISP_OK ? layer_cook( &b.mesh, &b.fabric, error ) : status;
    status = status == WISP_OK ? find_normals( &b, error ) : status;
    char title[160];
    snprintf( title, sizeof( title ),
              "Adaptive spacing: the %s, by curvature and with as many points at uniform spacing; turn: degrees "
              "between points of an edge",
              b.name );
    const int table = results_add_table( out, title, WISP_COUNT( header ), header );
    for ( int i = 0; i < GAINS && status == WISP_OK; ++i )
    {
        status = run_gain( &b, gains[i], table, out, error );
    }
    free( b.normals );
    wisp_fabric_release( b.fabric );
    wisp_mesh_release( &b.mesh );
    return status;
}
