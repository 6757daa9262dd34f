// `wisp compare BEFORE AFTER`: what differs between two files of results.
#include "commands.h"

#include "results_read.h"

typedef struct compare_options
{
    const char *before, *after;
    double least;
    results_format format;
} compare_options;

static const option_row compare_rows[] = {
    { "least", 0, "FRACTION", "Smallest change of a time that counts, default 0.25",
      OPTION_NUMBER( compare_options, least, 100.0 ) },
    OPTION_RESULTS_FORMAT( compare_options, format ),
};

static void take_result_file( const options_state* o, const char* argument )
{
    compare_options* given = o->input;
    if ( given->after )
    {
        options_fail( o, "got a third file '%s', expected two", argument );
    }
    *( given->before ? &given->after : &given->before ) = argument;
}

static void check_compare_options( const options_state* o )
{
    const compare_options* given = o->input;
    if ( !given->after )
    {
        options_fail( o, "expected two result files, such as before.json after.json" );
    }
}

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
    .values = { .files = ".json", .to = { .take = take_result_file } },
};

int command_compare( int argc, char** argv )
{
    compare_options options = { .least = 0.25 };
    options_parse( &compare_text, check_compare_options, &options, argc, argv );
    wisp_error error = { 0 };
    results out = { .machine = machine_describe( "" ), .is_result_first = true };
    results_put_options( &out, argc, argv );
    wisp_status status = results_compare( options.before, options.after, options.least, &out, &error );
    status = status == WISP_OK ? results_write_file( &out, options.format, NULL, &error ) : status;
    results_free( &out );
    return status == WISP_OK ? STATUS_GOOD : command_fail( &error );
}
