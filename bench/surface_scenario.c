#include "surface_scenario.h"

#include "cells.h"

#include <math.h>
#include <stdlib.h>

int scenario_path_observations( const scenario_plan* plan )
{
    return plan->warm_steps / plan->turn_steps;
}

wisp_status path_record_create( int vertex_count, int observation_count, path_record* out, wisp_error* error )
{
    *out = ( path_record ){ .vertex_count = vertex_count, .observation_count = observation_count };
    out->points = calloc( (size_t)vertex_count * (size_t)observation_count, 3 * sizeof( double ) );
    return out->points ? WISP_OK
                       : wisp_fail( error, WISP_NO_MEMORY, "no memory for the path of %d vertices", vertex_count );
}

void path_record_destroy( path_record* record )
{
    free( record->points );
    *record = ( path_record ){ 0 };
}

// ---- observations ----

typedef struct observation_sums
{
    double stretch_max, stretch_mean, kinetic;
    int count;     // of the observations behind these
    double square; // m^2, sum over the observations of the path
    int path_count;
    double energy_lost;
} observation_sums;

static double square_distance( const path_record* reference, int number, const wisp_vec3* points )
{
    double sum = 0.0;
    const double* q = reference->points + (size_t)number * (size_t)reference->vertex_count * 3;
    for ( int i = 0; i < reference->vertex_count; ++i, q += 3 )
    {
        double x = (double)points[i].x - q[0], y = (double)points[i].y - q[1], z = (double)points[i].z - q[2];
        sum += x * x + y * y + z * z;
    }
    return sum / reference->vertex_count;
}

static void keep_path( path_record* record, int number, const wisp_vec3* points )
{
    double* q = record->points + (size_t)number * (size_t)record->vertex_count * 3;
    for ( int i = 0; i < record->vertex_count; ++i, q += 3 )
    {
        q[0] = (double)points[i].x;
        q[1] = (double)points[i].y;
        q[2] = (double)points[i].z;
    }
}

static void observe( surface_implementation* implementation, observation_sums* sums )
{
    surface_observation seen = surface_implementation_observe( implementation );
    sums->stretch_max += seen.stretch_max;
    sums->stretch_mean += seen.stretch_mean;
    sums->kinetic += seen.kinetic;
    ++sums->count;
}

static wisp_status observe_path( surface_implementation* implementation, const path_record* reference,
                                 path_record* record, observation_sums* sums, wisp_error* error )
{
    const wisp_vec3* points;
    wisp_status status = surface_implementation_points( implementation, &points, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    sums->square += reference ? square_distance( reference, sums->path_count, points ) : NAN;
    if ( record )
    {
        keep_path( record, sums->path_count, points );
    }
    ++sums->path_count;
    return WISP_OK;
}

// ---- running ----

static wisp_status warm_one( surface_implementation* implementation, int steps, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int s = 0; s < steps && status == WISP_OK; ++s )
    {
        status = surface_implementation_step( implementation, error );
    }
    return status;
}

// The first implementation is sampled during its steps; the others do the same steps.
static wisp_status warm( surface_implementation* implementations, int count, const scenario_plan* plan,
                         const path_record* reference, path_record* record, observation_sums* sums,
                         wisp_error* error )
{
    wisp_status status = WISP_OK;
    int observations = scenario_path_observations( plan );
    for ( int i = 0; i < observations && status == WISP_OK; ++i )
    {
        status = warm_one( &implementations[0], plan->turn_steps, error );
        status = status == WISP_OK ? observe_path( &implementations[0], reference, record, sums, error ) : status;
    }
    status = status == WISP_OK
                 ? warm_one( &implementations[0], plan->warm_steps - observations * plan->turn_steps, error )
                 : status;
    surface_observation seen = surface_implementation_observe( &implementations[0] );
    sums->energy_lost = seen.potential < 0.0 ? 1.0 + seen.kinetic / seen.potential : NAN;
    for ( int e = 1; e < count && status == WISP_OK; ++e )
    {
        status = warm_one( &implementations[e], plan->warm_steps, error );
    }
    return status;
}

// @param samples receives the times of the counted steps
static wisp_status take_turn( surface_implementation* implementation, int steps, double* samples, int* sample_count,
                              wisp_error* error )
{
    for ( int s = 0; s < steps; ++s )
    {
        double start = wisp_clock_seconds();
        wisp_status status = surface_implementation_step( implementation, error );
        double ms = 1e3 * ( wisp_clock_seconds() - start );
        if ( status == WISP_OK && ( s > 0 || steps == 1 ) )
        {
            samples[( *sample_count )++] = ms;
            status = surface_implementation_keep_profile( implementation );
        }
        if ( status != WISP_OK )
        {
            return status;
        }
    }
    return WISP_OK;
}

