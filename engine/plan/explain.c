// The plan as data: every registered pass with its position, or the reason for its absence, and its predicted cost.

#include "alloc.h"
#include "plan.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// ---- reasons ----

// Reasons why a pass is selected or absent, as data and as text.

static const char* explain_name( const wisp_registry* r, wisp_component c )
{
    return r->store->components[c].def.name;
}

// Append up to the capacity.
static void explain_append( char* text, size_t size, const char* more )
{
    const size_t length = strlen( text );
    snprintf( text + length, size - length, "%s", more );
}

// ---- why a pass is selected ----

static bool is_requested( const wisp_registry* r, wisp_component c )
{
    bool requested = false;
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        requested = requested || store_mask_has( &r->store->entities[slot].requests, c );
    }
    return requested;
}

static bool is_reader( const plan* p, const wisp_registry* r, int number, const wisp_pass* of, wisp_component c )
{
    return store_mask_has( &p->live, number ) && r->passes + number != of &&
           store_mask_has( &r->uses[number].reads, c );
}

// List what requests the writes of a pass, component by component: the scene first, then readers in declaration
// order.
// @param out null to count only
// @return number of reasons
static int explain_find_reasons( const plan* p, const wisp_registry* r, const wisp_pass* pass, wisp_plan_reason* out )
{
    int count = 0;
    for ( int i = 0; i < WISP_MAX_USES && pass->writes[i] != 0; ++i )
    {
        const wisp_component c = pass->writes[i];
        for ( int k = -1; k < r->pass_count; ++k )
        {
            if ( k < 0 ? is_requested( r, c ) : is_reader( p, r, k, pass, c ) )
            {
                if ( out != NULL )
                {
                    out[count] = ( wisp_plan_reason ){ explain_name( r, c ), k < 0 ? NULL : r->passes[k].name };
                }
                ++count;
            }
        }
    }
    return count;
}

// Append the readers among the reasons [first, end). Of many only the last are listed, which are nearest to the
// request.
static void append_readers( wisp_plan_pass* p, int first, int end )
{
    enum
    {
        NAMED = 3,
    };
    const size_t size = sizeof( p->because );
    const int unnamed = end - first > NAMED ? end - first - NAMED : 0;
    explain_append( p->because, size, "read by " );
    for ( int i = first + unnamed; i < end; ++i )
    {
        const bool is_last = i + 1 == end && unnamed == 0;
        explain_append( p->because, size, i == first + unnamed ? "" : is_last ? " and " : ", " );
        explain_append( p->because, size, p->reasons[i].reader );
    }
    if ( unnamed > 0 )
    {
        char more[48];
        snprintf( more, sizeof( more ), " and %d other%s", unnamed, unnamed == 1 ? "" : "s" );
        explain_append( p->because, size, more );
    }
}

// Reasons of one component are consecutive, with a request of the scene first.
static void explain_reasons( wisp_plan_pass* p )
{
    const size_t size = sizeof( p->because );
    for ( int i = 0, end; i < p->reason_count; i = end )
    {
        for ( end = i; end < p->reason_count && p->reasons[end].component == p->reasons[i].component; ++end )
        {
        }
        const bool is_requested = p->reasons[i].reader == NULL;
        explain_append( p->because, size, i > 0 ? "; " : "" );
        explain_append( p->because, size, p->reasons[i].component );
        explain_append( p->because, size, is_requested ? " requested by the scene" : " " );
        if ( is_requested == false || end - i > 1 )
        {
            explain_append( p->because, size, is_requested ? " and " : "" );
            append_readers( p, is_requested ? i + 1 : i, end );
        }
    }
}

// ---- why a pass is absent ----

// Components of an entity that passes may require; rows that only a pass fills do not count.
static store_mask source_components( const store_entity* e )
{
    return e->alive ? store_mask_and_not( e->components, e->derived ) : ( store_mask ){ { 0 } };
}

static store_mask sources_of_all( const wisp_registry* r )
{
    store_mask anybody_has = { { 0 } };
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        anybody_has = store_mask_or( anybody_has, source_components( r->store->entities + slot ) );
    }
    return anybody_has;
}

