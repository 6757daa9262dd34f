/// The closed form of a regular balloon: each link has tension k (l - d) and is s times as long as at rest,
///
///   p = sum( k l^2 ) ( s - 1 ) / ( 3 V_rest s^2 ),   V = s^3 V_rest,
///
/// and a gas: p V = n R T, which is p = P_atm ( V_0 - V ) / V, or p = P_atm ( V_0 - V ) / V_0 for the constraint of
/// compliance V_0 / P_atm. Exact for an icosahedron; finer spheres bulge a little where their links are short.
#pragma once

#include "balloon_scene.h"

typedef struct balloon_equilibrium
{
    double scale;    ///< s
    double pressure; ///< Pa above the atmosphere
    double volume;   ///< V_rest, m^3
} balloon_equilibrium;

/// @param def fill, atmosphere and stiffness count; fill > 1
/// @param is_linear the gas of the constraint, else p V = n R T
balloon_equilibrium balloon_equilibrium_of( const wisp_fabric* fabric, const wisp_balloon_def* def, bool is_linear );
/// The same with another amount of gas, in double precision. @param gas_ratio V_0 / V_rest, > 1
balloon_equilibrium balloon_equilibrium_at( const wisp_fabric* fabric, const wisp_balloon_def* def, double gas_ratio,
                                            bool is_linear );
