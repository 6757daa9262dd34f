/// Compares the float engine with the double oracle, stage by stage and iteration by iteration.
///
/// A chain of stages amplifies rounding by factors that depend on the scene. So the oracle does not run in parallel
/// but follows the engine: each stage and each clump iteration of the oracle starts from the floats that the engine
/// had there (found by running the engine with the later stages off), and only one step is compared. The tolerance of
/// that step is derived, vertex by vertex, from the rounding of its operations; nothing is fitted.
/// frozen_hair_shadow_bounds.c has the derivations.
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

/// Compare the whole pipeline: no vertex may be farther from the oracle's than the oracle itself moves when its input
/// moves by the stages' tolerances (the largest of four random shifts of every coordinate).
void hair_compare_pipeline( const hair_groom* groom, const wisp_frozen_hair_def* def );

// Tolerances of one step, m per vertex; 0 demands equal bits.

/// Stage 1 from the floats of `base`.
void hair_bound_freeze( const hair_oracle* oracle, const double3* base, double* bound );
/// Stage 2 from the floats of `in`. Fails if the scene is so close to a threshold (of the reach, or of opposite
/// directions) that the two precisions may decide differently.
void hair_bound_align( const hair_oracle* oracle, const double3* in, double* bound );
/// One iteration of stage 3 from `in`, with an error of up to `in_bound` per vertex.
void hair_bound_clump( const hair_oracle* oracle, int iteration, const double3* reference, const double3* in,
                       const double* in_bound, double* bound );
