// Points are inserted one by one into a square around them all, in the order of Hilbert's curve, so that the next
// triangle is found in a few steps from the last one; each insertion is followed by flips until it is Delaunay again.
#include "delaunay_internal.h"

#include <stdlib.h>

// ---- flips -----------------------------------------------------------------------------------------------------

static void push( delaunay* d, int32_t half )
{
    if ( !d->waiting[half] )
    {
        d->waiting[half] = true;
        d->stack[d->stack_count++] = half;
    }
}

// Half-edge `half` takes over the neighbour beyond it from the triangle that had it before.
static void join( delaunay* d, int32_t half, int32_t twin, bool is_locked )
{
    d->twins[half] = twin;
    d->locked[half] = is_locked;
    if ( twin != DELAUNAY_NO_TWIN )
    {
        d->twins[twin] = half;
        push( d, half );
    }
}

static void join_inside( delaunay* d, int32_t half, int32_t twin )
{
    d->twins[half] = twin;
    d->twins[twin] = half;
    d->locked[half] = d->locked[twin] = false;
}

static void put_triangle( delaunay* d, int32_t first_half, int32_t a, int32_t b, int32_t c )
{
    d->corners[first_half] = a;
    d->corners[first_half + 1] = b;
    d->corners[first_half + 2] = c;
    d->leaving[a] = first_half;
    d->leaving[b] = first_half + 1;
    d->leaving[c] = first_half + 2;
}

// Flip the edge p-q of the triangles p q r and q p o to o-r.
void delaunay_flip( delaunay* d, int32_t half )
{
    int32_t twin = d->twins[half];
    int32_t qr = delaunay_next( half ), rp = delaunay_next( qr );
    int32_t po = delaunay_next( twin ), oq = delaunay_next( po );
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
void delaunay_settle( delaunay* d )
{
    while ( d->stack_count > 0 )
    {
        int32_t half = d->stack[--d->stack_count], twin = d->twins[half];
        d->waiting[half] = false;
        if ( twin == DELAUNAY_NO_TWIN || d->locked[half] )
        {
            continue;
        }
        const delaunay_point* p = d->points;
        int32_t apex = d->corners[delaunay_previous( half )], across = d->corners[delaunay_previous( twin )];
        if ( delaunay_is_inside( p[d->corners[half]], p[d->corners[twin]], p[apex], p[across] ) )
        {
            delaunay_flip( d, half );
        }
    }
}

// ---- insertion -------------------------------------------------------------------------------------------------

static void put_frame( delaunay* d )
{
    const int32_t lower = -DELAUNAY_SIDE, upper = 2 * DELAUNAY_SIDE;
    const delaunay_point frame[DELAUNAY_FRAME] = {
        { lower, lower }, { upper, lower }, { upper, upper }, { lower, upper }
    };
    int32_t first = d->point_count;
    for ( int k = 0; k < DELAUNAY_FRAME; ++k )
    {
        d->points[first + k] = frame[k];
    }
    put_triangle( d, 0, first, first + 1, first + 2 );
    put_triangle( d, 3, first, first + 2, first + 3 );
    for ( int half = 0; half < 6; ++half )
    {
        join( d, half, DELAUNAY_NO_TWIN, false );
    }
    join_inside( d, 2, 3 );
    d->triangle_count = 2;
}

// From triangle to triangle across an edge that has the point behind it. In a Delaunay triangulation this walk has no
// loops (Edelsbrunner 1990), and the frame contains every point, so it ends.
static int32_t find_triangle( const delaunay* d, int32_t first_half, delaunay_point p )
{
    for ( ;; )
    {
        int k = 0;
        while ( k < 3 && delaunay_turn( d->points[delaunay_from( d, first_half + k )],
                                        d->points[delaunay_to( d, first_half + k )], p ) >= 0 )
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
static void insert( delaunay* d, int32_t t, int32_t point )
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
        if ( delaunay_turn( d->points[delaunay_from( d, halves[k] )], d->points[delaunay_to( d, halves[k] )],
                            d->points[point] ) == 0 )
        {
            delaunay_flip( d, halves[k] );
            break;
        }
    }
    delaunay_settle( d );
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
wisp_status delaunay_insert( delaunay* d, wisp_error* error )
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
