/// Ctrl-C and SIGTERM during long work: loops end after the step that they are in, and what was done until then is
/// kept. A second signal ends the program at once.
#pragma once

#include "wisp/base.h"

#include <sys/types.h>

/// From now on the first SIGINT or SIGTERM is only noted. A signal that the caller of the program ignores stays
/// ignored.
void interruption_begin( void );
/// A process that was forked goes on as if there were no handlers, and ends if its parent does.
void interruption_leave_to_parent( void );

/// @return whether a signal has come
bool interruption_came( void );
/// For loops that end by a status. @return WISP_CONFLICT a signal has come, with a message that says so
wisp_status interruption_check( wisp_error* error );
/// @return the exit status: `status`, or 128 and the number of the signal that has come
int interruption_status( int status );

/// Wait for a child, as waitpid() does. If a signal comes it gets SIGTERM, and after a second SIGKILL.
/// @param status receives that of waitpid(), as if of a failure if it cannot be waited for
void interruption_wait( pid_t child, int* status );
