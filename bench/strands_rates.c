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

typedef struct hair_figures
{
    wisp_vec3 early, rest; // m, of the tip
    double us;             // a step, median
} hair_figures;

static wisp_status run_hair( const strands_plan* plan, const hair_setting* setting, hair_figures* out,
                             wisp_error* error )
{
    strands_shape shape = { 0 };
    strands_entrant entrant = { 0 };
    const wisp_vec3 along = { 1.0f, 0.0f, 0.0f };
    int steps = (int)( plan->settle_seconds * setting->rate ), early = (int)lround( HAIR_EARLY * setting->rate );
    double* us = malloc( (size_t)steps * sizeof( double ) );
    wisp_status status = us ? strands_shape_make_straight( setting->vertices, along, HAIR_LENGTH, &shape, error )
                            : wisp_fail( error, WISP_NO_MEMORY, "no memory for the samples" );
    strands_recipe recipe = strands_default_recipe( &shape );
    recipe.dynamics.rest = WISP_STRAND_REST_STRAIGHT;
    recipe.dynamics.damping = 3.0f;
    recipe.seconds = 1.0f / (float)setting->rate;
    recipe.substeps = setting->substeps;
    status = status == WISP_OK ? strands_entrant_create( &recipe, &entrant, error ) : status;
    for ( int s = 1; s <= steps && status == WISP_OK; ++s )
    {
        const wisp_vec3* points = NULL;
        double start = wisp_clock_seconds();
        status = strands_entrant_step( &entrant, error );
        us[s - 1] = 1e6 * ( wisp_clock_seconds() - start );
        status = status == WISP_OK ? strands_entrant_points( &entrant, &points, error ) : status;
        if ( status == WISP_OK )
        {
            out->rest = points[setting->vertices - 1];
            out->early = s <= early ? out->rest : out->early;
        }
    }
    out->us = status == WISP_OK ? stats_summarise( us, steps ).median : NAN;
    strands_entrant_destroy( &entrant );
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

static double share_of_length( wisp_vec3 a, wisp_vec3 b )
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
    hair_figures truth = { .us = 0.0 };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( hair_settings ) && status == WISP_OK; ++i )
    {
        const hair_setting* setting = &hair_settings[i];
        hair_figures f = { .us = 0.0 };
        status = run_hair( plan, setting, &f, error );
        if ( status != WISP_OK )
        {
            break;
        }
        truth = i == 0 ? f : truth;
        double early = share_of_length( f.early, truth.early ), rest = share_of_length( f.rest, truth.rest );
        double off = share_of_length( f.rest, closed );
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
    results_add_note( out, "The hair is straight without load, clamped horizontally and falls under its weight "
                           "(G = 64). The first row is the converged run that the others are compared with; the "
                           "elastica is the closed form of the continuous hair, so it shows what the number of "
                           "vertices costs. Distances are in %% of the length." );
    return status;
}

// ---- stretch and energy ----

#define ENERGY_STEPS 60
#define ENERGY_LOOK 5

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

typedef struct energy_figures
{
    strands_stretch stretch;
    double error; // share of the length, at the truth's time
    double lost;  // share of the potential energy released in a second that is not there any more
    double rise;  // largest rise of the whole energy above that at the start, share of the released energy
    stats_summary ms;
} energy_figures;

static wisp_status look( strands_entrant* entrant, energy_figures* f, double* start, double* released,
                         wisp_error* error )
{
    const wisp_vec3* points = NULL;
    wisp_quality quality = { 0 };
    wisp_status status = strands_entrant_points( entrant, &points, error );
    if ( status == WISP_OK )
    {
        status = wisp_world_quality( entrant->world, entrant->entity, &quality );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( entrant->world, status, error );
    }
    if ( status == WISP_OK )
    {
        strands_stretch stretch = strands_measure_stretch( entrant->recipe.shape, points );
        f->stretch.max += stretch.max * ENERGY_LOOK / ENERGY_STEPS;
        f->stretch.mean += stretch.mean * ENERGY_LOOK / ENERGY_STEPS;

        // The strands start at rest at height 0, so all energy is 0 at the start.
        double energy = quality.kinetic_energy + quality.potential_energy;
        *released = -quality.potential_energy;
        *start = fmax( *start, energy );
        f->lost = -energy / *released;
    }
    return status;
}

