#include "gate_turns.h"

#include "interruption.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

// ---- slow-downs by a known amount ----

// The wasted work is counted and not timed, so that it slows down whatever measures it: clocks, and counters of instructions.

// Processor time of this thread, s.
static double seconds_used( void )
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
static wisp_status time_steps( const wisp_scene* scene, const char* isa, double* seconds, wisp_error* error )
{
    const scene_world_options options = { .workers = 1, .isa = isa, .is_quiet = true };
    scene_world world;
    wisp_status status = scene_world_create( scene, &options, &world, error );
    const double begin = seconds_used();
    for ( int step = 0; step < scene->steps && status == WISP_OK; ++step )
    {
        status = scene_world_step( &world, error );
    }
    *seconds = seconds_used() - begin;
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
        const double begin = seconds_used();
        gate_slow_waste( &slow );
        least = fmin( least, ( seconds_used() - begin ) / (double)slow.loops );
    }
    return least;
}

wisp_status gate_slow_find( const wisp_scene* scene, const char* isa, gate_slow* out, wisp_error* error )
{
    enum
    {
        RUNS = 5,
    };
    double seconds = 0.0, least = INFINITY;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < RUNS && status == WISP_OK; ++i )
    {
        status = time_steps( scene, isa, &seconds, error );
        least = fmin( least, seconds );
    }
    *out = ( gate_slow ){ .loops = status == WISP_OK ? lround( least / ( scene->steps * seconds_of_loop() ) ) : 0 };
    return status;
}

static const char ANSWER[] = "wisp_gate_ns 2 "; // and two numbers: the time and how many steps it was

// ---- in the measured process ----

// A run of the row, which goes on from turn to turn and begins again after its last step.
typedef struct row_run
{
    const wisp_scene* scene;
    const char* isa;
    gate_slow* slow;
    scene_world world;
    int steps, step;
} row_run;

static wisp_status begin_run( row_run* run, wisp_error* error )
{
    const scene_world_options options = { .workers = 1, .isa = run->isa, .is_quiet = true };
    return scene_world_create( run->scene, &options, &run->world, error );
}

// Up to `most` steps, none beyond the last one of the run, and the answer.
static wisp_status take_turn( row_run* run, int most, wisp_error* error )
{
    wisp_status status = run->step == 0 ? begin_run( run, error ) : WISP_OK;
    const double begin = seconds_used();
    int made = 0;
    for ( ; made < most && run->step < run->steps && status == WISP_OK; ++made, ++run->step )
    {
        status = scene_world_step( &run->world, error );
        gate_slow_waste( run->slow );
    }
    const double seconds = seconds_used() - begin;
    if ( status == WISP_OK )
    {
        printf( "%s%.0f %d\n", ANSWER, 1e9 * seconds, made );
        fflush( stdout );
        if ( run->step == run->steps )
        {
            scene_world_destroy( &run->world );
            run->step = 0;
        }
    }
    return status;
}

