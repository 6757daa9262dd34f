/// What scenes of accuracy share: filling in settings, and steps that are timed.
#pragma once

#include "accuracy.h"

/// Reserve settings; their count stays 0.
wisp_status accuracy_reserve_settings( accuracy_scene* scene, int count, wisp_error* error );
/// The next setting, of no series. There must be room. @param name printf
accuracy_setting* accuracy_put_setting( accuracy_scene* scene, const char* name, ... )
    __attribute__( ( format( printf, 2, 3 ) ) );
/// Make it one of a series. @param order what theory promises, or NaN
void accuracy_join_series( accuracy_setting* setting, const char* series, const char* parameter_name,
                           double parameter, double order );
/// Free a scene that cannot be made. @return the status that it is given
wisp_status accuracy_abandon( accuracy_scene* scene, wisp_status status );

/// One step of an implementation, with its time kept.
wisp_status accuracy_time_step( wisp_status ( *step )( void* context, wisp_error* error ), void* context,
                                accuracy_run* out, wisp_error* error );
