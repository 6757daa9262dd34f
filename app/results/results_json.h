/// The two JSON forms of results, apart from the other formats because only they need jansson.
#pragma once

#include "results.h"

/// Our own schema: {"wisp_results":1, "machine":{..}, "build":{..}, "rows":[..], "notes":[..]}.
wisp_status results_write_json( const results* all, FILE* stream, wisp_error* error );

/// google-benchmark's schema: {"context":{..}, "benchmarks":[..]}, one entry a row that has a time.
wisp_status results_write_gbench( const results* all, FILE* stream, wisp_error* error );
