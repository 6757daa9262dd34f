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

static int report( const web_world* w, wisp_status status )
{
    if ( status != WISP_OK )
    {
        wisp_fail( &web_error, status, "%s", wisp_world_message( w->world.world ) );
    }
    return status == WISP_OK;
}

WEB_API int web_hair_is_frozen( const web_world* w, int body )
{
    return body < w->scene.strands_count && w->scene.strands[body].has_frozen_hair;
}

/// @param out [10] intensity, reach, stretch and bend stiffness, clump radius; whether it freezes, aligns, clumps; temperature, wetness
WEB_API int web_hair_read( web_world* w, int body, double* out )
{
    const wisp_scene_strands* entry = frozen( w, body );
    if ( !entry )
    {
        return 0;
    }
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
    return report( w, status );
}

/// The next step updates the strands. @param x, y, z m
WEB_API int web_hair_command( web_world* w, int body, float x, float y, float z )
{
    return frozen( w, body ) != NULL &&
           report( w, wisp_command_frozen_hair( w->world.world, w->world.entities[body], ( wisp_vec3 ){ x, y, z } ) );
}

/// Forget the alignment of all strands, and draw new random numbers at the next step.
WEB_API int web_hair_begin_stroke( web_world* w, int body )
{
    return frozen( w, body ) != NULL &&
           report( w, wisp_begin_frozen_hair_stroke( w->world.world, w->world.entities[body] ) );
}

/// @return the stiffness of strands in a climate, by the scene's curve or the default one
WEB_API double web_hair_climate_stiffness( web_world* w, int body, float temperature, float wetness )
{
    const wisp_scene_strands* entry = frozen( w, body );
    return entry ? (double)wisp_environment_stiffness( &entry->environment, temperature, wetness ) : 0.0;
}
