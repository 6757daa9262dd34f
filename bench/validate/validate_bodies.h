/// What the cases of rods, strips and sheets share: settings, worlds of bodies, materials, supports, and the elastica.
#pragma once

#include "accuracy/accuracy.h"
#include "accuracy/scene_tools.h"
#include "bench_world.h"
#include "mesh.h"
#include "validate/validate.h"

#include "cloth/cloth.h"
#include "implicit_cloth/implicit_cloth.h"
#include "strands/strands.h"
#include "wisp/module/definition.h"
#include "wisp/wisp.h"

#include <stdbool.h>

// ---- settings ----

// Settings of a case: solver x cells x substeps, in series of cells and of substeps.

typedef struct validate_setting
{
    int solver, cells, substeps; ///< solver: a number of the case
} validate_setting;

/// The settings of a scene, in its order. The context of every case begins with them, and its own bytes follow.
typedef struct validate_settings
{
    const validate_case* of;
    bool is_quick;
    double seconds; ///< for all runs
    validate_setting list[VALIDATE_MAX_SETTINGS];
} validate_settings;

/// The own bytes of a context.
static inline void* validate_own( void* context )
{
    return (validate_settings*)context + 1;
}

/// Add a series in cells, with the same substeps. @param cell what 1 / cells is: "cell / L" @param cells up to a 0
void validate_put_cells( accuracy_scene* out, int solver, const char* name, const char* cell, const int* cells,
                         int substeps );
/// Add a series in substeps of 1/60 s, with the same cells. @param substeps up to a 0
void validate_put_substeps( accuracy_scene* out, int solver, const char* name, int cells, const int* substeps );

// ---- a world of bodies ----

// A world of several bodies that a case steps, times and measures together.

enum
{
    VALIDATE_MAX_BODIES = 64,
};

#define VALIDATE_STEP ( 1.0f / 60.0f ) // s

typedef struct validate_body
{
    wisp_entity entity;
    wisp_component points;
    int vertex_count;
} validate_body;

typedef struct validate_world
{
    wisp_world* world;
    validate_body bodies[VALIDATE_MAX_BODIES];
    int count, substeps, steps, halted_at;
    bool is_observed;  ///< error and measures are requested
    accuracy_run* run; ///< which keeps what a step takes
} validate_world;

/// Steps of 1/60 s that a time takes, the last of which may end after it.
int validate_steps( double seconds );
/// @param out with `run`; to be released, also after a failure
wisp_status validate_world_create( const bench_world_def* def, validate_world* out, wisp_error* error );
void validate_world_release( validate_world* world );
/// Count an entity of the world among its bodies, and request its points.
wisp_status validate_world_add( validate_world* world, wisp_entity entity, wisp_component points, int vertex_count );
/// Make steps of 1/60 s, whose times are kept.
wisp_status validate_world_step( validate_world* world, int steps, wisp_error* error );
/// Read the points of a body, m, in the user's order, valid until the next step.
wisp_status validate_world_points( validate_world* world, int body, const wisp_vec3** out, wisp_error* error );
/// Request the motion of a body if the world is observed.
wisp_status validate_world_watch( validate_world* world, int body, wisp_error* error );
/// Read the motion of a body for which it was requested.
wisp_status validate_world_motion( validate_world* world, int body, wisp_motion_stats* out, wisp_error* error );
/// Hash the points of all bodies into that of the run, which may have had other worlds before, and keep what a step is
/// made of.
wisp_status validate_world_finish( validate_world* world, wisp_error* error );

// ---- rods and sheets, clamped ----

// Bodies in one world, alike but for their bending: rods of strands, and strips and sheets of cloth, clamped at the
// origin along +x.

/// What computes the bending.
typedef enum validate_solver
{
    VALIDATE_ROD,       ///< strands, bending rod
    VALIDATE_DIHEDRAL,  ///< cloth, bending dihedral
    VALIDATE_ISOMETRIC, ///< cloth, bending isometric
    VALIDATE_IMPLICIT,  ///< implicit cloth of a material
    VALIDATE_SOLVER_COUNT,
    VALIDATE_ALL_SOLVERS = ( 1 << VALIDATE_SOLVER_COUNT ) - 1, ///< in a grid
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
    int method;                          // the solver of the setting, by the numbers of the case
    void* own;                           // bytes of the case
    uint32_t masks[VALIDATE_MAX_BODIES]; // of the floors
} validate_bodies;

/// An empty world for bodies of another kind, which are added by their cases. To be ended, also after a failure.
wisp_status validate_open( validate_bodies* bodies, wisp_error* error );
/// Add strands as a body, `strand_count` of them with cells + 1 vertices each.
wisp_status validate_add_strands( validate_bodies* bodies, int strand_count, const wisp_vec3* points,
                                  const wisp_strand_dynamics_def* dynamics, wisp_error* error );
