/// Springs between particles, linearised, and conjugate gradients over them without a matrix. Jobs of kernels.h.
///
/// Particles stand in *rows*, eight rows a slice; row_count is padded to 8 by rows without links. A row lists the other ends of its
/// links as entries of eight, one a lane, so each link is there once for either end: nothing is scattered, and a sum has
/// the order of the list whatever the lanes.
#pragma once

#include "wisp/base.h"
#include "wisp/module/surface_kernels.h"

WISP_BEGIN_C

/// Links of rows. Immutable while they are solved for.
typedef struct wisp_spring_links
{
    const int32_t*
        begin; ///< [2 slice_count + 1] first entry of a slice's links that stretch, of those that bend, ...
    const int32_t ( *other_x4 )[8]; ///< [entry] rows times 4; a lane's own row pads
    const float ( *rest )[8];       ///< [entry] m, > 0; 0 pads
    const float (
        *stiffness )[8]; ///< [entry] k of a link that stretches, N/m; k_b / L^2 of one that bends, N; 0 pads
    const float ( *ramp_stiffness )[8]; ///< [entry] c of a link that bends, N/m
    const float ( *damping )[8];        ///< [entry] k_d, N s/m
    const float ( *ramp_end )[8]; ///< [entry] length, over that at rest, from which a link that bends is an arc; for
                                  ///< spring_gain only
} wisp_spring_links;

/// Forces and their derivatives at a state, and the linear system of an implicit step (Noh and Jung, eq. 5-17):
///
///   A dv = b,  A_ij = -( K2 I + e e' + s^2 D weight I ),  A_ii = m I - sum A_ij
///   b = m ( v_start - v ) + s f + drag,  drag = s f_damping in a repeat, -( A - M ) v in the first solve
typedef struct wisp_spring_args
{
    wisp_spring_links links;
    wisp_plate_rows plate; ///< begin null: none
    float rigidity;        ///< N m, of the plate
    const float* position; ///< [row][4] m; mass, kg > 0
    const float* velocity; ///< [row][4] m/s; any
    const float*
        base_position; ///< [row][4] m, links then span places + seconds * velocities, whose differences floats keep
                       ///< better than those of positions; null: positions
    const float* start_velocity; ///< [row][4] m/s, what a repeat comes back to; not read in the first solve
    float dt;                    ///< s of the equations above
    float
        compression_margin; ///< share of its rest length that a link may lack and still be stiff, though it does not pull
    float max_stiffness; ///< N/m, k and c of links are no larger; 0: they are what they are
    bool is_repeat;
    float ( *axis )[4][8];    ///< [entry] e in sqrt(kg), K2 in kg
    float ( *rhs )[3][8];     ///< [slice] b, kg m/s
    float ( *inverse )[6][8]; ///< [slice] inverse of A_ii, 1/kg: xx, xy, xz, yy, yz, zz
} wisp_spring_args;

/// Potential of rows in a motion, of links whose stiffness is not clamped.
typedef struct wisp_spring_gain
{
    double gain;   ///< J, of links and plate at the position less that at the base position
    double stored; ///< J, of links at the position
} wisp_spring_gain;

/// Vectors of conjugate gradients over the springs. Directions are rows of four because neighbours are reached through an
/// index; everything else is streamed.
typedef struct wisp_conjugate_args
{
    wisp_spring_links links;
    wisp_plate_rows plate; ///< begin null: none
    float plate_rate;      ///< kg m^2: rigidity times s^2
    const float ( *axis )[4][8];
    const float ( *inverse )[6][8]; ///< the preconditioner P
    const float ( *filter )[6][8];  ///< [slice] S, what a row is free to do, as `inverse`
    const uint8_t* filtered;        ///< [slice] 0: S is the identity, and `filter` is not read
    float* direction;               ///< [row][4] c, and behind it the mass in kg, which stays
    float ( *product )[3][8];       ///< [slice] q = A c
    float ( *residual )[3][8];      ///< [slice] r, never filtered
    float ( *solution )[3][8];      ///< [slice] dv
    float ( *search )[3][8];        ///< [slice] S P S r
} wisp_conjugate_args;

WISP_END_C
