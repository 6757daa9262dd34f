#include "view_page.h"

#include "base64.h"
#include "io_file.h"
#include "program_data.h"
#include "results_write.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define PAGE_MAX_BYTES ( 64u << 20 )

static const char place_begin[] = "<script type=\"application/json\" id=\"wisp-data\">";
static const char place_word[] = "null";

// ---- data ----

// @return a string for json_decref(), null without memory
static json_t* encode( const unsigned char* bytes, size_t size )
{
    char* text = NULL;
    size_t length = 0;
    FILE* stream = open_memstream( &text, &length );
    if ( !stream )
    {
        return NULL;
    }
    io_base64 letters = { .out = stream };
    io_base64_put( &letters, bytes, size );
    io_base64_end( &letters );
    const bool is_whole = !ferror( stream );
    json_t* string = fclose( stream ) == 0 && is_whole ? json_stringn( text, length ) : NULL;
    free( text );
    return string;
}

wisp_status view_add_file( json_t* files, const char* name, const char* path, size_t* total, wisp_error* error )
{
    json_t* word = json_string( name );
    if ( !word )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got a file name that is not UTF-8, which a page cannot hold",
                          path );
    }
    json_decref( word );
    unsigned char* bytes;
    size_t size;
    const wisp_status status = io_file_read( path, VIEW_MAX_BYTES, &bytes, &size, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    *total += size;
    if ( *total > VIEW_MAX_BYTES )
    {
        free( bytes );
        return wisp_fail( error, WISP_BAD_INPUT, "%s: with this file a page has more than %u MB, which is the limit",
                          path, VIEW_MAX_BYTES >> 20 );
    }
    const bool is_added = json_object_set_new( files, name, encode( bytes, size ) ) == 0;
    free( bytes );
    return is_added ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the page", path );
}

// ---- the page ----

static wisp_status read_page( unsigned char** page, size_t* size, size_t* place, wisp_error* error )
{
    char path[PATH_MAX];
    struct stat found;
    program_data_path( "viewer.html", path, sizeof path );
    if ( stat( path, &found ) != 0 )
    {
        return wisp_fail( error, WISP_IO_ERROR,
                          "%s: the page of `wisp view` is not there: './dev web' builds it, and WISP_DATA names the "
                          "folder that has it",
                          io_short_name( path ) );
    }
    wisp_status status = io_file_read( path, PAGE_MAX_BYTES, page, size, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const unsigned char* begin = *size ? memmem( *page, *size, place_begin, sizeof place_begin - 1 ) : NULL;
    const size_t at = begin ? (size_t)( begin - *page ) + sizeof place_begin - 1 : *size;
    if ( *size - at < sizeof place_word || memcmp( *page + at, place_word, sizeof place_word - 1 ) != 0 )
    {
        free( *page );
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the page has no place for data", path );
    }
    *place = at;
    return WISP_OK;
}

wisp_status view_page_write( const json_t* data, const char* path, size_t* size, wisp_error* error )
{
    unsigned char* page;
    size_t page_size, place;
    wisp_status status = read_page( &page, &page_size, &place, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    char* text = json_dumps( data, JSON_COMPACT );
    io_output output = { 0 };
    status = text ? io_output_open( path, &output, error )
                  : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the page", path );
    if ( status == WISP_OK )
    {
        const size_t behind = place + sizeof place_word - 1;
        fwrite( page, 1, place, output.stream );
        results_json_put_script( text, output.stream );
        fwrite( page + behind, 1, page_size - behind, output.stream );
        const long end = ftell( output.stream );
        *size = end > 0 ? (size_t)end : 0;
        status = io_output_commit( &output, error );
    }
    free( text );
    free( page );
    return status;
}
