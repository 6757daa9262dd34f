// Which vertices and hinges of a plate act on each other: the entries of the rows of its matrices.
#include "plate_parts.h"

#include <stdlib.h>
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
        p->of_vertex[edge][find_or_add( p->vertex, &p->vertex_count, corner[k] )] += factor * h->row[k];
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
        double share[PLATE_STENCIL];
        plate_share_turn( plate, f, h, share );
        for ( int s = 0; s < PLATE_STENCIL; ++s )
        {
            const double other = ( s == 0 ? 1.0 : 0.0 ) - share[s];
            if ( h->stencil[s] >= 0 && ( s == 0 || h->fitted[s] != 0.0 ) )
            {
                add_jump( &p, edge, plate, f, h->stencil[s], h->triangle[0] == triangle ? share[s] : other );
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
    unsigned of_edge[3]; // bits of the items that the turn at an edge depends on
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
        if ( h->row[k] != 0.0 )
        {
            add_member( p, edge, plate_corners( f, h )[k] );
        }
    }
}

static patch_members members_of( const wisp_plate* plate, const wisp_fabric* f, int32_t triangle, bool of_hinges )
{
    patch_members p = { .count = 0 };
    for ( int edge = 0; edge < 3; ++edge )
    {
        const int32_t hinge = plate->triangle_hinge[triangle][edge];
        const plate_hinge* h = hinge >= 0 ? plate->hinges + hinge : NULL;
        for ( int s = 0; s < PLATE_STENCIL && h != NULL; ++s )
        {
            if ( h->stencil[s] >= 0 && ( s == 0 || h->fitted[s] != 0.0 ) )
            {
                add_hinge( &p, edge, plate, f, h->stencil[s], of_hinges );
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
    uint8_t* common;   // [triangle_count] bit of an edge: its turn has energy in common with that of the next edge
} patch_lists;

static uint8_t* list_common_energy( const wisp_plate* plate, const wisp_fabric* f, fabric_pool* scratch )
{
    uint8_t* common = fabric_pool_push_zeroed( scratch, (size_t)f->triangle_count, sizeof( uint8_t ) );
    for ( int32_t t = 0; t < f->triangle_count && common != NULL; ++t )
    {
        double m[3][3];
        plate_turn_energy( plate, f, t, m );
        for ( int edge = 0; edge < 3; ++edge )
        {
            common[t] |= (uint8_t)( ( m[edge][( edge + 1 ) % 3] != 0.0 ? 1 : 0 ) << edge );
        }
    }
    return common;
}

static bool list_patches( const wisp_plate* plate, const wisp_fabric* f, const plate_row_set* set,
                          fabric_pool* scratch, patch_lists* out )
{
    const size_t count = (size_t)set->item_count;
    out->begin = fabric_pool_push_zeroed( scratch, count + 2, sizeof( int32_t ) );
    out->triangle = fabric_pool_push( scratch, PLATE_PATCH * (size_t)f->triangle_count, sizeof( int32_t ) );
    out->mark = fabric_pool_push( scratch, count, sizeof( int32_t ) );
    out->found = fabric_pool_push( scratch, count, sizeof( int32_t ) );
    out->common = list_common_energy( plate, f, scratch );
    if ( out->begin == NULL || out->triangle == NULL || out->mark == NULL || out->found == NULL ||
         out->common == NULL )
    {
        return false;
    }
    for ( int pass = 0; pass < 2; ++pass )
    {
        for ( int32_t t = 0; t < f->triangle_count; ++t )
        {
            const patch_members p = members_of( plate, f, t, set->of_hinges );
            for ( int i = 0; i < p.count; ++i )
            {
                // first the counts, two places ahead; then each place moves to its end, where the next one begins
                int32_t* place = out->begin + p.item[i] + ( pass == 0 ? 2 : 1 );
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

// Bits of the members of a patch that act on one of them.
static unsigned find_acting( const patch_members* p, int32_t item, unsigned common )
{
    unsigned acting = 0;
    for ( int edge = 0; edge < 3; ++edge )
    {
        const int next = ( edge + 1 ) % 3, before = ( edge + 2 ) % 3;
        for ( int i = 0; i < p->count; ++i )
        {
            if ( p->item[i] == item && ( p->of_edge[edge] >> i & 1 ) != 0 )
            {
                acting |= p->of_edge[edge] | ( ( common >> edge & 1 ) != 0 ? p->of_edge[next] : 0 ) |
                          ( ( common >> before & 1 ) != 0 ? p->of_edge[before] : 0 );
            }
        }
    }
    return acting;
}

// Items of a row in ascending order; a vertex is not in its own row, whose diagonal follows from the others. @return their
// number
static int merge_row( const wisp_plate* plate, const wisp_fabric* f, const plate_row_set* set,
                      const patch_lists* lists, int32_t item )
{
    int count = 0;
    lists->mark[item] = set->of_hinges ? -1 : item;
    for ( int32_t at = lists->begin[item]; at < lists->begin[item + 1]; ++at )
    {
        const patch_members p = members_of( plate, f, lists->triangle[at], set->of_hinges );
        const unsigned acting = find_acting( &p, item, lists->common[lists->triangle[at]] );
        for ( int i = 0; i < p.count; ++i )
        {
            if ( ( acting >> i & 1 ) != 0 && lists->mark[p.item[i]] != item )
            {
                lists->mark[p.item[i]] = item;
                lists->found[count++] = p.item[i];
            }
        }
    }
    qsort( lists->found, (size_t)count, sizeof( int32_t ), compare_items );
    return count;
}

static void clear_marks( const plate_row_set* set, const patch_lists* lists )
{
    memset( lists->mark, -1, (size_t)set->item_count * sizeof( int32_t ) );
}

static void write_rows( const wisp_plate* plate, const wisp_fabric* f, plate_row_set* set, const patch_lists* lists )
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
        const int length = merge_row( plate, f, set, lists, item );
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
        const int length = merge_row( plate, f, set, &lists, item );
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
    write_rows( plate, f, set, &lists );
    return true;
}
