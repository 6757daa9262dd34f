// Queries of voxels: closest points ring by ring, paths voxel by voxel.
#include "voxels.h"

enum
{
    SEEN = 64,      // recently proposed triangles, by the last bits of their index
    NEAR_RINGS = 3, // rings of voxels around the point; beyond them blocks are visited first
};

// ---- lists ----

// Tests whether a triangle was proposed recently. Triangles are listed in several adjacent voxels; proposing one
// again costs time and changes nothing.
typedef struct seen_triangles
{
    int32_t number[SEEN];
} seen_triangles;

static void forget_all( seen_triangles* seen )
{
    for ( int i = 0; i < SEEN; ++i )
    {
        seen->number[i] = -1;
    }
}

static bool is_new( seen_triangles* seen, int32_t triangle )
{
    int32_t* place = seen->number + (uint32_t)triangle % SEEN;
    bool is = *place != triangle;
    *place = triangle;
    return is;
}

// ---- closest points ----

typedef struct closest_walk
{
    const voxels* v;
    mesh_closest* search;
    double point[3];
    double most;   // m^2: farther triangles are skipped
    int centre[3]; // voxel of the point, clamped to the grid
    seen_triangles seen;
} closest_walk;

// Resolution and bounds of a ring traversal: single voxels or blocks.
typedef struct ring_walk
{
    int unit; // voxels along an edge of a cell
    int centre[3], first[3], last[3];
} ring_walk;

static void max_set( closest_walk* w )
{
    double radius = mesh_closest_radius( w->search );
    w->most = radius * radius;
}

// Returns the squared distance in m^2 along one axis from the point to the `unit` voxels that begin at `first`.
static double square_gap( const closest_walk* w, int axis, int first, int unit )
{
    double lower = w->v->lower[axis] + (double)first * w->v->size, upper = lower + (double)unit * w->v->size;
    double gap = fmax( 0.0, fmax( lower - w->point[axis], w->point[axis] - upper ) );
    return gap * gap;
}

// Tests whether the box of a triangle is beyond the search distance. This rejects half of the listed triangles, at
// a tenth of the cost of the exact distance.
static bool is_far( const closest_walk* w, int32_t triangle )
{
    const mesh_surface* s = w->search->surface;
    const int32_t* number = s->triangles + 3 * (size_t)triangle;
    const float *a = s->xyzw + 4 * (size_t)number[0], *b = s->xyzw + 4 * (size_t)number[1],
                *c = s->xyzw + 4 * (size_t)number[2];
    double sum = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        float ab_low = a[k] < b[k] ? a[k] : b[k], lower = ab_low < c[k] ? ab_low : c[k];
        float ab_high = a[k] > b[k] ? a[k] : b[k], upper = ab_high > c[k] ? ab_high : c[k];
        double below = (double)lower - w->v->widening - w->point[k],
               above = w->point[k] - (double)upper - w->v->widening;
        double gap = below > above ? below : above;
        sum += gap > 0.0 ? gap * gap : 0.0;
    }
    return sum > w->most;
}

static void propose_voxel( closest_walk* w, int32_t voxel )
{
    const int32_t *begins = w->v->begins.data, *lists = w->v->lists.data;
    for ( int32_t i = begins[voxel]; i < begins[voxel + 1]; ++i )
    {
        if ( is_new( &w->seen, lists[i] ) && !is_far( w, lists[i] ) && mesh_closest_propose( w->search, lists[i] ) )
        {
            max_set( w );
        }
    }
}

static bool was_near( const closest_walk* w, const int at[3] )
{
    int far = 0;
    for ( int k = 0; k < 3; ++k )
    {
        int away = at[k] < w->centre[k] ? w->centre[k] - at[k] : at[k] - w->centre[k];
        far = away > far ? away : far;
    }
    return far <= NEAR_RINGS;
}

