// Bending of thin plates on a mesh: creation, and what the kernels read. Equations: wisp/module/plate.h.
#include "plate_parts.h"

#include "fabric.h"

#include <math.h>
#include <string.h>

// ---- hinges ----

// Hinges of a plate: their places in the rest shape, and how two triangles share the turn of their hinge.

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
    const double3 e = plate_edge( f, corner[0], corner[1] ), d = plate_edge( f, corner[0], opposite );
    shape->length = double3_length( e );
    if ( !( shape->length > 0.0 ) )
    {
        return false;
    }
    shape->foot[side] = double3_dot( d, e ) / double3_dot( e, e );
    shape->height[side] = 2.0 * plate_area( f, t ) / shape->length;
    return shape->height[side] > LEAST_HEIGHT * shape->length;
}

bool plate_measure_hinge( const wisp_fabric* f, const plate_hinge* h, plate_shape* out )
{
    const int32_t* corner = h->corner;
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

// Corners of all hinges in the order of their numbers, by their schedule, or else by the fabric's list.
static void list_hinge_corners( const wisp_fabric* f, plate_hinge* out )
{
    for ( int n = 0; n < f->hinge_count && f->hinge_order.slot_count == 0; ++n )
    {
        out[n] = ( plate_hinge ){ .slot = -1 };
        memcpy( out[n].corner, f->hinges + PLATE_CORNERS * (size_t)n, sizeof( out[n].corner ) );
    }
    for ( int slot = 0; slot < f->hinge_order.slot_count; ++slot )
    {
        if ( f->hinge_order.constraint[slot] >= 0 )
        {
            plate_hinge* h = out + f->hinge_order.constraint[slot];
            *h = ( plate_hinge ){ .slot = slot };
            wisp_fabric_hinge_corners( f, slot, h->corner );
        }
    }
}

static bool connect_hinges( wisp_plate* plate, const wisp_fabric* f, plate_shape* shapes, fabric_pool* scratch )
{
    half_edges edges;
    if ( list_half_edges( f, scratch, &edges ) == false )
    {
        return false;
    }
    list_hinge_corners( f, plate->hinges );
    plate->hinge_count = 0;
    memset( plate->triangle_hinge, -1, (size_t)f->triangle_count * sizeof( plate->triangle_hinge[0] ) );
    for ( int n = 0; n < f->hinge_count; ++n )
    {
        plate_hinge h = plate->hinges[n];
        plate_shape* shape = shapes + plate->hinge_count;
        const int32_t* corner = h.corner;
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

// Hinges that share the turn of a hinge: itself, across (j, k), (k, i), (i, l), (l, j); -1: none.
static void plate_list_stencil( const wisp_plate* plate, const wisp_fabric* f, int32_t hinge,
                                int32_t stencil[PLATE_STENCIL] )
{
    const plate_hinge* h = plate->hinges + hinge;
    const int32_t* corner = h->corner;
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
    const bool same = h->corner[0] == from_slot; // then `near` is the corner k, the far one l
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
    const int32_t* corner = h->corner;
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

// List the hinges, how their triangles share a turn, and the hinge across each edge. @return false if out of memory
static bool plate_cook_hinges( wisp_plate* plate, const wisp_fabric* f, fabric_pool* scratch )
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

// ---- rows ----

// Which vertices and hinges of a plate act on each other: the entries of the rows of its matrices.

// ---- patches ----

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

static void add_jump( plate_patch* p, int edge, const wisp_plate* plate, int32_t hinge, double factor )
{
    const plate_hinge* h = plate->hinges + hinge;
    const int32_t* corner = h->corner;
    p->of_hinge[edge][find_or_add( p->hinge, &p->hinge_count, hinge )] += factor;
    for ( int k = 0; k < PLATE_CORNERS; ++k )
    {
        p->of_vertex[edge][find_or_add( p->vertex, &p->vertex_count, corner[k] )] += factor * (double)h->row[k];
    }
}

plate_patch plate_patch_of( const wisp_plate* plate, const wisp_fabric* f, int32_t triangle )
{
    plate_patch p = { .hinge_count = 0 };
    for ( int edge = 0; edge < 3; ++edge )
    {
        const int32_t hinge = plate->triangle_hinge[triangle][edge];
        if ( hinge < 0 )
        {
            continue;
        }
        const plate_hinge* h = plate->hinges + hinge;
        int32_t stencil[PLATE_STENCIL];
        double share[PLATE_STENCIL];
        plate_list_stencil( plate, f, hinge, stencil );
        plate_share_turn( plate, f, h, stencil, share );
        for ( int s = 0; s < PLATE_STENCIL; ++s )
        {
            const double other = ( s == 0 ? 1.0 : 0.0 ) - share[s];
            if ( stencil[s] >= 0 && ( s == 0 || h->fitted[s] != 0.0f ) )
            {
                add_jump( &p, edge, plate, stencil[s], h->triangle[0] == triangle ? share[s] : other );
            }
        }
    }
    return p;
}

// The hinges or vertices that a patch can have, whatever is pinned.
typedef struct patch_members
{
    int count;
    int32_t item[PLATE_PATCH];
    unsigned of_edge[3];          // bits of the items that the turn at an edge depends on
    uint16_t acting[PLATE_PATCH]; // bits of the items that act on an item
} patch_members;

static void add_member( patch_members* p, int edge, int32_t item )
{
    p->of_edge[edge] |= 1u << find_or_add( p->item, &p->count, item );
}

// Corners whose entry of the row is 0 do not turn the hinge.
static void add_hinge( patch_members* p, int edge, const wisp_plate* plate, int32_t hinge, bool of_hinges )
{
    const plate_hinge* h = plate->hinges + hinge;
    if ( of_hinges )
    {
        add_member( p, edge, hinge );
        return;
    }
    for ( int k = 0; k < PLATE_CORNERS; ++k )
    {
        if ( h->row[k] != 0.0f )
        {
            add_member( p, edge, h->corner[k] );
        }
    }
}

// Items act on each other where turns at their edges have energy in common.
static void set_acting( patch_members* p, double m[3][3] )
{
    unsigned on_edge[3] = { 0 };
    for ( int k = 0; k < 9; ++k )
    {
        on_edge[k / 3] |= k / 3 == k % 3 || m[k / 3][k % 3] != 0.0 ? p->of_edge[k % 3] : 0;
    }
    for ( int k = 0; k < 3 * p->count; ++k )
    {
        p->acting[k / 3] |= (uint16_t)( ( p->of_edge[k % 3] >> k / 3 & 1 ) != 0 ? on_edge[k % 3] : 0 );
    }
}

static patch_members members_of( const wisp_plate* plate, const wisp_fabric* f, int32_t triangle, bool of_hinges )
{
    patch_members p = { .count = 0 };
    for ( int edge = 0; edge < 3; ++edge )
    {
        const int32_t hinge = plate->triangle_hinge[triangle][edge];
        int32_t stencil[PLATE_STENCIL];
        if ( hinge < 0 )
        {
            continue;
        }
        plate_list_stencil( plate, f, hinge, stencil );
        for ( int s = 0; s < PLATE_STENCIL; ++s )
        {
            if ( stencil[s] >= 0 && ( s == 0 || plate->hinges[hinge].fitted[s] != 0.0f ) )
            {
                add_hinge( &p, edge, plate, stencil[s], of_hinges );
            }
        }
    }
    double m[3][3];
    plate_turn_energy( plate, f, triangle, m );
    set_acting( &p, m );
    return p;
}

// ---- rows ----

// The patches that a vertex or a hinge is in, to merge into its row.
typedef struct patch_lists
{
    patch_members* patch; // [triangle_count]
    int32_t* begin;       // [item_count + 2]
    int32_t* place;       // [begin[item_count]] PLATE_PATCH times the triangle, and which of its items
    int32_t* mark;        // [item_count] last row that has the item
    int32_t* found;       // [item_count]
} patch_lists;

static bool list_patches( const wisp_plate* plate, const wisp_fabric* f, const plate_row_set* set,
                          fabric_pool* scratch, patch_lists* out )
{
    const size_t count = (size_t)set->item_count;
    out->patch = fabric_pool_push( scratch, (size_t)f->triangle_count, sizeof( patch_members ) );
    out->begin = fabric_pool_push_zeroed( scratch, count + 2, sizeof( int32_t ) );
    out->place = fabric_pool_push( scratch, PLATE_PATCH * (size_t)f->triangle_count, sizeof( int32_t ) );
    out->mark = fabric_pool_push( scratch, count, sizeof( int32_t ) );
    out->found = fabric_pool_push( scratch, count, sizeof( int32_t ) );
    if ( out->patch == NULL || out->begin == NULL || out->place == NULL || out->mark == NULL || out->found == NULL )
    {
        return false;
    }
    for ( int32_t t = 0; t < f->triangle_count; ++t )
    {
        out->patch[t] = members_of( plate, f, t, set->of_hinges );
        for ( int i = 0; i < out->patch[t].count; ++i )
        {
            out->begin[out->patch[t].item[i] + 2] += 1;
        }
    }
    for ( size_t i = 0; i < count; ++i )
    {
        out->begin[i + 2] += out->begin[i + 1];
    }
    // each place moves to its end, where the next one begins
    for ( int32_t t = 0; t < f->triangle_count; ++t )
    {
        for ( int i = 0; i < out->patch[t].count; ++i )
        {
            out->place[out->begin[out->patch[t].item[i] + 1]++] = PLATE_PATCH * t + i;
        }
    }
    return true;
}

// Items of a row in ascending order; a vertex is not in its own row, whose diagonal follows from the others. @return their
// number
static int merge_row( const plate_row_set* set, const patch_lists* lists, int32_t item )
{
    int count = 0;
    lists->mark[item] = set->of_hinges ? -1 : item;
    for ( int32_t at = lists->begin[item]; at < lists->begin[item + 1]; ++at )
    {
        const patch_members* p = lists->patch + lists->place[at] / PLATE_PATCH;
        const unsigned acting = p->acting[lists->place[at] % PLATE_PATCH];
        for ( int i = 0; i < p->count; ++i )
        {
            if ( ( acting >> i & 1 ) != 0 && lists->mark[p->item[i]] != item )
            {
                lists->mark[p->item[i]] = item;
                int n = count++;
                for ( ; n > 0 && lists->found[n - 1] > p->item[i]; --n )
                {
                    lists->found[n] = lists->found[n - 1];
                }
                lists->found[n] = p->item[i];
            }
        }
    }
    return count;
}

static void clear_marks( const plate_row_set* set, const patch_lists* lists )
{
    memset( lists->mark, -1, (size_t)set->item_count * sizeof( int32_t ) );
}

static void write_rows( plate_row_set* set, const patch_lists* lists )
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
        const int length = merge_row( set, lists, item );
        for ( int n = 0; n < length; ++n )
        {
            set->other[set->begin[row / 8] + n][row % 8] = times * set->item_row[lists->found[n]];
        }
    }
}

// Keep what was listed in scratch memory, in half of it where that fits. Springs read the rows that they are told as they are.
static bool keep_others( wisp_plate* plate, plate_row_set* set )
{
    const size_t entries = (size_t)set->begin[set->slice_count];
    int32_t( *other )[8] = set->other;
    int least = 0, most = plate->slot_row != NULL ? INT32_MAX : 0;
    for ( int pass = 0; pass < 2; ++pass )
    {
        for ( int slice = 0; slice < set->slice_count; ++slice )
        {
            const int first = set->of_hinges ? 0 : 32 * slice;
            for ( int32_t i = 8 * set->begin[slice]; i < 8 * set->begin[slice + 1]; ++i )
            {
                const int far = other[i / 8][i % 8] - first;
                least = far < least ? far : least;
                most = far > most ? far : most;
                if ( pass == 1 )
                {
                    set->near[i / 8][i % 8] = (uint16_t)far;
                }
            }
        }
        if ( least < INT16_MIN || most > ( set->of_hinges ? UINT16_MAX : INT16_MAX ) )
        {
            set->other = fabric_pool_push( &plate->pool, entries, sizeof( *other ) );
            return set->other != NULL && memcpy( set->other, other, entries * sizeof( *other ) ) != NULL;
        }
        set->near = pass == 0 ? fabric_pool_push( &plate->pool, entries, sizeof( *set->near ) ) : set->near;
        if ( set->near == NULL )
        {
            return false;
        }
    }
    set->other = NULL;
    return true;
}

// List the entries of each row; their weights are 0. @return false if out of memory
static bool plate_cook_rows( wisp_plate* plate, const wisp_fabric* f, plate_row_set* set, fabric_pool* scratch )
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
        const int length = merge_row( set, &lists, item );
        int32_t* longest = set->begin + set->item_row[item] / 8 + 1;
        *longest = length > *longest ? length : *longest;
    }
    for ( int s = 0; s < set->slice_count; ++s )
    {
        set->begin[s + 1] += set->begin[s];
    }
    const size_t entries = (size_t)set->begin[set->slice_count];
    set->other = fabric_pool_push( scratch, entries, sizeof( set->other[0] ) );
    set->weight = fabric_pool_push_zeroed( &plate->pool, entries, sizeof( set->weight[0] ) );
    if ( set->other == NULL || set->weight == NULL )
    {
        return false;
    }
    clear_marks( set, &lists );
    write_rows( set, &lists );
    return keep_others( plate, set );
}

