// Points are inserted one by one into a square around them all, in the order of Hilbert's curve, so that the next
// triangle is found in a few steps from the last one; each insertion is followed by flips until it is Delaunay again.
// Then the edges of the outline become edges of triangles, and triangles outside of it are left out.
#include "delaunay.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- the lattice -----------------------------------------------------------------------------------------------

wisp_status delaunay_snap( const double* coordinates, int count, delaunay_point* out, const char* name,
                           wisp_error* error )
{
    double low[2] = { HUGE_VAL, HUGE_VAL }, high[2] = { -HUGE_VAL, -HUGE_VAL };
    for ( int i = 0; i < count; ++i )
    {
        for ( int axis = 0; axis < 2; ++axis )
        {
            double value = coordinates[2 * (size_t)i + (size_t)axis];
            if ( !isfinite( value ) )
            {
                return wisp_fail( error, WISP_BAD_INPUT, "%s: coordinate %c of point %d is not finite", name,
                                  axis == 0 ? 'x' : 'y', i );
            }
            low[axis] = fmin( low[axis], value );
            high[axis] = fmax( high[axis], value );
        }
    }
    double side = count > 0 ? fmax( high[0] - low[0], high[1] - low[1] ) : 0.0;
    double scale = ( DELAUNAY_SIDE - 1 ) / side;
    // Also false if the side overflows or is so small that its inverse does.
    if ( !( side > 0.0 && isfinite( side ) && isfinite( scale ) ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the %d points span %g, which no lattice fits", name, count,
                          side );
    }
    for ( int i = 0; i < count; ++i )
    {
        const double* p = coordinates + 2 * (size_t)i;
        out[i].x = (int32_t)( ( p[0] - low[0] ) * scale + 0.5 );
        out[i].y = (int32_t)( ( p[1] - low[1] ) * scale + 0.5 );
    }
    return WISP_OK;
}

// ---- triangles -------------------------------------------------------------------------------------------------

__extension__ typedef __int128 wide;

enum
{
    FRAME = 4,    // corners of a square around everything, behind the points
    NO_TWIN = -1, // across the frame there is nothing
};

// Half-edge 3 * t + k runs from corner k of triangle t to the next. Triangles are counter-clockwise.
typedef struct net
{
    const char* name;       // for messages
    delaunay_point* points; // [point_count + FRAME], the beginning of the memory of all arrays
    int32_t* leaving;       // [point_count + FRAME] a half-edge that begins at the point
    int32_t* corners;       // [3 * triangle_room] where each half-edge begins
    int32_t* twins;         // [3 * triangle_room] the half-edge across
    int32_t* stack;         // [3 * triangle_room] half-edges whose neighbourhood changed
    bool* locked;           // [3 * triangle_room] is a part of the outline and stays
    bool* waiting;          // [3 * triangle_room] lies on the stack
    int point_count, triangle_count, stack_count;
} net;

static wisp_status allocate( net* d, wisp_error* error )
{
    const size_t places = (size_t)d->point_count + FRAME, halves = 3 * ( 2 * places - FRAME - 2 );
    d->points = calloc( 1, places * ( sizeof *d->points + sizeof *d->leaving ) +
                               halves * ( 3 * sizeof *d->corners + 2 * sizeof *d->locked ) );
    if ( d->points == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory to join %d points", d->name, d->point_count );
    }
    d->leaving = (int32_t*)( d->points + places );
    d->corners = d->leaving + places;
    d->twins = d->corners + halves;
    d->stack = d->twins + halves;
    d->locked = (bool*)( d->stack + halves );
    d->waiting = d->locked + halves;
    return WISP_OK;
}

// The frame reaches one side of the lattice beyond it, so that differences of coordinates are at most 3 * 2^26, which
// is below 2^28. A product of two is below 2^56, a sum or a difference of two products below 2^57: 64 bits hold it.

// Twice the area of the triangle: positive if it runs counter-clockwise, 0 if the points lie on a line.
static int64_t turn( delaunay_point a, delaunay_point b, delaunay_point c )
{
    return ( (int64_t)b.x - a.x ) * ( (int64_t)c.y - a.y ) - ( (int64_t)b.y - a.y ) * ( (int64_t)c.x - a.x );
}

