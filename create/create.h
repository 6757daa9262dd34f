/// One call for the common case: a cloth, hair. Each function is a thin cover over the functions that it names; what it makes can be
/// changed with those.
///
///     wisp_world_def world_def = wisp_default_world_def();
///     world_def.modules = wisp_all_modules( &world_def.module_count );
///     wisp_world* world;
///     wisp_world_create( &world_def, &world, NULL );
///     wisp_create_cloth_def def = wisp_default_create_cloth_def();
///     def.points = points, def.vertex_count = vertex_count;
///     def.triangles = triangles, def.triangle_count = triangle_count;
///     def.pins = corners, def.pin_count = 2;
///     wisp_entity cloth;
///     wisp_create_cloth( world, &def, &cloth );                // hangs, collides with colliders, and has points and normals
#pragma once

#include "cloth.h"
#include "collision.h"
#include "contact.h"
#include "strands.h"
#include "wisp/wisp.h"

WISP_BEGIN_C

/// List the modules of the library, for wisp_world_def.modules. Those without entities cost nothing in a step.
/// @param count receives how many; may be null
/// @return [count] static
WISP_API const wisp_module* const* wisp_all_modules( int* count );

/// A cloth of a triangle mesh. Fill from wisp_default_create_cloth_def(). Copied; need not outlive the call.
typedef struct wisp_create_cloth_def
{
    uint32_t size;            ///< bytes; set by wisp_default_create_cloth_def()
    const wisp_vec3* points;  ///< [vertex_count] m, rest shape and start
    const int32_t* triangles; ///< [triangle_count][3] counter-clockwise
    int vertex_count, triangle_count;
    const int32_t* pins; ///< [pin_count] vertices that move only by wisp_move_pins()
    int pin_count;
    float area_density; ///< kg/m^2, default 0.15
    float damping;      ///< 1/s, of all velocities, default 0
    wisp_vec3 gravity;  ///< m/s^2, default (0, -9.81, 0)
    wisp_vec3 wind;     ///< m/s, default 0: that of the material. Without a coefficient as with wisp_set_cloth_wind()
    float drag_coefficient, lift_coefficient; ///< default 0: those of the material
    const wisp_cloth_def*
        material;  ///< default null: that of wisp_default_cloth_def(). The fabric is cooked with what it needs:
                   ///< hinges, tethers, and coarse sheets unless coarse_substeps is 0
    bool collides; ///< with the colliders of the world, default true; needs the module collision
    const wisp_collision_def* collision; ///< how; default null: wisp_default_collision_def()
    const wisp_contact_def*
        contact;  ///< default null: cloth passes through itself and other cloth; needs the module contact
    bool normals; ///< request WISP_SURFACE_NORMALS too, default true
} wisp_create_cloth_def;

WISP_DEFINITION( create_cloth_def );

/// Create a cloth: wisp_fabric_cook(), wisp_add_surface(), wisp_set_cloth(), wisp_set_collision() and wisp_request().
/// @param out receives the entity, null on failure; nothing of it is left in the world then
/// @return WISP_BAD_INPUT there are no points; the status of the call that failed; wisp_world_message() has its message
WISP_API wisp_status wisp_create_cloth( wisp_world* world, const wisp_create_cloth_def* def, wisp_entity* out );

/// Hair that moves. Fill from wisp_default_create_hair_def(). Copied; need not outlive the call.
typedef struct wisp_create_hair_def
{
    uint32_t size;           ///< bytes; set by wisp_default_create_hair_def()
    const wisp_vec3* points; ///< [offsets[strand_count]] m, roots first
    const int32_t* offsets;  ///< [strand_count + 1] first vertex of each strand
    int strand_count;
    wisp_vec3 wind; ///< m/s, default 0: that of the dynamics. Without a coefficient as with wisp_set_strand_wind()
    float drag_coefficient; ///< default 0: that of the dynamics
    const wisp_strand_dynamics_def*
        dynamics;                        ///< default null: wisp_default_strand_dynamics_def(), straight human hair
    bool collides;                       ///< with the colliders of the world, default true
    const wisp_collision_def* collision; ///< how; default null: wisp_default_collision_def()
} wisp_create_hair_def;

WISP_DEFINITION( create_hair_def );

/// Create hair: wisp_add_strands(), wisp_set_strand_dynamics(), wisp_set_collision() and wisp_request() of WISP_STRAND_POINTS. Move it
/// with wisp_move_strand_head().
/// @param out receives the entity, null on failure; nothing of it is left in the world then
/// @return as wisp_create_cloth()
WISP_API wisp_status wisp_create_hair( wisp_world* world, const wisp_create_hair_def* def, wisp_entity* out );

WISP_END_C
