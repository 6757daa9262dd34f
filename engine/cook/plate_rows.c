// Which vertices and hinges of a plate act on each other: the entries of the rows of its matrices.
#include "plate_parts.h"

#include <string.h>

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

static void add_jump( plate_patch* p, int edge, const wisp_plate* plate, const wisp_fabric* f, int32_t hinge,
                      double factor )
{
    const plate_hinge* h = plate->hinges + hinge;
    const int32_t* corner = plate_corners( f, h );
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
                add_jump( &p, edge, plate, f, stencil[s], h->triangle[0] == triangle ? share[s] : other );
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
static void add_hinge( patch_members* p, int edge, const wisp_plate* plate, const wisp_fabric* f, int32_t hinge,
                       bool of_hinges )
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
            add_member( p, edge, plate_corners( f, h )[k] );
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
                add_hinge( &p, edge, plate, f, stencil[s], of_hinges );
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

bool plate_cook_rows( wisp_plate* plate, const wisp_fabric* f, plate_row_set* set, fabric_pool* scratch )
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
    set->other = fabric_pool_push( &plate->pool, entries, sizeof( set->other[0] ) );
    set->weight = fabric_pool_push_zeroed( &plate->pool, entries, sizeof( set->weight[0] ) );
    if ( set->other == NULL || set->weight == NULL )
    {
        return false;
    }
    clear_marks( set, &lists );
    write_rows( set, &lists );
    return true;
}
