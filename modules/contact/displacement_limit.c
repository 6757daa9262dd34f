// Displacement limit: nothing passes through (the role of the step limit in IPC, Li et al. 2020). In: rows, positions,
// intersection-free positions. Out: positions on their sides of all planes.
//
// Distances to a plane are linear in time. So two convex primitives that end on their sides of the plane between them
// have not met. A pair that ends nearer to its plane than a tenth of its gap (or 0.99 of its distance, if that is
// less) is moved to the nearest positions, weighed by mass, that are a little farther: along the normal, by equal and
// opposite impulses. Each pair allows a convex set of positions, and the start is in all of them. So rounds over the
// pairs converge (Bregman 1965, successive projections), momentum is kept, and kinetic energy does not grow.
//
// Pinned points are not moved. What they drive into goes ahead of them, layer by layer; then there may be no positions
// that all pairs allow. After PARTIAL_ROUNDS free points go back to their start, which loses momentum. What is pinned
// on both sides and passes is marked as tangled (untangling.c).
//
// Where points keep to their tolerance, most pairs cannot come that near: these are not looked at.
#include "displacement_limit.h"

#include "broad_phase.h"
#include "clusters.h"
#include "constraints.h"
#include "predicted_motion.h"

#include <stdatomic.h>
#include <string.h>

enum
{
    PARTIAL_ROUNDS = 24, // then points of pairs that are too near go back to their start
    SHORT_ROUNDS = 2,    // the same where displacements are cut: all that is near is a pair, and rounds lead nowhere
    MAX_ROUNDS = 64,     // then all points do
    BISECTIONS = 24,
    LIMIT_ROW_GRAIN = 128,
    CHANGED_BEFORE = 1, // in the round before
    CHANGED_NOW = 2,
    MOVED = 4, // in this call
};

// The distance that a pair keeps: a fraction of its gap, or of its distance if it is nearer already.
static const float MIN_OF_REQUESTED = 0.1f, MIN_OF_DISTANCE = 0.99f;
// The distance to which it is moved, so that rounds are few.
static const float MOVE_OF_REQUESTED = 0.15f, MOVE_OF_DISTANCE = 0.995f;
static const float ALMOST = 0.999f; // of what is left of a margin

typedef struct guard_loop
{
    contact_contact_mesh* contact_mesh;
    bool* has_passed; // [block of rows]
    int first_new;    // rows from here on are tested in any case
    bool moves;       // a point was moved
    _Atomic int tests;
} guard_loop;

static bool is_pinned( const contact_contact_mesh* s, int point )
{
    return s->now[(size_t)point * 4 + 3] == 0.0f;
}

static contact_row* row_of( const contact_contact_mesh* s, int r )
{
    return r < s->constraints->row_count ? s->constraints->rows + r
                                         : s->constraints->missed_rows + ( r - s->constraints->row_count );
}

static float least_of( const contact_row* row )
{
    return contact_smaller( MIN_OF_REQUESTED * row->requested, MIN_OF_DISTANCE * row->distance );
}

// Compute the coordinates of the points of a row along its normal, relative to the last one.
static void find_places( const contact_contact_mesh* s, const contact_row* row, float at[CONTACT_MAX_POINTS] )
{
    const float* origin = s->now + (size_t)row->point[CONTACT_MAX_POINTS - 1] * 4;
    for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
    {
        const float* p = s->now + (size_t)row->point[i] * 4;
        const float from[3] = { p[0] - origin[0], p[1] - origin[1], p[2] - origin[2] };
        at[i] = contact_dot( row->normal, from );
    }
}

// Return whether the sides of a row are nearer than they may be.
static bool is_passed( const contact_contact_mesh* s, const contact_row* row )
{
    float at[CONTACT_MAX_POINTS], front = INFINITY, back = -INFINITY;
    find_places( s, row, at );
    for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
    {
        front = i < row->split ? contact_smaller( front, at[i] ) : front;
        back = i >= row->split ? contact_larger( back, at[i] ) : back;
    }
    return front - back < least_of( row );
}

