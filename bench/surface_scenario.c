#include "surface_scenario.h"

#include "cells.h"

#include <math.h>
#include <stdlib.h>

int scenario_path_looks( const scenario_plan* plan )
{
    return plan->warm_steps / plan->turn_steps;
}

wisp_status path_record_create( int vertex_count, int look_count, path_record* out, wisp_error* error )
{
    *out = ( path_record ){ .vertex_count = vertex_count, .look_count = look_count };
    out->points = calloc( (size_t)vertex_count * (size_t)look_count, 3 * sizeof( double ) );
    return out->points ? WISP_OK
                       : wisp_fail( error, WISP_NO_MEMORY, "no memory for the path of %d vertices", vertex_count );
}

void path_record_destroy( path_record* record )
{
    free( record->points );
    *record = ( path_record ){ 0 };
}

// ---- looking ----

typedef struct look_sums
{
    double stretch_max, stretch_mean, kinetic;
    int count;     // of the looks behind these
    double square; // m^2, sum over the looks at the path
    int path_count;
    double energy_lost;
} look_sums;

static double square_distance( const path_record* truth, int number, const wisp_vec3* points )
{
    double sum = 0.0;
    const double* q = truth->points + (size_t)number * (size_t)truth->vertex_count * 3;
    for ( int i = 0; i < truth->vertex_count; ++i, q += 3 )
    {
        double x = (double)points[i].x - q[0], y = (double)points[i].y - q[1], z = (double)points[i].z - q[2];
        sum += x * x + y * y + z * z;
    }
    return sum / truth->vertex_count;
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

static void look( surface_entrant* entrant, look_sums* sums )
{
    surface_look seen = surface_entrant_look( entrant );
    sums->stretch_max += seen.stretch_max;
    sums->stretch_mean += seen.stretch_mean;
    sums->kinetic += seen.kinetic;
    ++sums->count;
}

static wisp_status look_at_path( surface_entrant* entrant, const path_record* truth, path_record* record,
                                 look_sums* sums, wisp_error* error )
{
    const wisp_vec3* points;
    wisp_status status = surface_entrant_points( entrant, &points, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    sums->square += truth ? square_distance( truth, sums->path_count, points ) : NAN;
    if ( record )
    {
        keep_path( record, sums->path_count, points );
    }
    ++sums->path_count;
    return WISP_OK;
}

// ---- running ----

static wisp_status warm_one( surface_entrant* entrant, int steps, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int s = 0; s < steps && status == WISP_OK; ++s )
    {
        status = surface_entrant_step( entrant, error );
    }
    return status;
}

// The first entrant is looked at on its way; the others do the same steps.
static wisp_status warm( surface_entrant* entrants, int count, const scenario_plan* plan, const path_record* truth,
                         path_record* record, look_sums* sums, wisp_error* error )
{
    wisp_status status = WISP_OK;
    int looks = scenario_path_looks( plan );
    for ( int i = 0; i < looks && status == WISP_OK; ++i )
    {
        status = warm_one( &entrants[0], plan->turn_steps, error );
        status = status == WISP_OK ? look_at_path( &entrants[0], truth, record, sums, error ) : status;
    }
    status =
        status == WISP_OK ? warm_one( &entrants[0], plan->warm_steps - looks * plan->turn_steps, error ) : status;
    surface_look seen = surface_entrant_look( &entrants[0] );
    sums->energy_lost = seen.potential < 0.0 ? 1.0 + seen.kinetic / seen.potential : NAN;
    for ( int e = 1; e < count && status == WISP_OK; ++e )
    {
        status = warm_one( &entrants[e], plan->warm_steps, error );
    }
    return status;
}

// @param samples receives the times of the counted steps
static wisp_status take_turn( surface_entrant* entrant, int steps, double* samples, int* sample_count,
                              wisp_error* error )
{
    for ( int s = 0; s < steps; ++s )
    {
        double start = wisp_clock_seconds();
        wisp_status status = surface_entrant_step( entrant, error );
        double ms = 1e3 * ( wisp_clock_seconds() - start );
        if ( status == WISP_OK && ( s > 0 || steps == 1 ) )
        {
            samples[( *sample_count )++] = ms;
            status = surface_entrant_keep_profile( entrant );
        }
        if ( status != WISP_OK )
        {
            return status;
        }
    }
    return WISP_OK;
}

static void conclude( surface_entrant* entrants, int count, double* samples, const int* sample_count, int room,
                      const look_sums* sums, scenario_figures* out )
{
    bool is_halted = out->halted_at > 0;
    for ( int e = 0; e < count; ++e )
    {
        out->ms[e] = stats_summarise( samples + (size_t)e * (size_t)room, is_halted ? 0 : sample_count[e] );
        out->links_ms[e] = is_halted ? NAN : surface_entrant_pass_ms( &entrants[e], "links." );
    }
    out->stretch_max = is_halted ? NAN : sums->stretch_max / sums->count;
    out->stretch_mean = is_halted ? NAN : sums->stretch_mean / sums->count;
    out->kinetic = is_halted ? NAN : sums->kinetic / sums->count;
    out->energy_lost = is_halted ? NAN : sums->energy_lost;
    out->path = is_halted ? NAN : sqrt( sums->square / sums->path_count );
}

static wisp_status take_turns( surface_entrant* entrants, int count, const scenario_plan* plan,
                               const path_record* truth, path_record* record, double* samples, scenario_figures* out,
                               wisp_error* error )
{
    int sample_count[SCENARIO_ENTRANTS_MAX] = { 0 };
    look_sums sums = { 0 };
    wisp_status status = warm( entrants, count, plan, truth, record, &sums, error );
    for ( int turn = 0;
          turn < plan->measured_steps / plan->turn_steps && status == WISP_OK && entrants[0].halted_at == 0; ++turn )
    {
        for ( int e = 0; e < count && status == WISP_OK; ++e )
        {
            double* room = samples + (size_t)e * (size_t)plan->measured_steps;
            status = take_turn( &entrants[e], plan->turn_steps, room, &sample_count[e], error );
        }
        if ( status == WISP_OK && entrants[0].halted_at == 0 )
        {
            look( &entrants[0], &sums );
        }
    }
    for ( int e = 0; e < count && status == WISP_OK; ++e )
    {
        status = surface_entrant_hash( &entrants[e], &out->hash[e], error );
    }
    if ( status == WISP_OK )
    {
        out->halted_at = entrants[0].halted_at;
        conclude( entrants, count, samples, sample_count, plan->measured_steps, &sums, out );
    }
    return status;
}

wisp_status scenario_run( surface_entrant* entrants, int count, const scenario_plan* plan, const path_record* truth,
                          path_record* record, scenario_figures* out, wisp_error* error )
{
    *out = ( scenario_figures ){ 0 };
    double* samples = malloc( (size_t)count * (size_t)plan->measured_steps * sizeof( double ) );
    wisp_status status = samples ? take_turns( entrants, count, plan, truth, record, samples, out, error )
                                 : wisp_fail( error, WISP_NO_MEMORY, "no memory for the samples" );
    free( samples );
    return status;
}

// ---- results ----

void scenario_check_hashes( const surface_entrant* entrants, int count, const uint64_t* hashes, const char* what,
                            results* out )
{
    for ( int e = 1; e < count; ++e )
    {
        if ( hashes[e] != hashes[0] )
        {
            results_add_failure( out, "%s: %d workers give hash %016llx, %d gives %016llx.", what,
                                 entrants[e].recipe.workers, (unsigned long long)hashes[e],
                                 entrants[0].recipe.workers, (unsigned long long)hashes[0] );
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

void scenario_put_times( const scenario_figures* figures, int count, cells* row )
{
    for ( int e = 0; e < count; ++e )
    {
        if ( figures->halted_at > 0 )
        {
            cells_put( row, "halted at step %d", figures->halted_at );
            cells_put( row, "-" );
        }
        else
        {
            cells_put_number( row, figures->ms[e].median, 3 );
            cells_put( row, "%.3f .. %.3f", figures->ms[e].p10, figures->ms[e].p90 );
        }
    }
}

void scenario_add_rows( const surface_entrant* entrants, int count, const scenario_figures* figures, const char* name,
                        const char* variant, const char* truth_name, results* out )
{
    for ( int e = 0; e < count; ++e )
    {
        results_row* row = results_add_row( out, name, variant );
        if ( !row )
        {
            return;
        }
        const surface_recipe* recipe = &entrants[e].recipe;
        results_put( &row->size, "vertices", entrants[e].fabric->vertex_count );
        results_put( &row->size, "links", entrants[e].fabric->link_count );
        results_put( &row->size, "substeps", recipe->substeps );
        results_put( &row->size, "iterations", recipe->iterations );
        row->workers = recipe->workers;
        row->ms_median = figures->ms[e].median;
        row->ms_p10 = figures->ms[e].p10;
        row->ms_p90 = figures->ms[e].p90;
        row->steps = figures->ms[e].count;
        profile_samples profile = entrants[e].profile;
        for ( int i = 0; i < profile.pass_count; ++i )
        {
            results_put( &row->stages, profile.passes[i].name, 1e3 * profile_samples_median( &profile, i ) );
        }
        snprintf( row->error_reference, sizeof( row->error_reference ), "%s", truth_name );
        put_finite( &row->error, "stretch_max", figures->stretch_max );
        put_finite( &row->error, "stretch_mean", figures->stretch_mean );
        put_finite( &row->error, "kinetic_J", figures->kinetic );
        put_finite( &row->error, "energy_lost_share", figures->energy_lost );
        put_finite( &row->error, "path_rms_m", figures->path );
        if ( figures->halted_at > 0 )
        {
            results_put( &row->error, "halted_at_step", figures->halted_at );
        }
        row->hash = figures->hash[e];
        row->has_hash = true;
    }
}
