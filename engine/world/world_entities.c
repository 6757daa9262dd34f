// Entities: what is said of a call that failed, components on and off, requests, views out.
#include "world.h"

#include "wisp/module/components.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

// ---- failures ----

static const char STEPS_NOW[] =
    "a step of this world runs: calls from its callbacks or from other threads are refused";

// Another thread may write the message of a world that steps, so there it is a constant.
const char* wisp_world_message( const wisp_world* world )
{
    if ( world == NULL )
    {
        return "world: got null";
    }
    return atomic_load( &world->is_stepping ) ? STEPS_NOW : world->error.message;
}

wisp_status wisp_world_begin( wisp_world* world )
{
    if ( world == NULL )
    {
        return WISP_BAD_INPUT;
    }
    if ( atomic_load( &world->is_stepping ) )
    {
        return WISP_CONFLICT;
    }
    world->error.status = WISP_OK;
    world->error.message[0] = '\0';
    return WISP_OK;
}

wisp_status wisp_world_begin_def( wisp_world* world, const wisp_entity* entity, const wisp_fields* fields, void* def,
                                  const void* given )
{
    WISP_TRY( wisp_world_begin( world ) );
    wisp_error error = { 0 };
    const wisp_status status = wisp_def_read( fields, def, given, &error );
    return status != WISP_OK ? wisp_world_fail( world, status, "%s", error.message )
           : entity != NULL  ? wisp_world_check_entity( world, *entity )
                             : WISP_OK;
}

wisp_status wisp_world_check_values( wisp_world* world, const wisp_fields* fields, const char* name,
                                     const void* values, int count, const char* of )
{
    for ( int i = 0; values != NULL && i < count; ++i )
    {
        wisp_error error = { 0 };
        const void* value = (const char*)values + (size_t)i * sizeof( float );
        const wisp_status status = base_check_value( fields, name, of, i, value, &error );
        if ( status != WISP_OK )
        {
            return wisp_world_fail( world, status, "%s", error.message );
        }
    }
    return WISP_OK;
}

wisp_status wisp_world_check_entity( wisp_world* world, wisp_entity entity )
{
    WISP_TRY( wisp_world_begin( world ) );
    return store_find( &world->store, entity ) != NULL ? WISP_OK : world_stale( world, entity );
}

wisp_status wisp_world_find_state( wisp_world* world, const char* module, const wisp_entity* entity, unsigned kinds,
                                   void** state )
{
    WISP_TRY( entity != NULL ? wisp_world_check_entity( world, *entity ) : wisp_world_begin( world ) );
    *state = plan_registry_state( &world->registry, module );
    if ( *state == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "module %s: not registered in this world", module );
    }
    store_entity* e = kinds != 0 ? store_find( &world->store, *entity ) : NULL;
    if ( kinds == 0 || ( ( kinds & WISP_IS_STRANDS ) != 0 && e->strands != NULL ) )
    {
        return WISP_OK;
    }
    return ( kinds & WISP_IS_SURFACE ) != 0
               ? world_find_surface( world, *entity, &e )
               : wisp_world_fail( world, WISP_CONFLICT, "entity %u: has no strands", entity->index );
}

wisp_status wisp_world_begin_read( wisp_world* world, void* out, size_t size )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    memset( out, 0, size );
    return WISP_OK;
}

wisp_status wisp_world_check_pointer( wisp_world* world, const char* name, const void* pointer )
{
    return pointer != NULL ? WISP_OK : wisp_world_fail( world, WISP_BAD_INPUT, "%s: got null", name );
}

wisp_status wisp_world_check_list( wisp_world* world, const char* name, const void* list, int count )
{
    if ( count < 0 )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "%s: got %d of them, expected at least 0", name, count );
    }
    return count == 0 ? WISP_OK : wisp_world_check_pointer( world, name, list );
}

