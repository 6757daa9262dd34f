// Compiles a plan: selection, order and nodes, then the targets of nodes and the memory of their blocks.
#include "plan.h"

#include "alloc.h"
#include "wisp/module/components.h"

#include <string.h>

// ---- selection ----

// Selection: the passes of each entity, what supplies their reads, and the rows and arrays that they need.

// Select a pass if the entity has all required components and its output is requested, by the entity or by the
// reads of a selected pass. Repeat until nothing changes.
static store_mask live_passes( const wisp_registry* r, const store_entity* e )
{
    store_mask live = { { 0 } }, requested = e->alive ? e->requests : live;
    const store_mask components = store_mask_and_not( e->components, e->derived );
    for ( bool grew = true; grew; )
    {
        grew = false;
        for ( int i = 0; i < r->pass_count; ++i )
        {
            const plan_uses* uses = r->uses + i;
            const bool fits = store_mask_holds( components, uses->required ) &&
                              store_mask_meets( components, uses->excluded ) == false;
            if ( store_mask_has( &live, i ) == false && fits && store_mask_meets( uses->writes, requested ) )
            {
                store_mask_add( &live, i );
                requested = store_mask_or( requested, uses->reads );
                grew = true;
            }
        }
    }
    return live;
}

// Check that every request and every read has a supplier: rows of the entity, or a selected pass that writes them.
static wisp_status check_supply( const wisp_registry* r, store_mask live, int slot, wisp_error* error )
{
    const store_entity* e = r->store->entities + slot;
    store_mask supplied = store_mask_and_not( e->components, e->derived );
    for ( int i = 0; i < r->pass_count; ++i )
    {
        if ( store_mask_has( &live, i ) )
        {
            supplied = store_mask_or( supplied, r->uses[i].writes );
        }
    }
    for ( int c = 1; c < r->store->component_count; ++c )
    {
        if ( store_mask_has( &e->requests, c ) && store_mask_has( &supplied, c ) == false )
        {
            return wisp_fail( error, WISP_CONFLICT, "'%s': requested of entity %d, but no pass can write it there",
                              r->store->components[c].def.name, slot + 1 );
        }
    }
    for ( int i = 0; i < r->pass_count; ++i )
    {
        const store_mask missing = store_mask_and_not( r->uses[i].reads, supplied );
        for ( int c = 1; c < r->store->component_count && store_mask_has( &live, i ); ++c )
        {
            if ( store_mask_has( &missing, c ) )
            {
                return wisp_fail( error, WISP_CONFLICT,
                                  "pass '%s': reads '%s', which entity %d does not have and no active pass writes",
                                  r->passes[i].name, r->store->components[c].def.name, slot + 1 );
            }
        }
    }
    return WISP_OK;
}

// ---- rows and arrays ----

// Attach components that an entity does not have.
// @return false: no memory
static bool plan_attach_rows( plan* p, store* s, int slot, store_mask components )
{
    for ( int c = 1; c < s->component_count; ++c )
    {
        store_entity* e = s->entities + slot;
        if ( store_mask_has( &components, c ) && store_mask_has( &e->components, c ) == false )
        {
            if ( store_attach( s, store_handle( s, slot ), (wisp_component)c ) == false )
            {
                return false;
            }
            store_mask_add( &e->derived, c );
            store_mask_add( &p->entities[slot].came, c );
        }
    }
    return true;
}

// Detach those of some components that passes needed, and no one else.
static void plan_detach_rows( store* s, int slot, store_mask components )
{
    for ( int c = 1; c < s->component_count; ++c )
    {
        if ( store_mask_has( &components, c ) && store_mask_has( &s->entities[slot].derived, c ) )
        {
            store_detach( s, store_handle( s, slot ), (wisp_component)c );
        }
    }
}

// Return the components that some passes read and write.
static store_mask plan_used_by( const wisp_registry* r, store_mask passes )
{
    store_mask used = { { 0 } };
    for ( int i = 0; i < r->pass_count; ++i )
    {
        if ( store_mask_has( &passes, i ) )
        {
            used = store_mask_or( used, r->uses[i].touched );
        }
    }
    return used;
}

// Make what selected passes read of the fabric.
static wisp_status need_fabric( const wisp_registry* r, const store_entity* e, store_mask live )
{
    unsigned arrays = 0;
    for ( int i = 0; i < r->pass_count; ++i )
    {
        arrays |= store_mask_has( &live, i ) ? r->passes[i].fabric : 0u;
    }
    return arrays != 0 && e->fabric != NULL ? wisp_fabric_need( e->fabric, arrays ) : WISP_OK;
}

