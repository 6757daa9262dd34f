// Execution of a compiled plan, section by section and wave by wave. The blocks of a wave come from all of its
// nodes and entities, so that two small entities use two cores. The partition into blocks never depends on the
// workers.

#include "plan.h"

#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

// ---- substeps ----

// Substeps of entities. An entity may ask for more substeps than the world makes: it splits each of those into as many
// as it needs. Its detail may allow it fewer: then it makes fewer and longer ones in the same time. Entities that meet in substeps
// have the substeps of the one with the most.

// Return what passes of other entities touch of an entity in the substep loop.
static store_mask columns_across( const plan* p, const wisp_registry* r, int slot )
{
    const store_mask components = r->store->entities[slot].components;
    store_mask across = { { 0 } };
    for ( int n = 0; n < p->node_count; ++n )
    {
        const plan_node* node = p->nodes + n;
        for ( int i = 0; i < node->pass_count && plan_is_substep( node->section ); ++i )
        {
            const wisp_pass* pass = r->passes + node->passes[i];
            const bool reaches = pass->among == 0 || store_mask_has( &components, pass->among );
            across = reaches ? store_mask_or( across, r->uses[node->passes[i]].foreign ) : across;
        }
    }
    return across;
}

// Does a pass follow entities that it does not list? Which ones only the module knows, so all meet.
static bool has_followers( const plan* p, const wisp_registry* r )
{
    bool found = false;
    for ( int n = 0; n < p->node_count; ++n )
    {
        const plan_node* node = p->nodes + n;
        for ( int i = 0; i < node->pass_count && plan_is_substep( node->section ); ++i )
        {
            found = found || r->passes[node->passes[i]].follows;
        }
    }
    return found;
}

// Find whether an entity runs substeps in waves, and whether others touch what it has there, or it touches theirs.
static void find_meetings( plan* p, const wisp_registry* r, int slot, bool all_meet )
{
    plan_entity* e = p->entities + slot;
    const store_mask across = columns_across( p, r, slot );
    e->runs_waves = e->meets = false;
    for ( int n = 0; n < p->node_count; ++n )
    {
        const plan_node* node = p->nodes + n;
        for ( int i = 0; i < node->pass_count && plan_is_substep( node->section ); ++i )
        {
            if ( store_mask_has( &e->runs, node->passes[i] ) )
            {
                const plan_uses* uses = r->uses + node->passes[i];
                e->runs_waves = true;
                e->meets = e->meets || all_meet || store_mask_any( uses->foreign ) ||
                           store_mask_meets( uses->touched, across );
            }
        }
    }
}

int plan_usual_substeps( const wisp_registry* r )
{
    return r->substeps > 1 ? r->substeps : 1;
}

// Rates are ordered by the number of substeps.
int plan_rate( const plan_entity* e, const wisp_registry* r )
{
    return e->fewer > 0 ? e->fewer - plan_usual_substeps( r ) : e->split;
}

int plan_substeps_of_rate( const wisp_registry* r, int rate, int of_world )
{
    const int64_t usual = plan_usual_substeps( r );
    return rate > 0 ? of_world * rate : (int)( ( (int64_t)of_world * ( usual + rate ) + usual - 1 ) / usual );
}

// Return the rate for what an entity asks for, and the limit that its detail sets.
static int rate_for( const store_entity* e, int usual )
{
    const int asked = e->substeps > usual ? ( e->substeps - 1 ) / usual + 1 : 1;
    const int limit = e->detail.max_substeps;
    if ( limit == 0 || limit >= asked * usual )
    {
        return asked;
    }
    return limit < usual ? limit - usual : ( limit - 1 ) / usual + 1;
}

static void set_rate( plan_entity* e, int rate, int usual )
{
    e->split = rate > 0 ? rate : 1;
    e->fewer = rate > 0 ? 0 : usual + rate;
}

