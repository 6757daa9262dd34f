// The case `paper`: the tables of Kim 2026 and of Noh and Jung, in turn, each with a part of the time.
#include "bench_options.h"
#include "paper_triangle.h"

bench_case_fn paper_frozen_hair;

static const struct paper_part
{
    bench_case_fn* run;
    double fraction; // of the time
} parts[] = {
    { paper_frozen_hair, 0.55 },
    { paper_triangle_cloth, 0.45 },
};

// A part reports its own progress.
typedef struct part_progress
{
    const bench_options* whole;
    double begin, fraction;
} part_progress;

static void pass_on( void* user, double fraction, const char* what )
{
    const part_progress* part = user;
    bench_progress( part->whole, part->begin + part->fraction * fraction, what );
}

wisp_status paper_bench( const bench_options* options, results* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    part_progress progress = { .whole = options };
    for ( int i = 0; i < WISP_COUNT( parts ) && status == WISP_OK; ++i )
    {
        progress.fraction = parts[i].fraction;
        bench_options part = *options;
        part.seconds = parts[i].fraction * bench_seconds( options );
        part.progress = pass_on;
        part.progress_user = &progress;
        status = parts[i].run( &part, out, error );
        progress.begin += progress.fraction;
    }
    return status;
}
