// Points from the columns of their entities into the soup, and back.
#include "contact_internal.h"

#include <stdatomic.h>
#include <string.h>

enum
{
    GRAIN = 1024, // points
};

// ---- strands ----

// Where vertex i of strands stands: its lane in rows of so many numbers, which are 1 or 3.
static size_t lane_of( const wisp_strand_topology* t, int lane, int i, int numbers )
{
    const size_t row = (size_t)t->group_row[lane / WISP_LANES] + (size_t)i;
    return row * (size_t)numbers * WISP_LANES + (size_t)( lane % WISP_LANES );
}

// Places of strands, vertex by vertex.
typedef struct strand_way
{
    float* column;
    float* quads;
    bool is_out; // from the quads to the column
} strand_way;

// @return whether anything changed
static bool move_strands( const wisp_strand_topology* t, const contact_guest* guest, strand_way way )
{
    bool changed = false;
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        for ( int i = 0; i < t->lane_count[lane]; ++i )
        {
            float* x = way.column + lane_of( t, lane, i, 3 );
            float* q = way.quads + (size_t)( guest->first_point + t->offsets[t->lane_strand[lane]] + i ) * 4;
            for ( int k = 0; k < 3; ++k )
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
            quads[(size_t)( guest->first_point + t->offsets[t->lane_strand[lane]] + i ) * 4 + 3] =
                weight[lane_of( t, lane, i, 1 )];
        }
    }
}

// What moved has moved along with what it came from.
static void shift_strands( const contact_work* work, const contact_guest* guest )
{
    const contact_soup* s = work->soup;
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
}

// ---- gathering ----

typedef struct gather_loop
{
    const contact_work* work;
    const contact_guest* guest;
    const float* position;    // quads; null if they are gathered already
    const float* safe;        // quads, where it was safe by its column; null but at the start of a substep
    const float* start;       // quads, where it begins; likewise
    _Atomic bool is_restored; // its column has other bits than the warm copy: it was written from outside
    _Atomic bool has_jumped;
} gather_loop;

static void copy_points( gather_loop* loop, int begin, int end )
{
    contact_soup* s = loop->work->soup;
    const size_t at = (size_t)( loop->guest->first_point + begin ) * 4, from = (size_t)begin * 4;
    const size_t bytes = (size_t)( end - begin ) * 4 * sizeof( float );
    memcpy( s->now + at, loop->position + from, bytes );
    if ( loop->safe != NULL && memcmp( s->safe + at, loop->safe + from, bytes ) != 0 )
    {
        memcpy( s->safe + at, loop->safe + from, bytes );
        atomic_store( &loop->is_restored, true );
    }
}

// What does not begin where it was safe was moved by the user, or put back. What is less than half of a thickness is a way like
// others; a place that is no number is none to stay at.
static bool is_elsewhere( const contact_soup* s, const float* start, const float* safe )
{
    const float most = 0.5f * s->least_thickness;
    const float x = start[0] - safe[0], y = start[1] - safe[1], z = start[2] - safe[2];
    return !( x * x + y * y + z * z <= most * most );
}

// A number that went wrong is the entity's, which will be halted for it: here the point stands where it was and takes no part.
static void set_wrong_aside( float* now, const float* safe )
{
    static const float FARTHEST = 1e6f; // m, as far as a surface may be from the origin
    const float x = now[0] - safe[0], y = now[1] - safe[1], z = now[2] - safe[2];
    if ( !( x * x + y * y + z * z < FARTHEST * FARTHEST ) )
    {
        memcpy( now, safe, 3 * sizeof( float ) );
        now[3] = 0.0f;
    }
}

static void gather_points( void* context, int begin, int end, int worker )
{
    (void)worker;
    gather_loop* loop = context;
    contact_soup* s = loop->work->soup;
    if ( loop->position != NULL )
    {
        copy_points( loop, begin, end );
    }
    bool jumped = false;
    for ( int i = begin; i < end; ++i )
    {
        const size_t at = (size_t)( loop->guest->first_point + i ) * 4;
        jumped = jumped || ( loop->start != NULL && is_elsewhere( s, loop->start + (size_t)i * 4, s->safe + at ) );
        s->now[at + 3] = loop->guest->halted ? 0.0f : s->now[at + 3];
        set_wrong_aside( s->now + at, s->safe + at );
    }
    if ( jumped )
    {
        atomic_store( &loop->has_jumped, true );
    }
}

// One that is halted does not move, and what it came from means nothing.
static const float* find_start( const contact_work* work, const contact_guest* guest )
{
    const bool is_strands = guest->is_strands;
    float* start = wisp_frame_column( work->frame, guest->entity,
                                      is_strands ? WISP_STRAND_PREVIOUS : WISP_PARTICLE_PREVIOUS, 0 );
    if ( guest->halted || start == NULL )
    {
        start = wisp_frame_column( work->frame, guest->entity,
                                   is_strands ? WISP_STRAND_POSITION : WISP_PARTICLE_POSITION, 0 );
    }
    if ( is_strands )
    {
        float* quads = work->soup->shift; // not in use yet
        move_strands( wisp_frame_strands( work->frame, guest->entity ), guest,
                      ( strand_way ){ start, quads, false } );
        return quads + (size_t)guest->first_point * 4;
    }
    return start;
}

