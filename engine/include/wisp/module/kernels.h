/// Kernels that modules share: constraint projections, searches and integration over ranges, under their
/// mathematical names. The same source is compiled once per instruction set and called through a table. All tables
/// give the same bits.
#pragma once

#include "wisp/module/instances.h"
#include "wisp/module/primitives.h"
#include "wisp/module/random.h"
#include "wisp/module/skin_kernels.h"
#include "wisp/module/springs.h"
#include "wisp/module/strand_kernels.h"
#include "wisp/module/surface_kernels.h"
#include "wisp/module/particle_batch.h"
#include "wisp/module/shapes.h"

WISP_BEGIN_C

/// A slice is eight consecutive items, one per lane.
#define WISP_SLICE 8

/// Arguments of the search for all items within a radius of eight queries, through the rows of a uniform grid.
typedef struct wisp_range_search_args
{
    const float *x, *y, *z;    ///< [slot] items sorted by cell, padded by 16
    const int32_t* owner;      ///< [slot] items with the owner of the query are skipped
    const int32_t* cell_begin; ///< [cell_count + 1] first slot of each cell
    float origin[3];           ///< m
    float inverse_cell[3];     ///< 1/m
    int dims[3], axis[3];      ///< as in wisp_grid
    int cell_reach[3];         ///< cells to search on each side, along axis[0], axis[1], axis[2]
    float near_radius;         ///< m, neighbours closer than this are near
    float skin_radius;         ///< m, neighbours from near_radius to here are in the skin; 0: no skin
    int limit;         ///< maximum number of near neighbours, and of skin neighbours; the first in order are kept
    const float* xyzw; ///< [query][4] x, y, z in m, and the owner as int bits
    bool planar;       ///< all z are equal
} wisp_range_search_args;

/// Entries that a list needs beyond the limit, because entries are written eight at a time.
#define WISP_SEARCH_PADDING 16

/// Results of eight queries. The caller owns the arrays.
typedef struct wisp_range_search_result
{
    int32_t* lists;             ///< [8][2 limit + padding] slots times 4: near neighbours, then skin neighbours
    int32_t* skin;              ///< [8][limit + padding] scratch of the search
    int near_count[WISP_SLICE]; ///< near neighbours in each lane's list
    int count[WISP_SLICE];      ///< near and skin neighbours in each lane's list
    int near_length, length;    ///< maximum of near_count and of count
    int capped;                 ///< incremented by the number of queries that exceeded the limit
} wisp_range_search_result;

/// Boxes as one array per component, sorted so that boxes tested together are stored together.
typedef struct wisp_aabb_stream
{
    const float *lower[3], *upper[3]; ///< [slot] m, padded by 8 boxes that overlap nothing
    const int32_t* item;              ///< [slot] index of the box, padded by 8
} wisp_aabb_stream;

/// Up to eight query boxes and the boxes that overlap them.
typedef struct wisp_aabb_group
{
    int count;                  ///< number of queries
    float box[WISP_SLICE][6];   ///< lower x, y, z, then upper x, y, z, in m
    int32_t above[WISP_SLICE];  ///< report only items with a higher index than this
    int32_t* found[WISP_SLICE]; ///< output lists; the caller sets the first, each other list starts 8 entries after
                                ///< the end of the previous one
    int found_count[WISP_SLICE];
} wisp_aabb_group;

/// Maximum number of slots that are compared with several queries at once.
#define WISP_MAX_SHARED_AABBS 1024

/// Neighbour lists, interleaved by slice: entry k of slice s is entries[8 (begin[s] + k) ..], one query per lane.
typedef struct wisp_neighbour_list
{
    const int32_t* begin;   ///< [slice_count] first entry
    const int32_t* length;  ///< [slice_count] entries per lane
    const int32_t* entries; ///< [entry][8] slots of the neighbours times 4; shorter lists are padded with the lane's
                            ///< own slot
} wisp_neighbour_list;

/// Distances of reference pairs, stored for the brake.
typedef struct wisp_reference_pairs
{
    float* distance;   ///< [entry][8] m, r0; larger than any radius in padding, so that g(r0) is 0
    float* weight_sum; ///< [slot] sum of g(r0)
    int32_t* near;     ///< [slice] number of pairs with a distance above 0 and below the radius
} wisp_reference_pairs;

