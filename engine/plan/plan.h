/// From the requests of a scene to the passes of a step.
///
/// A registry holds the declarations of modules. Compiling selects, for every entity, the passes whose required
/// components it has and whose writes are requested. It orders them, puts those without a conflict into one wave,
/// and fuses consecutive passes that touch only their own item. An unselected pass does not exist: no branch, no
/// barrier, no column, no line in the profile.
#pragma once

#include "jobs.h"
#include "store.h"

#include "wisp/explain.h"
#include "wisp/module/module.h"
#include "wisp/module/sleep.h"
#include <stdatomic.h>

enum
{
    PLAN_MAX_PASSES = STORE_MASK_BITS,
    PLAN_MAX_FUSED = 32, // one bit each in a mask
    PLAN_MAX_FUSIONS = 8,
    PLAN_MAX_BATCHES = 4,
    PLAN_MAX_STATES = 32,
    PLAN_MAX_WORKSPACES = 16,
    PLAN_MAX_OBJECTS = 16,
    // An entity with fewer rows of sixteen lanes runs on one worker, in parallel with others. Coarse sheets take half of a step on one
    // worker, and waves between cost more than they save (flag, and sheets of 65 a side; 129 a side break even).
    PLAN_WIDE_ENTITY_ROWS = 256,
    PLAN_WIDE_ROWS_OVER_SHEETS = 1024,
};

typedef struct plan_workspace
{
    const char* module;
    size_t size; // bytes per worker, a multiple of 64
    void ( *release )( void* workspace, const wisp_allocator* allocator );
    size_t ( *memory )( const void* workspace );
    void* blocks; // [workers]
} plan_workspace;

typedef struct plan_state
{
    const char* module;
    void* memory;
    size_t size;
    wisp_state_hooks hooks;
    wisp_sleep_hooks sleep;
    wisp_detail_hooks detail;
} plan_state;

/// Objects of a module by the index of their entities.
struct wisp_objects
{
    const char* module;
    const wisp_allocator* allocator;
    void ( *release )( void* object, const wisp_allocator* allocator );
    size_t ( *bytes )( const void* object );
    struct plan_object
    {
        wisp_entity entity;
        void* object; // null: none
    } * places;       // [count]
    int count;
};

typedef struct plan_fusion
{
    const char* name;
    store_mask required, allows; // passes
    wisp_fused_fn* run;
    void* user;
} plan_fusion;

typedef struct plan_batch
{
    store_mask required, allowed;        // passes
    uint16_t passes[2 * WISP_MAX_FUSED]; // the required, then the allowed ones
    int pass_count;
    int pass; // that can run side by side among any others; -1: none
    wisp_batch def;
} plan_batch;

enum
{
    PLAN_MAX_MAPS = 64,
    PLAN_MAX_PLACES = 64,
};

/// What a map does on surfaces with a component.
typedef struct plan_map
{
    wisp_component map, component;
    const char* refusal; // null: it acts
} plan_map;

/// A column that holds places.
typedef struct plan_place_column
{
    wisp_component component;
    int column;
    wisp_place_shape shape;
    wisp_component low; // 0: none
    int low_column;
} plan_place_column;

/// Sets of the components that a pass uses, made once when it is declared.
typedef struct plan_uses
{
    store_mask required, excluded, reads, writes, foreign;
    store_mask changes;  // of any entity: what it writes, and what is foreign
    store_mask touched;  // of its own entity: what it reads or writes
    store_mask produced; // what it writes without having read it
} plan_uses;

struct wisp_registry
{
    store* store;
    int workers;
    int substeps;              // of the world in a step of usual length; 0 means 1
    int iterations;            // per substep; 0 means 1
    wisp_component detail;     // of entities whose level of detail was set
    wisp_pass* passes;         // [pass_count]
    plan_uses* uses;           // of passes
    const char** pass_modules; // module that declared the pass
    int pass_count;
    wisp_buffer pass_rows[3]; // of these three
    plan_fusion joins[PLAN_MAX_FUSIONS];
    int join_count;
    plan_batch batches[PLAN_MAX_BATCHES];
    int batch_count;
    plan_state states[PLAN_MAX_STATES];
    plan_state no_state; // of hooks that were refused
    int state_count;
    plan_workspace workspaces[PLAN_MAX_WORKSPACES];
    int workspace_count;
    wisp_objects objects[PLAN_MAX_OBJECTS];
    int object_count;
    plan_map maps[PLAN_MAX_MAPS];
    int map_count;
    plan_place_column places[PLAN_MAX_PLACES];
    int place_count;
    const char* module; // module whose declare() is running
    wisp_error error;   // of the first invalid declaration
};