void plan_find_splits( plan* p, const wisp_registry* r )
{
    const bool all_meet = has_followers( p, r );
    const int usual = plan_usual_substeps( r );
    int most = -usual; // of those that meet
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        plan_entity* e = p->entities + slot;
        find_meetings( p, r, slot, all_meet );
        const int rate = rate_for( r->store->entities + slot, usual );
        set_rate( e, rate, usual );
        most = e->meets && rate > most ? rate : most;
    }
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        plan_entity* e = p->entities + slot;
        set_rate( e, e->meets ? most : plan_rate( e, r ), usual );
    }
}

// Return the next larger rate among entities that run substeps in waves; 0: none.
static int plan_next_rate( const plan* p, const wisp_registry* r, int rate )
{
    int next = 0;
    for ( int slot = 0; slot < p->entity_count; ++slot )
    {
        const plan_entity* e = p->entities + slot;
        const int own = plan_rate( e, r );
        const bool is_nearer = own > rate && ( next == 0 || own < next );
        next = e->runs_waves && e->loops == false && is_nearer ? own : next;
    }
    return next;
}

// ---- callbacks ----

// Callbacks of a pass: the columns, substeps and fractions of a frame, its kernels, memory and counters.

static store_entity* entity_of( const wisp_frame* frame, wisp_entity entity )
{
    return frame->registry->store->entities + entity.index - 1;
}

void* wisp_frame_column( wisp_frame* frame, wisp_entity entity, wisp_component component, int column )
{
    return store_column( frame->registry->store, entity_of( frame, entity ), component, column );
}

bool wisp_frame_has( wisp_frame* frame, wisp_entity entity, wisp_component component )
{
    return store_mask_has( &entity_of( frame, entity )->components, component );
}

wisp_vec3 wisp_frame_offset( wisp_frame* frame, wisp_entity entity )
{
    return entity_of( frame, entity )->offset;
}

wisp_vec3 wisp_frame_between( wisp_frame* frame, wisp_entity from, wisp_entity to )
{
    return store_between( entity_of( frame, from ), entity_of( frame, to ) );
}

const wisp_strand_topology* wisp_frame_strands( wisp_frame* frame, wisp_entity entity )
{
    return entity_of( frame, entity )->strands;
}

const wisp_fabric* wisp_frame_fabric( wisp_frame* frame, wisp_entity entity )
{
    return entity_of( frame, entity )->fabric;
}

const struct wisp_samples* wisp_frame_samples( wisp_frame* frame, wisp_entity surface )
{
    return entity_of( frame, surface )->samples;
}

wisp_span wisp_frame_particles( wisp_frame* frame, const wisp_span* span )
{
    int count = entity_of( frame, span->entity )->rows[WISP_TABLE_PARTICLE].count;
    int end = span->end * WISP_PARTICLE_BLOCK;
    wisp_span particles = *span;
    particles.begin = span->begin * WISP_PARTICLE_BLOCK;
    particles.end = end < count ? end : count;
    return particles;
}

int execute_substeps( const wisp_frame* frame, int slot )
{
    return plan_substeps_of_rate( frame->registry, plan_rate( frame->plan->entities + slot, frame->registry ),
                                  frame->substeps );
}

// What a substep of the world has of something, for a substep of an entity.
static float in_substep( const wisp_frame* frame, wisp_entity entity, float of_world )
{
    const plan_entity* e = frame->plan->entities + entity.index - 1;
    return e->fewer > 0 && frame->substeps > 0
               ? of_world * (float)frame->substeps / (float)wisp_frame_substeps( frame, entity )
               : of_world / (float)e->split;
}

float wisp_frame_dt( const wisp_frame* frame, wisp_entity entity )
{
    return frame->even > 0.0f ? frame->even / (float)wisp_frame_substeps( frame, entity )
                              : in_substep( frame, entity, frame->seconds );
}

int wisp_frame_substeps( const wisp_frame* frame, wisp_entity entity )
{
    return execute_substeps( frame, (int)entity.index - 1 );
}

float wisp_frame_progress( const wisp_frame* frame, wisp_entity entity, int substeps )
{
    const float progress = in_substep( frame, entity, frame->progress ) * (float)substeps;
    return frame->progress == 0.0f ? (float)substeps / (float)wisp_frame_substeps( frame, entity )
           : progress < 1.0f       ? progress
                                   : 1.0f;
}