// Return those of some passes that run at a detail. The others keep their place in the plan, and their rows.
static store_mask passes_at( const wisp_registry* r, store_mask live, wisp_detail detail )
{
    for ( int i = 0; i < r->pass_count; ++i )
    {
        const unsigned use = r->passes[i].detail;
        const bool runs = detail == WISP_DETAIL_NOTHING  ? ( use & WISP_PASS_WITHOUT_MOTION ) != 0
                          : detail == WISP_DETAIL_COARSE ? ( use & WISP_PASS_FINE ) == 0
                                                         : true;
        if ( runs == false )
        {
            store_mask_remove( &live, i );
        }
    }
    return live;
}

// Select the passes of each entity, attach the rows that they need and make the arrays of fabrics that they read.
// @return WISP_CONFLICT a request or a read without supplier; WISP_NO_MEMORY
static wisp_status plan_select( plan* p, const wisp_registry* r, wisp_error* error )
{
    store* s = r->store;
    for ( int slot = 0; slot < s->entity_count; ++slot )
    {
        const store_mask live = live_passes( r, s->entities + slot );
        p->entities[slot] =
            ( plan_entity ){ .live = live, .runs = passes_at( r, live, s->entities[slot].detail.level ) };
        WISP_TRY( s->entities[slot].alive ? check_supply( r, live, slot, error ) : WISP_OK );
        // rows that mean nothing between steps follow when fusions are known
        const store_mask used = store_mask_and_not( plan_used_by( r, live ), s->transient );
        if ( s->entities[slot].alive && plan_attach_rows( p, s, slot, used ) == false )
        {
            return wisp_fail( error, WISP_NO_MEMORY, "out of memory for the rows between the passes of entity %d",
                              slot + 1 );
        }
        wisp_status status = s->entities[slot].alive ? need_fabric( r, s->entities + slot, live ) : WISP_OK;
        if ( status != WISP_OK )
        {
            return wisp_fail( error, status, "out of memory for the topology that passes of entity %d read",
                              slot + 1 );
        }
        p->live = store_mask_or( p->live, live );
    }
    return WISP_OK;
}

// ---- order ----

// The order of passes, their waves and nodes.

static bool conflicts( const plan_uses* a, const plan_uses* b )
{
    return store_mask_meets( a->changes, store_mask_or( b->changes, b->reads ) ) ||
           store_mask_meets( b->changes, a->reads );
}

// ---- order: stage, then data dependency, then the order of declaration ----

// Whether a must precede b: a only writes a component that b reads.
static bool must_precede( const plan_uses* a, const plan_uses* b )
{
    return store_mask_meets( a->produced, store_mask_and_not( b->reads, b->produced ) );
}

static wisp_status order_stage( const wisp_registry* r, store_mask live, wisp_stage stage, int* order, int* count,
                                wisp_error* error )
{
    store_mask waiting = { { 0 } };
    for ( int i = 0; i < r->pass_count; ++i )
    {
        if ( store_mask_has( &live, i ) && r->passes[i].stage == stage )
        {
            store_mask_add( &waiting, i );
        }
    }
    while ( store_mask_any( waiting ) )
    {
        int next = -1, first = -1;
        for ( int i = 0; i < r->pass_count && next < 0; ++i )
        {
            if ( store_mask_has( &waiting, i ) == false )
            {
                continue;
            }
            first = first < 0 ? i : first;
            bool free = true;
            for ( int j = 0; j < r->pass_count; ++j )
            {
                free = free && ( i == j || store_mask_has( &waiting, j ) == false ||
                                 must_precede( r->uses + j, r->uses + i ) == false );
            }
            next = free ? i : -1;
        }
        if ( next < 0 )
        {
            return wisp_fail( error, WISP_CONFLICT,
                              "pass '%s': part of a cycle of passes that wait for each other in one stage",
                              r->passes[first].name );
        }
        order[( *count )++] = next;
        store_mask_remove( &waiting, next );
    }
    return WISP_OK;
}

