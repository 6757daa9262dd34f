// The contact mesh: one numbering for the points, edges and triangles of all participants. In: topology and rest
// shape of cloth, balloons and strands. Out: the arrays of contact_contact_mesh; positions are gathered each substep
// (gather_scatter.c).
//
// A participant whose box is farther from those of all others that it may meet than they reach in a substep is left out:
// it costs a pass over its positions. Its reach is its thickness and twice its largest displacement, since projections
// add to that. It leaves at twice the reach and at the start of a step, so that the mesh is not built anew in each
// substep. What is farther than 32 reaches, and one for each substep, is looked at once a step.
//
// Strands that nothing comes near are apart in the next step: they run their substeps as if there were no contact. While they do,
// their box is the one that no force takes them out of. What comes near that has them join before the substep goes on.
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

// ---- who is within reach ----

enum
{
    REACH_GRAIN = 4096, // points of a block
};

static const float WATCHED_REACHES = 32.0f; // and one for each substep

typedef struct reach_loop
{
    const wisp_strand_topology* strands; // null: of a surface
    const float *position, *previous;
    contact_reach_box* blocks;
    int grain; // points, or groups of strands
} reach_loop;

// Extend a box by a point's positions before and now. NaN extends nothing.
static void box_point( contact_reach_box* box, const float* x, const float* y, size_t stride )
{
    float sum = 0.0f;
    for ( size_t k = 0; k < 3; ++k, x += stride, y += stride )
    {
        box->bounds.lower[k] = contact_smaller( *x, contact_smaller( *y, box->bounds.lower[k] ) );
        box->bounds.upper[k] = contact_larger( *x, contact_larger( *y, box->bounds.upper[k] ) );
        sum += ( *x - *y ) * ( *x - *y );
    }
    box->displacement2 = contact_larger( sum, box->displacement2 );
}

// Bounds of rows of strands, lane by lane.
typedef struct reach_lanes
{
    float lower[3][WISP_LANES], upper[3][WISP_LANES], displacement2[WISP_LANES];
} reach_lanes;

// Extend the bounds of all lanes by a row.
static void box_row( reach_lanes* out, const float* x, const float* y )
{
    float sum[WISP_LANES] = { 0 };
    for ( int k = 0; k < 3; ++k, x += WISP_LANES, y += WISP_LANES )
    {
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            out->lower[k][lane] = contact_smaller( x[lane], contact_smaller( y[lane], out->lower[k][lane] ) );
            out->upper[k][lane] = contact_larger( x[lane], contact_larger( y[lane], out->upper[k][lane] ) );
            sum[lane] += ( x[lane] - y[lane] ) * ( x[lane] - y[lane] );
        }
    }
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        out->displacement2[lane] = contact_larger( sum[lane], out->displacement2[lane] );
    }
}

// Extend a box by a group of strands: rows that all lanes have at once, and others lane by lane.
static void box_group( const reach_loop* loop, contact_reach_box* box, int group )
{
    const wisp_strand_topology* t = loop->strands;
    const int32_t* count = t->lane_count + (size_t)group * WISP_LANES;
    const size_t first = (size_t)t->group_row[group] * 3 * WISP_LANES, row = 3 * (size_t)WISP_LANES;
    const float *x = loop->position + first, *y = loop->previous + first;
    int shortest = count[0];
    reach_lanes all;
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        all.lower[0][lane] = all.lower[1][lane] = all.lower[2][lane] = INFINITY;
        all.upper[0][lane] = all.upper[1][lane] = all.upper[2][lane] = -INFINITY;
        all.displacement2[lane] = 0.0f;
        shortest = count[lane] < shortest ? count[lane] : shortest;
    }
    for ( int i = 0; i < shortest; ++i )
    {
        box_row( &all, x + (size_t)i * row, y + (size_t)i * row );
    }
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        for ( int k = 0; k < 3; ++k )
        {
            box->bounds.lower[k] = contact_smaller( all.lower[k][lane], box->bounds.lower[k] );
            box->bounds.upper[k] = contact_larger( all.upper[k][lane], box->bounds.upper[k] );
        }
        box->displacement2 = contact_larger( all.displacement2[lane], box->displacement2 );
        for ( int i = shortest; i < count[lane]; ++i )
        {
            box_point( box, x + (size_t)i * row + lane, y + (size_t)i * row + lane, WISP_LANES );
        }
    }
}

