// A flat piece of any outline: vertices along the border, well spaced ones at random inside, exactly the given
// number, and a Delaunay triangulation of them. Only + - * /, square roots and the engine's counter-based random
// numbers, so that the same outline gives the same bits on every machine.
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>

#include "delaunay.h"
#include "wisp/module/definition.h"
#include "wisp/module/random.h"

enum
{
    RANDOM_STREAM = 0x64617274, // any number that no other stream of the program uses
    SPACING_STEPS = 100,        // halvings, more than a double has digits
    THROWS_EACH = 4,            // darts per missing vertex before the distance between them shrinks
    THROWS_MORE = 64,
    NOBODY = -1,
};

static const char NAME[] = "mesh outline";
static const float FARTHEST = 1e6f; // m, the same limit as for a groom
static const float MIN_DENSITY = 1.0f, MAX_DENSITY = 16.0f;
static const double MAX_SLENDER = 1000.0;    // of box to area, and of the box's sides
static const double EQUILATERAL = 0.4330127; // area of the triangle whose sides are 1
static const double SHRINK = 0.96;           // of the minimum distance of darts
static const double NO_ROOM = 1e-6;          // of the spacing: closer vertices are useless
static const double BORDER_DISTANCE = 0.5; // minimum distance of darts from the border, relative to that from others

// Coordinates 0 and 1 are the mesh's z and x, so that counter-clockwise in the plane is counter-clockwise seen from
// above.
typedef struct flat
{
    const wisp_mesh_corner* corners;
    int corner_count, total, border_count;
    int count;        // points so far
    io_memory memory; // of all arrays
    double* points;   // [total][2]
    double lower[2], upper[2], area;
    double spacing;       // m, of a triangulation with this number of vertices
    int long_axis;        // of the box
    double cell;          // m, at least the spacing
    int cells[2];         // along the coordinates
    int32_t* first;       // [cells[0] * cells[1]] a point in the cell
    int32_t* next;        // [total] another point in the same cell
    int32_t* strip_from;  // [cells[long_axis] + 1] where a strip of cells across the long axis begins in strip_edges
    int32_t* strip_edges; // the open edges that a strip touches, by the point where they begin
} flat;

static const double* at( const flat* f, int i )
{
    return f->points + 2 * (size_t)i;
}

// ---- the outline -----------------------------------------------------------------------------------------------

static void corner_place( const flat* f, int i, double p[2] )
{
    const wisp_mesh_corner* corner = &f->corners[i < f->corner_count ? i : 0];
    p[0] = (double)corner->z;
    p[1] = (double)corner->x;
}

static wisp_status check_corners( const flat* f, wisp_error* error )
{
    for ( int i = 0; i < f->corner_count; ++i )
    {
        const wisp_mesh_corner* c = &f->corners[i];
        // Written so that NaN fails.
        if ( !( fabsf( c->x ) <= FARTHEST && fabsf( c->z ) <= FARTHEST ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: corner %d: got (%g, %g), expected coordinates within %g m",
                              NAME, i, (double)c->x, (double)c->z, (double)FARTHEST );
        }
        if ( !( c->density >= MIN_DENSITY && c->density <= MAX_DENSITY ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: density of corner %d: got %g, expected %g .. %g", NAME, i,
                              (double)c->density, (double)MIN_DENSITY, (double)MAX_DENSITY );
        }
    }
    return WISP_OK;
}

