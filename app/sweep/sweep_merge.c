#include "sweep_merge.h"

#include "io_file.h"
#include "sweep_item.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- the folder ----

typedef struct listing
{
    int shards;      // of the first part that was found; 0: none
    uint8_t* states; // [shards] 0: missing, 1: running, 2: done
} listing;

static wisp_status list_part( const char* folder, const char* name, listing* out, wisp_error* error )
{
    int shard, shards;
    bool is_done;
    if ( !sweep_part_of_name( name, &shard, &shards, &is_done ) )
    {
        return WISP_OK;
    }
    if ( out->shards == 0 )
    {
        out->shards = shards;
        out->states = calloc( (size_t)shards, 1 );
        if ( out->states == NULL )
        {
            return wisp_fail( error, WISP_NO_MEMORY, "no memory for %d shards", shards );
        }
    }
    if ( shards != out->shards )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: has parts of %d shards and of %d", io_short_name( folder ),
                          out->shards < shards ? out->shards : shards, out->shards < shards ? shards : out->shards );
    }
    const uint8_t state = is_done ? 2 : 1;
    out->states[shard] = state > out->states[shard] ? state : out->states[shard];
    return WISP_OK;
}

static wisp_status list_folder( const char* folder, listing* out, wisp_error* error )
{
    DIR* stream = opendir( folder );
    if ( stream == NULL )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: %s", io_short_name( folder ), strerror( errno ) );
    }
    wisp_status status = WISP_OK;
    for ( const struct dirent* entry; status == WISP_OK && ( entry = readdir( stream ) ) != NULL; )
    {
        status = list_part( folder, entry->d_name, out, error );
    }
    closedir( stream );
    return status != WISP_OK || out->shards > 0
               ? status
               : wisp_fail( error, WISP_BAD_INPUT, "%s: has no part of a sweep, such as part-0001-of-0004.jsonl",
                            io_short_name( folder ) );
}

// Say what is missing: the first, and how many more.
static wisp_status check_listing( const char* folder, const listing* all, wisp_error* error )
{
    int first = -1, more = 0;
    for ( int i = 0; i < all->shards; ++i )
    {
        more += all->states[i] < 2 && first >= 0 ? 1 : 0;
        first = all->states[i] < 2 && first < 0 ? i : first;
    }
    if ( first < 0 )
    {
        return WISP_OK;
    }
    char others[64] = "";
    if ( more > 0 )
    {
        snprintf( others, sizeof others, "; %d more are missing or not done", more );
    }
    return wisp_fail(
        error, WISP_BAD_INPUT, "%s: shard %d of %d %s%s", io_short_name( folder ), first + 1, all->shards,
        all->states[first] == 1 ? "is not done; `wisp sweep --resume` goes on with it" : "is not there", others );
}

// ---- items ----

static wisp_status check_part( const sweep_merge* merge, int part, const char* path, wisp_error* error )
{
    const sweep_header *h = &merge->parts[part].header, *first = &merge->parts[0].header;
    const char* difference = sweep_difference( first, h );
    if ( merge->parts[part].whole == 0 || h->shard != part || h->shards != merge->part_count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: is not the part that its name says", io_short_name( path ) );
    }
    return difference == NULL
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "%s: is of %s than part 1", io_short_name( path ), difference );
}

static const char* name_of( const sweep_record* r, char out[SUITE_MAX_LABEL] )
{
    snprintf( out, SUITE_MAX_LABEL, "%s%s%s", r->name, r->variant[0] ? ": " : "", r->variant );
    return out;
}

// How much a record says: 0, it was not run, as on a machine that lacks the memory; 1, it was; 2, it was, and something was wrong.
static int weight_of( const sweep_record* r )
{
    return r->failure[0] == '\0' ? 1 : r->hash != 0 ? 2 : 0;
}

// Whether two runs of an item are one.
static bool agrees( const sweep_record* a, const sweep_record* b )
{
    const double e = a->values[SUITE_ERROR], f = b->values[SUITE_ERROR];
    const bool is_same = a->hash == b->hash && a->steps == b->steps && strcmp( a->verdict, b->verdict ) == 0 &&
                         ( e == f || ( isnan( e ) && isnan( f ) ) );
    return a->key == b->key && ( is_same || weight_of( a ) == 0 || weight_of( b ) == 0 );
}

