// Maps of thickness and friction: what a vertex, an edge or a triangle has of those of its participant.
#pragma once

#include "collision_bodies.h"

typedef struct collision_maps
{
    const float *thickness, *friction; // [slot] factors; null: 1
    float own;                         // m, thickness of the participant without that of the body
} collision_maps;

static inline collision_maps collision_maps_of( wisp_frame* frame, wisp_entity participant,
                                                const collision_state* state )
{
    const collision_settings* settings = wisp_frame_column( frame, participant, state->settings, 0 );
    return ( collision_maps ){ wisp_frame_column( frame, participant, WISP_MAP_COLLISION_THICKNESS, 0 ),
                               wisp_frame_column( frame, participant, WISP_MAP_COLLISION_FRICTION, 0 ),
                               settings->thickness };
}

/// Return what the thickness of a vertex is less than that of the pair of body and participant, m.
static inline float collision_thinner( const collision_maps* maps, int slot )
{
    return maps->thickness != NULL ? maps->own * ( 1.0f - maps->thickness[slot] ) : 0.0f;
}

/// Give a view the thickness and friction that some slots have in the mean.
static inline void collision_view_at( const collision_maps* maps, const int32_t* slots, int count,
                                      collision_view* view )
{
    float thinner = 0.0f, friction = 0.0f;
    for ( int k = 0; k < count; ++k )
    {
        thinner += collision_thinner( maps, slots[k] );
        friction += maps->friction != NULL ? maps->friction[slots[k]] : 1.0f;
    }
    view->thickness -= thinner / (float)count;
    view->static_friction *= friction / (float)count;
    view->kinetic_friction *= friction / (float)count;
}
