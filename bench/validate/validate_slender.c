// Slender bodies under their own weight: the master curve of a cantilever, and the loads at which a column and a blade give way.
#include "validate_slender.h"

#include "accuracy/scene_tools.h"
#include "elastica.h"
#include "oracle/slender_theory.h"
#include "validate_ways.h"

#include <math.h>
#include <stdlib.h>

enum
{
    CURVE_LOADS = 4,
    LADDER = 31,
};

static const double CURVE[CURVE_LOADS] = { 1.0, 10.0, 100.0, 1000.0 };

typedef struct slender
{
    validate_way ways[VALIDATE_MAX_WAYS];
    double critical; // of a ladder
    bool is_blade;
} slender;

// ---- the cantilever ----

// Distances of the tips from theory, in lengths. The last measure is the aspect ratio H / W of the heaviest.
static wisp_status measure_curve( validate_bodies* bodies, accuracy_run* out, wisp_error* error )
{
    double sum = 0.0;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < CURVE_LOADS && status == WISP_OK; ++i )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        double exact[2][2];
        status = validate_tip( bodies, i, &tip, error );
        elastica_lay( CURVE[i], 2, exact );
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
    const validate_way* w = ( (const slender*)context )->ways + setting;
    // about critical for the second softest; 4 s are many times its period
    const validate_def def = {
        .solver = w->solver,
        .cells = w->cells,
        .substeps = w->substeps,
        .workers = workers,
        .count = CURVE_LOADS,
        .loads = CURVE,
        .gravity = { 0.0f, (float)-VALIDATE_GRAVITY, 0.0f },
        .damping = 2.0 * validate_frequency( 100.0 ),
    };
    validate_bodies bodies;
    wisp_status status = validate_create( &def, &bodies, error );
    status = status == WISP_OK ? validate_step_for( &bodies, 4.0, out, error ) : status;
    status = status == WISP_OK && is_observed ? measure_curve( &bodies, out, error ) : status;
    status = status == WISP_OK ? validate_finish( &bodies, out, error ) : status;
    validate_release( &bodies );
    return status;
}

// ---- ladders of loads ----

// The free ends are a little aside. Below the critical load they swing back, above it they go on.
static wisp_status measure_ladder( validate_bodies* bodies, const double* loads, double critical, accuracy_run* out,
                                   wisp_error* error )
{
    bool is_over[LADDER] = { false };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < LADDER && status == WISP_OK; ++i )
    {
        wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
        status = validate_tip( bodies, i, &tip, error );
        is_over[i] = fabs( (double)tip.y ) > validate_start( &bodies->def );
    }
    out->measures[0] = validate_ladder_found( is_over, loads, LADDER );
    out->measures[1] = critical;
    out->error = 100.0 * validate_ladder_error( out->measures[0], critical );
    return status;
}

static wisp_status run_ladder( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                               wisp_error* error )
{
    const slender* own = context;
    const validate_way* w = own->ways + setting;
    const double g = VALIDATE_GRAVITY;
    double loads[LADDER];
    validate_ladder( own->critical, LADDER, loads );
    const double slow = validate_frequency( own->critical );
    validate_def def = {
        .solver = w->solver,
        .cells = w->cells,
        .substeps = w->substeps,
        .workers = workers,
        .count = LADDER,
        .loads = loads,
        .gravity = own->is_blade ? ( wisp_vec3 ){ 0.0f, 0.0f, (float)-g } : ( wisp_vec3 ){ (float)-g, 0.0f, 0.0f },
        .damping = 0.5 * slow,
        .lateral = 0.005,
        .is_blade = own->is_blade,
    };
    validate_bodies bodies;
    wisp_status status = validate_create( &def, &bodies, error );
    status = status == WISP_OK ? validate_step_for( &bodies, 40.0 / slow, out, error ) : status;
    status = status == WISP_OK && is_observed ? measure_ladder( &bodies, loads, own->critical, out, error ) : status;
    status = status == WISP_OK ? validate_finish( &bodies, out, error ) : status;
    validate_release( &bodies );
    return status;
}

// ---- settings ----

// Bending of a mesh converges at second order.
static void put_settings( accuracy_scene* out, const validate_solver* solvers, int solver_count )
{
    static const int cells[] = { 4, 8, 16, 32 };
    slender* own = out->context;
    validate_put_settings( out, &( validate_series ){ solvers, solver_count, cells, WISP_COUNT( cells ), 32, 16 },
                           own->ways );
}

static wisp_status make( const slender* like, accuracy_scene scene, accuracy_scene* out, wisp_error* error )
{
    slender* own = malloc( sizeof *own );
    *out = scene;
    out->context = own;
    out->destroy = free;
    const wisp_status status = own != NULL ? accuracy_reserve_settings( out, VALIDATE_MAX_WAYS, error )
                                           : wisp_fail( error, WISP_NO_MEMORY, "no memory for a case" );
    if ( status != WISP_OK )
    {
        return accuracy_abandon( out, status );
    }
    *own = *like;
    return WISP_OK;
}

wisp_status validate_cantilever( const bench_options* options, double seconds, accuracy_scene* out,
                                 wisp_error* error )
{
    (void)options;
    (void)seconds;
    static const validate_solver solvers[] = { VALIDATE_ROD, VALIDATE_DIHEDRAL, VALIDATE_ISOMETRIC,
                                               VALIDATE_IMPLICIT };
    const slender like = { .critical = NAN };
    const accuracy_scene scene = {
        .reference = "the heavy elastica; root mean square over four loads, after 4 s",
        .error_name = "distance of the tip from theory",
        .error_unit = "% of L",
        .measure_names = { "G = 1, %", "G = 10, %", "G = 100, %", "G = 1000, %" },
        .measure_count = CURVE_LOADS,
        .run = run_curve,
    };
    const wisp_status status = make( &like, scene, out, error );
    if ( status == WISP_OK )
    {
        put_settings( out, solvers, WISP_COUNT( solvers ) );
    }
    return status;
}

static wisp_status make_ladder( double critical, bool is_blade, const char* reference, accuracy_scene* out,
                                wisp_error* error )
{
    static const validate_solver solvers[] = { VALIDATE_ROD, VALIDATE_DIHEDRAL, VALIDATE_ISOMETRIC,
                                               VALIDATE_IMPLICIT };
    const slender like = { .critical = critical, .is_blade = is_blade };
    accuracy_scene scene = {
        .error_name = "distance of the critical load",
        .error_unit = "%",
        .measure_names = { "measured G", "theory G" },
        .measure_count = 2,
        .uncertainty = 100.0 * validate_ladder_doubt( LADDER ),
        .run = run_ladder,
    };
    snprintf( scene.reference, sizeof scene.reference, "%s", reference );
    const wisp_status status = make( &like, scene, out, error );
    if ( status == WISP_OK )
    {
        put_settings( out, solvers, is_blade ? 1 : WISP_COUNT( solvers ) );
    }
    return status;
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
