/// Frozen hair in plain double precision: the method's equations one by one, then its three stages, then the
/// pipeline.
///
/// Equation numbers and switch names are those of "A Stiffness-Based Real-Time Appearance Deformation Method for 2D
/// Frozen Hair Without Physical Simulation"; docs/methods.md lists what that text leaves open or misprints. Nothing
/// here is optimised: neighbours are searched among all vertices.
#pragma once

#include "double3.h"
#include "wisp/base.h"

/// How the aligning rotation is spread along a strand.
typedef enum frozen_oracle_blend
{
    FROZEN_ORACLE_BLEND_ARC,   ///< rotate by w phi: distances to the root are kept (default)
    FROZEN_ORACLE_BLEND_CHORD, ///< Eq. 13 as printed: mix the turned and the unturned point
} frozen_oracle_blend;

/// Definition of the direction of a strand.
typedef enum frozen_oracle_direction
{
    FROZEN_ORACLE_DIRECTION_MEAN, ///< tip - mean, as printed (default)
    FROZEN_ORACLE_DIRECTION_ROOT, ///< tip - root
} frozen_oracle_direction;

/// How a change of distance scales down a clumping step.
typedef enum frozen_oracle_gap
{
    FROZEN_ORACLE_GAP_ABSOLUTE, ///< the more a distance has changed, the smaller the step (default)
    FROZEN_ORACLE_GAP_SIGNED,   ///< Eq. 17-18 literally: growing distances count
    FROZEN_ORACLE_GAP_REVERSED, ///< Eq. 18 with shrinking distances
    FROZEN_ORACLE_GAP_NONE,     ///< no brake: lambda = 1
} frozen_oracle_gap;

/// Where the distance r0 of Eq. 17 is measured.
typedef enum frozen_oracle_gap_reference
{
    FROZEN_ORACLE_GAP_REFERENCE_STAGE,     ///< before the clumping stage (default)
    FROZEN_ORACLE_GAP_REFERENCE_ITERATION, ///< before each clumping iteration
} frozen_oracle_gap_reference;

/// Which vertices are tested against the cursor.
typedef enum frozen_oracle_reach
{
    FROZEN_ORACLE_REACH_TIP,     ///< Eq. 10 as printed (default)
    FROZEN_ORACLE_REACH_NEAREST, ///< any vertex
} frozen_oracle_reach;

/// Which shape a command starts from.
typedef enum frozen_oracle_base
{
    FROZEN_ORACLE_BASE_REST,     ///< the rest shape (default)
    FROZEN_ORACLE_BASE_PREVIOUS, ///< the last output; rest lengths stay those of the rest shape
} frozen_oracle_base;

/// A strand set (Eq. 1): strand s owns the vertices offsets[s] .. offsets[s + 1] - 1, the first is its root.
typedef struct frozen_oracle_hair
{
    int strand_count;
    const int* offsets;              ///< [strand_count + 1], offsets[0] = 0, never falling
    const double3* rest;             ///< [offsets[strand_count]], m
    const double3* previous;         ///< the last output, m; only read with base = previous
    const double* stretch_stiffness; ///< [strand_count] k_s
    const double* bend_stiffness;    ///< [strand_count] k_b
    const double* intensity;         ///< [strand_count] x in [0, 1]
} frozen_oracle_hair;

