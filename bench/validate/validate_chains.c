// A chain that hangs folded, both ends at one height, is let go at one of them.
#include "validate_chains.h"

#include "oracle/chain_theory.h"
#include "validate_bodies.h"
#include "validate_settings.h"

#include <math.h>
#include <string.h>

enum
{
    THEORY_STEPS = 2000, // leave 1e-6 of the time of 65 links
    SWEEPS = 8,
    MAX_STEPS = 960, // twice the fall
};

typedef enum chain_method
{
    DIRECT,
    DIRECT_BDF2,
    LINKS,
} chain_method;

static const char* const names[] = { "direct", "direct bdf2", "links" };

// A chain of 1 m, 1 kg, falls slowly, so that a step of 1/60 s is short beside the time of the last part: what is
// shown has no unit.
static const double GRAVITY = 0.015625, TIME = 8.0, SPEED = 0.125; // m/s^2; sqrt( L / g ), s; sqrt( g L ), m/s
static const double DEPTH = 0.9;

// ---- set-up ----

static wisp_status add_chain( validate_bodies* b, chain_method method, wisp_error* error )
{
    const int links = b->def.cells;
    double start[VALIDATE_MAX_CELLS + 1][2];
    wisp_vec3 points[VALIDATE_MAX_CELLS + 1];
    chain_fold( links, start );
    for ( int i = 0; i <= links; ++i )
    {
        points[i] = ( wisp_vec3 ){ (float)start[i][0], (float)start[i][1], 0.0f };
    }
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.bending = WISP_STRAND_BEND_NONE;
    dynamics.stretch = method == LINKS ? WISP_STRAND_STRETCH_LINKS : WISP_STRAND_STRETCH_DIRECT;
    dynamics.integrator = method == DIRECT_BDF2 ? WISP_INTEGRATOR_BDF2 : WISP_INTEGRATOR_EULER;
    dynamics.line_density = 1.0f;
    dynamics.gravity = ( wisp_vec3 ){ 0.0f, (float)-GRAVITY, 0.0f };
    return validate_add_strands( b, 1, points, &dynamics, error );
}

// The energy that has become neither motion nor height, over the weight of the chain times its length.
static wisp_status read_energy_error( validate_bodies* b, double* out, wisp_error* error )
{
    const int links = b->def.cells;
    double start[VALIDATE_MAX_CELLS + 1][2], before = 0.0;
    wisp_motion_stats stats = { .mass = 0.0 };
    chain_fold( links, start );
    for ( int i = 1; i <= links; ++i )
    {
        before += GRAVITY * start[i][1] * ( i < links ? 1.0 : 0.5 ) / links;
    }
    const wisp_status status = validate_world_motion( &b->world, 0, &stats, error );
    *out = ( stats.kinetic_energy + stats.potential_energy - before ) / GRAVITY;
    return status;
}

// ---- the fall ----

/// Depths of the free end at the last three ends of steps.
typedef struct chain_depths
{
    double depths[3];
    int steps;
} chain_depths;

static void feed( chain_depths* f, double depth )
{
    f->depths[0] = f->depths[1];
    f->depths[1] = f->depths[2];
    f->depths[2] = depth;
    f->steps += 1;
}

// When it was at DEPTH, between the last steps, and how fast.
static chain_fall find( const chain_depths* f )
{
    // the parabola through the three: depth = d2 + b u + a u^2, u in steps before the last one
    const double a = 0.5 * ( f->depths[0] - 2.0 * f->depths[1] + f->depths[2] ),
                 b = 0.5 * ( f->depths[0] - 4.0 * f->depths[1] + 3.0 * f->depths[2] );
    const double rate = sqrt( fmax( b * b - 4.0 * a * ( f->depths[2] - DEPTH ), 0.0 ) );
    const double u = 2.0 * ( DEPTH - f->depths[2] ) / ( b + rate );
    return ( chain_fall ){ .time = ( f->steps + u ) * (double)VALIDATE_STEP / TIME,
                           .speed = rate / (double)VALIDATE_STEP / SPEED };
}

