#include "figures_drape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- the border ----

void drape_border_free( drape_border* border )
{
    free( border->vertices );
    free( border->places );
    *border = ( drape_border ){ .count = 0 };
}

// A half edge whose twin no triangle has leads along the border. @param next [vertex_count], -1: not on it
static wisp_status follow_border( const wisp_mesh* mesh, int32_t* next, wisp_error* error )
{
    const int corner_count = 3 * mesh->triangle_count;
    int32_t( *half )[2] = malloc( (size_t)corner_count * sizeof( *half ) );
    int32_t* begin = calloc( (size_t)mesh->vertex_count + 2, sizeof( int32_t ) );
    if ( half == NULL || begin == NULL )
    {
        free( half );
        free( begin );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the border of a mesh" );
    }

    // half edges by the vertex they begin at
    for ( int c = 0; c < corner_count; ++c )
    {
        ++begin[mesh->triangles[c] + 2];
    }
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        begin[v + 2] += begin[v + 1];
    }
    for ( int c = 0; c < corner_count; ++c )
    {
        int32_t from = mesh->triangles[c], to = mesh->triangles[c % 3 == 2 ? c - 2 : c + 1];
        int32_t* row = half[begin[from + 1]++];
        row[0] = from;
        row[1] = to;
    }

    for ( int i = 0; i < corner_count; ++i )
    {
        bool has_twin = false;
        for ( int k = begin[half[i][1]]; k < begin[half[i][1] + 1]; ++k )
        {
            has_twin = has_twin || half[k][1] == half[i][0];
        }
        if ( !has_twin )
        {
            next[half[i][0]] = half[i][1];
        }
    }
    free( half );
    free( begin );
    return WISP_OK;
}

static double distance( wisp_vec3 a, wisp_vec3 b )
{
    double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
    return sqrt( x * x + y * y + z * z );
}

static void walk( const wisp_mesh* mesh, const int32_t* next, drape_border* out )
{
    int first = 0;
    while ( first < mesh->vertex_count && next[first] < 0 )
    {
        ++first;
    }
    double length = 0.0;
    for ( int v = first; v < mesh->vertex_count && v >= 0 && out->count < mesh->vertex_count; )
    {
        out->places[out->count] = length;
        out->vertices[out->count++] = v;
        length += next[v] >= 0 ? distance( mesh->points[v], mesh->points[next[v]] ) : 0.0;
        v = next[v] == first ? -1 : next[v];
    }
    for ( int i = 0; i < out->count; ++i )
    {
        out->places[i] /= length;
    }
}

wisp_status drape_border_find( const wisp_mesh* mesh, drape_border* out, wisp_error* error )
{
    size_t count = (size_t)mesh->vertex_count;
    *out = ( drape_border ){ .vertices = malloc( count * sizeof( int32_t ) ),
                             .places = malloc( count * sizeof( double ) ) };
    int32_t* next = malloc( count * sizeof( int32_t ) );
    wisp_status status = WISP_OK;
    if ( out->vertices == NULL || out->places == NULL || next == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the border of a mesh" );
    }
    else
    {
        memset( next, -1, count * sizeof( int32_t ) );
        status = follow_border( mesh, next, error );
    }
    if ( status == WISP_OK )
    {
        walk( mesh, next, out );
    }
    else
    {
        drape_border_free( out );
    }
    free( next );
    return status;
}

// ---- folds ----

enum
{
    PLACES = 240, // round the border
    WINDOW = 5,   // places that one is smoothed over, each way: 18 cm of 4 m
};

// What stands out less is a ripple, m. Edges are 4 cm long.
static const double FOLD_HEIGHT = 0.01;

// How far from the ball's axis the border is, at places that are evenly apart at rest.
static void sample_border( const drape_border* border, const wisp_vec3* points, double* radius )
{
    for ( int i = 0, k = 0; i < PLACES; ++i )
    {
        double place = (double)i / PLACES;
        while ( k + 1 < border->count && border->places[k + 1] <= place )
        {
            ++k;
        }
        double from = border->places[k], to = k + 1 < border->count ? border->places[k + 1] : 1.0;
        double fraction = ( place - from ) / ( to - from );
        const wisp_vec3 a = points[border->vertices[k]], b = points[border->vertices[( k + 1 ) % border->count]];
        radius[i] = hypot( ( 1.0 - fraction ) * (double)a.x + fraction * (double)b.x,
                           ( 1.0 - fraction ) * (double)a.z + fraction * (double)b.z );
    }
}

