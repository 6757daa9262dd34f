/// Base64 (RFC 4648), with padding and without line breaks, as a stream of text.
#pragma once

#include <stddef.h>
#include <stdio.h>

/// Begin with `{ .out = stream }`. Errors of the stream are left to its owner.
typedef struct io_base64
{
    FILE* out;
    unsigned char pending[3];
    int count;
} io_base64;

/// Write bytes; up to two of them wait for the next ones.
void io_base64_put( io_base64* stream, const void* bytes, size_t size );
/// Write what waits.
void io_base64_end( io_base64* stream );
