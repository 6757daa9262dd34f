// Active pairs: the last test before a pair of primitives becomes a constraint. In: listed pairs that may reach their
// gap in this substep. Out: those that may come to it wherever their points go within their tolerance.
//
// A pair is active if its distance at the intersection-free positions is less than its gap and the most that two of
// its points may approach each other. The test looks at the state alone, so results do not depend on what found the
// pair. Within a participant the gap is at most 0.9 of the distance at rest, so that nothing presses at rest. Pairs
// around an intersection are dropped, because no side of their plane is right.
//
// Each closest point has one pair. On an edge or a corner it belongs to the triangle that owns this (clusters.h); the
// pairs of its neighbours, and of edges that meet in an end, repeat it. Repeats that the substep may bring within half
// the gap stay, so that nothing passes between the planes of the owners. All of them stay where something intersects,
// since an owner there may be dropped as tangled, and on surfaces that another module solves for: with one pair each,
// piles of implicit cloth tremble twice as much.
#include "primitive_pairs.h"

#include "clusters.h"
#include "predicted_motion.h"
#include "untangling.h"

#include <stdatomic.h>
#include <string.h>

// ---- a batch ----

static void swap_where( bool swapped, int32_t* a, int32_t* b )
{
    const int32_t was = *a, other = *b;
    *a = swapped ? other : was;
    *b = swapped ? was : other;
}

// Put the edge with the smaller index first.
static void put_less_first( contact_batch* batch )
{
    for ( int i = 0; i < batch->count; ++i )
    {
        const bool swapped = batch->second[i] < batch->first[i];
        swap_where( swapped, batch->first + i, batch->second + i );
        swap_where( swapped, batch->point_x4[0] + i, batch->point_x4[2] + i );
        swap_where( swapped, batch->point_x4[1] + i, batch->point_x4[3] + i );
    }
}

// Repeat the last pair up to a multiple of eight.
static int pad_to_eight( int32_t* const point_x4[4], int count )
{
    for ( ; count % WISP_SLICE != 0; ++count )
    {
        for ( int k = 0; k < 4; ++k )
        {
            point_x4[k][count] = point_x4[k][count - 1];
        }
    }
    return count;
}

void contact_measure_batch( const contact_work* work, contact_kind kind, contact_batch* batch )
{
    const wisp_kernels* kernels = wisp_frame_kernels( work->frame );
    if ( kind == CONTACT_EDGES )
    {
        put_less_first( batch );
    }
    int32_t* const points[4] = { batch->point_x4[0], batch->point_x4[1], batch->point_x4[2], batch->point_x4[3] };
    const wisp_closest_args args = {
        .xyzw = work->contact_mesh->intersection_free,
        .point_x4 = { points[0], points[1], points[2], points[3] },
        .distance = batch->distance,
    };
    const int groups = pad_to_eight( points, batch->count ) / WISP_SLICE;
    ( kind == CONTACT_EDGES ? kernels->closest_segments : kernels->closest_triangle )( &args, 0, groups );
}

// Move the pairs in `selected` to the front.
static void compact( contact_batch* batch, int count )
{
    int same = 0;
    for ( ; same < count && batch->selected[same] == same; ++same )
    {
    }
    for ( int i = same; i < count; ++i )
    {
        const int from = batch->selected[i];
        batch->first[i] = batch->first[from];
        batch->second[i] = batch->second[from];
        batch->of[i] = batch->of[from];
        batch->gap[i] = batch->gap[from];
        batch->distance[i] = batch->distance[from];
        batch->closing[i] = batch->closing[from];
        for ( int k = 0; k < 4; ++k )
        {
            batch->point_x4[k][i] = batch->point_x4[k][from];
        }
    }
    batch->count = count;
}

// ---- the test ----

