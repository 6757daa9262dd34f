// Suspended curls: where their tips hang in the plane, and the weight at which they leave it by bending and twist.
//
// Down is +x, the clamp points there, and curls turn towards +y. They start in their natural arc.
#include "validate/validate.h"

#include "validate/validate_bodies.h"

#include "oracle/slender_theory.h"
#include "oracle/slip_theory.h"

#include <math.h>
#include <string.h>

enum
{
    TIPS = 4,
    CURLS = 2,
    CURL_RUNGS = 13,
    LADDERS = CURLS * CURL_RUNGS,
};

// A round rod of a material that keeps its volume: GJ / EI = 1 / (1 + 1/2).
static const double TWIST = 2.0 / 3.0;
// Natural curvature times length, and weight, of the rods whose tips are measured. All are stable.
static const double TIP_CURLS[TIPS] = { 2.0, 2.0, 5.0, 9.0 }, TIP_WEIGHTS[TIPS] = { 10.0, 100.0, 10.0, 10.0 };
// Of the rods that leave their plane. Below about 6 none does, whatever its weight.
static const double LADDER_CURLS[CURLS] = { 7.0, 9.0 };
static const double MAX_WEIGHT = 50.0; // beyond both critical ones

typedef struct curls
{
    double tips[TIPS][2];  // aside, down
    double weights[CURLS]; // critical
} curls;

// Segments of equal length in the directions that the arc has in their middles. @param shape [cells + 1]
static void lay_arc( double curl, int cells, validate_point* shape )
{
    shape[0] = ( validate_point ){ 0.0, 0.0 };
    for ( int i = 0; i < cells; ++i )
    {
        const double angle = curl * ( i + 0.5 ) / cells;
        shape[i + 1].x = shape[i].x + cos( angle ) / cells;
        shape[i + 1].y = shape[i].y + sin( angle ) / cells;
    }
}

static wisp_status hang_curls( validate_bodies* b, int count, const double* curl, const double* weights,
                               validate_point* shapes, wisp_error* error )
{
    double softest = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        lay_arc( curl[i], b->def.cells, shapes + i * ( b->def.cells + 1 ) );
        softest = fmax( softest, weights[i] );
    }
    b->def.count = count;
    b->def.loads = weights;
    b->def.gravity.x = (float)VALIDATE_GRAVITY;
    b->def.damping = 2.0 * validate_frequency( softest );
    b->def.shapes = shapes;
    b->def.is_curled = true;
    b->def.twist_ratio = TWIST;
    return validate_create( b, error );
}

// ---- tips ----

static wisp_status measure_tips( validate_bodies* b, wisp_error* error )
{
    const curls* own = b->own;
    double sum = 0.0;
    for ( int i = 0; i < TIPS; ++i )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        WISP_TRY( validate_tip( b, i, &tip, error ) );
        const double aside = (double)tip.y / VALIDATE_LENGTH - own->tips[i][0],
                     down = (double)tip.x / VALIDATE_LENGTH - own->tips[i][1],
                     out_of_plane = (double)tip.z / VALIDATE_LENGTH;
        const double square = aside * aside + down * down + out_of_plane * out_of_plane;
        b->world.run->measures[i] = 100.0 * sqrt( square );
        sum += square;
    }
    b->world.run->error = 100.0 * sqrt( sum / TIPS );
    return WISP_OK;
}

static wisp_status play_tips( validate_bodies* b, wisp_error* error )
{
    validate_point shapes[TIPS * ( VALIDATE_MAX_CELLS + 1 )];
    WISP_TRY( hang_curls( b, TIPS, TIP_CURLS, TIP_WEIGHTS, shapes, error ) );
    WISP_TRY( validate_step_for( b, 3.0, error ) );
    return b->world.is_observed ? measure_tips( b, error ) : WISP_OK;
}

// ---- out of the plane ----

static wisp_status read_out_of_plane( validate_bodies* b, double* out, wisp_error* error )
{
    for ( int i = 0; i < b->def.count; ++i )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        WISP_TRY( validate_tip( b, i, &tip, error ) );
        out[i] = fabs( (double)tip.z );
    }
    return WISP_OK;
}

// Hang in the plane, push all out of it for a moment by gravity that is tilted, and let them go on or come back.
// @param start, end how far out of the plane tips are after the push, and at the end, m
static wisp_status push_and_wait( validate_bodies* b, double slow, double* start, double* end, wisp_error* error )
{
    const wisp_vec3 down = b->def.gravity, tilted = { down.x, 0.0f, 0.02f * down.x };
    WISP_TRY( validate_step_for( b, 5.0 / slow, error ) );
    WISP_TRY( validate_turn_gravity( b, tilted, error ) );
    WISP_TRY( validate_step_for( b, 1.0 / slow, error ) );
    WISP_TRY( validate_turn_gravity( b, down, error ) );
    WISP_TRY( validate_step_for( b, 1.0 / slow, error ) );
    WISP_TRY( read_out_of_plane( b, start, error ) );
    WISP_TRY( validate_step_for( b, 15.0 / slow, error ) );
    return read_out_of_plane( b, end, error );
}

