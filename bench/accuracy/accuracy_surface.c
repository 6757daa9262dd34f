#include "accuracy_surface.h"

#include <stdarg.h>

wisp_status accuracy_step_surface( surface_entrant* entrant, int steps, accuracy_run* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int s = 0; s < steps && out->halted_at == 0 && status == WISP_OK; ++s )
    {
        double start = wisp_clock_seconds();
        status = surface_entrant_step( entrant, error );
        double ms = 1e3 * ( wisp_clock_seconds() - start );
        if ( status == WISP_OK && accuracy_keep_ms( out, ms ) != WISP_OK )
        {
            status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the times of %d steps", entrant->steps );
        }
        out->halted_at = entrant->halted_at;
    }
    return status;
}

wisp_status accuracy_read_quality( surface_entrant* entrant, wisp_quality* out, wisp_error* error )
{
    wisp_status status = wisp_world_quality( entrant->world, entrant->entity, out );
    return status == WISP_OK ? WISP_OK : surface_entrant_fail( entrant, status, error );
}

wisp_status accuracy_want_quality( surface_entrant* entrant, bool is_looked_at, wisp_error* error )
{
    wisp_status status = is_looked_at ? wisp_want( entrant->world, entrant->entity, WISP_QUALITY ) : WISP_OK;
    return status == WISP_OK ? WISP_OK : surface_entrant_fail( entrant, status, error );
}

void accuracy_add_setting( accuracy_scene* scene, const char* series, const char* knob_name, double knob,
                           double order, const char* format, ... )
{
    accuracy_setting* setting = &scene->settings[scene->setting_count++];
    *setting = ( accuracy_setting ){ .knob = knob, .order = order };
    snprintf( setting->series, sizeof( setting->series ), "%s", series );
    snprintf( setting->knob_name, sizeof( setting->knob_name ), "%s", knob_name );
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( setting->name, sizeof( setting->name ), format, arguments );
    va_end( arguments );
}
