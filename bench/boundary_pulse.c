// Measure the cost of changing counts: a radius that pulsates, with and without hysteresis.
#include "boundary_bench.h"
#include "bench_timing.h"

#include <math.h>
#include <stdlib.h>

enum
{
    PULSES = 11,
    STILL = 0,
    ALL_RESAMPLED = 1,
    SAMPLES_MAX = 20 * LAYER_PERIOD, // whole periods, so that all phases have equal weight
    ROUNDS_MIN = 4,
};

static const float PULSE_SPACING = 0.05f;

/// The pulsation of a surface, and its results.
typedef struct pulse
{
    double amplitude;
    float hysteresis;
    bool is_resampled;
    layer_implementation implementation;
    double changed, max_changed; // fraction of the elements, mean and maximum of a step
    double kept;                 // fraction of the points that remain from one step to the next
    int min_points, max_points;
    uint64_t hash;
} pulse;

static void make_pulses( pulse all[PULSES] )
{
    static const double amplitudes[] = { 0.001, 0.01, 0.1 };
    static const float hysteresis[] = { 0.0f, 0.1f, 0.3f };
    all[STILL] = ( pulse ){ 0 };
    all[ALL_RESAMPLED] = ( pulse ){ .is_resampled = true };
    for ( int i = 0; i < PULSES - 2; ++i )
    {
        all[2 + i] = ( pulse ){ .amplitude = amplitudes[i / 3], .hysteresis = hysteresis[i % 3] };
    }
}

static wisp_status enter( const boundary_plan* plan, wisp_fabric* fabric, pulse* p, wisp_error* error )
{
    wisp_boundary_def def = layer_def( &layer_laws[0], PULSE_SPACING );
    def.hysteresis = p->hysteresis;
    wisp_status status = layer_enter( fabric, &def, plan->workers[0], &p->implementation, error );
    p->implementation.amplitude = p->amplitude;
    p->implementation.is_resampled = p->is_resampled;
    return status;
}

// ---- changes ----

// Points of elements whose number of points is that of the previous step.
// @param before [elements], receives the present counts
static int count_kept( const wisp_samples* s, int elements, int32_t* before )
{
    int kept = 0;
    for ( int e = 0; e < elements; ++e )
    {
        const int now = s->begin[e + 1] - s->begin[e];
        kept += now == before[e] ? now : 0;
        before[e] = now;
    }
    return kept;
}

