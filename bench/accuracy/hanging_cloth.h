/// The sheet of the scene `hanging_cloth`, for the scene itself and for bench/reference.
#pragma once

#include "accuracy_reference.h"

#include "cloth_scene.h"

#define HANGING_CLOTH_DENSITY 0.2f       // kg/m^2
#define HANGING_CLOTH_EDGE_STIFFNESS 1e3 // N/m, of every edge

enum
{
    HANGING_CLOTH_MESHES = 4,
    HANGING_CLOTH_STEPS = 24, // 0.4 s: later the cloth folds, and folds are chaotic
    HANGING_CLOTH_OBSERVATION_STEPS = 4,
    HANGING_CLOTH_OBSERVATIONS = HANGING_CLOTH_STEPS / HANGING_CLOTH_OBSERVATION_STEPS,
    HANGING_CLOTH_PLACES = 33, // per side, compared: every second vertex of the finest mesh
};

/// Vertices per side; coarser meshes have every second, fourth or eighth vertex of the finest one.
extern const int hanging_cloth_sizes[HANGING_CLOTH_MESHES];
double hanging_cloth_spacing( int mesh );
/// m/N, of a bend link: the same sheet on every mesh.
double hanging_cloth_bend_compliance( int mesh );
wisp_status hanging_cloth_make( int mesh, cloth_scene* out, wisp_error* error );

/// Scene, facts and size of the reference, [observations][places][places][3] m. @param finest the last mesh
accuracy_reference hanging_cloth_reference( const cloth_scene* finest );
