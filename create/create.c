#include "create.h"

#include "attachments.h"
#include "balloon.h"
#include "boundary.h"
#include "environment.h"
#include "frozen_hair.h"
#include "guide_hair.h"
#include "implicit_cloth.h"
#include "motion_constraints.h"
#include "membrane.h"
#include "seams.h"
#include "strand_appearance.h"
#include "tearing.h"
#include "wisp/fabric.h"
#include "wisp/module/module.h"

// ---- worlds ----

#define WISP_MODULE( name ) &wisp_##name##_module,
static const wisp_module* const ALL_MODULES[] = {
#include "modules.inc"
};
#undef WISP_MODULE

const wisp_module* const* wisp_all_modules( int* count )
{
    if ( count != NULL )
    {
        *count = WISP_COUNT( ALL_MODULES );
    }
    return ALL_MODULES;
}

// ---- what cloth and hair share ----

static wisp_status add_collision( wisp_world* world, wisp_entity entity, bool collides,
                                  const wisp_collision_def* given )
{
    const wisp_collision_def usual = wisp_default_collision_def();
    return collides ? wisp_set_collision( world, entity, given != NULL ? given : &usual ) : WISP_OK;
}

// An entity that is not whole is removed, and the message of what failed stays.
static wisp_status finish( wisp_world* world, wisp_status status, wisp_entity* entity )
{
    if ( status != WISP_OK )
    {
        wisp_world_remove( world, *entity );
        *entity = ( wisp_entity ){ 0, 0 };
    }
    return status;
}

// ---- cloth ----

static const wisp_field CLOTH_FIELDS[] = {
    WISP_NUMBER( wisp_create_cloth_def, area_density, 0.15, 1e-12, 1e12, "kg/m^2" ),
    WISP_NUMBER( wisp_create_cloth_def, damping, 0, 0, 1e9, "1/s" ),
    WISP_VECTOR( wisp_create_cloth_def, gravity, 0, 1e6, "m/s^2", 0, -9.81, 0 ),
    WISP_VECTOR( wisp_create_cloth_def, wind, 0, 1e5, "m/s", 0 ),
    WISP_NUMBER( wisp_create_cloth_def, drag_coefficient, 0, 0, 1e6, NULL ),
    WISP_NUMBER( wisp_create_cloth_def, lift_coefficient, 0, 0, 1e6, NULL ),
    WISP_SWITCH( wisp_create_cloth_def, collides, true ),
    WISP_SWITCH( wisp_create_cloth_def, normals, true ),
};
WISP_DEFINE( create_cloth_def, "cloth", CLOTH_FIELDS )

static wisp_status cook( wisp_world* world, const wisp_create_cloth_def* def, const wisp_cloth_def* material,
                         wisp_fabric** out )
{
    wisp_fabric_def fabric = wisp_default_fabric_def();
    fabric.points = def->points;
    fabric.vertex_count = def->vertex_count;
    fabric.triangles = def->triangles;
    fabric.triangle_count = def->triangle_count;
    fabric.attachments = def->pins;
    fabric.attachment_count = def->pin_count;
    fabric.bend_links = material->bending == WISP_CLOTH_BENDING_LINKS;
    fabric.hinges =
        material->bending == WISP_CLOTH_BENDING_DIHEDRAL || material->bending == WISP_CLOTH_BENDING_ISOMETRIC;
    fabric.tethers = material->tethers;
    // unless the material says otherwise: a mesh that is too small for them has none
    fabric.coarse_sheets = material->solver == WISP_SOLVER_XPBD && material->coarse_substeps != 0;
    fabric.lean = true;
    wisp_error error = { 0 };
    const wisp_status status = wisp_fabric_cook( &fabric, NULL, out, &error );
    return status == WISP_OK ? WISP_OK : wisp_world_fail( world, status, "%s", error.message );
}

static bool blows( wisp_vec3 wind )
{
    return wind.x != 0.0f || wind.y != 0.0f || wind.z != 0.0f;
}

