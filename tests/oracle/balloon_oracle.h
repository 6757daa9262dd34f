/// The balloon in plain double precision: the method's equations one by one, the closed forms that check them, and a
/// body that steps through them in the order of the specification.
///
/// Equation numbers and switch names are those of the balloon paper (balloons by PBD and gas law, a Korean conference
/// paper); docs/methods.md has the resolutions of what it leaves open or misprints. SI units. Nothing here is optimised.
/// Eq. 3-8 are in constraint_oracle.h.
#pragma once

#include "balloon_meshes.h"
#include "constraint_oracle.h"
#include "wisp/base.h"

// ---- constants of Eq. 9 and 10 ----

#define BALLOON_ORACLE_GAS_CONSTANT 8.314462618 ///< R, J/(mol K)
#define BALLOON_ORACLE_HELIUM 4.0026e-3         ///< M_He, kg/mol
#define BALLOON_ORACLE_AIR 28.9647e-3           ///< M_air, kg/mol; gives the 1.20410 kg/m^3 of the specification

// ---- switches ----

/// How the volume constraint is projected.
typedef enum balloon_oracle_volume
{
    BALLOON_ORACLE_VOLUME_XPBD, ///< compliance V_0 / P_atm, edges with compliance 1 / k_edge (default)
    BALLOON_ORACLE_VOLUME_PBD,  ///< as printed: stiffness in (0, 1] for volume and edges
} balloon_oracle_volume;

/// Where the pressure is read. The first three are equal at true equilibrium.
typedef enum balloon_oracle_reading
{
    BALLOON_ORACLE_PRESSURE_VIRIAL,     ///< from the tensions of the skin, clamped at 0 (default)
    BALLOON_ORACLE_PRESSURE_GAS,        ///< P_atm V_0 / V, as printed
    BALLOON_ORACLE_PRESSURE_MULTIPLIER, ///< lambda_V / dt^2 of the last substep
    BALLOON_ORACLE_PRESSURE_ADDED,      ///< V_added R T / V: the added volume is the amount in mol, as printed
} balloon_oracle_reading;

/// How the angle between motion and normal weights the drag.
typedef enum balloon_oracle_drag
{
    BALLOON_ORACLE_DRAG_MAX,    ///< against v, weighted with max( 0, v.n ): the textbook drag (default)
    BALLOON_ORACLE_DRAG_SIGNED, ///< against v, weighted with v.n, as printed: 0 on a closed rigid body
    BALLOON_ORACLE_DRAG_ABS,    ///< against v, weighted with |v.n|: twice the frontal area
    BALLOON_ORACLE_DRAG_NORMAL, ///< along n, weighted with v.n: 4/3 pi r^2 on a sphere
} balloon_oracle_drag;

/// Which pressure is the constant of Eq. 12.
typedef enum balloon_oracle_outlet
{
    BALLOON_ORACLE_OUTLET_PRESENT, ///< the present one: the gas flows from inside to the outlet (default)
    BALLOON_ORACLE_OUTLET_START,   ///< that of the jet's start, as printed: the jet speeds up as the balloon empties
} balloon_oracle_outlet;

/// How the torque turns the body.
typedef enum balloon_oracle_spin
{
    BALLOON_ORACLE_SPIN_KICK,    ///< D_omega x r is added to the velocities (default)
    BALLOON_ORACLE_SPIN_PRINTED, ///< omega accumulates, R(dq) of one step turns the positions, velocities stay
} balloon_oracle_spin;

// ---- rigid motion: matrix and quaternion ----

typedef struct balloon_oracle_matrix
{
    double m[3][3]; ///< rows first
} balloon_oracle_matrix;

typedef struct balloon_oracle_quaternion
{
    double w, x, y, z;
} balloon_oracle_quaternion;

/// Eq. 15: q + dt/2 (0, omega) q, normalised; omega in world axes, rad/s.
balloon_oracle_quaternion balloon_oracle_turn( balloon_oracle_quaternion q, double3 omega, double dt );

/// q v q*, q of unit length
double3 balloon_oracle_rotate( balloon_oracle_quaternion q, double3 v );

/// The angle of the rotation, rad, in [0, pi].
double balloon_oracle_angle( balloon_oracle_quaternion q );

// ---- Eq. 1-2: motion of one vertex ----

/// Eq. 1: v <- v + dt w f, then the predicted position x + dt v.
double3 balloon_oracle_predict( double3 x, double3* v, double w, double3 force, double dt );

