/// Guide hair in plain double precision: target strands drive ghost strands. The equations one by one, then the
/// ghosts of a head of hair stepped in the order of the specification, then the curves that draw them.
///
/// Equation numbers and switch names are those of "PBD-based Framework for Efficiently Controlling the Movement of
/// Strands in Hair"; docs/methods.md lists what that text leaves open or misprints, and the extensions. SI units. A
/// strand is a run of nodes, node 0 its root; strand s of a set with n nodes per strand begins at s * n. Nothing here
/// is optimised.
#pragma once

#include "constraint_oracle.h"
#include "wisp/base.h"

// ---- switches ----

/// How Eq. 4 interprets the change of velocity.
typedef enum guide_oracle_elastic
{
    GUIDE_ORACLE_ELASTIC_CHANGE,      ///< 0.5 - 0.5 cos: 0 in steady motion, 1 at reversal (default)
    GUIDE_ORACLE_ELASTIC_PRINTED_COS, ///< 0.5 + 0.5 cos: as printed, with the angle that the prose describes
    GUIDE_ORACLE_ELASTIC_PRINTED_RAW, ///< 0.5 + 0.5 v.v0: literally, in m^2/s^2, not bounded
} guide_oracle_elastic;

/// How the offsets of the ghosts are rotated.
typedef enum guide_oracle_frame
{
    GUIDE_ORACLE_FRAME_OFF,      ///< R = 1: offsets keep their directions in the world (default)
    GUIDE_ORACLE_FRAME_PARALLEL, ///< guide_oracle_parallel_frames() from the root rotation of each target
    GUIDE_ORACLE_FRAME_GIVEN,    ///< the caller's rotation for every paired target node
} guide_oracle_frame;

/// Which point of its target a ghost node follows.
typedef enum guide_oracle_pairing
{
    GUIDE_ORACLE_PAIRING_NODE,    ///< node i follows node i; other node counts are refused (default)
    GUIDE_ORACLE_PAIRING_NEAREST, ///< the nearest rest particle of the target: the printed limitation, for comparison
    GUIDE_ORACLE_PAIRING_SPLINE,  ///< the Catmull-Rom point at the same normalised arc length
} guide_oracle_pairing;

// ---- Eq. 1: correspondence ----

/// Several targets: the `link_count` guides with the smallest strand distances d_k, nearest first, ties by lowest
/// index, and their weights (1/d_k) / sum_j (1/d_j). Eq. 1 sums squares already, so this is the normalised inverse
/// squared distance of the rest strands. Guides at distance 0 divide the whole weight equally. One link has weight 1.
/// @param link_count in [1, guide_count]
void guide_oracle_links( const double3* detail, int detail_nodes, const double3* guides, int guide_count,
                         int guide_nodes, int link_count, int* link, double* weight );

// ---- Eq. 2-3: spread of a group ----

/// Reasons why a spread projection leaves its group unchanged.
typedef enum guide_oracle_spread_fault
{
    GUIDE_ORACLE_SPREAD_SOUND,
    GUIDE_ORACLE_SPREAD_SINGLE,     ///< fewer than two ghosts: V is always 0
    GUIDE_ORACLE_SPREAD_COINCIDENT, ///< V = 0: the ghosts coincide, so there is no direction
    GUIDE_ORACLE_SPREAD_BAD_TARGET, ///< Vbar is not positive
} guide_oracle_spread_fault;

/// The plain mean of points, measured from the first one so that a translation costs no digits.
double3 guide_oracle_mean( const double3* points, int count );

/// Eq. 3: V = sum |c - d|^2 about the mean c, m^2.
double guide_oracle_spread( const double3* points, int count );

/// Eq. 2: P = k_v (V - Vbar)^2.
double guide_oracle_spread_energy( double stiffness, double spread, double requested );

/// The derivative of (2): dP/dd_l = 4 k_v (V - Vbar)(d_l - c).
void guide_oracle_spread_gradient( double stiffness, const double3* points, int count, double requested,
                                   double3* gradient );

/// Scale a group to a given spread without moving its mean.
/// @param exact true: scale the offsets by sqrt(Vbar/V). false: the step of (3) as a position based constraint,
///        Dd_l = -((V - Vbar)/(2V))(d_l - c), which is one Newton step of the former
guide_oracle_spread_fault guide_oracle_spread_project( double3* points, int count, double requested, bool exact );

// ---- Eq. 4-5: weights and displacement ----

