// What the contract of frozen hair states in numbers fails the run of the case "paper"; what a machine's speed decides is a note.
#include "unit.h"

#include "paper.h"

#include <math.h>

// A table with the sizes of the case. @param power of the number of vertices that the time grows with
static paper_table made_table( double power, double ms_per_thousand )
{
    static const int strands[PAPER_SIZES] = { 100, 300, 500, 2000, 10000, 50000 };
    paper_table table = {
        .variant_count = 2, .workers = { 1, 2 }, .clump_radius = 0.0042, .size_count = PAPER_SIZES
    };
    for ( int i = 0; i < PAPER_SIZES; ++i )
    {
        paper_line* line = &table.lines[i];
        line->strands = strands[i];
        line->vertices = 20 * strands[i];
        line->source_ms = 0.91 + 2.74e-3 * line->vertices;
        line->neighbours = 12.0;
        for ( int v = 0; v < 2; ++v )
        {
            line->ms[v].count = 5;
            line->ms[v].median = ms_per_thousand * pow( 1e-3 * line->vertices, power );
        }
    }
    return table;
}

static bool has_note( const results* all, const char* text )
{
    bool found = false;
    for ( int i = 0; i < all->note_count; ++i )
    {
        found = found || strstr( all->notes[i], text ) != NULL;
    }
    return found;
}

TEST( a_line_passes_however_slow_it_is )
{
    results all = { .failed = false };
    const paper_table table = made_table( 1.0, 500.0 );
    paper_report( &table, &all );
    assert_false( all.failed );
    assert_true( has_note( &all, "MISSED" ) );
    results_free( &all );
}

// How times grow depends on what else runs: it is told, and fails nothing.
TEST( time_that_is_no_line_is_a_claim_that_is_not_met )
{
    results all = { .failed = false };
    const paper_table table = made_table( 2.0, 0.05 );
    paper_report( &table, &all );
    assert_true( !all.failed && all.claim_count == 2 && all.claims_met == 0 );
    assert_true( has_note( &all, "with 2 workers is a line, R^2 above 0.98. Measured 0.9" ) );
    results_free( &all );
}

TEST( too_few_neighbours_fail )
{
    results all = { .failed = false };
    paper_table table = made_table( 1.0, 0.05 );
    table.lines[4].neighbours = 9.9;
    paper_report( &table, &all );
    assert_true( all.failed );
    assert_true( has_note( &all, "10000 strands have 9.9 neighbours per vertex, expected at least 10" ) );
    results_free( &all );
}