wisp_status wisp_world_fail( wisp_world* world, wisp_status status, const char* format, ... )
{
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( world->error.message, sizeof( world->error.message ), format, arguments );
    va_end( arguments );
    world->error.status = status;
    if ( world->log.function != NULL ) // the status says it; only a host that asked gets it twice
    {
        base_log_write( &world->log, WISP_LOG_ERROR, "%s", world->error.message );
    }
    return status;
}

void wisp_world_warn( wisp_world* world, const char* format, ... )
{
    char message[sizeof( world->error.message )];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( message, sizeof( message ), format, arguments );
    va_end( arguments );
    base_log_write( &world->log, WISP_LOG_WARNING, "%s", message );
}

void wisp_world_tell( wisp_world* world, wisp_entity entity, bool is_so, const char* sentence )
{
    bool is_told = is_so == false || world->told_count == WISP_COUNT( world->told );
    for ( int i = 0; i < world->told_count; ++i )
    {
        is_told = is_told || ( world->told[i].sentence == sentence && world->told[i].entity.index == entity.index &&
                               world->told[i].entity.generation == entity.generation );
    }
    if ( is_told == false )
    {
        world->told[world->told_count++] = ( world_told ){ entity, sentence };
        wisp_world_warn( world, "entity %u: %s", entity.index, sentence );
    }
}

wisp_status world_stale( wisp_world* world, wisp_entity entity )
{
    return wisp_world_fail( world, WISP_STALE_ID, "entity %u of generation %u: does not exist or was removed",
                            entity.index, entity.generation );
}

wisp_status wisp_world_add_pairs( wisp_world* world, int pair_count, wisp_entity* out )
{
    const int rows[WISP_TABLE_COUNT] = { [WISP_TABLE_ENTITY] = 1, [WISP_TABLE_PAIR] = pair_count };
    *out = ( wisp_entity ){ 0, 0 };
    return store_add( &world->store, rows, out )
               ? WISP_OK
               : wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for another entity" );
}

const wisp_allocator* wisp_world_allocator( wisp_world* world )
{
    return &world->allocator;
}

void wisp_world_remove( wisp_world* world, wisp_entity entity )
{
    const store_entity* e = store_find( &world->store, entity );
    if ( e == NULL )
    {
        return;
    }
    plan_registry_removed( &world->registry, world, entity );
    cook_strands* strands = (cook_strands*)(void*)e->strands;
    wisp_fabric* fabric = (wisp_fabric*)(void*)e->fabric;
    store_remove( &world->store, entity );
    cook_strands_release( strands );
    wisp_fabric_release( fabric );
}

wisp_status wisp_remove( wisp_world* world, wisp_entity entity )
{
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    wisp_world_remove( world, entity );
    return WISP_OK;
}

bool wisp_is_alive( const wisp_world* world, wisp_entity entity )
{
    return world != NULL && store_find( &world->store, entity ) != NULL;
}

bool wisp_has_strands( const wisp_world* world, wisp_entity entity )
{
    const store_entity* e = world != NULL ? store_find( &world->store, entity ) : NULL;
    return e != NULL && e->strands != NULL;
}

wisp_status wisp_set_substeps( wisp_world* world, wisp_entity entity, int substeps )
{
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    store_entity* e = store_find( &world->store, entity );
    if ( substeps < 0 || substeps > WORLD_MAX_SUBSTEPS )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "substeps: got %d, expected 0 to %d", substeps,
                                WORLD_MAX_SUBSTEPS );
    }
    world->rates_are_stale = world->rates_are_stale || e->substeps != substeps;
    e->substeps = substeps;
    return WISP_OK;
}

// ---- components ----

static bool known( const wisp_world* world, wisp_component component )
{
    return component > 0 && component < world->store.component_count;
}