/// All other parameters. Start from frozen_oracle_default_options().
typedef struct frozen_oracle_options
{
    double theta_max;     ///< rad, largest bend at alpha_b = 1, default pi / 4
    double3 cursor;       ///< m, c of Eq. 9
    double cursor_radius; ///< m, r of Eq. 10, default 0.15
    double clump_radius;  ///< m, h of Eq. 14, default 0.01
    int clump_iterations; ///< K, default 4
    double clump_step;    ///< m, sigma = dt^2/m times a unit force, default 0.1 h
    double min_distance;  ///< m, r_min of the guard, default 0.02 h
    double lambda_min;    ///< lambda at delta = 1 with gap = prose, default 0
    double length_floor;  ///< shortest l* as a fraction of l0, default 0.05
    double epsilon;       ///< of the printed divisions, default 0: the resolved forms

    /// m, 2.5D (extension): the most that freezing moves a vertex along z; strands align about z and clump along x and y. Below
    /// 0, default: no limit.
    double max_depth_change;
    int dimension; ///< 2 or 3; decides the fallback axes only
    frozen_oracle_blend blend;
    frozen_oracle_direction direction;
    frozen_oracle_gap gap;
    frozen_oracle_gap_reference gap_reference;
    frozen_oracle_reach reach;
    frozen_oracle_base base;
    bool min_distance_clamp;   ///< no two vertices come closer than r_min, default on
    bool deform, align, clump; ///< the three stages, default on
    uint64_t seed;
    uint64_t event; ///< number of the user's command; the number of the frame makes hair flicker, as printed
} frozen_oracle_options;

/// The defaults that the method's specification states, for 3D input.
frozen_oracle_options frozen_oracle_default_options( void );

// Random numbers: pure functions of seed, event and element.

double frozen_oracle_eta( const frozen_oracle_options* options, int strand, int vertex ); ///< U(-1,1), length
double frozen_oracle_xi( const frozen_oracle_options* options, int strand, int vertex );  ///< U(-1,1), angle
double frozen_oracle_zeta( const frozen_oracle_options* options, int strand, int vertex,
                           int iteration );                                               ///< U(0,1), brake
double frozen_oracle_psi( const frozen_oracle_options* options, int strand, int vertex ); ///< rad, fallback axis

// Equations 2 to 7: stretch and bend one segment.

/// Two unit vectors that complete a unit vector to a right-handed frame (Duff et al. 2017).
void frozen_oracle_frame( double3 unit, double3* b1, double3* b2 );

/// R(axis, angle) v
double3 frozen_oracle_rotate( double3 axis, double angle, double3 v );

/// Result of stage 1 for the segment from vertex - 1 to vertex.
typedef struct frozen_oracle_segment
{
    double rest_length;   ///< m, l0
    double target_length; ///< m, l*
    double3 tangent;      ///< before the bend
    double3 axis;         ///< unit
    double angle;         ///< rad, theta
    double3 direction;    ///< tangent after the bend, Eq. 6
    double3 step;         ///< m, added to p'_{i-1} by Eq. 7
} frozen_oracle_segment;

/// Eq. 2-7 for one segment.
/// @param base the shape that gives the directions: rest, or the previous output
/// @param previous_tangent tangent of the segment before, the zero vector for the first
frozen_oracle_segment frozen_oracle_jitter( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                            const double3* base, int strand, int vertex, double3 previous_tangent );

/// 2.5D: bring a frozen strand back to within `limit` of the depths of `base`. Segments keep their lengths by more or less of
/// their x and y; one that is steeper, or has no x and y, is as long as its depth.
/// @param points [count] m, changed
void frozen_oracle_limit_depth( const double3* base, int count, double limit, double3* points );

// Equations 8 to 13: turn a strand towards the cursor.

/// Whether a 2.5D limit of depth applies; whether turns stay in the plane; a vector without the depth that then does not count.
bool frozen_oracle_has_depth( const frozen_oracle_options* options );
bool frozen_oracle_is_in_plane( const frozen_oracle_options* options );
double3 frozen_oracle_without_depth( const frozen_oracle_options* options, double3 v );

/// Eq. 8: tip - mean or tip - root of count >= 1 points.
double3 frozen_oracle_representative( const double3* points, int count, frozen_oracle_direction direction );

/// Eq. 10: whether the cursor reaches the strand.
bool frozen_oracle_in_reach( const double3* points, int count, double3 cursor, double radius,
                             frozen_oracle_reach reach );

/// Eq. 11: unit axis and angle in [0, pi] that turn v onto u.
/// @return false when v or u is shorter than 1e-12 m: without a direction nothing turns
bool frozen_oracle_turn( double3 v, double3 u, int dimension, double3* axis, double* phi );

