#include "sweep_item.h"

#include "interruption.h"
#include "io_file.h"
#include "stats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    RUN_TWICE = 100, // one in so many items
};

// ---- keys ----

static uint64_t add_bytes( uint64_t hash, const void* bytes, size_t size )
{
    const unsigned char* at = bytes;
    for ( size_t i = 0; i < size; ++i )
    {
        hash = ( hash ^ at[i] ) * 0x100000001b3u;
    }
    return hash;
}

// With its end, so that two texts are not one.
static uint64_t add_text( uint64_t hash, const char* text )
{
    return add_bytes( hash, text != NULL ? text : "", ( text != NULL ? strlen( text ) : 0 ) + 1 );
}

// The finalizer of splitmix64 (Steele, Lea and Flood 2014): shards are made of the low bits.
static uint64_t mixed( uint64_t hash )
{
    hash = ( hash ^ hash >> 30 ) * 0xbf58476d1ce4e5b9u;
    hash = ( hash ^ hash >> 27 ) * 0x94d049bb133111ebu;
    return hash ^ hash >> 31;
}

uint64_t sweep_key( const suite_row* row )
{
    const double limits[] = { row->limits.strain, row->limits.energy, row->limits.speed, row->limits.rest };
    const int numbers[] = { row->steps, (int)row->checks, row->is_refused, row->known };
    uint64_t hash = add_text( SUITE_HASH_BEGIN, row->name );
    hash = add_text( hash, row->variant );
    hash = add_text( hash, row->path != NULL ? io_file_name( row->path ) : "" );
    hash = add_text( hash, row->text );
    hash = add_text( hash, row->refusal );
    hash = add_bytes( hash, numbers, sizeof numbers );
    return mixed( add_bytes( hash, limits, sizeof limits ) );
}

uint64_t sweep_suite_key( const wisp_suite* suite )
{
    const suite_row* references[] = { &suite->reference, &suite->check, &suite->coarsest };
    const double numbers[] = { suite->extrapolate, suite->stored_doubt, suite->compares_start,
                               suite->compares_overlap };
    uint64_t hash = add_text( SUITE_HASH_BEGIN, suite->stored != NULL ? io_file_name( suite->stored ) : "" );
    for ( int i = 0; i < suite->row_count; ++i )
    {
        const uint64_t key = sweep_key( suite->rows + i );
        hash = add_bytes( hash, &key, sizeof key );
    }
    for ( int i = 0; i < WISP_COUNT( references ); ++i )
    {
        const uint64_t key = references[i]->text != NULL ? sweep_key( references[i] ) : 0;
        hash = add_bytes( hash, &key, sizeof key );
    }
    return mixed( add_bytes( hash, numbers, sizeof numbers ) );
}

bool sweep_is_run_twice( uint64_t key )
{
    return ( key >> 32 ) % RUN_TWICE == 0;
}

bool sweep_runs( const sweep_shard* shard, uint64_t key )
{
    const uint64_t count = (uint64_t)shard->count, own = key % count;
    return own == (uint64_t)shard->index ||
           ( sweep_is_run_twice( key ) && ( own + 1 ) % count == (uint64_t)shard->index );
}

// ---- times ----

// @param ms [steps] buffer
static wisp_status time_steps( scene_world* world, int steps, double* ms, uint64_t* hash, wisp_error* error )
{
    wisp_vec3* points = malloc( ( (size_t)scene_world_vertices( world ) + 1 ) * sizeof *points );
    wisp_status status = points != NULL ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for points" );
    *hash = SUITE_HASH_BEGIN;
    for ( int step = 0; step < steps && status == WISP_OK; ++step )
    {
        status = suite_time_step( world, ms + step, error );
        *hash = status == WISP_OK ? suite_hash_points( world, points, *hash ) : 0;
    }
    free( points );
    return status;
}