// Whether d lies inside the circle around a, b, c, which run counter-clockwise. The determinant is the sum of three
// products of a squared length and an area: below 3 * 2^57 * 2^57, which is below 2^116.
static bool is_inside( delaunay_point a, delaunay_point b, delaunay_point c, delaunay_point d )
{
    const delaunay_point corner[] = { a, b, c };
    wide determinant = 0;
    for ( int k = 0; k < 3; ++k )
    {
        int64_t x = (int64_t)corner[k].x - d.x, y = (int64_t)corner[k].y - d.y;
        determinant += (wide)( x * x + y * y ) * turn( d, corner[( k + 1 ) % 3], corner[( k + 2 ) % 3] );
    }
    return determinant > 0;
}

static int32_t next_of( int32_t half )
{
    return half % 3 == 2 ? half - 2 : half + 1;
}

static int32_t previous_of( int32_t half )
{
    return half % 3 == 0 ? half + 2 : half - 1;
}

// The point where a half-edge begins, and where it ends.
static int32_t begin_of( const net* d, int32_t half )
{
    return d->corners[half];
}

static int32_t end_of( const net* d, int32_t half )
{
    return d->corners[next_of( half )];
}

// ---- flips -----------------------------------------------------------------------------------------------------

static void push( net* d, int32_t half )
{
    if ( !d->waiting[half] )
    {
        d->waiting[half] = true;
        d->stack[d->stack_count++] = half;
    }
}

// Half-edge `half` takes over the neighbour beyond it from the triangle that had it before.
static void join( net* d, int32_t half, int32_t twin, bool is_locked )
{
    d->twins[half] = twin;
    d->locked[half] = is_locked;
    if ( twin != NO_TWIN )
    {
        d->twins[twin] = half;
        push( d, half );
    }
}

static void join_inside( net* d, int32_t half, int32_t twin )
{
    d->twins[half] = twin;
    d->twins[twin] = half;
    d->locked[half] = d->locked[twin] = false;
}

static void put_triangle( net* d, int32_t first_half, int32_t a, int32_t b, int32_t c )
{
    d->corners[first_half] = a;
    d->corners[first_half + 1] = b;
    d->corners[first_half + 2] = c;
    d->leaving[a] = first_half;
    d->leaving[b] = first_half + 1;
    d->leaving[c] = first_half + 2;
}

// Flip the edge p-q of the triangles p q r and q p o to o-r.
static void flip( net* d, int32_t half )
{
    int32_t twin = d->twins[half];
    int32_t qr = next_of( half ), rp = next_of( qr );
    int32_t po = next_of( twin ), oq = next_of( po );
    int32_t p = d->corners[half], q = d->corners[twin], r = d->corners[rp], o = d->corners[oq];
    const int32_t beyond[] = { d->twins[rp], d->twins[po], d->twins[oq], d->twins[qr] };
    const bool is_locked[] = { d->locked[rp], d->locked[po], d->locked[oq], d->locked[qr] };
    int32_t t = half - half % 3, s = twin - twin % 3;
    put_triangle( d, t, r, p, o );
    put_triangle( d, s, o, q, r );
    join( d, t, beyond[0], is_locked[0] );
    join( d, t + 1, beyond[1], is_locked[1] );
    join( d, s, beyond[2], is_locked[2] );
    join( d, s + 1, beyond[3], is_locked[3] );
    join_inside( d, t + 2, s + 2 );
}

// Over the points lifted to a paraboloid each flip lowers the surface of triangles, hence an end. Points on the circle
// do not flip.
static void settle( net* d )
{
    while ( d->stack_count > 0 )
    {
        int32_t half = d->stack[--d->stack_count], twin = d->twins[half];
        d->waiting[half] = false;
        if ( twin == NO_TWIN || d->locked[half] )
        {
            continue;
        }
        const delaunay_point* p = d->points;
        int32_t apex = d->corners[previous_of( half )], across = d->corners[previous_of( twin )];
        if ( is_inside( p[d->corners[half]], p[d->corners[twin]], p[apex], p[across] ) )
        {
            flip( d, half );
        }
    }
}

// ---- insertion -------------------------------------------------------------------------------------------------

