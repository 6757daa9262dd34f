/// A progress bar on stderr: only on a terminal that can return to the start of a line, so never in a log file.
#pragma once

#include <stdbool.h>

typedef struct progress
{
    bool is_shown;
    bool is_coloured; ///< NO_COLOR is unset or empty
    double last;      ///< s, when it was drawn last
    int drawn;        ///< columns to wipe out again
} progress;

progress progress_begin( void );

/// Draw at most ten times a second.
/// @param share done, in [0, 1] @param what one short phrase
void progress_show( progress* bar, double fraction, const char* what );

/// Wipe the bar out, so that whatever is printed next starts on a clean line.
void progress_end( progress* bar );
