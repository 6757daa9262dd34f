// Intersections: edges that pass through triangles, found exactly (wisp/intersections.h). In: positions. Out: the list of
// intersections; the points of those between participants that are kept apart are marked. Constraints between marked
// points are dropped, because their plane would have no right side, and untangling.c draws them apart.
#include "intersections.h"

#include <string.h>

bool contact_reserve_intersections( const contact_work* work )
{
    contact_intersections* x = work->contact_mesh->intersections;
    const size_t points = (size_t)work->contact_mesh->point_count;
    const bool enough = contact_reserve( work, &x->buffer, points, (void**)&x->is_tangled );
    if ( enough )
    {
        memset( x->is_tangled, 0, points );
    }
    return enough;
}

wisp_status contact_find_intersections( const contact_work* work, const float* xyzw, wisp_error* error )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const wisp_intersection_args args = {
        .xyzw = xyzw,
        .edges = s->edges,
        .edge_count = s->edge_count,
        .triangles = s->triangles,
        .triangle_count = s->triangle_count,
        .kernels = wisp_frame_kernels( work->frame ),
    };
    return wisp_intersections_find( &s->intersections->intersections, work->parallel, &args, error );
}

bool contact_is_forbidden( const contact_work* work, const wisp_intersection* intersection )
{
    const contact_contact_mesh* s = work->contact_mesh;
    return contact_may_meet( contact_participant_of( work, s->edges[2 * (size_t)intersection->edge] ),
                             contact_participant_of( work, s->triangles[3 * (size_t)intersection->triangle] ) );
}

bool contact_is_movable( const contact_contact_mesh* s, const wisp_intersection* intersection )
{
    const int32_t *edge = s->edges + 2 * (size_t)intersection->edge,
                  *triangle = s->triangles + 3 * (size_t)intersection->triangle;
    const int32_t points[5] = { edge[0], edge[1], triangle[0], triangle[1], triangle[2] };
    for ( int i = 0; i < 5; ++i )
    {
        if ( s->now[(size_t)points[i] * 4 + 3] > 0.0f )
        {
            return true;
        }
    }
    return false;
}

int contact_count_intersections( const contact_contact_mesh* s, int a, int b )
{
    const wisp_intersections* found = &s->intersections->intersections;
    int count = 0;
    for ( int i = 0; i < found->count; ++i )
    {
        const int edge_of = (int)s->rest[(size_t)s->edges[2 * (size_t)found->list[i].edge] * 4 + 3],
                  triangle_of = (int)s->rest[(size_t)s->triangles[3 * (size_t)found->list[i].triangle] * 4 + 3];
        const bool is_theirs = ( edge_of == a && triangle_of == b ) || ( edge_of == b && triangle_of == a );
        count += is_theirs && contact_is_movable( s, found->list + i );
    }
    return count;
}

static void mark( contact_contact_mesh* s, const wisp_intersection* intersection )
{
    uint8_t* is_tangled = s->intersections->is_tangled;
    for ( size_t i = 0; i < 2; ++i )
    {
        is_tangled[s->edges[2 * (size_t)intersection->edge + i]] = 1;
    }
    for ( size_t i = 0; i < 3; ++i )
    {
        is_tangled[s->triangles[3 * (size_t)intersection->triangle + i]] = 1;
    }
}

wisp_status contact_mark_intersections( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    const wisp_intersections* intersections = &s->intersections->intersections;
    memset( s->intersections->is_tangled, 0, (size_t)s->point_count );
    if ( work->memory->tangled == 0 )
    {
        return WISP_OK;
    }
    const wisp_status status = contact_find_intersections( work, s->intersection_free, error );
    int count = 0;
    for ( int c = 0; c < intersections->count && status == WISP_OK; ++c )
    {
        if ( contact_is_forbidden( work, intersections->list + c ) )
        {
            mark( s, intersections->list + c );
            count += 1;
        }
    }
    work->memory->stats.tangled = count;
    work->memory->tangled = status == WISP_OK && count == 0 ? 0 : 1;
    if ( work->memory->tangled == 0 && work->counts_intersections == false )
    {
        // a kilobyte per vertex, not used again before positions are replaced
        wisp_intersections_release( &s->intersections->intersections, wisp_parallel_allocator( work->parallel ) );
    }
    return status;
}