static void put_frame( net* d )
{
    const int32_t lower = -DELAUNAY_SIDE, upper = 2 * DELAUNAY_SIDE;
    const delaunay_point frame[FRAME] = { { lower, lower }, { upper, lower }, { upper, upper }, { lower, upper } };
    int32_t first = d->point_count;
    for ( int k = 0; k < FRAME; ++k )
    {
        d->points[first + k] = frame[k];
    }
    put_triangle( d, 0, first, first + 1, first + 2 );
    put_triangle( d, 3, first, first + 2, first + 3 );
    for ( int half = 0; half < 6; ++half )
    {
        join( d, half, NO_TWIN, false );
    }
    join_inside( d, 2, 3 );
    d->triangle_count = 2;
}

// From triangle to triangle across an edge that has the point behind it. In a Delaunay triangulation this walk has no
// loops (Edelsbrunner 1990), and the frame contains every point, so it ends.
static int32_t find_triangle( const net* d, int32_t first_half, delaunay_point p )
{
    for ( ;; )
    {
        int k = 0;
        while ( k < 3 &&
                turn( d->points[begin_of( d, first_half + k )], d->points[end_of( d, first_half + k )], p ) >= 0 )
        {
            ++k;
        }
        if ( k == 3 )
        {
            return first_half;
        }
        int32_t twin = d->twins[first_half + k];
        first_half = twin - twin % 3;
    }
}

// Replace one triangle by three. A point on an edge leaves one of them flat, until that edge is flipped at once.
static void insert( net* d, int32_t t, int32_t point )
{
    int32_t a = d->corners[t], b = d->corners[t + 1], c = d->corners[t + 2];
    int32_t u = 3 * d->triangle_count, v = u + 3;
    const int32_t beyond[] = { d->twins[t], d->twins[t + 1], d->twins[t + 2] };
    const int32_t halves[] = { t, u, v };
    d->triangle_count += 2;
    put_triangle( d, t, a, b, point );
    put_triangle( d, u, b, c, point );
    put_triangle( d, v, c, a, point );
    for ( int k = 0; k < 3; ++k )
    {
        join( d, halves[k], beyond[k], false );
        join_inside( d, halves[k] + 1, halves[( k + 1 ) % 3] + 2 );
    }
    for ( int k = 0; k < 3; ++k )
    {
        if ( turn( d->points[begin_of( d, halves[k] )], d->points[end_of( d, halves[k] )], d->points[point] ) == 0 )
        {
            flip( d, halves[k] );
            break;
        }
    }
    settle( d );
}

// From the largest quarters to the smallest; the curve inside a quarter is turned so that the four join end to end.
uint64_t delaunay_curve( delaunay_point place )
{
    uint32_t x = (uint32_t)place.x, y = (uint32_t)place.y;
    uint64_t along = 0;
    for ( uint32_t half = DELAUNAY_SIDE / 2; half > 0; half /= 2 )
    {
        uint32_t right = ( x & half ) != 0, upper = ( y & half ) != 0;
        along = 4 * along + ( ( 3 * right ) ^ upper );
        if ( !upper )
        {
            uint32_t mirror = right ? DELAUNAY_SIDE - 1 : 0, old_x = x;
            x = y ^ mirror;
            y = old_x ^ mirror;
        }
    }
    return along;
}

typedef struct visit
{
    uint64_t along;
    int32_t point;
} visit;

static int compare_visits( const void* left, const void* right )
{
    const visit *a = left, *b = right;
    if ( a->along != b->along )
    {
        return a->along < b->along ? -1 : 1;
    }
    return a->point < b->point ? -1 : a->point > b->point;
}

// Points at one position are neighbours on the curve.
static wisp_status insert_all( net* d, wisp_error* error )
{
    put_frame( d );
    visit* visits = malloc( (size_t)d->point_count * sizeof *visits );
    if ( visits == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory to sort %d points", d->name, d->point_count );
    }
    for ( int i = 0; i < d->point_count; ++i )
    {
        visits[i] = ( visit ){ .along = delaunay_curve( d->points[i] ), .point = i };
    }
    qsort( visits, (size_t)d->point_count, sizeof *visits, compare_visits );
    wisp_status status = WISP_OK;
    int32_t near = 0;
    for ( int i = 0; i < d->point_count && status == WISP_OK; ++i )
    {
        if ( i > 0 && visits[i].along == visits[i - 1].along )
        {
            status = wisp_fail( error, WISP_BAD_INPUT, "%s: points %d and %d are at the same place", d->name,
                                visits[i - 1].point, visits[i].point );
            continue;
        }
        insert( d, find_triangle( d, near, d->points[visits[i].point] ), visits[i].point );
        near = d->leaving[visits[i].point] - d->leaving[visits[i].point] % 3;
    }
    free( visits );
    return status;
}

