#include "report.h"

#include "io_file.h"
#include "page.h"
#include "report_data.h"

#include "wisp/module/definition.h"

#include <errno.h>
#include <math.h>
#include <string.h>

static const char failure_mark[] = "FAILED: ";

static bool is_failure( const char* note )
{
    return strncmp( note, failure_mark, strlen( failure_mark ) ) == 0;
}

// Failures at the top, or notes at the end.
static int count_notes( const results* all, bool of_failures )
{
    int count = 0;
    for ( int i = 0; i < all->note_count; ++i )
    {
        count += is_failure( all->notes[i] ) == of_failures;
    }
    return count;
}

// ---- the head ----

static void put_fact( const char* name, const char* text, FILE* stream )
{
    fprintf( stream, "<dt>%s</dt><dd>", name );
    report_put_text( text, stream );
    fputs( "</dd>\n", stream );
}

// Nothing but the date changes between two runs of one build on one machine; the clock rate would.
static const char* known( const char* text )
{
    return text[0] ? text : "unknown";
}

static void put_info( const machine_info* machine, FILE* stream )
{
    char text[512], memory[40];
    report_write_number( round( machine->memory_bytes / 1e8 ) / 10.0, memory, sizeof memory );
    snprintf( text, sizeof text, "%s, %d core%s, %s GB", machine->cpu, machine->cores, machine->cores == 1 ? "" : "s",
              memory );
    fputs( "<dl class=\"facts\">\n", stream );
    put_fact( "machine", text, stream );
    put_fact( "system", machine->os, stream );
    put_fact( "kernels", machine->isa, stream );
    snprintf( text, sizeof text, "wisp %s (%s), %s, %s", known( machine->version ), known( machine->commit ),
              known( machine->compiler ), known( machine->build_type ) );
    put_fact( "build", text, stream );
    put_fact( "date", known( machine->date ), stream );
    put_fact( "flags", known( machine->flags ), stream );
    fputs( "</dl>\n", stream );
}

static void put_good_verdict( const results* all, const report_run* run, FILE* stream )
{
    fprintf( stream, "<p class=\"verdict\" id=\"summary\"><strong>%s.</strong> %d measurement%s, %d table%s",
             run->errors != NULL ? "Every hash is as it must be" : "Nothing failed", all->row_count,
             all->row_count == 1 ? "" : "s", all->table_count, all->table_count == 1 ? "" : "s" );
    if ( run->errors != NULL )
    {
        fputs( ". ", stream );
        report_put_prose( run->errors, stream );
        fputs( "</p>\n", stream );
        return;
    }
    fputs( ": every hash, and every error that has a limit, is as it must be.</p>\n", stream );
}

static void put_verdict( const results* all, const report_run* run, FILE* stream )
{
    int failures = count_notes( all, true );
    if ( !all->failed && failures == 0 )
    {
        put_good_verdict( all, run, stream );
        return;
    }
    fprintf( stream, "<div class=\"verdict failed\" id=\"summary\"><p><strong>%d failure%s.</strong> ", failures,
             failures == 1 ? "" : "s" );
    fputs( "This run does not count as good.</p>\n<ul>\n", stream );
    for ( int i = 0; i < all->note_count; ++i )
    {
        if ( is_failure( all->notes[i] ) )
        {
            fputs( "<li>", stream );
            report_put_prose( all->notes[i] + strlen( failure_mark ), stream );
            fputs( "</li>\n", stream );
        }
    }
    fputs( "</ul>\n</div>\n", stream );
}

// The results of the cases, a sentence each.
static void put_conclusions( const results* all, FILE* stream )
{
    fputs( all->headline_count > 0 ? "<ul class=\"conclusions\">\n" : "", stream );
    for ( int i = 0; i < all->headline_count; ++i )
    {
        fputs( "<li>", stream );
        report_put_prose( all->headlines[i], stream );
        fputs( "</li>\n", stream );
    }
    fputs( all->headline_count > 0 ? "</ul>\n" : "", stream );
}

