// Pairs of the points that spent their reach, while all others have some left. Boxes are where each point was searched, so a
// list that is renewed in part is the one that a search of all would find.
#include "contact_internal.h"

#include <stdlib.h>
#include <string.h>

// What is asked: points, edges and triangles that have a renewed point.
typedef struct renewed_pieces
{
    int32_t *points, *edges, *triangles;
    wisp_box *point_boxes, *edge_boxes, *triangle_boxes;
    int point_count, edge_count, triangle_count;
} renewed_pieces;

// ---- what is asked ----

static bool has_renewed( const contact_soup* s, const int32_t* points, int count )
{
    bool any = false;
    for ( int i = 0; i < count; ++i )
    {
        any = any || s->renewed[points[i]] != 0;
    }
    return any;
}

// Lists the pieces of so many points each that have a renewed one, with new boxes.
static int list_pieces( const contact_work* work, const int32_t* corners, int size, int count, wisp_box* boxes,
                        int32_t* list, wisp_box* asked )
{
    int listed = 0;
    for ( int i = 0; i < count; ++i )
    {
        const int32_t* points = corners + (size_t)size * (size_t)i;
        if ( has_renewed( work->soup, points, size ) )
        {
            boxes[i] = asked[listed] = contact_box_around( work, points, size );
            list[listed++] = i;
        }
    }
    return listed;
}

static renewed_pieces list_renewed( const contact_work* work )
{
    contact_soup* s = work->soup;
    renewed_pieces r = { .points = s->renewed_list, .point_boxes = s->renewed_boxes };
    for ( int32_t p = 0; p < s->point_count; ++p )
    {
        if ( s->renewed[p] != 0 )
        {
            s->point_boxes[p] = r.point_boxes[r.point_count] = contact_box_around( work, &p, 1 );
            r.points[r.point_count++] = p;
        }
    }
    r.edges = r.points + r.point_count;
    r.edge_boxes = r.point_boxes + r.point_count;
    r.edge_count = list_pieces( work, s->edges, 2, s->edge_count, s->edge_boxes, r.edges, r.edge_boxes );
    r.triangles = r.edges + r.edge_count;
    r.triangle_boxes = r.edge_boxes + r.edge_count;
    r.triangle_count =
        list_pieces( work, s->triangles, 3, s->triangle_count, s->triangle_boxes, r.triangles, r.triangle_boxes );
    return r;
}

static wisp_status find_pairs( const contact_work* work, const renewed_pieces* r, wisp_error* error )
{
    contact_soup* s = work->soup;
    const struct
    {
        const wisp_box *askers, *boxes;
        int asker_count, box_count;
    } jobs[3] = {
        { r->point_boxes, s->triangle_boxes, r->point_count, s->triangle_count },
        { r->triangle_boxes, s->point_boxes, r->triangle_count, s->point_count },
        { r->edge_boxes, s->edge_boxes, r->edge_count, s->edge_count },
    };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < 3 && status == WISP_OK; ++i )
    {
        const wisp_box_job job = {
            .askers = jobs[i].askers,
            .asker_count = jobs[i].asker_count,
            .boxes = jobs[i].boxes,
            .box_count = jobs[i].box_count,
            .search = work->state->world.search,
            .kernels = wisp_frame_kernels( work->frame ),
        };
        status = wisp_box_pairs_find( s->renewed_pairs + i, work->parallel, &job, error );
    }
    return status;
}

// ---- the new candidates ----

static contact_candidate* put( contact_candidate* next, int a, int b, float gap )
{
    *next = ( contact_candidate ){ .a = a, .b = b, .gap = gap, .due = -INFINITY };
    return next + ( gap > 0.0f ? 1 : 0 ); // what keeps no gap is written over
}

// What two renewed pieces both find is taken from one of them.
static contact_candidate* put_points( const contact_work* work, const renewed_pieces* r, contact_candidate* next )
{
    const contact_soup* s = work->soup;
    const wisp_box_pairs *of_points = s->renewed_pairs, *of_triangles = s->renewed_pairs + 1;
    for ( int i = 0; i < r->point_count; ++i )
    {
        for ( int k = of_points->begin[i]; k < of_points->begin[i + 1]; ++k )
        {
            const int point = r->points[i], triangle = of_points->item[k];
            next = put( next, point, triangle, contact_point_gap( work, point, triangle ) );
        }
    }
    for ( int i = 0; i < r->triangle_count; ++i )
    {
        for ( int k = of_triangles->begin[i]; k < of_triangles->begin[i + 1]; ++k )
        {
            const int point = of_triangles->item[k], triangle = r->triangles[i];
            const bool is_found = s->renewed[point] != 0;
            next = put( next, point, triangle, is_found ? 0.0f : contact_point_gap( work, point, triangle ) );
        }
    }
    return next;
}