static wisp_status measure( flat* f, wisp_error* error )
{
    f->lower[0] = f->lower[1] = HUGE_VAL;
    f->upper[0] = f->upper[1] = -HUGE_VAL;
    for ( int i = 0; i < f->corner_count; ++i )
    {
        double p[2], q[2];
        corner_place( f, i, p );
        corner_place( f, i + 1, q );
        f->area += 0.5 * ( p[0] * q[1] - p[1] * q[0] );
        for ( int axis = 0; axis < 2; ++axis )
        {
            f->lower[axis] = fmin( f->lower[axis], p[axis] );
            f->upper[axis] = fmax( f->upper[axis], p[axis] );
        }
    }
    double size[] = { f->upper[0] - f->lower[0], f->upper[1] - f->lower[1] };
    f->long_axis = size[1] > size[0];
    double longer = size[f->long_axis], shorter = size[1 - f->long_axis];
    if ( !( longer <= MAX_SLENDER * shorter ) || !( fabs( f->area ) * MAX_SLENDER >= longer * shorter ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: an area of %g m^2 in %g by %g m is too slender", NAME,
                          fabs( f->area ), size[1], size[0] );
    }
    return WISP_OK;
}

// Whether the outline can be filled follows from the corners alone, with their indices for the message.
static wisp_status check_outline( const flat* f, wisp_error* error )
{
    const int count = f->corner_count;
    io_memory scratch = { 0 };
    double* places = io_get( &scratch, (size_t)count * 2 * sizeof *places );
    delaunay_point* lattice = io_get( &scratch, (size_t)count * sizeof *lattice );
    int32_t* triangles = io_get( &scratch, (size_t)delaunay_triangle_count( count, count ) * 3 * sizeof *triangles );
    wisp_status status =
        scratch.is_short ? wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory to check %d corners", NAME, count )
                         : WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        corner_place( f, i, places + 2 * (size_t)i );
    }
    status = status == WISP_OK ? delaunay_snap( places, count, lattice, NAME, error ) : status;
    status = status == WISP_OK ? delaunay_fill( lattice, count, count, triangles, NAME, error ) : status;
    io_release( &scratch );
    return status;
}

// ---- the border ------------------------------------------------------------------------------------------------

// Number of pieces of the edge behind corner i, none longer than the spacing. Not yet an int: a tiny spacing gives
// many.
static double edge_primitives( const flat* f, int i, double spacing )
{
    double p[2], q[2];
    corner_place( f, i, p );
    corner_place( f, i + 1, q );
    double x = q[0] - p[0], y = q[1] - p[1];
    return fmax( 1.0, ceil( sqrt( x * x + y * y ) * (double)f->corners[i].density / spacing ) );
}

static double border_primitives( const flat* f, double spacing )
{
    double sum = 0.0;
    for ( int i = 0; i < f->corner_count; ++i )
    {
        sum += edge_primitives( f, i, spacing );
    }
    return sum;
}

// Whether the border would take too many vertices, or equilateral triangles of this size would need too many.
static bool is_too_fine( const flat* f, double spacing )
{
    double open_edge = border_primitives( f, spacing );
    return open_edge > f->total || ( 2.0 * f->total - open_edge - 2.0 ) * EQUILATERAL * spacing * spacing < f->area;
}

// At the longest spacing the corners are the whole border and one triangle is enough.
static void choose_spacing( flat* f )
{
    double lower = 0.0;
    double upper = 4.0 * (double)MAX_DENSITY * ( f->upper[0] - f->lower[0] + f->upper[1] - f->lower[1] );
    for ( int i = 0; i < SPACING_STEPS; ++i )
    {
        double middle = 0.5 * ( lower + upper );
        bool too_fine = is_too_fine( f, middle );
        lower = too_fine ? middle : lower;
        upper = too_fine ? upper : middle;
    }
    f->spacing = upper;
    f->border_count = (int)border_primitives( f, upper );
}

static void put_border( flat* f )
{
    for ( int i = 0; i < f->corner_count; ++i )
    {
        double p[2], q[2];
        corner_place( f, i, p );
        corner_place( f, i + 1, q );
        int primitives = (int)edge_primitives( f, i, f->spacing );
        for ( int k = 0; k < primitives; ++k, ++f->count )
        {
            double part = (double)k / primitives;
            f->points[2 * (size_t)f->count] = p[0] + ( q[0] - p[0] ) * part;
            f->points[2 * (size_t)f->count + 1] = p[1] + ( q[1] - p[1] ) * part;
        }
    }
}

