// Supports: bodies that hold points up, and layers that lie on them.
#pragma once

#include "constraints.h"

enum
{
    CONTACT_NO_SUPPORT = 1 << 20,
    CONTACT_MAX_LAYERS = 64, // of a pile; what lies higher counts as not supported
    CONTACT_MAX_LEVER = 4,   // a correction moves no point by more than this many times what the sides lack
};

/// What holds a point up in a substep.
typedef struct contact_support
{
    float normal[3]; // unit, away from what supports it
    float motion[3]; // m, displacement of the body below in the substep
    int32_t layer;   // number of layers between it and the body that supports the pile; or CONTACT_NO_SUPPORT
} contact_support;

/// What presses on a point from above, and what carries it.
typedef struct contact_tally
{
    float normal, held; // kg m, as in contact_load
    float grip;         // of the rows below
    int32_t rows;       // number of rows below
} contact_tally;

typedef struct contact_supports
{
    contact_support* points; // [point]
    contact_load* loads;     // [point] of the substep before
    contact_tally* tallies;  // [point]
    bool any;
    wisp_buffer buffers[3];
} contact_supports;

/// The half spaces of a point, as rows of the kernel half_space: point, normal, motion, gap, corrections, friction.
typedef struct contact_half_spaces
{
    const float* row; // [count][16]
    int count;
} contact_half_spaces;

/// Points of a row, from begin on, before end.
typedef struct contact_side
{
    int begin, end;
} contact_side;

static inline float contact_dot( const float a[3], const float b[3] )
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Return the mobility of a side, sum w s^2, in 1/kg, but at least max w |s| / CONTACT_MAX_LEVER. Where the only free
/// point of a triangle is far from the contact, s is small, and a correction over sum w s^2 would throw it.
float contact_mobility_of( const contact_contact_mesh* s, const contact_row* row, contact_side side );

contact_half_spaces contact_half_spaces_of( const contact_work* work, int point );

/// Make room for the points of the contact mesh.
/// @return false without memory
bool contact_reserve_supports( const contact_work* work );

/// Find what supports each point, from the half spaces and the rows of the substep.
void contact_find_supports( const contact_work* work );

/// Return whether a point of a row is supported, so that contact_move_supported() has to move it.
bool contact_is_supported( const contact_work* work, const contact_row* row );

/// Return the point of a side in the highest layer, null if nothing supports any.
const contact_support* contact_highest( const contact_supports* supports, const contact_row* row, contact_side side );

/// Return the side of a row that lies on the other one; empty if neither does.
contact_side contact_upper_side( const contact_work* work, const contact_row* row );

/// Move the points of a row by a change of its distance. What would push a point against its support moves the other side.
/// @param sum of the row without supports, > 0
void contact_move_supported( const contact_work* work, contact_row* row, float change, float sum );

/// Put the points of a row back into their half spaces.
void contact_keep_inside( const contact_work* work, const contact_row* row );

/// Fetch the loads of the substep before.
void contact_begin_loads( const contact_work* work );

/// Apply friction to a supported row.
void contact_apply_pile_friction( const contact_work* work, contact_row* row );

/// Hand loads down to the layers below, for the next substep, and to the friction of bodies.
void contact_hand_down_loads( const contact_work* work );

/// Add how far the points [begin, end) of a row moved in the substep, with their weights.
void contact_add_way( const contact_contact_mesh* s, const contact_row* row, int begin, int end, float way[3] );

/// Find the tangential correction that a row still has to make, and add it to those made.
/// @param way m, how far its first side moved relative to the second @param most m, the greatest length of all of them
/// @param by m, receives it
void contact_find_slip( contact_row* row, const float way[3], float most, float by[3] );
