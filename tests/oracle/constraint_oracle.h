/// Constraints of cloth and balloons in plain double precision: the values and gradients one by one, then the two
/// ways to project them.
///
/// Equation numbers are those of the balloon paper (Eq. 3-8); the other forms name their paper. Every constraint is a
/// function C(p) of the predicted positions whose target is C = 0. Inverse masses w in 1/kg, 0 pins a vertex.
///
///   pbd    Dp_i = -k s w_i grad_i C,  s = C / sum_j w_j |grad_j C|^2                              (Eq. 4)
///   xpbd   Dlambda = -(C + a lambda) / (sum_j w_j |grad_j C|^2 + a),  Dp_i = Dlambda w_i grad_i C,
///          a = compliance / dt^2, lambda = 0 at the start of every substep      (Macklin, Mueller, Chentanez 2016)
///
/// A lambda is therefore negative while C > 0: the tension of a stretched distance is -lambda / dt^2 and the gauge
/// pressure of a volume below its target is +lambda / dt^2.
///
/// Projections are Gauss-Seidel: they write p at once, so the caller's order of calls is the order of the method.
#pragma once

#include "double3.h"

#include <stdbool.h>

/// Reasons why a projection leaves its vertices unchanged.
typedef enum constraint_oracle_fault
{
    CONSTRAINT_ORACLE_SOUND,
    CONSTRAINT_ORACLE_ZERO_LENGTH,   ///< both ends coincide: no direction
    CONSTRAINT_ORACLE_ZERO_AREA,     ///< a triangle of a bend has no area: no normal
    CONSTRAINT_ORACLE_ZERO_GRADIENT, ///< C is not 0 and no movement changes it
    CONSTRAINT_ORACLE_PINNED,        ///< every vertex that could change C has w = 0
    CONSTRAINT_ORACLE_FAULT_COUNT,
} constraint_oracle_fault;

/// Counts of each fault. Every skipped projection is counted.
typedef struct constraint_oracle_skips
{
    int count[CONSTRAINT_ORACLE_FAULT_COUNT];
} constraint_oracle_skips;

/// A constraint at the present positions: its value and its gradients, in the order of its vertices.
typedef struct constraint_oracle_term
{
    int count;                     ///< vertices, 2 or 4
    double value;                  ///< C
    double3 gradient[4];           ///< grad_i C; zero after a fault
    constraint_oracle_fault fault; ///< ZERO_LENGTH, ZERO_AREA or SOUND
    double max_change;             ///< largest change of C in one projection, to first order; 0: no limit
} constraint_oracle_term;

// Constraints of two vertices.

/// Eq. 5: C = |p1 - p2| - d, m; grad_1 = u, grad_2 = -u, u = (p1 - p2) / |p1 - p2|. Structural edges, and bends as a
/// distance between the two vertices across an interior edge.
constraint_oracle_term constraint_oracle_distance( double3 p1, double3 p2, double rest_length );

/// Strain limit: C = l - clamp( l, low d, high d ), 0 while the length is within its limits.
/// @param low, high fractions of the rest length, low <= 1 <= high
constraint_oracle_term constraint_oracle_strain_limit( double3 p1, double3 p2, double rest_length, double lower,
                                                       double upper );

// Constraints of two triangles that share the edge p0 p1: triangle 0 is (p0, p1, p2), triangle 1 is (p1, p0, p3).

/// Dihedral bend: C = theta - theta_rest, wrapped into (-pi, pi]. Gradients in the robust form of Bridson, Marino,
/// Fedkiw 2003: grad_2 = -|e| n0/|n0|^2, grad_3 = -|e| n1/|n1|^2 (n are doubled area vectors). Gradients at p0 and p1
/// balance forces and torques, in proportion to the feet of p2 and p3 on the edge.
constraint_oracle_term constraint_oracle_dihedral( const double3 p[4], double rest_angle );

/// Isometric (quadratic) bending of Bergou, Wardetzky, Harmon, Zorin, Grinspun 2006: Q = 3/(A0 + A1) K^T K, in 1/m^2,
/// with K = (c03 + c04, c01 + c02, -c01 - c03, -c02 - c04) for vertices (p0, p1, p2, p3), where c01, c02 are the
/// cotangents at p0 and c03, c04 those at p1, in triangle 0 and 1 of the rest shape. Q belongs to a flat rest shape.
/// @return false when a rest triangle has no area; then Q is zero
bool constraint_oracle_isometric_matrix( const double3 rest[4], double q[4][4] );

/// Isometric bending, energy form (the position based dynamics library of Bender et al.): C = 1/2 x^T Q x,
/// grad_i C = sum_j Q_ij x_j. Project it with stiffness k: Dp_i = -k w_i C grad_i C / sum w |grad C|^2. One
/// projection with k = 1 halves the curvature vector sum K_i x_i, because a quadratic is solved by its first-order
/// model.
constraint_oracle_term constraint_oracle_isometric_energy( const double3 p[4], double q[4][4] );

