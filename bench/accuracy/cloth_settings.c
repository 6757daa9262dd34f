#include "cloth_settings.h"

#include <stdarg.h>

accuracy_setting* cloth_settings_add( accuracy_scene* scene, const char* format, ... )
{
    accuracy_setting* setting = &scene->settings[scene->setting_count++];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( setting->name, sizeof( setting->name ), format, arguments );
    va_end( arguments );
    return setting;
}

void cloth_settings_join( accuracy_setting* setting, const char* series, const char* knob_name, double knob,
                          double order )
{
    snprintf( setting->series, sizeof( setting->series ), "%s", series );
    snprintf( setting->knob_name, sizeof( setting->knob_name ), "%s", knob_name );
    setting->knob = knob;
    setting->order = order;
}

wisp_status cloth_settings_step( surface_entrant* entrant, double scale, accuracy_run* out, wisp_error* error )
{
    const double begin = wisp_clock_seconds();
    wisp_status status = surface_entrant_step( entrant, error );
    const double ms = scale * 1e3 * ( wisp_clock_seconds() - begin );
    if ( status == WISP_OK && accuracy_keep_ms( out, ms ) != WISP_OK )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the time of a step" );
    }
    return status;
}

wisp_status cloth_settings_end( surface_entrant* entrant, accuracy_run* out, wisp_error* error )
{
    out->halted_at = entrant->halted_at;
    return surface_entrant_hash( entrant, &out->hash, error );
}
