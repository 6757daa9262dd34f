#include "triangle_scene.h"

#include "collision/collision.h"
#include "wisp/module/module.h"

// ---- the mesh ----

static wisp_status make_mesh( int vertices, triangle_scene* out, wisp_error* error )
{
    wisp_mesh_generator generator =
        wisp_default_mesh_generator( vertices > 0 ? WISP_MESH_DELAUNAY : WISP_MESH_PLANE_REGULAR );
    generator.vertex_count = vertices;
    generator.width = generator.depth = TRIANGLE_WIDTH;
    generator.columns = generator.rows = TRIANGLE_QUAD_SIDE;
    generator.spacing = TRIANGLE_WIDTH / ( TRIANGLE_QUAD_SIDE - 1 );
    wisp_status status = wisp_mesh_generate( &generator, &out->mesh, error );
    for ( int i = 0; status == WISP_OK && i < out->mesh.vertex_count; ++i )
    {
        out->mesh.points[i].y += TRIANGLE_HEIGHT;
    }
    return status;
}

wisp_status triangle_scene_make( int vertices, triangle_scene* out, wisp_error* error )
{
    *out = ( triangle_scene ){ .fabric = NULL };
    wisp_status status = make_mesh( vertices, out, error );
    if ( status == WISP_OK && vertices == 0 )
    {
        status = wisp_quad_pairs_make( TRIANGLE_QUAD_SIDE, TRIANGLE_QUAD_SIDE, &out->pairs, error );
    }
    status = status == WISP_OK ? surface_cook( &out->mesh, wisp_default_fabric_def(), &out->fabric, error ) : status;
    if ( status != WISP_OK )
    {
        triangle_scene_free( out );
    }
    return status;
}

void triangle_scene_free( triangle_scene* scene )
{
    wisp_fabric_release( scene->fabric );
    wisp_quad_pairs_release( &scene->pairs );
    wisp_mesh_release( &scene->mesh );
    *scene = ( triangle_scene ){ .fabric = NULL };
}

// ---- the world ----

triangle_setting triangle_default_setting( void )
{
    return ( triangle_setting ){
        .cloth = wisp_default_implicit_cloth_def(),
        .seconds = 0.01f,
        .workers = 1,
        .has_ball = true,
        .gravity = { 0.0f, -TRIANGLE_GRAVITY, 0.0f },
    };
}

static wisp_status add_cloth( const triangle_scene* scene, const triangle_setting* setting,
                              surface_implementation* out )
{
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = scene->fabric;
    surface.points = setting->points;
    surface.area_density = TRIANGLE_DENSITY;
    surface.pins = setting->pins;
    surface.pin_count = setting->pin_count;
    surface.gravity = setting->gravity;
    wisp_implicit_cloth_def cloth = setting->cloth;
    cloth.stretch_pairs = scene->pairs.stretch;
    cloth.stretch_pair_count = scene->pairs.stretch_count;
    cloth.bend_pairs = scene->pairs.bend;
    cloth.bend_pair_count = scene->pairs.bend_count;
    wisp_status status = wisp_add_surface( out->world, &surface, &out->entity );
    status = status ? status : wisp_set_implicit_cloth( out->world, out->entity, &cloth );
    if ( status == WISP_OK && setting->requests_stats )
    {
        status = wisp_request_implicit_cloth_stats( out->world, out->entity, true );
    }
    return status ? status : wisp_request( out->world, out->entity, WISP_SURFACE_POINTS );
}

wisp_status triangle_add_ball( surface_implementation* implementation )
{
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.radius = TRIANGLE_BALL_RADIUS;
    ball.pose.translation = ( wisp_vec3 ){ 0.0f, TRIANGLE_BALL_HEIGHT, 0.0f };
    ball.static_friction = TRIANGLE_STATIC_FRICTION;
    ball.kinetic_friction = TRIANGLE_KINETIC_FRICTION;
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = TRIANGLE_MARGIN;
    wisp_entity entity;
    wisp_status status = wisp_add_collider( implementation->world, &ball, &entity );
    return status ? status : wisp_set_collision( implementation->world, implementation->entity, &collision );
}

wisp_status triangle_enter( const triangle_scene* scene, const triangle_setting* setting, surface_implementation* out,
                            wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_collision_module, &wisp_implicit_cloth_module };
    *out = ( surface_implementation ){ .fabric = scene->fabric };
    out->generator = surface_default_generator( &wisp_implicit_cloth_module, scene->fabric );
    out->generator.gravity = setting->gravity;
    out->generator.seconds = setting->seconds;
    const bench_world_def def = { modules, WISP_COUNT( modules ), .workers = setting->workers };
    wisp_status status = bench_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_cloth( scene, setting, out );
    status = status == WISP_OK && setting->has_ball ? triangle_add_ball( out ) : status;
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        surface_implementation_destroy( out );
    }
    return status;
}
