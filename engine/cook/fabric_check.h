/// Declarations shared by the files that check a loaded fabric.
#pragma once

#include "fabric.h"

#include <math.h>

typedef struct check_state
{
    const wisp_fabric* f;
    fabric_pool* scratch;
    wisp_error* error;
} check_state;

#define BAD( ... ) wisp_fail( c->error, WISP_BAD_INPUT, "saved fabric: got " __VA_ARGS__ )
#define SHORT_OF_MEMORY wisp_fail( c->error, WISP_NO_MEMORY, "out of memory to check a saved fabric" )

static inline bool fabric_is_vertex( const wisp_fabric* f, int32_t slot )
{
    return slot >= 0 && slot < f->vertex_count;
}

static inline bool fabric_is_vertex_x4( const wisp_fabric* f, int32_t slot_x4 )
{
    return slot_x4 >= 0 && slot_x4 % 4 == 0 && slot_x4 / 4 < f->vertex_count;
}

static inline bool fabric_is_length( float value )
{
    return value >= 0.0f && isfinite( value );
}

// fabric_check_schedule.c

/// Constraints in the layout of kernels: slots times 4, one constraint per lane.
typedef struct lane_reader
{
    int arity;
    const int32_t *a_x4, *b_x4; // two vertices
    const int32_t* slot_x4;     // four vertices, [group][4][8]
    int vertex_count;           // tiles have their dummies behind the vertices
    int tile_size, tile_count;
} lane_reader;

/// Check offsets. @param step minimum increment
bool fabric_offsets_rise( const int32_t* begin, int count, int end, int step );

/// Check that every constraint occurs exactly once.
wisp_status fabric_check_schedule( const check_state* c, const char* what, const wisp_schedule* s, int count );

/// Check that lanes of a group and tiles of a colour share no vertex. Indices and slots are already checked.
wisp_status fabric_check_conflicts( const check_state* c, const char* what, const wisp_schedule* s,
                                    const lane_reader* lanes );

wisp_status fabric_check_links( const check_state* c );
wisp_status fabric_check_hinges( const check_state* c );

// fabric_check_levels.c

wisp_status fabric_check_levels( const check_state* c );
