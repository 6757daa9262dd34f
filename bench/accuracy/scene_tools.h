/// Shared by the scenes of accuracy: lists of settings, and timed steps.
#pragma once

#include "accuracy.h"

/// Reserve memory for settings; their count stays 0.
wisp_status accuracy_reserve_settings( accuracy_scene* scene, int count, wisp_error* error );
/// Give a scene a context of zeros, which is freed with it, and room for settings. After a failure the scene is empty.
wisp_status accuracy_begin_scene( accuracy_scene* scene, size_t context_size, int setting_count, wisp_error* error );
/// Add the next setting, outside any series. There must be room. @param name printf format
accuracy_setting* accuracy_put_setting( accuracy_scene* scene, const char* name, ... )
    __attribute__( ( format( printf, 2, 3 ) ) );
/// Put a setting into a series. @param order expected in theory, or NaN
void accuracy_join_series( accuracy_setting* setting, const char* series, const char* parameter_name,
                           double parameter, double order );
/// Free a scene that cannot be made. @return the given status
wisp_status accuracy_abandon( accuracy_scene* scene, wisp_status status );

/// Run one step of an implementation and keep its time.
wisp_status accuracy_time_step( wisp_status ( *step )( void* context, wisp_error* error ), void* context,
                                accuracy_run* out, wisp_error* error );
