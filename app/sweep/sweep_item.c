#include "sweep_item.h"

#include "interruption.h"
#include "io_file.h"
#include "stats.h"
#include "wisp/module/definition.h"
#include "wisp/module/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    RUN_TWICE = 100, // one in so many items
};

// ---- keys ----

// With its end, so that two texts are not one.
static uint64_t add_text( uint64_t hash, const char* text )
{
    return suite_hash_bytes( text != NULL ? text : "", ( text != NULL ? strlen( text ) : 0 ) + 1, hash );
}

// Keys are mixed, since shards are made of their low bits.
uint64_t sweep_key( const suite_row* row )
{
    const double limits[] = { row->limits.strain, row->limits.energy, row->limits.speed, row->limits.rest };
    const int numbers[] = { row->steps, (int)row->checks, row->is_refused, row->known };
    uint64_t hash = add_text( SUITE_HASH_BEGIN, row->name );
    hash = add_text( hash, row->variant );
    hash = add_text( hash, row->path != NULL ? io_file_name( row->path ) : "" );
    hash = add_text( hash, row->text );
    hash = add_text( hash, row->refusal );
    hash = suite_hash_bytes( numbers, sizeof numbers, hash );
    return wisp_random_mix( suite_hash_bytes( limits, sizeof limits, hash ) );
}

uint64_t sweep_suite_key( const wisp_suite* suite )
{
    const double numbers[] = { suite->extrapolate, suite->stored_doubt, suite->compares_start,
                               suite->compares_overlap };
    uint64_t hash = add_text( SUITE_HASH_BEGIN, suite->stored != NULL ? io_file_name( suite->stored ) : "" );
    for ( int i = 0; i < suite->row_count; ++i )
    {
        const uint64_t key = sweep_key( suite->rows + i );
        hash = suite_hash_bytes( &key, sizeof key, hash );
    }
    for ( int i = 0; i < 3 * suite->reference_count; ++i )
    {
        const suite_runs* runs = suite->references + i / 3;
        const suite_row* run = i % 3 == 0 ? &runs->fine : i % 3 == 1 ? &runs->check : &runs->coarsest;
        const uint64_t key = run->text != NULL ? sweep_key( run ) : 0;
        hash = suite_hash_bytes( &key, sizeof key, hash );
    }
    return wisp_random_mix( suite_hash_bytes( numbers, sizeof numbers, hash ) );
}

// ---- shards ----

wisp_status sweep_shard_parse( const char* text, int* shard, int* shards, wisp_error* error )
{
    int used = 0;
    if ( sscanf( text, "%9d/%9d%n", shard, shards, &used ) != 2 || text[used] != '\0' )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "--shard: got '%.40s', expected a share such as 2/8", text );
    }
    if ( *shards < 1 || *shards > SWEEP_MAX_SHARDS )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "--shard: got %d shards, expected 1 to %d", *shards,
                          SWEEP_MAX_SHARDS );
    }
    return *shard >= 1 && *shard <= *shards
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "--shard: got shard %d of %d, expected 1 to %d", *shard, *shards,
                            *shards );
}

bool sweep_runs( uint64_t key, int shard, int shards )
{
    const uint64_t count = (uint64_t)shards, own = key % count, asked = (uint64_t)shard - 1;
    const bool is_run_twice = ( key >> 32 ) % RUN_TWICE == 0;
    return own == asked || ( is_run_twice && ( own + 1 ) % count == asked );
}

// ---- times ----

static wisp_status time_row( const suite_row* row, int workers, sweep_row* out, sweep_time* time, wisp_error* error )
{
    double* ms = NULL;
    int steps = 0;
    uint64_t hash = 0;
    wisp_status status = suite_time_row( row, workers, NULL, NULL, &ms, &steps, &hash, error );
    if ( status == WISP_OK && hash != out->hash )
    {
        status = wisp_fail( error, WISP_CONFLICT, "a timed run with %d worker%s has other bits", workers,
                            workers == 1 ? "" : "s" );
    }
    const stats_summary summary = stats_summarise( ms, status == WISP_OK ? steps : 0 );
    *time = ( sweep_time ){ summary.median, summary.p10, summary.p90 };
    free( ms );
    return status;
}

static wisp_status time_item( const suite_row* row, int workers, sweep_row* out, wisp_error* error )
{
    wisp_status status = time_row( row, 1, out, &out->alone, error );
    if ( status == WISP_OK && workers > 1 )
    {
        status = time_row( row, workers, out, &out->together, error );
    }
    out->workers = status == WISP_OK ? workers : 0;
    return status;
}

// ---- an item ----

static wisp_status judge( const sweep_settings* s, const suite_row* row, sweep_row* out, wisp_error* error )
{
    suite_outcome outcome;
    WISP_TRY( suite_judge_row( row, s->twins, &outcome, error ) );
    const char* name = outcome.verdict.check == STABILITY_HOLDS ? outcome.is_refused ? "refused" : "holds"
                                                                : stability_check_names[outcome.verdict.check];
    snprintf( out->verdict, sizeof out->verdict, "%s", name );
    out->is_known = suite_is_as_known( row, &outcome );
    out->hash = outcome.hash;
    out->steps = outcome.steps;
    return WISP_OK;
}

static wisp_status measure( const sweep_settings* s, int number, sweep_row* out, wisp_error* error )
{
    const suite_row* row = s->suite->rows + number;
    const suite_reference* reference;
    suite_measurement measured;
    wisp_status status = suite_reference_of( s->references, number, &reference, error );
    status = status == WISP_OK ? suite_reference_run( reference, row, NULL, NULL, &measured, error ) : status;
    if ( status == WISP_OK )
    {
        out->hash = measured.hash;
        out->steps = measured.steps;
        out->strands = measured.strands;
        out->vertices = measured.vertices;
        out->substeps = measured.substeps;
        out->doubt = reference->doubt.distance;
        out->until = reference->until;
        for ( int v = 0; v < SWEEP_VALUE_COUNT; ++v )
        {
            const double* value = (const double*)( (const char*)&measured + sweep_values[v].offset );
            out->values[v] = sweep_values[v].scale * *value;
        }
        status = s->workers > 0 ? time_item( row, s->workers, out, error ) : status;
    }
    return status;
}

wisp_status sweep_run_item( const sweep_settings* s, int number, sweep_row* out, wisp_error* error )
{
    static const sweep_time untimed = { NAN, NAN, NAN };
    const suite_row* row = s->suite->rows + number;
    *out = *s->like;
    out->item = number + 1;
    out->along_value = row->along_value;
    out->order = row->order;
    out->alone = out->together = untimed;
    snprintf( out->name, sizeof out->name, "%s", row->name );
    snprintf( out->variant, sizeof out->variant, "%s", row->variant );
    snprintf( out->series, sizeof out->series, "%s", row->series );
    snprintf( out->along, sizeof out->along, "%s", row->along );
    for ( int v = 0; v < SWEEP_VALUE_COUNT; ++v )
    {
        out->values[v] = NAN;
    }
    wisp_error inner = { 0 };
    const wisp_status status =
        row->checks != 0 || row->is_refused ? judge( s, row, out, &inner ) : measure( s, number, out, &inner );
    if ( interruption_came() )
    {
        return interruption_check( error );
    }
    if ( status != WISP_OK )
    {
        snprintf( out->failure, sizeof out->failure, "%s",
                  inner.message[0] ? inner.message : wisp_status_name( status ) );
    }
    return WISP_OK;
}
