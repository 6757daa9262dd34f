// Check the number of points of an edge and a triangle, and their positions.
#include "boundary_bench.h"

#include "oracle/boundary_oracle.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <float.h>
#include <math.h>
#include <string.h>

// A world with one layer on given points.
static wisp_status enter_mesh( const wisp_mesh* mesh, const wisp_boundary_def* def, wisp_fabric** fabric,
                               layer_implementation* out, wisp_boundary_view* view, wisp_error* error )
{
    wisp_status status = layer_cook( mesh, fabric, error );
    status = status == WISP_OK ? layer_enter( *fabric, def, 1, out, error ) : status;
    status = status == WISP_OK ? layer_step( out, error ) : status;
    return status == WISP_OK ? layer_read( &out->surface, view, error ) : status;
}

static int points_of( const wisp_boundary_view* view, int element )
{
    return view->samples->begin[element + 1] - view->samples->begin[element];
}

static void add_count_row( const char* what, const layer_law* law, float spacing, int points, int expected,
                           const char* by, results* out )
{
    char variant[64];
    snprintf( variant, sizeof( variant ), "%s, %s", what, law->name );
    results_row* row = results_add_row( out, "boundary", variant );
    if ( row != NULL )
    {
        row->workers = 1;
        results_put( &row->size, "points", points );
        results_put( &row->size, "spacing_m", (double)spacing );
        snprintf( row->error_reference, sizeof( row->error_reference ), "%s", by );
        results_put( &row->error, "points", points - expected );
    }
}

// ---- points of an edge ----

#define EDGE_SPACING 0.5f // so that all lengths below are floats

enum
{
    EDGES = 5,
};

static int points_of_edge( const wisp_boundary_view* view, int32_t a, int32_t b )
{
    for ( int e = 0; e < view->edge_count; ++e )
    {
        if ( view->edges[2 * e] == a && view->edges[2 * e + 1] == b )
        {
            return points_of( view, e );
        }
    }
    return -1;
}

// @param counts of the edges
static wisp_status count_edges( const layer_law* law, const float* fractions, int counts[EDGES], wisp_error* error )
{
    wisp_vec3 points[3 * EDGES];
    int32_t triangles[3 * EDGES];
    for ( int i = 0; i < EDGES; ++i )
    {
        const float at = 0.5f * (float)i;
        points[3 * i] = ( wisp_vec3 ){ 0.0f, at, 0.0f };
        points[3 * i + 1] = ( wisp_vec3 ){ fractions[i] * EDGE_SPACING, at, 0.0f };
        points[3 * i + 2] = ( wisp_vec3 ){ 0.0f, at + 0.125f, 0.0f };
        for ( int k = 0; k < 3; ++k )
        {
            triangles[3 * i + k] = 3 * i + k;
        }
    }
    const wisp_mesh mesh = {
        .points = points, .triangles = triangles, .vertex_count = 3 * EDGES, .triangle_count = EDGES
    };
    const wisp_boundary_def def = layer_def( law, EDGE_SPACING );
    wisp_fabric* fabric = NULL;
    layer_implementation implementation = { 0 };
    wisp_boundary_view view;
    wisp_status status = enter_mesh( &mesh, &def, &fabric, &implementation, &view, error );
    for ( int i = 0; i < EDGES && status == WISP_OK; ++i )
    {
        counts[i] = points_of_edge( &view, 3 * i, 3 * i + 1 );
    }
    surface_implementation_destroy( &implementation.surface );
    wisp_fabric_release( fabric );
    return status;
}

static wisp_status edges( results* out, wisp_error* error )
{
    static const float fractions[EDGES] = { 0.3f, 1.0f, 1.5f, 2.0f, 3.7f };
    static const int expected[LAYER_LAWS][EDGES] = { { 0, 0, 0, 1, 2 }, { 0, 0, 1, 1, 3 }, { 0, 0, 1, 1, 3 } };
    static const char* const header[] = { "spacing", "L/d 0.3", "1", "1.5", "2", "3.7", "expected", "met" };
    const int table =
        results_add_table( out, "Edge points: number of points of an edge by its length over the spacing",
                           WISP_COUNT( header ), header );
    wisp_status status = WISP_OK;
    for ( int law = 0; law < LAYER_LAWS && status == WISP_OK; ++law )
    {
        int counts[EDGES] = { 0 };
        const int* e = expected[law];
        status = count_edges( &layer_laws[law], fractions, counts, error );
        const bool met = memcmp( counts, e, sizeof( counts ) ) == 0;
        cells row = { .count = 0 };
        cells_put( &row, "%s", layer_laws[law].name );
        for ( int i = 0; i < EDGES; ++i )
        {
            cells_put( &row, "%d", counts[i] );
        }
        cells_put( &row, "%d, %d, %d, %d, %d", e[0], e[1], e[2], e[3], e[4] );
        cells_put( &row, "%s", met ? "yes" : "NO" );
        cells_end_row( &row, table, out );
        add_count_row( "edges", &layer_laws[law], EDGE_SPACING,
                       counts[0] + counts[1] + counts[2] + counts[3] + counts[4], e[0] + e[1] + e[2] + e[3] + e[4],
                       "contract", out );
        if ( status == WISP_OK && !met )
        {
            results_add_failure( out, "Edge points: the points of an edge, %s, differ from the expected ones.",
                                 layer_laws[law].name );
        }
    }
    return status;
}

