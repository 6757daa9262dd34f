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
static wisp_status measure_curve( validate_bodies* b, wisp_error* error )
{
    double sum = 0.0;
    for ( int i = 0; i < CURVE_LOADS; ++i )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        double exact[2][2];
        WISP_TRY( validate_tip( b, i, &tip, error ) );
        elastica_lay_loaded( b->def.loads[i], b->def.loads[i] * b->def.tip, 2, exact );
        const double x = (double)tip.x / VALIDATE_LENGTH - exact[1][0],
                     y = (double)tip.y / VALIDATE_LENGTH - exact[1][1];
        b->world.run->measures[i] = 100.0 * hypot( x, y );
        sum += x * x + y * y;
    }
    b->world.run->error = 100.0 * sqrt( sum / CURVE_LOADS );
    return WISP_OK;
}

static wisp_status play_curve( validate_bodies* b, wisp_error* error )
{
    const slender* own = b->own;
    b->def.solver = (validate_solver)b->method;
    b->def.count = CURVE_LOADS;
    b->def.loads = own->loads;
    b->def.tip = own->tip;
    b->def.gravity.y = (float)-VALIDATE_GRAVITY;
    // about critical for the second softest; the time is many times its period
    b->def.damping = 2.0 * frequency_with_tip( own->loads[2], own->tip );
    WISP_TRY( validate_create( b, error ) );
    WISP_TRY( validate_step_for( b, own->seconds, error ) );
    return b->world.is_observed ? measure_curve( b, error ) : WISP_OK;
}

// ---- ladders of loads ----

// The free ends are a little aside. Below the critical load they swing back, above it they go on.
static wisp_status measure_ladder( validate_bodies* b, double critical, wisp_error* error )
{
    bool has_lost[VALIDATE_LADDER];
    for ( int i = 0; i < VALIDATE_LADDER; ++i )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        WISP_TRY( validate_tip( b, i, &tip, error ) );
        has_lost[i] = fabs( (double)tip.y ) > validate_start( &b->def );
    }
    validate_judge_ladder( b, has_lost, VALIDATE_LADDER, critical );
    return WISP_OK;
}

static wisp_status play_ladder( validate_bodies* b, wisp_error* error )
{
    const slender* own = b->own;
    double loads[VALIDATE_LADDER];
    for ( int i = 0; i < VALIDATE_LADDER; ++i )
    {
        loads[i] = own->critical * validate_rung( i, VALIDATE_LADDER );
    }
    const double slow = validate_frequency( own->critical );
    b->def.solver = (validate_solver)b->method;
    b->def.count = VALIDATE_LADDER;
    b->def.loads = loads;
    *( own->is_blade ? &b->def.gravity.z : &b->def.gravity.x ) = (float)-VALIDATE_GRAVITY;
    b->def.damping = 0.5 * slow;
    b->def.lateral = 0.005;
    b->def.is_blade = own->is_blade;
    WISP_TRY( validate_create( b, error ) );
    WISP_TRY( validate_step_for( b, 40.0 / slow, error ) );
    return measure_ladder( b, own->critical, error );
}

// ---- settings ----

static void put_cantilever( accuracy_scene* out )
{
    slender* own = validate_own( out->context );
    *own = ( slender ){ .seconds = 4.0 };
    memcpy( own->loads, CURVE, sizeof CURVE );
}

static void put_tip_load( accuracy_scene* out )
{
    slender* own = validate_own( out->context );
    *own = ( slender ){ .tip = TIP, .seconds = 2.0 };
    for ( int i = 0; i < CURVE_LOADS; ++i )
    {
        own->loads[i] = TIP_CURVE[i] / TIP;
    }
}

static void put_column( accuracy_scene* out )
{
    *(slender*)validate_own( out->context ) = ( slender ){ .critical = slender_column_load() };
}

static void put_blade( accuracy_scene* out )
{
    *(slender*)validate_own( out->context ) = ( slender ){ .critical = slender_blade_load(), .is_blade = true };
}

// Bending of a mesh converges at second order.
#define SLENDER_GRID( which )                                                                                        \
    {                                                                                                                \
        validate_solver_names, which, .cells = { 4, 8, 16, 32 }, .substeps = 32, .middle = 16, .fewer = { 16, 8, 4 } \
    }

const validate_case validate_cantilever = {
    .name = "cantilever",
    .title = "clamped rods and strips bend under their own weight",
    .scene = { .reference = "the heavy elastica; root mean square over four loads, after 4 s",
               .error_name = "distance of the tip from theory",
               .error_unit = "% of L",
               .measure_names = { "G = 1, %", "G = 10, %", "G = 100, %", "G = 1000, %" },
               .measure_count = CURVE_LOADS },
    .grid = SLENDER_GRID( VALIDATE_ALL_SOLVERS ),
    .own_size = sizeof( slender ),
    .put = put_cantilever,
    .play = play_curve,
};

const validate_case validate_tip_load = {
    .name = "tip_load",
    .title = "clamped rods and strips bend under a weight at the free end",
    .scene = { .reference =
                   "the elastica with a weight at its end, and its own; root mean square over four loads, after 2 s",
               .error_name = "distance of the tip from theory",
               .error_unit = "% of L",
               .measure_names = { "P = 0.5, %", "P = 1, %", "P = 3, %", "P = 10, %" },
               .measure_count = CURVE_LOADS },
    .grid = SLENDER_GRID( VALIDATE_ALL_SOLVERS ),
    .own_size = sizeof( slender ),
    .put = put_tip_load,
    .play = play_curve,
};

const validate_case validate_column = {
    .name = "column",
    .title = "upright rods and strips give way under their own weight",
    .scene = { .reference = "G = 7.837: the linear column of Greenhill (1881)",
               .error_name = "distance of the critical load",
               .error_unit = "%",
               .measure_names = { "measured G", "theory G" },
               .measure_count = 2 },
    .rungs = VALIDATE_LADDER,
    .grid = SLENDER_GRID( VALIDATE_ALL_SOLVERS ),
    .own_size = sizeof( slender ),
    .put = put_column,
    .play = play_ladder,
};

const validate_case validate_blade = {
    .name = "blade",
    .title = "level blades on edge turn aside under their own weight",
    .scene = { .reference = "G = 12.85, for GJ = EI: the linear blade of Michell and Prandtl (1899)",
               .error_name = "distance of the critical load",
               .error_unit = "%",
               .measure_names = { "measured G", "theory G" },
               .measure_count = 2 },
    .rungs = VALIDATE_LADDER,
    .grid = SLENDER_GRID( 1 << VALIDATE_ROD ),
    .own_size = sizeof( slender ),
    .put = put_blade,
    .play = play_ladder,
};