static wisp_status apply_material( wisp_world* world, const wisp_create_cloth_def* def,
                                   const wisp_cloth_def* material, wisp_entity cloth )
{
    WISP_TRY( wisp_set_cloth( world, cloth, material ) );
    WISP_TRY( blows( def->wind ) ? wisp_set_cloth_wind( world, cloth, def->wind ) : WISP_OK );
    WISP_TRY( wisp_set_damping( world, cloth, def->damping ) );
    WISP_TRY( add_collision( world, cloth, def->collides, def->collision ) );
    WISP_TRY( def->contact != NULL ? wisp_set_contact( world, cloth, def->contact ) : WISP_OK );
    WISP_TRY( def->normals ? wisp_request( world, cloth, WISP_SURFACE_NORMALS ) : WISP_OK );
    return wisp_request( world, cloth, WISP_SURFACE_POINTS );
}

wisp_status wisp_create_cloth( wisp_world* world, const wisp_create_cloth_def* given, wisp_entity* out )
{
    if ( out != NULL )
    {
        *out = ( wisp_entity ){ 0, 0 };
    }
    wisp_create_cloth_def def;
    WISP_TRY( wisp_world_begin_def( world, NULL, &wisp_create_cloth_def_fields, &def, given ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    if ( def.vertex_count == 0 )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "cloth: got no points" );
    }
    wisp_cloth_def material = wisp_default_cloth_def();
    if ( def.material != NULL )
    {
        WISP_TRY( wisp_world_begin_def( world, NULL, &wisp_cloth_def_fields, &material, def.material ) );
    }
    material.drag_coefficient = def.drag_coefficient != 0.0f ? def.drag_coefficient : material.drag_coefficient;
    material.lift_coefficient = def.lift_coefficient != 0.0f ? def.lift_coefficient : material.lift_coefficient;
    wisp_surface_def surface = wisp_default_surface_def();
    surface.area_density = def.area_density;
    surface.gravity = def.gravity;
    surface.pins = def.pins;
    surface.pin_count = def.pin_count;
    WISP_TRY( cook( world, &def, &material, &surface.fabric ) );
    const wisp_status status = wisp_add_surface( world, &surface, out );
    wisp_fabric_release( surface.fabric );
    WISP_TRY( status );
    return finish( world, apply_material( world, &def, &material, *out ), out );
}

// ---- hair ----

static const wisp_field HAIR_FIELDS[] = {
    WISP_VECTOR( wisp_create_hair_def, wind, 0, 1e5, "m/s", 0 ),
    WISP_NUMBER( wisp_create_hair_def, drag_coefficient, 0, 0, 1e6, NULL ),
    WISP_SWITCH( wisp_create_hair_def, collides, true ),
};
WISP_DEFINE( create_hair_def, "hair", HAIR_FIELDS )

static wisp_status apply_dynamics( wisp_world* world, const wisp_create_hair_def* def, wisp_entity hair )
{
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    if ( def->dynamics != NULL )
    {
        WISP_TRY( wisp_world_begin_def( world, NULL, &wisp_strand_dynamics_def_fields, &dynamics, def->dynamics ) );
    }
    dynamics.drag_coefficient = def->drag_coefficient != 0.0f ? def->drag_coefficient : dynamics.drag_coefficient;
    WISP_TRY( wisp_set_strand_dynamics( world, hair, &dynamics ) );
    WISP_TRY( blows( def->wind ) ? wisp_set_strand_wind( world, hair, def->wind ) : WISP_OK );
    WISP_TRY( add_collision( world, hair, def->collides, def->collision ) );
    return wisp_request( world, hair, WISP_STRAND_POINTS );
}

wisp_status wisp_create_hair( wisp_world* world, const wisp_create_hair_def* given, wisp_entity* out )
{
    if ( out != NULL )
    {
        *out = ( wisp_entity ){ 0, 0 };
    }
    wisp_create_hair_def def;
    WISP_TRY( wisp_world_begin_def( world, NULL, &wisp_create_hair_def_fields, &def, given ) );
    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = def.points;
    strands.offsets = def.offsets;
    strands.strand_count = def.strand_count;
    WISP_TRY( wisp_add_strands( world, &strands, out ) );
    return finish( world, apply_dynamics( world, &def, *out ), out );
}
