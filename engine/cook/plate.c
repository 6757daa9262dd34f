// Bending of thin plates on a mesh: which vertices act on which, and how strongly. Equations: wisp/module/plate.h.
#include "wisp/module/plate.h"

#include "fabric_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    STENCIL = 5,   // hinges that share a turn: the hinge itself, two of each triangle
    PATCH = 12,    // vertices of a triangle, its neighbours and theirs; more than the hinges between them
    CORNERS = 4,   // of a hinge
    MONOMIALS = 3, // quadratic surfaces of unit curvature: x x / 2, y y / 2, x y / sqrt 2
};

// Shares below this are dropped. They are rounding errors on regular meshes, whose rows become half as long.
static const double LEAST_SHARE = 1e-5;
// Of the sum of squares that a fit is solved with: where hinges lie badly for a fit, the share stays near that by height.
static const double REGULARISATION = 1e-4;
// A triangle lower than this part of its edge has no direction, so its edges are open.
static const double LEAST_HEIGHT = 1e-5;
// Squared gradients of an angle may be so many times those of the rest shape before the moment is scaled down.
static const double STEEPEST = 2.0;

// A hinge between side 0, the triangle (i, j, k), and side 1, the triangle (j, i, l).
typedef struct plate_hinge
{
    int32_t corner[CORNERS];      // slots i, j, k, l
    int32_t constraint;           // of the fabric
    int32_t triangle[2];
    int32_t stencil[STENCIL];     // hinges: itself, across (j, k), (k, i), (i, l), (l, j); -1: none
    double row[CORNERS];          // J = sum of row x, 1/m
    double length;                // m
    double foot[2], height[2];    // of an opposite corner over the edge: share of the edge from i; m
    double fitted[STENCIL];       // turn of side 0 from J of the stencil, without pins
    double share[STENCIL];        // the same next to pins
} plate_hinge;

// A matrix over vertices or over hinges by slices of eight rows. A slice has as many entries as its longest row.
typedef struct row_set
{
    bool of_hinges; // else of vertices
    int item_count, slice_count;
    int32_t* item_row;       // [item_count]
    int32_t* begin;          // [slice_count + 1]
    int32_t ( *other )[8];   // [entry] rows, times 4 of vertices; a lane's own row pads
    float ( *weight )[8];    // [entry]
} row_set;

