/// Names next to highlighted points, where there is room for them.
#pragma once

#include <stdio.h>

typedef struct report_place
{
    double x, y;       ///< in the drawing's coordinates
    const char* label; ///< null: no name, but no name may cover the point either
    int series;
} report_place;

/// Each name is right or left of its point, above or below, without touching a point, a name or the border. A name
/// without such a position is left to the tooltip.
void report_put_labels( const report_place* places, int count, FILE* stream );
