/// Membranes of a neo-Hookean solid that keeps its volume, in plain double precision: energy by invariants, the step of a triangle by
/// search, and balloons in closed form.
#pragma once

#include <stdbool.h>

typedef struct membrane_oracle_triangle
{
    double rest[3][3], position[3][3]; ///< m
    double inverse_mass[3];            ///< 1/kg
    double stiffness;                  ///< N/m: shear modulus times thickness
    bool tension_field;
} membrane_oracle_triangle;

/// N, the derivative of the energy by the corners, by differences.
void membrane_oracle_forces( const membrane_oracle_triangle* triangle, double out[3][3] );
/// A projection without stress before: F' minimises |F' - F|^2 / ( 2 m ) + h^2 E( F' ), m the largest eigenvalue of sum w D D', and
/// corners move by - w D h^2 dE/dF'. The two stretches of F' are found by halving intervals.
void membrane_oracle_project( membrane_oracle_triangle* triangle, double dt );

/// Pa in a spherical balloon whose radius is s times that at rest: 2 G / R ( 1 / s - 1 / s^7 ) (Green and Shield 1950, thin).
/// @param radius m, at rest
double membrane_oracle_sphere_pressure( double stiffness, double radius, double s );
/// The stretch at which that pressure is largest: 7^(1/6).
double membrane_oracle_limit_point( void );
