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

typedef struct parents
{
    int count;
    int32_t rank[3];
    double weight[3];
} parents;

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

// Returns the distance between two parents. At a seam they may be too far apart to be neighbours though both are
// near the child; then the Euclidean distance is used.
static double distance_between( const level_maker* m, int32_t rank_a, int32_t rank_b )
{
    double distance = level_distance( m, rank_a, rank_b );
    const wisp_vec3 *a = m->fabric->rest + m->fine[rank_a], *b = m->fabric->rest + m->fine[rank_b];
    double x = (double)a->x - (double)b->x, y = (double)a->y - (double)b->y, z = (double)a->z - (double)b->z;
    return distance < (double)INFINITY ? distance : sqrt( x * x + y * y + z * z );
}

static bool find_triangle( const level_maker* m, const level_near* near, int count, parents* out )
{
    double between[CANDIDATES][CANDIDATES];
    for ( int j = 0; j < count; ++j )
    {
        for ( int k = j + 1; k < count; ++k )
        {
            between[j][k] = distance_between( m, near[j].rank, near[k].rank );
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
                    *out = ( parents ){ 3, { near[i].rank, near[j].rank, near[k].rank }, { w[0], w[1], w[2] } };
                    best_inside = least( w );
                    best_radius = radius;
                }
            }
        }
    }
    return best_inside > -(double)INFINITY;
}

// Sets the weights between the two nearest vertices where there is no triangle, as in a ribbon.
static void find_pair( const level_near* near, int count, parents* out )
{
    double both = count > 1 ? (double)near[0].distance + (double)near[1].distance : 0.0;
    *out = ( parents ){ 1, { near[0].rank }, { 1.0 } };
    if ( both > 0.0 )
    {
        double fraction = (double)near[0].distance / both;
        *out = ( parents ){ 2, { near[0].rank, near[1].rank }, { 1.0 - fraction, fraction } };
    }
}

// Outside the hull, projects onto the nearest edge or vertex of the triangle.
static void clamp_weights( parents* p )
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

static void write_child( const level_maker* m, int child, int32_t rank, int32_t* child_x4, int32_t* parent_x4,
                         float* weight )
{
    const level_near* near = m->near + (size_t)rank * LEVEL_NEAR;
    int count = m->near_count[rank] < CANDIDATES ? m->near_count[rank] : CANDIDATES;
    parents p;
    if ( find_triangle( m, near, count, &p ) == false )
    {
        find_pair( near, count, &p );
    }
    clamp_weights( &p );
    size_t slice = (size_t)( child / WISP_FABRIC_LANES ), lane = (size_t)( child % WISP_FABRIC_LANES );
    child_x4[child] = m->fine[rank] * 4;
    for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
    {
        // a parent with weight 0 repeats the first, which is in cache
        bool gives = k < p.count && p.weight[k] > 0.0;
        size_t at = ( slice * WISP_FABRIC_PARENTS + (size_t)k ) * WISP_FABRIC_LANES + lane;
        parent_x4[at] = m->fine[p.rank[gives ? k : 0]] * 4;
        weight[at] = gives ? (float)p.weight[k] : 0.0f;
    }
}

bool level_make_children( const level_maker* m, fabric_pool* keep, wisp_fabric_level* out )
{
    int count = 0;
    for ( int r = 0; r < m->fine_count; ++r )
    {
        count += m->chosen[r] || m->idle[m->fine[r]] ? 0 : 1;
    }
    int padded = fabric_padded( count );
    int32_t* child_x4 = fabric_pool_push( keep, (size_t)padded, sizeof( int32_t ) );
    int32_t* parent_x4 = fabric_pool_push( keep, (size_t)padded * WISP_FABRIC_PARENTS, sizeof( int32_t ) );
    float* weight = fabric_pool_push_zeroed( keep, (size_t)padded * WISP_FABRIC_PARENTS, sizeof( float ) );
    if ( child_x4 == NULL || parent_x4 == NULL || weight == NULL )
    {
        return false;
    }
    int32_t dummy4 = m->fabric->vertex_count * 4;
    for ( int i = 0; i < padded * WISP_FABRIC_PARENTS; ++i )
    {
        parent_x4[i] = dummy4;
    }
    int child = 0;
    for ( int r = 0; r < m->fine_count; ++r )
    {
        if ( m->chosen[r] == false && m->idle[m->fine[r]] == false )
        {
            write_child( m, child++, r, child_x4, parent_x4, weight );
        }
    }
    while ( child < padded )
    {
        child_x4[child++] = dummy4;
    }
    out->child_count = count;
    out->child_x4 = child_x4;
    out->parent_x4 = parent_x4;
    out->weight = weight;
    return true;
}
