// The soup in patches of a few triangles that lie together at rest, or of a few segments of a strand. What is far away or stays
// near is told for all pieces of two patches at once.
#include "contact_internal.h"

#include <string.h>

enum
{
    PATCH_PIECES = 8, // triangles of a patch, or segments, or points that nothing has
};

// What the loops of this file share.
typedef struct cutting
{
    const contact_work* work;
    contact_soup* soup;
    int32_t* patch_of[3]; // [point], [edge], [triangle]; -1: none yet
    int32_t* order;       // [triangle] those of a patch behind each other
    float ( *middle )[3]; // [triangle] three times, at rest
    int patch_count;
} cutting;

static const int32_t* points_of( const contact_soup* s, int kind, const int32_t* piece )
{
    return kind == 0 ? piece : kind == 1 ? s->edges + 2 * (size_t)*piece : s->triangles + 3 * (size_t)*piece;
}

// ---- triangles ----

static int widest_axis( const cutting* c, int begin, int end )
{
    float width[3];
    for ( int k = 0; k < 3; ++k )
    {
        float low = INFINITY, high = -INFINITY;
        for ( int i = begin; i < end; ++i )
        {
            low = contact_smaller( low, c->middle[c->order[i]][k] );
            high = contact_larger( high, c->middle[c->order[i]][k] );
        }
        width[k] = high - low;
    }
    const int first = width[1] > width[0] ? 1 : 0;
    return width[2] > width[first] ? 2 : first;
}

// Equal ones in the order of their numbers, so that the cut is one.
static bool is_before( const cutting* c, int axis, int32_t a, int32_t b )
{
    const float p = c->middle[a][axis], q = c->middle[b][axis];
    return p < q || ( p == q && a < b );
}

// Put those in front that belong there, in any order (quickselect, Hoare).
static void part( const cutting* c, int axis, int begin, int middle, int end )
{
    int32_t* order = c->order;
    while ( end - begin > 1 )
    {
        const int32_t pivot = order[begin + ( end - begin ) / 2];
        int i = begin, k = end - 1;
        while ( i <= k )
        {
            for ( ; is_before( c, axis, order[i], pivot ); ++i )
            {
            }
            for ( ; is_before( c, axis, pivot, order[k] ); --k )
            {
            }
            if ( i <= k )
            {
                const int32_t moved = order[i];
                order[i++] = order[k];
                order[k--] = moved;
            }
        }
        if ( middle > k && middle < i )
        {
            return;
        }
        begin = middle >= i ? i : begin;
        end = middle >= i ? end : k + 1;
    }
}

// Halves of whole patches, so that all but one are full.
static void cut_triangles( cutting* c, int begin, int end )
{
    const int count = end - begin;
    if ( count <= PATCH_PIECES )
    {
        for ( int i = begin; i < end; ++i )
        {
            c->patch_of[2][c->order[i]] = c->patch_count;
        }
        c->patch_count += 1;
        return;
    }
    const int patches = ( count + PATCH_PIECES - 1 ) / PATCH_PIECES, middle = begin + patches / 2 * PATCH_PIECES;
    part( c, widest_axis( c, begin, end ), begin, middle, end );
    cut_triangles( c, begin, middle );
    cut_triangles( c, middle, end );
}

static void order_triangles( cutting* c, const contact_guest* guest )
{
    const contact_soup* s = c->soup;
    for ( int t = guest->first_triangle; t < guest->first_triangle + guest->triangle_count; ++t )
    {
        c->order[t] = t;
        for ( size_t k = 0; k < 3; ++k )
        {
            c->middle[t][k] = 0.0f;
            for ( size_t i = 0; i < 3; ++i )
            {
                c->middle[t][k] += s->rest[(size_t)s->triangles[3 * (size_t)t + i] * 4 + k];
            }
        }
    }
}

// ---- what belongs to them, and what does not ----

// Points and edges go to the first patch that has them.
static void follow_triangles( cutting* c, const contact_guest* guest )
{
    const contact_soup* s = c->soup;
    for ( int t = guest->first_triangle; t < guest->first_triangle + guest->triangle_count; ++t )
    {
        const int32_t* corner = s->triangles + 3 * (size_t)t;
        for ( int i = 0; i < 3; ++i )
        {
            const int a = corner[i], b = corner[( i + 1 ) % 3];
            const int edge = contact_find_edge( s, guest, a < b ? a : b, a < b ? b : a );
            c->patch_of[0][a] = c->patch_of[0][a] < 0 ? c->patch_of[2][t] : c->patch_of[0][a];
            c->patch_of[1][edge] = c->patch_of[1][edge] < 0 ? c->patch_of[2][t] : c->patch_of[1][edge];
        }
    }
}

