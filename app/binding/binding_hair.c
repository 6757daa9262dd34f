// Frozen hair under a brush: parameters, commands, and the stiffness that a climate gives.
#include "binding_internal.h"

static wisp_scene_strands* frozen( binding_world* w, int body, wisp_error* error )
{
    if ( body < 0 || body >= w->scene.strands_count || !w->scene.strands[body].has_frozen_hair )
    {
        wisp_fail( error, WISP_CONFLICT, "%s: body %d has no frozen hair", w->scene.name, body );
        return NULL;
    }
    return &w->scene.strands[body];
}

bool binding_hair_is_frozen( const binding_world* w, int body )
{
    return body >= 0 && body < w->scene.strands_count && w->scene.strands[body].has_frozen_hair;
}

// What the scene's own events have changed so far. They carry what they leave unchanged.
static void follow_events( binding_world* w, int body )
{
    for ( int k = 0; k < w->world.next_command && !w->is_combed; ++k )
    {
        const wisp_scene_hair_event* e = &w->scene.commands[k];
        if ( e->strands == body )
        {
            scene_hair_event_apply( e, &w->scene.strands[body].frozen_hair );
        }
    }
}

hair_state binding_hair_state( const binding_world* w, int body )
{
    const wisp_frozen_hair_def* def = &w->scene.strands[body].frozen_hair;
    return ( hair_state ){ def->intensity,
                           def->reach,
                           def->stretch_stiffness,
                           def->bend_stiffness,
                           def->clump_radius,
                           ( def->strand_intensity ? 1 : 0 ) | ( def->strand_stretch_stiffness ? 2 : 0 ) |
                               ( def->strand_bend_stiffness ? 4 : 0 ) };
}

void binding_hair_restore( binding_world* w, int body, hair_state hair )
{
    wisp_frozen_hair_def* def = &w->scene.strands[body].frozen_hair;
    def->intensity = hair.intensity;
    def->reach = hair.reach;
    def->stretch_stiffness = hair.stretch_stiffness;
    def->bend_stiffness = hair.bend_stiffness;
    def->clump_radius = hair.clump_radius;
    def->strand_intensity = hair.lists & 1 ? w->hair[body].strand_intensity : NULL;
    def->strand_stretch_stiffness = hair.lists & 2 ? w->hair[body].strand_stretch_stiffness : NULL;
    def->strand_bend_stiffness = hair.lists & 4 ? w->hair[body].strand_bend_stiffness : NULL;
}

wisp_status binding_hair_read( binding_world* w, int body, binding_hair* out, wisp_error* error )
{
    *out = ( binding_hair ){ 0 };
    const wisp_scene_strands* entry = frozen( w, body, error );
    if ( !entry )
    {
        return error->status;
    }
    follow_events( w, body );
    const wisp_frozen_hair_def* def = &entry->frozen_hair;
    *out = ( binding_hair ){ .intensity = def->intensity,
                             .reach = def->reach,
                             .stretch_stiffness = def->stretch_stiffness,
                             .bend_stiffness = def->bend_stiffness,
                             .clump_radius = def->clump_radius,
                             .freezes = def->freeze,
                             .aligns = def->align,
                             .clumps = def->clump,
                             .temperature_celsius = entry->environment.temperature_celsius,
                             .wetness = entry->environment.wetness };
    return WISP_OK;
}

wisp_status binding_hair_set( binding_world* w, int body, const binding_hair* hair, wisp_error* error )
{
    wisp_scene_strands* entry = frozen( w, body, error );
    if ( !entry )
    {
        return error->status;
    }
    follow_events( w, body );
    wisp_frozen_hair_def def = entry->frozen_hair;
    def.strand_intensity = def.intensity == hair->intensity ? def.strand_intensity : NULL;
    def.strand_stretch_stiffness =
        def.stretch_stiffness == hair->stretch_stiffness ? def.strand_stretch_stiffness : NULL;
    def.strand_bend_stiffness = def.bend_stiffness == hair->bend_stiffness ? def.strand_bend_stiffness : NULL;
    def.intensity = hair->intensity;
    def.reach = hair->reach;
    def.stretch_stiffness = hair->stretch_stiffness;
    def.bend_stiffness = hair->bend_stiffness;
    def.clump_radius = hair->clump_radius;
    const wisp_status status = wisp_set_frozen_hair( w->world.world, w->world.entities[body], &def );
    if ( status == WISP_OK )
    {
        entry->frozen_hair = def;
    }
    return binding_fail( w, status, error );
}

wisp_status binding_hair_command( binding_world* w, int body, float x, float y, float z, wisp_error* error )
{
    if ( !frozen( w, body, error ) )
    {
        return error->status;
    }
    follow_events( w, body );
    w->is_combed = true;
    w->world.next_command = w->scene.command_count;
    const wisp_entity strands = w->world.entities[body];
    return binding_fail( w, wisp_command_frozen_hair( w->world.world, strands, ( wisp_vec3 ){ x, y, z } ), error );
}

wisp_status binding_hair_begin_stroke( binding_world* w, int body, wisp_error* error )
{
    return frozen( w, body, error )
               ? binding_fail( w, wisp_begin_frozen_hair_stroke( w->world.world, w->world.entities[body] ), error )
               : error->status;
}

wisp_status binding_hair_climate_stiffness( binding_world* w, int body, float temperature, float wetness, double* out,
                                            wisp_error* error )
{
    const wisp_scene_strands* entry = frozen( w, body, error );
    *out = entry ? (double)wisp_environment_stiffness( &entry->environment, temperature, wetness ) : 0.0;
    return entry ? WISP_OK : error->status;
}