// Return whether a row has to be tested: its sides can come too near, or a point left its tolerance or was moved.
static bool may_pass( const guard_loop* loop, int r, const contact_row* row )
{
    const contact_contact_mesh* s = loop->contact_mesh;
    const bool is_new = r >= loop->first_new;
    uint8_t changed = 0;
    for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
    {
        changed |= (uint8_t)( s->limit->changed[row->point[i]] & CHANGED_BEFORE );
        changed |= is_new ? s->motion->is_missed[row->point[i]] : 0;
    }
    return changed != 0 || ( is_new && row->distance - row->closing < least_of( row ) );
}

static void check_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    guard_loop* loop = context;
    bool any = false;
    int tests = 0;
    for ( int r = begin; r < end; ++r )
    {
        contact_row* row = row_of( loop->contact_mesh, r );
        const bool is_tested = may_pass( loop, r, row );
        row->is_passed = is_tested && is_passed( loop->contact_mesh, row );
        any = any || row->is_passed;
        tests += is_tested ? 1 : 0;
    }
    loop->has_passed[begin / LIMIT_ROW_GRAIN] = any;
    atomic_fetch_add( &loop->tests, tests );
}

// Return the impulse on the front less that on the back, over the time, if a plane divides the points.
static float impulse_of( const contact_contact_mesh* s, const contact_row* row, const float at[CONTACT_MAX_POINTS],
                         float plane, float half )
{
    float sum = 0.0f;
    for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
    {
        const float short_by = i < row->split ? plane + half - at[i] : plane - half - at[i];
        const bool moves = i < row->split ? short_by > 0.0f : short_by < 0.0f;
        sum +=
            moves && is_pinned( s, row->point[i] ) == false ? short_by / s->now[(size_t)row->point[i] * 4 + 3] : 0.0f;
    }
    return sum;
}

// Find the plane from which the points of a row are to be at least `half` away, where impulses are equal and opposite.
// Those of pinned points are not moved. Where these leave less room, `half` is what they leave, at least 0.
// @return whether they leave any
static bool find_plane( const contact_contact_mesh* s, const contact_row* row, const float at[CONTACT_MAX_POINTS],
                        float* half, float* plane )
{
    float front = INFINITY, back = -INFINITY, fixed_front = INFINITY, fixed_back = -INFINITY;
    for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
    {
        const bool is_front = i < row->split, is_fixed = is_pinned( s, row->point[i] );
        front = is_front ? contact_smaller( front, at[i] ) : front;
        back = is_front ? back : contact_larger( back, at[i] );
        fixed_front = is_front && is_fixed ? contact_smaller( fixed_front, at[i] ) : fixed_front;
        fixed_back = is_front || is_fixed == false ? fixed_back : contact_larger( fixed_back, at[i] );
    }
    const float room = fixed_front - fixed_back;
    if ( room < 2.0f * *half )
    {
        *half = contact_larger( 0.5f * room, 0.0f );
        *plane = 0.5f * ( fixed_front + fixed_back );
        return room > 0.0f;
    }
    float lower = contact_larger( front - *half, fixed_back + *half ),
          upper = contact_smaller( back + *half, fixed_front - *half );
    for ( int i = 0; i < BISECTIONS && lower < upper; ++i )
    {
        const float middle = 0.5f * ( lower + upper );
        const bool is_low = impulse_of( s, row, at, middle, *half ) < 0.0f;
        lower = is_low ? middle : lower;
        upper = is_low ? upper : middle;
    }
    *plane = lower;
    return true;
}

static void move_along( contact_contact_mesh* s, int point, const float normal[3], float length )
{
    for ( int k = 0; k < 3; ++k )
    {
        s->now[(size_t)point * 4 + (size_t)k] += length * normal[k];
    }
    s->limit->changed[point] |= CHANGED_NOW | MOVED;
}

// Put a free point back to its start. @return whether it was elsewhere
static bool put_back( contact_contact_mesh* s, int point )
{
    const size_t at = (size_t)point * 4;
    bool moves = false;
    for ( size_t k = 0; k < 3 && is_pinned( s, point ) == false; ++k )
    {
        const float start = s->intersection_free[at + k] + s->motion->common[k];
        moves = moves || s->now[at + k] != start;
        s->now[at + k] = start;
        s->shift[at + k] = 0.0f;
    }
    s->limit->changed[point] |= moves ? CHANGED_NOW | MOVED : 0;
    return moves;
}