float wisp_frame_progress_left( const wisp_frame* frame, wisp_entity entity, int substep )
{
    const float progress = in_substep( frame, entity, frame->progress );
    const float left = 1.0f - progress * (float)substep;
    return progress == 0.0f  ? 1.0f / (float)( wisp_frame_substeps( frame, entity ) - substep )
           : left > progress ? progress / left
                             : 1.0f;
}

wisp_transform wisp_frame_reached( const wisp_frame* frame, wisp_transform from, wisp_transform to )
{
    const bool is_there = frame->reached == 1.0f || memcmp( &from, &to, sizeof( from ) ) == 0;
    return is_there ? to : wisp_transform_interpolate( from, to, frame->reached );
}

int wisp_frame_iterations( const wisp_frame* frame )
{
    return frame->iterations;
}

bool wisp_frame_is_halted( wisp_frame* frame, wisp_entity entity )
{
    const store_entity* e = entity_of( frame, entity );
    return e->halted != 0 || e->sleep != STORE_AWAKE || e->detail.level == WISP_DETAIL_NOTHING;
}

wisp_detail_frame wisp_frame_detail( wisp_frame* frame, wisp_entity entity )
{
    return entity_of( frame, entity )->detail;
}

bool wisp_frame_is_asleep( wisp_frame* frame, wisp_entity entity )
{
    return entity_of( frame, entity )->sleep != STORE_AWAKE;
}

void wisp_frame_halt( wisp_frame* frame, wisp_entity entity, const char* message )
{
    entity_of( frame, entity )->halted = 1; // only passes that run on the entity halt it, one at a time
    wisp_frame_count( frame, WISP_COUNT_HALTED, 1 );
    if ( atomic_flag_test_and_set( &frame->halting ) == false )
    {
        snprintf( frame->halted_message, sizeof( frame->halted_message ), "%s", message );
    }
}

const wisp_kernels* wisp_frame_kernels( wisp_frame* frame )
{
    return frame->kernels;
}

const wisp_parallel* wisp_frame_parallel( wisp_frame* frame, const wisp_span* span )
{
    return frame->wide ? jobs_everyone( frame->pool ) : jobs_alone( frame->pool, span->worker );
}

void* wisp_frame_workspace( wisp_frame* frame, int workspace, int worker )
{
    const plan_workspace* w = frame->registry->workspaces + workspace;
    return (char*)w->blocks + (size_t)worker * w->size;
}

uint64_t wisp_frame_step( wisp_frame* frame )
{
    return frame->step;
}

void wisp_frame_fail( wisp_frame* frame, wisp_status status, const char* format, ... )
{
    if ( atomic_flag_test_and_set( &frame->failing ) )
    {
        return; // keep the first message
    }
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( frame->error.message, sizeof( frame->error.message ), format, arguments );
    va_end( arguments );
    frame->error.status = status;
    atomic_store( &frame->failed, true );
}

void wisp_frame_count( wisp_frame* frame, wisp_counter counter, uint64_t amount )
{
    atomic_fetch_add_explicit( frame->counters + counter, amount, memory_order_relaxed );
}

// ---- execution ----

enum
{
    // Waking a worker costs about as much as this many rows of sixteen lanes (bench case "paper", 100 strands).
    PLAN_SMALL_WAVE_ROWS = 40,
    // One of this many blocks that loop over substeps is timed.
    PLAN_CLOCKED_BLOCKS = 8,
};

// ---- blocks ----

bool execute_is_due( wisp_frame* frame, int number, int slot )
{
    const wisp_pass* pass = frame->registry->passes + number;
    const store* s = frame->registry->store;
    store_entity* e = s->entities + slot;
    if ( frame->goes_on && pass->stage == WISP_STAGE_OBSERVE )
    {
        return false; // nobody sees it before the step has ended
    }
    if ( pass->on_change != 0 && store_mask_has( &e->dirty, number ) == false )
    {
        return false;
    }
    if ( pass->should_run != NULL && pass->should_run( frame, store_handle( s, slot ), pass->user ) == false )
    {
        return false;
    }
    for ( int i = 0; i < WISP_MAX_USES && pass->writes[i] != 0; ++i )
    {
        store_touch( s, e, pass->writes[i] );
    }
    store_mask_remove( &e->dirty, number ); // after its own writes, so that a pass does not trigger itself
    return true;
}