// ---- cells and strips ------------------------------------------------------------------------------------------

static int cell_along( const flat* f, double place, int axis )
{
    int cell = (int)( ( place - f->lower[axis] ) / f->cell );
    return cell < 0 ? 0 : cell < f->cells[axis] ? cell : f->cells[axis] - 1;
}

static void put_into_cell( flat* f, int i )
{
    const double* p = at( f, i );
    size_t cell = (size_t)cell_along( f, p[0], 0 ) * (size_t)f->cells[1] + (size_t)cell_along( f, p[1], 1 );
    f->next[i] = f->first[cell];
    f->first[cell] = i;
}

static void edge_strips( const flat* f, int edge, int* lower, int* upper )
{
    int axis = f->long_axis;
    int p = cell_along( f, at( f, edge )[axis], axis );
    int q = cell_along( f, at( f, edge + 1 < f->border_count ? edge + 1 : 0 )[axis], axis );
    *lower = p < q ? p : q;
    *upper = p < q ? q : p;
}

// Counted, summed, and filled from behind, so that edges are in order within a strip.
static wisp_status put_strips( flat* f, wisp_error* error )
{
    int strips = f->cells[f->long_axis], lower, upper;
    for ( int edge = 0; edge < f->border_count; ++edge )
    {
        edge_strips( f, edge, &lower, &upper );
        for ( int s = lower; s <= upper; ++s )
        {
            ++f->strip_from[s];
        }
    }
    for ( int s = 1; s <= strips; ++s )
    {
        f->strip_from[s] += f->strip_from[s - 1];
    }
    f->strip_edges = io_get( &f->memory, (size_t)f->strip_from[strips] * sizeof *f->strip_edges );
    if ( f->strip_edges == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d open edges", NAME, f->border_count );
    }
    for ( int edge = f->border_count - 1; edge >= 0; --edge )
    {
        edge_strips( f, edge, &lower, &upper );
        for ( int s = lower; s <= upper; ++s )
        {
            f->strip_edges[--f->strip_from[s]] = edge;
        }
    }
    return WISP_OK;
}

// Cells are so large that they are at most a few times as many as the vertices, also in an outline that fills a small
// part of its box.
static wisp_status make_cells( flat* f, wisp_error* error )
{
    double size[] = { f->upper[0] - f->lower[0], f->upper[1] - f->lower[1] };
    f->cell = fmax( f->spacing, sqrt( size[0] * size[1] / f->total ) );
    for ( int axis = 0; axis < 2; ++axis )
    {
        f->cells[axis] = (int)( size[axis] / f->cell ) + 1;
    }
    size_t cells = (size_t)f->cells[0] * (size_t)f->cells[1];
    f->first = io_get( &f->memory, cells * sizeof *f->first );
    f->next = io_get( &f->memory, (size_t)f->total * sizeof *f->next );
    f->strip_from = io_get( &f->memory, ( (size_t)f->cells[f->long_axis] + 1 ) * sizeof *f->strip_from );
    if ( f->memory.is_short )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory to spread %d vertices", NAME, f->total );
    }
    for ( size_t c = 0; c < cells; ++c )
    {
        f->first[c] = NOBODY;
    }
    for ( int i = 0; i < f->border_count; ++i )
    {
        put_into_cell( f, i );
    }
    return put_strips( f, error );
}

// ---- darts -----------------------------------------------------------------------------------------------------

static bool is_far_from_points( const flat* f, const double p[2], double distance )
{
    int row = cell_along( f, p[0], 0 ), column = cell_along( f, p[1], 1 );
    for ( int i = row > 0 ? row - 1 : 0; i <= row + 1 && i < f->cells[0]; ++i )
    {
        for ( int j = column > 0 ? column - 1 : 0; j <= column + 1 && j < f->cells[1]; ++j )
        {
            for ( int32_t k = f->first[(size_t)i * (size_t)f->cells[1] + (size_t)j]; k != NOBODY; k = f->next[k] )
            {
                double x = at( f, k )[0] - p[0], y = at( f, k )[1] - p[1];
                if ( x * x + y * y < distance * distance )
                {
                    return false;
                }
            }
        }
    }
    return true;
}

