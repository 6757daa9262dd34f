#include "plan.h"

#include "alloc.h"
#include "wisp/module/components.h"

#include <string.h>

// Descriptors of the components that every world has, generated from one list.
#define SHARED_COLUMNS( name, text, table )                                                                          \
    static const wisp_column_def name##_columns[] = { WISP_##name##_COLUMNS( WISP_COLUMN_DEF ) };
WISP_SHARED_COMPONENTS( SHARED_COLUMNS )
#undef SHARED_COLUMNS

#define SHARED_COMPONENT( name, text, table ) { text, table, name##_columns, WISP_COUNT( name##_columns ) },
static const wisp_component_def SHARED[] = { WISP_SHARED_COMPONENTS( SHARED_COMPONENT ) };
#undef SHARED_COMPONENT

_Static_assert( WISP_COUNT( SHARED ) == WISP_SHARED_COMPONENT_COUNT - 1, "wisp.h and components.h list the same" );

static wisp_component fail_declaration( wisp_registry* r, const char* what, const char* name )
{
    if ( r->error.status == WISP_OK )
    {
        wisp_fail( &r->error, WISP_BAD_INPUT, "module '%s': %s '%s'", r->module, what, name );
    }
    return 0;
}

wisp_component wisp_declare_component( wisp_registry* registry, const wisp_component_def* def )
{
    wisp_component c = store_declare( registry->store, def );
    return c != 0 ? c
                  : fail_declaration( registry,
                                      "too many components, or declared differently by another module:", def->name );
}

wisp_status wisp_declare_indices( wisp_registry* registry, const wisp_index_range* ranges, int count )
{
    if ( store_declare_ranges( registry->store, ranges, count ) == false )
    {
        fail_declaration( registry, "too many ranges of", "indices" );
        return WISP_BAD_INPUT;
    }
    return WISP_OK;
}

store_mask plan_mask( const wisp_component* uses )
{
    store_mask mask = { { 0 } };
    for ( int i = 0; i < WISP_MAX_USES && uses[i] != 0; ++i )
    {
        store_mask_add( &mask, uses[i] );
    }
    return mask;
}

static plan_uses uses_of( const wisp_pass* pass )
{
    plan_uses u = { .required = plan_mask( pass->required ),
                    .excluded = plan_mask( pass->excluded ),
                    .reads = plan_mask( pass->reads ),
                    .writes = plan_mask( pass->writes ),
                    .foreign = plan_mask( pass->foreign ) };
    u.changes = store_mask_or( u.writes, u.foreign );
    u.touched = store_mask_or( u.reads, u.writes );
    u.produced = store_mask_and_not( u.writes, u.reads );
    return u;
}

static wisp_status declare_pass( wisp_registry* registry, const wisp_pass* pass )
{
    for ( int i = 0; i < registry->pass_count; ++i )
    {
        if ( strcmp( registry->passes[i].name, pass->name ) == 0 )
        {
            fail_declaration( registry, "got a second pass", pass->name );
            return WISP_BAD_INPUT;
        }
    }
    if ( registry->pass_count == PLAN_MAX_PASSES || pass->run == NULL || pass->writes[0] == 0 )
    {
        fail_declaration( registry, "too many passes, or a pass without a function or an output:", pass->name );
        return WISP_BAD_INPUT;
    }
    if ( pass->on_change != 0 )
    {
        store_mask_add( registry->store->watchers + pass->on_change, registry->pass_count );
    }
    for ( int i = 0; i < WISP_MAX_USES && pass->writes[i] != 0; ++i )
    {
        store_mask_add( registry->store->writers + pass->writes[i], registry->pass_count );
    }
    registry->store->passes = store_hash_bytes( registry->store->passes, pass->name, strlen( pass->name ) );
    registry->pass_modules[registry->pass_count] = registry->module;
    registry->uses[registry->pass_count] = uses_of( pass );
    registry->passes[registry->pass_count++] = *pass;
    return WISP_OK;
}

wisp_status wisp_declare_passes( wisp_registry* registry, const wisp_pass* passes, int count, void* user )
{
    for ( int i = 0; i < count; ++i )
    {
        wisp_pass pass = passes[i];
        pass.user = pass.user != NULL ? pass.user : user;
        WISP_TRY( declare_pass( registry, &pass ) );
    }
    return WISP_OK;
}

// Return the number of a declared pass, or that behind the last one.
static int number_of( const wisp_registry* r, const char* name )
{
    int i = 0;
    while ( i < r->pass_count && strcmp( r->passes[i].name, name ) != 0 )
    {
        i += 1;
    }
    return i;
}

