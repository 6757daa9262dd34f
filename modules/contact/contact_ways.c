// How far each point goes, which bounds how much nearer any two features can come, and how well it keeps to its course, which
// tells for how long a search of pairs is good.
#include "contact_internal.h"

#include <stdatomic.h>
#include <string.h>

enum
{
    GRAIN = 1024,
    PATCH_GRAIN = 256,
    SUBSTEPS_AHEAD = 5,    // that patches are taken to drift
    PATIENT_SUBSTEPS = 16, // after so many it is asked again whether lists are too long
};

// What is farther is no way of a point, but a number that went wrong.
static const float FARTHEST = 1e6f;
// Projections move points elsewhere than predicted: so much of the way, and so much of the thickness besides, is taken for the
// most. Who is late goes where it went, give or take what is of no account: else cuts by a rounding would go on and on.
static const float SPARE = 0.25f, SPARE_THICKNESS = 0.05f, SPARE_LATE = 0.01f;
// How far astray a patch may go: so many times what it may in a substep.
static const float REACH_SUBSTEPS = 4.0f;

typedef struct way_loop
{
    const contact_work* work;
    contact_soup* soup;
    double ( *sums )[3]; // [block]
    _Atomic bool has_fixed;
    float drifts;        // 1 while patches are taken to drift, else 0
    bool is_expected;    // else it is measured
    _Atomic int reached; // contact_reached
} way_loop;

int contact_drift_substeps( const contact_work* work )
{
    // particles stand between points of several patches
    return work->state->world.features == WISP_CONTACT_SAMPLES ? 0 : SUBSTEPS_AHEAD;
}

static void sum_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    way_loop* loop = context;
    const wisp_way_job job = { .before = loop->soup->safe, .now = loop->soup->now };
    if ( wisp_frame_kernels( loop->work->frame )->sum_ways( &job, begin, end, loop->sums[begin / GRAIN] ) )
    {
        atomic_store( &loop->has_fixed, true );
    }
}

static void find_common( way_loop* loop )
{
    const contact_work* work = loop->work;
    contact_soup* s = work->soup;
    const int blocks = ( s->point_count + GRAIN - 1 ) / GRAIN;
    memset( s->common, 0, sizeof( s->common ) );
    loop->sums = wisp_parallel_scratch( work->parallel, work->worker, (size_t)blocks * sizeof( *loop->sums ) );
    if ( loop->sums == NULL )
    {
        return; // without memory nothing is in common, which is as true and costs time alone
    }
    atomic_init( &loop->has_fixed, false );
    wisp_parallel_for( work->parallel, s->point_count, GRAIN, sum_ways, loop );
    for ( int k = 0; k < 3 && atomic_load( &loop->has_fixed ) == false; ++k )
    {
        double sum = 0.0;
        for ( int b = 0; b < blocks; ++b )
        {
            sum += loop->sums[b][k];
        }
        s->common[k] = (float)( sum / ( s->point_count > 0 ? s->point_count : 1 ) );
    }
}

static void raise_to( _Atomic int* reached, int value )
{
    int seen = atomic_load_explicit( reached, memory_order_relaxed );
    while ( seen < value && atomic_compare_exchange_weak( reached, &seen, value ) == false )
    {
    }
}

static float length_of( float x, float y, float z )
{
    const float length = sqrtf( x * x + y * y + z * z );
    return length < FARTHEST ? length : 0.0f;
}

static void measure_way( contact_soup* s, int point )
{
    float* ahead = s->ahead + (size_t)point * 4;
    const float *now = s->now + (size_t)point * 4, *safe = s->safe + (size_t)point * 4;
    const float way[3] = { now[0] - safe[0], now[1] - safe[1], now[2] - safe[2] };
    const bool is_late = length_of( way[0] - ahead[0], way[1] - ahead[1], way[2] - ahead[2] ) > ahead[3];
    if ( is_late )
    {
        memcpy( ahead, way, sizeof( way ) );
        ahead[3] = SPARE_LATE * s->least_thickness;
        s->is_late[point] = 1;
    }
}

