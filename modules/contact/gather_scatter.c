// Gather and scatter: positions between the columns of the participants and the contact mesh. In: position, previous
// position and inverse mass of particles and strands. Out: `now` and `intersection_free` of the mesh; after the
// projections, the columns.
#include "gather_scatter.h"

#include "spheres.h"

#include <stdatomic.h>
#include <string.h>

// ---- strands ----

// Return the index of the first vertex of a lane in rows of 1 or 3 numbers per vertex.
static size_t lane_of( const wisp_strand_topology* t, int lane, int numbers )
{
    return (size_t)t->group_row[lane / WISP_LANES] * (size_t)numbers * WISP_LANES + (size_t)( lane % WISP_LANES );
}

typedef struct strand_way
{
    float* column; // rows of lanes
    float* xyzw;   // [point][4], from the first number that is moved on
    int numbers;   // of a vertex
    bool is_out;   // from the quads to the column
    bool adds;     // to what is there
    float small;   // what changes by no more does not count
} strand_way;

// Copy numbers of groups of strands, vertex by vertex.
// @return most that a number changed by, or 0 if all is small
static inline float move_groups( const wisp_strand_topology* t, const contact_participant* participant,
                                 strand_way way, int begin, int end )
{
    float most = 0.0f;
    for ( int lane = begin * WISP_LANES; lane < end * WISP_LANES; ++lane )
    {
        const int count = t->lane_count[lane];
        float* x = way.column + ( count > 0 ? lane_of( t, lane, way.numbers ) : 0 );
        float* q = way.xyzw;
        q += count > 0 ? (size_t)( participant->first_point + t->offsets[t->lane_strand[lane]] ) * 4 : 0;
        for ( int i = 0; i < count; ++i, x += way.numbers * WISP_LANES, q += 4 )
        {
            for ( int k = 0; k < way.numbers; ++k )
            {
                float *from = way.is_out ? q + k : x + k * WISP_LANES, *to = way.is_out ? x + k * WISP_LANES : q + k;
                const float value = way.adds ? *to + *from : *from, change = fabsf( *to - value );
                most = change <= way.small || change <= most ? most : isnan( change ) ? INFINITY : change;
                *to = value;
            }
        }
    }
    return most;
}

static bool move_strands( const wisp_strand_topology* t, const contact_participant* participant, strand_way way )
{
    return move_groups( t, participant, way, 0, t->group_count ) > 0.0f;
}

// Return whether rows or spheres may push a point of a group.
static bool may_push( const wisp_strand_topology* t, const uint8_t* is_pushed, int group )
{
    bool any = false;
    for ( int lane = group * WISP_LANES; lane < ( group + 1 ) * WISP_LANES && any == false; ++lane )
    {
        const int count = t->lane_count[lane];
        any = count > 0 && memchr( is_pushed + t->offsets[t->lane_strand[lane]], 1, (size_t)count ) != NULL;
    }
    return any;
}

// Push that needs no further turn of lengths, in thicknesses.
static const float SMALL_PUSH = 0.02f;

typedef struct lengths_loop
{
    const contact_work* work;
    const contact_participant* participant;
    wisp_span span;
    _Atomic uint32_t pushed; // bits of a float, m: those of numbers from 0 on have their order
} lengths_loop;

static void raise_push( _Atomic uint32_t* most, float value )
{
    uint32_t bits, now = atomic_load( most );
    memcpy( &bits, &value, sizeof( bits ) );
    while ( now < bits && atomic_compare_exchange_weak( most, &now, bits ) == false )
    {
    }
}

static void restore_groups( void* context, int begin, int end, int worker )
{
    lengths_loop* loop = context;
    wisp_frame* frame = loop->work->frame;
    const wisp_strand_topology* t = wisp_frame_strands( frame, loop->participant->entity );
    const strand_way in = { .column = wisp_frame_column( frame, loop->participant->entity, WISP_STRAND_POSITION, 0 ),
                            .xyzw = loop->work->contact_mesh->now,
                            .numbers = 3 };
    strand_way out = in;
    out.is_out = true;
    out.small = SMALL_PUSH * loop->work->contact_mesh->min_thickness;
    wisp_span span = loop->span;
    span.worker = worker;
    const uint8_t* is_pushed = loop->work->contact_mesh->is_pushed + loop->participant->first_point;
    for ( int group = begin; group < end; ++group )
    {
        span.begin = group;
        span.end = group + 1;
        const float pushed =
            may_push( t, is_pushed, group ) ? move_groups( t, loop->participant, out, group, group + 1 ) : 0.0f;
        if ( pushed > 0.0f )
        {
            wisp_frame_project_again( frame, &span );
            (void)move_groups( t, loop->participant, in, group, group + 1 );
            raise_push( &loop->pushed, pushed );
        }
    }
}

