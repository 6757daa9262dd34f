/// Ladders of loads from 0.7 times a critical one to 1.3, each on a body of its own: which is the first that gives way?
#pragma once

#include <stdbool.h>

enum
{
    VALIDATE_LADDER = 31, ///< rungs of a fine one
};

/// A load, in critical ones. @param count of rungs
double validate_rung( int i, int count );
/// Half of the distance between two loads, in percent of the critical one.
double validate_ladder_doubt( int count );
/// Measure the load at which bodies give way: between the first that does and the one before. NaN: none gives way, or
/// the first one does.
/// @param has_lost [count] by rung @param measures that load, and the critical one
/// @return their distance, in percent of the critical one. Beyond the ladder it is at least the ladder's half
double validate_measure_ladder( const bool* has_lost, int count, double critical, double measures[2] );