// Where points go, and how well that is known: which pairs become rows follows from this, not from what was searched.
static void find_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    way_loop* loop = context;
    contact_soup* s = loop->soup;
    const wisp_kernels* kernels = wisp_frame_kernels( loop->work->frame );
    const wisp_way_job job = {
        .before = s->safe,
        .now = s->now,
        .common = { s->common[0], s->common[1], s->common[2] },
        .share = SPARE,
        .spare = SPARE_THICKNESS * s->least_thickness,
        .way = s->ahead,
    };
    if ( loop->is_expected )
    {
        kernels->take_ways( &job, begin, end );
        memset( s->is_late + begin, 0, (size_t)( end - begin ) );
        return;
    }
    const bool is_late = kernels->leave_ways( &job, begin, end );
    for ( int p = begin; p < end && is_late; ++p )
    {
        measure_way( s, p );
    }
    if ( is_late )
    {
        raise_to( &loop->reached, CONTACT_ELSEWHERE );
    }
}

// ---- ways of patches ----

// @param spare m, that all of it is give or take
static contact_way middle_of( const float low[4], const float high[4], float spare )
{
    contact_way way;
    float squared = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        const float wide = high[k] - low[k];
        way.middle[k] = 0.5f * ( low[k] + high[k] );
        squared += wide * wide;
    }
    way.spread = 0.50001f * sqrtf( squared ) + spare;
    return way;
}

static contact_way expected_way_of( const contact_work* work, const contact_patch* patch )
{
    const contact_soup* s = work->soup;
    float low[4], high[4];
    wisp_frame_kernels( work->frame )
        ->quad_range( s->ahead, NULL, s->patch_points + patch->first_point, patch->point_count, low, high );
    return middle_of( low, high, contact_larger( high[3], 0.0f ) );
}

static contact_way gone_way_of( const contact_work* work, const contact_patch* patch )
{
    const contact_soup* s = work->soup;
    float low[4], high[4];
    wisp_frame_kernels( work->frame )
        ->quad_range( s->now, s->safe, s->patch_points + patch->first_point, patch->point_count, low, high );
    return middle_of( low, high, 0.0f );
}

float contact_length_of_way( const contact_soup* s, const contact_way* way )
{
    const float *m = way->middle, *c = s->common;
    return length_of( m[0] - c[0], m[1] - c[1], m[2] - c[2] ) + way->spread;
}

static bool is_beyond_reach( const contact_soup* s, int patch )
{
    const contact_course* course = s->courses + patch;
    return course->spent + contact_length_of_way( s, s->ways + patch ) > course->reach;
}

static void expect_patch_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    way_loop* loop = context;
    contact_soup* s = loop->soup;
    bool is_beyond = false;
    memset( s->patch_late + begin, 0, (size_t)( end - begin ) );
    for ( int p = begin; p < end; ++p )
    {
        s->ways[p] = expected_way_of( loop->work, s->patches + p );
        is_beyond = is_beyond_reach( s, p ) || is_beyond;
    }
    if ( is_beyond )
    {
        raise_to( &loop->reached, CONTACT_BEYOND );
    }
}

// Few points are late, and patches of others go as they were expected to. All are asked for their reach: what is in common is
// another now.
static void find_late_patches( way_loop* loop )
{
    contact_soup* s = loop->soup;
    bool is_beyond = false;
    for ( int point = 0; point < s->point_count; ++point )
    {
        for ( int i = s->patches_begin[point]; s->is_late[point] != 0 && i < s->patches_begin[point + 1]; ++i )
        {
            s->patch_late[s->patches_of[i]] = 1;
        }
    }
    for ( int p = 0; p < s->patch_count; ++p )
    {
        if ( s->patch_late[p] != 0 )
        {
            s->ways[p] = expected_way_of( loop->work, s->patches + p );
        }
        is_beyond = is_beyond_reach( s, p ) || is_beyond;
    }
    if ( is_beyond )
    {
        raise_to( &loop->reached, CONTACT_BEYOND );
    }
}

