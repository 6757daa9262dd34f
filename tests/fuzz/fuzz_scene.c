// Any bytes as a scene: rejected with one message that begins with the name, or read into a scene that satisfies its
// invariants.
#include "fuzz.h"

#include "scene.h"

static void demand_message( const wisp_error* error )
{
    static const char name[] = "fuzz.yaml:";
    demand_refusal( error->status, error );
    demand( strncmp( error->message, name, sizeof name - 1 ) == 0 );
}

static void demand_numbers( const float* values, int count, float lower, float upper )
{
    demand( ( values == NULL ) == ( count == 0 ) );
    for ( int i = 0; i < count; ++i )
    {
        demand( values[i] >= lower && values[i] <= upper );
    }
}

static void demand_environment( const wisp_environment_def* environment )
{
    int last = environment->point_count - 1;
    demand( last >= 1 && last < WISP_ENVIRONMENT_MAX_POINTS );
    demand( environment->ice[0] == 0.0f && environment->ice[last] == 1.0f && environment->span > 0.0f );
    bool rises = false, falls = false;
    for ( int i = 1; i <= last; ++i )
    {
        demand( environment->ice[i] > environment->ice[i - 1] );
        rises = rises || environment->stiffness[i] > environment->stiffness[i - 1];
        falls = falls || environment->stiffness[i] < environment->stiffness[i - 1];
    }
    demand( !rises || !falls );
}

static void demand_path( const wisp_scene_path* path )
{
    demand( ( path->poses == NULL ) == ( path->count == 0 ) );
    for ( int i = 0; i < path->count; ++i )
    {
        const wisp_quat q = path->poses[i].pose.rotation;
        demand( i == 0 || path->poses[i].time > path->poses[i - 1].time );
        demand( fabsf( q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1.0f ) < 1e-5f );
    }
}

static void demand_contact( const wisp_contact_def* c )
{
    demand( c->thickness >= 0.0f && isfinite( c->thickness ) && c->friction >= 0.0f && isfinite( c->friction ) );
    demand( c->max_push_out_speed >= 0.0f && isfinite( c->max_push_out_speed ) );
}

static void demand_settings( const wisp_scene* scene )
{
    const wisp_contact_settings* c = &scene->contact;
    demand( c->level >= 0 && c->level < WISP_CONTACT_LEVEL_COUNT );
    demand( c->margin > 0.0f && isfinite( c->margin ) );
    demand( scene->has_contact || !( scene->request_contact_stats || scene->request_intersections ) );
}

static void demand_layer( const wisp_boundary_def* b )
{
    demand( b->policy >= 0 && b->policy < WISP_SPACING_COUNT && b->rounding >= 0 && b->rounding < WISP_ROUND_COUNT );
    demand( b->spacing >= 0.0f && isfinite( b->spacing ) && b->hysteresis >= 0.0f && b->hysteresis <= 0.5f );
    demand( b->max_points >= 1 && b->curvature_gain >= 0.0f && isfinite( b->strain_gain ) );
    demand( b->max_spacing == 0.0f || b->min_spacing <= b->max_spacing );
    demand( b->eye_angle >= 0.0f && isfinite( b->eye.x ) );
    demand( b->eye_angle > 0.0f || ( b->eye.x == 0.0f && b->eye.y == 0.0f && b->eye.z == 0.0f ) );
}

static void demand_dynamics( const wisp_scene_strands* strands )
{
    const wisp_strand_dynamics_def* d = &strands->dynamics;
    demand( isfinite( d->gravity.y ) && d->bend_rigidity >= 0.0f && d->line_density > 0.0f && d->teleport > 0.0f );
    demand( ( d->vertex_masses == NULL ) == ( strands->mass_count == 0 ) &&
            ( d->pins == NULL ) == ( d->pin_count == 0 ) );
    for ( int i = 0; i < strands->mass_count; ++i )
    {
        demand( d->vertex_masses[i] > 0.0f && isfinite( d->vertex_masses[i] ) );
    }
    demand( strands->has_dynamics || !( strands->has_grid || strands->has_head ) );
    demand( strands->has_dynamics || strands->has_ghosts || !strands->has_collision );
    demand( strands->has_dynamics || !strands->has_contact );
    demand_contact( &strands->contact );
    demand( !( strands->has_head && strands->on_surface >= 0 ) );
    demand_path( &strands->head );
}

