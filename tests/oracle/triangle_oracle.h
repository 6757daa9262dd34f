/// Triangle cloth in plain double precision: particles joined by the edges and diagonals of a triangle mesh, moved by
/// one linear solve per substep, contact inside the solver.
///
/// Equation numbers are those of Noh and Jung; docs/methods.md describes how open points are resolved, and its
/// sections on the linear system, conjugate gradients and contact are functions here. SI units. Nothing is optimised:
/// sums run over a list of links, each of them once.
#pragma once

#include "double3.h"
#include "plate_oracle.h"
#include "wisp/base.h"

#include <stdbool.h>

// ---- switches ----

typedef enum triangle_oracle_weights
{
    TRIANGLE_ORACLE_WEIGHTS_EFFECTIVE, ///< rows divided by w_i: symmetric forces, masses m |N| / max |N| (default)
    TRIANGLE_ORACLE_WEIGHTS_NONE,      ///< 1
} triangle_oracle_weights;

typedef enum triangle_oracle_stiffness
{
    TRIANGLE_ORACLE_STIFFNESS_LINK,     ///< all links alike (default)
    TRIANGLE_ORACLE_STIFFNESS_MATERIAL, ///< a link is weighted by its length and area; only with the mesh's own links
} triangle_oracle_stiffness;

typedef enum triangle_oracle_jacobian
{
    TRIANGLE_ORACLE_JACOBIAN_DROPPED, ///< (13) without its negative second term (default)
    TRIANGLE_ORACLE_JACOBIAN_FULL,    ///< (13) whole
} triangle_oracle_jacobian;

typedef enum triangle_oracle_integrator
{
    TRIANGLE_ORACLE_EULER, ///< (18) (default)
    TRIANGLE_ORACLE_BDF2,  ///< from the last two substeps, whose lengths may differ; the first is Euler's
} triangle_oracle_integrator;

typedef struct triangle_oracle_params
{
    triangle_oracle_weights weights;
    triangle_oracle_stiffness stiffness;
    triangle_oracle_jacobian jacobian;
    triangle_oracle_integrator integrator;

    double stretch_stiffness;     ///< k_s, N/m, default 200
    double bend_stiffness;        ///< k_b, N m^2, default 1e-6: not with `sheet`
    double bend_rigidity;         ///< D, N m, default 5e-6: with `sheet`
    double compression_stiffness; ///< c_b, N/m, default 0: as stretch
    double damping;               ///< k_d of a link, N s/m, default 0.02: of all relative velocity (14)
    double drag;                  ///< 1/s, against the world at rest: v <- v / (1 + drag h) before gravity; default 0
    double3 gravity;              ///< m/s^2, default -9.81 along y

    int newton_iterations;     ///< linear solves per substep, default 1
    double tolerance;          ///< of conjugate gradients, default 1e-12
    int max_iterations;        ///< default 0: three per vertex, at least 100
    bool dense;                ///< elimination in place of conjugate gradients, default false
    bool speculative;          ///< contact: a vertex that would enter a body lands; default true
    double release_hysteresis; ///< times m |g| h: a smaller pull does not let go; default 1e-4
} triangle_oracle_params;

triangle_oracle_params triangle_oracle_default_params( void );

// ---- the arc: (9) to (13) without units, y = r / L ----

/// f_b L^2 / k_b of (11): -12 where the arc is straight, -4 pi^2 where its ends meet.
double triangle_oracle_arc_load( double y );
/// df_b/dr L^3 / k_b: 7.2 and 12 pi^2 there.
double triangle_oracle_arc_slope( double y );
/// E_b L / k_b of (9): its derivative by y is the load.
double triangle_oracle_arc_energy( double y );

// ---- links ----

typedef struct triangle_oracle_link
{
    int i, j; ///< i < j in the mesh's own links
    bool bends;
    double length;  ///< m, at rest
    double stretch; ///< N/m, k; of a bending link 0
    double bend;    ///< N m^2, k_b; of a stretching link 0
    double area;    ///< m^2, of the triangles at it
    double ramp;    ///< N/m, c
    double damping; ///< N s/m
    double scale;   ///< of all its forces, 1
} triangle_oracle_link;