// Order passes by stage, then data dependency, then declaration. @param order [PLAN_MAX_PASSES]
// @return WISP_CONFLICT passes wait for each other
static wisp_status plan_order( const wisp_registry* r, store_mask live, int* order, int* count, wisp_error* error )
{
    *count = 0;
    for ( int stage = 0; stage < WISP_STAGE_COUNT; ++stage )
    {
        WISP_TRY( order_stage( r, live, (wisp_stage)stage, order, count, error ) );
    }
    return WISP_OK;
}

// ---- nodes: waves and fusion ----

static bool node_conflicts( const wisp_registry* r, const plan_node* node, int number )
{
    bool found = false;
    for ( int i = 0; i < node->pass_count && found == false; ++i )
    {
        found = conflicts( r->uses + node->passes[i], r->uses + number );
    }
    return found;
}

// Find the passes over groups of strands that can run all substeps of a block of groups before the next block. The
// block then stays in the near caches for the whole step, and no worker waits for another between substeps (bench
// case "strands"). No other pass of the substep loop may touch what they write or write what they read. None may
// have `is_due`, which is evaluated once per step.
static store_mask item_loop_passes( const wisp_registry* r, store_mask live )
{
    store_mask loop = { { 0 } }, writes = { { 0 } }, reads = { { 0 } };
    bool possible = true;
    int count = 0;
    for ( int i = 0; i < r->pass_count; ++i )
    {
        const wisp_pass* pass = r->passes + i;
        const plan_section section = plan_section_of( pass->stage );
        if ( store_mask_has( &live, i ) && pass->domain == WISP_DOMAIN_STRAND_GROUP && section > PLAN_BEFORE &&
             section < PLAN_ITEM_LOOP )
        {
            store_mask_add( &loop, i );
            writes = store_mask_or( writes, r->uses[i].writes );
            reads = store_mask_or( reads, r->uses[i].reads );
            possible = possible && pass->should_run == NULL && pass->on_change == 0;
            count += 1;
        }
    }
    for ( int i = 0; i < r->pass_count; ++i )
    {
        const wisp_pass* pass = r->passes + i;
        const plan_section section = plan_section_of( pass->stage );
        const bool is_outside = store_mask_has( &live, i ) && store_mask_has( &loop, i ) == false;
        if ( is_outside && section > PLAN_BEFORE && section < PLAN_ITEM_LOOP )
        {
            possible = possible && store_mask_meets( r->uses[i].changes, store_mask_or( writes, reads ) ) == false &&
                       store_mask_meets( r->uses[i].reads, writes ) == false;
        }
    }
    return possible && count <= PLAN_MAX_FUSED ? loop : ( store_mask ){ { 0 } };
}

// Return those of some passes that touch entities that are apart.
static store_mask unsparing( const wisp_registry* r, store_mask live )
{
    for ( int i = 0; i < r->pass_count; ++i )
    {
        if ( r->passes[i].spares )
        {
            store_mask_remove( &live, i );
        }
    }
    return live;
}

// Add the item loop: one node, with its passes in the order of their stages.
static void place_in_item_loop( plan* p, const wisp_registry* r, int number, bool repeats )
{
    plan_node* node = NULL;
    for ( int n = 0; n < p->node_count; ++n )
    {
        node = p->nodes[n].section == PLAN_ITEM_LOOP ? p->nodes + n : node;
    }
    if ( node == NULL )
    {
        node = p->nodes + p->node_count++;
        *node = ( plan_node ){
            .domain = WISP_DOMAIN_STRAND_GROUP, .section = PLAN_ITEM_LOOP, .grain = 4, .repeats = repeats
        };
        p->wave_count[PLAN_ITEM_LOOP] = 1;
    }
    const int grain = r->passes[number].grain;
    node->passes[node->pass_count++] = (uint8_t)number;
    node->grain = grain > node->grain ? grain : node->grain;
}

static int default_grain( wisp_domain domain )
{
    return domain == WISP_DOMAIN_ENTITY ? 1 : 4;
}

