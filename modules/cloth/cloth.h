/// Cloth: a surface with direction-dependent stretch, bending, damping that keeps rigid motion, wind and air drag. Stretch is
/// XPBD (Macklin, Mueller and Chentanez 2016) or PBD (Mueller et al. 2007).
///
///     wisp_cloth_def cloth = wisp_default_cloth_def();            // inextensible light cotton
///     cloth.bending = WISP_CLOTH_BENDING_DIHEDRAL;                // the fabric must have hinges
///     cloth.wind = ( wisp_vec3 ){ 3, 0, 0 }, cloth.drag_coefficient = 1.0f;
///     wisp_set_cloth( world, surface, &cloth );
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_cloth_module;

/// How cloth bends.
typedef enum wisp_cloth_bending
{
    WISP_CLOTH_BENDING_LINKS =
        0, ///< a link between the opposite vertices of an edge: cheap, resists stretching too. Where
    ///< it is shorter than half its rest length the fold is bent by its angle. The fabric must
    ///< have bend links
    WISP_CLOTH_BENDING_DIHEDRAL =
        1, ///< the angle between two triangles (Bridson et al. 2003); the fabric must have hinges
    WISP_CLOTH_BENDING_ISOMETRIC =
        2, ///< quadratic in the positions (Bergou et al. 2006), cheaper than the angle and right
           ///< where the cloth hardly stretches; the fabric must have hinges
    WISP_CLOTH_BENDING_NONE = 3,
    WISP_CLOTH_BENDING_COUNT = 4,
} wisp_cloth_bending;

/// Material of a surface, and the air around it. Fill from wisp_default_cloth_def(). Copied.
///
/// Compliances are of one link, in m/N: a mesh of equilateral triangles whose links have the stiffness k has the membrane stiffness
/// 2/sqrt(3) k N/m when pulled one way and sqrt(3) k when pulled both ways, at any resolution. Their
/// direction dependence is that of an orthotropic membrane without Poisson effect: c(t) = warp cos^4 t + weft sin^4 t +
/// shear sin^2 t cos^2 t; shear = warp + weft is isotropic if both are equal.
typedef struct wisp_cloth_def
{
    uint32_t size;           ///< bytes; set by wisp_default_cloth_def()
    wisp_solver solver;      ///< default xpbd
    float warp_compliance;   ///< xpbd, m/N, >= 0, along `warp`; default 0: inextensible
    float weft_compliance;   ///< xpbd, m/N, across it; default 0
    float shear_compliance;  ///< xpbd, m/N, between the two; default 0
    float stretch_stiffness; ///< pbd, in [0, 1], along and across; default 1
    float shear_stiffness;   ///< pbd, in [0, 1], at 45 degrees; default 1
    wisp_vec3 warp;          ///< direction in the rest shape, default x. Triangles perpendicular to it are all weft

    wisp_cloth_bending bending; ///< default bend links
    float bend_stiffness;       ///< pbd, in [0, 1], default 0.2
    float bend_compliance;      ///< xpbd, bend links only, m/N, default 0.1
    /// xpbd, dihedral and isometric, N m (J): flexural rigidity D, > 0, default 5e-6 (light cotton). A strip has D times its
    /// width on any mesh and with any number of substeps (Poisson's ratio 0).
    /// With bend links: that of folds of more than about 120 degrees.
    float bend_rigidity;

    float
        internal_damping; ///< 1/s, >= 0: decay rate of relative velocities. Momentum and angular momentum are kept, unless
                          ///< the cloth is pinned: then all velocities decay. Default 3: at rest within 5 s
    wisp_vec3 wind;       ///< m/s, velocity of the air, default 0
    float air_density;      ///< kg/m^3, default 1.204
    float drag_coefficient; ///< coefficient along the relative wind, >= 0, default 0: no air
    float lift_coefficient; ///< coefficient across it, >= 0, default 0

    bool tethers;       ///< default false; the fabric must have attachments and tethers
    float tether_slack; ///< times the rest distance, >= 1, default 1
    /// Coarse sheets that carry the cloth, -1 .. 64. Default -1: 1 with xpbd if the fabric has coarse sheets, else 0, none. Above 0
    /// it needs xpbd and a fabric with them: a mesh of fewer than about 600 vertices has none, which is a warning. Substeps of the coarsest one in a substep of the cloth, by BDF2. 2
    /// with one substep, or 1 with two, are nearer to the converged motion than 40 plain substeps, and than 80 where the cloth
    /// touches nothing, for the time of four or five (docs/methods.md). To set any value of a cloth starts their history again
    int coarse_substeps;
    /// Over the links of the coarsest sheet in each of its substeps, 1 .. 64, default 10. Cloth that moves all the time is as near
    /// to its converged motion with 4 substeps of 2 passes, which cost less; at rest it quivers more
    int coarse_passes;
} wisp_cloth_def;

WISP_DEFINITION( cloth_def );

/// Make a surface a cloth, or change the cloth it is.
/// @return WISP_CONFLICT the module is not registered, the entity is not a surface, another solver moves it, or its fabric lacks what
///         the definition requires, or it asks for coarse sheets with pbd; WISP_BAD_INPUT a value is out of range (the message names it); WISP_NO_MEMORY
WISP_API wisp_status wisp_set_cloth( wisp_world* world, wisp_entity surface, const wisp_cloth_def* def );

/// Change only the wind; cheap enough for every step. The first call gives cloth without drag and lift a drag coefficient of 1.
/// @param wind m/s, at most 1e5
/// @return WISP_BAD_INPUT it is not finite or too large; WISP_CONFLICT the surface is no cloth, or an implicit one
WISP_API wisp_status wisp_set_cloth_wind( wisp_world* world, wisp_entity surface, wisp_vec3 wind );

WISP_END_C
