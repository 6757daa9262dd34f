// A trial from its first sample to its verdict.
#include "stability.h"

#include <stdarg.h>
#include <stdio.h>

static wisp_status watch_frames( stability_trial* trial, stability_outcome* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int frame = 0; frame <= trial->frame_count && status == WISP_OK; ++frame )
    {
        stability_observation observation = { 0 };
        status = frame > 0 ? trial->step( trial->context, frame, error ) : WISP_OK;
        if ( status == WISP_OK )
        {
            status = trial->observe( trial->context, frame, &observation, error );
        }
        if ( status == WISP_OK )
        {
            stability_watch( &out->score, &trial->limits, trial->frame_count, &observation );
        }
    }
    return status;
}

wisp_status stability_run( stability_trial* trial, stability_outcome* out, wisp_error* error )
{
    *out = ( stability_outcome ){ .limits = trial->limits };
    wisp_status status = watch_frames( trial, out, error );
    if ( status == WISP_OK )
    {
        out->verdict = stability_judge( &out->score, &trial->limits );
        out->hash = trial->hash( trial->context );
        if ( trial->world != NULL )
        {
            out->undirected = wisp_world_counter( trial->world, WISP_COUNT_DEGENERATE_LINK );
            out->laid = wisp_world_counter( trial->world, WISP_COUNT_STRAND_RESET );
            out->unsolved = wisp_world_counter( trial->world, WISP_COUNT_NOT_CONVERGED );
            out->halted = wisp_world_counter( trial->world, WISP_COUNT_HALTED );
        }
    }
    trial->close( trial->context );
    return status;
}

static wisp_status run_with( const stability_cell* cell, int workers, double max_strain, stability_outcome* out,
                             wisp_error* error )
{
    stability_trial trial = { 0 };
    wisp_status status = cell->subject->enter( cell->subject->way, &cell->axes, workers, &trial, error );
    trial.limits.strain = max_strain;
    return status == WISP_OK ? stability_run( &trial, out, error ) : status;
}

wisp_status stability_run_cell( const stability_cell* cell, double max_strain, stability_outcome* out,
                                wisp_error* error )
{
    *out = ( stability_outcome ){ 0 };
    wisp_status status = run_with( cell, 1, max_strain, out, error );
    if ( status == WISP_BAD_INPUT || ( status == WISP_OK && cell->is_refused ) )
    {
        // a rejection has its message, and is correct only where expected
        const bool is_right = status == WISP_BAD_INPUT && cell->is_refused;
        *out = ( stability_outcome ){ .is_refused = status == WISP_BAD_INPUT };
        snprintf( out->said, sizeof( out->said ), "%.150s", out->is_refused ? error->message : "not refused" );
        out->verdict.broke = is_right ? STABILITY_LIMIT_NONE : STABILITY_LIMIT_CLAIM;
        *error = ( wisp_error ){ 0 };
        return WISP_OK;
    }
    if ( status == WISP_OK && cell->two_workers )
    {
        stability_outcome other;
        status = run_with( cell, 2, max_strain, &other, error );
        if ( status == WISP_OK && other.hash != out->hash && out->verdict.broke == STABILITY_LIMIT_NONE )
        {
            out->verdict.broke = STABILITY_LIMIT_BITS;
        }
    }
    return status;
}

void stability_claim( stability_outcome* out, bool holds, const char* format, ... )
{
    va_list list;
    va_start( list, format );
    vsnprintf( out->said, sizeof( out->said ), format, list );
    va_end( list );
    if ( holds == false && out->verdict.broke == STABILITY_LIMIT_NONE )
    {
        out->verdict.broke = STABILITY_LIMIT_CLAIM;
    }
}
