// `wisp compare BEFORE AFTER`: what differs between two files of results.
#include "commands.h"

#include "results_compare.h"

static const char doc[] = "Say what differs between two result files beyond noise.\n"
                          "\v"
                          "The files are those of --format json. Times are compared by a test of ranks and a\n"
                          "least change; bits, errors and sizes as they stand. Times of other processors are\n"
                          "shown and not judged. To compare times of two programs, `wisp gate check --paired`\n"
                          "is better: it runs both by turns.\n"
                          "\n"
                          "Examples:\n"
                          "  wisp compare before.json after.json\n"
                          "  wisp compare before.json after.json --least 0.1 --format markdown\n"
                          "\n" STATUS_HELP;

typedef struct compare_options
{
    const char *before, *after;
    double least;
    results_format format;
} compare_options;

enum
{
    KEY_LEAST = 256,
};

static const struct argp_option option_list[] = {
    { "least", KEY_LEAST, "FRACTION", 0, "Smallest change of a time that counts, default 0.25", 0 },
    { "format", 'f', "FORMAT", 0, "text (default), markdown, csv or json", 0 },
    { 0 },
};

static error_t parse( int key, char* argument, struct argp_state* state )
{
    compare_options* o = state->input;
    switch ( key )
    {
        case KEY_LEAST:
            o->least = option_positive( state, "--least", argument, 100.0 );
            return 0;
        case 'f':
            o->format =
                (results_format)option_word( state, "--format", argument, results_format_names, RESULTS_GBENCH );
            return 0;
        case ARGP_KEY_ARG:
            if ( o->after )
            {
                argp_error( state, "got a third file '%s', expected two", argument );
            }
            *( o->before ? &o->after : &o->before ) = argument;
            return 0;
        case ARGP_KEY_END:
            if ( !o->after )
            {
                argp_error( state, "expected two result files, such as before.json after.json" );
            }
            return 0;
        default:
            return ARGP_ERR_UNKNOWN;
    }
}

int command_compare( int argc, char** argv )
{
    compare_options options = { .least = 0.25 };
    const struct argp parser = { option_list, parse, "BEFORE AFTER", doc, NULL, NULL, NULL };
    argp_parse( &parser, argc, argv, 0, NULL, &options );
    wisp_error error = { 0 };
    results out = { .machine = machine_describe( "" ), .is_result_first = true };
    results_put_options( &out, argc, argv );
    wisp_status status = results_compare( options.before, options.after, options.least, &out, &error );
    status = status == WISP_OK ? results_write_file( &out, options.format, NULL, &error ) : status;
    results_free( &out );
    return status == WISP_OK ? STATUS_GOOD : command_fail( &error );
}