static const contact_reach_box NO_BOX = { { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } },
                                          0.0f };

static void box_block( void* context, int begin, int end, int worker )
{
    (void)worker;
    const reach_loop* loop = context;
    contact_reach_box* box = loop->blocks + begin / loop->grain;
    *box = NO_BOX;
    for ( int i = begin; loop->strands == NULL && i < end; ++i )
    {
        box_point( box, loop->position + (size_t)i * 4, loop->previous + (size_t)i * 4, 1 );
    }
    for ( int group = begin; loop->strands != NULL && group < end; ++group )
    {
        box_group( loop, box, group );
    }
}

// Find the box of a participant; without memory it has none.
static void box_participant( const contact_work* work, contact_participant* participant )
{
    const bool is_strands = participant->is_strands;
    const wisp_component position = is_strands ? WISP_STRAND_POSITION : WISP_PARTICLE_POSITION,
                         previous = is_strands ? WISP_STRAND_PREVIOUS : WISP_PARTICLE_PREVIOUS;
    reach_loop loop = { .position = wisp_frame_column( work->frame, participant->entity, position, 0 ),
                        .previous = wisp_frame_column( work->frame, participant->entity, previous, 0 ),
                        .grain = REACH_GRAIN };
    int count = is_strands ? 0 : wisp_frame_fabric( work->frame, participant->entity )->vertex_count;
    if ( is_strands )
    {
        loop.strands = wisp_frame_strands( work->frame, participant->entity );
        count = loop.strands->group_count;
        const int rows_per_group = 1 + loop.strands->row_count / ( 1 + count );
        loop.grain = 1 + REACH_GRAIN / ( WISP_LANES * rows_per_group );
    }
    loop.previous = loop.previous != NULL ? loop.previous : loop.position;
    const int blocks = ( count + loop.grain - 1 ) / loop.grain;
    loop.blocks = wisp_parallel_scratch( work->parallel, work->worker, (size_t)blocks * sizeof( *loop.blocks ) );
    contact_reach_box* out = &participant->box;
    *out = NO_BOX;
    if ( loop.blocks == NULL )
    {
        return;
    }
    wisp_parallel_for( work->parallel, count, loop.grain, box_block, &loop );
    for ( int b = 0; b < blocks; ++b )
    {
        for ( int k = 0; k < 3; ++k )
        {
            out->bounds.lower[k] = contact_smaller( loop.blocks[b].bounds.lower[k], out->bounds.lower[k] );
            out->bounds.upper[k] = contact_larger( loop.blocks[b].bounds.upper[k], out->bounds.upper[k] );
        }
        out->displacement2 = contact_larger( loop.blocks[b].displacement2, out->displacement2 );
    }
}

// Return whether two participants, or a participant and itself, are kept apart wherever they are.
static bool are_to_meet( const contact_participant* a, const contact_participant* b )
{
    return a == b ? ( a->settings.self & 1 ) != 0 : contact_suit( a, &a->settings, b, &b->settings );
}

// Return whether two participants are within so many reaches of each other. A participant without a box always is.
static bool are_near( const contact_participant* a, const contact_participant* b, float reaches )
{
    const float reach =
        2.0f * ( contact_gap_between( a, b ) + sqrtf( a->box.displacement2 ) + sqrtf( b->box.displacement2 ) );
    return a->box.bounds.lower[0] == INFINITY || b->box.bounds.lower[0] == INFINITY ||
           wisp_bounds_touch( &a->box.bounds, &b->box.bounds, reaches * reach );
}

static contact_settings* settings_of( const contact_work* work, const contact_participant* participant )
{
    return wisp_frame_column( work->frame, participant->entity, work->components->settings, 0 );
}

// Return whether a participant may meet another within so many reaches. One that may meet nobody counts as near while
// intersections are counted.
static bool reaches_any( const contact_work* work, int number, float reaches )
{
    const contact_participant* a = work->participants + number;
    bool found = contact_may_meet( a, a ), meets = false;
    for ( int g = 0; g < work->participant_count && found == false; ++g )
    {
        const contact_participant* b = work->participants + g;
        meets = meets || ( g != number && are_to_meet( a, b ) );
        found = g != number && contact_may_meet( a, b ) && are_near( a, b, reaches );
    }
    return found || ( meets == false && work->counts_intersections );
}

