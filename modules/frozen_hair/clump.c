// The third stage: neighbours attract, gaps stay (eq. 14-19). Runs on one strand set with all workers, or with others
// beside it on one worker each.
//
//   pack      lanes -> items in the user's order
//   sort      items -> slots by cell, so that neighbours lie side by side
//   search    lists of all vertices of other strands within h, and within a skin around it; r0 of the former
//   iterate   attract: tentative positions; brake: lambda from r0 and r1 = distance of the tentative positions
//   unpack    slots -> lanes
//
// The lists outlive an iteration as long as no vertex has moved further than half the skin: pairs beyond h add exact
// zeros to the sums. When the skin is used up, the vertices are searched again where they are now; the brake keeps the
// first list, whose pairs are those of the reference shape.
#include "frozen_hair_state.h"

#include "wisp/space.h"

#include <stdatomic.h>
#include <string.h>

enum
{
    CLUMP_GRAIN = 4096, // slots a block of a copying loop
    CLUMP_SLICES = 32,  // slices a block of a summing loop
    CLUMP_GROUPS = 8,   // groups of strands a block
};

// The lists reach this share of h further at most. Wider ones cost every iteration, narrower ones are used up and searched
// again (bench case "paper").
static const float CLUMP_SKIN_MOST = 0.6f;

typedef struct clump_workspace
{
    wisp_grid grid, moved_grid;
    wisp_neighbours lists, moved_lists;
    wisp_buffer items;    // quads in the user's order, and their vertex numbers and lanes
    wisp_buffer slots;    // everything by slot
    wisp_buffer distance; // r0 an entry
    wisp_buffer most;     // largest displacement a block
} clump_workspace;

size_t frozen_clump_workspace_size( void )
{
    return sizeof( clump_workspace );
}

void frozen_clump_workspace_release( void* workspace, const wisp_allocator* allocator )
{
    clump_workspace* w = workspace;
    wisp_grid_release( &w->grid, allocator );
    wisp_grid_release( &w->moved_grid, allocator );
    wisp_neighbours_release( &w->lists, allocator );
    wisp_neighbours_release( &w->moved_lists, allocator );
    wisp_buffer_release( &w->items, allocator );
    wisp_buffer_release( &w->slots, allocator );
    wisp_buffer_release( &w->distance, allocator );
    wisp_buffer_release( &w->most, allocator );
}

// One run of the stage.
typedef struct clump_run
{
    const wisp_parallel* parallel;
    const wisp_kernels* kernels;
    const wisp_strand_topology* strands;
    const frozen_clump* params;
    clump_workspace* w;
    float* position; // [row][3][16]
    int count, slices;
    float skin;                                // m
    float* item_quads;                         // [item][4]
    int32_t *item_vertex, *item_lane;          // [item] index in the strand; row * 16 + lane
    int32_t *slot_vertex, *slot_lane;          // [slot]
    float *current, *tentative, *next, *spare; // [slot][4]
    const float* searched;                     // [slot][4] where the lists were made
    wisp_adhesion_job job;
    float* most; // [block]
    _Atomic uint64_t neighbours;
} clump_run;

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
        int strand = t->lane_strand[i], count = t->lane_count[i];
        int32_t lane = t->group_row[i / WISP_LANES] * WISP_LANES + i % WISP_LANES;
        for ( int v = 0; v < count; ++v, lane += WISP_LANES )
        {
            int item = t->offsets[strand] + v;
            const float* p = lane_of( run, lane );
            float* q = run->item_quads + 4 * (size_t)item;
            q[0] = p[0];
            q[1] = p[WISP_LANES];
            q[2] = p[2 * WISP_LANES];
            memcpy( q + 3, &strand, sizeof( strand ) );
            run->item_vertex[item] = v;
            run->item_lane[item] = lane;
        }
    }
}

static void fill_slots( void* context, int begin, int end, int worker )
{
    (void)worker;
    const clump_run* run = context;
    const int32_t* item = run->w->grid.item;
    for ( int slot = begin; slot < end; ++slot )
    {
        memcpy( run->current + 4 * (size_t)slot, run->item_quads + 4 * (size_t)item[slot], 4 * sizeof( float ) );
        run->slot_vertex[slot] = run->item_vertex[item[slot]];
        run->slot_lane[slot] = run->item_lane[item[slot]];
    }
}

