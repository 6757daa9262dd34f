// The third stage: neighbours attract, gaps stay (Kim 2026, eq. 14-19). One groom runs on all workers, several grooms on one worker
// each.
//
//   pack      lanes -> items in the user's order
//   search    items -> slots by cell, so that neighbours lie side by side; lists of all vertices of other strands within
//             h, and within a skin around it
//   iterate   attract: tentative positions, at first also r0; brake: lambda from r0 and r1 = distance of the tentative
//             positions; keep up: list all pairs that are near now (clump.c)
//   unpack    slots -> lanes
//
// Pairs beyond h add exact zeros to the sums. When the vertices are searched again, the brake keeps the first list, whose
// pairs are those of the reference shape.
#include "frozen_hair_state.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

// ---- search ----

// Neighbours of vertices, at first and while they move.
//
// The lists reach a skin further than h. A pair that they lack was further apart than h and the skin together when they
// were made, so the lists are complete while no vertex has moved further than half the skin, its search margin. Few
// vertices leave the margin: they are searched one by one, and pairs that the lists lack form the late list. Where many leave it,
// all vertices are searched again.

// The skin: so many steps of sigma for each iteration that needs the lists, at most this share of h. A wider one costs
// every iteration, a narrower one has more strays (bench case "paper").
static const float CLUMP_SKIN_STEPS = 1.1f;
static const float MAX_CLUMP_SKIN = 0.6f;

enum
{
    CLUMP_STRAYS = 64,    // strays a block of the search for late pairs
    CLUMP_FINE = 4,       // cells a radius along the grid's rows
    MAX_CLUMP_STRAYS = 8, // of so many vertices one may stray before all are searched again
};

// Radius h with a margin for rounding.
static float near_radius( const clump_run* run )
{
    return run->params->radius * 1.0001f;
}

static float skin_radius( const clump_run* run )
{
    return near_radius( run ) + run->skin;
}

// A vertex moves about one sigma in an iteration at most. The moves of the last iteration need no list.
static float choose_skin( const frozen_clump* c )
{
    float skin = CLUMP_SKIN_STEPS * c->step * (float)( c->iterations - 1 );
    return skin < MAX_CLUMP_SKIN * c->radius ? skin : MAX_CLUMP_SKIN * c->radius;
}

// ---- the reference shape ----

static void fill_slots( void* context, int begin, int end, int worker )
{
    (void)worker;
    const clump_run* run = context;
    const wisp_grid* grid = &run->w->grid;
    const int32_t* offsets = run->strands->offsets;
    for ( int slot = begin; slot < end; ++slot )
    {
        float* q = run->current + 4 * (size_t)slot;
        q[0] = grid->x[slot];
        q[1] = grid->y[slot];
        q[2] = grid->z[slot];
        memcpy( q + 3, grid->owner + slot, sizeof( int32_t ) );
        run->slot_vertex[slot] = grid->item[slot] - offsets[grid->owner[slot]];
    }
}

static wisp_neighbour_query make_query( const clump_run* run, const float* xyzw )
{
    return ( wisp_neighbour_query ){
        .xyzw = xyzw,
        .query_count = run->count,
        .near_radius = near_radius( run ),
        .skin_radius = skin_radius( run ),
        .limit = run->params->neighbour_limit,
        .rename = run->rename,
    };
}

// Make the lists of all vertices at their present places.
static void use( clump_run* run, const wisp_neighbours* lists, const float* searched )
{
    run->lists = lists;
    run->searched = searched;
    run->moved = 0.0f;
    run->report->searches += 1;
    run->report->capped += lists->capped;
}

