// Options that the commands of wisp-bench share, and what they write: results, and a page.
#include "bench_commands.h"
#include "bench_texts.h"

#include "progress.h"

#include <string.h>

bool bench_take_file( options_state* o, int key, const char* argument, bench_files* files )
{
    switch ( key )
    {
        case BENCH_KEY_FORMAT:
            files->format = (results_format)option_word( o, argument );
            return true;
        case BENCH_KEY_OUTPUT:
            files->output = argument;
            return true;
        case BENCH_KEY_REPORT:
            files->report = argument;
            return true;
        case OPTIONS_END:
            // without a file the results go to standard output
            if ( files->report != NULL && strcmp( files->report, files->output ? files->output : "-" ) == 0 )
            {
                options_fail( o, "--report and --output both write to '%s'", files->report );
            }
            return true;
        default:
            return false;
    }
}

bool bench_take_measurement( const options_state* o, int key, const char* argument, bench_options* options )
{
    switch ( key )
    {
        case BENCH_KEY_QUICK:
            options->quick = true;
            return true;
        case BENCH_KEY_SECONDS:
            options->seconds = option_positive( o, argument, 1e6 );
            return true;
        case BENCH_KEY_WORKERS:
            options->workers = option_whole( o, argument, 1, WISP_MAX_WORKERS );
            return true;
        default:
            return false;
    }
}

wisp_status bench_check_files( const bench_files* files, wisp_error* error )
{
    const wisp_status status = command_check_writable( files->output, error );
    return status == WISP_OK ? command_check_writable( files->report, error ) : status;
}

// The report first, since a reader of standard output may leave early; the results also if it fails.
wisp_status bench_write_files( const bench_files* files, const report_run* run, const results* out,
                               wisp_error* error )
{
    wisp_error later = { 0 };
    const wisp_status reported = files->report ? report_write_file( out, run, files->report, error ) : WISP_OK;
    const wisp_status written =
        results_write_file( out, files->format, files->output, reported == WISP_OK ? error : &later );
    return reported == WISP_OK ? written : reported;
}

void bench_show_progress( void* user, double fraction, const char* what )
{
    progress_show( user, fraction, what );
}