static void measure_ladders( const curls* own, const double* start, const double* end, accuracy_run* out )
{
    double sum = 0.0;
    for ( int k = 0; k < CURLS; ++k )
    {
        bool is_over[CURL_RUNGS];
        for ( int i = 0; i < CURL_RUNGS; ++i )
        {
            is_over[i] = end[k * CURL_RUNGS + i] > start[k * CURL_RUNGS + i];
        }
        const double error = validate_measure_ladder( is_over, CURL_RUNGS, own->weights[k], out->measures + 2 * k );
        sum += error * error;
    }
    out->error = sqrt( sum / CURLS );
}

static wisp_status play_ladders( validate_bodies* b, wisp_error* error )
{
    const curls* own = b->own;
    validate_point shapes[LADDERS * ( VALIDATE_MAX_CELLS + 1 )];
    double curl[LADDERS], weights[LADDERS], start[LADDERS], end[LADDERS];
    double softest = 0.0;
    for ( int i = 0; i < LADDERS; ++i )
    {
        const int k = i / CURL_RUNGS;
        softest = fmax( softest, own->weights[k] );
        curl[i] = LADDER_CURLS[k];
        weights[i] = own->weights[k] * validate_rung( i % CURL_RUNGS, CURL_RUNGS );
    }
    WISP_TRY( hang_curls( b, LADDERS, curl, weights, shapes, error ) );
    WISP_TRY( push_and_wait( b, validate_frequency( softest ), start, end, error ) );
    if ( b->world.is_observed )
    {
        measure_ladders( own, start, end, b->world.run );
    }
    return WISP_OK;
}

// ---- scenes ----

// Theory for both cases: tips, and weights.
static wisp_status find_theory( accuracy_scene* scene, wisp_error* error )
{
    curls* out = validate_own( scene->context );
    for ( int i = 0; i < TIPS; ++i )
    {
        const curl_rod rod = { TIP_CURLS[i], TIP_WEIGHTS[i], TWIST, 1.0, 0.0 };
        curl_shape shape;
        if ( curl_hang( &rod, &shape ) == false || shape.modes > 0 )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "a curl of %g and weight %g has no stable planar shape",
                              rod.curl, rod.weight );
        }
        out->tips[i][0] = shape.aside;
        out->tips[i][1] = shape.down;
    }
    for ( int k = 0; k < CURLS; ++k )
    {
        const curl_rod rod = { LADDER_CURLS[k], MAX_WEIGHT, TWIST, 1.0, 0.0 };
        out->weights[k] = curl_critical_weight( &rod );
        if ( isnan( out->weights[k] ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "a curl of %g does not leave its plane", rod.curl );
        }
    }
    return WISP_OK;
}

const validate_case validate_curl = {
    .name = "curl",
    .title = "suspended curls hang in their plane",
    .scene = { .reference =
                   "the planar heavy elastica with a natural curvature; root mean square over four rods, after 3 s",
               .error_name = "distance of the tip from theory",
               .error_unit = "% of L",
               .measure_names = { "curl 2, G = 10, %", "curl 2, G = 100, %", "curl 5, G = 10, %",
                                  "curl 9, G = 10, %" },
               .measure_count = TIPS },
    .grid = { validate_solver_names, 1 << VALIDATE_ROD, .cells = { 8, 16, 32, 64 }, .substeps = 128, .middle = 32,
              .fewer = { 64, 32, 16 } },
    .own_size = sizeof( curls ),
    .prepare = find_theory,
    .play = play_tips,
};

const validate_case validate_bend_twist = {
    .name = "bend_twist",
    .title = "suspended curls leave their plane under their own weight",
    .scene = { .reference =
                   "second variation of a Kirchhoff rod about its planar equilibrium, GJ = 2/3 EI; root mean square "
                   "over two curls",
               .error_name = "distance of the critical weight",
               .error_unit = "%",
               .measure_names = { "curl 7, measured G", "theory G, 7", "curl 9, measured G", "theory G, 9" },
               .measure_count = 2 * CURLS },
    .rungs = CURL_RUNGS,
    .grid = { validate_solver_names, 1 << VALIDATE_ROD, .cells = { 8, 16, 32 }, .substeps = 64, .middle = 16,
              .fewer = { 32, 16, 8 } },
    .own_size = sizeof( curls ),
    .prepare = find_theory,
    .play = play_ladders,
};

// ---- bowed bodies on a rough floor ----

// Bowed rods and strips between a clamp and a rough floor: they are held until they are at rest, and then given less friction.
//
// The clamp is at the origin and points at the floor, along x. Bodies bow to +y, so their tips push to -y.

enum
{
    SLIP_RUNGS = 13,
};

static const double HEIGHT = 0.75;   // of the clamp, in lengths
static const double BOW_LOAD = 10.0; // there is no weight: it only says how stiff they are
static const double HOLD = 10.0;     // mu, of tips that are to stay
static const double FAR = 0.005; // lengths, that a tip moves which slips; before one sticks it moves by up to 0.004
static const double HOLD_SECONDS = 0.3, SLIP_SECONDS = 0.5;

