// Hinges of a plate: their places in the rest shape, and how two triangles share the turn of their hinge.
#include "plate_parts.h"

#include <math.h>
#include <string.h>

enum
{
    MONOMIALS = 3, // quadratic surfaces of unit curvature: x x / 2, y y / 2, x y / sqrt 2
};

// Shares below this are dropped. They are rounding errors on regular meshes, whose rows become half as long.
static const double LEAST_SHARE = 1e-5;
// Of the sum of squares that a fit is solved with: where hinges lie badly for a fit, the share stays near that by height.
static const double REGULARISATION = 1e-4;
// A triangle lower than this part of its edge has no direction, so its edges are open.
static const double LEAST_HEIGHT = 1e-5;
typedef struct vec2d
{
    double x, y;
} vec2d;

// ---- hinges ----

// Place of an opposite corner relative to its edge. @return whether the triangle has a height
static bool measure_side( const wisp_fabric* f, const int32_t* corner, int side, plate_shape* shape )
{
    const int32_t opposite = corner[2 + side], t[3] = { corner[0], corner[1], opposite };
    const plate_vector e = plate_edge( f, corner[0], corner[1] ), d = plate_edge( f, corner[0], opposite );
    shape->length = sqrt( plate_dot( e, e ) );
    if ( !( shape->length > 0.0 ) )
    {
        return false;
    }
    shape->foot[side] = plate_dot( d, e ) / plate_dot( e, e );
    shape->height[side] = 2.0 * plate_area( f, t ) / shape->length;
    return shape->height[side] > LEAST_HEIGHT * shape->length;
}

bool plate_measure_hinge( const wisp_fabric* f, const plate_hinge* h, plate_shape* out )
{
    const int32_t* corner = plate_corners( f, h );
    return measure_side( f, corner, 0, out ) && measure_side( f, corner, 1, out );
}

// J is the jump of the gradients of the two triangles along the normal of the edge (Bergou et al. 2006, eq. 4).
static void set_row( plate_hinge* h, const plate_shape* shape )
{
    double row[PLATE_CORNERS] = { 0.0 };
    for ( int side = 0; side < 2; ++side )
    {
        const double per_height = 1.0 / shape->height[side];
        row[0] += ( 1.0 - shape->foot[side] ) * per_height;
        row[1] += shape->foot[side] * per_height;
        row[2 + side] = -per_height;
    }
    for ( int k = 0; k < PLATE_CORNERS; ++k )
    {
        h->row[k] = (float)row[k];
    }
}

// Half edges of triangles, 3 times the triangle and the corner they begin at, by that corner's vertex.
typedef struct half_edges
{
    int32_t *first, *next; // [vertex_count], [3 times triangle_count]; -1: none
} half_edges;

static bool list_half_edges( const wisp_fabric* f, fabric_pool* scratch, half_edges* out )
{
    const size_t vertices = (size_t)f->vertex_count, count = 3 * (size_t)f->triangle_count;
    out->first = fabric_pool_push( scratch, vertices, sizeof( int32_t ) );
    out->next = fabric_pool_push( scratch, count, sizeof( int32_t ) );
    if ( out->first == NULL || out->next == NULL )
    {
        return false;
    }
    memset( out->first, -1, vertices * sizeof( int32_t ) );
    for ( size_t e = 0; e < count; ++e )
    {
        out->next[e] = out->first[f->triangles[e]];
        out->first[f->triangles[e]] = (int32_t)e;
    }
    return true;
}

static int32_t find_half_edge( const half_edges* edges, const wisp_fabric* f, int32_t from, int32_t to )
{
    int32_t e = edges->first[from];
    while ( e >= 0 && f->triangles[e / 3 * 3 + ( e + 1 ) % 3] != to )
    {
        e = edges->next[e];
    }
    return e;
}

