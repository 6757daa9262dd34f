// Displacement limit: nothing passes through (the role of the step limit in IPC, Li et al. 2020). In: rows,
// displacements since the intersection-free positions. Out: the fraction of its displacement that each point keeps.
//
// Distances to a plane are linear in time. So two convex primitives that end on their sides of the plane between them
// have not met. Where a pair ends nearer to its plane than a tenth of its gap (or 0.99 of its distance, if that is
// less), the displacements of its points are cut. A cut may bring other pairs together, so tests and cuts go on in
// rounds until no plane is passed. They end, because points without displacement pass nothing. A cut loses momentum.
// It leaves what pinned points carry along (below), and takes that too where it is too much.
// Pinned points are not cut. Where they alone would pass a plane, the other side is pushed ahead of them, and is then
// treated as pinned for the rest of the substep, so that a push goes on through layers. Layers go as far as what drives
// them. A push that would go farther goes from crease to crease of crumpled cloth, and would grow with each: it is
// refused. What is pinned on both sides, or refused, is marked as tangled (untangling.c).
#include "displacement_limit.h"

#include "broad_phase.h"
#include "clusters.h"
#include "constraints.h"
#include "predicted_motion.h"

#include "wisp/module/inertia.h"

#include <stdatomic.h>
#include <string.h>

enum
{
    PARTIAL_ROUNDS = 16, // then displacements are cut to zero at once
    MAX_ROUNDS = 64,     // then those of all points are
    POINT_GRAIN = 2048,
    LIMIT_ROW_GRAIN = 128,
    JUST_DRIVEN = 2,    // in this call, against 1: in one before
    CHANGED_BEFORE = 1, // in the round before
    CHANGED_NOW = 2,
};

// The distance that a pair keeps: a fraction of its gap, or of its distance if it is nearer already.
static const float MIN_OF_REQUESTED = 0.1f, MIN_OF_DISTANCE = 0.99f;
// Fraction of the way to that distance that a cut leaves, so that a pair comes to it in several substeps and rounds
// are few.
static const float WAY_TO_GO = 0.9f;
static const float PUSH = -1.0f, STAY = -2.0f; // in place of a cut
// How far a push may move a point: in displacements of the pinned point that drives it, and in gaps of the pair.
static const float PUSH_DRIVES = 2.0f, PUSH_GAPS = 2.0f;
static const float ALMOST = 0.999f; // of what is left of a margin

typedef struct guard_loop
{
    contact_contact_mesh* contact_mesh;
    bool* has_cuts; // [block of rows]
    int first_new;  // rows from here on are tested in any case
    bool gives_up;
    _Atomic bool is_crossed;
    _Atomic int tests;
} guard_loop;

// Return whether a point goes where it goes: pinned, or pushed ahead of pinned points.
static bool is_fixed( const contact_contact_mesh* s, int point )
{
    return s->now[(size_t)point * 4 + 3] == 0.0f || s->limit->is_driven[point] != 0;
}

// Return a coordinate of what is carried of a point, m. @param at of all coordinates
static float carried_along( const contact_contact_mesh* s, size_t at )
{
    return s->limit->carries ? s->limit->carried[at] : 0.0f;
}

// Return the coordinate of a point along the normal, with a fraction of its displacement, relative to an origin.
static float place_along( const contact_contact_mesh* s, const contact_row* row, int i, float fraction,
                          const float* origin )
{
    const size_t at = (size_t)row->point[i] * 4;
    float sum = 0.0f;
    for ( size_t k = 0; k < 3; ++k )
    {
        const float start = s->intersection_free[at + k] - origin[k];
        const float way = s->now[at + k] - s->intersection_free[at + k] - s->motion->common[k];
        sum += row->normal[k] * ( start + fraction * way );
    }
    for ( size_t k = 0; k < 3 && fraction < 1.0f && s->limit->carries; ++k )
    {
        sum += ( 1.0f - fraction ) * row->normal[k] * s->limit->carried[at + k];
    }
    return sum;
}

