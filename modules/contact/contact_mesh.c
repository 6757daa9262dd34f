// The contact mesh: one numbering for the points, edges and triangles of all participants. In: topology and rest
// shape of cloth, balloons and strands. Out: the arrays of contact_contact_mesh; positions are gathered each substep
// (gather_scatter.c).
#include "contact_mesh.h"

#include "wisp/module/space.h"

#include <string.h>

bool contact_reserve( const contact_work* work, wisp_buffer* buffer, size_t bytes, void** out )
{
    enum
    {
        SPARE = 128, // no array is empty, and kernels may touch up to eight float[4] behind the end
    };
    const bool enough = wisp_buffer_reserve( buffer, wisp_parallel_allocator( work->parallel ), bytes + SPARE );
    *out = buffer->data;
    return enough;
}

// ---- building ----

static void count_participant( const contact_work* work, contact_participant* participant, int counts[3] )
{
    participant->first_point = counts[0];
    participant->first_edge = counts[1];
    participant->first_triangle = counts[2];
    if ( participant->is_strands )
    {
        const wisp_strand_topology* t = wisp_frame_strands( work->frame, participant->entity );
        participant->point_count = t->vertex_count;
        participant->edge_count = 0;
        for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
        {
            participant->edge_count += t->lane_count[lane] > 1 ? t->lane_count[lane] - 1 : 0;
        }
        participant->triangle_count = 0;
    }
    else
    {
        const wisp_fabric* f = wisp_frame_fabric( work->frame, participant->entity );
        participant->point_count = f->vertex_count;
        participant->edge_count = f->edge_count;
        participant->triangle_count = f->triangle_count;
    }
    counts[0] += participant->point_count;
    counts[1] += participant->edge_count;
    counts[2] += participant->triangle_count;
}

static bool reserve_mesh( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    const size_t xyzw = (size_t)s->point_count * 4 * sizeof( float ), index = sizeof( int32_t );
    const size_t edges = (size_t)s->edge_count * 2 * index, triangles = (size_t)s->triangle_count * 3 * index;
    wisp_buffer* b = s->buffers;
    return contact_reserve( work, b++, xyzw, (void**)&s->now ) &&
           contact_reserve( work, b++, xyzw, (void**)&s->intersection_free ) &&
           contact_reserve( work, b++, xyzw, (void**)&s->rest ) &&
           contact_reserve( work, b++, xyzw, (void**)&s->shift ) &&
           contact_reserve( work, b++, edges, (void**)&s->edges ) &&
           contact_reserve( work, b++, triangles, (void**)&s->triangles );
}

static void fill_surface( const contact_work* work, const contact_participant* participant, int number )
{
    contact_contact_mesh* s = work->contact_mesh;
    const wisp_fabric* f = wisp_frame_fabric( work->frame, participant->entity );
    for ( int i = 0; i < participant->point_count; ++i )
    {
        float* rest = s->rest + (size_t)( participant->first_point + i ) * 4;
        rest[0] = f->rest[i].x;
        rest[1] = f->rest[i].y;
        rest[2] = f->rest[i].z;
        rest[3] = (float)number;
    }
    for ( int i = 0; i < 2 * participant->edge_count; ++i )
    {
        s->edges[2 * participant->first_edge + i] = participant->first_point + f->edges[i];
    }
    for ( int i = 0; i < 3 * participant->triangle_count; ++i )
    {
        s->triangles[3 * participant->first_triangle + i] = participant->first_point + f->triangles[i];
    }
}

static void fill_strands( const contact_work* work, const contact_participant* participant, int number )
{
    contact_contact_mesh* s = work->contact_mesh;
    const wisp_strand_topology* t = wisp_frame_strands( work->frame, participant->entity );
    const float* shape = wisp_frame_column( work->frame, participant->entity, WISP_STRAND_REST, 0 );
    int32_t* edge = s->edges + 2 * (size_t)participant->first_edge;
    for ( int i = 0; i < participant->point_count; ++i )
    {
        memset( s->rest + (size_t)( participant->first_point + i ) * 4, 0, 4 * sizeof( float ) );
        s->rest[(size_t)( participant->first_point + i ) * 4 + 3] = (float)number;
    }
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        for ( int i = 0; i < t->lane_count[lane] && ( participant->settings.self & 1 ) != 0; ++i )
        {
            const int point = participant->first_point + t->offsets[t->lane_strand[lane]] + i;
            const float* from =
                shape + (size_t)( t->group_row[lane / WISP_LANES] + i ) * 3 * WISP_LANES + lane % WISP_LANES;
            for ( int k = 0; k < 3; ++k )
            {
                s->rest[(size_t)point * 4 + (size_t)k] = from[k * WISP_LANES];
            }
        }
        for ( int i = 1; i < t->lane_count[lane]; ++i, edge += 2 )
        {
            edge[1] = participant->first_point + t->offsets[t->lane_strand[lane]] + i;
            edge[0] = edge[1] - 1;
        }
    }
}

bool contact_build_contact_mesh( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    int counts[3] = { 0 };
    s->min_thickness = INFINITY;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        contact_participant* participant = work->participants + g;
        participant->settings =
            *(contact_settings*)wisp_frame_column( work->frame, participant->entity, work->components->settings, 0 );
        count_participant( work, participant, counts );
        s->min_thickness = fminf( s->min_thickness, participant->settings.thickness );
    }
    s->point_count = counts[0];
    s->edge_count = counts[1];
    s->triangle_count = counts[2];
    s->is_listed = s->is_reset = false;
    if ( reserve_mesh( work ) == false )
    {
        return false;
    }
    memset( s->intersection_free, 0, (size_t)s->point_count * 4 * sizeof( float ) ); // compared before it is written
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        participant->is_strands ? fill_strands( work, participant, g ) : fill_surface( work, participant, g );
    }
    return true;
}

// ---- queries ----

// Edges of a participant rise by their first point, then by their second.
int contact_find_edge( const contact_contact_mesh* s, const contact_participant* participant, int a, int b )
{
    int lower = participant->first_edge, upper = participant->first_edge + participant->edge_count - 1;
    while ( lower < upper )
    {
        const int middle = lower + ( upper - lower ) / 2;
        const int32_t* e = s->edges + 2 * (size_t)middle;
        const bool is_before = e[0] < a || ( e[0] == a && e[1] < b );
        lower = is_before ? middle + 1 : lower;
        upper = is_before ? upper : middle;
    }
    return lower;
}

bool contact_may_meet( const contact_participant* a, const contact_participant* b )
{
    if ( a == b )
    {
        return ( a->settings.self & 1 ) != 0;
    }
    // what is apart has another origin, and meets nothing
    const bool is_apart = a->place.x != b->place.x || a->place.y != b->place.y || a->place.z != b->place.z;
    return is_apart == false && ( a->settings.layers & b->settings.mask ) != 0 &&
           ( b->settings.layers & a->settings.mask ) != 0 &&
           ( a->is_strands == false || b->is_strands == false || ( a->settings.self & b->settings.self & 2 ) != 0 );
}