static void demand_strands( const wisp_scene* scene, int i )
{
    const wisp_scene_strands* strands = &scene->strands[i];
    const wisp_frozen_hair_def* hair = &strands->frozen_hair;
    demand( strands->name && strlen( strands->name ) <= WISP_SCENE_MAX_NAME && strands->line > 0 );
    demand( ( strands->file != NULL ) + strands->is_generated + strands->is_scattered + strands->is_curves == 1 );
    demand( strands->scatter.around < i && strands->is_scattered == ( strands->scatter.around >= 0 ) );
    demand( strands->is_curves == ( strands->curves_of >= 0 ) && strands->curves_of < scene->strands_count );
    demand( strands->has_ghosts == ( strands->targets >= 0 ) && strands->targets < scene->strands_count );
    demand( strands->on_surface < scene->surface_count && strands->scale > 0.0f );
    demand_numbers( hair->strand_stretch_stiffness, strands->stretch_count, 1e-3f, 1e12f );
    demand_numbers( hair->strand_bend_stiffness, strands->bend_count, 1e-3f, 1e12f );
    demand_numbers( hair->strand_intensity, strands->intensity_count, 0.0f, 1.0f );
    demand( strands->bend_count == 0 || !strands->is_generated ||
            strands->bend_count == strands->generator.strand_count );
    demand( isfinite( hair->reach ) && isfinite( hair->cursor.x ) && hair->clump_radius > 0.0f );
    demand( strands->has_appearance || !( strands->request_width || strands->request_colour ) );
    demand_environment( &strands->environment );
    demand_dynamics( strands );
}

static void demand_mesh( const wisp_scene_mesh* mesh, bool needed )
{
    demand( needed == ( mesh->is_generated || mesh->file ) && !( mesh->is_generated && mesh->file ) );
    demand( mesh->scale > 0.0f );
    demand( ( mesh->repairs & ~( WISP_MESH_REPAIR_ALL | WISP_MESH_WELD | WISP_MESH_FLIP ) ) == 0 );
    demand( mesh->weld_distance >= 0.0f &&
            ( mesh->weld_distance == 0.0f || ( mesh->repairs & WISP_MESH_WELD ) != 0 ) );
    demand( mesh->generator.shape >= 0 && mesh->generator.shape < WISP_MESH_SHAPE_COUNT );
}

static void demand_balloon( const wisp_scene_surface* s )
{
    const wisp_balloon_def* b = &s->balloon;
    demand( b->gas_ratio >= b->min_gas_ratio && b->outlet_count >= 0 && b->outlet_count <= WISP_BALLOON_MAX_OUTLET );
    demand( !( b->outlet_count > 0 && s->has_outlet_nearest ) );
    for ( int i = 0; i < s->gas_ratio_keyframe_count; ++i )
    {
        demand( s->gas_ratio_keyframes[i].gas_ratio >= b->min_gas_ratio );
        demand( i == 0 || s->gas_ratio_keyframes[i].time > s->gas_ratio_keyframes[i - 1].time );
    }
}

static void demand_implicit( const wisp_scene* scene, const wisp_scene_surface* s )
{
    const wisp_implicit_cloth_def* d = &s->implicit;
    const float values[] = { d->stretch_stiffness, d->bend_stiffness, d->bend_rigidity, d->compression_stiffness,
                             d->link_damping };
    for ( int i = 0; i < WISP_COUNT( values ); ++i )
    {
        demand( values[i] >= 0.0f && isfinite( values[i] ) );
    }
    demand( d->stiffness_model >= 0 && d->stiffness_model < WISP_IMPLICIT_STIFFNESS_COUNT );
    demand( d->weights >= 0 && d->weights < WISP_IMPLICIT_WEIGHTS_COUNT );
    demand( d->integrator >= 0 && d->integrator < WISP_INTEGRATOR_COUNT );
    demand( d->newton_iterations >= 1 && d->newton_iterations <= 64 && d->max_newton_iterations >= 1 &&
            d->max_newton_iterations <= 64 );
    demand( d->tolerance >= 1e-7f && d->tolerance <= 0.1f );
    demand( d->max_iterations >= 0 && d->max_iterations <= 1000000 );
    demand( !d->stretch_pairs && !d->bend_pairs && d->stretch_pair_count == 0 && d->bend_pair_count == 0 );
    demand( s->has_implicit || !s->has_quad_links );
    demand( !s->has_implicit || ( s->strain_limit[0] == 0.0f && isinf( s->strain_limit[1] ) ) );
    const wisp_scene_mesh* mesh = s->instance_of < 0 ? &s->mesh : &scene->surfaces[s->instance_of].mesh;
    demand( !s->has_quad_links || ( mesh->is_generated && mesh->generator.shape == WISP_MESH_PLANE_REGULAR ) );
    demand( !s->has_quad_links || d->stiffness_model == WISP_IMPLICIT_STIFFNESS_LINK );
}

static void demand_pins( const wisp_scene_pins* pins )
{
    demand( pins->path.count == 0 || pins->vertex_count + pins->box_count + pins->nearest_count > 0 );
    for ( int k = 0; k < pins->vertex_count; ++k )
    {
        demand( pins->vertices[k] >= 0 && pins->vertices[k] < WISP_SCENE_MAX_VERTICES );
    }
    for ( int k = 0; k < pins->box_count; ++k )
    {
        demand( pins->boxes[k].lower.y <= pins->boxes[k].upper.y );
    }
    demand_path( &pins->path );
}

