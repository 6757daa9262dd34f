// Cusick's test: round specimens of named fabrics between two discs, each fabric on two meshes, all in one world.
#include "validate_drape.h"

#include "oracle/sheet_theory.h"
#include "validate_disc.h"
#include "validate_settings.h"
#include "validate_sheets.h"

#include <math.h>

enum
{
    MESHES = 2,
    MAX_PINS = 256,
    STEPS = 120,
    LAST_STEPS = 30, // over which the change that is left is measured
};

static const double PI = 3.14159265358979323846;
// A little above critical for the softest fabric, 1/s: with half of it folds still swing after 2 s.
static const double DAMPING = 12.0;
// Of the membrane, N/m: the weight strains it by less than 0.1 %.
static const double STIFFNESS = 100.0;
static const double TURNS[MESHES] = { 1.0, 2.0 };

const drape_fabric drape_fabrics[DRAPE_FABRICS] = {
    { "polyester faille", 0.019, 10.43, 28.3 },
    { "wool tropical", 0.067, 16.29, 49.8 },
    { "polyester tropical", 0.077, 11.65, 50.7 },
    { "cotton broad", 0.118, 12.38, 82.9 },
};

double drape_rigidity( const drape_fabric* fabric )
{
    return 9.80665e-5 * fabric->bending; // gf cm
}

double drape_density( const drape_fabric* fabric )
{
    return 0.01 * fabric->weight; // mg / cm^2
}

// ---- a run ----

typedef struct drape_run
{
    validate_world world; // fabric f on mesh m is body m DRAPE_FABRICS + f
    wisp_mesh meshes[MESHES];
    sheet_solver solver;
} drape_run;

static wisp_status lay_fabrics( drape_run* run, int mesh, int pin_count, bool is_observed, wisp_error* error )
{
    int32_t pins[MAX_PINS];
    WISP_ASSERT( pin_count <= MAX_PINS );
    for ( int i = 0; i < pin_count; ++i )
    {
        pins[i] = i;
    }
    wisp_status status = WISP_OK;
    for ( int f = 0; f < DRAPE_FABRICS && status == WISP_OK; ++f )
    {
        const sheet_def def = {
            .solver = run->solver,
            .mesh = run->meshes + mesh,
            .pins = pins,
            .pin_count = pin_count,
            .density = drape_density( drape_fabrics + f ),
            .rigidity = drape_rigidity( drape_fabrics + f ),
            .stiffness = STIFFNESS,
            .damping = DAMPING,
            .gravity = { 0.0f, (float)-SHEET_GRAVITY, 0.0f },
            .friction = -1.0,
        };
        status = sheet_add( &run->world, &def, is_observed, error );
    }
    return status;
}

static wisp_status lay_down( drape_run* run, int cells, bool is_observed, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int m = 0; m < MESHES && status == WISP_OK; ++m )
    {
        int pin_count = 0;
        status = disc_mesh( DRAPE_DISC, DRAPE_CLOTH, cells, TURNS[m], run->meshes + m, &pin_count, error );
        status = status == WISP_OK ? lay_fabrics( run, m, pin_count, is_observed, error ) : status;
    }
    return status;
}

// Drape coefficients of all bodies, in %.
static wisp_status read_drapes( drape_run* run, double out[MESHES * DRAPE_FABRICS], wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < MESHES * DRAPE_FABRICS && status == WISP_OK; ++i )
    {
        const wisp_vec3* points = NULL;
        status = validate_world_points( &run->world, i, &points, error );
        if ( status == WISP_OK )
        {
            const double shadow = disc_shadow( run->meshes + i / DRAPE_FABRICS, points, DRAPE_DISC, DRAPE_CLOTH );
            status = shadow >= 0.0 ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a shadow" );
            out[i] = 100.0 * shadow / ( PI * ( DRAPE_CLOTH * DRAPE_CLOTH - DRAPE_DISC * DRAPE_DISC ) );
        }
    }
    return status;
}

// How far a value is from an interval.
static double outside( double value, double lower, double upper )
{
    return fmax( 0.0, fmax( lower - value, value - upper ) );
}

// How far a coefficient is from those that the regression has for fabrics of this bending length, whatever their shear.
static double outside_cusick( const drape_fabric* fabric, double drape )
{
    const double c =
        100.0 * sheet_bending_length( drape_rigidity( fabric ), drape_density( fabric ) * SHEET_GRAVITY );
    return outside( drape, sheet_cusick( c, sheet_cusick_softest() ), sheet_cusick( c, 0.0 ) );
}

enum
{
    SPREAD = DRAPE_FABRICS,
    LEFT,
    CUSICK,
    MEASURES,
};