// Return whether both sides of a pair of one kind have a point of an intersection.
static bool is_tangled( const contact_work* work, contact_kind kind, const int32_t* const point_x4[4], int i )
{
    const int split = kind == CONTACT_EDGES ? 2 : 1;
    bool sides[2] = { false, false };
    for ( int k = 0; k < 4; ++k )
    {
        sides[k >= split] =
            sides[k >= split] || work->contact_mesh->intersections->is_tangled[point_x4[k][i] / 4] != 0;
    }
    return sides[0] && sides[1];
}

// Compute the most that the sides of each pair may approach each other in this substep.
static void find_closings( const contact_work* work, contact_kind kind, int32_t* const point_x4[4], int count,
                           float* closing )
{
    const wisp_approach_args args = {
        .predicted = work->contact_mesh->motion->ahead,
        .point_x4 = { point_x4[0], point_x4[1], point_x4[2], point_x4[3] },
        .are_edges = kind == CONTACT_EDGES,
        .max_approach = closing,
    };
    wisp_frame_kernels( work->frame )->max_approach( &args, 0, pad_to_eight( point_x4, count ) );
}

// Pairs at no distance have no plane between them; only coincident.c can use them.
static bool may_meet( const contact_contact_mesh* s, float distance, float gap, float closing )
{
    return gap > 0.0f && ( distance > 0.0f || s->is_parting ) && distance < gap + closing;
}

// ---- rest distances ----

// Return whether the boxes around the two sides of a pair are nearer than a distance.
static bool boxes_are_within( const float* xyzw, const contact_batch* batch, int i, int split, float distance )
{
    bool within = true;
    for ( int k = 0; k < 3 && within; ++k )
    {
        float lower[2] = { INFINITY, INFINITY }, upper[2] = { -INFINITY, -INFINITY };
        for ( int p = 0; p < 4; ++p )
        {
            const float x = xyzw[batch->point_x4[p][i] + k];
            lower[p >= split] = contact_smaller( lower[p >= split], x );
            upper[p >= split] = contact_larger( upper[p >= split], x );
        }
        within = lower[0] - upper[1] < distance && lower[1] - upper[0] < distance;
    }
    return within;
}

// Lower the gap of pairs within a participant that are closer at rest.
static void thin_gaps( const contact_work* work, contact_kind kind, contact_batch* batch )
{
    static const float REST_FRACTION = 0.9f; // of the rest distance
    const contact_contact_mesh* s = work->contact_mesh;
    contact_primitives primitives;
    primitives.are_edges = kind == CONTACT_EDGES;
    for ( int next = 0; next < batch->count; )
    {
        int thin[CONTACT_BATCH], thin_count = 0;
        for ( ; next < batch->count && thin_count < CONTACT_BATCH; ++next )
        {
            const bool is_own = s->rest[batch->point_x4[0][next] + 3] == s->rest[batch->point_x4[3][next] + 3];
            if ( is_own &&
                 boxes_are_within( s->rest, batch, next, kind == CONTACT_EDGES ? 2 : 1, 2.0f * batch->gap[next] ) )
            {
                for ( int k = 0; k < 4; ++k )
                {
                    primitives.point_x4[k][thin_count] = batch->point_x4[k][next];
                }
                thin[thin_count++] = next;
            }
        }
        const float* distance = contact_measure_primitives( work, s->rest, &primitives, thin_count, NULL, NULL );
        for ( int i = 0; i < thin_count; ++i )
        {
            batch->gap[thin[i]] = contact_smaller( batch->gap[thin[i]], REST_FRACTION * distance[i] );
        }
    }
}

