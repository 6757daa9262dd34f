// The case `boundary`: the number of points for a spacing, their cost, and how densely they cover the surface.
#include "boundary_bench.h"

#include "bench.h"
#include "bench_output.h"
#include "mesh.h"

#include "suite_measure.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float LITTLE_HYSTERESIS = 1e-6f; // of a spacing

const layer_law layer_laws[LAYER_LAWS] = {
    { "even", WISP_SPACING_EVEN, WISP_ROUND_DOWN },
    { "exact", WISP_SPACING_EXACT, WISP_ROUND_DOWN },
    { "even, up", WISP_SPACING_EVEN, WISP_ROUND_UP },
};

wisp_status layer_sphere( int segments, float radius, wisp_mesh* out, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_UV_SPHERE );
    generator.segments = generator.rings = segments;
    generator.radius = radius;
    return wisp_mesh_generate( &generator, out, error );
}

wisp_status layer_cook( const wisp_mesh* mesh, wisp_fabric** out, wisp_error* error )
{
    wisp_fabric_def def = wisp_default_fabric_def();
    def.bend_links = false;
    return surface_cook( mesh, def, out, error );
}

wisp_boundary_def layer_def( const layer_law* law, float spacing )
{
    wisp_boundary_def def = wisp_default_boundary_def();
    def.spacing = spacing;
    def.policy = law->policy;
    def.rounding = law->rounding;
    return def;
}

// ---- implementations ----