/// Declare the components and passes that every world has.
void plan_registry_init( wisp_registry* r, store* s, int workers );
void plan_registry_release( wisp_registry* r );
/// @return status of the first invalid declaration, with its message in r->error
wisp_status plan_registry_add( wisp_registry* r, const wisp_module* module );
void* plan_registry_state( const wisp_registry* r, const char* module );
/// Notify the modules of other triangles; the first failure ends it.
wisp_status plan_registry_triangles_changed( const wisp_registry* r, wisp_world* world, wisp_entity surface,
                                             const wisp_fabric* before );
/// Notify the modules before an entity is removed.
wisp_status plan_registry_planning( const wisp_registry* r, wisp_world* world );
void plan_registry_planned( const wisp_registry* r, wisp_world* world );
void plan_registry_removed( wisp_registry* r, wisp_world* world, wisp_entity entity );
/// Call the hooks of teleports. The first failure ends it. @param is_moved set if a module moves the entity
wisp_status plan_registry_teleported( const wisp_registry* r, wisp_world* world, wisp_entity entity,
                                      const wisp_teleport_motion* teleport, bool* is_moved );

/// Ask all modules what is around an entity, as wisp_sleep_hooks.surroundings.
bool plan_registry_surroundings( const wisp_registry* r, wisp_world* world, wisp_entity entity,
                                 const wisp_sleep_bounds* bounds, uint64_t* hash );
/// Return the largest reach of an entity among all modules, m; below 0: none.
float plan_registry_reach( const wisp_registry* r, wisp_world* world, wisp_entity entity );
void plan_registry_rested( const wisp_registry* r, wisp_world* world, wisp_entity entity );

/// Has an entity something coarse of any module?
bool plan_registry_has_coarse( const wisp_registry* r, const wisp_world* world, wisp_entity entity );
/// Let all modules attach what an entity needs whose detail is set for the first time. The first failure ends it.
wisp_status plan_registry_prepare_detail( const wisp_registry* r, wisp_world* world, wisp_entity entity );
/// Tell all modules that an entity runs at another level of detail from now on.
void plan_registry_detail_changed( const wisp_registry* r, wisp_world* world, wisp_entity entity, wisp_detail from,
                                   wisp_detail to );

/// Count the states and workspaces of a module, and what they point to. Modules are numbered by their states.
/// @param held receives the bytes of what states and workspaces point to
/// @param outside bytes that are not of the world's allocator are added to it
/// @return bytes of the world's allocator, states and workspaces included
size_t plan_registry_memory( const wisp_registry* r, int state, size_t* held, size_t* outside );

/// Where a node runs: loops are sections, and a section without nodes does not exist.
typedef enum plan_section
{
    PLAN_BEFORE,
    PLAN_SUBSTEP,         // once per substep, before the iterations
    PLAN_ITERATION,       // once per iteration
    PLAN_AFTER_ITERATION, // once per substep, after the iterations
    PLAN_ITEM_LOOP, // the three previous sections, block by block: all substeps of some groups, then of the next
    PLAN_AFTER,
    PLAN_SECTION_COUNT,
} plan_section;

/// Fused passes, which run item by item.
typedef struct plan_node
{
    uint8_t passes[PLAN_MAX_FUSED]; // indices in the registry, in order
    int pass_count;
    wisp_domain domain;
    plan_section section;
    int wave; // within the section
    int first_target, target_count;
    int wave_target_count; // that run in waves; the others have a substep loop of their own
    int grain;
    bool repeats; // its passes run in waves too, on entities that are not apart
} plan_node;

/// An entity of a node, and its selected passes of the node.
typedef struct plan_target
{
    int slot;
    uint32_t passes; // bit i: passes[i] of the node
    int join;        // index of the fusion in the registry that can run all of them; -1: none
} plan_target;

/// Whether an entity runs its substeps in the item loop where others run in waves.
typedef enum plan_parting
{
    PLAN_PARTS_NEVER,
    PLAN_PARTS_APART, // in steps in which it is apart
    PLAN_PARTS_ALWAYS,
} plan_parting;

