#include "report_table.h"

#include "report_text.h"

#include <string.h>

// Sixteen hexadecimal digits, as every case writes a hash.
static bool is_hash( const char* cell )
{
    return strlen( cell ) == 16 && strspn( cell, "0123456789abcdef" ) == 16;
}

static const char* column_class( const results_table* table, int column )
{
    for ( int row = 1; row < table->row_count; ++row )
    {
        if ( is_hash( results_cell( table, row, column ) ) )
        {
            return " class=\"hash\"";
        }
    }
    return results_is_numeric_column( table, column ) ? " class=\"n\"" : "";
}

static void put_row( const results_table* table, int row, FILE* stream )
{
    fputs( "<tr>", stream );
    for ( int column = 0; column < table->column_count; ++column )
    {
        fputs( row == 0 ? "<th scope=\"col\"" : "<td", stream );
        fputs( column_class( table, column ), stream );
        fputc( '>', stream );
        report_put_prose( results_cell( table, row, column ), stream );
        fputs( row == 0 ? "</th>" : "</td>", stream );
    }
    fputs( "</tr>\n", stream );
}

void report_put_table( const results_table* table, int number, FILE* stream )
{
    fprintf( stream, "<section class=\"table\" id=\"table-%d\">\n<h3 id=\"table-%d-title\">", number, number );
    report_put_text( table->title, stream );
    // A region that scrolls has a name and can be reached by the keyboard.
    fprintf( stream,
             "</h3>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"table-%d-title\">\n"
             "<table class=\"data\">\n<thead>\n",
             number );
    for ( int row = 0; row < table->row_count; ++row )
    {
        fputs( row == 1 ? "</thead>\n<tbody>\n" : "", stream );
        put_row( table, row, stream );
    }
    fputs( table->row_count > 1 ? "</tbody>\n" : "</thead>\n", stream );
    fputs( "</table>\n</div>\n</section>\n", stream );
}