// What no triangle has, as it comes: segments as long as they go on from each other.
static void cut_rest( cutting* c, const contact_guest* guest )
{
    const contact_soup* s = c->soup;
    int taken = PATCH_PIECES, last = -1;
    for ( int e = guest->first_edge; e < guest->first_edge + guest->edge_count; ++e )
    {
        const int32_t* points = s->edges + 2 * (size_t)e;
        if ( c->patch_of[1][e] >= 0 )
        {
            continue;
        }
        const bool goes_on = taken < PATCH_PIECES && points[0] == last;
        taken = goes_on ? taken + 1 : 1;
        c->patch_count += goes_on ? 0 : 1;
        c->patch_of[1][e] = c->patch_count - 1;
        for ( int i = 0; i < 2; ++i )
        {
            int32_t* of = c->patch_of[0] + points[i];
            *of = *of < 0 ? c->patch_count - 1 : *of;
        }
        last = points[1];
    }
    taken = PATCH_PIECES;
    for ( int p = guest->first_point; p < guest->first_point + guest->point_count; ++p )
    {
        if ( c->patch_of[0][p] < 0 )
        {
            taken = taken < PATCH_PIECES ? taken + 1 : 1;
            c->patch_count += taken == 1 ? 1 : 0;
            c->patch_of[0][p] = c->patch_count - 1;
        }
    }
}

// ---- patches ----

static bool reserve_patches( const cutting* c )
{
    contact_soup* s = c->soup;
    const size_t count = (size_t)s->patch_count;
    return contact_reserve( c->work, CONTACT_PATCHES, count * sizeof( *s->patches ), (void**)&s->patches ) &&
           contact_reserve( c->work, CONTACT_WAYS, count * sizeof( *s->ways ), (void**)&s->ways ) &&
           contact_reserve( c->work, CONTACT_WAYS_GONE, count * sizeof( *s->gone ), (void**)&s->gone ) &&
           contact_reserve( c->work, CONTACT_COURSES, count * sizeof( *s->courses ), (void**)&s->courses ) &&
           contact_reserve( c->work, CONTACT_PATCH_LATE, count, (void**)&s->patch_late ) &&
           contact_reserve( c->work, CONTACT_PATCH_PLACED, count, (void**)&s->is_placed ) &&
           contact_reserve( c->work, CONTACT_PATCH_ASKED, ( count + 1 ) * sizeof( int32_t ), (void**)&s->asked ) &&
           contact_reserve( c->work, CONTACT_PATCH_NORMALS, count * 3 * sizeof( float ),
                            (void**)&s->patch_normals ) &&
           contact_reserve( c->work, CONTACT_REACHED_BOXES, count * sizeof( *s->reached_boxes ),
                            (void**)&s->reached_boxes ) &&
           contact_reserve( c->work, CONTACT_PATCH_BOXES, count * sizeof( *s->patch_boxes ),
                            (void**)&s->patch_boxes );
}

// How many pieces of each kind a patch has: first as numbers of pieces, then as rows.
static int count_rows( const cutting* c, const int counts[3] )
{
    contact_soup* s = c->soup;
    memset( s->patches, 0, (size_t)s->patch_count * sizeof( *s->patches ) );
    for ( int kind = 0; kind < 3; ++kind )
    {
        for ( int i = 0; i < counts[kind]; ++i )
        {
            contact_patch* patch = s->patches + c->patch_of[kind][i];
            patch->rows[kind] += 1;
            patch->point_count += kind + 1; // at most
            patch->guest = (int32_t)s->rest[(size_t)points_of( s, kind, &i )[0] * 4 + 3];
        }
    }
    int rows = 0, points = 0;
    for ( int p = 0; p < s->patch_count; ++p )
    {
        contact_patch* patch = s->patches + p;
        patch->first_point = points;
        points += ( patch->point_count + WISP_SLICE - 1 ) / WISP_SLICE * WISP_SLICE;
        patch->point_count = 0;
        for ( int kind = 0; kind < 3; ++kind )
        {
            patch->kind_row[kind] = rows;
            patch->rows[kind] = ( patch->rows[kind] + WISP_SLICE - 1 ) / WISP_SLICE;
            rows += patch->rows[kind];
        }
    }
    return rows;
}

static void add_point( contact_soup* s, contact_patch* patch, int32_t point )
{
    int32_t* point4 = s->patch_points + patch->first_point;
    for ( int i = 0; i < patch->point_count; ++i )
    {
        if ( point4[i] == point * 4 )
        {
            return;
        }
    }
    point4[patch->point_count++] = point * 4;
}

static void repeat_last( contact_soup* s, contact_patch* patch )
{
    int32_t* point4 = s->patch_points + patch->first_point;
    const int32_t last = point4[patch->point_count - 1];
    while ( patch->point_count % WISP_SLICE != 0 )
    {
        point4[patch->point_count++] = last;
    }
}

static void add_piece( contact_soup* s, contact_patch* patch, int kind, int32_t piece )
{
    wisp_piece_row* row = s->pieces + patch->kind_row[kind];
    int lane = 0;
    for ( ; row->item[lane] >= 0; row += lane == WISP_SLICE - 1 ? 1 : 0, lane = ( lane + 1 ) % WISP_SLICE )
    {
    }
    const int32_t* points = points_of( s, kind, &piece );
    int32_t* const point4[3] = { row->point4[0], row->point4[1], row->third4 };
    row->item[lane] = piece;
    for ( int k = 0; k <= kind; ++k )
    {
        point4[k][lane] = points[k] * 4;
        add_point( s, patch, points[k] );
    }
}

