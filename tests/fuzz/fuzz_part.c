// Any bytes as a part of a sweep: refused with one message that begins with the name, or rows that are written as they were read.
#include "fuzz.h"

#include "sweep_merge.h"

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size )
{
    sweep_merge merge = { 0 };
    wisp_error error = { .status = WISP_OK };
    size_t whole;
    const wisp_status status = sweep_merge_parse( (const char*)data, size, "part.jsonl", &merge, &whole, &error );
    demand( whole <= size && merge.count <= merge.like.items && merge.run_twice <= merge.count );
    if ( status != WISP_OK )
    {
        demand_refusal( status, &error );
        demand( strncmp( error.message, "part.jsonl:", 11 ) == 0 );
    }
    for ( int i = 0; i < merge.like.items && status == WISP_OK; ++i )
    {
        const sweep_row* row = merge.rows + i;
        if ( row->item != 0 )
        {
            char* line = sweep_row_write( row );
            sweep_row again;
            demand( row->item == i + 1 && row->shard <= row->shards );
            demand( line != NULL && sweep_row_read( line, strlen( line ), &again ) );
            demand( again.hash == row->hash && sweep_row_difference( row, &again ) == NULL );
            free( line );
        }
    }
    sweep_merge_release( &merge );
    return 0;
}