/// Eq. 4: W of the present and the previous velocity. Below 1e-6 m/s there is no direction: 0 with `change`, 0.5 with
/// `printed_cos`.
double guide_oracle_elastic_weight( guide_oracle_elastic elastic, double3 v, double3 v0 );

/// k_tip i/(N-1), linear from the root to the tip; 0 for a strand of one node.
double guide_oracle_tip_weight( double gain, int node, int node_count );

/// k_com |b - c| / largest; 0 when the largest offset is 0. It is k_com at the farthest ghost; larger values occur
/// only where b is not rigid about c: with feedback, and with several targets per ghost.
double guide_oracle_centre_weight( double gain, double3 b, double3 c, double largest_offset );

/// The term that Eq. 5 adds to b: tau v (sum of weights), scaled so that a ghost with the largest weight of the group
/// moves no farther than `longest`. One factor for the whole group, so that the ratios between its ghosts stay.
/// @param largest_weight >= 0, of any ghost from the centre to the farthest one of the group's node
/// @param longest m; negative: no limit, as printed. 0 forbids every move
/// @param cut set to true when the limit acted, otherwise left alone
double3 guide_oracle_displacement( double3 v, double weight, double largest_weight, double tau, double longest,
                                   bool* cut );

/// Section 4.2: move all members by goal - mean, so that their mean is the goal.
void guide_oracle_track( double3* members, int count, double3 goal );

/// Restore rest lengths (optional, section 4.6): from the root outwards each node moves along the line to the node
/// before it, which is restored already, until their distance is the rest length.
/// @param segment_lengths [node_count], m: entry i belongs to the segment that ends in node i, entry 0 is not read
/// @return how many segments had no length, hence no direction, and were left unchanged
/// @return how many segments had no length, hence no direction, and were left alone
int guide_oracle_repair_lengths( double3* strand, int node_count, const double* segment_lengths );

// ---- frames ----

typedef struct guide_oracle_rotation
{
    double m[3][3]; ///< rows first
} guide_oracle_rotation;

guide_oracle_rotation guide_oracle_no_rotation( void );
double3 guide_oracle_rotate( const guide_oracle_rotation* rotation, double3 v );

guide_oracle_rotation guide_oracle_turn_about( double3 axis, double angle );

/// Frames by smallest rotations, segment by segment from the root outwards:
///   R_0 = root,  R_i = S( R_{i-1} t_rest,i -> t_i ) R_{i-1},  t_i = x_i - x_{i-1},
/// with S the smallest rotation from the carried rest tangent to the present tangent. So node i has the frame of the
/// segment that ends in it, the root has the frame of the head, and a segment without length adds no rotation.
/// @return how many tangents were opposite
int guide_oracle_parallel_frames( const double3* rest, const double3* present, int node_count,
                                  const guide_oracle_rotation* root, guide_oracle_rotation* frames );

// ---- Eq. 6 and splines ----

/// How a strand is drawn.
typedef enum guide_oracle_curve
{
    GUIDE_ORACLE_CURVE_GROUPS, ///< nodes {0..3}, {3..6}, ...: the source, C0 at the shared ends (default)
    GUIDE_ORACLE_CURVE_SMOOTH, ///< one cubic a segment through all nodes, C1
    GUIDE_ORACLE_CURVE_JOINED, ///< the groups with one tangent at a joint: along x_{k+1} - x_{k-1}, G1
} guide_oracle_curve;

/// The weights of Eq. 6.
/// @param printed true: the second coefficient is 2, as printed; false: 3
void guide_oracle_bezier_weights( double t, bool printed, double weight[4] );

/// Number of cubics that draw a strand: 0 for fewer than two nodes, else ceil((N-1)/3) groups, or N-1 smooth ones.
int guide_oracle_curve_count( int node_count, guide_oracle_curve curve );

/// Their control points. Groups: four nodes that share their ends; a remainder of one node is a line, of two nodes a
/// quadratic, both raised to cubics. Joined: the same, and control points next to a joint keep their distance to it and are moved
/// onto its tangent; a joint whose neighbours coincide is left alone. Smooth: x_k, x_k + m_k/3, x_{k+1} - m_{k+1}/3, x_{k+1} with the tangents m of
/// guide_oracle_tangent().
/// @param controls receives 4 * guide_oracle_curve_count() points
void guide_oracle_curve_controls( const double3* nodes, int node_count, guide_oracle_curve curve, double3* controls );

/// Sample every cubic at t = k/M, joints once.
/// @param points receives curve_count * samples + 1 points, none when curve_count is 0
/// @return number of points
int guide_oracle_draw( const double3* controls, int curve_count, int samples, bool printed, double3* points );