wisp_status wisp_world_attach( wisp_world* world, wisp_entity entity, wisp_component component )
{
    store_entity* e = store_find( &world->store, entity );
    if ( e == NULL )
    {
        return world_stale( world, entity );
    }
    WISP_ASSERT( known( world, component ) );
    if ( store_attach( &world->store, entity, component ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for the rows of '%s'",
                                world->store.components[component].def.name );
    }
    // rows that were there only for a request are given now, so passes may need them
    world->store.structure += store_mask_has( &e->derived, component ) ? 1 : 0;
    store_mask_remove( &e->derived, component );
    return WISP_OK;
}

wisp_status wisp_world_detach( wisp_world* world, wisp_entity entity, wisp_component component )
{
    if ( store_find( &world->store, entity ) == NULL )
    {
        return world_stale( world, entity );
    }
    WISP_ASSERT( known( world, component ) );
    store_detach( &world->store, entity, component );
    return WISP_OK;
}

bool wisp_world_has( const wisp_world* world, wisp_entity entity, wisp_component component )
{
    const store_entity* e = store_find( &world->store, entity );
    return e != NULL && known( world, component ) && store_mask_has( &e->components, component ) &&
           store_mask_has( &e->derived, component ) == false;
}

wisp_status wisp_world_set_components( wisp_world* world, wisp_entity entity, const wisp_component_use* all,
                                       int count )
{
    store_entity* e = store_find( &world->store, entity );
    const store_mask had = e->components, derived = e->derived, requests = e->requests;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        status = ( all[i].use & WISP_USED ) != 0 ? wisp_world_attach( world, entity, all[i].component ) : WISP_OK;
        status = status == WISP_OK && ( all[i].use & WISP_REQUESTED ) != 0
                     ? wisp_world_request( world, entity, all[i].component, true )
                     : status;
    }
    for ( int i = 0; i < count; ++i )
    {
        if ( status == WISP_OK ? all[i].use == 0 : store_mask_has( &had, all[i].component ) == false )
        {
            (void)wisp_world_detach( world, entity, all[i].component ); // only frees memory
        }
    }
    e->derived = status == WISP_OK ? e->derived : derived;
    e->requests = status == WISP_OK ? e->requests : requests;
    return status;
}

wisp_status wisp_world_set_row( wisp_world* world, wisp_entity entity, wisp_component component, const void* row,
                                size_t size )
{
    if ( row == NULL )
    {
        return wisp_world_detach( world, entity, component );
    }
    WISP_TRY( wisp_world_attach( world, entity, component ) );
    memcpy( wisp_world_column( world, entity, component, 0 ), row, size );
    return WISP_OK;
}

void* wisp_world_column( wisp_world* world, wisp_entity entity, wisp_component component, int column )
{
    store_entity* e = store_find( &world->store, entity );
    if ( e == NULL || known( world, component ) == false )
    {
        return NULL;
    }
    store_touch( &world->store, e, component );
    return store_column( &world->store, e, component, column );
}

const wisp_strand_topology* wisp_world_strands( wisp_world* world, wisp_entity entity )
{
    const store_entity* e = store_find( &world->store, entity );
    return e != NULL ? e->strands : NULL;
}

void* wisp_world_module_state( wisp_world* world, const char* module )
{
    return plan_registry_state( &world->registry, module );
}

// ---- what modules share ----

bool wisp_world_reserve( wisp_world* world, void** array, int* capacity, int count, size_t element_size )
{
    if ( count < *capacity )
    {
        return true;
    }
    const wisp_allocator* allocator = &world->allocator;
    const int more = *capacity > 0 ? 2 * *capacity : 4;
    void* grown = allocator->allocate( allocator->user, (size_t)more * element_size, 64 );
    if ( grown == NULL )
    {
        return false;
    }
    if ( *array != NULL )
    {
        memcpy( grown, *array, (size_t)count * element_size );
        allocator->release( allocator->user, *array, (size_t)*capacity * element_size );
    }
    *array = grown;
    *capacity = more;
    return true;
}

