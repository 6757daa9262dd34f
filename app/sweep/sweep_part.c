#include "sweep_header.h"

#include "io_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum
{
    MAX_BYTES = 1 << 28, // of a part
};

static const double SYNC_SECONDS = 1.0; // so often lines are brought to the disk

// ---- names ----

void sweep_part_path( const char* folder, int shard, int shards, bool is_done, char out[SWEEP_MAX_PATH] )
{
    snprintf( out, SWEEP_MAX_PATH, "%.900s/part-%04d-of-%04d.%s", folder, shard + 1, shards,
              is_done ? "jsonl" : "running" );
}

bool sweep_part_of_name( const char* name, int* shard, int* shards, bool* is_done )
{
    int used = 0;
    if ( sscanf( name, "part-%4d-of-%4d.%n", shard, shards, &used ) != 2 || used == 0 )
    {
        return false;
    }
    char exact[64];
    *is_done = strcmp( name + used, "jsonl" ) == 0;
    snprintf( exact, sizeof exact, "part-%04d-of-%04d.%s", *shard, *shards, *is_done ? "jsonl" : "running" );
    *shard -= 1;
    return strcmp( name, exact ) == 0 && *shards >= 1 && *shard >= 0 && *shard < *shards;
}

// ---- reading ----

static wisp_status add_record( const char* line, size_t size, const char* path, int number, sweep_part* out,
                               wisp_error* error )
{
    sweep_record record;
    if ( size > SWEEP_MAX_LINE || !sweep_record_read( line, size, &record ) || record.item >= out->header.items )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s:%d: expected a record of a sweep", io_short_name( path ),
                          number );
    }
    if ( ( out->count & ( out->count - 1 ) ) == 0 )
    {
        const size_t room = out->count > 0 ? 2 * (size_t)out->count : 1;
        sweep_record* records = realloc( out->records, room * sizeof *records );
        if ( records == NULL )
        {
            return wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for its records", io_short_name( path ) );
        }
        out->records = records;
    }
    out->records[out->count++] = record;
    return WISP_OK;
}

wisp_status sweep_part_parse( const char* bytes, size_t size, const char* path, sweep_part* out, wisp_error* error )
{
    *out = ( sweep_part ){ 0 };
    wisp_status status = WISP_OK;
    int number = 1;
    for ( const char* end; status == WISP_OK && ( end = memchr( bytes + out->whole, '\n', size - out->whole ) );
          ++number )
    {
        const char* line = bytes + out->whole;
        const size_t length = (size_t)( end - line );
        if ( number == 1 && ( length > SWEEP_MAX_LINE || !sweep_header_read( line, length, &out->header ) ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s:1: expected the header of a part of a sweep",
                              io_short_name( path ) );
        }
        status = number > 1 ? add_record( line, length, path, number, out, error ) : WISP_OK;
        out->whole += status == WISP_OK ? length + 1 : 0;
    }
    return status;
}

wisp_status sweep_part_read( const char* path, sweep_part* out, wisp_error* error )
{
    unsigned char* bytes = NULL;
    size_t size = 0;
    *out = ( sweep_part ){ 0 };
    wisp_status status = io_file_read( path, MAX_BYTES, &bytes, &size, error );
    if ( status == WISP_OK && size > 0 )
    {
        status = sweep_part_parse( (const char*)bytes, size, path, out, error );
    }
    free( bytes );
    return status;
}

void sweep_part_release( sweep_part* part )
{
    free( part->records );
    *part = ( sweep_part ){ 0 };
}

// ---- writing ----

static wisp_status fail_by_errno( const char* path, const char* what, int number, wisp_error* error )
{
    return wisp_fail( error, WISP_IO_ERROR, "%s: %s: %s", io_short_name( path ), what, strerror( number ) );
}

// A line that is not written whole is cut off again. Where even that fails, the next reader leaves out what has no end.
static wisp_status write_line( sweep_writer* w, char* line, wisp_error* error )
{
    if ( line == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for a line", io_short_name( w->running ) );
    }
    const size_t size = strlen( line ) + 1;
    const off_t before = lseek( w->file, 0, SEEK_END );
    size_t done = 0;
    line[size - 1] = '\n';
    while ( done < size )
    {
        const ssize_t count = write( w->file, line + done, size - done );
        if ( count <= 0 && errno != EINTR )
        {
            break;
        }
        done += count > 0 ? (size_t)count : 0;
    }
    const int number = errno;
    free( line );
    if ( done == size )
    {
        return WISP_OK;
    }
    const bool is_cut = before >= 0 && ftruncate( w->file, before ) == 0;
    return fail_by_errno( w->running, is_cut ? "cannot be written" : "cannot be written, and ends within a line",
                          number, error );
}

