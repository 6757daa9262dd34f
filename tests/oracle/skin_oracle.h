/// Skinning in plain double precision: each sum as it is printed.
#pragma once

#include "double3.h"

/// A bone in doubles: rows of the matrix, the last column is the translation.
typedef struct skin_oracle_bone
{
    double m[3][4];
} skin_oracle_bone;

/// Linear blend (Magnenat-Thalmann, Laperriere, Thalmann 1988): sum w_k M_k p.
/// @param weights [count] sum to 1
double3 skin_oracle_linear( const skin_oracle_bone* bones, const double* weights, int count, double3 p );

/// Dual quaternions (Kavan, Collins, Zara, O'Sullivan 2008): each bone as a unit dual quaternion, signs chosen so that real parts lie
/// on the side of that with the largest weight, the weighted sum divided by the length of its real part, applied to the point.
/// @param bones [count] rigid
double3 skin_oracle_dual_quaternion( const skin_oracle_bone* bones, const double* weights, int count, double3 p );
