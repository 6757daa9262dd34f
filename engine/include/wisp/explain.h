/// The plan of a world as data: which passes are active and why, what each one reads and writes, what it is predicted to
/// cost, and why the others are absent.
///
///     wisp_plan_info* info;
///     if ( wisp_world_explain( world, &info ) == WISP_OK )
///     {
///         for ( int i = 0; i < info->pass_count; ++i )
///             printf( "%s: %s\n", info->passes[i].name, info->passes[i].because );
///         wisp_plan_info_release( info );
///     }
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

/// Maximum length of a component list of a pass; lists end with null.
#define WISP_PLAN_USES 12

/// Whether a pass is in the plan, and if not, why. Later states are closer to being active.
typedef enum wisp_plan_state
{
    WISP_PLAN_MISSING = 0,     ///< no entity has a component that it requires
    WISP_PLAN_SPLIT = 1,       ///< entities have the required components, but none has all of them
    WISP_PLAN_EXCLUDED = 2,    ///< every entity with the required components has an excluded one
    WISP_PLAN_UNREQUESTED = 3, ///< it could run, but nothing requests or reads what it writes
    WISP_PLAN_ACTIVE = 4,      ///< it is in the plan
} wisp_plan_state;

/// Why a component that a pass writes is needed.
typedef struct wisp_plan_reason
{
    const char* component;
    const char* reader; ///< the pass that reads it; null: it was requested
} wisp_plan_reason;

/// A registered pass. Strings belong to the modules and live as long as they do.
typedef struct wisp_plan_pass
{
    const char* name;   ///< "module.verb"
    const char* module; ///< the module that declares it; "wisp" is the engine itself
    const char*
        stage; ///< "input", "force", "predict", "contact", "project", "velocity", "check", "derive", "shape", "observe"
    const char* domain; ///< what it runs over: "entity", "strand group" or "particle block"
    wisp_plan_state state;
    uintptr_t code; ///< address of the function that runs it, for profilers

    // Declared components. Lists end with null.
    const char* required[WISP_PLAN_USES + 1];
    const char* excluded[WISP_PLAN_USES + 1];
    const char* reads[WISP_PLAN_USES + 1];
    const char* writes[WISP_PLAN_USES + 1];
    const char* foreign[WISP_PLAN_USES + 1]; ///< of other entities, read and written
    const char* missing[WISP_PLAN_USES + 1]; ///< those of `required` that no entity has

    // Where it runs; null, -1 and 0 if it is absent.
    const char* loop; ///< "before", "substep", "iteration", "substep end", "item loop" or "after"
    int wave;         ///< within the loop; nodes of one wave run side by side
    int node;         ///< passes of one node run item by item together
    bool is_fused;    ///< it follows another pass of its node
    const char*
        fusion; ///< the fusion that runs it together with others on at least one entity, "module.noun"; or null
    uintptr_t fusion_code; ///< address of its function; 0 without one
    int entities;          ///< that it runs on
    int items;             ///< of all of these entities: groups of strands, blocks of particles, or entities
    int blocks; ///< units of work that workers draw, each some items of one entity, or all of one in its own loop
    int runs;   ///< per step of usual length, from substeps and iterations, on the entity with the most
    int fewest_runs; ///< on that with the fewest

    /// Bytes that one run reads and writes: rows of every component it reads, and again of every one it writes.
    uint64_t bytes;
    /// Predicted fraction of a step in [0, 1], NaN if the pass is absent: bytes * runs of its entities over those of all passes.
    /// Kernels stream, so bytes are a measure of cost that needs no run. Searches, solves and accesses through the
    /// topology of a mesh are not counted, and every pass counts as if it ran in every step.
    double fraction;

    const wisp_plan_reason* reasons; ///< [reason_count]; empty if the pass is absent
    int reason_count;
    char because[400]; ///< the reason in words
} wisp_plan_pass;

/// A registered module with passes.
typedef struct wisp_plan_module
{
    const char* name;
    int pass_count, active_count;
    const char*
        missing; ///< the component that most of its passes need and no entity has; null if that is not the reason
    char because[480]; ///< why no pass of it is active; empty if one is
} wisp_plan_module;

typedef struct wisp_plan_info
{
    uint64_t hash; ///< equal plans over equally many entities have equal hashes
    int active_count, node_count, wave_count;
    int substeps, iterations;
    bool has_substep_loop;
    const wisp_plan_pass*
        passes; ///< [pass_count]: active ones in plan order, then absent ones in order of registration
    int pass_count;
    const wisp_plan_module* modules; ///< [module_count] in order of registration, the engine first
    int module_count;
} wisp_plan_info;

/// Explain the plan; compiles it if needed.
/// @param out receives the description, null on failure; it does not follow later changes of the world
/// @return WISP_CONFLICT a pass reads a component that nothing writes (the message names both); WISP_NO_MEMORY
WISP_API wisp_status wisp_world_explain( wisp_world* world, wisp_plan_info** out );
/// Free a description, before the world is destroyed. Null is allowed.
WISP_API void wisp_plan_info_release( wisp_plan_info* info );

/// Format the line of a pass as wisp_world_plan() writes it: stage, name, reason. Truncated to `size`.
WISP_API void wisp_plan_pass_text( const wisp_plan_pass* pass, char* out, size_t size );
/// Format the first line of wisp_world_plan(): hash and counts.
WISP_API void wisp_plan_info_text( const wisp_plan_info* info, char* out, size_t size );

WISP_END_C
