#include "cloth_scene.h"

#include <stdlib.h>

wisp_status cloth_scene_make( int n, bool is_irregular, cloth_scene* out, wisp_error* error )
{
    *out = ( cloth_scene ){ .n = n, .pins = { 0, n - 1 } };
    wisp_mesh_generator generator =
        wisp_default_mesh_generator( is_irregular ? WISP_MESH_PLANE_IRREGULAR : WISP_MESH_PLANE_ALTERNATING );
    generator.columns = n;
    generator.rows = n;
    generator.spacing = CLOTH_SPACING;
    return wisp_mesh_generate( &generator, &out->mesh, error );
}

void cloth_scene_free( cloth_scene* scene )
{
    wisp_mesh_release( &scene->mesh );
}

wisp_status cloth_cook( const cloth_scene* scene, wisp_fabric** out, wisp_error* error )
{
    wisp_fabric_def def = wisp_default_fabric_def();
    def.attachments = scene->pins;
    def.attachment_count = WISP_COUNT( scene->pins );
    return surface_cook( &scene->mesh, def, out, error );
}

wisp_status cloth_implementation_create( const cloth_scene* scene, wisp_fabric* fabric, const cloth_setting* setting,
                                         int workers, surface_implementation* out, wisp_error* error )
{
    surface_generator generator = surface_default_generator( &wisp_cloth_module, fabric );
    generator.pins = scene->pins;
    generator.pin_count = WISP_COUNT( scene->pins );
    generator.vertex_mass = 1.0f;
    generator.gravity = ( wisp_vec3 ){ 0.0f, -CLOTH_GRAVITY, 0.0f };
    generator.substeps = setting->substeps;
    generator.iterations = setting->iterations;
    generator.workers = workers;
    wisp_status status = surface_implementation_create( &generator, out, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_cloth_def def = wisp_default_cloth_def();
    def.solver = WISP_SOLVER_PBD;
    def.bend_stiffness = CLOTH_BEND_STIFFNESS;
    status = wisp_set_cloth( out->world, out->entity, &def );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        surface_implementation_destroy( out );
    }
    return status;
}