// Time the steps of a row into the next place of the record. @param hash receives that of all points after all steps
static wisp_status time_row( const suite_row* row, int workers, sweep_record* out, uint64_t* hash, wisp_error* error )
{
    const scene_world_options options = { .workers = workers, .is_quiet = true };
    wisp_scene scene;
    scene_world world;
    wisp_status status = suite_scene( row, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    scene_request_points( &scene );
    const int steps = row->steps > 0 ? row->steps : scene.steps;
    double* ms = calloc( (size_t)steps + 1, sizeof *ms );
    status = ms != NULL ? scene_world_create( &scene, &options, &world, error )
                        : wisp_fail( error, WISP_NO_MEMORY, "no memory for times" );
    if ( status == WISP_OK )
    {
        status = time_steps( &world, steps, ms, hash, error );
        const stats_summary summary = stats_summarise( ms, steps );
        out->times[out->time_count] = ( sweep_time ){ workers, steps, summary.median, summary.p10, summary.p90 };
        out->vertices = scene_world_vertices( &world );
        out->substeps = scene.substeps;
        scene_world_destroy( &world );
    }
    free( ms );
    wisp_scene_release( &scene );
    return status;
}

static wisp_status time_item( const suite_row* row, int workers, sweep_record* out, wisp_error* error )
{
    const int counts[SWEEP_MAX_TIMES] = { 1, workers };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < ( workers > 1 ? 2 : 1 ) && status == WISP_OK; ++i )
    {
        uint64_t hash = 0;
        status = time_row( row, counts[i], out, &hash, error );
        if ( status == WISP_OK && hash != out->hash )
        {
            return wisp_fail( error, WISP_CONFLICT, "a timed run with %d worker%s has other bits", counts[i],
                              counts[i] == 1 ? "" : "s" );
        }
        out->time_count += status == WISP_OK ? 1 : 0;
    }
    return status;
}

// ---- an item ----

// A text that was cut may end within a character of UTF-8.
static void cut_character( char* text )
{
    size_t end = strlen( text );
    while ( end > 0 && ( (unsigned char)text[end - 1] & 0xC0 ) == 0x80 )
    {
        --end;
    }
    if ( end > 0 && strlen( text ) >= 296 && (unsigned char)text[end - 1] >= 0xC0 )
    {
        text[end - 1] = '\0';
    }
}

static wisp_status judge( const sweep_settings* s, const suite_row* row, sweep_record* out, wisp_error* error )
{
    suite_outcome outcome;
    const wisp_status status = suite_judge_row( row, s->twins, &outcome, error );
    if ( status == WISP_OK )
    {
        const char* name = outcome.verdict.check == STABILITY_HOLDS ? outcome.is_refused ? "refused" : "holds"
                                                                    : stability_check_names[outcome.verdict.check];
        snprintf( out->verdict, sizeof out->verdict, "%s", name );
        out->is_known = suite_is_as_known( row, &outcome );
        out->hash = outcome.hash;
        out->steps = outcome.steps;
    }
    return status;
}

static wisp_status measure( const sweep_settings* s, const suite_row* row, sweep_record* out, wisp_error* error )
{
    suite_measurement measured;
    wisp_status status = suite_reference_run( s->reference, row, NULL, NULL, &measured, error );
    if ( status == WISP_OK )
    {
        out->hash = measured.hash;
        out->steps = measured.steps;
        out->compared = measured.compared;
        memcpy( out->values, measured.values, sizeof out->values );
        status = s->workers > 0 ? time_item( row, s->workers, out, error ) : status;
    }
    return status;
}

wisp_status sweep_run_item( const sweep_settings* s, int item, sweep_record* out, wisp_error* error )
{
    const suite_row* row = s->suite->rows + item;
    *out = ( sweep_record ){
        .item = item,
        .key = sweep_key( row ),
        .along_value = row->along_value,
        .order = row->order,
        .compared = suite_not_compared,
    };
    snprintf( out->name, sizeof out->name, "%s", row->name );
    snprintf( out->variant, sizeof out->variant, "%s", row->variant );
    snprintf( out->series, sizeof out->series, "%s", row->series );
    snprintf( out->along, sizeof out->along, "%s", row->along );
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        out->values[m] = NAN;
    }
    wisp_error inner = { 0 };
    const wisp_status status =
        row->checks != 0 || row->is_refused ? judge( s, row, out, &inner ) : measure( s, row, out, &inner );
    if ( interruption_came() )
    {
        return interruption_check( error );
    }
    if ( status != WISP_OK )
    {
        snprintf( out->failure, sizeof out->failure, "%.299s",
                  inner.message[0] ? inner.message : wisp_status_name( status ) );
        cut_character( out->failure );
    }
    return WISP_OK;
}