// @param missing components that the pass requires and no entity has
static wisp_plan_state state_of( const wisp_registry* r, const wisp_pass* pass, store_mask missing )
{
    const plan_uses* uses = r->uses + ( pass - r->passes );
    bool suits = false, is_free = false;
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        const store_entity* e = r->store->entities + slot;
        const bool has_all = e->alive && store_mask_holds( source_components( e ), uses->required );
        suits = suits || has_all;
        is_free = is_free || ( has_all && store_mask_meets( uses->excluded, source_components( e ) ) == false );
    }
    if ( store_mask_any( missing ) )
    {
        return WISP_PLAN_MISSING;
    }
    // a pass without required components suits every entity; in a world without entities it counts as unrequested
    if ( is_free || ( suits == false && store_mask_any( uses->required ) == false ) )
    {
        return WISP_PLAN_UNREQUESTED;
    }
    return suits ? WISP_PLAN_EXCLUDED : WISP_PLAN_SPLIT;
}

// Append " X", or "s X, Y and Z" of several names.
static void append_list( wisp_plan_pass* p, const char* const* names )
{
    explain_append( p->because, sizeof( p->because ), names[0] != NULL && names[1] != NULL ? "s " : " " );
    for ( int i = 0; names[i] != NULL; ++i )
    {
        explain_append( p->because, sizeof( p->because ), i == 0 ? "" : names[i + 1] == NULL ? " and " : ", " );
        explain_append( p->because, sizeof( p->because ), names[i] );
    }
}

// Find why a pass is absent, as state, list and text.
// @param out has its own lists already
static void explain_absence( const wisp_registry* r, const wisp_pass* pass, store_mask missing, wisp_plan_pass* out )
{
    for ( int i = 0, count = 0; i < WISP_MAX_USES && pass->required[i] != 0; ++i )
    {
        if ( store_mask_has( &missing, pass->required[i] ) )
        {
            out->missing[count++] = explain_name( r, pass->required[i] );
        }
    }
    static const struct
    {
        const char *before, *after;
    } WORDS[] = {
        [WISP_PLAN_MISSING] = { "needs component", ", which no entity has" },
        [WISP_PLAN_SPLIT] = { "needs component", ", which no single entity has together" },
        [WISP_PLAN_EXCLUDED] = { "excluded by component", "" },
        [WISP_PLAN_UNREQUESTED] = { "neither requested nor read: component", "" },
    };
    out->state = state_of( r, pass, missing );
    const char* const first_write[] = { out->writes[0], NULL };
    const char* const* lists[] = {
        [WISP_PLAN_MISSING] = out->missing,
        [WISP_PLAN_SPLIT] = out->required,
        [WISP_PLAN_EXCLUDED] = out->excluded,
        [WISP_PLAN_UNREQUESTED] = first_write,
    };
    explain_append( out->because, sizeof( out->because ), WORDS[out->state].before );
    append_list( out, lists[out->state] );
    explain_append( out->because, sizeof( out->because ), WORDS[out->state].after );
}

// ---- text ----

// The plan as text: section, name and reason of each pass.

void wisp_plan_info_text( const wisp_plan_info* report, char* out, size_t size )
{
    if ( report == NULL || out == NULL )
    {
        return;
    }
    snprintf( out, size, "plan %016llx: %d passes in %d nodes and %d waves, %s", (unsigned long long)report->hash,
              report->active_count, report->node_count, report->wave_count,
              report->has_substep_loop ? "with a substep loop" : "no substep loop" );
}

void wisp_plan_pass_text( const wisp_plan_pass* pass, char* out, size_t size )
{
    if ( pass == NULL || out == NULL )
    {
        return;
    }
    if ( pass->state == WISP_PLAN_ACTIVE )
    {
        const bool is_joined = pass->fusion != NULL;
        snprintf( out, size, "  %-11s wave %d  %-24s %s%s%s%s%s", pass->loop, pass->wave, pass->name,
                  pass->is_fused ? "(fused) " : "", is_joined ? "(in " : "", is_joined ? pass->fusion : "",
                  is_joined ? ") " : "", pass->because );
    }
    else
    {
        snprintf( out, size, "  absent              %-24s %s", pass->name, pass->because );
    }
}

