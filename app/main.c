#include "verbs.h"

#include "nearest.h"

#include <string.h>

typedef struct program_verb
{
    const char* name;
    verb_fn* run;
} program_verb;

static const program_verb verbs[] = {
    { "run", verb_run },   { "plan", verb_plan },     { "bench", verb_bench },
    { "info", verb_info }, { "render", verb_render }, { "tune", verb_tune },
};

static const char program_doc[] =
    "Wisp simulates thin things: cloth, balloons, hair.\n"
    "\n"
    "Verbs:\n"
    "  run SCENE      simulate a scene and write what it asks for\n"
    "  plan SCENE     the passes that a scene needs, and why\n"
    "  bench [CASE]   measure, with the error beside every time\n"
    "  info FILE      what is in a mesh, groom, scene, recording or result, and what is wrong with it\n"
    "  render FILE    pictures of a scene, recording, mesh or groom\n"
    "  tune SCENE     the cheapest setting that meets an error, or the most accurate within a time\n"
    "\v"
    "'wisp VERB --help' tells more about a verb.\n" STATUS_HELP;

// Options before the verb belong to the program; everything from the verb on belongs to the verb.
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
            argp_error( state, "which verb? one of run, plan, bench, info, render, tune" );
            return 0;
        default:
            return ARGP_ERR_UNKNOWN;
    }
}

static int unknown_verb( const char* word )
{
    const char* names[WISP_COUNT( verbs )];
    for ( int i = 0; i < WISP_COUNT( verbs ); ++i )
    {
        names[i] = verbs[i].name;
    }
    const char* nearest = nearest_word( word, names, WISP_COUNT( verbs ) );
    if ( nearest )
    {
        fprintf( stderr, "wisp: there is no verb '%s'; did you mean '%s'?\n", word, nearest );
    }
    else
    {
        fprintf( stderr, "wisp: there is no verb '%s', only run, plan, bench, info, render and tune\n", word );
    }
    return STATUS_USAGE;
}

int main( int argc, char** argv )
{
    int place = 0;
    // argp calls the program by argv[0] in its messages, and a message begins alike wherever the program lies.
    char program[] = "wisp";
    argv[0] = program;
    const struct argp parser = { .parser = parse_program, .args_doc = "VERB [ARGUMENT...]", .doc = program_doc };
    argp_parse( &parser, argc, argv, ARGP_IN_ORDER, NULL, &place );

    for ( int i = 0; i < WISP_COUNT( verbs ); ++i )
    {
        if ( strcmp( argv[place], verbs[i].name ) == 0 )
        {
            char name[40];
            snprintf( name, sizeof( name ), "wisp %s", verbs[i].name );
            argv[place] = name;
            return verbs[i].run( argc - place, argv + place );
        }
    }
    return unknown_verb( argv[place] );
}
