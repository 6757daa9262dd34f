/// The kernels, in the order of their table. Included with WISP_KERNEL( result, name, parameters... ), which makes members, prototypes or
/// rows of a table, and WISP_STRAND_KERNEL where those that need hair differ; therefore no include guard. Empty without it.
#if defined( WISP_KERNEL )
#if !defined( WISP_STRAND_KERNEL )
#define WISP_STRAND_KERNEL WISP_KERNEL
#endif

WISP_STRAND_KERNEL( void, strand_jitter, const wisp_strand_jitter_args* args, int group_begin, int group_end )
WISP_STRAND_KERNEL( void, strand_align, const wisp_strand_align_args* args, int group_begin, int group_end )
WISP_KERNEL( void, strand_unpack, const wisp_strand_unpack_args* args, int group_begin, int group_end )
/// Find neighbours of queries [8 slice, 8 slice + count), count <= 8.
WISP_KERNEL( void, range_search, const wisp_range_search_args* args, int slice, int count,
             wisp_range_search_result* result )
/// Interleave eight lists; shorter lists are padded with the query's own slot.
/// @param lists [8][stride] as written by range_search; renamed in place
/// @param rename [slot] index to report for a slot; null: the slot itself
/// @param packed [longest][8] output, with longest the maximum of counts
WISP_KERNEL( void, interleave, int32_t* lists, int stride, const int* counts, int slice, const int32_t* rename,
             int32_t* packed )
/// Find boxes that overlap the queries, touching included, among some runs of slots, in slot order. A group
/// with one query appends to its list. Lists need room for all compared slots and 8 more.
/// @param runs [run_count][2] first slot and the slot after the last. Whole groups of eight slots are compared,
/// so the next run must not begin before the last group of this run ends
WISP_KERNEL( void, box_overlap, const wisp_aabb_stream* stream, const int32_t* runs, int run_count,
             wisp_aabb_group* group )
/// Sort distinct non-negative integers in increasing order, in time quadratic in count.
/// @param items [count] padded by 8, padding may be overwritten
/// @param out another array, padded likewise
WISP_KERNEL( void, sort_items, int32_t* items, int count, int32_t* out )
/// Run one sweep of adhesion.
/// @return maximum distance of a vertex from its position at the last search, m; 0 for a first sweep that a
/// brake follows
WISP_KERNEL( float, adhesion_attract, const wisp_adhesion_args* args, int slice_first, int slice_last )
WISP_KERNEL( float, adhesion_brake, const wisp_adhesion_args* args, int slice_first, int slice_last )

// links [begin, end), multiples of 8
WISP_KERNEL( void, link_pbd, const wisp_link_args* args, int begin, int end )
WISP_KERNEL( void, link_xpbd, const wisp_link_args* args, int begin, int end )
/// clamps the length to [minimum, maximum] times rest
WISP_KERNEL( void, link_limit, const wisp_link_args* args, int begin, int end )
/// Sum k (length - rest) length, with the stiffness of edges or of bend links. Padding adds nothing.
/// @return N m
WISP_KERNEL( double, link_virial, const wisp_link_args* args, float edge_stiffness, float bend_stiffness, int begin,
             int end )
/// Sum |length / rest - 1| of edges. @param largest receives the largest
WISP_KERNEL( double, link_strain, const wisp_link_args* args, int begin, int end, float* largest )
/// Positions and velocities of columns to lanes; positions alone if `velocity` is null. @return `pinned` of the arguments
WISP_KERNEL( uint32_t, instances_load, const wisp_instances_args* args )
/// Positions, velocities and previous positions of some lanes to columns, or positions alone. @param lanes bit l: lane l
WISP_KERNEL( void, instances_store, const wisp_instances_args* args, uint32_t lanes )
/// The end of a substep, as `velocity` and damping; the begin of the next one, as `accelerate` and `predict`.
/// @return bits of lanes that do not end with finite numbers; 0 if a substep begins
WISP_KERNEL( uint32_t, instances_advance, const wisp_instances_args* args, bool ends, bool begins )
WISP_KERNEL( void, instances_air, const wisp_instances_args* args,
             const wisp_instances_air_args* air ) ///< as `strip_air` and `blow`
