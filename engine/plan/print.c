// The plan as text: section, name and reason of each pass.
#include "plan.h"

#include <stdio.h>

void wisp_plan_info_text( const wisp_plan_info* report, char* out, size_t size )
{
    if ( report == NULL || out == NULL )
    {
        return;
    }
    snprintf( out, size, "plan %016llx: %d passes in %d nodes and %d waves, %s", (unsigned long long)report->hash,
              report->active_count, report->node_count, report->wave_count,
              report->has_substep_loop ? "with a substep loop" : "no substep loop" );
}

void wisp_plan_pass_text( const wisp_plan_pass* pass, char* out, size_t size )
{
    if ( pass == NULL || out == NULL )
    {
        return;
    }
    if ( pass->state == WISP_PLAN_ACTIVE )
    {
        const bool is_joined = pass->fusion != NULL;
        snprintf( out, size, "  %-11s wave %d  %-24s %s%s%s%s%s", pass->loop, pass->wave, pass->name,
                  pass->is_fused ? "(fused) " : "", is_joined ? "(in " : "", is_joined ? pass->fusion : "",
                  is_joined ? ") " : "", pass->because );
    }
    else
    {
        snprintf( out, size, "  absent              %-24s %s", pass->name, pass->because );
    }
}

void plan_print( const wisp_plan_info* report, void ( *write )( void* user, const char* line ), void* user )
{
    char line[512];
    wisp_plan_info_text( report, line, sizeof( line ) );
    write( user, line );
    for ( int i = 0; i < report->pass_count; ++i )
    {
        wisp_plan_pass_text( report->passes + i, line, sizeof( line ) );
        write( user, line );
    }
}
