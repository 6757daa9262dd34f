// The order of passes, their waves and nodes.
#include "compile_parts.h"

static bool conflicts( const wisp_pass* a, const wisp_pass* b )
{
    store_mask a_writes = store_mask_or( plan_mask( a->writes ), plan_mask( a->foreign ) );
    store_mask b_writes = store_mask_or( plan_mask( b->writes ), plan_mask( b->foreign ) );
    return store_mask_meets( a_writes, store_mask_or( b_writes, plan_mask( b->reads ) ) ) ||
           store_mask_meets( b_writes, plan_mask( a->reads ) );
}

// ---- order: stage, then data dependency, then the order of declaration ----

// Whether a must precede b: a only writes a component that b reads.
static bool must_precede( const wisp_pass* a, const wisp_pass* b )
{
    store_mask produced = store_mask_and_not( plan_mask( a->writes ), plan_mask( a->reads ) );
    store_mask produced_by_b = store_mask_and_not( plan_mask( b->writes ), plan_mask( b->reads ) );
    return store_mask_meets( produced, store_mask_and_not( plan_mask( b->reads ), produced_by_b ) );
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
                                 must_precede( r->passes + j, r->passes + i ) == false );
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

wisp_status plan_order( const wisp_registry* r, store_mask live, int* order, int* count, wisp_error* error )
{
    *count = 0;
    for ( int stage = 0; stage < WISP_STAGE_COUNT; ++stage )
    {
        WISP_TRY( order_stage( r, live, (wisp_stage)stage, order, count, error ) );
    }
    return WISP_OK;
}

// ---- nodes: waves and fusion ----

static bool node_conflicts( const wisp_registry* r, const plan_node* node, const wisp_pass* pass )
{
    for ( int i = 0; i < node->pass_count; ++i )
    {
        if ( conflicts( r->passes + node->passes[i], pass ) )
        {
            return true;
        }
    }
    return false;
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
            writes = store_mask_or( writes, plan_mask( pass->writes ) );
            reads = store_mask_or( reads, plan_mask( pass->reads ) );
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
            const store_mask changed = store_mask_or( plan_mask( pass->writes ), plan_mask( pass->foreign ) );
            possible = possible && store_mask_meets( changed, store_mask_or( writes, reads ) ) == false &&
                       store_mask_meets( plan_mask( pass->reads ), writes ) == false;
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
    node->passes[node->pass_count++] = number;
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
        if ( node->section != section || node_conflicts( r, node, pass ) == false )
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
        host->passes[host->pass_count++] = number;
        host->grain = pass->grain > host->grain ? pass->grain : host->grain;
        return;
    }
    p->nodes[p->node_count++] = ( plan_node ){
        .passes = { number },
        .pass_count = 1,
        .domain = pass->domain,
        .section = section,
        .wave = wave,
        .grain = pass->grain > 0 ? pass->grain : default_grain( pass->domain ),
    };
    p->wave_count[section] = wave + 1 > p->wave_count[section] ? wave + 1 : p->wave_count[section];
}

void plan_place( plan* p, const wisp_registry* r, const int* order, int count )
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