wisp_status clump_search( clump_run* run )
{
    clump_workspace* w = run->w;
    run->skin = choose_skin( run->params );
    WISP_TRY(
        wisp_grid_build( &w->grid, run->parallel, run->item_quads, run->count, skin_radius( run ), CLUMP_FINE ) );
    run->grid = &w->grid;
    run->rename = NULL;
    wisp_parallel_for( run->parallel, run->count, CLUMP_GRAIN, fill_slots, run );
    wisp_neighbour_query query = make_query( run, run->current );
    wisp_status status = wisp_neighbours_build( &w->lists, run->parallel, run->kernels, &w->grid, &query );
    const size_t bytes = w->lists.entries * WISP_SLICE * sizeof( float );
    if ( status != WISP_OK ||
         wisp_buffer_reserve( &w->measured, wisp_parallel_allocator( run->parallel ), bytes ) == false )
    {
        return WISP_NO_MEMORY;
    }
    run->measured.distance = w->measured.data;
    use( run, &w->lists, run->current );
    return WISP_OK;
}

// ---- search again ----

// Copy the present place of a vertex in the form of the grid.
static void copy_vertex( const clump_run* run, int slot, float* quad )
{
    memcpy( quad, run->current + 4 * (size_t)slot, 3 * sizeof( float ) );
    memcpy( quad + 3, run->w->grid.owner + slot, sizeof( int32_t ) );
}

static void copy_moved( void* context, int begin, int end, int worker )
{
    (void)worker;
    const clump_run* run = context;
    for ( int slot = begin; slot < end; ++slot )
    {
        copy_vertex( run, slot, run->item_quads + 4 * (size_t)slot );
    }
}

static wisp_status search_again( clump_run* run )
{
    clump_workspace* w = run->w;
    wisp_parallel_for( run->parallel, run->count, CLUMP_GRAIN, copy_moved, run );
    WISP_TRY( wisp_grid_build( &w->moved_grid, run->parallel, run->item_quads, run->count, skin_radius( run ),
                               CLUMP_FINE ) );
    run->grid = &w->moved_grid;
    run->rename = w->moved_grid.item;
    wisp_neighbour_query query = make_query( run, run->item_quads );
    wisp_status status = wisp_neighbours_build( &w->moved_lists, run->parallel, run->kernels, run->grid, &query );
    use( run, &w->moved_lists, run->item_quads );
    return status;
}

// ---- strays ----

// Count one bit per vertex, eight slices at a time; padding is never set.
static int count_strays( const clump_run* run )
{
    uint64_t count = 0;
    for ( int slice = 0; slice < run->slices; slice += 8 )
    {
        uint64_t bits;
        memcpy( &bits, run->needs_search + slice, sizeof( bits ) );
        bits -= bits >> 1 & 0x5555555555555555u;
        bits = ( bits & 0x3333333333333333u ) + ( bits >> 2 & 0x3333333333333333u );
        bits = ( bits + ( bits >> 4 ) ) & 0x0f0f0f0f0f0f0f0fu;
        count += bits * 0x0101010101010101u >> 56;
    }
    return (int)count;
}

// Vertices that have left their search margin, as queries at their present places.
typedef struct stray_queries
{
    float* xyzw;   // [stray][4], whole slices
    int32_t* slot; // [stray]
    int count;
} stray_queries;

static bool collect_strays( clump_run* run, int count, stray_queries* out )
{
    // reserve the maximum, so that a step with more of them than the last allocates nothing
    size_t room = (size_t)( run->count / MAX_CLUMP_STRAYS + 1 + WISP_SLICE ) / WISP_SLICE * WISP_SLICE;
    wisp_buffer* buffer = &run->w->strays;
    if ( wisp_buffer_reserve( buffer, wisp_parallel_allocator( run->parallel ), room * 5 * sizeof( float ) ) ==
         false )
    {
        return false;
    }
    *out = ( stray_queries ){ .xyzw = buffer->data, .count = count };
    out->slot = (int32_t*)( out->xyzw + 4 * room );
    memset( out->xyzw, 0, room * 4 * sizeof( float ) );
    int at = 0;
    for ( int slice = 0; slice < run->slices; ++slice )
    {
        for ( unsigned bits = run->needs_search[slice]; bits != 0; bits &= bits - 1 )
        {
            int slot = slice * WISP_SLICE + __builtin_ctz( bits );
            copy_vertex( run, slot, out->xyzw + 4 * (size_t)at );
            out->slot[at++] = slot;
        }
    }
    return true;
}