/// Eq. 2: (p - x) / dt.
double3 balloon_oracle_velocity( double3 x, double3 p, double dt );

// ---- geometry of the skin ----

/// Vertex masses from an areal density, kg: a third of the mass of every incident triangle.
void balloon_oracle_masses( const double3* x, int vertex_count, const int* triangles, int triangle_count,
                            double areal_density, double* mass );

/// Unit vertex normals weighted by area, and A_i, a third of the incident areas, m^2. A triangle without area adds
/// nothing; a normal whose sum cancels (below 1e-12 of the incident areas) is zero.
/// @return how many normals are zero
int balloon_oracle_skin( const double3* x, int vertex_count, const int* triangles, int triangle_count,
                         double3* normal, double* area );

/// c = sum m x / sum m.
double3 balloon_oracle_centre( const double3* x, const double* mass, int vertex_count );

/// Eq. 16-17: I = sum m (|r|^2 Id - r r^T), r = x - c, world axes, kg m^2.
balloon_oracle_matrix balloon_oracle_inertia( const double3* x, const double* mass, int vertex_count,
                                              double3 centre );

/// sum m v.
double3 balloon_oracle_momentum( const double3* v, const double* mass, int vertex_count );

/// L = sum m (x - c) x v.
double3 balloon_oracle_angular_momentum( const double3* x, const double3* v, const double* mass, int vertex_count,
                                         double3 centre );

// ---- open meshes ----

/// An open skin whose holes are closed by fans (`allow_open`). V is the volume of the closed mesh, as a function of
/// the skin's own vertices. A hub is the mean of its border, so a border vertex also receives its fraction of the
/// hub's gradient.
typedef struct balloon_oracle_caps
{
    int vertex_count, triangle_count; ///< of the closed mesh
    int hub_count;
    int* triangles;    ///< [3 * triangle_count], the skin's first
    int* hub;          ///< [skin's vertices], the vertex of the closed mesh, -1 inside the skin
    int* size;         ///< [hub_count] vertices of its border
    double3* x;        ///< scratch [vertex_count]
    double3* gradient; ///< scratch [vertex_count]
} balloon_oracle_caps;

/// @return false when a border is not a set of simple loops, or when memory runs out; then nothing needs to be destroyed
bool balloon_oracle_make_caps( const balloon_mesh* mesh, balloon_oracle_caps* out );
void balloon_oracle_destroy_caps( balloon_oracle_caps* caps );

/// V of the skin with its fans, m^3.
double balloon_oracle_capped_volume( balloon_oracle_caps* caps, const double3* p );

/// grad_i V at the skin's vertices, m^2, with the chain rule through the hubs, so that the gradients sum to 0.
void balloon_oracle_capped_gradient( balloon_oracle_caps* caps, const double3* p, double3* gradient );

/// pbd (stiffness in (0, 1], alpha 0) or xpbd (stiffness 1) of C = V - target.
/// @param lambda grows by Dlambda; without a compliance it has no effect on the projection
/// @param gradient scratch [skin's vertices], receives grad C
void balloon_oracle_project_capped( balloon_oracle_caps* caps, double3* p, const double* w, double target,
                                    double stiffness, double alpha, double* lambda, double3* gradient,
                                    constraint_oracle_skips* skips );

// ---- Eq. 9: gas ----

/// rho = P M / (R T), kg/m^3.
double balloon_oracle_density( double pressure, double molar_mass, double temperature );

/// The balloon paper taken literally, N = V_added in mol: P = V_added R T / V, Pa.
double balloon_oracle_gas_pressure_printed( double added_volume, double volume, double temperature );

/// One distance constraint of the skin, in the order in which it is projected.
typedef struct balloon_oracle_link
{
    int a, b;
    double rest;   ///< m
    double lambda; ///< of the present substep
} balloon_oracle_link;

/// sum_e T_e l_e, J, with T_e = k_edge (l_e - d_e).
double balloon_oracle_virial( const double3* x, const balloon_oracle_link* links, int link_count,
                              double edge_stiffness );

// ---- Eq. 10-11: air around the skin ----

/// Eq. 10 resolved: -g V (rho_air - rho_He), N.
double3 balloon_oracle_buoyancy( double3 gravity, double volume, double air_density, double gas_density );

/// Eq. 11 resolved: the drag on one vertex, N.
/// @param coefficient 1/2 rho_air C_d A_i, kg/m
/// @param limit_rate dt w: the force is divided by 1 + c |v| dt w, so that an explicit step never reverses v; 0
///        disables the limit. A thrust (c < 0, only with `signed`) has the same limit.
double3 balloon_oracle_drag_force( balloon_oracle_drag drag, double coefficient, double3 v, double3 normal,
                                   double limit_rate );