static uint32_t due_passes( wisp_frame* frame, const plan_node* node, const plan_target* target )
{
    unsigned due = 0;
    const bool left_out = execute_leaves_out( frame->registry->store->entities + target->slot, node->section );
    for ( int i = 0; i < node->pass_count && left_out == false; ++i )
    {
        bool live = ( target->passes >> i & 1 ) != 0;
        due |= live && execute_is_due( frame, node->passes[i], target->slot ) ? 1u << i : 0;
    }
    return due;
}

typedef struct wave_size
{
    int count;    // blocks
    int64_t rows; // of sixteen lanes
} wave_size;

// Substeps of an entity in one run of a node.
static int substeps_in( const wisp_frame* frame, const plan_node* node, int slot )
{
    return node->section == PLAN_ITEM_LOOP ? execute_substeps( frame, slot ) : 1;
}

// Number of runs of each pass in so many substeps of one run of its node.
static int64_t runs_of( const wisp_frame* frame, const plan_node* node, int pass, int substeps )
{
    const bool iterated = plan_section_of( frame->registry->passes[pass].stage ) == PLAN_ITERATION;
    return node->section == PLAN_ITEM_LOOP && iterated ? (int64_t)substeps * frame->iterations : substeps;
}

static void add_blocks( wisp_frame* frame, int n, const plan_target* target, unsigned due, wave_size* size )
{
    plan* p = frame->plan;
    const plan_node* node = p->nodes + n;
    const store_entity* e = frame->registry->store->entities + target->slot;
    const int join = due == target->passes && frame->iterations == 1 ? target->join : -1;
    const int items = plan_item_count( e, node->domain ), substeps = substeps_in( frame, node, target->slot );
    for ( int begin = 0; begin < items; begin += node->grain )
    {
        int end = items - begin > node->grain ? begin + node->grain : items;
        p->blocks[size->count++] = ( plan_block ){ n, due, join, target->slot, begin, end };
    }
    for ( int i = 0; i < node->pass_count; ++i )
    {
        frame->pass_items[node->passes[i]] +=
            ( due >> i & 1 ) != 0 ? items * runs_of( frame, node, node->passes[i], substeps ) : 0;
    }
    size->rows += (int64_t)plan_row_count( e ) * substeps;
}

// Entities whose substeps are not those of the world have the substep loop for themselves, and those that are apart the item loop.
static bool takes_part( const wisp_frame* frame, const plan_node* node, int slot )
{
    const plan_entity* e = frame->plan->entities + slot;
    return plan_is_substep( node->section ) ? e->is_apart == false && plan_rate( e, frame->registry ) == frame->rate
                                            : node->repeats == false || e->is_apart;
}

static wave_size collect_blocks( wisp_frame* frame, plan_section section, int wave )
{
    plan* p = frame->plan;
    wave_size size = { 0 };
    for ( int n = 0; n < p->node_count; ++n )
    {
        const plan_node* node = p->nodes + n;
        for ( int i = 0; i < node->wave_target_count && node->section == section && node->wave == wave; ++i )
        {
            const plan_target* target = p->targets + node->first_target + i;
            frame->asking = n;
            const unsigned due = takes_part( frame, node, target->slot ) ? due_passes( frame, node, target ) : 0;
            if ( due != 0 )
            {
                add_blocks( frame, n, target, due, &size );
            }
        }
    }
    return size;
}

