// Parents of a vertex in the coarse level, and their weights. Where three coarse vertices surround it, the weights
// are barycentric coordinates in the flat triangle with the same distances. So a linear displacement of a flat mesh
// is prolonged exactly.
#include "fabric.h"
#include "fabric_levels.h"

#include <math.h>

// Number of nearest coarse vertices among which parents are searched.
#define CANDIDATES 7
// Minimum area of a triangle relative to its squared longest side; a thinner one gives no accurate coordinates.
#define FLATTEST 0.02
// Tolerance for coordinates that are negative only by rounding.
#define EDGE_TOLERANCE 1e-4

typedef struct coarse_parents
{
    int count;
    int32_t rank[3];
    double weight[3];
} coarse_parents;

static double square( double x )
{
    return x * x;
}

static double least( const double* w )
{
    double smaller = w[0] < w[1] ? w[0] : w[1];
    return smaller < w[2] ? smaller : w[2];
}

// Computes barycentric coordinates of a point in a triangle from distances: p at the origin, q on the x axis, r
// above it.
// @param side distances pq, pr, qr
// @param away distances to p, q, r
// @param radius output, squared circumradius
// @return false if the triangle is too thin
static bool locate( const double side[3], const double away[3], double weight[3], double* radius )
{
    double c = side[0], longest = fmax( c, fmax( side[1], side[2] ) );
    if ( c <= 0.0 )
    {
        return false;
    }
    double rx = ( square( c ) + square( side[1] ) - square( side[2] ) ) / ( 2.0 * c );
    double ry = sqrt( fmax( 0.0, square( side[1] ) - square( rx ) ) );
    if ( c * ry <= FLATTEST * square( longest ) )
    {
        return false;
    }
    double x = ( square( c ) + square( away[0] ) - square( away[1] ) ) / ( 2.0 * c );
    double y = ( square( away[0] ) - square( away[2] ) + square( side[1] ) - 2.0 * x * rx ) / ( 2.0 * ry );
    weight[2] = y / ry;
    weight[1] = ( x - weight[2] * rx ) / c;
    weight[0] = 1.0 - weight[1] - weight[2];
    *radius = square( side[0] * side[1] * side[2] / ( 2.0 * c * ry ) );
    return true;
}

// Tests whether a triangle with this minimum coordinate and radius is better than the best so far. A triangle that
// surrounds the vertex is preferred, then the smaller circumcircle, as in a Delaunay triangulation. Among triangles
// that do not surround it, the larger minimum coordinate is preferred.
static bool is_better( double inside, double radius, double best_inside, double best_radius )
{
    bool surrounds = inside >= -EDGE_TOLERANCE, did = best_inside >= -EDGE_TOLERANCE;
    if ( surrounds != did )
    {
        return surrounds;
    }
    return surrounds ? radius < best_radius * ( 1.0 - EDGE_TOLERANCE ) : inside > best_inside;
}

static bool find_triangle( const level_maker* m, const level_near* near, int count, coarse_parents* out )
{
    double between[CANDIDATES][CANDIDATES];
    for ( int j = 0; j < count; ++j )
    {
        for ( int k = j + 1; k < count; ++k )
        {
            between[j][k] = level_distance_or_straight( m, near[j].rank, near[k].rank );
        }
    }
    double best_inside = -INFINITY, best_radius = INFINITY;

    // the nearest vertex is nearly always a parent; others are searched only if no triangle with it surrounds the
    // child
    for ( int i = 0; i < count && best_inside < -EDGE_TOLERANCE; ++i )
    {
        for ( int j = i + 1; j < count; ++j )
        {
            for ( int k = j + 1; k < count; ++k )
            {
                double side[3] = { between[i][j], between[i][k], between[j][k] };
                double away[3] = { near[i].distance, near[j].distance, near[k].distance };
                double w[3], radius;
                if ( locate( side, away, w, &radius ) && is_better( least( w ), radius, best_inside, best_radius ) )
                {
                    *out =
                        ( coarse_parents ){ 3, { near[i].rank, near[j].rank, near[k].rank }, { w[0], w[1], w[2] } };
                    best_inside = least( w );
                    best_radius = radius;
                }
            }
        }
    }
    return best_inside > -(double)INFINITY;
}