/// What a slot of the store runs.
typedef struct plan_entity
{
    store_mask live; // passes
    store_mask runs; // those of them that run at its detail
    store_mask came; // components that this plan has attached
    int split;       // substeps in a substep of the world
    int fewer; // substeps of a step in which the world makes its usual ones, when they are fewer; 0: `split` counts
    bool runs_waves; // passes of substeps, unless it loops
    bool meets;      // other entities in them
    bool loops;      // it runs all its substeps before the next entity does
    bool listed;     // among the loops
    int8_t pose;     // place column of its poses; -1: none
    plan_parting parts;
    bool is_apart; // in this step: its passes run in the item loop, not in waves
} plan_entity;

/// Entities with a substep loop of their own that are one block: a single one, or some that can run side by side.
typedef struct plan_loop_group
{
    int first, count; // of loop_slots
    int batch;        // in the registry; -1: a single entity
    bool has_others;  // passes besides those of the batch
} plan_loop_group;

typedef struct plan_block
{
    int32_t node;
    uint32_t passes; // selected and due, bit i: passes[i] of the node
    int join;        // fusion that runs them; -1: run one after another
    int slot;
    int begin, end;
} plan_block;

typedef struct plan
{
    plan_node nodes[PLAN_MAX_PASSES + 1];
    int node_count;
    int wave_count[PLAN_SECTION_COUNT];
    store_mask live; // bit p: pass p is selected
    int pass_count;
    plan_target* targets;
    int target_count, target_capacity;
    plan_entity* entities; // [slot]
    int entity_count;
    int entity_capacity;
    plan_block* blocks; // capacity of the widest wave
    int block_capacity;
    // Entities with a substep loop of their own, and what they run of the nodes of substeps, in the order of a substep.
    uint8_t loop_nodes[PLAN_MAX_PASSES];
    int loop_node_count;
    int* loop_slots;       // [loop] those of a group one after another
    uint32_t* loop_passes; // [loop][loop_node_count] bit i: passes[i] of the node
    plan_loop_group* loop_groups;
    int loop_count, loop_slot_capacity, loop_pass_capacity, loop_group_count, loop_group_capacity;
    uint8_t
        acting[PLAN_MAX_STATES]; // states of modules with selected passes that act between steps, or before substeps
    int acting_count;
    uint32_t structure; // structure version of the store for which it was compiled
    uint64_t hash;
} plan;

/// Compile for the current store, and attach the rows that selected passes exchange. On failure the plan is empty
/// and the message names pass and component.
wisp_status plan_compile( plan* p, wisp_registry* r, wisp_error* error );
/// Give entities of a compiled plan the substeps that they ask for now: passes, rows and targets do not depend on them.
void plan_update_rates( plan* p, const wisp_registry* r );
void plan_release( plan* p, const wisp_allocator* allocator );
/// Return the bytes of its arrays.
size_t plan_memory( const plan* p );
/// Notify the modules of selected passes of the end of a step; the first failure ends it.
wisp_status plan_end_step( const plan* p, const wisp_registry* r, wisp_world* world );

/// Explain a compiled plan and the absent passes, in one block of the world's memory. @return null without memory
wisp_plan_info* plan_explain( const plan* p, const wisp_registry* r, int substeps, int iterations );

/// Print one line per pass: selected passes with their reasons, absent ones with what is missing.
void plan_print( const wisp_plan_info* report, void ( *write )( void* user, const char* line ), void* user );

// execute.c

/// Find which entities meet in substeps, and how many each makes; after nodes and before loops.
void plan_find_splits( plan* p, const wisp_registry* r );
/// Return the substeps that the world makes in a step of usual length.
int plan_usual_substeps( const wisp_registry* r );
/// Return the rate of an entity: those with equal rates have equal substeps. Above 0 it is the split.
int plan_rate( const plan_entity* e, const wisp_registry* r );
/// Return the substeps of a rate in a step in which the world makes so many.
int plan_substeps_of_rate( const wisp_registry* r, int rate, int of_world );

// entity_loop.c

/// Find the entities that run all their substeps on their own: small ones whose passes share nothing with others.
void plan_find_entity_loops( plan* p, const wisp_registry* r );
/// List them, their passes and groups; there is room for all.
void plan_fill_entity_loops( plan* p, const wisp_registry* r );

// compile.c

