// Runs a fuzz target over the files named on the command line, for compilers without libFuzzer: link it with one
// target. A finding stops the program as it would stop the fuzzer.
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size );

// The whole file in a block exactly as long, so that a checker sees a read past its end; an empty file gets one byte.
static unsigned char* read_whole( FILE* file, size_t* size )
{
    if ( fseek( file, 0, SEEK_END ) != 0 )
    {
        return NULL;
    }
    long end = ftell( file );
    if ( end < 0 || fseek( file, 0, SEEK_SET ) != 0 )
    {
        return NULL;
    }
    *size = (size_t)end;
    unsigned char* bytes = malloc( end > 0 ? *size : 1 );
    if ( bytes != NULL && fread( bytes, 1, *size, file ) != *size )
    {
        free( bytes );
        bytes = NULL;
    }
    return bytes;
}

static int replay( const char* path )
{
    FILE* file = fopen( path, "rb" );
    if ( file == NULL )
    {
        perror( path );
        return 1;
    }
    size_t size = 0;
    unsigned char* bytes = read_whole( file, &size );
    fclose( file );
    if ( bytes == NULL )
    {
        fprintf( stderr, "%s: cannot be read\n", path );
        return 1;
    }
    printf( "%s: %zu bytes\n", path, size );
    LLVMFuzzerTestOneInput( bytes, size );
    free( bytes );
    return 0;
}

int main( int argc, char** argv )
{
    if ( argc < 2 )
    {
        fprintf( stderr, "usage: %s FILE...\n", argv[0] );
        return 64;
    }
    int failed = 0;
    for ( int i = 1; i < argc; ++i )
    {
        failed |= replay( argv[i] );
    }
    return failed;
}
