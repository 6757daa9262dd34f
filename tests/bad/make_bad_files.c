// Writes the groom files and recordings that must be refused. Run it after a change of their lists and commit its
// files:
//
//     make_bad_files tests/bad
#include "bad_grooms.h"
#include "bad_recordings.h"

#include <stdio.h>

static int write_all( const char* root, const char* folder, const bad_file_list* lists, int list_count )
{
    for ( int l = 0; l < list_count; ++l )
    {
        for ( int i = 0; i < lists[l].count; ++i )
        {
            unsigned char bytes[BAD_FILE_MAX];
            size_t size = bad_file_build( lists + l, i, bytes );
            char path[1024];
            snprintf( path, sizeof path, "%s/%s/%s", root, folder, lists[l].files[i].name );
            FILE* file = fopen( path, "wb" );
            size_t written = file != NULL ? fwrite( bytes, 1, size, file ) : 0;
            if ( file == NULL || fclose( file ) != 0 || written != size )
            {
                perror( path );
                return 1;
            }
        }
    }
    return 0;
}

int main( int argc, char** argv )
{
    if ( argc != 2 )
    {
        fprintf( stderr, "usage: %s FOLDER\n", argv[0] );
        return 64;
    }
    return write_all( argv[1], "groom", &bad_groom_list, 1 ) |
           write_all( argv[1], "recording", bad_recording_lists, 3 );
}
