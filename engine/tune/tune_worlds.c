// Runs of worlds: the reference once, then each configuration against it.
#include "tune.h"

#include "wisp/module/definition.h"

#include "alloc.h"

#include <float.h>
#include <math.h>

void wisp_init_tune_worlds_def( wisp_tune_worlds_def* def, size_t size )
{
    const wisp_tune_worlds_def values = {
        .dt = 1.0f / 60.0f,
        .step_count = 120,
        .sample_count = 12,
        .reference_factor = 16,
    };
    wisp_def_init( def, size, &values, sizeof( values ) );
}

static wisp_status check_def( const wisp_tune_worlds_def* def, wisp_error* error )
{
    if ( !def->build )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "expected a callback that builds the world of a configuration" );
    }
    if ( !( def->dt > 0.0f ) || !isfinite( def->dt ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "dt: got %g, expected a number above 0", (double)def->dt );
    }
    if ( def->sample_count < 1 || def->sample_count > def->step_count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "sample_count: got %d, expected 1 to step_count, which is %d",
                          def->sample_count, def->step_count );
    }
    if ( def->reference_factor < 2 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "reference_factor: got %d, expected at least 2",
                          def->reference_factor );
    }
    return WISP_OK;
}

// ---- a run ----

typedef struct worlds_run
{
    const wisp_tune_worlds_def* def;
    const wisp_tune_def* args;
    wisp_vec3* reference;   // [observation][total]
    size_t reference_bytes; // 0: the reference has not run yet
    int total;              // points of an observation
    double* times;          // [step_count] ms
} worlds_run;

/// Results of the run of one world so far.
typedef struct world_sums
{
    double squares; // m^2
    double largest; // m
    int observations;
    bool is_halted;
} world_sums;

static wisp_status fail_in_world( const wisp_tune_world* w, wisp_status status, wisp_error* error )
{
    return wisp_fail( error, status, "%s", wisp_world_message( w->world ) );
}

static wisp_status step_world( const worlds_run* r, wisp_tune_world* w, int step, wisp_error* error )
{
    if ( r->def->step )
    {
        return r->def->step( r->def->user, w, step, error );
    }
    wisp_status status = wisp_world_step( w->world, r->def->dt );
    return status == WISP_OK ? WISP_OK : fail_in_world( w, status, error );
}

static wisp_status view_points( const wisp_tune_world* w, int entry, wisp_view* out, wisp_error* error )
{
    const wisp_tune_points* points = &w->points[entry];
    wisp_status status = wisp_world_view( w->world, points->entity, points->component, out );
    return status == WISP_OK ? WISP_OK : fail_in_world( w, status, error );
}

static wisp_status count_points( const wisp_tune_world* w, int* total, wisp_error* error )
{
    *total = 0;
    for ( int i = 0; i < w->point_count; ++i )
    {
        wisp_view view;
        wisp_status status = view_points( w, i, &view, error );
        if ( status != WISP_OK )
        {
            return status;
        }
        *total += view.count;
    }
    return WISP_OK;
}

static wisp_status make_room( worlds_run* r, const wisp_tune_world* w, wisp_error* error )
{
    wisp_status status = count_points( w, &r->total, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( r->total == 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "the world has no points to compare" );
    }
    size_t bytes;
    const bool fits =
        base_size_multiply( (size_t)r->total * sizeof( wisp_vec3 ), (size_t)r->def->sample_count, &bytes );
    r->reference = fits ? base_allocate( &r->args->allocator, bytes, _Alignof( wisp_vec3 ) ) : NULL;
    if ( !r->reference )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d points in %d samples", r->total,
                          r->def->sample_count );
    }
    r->reference_bytes = bytes;
    return WISP_OK;
}

static void compare( wisp_vec3 is, wisp_vec3 reference, world_sums* sums )
{
    const double x = (double)is.x - (double)reference.x;
    const double y = (double)is.y - (double)reference.y;
    const double z = (double)is.z - (double)reference.z;
    const double square = x * x + y * y + z * z;
    sums->squares += square;
    sums->largest = fmax( sums->largest, sqrt( square ) );
    sums->is_halted |= !isfinite( square );
}

// Record the reference, or compare with it.
static wisp_status observe( worlds_run* r, const wisp_tune_world* w, bool is_reference, world_sums* sums,
                            wisp_error* error )
{
    wisp_status status = is_reference && r->reference_bytes == 0 ? make_room( r, w, error ) : WISP_OK;
    int total = 0;
    status = status == WISP_OK ? count_points( w, &total, error ) : status;
    if ( status == WISP_OK && total != r->total )
    {
        status = wisp_fail( error, WISP_CONFLICT, "got a world of %d points and one of %d, which cannot be compared",
                            r->total, total );
    }
    wisp_vec3* reference = r->reference + (size_t)sums->observations * (size_t)r->total;
    for ( int i = 0; i < w->point_count && status == WISP_OK; ++i )
    {
        wisp_view view;
        status = view_points( w, i, &view, error );
        for ( int v = 0; v < view.count && status == WISP_OK; ++v, ++reference )
        {
            const wisp_vec3* point = (const wisp_vec3*)( (const char*)view.data + (size_t)v * view.stride );
            if ( is_reference )
            {
                *reference = *point;
            }
            compare( *point, *reference, sums );
        }
    }
    ++sums->observations;
    return status;
}

// Samples are spread evenly, and the last step is one of them.
static bool is_observation( const wisp_tune_worlds_def* def, int step )
{
    const int64_t observations = def->sample_count, steps = def->step_count;
    return ( step + 1 ) * observations / steps > step * observations / steps;
}

