// Surfaces: what no table can say about an entry, and the list of them.
#include "scene_detail.h"
#include "scene_parts.h"
#include "scene_start.h"

#include <math.h>

// ---- an entry ----

static wisp_status check_source( scene_reader* r, const scene_node* node, const wisp_scene_surface* surface )
{
    static const char* const fabric_keys[] = { "repair", "weld_distance", "require", "solve_order", "tile_size" };
    const bool instance = scene_child( r, node, "instance_of" ) != NULL;
    int sources = ( surface->mesh.file != NULL ) + surface->mesh.is_generated + instance;
    if ( sources == 0 )
    {
        return scene_refuse_node( r, node, "got none of 'file', 'generate' and 'instance_of', expected one of them" );
    }
    if ( sources > 1 )
    {
        return scene_refuse_node( r, node,
                                  "got more than one of 'file', 'generate' and 'instance_of', expected one of them" );
    }
    for ( int i = 0; instance && i < WISP_COUNT( fabric_keys ); ++i )
    {
        const scene_node* child = scene_child( r, node, fabric_keys[i] );
        if ( child )
        {
            return scene_refuse_node( r, child, "'%s' is not possible with 'instance_of'", fabric_keys[i] );
        }
    }
    const scene_node* transform = scene_child( r, node, "transform" );
    const scene_node* scale = instance && transform ? scene_child( r, transform, "scale" ) : NULL;
    return scale ? scene_refuse_node( r, scale, "'scale' is not possible with 'instance_of'" )
                 : scene_check_weld( r, node, &surface->mesh );
}

static wisp_status check_cloth( scene_reader* r, const scene_node* node, const wisp_scene_surface* s )
{
    const wisp_vec3 warp = s->cloth.warp;
    if ( !( fabsf( warp.x ) + fabsf( warp.y ) + fabsf( warp.z ) >= 1e-5f ) )
    {
        return scene_refuse_node( r, node, "cloth.warp is zero" );
    }
    if ( s->cloth.coarse_substeps > 0 && s->cloth.solver == WISP_SOLVER_PBD )
    {
        return scene_refuse_node( r, node, "cloth.coarse_substeps needs the solver xpbd, but 'solver' is pbd" );
    }
    return WISP_OK;
}

static wisp_status check_balloon( scene_reader* r, const scene_node* node, const wisp_scene_surface* s )
{
    const wisp_balloon_def* b = &s->balloon;
    if ( b->outlet_count > 0 && s->has_outlet_nearest )
    {
        return scene_refuse_node( r, node,
                                  "got both balloon.outlet and balloon.outlet_nearest, expected one of them" );
    }
    if ( b->outlet_open && b->outlet_count == 0 && !s->has_outlet_nearest )
    {
        return scene_refuse_node( r, node, "balloon.outlet_open is true, but the balloon has no outlet" );
    }
    if ( s->outlet_radius > 0.0f && !s->has_outlet_nearest )
    {
        return scene_refuse_node( r, node, "balloon.outlet_radius needs balloon.outlet_nearest" );
    }
    if ( b->gas_ratio < b->min_gas_ratio )
    {
        return scene_refuse_node( r, node, "got balloon.gas_ratio %g, expected at least balloon.min_gas_ratio, %g",
                                  (double)b->gas_ratio, (double)b->min_gas_ratio );
    }
    for ( int i = 0; i < s->gas_ratio_keyframe_count; ++i )
    {
        if ( s->gas_ratio_keyframes[i].gas_ratio < b->min_gas_ratio )
        {
            return scene_refuse_node(
                r, node, "got %g in balloon.gas_ratio_keyframes[%d], expected at least balloon.min_gas_ratio, %g",
                (double)s->gas_ratio_keyframes[i].gas_ratio, i, (double)b->min_gas_ratio );
        }
    }
    return WISP_OK;
}

// What is refused of a plane is not what an instance shares: that is known once its source is.
static wisp_status check_quad_links( scene_reader* r, const scene_node* node, const wisp_scene_mesh* mesh )
{
    return mesh->is_generated && mesh->generator.shape == WISP_MESH_PLANE_REGULAR
               ? WISP_OK
               : scene_refuse_node( r, node, "implicit.links 'quad' needs 'generate: { shape: plane }'" );
}