/// The bodies of their definition. To be ended, also after a failure.
wisp_status validate_create( validate_bodies* bodies, wisp_error* error );
/// The slowest frequency of a cantilever without weight, rad/s (Euler and Bernoulli): 3.516 sqrt( EI / m L^4 ).
double validate_frequency( double load );
/// How far aside the free ends start, m.
double validate_start( const validate_def* def );
/// Change the direction of gravity. For rods. @param gravity m/s^2
wisp_status validate_turn_gravity( validate_bodies* bodies, wisp_vec3 gravity, wisp_error* error );
/// Change the friction of each body with its floor. @param mu [count]
wisp_status validate_set_friction( validate_bodies* bodies, const double* mu, wisp_error* error );
/// Make steps of 1/60 s, whose times are kept.
wisp_status validate_step( validate_bodies* bodies, int steps, wisp_error* error );
/// Make steps for a time. @see validate_steps
wisp_status validate_step_for( validate_bodies* bodies, double seconds, wisp_error* error );
/// Change the damping of all sheets, 1/s.
wisp_status validate_damp( validate_bodies* bodies, double damping, wisp_error* error );
/// The free end of a body, m, in the middle of its width.
wisp_status validate_tip( validate_bodies* bodies, int body, wisp_vec3* out, wisp_error* error );
/// How far a body is aside, along y: the root mean square over its points, m.
wisp_status validate_aside( validate_bodies* bodies, int body, double* out, wisp_error* error );
/// Finish a run that went well so far, and release its bodies. @see validate_world_finish @return status, or that of the end
wisp_status validate_end( wisp_status status, validate_bodies* bodies, wisp_error* error );

// ---- sheets with supports, friction or air ----

// Sheets of cloth and strands in one world, by every solver, with supports, friction or air.

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

/// A world of sheets for the setting of bodies, with a ground of friction 1 if sheets collide. To be ended, also after a failure.
wisp_status sheet_world_create( validate_bodies* bodies, bool has_ground, wisp_error* error );
/// Add a sheet to the bodies of a world.
/// Its motion is measured if the world is observed.
wisp_status sheet_add( validate_world* world, const sheet_def* def, wisp_error* error );

// ---- ladders of loads ----

// Ladders of loads from 0.7 times a critical one to 1.3, each on a body of its own: which is the first that gives way?

enum
{
    VALIDATE_LADDER = 31, ///< rungs of a fine one
};

/// A load, in critical ones. @param count of rungs
double validate_rung( int i, int count );
/// Half of the distance between two loads, in percent of the critical one.
double validate_ladder_doubt( int count );
/// Measure the load at which bodies give way: between the first that does and the one before. NaN: none gives way, or
/// the first one does.
/// @param has_lost [count] by rung @param measures that load, and the critical one
/// @return their distance, in percent of the critical one. Beyond the ladder it is at least the ladder's half
double validate_measure_ladder( const bool* has_lost, int count, double critical, double measures[2] );
/// Put that distance and the two loads into the run, if it is observed.
void validate_judge_ladder( validate_bodies* bodies, const bool* has_lost, int count, double critical );

// ---- discs ----

// A round specimen of cloth, held between discs in its middle, and its shadow.

/// A ring of cloth in y = 0 between a clamp and a border, cut into cells of one size on circles. Its vertices come circle by circle, the
/// two circles of the clamp first: one cell inside it, and its edge.
/// @param cells from the clamp to the border, at most 32
/// @param turn of the mesh in cells: each circle is turned by another part of it, so that another turn is another mesh
/// @param pin_count receives the number of vertices on the two circles of the clamp
/// @return WISP_NO_MEMORY
wisp_status disc_mesh( double clamp, double border, int cells, double turn, wisp_mesh* out, int* pin_count,
                       wisp_error* error );

/// Area of the shadow under a light from above, outside of a disc about the y axis, m^2: what several layers cover counts once.
/// @param points [mesh->vertex_count] within twice `border` of the axis
/// @return below 0: no memory
double disc_shadow( const wisp_mesh* mesh, const wisp_vec3* points, double disc, double border );

// ---- the elastica ----

// The elastica in closed form: a rod clamped horizontally that bends under its own weight (Bickley 1934) and a
// weight at its free end (Bisshopp and Drucker 1945).

/// theta'' = -( G (1 - s) + P ) cos theta, theta(0) = 0, theta'(1) = 0, for a rod of length 1 that is clamped at the
/// origin along +x and hangs towards -y.
/// @param load G = weight times length^2 over EI, >= 0
/// @param tip P = weight at the free end times length^2 over EI, >= 0
/// @param count of points at equal distances along the rod, at least 2
/// @param points [count] x and y
void elastica_lay_loaded( double load, double tip, int count, double ( *points )[2] );

// ---- named fabrics ----

#define DRAPE_DISC 0.09   // m, radius of the disc
#define DRAPE_CLOTH 0.15  // m, of the specimen
#define DRAPE_SCATTER 5.0 // %, half width of the band around a measured coefficient

/// A fabric and its coefficient as others measured them.
typedef struct drape_fabric
{
    const char* name;
    double bending; ///< B, gf cm^2 / cm
    double weight;  ///< mg / cm^2
    double drape;   ///< coefficient, %
} drape_fabric;

enum
{
    DRAPE_FABRICS = 4,
};

/// Of Matsudaira, Masuda, Wada and Yokura 2015, tables 1 and 2.
extern const drape_fabric drape_fabrics[DRAPE_FABRICS];

double drape_rigidity( const drape_fabric* fabric ); ///< N m
double drape_density( const drape_fabric* fabric );  ///< kg/m^2

// ---- bowed bodies on a floor ----

enum
{
    VALIDATE_SLIP_MAX_CELLS = 32,
};

/// A start for the engine: the first cell straight, for that is how a clamp is said, the tip on the floor, and the elastica between.
/// @param height of the clamp in lengths @param shape [cells + 1]
wisp_status validate_slip_lay( double height, int cells, validate_point* shape, wisp_error* error );
