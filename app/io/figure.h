/// A human-like figure made by a recipe: a closed mesh in a relaxed pose with the arms apart, its skeleton and its weights.
///
/// It stands on y = 0 around the axis y and looks along +z; its left side is at +x. Joints: hips (the root), spine, chest, neck, head,
/// and left_ and right_ shoulder, upper_arm, forearm, hand, thigh, shin, foot. Axes of joints at rest are those of the world.
#pragma once

#include "mesh.h"
#include "skeleton.h"

#ifdef __cplusplus
extern "C"
{
#endif

#define WISP_FIGURE_MIN_TRIANGLES 1500
#define WISP_FIGURE_MAX_TRIANGLES 200000

    typedef struct wisp_figure_generator
    {
        float height;       ///< m, 1e-3 .. 1e3
        int triangle_count; ///< WISP_FIGURE_MIN_TRIANGLES .. MAX_TRIANGLES; the mesh has as many within a tenth
    } wisp_figure_generator;

    /// 1.75 m, 8000 triangles.
    wisp_figure_generator wisp_default_figure_generator( void );

    /// Zero-initialised is empty.
    typedef struct wisp_figure
    {
        wisp_mesh mesh; ///< closed, manifold, one component, outward normals
        wisp_skeleton skeleton;
        wisp_skin_weights
            weights; ///< of the mesh's vertices, sum 1; a function of the place on the body, not of the mesh
    } wisp_figure;

    /// Generate a figure. The surface is a smooth union of round cones, meshed by dual marching cubes (Nielson 2004), then evened out.
    /// The same definition gives the same bits on every machine.
    /// @param out receives the figure, to be released; empty on failure
    /// @return WISP_BAD_INPUT the message names the value; WISP_NO_MEMORY
    wisp_status wisp_figure_generate( const wisp_figure_generator* generator, wisp_figure* out, wisp_error* error );
    void wisp_figure_release( wisp_figure* figure );

    /// The skeleton of a figure alone. @param out to be released
    wisp_status wisp_figure_skeleton( float height, wisp_skeleton* out, wisp_error* error );
    /// The weights of points on a figure: those that a figure is generated with, or others there.
    /// @param points [point_count] m, of a figure of that height at rest @param out to be released; empty on failure
    wisp_status wisp_figure_bind( float height, const wisp_vec3* points, int point_count, wisp_skin_weights* out,
                                  wisp_error* error );

    /// Read clips of keyframes from YAML, see data/figures/motions.yaml: a mapping with the list `clips`; a clip has name, duration in s,
    /// loops, interpolation (step, linear or cubic) and keys; a key has time in s, translation of the root from its place at rest in m,
    /// and rotations, a mapping from joints to [x, y, z] in degrees about the fixed axes x, then y, then z of the parent, or to a
    /// quaternion [x, y, z, w]. A joint that a key does not name has no keyframe there.
    /// @param bytes, size, name the text, and what messages call it
    /// @param scale factor of translations
    /// @param clip which one
    /// @param out receives the animation, checked for the skeleton, to be released; empty on failure
    /// @return WISP_BAD_INPUT the message names file, line and key; WISP_NO_MEMORY
    wisp_status wisp_animation_parse( const void* bytes, size_t size, const char* name, const char* clip,
                                      const wisp_skeleton* skeleton, float scale, wisp_animation* out,
                                      wisp_error* error );

#ifdef __cplusplus
}
#endif
