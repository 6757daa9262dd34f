/// A progress bar on stderr: only on a terminal that can return to the start of a line, so never in a log file.
#pragma once

#include <stdbool.h>

typedef struct progress
{
    bool is_shown;
    bool is_coloured; ///< NO_COLOR is unset or empty
    double last;      ///< s, when it was drawn last
    int drawn;        ///< columns to erase
} progress;

progress progress_begin( void );

/// Draw at most ten times a second.
/// @param share done, in [0, 1] @param what a short phrase
void progress_show( progress* bar, double fraction, const char* what );

/// Erase the bar, so that the next output starts on a clean line.
void progress_end( progress* bar );
