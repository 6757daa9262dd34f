#include "sweep_shard.h"

#include "io_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- numbers ----

// @return -1: no whole number from 0 on
static int whole( const char* text )
{
    char* end = NULL;
    const long value = text != NULL && text[0] >= '0' && text[0] <= '9' ? strtol( text, &end, 10 ) : -1;
    return end != NULL && *end == '\0' && value <= 1000000000 ? (int)value : -1;
}

static wisp_status check( const sweep_shard* shard, wisp_error* error )
{
    if ( shard->count < 1 || shard->count > SWEEP_MAX_SHARDS )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %d shards, expected 1 to %d", shard->source, shard->count,
                          SWEEP_MAX_SHARDS );
    }
    if ( shard->index < 0 || shard->index >= shard->count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got shard %d of %d, expected 1 to %d", shard->source,
                          shard->index + 1, shard->count, shard->count );
    }
    return WISP_OK;
}

wisp_status sweep_shard_parse( const char* text, sweep_shard* out, wisp_error* error )
{
    char first[16];
    const char* slash = strchr( text, '/' );
    snprintf( first, sizeof first, "%.*s", slash ? (int)( slash - text ) : 0, text );
    const int index = slash && slash - text < (int)sizeof first ? whole( first ) : -1;
    const int count = slash ? whole( slash + 1 ) : -1;
    *out = ( sweep_shard ){ .index = index - 1, .count = count, .source = "--shard" };
    return index < 0 || count < 0
               ? wisp_fail( error, WISP_BAD_INPUT, "--shard: got '%.40s', expected a share such as 2/8", text )
               : check( out, error );
}

// ---- schedulers ----

// @param fallback of a variable that is not set; below 0: it must be
static wisp_status read_variable( const char* name, int fallback, int* out, wisp_error* error )
{
    const char* text = getenv( name );
    *out = text != NULL ? whole( text ) : fallback;
    return *out >= 0 ? WISP_OK
                     : wisp_fail( error, WISP_BAD_INPUT, "%s: got '%.40s', expected a whole number", name,
                                  text != NULL ? text : "" );
}

static wisp_status read_slurm( int count, sweep_shard* out, wisp_error* error )
{
    int id, first, step;
    wisp_status status = read_variable( "SLURM_ARRAY_TASK_ID", -1, &id, error );
    status = status == WISP_OK ? read_variable( "SLURM_ARRAY_TASK_MIN", 1, &first, error ) : status;
    status = status == WISP_OK ? read_variable( "SLURM_ARRAY_TASK_STEP", 1, &step, error ) : status;
    if ( status != WISP_OK || count > 0 )
    {
        *out = ( sweep_shard ){ id - 1, count, "SLURM_ARRAY_TASK_ID" };
        return status;
    }
    out->source = "SLURM_ARRAY_TASK_ID";
    out->index = ( id - first ) / ( step > 0 ? step : 1 );
    return read_variable( "SLURM_ARRAY_TASK_COUNT", -1, &out->count, error );
}

static wisp_status read_gtest( int count, sweep_shard* out, wisp_error* error )
{
    out->source = "GTEST_SHARD_INDEX";
    wisp_status status = read_variable( "GTEST_SHARD_INDEX", -1, &out->index, error );
    status = status == WISP_OK ? read_variable( "GTEST_TOTAL_SHARDS", -1, &out->count, error ) : status;
    return status != WISP_OK || count == 0 || count == out->count
               ? status
               : wisp_fail( error, WISP_BAD_INPUT, "--shards: got %d, and GTEST_TOTAL_SHARDS says %d", count,
                            out->count );
}

static wisp_status read_pbs( int count, sweep_shard* out, wisp_error* error )
{
    int id;
    const wisp_status status = read_variable( "PBS_ARRAY_INDEX", -1, &id, error );
    *out = ( sweep_shard ){ id - 1, count, "PBS_ARRAY_INDEX" };
    return status != WISP_OK || count > 0
               ? status
               : wisp_fail( error, WISP_BAD_INPUT,
                            "PBS_ARRAY_INDEX: PBS does not tell how many shards there are, say it with --shards" );
}

// HTCondor gives each job a file of lines such as "ProcId = 3". @return -1: it has no such line
static int number_of_job( const char* text, const char* name )
{
    const size_t length = strlen( name );
    for ( const char* line = text; line != NULL; line = strchr( line, '\n' ) )
    {
        line += line[0] == '\n' ? 1 : 0;
        if ( strncmp( line, name, length ) == 0 && strncmp( line + length, " = ", 3 ) == 0 )
        {
            char number[16];
            snprintf( number, sizeof number, "%.*s", (int)strcspn( line + length + 3, "\r\n" ), line + length + 3 );
            return whole( number );
        }
    }
    return -1;
}

static wisp_status read_condor( const char* path, int count, sweep_shard* out, wisp_error* error )
{
    enum
    {
        MOST = 1 << 20, // bytes
    };
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_status status = io_file_read( path, MOST, &bytes, &size, error );
    char* text = status == WISP_OK ? calloc( size + 1, 1 ) : NULL;
    if ( text != NULL )
    {
        memcpy( text, bytes != NULL ? (const char*)bytes : "", size );
        const int total = number_of_job( text, "TotalSubmitProcs" );
        *out = ( sweep_shard ){ number_of_job( text, "ProcId" ), count > 0 ? count : total, "_CONDOR_JOB_AD" };
        status = out->index >= 0 && out->count > 0
                     ? WISP_OK
                     : wisp_fail( error, WISP_BAD_INPUT,
                                  "%s: has no ProcId or TotalSubmitProcs; say the share with --shard", path );
    }
    else if ( status == WISP_OK )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for %s", path );
    }
    free( text );
    free( bytes );
    return status;
}

wisp_status sweep_shard_from_environment( int count, sweep_shard* out, wisp_error* error )
{
    const char* condor = getenv( "_CONDOR_JOB_AD" );
    *out = ( sweep_shard ){ 0, 1, NULL };
    wisp_status status = WISP_OK;
    if ( getenv( "SLURM_ARRAY_TASK_ID" ) != NULL )
    {
        status = read_slurm( count, out, error );
    }
    else if ( getenv( "GTEST_SHARD_INDEX" ) != NULL )
    {
        status = read_gtest( count, out, error );
    }
    else if ( getenv( "PBS_ARRAY_INDEX" ) != NULL )
    {
        status = read_pbs( count, out, error );
    }
    else if ( condor != NULL )
    {
        status = read_condor( condor, count, out, error );
    }
    else if ( count > 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "--shards: no scheduler says which of %d shards this is; say it with --shard", count );
    }
    return status == WISP_OK && out->source != NULL ? check( out, error ) : status;
}
