// Frozen hair under a brush: parameters, commands, and the stiffness that a climate gives.
#include "web.h"

WEB_API int web_hair_is_frozen( const web_world* w, int body )
{
    return binding_hair_is_frozen( w->world, body );
}

/// @param out [10] intensity, reach, stretch and bend stiffness, clump radius; whether it freezes, aligns, clumps; temperature, wetness
WEB_API int web_hair_read( web_world* w, int body, double* out )
{
    binding_hair hair;
    if ( binding_hair_read( w->world, body, &hair, &web_error ) != WISP_OK )
    {
        return 0;
    }
    out[0] = (double)hair.intensity;
    out[1] = (double)hair.reach;
    out[2] = (double)hair.stretch_stiffness;
    out[3] = (double)hair.bend_stiffness;
    out[4] = (double)hair.clump_radius;
    out[5] = hair.freezes;
    out[6] = hair.aligns;
    out[7] = hair.clumps;
    out[8] = (double)hair.temperature_celsius;
    out[9] = (double)hair.wetness;
    return 1;
}

/// Other parameters from the next step on. One number replaces a value for each strand.
WEB_API int web_hair_set( web_world* w, int body, float intensity, float reach, float stretch_stiffness,
                          float bend_stiffness, float clump_radius )
{
    const binding_hair hair = { .intensity = intensity,
                                .reach = reach,
                                .stretch_stiffness = stretch_stiffness,
                                .bend_stiffness = bend_stiffness,
                                .clump_radius = clump_radius };
    return binding_hair_set( w->world, body, &hair, &web_error ) == WISP_OK;
}

/// The next step updates the strands. The scene's own events that are still to come are over. @param x, y, z m
WEB_API int web_hair_command( web_world* w, int body, float x, float y, float z )
{
    return binding_hair_command( w->world, body, x, y, z, &web_error ) == WISP_OK;
}

/// Forget the alignment of all strands, and draw new random numbers at the next step.
WEB_API int web_hair_begin_stroke( web_world* w, int body )
{
    return binding_hair_begin_stroke( w->world, body, &web_error ) == WISP_OK;
}

/// @return the stiffness of strands in a climate, by the scene's curve or the default one
WEB_API double web_hair_climate_stiffness( web_world* w, int body, float temperature, float wetness )
{
    double stiffness;
    binding_hair_climate_stiffness( w->world, body, temperature, wetness, &stiffness, &web_error );
    return stiffness;
}
