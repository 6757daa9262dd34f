// One numbering for the points, edges and triangles of all guests, and the ways between it and their columns.
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

// Where vertex i of strands stands: its lane in rows of so many numbers.
static size_t lane_of( const wisp_strand_topology* t, int lane, int i, int numbers )
{
    const size_t row = (size_t)t->group_row[lane / WISP_LANES] + (size_t)i;
    return row * (size_t)numbers * WISP_LANES + (size_t)( lane % WISP_LANES );
}

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
        SPARE = 64, // no array is empty, and wide loads may go over the end
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

// ---- gathering and scattering ----

// What the columns of strands hold, vertex by vertex. A column that is null is passed over.
typedef struct strand_way
{
    float* column;
    float* quads;
    bool is_out; // from the quads to the column
    int numbers; // a vertex has, 3 or 4
} strand_way;

// @return whether anything changed
static bool move_strands( const wisp_strand_topology* t, const contact_guest* guest, strand_way way )
{
    bool changed = false;
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        for ( int i = 0; i < t->lane_count[lane]; ++i )
        {
            float* x = way.column + lane_of( t, lane, i, way.numbers );
            float* q = way.quads + (size_t)( guest->first_point + t->offsets[t->lane_strand[lane]] + i ) * 4;
            for ( int k = 0; k < way.numbers; ++k )
            {
                float *from = way.is_out ? q + k : x + k * WISP_LANES, *to = way.is_out ? x + k * WISP_LANES : q + k;
                changed = changed || *to != *from;
                *to = *from;
            }
        }
    }
    return changed;
}

static void gather_strand_weights( const wisp_strand_topology* t, const contact_guest* guest, const float* weight,
                                   float* quads )
{
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        for ( int i = 0; i < t->lane_count[lane]; ++i )
        {
            const size_t row = (size_t)( t->group_row[lane / WISP_LANES] + i );
            quads[(size_t)( guest->first_point + t->offsets[t->lane_strand[lane]] + i ) * 4 + 3] =
                weight[row * WISP_LANES + (size_t)( lane % WISP_LANES )];
        }
    }
}

// Has a column other bits than the warm copy? Then it was written from outside: a snapshot was restored.
static bool take_quads( const contact_work* work, const contact_guest* guest, float* quads )
{
    if ( guest->is_strands )
    {
        float* rows = wisp_frame_column( work->frame, guest->entity, work->state->strand_safe, 0 );
        return move_strands( wisp_frame_strands( work->frame, guest->entity ), guest,
                             ( strand_way ){ rows, quads, false, 3 } );
    }
    const float* rows = wisp_frame_column( work->frame, guest->entity, work->state->particle_safe, 0 );
    const size_t bytes = (size_t)guest->point_count * 4 * sizeof( float );
    float* to = quads + (size_t)guest->first_point * 4;
    const bool differs = memcmp( to, rows, bytes ) != 0;
    memcpy( to, rows, bytes );
    return differs;
}

static void gather_now( const contact_work* work, const contact_guest* guest )
{
    contact_soup* s = work->soup;
    float* now = s->now + (size_t)guest->first_point * 4;
    if ( guest->is_strands )
    {
        const wisp_strand_topology* t = wisp_frame_strands( work->frame, guest->entity );
        float* rows = wisp_frame_column( work->frame, guest->entity, WISP_STRAND_POSITION, 0 );
        move_strands( t, guest, ( strand_way ){ rows, s->now, false, 3 } );
        gather_strand_weights( t, guest, wisp_frame_column( work->frame, guest->entity, WISP_STRAND_WEIGHT, 0 ),
                               s->now );
    }
    else
    {
        memcpy( now, wisp_frame_column( work->frame, guest->entity, WISP_PARTICLE_POSITION, 0 ),
                (size_t)guest->point_count * 4 * sizeof( float ) );
    }
    for ( int i = 0; i < guest->point_count && guest->halted; ++i )
    {
        now[4 * i + 3] = 0.0f;
    }
}

// Where a guest begins the substep. One that is halted does not move, and what it came from means nothing.
static void gather_start( const contact_work* work, const contact_guest* guest, float* start )
{
    contact_soup* s = work->soup;
    const size_t first = (size_t)guest->first_point * 4, bytes = (size_t)guest->point_count * 4 * sizeof( float );
    const wisp_component component = guest->is_strands ? WISP_STRAND_PREVIOUS : WISP_PARTICLE_PREVIOUS;
    float* previous = wisp_frame_column( work->frame, guest->entity, component, 0 );
    if ( guest->halted || previous == NULL )
    {
        memcpy( start + first, s->now + first, bytes );
    }
    else if ( guest->is_strands )
    {
        move_strands( wisp_frame_strands( work->frame, guest->entity ), guest,
                      ( strand_way ){ previous, start, false, 3 } );
    }
    else
    {
        memcpy( start + first, previous, bytes );
    }
}

// A point that does not begin where it was safe was moved by the user, or put back: it is safe where it begins. What is less
// than half of a thickness is a way like others.
static void start_over( const contact_work* work, const contact_guest* guest )
{
    contact_soup* s = work->soup;
    contact_settings* settings = wisp_frame_column( work->frame, guest->entity, work->state->settings, 0 );
    float* start = s->shift; // not in use yet
    const float most = 0.5f * s->least_thickness;
    gather_start( work, guest, start );
    bool jumped = settings->is_new != 0;
    const int end = guest->first_point + guest->point_count;
    for ( int i = guest->first_point; i < end && jumped == false; ++i )
    {
        const float *p = start + (size_t)i * 4, *q = s->safe + (size_t)i * 4;
        const float x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
        jumped = !( x * x + y * y + z * z <= most * most ); // a place that is no number is none to stay at
    }
    for ( int i = guest->first_point; i < end && jumped; ++i )
    {
        memcpy( s->safe + (size_t)i * 4, start + (size_t)i * 4, 3 * sizeof( float ) );
    }
    s->is_anew = s->is_anew || jumped;
    work->memory->tangled = jumped ? 1 : work->memory->tangled;
    settings->is_new = 0;
}

