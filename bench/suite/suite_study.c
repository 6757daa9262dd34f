#include "suite_study.h"

#include "accuracy/scene_tools.h"
#include "suite_motion.h"
#include "suite_sampler.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct study
{
    const wisp_suite* suite;
    suite_reference reference;
    double* dt; // [rows] s
    int* steps; // [rows] that are made
    double longest_dt;
    bool measures[SAMPLE_COUNT]; // a suite has those columns that one of its scenes can have
    char note[480];
} study;

// ---- a sampled run ----

static void keep_measures( const study* own, const suite_sampler* s, const suite_measurement* measured,
                           accuracy_run* out )
{
    double all[SAMPLE_COUNT];
    int count = 0;
    suite_sampler_values( s, measured, all );
    for ( int m = 0; m < SAMPLE_COUNT; ++m )
    {
        if ( own->measures[m] )
        {
            out->measures[count++] = all[m];
        }
    }
    out->hash = measured->hash;
    out->halted_at = measured->values[SUITE_HALTED] > 0.0 ? measured->steps : 0;
}

static wisp_status observe_row( const study* own, int row, accuracy_run* out, wisp_error* error )
{
    const suite_row* r = own->suite->rows + row;
    suite_sampler s = {
        .last_step = own->steps[row],
        .has_contact = own->measures[SAMPLE_CANDIDATES],
        .has_overlap = own->measures[SAMPLE_OVERLAP],
    };
    const suite_observer observer = { suite_sampler_observe, &s, s.has_contact };
    suite_measurement measured;
    const wisp_status status = suite_reference_run( &own->reference, r, NULL, &observer, &measured, error );
    if ( status == WISP_OK )
    {
        keep_measures( own, &s, &measured, out );
        out->error = own->suite->compares_overlap && s.has_overlap ? 1e3 * s.overlap_max : out->error;
        out->error = own->reference.exists && out->halted_at == 0 ? 1e3 * measured.values[SUITE_ERROR] : out->error;
    }
    return status;
}

// ---- a timed run ----

static wisp_status time_steps( const study* own, int row, scene_world* world, int steps, accuracy_run* out,
                               wisp_error* error )
{
    wisp_vec3* points = malloc( ( (size_t)scene_world_vertices( world ) + 1 ) * sizeof *points );
    const double scale = own->longest_dt / own->dt[row];
    wisp_status status = points ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for points" );
    out->hash = SUITE_HASH_BEGIN;
    for ( int step = 0; step < steps && status == WISP_OK; ++step )
    {
        double ms;
        status = suite_time_step( world, &ms, error );
        status = status == WISP_OK ? accuracy_keep_ms( out, scale * ms ) : status;
        status =
            status == WISP_OK ? profile_samples_add( &out->profile, wisp_world_profile( world->world ) ) : status;
        out->hash = status == WISP_OK ? suite_hash_points( world, points, out->hash ) : 0;
    }
    free( points );
    out->work = ( accuracy_work ){
        .vertices = scene_world_vertices( world ),
        .substeps = world->scene->substeps,
        .bytes = (double)scene_world_bytes( world ),
    };
    out->halted_at = wisp_world_counter( world->world, WISP_COUNT_HALTED ) > 0 ? steps : 0;
    return status;
}

