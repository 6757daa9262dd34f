/// Implicit cloth: particles joined by the links of a triangle mesh, moved by one linear solve per substep (Noh and Jung).
/// Forces are in SI units, and contact is part of the solve. It is the reference to compare position-based cloth with.
///
///     wisp_implicit_cloth_def cloth = wisp_default_implicit_cloth_def();
///     cloth.stretch_stiffness = 500.0f; // N/m
///     wisp_set_implicit_cloth( world, surface, &cloth );
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_implicit_cloth_module;

/// Weight of the force of a neighbour (Noh and Jung, eq. 1-3).
typedef enum wisp_implicit_weights
{
    WISP_IMPLICIT_WEIGHTS_EFFECTIVE = 0, ///< eq. 3 exactly, with symmetric forces and masses m |N| / max |N|
    WISP_IMPLICIT_WEIGHTS_NONE = 1,      ///< 1
    WISP_IMPLICIT_WEIGHTS_COUNT = 2,
} wisp_implicit_weights;

/// What a stiffness describes.
typedef enum wisp_implicit_stiffness
{
    WISP_IMPLICIT_STIFFNESS_LINK = 0,     ///< each link, as printed: another mesh is another cloth
    WISP_IMPLICIT_STIFFNESS_MATERIAL = 1, ///< the material: a link has the part of its length and area, so that
                                          ///< refinement does not change the cloth. Only with the mesh's own links
    WISP_IMPLICIT_STIFFNESS_COUNT = 2,
} wisp_implicit_stiffness;

/// Material and solver of a surface. Fill from wisp_default_implicit_cloth_def(). Copied; need not outlive the call.
typedef struct wisp_implicit_cloth_def
{
    uint32_t size;                           ///< bytes; set by wisp_default_implicit_cloth_def()
    wisp_implicit_stiffness stiffness_model; ///< default material, the same cloth at every resolution
    float
        stretch_stiffness; ///< k_s, N/m, >= 0, default 200: of a link, or of the material (force per width and strain)
    float bend_stiffness;  ///< k_b, N m^2, >= 0, default 1e-6: of a diagonal link; not used with material stiffness
    /// D, N m, >= 0, default 5e-5, of heavy cotton: flexural rigidity, used with material stiffness only. A strip has D times its
    /// width on any mesh; the rest shape bends to a plane. Edges buckle under D as well: softer cloth needs edges below 20 mm
    float bend_rigidity;
    /// c_b, N/m, >= 0; default 0: stretch_stiffness. Of a link: initial slope of bending (eq. 12). Of a material: against
    /// compression, until an edge buckles
    float compression_stiffness;
    float link_damping; ///< k_d of a link, N s/m, >= 0, default 0.02: of all relative velocity (eq. 14)

    wisp_implicit_weights weights; ///< default none
    /// Default Euler (eq. 16-17), which damps oscillation. BDF2 makes its first substep by Euler, and those with k h^2 / m above 512 or
    /// after a correction by contact of surfaces (WISP_COUNT_FIRST_ORDER).
    wisp_integrator integrator;

    /// Linear solves per substep, 1 .. 64, default 1 as in the paper. More approach the nonlinear step of implicit Euler.
    int newton_iterations;
    /// Limit of the linear solves of a substep that iterates until it converges, 1 .. 64, default 16: one with k h^2 / m above
    /// 1024, or one that gained energy, which is made again (by Euler, WISP_COUNT_FIRST_ORDER if it was BDF2).
    /// 1: all substeps make newton_iterations, and may gain energy. Substeps of more than three are counted (WISP_COUNT_MANY_SOLVES).
    int max_newton_iterations;
    /// Residual at which a solve ends, relative to that of zero velocity change: in [1e-7, 0.1], default 1e-2, as the length of a
    /// substep adds ten times its error. Repeated solves of a substep end where its first did. Where k h^2 / m is above 8192 the
    /// tolerance falls with that, to 1e-4 at the least
    float tolerance;
    int max_iterations; ///< limit of the iterations of a solve, 0 .. 1000000; default 0: three per vertex

    /// Links given by the host instead of those of the mesh (edges stretch, diagonals bend), for a quad mesh or seams.
    const int32_t* stretch_pairs; ///< [stretch_pair_count][2] in the user's order; null: the edges of the mesh
    const int32_t* bend_pairs; ///< [bend_pair_count][2]; null: the diagonals of the mesh, or none with stretch pairs
    int stretch_pair_count, bend_pair_count;
} wisp_implicit_cloth_def;

WISP_DEFINITION( implicit_cloth_def );

/// Make a surface an implicit cloth, or replace its definition. Gravity, pins, targets and damping of the surface apply.
/// Colliders act through wisp_set_collision(): its thickness is the margin within which a vertex is held, its push-out
/// speed limits how fast penetration is removed, friction is Coulomb's. wisp_set_contact() keeps it apart from itself and from other
/// surfaces: positions are corrected after the solve and velocities follow; a substep of BDF2 after one that was corrected is of Euler.
/// @return WISP_CONFLICT the module is not registered, the entity is not a surface, or another solver moves it;
///         WISP_BAD_INPUT a value is out of range, a pair is not two vertices of the surface, or a link has no length
///         (the message names it); WISP_NO_MEMORY. On failure the surface is unchanged
/// @note With BDF2, call again after wisp_set_velocity(), to drop the previous substep.
WISP_API wisp_status wisp_set_implicit_cloth( wisp_world* world, wisp_entity surface,
                                              const wisp_implicit_cloth_def* def );

/// Statistics of the last substep of a step, and energies at its end.
typedef struct wisp_implicit_cloth_stats
{
    int32_t iterations;        ///< of conjugate gradients, over all linear solves
    int32_t newton_iterations; ///< linear solves
    float residual;            ///< final residual of the last solve, relative to that of zero velocity change
    int32_t stretch_links, bend_links;
    int32_t max_neighbours;             ///< max |N|
    int32_t sticking, sliding, landing; ///< vertices in contact
    int32_t released;      ///< vertices released in the last substep because a body would have to pull them
    double stretch_energy; ///< J (eq. 5)
    double bend_energy;    ///< J, the potential of eq. 12
    double
        newton_residual; ///< m/s, largest |v - v* - h f(x, v) / m| of a free vertex: 0: converged to the nonlinear step
} wisp_implicit_cloth_stats;

/// Request statistics from the next step on. @param requested false cancels the request
/// @return WISP_CONFLICT the entity is no implicit cloth
WISP_API wisp_status wisp_request_implicit_cloth_stats( wisp_world* world, wisp_entity surface, bool requested );

/// @return WISP_CONFLICT statistics were not requested, or no step was made since
WISP_API wisp_status wisp_read_implicit_cloth_stats( wisp_world* world, wisp_entity surface,
                                                     wisp_implicit_cloth_stats* out );

WISP_END_C
