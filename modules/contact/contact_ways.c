// How far each point goes, which bounds how much nearer any two features can come, and how well it keeps to its course, which
// tells for how long a search of pairs is good.
#include "contact_internal.h"

#include <stdatomic.h>
#include <string.h>

enum
{
    GRAIN = 2048,
    SUBSTEPS_AHEAD = 5, // that points are taken to drift
};

// What is farther is no way of a point, but a number that went wrong.
static const float FARTHEST = 1e6f;
// Projections move points elsewhere than predicted: so much of the way, and so much of the thickness besides, is taken for the
// most.
static const float SPARE = 0.25f, SPARE_THICKNESS = 0.05f;
// How far astray a point may go: so many times what it may in a substep.
static const float REACH_SUBSTEPS = 4.0f;

typedef struct way_loop
{
    const contact_work* work;
    contact_soup* soup;
    double ( *sums )[3]; // [block]
    float drifts;        // 1 while points are taken to drift, else 0
    bool is_expected;    // else it is measured
    _Atomic int reached; // contact_reached
} way_loop;

int contact_drift_substeps( const contact_work* work )
{
    // particles stand between their points and have no drift of their own
    return work->state->world.features == WISP_CONTACT_SAMPLES ? 0 : SUBSTEPS_AHEAD;
}

static void sum_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    const way_loop* loop = context;
    double* sum = loop->sums[begin / GRAIN];
    sum[0] = sum[1] = sum[2] = 0.0;
    for ( size_t i = (size_t)begin * 4; i < (size_t)end * 4; i += 4 )
    {
        for ( size_t k = 0; k < 3; ++k )
        {
            const float way = loop->soup->now[i + k] - loop->soup->safe[i + k];
            sum[k] += fabsf( way ) < FARTHEST ? (double)way : 0.0;
        }
    }
}

static bool has_fixed( const contact_soup* s )
{
    for ( int i = 0; i < s->point_count; ++i )
    {
        if ( s->now[(size_t)i * 4 + 3] == 0.0f )
        {
            return true;
        }
    }
    return false;
}

static void find_common( way_loop* loop )
{
    const contact_work* work = loop->work;
    contact_soup* s = work->soup;
    const int blocks = ( s->point_count + GRAIN - 1 ) / GRAIN;
    memset( s->common, 0, sizeof( s->common ) );
    loop->sums = has_fixed( s )
                     ? NULL
                     : wisp_parallel_scratch( work->parallel, work->worker, (size_t)blocks * sizeof( *loop->sums ) );
    if ( loop->sums == NULL )
    {
        return; // without memory nothing is in common, which is as true and costs time alone
    }
    wisp_parallel_for( work->parallel, s->point_count, GRAIN, sum_ways, loop );
    for ( int k = 0; k < 3; ++k )
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

// How far from its course a point is that goes some way.
static float stray_of( const way_loop* loop, const float* way, const float* drift )
{
    const float *c = loop->soup->common, drifts = loop->drifts;
    return length_of( way[0] - c[0] - drifts * drift[0], way[1] - c[1] - drifts * drift[1],
                      way[2] - c[2] - drifts * drift[2] );
}

// Where a point goes, and how well that is known: which pairs become rows follows from this, not from what was searched.
static void expect_way( contact_soup* s, int point )
{
    float* ahead = s->ahead + (size_t)point * 4;
    const float *now = s->now + (size_t)point * 4, *safe = s->safe + (size_t)point * 4, *c = s->common;
    for ( int k = 0; k < 3; ++k )
    {
        ahead[k] = now[k] - safe[k];
    }
    const float length = length_of( ahead[0] - c[0], ahead[1] - c[1], ahead[2] - c[2] );
    ahead[3] = SPARE * length + SPARE_THICKNESS * s->least_thickness;
    s->is_late[point] = 0;
}

static bool measure_way( contact_soup* s, int point )
{
    float* ahead = s->ahead + (size_t)point * 4;
    const float *now = s->now + (size_t)point * 4, *safe = s->safe + (size_t)point * 4;
    const float way[3] = { now[0] - safe[0], now[1] - safe[1], now[2] - safe[2] };
    const bool is_late = length_of( way[0] - ahead[0], way[1] - ahead[1], way[2] - ahead[2] ) > ahead[3];
    if ( is_late )
    {
        memcpy( ahead, way, sizeof( way ) );
        ahead[3] = 0.0f;
        s->is_late[point] = 1;
    }
    return is_late;
}

static void find_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    way_loop* loop = context;
    contact_soup* s = loop->soup;
    contact_reached reached = CONTACT_WITHIN;
    for ( int p = begin; p < end; ++p )
    {
        const size_t i = (size_t)p * 4;
        const float way[3] = { s->now[i] - s->safe[i], s->now[i + 1] - s->safe[i + 1],
                               s->now[i + 2] - s->safe[i + 2] };
        bool is_late = false;
        if ( loop->is_expected )
        {
            expect_way( s, p );
        }
        else
        {
            is_late = measure_way( s, p );
        }
        s->gone[p] = stray_of( loop, way, s->drift + i );
        s->astray[p] = stray_of( loop, s->ahead + i, s->drift + i ) + s->ahead[i + 3];
        const bool is_beyond = contact_is_beyond( s, p );
        reached = is_beyond ? CONTACT_BEYOND : ( is_late && reached == CONTACT_WITHIN ? CONTACT_ELSEWHERE : reached );
    }
    raise_to( &loop->reached, (int)reached );
}

