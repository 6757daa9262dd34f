/// For modules whose passes do not run at every level of detail.
#pragma once

#include "wisp/detail.h"

WISP_BEGIN_C

typedef struct wisp_frame wisp_frame;
typedef struct wisp_registry wisp_registry;

/// At which detail a pass runs, besides those at which everything is solved.
typedef enum wisp_pass_detail
{
    WISP_PASS_FINE = 1,           ///< not at WISP_DETAIL_COARSE: it solves what is carried there
    WISP_PASS_WITHOUT_MOTION = 2, ///< at WISP_DETAIL_NOTHING too, where an entity makes one substep
} wisp_pass_detail;

/// The detail of an entity in a step.
typedef struct wisp_detail_frame
{
    wisp_detail level, from; ///< that it has, and that it had before the last change
    int max_substeps;        ///< in a step of usual length; 0: as many as it asks for
    int blend_steps;         ///< of the definition
    float blend;             ///< in [0, 1], fraction of the last change that is over at the end of the step
    float keep; ///< fraction of the relative velocity that the step begins with; below 1 while it comes to rest
} wisp_detail_frame;

/// @return zero, which is full detail, for an entity whose detail was never set
WISP_API wisp_detail_frame wisp_frame_detail( wisp_frame* frame, wisp_entity entity );

/// What detail has to know of a module. Called between passes, on the calling thread. Zero-initialised members are never called.
typedef struct wisp_detail_hooks
{
    /// @return whether the entity has something coarse of this module
    bool ( *has_coarse )( const void* state, const wisp_world* world, wisp_entity entity );
    /// The detail of the entity is set for the first time: attach what its passes need.
    wisp_status ( *prepare )( const void* state, wisp_world* world, wisp_entity entity );
    /// The next step runs at another level than the last one.
    void ( *changed )( const void* state, wisp_world* world, wisp_entity entity, wisp_detail from, wisp_detail to );
} wisp_detail_hooks;

/// The component of entities whose detail was set. Passes for it alone require it.
WISP_API wisp_component wisp_detail_component( wisp_registry* registry );

WISP_END_C
