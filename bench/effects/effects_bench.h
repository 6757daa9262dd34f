/// The case `effects`: an effect that is not requested costs nothing, and effects that share a world cost their sum.
#pragma once

#include "bench_options.h"

#include "effects/effect_world.h"

typedef struct effects_plan
{
    const effects* all;
    effect_size size;     ///< of each effect against itself
    effect_size together; ///< of the effects that share a world
    int steps;            ///< steps before anything is compared or timed
    double seconds;       ///< for the times of all effects; half as much again for those that share a world
    int samples_max;
    const bench_options* options;
} effects_plan;

/// Every effect: on, with every module and with those in use; off; and not registered. A failure if plan, bits or
/// memory differ where they must not.
wisp_status effects_compare( const effects_plan* plan, results* out, wisp_error* error );
/// Some effects in worlds of their own and in one together. A failure if one has other bits together with others.
wisp_status effects_together( const effects_plan* plan, results* out, wisp_error* error );