float contact_restore_lengths( const contact_work* work, const wisp_span* span )
{
    uint32_t bits = 0;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        if ( participant->is_strands && participant->is_left_out == false && participant->halted == false )
        {
            lengths_loop loop = { .work = work, .participant = participant, .span = *span };
            loop.span.entity = participant->entity;
            loop.span.iteration = wisp_frame_iterations( work->frame ); // lengths alone; tensions add up
            atomic_init( &loop.pushed, bits );
            wisp_parallel_for( work->parallel, wisp_frame_strands( work->frame, participant->entity )->group_count, 1,
                               restore_groups, &loop );
            bits = atomic_load( &loop.pushed );
        }
    }
    float pushed;
    memcpy( &pushed, &bits, sizeof( pushed ) );
    return pushed;
}

// ---- gathering ----

typedef struct gather_loop
{
    const contact_work* work;
    const contact_participant* participant;
    const float* position;          // [vertex][4]; null if gathered already
    const float* intersection_free; // [vertex][4], of its column; null except at the start of a substep
    const float* start;             // [vertex][4], previous positions; likewise
    _Atomic bool is_restored;       // the column differs from the mesh: it was written from outside
    _Atomic bool has_jumped;
} gather_loop;

static void copy_points( gather_loop* loop, int begin, int end )
{
    contact_contact_mesh* s = loop->work->contact_mesh;
    const size_t at = (size_t)( loop->participant->first_point + begin ) * 4, from = (size_t)begin * 4;
    const size_t bytes = (size_t)( end - begin ) * 4 * sizeof( float );
    memcpy( s->now + at, loop->position + from, bytes );
    if ( loop->intersection_free != NULL &&
         memcmp( s->intersection_free + at, loop->intersection_free + from, bytes ) != 0 )
    {
        memcpy( s->intersection_free + at, loop->intersection_free + from, bytes );
        atomic_store( &loop->is_restored, true );
    }
}

// Take from a way what leads out of the half spaces of a point: bodies push out what starts inside, together with its previous
// position. That is an ordinary displacement, however long.
static void drop_pushes( const contact_participant* participant, int i, float way[3] )
{
    const int found = participant->half_spaces != NULL ? participant->half_spaces[i] : 0;
    for ( int k = 0; k < found && k < WISP_MAX_HALF_SPACES; ++k )
    {
        const float* normal = participant->half_space_row + ( (size_t)i * WISP_MAX_HALF_SPACES + (size_t)k ) * 16 + 3;
        const float out = way[0] * normal[0] + way[1] * normal[1] + way[2] * normal[2];
        for ( int c = 0; c < 3 && out > 0.0f; ++c )
        {
            way[c] -= out * normal[c];
        }
    }
}

// Return whether a point starts elsewhere than it ended: the user moved it, or its entity was restored. Less than
// half a thickness counts as ordinary displacement. NaN counts as elsewhere.
static bool is_elsewhere( const gather_loop* loop, int i )
{
    const contact_contact_mesh* s = loop->work->contact_mesh;
    const float most = 0.5f * s->min_thickness, *start = loop->start + (size_t)i * 4;
    const float* ended = s->intersection_free + (size_t)( loop->participant->first_point + i ) * 4;
    float way[3] = { start[0] - ended[0], start[1] - ended[1], start[2] - ended[2] };
    if ( way[0] * way[0] + way[1] * way[1] + way[2] * way[2] <= most * most )
    {
        return false;
    }
    drop_pushes( loop->participant, i, way );
    return !( way[0] * way[0] + way[1] * way[1] + way[2] * way[2] <= most * most );
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
    contact_contact_mesh* s = loop->work->contact_mesh;
    if ( loop->position != NULL )
    {
        copy_points( loop, begin, end );
    }
    const bool are_spheres = loop->work->settings->level == WISP_CONTACT_SPHERES;
    bool jumped = false;
    for ( int i = begin; i < end && ( are_spheres == false || loop->participant->halted ); ++i )
    {
        const size_t at = (size_t)( loop->participant->first_point + i ) * 4;
        jumped = jumped || ( loop->start != NULL && is_elsewhere( loop, i ) );
        s->now[at + 3] = loop->participant->halted ? 0.0f : s->now[at + 3];
        pin_not_finite( s->now + at, s->intersection_free + at );
    }
    if ( jumped )
    {
        atomic_store( &loop->has_jumped, true );
    }
}

