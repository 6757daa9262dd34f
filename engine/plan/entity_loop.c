// Substeps of small entities, entity by entity: all substeps of one, then of the next. Its rows then stay in the near
// caches for the whole step, and no worker waits for another between passes (bench case "scenes", crowds).
#include "plan.h"

#include "wisp/module/components.h"

#include <string.h>

// ---- compilation ----

enum
{
    // With fewer rows of sixteen lanes, waves take a single cloth as long as they save (cloths of 25 to 63 vertices a side).
    PLAN_LONE_ENTITY_ROWS = 96,
};

// A large entity runs on all workers. `should_run` and `on_change` are evaluated on the calling thread.
static bool can_loop( const plan* p, const wisp_registry* r, int slot )
{
    const plan_entity* e = p->entities + slot;
    bool possible = e->runs_waves && e->meets == false && plan_is_wide( r->store->entities + slot ) == false;
    for ( int n = 0; n < p->loop_node_count && possible; ++n )
    {
        const plan_node* node = p->nodes + p->loop_nodes[n];
        for ( int i = 0; i < node->pass_count; ++i )
        {
            const wisp_pass* pass = r->passes + node->passes[i];
            const bool is_live = store_mask_has( &e->runs, node->passes[i] );
            possible = possible && ( is_live == false || ( pass->should_run == NULL && pass->on_change == 0 ) );
        }
    }
    return possible;
}

// Nodes of substeps in the order in which they run.
static void list_nodes( plan* p )
{
    p->loop_node_count = 0;
    for ( int section = PLAN_SUBSTEP; section <= PLAN_AFTER_ITERATION; ++section )
    {
        for ( int wave = 0; wave < p->wave_count[section]; ++wave )
        {
            for ( int n = 0; n < p->node_count; ++n )
            {
                if ( (int)p->nodes[n].section == section && p->nodes[n].wave == wave )
                {
                    p->loop_nodes[p->loop_node_count++] = (uint8_t)n;
                }
            }
        }
    }
}

_Static_assert( PLAN_MAX_PASSES <= UINT8_MAX + 1, "loop_nodes hold numbers of nodes" );

void plan_find_entity_loops( plan* p, const wisp_registry* r )
{
    list_nodes( p );
    p->loop_count = 0;
    int last = -1;
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        p->entities[slot].loops = can_loop( p, r, slot );
        p->loop_count += p->entities[slot].loops ? 1 : 0;
        last = p->entities[slot].loops ? slot : last;
    }
    if ( p->loop_count == 1 && plan_row_count( r->store->entities + last ) >= PLAN_LONE_ENTITY_ROWS &&
         store_mask_has( &r->store->entities[last].components, WISP_SURFACE_LEVELS ) == false )
    {
        p->entities[last].loops = false; // it has all workers
        p->loop_count = 0;
    }
}

// Visit the passes of a substep of an entity that can run for a crowd, in their order.
// @param next 0 at first @return its number; -1: none is left
static int next_crowd_pass( const plan* p, const wisp_registry* r, int slot, int* next )
{
    while ( *next < p->loop_node_count * WISP_MAX_FUSED )
    {
        const plan_node* node = p->nodes + p->loop_nodes[*next / WISP_MAX_FUSED];
        const int i = ( *next )++ % WISP_MAX_FUSED;
        if ( i < node->pass_count && r->passes[node->passes[i]].run_crowd != NULL &&
             store_mask_has( &p->entities[slot].runs, node->passes[i] ) )
        {
            return node->passes[i];
        }
    }
    return -1;
}

// Find the batch that can run all that an entity runs in its loop, or else one that can run a pass of it.
// @return -1: there is none
static int find_batch( const plan* p, const wisp_registry* r, int slot, bool* has_others )
{
    store_mask live = { { 0 } };
    for ( int n = 0; n < p->loop_node_count; ++n )
    {
        const plan_node* node = p->nodes + p->loop_nodes[n];
        for ( int i = 0; i < node->pass_count; ++i )
        {
            if ( store_mask_has( &p->entities[slot].runs, node->passes[i] ) )
            {
                store_mask_add( &live, node->passes[i] );
            }
        }
    }
    store_mask beside = { { 0 } };
    for ( int next = 0, pass; ( pass = next_crowd_pass( p, r, slot, &next ) ) >= 0; )
    {
        store_mask_add( &beside, pass );
    }
    int found = -1;
    *has_others = true;
    for ( int i = 0; i < r->batch_count && wisp_registry_iterations( r ) == 1; ++i )
    {
        const plan_batch* b = r->batches + i;
        const bool runs_all =
            store_mask_holds( store_mask_or( store_mask_or( b->required, b->allowed ), beside ), live );
        const bool fits = store_mask_holds( live, b->required ) && ( runs_all || ( b->pass >= 0 && *has_others ) );
        found = fits ? i : found;
        *has_others = *has_others && ( fits && runs_all ) == false;
    }
    return found;
}

