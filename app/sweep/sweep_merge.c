#include "sweep_merge.h"

#include "io_file.h"

#include "wisp/module/definition.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MAX_BYTES = 1 << 28, // of a part
};

wisp_status sweep_merge_begin( const sweep_row* like, const char* origin, sweep_merge* out, wisp_error* error )
{
    *out = ( sweep_merge ){ .like = *like };
    snprintf( out->origin, sizeof out->origin, "%s", origin );
    out->rows = calloc( (size_t)like->items, sizeof *out->rows );
    out->second = calloc( (size_t)like->items, sizeof *out->second );
    out->shares = calloc( (size_t)like->shards, sizeof *out->shares );
    return out->rows != NULL && out->second != NULL && out->shares != NULL
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "no memory for %d items", like->items );
}

void sweep_merge_release( sweep_merge* merge )
{
    free( merge->rows );
    free( merge->second );
    free( merge->shares );
    *merge = ( sweep_merge ){ 0 };
}

// ---- a row ----

// How much a row says: 0, it was not run, as on a machine that lacks the memory; 1, it was; 2, it was, and something was wrong.
static int weight_of( const sweep_row* r )
{
    return r->failure[0] == '\0' ? 1 : r->hash != 0 ? 2 : 0;
}

// Whether two runs of an item are one.
static wisp_status check_agrees( const sweep_row* a, const sweep_row* b, const char* place, wisp_error* error )
{
    const char* colon = a->variant[0] ? ": " : "";
    const double e = a->values[0], f = b->values[0];
    const bool is_same =
        a->steps == b->steps && strcmp( a->verdict, b->verdict ) == 0 && ( e == f || ( isnan( e ) && isnan( f ) ) );
    if ( weight_of( a ) == 0 || weight_of( b ) == 0 || ( a->hash == b->hash && is_same ) )
    {
        return WISP_OK;
    }
    return a->hash == b->hash
               ? wisp_fail( error, WISP_BAD_INPUT,
                            "%s: item %d (%s%s%s) has the bits of the run by shard %d, and another error, number of "
                            "steps or verdict",
                            place, a->item, a->name, colon, a->variant, a->shard )
               : wisp_fail( error, WISP_BAD_INPUT,
                            "%s: item %d (%s%s%s) has other bits than the run by shard %d, %016llx and %016llx; one "
                            "of the machines, "
                            "or a file that its scene names, differs",
                            place, a->item, a->name, colon, a->variant, a->shard, (unsigned long long)b->hash,
                            (unsigned long long)a->hash );
}

wisp_status sweep_merge_add( const sweep_row* row, const char* place, sweep_merge* out, wisp_error* error )
{
    const bool is_first = out->rows == NULL;
    wisp_status status = is_first ? sweep_merge_begin( row, place, out, error ) : WISP_OK;
    const char* difference = sweep_row_difference( &out->like, row );
    if ( status != WISP_OK || difference != NULL )
    {
        return status != WISP_OK ? status
                                 : wisp_fail( error, WISP_BAD_INPUT, "%s: is of another %s than %s", place,
                                              difference, out->origin );
    }
    sweep_row* kept = out->rows + row->item - 1;
    int* second = out->second + row->item - 1;
    const bool is_new = kept->item == 0, is_second = !is_new && row->shard != kept->shard && *second == 0;
    WISP_TRY( is_new ? WISP_OK : check_agrees( kept, row, place, error ) );
    const sweep_row before = *kept;
    if ( is_new || weight_of( row ) > weight_of( kept ) )
    {
        *kept = *row;
        kept->shard = is_new ? row->shard : before.shard;
    }
    if ( kept->workers == 0 && ( row->workers > 0 || before.workers > 0 ) )
    {
        sweep_row_take_times( kept, row->workers > 0 ? row : &before );
    }
    *second = is_second ? row->shard : *second;
    out->like.workers = row->workers > 0 ? row->workers : out->like.workers;
    out->shares[row->shard - 1].of = row->share;
    out->shares[row->shard - 1].there += is_new || is_second ? 1 : 0;
    out->count += is_new ? 1 : 0;
    out->run_twice += is_second ? 1 : 0;
    return WISP_OK;
}

