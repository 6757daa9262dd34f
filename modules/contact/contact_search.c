// Which patches may come near each other while all keep to their courses.
#include "contact_internal.h"

#include <string.h>

enum
{
    BOX_GRAIN = 256,
    LIST_GRAIN = 64,
    MOST_PER_PATCH = 512, // pairs a patch, before reach is cut
};

// ---- what is kept apart ----

bool contact_may_meet( const contact_guest* a, const contact_guest* b )
{
    if ( a == b )
    {
        return a->settings.self != 0;
    }
    return ( a->settings.layers & b->settings.mask ) != 0 && ( b->settings.layers & a->settings.mask ) != 0 &&
           ( a->is_strands && b->is_strands ) == false;
}

float contact_gap_of( const contact_work* work, int a, int b )
{
    const contact_guest *ga = contact_guest_of( work, a ), *gb = contact_guest_of( work, b );
    return contact_may_meet( ga, gb ) ? 0.5f * ( ga->settings.thickness + gb->settings.thickness ) : 0.0f;
}

// ---- boxes ----

wisp_box contact_box_around( const contact_work* work, const contact_patch* patch )
{
    const contact_soup* s = work->soup;
    float low[4], high[4];
    wisp_box box;
    wisp_frame_kernels( work->frame )
        ->quad_range( s->safe, NULL, s->patch_points + patch->first_point, patch->point_count, low, high );
    memcpy( box.low, low, sizeof( box.low ) );
    memcpy( box.high, high, sizeof( box.high ) );
    return box;
}

// The box that a patch stays in as long as it keeps to its course, in a frame that goes where all go.
static wisp_box reached_box( const contact_work* work, int p )
{
    const contact_soup* s = work->soup;
    const contact_course* course = s->courses + p;
    const float wide = 0.5f * work->state->guests[s->patches[p].guest].settings.thickness + course->reach;
    const float substeps = (float)contact_drift_substeps( work );
    wisp_box box = contact_box_around( work, s->patches + p );
    for ( int k = 0; k < 3; ++k )
    {
        const float way = substeps * course->drift[k];
        box.low[k] += contact_smaller( way, 0.0f ) - wide;
        box.high[k] += contact_larger( way, 0.0f ) + wide;
    }
    return box;
}

static void box_patches( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    contact_soup* s = work->soup;
    for ( int p = begin; p < end; ++p )
    {
        s->reached_boxes[p] = reached_box( work, p );
    }
}

// ---- lists ----

static bool patches_meet( const contact_work* work, int a, int b )
{
    const contact_patch* patches = work->soup->patches;
    const contact_guest* guests = work->state->guests;
    return contact_may_meet( guests + patches[a].guest, guests + patches[b].guest );
}

static int keep_meeting( const void* context, int asker, int32_t* items, int count )
{
    int kept = 0;
    for ( int i = 0; i < count; ++i )
    {
        const int32_t item = items[i];
        items[kept] = item;
        kept += patches_meet( context, asker, item ) ? 1 : 0;
    }
    return kept;
}

static bool reserve_pairs( const contact_work* work, contact_patch_pairs* pairs, size_t count, int which )
{
    const size_t patches = (size_t)work->soup->patch_count + 1, most = count + WISP_SLICE;
    return contact_reserve( work, CONTACT_PAIRS_BEGIN + (contact_place)which, patches * sizeof( int32_t ),
                            (void**)&pairs->begin ) &&
           contact_reserve( work, CONTACT_PAIRS_PATCH + (contact_place)which, most * sizeof( int32_t ),
                            (void**)&pairs->patch ) &&
           contact_reserve( work, CONTACT_PAIRS_OTHER + (contact_place)which, most * sizeof( int32_t ),
                            (void**)&pairs->other ) &&
           contact_reserve( work, CONTACT_PAIRS_SLACK + (contact_place)which, most * sizeof( float ),
                            (void**)&pairs->slack ) &&
           contact_reserve( work, CONTACT_DUE, most * sizeof( int32_t ), (void**)&work->soup->due ) &&
           contact_reserve( work, CONTACT_DUE_COUNT, ( most / CONTACT_PAIRS_PART + 1 ) * sizeof( int32_t ),
                            (void**)&work->soup->due_count );
}

static void put_pair( contact_patch_pairs* pairs, int at, int32_t patch, int32_t other, float slack )
{
    pairs->patch[at] = patch;
    pairs->other[at] = other;
    pairs->slack[at] = slack;
}

// What was known of the pairs of a patch, in the order of the others.
typedef struct known_pairs
{
    const contact_patch_pairs* pairs;
    int next, end;
} known_pairs;

