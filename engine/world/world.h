/// A world from inside, for the files of this folder and the tests.
#pragma once

#include "cook_strands.h"
#include "jobs.h"
#include "kernel_tables.h"
#include "log.h"
#include "passes.h"
#include "plan.h"
#include "step_clock.h"
#include "store.h"

#include "wisp/module/module.h"

enum
{
    WORLD_MAX_SUBSTEPS = 1000000, // of a step, and most iterations of a substep
    WORLD_MAX_USUAL_STEPS = 1000, // in a step
};

/// The host's memory, counted.
typedef struct world_memory
{
    wisp_allocator host;
    _Atomic size_t bytes;
} world_memory;

/// Points of two steps, and between them.
typedef struct world_blend
{
    wisp_buffer previous, points; // [strand points, surface points][row] m
    uint32_t structure;           // of the store when points were kept
    bool is_shown;                // views are of `points`
} world_blend;

/// What sleep keeps of a world, outside of rows.
typedef struct world_sleep
{
    passes_sleep_components components;
    wisp_buffer boxes; // scratch of a step
} world_sleep;

/// What wisp_world_tell() has told.
typedef struct world_told
{
    wisp_entity entity;
    const char* sentence;
} world_told;

struct wisp_world
{
    world_memory memory;
    wisp_allocator allocator; // counts, then calls the host
    base_log log;
    bool has_warned_of_threads, has_warned_of_nothing;
    world_told told[32];
    int told_count;
    _Atomic bool is_stepping;
    store store;
    wisp_registry registry;
    plan plan;
    bool plan_is_stale;   // although entities and components are those of the plan
    bool rates_are_stale; // substeps of entities alone
    bool plan_is_new;     // no step was made with it
    jobs_pool* pool;
    wisp_frame frame;
    step_clock clock;
    int longest_step; // usual steps
    world_blend blend;
    world_sleep sleep;
    wisp_buffer origin_members; // scratch of world_origins.c
    uint32_t tie_count;
    wisp_error error; // of the last call that failed
    wisp_profile_line lines[PLAN_MAX_PASSES];
    int line_count;
    double seconds; // of the last step
};

/// For tests of tables that this processor would not select.
void world_set_kernels( wisp_world* world, const wisp_kernels* kernels );

/// Count a step of which a part is left out; tell of the first.
void world_count_cut( wisp_world* world, double seconds, double cut );

/// An entity with the same fabric and masses as a surface, at its rest shape and without effects.
wisp_status world_add_surface_instance( wisp_world* world, wisp_entity source_entity, wisp_entity* out );

/// Check the pose of an instance to be.
wisp_status world_check_pose( wisp_world* world, const store_entity* source, wisp_transform pose );
/// Take an entity that was just added from its rest shape to a pose. That of strands goes along.
void world_place( wisp_world* world, wisp_entity entity, wisp_transform pose );

/// Fail because the handle names no entity.
wisp_status world_stale( wisp_world* world, wisp_entity entity );
/// Begin a call on a surface.
/// @return WISP_STALE_ID; WISP_CONFLICT the entity is not a surface
wisp_status world_find_surface( wisp_world* world, wisp_entity entity, store_entity** out );

/// Inverse mass of a vertex while it is not pinned, 1/kg; 0 if it has no mass.
float world_inverse_mass( wisp_world* world, const store_entity* surface, int slot );

/// List which edge each link and hinge takes the factor of its map from. @return false without memory
bool world_list_map_edges( wisp_world* world, store_entity* surface );

// world_sleep.c, in a step that has substeps

/// Wake entities, before any pass.
void world_sleep_begin( wisp_world* world );
/// Let entities fall asleep, behind all passes.
void world_sleep_end( wisp_world* world );
/// Store in rows what a snapshot must hold besides, and clear it when the snapshot is there, so that no hash depends on snapshots.
void world_sleep_to_rows( wisp_world* world, bool has_snapshot );
/// Take it from there.
void world_sleep_from_rows( wisp_world* world );

/// Zero the velocities of an entity that comes to rest; coarse sheets forget how they moved.
void world_forget_velocities( wisp_world* world, store_entity* e );

/// Keep an entity asleep whose rows got another origin. @return false if it is awake
bool world_sleep_shift( wisp_world* world, store_entity* e, wisp_vec3 by );
/// Wake all entities at the start of the next step.
void world_sleep_disturb( wisp_world* world );

// world_teleport.c

/// Move places in the rows of an entity.
void world_move_place( wisp_world* world, store_entity* e, const plan_place_column* place, wisp_transform motion );

// world_origins.c

/// Have rows relative to places near them, before any pass.
wisp_status world_origins_begin( wisp_world* world );
/// Return a vertex of an entity in its rows; null without. @param coordinate receives the floats from x to y
const float* world_find_vertex( const wisp_world* world, const store_entity* e, size_t* coordinate );
/// Size, write, check and read the offsets of rows that a snapshot holds.
size_t world_origins_size( const wisp_world* world );
void world_origins_write( const wisp_world* world, void* out );
bool world_origins_check( const wisp_world* world, const void* bytes );
void world_origins_read( wisp_world* world, const void* bytes );
/// Declare which shared columns hold places.
wisp_status world_declare_places( wisp_registry* registry );

// world_detail.c

/// Show the plan the detail of the next step, or that of the last one again.
void world_detail_show( wisp_world* world, bool of_next_step );
/// Advance changes of detail by the step that begins.
void world_detail_begin( wisp_world* world );
/// Take the detail of entities from the rows of a snapshot.
void world_detail_from_rows( wisp_world* world );

/// Declares the passes that belong to no module: strands into the user's order.
wisp_status world_declare_strands( wisp_registry* registry );

// ---- world blend ----

/// Points between two steps, for hosts whose frames do not fall on steps.

/// Keep the points of the last step. @return false without memory
bool world_keep_points( wisp_world* world );
/// Show points between the kept ones and those of the last step. Without kept points views stay as they are.
/// @param weight of the last step, in [0, 1]
void world_blend_points( wisp_world* world, float weight );

/// @return interpolated rows of an entity, null if the last call was not wisp_world_advance() or the component has none
const void* world_blended_rows( const wisp_world* world, const store_entity* e, wisp_component component );
/// @return points of the step before the last, to be interpolated from; null if none are kept
void* world_kept_rows( wisp_world* world, const store_entity* e, wisp_component component );

// ---- sleep bounds ----

/// Bounds of entities, and which of them reach each other. For the files of sleep.

/// An entity that acts on others with contact.
typedef struct sleep_box
{
    wisp_sleep_bounds bounds; // m, with its motion in a step unless it sleeps
    float reach;              // m; below 0: it acts on none, or is halted
    bool is_still;            // it sleeps, or is going to
    double origin[3];         // m, of the bounds: those of others are not near
} sleep_box;

/// Compute the bounds of an entity, and of where its velocities and targets take it in so many seconds. @return false without vertices
bool sleep_find_bounds( const wisp_world* world, const store_entity* e, float seconds, wisp_sleep_bounds* out );

/// Entities that are still stir where one that is not reaches them, until none does.
/// @param room sleep_wake_bytes()
void sleep_wake_touched( sleep_box* boxes, int count, void* room );
size_t sleep_wake_bytes( int count );