static wisp_status check_implicit( scene_reader* r, const scene_node* node, const wisp_scene_surface* s )
{
    const bool instance = scene_child( r, node, "instance_of" ) != NULL;
    if ( s->has_cloth || s->has_balloon )
    {
        return scene_refuse_node( r, node, "got both '%s' and 'implicit', expected one of them",
                                  s->has_cloth ? "cloth" : "balloon" );
    }
    if ( s->strain_limit[0] > 0.0f || s->strain_limit[1] < INFINITY )
    {
        return scene_refuse_node( r, node, "got both 'strain_limit' and 'implicit', expected one of them" );
    }
    if ( s->has_collision && s->collision.features == WISP_COLLISION_ALL )
    {
        return scene_refuse_node( r, node, "collision.features 'all' is not possible with 'implicit'" );
    }
    if ( s->has_quad_links && s->implicit.stiffness_model == WISP_IMPLICIT_STIFFNESS_MATERIAL )
    {
        return scene_refuse_node( r, node, "implicit.links 'quad' needs 'stiffness_model: link'" );
    }
    return s->has_quad_links && !instance ? check_quad_links( r, node, &s->mesh ) : WISP_OK;
}

static wisp_status check_entry( scene_reader* r, const scene_node* node, const wisp_scene_surface* s )
{
    const bool pinned = wisp_scene_has_pins( s ) || s->has_animation;
    wisp_status status = check_source( r, node, s );
    if ( status )
    {
        return status;
    }
    if ( s->has_cloth && s->has_balloon )
    {
        return scene_refuse_node( r, node, "got both 'cloth' and 'balloon', expected one of them" );
    }
    const bool has_own = s->pins.vertex_count + s->pins.box_count + s->pins.nearest_count > 0 || s->has_animation;
    if ( ( s->pins.path.count > 0 || s->pins.has_pivot ) && !has_own )
    {
        return scene_refuse_node( r, node, "'%s' moves pins, but nothing is pinned",
                                  s->pins.path.count > 0 ? "pin_keyframes" : "pin_pivot" );
    }
    if ( s->has_cloth && s->cloth.tethers && !pinned )
    {
        return scene_refuse_node( r, node, "cloth.tethers needs pins, but nothing is pinned" );
    }
    const scene_node* detail = scene_child( r, node, "detail" );
    const scene_node* level = detail ? scene_child( r, detail, "level" ) : NULL;
    status = level ? scene_check_surface_detail( r, level, s, s->detail.level ) : WISP_OK;
    status = status ? status : scene_check_held( r, node, s );
    status = status || !s->has_animation ? status : scene_check_animation( r, node, s );
    status = status || !s->has_boundary ? status : scene_check_boundary( r, node, s );
    status = status || !s->has_implicit ? status : check_implicit( r, node, s );
    status = status || !s->has_cloth ? status : check_cloth( r, node, s );
    return status || !s->has_balloon ? status : check_balloon( r, node, s );
}

wisp_scene_surface scene_default_surface( wisp_vec3 gravity )
{
    const wisp_surface_def def = wisp_default_surface_def();
    return ( wisp_scene_surface ){
        .mesh = { .generator = wisp_default_mesh_generator( WISP_MESH_PLANE_REGULAR ), .scale = 1.0f },
        .copies = { .count = 1 },
        .start = scene_default_start(),
        .mass_ratio = 1.0f,
        .instance_of = -1,
        .pins = scene_default_pins(),
        .pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } },
        .area_density = def.area_density,
        .vertex_mass = def.vertex_mass,
        .gravity = gravity,
        .strain_limit = { 0.0f, INFINITY },
        .cloth = wisp_default_cloth_def(),
        .balloon = wisp_default_balloon_def(),
        .implicit = wisp_default_implicit_cloth_def(),
        .solve_order = wisp_default_fabric_def().solve_order,
        .animation = { .blend = 0.3f },
        .membrane = wisp_default_membrane_def(),
        .tearing = wisp_default_tearing_def(),
        .max_new_vertices = -1,
        .motion_constraints = wisp_default_motion_constraints_def(),
        .frame = wisp_default_moving_frame_def(),
        .max_speed = INFINITY,
        .sleep = wisp_default_sleep_def(),
        .detail = wisp_default_detail_def(),
        .collision = wisp_default_collision_def(),
        .collider = wisp_default_collider_def(),
        .contact = wisp_default_contact_def(),
        .boundary = wisp_default_boundary_def(),
    };
}