// Return the distance between the two sides. @param is_cut with all free points back at their start
static float separation( const contact_contact_mesh* s, const contact_row* row, bool is_cut )
{
    const float* origin = s->intersection_free + (size_t)row->point[row->count - 1] * 4;
    float front = INFINITY, back = -INFINITY;
    for ( int i = 0; i < row->count; ++i )
    {
        const int point = row->point[i];
        const float fraction = is_cut && is_fixed( s, point ) == false ? 0.0f : s->limit->fraction[point];
        const float place = place_along( s, row, i, fraction, origin );
        front = i < row->split ? contact_smaller( front, place ) : front;
        back = i >= row->split ? contact_larger( back, place ) : back;
    }
    return front - back;
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

// Return the side of a row, 0 or 1, that fixed points of the other side can push: it has none itself. -1: no side.
static int pushed_side( const contact_contact_mesh* s, const contact_row* row )
{
    bool has_fixed[2] = { false, false };
    for ( int i = 0; i < row->count; ++i )
    {
        const int side = i < row->split ? 0 : 1;
        has_fixed[side] = has_fixed[side] || is_fixed( s, row->point[i] );
    }
    return has_fixed[0] == has_fixed[1] ? -1 : has_fixed[0] ? 1 : 0;
}

static bool is_carried( const contact_contact_mesh* s, int point )
{
    const float* carried = s->limit->carried + (size_t)point * 4;
    return s->limit->carries && is_fixed( s, point ) == false &&
           ( carried[0] != 0.0f || carried[1] != 0.0f || carried[2] != 0.0f );
}

static bool has_carried( const contact_contact_mesh* s, const contact_row* row )
{
    bool any = false;
    for ( int i = 0; i < row->count; ++i )
    {
        any = any || is_carried( s, row->point[i] );
    }
    return any;
}

// Test a row and compute its cut, which is negative if points have to be pushed, or not even carried. @return whether any is needed
static bool check_row( guard_loop* loop, contact_row* row )
{
    const contact_contact_mesh* s = loop->contact_mesh;
    const float least = least_of( row ), there = separation( s, row, false );
    row->cut = 1.0f;
    if ( there < least )
    {
        const float start = separation( s, row, true );
        const bool pushes = start < least && pushed_side( s, row ) >= 0;
        const bool stays = pushes == false && start < least && has_carried( s, row );
        if ( pushes == false && stays == false && start <= 0.0f )
        {
            // fixed points of both sides went through each other
            atomic_store( &loop->is_crossed, true );
        }
        row->cut = loop->gives_up || !( start > least ) ? 0.0f : WAY_TO_GO * ( start - least ) / ( start - there );
        row->cut = pushes ? PUSH : stays ? STAY : row->cut;
    }
    return there < least;
}

// Return whether a point of a row was changed in the round before. A row without one is as it was: nothing to cut.
static bool is_changed( const contact_contact_mesh* s, const contact_row* row )
{
    uint8_t changed = 0;
    for ( int i = 0; i < row->count; ++i )
    {
        changed |= s->limit->changed[row->point[i]];
    }
    return ( changed & CHANGED_BEFORE ) != 0;
}

static void check_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    guard_loop* loop = context;
    bool cuts = false;
    int tests = 0;
    for ( int r = begin; r < end; ++r )
    {
        contact_row* row = row_of( loop->contact_mesh, r );
        if ( row->cut != 1.0f )
        {
            row->cut = 1.0f;
        }
        if ( r >= loop->first_new || is_changed( loop->contact_mesh, row ) )
        {
            cuts = check_row( loop, row ) || cuts;
            tests += 1;
        }
    }
    loop->has_cuts[begin / LIMIT_ROW_GRAIN] = cuts;
    atomic_fetch_add( &loop->tests, tests );
}

// Return how far a pinned point goes, relative to the mean, or the one that drives a point, m.
static float drive_of_point( const contact_contact_mesh* s, int point )
{
    const size_t at = (size_t)point * 4;
    float squared = 0.0f;
    if ( s->now[at + 3] != 0.0f )
    {
        return s->limit->drive[point];
    }
    for ( size_t k = 0; k < 3; ++k )
    {
        const float way = s->now[at + k] - s->intersection_free[at + k] - s->motion->common[k];
        squared += way * way;
    }
    return sqrtf( squared );
}

