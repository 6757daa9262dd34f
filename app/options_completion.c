// The script for bash. What can be completed is in the tables: commands, options, words and files.
#include "options.h"

#include <string.h>

// ---- tables ----

static bool is_shown( const option_row* row )
{
    return row->name && row->text;
}

/// Rows of a command and those of all commands, by number. @return null after the last one
static const option_row* row_at( const command_text* command, int i )
{
    return i < command->row_count                                  ? command->rows + i
           : i < command->row_count + WISP_COUNT( options_common ) ? options_common + ( i - command->row_count )
                                                                   : NULL;
}

static bool needs_value( const option_row* row )
{
    return row->argument && row->argument[0] != '[';
}

// The operand of `help` is a command, so those are its words.
static bool wants_command( const command_text* command )
{
    return strcmp( command->noun, "command" ) == 0;
}

static void put_words( const option_values* values, FILE* out )
{
    for ( int i = 0; i < values->word_count; ++i )
    {
        fprintf( out, "%s%s", i > 0 ? " " : "", values->words[i] );
    }
}

static void put_commands( const command_text* program, FILE* out )
{
    int count;
    const command_text* const* list = program->commands( &count );
    for ( int i = 0; i < count; ++i )
    {
        fprintf( out, "%s%s", i > 0 ? " " : "", list[i]->name );
    }
}

// ---- the script ----

static const char bash_head[] = "# Files of some extensions, and folders; '*' is any file and '/' folders alone.\n"
                                "_wisp_files()\n"
                                "{\n"
                                "    local extension line\n"
                                "    local -a extensions\n"
                                "    read -ra extensions <<<\"$1\"\n"
                                "    compopt -o filenames 2>/dev/null || :\n"
                                "    while IFS= read -r line; do\n"
                                "        COMPREPLY+=(\"$line\")\n"
                                "    done < <(\n"
                                "        for extension in \"${extensions[@]}\"; do\n"
                                "            case $extension in\n"
                                "                '*') compgen -f -- \"$cur\" ;;\n"
                                "                /) ;;\n"
                                "                *) compgen -f -X \"!*$extension\" -- \"$cur\" ;;\n"
                                "            esac\n"
                                "        done\n"
                                "        [[ $1 == '*' ]] || compgen -d -- \"$cur\"\n"
                                "    )\n"
                                "}\n"
                                "\n"
                                "_wisp()\n"
                                "{\n"
                                "    local cur=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}\n"
                                "    local command='' options='' words='' files='' value='' i\n"
                                "    COMPREPLY=()\n"
                                "    # bash divides --format=json at the sign\n"
                                "    if [[ $cur == = ]]; then\n"
                                "        cur=''\n"
                                "    elif [[ $before == = ]]; then\n"
                                "        before=${COMP_WORDS[COMP_CWORD - 2]}\n"
                                "    fi\n"
                                "    for ((i = 1; i < COMP_CWORD; i++)); do\n"
                                "        if [[ ${COMP_WORDS[i]} != -* ]]; then\n"
                                "            command=${COMP_WORDS[i]}\n"
                                "            break\n"
                                "        fi\n"
                                "    done\n"
                                "    case $command in\n";

static const char bash_tail[] = "    esac\n"
                                "    if [[ -z $value && $cur == -* ]]; then\n"
                                "        words=$options files=\n"
                                "    fi\n"
                                "    while IFS= read -r i; do\n"
                                "        COMPREPLY+=(\"$i\")\n"
                                "    done < <(compgen -W \"$words\" -- \"$cur\")\n"
                                "    if [[ -n $files ]]; then\n"
                                "        _wisp_files \"$files\"\n"
                                "    fi\n"
                                "}\n"
                                "\n"
                                "complete -F _wisp wisp\n";

static void put_bash_values( const option_values* values, FILE* out )
{
    if ( values->word_count > 0 )
    {
        fputs( " words='", out );
        put_words( values, out );
        fputs( "'", out );
    }
    if ( values->files )
    {
        fprintf( out, " files='%s'", values->files );
    }
}

static void put_bash_command( const command_text* program, const command_text* command, FILE* out )
{
    fprintf( out, "        %s)\n            options='", command->name[0] ? command->name : "''" );
    const option_row* row;
    for ( int i = 0, count = 0; ( row = row_at( command, i ) ) != NULL; ++i )
    {
        if ( is_shown( row ) )
        {
            fprintf( out, "%s--%s", count++ > 0 ? " " : "", row->name );
        }
    }
    fputs( "'\n            case $before in\n", out );
    for ( int i = 0; ( row = row_at( command, i ) ) != NULL; ++i )
    {
        if ( is_shown( row ) && needs_value( row ) )
        {
            fprintf( out, "                --%s", row->name );
            if ( row->key < OPTION_KEY )
            {
                fprintf( out, " | -%c", row->key );
            }
            fputs( ") value=1", out );
            put_bash_values( &row->values, out );
            fputs( " ;;\n", out );
        }
    }
    fputs( "                *)", out );
    put_bash_values( &command->values, out );
    if ( wants_command( command ) )
    {
        fputs( " words='", out );
        put_commands( program, out );
        fputs( "'", out );
    }
    fputs( " ;;\n            esac\n            ;;\n", out );
}

void options_print_bash( const command_text* program, FILE* out )
{
    int count;
    const command_text* const* list = program->commands( &count );
    fprintf( out, "# Completions of wisp %s for bash, made by 'wisp completion bash'.\n\n%s", WISP_VERSION_STRING,
             bash_head );
    put_bash_command( program, program, out );
    for ( int i = 0; i < count; ++i )
    {
        put_bash_command( program, list[i], out );
    }
    fputs( bash_tail, out );
}
