#include "boundary_cover.h"

#include <math.h>
#include <stdlib.h>

enum
{
    PARTS = 24, // of each side of a triangle: 325 positions
};

int layer_find_edge( const wisp_boundary_view* view, int32_t a, int32_t b )
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
        count += gather_range( all, view->samples, layer_find_edge( view, corner[k], corner[( k + 1 ) % 3] ) );
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
