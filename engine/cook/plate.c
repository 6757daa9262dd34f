// Bending of thin plates on a mesh: which vertices act on which, and how strongly. Equations: wisp/module/plate.h.
#include "wisp/module/plate.h"

#include "fabric_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    STENCIL = 5,       // hinges that share a turn: the hinge itself, two of each triangle
    PATCH = 12,        // vertices of a triangle, its neighbours and theirs
    CORNERS = 4,       // of a hinge
    MONOMIALS = 3,     // of a quadratic surface: x x / 2, y y / 2, x y
    HELD = 1,          // of a hinge: the triangle of side 0 is rigid; 2: that of side 1
};

// Shares below this are dropped. They are rounding errors on regular meshes, whose rows become half as long.
static const double LEAST_SHARE = 1e-5;
// Of the sum of squares that a fit is solved with: where hinges lie badly for a fit, the share stays near that by height.
static const double REGULARISATION = 1e-6;
// A triangle lower than this part of its edge has no direction, so its edges are open.
static const double LEAST_HEIGHT = 1e-5;

// A hinge between side 0, the triangle (i, j, k), and side 1, the triangle (j, i, l).
typedef struct plate_hinge
{
    int32_t corner[CORNERS];      // slots i, j, k, l
    int32_t triangle[2];
    int32_t stencil[STENCIL];     // hinges: itself, across (j, k), (k, i), (i, l), (l, j); -1: none
    double row[CORNERS];          // J = sum of row x, 1/m
    double length;                // m
    double foot[2], height[2];    // of an opposite corner over the edge: share of the edge from i; m
    double fitted[STENCIL];       // turn of side 0 from J of the stencil, without pins
    double share[STENCIL];        // the same next to pins
} plate_hinge;

struct wisp_plate
{
    wisp_plate_rows rows;
    int32_t* slot_row;              // [vertex_count]
    plate_hinge* hinges;            // [hinge_count]
    int hinge_count;
    int32_t ( *triangle_hinge )[3]; // [triangle_count] across the edge from corner k to the next; -1: open
    float ( *weight )[8];           // [entry]
    uint8_t* pinned;                // [vertex_count]
    float max_rate;
    fabric_pool pool;
};

typedef struct vec2d
{
    double x, y;
} vec2d;

typedef struct vec3d
{
    double x, y, z;
} vec3d;

static vec3d edge_of( const wisp_fabric* f, int32_t from, int32_t to )
{
    const wisp_vec3 a = f->rest[from], b = f->rest[to];
    return ( vec3d ){ (double)b.x - (double)a.x, (double)b.y - (double)a.y, (double)b.z - (double)a.z };
}

