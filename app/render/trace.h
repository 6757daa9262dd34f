/// Rays against the bodies of a scene. The only interface to Embree, with one file behind it. All input is checked
/// first, because a release of Embree with its asserts on ends the process at the first ray that is not finite.
#pragma once

#include "render.h"

/// Trees over all bodies. Read-only once built: any number of threads may query them.
typedef struct trace_tree trace_tree;

typedef struct trace_ray
{
    wisp_vec3 origin;
    wisp_vec3 direction; ///< unit length
    float far;           ///< m, may be infinite
} trace_ray;

typedef struct trace_hit
{
    float distance;   ///< m
    int body;         ///< meshes by their number, then curves, then points
    int primitive;    ///< triangle; for curves the first of the segment's two vertices; the point
    float u, v;       ///< weights of a triangle's second and third vertex; u along a segment
    wisp_vec3 normal; ///< of the surface itself, unit length, either side
} trace_hit;

/// Strands that are too thin to be visible are widened.
typedef struct trace_widening
{
    wisp_vec3 eye;
    float radius_fraction; ///< minimum radius per metre of distance from the camera
} trace_widening;

/// The radius at which a strand's vertex is drawn.
float trace_radius( const trace_widening* widening, const render_curves* curves, int vertex );

/// The direction of a strand at a vertex, from root to tip; upwards where it has none.
wisp_vec3 trace_tangent( const render_curves* curves, int strand, int vertex );

/// @param scene checked by render_check_scene()
/// @return WISP_NO_MEMORY; WISP_CONFLICT an Embree error, with its reason
wisp_status trace_build( const render_scene* scene, const trace_widening* widening, trace_tree** out,
                         wisp_error* error );

/// Null is allowed.
void trace_release( trace_tree* tree );

/// The nearest body on the ray. @return false if there is none, or the ray is invalid
bool trace_nearest( const trace_tree* tree, const trace_ray* ray, trace_hit* hit );

/// Whether anything is on the ray. Cheaper than finding the nearest.
bool trace_blocked( const trace_tree* tree, const trace_ray* ray );
