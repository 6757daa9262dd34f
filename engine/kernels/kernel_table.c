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
    .link_pbd = KERNEL( link_pbd ),
    .link_xpbd = KERNEL( link_xpbd ),
    .link_unilateral = KERNEL( link_unilateral ),
    .link_limit = KERNEL( link_limit ),
    .hinge_dihedral = KERNEL( hinge_dihedral ),
    .hinge_isometric = KERNEL( hinge_isometric ),
    .ring_gradient = KERNEL( ring_gradient ),
    .ring_normal = KERNEL( ring_normal ),
    .push = KERNEL( push ),
    .tether = KERNEL( tether ),
    .accelerate = KERNEL( accelerate ),
    .predict = KERNEL( predict ),
    .velocity = KERNEL( velocity ),
    .strand_predict = KERNEL( strand_predict ),
    .strand_velocity = KERNEL( strand_velocity ),
    .strand_damp = KERNEL( strand_damp ),
    .strand_air = KERNEL( strand_air ),
    .strand_stretch = KERNEL( strand_stretch ),
    .strand_link = KERNEL( strand_link ),
    .strand_follow = KERNEL( strand_follow ),
    .strand_rod = KERNEL( strand_rod ),
    .strand_contact_begin = KERNEL( strand_contact_begin ),
    .strand_contact = KERNEL( strand_contact ),
    .strand_target = KERNEL( strand_target ),
    .strand_ghost = KERNEL( strand_ghost ),
    .strand_ghost_blend = KERNEL( strand_ghost_blend ),
    .strand_curve = KERNEL( strand_curve ),
    .spring_assemble = KERNEL( spring_assemble ),
    .spring_product = KERNEL( spring_product ),
    .conjugate_advance = KERNEL( conjugate_advance ),
    .conjugate_turn = KERNEL( conjugate_turn ),
    .prolong = KERNEL( prolong ),
};