// Place a pass in the wave after the last node with which it conflicts. If that node is alone in its wave, and both
// touch only their own item of the same domain, fuse them instead: A, B on item 0, then A, B on item 1. A pass with
// `is_due` is not fused with earlier passes.
static void place_pass( plan* p, const wisp_registry* r, int number )
{
    const wisp_pass* pass = r->passes + number;
    plan_section section = plan_section_of( pass->stage );
    int wave = 0, latest = -1, latest_count = 0;
    for ( int n = 0; n < p->node_count; ++n )
    {
        const plan_node* node = p->nodes + n;
        if ( node->section != section || node_conflicts( r, node, number ) == false )
        {
            continue;
        }
        if ( latest < 0 || node->wave > p->nodes[latest].wave )
        {
            latest = n;
            latest_count = 0;
        }
        latest_count += node->wave == p->nodes[latest].wave ? 1 : 0;
        wave = p->nodes[latest].wave + 1;
    }
    plan_node* host = latest >= 0 ? p->nodes + latest : NULL;
    bool fuses = host != NULL && latest_count == 1 && pass->domain != WISP_DOMAIN_ENTITY &&
                 host->domain == pass->domain && host->pass_count < PLAN_MAX_FUSED && pass->should_run == NULL;
    if ( fuses )
    {
        host->passes[host->pass_count++] = (uint8_t)number;
        host->grain = pass->grain > host->grain ? pass->grain : host->grain;
        return;
    }
    p->nodes[p->node_count++] = ( plan_node ){
        .passes = { (uint8_t)number },
        .pass_count = 1,
        .domain = pass->domain,
        .section = section,
        .wave = wave,
        .grain = pass->grain > 0 ? pass->grain : default_grain( pass->domain ),
    };
    p->wave_count[section] = wave + 1 > p->wave_count[section] ? wave + 1 : p->wave_count[section];
}

// Place ordered passes in nodes and waves, and fuse them.
static void plan_place( plan* p, const wisp_registry* r, const int* order, int count )
{
    store_mask loop = item_loop_passes( r, p->live );
    const bool repeats = store_mask_any( loop ) == false;
    loop = repeats ? item_loop_passes( r, unsparing( r, p->live ) ) : loop;
    for ( int i = 0; i < count; ++i )
    {
        const bool loops = store_mask_has( &loop, order[i] );
        if ( loops )
        {
            place_in_item_loop( p, r, order[i], repeats );
        }
        if ( loops == false || repeats )
        {
            place_pass( p, r, order[i] );
        }
    }
    p->pass_count = count;
}

// ---- compile ----

plan_section plan_section_of( wisp_stage stage )
{
    switch ( stage )
    {
        case WISP_STAGE_INPUT:
            return PLAN_BEFORE;
        case WISP_STAGE_FORCE:
        case WISP_STAGE_PREDICT:
        case WISP_STAGE_CONTACT:
            return PLAN_SUBSTEP;
        case WISP_STAGE_PROJECT:
            return PLAN_ITERATION;
        case WISP_STAGE_VELOCITY:
            return PLAN_AFTER_ITERATION;
        default:
            return PLAN_AFTER;
    }
}

// ---- targets and memory of blocks ----

int plan_row_count( const store_entity* e )
{
    return e->rows[WISP_TABLE_STRAND_ROW].count + e->rows[WISP_TABLE_PARTICLE].count / WISP_LANES;
}

bool plan_is_wide( const store_entity* e )
{
    const bool has_sheets = store_mask_has( &e->components, WISP_SURFACE_LEVELS );
    return plan_row_count( e ) >= ( has_sheets ? PLAN_WIDE_ROWS_OVER_SHEETS : PLAN_WIDE_ENTITY_ROWS );
}

int plan_item_count( const store_entity* e, wisp_domain domain )
{
    switch ( domain )
    {
        case WISP_DOMAIN_STRAND_GROUP:
            return e->rows[WISP_TABLE_STRAND_GROUP].count;
        case WISP_DOMAIN_PARTICLE_BLOCK:
            return ( e->rows[WISP_TABLE_PARTICLE].count + WISP_PARTICLE_BLOCK - 1 ) / WISP_PARTICLE_BLOCK;
        default:
            return 1;
    }
}

// Find the fusion that can run all selected passes of an entity.
static int find_fusion( const wisp_registry* r, const plan_node* node, uint32_t passes )
{
    store_mask live = { { 0 } };
    for ( int i = 0; i < node->pass_count; ++i )
    {
        if ( ( passes >> i & 1 ) != 0 )
        {
            store_mask_add( &live, node->passes[i] );
        }
    }
    int found = -1;
    for ( int i = 0; i < r->join_count && node->section == PLAN_ITEM_LOOP; ++i )
    {
        const plan_fusion* f = r->joins + i;
        const bool runs_all = store_mask_holds( store_mask_or( f->required, f->allows ), live );
        found = runs_all && store_mask_holds( live, f->required ) ? i : found;
    }
    return found;
}

