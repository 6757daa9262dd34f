// Rods that are closed: stiffness and factors of a ring, and its shape at rest.
#pragma once

#include "strand_rows.h"
#include "strands_state.h"

/// Bound of dt^2 EI / (m l^3), and of the same times the fourth power of the turn at a vertex of a curled rod.
static const double STRANDS_MAX_STIFFNESS = 6e4, STRANDS_MAX_CURLED = 0.08;

/// What the factors of a closed rod are made from.
typedef struct closed_factor_args
{
    const strands_rows* rows;
    const strands_settings* settings;
    float *stiffness, *factor, *response; // columns
    double dt;                            // s, of a substep
    double* work;                         // [2 * vertices]
} closed_factor_args;

/// Compute EI / L_i, the factors and the response of the joint of a strand.
/// @param row its first @param count vertices, the last of which is the first
void strands_factor_closed( const closed_factor_args* args, int row, int count, int lane );
