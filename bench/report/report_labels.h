/// Names beside points that stand out, where there is room for them.
#pragma once

#include <stdio.h>

typedef struct report_place
{
    double x, y;       ///< in the drawing's coordinates
    const char* label; ///< null: no name is wanted, but none may cover the point either
    int series;
} report_place;

/// Each name stands right or left of its point, above or below, without touching a point, a name or the border. One that
/// finds no such place is left to the tooltip.
void report_put_labels( const report_place* places, int count, FILE* stream );