// ---- the outline -----------------------------------------------------------------------------------------------

// The path of an edge of the outline through the triangles.
typedef struct path
{
    int32_t from, to;
    int32_t edge;  // the half-edge that runs from `from` to `to`, or NO_TWIN while there is none
    int32_t cross; // otherwise the next half-edge that the path crosses: it begins on the right and ends on the left
} path;

static wisp_status refuse_point( const net* d, const path* w, int32_t point, wisp_error* error )
{
    return wisp_fail( error, WISP_BAD_INPUT, "%s: the outline from point %d to point %d passes through point %d",
                      d->name, w->from, w->to, point );
}

// Whether b is ahead and not behind, from a towards c, all three on a line.
static bool is_ahead( delaunay_point a, delaunay_point b, delaunay_point c )
{
    return ( (int64_t)b.x - a.x ) * ( (int64_t)c.x - a.x ) + ( (int64_t)b.y - a.y ) * ( (int64_t)c.y - a.y ) > 0;
}

// Walk around the first point, which the frame surrounds: the edge exists, or it leaves between two others.
static wisp_status set_out( const net* d, path* w, wisp_error* error )
{
    const delaunay_point a = d->points[w->from], b = d->points[w->to];
    w->edge = w->cross = NO_TWIN;
    for ( int32_t half = d->leaving[w->from];; half = d->twins[previous_of( half )] )
    {
        const int32_t right = end_of( d, half ), left = end_of( d, next_of( half ) );
        const int64_t side = turn( a, d->points[right], b );
        if ( right == w->to )
        {
            w->edge = half;
            return WISP_OK;
        }
        if ( side == 0 && is_ahead( a, d->points[right], b ) )
        {
            return refuse_point( d, w, right, error );
        }
        if ( side > 0 && turn( a, d->points[left], b ) < 0 )
        {
            w->cross = next_of( half );
            return WISP_OK;
        }
    }
}

// Step across the current edge, out of the triangle behind it by the one of its two other edges that the path
// crosses. At the end of the path `cross` is NO_TWIN.
static wisp_status go_on( const net* d, path* w, wisp_error* error )
{
    const int32_t back = d->twins[w->cross], apex = d->corners[previous_of( back )];
    const int64_t side = turn( d->points[w->from], d->points[w->to], d->points[apex] );
    w->cross = apex == w->to ? NO_TWIN : side > 0 ? next_of( back ) : previous_of( back );
    return apex != w->to && side == 0 ? refuse_point( d, w, apex, error ) : WISP_OK;
}

// Of the edges that the path crosses, the one to flip: its left end is the farthest from the path, and of the edges
// there its right end is; ties go to the first. Neighbours of a farthest point are lower or level on one side, so the
// quadrilateral is strictly convex at both ends of the edge and the flip is valid. Each flip removes an edge from the
// left end, which gets no new ones: in the end it is off the path, and then the next one, so the loop ends.
static wisp_status choose_flip( const net* d, path* w, int32_t* chosen, wisp_error* error )
{
    const delaunay_point a = d->points[w->from], b = d->points[w->to];
    int64_t highest = 0, deepest = 0;
    wisp_status status = WISP_OK;
    *chosen = w->cross;
    while ( status == WISP_OK && w->cross != NO_TWIN )
    {
        const int32_t right = begin_of( d, w->cross ), left = end_of( d, w->cross );
        if ( d->locked[w->cross] )
        {
            return wisp_fail(
                error, WISP_BAD_INPUT,
                "%s: the outline crosses itself: from point %d to point %d and from point %d to point %d", d->name,
                w->from, w->to, right, left );
        }
        const int64_t height = turn( a, b, d->points[left] ), depth = -turn( a, b, d->points[right] );
        if ( height > highest || ( left == end_of( d, *chosen ) && depth > deepest ) )
        {
            highest = height;
            deepest = depth;
            *chosen = w->cross;
        }
        status = go_on( d, w, error );
    }
    return status;
}