/// As `rigid_sums` and `rigid_approach`, a surface a lane. @param rigid, sums [lane] all but positions and velocities
WISP_KERNEL( void, instances_rigid_sums, const wisp_instances_args* args, const wisp_rigid_args* rigid, int begin,
             int end, wisp_rigid_sums* sums )
WISP_KERNEL( void, instances_rigid_approach, const wisp_instances_args* args, const wisp_rigid_args* rigid )
/// @return bits of lanes with positions that are not finite
WISP_KERNEL( uint32_t, instances_find_lost, const wisp_instances_args* args )
/// All links, as `link_pbd` or `link_xpbd` without multipliers.
/// @param folds find bend links shorter than half their rest length @return bits of lanes that have some
WISP_KERNEL( uint32_t, instances_link, const wisp_instances_args* args, bool folds )
// hinges [begin, end), multiples of 8
WISP_KERNEL( void, hinge_dihedral, const wisp_hinge_args* args, int begin, int end )
WISP_KERNEL( void, hinge_isometric, const wisp_hinge_args* args, int begin, int end )
WISP_KERNEL( void, hinge_find_folds, const wisp_fold_args* args, int begin, int end )
// hinges [begin, end), multiples of 8; those of a group share no particle
WISP_KERNEL( void, plate_measure_angles, const wisp_plate_angle_args* args, int begin, int end )
WISP_KERNEL( void, plate_couple_angles, const wisp_plate_angle_args* args, int begin, int end )
WISP_KERNEL( void, plate_add_moments, const wisp_plate_angle_args* args, int begin, int end )
// triangles [begin, end), multiples of 8; those of a group share no particle
WISP_KERNEL( void, elastic_triangle_project, const wisp_elastic_triangle_args* args, int begin, int end )
/// @return J, the sum of F : dE/dF: three times pressure times volume of a closed surface at rest
WISP_KERNEL( double, elastic_triangle_virial, const wisp_elastic_triangle_args* args, int begin, int end )
// slices of eight rows
WISP_KERNEL( void, plate_predict, const wisp_plate_move_args* args, int begin, int end )
WISP_KERNEL( void, plate_impulse, const wisp_plate_args* args, int begin, int end ) ///< b = - r Q x
WISP_KERNEL( void, plate_begin, const wisp_plate_args* args, int begin, int end )   ///< the first stage, y = gain W b
WISP_KERNEL( void, plate_stage, const wisp_plate_args* args, int begin, int end )
/// @return the largest square of a move over the least height, at least 0; NaN is ignored
WISP_KERNEL( float, plate_largest_move, const wisp_plate_move_args* args, int begin, int end )
WISP_KERNEL( void, plate_accelerate, const wisp_plate_move_args* args, int begin, int end ) ///< v += scale moved / dt
// slices of eight slots
WISP_KERNEL( void, ring_gradient, const wisp_ring_args* args, int begin, int end, wisp_ring_sums* sums )
WISP_KERNEL( void, ring_normal, const wisp_ring_args* args, int begin,
             int end ) ///< area-weighted unit normals, 0 if they cancel