/// Largest angle between successive segments, rad; segments without length are skipped.
double guide_oracle_largest_turn( const double3* points, int count );

/// Between two steps (section II.2.2): a node between two frames dt apart, by its positions and velocities at both; u in [0, 1].
double3 guide_oracle_between_frames( double3 x0, double3 v0, double3 x1, double3 v1, double dt, double u );

/// Catmull-Rom tangent by the node number: (x_{i+1} - x_{i-1})/2, one-sided differences at the ends.
double3 guide_oracle_tangent( const double3* nodes, int node_count, int node );

/// Normalised arc length of the polyline at every node, 0 at the root, 1 at the tip; i/(N-1) for a strand without
/// length.
void guide_oracle_arc( const double3* nodes, int node_count, double* arc );

/// A point of a strand as a sum of nodes: four indices, which may repeat, and their weights.
typedef struct guide_oracle_stencil
{
    int node[4];
    double weight[4];
} guide_oracle_stencil;

/// The spline point at a normalised arc length of the rest polyline. Segment k contains s between its nodes' arc
/// lengths and u = (s - s_k)/(s_{k+1} - s_k). Computed at rest, applied to present positions and velocities alike.
guide_oracle_stencil guide_oracle_spline_stencil( const double3* rest, int node_count, double arc );

/// Find the nearest particle; ties go to the lowest index.
guide_oracle_stencil guide_oracle_nearest_stencil( const double3* rest, int node_count, double3 point );

double3 guide_oracle_gather( const guide_oracle_stencil* stencil, const double3* nodes );

// ---- targets: a chain by position based dynamics ----

/// A target strand. Node 0 follows `root` when its w is 0.
typedef struct guide_oracle_strand
{
    int node_count;
    const double3* rest;   ///< [node_count], m: rest lengths of segments and of the bends |x_i - x_{i+2}|
    const double* w;       ///< [node_count], 1/kg
    double dt;             ///< s, one frame
    int substeps;          ///< > 0
    int iterations;        ///< > 0, of all segments and then all bends, root first
    double bend_stiffness; ///< in [0, 1], in every iteration; segments have 1
    double3 gravity;       ///< m/s^2
    double3 root;          ///< m, where node 0 is at the end of the frame
} guide_oracle_strand;

/// Advance one frame: predict, project, v = (p - x)/h, `substeps` times.
/// @return how many constraints were projected, those without length are counted in `skips`; -1: no memory, and
///        nothing has moved
int guide_oracle_strand_step( const guide_oracle_strand* strand, double3* x, double3* v,
                              constraint_oracle_skips* skips );

// ---- the ghosts of a head of hair ----

/// All parameters except the shape. Start from guide_oracle_default_options(). Those from `dt` to `repair_lengths`
/// may be changed between steps.
typedef struct guide_oracle_options
{
    guide_oracle_pairing pairing;
    int link_count;      ///< targets per ghost, default 1
    bool keep_offset;    ///< a ghost that is alone in its group keeps y - X of the rest shape, default on
    double dt;           ///< s, default 1/60; only read with feedback
    double tau;          ///< s, default dt; the printed form has 1
    double elastic_gain; ///< factor of W, default 1; 0 switches W off
    double tip_gain;     ///< k_tip >= 0, default 0.5
    double centre_gain;  ///< k_com >= 0, default 0.5
    double spread;       ///< Vbar / v_0 > 0, default 1; only read with use_spread
    guide_oracle_elastic elastic;
    guide_oracle_frame frame;
    bool cap_offset;     ///< Eq. 5 moves no ghost of a group farther than one segment of the target, default on
    bool feedback;       ///< pos* is integrated, default off; needs frame = off and one target per ghost
    bool use_spread;     ///< default off
    bool spread_exact;   ///< default on
    bool repair_lengths; ///< default off
} guide_oracle_options;

guide_oracle_options guide_oracle_default_options( void );

/// The rest shape. Copied; need not outlive the call.
typedef struct guide_oracle_def
{
    int target_count, target_nodes;
    int ghost_count, ghost_nodes;
    const double3* targets; ///< [target_count * target_nodes], m
    const double3* ghosts;  ///< [ghost_count * ghost_nodes], m
    const int* assignment;  ///< [ghost_count] a(g), or null: Eq. 1. Only with one target per ghost
} guide_oracle_def;

