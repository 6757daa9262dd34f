#include "effects/effect_world.h"

#include "bench_world.h"
#include "wisp/explain.h"

#include <stdio.h>
#include <string.h>

static wisp_status add_scenes( const effect_world_def* def, effect_world* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < def->count && status == WISP_OK; ++i )
    {
        effect_scene* scene = out->scenes + out->scene_count++;
        status = effect_scene_add( def->effects[i], &def->size, def->is_on, out->world, scene, error );
    }
    return status;
}

wisp_status effect_world_open( const effect_world_def* def, effect_world* out, wisp_error* error )
{
    WISP_ASSERT( def->count <= EFFECT_SCENES_MAX );
    *out = ( effect_world ){ 0 };
    const wisp_module* modules[EFFECT_MODULES_MAX];
    wisp_world_def world = wisp_default_world_def();
    world.modules = modules;
    world.module_count = effects_modules( def->effects, def->count, def->is_on, def->registry, modules );
    world.allocator = def->allocator;
    world.workers = 1;
    world.substeps = EFFECT_SUBSTEPS;
    wisp_status status = wisp_world_create( &world, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    out->module_count = world.module_count;
    out->registry_bytes = wisp_world_memory( out->world );
    status = add_scenes( def, out, error );
    if ( status != WISP_OK )
    {
        effect_world_close( out );
    }
    return status;
}

void effect_world_close( effect_world* world )
{
    wisp_world_destroy( world->world );
    *world = ( effect_world ){ 0 };
}

wisp_status effect_world_step( void* context, wisp_error* error )
{
    effect_world* world = context;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < world->scene_count && status == WISP_OK; ++i )
    {
        status = effect_scene_tell( world->scenes + i, world->world, world->steps );
    }
    status = status == WISP_OK ? wisp_world_step( world->world, EFFECT_STEP ) : status;
    world->steps += 1;
    return status == WISP_OK ? WISP_OK : bench_world_fail( world->world, status, error );
}

size_t effect_world_bytes( const effect_world* world )
{
    return wisp_world_memory( world->world ) - world->registry_bytes;
}

wisp_status effect_world_hash( effect_world* world, int scene, uint64_t* hash, wisp_error* error )
{
    const wisp_status status = effect_scene_hash( world->scenes + scene, world->world, hash );
    return status == WISP_OK ? WISP_OK : bench_world_fail( world->world, status, error );
}

wisp_status effect_world_plan( effect_world* world, char* out, int* count, wisp_error* error )
{
    wisp_plan_info* report;
    const wisp_status status = wisp_world_explain( world->world, &report );
    out[0] = '\0';
    if ( status != WISP_OK )
    {
        return bench_world_fail( world->world, status, error );
    }
    size_t length = 0;
    for ( int i = 0; i < report->active_count; ++i )
    {
        const int more =
            snprintf( out + length, EFFECT_PLAN_MAX - length, "%s%s", i > 0 ? " " : "", report->passes[i].name );
        length += more > 0 ? (size_t)more : 0;
        WISP_ASSERT( length < EFFECT_PLAN_MAX );
    }
    if ( count != NULL )
    {
        *count = report->active_count;
    }
    wisp_plan_info_release( report );
    return WISP_OK;
}