static wisp_status set_layer( surface_implementation* implementation, const wisp_boundary_def* def,
                              wisp_error* error )
{
    wisp_status status = wisp_set_boundary( implementation->world, implementation->entity, def );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

wisp_status layer_enter( wisp_fabric* fabric, const wisp_boundary_def* def, int workers, layer_implementation* out,
                         wisp_error* error )
{
    *out = ( layer_implementation ){ .def = *def };
    surface_generator generator = surface_default_generator( &wisp_boundary_module, fabric );
    generator.workers = workers;
    wisp_status status = surface_implementation_create( &generator, &out->surface, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = set_layer( &out->surface, def, error );
    if ( status != WISP_OK )
    {
        surface_implementation_destroy( &out->surface );
    }
    return status;
}

// A layer that is set again with the same definition keeps its weights where counts are the same. Another hysteresis
// drops all of them; so small a change affects no count, except for lengths that are a whole number of spacings
// within the rounding of a float.
static wisp_status sample_again( layer_implementation* implementation, wisp_error* error )
{
    wisp_boundary_def def = implementation->def;
    implementation->has_little = !implementation->has_little;
    def.hysteresis += implementation->has_little ? LITTLE_HYSTERESIS : 0.0f;
    return set_layer( &implementation->surface, &def, error );
}

wisp_status layer_step( void* context, wisp_error* error )
{
    layer_implementation* implementation = context;
    wisp_status status = implementation->is_resampled ? sample_again( implementation, error ) : WISP_OK;
    return status == WISP_OK ? surface_implementation_step( &implementation->surface, error ) : status;
}

static wisp_status keep_layer_profile( void* context )
{
    layer_implementation* implementation = context;
    return surface_implementation_keep_profile( &implementation->surface );
}

static stats_summary pass_ms( surface_implementation* implementation, const char* pass )
{
    stats_summary ms = { .median = NAN, .p10 = NAN, .p90 = NAN, .minimum = NAN };
    for ( int i = 0; i < implementation->profile.pass_count; ++i )
    {
        profile_pass* kept = implementation->profile.passes + i;
        if ( strcmp( kept->name, pass ) == 0 )
        {
            ms = stats_summarise( kept->seconds, kept->count );
            ms.median *= 1e3;
            ms.p10 *= 1e3;
            ms.p90 *= 1e3;
            ms.minimum *= 1e3;
        }
    }
    return ms;
}

// ---- outputs of a layer ----

wisp_status layer_read( surface_implementation* implementation, wisp_boundary_view* out, wisp_error* error )
{
    wisp_status status = wisp_read_boundary( implementation->world, implementation->entity, out );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

wisp_status layer_read_stats( surface_implementation* implementation, wisp_boundary_stats* out, wisp_error* error )
{
    wisp_status status = wisp_read_boundary_stats( implementation->world, implementation->entity, out );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

uint64_t layer_hash( const wisp_boundary_view* view )
{
    const wisp_samples* s = view->samples;
    const size_t bytes = (size_t)s->count * 4 * sizeof( float );
    const int32_t counts[2] = { s->count, s->edge_count };
    uint64_t hash = suite_hash_bytes( counts, sizeof( counts ), SUITE_HASH_BEGIN );
    hash = suite_hash_bytes( s->xyzw, bytes, hash );
    hash = suite_hash_bytes( s->normals, bytes, hash );
    hash = suite_hash_bytes( s->parents, bytes, hash );
    return suite_hash_bytes( s->weights, bytes, hash );
}

// ---- how densely a layer covers its surface ----

enum
{
    PARTS = 24, // of each side of a triangle: 325 positions
};

static int find_edge( const wisp_boundary_view* view, int32_t a, int32_t b )
{
    const int32_t lower = a < b ? a : b, upper = a < b ? b : a;
    int first = 0, end = view->edge_count;
    while ( first < end )
    {
        const int middle = first + ( end - first ) / 2;
        const int32_t* e = view->edges + 2 * (size_t)middle;
        const bool below = e[0] < lower || ( e[0] == lower && e[1] < upper );
        first = below ? middle + 1 : first;
        end = below ? end : middle;
    }
    WISP_ASSERT( first < view->edge_count );
    return first;
}

static double square_of( double x, double y, double z )
{
    return x * x + y * y + z * z;
}

static wisp_vec3 place( const wisp_samples* s, int point )
{
    const float* q = s->xyzw + 4 * (size_t)point;
    return ( wisp_vec3 ){ q[0], q[1], q[2] };
}

static double square_between( wisp_vec3 a, wisp_vec3 b )
{
    return square_of( (double)a.x - (double)b.x, (double)a.y - (double)b.y, (double)a.z - (double)b.z );
}

static double largest_gap( const wisp_boundary_view* view, const wisp_mesh* mesh )
{
    const wisp_samples* s = view->samples;
    double most = 0.0;
    for ( int e = 0; e < view->edge_count; ++e )
    {
        wisp_vec3 last = mesh->points[view->edges[2 * e]];
        for ( int p = s->begin[e]; p < s->begin[e + 1]; ++p )
        {
            most = fmax( most, square_between( last, place( s, p ) ) );
            last = place( s, p );
        }
        most = fmax( most, square_between( last, mesh->points[view->edges[2 * e + 1]] ) );
    }
    return sqrt( most );
}

// The points on a triangle, on its sides and at its corners.
typedef struct crowd
{
    wisp_vec3* points;
    int count, capacity;
} crowd;

static int gather_range( crowd* all, const wisp_samples* s, int element )
{
    for ( int p = s->begin[element]; p < s->begin[element + 1] && all->points != NULL; ++p )
    {
        all->points[all->count++] = place( s, p );
    }
    return s->begin[element + 1] - s->begin[element];
}

// @return their number; without memory for them they are only counted
static int gather( crowd* all, const wisp_boundary_view* view, const wisp_mesh* mesh, int triangle )
{
    const int32_t* corner = mesh->triangles + 3 * (size_t)triangle;
    int count = 3 + gather_range( all, view->samples, view->edge_count + triangle );
    for ( int k = 0; k < 3; ++k )
    {
        count += gather_range( all, view->samples, find_edge( view, corner[k], corner[( k + 1 ) % 3] ) );
        if ( all->points != NULL )
        {
            all->points[all->count++] = mesh->points[corner[k]];
        }
    }
    return count;
}

static double farthest_place( const crowd* all, const wisp_vec3 corner[3] )
{
    double most = 0.0;
    for ( int i = 0; i <= PARTS; ++i )
    {
        for ( int j = 0; i + j <= PARTS; ++j )
        {
            const float u = (float)i / PARTS, v = (float)j / PARTS, w = 1.0f - u - v;
            const wisp_vec3 at = { u * corner[0].x + v * corner[1].x + w * corner[2].x,
                                   u * corner[0].y + v * corner[1].y + w * corner[2].y,
                                   u * corner[0].z + v * corner[1].z + w * corner[2].z };
            float least = INFINITY;
            for ( int p = 0; p < all->count; ++p )
            {
                const wisp_vec3 q = all->points[p];
                const float x = q.x - at.x, y = q.y - at.y, z = q.z - at.z, square = x * x + y * y + z * z;
                least = square < least ? square : least;
            }
            most = fmax( most, (double)least );
        }
    }
    return sqrt( most );
}

wisp_status layer_find_cover( const wisp_boundary_view* view, const wisp_mesh* mesh, layer_cover* out,
                              wisp_error* error )
{
    crowd all = { 0 };
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int count = gather( &all, view, mesh, t );
        all.capacity = count > all.capacity ? count : all.capacity;
    }
    all.points = malloc( (size_t)all.capacity * sizeof( wisp_vec3 ) );
    if ( all.points == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the points on a triangle" );
    }
    *out = ( layer_cover ){ .gap = largest_gap( view, mesh ) };
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int32_t* c = mesh->triangles + 3 * (size_t)t;
        const wisp_vec3 corner[3] = { mesh->points[c[0]], mesh->points[c[1]], mesh->points[c[2]] };
        all.count = 0;
        gather( &all, view, mesh, t );
        out->reach = fmax( out->reach, farthest_place( &all, corner ) );
    }
    free( all.points );
    return WISP_OK;
}

// ---- the cost of points ----

enum
{
    LAYER_SAMPLES_MAX = 200,
    ROUNDS_MIN = 3,
    IN_PLACE = 0,  // case A everywhere
    RESAMPLED = 1, // case B everywhere
    SAMPLINGS = 2,
    VARIANTS = SAMPLINGS * BOUNDARY_WORKERS_MAX,
};

static const char* const sampling_names[SAMPLINGS] = { "in place", "resampled" };

/// Results for one spacing and one rule.
typedef struct layer_cost
{
    const layer_law* law;
    float spacing;
    int points, edge_points;
    layer_cover cover;
    stats_summary ms[SAMPLINGS][BOUNDARY_WORKERS_MAX]; // of the pass that computes the points
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
} cost_run;

// ---- measuring ----

static wisp_status enter_all( cost_run* run, const layer_cost* cost, bench_variant* variants, wisp_error* error )
{
    const boundary_plan* plan = run->plan;
    const wisp_boundary_def def = layer_def( cost->law, cost->spacing );
    wisp_status status = WISP_OK;
    for ( int i = 0; i < SAMPLINGS * plan->worker_count && status == WISP_OK; ++i )
    {
        status = layer_enter( run->fabric, &def, plan->workers[i / SAMPLINGS], run->implementations + i, error );
        run->implementations[i].is_resampled = i % SAMPLINGS == RESAMPLED;
        variants[i] = ( bench_variant ){ .name = sampling_names[i % SAMPLINGS],
                                         .step = layer_step,
                                         .after = keep_layer_profile,
                                         .context = run->implementations + i };
    }
    return status;
}

static void read_times( cost_run* run, layer_cost* cost )
{
    for ( int i = 0; i < SAMPLINGS * run->plan->worker_count; ++i )
    {
        cost->ms[i % SAMPLINGS][i / SAMPLINGS] = pass_ms( &run->implementations[i].surface, "boundary.points" );
    }
}

static wisp_status observe_layer( cost_run* run, layer_cost* cost, wisp_error* error )
{
    wisp_boundary_stats stats = { 0 };
    wisp_boundary_view view;
    wisp_status status = layer_read_stats( &run->implementations[0].surface, &stats, error );
    cost->points = stats.points;
    cost->edge_points = stats.edge_points;
    cost->bytes = stats.bytes;
    cost->same_hash = true;
    for ( int i = 0; i < SAMPLINGS * run->plan->worker_count && status == WISP_OK; ++i )
    {
        status = layer_read( &run->implementations[i].surface, &view, error );
        const uint64_t hash = status == WISP_OK ? layer_hash( &view ) : 0;
        cost->hash = i == 0 ? hash : cost->hash;
        cost->same_hash = cost->same_hash && hash == cost->hash;
    }
    return status == WISP_OK ? layer_find_cover( &view, &run->mesh, &cost->cover, error ) : status;
}

static wisp_status measure_layer( cost_run* run, layer_cost* cost, double seconds, wisp_error* error )
{
    bench_variant variants[VARIANTS] = { { 0 } };
    const int count = SAMPLINGS * run->plan->worker_count;
    const bench_effort effort = { seconds, ROUNDS_MIN, LAYER_SAMPLES_MAX };
    wisp_status status = enter_all( run, cost, variants, error );
    if ( status == WISP_OK )
    {
        status = bench_interleave( variants, count, &effort, error );
        bench_free_samples( variants, count );
    }
    if ( status == WISP_OK )
    {
        read_times( run, cost );
        status = observe_layer( run, cost, error );
    }
    for ( int i = 0; i < count; ++i )
    {
        surface_implementation_destroy( &run->implementations[i].surface );
    }
    return status;
}

// ---- rows ----

static void add_cost_rows( const cost_run* run, const layer_cost* cost, results* out )
{
    for ( int i = 0; i < SAMPLINGS * run->plan->worker_count; ++i )
    {
        char variant[64];
        snprintf( variant, sizeof( variant ), "%s, %s", cost->law->name, sampling_names[i % SAMPLINGS] );
        const stats_summary* ms = &cost->ms[i % SAMPLINGS][i / SAMPLINGS];
        results_row* row = results_add_row( out, "boundary", variant );
        if ( row != NULL )
        {
            row->workers = run->plan->workers[i / SAMPLINGS];
            results_put_times( row, ms );
            row->hash = cost->hash;
            row->has_hash = true;
            results_put( &row->size, "points", cost->points );
            results_put( &row->size, "edge_points", cost->edge_points );
            results_put( &row->size, "spacing_m", (double)cost->spacing );
            results_put( &row->size, "bytes", (double)cost->bytes );
            results_put( &row->stages, "boundary.points", ms->median );
            results_put( &row->error, "gap_m", cost->cover.gap );
            results_put( &row->error, "cover_m", cost->cover.reach );
        }
    }
}

static void check_hash( const layer_cost* cost, results* out )
{
    if ( !cost->same_hash )
    {
        results_add_failure(
            out,
            "Cost of points: at d = %g m, %s, points depend on the number of workers, or on whether they "
            "were sampled again.",
            (double)cost->spacing, cost->law->name );
    }
}

static void add_costs( const cost_run* run, const layer_cost* cost, int table, results* out )
{
    const int workers = run->plan->worker_count;
    const double ns = 1e6 / fmax( cost->points, 1.0 );
    results_cells row = { .count = 0 };
    cells_put( &row, "%g\t%s\t%d", (double)cost->spacing, cost->law->name, cost->points );
    for ( int i = 0; i < SAMPLINGS * BOUNDARY_WORKERS_MAX; ++i )
    {
        const int way = i / BOUNDARY_WORKERS_MAX, w = i % BOUNDARY_WORKERS_MAX;
        cells_put( &row, "%.2f", w < workers ? ns * cost->ms[way][w].median : NAN );
    }
    cells_put( &row, "%.2f\t%.2f\t%.0f\t%.2f", cost->ms[RESAMPLED][0].median / cost->ms[IN_PLACE][0].median,
               workers > 1 ? cost->ms[IN_PLACE][0].median / cost->ms[IN_PLACE][1].median : NAN,
               (double)cost->bytes / fmax( cost->points, 1.0 ), 1e-6 * (double)cost->bytes );
    cells_end_row( &row, table, out );
}

static void add_accuracy( const layer_cost* cost, int table, results* out )
{
    const double d = (double)cost->spacing;
    const bool covers = cost->law->rounding == WISP_ROUND_UP || cost->law->policy == WISP_SPACING_EXACT;
    // the last gap is a difference of rounded positions; even spacing rounded down has gaps below 2 d
    const bool met = cost->cover.gap <= ( covers ? 1.0 : 2.0 ) * d + 1e-5;
    results_cells row = { .count = 0 };
    cells_put( &row, "%g\t%s\t%.2f\t%.3f\t%.2f\t%.3f\t%d\t%.4f\t%.4f\t%.2f\t%s", d, cost->law->name,
               1e3 * cost->cover.gap, cost->cover.gap / d, 1e3 * cost->cover.reach, cost->cover.reach / d,
               cost->points, cost->ms[IN_PLACE][0].median, cost->ms[RESAMPLED][0].median, 1e-6 * (double)cost->bytes,
               met ? "yes" : "NO" );
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

static void add_cost_chart( const cost_run* run, int first_row, results* out )
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
    const int w = run->plan->workers[run->plan->worker_count - 1];
    results_cells costs = { .count = 0 };
    char title[160];
    cells_put( &costs,
               "d\tspacing\tpoints\tin place\tin place, %d workers\tresampled\tresampled, %d workers\tresampled / in "
               "place\t1 worker / more\tbytes per point\tMB",
               w, w );
    for ( int i = 0; i < run->count; ++i )
    {
        add_cost_rows( run, run->costs + i, out );
        check_hash( run->costs + i, out );
    }
    snprintf(
        title, sizeof( title ),
        "Cost of points: ns per point, medians of the pass that makes them, 1 worker where not stated; memory" );
    int table = cells_begin_table( &costs, title, out );
    for ( int i = 0; i < run->count; ++i )
    {
        add_costs( run, run->costs + i, table, out );
    }
    table = results_begin_table(
        out,
        "Coverage against cost: the largest gap along edges, and the largest distance from a "
        "place on a triangle to its points; 1 worker",
        "d\tspacing\tgap, mm\tgap / d\tcover, mm\tcover / d\tpoints\tin place ms\tresampled ms\tMB\tmet" );
    for ( int i = 0; i < run->count; ++i )
    {
        add_accuracy( run->costs + i, table, out );
    }
    add_cost_chart( run, first_row, out );
    results_add_note( out, "Cost of points: in place: no count changes (case A). resampled: every element is sampled "
                           "again in every step (case B). bytes: the whole layer, points twice." );
    results_add_note( out,
                      "Coverage: distances are measured at 325 places of each triangle. Points, normals and recipes "
                      "have one hash in both cases and for every worker count." );
}

wisp_status boundary_bench_run( const boundary_plan* plan, results* out, wisp_error* error )
{
    cost_run run = { .plan = plan, .out = out };
    wisp_status status = layer_sphere( LAYER_SEGMENTS, LAYER_RADIUS, &run.mesh, error );
    status = status == WISP_OK ? layer_cook( &run.mesh, &run.fabric, error ) : status;
    const int count = plan->spacing_count * LAYER_LAWS;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        bench_progress( plan->options, (double)i / count, "boundary" );
        layer_cost* cost = run.costs + i;
        *cost = ( layer_cost ){ .law = layer_laws + i % LAYER_LAWS, .spacing = plan->spacings[i / LAYER_LAWS] };
        status = measure_layer( &run, cost, plan->seconds / count, error );
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

boundary_plan boundary_default_plan( const bench_options* options )
{
    return ( boundary_plan ){
        .spacings = { 0.2f, 0.1f, 0.05f, 0.025f, 0.0125f },
        .spacing_count = 5,
        .seconds = 0.8 * bench_seconds( options ),
        .workers = { 1, options->workers },
        .worker_count = options->workers > 1 ? 2 : 1,
        .options = options,
    };
}

wisp_status boundary_bench( const bench_options* options, results* out, wisp_error* error )
{
    const boundary_plan plan = boundary_default_plan( options );
    return boundary_bench_run( &plan, out, error );
}
