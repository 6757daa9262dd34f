// clock_gettime() is POSIX, which -std=c17 hides by default.
#define _POSIX_C_SOURCE 200809L

#include "wisp/base.h"

#include <time.h>

double wisp_clock_seconds( void )
{
    struct timespec now;
    clock_gettime( CLOCK_MONOTONIC, &now );
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