// Return those of some passes that a node has. Bit i: passes[i] of the node.
static uint32_t passes_in( const plan_node* node, store_mask some )
{
    uint32_t passes = 0;
    for ( int i = 0; i < node->pass_count; ++i )
    {
        passes |= store_mask_has( &some, node->passes[i] ) ? 1u << i : 0;
    }
    return passes;
}

uint32_t plan_live_passes( const plan* p, const plan_node* node, int slot )
{
    return passes_in( node, p->entities[slot].runs );
}

// Find when an entity can run all its passes of substeps in the item loop: others that it runs spare it.
static plan_parting parting_of( const plan* p, const wisp_registry* r, uint32_t loop, const plan_node* node,
                                int slot )
{
    store_mask others = p->entities[slot].runs;
    for ( int i = 0; i < node->pass_count; ++i )
    {
        if ( ( loop >> i & 1 ) != 0 )
        {
            store_mask_remove( &others, node->passes[i] );
        }
    }
    bool can = p->entities[slot].loops == false && wisp_registry_iterations( r ) == 1, is_spared = false;
    for ( int i = 0; i < r->pass_count; ++i )
    {
        const wisp_pass* pass = r->passes + i;
        const bool runs = store_mask_has( &others, i ) && plan_is_substep( plan_section_of( pass->stage ) );
        const bool reaches = pass->among != 0 && store_mask_has( &p->live, i ) &&
                             store_mask_has( &r->store->entities[slot].components, pass->among );
        can = can && ( runs == false || pass->spares );
        is_spared = is_spared || ( pass->spares && ( runs || reaches ) );
    }
    return can == false ? PLAN_PARTS_NEVER : is_spared ? PLAN_PARTS_APART : PLAN_PARTS_ALWAYS;
}

// Append the targets of a node that run in waves, or those with a substep loop of their own.
static void append_targets( plan* p, const wisp_registry* r, const plan_node* node, bool loops )
{
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        const bool in_loop = p->entities[slot].loops && plan_is_substep( node->section );
        const uint32_t passes = in_loop == loops ? plan_live_passes( p, node, slot ) : 0;
        const int join = passes != 0 ? find_fusion( r, node, passes ) : -1;
        if ( node->repeats && join >= 0 )
        {
            p->entities[slot].parts = parting_of( p, r, passes, node, slot );
        }
        if ( passes != 0 && ( node->repeats == false || p->entities[slot].parts != PLAN_PARTS_NEVER ) )
        {
            p->targets[p->target_count++] = ( plan_target ){ slot, passes, join };
        }
    }
}

static void fill_targets( plan* p, const wisp_registry* r )
{
    p->target_count = 0;
    for ( int n = 0; n < p->node_count; ++n )
    {
        plan_node* node = p->nodes + n;
        node->first_target = p->target_count;
        append_targets( p, r, node, false );
        node->wave_target_count = p->target_count - node->first_target;
        append_targets( p, r, node, true );
        node->target_count = p->target_count - node->first_target;
    }
}

static int widest_wave( const plan* p, const store* s )
{
    int widest = 0;
    for ( int section = 0; section < PLAN_SECTION_COUNT; ++section )
    {
        for ( int wave = 0; wave < p->wave_count[section]; ++wave )
        {
            int blocks = 0;
            for ( int n = 0; n < p->node_count; ++n )
            {
                const plan_node* node = p->nodes + n;
                for ( int i = 0; i < node->wave_target_count && (int)node->section == section && node->wave == wave;
                      ++i )
                {
                    int items =
                        plan_item_count( s->entities + p->targets[node->first_target + i].slot, node->domain );
                    blocks += ( items + node->grain - 1 ) / node->grain;
                }
            }
            widest = blocks > widest ? blocks : widest;
        }
    }
    return widest;
}

// Grow an array of the plan to `count` elements and discard its contents.
static bool reserve( const wisp_allocator* allocator, void** array, int* capacity, int count, size_t element )
{
    if ( count <= *capacity )
    {
        return true;
    }
    void* grown = base_allocate( allocator, (size_t)count * element, 64 );
    if ( grown == NULL )
    {
        return false;
    }
    base_release( allocator, *array, (size_t)*capacity * element );
    *array = grown;
    *capacity = count;
    return true;
}

