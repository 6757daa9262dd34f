// A scene in a process of its own: a crash or an endless loop is a verdict like any other.
#include "torture_twins.h"

#include "interruption.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static void refuse( stability_verdict* out, const wisp_error* error )
{
    *out = ( stability_verdict ){ .check = STABILITY_REFUSED, .severity = 1.0 };
    snprintf( out->message, sizeof out->message, "%.310s", error->message );
}

// What happens in the child.
static stability_verdict judge_here( const torture_subject* subject, int twins )
{
    const unsigned checks = STABILITY_ALL | ( twins & TORTURE_CLOSE ? STABILITY_CLOSE : 0u );
    stability_verdict verdict = { .check = STABILITY_HOLDS };
    wisp_error error = { 0 };
    wisp_scene scene;
    if ( torture_read( subject, &scene, &error ) != WISP_OK )
    {
        refuse( &verdict, &error );
        return verdict;
    }
    stability_trace trace;
    if ( stability_trace_run( &scene, &trace, &error ) != WISP_OK )
    {
        refuse( &verdict, &error );
    }
    else if ( stability_judge_trace( &trace, checks, NULL, &verdict ) && ( twins & TORTURE_TWIN_ALL ) != 0 )
    {
        torture_judge_twins( subject, &trace, twins, &verdict );
    }
    stability_trace_release( &trace );
    wisp_scene_release( &scene );
    return verdict;
}

// A core file of each crash would fill the disk.
static _Noreturn void be_child( const torture_subject* subject, int twins, int out )
{
    const struct rlimit none = { 0, 0 };
    setrlimit( RLIMIT_CORE, &none );
    interruption_leave_to_parent();
    static const int fatal[] = { SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT };
    for ( int i = 0; i < WISP_COUNT( fatal ); ++i )
    {
        signal( fatal[i], SIG_DFL ); // a host that catches them would go on as two processes
    }
    const stability_verdict verdict = judge_here( subject, twins );
    const ssize_t written = write( out, &verdict, sizeof verdict );
    _exit( written == (ssize_t)sizeof verdict ? 0 : 1 );
}

torture_child torture_start( const torture_subject* subject, int twins, double seconds )
{
    torture_child child = { .pid = -1, .in = -1, .seconds = seconds, .end = wisp_clock_seconds() + seconds };
    int ends[2];
    fflush( NULL );
    if ( pipe( ends ) != 0 )
    {
        return child;
    }
    child.in = ends[0];
    child.pid = fork();
    if ( child.pid == 0 )
    {
        close( ends[0] );
        be_child( subject, twins, ends[1] );
    }
    close( ends[1] );
    return child;
}

// Wait until the verdict is there, the child is gone, or its time is over. A verdict that is there counts, however late
// it is asked for.
static bool wait_for( const torture_child* child, stability_verdict* out )
{
    const double SLICE = 0.2; // s: a signal just before poll() does not end it
    struct pollfd wait = { child->in, POLLIN, 0 };
    double left = 0.0;
    do
    {
        left = interruption_came() ? 0.0 : fmax( 0.0, child->end - wisp_clock_seconds() );
        const int ready = poll( &wait, 1, (int)( 1e3 * fmin( left, SLICE ) ) );
        if ( ready > 0 )
        {
            return read( child->in, out, sizeof *out ) == (ssize_t)sizeof *out;
        }
        if ( ready < 0 && errno != EINTR )
        {
            break;
        }
    } while ( left > 0.0 );
    *out = ( stability_verdict ){ .check = STABILITY_TIME, .severity = 1.0 };
    snprintf( out->message, sizeof out->message, "the scene did not end within %.3g s", child->seconds );
    return true;
}

stability_verdict torture_finish( const torture_child* child )
{
    stability_verdict verdict = { .check = STABILITY_CRASH, .severity = 1.0 };
    if ( child->pid < 0 )
    {
        snprintf( verdict.message, sizeof verdict.message, "no process could be started" );
        return verdict;
    }
    const bool has_verdict = wait_for( child, &verdict );
    close( child->in );
    if ( has_verdict && verdict.check == STABILITY_TIME )
    {
        kill( child->pid, SIGKILL );
    }
    int status = 0;
    waitpid( child->pid, &status, 0 );
    if ( !has_verdict )
    {
        verdict = ( stability_verdict ){ .check = STABILITY_CRASH, .severity = 1.0 };
        snprintf( verdict.message, sizeof verdict.message, "the process ended without a verdict: %s",
                  WIFSIGNALED( status ) ? strsignal( WTERMSIG( status ) ) : "an exit" );
    }
    return verdict;
}

stability_verdict torture_judge_scene( const torture_subject* subject, int twins, double seconds )
{
    const torture_child child = torture_start( subject, twins, seconds );
    return torture_finish( &child );
}
