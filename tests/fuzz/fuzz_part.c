// Any bytes as a part of a sweep: refused with one message that begins with the name, or records that are written as they were read.
#include "fuzz.h"

#include "sweep_part.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size )
{
    sweep_part part;
    wisp_error error = { .status = WISP_OK };
    const wisp_status status = sweep_part_parse( (const char*)data, size, "part.jsonl", &part, &error );
    if ( status != WISP_OK )
    {
        demand_refusal( status, &error );
        demand( strncmp( error.message, "part.jsonl:", 11 ) == 0 );
    }
    else if ( part.whole > 0 )
    {
        demand( part.whole <= size && part.header.shard < part.header.shards && part.header.items <= SUITE_MAX_ROWS );
        char* line = sweep_header_write( &part.header );
        sweep_header again;
        demand( line != NULL && sweep_header_read( line, strlen( line ), &again ) );
        demand( sweep_difference( &part.header, &again ) == NULL );
        free( line );
    }
    for ( int i = 0; i < part.count && status == WISP_OK; ++i )
    {
        char* line = sweep_record_write( part.records + i );
        sweep_record again;
        demand( part.records[i].item < part.header.items && part.records[i].time_count <= SWEEP_MAX_TIMES );
        demand( line != NULL && sweep_record_read( line, strlen( line ), &again ) );
        demand( again.key == part.records[i].key && again.hash == part.records[i].hash );
        free( line );
    }
    sweep_part_release( &part );
    return 0;
}
