/// The plan of a world explained: which passes it has and why, what each needs, reads and writes, what a step of it is
/// predicted to touch, and what keeps the others away. Plain structs; a host prints or draws them as it likes.
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

/// Most components that a list of a pass names; lists end with null.
#define WISP_PLAN_USES 12

/// Is a pass in the plan, and if not, what keeps it away? Those further down are nearer to being kept.
typedef enum wisp_plan_state
{
    WISP_PLAN_MISSING,     ///< it needs components that no entity has
    WISP_PLAN_SPLIT,       ///< entities have what it needs, but none has all of it
    WISP_PLAN_EXCLUDED,    ///< every entity with the required components has an excluded one
    WISP_PLAN_UNREQUESTED, ///< it could run, but nothing requests or reads what it writes
    WISP_PLAN_ACTIVE,
} wisp_plan_state;

/// Who wants a component that a pass writes.
typedef struct wisp_plan_reason
{
    const char* component;
    const char* reader; ///< the pass that reads it; null: the scene has a request for it
} wisp_plan_reason;

/// A pass that is registered. Names are those of the modules and live as long as they do.
typedef struct wisp_plan_pass
{
    const char* name;   ///< "module.verb"
    const char* module; ///< who declared it; "wisp" is the engine itself
    const char*
        stage; ///< "input", "force", "predict", "contact", "project", "velocity", "derive", "shape", "observe"
    const char* domain; ///< what it runs over: "entity", "strand group" or "particle block"
    wisp_plan_state state;

    // What it declares. Lists end with null.
    const char* required[WISP_PLAN_USES + 1];
    const char* excluded[WISP_PLAN_USES + 1];
    const char* reads[WISP_PLAN_USES + 1];
    const char* writes[WISP_PLAN_USES + 1];
    const char* foreign[WISP_PLAN_USES + 1]; ///< of other entities, read and written
    const char* missing[WISP_PLAN_USES + 1]; ///< those of `required` that no entity has

    // Where it runs; null, -1 and 0 of an absent one.
    const char* loop;   ///< "before", "substep", "iteration", "substep end", "item loop" or "after"
    int wave;           ///< within the loop; nodes of one wave run side by side
    int node;           ///< passes of one node run item by item together
    bool is_fused;      ///< behind another pass of its node
    const char* fusion; ///< what runs it together with others on at least one entity, "module.noun"; null: nothing
    int entities;       ///< that it runs on
    int items;          ///< of all of these entities: groups of strands, blocks of particles, or entities
    int blocks;         ///< what workers draw: so many items of one entity
    int runs;           ///< a step, from substeps and iterations

    /// Bytes that one run reads and writes: rows of every component it reads, and again of every one it writes.
    uint64_t bytes;
    /// Predicted share of a step in [0, 1], NaN of an absent pass: bytes * runs of this pass over those of all passes.
    /// Kernels stream, so bytes are the engine's only measure of cost that needs no run. What a pass reaches through a
    /// mesh's topology, searches or solves for is not in it, and every pass counts as due in every step.
    double fraction;

    const wisp_plan_reason* reasons; ///< [reason_count], all of them; empty of an absent pass
    int reason_count;
    char because[400]; ///< the reason in words: what keeps it, or what keeps it away
} wisp_plan_pass;

/// A module that is registered and has passes.
typedef struct wisp_plan_module
{
    const char* name;
    int pass_count, active_count;
    const char*
        missing; ///< the component that most of its passes need and no entity has; null if that is not the reason
    char because[480]; ///< empty if a pass of it is kept, else why none is
} wisp_plan_module;

typedef struct wisp_plan_info
{
    uint64_t hash; ///< equal plans over equally many entities hash equal
    int active_count, node_count, wave_count;
    int substeps, iterations;
    bool has_substep_loop;
    const wisp_plan_pass* passes; ///< [pass_count]: kept ones in plan order, then absent ones as they are registered
    int pass_count;
    const wisp_plan_module* modules; ///< [module_count], as they are registered, the engine first
    int module_count;
} wisp_plan_info;

/// Explain the plan; compiles it if needed.
/// @param out receives the report, null on failure; what it says stays as it is when the world changes
/// @return WISP_CONFLICT a pass reads a component that nothing writes (the message names both); WISP_NO_MEMORY
WISP_API wisp_status wisp_world_explain( wisp_world* world, wisp_plan_info** out );
/// To be called before the world is destroyed. Null is allowed.
WISP_API void wisp_plan_info_release( wisp_plan_info* report );

/// The line of a pass, as wisp_world_plan() writes it: where it runs, its name, why. Cut to the room there is.
WISP_API void wisp_plan_pass_text( const wisp_plan_pass* pass, char* out, size_t size );
/// The first line of wisp_world_plan(): hash and counts.
WISP_API void wisp_plan_info_text( const wisp_plan_info* report, char* out, size_t size );

WISP_END_C
