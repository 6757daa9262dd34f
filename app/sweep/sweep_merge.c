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

// ---- a model of cost ----

// A model of cost: t = a + b S + c V S, with S substeps and V vertices. a is what a step costs once, b what a substep costs whatever it moves
// (passes, barriers), c is the work. Least squares of relative errors; every second item by size takes part in the fit, and the others
// check it.

enum
{
    TERMS = 3,
    LEAST_ITEMS = 8,
};

typedef struct sample
{
    double vertices, substeps, ms;
} sample;

static int by_work( const void* a, const void* b )
{
    const sample *p = a, *q = b;
    const double d = p->vertices * p->substeps - q->vertices * q->substeps;
    return d != 0.0 ? ( d > 0.0 ) - ( d < 0.0 ) : ( p->substeps > q->substeps ) - ( p->substeps < q->substeps );
}

static void terms_of( const sample* s, double out[TERMS] )
{
    out[0] = 1.0;
    out[1] = s->substeps;
    out[2] = s->vertices * s->substeps;
}

// Gaussian elimination with pivots. @param a [TERMS] rows, the right side last @return false: the sizes do not tell the terms apart
static bool solve( double a[TERMS][TERMS + 1], double out[TERMS] )
{
    for ( int k = 0; k < TERMS; ++k )
    {
        int pivot = k;
        for ( int i = k + 1; i < TERMS; ++i )
        {
            pivot = fabs( a[i][k] ) > fabs( a[pivot][k] ) ? i : pivot;
        }
        for ( int j = 0; j <= TERMS; ++j )
        {
            const double kept = a[k][j];
            a[k][j] = a[pivot][j];
            a[pivot][j] = kept;
        }
        if ( !( fabs( a[k][k] ) >= 1e-9 ) )
        {
            return false;
        }
        for ( int i = 0; i < TERMS; ++i )
        {
            const double factor = i == k ? 0.0 : a[i][k] / a[k][k];
            for ( int j = k; j <= TERMS; ++j )
            {
                a[i][j] -= factor * a[k][j];
            }
        }
    }
    for ( int k = 0; k < TERMS; ++k )
    {
        out[k] = a[k][TERMS] / a[k][k];
    }
    return true;
}

// Columns are scaled to one size, so that the pivots tell whether they differ.
static bool fit( const sample* samples, int count, double out[TERMS] )
{
    double a[TERMS][TERMS + 1] = { { 0.0 } }, scale[TERMS] = { 0.0 }, x[TERMS];
    for ( int i = 0; i < count; i += 2 )
    {
        terms_of( samples + i, x );
        for ( int k = 0; k < TERMS; ++k )
        {
            scale[k] = fmax( scale[k], x[k] / samples[i].ms );
        }
    }
    for ( int i = 0; i < count; i += 2 )
    {
        terms_of( samples + i, x );
        for ( int k = 0; k < TERMS; ++k )
        {
            for ( int j = 0; j < TERMS; ++j )
            {
                a[k][j] += x[k] * x[j] / ( scale[k] * scale[j] * samples[i].ms * samples[i].ms );
            }
            a[k][TERMS] += x[k] / ( scale[k] * samples[i].ms );
        }
    }
    const bool good = solve( a, out );
    for ( int k = 0; k < TERMS && good; ++k )
    {
        out[k] /= scale[k];
    }
    return good;
}

static int by_size( const void* a, const void* b )
{
    const double p = *(const double*)a, q = *(const double*)b;
    return ( p > q ) - ( p < q );
}

typedef struct model
{
    double terms[TERMS]; // ms
    int fitted, checked;
    double median, largest; // relative errors of those that are checked
} model;

static bool make_model( sample* samples, int count, model* out )
{
    *out = ( model ){ .fitted = ( count + 1 ) / 2, .checked = count / 2 };
    qsort( samples, (size_t)count, sizeof *samples, by_work );
    double* errors = calloc( (size_t)count + 1, sizeof *errors );
    const bool good = count >= LEAST_ITEMS && errors != NULL && fit( samples, count, out->terms );
    for ( int i = 1; i < count && good; i += 2 )
    {
        double x[TERMS], sum = 0.0;
        terms_of( samples + i, x );
        for ( int k = 0; k < TERMS; ++k )
        {
            sum += out->terms[k] * x[k];
        }
        errors[i / 2] = fabs( sum / samples[i].ms - 1.0 );
    }
    if ( good )
    {
        qsort( errors, (size_t)out->checked, sizeof *errors, by_size );
        out->median = errors[out->checked / 2];
        out->largest = errors[out->checked - 1];
    }
    free( errors );
    return good;
}

