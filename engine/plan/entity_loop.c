// Substeps of small entities, entity by entity: all substeps of one, then of the next. Its rows then stay in the near
// caches for the whole step, and no worker waits for another between passes (bench case "scenes", crowds).
#include "execute_parts.h"

// ---- compilation ----

// What passes of other entities touch in the substep loop.
static store_mask columns_across( const plan* p, const wisp_registry* r )
{
    store_mask across = { { 0 } };
    for ( int n = 0; n < p->loop_node_count; ++n )
    {
        const plan_node* node = p->nodes + p->loop_nodes[n];
        for ( int i = 0; i < node->pass_count; ++i )
        {
            across = store_mask_or( across, plan_mask( r->passes[node->passes[i]].foreign ) );
        }
    }
    return across;
}

// A large entity runs on all workers. `should_run` and `on_change` are evaluated on the calling thread.
static bool can_loop( const plan* p, const wisp_registry* r, int slot, store_mask across )
{
    bool has_passes = false, possible = plan_row_count( r->store->entities + slot ) < PLAN_WIDE_ENTITY_ROWS;
    for ( int n = 0; n < p->loop_node_count && possible; ++n )
    {
        const plan_node* node = p->nodes + p->loop_nodes[n];
        for ( int i = 0; i < node->pass_count; ++i )
        {
            const wisp_pass* pass = r->passes + node->passes[i];
            if ( store_mask_has( &p->entities[slot].live, node->passes[i] ) )
            {
                has_passes = true;
                const store_mask touched = store_mask_or( plan_mask( pass->reads ), plan_mask( pass->writes ) );
                possible = possible && pass->should_run == NULL && pass->on_change == 0 && pass->foreign[0] == 0 &&
                           store_mask_meets( touched, across ) == false;
            }
        }
    }
    return has_passes && possible;
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
                    p->loop_nodes[p->loop_node_count++] = n;
                }
            }
        }
    }
}

void plan_find_entity_loops( plan* p, const wisp_registry* r )
{
    list_nodes( p );
    const store_mask across = columns_across( p, r );
    p->loop_count = 0;
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        p->entities[slot].loops = can_loop( p, r, slot, across );
        p->loop_count += p->entities[slot].loops ? 1 : 0;
    }
    if ( p->loop_count < 2 ) // a single one has all workers
    {
        for ( int slot = 0; slot < r->store->entity_count; ++slot )
        {
            p->entities[slot].loops = false;
        }
        p->loop_count = 0;
    }
}

void plan_fill_entity_loops( plan* p, const store* s )
{
    int loop = 0;
    for ( int slot = 0; slot < s->entity_count; ++slot )
    {
        for ( int n = 0; n < p->loop_node_count && p->entities[slot].loops; ++n )
        {
            const plan_node* node = p->nodes + p->loop_nodes[n];
            p->loop_passes[loop * p->loop_node_count + n] = plan_live_passes( p, node, slot );
        }
        if ( p->entities[slot].loops )
        {
            p->loop_slots[loop++] = slot;
        }
    }
}

// ---- execution ----

// A substep of an entity.
typedef struct loop_substep
{
    wisp_frame* frame;
    const uint32_t* passes; // [loop node]
    int slot;
    wisp_span span;
    double scale; // above 0: timed
} loop_substep;

// Runs as many items at once as a block of a wave has.
static void run_node( const loop_substep* loop, int n, wisp_span span )
{
    const plan* p = loop->frame->plan;
    const plan_node* node = p->nodes + p->loop_nodes[n];
    const store_entity* e = loop->frame->registry->store->entities + loop->slot;
    const int items = loop->passes[n] != 0 && e->halted == 0 ? plan_item_count( e, node->domain ) : 0;
    for ( span.begin = 0; span.begin < items; span.begin = span.end )
    {
        span.end = items - span.begin > node->grain ? span.begin + node->grain : items;
        execute_item( loop->frame, node, loop->passes[n], ( pass_range ){ 0, node->pass_count }, &span, loop->scale );
    }
}

// Run the nodes of a section. @return the node behind them
static int run_section( const loop_substep* loop, int first, plan_section section, int iteration )
{
    const plan* p = loop->frame->plan;
    wisp_span span = loop->span;
    span.iteration = iteration;
    int n = first;
    for ( ; n < p->loop_node_count && p->nodes[p->loop_nodes[n]].section == section; ++n )
    {
        run_node( loop, n, span );
    }
    return n;
}

static void run_substep( void* context, int substep, int worker )
{
    loop_substep* loop = context;
    loop->span.substep = substep;
    loop->span.worker = worker;
    const int first = run_section( loop, 0, PLAN_SUBSTEP, 0 );
    int behind = first;
    for ( int iteration = 0; iteration < loop->frame->iterations; ++iteration )
    {
        behind = run_section( loop, first, PLAN_ITERATION, iteration );
    }
    run_section( loop, behind, PLAN_AFTER_ITERATION, loop->frame->iterations - 1 );
}

static void run_entity( void* context, int index, int worker )
{
    wisp_frame* frame = context;
    const plan* p = frame->plan;
    const int slot = p->loop_slots[index], timed = execute_timed_substep( frame, index );
    loop_substep loop = { .frame = frame,
                          .passes = p->loop_passes + index * p->loop_node_count,
                          .slot = slot,
                          .span = { .entity = store_handle( frame->registry->store, slot ) } };
    for ( int substep = 0; substep < frame->substeps; ++substep )
    {
        loop.scale = substep == timed ? frame->substeps : 0.0;
        jobs_run_within( frame->pool, substep, run_substep, &loop, worker );
    }
}

// Count the items of an entity, and have what watches its rows run. @return its size in rows of sixteen lanes
static int begin_entity( wisp_frame* frame, int index )
{
    const plan* p = frame->plan;
    const store_entity* e = frame->registry->store->entities + p->loop_slots[index];
    for ( int n = 0; n < p->loop_node_count && e->halted == 0; ++n )
    {
        const plan_node* node = p->nodes + p->loop_nodes[n];
        const int items = plan_item_count( e, node->domain ) * frame->substeps *
                          ( node->section == PLAN_ITERATION ? frame->iterations : 1 );
        for ( int i = 0; i < node->pass_count; ++i )
        {
            if ( ( p->loop_passes[index * p->loop_node_count + n] >> i & 1 ) != 0 )
            {
                execute_is_due( frame, node->passes[i], p->loop_slots[index] );
                frame->pass_items[node->passes[i]] += items;
            }
        }
    }
    return plan_row_count( e );
}

void execute_entity_loops( wisp_frame* frame )
{
    int rows = 0;
    for ( int i = 0; i < frame->plan->loop_count; ++i )
    {
        rows += begin_entity( frame, i ) * frame->substeps;
    }
    if ( frame->plan->loop_count > 0 )
    {
        frame->sampled = true;
        execute_timed( frame, frame->plan->loop_count, rows, run_entity );
    }
}