static contact_reached take_ways( const contact_work* work, bool is_expected )
{
    way_loop loop = { .work = work, .soup = work->soup, .is_expected = is_expected };
    loop.drifts = work->soup->drifted < contact_drift_substeps( work ) ? 1.0f : 0.0f;
    atomic_init( &loop.reached, CONTACT_WITHIN );
    find_common( &loop );
    wisp_parallel_for( work->parallel, work->soup->point_count, GRAIN, find_ways, &loop );
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

void contact_set_course( const contact_work* work, int point )
{
    static const float HALF = 0.5f; // of a pair
    contact_soup* s = work->soup;
    const bool drifts = contact_drift_substeps( work ) > s->drifted;
    const float least = HALF * work->state->world.margin * s->least_thickness;
    const size_t i = (size_t)point * 4;
    // in a frame that goes where all go
    const float *ahead = s->ahead + i, *c = s->common;
    for ( size_t k = 0; k < 3; ++k )
    {
        s->drift[i + k] = drifts ? ahead[k] - c[k] : 0.0f;
    }
    s->drift[i + 3] = 0.0f;
    const float astray =
        drifts ? ahead[3] : ahead[3] + length_of( ahead[0] - c[0], ahead[1] - c[1], ahead[2] - c[2] );
    s->reach[point] = contact_larger( least, REACH_SUBSTEPS * astray );
    s->spent[point] = 0.0f;
    s->astray[point] = s->gone[point] = astray;
}

static void set_courses( void* context, int begin, int end, int worker )
{
    (void)worker;
    for ( int p = begin; p < end; ++p )
    {
        contact_set_course( context, p );
    }
}

void contact_set_courses( const contact_work* work )
{
    contact_soup* s = work->soup;
    s->drifted = 0;
    memset( s->travelled, 0, sizeof( s->travelled ) );
    wisp_parallel_for( work->parallel, s->point_count, GRAIN, set_courses, (void*)(uintptr_t)work );
}

static void spend_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    contact_soup* s = context;
    for ( int p = begin; p < end; ++p )
    {
        s->spent[p] += s->gone[p];
    }
}

void contact_spend_ways( const contact_work* work )
{
    contact_soup* s = work->soup;
    wisp_parallel_for( work->parallel, s->point_count, GRAIN, spend_ways, s );
    s->drifted += s->drifted < contact_drift_substeps( work ) ? 1 : 0;
    for ( int k = 0; k < 3; ++k )
    {
        s->travelled[k] += s->common[k];
    }
}
