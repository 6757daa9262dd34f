/// What scenes of cloth share: settings that are listed one by one, and steps that are timed.
#pragma once

#include "accuracy.h"
#include "surface_entrant.h"

/// The scene's next setting, of no series. There must be room.
accuracy_setting* cloth_settings_add( accuracy_scene* scene, const char* format, ... )
    __attribute__( ( format( printf, 2, 3 ) ) );
/// Make it one of a series. @param order what theory promises, or NaN
void cloth_settings_join( accuracy_setting* setting, const char* series, const char* knob_name, double knob,
                          double order );

/// A step whose time is kept. @param scale of the time, so that steps of several lengths can be compared
wisp_status cloth_settings_step( surface_entrant* entrant, double scale, accuracy_run* out, wisp_error* error );
/// The end of a run: its hash, and when it was halted.
wisp_status cloth_settings_end( surface_entrant* entrant, accuracy_run* out, wisp_error* error );
