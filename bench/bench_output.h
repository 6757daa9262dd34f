/// What cases show: rows of tables, charts of rows, and pictures side by side.
#pragma once

#include "render.h"
#include "results.h"

// ---- rows of tables ----

/// Two numbers separated by a slash: the largest value and the mean.
void cells_put_pair( results_cells* row, double first, int first_digits, double second, int second_digits );

// ---- charts of rows ----

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
/// The row's size or error of that name, or NaN.
double rows_size( const results_row* row, const char* name );
double rows_error( const results_row* row, const char* name );
double rows_vertices( const results_row* row );

// ---- pictures ----

#define PICTURE_SHEET_MAX 8

/// Zero-initialised is empty.
typedef struct picture_sheet
{
    image pictures[PICTURE_SHEET_MAX];
    const char* labels[PICTURE_SHEET_MAX]; ///< owned by the caller
    int count;
    int columns; ///< 0: all in one row
} picture_sheet;

/// Shots that one camera sees, so that they can be compared.
typedef struct picture_shots
{
    /// The scene of a shot, valid until the next call.
    const render_scene* ( *scene )( void* context, int shot );
    void* context;
    int count;
    render_view view;
    int width, height; ///< pixels
    int samples;       ///< of a pixel; 0: the default
} picture_shots;

/// @param labels of the first shot; each further one is `label_distance` bytes behind. The caller keeps them
wisp_status picture_sheet_draw( const picture_shots* shots, const char* labels, size_t label_distance,
                                picture_sheet* sheet, wisp_error* error );

/// FOLDER/<name>.png. @return WISP_BAD_INPUT the folder's name is too long
wisp_status picture_path( const char* folder, const char* name, char* out, size_t size, wisp_error* error );

/// Write the sheet as FOLDER/<name>.png and link it with its caption; release the pictures in any case.
/// @param drawn the status of drawing; nothing is written unless it is WISP_OK
wisp_status picture_sheet_finish( picture_sheet* sheet, wisp_status drawn, const char* folder, const char* name,
                                  const char* caption, results* out, wisp_error* error );
