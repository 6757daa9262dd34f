/// The benchmark's runner: a table of cases.
#pragma once

#include "bench_options.h"

typedef struct bench_case
{
    const char* name;
    const char* purpose; ///< one line
    bench_case_fn* run;
} bench_case;

/// The cases of cases.inc in their order.
const bench_case* bench_cases( int* count );
