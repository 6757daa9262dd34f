#include "effects/effects_bench.h"

bench_case_fn effects_bench;

wisp_status effects_bench( const bench_options* options, results* out, wisp_error* error )
{
    const double seconds = bench_seconds( options );
    effects all;
    wisp_status status = effects_read( &all, error );
    const effects_plan plan = {
        .all = &all,
        .size = { .side = 32, .level = 3, .strands = 500 },
        // A step of all four is a few milliseconds: longer ones would be interrupted by other processes.
        .together = { .side = 32, .level = 3, .strands = 200 },
        .steps = 20,
        .seconds = 0.6 * seconds,
        .samples_max = options->quick ? 400 : 2000,
        .options = options,
    };
    status = status == WISP_OK ? effects_compare( &plan, out, error ) : status;
    status = status == WISP_OK ? effects_together( &plan, out, error ) : status;
    effects_release( &all );
    return status;
}
