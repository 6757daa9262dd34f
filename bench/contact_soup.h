/// What is searched: the boxes of surfaces that lie close to themselves or to each other, as contact makes them.
#pragma once

#include "mesh.h"
#include "wisp/fabric.h"
#include "wisp/module/box_pairs.h"

typedef enum soup_source
{
    SOUP_SHEET,   ///< a sheet in four layers
    SOUP_SPHERES, ///< two spheres that touch
    SOUP_SOURCES,
} soup_source;

typedef enum soup_kind
{
    SOUP_PARTICLES, ///< boundary particles among themselves: one at each vertex, as thick as they are apart
    SOUP_VERTICES,  ///< vertices against triangles, a quarter as thick as edges are long
    SOUP_EDGES,     ///< edges among themselves, as thick
    SOUP_KINDS,
} soup_kind;

extern const char* const soup_source_names[SOUP_SOURCES];
extern const char* const soup_kind_names[SOUP_KINDS];

/// A mesh, cooked, so that its order is that of what contact searches.
typedef struct soup_mesh
{
    soup_source source;
    wisp_fabric* fabric;
    int copies;
    float edge;   ///< m, typical
    float extent; ///< m, of the flat sheet; the radius of a sphere
} soup_mesh;

/// @param size vertices a side of the sheet; level of the icospheres
wisp_status soup_make_mesh( soup_source source, int size, soup_mesh* out, wisp_error* error );
void soup_free_mesh( soup_mesh* mesh );

enum
{
    SOUP_BEFORE, ///< where all is at one search ...
    SOUP_AFTER,  ///< ... and at the next: everything went its reach or less
    SOUP_TIMES,
};

/// Boxes of one kind.
typedef struct soup_boxes
{
    wisp_box *askers[SOUP_TIMES], *boxes[SOUP_TIMES]; ///< askers are null where boxes ask each other
    int asker_count, box_count, particle_count;
} soup_boxes;

wisp_status soup_make_boxes( const soup_mesh* mesh, soup_kind kind, soup_boxes* out, wisp_error* error );
void soup_free_boxes( soup_boxes* boxes );