/// A link at the positions of its ends. All values are 0 when they coincide: without a direction it gives no force,
/// not even damping.
typedef struct triangle_oracle_term
{
    double3 direction; ///< d from i to j
    double length;     ///< r, m
    double force;      ///< N, on i along d
    double k1, k2;     ///< N/m, df_i/dx_j = k1 d d' + k2 (1 - d d')
} triangle_oracle_term;

// ---- bodies ----

/// Contact input of a vertex from a body, at the start of a substep.
typedef struct triangle_oracle_touch
{
    int body;           ///< a stable identifier, not 0
    double3 normal;     ///< unit, out of the body
    double gap;         ///< m, signed distance from the surface
    double3 motion;     ///< m/s, of the surface
    double margin;      ///< m
    double still, slip; ///< friction, mu_s and mu_k
    double recovery;    ///< m/s, limit of depenetration
} triangle_oracle_touch;

typedef enum triangle_oracle_shape
{
    TRIANGLE_ORACLE_PLANE,
    TRIANGLE_ORACLE_SPHERE,
    TRIANGLE_ORACLE_GIVEN, ///< `touch` fills the fields that it overrides; false: too far
} triangle_oracle_shape;

typedef struct triangle_oracle_body
{
    triangle_oracle_shape shape;
    double3 place;  ///< a point of the plane, or the centre
    double3 normal; ///< unit, of the plane
    double radius;
    double3 velocity;
    double margin, still, slip, recovery;
    bool ( *touch )( void* user, int vertex, double3 x, triangle_oracle_touch* touch );
    void* user;
} triangle_oracle_body;

typedef struct triangle_oracle_bodies
{
    int count;
    const triangle_oracle_body* body; ///< at the start of the substep; body k has the identifier k + 1
} triangle_oracle_bodies;

// ---- contact ----

typedef enum triangle_oracle_contact_state
{
    TRIANGLE_ORACLE_FREE,
    TRIANGLE_ORACLE_STICKING,
    TRIANGLE_ORACLE_SLIDING,
    TRIANGLE_ORACLE_LANDING,
} triangle_oracle_contact_state;

enum
{
    TRIANGLE_ORACLE_TOUCHES = 2,
};

/// The contacts of a vertex in the last substep.
typedef struct triangle_oracle_contact
{
    triangle_oracle_contact_state state;
    int count;                                            ///< number of held and landing contacts
    triangle_oracle_touch touch[TRIANGLE_ORACLE_TOUCHES]; ///< their input, unchanged
    bool lands[TRIANGLE_ORACLE_TOUCHES];
    bool pulls[TRIANGLE_ORACLE_TOUCHES]; ///< the body would have had to pull: released next, unless it is leaving
    double slack;                        ///< N s, a pull below this is ignored
    double normal_impulse[TRIANGLE_ORACLE_TOUCHES]; ///< N s, in units of the row; times w_i: physical
} triangle_oracle_contact;

// ---- the cloth ----

typedef struct triangle_oracle_def
{
    int count;
    const double3* points; ///< at rest, also the start positions
    int triangle_count;
    const int* triangles;     ///< [triangle_count][3]
    const double* masses;     ///< [count] kg, > 0
    const int* stretch_pairs; ///< [stretch_pair_count][2]; null: the mesh's edges
    const int* bend_pairs; ///< [bend_pair_count][2]; null: the mesh's diagonals, or none if there are stretch pairs
    int stretch_pair_count, bend_pair_count;
} triangle_oracle_def;

typedef struct triangle_oracle_matrix
{
    double m[3][3];
} triangle_oracle_matrix;

