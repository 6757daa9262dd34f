// Pairs that repeat another one. In: pairs within their gap. Out: how near they may come before they are active.
//
// - Two edges that are nearest at an end of one have the closest points of that end and a triangle at the other edge.
// - A point that is nearest to a side or a corner of a triangle is as near to all triangles there, or nearer. Of these the
//   first one counts.
//
// Such a pair pushes nothing that the other one does not push. What is left to do is to keep its primitives as a whole from
// passing through each other, so it is active only where it may come to the distance that the displacement limit keeps. In
// cloth that lies on cloth three of four pairs repeat others.
#include "repeats.h"

#include "closest_points.h"
#include "displacement_limit.h"

#include <string.h>

// Weights of the closest points of a group of pairs.
typedef float pair_weights[4][WISP_SLICE];

// Return whether the closest point of a side of two edges is an end, and the other side has triangles.
static bool is_end( const contact_work* work, const contact_batch* batch, int i, const float ( *weight )[WISP_SLICE],
                    int side )
{
    const int here = 2 * side, there = 2 * ( 1 - side ), lane = i % WISP_SLICE;
    return ( weight[here][lane] == 0.0f || weight[here + 1][lane] == 0.0f ) &&
           contact_participant_of( work, batch->point_x4[there][i] / 4 )->is_strands == false;
}

static bool repeats_edges( const contact_work* work, const contact_batch* batch, int i,
                           const float ( *weight )[WISP_SLICE] )
{
    return is_end( work, batch, i, weight, 0 ) || is_end( work, batch, i, weight, 1 );
}

// Return the first triangle at the side or the corner where a point is nearest to a triangle; itself if it is inside.
static int first_there( const contact_contact_mesh* s, int triangle, const float ( *weight )[WISP_SLICE], int lane )
{
    int zeros = 0, zero = 0, other = 0;
    for ( int k = 0; k < 3; ++k )
    {
        const bool is_zero = weight[1 + k][lane] == 0.0f;
        zeros += is_zero ? 1 : 0;
        zero = is_zero ? k : zero;
        other = is_zero ? other : k;
    }
    return zeros == 1   ? s->first_at_side[3 * (size_t)triangle + (size_t)zero]
           : zeros == 2 ? s->first_at_point[s->triangles[3 * (size_t)triangle + (size_t)other]]
                        : triangle;
}

static bool repeats_triangle( const contact_work* work, const contact_batch* batch, int i,
                              const float ( *weight )[WISP_SLICE] )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const int point = batch->first[i], first = first_there( s, batch->second[i], weight, i % WISP_SLICE );
    const int32_t* corner = s->triangles + 3 * (size_t)first;
    return first != batch->second[i] && corner[0] != point && corner[1] != point && corner[2] != point;
}

static void find_reaches( const contact_work* work, contact_kind kind, contact_batch* batch, int first, int count )
{
    _Alignas( 64 ) pair_weights weight[CONTACT_BATCH / WISP_SLICE];
    _Alignas( 64 ) float normal[CONTACT_BATCH / WISP_SLICE][3][WISP_SLICE];
    contact_primitives primitives;
    primitives.are_edges = kind == CONTACT_EDGES;
    for ( int k = 0; k < 4; ++k )
    {
        memcpy( primitives.point_x4[k], batch->point_x4[k] + first, (size_t)count * sizeof( int32_t ) );
    }
    contact_measure_primitives( work, work->contact_mesh->intersection_free, &primitives, count, weight, normal );
    for ( int i = first; i < first + count; ++i )
    {
        const float( *of )[WISP_SLICE] = (const float( * )[WISP_SLICE])weight[( i - first ) / WISP_SLICE];
        const bool repeats =
            primitives.are_edges ? repeats_edges( work, batch, i, of ) : repeats_triangle( work, batch, i, of );
        // neighbours at rest have gaps of their own
        const bool is_repeat = repeats && batch->is_near_at_rest[i] == 0;
        batch->reach[i] = ( is_repeat ? CONTACT_LEAST_GAP : 1.0f ) * batch->gap[i];
    }
}

void contact_find_reaches( const contact_work* work, contact_kind kind, contact_batch* batch, int count )
{
    if ( work->contact_mesh->is_parting )
    {
        memcpy( batch->reach, batch->gap, (size_t)count * sizeof( float ) );
        return;
    }
    for ( int first = 0; first < count; first += CONTACT_BATCH )
    {
        find_reaches( work, kind, batch, first, count - first < CONTACT_BATCH ? count - first : CONTACT_BATCH );
    }
}