// Find the positions at the start of the substep. A halted participant does not move, so its previous positions do
// not count.
static const float* find_start( const contact_work* work, const contact_participant* participant )
{
    const bool is_strands = participant->is_strands;
    float* start = wisp_frame_column( work->frame, participant->entity,
                                      is_strands ? WISP_STRAND_PREVIOUS : WISP_PARTICLE_PREVIOUS, 0 );
    if ( participant->halted || start == NULL )
    {
        start = wisp_frame_column( work->frame, participant->entity,
                                   is_strands ? WISP_STRAND_POSITION : WISP_PARTICLE_POSITION, 0 );
    }
    if ( is_strands )
    {
        float* xyzw = work->contact_mesh->shift; // unused until the end of the substep
        move_strands( wisp_frame_strands( work->frame, participant->entity ), participant,
                      ( strand_way ){ .column = start, .xyzw = xyzw, .numbers = 3 } );
        return xyzw + (size_t)participant->first_point * 4;
    }
    return start;
}

static void gather_strands( gather_loop* loop, bool starts, bool has_rows )
{
    const contact_work* work = loop->work;
    const contact_participant* participant = loop->participant;
    const wisp_strand_topology* t = wisp_frame_strands( work->frame, participant->entity );
    float* rows = wisp_frame_column( work->frame, participant->entity, WISP_STRAND_POSITION, 0 );
    move_strands( t, participant, ( strand_way ){ .column = rows, .xyzw = work->contact_mesh->now, .numbers = 3 } );
    if ( starts ) // surfaces have theirs beside their positions
    {
        float* weights = wisp_frame_column( work->frame, participant->entity, WISP_STRAND_INVERSE_MASS, 0 );
        (void)move_strands( t, participant,
                            ( strand_way ){ .column = weights, .xyzw = work->contact_mesh->now + 3, .numbers = 1 } );
    }
    if ( starts && has_rows )
    {
        float* intersection_free =
            wisp_frame_column( work->frame, participant->entity, work->components->strand_free, 0 );
        atomic_store( &loop->is_restored, move_strands( t, participant,
                                                        ( strand_way ){ .column = intersection_free,
                                                                        .xyzw = work->contact_mesh->intersection_free,
                                                                        .numbers = 3 } ) );
    }
}

static void gather_participant( const contact_work* work, const contact_participant* participant, bool is_start )
{
    contact_contact_mesh* s = work->contact_mesh;
    gather_loop loop = { .work = work, .participant = participant };
    const bool has_rows = work->settings->level != WISP_CONTACT_SPHERES;
    const float* start = is_start ? find_start( work, participant ) : NULL;
    atomic_init( &loop.is_restored, false );
    atomic_init( &loop.has_jumped, false );
    if ( is_start && has_rows == false )
    {
        memcpy( s->intersection_free + (size_t)participant->first_point * 4, start,
                (size_t)participant->point_count * 4 * sizeof( float ) );
    }
    if ( participant->is_strands )
    {
        gather_strands( &loop, is_start, has_rows );
    }
    else
    {
        loop.position = wisp_frame_column( work->frame, participant->entity, WISP_PARTICLE_POSITION, 0 );
        loop.intersection_free = is_start && has_rows ? wisp_frame_column( work->frame, participant->entity,
                                                                           work->components->particle_free, 0 )
                                                      : NULL;
    }
    loop.start = has_rows ? start : NULL;
    wisp_parallel_for( work->parallel, participant->point_count, CONTACT_POINT_GRAIN, gather_points, &loop );
    s->is_listed = s->is_listed && atomic_load( &loop.is_restored ) == false;
    if ( loop.start == NULL )
    {
        return;
    }
    contact_settings* settings = wisp_frame_column( work->frame, participant->entity, work->components->settings, 0 );
    if ( settings->is_new != 0 || atomic_load( &loop.has_jumped ) ) // its start counts as intersection-free
    {
        for ( int i = 0; i < participant->point_count; ++i )
        {
            memcpy( s->intersection_free + (size_t)( participant->first_point + i ) * 4, loop.start + (size_t)i * 4,
                    3 * sizeof( float ) );
        }
        if ( participant->loads != NULL )
        {
            memset( participant->loads, 0, (size_t)participant->point_count * sizeof( contact_load ) );
        }
        s->is_reset = true;
        work->memory->tangled = 1;
        gather_participant( work, participant, false );
    }
    settings->is_new = 0;
}

