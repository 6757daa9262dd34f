/// Compares the float engine with the double oracle, stage by stage and iteration by iteration.
///
/// A chain of stages amplifies rounding by factors that depend on the scene. So the oracle does not run in parallel
/// but follows the engine: each stage and each clump iteration of the oracle starts from the floats that the engine
/// had there (found by running the engine with the later stages off), and only one step is compared. The tolerance of
/// that step is a number of roundings, and of a clump iteration what the oracle itself makes of a move of its input by so much.
#pragma once

#include "frozen_hair_engine_fixture.h"

/// How close the differences came to the tolerance.
typedef struct hair_shadow
{
    double offset;   ///< m, the largest distance between engine and oracle in one step
    double fraction; ///< the largest offset / tolerance of a vertex; at most 1
    uint64_t neighbours, capped;
    uint64_t late;     ///< pairs found outside the lists, of the last command with all its iterations
    uint32_t searches; ///< of the last command with all its iterations
} hair_shadow;

/// Fails with the vertex if the engine differs from the oracle by more than the tolerance.
/// @param host may be null
/// @param commands earlier commands with the same parameters: the event number
hair_shadow hair_follow( const hair_host* host, const hair_groom* groom, const wisp_frozen_hair_def* def,
                         int commands );
