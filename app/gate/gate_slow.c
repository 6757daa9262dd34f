// The wasted work is counted and not timed, so that it slows down whatever measures it: clocks, and counters of instructions.
#include "gate_slow.h"

#include "profile_samples.h"
#include "wisp/explain.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

double gate_seconds_used( void )
{
    struct timespec now;
    clock_gettime( CLOCK_THREAD_CPUTIME_ID, &now );
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void waste( gate_slow* slow, long loops )
{
    unsigned long x = (unsigned long)slow->sum;
    for ( long i = 0; i < loops; ++i )
    {
        x = x * 6364136223846793005u + 1442695040888963407u;
        __asm__ volatile( "" : "+r"( x ) ); // each turn waits for the one before
    }
    slow->sum = (long)x;
}

static void run_and_waste( void* user, void ( *run )( void* call ), void* call )
{
    gate_slow* slow = user;
    run( call );
    slow->calls += 1.0;
    waste( slow, slow->loops );
}

wisp_status gate_slow_apply( gate_slow* slow, wisp_world* world, wisp_error* error )
{
    if ( slow->pass[0] == '\0' || wisp_world_surround( world, slow->pass, run_and_waste, slow ) == WISP_OK )
    {
        return WISP_OK;
    }
    return wisp_fail( error, WISP_BAD_INPUT, "gate: %s", wisp_world_message( world ) );
}

// ---- which pass, and how much ----

// Most substeps of fused passes run in the function of their fusion.
static void name_what_runs( wisp_world* world, const char* pass, gate_slow* out )
{
    wisp_plan_info* info = NULL;
    snprintf( out->pass, sizeof out->pass, "%s", pass );
    if ( wisp_world_explain( world, &info ) == WISP_OK )
    {
        for ( int i = 0; i < info->active_count; ++i )
        {
            const wisp_plan_pass* p = &info->passes[i];
            if ( strcmp( p->name, pass ) == 0 && p->fusion != NULL )
            {
                snprintf( out->pass, sizeof out->pass, "%s", p->fusion );
            }
        }
    }
    wisp_plan_info_release( info );
}

static wisp_status choose_pass( const profile_samples* times, wisp_world* world, const char* asked, gate_slow* out,
                                wisp_error* error )
{
    const char* pass = NULL;
    double most = -1.0;
    for ( int i = 0; i < times->pass_count; ++i )
    {
        const profile_pass* p = &times->passes[i];
        double sum = 0.0;
        for ( int k = 0; k < p->count; ++k )
        {
            sum += p->seconds[k];
        }
        if ( sum > most && ( asked == NULL || strcmp( asked, p->name ) == 0 ) )
        {
            most = sum;
            pass = p->name;
        }
    }
    if ( pass == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "gate: the scene runs no pass '%s'", asked ? asked : "at all" );
    }
    name_what_runs( world, pass, out );
    return WISP_OK;
}

// All steps of a scene. Either it is found which pass to slow down, or that one is slowed down.
static wisp_status run_steps( const wisp_scene* scene, int steps, const char* isa, gate_slow* slow, bool chooses,
                              const char* asked, double* seconds, wisp_error* error )
{
    const scene_world_options options = { .workers = 1, .isa = isa, .is_quiet = true };
    scene_world world;
    profile_samples times = { 0 };
    wisp_status status = scene_world_create( scene, &options, &world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = chooses ? WISP_OK : gate_slow_apply( slow, world.world, error );
    const double begin = gate_seconds_used();
    for ( int step = 0; step < steps && status == WISP_OK; ++step )
    {
        status = scene_world_step( &world, error );
        status =
            status == WISP_OK && chooses ? profile_samples_add( &times, wisp_world_profile( world.world ) ) : status;
    }
    *seconds = gate_seconds_used() - begin;
    status = status == WISP_OK && chooses ? choose_pass( &times, world.world, asked, slow, error ) : status;
    profile_samples_free( &times );
    scene_world_destroy( &world );
    return status;
}

// s that a turn of the wasted work takes: the least of some tries.
static double seconds_of_loop( gate_slow* slow )
{
    const long LOOPS = 200000;
    double least = INFINITY;
    for ( int i = 0; i < 20; ++i )
    {
        const double begin = gate_seconds_used();
        waste( slow, LOOPS );
        least = fmin( least, ( gate_seconds_used() - begin ) / (double)LOOPS );
    }
    return least;
}

wisp_status gate_slow_find( const wisp_scene* scene, int steps, const char* isa, const char* pass, gate_slow* out,
                            wisp_error* error )
{
    enum
    {
        RUNS = 5,
    };
    *out = ( gate_slow ){ 0 };
    double seconds = 0.0, least = INFINITY;
    wisp_status status = run_steps( scene, steps, isa, out, true, pass, &seconds, error );
    for ( int i = 0; i < RUNS && status == WISP_OK; ++i )
    {
        out->calls = 0.0;
        status = run_steps( scene, steps, isa, out, false, pass, &seconds, error );
        least = fmin( least, seconds );
    }
    if ( status == WISP_OK )
    {
        out->loops = lround( least / ( fmax( out->calls, 1.0 ) * seconds_of_loop( out ) ) );
    }
    return status;
}
