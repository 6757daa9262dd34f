/// Charts of rows that the results hold already, so that no chart can say anything else than they do.
#pragma once

#include "results.h"

/// A number of a row; NaN: it has none.
typedef double rows_number( const results_row* row );

/// What a chart takes from which rows. A series is a variant with a worker count, in the order of their first rows.
typedef struct rows_chart
{
    int first_row;         ///< rows before it belong to others
    const char* name;      ///< of the rows it takes
    int workers;           ///< only rows with this many; 0: all, and the names of series say how many
    int min_steps;         ///< rows with fewer samples are left out of the drawing
    const char* also;      ///< a size whose value tells series of one variant apart, such as "substeps"; may be null
    const char* also_unit; ///< what follows that value

    const char *title, *x_label, *y_label, *caption; ///< caption: may be null
    rows_number *x, *y;
    bool x_linear, y_linear; ///< logarithmic otherwise
    bool
        is_front; ///< loose points with their variants' names; marked: no other has less of x or y and no more of the other
} rows_chart;

void rows_chart_add( const rows_chart* chart, results* out );

double rows_ms( const results_row* row );
/// The row's size or error of that name, or NaN.
double rows_size( const results_row* row, const char* name );
double rows_error( const results_row* row, const char* name );
double rows_vertices( const results_row* row );
