#include "report_drawing.h"

#include "report_text.h"

// Filled shapes of about one area around 0, told apart also where colours are not.
static const char* const marker_paths[REPORT_COLOURS] = {
    "M-4.5 0a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0z",
    "M-4 -4h8v8h-8z",
    "M0 -5.4L5.2 3.8H-5.2z",
    "M0 -5.8L5.8 0L0 5.8L-5.8 0z",
    "M0 5.4L5.2 -3.8H-5.2z",
    "M-1.8 -5.2h3.6v3.4h3.4v3.6h-3.4v3.4h-3.6v-3.4h-3.4v-3.6h3.4z",
    "M0 -5.2L5 -1.6L3.1 4.2H-3.1L-5 -1.6z",
    "M0 -6.4L1.8 -1.8L6.4 0L1.8 1.8L0 6.4L-1.8 1.8L-6.4 0L-1.8 -1.8z",
};

int report_marker_of( int series )
{
    return ( series + series / REPORT_COLOURS ) % REPORT_COLOURS;
}

void report_put_markers( FILE* stream )
{
    fputs( "<svg class=\"shapes\" width=\"0\" height=\"0\" aria-hidden=\"true\"><defs>\n", stream );
    for ( int i = 0; i < REPORT_COLOURS; ++i )
    {
        fprintf( stream, "<path id=\"m%d\" d=\"%s\"/>\n", i, marker_paths[i] );
    }
    fputs( "</defs></svg>\n", stream );
}

void report_put_series_class( int series, FILE* stream )
{
    fprintf( stream, "s%d%s", series % REPORT_COLOURS, series >= REPORT_COLOURS ? " dashed" : "" );
}

void report_put_key( const results_chart* chart, FILE* stream )
{
    fputs( "<ul class=\"key\">\n", stream );
    for ( int i = 0; i < chart->series_count; ++i )
    {
        const results_series* series = &chart->series[i];
        fputs( "<li><svg class=\"", stream );
        report_put_series_class( i, stream );
        fputs( "\" viewBox=\"0 0 30 16\" aria-hidden=\"true\">", stream );
        if ( chart->is_bars )
        {
            fputs( "<rect class=\"bar\" x=\"8\" y=\"1\" width=\"14\" height=\"14\"/>", stream );
        }
        else
        {
            fputs( series->is_joined ? "<path class=\"line\" d=\"M0 8H30\"/>" : "", stream );
            fprintf( stream, "<use href=\"#m%d\" x=\"15\" y=\"8\"/>", report_marker_of( i ) );
        }
        fputs( "</svg> ", stream );
        report_put_text( series->name, stream );
        fputs( "</li>\n", stream );
    }
    fputs( "</ul>\n", stream );
}

void report_put_tooltip( const results_chart* chart, int series, const results_point* point, FILE* stream )
{
    const char* const labels[2] = { chart->x_label, chart->y_label };
    const double values[2] = { point->x, point->y };
    fputs( "<title>", stream );
    report_put_text( chart->series[series].name, stream );
    if ( point->label[0] )
    {
        fputs( chart->series[series].name[0] ? ": " : "", stream );
        report_put_text( point->label, stream );
    }
    // Bars are numbered by x, which has no meaning for a reader.
    for ( int i = chart->is_bars ? 1 : 0; i < 2; ++i )
    {
        fputc( '\n', stream );
        report_put_short( values[i], stream );
        fputs( labels[i][0] ? " \xc2\xb7 " : "", stream );
        report_put_text( labels[i], stream );
    }
    fputs( "</title>", stream );
}
