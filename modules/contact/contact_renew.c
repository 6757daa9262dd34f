// Points that go farther astray than their reach get a new course, and their pairs are looked for again: mostly there are a
// few of them, and all the others' boxes hold.
#include "contact_internal.h"

#include <string.h>

enum
{
    POINTS_SHARE = 64, // one point of so many may be renewed at once
    KEPT_SHARE = 16,   // and one piece of so many before all are looked for
    OVERLAPS_MOST = 1024,
};

typedef enum piece_type
{
    POINTS,
    EDGES,
    TRIANGLES,
    TYPE_COUNT,
} piece_type;

typedef int keep_fn( const contact_work* work, int asker, int32_t* items, int count );

// Pieces of a type that ask again.
typedef struct asking
{
    const contact_work* work;
    const contact_renewed* renewed;
    int first; // of the renewed: those before were renewed earlier
    keep_fn* keep;
} asking;

static bool make_room( const contact_work* work )
{
    contact_soup* s = work->soup;
    const size_t counts[TYPE_COUNT] = { (size_t)s->point_count, (size_t)s->edge_count, (size_t)s->triangle_count };
    const size_t each = sizeof( wisp_box ) + sizeof( int32_t );
    size_t total = 0;
    for ( int type = 0; type < TYPE_COUNT; ++type )
    {
        total += counts[type] / KEPT_SHARE + 1;
    }
    char* room;
    if ( contact_reserve( work, CONTACT_RENEWED, total * each, (void**)&room ) == false )
    {
        return false;
    }
    wisp_box* boxes = (wisp_box*)room;
    int32_t* items = (int32_t*)( boxes + total );
    for ( int type = 0; type < TYPE_COUNT; ++type )
    {
        s->renewed[type].boxes = boxes;
        s->renewed[type].items = items;
        s->renewed[type].most = (int)( counts[type] / KEPT_SHARE );
        boxes += counts[type] / KEPT_SHARE + 1;
        items += counts[type] / KEPT_SHARE + 1;
    }
    return true;
}

static void add_renewed( const contact_work* work, piece_type type, int item, const int32_t* points, int count,
                         float reach )
{
    contact_renewed* r = work->soup->renewed + type;
    if ( r->count < r->most )
    {
        r->items[r->count] = item;
        r->boxes[r->count] = contact_box_around( work, points, count, reach );
    }
    r->count += 1;
}

static int count_astray( const contact_soup* s )
{
    int count = 0;
    for ( int p = 0; p < s->point_count; ++p )
    {
        count += contact_is_beyond( s, p ) ? 1 : 0;
    }
    return count;
}

// Give them courses, and all pieces that they are points of. @return false if they are too many
static bool renew_courses( const contact_work* work )
{
    contact_soup* s = work->soup;
    uint8_t* marks = wisp_parallel_scratch( work->parallel, work->worker, (size_t)s->point_count + 1 );
    if ( marks == NULL )
    {
        return false;
    }
    for ( int p = 0; p < s->point_count; ++p )
    {
        marks[p] = contact_is_beyond( s, p ) ? 1 : 0;
    }
    for ( int p = 0; p < s->point_count; ++p )
    {
        if ( marks[p] != 0 )
        {
            contact_set_course( work, p );
            add_renewed( work, POINTS, p, &p, 1, s->reach[p] );
        }
    }
    for ( int e = 0; e < s->edge_count; ++e )
    {
        const int32_t* points = s->edges + (size_t)e * 2;
        if ( ( marks[points[0]] | marks[points[1]] ) != 0 )
        {
            contact_take_course( s, points, 2, s->edge_drift + (size_t)e * 4, s->edge_reach + e );
            add_renewed( work, EDGES, e, points, 2, s->edge_reach[e] );
        }
    }
    for ( int t = 0; t < s->triangle_count; ++t )
    {
        const int32_t* points = s->triangles + (size_t)t * 3;
        if ( ( marks[points[0]] | marks[points[1]] | marks[points[2]] ) != 0 )
        {
            contact_take_course( s, points, 3, s->triangle_drift + (size_t)t * 4, s->triangle_reach + t );
            add_renewed( work, TRIANGLES, t, points, 3, s->triangle_reach[t] );
        }
    }
    bool fits = true;
    for ( int type = 0; type < TYPE_COUNT; ++type )
    {
        fits = fits && s->renewed[type].count <= s->renewed[type].most;
    }
    return fits;
}

// ---- whom they may meet ----