// Return the largest displacement that drives the points of a row from a to b, m.
static float drive_of( const contact_contact_mesh* s, const contact_row* row, int a, int b )
{
    float drive = 0.0f;
    for ( int i = a; i < b; ++i )
    {
        const int point = row->point[i];
        drive = is_fixed( s, point ) ? contact_larger( drive, drive_of_point( s, point ) ) : drive;
    }
    return drive;
}

// Push the side of a row without fixed points until the sides have their gap. @return whether a point moved
static bool apply_push( guard_loop* loop, const contact_row* row )
{
    contact_contact_mesh* s = loop->contact_mesh;
    const float there = separation( s, row, false );
    if ( there >= least_of( row ) )
    {
        return false;
    }
    const bool is_second = pushed_side( s, row ) == 1;
    const int first = is_second ? row->split : 0, end = is_second ? row->count : row->split;
    const float drive = is_second ? drive_of( s, row, 0, row->split ) : drive_of( s, row, row->split, row->count );
    const float push = row->gap - there;
    if ( !( push <= PUSH_DRIVES * drive + PUSH_GAPS * row->requested ) )
    {
        atomic_store( &loop->is_crossed, true );
        return false;
    }
    const float length = is_second ? -push : push;
    for ( int i = first; i < end; ++i )
    {
        const int point = row->point[i];
        for ( size_t k = 0, at = (size_t)point * 4; k < 3; ++k )
        {
            const float start = s->intersection_free[at + k] + carried_along( s, at + k );
            s->now[at + k] = start + s->limit->fraction[point] * ( s->now[at + k] - start ) + length * row->normal[k];
        }
        s->limit->fraction[point] = 1.0f;
        s->limit->is_driven[point] = JUST_DRIVEN;
        s->limit->drive[point] = drive;
        s->limit->changed[point] |= CHANGED_NOW;
    }
    return true;
}

// Leave the points of a row where they were.
static bool apply_stay( contact_contact_mesh* s, const contact_row* row )
{
    bool any = false;
    for ( int i = 0; i < row->count; ++i )
    {
        const int point = row->point[i];
        if ( is_carried( s, point ) )
        {
            memset( s->limit->carried + (size_t)point * 4, 0, 3 * sizeof( float ) );
            s->limit->fraction[point] = 0.0f;
            s->limit->changed[point] |= CHANGED_NOW;
            any = true;
        }
    }
    return any;
}

static bool apply_cut( contact_contact_mesh* s, const contact_row* row )
{
    bool any = false;
    for ( int i = 0; i < row->count && row->cut < 1.0f; ++i )
    {
        const int point = row->point[i];
        const bool can = is_fixed( s, point ) == false && s->limit->fraction[point] > 0.0f;
        s->limit->cut[point] = can ? contact_smaller( s->limit->cut[point], row->cut ) : s->limit->cut[point];
        s->limit->changed[point] |= can ? CHANGED_NOW : 0;
        any = any || can;
    }
    return any;
}

// Apply cuts and pushes serially, in the order of rows: they share points, and are few.
static bool apply_cuts( guard_loop* loop, int count )
{
    bool any = false;
    for ( int r = 0; r < count; ++r )
    {
        if ( loop->has_cuts[r / LIMIT_ROW_GRAIN] )
        {
            const contact_row* row = row_of( loop->contact_mesh, r );
            const bool moves = row->cut == PUSH   ? apply_push( loop, row )
                               : row->cut == STAY ? apply_stay( loop->contact_mesh, row )
                                                  : apply_cut( loop->contact_mesh, row );
            any = any || moves;
        }
    }
    return any;
}

