// Which targets a ghost follows (Park and Kim 2024, eq. 1). The result is that of all pairs; boxes around the targets rule out most
// of them.
#include "guide_internal.h"

#include <math.h>

// Bounds of a target.
typedef struct box
{
    guide_point lower, upper;
} box;

// The nearest targets found so far, nearest first; of equals the lowest number.
typedef struct ranking
{
    double distance[WISP_MAX_GHOST_TARGETS];
    int target[WISP_MAX_GHOST_TARGETS];
    int count, links;
} ranking;

static double worst( const ranking* r )
{
    return r->count < r->links ? HUGE_VAL : r->distance[r->links - 1];
}

static void enter( ranking* r, double distance, int target )
{
    int at = r->count;
    while ( at > 0 &&
            ( distance < r->distance[at - 1] || ( distance == r->distance[at - 1] && target < r->target[at - 1] ) ) )
    {
        at -= 1;
    }
    if ( at == r->links )
    {
        return;
    }
    r->count += r->count < r->links ? 1 : 0;
    for ( int k = r->count - 1; k > at; --k )
    {
        r->distance[k] = r->distance[k - 1];
        r->target[k] = r->target[k - 1];
    }
    r->distance[at] = distance;
    r->target[at] = target;
}

// In place of fmin() and fmax(), with which gcc 12 for 64-bit ARM ends with an internal error in the loops below.
static double lesser( double a, double b )
{
    return b < a ? b : a;
}

static double greater( double a, double b )
{
    return b > a ? b : a;
}

static box box_of( const wisp_vec3* points, int count )
{
    box b = { { HUGE_VAL, HUGE_VAL, HUGE_VAL }, { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL } };
    for ( int i = 0; i < count; ++i )
    {
        const guide_point p = guide_widen( points[i] );
        b.lower = ( guide_point ){ lesser( b.lower.x, p.x ), lesser( b.lower.y, p.y ), lesser( b.lower.z, p.z ) };
        b.upper = ( guide_point ){ greater( b.upper.x, p.x ), greater( b.upper.y, p.y ), greater( b.upper.z, p.z ) };
    }
    return b;
}

static double outside( double lower, double p, double upper )
{
    return p < lower ? lower - p : p > upper ? p - upper : 0.0;
}

// Whether a strand is farther from the box than `limit`, as sums of squares, with a margin for rounding.
static bool is_beyond( const box* b, const wisp_vec3* points, int count, double limit )
{
    const double enough = limit * ( 1.0 + 1e-9 );
    double sum = 0.0;
    for ( int i = 0; i < count && sum <= enough; ++i )
    {
        const guide_point p = guide_widen( points[i] );
        const guide_point d = { outside( b->lower.x, p.x, b->upper.x ), outside( b->lower.y, p.y, b->upper.y ),
                                outside( b->lower.z, p.z, b->upper.z ) };
        sum += guide_dot( d, d );
    }
    return sum > enough;
}

// Sum over the ghost's vertices of the squared distance to the nearest vertex of the target. Stops above `limit`.
static double strand_distance( const wisp_vec3* ghost, int ghost_count, const wisp_vec3* target, int target_count,
                               double limit )
{
    double sum = 0.0;
    for ( int k = 0; k < ghost_count && sum <= limit; ++k )
    {
        const guide_point p = guide_widen( ghost[k] );
        double nearest = HUGE_VAL;
        for ( int i = 0; i < target_count; ++i )
        {
            const guide_point d = guide_sub( p, guide_widen( target[i] ) );
            nearest = lesser( nearest, guide_dot( d, d ) );
        }
        sum += nearest;
    }
    return sum;
}

// The target whose root is nearest: nearly always the answer, so that boxes rule out most others.
static int nearest_root( const guide_shape* targets, wisp_vec3 root )
{
    int best = -1;
    float least = HUGE_VALF;
    for ( int a = 0; a < targets->topology->strand_count; ++a )
    {
        if ( guide_vertices( targets, a ) == 0 )
        {
            continue;
        }
        const wisp_vec3 p = *guide_strand( targets, a );
        const float x = p.x - root.x, y = p.y - root.y, z = p.z - root.z, squared = x * x + y * y + z * z;
        best = best < 0 || squared < least ? a : best;
        least = squared < least ? squared : least;
    }
    return best;
}

static ranking rank_targets( const guide_shape* ghosts, int ghost, const guide_shape* targets, const box* boxes,
                             int links )
{
    const wisp_vec3* points = guide_strand( ghosts, ghost );
    const int count = guide_vertices( ghosts, ghost ), guess = nearest_root( targets, points[0] );
    ranking r = { .links = links };
    for ( int n = -1; n < targets->topology->strand_count; ++n )
    {
        const int a = n < 0 ? guess : n, vertices = guide_vertices( targets, a );
        if ( ( n >= 0 && a == guess ) || vertices == 0 || is_beyond( boxes + a, points, count, worst( &r ) ) )
        {
            continue;
        }
        const double limit = worst( &r );
        const double distance = strand_distance( points, count, guide_strand( targets, a ), vertices, limit );
        if ( distance <= limit )
        {
            enter( &r, distance, a );
        }
    }
    return r;
}

// (1/d_k) / sum (1/d_j), scaled by the smallest distance: no overflow, and targets at distance 0 share all of it.
static void share_out( const ranking* r, double* fraction )
{
    double sum = 0.0;
    for ( int k = 0; k < r->links; ++k )
    {
        fraction[k] = r->distance[k] == r->distance[0] ? 1.0 : r->distance[0] / r->distance[k];
        sum += fraction[k];
    }
    for ( int k = 0; k < r->links; ++k )
    {
        fraction[k] /= sum;
    }
}

bool guide_assign( const guide_shape* ghosts, const guide_shape* targets, int links, int32_t* target,
                   double* fraction, guide_memory* scratch )
{
    const int target_count = targets->topology->strand_count;
    box* boxes = guide_take( scratch, (size_t)target_count, sizeof( box ) );
    if ( boxes == NULL )
    {
        return false;
    }
    for ( int a = 0; a < target_count; ++a )
    {
        boxes[a] = box_of( guide_strand( targets, a ), guide_vertices( targets, a ) );
    }
    for ( int g = 0; g < ghosts->topology->strand_count; ++g )
    {
        int32_t* own = target + (size_t)g * (size_t)links;
        if ( guide_vertices( ghosts, g ) == 0 )
        {
            for ( int k = 0; k < links; ++k )
            {
                own[k] = -1;
            }
            continue;
        }
        const ranking r = rank_targets( ghosts, g, targets, boxes, links );
        share_out( &r, fraction + (size_t)g * (size_t)links );
        for ( int k = 0; k < links; ++k )
        {
            own[k] = r.target[k];
        }
    }
    return true;
}
