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

typedef struct boundary_state
{
    wisp_component settings;  // boundary_settings
    wisp_component normals;   // vertex normals
    wisp_component edges;     // counts of edges, and their spacing
    wisp_component triangles; // likewise
    wisp_component local;     // marker: a criterion is on
    wisp_component read;      // WISP_SAMPLES_READ: another module reads the points in the substeps
    boundary_layer** layers;  // [layer_count] by rising index of their entities
    int layer_count, layer_capacity;
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

/// @return null if there is none
boundary_layer* boundary_find_layer( const boundary_state* state, wisp_entity entity );
/// The elements of a fabric, without points. @return null without memory
boundary_layer* boundary_layer_create( const wisp_allocator* allocator, const wisp_fabric* fabric,
                                       wisp_entity entity );
void boundary_layer_release( boundary_layer* layer, const wisp_allocator* allocator );
/// Insert the first layer of its entity into reserved memory.
void boundary_put_layer( boundary_state* state, boundary_layer* layer );
void boundary_drop_layer( boundary_state* state, const wisp_allocator* allocator, wisp_entity entity );

// ---- passes ----

void boundary_find_normals( wisp_frame* frame, const wisp_span* span, void* user );
void boundary_find_spacing( wisp_frame* frame, const wisp_span* span, void* user );
void boundary_place_points( wisp_frame* frame, const wisp_span* span, void* user );
/// All three, before the substeps.
void boundary_share_points( wisp_frame* frame, const wisp_span* span, void* user );