// Same rounding as the search, so that each pair is either in the lists or late.
static float squared_distance( const float* xyzw, int a, int b )
{
    const float *p = xyzw + 4 * (size_t)a, *q = xyzw + 4 * (size_t)b;
    float x = q[0] - p[0], y = q[1] - p[1], z = q[2] - p[2];
    return x * x + y * y + z * z;
}

static int compare_pairs( const void* a, const void* b )
{
    uint64_t x = *(const uint64_t*)a, y = *(const uint64_t*)b;
    return x < y ? -1 : x > y;
}

// Whether the lists lack a pair that is near now.
static bool is_late( const clump_run* run, float listed2, int a, int b )
{
    const int32_t* owner = run->w->grid.owner;
    const float near = near_radius( run );
    return squared_distance( run->searched, a, b ) >= listed2 &&
           squared_distance( run->current, a, b ) < near * near && owner[a] != owner[b];
}

// Shared data of the blocks that search late pairs.
typedef struct late_search
{
    const clump_run* run;
    const stray_queries* strays;
    uint64_t* pairs; // [2 entries of the strays' lists]
    _Atomic size_t count;
} late_search;

static void find_late_pairs( void* context, int begin, int end, int worker )
{
    (void)worker;
    late_search* s = context;
    const clump_run* run = s->run;
    const wisp_neighbours* lists = &run->w->stray_lists;
    const wisp_neighbour_list* found = &lists->all;
    const float listed2 = skin_radius( run ) * skin_radius( run );
    for ( int i = begin; i < end; ++i )
    {
        const int slice = i / WISP_SLICE, a = s->strays->slot[i];
        const int32_t* entry = found->entries + (size_t)found->begin[slice] * WISP_SLICE + i % WISP_SLICE;
        for ( int k = lists->near_count[i]; k < found->length[slice]; ++k )
        {
            int b = entry[k * WISP_SLICE] / 4;
            if ( is_late( run, listed2, a, b ) )
            {
                size_t at = atomic_fetch_add_explicit( &s->count, 2, memory_order_relaxed );
                s->pairs[at] = (uint64_t)a << 32 | (uint64_t)b;
                s->pairs[at + 1] = (uint64_t)b << 32 | (uint64_t)a;
            }
        }
    }
}

// Late pairs of the strays, each in both directions, in rising order. Two strays find each
// other twice, and padding repeats slots, so duplicates are removed.
// @param pairs [2 entries of the strays' lists]
static size_t collect_late_pairs( const clump_run* run, const stray_queries* strays, uint64_t* pairs )
{
    late_search s = { .run = run, .strays = strays, .pairs = pairs };
    wisp_parallel_for( run->parallel, strays->count, CLUMP_STRAYS, find_late_pairs, &s );
    const size_t count = atomic_load( &s.count );
    qsort( pairs, count, sizeof( *pairs ), compare_pairs );
    size_t kept = 0;
    for ( size_t i = 0; i < count; ++i )
    {
        if ( kept == 0 || pairs[kept - 1] != pairs[i] )
        {
            pairs[kept++] = pairs[i];
        }
    }
    return kept;
}

// Make the lists of one slice from its pairs. @return entries per lane
static int list_slice( const uint64_t* pairs, size_t count, int slice, int32_t* entries )
{
    int lengths[WISP_SLICE] = { 0 }, longest = 0;
    for ( size_t i = 0; i < count; ++i )
    {
        int lane = (int)( pairs[i] >> 32 ) % WISP_SLICE, k = lengths[lane]++;
        if ( k == longest )
        {
            for ( int l = 0; l < WISP_SLICE; ++l )
            {
                entries[k * WISP_SLICE + l] = 4 * ( slice * WISP_SLICE + l );
            }
            ++longest;
        }
        entries[k * WISP_SLICE + lane] = 4 * (int32_t)( pairs[i] & UINT32_MAX );
    }
    return longest;
}