typedef struct triangle_oracle
{
    triangle_oracle_params params;
    int count;

    int link_count, stretch_count, bend_count;
    triangle_oracle_link* link; ///< stretching ones first; the mesh's own in ascending order of (i, j)
    /// Bending of a material, of its rest shape, which is flat; its edges bear pressure as arcs in place of the diagonals.
    plate_oracle plate;
    double3* rest;
    int* triangles;
    int triangle_count; ///< 0: no plate
    int max_neighbours; ///< max |N|
    int* neighbours;    ///< |N_i|
    double* weight;     ///< w_i of (1); 1 for a vertex without neighbours
    double* true_mass;  ///< kg
    double* mass;       ///< kg, of its row: m / w_i with weights `effective`

    double3 *x, *v;
    double3 *x_before, *v_before; ///< one substep earlier
    double h_before;              ///< s, length of the last substep; 0 before the first
    bool* pinned;
    double3* target; ///< where a pinned vertex is at the end of the next substep

    triangle_oracle_matrix* freedom; ///< S_i of the last substep
    double3* prescribed;             ///< m/s, velocity at its end of which 1 - S_i counts
    double3* push;                   ///< N s, sliding friction, in units of the row
    double3* change;                 ///< dv of the last solve
    double3* impulse;                ///< J of the last solve, N s, in units of the row
    triangle_oracle_contact* contact;

    triangle_oracle_term* term; ///< links where they were assembled last
    double s;                   ///< s, what stood for h in that

    int iterations;         ///< of the last substep, all repeats
    double residual;        ///< of the last solve, over that of standing still
    bool negative;          ///< a solve of the last substep stopped at negative curvature
    bool limited;           ///< a solve of the last substep stopped at the limit of iterations
    double newton_residual; ///< m/s, largest |v - v^ - s f(x, v) / m| of a free vertex
    int coincident;         ///< links without a direction where they were assembled last
    int sticking, sliding, landing, released;
} triangle_oracle;

/// A third of its triangles each, and at least a millionth of the mean. @param density kg/m^2
void triangle_oracle_lump( const triangle_oracle_def* def, double density, double* masses );

triangle_oracle triangle_oracle_create( const triangle_oracle_def* def, const triangle_oracle_params* params );
void triangle_oracle_destroy( triangle_oracle* cloth );

/// Hold a vertex where it is; move its `target` for elsewhere.
void triangle_oracle_pin( triangle_oracle* cloth, int vertex );

/// (5) to (13) of one link with its stiffness, scale included.
triangle_oracle_term triangle_oracle_term_at( const triangle_oracle* cloth, int link, const double3* x );
/// Sums of stretching and bending forces, without gravity and damping. [count]
void triangle_oracle_forces( const triangle_oracle* cloth, const double3* x, double3* force );
/// (14) with directions from x. [count]
void triangle_oracle_damping_forces( const triangle_oracle* cloth, const double3* x, const double3* v,
                                     double3* force );
/// The right side of (3) as printed, every force times its row's w_i, without gravity: m_i a_i, with weights
/// `effective`.
void triangle_oracle_printed( const triangle_oracle* cloth, const double3* x, const double3* v, double3* force );

double triangle_oracle_stretch_energy( const triangle_oracle* cloth, const double3* x );
double triangle_oracle_bend_energy( const triangle_oracle* cloth, const double3* x );
/// Sum of the rows' m v.
double3 triangle_oracle_momentum( const triangle_oracle* cloth );

// ---- the solve ----

/// Take links where x has them, for A = M - s D - s^2 K.
void triangle_oracle_assemble( triangle_oracle* cloth, const double3* x, double s );
/// A dv = b where `freedom` allows it, dv = z elsewhere; J, iterations and residual are in the cloth.
/// @param z [count], of which 1 - S counts
/// @param dv [count], in: where to start, what `freedom` allows of it counts
void triangle_oracle_solve( triangle_oracle* cloth, const double3* b, const double3* z, double3* dv );
/// The same by elimination.
void triangle_oracle_solve_dense( triangle_oracle* cloth, const double3* b, const double3* z, double3* dv );

/// One substep. @param bodies may be null
void triangle_oracle_step( triangle_oracle* cloth, double h, const triangle_oracle_bodies* bodies );

/// What contact does before a substep's first solve, with its x^ and v^, and after its last one.
void triangle_oracle_contact_begin( triangle_oracle* cloth, double h, double s, const double3* x_hat,
                                    const double3* v_hat, const triangle_oracle_bodies* bodies );
void triangle_oracle_contact_end( triangle_oracle* cloth, double h );
/// After a substep of BDF2: what is held has moved with its surface for ever, along the normals, and across them
/// too if it sticks. Without that an impact would still be in v^ a substep later, and look like a pull of the
/// body.
void triangle_oracle_contact_settle( triangle_oracle* cloth, double h );
