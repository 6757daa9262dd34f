// The wasted work is counted and not timed, so that it slows down whatever measures it: clocks, and counters of instructions.
#include "gate_slow.h"

#include <math.h>
#include <time.h>

double gate_seconds_used( void )
{
    struct timespec now;
    clock_gettime( CLOCK_THREAD_CPUTIME_ID, &now );
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void gate_slow_waste( gate_slow* slow )
{
    unsigned long x = (unsigned long)slow->sum;
    for ( long i = 0; i < slow->loops; ++i )
    {
        x = x * 6364136223846793005u + 1442695040888963407u;
        __asm__ volatile( "" : "+r"( x ) ); // each turn waits for the one before
    }
    slow->sum = (long)x;
}

// s of all steps of a scene
static wisp_status time_steps( const wisp_scene* scene, int steps, const char* isa, double* seconds,
                               wisp_error* error )
{
    const scene_world_options options = { .workers = 1, .isa = isa, .is_quiet = true };
    scene_world world;
    wisp_status status = scene_world_create( scene, &options, &world, error );
    const double begin = gate_seconds_used();
    for ( int step = 0; step < steps && status == WISP_OK; ++step )
    {
        status = scene_world_step( &world, error );
    }
    *seconds = gate_seconds_used() - begin;
    scene_world_destroy( &world );
    return status;
}

// s that a turn of the wasted work takes: the least of some tries.
static double seconds_of_loop( void )
{
    gate_slow slow = { .loops = 200000 };
    double least = INFINITY;
    for ( int i = 0; i < 20; ++i )
    {
        const double begin = gate_seconds_used();
        gate_slow_waste( &slow );
        least = fmin( least, ( gate_seconds_used() - begin ) / (double)slow.loops );
    }
    return least;
}

wisp_status gate_slow_find( const wisp_scene* scene, int steps, const char* isa, gate_slow* out, wisp_error* error )
{
    enum
    {
        RUNS = 5,
    };
    double seconds = 0.0, least = INFINITY;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < RUNS && status == WISP_OK; ++i )
    {
        status = time_steps( scene, steps, isa, &seconds, error );
        least = fmin( least, seconds );
    }
    *out = ( gate_slow ){ .loops = status == WISP_OK ? lround( least / ( steps * seconds_of_loop() ) ) : 0 };
    return status;
}
