#include "kernel_isa.h"

#define TEXT_NOW( name ) #name
#define TEXT( name ) TEXT_NOW( name )

extern const wisp_kernels LANE_JOIN( kernels_, WISP_KERNEL_ISA );

const wisp_kernels LANE_JOIN( kernels_, WISP_KERNEL_ISA ) = {
    .isa = TEXT( WISP_KERNEL_ISA ),
    .strand_jitter = KERNEL( strand_jitter ),
    .strand_align = KERNEL( strand_align ),
    .strand_unpack = KERNEL( strand_unpack ),
    .range_search = KERNEL( range_search ),
    .pair_distance = KERNEL( pair_distance ),
    .adhesion_attract = KERNEL( adhesion_attract ),
    .adhesion_brake = KERNEL( adhesion_brake ),
};
