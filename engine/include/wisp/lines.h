/// Lines of what is simulated, to see in a host's own renderer what the engine sees. Nothing has to be requested, and nothing changes.
///
///     static wisp_line lines[20000];
///     int count;                                                       // may be more than there is room for
///     wisp_debug_lines( world, WISP_LINES_ALL, NULL, lines, 20000, &count );
///     draw_lines( lines, sizeof( wisp_line_end ), 2 * ( count < 20000 ? count : 20000 ) );   // of vertices with colours
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

/// Kinds of lines, in the order in which they are listed. Lengths are those of the world: nothing is enlarged.
typedef enum wisp_line_kind
{
    WISP_LINES_PINS = 1, ///< magenta: a cross at each pinned vertex, three lines of half a mean edge or segment
    WISP_LINES_CONTACTS =
        2,                 ///< yellow: along the normal out of what is touched, over the distance that contact keeps
    WISP_LINES_FRAMES = 4, ///< red and green: first and second axis of the frames of rods, over half a segment
    WISP_LINES_LINKS = 8,  ///< edges and segments: grey at rest length, red 5 % above and blue 5 % below
    WISP_LINES_COLLIDERS =
        16, ///< cyan: circles, edges of boxes, hulls and meshes; 10 m of a plane; heights without diagonals
    WISP_LINES_ALL = 31,
} wisp_line_kind;

typedef struct wisp_line_end
{
    wisp_vec3 point;  ///< m
    wisp_vec3 colour; ///< linear red, green, blue in [0, 1]
} wisp_line_end;

typedef struct wisp_line
{
    wisp_line_end ends[2];
} wisp_line;

/// List the lines of all entities as the last step left them. Vertices touch a collider within 1.01 of the thickness at its end. Pairs of
/// contact are those that pressed on each other in the last substep, if no participant came or went since then.
/// @param kinds wisp_line_kind or-ed
/// @param origin m, place in the world that points are relative to; null: its origin
/// @param lines [capacity] of the host, receives the first lines; may be null with capacity 0
/// @param count receives how many there are, which may be more than the capacity
/// @return WISP_BAD_INPUT an argument is wrong (the message names it); WISP_NO_MEMORY
WISP_API wisp_status wisp_debug_lines( wisp_world* world, unsigned kinds, const double origin[3], wisp_line* lines,
                                       int capacity, int* count );

WISP_END_C