static wisp_status run_steps( worlds_run* r, wisp_tune_world* w, bool is_reference, wisp_tune_sample* out,
                              wisp_error* error )
{
    world_sums sums = { 0 };
    wisp_status status = WISP_OK;
    int step = 0;
    for ( ; step < r->def->step_count && status == WISP_OK && !sums.is_halted; ++step )
    {
        const double start = wisp_clock_seconds();
        status = step_world( r, w, step, error );
        r->times[step] = 1e3 * ( wisp_clock_seconds() - start );
        sums.is_halted |= wisp_world_counter( w->world, WISP_COUNT_HALTED ) > 0;
        if ( status == WISP_OK && !sums.is_halted && is_observation( r->def, step ) )
        {
            status = observe( r, w, is_reference, &sums, error );
        }
    }
    if ( status == WISP_OK )
    {
        const double count = (double)sums.observations * (double)r->total;
        *out = ( wisp_tune_sample ){ .ms = tune_median( r->times, step ),
                                     .error = sums.is_halted ? 0.0 : sqrt( sums.squares / count ),
                                     .largest = sums.is_halted ? 0.0 : sums.largest,
                                     .is_halted = sums.is_halted };
    }
    return status;
}

static wisp_status request_points( const wisp_tune_world* w, wisp_error* error )
{
    if ( !w->world || w->point_count < 1 || !w->points )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "build callback: got no world, or no points to compare" );
    }
    wisp_status status = WISP_OK;
    for ( int i = 0; i < w->point_count && status == WISP_OK; ++i )
    {
        const wisp_component component = w->points[i].component;
        if ( component != WISP_SURFACE_POINTS && component != WISP_STRAND_POINTS )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "points[%d]: got component %d, expected surface.points or strand.points", i,
                              component );
        }
        status = wisp_request( w->world, w->points[i].entity, component );
    }
    return status == WISP_OK ? WISP_OK : fail_in_world( w, status, error );
}

static wisp_status run_world( worlds_run* r, const int* configuration, int factor, wisp_tune_sample* out,
                              wisp_error* error )
{
    const wisp_tune_worlds_def* def = r->def;
    wisp_tune_world w = { 0 };
    wisp_status status = def->build( def->user, configuration, factor, &w, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = request_points( &w, error );
    status = status == WISP_OK ? run_steps( r, &w, factor > 1, out, error ) : status;
    if ( def->destroy )
    {
        def->destroy( def->user, &w );
    }
    else
    {
        wisp_world_destroy( w.world );
    }
    return status;
}

static wisp_status run_choice( void* user, const int* configuration, wisp_tune_sample* out, wisp_error* error )
{
    return run_world( user, configuration, 1, out, error );
}

// ---- the reference, and the search ----

static wisp_status run_reference( worlds_run* r, wisp_error* error )
{
    int finest[WISP_TUNE_MAX_PARAMETERS] = { 0 };
    for ( int k = 0; k < r->args->parameter_count; ++k )
    {
        finest[k] = r->args->parameters[k].value_count - 1;
    }
    wisp_tune_sample sample;
    wisp_status status = run_world( r, finest, r->def->reference_factor, &sample, error );
    if ( status == WISP_OK && sample.is_halted )
    {
        status = wisp_fail( error, WISP_CONFLICT,
                            "the reference, with %d times the substeps of the finest configuration, became unstable: "
                            "there is nothing to compare with",
                            r->def->reference_factor );
    }
    return status;
}

static wisp_status search_worlds( worlds_run* r, wisp_tune_result* out, wisp_error* error )
{
    const double start = wisp_clock_seconds();
    wisp_status status = run_reference( r, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const double spent = wisp_clock_seconds() - start;
    wisp_tune_def args = *r->args;
    args.run = run_choice;
    args.user = r;
    // If the reference has used up the time, the one run that every search makes remains.
    args.max_seconds = args.max_seconds > spent ? args.max_seconds - spent : DBL_MIN;
    status = wisp_tune( &args, out, error );
    out->seconds += status == WISP_OK ? spent : 0.0;
    return status;
}

wisp_status wisp_tune_worlds( const wisp_tune_def* given_args, const wisp_tune_worlds_def* given,
                              wisp_tune_result* out, wisp_error* error )
{
    if ( out == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "out: got null, expected where to store the result" );
    }
    *out = ( wisp_tune_result ){ 0 };
    wisp_tune_def arg_values = wisp_default_tune_def();
    wisp_tune_worlds_def values = wisp_default_tune_worlds_def();
    const wisp_tune_def* args = &arg_values;
    const wisp_tune_worlds_def* def = &values;
    WISP_TRY( wisp_def_read( &arg_values, given_args, "wisp_default_tune_def", error ) );
    WISP_TRY( wisp_def_read( &values, given, "wisp_default_tune_worlds_def", error ) );
    int setting_count;
    wisp_status status = tune_check_def( args, &setting_count, error );
    status = status == WISP_OK ? check_def( def, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    worlds_run r = { .def = def, .args = args };
    const size_t bytes = (size_t)def->step_count * sizeof( double );
    r.times = base_allocate( &args->allocator, bytes, _Alignof( double ) );
    status = r.times ? search_worlds( &r, out, error )
                     : wisp_fail( error, WISP_NO_MEMORY, "out of memory for the times of %d steps", def->step_count );
    base_release( &args->allocator, r.reference, r.reference_bytes );
    base_release( &args->allocator, r.times, bytes );
    return status;
}
