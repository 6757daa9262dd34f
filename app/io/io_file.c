// POSIX 2008 with XSI rather than C17 alone: fsync, realpath and per-thread locales have no standard counterpart.
#define _XOPEN_SOURCE 700

#include "io_bytes.h"
#include "io_file.h"

#include "wisp/module/definition.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <locale.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum
{
    FIRST_BLOCK = 64 * 1024, // bytes, where a file's size is unknown
    NAME_SHOWN = 200,        // characters of a path that a message shows
    PARTIAL_ATTEMPTS = 100,  // names tried before giving up; one is enough unless a crash left files behind
};

// ---- memory ----------------------------------------------------------------------------------------------------

typedef struct io_block
{
    struct io_block* before;
    max_align_t bytes[];
} io_block;

void* io_get( io_memory* memory, size_t size )
{
    io_block* block = calloc( 1, sizeof *block + size );
    if ( block == NULL )
    {
        memory->is_short = true;
        return NULL;
    }
    block->before = memory->last;
    memory->last = block;
    return block->bytes;
}

void* io_copy( io_memory* memory, const void* from, size_t size )
{
    void* copy = from != NULL ? io_get( memory, size ) : NULL;
    return copy != NULL ? memcpy( copy, from, size ) : NULL;
}

void io_release( io_memory* memory )
{
    while ( memory->last != NULL )
    {
        io_block* block = memory->last;
        memory->last = block->before;
        free( block );
    }
}

// ---- names -----------------------------------------------------------------------------------------------------

bool io_is_standard( const char* path )
{
    return strcmp( path, "-" ) == 0;
}

const char* io_input_name( const char* path )
{
    return io_is_standard( path ) ? "standard input" : path;
}

const char* io_short_name( const char* name )
{
    name = io_input_name( name );
    size_t length = strlen( name );
    return length > NAME_SHOWN ? name + ( length - NAME_SHOWN ) : name;
}

const char* io_file_name( const char* path )
{
    const char* slash = strrchr( path, '/' );
    return slash ? slash + 1 : path;
}

size_t io_folder_length( const char* path )
{
    return (size_t)( io_file_name( path ) - path );
}

bool io_has_extension( const char* path, const char* extension )
{
    size_t length = strlen( path );
    size_t requested = strlen( extension );
    if ( length <= requested )
    {
        return false;
    }
    for ( size_t i = 0; i < requested; ++i )
    {
        // Not tolower(): the host's locale must not decide the kind of a file.
        char c = path[length - requested + i];
        char lower = c >= 'A' && c <= 'Z' ? (char)( c - 'A' + 'a' ) : c;
        if ( lower != extension[i] )
        {
            return false;
        }
    }
    return true;
}

bool io_is_name( const char* text, int most )
{
    int length = 0;
    for ( char c = text[0]; length <= most && c != 0; c = text[++length] )
    {
        const bool is_letter = ( c >= 'a' && c <= 'z' ) || ( c >= 'A' && c <= 'Z' ) || ( c >= '0' && c <= '9' );
        if ( !is_letter && c != '_' && c != '-' )
        {
            return false;
        }
    }
    return length >= 1 && length <= most;
}

// ---- numbers ---------------------------------------------------------------------------------------------------

void io_write_words( FILE* out, const void* words, size_t count )
{
    unsigned char bytes[4096];
    for ( size_t done = 0, size; done < count; done += size )
    {
        size = count - done < sizeof bytes / 4 ? count - done : sizeof bytes / 4;
        io_put_words( bytes, (const unsigned char*)words + 4 * done, size );
        fwrite( bytes, 4, size, out );
    }
}

// ---- bounds ----------------------------------------------------------------------------------------------------

void io_extend_bounds( io_bounds* bounds, const wisp_vec3* points, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        const wisp_vec3 p = points[v];
        const wisp_vec3 a = bounds->filled ? bounds->least : p;
        const wisp_vec3 b = bounds->filled ? bounds->most : p;
        bounds->least = ( wisp_vec3 ){ fminf( a.x, p.x ), fminf( a.y, p.y ), fminf( a.z, p.z ) };
        bounds->most = ( wisp_vec3 ){ fmaxf( b.x, p.x ), fmaxf( b.y, p.y ), fmaxf( b.z, p.z ) };
        bounds->filled = true;
    }
}

void io_print_bounds( FILE* out, const io_bounds* bounds )
{
    const wisp_vec3 a = bounds->least, b = bounds->most;
    fprintf( out, "x %.6g .. %.6g, y %.6g .. %.6g, z %.6g .. %.6g m", (double)a.x, (double)b.x, (double)a.y,
             (double)b.y, (double)a.z, (double)b.z );
}

