/// Text of a page, which can end neither a tag nor a quote.
#pragma once

#include <stdio.h>

/// Write text between tags or in a quoted attribute. Invalid UTF-8, and characters that no page may contain, become
/// U+FFFD.
void report_put_text( const char* text, FILE* stream );
/// The same for text of a page, where backticks around words become <code>; report_put_text() leaves them out.
void report_put_prose( const char* text, FILE* stream );