static wisp_status count_step( pulse* p, int32_t* before, bool is_first, wisp_error* error )
{
    wisp_boundary_stats stats;
    wisp_boundary_view view;
    wisp_status status = layer_step( &p->implementation, error );
    status = status == WISP_OK ? layer_read_stats( &p->implementation.surface, &stats, error ) : status;
    status = status == WISP_OK ? layer_read( &p->implementation.surface, &view, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    const int kept = count_kept( view.samples, stats.elements, before );
    if ( !is_first )
    {
        const double fraction = (double)stats.changed_elements / stats.elements;
        p->changed += fraction;
        p->max_changed = fmax( p->max_changed, fraction );
        p->kept += p->is_resampled ? 0.0 : (double)kept / stats.points;
        p->min_points = p->min_points == 0 || stats.points < p->min_points ? stats.points : p->min_points;
        p->max_points = stats.points > p->max_points ? stats.points : p->max_points;
    }
    return WISP_OK;
}

static wisp_status count_changes( const boundary_plan* plan, const wisp_fabric* fabric, pulse* p, wisp_error* error )
{
    int32_t* before = calloc( (size_t)( fabric->edge_count + fabric->triangle_count ), sizeof( int32_t ) );
    if ( before == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the counts of a step" );
    }
    // the first step samples everything and does not belong to the pulsation
    wisp_status status = count_step( p, before, true, error );
    for ( int step = 0; step < plan->pulse_steps && status == WISP_OK; ++step )
    {
        status = count_step( p, before, false, error );
    }
    wisp_boundary_view view;
    status = status == WISP_OK ? layer_read( &p->implementation.surface, &view, error ) : status;
    p->hash = status == WISP_OK ? layer_hash( &view ) : 0;
    p->changed /= plan->pulse_steps;
    p->kept /= plan->pulse_steps;
    free( before );
    return status;
}

// ---- cost ----

static wisp_status time_all( const boundary_plan* plan, pulse all[PULSES], wisp_error* error )
{
    bench_variant variants[PULSES] = { { 0 } };
    const bench_effort effort = { plan->pulse_seconds, ROUNDS_MIN, SAMPLES_MAX };
    for ( int i = 0; i < PULSES; ++i )
    {
        variants[i] = ( bench_variant ){
            .name = "pulse", .step = layer_step, .after = layer_keep_profile, .context = &all[i].implementation
        };
    }
    wisp_status status = bench_interleave( variants, PULSES, &effort, error );
    bench_free_samples( variants, PULSES );
    return status;
}

static const char* name_of( const pulse* p )
{
    return p->is_resampled ? "all resampled" : p->amplitude == 0.0 ? "still" : "pulse";
}

static void add_pulse_row( const pulse* p, const stats_summary* ms, int workers, results* out )
{
    results_row* row = results_add_row( out, "boundary", name_of( p ) );
    if ( row != NULL )
    {
        row->workers = workers;
        results_put_times( row, ms );
        row->hash = p->hash;
        row->has_hash = true;
        results_put( &row->size, "amplitude", p->amplitude );
        results_put( &row->size, "hysteresis", (double)p->hysteresis );
        results_put( &row->size, "points", p->max_points );
        results_put( &row->size, "changed_fraction", p->changed );
        results_put( &row->size, "kept_fraction", p->kept );
        results_put( &row->stages, "boundary.points", ms->median );
    }
}

static void add_pulse( pulse* p, const stats_summary times[2], int workers, int table, results* out )
{
    const stats_summary ms = layer_pass_ms( &p->implementation.surface, "boundary.points" );
    cells row = { .count = 0 };
    cells_put( &row, "%s", name_of( p ) );
    cells_put_number( &row, 100.0 * p->amplitude, 1 );
    cells_put_number( &row, (double)p->hysteresis, 1 );
    cells_put( &row, "%d .. %d", p->min_points, p->max_points );
    cells_put_number( &row, 100.0 * p->changed, 2 );
    cells_put_number( &row, 100.0 * p->max_changed, 1 );
    cells_put_number( &row, 100.0 * p->kept, 2 );
    cells_put_number( &row, ms.median, 4 );
    cells_put_number( &row, ms.p90, 4 );
    cells_put_number( &row, ms.median / times[STILL].median, 2 );
    cells_put_number( &row, ms.median / times[ALL_RESAMPLED].median, 2 );
    cells_put_hash( &row, p->hash );
    cells_end_row( &row, table, out );
    add_pulse_row( p, &ms, workers, out );
}

// No element changes on a static surface, all change if requested, and fewer with hysteresis. Without it counts
// follow from positions alone: after whole periods a layer is the same again.
static void check_pulses( const pulse all[PULSES], results* out )
{
    if ( all[STILL].changed != 0.0 || all[ALL_RESAMPLED].changed != 1.0 )
    {
        results_add_failure( out,
                             "Pulsating radius: %g of the elements of a static surface are sampled again, and %g "
                             "where all are requested.",
                             all[STILL].changed, all[ALL_RESAMPLED].changed );
    }
    for ( int i = 2; i < PULSES; ++i )
    {
        const pulse *p = all + i, *without = p - ( i - 2 ) % 3;
        if ( p == without && p->hash != all[STILL].hash )
        {
            results_add_failure(
                out, "Pulsating radius: after whole periods of +- %g %% the layer differs from the first one.",
                100.0 * p->amplitude );
        }
        if ( p->changed > without->changed )
        {
            results_add_failure( out,
                                 "Pulsating radius: at %g %% a hysteresis of %g changes more elements than none.",
                                 100.0 * p->amplitude, (double)p->hysteresis );
        }
    }
}

static void write_pulses( const boundary_plan* plan, pulse all[PULSES], results* out )
{
    static const char* const header[] = { "surface",      "+- %",       "hysteresis",       "points",
                                          "in case B, %", "at most, %", "points kept, %",   "ms",
                                          "p90",          "of still",   "of all resampled", "hash" };
    const int table = results_add_table( out,
                                         "Pulsating radius, 60 steps, d 0.05: elements whose counts change, and time "
                                         "of the pass that makes the points",
                                         WISP_COUNT( header ), header );
    const stats_summary times[2] = { layer_pass_ms( &all[STILL].implementation.surface, "boundary.points" ),
                                     layer_pass_ms( &all[ALL_RESAMPLED].implementation.surface, "boundary.points" ) };
    for ( int i = 0; i < PULSES; ++i )
    {
        add_pulse( all + i, times, plan->workers[0], table, out );
    }
    check_pulses( all, out );
    results_add_note(
        out,
        "Pulsating radius: fractions are of %d steps after the first; hysteresis is in spacings. points kept: of "
        "elements with the same count as a step before. A changed count moves the points of all elements behind it.",
        plan->pulse_steps );
}

wisp_status boundary_pulses( const boundary_plan* plan, results* out, wisp_error* error )
{
    wisp_mesh mesh = { 0 };
    wisp_fabric* fabric = NULL;
    pulse* all = calloc( PULSES, sizeof( pulse ) );
    if ( all == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for pulsating surfaces" );
    }
    make_pulses( all );
    wisp_status status = layer_sphere( LAYER_SEGMENTS, LAYER_RADIUS, &mesh, error );
    status = status == WISP_OK ? layer_cook( &mesh, &fabric, error ) : status;
    for ( int i = 0; i < PULSES && status == WISP_OK; ++i )
    {
        status = enter( plan, fabric, all + i, error );
        status = status == WISP_OK ? count_changes( plan, fabric, all + i, error ) : status;
    }
    status = status == WISP_OK ? time_all( plan, all, error ) : status;
    if ( status == WISP_OK )
    {
        write_pulses( plan, all, out );
    }
    for ( int i = 0; i < PULSES; ++i )
    {
        surface_implementation_destroy( &all[i].implementation.surface );
    }
    free( all );
    wisp_fabric_release( fabric );
    wisp_mesh_release( &mesh );
    return status;
}
