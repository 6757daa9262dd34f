// State of the module: where attached pins are.
#pragma once

#include "attachments.h"

#include "wisp/module/anchor.h"
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
    wisp_entity to;   // zero: the particle is not attached
    wisp_anchor at;   // on that surface
    wisp_vec3 offset; // m, in the frame of the triangle
} attachments_place;

_Static_assert( sizeof( wisp_entity ) == 8 && sizeof( attachments_place ) == 36, "without padding" );
