#include "commands.h"

#include "plan_sheet.h"
#include "scene.h"

#define STEPS_DEFAULT 10
#define STEPS_MAX 1000000

enum
{
    KEY_STEPS = 's',
    KEY_FORMAT = 'f',
    KEY_VERBOSE = 'v',
};

enum
{
    FORMAT_TEXT,
    FORMAT_DOT,
    FORMAT_JSON,
    FORMAT_COUNT,
};

static const char* const format_words[FORMAT_COUNT] = { "text", "dot", "json" };

static const char doc[] = "Print the passes that a scene needs, and why each is there.\n"
                          "\v"
                          "One line per pass: its stage, the entities it runs on, its predicted percentage\n"
                          "of the memory traffic, its measured percentage of the time, and why it is active.\n"
                          "Below are the modules that the scene does not use. docs/outputs.md explains both\n"
                          "percentages and the JSON format.\n"
                          "\n"
                          "Examples:\n"
                          "  wisp plan data/scenes/flag.yaml\n"
                          "  wisp plan data/scenes/flag.yaml --format dot | dot -Tsvg > plan.svg\n"
                          "\n" STATUS_HELP;

static const struct argp_option option_list[] = {
    { "verbose", KEY_VERBOSE, 0, 0, "Also print what passes read and write, and absent passes", 0 },
    { "format", KEY_FORMAT, "FORMAT", 0, "text (default), dot for Graphviz, or json", 0 },
    { "steps", KEY_STEPS, "N", 0, "Measure the first N steps, 10 by default, 0 for none", 0 },
    { 0 },
};

typedef struct plan_options
{
    const char* scene;
    int format;
    int steps;
    bool is_verbose;
} plan_options;

static error_t parse( int key, char* argument, struct argp_state* state )
{
    plan_options* options = state->input;
    switch ( key )
    {
        case KEY_FORMAT:
            options->format = option_word( state, "--format", argument, format_words, FORMAT_COUNT );
            return 0;
        case KEY_STEPS:
            options->steps = option_whole( state, "--steps", argument, 0, STEPS_MAX );
            return 0;
        case KEY_VERBOSE:
            options->is_verbose = true;
            return 0;
        default:
            return option_input( state, key, argument, "scene", &options->scene ) ? 0 : ARGP_ERR_UNKNOWN;
    }
}

static wisp_status write_sheet( const plan_sheet* sheet, const plan_options* options, wisp_error* error )
{
    bool is_written = true;
    switch ( options->format )
    {
        case FORMAT_DOT:
            plan_sheet_dot( sheet, stdout );
            break;
        case FORMAT_JSON:
            is_written = plan_sheet_json( sheet, stdout );
            break;
        default:
            plan_sheet_text( sheet, options->is_verbose, stdout );
            break;
    }
    if ( is_written == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "plan: out of memory for the JSON output" );
    }
    return fflush( stdout ) != 0 || ferror( stdout )
               ? wisp_fail( error, WISP_IO_ERROR, "standard output: the plan could not be written" )
               : WISP_OK;
}

int command_plan( int argc, char** argv )
{
    plan_options options = { .format = FORMAT_TEXT, .steps = STEPS_DEFAULT };
    const struct argp parser = { .options = option_list, .parser = parse, .args_doc = "SCENE", .doc = doc };
    argp_parse( &parser, argc, argv, 0, NULL, &options );

    wisp_error error = { 0 };
    wisp_scene scene;
    if ( wisp_scene_read( options.scene, &scene, &error ) != WISP_OK )
    {
        return command_fail( &error );
    }
    // On one worker no thread competes for time, so the times of passes are clean.
    const scene_world_options world_options = { .workers = 1 };
    scene_world world;
    wisp_status status = scene_world_create( &scene, &world_options, &world, &error );
    if ( status == WISP_OK )
    {
        plan_sheet sheet;
        status = plan_sheet_make( &world, options.steps, &sheet, &error );
        status = status == WISP_OK ? write_sheet( &sheet, &options, &error ) : status;
        plan_sheet_release( &sheet );
        scene_world_destroy( &world );
    }
    wisp_scene_release( &scene );
    return status == WISP_OK ? STATUS_GOOD : command_fail( &error );
}