// ---- plate ----

// Squared gradients of an angle may be so many times those of the rest shape before the moment is scaled down.
static const double STEEPEST = 2.0;

// The steepest gradients, and the least height of the triangles at each vertex; vertices without a hinge do not bend.
static void measure_hinges( wisp_plate* plate, const wisp_fabric* f )
{
    for ( int slot = 0; slot < f->slot_count; ++slot )
    {
        plate->least_height[slot] = INFINITY;
    }
    for ( int n = 0; n < plate->hinge_count; ++n )
    {
        const int32_t* corner = plate->hinges[n].corner;
        plate_shape shape = { 0 };
        plate_measure_hinge( f, plate->hinges + n, &shape );
        const double k = shape.height[0], l = shape.height[1];
        plate->steepest[plate->turns.item_row[n]] = (float)( STEEPEST * ( 1.0 / ( k * k ) + 1.0 / ( l * l ) ) );
        for ( int i = 0; i < PLATE_CORNERS; ++i )
        {
            plate->least_height[corner[i]] = fminf( plate->least_height[corner[i]], (float)fmin( k, l ) );
        }
    }
}

// Groups of triangles, and where they read moments: at the slots of hinges.
static bool cook_triangles( wisp_plate* plate, const wisp_fabric* f, fabric_pool* scratch )
{
    fabric_constraints triangles = fabric_triangle_constraints( f );
    triangles.solve_order = f->solve_order;
    wisp_schedule* order = &plate->triangles;
    if ( fabric_schedule_build( &triangles, &plate->pool, scratch, order ) == false ||
         fabric_schedule_corners( order, &triangles, &plate->pool, &plate->corner_x4 ) == false )
    {
        return false;
    }
    plate->moment_of = fabric_pool_push( &plate->pool, 3 * (size_t)order->slot_count, sizeof( int32_t ) );
    for ( int i = 0; i < 3 * order->slot_count && plate->moment_of != NULL; ++i )
    {
        const int32_t triangle = order->constraint[i / 24 * 8 + i % 8];
        const int32_t hinge = triangle >= 0 ? plate->triangle_hinge[triangle][( i / 8 + 1 ) % 3] : -1;
        plate->moment_of[i] = hinge >= 0 ? plate->turns.item_row[hinge] : f->hinge_order.slot_count;
    }
    order->constraint = NULL; // in scratch memory
    return plate->moment_of != NULL;
}

