/// Small grooms for the tests of frozen hair. Every coordinate is exactly a float, so that the oracle and
/// the engine receive the same numbers.
#pragma once

#include "frozen_hair_oracle.h"

typedef enum frozen_scene_shape
{
    FROZEN_SCENE_STRAIGHT, ///< equal segments with exact coordinates: every bend needs the fallback axis
    FROZEN_SCENE_WAVY,     ///< a wave in one plane, no two neighbouring segments parallel
    FROZEN_SCENE_CURLY,    ///< a helix, or loops in the plane
} frozen_scene_shape;

typedef struct frozen_scene
{
    frozen_oracle_hair hair; ///< points into the arrays below
    int vertex_count;
    int* offsets;
    double3* rest;
    double* stretch_stiffness; ///< 7 for every strand unless a test changes it
    double* bend_stiffness;    ///< 7
    double* intensity;         ///< 0.8
} frozen_scene;

/// Make strands of equal vertex count with roots on a line (2D) or on a square lattice (3D).
/// @param spacing m between roots, rounded to a multiple of 2^-14 m
/// @return false when memory runs out; then nothing needs to be destroyed
bool frozen_scene_create( frozen_scene* scene, frozen_scene_shape shape, int dimension, int strand_count,
                          int vertices_per_strand, double spacing );

void frozen_scene_destroy( frozen_scene* scene );
