// Bytes of a recording, from a file or from memory. Files are read piece by piece: a recording may be larger than
// memory. They are not mapped, because truncating a mapped file during a read kills the process.
#define _XOPEN_SOURCE 700

#include "record_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static wisp_status examine( const char* path, record_source* source, wisp_error* error )
{
    struct stat info;
    if ( fstat( source->descriptor, &info ) != 0 )
    {
        return record_refused( path, "examine", error );
    }
    if ( !S_ISREG( info.st_mode ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %s, expected a file", io_short_name( path ),
                          S_ISDIR( info.st_mode ) ? "a folder" : "a device or a pipe" );
    }
    source->size = (uint64_t)info.st_size;
    source->name = strdup( io_short_name( path ) );
    return source->name != NULL ? WISP_OK : record_no_memory( path, error );
}

wisp_status record_source_open( const char* path, record_source* source, wisp_error* error )
{
    *source = ( record_source ){ .descriptor = -1 };
    // Without O_NONBLOCK a pipe without a writer would block the caller before it can be rejected.
    source->descriptor = io_file_open( path, O_NONBLOCK, IO_STANDARD_INPUT_MAX );
    if ( source->descriptor < 0 )
    {
        return record_refused( path, "open", error );
    }
    wisp_status status = examine( path, source, error );
    if ( status != WISP_OK )
    {
        record_source_close( source );
    }
    return status;
}

wisp_status record_source_open_memory( const void* bytes, size_t size, const char* name, record_source* source,
                                       wisp_error* error )
{
    // Null marks a file, so empty memory needs an address too.
    static const unsigned char nothing[1];
    *source = ( record_source ){
        .bytes = size > 0 ? bytes : nothing,
        .size = size,
        .descriptor = -1,
        .name = strdup( io_short_name( name ) ),
    };
    return source->name != NULL ? WISP_OK : record_no_memory( name, error );
}

void record_source_close( record_source* source )
{
    if ( source->descriptor >= 0 )
    {
        close( source->descriptor );
    }
    free( source->buffer );
    free( source->name );
    *source = ( record_source ){ .descriptor = -1 };
}

static wisp_status make_room( record_source* source, size_t size, wisp_error* error )
{
    if ( size <= source->buffer_size )
    {
        return WISP_OK;
    }
    unsigned char* larger = realloc( source->buffer, size );
    if ( larger == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %zu bytes", source->name, size );
    }
    source->buffer = larger;
    source->buffer_size = size;
    return WISP_OK;
}

wisp_status record_source_read( record_source* source, uint64_t at, size_t size, const unsigned char** view,
                                wisp_error* error )
{
    if ( source->bytes != NULL )
    {
        *view = source->bytes + at;
        return WISP_OK;
    }
    wisp_status status = make_room( source, size, error );
    for ( size_t done = 0; status == WISP_OK && done < size; )
    {
        ssize_t got = pread( source->descriptor, source->buffer + done, size - done, (off_t)( at + done ) );
        if ( got > 0 )
        {
            done += (size_t)got;
        }
        else if ( got == 0 )
        {
            status = wisp_fail( error, WISP_IO_ERROR, "%s: byte %llu: the file became shorter while it was read",
                                source->name, (unsigned long long)( at + done ) );
        }
        else if ( errno != EINTR )
        {
            status = record_refused( source->name, "read", error );
        }
    }
    *view = source->buffer;
    return status;
}
