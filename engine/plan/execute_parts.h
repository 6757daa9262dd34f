/// Declarations shared by the files that execute a plan.
#pragma once

#include "plan.h"

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

// frame.c

/// Return the substeps of an entity in this step.
int execute_substeps( const wisp_frame* frame, int slot );

// execute.c

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
