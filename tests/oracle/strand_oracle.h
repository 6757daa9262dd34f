/// Moving strands in plain double precision: one strand at a time, one function per stage of the substep. The
/// mathematics is that of modules/strands (rod_factors.c, rod_factors.c, rest_curvature.c); a function has the name of
/// the kernel that it checks.
///
/// SI units. Vertex 0 is the root; segment s runs from vertex s to vertex s + 1. A weight is an inverse mass, 0 holds
/// a vertex. A strand is a plain value: an assignment copies it. Guards against missing directions and unbounded
/// values are part of the method and are described at their function.
#pragma once

#include "double3.h"

#include <stdbool.h>

enum
{
    MAX_STRAND_ORACLE = 128, ///< vertices of a strand; strand_oracle_shape() rejects more
};

// ---- rotations ----

/// A rotation, x y z sin(a/2), cos(a/2).
typedef struct strand_oracle_quaternion
{
    double x, y, z, w;
} strand_oracle_quaternion;

/// First b, then a.
strand_oracle_quaternion strand_oracle_product( strand_oracle_quaternion a, strand_oracle_quaternion b );
double3 strand_oracle_turned( strand_oracle_quaternion q, double3 v );
/// Rotate a frame so that its z axis is along e, by the smallest rotation; e without length leaves it unchanged.
strand_oracle_quaternion strand_oracle_carried( strand_oracle_quaternion frame, double3 e );

// ---- a strand ----

typedef struct strand_oracle
{
    int count; ///< vertices
    double3 position[MAX_STRAND_ORACLE], previous[MAX_STRAND_ORACLE], velocity[MAX_STRAND_ORACLE];
    double weight[MAX_STRAND_ORACLE]; ///< 1/kg
    double mass[MAX_STRAND_ORACLE];   ///< kg, of held vertices too
    double length[MAX_STRAND_ORACLE]; ///< m, of segment s at rest, > 0
    double tension[MAX_STRAND_ORACLE];
    double max_tension[MAX_STRAND_ORACLE]; ///< N, limit for a rod; infinite from strand_oracle_shape()
    double stretch_lambda[MAX_STRAND_ORACLE], bend_lambda[MAX_STRAND_ORACLE]; ///< N s^2, of links in a substep

    double stiffness[MAX_STRAND_ORACLE];       ///< N m, EI / L_i
    double twist_stiffness[MAX_STRAND_ORACLE]; ///< N m, GJ / L_i
    strand_oracle_quaternion turn;             ///< of the root from rest
    strand_oracle_quaternion clamp;            ///< frame q_{-1} at rest; its z axis is the direction of growth
    strand_oracle_quaternion frame[MAX_STRAND_ORACLE]; ///< q_s
    double3 rest[MAX_STRAND_ORACLE];                   ///< k_i in the middle frame of vertex i
    double rest_twist[MAX_STRAND_ORACLE];              ///< rad
    bool framed;                                       ///< false: straight at rest, frames have no effect
    double factor[MAX_STRAND_ORACLE][3];               ///< 1/pivot, L(i, i-1), L(i, i-2)
    double
        held_diagonal; ///< factor of the diagonal of J W J^T, 1 from strand_oracle_shape(); 1 + 1e-5 where tips are held
    double flatness; ///< sqrt( 1 - EI / EI' ) of an elliptic section, whose x axis is across its flat side and whose
                     ///< stiffness is that of EI'; 0: circular
    /// The last vertex is the first again: vertex 0 is between the last segment and the first. Systems are solved dense.
    bool closed;
    bool guided; ///< the direction of the tip is held: frame[count - 1] is its frame, and vertex count - 1 bends
} strand_oracle;

/// Make a strand at rest in this shape: lengths, frames carried along from the clamp without twist, the clamp in the
/// direction of the first segment (of a segment without length: as strand_oracle_directions()). A segment has at
/// least a thousandth of the mean length, and at least 1e-6 m, so that t_s = e_s / l_s is defined. Masses and
/// stiffness are not set.
/// @return false when count is below 1 or above MAX_STRAND_ORACLE
bool strand_oracle_shape( strand_oracle* strand, const double3* points, int count );
/// Give each vertex half the mass of each of its segments; the root is held if `held` is set. A strand of one vertex
/// has the mass of a millimetre.
void strand_oracle_weigh( strand_oracle* strand, double line_density, bool held );
/// Hold a vertex.
void strand_oracle_pin( strand_oracle* strand, int vertex );
/// Set EI / L_i and GJ / L_i with L_i = (l_{i-1} + l_i) / 2, L_0 = l_0 / 2; vertex 0 of a hinged root and a tip
/// that is not guided have 0. dt^2 EI / (m l^3) is at most 6e4 (l the shorter segment at the vertex, m the lightest of the three
/// vertices that move), where single precision still solves; dt 0 does not limit.
void strand_oracle_stiffen( strand_oracle* strand, double bend_rigidity, double twist_rigidity, bool clamped,
                            double dt );

