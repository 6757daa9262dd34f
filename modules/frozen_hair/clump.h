/// One run of the clump stage, and its memory.
#pragma once

#include "frozen_hair_state.h"

#include "wisp/module/space.h"

enum
{
    CLUMP_GRAIN = 1024, // slots a block of a copying loop
    CLUMP_SLICES = 32,  // slices a block of a summing loop
    CLUMP_GROUPS = 8,   // groups of strands a block
};

typedef struct clump_workspace
{
    wisp_grid grid, moved_grid;
    wisp_neighbours lists, moved_lists, stray_lists;
    wisp_buffer items;    // quads in the user's order, and where strands begin
    wisp_buffer slots;    // everything by slot
    wisp_buffer slices;   // everything by slice
    wisp_buffer measured; // r0 and g(r0) an entry
    wisp_buffer most;     // largest displacement a block
    wisp_buffer strays;   // vertices that have left their search margin, and their slots
    wisp_buffer late_pairs, late_lists;
} clump_workspace;

// One run of the stage.
typedef struct clump_run
{
    const wisp_parallel* parallel;
    const wisp_kernels* kernels;
    const wisp_strand_topology* strands;
    const frozen_clump* params;
    clump_workspace* w;
    wisp_frozen_hair_stats* report;
    float* position; // [row][3][16]
    int count, slices;
    float skin;           // m
    float* item_quads;    // [item][4]
    int32_t* root_lane;   // [strand] row * 16 + lane of vertex 0; the next vertex is a row further
    int32_t* slot_vertex; // [slot] index in the strand
    float *current, *tentative, *next, *spare; // [slot][4]
    float* displacement;                       // [slice][3][8]
    uint8_t* needs_search;                     // [slice] a bit a lane
    float* most;                               // [block]
    wisp_reference_pairs measured;

    // the lists in use
    const wisp_grid* grid;
    const int32_t* rename; // [slot of the grid] slot; null: the same
    const wisp_neighbours* lists;
    const float* searched;    // [slot][4] where the lists were made
    float moved;              // m, of any vertex since then
    wisp_neighbour_list late; // pairs within the radius that the lists lack
    wisp_adhesion_args args;
} clump_run;

/// Make the lists of the reference shape. @return WISP_NO_MEMORY
wisp_status clump_search( clump_run* run );
