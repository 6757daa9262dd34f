#include "commands.h"

#include "interruption.h"
#include "io_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const char* const option_isa_words[3] = { "baseline", "avx2", "avx512" };

int command_fail( const wisp_error* error )
{
    const char* message = error->message[0] ? error->message : wisp_status_name( error->status );
    fprintf( stderr, "wisp: %s\n", message );
    return interruption_status( STATUS_FAILED );
}

int command_end( wisp_status status, wisp_error* error )
{
    if ( ( fflush( stdout ) != 0 || ferror( stdout ) ) && status == WISP_OK )
    {
        status = wisp_fail( error, WISP_IO_ERROR, "standard output: the text could not be written" );
    }
    return status == WISP_OK ? interruption_status( STATUS_GOOD ) : command_fail( error );
}

wisp_status command_check_writable( const char* path, wisp_error* error )
{
    struct stat info;
    int number = 0;
    if ( path == NULL || io_is_standard( path ) )
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