struct wisp_plate
{
    row_set vertices;               // Q, without its diagonal
    row_set turns;                  // energy of turns, 1/2 D sum of K J J; empty unless requested
    float *stiffness, *steepest;    // [row of turns]
    float* least_height;            // [slot] m
    plate_hinge* hinges;            // [hinge_count]
    int hinge_count;
    int32_t ( *triangle_hinge )[3]; // [triangle_count] across the edge from corner k to the next; -1: open
    uint8_t* pinned;                // [vertex_count]
    float max_rate;
    bool filled;
    int lowered;     // triangles that are scaled down
    float scaled_to; // 1/(kg m^2)
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
        plate_hinge h = { .constraint = n };
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
        out[2] += h->row[k] * sqrt( 0.5 ) * at[k].x * at[k].y;
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

// What acts on the curvature of one triangle: its turns as linear combinations of those of hinges, and of the vertices around.
typedef struct patch
{
    int hinge_count, vertex_count;
    int32_t hinge[PATCH], vertex[PATCH];
    double of_hinge[3][PATCH];
    double of_vertex[3][PATCH]; // 1/m
} patch;

static int find_or_add( int32_t* list, int* count, int32_t item )
{
    for ( int i = 0; i < *count; ++i )
    {
        if ( list[i] == item )
        {
            return i;
        }
    }
    list[*count] = item;
    return ( *count )++;
}

static void add_jump( patch* p, int edge, const wisp_plate* plate, int32_t hinge, double factor )
{
    const plate_hinge* h = plate->hinges + hinge;
    p->of_hinge[edge][find_or_add( p->hinge, &p->hinge_count, hinge )] += factor;
    for ( int k = 0; k < CORNERS; ++k )
    {
        p->of_vertex[edge][find_or_add( p->vertex, &p->vertex_count, h->corner[k] )] += factor * h->row[k];
    }
}

// @param with_pins with the shares next to pins; without, a patch has the vertices and hinges that it can ever have
static patch patch_of( const wisp_plate* plate, int32_t triangle, bool with_pins )
{
    patch p = { .hinge_count = 0 };
    for ( int edge = 0; edge < 3; ++edge )
    {
        const int32_t hinge = plate->triangle_hinge[triangle][edge];
        if ( hinge < 0 )
        {
            continue;
        }
        const plate_hinge* h = plate->hinges + hinge;
        const double* share = with_pins ? h->share : h->fitted;
        for ( int s = 0; s < STENCIL; ++s )
        {
            const double other = ( s == 0 ? 1.0 : 0.0 ) - share[s];
            if ( h->stencil[s] >= 0 && ( s == 0 || h->fitted[s] != 0.0 ) )
            {
                add_jump( &p, edge, plate, h->stencil[s], h->triangle[0] == triangle ? share[s] : other );
            }
        }
    }
    return p;
}

// ---- rows ----

// The patches that a vertex or a hinge is in, to merge into its row.
typedef struct patch_lists
{
    int32_t* begin;    // [item_count + 2]
    int32_t* triangle; // [begin[item_count]]
    int32_t* mark;     // [item_count] last row that has the item
    int32_t* found;    // [item_count]
} patch_lists;

static int members_of( const patch* p, const row_set* set, const int32_t** out )
{
    *out = set->of_hinges ? p->hinge : p->vertex;
    return set->of_hinges ? p->hinge_count : p->vertex_count;
}

static bool list_patches( const wisp_plate* plate, const wisp_fabric* f, const row_set* set, fabric_pool* scratch,
                          patch_lists* out )
{
    const size_t count = (size_t)set->item_count;
    out->begin = fabric_pool_push_zeroed( scratch, count + 2, sizeof( int32_t ) );
    out->triangle = fabric_pool_push( scratch, PATCH * (size_t)f->triangle_count, sizeof( int32_t ) );
    out->mark = fabric_pool_push( scratch, count, sizeof( int32_t ) );
    out->found = fabric_pool_push( scratch, count, sizeof( int32_t ) );
    if ( out->begin == NULL || out->triangle == NULL || out->mark == NULL || out->found == NULL )
    {
        return false;
    }
    for ( int pass = 0; pass < 2; ++pass )
    {
        for ( int32_t t = 0; t < f->triangle_count; ++t )
        {
            const patch p = patch_of( plate, t, false );
            const int32_t* members;
            const int member_count = members_of( &p, set, &members );
            for ( int i = 0; i < member_count; ++i )
            {
                // first the counts, two places ahead; then each place moves to its end, where the next one begins
                int32_t* place = out->begin + members[i] + ( pass == 0 ? 2 : 1 );
                if ( pass == 1 )
                {
                    out->triangle[*place] = t;
                }
                *place += 1;
            }
        }
        for ( size_t i = 0; i < count && pass == 0; ++i )
        {
            out->begin[i + 2] += out->begin[i + 1];
        }
    }
    return true;
}

static int compare_items( const void* first, const void* second )
{
    const int32_t a = *(const int32_t*)first, b = *(const int32_t*)second;
    return ( a > b ) - ( a < b );
}

// Items of a row in ascending order; a vertex is not in its own row, whose diagonal follows from the others. @return their
// number
static int merge_row( const wisp_plate* plate, const row_set* set, const patch_lists* lists, int32_t item )
{
    int count = 0;
    lists->mark[item] = set->of_hinges ? -1 : item;
    for ( int32_t at = lists->begin[item]; at < lists->begin[item + 1]; ++at )
    {
        const patch p = patch_of( plate, lists->triangle[at], false );
        const int32_t* members;
        const int member_count = members_of( &p, set, &members );
        for ( int i = 0; i < member_count; ++i )
        {
            if ( lists->mark[members[i]] != item )
            {
                lists->mark[members[i]] = item;
                lists->found[count++] = members[i];
            }
        }
    }
    qsort( lists->found, (size_t)count, sizeof( int32_t ), compare_items );
    return count;
}

static void clear_marks( const row_set* set, const patch_lists* lists )
{
    memset( lists->mark, -1, (size_t)set->item_count * sizeof( int32_t ) );
}

static void write_rows( const wisp_plate* plate, row_set* set, const patch_lists* lists )
{
    const int times = set->of_hinges ? 1 : 4;
    for ( int slice = 0; slice < set->slice_count; ++slice )
    {
        for ( int32_t n = set->begin[slice]; n < set->begin[slice + 1]; ++n )
        {
            for ( int lane = 0; lane < 8; ++lane )
            {
                set->other[n][lane] = times * ( 8 * slice + lane );
            }
        }
    }
    for ( int32_t item = 0; item < set->item_count; ++item )
    {
        const int32_t row = set->item_row[item];
        const int length = merge_row( plate, set, lists, item );
        for ( int n = 0; n < length; ++n )
        {
            set->other[set->begin[row / 8] + n][row % 8] = times * set->item_row[lists->found[n]];
        }
    }
}

static bool cook_rows( wisp_plate* plate, const wisp_fabric* f, row_set* set, fabric_pool* scratch )
{
    patch_lists lists;
    set->begin = fabric_pool_push_zeroed( &plate->pool, (size_t)set->slice_count + 1, sizeof( int32_t ) );
    if ( set->begin == NULL || list_patches( plate, f, set, scratch, &lists ) == false )
    {
        return false;
    }
    clear_marks( set, &lists );
    for ( int32_t item = 0; item < set->item_count; ++item )
    {
        const int length = merge_row( plate, set, &lists, item );
        int32_t* longest = set->begin + set->item_row[item] / 8 + 1;
        *longest = length > *longest ? length : *longest;
    }
    for ( int s = 0; s < set->slice_count; ++s )
    {
        set->begin[s + 1] += set->begin[s];
    }
    const size_t entries = (size_t)set->begin[set->slice_count];
    set->other = fabric_pool_push( &plate->pool, entries, sizeof( set->other[0] ) );
    set->weight = fabric_pool_push_zeroed( &plate->pool, entries, sizeof( set->weight[0] ) );
    if ( set->other == NULL || set->weight == NULL )
    {
        return false;
    }
    clear_marks( set, &lists );
    write_rows( plate, set, &lists );
    return true;
}

// The least height of the triangles at each vertex; vertices without a hinge do not bend.
static bool list_heights( wisp_plate* plate, const wisp_fabric* f )
{
    plate->least_height = fabric_pool_push( &plate->pool, (size_t)f->slot_count, sizeof( float ) );
    for ( int slot = 0; slot < f->slot_count && plate->least_height != NULL; ++slot )
    {
        plate->least_height[slot] = INFINITY;
    }
    for ( int n = 0; n < plate->hinge_count && plate->least_height != NULL; ++n )
    {
        const plate_hinge* h = plate->hinges + n;
        const float least = (float)fmin( h->height[0], h->height[1] );
        for ( int k = 0; k < CORNERS; ++k )
        {
            plate->least_height[h->corner[k]] = fminf( plate->least_height[h->corner[k]], least );
        }
    }
    return plate->least_height != NULL;
}

// Rows of hinges are the slots of their schedule.
static bool cook_turns( wisp_plate* plate, const wisp_fabric* f, fabric_pool* scratch )
{
    const size_t slots = (size_t)f->hinge_order.slot_count;
    row_set* set = &plate->turns;
    *set = ( row_set ){ .of_hinges = true, .item_count = plate->hinge_count, .slice_count = (int)( slots / 8 ) };
    int32_t* slot_of = fabric_pool_push( scratch, (size_t)f->hinge_count, sizeof( int32_t ) );
    set->item_row = fabric_pool_push( &plate->pool, (size_t)plate->hinge_count, sizeof( int32_t ) );
    plate->stiffness = fabric_pool_push_zeroed( &plate->pool, slots, sizeof( float ) );
    plate->steepest = fabric_pool_push_zeroed( &plate->pool, slots, sizeof( float ) );
    if ( slot_of == NULL || set->item_row == NULL || plate->stiffness == NULL || plate->steepest == NULL || list_heights( plate, f ) == false )
    {
        return false;
    }
    for ( size_t slot = 0; slot < slots; ++slot )
    {
        if ( f->hinge_order.constraint[slot] >= 0 )
        {
            slot_of[f->hinge_order.constraint[slot]] = (int32_t)slot;
        }
    }
    for ( int32_t n = 0; n < plate->hinge_count; ++n )
    {
        const plate_hinge* h = plate->hinges + n;
        const double k = h->height[0], l = h->height[1];
        set->item_row[n] = slot_of[h->constraint];
        plate->steepest[set->item_row[n]] = (float)( STEEPEST * ( 1.0 / ( k * k ) + 1.0 / ( l * l ) ) );
    }
    return cook_rows( plate, f, set, scratch );
}

static bool cook( wisp_plate* plate, const wisp_fabric* f, const int32_t* slot_row, bool with_turns,
                  fabric_pool* scratch )
{
    fabric_pool* keep = &plate->pool;
    int32_t* item_row = fabric_pool_push( keep, (size_t)f->vertex_count, sizeof( int32_t ) );
    plate->hinges = fabric_pool_push( keep, (size_t)f->hinge_count, sizeof( plate_hinge ) );
    plate->triangle_hinge = fabric_pool_push( keep, (size_t)f->triangle_count, sizeof( plate->triangle_hinge[0] ) );
    plate->pinned = fabric_pool_push_zeroed( keep, (size_t)f->vertex_count, sizeof( uint8_t ) );
    if ( item_row == NULL || plate->hinges == NULL || plate->triangle_hinge == NULL ||
         plate->pinned == NULL || connect_hinges( plate, f, scratch ) == false )
    {
        return false;
    }
    for ( int32_t v = 0; v < f->vertex_count; ++v )
    {
        item_row[v] = slot_row != NULL ? slot_row[v] : v;
    }
    plate->vertices.item_row = item_row;
    plate->vertices.item_count = f->vertex_count;
    for ( int32_t h = 0; h < plate->hinge_count; ++h )
    {
        list_stencil( plate, f, h );
        fit_shares( plate, plate->hinges + h );
    }
    return cook_rows( plate, f, &plate->vertices, scratch ) &&
           ( with_turns == false || cook_turns( plate, f, scratch ) );
}

wisp_status wisp_plate_create( const wisp_fabric* fabric, const int32_t* slot_row, int row_count, bool with_turns,
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
    plate->vertices.slice_count = row_count / 8;
    const bool done = cook( plate, fabric, slot_row, with_turns, &scratch );
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

// Energy of one triangle by its items. @param factor turns of its edges from those items
static void patch_matrix( double m[3][3], double factor[3][PATCH], int count, double out[PATCH][PATCH] )
{
    for ( int a = 0; a < count; ++a )
    {
        double moment[3];
        for ( int k = 0; k < 3; ++k )
        {
            moment[k] = m[k][0] * factor[0][a] + m[k][1] * factor[1][a] + m[k][2] * factor[2][a];
        }
        for ( int b = 0; b < count; ++b )
        {
            out[a][b] = moment[0] * factor[0][b] + moment[1] * factor[1][b] + moment[2] * factor[2][b];
        }
    }
}

// Largest row sum of W Q of one triangle.
static double patch_rate( const patch* p, const float* position, double q[PATCH][PATCH] )
{
    double largest = 0.0;
    for ( int a = 0; a < p->vertex_count; ++a )
    {
        double sum = 0.0;
        for ( int b = 0; b < p->vertex_count; ++b )
        {
            sum += fabs( q[a][b] );
        }
        largest = fmax( largest, sum * (double)position[4 * (size_t)p->vertex[a] + 3] );
    }
    return largest;
}

static void add_entry( row_set* set, int32_t row, int32_t other, double value )
{
    const int32_t name = set->of_hinges ? other : 4 * other;
    for ( int32_t n = set->begin[row / 8]; n < set->begin[row / 8 + 1]; ++n )
    {
        if ( set->other[n][row % 8] == name )
        {
            set->weight[n][row % 8] += (float)value;
            return;
        }
    }
}

// Rows sum to zero with their diagonal, so off it the weights of differences are the negative entries.
static void add_vertices( wisp_plate* plate, const patch* p, double q[PATCH][PATCH], double scale )
{
    const int32_t* row = plate->vertices.item_row;
    for ( int a = 0; a < p->vertex_count; ++a )
    {
        for ( int b = 0; b < p->vertex_count; ++b )
        {
            if ( a != b )
            {
                add_entry( &plate->vertices, row[p->vertex[a]], row[p->vertex[b]], -scale * q[a][b] );
            }
        }
    }
}

static void add_turns( wisp_plate* plate, const patch* p, double k[PATCH][PATCH], double scale )
{
    const int32_t* row = plate->turns.item_row;
    for ( int a = 0; a < p->hinge_count; ++a )
    {
        for ( int b = 0; b < p->hinge_count; ++b )
        {
            add_entry( &plate->turns, row[p->hinge[a]], row[p->hinge[b]], scale * k[a][b] );
        }
        plate->stiffness[row[p->hinge[a]]] += (float)( scale * k[a][a] );
    }
}

// A row sum of magnitudes: of the weights, and of their sum, the diagonal.
static void bound_rate( wisp_plate* plate, const wisp_fabric* f, const float* position )
{
    const row_set* set = &plate->vertices;
    double largest = 0.0;
    for ( int32_t v = 0; v < f->vertex_count; ++v )
    {
        const int32_t row = set->item_row[v];
        double diagonal = 0.0, magnitudes = 0.0;
        for ( int32_t n = set->begin[row / 8]; n < set->begin[row / 8 + 1]; ++n )
        {
            const double weight = (double)set->weight[n][row % 8];
            diagonal += weight;
            magnitudes += fabs( weight );
        }
        largest = fmax( largest, ( diagonal + magnitudes ) * (double)position[4 * (size_t)v + 3] );
    }
    plate->max_rate = (float)largest;
}

static void clear( wisp_plate* plate )
{
    row_set* sets[2] = { &plate->vertices, &plate->turns };
    for ( int i = 0; i < 2; ++i )
    {
        if ( sets[i]->begin != NULL )
        {
            memset( sets[i]->weight, 0, (size_t)sets[i]->begin[sets[i]->slice_count] * sizeof( sets[i]->weight[0] ) );
        }
    }
    if ( plate->stiffness != NULL )
    {
        memset( plate->stiffness, 0, 8 * (size_t)plate->turns.slice_count * sizeof( float ) );
    }
}

static int fill( wisp_plate* plate, const wisp_fabric* fabric, const float* position, float max_rate )
{
    for ( int32_t v = 0; v < fabric->vertex_count; ++v )
    {
        plate->pinned[v] = position[4 * (size_t)v + 3] == 0.0f ? 1 : 0;
    }
    for ( int32_t h = 0; h < plate->hinge_count; ++h )
    {
        share_next_to_pins( plate, fabric, plate->hinges + h );
    }
    clear( plate );
    int lowered = 0;
    for ( int32_t t = 0; t < fabric->triangle_count; ++t )
    {
        if ( is_rigid( plate, fabric, t ) )
        {
            continue;
        }
        double m[3][3], q[PATCH][PATCH];
        patch p = patch_of( plate, t, true );
        turn_energy( plate, fabric, t, m );
        patch_matrix( m, p.of_vertex, p.vertex_count, q );
        const double rate = patch_rate( &p, position, q ), most = (double)max_rate;
        const double scale = rate > most ? most / rate : 1.0;
        lowered += rate > most ? 1 : 0;
        add_vertices( plate, &p, q, scale );
        if ( plate->turns.begin != NULL )
        {
            patch_matrix( m, p.of_hinge, p.hinge_count, q );
            add_turns( plate, &p, q, scale );
        }
    }
    bound_rate( plate, fabric, position );
    return lowered;
}

static bool has_same_pins( const wisp_plate* plate, const wisp_fabric* fabric, const float* position )
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

int wisp_plate_update( wisp_plate* plate, const wisp_fabric* fabric, const float* position, float max_rate )
{
    const bool rescaled = max_rate != plate->scaled_to && ( plate->lowered > 0 || max_rate < plate->scaled_to );
    if ( plate->filled == false || rescaled || has_same_pins( plate, fabric, position ) == false )
    {
        plate->lowered = fill( plate, fabric, position, max_rate );
        plate->scaled_to = max_rate;
        plate->filled = true;
    }
    return plate->lowered;
}

wisp_plate_rows wisp_plate_get_rows( const wisp_plate* plate )
{
    return ( wisp_plate_rows ){
        .slice_count = plate->vertices.slice_count,
        .begin = plate->vertices.begin,
        .other_x4 = (const int32_t( * )[8])plate->vertices.other,
        .weight = (const float( * )[8])plate->vertices.weight,
    };
}

wisp_plate_turns wisp_plate_get_turns( const wisp_plate* plate )
{
    return ( wisp_plate_turns ){
        .begin = plate->turns.begin,
        .other = (const int32_t( * )[8])plate->turns.other,
        .weight = (const float( * )[8])plate->turns.weight,
        .stiffness = plate->stiffness,
        .steepest = plate->steepest,
        .least_height = plate->least_height,
    };
}

float wisp_plate_max_rate( const wisp_plate* plate )
{
    return plate->max_rate;
}
