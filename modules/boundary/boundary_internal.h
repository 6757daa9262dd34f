/// Layers, settings and components of the module.
#pragma once

#include "boundary.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"
#include "wisp/module/sampling.h"
#include "wisp/module/space.h"

/// A layer: its elements and its points. Not in snapshots.
typedef struct boundary_layer
{
    wisp_entity entity;
    int edge_count, triangle_count;
    int32_t* edges;         // [edge_count][2] the user's vertices, lower first, rising
    int32_t* edge_slots;    // [edge_count][2] the same as slots
    int32_t* triangle_edge; // [triangle_count][3] local edge k joins corners k and k + 1
    wisp_samples samples;
    wisp_samples shown; // with points in the host's coordinates, where those are not the ones of rows
    wisp_buffer moved;  // those points
    size_t bytes;       // of the block that this struct begins
    bool made;          // a step was made since the layer was set
    bool is_early;      // the points are those of a read before that step, which must not change what the step does
} boundary_layer;

/// The components, a row each: X( member, "name", table, columns ).
#define BOUNDARY_COMPONENTS( X )                                                                                     \
    X( settings, "boundary.settings", ENTITY, WISP_COLUMN( boundary_settings, settings, 1 ) )                        \
    X( normals, "boundary.normals", PARTICLE,                                                                        \
       WISP_COLUMN( float, normal, 4 ) ) /* mean of unit normals around, unit or 0 */                                \
    X( edges, "boundary.edges", EDGE,                                                                                \
       /* counts of edges, and their spacing */ WISP_COLUMN( float, spacing, 1 ), /* m, 0 without a criterion */     \
       WISP_COLUMN( float, length, 1 ), /* over the spacing, that the count was made from; 0 without hysteresis */   \
       WISP_COLUMN( int32_t, points, 1 ) )                                                                           \
    X( triangles, "boundary.triangles", TRIANGLE, /* likewise */ WISP_COLUMN( float, spacing, 1 ),                   \
       WISP_COLUMN( float, extent, 2 ), /* base and height, likewise */ WISP_COLUMN( int32_t, points, 1 ),           \
       WISP_COLUMN( int32_t, axis, 1 ) /* local edge */ )                                                            \
    X( local, "boundary.local", ENTITY, WISP_NO_COLUMNS ) /* marker: a criterion is on */                            \
    X( read, WISP_SAMPLES_READ, ENTITY, WISP_NO_COLUMNS ) /* in substeps, by another module */

typedef struct boundary_state
{
    BOUNDARY_COMPONENTS( WISP_COMPONENT_MEMBER )
    wisp_objects* layers; // boundary_layer
} boundary_state;

/// The definition with the defaults filled in.
typedef struct boundary_settings
{
    float spacing;
    int32_t policy, rounding, limit;
    float hysteresis, min_spacing, max_spacing, curvature_gain, strain_gain, eye_angle;
    wisp_vec3 eye;
} boundary_settings;

/// Columns of boundary.edges and boundary.triangles.
enum
{
    BOUNDARY_SPACING, // m, 0 without a criterion
    BOUNDARY_EXTENT,  // length, or base and height, over the spacing
    BOUNDARY_POINTS,
    BOUNDARY_AXIS, // of triangles
};

// ---- boundary_passes.c ----

/// The elements of a fabric, without points. @return null without memory
boundary_layer* boundary_layer_create( const wisp_allocator* allocator, const wisp_fabric* fabric,
                                       wisp_entity entity );
void boundary_layer_release( void* layer, const wisp_allocator* allocator );

// ---- passes ----

void boundary_find_normals( wisp_frame* frame, const wisp_span* span, void* user );
void boundary_find_spacing( wisp_frame* frame, const wisp_span* span, void* user );
void boundary_place_points( wisp_frame* frame, const wisp_span* span, void* user );
/// All three, before the substeps.
void boundary_share_points( wisp_frame* frame, const wisp_span* span, void* user );
