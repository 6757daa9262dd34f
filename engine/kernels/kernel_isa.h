/// Every file of kernel_sources is compiled once an instruction set, with WISP_KERNEL_ISA naming it: the same function
/// has one symbol a table. Helpers stay static.
#pragma once

#include "lane_vec.h"

#include "wisp/kernels.h"

#define KERNEL( name ) LANE_JOIN( name##_, WISP_KERNEL_ISA )

void KERNEL( strand_jitter )( const wisp_strand_jitter_job* job, int group_begin, int group_end );
void KERNEL( strand_align )( const wisp_strand_align_job* job, int group_begin, int group_end );
void KERNEL( strand_unpack )( const wisp_strand_unpack_job* job, int group_begin, int group_end );
void KERNEL( range_search )( const wisp_range_search_job* job, int slice, int count,
                             wisp_range_search_result* result );
int64_t KERNEL( pair_distance )( const float* quads, const wisp_neighbour_list* list, float radius, float* distance,
                                 int slice_first, int slice_last );
float KERNEL( adhesion_attract )( const wisp_adhesion_job* job, int slice_first, int slice_last );
float KERNEL( adhesion_brake )( const wisp_adhesion_job* job, int slice_first, int slice_last );
