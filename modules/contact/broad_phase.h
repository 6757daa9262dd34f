// Broad phase: pairs of clusters that may come near each other before the next search.
#pragma once

#include "contact_mesh.h"

#include "wisp/module/aabb_pairs.h"

typedef struct contact_broad_phase
{
    wisp_aabb* boxes; // [cluster] around its predicted motion
    wisp_buffer box_buffer;
    wisp_aabb_pairs overlaps;
    int searches;  // in this step
    bool is_short; // margins were cut to bound the number of pairs: displacements must stay within them
} contact_broad_phase;

/// Search for all pairs.
wisp_status contact_search( const contact_work* work, wisp_error* error );