void plan_print( const wisp_plan_info* report, void ( *write )( void* user, const char* line ), void* user )
{
    char line[512];
    wisp_plan_info_text( report, line, sizeof( line ) );
    write( user, line );
    for ( int i = 0; i < report->pass_count; ++i )
    {
        wisp_plan_pass_text( report->passes + i, line, sizeof( line ) );
        write( user, line );
    }
}

// ---- explain ----

_Static_assert( WISP_PLAN_USES == WISP_MAX_USES, "explain.h and module.h count the same lists" );

// The report and all data it points to are one block of memory.
typedef struct report_block
{
    wisp_plan_info report;
    const wisp_allocator* allocator;
    size_t size;
} report_block;

typedef struct writer
{
    const plan* plan;
    const wisp_registry* registry;
    store_mask sources; // of all entities
    wisp_plan_pass* passes;
    wisp_plan_module* modules;
    wisp_plan_reason* reasons;
    int reason_count;
    int substeps, iterations;
} writer;

// Return what a pass requires and no entity has.
static store_mask missing_of( const writer* w, int number )
{
    return store_mask_and_not( w->registry->uses[number].required, w->sources );
}

static bool is_live( const writer* w, int number )
{
    return store_mask_has( &w->plan->live, number );
}

static void fill_names( const writer* w, const wisp_component* uses, const char** names )
{
    for ( int i = 0; i < WISP_MAX_USES && uses[i] != 0; ++i )
    {
        names[i] = explain_name( w->registry, uses[i] );
    }
}

// ---- predicted cost ----

// Bytes of the rows of these components in an entity.
static uint64_t row_bytes( const store* s, const store_entity* e, const wisp_component* uses )
{
    uint64_t bytes = 0;
    for ( int i = 0; i < WISP_MAX_USES && uses[i] != 0; ++i )
    {
        const wisp_component_def* def = &s->components[uses[i]].def;
        for ( int k = 0; k < def->column_count && store_mask_has( &e->components, uses[i] ); ++k )
        {
            bytes += (uint64_t)e->rows[def->table].count * def->columns[k].row_size;
        }
    }
    return bytes;
}

// A pass over several entities may touch any of them.
static uint64_t across_bytes( const store* s, const wisp_pass* pass )
{
    uint64_t bytes = 0;
    for ( int slot = 0; slot < s->entity_count; ++slot )
    {
        const store_entity* e = s->entities + slot;
        bytes += e->alive ? 2 * row_bytes( s, e, pass->foreign ) : 0;
    }
    return bytes;
}

// Runs on an entity in a step of usual length.
static int runs_on( const writer* w, wisp_stage stage, int slot )
{
    const int rate = plan_rate( w->plan->entities + slot, w->registry ), iterations = w->iterations;
    const int substeps = plan_substeps_of_rate( w->registry, rate, w->substeps );
    switch ( plan_section_of( stage ) )
    {
        case PLAN_SUBSTEP:
        case PLAN_AFTER_ITERATION:
            return substeps;
        case PLAN_ITERATION:
            return substeps * iterations;
        default:
            return 1;
    }
}

static void count_work( const writer* w, const plan_node* node, int i, wisp_plan_pass* p )
{
    const store* s = w->registry->store;
    const wisp_pass* pass = w->registry->passes + node->passes[i];
    for ( int k = 0; k < node->target_count; ++k )
    {
        const plan_target* target = w->plan->targets + node->first_target + k;
        if ( ( target->passes >> i & 1 ) != 0 )
        {
            const store_entity* e = s->entities + target->slot;
            const int items = plan_item_count( e, node->domain );
            p->entities += 1;
            if ( target->join >= 0 && w->iterations == 1 )
            {
                p->fusion = w->registry->joins[target->join].name;
                p->fusion_code = (uintptr_t)w->registry->joins[target->join].run;
            }
            const int runs = runs_on( w, pass->stage, target->slot );
            p->runs = runs > p->runs ? runs : p->runs;
            p->fewest_runs = p->entities == 1 || runs < p->fewest_runs ? runs : p->fewest_runs;
            p->items += items;
            const bool loops = k >= node->wave_target_count;
            p->blocks += loops ? 1 : ( items + node->grain - 1 ) / node->grain;
            const uint64_t bytes =
                row_bytes( s, e, pass->reads ) + row_bytes( s, e, pass->writes ) + across_bytes( s, pass );
            p->bytes += bytes;
            p->fraction += (double)bytes * runs; // of the sum of all passes, in the end
        }
    }
}

