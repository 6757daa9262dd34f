/// Cases of balloons: a filled sphere, the pressure of rubber, the shape of a foil, the impulse of a jet, lift, and the speed of ascent.
#pragma once

#include "accuracy/accuracy.h"

accuracy_scene_fn validate_inflate;        ///< a filled sphere, against the closed form of its mesh
accuracy_scene_fn validate_rubber;         ///< the pressure of neo-Hookean spheres, over their limit point
accuracy_scene_fn validate_mylar;          ///< two discs that are filled, against the Mylar balloon
accuracy_scene_fn validate_jet;            ///< the speed that a jet gives, against the integral of Bernoulli's law
accuracy_scene_fn validate_lift_off;       ///< the load that helium lifts
accuracy_scene_fn validate_rising_balloon; ///< terminal speed of ascent

/// Edge of the mesh of a sphere whose radius is 1. It halves with each level.
static inline double validate_sphere_edge( int level )
{
    return 1.0514622242382672 / ( 1 << level ); // of an icosahedron; on a sphere the links are a little longer
}