// Move blocks that run on all workers to the end: large entities, and a single one.
// @return number of other blocks
static int partition_wide_blocks( const wisp_frame* frame, int count )
{
    plan* p = frame->plan;
    int entity_blocks = 0;
    for ( int i = 0; i < count; ++i )
    {
        entity_blocks += p->nodes[p->blocks[i].node].domain == WISP_DOMAIN_ENTITY ? 1 : 0;
    }
    int narrow = count;
    for ( int i = 0; i < narrow && entity_blocks > 0; )
    {
        const plan_block block = p->blocks[i];
        const store_entity* e = frame->registry->store->entities + block.slot;
        bool wide = p->nodes[block.node].domain == WISP_DOMAIN_ENTITY && ( entity_blocks == 1 || plan_is_wide( e ) );
        if ( wide )
        {
            p->blocks[i] = p->blocks[--narrow];
            p->blocks[narrow] = block;
        }
        else
        {
            ++i;
        }
    }
    return narrow;
}

// ---- running ----

static void run_passes( wisp_frame* frame, const plan_node* node, unsigned due, pass_range range,
                        const wisp_span* span )
{
    for ( int i = range.begin; i < range.end; ++i )
    {
        if ( ( due >> i & 1 ) != 0 )
        {
            const wisp_pass* pass = frame->registry->passes + node->passes[i];
            pass->run( frame, span, pass->user );
        }
    }
}

// Like run_passes, but times each pass; `scale` extends the sample to its block.
static void sample_passes( wisp_frame* frame, const plan_node* node, unsigned due, pass_range range,
                           const wisp_span* span, double scale )
{
    double last = wisp_clock_seconds();
    for ( int i = range.begin; i < range.end; ++i )
    {
        if ( ( due >> i & 1 ) != 0 )
        {
            const wisp_pass* pass = frame->registry->passes + node->passes[i];
            pass->run( frame, span, pass->user );
            double now = wisp_clock_seconds();
            frame->clocks[span->worker].seconds[node->passes[i]] += ( now - last ) * scale;
            last = now;
        }
    }
}

void execute_item( wisp_frame* frame, const plan_node* node, unsigned due, pass_range range, const wisp_span* span,
                   double scale )
{
    if ( scale > 0.0 )
    {
        sample_passes( frame, node, due, range, span, scale );
    }
    else
    {
        run_passes( frame, node, due, range, span );
    }
}

typedef struct pass_run
{
    wisp_frame* frame;
    const wisp_span* span;
} pass_run;

static void run_pass( void* context, int number, int worker )
{
    (void)worker;
    const pass_run* run = context;
    const wisp_pass* pass = run->frame->registry->passes + number;
    pass->run( run->frame, run->span, pass->user );
}

// Each pass releases its scratch memory, so that what a step needs does not depend on how often this is called.
void wisp_frame_project_again( wisp_frame* frame, const wisp_span* groups )
{
    const plan* p = frame->plan;
    pass_run run = { frame, groups };
    for ( int n = 0; n < p->node_count; ++n )
    {
        const plan_node* node = p->nodes + n;
        const plan_target* target = p->targets + node->first_target;
        const bool projects = node->domain == WISP_DOMAIN_STRAND_GROUP && node->repeats == false;
        for ( int t = 0; t < node->target_count && projects; ++t )
        {
            for ( int i = 0; i < node->pass_count && target[t].slot == (int)groups->entity.index - 1; ++i )
            {
                if ( ( target[t].passes >> i & 1 ) != 0 &&
                     frame->registry->passes[node->passes[i]].stage == WISP_STAGE_PROJECT )
                {
                    jobs_run_within( frame->pool, node->passes[i], run_pass, &run, groups->worker );
                }
            }
        }
    }
}

// First pass at or after `from` that belongs to a later section.
static int end_of_section( const wisp_frame* frame, const plan_node* node, int from, plan_section section )
{
    while ( from < node->pass_count &&
            plan_section_of( frame->registry->passes[node->passes[from]].stage ) <= section )
    {
        from += 1;
    }
    return from;
}