static bool cook_turns( wisp_plate* plate, const wisp_fabric* f, fabric_pool* scratch )
{
    plate->steepest = fabric_pool_push_zeroed( &plate->pool, (size_t)f->hinge_order.slot_count, sizeof( float ) );
    plate->least_height = fabric_pool_push( &plate->pool, (size_t)f->slot_count, sizeof( float ) );
    if ( plate->steepest == NULL || plate->least_height == NULL )
    {
        return false;
    }
    measure_hinges( plate, f );
    return cook_triangles( plate, f, scratch ) && plate_cook_rows( plate, f, &plate->turns, scratch );
}

// Rows of vertices are slots unless told otherwise; those of hinges are the slots of their schedule.
static bool list_item_rows( wisp_plate* plate, const wisp_fabric* f )
{
    plate_row_set *vertices = &plate->vertices, *turns = &plate->turns;
    vertices->item_count = f->vertex_count;
    vertices->item_row = fabric_pool_push( &plate->parts, (size_t)vertices->item_count, sizeof( int32_t ) );
    turns->item_count = turns->of_hinges ? plate->hinge_count : 0;
    turns->item_row = fabric_pool_push( &plate->parts, (size_t)turns->item_count, sizeof( int32_t ) );
    if ( vertices->item_row == NULL || turns->item_row == NULL )
    {
        return false;
    }
    for ( int32_t v = 0; v < vertices->item_count; ++v )
    {
        vertices->item_row[v] = plate->slot_row != NULL ? plate->slot_row[v] : v;
    }
    for ( int32_t n = 0; n < turns->item_count; ++n )
    {
        turns->item_row[n] = plate->hinges[n].slot;
    }
    return true;
}

