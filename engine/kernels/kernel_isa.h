/// Each file of kernel_sources is compiled once per instruction set, named by WISP_KERNEL_ISA. The same function
/// has one symbol per table. Helpers stay static.
#pragma once

#include "lane_vec.h"

#include "wisp/fabric.h"
#include "wisp/skin.h"
#include "wisp/module/kernels.h"

#include <float.h>

#define KERNEL( name ) LANE_JOIN( name##_, WISP_KERNEL_ISA )

/// Minimum squared length of a vector with a direction. Below it the vector loses significant digits.
#define KERNEL_MIN_SQUARED 1e-30f

void KERNEL( strand_jitter )( const wisp_strand_jitter_args* args, int group_begin, int group_end );
void KERNEL( strand_align )( const wisp_strand_align_args* args, int group_begin, int group_end );
void KERNEL( strand_unpack )( const wisp_strand_unpack_args* args, int group_begin, int group_end );
void KERNEL( range_search )( const wisp_range_search_args* args, int slice, int count,
                             wisp_range_search_result* result );
void KERNEL( interleave )( int32_t* lists, int stride, const int* counts, int slice, const int32_t* rename,
                           int32_t* packed );
void KERNEL( box_overlap )( const wisp_aabb_stream* stream, const int32_t* runs, int run_count,
                            wisp_aabb_group* group );
void KERNEL( sort_items )( int32_t* items, int count, int32_t* out );
float KERNEL( adhesion_attract )( const wisp_adhesion_args* args, int slice_first, int slice_last );
float KERNEL( adhesion_brake )( const wisp_adhesion_args* args, int slice_first, int slice_last );

void KERNEL( link_pbd )( const wisp_link_args* args, int begin, int end );
void KERNEL( link_xpbd )( const wisp_link_args* args, int begin, int end );
double KERNEL( link_virial )( const wisp_link_args* args, float edge_stiffness, float bend_stiffness, int begin,
                              int end );
uint32_t KERNEL( instances_load )( const wisp_instances_args* args );
void KERNEL( instances_store )( const wisp_instances_args* args, uint32_t lanes );
uint32_t KERNEL( instances_advance )( const wisp_instances_args* args, bool ends, bool begins );
void KERNEL( instances_air )( const wisp_instances_args* args, const wisp_instances_air_args* air );
void KERNEL( instances_rigid_sums )( const wisp_instances_args* args, const wisp_rigid_args* rigid, int begin,
                                     int end, wisp_rigid_sums* sums );