static bool list_late_pairs( clump_run* run, const uint64_t* pairs, size_t count )
{
    const size_t slices = (size_t)run->slices, rows = count > slices ? count : slices;
    const size_t ints = 2 * slices + rows * WISP_SLICE;
    wisp_buffer* buffer = &run->w->late_lists;
    if ( wisp_buffer_reserve( buffer, wisp_parallel_allocator( run->parallel ), ints * sizeof( int32_t ) ) == false )
    {
        return false;
    }
    int32_t *begin = buffer->data, *length = begin + slices, *entries = length + slices;
    memset( begin, 0, 2 * slices * sizeof( int32_t ) );
    int32_t used = 0;
    for ( size_t i = 0, end; i < count; i = end )
    {
        int slice = (int)( pairs[i] >> 32 ) / WISP_SLICE;
        for ( end = i + 1; end < count && (int)( pairs[end] >> 32 ) / WISP_SLICE == slice; ++end )
        {
        }
        begin[slice] = used;
        length[slice] = list_slice( pairs + i, end - i, slice, entries + (size_t)used * WISP_SLICE );
        used += length[slice];
    }
    run->late = ( wisp_neighbour_list ){ begin, length, entries };
    return true;
}

// @param complete receives false if a list ran into the limit
static wisp_status search_strays( clump_run* run, int count, bool* complete )
{
    clump_workspace* w = run->w;
    stray_queries strays;
    if ( collect_strays( run, count, &strays ) == false )
    {
        return WISP_NO_MEMORY;
    }
    wisp_neighbour_query query = {
        .xyzw = strays.xyzw,
        .query_count = count,
        // the grid holds old places; pairs closer than this are in the lists
        .near_radius = fmaxf( skin_radius( run ) - 1.0001f * run->moved, 0.0f ),
        .skin_radius = near_radius( run ) + 1.0001f * run->moved,
        .limit = run->params->neighbour_limit,
        .rename = run->rename,
    };
    wisp_status status = wisp_neighbours_build( &w->stray_lists, run->parallel, run->kernels, run->grid, &query );
    *complete = w->stray_lists.capped == 0;
    if ( status != WISP_OK || *complete == false )
    {
        return status;
    }
    size_t most = 2 * w->stray_lists.entries * WISP_SLICE;
    most = most > (size_t)run->count ? most : (size_t)run->count;
    const wisp_allocator* allocator = wisp_parallel_allocator( run->parallel );
    if ( wisp_buffer_reserve( &w->late_pairs, allocator, most * sizeof( uint64_t ) ) == false )
    {
        return WISP_NO_MEMORY;
    }
    size_t late = collect_late_pairs( run, &strays, w->late_pairs.data );
    run->report->missed += late;
    return late == 0 || list_late_pairs( run, w->late_pairs.data, late ) ? WISP_OK : WISP_NO_MEMORY;
}

// Update the lists in use so that they have all pairs that are within the radius now.
// @return WISP_NO_MEMORY
static wisp_status clump_keep_up( clump_run* run )
{
    run->late = ( wisp_neighbour_list ){ NULL, NULL, NULL };
    int strays = run->moved > run->args.search_margin ? count_strays( run ) : 0;
    if ( strays == 0 )
    {
        return WISP_OK;
    }
    bool complete = false;
    wisp_status status = strays > run->count / MAX_CLUMP_STRAYS ? WISP_OK : search_strays( run, strays, &complete );
    return status == WISP_OK && complete == false ? search_again( run ) : status;
}

// ---- clumps ----

size_t frozen_clump_workspace_size( void )
{
    return sizeof( clump_workspace );
}

