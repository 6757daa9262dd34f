#include "stability.h"

#include <string.h>

// The end mark keeps the list an array even if nothing is on it.
static const stability_known all_known[] = {
#define STABILITY_KNOWN( cell, limit ) { cell, STABILITY_LIMIT_##limit },
#include "limits.inc"
#undef STABILITY_KNOWN
    { NULL, STABILITY_LIMIT_NONE },
};

const stability_known* stability_known_limits( int* count )
{
    *count = WISP_COUNT( all_known ) - 1;
    return all_known;
}

const stability_known* stability_find_known( const stability_known* list, int count, const char* cell )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( strcmp( list[i].cell, cell ) == 0 )
        {
            return list + i;
        }
    }
    return NULL;
}

bool stability_is_as_known( const stability_known* known, stability_limit broke )
{
    return broke == ( known != NULL ? known->broke : STABILITY_LIMIT_NONE );
}
