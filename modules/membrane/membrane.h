/// Membranes: a surface of a thin rubber-like solid with a strain energy instead of links. A balloon of it has the pressure of a
/// rubber balloon, which falls again when it is stretched by more than 7^(1/6).
///
///     wisp_membrane_def rubber = wisp_default_membrane_def();       // latex of 0.2 mm
///     wisp_set_membrane( world, surface, &rubber );                 // before cloth or balloon
///     wisp_set_balloon( world, surface, &gas );                     // gas inside; its skin has no links now
///
/// A membrane does not bend, and air does not act on it: wisp_set_cloth() adds both, a balloon has its own air.
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_membrane_module;

/// Fill from wisp_default_membrane_def(). Copied.
///
/// The energy per area at rest is G / 2 (s1^2 + s2^2 + 1 / (s1 s2)^2 - 3), with the principal stretches s1, s2 of a triangle and G the
/// shear modulus times the thickness: neo-Hookean, of a solid that keeps its volume (Treloar 1943). A strip that is pulled a little has
/// the stiffness 3 G times its width, and Poisson's ratio 1/2.
typedef struct wisp_membrane_def
{
    uint32_t size;       ///< bytes; set by wisp_default_membrane_def()
    float shear_modulus; ///< Pa, > 0, default 4e5 (latex)
    float thickness;     ///< m, at rest, > 0, default 2e-4; the mass is that of the surface's area density
    /// Default false: triangles resist compression, and a mesh that is fine enough wrinkles by itself. True: a triangle that is narrower
    /// than its pull makes it holds no compression, as if it had wrinkles finer than itself (Pipkin 1986)
    bool tension_field;
} wisp_membrane_def;

WISP_DEFINITION( membrane_def );

/// Make a surface a membrane, or change the membrane it is. Its triangles are projected in place of links, one after the other by
/// colours, each by implicit Euler of its own energy, so a membrane of any stiffness is stable with substeps of any length. With few of
/// them it is softer than its modulus, as links are (docs/methods.md). Balloon and cloth that are set later have no links: what they say
/// of stretch counts nothing.
/// @param def null: the surface is a membrane no more, and nothing holds it or its gas until a cloth or a balloon is set (again)
/// @return WISP_CONFLICT the module is not registered, the entity is not a surface, or it has links already (a cloth, a balloon) or
///         another solver; WISP_BAD_INPUT a value is out of range; WISP_NO_MEMORY
WISP_API wisp_status wisp_set_membrane( wisp_world* world, wisp_entity surface, const wisp_membrane_def* def );

WISP_END_C