// What is known of a pair that was listed before holds.
static float slack_of( known_pairs* known, int32_t other )
{
    while ( known->next < known->end && known->pairs->other[known->next] < other )
    {
        known->next += 1;
    }
    const bool is_known = known->next < known->end && known->pairs->other[known->next] == other;
    return is_known ? known->pairs->slack[known->next] : -INFINITY;
}

typedef struct list_loop
{
    const contact_work* work;
    bool is_known;
} list_loop;

static void list_pairs_of( void* context, int begin, int end, int worker )
{
    (void)worker;
    const list_loop* loop = context;
    contact_soup* s = loop->work->soup;
    const wisp_box_pairs* found = &s->overlaps;
    for ( int p = begin; p < end; ++p )
    {
        known_pairs known = { .pairs = s->pairs + 1 };
        if ( loop->is_known )
        {
            known.next = known.pairs->begin[p];
            known.end = known.pairs->begin[p + 1];
        }
        int at = s->pairs[0].begin[p];
        if ( patches_meet( loop->work, p, p ) )
        {
            put_pair( s->pairs, at++, p, p, slack_of( &known, p ) );
        }
        for ( int i = found->begin[p]; i < found->begin[p + 1]; ++i )
        {
            const int32_t other = found->item[i];
            put_pair( s->pairs, at++, p, other, slack_of( &known, other ) );
        }
    }
}

static bool list_pairs( const contact_work* work, bool is_known )
{
    contact_soup* s = work->soup;
    const wisp_box_pairs* found = &s->overlaps;
    const contact_patch_pairs known = s->pairs[0];
    // the arrays of the list before that one are free
    s->pairs[0] = s->pairs[1];
    s->pairs[1] = known;
    s->pairs_turn = 1 - s->pairs_turn;
    contact_patch_pairs* pairs = s->pairs;
    if ( reserve_pairs( work, pairs, found->pair_count + (size_t)s->patch_count, s->pairs_turn ) == false )
    {
        return false;
    }
    pairs->count = 0;
    for ( int p = 0; p < s->patch_count; ++p )
    {
        pairs->begin[p] = pairs->count;
        pairs->count += ( patches_meet( work, p, p ) ? 1 : 0 ) + found->begin[p + 1] - found->begin[p];
    }
    pairs->begin[s->patch_count] = pairs->count;
    list_loop loop = { work, is_known };
    wisp_parallel_for( work->parallel, s->patch_count, LIST_GRAIN, list_pairs_of, &loop );
    for ( int i = 0; i < WISP_SLICE; ++i )
    {
        put_pair( pairs, pairs->count + i, 0, 0, INFINITY );
    }
    return true;
}

// ---- searching ----

static wisp_status find_pairs( const contact_work* work, wisp_error* error )
{
    contact_soup* s = work->soup;
    if ( work->state->world.features == WISP_CONTACT_SAMPLES )
    {
        return contact_find_sample_pairs( work, error );
    }
    wisp_parallel_for( work->parallel, s->patch_count, BOX_GRAIN, box_patches, (void*)(uintptr_t)work );
    const wisp_box_job job = {
        .boxes = s->reached_boxes,
        .box_count = s->patch_count,
        .search = work->state->world.search,
        .kernels = wisp_frame_kernels( work->frame ),
        .limit = (size_t)s->patch_count * MOST_PER_PATCH,
        .filter = keep_meeting,
        .filter_context = work,
    };
    return wisp_box_pairs_find( &s->overlaps, work->parallel, &job, error );
}

// Look less far, and let the guard cut what goes farther.
static void halve_reach( contact_soup* s )
{
    for ( int p = 0; p < s->patch_count; ++p )
    {
        s->courses[p].reach *= 0.5f;
        for ( int k = 0; k < 3; ++k )
        {
            s->courses[p].drift[k] *= 0.5f;
        }
    }
}

wisp_status contact_search( const contact_work* work, wisp_error* error )
{
    contact_soup* s = work->soup;
    const bool are_samples = work->state->world.features == WISP_CONTACT_SAMPLES;
    wisp_status status = WISP_BAD_INPUT;
    contact_set_courses( work );
    s->is_short = false;
    for ( int halvings = 0; status == WISP_BAD_INPUT && halvings < 40; ++halvings )
    {
        status = find_pairs( work, error );
        if ( status == WISP_BAD_INPUT ) // more than so many pairs are no list
        {
            halve_reach( s );
            s->is_short = true;
        }
    }
    if ( status == WISP_OK && are_samples == false && list_pairs( work, s->is_listed ) == false )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for %zu pairs", s->overlaps.pair_count );
    }
    s->is_listed = status == WISP_OK;
    return status;
}