/// Compute the normalised mean of the unit normals of the incident triangles, regardless of their areas; 0 if
/// they cancel. Triangles without area, and those with a corner that is not finite, are skipped.
/// @param xyzw [slot][4] output, the fourth component is 0
WISP_KERNEL( void, ring_mean_normal, const wisp_ring_args* args, int begin, int end, float* xyzw )
/// Sum drag and lift over steps of strips. Triangles without area, and those with a corner that is not finite, are skipped.
WISP_KERNEL( void, strip_air, const wisp_strip_air_args* args, int begin, int end )
/// Apply the sums to the velocities of slices.
WISP_KERNEL( void, blow, const wisp_strip_air_args* args, int begin, int end )
WISP_KERNEL( void, push, const wisp_push_args* args, int begin, int end )
// points, multiples of 8
/// Compute weighted points and normals.
/// @return number of points whose normal was kept, padding included
WISP_KERNEL( int, blend_two, const wisp_blend_args* args, int begin, int end ) ///< reads only the first two parents
WISP_KERNEL( int, blend_three, const wisp_blend_args* args, int begin, int end )
// slices of eight elements
WISP_KERNEL( void, check_edge_extents, const wisp_extent_args* args, int begin, int end )
WISP_KERNEL( void, check_triangle_extents, const wisp_extent_args* args, int begin, int end )
// groups of eight pairs
WISP_KERNEL( void, closest_triangle, const wisp_closest_args* args, int begin, int end )
WISP_KERNEL( void, closest_segments, const wisp_closest_args* args, int begin, int end )
/// Compute edge vectors and centres of the primitives of packs [begin, end).
/// @param points per primitive: 1, 2 or 3
WISP_KERNEL( void, place_primitives, const float* xyzw, wisp_primitive_pack* rows, int points, int begin, int end )
/// Find pairs of edges that may be within max_distance: pairs without a common point that no plane
/// perpendicular to the line through their centres separates by max_distance. No pair within the distance is
/// missed, except for rounding. NaN and infinity count as within.
/// @param count of batch, at most WISP_PRIMITIVE_BATCH
/// @param to output
/// @return number of pairs
WISP_KERNEL( int, find_near_edges, const wisp_primitive_near_args* batch, int count, const wisp_primitive_pairs* to )
/// Find pairs of points and triangles in the same way.
WISP_KERNEL( int, find_near_points, const wisp_primitive_near_args* batch, int count, const wisp_primitive_pairs* to )
// points, begin a multiple of 8
/// Sum displacements; up to a thousand are summed in floats. A displacement with a component beyond 1e6 m or
/// NaN is skipped.
/// @param sum [3] m, output
/// @return whether a point has inverse mass 0
WISP_KERNEL( bool, sum_displacements, const wisp_displacement_args* args, int begin, int end, double sum[3] )
/// Compute displacements and their uncertainty. A displacement longer than 1e6 m, or NaN, adds nothing to the
/// uncertainty.
WISP_KERNEL( void, measure_displacements, const wisp_displacement_args* args, int begin, int end )
/// Test predicted positions.
/// @return whether a point deviates from its prediction by more than the uncertainty; false for NaN
WISP_KERNEL( bool, exceeds_prediction, const wisp_displacement_args* args, int begin, int end )
// pairs [begin, end), multiples of 8
WISP_KERNEL( void, max_approach, const wisp_approach_args* args, int begin, int end )
/// Find pairs of [begin, end) that may meet; only begin is a multiple of 8. NaN counts as active.
/// @return number of pairs
WISP_KERNEL( int, find_active_pairs, const wisp_separation_args* args, int begin, int end )
// packs of sixteen points, or of their pairs
/// Predict the paths of points, and box them.
WISP_KERNEL( void, predict_points, const wisp_point_list_args* args, int begin, int end )
/// Count the points that left their path by more than they may. @param progress part of the step, less a half
WISP_KERNEL( int, count_strayed, const wisp_point_list_args* args, float progress, int begin, int end )
/// Find the points of pairs of packs [begin, end) whose paths come near, beside neighbours.
WISP_KERNEL( void, list_point_pairs, const wisp_point_list_args* args, int begin, int end )
/// Find the pairs that come near on straight paths from start to now.
WISP_KERNEL( void, find_near_pairs, const wisp_point_pair_args* args, int begin, int end )
/// Find the pairs that come nearer than their gap, and are too near along the line between them at the start. Compute the
/// corrections that part them along that line, with Coulomb friction.
/// @return whether there are any
WISP_KERNEL( bool, push_points, const wisp_point_pair_args* args, int begin, int end )
/// Compute a lower bound of the distance between two sets of points.
/// @return m, the largest gap along the given axes, at least -1; below 0 if no axis separates the sets. Points
/// that are NaN are ignored
WISP_KERNEL( float, separation, const wisp_separating_axis_args* args )
/// Compute the minimum and maximum of each component over some points, less those of other rows if `less` is
/// given. NaN is ignored.
/// @param point_x4 [count] points times 4, count a multiple of 8
WISP_KERNEL( void, xyzw_range, const float* xyzw, const float* less, const int32_t* point_x4, int count,
             float lower[4], float upper[4] )
