#include "gate_page.h"

#include "io_file.h"

#include <stdio.h>
#include <string.h>

// px of a character of 11 px in the widest usual font, and around a text
static const int CHARACTER = 7, SPACE = 12;

static void put_part( FILE* out, int x, const char* text, const char* colour )
{
    const int width = CHARACTER * (int)strlen( text ) + SPACE;
    fprintf( out, "<rect x=\"%d\" width=\"%d\" height=\"20\" fill=\"%s\"/>", x, width, colour );
    fprintf( out, "<text x=\"%g\" y=\"14\" textLength=\"%d\">%s</text>\n", x + 0.5 * width, width - SPACE, text );
}

wisp_status gate_write_badge( const wisp_suite* suite, const gate_row_check* checks, const char* path,
                              wisp_error* error )
{
    static const char name[] = "wisp gate";
    const gate_verdict verdict = gate_verdict_of( suite, checks );
    const char* const words = gate_verdict_names[verdict];
    const char* const colour = verdict == GATE_PASS ? "#2a7a3b" : verdict == GATE_REGRESSION ? "#b3261e" : "#8a6100";
    const int first = CHARACTER * (int)strlen( name ) + SPACE;
    io_output output;
    const wisp_status status = io_output_open( path, &output, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    fprintf(
        output.stream,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"20\" role=\"img\" aria-label=\"%s: %s\">\n"
        "<title>%s: %s</title>\n"
        "<g fill=\"#fff\" text-anchor=\"middle\" font-family=\"Verdana,DejaVu Sans,sans-serif\" font-size=\"11\">\n",
        first + CHARACTER * (int)strlen( words ) + SPACE, name, words, name, words );
    put_part( output.stream, 0, name, "#444" );
    put_part( output.stream, first, words, colour );
    fputs( "</g>\n</svg>\n", output.stream );
    return io_output_end( &output, WISP_OK, error );
}
