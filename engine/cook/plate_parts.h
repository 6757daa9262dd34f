/// Parts of a plate while it is cooked: hinges with the shares of their turns, patches of triangles, rows of matrices.
#pragma once

#include "wisp/module/plate.h"

#include "wisp/module/double3.h"
#include "fabric_parts.h"

#include <stdatomic.h>

enum
{
    PLATE_STENCIL = 5, // hinges that share a turn: the hinge itself, two of each triangle
    PLATE_PATCH = 12,  // vertices of a triangle, its neighbours and theirs; more than the hinges between them
    PLATE_CORNERS = 4, // of a hinge
};

// A hinge between side 0, the triangle (i, j, k), and side 1, the triangle (j, i, l).
typedef struct plate_hinge
{
    int32_t corner[PLATE_CORNERS]; // i, j, k, l
    int32_t slot;                  // of the fabric's hinges; -1: those have no schedule
    int32_t triangle[2];
    float row[PLATE_CORNERS];    // J = sum of row x, 1/m
    float fitted[PLATE_STENCIL]; // turn of side 0 from J of the stencil, without pins
} plate_hinge;

// Opposite corners over the edge of a hinge at rest.
typedef struct plate_shape
{
    double length;             // of the edge, m
    double foot[2], height[2]; // share of the edge from i; m
} plate_shape;

// A matrix over vertices or over hinges by slices of eight rows. A slice has as many entries as its longest row.
typedef struct plate_row_set
{
    bool of_hinges; // else of vertices
    int item_count, slice_count;
    int32_t* item_row;     // [item_count] in the plate's `parts`
    int32_t* begin;        // [slice_count + 1]
    int32_t ( *other )[8]; // [entry] rows, times 4 of vertices; a lane's own row pads. Null: `near` has them
    uint16_t ( *near )[8]; // [entry] rows of hinges; of vertices likewise, relative to the first row of the slice
    float ( *weight )[8];  // [entry]
} plate_row_set;

struct wisp_plate
{
    plate_row_set vertices;   // Q, without its diagonal
    plate_row_set turns;      // energy of turns, 1/2 D sum of K J J; empty unless requested
    float* steepest;          // [row of turns]
    float* least_height;      // [slot] m
    wisp_schedule triangles;  // of those that bend, with turns
    const int32_t* corner_x4; // [group of triangles][3][8]
    int32_t* moment_of;       // [group of triangles][3][8] row of the hinge opposite to a corner
    uint8_t* pinned;          // [vertex_count]
    const int32_t* slot_row;  // [vertex_count] null: the slot itself
    plate_hinge* hinges;      // [hinge_count] in `parts`; null: to be listed again
    int hinge_count;
    int32_t (
        *triangle_hinge )[3]; // [triangle_count] across the edge from corner k to the next; -1: open. In `parts`
    uint8_t* place;           // [rows] of a patch while it is added: 1 and more; 0: not in it. In `parts`
    float max_rate;
    bool filled;
    int lowered;           // triangles that are scaled down
    float largest;         // 1/(kg m^2), of a triangle alone
    float scaled_to;       // 1/(kg m^2)
    uint64_t maps, masses; // what the maps, 0: none, and all masses were at the last fill
    atomic_int owners;
    const wisp_fabric* fabric;
    fabric_pool pool;
    fabric_pool parts; // what coefficients are computed from, released when they are
};

// Stencil of the curvature of one triangle: its turns as linear combinations of those of hinges, and of the vertices around.
typedef struct plate_patch
{
    int hinge_count, vertex_count;
    int32_t hinge[PLATE_PATCH], vertex[PLATE_PATCH];
    double of_hinge[3][PLATE_PATCH];
    double of_vertex[3][PLATE_PATCH]; // 1/m
} plate_patch;

// Relative to a corner, so that nothing is lost far from the origin.
static inline double3 plate_edge( const wisp_fabric* f, int32_t from, int32_t to )
{
    return double3_sub( double3_widen( f->rest[to] ), double3_widen( f->rest[from] ) );
}

static inline double plate_area( const wisp_fabric* f, const int32_t* t )
{
    return 0.5 * double3_length( double3_cross( plate_edge( f, t[0], t[1] ), plate_edge( f, t[0], t[2] ) ) );
}

static inline double plate_share_by_height( const plate_shape* shape )
{
    return shape->height[0] / ( shape->height[0] + shape->height[1] );
}

/// List the hinges, how their triangles share a turn, and the rows of the matrices, if that is due. @return false if out of memory
bool plate_list_parts( wisp_plate* plate, const wisp_fabric* f );
/// Forget these.
void plate_release_parts( wisp_plate* plate );

/// Return an entry of a row, as `other` has it.
static inline int32_t plate_other( const plate_row_set* set, int32_t entry, int32_t row )
{
    const int32_t first = 4 * ( row - row % 8 );
    return set->other != NULL ? set->other[entry][row % 8]
           : set->of_hinges   ? set->near[entry][row % 8]
                              : first + (int16_t)set->near[entry][row % 8];
}

/// Shape of a hinge. @return false: an edge without a length or a triangle without a height
bool plate_measure_hinge( const wisp_fabric* f, const plate_hinge* h, plate_shape* out );

/// Turn of side 0 from J of the stencil, next to pins.
void plate_share_turn( const wisp_plate* plate, const wisp_fabric* f, const plate_hinge* h,
                       const int32_t stencil[PLATE_STENCIL], double share[PLATE_STENCIL] );

/// Energy of the turns of a triangle at its edges, 1/2 sum of m d d. Edges at a right angle have exactly none in common.
void plate_turn_energy( const wisp_plate* plate, const wisp_fabric* f, int32_t triangle, double m[3][3] );

/// Turns of a triangle's edges as linear combinations of those of hinges and of the vertices around.
plate_patch plate_patch_of( const wisp_plate* plate, const wisp_fabric* f, int32_t triangle );
