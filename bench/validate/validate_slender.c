// Slender bodies under their own weight: the master curve of a cantilever, and the loads at which a column and a blade give way.
#include "validate/validate.h"

#include "validate/validate_bodies.h"

#include "oracle/slender_theory.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

// ---- the elastica ----

enum
{
    PRIMITIVES = 4000, // at least this many for the whole curve
};

typedef struct elastica_place
{
    double theta, slope, x, y;
} elastica_place;

typedef struct elastica_loads
{
    double weight, tip;
} elastica_loads;

// theta'' of what hangs behind a place
static double turn( const elastica_loads* loads, double s, double theta )
{
    return -( loads->weight * ( 1.0 - s ) + loads->tip ) * cos( theta );
}

// One piece by Runge and Kutta.
static void move_on( const elastica_loads* loads, double s, double h, elastica_place* p )
{
    const double k1 = p->slope, m1 = turn( loads, s, p->theta );
    const double k2 = p->slope + 0.5 * h * m1, m2 = turn( loads, s + 0.5 * h, p->theta + 0.5 * h * k1 );
    const double k3 = p->slope + 0.5 * h * m2, m3 = turn( loads, s + 0.5 * h, p->theta + 0.5 * h * k2 );
    const double k4 = p->slope + h * m3, m4 = turn( loads, s + h, p->theta + h * k3 );
    const double next = p->theta + h / 6.0 * ( k1 + 2.0 * k2 + 2.0 * k3 + k4 ), middle = 0.5 * ( p->theta + next );
    p->x += h * cos( middle );
    p->y -= h * sin( middle ); // theta grows downwards
    p->theta = next;
    p->slope += h / 6.0 * ( m1 + 2.0 * m2 + 2.0 * m3 + m4 );
}

// @param start theta'(0) @return the smallest theta' on the way, which grows with it. Not that at the tip: under a
//        large load a rod that is bent too little swings back, and may end with any slope
static double shoot( const elastica_loads* loads, double start, int count, double ( *points )[2] )
{
    const int each = ( PRIMITIVES + count - 2 ) / ( count - 1 ), primitives = each * ( count - 1 );
    elastica_place p = { .slope = start };
    double least = start;
    points[0][0] = points[0][1] = 0.0;
    for ( int i = 0; i < primitives; ++i )
    {
        move_on( loads, (double)i / primitives, 1.0 / primitives, &p );
        least = fmin( least, p.slope );
        if ( ( i + 1 ) % each == 0 )
        {
            points[( i + 1 ) / each][0] = p.x;
            points[( i + 1 ) / each][1] = p.y;
        }
    }
    return least;
}

void elastica_lay_loaded( double load, double tip, int count, double ( *points )[2] )
{
    const elastica_loads loads = { load, tip };
    // A moment that turned the rod past the vertical would have to be larger than sqrt( 2 ( G + P ) ) allows.
    double lower = 0.0, upper = sqrt( 2.0 * ( load + tip ) );
    for ( int i = 0; i < 100; ++i )
    {
        const double middle = 0.5 * ( lower + upper );
        const bool is_too_much = shoot( &loads, middle, count, points ) > 0.0;
        lower = is_too_much ? lower : middle;
        upper = is_too_much ? middle : upper;
    }
}

// ---- cases ----

enum
{
    CURVE_LOADS = 4,
};

static const double CURVE[CURVE_LOADS] = { 1.0, 10.0, 100.0, 1000.0 };
// P L^2 / EI of weights at the tip, in the weight of the body.
static const double TIP_CURVE[CURVE_LOADS] = { 0.5, 1.0, 3.0, 10.0 }, TIP = 10.0;

typedef struct slender
{
    validate_settings settings;
    double loads[CURVE_LOADS], tip, seconds; // of a curve
    double critical;                         // of a ladder
    bool is_blade;
} slender;

// The slowest frequency with a mass at the tip, by Rayleigh's quotient of its static shape: 3 EI / L^3 over that mass and
// the part of the rod's own that a rod without one has.
static double frequency_with_tip( double load, double tip )
{
    return validate_frequency( load ) / sqrt( 1.0 + 3.516 * 3.516 / 3.0 * tip );
}

// ---- the cantilever ----

// Distances of the tips from theory, in lengths.
static wisp_status measure_curve( validate_bodies* bodies, accuracy_run* out, wisp_error* error )
{
    double sum = 0.0;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < CURVE_LOADS && status == WISP_OK; ++i )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        double exact[2][2];
        status = validate_tip( bodies, i, &tip, error );
        elastica_lay_loaded( bodies->def.loads[i], bodies->def.loads[i] * bodies->def.tip, 2, exact );
        const double x = (double)tip.x / VALIDATE_LENGTH - exact[1][0],
                     y = (double)tip.y / VALIDATE_LENGTH - exact[1][1];
        out->measures[i] = 100.0 * hypot( x, y );
        sum += x * x + y * y;
    }
    out->error = 100.0 * sqrt( sum / CURVE_LOADS );
    return status;
}

static wisp_status run_curve( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                              wisp_error* error )
{
    const slender* own = context;
    const validate_setting* w = validate_setting_of( context, setting );
    // about critical for the second softest; the time is many times its period
    const validate_def def = {
        .solver = (validate_solver)w->solver,
        .cells = w->cells,
        .substeps = w->substeps,
        .workers = workers,
        .count = CURVE_LOADS,
        .loads = own->loads,
        .tip = own->tip,
        .gravity = { 0.0f, (float)-VALIDATE_GRAVITY, 0.0f },
        .damping = 2.0 * frequency_with_tip( own->loads[2], own->tip ),
    };
    validate_bodies bodies;
    wisp_status status = validate_create( &def, &bodies, error );
    status = status == WISP_OK ? validate_step_for( &bodies, own->seconds, out, error ) : status;
    status = status == WISP_OK && is_observed ? measure_curve( &bodies, out, error ) : status;
    return validate_end( status, &bodies, out, error );
}

