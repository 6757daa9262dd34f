// Writes the recordings and point caches that must be refused. Run it after a change of bad_recordings.h and commit
// what it wrote:
//
//     make_bad_recordings tests/bad/recording
#include "bad_recordings.h"

#include <stdio.h>

static int write_all( const char* folder, const bad_recording* list, size_t count, void ( *good )( unsigned char* ) )
{
    for ( size_t i = 0; i < count; ++i )
    {
        unsigned char bytes[BAD_RECORDING_ROOM];
        size_t size = bad_recording_build( &list[i], good, bytes );
        char path[1024];
        snprintf( path, sizeof path, "%s/%s", folder, list[i].name );
        FILE* file = fopen( path, "wb" );
        if ( file == NULL )
        {
            perror( path );
            return 1;
        }
        size_t written = fwrite( bytes, 1, size, file );
        if ( fclose( file ) != 0 || written != size )
        {
            perror( path );
            return 1;
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
    int failed = write_all( argv[1], bad_wisps, sizeof bad_wisps / sizeof bad_wisps[0], bad_recording_good_wisp );
    return failed != 0 ? failed
                       : write_all( argv[1], bad_pc2s, sizeof bad_pc2s / sizeof bad_pc2s[0], bad_recording_good_pc2 );
}
