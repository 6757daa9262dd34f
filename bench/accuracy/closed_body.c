// A cloth of a closed form, from its mesh to its figures.
#include "closed_forms.h"

#include "collision/collision.h"

wisp_status closed_make_plane( int columns, int rows, double spacing, closed_body* out, wisp_error* error )
{
    wisp_mesh_recipe recipe = wisp_default_mesh_recipe( WISP_MESH_PLANE_REGULAR );
    recipe.columns = columns;
    recipe.rows = rows;
    recipe.spacing = (float)spacing;
    return wisp_mesh_make( &recipe, &out->mesh, error );
}

surface_recipe closed_recipe( const closed_run* run )
{
    surface_recipe recipe = surface_default_recipe( &wisp_cloth_module, NULL );
    recipe.second = &wisp_collision_module;
    recipe.gravity = ( wisp_vec3 ){ 0.0f, (float)-CLOSED_GRAVITY, 0.0f };
    recipe.substeps = run->knob;
    recipe.workers = run->workers;
    recipe.seconds = ACCURACY_FRAME;
    return recipe;
}

wisp_status closed_enter( const closed_run* run, surface_recipe recipe, const wisp_cloth_def* cloth,
                          closed_body* body, wisp_error* error )
{
    wisp_fabric_def def = wisp_default_fabric_def();
    def.cross_links = false;
    def.hinges = cloth->bending == WISP_CLOTH_BENDING_DIHEDRAL;
    wisp_status status = surface_cook( &body->mesh, def, &body->fabric, error );
    recipe.fabric = body->fabric;
    status = status == WISP_OK ? surface_entrant_create( &recipe, &body->entrant, error ) : status;
    if ( status == WISP_OK )
    {
        status = wisp_set_cloth( body->entrant.world, body->entrant.entity, cloth );
        status = status == WISP_OK ? accuracy_want_quality( &body->entrant, run->is_looked_at, error )
                                   : bench_world_fail( body->entrant.world, status, error );
    }
    return status;
}

wisp_status closed_advance( closed_run* run, closed_body* body, int steps, wisp_quality* quality, wisp_error* error )
{
    wisp_quality seen = { 0 };
    wisp_status status = accuracy_step_surface( &body->entrant, steps, run->out, error );
    status = status == WISP_OK ? accuracy_end_surface( &body->entrant, run->out, error ) : status;
    if ( status == WISP_OK && run->is_looked_at )
    {
        status = accuracy_read_quality( &body->entrant, &seen, error );
        run->strain = seen.strain_max;
    }
    if ( quality )
    {
        *quality = seen;
    }
    return status;
}

void closed_leave( closed_body* body )
{
    surface_entrant_destroy( &body->entrant );
    wisp_fabric_release( body->fabric );
    wisp_mesh_release( &body->mesh );
}