// ---- points inside a triangle ----

enum
{
    KINDS = 4,
    TURNS = 3,  // a triangle begins with any of its corners
    PLACES = 2, // at the origin and far from it
    COPIES = TURNS * PLACES,
};

// Dyadic, so that a shift by 1024 m is exact. The equilateral one has sides of exactly the same length.
static const struct
{
    const char* name;
    wisp_vec3 corner[3];
} kinds[KINDS] = {
    { "equilateral", { { 1.0f, 0.0f, 0.0f }, { 0.0f, 1.0f, 0.0f }, { 0.0f, 0.0f, 1.0f } } },
    { "isosceles", { { 0.0f, 0.0f, 0.0f }, { 0.5f, 0.0f, 0.0f }, { 0.25f, 1.0f, 0.0f } } },
    { "needle", { { 0.0f, 0.0f, 0.0f }, { 0.25f, 0.0f, 0.0f }, { 2.0f, 0.375f, 0.0f } } },
    { "right", { { 0.0f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 0.0f, 0.75f, 0.0f } } },
};
static const float FAR_AWAY = 1024.0f; // m

typedef struct triangle_observation
{
    int points, expected, rows;
    double slant;  // the largest sine of the angle between a row and the shortest side
    bool inside;   // no weight is negative or 0
    bool all_same; // copies have the same points with the same weights
} triangle_observation;

// Lines, and points on each, by the oracle's formulas.
static int expected_points( const double3 corner[3], const wisp_boundary_def* def )
{
    const double d = (double)def->spacing;
    const boundary_oracle_policy policy = (boundary_oracle_policy)def->policy;
    const boundary_oracle_rounding rounding = (boundary_oracle_rounding)def->rounding;
    const boundary_oracle_axis axis = boundary_oracle_axis_of( corner );
    const int n = boundary_oracle_count( axis.height, d, rounding );
    const int lines = boundary_oracle_points( n, axis.height, d, policy );
    int sum = 0;
    for ( int k = 1; k <= lines; ++k )
    {
        const double q = boundary_oracle_fraction( k, n, axis.height, d, policy );
        sum += boundary_oracle_points_of_length( boundary_oracle_line_length( axis.base, q ), d, policy, rounding );
    }
    return sum;
}

static double3 quad_point( const wisp_samples* s, int p )
{
    const float* q = s->xyzw + 4 * (size_t)p;
    return double3_make( (double)q[0], (double)q[1], (double)q[2] );
}

// Points of one row have the same weight of the opposite corner.
static void observe_rows( const wisp_samples* s, int begin, int end, const double3 corner[3],
                          triangle_observation* out )
{
    const boundary_oracle_axis axis = boundary_oracle_axis_of( corner );
    out->rows = end > begin ? 1 : 0;
    for ( int p = begin; p < end; ++p )
    {
        for ( int k = 0; k < 3; ++k )
        {
            out->inside = out->inside && s->weights[p][k] > 0.0f;
        }
        if ( p + 1 == end )
        {
            break;
        }
        const double3 step = double3_sub( quad_point( s, p + 1 ), quad_point( s, p ) );
        const double rise = double3_dot( step, axis.upward ), size = sqrt( double3_dot( step, step ) );
        const bool same_row = s->weights[p + 1][axis.c] == s->weights[p][axis.c];
        out->rows += same_row ? 0 : 1;
        out->slant = same_row ? fmax( out->slant, fabs( rise ) / size ) : out->slant;
    }
}

// The corner of the first copy that corresponds to a corner of this one.
static int first_corner( int copy, int k )
{
    return ( k + copy % TURNS ) % 3;
}

// Weights are those of the first copy, corner by corner. With sides of equal length the axis is the first one, which
// rotates with the corners: then only the number of points stays.
static bool is_same( const wisp_boundary_view* view, int kind, int copy )
{
    const wisp_samples* s = view->samples;
    const int first = view->edge_count + kind * COPIES, element = first + copy;
    bool same = points_of( view, element ) == points_of( view, first );
    for ( int p = 0; p < points_of( view, element ) && same && kind > 0; ++p )
    {
        const float* mine = s->weights[s->begin[element] + p];
        for ( int k = 0; k < 3; ++k )
        {
            const float theirs = s->weights[s->begin[first] + p][first_corner( copy, k )];
            same = same && fabsf( mine[k] - theirs ) <= 4.0f * FLT_EPSILON;
        }
    }
    return same;
}

