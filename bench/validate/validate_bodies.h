/// Slender bodies in one world, alike but for their bending: rods of strands and strips of cloth, clamped at the origin along +x.
#pragma once

#include "accuracy/accuracy.h"

#include "wisp/wisp.h"

/// What computes the bending.
typedef enum validate_solver
{
    VALIDATE_ROD,       ///< strands, bending rod
    VALIDATE_DIHEDRAL,  ///< cloth, bending dihedral
    VALIDATE_ISOMETRIC, ///< cloth, bending isometric
    VALIDATE_IMPLICIT,  ///< implicit cloth of a material
    VALIDATE_SOLVER_COUNT,
} validate_solver;

extern const char* const validate_solver_names[VALIDATE_SOLVER_COUNT];

enum
{
    VALIDATE_MAX_BODIES = 64,
    VALIDATE_MAX_CELLS = 64,
};

/// In lengths of a body.
typedef struct validate_point
{
    double x, y;
} validate_point;

#define VALIDATE_LENGTH 0.1   // m
#define VALIDATE_GRAVITY 9.81 // m/s^2

typedef struct validate_def
{
    validate_solver solver;
    int cells, substeps, workers;
    int count;           ///< of bodies
    const double* loads; ///< [count] G = rho g L^3 / EI
    wisp_vec3 gravity;   ///< m/s^2
    double damping;      ///< 1/s
    double lateral;      ///< in lengths: how far the free end starts aside, along y. The clamp is straight
    bool
        is_blade; ///< stiff in its plane: rods have a flat section across y, and GJ = EI; strips are on edge along z anyhow
    /// [count][cells + 1] where bodies start. Rods are clamped in the direction of their first cell. Null: straight
    const validate_point* shapes;
    bool is_curled;     ///< rods have their shape without load too; else they are straight without load
    double twist_ratio; ///< GJ / EI of rods; 0: 1
    const double*
        floors; ///< [count] x in lengths of a floor that faces the clamp; those with the same one in turn share it, of at most 32. Null: none
    double friction; ///< mu of the floors at the start
} validate_def;

typedef struct validate_bodies
{
    validate_def def;
    wisp_world* world;
    wisp_entity bodies[VALIDATE_MAX_BODIES];
    uint32_t masks[VALIDATE_MAX_BODIES]; // of the floors
    int steps, halted_at;
} validate_bodies;

/// @param out to be released, also after a failure
wisp_status validate_create( const validate_def* def, validate_bodies* out, wisp_error* error );
void validate_release( validate_bodies* bodies );
/// How far aside the free ends start, m.
double validate_start( const validate_def* def );
/// Change the direction of gravity. For rods. @param gravity m/s^2
wisp_status validate_turn_gravity( validate_bodies* bodies, wisp_vec3 gravity, wisp_error* error );
/// Change the friction of each body with its floor. @param mu [count]
wisp_status validate_set_friction( validate_bodies* bodies, const double* mu, wisp_error* error );
/// A step of 1/60 s, whose time is kept.
wisp_status validate_step( validate_bodies* bodies, accuracy_run* out, wisp_error* error );
/// The free end of a body, m, in the middle of its width.
wisp_status validate_tip( validate_bodies* bodies, int body, wisp_vec3* out, wisp_error* error );
/// Hash the points of all bodies, and keep what a step is made of.
wisp_status validate_finish( validate_bodies* bodies, accuracy_run* out, wisp_error* error );
