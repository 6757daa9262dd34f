// `wisp compare BEFORE AFTER`: what differs between two files of results.
#include "commands.h"

#include "results_read.h"

typedef struct compare_options
{
    const char *before, *after;
    double least;
    results_format format;
} compare_options;

enum
{
    COMPARE_KEY_LEAST = 256,
};

static const option_row compare_rows[] = {
    { "least", COMPARE_KEY_LEAST, "FRACTION", "Smallest change of a time that counts, default 0.25", OPTION_ANY },
    { "format",
      'f',
      "FORMAT",
      "text (default), markdown, csv, json or latex",
      { results_format_names, RESULTS_FORMAT_COUNT, NULL } },
};

const command_text compare_text = {
    .name = "compare",
    .operands = "BEFORE AFTER",
    .noun = "file",
    .summary = "say what differs between two result files",
    .about = "Say what differs between two result files beyond noise.",
    .notes = "The files are those of --format json. Times are compared by a test of ranks and a\n"
             "least change; bits, errors and sizes as they stand. Times of other processors are\n"
             "shown and not judged. To compare times of two programs, `wisp gate check --paired`\n"
             "is better: it runs both by turns.",
    .examples = "wisp compare before.json after.json\n"
                "wisp compare before.json after.json --least 0.1 --format markdown",
    .rows = compare_rows,
    .row_count = WISP_COUNT( compare_rows ),
    .values = OPTION_FILES( ".json" ),
};

static bool take_compare_option( options_state* o, int key, const char* argument )
{
    compare_options* given = o->input;
    switch ( key )
    {
        case COMPARE_KEY_LEAST:
            given->least = option_positive( o, argument, 100.0 );
            return true;
        case 'f':
            given->format = (results_format)option_word( o, argument );
            return true;
        case OPTIONS_OPERAND:
            if ( given->after )
            {
                options_fail( o, "got a third file '%s', expected two", argument );
            }
            *( given->before ? &given->after : &given->before ) = argument;
            return true;
        case OPTIONS_END:
            if ( !given->after )
            {
                options_fail( o, "expected two result files, such as before.json after.json" );
            }
            return true;
        default:
            return false;
    }
}

int command_compare( int argc, char** argv )
{
    compare_options options = { .least = 0.25 };
    options_parse( &compare_text, take_compare_option, &options, argc, argv );
    wisp_error error = { 0 };
    results out = { .machine = machine_describe( "" ), .is_result_first = true };
    results_put_options( &out, argc, argv );
    wisp_status status = results_compare( options.before, options.after, options.least, &out, &error );
    status = status == WISP_OK ? results_write_file( &out, options.format, NULL, &error ) : status;
    results_free( &out );
    return status == WISP_OK ? STATUS_GOOD : command_fail( &error );
}
