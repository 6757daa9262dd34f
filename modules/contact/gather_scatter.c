// Gather and scatter: positions between the columns of the participants and the contact mesh. In: position, previous
// position and inverse mass of particles and strands. Out: `now` and `intersection_free` of the mesh; after the
// projections, the columns.
#include "gather_scatter.h"

#include <stdatomic.h>
#include <string.h>

enum
{
    GRAIN = 1024, // points
};

// ---- strands ----

// Return the index of vertex i of a lane in rows of 1 or 3 numbers per vertex.
static size_t lane_of( const wisp_strand_topology* t, int lane, int i, int numbers )
{
    const size_t row = (size_t)t->group_row[lane / WISP_LANES] + (size_t)i;
    return row * (size_t)numbers * WISP_LANES + (size_t)( lane % WISP_LANES );
}

typedef struct strand_way
{
    float* column; // rows of lanes
    float* quads;  // [point][4]
    bool is_out;   // from the quads to the column
} strand_way;

// Copy positions of strands, vertex by vertex.
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

// Add the shift of each vertex to its previous position, so that it gives no velocity.
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
    const float* position;          // [vertex][4]; null if gathered already
    const float* intersection_free; // [vertex][4], of its column; null except at the start of a substep
    const float* start;             // [vertex][4], previous positions; likewise
    _Atomic bool is_restored;       // the column differs from the mesh: it was written from outside
    _Atomic bool has_jumped;
} gather_loop;

static void copy_points( gather_loop* loop, int begin, int end )
{
    contact_soup* s = loop->work->soup;
    const size_t at = (size_t)( loop->guest->first_point + begin ) * 4, from = (size_t)begin * 4;
    const size_t bytes = (size_t)( end - begin ) * 4 * sizeof( float );
    memcpy( s->now + at, loop->position + from, bytes );
    if ( loop->intersection_free != NULL &&
         memcmp( s->intersection_free + at, loop->intersection_free + from, bytes ) != 0 )
    {
        memcpy( s->intersection_free + at, loop->intersection_free + from, bytes );
        atomic_store( &loop->is_restored, true );
    }
}

// Return whether a point starts elsewhere than it ended: the user moved it, or its entity was restored. Less than
// half a thickness counts as ordinary displacement. NaN counts as elsewhere.
static bool is_elsewhere( const contact_soup* s, const float* start, const float* intersection_free )
{
    const float most = 0.5f * s->least_thickness;
    const float x = start[0] - intersection_free[0], y = start[1] - intersection_free[1],
                z = start[2] - intersection_free[2];
    return !( x * x + y * y + z * z <= most * most );
}

// Pin a point whose position is not finite at its intersection-free position. The engine halts the entity for it.
static void pin_not_finite( float* now, const float* intersection_free )
{
    static const float FARTHEST = 1e6f; // m, in a substep
    const float x = now[0] - intersection_free[0], y = now[1] - intersection_free[1],
                z = now[2] - intersection_free[2];
    if ( !( x * x + y * y + z * z < FARTHEST * FARTHEST ) )
    {
        memcpy( now, intersection_free, 3 * sizeof( float ) );
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
        jumped = jumped ||
                 ( loop->start != NULL && is_elsewhere( s, loop->start + (size_t)i * 4, s->intersection_free + at ) );
        s->now[at + 3] = loop->guest->halted ? 0.0f : s->now[at + 3];
        pin_not_finite( s->now + at, s->intersection_free + at );
    }
    if ( jumped )
    {
        atomic_store( &loop->has_jumped, true );
    }
}

// Find the positions at the start of the substep. A halted participant does not move, so its previous positions do
// not count.
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
        float* quads = work->soup->shift; // unused until the end of the substep
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
        float* intersection_free = wisp_frame_column( work->frame, guest->entity, work->components->strand_free, 0 );
        atomic_store(
            &loop->is_restored,
            move_strands( t, guest, ( strand_way ){ intersection_free, work->soup->intersection_free, false } ) );
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
        loop.intersection_free =
            is_start ? wisp_frame_column( work->frame, guest->entity, work->components->particle_free, 0 ) : NULL;
    }
    loop.start = is_start ? find_start( work, guest ) : NULL;
    wisp_parallel_for( work->parallel, guest->point_count, GRAIN, gather_points, &loop );
    s->is_listed = s->is_listed && atomic_load( &loop.is_restored ) == false;
    if ( is_start == false )
    {
        return;
    }
    contact_settings* settings = wisp_frame_column( work->frame, guest->entity, work->components->settings, 0 );
    if ( settings->is_new != 0 || atomic_load( &loop.has_jumped ) ) // its start counts as intersection-free
    {
        for ( int i = 0; i < guest->point_count; ++i )
        {
            memcpy( s->intersection_free + (size_t)( guest->first_point + i ) * 4, loop.start + (size_t)i * 4,
                    3 * sizeof( float ) );
        }
        s->is_reset = true;
        work->memory->tangled = 1;
        gather_guest( work, guest, false );
    }
    settings->is_new = 0;
}

void contact_gather( const contact_work* work, bool is_start )
{
    for ( int g = 0; g < work->guest_count; ++g )
    {
        contact_guest* guest = work->guests + g;
        guest->halted = wisp_frame_is_halted( work->frame, guest->entity );
        gather_guest( work, guest, is_start );
    }
}

// ---- scattering ----

typedef struct scatter_loop
{
    contact_soup* soup;
    const contact_guest* guest;
    float *position, *previous; // [vertex][4]; null where they stay
    bool is_end;
} scatter_loop;

// The inverse mass in the fourth place stays the entity's own. Points without inverse mass did not move. The shift of
// recovery and untangling goes to the previous position too, so that it gives no velocity.
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
            memcpy( s->intersection_free + at, s->now + at, 3 * sizeof( float ) );
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
    for ( int g = 0; g < work->guest_count; ++g )
    {
        const contact_guest* guest = work->guests + g;
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
        if ( is_end && guest->halted ) // its own passes do not run
        {
            contact_keep_guest( work, guest );
        }
    }
}

void contact_keep_guest( const contact_work* work, const contact_guest* guest )
{
    if ( guest->is_strands )
    {
        float* rows = wisp_frame_column( work->frame, guest->entity, work->components->strand_free, 0 );
        move_strands( wisp_frame_strands( work->frame, guest->entity ), guest,
                      ( strand_way ){ rows, work->soup->intersection_free, true } );
        return;
    }
    memcpy( wisp_frame_column( work->frame, guest->entity, work->components->particle_free, 0 ),
            work->soup->intersection_free + (size_t)guest->first_point * 4,
            (size_t)guest->point_count * 4 * sizeof( float ) );
}
