// The case `character`: the suite data/suites/character.yaml, and what each effect of the dressed figure costs in one table.
#include "accuracy/accuracy.h"
#include "cells.h"
#include "program_data.h"
#include "rows_chart.h"

#include <math.h>
#include <string.h>

bench_case_fn character_bench;

static void add_line( const results_row* row, const results_row* whole, int table, results* out )
{
    const double all = rows_error( row, "intersections" ),
                 with_body = rows_error( row, "intersections_with_driven_surfaces" );
    cells line = { .count = 0 };
    cells_put( &line, "%s", row->variant );
    cells_put_number( &line, rows_vertices( row ), 0 );
    cells_put_number( &line, rows_ms( row ), 2 );
    cells_put_number( &line, rows_ms( row ) / rows_ms( whole ), 2 );
    cells_put_number( &line, all - ( isfinite( with_body ) ? with_body : 0.0 ), 0 );
    cells_put_number( &line, with_body, 0 );
    cells_put_number( &line, rows_error( row, "stretch_max_percent" ), 1 );
    cells_end_row( &line, table, out );
}

// The first row of the suite is the whole scene.
static void add_summary( int first_row, int workers, results* out )
{
    char title[160];
    cells header = { .count = 0 };
    cells_put( &header, "setting" );
    cells_put( &header, "vertices" );
    cells_put( &header, "ms per step" );
    cells_put( &header, "/ whole" );
    cells_put( &header, "cloth through cloth" );
    cells_put( &header, "through the body" );
    cells_put( &header, "largest strain, %%" );
    snprintf(
        title, sizeof title,
        "The dressed figure without each effect: median of a step with %d worker%s, and intersections at the end",
        workers, workers == 1 ? "" : "s" );
    const int table = cells_begin_table( &header, title, out );
    const results_row* whole = NULL;
    for ( int i = first_row; i < out->row_count; ++i )
    {
        const results_row* row = &out->rows[i];
        if ( row->workers == workers && strcmp( row->name, "suite.character" ) == 0 )
        {
            whole = whole ? whole : row;
            add_line( row, whole, table, out );
        }
    }
}

wisp_status character_bench( const bench_options* options, results* out, wisp_error* error )
{
    char path[1024];
    const int first_row = out->row_count;
    program_data_path( "suites/character.yaml", path, sizeof path );
    const wisp_status status = suite_bench( path, options, out, error );
    if ( status == WISP_OK )
    {
        add_summary( first_row, options->workers > 1 ? options->workers : 1, out );
    }
    return status;
}
