#include "bench_world.h"

#include "interruption.h"

// A log that drops every line: the tables report halts and resets.
static void bench_world_drop_log( void* user, wisp_log_level level, const char* message )
{
    (void)user;
    (void)level;
    (void)message;
}

wisp_status bench_world_create( const bench_world_def* from, wisp_world** out, wisp_error* error )
{
    wisp_world_def def = wisp_default_world_def();
    def.modules = from->modules;
    def.module_count = from->module_count;
    def.log = bench_world_drop_log;
    def.workers = from->workers > 0 ? from->workers : 1;
    def.substeps = from->substeps > 0 ? from->substeps : 1;
    def.iterations = from->iterations > 0 ? from->iterations : 1;
    return wisp_world_create( &def, out, error );
}

wisp_status bench_world_fail( const wisp_world* world, wisp_status status, wisp_error* error )
{
    return wisp_fail( error, status, "%s", wisp_world_message( world ) );
}

wisp_status bench_world_step( wisp_world* world, wisp_entity entity, float seconds, int* steps, int* halted_at,
                              wisp_error* error )
{
    wisp_status status = interruption_check( error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = wisp_world_step( world, seconds );
    if ( status != WISP_OK )
    {
        return bench_world_fail( world, status, error );
    }
    ++*steps;
    if ( *halted_at == 0 && wisp_is_halted( world, entity ) )
    {
        *halted_at = *steps;
    }
    return WISP_OK;
}

wisp_status bench_world_hash( wisp_world* world, wisp_entity entity, wisp_component component, uint64_t* hash,
                              wisp_error* error )
{
    wisp_status status = wisp_world_hash_column( world, entity, component, hash );
    return status == WISP_OK ? WISP_OK : bench_world_fail( world, status, error );
}

wisp_status bench_world_points( wisp_world* world, wisp_entity entity, wisp_component component, int count,
                                const wisp_vec3** points, wisp_error* error )
{
    wisp_view view = { 0 };
    wisp_status status = wisp_world_view( world, entity, component, &view );
    if ( status != WISP_OK )
    {
        return bench_world_fail( world, status, error );
    }
    WISP_ASSERT( view.stride == sizeof( wisp_vec3 ) && view.count == count );
    *points = view.data;
    return WISP_OK;
}