void contact_keep_near( const contact_work* work, contact_kind kind, contact_batch* batch, int selected,
                        const bool* is_brief )
{
    compact( batch, selected );
    int32_t* const points[4] = { batch->point_x4[0], batch->point_x4[1], batch->point_x4[2], batch->point_x4[3] };
    find_closings( work, kind, points, selected, batch->closing );
    for ( int pass = 0; pass < 2; ++pass )
    {
        const bool may_tangle = pass == 0 && work->memory->tangled != 0;
        int kept = 0;
        for ( int i = 0; i < batch->count; ++i )
        {
            const bool is_active =
                may_meet( work->contact_mesh, batch->distance[i], batch->gap[i], batch->closing[i] ) &&
                ( may_tangle && is_tangled( work, kind, (const int32_t* const*)points, i ) ) == false;
            batch->selected[kept] = i;
            kept += is_active || ( is_brief[batch->of[i]] == false && batch->gap[i] > 0.0f ) ? 1 : 0;
        }
        compact( batch, kept );
        if ( pass == 0 )
        {
            thin_gaps( work, kind, batch );
        }
    }
}

// ---- candidates ----

bool contact_add_candidate( const contact_work* work, contact_candidates* candidates, contact_listed* listed,
                            const contact_listed_source* from )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const bool is_edge = candidates->kind == CONTACT_EDGES;
    const int32_t* a = is_edge ? s->edges + 2 * (size_t)listed->a : &listed->a;
    const int32_t* b = is_edge ? s->edges + 2 * (size_t)listed->b : s->triangles + 3 * (size_t)listed->b;
    const int32_t points[4] = { a[0], is_edge ? a[1] : b[0], is_edge ? b[0] : b[1], is_edge ? b[1] : b[2] };
    const int i = candidates->count++;
    contact_put_primitives( &candidates->primitives, i, points );
    candidates->listed[i] = listed;
    candidates->list[i] = from->list;
    candidates->slack[i] = from->slack;
    candidates->gap[i] = from->gap;
    candidates->has_owners[i] = from->has_owners;
    return candidates->count < CONTACT_BATCH;
}

// ---- owners ----

// Return whether a corner has no part in a closest point, within rounding.
static bool is_zero( float weight )
{
    return fabsf( weight ) < 1e-6f;
}

// Return whether a pair of edges repeats one of a point and a triangle, or another pair of edges.
static bool repeats_edges( const contact_clusters* k, const contact_active* active )
{
    const int32_t edges[2] = { active->pair.a, active->pair.b };
    bool repeats = false;
    for ( int side = 0; side < 2; ++side )
    {
        const bool is_second = is_zero( active->weight[2 * side] ),
                   is_end = is_second || is_zero( active->weight[2 * side + 1] );
        const bool owns = ( k->edge_owns[edges[side]] >> ( is_second ? 1 : 0 ) & 1 ) != 0;
        const bool meets_triangle = ( k->edge_owns[edges[1 - side]] & CONTACT_HAS_TRIANGLE ) != 0;
        repeats = repeats || ( is_end && ( meets_triangle || owns == false ) );
    }
    return repeats;
}

// Return whether a triangle does not own the edge or corner that is nearest to a point.
static bool repeats_point( const contact_clusters* k, const contact_active* active )
{
    const int owned = k->triangle_owns[active->pair.b];
    int zeros = 0, edge = 0, corner = 0;
    for ( int i = 0; i < 3; ++i )
    {
        const bool is_off = is_zero( active->weight[1 + i] );
        zeros += is_off ? 1 : 0;
        edge = is_off ? i : edge;
        corner = is_off ? corner : i;
    }
    return ( zeros == 1 && ( owned >> edge & 1 ) == 0 ) || ( zeros == 2 && ( owned >> ( 3 + corner ) & 1 ) == 0 );
}

