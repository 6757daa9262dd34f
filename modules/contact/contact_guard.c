// Nothing crosses. Two convex pieces that stay on their sides of a plane have not met, and their distances to it are linear
// in time, so it is enough that the plane between a pair separates it at the end as it did at the start. Where it does
// not, the ways of the pair's points are cut. A cut may bring others together, so it is looked at again, in rounds, until
// no plane is passed; without any way left nothing can be, so that the rounds end.
#include "contact_internal.h"

#include <stdatomic.h>

enum
{
    PATIENT_ROUNDS = 16, // then ways are cut to nothing at once
    MOST_ROUNDS = 64,    // then those of all points
    POINT_GRAIN = 2048,
    ROW_GRAIN = 128,
};

// A pair may come this near, of what it should keep; if it is nearer already, of its distance.
static const float ALMOST = 0.999f;
static const float LEAST_OF_WANTED = 0.1f, LEAST_OF_DISTANCE = 0.98f;

typedef struct guard_loop
{
    contact_soup* soup;
    bool* has_cuts; // [part of the rows]
    bool gives_up;
    _Atomic bool is_crossed;
} guard_loop;

// How far a point is along the normal with a share of its way, about an origin.
static float place_along( const contact_soup* s, const contact_row* row, int i, float share, const float* origin )
{
    const size_t at = (size_t)row->point[i] * 4;
    float sum = 0.0f;
    for ( size_t k = 0; k < 3; ++k )
    {
        const float start = s->safe[at + k] - origin[k];
        const float way = s->now[at + k] - s->safe[at + k] - s->common[k];
        sum += row->normal[k] * ( start + share * way );
    }
    return sum;
}

// What is between the two sides: with the shares as they are, or with all that can be cut cut to nothing.
static float separation( const contact_soup* s, const contact_row* row, bool is_cut )
{
    const float* origin = s->safe + (size_t)row->point[row->count - 1] * 4;
    float front = INFINITY, back = -INFINITY;
    for ( int i = 0; i < row->count; ++i )
    {
        const int point = row->point[i];
        const bool is_fixed = s->now[(size_t)point * 4 + 3] == 0.0f;
        const float share = is_cut && is_fixed == false ? 0.0f : s->share[point];
        const float place = place_along( s, row, i, share, origin );
        front = i < row->split ? contact_smaller( front, place ) : front;
        back = i >= row->split ? contact_larger( back, place ) : back;
    }
    return front - back;
}

static contact_row* row_of( const contact_soup* s, int r )
{
    return r < s->row_count ? s->rows + r : s->late_rows + ( r - s->row_count );
}

// @return whether it cuts ways
static bool check_row( guard_loop* loop, contact_row* row )
{
    const contact_soup* s = loop->soup;
    const float least = contact_smaller( LEAST_OF_WANTED * row->wanted, LEAST_OF_DISTANCE * row->distance );
    const float there = separation( s, row, false );
    row->cut = 1.0f;
    if ( there < least )
    {
        const float start = separation( s, row, true );
        row->cut = loop->gives_up || !( start > least ) ? 0.0f : ( start - least ) / ( start - there );
        if ( start <= 0.0f ) // what is held by the user went through: nobody can cut that
        {
            atomic_store( &loop->is_crossed, true );
        }
    }
    return there < least;
}

static void check_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    guard_loop* loop = context;
    bool cuts = false;
    for ( int r = begin; r < end; ++r )
    {
        cuts = check_row( loop, row_of( loop->soup, r ) ) || cuts;
    }
    loop->has_cuts[begin / ROW_GRAIN] = cuts;
}

static bool take_cut( contact_soup* s, const contact_row* row )
{
    bool any = false;
    for ( int i = 0; i < row->count && row->cut < 1.0f; ++i )
    {
        const int point = row->point[i];
        const bool can = s->now[(size_t)point * 4 + 3] > 0.0f && s->share[point] > 0.0f;
        // several pairs of a round cut a point one after the other: more than the worst asks for, never less
        s->share[point] *= can ? row->cut : 1.0f;
        s->share[point] = s->share[point] < 1e-4f && can ? 0.0f : s->share[point];
        any = any || can;
    }
    return any;
}