// Which patches each point is in. @param most points of all patches, those that repeat included
static bool list_patches_of_points( const cutting* c, size_t most )
{
    contact_soup* s = c->soup;
    const size_t points = (size_t)s->point_count, number = sizeof( int32_t );
    if ( contact_reserve( c->work, CONTACT_PATCHES_BEGIN, ( points + 2 ) * number, (void**)&s->patches_begin ) ==
             false ||
         contact_reserve( c->work, CONTACT_PATCHES_OF, most * number, (void**)&s->patches_of ) == false )
    {
        return false;
    }
    // counted two places on, so that filling in leaves each where it begins
    int32_t* begin = s->patches_begin;
    memset( begin, 0, ( points + 2 ) * number );
    for ( int pass = 0; pass < 2; ++pass )
    {
        for ( int p = 0; p < s->patch_count; ++p )
        {
            const int32_t* point4 = s->patch_points + s->patches[p].first_point;
            for ( int i = 0; i < s->patches[p].point_count && ( i == 0 || point4[i] != point4[i - 1] ); ++i )
            {
                if ( pass == 0 )
                {
                    begin[point4[i] / 4 + 2] += 1;
                }
                else
                {
                    s->patches_of[begin[point4[i] / 4 + 1]++] = p;
                }
            }
        }
        for ( size_t i = 0; i < points && pass == 0; ++i )
        {
            begin[i + 2] += begin[i + 1];
        }
    }
    return true;
}

static bool fill_patches( const cutting* c, const int counts[3] )
{
    contact_soup* s = c->soup;
    s->patch_count = c->patch_count;
    if ( reserve_patches( c ) == false )
    {
        return false;
    }
    const size_t rows = (size_t)count_rows( c, counts );
    const size_t points = (size_t)counts[0] + 2 * (size_t)counts[1] + 3 * (size_t)counts[2] +
                          (size_t)WISP_SLICE * (size_t)s->patch_count;
    if ( contact_reserve( c->work, CONTACT_PIECE_ROWS, rows * sizeof( *s->pieces ), (void**)&s->pieces ) == false ||
         contact_reserve( c->work, CONTACT_PATCH_POINTS, points * sizeof( int32_t ), (void**)&s->patch_points ) ==
             false )
    {
        return false;
    }
    memset( s->courses, 0, (size_t)s->patch_count * sizeof( *s->courses ) );
    memset( s->gone, 0, (size_t)s->patch_count * sizeof( *s->gone ) );
    memset( s->pieces, 0, rows * sizeof( *s->pieces ) );
    for ( size_t row = 0; row < rows; ++row )
    {
        memset( s->pieces[row].item, -1, sizeof( s->pieces[row].item ) );
    }
    for ( int kind = 0; kind < 3; ++kind )
    {
        for ( int i = 0; i < counts[kind]; ++i )
        {
            add_piece( s, s->patches + c->patch_of[kind][i], kind, i );
        }
    }
    for ( int p = 0; p < s->patch_count; ++p )
    {
        repeat_last( s, s->patches + p );
    }
    return list_patches_of_points( c, points );
}

bool contact_make_patches( const contact_work* work )
{
    contact_soup* s = work->soup;
    const int counts[3] = { s->point_count, s->edge_count, s->triangle_count };
    const size_t triangles = (size_t)counts[2], numbers = (size_t)counts[1] + 2 * triangles + 1;
    cutting c = { .work = work, .soup = s };
    int32_t* scratch = wisp_parallel_scratch( work->parallel, work->worker,
                                              numbers * sizeof( int32_t ) + triangles * sizeof( *c.middle ) );
    if ( scratch == NULL || contact_reserve( work, CONTACT_PATCH_OF, (size_t)counts[0] * sizeof( int32_t ),
                                             (void**)&s->patch_of ) == false )
    {
        return false;
    }
    c.patch_of[0] = s->patch_of;
    c.patch_of[1] = scratch;
    c.patch_of[2] = scratch + counts[1];
    c.order = c.patch_of[2] + triangles;
    c.middle = ( float( * )[3] )(void*)( c.order + triangles );
    memset( s->patch_of, -1, (size_t)counts[0] * sizeof( int32_t ) );
    memset( scratch, -1, numbers * sizeof( int32_t ) );
    for ( int g = 0; g < work->state->guest_count; ++g )
    {
        const contact_guest* guest = work->state->guests + g;
        order_triangles( &c, guest );
        if ( guest->triangle_count > 0 )
        {
            cut_triangles( &c, guest->first_triangle, guest->first_triangle + guest->triangle_count );
        }
        follow_triangles( &c, guest );
        cut_rest( &c, guest );
    }
    return fill_patches( &c, counts );
}
