/// Fully converged steps of triangle cloth: Newton's method on the nonlinear step, each of its linear systems by
/// CHOLMOD. Forces, derivatives and contact are the oracle's.
#pragma once

#include "oracle/triangle_oracle.h"

#include <suitesparse/cholmod.h>

typedef struct newton
{
    triangle_oracle* cloth; ///< owned by the caller, with the full jacobian and isotropic damping
    cholmod_common common;
    cholmod_triplet* triplets; ///< of the lower half of the filtered matrix, always in one order
    cholmod_factor* factor;    ///< its ordering is found once
    cholmod_dense* right;
    double3 *x_hat, *v_hat, *v, *trial, *missing, *scratch;

    double worst;       ///< largest residual of all steps so far, relative to the impulse of the cloth's weight
    long steps, solves; ///< so far
    long unconverged;   ///< steps that ended above NEWTON_TOLERANCE
} newton;

#define NEWTON_TOLERANCE 1e-10

/// @return WISP_NO_MEMORY
wisp_status newton_create( triangle_oracle* cloth, newton* out, wisp_error* error );
void newton_destroy( newton* n );

/// One step of triangle_oracle_step(), but converged. @param bodies may be null
/// @return WISP_CONFLICT the matrix is not positive definite: the step is too long
wisp_status newton_step( newton* n, double h, const triangle_oracle_bodies* bodies, wisp_error* error );
