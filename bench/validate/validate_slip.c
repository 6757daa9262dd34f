// Bowed rods and strips between a clamp and a rough floor: they are held until they are at rest, and then given less friction.
//
// The clamp is at the origin and points at the floor, along x. Bodies bow to +y, so their tips push to -y.
#include "validate_slip.h"

#include "oracle/slip_theory.h"
#include "validate_ladder.h"
#include "validate_settings.h"

#include <math.h>
#include <string.h>

enum
{
    RUNGS = 13,
};

static const double HEIGHT = 0.75; // of the clamp, in lengths
static const double LOAD = 10.0;   // there is no weight: it only says how stiff they are
static const double HOLD = 10.0;   // mu, of tips that are to stay
static const double FAR = 0.005;   // lengths, that a tip moves which slips; before one sticks it moves by up to 0.004
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
static void measure( const slips* own, const double* start, const double* end, accuracy_run* out )
{
    bool sticks[RUNGS];
    for ( int i = 0; i < RUNGS; ++i )
    {
        sticks[i] = fabs( end[i] - start[i] ) < FAR;
    }
    out->error = validate_measure_ladder( sticks, RUNGS, own->ratio, out->measures );
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

static wisp_status run_ladder( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                               wisp_error* error )
{
    const slips* own = context;
    const validate_setting* w = validate_setting_of( context, setting );
    validate_point shapes[RUNGS * ( VALIDATE_SLIP_MAX_CELLS + 1 )];
    double mu[RUNGS], loads[RUNGS], floors[RUNGS], start[RUNGS], end[RUNGS];
    const int points = w->cells + 1;
    wisp_status status = validate_slip_lay( HEIGHT, w->cells, shapes, error );
    for ( int i = 0; i < RUNGS && status == WISP_OK; ++i )
    {
        loads[i] = LOAD;
        floors[i] = HEIGHT;
        mu[i] = own->ratio * validate_rung( i, RUNGS );
        memcpy( shapes + i * points, shapes, (size_t)( i > 0 ? points : 0 ) * sizeof *shapes );
    }
    const validate_def def = {
        .solver = (validate_solver)w->solver,
        .cells = w->cells,
        .substeps = w->substeps,
        .workers = workers,
        .count = RUNGS,
        .loads = loads,
        .damping = 4.0 * validate_frequency( LOAD ), // about critical between a clamp and a hinge
        .shapes = shapes,
        .floors = floors,
        .friction = HOLD,
    };
    validate_bodies bodies = { .world = { .world = NULL } };
    status = status == WISP_OK ? validate_create( &def, &bodies, error ) : status;
    status = status == WISP_OK ? hold_and_let_go( &bodies, mu, start, end, out, error ) : status;
    if ( status == WISP_OK && is_observed )
    {
        measure( own, start, end, out );
    }
    status = status == WISP_OK ? validate_finish( &bodies, out, error ) : status;
    validate_release( &bodies );
    return status;
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
        .uncertainty = validate_ladder_doubt( RUNGS ),
        .error_name = "distance of the critical friction",
        .error_unit = "%",
        .measure_names = { "measured mu", "theory mu", "slip at 0.7 of it, % of L" },
        .measure_count = 3,
        .run = run_ladder,
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