// Resolve the components.
// @return false if one of them was not declared
static bool find_passes( const wisp_registry* r, const char* const* names, store_mask* passes )
{
    bool found = true;
    for ( int n = 0; n < WISP_MAX_FUSED && names[n] != NULL; ++n )
    {
        const int i = number_of( r, names[n] );
        found = found && i < r->pass_count;
        if ( i < r->pass_count )
        {
            store_mask_add( passes, i );
        }
    }
    return found;
}

wisp_status wisp_declare_fusion( wisp_registry* registry, const wisp_fusion* join )
{
    plan_fusion f = { .name = join->name, .run = join->run, .user = join->user };
    const bool found =
        find_passes( registry, join->required, &f.required ) && find_passes( registry, join->allowed, &f.allows );
    if ( found == false || store_mask_any( f.required ) == false || f.run == NULL ||
         registry->join_count == PLAN_MAX_FUSIONS )
    {
        fail_declaration( registry, "too many fusions, or one without declared passes:", join->name );
        return WISP_BAD_INPUT;
    }
    registry->joins[registry->join_count++] = f;
    return WISP_OK;
}

// Append the numbers of declared passes.
static void list_passes( const wisp_registry* r, const char* const* names, plan_batch* batch )
{
    for ( int n = 0; n < WISP_MAX_FUSED && names[n] != NULL; ++n )
    {
        batch->passes[batch->pass_count++] = (uint16_t)number_of( r, names[n] );
    }
}

wisp_status wisp_declare_batch( wisp_registry* registry, const wisp_batch* batch )
{
    plan_batch b = { .pass = batch->pass != NULL ? number_of( registry, batch->pass ) : -1,
                     .lanes = batch->lanes,
                     .can_join = batch->can_join,
                     .run = batch->run,
                     .run_pass = batch->run_pass,
                     .user = batch->user };
    const bool found =
        find_passes( registry, batch->required, &b.required ) && find_passes( registry, batch->allowed, &b.allowed );
    if ( found == false || store_mask_any( b.required ) == false || batch->run == NULL || batch->can_join == NULL ||
         batch->lanes < 2 || batch->lanes > WISP_MAX_BATCH || registry->batch_count == PLAN_MAX_BATCHES ||
         ( batch->pass == NULL ) != ( batch->run_pass == NULL ) || b.pass == registry->pass_count ||
         ( b.pass >= 0 && store_mask_has( &b.required, b.pass ) == false ) )
    {
        fail_declaration( registry, "too many batches, or one without declared passes:", batch->name );
        return WISP_BAD_INPUT;
    }
    list_passes( registry, batch->required, &b );
    list_passes( registry, batch->allowed, &b );
    registry->batches[registry->batch_count++] = b;
    return WISP_OK;
}

void wisp_declare_map( wisp_registry* registry, wisp_component map, wisp_component component, const char* refusal )
{
    if ( registry->map_count == PLAN_MAX_MAPS )
    {
        fail_declaration( registry, "too many maps:", registry->module );
        return;
    }
    registry->maps[registry->map_count++] = ( plan_map ){ map, component, refusal };
}

void wisp_declare_places( wisp_registry* registry, wisp_component component, int column, wisp_place_shape shape )
{
    if ( registry->place_count == PLAN_MAX_PLACES )
    {
        fail_declaration( registry, "too many columns of places:", registry->module );
        return;
    }
    registry->places[registry->place_count++] = ( plan_place_column ){ component, column, shape, 0, 0 };
}

void wisp_declare_low( wisp_registry* registry, wisp_component component, int column, wisp_component low,
                       int low_column )
{
    for ( int i = 0; i < registry->place_count; ++i )
    {
        plan_place_column* place = registry->places + i;
        const bool is_it = place->component == component && place->column == column;
        place->low = is_it ? low : place->low;
        place->low_column = is_it ? low_column : place->low_column;
    }
}

void* wisp_declare_state( wisp_registry* registry, size_t size )
{
    void* memory =
        registry->state_count < PLAN_MAX_STATES ? base_allocate( registry->store->allocator, size, 64 ) : NULL;
    if ( memory == NULL )
    {
        wisp_fail( &registry->error, WISP_NO_MEMORY, "module '%s': out of memory for its state", registry->module );
        return NULL;
    }
    memset( memory, 0, size );
    registry->states[registry->state_count++] =
        ( plan_state ){ .module = registry->module, .memory = memory, .size = size };
    return memory;
}

