// Active pairs: the last test before a pair of primitives becomes a constraint. In: pairs within reach, from the
// narrow phase. Out: those that may come to their gap wherever their points go within their tolerance.
//
// A pair is active if its distance at the intersection-free positions is less than its gap and the most that two of
// its points may approach each other. The test looks at the state alone, so results do not depend on what found the
// pair. Within a participant the gap is at most 0.9 of the distance at rest, so that nothing presses at rest. Pairs
// around an intersection are dropped, because no side of their plane is right.
#include "primitive_pairs.h"

#include "closest_points.h"
#include "intersections.h"
#include "predicted_motion.h"

#include <stdatomic.h>
#include <string.h>

// ---- distances ----

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
static int pad_to_eight( contact_batch* batch, int count )
{
    for ( ; count % WISP_SLICE != 0; ++count )
    {
        for ( int k = 0; k < 4; ++k )
        {
            batch->point_x4[k][count] = batch->point_x4[k][count - 1];
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
    const wisp_closest_args args = {
        .xyzw = work->contact_mesh->intersection_free,
        .point_x4 = { batch->point_x4[0], batch->point_x4[1], batch->point_x4[2], batch->point_x4[3] },
        .distance = batch->distance,
    };
    const int groups = pad_to_eight( batch, batch->count ) / WISP_SLICE;
    ( kind == CONTACT_EDGES ? kernels->closest_segments : kernels->closest_triangle )( &args, 0, groups );
}

// ---- the test ----

// Move the pairs in `selected` to the front.
static void compact( contact_batch* batch, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        const int from = batch->selected[i];
        batch->first[i] = batch->first[from];
        batch->second[i] = batch->second[from];
        batch->gap[i] = batch->gap[from];
        batch->distance[i] = batch->distance[from];
        for ( int k = 0; k < 4; ++k )
        {
            batch->point_x4[k][i] = batch->point_x4[k][from];
        }
    }
}

// Return whether both sides have a point of an intersection.
static bool is_tangled( const contact_contact_mesh* s, contact_kind kind, const contact_batch* batch, int i )
{
    const int split = kind == CONTACT_EDGES ? 2 : 1;
    bool sides[2] = { false, false };
    for ( int k = 0; k < 4; ++k )
    {
        sides[k >= split] = sides[k >= split] || s->intersections->is_tangled[batch->point_x4[k][i] / 4] != 0;
    }
    return sides[0] && sides[1];
}

// Compute the most that the sides of each pair may approach each other in this substep.
static void find_closings( const contact_work* work, contact_kind kind, contact_batch* batch, int count )
{
    const wisp_approach_args args = {
        .predicted = work->contact_mesh->motion->ahead,
        .point_x4 = { batch->point_x4[0], batch->point_x4[1], batch->point_x4[2], batch->point_x4[3] },
        .are_edges = kind == CONTACT_EDGES,
        .max_approach = batch->closing,
    };
    wisp_frame_kernels( work->frame )->max_approach( &args, 0, pad_to_eight( batch, count ) );
}

// Pairs at no distance have no plane between them; only coincident.c can use them.
static bool may_meet( const contact_contact_mesh* s, const contact_batch* batch, int i )
{
    return ( batch->distance[i] > 0.0f || s->is_parting ) && batch->distance[i] < batch->gap[i] + batch->closing[i];
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
static void thin_gaps( const contact_work* work, contact_kind kind, contact_batch* batch, int count )
{
    static const float REST_FRACTION = 0.9f; // of the rest distance
    const contact_contact_mesh* s = work->contact_mesh;
    contact_primitives primitives;
    primitives.are_edges = kind == CONTACT_EDGES;
    for ( int next = 0; next < count; )
    {
        int thin[CONTACT_BATCH], thin_count = 0;
        for ( ; next < count && thin_count < CONTACT_BATCH; ++next )
        {
            const bool is_own = s->rest[batch->point_x4[0][next] + 3] == s->rest[batch->point_x4[3][next] + 3];
            if ( is_own &&
                 boxes_are_within( s->rest, batch, next, kind == CONTACT_EDGES ? 2 : 1, 2.0f * batch->gap[next] ) )
            {
                const int32_t points[4] = { batch->point_x4[0][next] / 4, batch->point_x4[1][next] / 4,
                                            batch->point_x4[2][next] / 4, batch->point_x4[3][next] / 4 };
                contact_put_primitives( &primitives, thin_count, points );
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

// ---- output ----

bool contact_reserve_near( const contact_work* work, contact_kind kind, int count )
{
    contact_near* near = work->contact_mesh->primitives->near + kind;
    const bool enough =
        contact_reserve( work, &near->buffer, (size_t)count * sizeof( *near->items ), (void**)&near->items );
    near->most = enough ? count : 0;
    return enough;
}

void contact_select_active( const contact_work* work, contact_kind kind, contact_batch* batch, int selected,
                            _Atomic int* total )
{
    const contact_contact_mesh* s = work->contact_mesh;
    contact_near* near = work->contact_mesh->primitives->near + kind;
    compact( batch, selected );
    find_closings( work, kind, batch, selected );
    int kept = 0;
    for ( int i = 0; i < selected; ++i )
    {
        batch->selected[kept] = i;
        const bool is_dropped = work->memory->tangled != 0 && is_tangled( s, kind, batch, i );
        kept += may_meet( s, batch, i ) && is_dropped == false ? 1 : 0;
    }
    for ( int i = 0; i < kept; ++i )
    {
        batch->closing[i] = batch->closing[batch->selected[i]];
    }
    compact( batch, kept );
    thin_gaps( work, kind, batch, kept );
    int count = 0;
    for ( int i = 0; i < kept; ++i )
    {
        batch->found[count] = ( contact_pair ){ batch->first[i], batch->second[i], batch->gap[i] };
        count += batch->gap[i] > 0.0f && may_meet( s, batch, i ) ? 1 : 0;
    }
    const int first = count > 0 ? atomic_fetch_add( total, count ) : 0;
    if ( count > 0 && first + count <= near->most )
    {
        memcpy( near->items + first, batch->found, (size_t)count * sizeof( *batch->found ) );
    }
}
