/// The scenes of `wisp bench cloth --compare`: the triangle scene's cloth of 958 vertices, one material in SI units,
/// for all solvers. This file has the data common to all solvers and the reference.
#pragma once

#include "triangle_scene.h"

#include "oracle/triangle_oracle.h"

#define COMPARE_SEED 1
#define COMPARE_STRETCH_STIFFNESS 200.0f  ///< N/m, of every edge
#define COMPARE_OBSERVATION_SECONDS 0.05f ///< between samples: whole steps of 1/60, 1/100, 1/200, 1/400 and 1/800 s
#define COMPARE_FRAME ( 1.0f / 60.0f )    ///< s

typedef enum compare_scenario
{
    COMPARE_DRAPE, ///< falls 5 cm onto the ball and begins to drape
    COMPARE_TAUT,  ///< all of its border held, stretched, released under gravity: hardly an edge is ever slack
    COMPARE_SCENARIO_COUNT,
} compare_scenario;

typedef struct compare_physics
{
    const char* name;      ///< of rows and of the reference's file
    bool has_ball;         ///< otherwise the border is pinned
    float drop;            ///< m, how much lower than in the triangle scene the cloth starts
    float widening;        ///< of the flat cloth before the start
    float bend;            ///< N m^2, of every diagonal
    float damping;         ///< 1/s, of all velocity
    float damping_link;    ///< N s/m, k_d of every link, which only the reference and implicit cloth have
    int observation_count; ///< of the window: at 0, and then every COMPARE_OBSERVATION_SECONDS
    int timed_observation; ///< times are taken after this sample: before it hardly anything happens
    float rest_seconds;    ///< time of the last sample
} compare_physics;

compare_physics compare_physics_of( compare_scenario scenario );

/// Mesh, start positions, and data common to the bench and the reference.
typedef struct compare_scene
{
    compare_physics physics;
    triangle_scene base; ///< the mesh at rest
    wisp_vec3*
        start; ///< [vertex_count] start positions. For COMPARE_TAUT the first sample of the reference replaces them
    int32_t* border; ///< [border_count] vertices
    int border_count;
    int32_t* edges; ///< [edge_count][2]
    int edge_count;
    double* lengths; ///< [edge_count] m, at rest
    double* masses;  ///< [vertex_count] kg
    uint64_t hash;   ///< of the mesh, so that a reference of another mesh is rejected
    double rigidity; ///< N m: bending of the diagonals as the rigidity of a sheet, on average
} compare_scene;

/// @param vertices TRIANGLE_VERTICES; tests have fewer
wisp_status compare_scene_make( compare_scenario scenario, int vertices, compare_scene* out, wisp_error* error );
void compare_scene_free( compare_scene* scene );

/// Measures of a shape, equal for every solver.
typedef struct compare_observation
{
    double hem;    ///< m, mean height of the border; of COMPARE_TAUT, whose border is held: of all vertices
    double strain; ///< mean |l / l0 - 1| of the edges
    double energy; ///< J: kinetic, of gravity (0 at the height 0), and of edges that are longer than at rest
    double slack;  ///< edges that are shorter than at rest
} compare_observation;

/// @param points, velocities [vertex_count][3]
compare_observation compare_observe( const compare_scene* scene, const double* points, const double* velocities );
