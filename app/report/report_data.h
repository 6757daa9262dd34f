/// Data of a page: tables, and charts as tables for readers and as JSON for the script that draws them; text that can end neither a
/// tag nor a quote.
#pragma once

#include "results.h"

#include <stdio.h>

/// Write text between tags or in a quoted attribute. Invalid UTF-8, and characters that no page may contain, become
/// U+FFFD.
void report_put_text( const char* text, FILE* stream );
/// The same for text of a page, where backticks around words become <code>; report_put_text() leaves them out.
void report_put_prose( const char* text, FILE* stream );

/// Write four significant digits, or a whole number, in any locale; "-" if not finite.
void report_write_number( double value, char* out, size_t size );
/// A table that scrolls inside its own frame, with a fixed header. @param number from 1, for the anchor
void report_put_table( const results_table* table, int number, FILE* stream );
/// A chart as a card: title, points as a table for readers without script, caption. @param number from 1, for the anchor
void report_put_chart( const results_chart* chart, int number, FILE* stream );
/// All charts as the script of page.html reads them. @return false without memory
bool report_put_chart_data( const results* all, FILE* stream );
