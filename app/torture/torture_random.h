/// Random numbers of the generator: a sequence for each scene of a seed, the same on every machine. No function of
/// the C library takes part, whose last bit may differ between machines.
#pragma once

#include <stdbool.h>
#include <stdint.h>

typedef struct torture_random
{
    uint64_t state;
} torture_random;

/// The sequence of scene number `number` of a seed.
torture_random torture_random_start( uint64_t seed, uint64_t number );

uint64_t torture_random_next( torture_random* random );

/// @return a whole number in [lower, upper]
int torture_random_whole( torture_random* random, int lower, int upper );

/// @return true with this probability
bool torture_random_chance( torture_random* random, int percent );

/// A number as a scene has it.
typedef struct torture_number
{
    char text[32];
} torture_number;

/// Draw from a linear scale, with a step of a fortieth of the range and three digits.
torture_number torture_random_linear( torture_random* random, double lower, double upper );

/// Draw from a logarithmic scale: 1, 2, 3, 5 or 7 times a power of ten.
/// @param lower > 0, at most upper
torture_number torture_random_log( torture_random* random, double lower, double upper );