static void append_loop( plan* p, int slot )
{
    const int loop = p->loop_count++;
    p->loop_slots[loop] = slot;
    for ( int n = 0; n < p->loop_node_count; ++n )
    {
        p->loop_passes[loop * p->loop_node_count + n] = plan_live_passes( p, p->nodes + p->loop_nodes[n], slot );
    }
    p->entities[slot].listed = true;
}

// With less than a third of the lanes, entities side by side take longer than one by one.
static int fewest_lanes( int lanes )
{
    return ( lanes + 2 ) / 3;
}

// Number of lanes that are filled: every worker gets a group, unless so few lanes would be no gain.
static int lanes_for( int lanes, int entities, int workers )
{
    const int share = ( entities + workers - 1 ) / workers, fewest = fewest_lanes( lanes );
    return share > lanes ? lanes : share > fewest ? share : fewest;
}

// Append an entity, and others of its fabric that run the same passes.
static void append_group( plan* p, const wisp_registry* r, int slot, int entities )
{
    const store* s = r->store;
    bool has_others = false;
    const int batch = s->entities[slot].fabric != NULL ? find_batch( p, r, slot, &has_others ) : -1;
    const int lanes = batch >= 0 ? lanes_for( r->batches[batch].def.lanes, entities, r->workers ) : 1;
    plan_loop_group* group = p->loop_groups + p->loop_group_count++;
    *group = ( plan_loop_group ){ .first = p->loop_count, .batch = batch, .has_others = has_others };
    for ( int other = slot; other < s->entity_count && p->loop_count - group->first < lanes; ++other )
    {
        const plan_entity* e = p->entities + other;
        if ( e->loops && e->listed == false && s->entities[other].fabric == s->entities[slot].fabric &&
             plan_rate( e, r ) == plan_rate( p->entities + slot, r ) &&
             memcmp( &e->runs, &p->entities[slot].runs, sizeof( e->runs ) ) == 0 )
        {
            append_loop( p, other );
        }
    }
    // too few to run side by side run one by one, on any worker
    while ( batch >= 0 && p->loop_count - group->first > 1 &&
            p->loop_count - group->first < fewest_lanes( r->batches[batch].def.lanes ) )
    {
        p->entities[p->loop_slots[--p->loop_count]].listed = false;
    }
    group->count = p->loop_count - group->first;
}

void plan_fill_entity_loops( plan* p, const wisp_registry* r )
{
    const int entities = p->loop_count;
    p->loop_count = p->loop_group_count = 0;
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        p->entities[slot].listed = false;
    }
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        if ( p->entities[slot].loops && p->entities[slot].listed == false )
        {
            append_group( p, r, slot, entities );
        }
    }
}

// ---- execution ----

// An entity in its loop.
typedef struct loop_member
{
    const uint32_t* passes; // [loop node]
    wisp_entity entity;
    int slot;
} loop_member;

// A substep of some entities, pass by pass. One pass may run for all of them side by side.
typedef struct loop_substep
{
    wisp_frame* frame;
    loop_member members[WISP_MAX_BATCH];
    int count;
    const plan_batch* batch;            // null: all passes run entity by entity
    wisp_entity joined[WISP_MAX_BATCH]; // those that run its pass side by side
    int joined_members[WISP_MAX_BATCH];
    int joined_count;
    wisp_span span;
    double scale; // above 0: timed
} loop_substep;

static void add_member( loop_substep* loop, int index )
{
    const plan* p = loop->frame->plan;
    const int slot = p->loop_slots[index];
    loop->members[loop->count++] = ( loop_member ){ .passes = p->loop_passes + index * p->loop_node_count,
                                                    .entity = store_handle( loop->frame->registry->store, slot ),
                                                    .slot = slot };
}

// Runs as many items at once as a block of a wave has.
static void run_member( const loop_substep* loop, const loop_member* member, int n, wisp_span span )
{
    const plan* p = loop->frame->plan;
    const plan_node* node = p->nodes + p->loop_nodes[n];
    const store_entity* e = loop->frame->registry->store->entities + member->slot;
    const int items = member->passes[n] != 0 && execute_leaves_out( e, node->section ) == false
                          ? plan_item_count( e, node->domain )
                          : 0;
    span.entity = member->entity;
    for ( span.begin = 0; span.begin < items; span.begin = span.end )
    {
        span.end = items - span.begin > node->grain ? span.begin + node->grain : items;
        execute_item( loop->frame, node, member->passes[n], ( pass_range ){ 0, node->pass_count }, &span,
                      loop->scale );
    }
}

