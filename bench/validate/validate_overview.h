/// The first table of a validation: for each case and solver, how near it comes to the answer, and with what.
#pragma once

#include "results.h"

/// Add the table, empty. @return its number
int validate_begin_overview( results* out );
/// Add the lines of a case.
/// @param first_row of the case in the results; all later ones are of it
void validate_add_to_overview( int table, const char* name, int first_row, results* out );
/// Say in a sentence how many of its lines come near theory, and which do not. Also a headline.
void validate_end_overview( int table, results* out, char* summary, size_t size );
