/// Cloth in cells of the matrix and in named cases.
#pragma once

#include "stability_surface.h"

/// Solvers of cloth.
enum
{
    STABILITY_PBD,
    STABILITY_XPBD,
    STABILITY_XPBD_FOUR, ///< iterations, with multipliers kept
    STABILITY_XPBD_FAR,  ///< levels and tethers
    STABILITY_XPBD_DIHEDRAL,
    STABILITY_XPBD_ISOMETRIC,
    STABILITY_IMPLICIT_EULER,
    STABILITY_IMPLICIT_BDF2,
};

/// A square of cloth that hangs from two corners.
typedef struct stability_cloth_plan
{
    int way;
    int side;      ///< vertices
    float spacing; ///< m
    float density; ///< kg/m^2
    float damping; ///< 1/s
    wisp_vec3 at;  ///< m, of the middle of its upper edge
    int tile_size; ///< 0: the default
    int substeps, iterations;
    bool is_free;      ///< without pins
    bool has_boundary; ///< boundary particles are allowed, and no contact
} stability_cloth_plan;

stability_cloth_plan stability_default_cloth_plan( int way );

/// @param out receives the cloth, to be closed; null on failure
wisp_status stability_cloth_enter( const stability_cloth_plan* plan, const stability_axes* axes, int workers,
                                   stability_surface** out, wisp_error* error );