// ---- motion ----

/// v <- v + dt a, p <- p + dt v with the new velocity, previous = p before. A held root moves to `root` (null: it
/// stays) with the velocity of that move. Other held vertices are already at their end positions: previous = p - dt
/// v.
void strand_oracle_predict( strand_oracle* strand, const double3* root, double3 acceleration, double dt );
/// v <- v + (p - (previous + dt v)) / dt of vertices that are not held.
void strand_oracle_velocity( strand_oracle* strand, double dt );
/// v <- u + keep (v - u), u = linear + angular x (p - centre), of vertices that are not held.
void strand_oracle_damp( strand_oracle* strand, double keep, double3 linear, double3 angular, double3 centre );
/// Drag across: u the part of (wind - v) across the line from neighbour to neighbour, reach half of both segments,
/// a = drag reach |u| w dt, v <- v + a / (1 + a) u. Where that line has no length all of the wind is across.
/// @param drag kg/m^2, 1/2 density C_d diameter
void strand_oracle_air( strand_oracle* strand, double3 wind, double drag, double dt );

// ---- BDF2 ----

/// The substep before, which BDF2 looks back on.
typedef struct strand_oracle_past
{
    bool exists;
    double3 position[MAX_STRAND_ORACLE], velocity[MAX_STRAND_ORACLE]; ///< at its start
} strand_oracle_past;

/// v <- (4 v - v_1) / 3 of vertices that are not held, and start = (4 p - p_1) / 3. The present is the next past.
void strand_oracle_extrapolate( strand_oracle* strand, strand_oracle_past* past, double3* start );
/// v <- v + he a, p <- start + he v, previous = start, with he = 2 dt / 3. Held vertices move to their ends in dt, and
/// previous = p - he v.
void strand_oracle_predict_bdf2( strand_oracle* strand, const double3* start, const double3* root,
                                 double3 acceleration, double dt );

// ---- lengths ----

/// Which constraint Newton linearises. Both have the same solutions.
typedef enum strand_oracle_measure
{
    STRAND_ORACLE_SQUARE, ///< C_s = (|e_s|^2 - l_s^2) / 2, gradients e_s: without a root, as the kernel
    STRAND_ORACLE_LENGTH, ///< C_s = |e_s| - l_s, gradients e_s / |e_s|
} strand_oracle_measure;

/// Unit directions of the present segments. A segment that is shorter than 1e-15 m or not finite has the direction of
/// the previous one, or (0, -1, 0) if it is the first.
void strand_oracle_directions( const strand_oracle* strand, double3* direction );

/// Newton passes with J W J^T dlambda = -C, tridiagonal. A segment whose pivot vanishes (below 1e-12 of its own
/// diagonal, or below 1e-30 m^2/kg) moves nothing: it has no length, or none of its vertices is free. The tension of
/// a segment grows by -|grad C_s| dlambda / dt^2, the force of the pass.
///
/// A strand that is not within tolerance afterwards and is held at most at its root is reset: p_0 stays, p_{s+1} =
/// p_s + l_s d_s with the directions of the segments after Newton. Its tension is 0, and a vertex that moves farther
/// from `previous` than the length of the strand loses its velocity: previous = p. No vertex becomes faster than its
/// predicted velocity: previous moves towards p until it is dt |v| away.
/// @return whether it was reset
bool strand_oracle_stretch( strand_oracle* strand, strand_oracle_measure measure, int passes, double tolerance,
                            bool keeps_tension, double dt );

/// Softness of a link.
typedef struct strand_oracle_link_rule
{
    double stiffness;   ///< pbd: fraction of the error, 0 .. 1
    double compliance;  ///< xpbd: m/N
    double inverse_dt2; ///< xpbd: 1/s^2; 0: pbd
} strand_oracle_link_rule;

/// One sweep from the root over the pairs (i, i + stride), each at once. A pair shorter than 1e-15 m, or with a
/// negative rest length, does nothing.
/// @param lambda [count], xpbd: N s^2, begins at 0 every substep
void strand_oracle_link( strand_oracle* strand, const double* rest, double* lambda, int stride,
                         strand_oracle_link_rule rule );

/// The twist of a closed strand at rest in its shape, and its closing twist: -angle L_i / L of each vertex, and what frames
/// carried around the loop are turned by at vertex 0.
void strand_oracle_close( strand_oracle* strand, double angle );
/// Solve (M + scale K) x = right of a closed strand for x, y and z, and move it by x.
void strand_oracle_closed_move( strand_oracle* strand, double scale, double3* right );

