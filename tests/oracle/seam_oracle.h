/// A seam in plain double precision: pairs of particles held at a distance by XPBD (Macklin, Mueller, Chentanez 2016, eq. 17-18).
#pragma once

#include "double3.h"

typedef struct seam_oracle_pair
{
    double rest;    ///< m
    double3 lambda; ///< N s^2, on the first particle, in the substep; in and out
} seam_oracle_pair;

/// Move a rest distance towards that of the seam by at most `step`.
double seam_oracle_close( double rest, double distance, double step );

/// Project one pair. At rest > 0 the constraint is C = |a - b| - rest along n; at rest 0 it is the vector C = a - b.
/// @param w inverse masses @param alpha compliance / dt^2
void seam_oracle_project( seam_oracle_pair* pair, double3* a, double3* b, const double w[2], double alpha );

/// @return N, the tension of a pair in a substep of dt
double seam_oracle_force( const seam_oracle_pair* pair, double dt );
