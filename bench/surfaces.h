/// Surfaces in worlds of their own: sheets, balloons, and the cloth of Noh and Jung.
#pragma once

#include "bench_world.h"
#include "mesh.h"
#include "stats.h"

#include "balloon/balloon.h"
#include "implicit_cloth/implicit_cloth.h"
#include "membrane/membrane.h"
#include "wisp/fabric.h"

/// What there is besides the effect. Start from surface_default_generator().
typedef struct surface_generator
{
    const wisp_module* module; ///< the effect of the world
    const wisp_module* second; ///< another module beside it, or null
    wisp_fabric* fabric;       ///< the caller's, who keeps it until the implementation is gone
    const wisp_vec3* points;   ///< [vertex_count] where the vertices start; null: the rest shape
    const int32_t* pins;
    int pin_count;
    float area_density; ///< kg/m^2
    float vertex_mass;  ///< kg, above 0 it counts instead
    wisp_vec3 gravity;  ///< m/s^2
    float damping;      ///< 1/s
    int substeps, iterations;
    int workers;
    float seconds; ///< a step
} surface_generator;

/// Steps of 1/60 s, one substep of one iteration, one worker, no gravity.
surface_generator surface_default_generator( const wisp_module* module, wisp_fabric* fabric );

/// Cook a mesh. @param def what to cook; points and triangles are filled in here
wisp_status surface_cook( const wisp_mesh* mesh, wisp_fabric_def def, wisp_fabric** out, wisp_error* error );

/// A regular plane of columns x rows vertices about the origin. @param spacing m
wisp_status surface_plane( int columns, int rows, double spacing, wisp_mesh* out, wisp_error* error );

typedef struct surface_implementation
{
    wisp_world* world;
    wisp_entity entity;
    wisp_fabric* fabric;
    surface_generator generator;
    int steps;
    int halted_at; ///< the step at which the engine halted it because it left its bounds; 0: it never did
} surface_implementation;

/// A surface that nothing acts on yet, with WISP_SURFACE_POINTS wanted as a renderer would.
wisp_status surface_implementation_create( const surface_generator* generator, surface_implementation* out,
                                           wisp_error* error );
void surface_implementation_destroy( surface_implementation* implementation );

/// One step. @param context the implementation, as a bench_variant has it
wisp_status surface_implementation_step( void* context, wisp_error* error );
/// Hash of the vertices in the user's order.
wisp_status surface_implementation_hash( surface_implementation* implementation, uint64_t* hash, wisp_error* error );
/// The vertices in the user's order, valid until the next step.
wisp_status surface_implementation_points( surface_implementation* implementation, const wisp_vec3** points,
                                           wisp_error* error );

// ---- balloons ----

// Balloons for measurements: spheres of any fineness, with the outlet and gas of an experiment.

#define BALLOON_RADIUS 0.15f
#define BALLOON_AREA_DENSITY 0.02f
#define BALLOON_STEP ( 1.0f / 60.0f )
#define BALLOON_SUBSTEPS 10
#define BALLOON_ITERATIONS 2

/// 10 * 4^level + 2 vertices about the origin.
wisp_status balloon_mesh_sphere( int level, float radius, wisp_mesh* out, wisp_error* error );

/// The vertex farthest along a direction; ties go to the lowest index.
int balloon_mesh_extreme( const wisp_mesh* mesh, wisp_vec3 direction );

/// Parameters of an experiment, apart from the mesh. Start from balloon_default_setting().
typedef struct balloon_setting
{
    wisp_balloon_def def;
    const wisp_membrane_def* membrane; ///< the skin instead of links; null: links
    const wisp_vec3* points;           ///< [vertex_count] where the vertices start; null: the rest shape
    float area_density;                ///< kg/m^2
    wisp_vec3 gravity;                 ///< m/s^2
    float damping;                     ///< 1/s
    wisp_solve_order solve_order;
    const int32_t* pins;
    int pin_count;
    int substeps, iterations, workers;
    float seconds; ///< per step
} balloon_setting;

/// In still air at rest: 9.8 m/s^2, buoyancy, drag; 10 substeps of two iterations, steps of 1/60 s.
balloon_setting balloon_default_setting( void );
/// In a vacuum without gravity: nothing but skin and gas.
balloon_setting balloon_setting_in_vacuum( void );

wisp_status balloon_cook( const wisp_mesh* mesh, const balloon_setting* setting, wisp_fabric** out,
                          wisp_error* error );
/// A balloon with statistics requested.
wisp_status balloon_implementation_create( wisp_fabric* fabric, const balloon_setting* setting,
                                           surface_implementation* out, wisp_error* error );
wisp_status balloon_implementation_read( surface_implementation* implementation, wisp_balloon_stats* out,
                                         wisp_error* error );

/// Volume of a closed mesh, m^3.
double balloon_volume( const wisp_mesh* mesh, const wisp_vec3* points );
/// The vertices of a mesh, scaled from the origin. @return [vertex_count], for free(); null: no memory
wisp_vec3* balloon_scaled_points( const wisp_mesh* mesh, double scale );

// ---- readings of pressure ----

// The pressure of a balloon as it reads it, by the gas law and by its closed form.

/// Sum of k l^2 over all links at rest, N m: what the pressure of a mesh that is scaled evenly goes with.
double balloon_stiffness_sum( const wisp_fabric* fabric, const wisp_balloon_def* def );

typedef struct balloon_readings
{
    double pressure;     ///< Pa above the atmosphere, as the balloon reads it
    double gas_law;      ///< Pa, P_atm (V_0 - V) / V
    double volume_error; ///< V / V_0 - 1
    double closed_form;  ///< Pa, of the mesh scaled to the volume that it has: every link k (l - d)
} balloon_readings;

/// One more step, with statistics.
wisp_status balloon_read_all( surface_implementation* implementation, const balloon_setting* setting,
                              balloon_readings* out, wisp_error* error );

// ---- cloth of Noh and Jung ----

// The scene of Noh and Jung: a square of cloth, 1 m wide, above a ball; as an irregular triangle mesh,
// or as quads with first and second neighbours. Without the ball it hangs, or flies.

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

/// A world with the cloth, and with the ball if the setting has it.
/// @param scene the caller's, who keeps it until the implementation is gone
wisp_status triangle_enter( const triangle_scene* scene, const triangle_setting* setting, surface_implementation* out,
                            wisp_error* error );
