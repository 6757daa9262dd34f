/// Bending of a thin plate on a flat triangle mesh, in double precision: the equations of wisp/module/plate.h from gradients of
/// linear interpolants and the norm of the curvature tensor, without unfolding and without condensed rows.
#pragma once

#include "double3.h"

#include <stdbool.h>

/// E = 1/2 D sum of `stiffness` |x_i - x_j|^2 over the pairs.
typedef struct plate_oracle_pair
{
    int i, j;
    double stiffness; ///< 1/m^2, of either sign
} plate_oracle_pair;

typedef struct plate_oracle
{
    int pair_count;
    plate_oracle_pair* pairs; ///< by triangle, several for the same two vertices
    int* begin;               ///< [triangle_count + 1] first pair of a triangle
} plate_oracle;

/// @param rest [count] in one plane
/// @param triangles [triangle_count][3], wound alike
/// @param pinned [count] a triangle of three pinned vertices is rigid; null: none
plate_oracle plate_oracle_create( const double3* rest, int count, const int* triangles, int triangle_count,
                                  const bool* pinned );
void plate_oracle_destroy( plate_oracle* plate );

/// Q x, so that forces are -D times it. @param out [count] overwritten
void plate_oracle_multiply( const plate_oracle* plate, const double3* x, int count, double3* out );
/// E over D, of all and of one triangle.
double plate_oracle_energy( const plate_oracle* plate, const double3* x );
double plate_oracle_triangle_energy( const plate_oracle* plate, int triangle, const double3* x );