// groups of eight particles
WISP_KERNEL( void, half_space, const wisp_half_space_args* args, int begin, int end )
// slots, begin a multiple of 8; from end to the next multiple of 8, inverse masses are 0
WISP_KERNEL( void, moments, const wisp_moment_args* args, int begin, int end, wisp_moments* sums ) ///< sums: output
WISP_KERNEL( void, turn, const wisp_turn_args* args, int begin, int end )
// slots, multiples of 8
WISP_KERNEL( void, tether, const wisp_tether_args* args, int begin, int end )
WISP_KERNEL( void, motion_constraint, const wisp_motion_constraint_args* args, int begin, int end )
WISP_KERNEL( void, motion_targets, const wisp_motion_target_args* args, int begin, int end )
/// Move points by a rigid motion: x += turn (x - origin) + shift; pinned ones too. Vectors get v += turn v.
WISP_KERNEL( void, move_points, const wisp_frame_motion_args* args, float* xyzw, int begin, int end )
WISP_KERNEL( void, turn_vectors, const wisp_frame_motion_args* args, float* xyzw, int begin, int end )
/// Scale velocities that are above a speed. @return number of velocities that were
WISP_KERNEL( int, limit_speed, float* velocity, float max_speed, int begin, int end )
WISP_KERNEL( void, accelerate, const wisp_particle_args* args, int begin, int end ) ///< v += dt acceleration
WISP_KERNEL( void, predict, const wisp_particle_args* args, int begin, int end )    ///< previous = p, p += dt v
WISP_KERNEL( void, velocity, const wisp_particle_args* args, int begin,
             int end ) ///< v += (p - (previous + dt v)) / dt
WISP_KERNEL( void, vertex_drag, const wisp_vertex_drag_args* args, int begin, int end ) ///< v += dt w force
/// Sum the forces. @param sum [3] N, output
WISP_KERNEL( void, sum_vertex_drag, const wisp_vertex_drag_args* args, int begin, int end, double sum[3] )
WISP_KERNEL( void, rigid_sums, const wisp_rigid_args* args, int begin, int end,
             wisp_rigid_sums* sums ) ///< sums: output
WISP_KERNEL( void, rigid_approach, const wisp_rigid_args* args, int begin,
             int end ) ///< v += fraction (linear + angular x r - v)
/// Find groups of eight slots that must be gathered. The others are settled: in each slot the fourth component of
/// `place` is negative, and both positions are nearer to `place` than it says.
/// @return a bit for each group, at most WISP_BATCH_GROUPS
WISP_KERNEL( uint32_t, find_unclear, const float* position, const float* previous, const float* place, int begin,
             int end )
/// Gather groups of particles. Those move whose inverse mass is above 0 and whose positions are within 1e9 m.
/// @return number of particles, a multiple of 8; 0 if none moves
WISP_KERNEL( int, gather_particles, const wisp_gather_args* args, int begin, int end )
/// Transform gathered particles to the frame of a body and keep those that may touch it.
/// @return number of candidates
WISP_KERNEL( int, cull_particles, const wisp_cull_args* args, int count )
/// Find the closest points of a shape in closed form, with the bits of wisp_shape_closest().
/// @param special_count receives the number of special ones
/// @return number of candidates that are near
WISP_KERNEL( int, query_shape, const wisp_shape_query_args* args, int count, int32_t* special_count )
/// Write half spaces. @param count multiple of 8 @return whether a particle was moved
WISP_KERNEL( bool, half_space_rows, const wisp_half_space_rows_args* args, int count )
/// Find the half spaces of particles outside shapes and project them in one sweep. Slots are multiples of 8.
/// @return a bit for each group that is left as it was: a path enters a shape, or two squeeze a particle
WISP_KERNEL( uint32_t, stay_outside, const wisp_outside_args* args, int begin, int end )
/// The same of instances. @param shapes [count][lane / 8] @return a bit for each lane that cannot be done here
WISP_KERNEL( uint32_t, instances_stay_outside, const wisp_instances_args* args, const wisp_shape_lanes* shapes,
             int count )