static int filter( const void* context, int asker, int32_t* items, int count )
{
    const asking* a = context;
    return a->keep( a->work, a->renewed->items[a->first + asker], items, count );
}

// Ask what is searched already. @return false if the list has no room for what is found
static bool ask_again( const asking* a, wisp_box_pairs* pairs, const wisp_box* boxes, int count, bool again,
                       contact_kind kind, bool turned, wisp_status* status, wisp_error* error )
{
    const contact_list* list = a->work->soup->lists + kind;
    const wisp_box_job job = {
        .askers = a->renewed->boxes + a->first,
        .asker_count = a->renewed->count - a->first,
        .boxes = boxes,
        .box_count = count,
        .again = again,
        .search = a->work->state->world.search,
        .kernels = wisp_frame_kernels( a->work->frame ),
        .filter = filter,
        .filter_context = a,
    };
    *status = wisp_box_pairs_find( pairs, a->work->parallel, &job, error );
    const bool fits = *status == WISP_OK && pairs->pair_count <= (size_t)( list->most - list->count );
    if ( fits )
    {
        contact_fill_list( a->work, kind, pairs, a->renewed->items + a->first, turned );
    }
    return fits;
}

// Ask those whose boxes are no longer what was searched. @return false if the list has no room
static bool ask_renewed( const asking* a, const contact_renewed* others, contact_kind kind, bool turned )
{
    const contact_list* list = a->work->soup->lists + kind;
    for ( int i = a->first; i < a->renewed->count; ++i )
    {
        const int32_t asker = a->renewed->items[i];
        int32_t items[OVERLAPS_MOST];
        int count = 0;
        for ( int k = 0; k < others->count; ++k )
        {
            if ( wisp_box_overlaps( a->renewed->boxes + i, others->boxes + k ) )
            {
                if ( count == OVERLAPS_MOST )
                {
                    return false;
                }
                items[count++] = others->items[k];
            }
        }
        count = a->keep( a->work, asker, items, count );
        const int32_t begin[2] = { 0, count };
        const wisp_box_pairs pairs = { .asker_count = 1, .pair_count = (size_t)count, .begin = begin, .item = items };
        if ( count > list->most - list->count )
        {
            return false;
        }
        contact_fill_list( a->work, kind, &pairs, &asker, turned );
    }
    return true;
}

static bool ask_all( const contact_work* work, const int first[TYPE_COUNT], wisp_status* status, wisp_error* error )
{
    contact_soup* s = work->soup;
    const contact_renewed* r = s->renewed;
    const asking points = { work, r + POINTS, first[POINTS], contact_keep_triangles };
    const asking triangles = { work, r + TRIANGLES, first[TRIANGLES], contact_keep_points };
    const asking edges = { work, r + EDGES, first[EDGES], contact_keep_edges };
    const bool has_grid = s->has_point_grid;
    s->has_point_grid = true;
    return ask_again( &points, &s->point_pairs, s->triangle_boxes, s->triangle_count, true, CONTACT_LATE_POINTS,
                      false, status, error ) &&
           ask_again( &triangles, &s->triangle_pairs, s->point_boxes, s->point_count, has_grid, CONTACT_LATE_POINTS,
                      true, status, error ) &&
           ask_again( &edges, &s->edge_pairs, s->edge_boxes, s->edge_count, true, CONTACT_LATE_EDGES, false, status,
                      error ) &&
           ask_renewed( &points, r + TRIANGLES, CONTACT_LATE_POINTS, false ) &&
           ask_renewed( &triangles, r + POINTS, CONTACT_LATE_POINTS, true ) &&
           ask_renewed( &edges, r + EDGES, CONTACT_LATE_EDGES, false );
}

wisp_status contact_renew( const contact_work* work, bool* done, wisp_error* error )
{
    contact_soup* s = work->soup;
    *done = false;
    const bool is_first = s->renewed[POINTS].count == 0;
    if ( work->state->world.features == WISP_CONTACT_SAMPLES ||
         count_astray( s ) > s->point_count / POINTS_SHARE + 1 || ( is_first && make_room( work ) == false ) )
    {
        return WISP_OK;
    }
    const int first[TYPE_COUNT] = { s->renewed[POINTS].count, s->renewed[EDGES].count, s->renewed[TRIANGLES].count };
    wisp_status status = WISP_OK;
    *done = renew_courses( work ) && ask_all( work, first, &status, error );
    s->renewals += *done ? 1 : 0;
    return status;
}