/// Arguments of pairwise adhesion with a gap-keeping brake (Kim 2026, eq. 14-19): one Jacobi iteration in two
/// sweeps. Each lane adds its entries in list order, so sums do not depend on the lane width.
typedef struct wisp_adhesion_args
{
    const float* current;         ///< [slot][4] p(k)
    float* tentative;             ///< [slot][4] p(k) + Dp(k); output of the first sweep, input of the second
    float* displacement;          ///< [slice][3][8] Dp(k), after the guard
    float* next;                  ///< [slot][4] p(k+1)
    const float* search_position; ///< [slot][4] positions at the last search of the attracting lists
    const int32_t* owner;         ///< [slot] index of the strand
    const int32_t* vertex;        ///< [slot] index of the vertex in its strand; 0 is the root, which does not move
    wisp_neighbour_list attracting[2]; ///< lists of the first sweep, summed in this order
    int attracting_count;
    wisp_neighbour_list reference; ///< list of the second sweep: neighbours at the reference shape
    wisp_reference_pairs* pairs;   ///< of `reference`
    bool stores_pairs;             ///< the first sweep runs over `reference` alone and fills `pairs`
    float search_margin;   ///< m, a vertex that has moved farther than this since the last search needs a new one
    uint8_t* needs_search; ///< [slice] one bit per lane, set by the second sweep, or by the first if there is no
                           ///< brake
    wisp_random_key key;
    uint32_t iteration;
    float radius;       ///< h, m
    float step;         ///< sigma, m
    float distance_min; ///< r_min, m; minimum distance that the guard keeps between vertices of a pair
    float lambda_min;   ///< minimum of the brake's factor, reached where the distance changes by h
    bool planar;        ///< all z are 0
    bool in_plane;      ///< vertices move along x and y only
    bool brakes;        ///< there is a second sweep
} wisp_adhesion_args;

/// Arguments of time integration of particles (Mueller et al. 2007, algorithm 1). Pinned particles keep their
/// position; their velocity is not changed.
typedef struct wisp_particle_args
{
    float* position;        ///< [slot][4] m, inverse mass in 1/kg
    float* previous;        ///< [slot][4] m, at the start of the substep
    float* velocity;        ///< [slot][4] m/s, the fourth component is 0
    wisp_vec3 acceleration; ///< m/s^2, of every particle that is not pinned
    float dt;               ///< s
} wisp_particle_args;

/// Arguments of moments of particles at two times.
typedef struct wisp_moment_args
{
    const float* position; ///< [slot][4] m, inverse mass in 1/kg
    const float* previous; ///< [slot][4] m, at the other time; may be the position
    const float* velocity; ///< [slot][4] m/s
    wisp_vec3 origin;      ///< m, reference point of all moments; a point near the body reduces rounding
} wisp_moment_args;

/// Sums over particles with inverse masses above 0, with p from the origin to the position, x to the previous one.
typedef struct wisp_moments
{
    double mass;                ///< kg
    double pinned;              ///< number of the other particles
    double first[3];            ///< kg m, m p
    double previous[3];         ///< kg m, m x
    double momentum[3];         ///< kg m/s, m v
    double angular_momentum[3]; ///< kg m^2/s, m x x v
    double mixed[3][3];         ///< kg m^2, m p_a x_b
} wisp_moments;

/// Arguments of a small rotation: row += angle x (position - centre), rounded once. Particles with inverse mass 0 keep theirs.
typedef struct wisp_turn_args
{
    const float* position; ///< [slot][4] m, inverse mass in 1/kg
    float* rows;           ///< [slot][4] positions or velocities; the fourth component is kept
    double angle[3];       ///< rad, or rad/s for velocities
    double centre[3];      ///< m
} wisp_turn_args;

/// Arguments of the check that positions and velocities of particles are finite and bounded.
typedef struct wisp_bound_args
{
    const float* position; ///< [slot][4] m
    const float* velocity; ///< [slot][4] m/s
    float bound;           ///< maximum magnitude of x, y and z
} wisp_bound_args;

