/// One axis of a chart: its ends, its ticks, and the position of a value on it.
#pragma once

#include <stdbool.h>

#define REPORT_TICKS_MAX 40

typedef struct report_tick
{
    double value;
    bool is_major;  ///< a power of ten, or any tick of a linear axis
    char label[64]; ///< empty: a gridline only
} report_tick;

typedef struct report_axis
{
    bool is_log;
    double lower, upper; ///< values at its ends; they are ticks, though not always with a label
    report_tick ticks[REPORT_TICKS_MAX];
    int tick_count;
} report_axis;

/// Whether a value has a position: finite, within 1e100, and above 1e-100 if the axis is logarithmic.
bool report_axis_takes( bool is_log, double value );
/// An axis that contains two valid values, least <= most; they may be equal.
report_axis report_axis_make( double least, double most, bool is_log );
/// Position of a value as a fraction of the axis: 0 at low, 1 at high.
double report_axis_place( const report_axis* axis, double value );
