/// Passes that every world has, and what their files share.
#pragma once

#include "wisp/module/detail.h"
#include "wisp/module/module.h"

wisp_status passes_declare( wisp_registry* registry );

wisp_status passes_declare_particles( wisp_registry* registry );
wisp_status passes_declare_moving_frame( wisp_registry* registry );
wisp_status passes_declare_levels( wisp_registry* registry );
wisp_status passes_declare_max_speed( wisp_registry* registry );
wisp_status passes_declare_tethers( wisp_registry* registry );
wisp_status passes_declare_seen_motion( wisp_registry* registry );
wisp_status passes_declare_constraints( wisp_registry* registry );
wisp_status passes_declare_state_check( wisp_registry* registry );
wisp_status passes_declare_surface( wisp_registry* registry );
wisp_status passes_declare_instances( wisp_registry* registry );

/// State of surface.levels.
enum
{
    LEVELS_RESTARTED, ///< masses have to be found
    LEVELS_FIRST,     ///< the next substep of the coarsest sheet is Euler's
    LEVELS_MOVING,
};

/// Passes without a search after one that found no sharp folds: with a search links take a tenth longer.
#define PASSES_BETWEEN_FOLDS 7

/// Let a kernel of links find folded bend links, if the entity has link.folds: while there are some, and from time to time.
/// @return false if there is no memory for their bits, which is reported
bool passes_begin_folds( wisp_frame* frame, const wisp_span* span, wisp_link_args* args );

/// Project the hinges of folded bend links. Their order is that of the links, so bits do not depend on workers.
/// @param folded bits that a kernel of links has stored, from passes_begin_folds()
void passes_open_folds( wisp_frame* frame, const wisp_span* span, const uint64_t* folded );

/// Is a vertex of a triangle pinned? @param position [slot][4]
bool passes_has_pins( const wisp_fabric* fabric, const float* position );

/// Pass: find the folded hinges of an entity with hinge.folds, and project them.
void passes_open_hinges( wisp_frame* frame, const wisp_span* span, void* user );

// ---- detail ----

/// Rows of entities whose level of detail was set, and what they do where nothing is solved.

/// A row of the component "detail.state".
typedef struct passes_detail
{
    int32_t level, active, from; // that was set, at which the last step ran, and before the last change
    int32_t divisor, blend_steps;
    int32_t elapsed;               // steps since the last change, at most blend_steps
    int32_t substeps, of_substeps; // in a step of usual length, now and at the last change; 0: as many as it asks for
} passes_detail;

/// Declare the component and the passes.
/// @param out receives the component; must live as long as the registry
wisp_status passes_declare_detail( wisp_registry* registry, wisp_component* out );

// ---- sleep ----

/// Rows of entities that can sleep.

enum
{
    PASSES_TOUCHED = 3, // more than any store_sleep
};

/// A row of the component "sleep.state".
typedef struct passes_sleep
{
    uint64_t rows;            // hash of the entity's own rows when it fell asleep
    uint64_t surroundings;    // hash of what was around it
    float lower[3], upper[3]; // m, its bounds there
    float max_speed, seconds; // of the definition
    float still;              // s for which no vertex was faster
    int32_t phase;            // store_sleep; in a snapshot PASSES_TOUCHED more if store_entity.is_touched
} passes_sleep;

typedef struct passes_sleep_components
{
    wisp_component state;              // passes_sleep
    wisp_component particles, strands; // positions at the end of the step before
    wisp_component moved;              // what the passes write: the largest displacement of a step, m
} passes_sleep_components;

/// Declare the components and the passes, behind those of all modules: states are checked first.
/// @param out receives the components; must live as long as the registry
wisp_status passes_declare_sleep( wisp_registry* registry, passes_sleep_components* out );