static double dot( vec3d a, vec3d b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static double area_of( const wisp_fabric* f, const int32_t* t )
{
    const vec3d a = edge_of( f, t[0], t[1] ), b = edge_of( f, t[0], t[2] );
    const vec3d n = { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
    return 0.5 * sqrt( dot( n, n ) );
}

// ---- hinges ----

// Place of an opposite corner relative to its edge. @return whether the triangle has a height
static bool measure_side( const wisp_fabric* f, plate_hinge* h, int side )
{
    const int32_t opposite = h->corner[2 + side], t[3] = { h->corner[0], h->corner[1], opposite };
    const vec3d e = edge_of( f, h->corner[0], h->corner[1] ), d = edge_of( f, h->corner[0], opposite );
    h->length = sqrt( dot( e, e ) );
    if ( !( h->length > 0.0 ) )
    {
        return false;
    }
    h->foot[side] = dot( d, e ) / dot( e, e );
    h->height[side] = 2.0 * area_of( f, t ) / h->length;
    return h->height[side] > LEAST_HEIGHT * h->length;
}

// J is the jump of the gradients of the two triangles along the normal of the edge (Bergou et al. 2006, eq. 4).
static void set_row( plate_hinge* h )
{
    for ( int side = 0; side < 2; ++side )
    {
        const double per_height = 1.0 / h->height[side];
        h->row[0] += ( 1.0 - h->foot[side] ) * per_height;
        h->row[1] += h->foot[side] * per_height;
        h->row[2 + side] = -per_height;
    }
}

// A triangle as seen along one of its edges.
typedef struct half_edge
{
    int32_t from, to, triangle, corner;
} half_edge;

static int compare_half_edges( const void* first, const void* second )
{
    const half_edge *a = first, *b = second;
    return a->from != b->from ? ( a->from < b->from ? -1 : 1 ) : ( a->to > b->to ) - ( a->to < b->to );
}

static const half_edge* find_half_edge( const half_edge* edges, size_t count, int32_t from, int32_t to )
{
    const half_edge key = { .from = from, .to = to };
    return bsearch( &key, edges, count, sizeof( key ), compare_half_edges );
}

static half_edge* list_half_edges( const wisp_fabric* f, fabric_pool* scratch )
{
    const size_t count = 3 * (size_t)f->triangle_count;
    half_edge* edges = fabric_pool_push( scratch, count, sizeof( *edges ) );
    for ( size_t i = 0; i < count && edges != NULL; ++i )
    {
        const int32_t* t = f->triangles + i / 3 * 3;
        edges[i] = ( half_edge ){ t[i % 3], t[( i + 1 ) % 3], (int32_t)( i / 3 ), (int32_t)( i % 3 ) };
    }
    if ( edges != NULL )
    {
        qsort( edges, count, sizeof( *edges ), compare_half_edges );
    }
    return edges;
}

static bool connect_hinges( wisp_plate* plate, const wisp_fabric* f, fabric_pool* scratch )
{
    const half_edge* edges = list_half_edges( f, scratch );
    if ( edges == NULL )
    {
        return false;
    }
    const size_t count = 3 * (size_t)f->triangle_count;
    memset( plate->triangle_hinge, -1, (size_t)f->triangle_count * sizeof( plate->triangle_hinge[0] ) );
    for ( int n = 0; n < f->hinge_count; ++n )
    {
        plate_hinge h = { .stencil = { 0 } };
        memcpy( h.corner, f->hinges + CORNERS * (size_t)n, sizeof( h.corner ) );
        const half_edge* side[2] = { find_half_edge( edges, count, h.corner[0], h.corner[1] ),
                                     find_half_edge( edges, count, h.corner[1], h.corner[0] ) };
        // back to back, or without a height: the edge is open
        const bool measured = side[0] != NULL && side[1] != NULL && h.corner[2] != h.corner[3] &&
                              measure_side( f, &h, 0 ) && measure_side( f, &h, 1 );
        if ( measured )
        {
            set_row( &h );
            for ( int s = 0; s < 2; ++s )
            {
                h.triangle[s] = side[s]->triangle;
                plate->triangle_hinge[side[s]->triangle][side[s]->corner] = plate->hinge_count;
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

static void list_stencil( const wisp_plate* plate, const wisp_fabric* f, int32_t hinge )
{
    plate_hinge* h = plate->hinges + hinge;
    h->stencil[0] = hinge;
    h->stencil[1] = hinge_across( plate, f, h->triangle[0], h->corner[1] );
    h->stencil[2] = hinge_across( plate, f, h->triangle[0], h->corner[2] );
    h->stencil[3] = hinge_across( plate, f, h->triangle[1], h->corner[0] );
    h->stencil[4] = hinge_across( plate, f, h->triangle[1], h->corner[3] );
}

// ---- how two triangles share a turn ----

// The point that is `height` to the right of the way from a to b, at the share `foot` of it.
static vec2d place_right( vec2d a, vec2d b, double foot, double height )
{
    const double x = b.x - a.x, y = b.y - a.y, per_length = 1.0 / sqrt( x * x + y * y );
    return ( vec2d ){ a.x + foot * x + height * y * per_length, a.y + foot * y - height * x * per_length };
}

// J of a hinge for the three quadratic surfaces. @param at its corners in the plane
static void add_monomials( const plate_hinge* h, const vec2d at[CORNERS], double out[MONOMIALS] )
{
    for ( int k = 0; k < CORNERS; ++k )
    {
        out[0] += h->row[k] * 0.5 * at[k].x * at[k].x;
        out[1] += h->row[k] * 0.5 * at[k].y * at[k].y;
        out[2] += h->row[k] * at[k].x * at[k].y;
    }
}

// J of a hinge next to this one, unfolded into its plane. @param from, to of the edge, so that the far triangle is to the right
static void unfold( const plate_hinge* h, int32_t from_slot, vec2d from, vec2d to, vec2d near, double out[MONOMIALS] )
{
    const bool same = h->corner[0] == from_slot; // then `near` is the corner k, the far one l
    vec2d at[CORNERS];
    at[0] = same ? from : to;
    at[1] = same ? to : from;
    const int far = same ? 1 : 0;
    at[2 + far] = same ? place_right( from, to, h->foot[1], h->height[1] )
                       : place_right( from, to, 1.0 - h->foot[0], h->height[0] );
    at[2 + ( 1 - far )] = near;
    add_monomials( h, at, out );
}

// Turn of side 0 and of the stencil for quadratic surfaces in the plane of a hinge, the middle of its edge at the origin.
static void measure_quadratics( const wisp_plate* plate, const plate_hinge* h, double turn[MONOMIALS],
                                double jump[STENCIL][MONOMIALS] )
{
    const double half = 0.5 * h->length;
    const vec2d i = { -half, 0.0 }, j = { half, 0.0 };
    const vec2d k = { ( 2.0 * h->foot[0] - 1.0 ) * half, h->height[0] };
    const vec2d l = { ( 2.0 * h->foot[1] - 1.0 ) * half, -h->height[1] };
    const vec2d own[CORNERS] = { i, j, k, l };
    memset( jump, 0, STENCIL * sizeof( jump[0] ) );
    add_monomials( h, own, jump[0] );
    const struct
    {
        int32_t slot;
        vec2d from, to, near;
    } next[STENCIL - 1] = { { h->corner[1], j, k, i },
                            { h->corner[2], k, i, j },
                            { h->corner[0], i, l, j },
                            { h->corner[3], l, j, i } };
    for ( int n = 0; n < STENCIL - 1; ++n )
    {
        if ( h->stencil[n + 1] >= 0 )
        {
            unfold( plate->hinges + h->stencil[n + 1], next[n].slot, next[n].from, next[n].to, next[n].near,
                    jump[n + 1] );
        }
    }
    // the gradient at the middle of the edge is 0, that of the flat triangle leads from the edge to the corner
    turn[0] = ( 0.5 * half * half - 0.5 * k.x * k.x ) / k.y;
    turn[1] = -0.5 * k.y;
    turn[2] = -k.x;
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
static void fit_shares( const wisp_plate* plate, plate_hinge* h )
{
    double turn[MONOMIALS], jump[STENCIL][MONOMIALS], gram[MONOMIALS][MONOMIALS] = { { 0.0 } }, trace = 0.0;
    measure_quadratics( plate, h, turn, jump );
    h->fitted[0] = h->height[0] / ( h->height[0] + h->height[1] );
    for ( int m = 0; m < MONOMIALS; ++m )
    {
        turn[m] -= h->fitted[0] * jump[0][m];
        for ( int n = 0; n < MONOMIALS; ++n )
        {
            for ( int s = 0; s < STENCIL; ++s )
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
    for ( int s = 0; s < STENCIL; ++s )
    {
        const double more = jump[s][0] * turn[0] + jump[s][1] * turn[1] + jump[s][2] * turn[2];
        h->fitted[s] += s == 0 || fabs( more ) >= LEAST_SHARE ? more : 0.0;
    }
}

// ---- patches ----

// What acts on the curvature of one triangle: its turns as linear combinations of the vertices around.
typedef struct patch
{
    int count;
    int32_t slot[PATCH];
    double turn[3][PATCH]; // 1/m
} patch;

static int patch_index( patch* p, int32_t slot )
{
    for ( int i = 0; i < p->count; ++i )
    {
        if ( p->slot[i] == slot )
        {
            return i;
        }
    }
    p->slot[p->count] = slot;
    return p->count++;
}

static void add_jump( patch* p, int edge, const plate_hinge* h, double factor )
{
    for ( int k = 0; k < CORNERS; ++k )
    {
        p->turn[edge][patch_index( p, h->corner[k] )] += factor * h->row[k];
    }
}

// @param shares of the hinges: fitted, or those next to pins
static patch patch_of( const wisp_plate* plate, int32_t triangle, bool with_pins )
{
    patch p = { .count = 0 };
    for ( int edge = 0; edge < 3; ++edge )
    {
        const int32_t hinge = plate->triangle_hinge[triangle][edge];
        if ( hinge < 0 )
        {
            continue;
        }
        const plate_hinge* h = plate->hinges + hinge;
        const bool first = h->triangle[0] == triangle;
        const double* share = with_pins ? h->share : h->fitted;
        for ( int s = 0; s < STENCIL; ++s )
        {
            const double factor = first ? share[s] : ( s == 0 ? 1.0 : 0.0 ) - share[s];
            if ( h->stencil[s] >= 0 && ( s == 0 || h->fitted[s] != 0.0 ) )
            {
                add_jump( &p, edge, plate->hinges + h->stencil[s], factor );
            }
        }
    }
    return p;
}

// ---- rows ----

// Lists of the patches that a vertex is in, to merge into its row.
typedef struct patch_lists
{
    int32_t* begin;    // [vertex_count + 1]
    int32_t* triangle; // [begin[vertex_count]]
} patch_lists;

static bool list_patches( const wisp_plate* plate, const wisp_fabric* f, fabric_pool* scratch, patch_lists* out )
{
    out->begin = fabric_pool_push_zeroed( scratch, (size_t)f->vertex_count + 2, sizeof( int32_t ) );
    out->triangle = fabric_pool_push( scratch, PATCH * (size_t)f->triangle_count, sizeof( int32_t ) );
    if ( out->begin == NULL || out->triangle == NULL )
    {
        return false;
    }
    for ( int pass = 0; pass < 2; ++pass )
    {
        for ( int32_t t = 0; t < f->triangle_count; ++t )
        {
            const patch p = patch_of( plate, t, false );
            for ( int i = 0; i < p.count; ++i )
            {
                // first the counts, two places ahead; then each place moves to its end, where the next one begins
                int32_t* place = out->begin + p.slot[i] + ( pass == 0 ? 2 : 1 );
                if ( pass == 1 )
                {
                    out->triangle[*place] = t;
                }
                *place += 1;
            }
        }
        for ( int v = 0; v < f->vertex_count && pass == 0; ++v )
        {
            out->begin[v + 2] += out->begin[v + 1];
        }
    }
    return true;
}

typedef struct row_list
{
    const wisp_plate* plate;
    const patch_lists* lists;
    int32_t* mark; // [vertex_count] last row that has the slot
    int32_t* found;
} row_list;

static int compare_slots( const void* first, const void* second )
{
    const int32_t a = *(const int32_t*)first, b = *(const int32_t*)second;
    return ( a > b ) - ( a < b );
}

// Other ends of a row in ascending order. @return their number
static int merge_row( const row_list* r, int32_t slot )
{
    int count = 0;
    r->mark[slot] = slot;
    for ( int32_t at = r->lists->begin[slot]; at < r->lists->begin[slot + 1]; ++at )
    {
        const patch p = patch_of( r->plate, r->lists->triangle[at], false );
        for ( int i = 0; i < p.count; ++i )
        {
            if ( r->mark[p.slot[i]] != slot )
            {
                r->mark[p.slot[i]] = slot;
                r->found[count++] = p.slot[i];
            }
        }
    }
    qsort( r->found, (size_t)count, sizeof( int32_t ), compare_slots );
    return count;
}

// A slice has as many entries as its longest row.
static bool place_rows( wisp_plate* plate, const wisp_fabric* f, const row_list* r, fabric_pool* scratch )
{
    const int slices = plate->rows.slice_count;
    int32_t* begin = fabric_pool_push_zeroed( &plate->pool, (size_t)slices + 1, sizeof( int32_t ) );
    int32_t* row_slot = fabric_pool_push( scratch, 8 * (size_t)slices, sizeof( int32_t ) );
    if ( begin == NULL || row_slot == NULL )
    {
        return false;
    }
    memset( row_slot, -1, 8 * (size_t)slices * sizeof( int32_t ) );
    for ( int32_t v = 0; v < f->vertex_count; ++v )
    {
        row_slot[plate->slot_row[v]] = v;
        const int length = merge_row( r, v );
        int32_t* entries = begin + plate->slot_row[v] / 8 + 1;
        *entries = length > *entries ? length : *entries;
    }
    memset( r->mark, -1, (size_t)f->vertex_count * sizeof( int32_t ) );
    for ( int s = 0; s < slices; ++s )
    {
        begin[s + 1] += begin[s];
    }
    int32_t( *other_x4 )[8] = fabric_pool_push( &plate->pool, (size_t)begin[slices], sizeof( *other_x4 ) );
    plate->weight = fabric_pool_push_zeroed( &plate->pool, (size_t)begin[slices], sizeof( plate->weight[0] ) );
    if ( other_x4 == NULL || plate->weight == NULL )
    {
        return false;
    }
    for ( int row = 0; row < 8 * slices; ++row )
    {
        const int length = row_slot[row] >= 0 ? merge_row( r, row_slot[row] ) : 0;
        for ( int n = 0; n < begin[row / 8 + 1] - begin[row / 8]; ++n )
        {
            other_x4[begin[row / 8] + n][row % 8] = 4 * ( n < length ? plate->slot_row[r->found[n]] : row );
        }
    }
    plate->rows.begin = begin;
    plate->rows.other_x4 = (const int32_t( * )[8])other_x4;
    plate->rows.weight = (const float( * )[8])plate->weight;
    return true;
}

static bool cook_rows( wisp_plate* plate, const wisp_fabric* f, fabric_pool* scratch )
{
    patch_lists lists;
    row_list r = { .plate = plate, .lists = &lists };
    r.mark = fabric_pool_push( scratch, (size_t)f->vertex_count, sizeof( int32_t ) );
    r.found = fabric_pool_push( scratch, (size_t)f->vertex_count, sizeof( int32_t ) );
    if ( r.mark == NULL || r.found == NULL || list_patches( plate, f, scratch, &lists ) == false )
    {
        return false;
    }
    memset( r.mark, -1, (size_t)f->vertex_count * sizeof( int32_t ) );
    return place_rows( plate, f, &r, scratch );
}

static bool cook( wisp_plate* plate, const wisp_fabric* f, const int32_t* slot_row, fabric_pool* scratch )
{
    fabric_pool* keep = &plate->pool;
    plate->slot_row = fabric_pool_push( keep, (size_t)f->vertex_count, sizeof( int32_t ) );
    plate->hinges = fabric_pool_push( keep, (size_t)f->hinge_count, sizeof( plate_hinge ) );
    plate->triangle_hinge = fabric_pool_push( keep, (size_t)f->triangle_count, sizeof( plate->triangle_hinge[0] ) );
    plate->pinned = fabric_pool_push_zeroed( keep, (size_t)f->vertex_count, sizeof( uint8_t ) );
    if ( plate->slot_row == NULL || plate->hinges == NULL || plate->triangle_hinge == NULL ||
         plate->pinned == NULL || connect_hinges( plate, f, scratch ) == false )
    {
        return false;
    }
    for ( int32_t v = 0; v < f->vertex_count; ++v )
    {
        plate->slot_row[v] = slot_row != NULL ? slot_row[v] : v;
    }
    for ( int32_t h = 0; h < plate->hinge_count; ++h )
    {
        list_stencil( plate, f, h );
        fit_shares( plate, plate->hinges + h );
    }
    return cook_rows( plate, f, scratch );
}

wisp_status wisp_plate_create( const wisp_fabric* fabric, const int32_t* slot_row, int row_count,
                               const wisp_allocator* allocator, wisp_plate** out )
{
    fabric_pool pool = { .allocator = allocator }, scratch = { .allocator = allocator };
    wisp_plate* plate = fabric_pool_push_zeroed( &pool, 1, sizeof( wisp_plate ) );
    *out = NULL;
    if ( plate == NULL )
    {
        return WISP_NO_MEMORY;
    }
    plate->pool = pool;
    plate->rows.slice_count = row_count / 8;
    const bool done = cook( plate, fabric, slot_row, &scratch );
    fabric_pool_release( &scratch );
    if ( done == false )
    {
        wisp_plate_release( plate, allocator );
        return WISP_NO_MEMORY;
    }
    *out = plate;
    return WISP_OK;
}

void wisp_plate_release( wisp_plate* plate, const wisp_allocator* allocator )
{
    if ( plate != NULL )
    {
        fabric_pool pool = plate->pool; // the plate itself lies in it
        pool.allocator = allocator;
        fabric_pool_release( &pool );
    }
}

// ---- coefficients ----

static bool is_rigid( const wisp_plate* plate, const wisp_fabric* f, int32_t triangle )
{
    const int32_t* t = f->triangles + 3 * (size_t)triangle;
    return plate->pinned[t[0]] != 0 && plate->pinned[t[1]] != 0 && plate->pinned[t[2]] != 0;
}

// A hinge at a rigid triangle turns on the other side alone. It does not measure the curvature beyond, so it is not part of
// the fit of its neighbours.
static void share_next_to_pins( const wisp_plate* plate, const wisp_fabric* f, plate_hinge* h )
{
    const bool rigid[2] = { is_rigid( plate, f, h->triangle[0] ), is_rigid( plate, f, h->triangle[1] ) };
    memcpy( h->share, h->fitted, sizeof( h->share ) );
    bool whole = true;
    for ( int s = 1; s < STENCIL; ++s )
    {
        if ( h->stencil[s] >= 0 )
        {
            const plate_hinge* next = plate->hinges + h->stencil[s];
            whole = whole && is_rigid( plate, f, next->triangle[0] ) == false &&
                    is_rigid( plate, f, next->triangle[1] ) == false;
        }
    }
    if ( rigid[0] || rigid[1] || whole == false )
    {
        memset( h->share, 0, sizeof( h->share ) );
        h->share[0] = h->height[0] / ( h->height[0] + h->height[1] );
        h->share[0] = rigid[0] ? 0.0 : ( rigid[1] ? 1.0 : h->share[0] );
    }
}

// Energy of turns, 1/2 sum of m d d: m = ( e . e )^2 / ( l l A ) for normals that are as oblique as the edges. Nothing turns
// a triangle about an open edge, so its energy there is the least possible.
static void turn_energy( const wisp_plate* plate, const wisp_fabric* f, int32_t triangle, double m[3][3] )
{
    const int32_t* t = f->triangles + 3 * (size_t)triangle;
    const vec3d e[3] = { edge_of( f, t[0], t[1] ), edge_of( f, t[1], t[2] ), edge_of( f, t[2], t[0] ) };
    const double area = area_of( f, t );
    for ( int p = 0; p < 3; ++p )
    {
        for ( int q = 0; q < 3; ++q )
        {
            const double cosine = dot( e[p], e[q] );
            const double bottom = sqrt( dot( e[p], e[p] ) * dot( e[q], e[q] ) ) * area;
            m[p][q] = bottom > 0.0 ? cosine * cosine / bottom : 0.0;
        }
    }
    for ( int open = 0; open < 3; ++open )
    {
        if ( plate->triangle_hinge[triangle][open] >= 0 )
        {
            continue;
        }
        double column[3] = { m[0][open], m[1][open], m[2][open] };
        const double pivot = m[open][open];
        for ( int p = 0; p < 3; ++p )
        {
            for ( int q = 0; q < 3 && pivot > 0.0; ++q )
            {
                m[p][q] -= column[p] * column[q] / pivot;
            }
        }
    }
}

// Q of one triangle, by its vertices.
static void patch_matrix( const patch* p, double m[3][3], double out[PATCH][PATCH] )
{
    for ( int a = 0; a < p->count; ++a )
    {
        double force[3];
        for ( int k = 0; k < 3; ++k )
        {
            force[k] = m[k][0] * p->turn[0][a] + m[k][1] * p->turn[1][a] + m[k][2] * p->turn[2][a];
        }
        for ( int b = 0; b < p->count; ++b )
        {
            out[a][b] = force[0] * p->turn[0][b] + force[1] * p->turn[1][b] + force[2] * p->turn[2][b];
        }
    }
}

// Largest row sum of W Q of one triangle.
static double patch_rate( const patch* p, const float* position, double q[PATCH][PATCH] )
{
    double largest = 0.0;
    for ( int a = 0; a < p->count; ++a )
    {
        double sum = 0.0;
        for ( int b = 0; b < p->count; ++b )
        {
            sum += fabs( q[a][b] );
        }
        largest = fmax( largest, sum * (double)position[4 * (size_t)p->slot[a] + 3] );
    }
    return largest;
}

static float* find_entry( wisp_plate* plate, int32_t row, int32_t other )
{
    for ( int32_t n = plate->rows.begin[row / 8]; n < plate->rows.begin[row / 8 + 1]; ++n )
    {
        if ( plate->rows.other_x4[n][row % 8] == 4 * other )
        {
            return &plate->weight[n][row % 8];
        }
    }
    return NULL;
}

static void add_patch( wisp_plate* plate, const patch* p, double q[PATCH][PATCH], double scale )
{
    for ( int a = 0; a < p->count; ++a )
    {
        for ( int b = 0; b < p->count; ++b )
        {
            float* entry = a != b ? find_entry( plate, plate->slot_row[p->slot[a]], plate->slot_row[p->slot[b]] ) : NULL;
            if ( entry != NULL )
            {
                *entry -= (float)( scale * q[a][b] );
            }
        }
    }
}

// Rows sum to zero, so a row sum of magnitudes is at most twice that of the weights.
static void bound_rate( wisp_plate* plate, const wisp_fabric* f, const float* position )
{
    double largest = 0.0;
    for ( int32_t v = 0; v < f->vertex_count; ++v )
    {
        const int32_t row = plate->slot_row[v];
        double diagonal = 0.0, magnitudes = 0.0;
        for ( int32_t n = plate->rows.begin[row / 8]; n < plate->rows.begin[row / 8 + 1]; ++n )
        {
            const double weight = (double)plate->weight[n][row % 8];
            diagonal += weight;
            magnitudes += fabs( weight );
        }
        largest = fmax( largest, ( diagonal + magnitudes ) * (double)position[4 * (size_t)v + 3] );
    }
    plate->max_rate = (float)largest;
}

int wisp_plate_fill( wisp_plate* plate, const wisp_fabric* fabric, const float* position, float max_rate )
{
    for ( int32_t v = 0; v < fabric->vertex_count; ++v )
    {
        plate->pinned[v] = position[4 * (size_t)v + 3] == 0.0f ? 1 : 0;
    }
    for ( int32_t h = 0; h < plate->hinge_count; ++h )
    {
        share_next_to_pins( plate, fabric, plate->hinges + h );
    }
    memset( plate->weight, 0, (size_t)plate->rows.begin[plate->rows.slice_count] * sizeof( plate->weight[0] ) );
    int lowered = 0;
    for ( int32_t t = 0; t < fabric->triangle_count; ++t )
    {
        if ( is_rigid( plate, fabric, t ) )
        {
            continue;
        }
        double m[3][3], q[PATCH][PATCH];
        const patch p = patch_of( plate, t, true );
        turn_energy( plate, fabric, t, m );
        patch_matrix( &p, m, q );
        const double rate = patch_rate( &p, position, q ), most = (double)max_rate;
        lowered += rate > most ? 1 : 0;
        add_patch( plate, &p, q, rate > most ? most / rate : 1.0 );
    }
    bound_rate( plate, fabric, position );
    return lowered;
}

bool wisp_plate_is_current( const wisp_plate* plate, const wisp_fabric* fabric, const float* position )
{
    for ( int32_t v = 0; v < fabric->vertex_count; ++v )
    {
        if ( plate->pinned[v] != ( position[4 * (size_t)v + 3] == 0.0f ? 1 : 0 ) )
        {
            return false;
        }
    }
    return true;
}

wisp_plate_rows wisp_plate_get_rows( const wisp_plate* plate )
{
    return plate->rows;
}

float wisp_plate_max_rate( const wisp_plate* plate )
{
    return plate->max_rate;
}
