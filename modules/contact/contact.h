/// Contact between surfaces, of surfaces with themselves, of strands with surfaces, and on request of strands with strands. Cloth does not pass through cloth, and
/// balloons press on each other and flatten. Friction is Coulomb's, and momentum is conserved. Kinematic bodies belong to
/// the module collision. The displacement limit follows Incremental Potential Contact (Li et al. 2020) in its purpose:
/// a state without intersections stays free of them.
///
///     wisp_contact_def contact = wisp_default_contact_def();
///     contact.thickness = 0.004f;                            // m
///     wisp_set_contact( world, shirt, &contact );
///     wisp_set_contact( world, jacket, &contact );           // both also keep off themselves
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_contact_module;

/// Primitives that are kept apart.
typedef enum wisp_contact_primitives
{
    /// Vertices from triangles, and edges from edges. A state without intersections stays free of them: no vertex moves
    /// farther than the separating planes of its pairs allow. Pinned vertices move freely; what they pass through is
    /// untangled.
    WISP_CONTACT_TRIANGLES = 0,
    /// Boundary particles from each other, as spheres of the thickness: those of the layer of a surface that has one
    /// (boundary.h), else particles at fixed places of its rest shape. Details finer than their spacing pass through, so the
    /// spacing sets both the cost and what is missed (benchmark, case contact).
    WISP_CONTACT_PARTICLES = 1,
    WISP_CONTACT_PRIMITIVES_COUNT = 2,
} wisp_contact_primitives;

/// Contact detection of a world. Fill from wisp_default_contact_settings(). Copied.
typedef struct wisp_contact_settings
{
    uint32_t size;                      ///< bytes; set by wisp_default_contact_settings()
    wisp_contact_primitives primitives; ///< default triangles
    float
        particle_spacing; ///< m, > 0, with particles, of surfaces without a layer; default 0: the smallest thickness of
                          ///< the participants
    /// Search margin beyond the thickness, in thicknesses, > 0, default 1. A larger one makes lists longer and searches rarer,
    /// with the same bits.
    float margin;
    bool displacement_limit; ///< default true: displacements are limited before they intersect (triangles only)
} wisp_contact_settings;

WISP_DEFINITION( contact_settings );

/// @return WISP_BAD_INPUT a value is out of range (the message names it); WISP_CONFLICT the module is not registered;
///         WISP_NO_MEMORY
WISP_API wisp_status wisp_set_contact_settings( wisp_world* world, const wisp_contact_settings* settings );

/// How a surface or strands take part in contact. Fill from wisp_default_contact_def(). Copied.
typedef struct wisp_contact_def
{
    uint32_t size; ///< bytes; set by wisp_default_contact_def()
    /// m; two participants keep half the sum of their thicknesses apart. Default 0: a quarter of the mean length of edges or
    /// segments, and of a surface at most 0.9 of its shortest edge (at least a fortieth of the mean). Within a surface, pairs
    /// keep at most 0.9 of their distance at rest; a thickness above the shortest edge makes it stiff there and is warned of.
    float thickness;
    float friction; ///< mu >= 0, default 0.3; a pair has the geometric mean
    bool self;      ///< default true: a surface keeps its distance from itself, and strands with `between_strands` do
    float
        max_push_out_speed; ///< m/s, >= 0: speed at which pairs that are too near separate, without getting velocity;
                            ///< default 0: ten thicknesses per second
    uint32_t layers,
        mask;     ///< bits, default 1 and all: two participants collide if each has a layer in the mask of the other
    bool enabled; ///< default true
    /// Strands keep their distance from strands: with `self` from each other and from themselves, and from those of another
    /// entity that has it too. Segments that are nearer at rest keep 0.9 of that distance. Displacements are limited once more
    /// after lengths are restored, so that segments do not pass through each other; lengths give way by that. Default false.
    bool between_strands;
} wisp_contact_def;

WISP_DEFINITION( contact_def );

/// Add a surface or strands to contact, or replace their definition. Pinned vertices push and are not pushed.
/// @return WISP_BAD_INPUT a value is out of range (the message names it); WISP_CONFLICT the module is not registered,
///         or the entity is neither a surface nor strands with dynamics; WISP_NO_MEMORY
/// @note Positions of a surface with an external solver (implicit cloth) are corrected after its solve.
WISP_API wisp_status wisp_set_contact( wisp_world* world, wisp_entity entity, const wisp_contact_def* def );
/// Remove an entity from contact.
WISP_API wisp_status wisp_unset_contact( wisp_world* world, wisp_entity entity );

/// Statistics of contact in the last step, over all participants.
typedef struct wisp_contact_stats
{
    int participants, points, edges, triangles; ///< in contact; with particles, points are boundary particles
    int64_t candidates; ///< pairs that may touch before the next search: of particles, or of clusters of neighbouring
                        ///< triangles
    int contacts;       ///< pairs that pressed on each other in the last substep
    int searches;       ///< in this step, for all pairs
    float min_gap;      ///< smallest distance of a pair over its thickness at the end; 1 or more: no pair is too near
    int displacement_limited; ///< vertices whose displacement was limited, summed over substeps; above 0 momentum is not conserved
    int tangled;              ///< edges through triangles that were being untangled at the last search
    int intersections; ///< edges that intersect triangles at the end of the step, exact, of which not all five points
                       ///< are pinned; -1 unless requested
    double net_impulse
        [3];        ///< N s, sum of the impulses of all pairs in this step: equal and opposite, so 0 but for rounding
    double impulse; ///< N s, sum of the pairs' magnitudes in this step
} wisp_contact_stats;

/// Request statistics from the next step on.
/// @param requested false cancels the request
/// @param count_intersections also count intersections, which costs a search
WISP_API wisp_status wisp_request_contact_stats( wisp_world* world, bool requested, bool count_intersections );
/// @return WISP_CONFLICT statistics were not requested, no entity is in contact, or no step was made since
WISP_API wisp_status wisp_read_contact_stats( wisp_world* world, wisp_contact_stats* out );

/// Read the impulse that contact gave an entity in the last step. The sum over all participants is zero but for rounding, unless
/// pinned vertices are in contact.
/// @param out receives N s
/// @return WISP_CONFLICT as wisp_read_contact_stats()
WISP_API wisp_status wisp_read_contact_impulse( wisp_world* world, wisp_entity entity, double out[3] );

/// Read how many of `intersections` of wisp_contact_stats are between two entities: edges of one through triangles of the other.
/// @param a, b participants; the same one twice: an entity with itself
/// @return WISP_CONFLICT intersections were not counted in the last step, an entity takes no part, or participants have changed
///         since that step
WISP_API wisp_status wisp_read_contact_intersections( wisp_world* world, wisp_entity a, wisp_entity b, int* out );

WISP_END_C
