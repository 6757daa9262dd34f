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
// When some points have spent theirs, those whose reach would not last for so many substeps are searched with them.
static const float RENEWED_AHEAD = 3.0f;

typedef struct way_loop
{
    contact_soup* soup;
    double ( *sums )[3]; // [block]
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

// A new reach for a point, from where it is safe.
static void set_reach_of( const contact_work* work, int point )
{
    static const float HALF = 0.5f; // of a pair
    contact_soup* s = work->soup;
    const size_t at = (size_t)point * 4;
    const float least = HALF * work->state->world.margin * s->least_thickness;
    s->safe[at + 3] = contact_larger( least, SUBSTEPS_AHEAD * s->closing[point] );
    for ( size_t k = 0; k < 3; ++k )
    {
        s->searched[at + k] = (float)( (double)s->safe[at + k] - work->memory->drift[k] );
    }
    s->searched[at + 3] = 0.0f;
}

static void set_reach( void* context, int begin, int end, int worker )
{
    (void)worker;
    for ( int p = begin; p < end; ++p )
    {
        set_reach_of( context, p );
    }
}

void contact_set_reach( const contact_work* work )
{
    memset( work->memory->drift, 0, sizeof( work->memory->drift ) );
    wisp_parallel_for( work->parallel, work->soup->point_count, GRAIN, set_reach, (void*)(uintptr_t)work );
}

// Mark the points whose reach does not last for so many substeps. @return how many there are
static int mark_spent( contact_soup* s, float substeps )
{
    int count = 0;
    for ( int p = 0; p < s->point_count; ++p )
    {
        const float spent = s->searched[(size_t)p * 4 + 3] + substeps * s->closing[p];
        s->renewed[p] = spent > s->safe[(size_t)p * 4 + 3] ? 1 : 0;
        count += s->renewed[p];
    }
    return count;
}

int contact_renew_reach( const contact_work* work, int most )
{
    contact_soup* s = work->soup;
    int count = mark_spent( s, RENEWED_AHEAD );
    count = count > most ? mark_spent( s, 1.0f ) : count;
    for ( int p = 0; p < s->point_count && count <= most; ++p )
    {
        if ( s->renewed[p] != 0 )
        {
            set_reach_of( work, p );
        }
    }
    return count;
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
    for ( int k = 0; k < 3; ++k )
    {
        work->memory->drift[k] += (double)work->soup->common[k];
    }
}