wisp_status gate_answer_turns( const suite_row* row, gate_slow* slow, const char* isa, wisp_error* error )
{
    wisp_scene scene;
    wisp_status status = suite_scene( row, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    row_run run = { .scene = &scene, .isa = isa, .slow = slow, .steps = scene.steps };
    char line[32];
    while ( status == WISP_OK && fgets( line, sizeof line, stdin ) )
    {
        status = take_turn( &run, atoi( line ), error );
    }
    scene_world_destroy( &run.world );
    wisp_scene_release( &scene );
    return status;
}

// ---- in the process that compares ----

static _Noreturn void be_child( const gate_program* program, const gate_turns* turns, int in, int out )
{
    char row[32], slow[32], set[32];
    snprintf( row, sizeof row, "--row=%d", turns->row );
    snprintf( set, sizeof set, "--isa=%s", turns->isa );
    snprintf( slow, sizeof slow, "--slow=%ld", program->loops );
    char* arguments[9] = { (char*)(uintptr_t)program->path, "gate", "step", "--turns", row, set,
                           (char*)(uintptr_t)turns->suite };
    if ( program->loops > 0 ) // other programs need not know it
    {
        arguments[7] = slow;
    }
    interruption_leave_to_parent();
    setpgid( 0, 0 ); // so that what it starts ends with it
    // the last processor: the first one serves most interrupts
    cpu_set_t mine;
    CPU_ZERO( &mine );
    CPU_SET( (size_t)sysconf( _SC_NPROCESSORS_ONLN ) - 1, &mine );
    sched_setaffinity( 0, sizeof mine, &mine );
    dup2( in, STDIN_FILENO );
    dup2( out, STDOUT_FILENO );
    dup2( open( "/dev/null", O_RDWR ), STDERR_FILENO );
    execv( program->path, arguments );
    _exit( 127 );
}

wisp_status gate_process_begin( const gate_program* program, const gate_turns* turns, gate_process* out,
                                wisp_error* error )
{
    int in[2], back[2];
    *out = ( gate_process ){ .program = program, .to = -1, .from = -1 };
    fflush( NULL );
    signal( SIGPIPE, SIG_IGN ); // a program that has ended is told by its missing answer
    if ( pipe2( in, O_CLOEXEC ) != 0 )
    {
        return wisp_fail( error, WISP_IO_ERROR, "gate: no pipe: %s", strerror( errno ) );
    }
    if ( pipe2( back, O_CLOEXEC ) != 0 )
    {
        close( in[0] );
        close( in[1] );
        return wisp_fail( error, WISP_IO_ERROR, "gate: no pipe: %s", strerror( errno ) );
    }
    out->child = fork();
    if ( out->child == 0 )
    {
        be_child( program, turns, in[0], back[1] );
    }
    close( in[0] );
    close( back[1] );
    out->to = in[1];
    out->from = back[0];
    out->child = out->child > 0 ? out->child : 0;
    return out->child > 0 ? WISP_OK : wisp_fail( error, WISP_IO_ERROR, "gate: no process: %s", strerror( errno ) );
}

void gate_process_end( gate_process* process )
{
    if ( process->to >= 0 )
    {
        close( process->to );
        close( process->from );
    }
    if ( process->child > 0 )
    {
        kill( -process->child, SIGKILL );
        kill( process->child, SIGKILL );
        waitpid( process->child, NULL, 0 );
    }
    *process = ( gate_process ){ .to = -1, .from = -1 };
}

// A line of the process. @return false if it ended without one, or the time is over, which is said
static bool read_line( const gate_process* process, double patience, char* out, size_t size, bool* is_late )
{
    size_t used = 0;
    const double end = wisp_clock_seconds() + patience;
    *is_late = false;
    while ( used + 1 < size )
    {
        struct pollfd ready = { .fd = process->from, .events = POLLIN };
        const double left = end - wisp_clock_seconds();
        if ( left <= 0.0 || interruption_came() )
        {
            *is_late = left <= 0.0;
            return false;
        }
        // in slices: a signal just before poll() does not end it
        if ( poll( &ready, 1, left < 0.2 ? (int)( 1e3 * left ) + 1 : 200 ) <= 0 )
        {
            continue;
        }
        const ssize_t got = read( process->from, out + used, 1 );
        if ( got <= 0 || out[used] == '\n' )
        {
            out[used] = '\0';
            return got > 0;
        }
        used += 1;
    }
    return false;
}

wisp_status gate_process_turn( gate_process* process, const gate_turns* turns, int steps, gate_turn* out,
                               wisp_error* error )
{
    char line[64];
    bool is_late = false;
    const size_t before = sizeof ANSWER - 1;
    const int size = snprintf( line, sizeof line, "%d\n", steps );
    const bool has_line = write( process->to, line, (size_t)size ) == size &&
                          read_line( process, turns->patience, line, sizeof line, &is_late );
    *out = ( gate_turn ){ 0 };
    if ( interruption_came() )
    {
        return interruption_check( error );
    }
    if ( has_line && strncmp( line, ANSWER, before ) == 0 )
    {
        char* end;
        out->ns = strtod( line + before, &end );
        out->steps = (int)strtol( end, NULL, 10 );
    }
    if ( is_late )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: gave no time of row %d of %s within %g s (--patience)",
                          process->program->path, turns->row, turns->suite, turns->patience );
    }
    return out->ns > 0.0 && out->steps > 0
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "%s: expected a Wisp that can run and time row %d of %s",
                            process->program->path, turns->row, turns->suite );
}