static void compare( const double* before, const double* after, accuracy_run* out )
{
    double sum = 0.0;
    out->measures[SPREAD] = out->measures[LEFT] = out->measures[CUSICK] = 0.0;
    for ( int f = 0; f < DRAPE_FABRICS; ++f )
    {
        const drape_fabric* fabric = drape_fabrics + f;
        const double other = after[f + DRAPE_FABRICS], mean = 0.5 * ( after[f] + other );
        const double wrong = outside( mean, fabric->drape - DRAPE_SCATTER, fabric->drape + DRAPE_SCATTER );
        const double left = fmax( fabs( after[f] - before[f] ), fabs( other - before[f + DRAPE_FABRICS] ) );
        sum += wrong * wrong;
        out->measures[f] = mean;
        out->measures[SPREAD] = fmax( out->measures[SPREAD], fabs( after[f] - other ) );
        out->measures[LEFT] = fmax( out->measures[LEFT], left / ( LAST_STEPS * (double)VALIDATE_STEP ) );
        out->measures[CUSICK] = fmax( out->measures[CUSICK], outside_cusick( fabric, mean ) );
    }
    out->error = sqrt( sum / DRAPE_FABRICS );
}

static wisp_status drape( drape_run* run, int cells, bool is_observed, accuracy_run* out, wisp_error* error )
{
    double before[MESHES * DRAPE_FABRICS], after[MESHES * DRAPE_FABRICS];
    wisp_status status = lay_down( run, cells, is_observed, error );
    status = status == WISP_OK ? validate_world_step( &run->world, STEPS - LAST_STEPS, out, error ) : status;
    status = status == WISP_OK && is_observed ? read_drapes( run, before, error ) : status;
    status = status == WISP_OK ? validate_world_step( &run->world, LAST_STEPS, out, error ) : status;
    status = status == WISP_OK && is_observed ? read_drapes( run, after, error ) : status;
    if ( status == WISP_OK && is_observed )
    {
        compare( before, after, out );
    }
    return status == WISP_OK ? validate_world_finish( &run->world, out, error ) : status;
}

static wisp_status run_drape( void* context, int index, int workers, bool is_observed, accuracy_run* out,
                              wisp_error* error )
{
    const validate_setting* setting = validate_setting_of( context, index );
    drape_run run = { .solver = (sheet_solver)setting->solver };
    wisp_status status = sheet_world_create( run.solver, setting->substeps, workers, false, &run.world, error );
    status = status == WISP_OK ? drape( &run, setting->cells, is_observed, out, error ) : status;
    validate_world_release( &run.world );
    for ( int m = 0; m < MESHES; ++m )
    {
        wisp_mesh_release( run.meshes + m );
    }
    return status;
}

// Implicit cloth, which is the slowest by far and needs the fewest substeps, has less of both. A quick run has coarse meshes alone.
static void put_settings( accuracy_scene* out, bool is_quick )
{
    static const int quick[] = { 3, 4 }, cells[] = { 4, 6, 8 }, substeps[] = { 2, 4, 8 };
    static const int solvers[] = { SHEET_DIHEDRAL, SHEET_ISOMETRIC, SHEET_IMPLICIT };
    for ( int s = 0; s < WISP_COUNT( solvers ); ++s )
    {
        const char *name = sheet_solver_names[solvers[s]], *cell = "cell / overhang";
        const int fewer = solvers[s] == SHEET_IMPLICIT ? 1 : 0;
        if ( is_quick )
        {
            validate_put_cells( out, solvers[s], name, cell, quick, WISP_COUNT( quick ), 8 );
            continue;
        }
        validate_put_cells( out, solvers[s], name, cell, cells, WISP_COUNT( cells ) - fewer, fewer ? 8 : 16 );
        validate_put_substeps( out, solvers[s], name, 4, substeps, WISP_COUNT( substeps ) - fewer );
    }
}

wisp_status validate_drape( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)seconds;
    const validate_settings like = { .list = { { 0 } } };
    const accuracy_scene scene = {
        .reference = "measured coefficients of four fabrics, +- 5 points; root mean square, after 2 s",
        .error_name = "distance of the drape from its band",
        .error_unit = "points",
        .measure_names = { "faille, %", "wool, %", "polyester, %", "cotton, %", "spread of two meshes",
                           "change per s", "outside Cusick's law" },
        .measure_count = MEASURES,
        .run = run_drape,
    };
    const wisp_status status = validate_make( &like, sizeof like, scene, out, error );
    if ( status == WISP_OK )
    {
        put_settings( out, options->quick );
    }
    return status;
}
