// A scene in a process of its own: a crash or an endless loop is a verdict like any other.
#include "torture_judges.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

wisp_status torture_read( const torture_subject* subject, wisp_scene* out, wisp_error* error )
{
    char* text = torture_write( subject->tree, NULL );
    const wisp_status status = wisp_scene_parse( text, strlen( text ), subject->name, out, error );
    free( text );
    return status;
}

static void refuse( torture_verdict* out, const wisp_error* error )
{
    *out = ( torture_verdict ){ .judge = TORTURE_REFUSED, .severity = 1.0 };
    snprintf( out->message, sizeof out->message, "%.310s", error->message );
}

// What happens in the child.
static torture_verdict judge_here( const torture_subject* subject, int twins )
{
    torture_verdict verdict = { .judge = TORTURE_HOLDS };
    wisp_error error = { 0 };
    wisp_scene scene;
    if ( torture_read( subject, &scene, &error ) != WISP_OK )
    {
        refuse( &verdict, &error );
        return verdict;
    }
    torture_trace trace;
    if ( torture_trace_run( &scene, &trace, &error ) != WISP_OK )
    {
        refuse( &verdict, &error );
    }
    else if ( torture_judge_trace( &trace, &verdict ) && twins != 0 )
    {
        torture_judge_twins( subject, &trace, twins, &verdict );
    }
    torture_trace_release( &trace );
    wisp_scene_release( &scene );
    return verdict;
}

// A core file of each crash would fill the disk.
static _Noreturn void be_child( const torture_subject* subject, int twins, int out )
{
    const struct rlimit none = { 0, 0 };
    setrlimit( RLIMIT_CORE, &none );
    static const int fatal[] = { SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT };
    for ( int i = 0; i < WISP_COUNT( fatal ); ++i )
    {
        signal( fatal[i], SIG_DFL ); // a host that catches them would go on as two processes
    }
    const torture_verdict verdict = judge_here( subject, twins );
    const ssize_t written = write( out, &verdict, sizeof verdict );
    _exit( written == (ssize_t)sizeof verdict ? 0 : 1 );
}

// Wait until the verdict is there, the child is gone, or the time is over.
static bool wait_for( int in, double seconds, torture_verdict* out )
{
    struct pollfd wait = { in, POLLIN, 0 };
    const double end = wisp_clock_seconds() + seconds;
    for ( double left = seconds; left > 0.0; left = end - wisp_clock_seconds() )
    {
        const int ready = poll( &wait, 1, (int)( 1e3 * left ) + 1 );
        if ( ready > 0 )
        {
            return read( in, out, sizeof *out ) == (ssize_t)sizeof *out;
        }
        if ( ready < 0 && errno != EINTR )
        {
            break;
        }
    }
    *out = ( torture_verdict ){ .judge = TORTURE_TIME, .severity = 1.0 };
    snprintf( out->message, sizeof out->message, "the scene did not end within %.3g s", seconds );
    return true;
}

torture_verdict torture_judge_scene( const torture_subject* subject, int twins, double seconds )
{
    torture_verdict verdict = { .judge = TORTURE_CRASH, .severity = 1.0 };
    int ends[2];
    fflush( NULL );
    if ( pipe( ends ) != 0 )
    {
        snprintf( verdict.message, sizeof verdict.message, "no pipe: %s", strerror( errno ) );
        return verdict;
    }
    const pid_t child = fork();
    if ( child == 0 )
    {
        close( ends[0] );
        be_child( subject, twins, ends[1] );
    }
    close( ends[1] );
    const bool has_verdict = child > 0 && wait_for( ends[0], seconds, &verdict );
    close( ends[0] );
    int status = 0;
    if ( child > 0 && has_verdict && verdict.judge == TORTURE_TIME )
    {
        kill( child, SIGKILL );
    }
    if ( child > 0 )
    {
        waitpid( child, &status, 0 );
    }
    if ( !has_verdict )
    {
        verdict = ( torture_verdict ){ .judge = TORTURE_CRASH, .severity = 1.0 };
        const char* cause = child < 0               ? strerror( errno )
                            : WIFSIGNALED( status ) ? strsignal( WTERMSIG( status ) )
                                                    : "an exit";
        snprintf( verdict.message, sizeof verdict.message, "the process ended without a verdict: %s", cause );
    }
    return verdict;
}