size_t frozen_clump_workspace_bytes( const void* workspace )
{
    const clump_workspace* w = workspace;
    const wisp_buffer buffers[] = { w->items, w->slots,  w->slices,     w->measured,
                                    w->most,  w->strays, w->late_pairs, w->late_lists };
    return wisp_grid_bytes( &w->grid ) + wisp_grid_bytes( &w->moved_grid ) + wisp_neighbours_bytes( &w->lists ) +
           wisp_neighbours_bytes( &w->moved_lists ) + wisp_neighbours_bytes( &w->stray_lists ) +
           wisp_buffer_bytes( buffers, WISP_COUNT( buffers ) );
}

void frozen_clump_workspace_release( void* workspace, const wisp_allocator* allocator )
{
    clump_workspace* w = workspace;
    wisp_grid_release( &w->grid, allocator );
    wisp_grid_release( &w->moved_grid, allocator );
    wisp_neighbours_release( &w->lists, allocator );
    wisp_neighbours_release( &w->moved_lists, allocator );
    wisp_neighbours_release( &w->stray_lists, allocator );
    wisp_buffer* const buffers[] = { &w->items, &w->slots,  &w->slices,     &w->measured,
                                     &w->most,  &w->strays, &w->late_pairs, &w->late_lists };
    for ( int i = 0; i < WISP_COUNT( buffers ); ++i )
    {
        wisp_buffer_release( buffers[i], allocator );
    }
}

// ---- pack and unpack ----

static float* lane_of( const clump_run* run, int32_t lane )
{
    return run->position + (size_t)( lane / WISP_LANES ) * 3 * WISP_LANES + (size_t)( lane % WISP_LANES );
}

static void pack_items( void* context, int begin, int end, int worker )
{
    (void)worker;
    const clump_run* run = context;
    const wisp_strand_topology* t = run->strands;
    for ( int i = begin * WISP_LANES; i < end * WISP_LANES; ++i )
    {
        const int strand = t->lane_strand[i], count = t->lane_count[i];
        if ( count == 0 )
        {
            continue;
        }
        const int32_t lane = t->group_row[i / WISP_LANES] * WISP_LANES + i % WISP_LANES;
        run->root_lane[strand] = lane;
        const float* p = lane_of( run, lane );
        float* q = run->item_quads + 4 * (size_t)t->offsets[strand];
        for ( int v = 0; v < count; ++v, p += 3 * WISP_LANES, q += 4 )
        {
            q[0] = p[0];
            q[1] = p[WISP_LANES];
            q[2] = p[2 * WISP_LANES];
            memcpy( q + 3, &strand, sizeof( strand ) );
        }
    }
}

static void unpack_slots( void* context, int begin, int end, int worker )
{
    (void)worker;
    const clump_run* run = context;
    const int32_t* owner = run->w->grid.owner;
    for ( int slot = begin; slot < end; ++slot )
    {
        const float* q = run->current + 4 * (size_t)slot;
        float* p = lane_of( run, run->root_lane[owner[slot]] + run->slot_vertex[slot] * WISP_LANES );
        p[0] = q[0];
        p[WISP_LANES] = q[1];
        p[2 * WISP_LANES] = q[2];
    }
}

// Lanes behind a strand's tip repeat the tip, as cooking left them.
static void repeat_tips( void* context, int begin, int end, int worker )
{
    (void)worker;
    const clump_run* run = context;
    const wisp_strand_topology* t = run->strands;
    for ( int i = begin * WISP_LANES; i < end * WISP_LANES; ++i )
    {
        int group = i / WISP_LANES, rows = t->group_row[group + 1] - t->group_row[group];
        for ( int v = t->lane_count[i]; v < rows && t->lane_count[i] > 0; ++v )
        {
            int32_t lane = ( t->group_row[group] + v ) * WISP_LANES + i % WISP_LANES;
            float *p = lane_of( run, lane ), *before = p - 3 * WISP_LANES;
            p[0] = before[0];
            p[WISP_LANES] = before[WISP_LANES];
            p[2 * WISP_LANES] = before[2 * WISP_LANES];
        }
    }
}

// ---- iterate ----

