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
    const char* const places[] = { "../share/wisp", "../../build-web", "../../data" };
    const char* chosen = getenv( "WISP_DATA" );
    char program[PATH_MAX];
    struct stat found;
    find_program( program, sizeof program );
    snprintf( out, size, "%s/%s", chosen ? chosen : program, inner );
    for ( size_t i = 0; chosen == NULL && i < sizeof places / sizeof places[0]; ++i )
    {
        snprintf( out, size, "%s/%s/%s", program, places[i], inner );
        chosen = stat( out, &found ) == 0 ? places[i] : NULL;
    }
}