// ---- messages --------------------------------------------------------------------------------------------------

static wisp_status system_refused( wisp_error* error, const char* path, const char* what )
{
    return wisp_fail( error, WISP_IO_ERROR, "%s: cannot %s: %s", io_short_name( path ), what, strerror( errno ) );
}

static wisp_status too_long( wisp_error* error, const char* path, size_t size_cap )
{
    return wisp_fail( error, WISP_BAD_INPUT, "%s: expected at most %zu bytes", io_short_name( path ), size_cap );
}

// ---- reading ---------------------------------------------------------------------------------------------------

// The part of standard input that readers have asked for, in a file without a name.
typedef struct kept_input
{
    int descriptor; // -1: nothing was read yet
    unsigned long long size;
    bool is_whole;
} kept_input;

static bool keep_block( kept_input* input )
{
    char block[FIRST_BLOCK];
    const ssize_t count = read( STDIN_FILENO, block, sizeof block );
    input->is_whole = count == 0;
    input->size += count > 0 ? (size_t)count : 0;
    return count >= 0 && write( input->descriptor, block, (size_t)count ) == count;
}

static int open_standard_input( unsigned long long most )
{
    static kept_input input = { .descriptor = -1 };
    if ( input.descriptor < 0 )
    {
        FILE* file = tmpfile();
        input.descriptor = file ? fcntl( fileno( file ), F_DUPFD_CLOEXEC, 0 ) : -1;
        if ( file )
        {
            fclose( file );
        }
    }
    bool is_good = input.descriptor >= 0 && lseek( input.descriptor, 0, SEEK_END ) >= 0;
    while ( is_good && !input.is_whole && input.size <= most )
    {
        is_good = keep_block( &input );
    }
    if ( is_good && input.size > IO_STANDARD_INPUT_MAX )
    {
        errno = EFBIG;
        is_good = false;
    }
    return is_good && lseek( input.descriptor, 0, SEEK_SET ) == 0 ? fcntl( input.descriptor, F_DUPFD_CLOEXEC, 0 )
                                                                  : -1;
}

int io_file_open( const char* path, int flags, unsigned long long most )
{
    return io_is_standard( path ) ? open_standard_input( most < IO_STANDARD_INPUT_MAX ? most : IO_STANDARD_INPUT_MAX )
                                  : open( path, O_RDONLY | O_CLOEXEC | flags );
}

// A regular file has a size, so one block is enough. The extra byte detects the end of the file.
static wisp_status first_capacity( FILE* file, const char* path, size_t size_cap, size_t* capacity,
                                   wisp_error* error )
{
    struct stat info;
    if ( fstat( fileno( file ), &info ) != 0 )
    {
        return system_refused( error, path, "examine" );
    }
    if ( S_ISDIR( info.st_mode ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got a folder, expected a file", io_short_name( path ) );
    }
    *capacity = FIRST_BLOCK;
    if ( S_ISREG( info.st_mode ) && info.st_size > 0 )
    {
        if ( (unsigned long long)info.st_size > size_cap )
        {
            return too_long( error, path, size_cap );
        }
        *capacity = (size_t)info.st_size + 1;
    }
    return WISP_OK;
}

// Doubles the block when it is full. The file is over the cap when one byte more than the cap has arrived.
static wisp_status read_all( FILE* file, const char* path, size_t size_cap, size_t capacity, unsigned char** bytes,
                             size_t* size, wisp_error* error )
{
    unsigned char* block = NULL;
    size_t used = 0;
    wisp_status status = WISP_OK;
    while ( status == WISP_OK )
    {
        unsigned char* larger = realloc( block, capacity );
        if ( larger == NULL )
        {
            status = wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %zu bytes", io_short_name( path ),
                                capacity );
            break;
        }
        block = larger;
        used += fread( block + used, 1, capacity - used, file );
        if ( ferror( file ) )
        {
            status = system_refused( error, path, "read" );
        }
        else if ( used > size_cap )
        {
            status = too_long( error, path, size_cap );
        }
        else if ( used < capacity )
        {
            break;
        }
        capacity *= 2;
    }
    if ( status != WISP_OK )
    {
        free( block );
        return status;
    }
    *bytes = block;
    *size = used;
    return WISP_OK;
}

// A block as long as the file, so that a sanitizer detects a read beyond its end.
static void trim( unsigned char** bytes, size_t size )
{
    if ( size == 0 )
    {
        free( *bytes );
        *bytes = NULL;
        return;
    }
    unsigned char* exact = realloc( *bytes, size );
    if ( exact != NULL )
    {
        *bytes = exact;
    }
}

