/// Options of the commands of the program wisp-bench, `wisp bench`, `accuracy`, `sweep` and `merge`.
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
    BENCH_KEY_PICTURES,
    BENCH_KEY_REPORT,
    BENCH_KEY_SCENE,
    BENCH_KEY_LONG,
    BENCH_KEY_LENGTH,
    BENCH_KEY_SUITE,
    BENCH_KEY_SHARD,
    BENCH_KEY_SHARDS,
    BENCH_KEY_RESUME,
    BENCH_KEY_EXCLUSIVE,
};