// Items of a scene on a processor with a number of workers. @param samples [items] buffer
static int gather_samples( const sweep_merge* merge, const sweep_merged* like, int time, sample* samples )
{
    char wanted[160], processor[160];
    sweep_processor( &merge->parts[like->timed_part].header, wanted );
    int count = 0;
    for ( int i = 0; i < merge->parts[0].header.items; ++i )
    {
        const sweep_merged* item = merge->items + i;
        const sweep_record* r = item->timed;
        if ( r == NULL || strcmp( r->name, like->timed->name ) != 0 || r->time_count <= time ||
             r->times[time].workers != like->timed->times[time].workers || !( r->times[time].median > 0.0 ) )
        {
            continue;
        }
        sweep_processor( &merge->parts[item->timed_part].header, processor );
        samples[count] = ( sample ){ r->vertices, r->substeps, r->times[time].median };
        count += strcmp( processor, wanted ) == 0 ? 1 : 0;
    }
    return count;
}

static void add_model( const sweep_merged* like, int time, const model* m, int* table, results* out )
{
    static const char* const header[] = {
        "scene",  "workers",         "a step, us",      "a substep, us",   "a vertex and substep, ns",
        "fitted", "others, checked", "median error, %", "largest error, %"
    };
    char cells[WISP_COUNT( header )][SUITE_MAX_NAME];
    const char* pointers[WISP_COUNT( header )];
    *table = *table < 0 ? results_add_table( out, "Model of cost", WISP_COUNT( header ), header ) : *table;
    snprintf( cells[0], sizeof cells[0], "%s", like->timed->name );
    snprintf( cells[1], sizeof cells[1], "%d", like->timed->times[time].workers );
    snprintf( cells[2], sizeof cells[2], "%.3g", 1e3 * m->terms[0] );
    snprintf( cells[3], sizeof cells[3], "%.3g", 1e3 * m->terms[1] );
    snprintf( cells[4], sizeof cells[4], "%.3g", 1e6 * m->terms[2] );
    snprintf( cells[5], sizeof cells[5], "%d", m->fitted );
    snprintf( cells[6], sizeof cells[6], "%d", m->checked );
    snprintf( cells[7], sizeof cells[7], "%.1f", 100.0 * m->median );
    snprintf( cells[8], sizeof cells[8], "%.1f", 100.0 * m->largest );
    for ( int i = 0; i < WISP_COUNT( header ); ++i )
    {
        pointers[i] = cells[i];
    }
    results_add_cells( out, *table, pointers );
}

// Whether an item is the first one of its scene that has times on its processor.
static bool is_first( const sweep_merge* merge, int item )
{
    char mine[160], other[160];
    const sweep_merged* of = merge->items + item;
    if ( of->timed == NULL )
    {
        return false;
    }
    sweep_processor( &merge->parts[of->timed_part].header, mine );
    for ( int i = 0; i < item; ++i )
    {
        const sweep_merged* before = merge->items + i;
        if ( before->timed != NULL && strcmp( before->timed->name, of->timed->name ) == 0 )
        {
            sweep_processor( &merge->parts[before->timed_part].header, other );
            if ( strcmp( mine, other ) == 0 )
            {
                return false;
            }
        }
    }
    return true;
}

void sweep_add_models( const sweep_merge* merge, results* out )
{
    const int items = merge->parts[0].header.items;
    sample* samples = calloc( (size_t)items + 1, sizeof *samples );
    int table = -1;
    for ( int i = 0; i < items && samples != NULL; ++i )
    {
        for ( int t = 0; is_first( merge, i ) && t < merge->items[i].timed->time_count; ++t )
        {
            model m;
            const int count = gather_samples( merge, merge->items + i, t, samples );
            if ( make_model( samples, count, &m ) )
            {
                add_model( merge->items + i, t, &m, &table, out );
            }
        }
    }
    free( samples );
    if ( table >= 0 )
    {
        results_add_note( out, "model of cost: the time of a step by its vertices V and substeps S is a + b S + c V "
                               "S; every second item by size "
                               "made it, and the others check it" );
    }
}
