// State of the module: where attached pins are.
#pragma once

#include "attachments.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

typedef struct attachments_state
{
    wisp_component place; // of particles
    const wisp_registry* registry;
} attachments_state;

/// A place against a triangle of another surface. A row of the component.
typedef struct attachments_place
{
    wisp_entity to;    // zero: the particle is not attached
    int32_t corner[3]; // slots of that surface
    float weights[3];  // barycentric
    wisp_vec3 offset;  // m, in the frame of the triangle
} attachments_place;

_Static_assert( sizeof( wisp_entity ) == 8 && sizeof( attachments_place ) == 44, "without padding" );

/// Rows of the surface that the span names take their targets from the other surfaces.
void attachments_follow( wisp_frame* frame, const wisp_span* span, void* user ); // attachments_pins.c

/// Pins that are attached to a surface go with their triangles, whose corners may be other vertices now.
void attachments_follow_triangles( const attachments_state* state, wisp_world* world, wisp_entity to,
                                   const wisp_fabric* before ); // attachments_pins.c

/// Detach all pins that are attached to a surface.
void attachments_forget( attachments_state* state, wisp_world* world, wisp_entity to ); // attachments_pins.c