// A ray along the short axis crosses the border an odd number of times: all its edges are in the point's strip.
static bool is_inside( const flat* f, const double p[2] )
{
    int axis = f->long_axis, other = 1 - axis, strip = cell_along( f, p[axis], axis );
    bool inside = false;
    for ( int k = f->strip_from[strip]; k < f->strip_from[strip + 1]; ++k )
    {
        int edge = f->strip_edges[k];
        const double *a = at( f, edge ), *b = at( f, edge + 1 < f->border_count ? edge + 1 : 0 );
        if ( ( a[axis] > p[axis] ) != ( b[axis] > p[axis] ) )
        {
            double part = ( p[axis] - a[axis] ) / ( b[axis] - a[axis] );
            inside = inside != ( a[other] + part * ( b[other] - a[other] ) > p[other] );
        }
    }
    return inside;
}

static double squared_distance_to_edge( const double a[2], const double b[2], const double p[2] )
{
    double along[] = { b[0] - a[0], b[1] - a[1] }, to[] = { p[0] - a[0], p[1] - a[1] };
    double part = ( to[0] * along[0] + to[1] * along[1] ) / ( along[0] * along[0] + along[1] * along[1] );
    part = fmin( fmax( part, 0.0 ), 1.0 );
    double x = to[0] - part * along[0], y = to[1] - part * along[1];
    return x * x + y * y;
}

static bool is_far_from_border( const flat* f, const double p[2], double distance )
{
    int axis = f->long_axis, strip = cell_along( f, p[axis], axis );
    int from = strip > 0 ? strip - 1 : 0, to = strip + 2 < f->cells[axis] ? strip + 2 : f->cells[axis];
    for ( int k = f->strip_from[from]; k < f->strip_from[to]; ++k )
    {
        int edge = f->strip_edges[k];
        const double *a = at( f, edge ), *b = at( f, edge + 1 < f->border_count ? edge + 1 : 0 );
        if ( squared_distance_to_edge( a, b, p ) < distance * distance )
        {
            return false;
        }
    }
    return true;
}

// Darts too close to another vertex or the border are discarded.
static void throw_darts( flat* f, wisp_random_key key, double distance )
{
    double size[] = { f->upper[0] - f->lower[0], f->upper[1] - f->lower[1] };
    double throws = THROWS_EACH * (double)( f->total - f->border_count ) + THROWS_MORE;
    uint64_t count = (uint64_t)( throws * size[0] * size[1] / f->area );
    for ( uint64_t i = 0; i < count && f->count < f->total; ++i )
    {
        double* p = f->points + 2 * (size_t)f->count;
        for ( uint32_t axis = 0; axis < 2; ++axis )
        {
            p[axis] = f->lower[axis] + size[axis] * wisp_random_unit( key, (uint32_t)i, axis, (uint32_t)( i >> 32 ) );
        }
        if ( is_far_from_points( f, p, distance ) && is_inside( f, p ) &&
             is_far_from_border( f, p, BORDER_DISTANCE * distance ) )
        {
            put_into_cell( f, f->count++ );
        }
    }
}

// The distance starts at that of a perfect pattern, and shrinks until the last vertex is placed: the first ones are
// far apart, and the later ones fill the gaps between them (McCool and Fiume 1992).
static wisp_status put_inside( flat* f, uint64_t seed, wisp_error* error )
{
    uint64_t round = 0;
    for ( double distance = f->spacing; f->count < f->total; distance *= SHRINK, ++round )
    {
        if ( distance < NO_ROOM * f->spacing )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: no room for %d vertices", NAME, f->total );
        }
        throw_darts( f, wisp_random_make_key( seed, RANDOM_STREAM, round ), distance );
    }
    return WISP_OK;
}

// ---- the mesh --------------------------------------------------------------------------------------------------

