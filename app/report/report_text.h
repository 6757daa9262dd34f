/// Text and numbers of a page: no text can end a tag or a quote, and no locale changes a number.
#pragma once

#include <stdbool.h>
#include <stdio.h>

/// Write text between tags or in a quoted attribute. Invalid UTF-8, and characters that no page may contain, become
/// U+FFFD.
void report_put_text( const char* text, FILE* stream );
/// The same for text of a page, where backticks around words become <code>; report_put_text() leaves them out.
void report_put_prose( const char* text, FILE* stream );
/// Write a number with this many decimals, up to 9, rounded to the nearest.
void report_put_fixed( double value, int digits, FILE* stream );
/// Write up to four significant digits: 0.001234, 12.34, 12345; smaller or larger numbers times a power of ten; "-"
/// if not finite.
void report_put_short( double value, FILE* stream );

/// Write the exact decimal text of n * 10^exponent for axes: in groups of three, or times a power of ten.
/// @param power this power of ten is written as such; 0: none. The rest of the exponent is from -20 to 20
void report_decimal( long long n, int exponent, int power, char* out, size_t size );
/// Characters, not bytes, of what report_put_text() writes.
int report_text_length( const char* text );