// Start with whole displacements. Where the broad phase had to halve its margins, clusters stay within them.
static void limit_ways( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    for ( int i = 0; i < s->point_count; ++i )
    {
        s->limit->fraction[i] = s->limit->cut[i] = 1.0f;
    }
    for ( int p = 0; p < s->clusters->count && s->broad_phase->is_short; ++p )
    {
        const contact_cluster* cluster = s->clusters->items + p;
        const float left = ALMOST * ( s->motion->predicted[p].margin - s->motion->predicted[p].deviation );
        const float way = contact_length_of_way( s, s->motion->ways + p );
        const float fraction = way > left ? ( left > 0.0f ? left / way : 0.0f ) : 1.0f;
        for ( int i = 0; i < cluster->point_count; ++i )
        {
            const int point = s->clusters->points[cluster->first_point + i] / 4;
            if ( is_fixed( s, point ) == false && fraction < s->limit->fraction[point] )
            {
                s->limit->fraction[point] = fraction;
                s->limit->changed[point] |= CHANGED_BEFORE;
            }
        }
    }
}

static void cut_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    const guard_loop* loop = context;
    contact_contact_mesh* s = loop->contact_mesh;
    for ( int i = begin; i < end; ++i )
    {
        const float fraction = s->limit->fraction[i];
        for ( size_t k = 0, at = (size_t)i * 4; k < 3 && fraction < 1.0f; ++k )
        {
            const float there = s->intersection_free[at + k] + s->motion->common[k] + carried_along( s, at + k );
            s->now[at + k] = there + fraction * ( s->now[at + k] - there );
            s->shift[at + k] *= fraction;
        }
    }
}

// Return whether this call cut or pushed a point.
static bool is_cut( const contact_contact_mesh* s, int point )
{
    return s->limit->fraction[point] < 1.0f || s->limit->is_driven[point] == JUST_DRIVEN;
}

static int count_cut( const contact_contact_mesh* s )
{
    int count = 0;
    for ( int i = 0; i < s->point_count; ++i )
    {
        count += is_cut( s, i ) ? 1 : 0;
    }
    return count;
}

static void hold_all( contact_contact_mesh* s )
{
    for ( int i = 0; i < s->point_count; ++i )
    {
        s->limit->fraction[i] = is_fixed( s, i ) ? 1.0f : 0.0f;
    }
    s->limit->carries = false;
}

bool contact_reserve_limit( const contact_work* work )
{
    contact_limit* limit = work->contact_mesh->limit;
    const size_t points = (size_t)work->contact_mesh->point_count;
    return contact_reserve( work, limit->buffers, points * sizeof( float ), (void**)&limit->fraction ) &&
           contact_reserve( work, limit->buffers + 1, points, (void**)&limit->is_driven ) &&
           contact_reserve( work, limit->buffers + 2, points, (void**)&limit->changed ) &&
           contact_reserve( work, limit->buffers + 3, points * sizeof( float ), (void**)&limit->cut ) &&
           contact_reserve( work, limit->buffers + 4, points * 4 * sizeof( float ), (void**)&limit->carried ) &&
           contact_reserve( work, limit->buffers + 5, points * sizeof( float ), (void**)&limit->drive );
}

// Shorten the displacement of a free point to what the lists reach. @return whether it was longer
static bool stay_in_reach( const contact_contact_mesh* s, int point )
{
    const size_t at = (size_t)point * 4;
    float way[3], squared = 0.0f;
    for ( size_t k = 0; k < 3; ++k )
    {
        way[k] = s->now[at + k] - s->intersection_free[at + k] - s->motion->common[k];
        squared += way[k] * way[k];
    }
    const bool is_far = squared > s->motion->reach * s->motion->reach && s->now[at + 3] > 0.0f;
    const float fraction = is_far ? s->motion->reach / sqrtf( squared ) : 1.0f;
    for ( size_t k = 0; k < 3 && is_far; ++k )
    {
        s->now[at + k] = s->intersection_free[at + k] + s->motion->common[k] + fraction * way[k];
        s->shift[at + k] *= fraction;
    }
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
    contact_find_carried( work );
    memset( s->limit->is_driven, 0, (size_t)s->point_count );
    memset( s->limit->changed, 0, (size_t)s->point_count );
    s->limit->is_again = false;
}