static void propose_block( closest_walk* w, int x, int y, int z )
{
    const voxels* v = w->v;
    uint64_t mask = ( (const uint64_t*)v->masks.data )[( z * v->blocks[1] + y ) * v->blocks[0] + x];
    for ( ; mask != 0; mask &= mask - 1 )
    {
        int bit = __builtin_ctzll( mask );
        const int at[3] = { VOXELS_BLOCK * x + bit % VOXELS_BLOCK,
                            VOXELS_BLOCK * y + bit / VOXELS_BLOCK % VOXELS_BLOCK,
                            VOXELS_BLOCK * z + bit / ( VOXELS_BLOCK * VOXELS_BLOCK ) };
        double gap = square_gap( w, 0, at[0], 1 ) + square_gap( w, 1, at[1], 1 ) + square_gap( w, 2, at[2], 1 );
        if ( gap <= w->most && !was_near( w, at ) )
        {
            propose_voxel( w, voxels_number( v, at[0], at[1], at[2] ) );
        }
    }
}

// Visits one row of a ring along x; unless it is `whole`, only its two ends belong to the ring.
static void walk_row( closest_walk* w, const ring_walk* r, int ring, int y, int z, bool whole )
{
    double gap = square_gap( w, 1, r->unit * y, r->unit ) + square_gap( w, 2, r->unit * z, r->unit );
    if ( gap > w->most )
    {
        return;
    }
    int stride = whole || ring == 0 ? 1 : 2 * ring;
    for ( int x = r->centre[0] - ring; x <= r->centre[0] + ring; x += stride )
    {
        if ( x < r->first[0] || x > r->last[0] || gap + square_gap( w, 0, r->unit * x, r->unit ) > w->most )
        {
            continue;
        }
        if ( r->unit == 1 )
        {
            propose_voxel( w, voxels_number( w->v, x, y, z ) );
        }
        else
        {
            propose_block( w, x, y, z );
        }
    }
}

static int greater( int a, int b )
{
    return a > b ? a : b;
}

static int lesser( int a, int b )
{
    return a < b ? a : b;
}

// Visits the cells at distance `ring` from the centre along one axis and at most `ring` along the others.
static void walk_ring( closest_walk* w, const ring_walk* r, int ring )
{
    const int* c = r->centre;
    for ( int z = greater( r->first[2], c[2] - ring ); z <= lesser( r->last[2], c[2] + ring ); ++z )
    {
        for ( int y = greater( r->first[1], c[1] - ring ); y <= lesser( r->last[1], c[1] + ring ); ++y )
        {
            bool whole = z == c[2] - ring || z == c[2] + ring || y == c[1] - ring || y == c[1] + ring;
            walk_row( w, r, ring, y, z, whole );
        }
    }
}

// Returns a lower bound, in m^2, of the squared distance to voxels outside the ring; infinite if there are none.
// For a point outside the grid, the distance to the grid's box is added, since the two meet at a right angle or
// more.
static double square_beyond( const closest_walk* w, const ring_walk* r, int ring )
{
    const voxels* v = w->v;
    double outside = 0.0, inside = (double)INFINITY;
    for ( int k = 0; k < 3; ++k )
    {
        double lower = v->lower[k], upper = lower + (double)v->count[k] * v->size, p = w->point[k];
        double nearest = fmin( fmax( p, lower ), upper ), edge = v->size * (double)r->unit;
        outside += ( p - nearest ) * ( p - nearest );
        int first = r->centre[k] - ring, last = r->centre[k] + ring + 1;
        inside = first > r->first[k] ? fmin( inside, nearest - ( lower + (double)first * edge ) ) : inside;
        inside = last <= r->last[k] ? fmin( inside, lower + (double)last * edge - nearest ) : inside;
    }
    inside = fmax( inside, 0.0 );
    return outside + inside * inside;
}

// Computes the part of the grid within the radius, in cells of some voxels.
static ring_walk make_rings( const closest_walk* w, int unit )
{
    ring_walk r = { .unit = unit };
    double radius = sqrt( w->most );
    for ( int k = 0; k < 3; ++k )
    {
        r.centre[k] = w->centre[k] / unit;
        r.first[k] = voxels_at( w->v, k, w->point[k] - radius ) / unit;
        r.last[k] = voxels_at( w->v, k, w->point[k] + radius ) / unit;
    }
    return r;
}

