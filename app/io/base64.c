#include "base64.h"

#include <string.h>

static void put_group( io_base64* stream )
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const unsigned char* p = stream->pending;
    char group[4] = {
        letters[p[0] >> 2],
        letters[( p[0] & 3 ) << 4 | p[1] >> 4],
        stream->count > 1 ? letters[( p[1] & 15 ) << 2 | p[2] >> 6] : '=',
        stream->count > 2 ? letters[p[2] & 63] : '=',
    };
    fwrite( group, 1, sizeof group, stream->out );
    stream->count = 0;
    memset( stream->pending, 0, sizeof stream->pending );
}

void io_base64_put( io_base64* stream, const void* bytes, size_t size )
{
    for ( size_t i = 0; i < size; ++i )
    {
        stream->pending[stream->count++] = ( (const unsigned char*)bytes )[i];
        if ( stream->count == 3 )
        {
            put_group( stream );
        }
    }
}

void io_base64_end( io_base64* stream )
{
    if ( stream->count > 0 )
    {
        put_group( stream );
    }
}