static wisp_status stand( double height, double aside, slip_shape* out, wisp_error* error )
{
    return slip_stand( height, aside, out )
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "no elastica %g lengths high", height );
}

// Cells in the directions that the elastica has in their middles end somewhat off its tip, so the elastica aims beside it by as much.
wisp_status validate_slip_lay( double height, int cells, validate_point* shape, wisp_error* error )
{
    const double cell = 1.0 / cells, rest = 1.0 - cell;
    double aim[2] = { ( height - cell ) / rest, 0.0 };
    wisp_status status = WISP_OK;
    shape[0] = ( validate_point ){ 0.0, 0.0 };
    shape[1] = ( validate_point ){ cell, 0.0 };
    for ( int i = 0; i < 8 && status == WISP_OK; ++i )
    {
        slip_shape elastica;
        status = stand( aim[0], aim[1], &elastica, error );
        for ( int k = 1; k < cells; ++k )
        {
            const double angle = slip_angle( &elastica, ( k - 0.5 ) / ( cells - 1 ) );
            shape[k + 1].x = shape[k].x + cell * cos( angle );
            shape[k + 1].y = shape[k].y + cell * sin( angle );
        }
        aim[0] += ( height - shape[cells].x ) / rest;
        aim[1] -= shape[cells].y / rest;
    }
    return status;
}

// ---- a run ----

static wisp_status read_asides( validate_bodies* b, double* out, wisp_error* error )
{
    for ( int i = 0; i < b->def.count; ++i )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        WISP_TRY( validate_tip( b, i, &tip, error ) );
        out[i] = (double)tip.y / VALIDATE_LENGTH;
    }
    return WISP_OK;
}

// What slips a little goes on, for the farther the tip is, the more friction would hold it.
static void measure_slips( validate_bodies* b, double critical, const double* start, const double* end )
{
    bool sticks[SLIP_RUNGS];
    for ( int i = 0; i < SLIP_RUNGS; ++i )
    {
        sticks[i] = fabs( end[i] - start[i] ) < FAR;
    }
    validate_judge_ladder( b, sticks, SLIP_RUNGS, critical );
    b->world.run->measures[2] = 100.0 * fabs( end[0] - start[0] );
}

static wisp_status play_slips( validate_bodies* b, wisp_error* error )
{
    validate_point shapes[SLIP_RUNGS * ( VALIDATE_SLIP_MAX_CELLS + 1 )];
    double mu[SLIP_RUNGS], loads[SLIP_RUNGS], floors[SLIP_RUNGS], start[SLIP_RUNGS], end[SLIP_RUNGS];
    const double critical = *(const double*)b->own;
    const int points = b->def.cells + 1;
    WISP_TRY( validate_slip_lay( HEIGHT, b->def.cells, shapes, error ) );
    for ( int i = 0; i < SLIP_RUNGS; ++i )
    {
        loads[i] = BOW_LOAD;
        floors[i] = HEIGHT;
        mu[i] = critical * validate_rung( i, SLIP_RUNGS );
        memcpy( shapes + i * points, shapes, (size_t)( i > 0 ? points : 0 ) * sizeof *shapes );
    }
    b->def.solver = (validate_solver)b->method;
    b->def.count = SLIP_RUNGS;
    b->def.loads = loads;
    b->def.damping = 4.0 * validate_frequency( BOW_LOAD ); // about critical between a clamp and a hinge
    b->def.shapes = shapes;
    b->def.floors = floors;
    b->def.friction = HOLD;
    WISP_TRY( validate_create( b, error ) );
    WISP_TRY( validate_step_for( b, HOLD_SECONDS, error ) );
    WISP_TRY( read_asides( b, start, error ) );
    WISP_TRY( validate_set_friction( b, mu, error ) );
    WISP_TRY( validate_step_for( b, SLIP_SECONDS, error ) );
    WISP_TRY( read_asides( b, end, error ) );
    measure_slips( b, critical, start, end );
    return WISP_OK;
}

// Keep the critical friction.
static wisp_status find_slip( accuracy_scene* out, wisp_error* error )
{
    slip_shape shape;
    const wisp_status status = stand( HEIGHT, 0.0, &shape, error );
    *(double*)validate_own( out->context ) = status == WISP_OK ? shape.ratio : (double)NAN;
    return status;
}

const validate_case validate_stick_slip = {
    .name = "stick_slip",
    .title = "bowed rods and strips stick to a rough floor, or slip",
    .scene = { .reference = "the elastica between a clamp and a hinge, three quarters of its length high",
               .error_name = "distance of the critical friction",
               .error_unit = "%",
               .measure_names = { "measured mu", "theory mu", "slip at 0.7 of it, % of L" },
               .measure_count = 3 },
    .rungs = SLIP_RUNGS,
    .grid = { validate_solver_names, VALIDATE_ALL_SOLVERS, .cells = { 8, 16, VALIDATE_SLIP_MAX_CELLS },
              .substeps = 16, .middle = 16, .fewer = { 8, 4, 2 } },
    .own_size = sizeof( double ),
    .prepare = find_slip,
    .play = play_slips,
};
