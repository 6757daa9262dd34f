// Chains: strands without bending.
#include "validate/validate.h"

#include "accuracy/scene_tools.h"
#include "strands_scene.h"
#include "validate/validate_bodies.h"

#include "oracle/chain_theory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- chains that swing ----

// Chains that hang and swing with small amplitude: their two slowest modes against closed forms, by substeps, sweeps
// and vertices.

#define CHAIN_LENGTH 0.2      // m, as long as a hair
#define CHAIN_AMPLITUDE 0.002 // of the length, at the tip: small enough for the periods of small swings
#define CHAIN_VERTICES_MAX 65
#define LAGUERRE_LINKS 10
#define FEW_CHAINS 64 // half of them in each mode
#define MANY_CHAINS 256
#define FULL_SECONDS 15.0

// Periods over sqrt( L/g ): of ten equal masses by the roots of a Laguerre polynomial, and of their limit by the
// zeros of J0.
static const double laguerre_period[] = { 5.352609, 2.326381 };
static const double continuous_period[] = { 5.2254811, 2.2764842 };

typedef struct chain_way
{
    wisp_strand_stretch stretch;
    int links, sweeps, substeps;
    bool is_continuous; // of uniform mass, against the continuous chain; otherwise of equal masses
} chain_way;

typedef struct chains
{
    int count;
    chain_way ways[VALIDATE_MAX_SETTINGS];
} chains;

// ---- shapes ----

static double mass_of( const chain_way* way, int vertex )
{
    return way->is_continuous && vertex == way->links ? 0.5 : 1.0;
}

// The remainder of u without its component along the mode.
static void take_away( const chain_way* way, const double* mode, double* u )
{
    double shared = 0.0, norm = 0.0;
    for ( int v = 1; v <= way->links; ++v )
    {
        shared += mass_of( way, v ) * mode[v] * u[v];
        norm += mass_of( way, v ) * mode[v] * mode[v];
    }
    for ( int v = 1; v <= way->links; ++v )
    {
        u[v] -= shared / norm * mode[v];
    }
}

// The shape of the slowest mode, or of the next one, by inverse iteration: the forces m u are solved for a shape,
// with the weight below each link as its tension. The tip is displaced by 1.
static void find_mode( const chain_way* way, const double* slower, double* u )
{
    for ( int v = 0; v <= way->links; ++v )
    {
        u[v] = v * ( v - 0.6 * way->links ); // contains both modes
    }
    for ( int iteration = 0; iteration < 80; ++iteration )
    {
        double slope[CHAIN_VERTICES_MAX], forces = 0.0, weight = 0.0, aside = 0.0;
        for ( int v = way->links; v > 0; --v )
        {
            forces += mass_of( way, v ) * u[v];
            weight += mass_of( way, v );
            slope[v] = forces / weight;
        }
        for ( int v = 1; v <= way->links; ++v )
        {
            aside += slope[v];
            u[v] = aside;
        }
        if ( slower )
        {
            take_away( way, slower, u );
        }
        const double tip = u[way->links];
        for ( int v = 1; v <= way->links; ++v )
        {
            u[v] /= tip;
        }
    }
}

// One chain in the shape of a mode, in its own vertical plane.
static void lay_chain( const double* mode, int links, double plane, wisp_vec3* points )
{
    const double link = CHAIN_LENGTH / links;
    double aside = 0.0, y = 0.0;
    points[0] = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    for ( int v = 1; v <= links; ++v )
    {
        const double next = CHAIN_AMPLITUDE * CHAIN_LENGTH * mode[v];
        y -= sqrt( link * link - ( next - aside ) * ( next - aside ) );
        aside = next;
        points[v] = ( wisp_vec3 ){ (float)( aside * cos( plane ) ), (float)y, (float)( aside * sin( plane ) ) };
    }
}

static double plane_of( int chain )
{
    return 2.399963229728653 * chain; // multiples of the golden angle never repeat
}

