/// Spheres of helium: their settings, their bodies, and the theory of their lift.
#pragma once

#include "accuracy/accuracy_surface.h"
#include "balloon_scene.h"

#define VALIDATE_HELIUM_GRAVITY 9.81 // m/s^2

typedef struct validate_helium_way
{
    int level, substeps;      // of the icosphere; of 1/60 s
    double fill;              // V_0 / V_rest
    wisp_solver skin, volume; // what solves them
} validate_helium_way;

/// A default balloon in air at rest.
balloon_setting validate_helium_setting( const validate_helium_way* way, int workers );

/// A smooth sphere of the same skin, filled with an ideal gas: p V = n R T.
typedef struct validate_helium_sphere
{
    double scale, radius; ///< of the full sphere in the one at rest; m
    double air, helium;   ///< kg/m^3, at the pressure of the atmosphere
    double
        lift; ///< kg that it can carry, its skin included (Archimedes). The gas weighs what it did before it was squeezed
} validate_helium_sphere;

validate_helium_sphere validate_helium_theory( const balloon_setting* setting );

typedef struct validate_helium_body
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    wisp_vec3* points; ///< full, in balance
    double area;       ///< m^2, at rest
    double lift;       ///< kg that the mesh can carry, as validate_helium_sphere.lift
} validate_helium_body;

/// @param out to be freed, also after a failure
wisp_status validate_helium_make( const validate_helium_way* way, validate_helium_body* out, wisp_error* error );
void validate_helium_free( validate_helium_body* body );
/// "xpbd skin, pbd gas"
void validate_helium_name( const validate_helium_way* way, char* out, size_t size );
