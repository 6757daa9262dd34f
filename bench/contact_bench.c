#include "contact_bench.h"

contact_plan contact_default_plan( const bench_options* options )
{
    const double seconds = bench_seconds( options );
    const bool full = seconds >= 600.0, brief = seconds < 40.0;
    return ( contact_plan ){
        .sheet_sides = { 32, 100, 316 },
        .sphere_levels = { 3, 5, 6 },
        .size_count = brief ? 2 : 3,
        .brute_most = 6e7,
        .query_seconds = full ? 60.0 : 0.3 * seconds,
        .fold_side = full ? 64 : 24,
        .fold_steps = brief ? 60 : 300,
        .fold_seconds = 0.25 * seconds,
        .balloon_level = full ? 3 : 2,
        .balloon_steps = brief  ? 60
                         : full ? 300
                                : 150,
        .balloon_seconds = 0.1 * seconds,
        .picture_side = 64,
        .picture_level = 4,
        .picture_steps = 300,
        .picture_pixels = 560,
        .teams = { { 1, options->workers }, options->workers > 1 ? 2 : 1 },
        .options = options,
    };
}

wisp_status contact_bench_run( const contact_plan* plan, results* out, wisp_error* error )
{
    static contact_fn* const tables[] = { contact_queries, contact_price, contact_balloons, contact_pictures };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( tables ) && status == WISP_OK; ++i )
    {
        status = tables[i]( plan, out, error );
    }
    return status;
}

wisp_status contact_bench( const bench_options* options, results* out, wisp_error* error )
{
    const contact_plan plan = contact_default_plan( options );
    return contact_bench_run( &plan, out, error );
}