wisp_component wisp_world_find_component( wisp_world* world, const char* name )
{
    if ( wisp_world_begin( world ) != WISP_OK || wisp_world_check_pointer( world, "name", name ) != WISP_OK )
    {
        return 0;
    }
    for ( int c = 1; c < world->store.component_count; ++c )
    {
        if ( strcmp( world->store.components[c].def.name, name ) == 0 )
        {
            return (wisp_component)c;
        }
    }
    wisp_world_fail( world, WISP_BAD_INPUT, "component: got '%s', expected a name such as '%s'", name,
                     world->store.components[WISP_SURFACE_POINTS].def.name );
    return 0;
}

const char* wisp_world_component_name( const wisp_world* world, wisp_component component )
{
    return world != NULL && known( world, component ) ? world->store.components[component].def.name : "unknown";
}

// ---- requests and views ----

wisp_status wisp_world_request( wisp_world* world, wisp_entity entity, wisp_component component, bool is_requested )
{
    store_entity* e = store_find( &world->store, entity );
    if ( e == NULL )
    {
        return world_stale( world, entity );
    }
    if ( known( world, component ) == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "component %u: not declared in this world",
                                (unsigned)component );
    }
    const bool was_requested = store_mask_has( &e->requests, component );
    world->store.structure += is_requested != was_requested ? 1 : 0;
    if ( is_requested == false )
    {
        store_mask_remove( &e->requests, component );
        if ( was_requested && store_mask_has( &e->derived, component ) )
        {
            store_detach( &world->store, entity, component );
        }
        return WISP_OK;
    }
    const bool had = store_mask_has( &e->components, component );
    if ( store_attach( &world->store, entity, component ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for the rows of '%s'",
                                world->store.components[component].def.name );
    }
    if ( had == false )
    {
        store_mask_add( &e->derived, component );
    }
    store_mask_add( &e->requests, component );
    return WISP_OK;
}

wisp_status wisp_request( wisp_world* world, wisp_entity entity, wisp_component component )
{
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    return wisp_world_request( world, entity, component, true );
}

wisp_status wisp_cancel_request( wisp_world* world, wisp_entity entity, wisp_component component )
{
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    return wisp_world_request( world, entity, component, false );
}

static wisp_status user_rows( const wisp_world* world, wisp_entity entity, wisp_component component, wisp_view* out,
                              wisp_error* error )
{
    *out = ( wisp_view ){ 0 };
    const store_entity* e = store_find( &world->store, entity );
    const wisp_component_def* def = known( world, component ) ? &world->store.components[component].def : NULL;
    if ( def == NULL || def->table != WISP_TABLE_POINT || store_mask_has( &e->components, component ) == false )
    {
        return wisp_fail( error, WISP_CONFLICT,
                          "component '%s': has no rows in the user's order, request it with wisp_request first",
                          def != NULL ? def->name : "unknown" );
    }
    *out = ( wisp_view ){ store_column( &world->store, e, component, 0 ), e->rows[WISP_TABLE_POINT].count,
                          def->columns[0].row_size };
    return WISP_OK;
}

wisp_status wisp_world_view( wisp_world* world, wisp_entity entity, wisp_component component, wisp_view* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    wisp_error error = { 0 };
    wisp_status status = user_rows( world, entity, component, out, &error );
    if ( status != WISP_OK )
    {
        return wisp_world_fail( world, status, "%s", error.message );
    }
    const void* blended = world_blended_rows( world, store_find( &world->store, entity ), component );
    out->data = blended != NULL ? blended : out->data;
    return WISP_OK;
}

wisp_status wisp_world_hash_column( wisp_world* world, wisp_entity entity, wisp_component component, uint64_t* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    WISP_TRY( wisp_world_check_entity( world, entity ) );
    wisp_view view;
    wisp_error error = { 0 };
    wisp_status status = user_rows( world, entity, component, &view, &error );
    *out = status == WISP_OK ? store_hash_bytes( 0, view.data, (size_t)view.count * view.stride ) : 0;
    return status == WISP_OK ? WISP_OK : wisp_world_fail( world, status, "%s", error.message );
}