// ---- ladders of loads ----

// The free ends are a little aside. Below the critical load they swing back, above it they go on.
static wisp_status measure_ladder( validate_bodies* bodies, double critical, accuracy_run* out, wisp_error* error )
{
    bool has_lost[VALIDATE_LADDER] = { false };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < VALIDATE_LADDER && status == WISP_OK; ++i )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        status = validate_tip( bodies, i, &tip, error );
        has_lost[i] = fabs( (double)tip.y ) > validate_start( &bodies->def );
    }
    if ( status == WISP_OK )
    {
        out->error = validate_measure_ladder( has_lost, VALIDATE_LADDER, critical, out->measures );
    }
    return status;
}

static wisp_status run_ladder( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                               wisp_error* error )
{
    const slender* own = context;
    const validate_setting* w = validate_setting_of( context, setting );
    const double g = VALIDATE_GRAVITY;
    double loads[VALIDATE_LADDER];
    for ( int i = 0; i < VALIDATE_LADDER; ++i )
    {
        loads[i] = own->critical * validate_rung( i, VALIDATE_LADDER );
    }
    const double slow = validate_frequency( own->critical );
    validate_def def = {
        .solver = (validate_solver)w->solver,
        .cells = w->cells,
        .substeps = w->substeps,
        .workers = workers,
        .count = VALIDATE_LADDER,
        .loads = loads,
        .gravity = own->is_blade ? ( wisp_vec3 ){ 0.0f, 0.0f, (float)-g } : ( wisp_vec3 ){ (float)-g, 0.0f, 0.0f },
        .damping = 0.5 * slow,
        .lateral = 0.005,
        .is_blade = own->is_blade,
    };
    validate_bodies bodies;
    wisp_status status = validate_create( &def, &bodies, error );
    status = status == WISP_OK ? validate_step_for( &bodies, 40.0 / slow, out, error ) : status;
    status = status == WISP_OK && is_observed ? measure_ladder( &bodies, own->critical, out, error ) : status;
    return validate_end( status, &bodies, out, error );
}

// ---- settings ----

// Bending of a mesh converges at second order.
static wisp_status make_slender( const slender* like, accuracy_scene scene, accuracy_scene* out, wisp_error* error )
{
    static const int solvers[] = { VALIDATE_ROD, VALIDATE_DIHEDRAL, VALIDATE_ISOMETRIC, VALIDATE_IMPLICIT };
    static const int cells[] = { 4, 8, 16, 32 };
    const validate_grid grid = {
        .names = validate_solver_names,
        .solvers = solvers,
        .solver_count = like->is_blade ? 1 : WISP_COUNT( solvers ),
        .cells = cells,
        .cell_count = WISP_COUNT( cells ),
        .substeps = 32,
        .halvings = 3,
        .middle = 16,
    };
    const wisp_status status = validate_make( like, sizeof *like, scene, out, error );
    if ( status == WISP_OK )
    {
        validate_put_grid( out, &grid );
    }
    return status;
}

wisp_status validate_cantilever( const bench_options* options, double seconds, accuracy_scene* out,
                                 wisp_error* error )
{
    (void)options;
    (void)seconds;
    slender like = { .seconds = 4.0, .critical = NAN };
    memcpy( like.loads, CURVE, sizeof CURVE );
    const accuracy_scene scene = {
        .reference = "the heavy elastica; root mean square over four loads, after 4 s",
        .error_name = "distance of the tip from theory",
        .error_unit = "% of L",
        .measure_names = { "G = 1, %", "G = 10, %", "G = 100, %", "G = 1000, %" },
        .measure_count = CURVE_LOADS,
        .run = run_curve,
    };
    return make_slender( &like, scene, out, error );
}

wisp_status validate_tip_load( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)options;
    (void)seconds;
    slender like = { .tip = TIP, .seconds = 2.0, .critical = NAN };
    for ( int i = 0; i < CURVE_LOADS; ++i )
    {
        like.loads[i] = TIP_CURVE[i] / TIP;
    }
    const accuracy_scene scene = {
        .reference =
            "the elastica with a weight at its end, and its own; root mean square over four loads, after 2 s",
        .error_name = "distance of the tip from theory",
        .error_unit = "% of L",
        .measure_names = { "P = 0.5, %", "P = 1, %", "P = 3, %", "P = 10, %" },
        .measure_count = CURVE_LOADS,
        .run = run_curve,
    };
    return make_slender( &like, scene, out, error );
}

static wisp_status make_ladder( double critical, bool is_blade, const char* reference, accuracy_scene* out,
                                wisp_error* error )
{
    const slender like = { .critical = critical, .is_blade = is_blade };
    accuracy_scene scene = {
        .error_name = "distance of the critical load",
        .error_unit = "%",
        .measure_names = { "measured G", "theory G" },
        .measure_count = 2,
        .uncertainty = validate_ladder_doubt( VALIDATE_LADDER ),
        .run = run_ladder,
    };
    snprintf( scene.reference, sizeof scene.reference, "%s", reference );
    return make_slender( &like, scene, out, error );
}

wisp_status validate_column( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)options;
    (void)seconds;
    return make_ladder( slender_column_load(), false, "G = 7.837: the linear column of Greenhill (1881)", out,
                        error );
}

wisp_status validate_blade( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)options;
    (void)seconds;
    return make_ladder( slender_blade_load(), true,
                        "G = 12.85, for GJ = EI: the linear blade of Michell and Prandtl (1899)", out, error );
}
