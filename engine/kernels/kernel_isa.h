/// Every file of kernel_sources is compiled once an instruction set, with WISP_KERNEL_ISA naming it: the same function
/// has one symbol a table. Helpers stay static.
#pragma once

#include "lane_vec.h"

#include "wisp/fabric.h"
#include "wisp/module/kernels.h"

#include <float.h>

#define KERNEL( name ) LANE_JOIN( name##_, WISP_KERNEL_ISA )

/// A squared length below this gives no direction: it loses digits, and then all of them.
#define KERNEL_LEAST_SQUARED 1e-30f

void KERNEL( strand_jitter )( const wisp_strand_jitter_job* job, int group_begin, int group_end );
void KERNEL( strand_align )( const wisp_strand_align_job* job, int group_begin, int group_end );
void KERNEL( strand_unpack )( const wisp_strand_unpack_job* job, int group_begin, int group_end );
void KERNEL( range_search )( const wisp_range_search_job* job, int slice, int count,
                             wisp_range_search_result* result );
void KERNEL( interleave )( int32_t* lists, int stride, const int* counts, int slice, const int32_t* rename,
                           int32_t* packed );
void KERNEL( box_overlap )( const wisp_box_stream* stream, const int32_t* runs, int run_count,
                            wisp_box_group* group );
void KERNEL( rank_order )( int32_t* items, int count, int32_t* out );
float KERNEL( adhesion_attract )( const wisp_adhesion_job* job, int slice_first, int slice_last );
float KERNEL( adhesion_brake )( const wisp_adhesion_job* job, int slice_first, int slice_last );

void KERNEL( link_pbd )( const wisp_link_job* job, int begin, int end );
void KERNEL( link_xpbd )( const wisp_link_job* job, int begin, int end );
void KERNEL( link_unilateral )( const wisp_link_job* job, int begin, int end );
void KERNEL( link_limit )( const wisp_link_job* job, int begin, int end );
void KERNEL( hinge_dihedral )( const wisp_hinge_job* job, int begin, int end );
void KERNEL( hinge_isometric )( const wisp_hinge_job* job, int begin, int end );
void KERNEL( ring_gradient )( const wisp_ring_job* job, int begin, int end, wisp_ring_sums* sums );
void KERNEL( ring_normal )( const wisp_ring_job* job, int begin, int end );
void KERNEL( ring_mean_normal )( const wisp_ring_job* job, int begin, int end, float* quads );
void KERNEL( ring_air )( const wisp_ring_air_job* job, int begin, int end );
int KERNEL( blend_two )( const wisp_blend_job* job, int begin, int end );
int KERNEL( blend_three )( const wisp_blend_job* job, int begin, int end );
void KERNEL( hold_edges )( const wisp_hold_job* job, int begin, int end );
void KERNEL( hold_triangles )( const wisp_hold_job* job, int begin, int end );
void KERNEL( closest_triangle )( const wisp_closest_job* job, int begin, int end );
void KERNEL( closest_segments )( const wisp_closest_job* job, int begin, int end );
void KERNEL( piece_place )( const float* quads, wisp_piece_row* rows, int points, int begin, int end );
int KERNEL( edges_near )( const wisp_piece_near_job* jobs, int count, const wisp_piece_pairs* to );
int KERNEL( points_near )( const wisp_piece_near_job* jobs, int count, const wisp_piece_pairs* to );
bool KERNEL( sum_ways )( const wisp_way_job* job, int begin, int end, double sum[3] );
void KERNEL( take_ways )( const wisp_way_job* job, int begin, int end );
bool KERNEL( leave_ways )( const wisp_way_job* job, int begin, int end );
void KERNEL( closing )( const wisp_closing_job* job, int begin, int end );
int KERNEL( slack_due )( const wisp_slack_job* job, int begin, int end );
float KERNEL( apart )( const wisp_apart_job* job );
void KERNEL( quad_range )( const float* quads, const float* less, const int32_t* point4, int count, float low[4],
                           float high[4] );
void KERNEL( half_space )( const wisp_half_space_job* job, int begin, int end );
void KERNEL( push )( const wisp_push_job* job, int begin, int end );
void KERNEL( tether )( const wisp_tether_job* job, int begin, int end );
int KERNEL( first_beyond )( const wisp_bound_job* job, int begin, int end );
void KERNEL( accelerate )( const wisp_particle_job* job, int begin, int end );
void KERNEL( predict )( const wisp_particle_job* job, int begin, int end );
int KERNEL( swarm_take )( const wisp_swarm_job* job, int begin, int end );
int KERNEL( swarm_see )( const wisp_swarm_sight* sight, int count );
int KERNEL( swarm_stray )( const float* position, const float* place, int begin, int end, int32_t* strays );
void KERNEL( rigid_sums )( const wisp_rigid_job* job, int begin, int end, wisp_rigid_sums* sums );
void KERNEL( rigid_approach )( const wisp_rigid_job* job, int begin, int end );
void KERNEL( velocity )( const wisp_particle_job* job, int begin, int end );
void KERNEL( strand_predict )( const wisp_strand_motion_job* job, int begin, int end );
void KERNEL( strand_advance )( const wisp_strand_motion_job* job, int begin, int end );
void KERNEL( strand_velocity )( const wisp_strand_motion_job* job, int begin, int end );
int KERNEL( strand_first_beyond )( const wisp_strand_bound_job* job, int begin, int end );
void KERNEL( strand_damp )( const wisp_strand_damp_job* job, int begin, int end );
void KERNEL( strand_air )( const wisp_strand_air_job* job, int begin, int end );
int KERNEL( strand_stretch )( const wisp_strand_stretch_job* job, int begin, int end );
void KERNEL( strand_link )( const wisp_strand_link_job* job, int begin, int end );
void KERNEL( strand_follow )( const wisp_strand_follow_job* job, int begin, int end );
void KERNEL( strand_rod )( const wisp_strand_rod_job* job, int begin, int end );
void KERNEL( strand_contact_begin )( const wisp_strand_contact_job* job, int group, bool first_iteration,
                                     wisp_strand_reach* reach );
void KERNEL( strand_contact )( const wisp_strand_contact_job* job, int begin, int end );
void KERNEL( strand_target )( const wisp_strand_target_job* job, int begin, int end );
void KERNEL( strand_ghost )( const wisp_strand_ghost_job* job, int begin, int end );
void KERNEL( strand_ghost_blend )( const wisp_strand_ghost_job* job, int begin, int end );
void KERNEL( strand_curve )( const wisp_strand_curve_job* job, int begin, int end );
void KERNEL( prolong )( const wisp_prolong_job* job, int begin, int end );
int KERNEL( spring_assemble )( const wisp_spring_job* job, int begin, int end );
double KERNEL( spring_product )( const wisp_conjugate_job* job, int begin, int end );
double KERNEL( conjugate_advance )( const wisp_conjugate_job* job, float step, int begin, int end );
void KERNEL( conjugate_turn )( const wisp_conjugate_job* job, float step, float share, int begin, int end );
