// One numbering for the points, edges and triangles of all guests.
#include "contact_internal.h"

#include <string.h>

void contact_release_soup( contact_soup* soup, const wisp_allocator* allocator )
{
    for ( int i = 0; i < WISP_COUNT( soup->buffers ); ++i )
    {
        wisp_buffer_release( soup->buffers + i, allocator );
    }
    wisp_box_pairs_release( &soup->overlaps, allocator );
    wisp_crossings_release( &soup->crossings, allocator );
    wisp_samples_release( &soup->sampler, allocator );
    *soup = ( contact_soup ){ 0 };
}

// ---- building ----

static void count_guest( const contact_work* work, contact_guest* guest, int counts[3] )
{
    guest->first_point = counts[0];
    guest->first_edge = counts[1];
    guest->first_triangle = counts[2];
    if ( guest->is_strands )
    {
        const wisp_strand_topology* t = wisp_frame_strands( work->frame, guest->entity );
        guest->point_count = t->vertex_count;
        guest->edge_count = 0;
        for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
        {
            guest->edge_count += t->lane_count[lane] > 1 ? t->lane_count[lane] - 1 : 0;
        }
        guest->triangle_count = 0;
    }
    else
    {
        const wisp_fabric* f = wisp_frame_fabric( work->frame, guest->entity );
        guest->point_count = f->vertex_count;
        guest->edge_count = f->edge_count;
        guest->triangle_count = f->triangle_count;
    }
    counts[0] += guest->point_count;
    counts[1] += guest->edge_count;
    counts[2] += guest->triangle_count;
}

bool contact_reserve( const contact_work* work, contact_place place, size_t bytes, void** out )
{
    enum
    {
        SPARE = 128, // no array is empty, and what reads or writes eight quads may go over the end
    };
    const bool enough =
        wisp_buffer_reserve( work->soup->buffers + place, wisp_parallel_allocator( work->parallel ), bytes + SPARE );
    *out = work->soup->buffers[place].data;
    return enough;
}

static bool reserve_all( const contact_work* work )
{
    contact_soup* s = work->soup;
    const size_t points = (size_t)s->point_count, edges = (size_t)s->edge_count;
    const size_t triangles = (size_t)s->triangle_count, quad = 4 * sizeof( float );
    return contact_reserve( work, CONTACT_NOW, points * quad, (void**)&s->now ) &&
           contact_reserve( work, CONTACT_SAFE, points * quad, (void**)&s->safe ) &&
           contact_reserve( work, CONTACT_REST, points * quad, (void**)&s->rest ) &&
           contact_reserve( work, CONTACT_AHEAD, points * quad, (void**)&s->ahead ) &&
           contact_reserve( work, CONTACT_LATE, points, (void**)&s->is_late ) &&
           contact_reserve( work, CONTACT_SHIFT, points * quad, (void**)&s->shift ) &&
           contact_reserve( work, CONTACT_SHARE, points * sizeof( float ), (void**)&s->share ) &&
           contact_reserve( work, CONTACT_EDGE_POINTS, edges * 2 * sizeof( int32_t ), (void**)&s->edges ) &&
           contact_reserve( work, CONTACT_TRIANGLE_POINTS, triangles * 3 * sizeof( int32_t ),
                            (void**)&s->triangles ) &&
           contact_reserve( work, CONTACT_TANGLED, points, (void**)&s->is_tangled ) &&
           contact_reserve( work, CONTACT_COLOUR_MASKS, points * sizeof( uint64_t ), (void**)&s->colours );
}

static void fill_surface( const contact_work* work, const contact_guest* guest, int number )
{
    contact_soup* s = work->soup;
    const wisp_fabric* f = wisp_frame_fabric( work->frame, guest->entity );
    for ( int i = 0; i < guest->point_count; ++i )
    {
        float* rest = s->rest + (size_t)( guest->first_point + i ) * 4;
        rest[0] = f->rest[i].x;
        rest[1] = f->rest[i].y;
        rest[2] = f->rest[i].z;
        rest[3] = (float)number;
    }
    for ( int i = 0; i < 2 * guest->edge_count; ++i )
    {
        s->edges[2 * guest->first_edge + i] = guest->first_point + f->edges[i];
    }
    for ( int i = 0; i < 3 * guest->triangle_count; ++i )
    {
        s->triangles[3 * guest->first_triangle + i] = guest->first_point + f->triangles[i];
    }
}

static void fill_strands( const contact_work* work, const contact_guest* guest, int number )
{
    contact_soup* s = work->soup;
    const wisp_strand_topology* t = wisp_frame_strands( work->frame, guest->entity );
    int32_t* edge = s->edges + 2 * (size_t)guest->first_edge;
    for ( int i = 0; i < guest->point_count; ++i )
    {
        memset( s->rest + (size_t)( guest->first_point + i ) * 4, 0, 4 * sizeof( float ) );
        s->rest[(size_t)( guest->first_point + i ) * 4 + 3] = (float)number;
    }
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        for ( int i = 1; i < t->lane_count[lane]; ++i, edge += 2 )
        {
            edge[1] = guest->first_point + t->offsets[t->lane_strand[lane]] + i;
            edge[0] = edge[1] - 1;
        }
    }
}

wisp_status contact_build_soup( const contact_work* work )
{
    contact_soup* s = work->soup;
    int counts[3] = { 0 };
    s->least_thickness = INFINITY;
    for ( int g = 0; g < work->state->guest_count; ++g )
    {
        contact_guest* guest = work->state->guests + g;
        guest->settings =
            *(contact_settings*)wisp_frame_column( work->frame, guest->entity, work->state->settings, 0 );
        count_guest( work, guest, counts );
        s->least_thickness = fminf( s->least_thickness, guest->settings.thickness );
    }
    s->point_count = counts[0];
    s->edge_count = counts[1];
    s->triangle_count = counts[2];
    s->is_listed = s->is_anew = s->has_faces = false;
    s->row_count = s->late_row_count = 0;
    if ( reserve_all( work ) == false )
    {
        s->point_count = s->edge_count = s->triangle_count = 0;
        return WISP_NO_MEMORY;
    }
    memset( s->is_tangled, 0, (size_t)s->point_count );
    memset( s->colours, 0, (size_t)s->point_count * sizeof( uint64_t ) );
    for ( int g = 0; g < work->state->guest_count; ++g )
    {
        const contact_guest* guest = work->state->guests + g;
        guest->is_strands ? fill_strands( work, guest, g ) : fill_surface( work, guest, g );
    }
    const bool samples = work->state->world.features == WISP_CONTACT_SAMPLES;
    if ( contact_make_patches( work ) == false || ( samples && contact_sample_guests( work ) != WISP_OK ) )
    {
        s->point_count = s->edge_count = s->triangle_count = 0;
        return WISP_NO_MEMORY;
    }
    return WISP_OK;
}
