/// The JSON forms of results, apart from the other formats because only they need jansson.
#pragma once

#include "results.h"

#include <jansson.h>

#define RESULTS_JSON_VERSION 2

/// Our own schema: {"wisp_results":2, "date":.., "options":.., "machine":{..}, "build":{..}, "rows":[..], "notes":[..]}.
wisp_status results_write_json( const results* all, FILE* stream, wisp_error* error );

/// What github-action-benchmark reads with the tool customSmallerIsBetter: [{"name", "unit", "value", "range", "extra"}].
wisp_status results_write_github( const results* all, FILE* stream, wisp_error* error );

/// null for NaN and infinity, which JSON does not have.
json_t* results_json_number( double value );
/// The same, but a count is 20 rather than 20.0.
json_t* results_json_count( double value );
/// A string, also of bytes that are not UTF-8.
json_t* results_json_text( const char* value );
/// Sixteen hexadecimal digits, since a JSON integer has 63 bits; null without a hash.
json_t* results_json_hash( const results_row* row );
/// Write JSON into a script of a page, which would end where "</script" begins, whatever string that is in.
void results_json_put_script( const char* json, FILE* stream );
/// Write and release.
wisp_status results_json_dump( json_t* root, FILE* stream, wisp_error* error );

/// Read a file of our own schema and check it.
/// @return to be released; null: the error says where the file is wrong
json_t* results_json_load( const char* path, wisp_error* error );
