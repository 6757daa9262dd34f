/// The pressure of a balloon by its three readings, and by its closed form.
#pragma once

#include "balloon_scene.h"

/// Sum of k l^2 over all links at rest, N m: what the pressure of a mesh that is scaled evenly goes with.
double balloon_stiffness_sum( const wisp_fabric* fabric, const wisp_balloon_def* def );

/// The readings that are one pressure at equilibrium; the printed `added` is not one of them.
#define BALLOON_READINGS ( WISP_BALLOON_PRESSURE_GAS + 1 )

typedef struct balloon_readings
{
    double pressure[BALLOON_READINGS]; ///< Pa above the atmosphere, by wisp_balloon_pressure
    double volume_error;               ///< V / V_0 - 1
    double closed_form;                ///< Pa, of the mesh scaled to the volume that it has: every link k (l - d)
} balloon_readings;

/// One more step for each reading.
wisp_status balloon_read_all( surface_implementation* implementation, const balloon_setting* setting,
                              balloon_readings* out, wisp_error* error );