void plate_release_parts( wisp_plate* plate )
{
    fabric_pool_release( &plate->parts );
    plate->hinges = NULL;
}

bool plate_list_parts( wisp_plate* plate, const wisp_fabric* f )
{
    if ( plate->hinges != NULL )
    {
        return true;
    }
    fabric_pool *pool = &plate->parts, scratch = { .allocator = pool->allocator };
    const int rows = 8 * plate->vertices.slice_count, turns = 8 * plate->turns.slice_count;
    plate->hinges = fabric_pool_push( pool, (size_t)f->hinge_count, sizeof( plate_hinge ) );
    plate->triangle_hinge = fabric_pool_push( pool, (size_t)f->triangle_count, sizeof( plate->triangle_hinge[0] ) );
    plate->place = fabric_pool_push_zeroed( pool, (size_t)( rows > turns ? rows : turns ), sizeof( uint8_t ) );
    const bool done = plate->hinges != NULL && plate->triangle_hinge != NULL && plate->place != NULL &&
                      plate_cook_hinges( plate, f, &scratch ) && list_item_rows( plate, f );
    fabric_pool_release( &scratch );
    if ( done == false )
    {
        plate_release_parts( plate );
    }
    return done;
}

// Keep the rows of slots that are told. @return false if out of memory
static bool keep_slot_rows( wisp_plate* plate, const wisp_fabric* f, const int32_t* slot_row )
{
    int32_t* kept =
        slot_row != NULL ? fabric_pool_push( &plate->pool, (size_t)f->vertex_count, sizeof( int32_t ) ) : NULL;
    plate->slot_row = kept;
    if ( kept != NULL )
    {
        memcpy( kept, slot_row, (size_t)f->vertex_count * sizeof( int32_t ) );
    }
    return slot_row == NULL || kept != NULL;
}

