#include "commands.h"

#include "nearest.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// The name is argp's: it answers --version with this.
const char* argp_program_version = "wisp " WISP_VERSION_STRING;

const char* const option_isa_words[3] = { "baseline", "avx2", "avx512" };

int command_fail( const wisp_error* error )
{
    const char* message = error->message[0] ? error->message : wisp_status_name( error->status );
    fprintf( stderr, "wisp: %s\n", message );
    return STATUS_FAILED;
}

wisp_status command_check_writable( const char* path, wisp_error* error )
{
    struct stat info;
    int number = 0;
    if ( path == NULL )
    {
        return WISP_OK;
    }
    if ( stat( path, &info ) == 0 )
    {
        number = S_ISDIR( info.st_mode ) ? EISDIR : access( path, W_OK ) == 0 ? 0 : errno;
    }
    else
    {
        int file = open( path, O_CREAT | O_EXCL | O_WRONLY, 0600 );
        // A link to a missing file can be written through.
        number = file >= 0 || errno == EEXIST ? 0 : errno;
        if ( file >= 0 )
        {
            close( file );
            unlink( path );
        }
    }
    return number == 0 ? WISP_OK
                       : wisp_fail( error, WISP_IO_ERROR, "%s: cannot be written: %s", path, strerror( number ) );
}

int option_whole( struct argp_state* state, const char* option, const char* text, int lower, int upper )
{
    char* end = NULL;
    errno = 0;
    long value = strtol( text, &end, 10 );
    if ( end == text || *end || errno || value < lower || value > upper )
    {
        argp_error( state, "%s: got '%s', expected a whole number from %d to %d", option, text, lower, upper );
    }
    return (int)value;
}

double option_positive( struct argp_state* state, const char* option, const char* text, double upper )
{
    char* end = NULL;
    double value = strtod( text, &end );
    if ( end == text || *end || !( value > 0.0 ) || !( value <= upper ) )
    {
        argp_error( state, "%s: got '%s', expected a number above 0 and at most %g", option, text, upper );
    }
    return value;
}

int option_word( struct argp_state* state, const char* option, const char* text, const char* const* words, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( strcmp( text, words[i] ) == 0 )
        {
            return i;
        }
    }
    const char* nearest = nearest_word( text, words, count );
    if ( nearest )
    {
        argp_error( state, "%s: got '%s'; did you mean '%s'?", option, text, nearest );
    }
    char all[200] = "";
    for ( int i = 0; i < count; ++i )
    {
        strncat( all, i > 0 ? ", " : "", sizeof( all ) - strlen( all ) - 1 );
        strncat( all, words[i], sizeof( all ) - strlen( all ) - 1 );
    }
    argp_error( state, "%s: got '%s', expected one of %s", option, text, all );
    return 0;
}

bool option_input( struct argp_state* state, int key, const char* argument, const char* noun, const char** input )
{
    if ( key == ARGP_KEY_NO_ARGS )
    {
        argp_error( state, "expected a %s", noun );
        return true;
    }
    if ( key != ARGP_KEY_ARG )
    {
        return false;
    }
    if ( *input )
    {
        argp_error( state, "got a second %s '%s', expected one", noun, argument );
    }
    *input = argument;
    return true;
}
