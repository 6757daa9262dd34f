// Constraints of pairs that a step lists once.
#pragma once

#include "contact_mesh.h"

typedef struct contact_listed_rows
{
    struct contact_row* rows;             // constraints.h
    int count, split;                     // first row of two edges
    struct contact_listed_batch* batches; // of them
    int batch_count;
    wisp_buffer buffers[2];
} contact_listed_rows;

/// List the pairs of primitives that may press on each other in the rest of the step.
wisp_status contact_list_rows( const contact_work* work, wisp_error* error );

/// Build the constraints of the listed pairs that may press on each other in this substep.
wisp_status contact_take_listed_rows( const contact_work* work, wisp_error* error );
