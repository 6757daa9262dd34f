/// The case `stability`: hard cases of every solver.
#pragma once

#include "bench.h"

bench_case_fn stability_bench;
