/// Contact: surfaces that keep their distance from each other and from themselves, and strands from surfaces. Cloth does not
/// pass through cloth, balloons press on each other, flatten and share forces; friction is Coulomb's; momentum is kept
/// (BND-X4, BAL-X1, TRI-X2). Bodies that only move as they are told belong to the module collision.
#pragma once

#include "wisp/variants.h"
#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_contact_module;

/// What is kept apart.
typedef enum wisp_contact_primitives
{
    /// Vertices from triangles and edges from edges. What starts without intersections ends every step without: no vertex
    /// goes farther than the separating planes of its pairs allow. A pinned vertex goes where it is told; what it is put
    /// through is drawn apart.
    WISP_CONTACT_TRIANGLES,
    /// Boundary particles from each other, as balls of the thickness, a spacing apart on the rest shape: what is finer than
    /// their spacing passes, so the spacing sets both the price and what is missed (benchmark, case contact).
    WISP_CONTACT_PARTICLES,
    WISP_CONTACT_PRIMITIVES_COUNT,
} wisp_contact_primitives;

/// How the contacts of a world are found. Fill from wisp_default_contact_settings(). Copied.
typedef struct wisp_contact_settings
{
    wisp_contact_primitives primitives; ///< default exact
    wisp_pair_search search;            ///< default auto; changes the time and not the result
    float particle_spacing;             ///< m, > 0, with samples; default 0: the least thickness of the participants
    /// Of the thickness: how much farther than it pairs are looked for, > 0; more makes lists longer and searches rarer, and
    /// changes no bit. Default 1
    float margin;
    bool
        displacement_limit; ///< default true: displacements are cut before they cross (exact only). False shows what it costs
    uint32_t cookie;
} wisp_contact_settings;

WISP_API wisp_contact_settings wisp_default_contact_settings( void );

/// @return WISP_BAD_INPUT a value is out of range (the message names it); WISP_CONFLICT the module is not registered;
///         WISP_NO_MEMORY
WISP_API wisp_status wisp_set_contact_settings( wisp_world* world, const wisp_contact_settings* settings );

/// How a surface, or strands, take part. Fill from wisp_default_contact_def(). Copied.
typedef struct wisp_contact_def
{
    float
        thickness; ///< m; two participants keep half of the sum of theirs apart; default 0: a quarter of the mean rest length
                   ///< of the edges (segments). Must stay below the shortest edges to lie flat
    float friction; ///< mu >= 0, default 0.3; of two participants the geometric mean
    bool self;      ///< default true: a surface keeps its distance from itself; strands never do
    float
        max_push_out_speed; ///< m/s, >= 0: how fast what is too near is parted, which gives it no velocity; default 0: ten
                            ///< thicknesses a second
    uint32_t layers, mask; ///< bits, default 1 and all: two participants meet if each has a layer of the other's mask
    bool enabled;          ///< default true
    uint32_t cookie;
} wisp_contact_def;

WISP_API wisp_contact_def wisp_default_contact_def( void );

/// Let a surface or strands take part in contact, or change how they do. Vertices that are pinned push and are not pushed.
/// @return WISP_BAD_INPUT a value is out of range (the message names it); WISP_CONFLICT the module is not registered,
///         or the entity is neither a surface nor strands with dynamics, or a surface that another module solves for
///         (implicit cloth); WISP_NO_MEMORY
WISP_API wisp_status wisp_set_contact( wisp_world* world, wisp_entity participant, const wisp_contact_def* def );
/// Take no part any more.
WISP_API wisp_status wisp_unset_contact( wisp_world* world, wisp_entity participant );

/// What contact did in the last step, over all participants.
typedef struct wisp_contact_stats
{
    int participants, points, edges, triangles; ///< that take part; with samples, points are boundary particles
    int64_t
        candidates; ///< pairs that may meet before pairs are looked for anew: of particles, or else of patches, each of
                    ///< some triangles that lie together
    int contacts;   ///< pairs that pressed on each other in the last substep
    int searches;   ///< in this step, for all pairs
    float min_gap; ///< of the pairs' thickness: the nearest pair at the end; 1 or more: none is nearer than it should
    int limited;   ///< vertices whose way was cut in this step, summed over substeps; above 0 momentum is not kept
    int tangled;   ///< edges through triangles that were being drawn apart at the last search
    int intersections; ///< edges that pass through triangles at the end of the step, exact; -1 unless asked for
    double pushed
        [3]; ///< N s, of what was pushed apart in this step by all pairs: equal and opposite, so 0 but for rounding
    double impulse; ///< N s, sum of the pairs' magnitudes in this step
} wisp_contact_stats;

/// Ask for figures from the next step on; intersections are counted on request, for they cost a search.
WISP_API wisp_status wisp_request_contact_stats( wisp_world* world, bool requested, bool count_intersections );
/// @return WISP_CONFLICT nobody asked, no participant takes part, or no step was made since
WISP_API wisp_status wisp_read_contact_stats( wisp_world* world, wisp_contact_stats* out );

/// The impulse that contact gave a participant in the last step, N s; of all participants together it is zero but for rounding, unless
/// pins take part. @return WISP_CONFLICT as wisp_read_contact_stats()
WISP_API wisp_status wisp_read_contact_impulse( wisp_world* world, wisp_entity participant, double out[3] );

WISP_END_C