static void attract( void* context, int begin, int end, int worker )
{
    (void)worker;
    const clump_run* run = context;
    run->most[begin / CLUMP_SLICES] = run->kernels->adhesion_attract( &run->args, begin, end );
}

static void brake( void* context, int begin, int end, int worker )
{
    (void)worker;
    const clump_run* run = context;
    run->most[begin / CLUMP_SLICES] = run->kernels->adhesion_brake( &run->args, begin, end );
}

// Make `result` current. The former current buffer is free for the next sweep, unless the lists still refer to it.
static void advance( clump_run* run, float** result )
{
    float* before = run->current;
    run->current = *result;
    *result = before == run->searched ? run->spare : before;
}

static void iterate( clump_run* run, int iteration )
{
    wisp_adhesion_args* args = &run->args;
    args->current = run->current;
    args->tentative = run->tentative;
    args->next = run->next;
    args->search_position = run->searched;
    args->iteration = (uint32_t)iteration;
    wisp_parallel_for( run->parallel, run->slices, CLUMP_SLICES, attract, run );
    if ( run->params->brakes != 0 )
    {
        wisp_parallel_for( run->parallel, run->slices, CLUMP_SLICES, brake, run );
        advance( run, &run->next );
    }
    else
    {
        advance( run, &run->tentative );
    }
    float most = 0.0f;
    for ( int i = 0; i < ( run->slices + CLUMP_SLICES - 1 ) / CLUMP_SLICES; ++i )
    {
        most = run->most[i] > most ? run->most[i] : most;
    }
    run->moved = most;
}

static void make_args( clump_run* run, const frozen_settings* settings, const frozen_event* event, bool in_plane )
{
    const frozen_clump* c = run->params;
    run->args = ( wisp_adhesion_args ){
        .displacement = run->displacement,
        .owner = run->w->grid.owner,
        .vertex = run->slot_vertex,
        .reference = run->w->lists.near,
        .pairs = &run->measured,
        .search_margin = run->skin / 2.0001f, // two vertices may move towards each other; the rest is rounding
        .needs_search = run->needs_search,
        .key = wisp_random_make_key( settings->seed, FROZEN_STREAM_GAP, event->number ),
        .radius = c->radius,
        .step = c->step,
        .distance_min = c->distance_min,
        .lambda_min = c->lambda_min,
        .planar = run->strands->dimension == 2,
        .in_plane = in_plane,
        .brakes = c->brakes != 0,
    };
}

// Choose the lists of this iteration. Before any vertex moves the near lists suffice; afterwards the skin and the late pairs count
// too.
static void use_lists( clump_run* run, int iteration )
{
    wisp_adhesion_args* args = &run->args;
    const wisp_neighbour_list lists[2] = { run->moved == 0.0f ? run->lists->near : run->lists->all, run->late };
    memcpy( args->attracting, lists, sizeof( lists ) );
    args->attracting_count = run->late.length == NULL ? 1 : 2;
    args->stores_pairs = iteration == 0;
}

static void count_neighbours( clump_run* run )
{
    for ( int slice = 0; slice < run->slices; ++slice )
    {
        run->report->neighbours += (uint64_t)run->measured.near[slice];
    }
}

static wisp_status iterate_all( clump_run* run )
{
    wisp_status status = WISP_OK;
    for ( int k = 0; k < run->params->iterations && status == WISP_OK; ++k )
    {
        status = k == 0 ? WISP_OK : clump_keep_up( run );
        if ( status == WISP_OK )
        {
            use_lists( run, k );
            iterate( run, k );
        }
    }
    count_neighbours( run );
    return status;
}

// ---- memory ----

