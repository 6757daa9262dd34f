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
    validate_settings settings;
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

static validate_def hang_curls( const validate_setting* way, int workers, int count, const double* curl,
                                const double* weights, validate_point* shapes )
{
    double softest = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        lay_arc( curl[i], way->cells, shapes + i * ( way->cells + 1 ) );
        softest = fmax( softest, weights[i] );
    }
    return ( validate_def ){
        .solver = (validate_solver)way->solver,
        .cells = way->cells,
        .substeps = way->substeps,
        .workers = workers,
        .count = count,
        .loads = weights,
        .gravity = { (float)VALIDATE_GRAVITY, 0.0f, 0.0f },
        .damping = 2.0 * validate_frequency( softest ),
        .shapes = shapes,
        .is_curled = true,
        .twist_ratio = TWIST,
    };
}

// ---- tips ----

static wisp_status measure_tips( const curls* own, validate_bodies* bodies, accuracy_run* out, wisp_error* error )
{
    double sum = 0.0;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < TIPS && status == WISP_OK; ++i )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        status = validate_tip( bodies, i, &tip, error );
        const double aside = (double)tip.y / VALIDATE_LENGTH - own->tips[i][0],
                     down = (double)tip.x / VALIDATE_LENGTH - own->tips[i][1],
                     out_of_plane = (double)tip.z / VALIDATE_LENGTH;
        const double square = aside * aside + down * down + out_of_plane * out_of_plane;
        out->measures[i] = 100.0 * sqrt( square );
        sum += square;
    }
    out->error = 100.0 * sqrt( sum / TIPS );
    return status;
}

static wisp_status run_tips( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                             wisp_error* error )
{
    const curls* own = context;
    validate_point shapes[TIPS * ( VALIDATE_MAX_CELLS + 1 )];
    const validate_def def =
        hang_curls( validate_setting_of( own, setting ), workers, TIPS, TIP_CURLS, TIP_WEIGHTS, shapes );
    validate_bodies bodies;
    wisp_status status = validate_create( &def, &bodies, error );
    status = status == WISP_OK ? validate_step_for( &bodies, 3.0, out, error ) : status;
    status = status == WISP_OK && is_observed ? measure_tips( own, &bodies, out, error ) : status;
    return validate_end( status, &bodies, out, error );
}

// ---- out of the plane ----

static wisp_status read_out_of_plane( validate_bodies* bodies, double* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < bodies->def.count && status == WISP_OK; ++i )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        status = validate_tip( bodies, i, &tip, error );
        out[i] = fabs( (double)tip.z );
    }
    return status;
}