// @return bits of members that have run the pass of the batch
static uint32_t run_side_by_side( const loop_substep* loop, const wisp_span* span )
{
    const double begin = loop->scale > 0.0 ? wisp_clock_seconds() : 0.0;
    const uint32_t left =
        loop->batch->def.run_pass( loop->frame, loop->joined, loop->joined_count, span, loop->batch->def.user );
    if ( loop->scale > 0.0 )
    {
        loop->frame->clocks[span->worker].seconds[loop->batch->pass] +=
            ( wisp_clock_seconds() - begin ) * loop->scale;
    }
    uint32_t done = 0;
    for ( int i = 0; i < loop->joined_count; ++i )
    {
        done |= ( left >> i & 1 ) == 0 ? 1u << loop->joined_members[i] : 0;
    }
    return done;
}

static void run_node( void* context, int n, int worker )
{
    (void)worker;
    const loop_substep* loop = context;
    const wisp_span* span = &loop->span;
    const plan_node* node = loop->frame->plan->nodes + loop->frame->plan->loop_nodes[n];
    const bool is_batch = loop->joined_count > 0 && node->passes[0] == loop->batch->pass;
    const uint32_t done = is_batch ? run_side_by_side( loop, span ) : 0;
    for ( int i = 0; i < loop->count; ++i )
    {
        if ( ( done >> i & 1 ) == 0 )
        {
            run_member( loop, loop->members + i, n, *span );
        }
    }
}

// Run the nodes of a section, each of which releases its scratch memory. @return the node behind them
static int run_entity_section( loop_substep* loop, int first, plan_section section, int iteration )
{
    const plan* p = loop->frame->plan;
    loop->span.iteration = iteration;
    int n = first;
    for ( ; n < p->loop_node_count && p->nodes[p->loop_nodes[n]].section == section; ++n )
    {
        jobs_run_within( loop->frame->pool, n, run_node, loop, loop->span.worker );
    }
    return n;
}

static void run_substep( loop_substep* loop, int substep, int worker )
{
    loop->span.substep = substep;
    loop->span.worker = worker;
    const int first = run_entity_section( loop, 0, PLAN_SUBSTEP, 0 );
    int behind = first;
    for ( int iteration = 0; iteration < loop->frame->iterations; ++iteration )
    {
        behind = run_entity_section( loop, first, PLAN_ITERATION, iteration );
    }
    run_entity_section( loop, behind, PLAN_AFTER_ITERATION, loop->frame->iterations - 1 );
}

// @param index of what is timed in turns
static void run_entity_substeps( loop_substep* loop, int index, int worker )
{
    wisp_frame* frame = loop->frame;
    const int substeps = wisp_frame_substeps( frame, loop->members[0].entity );
    const int timed = execute_timed_substep( frame, index, substeps );
    for ( int substep = 0; substep < substeps; ++substep )
    {
        loop->scale = substep == timed ? substeps * frame->clocked_blocks : 0.0;
        run_substep( loop, substep, worker );
    }
}

// @param index of the entity
static void run_alone( wisp_frame* frame, int index, int worker )
{
    loop_substep loop = { .frame = frame };
    add_member( &loop, index );
    run_entity_substeps( &loop, index, worker );
}

static bool joins_crowd( wisp_frame* frame, const loop_member* member )
{
    const wisp_registry* r = frame->registry;
    for ( int next = 0, pass; ( pass = next_crowd_pass( frame->plan, r, member->slot, &next ) ) >= 0; )
    {
        const wisp_pass* p = r->passes + pass;
        if ( p->joins_crowd != NULL && p->joins_crowd( frame, member->entity, p->user ) == false )
        {
            return false;
        }
    }
    return true;
}

// Find the members that run side by side: in all passes, or in the one of the batch.
static void choose_joined( loop_substep* loop, const plan_batch* batch, bool in_all )
{
    const store* s = loop->frame->registry->store;
    loop->batch = batch;
    loop->joined_count = 0;
    for ( int i = 0; i < loop->count; ++i )
    {
        const wisp_entity entity = loop->members[i].entity, first = loop->joined_count > 0 ? loop->joined[0] : entity;
        if ( execute_leaves_out( s->entities + loop->members[i].slot, PLAN_SUBSTEP ) == false &&
             batch->def.can_join( loop->frame, first, entity, batch->def.user ) &&
             ( in_all == false || joins_crowd( loop->frame, loop->members + i ) ) )
        {
            loop->joined[loop->joined_count] = entity;
            loop->joined_members[loop->joined_count++] = i;
        }
    }
    loop->joined_count = loop->joined_count < fewest_lanes( batch->def.lanes ) ? 0 : loop->joined_count;
}

