/// Pictures of meshes and strands by ray tracing: no window, no graphics processor. A picture is a pure function of
/// scene, camera and options; neither the number of threads nor their order changes a byte of it.
///
/// Lengths in metres, y up, colours linear RGB in [0, 1]. Nothing is kept after a call: arrays belong to the caller.
#pragma once

#include "image.h"
#include "wisp/base.h"
#include "wisp/module/jobs.h"

// ---- bodies ----

typedef enum render_material
{
    RENDER_SOLID, ///< colliders: matte, a broad weak gloss, opaque
    RENDER_CLOTH, ///< rough, with a little fuzz at the rim; some light comes through; its back is paler, unless it has `colours`
    RENDER_LATEX, ///< balloons: glossy, lamps mirrored in it, coloured light comes through the skin
    RENDER_GLASS, ///< walls that would hide what is behind them: nearly clear
} render_material;

/// Triangles. Fill from render_default_mesh().
typedef struct render_mesh
{
    const char* name;         ///< for messages; null: the number of the mesh
    const wisp_vec3* points;  ///< [vertex_count], finite
    const int32_t* triangles; ///< [triangle_count][3] indices into points
    const wisp_vec3* colours; ///< [vertex_count], or null: the one colour below
    int vertex_count;         ///<
    int triangle_count;       ///<
    wisp_vec3 colour;         ///< default by material
    render_material material; ///<
    bool is_faceted;          ///< normals of the triangles (boxes); default false: smooth, weighted by area
} render_mesh;

/// Strands as round curves. Fill from render_default_curves().
typedef struct render_curves
{
    const char* name;         ///< for messages; null: the number of the curves
    const wisp_vec3* points;  ///< [offsets[strand_count]], finite
    const int32_t* offsets;   ///< [strand_count + 1] from 0, never falling; a strand of one point is not drawn
    const float* radii;       ///< [offsets[strand_count]] m, or null: the one radius below
    const wisp_vec3* colours; ///< [offsets[strand_count]], or null: the one colour below
    int strand_count;         ///<
    float radius;             ///< m, default 4e-5 (a human hair)
    wisp_vec3 colour;         ///< default chestnut
    bool is_hair;             ///< smooth through the points, pointed at the tip if it has one radius, and each strand
                              ///< a little thicker and lighter than the next; default false: segments as they are
} render_curves;

/// Points as matte balls. Fill from render_default_points().
typedef struct render_points
{
    const char* name;         ///< for messages; null: the number of the points
    const wisp_vec3* points;  ///< [count], finite
    const wisp_vec3* colours; ///< [count], or null: the one colour below
    int count;                ///<
    float radius;             ///< m, > 0, default 0.01
    wisp_vec3 colour;         ///< default sand
} render_points;

/// What a picture shows. Fill from render_default_scene().
typedef struct render_scene
{
    const render_mesh* meshes;
    const render_curves* curves;
    const render_points* points;
    int mesh_count;
    int curves_count;
    int points_count;
    bool has_ground;          ///< default false
    float ground_height;      ///< m, y; seen from above only. Its squares are 1, 2 or 5 times a power of ten metres
    wisp_vec3 background_top; ///< default a cool grey
    wisp_vec3 background_bottom; ///< default a lighter one; the ground is made of it
    wisp_vec3 cut_normal; ///< any length; bodies are drawn where cut_normal . p <= cut_offset. Zero (default): whole
    float cut_offset;     ///<
} render_scene;

render_mesh render_default_mesh( render_material material );
render_curves render_default_curves( void );
render_points render_default_points( void );
render_scene render_default_scene( void );

// ---- camera ----

/// An axis-aligned box. Zero-initialised is empty.
typedef struct render_bounds
{
    wisp_vec3 lower, upper;
    bool is_filled;
} render_bounds;

/// The box of all bodies, without the ground.
/// @return WISP_BAD_INPUT as render_picture() for the scene; the box is then unchanged
wisp_status render_scene_bounds( const render_scene* scene, render_bounds* bounds, wisp_error* error );

/// The box around both: over all frames of a recording it keeps the camera still.
render_bounds render_bounds_union( render_bounds a, render_bounds b );