static void put_head( const results* all, const report_run* run, FILE* stream )
{
    fputs( "<header>\n<p class=\"over\">Wisp, measured</p>\n<h1>", stream );
    report_put_text( run->what, stream );
    fputs( "</h1>\n<p class=\"how\">", stream );
    report_put_text( run->how, stream );
    fputs( "</p>\n", stream );
    put_verdict( all, run, stream );
    put_conclusions( all, stream );
    put_info( &all->machine, stream );
    fputs( "</header>\n<nav aria-label=\"Contents\"></nav>\n", stream );
}

// ---- the body ----

static void begin_section( const char* id, const char* title, FILE* stream )
{
    fprintf( stream, "<section id=\"%s\">\n<h2>%s</h2>\n", id, title );
}

static void put_charts( const results* all, FILE* stream )
{
    if ( all->chart_count > 0 )
    {
        begin_section( "charts", "Charts", stream );
        fputs( "<div class=\"grid\">\n", stream );
        for ( int i = 0; i < all->chart_count; ++i )
        {
            report_put_chart( &all->charts[i], i + 1, stream );
        }
        fputs( "</div>\n</section>\n", stream );
    }
}

static void put_tables( const results* all, FILE* stream )
{
    if ( all->table_count > 0 )
    {
        begin_section( "tables", "Tables", stream );
        for ( int i = 0; i < all->table_count; ++i )
        {
            report_put_table( &all->tables[i], i + 1, stream );
        }
        fputs( "</section>\n", stream );
    }
}

static void put_notes( const results* all, FILE* stream )
{
    if ( count_notes( all, false ) > 0 )
    {
        begin_section( "notes", "Notes", stream );
        fputs( "<ul class=\"notes\">\n", stream );
        for ( int i = 0; i < all->note_count; ++i )
        {
            if ( !is_failure( all->notes[i] ) )
            {
                fputs( "<li>", stream );
                report_put_prose( all->notes[i], stream );
                fputs( "</li>\n", stream );
            }
        }
        fputs( "</ul>\n</section>\n", stream );
    }
}

// ---- the page ----

// Write the template up to the line of a marker, or to its end. @return the line behind it
static int put_template( int line, const char* marker, FILE* stream )
{
    for ( ; line < WISP_COUNT( page_lines ) && strcmp( page_lines[line], marker ) != 0; ++line )
    {
        fputs( page_lines[line], stream );
    }
    return line + 1;
}

wisp_status report_write( const results* all, const report_run* run, FILE* stream, wisp_error* error )
{
    if ( all->incomplete )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory to gather the results" );
    }
    int line = put_template( 0, "<!-- title -->\n", stream );
    fputs( "<title>Wisp: ", stream );
    report_put_text( run->what, stream );
    fputs( "</title>\n", stream );
    line = put_template( line, "<!-- body -->\n", stream );
    put_head( all, run, stream );
    fputs( "<main>\n", stream );
    put_charts( all, stream );
    put_tables( all, stream );
    put_notes( all, stream );
    fputs( "</main>\n", stream );
    if ( all->chart_count > 0 && !report_put_chart_data( all, stream ) )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the charts of the report" );
    }
    put_template( line, "", stream );
    // Streams keep their first error, so one check at the end is enough.
    if ( fflush( stream ) != 0 || ferror( stream ) )
    {
        return wisp_fail( error, WISP_IO_ERROR, "the report could not be written: %s", strerror( errno ) );
    }
    return WISP_OK;
}

wisp_status report_write_file( const results* all, const report_run* run, const char* path, wisp_error* error )
{
    io_output output;
    WISP_TRY( io_output_open( path, &output, error ) );
    wisp_error cause = { 0 };
    wisp_status status = report_write( all, run, output.stream, &cause );
    if ( status != WISP_OK )
    {
        wisp_fail( error, status, "%s: %s", path, cause.message );
    }
    return io_output_end( &output, status, error );
}