static bool connect_hinges( wisp_plate* plate, const wisp_fabric* f, plate_shape* shapes, fabric_pool* scratch )
{
    half_edges edges;
    if ( list_half_edges( f, scratch, &edges ) == false )
    {
        return false;
    }
    memset( plate->triangle_hinge, -1, (size_t)f->triangle_count * sizeof( plate->triangle_hinge[0] ) );
    for ( int n = 0; n < f->hinge_count; ++n )
    {
        plate_hinge h = { .constraint = n };
        plate_shape* shape = shapes + plate->hinge_count;
        const int32_t* corner = plate_corners( f, &h );
        const int32_t side[2] = { find_half_edge( &edges, f, corner[0], corner[1] ),
                                  find_half_edge( &edges, f, corner[1], corner[0] ) };
        // back to back, or without a height: the edge is open
        if ( side[0] >= 0 && side[1] >= 0 && corner[2] != corner[3] && plate_measure_hinge( f, &h, shape ) )
        {
            set_row( &h, shape );
            for ( int s = 0; s < 2; ++s )
            {
                h.triangle[s] = side[s] / 3;
                plate->triangle_hinge[side[s] / 3][side[s] % 3] = plate->hinge_count;
            }
            plate->hinges[plate->hinge_count++] = h;
        }
    }
    return true;
}

// Hinge across the edge between two corners of a triangle.
static int32_t hinge_across( const wisp_plate* plate, const wisp_fabric* f, int32_t triangle, int32_t from )
{
    const int32_t* t = f->triangles + 3 * (size_t)triangle;
    const int corner = t[0] == from ? 0 : ( t[1] == from ? 1 : 2 );
    return plate->triangle_hinge[triangle][corner];
}

void plate_list_stencil( const wisp_plate* plate, const wisp_fabric* f, int32_t hinge,
                         int32_t stencil[PLATE_STENCIL] )
{
    const plate_hinge* h = plate->hinges + hinge;
    const int32_t* corner = plate_corners( f, h );
    stencil[0] = hinge;
    stencil[1] = hinge_across( plate, f, h->triangle[0], corner[1] );
    stencil[2] = hinge_across( plate, f, h->triangle[0], corner[2] );
    stencil[3] = hinge_across( plate, f, h->triangle[1], corner[0] );
    stencil[4] = hinge_across( plate, f, h->triangle[1], corner[3] );
}

// ---- how two triangles share a turn ----

// The point that is `height` to the right of the way from a to b, at the share `foot` of it.
static vec2d place_right( vec2d a, vec2d b, double foot, double height )
{
    const double x = b.x - a.x, y = b.y - a.y, per_length = 1.0 / sqrt( x * x + y * y );
    return ( vec2d ){ a.x + foot * x + height * y * per_length, a.y + foot * y - height * x * per_length };
}

typedef struct hinge_list
{
    const wisp_plate* plate;
    const wisp_fabric* fabric;
    const plate_shape* shapes; // of the hinges
} hinge_list;

// J of a hinge for the three quadratic surfaces. @param at its corners in the plane
static void add_monomials( const plate_hinge* h, const vec2d at[PLATE_CORNERS], double out[MONOMIALS] )
{
    for ( int k = 0; k < PLATE_CORNERS; ++k )
    {
        out[0] += (double)h->row[k] * 0.5 * at[k].x * at[k].x;
        out[1] += (double)h->row[k] * 0.5 * at[k].y * at[k].y;
        out[2] += (double)h->row[k] * sqrt( 0.5 ) * at[k].x * at[k].y;
    }
}

// J of a hinge next to this one, unfolded into its plane. @param from, to of the edge, so that the far triangle is to the right
static void unfold_stencil( const hinge_list* list, int32_t hinge, int32_t from_slot, vec2d from, vec2d to,
                            vec2d near, double out[MONOMIALS] )
{
    const plate_hinge* h = list->plate->hinges + hinge;
    const plate_shape* shape = list->shapes + hinge;
    const bool same = plate_corners( list->fabric, h )[0] == from_slot; // then `near` is the corner k, the far one l
    vec2d at[PLATE_CORNERS];
    at[0] = same ? from : to;
    at[1] = same ? to : from;
    const int far = same ? 1 : 0;
    at[2 + far] = same ? place_right( from, to, shape->foot[1], shape->height[1] )
                       : place_right( from, to, 1.0 - shape->foot[0], shape->height[0] );
    at[2 + ( 1 - far )] = near;
    add_monomials( h, at, out );
}

