/// Boundary particles: a layer of points on a surface, on its edges and inside its triangles, about a spacing apart, with
/// interpolated normals (boundary particle paper, docs/methods.md). It follows the surface after each step and changes nothing of it: the surface has the same
/// bits with and without. It is there to be drawn, exported, or read by what couples to it.
#pragma once

#include "wisp/samples.h"
#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_boundary_module;

/// How to sample. Fill from wisp_default_boundary_def(). Copied.
typedef struct wisp_boundary_def
{
    float spacing;          ///< d, m, > 0; default 0: half of the mean rest length of the edges
    wisp_spacing policy;    ///< default even
    wisp_rounding rounding; ///< default down
    bool scanline_normals;  ///< inner normals from the ends of a line; default false: barycentric
    float hysteresis;       ///< of a spacing, in [0, 0.5]: counts stay while lengths are so near to where they would
                            ///< change; default 0, as in the paper. Counts of a triangle stay or go together
    int max_points;         ///< points at most, > 0; default 4 000 000. A layer that would have more stays as it was

    // Local spacing (not in the paper), one value an edge: d_e = clamp( the least that a criterion asks for, least, most ).
    // A triangle has the least of its three edges: what an edge asks for holds beside it, too.
    float min_spacing;    ///< m; default 0: a quarter of the spacing
    float max_spacing;    ///< m; default 0: four times the spacing
    float curvature_gain; ///< 1/rad: the spacing is divided by 1 + gain times the angle between the normals of the
                          ///< edge's ends; default 0: off
    float strain_gain;    ///< the spacing is divided by 1 + gain |l/l0 - 1|, or times it where the gain is negative;
                          ///< default 0: off
    bool by_screen;       ///< the spacing is what `pixels` come to at the edge's middle; default false
    wisp_vec3 eye;        ///< m, with by_screen
    float pixel_angle;    ///< rad that a pixel spans, > 0; default 0.001
    float pixels;         ///< default 4
    uint32_t cookie;
} wisp_boundary_def;

WISP_API wisp_boundary_def wisp_default_boundary_def( void );

/// Give a surface its layer, or change how it is sampled: the next step samples everything anew.
/// @return WISP_BAD_INPUT a value is out of range (the message names it); WISP_CONFLICT the module is not registered, or
///         the entity is not a surface; WISP_NO_MEMORY
/// @note A mesh may be open; an edge of more than two triangles is sampled once; a unreferenced vertex has no points
WISP_API wisp_status wisp_set_boundary( wisp_world* world, wisp_entity surface, const wisp_boundary_def* def );
/// Take the layer away, and its passes with it.
WISP_API wisp_status wisp_unset_boundary( wisp_world* world, wisp_entity surface );
/// Look from somewhere else from the next step on. @param eye m, finite
/// @return WISP_CONFLICT also if the surface has no layer, or its spacing is not by_screen
WISP_API wisp_status wisp_set_boundary_eye( wisp_world* world, wisp_entity surface, wisp_vec3 eye );

/// The layer after a step. Arrays are the world's, valid until the next call that changes it.
typedef struct wisp_boundary_view
{
    const wisp_samples* samples; ///< parents are slots of the fabric times 4
    int edge_count;              ///< of the mesh: elements below it are edges, the others triangles
    const int32_t* edges;        ///< [edge_count][2] the user's vertices, lower first, rising
    const int32_t* slot_vertex;  ///< of the fabric, to name parents in the user's numbers
} wisp_boundary_view;

/// @return WISP_CONFLICT the surface has no layer, or no step was made since it was set
WISP_API wisp_status wisp_read_boundary( wisp_world* world, wisp_entity surface, wisp_boundary_view* out );

/// What the last update did.
typedef struct wisp_boundary_stats
{
    int points, edge_points, inner_points;
    int elements;         ///< edges and triangles of the mesh
    int changed_elements; ///< sampled anew: case B
    int skipped_elements; ///< with a corner that is not finite
    bool refused;         ///< the limit was met
    double requested;     ///< points that would have been needed
    size_t bytes;         ///< of the layer
} wisp_boundary_stats;

/// @return WISP_CONFLICT as wisp_read_boundary()
WISP_API wisp_status wisp_read_boundary_stats( wisp_world* world, wisp_entity surface, wisp_boundary_stats* out );

WISP_END_C
