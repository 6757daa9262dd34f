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

/// What is kept apart, and how surely: the less, the faster (docs/scenes.md has a table to choose by).
typedef enum wisp_contact_level
{
    /// Vertices from triangles, and edges from edges. A state without intersections stays free of them: no vertex moves
    /// farther than the separating planes of its pairs allow. Pinned vertices move freely; what they pass through is
    /// untangled.
    WISP_CONTACT_EXACT = 0,
    /// The same pairs, without the displacement limit: what is fast may pass through, and is untangled.
    WISP_CONTACT_TRIANGLES = 1,
    /// Points, as spheres: the vertices of a surface, with the points of its layer if it has one (boundary.h). Pairs are searched once per
    /// step. They keep the thickness, but at least 0.72 of the longest edge around a vertex, so that no point
    /// slips between them. Details finer than that spacing pass through, and nothing is untangled.
    WISP_CONTACT_SPHERES = 2,
    WISP_CONTACT_LEVEL_COUNT = 3,
} wisp_contact_level;

/// Contact detection of a world. Fill from wisp_default_contact_settings(). Copied.
typedef struct wisp_contact_settings
{
    uint32_t size;            ///< bytes; set by wisp_default_contact_settings()
    wisp_contact_level level; ///< default exact; may change between steps, as a level of detail
    /// Search margin beyond the distance to keep, in such distances, > 0, default 1. A larger one makes lists longer, and searches
    /// rarer, with the same bits. Spheres are searched once per step: their motion has to stay within it.
    float margin;
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
    int participants, points, edges, triangles; ///< in contact; with spheres, points are spheres
    int64_t
        candidates; ///< pairs that may touch before the next search: of spheres, of primitives, or if exact of clusters
                    ///< of neighbouring triangles
    int contacts;   ///< pairs that pressed on each other in the last substep
    int searches;   ///< in this step, for all pairs
    float min_gap; ///< smallest distance of a pair over its thickness at the end; 1 or more: no pair is too near
    int displacement_limited; ///< vertices whose displacement was limited, summed over substeps
    int outran; ///< points that left the margin of the search, summed over substeps; above 0 pairs may have been missed (spheres)
    int tangled;       ///< edges through triangles that were being untangled at the last search
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
