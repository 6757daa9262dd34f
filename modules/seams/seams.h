/// Seams: pairs of vertices of two surfaces, or of one, are sewn together edge to edge. Panels become garments, a flat strip becomes a
/// tube, and a seam may have a strength at which it gives way.
///
///     wisp_seam_def def = wisp_default_seam_def();
///     def.a = front, def.b = back;
///     def.pairs = pairs, def.pair_count = count;                      // or def.within = 0.05f: edges that lie side by side
///     def.strength = 5.0f;                                            // N per pair
///     wisp_entity seam;
///     wisp_add_seam( world, &def, &seam );
///     ...
///     int torn = wisp_count_broken_seam_pairs( world, seam );
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_seams_module;

/// Fill from wisp_default_seam_def(). Copied; need not outlive the call.
typedef struct wisp_seam_def
{
    uint32_t size;    ///< bytes; set by wisp_default_seam_def()
    wisp_entity a, b; ///< surfaces of any kind; the same one twice sews a surface to itself
    const int32_t*
        pairs; ///< [pair_count][2] a vertex of `a`, a vertex of `b`, the user's order; a vertex may be in several pairs
    int pair_count;
    /// m; default 0: `pairs` are given. Above 0 they are found: each boundary vertex of `a` with the nearest one of `b` within this
    /// distance, as the surfaces are now, and each boundary vertex of `b` with the nearest one of `a`
    float within;
    float distance; ///< m, that the seam holds between the vertices of a pair, >= 0, default 0: it pulls shut
    float
        closing_speed; ///< m/s, at which pairs go from their present distance to that one, > 0, default 1; infinite: at once
    float compliance; ///< m/N, of each pair, >= 0, default 0
    float strength;   ///< N, of each pair, > 0, default infinite: it never breaks
} wisp_seam_def;

WISP_DEFINITION( seam_def );

/// Sew two surfaces together by XPBD (Macklin, Mueller, Chentanez 2016, eq. 17-18): C = |x_a - x_b| - distance. In a substep seams come
/// after the constraints of the cloth and before collision and contact, which have the last word: give a seam of surfaces in
/// contact the thickness of the contact as its distance. Surfaces that are sewn have the same substeps, those of the one with the most.
/// Pinned vertices and halted surfaces pull, but are not pulled. A pair whose force is above `strength` at the end of a substep breaks
/// and stays broken. Teleport all surfaces of a seam together. wisp_remove() takes a seam away; a seam whose surface was removed joins
/// nothing.
/// @param out receives the seam, null on failure
/// @return WISP_BAD_INPUT a number is out of range, a pair has a vertex that is out of range or the same one twice (the message names
///         the pair), there are no pairs, or none within `within`; WISP_CONFLICT the module is not registered, an entity is not a
///         surface, or `within` with the same surface twice; WISP_STALE_ID; WISP_NO_MEMORY. Nothing changes then
WISP_API wisp_status wisp_add_seam( wisp_world* world, const wisp_seam_def* def, wisp_entity* out );

/// @return pairs of a seam, broken or not; 0 if it or a surface of it was removed
WISP_API int wisp_count_seam_pairs( wisp_world* world, wisp_entity seam );
/// @return how many pairs of a seam have broken; 0 if it or a surface of it was removed
WISP_API int wisp_count_broken_seam_pairs( wisp_world* world, wisp_entity seam );

WISP_END_C