void contact_gather( const contact_work* work, bool is_start )
{
    for ( int g = 0; g < work->participant_count; ++g )
    {
        contact_participant* participant = work->participants + g;
        if ( participant->is_left_out )
        {
            continue;
        }
        participant->halted = wisp_frame_is_halted( work->frame, participant->entity );
        participant->position = wisp_frame_column( work->frame, participant->entity, WISP_PARTICLE_POSITION, 0 );
        participant->previous = wisp_frame_column( work->frame, participant->entity, WISP_PARTICLE_PREVIOUS, 0 );
        participant->is_corrected = wisp_frame_has( work->frame, participant->entity, WISP_PARTICLE_EXTERNAL_SOLVER );
        participant->thickness = wisp_frame_column( work->frame, participant->entity, WISP_MAP_CONTACT_THICKNESS, 0 );
        participant->friction = wisp_frame_column( work->frame, participant->entity, WISP_MAP_CONTACT_FRICTION, 0 );
        participant->half_spaces =
            wisp_frame_column( work->frame, participant->entity, WISP_PARTICLE_HALF_SPACES, 0 );
        participant->half_space_row =
            wisp_frame_column( work->frame, participant->entity, WISP_PARTICLE_HALF_SPACES, 2 );
        participant->loads =
            wisp_frame_column( work->frame, participant->entity, work->components->particle_free, 1 );
        gather_participant( work, participant, is_start );
    }
}

// ---- scattering ----

typedef struct scatter_loop
{
    contact_contact_mesh* contact_mesh;
    const contact_participant* participant;
    float *position, *previous; // [vertex][4]; null where they stay
    bool is_final;              // positions become the intersection-free ones
} scatter_loop;

// The inverse mass in the fourth place stays the entity's own. Points without inverse mass did not move. The shift of
// recovery and untangling goes to the previous position too, so that it gives no velocity.
static void scatter_points( void* context, int begin, int end, int worker )
{
    (void)worker;
    const scatter_loop* loop = context;
    const contact_contact_mesh* s = loop->contact_mesh;
    for ( int i = begin; i < end; ++i )
    {
        const size_t at = (size_t)( loop->participant->first_point + i ) * 4, to = (size_t)i * 4;
        if ( loop->is_final )
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

// The shift of each vertex goes to its previous position, so that it gives no velocity.
static void scatter_strands( const contact_work* work, const contact_participant* participant, bool is_end )
{
    const wisp_strand_topology* t = wisp_frame_strands( work->frame, participant->entity );
    strand_way way = { .numbers = 3, .is_out = true };
    if ( participant->halted == false )
    {
        way.column = wisp_frame_column( work->frame, participant->entity, WISP_STRAND_POSITION, 0 );
        way.xyzw = work->contact_mesh->now;
        (void)move_strands( t, participant, way );
    }
    if ( is_end )
    {
        way.column = wisp_frame_column( work->frame, participant->entity, WISP_STRAND_PREVIOUS, 0 );
        way.xyzw = work->contact_mesh->shift;
        way.adds = true;
        (void)move_strands( t, participant, way );
    }
}

void contact_scatter( const contact_work* work, bool is_end, bool is_final )
{
    const bool are_spheres = work->settings->level == WISP_CONTACT_SPHERES;
    if ( are_spheres )
    {
        contact_scatter_spheres( work, is_end );
    }
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        if ( participant->is_left_out || ( are_spheres && participant->is_strands == false ) )
        {
            continue;
        }
        scatter_loop loop = { .contact_mesh = work->contact_mesh, .participant = participant, .is_final = is_final };
        if ( participant->is_strands )
        {
            scatter_strands( work, participant, is_end );
        }
        else
        {
            loop.position = participant->halted
                                ? NULL
                                : wisp_frame_column( work->frame, participant->entity, WISP_PARTICLE_POSITION, 0 );
            loop.previous =
                is_end ? wisp_frame_column( work->frame, participant->entity, WISP_PARTICLE_PREVIOUS, 0 ) : NULL;
        }
        wisp_parallel_for( work->parallel, participant->point_count, CONTACT_POINT_GRAIN, scatter_points, &loop );
        if ( is_final && participant->halted ) // its own passes do not run
        {
            contact_keep_participant( work, participant );
        }
    }
}

void contact_keep_participant( const contact_work* work, const contact_participant* participant )
{
    if ( participant->is_left_out )
    {
        return;
    }
    if ( participant->is_strands )
    {
        float* rows = wisp_frame_column( work->frame, participant->entity, work->components->strand_free, 0 );
        move_strands(
            wisp_frame_strands( work->frame, participant->entity ), participant,
            ( strand_way ){
                .column = rows, .xyzw = work->contact_mesh->intersection_free, .numbers = 3, .is_out = true } );
        return;
    }
    memcpy( wisp_frame_column( work->frame, participant->entity, work->components->particle_free, 0 ),
            work->contact_mesh->intersection_free + (size_t)participant->first_point * 4,
            (size_t)participant->point_count * 4 * sizeof( float ) );
}