// Sets the weights between the two nearest vertices where there is no triangle, as in a ribbon.
static void find_pair( const level_near* near, int count, coarse_parents* out )
{
    double both = count > 1 ? (double)near[0].distance + (double)near[1].distance : 0.0;
    *out = ( coarse_parents ){ 1, { near[0].rank }, { 1.0 } };
    if ( both > 0.0 )
    {
        double fraction = (double)near[0].distance / both;
        *out = ( coarse_parents ){ 2, { near[0].rank, near[1].rank }, { 1.0 - fraction, fraction } };
    }
}

// Outside the hull, projects onto the nearest edge or vertex of the triangle.
static void clamp_weights( coarse_parents* p )
{
    double sum = 0.0;
    for ( int i = 0; i < p->count; ++i )
    {
        p->weight[i] = p->weight[i] > EDGE_TOLERANCE ? p->weight[i] : 0.0;
        sum += p->weight[i];
    }
    for ( int i = 0; i < p->count; ++i )
    {
        p->weight[i] /= sum;
    }
}

// Finds what a vertex follows: itself if it is chosen, nothing if no coarse vertex is near.
static coarse_parents find_parents( const level_maker* m, int32_t rank )
{
    const level_near* near = m->near + (size_t)rank * LEVEL_NEAR;
    const int count = m->near_count[rank] < CANDIDATES ? m->near_count[rank] : CANDIDATES;
    coarse_parents p = { .count = 0 };
    if ( m->chosen[rank] )
    {
        return ( coarse_parents ){ 1, { rank }, { 1.0 } };
    }
    if ( count > 0 )
    {
        if ( find_triangle( m, near, count, &p ) == false )
        {
            find_pair( near, count, &p );
        }
        clamp_weights( &p );
    }
    return p;
}

bool level_make_parents( const level_maker* m, fabric_pool* keep, wisp_fabric_level* out )
{
    const int rows = m->finer != NULL ? m->finer->row_count : m->fabric->slot_count;
    int32_t* parent_x4 = fabric_pool_push( keep, (size_t)rows * WISP_FABRIC_PARENTS, sizeof( int32_t ) );
    float* weight = fabric_pool_push_zeroed( keep, (size_t)rows * WISP_FABRIC_PARENTS, sizeof( float ) );
    if ( parent_x4 == NULL || weight == NULL )
    {
        return false;
    }
    for ( int i = 0; i < rows * WISP_FABRIC_PARENTS; ++i )
    {
        parent_x4[i] = 4 * out->vertex_count;
    }
    for ( int32_t rank = 0; rank < m->fine_count; ++rank )
    {
        const coarse_parents p = find_parents( m, rank );
        const int32_t row = m->finer != NULL ? rank : m->fine[rank];
        size_t at = (size_t)( row / WISP_FABRIC_LANES * WISP_FABRIC_PARENTS ) * WISP_FABRIC_LANES +
                    (size_t)( row % WISP_FABRIC_LANES );
        for ( int k = 0; k < p.count; ++k, at += WISP_FABRIC_LANES )
        {
            // a parent with weight 0 repeats the first, which is in cache
            const bool gives = p.weight[k] > 0.0;
            parent_x4[at] = 4 * m->row[p.rank[gives ? k : 0]];
            weight[at] = gives ? (float)p.weight[k] : 0.0f;
        }
        out->unlinked_count += p.count == 0 ? 1 : 0;
    }
    out->finer_row_count = rows;
    out->parent_x4 = parent_x4;
    out->weight = weight;
    return true;
}