// Hang in the plane, push all out of it for a moment by gravity that is tilted, and let them go on or come back.
// @param start, end how far out of the plane tips are after the push, and at the end, m
static wisp_status push_and_wait( validate_bodies* bodies, double slow, double* start, double* end, accuracy_run* out,
                                  wisp_error* error )
{
    const wisp_vec3 down = bodies->def.gravity, tilted = { down.x, 0.0f, 0.02f * down.x };
    wisp_status status = validate_step_for( bodies, 5.0 / slow, out, error );
    status = status == WISP_OK ? validate_turn_gravity( bodies, tilted, error ) : status;
    status = status == WISP_OK ? validate_step_for( bodies, 1.0 / slow, out, error ) : status;
    status = status == WISP_OK ? validate_turn_gravity( bodies, down, error ) : status;
    status = status == WISP_OK ? validate_step_for( bodies, 1.0 / slow, out, error ) : status;
    status = status == WISP_OK ? read_out_of_plane( bodies, start, error ) : status;
    status = status == WISP_OK ? validate_step_for( bodies, 15.0 / slow, out, error ) : status;
    return status == WISP_OK ? read_out_of_plane( bodies, end, error ) : status;
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

static wisp_status run_ladders( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                                wisp_error* error )
{
    const curls* own = context;
    validate_point shapes[LADDERS * ( VALIDATE_MAX_CELLS + 1 )];
    double curl[LADDERS], weights[LADDERS], start[LADDERS], end[LADDERS];
    double softest = 0.0;
    for ( int k = 0; k < CURLS; ++k )
    {
        softest = fmax( softest, own->weights[k] );
        for ( int i = 0; i < CURL_RUNGS; ++i )
        {
            curl[k * CURL_RUNGS + i] = LADDER_CURLS[k];
            weights[k * CURL_RUNGS + i] = own->weights[k] * validate_rung( i, CURL_RUNGS );
        }
    }
    const validate_def def =
        hang_curls( validate_setting_of( own, setting ), workers, LADDERS, curl, weights, shapes );
    validate_bodies bodies;
    wisp_status status = validate_create( &def, &bodies, error );
    status =
        status == WISP_OK ? push_and_wait( &bodies, validate_frequency( softest ), start, end, out, error ) : status;
    if ( status == WISP_OK && is_observed )
    {
        measure_ladders( own, start, end, out );
    }
    return validate_end( status, &bodies, out, error );
}

// ---- scenes ----

// Theory for both cases: tips, and weights.
static wisp_status find_theory( curls* out, wisp_error* error )
{
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

static wisp_status make_curls( accuracy_scene scene, const int* cells, int cell_count, int substeps, int middle,
                               accuracy_scene* out, wisp_error* error )
{
    static const int rod = VALIDATE_ROD;
    const validate_grid grid = {
        .names = validate_solver_names,
        .solvers = &rod,
        .solver_count = 1,
        .cells = cells,
        .cell_count = cell_count,
        .substeps = substeps,
        .halvings = 3,
        .middle = middle,
    };
    curls like = { .settings = { .list = { { 0 } } } };
    wisp_status status = find_theory( &like, error );
    status = status == WISP_OK ? validate_make( &like, sizeof like, scene, out, error ) : status;
    if ( status == WISP_OK )
    {
        validate_put_grid( out, &grid );
    }
    return status;
}

wisp_status validate_curl( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)options;
    (void)seconds;
    const accuracy_scene scene = {
        .reference = "the planar heavy elastica with a natural curvature; root mean square over four rods, after 3 s",
        .error_name = "distance of the tip from theory",
        .error_unit = "% of L",
        .measure_names = { "curl 2, G = 10, %", "curl 2, G = 100, %", "curl 5, G = 10, %", "curl 9, G = 10, %" },
        .measure_count = TIPS,
        .run = run_tips,
    };
    static const int cells[] = { 8, 16, 32, 64 };
    return make_curls( scene, cells, WISP_COUNT( cells ), 128, 32, out, error );
}

wisp_status validate_bend_twist( const bench_options* options, double seconds, accuracy_scene* out,
                                 wisp_error* error )
{
    (void)options;
    (void)seconds;
    const accuracy_scene scene = {
        .reference =
            "second variation of a Kirchhoff rod about its planar equilibrium, GJ = 2/3 EI; root mean square "
            "over two curls",
        .uncertainty = validate_ladder_doubt( CURL_RUNGS ),
        .error_name = "distance of the critical weight",
        .error_unit = "%",
        .measure_names = { "curl 7, measured G", "theory G, 7", "curl 9, measured G", "theory G, 9" },
        .measure_count = 2 * CURLS,
        .run = run_ladders,
    };
    static const int cells[] = { 8, 16, 32 };
    return make_curls( scene, cells, WISP_COUNT( cells ), 64, 16, out, error );
}

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

typedef struct slips
{
    validate_settings settings;
    double ratio; // critical mu
} slips;

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

static wisp_status read_asides( validate_bodies* bodies, double* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < bodies->def.count && status == WISP_OK; ++i )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        status = validate_tip( bodies, i, &tip, error );
        out[i] = (double)tip.y / VALIDATE_LENGTH;
    }
    return status;
}

// What slips a little goes on, for the farther the tip is, the more friction would hold it.
static void measure_slips( const slips* own, const double* start, const double* end, accuracy_run* out )
{
    bool sticks[SLIP_RUNGS];
    for ( int i = 0; i < SLIP_RUNGS; ++i )
    {
        sticks[i] = fabs( end[i] - start[i] ) < FAR;
    }
    out->error = validate_measure_ladder( sticks, SLIP_RUNGS, own->ratio, out->measures );
    out->measures[2] = 100.0 * fabs( end[0] - start[0] );
}