// Find the state of the module that declares hooks of it.
static plan_state* find_own_state( wisp_registry* registry )
{
    plan_state* state = registry->state_count > 0 ? registry->states + registry->state_count - 1 : NULL;
    if ( state == NULL || strcmp( state->module, registry->module ) != 0 )
    {
        fail_declaration( registry, "got hooks without a state for", registry->module );
        return NULL;
    }
    return state;
}

void wisp_declare_hooks( wisp_registry* registry, const wisp_state_hooks* hooks )
{
    plan_state* state = find_own_state( registry );
    if ( state != NULL )
    {
        state->hooks = *hooks;
    }
}

void wisp_declare_sleep( wisp_registry* registry, const wisp_sleep_hooks* hooks )
{
    plan_state* state = find_own_state( registry );
    if ( state != NULL )
    {
        state->sleep = *hooks;
    }
}

void wisp_declare_detail( wisp_registry* registry, const wisp_detail_hooks* hooks )
{
    plan_state* state = find_own_state( registry );
    if ( state != NULL )
    {
        state->detail = *hooks;
    }
}

wisp_component wisp_detail_component( wisp_registry* registry )
{
    return registry->detail;
}

int wisp_declare_workspace( wisp_registry* registry, size_t size,
                            void ( *release )( void* workspace, const wisp_allocator* allocator ),
                            size_t ( *memory )( const void* workspace ) )
{
    size_t padded = ( size + 63 ) & ~(size_t)63, bytes = padded * (size_t)registry->workers;
    void* blocks = registry->workspace_count < PLAN_MAX_WORKSPACES
                       ? base_allocate( registry->store->allocator, bytes, 64 )
                       : NULL;
    if ( blocks == NULL )
    {
        wisp_fail( &registry->error, WISP_NO_MEMORY, "module '%s': out of memory for its workspace",
                   registry->module );
        return -1;
    }
    memset( blocks, 0, bytes );
    registry->workspaces[registry->workspace_count] =
        ( plan_workspace ){ registry->module, padded, release, memory, blocks };
    return registry->workspace_count++;
}

int wisp_registry_iterations( const wisp_registry* registry )
{
    return registry->iterations > 1 ? registry->iterations : 1;
}

void plan_registry_init( wisp_registry* r, store* s, int workers )
{
    *r = ( wisp_registry ){ .store = s, .workers = workers, .module = "wisp" };
    for ( int i = 0; i < WISP_COUNT( SHARED ); ++i )
    {
        wisp_declare_component( r, SHARED + i );
    }
    s->transient = store_bit( WISP_STRAND_PREVIOUS );
}

void plan_registry_release( wisp_registry* r )
{
    const wisp_allocator* allocator = r->store->allocator;
    for ( int i = 0; i < r->workspace_count; ++i )
    {
        plan_workspace* w = r->workspaces + i;
        for ( int worker = 0; worker < r->workers && w->release != NULL; ++worker )
        {
            w->release( (char*)w->blocks + (size_t)worker * w->size, allocator );
        }
        base_release( allocator, w->blocks, w->size * (size_t)r->workers );
    }
    for ( int i = 0; i < r->state_count; ++i )
    {
        if ( r->states[i].hooks.release != NULL )
        {
            r->states[i].hooks.release( r->states[i].memory, allocator );
        }
        base_release( allocator, r->states[i].memory, r->states[i].size );
    }
}

size_t plan_registry_memory( const wisp_registry* r, int state, size_t* held, size_t* outside )
{
    const plan_state* s = r->states + state;
    size_t bytes = s->size;
    *held = s->hooks.memory != NULL ? s->hooks.memory( s->memory, outside ) : 0;
    for ( int i = 0; i < r->workspace_count; ++i )
    {
        const plan_workspace* w = r->workspaces + i;
        if ( strcmp( w->module, s->module ) != 0 )
        {
            continue;
        }
        bytes += w->size * (size_t)r->workers;
        for ( int worker = 0; worker < r->workers && w->memory != NULL; ++worker )
        {
            *held += w->memory( (const char*)w->blocks + (size_t)worker * w->size );
        }
    }
    return bytes + *held;
}

wisp_status plan_registry_planning( const wisp_registry* r, wisp_world* world )
{
    for ( int i = 0; i < r->state_count; ++i )
    {
        WISP_TRY( r->states[i].hooks.planning != NULL ? r->states[i].hooks.planning( r->states[i].memory, world )
                                                      : WISP_OK );
    }
    return WISP_OK;
}