wisp_status io_file_read( const char* path, size_t size_cap, unsigned char** bytes, size_t* size, wisp_error* error )
{
    *bytes = NULL;
    *size = 0;
    const int descriptor = io_file_open( path, 0, size_cap );
    FILE* file = descriptor >= 0 ? fdopen( descriptor, "rb" ) : NULL;
    if ( file == NULL )
    {
        return system_refused( error, path, "open" );
    }
    size_t capacity = 0;
    wisp_status status = first_capacity( file, path, size_cap, &capacity, error );
    if ( status == WISP_OK )
    {
        status = read_all( file, path, size_cap, capacity, bytes, size, error );
    }
    fclose( file );
    if ( status == WISP_OK )
    {
        trim( bytes, *size );
    }
    return status;
}

// ---- writing ---------------------------------------------------------------------------------------------------

static wisp_status no_memory( wisp_error* error, const char* path )
{
    return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for a path", io_short_name( path ) );
}

// A hidden name in the folder of `path`; short, because the folder's limit counts for it as well.
static char* partial_name( const char* path, int attempt )
{
    const size_t folder = io_folder_length( path ), room = folder + 64;
    char* name = malloc( room );
    if ( name != NULL )
    {
        memcpy( name, path, folder );
        snprintf( name + folder, room - folder, ".wisp-%ld-%d.partial", (long)getpid(), attempt );
    }
    return name;
}

// O_EXCL: an existing name belongs to another writer, or to a malicious symbolic link.
static wisp_status open_partial( const char* path, io_output* output, int* descriptor, wisp_error* error )
{
    for ( int attempt = 0; attempt < PARTIAL_ATTEMPTS; ++attempt )
    {
        char* name = partial_name( output->path, attempt );
        if ( name == NULL )
        {
            return no_memory( error, path );
        }
        *descriptor = open( name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666 );
        if ( *descriptor >= 0 )
        {
            output->partial = name;
            return WISP_OK;
        }
        int reason = errno;
        free( name );
        errno = reason;
        if ( reason != EEXIST )
        {
            break;
        }
    }
    return system_refused( error, path, "create a file beside it" );
}

// A file without a name in the folder of the final one. @return false where the system has none
static bool open_nameless( io_output* output, int* descriptor )
{
#if defined( O_TMPFILE ) && defined( __linux__ )
    char* slash = strrchr( output->path, '/' );
    char* folder = slash == NULL           ? strdup( "." )
                   : slash == output->path ? strdup( "/" )
                                           : strndup( output->path, (size_t)( slash - output->path ) );
    const bool has_links = access( "/proc/self/fd", X_OK ) == 0;
    *descriptor = folder && has_links ? open( folder, O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666 ) : -1;
    free( folder );
    return *descriptor >= 0;
#else
    (void)output;
    (void)descriptor;
    return false;
#endif
}

// Give the file the final name, or a hidden one beside it if the final one is taken: only renaming replaces a file.
static bool give_name( io_output* output )
{
#if defined( O_TMPFILE ) && defined( __linux__ )
    char link[64];
    snprintf( link, sizeof link, "/proc/self/fd/%d", fileno( output->stream ) );
    if ( linkat( AT_FDCWD, link, AT_FDCWD, output->path, AT_SYMLINK_FOLLOW ) == 0 )
    {
        return true;
    }
    for ( int attempt = 0; attempt < PARTIAL_ATTEMPTS && errno == EEXIST; ++attempt )
    {
        char* name = partial_name( output->path, attempt );
        if ( name != NULL && linkat( AT_FDCWD, link, AT_FDCWD, name, AT_SYMLINK_FOLLOW ) == 0 )
        {
            output->partial = name;
            return true;
        }
        const int reason = name != NULL ? errno : ENOMEM;
        free( name );
        errno = reason;
    }
#else
    (void)output;
#endif
    return false;
}

