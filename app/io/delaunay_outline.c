// The outline: its edges become edges of triangles, and triangles outside of it are left out.
#include "delaunay_internal.h"

#include <stdlib.h>
#include <string.h>

// ---- edges -----------------------------------------------------------------------------------------------------

// State of an edge of the outline on its path through the triangles.
typedef struct way
{
    int32_t from, to;
    int32_t edge;  // the half-edge that runs from `from` to `to`, or DELAUNAY_NO_TWIN while there is none
    int32_t cross; // otherwise the next half-edge that the path crosses: it begins on the right and ends on the left
} way;

static wisp_status refuse_point( const delaunay* d, const way* w, int32_t point, wisp_error* error )
{
    return wisp_fail( error, WISP_BAD_INPUT, "%s: the outline from point %d to point %d passes through point %d",
                      d->name, w->from, w->to, point );
}

static wisp_status refuse_intersection( const delaunay* d, const way* w, wisp_error* error )
{
    return wisp_fail( error, WISP_BAD_INPUT,
                      "%s: the outline crosses itself: from point %d to point %d and from point %d to point %d",
                      d->name, w->from, w->to, delaunay_from( d, w->cross ), delaunay_to( d, w->cross ) );
}

// Whether b is ahead and not behind, from a towards c, all three on a line.
static bool is_ahead( delaunay_point a, delaunay_point b, delaunay_point c )
{
    return ( (int64_t)b.x - a.x ) * ( (int64_t)c.x - a.x ) + ( (int64_t)b.y - a.y ) * ( (int64_t)c.y - a.y ) > 0;
}

// Walk around the first point, which the frame surrounds: the edge exists, or it leaves between two others.
static wisp_status set_out( const delaunay* d, way* w, wisp_error* error )
{
    const delaunay_point* points = d->points;
    delaunay_point a = points[w->from], b = points[w->to];
    int32_t half = d->leaving[w->from];
    w->edge = w->cross = DELAUNAY_NO_TWIN;
    for ( ;; )
    {
        int32_t right = delaunay_to( d, half ), opposite = delaunay_next( half );
        int64_t turn = delaunay_turn( a, points[right], b );
        if ( right == w->to )
        {
            w->edge = half;
            return WISP_OK;
        }
        if ( turn == 0 && is_ahead( a, points[right], b ) )
        {
            return refuse_point( d, w, right, error );
        }
        if ( turn > 0 && delaunay_turn( a, points[delaunay_to( d, opposite )], b ) < 0 )
        {
            w->cross = opposite;
            return d->locked[opposite] ? refuse_intersection( d, w, error ) : WISP_OK;
        }
        half = d->twins[delaunay_previous( half )];
    }
}

// Step across the current edge, out of the triangle behind it by the one of its two other edges that the path
// crosses. At the end of the path `cross` is DELAUNAY_NO_TWIN.
static wisp_status go_on( const delaunay* d, way* w, wisp_error* error )
{
    int32_t back = d->twins[w->cross], apex = d->corners[delaunay_previous( back )];
    if ( apex == w->to )
    {
        w->cross = DELAUNAY_NO_TWIN;
        return WISP_OK;
    }
    int64_t side = delaunay_turn( d->points[w->from], d->points[w->to], d->points[apex] );
    if ( side == 0 )
    {
        return refuse_point( d, w, apex, error );
    }
    w->cross = side > 0 ? delaunay_next( back ) : delaunay_previous( back );
    return d->locked[w->cross] ? refuse_intersection( d, w, error ) : WISP_OK;
}