static void smooth( const double* in, double* out )
{
    for ( int i = 0; i < PLACES; ++i )
    {
        double sum = 0.0;
        for ( int k = -WINDOW; k <= WINDOW; ++k )
        {
            sum += in[( i + k + PLACES ) % PLACES];
        }
        out[i] = sum / ( 2 * WINDOW + 1 );
    }
}

// Maxima from which it falls by a fold's height on both sides: round from the lowest place, where a rise must begin.
static int count_folds( const drape_border* border, const wisp_vec3* points )
{
    double radius[PLACES], even[PLACES];
    sample_border( border, points, radius );
    smooth( radius, even );
    int first = 0;
    for ( int i = 1; i < PLACES; ++i )
    {
        first = even[i] < even[first] ? i : first;
    }
    int folds = 0;
    bool rises = true;
    double extreme = even[first];
    for ( int i = 1; i <= PLACES; ++i )
    {
        double value = even[( first + i ) % PLACES], turned = rises ? extreme - value : value - extreme;
        if ( rises ? value > extreme : value < extreme )
        {
            extreme = value;
        }
        else if ( turned > FOLD_HEIGHT )
        {
            folds += rises ? 1 : 0;
            rises = !rises;
            extreme = value;
        }
    }
    return folds;
}

// ---- an observation ----

static double gap_of( double x, double y, double z )
{
    y -= (double)TRIANGLE_BALL_HEIGHT;
    return sqrt( x * x + y * y + z * z ) - (double)TRIANGLE_BALL_RADIUS;
}

wisp_status drape_glance( surface_implementation* implementation, drape_observation* out, wisp_error* error )
{
    const wisp_vec3* points;
    wisp_status status = surface_implementation_points( implementation, &points, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    surface_observation observation = surface_implementation_observe( implementation );
    *out =
        ( drape_observation ){ .kinetic = observation.kinetic, .gap = INFINITY, .is_finite = observation.is_finite };
    for ( int i = 0; i < implementation->fabric->vertex_count; ++i )
    {
        out->gap = fmin( out->gap, gap_of( (double)points[i].x, (double)points[i].y, (double)points[i].z ) );
    }
    return WISP_OK;
}

static void observe_edge( const triangle_scene* scene, const wisp_vec3* points, int32_t i, int32_t k,
                          drape_observation* out )
{
    const wisp_vec3 a = points[i], b = points[k];
    double rest = distance( scene->mesh.points[i], scene->mesh.points[k] );
    out->strain = fmax( out->strain, distance( a, b ) / rest - 1.0 );
    out->gap_between =
        fmin( out->gap_between, gap_of( 0.5 * ( (double)a.x + (double)b.x ), 0.5 * ( (double)a.y + (double)b.y ),
                                        0.5 * ( (double)a.z + (double)b.z ) ) );
}

static void observe_edges( const triangle_scene* scene, const wisp_vec3* points, drape_observation* out )
{
    const wisp_fabric* fabric = scene->fabric;
    out->gap_between = INFINITY;
    for ( int e = 0; e < scene->pairs.stretch_count; ++e )
    {
        observe_edge( scene, points, scene->pairs.stretch[2 * e], scene->pairs.stretch[2 * e + 1], out );
    }
    for ( int e = 0; e < fabric->edge_count && scene->pairs.stretch_count == 0; ++e )
    {
        observe_edge( scene, points, fabric->slot_vertex[fabric->edges[2 * e]],
                      fabric->slot_vertex[fabric->edges[2 * e + 1]], out );
    }
}

wisp_status drape_observe( const triangle_scene* scene, const drape_border* border,
                           surface_implementation* implementation, drape_observation* out, wisp_error* error )
{
    const wisp_vec3* points;
    wisp_status status = drape_glance( implementation, out, error );
    status = status == WISP_OK ? surface_implementation_points( implementation, &points, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    observe_edges( scene, points, out );
    out->min_hem = INFINITY;
    for ( int i = 0; i < border->count; ++i )
    {
        double height = (double)points[border->vertices[i]].y;
        out->hem_mean += height / border->count;
        out->min_hem = fmin( out->min_hem, height );
    }
    out->folds = count_folds( border, points );
    return WISP_OK;
}
