#include "interruption.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

static volatile sig_atomic_t noted; // the number of the signal, or 0

static const int signals[] = { SIGINT, SIGTERM };

static void note( int number )
{
    noted = number;
}

void interruption_begin( void )
{
    // One-shot, so that a second signal has its usual effect. Calls are restarted: a file that is being written must
    // not fail because of a signal.
    struct sigaction action = { .sa_handler = note, .sa_flags = SA_RESTART | (int)SA_RESETHAND };
    sigemptyset( &action.sa_mask );
    for ( int i = 0; i < WISP_COUNT( signals ); ++i )
    {
        struct sigaction before;
        if ( sigaction( signals[i], NULL, &before ) == 0 && before.sa_handler != SIG_IGN )
        {
            sigaction( signals[i], &action, NULL );
        }
    }
}

void interruption_leave_to_parent( void )
{
    for ( int i = 0; i < WISP_COUNT( signals ); ++i )
    {
        struct sigaction before;
        if ( sigaction( signals[i], NULL, &before ) == 0 && before.sa_handler != SIG_IGN )
        {
            signal( signals[i], SIG_DFL );
        }
    }
#ifdef __linux__
    prctl( PR_SET_PDEATHSIG, SIGKILL );
#endif
}

bool interruption_came( void )
{
    return noted != 0;
}

wisp_status interruption_check( wisp_error* error )
{
    return noted == 0
               ? WISP_OK
               : wisp_fail( error, WISP_CONFLICT, "interrupted by %s", noted == SIGINT ? "Ctrl-C" : "SIGTERM" );
}

int interruption_status( int status )
{
    return noted == 0 ? status : 128 + (int)noted;
}

void interruption_wait( pid_t child, int* status )
{
    enum
    {
        POLL_MS = 20,
        PATIENCE_MS = 1000,
    };
    int waited = 0;
    pid_t ended;
    while ( ( ended = waitpid( child, status, WNOHANG ) ) == 0 || ( ended < 0 && errno == EINTR ) )
    {
        if ( noted && ( waited == 0 || waited == PATIENCE_MS ) )
        {
            kill( child, waited == 0 ? SIGTERM : SIGKILL );
        }
        waited += noted ? POLL_MS : 0;
        poll( NULL, 0, POLL_MS );
    }
    *status = ended == child ? *status : 0xff00;
}