// @return WISP_CONFLICT: it is of another sweep
static wisp_status check_same( const char* path, const sweep_header* found, const sweep_header* wanted,
                               wisp_error* error )
{
    const char* difference = sweep_difference( found, wanted );
    difference = difference == NULL && found->is_exclusive != wanted->is_exclusive
                     ? found->is_exclusive ? "a run with --exclusive" : "a run without --exclusive"
                     : difference;
    return difference == NULL ? WISP_OK
                              : wisp_fail( error, WISP_CONFLICT, "%s: is of %s; choose another folder",
                                           io_short_name( path ), difference );
}

// A part that is done. @return WISP_OK also if there is none
static wisp_status look_for_done( const sweep_header* header, bool resume, sweep_writer* w, sweep_part* found,
                                  wisp_error* error )
{
    struct stat info;
    if ( stat( w->done, &info ) != 0 )
    {
        return WISP_OK;
    }
    if ( resume == false )
    {
        return wisp_fail( error, WISP_CONFLICT,
                          "%s: exists, the shard is done; --resume accepts it, another folder begins again",
                          io_short_name( w->done ) );
    }
    const wisp_status status = sweep_part_read( w->done, found, error );
    w->is_done = status == WISP_OK;
    return status == WISP_OK ? check_same( w->done, &found->header, header, error ) : status;
}

// Read what a process before has written, and cut off the line in which it was stopped.
static wisp_status take_over( const sweep_header* header, bool resume, sweep_writer* w, sweep_part* found,
                              wisp_error* error )
{
    struct stat info;
    if ( fstat( w->file, &info ) != 0 || info.st_size == 0 )
    {
        return WISP_OK;
    }
    if ( resume == false )
    {
        return wisp_fail( error, WISP_CONFLICT,
                          "%s: exists, the shard was begun; --resume goes on with it, another folder begins again",
                          io_short_name( w->running ) );
    }
    wisp_status status = sweep_part_read( w->running, found, error );
    status = status == WISP_OK && found->whole > 0 ? check_same( w->running, &found->header, header, error ) : status;
    return status == WISP_OK && ftruncate( w->file, (off_t)found->whole ) != 0
               ? fail_by_errno( w->running, "cannot be cut", errno, error )
               : status;
}

static wisp_status open_running( sweep_writer* w, wisp_error* error )
{
    w->file = open( w->running, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666 );
    if ( w->file < 0 )
    {
        return fail_by_errno( w->running, "cannot be opened", errno, error );
    }
    if ( flock( w->file, LOCK_EX | LOCK_NB ) == 0 )
    {
        return WISP_OK;
    }
    if ( errno == EWOULDBLOCK )
    {
        return wisp_fail( error, WISP_CONFLICT, "%s: another process writes it", io_short_name( w->running ) );
    }
    fprintf( stderr, "wisp: %s: cannot be locked (%s), so no two processes may run this shard\n",
             io_short_name( w->running ), strerror( errno ) );
    return WISP_OK;
}

wisp_status sweep_writer_open( const char* folder, const sweep_header* header, bool resume, sweep_writer* out,
                               sweep_part* found, wisp_error* error )
{
    *out = ( sweep_writer ){ .file = -1 };
    *found = ( sweep_part ){ 0 };
    sweep_part_path( folder, header->shard, header->shards, false, out->running );
    sweep_part_path( folder, header->shard, header->shards, true, out->done );
    wisp_status status = look_for_done( header, resume, out, found, error );
    if ( status != WISP_OK || out->is_done )
    {
        return status;
    }
    status = open_running( out, error );
    // the process that held the lock may have finished since the first look
    status = status == WISP_OK ? look_for_done( header, resume, out, found, error ) : status;
    if ( status == WISP_OK && out->is_done )
    {
        unlink( out->running );
        sweep_writer_close( out );
        return WISP_OK;
    }
    status = status == WISP_OK ? take_over( header, resume, out, found, error ) : status;
    if ( status == WISP_OK && found->whole == 0 )
    {
        status = write_line( out, sweep_header_write( header ), error );
    }
    if ( status != WISP_OK )
    {
        sweep_writer_close( out );
    }
    return status;
}

wisp_status sweep_writer_add( sweep_writer* w, const sweep_record* record, wisp_error* error )
{
    const wisp_status status = write_line( w, sweep_record_write( record ), error );
    const double now = wisp_clock_seconds();
    if ( status != WISP_OK || now - w->synced < SYNC_SECONDS )
    {
        return status;
    }
    w->synced = now;
    return fdatasync( w->file ) == 0 ? WISP_OK
                                     : fail_by_errno( w->running, "cannot be brought to the disk", errno, error );
}

void sweep_writer_close( sweep_writer* w )
{
    if ( w->file >= 0 )
    {
        close( w->file );
        w->file = -1;
    }
}

wisp_status sweep_writer_finish( sweep_writer* w, wisp_error* error )
{
    wisp_status status =
        fsync( w->file ) == 0 ? WISP_OK : fail_by_errno( w->running, "cannot be brought to the disk", errno, error );
    if ( status == WISP_OK && rename( w->running, w->done ) != 0 )
    {
        status = fail_by_errno( w->done, "cannot be named so", errno, error );
    }
    sweep_writer_close( w );
    return status;
}
