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

// What failed half way left lists that miss pairs: the next step looks for all.
static bool succeeds( const contact_work* work, wisp_status status, const wisp_error* error )
{
    if ( status != WISP_OK )
    {
        work->soup->is_listed = false;
        wisp_frame_fail( work->frame, status, "%s", error->sentence );
    }
    return status == WISP_OK;
}

static bool search( const contact_work* work )
{
    wisp_error error = { 0 };
    work->soup->searches += 1;
    return succeeds( work, contact_search( work, &error ), &error );
}

// While something is crossed, what is changes from substep to substep.
static bool mark_tangles( const contact_work* work )
{
    wisp_error error = { 0 };
    return succeeds( work, contact_mark_tangles( work, &error ), &error );
}

static bool find_rows( const contact_work* work )
{
    wisp_error error = { 0 };
    return succeeds( work, contact_find_rows( work, &error ), &error );
}

static bool find_late_rows( const contact_work* work )
{
    wisp_error error = { 0 };
    return succeeds( work, contact_find_late_rows( work, &error ), &error );
}

static void begin_step( const contact_work* work )
{
    wisp_contact_figures* f = &work->memory->figures;
    *f = ( wisp_contact_figures ){ .crossings = -1 };
    work->soup->searches = 0;
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
    const contact_reached reached = contact_expect_ways( &work );
    const bool is_new = s->is_listed == false || s->is_anew;
    s->is_listed = is_new == false;
    s->is_anew = false;
    if ( ( is_new || work.memory->tangled != 0 ) && mark_tangles( &work ) == false )
    {
        return;
    }
    const bool is_enough = is_new == false && reached != CONTACT_BEYOND && contact_lists_too_many( &work ) == false;
    if ( is_enough || search( &work ) )
    {
        find_rows( &work );
    }
}

// What went elsewhere than it was expected to has no rows that could hold it: they are found for where it went. Who is cut then
// goes elsewhere again, until nobody does.
static void guard_ways( const contact_work* work )
{
    enum
    {
        MOST_ROUNDS = 8, // two were the most that any test needed
    };
    contact_reached reached = contact_measure_ways( work );
    for ( int round = 0; round < MOST_ROUNDS; ++round )
    {
        const bool is_searched = reached != CONTACT_BEYOND || search( work );
        if ( is_searched == false || ( reached != CONTACT_WITHIN && find_late_rows( work ) == false ) )
        {
            return;
        }
        const int cut = contact_guard( work );
        work->memory->figures.guarded += cut;
        reached = cut > 0 ? contact_measure_ways( work ) : CONTACT_WITHIN;
        if ( reached == CONTACT_WITHIN )
        {
            return;
        }
    }
    contact_hold( work );
}

void contact_project( wisp_frame* frame, const wisp_span* span, void* user )
{
    contact_state* state = user;
    const contact_work work = contact_begin_work( frame, span, state );
    contact_soup* s = &state->soup;
    if ( s->is_listed == false )
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
    if ( state->soup.is_listed )
    {
        contact_keep_guest( &work, state->guests + contact_find_guest( state, span->entity ) );
    }
}
