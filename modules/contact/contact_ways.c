// How far each point goes, which bounds how much nearer any two features can come, and how far that is looked ahead.
#include "contact_internal.h"

#include <stdatomic.h>
#include <string.h>

enum
{
    GRAIN = 2048,
};

// What is farther is no way of a point, but a number that went wrong.
static const float FARTHEST = 1e6f;
// Projections move points beyond what was predicted: so many times the prediction, and so much of the thickness besides, are
// taken for the most.
static const float SPARE = 1.25f, SPARE_THICKNESS = 0.05f;
// A search looks so many substeps ahead.
static const float SUBSTEPS_AHEAD = 4.0f;

typedef struct way_loop
{
    contact_soup* soup;
    double ( *sums )[3]; // [block]
    float least_reach;   // m
    bool is_expected;    // else it is measured
    _Atomic int reached; // contact_reached
} way_loop;

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

static void find_common( const contact_work* work )
{
    contact_soup* s = work->soup;
    const int blocks = ( s->point_count + GRAIN - 1 ) / GRAIN;
    memset( s->common, 0, sizeof( s->common ) );
    way_loop loop = { .soup = s };
    loop.sums = has_fixed( s )
                    ? NULL
                    : wisp_parallel_scratch( work->parallel, work->worker, (size_t)blocks * sizeof( *loop.sums ) );
    if ( loop.sums == NULL )
    {
        return; // without memory nothing is in common, which is as true and costs time alone
    }
    wisp_parallel_for( work->parallel, s->point_count, GRAIN, sum_ways, &loop );
    for ( int k = 0; k < 3; ++k )
    {
        double sum = 0.0;
        for ( int b = 0; b < blocks; ++b )
        {
            sum += loop.sums[b][k];
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

static void find_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    way_loop* loop = context;
    contact_soup* s = loop->soup;
    const float* c = s->common;
    contact_reached reached = CONTACT_WITHIN;
    for ( int p = begin; p < end; ++p )
    {
        const size_t i = (size_t)p * 4;
        const float x = s->now[i] - s->safe[i] - c[0], y = s->now[i + 1] - s->safe[i + 1] - c[1];
        const float z = s->now[i + 2] - s->safe[i + 2] - c[2];
        const float length = sqrtf( x * x + y * y + z * z ), way = length < FARTHEST ? length : 0.0f;
        const float closing = loop->is_expected ? SPARE * way + SPARE_THICKNESS * s->least_thickness : way;
        const bool is_late = closing > s->closing[p], is_beyond = s->searched[i + 3] + closing > s->safe[i + 3];
        reached = is_beyond ? CONTACT_BEYOND : ( is_late && reached == CONTACT_WITHIN ? CONTACT_LATE : reached );
        s->closing[p] = closing;
    }
    raise_to( &loop->reached, (int)reached );
}

static contact_reached take_ways( const contact_work* work, bool is_expected )
{
    find_common( work );
    way_loop loop = { .soup = work->soup, .is_expected = is_expected };
    atomic_init( &loop.reached, CONTACT_WITHIN );
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

static void set_reach( void* context, int begin, int end, int worker )
{
    (void)worker;
    const way_loop* loop = context;
    contact_soup* s = loop->soup;
    for ( int p = begin; p < end; ++p )
    {
        s->safe[(size_t)p * 4 + 3] = contact_larger( loop->least_reach, SUBSTEPS_AHEAD * s->closing[p] );
        s->searched[(size_t)p * 4 + 3] = 0.0f;
    }
}

void contact_set_reach( const contact_work* work )
{
    static const float HALF = 0.5f; // of a pair
    way_loop loop = { .soup = work->soup };
    loop.least_reach = HALF * work->state->world.margin * work->soup->least_thickness;
    memcpy( loop.soup->searched, loop.soup->safe, (size_t)loop.soup->point_count * 4 * sizeof( float ) );
    wisp_parallel_for( work->parallel, loop.soup->point_count, GRAIN, set_reach, &loop );
}

static void spend_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    const way_loop* loop = context;
    for ( int p = begin; p < end; ++p )
    {
        loop->soup->searched[(size_t)p * 4 + 3] += loop->soup->closing[p];
    }
}

void contact_spend_ways( const contact_work* work )
{
    way_loop loop = { .soup = work->soup };
    wisp_parallel_for( work->parallel, work->soup->point_count, GRAIN, spend_ways, &loop );
}