static bool cook_plate( wisp_plate* plate, const wisp_fabric* f, const int32_t* slot_row, fabric_pool* scratch )
{
    plate->pinned = fabric_pool_push_zeroed( &plate->pool, (size_t)f->vertex_count, sizeof( uint8_t ) );
    return plate->pinned != NULL && keep_slot_rows( plate, f, slot_row ) && plate_list_parts( plate, f ) &&
           plate_cook_rows( plate, f, &plate->vertices, scratch ) &&
           ( plate->turns.of_hinges == false || cook_turns( plate, f, scratch ) );
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
    plate->parts = scratch;
    plate->fabric = fabric;
    atomic_init( &plate->owners, 1 );
    plate->vertices.slice_count = row_count / 8;
    plate->turns = ( plate_row_set ){ .of_hinges = with_turns,
                                      .slice_count = with_turns ? fabric->hinge_order.slot_count / 8 : 0 };
    const bool has_hinges =
        fabric->hinge_order.slot_count > 0 || wisp_fabric_need( fabric, WISP_FABRIC_HINGES ) == WISP_OK;
    const bool done = has_hinges && cook_plate( plate, fabric, slot_row, &scratch );
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
    if ( plate != NULL && atomic_fetch_sub( &plate->owners, 1 ) == 1 )
    {
        plate_release_parts( plate );
        fabric_pool pool = plate->pool; // the plate itself lies in it
        pool.allocator = allocator;
        fabric_pool_release( &pool );
    }
}

size_t wisp_plate_bytes( const wisp_plate* plate )
{
    return plate != NULL ? ( plate->pool.bytes + plate->parts.bytes ) / (size_t)plate->owners : 0;
}

wisp_plate_rows wisp_plate_get_rows( const wisp_plate* plate )
{
    return ( wisp_plate_rows ){
        .slice_count = plate->vertices.slice_count,
        .begin = plate->vertices.begin,
        .other_x4 = (const int32_t( * )[8])plate->vertices.other,
        .weight = (const float( * )[8])plate->vertices.weight,
        .near_x4 = ( const int16_t( * )[8] )(const void*)plate->vertices.near,
    };
}

wisp_plate_turns wisp_plate_get_turns( const wisp_plate* plate )
{
    return ( wisp_plate_turns ){
        .begin = plate->turns.begin,
        .other = (const int32_t( * )[8])plate->turns.other,
        .near = (const uint16_t( * )[8])plate->turns.near,
        .weight = (const float( * )[8])plate->turns.weight,
        .steepest = plate->steepest,
        .least_height = plate->least_height,
        .triangles = &plate->triangles,
        .corner_x4 = plate->corner_x4,
        .moment_of = plate->moment_of,
    };
}

float wisp_plate_max_rate( const wisp_plate* plate )
{
    return plate->max_rate;
}