static uint64_t hash_plan( const plan* p, const wisp_registry* r )
{
    uint64_t hash = 0;
    for ( int n = 0; n < p->node_count; ++n )
    {
        const plan_node* node = p->nodes + n;
        int place[3] = { (int)node->section, node->wave, node->target_count };
        hash = store_hash_bytes( hash, place, sizeof( place ) );
        for ( int i = 0; i < node->pass_count; ++i )
        {
            hash =
                store_hash_bytes( hash, r->passes[node->passes[i]].name, strlen( r->passes[node->passes[i]].name ) );
        }
    }
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        const int rate[2] = { slot, plan_rate( p->entities + slot, r ) };
        hash = rate[1] != 1 ? store_hash_bytes( hash, rate, sizeof( rate ) ) : hash;
    }
    return hash;
}

// Find the node whose targets fusions run in every step. Null: there is none.
static const plan_node* find_item_loop( const plan* p )
{
    for ( int n = 0; n < p->node_count; ++n )
    {
        if ( p->nodes[n].section == PLAN_ITEM_LOOP && p->nodes[n].repeats == false )
        {
            return p->nodes + n;
        }
    }
    return NULL;
}

// Rows that mean nothing between steps: a fusion takes some for the items at hand, so the entity needs none of all items. Which rows
// there are does not depend on the detail of an entity, so that snapshots fit; passes that run at any need none of those.
static bool fit_transient( plan* p, const wisp_registry* r )
{
    store* s = r->store;
    const plan_node* loop = wisp_registry_iterations( r ) == 1 ? find_item_loop( p ) : NULL;
    bool room = true;
    for ( int slot = 0; slot < s->entity_count && room; ++slot )
    {
        store_mask alone = p->entities[slot].live;
        const bool is_fused = loop != NULL && find_fusion( r, loop, passes_in( loop, alone ) ) >= 0;
        for ( int i = 0; is_fused && i < loop->pass_count; ++i )
        {
            store_mask_remove( &alone, loop->passes[i] );
        }
        const store_mask used = store_mask_and( plan_used_by( r, alone ), s->transient );
        room = s->entities[slot].alive == false || plan_attach_rows( p, s, slot, used );
        plan_detach_rows( s, slot, store_mask_and_not( s->transient, used ) );
    }
    return room;
}

// Detach what only passes needed that are selected no longer, or, of a plan that failed, what it has attached.
static void detach_rows( const plan* p, const wisp_registry* r, bool is_made )
{
    store* s = r->store;
    for ( int slot = 0; slot < s->entity_count; ++slot )
    {
        const plan_entity* e = p->entities + slot;
        const store_mask requests = s->entities[slot].requests,
                         needed =
                             store_mask_or( plan_used_by( r, e->live ), store_mask_or( requests, s->transient ) );
        plan_detach_rows( s, slot, is_made ? store_mask_and_not( store_mask_all(), needed ) : e->came );
        s->entities[slot].requests = requests;
    }
}

// Find what acts between steps, so that a step asks neither modules without passes nor columns that an entity lacks.
static void list_followers( plan* p, const wisp_registry* r )
{
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        p->entities[slot].pose = -1;
        for ( int i = r->place_count - 1; i >= 0; --i )
        {
            const bool is_pose = r->places[i].shape == WISP_PLACE_POSES &&
                                 store_mask_has( &r->store->entities[slot].components, r->places[i].component );
            p->entities[slot].pose = is_pose ? (int8_t)i : p->entities[slot].pose;
        }
    }
    for ( int i = 0; i < r->state_count; ++i )
    {
        bool is_live = false;
        for ( int pass = 0;
              pass < r->pass_count && ( r->states[i].hooks.stepped != NULL || r->states[i].hooks.begun != NULL );
              ++pass )
        {
            is_live = is_live || ( store_mask_has( &p->live, pass ) &&
                                   strcmp( r->pass_modules[pass], r->states[i].module ) == 0 );
        }
        if ( is_live )
        {
            p->acting[p->acting_count++] = (uint8_t)i;
        }
    }
}

// ---- compilation ----

static void clear( plan* p )
{
    p->node_count = p->pass_count = p->target_count = p->loop_count = p->entity_count = p->acting_count = 0;
    p->live = ( store_mask ){ { 0 } };
    memset( p->wave_count, 0, sizeof( p->wave_count ) );
    p->structure = 0;
}

