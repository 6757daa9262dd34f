#include "commands.h"

#include "plan_sheet.h"
#include "scene.h"

#define STEPS_DEFAULT 10
#define PLAN_STEPS_MAX 1000000

enum
{
    FORMAT_TEXT,
    FORMAT_DOT,
    FORMAT_JSON,
    FORMAT_COUNT,
};

static const char* const format_words[FORMAT_COUNT] = { "text", "dot", "json" };

typedef struct plan_options
{
    const char* scene;
    int format;
    int steps;
    bool is_verbose;
} plan_options;

static const option_row plan_rows[] = {
    { "verbose", 'v', NULL, "Also print what passes read and write, and absent passes",
      OPTION_FLAG( plan_options, is_verbose ) },
    { "format", 'f', "FORMAT", "text (default), dot for Graphviz, or json",
      OPTION_WORD( plan_options, format, format_words ) },
    { "steps", 's', "N", "Measure the first N steps, 10 by default, 0 for none",
      OPTION_WHOLE( plan_options, steps, 0, PLAN_STEPS_MAX ) },
};

const command_text plan_text = {
    .name = "plan",
    .operands = "SCENE",
    .noun = "scene",
    .summary = "list the passes that a scene needs, and why",
    .about = "Print the passes that a scene needs, and why each is there.",
    .notes = "One line per pass: its stage, the entities it runs on, its predicted percentage\n"
             "of the memory traffic, its measured percentage of the time, and why it is active.\n"
             "Below are the modules that the scene does not use. docs/outputs.md explains both\n"
             "percentages and the JSON format.",
    .examples = "wisp plan data/scenes/flag.yaml\n"
                "wisp plan data/scenes/flag.yaml --format dot | dot -Tsvg > plan.svg",
    .rows = plan_rows,
    .row_count = WISP_COUNT( plan_rows ),
    .values = OPTION_INPUT( OPTION_TO_INPUT, plan_options, scene, ".yaml .yml .json" ),
};

static wisp_status write_plan( const plan_sheet* sheet, const plan_options* options, wisp_error* error )
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
    return is_written ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "plan: out of memory for the JSON output" );
}

int command_plan( int argc, char** argv )
{
    plan_options options = { .format = FORMAT_TEXT, .steps = STEPS_DEFAULT };
    options_parse( &plan_text, NULL, &options, argc, argv );

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
        status = status == WISP_OK ? write_plan( &sheet, &options, &error ) : status;
        plan_sheet_release( &sheet );
        scene_world_destroy( &world );
    }
    wisp_scene_release( &scene );
    return command_end( status, &error );
}
