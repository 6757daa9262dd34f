/// Text and numbers of a page: no text can end a tag or a quote, and no locale changes a number.
#pragma once

#include <stdbool.h>
#include <stdio.h>

/// Text between tags or in a quoted attribute. What is not UTF-8, and what no page may hold, becomes U+FFFD.
void report_put_text( const char* text, FILE* stream );
/// So many digits behind the point, up to 9, rounded to the nearest.
void report_put_fixed( double value, int digits, FILE* stream );
/// Up to four digits that say something: 0.001234, 12.34, 12345; what is smaller or larger times a power of ten; "-"
/// if not finite.
void report_put_short( double value, FILE* stream );

/// Exact decimal text of n * 10^exponent as axes show it: in groups of three, or times a power of ten.
/// @param power this power of ten is written as such; 0: none. The rest of the exponent is from -20 to 20
void report_decimal( long long n, int exponent, int power, char* out, size_t size );
/// Characters, not bytes, of what report_put_text() writes.
int report_text_length( const char* text );