/// Return the selected passes of an entity that a node has and that run at its detail. Bit i: passes[i] of the node.
uint32_t plan_live_passes( const plan* p, const plan_node* node, int slot );

/// Return the size of an entity in rows of sixteen lanes.
int plan_row_count( const store_entity* e );
/// Is an entity large enough for all workers?
bool plan_is_wide( const store_entity* e );

/// Is it a section of the substep loop?
static inline bool plan_is_substep( plan_section section )
{
    return section == PLAN_SUBSTEP || section == PLAN_ITERATION || section == PLAN_AFTER_ITERATION;
}

/// Return the section of a stage.
plan_section plan_section_of( wisp_stage stage );

/// Convert a zero-terminated list to a set.
store_mask plan_mask( const wisp_component* uses );
/// Return the number of items of a domain in an entity.
int plan_item_count( const store_entity* e, wisp_domain domain );

// execute.c

/// State of a running step, seen by passes as wisp_frame.
struct wisp_frame
{
    wisp_registry* registry;
    plan* plan;
    jobs_pool* pool;
    const wisp_kernels* kernels;
    uint64_t step;
    int substeps, iterations; // of the world
    int substep, iteration;   // current ones
    int asking;               // node that asks whether it is due
    int rate;                 // of the entities whose substeps run
    float seconds;            // of a substep of the world
    float even;               // s, the step if it has its usual length and nothing is left of those before; else 0
    float progress;           // fraction of the motion to kinematic targets per substep; 0: 1 / substeps
    float reached;            // fraction of that motion completed by the last step
    bool continues, goes_on;  // a part of a step that is not the first, or not the last
    const plan_block* wave;   // of the current wave
    bool wide;                // one entity at a time, on all workers
    bool sampled;             // times of passes come from samples
    int only_pass;            // of a wave without samples
    int clocked_blocks;       // one of this many blocks with a substep loop is timed
    _Atomic uint64_t counters[WISP_COUNTER_COUNT];
    double pass_seconds[PLAN_MAX_PASSES]; // of this step
    int64_t pass_items[PLAN_MAX_PASSES];
    struct plan_clock* clocks; // [workers][PLAN_MAX_PASSES]
    atomic_flag failing;
    _Atomic bool failed;
    wisp_error error;
    atomic_flag halting;
    char halted_message[300]; // of the first entity halted in this step
};

/// Samples of a worker: seconds that passes of fused nodes took on the first item of its blocks.
typedef struct plan_clock
{
    _Alignas( 64 ) double seconds[PLAN_MAX_PASSES];
} plan_clock;

/// Test whether a pass of the plan runs in substeps.
bool plan_has_substeps( const plan* p );
/// Run all sections in their loops, or none in a step without substeps. The caller keeps the pool open
/// (jobs_enter).
void plan_execute( wisp_frame* frame );

// ---- execute parts ----

/// Declarations shared by the files that execute a plan.

/// Range of passes in the list of a node.
typedef struct pass_range
{
    int begin, end;
} pass_range;

/// Whether an entity is left out of the passes of a section.
static inline bool execute_leaves_out( const store_entity* e, plan_section section )
{
    return e->halted != 0 || e->sleep == STORE_ASLEEP ||
           ( e->sleep == STORE_FALLING_ASLEEP && section != PLAN_AFTER );
}

// execute.c

/// Return the substeps of an entity in this step.
int execute_substeps( const wisp_frame* frame, int slot );

/// Whether a pass has to run on an entity; if so, what watches its output has to run too. Once per run of the pass.
bool execute_is_due( wisp_frame* frame, int number, int slot );

/// Run the passes of an item, timed if `scale` is above 0, which extends the sample to what it stands for.
/// @param due selected and due passes, bit i: passes[i] of the node
void execute_item( wisp_frame* frame, const plan_node* node, unsigned due, pass_range range, const wisp_span* span,
                   double scale );

/// Run blocks that take some rows together, on all workers if that is worth it, and divide their time among passes.
/// @param clocked one of so many blocks with a substep loop is timed
void execute_timed( wisp_frame* frame, int count, int64_t rows, int clocked, wisp_block_fn* run );

/// Which of the substeps of a block is timed, pass by pass; the number of substeps: none.
int execute_timed_substep( const wisp_frame* frame, int block, int substeps );

// entity_loop.c

/// Run all substeps of the entities that have a loop of their own.
void execute_entity_loops( wisp_frame* frame );
