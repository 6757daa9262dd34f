// `wisp validate`: what theory and measurements say of it, by every solver that can do it.
#include "bench_commands.h"
#include "bench_texts.h"

#include "interruption.h"
#include "progress.h"
#include "report.h"
#include "validate/validate.h"

enum
{
    MAX_CASES = 64,
};

typedef struct validate_arguments
{
    bench_options options;
    bench_files files;
    uint64_t chosen;
    bool only_list;
} validate_arguments;

static int list_names( const char* names[MAX_CASES] )
{
    int count;
    const validate_case* cases = validate_cases( &count );
    for ( int i = 0; i < count; ++i )
    {
        names[i] = cases[i].name;
    }
    return count;
}

static bool take( options_state* o, int key, const char* argument )
{
    validate_arguments* a = o->input;
    const char* names[MAX_CASES];
    switch ( key )
    {
        case BENCH_KEY_LIST:
            a->only_list = true;
            return true;
        case OPTIONS_OPERAND:
        {
            const int count = list_names( names );
            a->chosen |= 1ull << option_word_of( o, argument, names, count );
            return true;
        }
        default:
            return bench_take_measurement( o, key, argument, &a->options ) ||
                   bench_take_file( o, key, argument, &a->files );
    }
}

static int list_cases( void )
{
    int count;
    const validate_case* cases = validate_cases( &count );
    for ( int i = 0; i < count; ++i )
    {
        printf( "%-18s %s\n", cases[i].name, cases[i].title );
    }
    return STATUS_GOOD;
}

static wisp_status run( validate_arguments* a, results* out, char* summary, size_t size, wisp_error* error )
{
    progress bar = progress_begin();
    a->options.progress = bench_show_progress;
    a->options.progress_user = &bar;
    const wisp_status status = validate_run( a->chosen, &a->options, out, summary, size, error );
    progress_end( &bar );
    return bench_keep_interrupted( out, status );
}

int bench_validate( int argc, char** argv )
{
    validate_arguments a = { .options = bench_default_options() };
    options_parse( &validate_text, take, &a, argc, argv );
    if ( a.only_list )
    {
        return list_cases();
    }
    interruption_begin();
    results out = { .is_result_first = true };
    results_put_options( &out, argc, argv );
    wisp_error error = { 0 };
    wisp_status status = bench_describe_machine( &out.machine, &error );
    status = status == WISP_OK ? bench_check_files( &a.files, &error ) : status;
    char summary[600] = "";
    status = status == WISP_OK ? run( &a, &out, summary, sizeof summary, &error ) : status;
    const report_run page = { .what = "validation", .how = "wisp validate", .errors = summary };
    status = status == WISP_OK ? bench_write_files( &a.files, &page, &out, &error ) : status;
    const bool failed = out.failed;
    results_free( &out );
    return status != WISP_OK ? command_fail( &error ) : interruption_status( failed ? STATUS_UNMET : STATUS_GOOD );
}