// Visits rings from the inside to the outside.
// @return whether nothing nearer is possible beyond the last one
static bool walk_rings( closest_walk* w, const ring_walk* r, int rings )
{
    for ( int ring = 0; ring <= rings; ++ring )
    {
        walk_ring( w, r, ring );
        if ( square_beyond( w, r, ring ) > w->most )
        {
            return true;
        }
    }
    return false;
}

void voxels_find_closest( const voxels* v, mesh_closest* search )
{
    closest_walk w = { .v = v, .search = search, .point = { search->point.x, search->point.y, search->point.z } };
    max_set( &w );
    double gap = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        w.centre[k] = voxels_at( v, k, w.point[k] );
        gap += square_gap( &w, k, 0, v->count[k] );
    }
    if ( gap > w.most )
    {
        return;
    }
    forget_all( &w.seen );
    ring_walk near = make_rings( &w, 1 );
    if ( !walk_rings( &w, &near, NEAR_RINGS ) )
    {
        ring_walk far = make_rings( &w, VOXELS_BLOCK );
        walk_rings( &w, &far, INT32_MAX - 1 );
    }
}

// ---- paths ----

typedef struct path_walk
{
    const voxels* v;
    double from[3], step[3];
    int at[3];
} path_walk;

// Computes the time at which the path leaves its voxel along an axis, as a fraction; computed from scratch for each
// voxel, so that errors do not accumulate.
static double leaving_time( const path_walk* w, int axis )
{
    if ( w->step[axis] == 0.0 )
    {
        return (double)INFINITY;
    }
    double side = (double)( w->at[axis] + ( w->step[axis] > 0.0 ? 1 : 0 ) );
    return ( w->v->lower[axis] + side * w->v->size - w->from[axis] ) / w->step[axis];
}

static path_walk make_path_walk( const voxels* v, const mesh_cast* search, double begin )
{
    path_walk w = { .v = v,
                    .from = { search->from.x, search->from.y, search->from.z },
                    .step = { search->to.x - search->from.x, search->to.y - search->from.y,
                              search->to.z - search->from.z } };
    for ( int k = 0; k < 3; ++k )
    {
        w.at[k] = voxels_at( v, k, w.from[k] + begin * w.step[k] );
    }
    return w;
}

// Traverses voxels as in Amanatides and Woo 1987, "A fast voxel traversal algorithm for ray tracing". Where a path
// crosses an edge of a voxel, the diagonal neighbour may be skipped. What is crossed there is listed in both
// voxels, because lists are widened.
static void walk_path( path_walk* w, mesh_cast* search, double end )
{
    const int32_t *begins = w->v->begins.data, *lists = w->v->lists.data;
    double leaving[3] = { leaving_time( w, 0 ), leaving_time( w, 1 ), leaving_time( w, 2 ) };
    double slack = search->slack / search->length;
    seen_triangles seen;
    forget_all( &seen );
    for ( ;; )
    {
        int32_t voxel = voxels_number( w->v, w->at[0], w->at[1], w->at[2] );
        for ( int32_t i = begins[voxel]; i < begins[voxel + 1]; ++i )
        {
            if ( is_new( &seen, lists[i] ) )
            {
                mesh_cast_propose( search, lists[i] );
            }
        }
        int axis = leaving[0] <= leaving[1] ? 0 : 1;
        axis = leaving[axis] <= leaving[2] ? axis : 2;
        double time = leaving[axis];
        bool is_over = time > end || ( search->triangle >= 0 && time > search->best.time + slack );
        w->at[axis] += w->step[axis] > 0.0 ? 1 : -1;
        if ( is_over || w->at[axis] < 0 || w->at[axis] >= w->v->count[axis] )
        {
            return;
        }
        leaving[axis] = leaving_time( w, axis );
    }
}

void voxels_find_intersection( const voxels* v, mesh_cast* search )
{
    double lower[3], upper[3], begin, end;
    for ( int k = 0; k < 3; ++k )
    {
        lower[k] = v->lower[k];
        upper[k] = lower[k] + (double)v->count[k] * v->size;
    }
    if ( mesh_cast_clip( search, lower, upper, &begin, &end ) )
    {
        path_walk walk = make_path_walk( v, search, begin );
        walk_path( &walk, search, end );
    }
}
