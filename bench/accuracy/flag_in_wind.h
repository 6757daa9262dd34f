/// The flag of the scene `flag`, for the scene itself and for bench/reference.
#pragma once

#include "accuracy_reference.h"

#include "cloth/cloth.h"
#include "mesh.h"
#include "wisp/fabric.h"

#define FLAG_DENSITY 0.12f // kg/m^2
#define FLAG_GRAVITY 9.81f

enum
{
    FLAG_COLUMNS = 31,
    FLAG_ROWS = 21,
    FLAG_VERTICES = FLAG_COLUMNS * FLAG_ROWS,
    FLAG_EARLY_STEPS = 12, // 0.2 s: flapping is chaotic, so the path is compared only before it
    FLAG_OBSERVATION_STEPS = 2,
    FLAG_OBSERVATIONS = FLAG_EARLY_STEPS / FLAG_OBSERVATION_STEPS,
    FLAG_STEPS = 60, // averages are over the steps after the early ones
    FLAG_PATH = 3 * FLAG_OBSERVATIONS * FLAG_VERTICES,
};

/// A flag at its start.
typedef struct flag_body
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    int32_t pins[FLAG_ROWS];
} flag_body;

/// @param out to be given to flag_free() even after a failure
wisp_status flag_make( flag_body* out, wisp_error* error );
void flag_free( flag_body* body );
/// Its material, with dihedral bending, without tethers and levels.
wisp_cloth_def flag_cloth( void );

/// Scene, facts and size of the reference: [observations][vertices][3] m, and J, the mean kinetic energy after the compared
/// path.
accuracy_reference flag_reference( const flag_body* body );
