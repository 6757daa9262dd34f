/// Options of the commands that measure.
#pragma once

#include "commands.h"

enum
{
    BENCH_KEY_WORKERS = 'w',
    BENCH_KEY_FORMAT = 'f',
    BENCH_KEY_OUTPUT = 'o',
    BENCH_KEY_QUICK = 'q',
    BENCH_KEY_LIST = 'l',
    BENCH_KEY_SECONDS = OPTION_KEY,
    BENCH_KEY_REPORT,
    BENCH_KEY_LONG,
    BENCH_KEY_LENGTH,
    BENCH_KEY_SUITE,
    BENCH_KEY_SHARD,
    BENCH_KEY_EXCLUSIVE,
};

// Options of `wisp gate`.
enum
{
    GATE_KEY_NO_INSTRUCTIONS = 0x100,
    GATE_KEY_CYCLES,
    GATE_KEY_JUNIT,
    GATE_KEY_HTML,
    GATE_KEY_GITHUB,
    GATE_KEY_PATCH,
    GATE_KEY_STRICT,
    GATE_KEY_STEPS,
    GATE_KEY_ROW,
    GATE_KEY_ISA,
    GATE_KEY_PAIRED,
    GATE_KEY_TURNS,
    GATE_KEY_SLOW,
    GATE_KEY_TRIALS,
    GATE_KEY_PATIENCE,
};

// Options of `wisp torture`.
enum
{
    TORTURE_KEY_FORMAT = 'f',
    TORTURE_KEY_LIMIT = 256,
    TORTURE_KEY_TWIN,
    TORTURE_KEY_CLOSE,
};