static wisp_status run_energy( const strands_shape* shape, int solver, int substeps, const wisp_vec3* truth,
                               wisp_vec3* keep, energy_figures* f, wisp_error* error )
{
    const strands_setting setting = { "energy", energy_solvers[solver].stretch, WISP_STRAND_BEND_NONE, 2, substeps };
    strands_recipe recipe = strands_default_recipe( shape );
    recipe.dynamics = strands_setting_dynamics( &setting );
    recipe.substeps = substeps;
    recipe.has_quality = true;
    strands_entrant entrant = { 0 };
    double ms[ENERGY_STEPS], highest = 0.0, released = 0.0;
    wisp_status status = strands_entrant_create( &recipe, &entrant, error );
    for ( int s = 1; s <= ENERGY_STEPS && status == WISP_OK; ++s )
    {
        double begin = wisp_clock_seconds();
        status = strands_entrant_step( &entrant, error );
        ms[s - 1] = 1e3 * ( wisp_clock_seconds() - begin );
        const wisp_vec3* points = NULL;
        if ( status == WISP_OK && s == STRANDS_TRUTH_STEPS )
        {
            status = strands_entrant_points( &entrant, &points, error );
            for ( int i = 0; i < strands_shape_size( shape ) && keep && status == WISP_OK; ++i )
            {
                keep[i] = points[i];
            }
            f->error = status == WISP_OK && truth
                           ? strands_rms_distance( points, truth, strands_shape_size( shape ) ) /
                                 ( (double)STRANDS_SPACING * ( STRANDS_VERTICES - 1 ) )
                           : 0.0;
        }
        if ( status == WISP_OK && s % ENERGY_LOOK == 0 )
        {
            status = look( &entrant, f, &highest, &released, error );
        }
    }
    f->rise = released > 0.0 ? highest / released : 0.0;
    f->ms = stats_summarise( ms, status == WISP_OK ? ENERGY_STEPS : 0 );
    strands_entrant_destroy( &entrant );
    return status;
}

static void add_energy( int solver, int substeps, const energy_figures* f, int table, results* out )
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
        machine->ms_median = f->ms.median;
        machine->ms_p10 = f->ms.p10;
        machine->ms_p90 = f->ms.p90;
        machine->steps = f->ms.count;
        snprintf( machine->error_reference, sizeof( machine->error_reference ), "%d substeps",
                  STRANDS_TRUTH_SUBSTEPS );
        results_put( &machine->error, "stretch_max", f->stretch.max );
        results_put( &machine->error, "stretch_mean", f->stretch.mean );
        results_put( &machine->error, "rms_share_of_length", f->error );
        results_put( &machine->error, "energy_lost_share", f->lost );
        results_put( &machine->error, "energy_risen_share", f->rise );
    }
}

wisp_status strands_energy( const strands_plan* plan, results* out, wisp_error* error )
{
    static const char* const header[] = {
        "stretch", "substeps", "1 worker ms", "stretch max / mean %", "error to truth %", "energy lost %", "risen %",
    };
    (void)plan;
    int table = results_add_table( out, "Stretch and energy: chains of 20 vertices fall from the horizontal for 1 s",
                                   WISP_COUNT( header ), header );
    strands_shape shape = { 0 };
    wisp_status status = strands_shape_make_horizontal( STRANDS_TRUTH_STRANDS, &shape, error );
    wisp_vec3* truth = calloc( (size_t)STRANDS_TRUTH_STRANDS * STRANDS_VERTICES, sizeof( wisp_vec3 ) );
    energy_figures converged = { .lost = 0.0 };
    status =
        status == WISP_OK && !truth ? wisp_fail( error, WISP_NO_MEMORY, "no memory for a converged run" ) : status;
    status =
        status == WISP_OK ? run_energy( &shape, 0, STRANDS_TRUTH_SUBSTEPS, NULL, truth, &converged, error ) : status;
    for ( int solver = 0; solver < WISP_COUNT( energy_solvers ) && status == WISP_OK; ++solver )
    {
        for ( int i = 0; i < WISP_COUNT( energy_substeps ) && status == WISP_OK; ++i )
        {
            energy_figures f = { .lost = 0.0 };
            status = run_energy( &shape, solver, energy_substeps[i], truth, NULL, &f, error );
            if ( status == WISP_OK )
            {
                add_energy( solver, energy_substeps[i], &f, table, out );
            }
        }
    }
    if ( status == WISP_OK )
    {
        results_add_note(
            out,
            "Energy: %d chains without bending or damping. What is lost of the potential energy released "
            "in 1 s is the solver's; with %d substeps (the truth, direct) it is %.2f %%. Risen is the "
            "largest energy above that of the start.",
            STRANDS_TRUTH_STRANDS, STRANDS_TRUTH_SUBSTEPS, 100.0 * converged.lost );
    }
    free( truth );
    strands_shape_free( &shape );
    return status;
}