static void gather_strands( gather_loop* loop, bool is_start )
{
    const contact_work* work = loop->work;
    const contact_guest* guest = loop->guest;
    const wisp_strand_topology* t = wisp_frame_strands( work->frame, guest->entity );
    float* rows = wisp_frame_column( work->frame, guest->entity, WISP_STRAND_POSITION, 0 );
    move_strands( t, guest, ( strand_way ){ rows, work->soup->now, false } );
    gather_strand_weights( t, guest, wisp_frame_column( work->frame, guest->entity, WISP_STRAND_WEIGHT, 0 ),
                           work->soup->now );
    if ( is_start )
    {
        float* safe = wisp_frame_column( work->frame, guest->entity, work->state->strand_safe, 0 );
        atomic_store( &loop->is_restored, move_strands( t, guest, ( strand_way ){ safe, work->soup->safe, false } ) );
    }
}

static void gather_guest( const contact_work* work, const contact_guest* guest, bool is_start )
{
    contact_soup* s = work->soup;
    gather_loop loop = { .work = work, .guest = guest };
    atomic_init( &loop.is_restored, false );
    atomic_init( &loop.has_jumped, false );
    if ( guest->is_strands )
    {
        gather_strands( &loop, is_start );
    }
    else
    {
        loop.position = wisp_frame_column( work->frame, guest->entity, WISP_PARTICLE_POSITION, 0 );
        loop.safe = is_start ? wisp_frame_column( work->frame, guest->entity, work->state->particle_safe, 0 ) : NULL;
    }
    loop.start = is_start ? find_start( work, guest ) : NULL;
    wisp_parallel_for( work->parallel, guest->point_count, GRAIN, gather_points, &loop );
    s->is_listed = s->is_listed && atomic_load( &loop.is_restored ) == false;
    if ( is_start == false )
    {
        return;
    }
    contact_settings* settings = wisp_frame_column( work->frame, guest->entity, work->state->settings, 0 );
    if ( settings->is_new != 0 || atomic_load( &loop.has_jumped ) ) // it is safe where it begins
    {
        for ( int i = 0; i < guest->point_count; ++i )
        {
            memcpy( s->safe + (size_t)( guest->first_point + i ) * 4, loop.start + (size_t)i * 4,
                    3 * sizeof( float ) );
        }
        s->is_anew = true;
        work->memory->tangled = 1;
        gather_guest( work, guest, false );
    }
    settings->is_new = 0;
}

void contact_gather( const contact_work* work, bool is_start )
{
    for ( int g = 0; g < work->state->guest_count; ++g )
    {
        contact_guest* guest = work->state->guests + g;
        guest->halted = wisp_frame_is_halted( work->frame, guest->entity );
        gather_guest( work, guest, is_start );
    }
}

// ---- scattering ----

typedef struct scatter_loop
{
    contact_soup* soup;
    const contact_guest* guest;
    float *position, *previous; // quads; null where they stay
    bool is_end;
} scatter_loop;

// Weights are the entity's, so a quad's fourth number stays what it is there. What has none here was not moved. What recovery
// moved has not moved by itself: where it came from goes along.
static void scatter_points( void* context, int begin, int end, int worker )
{
    (void)worker;
    const scatter_loop* loop = context;
    const contact_soup* s = loop->soup;
    for ( int i = begin; i < end; ++i )
    {
        const size_t at = (size_t)( loop->guest->first_point + i ) * 4, to = (size_t)i * 4;
        if ( loop->is_end )
        {
            memcpy( s->safe + at, s->now + at, 3 * sizeof( float ) );
        }
        if ( loop->position != NULL && s->now[at + 3] > 0.0f )
        {
            memcpy( loop->position + to, s->now + at, 3 * sizeof( float ) );
        }
        for ( size_t k = 0; k < 3 && loop->previous != NULL; ++k )
        {
            loop->previous[to + k] += s->shift[at + k];
        }
    }
}

static void scatter_strands( const contact_work* work, const contact_guest* guest, bool is_end )
{
    if ( guest->halted == false )
    {
        float* rows = wisp_frame_column( work->frame, guest->entity, WISP_STRAND_POSITION, 0 );
        move_strands( wisp_frame_strands( work->frame, guest->entity ), guest,
                      ( strand_way ){ rows, work->soup->now, true } );
    }
    if ( is_end )
    {
        shift_strands( work, guest );
    }
}

void contact_scatter( const contact_work* work, bool is_end )
{
    for ( int g = 0; g < work->state->guest_count; ++g )
    {
        const contact_guest* guest = work->state->guests + g;
        scatter_loop loop = { .soup = work->soup, .guest = guest, .is_end = is_end };
        if ( guest->is_strands )
        {
            scatter_strands( work, guest, is_end );
        }
        else
        {
            loop.position =
                guest->halted ? NULL : wisp_frame_column( work->frame, guest->entity, WISP_PARTICLE_POSITION, 0 );
            loop.previous =
                is_end ? wisp_frame_column( work->frame, guest->entity, WISP_PARTICLE_PREVIOUS, 0 ) : NULL;
        }
        wisp_parallel_for( work->parallel, guest->point_count, GRAIN, scatter_points, &loop );
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
                      ( strand_way ){ rows, work->soup->safe, true } );
        return;
    }
    memcpy( wisp_frame_column( work->frame, guest->entity, work->state->particle_safe, 0 ),
            work->soup->safe + (size_t)guest->first_point * 4, (size_t)guest->point_count * 4 * sizeof( float ) );
}
