#include "progress.h"

#include "wisp/base.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define BAR_WIDTH 30
#define SECONDS_BETWEEN 0.1

progress progress_begin( void )
{
    const char* terminal = getenv( "TERM" );
    const char* no_colour = getenv( "NO_COLOR" );
    bool can_return = terminal && *terminal && strcmp( terminal, "dumb" ) != 0;
    return ( progress ){
        .is_shown = can_return && isatty( STDERR_FILENO ) == 1,
        .is_coloured = !no_colour || !*no_colour,
        .last = -1.0,
    };
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
    int filled = (int)( clamped * BAR_WIDTH );
    char cells[BAR_WIDTH + 1];
    memset( cells, '#', (size_t)filled );
    memset( cells + filled, '.', (size_t)( BAR_WIDTH - filled ) );
    cells[BAR_WIDTH] = '\0';

    char text[80];
    int length = snprintf( text, sizeof( text ), "%3d %% %.60s", (int)( 100.0 * clamped ), what );
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