typedef struct placed
{
    uint64_t along;
    wisp_vec3 point;
    delaunay_point lattice;
} placed;

static int compare_placed( const void* left, const void* right )
{
    const placed *a = left, *b = right;
    return a->along < b->along ? -1 : a->along > b->along;
}

// Vertices are floats, and the lattice is made from those, so that the triangles are Delaunay for the stored mesh.
// The inside is numbered along Hilbert's curve: neighbours in the plane are near in memory.
static wisp_status put_vertices( flat* f, wisp_mesh* out, delaunay_point* lattice, wisp_error* error )
{
    placed* vertices = io_get( &f->memory, (size_t)f->total * sizeof *vertices );
    if ( vertices == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory to number %d vertices", NAME, f->total );
    }
    for ( int i = 0; i < f->total; ++i )
    {
        out->points[i] = ( wisp_vec3 ){ .x = (float)at( f, i )[1], .z = (float)at( f, i )[0] };
    }
    // In a separate loop: gcc 12 removes a rounding to float and back to double when it vectorises them in one loop.
    for ( int i = 0; i < f->total; ++i )
    {
        f->points[2 * (size_t)i] = (double)out->points[i].z;
        f->points[2 * (size_t)i + 1] = (double)out->points[i].x;
    }
    WISP_TRY( delaunay_snap( f->points, f->total, lattice, NAME, error ) );
    for ( int i = 0; i < f->total; ++i )
    {
        vertices[i] = ( placed ){ delaunay_curve( lattice[i] ), out->points[i], lattice[i] };
    }
    qsort( vertices + f->border_count, (size_t)( f->total - f->border_count ), sizeof *vertices, compare_placed );
    for ( int i = 0; i < f->total; ++i )
    {
        out->points[i] = vertices[i].point;
        lattice[i] = vertices[i].lattice;
    }
    return WISP_OK;
}

static wisp_status triangulate( flat* f, wisp_mesh* out, wisp_error* error )
{
    delaunay_point* lattice = io_get( &f->memory, (size_t)f->total * sizeof *lattice );
    WISP_TRY( mesh_allocate( out, f->total, delaunay_triangle_count( f->total, f->border_count ), NAME, error ) );
    if ( lattice == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory to join %d vertices", NAME, f->total );
    }
    WISP_TRY( put_vertices( f, out, lattice, error ) );
    return delaunay_fill( lattice, f->total, f->border_count, out->triangles, NAME, error );
}

static wisp_status fill( flat* f, uint64_t seed, wisp_mesh* out, wisp_error* error )
{
    choose_spacing( f );
    f->points = io_get( &f->memory, (size_t)f->total * 2 * sizeof *f->points );
    if ( f->points == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d vertices", NAME, f->total );
    }
    put_border( f );
    WISP_TRY( make_cells( f, error ) );
    WISP_TRY( put_inside( f, seed, error ) );
    return triangulate( f, out, error );
}

wisp_status wisp_mesh_generate_flat( const wisp_mesh_corner* corners, int corner_count, int vertex_count,
                                     uint64_t seed, wisp_mesh* out, wisp_error* error )
{
    *out = ( wisp_mesh ){ 0 };
    if ( corner_count < 3 || vertex_count < corner_count || vertex_count > WISP_MESH_VERTEX_CAP )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: %d vertices, %d of them corners, which must be at least 3 and at most all, which must "
                          "be at most %d",
                          NAME, vertex_count, corner_count, WISP_MESH_VERTEX_CAP );
    }
    flat f = { .corners = corners, .corner_count = corner_count, .total = vertex_count };
    WISP_TRY( check_corners( &f, error ) );
    WISP_TRY( measure( &f, error ) );
    WISP_TRY( check_outline( &f, error ) );
    const wisp_status status = fill( &f, seed, out, error );
    io_release( &f.memory );
    if ( status != WISP_OK )
    {
        wisp_mesh_release( out );
    }
    return status;
}
