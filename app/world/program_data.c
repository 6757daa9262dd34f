#include "program_data.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// The folder of this program, of the links to it too.
static void find_program( char* out, size_t size )
{
    const ssize_t length = readlink( "/proc/self/exe", out, size - 1 );
    out[length > 0 ? length : 0] = '\0';
    char* slash = strrchr( out, '/' );
    *( slash ? slash : out ) = '\0';
}

void program_data_path( const char* inner, char* out, size_t size )
{
    const char* const chosen = getenv( "WISP_DATA" );
    char program[PATH_MAX], build[PATH_MAX + 32];
    struct stat found;
    if ( chosen )
    {
        snprintf( out, size, "%s/%s", chosen, inner );
        return;
    }
    find_program( program, sizeof program );
    // meson's own folder tells a build in a tree from an installed program, which has nothing to do with any tree
    snprintf( build, sizeof build, "%s/../meson-private", program );
    if ( stat( build, &found ) != 0 )
    {
        snprintf( out, size, "%s/../share/wisp/%s", program, inner );
        return;
    }
    snprintf( out, size, "%s/../../build-web/%s", program, inner );
    if ( stat( out, &found ) != 0 )
    {
        snprintf( out, size, "%s/../../data/%s", program, inner );
    }
}
