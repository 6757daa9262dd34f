#include "bench_data.h"

#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_folder( const char* path )
{
    struct stat found;
    return stat( path, &found ) == 0 && S_ISDIR( found.st_mode );
}

// The folder of this program, of the links to it too.
static void find_program( char* out, size_t size )
{
    const ssize_t length = readlink( "/proc/self/exe", out, size - 1 );
    out[length > 0 ? length : 0] = '\0';
    char* slash = strrchr( out, '/' );
    *( slash ? slash : out ) = '\0';
}

void bench_data_path( const char* inner, char* out, size_t size )
{
    const char* const places[] = { "../share/wisp", "../../data" };
    const char* chosen = getenv( "WISP_DATA" );
    char program[PATH_MAX], folder[PATH_MAX + 32];
    find_program( program, sizeof program );
    for ( size_t i = 0; chosen == NULL && i < sizeof places / sizeof places[0]; ++i )
    {
        // Tests run from another folder of the build than the program.
        snprintf( folder, sizeof folder, "%s/%s", program, places[i] );
        chosen = is_folder( folder ) ? folder : NULL;
    }
    snprintf( out, size, "%s/%s", chosen ? chosen : folder, inner );
}