/// Counts of degenerate cases and of work, from creation and all steps.
typedef struct guide_oracle_counters
{
    int empty_groups;       ///< targets without ghosts
    int coincident_spreads; ///< groups of a node, summed over steps, that coincide and cannot spread
    int zero_segments;      ///< segments without a direction to repair
    int cut_displacements;  ///< ghost nodes whose group was limited to one segment
    int reversed_tangents;  ///< segments opposite to their carried rest tangent
    long node_updates;      ///< ghost nodes moved: the work for the ghosts
} guide_oracle_counters;

/// The state. `target_nodes` is the node count of the targets, `node_count` that of the ghosts; a paired target is a
/// target at the ghosts' nodes (the same nodes with pairing = node).
///
/// Set-up. Ghost g belongs to the group of a(g) and follows its links a_1 = a(g), a_2, ... with weights q_k:
///   b = sum_k q_k ( X_{a_k} + R_{a_k} o_k ),  o_k = y_rest - e_{a_k},  v = sum_k q_k V_{a_k}
/// The anchor e_a is the mean of the group's rest ghosts, so that the group's mean is the target. It is the paired
/// rest target for an empty group, for a group of one with keep_offset, and with pairing = nearest, where two nodes
/// may follow one particle and cannot both have it as their mean. With one link, the mean is therefore the target's
/// node. Several links blend the results for each target, and equal y_rest at rest wherever the anchors are on the
/// targets. With pairing = spline, node j of a group is at the mean of its ghosts' normalised arc lengths at j
/// (j/(M-1) for an empty group). With pairing = nearest it follows the particle nearest to the mean of the group's
/// nodes j.
///
/// The limit of Eq. 5 is the length of a segment of the original target, so that ghosts with more nodes are not
/// limited to shorter moves: the segment before the node, or with pairing = spline the one that contains the point.
typedef struct guide_oracle
{
    guide_oracle_options options;
    int target_count, target_nodes, ghost_count, node_count;
    int* link;              ///< [ghost_count * link_count], the first of each ghost is a(g)
    double* link_weight;    ///< [ghost_count * link_count], sum 1 per ghost
    int* group_size;        ///< [target_count]
    double* largest;        ///< [target_count], max over nodes and ghosts of |y_rest - c|, m; 0 for a group of one
    double* rest_spread;    ///< [target_count * node_count], v_0, m^2
    double3* centre;        ///< [target_count * node_count], mean of the group's rest ghosts; else the paired target
    double3* anchor;        ///< [target_count * node_count], e
    double3* rest;          ///< [target_count * node_count], paired rest targets
    double* segment;        ///< [target_count * node_count], rest length of the target's own segment there, m
    double* ghost_segment;  ///< [ghost_count * node_count], rest length of the ghost's segment before the node, m
    double3* offset;        ///< [ghost_count * link_count * node_count], o
    double3 *x, *v, *v0;    ///< [target_count * node_count], paired targets of the last step
    bool has_previous;      ///< false until the first step, which has v0 = v
    double3 *b, *y;         ///< [ghost_count * node_count], base and output, m
    double* elastic_weight; ///< [ghost_count * node_count], W times its gain
    double* centre_weight;  ///< [ghost_count * node_count]
    double3* scratch;       ///< [ghost_count]
    guide_oracle_stencil* stencil;   ///< [target_count * node_count]
    guide_oracle_rotation* rotation; ///< [target_count * node_count], R of the last step
    guide_oracle_counters counters;
} guide_oracle;

/// The targets at the end of a step.
typedef struct guide_oracle_motion
{
    const double3* x;                      ///< [target_count * target_nodes], m
    const double3* v;                      ///< [target_count * target_nodes], m/s
    const guide_oracle_rotation* rotation; ///< frame = parallel: [target_count], the root's rotation since rest;
                                           ///< frame = given: [target_count * node_count]; null: none
} guide_oracle_motion;

/// Make ghosts at their base positions about the rest targets.
/// @return WISP_NO_MEMORY: nothing needs to be destroyed
wisp_status guide_oracle_create( const guide_oracle_def* def, const guide_oracle_options* options, guide_oracle* out,
                                 wisp_error* error );

void guide_oracle_destroy( guide_oracle* hair );

/// Advance one step of section 4: pair, frames, base, weights, Eq. 5, spread, lengths. Roots have y = b: Eq. 5,
/// spread and lengths leave them out. With feedback b is advanced by dt v, Eq. 5 is added and the mean of a group is
/// returned to the mean of X + o. This removes what all members have in common; differences between members remain
/// for good.
void guide_oracle_step( guide_oracle* hair, const guide_oracle_motion* motion );