// Put the points of a row back into the half spaces of their bodies.
static void keep_inside( const contact_work* work, const contact_row* row )
{
    for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
    {
        const contact_participant* participant = contact_participant_of( work, row->point[i] );
        const int number = row->point[i] - participant->first_point;
        float* p = work->contact_mesh->now + (size_t)row->point[i] * 4;
        const int found = participant->half_spaces != NULL && p[3] > 0.0f ? participant->half_spaces[number] : 0;
        for ( int k = 0; k < found && k < WISP_MAX_HALF_SPACES; ++k )
        {
            const float* half =
                participant->half_space_row + 16 * ( (size_t)number * WISP_MAX_HALF_SPACES + (size_t)k );
            const float from[3] = { p[0] - half[0], p[1] - half[1], p[2] - half[2] };
            const float out = contact_smaller( contact_dot( half + 3, from ) - half[9], 0.0f );
            for ( int c = 0; c < 3; ++c )
            {
                p[c] -= out * half[3 + c];
            }
        }
    }
}

// Part the sides of a row. @return whether a point moved
static bool part( const contact_work* work, const contact_row* row, bool gives_up )
{
    contact_contact_mesh* s = work->contact_mesh;

    float half = 0.5f * contact_smaller( MOVE_OF_REQUESTED * row->requested, MOVE_OF_DISTANCE * row->distance );
    const float nothing = 1e-3f * half;
    float at[CONTACT_MAX_POINTS], plane;
    find_places( s, row, at );
    const bool is_tangled = find_plane( s, row, at, &half, &plane ) == false;
    bool moves = false;
    for ( int i = 0; i < CONTACT_MAX_POINTS; ++i )
    {
        const float short_by = i < row->split ? contact_larger( 0.0f, plane + half - at[i] )
                                              : contact_smaller( 0.0f, plane - half - at[i] );
        if ( gives_up )
        {
            moves = put_back( s, row->point[i] ) || moves;
        }
        else if ( fabsf( short_by ) > nothing && is_pinned( s, row->point[i] ) == false )
        {
            move_along( s, row->point[i], row->normal, short_by );
            moves = true;
        }
    }
    keep_inside( work, row );
    work->memory->tangled = is_tangled ? 1 : work->memory->tangled;
    return moves;
}

// Part what has passed serially, in the order of rows: they share points, and are few. @return whether a point moved
static bool part_rows( const contact_work* work, const guard_loop* loop, int count, bool gives_up )
{
    contact_contact_mesh* s = work->contact_mesh;
    bool any = false;
    for ( int r = 0; r < count; ++r )
    {
        const contact_row* row = row_of( s, r );
        if ( loop->has_passed[r / LIMIT_ROW_GRAIN] && row->is_passed && is_passed( s, row ) )
        {
            any = part( work, row, gives_up ) || any;
        }
    }
    for ( int i = 0; i < s->point_count && any; ++i )
    {
        const uint8_t changed = s->limit->changed[i];
        s->limit->changed[i] =
            (uint8_t)( ( changed & MOVED ) | ( ( changed & CHANGED_NOW ) != 0 ? CHANGED_BEFORE : 0 ) );
    }
    return any;
}

// Where the broad phase had to halve its margins, clusters stay within them.
static void stay_in_margins( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    for ( int p = 0; p < s->clusters->count && s->broad_phase->is_short; ++p )
    {
        const contact_cluster* cluster = s->clusters->items + p;
        const float left = ALMOST * ( s->motion->predicted[p].margin - s->motion->predicted[p].deviation );
        const float way = contact_length_of_way( s, s->motion->ways + p );
        const float fraction = left > 0.0f ? left / way : 0.0f;
        for ( int i = 0; i < cluster->point_count && way > left; ++i )
        {
            const int point = s->clusters->points[cluster->first_point + i] / 4;
            for ( size_t k = 0, at = (size_t)point * 4; k < 3 && is_pinned( s, point ) == false; ++k )
            {
                const float start = s->intersection_free[at + k] + s->motion->common[k];
                s->now[at + k] = start + fraction * ( s->now[at + k] - start );
                s->shift[at + k] *= fraction;
            }
            s->limit->changed[point] |= is_pinned( s, point ) ? 0 : CHANGED_BEFORE | MOVED;
        }
    }
}