// One after the other, in the order of rows: they share points, and there are few.
static bool take_cuts( guard_loop* loop, int count )
{
    bool any = false;
    for ( int r = 0; r < count; ++r )
    {
        any = ( loop->has_cuts[r / ROW_GRAIN] && take_cut( loop->soup, row_of( loop->soup, r ) ) ) || any;
    }
    return any;
}

// Where lists cannot reach as far as points go, patches go no farther than lists reach.
static void limit_ways( const contact_work* work )
{
    contact_soup* s = work->soup;
    for ( int i = 0; i < s->point_count; ++i )
    {
        s->share[i] = 1.0f;
    }
    for ( int p = 0; p < s->patch_count && s->is_short; ++p )
    {
        const contact_patch* patch = s->patches + p;
        const float left = ALMOST * ( s->courses[p].reach - s->courses[p].spent );
        const float way = contact_length_of_way( s, s->ways + p );
        const float share = way > left ? ( left > 0.0f ? left / way : 0.0f ) : 1.0f;
        for ( int i = 0; i < patch->point_count; ++i )
        {
            const int point = s->patch_points[patch->first_point + i] / 4;
            const bool is_free = s->now[(size_t)point * 4 + 3] > 0.0f;
            s->share[point] = is_free ? contact_smaller( s->share[point], share ) : s->share[point];
        }
    }
}

static void cut_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    const guard_loop* loop = context;
    contact_soup* s = loop->soup;
    for ( int i = begin; i < end; ++i )
    {
        const float share = s->share[i];
        for ( size_t k = 0, at = (size_t)i * 4; k < 3 && share < 1.0f; ++k )
        {
            const float there = s->safe[at + k] + s->common[k];
            s->now[at + k] = there + share * ( s->now[at + k] - there );
            s->shift[at + k] *= share;
        }
    }
}

static int count_cut( const contact_soup* s )
{
    int count = 0;
    for ( int i = 0; i < s->point_count; ++i )
    {
        count += s->share[i] < 1.0f ? 1 : 0;
    }
    return count;
}

static void hold_all( contact_soup* s )
{
    for ( int i = 0; i < s->point_count; ++i )
    {
        s->share[i] = s->now[(size_t)i * 4 + 3] > 0.0f ? 0.0f : 1.0f;
    }
}

void contact_hold( const contact_work* work )
{
    guard_loop loop = { .soup = work->soup };
    contact_soup* s = work->soup;
    hold_all( s );
    work->memory->figures.guarded += count_cut( s );
    wisp_parallel_for( work->parallel, s->point_count, POINT_GRAIN, cut_ways, &loop );
    contact_measure_ways( work );
}

int contact_guard( const contact_work* work )
{
    contact_soup* s = work->soup;
    guard_loop loop = { .soup = s };
    atomic_init( &loop.is_crossed, false );
    const int count = s->row_count + s->late_row_count;
    loop.has_cuts = wisp_parallel_scratch( work->parallel, work->worker, (size_t)( count / ROW_GRAIN + 1 ) );
    if ( loop.has_cuts == NULL )
    {
        wisp_frame_fail( work->frame, WISP_NO_MEMORY, "no memory to guard %d pairs", count );
        return 0;
    }
    limit_ways( work );
    bool cuts = true;
    for ( int round = 0; round < MOST_ROUNDS && cuts; ++round )
    {
        loop.gives_up = round >= PATIENT_ROUNDS;
        wisp_parallel_for( work->parallel, count, ROW_GRAIN, check_rows, &loop );
        cuts = take_cuts( &loop, count );
    }
    if ( cuts )
    {
        hold_all( s );
    }
    const int cut = count_cut( s );
    work->memory->tangled = atomic_load( &loop.is_crossed ) ? 1 : work->memory->tangled;
    if ( cut > 0 )
    {
        wisp_parallel_for( work->parallel, s->point_count, POINT_GRAIN, cut_ways, &loop );
    }
    return cut;
}
