/// A picture inside the page: its file's bytes as base64.
#pragma once

#include "results.h"

/// A larger file is named but not included.
#define REPORT_PICTURE_BYTES_MAX ( 16 << 20 )

/// @param number from 1, for the anchor
void report_put_picture( const results_picture* picture, int number, FILE* stream );
