// `wisp bench` runs the program wisp-bench in the folder of this one, so that simulating does not require the
// benchmark to be built.
#include "commands.h"

#include <errno.h>
#include <limits.h>
#include <string.h>
#include <unistd.h>

#define BENCH_PROGRAM "wisp-bench"

// Write the path of wisp-bench. The link of /proc leads to this program's own file even if it was started through a
// symbolic link or found in PATH.
static wisp_status find_bench( char out[PATH_MAX], wisp_error* error )
{
    ssize_t length = readlink( "/proc/self/exe", out, PATH_MAX - 1 );
    if ( length < 0 )
    {
        return wisp_fail( error, WISP_IO_ERROR, "/proc/self/exe: %s", strerror( errno ) );
    }
    out[length] = '\0';
    size_t folder = (size_t)( strrchr( out, '/' ) + 1 - out );
    if ( folder + sizeof( BENCH_PROGRAM ) > PATH_MAX )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: the path of " BENCH_PROGRAM " is too long", out );
    }
    memcpy( out + folder, BENCH_PROGRAM, sizeof( BENCH_PROGRAM ) );
    return WISP_OK;
}

int command_bench( int argc, char** argv )
{
    (void)argc;
    char path[PATH_MAX];
    wisp_error error = { 0 };
    if ( find_bench( path, &error ) == WISP_OK )
    {
        execv( path, argv );
        wisp_fail( &error, WISP_IO_ERROR, "%s: %s; `wisp bench` runs this program, which `./dev bench` builds", path,
                   strerror( errno ) );
    }
    return command_fail( &error );
}
