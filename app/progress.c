#include "progress.h"

#include "wisp/base.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define BAR_WIDTH 30
#define SECONDS_BETWEEN 0.1
#define SECONDS_BEFORE 2.0 // of the time left

progress progress_begin( void )
{
    const char* terminal = getenv( "TERM" );
    const char* no_colour = getenv( "NO_COLOR" );
    bool can_return = terminal && *terminal && strcmp( terminal, "dumb" ) != 0;
    return ( progress ){
        .is_shown = can_return && isatty( STDERR_FILENO ) == 1,
        .is_coloured = !no_colour || !*no_colour,
        .last = -1.0,
        .part = { 0.0, 1.0 },
        .start = { wisp_clock_seconds(), 0.0 },
    };
}

void progress_part( progress* bar, double begin, double length )
{
    bar->part[0] = begin;
    bar->part[1] = length;
}

// Of a steady pace since the start: nothing in the first seconds, which say little.
static void put_time_left( const progress* bar, double now, double fraction, char* out, size_t size )
{
    const double gone = now - bar->start[0], done = fraction - bar->start[1];
    const double left = done > 0.0 ? gone * ( 1.0 - fraction ) / done : 0.0;
    out[0] = '\0';
    if ( gone >= SECONDS_BEFORE && done >= 0.01 )
    {
        left < 99.5     ? snprintf( out, size, ", %.0f s left", left )
        : left < 5970.0 ? snprintf( out, size, ", %.0f min left", left / 60.0 )
                        : snprintf( out, size, ", %.1f h left", left / 3600.0 );
    }
}

void progress_show( progress* bar, double fraction, const char* what )
{
    double now = wisp_clock_seconds();
    if ( !bar->is_shown || ( bar->last >= 0.0 && now - bar->last < SECONDS_BETWEEN ) )
    {
        return;
    }
    bar->last = now;

    double clamped = fraction < 0.0 ? 0.0 : fraction > 1.0 ? 1.0 : fraction;
    clamped = bar->part[0] + bar->part[1] * clamped;
    if ( clamped < bar->last_fraction )
    {
        bar->start[0] = now;
        bar->start[1] = clamped;
    }
    bar->last_fraction = clamped;
    int filled = (int)( clamped * BAR_WIDTH );
    char cells[BAR_WIDTH + 1];
    memset( cells, '#', (size_t)filled );
    memset( cells + filled, '.', (size_t)( BAR_WIDTH - filled ) );
    cells[BAR_WIDTH] = '\0';

    char text[100], left[32];
    put_time_left( bar, now, clamped, left, sizeof( left ) );
    int length = snprintf( text, sizeof( text ), "%3d %% %.60s%s", (int)( 100.0 * clamped ), what, left );
    int columns = BAR_WIDTH + 3 + length;
    int stale = bar->drawn > columns ? bar->drawn - columns : 0;
    fprintf( stderr, "\r[%s%s%s] %s%*s", bar->is_coloured ? "\033[32m" : "", cells, bar->is_coloured ? "\033[0m" : "",
             text, stale, "" );
    fflush( stderr );
    bar->drawn = columns;
}

void progress_end( progress* bar )
{
    if ( bar->drawn > 0 )
    {
        fprintf( stderr, "\r%*s\r", bar->drawn, "" );
        fflush( stderr );
        bar->drawn = 0;
    }
}