void KERNEL( instances_rigid_approach )( const wisp_instances_args* args, const wisp_rigid_args* rigid );
uint32_t KERNEL( instances_find_lost )( const wisp_instances_args* args );
uint32_t KERNEL( instances_link )( const wisp_instances_args* args, bool folds );
void KERNEL( link_limit )( const wisp_link_args* args, int begin, int end );
void KERNEL( hinge_dihedral )( const wisp_hinge_args* args, int begin, int end );
void KERNEL( hinge_isometric )( const wisp_hinge_args* args, int begin, int end );
void KERNEL( hinge_find_folds )( const wisp_fold_args* args, int begin, int end );
void KERNEL( plate_measure_angles )( const wisp_plate_angle_args* args, int begin, int end );
void KERNEL( plate_couple_angles )( const wisp_plate_angle_args* args, int begin, int end );
void KERNEL( plate_add_moments )( const wisp_plate_angle_args* args, int begin, int end );
void KERNEL( elastic_triangle_project )( const wisp_elastic_triangle_args* args, int begin, int end );
double KERNEL( elastic_triangle_virial )( const wisp_elastic_triangle_args* args, int begin, int end );
void KERNEL( plate_predict )( const wisp_plate_move_args* args, int begin, int end );
void KERNEL( plate_impulse )( const wisp_plate_args* args, int begin, int end );
void KERNEL( plate_begin )( const wisp_plate_args* args, int begin, int end );
void KERNEL( plate_stage )( const wisp_plate_args* args, int begin, int end );
float KERNEL( plate_largest_move )( const wisp_plate_move_args* args, int begin, int end );
void KERNEL( plate_accelerate )( const wisp_plate_move_args* args, int begin, int end );
void KERNEL( ring_gradient )( const wisp_ring_args* args, int begin, int end, wisp_ring_sums* sums );
void KERNEL( ring_normal )( const wisp_ring_args* args, int begin, int end );
void KERNEL( ring_mean_normal )( const wisp_ring_args* args, int begin, int end, float* xyzw );
void KERNEL( strip_air )( const wisp_strip_air_args* args, int begin, int end );
void KERNEL( blow )( const wisp_strip_air_args* args, int begin, int end );
void KERNEL( vertex_drag )( const wisp_vertex_drag_args* args, int begin, int end );
void KERNEL( sum_vertex_drag )( const wisp_vertex_drag_args* args, int begin, int end, double sum[3] );
int KERNEL( blend_two )( const wisp_blend_args* args, int begin, int end );
int KERNEL( blend_three )( const wisp_blend_args* args, int begin, int end );
void KERNEL( check_edge_extents )( const wisp_extent_args* args, int begin, int end );
void KERNEL( check_triangle_extents )( const wisp_extent_args* args, int begin, int end );
void KERNEL( closest_triangle )( const wisp_closest_args* args, int begin, int end );
void KERNEL( closest_segments )( const wisp_closest_args* args, int begin, int end );
void KERNEL( place_primitives )( const float* xyzw, wisp_primitive_pack* rows, int points, int begin, int end );
int KERNEL( find_near_edges )( const wisp_primitive_near_args* batch, int count, const wisp_primitive_pairs* to );
int KERNEL( find_near_points )( const wisp_primitive_near_args* batch, int count, const wisp_primitive_pairs* to );
bool KERNEL( sum_displacements )( const wisp_displacement_args* args, int begin, int end, double sum[3] );
void KERNEL( measure_displacements )( const wisp_displacement_args* args, int begin, int end );
bool KERNEL( exceeds_prediction )( const wisp_displacement_args* args, int begin, int end );
void KERNEL( max_approach )( const wisp_approach_args* args, int begin, int end );
int KERNEL( find_active_pairs )( const wisp_separation_args* args, int begin, int end );
void KERNEL( predict_points )( const wisp_point_list_args* args, int begin, int end );
int KERNEL( count_strayed )( const wisp_point_list_args* args, float progress, int begin, int end );
void KERNEL( list_point_pairs )( const wisp_point_list_args* args, int begin, int end );
void KERNEL( find_near_pairs )( const wisp_point_pair_args* args, int begin, int end );
bool KERNEL( push_points )( const wisp_point_pair_args* args, int begin, int end );
float KERNEL( separation )( const wisp_separating_axis_args* args );
void KERNEL( xyzw_range )( const float* xyzw, const float* less, const int32_t* point_x4, int count, float lower[4],
                           float upper[4] );
void KERNEL( half_space )( const wisp_half_space_args* args, int begin, int end );
void KERNEL( push )( const wisp_push_args* args, int begin, int end );
void KERNEL( tether )( const wisp_tether_args* args, int begin, int end );
void KERNEL( motion_constraint )( const wisp_motion_constraint_args* args, int begin, int end );
void KERNEL( motion_targets )( const wisp_motion_target_args* args, int begin, int end );
void KERNEL( carry_points )( const wisp_carry_args* args, float* xyzw, int begin, int end );
void KERNEL( carry_vectors )( const wisp_carry_args* args, float* xyzw, int begin, int end );
int KERNEL( limit_speed )( float* velocity, float max_speed, int begin, int end );
int KERNEL( find_out_of_bounds )( const wisp_bound_args* args, int begin, int end );
void KERNEL( accelerate )( const wisp_particle_args* args, int begin, int end );
void KERNEL( predict )( const wisp_particle_args* args, int begin, int end );
uint32_t KERNEL( find_unsettled )( const float* position, const float* previous, const float* place, int begin,
                                   int end );
int KERNEL( query_shape )( const wisp_shape_query_args* args, int count, int32_t* special_count );
bool KERNEL( half_space_rows )( const wisp_half_space_rows_args* args, int count );
uint32_t KERNEL( stay_outside )( const wisp_outside_args* args, int begin, int end );
uint32_t KERNEL( instances_stay_outside )( const wisp_instances_args* args, const wisp_shape_lanes* shapes,
                                           int count );
void KERNEL( clear_particles )( const wisp_clear_args* args, int begin, int end );
int KERNEL( find_near_primitives )( const wisp_primitive_paths* args, int begin, int end, int32_t* near );
int KERNEL( meet_shape )( const wisp_primitive_paths* args, const wisp_shape_lanes* shape, const float* thickness,
                          const int32_t* primitives, int count, wisp_primitive_meeting* out );