static bool make_entity_loops( plan* p, const wisp_registry* r )
{
    const store* s = r->store;
    plan_find_splits( p, r );
    plan_find_entity_loops( p, r );
    const bool room = reserve( s->allocator, (void**)&p->loop_slots, &p->loop_slot_capacity, p->loop_count,
                               sizeof( p->loop_slots[0] ) ) &&
                      reserve( s->allocator, (void**)&p->loop_groups, &p->loop_group_capacity, p->loop_count,
                               sizeof( plan_loop_group ) ) &&
                      reserve( s->allocator, (void**)&p->loop_passes, &p->loop_pass_capacity,
                               p->loop_count * p->loop_node_count, sizeof( p->loop_passes[0] ) );
    if ( room )
    {
        plan_fill_entity_loops( p, r );
    }
    return room;
}

static wisp_status compile( plan* p, wisp_registry* r, wisp_error* error )
{
    const store* s = r->store;
    int order[PLAN_MAX_PASSES], count = 0;
    WISP_TRY( plan_select( p, r, error ) );
    WISP_TRY( plan_order( r, p->live, order, &count, error ) );
    plan_place( p, r, order, count );

    bool room = reserve( s->allocator, (void**)&p->targets, &p->target_capacity, p->node_count * s->entity_count,
                         sizeof( plan_target ) );
    room = room && make_entity_loops( p, r );
    if ( room )
    {
        fill_targets( p, r );
        room = reserve( s->allocator, (void**)&p->blocks, &p->block_capacity, widest_wave( p, s ),
                        sizeof( plan_block ) ) &&
               fit_transient( p, r );
    }
    return room ? WISP_OK
                : wisp_fail( error, WISP_NO_MEMORY, "out of memory for a plan of %d passes over %d entities", count,
                             s->entity_count );
}

wisp_status plan_compile( plan* p, wisp_registry* r, wisp_error* error )
{
    const store* s = r->store;
    clear( p );
    if ( reserve( s->allocator, (void**)&p->entities, &p->entity_capacity, s->entity_count, sizeof( plan_entity ) ) ==
         false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for a plan of %d entities", s->entity_count );
    }
    for ( int slot = 0; slot < s->entity_count; ++slot )
    {
        p->entities[slot] = ( plan_entity ){ 0 };
    }
    const wisp_status status = compile( p, r, error );
    detach_rows( p, r, status == WISP_OK );
    if ( status != WISP_OK )
    {
        clear( p );
        return status;
    }
    p->entity_count = s->entity_count;
    p->structure = s->structure;
    list_followers( p, r );
    p->hash = hash_plan( p, r );
    return WISP_OK;
}

void plan_update_rates( plan* p, const wisp_registry* r )
{
    plan_find_splits( p, r );
    plan_fill_entity_loops( p, r ); // as many as before
    p->hash = hash_plan( p, r );
}

wisp_status plan_end_step( const plan* p, const wisp_registry* r, wisp_world* world )
{
    for ( int i = 0; i < p->acting_count; ++i )
    {
        const plan_state* s = r->states + p->acting[i];
        if ( s->hooks.stepped != NULL )
        {
            WISP_TRY( s->hooks.stepped( s->memory, world ) );
        }
    }
    return WISP_OK;
}

size_t plan_memory( const plan* p )
{
    return (size_t)p->target_capacity * sizeof( plan_target ) + (size_t)p->block_capacity * sizeof( plan_block ) +
           (size_t)p->entity_capacity * sizeof( plan_entity ) +
           (size_t)p->loop_slot_capacity * sizeof( p->loop_slots[0] ) +
           (size_t)p->loop_group_capacity * sizeof( plan_loop_group ) +
           (size_t)p->loop_pass_capacity * sizeof( p->loop_passes[0] );
}

void plan_release( plan* p, const wisp_allocator* allocator )
{
    base_release( allocator, p->targets, (size_t)p->target_capacity * sizeof( plan_target ) );
    base_release( allocator, p->entities, (size_t)p->entity_capacity * sizeof( plan_entity ) );
    base_release( allocator, p->loop_slots, (size_t)p->loop_slot_capacity * sizeof( p->loop_slots[0] ) );
    base_release( allocator, p->loop_groups, (size_t)p->loop_group_capacity * sizeof( plan_loop_group ) );
    base_release( allocator, p->loop_passes, (size_t)p->loop_pass_capacity * sizeof( p->loop_passes[0] ) );
    base_release( allocator, p->blocks, (size_t)p->block_capacity * sizeof( plan_block ) );
    *p = ( plan ){ 0 };
}