// End a round. A point is cut by the worst of its pairs: others are tested again. The product of all cuts would leave
// nothing where pairs are many, and a cloth that collapsed would never move again.
static void end_round( contact_contact_mesh* s )
{
    static const float NOTHING = 1e-4f;
    contact_limit* limit = s->limit;
    for ( int i = 0; i < s->point_count; ++i )
    {
        if ( limit->cut[i] < 1.0f && is_fixed( s, i ) == false )
        {
            limit->fraction[i] *= limit->cut[i];
            limit->fraction[i] = limit->fraction[i] < NOTHING ? 0.0f : limit->fraction[i];
        }
        limit->cut[i] = 1.0f;
        limit->changed[i] >>= 1; // what changed now has changed before
    }
}

// Mark the points that this call cut or pushed for the next one.
static void keep_changes( contact_contact_mesh* s )
{
    for ( int i = 0; i < s->point_count; ++i )
    {
        s->limit->changed[i] = is_cut( s, i ) ? CHANGED_BEFORE : 0;
    }
    s->limit->is_again = true;
}

// Test and cut in rounds. Rows whose points are as they were in the test before pass again.
static void run_rounds( const contact_work* work, guard_loop* loop, int count )
{
    contact_contact_mesh* s = loop->contact_mesh;
    bool cuts = true;
    loop->first_new = s->limit->is_again ? s->constraints->row_count : 0;
    for ( int round = 0; round < MAX_ROUNDS && cuts; ++round )
    {
        loop->gives_up = round >= PARTIAL_ROUNDS;
        wisp_parallel_for( work->parallel, count, LIMIT_ROW_GRAIN, check_rows, loop );
        cuts = apply_cuts( loop, count );
        loop->first_new = count;
        end_round( s );
    }
    if ( cuts )
    {
        hold_all( s );
    }
}

void contact_hold( const contact_work* work )
{
    guard_loop loop = { .contact_mesh = work->contact_mesh };
    contact_contact_mesh* s = work->contact_mesh;
    hold_all( s );
    work->memory->stats.displacement_limited += count_cut( s );
    wisp_parallel_for( work->parallel, s->point_count, POINT_GRAIN, cut_ways, &loop );
    contact_measure_ways( work );
}

int contact_limit_displacements( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    guard_loop loop = { .contact_mesh = s };
    const int count = s->constraints->row_count + s->constraints->missed_row_count;
    loop.has_cuts = wisp_parallel_scratch( work->parallel, work->worker, (size_t)( count / LIMIT_ROW_GRAIN + 1 ) );
    if ( loop.has_cuts == NULL )
    {
        wisp_frame_fail( work->frame, WISP_NO_MEMORY, "out of memory to limit displacements of %d pairs", count );
        return 0;
    }
    for ( int i = 0; i < s->point_count; ++i )
    {
        s->limit->is_driven[i] = s->limit->is_driven[i] != 0 ? 1 : 0;
    }
    atomic_init( &loop.is_crossed, false );
    atomic_init( &loop.tests, 0 );
    limit_ways( work );
    run_rounds( work, &loop, count );
    keep_changes( s );
    const int cut = count_cut( s );
    s->limit->tests += atomic_load( &loop.tests );
    work->memory->tangled = atomic_load( &loop.is_crossed ) ? 1 : work->memory->tangled;
    if ( cut > 0 )
    {
        wisp_parallel_for( work->parallel, s->point_count, POINT_GRAIN, cut_ways, &loop );
    }
    return cut;
}

// Carried motion. In: displacements since the intersection-free positions. Out: for each point the displacement that a
// cut leaves it.
//
// A cut that stopped a point where it was would stop it in space. In the clothes of a figure that jumps, its pinned
// neighbours would then leave it behind, and pass through what it hangs on to. So a point that is cut goes on with the
// pinned points of its participant: with as much of their rigid motion (of least squares) as its own displacement has.
// Where those stand still, or a participant has none, nothing is left.

// A rigid displacement.
typedef struct rigid_motion
{
    double centre[3];   // m
    double along[3];    // m
    double rotation[3]; // rad
} rigid_motion;

static bool is_pinned( const contact_contact_mesh* s, int point )
{
    return s->now[(size_t)point * 4 + 3] == 0.0f;
}

static void way_of( const contact_contact_mesh* s, int point, double out[3] )
{
    for ( size_t k = 0, at = (size_t)point * 4; k < 3; ++k )
    {
        out[k] = (double)( s->now[at + k] - s->intersection_free[at + k] - s->motion->common[k] );
    }
}

