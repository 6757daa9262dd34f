// Measure the error of points' normals relative to the sphere that the mesh approximates.
#include "boundary_bench.h"

#include <math.h>

static const double DEGREES = 57.29577951308232;
// With this, the longest edges have some points, on the finest sphere too.
static const float NORMAL_SPACING = 0.025f;

typedef struct angles
{
    double sum, most;
    int count;
} angles;

static double angle_of( const float* a, const float* b )
{
    double cross = 0.0, dot = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        const int n = ( k + 1 ) % 3, l = ( k + 2 ) % 3;
        const double c = (double)a[n] * (double)b[l] - (double)a[l] * (double)b[n];
        cross += c * c;
        dot += (double)a[k] * (double)b[k];
    }
    return DEGREES * atan2( sqrt( cross ), dot );
}

static void add_angle( angles* sum, double angle )
{
    sum->sum += angle;
    sum->most = angle > sum->most || isnan( angle ) ? angle : sum->most;
    sum->count += 1;
}

static double mean_of( const angles* sum )
{
    return sum->count > 0 ? sum->sum / sum->count : NAN;
}

typedef struct normal_observation
{
    angles edge, inner, turn; // from the direction of the position; between neighbours on an edge
} normal_observation;

static void observe_normals( const wisp_boundary_view* view, normal_observation* out )
{
    const wisp_samples* s = view->samples;
    *out = ( normal_observation ){ 0 };
    for ( int p = 0; p < s->count; ++p )
    {
        const float* n = s->normals + 4 * (size_t)p;
        add_angle( p < s->edge_count ? &out->edge : &out->inner, angle_of( n, s->xyzw + 4 * (size_t)p ) );
    }
    for ( int e = 0; e < view->edge_count; ++e )
    {
        for ( int p = s->begin[e] + 1; p < s->begin[e + 1]; ++p )
        {
            add_angle( &out->turn, angle_of( s->normals + 4 * (size_t)p, s->normals + 4 * (size_t)( p - 1 ) ) );
        }
    }
}

static wisp_status observe_sphere( int segments, normal_observation* observation, int* vertices, wisp_error* error )
{
    const wisp_boundary_def def = layer_def( &layer_laws[0], NORMAL_SPACING );
    wisp_mesh mesh = { 0 };
    wisp_fabric* fabric = NULL;
    layer_implementation implementation = { 0 };
    wisp_boundary_view view;
    wisp_status status = layer_sphere( segments, LAYER_RADIUS, &mesh, error );
    status = status == WISP_OK ? layer_cook( &mesh, &fabric, error ) : status;
    status = status == WISP_OK ? layer_enter( fabric, &def, 1, &implementation, error ) : status;
    status = status == WISP_OK ? layer_step( &implementation, error ) : status;
    status = status == WISP_OK ? layer_read( &implementation.surface, &view, error ) : status;
    if ( status == WISP_OK )
    {
        observe_normals( &view, observation );
        *vertices = mesh.vertex_count;
    }
    surface_implementation_destroy( &implementation.surface );
    wisp_fabric_release( fabric );
    wisp_mesh_release( &mesh );
    return status;
}

static void add_sphere( int segments, int vertices, const normal_observation* observation, bool met, int table,
                        results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "%d x %d", segments, segments );
    cells_put( &row, "%d", vertices );
    cells_put( &row, "%d", observation->edge.count );
    cells_put( &row, "%d", observation->inner.count );
    cells_put_number( &row, mean_of( &observation->edge ), 4 );
    cells_put_number( &row, observation->edge.most, 4 );
    cells_put_number( &row, mean_of( &observation->inner ), 4 );
    cells_put_number( &row, observation->inner.most, 4 );
    cells_put_number( &row, observation->turn.most, 4 );
    cells_put( &row, "%s", met ? "yes" : "NO" );
    cells_end_row( &row, table, out );
    results_row* line = results_add_row( out, "boundary", "normals" );
    if ( line != NULL )
    {
        line->workers = 1;
        results_put( &line->size, "vertices", vertices );
        results_put( &line->size, "points", observation->edge.count + observation->inner.count );
        snprintf( line->error_reference, sizeof( line->error_reference ), "sphere" );
        results_put( &line->error, "edge_mean_degrees", mean_of( &observation->edge ) );
        results_put( &line->error, "edge_max_degrees", observation->edge.most );
        results_put( &line->error, "inner_mean_degrees", mean_of( &observation->inner ) );
        results_put( &line->error, "inner_max_degrees", observation->inner.most );
    }
}

wisp_status boundary_normals( const boundary_plan* plan, results* out, wisp_error* error )
{
    static const char* const header[] = { "sphere",    "vertices",    "edge points", "inner points",    "edge, mean",
                                          "edge, max", "inner, mean", "inner, max",  "turn a gap, max", "met" };
    const int table = results_add_table( out,
                                         "Normals: degrees between a point's normal and its direction on spheres of "
                                         "2.5 m, d 0.025; should fall on finer meshes",
                                         WISP_COUNT( header ), header );
    wisp_status status = WISP_OK;
    double before = INFINITY;
    for ( int i = 0; i < plan->sphere_count && status == WISP_OK; ++i )
    {
        normal_observation observation = { 0 };
        int vertices = 0;
        status = observe_sphere( plan->segments[i], &observation, &vertices, error );
        const double mean =
            ( observation.edge.sum + observation.inner.sum ) / ( observation.edge.count + observation.inner.count );
        const bool met = mean < before;
        if ( status == WISP_OK )
        {
            add_sphere( plan->segments[i], vertices, &observation, met, table, out );
        }
        if ( status == WISP_OK && !met )
        {
            results_add_failure(
                out, "Normals: on the sphere of %d slices they are no more accurate than on a coarser one.",
                plan->segments[i] );
        }
        before = mean;
    }
    return status;
}
