#include "contact_bench.h"

// Below this time in seconds all sizes and runs are smaller.
#define BRIEF_SECONDS 40.0
// From this time in seconds on, the folding cloth is that of the pictures.
#define FINE_SECONDS 240.0

contact_plan contact_default_plan( const bench_options* options )
{
    const double seconds = bench_seconds( options );
    const bool full = seconds >= 600.0, brief = seconds < BRIEF_SECONDS, fine = seconds >= FINE_SECONDS;
    return ( contact_plan ){
        .sheet_sides = { 32, brief ? 48 : 100, 316 },
        .sphere_levels = { 3, brief ? 4 : 5, 6 },
        .size_count = brief ? 2 : 3,
        .max_brute = brief ? 6e6 : 6e7,
        .query_seconds = full    ? 60.0
                         : brief ? 0.2 * seconds
                                 : 0.3 * seconds,
        .fold_side = fine    ? 64
                     : brief ? 16
                             : 24,
        .fold_steps = brief ? 40 : 300,
        .fold_seconds = 0.25 * seconds,
        .motion_seconds = 0.1 * seconds,
        .balloon_level = full    ? 3
                         : brief ? 1
                                 : 2,
        .balloon_steps = brief  ? 30
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
    static contact_fn* const tables[] = { contact_queries, contact_price, contact_motion, contact_balloons,
                                          contact_pictures };
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
    const wisp_status status = contact_bench_run( &plan, out, error );
    if ( status == WISP_OK && bench_seconds( options ) < BRIEF_SECONDS )
    {
        results_add_note( out,
                          "Contact: short of time, sheets of %d and %d per side and spheres two levels coarser are "
                          "searched, without the largest.",
                          plan.sheet_sides[0], plan.sheet_sides[1] );
        results_add_note( out,
                          "Contact: short of time, a cloth of %d per side folds for %d steps, and balloons one level "
                          "coarser are pressed for %d.",
                          plan.fold_side, plan.fold_steps, plan.balloon_steps );
    }
    return status;
}