// Turn of side 0 and of the stencil for quadratic surfaces in the plane of a hinge, the middle of its edge at the origin.
static void measure_quadratics( const hinge_list* list, int32_t hinge, double turn[MONOMIALS],
                                double jump[PLATE_STENCIL][MONOMIALS] )
{
    const plate_hinge* h = list->plate->hinges + hinge;
    const plate_shape* shape = list->shapes + hinge;
    const int32_t* corner = plate_corners( list->fabric, h );
    const double half = 0.5 * shape->length;
    const vec2d i = { -half, 0.0 }, j = { half, 0.0 };
    const vec2d k = { ( 2.0 * shape->foot[0] - 1.0 ) * half, shape->height[0] };
    const vec2d l = { ( 2.0 * shape->foot[1] - 1.0 ) * half, -shape->height[1] };
    const vec2d own[PLATE_CORNERS] = { i, j, k, l };
    memset( jump, 0, PLATE_STENCIL * sizeof( jump[0] ) );
    add_monomials( h, own, jump[0] );
    const struct
    {
        int32_t slot;
        vec2d from, to, near;
    } next[PLATE_STENCIL - 1] = {
        { corner[1], j, k, i }, { corner[2], k, i, j }, { corner[0], i, l, j }, { corner[3], l, j, i }
    };
    int32_t stencil[PLATE_STENCIL];
    plate_list_stencil( list->plate, list->fabric, hinge, stencil );
    for ( int n = 0; n < PLATE_STENCIL - 1; ++n )
    {
        if ( stencil[n + 1] >= 0 )
        {
            unfold_stencil( list, stencil[n + 1], next[n].slot, next[n].from, next[n].to, next[n].near, jump[n + 1] );
        }
    }
    // the gradient at the middle of the edge is 0, that of the flat triangle leads from the edge to the corner
    turn[0] = ( 0.5 * half * half - 0.5 * k.x * k.x ) / k.y;
    turn[1] = -0.5 * k.y;
    turn[2] = -sqrt( 0.5 ) * k.x;
}

// Solve a symmetric system in place. @return by pivots of a matrix that is positive definite
static void solve_monomials( double a[MONOMIALS][MONOMIALS], double b[MONOMIALS] )
{
    for ( int p = 0; p < MONOMIALS; ++p )
    {
        for ( int r = p + 1; r < MONOMIALS; ++r )
        {
            const double factor = a[r][p] / a[p][p];
            for ( int c = p; c < MONOMIALS; ++c )
            {
                a[r][c] -= factor * a[p][c];
            }
            b[r] -= factor * b[p];
        }
    }
    for ( int p = MONOMIALS - 1; p >= 0; --p )
    {
        for ( int c = p + 1; c < MONOMIALS; ++c )
        {
            b[p] -= a[p][c] * b[c];
        }
        b[p] /= a[p][p];
    }
}

// The shares nearest to one by height, which suits equal triangles, that are right for every quadratic surface.
static void fit_shares( const hinge_list* list, int32_t hinge, float fitted[PLATE_STENCIL] )
{
    const double by_height = plate_share_by_height( list->shapes + hinge );
    double turn[MONOMIALS], jump[PLATE_STENCIL][MONOMIALS], gram[MONOMIALS][MONOMIALS] = { { 0.0 } }, trace = 0.0;
    measure_quadratics( list, hinge, turn, jump );
    for ( int m = 0; m < MONOMIALS; ++m )
    {
        turn[m] -= by_height * jump[0][m];
        for ( int n = 0; n < MONOMIALS; ++n )
        {
            for ( int s = 0; s < PLATE_STENCIL; ++s )
            {
                gram[m][n] += jump[s][m] * jump[s][n];
            }
        }
        trace += gram[m][m];
    }
    for ( int m = 0; m < MONOMIALS; ++m )
    {
        gram[m][m] += REGULARISATION * trace;
    }
    solve_monomials( gram, turn );
    for ( int s = 0; s < PLATE_STENCIL; ++s )
    {
        const double more = jump[s][0] * turn[0] + jump[s][1] * turn[1] + jump[s][2] * turn[2];
        fitted[s] = s == 0 ? (float)( by_height + more ) : ( fabs( more ) >= LEAST_SHARE ? (float)more : 0.0f );
    }
}

bool plate_cook_hinges( wisp_plate* plate, const wisp_fabric* f, fabric_pool* scratch )
{
    plate_shape* shapes = fabric_pool_push( scratch, (size_t)f->hinge_count, sizeof( plate_shape ) );
    const bool done = shapes != NULL && connect_hinges( plate, f, shapes, scratch );
    const hinge_list list = { plate, f, shapes };
    for ( int32_t h = 0; h < plate->hinge_count && done; ++h )
    {
        fit_shares( &list, h, plate->hinges[h].fitted );
    }
    return done;
}