// Step until the free end is deep enough. @param out NaN: it never is
static wisp_status drop( validate_bodies* b, accuracy_run* run, chain_fall* out, wisp_error* error )
{
    chain_depths f = { .steps = 0 };
    wisp_status status = WISP_OK;
    *out = ( chain_fall ){ NAN, NAN, NAN, NAN };
    while ( f.steps < MAX_STEPS && f.depths[2] < DEPTH && status == WISP_OK )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        status = validate_step( b, 1, run, error );
        status = status == WISP_OK ? validate_tip( b, 0, &tip, error ) : status;
        feed( &f, -(double)tip.y );
    }
    if ( f.depths[2] >= DEPTH )
    {
        *out = find( &f );
    }
    return status;
}

static void measure( const validate_bodies* b, const chain_fall* fall, accuracy_run* out )
{
    double start[VALIDATE_MAX_CELLS + 1][2];
    chain_fall exact = { NAN, NAN, NAN, NAN };
    chain_fold( b->def.cells, start );
    chain_fall_of_masses( b->def.cells, (const double( * )[2])start, DEPTH, THEORY_STEPS, &exact );
    const chain_fall limit = chain_fall_continuous( DEPTH );
    out->error = 100.0 * fabs( fall->speed / exact.speed - 1.0 );
    const double measures[] = {
        fall->speed, exact.speed, limit.speed, fall->time, exact.time, limit.time, 100.0 * fall->energy_error
    };
    memcpy( out->measures, measures, sizeof measures );
}

static wisp_status run( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    const validate_setting* way = validate_setting_of( context, setting );
    const validate_def def = {
        .solver = VALIDATE_ROD,
        .cells = way->cells,
        .substeps = way->substeps,
        .iterations = way->solver == LINKS ? SWEEPS : 1,
        .workers = workers,
        .count = 1,
    };
    validate_bodies bodies;
    chain_fall fall;
    wisp_status status = validate_open( &def, &bodies, error );
    status = status == WISP_OK ? add_chain( &bodies, (chain_method)way->solver, error ) : status;
    status = status == WISP_OK && is_observed ? validate_world_watch( &bodies.world, 0, error ) : status;
    status = status == WISP_OK ? drop( &bodies, out, &fall, error ) : status;
    if ( status == WISP_OK && is_observed )
    {
        status = read_energy_error( &bodies, &fall.energy_error, error );
        measure( &bodies, &fall, out );
    }
    status = status == WISP_OK ? validate_finish( &bodies, out, error ) : status;
    validate_release( &bodies );
    return status;
}

wisp_status validate_folded_chain( const bench_options* options, double seconds, accuracy_scene* out,
                                   wisp_error* error )
{
    (void)options;
    (void)seconds;
    static const int methods[] = { DIRECT, DIRECT_BDF2, LINKS }, cells[] = { 9, 17, 33, 65 };
    const validate_grid grid = {
        .names = names,
        .solvers = methods,
        .solver_count = WISP_COUNT( methods ),
        .cells = cells,
        .cell_count = WISP_COUNT( cells ),
        .middle = 33,
        .substeps = 32,
        .halvings = 5,
    };
    const accuracy_scene scene = {
        .reference =
            "a chain of as many masses, integrated in double precision, when its end has fallen 0.9 of its length",
        .error_name = "distance of the speed of the end",
        .error_unit = "%",
        .measure_names = { "speed, sqrt(gL)", "speed of masses", "speed, continuous", "time, sqrt(L/g)",
                           "time of masses", "time, continuous", "energy gained, % of m g L" },
        .measure_count = 7,
        .uncertainty = 0.15, // %, what the parabola leaves: 0.60 in steps of four times the length
        .run = run,
    };
    return validate_make_grid( &grid, scene, out, error );
}
