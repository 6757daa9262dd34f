/// Motion constraints of one particle, in plain double precision: a largest distance from a target, and a sphere or half space behind it
/// (the motion and separation constraints of NvCloth, with the compliance of XPBD).
#pragma once

#include "double3.h"

typedef struct motion_oracle
{
    double3 target;           ///< m
    double max_distance;      ///< m; infinite: free
    double3 normal;           ///< of any length; 0: no backstop
    double backstop_distance; ///< m behind the target; infinite: no backstop
    double backstop_radius;   ///< m; infinite: a plane
    double stiffness[2];      ///< of distance and backstop, fraction of the error that is removed
    double alpha[2];          ///< 1/kg, compliance over the squared substep
    double lambda[2];         ///< N s^2, in and out; used only where alpha is above 0 and the multiplier is kept
} motion_oracle;

/// Project a particle of inverse mass w, first by the distance, C = |x - t| - d, then by the backstop: out of the sphere of radius r
/// about t - (b + r) n, or in front of the plane (x - t).n = -b.
double3 motion_oracle_project( motion_oracle* m, double3 x, double w, bool keeps_lambda );