static bool reserve( clump_run* run )
{
    const wisp_allocator* allocator = wisp_parallel_allocator( run->parallel );
    clump_workspace* w = run->w;
    size_t items = (size_t)run->count + WISP_SLICE, slots = (size_t)run->slices * WISP_SLICE;
    size_t blocks = (size_t)( run->slices / CLUMP_SLICES + 1 );
    size_t slices = (size_t)run->slices;
    if ( wisp_buffer_reserve( &w->items, allocator, ( items * 4 + (size_t)run->strands->strand_count ) * 4 ) ==
             false ||
         wisp_buffer_reserve( &w->slots, allocator, slots * ( 4 * 4 + 3 + 1 + 1 ) * 4 ) == false ||
         wisp_buffer_reserve( &w->slices, allocator, slices * ( sizeof( int32_t ) + 1 ) + 7 ) == false ||
         wisp_buffer_reserve( &w->most, allocator, blocks * sizeof( float ) ) == false )
    {
        return false;
    }
    run->item_quads = w->items.data;
    run->root_lane = (int32_t*)( run->item_quads + 4 * items );
    run->current = w->slots.data;
    run->tentative = run->current + 4 * slots;
    run->next = run->tentative + 4 * slots;
    run->spare = run->next + 4 * slots;
    run->displacement = run->spare + 4 * slots;
    run->measured.weight_sum = run->displacement + 3 * slots;
    run->slot_vertex = (int32_t*)( run->measured.weight_sum + slots );
    run->measured.near = w->slices.data;
    run->needs_search = (uint8_t*)( run->measured.near + slices );
    run->most = w->most.data;

    memset( run->needs_search + slices, 0, 7 ); // counted eight at a time

    // the last slice's empty lanes are vertices that never move
    for ( size_t slot = (size_t)run->count; slot < slots; ++slot )
    {
        memset( run->current + 4 * slot, 0, 4 * sizeof( float ) );
        memset( run->item_quads + 4 * slot, 0, 4 * sizeof( float ) );
        run->slot_vertex[slot] = 0;
    }
    return true;
}

void frozen_clump_run( wisp_frame* frame, const wisp_span* span, void* user )
{
    const frozen_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    wisp_frozen_hair_stats* report = wisp_frame_column( frame, span->entity, state->report, 0 );
    clump_run run = {
        .parallel = wisp_frame_parallel( frame, span ),
        .kernels = wisp_frame_kernels( frame ),
        .strands = t,
        .params = wisp_frame_column( frame, span->entity, state->clump, 0 ),
        .w = wisp_frame_workspace( frame, state->workspace, span->worker ),
        .report = report,
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .count = t->vertex_count,
        .slices = ( t->vertex_count + WISP_SLICE - 1 ) / WISP_SLICE,
    };
    if ( run.count == 0 )
    {
        return;
    }
    if ( reserve( &run ) == false )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "frozen hair: out of memory to clump %d vertices", run.count );
        return;
    }
    wisp_parallel_for( run.parallel, t->group_count, CLUMP_GROUPS, pack_items, &run );
    wisp_status status = clump_search( &run );
    if ( status == WISP_OK )
    {
        report->coarse_grid = run.w->grid.is_widened;
        make_args( &run, wisp_frame_column( frame, span->entity, state->settings, 0 ),
                   wisp_frame_column( frame, span->entity, state->event, 0 ),
                   wisp_frame_has( frame, span->entity, state->depth ) );
        status = iterate_all( &run );
    }
    if ( status != WISP_OK )
    {
        wisp_frame_fail( frame, status, "frozen hair: out of memory for the neighbours of %d vertices within %g m",
                         run.count, (double)run.params->radius );
        return;
    }
    wisp_parallel_for( run.parallel, run.count, CLUMP_GRAIN, unpack_slots, &run );
    wisp_parallel_for( run.parallel, t->group_count, CLUMP_GROUPS, repeat_tips, &run );
    wisp_frame_count( frame, WISP_COUNT_NEIGHBOURS, report->neighbours );
    wisp_frame_count( frame, WISP_COUNT_CAPPED, report->capped );
    wisp_frame_count( frame, WISP_COUNT_COARSE_GRIDS, report->coarse_grid );
    wisp_frame_count( frame, WISP_COUNT_SEARCHES, report->searches );
}