// ---- the rod ----

/// M + (dt^2 + damping dt) K = L D L^T. A held vertex has 1/pivot = 0.
void strand_oracle_rod_factor( strand_oracle* strand, double damping, double dt );
/// Tension first, then frames, twist in balance, bending. The guards: the tangent in T_i is limited where |w'| <
/// 0.087 (a twist of 170 degrees); 1 + t_{i-1} . t_i is at least 0.1; a segment turns about itself by at most a
/// radian, to first order: q_s by (0, 0, a/2, 1), k_i by the mean turn of its two segments times z x k_i, T_i by GJ /
/// L_i times their difference; where a turn is limited, all T_i of the strand are 0. A vertex that folds back fades
/// (rod_factors.c). A segment whose pivot vanishes does not turn. The clamp counts as resting where the rate of bending
/// is damped.
/// @param acceleration null: tension pulls along the segments at p*, frames and twist are taken at p* + tension.
///        Otherwise the acceleration of the prediction, m/s^2: all are taken at p* - dt^2 a, the position without it.
///        At rest that is the present position, so an equilibrium of the equations is one of the substep too; with p*
///        it is one up to dt^2 only.
///        so that an equilibrium of the equations is one of the substep too; with p* it is one up to dt^2 only.
void strand_oracle_rod( strand_oracle* strand, double damping, double dt, const double3* acceleration );

/// Compute k_i, rest twist and tension for which the present shape is in balance under the fraction of gravity at which the
/// rest shape turns against the load by at most max_turn (rad) between the tip and any vertex. The stiffness must be set.
/// Without twist stiffness T_i = 0 and segments do not turn about themselves, so twist is left out of the balance; a vertex
/// without stiffness gets its present curvature. A held vertex beyond the root carries everything that hangs from it. A
/// segment without length has tension 0. @return the fraction
double strand_oracle_balance_stably( strand_oracle* strand, double3 gravity, double max_turn );
/// Take the present shape without twist as the rest shape.
void strand_oracle_rest_shape( strand_oracle* strand );
/// Straight, without twist.
void strand_oracle_rest_straight( strand_oracle* strand );

/// m_i = 2 atan2( r_z, r_w ) of vertex i, rad.
double strand_oracle_twist( const strand_oracle* strand, int vertex );
/// Energy of bending and twist with t_s = e_s / l_s and frames as they are. Where a vertex folds back, rest curvature
/// and twist fade. Twist has the energy whose derivative is
/// T_i = 2 GJ / L_i tan( d/2 ), d = m_i less its rest value: -4 GJ / L_i log cos( d/2 ), which is GJ / (2 L_i) d^2 up
/// to d^4.
double strand_oracle_rod_energy( const strand_oracle* strand );
/// The gradient in the rod's right-hand side, [count]: that of the energy, with frames carried along, where vertices
/// are not twisted; twist leaves out a part of second order.
void strand_oracle_rod_gradient( const strand_oracle* strand, double3* gradient );

// ---- a substep ----

typedef enum strand_oracle_lengths
{
    STRAND_ORACLE_LENGTHS_DIRECT,
    STRAND_ORACLE_LENGTHS_LINKS,
    STRAND_ORACLE_LENGTHS_COUNT,
} strand_oracle_lengths;

typedef enum strand_oracle_bending
{
    STRAND_ORACLE_BENDING_ROD,
    STRAND_ORACLE_BENDING_LINKS,
    STRAND_ORACLE_BENDING_NONE,
} strand_oracle_bending;

typedef struct strand_oracle_settings
{
    strand_oracle_lengths lengths;
    strand_oracle_measure measure;
    int passes;                          ///< of Newton
    double tolerance;                    ///< of |l/l_0 - 1|
    int iterations;                      ///< of links; each is a sweep of bends, then one of distances
    strand_oracle_link_rule along, bend; ///< above 0 in inverse_dt2: xpbd
    strand_oracle_bending bending;
    double bend_damping; ///< s
    bool looks_back;     ///< the rod is evaluated at p* - dt^2 gravity
    double3 gravity;     ///< m/s^2
    double damping;      ///< 1/s, against the world at rest: v <- v / (1 + damping dt) before gravity
    double dt;
} strand_oracle_settings;

/// Direct lengths, two passes, tolerance 1e-3, no bending, gravity -9.81 along y.
strand_oracle_settings strand_oracle_default_settings( double dt );
/// Damping, prediction, rod, lengths, velocity: the order of the README. Bend links have the distance that two
/// straight segments span.
/// @return whether the strand was reset
bool strand_oracle_substep( strand_oracle* strand, const strand_oracle_settings* settings, const double3* root );
