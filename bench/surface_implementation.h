/// A surface in a world of its own: what the cases of cloth and balloons step, time and measure.
#pragma once

#include "bench_world.h"
#include "stats.h"

#include "mesh.h"
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
    profile_samples profile; ///< of the steps that were kept
    int steps;
    int halted_at; ///< the step at which the engine halted it because it left its bounds; 0: it never did
} surface_implementation;

/// A surface that nothing acts on yet, with WISP_SURFACE_POINTS wanted as a renderer would.
wisp_status surface_implementation_create( const surface_generator* generator, surface_implementation* out,
                                           wisp_error* error );
void surface_implementation_destroy( surface_implementation* implementation );

/// One step. @param context the implementation, as a bench_variant has it
wisp_status surface_implementation_step( void* context, wisp_error* error );
/// Keep the last step's profile.
wisp_status surface_implementation_keep_profile( void* context );
/// Hash of the vertices in the user's order.
wisp_status surface_implementation_hash( surface_implementation* implementation, uint64_t* hash, wisp_error* error );
/// The vertices in the user's order, valid until the next step.
wisp_status surface_implementation_points( surface_implementation* implementation, const wisp_vec3** points,
                                           wisp_error* error );
/// Velocities in the user's order. @param out [vertex_count]
void surface_implementation_velocities( surface_implementation* implementation, wisp_vec3* out );

typedef struct surface_observation
{
    double stretch_max, stretch_mean; ///< |l/l0 - 1| of the edges
    double kinetic, potential;        ///< J; potential is 0 at the rest shape
    bool is_finite;
} surface_observation;

/// Measure the present state, in double.
surface_observation surface_implementation_observe( surface_implementation* implementation );