// ---- parts ----

wisp_status sweep_merge_parse( const char* bytes, size_t size, const char* path, sweep_merge* out, size_t* whole,
                               wisp_error* error )
{
    *whole = 0;
    int number = 1;
    for ( const char* end; size > *whole && ( end = memchr( bytes + *whole, '\n', size - *whole ) ) != NULL;
          ++number )
    {
        char place[300];
        sweep_row row;
        const size_t length = (size_t)( end - bytes ) - *whole;
        snprintf( place, sizeof place, "%.280s:%d", io_short_name( path ), number );
        if ( length > SWEEP_MAX_LINE || !sweep_row_read( bytes + *whole, length, &row ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: expected a row of a sweep", place );
        }
        WISP_TRY( sweep_merge_add( &row, place, out, error ) );
        *whole += length + 1;
    }
    return WISP_OK;
}

wisp_status sweep_merge_part( const char* path, sweep_merge* out, size_t* whole, wisp_error* error )
{
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_status status = io_file_read( path, MAX_BYTES, &bytes, &size, error );
    status = status == WISP_OK ? sweep_merge_parse( (const char*)bytes, size, path, out, whole, error ) : status;
    free( bytes );
    return status;
}

static int is_part( const struct dirent* entry )
{
    return io_has_extension( entry->d_name, ".jsonl" ) ? 1 : 0;
}

// A share of which no row is there may have no items, but that is not known as long as some are missing.
static wisp_status check_missing( const sweep_merge* merge, const char* folder, wisp_error* error )
{
    const int missing = merge->like.items - merge->count;
    int first = -1, more = 0;
    for ( int i = 0; i < merge->like.shards; ++i )
    {
        const sweep_share* s = merge->shares + i;
        if ( s->there < s->of || ( s->of == 0 && missing > 0 ) )
        {
            more += first >= 0 ? 1 : 0;
            first = first < 0 ? i : first;
        }
    }
    char have[64] = "is not there", others[64] = "";
    if ( first >= 0 && merge->shares[first].of > 0 )
    {
        snprintf( have, sizeof have, "has %d of its %d items", merge->shares[first].there, merge->shares[first].of );
    }
    if ( more > 0 )
    {
        snprintf( others, sizeof others, ", and %d more have none or lack some", more );
    }
    return first >= 0    ? wisp_fail( error, WISP_BAD_INPUT,
                                      "%s: shard %d of %d %s%s; `wisp sweep` with the same folder goes on",
                                      io_short_name( folder ), first + 1, merge->like.shards, have, others )
           : missing > 0 ? wisp_fail( error, WISP_BAD_INPUT, "%s: %d of %d items are missing",
                                      io_short_name( folder ), missing, merge->like.items )
                         : WISP_OK;
}

wisp_status sweep_merge_folder( const char* folder, sweep_merge* out, wisp_error* error )
{
    *out = ( sweep_merge ){ 0 };
    struct dirent** names = NULL;
    const int count = scandir( folder, &names, is_part, alphasort );
    wisp_status status =
        count >= 0 ? WISP_OK
                   : wisp_fail( error, WISP_IO_ERROR, "%s: %s", io_short_name( folder ), strerror( errno ) );
    for ( int i = 0; i < count; ++i )
    {
        char path[1024];
        size_t whole;
        snprintf( path, sizeof path, "%.700s/%s", folder, names[i]->d_name );
        status = status == WISP_OK ? sweep_merge_part( path, out, &whole, error ) : status;
        free( names[i] );
    }
    free( names );
    if ( status == WISP_OK && out->rows == NULL )
    {
        status = wisp_fail( error, WISP_BAD_INPUT, "%s: has no part of a sweep, such as part-0001-of-0004.jsonl",
                            io_short_name( folder ) );
    }
    return status == WISP_OK ? check_missing( out, folder, error ) : status;
}
