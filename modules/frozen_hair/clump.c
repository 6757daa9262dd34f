// The third stage: neighbours attract, gaps stay (Kim 2026, eq. 14-19). One groom runs on all workers, several grooms on one worker
// each.
//
//   pack      lanes -> items in the user's order
//   search    items -> slots by cell, so that neighbours lie side by side; lists of all vertices of other strands within
//             h, and within a skin around it
//   iterate   attract: tentative positions, at first also r0; brake: lambda from r0 and r1 = distance of the tentative
//             positions; keep up: list all pairs that are near now (clump_search.c)
//   unpack    slots -> lanes
//
// Pairs beyond h add exact zeros to the sums. When the vertices are searched again, the brake keeps the first list, whose
// pairs are those of the reference shape.
#include "clump.h"

#include <string.h>

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