static void unpack_slots( void* context, int begin, int end, int worker )
{
    (void)worker;
    const clump_run* run = context;
    for ( int slot = begin; slot < end; ++slot )
    {
        const float* q = run->current + 4 * (size_t)slot;
        float* p = lane_of( run, run->slot_lane[slot] );
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

// ---- search ----

static void copy_moved( void* context, int begin, int end, int worker )
{
    (void)worker;
    const clump_run* run = context;
    for ( int slot = begin; slot < end; ++slot )
    {
        float* q = run->item_quads + 4 * (size_t)slot;
        memcpy( q, run->current + 4 * (size_t)slot, 3 * sizeof( float ) );
        memcpy( q + 3, run->w->grid.owner + slot, sizeof( int32_t ) );
    }
}

static void measure( void* context, int begin, int end, int worker )
{
    (void)worker;
    clump_run* run = context;
    int64_t count = run->kernels->pair_distance( run->current, &run->w->lists.near, run->params->radius,
                                                 run->w->distance.data, begin, end );
    atomic_fetch_add_explicit( &run->neighbours, (uint64_t)count, memory_order_relaxed );
}

// A step of sigma is what a vertex moves in an iteration, about; two may move towards each other. The last iteration's
// moves need no list.
static float choose_skin( const frozen_clump* c )
{
    float skin = 2.0f * c->step * (float)( c->iterations - 1 );
    return skin < CLUMP_SKIN_MOST * c->radius ? skin : CLUMP_SKIN_MOST * c->radius;
}

// Near is what rounding may put on the border of h.
static float near_radius( const clump_run* run )
{
    return run->params->radius * 1.0001f;
}

static wisp_neighbour_query make_query( const clump_run* run, const float* quads, const int32_t* rename )
{
    return ( wisp_neighbour_query ){
        .quads = quads,
        .query_count = run->count,
        .near_radius = near_radius( run ),
        .shell_radius = near_radius( run ) + run->skin,
        .limit = run->params->neighbour_limit,
        .rename = rename,
    };
}

static wisp_status search( clump_run* run )
{
    clump_workspace* w = run->w;
    wisp_status status =
        wisp_grid_build( &w->grid, run->parallel, run->item_quads, run->count, near_radius( run ) + run->skin );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_parallel_for( run->parallel, run->count, CLUMP_GRAIN, fill_slots, run );
    wisp_neighbour_query query = make_query( run, run->current, NULL );
    status = wisp_neighbours_build( &w->lists, run->parallel, run->kernels, &w->grid, &query );
    size_t bytes = w->lists.near_entries * WISP_SLICE * sizeof( float );
    if ( status != WISP_OK ||
         wisp_buffer_reserve( &w->distance, wisp_parallel_allocator( run->parallel ), bytes ) == false )
    {
        return WISP_NO_MEMORY;
    }
    wisp_parallel_for( run->parallel, run->slices, CLUMP_SLICES, measure, run );
    return WISP_OK;
}

static wisp_status search_again( clump_run* run )
{
    clump_workspace* w = run->w;
    wisp_parallel_for( run->parallel, run->count, CLUMP_GRAIN, copy_moved, run );
    wisp_status status =
        wisp_grid_build( &w->moved_grid, run->parallel, run->item_quads, run->count, near_radius( run ) + run->skin );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_neighbour_query query = make_query( run, run->item_quads, w->moved_grid.item );
    return wisp_neighbours_build( &w->moved_lists, run->parallel, run->kernels, &w->moved_grid, &query );
}

// ---- iterate ----

static void attract( void* context, int begin, int end, int worker )
{
    (void)worker;
    const clump_run* run = context;
    run->most[begin / CLUMP_SLICES] = run->kernels->adhesion_attract( &run->job, begin, end );
}

static void brake( void* context, int begin, int end, int worker )
{
    (void)worker;
    const clump_run* run = context;
    run->most[begin / CLUMP_SLICES] = run->kernels->adhesion_brake( &run->job, begin, end );
}

// The sweep that wrote `result` has made it the current one. What was current is free for the next, unless the lists
// still need to know where they were made.
static void advance( clump_run* run, float** result )
{
    float* before = run->current;
    run->current = *result;
    *result = before == run->searched ? run->spare : before;
}

// One iteration. @return how far a vertex is at most from where it was searched, m
static float iterate( clump_run* run, int iteration )
{
    wisp_adhesion_job* job = &run->job;
    job->current = run->current;
    job->tentative = run->tentative;
    job->next = run->next;
    job->searched = run->searched;
    job->iteration = (uint32_t)iteration;
    wisp_parallel_for( run->parallel, run->slices, CLUMP_SLICES, attract, run );
    if ( run->params->gap == WISP_GAP_WET )
    {
        advance( run, &run->tentative );
    }
    else
    {
        wisp_parallel_for( run->parallel, run->slices, CLUMP_SLICES, brake, run );
        advance( run, &run->next );
    }
    float most = 0.0f;
    for ( int i = 0; i < ( run->slices + CLUMP_SLICES - 1 ) / CLUMP_SLICES; ++i )
    {
        most = run->most[i] > most ? run->most[i] : most;
    }
    return most;
}

static void make_job( clump_run* run, const frozen_settings* settings, const frozen_event* event )
{
    const clump_workspace* w = run->w;
    const frozen_clump* c = run->params;
    float* displacement = run->spare + 4 * (size_t)run->slices * WISP_SLICE;
    run->job = ( wisp_adhesion_job ){
        .displacement = displacement,
        .owner = w->grid.owner,
        .vertex = run->slot_vertex,
        .reference = { w->lists.near },
        .reference_count = 1,
        .reference_distance = c->gap_by_iteration ? NULL : w->distance.data,
        .key = wisp_random_make_key( settings->seed, FROZEN_STREAM_GAP, event->number ),
        .radius = c->radius,
        .step = c->step,
        .epsilon = settings->epsilon,
        .distance_min = c->distance_min,
        .lambda_min = c->lambda_min,
        .guard = c->guard != 0,
        .planar = run->strands->dimension == 2,
        .gap = c->gap,
    };
}

// Where vertices are as they were searched, the near list has them all; once they have moved, the shell counts too.
// r0 by iteration is measured over the neighbours of the moment, so that the brake follows.
static void use_lists( clump_run* run, const wisp_neighbours* lists, bool fresh )
{
    wisp_adhesion_job* job = &run->job;
    job->attracting[0] = lists->near;
    job->attracting[1] = lists->shell;
    job->attracting_count = fresh ? 1 : 2;
    if ( run->params->gap_by_iteration )
    {
        job->reference[0] = lists->near;
        job->reference[1] = lists->shell;
        job->reference_count = job->attracting_count;
    }
}

static wisp_status iterate_all( clump_run* run, wisp_frozen_hair_report* report )
{
    const wisp_neighbours* lists = &run->w->lists;
    float moved = 0.0f; // of any vertex since the lists were made
    for ( int k = 0; k < run->params->iterations; ++k )
    {
        // two vertices may have moved towards each other, and rounding is on nobody's side
        if ( 2.0001f * moved > run->skin )
        {
            wisp_status status = search_again( run );
            if ( status != WISP_OK )
            {
                return status;
            }
            lists = &run->w->moved_lists;
            report->searches += 1;
            report->capped += lists->capped;
            run->searched = run->item_quads;
            moved = 0.0f;
        }
        use_lists( run, lists, moved == 0.0f );
        moved = iterate( run, k );
    }
    return WISP_OK;
}

// ---- memory ----

static bool reserve( clump_run* run )
{
    const wisp_allocator* allocator = wisp_parallel_allocator( run->parallel );
    clump_workspace* w = run->w;
    size_t items = (size_t)run->count + WISP_SLICE, slots = (size_t)run->slices * WISP_SLICE;
    size_t blocks = (size_t)( run->slices / CLUMP_SLICES + 1 );
    if ( wisp_buffer_reserve( &w->items, allocator, items * 6 * 4 ) == false ||
         wisp_buffer_reserve( &w->slots, allocator, slots * ( 4 * 4 + 3 + 2 ) * 4 ) == false ||
         wisp_buffer_reserve( &w->most, allocator, blocks * sizeof( float ) ) == false )
    {
        return false;
    }
    run->item_quads = w->items.data;
    run->item_vertex = (int32_t*)( run->item_quads + 4 * items );
    run->item_lane = run->item_vertex + items;
    run->current = w->slots.data;
    run->tentative = run->current + 4 * slots;
    run->next = run->tentative + 4 * slots;
    run->spare = run->next + 4 * slots;
    run->slot_vertex = (int32_t*)( run->spare + ( 4 + 3 ) * slots );
    run->searched = run->current;
    run->slot_lane = run->slot_vertex + slots;
    run->most = w->most.data;

    // the last slice's empty lanes are vertices that never move
    for ( size_t slot = (size_t)run->count; slot < slots; ++slot )
    {
        memset( run->current + 4 * slot, 0, 4 * sizeof( float ) );
        memset( run->item_quads + 4 * slot, 0, 4 * sizeof( float ) );
        run->slot_vertex[slot] = 0;
        run->slot_lane[slot] = 0;
    }
    return true;
}

void frozen_clump_run( wisp_frame* frame, const wisp_span* span, void* user )
{
    const frozen_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    wisp_frozen_hair_report* report = wisp_frame_column( frame, span->entity, state->report, 0 );
    clump_run run = {
        .parallel = wisp_frame_parallel( frame, span ),
        .kernels = wisp_frame_kernels( frame ),
        .strands = t,
        .params = wisp_frame_column( frame, span->entity, state->clump, 0 ),
        .w = wisp_frame_workspace( frame, state->workspace, span->worker ),
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .count = t->vertex_count,
        .slices = ( t->vertex_count + WISP_SLICE - 1 ) / WISP_SLICE,
    };
    run.skin = choose_skin( run.params );
    if ( run.count == 0 )
    {
        return;
    }
    if ( reserve( &run ) == false )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "frozen hair: no memory to clump %d vertices", run.count );
        return;
    }
    wisp_parallel_for( run.parallel, t->group_count, CLUMP_GROUPS, pack_items, &run );
    wisp_status status = search( &run );
    if ( status == WISP_OK )
    {
        report->searches = 1;
        report->neighbours = atomic_load( &run.neighbours );
        report->capped = run.w->lists.capped;
        report->coarse_grid = run.w->grid.coarse;
        make_job( &run, wisp_frame_column( frame, span->entity, state->settings, 0 ),
                  wisp_frame_column( frame, span->entity, state->event, 0 ) );
        status = iterate_all( &run, report );
    }
    if ( status != WISP_OK )
    {
        wisp_frame_fail( frame, status, "frozen hair: no memory for the neighbours of %d vertices within %g m",
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
