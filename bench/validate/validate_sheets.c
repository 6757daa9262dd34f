#include "validate_sheets.h"

#include "surface_implementation.h"
#include "validate_material.h"

#include "balloon/balloon.h"
#include "collision/collision.h"
#include "strands/strands.h"
#include "wisp/fabric.h"

const char* const sheet_solver_names[SHEET_SOLVER_COUNT] = { "strands",   "xpbd",     "dihedral",
                                                             "isometric", "implicit", "balloon" };

// Volumes of gas in a balloon: the air dents one that is slack.
static const float TAUT = 1.05f;

enum
{
    CLOTH_ITERATIONS = 8, // links of a sheet converge slowly
};

static bool is_cloth( sheet_solver solver )
{
    return solver == SHEET_XPBD || solver == SHEET_DIHEDRAL || solver == SHEET_ISOMETRIC;
}

wisp_status sheet_world_create( sheet_solver solver, int substeps, int workers, bool has_ground, validate_world* out,
                                wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_strands_module, &wisp_cloth_module,
                                                  &wisp_implicit_cloth_module, &wisp_balloon_module,
                                                  &wisp_collision_module };
    const bench_world_def def = { modules, WISP_COUNT( modules ), workers, substeps,
                                  is_cloth( solver ) ? CLOTH_ITERATIONS : 1 };
    wisp_status status = validate_world_create( &def, out, error );
    if ( status != WISP_OK || !has_ground )
    {
        return status;
    }
    wisp_collider_def ground = wisp_default_collider_def();
    ground.kind = WISP_COLLIDER_PLANE;
    ground.static_friction = ground.kinetic_friction = 1.0f;
    wisp_entity plane;
    status = wisp_add_collider( out->world, &ground, &plane );
    return status == WISP_OK ? WISP_OK : bench_world_fail( out->world, status, error );
}

// ---- materials ----

static wisp_status set_implicit( wisp_world* world, wisp_entity surface, const sheet_def* def )
{
    const wisp_implicit_cloth_def cloth = validate_implicit_material( def->rigidity, def->stiffness );
    return wisp_set_implicit_cloth( world, surface, &cloth );
}

static wisp_status set_cloth( wisp_world* world, wisp_entity surface, const sheet_def* def )
{
    wisp_cloth_def cloth = validate_cloth_material( def->solver == SHEET_DIHEDRAL    ? WISP_CLOTH_BENDING_DIHEDRAL
                                                    : def->solver == SHEET_ISOMETRIC ? WISP_CLOTH_BENDING_ISOMETRIC
                                                                                     : WISP_CLOTH_BENDING_NONE,
                                                    def->rigidity, def->stiffness );
    cloth.air_density = SHEET_AIR;
    cloth.drag_coefficient = (float)def->drag;
    return wisp_set_cloth( world, surface, &cloth );
}

static wisp_status set_balloon( wisp_world* world, wisp_entity surface, const sheet_def* def )
{
    wisp_balloon_def balloon = wisp_default_balloon_def();
    balloon.drag_coefficient = (float)def->drag;
    balloon.gas_ratio = TAUT;
    return wisp_set_balloon( world, surface, &balloon );
}

static wisp_status set_material( wisp_world* world, wisp_entity surface, const sheet_def* def )
{
    return def->solver == SHEET_IMPLICIT  ? set_implicit( world, surface, def )
           : def->solver == SHEET_BALLOON ? set_balloon( world, surface, def )
                                          : set_cloth( world, surface, def );
}

// ---- bodies ----

static wisp_status add_strand( validate_world* w, const sheet_def* def, wisp_entity* out )
{
    const int32_t offsets[2] = { 0, def->row };
    const bool is_pinned = def->pin_count > 0;
    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = def->start != NULL ? def->start : def->mesh->points;
    strands.offsets = offsets;
    strands.strand_count = 1;
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.bending = WISP_STRAND_BEND_NONE;
    dynamics.line_density = (float)( def->density * SHEET_STRAND_WIDTH );
    dynamics.diameter = (float)SHEET_STRAND_WIDTH;
    dynamics.gravity = def->gravity;
    dynamics.damping = (float)def->damping;
    dynamics.air_density = SHEET_AIR;
    dynamics.drag_coefficient = (float)def->drag;
    dynamics.free_roots = !is_pinned;
    wisp_status status = wisp_add_strands( w->world, &strands, out );
    status = status == WISP_OK ? wisp_set_strand_dynamics( w->world, *out, &dynamics ) : status;
    status =
        status == WISP_OK && is_pinned ? wisp_hold_strand_tip( w->world, *out, 0, WISP_STRAND_TIP_PINNED ) : status;
    return status == WISP_OK ? validate_world_add( w, *out, WISP_STRAND_POINTS, def->row ) : status;
}

static wisp_status add_surface( validate_world* w, const sheet_def* def, wisp_fabric* fabric, wisp_entity* out )
{
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = fabric;
    surface.points = def->start;
    surface.area_density = (float)def->density;
    surface.pins = def->pins;
    surface.pin_count = def->pin_count;
    surface.gravity = def->gravity;
    wisp_status status = wisp_add_surface( w->world, &surface, out );
    status = status == WISP_OK ? wisp_set_damping( w->world, *out, (float)def->damping ) : status;
    status = status == WISP_OK ? set_material( w->world, *out, def ) : status;
    return status == WISP_OK ? validate_world_add( w, *out, WISP_SURFACE_POINTS, def->mesh->vertex_count ) : status;
}

static wisp_status set_friction( wisp_world* world, wisp_entity entity, double friction )
{
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = SHEET_MARGIN;
    collision.friction_scale = (float)friction; // of the ground's, which is 1
    return wisp_set_collision( world, entity, &collision );
}

wisp_status sheet_add( validate_world* w, const sheet_def* def, bool is_watched, wisp_error* error )
{
    wisp_fabric_def cooked = wisp_default_fabric_def();
    cooked.hinges = def->solver == SHEET_DIHEDRAL || def->solver == SHEET_ISOMETRIC;
    cooked.bend_links = def->solver == SHEET_IMPLICIT || def->solver == SHEET_BALLOON;
    wisp_fabric* fabric = NULL;
    wisp_entity entity;
    wisp_status status = def->solver != SHEET_STRANDS ? surface_cook( def->mesh, cooked, &fabric, error ) : WISP_OK;
    if ( status != WISP_OK )
    {
        return status;
    }
    status = fabric != NULL ? add_surface( w, def, fabric, &entity ) : add_strand( w, def, &entity );
    status = status == WISP_OK && def->friction >= 0.0 ? set_friction( w->world, entity, def->friction ) : status;
    status = status == WISP_OK && is_watched ? wisp_request( w->world, entity, WISP_MOTION_STATS ) : status;
    wisp_fabric_release( fabric );
    return status == WISP_OK ? WISP_OK : bench_world_fail( w->world, status, error );
}