/// Isometric bending, root form: C = sqrt( x^T Q x ), grad_i C = sum_j Q_ij x_j / C. Project it as xpbd with
/// compliance 1/k, then U = C^2/(2 compliance) is exactly the energy E = 1/2 k x^T Q x of the paper. One projection
/// with compliance 0 flattens the hinge. A flat hinge has C = 0 and no gradient: nothing to do, and no fault.
constraint_oracle_term constraint_oracle_isometric_root( const double3 p[4], double q[4][4] );

// Projection of terms. `vertices` are the indices into w and p.

/// pbd: Eq. 4 with stiffness k in (0, 1].
/// @return lambda = -k s of this projection; 0 when skipped, which is counted
double constraint_oracle_project( const constraint_oracle_term* term, const int* vertices, const double* w,
                                  double stiffness, double3* p, constraint_oracle_skips* skips );

/// xpbd.
/// @param alpha compliance / dt^2
/// @param lambda grows by Dlambda
void constraint_oracle_project_compliant( const constraint_oracle_term* term, const int* vertices, const double* w,
                                          double alpha, double* lambda, double3* p, constraint_oracle_skips* skips );

// Volume of a closed mesh. `triangles` holds 3 * triangle_count indices, counter-clockwise seen from outside.

/// V = S/6, m^3, measured from the first vertex of the first triangle, so that a translation costs no digits.
double constraint_oracle_volume( const double3* p, const int* triangles, int triangle_count );

/// Eq. 8 resolved, the gradient of V: grad_i V = 1/6 sum over the faces around i of (p_b - p_a) x (p_c - p_a), m^2.
/// It uses only differences of positions, so it does not depend on the origin. Valid for a closed mesh.
void constraint_oracle_volume_gradient( const double3* p, int vertex_count, const int* triangles, int triangle_count,
                                        double3* gradient );

/// pbd of C = V - target.
/// @param gradient scratch [vertex_count], receives grad C
/// @return lambda = -k s; 0 when skipped, which is counted
double constraint_oracle_project_volume( double3* p, const double* w, int vertex_count, const int* triangles,
                                         int triangle_count, double target, double stiffness, double3* gradient,
                                         constraint_oracle_skips* skips );

/// xpbd of C = V - target.
/// @param alpha compliance / dt^2, m^6/J/s^2
void constraint_oracle_project_volume_compliant( double3* p, const double* w, int vertex_count, const int* triangles,
                                                 int triangle_count, double target, double alpha, double* lambda,
                                                 double3* gradient, constraint_oracle_skips* skips );

// ---- seam oracle ----

typedef struct seam_oracle_pair
{
    double rest;    ///< m
    double3 lambda; ///< N s^2, on the first particle, in the substep; in and out
} seam_oracle_pair;

/// Move a rest distance towards that of the seam by at most `step`.
double seam_oracle_close( double rest, double distance, double step );

/// Project one pair. At rest > 0 the constraint is C = |a - b| - rest along n; at rest 0 it is the vector C = a - b.
/// @param w inverse masses @param alpha compliance / dt^2
void seam_oracle_project( seam_oracle_pair* pair, double3* a, double3* b, const double w[2], double alpha );

/// @return N, the tension of a pair in a substep of dt
double seam_oracle_force( const seam_oracle_pair* pair, double dt );

// ---- skin oracle ----

/// A bone in doubles: rows of the matrix, the last column is the translation.
typedef struct skin_oracle_bone
{
    double m[3][4];
} skin_oracle_bone;

/// Linear blend (Magnenat-Thalmann, Laperriere, Thalmann 1988): sum w_k M_k p.
/// @param weights [count] sum to 1
double3 skin_oracle_linear( const skin_oracle_bone* bones, const double* weights, int count, double3 p );

/// Dual quaternions (Kavan, Collins, Zara, O'Sullivan 2008): each bone as a unit dual quaternion, signs chosen so that real parts lie
/// on the side of that with the largest weight, the weighted sum divided by the length of its real part, applied to the point.
/// @param bones [count] rigid
double3 skin_oracle_dual_quaternion( const skin_oracle_bone* bones, const double* weights, int count, double3 p );

// ---- motion oracle ----

typedef struct motion_oracle
{
    double3 target;           ///< m
    double max_distance;      ///< m; infinite: free
    double3 normal;           ///< of any length; 0: no backstop
    double backstop_distance; ///< m behind the target; infinite: no backstop
    double backstop_radius;   ///< m; infinite: a plane
    double stiffness[2];      ///< of distance and backstop, fraction of the error that is removed
    double alpha[2];          ///< 1/kg, compliance over the squared substep
    double lambda[2];         ///< N s^2, in and out; used only where alpha is above 0 and the multiplier is kept
} motion_oracle;

/// Project a particle of inverse mass w, first by the distance, C = |x - t| - d, then by the backstop: out of the sphere of radius r
/// about t - (b + r) n, or in front of the plane (x - t).n = -b.
double3 motion_oracle_project( motion_oracle* m, double3 x, double w, bool keeps_lambda );