static void predict_fractions( wisp_plan_info* report, wisp_plan_pass* passes )
{
    double sum = 0.0;
    for ( int i = 0; i < report->active_count; ++i )
    {
        sum += passes[i].fraction;
    }
    for ( int i = 0; i < report->active_count; ++i )
    {
        passes[i].fraction = sum > 0.0 ? passes[i].fraction / sum : 1.0 / report->active_count;
    }
}

// ---- passes ----

static wisp_plan_pass* begin_pass( writer* w, wisp_plan_info* report, int number )
{
    static const char* const STAGES[WISP_STAGE_COUNT] = { "input",    "force", "predict", "contact", "project",
                                                          "velocity", "check", "derive",  "shape",   "observe" };
    static const char* const DOMAINS[] = { "entity", "strand group", "particle block" };
    const wisp_pass* pass = w->registry->passes + number;
    wisp_plan_pass* p = w->passes + report->pass_count++;
    *p = ( wisp_plan_pass ){
        .name = pass->name,
        .module = w->registry->pass_modules[number],
        .stage = STAGES[pass->stage],
        .domain = DOMAINS[pass->domain],
        .code = (uintptr_t)pass->run,
        .wave = -1,
        .node = -1,
        .fraction = (double)NAN,
        .reasons = w->reasons + w->reason_count,
    };
    fill_names( w, pass->required, p->required );
    fill_names( w, pass->excluded, p->excluded );
    fill_names( w, pass->reads, p->reads );
    fill_names( w, pass->writes, p->writes );
    fill_names( w, pass->foreign, p->foreign );
    return p;
}

static void add_kept( writer* w, wisp_plan_info* report, int n, int i )
{
    static const char* const LOOPS[PLAN_SECTION_COUNT] = { "before",      "substep",   "iteration",
                                                           "substep end", "item loop", "after" };
    const plan_node* node = w->plan->nodes + n;
    const wisp_pass* pass = w->registry->passes + node->passes[i];
    wisp_plan_pass* p = begin_pass( w, report, node->passes[i] );
    p->state = WISP_PLAN_ACTIVE;
    p->loop = LOOPS[node->section];
    p->wave = node->wave;
    p->node = n;
    p->is_fused = i > 0;
    p->fraction = 0.0;
    count_work( w, node, i, p );
    p->reason_count = explain_find_reasons( w->plan, w->registry, pass, w->reasons + w->reason_count );
    w->reason_count += p->reason_count;
    explain_reasons( p );
}

static void add_kept_in_order( writer* w, wisp_plan_info* report )
{
    const plan* p = w->plan;
    for ( int section = 0; section < PLAN_SECTION_COUNT; ++section )
    {
        for ( int wave = 0; wave < p->wave_count[section]; ++wave )
        {
            for ( int n = 0; n < p->node_count; ++n )
            {
                const bool is_here =
                    (int)p->nodes[n].section == section && p->nodes[n].wave == wave && p->nodes[n].repeats == false;
                for ( int i = 0; is_here && i < p->nodes[n].pass_count; ++i )
                {
                    add_kept( w, report, n, i );
                }
            }
        }
    }
}

static void add_absent( writer* w, wisp_plan_info* report, int number )
{
    const wisp_pass* pass = w->registry->passes + number;
    wisp_plan_pass* p = begin_pass( w, report, number );
    explain_absence( w->registry, pass, missing_of( w, number ), p );
}

// ---- modules ----

// Find the component that most passes of a module require and no entity has.
static wisp_component max_missed( const writer* w, const char* module )
{
    wisp_component most = 0;
    for ( int c = 1, highest = 0; c < w->registry->store->component_count; ++c )
    {
        int count = 0;
        for ( int i = 0; i < w->registry->pass_count; ++i )
        {
            if ( w->registry->pass_modules[i] == module )
            {
                const store_mask missing = missing_of( w, i );
                count += store_mask_has( &missing, c ) ? 1 : 0;
            }
        }
        most = count > highest ? (wisp_component)c : most;
        highest = count > highest ? count : highest;
    }
    return most;
}

