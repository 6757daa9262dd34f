/// A progress bar on stderr: only on a terminal that can return to the start of a line, so never in a log file.
#pragma once

#include <stdbool.h>

typedef struct progress
{
    bool is_shown;
    bool is_coloured;     ///< NO_COLOR is unset or empty
    double last;          ///< s, when it was drawn last
    int drawn;            ///< columns to erase
    double part[2];       ///< of the whole: where the present part begins, and its length
    double start[2];      ///< s and fraction at the start, from which the time left follows
    double last_fraction; ///< if it falls, something else began
} progress;

progress progress_begin( void );

/// The following calls are about a part of the whole. @param begin,length fractions of the whole
void progress_part( progress* bar, double begin, double length );

/// Draw at most ten times a second, with the time left once it can be told.
/// @param fraction of the part that is done, in [0, 1] @param what a short phrase
void progress_show( progress* bar, double fraction, const char* what );

/// Erase the bar, so that the next output starts on a clean line.
void progress_end( progress* bar );