static contact_candidate* put_edges( const contact_work* work, const renewed_pieces* r, contact_candidate* next )
{
    const contact_soup* s = work->soup;
    const wisp_box_pairs* pairs = s->renewed_pairs + 2;
    for ( int i = 0; i < r->edge_count; ++i )
    {
        for ( int k = pairs->begin[i]; k < pairs->begin[i + 1]; ++k )
        {
            const int edge = r->edges[i], other = pairs->item[k], low = edge < other ? edge : other;
            const bool is_found = other <= edge && has_renewed( s, s->edges + 2 * (size_t)other, 2 );
            next = put( next, low, edge + other - low, is_found ? 0.0f : contact_edge_gap( work, edge, other ) );
        }
    }
    return next;
}

static int by_pieces( const void* left, const void* right )
{
    const contact_candidate *a = left, *b = right;
    return a->a != b->a ? ( a->a > b->a ) - ( a->a < b->a ) : ( a->b > b->b ) - ( a->b < b->b );
}

// Those that have a gap to keep, in order.
static contact_candidate* put_in_order( contact_candidate* begin, contact_candidate* end )
{
    contact_candidate* kept = begin;
    for ( const contact_candidate* c = begin; c < end; ++c )
    {
        *kept = *c;
        kept += c->gap > 0.0f ? 1 : 0;
    }
    qsort( begin, (size_t)( kept - begin ), sizeof( contact_candidate ), by_pieces );
    return kept;
}

// ---- old and new in one list ----

typedef struct candidate_range
{
    const contact_candidate *next, *end;
} candidate_range;

static bool is_renewed( const contact_soup* s, const contact_candidate* c, bool is_edge )
{
    return is_edge
               ? has_renewed( s, s->edges + 2 * (size_t)c->a, 2 ) || has_renewed( s, s->edges + 2 * (size_t)c->b, 2 )
               : s->renewed[c->a] != 0 || has_renewed( s, s->triangles + 3 * (size_t)c->b, 3 );
}

// Old candidates without a renewed point, and new ones, in their order.
static contact_candidate* merge( const contact_soup* s, candidate_range old, candidate_range fresh, bool are_edges,
                                 contact_candidate* out )
{
    for ( ;; )
    {
        while ( old.next < old.end && is_renewed( s, old.next, are_edges ) )
        {
            old.next += 1;
        }
        if ( old.next == old.end && fresh.next == fresh.end )
        {
            return out;
        }
        const bool is_old =
            fresh.next == fresh.end || ( old.next < old.end && by_pieces( old.next, fresh.next ) < 0 );
        *out++ = is_old ? *old.next++ : *fresh.next++;
    }
}

// What is new is looked at in a list of its own, behind the place where both are joined.
static bool join( const contact_work* work, const renewed_pieces* r )
{
    contact_soup* s = work->soup;
    contact_candidate *old = s->candidates, *both;
    const int old_count = s->candidate_count, old_split = s->candidate_split;
    size_t found = 0;
    for ( int i = 0; i < 3; ++i )
    {
        found += s->renewed_pairs[i].pair_count;
    }
    const size_t most = (size_t)old_count + found, size = sizeof( contact_candidate );
    if ( most + found > INT32_MAX / 2 ||
         contact_reserve( work, CONTACT_JOINED, ( most + found + 1 ) * size, (void**)&both ) == false )
    {
        return false;
    }
    contact_candidate* fresh = both + most;
    contact_candidate* split = put_points( work, r, fresh );
    contact_candidate* end = put_edges( work, r, split );
    s->candidates = fresh;
    contact_check_candidates( work, 0, (int)( split - fresh ), false );
    contact_check_candidates( work, (int)( split - fresh ), (int)( end - split ), true );
    const candidate_range points = { fresh, put_in_order( fresh, split ) },
                          edges = { split, put_in_order( split, end ) };
    contact_candidate* middle = merge( s, ( candidate_range ){ old, old + old_split }, points, false, both );
    end = merge( s, ( candidate_range ){ old + old_split, old + old_count }, edges, true, middle );
    s->candidate_split = (int)( middle - both );
    s->candidate_count = (int)( end - both );
    const size_t bytes = (size_t)s->candidate_count * size;
    if ( contact_reserve( work, CONTACT_CANDIDATES, bytes, (void**)&s->candidates ) == false )
    {
        return false;
    }
    memcpy( s->candidates, both, bytes );
    return contact_make_blocks( work );
}

wisp_status contact_renew_pairs( const contact_work* work, wisp_error* error )
{
    const renewed_pieces r = list_renewed( work );
    wisp_status status = find_pairs( work, &r, error );
    if ( status == WISP_OK && join( work, &r ) == false )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the candidates of %d points", r.point_count );
    }
    work->soup->candidate_count = status == WISP_OK ? work->soup->candidate_count : -1;
    return status;
}
