// What the rate of steps and the number of vertices do to the answer.
#include "elastica.h"
#include "strands_bench.h"

#include <math.h>
#include <stdlib.h>

// ---- a hanging hair ----

#define HAIR_LENGTH 0.2 // m
#define HAIR_EARLY 0.2  // s, while it still falls: whole steps at all rates

typedef struct hair_setting
{
    int rate, vertices, substeps; // steps a second
} hair_setting;

// The run that the others are compared with comes first.
static const hair_setting hair_settings[] = {
    { 240, 160, 16 }, { 30, 20, 1 },   { 60, 20, 1 },   { 120, 20, 1 }, { 240, 20, 1 }, { 30, 20, 10 },
    { 60, 20, 10 },   { 120, 20, 10 }, { 240, 20, 10 }, { 60, 10, 10 }, { 60, 40, 10 }, { 60, 80, 10 },
};

typedef struct hair_stats
{
    wisp_vec3 early, rest; // m, of the tip
    double us;             // a step, median
} hair_stats;

static wisp_status run_hair( const strands_plan* plan, const hair_setting* setting, hair_stats* out,
                             wisp_error* error )
{
    strands_shape shape = { 0 };
    strands_implementation implementation = { 0 };
    const wisp_vec3 along = { 1.0f, 0.0f, 0.0f };
    int steps = (int)( plan->settle_seconds * setting->rate ), early = (int)lround( HAIR_EARLY * setting->rate );
    double* us = malloc( (size_t)steps * sizeof( double ) );
    wisp_status status = us ? strands_shape_make_straight( setting->vertices, along, HAIR_LENGTH, &shape, error )
                            : wisp_fail( error, WISP_NO_MEMORY, "no memory for the samples" );
    strands_generator generator = strands_default_generator( &shape );
    generator.dynamics.rest = WISP_STRAND_REST_STRAIGHT;
    generator.dynamics.damping = 3.0f;
    generator.seconds = 1.0f / (float)setting->rate;
    generator.substeps = setting->substeps;
    status = status == WISP_OK ? strands_implementation_create( &generator, &implementation, error ) : status;
    for ( int s = 1; s <= steps && status == WISP_OK; ++s )
    {
        const wisp_vec3* points = NULL;
        double start = wisp_clock_seconds();
        status = strands_implementation_step( &implementation, error );
        us[s - 1] = 1e6 * ( wisp_clock_seconds() - start );
        status = status == WISP_OK ? strands_implementation_points( &implementation, &points, error ) : status;
        if ( status == WISP_OK )
        {
            out->rest = points[setting->vertices - 1];
            out->early = s <= early ? out->rest : out->early;
        }
    }
    out->us = status == WISP_OK ? stats_summarise( us, steps ).median : NAN;
    strands_implementation_destroy( &implementation );
    strands_shape_free( &shape );
    free( us );
    return status;
}

static wisp_vec3 elastica_tip( void )
{
    const wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    double load = (double)def.line_density * STRANDS_GRAVITY * HAIR_LENGTH * HAIR_LENGTH * HAIR_LENGTH /
                  (double)def.bend_rigidity;
    double ends[2][2];
    elastica_lay( load, 2, ends );
    return ( wisp_vec3 ){ (float)( HAIR_LENGTH * ends[1][0] ), (float)( HAIR_LENGTH * ends[1][1] ), 0.0f };
}

static double fraction_of_length( wisp_vec3 a, wisp_vec3 b )
{
    return 100.0 * strands_rms_distance( &a, &b, 1 ) / HAIR_LENGTH;
}

wisp_status strands_independence( const strands_plan* plan, results* out, wisp_error* error )
{
    static const char* const header[] = {
        "steps per second",     "substeps",   "vertices", "tip error at 0.2 s, %", "tip error at rest, %",
        "error to elastica, %", "us per step"
    };
    int table = results_add_table( out, "A clamped hair of 0.2 m: the same answer at any rate and number of vertices",
                                   WISP_COUNT( header ), header );
    const wisp_vec3 closed = elastica_tip();
    hair_stats reference = { .us = 0.0 };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( hair_settings ) && status == WISP_OK; ++i )
    {
        const hair_setting* setting = &hair_settings[i];
        hair_stats f = { .us = 0.0 };
        status = run_hair( plan, setting, &f, error );
        if ( status != WISP_OK )
        {
            break;
        }
        reference = i == 0 ? f : reference;
        double early = fraction_of_length( f.early, reference.early ),
               rest = fraction_of_length( f.rest, reference.rest );
        double off = fraction_of_length( f.rest, closed );
        cells row = { .count = 0 };
        cells_put( &row, "%d", setting->rate );
        cells_put( &row, "%d", setting->substeps );
        cells_put( &row, "%d", setting->vertices );
        cells_put_number( &row, i == 0 ? NAN : early, 3 );
        cells_put_number( &row, i == 0 ? NAN : rest, 3 );
        cells_put_number( &row, off, 3 );
        cells_put_number( &row, f.us, 1 );
        cells_end_row( &row, table, out );
        results_row* machine = results_add_row( out, "strands.rates", "rod" );
        if ( machine )
        {
            results_put( &machine->size, "rate", setting->rate );
            results_put( &machine->size, "substeps", setting->substeps );
            results_put( &machine->size, "vertices", setting->vertices );
            machine->workers = 1;
            machine->ms_median = 1e-3 * f.us;
            snprintf( machine->error_reference, sizeof( machine->error_reference ), "converged run" );
            results_put( &machine->error, "tip_early_percent", early );
            results_put( &machine->error, "tip_rest_percent", rest );
            results_put( &machine->error, "tip_elastica_percent", off );
        }
    }
    results_add_note( out, "Clamped hair: straight without load, clamped horizontally, falls under its weight (G = "
                           "64). The first row is the reference. Distances are in %% of the length." );
    results_add_note( out, "Clamped hair: the elastica is the closed form of the continuous hair, so it shows the "
                           "error of the number of vertices." );
    return status;
}