// Run substeps [begin, end) of a block of items, pass by pass.
static void loop_passes( wisp_frame* frame, const plan_node* node, const plan_block* block, wisp_span span, int begin,
                         int end, double scale )
{
    const int substep_end = end_of_section( frame, node, 0, PLAN_SUBSTEP );
    const int iteration_end = end_of_section( frame, node, substep_end, PLAN_ITERATION );
    for ( span.substep = begin; span.substep < end; ++span.substep )
    {
        span.iteration = 0;
        execute_item( frame, node, block->passes, ( pass_range ){ 0, substep_end }, &span, scale );
        for ( ; span.iteration < frame->iterations && iteration_end > substep_end; ++span.iteration )
        {
            execute_item( frame, node, block->passes, ( pass_range ){ substep_end, iteration_end }, &span, scale );
        }
        execute_item( frame, node, block->passes, ( pass_range ){ iteration_end, node->pass_count }, &span, scale );
    }
}

// Run substeps without timing, by the fused function if there is one.
static void loop_fast( wisp_frame* frame, const plan_node* node, const plan_block* block, wisp_span span, int begin,
                       int end )
{
    if ( block->join < 0 )
    {
        loop_passes( frame, node, block, span, begin, end, 0.0 );
    }
    else if ( begin < end )
    {
        const plan_fusion* join = frame->registry->joins + block->join;
        span.substep = begin;
        span.iteration = 0;
        join->run( frame, &span, end, join->user );
    }
}

// One substep of one block in `clocked_blocks` is timed, a different one in each step: reading the clock for every pass of
// every substep took a tenth of the time of strands.
int execute_timed_substep( const wisp_frame* frame, int block, int substeps )
{
    const uint64_t turn = frame->step + (uint64_t)block, interval = (uint64_t)frame->clocked_blocks;
    const bool is_timed = frame->sampled && turn % interval == 0;
    return is_timed ? (int)( turn / interval % (uint64_t)substeps ) : substeps;
}

// Run all substeps of a block of items, so that it stays in the near caches. The timed substep runs pass by pass,
// because a fused function gives no times of its passes.
static void loop_block( wisp_frame* frame, const plan_node* node, const plan_block* block, wisp_span span, int index )
{
    const int substeps = wisp_frame_substeps( frame, span.entity );
    const int timed = execute_timed_substep( frame, index, substeps );
    loop_fast( frame, node, block, span, 0, timed );
    if ( timed < substeps )
    {
        loop_passes( frame, node, block, span, timed, timed + 1, substeps );
        loop_fast( frame, node, block, span, timed + 1, substeps );
    }
}

static void run_block( void* context, int index, int worker )
{
    wisp_frame* frame = context;
    const plan_block block = frame->wave[index];
    const plan_node* node = frame->plan->nodes + block.node;
    const pass_range all = { 0, node->pass_count };
    wisp_span span = { .entity = store_handle( frame->registry->store, block.slot ),
                       .begin = block.begin,
                       .end = block.end,
                       .worker = worker,
                       .substep =
                           node->section == PLAN_AFTER ? execute_substeps( frame, block.slot ) - 1 : frame->substep,
                       .iteration = frame->iteration };
    if ( node->section == PLAN_ITEM_LOOP )
    {
        loop_block( frame, node, &block, span, index );
        return;
    }
    if ( frame->sampled == false && node->pass_count == 1 )
    {
        run_passes( frame, node, block.passes, all, &span );
        return;
    }
    for ( int item = block.begin; item < block.end; ++item )
    {
        const double scale = item == block.begin && frame->sampled ? block.end - block.begin : 0.0;
        span.begin = item;
        span.end = item + 1;
        execute_item( frame, node, block.passes, all, &span, scale );
    }
}

// Whether the wave has more than one pass. @param only receives one of them
static bool has_several_passes( const wisp_frame* frame, int count, int* only )
{
    bool several = false;
    *only = -1;
    for ( int i = 0; i < count; ++i )
    {
        const plan_block* block = frame->wave + i;
        const plan_node* node = frame->plan->nodes + block->node;
        for ( int k = 0; k < node->pass_count; ++k )
        {
            if ( ( block->passes >> k & 1 ) != 0 )
            {
                several = several || ( *only >= 0 && *only != node->passes[k] );
                *only = node->passes[k];
            }
        }
    }
    return several;
}

