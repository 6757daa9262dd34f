// From points to triangles: points are snapped to a lattice, checked and inserted, and the outline is enforced.
#include "delaunay_internal.h"

#include <math.h>
#include <stdlib.h>

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

// ---- triangulation ---------------------------------------------------------------------------------------------

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
    delaunay_wide area = 0;
    for ( int i = 0; i < outline_count; ++i )
    {
        delaunay_point p = points[i], q = points[i + 1 < outline_count ? i + 1 : 0];
        area += (int64_t)p.x * q.y - (int64_t)p.y * q.x;
    }
    return area > 0 ? WISP_OK
                    : wisp_fail( error, WISP_BAD_INPUT, "%s: the outline of %d points %s", name, outline_count,
                                 area < 0 ? "runs clockwise" : "has no area" );
}

static wisp_status allocate( delaunay* d, wisp_error* error )
{
    size_t places = (size_t)d->point_count + DELAUNAY_FRAME;
    size_t halves = 3 * ( 2 * places - DELAUNAY_FRAME - 2 );
    d->points = malloc( places * sizeof *d->points );
    d->leaving = malloc( places * sizeof *d->leaving );
    d->corners = malloc( halves * sizeof *d->corners );
    d->twins = malloc( halves * sizeof *d->twins );
    d->stack = malloc( halves * sizeof *d->stack );
    d->locked = calloc( halves, sizeof *d->locked );
    d->waiting = calloc( halves, sizeof *d->waiting );
    if ( d->points && d->leaving && d->corners && d->twins && d->stack && d->locked && d->waiting )
    {
        return WISP_OK;
    }
    return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory to join %d points", d->name, d->point_count );
}

static void release( delaunay* d )
{
    free( d->points );
    free( d->leaving );
    free( d->corners );
    free( d->twins );
    free( d->stack );
    free( d->locked );
    free( d->waiting );
}

wisp_status delaunay_fill( const delaunay_point* points, int count, int outline_count, int32_t* triangles,
                           const char* name, wisp_error* error )
{
    wisp_status status = check( points, count, outline_count, name, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    delaunay d = { .name = name, .point_count = count };
    status = allocate( &d, error );
    if ( status == WISP_OK )
    {
        for ( int i = 0; i < count; ++i )
        {
            d.points[i] = points[i];
        }
        status = delaunay_insert( &d, error );
    }
    if ( status == WISP_OK )
    {
        status = delaunay_enforce( &d, outline_count, error );
    }
    if ( status == WISP_OK )
    {
        status = delaunay_take_inside( &d, outline_count, triangles, error );
    }
    release( &d );
    return status;
}