// Make an edge of the outline one of triangles, and lock it.
static wisp_status enforce_edge( net* d, int32_t from, int32_t to, wisp_error* error )
{
    path w = { .from = from, .to = to };
    WISP_TRY( set_out( d, &w, error ) );
    while ( w.edge == NO_TWIN )
    {
        int32_t chosen;
        WISP_TRY( choose_flip( d, &w, &chosen, error ) );
        // The new diagonal need not be Delaunay. The path still crosses a triangle next to it, unless it is the
        // edge itself, so a later flip puts it on the stack.
        flip( d, chosen );
        WISP_TRY( set_out( d, &w, error ) );
    }
    d->locked[w.edge] = d->locked[d->twins[w.edge]] = true;
    settle( d );
    return WISP_OK;
}

// ---- inside and outside ----------------------------------------------------------------------------------------

// From the frame, across all edges that are not part of the outline. @param outside [triangle_count] all false
static void flood_outside( net* d, bool* outside )
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
            if ( twin != NO_TWIN && !d->locked[3 * t + k] && !outside[twin / 3] )
            {
                outside[twin / 3] = true;
                d->stack[count++] = twin / 3;
            }
        }
    }
}

// Write the triangles inside the outline. A point that is outside of it has none of them.
static wisp_status take_inside( net* d, int32_t* triangles, wisp_error* error )
{
    // Nothing waits any more, and no lock is asked for after the flood.
    bool *outside = d->waiting, *has_triangle = d->locked;
    flood_outside( d, outside );
    memset( has_triangle, 0, (size_t)d->point_count * sizeof *has_triangle );
    for ( int half = 0; half < 3 * d->triangle_count; ++half )
    {
        has_triangle[d->corners[half]] = has_triangle[d->corners[half]] || !outside[half / 3];
    }
    for ( int i = 0; i < d->point_count; ++i )
    {
        if ( !has_triangle[i] )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: point %d lies outside of the outline", d->name, i );
        }
    }
    for ( int t = 0; t < d->triangle_count; ++t )
    {
        if ( !outside[t] )
        {
            memcpy( triangles, d->corners + 3 * (size_t)t, 3 * sizeof *triangles );
            triangles += 3;
        }
    }
    return WISP_OK;
}

// ---- the whole -------------------------------------------------------------------------------------------------

static wisp_status check( const delaunay_point* points, int count, int outline_count, const char* name,
                          wisp_error* error )
{
    if ( outline_count < 3 || count < outline_count || count > DELAUNAY_SIDE )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: %d points in all, %d of them the outline, which must be at least 3 and at most all, "
                          "which must be at most %d",
                          name, count, outline_count, DELAUNAY_SIDE );
    }
    for ( int i = 0; i < count; ++i )
    {
        if ( points[i].x < 0 || points[i].x >= DELAUNAY_SIDE || points[i].y < 0 || points[i].y >= DELAUNAY_SIDE )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: point %d is off the lattice", name, i );
        }
    }
    // Each product is below 2^52 and there are at most 2^26 of them: 2^78 does not fit 64 bits.
    wide area = 0;
    for ( int i = 0; i < outline_count; ++i )
    {
        delaunay_point p = points[i], q = points[i + 1 < outline_count ? i + 1 : 0];
        area += (int64_t)p.x * q.y - (int64_t)p.y * q.x;
    }
    return area > 0 ? WISP_OK
                    : wisp_fail( error, WISP_BAD_INPUT, "%s: the outline of %d points %s", name, outline_count,
                                 area < 0 ? "runs clockwise" : "has no area" );
}

wisp_status delaunay_fill( const delaunay_point* points, int count, int outline_count, int32_t* triangles,
                           const char* name, wisp_error* error )
{
    WISP_TRY( check( points, count, outline_count, name, error ) );
    net d = { .name = name, .point_count = count };
    wisp_status status = allocate( &d, error );
    if ( status == WISP_OK )
    {
        memcpy( d.points, points, (size_t)count * sizeof *points );
        status = insert_all( &d, error );
    }
    for ( int i = 0; i < outline_count && status == WISP_OK; ++i )
    {
        status = enforce_edge( &d, i, i + 1 < outline_count ? i + 1 : 0, error );
    }
    status = status == WISP_OK ? take_inside( &d, triangles, error ) : status;
    free( d.points );
    return status;
}