// Divide the wall time of a wave among its passes in proportion to the samples. Walks the plan, not the registry,
// so that unselected passes cost nothing.
static void divide_time( wisp_frame* frame, double seconds )
{
    const plan* p = frame->plan;
    double totals[PLAN_MAX_PASSES], sum = 0.0;
    for ( int n = 0; n < p->node_count; ++n )
    {
        for ( int i = 0; i < p->nodes[n].pass_count && p->nodes[n].repeats == false; ++i )
        {
            int pass = p->nodes[n].passes[i];
            totals[pass] = 0.0;
            for ( int w = 0; w < frame->registry->workers; ++w )
            {
                totals[pass] += frame->clocks[w].seconds[pass];
                frame->clocks[w].seconds[pass] = 0.0;
            }
            sum += totals[pass];
        }
    }
    for ( int n = 0; n < p->node_count && sum > 0.0; ++n )
    {
        for ( int i = 0; i < p->nodes[n].pass_count && p->nodes[n].repeats == false; ++i )
        {
            int pass = p->nodes[n].passes[i];
            frame->pass_seconds[pass] += seconds * totals[pass] / sum;
        }
    }
}

void execute_timed( wisp_frame* frame, int count, int64_t rows, int clocked, wisp_block_fn* run )
{
    frame->clocked_blocks = clocked;
    double begin = wisp_clock_seconds();
    if ( rows < PLAN_SMALL_WAVE_ROWS )
    {
        jobs_run_inline( frame->pool, count, run, frame );
    }
    else
    {
        jobs_run_wave( frame->pool, count, run, frame );
    }
    double seconds = wisp_clock_seconds() - begin;
    if ( frame->sampled )
    {
        divide_time( frame, seconds );
    }
    else
    {
        frame->pass_seconds[frame->only_pass] += seconds;
    }
}

static void run_narrow( wisp_frame* frame, int count, int64_t rows )
{
    frame->sampled = has_several_passes( frame, count, &frame->only_pass );
    execute_timed( frame, count, rows, count < PLAN_CLOCKED_BLOCKS ? count : PLAN_CLOCKED_BLOCKS, run_block );
}

// Passes of one block that use all workers. They run one behind the other, so each is timed as a whole.
static void run_wide( wisp_frame* frame, int index )
{
    frame->wide = true;
    frame->wave += index;
    run_narrow( frame, 1, 0 );
    frame->wave -= index;
    frame->wide = false;
}

static void run_section( wisp_frame* frame, plan_section section )
{
    for ( int wave = 0; wave < frame->plan->wave_count[section]; ++wave )
    {
        wave_size size = collect_blocks( frame, section, wave );
        int narrow = partition_wide_blocks( frame, size.count );
        frame->wave = frame->plan->blocks;
        if ( narrow > 0 )
        {
            run_narrow( frame, narrow, size.rows );
        }
        for ( int i = narrow; i < size.count; ++i )
        {
            run_wide( frame, i );
        }
    }
}

// Run the substeps of the entities that wait for each other and make them at a rate.
static void run_substeps( wisp_frame* frame, int rate )
{
    const bool iterates = frame->plan->wave_count[PLAN_ITERATION] > 0;
    const int count = plan_substeps_of_rate( frame->registry, rate, frame->substeps );
    frame->rate = rate;
    for ( frame->substep = 0; frame->substep < count; ++frame->substep )
    {
        run_section( frame, PLAN_SUBSTEP );
        for ( frame->iteration = 0; frame->iteration < frame->iterations && iterates; ++frame->iteration )
        {
            run_section( frame, PLAN_ITERATION );
        }
        run_section( frame, PLAN_AFTER_ITERATION );
    }
}

// ---- entities that are apart ----

// Find the entities that are apart in a step, once their bounds are known.
static void find_apart( wisp_frame* frame )
{
    store* s = frame->registry->store;
    for ( int slot = 0; slot < frame->plan->entity_count; ++slot )
    {
        plan_entity* e = frame->plan->entities + slot;
        const int32_t* known = store_column( s, s->entities + slot, WISP_STRAND_REACH, 1 );
        const int32_t* apart = store_column( s, s->entities + slot, WISP_STRAND_REACH, 2 );
        e->is_apart = e->parts == PLAN_PARTS_ALWAYS ||
                      ( e->parts == PLAN_PARTS_APART && known != NULL && *known != 0 && *apart != 0 );
    }
}