bool wisp_scene_is_driven( const wisp_scene_surface* surface )
{
    return surface->has_animation &&
           !( surface->has_cloth || surface->has_balloon || surface->has_implicit || surface->has_membrane );
}

static wisp_status read_entry( scene_reader* r, const scene_node* node, int index, void* context )
{
    wisp_scene* scene = context;
    wisp_scene_surface* surface = &scene->surfaces[index];
    scene->surface_count = index + 1;
    *surface = scene_default_surface( r->scene->gravity );
    surface->line = node->line;
    surface->column = node->column;
    surface->has_collision = r->body_count > ( scene_child( r, node, "collider" ) != NULL );
    r->mesh = &surface->mesh;
    wisp_status status = scene_read_block( r, node, &SCENE_SURFACE_BLOCK, surface );
    if ( wisp_scene_is_driven( surface ) && scene_child( r, node, "collision" ) == NULL )
    {
        surface->has_collision = false;
    }
    const bool has_links = surface->has_membrane == false && surface->cloth.solver == WISP_SOLVER_XPBD;
    if ( surface->cloth.coarse_substeps < 0 && ( has_links == false || surface->has_tearing ) )
    {
        surface->cloth.coarse_substeps = 0;
    }
    return status ? status : check_entry( r, node, surface );
}

// ---- instances ----

// A source comes before its instances, so there is no circle, and it is no instance itself.
static wisp_status find_source( scene_reader* r, const scene_node* node, int i )
{
    wisp_scene_surface* surface = &r->scene->surfaces[i];
    wisp_status status = scene_read_named( r, node, SCENE_SURFACE, &surface->instance_of );
    if ( status )
    {
        return status;
    }
    const wisp_scene_surface* source = &r->scene->surfaces[surface->instance_of];
    if ( surface->instance_of >= i )
    {
        return scene_refuse_node( r, node, "got '%s', expected an entry above this one", source->name );
    }
    if ( source->instance_of >= 0 )
    {
        return scene_refuse_node( r, node, "got '%s', which is an instance, expected '%s'", source->name,
                                  r->scene->surfaces[source->instance_of].name );
    }
    if ( surface->has_cloth && surface->cloth.tethers && !wisp_scene_has_pins( source ) )
    {
        return scene_refuse_node( r, node, "cloth.tethers needs pins, but '%s' has none", source->name );
    }
    return surface->has_quad_links ? check_quad_links( r, node, &source->mesh ) : WISP_OK;
}

static wisp_status bind_instance( scene_reader* r, const scene_node* item, int index, void* context )
{
    (void)context;
    const scene_node* source = scene_child( r, item, "instance_of" );
    const size_t outside = scene_enter_key( r, "instance_of" );
    const wisp_status status = source ? find_source( r, source, index ) : WISP_OK;
    if ( !status )
    {
        scene_leave( r, outside );
    }
    return status;
}

// What a file holds is only known when it is read; made meshes are counted here, so that a short scene cannot ask for
// more memory than a long one.
static wisp_status count_vertices( scene_reader* r, const scene_node* node )
{
    int64_t sum = 0;
    for ( int i = 0; i < r->scene->surface_count; ++i )
    {
        const wisp_scene_surface* surface = &r->scene->surfaces[i];
        const wisp_scene_mesh* mesh = &r->scene->surfaces[surface->instance_of >= 0 ? surface->instance_of : i].mesh;
        sum += mesh->is_generated ? scene_generator_vertices( &mesh->generator ) : 0;
    }
    return sum <= WISP_SCENE_MAX_VERTICES
               ? WISP_OK
               : scene_refuse_node( r, node, "got %lld vertices in all surfaces, expected at most %d", (long long)sum,
                                    WISP_SCENE_MAX_VERTICES );
}

wisp_status scene_read_surfaces( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene* scene = at;
    void* items;
    wisp_status status =
        scene_begin_list( r, node, "a list of surfaces", WISP_SCENE_MAX_SURFACES, sizeof *scene->surfaces, &items );
    scene->surfaces = items;
    status = status ? status : scene_read_items( r, node, read_entry, scene );
    status = status
                 ? status
                 : scene_register( r, SCENE_SURFACE, scene->surfaces, sizeof *scene->surfaces, scene->surface_count );
    status = status ? status : scene_read_items( r, node, bind_instance, NULL );
    return status ? status : count_vertices( r, node );
}