static void arm_of( const contact_contact_mesh* s, const rigid_motion* motion, int point, double out[3] )
{
    for ( size_t k = 0; k < 3; ++k )
    {
        out[k] = (double)s->intersection_free[(size_t)point * 4 + k] - motion->centre[k];
    }
}

// Find where the pinned points are and go in the mean. @return how many there are
static int find_mean( const contact_contact_mesh* s, const contact_participant* participant, rigid_motion* motion )
{
    int count = 0;
    for ( int i = participant->first_point; i < participant->first_point + participant->point_count; ++i )
    {
        double way[3];
        if ( is_pinned( s, i ) == false )
        {
            continue;
        }
        way_of( s, i, way );
        for ( size_t k = 0; k < 3; ++k )
        {
            motion->centre[k] += (double)s->intersection_free[(size_t)i * 4 + k];
            motion->along[k] += way[k];
        }
        count += 1;
    }
    for ( int k = 0; k < 3 && count > 0; ++k )
    {
        motion->centre[k] /= count;
        motion->along[k] /= count;
    }
    return count;
}

// Rotation of least squares: the angular momentum of the pinned points over their inertia.
static void find_rotation( const contact_contact_mesh* s, const contact_participant* participant,
                           rigid_motion* motion )
{
    double inertia[6] = { 0.0 }, momentum[3] = { 0.0 };
    for ( int i = participant->first_point; i < participant->first_point + participant->point_count; ++i )
    {
        double way[3], arm[3], turn[3];
        if ( is_pinned( s, i ) == false )
        {
            continue;
        }
        way_of( s, i, way );
        arm_of( s, motion, i, arm );
        wisp_cross_product( arm, way, turn );
        for ( size_t k = 0; k < 3; ++k )
        {
            const double y = arm[( k + 1 ) % 3], z = arm[( k + 2 ) % 3];
            momentum[k] += turn[k];
            inertia[k] += y * y + z * z;
            inertia[5 - k] -= y * z; // yz, xz, xy
        }
    }
    wisp_solve_inertia( inertia, momentum, motion->rotation );
}

// @return false if pinned points stand still, or there are none, or all are
static bool find_rigid_motion( const contact_contact_mesh* s, const contact_participant* participant,
                               rigid_motion* motion )
{
    *motion = ( rigid_motion ){ 0 };
    const int count = find_mean( s, participant, motion );
    if ( count == 0 || count == participant->point_count )
    {
        return false;
    }
    find_rotation( s, participant, motion );
    const double *a = motion->along, *r = motion->rotation;
    const double size = a[0] * a[0] + a[1] * a[1] + a[2] * a[2] + r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    return size > 0.0 && size < INFINITY;
}

// As much of a rigid motion as the point's displacement has, at most all of it.
static void carry( contact_contact_mesh* s, const rigid_motion* motion, int point )
{
    double arm[3], turn[3], way[3], squared = 0.0, along = 0.0;
    arm_of( s, motion, point, arm );
    wisp_cross_product( motion->rotation, arm, turn );
    way_of( s, point, way );
    for ( size_t k = 0; k < 3; ++k )
    {
        turn[k] += motion->along[k];
        squared += turn[k] * turn[k];
        along += turn[k] * way[k];
    }
    const double part = along > 0.0 ? fmin( 1.0, along / squared ) : 0.0;
    for ( size_t k = 0; k < 3; ++k )
    {
        s->limit->carried[(size_t)point * 4 + k] = (float)( part * turn[k] );
    }
}

void contact_find_carried( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    contact_limit* limit = s->limit;
    limit->carries = false;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        rigid_motion motion;
        if ( find_rigid_motion( s, participant, &motion ) == false )
        {
            continue;
        }
        if ( limit->carries == false )
        {
            memset( limit->carried, 0, (size_t)s->point_count * 4 * sizeof( float ) );
            limit->carries = true;
        }
        for ( int i = participant->first_point; i < participant->first_point + participant->point_count; ++i )
        {
            if ( is_pinned( s, i ) == false )
            {
                carry( s, &motion, i );
            }
        }
    }
}