// A number that went wrong is the entity's, which will be halted for it: here the point stands where it was and takes no part.
static void set_wrong_aside( contact_soup* s )
{
    static const float FARTHEST = 1e6f; // m, as far as a surface may be from the origin
    for ( size_t i = 0; i < (size_t)s->point_count * 4; i += 4 )
    {
        const float *p = s->now + i, *q = s->safe + i;
        const float x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
        if ( !( x * x + y * y + z * z < FARTHEST * FARTHEST ) )
        {
            memcpy( s->now + i, s->safe + i, 3 * sizeof( float ) );
            s->now[i + 3] = 0.0f;
        }
    }
}

void contact_gather( const contact_work* work, bool is_start )
{
    contact_soup* s = work->soup;
    bool restored = false;
    for ( int g = 0; g < work->state->guest_count; ++g )
    {
        contact_guest* guest = work->state->guests + g;
        guest->halted = wisp_frame_is_halted( work->frame, guest->entity );
        gather_now( work, guest );
        if ( is_start )
        {
            restored = take_quads( work, guest, s->safe ) || restored;
        }
    }
    for ( int g = 0; g < work->state->guest_count && is_start; ++g )
    {
        start_over( work, work->state->guests + g );
    }
    s->is_listed = s->is_listed && restored == false;
    set_wrong_aside( s );
}

// Weights are the entity's, so a quad's fourth number stays what it is there. What has none here was not moved.
static void scatter_particles( const contact_work* work, const contact_guest* guest )
{
    float* position = wisp_frame_column( work->frame, guest->entity, WISP_PARTICLE_POSITION, 0 );
    const float* now = work->soup->now + (size_t)guest->first_point * 4;
    for ( size_t i = 0; i < (size_t)guest->point_count * 4; i += 4 )
    {
        if ( now[i + 3] > 0.0f )
        {
            memcpy( position + i, now + i, 3 * sizeof( float ) );
        }
    }
}

// What recovery moved has not moved by itself: where it came from goes along.
static void shift_previous( const contact_work* work, const contact_guest* guest )
{
    const contact_soup* s = work->soup;
    if ( guest->is_strands )
    {
        const wisp_strand_topology* t = wisp_frame_strands( work->frame, guest->entity );
        float* rows = wisp_frame_column( work->frame, guest->entity, WISP_STRAND_PREVIOUS, 0 );
        for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
        {
            for ( int i = 0; i < t->lane_count[lane]; ++i )
            {
                const int point = guest->first_point + t->offsets[t->lane_strand[lane]] + i;
                for ( int k = 0; k < 3; ++k )
                {
                    rows[lane_of( t, lane, i, 3 ) + (size_t)( k * WISP_LANES )] +=
                        s->shift[(size_t)point * 4 + (size_t)k];
                }
            }
        }
        return;
    }
    float* previous = wisp_frame_column( work->frame, guest->entity, WISP_PARTICLE_PREVIOUS, 0 );
    const float* shift = s->shift + (size_t)guest->first_point * 4;
    for ( size_t i = 0; i < (size_t)guest->point_count * 4; i += 4 )
    {
        for ( size_t k = 0; k < 3; ++k )
        {
            previous[i + k] += shift[i + k];
        }
    }
}

void contact_scatter( const contact_work* work, bool is_end )
{
    contact_soup* s = work->soup;
    for ( size_t i = 0; i < (size_t)s->point_count * 4 && is_end; i += 4 )
    {
        memcpy( s->safe + i, s->now + i, 3 * sizeof( float ) );
    }
    for ( int g = 0; g < work->state->guest_count; ++g )
    {
        const contact_guest* guest = work->state->guests + g;
        if ( guest->halted == false && guest->is_strands )
        {
            float* rows = wisp_frame_column( work->frame, guest->entity, WISP_STRAND_POSITION, 0 );
            move_strands( wisp_frame_strands( work->frame, guest->entity ), guest,
                          ( strand_way ){ rows, s->now, true, 3 } );
        }
        else if ( guest->halted == false )
        {
            scatter_particles( work, guest );
        }
        if ( is_end )
        {
            shift_previous( work, guest );
        }
        if ( is_end && guest->halted ) // no pass of its own runs
        {
            contact_keep_guest( work, guest );
        }
    }
}

void contact_keep_guest( const contact_work* work, const contact_guest* guest )
{
    if ( guest->is_strands )
    {
        float* rows = wisp_frame_column( work->frame, guest->entity, work->state->strand_safe, 0 );
        move_strands( wisp_frame_strands( work->frame, guest->entity ), guest,
                      ( strand_way ){ rows, work->soup->safe, true, 3 } );
        return;
    }
    memcpy( wisp_frame_column( work->frame, guest->entity, work->state->particle_safe, 0 ),
            work->soup->safe + (size_t)guest->first_point * 4, (size_t)guest->point_count * 4 * sizeof( float ) );
}