static wisp_status time_row( const study* own, int row, int workers, accuracy_run* out, wisp_error* error )
{
    const suite_row* r = own->suite->rows + row;
    const scene_world_options options = { .workers = workers, .is_quiet = true };
    wisp_scene scene;
    scene_world world;
    wisp_status status = suite_scene( r, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    scene_request_points( &scene );
    status = scene_world_create( &scene, &options, &world, error );
    if ( status == WISP_OK )
    {
        status = time_steps( own, row, &world, own->steps[row], out, error );
        scene_world_destroy( &world );
    }
    wisp_scene_release( &scene );
    return status;
}

static wisp_status run( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    return is_observed ? observe_row( context, setting, out, error )
                       : time_row( context, setting, workers, out, error );
}

// ---- settings ----

static void destroy( void* context )
{
    study* own = context;
    suite_reference_release( &own->reference );
    free( own->dt );
    free( own->steps );
    free( own );
}

// Columns that the scene of a row can have.
static wisp_status look_at_row( study* own, int row, wisp_error* error )
{
    wisp_scene scene;
    const wisp_status status = suite_scene( own->suite->rows + row, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const int round = scene.dt_factor_count > 0 ? scene.dt_factor_count : 1;
    own->dt[row] = wisp_scene_step_time( &scene, round ) / round;
    own->longest_dt = fmax( own->longest_dt, own->dt[row] );
    own->steps[row] = own->suite->rows[row].steps > 0 ? own->suite->rows[row].steps : scene.steps;
    suite_samples_of( &scene, own->measures );
    wisp_scene_release( &scene );
    return WISP_OK;
}

// A number that grows with accuracy goes to 0 as its reciprocal.
static double parameter_of( const study* own, int row, char* name, size_t size )
{
    const suite_row* r = own->suite->rows + row;
    const char* dot = strrchr( r->along, '.' );
    const char* field = dot ? dot + 1 : r->along;
    if ( strcmp( r->along, "substeps" ) == 0 )
    {
        snprintf( name, size, "substep, s" );
        return own->dt[row] / r->along_value;
    }
    const bool falls = strcmp( field, "dt" ) == 0 || strstr( field, "spacing" ) || strstr( field, "tolerance" );
    snprintf( name, size, falls ? "%s" : "1 / %s", field );
    return falls ? r->along_value : 1.0 / r->along_value;
}

static void add_setting( const study* own, int row, accuracy_scene* out )
{
    const suite_row* r = own->suite->rows + row;
    char name[SUITE_MAX_NAME + 8];
    accuracy_setting* setting = accuracy_put_setting( out, "%s%s%s", r->name, r->variant[0] ? ", " : "", r->variant );
    if ( r->series[0] != '\0' )
    {
        const double parameter = parameter_of( own, row, name, sizeof name );
        accuracy_join_series( setting, r->series, name, parameter, r->order );
    }
}

// Samples of a comparison that the reference can have, and their doubts.
static void look_at_reference( study* own, double doubts[SAMPLE_COUNT] )
{
    for ( int m = 0; m < SAMPLE_COUNT; ++m )
    {
        doubts[m] = NAN;
    }
    const bool is_motion = own->suite->reference.text || own->suite->stored;
    if ( !is_motion )
    {
        return;
    }
    suite_sampler_comparison( &own->reference.doubt, doubts );
    own->measures[SAMPLE_LARGEST_DISTANCE] = true;
    for ( int i = 0; i < SUITE_MOMENT_COUNT; ++i )
    {
        own->measures[SAMPLE_ERROR_FIRST + i] = isfinite( own->reference.doubt.at[i] );
    }
    own->measures[SAMPLE_DETAIL] = isfinite( own->reference.doubt.detail );
    own->measures[SAMPLE_ENERGY_COMPARED] = isfinite( own->reference.doubt.energy );
    // it is near 1, and no error that could be below a doubt
    doubts[SAMPLE_DETAIL] = NAN;
}

static void describe( study* own, accuracy_scene* out )
{
    double doubts[SAMPLE_COUNT];
    look_at_reference( own, doubts );
    for ( int m = 0; m < SAMPLE_COUNT; ++m )
    {
        if ( own->measures[m] )
        {
            out->measure_doubts[out->measure_count] = isfinite( doubts[m] ) ? fabs( doubts[m] ) : 0.0;
            out->measure_names[out->measure_count++] = suite_sample_names[m];
            out->contact_measures += m >= SAMPLE_CONTACT_FIRST ? 1 : 0;
        }
    }
    bool is_uniform = true;
    for ( int i = 0; i < own->suite->row_count; ++i )
    {
        is_uniform = is_uniform && own->dt[i] == own->longest_dt;
    }
    if ( !is_uniform )
    {
        snprintf( out->ms_name, sizeof out->ms_name, "%.4g s of motion", own->longest_dt );
    }
    out->note = own->suite->note;
    out->has_no_rivals = !own->reference.exists && !own->suite->compares_overlap;
    if ( own->suite->compares_overlap )
    {
        snprintf(
            out->reference, sizeof out->reference,
            "balloons keep their thickness from each other; by signed distances, which contact has no part in" );
        snprintf( out->error_name, sizeof out->error_name, "overlap at most" );
        snprintf( out->error_unit, sizeof out->error_unit, "mm" );
    }
    else if ( own->reference.is_start )
    {
        snprintf( out->reference, sizeof out->reference, "where every vertex starts" );
        snprintf( out->error_name, sizeof out->error_name, "RMS drift from the start" );
        snprintf( out->error_unit, sizeof out->error_unit, "mm" );
    }
    else if ( own->reference.exists )
    {
        snprintf( out->reference, sizeof out->reference, "%s", own->reference.description );
        snprintf( out->error_name, sizeof out->error_name, "RMS distance to the reference" );
        snprintf( out->error_unit, sizeof out->error_unit, "mm" );
        out->uncertainty = 1e3 * own->reference.doubt.distance;
        if ( isfinite( own->reference.parts_at ) )
        {
            const double until = own->reference.motion.times[own->reference.frame_count - 1];
            const bool is_cut = until < own->reference.parts_at;
            snprintf( own->note, sizeof own->note,
                      is_cut ? "motion is compared up to %.3g s. After that two runs that should have converged are "
                               "more than 1 %% of their size apart, and distances are chance. %.200s"
                             : "two runs that should have converged are more than 1 %% of their size apart from %.3g "
                               "s on: the reference is too coarse for errors to say much. %.200s",
                      is_cut ? until : own->reference.parts_at, own->suite->note ? own->suite->note : "" );
            out->note = own->note;
        }
    }
}

static wisp_status fill( study* own, accuracy_scene* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < own->suite->row_count && status == WISP_OK; ++i )
    {
        status = look_at_row( own, i, error );
    }
    status = status == WISP_OK ? suite_reference_make( own->suite, &own->reference, error ) : status;
    for ( int i = 0; i < own->suite->row_count && status == WISP_OK; ++i )
    {
        add_setting( own, i, out );
    }
    describe( own, out );
    return status;
}

wisp_status suite_study_make( const wisp_suite* suite, const bench_options* options, accuracy_scene* out,
                              wisp_error* error )
{
    (void)options;
    study* own = calloc( 1, sizeof *own );
    *out = ( accuracy_scene ){ .context = own, .run = run, .destroy = destroy };
    if ( own == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a suite" );
    }
    own->suite = suite;
    own->dt = calloc( (size_t)suite->row_count, sizeof *own->dt );
    own->steps = calloc( (size_t)suite->row_count, sizeof *own->steps );
    wisp_status status = own->dt && own->steps ? accuracy_reserve_settings( out, suite->row_count, error )
                                               : wisp_fail( error, WISP_NO_MEMORY, "no memory for a suite" );
    status = status == WISP_OK ? fill( own, out, error ) : status;
    return status == WISP_OK ? WISP_OK : accuracy_abandon( out, status );
}
