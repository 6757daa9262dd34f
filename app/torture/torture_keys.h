/// The keys of a scene from the tables that read them: which block a mapping is, and a random value for a key. A new
/// key of a table is tortured without another line here; a span below says where a value is sensible if its default
/// does not.
#pragma once

#include "scene_parts.h"
#include "text_tree.h"

#include <stdbool.h>
#include <stdint.h>

// ---- random numbers ----

/// A sequence for each scene of a seed, the same on every machine. No function of the C library takes part, whose last bit may
/// differ between machines.
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

// ---- the keys ----

/// The table of a mapping, and the struct with its defaults.
typedef struct torture_block
{
    const scene_block* table; ///< null: no table describes it
    const void* base;
} torture_block;

/// The block of the scene itself.
torture_block torture_block_of_scene( void );

/// The block of a value of a mapping, or of the items of that value if it is a list.
/// @param block of the mapping @param value the value of a key, or an item of it
torture_block torture_block_below( torture_block block, const char* key, const text_node* value );

/// Give a mapping random values for some of its keys, those without one.
/// @param percent of the keys
void torture_draw_keys( torture_random* random, torture_block block, int percent, text_node* map );