static void conclude( surface_implementation* implementations, int count, double* samples, const int* sample_count,
                      int room, const observation_sums* sums, scenario_stats* out )
{
    bool is_halted = out->halted_at > 0;
    for ( int e = 0; e < count; ++e )
    {
        out->ms[e] = stats_summarise( samples + (size_t)e * (size_t)room, is_halted ? 0 : sample_count[e] );
        out->links_ms[e] = is_halted ? NAN : surface_implementation_pass_ms( &implementations[e], "links." );
    }
    out->stretch_max = is_halted ? NAN : sums->stretch_max / sums->count;
    out->stretch_mean = is_halted ? NAN : sums->stretch_mean / sums->count;
    out->kinetic = is_halted ? NAN : sums->kinetic / sums->count;
    out->energy_lost = is_halted ? NAN : sums->energy_lost;
    out->path = is_halted ? NAN : sqrt( sums->square / sums->path_count );
}

static wisp_status take_turns( surface_implementation* implementations, int count, const scenario_plan* plan,
                               const path_record* reference, path_record* record, double* samples,
                               scenario_stats* out, wisp_error* error )
{
    int sample_count[SCENARIO_IMPLEMENTATIONS_MAX] = { 0 };
    observation_sums sums = { 0 };
    wisp_status status = warm( implementations, count, plan, reference, record, &sums, error );
    for ( int turn = 0;
          turn < plan->measured_steps / plan->turn_steps && status == WISP_OK && implementations[0].halted_at == 0;
          ++turn )
    {
        for ( int e = 0; e < count && status == WISP_OK; ++e )
        {
            double* room = samples + (size_t)e * (size_t)plan->measured_steps;
            status = take_turn( &implementations[e], plan->turn_steps, room, &sample_count[e], error );
        }
        if ( status == WISP_OK && implementations[0].halted_at == 0 )
        {
            observe( &implementations[0], &sums );
        }
    }
    for ( int e = 0; e < count && status == WISP_OK; ++e )
    {
        status = surface_implementation_hash( &implementations[e], &out->hash[e], error );
    }
    if ( status == WISP_OK )
    {
        out->halted_at = implementations[0].halted_at;
        conclude( implementations, count, samples, sample_count, plan->measured_steps, &sums, out );
    }
    return status;
}

wisp_status scenario_run( surface_implementation* implementations, int count, const scenario_plan* plan,
                          const path_record* reference, path_record* record, scenario_stats* out, wisp_error* error )
{
    *out = ( scenario_stats ){ 0 };
    double* samples = malloc( (size_t)count * (size_t)plan->measured_steps * sizeof( double ) );
    wisp_status status = samples ? take_turns( implementations, count, plan, reference, record, samples, out, error )
                                 : wisp_fail( error, WISP_NO_MEMORY, "no memory for the samples" );
    free( samples );
    return status;
}

// ---- results ----

void scenario_check_hashes( const surface_implementation* implementations, int count, const uint64_t* hashes,
                            const char* what, results* out )
{
    for ( int e = 1; e < count; ++e )
    {
        if ( hashes[e] != hashes[0] )
        {
            results_add_failure( out, "%s: %d workers give hash %016llx, %d gives %016llx.", what,
                                 implementations[e].generator.workers, (unsigned long long)hashes[e],
                                 implementations[0].generator.workers, (unsigned long long)hashes[0] );
        }
    }
}

static void put_finite( results_values* values, const char* name, double value )
{
    if ( isfinite( value ) )
    {
        results_put( values, name, value );
    }
}

void scenario_put_times( const scenario_stats* stats, int count, cells* row )
{
    for ( int e = 0; e < count; ++e )
    {
        if ( stats->halted_at > 0 )
        {
            cells_put( row, "halted at step %d", stats->halted_at );
            cells_put( row, "-" );
        }
        else
        {
            cells_put_number( row, stats->ms[e].median, 3 );
            cells_put( row, "%.3f .. %.3f", stats->ms[e].p10, stats->ms[e].p90 );
        }
    }
}

void scenario_add_rows( const surface_implementation* implementations, int count, const scenario_stats* stats,
                        const char* name, const char* variant, const char* reference_name, results* out )
{
    for ( int e = 0; e < count; ++e )
    {
        results_row* row = results_add_row( out, name, variant );
        if ( !row )
        {
            return;
        }
        const surface_generator* generator = &implementations[e].generator;
        results_put( &row->size, "vertices", implementations[e].fabric->vertex_count );
        results_put( &row->size, "links", implementations[e].fabric->link_count );
        results_put( &row->size, "substeps", generator->substeps );
        results_put( &row->size, "iterations", generator->iterations );
        row->workers = generator->workers;
        results_put_times( row, &stats->ms[e] );
        profile_samples profile = implementations[e].profile;
        for ( int i = 0; i < profile.pass_count; ++i )
        {
            results_put( &row->stages, profile.passes[i].name, 1e3 * profile_samples_median( &profile, i ) );
        }
        snprintf( row->error_reference, sizeof( row->error_reference ), "%s", reference_name );
        put_finite( &row->error, "stretch_max", stats->stretch_max );
        put_finite( &row->error, "stretch_mean", stats->stretch_mean );
        put_finite( &row->error, "kinetic_J", stats->kinetic );
        put_finite( &row->error, "energy_lost_fraction", stats->energy_lost );
        put_finite( &row->error, "path_rms_m", stats->path );
        if ( stats->halted_at > 0 )
        {
            results_put( &row->error, "halted_at_step", stats->halted_at );
        }
        row->hash = stats->hash[e];
        row->has_hash = true;
    }
}