void plan_registry_planned( const wisp_registry* r, wisp_world* world )
{
    for ( int i = 0; i < r->state_count; ++i )
    {
        if ( r->states[i].hooks.planned != NULL )
        {
            r->states[i].hooks.planned( r->states[i].memory, world );
        }
    }
}

void plan_registry_removed( const wisp_registry* r, wisp_world* world, wisp_entity entity )
{
    for ( int i = 0; i < r->state_count; ++i )
    {
        if ( r->states[i].hooks.removed != NULL )
        {
            r->states[i].hooks.removed( r->states[i].memory, world, entity );
        }
    }
}

wisp_status plan_registry_triangles_changed( const wisp_registry* r, wisp_world* world, wisp_entity surface,
                                             const wisp_fabric* before )
{
    for ( int i = 0; i < r->state_count; ++i )
    {
        if ( r->states[i].hooks.triangles_changed != NULL )
        {
            WISP_TRY( r->states[i].hooks.triangles_changed( r->states[i].memory, world, surface, before ) );
        }
    }
    return WISP_OK;
}

wisp_status plan_registry_teleported( const wisp_registry* r, wisp_world* world, wisp_entity entity,
                                      const wisp_teleport_motion* teleport, bool* is_moved )
{
    for ( int i = 0; i < r->state_count; ++i )
    {
        if ( r->states[i].hooks.teleported != NULL )
        {
            WISP_TRY( r->states[i].hooks.teleported( r->states[i].memory, world, entity, teleport, is_moved ) );
        }
    }
    return WISP_OK;
}

bool plan_registry_surroundings( const wisp_registry* r, wisp_world* world, wisp_entity entity,
                                 const wisp_sleep_bounds* bounds, uint64_t* hash )
{
    bool rests = true;
    *hash = 0;
    for ( int i = 0; i < r->state_count && rests; ++i )
    {
        const plan_state* s = r->states + i;
        rests = s->sleep.surroundings == NULL || s->sleep.surroundings( s->memory, world, entity, bounds, hash );
    }
    return rests;
}

float plan_registry_reach( const wisp_registry* r, wisp_world* world, wisp_entity entity )
{
    float reach = -1.0f;
    for ( int i = 0; i < r->state_count; ++i )
    {
        const plan_state* s = r->states + i;
        const float of_module = s->sleep.reach != NULL ? s->sleep.reach( s->memory, world, entity ) : -1.0f;
        reach = of_module > reach ? of_module : reach;
    }
    return reach;
}

void plan_registry_rested( const wisp_registry* r, wisp_world* world, wisp_entity entity )
{
    for ( int i = 0; i < r->state_count; ++i )
    {
        if ( r->states[i].sleep.rested != NULL )
        {
            r->states[i].sleep.rested( r->states[i].memory, world, entity );
        }
    }
}

bool plan_registry_has_coarse( const wisp_registry* r, const wisp_world* world, wisp_entity entity )
{
    bool found = false;
    for ( int i = 0; i < r->state_count; ++i )
    {
        const plan_state* s = r->states + i;
        found = found || ( s->detail.has_coarse != NULL && s->detail.has_coarse( s->memory, world, entity ) );
    }
    return found;
}

wisp_status plan_registry_prepare_detail( const wisp_registry* r, wisp_world* world, wisp_entity entity )
{
    for ( int i = 0; i < r->state_count; ++i )
    {
        const plan_state* s = r->states + i;
        WISP_TRY( s->detail.prepare != NULL ? s->detail.prepare( s->memory, world, entity ) : WISP_OK );
    }
    return WISP_OK;
}

void plan_registry_detail_changed( const wisp_registry* r, wisp_world* world, wisp_entity entity, wisp_detail from,
                                   wisp_detail to )
{
    for ( int i = 0; i < r->state_count; ++i )
    {
        if ( r->states[i].detail.changed != NULL )
        {
            r->states[i].detail.changed( r->states[i].memory, world, entity, from, to );
        }
    }
}

wisp_status plan_registry_add( wisp_registry* r, const wisp_module* module )
{
    r->module = module->name;
    wisp_status status = module->declare( r );
    if ( status != WISP_OK && r->error.status == WISP_OK )
    {
        wisp_fail( &r->error, status, "module '%s': declaration failed: %s", module->name,
                   wisp_status_name( status ) );
    }
    return r->error.status;
}

void* plan_registry_state( const wisp_registry* r, const char* module )
{
    for ( int i = 0; i < r->state_count; ++i )
    {
        if ( strcmp( r->states[i].module, module ) == 0 )
        {
            return r->states[i].memory;
        }
    }
    return NULL;
}
