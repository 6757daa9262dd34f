/// The scene of Noh and Jung: a square of cloth, 1 m wide, above a ball; as an irregular triangle mesh,
/// or as quads with first and second neighbours. Without the ball it hangs, or flies.
#pragma once

#include "surface_implementation.h"

#include "implicit_cloth/implicit_cloth.h"

#define TRIANGLE_VERTICES 958 ///< of the triangle mesh of Noh and Jung
#define TRIANGLE_QUAD_SIDE 25 ///< of its quad mesh
#define TRIANGLE_WIDTH 1.0f   ///< m
#define TRIANGLE_DENSITY 0.2f ///< kg/m^2
#define TRIANGLE_GRAVITY 9.81f
#define TRIANGLE_HEIGHT 1.0f ///< m, of the cloth at the start
#define TRIANGLE_BALL_HEIGHT 0.6f
#define TRIANGLE_BALL_RADIUS 0.25f
#define TRIANGLE_MARGIN 0.005f ///< m, within which the ball holds a vertex
#define TRIANGLE_STATIC_FRICTION 0.3f
#define TRIANGLE_KINETIC_FRICTION 0.2f

typedef struct triangle_scene
{
    wisp_mesh mesh;
    wisp_quad_pairs pairs; ///< none of a triangle mesh
    wisp_fabric* fabric;
} triangle_scene;

/// @param vertices of an irregular triangle mesh; 0: TRIANGLE_QUAD_SIDE by as many, joined as quads
wisp_status triangle_scene_make( int vertices, triangle_scene* out, wisp_error* error );
void triangle_scene_free( triangle_scene* scene );

/// How it is solved, and with what around it. Start from triangle_default_setting().
typedef struct triangle_setting
{
    wisp_implicit_cloth_def cloth; ///< the pairs of a quad mesh are filled in
    float seconds;                 ///< a step, default 0.01
    int workers;                   ///< default 1
    bool has_ball;                 ///< default true
    bool requests_stats;           ///< those of wisp_read_implicit_cloth_stats(), which cost time; default false
    wisp_vec3 gravity;             ///< m/s^2, default down
    const wisp_vec3* points;       ///< where the vertices start; null: the rest shape
    const int32_t* pins;
    int pin_count;
} triangle_setting;

triangle_setting triangle_default_setting( void );

/// Put the ball into an implementation's world, and let the implementation's surface collide with it.
wisp_status triangle_add_ball( surface_implementation* implementation );

/// A world with the cloth, and with the ball if the setting has it.
/// @param scene the caller's, who keeps it until the implementation is gone
wisp_status triangle_enter( const triangle_scene* scene, const triangle_setting* setting, surface_implementation* out,
                            wisp_error* error );