static wisp_status hold_and_let_go( validate_bodies* bodies, const double* mu, double* start, double* end,
                                    accuracy_run* out, wisp_error* error )
{
    wisp_status status = validate_step_for( bodies, HOLD_SECONDS, out, error );
    status = status == WISP_OK ? read_asides( bodies, start, error ) : status;
    status = status == WISP_OK ? validate_set_friction( bodies, mu, error ) : status;
    status = status == WISP_OK ? validate_step_for( bodies, SLIP_SECONDS, out, error ) : status;
    return status == WISP_OK ? read_asides( bodies, end, error ) : status;
}

static wisp_status run_slips( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                              wisp_error* error )
{
    const slips* own = context;
    const validate_setting* w = validate_setting_of( context, setting );
    validate_point shapes[SLIP_RUNGS * ( VALIDATE_SLIP_MAX_CELLS + 1 )];
    double mu[SLIP_RUNGS], loads[SLIP_RUNGS], floors[SLIP_RUNGS], start[SLIP_RUNGS], end[SLIP_RUNGS];
    const int points = w->cells + 1;
    wisp_status status = validate_slip_lay( HEIGHT, w->cells, shapes, error );
    for ( int i = 0; i < SLIP_RUNGS && status == WISP_OK; ++i )
    {
        loads[i] = BOW_LOAD;
        floors[i] = HEIGHT;
        mu[i] = own->ratio * validate_rung( i, SLIP_RUNGS );
        memcpy( shapes + i * points, shapes, (size_t)( i > 0 ? points : 0 ) * sizeof *shapes );
    }
    const validate_def def = {
        .solver = (validate_solver)w->solver,
        .cells = w->cells,
        .substeps = w->substeps,
        .workers = workers,
        .count = SLIP_RUNGS,
        .loads = loads,
        .damping = 4.0 * validate_frequency( BOW_LOAD ), // about critical between a clamp and a hinge
        .shapes = shapes,
        .floors = floors,
        .friction = HOLD,
    };
    validate_bodies bodies = { .world = { .world = NULL } };
    status = status == WISP_OK ? validate_create( &def, &bodies, error ) : status;
    status = status == WISP_OK ? hold_and_let_go( &bodies, mu, start, end, out, error ) : status;
    if ( status == WISP_OK && is_observed )
    {
        measure_slips( own, start, end, out );
    }
    return validate_end( status, &bodies, out, error );
}

wisp_status validate_stick_slip( const bench_options* options, double seconds, accuracy_scene* out,
                                 wisp_error* error )
{
    (void)options;
    (void)seconds;
    static const int solvers[] = { VALIDATE_ROD, VALIDATE_DIHEDRAL, VALIDATE_ISOMETRIC, VALIDATE_IMPLICIT };
    static const int cells[] = { 8, 16, VALIDATE_SLIP_MAX_CELLS };
    const validate_grid grid = {
        .names = validate_solver_names,
        .solvers = solvers,
        .solver_count = WISP_COUNT( solvers ),
        .cells = cells,
        .cell_count = WISP_COUNT( cells ),
        .substeps = 16,
        .halvings = 3,
        .middle = 16,
    };
    const accuracy_scene scene = {
        .reference = "the elastica between a clamp and a hinge, three quarters of its length high",
        .uncertainty = validate_ladder_doubt( SLIP_RUNGS ),
        .error_name = "distance of the critical friction",
        .error_unit = "%",
        .measure_names = { "measured mu", "theory mu", "slip at 0.7 of it, % of L" },
        .measure_count = 3,
        .run = run_slips,
    };
    slip_shape shape;
    wisp_status status = stand( HEIGHT, 0.0, &shape, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const slips like = { .ratio = shape.ratio };
    status = validate_make( &like, sizeof like, scene, out, error );
    if ( status == WISP_OK )
    {
        validate_put_grid( out, &grid );
    }
    return status;
}
