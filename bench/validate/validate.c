#include "validate.h"

#include "validate_overview.h"

static const double CASE_SECONDS = 20.0, CASE_SECONDS_QUICK = 3.0;

static void describe( const validate_case* c, results* out )
{
    const char* const header[] = { "case", c->title };
    const char* const lines[][2] = {
        { "tests", c->tests }, { "leaves out", c->left_out }, { "theory", c->formula }, { "source", c->source }
    };
    char title[160];
    snprintf( title, sizeof title, "Case `%s`", c->name );
    const int table = results_add_table( out, title, WISP_COUNT( header ), header );
    for ( int i = 0; i < WISP_COUNT( lines ); ++i )
    {
        results_add_cells( out, table, lines[i] );
    }
}

wisp_status validate_run( uint64_t chosen, const bench_options* options, results* out, char* summary, size_t size,
                          wisp_error* error )
{
    int count;
    const validate_case* cases = validate_cases( &count );
    const int overview = validate_begin_overview( out );
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        if ( chosen != 0 && ( chosen >> i & 1 ) == 0 )
        {
            continue;
        }
        const accuracy_entry entry = { cases[i].name, cases[i].title, cases[i].make, NULL };
        const double seconds = options->seconds > 0.0 ? options->seconds
                               : options->quick       ? CASE_SECONDS_QUICK
                                                      : CASE_SECONDS;
        const int first_row = out->row_count;
        describe( cases + i, out );
        status = accuracy_bench_run( &entry, 1, seconds, options, out, error );
        validate_add_to_overview( overview, cases[i].name, first_row, out );
    }
    validate_end_overview( overview, out, summary, size );
    return status;
}
