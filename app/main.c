#include "commands.h"

#include "nearest.h"

#include <stdlib.h>
#include <string.h>

typedef struct program_command
{
    const char* name;
    command_fn* run;
} program_command;

static const program_command commands[] = {
    { "run", command_run },         { "plan", command_plan },     { "bench", command_bench },
    { "info", command_info },       { "render", command_render }, { "tune", command_tune },
    { "torture", command_torture }, { "gate", command_gate },     { "accuracy", command_bench },
    { "compare", command_compare }, { "view", command_view },
};

static const char program_doc[] =
    "Simulate thin things on the CPU: cloth, balloons and hair.\n"
    "\n"
    "Commands:\n"
    "  run SCENE      simulate a scene, write its files and print a summary\n"
    "  render FILE    draw pictures of a scene, recording, mesh or groom\n"
    "  view FILE      write a page that simulates a scene, or plays a recording, in a browser\n"
    "  info FILE      describe a file and report what is wrong with it\n"
    "  plan SCENE     list the passes that a scene needs, and why\n"
    "  tune SCENE     find the cheapest configuration within an error or time\n"
    "  bench [CASE]   measure time and error together\n"
    "  accuracy SCENE show what accuracy costs in a scene\n"
    "  torture        search for scenes that break the engine, or judge scenes\n"
    "  gate ACTION    measure the scenes of a suite, and fail if one became worse\n"
    "  compare A B    say what differs between two result files\n"
    "\v"
    "'wisp COMMAND --help' describes the arguments and options of a command.\n"
    "\n"
    "Examples:\n"
    "  wisp run data/scenes/flag.yaml --record flag.wisp\n"
    "  wisp render flag.wisp -o flag.png\n"
    "\n" STATUS_HELP_UNMET(
        "a benchmark check failed, a tuning target was not met, a scene breaks, or the gate fails" );

// Options before the command belong to the program. Everything after it belongs to the command.
static error_t parse_program( int key, char* argument, struct argp_state* state )
{
    (void)argument;
    switch ( key )
    {
        case ARGP_KEY_ARG:
            *(int*)state->input = state->next - 1;
            state->next = state->argc;
            return 0;
        case ARGP_KEY_NO_ARGS:
            argp_error( state, "expected a command: run, render, view, info, plan, tune, bench, accuracy, torture, "
                               "gate or compare" );
            return 0;
        default:
            return ARGP_ERR_UNKNOWN;
    }
}

static int unknown_command( const char* word )
{
    const char* names[WISP_COUNT( commands )];
    for ( int i = 0; i < WISP_COUNT( commands ); ++i )
    {
        names[i] = commands[i].name;
    }
    const char* nearest = nearest_word( word, names, WISP_COUNT( commands ) );
    if ( nearest )
    {
        fprintf( stderr, "wisp: got command '%s'; did you mean '%s'?\n", word, nearest );
    }
    else
    {
        fprintf(
            stderr,
            "wisp: got command '%s', expected run, render, view, info, plan, tune, bench, accuracy, torture, gate or "
            "compare\n",
            word );
    }
    return STATUS_USAGE;
}

int main( int argc, char** argv )
{
    int place = 0;
    // Lines of --help up to 100 columns, without argp's note about long and short options below each list.
    setenv( "ARGP_HELP_FMT", "rmargin=100,no-dup-args-note", 0 );
    // argp starts its messages with argv[0]: the name is the same wherever the program is installed.
    char program[] = "wisp";
    argv[0] = program;
    const struct argp parser = { .parser = parse_program, .args_doc = "COMMAND [ARGUMENT...]", .doc = program_doc };
    argp_parse( &parser, argc, argv, ARGP_IN_ORDER, NULL, &place );

    for ( int i = 0; i < WISP_COUNT( commands ); ++i )
    {
        if ( strcmp( argv[place], commands[i].name ) == 0 )
        {
            char name[40];
            snprintf( name, sizeof( name ), "wisp %s", commands[i].name );
            argv[place] = name;
            return commands[i].run( argc - place, argv + place );
        }
    }
    return unknown_command( argv[place] );
}