typedef struct wisp_kernels
{
    const char* isa; ///< "baseline", "avx2" or "avx512"; tests have two more
    void ( *strand_jitter )( const wisp_strand_jitter_args* args, int group_begin, int group_end );
    void ( *strand_align )( const wisp_strand_align_args* args, int group_begin, int group_end );
    void ( *strand_unpack )( const wisp_strand_unpack_args* args, int group_begin, int group_end );
    /// Find neighbours of queries [8 slice, 8 slice + count), count <= 8.
    void ( *range_search )( const wisp_range_search_args* args, int slice, int count,
                            wisp_range_search_result* result );
    /// Interleave eight lists; shorter lists are padded with the query's own slot.
    /// @param lists [8][stride] as written by range_search; renamed in place
    /// @param rename [slot] index to report for a slot; null: the slot itself
    /// @param packed [longest][8] output, with longest the maximum of counts
    void ( *interleave )( int32_t* lists, int stride, const int* counts, int slice, const int32_t* rename,
                          int32_t* packed );
    /// Find boxes that overlap the queries, touching included, among some runs of slots, in slot order. A group
    /// with one query appends to its list. Lists need room for all compared slots and 8 more.
    /// @param runs [run_count][2] first slot and the slot after the last. Whole groups of eight slots are compared,
    /// so the next run must not begin before the last group of this run ends
    void ( *box_overlap )( const wisp_aabb_stream* stream, const int32_t* runs, int run_count,
                           wisp_aabb_group* group );
    /// Sort distinct non-negative integers in increasing order, in time quadratic in count.
    /// @param items [count] padded by 8, padding may be overwritten
    /// @param out another array, padded likewise
    void ( *sort_items )( int32_t* items, int count, int32_t* out );
    /// Run one sweep of adhesion.
    /// @return maximum distance of a vertex from its position at the last search, m; 0 for a first sweep that a
    /// brake follows
    float ( *adhesion_attract )( const wisp_adhesion_args* args, int slice_first, int slice_last );
    float ( *adhesion_brake )( const wisp_adhesion_args* args, int slice_first, int slice_last );

    // links [begin, end), multiples of 8
    void ( *link_pbd )( const wisp_link_args* args, int begin, int end );
    void ( *link_xpbd )( const wisp_link_args* args, int begin, int end );
    /// clamps the length to [minimum, maximum] times rest
    void ( *link_limit )( const wisp_link_args* args, int begin, int end );
    /// Sum k (length - rest) length, with the stiffness of edges or of bend links. Padding adds nothing.
    /// @return N m
    double ( *link_virial )( const wisp_link_args* args, float edge_stiffness, float bend_stiffness, int begin,
                             int end );
    /// Positions and velocities of columns to lanes; positions alone if `velocity` is null. @return `pinned` of the arguments
    uint32_t ( *instances_load )( const wisp_instances_args* args );
    /// Positions, velocities and previous positions of some lanes to columns, or positions alone. @param lanes bit l: lane l
    void ( *instances_store )( const wisp_instances_args* args, uint32_t lanes );
    /// The end of a substep, as `velocity` and damping; the begin of the next one, as `accelerate` and `predict`.
    /// @return bits of lanes that do not end with finite numbers; 0 if a substep begins
    uint32_t ( *instances_advance )( const wisp_instances_args* args, bool ends, bool begins );
    void ( *instances_air )( const wisp_instances_args* args,
                             const wisp_instances_air_args* air ); ///< as `strip_air` and `blow`
    /// As `rigid_sums` and `rigid_approach`, a surface a lane. @param rigid, sums [lane] all but positions and velocities
    void ( *instances_rigid_sums )( const wisp_instances_args* args, const wisp_rigid_args* rigid, int begin, int end,
                                    wisp_rigid_sums* sums );
    void ( *instances_rigid_approach )( const wisp_instances_args* args, const wisp_rigid_args* rigid );
    /// @return bits of lanes with positions that are not finite
    uint32_t ( *instances_find_lost )( const wisp_instances_args* args );
    /// All links, as `link_pbd` or `link_xpbd` without multipliers.
    /// @param folds find bend links shorter than half their rest length @return bits of lanes that have some
    uint32_t ( *instances_link )( const wisp_instances_args* args, bool folds );
    // hinges [begin, end), multiples of 8
    void ( *hinge_dihedral )( const wisp_hinge_args* args, int begin, int end );
    void ( *hinge_isometric )( const wisp_hinge_args* args, int begin, int end );
    void ( *hinge_find_folds )( const wisp_fold_args* args, int begin, int end );
    // hinges [begin, end), multiples of 8; those of a group share no particle
    void ( *plate_measure_angles )( const wisp_plate_angle_args* args, int begin, int end );
    void ( *plate_couple_angles )( const wisp_plate_angle_args* args, int begin, int end );
    void ( *plate_add_moments )( const wisp_plate_angle_args* args, int begin, int end );
    // triangles [begin, end), multiples of 8; those of a group share no particle
    void ( *elastic_triangle_project )( const wisp_elastic_triangle_args* args, int begin, int end );
    /// @return J, the sum of F : dE/dF: three times pressure times volume of a closed surface at rest
    double ( *elastic_triangle_virial )( const wisp_elastic_triangle_args* args, int begin, int end );
    // slices of eight rows
    void ( *plate_predict )( const wisp_plate_move_args* args, int begin, int end );
    void ( *plate_impulse )( const wisp_plate_args* args, int begin, int end ); ///< b = - r Q x
    void ( *plate_begin )( const wisp_plate_args* args, int begin, int end );   ///< the first stage, y = gain W b
    void ( *plate_stage )( const wisp_plate_args* args, int begin, int end );
    /// @return the largest square of a move over the least height, at least 0; NaN is ignored
    float ( *plate_largest_move )( const wisp_plate_move_args* args, int begin, int end );
    void ( *plate_accelerate )( const wisp_plate_move_args* args, int begin, int end ); ///< v += scale moved / dt
    // slices of eight slots
    void ( *ring_gradient )( const wisp_ring_args* args, int begin, int end, wisp_ring_sums* sums );
    void ( *ring_normal )( const wisp_ring_args* args, int begin,
                           int end ); ///< area-weighted unit normals, 0 if they cancel
    /// Compute the normalised mean of the unit normals of the incident triangles, regardless of their areas; 0 if
    /// they cancel. Triangles without area, and those with a corner that is not finite, are skipped.
    /// @param xyzw [slot][4] output, the fourth component is 0
    void ( *ring_mean_normal )( const wisp_ring_args* args, int begin, int end, float* xyzw );
    /// Sum drag and lift over steps of strips. Triangles without area, and those with a corner that is not finite, are skipped.
    void ( *strip_air )( const wisp_strip_air_args* args, int begin, int end );
    /// Apply the sums to the velocities of slices.
    void ( *blow )( const wisp_strip_air_args* args, int begin, int end );
    void ( *push )( const wisp_push_args* args, int begin, int end );
    // points, multiples of 8
    /// Compute weighted points and normals.
    /// @return number of points whose normal was kept, padding included
    int ( *blend_two )( const wisp_blend_args* args, int begin, int end ); ///< reads only the first two parents
    int ( *blend_three )( const wisp_blend_args* args, int begin, int end );
    // slices of eight elements
    void ( *check_edge_extents )( const wisp_extent_args* args, int begin, int end );
    void ( *check_triangle_extents )( const wisp_extent_args* args, int begin, int end );
    // groups of eight pairs
    void ( *closest_triangle )( const wisp_closest_args* args, int begin, int end );
    void ( *closest_segments )( const wisp_closest_args* args, int begin, int end );
    /// Compute edge vectors and centres of the primitives of packs [begin, end).
    /// @param points per primitive: 1, 2 or 3
    void ( *place_primitives )( const float* xyzw, wisp_primitive_pack* rows, int points, int begin, int end );
    /// Find pairs of edges that may be within max_distance: pairs without a common point that no plane
    /// perpendicular to the line through their centres separates by max_distance. No pair within the distance is
    /// missed, except for rounding. NaN and infinity count as within.
    /// @param count of batch, at most WISP_PRIMITIVE_BATCH
    /// @param to output
    /// @return number of pairs
    int ( *find_near_edges )( const wisp_primitive_near_args* batch, int count, const wisp_primitive_pairs* to );
    /// Find pairs of points and triangles in the same way.
    int ( *find_near_points )( const wisp_primitive_near_args* batch, int count, const wisp_primitive_pairs* to );
    // points, begin a multiple of 8
    /// Sum displacements; up to a thousand are summed in floats. A displacement with a component beyond 1e6 m or
    /// NaN is skipped.
    /// @param sum [3] m, output
    /// @return whether a point has inverse mass 0
    bool ( *sum_displacements )( const wisp_displacement_args* args, int begin, int end, double sum[3] );
    /// Compute displacements and their uncertainty. A displacement longer than 1e6 m, or NaN, adds nothing to the
    /// uncertainty.
    void ( *measure_displacements )( const wisp_displacement_args* args, int begin, int end );
    /// Test predicted positions.
    /// @return whether a point deviates from its prediction by more than the uncertainty; false for NaN
    bool ( *exceeds_prediction )( const wisp_displacement_args* args, int begin, int end );
    // pairs [begin, end), multiples of 8
    void ( *max_approach )( const wisp_approach_args* args, int begin, int end );
    /// Find pairs of [begin, end) that may meet; only begin is a multiple of 8. NaN counts as active.
    /// @return number of pairs
    int ( *find_active_pairs )( const wisp_separation_args* args, int begin, int end );
    // packs of sixteen points, or of their pairs
    /// Predict the paths of points, and box them.
    void ( *predict_points )( const wisp_point_list_args* args, int begin, int end );
    /// Count the points that left their path by more than they may. @param progress part of the step, less a half
    int ( *count_strayed )( const wisp_point_list_args* args, float progress, int begin, int end );
    /// Find the points of pairs of packs [begin, end) whose paths come near, beside neighbours.
    void ( *list_point_pairs )( const wisp_point_list_args* args, int begin, int end );
    /// Find the pairs that come near on straight paths from start to now.
    void ( *find_near_pairs )( const wisp_point_pair_args* args, int begin, int end );
    /// Find the pairs that come nearer than their gap, and are too near along the line between them at the start. Compute the
    /// corrections that part them along that line, with Coulomb friction.
    /// @return whether there are any
    bool ( *push_points )( const wisp_point_pair_args* args, int begin, int end );
    /// Compute a lower bound of the distance between two sets of points.
    /// @return m, the largest gap along the given axes, at least -1; below 0 if no axis separates the sets. Points
    /// that are NaN are ignored
    float ( *separation )( const wisp_separating_axis_args* args );
    /// Compute the minimum and maximum of each component over some points, less those of other rows if `less` is
    /// given. NaN is ignored.
    /// @param point_x4 [count] points times 4, count a multiple of 8
    void ( *xyzw_range )( const float* xyzw, const float* less, const int32_t* point_x4, int count, float lower[4],
                          float upper[4] );
    // groups of eight particles
    void ( *half_space )( const wisp_half_space_args* args, int begin, int end );
    // slots, begin a multiple of 8; from end to the next multiple of 8, inverse masses are 0
    void ( *moments )( const wisp_moment_args* args, int begin, int end, wisp_moments* sums ); ///< sums: output
    void ( *turn )( const wisp_turn_args* args, int begin, int end );
    // slots, multiples of 8
    void ( *tether )( const wisp_tether_args* args, int begin, int end );
    void ( *motion_constraint )( const wisp_motion_constraint_args* args, int begin, int end );
    void ( *motion_targets )( const wisp_motion_target_args* args, int begin, int end );
    /// Carry points by a rigid motion: x += turn (x - origin) + shift; pinned ones too. Vectors get v += turn v.
    void ( *carry_points )( const wisp_carry_args* args, float* xyzw, int begin, int end );
    void ( *carry_vectors )( const wisp_carry_args* args, float* xyzw, int begin, int end );
    /// Scale velocities that are above a speed. @return number of velocities that were
    int ( *limit_speed )( float* velocity, float max_speed, int begin, int end );
    void ( *accelerate )( const wisp_particle_args* args, int begin, int end ); ///< v += dt acceleration
    void ( *predict )( const wisp_particle_args* args, int begin, int end );    ///< previous = p, p += dt v
    void ( *velocity )( const wisp_particle_args* args, int begin, int end );   ///< v += (p - (previous + dt v)) / dt
    void ( *vertex_drag )( const wisp_vertex_drag_args* args, int begin, int end ); ///< v += dt w force
    /// Sum the forces. @param sum [3] N, output
    void ( *sum_vertex_drag )( const wisp_vertex_drag_args* args, int begin, int end, double sum[3] );
    void ( *rigid_sums )( const wisp_rigid_args* args, int begin, int end, wisp_rigid_sums* sums ); ///< sums: output
    void ( *rigid_approach )( const wisp_rigid_args* args, int begin,
                              int end ); ///< v += fraction (linear + angular x r - v)
    /// Find groups of eight slots that must be gathered. The others are settled: in each slot the fourth component of
    /// `place` is negative, and both positions are nearer to `place` than it says.
    /// @return a bit for each group, at most WISP_BATCH_GROUPS
    uint32_t ( *find_unsettled )( const float* position, const float* previous, const float* place, int begin,
                                  int end );
    /// Gather groups of particles. Those move whose inverse mass is above 0 and whose positions are within 1e9 m.
    /// @return number of particles, a multiple of 8; 0 if none moves
    int ( *gather_particles )( const wisp_gather_args* args, int begin, int end );
    /// Transform gathered particles to the frame of a body and keep those that may touch it.
    /// @return number of candidates
    int ( *cull_particles )( const wisp_cull_args* args, int count );
    /// Find the closest points of a shape in closed form, with the bits of wisp_shape_closest().
    /// @param special_count receives the number of special ones
    /// @return number of candidates that are near
    int ( *query_shape )( const wisp_shape_query_args* args, int count, int32_t* special_count );
    /// Write half spaces. @param count multiple of 8 @return whether a particle was moved
    bool ( *half_space_rows )( const wisp_half_space_rows_args* args, int count );
    /// Find the half spaces of particles outside shapes and project them in one sweep. Slots are multiples of 8.
    /// @return a bit for each group that is left as it was: a path enters a shape, or two squeeze a particle
    uint32_t ( *stay_outside )( const wisp_outside_args* args, int begin, int end );
    /// The same of instances. @param shapes [count][lane / 8] @return a bit for each lane that cannot be done here
    uint32_t ( *instances_stay_outside )( const wisp_instances_args* args, const wisp_shape_lanes* shapes,
                                          int count );
    void ( *clear_particles )( const wisp_clear_args* args, int begin, int end );
    /// List the primitives of which a point may come within twice the thickness of a shape in the step. @return how many
    int ( *find_near_primitives )( const wisp_primitive_paths* args, int begin, int end, int32_t* near );
    /// Find the points of primitives that meet a shape that all share: where their path is stopped, or at its end, if that is near and
    /// deeper than the corners. A triangle meets it only in a point that is not on its border.
    /// @param thickness [count, padded to a multiple of 8] m; null: that of the shape @return how many meet it
    int ( *meet_shape )( const wisp_primitive_paths* args, const wisp_shape_lanes* shape, const float* thickness,
                         const int32_t* primitives, int count, wisp_primitive_meeting* out );
    /// Bound the paths of particles with inverse mass. @param lower, upper [3] m
    void ( *bound_paths )( const float* position, const float* previous, int begin, int end, float* lower,
                           float* upper );
    /// The same of instances. @param lower, upper [3][lane] m
    void ( *instances_bound_paths )( const wisp_instances_args* args, float* lower, float* upper );
    /// Find slots that have moved farther from `place` than its fourth component, whatever its sign.
    /// @param displaced [end - begin] output
    /// @return number of slots
    int ( *find_displaced )( const float* position, const float* place, int begin, int end, int32_t* displaced );
    /// List the numbers of counts that are 1, and of those that are larger. Both lists need room for 8 more.
    /// @param counts padded to a multiple of 8
    /// @return length of `single`
    int ( *list_counts )( const int32_t* counts, int count, int32_t* single, int32_t* several, int* several_count );
    /// Find a component that is NaN or beyond the bound.
    /// @return its slot, the first if there are several; `end` if there is none
    int ( *find_out_of_bounds )( const wisp_bound_args* args, int begin, int end );
    // groups of sixteen strands
    /// Begin a substep with history: extrapolate velocities, shift starts, choose the order of each strand.
    void ( *strand_extrapolate )( const wisp_strand_motion_args* args, int begin, int end );
    void ( *strand_predict )( const wisp_strand_motion_args* args, int begin, int end );
    /// Run strand_velocity of the last substep, strand_extrapolate with history, and strand_predict in one pass.
    /// @return as strand_velocity
    int ( *strand_advance )( const wisp_strand_motion_args* args, int begin, int end );
    /// @return number of strands with history that made the substep by implicit Euler, apart from their first one
    int ( *strand_velocity )( const wisp_strand_motion_args* args, int begin, int end );
    /// Find a component that is NaN or beyond the bound.
    /// @return its row, the first if there are several; `end` if there is none
    int ( *strand_find_out_of_bounds )( const wisp_strand_bound_args* args, int begin, int end );
    void ( *strand_damp )( const wisp_strand_damp_args* args, int begin, int end );
    void ( *strand_air )( const wisp_strand_air_args* args, int begin, int end );
    /// Make segments inextensible.
    /// @return number of strands that were reset to rest lengths from the root
    int ( *strand_stretch )( const wisp_strand_stretch_args* args, int begin, int end );
    void ( *strand_link )( const wisp_strand_link_args* args, int begin, int end );
    /// @return number of strands that links leave longer than at rest by more than this fraction
    int ( *strand_count_stretched )( const wisp_strand_link_args* args, float fraction, int begin, int end );
    void ( *strand_rod )( const wisp_strand_rod_args* args, int begin, int end );
    /// Begin an iteration, before the first body: set depths, clear sums, and compute the bounds of the group.
    void ( *strand_contact_begin )( const wisp_strand_contact_args* args, int group, bool first_iteration,
                                    wisp_strand_bounds* reach );
    void ( *strand_contact )( const wisp_strand_contact_args* args, int begin, int end );
    /// See a row from a body whose points are queried one by one.
    /// @param free [16] m, from `origin`, [3][16] in the frame of the body, on within which it does not come; null: none
    /// @return a bit for each vertex with inverse mass to which something may be near
    uint32_t ( *strand_see_row )( const wisp_strand_contact_args* args, int row, const float* free,
                                  const float* origin, wisp_strand_row* out );
    void ( *strand_target )( const wisp_strand_target_args* args, int begin, int end );
    void ( *strand_ghost )( const wisp_strand_ghost_args* args, int begin, int end );
    void ( *strand_ghost_blend )( const wisp_strand_ghost_args* args, int begin, int end ); ///< of several targets
    void ( *strand_curve )( const wisp_strand_curve_args* args, int begin, int end );
    // slices of eight rows
    /// Assemble the system.
    /// @return number of links without a direction, counted at either end
    int ( *spring_assemble )( const wisp_spring_args* args, int begin, int end );
    /// Potential (Noh and Jung, eq. 5 and the integral of eq. 12) that a motion from base_position to position adds.
    /// Reads links, plate and these two. Sums are of slices, in order.
    wisp_spring_gain ( *spring_gain )( const wisp_spring_args* args, int begin, int end );
    double ( *spring_product )( const wisp_conjugate_args* args, int begin, int end ); ///< q = A c; @return c . q
    /// r -= step q, s = S P S r; @return r . s
    double ( *conjugate_advance )( const wisp_conjugate_args* args, float step, int begin, int end );
    /// dv += step c, c = s + fraction c: completes a conjugate gradient iteration
    void ( *conjugate_update )( const wisp_conjugate_args* args, float step, float fraction, int begin, int end );
    // links of a coarse sheet [begin, end), multiples of 8
    void ( *level_prepare )( const wisp_level_link_args* args, int begin, int end );
    void ( *level_band )( const wisp_level_link_args* args, int begin, int end );
    void ( *level_link )( const wisp_level_link_args* args, int begin, int end );
    bool ( *level_is_torn )( const wisp_level_link_args* args, float most, int begin,
                             int end ); ///< a link has `most` times its length
    // rows of the coarsest sheet [begin, end), multiples of 8
    void ( *level_predict )( const wisp_level_rows_args* args, int begin, int end );
    void ( *level_finish )( const wisp_level_rows_args* args, int begin, int end );
    /// @return whether there is some, and more than half of it is left
    bool ( *level_add )( const wisp_level_added_args* args, int row_count );
    // slices of eight rows
    void ( *prolong )( const wisp_prolong_args* args, int begin, int end );
    // groups of eight points
    void ( *skin_linear )( const wisp_skin_args* args, int begin, int end );
    void ( *skin_dual_quaternion )( const wisp_skin_args* args, int begin, int end );
} wisp_kernels;

WISP_END_C