// ---- Eq. 12: outlet ----

/// v_e = sqrt( 2 max( 0, P - P_atm ) / rho_He ), m/s.
double balloon_oracle_outlet_speed( double gauge_pressure, double gas_density );

/// Eq. 12 with a constant frozen at the start, for comparison: sqrt( 2 max( 0, P_start - P ) / rho ), which grows as
/// the balloon empties.
double balloon_oracle_outlet_speed_printed( double start_pressure, double pressure, double gas_density );

/// mdot = rho_He A_h v_e, kg/s.
double balloon_oracle_mass_flow( double gas_density, double outlet_area, double speed );

/// F = -mdot v_e n_h, N.
double3 balloon_oracle_reaction( double mass_flow, double speed, double3 outlet_normal );

/// Hysteresis of the outlet: a running jet ends at P <= P_atm (1 + close), a resting one starts above P_atm (1 +
/// open).
bool balloon_oracle_jet_runs( bool running, double gauge_pressure, double atmosphere, double close, double open );

// ---- Eq. 13-14: torque ----

/// Eq. 13: (outlet - centre) x F, N m.
double3 balloon_oracle_torque( double3 outlet, double3 centre, double3 force );

/// Eq. 14: the increment dt I^-1 tau, rad/s.
double3 balloon_oracle_spin_increment( const balloon_oracle_matrix* inertia, double3 torque, double dt );

/// v_i += D_omega x (x_i - c) for every vertex with w > 0.
void balloon_oracle_spin_kick( const double3* x, double3* v, const double* w, int vertex_count, double3 centre,
                               double3 increment );

// ---- closed forms ----

/// The same, exact for a mesh whose every length is scaled by s: sum(k l^2) (s - 1) / (3 V_rest s^2), Pa.
double balloon_oracle_true_scaled_pressure( double sum_k_length_squared, double rest_volume, double scale );

/// Moment of inertia of a thin spherical shell: 2/3 M r^2.
double balloon_oracle_true_shell_inertia( double mass, double radius );

// ---- the body ----

/// All parameters except the shape. Start from balloon_oracle_default_options(). May be changed between steps.
typedef struct balloon_oracle_options
{
    double dt;      ///< s, one frame, default 1/60
    int substeps;   ///< default 10
    int iterations; ///< default 2
    balloon_oracle_volume volume;
    balloon_oracle_reading pressure;
    balloon_oracle_drag drag;
    balloon_oracle_outlet outlet;
    balloon_oracle_spin spin;
    bool use_gravity, use_buoyancy, use_drag, use_jet; ///< the four external forces, default on
    bool limit_drag;                                   ///< default on
    bool keep_angular_momentum;                        ///< extension, default off; acts on a body without pins
    bool update_per_frame;                             ///< read P and jet only in the first substep, default off
    double3 gravity;                                   ///< m/s^2, default (0, -9.8, 0)
    double atmosphere;                                 ///< Pa, default 101325
    double temperature;                                ///< K, default 293.15
    double gas_molar_mass, air_molar_mass;             ///< kg/mol, default helium and air
    double drag_coefficient;                           ///< default 0.5
    double outlet_area;                                ///< m^2, default 1e-4
    double structural_k;                               ///< pbd, in (0, 1], default 0.9, applied in every iteration
    double bend_k;                                     ///< pbd, default 0.1
    double volume_k;                                   ///< pbd, default 1
    double structural_stiffness;                       ///< N/m, k_edge, default 2000; also the virial's
    double bend_stiffness;                             ///< N/m, k_edge of bend pairs, default 20
    double velocity_decay;                             ///< 1/s, v *= exp( -decay h ) after (2), default 0
    double close_at, open_at;                          ///< fractions of P_atm, defaults 1e-4 and 5e-4
    double min_volume; ///< V_min / V_rest, default 1: the guard V_0 >= V_rest; with less the final shape crumples
    double inflow;     ///< Q, m^3/s at atmospheric pressure, default 0
    bool outlet_open;  ///< the user's valve, default shut
} balloon_oracle_options;

balloon_oracle_options balloon_oracle_default_options( void );