typedef struct render_camera
{
    wisp_vec3 eye, target; ///< m, apart from each other
    wisp_vec3 up;          ///< any length, not along the view
    float fov_degrees;     ///< from the lower to the upper edge, in [1, 150]
} render_camera;

/// Direction of an automatic camera. Fill from render_default_view().
typedef struct render_view
{
    float azimuth_degrees;   ///< about y, from +z towards +x: the angle of a turntable. Default 32: three quarters
    float elevation_degrees; ///< above the horizon, in [-89, 89], default 16
    float fov_degrees;       ///< default 28, a portrait lens
    float margin;            ///< empty fraction of the picture at each edge, in [0, 0.4], default 0.04
    bool is_turntable;       ///< fit the space that the box sweeps when it turns: one distance for all angles
} render_view;

render_view render_default_view( void );

/// The closest camera that shows the whole box. An empty box counts as a cube of 1 m.
/// @param aspect width / height, in [0.01, 100]
/// @return WISP_BAD_INPUT a number is not finite or outside its range
wisp_status render_frame_camera( const render_bounds* bounds, const render_view* view, float aspect,
                                 render_camera* camera, wisp_error* error );

/// The first body on the line from the camera to each point, without the ground.
/// @param points [count], finite
/// @param bodies [count]: the number of the body, meshes first, then curves, then points; -1 where the view is free
/// @return WISP_BAD_INPUT as render_picture(), or a point is not finite; WISP_NO_MEMORY; WISP_CONFLICT
wisp_status render_find_hiding( const render_scene* scene, const render_camera* camera, const wisp_vec3* points,
                                int count, int* bodies, wisp_error* error );

// ---- pictures ----

typedef enum render_tone
{
    RENDER_TONE_FILMIC, ///< highlights roll off to white and colours below stay as they are; default
    RENDER_TONE_SRGB,   ///< values brighter than white are cut
} render_tone;

/// @param share of the picture that is done, in [0, 1]; never called by two threads at once
typedef void render_progress_fn( void* user, double fraction );

#define RENDER_MAX_SIDE 16384
#define RENDER_MAX_SAMPLES 4096

/// Fill from render_default_options().
typedef struct render_options
{
    int width, height;                  ///< pixels, in [1, RENDER_MAX_SIDE], default 640 x 480
    int samples;                        ///< per pixel, in [1, RENDER_MAX_SAMPLES], best a power of two, default 16
    int threads;                        ///< in [1, WISP_MAX_WORKERS], default 1; unused with parallel_for
    uint64_t seed;                      ///< of the noise, default 1
    float exposure;                     ///< brightness, > 0, default 1
    render_tone tone;                   ///<
    float min_curve_pixels;             ///< minimum width of strands, in [0, 8], default 0.7
    wisp_vec3 light;                    ///< towards the key light in the world; zero (default): it follows the camera
    wisp_parallel_for_fn* parallel_for; ///< the host's own loop instead of internal threads, or null
    void* parallel_user;                ///< for parallel_for
    render_progress_fn* progress;       ///< or null
    void* progress_user;
    bool ( *is_cancelled )( void ); ///< asked before each tile, by any thread; null: never
    bool* sees_bodies;              ///< receives whether a body is in the picture, besides the ground; or null
} render_options;

render_options render_default_options( void );

/// Render. An infinite or missing number in the scene is rejected before anything is built.
/// @param out zero or an image to be replaced; unchanged on failure. Release with image_release().
/// @return WISP_BAD_INPUT an element is invalid (the message names body and vertex, triangle or strand), or an option
///        or the camera; WISP_NO_MEMORY; WISP_CONFLICT the ray tracer failed, with its reason
wisp_status render_picture( const render_scene* scene, const render_camera* camera, const render_options* options,
                            image* out, wisp_error* error );

/// A wisp_parallel_for_fn for callers without a job system. Blocks are taken one by one from a common counter; the calling
/// thread is worker 0. A thread that the system refuses is left out.
/// @param user int*: the number of threads, in [1, WISP_MAX_WORKERS]
void threads_parallel_for( void* user, int block_count, wisp_block_fn* run, void* context );
