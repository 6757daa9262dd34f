/// The pressure of a balloon as it reads it, by the gas law and by its closed form.
#pragma once

#include "balloon_scene.h"

/// Sum of k l^2 over all links at rest, N m: what the pressure of a mesh that is scaled evenly goes with.
double balloon_stiffness_sum( const wisp_fabric* fabric, const wisp_balloon_def* def );

typedef struct balloon_readings
{
    double pressure;     ///< Pa above the atmosphere, as the balloon reads it
    double gas_law;      ///< Pa, P_atm (V_0 - V) / V
    double volume_error; ///< V / V_0 - 1
    double closed_form;  ///< Pa, of the mesh scaled to the volume that it has: every link k (l - d)
} balloon_readings;

/// One more step, with statistics.
wisp_status balloon_read_all( surface_implementation* implementation, const balloon_setting* setting,
                              balloon_readings* out, wisp_error* error );
