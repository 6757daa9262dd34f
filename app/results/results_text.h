/// Results as text for a terminal: tables of at most RESULTS_TEXT_COLUMNS columns and RESULTS_TEXT_WIDTH characters.
#pragma once

#include "results.h"

#define RESULTS_TEXT_WIDTH 120
#define RESULTS_TEXT_COLUMNS 8

/// Write one table. A wider one is split; each part repeats the columns that tell its rows apart. Hashes and
/// quantiles are left to the formats for programs, and long cells go on in the next line.
void results_write_text_table( const results_table* table, FILE* stream );
/// Write a text, broken between words; its further lines are indented.
void results_write_text_lines( const char* text, FILE* stream );