// Set the box of strands to the one that they do not leave in this step. @return false if there is none
static bool box_reach( const contact_work* work, contact_participant* participant )
{
    const float* bounds = wisp_frame_column( work->frame, participant->entity, WISP_STRAND_REACH, 0 );
    const int32_t* known = wisp_frame_column( work->frame, participant->entity, WISP_STRAND_REACH, 1 );
    const bool is_known = participant->is_strands && *known != 0;
    for ( int k = 0; k < 3 && is_known; ++k )
    {
        participant->box.bounds.lower[k] = bounds[k];
        participant->box.bounds.upper[k] = bounds[3 + k];
        participant->box.displacement2 = 0.0f;
    }
    return is_known;
}

static void box_all( const contact_work* work )
{
    for ( int g = 0; g < work->participant_count; ++g )
    {
        contact_participant* participant = work->participants + g;
        wisp_frame_is_apart( work->frame, participant->entity ) ? (void)box_reach( work, participant )
                                                                : box_participant( work, participant );
    }
}

// Mark the strands that are apart in the next step. Boxes of those that are far become their reach.
static void mark_apart( const contact_work* work )
{
    for ( int g = 0; g < work->participant_count; ++g )
    {
        contact_participant* participant = work->participants + g;
        participant->may_part = participant->settings.is_far != 0 && box_reach( work, participant );
    }
    for ( int g = 0; g < work->participant_count; ++g )
    {
        contact_participant* participant = work->participants + g;
        int32_t* apart = wisp_frame_column( work->frame, participant->entity, WISP_STRAND_REACH, 2 );
        if ( apart != NULL )
        {
            *apart = participant->may_part && reaches_any( work, g, 2.0f ) == false ? 1 : 0;
        }
    }
}

// Mark participants at the start of a step: they leave or join.
static void mark_anew( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    const float watched = WATCHED_REACHES + (float)wisp_frame_substeps( work->frame, work->participants->entity );
    s->may_join = false;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        contact_settings* settings = &work->participants[g].settings;
        settings->is_far = reaches_any( work, g, settings->is_far != 0 ? 1.0f : 2.0f ) ? 0 : 1;
        s->may_join = s->may_join || ( settings->is_far != 0 && reaches_any( work, g, watched ) );
    }
    mark_apart( work );
}

// Mark participants in later substeps: they only join.
static void mark_joining( const contact_work* work )
{
    for ( int g = 0; g < work->participant_count; ++g )
    {
        contact_settings* settings = &work->participants[g].settings;
        settings->is_far = settings->is_far != 0 && reaches_any( work, g, 1.0f ) == false ? 1 : 0;
    }
}

bool contact_mark_far( const contact_work* work, bool is_start )
{
    contact_contact_mesh* s = work->contact_mesh;
    bool may_leave = false, is_other = false;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        contact_participant* participant = work->participants + g;
        participant->settings = *settings_of( work, participant );
        participant->cover = work->settings->level == WISP_CONTACT_SPHERES ? participant->spacing : 0.0f;
        participant->place = wisp_frame_between( work->frame, participant->entity, work->participants->entity );
        may_leave =
            may_leave || participant->settings.is_far != 0 || contact_may_meet( participant, participant ) == false;
    }
    if ( may_leave && ( is_start || s->may_join ) )
    {
        box_all( work );
        is_start ? mark_anew( work ) : mark_joining( work );
    }
    for ( int g = 0; g < work->participant_count; ++g )
    {
        contact_participant* participant = work->participants + g;
        contact_settings* settings = settings_of( work, participant );
        const bool is_near = participant->settings.is_far == 0;
        participant->joins = is_near && wisp_frame_is_apart( work->frame, participant->entity );
        // who comes has no intersection-free positions
        settings->is_new = participant->joins || ( is_near && settings->is_far != 0 ) ? 1 : settings->is_new;
        settings->is_far = participant->settings.is_far;
        participant->settings.is_new = settings->is_new;
        is_other = is_other || ( settings->is_far != 0 ) != participant->is_left_out;
    }
    return is_other;
}

// ---- building ----