/// Eq. 12: w = t (1 - x) + x with t = vertex / (count - 1); x when count is 1.
double frozen_oracle_weight( int vertex, int count, double intensity );

/// Eq. 13, as a chord or an arc: the turned point.
double3 frozen_oracle_blend_point( frozen_oracle_blend blend, double3 root, double3 point, double3 axis, double phi,
                                   double weight );

// Equations 14 to 19: clump with gaps.

/// Eq. 14: g(r) = (1 - r/h)^2 for 0 <= r < h, else 0.
double frozen_oracle_kernel( double distance, double radius );

/// The adhesion of one vertex and the nearest distance for the guard.
typedef struct frozen_oracle_adhesion
{
    double3 force;  ///< f of Eq. 15
    double nearest; ///< m, r_nn of the guard; infinite without neighbours
    int neighbours; ///< vertices of other strands with 0 < r < h
} frozen_oracle_adhesion;

/// Eq. 15 by brute force.
/// @param order a permutation of all vertices that the sum follows, or null for ascending
frozen_oracle_adhesion frozen_oracle_adhere( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                             const double3* points, int strand, int vertex, const int* order );

/// Eq. 16 with the guard: sigma f, no longer than max( 0, (r_nn - r_min) / 2 ) when the guard is on.
double3 frozen_oracle_tentative_step( const frozen_oracle_options* options, frozen_oracle_adhesion adhesion );

/// Eq. 17 in one of its readings: the relative change of one pair, in [0, 1].
double frozen_oracle_pair_delta( frozen_oracle_gap gap, double r0, double r1, double radius );

/// The mean of the pair deltas of one vertex, weighted by g(r0), over its neighbourhood in the reference shape.
double frozen_oracle_vertex_delta( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                   const double3* reference, const double3* tentative, int strand, int vertex,
                                   const int* order );

/// Eq. 18 in one of its readings: the fraction of the step that remains.
double frozen_oracle_lambda( frozen_oracle_gap gap, double delta, double zeta, double lambda_min );

// The stages. Arrays hold offsets[strand_count] points; in and out must differ.

/// Stage 1: FreezeDeform, from the base shape that the options name.
void frozen_oracle_deform( const frozen_oracle_hair* hair, const frozen_oracle_options* options, double3* out );

/// Stage 2: UserAlign.
void frozen_oracle_align( const frozen_oracle_hair* hair, const frozen_oracle_options* options, const double3* in,
                          double3* out );

/// What strands keep between the commands of a stroke.
typedef struct frozen_oracle_stroke
{
    double3* target;      ///< [strand_count] m, root to cursor of the last command that reached it; zero: none has
    double* intensity;    ///< [strand_count] x of that command
    const double3* moved; ///< shape that strands have moved to, m; null: the rest shape
    double3 axis;         ///< how the moved shape is turned as a whole: unit axis
    double angle;         ///< and angle, rad
} frozen_oracle_stroke;

/// Stage 2 in a stroke for one strand: the cursor reaches it as it is turned already; a strand that it does not reach
/// keeps its turn, which follows the moved shape.
/// @param sweeps false: the update is no command, no strand is reached
void frozen_oracle_align_in_stroke( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                    frozen_oracle_stroke* stroke, bool sweeps, int strand, const double3* in,
                                    double3* out );

/// One Jacobi iteration of stage 3.
/// @param reference p'', read with gap_reference = stage
/// @param delta, lambda receive Eq. 17 and 18 of every vertex (roots: 0); either may be null
/// @return WISP_OK or WISP_NO_MEMORY
wisp_status frozen_oracle_clump_step( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                      int iteration, const double3* reference, const double3* in, const int* order,
                                      double* delta, double* lambda, double3* out );

/// Stage 3: ClumpWithGaps, K iterations.
wisp_status frozen_oracle_clump( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                 const double3* in, const int* order, double3* out );

/// The pipeline of one user command: FreezeDeform, UserAlign, ClumpWithGaps. A stage that is off copies its
/// input.
wisp_status frozen_oracle_run( const frozen_oracle_hair* hair, const frozen_oracle_options* options, const int* order,
                               double3* out );