void KERNEL( bound_paths )( const float* position, const float* previous, int begin, int end, float* lower,
                            float* upper );
void KERNEL( instances_bound_paths )( const wisp_instances_args* args, float* lower, float* upper );
int KERNEL( list_counts )( const int32_t* counts, int count, int32_t* single, int32_t* several, int* several_count );
int KERNEL( gather_particles )( const wisp_gather_args* args, int begin, int end );
int KERNEL( cull_particles )( const wisp_cull_args* args, int count );
int KERNEL( find_displaced )( const float* position, const float* place, int begin, int end, int32_t* displaced );
void KERNEL( rigid_sums )( const wisp_rigid_args* args, int begin, int end, wisp_rigid_sums* sums );
void KERNEL( rigid_approach )( const wisp_rigid_args* args, int begin, int end );
void KERNEL( moments )( const wisp_moment_args* args, int begin, int end, wisp_moments* sums );
void KERNEL( turn )( const wisp_turn_args* args, int begin, int end );
void KERNEL( velocity )( const wisp_particle_args* args, int begin, int end );
void KERNEL( strand_extrapolate )( const wisp_strand_motion_args* args, int begin, int end );
void KERNEL( strand_predict )( const wisp_strand_motion_args* args, int begin, int end );
int KERNEL( strand_advance )( const wisp_strand_motion_args* args, int begin, int end );
int KERNEL( strand_velocity )( const wisp_strand_motion_args* args, int begin, int end );
int KERNEL( strand_find_out_of_bounds )( const wisp_strand_bound_args* args, int begin, int end );
void KERNEL( strand_damp )( const wisp_strand_damp_args* args, int begin, int end );
void KERNEL( strand_air )( const wisp_strand_air_args* args, int begin, int end );
int KERNEL( strand_stretch )( const wisp_strand_stretch_args* args, int begin, int end );
void KERNEL( strand_link )( const wisp_strand_link_args* args, int begin, int end );
int KERNEL( strand_count_stretched )( const wisp_strand_link_args* args, float fraction, int begin, int end );
void KERNEL( strand_rod )( const wisp_strand_rod_args* args, int begin, int end );
void KERNEL( strand_contact_begin )( const wisp_strand_contact_args* args, int group, bool first_iteration,
                                     wisp_strand_bounds* reach );
void KERNEL( strand_contact )( const wisp_strand_contact_args* args, int begin, int end );
uint32_t KERNEL( strand_see_row )( const wisp_strand_contact_args* args, int row, const float* free,
                                   const float* origin, wisp_strand_row* out );
void KERNEL( strand_target )( const wisp_strand_target_args* args, int begin, int end );
void KERNEL( strand_ghost )( const wisp_strand_ghost_args* args, int begin, int end );
void KERNEL( strand_ghost_blend )( const wisp_strand_ghost_args* args, int begin, int end );
void KERNEL( strand_curve )( const wisp_strand_curve_args* args, int begin, int end );
void KERNEL( level_prepare )( const wisp_level_link_args* args, int begin, int end );
void KERNEL( level_band )( const wisp_level_link_args* args, int begin, int end );
void KERNEL( level_link )( const wisp_level_link_args* args, int begin, int end );
bool KERNEL( level_is_torn )( const wisp_level_link_args* args, float most, int begin, int end );
void KERNEL( level_predict )( const wisp_level_rows_args* args, int begin, int end );
void KERNEL( level_finish )( const wisp_level_rows_args* args, int begin, int end );
bool KERNEL( level_add )( const wisp_level_added_args* args, int row_count );
void KERNEL( prolong )( const wisp_prolong_args* args, int begin, int end );
void KERNEL( skin_linear )( const wisp_skin_args* args, int begin, int end );
void KERNEL( skin_dual_quaternion )( const wisp_skin_args* args, int begin, int end );
int KERNEL( spring_assemble )( const wisp_spring_args* args, int begin, int end );
wisp_spring_gain KERNEL( spring_gain )( const wisp_spring_args* args, int begin, int end );
double KERNEL( spring_product )( const wisp_conjugate_args* args, int begin, int end );
double KERNEL( conjugate_advance )( const wisp_conjugate_args* args, float step, int begin, int end );
void KERNEL( conjugate_update )( const wisp_conjugate_args* args, float step, float fraction, int begin, int end );
