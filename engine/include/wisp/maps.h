/// Maps: parameters of a surface that differ from vertex to vertex.
///
/// A map is a list of factors. Each multiplies the constant that the surface or its effect was given, so a change of the
/// constant keeps the pattern, and a map of ones changes no bit of what is computed, but for drag, lift and internal
/// damping, which may round differently. A surface without a map has no column, no pass and no other kernel for it.
///
///     wisp_set_cloth( world, cloth, &material );
///     wisp_set_map( world, cloth, WISP_MAP_BEND_RIGIDITY, stiff_where_embroidered, vertex_count );
///
/// | map                          | multiplies                                              | of             |
/// |------------------------------|---------------------------------------------------------|----------------|
/// | WISP_MAP_AREA_DENSITY        | area_density, or vertex_mass; 1e-6 to 1e6               | surfaces       |
/// | WISP_MAP_DAMPING             | the rate of wisp_set_damping()                          | surfaces       |
/// | WISP_MAP_STRETCH_COMPLIANCE  | warp, weft and shear compliance, of coarse sheets too   | cloth, xpbd    |
/// | WISP_MAP_STRETCH_STIFFNESS   | stretch and shear stiffness; the product is at most 1   | cloth, pbd     |
/// | WISP_MAP_BEND_COMPLIANCE     | bend_compliance                                         | cloth, xpbd, bend links |
/// | WISP_MAP_BEND_STIFFNESS      | bend_stiffness; the product is at most 1                | cloth, pbd     |
/// | WISP_MAP_BEND_RIGIDITY       | bend_rigidity, not that of sharp folds                  | cloth, xpbd, dihedral or isometric |
/// | WISP_MAP_INTERNAL_DAMPING    | internal_damping; momenta are kept                      | cloth          |
/// | WISP_MAP_DRAG, WISP_MAP_LIFT | drag_coefficient, lift_coefficient                      | cloth          |
/// | WISP_MAP_COLLISION_THICKNESS | thickness of the collision, which is the largest: 0 to 1; not that of the collider | surfaces that collide |
/// | WISP_MAP_COLLISION_FRICTION  | friction_scale                                          | surfaces that collide |
/// | WISP_MAP_CONTACT_THICKNESS   | thickness of the contact, which is the largest: 0.01 to 1 | surfaces with contact |
/// | WISP_MAP_CONTACT_FRICTION    | friction                                                | surfaces with contact |
///
/// Bodies and other participants are searched within the largest thickness, so a map of thickness makes no search shorter. A
/// point on an edge or a triangle, or a boundary particle, has the mean of the corners by its weights; an edge or a triangle
/// that collides with a body (WISP_COLLISION_ALL) the mean of its corners.
///
/// A map waits while the effect is changed so that nothing has its constant, and acts again afterwards. Snapshots hold maps. An
/// instance has the map of area density of its source, as it was, and no other map, as it has no effect.
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

/// Set or replace a map of a surface. An edge has the mean of its ends, a triangle that of its corners, a link
/// of a coarse sheet that of the edges along it, by their lengths.
/// @param map WISP_MAP_...
/// @param factors [count] in the user's order, 0 to 1e6 unless the table says otherwise; null removes the map. Copied
/// @param count the number of vertices; ignored if the map is removed
/// @return WISP_BAD_INPUT another count, or a factor out of range (the message has both counts, or the vertex); WISP_CONFLICT
///         the entity is no surface, or nothing that it has has this constant; WISP_NO_MEMORY. Nothing changes then
WISP_API wisp_status wisp_set_map( wisp_world* world, wisp_entity surface, wisp_component map, const float* factors,
                                   int count );

WISP_END_C
