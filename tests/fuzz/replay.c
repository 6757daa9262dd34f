// Runs a fuzz target over files and over damaged copies of them, for compilers without libFuzzer and for the test
// suite: link it with one target. A finding stops the program as it would stop the fuzzer. The damage is a function
// of the file's position on the command line and of the copy's number, so that a finding is reproducible.
#include "wisp/module/random.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size );

enum
{
    REPLAY_MAX_FILES = 4096,
    REPLAY_MAX_GROWTH = 64, // bytes that damage may add
};

typedef struct replay_input
{
    unsigned char* bytes;
    size_t size;
} replay_input;

// The whole file in a block exactly as long, so that a sanitizer detects a read beyond it; an empty file gets one
// byte.
static bool read_whole( const char* path, replay_input* input )
{
    FILE* file = fopen( path, "rb" );
    struct stat status;
    if ( file == NULL || fstat( fileno( file ), &status ) != 0 )
    {
        perror( path );
        return false;
    }
    input->size = (size_t)status.st_size;
    input->bytes = malloc( input->size > 0 ? input->size : 1 );
    bool complete = input->bytes != NULL && fread( input->bytes, 1, input->size, file ) == input->size;
    fclose( file );
    return complete;
}

typedef struct replay_dice
{
    wisp_random_key key;
    uint32_t file, copy, draw;
} replay_dice;

static size_t roll( replay_dice* dice, size_t sides )
{
    return sides == 0 ? 0 : (size_t)( wisp_random_bits( dice->key, dice->file, dice->copy, dice->draw++ ) % sides );
}

// One kind of damage: a bit, a byte, the end, a piece doubled, a piece lost.
static size_t wound( replay_dice* dice, unsigned char* bytes, size_t size, size_t room )
{
    static const unsigned char telling[] = { 0x00, 0xff, 0x7f, 0x80, 0x01, '0', '-', ':',
                                             '[',  '{',  '"',  '\n', ' ',  '&', '*' };
    size_t at = roll( dice, size ), length = 1 + roll( dice, 16 );
    length = length > size - at ? size - at : length;
    switch ( roll( dice, 5 ) )
    {
        case 0:
            bytes[at] ^= (unsigned char)( 1u << roll( dice, 8 ) );
            return size;
        case 1:
            bytes[at] = telling[roll( dice, sizeof( telling ) )];
            return size;
        case 2:
            return at;
        case 3:
            if ( size + length > room )
            {
                return size;
            }
            memmove( bytes + at + length, bytes + at, size - at );
            return size + length;
        default:
            memmove( bytes + at, bytes + at + length, size - at - length );
            return size - length;
    }
}

static void run_damaged( const replay_input* input, int file, int copies )
{
    size_t room = input->size + REPLAY_MAX_GROWTH;
    unsigned char* work = malloc( room );
    for ( int copy = 0; copy < copies && work != NULL && input->size > 0; ++copy )
    {
        replay_dice dice = { wisp_random_make_key( 1, 0, 0 ), (uint32_t)file, (uint32_t)copy, 0 };
        memcpy( work, input->bytes, input->size );
        size_t size = input->size;
        for ( size_t wounds = 1 + roll( &dice, 4 ); wounds > 0 && size > 0; --wounds )
        {
            size = wound( &dice, work, size, room );
        }
        // exactly as long again, for the sanitizer
        unsigned char* exact = malloc( size > 0 ? size : 1 );
        if ( exact != NULL )
        {
            memcpy( exact, work, size );
            LLVMFuzzerTestOneInput( exact, size );
        }
        free( exact );
    }
    free( work );
}

static int by_name( const void* a, const void* b )
{
    return strcmp( *(char* const*)a, *(char* const*)b );
}

// A file, or the files of a folder in the order of their names.
static int list_files( const char* path, char** files, int count )
{
    int first = count;
    DIR* folder = opendir( path );
    if ( folder == NULL )
    {
        files[count] = strdup( path );
        return count + 1;
    }
    for ( const struct dirent* entry; ( entry = readdir( folder ) ) != NULL && count < REPLAY_MAX_FILES; )
    {
        size_t length = strlen( path ) + strlen( entry->d_name ) + 2;
        if ( entry->d_name[0] != '.' && ( files[count] = malloc( length ) ) != NULL )
        {
            snprintf( files[count++], length, "%s/%s", path, entry->d_name );
        }
    }
    closedir( folder );
    qsort( files + first, (size_t)( count - first ), sizeof( files[0] ), by_name );
    return count;
}

int main( int argc, char** argv )
{
    int first = 1, copies = 0;
    if ( argc > 3 && strcmp( argv[1], "--damaged" ) == 0 )
    {
        copies = atoi( argv[2] );
        first = 3;
    }
    if ( argc <= first )
    {
        fprintf( stderr, "usage: %s [--damaged COPIES] FILE_OR_FOLDER...\n", argv[0] );
        return 64;
    }
    static char* files[REPLAY_MAX_FILES + 1];
    int count = 0, failed = 0;
    for ( int i = first; i < argc && count < REPLAY_MAX_FILES; ++i )
    {
        count = list_files( argv[i], files, count );
    }
    for ( int i = 0; i < count; ++i )
    {
        replay_input input = { NULL, 0 };
        if ( read_whole( files[i], &input ) )
        {
            LLVMFuzzerTestOneInput( input.bytes, input.size );
            run_damaged( &input, i, copies );
        }
        else
        {
            failed = 1;
        }
        free( input.bytes );
        free( files[i] );
    }
    printf( "%d files, %d damaged copies of each\n", count, copies );
    return failed;
}
