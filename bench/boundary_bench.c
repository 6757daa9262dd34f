// The case `boundary`: the number of points for a spacing, their cost, and how densely they cover the surface.
#include "boundary_bench.h"

#include "accuracy/scene_tools.h"

#include "suite_measure.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float LITTLE_HYSTERESIS = 1e-6f; // of a spacing

/// Points at a spacing by one of the laws that are compared.
typedef struct layer_law
{
    const char* name;
    wisp_spacing policy;
    wisp_rounding rounding;
} layer_law;

static const layer_law layer_laws[] = {
    { "even", WISP_SPACING_EVEN, WISP_ROUND_DOWN },
    { "exact", WISP_SPACING_EXACT, WISP_ROUND_DOWN },
    { "even, up", WISP_SPACING_EVEN, WISP_ROUND_UP },
};

/// A static surface with a layer.
typedef struct layer_implementation
{
    surface_implementation surface;
    wisp_boundary_def def;
    bool is_resampled; ///< every step samples all elements again: case B everywhere
    bool has_little;   ///< of two definitions that give the same points, the present one
} layer_implementation;

static wisp_boundary_def layer_def( const layer_law* law, float spacing )
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

static wisp_status layer_enter( wisp_fabric* fabric, const wisp_boundary_def* def, int workers,
                                layer_implementation* out, wisp_error* error )
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

static wisp_status layer_step( void* context, wisp_error* error )
{
    layer_implementation* implementation = context;
    wisp_status status = implementation->is_resampled ? sample_again( implementation, error ) : WISP_OK;
    return status == WISP_OK ? surface_implementation_step( &implementation->surface, error ) : status;
}

// ms of the pass that computes the points, in the last step.
static double pass_ms( const surface_implementation* implementation )
{
    const wisp_profile profile = wisp_world_profile( implementation->world );
    double ms = NAN;
    for ( int i = 0; i < profile.count; ++i )
    {
        ms = strcmp( profile.lines[i].pass, "boundary.points" ) == 0 ? 1e3 * profile.lines[i].seconds : ms;
    }
    return ms;
}

// ---- outputs of a layer ----

static wisp_status layer_read( surface_implementation* implementation, wisp_boundary_view* out, wisp_error* error )
{
    wisp_status status = wisp_read_boundary( implementation->world, implementation->entity, out );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

static wisp_status layer_read_stats( surface_implementation* implementation, wisp_boundary_stats* out,
                                     wisp_error* error )
{
    wisp_status status = wisp_read_boundary_stats( implementation->world, implementation->entity, out );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

static uint64_t layer_hash( const wisp_boundary_view* view )
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

// ---- runs ----

static const float spacings[] = { 0.2f, 0.1f, 0.05f, 0.025f, 0.0125f }; // m

enum
{
    LAYER_LAWS = WISP_COUNT( layer_laws ),
    SPACINGS = WISP_COUNT( spacings ),
    SAMPLINGS = 2, // in place: no count changes, case A everywhere; resampled: case B everywhere
    LAYER_STEPS = 40,
    SEGMENTS = 30, // slices and stacks of the paper's sphere
};

static const char* const sampling_names[SAMPLINGS] = { "in place", "resampled" };

enum
{
    LAYER_POINTS,
    EDGE_POINTS,
    LAYER_COVER,
    COVER_SPACINGS,
    LAYER_BYTES,
    LAYER_MEASURES,
};

typedef struct layer_scene
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    uint64_t hashes[SPACINGS * LAYER_LAWS]; // of the points in place; 0: not yet
} layer_scene;

// Even spacing rounded down has gaps below 2 d; the last gap is a difference of rounded positions.
static wisp_status check_gap( const layer_law* law, double spacing, double gap, wisp_error* error )
{
    const bool covers = law->rounding == WISP_ROUND_UP || law->policy == WISP_SPACING_EXACT;
    return gap <= ( covers ? 1.0 : 2.0 ) * spacing + 1e-5
               ? WISP_OK
               : wisp_fail( error, WISP_CONFLICT, "a gap of %.4f m on an edge at d = %g m, %s", gap, spacing,
                            law->name );
}

static wisp_status measure_layer( layer_scene* own, int number, layer_implementation* layer,
                                  const wisp_boundary_view* view, accuracy_run* out, wisp_error* error )
{
    const double spacing = (double)layer->def.spacing;
    wisp_boundary_stats stats;
    layer_cover cover = { .gap = 0.0 };
    wisp_status status = layer_read_stats( &layer->surface, &stats, error );
    status = status == WISP_OK ? layer_find_cover( view, &own->mesh, &cover, error ) : status;
    if ( status == WISP_OK )
    {
        const double measures[LAYER_MEASURES] = { stats.points, stats.edge_points, 1e3 * cover.reach,
                                                  cover.reach / spacing, 1e-6 * (double)stats.bytes };
        memcpy( out->measures, measures, sizeof measures );
        out->error = cover.gap;
        status = check_gap( layer_laws + number % LAYER_LAWS, spacing, cover.gap, error );
    }
    return status;
}

static wisp_status time_layer( layer_implementation* layer, accuracy_run* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < LAYER_STEPS && status == WISP_OK; ++i )
    {
        status = layer_step( layer, error );
        status = status == WISP_OK ? accuracy_keep_ms( out, pass_ms( &layer->surface ) ) : status;
    }
    return status;
}

