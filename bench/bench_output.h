/// Charts of rows.
#pragma once

#include "results.h"

// Charts of rows that are in the results already, so that a chart always agrees with them.

/// A number of a row; NaN: it has none.
typedef double rows_number( const results_row* row );

/// The values of a chart and their rows. A series is a variant with a worker count, in the order of their first rows.
typedef struct rows_chart
{
    int first_row;         ///< rows before it belong to others
    const char* name;      ///< of the rows in the chart
    int workers;           ///< only rows with this many; 0: all, with the number in the names of series
    int min_steps;         ///< rows with fewer samples are left out of the drawing
    const char* also;      ///< a size that distinguishes series of one variant, such as "substeps"; may be null
    const char* also_unit; ///< text after that value

    const char *title, *x_label, *y_label, *caption; ///< caption: may be null
    rows_number *x, *y;
    bool x_linear, y_linear; ///< logarithmic otherwise
    bool is_front;           ///< unconnected points with their variants' names; the Pareto front of x and y is marked
} rows_chart;

void rows_chart_add( const rows_chart* chart, results* out );

double rows_ms( const results_row* row );
/// The row's error of that name, or NaN.
double rows_error( const results_row* row, const char* name );
double rows_vertices( const results_row* row );
