// Suspended curls: where their tips hang in the plane, and the weight at which they leave it by bending and twist.
//
// Down is +x, the clamp points there, and curls turn towards +y. They start in their natural arc.
#include "validate_curls.h"

#include "oracle/curl_theory.h"
#include "validate_bodies.h"
#include "validate_ladder.h"
#include "validate_settings.h"

#include <math.h>

enum
{
    TIPS = 4,
    CURLS = 2,
    RUNGS = 13,
    LADDERS = CURLS * RUNGS,
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

static validate_def hang( const validate_setting* way, int workers, int count, const double* curl,
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
        hang( validate_setting_of( own, setting ), workers, TIPS, TIP_CURLS, TIP_WEIGHTS, shapes );
    validate_bodies bodies;
    wisp_status status = validate_create( &def, &bodies, error );
    status = status == WISP_OK ? validate_step_for( &bodies, 3.0, out, error ) : status;
    status = status == WISP_OK && is_observed ? measure_tips( own, &bodies, out, error ) : status;
    status = status == WISP_OK ? validate_finish( &bodies, out, error ) : status;
    validate_release( &bodies );
    return status;
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
        bool is_over[RUNGS];
        for ( int i = 0; i < RUNGS; ++i )
        {
            is_over[i] = end[k * RUNGS + i] > start[k * RUNGS + i];
        }
        const double error = validate_measure_ladder( is_over, RUNGS, own->weights[k], out->measures + 2 * k );
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
        for ( int i = 0; i < RUNGS; ++i )
        {
            curl[k * RUNGS + i] = LADDER_CURLS[k];
            weights[k * RUNGS + i] = own->weights[k] * validate_rung( i, RUNGS );
        }
    }
    const validate_def def = hang( validate_setting_of( own, setting ), workers, LADDERS, curl, weights, shapes );
    validate_bodies bodies;
    wisp_status status = validate_create( &def, &bodies, error );
    status =
        status == WISP_OK ? push_and_wait( &bodies, validate_frequency( softest ), start, end, out, error ) : status;
    if ( status == WISP_OK && is_observed )
    {
        measure_ladders( own, start, end, out );
    }
    status = status == WISP_OK ? validate_finish( &bodies, out, error ) : status;
    validate_release( &bodies );
    return status;
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

static wisp_status make( accuracy_scene scene, const int* cells, int cell_count, int substeps, int middle,
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
    return make( scene, cells, WISP_COUNT( cells ), 128, 32, out, error );
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
        .uncertainty = validate_ladder_doubt( RUNGS ),
        .error_name = "distance of the critical weight",
        .error_unit = "%",
        .measure_names = { "curl 7, measured G", "theory G, 7", "curl 9, measured G", "theory G, 9" },
        .measure_count = 2 * CURLS,
        .run = run_ladders,
    };
    static const int cells[] = { 8, 16, 32 };
    return make( scene, cells, WISP_COUNT( cells ), 64, 16, out, error );
}