static wisp_status run_layer( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                              wisp_error* error )
{
    layer_scene* own = context;
    const int number = setting / SAMPLINGS; // of law and spacing
    const wisp_boundary_def def = layer_def( layer_laws + number % LAYER_LAWS, spacings[number / LAYER_LAWS] );
    layer_implementation layer;
    wisp_boundary_view view;
    wisp_status status = layer_enter( own->fabric, &def, workers, &layer, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    layer.is_resampled = setting % SAMPLINGS == 1;
    status = time_layer( &layer, out, error );
    status = status == WISP_OK ? layer_read( &layer.surface, &view, error ) : status;
    out->hash = status == WISP_OK ? layer_hash( &view ) : 0;
    out->work.vertices = own->mesh.vertex_count;
    status = status == WISP_OK && is_observed ? measure_layer( own, number, &layer, &view, out, error ) : status;
    if ( status == WISP_OK && own->hashes[number] != 0 && own->hashes[number] != out->hash )
    {
        status = wisp_fail( error, WISP_CONFLICT, "at d = %g m, %s, points depend on whether they were sampled again",
                            (double)def.spacing, layer_laws[number % LAYER_LAWS].name );
    }
    own->hashes[number] = out->hash;
    surface_implementation_destroy( &layer.surface );
    return status;
}

static void destroy_layers( void* context )
{
    layer_scene* own = context;
    wisp_fabric_release( own->fabric );
    wisp_mesh_release( &own->mesh );
    free( own );
}

// Cooked without bend links: the boundary particle paper has none.
static wisp_status make_sphere( layer_scene* own, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_UV_SPHERE );
    generator.segments = generator.rings = SEGMENTS;
    generator.radius = LAYER_RADIUS;
    wisp_fabric_def def = wisp_default_fabric_def();
    def.bend_links = false;
    const wisp_status status = wisp_mesh_generate( &generator, &own->mesh, error );
    return status == WISP_OK ? surface_cook( &own->mesh, def, &own->fabric, error ) : status;
}

static wisp_status make_layers( const void* subject, const bench_options* options, double seconds,
                                accuracy_scene* out, wisp_error* error )
{
    (void)subject;
    (void)options;
    (void)seconds;
    *out = ( accuracy_scene ){
        .reference = "no gap above the spacing, or twice that where counts are rounded down",
        .error_name = "gap along edges",
        .error_unit = "m",
        .measure_names = { "points", "edge points", "cover, mm", "cover / d", "MB" },
        .measure_count = LAYER_MEASURES,
        .has_no_rivals = true,
        .note = "Times are of the pass that makes the points. In place: no count changes (case A). Resampled: every "
                "element is "
                "sampled again in every step (case B). The cover is the largest distance from 325 places of each "
                "triangle to "
                "its points. Points, normals and recipes have one hash in both cases and for every worker count.",
        .run = run_layer,
    };
    wisp_status status = accuracy_begin_scene( out, sizeof( layer_scene ), SPACINGS * LAYER_LAWS * SAMPLINGS, error );
    out->destroy = destroy_layers;
    status = status == WISP_OK ? make_sphere( out->context, error ) : status;
    for ( int i = 0; i < SPACINGS * LAYER_LAWS * SAMPLINGS && status == WISP_OK; ++i )
    {
        const layer_law* law = layer_laws + i / SAMPLINGS % LAYER_LAWS;
        const double spacing = (double)spacings[i / SAMPLINGS / LAYER_LAWS];
        char series[64];
        snprintf( series, sizeof series, "%s, %s", law->name, sampling_names[i % SAMPLINGS] );
        accuracy_join_series( accuracy_put_setting( out, "%s, d %g", series, spacing ), series, "spacing, m", spacing,
                              NAN );
    }
    return status == WISP_OK || out->context == NULL ? status : accuracy_abandon( out, status );
}

wisp_status boundary_bench( const bench_options* options, results* out, wisp_error* error )
{
    const accuracy_entry entry = { "boundary", "boundary particles of a sphere", make_layers, NULL, NULL };
    return accuracy_bench_run( &entry, 1, bench_seconds( options ), options, out, error );
}