static int count_moved( const contact_contact_mesh* s )
{
    int count = 0;
    for ( int i = 0; i < s->point_count; ++i )
    {
        count += ( s->limit->changed[i] & MOVED ) != 0 ? 1 : 0;
    }
    return count;
}

bool contact_reserve_limit( const contact_work* work )
{
    contact_limit* limit = work->contact_mesh->limit;
    return contact_reserve( work, limit->buffers, (size_t)work->contact_mesh->point_count, (void**)&limit->changed );
}

// Shorten the displacement of a free point to what the lists reach. @return whether it was longer
static bool stay_in_reach( const contact_contact_mesh* s, int point )
{
    const size_t at = (size_t)point * 4;
    float way[3];
    for ( size_t k = 0; k < 3; ++k )
    {
        way[k] = s->now[at + k] - s->intersection_free[at + k] - s->motion->common[k];
    }
    const float squared = contact_dot( way, way );
    const bool is_far = squared > s->motion->reach * s->motion->reach && s->now[at + 3] > 0.0f;
    const float fraction = is_far ? s->motion->reach / sqrtf( squared ) : 1.0f;
    for ( size_t k = 0; k < 3 && is_far; ++k )
    {
        s->now[at + k] = s->intersection_free[at + k] + s->motion->common[k] + fraction * way[k];
        s->shift[at + k] *= fraction;
    }
    s->limit->changed[point] |= is_far ? CHANGED_BEFORE : 0;
    return is_far;
}

int contact_stay_in_reach( const contact_work* work )
{
    const contact_contact_mesh* s = work->contact_mesh;
    int count = 0;
    for ( int i = 0; i < s->point_count && s->motion->reach < INFINITY; ++i )
    {
        count += stay_in_reach( s, i ) ? 1 : 0;
    }
    return count;
}

void contact_begin_limit( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    memset( s->limit->changed, 0, (size_t)s->point_count );
    s->limit->is_again = false;
}

void contact_hold( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    for ( int i = 0; i < s->point_count; ++i )
    {
        work->memory->stats.displacement_limited += put_back( s, i ) ? 1 : 0;
    }
    contact_measure_ways( work );
}

// Test and part in rounds. Rows whose points are as they were in the test before pass again. @return false: some have passed still
static bool run_rounds( const contact_work* work, guard_loop* loop, int count )
{
    const int partial = work->contact_mesh->motion->reach < INFINITY ? SHORT_ROUNDS : PARTIAL_ROUNDS;
    bool any = true;
    for ( int round = 0; round < MAX_ROUNDS && any; ++round )
    {
        wisp_parallel_for( work->parallel, count, LIMIT_ROW_GRAIN, check_rows, loop );
        any = part_rows( work, loop, count, round >= partial );
        loop->first_new = count;
        loop->moves = loop->moves || any;
    }
    return any == false;
}

int contact_limit_displacements( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    guard_loop loop = { .contact_mesh = s };
    const int count = s->constraints->row_count + s->constraints->missed_row_count;
    loop.has_passed = wisp_parallel_scratch( work->parallel, work->worker, (size_t)( count / LIMIT_ROW_GRAIN + 1 ) );
    if ( loop.has_passed == NULL )
    {
        wisp_frame_fail( work->frame, WISP_NO_MEMORY, "out of memory to limit displacements of %d pairs", count );
        return 0;
    }
    loop.first_new = s->limit->is_again ? s->constraints->row_count : 0;
    atomic_init( &loop.tests, 0 );
    for ( int i = 0; i < s->point_count && s->limit->is_again; ++i )
    {
        s->limit->changed[i] &= CHANGED_BEFORE;
    }
    s->limit->is_again = true;
    stay_in_margins( work );
    const bool is_done = run_rounds( work, &loop, count );
    s->limit->tests += atomic_load( &loop.tests );
    const int moved = loop.moves || s->broad_phase->is_short ? count_moved( s ) : 0;
    if ( is_done == false )
    {
        contact_hold( work );
    }
    return moved;
}