WISP_KERNEL( void, clear_particles, const wisp_clear_args* args, int begin, int end )
/// List the primitives of which a point may come within twice the thickness of a shape in the step: twice their number, and 1 if they may
/// get large. @return how many
WISP_KERNEL( int, list_near_primitives, const wisp_primitive_paths* args, int begin, int end, int32_t* near )
/// Select of those the ones that may come so near in the substep. @param near receives their numbers
/// @param looks receives bit 4 i of each shape i that they may meet @return how many
WISP_KERNEL( int, select_near_primitives, const wisp_primitive_paths* args, const int32_t* listed, int count,
             int32_t* near, int32_t* looks )
/// Find the points of primitives that meet a shape that all share: where their path is stopped, or at its end, if that is near and
/// deeper than the corners. A triangle meets it only in a point that is not on its border.
/// @param thickness [count, padded to a multiple of 8] m; null: that of the shape @return how many meet it
WISP_KERNEL( int, meet_shape, const wisp_primitive_paths* args, const wisp_shape_lanes* shape, const float* thickness,
             const int32_t* primitives, int count, wisp_primitive_meeting* out )
/// Bound the paths of particles with inverse mass. @param lower, upper [3] m
WISP_KERNEL( void, bound_paths, const float* position, const float* previous, int begin, int end, float* lower,
             float* upper )
/// The same of instances. @param lower, upper [3][lane] m
WISP_KERNEL( void, instances_bound_paths, const wisp_instances_args* args, float* lower, float* upper )
/// Find slots that have moved farther from `place` than its fourth component, whatever its sign.
/// @param displaced [end - begin] output
/// @return number of slots
WISP_KERNEL( int, find_displaced, const float* position, const float* place, int begin, int end, int32_t* displaced )
/// List the numbers of counts that are 1, and of those that are larger. Both lists need room for 8 more.
/// @param counts padded to a multiple of 8
/// @return length of `single`
WISP_KERNEL( int, list_counts, const int32_t* counts, int count, int32_t* single, int32_t* several,
             int* several_count )
/// Find a component that is NaN or beyond the bound.
/// @return its slot, the first if there are several; `end` if there is none
WISP_KERNEL( int, find_out_of_bounds, const wisp_bound_args* args, int begin, int end )
// groups of sixteen strands
/// Begin a substep with history: extrapolate velocities, shift starts, choose the order of each strand.
WISP_STRAND_KERNEL( void, strand_extrapolate, const wisp_strand_motion_args* args, int begin, int end )
WISP_STRAND_KERNEL( void, strand_predict, const wisp_strand_motion_args* args, int begin, int end )
/// Run strand_velocity of the last substep, strand_extrapolate with history, and strand_predict in one pass.
/// @return as strand_velocity
WISP_STRAND_KERNEL( int, strand_advance, const wisp_strand_motion_args* args, int begin, int end )
/// @return number of strands with history that made the substep by implicit Euler, apart from their first one
WISP_STRAND_KERNEL( int, strand_velocity, const wisp_strand_motion_args* args, int begin, int end )
/// Find a component that is NaN or beyond the bound.
/// @return its row, the first if there are several; `end` if there is none
WISP_STRAND_KERNEL( int, strand_find_out_of_bounds, const wisp_strand_bound_args* args, int begin, int end )
WISP_STRAND_KERNEL( void, strand_damp, const wisp_strand_damp_args* args, int begin, int end )
WISP_STRAND_KERNEL( void, strand_air, const wisp_strand_air_args* args, int begin, int end )
/// Make segments inextensible.
/// @return number of strands that were reset to rest lengths from the root
WISP_STRAND_KERNEL( int, strand_stretch, const wisp_strand_stretch_args* args, int begin, int end )
WISP_STRAND_KERNEL( void, strand_link, const wisp_strand_link_args* args, int begin, int end )
/// @return number of strands that links leave longer than at rest by more than this fraction
WISP_STRAND_KERNEL( int, strand_count_stretched, const wisp_strand_link_args* args, float fraction, int begin,
                    int end )
WISP_STRAND_KERNEL( void, strand_rod, const wisp_strand_rod_args* args, int begin, int end )
/// Begin an iteration, before the first body: set depths, clear sums, and compute the bounds of the group.
/// @param segments the same of sums of segments, with their lengths; null: none
WISP_STRAND_KERNEL( void, strand_contact_begin, const wisp_strand_contact_args* args,
                    const wisp_strand_contact_args* segments, int group, bool first_iteration,
                    wisp_strand_bounds* reach )