static wisp_status add_item( sweep_merge* merge, int part, const sweep_record* record, wisp_error* error )
{
    sweep_merged* item = merge->items + record->item;
    const sweep_shard shard = { .index = part, .count = merge->part_count };
    char name[SUITE_MAX_LABEL];
    if ( !sweep_runs( &shard, record->key ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "item %d (%s): is not of shard %d, which has it", record->item + 1,
                          name_of( record, name ), part + 1 );
    }
    if ( item->record != NULL && !agrees( item->record, record ) && item->record->hash == record->hash )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "item %d (%s): shards %d and %d have the same bits and different errors, steps or verdicts",
                          record->item + 1, name_of( record, name ), item->part + 1, part + 1 );
    }
    if ( item->record != NULL && !agrees( item->record, record ) )
    {
        return wisp_fail(
            error, WISP_BAD_INPUT,
            "item %d (%s): shards %d and %d have different bits, %016llx and %016llx; one of the machines, or a "
            "file that its scene names, differs",
            record->item + 1, name_of( record, name ), item->part + 1, part + 1,
            (unsigned long long)item->record->hash, (unsigned long long)record->hash );
    }
    merge->run_twice += item->record != NULL && item->part != part ? 1 : 0;
    if ( item->record == NULL || weight_of( item->record ) < weight_of( record ) )
    {
        item->record = record;
        item->part = part;
    }
    if ( item->timed == NULL && record->time_count > 0 )
    {
        item->timed = record;
        item->timed_part = part;
    }
    return WISP_OK;
}

static wisp_status gather( const char* folder, sweep_merge* merge, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int part = 0; part < merge->part_count && status == WISP_OK; ++part )
    {
        char path[SWEEP_MAX_PATH];
        sweep_part_path( folder, part, merge->part_count, true, path );
        status = sweep_part_read( path, merge->parts + part, error );
        status = status == WISP_OK ? check_part( merge, part, path, error ) : status;
        if ( status == WISP_OK && part == 0 )
        {
            merge->items = calloc( (size_t)merge->parts[0].header.items, sizeof *merge->items );
            status = merge->items != NULL ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for items" );
        }
        for ( int i = 0; i < merge->parts[part].count && status == WISP_OK; ++i )
        {
            status = add_item( merge, part, merge->parts[part].records + i, error );
        }
    }
    return status;
}

// Items that nobody ran, and items that only one of two shards ran.
static wisp_status check_items( const sweep_merge* merge, wisp_error* error )
{
    const int items = merge->parts[0].header.items;
    int twice = 0;
    for ( int i = 0; i < items; ++i )
    {
        if ( merge->items[i].record == NULL )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "item %d of %d is in no part", i + 1, items );
        }
        twice += merge->part_count > 1 && sweep_is_run_twice( merge->items[i].record->key ) ? 1 : 0;
    }
    return merge->run_twice == twice
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "%d of %d items that two shards run are in one part alone",
                            twice - merge->run_twice, twice );
}

wisp_status sweep_merge_read( const char* folder, sweep_merge* out, wisp_error* error )
{
    *out = ( sweep_merge ){ 0 };
    listing all = { 0 };
    wisp_status status = list_folder( folder, &all, error );
    status = status == WISP_OK ? check_listing( folder, &all, error ) : status;
    free( all.states );
    if ( status != WISP_OK )
    {
        return status;
    }
    out->part_count = all.shards;
    out->parts = calloc( (size_t)all.shards, sizeof *out->parts );
    if ( out->parts == NULL )
    {
        out->part_count = 0;
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %d parts", all.shards );
    }
    status = gather( folder, out, error );
    return status == WISP_OK ? check_items( out, error ) : status;
}

void sweep_merge_release( sweep_merge* merge )
{
    for ( int i = 0; i < merge->part_count; ++i )
    {
        sweep_part_release( merge->parts + i );
    }
    free( merge->parts );
    free( merge->items );
    *merge = ( sweep_merge ){ 0 };
}
