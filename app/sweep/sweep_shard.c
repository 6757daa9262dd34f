#include "sweep_shard.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// @return -1: not a whole number from 0 on
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
        return wisp_fail( error, WISP_BAD_INPUT, "--shard: got %d shards, expected 1 to %d", shard->count,
                          SWEEP_MAX_SHARDS );
    }
    if ( shard->index < 0 || shard->index >= shard->count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "--shard: got shard %d of %d, expected 1 to %d", shard->index + 1,
                          shard->count, shard->count );
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
    *out = ( sweep_shard ){ .index = index - 1, .count = count };
    return index < 0 || count < 0
               ? wisp_fail( error, WISP_BAD_INPUT, "--shard: got '%.40s', expected a share such as 2/8", text )
               : check( out, error );
}
