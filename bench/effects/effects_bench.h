/// The case `effects`: an effect that is not requested costs nothing.
#pragma once

#include "bench.h"

#include "effects/effect_world.h"

typedef struct effects_plan
{
    const effects* all;
    effect_size size;
    int steps;      ///< steps before anything is compared or timed
    double seconds; ///< for the times of all effects
    int samples_max;
    const bench_options* options;
} effects_plan;

/// Every effect: on, with every module and with those in use; off; and not registered. A failure if plan, bits or
/// memory differ where they must not.
wisp_status effects_compare( const effects_plan* plan, results* out, wisp_error* error );