// Initial target of the bytes. A device or a pipe is written in place: renaming over /dev/stdout would destroy it.
static wisp_status open_descriptor( const char* path, io_output* output, int* descriptor, wisp_error* error )
{
    struct stat info;
    if ( io_is_standard( path ) )
    {
        fflush( stdout );
        output->in_place = true;
        output->path = strdup( "standard output" );
        *descriptor = fcntl( STDOUT_FILENO, F_DUPFD_CLOEXEC, 0 );
        return output->path == NULL ? no_memory( error, path )
               : *descriptor >= 0   ? WISP_OK
                                    : system_refused( error, output->path, "open for writing" );
    }
    bool exists = stat( path, &info ) == 0;
    if ( exists && S_ISDIR( info.st_mode ) )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: got a folder, expected a file", io_short_name( path ) );
    }
    // A folder's permission to rename is not the file's permission to be written.
    if ( exists && access( path, W_OK ) != 0 )
    {
        return system_refused( error, path, "open for writing" );
    }
    output->in_place = exists && !S_ISREG( info.st_mode );
    output->path = exists && !output->in_place ? realpath( path, NULL ) : strdup( path );
    if ( output->path == NULL )
    {
        return no_memory( error, path );
    }
    if ( output->in_place )
    {
        *descriptor = open( path, O_WRONLY | O_CLOEXEC );
        return *descriptor >= 0 ? WISP_OK : system_refused( error, path, "open for writing" );
    }
    output->has_name = !open_nameless( output, descriptor );
    wisp_status status = output->has_name ? open_partial( path, output, descriptor, error ) : WISP_OK;
    if ( status == WISP_OK && exists && fchmod( *descriptor, info.st_mode & 07777 ) != 0 )
    {
        status = system_refused( error, path, "keep the permissions" );
    }
    return status;
}

static void forget( io_output* output )
{
    if ( output->partial != NULL )
    {
        unlink( output->partial );
    }
    free( output->partial );
    free( output->path );
    *output = ( io_output ){ 0 };
}

wisp_status io_output_open( const char* path, io_output* output, wisp_error* error )
{
    *output = ( io_output ){ 0 };
    int descriptor = -1;
    wisp_status status = open_descriptor( path, output, &descriptor, error );
    if ( status == WISP_OK )
    {
        output->stream = fdopen( descriptor, "wb" );
        if ( output->stream == NULL )
        {
            status = system_refused( error, path, "open for writing" );
        }
    }
    if ( status != WISP_OK )
    {
        if ( descriptor >= 0 )
        {
            close( descriptor );
        }
        forget( output );
    }
    return status;
}

wisp_status io_output_commit( io_output* output, wisp_error* error )
{
    const char* path = output->path;

    // errno of an earlier failed write is lost, hence the zero: strerror must not report something unrelated.
    errno = 0;
    bool failed = ferror( output->stream ) != 0;
    failed = fflush( output->stream ) != 0 || failed;
    // Without fsync a power failure after the rename can leave the new name with no content.
    failed = failed || ( !output->in_place && fsync( fileno( output->stream ) ) != 0 );
    failed = failed || ( !output->in_place && !output->has_name && !give_name( output ) );
    int reason = errno;
    if ( fclose( output->stream ) != 0 && !failed )
    {
        failed = true;
        reason = errno;
    }
    wisp_status status = WISP_OK;
    if ( failed )
    {
        status = wisp_fail( error, WISP_IO_ERROR, "%s: cannot write: %s", io_short_name( path ),
                            reason != 0 ? strerror( reason ) : "an earlier write failed" );
    }
    else if ( output->partial != NULL && rename( output->partial, output->path ) != 0 )
    {
        status = system_refused( error, path, "put the new file in place" );
    }
    else
    {
        free( output->partial );
        output->partial = NULL;
    }
    forget( output );
    return status;
}

void io_output_discard( io_output* output )
{
    fclose( output->stream );
    forget( output );
}

wisp_status io_output_end( io_output* output, wisp_status status, wisp_error* error )
{
    if ( status != WISP_OK )
    {
        io_output_discard( output );
        return status;
    }
    return io_output_commit( output, error );
}

wisp_status io_folder_make( const char* path, wisp_error* error )
{
    struct stat info;
    bool is_there = mkdir( path, 0777 ) == 0;
    is_there = is_there || ( errno == EEXIST && stat( path, &info ) == 0 && S_ISDIR( info.st_mode ) );
    return is_there ? WISP_OK : system_refused( error, path, "make a folder" );
}

// ---- numbers ---------------------------------------------------------------------------------------------------

wisp_status io_numbers_begin( io_numbers* numbers, wisp_error* error )
{
    locale_t plain = newlocale( LC_ALL_MASK, "C", (locale_t)0 );
    if ( plain == (locale_t)0 )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for a numeric locale" );
    }
    numbers->plain = plain;
    numbers->previous = uselocale( plain );
    return WISP_OK;
}

void io_numbers_end( io_numbers* numbers )
{
    uselocale( (locale_t)numbers->previous );
    freelocale( (locale_t)numbers->plain );
    *numbers = ( io_numbers ){ 0 };
}

wisp_status io_file_write( const char* path, const void* bytes, size_t size, wisp_error* error )
{
    io_output output;
    WISP_TRY( io_output_open( path, &output, error ) );
    fwrite( bytes, 1, size, output.stream );
    return io_output_commit( &output, error );
}
