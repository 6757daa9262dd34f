/// Components and passes of the module.
#pragma once

#include "cloth.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"
#include "wisp/module/plate.h"

/// Bending of one surface.
typedef struct cloth_plate
{
    wisp_plate* plate;
    int lowered; // triangles that are scaled down
} cloth_plate;

/// The components, a row each: X( member, "name", table, columns ).
#define CLOTH_COMPONENTS( X )                                                                                        \
    X( air, "cloth.air", ENTITY, WISP_COLUMN( cloth_air, air, 1 ) )                                                  \
    X( damping, "cloth.damping", ENTITY, WISP_COLUMN( float, rate, 1 ) )                                             \
    X( bending, "cloth.bending", ENTITY, WISP_COLUMN( float, rigidity, 1 ) ) /* N m, of bending by curvature */

typedef struct cloth_state
{
    CLOTH_COMPONENTS( WISP_COMPONENT_MEMBER )
    wisp_objects* plates; // cloth_plate
} cloth_state;

/// Air around a cloth.
typedef struct cloth_air
{
    wisp_vec3 wind; ///< m/s
    float density;  ///< kg/m^3
    float drag, lift;
} cloth_air;

/// Find the stiffness or compliance of edges and of bend links; the first is below 0 if links differ. @return whether each kind has one
bool cloth_find_alike( const wisp_fabric* f, const wisp_cloth_def* def, float alike[2] );
/// Fill the columns of links and hinges from a checked definition.
void cloth_fill_links( wisp_world* world, wisp_entity surface, const wisp_cloth_def* def );
/// Fill the links of coarse sheets, if the surface has them.
void cloth_fill_levels( wisp_world* world, wisp_entity surface, const wisp_cloth_def* def );
void cloth_fill_hinges( wisp_world* world, wisp_entity surface, const wisp_cloth_def* def );

// ---- cloth bending ----

/// Bending of xpbd cloth: a matrix a surface, kept by the module, and the pass that solves with it.

/// Cook the plate of a surface, unless it has one that serves. @param by_angle for bending by angle
wisp_status cloth_add_plate( wisp_world* world, const cloth_state* state, wisp_entity surface, bool by_angle );
void cloth_release_plate( void* plate, const wisp_allocator* allocator );

/// The pass.
void cloth_bend( wisp_frame* frame, const wisp_span* span, void* user );
