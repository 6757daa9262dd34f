// Follows a transcript of the program: commands of a shell, and what each of them says. "$ " begins a command and "> " goes on
// with it. Below stand the lines of its standard output, those of its error stream behind "! ", and its exit status unless that is
// 0. "..." stands for any text, alone in a line for any lines; empty lines and those that begin with "#" are for readers.
#include "files.h"

#include "wisp/base.h"

#include <ftw.h>
#include <sys/wait.h>

enum
{
    OUTPUT_MAX = 262144,
};

static char program[4096], transcript[4096];

static bool find_both( int argc, char** argv )
{
    return argc == 3 && realpath( argv[1], program ) != NULL && realpath( argv[2], transcript ) != NULL;
}

static bool is_as_expected( const char* said, const char* expected )
{
    const char* any = strstr( expected, "..." );
    bool is_anchored = true;
    while ( any != NULL )
    {
        const size_t length = (size_t)( any - expected );
        const char* at = is_anchored ? said : memmem( said, strlen( said ), expected, length );
        if ( at == NULL || strncmp( at, expected, length ) != 0 )
        {
            return false;
        }
        said = at + length;
        const bool is_line = any[3] == '\n' && ( length == 0 || any[-1] == '\n' );
        expected = any + ( is_line ? 4 : 3 );
        any = strstr( expected, "..." );
        is_anchored = false;
    }
    const size_t length = strlen( expected ), rest = strlen( said );
    return ( is_anchored ? rest == length : rest >= length ) && strcmp( said + rest - length, expected ) == 0;
}

// Lines with a mark before each.
static void add_lines( char* to, const char* lines, const char* mark )
{
    for ( const char* line = lines; *line != '\0'; line += strcspn( line, "\n" ) + ( strchr( line, '\n' ) ? 1 : 0 ) )
    {
        sprintf( to + strlen( to ), "%s%.*s\n", mark, (int)strcspn( line, "\n" ), line );
    }
}

static bool follow( const char* command, const char* expected )
{
    static char script[2 * OUTPUT_MAX], said[3 * OUTPUT_MAX], out[OUTPUT_MAX], err[OUTPUT_MAX];
    snprintf( script, sizeof script, "wisp() { \"$WISP\" \"$@\"; }\n{ %s} >../out 2>../err </dev/null", command );
    const int status = system( script );
    read_text( "../out", out, sizeof out );
    read_text( "../err", err, sizeof err );
    said[0] = '\0';
    add_lines( said, out, "" );
    add_lines( said, err, "! " );
    if ( status != 0 )
    {
        sprintf( said + strlen( said ), "[%d]\n", WIFEXITED( status ) ? WEXITSTATUS( status ) : -1 );
    }
    if ( !is_as_expected( said, expected ) )
    {
        fprintf( stderr, "$ %ssays\n%sexpected\n%s\n", command, said, expected );
        return false;
    }
    return true;
}

TEST( every_command_says_what_its_transcript_says )
{
    static char command[OUTPUT_MAX], expected[OUTPUT_MAX];
    size_t size;
    int commands = 0, wrong = 0;
    char* text = read_bytes( transcript, &size );
    for ( char *rest = text, *line = strsep( &rest, "\n" ); line != NULL; line = strsep( &rest, "\n" ) )
    {
        if ( strncmp( line, "$ ", 2 ) == 0 )
        {
            wrong += commands++ > 0 && !follow( command, expected ) ? 1 : 0;
            command[0] = expected[0] = '\0';
        }
        if ( line[0] == '$' || line[0] == '>' )
        {
            sprintf( command + strlen( command ), "%s\n", line[1] == ' ' ? line + 2 : line + 1 );
        }
        else if ( line[0] != '\0' && line[0] != '#' )
        {
            sprintf( expected + strlen( expected ), "%s\n", line );
        }
    }
    assert_true( commands > 0 );
    wrong += follow( command, expected ) ? 0 : 1;
    free( text );
    assert_int_equal( wrong, 0 );
}

static int remove_entry( const char* path, const struct stat* info, int kind, struct FTW* place )
{
    (void)info;
    (void)kind;
    (void)place;
    return remove( path );
}

// A folder of its own.
static int enter_folder( void** state )
{
    static char folder[] = P_tmpdir "/wisp_program_XXXXXX";
    *state = mkdtemp( folder );
    unsetenv( "NO_COLOR" );
    setenv( "WISP", program, 1 );
    setenv( "LC_ALL", "C", 1 );
    setenv( "WISP_CACHE", "cache", 1 );
    setenv( "SOURCE", WISP_SOURCE_ROOT, 1 );
    return *state && chdir( folder ) == 0 && mkdir( "here", 0700 ) == 0 ? chdir( "here" ) : -1;
}

// Remove the folder with everything that the program left in it.
static int leave_folder( void** state )
{
    return chdir( "/" ) == 0 ? nftw( *state, remove_entry, 8, FTW_DEPTH | FTW_PHYS ) : -1;
}

TEST_ARGUMENTS( find_both )
TEST_GROUP( enter_folder, leave_folder )