void contact_select_active( const contact_work* work, contact_candidates* c, _Atomic int* total, _Atomic int* stored )
{
    static const float REPEAT_FRACTION = 0.5f; // of the gap
    _Alignas( 64 ) float weight[CONTACT_BATCH / WISP_SLICE][4][WISP_SLICE];
    _Alignas( 64 ) float normal[CONTACT_BATCH / WISP_SLICE][3][WISP_SLICE];
    contact_near* near = work->contact_mesh->primitives->near + c->kind;
    contact_active found[CONTACT_BATCH];
    int count = 0, all = 0;
    if ( c->count == 0 )
    {
        return;
    }
    int32_t* const points[4] = { c->primitives.point_x4[0], c->primitives.point_x4[1], c->primitives.point_x4[2],
                                 c->primitives.point_x4[3] };
    c->primitives.are_edges = c->kind == CONTACT_EDGES;
    const float* distance = contact_measure_primitives( work, work->contact_mesh->intersection_free, &c->primitives,
                                                        c->count, weight, normal );
    find_closings( work, c->kind, points, c->count, c->closing );
    for ( int i = 0; i < c->count; ++i )
    {
        contact_listed* listed = c->listed[i];
        const float d = distance[i], gap = listed->gap;
        listed->key = contact_key_of( d, gap, c->slack[i] );
        c->list[i]->beyond = contact_larger( -listed->key, c->list[i]->beyond );
        if ( may_meet( work->contact_mesh, d, gap, c->closing[i] ) == false ||
             ( work->memory->tangled != 0 && is_tangled( work, c->kind, (const int32_t* const*)points, i ) ) )
        {
            continue;
        }
        contact_active* active = found + count;
        *active = ( contact_active ){ { listed->a, listed->b, gap }, d, c->closing[i], { 0.0f }, { 0.0f } };
        for ( int k = 0; k < 4; ++k )
        {
            active->weight[k] = weight[i / WISP_SLICE][k][i % WISP_SLICE];
            active->normal[k % 3] = normal[i / WISP_SLICE][k % 3][i % WISP_SLICE];
        }
        // what is nearer at rest shares a corner with its owner, which may be no pair
        const bool is_far = c->has_owners[i] && gap == c->gap[i] && d >= REPEAT_FRACTION * gap + c->closing[i];
        const bool repeats =
            is_far && ( c->kind == CONTACT_EDGES ? repeats_edges( work->contact_mesh->clusters, active )
                                                 : repeats_point( work->contact_mesh->clusters, active ) );
        count += repeats ? 0 : 1;
        all += 1;
    }
    atomic_fetch_add( total, all );
    const int first = count > 0 ? atomic_fetch_add( stored, count ) : 0;
    if ( count > 0 && first + count <= near->most )
    {
        memcpy( near->items + first, found, (size_t)count * sizeof( *found ) );
    }
    c->count = 0;
}

// ---- output ----

bool contact_reserve_near( const contact_work* work, contact_kind kind, int count )
{
    contact_near* near = work->contact_mesh->primitives->near + kind;
    const bool enough =
        contact_reserve( work, &near->buffer, (size_t)count * sizeof( *near->items ), (void**)&near->items );
    near->most = enough ? count : 0;
    return enough;
}

// Closest points of a point and a triangle, or of two edges, eight pairs per kernel call. In: positions and the
// points of pairs. Out: distances, barycentric weights of the closest points, and the unit vector between them. The
// kernels closest_triangle and closest_segments do the work (engine/kernels).

const float* contact_measure_primitives( const contact_work* work, const float* xyzw, contact_primitives* primitives,
                                         int count, float ( *weight )[4][WISP_SLICE],
                                         float ( *normal )[3][WISP_SLICE] )
{
    const int groups = ( count + WISP_SLICE - 1 ) / WISP_SLICE;
    // lanes without a pair repeat the last pair
    for ( int i = count; i < groups * WISP_SLICE; ++i )
    {
        for ( int k = 0; k < 4; ++k )
        {
            primitives->point_x4[k][i] = primitives->point_x4[k][count - 1];
        }
    }
    const wisp_closest_args args = {
        .xyzw = xyzw,
        .point_x4 = { primitives->point_x4[0], primitives->point_x4[1], primitives->point_x4[2],
                      primitives->point_x4[3] },
        .distance = primitives->distance,
        .weight = weight,
        .normal = normal,
    };
    const wisp_kernels* kernels = wisp_frame_kernels( work->frame );
    ( primitives->are_edges ? kernels->closest_segments : kernels->closest_triangle )( &args, 0, groups );
    return primitives->distance;
}
