// The case `strands`: the suites in data/suites/strands, by size, settings and energy; guides and ghosts against full simulation
// (extension, not in Park and Kim 2024).
#include "strands_bench.h"

#include "suite/suite_folder.h"

#include <string.h>

// Below this time in seconds the largest suite is left out.
#define FULL_SECONDS 40.0

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

bench_case_fn strands_bench;

wisp_status strands_bench( const bench_options* options, results* out, wisp_error* error )
{
    static const char* const names[] = {
        "sizes", "bend_links", "rods", "energy", "guides", "guides_16384", "million"
    };
    const int first_row = out->row_count;
    const bool is_full = bench_seconds( options ) >= FULL_SECONDS;
    const wisp_status status = suite_bench_names( "strands", names, WISP_COUNT( names ) - ( is_full ? 0 : 1 ),
                                                  0.75 * bench_seconds( options ), options, out, error );
    strands_claim_million( first_row, out );
    if ( !is_full )
    {
        results_add_note( out, "Strands: short of time, the head with a million vertices is left out." );
    }
    return status;
}
