/// Bodies in one world, alike but for their bending: rods of strands, and strips and sheets of cloth, clamped at the
/// origin along +x.
#pragma once

#include "validate_world.h"

#include "strands/strands.h"

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

/// How the cells of a sheet are cut into triangles.
typedef enum validate_mesh
{
    VALIDATE_MESH_IN_TURN,   ///< diagonals in turn
    VALIDATE_MESH_ONE_WAY,   ///< all diagonals one way
    VALIDATE_MESH_IRREGULAR, ///< diagonals in turn, and inner vertices moved at random by up to a quarter of a cell
    VALIDATE_MESH_COUNT,
} validate_mesh;

enum
{
    VALIDATE_MAX_CELLS = 128,
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
    int iterations;      ///< of a substep; 0: those that the solver needs for a strip
    int count;           ///< of bodies
    const double* loads; ///< [count] G = rho g L^3 / EI
    double tip;          ///< mass at the free end of a rod or a strip, in that of the body
    wisp_vec3 gravity;   ///< m/s^2
    double damping;      ///< 1/s
    validate_mesh mesh;  ///< of strips and sheets
    double width;        ///< of a sheet across x, along z, in lengths; 0: a strip of one square cell
    /// In lengths, > 0: a sheet stretches like a plate of this thickness that has its rigidity, so that its forces in the
    /// plane are those of a material. 0: as stiff as its solver allows
    double thickness;
    double lateral; ///< in lengths: how far the free end starts aside, along y. The clamp is straight
    bool
        is_blade; ///< stiff in its plane: rods have a flat section across y, and GJ = EI; strips are on edge along z anyhow
    /// [count][cells + 1] where rods and strips start. Rods are clamped in the direction of their first cell. Null:
    /// straight
    const validate_point* shapes;
    bool is_curled;     ///< rods have their shape without load too; else they are straight without load
    double twist_ratio; ///< GJ / EI of rods; 0: 1
    /// [count] x in lengths of a floor that faces the clamp; those with the same one in turn share it, of at most 32. Null:
    /// none
    const double* floors;
    double friction; ///< mu of the floors at the start
} validate_def;

typedef struct validate_bodies
{
    validate_def def;
    validate_world world;
    uint32_t masks[VALIDATE_MAX_BODIES]; // of the floors
} validate_bodies;

/// An empty world for bodies of another kind, which are added by their cases.
/// @param out to be released, also after a failure
wisp_status validate_open( const validate_def* def, validate_bodies* out, wisp_error* error );
/// Add strands as a body, `strand_count` of them with cells + 1 vertices each.
wisp_status validate_add_strands( validate_bodies* bodies, int strand_count, const wisp_vec3* points,
                                  const wisp_strand_dynamics_def* dynamics, wisp_error* error );
/// @param out to be released, also after a failure
wisp_status validate_create( const validate_def* def, validate_bodies* out, wisp_error* error );
void validate_release( validate_bodies* bodies );
/// The slowest frequency of a cantilever without weight, rad/s (Euler and Bernoulli): 3.516 sqrt( EI / m L^4 ).
double validate_frequency( double load );
/// A point of the middle line at the start, m. @param cell whose end it is, of bodies with
/// shapes @param x in lengths, of straight ones
wisp_vec3 validate_start_of( const validate_def* def, int body, int cell, double x );
/// How far aside the free ends start, m.
double validate_start( const validate_def* def );
/// Change the direction of gravity. For rods. @param gravity m/s^2
wisp_status validate_turn_gravity( validate_bodies* bodies, wisp_vec3 gravity, wisp_error* error );
/// Change the friction of each body with its floor. @param mu [count]
wisp_status validate_set_friction( validate_bodies* bodies, const double* mu, wisp_error* error );
/// Make steps of 1/60 s, whose times are kept.
wisp_status validate_step( validate_bodies* bodies, int steps, accuracy_run* out, wisp_error* error );
/// Make steps for a time. @see validate_steps
wisp_status validate_step_for( validate_bodies* bodies, double seconds, accuracy_run* out, wisp_error* error );
/// Change the damping of all sheets, 1/s.
wisp_status validate_damp( validate_bodies* bodies, double damping, wisp_error* error );
/// The free end of a body, m, in the middle of its width.
wisp_status validate_tip( validate_bodies* bodies, int body, wisp_vec3* out, wisp_error* error );
/// How far a body is aside, along y: the root mean square over its points, m.
wisp_status validate_aside( validate_bodies* bodies, int body, double* out, wisp_error* error );
/// @see validate_world_finish
wisp_status validate_finish( validate_bodies* bodies, accuracy_run* out, wisp_error* error );