static void demand_surface( const wisp_scene* scene, int i )
{
    const wisp_scene_surface* s = &scene->surfaces[i];
    demand( s->name && strlen( s->name ) <= WISP_SCENE_MAX_NAME && s->line > 0 );
    demand( s->instance_of < i && s->instance_of >= -1 );
    demand( s->instance_of < 0 || scene->surfaces[s->instance_of].instance_of < 0 );
    demand_mesh( &s->mesh, s->instance_of < 0 );
    demand( s->has_cloth + s->has_balloon + s->has_implicit <= 1 );
    demand( isfinite( s->gravity.y ) && s->damping >= 0.0f );
    demand( !s->request_stats || s->has_balloon || s->has_implicit );
    demand( s->strain_limit[0] <= 1.0f && s->strain_limit[1] >= 1.0f );
    demand( s->tile_size == 0 || ( s->tile_size >= 64 && s->tile_size % 8 == 0 ) );
    demand_pins( &s->pins );
    for ( int k = 0; k < s->pin_group_count; ++k )
    {
        demand_pins( &s->pin_groups[k] );
    }
    demand_balloon( s );
    demand_implicit( scene, s );
    demand_contact( &s->contact );
    demand_layer( &s->boundary );
}

static void demand_collider( const wisp_scene_collider* c )
{
    demand( c->name && c->def.kind >= 0 && c->def.kind < WISP_COLLIDER_COUNT );
    demand( c->def.kinetic_friction <= c->def.static_friction && c->def.kinetic_friction >= 0.0f );
    demand( c->def.radius > 0.0f && c->def.half_length >= 0.0f && c->def.half_extent.z > 0.0f );
    demand_mesh( &c->mesh, c->def.kind == WISP_COLLIDER_MESH || c->def.kind == WISP_COLLIDER_CONVEX );
    demand_path( &c->path );
}

static void demand_event( const wisp_scene* scene, int i )
{
    const wisp_scene_event* e = &scene->events[i];
    demand( e->step >= 0 && e->step < scene->steps && ( i == 0 || e->step >= e[-1].step ) );
    demand( e->surface < scene->surface_count && e->strands < scene->strands_count );
    demand( ( e->surface >= 0 ) != ( e->strands >= 0 ) );
    if ( e->surface < 0 )
    {
        const wisp_scene_strands* strands = &scene->strands[e->strands];
        demand( e->has_wind || e->has_detail );
        demand( !e->has_wind ||
                ( strands->has_dynamics && strands->dynamics.drag_coefficient > 0.0f && isfinite( e->wind.x ) ) );
        return;
    }
    demand( i == 0 || e->step > e[-1].step || e->surface > e[-1].surface ||
            ( e->surface == e[-1].surface && e->pin_group != e[-1].pin_group ) );
    const wisp_scene_surface* s = &scene->surfaces[e->surface];
    demand( s->has_balloon || !( e->has_gas_ratio || e->has_inflation_rate || e->has_open ) );
    demand( !e->has_gas_ratio || e->gas_ratio >= s->balloon.min_gas_ratio );
    demand( s->has_cloth || !e->has_wind );
}

static void demand_scene( const wisp_scene* scene )
{
    demand( scene->dt > 0.0f && isfinite( scene->dt ) && scene->steps >= 0 );
    demand( scene->substeps >= 1 && scene->iterations >= 1 );
    demand( scene->workers >= 0 && scene->workers <= WISP_MAX_WORKERS );
    demand_settings( scene );
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        demand_strands( scene, i );
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        demand_surface( scene, i );
    }
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        demand_collider( &scene->colliders[i] );
    }
    for ( int i = 0; i < scene->event_count; ++i )
    {
        demand_event( scene, i );
    }
    for ( int i = 0; i < scene->command_count; ++i )
    {
        const wisp_scene_hair_event* command = &scene->commands[i];
        demand( command->strands >= 0 && command->strands < scene->strands_count );
        demand( command->step >= 0 && command->step < scene->steps );
        demand( i == 0 || command->step >= command[-1].step );
        demand( scene->strands[command->strands].has_frozen_hair );
    }
    for ( int i = 0; i < scene->output_count; ++i )
    {
        const wisp_scene_output* output = &scene->outputs[i];
        demand( ( output->strands < 0 ) != ( output->surface < 0 ) && output->file[0] );
        demand( output->strands < scene->strands_count && output->surface < scene->surface_count );
        demand( output->strands >= 0 ? scene->strands[output->strands].request_points
                                     : scene->surfaces[output->surface].request_points );
    }
}

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size )
{
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    wisp_status status = wisp_scene_parse( (const char*)data, size, "fuzz.yaml", &scene, &error );
    if ( status )
    {
        demand( status == WISP_BAD_INPUT && !scene.strands && !scene.blocks );
        demand_message( &error );
    }
    else
    {
        demand_scene( &scene );
    }
    wisp_scene_release( &scene );
    return 0;
}
