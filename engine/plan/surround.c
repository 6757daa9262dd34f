#include "plan.h"

#include <string.h>

// A call of what is surrounded, which the function around it makes by call_inner().
typedef struct inner_call
{
    const plan_around* around;
    wisp_frame* frame;
    const wisp_span* span;
    int substep_end; // of a fusion
} inner_call;

static void call_inner( void* call )
{
    const inner_call* c = call;
    if ( c->around->run != NULL )
    {
        c->around->run( c->frame, c->span, c->around->user );
    }
    else
    {
        c->around->run_fused( c->frame, c->span, c->substep_end, c->around->user );
    }
}

static void run_around( wisp_frame* frame, const wisp_span* span, void* user )
{
    const plan_around* around = user;
    inner_call call = { around, frame, span, 0 };
    around->around( around->around_user, call_inner, &call );
}

static void run_around_fused( wisp_frame* frame, const wisp_span* span, int substep_end, void* user )
{
    const plan_around* around = user;
    inner_call call = { around, frame, span, substep_end };
    around->around( around->around_user, call_inner, &call );
}

static bool surround_pass( wisp_registry* r, const char* name, plan_around* a )
{
    for ( int i = 0; i < r->pass_count; ++i )
    {
        wisp_pass* pass = r->passes + i;
        if ( strcmp( pass->name, name ) == 0 && pass->run != run_around )
        {
            a->run = pass->run;
            a->user = pass->user;
            pass->run = run_around;
            pass->user = a;
            return true;
        }
    }
    return false;
}

static bool surround_fusion( wisp_registry* r, const char* name, plan_around* a )
{
    for ( int i = 0; i < r->join_count; ++i )
    {
        plan_fusion* join = r->joins + i;
        if ( strcmp( join->name, name ) == 0 && join->run != run_around_fused )
        {
            a->run_fused = join->run;
            a->user = join->user;
            join->run = run_around_fused;
            join->user = a;
            return true;
        }
    }
    return false;
}

bool plan_surround( wisp_registry* r, const char* name, wisp_around_fn* around, void* user )
{
    plan_around* a = r->arounds + r->around_count;
    if ( r->around_count == PLAN_MAX_AROUNDS )
    {
        return false;
    }
    *a = ( plan_around ){ .around = around, .around_user = user };
    const bool is_found = surround_pass( r, name, a ) || surround_fusion( r, name, a );
    r->around_count += is_found ? 1 : 0;
    return is_found;
}
