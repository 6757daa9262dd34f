/// `wisp validate`: scenes with an answer from outside, in theory or in measurements that others published, by every solver that can do them.
#pragma once

#include "accuracy/accuracy.h"

typedef struct validate_case
{
    const char *name, *title;
    accuracy_scene_fn* make;
    const char *tests, *left_out; ///< in words
    const char *formula, *source;
} validate_case;

/// All cases in their order.
const validate_case* validate_cases( int* count );

/// Run cases, and add their tables, charts and descriptions.
/// @param chosen a bit for each of validate_cases(); 0: all
/// @param summary [size] receives a sentence: which solvers come near theory
wisp_status validate_run( uint64_t chosen, const bench_options* options, results* out, char* summary, size_t size,
                          wisp_error* error );