// Even ones swing in the slowest mode, odd ones in the next.
static wisp_status make_chains( const chains* all, const chain_way* way, strands_shape* out, wisp_error* error )
{
    double modes[2][CHAIN_VERTICES_MAX];
    const wisp_status status = strands_shape_create( all->count, way->links + 1, out, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    find_mode( way, NULL, modes[0] );
    find_mode( way, modes[0], modes[1] );
    for ( int c = 0; c < all->count; ++c )
    {
        lay_chain( modes[c % 2], way->links, plane_of( c ), out->points + (size_t)c * (size_t)( way->links + 1 ) );
    }
    return WISP_OK;
}

// ---- periods ----

#define SWING_STEPS 80 // of 1/60 s: a period and three quarters of the slowest mode

/// Displacement of the tips of a mode, step by step: the mean over its chains, each along its own plane.
typedef struct swing
{
    double aside[2][SWING_STEPS + 1];
} swing;

static void keep_tips( const strands_shape* shape, const wisp_vec3* points, int step, swing* out )
{
    out->aside[0][step] = out->aside[1][step] = 0.0;
    for ( int c = 0; c < shape->strand_count; ++c )
    {
        const wisp_vec3 tip = points[( c + 1 ) * shape->vertices - 1];
        out->aside[c % 2][step] += ( (double)tip.x * cos( plane_of( c ) ) + (double)tip.z * sin( plane_of( c ) ) ) /
                                   ( 0.5 * shape->strand_count );
    }
}

// The cubic through y[-1], y[0], y[1], y[2] at t in [0, 1].
static double cubic( const double* y, double t )
{
    return -y[-1] * t * ( t - 1.0 ) * ( t - 2.0 ) / 6.0 + y[0] * ( t + 1.0 ) * ( t - 1.0 ) * ( t - 2.0 ) / 2.0 -
           y[1] * ( t + 1.0 ) * t * ( t - 2.0 ) / 2.0 + y[2] * ( t + 1.0 ) * t * ( t - 1.0 ) / 6.0;
}

// Zero of that cubic between y[0] and y[1], by bisection: a straight line is too coarse for steps of 1/60 s.
static double zero_between( const double* y )
{
    double lower = 0.0, upper = 1.0;
    for ( int i = 0; i < 40; ++i )
    {
        const double middle = 0.5 * ( lower + upper );
        const bool is_before = ( cubic( y, middle ) < 0.0 ) == ( y[0] < 0.0 );
        lower = is_before ? middle : lower;
        upper = is_before ? upper : middle;
    }
    return 0.5 * ( lower + upper );
}

// From the first passage through the middle to the next one in the same direction. @return s; NaN if there is none
static double period_of( const double* aside )
{
    double times[3];
    int count = 0;
    for ( int s = 1; s + 2 <= SWING_STEPS && count < 3; ++s )
    {
        if ( ( aside[s] < 0.0 ) != ( aside[s + 1] < 0.0 ) )
        {
            times[count++] = (double)STRANDS_STEP * ( s + zero_between( aside + s ) );
        }
    }
    return count == 3 ? times[2] - times[0] : NAN;
}

// Loss of amplitude of the slowest mode after one period: compares its largest value in the last two thirds with the
// start.
static double amplitude_lost( const double* aside )
{
    double most = 0.0;
    for ( int s = SWING_STEPS / 3; s <= SWING_STEPS; ++s )
    {
        most = fmax( most, aside[s] );
    }
    return 1.0 - most / ( CHAIN_AMPLITUDE * CHAIN_LENGTH );
}

// ---- a run ----

enum
{
    SECOND_PERIOD,
    AMPLITUDE_LOST,
    STRETCH_MAX,
    CHAIN_MEASURES,
};

static strands_generator make_generator( const chain_way* way, const strands_shape* shape, int workers )
{
    strands_generator generator = strands_default_generator( shape );
    generator.dynamics.stretch = way->stretch;
    generator.dynamics.bending = WISP_STRAND_BEND_NONE;
    generator.dynamics.rest = WISP_STRAND_REST_STRAIGHT;
    generator.dynamics.clamped = false;
    generator.dynamics.vertex_mass = way->is_continuous ? 0.0f : 1.0f;
    generator.substeps = way->substeps;
    generator.iterations = way->sweeps;
    generator.workers = workers;
    return generator;
}

static void judge_swing( const chain_way* way, const swing* seen, accuracy_run* out )
{
    const double* reference = way->is_continuous ? continuous_period : laguerre_period;
    const double unit = sqrt( CHAIN_LENGTH / STRANDS_GRAVITY );
    out->error = 100.0 * fabs( period_of( seen->aside[0] ) / ( unit * reference[0] ) - 1.0 );
    out->measures[SECOND_PERIOD] = 100.0 * fabs( period_of( seen->aside[1] ) / ( unit * reference[1] ) - 1.0 );
    out->measures[AMPLITUDE_LOST] = 100.0 * amplitude_lost( seen->aside[0] );
}

static wisp_status observe_chains( strands_implementation* implementation, swing* seen, accuracy_run* out,
                                   wisp_error* error )
{
    const wisp_vec3* points = NULL;
    const wisp_status status = strands_implementation_points( implementation, &points, error );
    if ( status == WISP_OK )
    {
        const double stretch = strands_measure_stretch( implementation->generator.shape, points );
        keep_tips( implementation->generator.shape, points, implementation->steps, seen );
        out->measures[STRETCH_MAX] = fmax( out->measures[STRETCH_MAX], 100.0 * stretch );
    }
    return status;
}

static wisp_status run_chains( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                               wisp_error* error )
{
    const chains* all = validate_own( context );
    const chain_way* way = &all->ways[setting];
    strands_shape shape = { 0 };
    strands_implementation implementation = { 0 };
    swing seen;
    wisp_status status = make_chains( all, way, &shape, error );
    const strands_generator generator = make_generator( way, &shape, workers );
    status = status == WISP_OK ? strands_implementation_create( &generator, &implementation, error ) : status;
    if ( status == WISP_OK && is_observed )
    {
        out->measures[STRETCH_MAX] = 0.0;
        keep_tips( &shape, shape.points, 0, &seen );
    }
    for ( int s = 1; s <= SWING_STEPS && status == WISP_OK; ++s )
    {
        status = accuracy_time_step( strands_implementation_step, &implementation, out, error );
        status = status == WISP_OK && is_observed ? observe_chains( &implementation, &seen, out, error ) : status;
    }
    status = status == WISP_OK ? strands_implementation_hash( &implementation, &out->hash, error ) : status;
    out->halted_at = implementation.halted_at;
    if ( status == WISP_OK && is_observed )
    {
        judge_swing( way, &seen, out );
    }
    strands_implementation_destroy( &implementation );
    strands_shape_free( &shape );
    return status;
}

// ---- settings ----

static accuracy_setting* put_way( accuracy_scene* scene, const char* name, chain_way way )
{
    chains* all = validate_own( scene->context );
    all->ways[scene->setting_count] = way;
    return accuracy_put_setting( scene, "%s, %d links, %d substeps", name, way.links, way.substeps );
}

static void put_chain_substeps( accuracy_scene* scene, const char* name, wisp_strand_stretch stretch )
{
    static const int tried[] = { 1, 2, 4, 10, 20, 40 };

    // One sweep of one substep stretches the chain threefold, so it does not swing.
    for ( int i = stretch == WISP_STRAND_STRETCH_LINKS ? 1 : 0; i < WISP_COUNT( tried ); ++i )
    {
        const chain_way way = { .stretch = stretch, .links = LAGUERRE_LINKS, .sweeps = 1, .substeps = tried[i] };
        accuracy_join_series( put_way( scene, name, way ), name, "substep, s", (double)STRANDS_STEP / tried[i], 2.0 );
    }
}

static void put_sweeps( accuracy_scene* scene )
{
    for ( int sweeps = 2; sweeps <= 32; sweeps *= 2 )
    {
        const chain_way way = {
            .stretch = WISP_STRAND_STRETCH_LINKS, .links = LAGUERRE_LINKS, .sweeps = sweeps, .substeps = 4
        };
        char name[32];
        snprintf( name, sizeof( name ), "xpbd, %d sweeps", sweeps );
        accuracy_join_series( put_way( scene, name, way ), "xpbd, 4 substeps", "1 / sweeps", 1.0 / sweeps, NAN );
    }
}

// The order of the discrete Laplacian; at this number of substeps the other error is small.
static void put_vertices( accuracy_scene* scene )
{
    static const int tried[] = { 4, 8, 16, 32, 64 };
    for ( int i = 0; i < WISP_COUNT( tried ); ++i )
    {
        const chain_way way = { .stretch = WISP_STRAND_STRETCH_DIRECT,
                                .links = tried[i],
                                .sweeps = 1,
                                .substeps = 40,
                                .is_continuous = true };
        accuracy_join_series( put_way( scene, "vertices", way ), "vertices", "segment, m", CHAIN_LENGTH / tried[i],
                              2.0 );
    }
}

static void put_chains( accuracy_scene* out )
{
    chains* all = validate_own( out->context );
    all->count = ( (const validate_settings*)out->context )->seconds < FULL_SECONDS ? FEW_CHAINS : MANY_CHAINS;
    put_chain_substeps( out, "direct", WISP_STRAND_STRETCH_DIRECT );
    put_chain_substeps( out, "xpbd, 1 sweep", WISP_STRAND_STRETCH_LINKS );
    put_sweeps( out );
    put_vertices( out );
}

const validate_case validate_chain = {
    .name = "chain",
    .title = "hanging chains swing in their two slowest modes",
    .scene = { .reference =
                   "closed forms: the period of ten equal masses from the roots of a Laguerre polynomial; of a "
                   "continuous chain from the zeros of J0",
               .error_name = "period of the slowest mode",
               .error_unit = "%",
               .measure_names = { "second period %", "amplitude lost %", "stretch max %" },
               .measure_count = CHAIN_MEASURES,
               .run = run_chains },
    .own_size = sizeof( chains ),
    .put = put_chains,
};

// ---- a folded chain ----

// A chain that hangs folded, both ends at one height, is let go at one of them.

enum
{
    THEORY_STEPS = 2000, // leave 1e-6 of the time of 65 links
    SWEEPS = 8,
    MAX_STEPS = 960, // twice the fall
};

enum
{
    DIRECT,
    DIRECT_BDF2,
    LINKS,
    CHAIN_METHODS,
};

static const char* const method_names[] = { "direct", "direct bdf2", "links" };

// A chain of 1 m, 1 kg, falls slowly, so that a step of 1/60 s is short beside the time of the last part: what is
// shown has no unit.
static const double GRAVITY = 0.015625, TIME = 8.0, SPEED = 0.125; // m/s^2; sqrt( L / g ), s; sqrt( g L ), m/s
static const double DEPTH = 0.9;

// ---- set-up ----

static wisp_status add_chain( validate_bodies* b, wisp_error* error )
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
    dynamics.damping = 0.0f;
    dynamics.bending = WISP_STRAND_BEND_NONE;
    dynamics.stretch = b->method == LINKS ? WISP_STRAND_STRETCH_LINKS : WISP_STRAND_STRETCH_DIRECT;
    dynamics.integrator = b->method == DIRECT_BDF2 ? WISP_INTEGRATOR_BDF2 : WISP_INTEGRATOR_EULER;
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
static chain_fall find_fall( const chain_depths* f )
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
static wisp_status drop_chain( validate_bodies* b, chain_fall* out, wisp_error* error )
{
    chain_depths f = { .steps = 0 };
    *out = ( chain_fall ){ NAN, NAN, NAN, NAN };
    while ( f.steps < MAX_STEPS && f.depths[2] < DEPTH )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        WISP_TRY( validate_step( b, 1, error ) );
        WISP_TRY( validate_tip( b, 0, &tip, error ) );
        feed( &f, -(double)tip.y );
    }
    if ( f.depths[2] >= DEPTH )
    {
        *out = find_fall( &f );
    }
    return WISP_OK;
}

