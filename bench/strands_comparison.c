// Ways to solve strands in turns: the same scene, in one run.
#include "strands_comparison.h"

#include "bench_timing.h"

#include <math.h>
#include <stdlib.h>

#define IMPLEMENTATIONS_MAX ( STRANDS_SETTINGS_MAX * STRANDS_WORKERS_MAX )
#define SAMPLES_MAX 200
#define OBSERVATION_STEPS 5

// ---- the reference ----

// The same strands with many substeps, one run for each way to bend.
typedef struct reference
{
    int vertex_count;
    wisp_vec3* points[WISP_STRAND_BEND_COUNT]; // null: not needed
} reference;

static void free_reference( reference* t )
{
    for ( int bend = 0; bend < WISP_STRAND_BEND_COUNT; ++bend )
    {
        free( t->points[bend] );
    }
}

static wisp_status converge( wisp_strand_bend bend, const strands_shape* shape, wisp_vec3** out, wisp_error* error )
{
    const strands_setting setting = { "reference", WISP_STRAND_STRETCH_DIRECT, bend, 2, STRANDS_REFERENCE_SUBSTEPS };
    strands_generator generator = strands_default_generator( shape );
    generator.dynamics = strands_setting_dynamics( &setting );
    generator.substeps = setting.substeps;
    strands_implementation implementation = { 0 };
    const wisp_vec3* points = NULL;
    wisp_status status = strands_implementation_create( &generator, &implementation, error );
    status =
        status == WISP_OK ? strands_implementation_steps( &implementation, STRANDS_REFERENCE_STEPS, error ) : status;
    status = status == WISP_OK ? strands_implementation_points( &implementation, &points, error ) : status;
    if ( status == WISP_OK )
    {
        int count = strands_shape_size( shape );
        *out = malloc( (size_t)count * sizeof( wisp_vec3 ) );
        status = *out ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a converged run" );
        for ( int i = 0; i < count && *out; ++i )
        {
            ( *out )[i] = points[i];
        }
    }
    strands_implementation_destroy( &implementation );
    return status;
}

static wisp_status find_reference( int strand_count, reference* out, wisp_error* error )
{
    strands_shape shape = { 0 };
    wisp_status status = strands_shape_make_horizontal( strand_count, &shape, error );
    for ( int i = 0; i < strands_comparison_setting_count && status == WISP_OK; ++i )
    {
        wisp_strand_bend bend = strands_comparison_settings[i].bend;
        if ( !out->points[bend] )
        {
            status = converge( bend, &shape, &out->points[bend], error );
        }
    }
    out->vertex_count = strand_count * STRANDS_VERTICES;
    strands_shape_free( &shape );
    return status;
}

static double error_to( const reference* t, wisp_strand_bend bend, const wisp_vec3* points, int vertex_count )
{
    int count = vertex_count < t->vertex_count ? vertex_count : t->vertex_count;
    double length = (double)STRANDS_SPACING * ( STRANDS_VERTICES - 1 );
    return strands_rms_distance( points, t->points[bend], count ) / length;
}

// ---- one size ----

typedef struct comparison
{
    strands_shape shape;
    strands_implementation implementations[IMPLEMENTATIONS_MAX]; // [setting][worker]
    bench_variant variants[IMPLEMENTATIONS_MAX];
    int variant_count;
} comparison;

static wisp_status enter( const strands_plan* plan, const strands_comparison_size* size, comparison* r,
                          wisp_error* error )
{
    wisp_status status = strands_shape_make_horizontal( size->strands, &r->shape, error );
    for ( int i = 0; i < size->setting_count * plan->worker_count && status == WISP_OK; ++i )
    {
        const strands_setting* setting = &strands_comparison_settings[i / plan->worker_count];
        strands_generator generator = strands_default_generator( &r->shape );
        generator.dynamics = strands_setting_dynamics( setting );
        generator.substeps = setting->substeps;
        generator.workers = plan->workers[i % plan->worker_count];
        status = strands_implementation_create( &generator, &r->implementations[i], error );
        r->variants[r->variant_count++] = ( bench_variant ){ .name = setting->name,
                                                             .step = strands_implementation_step,
                                                             .after = strands_implementation_keep_profile,
                                                             .context = &r->implementations[i] };
    }
    return status;
}

static void leave( comparison* r )
{
    bench_free_samples( r->variants, r->variant_count );
    for ( int i = 0; i < IMPLEMENTATIONS_MAX; ++i )
    {
        strands_implementation_destroy( &r->implementations[i] );
    }
    strands_shape_free( &r->shape );
}

// ---- the scenario: errors, stretch and hashes ----

static void observe( const strands_shape* shape, const wisp_vec3* points, double observations, strands_line* line )
{
    strands_stretch stretch = strands_measure_stretch( shape, points );
    line->stretch_max += stretch.max / observations;
    line->stretch_mean += stretch.mean / observations;
}

