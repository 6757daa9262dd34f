/// A function of a test that is called after each run of a pass.
#pragma once

#include "support.h"

#include "world.h"

#include <string.h>

typedef struct pass_hook
{
    void ( *after )( void* user );
    void* user;
    wisp_pass_fn* run; ///< of the pass
    void* run_user;
} pass_hook;

static inline void pass_hook_run( wisp_frame* frame, const wisp_span* span, void* user )
{
    const pass_hook* hook = user;
    hook->run( frame, span, hook->run_user );
    hook->after( hook->user );
}

/// @param hook `after` and `user` are set; must live as long as the world
static inline void pass_hook_set( wisp_world* world, const char* pass, pass_hook* hook )
{
    for ( int i = 0; i < world->registry.pass_count; ++i )
    {
        wisp_pass* p = world->registry.passes + i;
        if ( strcmp( p->name, pass ) == 0 )
        {
            hook->run = p->run;
            hook->run_user = p->user;
            p->run = pass_hook_run;
            p->user = hook;
            return;
        }
    }
    fail_msg( "no pass %s", pass );
}
