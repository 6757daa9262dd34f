/// What is searched: the boxes of surfaces that lie close to themselves or to each other, as contact makes them.
#pragma once

#include "mesh.h"
#include "wisp/fabric.h"
#include "wisp/module/aabb_pairs.h"

typedef enum query_input_source
{
    QUERY_INPUT_SHEET,   ///< a sheet in four layers
    QUERY_INPUT_SPHERES, ///< two spheres that touch
    QUERY_INPUT_SOURCES,
} query_input_source;

typedef enum query_input_kind
{
    QUERY_INPUT_PARTICLES, ///< boundary particles among themselves: one at each vertex, as thick as they are apart
    QUERY_INPUT_VERTICES,  ///< vertices against triangles, a quarter as thick as edges are long
    QUERY_INPUT_EDGES,     ///< edges among themselves, as thick
    QUERY_INPUT_KINDS,
} query_input_kind;

extern const char* const query_input_source_names[QUERY_INPUT_SOURCES];
extern const char* const query_input_kind_names[QUERY_INPUT_KINDS];

/// A mesh, cooked, so that its order is that of what contact searches.
typedef struct query_input_mesh
{
    query_input_source source;
    wisp_fabric* fabric;
    int copies;
    float edge;   ///< m, typical
    float extent; ///< m, of the flat sheet; the radius of a sphere
} query_input_mesh;

/// @param size vertices a side of the sheet; level of the icospheres
wisp_status query_input_make_mesh( query_input_source source, int size, query_input_mesh* out, wisp_error* error );
void query_input_free_mesh( query_input_mesh* mesh );

enum
{
    QUERY_INPUT_BEFORE, ///< where all is at one search ...
    QUERY_INPUT_AFTER,  ///< ... and at the next: everything went its reach or less
    QUERY_INPUT_TIMES,
};

/// Boxes of one kind.
typedef struct query_input_boxes
{
    wisp_aabb *queries[QUERY_INPUT_TIMES], *boxes[QUERY_INPUT_TIMES]; ///< queries are null where boxes ask each other
    int query_count, box_count, particle_count;
} query_input_boxes;

wisp_status query_input_make_boxes( const query_input_mesh* mesh, query_input_kind kind, query_input_boxes* out,
                                    wisp_error* error );
void query_input_free_boxes( query_input_boxes* boxes );