/// The shape. Copied; need not outlive the call.
typedef struct balloon_oracle_def
{
    int vertex_count, triangle_count, structural_count, bend_count;
    const double3* positions; ///< [vertex_count], the rest shape and the first shape, m
    const double* mass;       ///< [vertex_count], skin only, > 0, kg
    const bool* pinned;       ///< [vertex_count], or null
    const int* triangles;     ///< [3 * triangle_count], one closed shell
    bool allow_open;          ///< the shell may have holes; fans close them for V
    const int* structural;    ///< [2 * structural_count], projected in this order
    const int* bend;          ///< [2 * bend_count], opposite vertices of interior edges, projected in this order
    const int* outlet;        ///< [outlet_count] vertices of the outlet: the jet acts at their mean, along the sum of
                              ///< their area vectors
    int outlet_count;         ///< 0: no outlet
} balloon_oracle_def;

/// The external forces of the last substep, summed over the body, N (Fig. 4).
typedef struct balloon_oracle_forces
{
    double3 gravity, buoyancy, drag, jet;
} balloon_oracle_forces;

/// Counts of numerical failures and limits reached, since creation.
typedef struct balloon_oracle_counters
{
    constraint_oracle_skips skips; ///< of all projections
    int zero_normals;              ///< vertices whose normal cancelled, summed over substeps
    int clamped_volumes;           ///< substeps with V below 1e-3 V_rest
    int silent_outlets;            ///< substeps whose open outlet had no normal
    int fast_outlets;              ///< substeps beyond 300 m/s, above which incompressible Bernoulli is invalid
    int jet_starts;                ///< how often the jet started: shows chatter
} balloon_oracle_counters;

/// The state. Fields may be read at any time, and x, v, gas_volume written between steps.
typedef struct balloon_oracle
{
    balloon_oracle_options options;
    int vertex_count, triangle_count, structural_count, bend_count, outlet_count;
    double3 *x, *p, *v, *force;
    double3* predicted;         ///< by Eq. 1, before projections
    double3 *normal, *gradient; ///< unit vertex normals at the start of the substep | scratch of the volume
    double *mass, *w, *area;
    int *triangles, *outlet;
    balloon_oracle_caps caps; ///< of an open skin, else empty
    balloon_oracle_link *structural, *bend;
    double total_mass;
    double rest_volume;   ///< V_rest
    double gas_volume;    ///< V_0: volume of the gas at atmospheric pressure, target of the constraint
    double volume;        ///< V of x at the start of the last substep, clamped as Eq. 9 uses it
    double volume_lambda; ///< of the last substep
    double h;             ///< length of the last substep, s; 0 before the first
    double gauge;         ///< P - P_atm in use, Pa
    double mass_flow;     ///< mdot in use, kg/s
    double outlet_speed;  ///< v_e in use, m/s
    double start_gauge;   ///< P - P_atm when the jet last started, Pa
    bool jet_on;
    double3 outlet_normal, outlet_place;
    double3 centre;              ///< c at the start of the last substep
    double3 omega;               ///< rad/s: I^-1 L with `kick`, the accumulated one with `printed`
    balloon_oracle_quaternion q; ///< diagnostic orientation
    balloon_oracle_forces forces;
    double gas_lost;     ///< kg, integral of mdot
    double3 jet_impulse; ///< N s, integral of the reaction
    double time;         ///< s
    balloon_oracle_counters counters;
} balloon_oracle;

/// Make a body at rest with V_0 = V_rest.
/// @param error receives a message; may be null
/// @return WISP_BAD_INPUT: a border is no simple loop; WISP_NO_MEMORY; then nothing needs to be destroyed
wisp_status balloon_oracle_create( const balloon_oracle_def* def, const balloon_oracle_options* options,
                                   balloon_oracle* out, wisp_error* error );

/// Make the same from a mesh: masses from an areal density (kg/m^2), every edge structural, every pair across an edge
/// a bend.
wisp_status balloon_oracle_create_from_mesh( const balloon_mesh* mesh, double areal_density, int outlet_vertex,
                                             const balloon_oracle_options* options, balloon_oracle* out,
                                             wisp_error* error );

void balloon_oracle_destroy( balloon_oracle* balloon );

/// V of the present x, m^3, not clamped.
double balloon_oracle_present_volume( const balloon_oracle* balloon );

/// Advance one frame: section 4, `substeps` times. Each substep computes geometry; inflow; pressure, hysteresis,
/// mdot; forces; spin; (1); iterations of all structural links, all bends and one volume; the turn that keeps L; (2) and decay; diagnostics.
/// The outlet takes no more than V_0 has above its guard, so impulse and mass balance to rounding.
void balloon_oracle_step( balloon_oracle* balloon );