static void count_participant( const contact_work* work, contact_participant* participant, int counts[3] )
{
    participant->first_point = counts[0];
    participant->first_edge = counts[1];
    participant->first_triangle = counts[2];
    participant->point_count = participant->edge_count = participant->triangle_count = 0;
    if ( participant->is_left_out )
    {
        return;
    }
    if ( participant->is_strands )
    {
        const wisp_strand_topology* t = wisp_frame_strands( work->frame, participant->entity );
        participant->point_count = t->vertex_count;
        for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
        {
            participant->edge_count += t->lane_count[lane] > 1 ? t->lane_count[lane] - 1 : 0;
        }
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

// Return the fabric of the only participant with points, whose lists then serve; null: there are others.
static const wisp_fabric* only_fabric( const contact_work* work )
{
    const wisp_fabric* only = NULL;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        if ( participant->point_count == work->contact_mesh->point_count && participant->is_strands == false )
        {
            only = wisp_frame_fabric( work->frame, participant->entity );
        }
    }
    return only;
}

// @param edges, triangles receive where to list those of the participants; null: the lists of the only fabric serve
static bool reserve_mesh( const contact_work* work, int32_t** edges, int32_t** triangles )
{
    contact_contact_mesh* s = work->contact_mesh;
    const size_t xyzw = (size_t)s->point_count * 4 * sizeof( float ), index = sizeof( int32_t );
    const wisp_fabric* only = only_fabric( work );
    wisp_buffer* b = s->buffers;
    *edges = *triangles = NULL;
    const bool enough =
        contact_reserve( work, b++, xyzw, (void**)&s->now ) &&
        contact_reserve( work, b++, xyzw, (void**)&s->intersection_free ) &&
        contact_reserve( work, b++, xyzw, (void**)&s->rest ) &&
        contact_reserve( work, b++, xyzw, (void**)&s->shift ) &&
        contact_reserve( work, b++, (size_t)s->point_count, (void**)&s->is_pushed ) &&
        contact_reserve( work, b++, (size_t)s->point_count * index, (void**)&s->held ) &&
        ( only != NULL ||
          ( contact_reserve( work, b++, (size_t)s->edge_count * 2 * index, (void**)edges ) &&
            contact_reserve( work, b++, (size_t)s->triangle_count * 3 * index, (void**)triangles ) ) );
    s->edges = only != NULL ? only->edges : *edges;
    s->triangles = only != NULL ? only->triangles : *triangles;
    return enough;
}

static void fill_surface( const contact_work* work, const contact_participant* participant, int number,
                          int32_t* edges, int32_t* triangles )
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
    for ( int i = 0; i < 2 * participant->edge_count && edges != NULL; ++i )
    {
        edges[2 * participant->first_edge + i] = participant->first_point + f->edges[i];
    }
    for ( int i = 0; i < 3 * participant->triangle_count && triangles != NULL; ++i )
    {
        triangles[3 * participant->first_triangle + i] = participant->first_point + f->triangles[i];
    }
}

static void fill_strands( const contact_work* work, const contact_participant* participant, int number,
                          int32_t* edges )
{
    contact_contact_mesh* s = work->contact_mesh;
    const wisp_strand_topology* t = wisp_frame_strands( work->frame, participant->entity );
    const float* shape = wisp_frame_column( work->frame, participant->entity, WISP_STRAND_REST, 0 );
    int32_t* edge = edges + 2 * (size_t)participant->first_edge;
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
        participant->is_left_out = participant->settings.is_far != 0;
        participant->held_count = 0;
        count_participant( work, participant, counts );
        s->min_thickness = fminf( s->min_thickness, participant->settings.thickness );
    }
    s->point_count = counts[0];
    s->edge_count = counts[1];
    s->triangle_count = counts[2];
    s->is_listed = s->is_reset = false;
    int32_t *edges, *triangles;
    if ( reserve_mesh( work, &edges, &triangles ) == false )
    {
        return false;
    }
    memset( s->intersection_free, 0, (size_t)s->point_count * 4 * sizeof( float ) ); // compared before it is written
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        if ( participant->is_left_out == false )
        {
            participant->is_strands ? fill_strands( work, participant, g, edges )
                                    : fill_surface( work, participant, g, edges, triangles );
        }
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
    // what is apart has another origin, and meets nothing
    return are_to_meet( a, b ) && a->place.x == b->place.x && a->place.y == b->place.y && a->place.z == b->place.z;
}
