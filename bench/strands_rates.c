// What the rate of steps, the number of vertices and the number of substeps do to the answer.
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

// ---- stretch and energy ----

#define ENERGY_STEPS 60
#define ENERGY_OBSERVATION 5

static const struct
{
    const char* name;
    wisp_strand_stretch stretch;
} energy_solvers[] = {
    { "direct", WISP_STRAND_STRETCH_DIRECT },
    { "links", WISP_STRAND_STRETCH_LINKS },
    { "follow", WISP_STRAND_STRETCH_FOLLOW },
};

static const int energy_substeps[] = { 1, 4, 10, 40 };

typedef struct energy_stats
{
    strands_stretch stretch;
    double error; // share of the length, at the reference's time
    double lost;  // share of the potential energy released in a second that is not there any more
    double rise;  // largest rise of the whole energy above that at the start, share of the released energy
    stats_summary ms;
} energy_stats;

static wisp_status observe( strands_implementation* implementation, energy_stats* f, double* start, double* released,
                            wisp_error* error )
{
    const wisp_vec3* points = NULL;
    wisp_motion_stats motion_stats = { 0 };
    wisp_status status = strands_implementation_points( implementation, &points, error );
    if ( status == WISP_OK )
    {
        status = wisp_read_motion_stats( implementation->world, implementation->entity, &motion_stats );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
    }
    if ( status == WISP_OK )
    {
        strands_stretch stretch = strands_measure_stretch( implementation->generator.shape, points );
        f->stretch.max += stretch.max * ENERGY_OBSERVATION / ENERGY_STEPS;
        f->stretch.mean += stretch.mean * ENERGY_OBSERVATION / ENERGY_STEPS;

        // The strands start at rest at height 0, so all energy is 0 at the start.
        double energy = motion_stats.kinetic_energy + motion_stats.potential_energy;
        *released = -motion_stats.potential_energy;
        *start = fmax( *start, energy );
        f->lost = -energy / *released;
    }
    return status;
}

static wisp_status run_energy( const strands_shape* shape, int solver, int substeps, const wisp_vec3* reference,
                               wisp_vec3* keep, energy_stats* f, wisp_error* error )
{
    const strands_setting setting = { "energy", energy_solvers[solver].stretch, WISP_STRAND_BEND_NONE, 2, substeps };
    strands_generator generator = strands_default_generator( shape );
    generator.dynamics = strands_setting_dynamics( &setting );
    generator.substeps = substeps;
    generator.has_motion_stats = true;
    strands_implementation implementation = { 0 };
    double ms[ENERGY_STEPS], highest = 0.0, released = 0.0;
    wisp_status status = strands_implementation_create( &generator, &implementation, error );
    for ( int s = 1; s <= ENERGY_STEPS && status == WISP_OK; ++s )
    {
        double begin = wisp_clock_seconds();
        status = strands_implementation_step( &implementation, error );
        ms[s - 1] = 1e3 * ( wisp_clock_seconds() - begin );
        const wisp_vec3* points = NULL;
        if ( status == WISP_OK && s == STRANDS_REFERENCE_STEPS )
        {
            status = strands_implementation_points( &implementation, &points, error );
            for ( int i = 0; i < strands_shape_size( shape ) && keep && status == WISP_OK; ++i )
            {
                keep[i] = points[i];
            }
            f->error = status == WISP_OK && reference
                           ? strands_rms_distance( points, reference, strands_shape_size( shape ) ) /
                                 ( (double)STRANDS_SPACING * ( STRANDS_VERTICES - 1 ) )
                           : 0.0;
        }
        if ( status == WISP_OK && s % ENERGY_OBSERVATION == 0 )
        {
            status = observe( &implementation, f, &highest, &released, error );
        }
    }
    f->rise = released > 0.0 ? highest / released : 0.0;
    f->ms = stats_summarise( ms, status == WISP_OK ? ENERGY_STEPS : 0 );
    strands_implementation_destroy( &implementation );
    return status;
}

static void add_energy( int solver, int substeps, const energy_stats* f, int table, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "%s", energy_solvers[solver].name );
    cells_put( &row, "%d", substeps );
    cells_put_number( &row, f->ms.median, 4 );
    cells_put_pair( &row, 100.0 * f->stretch.max, 5, 100.0 * f->stretch.mean, 5 );
    cells_put_number( &row, 100.0 * f->error, 3 );
    cells_put_number( &row, 100.0 * f->lost, 2 );
    cells_put_number( &row, 100.0 * f->rise, 2 );
    cells_end_row( &row, table, out );
    results_row* machine = results_add_row( out, "strands.energy", energy_solvers[solver].name );
    if ( machine )
    {
        results_put( &machine->size, "substeps", substeps );
        machine->workers = 1;
        results_put_times( machine, &f->ms );
        snprintf( machine->error_reference, sizeof( machine->error_reference ), "%d substeps",
                  STRANDS_REFERENCE_SUBSTEPS );
        results_put( &machine->error, "stretch_max", f->stretch.max );
        results_put( &machine->error, "stretch_mean", f->stretch.mean );
        results_put( &machine->error, "rms_share_of_length", f->error );
        results_put( &machine->error, "energy_lost_fraction", f->lost );
        results_put( &machine->error, "energy_risen_fraction", f->rise );
    }
}

wisp_status strands_energy( const strands_plan* plan, results* out, wisp_error* error )
{
    static const char* const header[] = {
        "stretch",       "substeps", "1 worker ms", "stretch max / mean %", "error to reference %",
        "energy lost %", "risen %",
    };
    (void)plan;
    int table = results_add_table( out, "Stretch and energy: chains of 20 vertices fall from the horizontal for 1 s",
                                   WISP_COUNT( header ), header );
    strands_shape shape = { 0 };
    wisp_status status = strands_shape_make_horizontal( STRANDS_REFERENCE_STRANDS, &shape, error );
    wisp_vec3* reference = calloc( (size_t)STRANDS_REFERENCE_STRANDS * STRANDS_VERTICES, sizeof( wisp_vec3 ) );
    energy_stats converged = { .lost = 0.0 };
    status = status == WISP_OK && !reference ? wisp_fail( error, WISP_NO_MEMORY, "no memory for a converged run" )
                                             : status;
    status = status == WISP_OK
                 ? run_energy( &shape, 0, STRANDS_REFERENCE_SUBSTEPS, NULL, reference, &converged, error )
                 : status;
    for ( int solver = 0; solver < WISP_COUNT( energy_solvers ) && status == WISP_OK; ++solver )
    {
        for ( int i = 0; i < WISP_COUNT( energy_substeps ) && status == WISP_OK; ++i )
        {
            energy_stats f = { .lost = 0.0 };
            status = run_energy( &shape, solver, energy_substeps[i], reference, NULL, &f, error );
            if ( status == WISP_OK )
            {
                add_energy( solver, energy_substeps[i], &f, table, out );
            }
        }
    }
    if ( status == WISP_OK )
    {
        results_add_note( out,
                          "Energy: %d chains without bending or damping. Lost potential energy of that released in 1 "
                          "s is the solver's; with %d substeps (the reference, direct) it is %.2f %%. Risen: the "
                          "largest energy above the first.",
                          STRANDS_REFERENCE_STRANDS, STRANDS_REFERENCE_SUBSTEPS, 100.0 * converged.lost );
    }
    free( reference );
    strands_shape_free( &shape );
    return status;
}
