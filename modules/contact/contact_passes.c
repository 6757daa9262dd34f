// A substep of contact: look for pairs if points went too far since the last search, find the planes between those that
// may meet, push, guard.
#include "contact_internal.h"

#include <string.h>

contact_work contact_begin_work( wisp_frame* frame, const wisp_span* span, contact_state* state )
{
    return ( contact_work ){
        .state = state,
        .soup = &state->soup,
        .memory = wisp_frame_column( frame, span->entity, state->active, 0 ),
        .parallel = wisp_frame_parallel( frame, span ),
        .frame = frame,
        .seconds = wisp_frame_seconds( frame ),
        .worker = span->worker,
    };
}

static bool succeeds( const contact_work* work, wisp_status status, const wisp_error* error )
{
    if ( status != WISP_OK )
    {
        wisp_frame_fail( work->frame, status, "%s", error->sentence );
    }
    return status == WISP_OK;
}

// A restored snapshot brings the places of its last search along: the same pairs come of them. Whether something is crossed is
// known too: if it is, all is searched anew anyway.
static bool search_restored( const contact_work* work )
{
    wisp_error error = { 0 };
    memset( work->soup->is_tangled, 0, (size_t)work->soup->point_count );
    return succeeds( work, contact_search( work, &error ), &error );
}

static bool search_anew( const contact_work* work )
{
    wisp_error error = { 0 };
    contact_set_reach( work );
    work->soup->is_anew = false;
    work->memory->figures.searches += 1;
    const wisp_status status = contact_mark_tangles( work, &error );
    return succeeds( work, status == WISP_OK ? contact_search( work, &error ) : status, &error );
}

static void begin_step( const contact_work* work )
{
    wisp_contact_figures* f = &work->memory->figures;
    *f = ( wisp_contact_figures ){ .crossings = -1 };
    for ( int g = 0; g < work->state->guest_count; ++g )
    {
        memset( work->state->guests[g].impulse, 0, sizeof( work->state->guests[g].impulse ) );
    }
}

void contact_find( wisp_frame* frame, const wisp_span* span, void* user )
{
    contact_state* state = user;
    const contact_work work = contact_begin_work( frame, span, state );
    contact_soup* s = &state->soup;
    if ( span->substep == 0 )
    {
        begin_step( &work );
    }
    if ( state->changed )
    {
        const wisp_status status = contact_build_soup( &work );
        if ( status != WISP_OK )
        {
            wisp_frame_fail( frame, status, "no memory for the points of %d entities in contact",
                             state->guest_count );
            return;
        }
        state->changed = false;
    }
    contact_gather( &work, true );
    if ( s->candidate_count < 0 && s->is_anew == false && search_restored( &work ) == false )
    {
        return;
    }
    const contact_reached reached = contact_expect_ways( &work );
    // while something is crossed, what is changes from substep to substep
    const bool is_due = s->is_anew || reached == CONTACT_BEYOND || work.memory->tangled != 0;
    if ( is_due && search_anew( &work ) == false )
    {
        return;
    }
    contact_find_rows( &work );
}

// What went farther than it was expected to has no rows that could hold it: they are found for as far as it went.
static void guard_ways( const contact_work* work )
{
    const contact_reached reached = contact_measure_ways( work );
    if ( reached == CONTACT_BEYOND && search_anew( work ) == false )
    {
        return;
    }
    if ( reached != CONTACT_WITHIN )
    {
        contact_find_rows( work );
    }
    work->memory->figures.guarded += contact_guard( work );
}

void contact_project( wisp_frame* frame, const wisp_span* span, void* user )
{
    contact_state* state = user;
    const contact_work work = contact_begin_work( frame, span, state );
    contact_soup* s = &state->soup;
    if ( s->candidate_count < 0 )
    {
        return; // the step has failed already
    }
    const bool is_end = span->iteration + 1 == wisp_frame_iterations( frame );
    contact_gather( &work, false );
    contact_project_rows( &work );
    if ( is_end )
    {
        memset( s->shift, 0, (size_t)s->point_count * 4 * sizeof( float ) );
        contact_recover( &work );
        contact_untangle( &work );
        if ( state->wants_figures )
        {
            contact_sum_impulses( &work );
        }
        if ( state->world.guard && state->world.features == WISP_CONTACT_EXACT )
        {
            guard_ways( &work );
        }
        else
        {
            contact_measure_ways( &work );
        }
        contact_spend_ways( &work );
    }
    contact_scatter( &work, is_end );
}

void contact_keep( wisp_frame* frame, const wisp_span* span, void* user )
{
    contact_state* state = user;
    const contact_work work = { .state = state, .soup = &state->soup, .frame = frame };
    if ( state->soup.candidate_count >= 0 )
    {
        contact_keep_guest( &work, state->guests + contact_find_guest( state, span->entity ) );
    }
}
