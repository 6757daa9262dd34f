/// Results as text for a terminal, and as JSON.
#pragma once

#include "results.h"

#include <jansson.h>

// ---- text for a terminal: tables of at most RESULTS_TEXT_COLUMNS columns and RESULTS_TEXT_WIDTH characters ----

#define RESULTS_TEXT_WIDTH 120
#define RESULTS_TEXT_COLUMNS 8

/// Write one table. A wider one is split; each part repeats the columns that tell its rows apart. Hashes and
/// quantiles are left to the formats for programs, and long cells go on in the next line.
void results_write_text_table( const results_table* table, FILE* stream );

// ---- JSON ----

#define RESULTS_JSON_VERSION 2

/// A count is 20 rather than 20.0; NaN and infinity, which JSON does not have, are null.
json_t* results_json_count( double value );
/// Write JSON into a script of a page, which would end where "</script" begins, whatever string that is in.
void results_json_put_script( const char* json, FILE* stream );
/// A string, also of bytes that are not UTF-8.
json_t* results_json_text( const char* value );
/// A hash as sixteen hexadecimal digits.
json_t* results_json_hash( uint64_t hash );
/// @return false: it is no hash
bool results_json_take_hash( const json_t* value, uint64_t* out );
