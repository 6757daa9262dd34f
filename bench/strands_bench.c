#include "strands_bench.h"

#include "suite/suite_folder.h"

#include <string.h>

enum
{
    SUITES = 4,
};

// Below this time in seconds fewer steps lead up to the times.
#define FULL_SECONDS 40.0

strands_plan strands_default_plan( const bench_options* options )
{
    bool is_full = bench_seconds( options ) >= FULL_SECONDS;
    return ( strands_plan ){
        .sizes = { 100, 300, 500, 2000, 10000, 50000 },
        .size_count = 6,
        .scenario_steps = is_full ? 60 : STRANDS_REFERENCE_STEPS,
        .scenario_strands = 2000,
        .few_settings_strands = is_full ? 10000 : 2000,
        .few_settings = is_full ? 3 : 1,
        .comparison_seconds = ( is_full ? 0.5 : 0.1 ) * bench_seconds( options ),
        .suite_count = is_full ? SUITES : SUITES - 1,
        .suite_seconds = 0.25 * bench_seconds( options ),
        .workers = { 1, options->workers },
        .worker_count = options->workers > 1 ? 2 : 1,
        .options = options,
    };
}

// ---- suites ----

#define CLAIM_FRAME_MS 5.0

static void add_claims( const results_row* row, results* out )
{
    static const char claim[] = "a million ghost vertices per frame, 1 : 16, 2 workers";
    char text[160];
    double ghosts = 0.0;
    for ( int i = 0; i < row->stages.count; ++i )
    {
        ghosts += strncmp( row->stages.items[i].name, "guide_hair.", 11 ) == 0 ? row->stages.items[i].value : 0.0;
    }
    snprintf( text, sizeof text, "%s, guides included: under %.0f ms", claim, CLAIM_FRAME_MS );
    results_add_claim( out, row->ms_median < CLAIM_FRAME_MS, text, row->ms_median, " ms" );
    snprintf( text, sizeof text, "%s, the ghosts alone: under %.0f ms", claim, CLAIM_FRAME_MS );
    results_add_claim( out, ghosts < CLAIM_FRAME_MS, text, ghosts, " ms" );
}

void strands_claim_million( int first_row, results* out )
{
    for ( int i = first_row; i < out->row_count; ++i )
    {
        const results_row* row = &out->rows[i];
        if ( strcmp( row->name, "accuracy.million" ) == 0 && strcmp( row->variant, "1 : 16" ) == 0 &&
             row->workers == 2 )
        {
            add_claims( row, out );
        }
    }
}

wisp_status strands_suites( const strands_plan* plan, results* out, wisp_error* error )
{
    static const char* const names[SUITES] = { "energy", "guides", "guides_16384", "million" };
    const int first_row = out->row_count;
    const wisp_status status =
        suite_bench_names( "strands", names, plan->suite_count, plan->suite_seconds, plan->options, out, error );
    strands_claim_million( first_row, out );
    if ( plan->suite_count < SUITES )
    {
        results_add_note( out, "Strands: short of time, the head with a million vertices is left out." );
    }
    return status;
}

wisp_status strands_bench_run( const strands_plan* plan, results* out, wisp_error* error )
{
    static const struct
    {
        wisp_status ( *make )( const strands_plan* plan, results* out, wisp_error* error );
        const char* what;
        double fraction; // of the case that is done when it begins
    } tables[] = {
        { strands_comparison, "strands by size", 0.0 },
        { strands_suites, "suites of strands", 0.7 },
    };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( tables ) && status == WISP_OK; ++i )
    {
        bench_progress( plan->options, tables[i].fraction, tables[i].what );
        status = tables[i].make( plan, out, error );
    }
    return status;
}

wisp_status strands_bench( const bench_options* options, results* out, wisp_error* error )
{
    strands_plan plan = strands_default_plan( options );
    return strands_bench_run( &plan, out, error );
}