// Set the reason of a module to that of its pass that is closest to being active.
static void explain_module( const writer* w, const wisp_plan_info* report, wisp_plan_module* m )
{
    const wisp_plan_pass* nearest = NULL;
    for ( int i = 0; i < report->pass_count; ++i )
    {
        const wisp_plan_pass* p = w->passes + i;
        const bool is_nearer = nearest == NULL || p->state > nearest->state;
        nearest = p->module == m->name && is_nearer ? p : nearest;
    }
    if ( nearest->state == WISP_PLAN_MISSING )
    {
        m->missing = explain_name( w->registry, max_missed( w, m->name ) );
        snprintf( m->because, sizeof( m->because ), "needs component %s, which no entity has", m->missing );
    }
    else
    {
        snprintf( m->because, sizeof( m->because ), "%s: %s", nearest->name, nearest->because );
    }
}

// The passes of a module are consecutive in the registry.
static void add_modules( writer* w, wisp_plan_info* report )
{
    for ( int i = 0; i < w->registry->pass_count; ++i )
    {
        const char* name = w->registry->pass_modules[i];
        if ( report->module_count == 0 || w->modules[report->module_count - 1].name != name )
        {
            w->modules[report->module_count++] = ( wisp_plan_module ){ .name = name };
        }
        wisp_plan_module* m = w->modules + report->module_count - 1;
        m->pass_count += 1;
        m->active_count += is_live( w, i ) ? 1 : 0;
    }
    for ( int i = 0; i < report->module_count; ++i )
    {
        if ( w->modules[i].active_count == 0 )
        {
            explain_module( w, report, w->modules + i );
        }
    }
}

// ---- the report ----

static int count_reasons( const writer* w )
{
    int count = 0;
    for ( int i = 0; i < w->registry->pass_count; ++i )
    {
        count += is_live( w, i ) ? explain_find_reasons( w->plan, w->registry, w->registry->passes + i, NULL ) : 0;
    }
    return count;
}

static report_block* make_block( writer* w )
{
    const wisp_registry* r = w->registry;
    const size_t passes = (size_t)r->pass_count * sizeof( wisp_plan_pass );
    const size_t modules = (size_t)r->pass_count * sizeof( wisp_plan_module );
    const size_t reasons = (size_t)count_reasons( w ) * sizeof( wisp_plan_reason );
    const size_t size = sizeof( report_block ) + passes + modules + reasons;
    report_block* block = base_allocate( r->store->allocator, size, 64 );
    if ( block == NULL )
    {
        return NULL;
    }
    *block = ( report_block ){ .allocator = r->store->allocator, .size = size };
    w->passes = (void*)( block + 1 );
    w->modules = (void*)( (char*)w->passes + passes );
    w->reasons = (void*)( (char*)w->modules + modules );
    return block;
}

wisp_plan_info* plan_explain( const plan* p, const wisp_registry* r, int substeps, int iterations )
{
    writer w = { p, r, sources_of_all( r ), .substeps = substeps, .iterations = iterations };
    report_block* block = make_block( &w );
    if ( block == NULL )
    {
        return NULL;
    }
    wisp_plan_info* report = &block->report;
    *report = ( wisp_plan_info ){
        .hash = p->hash,
        .active_count = p->pass_count,
        .node_count = p->node_count,
        .substeps = substeps,
        .iterations = iterations,
        .has_substep_loop = p->wave_count[PLAN_SUBSTEP] + p->wave_count[PLAN_ITERATION] +
                                p->wave_count[PLAN_AFTER_ITERATION] + p->wave_count[PLAN_ITEM_LOOP] >
                            0,
        .passes = w.passes,
        .modules = w.modules,
    };
    for ( int section = 0; section < PLAN_SECTION_COUNT; ++section )
    {
        report->wave_count += p->wave_count[section];
    }
    add_kept_in_order( &w, report );
    for ( int i = 0; i < r->pass_count; ++i )
    {
        if ( is_live( &w, i ) == false )
        {
            add_absent( &w, report, i );
        }
    }
    predict_fractions( report, w.passes );
    add_modules( &w, report );
    return report;
}

void wisp_plan_info_release( wisp_plan_info* report )
{
    if ( report != NULL )
    {
        report_block* block = (report_block*)(void*)report;
        base_release( block->allocator, block, block->size );
    }
}
