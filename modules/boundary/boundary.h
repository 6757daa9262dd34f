/// Boundary particles: a layer of points on the edges and triangles of a surface, about one spacing apart, with interpolated
/// normals (boundary particle paper, docs/methods.md). The layer follows the surface after each step and does not change it:
/// the surface has the same bits with and without. Draw it, export it, or couple a fluid to it. Only contact by particles
/// (contact.h) acts on it: it takes the points of the start of the step for those of the surface.
///
///     wisp_boundary_def def = wisp_default_boundary_def();
///     def.spacing = 0.01f;                                   // m
///     wisp_set_boundary( world, surface, &def );
///     wisp_world_step( world, dt );
///     wisp_boundary_view layer;
///     wisp_read_boundary( world, surface, &layer );          // layer.samples->xyzw, ->normals
#pragma once

#include "wisp/samples.h"
#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_boundary_module;

/// How to sample a surface. Fill from wisp_default_boundary_def(). Copied.
typedef struct wisp_boundary_def
{
    uint32_t size;          ///< bytes; set by wisp_default_boundary_def()
    float spacing;          ///< d, m, > 0; default 0: half of the mean rest length of the edges
    wisp_spacing policy;    ///< default even
    wisp_rounding rounding; ///< default down
    float
        hysteresis; ///< in spacings, in [0, 0.5]: counts stay while lengths are this close to where they would change;
                    ///< default 0, as in the paper. The counts of a triangle change together
    int max_points; ///< > 0; default 4 000 000. A layer that would have more points keeps its previous ones

    // Local spacing (not in the paper), one value per edge: d_e = clamp( smallest value of all criteria, min_spacing,
    // max_spacing ). A triangle has the smallest value of its three edges.
    float min_spacing;    ///< m; default 0: a quarter of the spacing
    float max_spacing;    ///< m; default 0: four times the spacing
    float curvature_gain; ///< 1/rad: the spacing is divided by 1 + gain times the angle between the normals of the
                          ///< edge's ends; default 0: off
    float
        strain_gain; ///< the spacing is divided by 1 + gain |l/l0 - 1|, or multiplied by it if the gain is negative;
                     ///< default 0: off
    float
        eye_angle; ///< rad: the spacing at the midpoint of an edge spans this angle as seen from the eye; default 0: off
    wisp_vec3 eye; ///< m, position of the camera
} wisp_boundary_def;

WISP_DEFINITION( boundary_def );

/// Give a surface a layer, or replace its definition. The next step samples every element.
/// @return WISP_BAD_INPUT a value is out of range (the message names it); WISP_CONFLICT the module is not registered, or
///         the entity is not a surface; WISP_NO_MEMORY
/// @note A mesh may be open; an edge of more than two triangles is sampled once; an unreferenced vertex has no points
WISP_API wisp_status wisp_set_boundary( wisp_world* world, wisp_entity surface, const wisp_boundary_def* def );
/// Remove the layer and its passes.
WISP_API wisp_status wisp_unset_boundary( wisp_world* world, wisp_entity surface );
/// The layer after a step, or of the present positions before the first one. The world owns the arrays; they are valid until
/// the next call that changes it, and before the first step until the next read of the layer or its statistics.
typedef struct wisp_boundary_view
{
    const wisp_samples* samples; ///< parents are slots of the fabric times 4
    int edge_count;              ///< of the mesh: elements below it are edges, the others triangles
    const int32_t* edges;        ///< [edge_count][2] vertices in the user's order, lower first, ascending
    const int32_t* slot_vertex;  ///< of the fabric: from slots to the user's order
} wisp_boundary_view;

/// @return WISP_CONFLICT the surface has no layer; WISP_NO_MEMORY, or as wisp_world_explain(), before the first step
WISP_API wisp_status wisp_read_boundary( wisp_world* world, wisp_entity surface, wisp_boundary_view* out );

/// Statistics of the last update. Always available.
typedef struct wisp_boundary_stats
{
    int points, edge_points, inner_points;
    int elements;         ///< edges and triangles of the mesh
    int changed_elements; ///< elements that were resampled
    int skipped_elements; ///< elements with a corner that is not finite
    bool refused;         ///< the limit was reached
    double requested;     ///< points that the spacing requires
    size_t bytes;         ///< of the layer
} wisp_boundary_stats;

/// @return WISP_CONFLICT as wisp_read_boundary()
WISP_API wisp_status wisp_read_boundary_stats( wisp_world* world, wisp_entity surface, wisp_boundary_stats* out );

WISP_END_C
