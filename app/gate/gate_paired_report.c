#include "gate_paired.h"

#include <math.h>

void gate_report_pairs( const wisp_suite* suite, const gate_pair_check* checks, results* out )
{
    static const char* const names[PACE_COUNT] = { "as fast", "in doubt", "not measurable", "slower" };
    const char* const header[] = { "row", "verdict", "time", "from", "to", "noise", "rounds" };
    const int table = results_add_table( out, "Time against the other program", WISP_COUNT( header ), header );
    int counts[PACE_COUNT] = { 0 };
    for ( int i = 0; i < suite->row_count; ++i )
    {
        const gate_pair_check* c = checks + i;
        char name[SUITE_MAX_NAME + SUITE_MAX_VARIANT + 2], cells[5][24];
        snprintf( name, sizeof name, "%s%s%s", suite->rows[i].name, suite->rows[i].variant[0] ? ", " : "",
                  suite->rows[i].variant );
        const double logs[] = { c->slower, c->lower, c->upper };
        for ( int k = 0; k < 3; ++k )
        {
            snprintf( cells[k], sizeof cells[k], "%+.1f %%", 100.0 * expm1( logs[k] ) );
        }
        snprintf( cells[3], sizeof cells[3], "%.1f %%", 100.0 * c->noise );
        snprintf( cells[4], sizeof cells[4], "%d", c->rounds );
        results_add_cells(
            out, table,
            ( const char* const[] ){ name, names[c->pace], cells[0], cells[1], cells[2], cells[3], cells[4] } );
        counts[c->pace] += 1;
        results_row* row = results_add_row( out, suite->rows[i].name, suite->rows[i].variant );
        if ( row != NULL )
        {
            results_put( &row->size, "is_slower", c->pace == PACE_SLOWER ? 1.0 : 0.0 );
            results_put( &row->size, "is_as_fast", c->pace == PACE_FINE ? 1.0 : 0.0 );
            results_put( &row->size, "ratio", exp( c->slower ) );
            results_put( &row->size, "ratio_lower", exp( c->lower ) );
            results_put( &row->size, "ratio_upper", exp( c->upper ) );
            results_put( &row->size, "noise", c->noise );
            results_put( &row->size, "rounds", c->rounds );
            results_put( &row->size, "p", c->p );
        }
    }
    const char* verdict = counts[PACE_SLOWER] > 0                                ? "regression"
                          : counts[PACE_DOUBT] + counts[PACE_NOT_MEASURABLE] > 0 ? "inconclusive"
                                                                                 : "pass";
    char line[200];
    snprintf( line, sizeof line, "gate %.80s: time: %s: %d rows", suite->name, verdict, suite->row_count );
    for ( int i = 0; i < PACE_COUNT; ++i )
    {
        results_append_count( line, sizeof line, counts[i], names[i] );
    }
    results_add_headline( out, "%s", line );
}