/// Find the next row with segments, each from a row to the one after it, whose way meets a box. NaN does not.
/// @param row, end rows, row < end @param lanes receives their bits @return the row; end - 1: none
WISP_STRAND_KERNEL( int, strand_find_segments, const wisp_strand_contact_args* args, int row, int end,
                    const wisp_strand_bounds* box, uint32_t* lanes )
WISP_STRAND_KERNEL( void, strand_contact, const wisp_strand_contact_args* args, int begin, int end )
/// Add the pushes of a group. @param sums [16] in and out, m, of a strand @return whether a vertex remains deeper than `shallow`
WISP_STRAND_KERNEL( bool, strand_contact_sum, const wisp_strand_contact_args* args, int group, float shallow, float* sums )
/// See a row from a body whose points are queried one by one.
/// @param free [16] m, from `origin`, [3][16] in the frame of the body, on within which it does not come; null: none
/// @return a bit for each vertex with inverse mass to which something may be near
WISP_STRAND_KERNEL( uint32_t, strand_see_row, const wisp_strand_contact_args* args, int row, const float* free,
                    const float* origin, wisp_strand_row* out )
WISP_STRAND_KERNEL( void, strand_target, const wisp_strand_target_args* args, int begin, int end )
WISP_STRAND_KERNEL( void, strand_ghost, const wisp_strand_ghost_args* args, int begin, int end )
WISP_STRAND_KERNEL( void, strand_ghost_blend, const wisp_strand_ghost_args* args, int begin,
                    int end ) ///< of several targets
WISP_STRAND_KERNEL( void, strand_curve, const wisp_strand_curve_args* args, int begin, int end )
// slices of eight rows
/// Assemble the system.
/// @return number of links without a direction, counted at either end
WISP_KERNEL( int, spring_assemble, const wisp_spring_args* args, int begin, int end )
/// Potential (Noh and Jung, eq. 5 and the integral of eq. 12) that a motion from base_position to position adds.
/// Reads links, plate and these two. Sums are of slices, in order.
WISP_KERNEL( wisp_spring_gain, spring_gain, const wisp_spring_args* args, int begin, int end )
WISP_KERNEL( double, spring_product, const wisp_conjugate_args* args, int begin, int end ) ///< q = A c; @return c . q
/// r -= step q, s = S P S r; @return r . s
WISP_KERNEL( double, conjugate_advance, const wisp_conjugate_args* args, float step, int begin, int end )
/// dv += step c, c = s + fraction c: completes a conjugate gradient iteration
WISP_KERNEL( void, conjugate_update, const wisp_conjugate_args* args, float step, float fraction, int begin, int end )
// links of a coarse sheet [begin, end), multiples of 8
WISP_KERNEL( void, level_prepare, const wisp_level_link_args* args, int begin, int end )
WISP_KERNEL( void, level_band, const wisp_level_link_args* args, int begin, int end )
WISP_KERNEL( void, level_link, const wisp_level_link_args* args, int begin, int end )
WISP_KERNEL( bool, level_is_torn, const wisp_level_link_args* args, float most, int begin,
             int end ) ///< a link has `most` times its length
// rows of the coarsest sheet [begin, end), multiples of 8
WISP_KERNEL( void, level_predict, const wisp_level_rows_args* args, int begin, int end )
WISP_KERNEL( void, level_finish, const wisp_level_rows_args* args, int begin, int end )
/// @return whether there is some, and more than half of it is left
WISP_KERNEL( bool, level_add, const wisp_level_added_args* args, int row_count )
// slices of eight rows
WISP_KERNEL( void, prolong, const wisp_prolong_args* args, int begin, int end )
// groups of eight points
WISP_KERNEL( void, skin_linear, const wisp_skin_args* args, int begin, int end )
WISP_KERNEL( void, skin_dual_quaternion, const wisp_skin_args* args, int begin, int end )

#undef WISP_KERNEL
#undef WISP_STRAND_KERNEL
#endif
