/// Declarations shared by the files that schedule constraints.
#pragma once

#include "fabric.h"

#include "alloc.h"

// Colours per vertex in a bit mask; also the number of open groups of a list schedule.
#define WORD_COLOURS 64
#define OPEN_GROUPS 64

_Static_assert( WISP_FABRIC_LANES == 8, "a slot of a schedule knows its group by a shift of three" );

// State of a schedule under construction. Constraints are identified by their sorted index until they are emitted.
typedef struct schedule_state
{
    const fabric_constraints* in;
    fabric_pool scratch;
    int32_t* order;  // [count] constraint at each sorted index
    int32_t* slots;  // [count][arity] sorted, so that slots of a tile are contiguous
    uint64_t* taken; // [vertex_count] mask of colours, or of open groups, that contain the vertex
    int32_t* later;  // [vertex_count] next colour beyond those of the mask
    int32_t* stamp;  // [vertex_count] last group that was filled around the vertex
    int32_t stamps;
    int32_t* colour;                // [maximum constraints per tile]
    int32_t* member;                // [maximum constraints per tile] sorted indices by colour, -1 once emitted
    int32_t* begin;                 // [maximum constraints per tile + WORD_COLOURS + 2] first member of each colour
    wisp_buffer emitted;            // constraints, -1 for padding
    wisp_buffer attached;           // groups of a tile that are postponed to its end
    int slot_count;                 // number of emitted slots
    int32_t *tile_end, *colour_end; // ends of tiles in slots, ends of colours in tiles
    int tile_count, colour_count;   // finished ones
    int colours;                    // number of colours of tiles, including skipped ones
} schedule_state;

static inline const int32_t* schedule_slots_of( const schedule_state* s, int place )
{
    return s->slots + (size_t)place * (size_t)s->in->arity;
}

/// Return the smallest or the largest slot of a constraint.
static inline int32_t schedule_extreme( const fabric_constraints* in, int32_t constraint, bool largest )
{
    const int32_t* slots = in->slots + (size_t)constraint * (size_t)in->arity;
    int32_t found = slots[0];
    for ( int k = 1; k < in->arity; ++k )
    {
        found = ( largest ? slots[k] > found : slots[k] < found ) ? slots[k] : found;
    }
    return found;
}

// fabric_order.c

/// Assign the lowest colour that none of the slots has. Beyond the colours of the mask, a vertex stores only its last colour. This wastes
/// colours, but a vertex with a million edges then needs only a million steps.
int32_t schedule_give_colour( schedule_state* s, const int32_t* slots, size_t count );
void schedule_forget_colours( schedule_state* s, const int32_t* slots, size_t count );

/// Sort n items by colour, ties by index.
/// @param begin [colours + 1] output
/// @return number of colours
int schedule_sort_by_colour( const int32_t* colour, int n, int32_t* begin, int32_t* sorted );

void schedule_close_tile( schedule_state* s );
void schedule_close_colour( schedule_state* s );

/// Emit constraints [first, last) by colour, last colour first. Without tiles each colour becomes a tile.
bool schedule_emit_by_colour( schedule_state* s, int first, int last );

/// Schedule constraints [first, last) in mesh order: each goes into the oldest open group that it fits. The window of open groups
/// preserves the sweep order: a constraint stays close to its neighbours.
bool schedule_emit_by_list( schedule_state* s, int first, int last );

/// Move groups at attachments to the end of their tile. A mesh hangs on its attachments, so stretch is largest there, and the constraints
/// projected last are exact. A hanging sheet of 64 rows then stretches by at most 75 % instead of 93 % (10 substeps), with the same
/// average.
bool schedule_put_attached_last( schedule_state* s, int tile_begin );