static void observe_kind( const wisp_boundary_view* view, const wisp_boundary_def* def, int kind,
                          triangle_observation* out )
{
    double3 corner[3];
    for ( int k = 0; k < 3; ++k )
    {
        const wisp_vec3 c = kinds[kind].corner[k];
        corner[k] = double3_make( (double)c.x, (double)c.y, (double)c.z );
    }
    const int element = view->edge_count + kind * COPIES;
    *out = ( triangle_observation ){ .points = points_of( view, element ), .inside = true, .all_same = true };
    out->expected = expected_points( corner, def );
    observe_rows( view->samples, view->samples->begin[element], view->samples->begin[element + 1], corner, out );
    for ( int copy = 1; copy < COPIES; ++copy )
    {
        out->all_same = out->all_same && is_same( view, kind, copy );
    }
}

static void make_triangles( wisp_vec3* points, int32_t* triangles )
{
    for ( int i = 0; i < KINDS * COPIES; ++i )
    {
        const int copy = i % COPIES;
        const float away = copy >= TURNS ? FAR_AWAY : 0.0f;
        for ( int k = 0; k < 3; ++k )
        {
            const wisp_vec3 p = kinds[i / COPIES].corner[first_corner( copy, k )];
            points[3 * i + k] = ( wisp_vec3 ){ p.x + away, p.y + away, p.z + away };
            triangles[3 * i + k] = 3 * i + k;
        }
    }
}

static void add_kind( const wisp_boundary_view* view, const wisp_boundary_def* def, int law, int kind, int table,
                      results* out )
{
    triangle_observation observation;
    observe_kind( view, def, kind, &observation );
    // a row is level up to roundings of positions over the gap between them
    const bool met = observation.points == observation.expected && observation.inside && observation.all_same &&
                     observation.slant < 8.0 * (double)FLT_EPSILON * 2.0 / (double)def->spacing;
    cells row = { .count = 0 };
    cells_put( &row, "%s", kinds[kind].name );
    cells_put_number( &row, (double)def->spacing, 3 );
    cells_put( &row, "%s", layer_laws[law].name );
    cells_put( &row, "%d", observation.rows );
    cells_put( &row, "%d", observation.points );
    cells_put( &row, "%d", observation.expected );
    cells_put( &row, "%s", observation.inside ? "yes" : "NO" );
    cells_put( &row, "%.1e", observation.slant );
    cells_put( &row, "%s", observation.all_same ? "yes" : "NO" );
    cells_put( &row, "%s", met ? "yes" : "NO" );
    cells_end_row( &row, table, out );
    add_count_row( kinds[kind].name, &layer_laws[law], def->spacing, observation.points, observation.expected,
                   "oracle", out );
    if ( !met )
    {
        results_add_failure( out, "Inner points: the %s triangle, %s, d = %g m, has other points than expected.",
                             kinds[kind].name, layer_laws[law].name, (double)def->spacing );
    }
}

static wisp_status triangles( results* out, wisp_error* error )
{
    static const char* const header[] = { "triangle", "d",      "spacing", "rows",          "points",
                                          "expected", "inside", "slant",   "turned, moved", "met" };
    static const float spacings[] = { 0.2f, 0.1f, 0.05f };
    wisp_vec3 points[3 * KINDS * COPIES];
    int32_t corners[3 * KINDS * COPIES];
    make_triangles( points, corners );
    const wisp_mesh mesh = {
        .points = points, .triangles = corners, .vertex_count = 3 * KINDS * COPIES, .triangle_count = KINDS * COPIES
    };
    const int table = results_add_table( out,
                                         "Inner points: in rows along the shortest side of a triangle, from any "
                                         "corner and 1024 m away; expected by the oracle",
                                         WISP_COUNT( header ), header );
    wisp_status status = WISP_OK;
    for ( int i = 0; i < LAYER_LAWS * WISP_COUNT( spacings ) && status == WISP_OK; ++i )
    {
        const int law = i / WISP_COUNT( spacings );
        const wisp_boundary_def def = layer_def( &layer_laws[law], spacings[i % WISP_COUNT( spacings )] );
        wisp_fabric* fabric = NULL;
        layer_implementation implementation = { 0 };
        wisp_boundary_view view;
        status = enter_mesh( &mesh, &def, &fabric, &implementation, &view, error );
        for ( int kind = 0; kind < KINDS && status == WISP_OK; ++kind )
        {
            add_kind( &view, &def, law, kind, table, out );
        }
        surface_implementation_destroy( &implementation.surface );
        wisp_fabric_release( fabric );
    }
    return status;
}

wisp_status boundary_counts( const boundary_plan* plan, results* out, wisp_error* error )
{
    (void)plan;
    wisp_status status = edges( out, error );
    return status == WISP_OK ? triangles( out, error ) : status;
}
