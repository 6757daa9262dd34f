#include "bench.h"

#include <stdio.h>
#include <string.h>

// Every case's function, then the table of them, from the one list.
#define BENCH_CASE( name, purpose, function ) bench_case_fn function;
#include "cases.inc"
#undef BENCH_CASE

// Run a case and say in one line how it went.
static wisp_status run_case( const char* name, bench_case_fn* run, const bench_options* options, results* out,
                             wisp_error* error )
{
    const int first_note = out->note_count, first_table = out->table_count, first_row = out->row_count;
    const int first_claim = out->claim_count, first_met = out->claims_met;
    const wisp_status status = run( options, out, error );
    int failures = 0;
    for ( int i = first_note; i < out->note_count; ++i )
    {
        failures += strncmp( out->notes[i], "FAILED", 6 ) == 0 ? 1 : 0;
    }
    char checks[64] = "all checks passed", claims[100] = "";
    if ( failures > 0 )
    {
        snprintf( checks, sizeof( checks ), "%d checks FAILED", failures );
    }
    if ( out->claim_count > first_claim )
    {
        snprintf( claims, sizeof( claims ), "; %d of %d claims of speed are met on this machine",
                  out->claims_met - first_met, out->claim_count - first_claim );
    }
    if ( status == WISP_OK )
    {
        results_add_headline( out, "%s: %s%s; %d measurements in %d tables.", name, checks, claims,
                              out->row_count - first_row, out->table_count - first_table );
    }
    return status;
}

#define BENCH_CASE( name, purpose, function )                                                                        \
    static wisp_status run_##function( const bench_options* options, results* out, wisp_error* error )               \
    {                                                                                                                \
        return run_case( name, function, options, out, error );                                                      \
    }
#include "cases.inc"
#undef BENCH_CASE

#define BENCH_CASE( name, purpose, function ) { name, purpose, run_##function },
static const bench_case all_cases[] = {
#include "cases.inc"
};
#undef BENCH_CASE

const bench_case* bench_cases( int* count )
{
    *count = WISP_COUNT( all_cases );
    return all_cases;
}
