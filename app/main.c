#include "commands.h"

#include "nearest.h"

#include <string.h>

typedef struct program_command
{
    const command_text* text;
    command_fn* run;
} program_command;

static const program_command commands[] = {
    { &run_text, command_run },           { &render_text, command_render },
    { &view_text, command_view },         { &info_text, command_info },
    { &plan_text, command_plan },         { &tune_text, command_tune },
    { &bench_text, command_bench },       { &accuracy_text, command_accuracy },
    { &validate_text, command_validate }, { &sweep_text, command_sweep },
    { &merge_text, command_merge },       { &torture_text, command_torture },
    { &gate_text, command_gate },         { &compare_text, command_compare },
    { &help_text, command_help },         { &completion_text, command_completion },
};

static const command_text* const* list_commands( int* count )
{
    static const command_text* texts[WISP_COUNT( commands )];
    for ( int i = 0; i < WISP_COUNT( commands ); ++i )
    {
        texts[i] = commands[i].text;
    }
    *count = WISP_COUNT( commands );
    return texts;
}

const command_text program_text = {
    .name = "",
    .operands = "COMMAND [ARGUMENT...]",
    .noun = "command",
    .summary = "simulate thin things on the CPU: cloth, balloons and hair",
    .about = "Simulate thin things on the CPU: cloth, balloons and hair.",
    .notes = "'wisp help COMMAND' describes the arguments and options of a command. Where a command reads a\n"
             "file, '-' is standard input; where it writes text, '-' is standard output.",
    .examples = "wisp run data/scenes/flag.yaml --record flag.wisp\n"
                "wisp render flag.wisp -o flag.png",
    .unmet = "a benchmark check failed, a tuning target was not met, a scene breaks, or the gate fails",
    .commands = list_commands,
};

_Noreturn void command_unknown( const char* word )
{
    const char* names[WISP_COUNT( commands )];
    char all[240] = "";
    for ( int i = 0; i < WISP_COUNT( commands ); ++i )
    {
        names[i] = commands[i].text->name;
        strcat( strcat( all, i == 0 ? "" : i + 1 < WISP_COUNT( commands ) ? ", " : " or " ), names[i] );
    }
    const options_state o = { .command = &program_text };
    const char* nearest = word ? nearest_word( word, names, WISP_COUNT( commands ) ) : NULL;
    if ( word == NULL )
    {
        options_fail( &o, "expected a command: %s", all );
    }
    if ( nearest )
    {
        options_fail( &o, "got command '%s'; did you mean '%s'?", word, nearest );
    }
    options_fail( &o, "got command '%s', expected %s", word, all );
}

// Options before the command belong to the program, and each of them ends it. Everything after it is the command's.
static int find_command( int argc, char** argv )
{
    int place = 1;
    while ( place < argc && argv[place][0] == '-' && argv[place][1] != '\0' && strcmp( argv[place], "--" ) != 0 )
    {
        ++place;
    }
    options_parse( &program_text, NULL, NULL, place, argv );
    return place + ( place < argc && strcmp( argv[place], "--" ) == 0 ? 1 : 0 );
}

int main( int argc, char** argv )
{
    const int place = find_command( argc, argv );
    for ( int i = 0; i < WISP_COUNT( commands ) && place < argc; ++i )
    {
        if ( strcmp( argv[place], commands[i].text->name ) == 0 )
        {
            char name[48];
            command_name( commands[i].text, name );
            argv[place] = name;
            return commands[i].run( argc - place, argv + place );
        }
    }
    command_unknown( place < argc ? argv[place] : NULL );
}