static wisp_status follow( const strands_setting* setting, const reference* t, int steps,
                           strands_implementation* implementation, strands_line* line, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int step = OBSERVATION_STEPS; step <= steps && status == WISP_OK; step += OBSERVATION_STEPS )
    {
        const wisp_vec3* points = NULL;
        status = strands_implementation_steps( implementation, OBSERVATION_STEPS, error );
        status = status == WISP_OK ? strands_implementation_points( implementation, &points, error ) : status;
        if ( status == WISP_OK && line )
        {
            observe( implementation->generator.shape, points, steps / OBSERVATION_STEPS, line );
            if ( step == STRANDS_REFERENCE_STEPS )
            {
                line->error =
                    error_to( t, setting->bend, points, strands_shape_size( implementation->generator.shape ) );
            }
        }
    }
    return status;
}

static wisp_status judge( const strands_plan* plan, const reference* t, comparison* r, strands_comparison_size* size,
                          results* out, wisp_error* error )
{
    int steps = size->strands <= plan->scenario_strands ? plan->scenario_steps : STRANDS_REFERENCE_STEPS;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < size->setting_count * plan->worker_count && status == WISP_OK; ++i )
    {
        int s = i / plan->worker_count;
        bool is_first = i % plan->worker_count == 0;
        const strands_setting* setting = &strands_comparison_settings[s];
        strands_line* line = &size->ours[s];
        uint64_t hash = 0;
        status = follow( setting, t, steps, &r->implementations[i], is_first ? line : NULL, error );
        status = status == WISP_OK ? strands_implementation_hash( &r->implementations[i], &hash, error ) : status;
        line->hash = is_first ? hash : line->hash;
        if ( status == WISP_OK && hash != line->hash )
        {
            results_add_failure( out, "%d strands, %s, %d substeps: %d workers give hash %016llx, %d gives %016llx.",
                                 size->strands, setting->name, setting->substeps,
                                 plan->workers[i % plan->worker_count], (unsigned long long)hash, plan->workers[0],
                                 (unsigned long long)line->hash );
        }
    }
    return status;
}

// ---- times ----

static void keep_kernels( const strands_plan* plan, comparison* r, int setting, strands_kernel_times* out )
{
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        profile_samples* profile = &r->implementations[setting * plan->worker_count + w].profile;
        out->pass_count =
            profile->pass_count < WISP_COUNT( out->passes ) ? profile->pass_count : WISP_COUNT( out->passes );
        for ( int i = 0; i < out->pass_count; ++i )
        {
            snprintf( out->passes[i].name, sizeof( out->passes[i].name ), "%s", profile->passes[i].name );
            out->passes[i].seconds[w] = profile_samples_median( profile, i );
        }
    }
}

static void conclude( const strands_plan* plan, comparison* r, strands_comparison_size* size, results* out )
{
    for ( int i = 0; i < size->setting_count * plan->worker_count; ++i )
    {
        bench_variant* variant = &r->variants[i];
        strands_line* line = &size->ours[i / plan->worker_count];
        line->ms[i % plan->worker_count] = bench_summarise( variant );
        line->laid = wisp_world_counter( r->implementations[i].world, WISP_COUNT_STRAND_RESET );
        if ( r->implementations[i].halted_at > 0 )
        {
            line->halted_at = r->implementations[i].halted_at;
            results_add_failure( out, "%d strands, %s: halted at step %d.", size->strands, variant->name,
                                 line->halted_at );
        }
    }
    for ( int s = 0; s < size->setting_count; ++s )
    {
        keep_kernels( plan, r, s, &size->kernels[s] );
    }
}

static wisp_status run_size( const strands_plan* plan, const reference* t, double seconds,
                             strands_comparison_size* size, results* out, wisp_error* error )
{
    comparison* r = calloc( 1, sizeof( comparison ) );
    if ( !r )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the race" );
    }
    wisp_status status = enter( plan, size, r, error );
    status = status == WISP_OK ? judge( plan, t, r, size, out, error ) : status;
    const bench_effort effort = { .seconds = seconds, .rounds_min = 2, .samples_max = SAMPLES_MAX };
    status = status == WISP_OK ? bench_interleave( r->variants, r->variant_count, &effort, error ) : status;
    if ( status == WISP_OK )
    {
        conclude( plan, r, size, out );
    }
    leave( r );
    free( r );
    return status;
}

wisp_status strands_comparison( const strands_plan* plan, results* out, wisp_error* error )
{
    strands_comparison_size* sizes = calloc( STRANDS_SIZES_MAX, sizeof( strands_comparison_size ) );
    reference t = { 0 };
    wisp_status status = sizes ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for the race" );
    status = status == WISP_OK ? find_reference( STRANDS_REFERENCE_STRANDS, &t, error ) : status;
    double deadline = wisp_clock_seconds() + plan->comparison_seconds;
    for ( int i = 0; i < plan->size_count && status == WISP_OK; ++i )
    {
        strands_comparison_size* size = &sizes[i];
        size->strands = plan->sizes[i];
        size->setting_count =
            size->strands <= plan->few_settings_strands ? strands_comparison_setting_count : plan->few_settings;
        bench_progress( plan->options, 0.1 * i, "strands by size" );
        double left = fmax( deadline - wisp_clock_seconds(), 0.0 ) / ( plan->size_count - i );
        status = run_size( plan, &t, left, size, out, error );
    }
    if ( status == WISP_OK )
    {
        strands_comparison_write( plan, sizes, plan->size_count, out );
    }
    free_reference( &t );
    free( sizes );
    return status;
}