// Run all substeps of the members that are joined. @return bits of members that have run
static uint32_t run_batch( const loop_substep* loop, int worker )
{
    const plan_batch* batch = loop->batch;
    double seconds[2 * WISP_MAX_FUSED] = { 0 };
    uint32_t done = 0, left = 0;
    if ( loop->joined_count > 0 )
    {
        left = batch->def.run( loop->frame, loop->joined, loop->joined_count, worker, seconds, batch->def.user );
    }
    for ( int i = 0; i < loop->joined_count; ++i )
    {
        done |= ( left >> i & 1 ) == 0 ? 1u << loop->joined_members[i] : 0;
    }
    for ( int i = 0; i < batch->pass_count; ++i )
    {
        loop->frame->clocks[worker].seconds[batch->passes[i]] += seconds[i];
    }
    return done;
}

// A pass of a crowd in a substep.
typedef struct crowd_pass
{
    wisp_frame* frame;
    const wisp_crowd* crowd;
    const wisp_span* span;
} crowd_pass;

static void run_crowd_pass( void* context, int number, int worker )
{
    const crowd_pass* c = context;
    const double begin = wisp_clock_seconds();
    const wisp_pass* pass = c->frame->registry->passes + number;
    pass->run_crowd( c->frame, c->crowd, c->span, pass->user );
    c->frame->clocks[worker].seconds[number] += wisp_clock_seconds() - begin;
}

bool wisp_frame_run_crowd( wisp_frame* frame, wisp_stage stage, const wisp_crowd* crowd, const wisp_span* span )
{
    bool has_some = false;
    const wisp_registry* r = frame->registry;
    crowd_pass context = { frame, crowd, span };
    const int slot = (int)crowd->entities[0].index - 1;
    for ( int next = 0, pass; ( pass = next_crowd_pass( frame->plan, r, slot, &next ) ) >= 0; )
    {
        const bool is_of_stage = r->passes[pass].stage == stage;
        has_some = has_some || is_of_stage;
        if ( is_of_stage && span != NULL )
        {
            jobs_run_within( frame->pool, pass, run_crowd_pass, &context, span->worker );
        }
    }
    return has_some;
}

static void run_group( void* context, int index, int worker )
{
    wisp_frame* frame = context;
    const plan_loop_group* group = frame->plan->loop_groups + index;
    loop_substep loop = { .frame = frame };
    for ( int i = 0; i < group->count; ++i )
    {
        add_member( &loop, group->first + i );
    }
    bool in_all = group->has_others == false;
    if ( group->count > 1 )
    {
        choose_joined( &loop, frame->registry->batches + group->batch, in_all );
    }
    if ( in_all && group->count > 1 && loop.joined_count == 0 && loop.batch->pass >= 0 )
    {
        choose_joined( &loop, loop.batch, false );
        in_all = false;
    }
    if ( loop.joined_count > 0 && in_all == false )
    {
        run_entity_substeps( &loop, index, worker );
        return;
    }
    const uint32_t done = loop.joined_count > 0 ? run_batch( &loop, worker ) : 0;
    for ( int i = 0; i < group->count; ++i )
    {
        if ( ( done >> i & 1 ) == 0 )
        {
            run_alone( frame, group->first + i, worker );
        }
    }
}

// Count the items of an entity, and have what watches its rows run. @return rows of sixteen lanes of all of its substeps
static int64_t begin_entity( wisp_frame* frame, int index )
{
    const plan* p = frame->plan;
    const int slot = p->loop_slots[index], substeps = execute_substeps( frame, slot );
    const store_entity* e = frame->registry->store->entities + slot;
    for ( int n = 0; n < p->loop_node_count && execute_leaves_out( e, PLAN_SUBSTEP ) == false; ++n )
    {
        const plan_node* node = p->nodes + p->loop_nodes[n];
        const int64_t items = (int64_t)plan_item_count( e, node->domain ) * substeps *
                              ( node->section == PLAN_ITERATION ? frame->iterations : 1 );
        for ( int i = 0; i < node->pass_count; ++i )
        {
            if ( ( p->loop_passes[index * p->loop_node_count + n] >> i & 1 ) != 0 )
            {
                execute_is_due( frame, node->passes[i], slot );
                frame->pass_items[node->passes[i]] += items;
            }
        }
    }
    return (int64_t)plan_row_count( e ) * substeps;
}

void execute_entity_loops( wisp_frame* frame )
{
    int64_t rows = 0;
    for ( int i = 0; i < frame->plan->loop_count; ++i )
    {
        rows += begin_entity( frame, i );
    }
    if ( frame->plan->loop_count > 0 )
    {
        frame->sampled = true;
        execute_timed( frame, frame->plan->loop_group_count, rows, 1, run_group );
    }
}