static void measure_fall( const validate_bodies* b, const chain_fall* fall )
{
    accuracy_run* out = b->world.run;
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

static wisp_status play_folded( validate_bodies* b, wisp_error* error )
{
    chain_fall fall;
    b->def.iterations = b->method == LINKS ? SWEEPS : 1;
    WISP_TRY( validate_open( b, error ) );
    WISP_TRY( add_chain( b, error ) );
    WISP_TRY( validate_world_watch( &b->world, 0, error ) );
    WISP_TRY( drop_chain( b, &fall, error ) );
    if ( b->world.is_observed )
    {
        WISP_TRY( read_energy_error( b, &fall.energy_error, error ) );
        measure_fall( b, &fall );
    }
    return WISP_OK;
}

const validate_case validate_folded_chain = {
    .name = "folded_chain",
    .title = "a folded chain is let go at one end",
    .scene = { .reference = "a chain of as many masses, integrated in double precision, when its end has fallen 0.9 "
                            "of its length",
               .error_name = "distance of the speed of the end",
               .error_unit = "%",
               .measure_names = { "speed, sqrt(gL)", "speed of masses", "speed, continuous", "time, sqrt(L/g)",
                                  "time of masses", "time, continuous", "energy gained, % of m g L" },
               .measure_count = 7,
               // %, what the parabola leaves: 0.60 in steps of four times the length
               .uncertainty = 0.15 },
    .grid = { method_names, ( 1 << CHAIN_METHODS ) - 1, .cells = { 9, 17, 33, 65 }, .substeps = 32, .middle = 33,
              .fewer = { 16, 8, 4, 2, 1 } },
    .play = play_folded,
};
