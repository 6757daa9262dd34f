/// Implicit cloth: particles joined by the links of a triangle mesh, moved by one linear solve a substep (Noh and Jung).
/// The honest counterpart of position-based cloth: forces in SI units, contact inside the solver.
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_implicit_cloth_module;

/// What a neighbour's force weighs (Noh and Jung, eq. 1-3).
typedef enum wisp_implicit_weights
{
    WISP_IMPLICIT_WEIGHTS_EFFECTIVE, ///< eq. 3 exactly, with symmetric forces and masses m |N| / max |N|
    WISP_IMPLICIT_WEIGHTS_NONE,      ///< 1
    WISP_IMPLICIT_WEIGHTS_PAIR,      ///< a link's force times the mean weight of its two ends, true masses
    WISP_IMPLICIT_WEIGHTS_COUNT,
} wisp_implicit_weights;

/// What a stiffness belongs to.
typedef enum wisp_implicit_stiffness
{
    WISP_IMPLICIT_STIFFNESS_LINK,     ///< to every link alike, as printed: another mesh is another cloth
    WISP_IMPLICIT_STIFFNESS_MATERIAL, ///< to the sheet: a link has the share of its length and area, so that
                                      ///< refining the mesh does not change the cloth. Only with the mesh's own links
    WISP_IMPLICIT_STIFFNESS_COUNT,
} wisp_implicit_stiffness;

typedef enum wisp_implicit_damping
{
    WISP_IMPLICIT_DAMPING_ISOTROPIC, ///< all relative velocity of a link's ends dies (eq. 14)
    WISP_IMPLICIT_DAMPING_AXIAL,     ///< only that along the link, so that rigid spin is left alone
    WISP_IMPLICIT_DAMPING_COUNT,
} wisp_implicit_damping;

/// The derivative of bending forces (Noh and Jung, eq. 13).
typedef enum wisp_implicit_jacobian
{
    WISP_IMPLICIT_JACOBIAN_DROPPED, ///< without its negative second term: the matrix stays positive
    WISP_IMPLICIT_JACOBIAN_FULL,    ///< with it: a solve may meet negative curvature, which stops and counts it
    WISP_IMPLICIT_JACOBIAN_COUNT,
} wisp_implicit_jacobian;

typedef enum wisp_implicit_integrator
{
    WISP_IMPLICIT_EULER, ///< implicit Euler (eq. 16-17): first order, damps oscillation
    WISP_IMPLICIT_BDF2,  ///< second order from the last two substeps; the first substep is Euler's, and so are
                         ///< those with k h^2 / m beyond 512 (WISP_COUNT_FIRST_ORDER)
    WISP_IMPLICIT_INTEGRATOR_COUNT,
} wisp_implicit_integrator;

/// What a surface is made of and how it is solved for. Fill from wisp_default_implicit_cloth_def(). Copied; may die after
/// the call.
typedef struct wisp_implicit_cloth_def
{
    wisp_implicit_stiffness stiffness_model; ///< default link
    float stretch_stiffness; ///< k_s, N/m, >= 0, default 200: of a link, or of the sheet (force a width and strain)
    float bend_stiffness;    ///< k_b, N m^2, >= 0, default 1e-6: of a diagonal link; not with `sheet`
    float bend_rigidity;     ///< D, N m, >= 0, default 5e-6: flexural rigidity with `sheet`; else not used
    float compression_stiffness; ///< c_b, N/m, >= 0, slope at which bending sets in (eq. 12); default 0: as stretch
    float link_damping;          ///< k_d of a link, N s/m, >= 0, default 0.02

    wisp_implicit_weights weights;       ///< default effective
    wisp_implicit_damping damping_form;  ///< default isotropic
    wisp_implicit_jacobian jacobian;     ///< default dropped
    wisp_implicit_integrator integrator; ///< default Euler

    int newton_iterations; ///< linear solves a substep, 1 .. 64, default 1, as in the paper; more approach Euler's nonlinear step.
    int max_newton_iterations; ///< where k h^2 / m is beyond 1024: as many as it takes, up to this, 1 .. 64, default 16. 1: newton_iterations
        ///< and nothing else, as in other substeps, which may gain energy
    float tolerance;    ///< of a solve: its residual over that of standing still, in [1e-7, 0.1], default 1e-4
    int max_iterations; ///< of a solve, 0 .. 1000000; default 0: three a vertex
    bool warm_start;    ///< start a solve from the last one's answer, default true
    bool speculative;   ///< contact: what would pass into a body in this substep lands on it instead; default true.
                        ///< false: contact begins within the margin, as printed

    /// Links by hand instead of those of the mesh (its edges stretch, its diagonals bend): for a quad mesh, or sewing.
    const int32_t* stretch_pairs; ///< [stretch_pair_count][2] the user's vertices; null: the mesh's edges
    const int32_t*
        bend_pairs; ///< [bend_pair_count][2]; null: the mesh's diagonals, or none if there are stretch pairs
    int stretch_pair_count, bend_pair_count;
    uint32_t cookie;
} wisp_implicit_cloth_def;

WISP_API wisp_implicit_cloth_def wisp_default_implicit_cloth_def( void );

/// Make a surface an implicit cloth, or change the one it is. Gravity, pins, targets and damping of the surface count as
/// ever. Bodies count through wisp_set_collision(): its thickness is the margin within which a vertex is held, its
/// push-out speed caps how fast depth is undone, friction is Coulomb's.
/// @return WISP_CONFLICT the module is not registered, the entity is not a surface, or another solver moves it;
///         WISP_BAD_INPUT a value is out of range, a pair is not two vertices of the surface, or a link has no length
///         (the message names it); WISP_NO_MEMORY. On failure the surface is what it was
/// @note Call again after wisp_set_velocity() with BDF2: it forgets the substep before.
WISP_API wisp_status wisp_set_implicit_cloth( wisp_world* world, wisp_entity surface,
                                              const wisp_implicit_cloth_def* def );

/// Figures of the last substep of a step, and energies at its end.
typedef struct wisp_implicit_cloth_stats
{
    int32_t iterations; ///< of conjugate gradients, of all linear solves
    int32_t repeats;    ///< linear solves
    float residual;     ///< that the last solve ended with, over that of standing still
    int32_t stretch_links, bend_links;
    int32_t max_neighbours;             ///< max |N|
    int32_t sticking, sliding, landing; ///< vertices in contact
    int32_t released;                   ///< vertices let go in the last substep because a body would have to pull
    double stretch_energy;              ///< J (eq. 5)
    double bend_energy;                 ///< J, the potential of eq. 12
    double newton_residual; ///< m/s, largest |v - v* - h f(x, v) / m| of a free vertex: 0 is Euler's nonlinear step
} wisp_implicit_cloth_stats;

/// Ask for figures from the next step on. @return WISP_CONFLICT the entity is no implicit cloth
WISP_API wisp_status wisp_request_implicit_cloth_stats( wisp_world* world, wisp_entity surface, bool requested );

/// @return WISP_CONFLICT nobody asked for them, or no step was made since
WISP_API wisp_status wisp_read_implicit_cloth_stats( wisp_world* world, wisp_entity surface,
                                                     wisp_implicit_cloth_stats* out );

WISP_END_C
