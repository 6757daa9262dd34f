/// Meshes and strands that hosts and tests need all the time. The functions fill arrays of the host; the macros say how large they are.
/// The same arguments give the same bits on every machine.
///
///     static wisp_vec3 points[WISP_GRID_VERTICES( 41, 41 )];
///     static int32_t triangles[WISP_GRID_TRIANGLES( 41, 41 )][3];
///     wisp_generate_grid( 41, 41, 0.025f, 0.025f, points, &triangles[0][0], NULL ); // 1 m x 1 m around the origin
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

/// Most vertices of a generated mesh or of generated strands.
#define WISP_GENERATE_MAX_VERTICES 67108864

#define WISP_GRID_VERTICES( columns, rows ) ( ( columns ) * ( rows ) )
#define WISP_GRID_TRIANGLES( columns, rows ) ( 2 * ( (columns)-1 ) * ( (rows)-1 ) )
#define WISP_SPHERE_VERTICES( segments, rings ) ( ( segments ) * ( (rings)-1 ) + 2 )
#define WISP_SPHERE_TRIANGLES( segments, rings ) ( 2 * ( segments ) * ( (rings)-1 ) )
#define WISP_CYLINDER_VERTICES( segments, parts ) ( ( segments ) * ( ( parts ) + 1 ) )
#define WISP_CYLINDER_TRIANGLES( segments, parts ) ( 2 * ( segments ) * ( parts ) )
#define WISP_CAPSULE_VERTICES( segments, rings, parts ) ( ( segments ) * ( 2 * ( rings ) + (parts)-1 ) + 2 )
#define WISP_CAPSULE_TRIANGLES( segments, rings, parts ) ( 2 * ( segments ) * ( 2 * ( rings ) + (parts)-1 ) )
#define WISP_TORUS_VERTICES( segments, rings ) ( ( segments ) * ( rings ) )
#define WISP_TORUS_TRIANGLES( segments, rings ) ( 2 * ( segments ) * ( rings ) )

/// Generate a grid in the plane y = 0 around the origin, with normals along +y. Vertex (i, j) has the number j * columns + i. A strip
/// is a grid of few columns.
/// @param columns, rows vertices along x and z, >= 2
/// @param dx, dz m, > 0, from vertex to vertex
/// @param points [WISP_GRID_VERTICES] @param triangles [WISP_GRID_TRIANGLES][3]
/// @param error may be null
/// @return WISP_BAD_INPUT a number is out of range, or an array is null (the message names it); nothing was written
WISP_API wisp_status wisp_generate_grid( int columns, int rows, float dx, float dz, wisp_vec3* points,
                                         int32_t* triangles, wisp_error* error );

/// Generate a sphere around the origin, with its poles on the axis y. Its normals point outwards, like those of the other round
/// meshes.
/// @param segments around the axis, >= 3 @param rings from pole to pole, >= 2
/// @param points [WISP_SPHERE_VERTICES] @param triangles [WISP_SPHERE_TRIANGLES][3]
WISP_API wisp_status wisp_generate_sphere( int segments, int rings, float radius, wisp_vec3* points,
                                           int32_t* triangles, wisp_error* error );

/// Generate a cylinder along y without ends, around the origin.
/// @param segments around the axis, >= 3 @param parts along it, >= 1
/// @param points [WISP_CYLINDER_VERTICES], ring by ring from above @param triangles [WISP_CYLINDER_TRIANGLES][3]
WISP_API wisp_status wisp_generate_cylinder( int segments, int parts, float radius, float length, wisp_vec3* points,
                                             int32_t* triangles, wisp_error* error );

/// Generate a capsule along y around the origin: a cylinder between two half spheres.
/// @param segments around the axis, >= 3 @param rings of a half sphere, >= 1 @param parts of the cylinder, >= 1
/// @param length m, > 0, of the cylinder
WISP_API wisp_status wisp_generate_capsule( int segments, int rings, int parts, float radius, float length,
                                            wisp_vec3* points, int32_t* triangles, wisp_error* error );

/// Generate a torus around the axis y.
/// @param segments around the axis, >= 3 @param rings around the tube, >= 3
/// @param radius m, of the centre line @param tube_radius m, > 0 and < radius
WISP_API wisp_status wisp_generate_torus( int segments, int rings, float radius, float tube_radius, wisp_vec3* points,
                                          int32_t* triangles, wisp_error* error );

/// Generate straight strands that hang down from a grid of roots in the plane y = 0 around the origin.
/// @param columns, rows roots along x and z, >= 1
/// @param spacing m, > 0, from root to root
/// @param vertices per strand, >= 2 @param length m, > 0, of a strand
/// @param points [columns * rows * vertices] strand by strand, roots first
/// @param offsets [columns * rows + 1] first vertex of each strand, as in wisp_strands_def
WISP_API wisp_status wisp_generate_strand_rows( int columns, int rows, float spacing, int vertices, float length,
                                                wisp_vec3* points, int32_t* offsets, wisp_error* error );

WISP_END_C
