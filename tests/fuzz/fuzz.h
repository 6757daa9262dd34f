/// Shared by all fuzz targets: assertions, and the form of a rejection.
#pragma once

#ifndef _XOPEN_SOURCE
#define _XOPEN_SOURCE 700 // open_memstream
#endif

#include "wisp/base.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// Called by libFuzzer or by replay.c.
int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size );

static inline void demand( bool condition )
{
    if ( !condition )
    {
        abort();
    }
}

/// Input was rejected with a message, which is one printable line.
static inline void demand_refusal( wisp_status status, const wisp_error* error )
{
    demand( status == WISP_BAD_INPUT && error->status == status && error->message[0] != 0 );
    for ( const char* c = error->message; *c != 0; ++c )
    {
        demand( (unsigned char)*c >= 0x20 && *c != 0x7f );
    }
}
