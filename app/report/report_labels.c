#include "report_labels.h"

#include "report_drawing.h"
#include "report_text.h"

#include <stdlib.h>

// Of the stylesheet's font, on the wide side.
#define CHARACTER_WIDTH 6.3
#define LABEL_HEIGHT 12.0
#define LABEL_GAP 11.0
#define POINT_RADIUS 10.0 // with its ring
#define LABELS_MAX 24

typedef struct box
{
    double left, top, right, bottom;
} box;

static bool is_apart( box a, box b )
{
    return a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
}

static box box_of( const report_place* place, int corner )
{
    double width = CHARACTER_WIDTH * report_text_length( place->label );
    double left = corner % 2 == 0 ? place->x + LABEL_GAP : place->x - LABEL_GAP - width;
    double top = corner < 2 ? place->y - LABEL_HEIGHT - 2.0 : place->y + 2.0;
    return ( box ){ left, top, left + width, top + LABEL_HEIGHT };
}

static bool is_inside( box b )
{
    return b.left >= REPORT_CHART_LEFT && b.right <= REPORT_CHART_WIDTH && b.top >= 0.0 &&
           b.bottom <= REPORT_CHART_HEIGHT - REPORT_CHART_BOTTOM;
}

static bool is_free( box b, const report_place* places, int count, const box* taken, int taken_count )
{
    for ( int i = 0; i < count; ++i )
    {
        const report_place* p = &places[i];
        const box around = { p->x - POINT_RADIUS, p->y - POINT_RADIUS, p->x + POINT_RADIUS, p->y + POINT_RADIUS };
        if ( !is_apart( b, around ) )
        {
            return false;
        }
    }
    for ( int i = 0; i < taken_count; ++i )
    {
        if ( !is_apart( b, taken[i] ) )
        {
            return false;
        }
    }
    return true;
}

static void put_label( const report_place* place, box b, FILE* stream )
{
    fputs( "<text class=\"label ", stream );
    report_put_series_class( place->series, stream );
    fputs( "\" x=\"", stream );
    report_put_fixed( b.left, 2, stream );
    fputs( "\" y=\"", stream );
    report_put_fixed( b.bottom - 2.5, 2, stream );
    fputs( "\">", stream );
    report_put_text( place->label, stream );
    fputs( "</text>\n", stream );
}

void report_put_labels( const report_place* places, int count, FILE* stream )
{
    box taken[LABELS_MAX];
    int taken_count = 0;
    for ( int i = 0; i < count && taken_count < LABELS_MAX; ++i )
    {
        bool is_placed = !places[i].label;
        for ( int corner = 0; corner < 4 && !is_placed; ++corner )
        {
            box b = box_of( &places[i], corner );
            is_placed = is_inside( b ) && is_free( b, places, count, taken, taken_count );
            if ( is_placed )
            {
                put_label( &places[i], b, stream );
                taken[taken_count++] = b;
            }
        }
    }
}
