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

// Make room for one pass more.
static bool reserve_pass( wisp_registry* r )
{
    const size_t count = (size_t)r->pass_count + 1;
    const size_t sizes[3] = { sizeof( *r->passes ), sizeof( *r->uses ), sizeof( *r->pass_modules ) };
    bool enough = true;
    for ( int i = 0; i < 3; ++i )
    {
        enough = enough && base_buffer_reserve( r->store->allocator, r->pass_rows + i, count * sizes[i] );
    }
    r->passes = r->pass_rows[0].data;
    r->uses = r->pass_rows[1].data;
    r->pass_modules = r->pass_rows[2].data;
    return enough;
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
    if ( reserve_pass( registry ) == false )
    {
        return wisp_fail( &registry->error, WISP_NO_MEMORY, "module '%s': out of memory for its passes",
                          registry->module );
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
    plan_batch b = { .pass = batch->pass != NULL ? number_of( registry, batch->pass ) : -1, .def = *batch };
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

// Find the state of the module that declares hooks of it; after a failure one that nobody reads.
static plan_state* find_own_state( wisp_registry* registry )
{
    plan_state* state = registry->state_count > 0 ? registry->states + registry->state_count - 1 : NULL;
    if ( state == NULL || strcmp( state->module, registry->module ) != 0 )
    {
        fail_declaration( registry, "got hooks without a state for", registry->module );
        return &registry->no_state;
    }
    return state;
}

void wisp_declare_hooks( wisp_registry* registry, const wisp_state_hooks* hooks )
{
    plan_state* state = find_own_state( registry );
    state->hooks = *hooks;
    state->sleep = hooks->sleep != NULL ? *hooks->sleep : state->sleep;
    state->detail = hooks->detail != NULL ? *hooks->detail : state->detail;
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

// ---- objects of entities ----

wisp_objects* wisp_declare_objects( wisp_registry* registry,
                                    void ( *release )( void* object, const wisp_allocator* allocator ),
                                    size_t ( *bytes )( const void* object ) )
{
    if ( registry->object_count == PLAN_MAX_OBJECTS )
    {
        fail_declaration( registry, "too many objects of", registry->module );
        return NULL;
    }
    wisp_objects* o = registry->objects + registry->object_count++;
    *o = ( wisp_objects ){ registry->module, registry->store->allocator, release, bytes, NULL, 0 };
    return o;
}

void* wisp_find_object( const wisp_objects* objects, wisp_entity entity )
{
    const int place = (int)entity.index - 1;
    const bool is_there =
        place >= 0 && place < objects->count && wisp_entity_equal( objects->places[place].entity, entity );
    return is_there ? objects->places[place].object : NULL;
}

bool wisp_reserve_object( wisp_objects* objects, wisp_entity entity )
{
    const int least = (int)entity.index, twice = 2 * objects->count, count = least > twice ? least : twice;
    const size_t size = sizeof( *objects->places );
    if ( least <= objects->count )
    {
        return true;
    }
    struct plan_object* grown = base_allocate( objects->allocator, (size_t)count * size, 64 );
    if ( grown == NULL )
    {
        return false;
    }
    memset( grown, 0, (size_t)count * size );
    if ( objects->count > 0 )
    {
        memcpy( grown, objects->places, (size_t)objects->count * size );
        base_release( objects->allocator, objects->places, (size_t)objects->count * size );
    }
    objects->places = grown;
    objects->count = count;
    return true;
}

void wisp_set_object( wisp_objects* objects, wisp_entity entity, void* object )
{
    if ( entity.index > 0 && (int)entity.index <= objects->count )
    {
        struct plan_object* place = objects->places + entity.index - 1;
        void* before = place->object;
        *place = ( struct plan_object ){ entity, object };
        if ( before != NULL )
        {
            objects->release( before, objects->allocator );
        }
    }
}

void* wisp_next_object( const wisp_objects* objects, int* place )
{
    void* object = NULL;
    while ( object == NULL && *place < objects->count )
    {
        object = objects->places[( *place )++].object;
    }
    return object;
}

bool wisp_next_entity( const wisp_registry* registry, wisp_component component, wisp_entity* entity )
{
    const store* s = registry->store;
    for ( int slot = (int)entity->index; slot < s->entity_count; ++slot )
    {
        const store_entity* e = s->entities + slot;
        if ( store_mask_has( &e->components, component ) && store_mask_has( &e->derived, component ) == false )
        {
            *entity = store_handle( s, slot );
            return true;
        }
    }
    return false;
}

static size_t object_bytes( const wisp_objects* o )
{
    size_t bytes = (size_t)o->count * sizeof( *o->places );
    for ( int i = 0; i < o->count; ++i )
    {
        bytes += o->places[i].object != NULL ? o->bytes( o->places[i].object ) : 0;
    }
    return bytes;
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
    for ( int i = 0; i < r->object_count; ++i )
    {
        wisp_objects* o = r->objects + i;
        for ( int place = 0; place < o->count; ++place )
        {
            if ( o->places[place].object != NULL )
            {
                o->release( o->places[place].object, allocator );
            }
        }
        base_release( allocator, o->places, (size_t)o->count * sizeof( *o->places ) );
    }
    for ( int i = 0; i < r->state_count; ++i )
    {
        if ( r->states[i].hooks.release != NULL )
        {
            r->states[i].hooks.release( r->states[i].memory, allocator );
        }
        base_release( allocator, r->states[i].memory, r->states[i].size );
    }
    for ( int i = 0; i < WISP_COUNT( r->pass_rows ); ++i )
    {
        base_buffer_release( allocator, r->pass_rows + i );
    }
}

size_t plan_registry_memory( const wisp_registry* r, int state, size_t* held, size_t* outside )
{
    const plan_state* s = r->states + state;
    size_t bytes = s->size;
    *held = s->hooks.memory != NULL ? s->hooks.memory( s->memory, outside ) : 0;
    for ( int i = 0; i < r->object_count; ++i )
    {
        *held += strcmp( r->objects[i].module, s->module ) == 0 ? object_bytes( r->objects + i ) : 0;
    }
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

// The states of the registry `r` that have a hook.
#define EACH_HOOK( hook )                                                                                            \
    for ( const plan_state* s = r->states; s < r->states + r->state_count; ++s )                                     \
        if ( s->hook != NULL )

wisp_status plan_registry_planning( const wisp_registry* r, wisp_world* world )
{
    EACH_HOOK( hooks.planning )
    {
        WISP_TRY( s->hooks.planning( s->memory, world ) );
    }
    return WISP_OK;
}

void plan_registry_planned( const wisp_registry* r, wisp_world* world )
{
    EACH_HOOK( hooks.planned )
    {
        s->hooks.planned( s->memory, world );
    }
}

void plan_registry_removed( wisp_registry* r, wisp_world* world, wisp_entity entity )
{
    EACH_HOOK( hooks.removed )
    {
        s->hooks.removed( s->memory, world, entity );
    }
    for ( int i = 0; i < r->object_count; ++i )
    {
        if ( wisp_find_object( r->objects + i, entity ) != NULL )
        {
            wisp_set_object( r->objects + i, entity, NULL );
        }
    }
}

wisp_status plan_registry_triangles_changed( const wisp_registry* r, wisp_world* world, wisp_entity surface,
                                             const wisp_fabric* before )
{
    EACH_HOOK( hooks.triangles_changed )
    {
        WISP_TRY( s->hooks.triangles_changed( s->memory, world, surface, before ) );
    }
    return WISP_OK;
}

wisp_status plan_registry_teleported( const wisp_registry* r, wisp_world* world, wisp_entity entity,
                                      const wisp_teleport_motion* teleport, bool* is_moved )
{
    EACH_HOOK( hooks.teleported )
    {
        WISP_TRY( s->hooks.teleported( s->memory, world, entity, teleport, is_moved ) );
    }
    return WISP_OK;
}

bool plan_registry_surroundings( const wisp_registry* r, wisp_world* world, wisp_entity entity,
                                 const wisp_sleep_bounds* bounds, uint64_t* hash )
{
    bool rests = true;
    *hash = 0;
    EACH_HOOK( sleep.surroundings )
    {
        rests = rests && s->sleep.surroundings( s->memory, world, entity, bounds, hash );
    }
    return rests;
}

float plan_registry_reach( const wisp_registry* r, wisp_world* world, wisp_entity entity )
{
    float reach = -1.0f;
    EACH_HOOK( sleep.reach )
    {
        const float of_module = s->sleep.reach( s->memory, world, entity );
        reach = of_module > reach ? of_module : reach;
    }
    return reach;
}

void plan_registry_rested( const wisp_registry* r, wisp_world* world, wisp_entity entity )
{
    EACH_HOOK( sleep.rested )
    {
        s->sleep.rested( s->memory, world, entity );
    }
}

bool plan_registry_has_coarse( const wisp_registry* r, const wisp_world* world, wisp_entity entity )
{
    bool found = false;
    EACH_HOOK( detail.has_coarse )
    {
        found = found || s->detail.has_coarse( s->memory, world, entity );
    }
    return found;
}

wisp_status plan_registry_prepare_detail( const wisp_registry* r, wisp_world* world, wisp_entity entity )
{
    EACH_HOOK( detail.prepare )
    {
        WISP_TRY( s->detail.prepare( s->memory, world, entity ) );
    }
    return WISP_OK;
}

void plan_registry_detail_changed( const wisp_registry* r, wisp_world* world, wisp_entity entity, wisp_detail from,
                                   wisp_detail to )
{
    EACH_HOOK( detail.changed )
    {
        s->detail.changed( s->memory, world, entity, from, to );
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
