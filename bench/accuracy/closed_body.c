// The cloth of a closed form, from its mesh to its statistics.
#include "closed_forms.h"

#include "collision/collision.h"

surface_generator closed_generator( const closed_run* run )
{
    surface_generator generator = surface_default_generator( &wisp_cloth_module, NULL );
    generator.second = &wisp_collision_module;
    generator.gravity = ( wisp_vec3 ){ 0.0f, (float)-CLOSED_GRAVITY, 0.0f };
    generator.substeps = run->parameter;
    generator.workers = run->workers;
    generator.seconds = ACCURACY_FRAME;
    return generator;
}

wisp_status closed_enter( const closed_run* run, surface_generator generator, const wisp_cloth_def* cloth,
                          closed_body* body, wisp_error* error )
{
    wisp_fabric_def def = wisp_default_fabric_def();
    def.bend_links = false;
    def.hinges = cloth->bending == WISP_CLOTH_BENDING_DIHEDRAL;
    wisp_status status = surface_cook( &body->mesh, def, &body->fabric, error );
    generator.fabric = body->fabric;
    status = status == WISP_OK ? surface_implementation_create( &generator, &body->implementation, error ) : status;
    if ( status == WISP_OK )
    {
        status = wisp_set_cloth( body->implementation.world, body->implementation.entity, cloth );
        status = status == WISP_OK ? accuracy_request_motion_stats( &body->implementation, run->is_observed, error )
                                   : bench_world_fail( body->implementation.world, status, error );
    }
    return status;
}

wisp_status closed_advance( closed_run* run, closed_body* body, int steps, wisp_motion_stats* motion_stats,
                            wisp_error* error )
{
    wisp_motion_stats seen = { 0 };
    wisp_status status = accuracy_step_surface( &body->implementation, steps, run->out, error );
    status = status == WISP_OK ? accuracy_end_surface( &body->implementation, run->out, error ) : status;
    if ( status == WISP_OK && run->is_observed )
    {
        status = accuracy_read_motion_stats( &body->implementation, &seen, error );
        run->strain = seen.strain_max;
    }
    if ( motion_stats )
    {
        *motion_stats = seen;
    }
    return status;
}

void closed_leave( closed_body* body )
{
    surface_implementation_destroy( &body->implementation );
    wisp_fabric_release( body->fabric );
    wisp_mesh_release( &body->mesh );
}
