// Frozen hair under a brush: parameters, commands, and the stiffness that a climate gives.
#include "web.h"

static wisp_scene_strands* frozen( web_world* w, int body )
{
    if ( body < 0 || body >= w->scene.strands_count || !w->scene.strands[body].has_frozen_hair )
    {
        wisp_fail( &web_error, WISP_CONFLICT, "body %d has no frozen hair", body );
        return NULL;
    }
    return &w->scene.strands[body];
}

WEB_API int web_hair_is_frozen( const web_world* w, int body )
{
    return body < w->scene.strands_count && w->scene.strands[body].has_frozen_hair;
}

// What the scene's own events have changed so far. They carry what they leave unchanged.
static void follow_events( web_world* w, int body )
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

web_hair web_hair_state( const web_world* w, int body )
{
    const wisp_frozen_hair_def* def = &w->scene.strands[body].frozen_hair;
    return ( web_hair ){ def->intensity,
                         def->reach,
                         def->stretch_stiffness,
                         def->bend_stiffness,
                         def->clump_radius,
                         ( def->strand_intensity ? 1 : 0 ) | ( def->strand_stretch_stiffness ? 2 : 0 ) |
                             ( def->strand_bend_stiffness ? 4 : 0 ) };
}

void web_hair_restore( web_world* w, int body, web_hair hair )
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

/// @param out [10] intensity, reach, stretch and bend stiffness, clump radius; whether it freezes, aligns, clumps; temperature, wetness
WEB_API int web_hair_read( web_world* w, int body, double* out )
{
    const wisp_scene_strands* entry = frozen( w, body );
    if ( !entry )
    {
        return 0;
    }
    follow_events( w, body );
    const wisp_frozen_hair_def* def = &entry->frozen_hair;
    out[0] = (double)def->intensity;
    out[1] = (double)def->reach;
    out[2] = (double)def->stretch_stiffness;
    out[3] = (double)def->bend_stiffness;
    out[4] = (double)def->clump_radius;
    out[5] = def->freeze;
    out[6] = def->align;
    out[7] = def->clump;
    out[8] = (double)entry->environment.temperature_celsius;
    out[9] = (double)entry->environment.wetness;
    return 1;
}

/// Other parameters from the next step on. One number replaces a value for each strand.
WEB_API int web_hair_set( web_world* w, int body, float intensity, float reach, float stretch_stiffness,
                          float bend_stiffness, float clump_radius )
{
    wisp_scene_strands* entry = frozen( w, body );
    if ( !entry )
    {
        return 0;
    }
    follow_events( w, body );
    wisp_frozen_hair_def def = entry->frozen_hair;
    def.strand_intensity = def.intensity == intensity ? def.strand_intensity : NULL;
    def.strand_stretch_stiffness = def.stretch_stiffness == stretch_stiffness ? def.strand_stretch_stiffness : NULL;
    def.strand_bend_stiffness = def.bend_stiffness == bend_stiffness ? def.strand_bend_stiffness : NULL;
    def.intensity = intensity;
    def.reach = reach;
    def.stretch_stiffness = stretch_stiffness;
    def.bend_stiffness = bend_stiffness;
    def.clump_radius = clump_radius;
    const wisp_status status = wisp_set_frozen_hair( w->world.world, w->world.entities[body], &def );
    if ( status == WISP_OK )
    {
        entry->frozen_hair = def;
    }
    return web_report( w, status );
}

/// The next step updates the strands. The scene's own events that are still to come are over: they would take the brush out of
/// the user's hand. @param x, y, z m
WEB_API int web_hair_command( web_world* w, int body, float x, float y, float z )
{
    if ( !frozen( w, body ) )
    {
        return 0;
    }
    follow_events( w, body );
    w->is_combed = 1;
    w->world.next_command = w->scene.command_count;
    return web_report(
        w, wisp_command_frozen_hair( w->world.world, w->world.entities[body], ( wisp_vec3 ){ x, y, z } ) );
}

/// Forget the alignment of all strands, and draw new random numbers at the next step.
WEB_API int web_hair_begin_stroke( web_world* w, int body )
{
    return frozen( w, body ) != NULL &&
           web_report( w, wisp_begin_frozen_hair_stroke( w->world.world, w->world.entities[body] ) );
}

/// @return the stiffness of strands in a climate, by the scene's curve or the default one
WEB_API double web_hair_climate_stiffness( web_world* w, int body, float temperature, float wetness )
{
    const wisp_scene_strands* entry = frozen( w, body );
    return entry ? (double)wisp_environment_stiffness( &entry->environment, temperature, wetness ) : 0.0;
}
