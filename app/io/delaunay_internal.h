/// Shared by the files of the triangulation: predicates, and triangles with their neighbours.
#pragma once

#include "delaunay.h"

__extension__ typedef __int128 delaunay_wide;

enum
{
    DELAUNAY_FRAME = 4,    // corners of a square around everything, behind the points
    DELAUNAY_NO_TWIN = -1, // across the frame there is nothing
};

/// Half-edge 3 * t + k runs from corner k of triangle t to the next. Triangles are counter-clockwise.
typedef struct delaunay
{
    const char* name;       // for messages
    delaunay_point* points; // [point_count + DELAUNAY_FRAME]
    int32_t* corners;       // [3 * triangle_room] where each half-edge begins
    int32_t* twins;         // [3 * triangle_room] the half-edge across
    bool* locked;           // [3 * triangle_room] is a part of the outline and stays
    bool* waiting;          // [3 * triangle_room] lies on the stack
    int32_t* stack;         // [3 * triangle_room] half-edges whose neighbourhood changed
    int32_t* leaving;       // [point_count + DELAUNAY_FRAME] a half-edge that begins at the point
    int point_count, triangle_count, stack_count;
} delaunay;

// ---- predicates ------------------------------------------------------------------------------------------------

// The frame reaches one side of the lattice beyond it, so that differences of coordinates are at most 3 * 2^26, which
// is below 2^28. A product of two is below 2^56, a sum or a difference of two products below 2^57: 64 bits hold it.

/// Twice the area of the triangle: positive if it runs counter-clockwise, 0 if the points lie on a line.
static inline int64_t delaunay_turn( delaunay_point a, delaunay_point b, delaunay_point c )
{
    return ( (int64_t)b.x - a.x ) * ( (int64_t)c.y - a.y ) - ( (int64_t)b.y - a.y ) * ( (int64_t)c.x - a.x );
}

/// Whether d lies inside the circle around a, b, c, which run counter-clockwise. The determinant is the sum of three
/// products of a squared length and an area: below 3 * 2^57 * 2^57, which is below 2^116.
static inline bool delaunay_is_inside( delaunay_point a, delaunay_point b, delaunay_point c, delaunay_point d )
{
    const delaunay_point corner[] = { a, b, c };
    delaunay_wide determinant = 0;
    for ( int k = 0; k < 3; ++k )
    {
        int64_t x = (int64_t)corner[k].x - d.x, y = (int64_t)corner[k].y - d.y;
        determinant +=
            (delaunay_wide)( x * x + y * y ) * delaunay_turn( d, corner[( k + 1 ) % 3], corner[( k + 2 ) % 3] );
    }
    return determinant > 0;
}

// ---- half-edges ------------------------------------------------------------------------------------------------

static inline int32_t delaunay_next( int32_t half )
{
    return half % 3 == 2 ? half - 2 : half + 1;
}

static inline int32_t delaunay_previous( int32_t half )
{
    return half % 3 == 0 ? half + 2 : half - 1;
}

/// The point where a half-edge begins, and where it ends.
static inline int32_t delaunay_from( const delaunay* d, int32_t half )
{
    return d->corners[half];
}

static inline int32_t delaunay_to( const delaunay* d, int32_t half )
{
    return d->corners[delaunay_next( half )];
}

// ---- delaunay_insert.c -----------------------------------------------------------------------------------------

/// Flip the edge between two triangles to the other diagonal of their quadrilateral. The four edges around go on the
/// stack.
void delaunay_flip( delaunay* d, int32_t half );

/// Insert all points, whose memory is allocated, into a square around them.
/// @return WISP_BAD_INPUT two points are at one position; WISP_NO_MEMORY
wisp_status delaunay_insert( delaunay* d, wisp_error* error );

/// Flip until no unlocked edge on the stack has a point inside a neighbour's circle (Lawson 1977).
void delaunay_settle( delaunay* d );

// ---- delaunay_outline.c ----------------------------------------------------------------------------------------

/// Make the edges of the outline edges of triangles, and lock them.
/// @return WISP_BAD_INPUT it crosses itself or passes through a point
wisp_status delaunay_enforce( delaunay* d, int outline_count, wisp_error* error );

/// Write the triangles inside the outline.
/// @return WISP_BAD_INPUT a point has none of them; WISP_NO_MEMORY
wisp_status delaunay_take_inside( delaunay* d, int outline_count, int32_t* triangles, wisp_error* error );