bool wisp_frame_is_apart( const wisp_frame* frame, wisp_entity entity )
{
    return frame->plan->entities[entity.index - 1].is_apart;
}

typedef struct late_entity
{
    wisp_frame* frame;
    int slot;
} late_entity;

// Run what a late entity has to run of a node: its missed substeps in the item loop, or passes of this substep.
static void run_late( const late_entity* late, int n, int worker )
{
    wisp_frame* frame = late->frame;
    const plan_node* node = frame->plan->nodes + n;
    const store* s = frame->registry->store;
    const int items = plan_item_count( s->entities + late->slot, node->domain );
    const wisp_span span = {
        .entity = store_handle( s, late->slot ), .end = items, .worker = worker, .substep = frame->substep
    };
    for ( int i = 0; i < node->wave_target_count; ++i )
    {
        const plan_target* target = frame->plan->targets + node->first_target + i;
        const unsigned due = target->slot == late->slot ? due_passes( frame, node, target ) : 0;
        const plan_block block = { n, due, target->join, late->slot, 0, items };
        if ( due != 0 && node->repeats )
        {
            loop_fast( frame, node, &block, span, 0, frame->substep );
        }
        else
        {
            run_passes( frame, node, due, ( pass_range ){ 0, node->pass_count }, &span );
        }
    }
}

// Run the substeps that an entity has missed, then its passes before the node that asks.
static void catch_up( void* context, int index, int worker )
{
    (void)index;
    const late_entity* late = context;
    const plan* p = late->frame->plan;
    const plan_node* asking = p->nodes + late->frame->asking;
    for ( int wave = -1; wave <= asking->wave; ++wave )
    {
        for ( int n = 0; n < p->node_count; ++n )
        {
            const plan_node* node = p->nodes + n;
            const bool precedes = node->section == asking->section && node->wave == wave &&
                                  ( wave < asking->wave || n < late->frame->asking );
            if ( wave < 0 ? node->repeats : precedes )
            {
                run_late( late, n, worker );
            }
        }
    }
}

void wisp_frame_join( wisp_frame* frame, wisp_entity entity )
{
    late_entity late = { frame, (int)entity.index - 1 };
    plan_entity* e = frame->plan->entities + late.slot;
    if ( e->is_apart )
    {
        e->is_apart = false;
        jobs_run_inline( frame->pool, 1, catch_up, &late );
    }
}

bool plan_has_substeps( const plan* p )
{
    return p->wave_count[PLAN_SUBSTEP] > 0 || p->wave_count[PLAN_ITERATION] > 0 ||
           p->wave_count[PLAN_AFTER_ITERATION] > 0 || p->wave_count[PLAN_ITEM_LOOP] > 0;
}

void plan_execute( wisp_frame* frame )
{
    const plan* p = frame->plan;
    if ( frame->continues == false )
    {
        memset( frame->pass_seconds, 0, sizeof( frame->pass_seconds ) );
        memset( frame->pass_items, 0, sizeof( frame->pass_items ) );
    }
    if ( frame->substeps == 0 )
    {
        return;
    }

    frame->substep = frame->iteration = 0;
    run_section( frame, PLAN_BEFORE );
    find_apart( frame );
    for ( int i = 0; i < p->acting_count; ++i )
    {
        const plan_state* s = frame->registry->states + p->acting[i];
        if ( s->hooks.begun != NULL )
        {
            s->hooks.begun( s->memory, frame, frame->registry->store->allocator );
        }
    }
    for ( int rate = plan_next_rate( p, frame->registry, INT_MIN ); rate != 0;
          rate = plan_next_rate( p, frame->registry, rate ) )
    {
        run_substeps( frame, rate );
    }
    frame->iteration = frame->iterations - 1;
    execute_entity_loops( frame ); // strands follow where surfaces have moved
    run_section( frame, PLAN_ITEM_LOOP );
    run_section( frame, PLAN_AFTER );
}
