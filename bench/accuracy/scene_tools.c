#include "accuracy/scene_tools.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>

wisp_status accuracy_reserve_settings( accuracy_scene* scene, int count, wisp_error* error )
{
    scene->settings = calloc( (size_t)count, sizeof( accuracy_setting ) );
    scene->setting_count = 0;
    return scene->settings ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for %d settings", count );
}

wisp_status accuracy_begin_scene( accuracy_scene* scene, size_t context_size, int setting_count, wisp_error* error )
{
    scene->context = calloc( 1, context_size );
    scene->destroy = free;
    const wisp_status status = scene->context != NULL ? accuracy_reserve_settings( scene, setting_count, error )
                                                      : wisp_fail( error, WISP_NO_MEMORY, "no memory for a scene" );
    return status == WISP_OK ? WISP_OK : accuracy_abandon( scene, status );
}

accuracy_setting* accuracy_put_setting( accuracy_scene* scene, const char* name, ... )
{
    accuracy_setting* setting = &scene->settings[scene->setting_count++];
    va_list arguments;
    va_start( arguments, name );
    vsnprintf( setting->name, sizeof( setting->name ), name, arguments );
    va_end( arguments );
    setting->parameter = setting->order = NAN;
    return setting;
}

void accuracy_join_series( accuracy_setting* setting, const char* series, const char* parameter_name,
                           double parameter, double order )
{
    snprintf( setting->series, sizeof( setting->series ), "%s", series );
    snprintf( setting->parameter_name, sizeof( setting->parameter_name ), "%s", parameter_name );
    setting->parameter = parameter;
    setting->order = order;
}

wisp_status accuracy_abandon( accuracy_scene* scene, wisp_status status )
{
    if ( scene->context && scene->destroy )
    {
        scene->destroy( scene->context );
    }
    free( scene->settings );
    *scene = ( accuracy_scene ){ .setting_count = 0 };
    return status;
}

wisp_status accuracy_time_step( wisp_status ( *step )( void* context, wisp_error* error ), void* context,
                                accuracy_run* out, wisp_error* error )
{
    const double begin = wisp_clock_seconds();
    const wisp_status status = step( context, error );
    const double ms = 1e3 * ( wisp_clock_seconds() - begin );
    if ( status != WISP_OK )
    {
        return status;
    }
    return accuracy_keep_ms( out, ms ) == WISP_OK
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "no memory for the times of steps" );
}

// ---- scenes of surfaces ----

wisp_status accuracy_end_surface( surface_implementation* implementation, accuracy_run* out, wisp_error* error )
{
    out->halted_at = implementation->halted_at;
    return surface_implementation_hash( implementation, &out->hash, error );
}

wisp_status accuracy_step_surface( surface_implementation* implementation, int steps, accuracy_run* out,
                                   wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int s = 0; s < steps && implementation->halted_at == 0 && status == WISP_OK; ++s )
    {
        status = accuracy_time_step( surface_implementation_step, implementation, out, error );
    }
    return status;
}

wisp_status accuracy_read_motion_stats( surface_implementation* implementation, wisp_motion_stats* out,
                                        wisp_error* error )
{
    wisp_status status = wisp_read_motion_stats( implementation->world, implementation->entity, out );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

wisp_status accuracy_request_motion_stats( surface_implementation* implementation, bool is_observed,
                                           wisp_error* error )
{
    wisp_status status =
        is_observed ? wisp_request( implementation->world, implementation->entity, WISP_MOTION_STATS ) : WISP_OK;
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}