static contact_reached take_ways( const contact_work* work, bool is_expected )
{
    contact_soup* s = work->soup;
    way_loop loop = { .work = work, .soup = s, .is_expected = is_expected };
    atomic_init( &loop.reached, CONTACT_WITHIN );
    find_common( &loop );
    wisp_parallel_for( work->parallel, s->point_count, GRAIN, find_ways, &loop );
    if ( is_expected )
    {
        wisp_parallel_for( work->parallel, s->patch_count, PATCH_GRAIN, expect_patch_ways, &loop );
    }
    else if ( atomic_load( &loop.reached ) != CONTACT_WITHIN )
    {
        find_late_patches( &loop );
    }
    return (contact_reached)atomic_load( &loop.reached );
}

contact_reached contact_expect_ways( const contact_work* work )
{
    return take_ways( work, true );
}

contact_reached contact_measure_ways( const contact_work* work )
{
    return take_ways( work, false );
}

// ---- courses ----

// How far a patch that goes such a way may go astray.
static float reach_for( const contact_work* work, const contact_way* way )
{
    static const float HALF = 0.5f; // of a pair
    const float margin = work->state->world.margin * work->soup->least_thickness;
    const float length = contact_length_of_way( work->soup, way );
    // patches are few, so that a wide reach costs less than searching often; particles are many
    return contact_drift_substeps( work ) > 0 ? length + contact_larger( margin, REACH_SUBSTEPS * way->spread )
                                              : contact_larger( HALF * margin, REACH_SUBSTEPS * length );
}

static void set_courses( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    const contact_soup* s = work->soup;
    const float drifts = contact_drift_substeps( work ) > 0 ? 1.0f : 0.0f;
    for ( int p = begin; p < end; ++p )
    {
        const contact_way* way = s->ways + p;
        contact_course* course = s->courses + p;
        for ( int k = 0; k < 3; ++k )
        {
            course->drift[k] = drifts * ( way->middle[k] - s->common[k] );
        }
        course->reach = reach_for( work, way );
        course->spent = 0.0f;
    }
}

void contact_set_courses( const contact_work* work )
{
    contact_soup* s = work->soup;
    s->listed_for = 0;
    wisp_parallel_for( work->parallel, s->patch_count, PATCH_GRAIN, set_courses, (void*)(uintptr_t)work );
}

bool contact_lists_too_many( const contact_work* work )
{
    static const float TOO_FAR = 2.0f;
    const contact_soup* s = work->soup;
    if ( contact_drift_substeps( work ) > 0 || s->listed_for == 0 || s->listed_for % PATIENT_SUBSTEPS != 0 )
    {
        return false;
    }
    float reach = 0.0f, needed = 0.0f;
    for ( int p = 0; p < s->patch_count; ++p )
    {
        reach += s->courses[p].reach;
        needed += reach_for( work, s->ways + p );
    }
    return reach > TOO_FAR * needed;
}

static void spend_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    const way_loop* loop = context;
    contact_soup* s = loop->soup;
    for ( int p = begin; p < end; ++p )
    {
        contact_course* course = s->courses + p;
        s->gone[p] = gone_way_of( loop->work, s->patches + p );
        contact_way astray = s->gone[p];
        for ( int k = 0; k < 3; ++k )
        {
            astray.middle[k] -= loop->drifts * course->drift[k];
        }
        course->spent += contact_length_of_way( s, &astray );
    }
}

void contact_spend_ways( const contact_work* work )
{
    contact_soup* s = work->soup;
    way_loop loop = { .work = work, .soup = s };
    loop.drifts = s->listed_for < contact_drift_substeps( work ) ? 1.0f : 0.0f;
    wisp_parallel_for( work->parallel, s->patch_count, PATCH_GRAIN, spend_ways, &loop );
    s->listed_for += 1;
}
