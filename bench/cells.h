/// A row of a table, written cell by cell from left to right.
#pragma once

#include "results.h"

#define CELLS_MAX 32

typedef struct cells
{
    char text[CELLS_MAX][192];
    int count;
} cells;

/// A cell of at most 191 bytes; longer ones are cut.
void cells_put( cells* row, const char* format, ... ) __attribute__( ( format( printf, 2, 3 ) ) );
/// Put a number with the given decimals; "-" if it is not finite.
void cells_put_number( cells* row, double value, int digits );
/// Two numbers separated by a slash: the largest value and the mean.
void cells_put_pair( cells* row, double first, int first_digits, double second, int second_digits );
void cells_put_hash( cells* row, uint64_t hash );
/// A table whose header is this row. @return its number
int cells_begin_table( const cells* header, const char* title, results* out );
void cells_end_row( const cells* row, int table, results* out );
