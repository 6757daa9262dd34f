// Reasons why a pass is selected or absent, as data and as text.
#include "explain_parts.h"

#include <stdio.h>
#include <string.h>

const char* explain_name( const wisp_registry* r, wisp_component c )
{
    return r->store->components[c].def.name;
}

void explain_append( char* text, size_t size, const char* more )
{
    const size_t length = strlen( text );
    snprintf( text + length, size - length, "%s", more );
}

// ---- why a pass is selected ----

static bool is_requested( const wisp_registry* r, wisp_component c )
{
    bool requested = false;
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        requested = requested || store_mask_has( &r->store->entities[slot].requests, c );
    }
    return requested;
}

static bool is_reader( const plan* p, const wisp_pass* reader, int number, const wisp_pass* of, wisp_component c )
{
    return store_mask_has( &p->live, number ) && reader != of && plan_lists( reader->reads, c );
}

int explain_find_reasons( const plan* p, const wisp_registry* r, const wisp_pass* pass, wisp_plan_reason* out )
{
    int count = 0;
    for ( int i = 0; i < WISP_MAX_USES && pass->writes[i] != 0; ++i )
    {
        const wisp_component c = pass->writes[i];
        for ( int k = -1; k < r->pass_count; ++k )
        {
            if ( k < 0 ? is_requested( r, c ) : is_reader( p, r->passes + k, k, pass, c ) )
            {
                if ( out != NULL )
                {
                    out[count] = ( wisp_plan_reason ){ explain_name( r, c ), k < 0 ? NULL : r->passes[k].name };
                }
                ++count;
            }
        }
    }
    return count;
}

// Append the readers among the reasons [first, end). Of many only the last are listed, which are nearest to the
// request.
static void append_readers( wisp_plan_pass* p, int first, int end )
{
    enum
    {
        NAMED = 3,
    };
    const size_t size = sizeof( p->because );
    const int unnamed = end - first > NAMED ? end - first - NAMED : 0;
    explain_append( p->because, size, "read by " );
    for ( int i = first + unnamed; i < end; ++i )
    {
        const bool is_last = i + 1 == end && unnamed == 0;
        explain_append( p->because, size, i == first + unnamed ? "" : is_last ? " and " : ", " );
        explain_append( p->because, size, p->reasons[i].reader );
    }
    if ( unnamed > 0 )
    {
        char more[48];
        snprintf( more, sizeof( more ), " and %d other%s", unnamed, unnamed == 1 ? "" : "s" );
        explain_append( p->because, size, more );
    }
}

// Reasons of one component are consecutive, with a request of the scene first.
void explain_reasons( wisp_plan_pass* p )
{
    const size_t size = sizeof( p->because );
    for ( int i = 0, end; i < p->reason_count; i = end )
    {
        for ( end = i; end < p->reason_count && p->reasons[end].component == p->reasons[i].component; ++end )
        {
        }
        const bool is_requested = p->reasons[i].reader == NULL;
        explain_append( p->because, size, i > 0 ? "; " : "" );
        explain_append( p->because, size, p->reasons[i].component );
        explain_append( p->because, size, is_requested ? " requested by the scene" : " " );
        if ( is_requested == false || end - i > 1 )
        {
            explain_append( p->because, size, is_requested ? " and " : "" );
            append_readers( p, is_requested ? i + 1 : i, end );
        }
    }
}

// ---- why a pass is absent ----

// Components of an entity that passes may require; rows that only a pass fills do not count.
static store_mask source_components( const store_entity* e )
{
    return e->alive ? store_mask_and_not( e->components, e->derived ) : ( store_mask ){ { 0 } };
}

store_mask explain_missing( const wisp_registry* r, const wisp_pass* pass )
{
    store_mask anybody_has = { { 0 } };
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        anybody_has = store_mask_or( anybody_has, source_components( r->store->entities + slot ) );
    }
    return store_mask_and_not( plan_mask( pass->required ), anybody_has );
}

static wisp_plan_state state_of( const wisp_registry* r, const wisp_pass* pass )
{
    const store_mask required = plan_mask( pass->required ), excluded = plan_mask( pass->excluded );
    bool suits = false, is_free = false;
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        const store_entity* e = r->store->entities + slot;
        const bool has_all = e->alive && store_mask_holds( source_components( e ), required );
        suits = suits || has_all;
        is_free = is_free || ( has_all && store_mask_meets( excluded, source_components( e ) ) == false );
    }
    if ( store_mask_any( explain_missing( r, pass ) ) )
    {
        return WISP_PLAN_MISSING;
    }
    // a pass without required components suits every entity; in a world without entities it counts as unrequested
    if ( is_free || ( suits == false && store_mask_any( required ) == false ) )
    {
        return WISP_PLAN_UNREQUESTED;
    }
    return suits ? WISP_PLAN_EXCLUDED : WISP_PLAN_SPLIT;
}

// Append " X", or "s X, Y and Z" of several names.
static void append_list( wisp_plan_pass* p, const char* const* names )
{
    explain_append( p->because, sizeof( p->because ), names[0] != NULL && names[1] != NULL ? "s " : " " );
    for ( int i = 0; names[i] != NULL; ++i )
    {
        explain_append( p->because, sizeof( p->because ), i == 0 ? "" : names[i + 1] == NULL ? " and " : ", " );
        explain_append( p->because, sizeof( p->because ), names[i] );
    }
}

void explain_absence( const wisp_registry* r, const wisp_pass* pass, wisp_plan_pass* out )
{
    const store_mask missing = explain_missing( r, pass );
    for ( int i = 0, count = 0; i < WISP_MAX_USES && pass->required[i] != 0; ++i )
    {
        if ( store_mask_has( &missing, pass->required[i] ) )
        {
            out->missing[count++] = explain_name( r, pass->required[i] );
        }
    }
    static const struct
    {
        const char *before, *after;
    } WORDS[] = {
        [WISP_PLAN_MISSING] = { "needs component", ", which no entity has" },
        [WISP_PLAN_SPLIT] = { "needs component", ", which no single entity has together" },
        [WISP_PLAN_EXCLUDED] = { "excluded by component", "" },
        [WISP_PLAN_UNREQUESTED] = { "neither requested nor read: component", "" },
    };
    out->state = state_of( r, pass );
    const char* const first_write[] = { out->writes[0], NULL };
    const char* const* lists[] = {
        [WISP_PLAN_MISSING] = out->missing,
        [WISP_PLAN_SPLIT] = out->required,
        [WISP_PLAN_EXCLUDED] = out->excluded,
        [WISP_PLAN_UNREQUESTED] = first_write,
    };
    explain_append( out->because, sizeof( out->because ), WORDS[out->state].before );
    append_list( out, lists[out->state] );
    explain_append( out->because, sizeof( out->because ), WORDS[out->state].after );
}
