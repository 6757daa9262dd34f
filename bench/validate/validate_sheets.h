/// Sheets of cloth and strands in one world, by every solver, with supports, friction or air.
#pragma once

#include "validate_world.h"

#include "mesh.h"

/// What moves a sheet.
typedef enum sheet_solver
{
    SHEET_STRANDS,   ///< a strand with direct lengths: the first row of the mesh
    SHEET_XPBD,      ///< cloth, xpbd, without bending
    SHEET_DIHEDRAL,  ///< cloth, xpbd, bending dihedral
    SHEET_ISOMETRIC, ///< cloth, xpbd, bending isometric
    SHEET_IMPLICIT,  ///< implicit cloth of a material
    SHEET_BALLOON,   ///< the skin of a balloon, of a closed mesh
    SHEET_SOLVER_COUNT,
} sheet_solver;

extern const char* const sheet_solver_names[SHEET_SOLVER_COUNT];

#define SHEET_GRAVITY 9.81
#define SHEET_DENSITY 0.15       // kg/m^2, unless a fabric says otherwise
#define SHEET_STRAND_WIDTH 0.001 // m, of the ribbon that a strand stands for
#define SHEET_AIR 1.204f         // kg/m^3
#define SHEET_MARGIN 0.005f      // m, that is kept from the ground

typedef struct sheet_def
{
    sheet_solver solver;
    const wisp_mesh* mesh;
    int row;                ///< vertices in a row of the mesh
    const wisp_vec3* start; ///< [vertex_count] m; null: as meshed
    const int32_t* pins;    ///< of a strand, whose ends are pinned if it has pins
    int pin_count;
    double density;    ///< kg/m^2
    double rigidity;   ///< N m, against bending; 0: none
    double stiffness;  ///< N/m, of the membrane; 0: as stiff as the solver can be
    double damping;    ///< 1/s
    wisp_vec3 gravity; ///< m/s^2
    double friction;   ///< against the ground, y <= 0; below 0: does not collide
    double drag;       ///< coefficient in air; 0: none
} sheet_def;

/// A world of sheets, with a ground of friction 1 if sheets collide. @param out to be released, also after a failure
wisp_status sheet_world_create( sheet_solver solver, int substeps, int workers, bool has_ground, validate_world* out,
                                wisp_error* error );
/// Add a sheet to the bodies of a world.
/// @param is_watched its motion is measured
wisp_status sheet_add( validate_world* world, const sheet_def* def, bool is_watched, wisp_error* error );