// Of the edges that the path crosses, the one to flip: its left end is the farthest from the path, and of the edges
// there its right end is; ties go to the first. Neighbours of a farthest point are lower or level on one side, so the
// quadrilateral is strictly convex at both ends of the edge and the flip is valid. Each flip removes an edge from the
// left end, which gets no new ones: in the end it is off the path, and then the next one, so the loop ends.
static wisp_status choose_flip( const delaunay* d, way* w, int32_t* chosen, wisp_error* error )
{
    delaunay_point a = d->points[w->from], b = d->points[w->to];
    int64_t highest = 0, deepest = 0;
    wisp_status status = WISP_OK;
    *chosen = w->cross;
    while ( status == WISP_OK && w->cross != DELAUNAY_NO_TWIN )
    {
        int32_t left = delaunay_to( d, w->cross );
        int64_t height = delaunay_turn( a, b, d->points[left] );
        int64_t depth = -delaunay_turn( a, b, d->points[delaunay_from( d, w->cross )] );
        if ( height > highest || ( left == delaunay_to( d, *chosen ) && depth > deepest ) )
        {
            highest = height;
            deepest = depth;
            *chosen = w->cross;
        }
        status = go_on( d, w, error );
    }
    return status;
}

static wisp_status enforce_edge( delaunay* d, int32_t from, int32_t to, wisp_error* error )
{
    way w = { .from = from, .to = to };
    wisp_status status = set_out( d, &w, error );
    while ( status == WISP_OK && w.edge == DELAUNAY_NO_TWIN )
    {
        int32_t chosen;
        status = choose_flip( d, &w, &chosen, error );
        if ( status == WISP_OK )
        {
            // The new diagonal need not be Delaunay. The path still crosses a triangle next to it, unless it is the
            // edge itself, so a later flip puts it on the stack.
            delaunay_flip( d, chosen );
            status = set_out( d, &w, error );
        }
    }
    if ( status == WISP_OK )
    {
        d->locked[w.edge] = d->locked[d->twins[w.edge]] = true;
        delaunay_settle( d );
    }
    return status;
}

wisp_status delaunay_enforce( delaunay* d, int outline_count, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < outline_count && status == WISP_OK; ++i )
    {
        status = enforce_edge( d, i, i + 1 < outline_count ? i + 1 : 0, error );
    }
    return status;
}

// ---- inside and outside ----------------------------------------------------------------------------------------

// From the frame, across all edges that are not part of the outline.
static void flood_outside( delaunay* d, bool* outside )
{
    int32_t t = d->leaving[d->point_count] / 3;
    outside[t] = true;
    d->stack[0] = t;
    int count = 1;
    while ( count > 0 )
    {
        t = d->stack[--count];
        for ( int k = 0; k < 3; ++k )
        {
            int32_t twin = d->twins[3 * t + k];
            if ( twin != DELAUNAY_NO_TWIN && !d->locked[3 * t + k] && !outside[twin / 3] )
            {
                outside[twin / 3] = true;
                d->stack[count++] = twin / 3;
            }
        }
    }
}

static wisp_status refuse_outsider( const delaunay* d, const bool* outside, bool* is_inside, wisp_error* error )
{
    for ( int half = 0; half < 3 * d->triangle_count; ++half )
    {
        is_inside[d->corners[half]] = is_inside[d->corners[half]] || !outside[half / 3];
    }
    int i = 0;
    while ( i + 1 < d->point_count && is_inside[i] )
    {
        ++i;
    }
    return wisp_fail( error, WISP_BAD_INPUT, "%s: point %d lies outside of the outline", d->name, i );
}

wisp_status delaunay_take_inside( delaunay* d, int outline_count, int32_t* triangles, wisp_error* error )
{
    bool* outside = calloc( (size_t)d->triangle_count, sizeof *outside );
    if ( outside == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory to sort out %d triangles", d->name,
                          d->triangle_count );
    }
    flood_outside( d, outside );
    int count = 0, requested = delaunay_triangle_count( d->point_count, outline_count );
    for ( int t = 0; t < d->triangle_count; ++t )
    {
        count += !outside[t];
    }
    wisp_status status = WISP_OK;
    if ( count != requested )
    {
        // A point that is not a corner of a remaining triangle removes two triangles. The stack is empty now.
        status = refuse_outsider( d, outside, d->waiting, error );
    }
    for ( int t = 0, kept = 0; t < d->triangle_count && status == WISP_OK; ++t )
    {
        if ( !outside[t] )
        {
            memcpy( triangles + 3 * (size_t)kept++, d->corners + 3 * (size_t)t, 3 * sizeof *triangles );
        }
    }
    free( outside );
    return status;
}
