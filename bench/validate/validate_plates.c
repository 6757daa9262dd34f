// Plates that buckle under their own weight: the load at which a sheet on edge turns aside, and that at which an upright one gives way.
#include "validate/validate.h"

#include "oracle/plate_theory.h"
#include "validate/validate_bodies.h"

#include <math.h>

enum
{
    MAX_WIDTHS = 4,
    PLATE_RUNGS = 7, // loads, of a sheet each
};

static const double LOWEST = 0.6, HIGHEST = 1.8; // loads of the first and the last sheet, in parts of theory
// The turn of growth into decay is interpolated between two sheets. Growth is nearly linear in 1 / load, as the sheets are overdamped.
static const double UNCERTAINTY = 0.5; // %

// Bending of the solvers has Poisson's ratio 0. In its plane a sheet of links has 1/3 on the mesh with diagonals in turn; what
// another one changes is below 0.2 % (see the test of the theory).
static const double POISSON_BENDING = 0.0, POISSON_PLANE = 1.0 / 3.0;

typedef struct plates
{
    validate_settings settings; // whose solver is a number of solver and mesh
    bool is_sideways;
    int width_count;
    double widths[MAX_WIDTHS], theory[MAX_WIDTHS];
} plates;

// ---- a critical load ----

// How far aside the sheets are at two times, from which their growth follows.
typedef struct ladder
{
    double loads[PLATE_RUNGS], half[PLATE_RUNGS], end[PLATE_RUNGS];
} ladder;

static wisp_status read_aside( validate_bodies* bodies, double* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < PLATE_RUNGS && status == WISP_OK; ++i )
    {
        status = validate_aside( bodies, i, out + i, error );
    }
    return status;
}

// The weight comes at once and shakes the sheets in their plane, so strong damping comes first.
static wisp_status swing_plates( validate_bodies* bodies, double slow, accuracy_run* out, ladder* l,
                                 wisp_error* error )
{
    wisp_status status = validate_damp( bodies, 20.0 * slow, error );
    status = status == WISP_OK ? validate_step_for( bodies, 1.0 / slow, out, error ) : status;
    status = status == WISP_OK ? validate_damp( bodies, 2.0 * slow, error ) : status;
    status = status == WISP_OK ? validate_step_for( bodies, 3.0 / slow, out, error ) : status;
    status = status == WISP_OK ? read_aside( bodies, l->half, error ) : status;
    status = status == WISP_OK ? validate_step_for( bodies, 3.0 / slow, out, error ) : status;
    return status == WISP_OK ? read_aside( bodies, l->end, error ) : status;
}

// The load between the first sheet that goes on and the one before. @param start how far aside the free ends started, m
// @return NaN: the first sheet went on, or none
static double find_load( const ladder* l, double start )
{
    int first = 0;
    // What has come back may still swing a little, and what has fallen over may be on its way back.
    while ( first < PLATE_RUNGS &&
            !( l->end[first] > 4.0 * start || ( l->end[first] > 0.1 * start && l->end[first] > l->half[first] ) ) )
    {
        ++first;
    }
    if ( first == 0 || first == PLATE_RUNGS )
    {
        return NAN;
    }
    const double before = log( l->end[first - 1] / l->half[first - 1] ),
                 after = log( l->end[first] / l->half[first] );
    const double part = before < 0.0 && after > 0.0 ? before / ( before - after ) : 0.5;
    return 1.0 / ( ( 1.0 - part ) / l->loads[first - 1] + part / l->loads[first] );
}

// How far the tip of the lightest sheet has moved in its plane, in lengths: what links that have not converged let it sag.
static wisp_status read_sag( validate_bodies* bodies, double* out, wisp_error* error )
{
    wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
    const wisp_status status = validate_tip( bodies, 0, &tip, error );
    *out = hypot( (double)tip.x / VALIDATE_LENGTH - 1.0, (double)tip.z / VALIDATE_LENGTH );
    return status;
}

typedef struct found
{
    double load; // in parts of theory; NaN: not between the first and the last of the ladder
    double sag;  // in lengths
} found;

// The critical load of one width: a world of sheets under rising loads.
static wisp_status measure_plates( const plates* own, const validate_setting* w, int width, int workers,
                                   accuracy_run* out, found* seen, wisp_error* error )
{
    const float g = (float)VALIDATE_GRAVITY;
    const double theory = own->theory[width], slow = validate_frequency( theory );
    ladder l;
    for ( int i = 0; i < PLATE_RUNGS; ++i )
    {
        l.loads[i] = theory * LOWEST * pow( HIGHEST / LOWEST, (double)i / ( PLATE_RUNGS - 1 ) );
    }
    const validate_def def = {
        .solver = (validate_solver)( w->solver % VALIDATE_SOLVER_COUNT ),
        .mesh = (validate_mesh)( w->solver / VALIDATE_SOLVER_COUNT ),
        .cells = w->cells,
        .substeps = w->substeps,
        .workers = workers,
        .count = PLATE_RUNGS,
        .loads = l.loads,
        .width = own->widths[width],
        .thickness = own->widths[width] / 25.0,
        .gravity = own->is_sideways ? ( wisp_vec3 ){ 0.0f, 0.0f, -g } : ( wisp_vec3 ){ -g, 0.0f, 0.0f },
        .lateral = 0.005, // far more than rounding in the plane can shake, and small enough for the linear theory
    };
    validate_bodies bodies;
    wisp_status status = validate_create( &def, &bodies, error );
    status = status == WISP_OK ? swing_plates( &bodies, slow, out, &l, error ) : status;
    status = status == WISP_OK ? read_sag( &bodies, &seen->sag, error ) : status;
    status = validate_end( status, &bodies, out, error );
    seen->load = status == WISP_OK ? find_load( &l, validate_start( &def ) ) / theory : (double)NAN;
    return status;
}

static wisp_status run_plates( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                               wisp_error* error )
{
    const plates* own = context;
    double sum = 0.0, sag = 0.0;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < own->width_count && status == WISP_OK; ++i )
    {
        found seen = { .load = NAN };
        status = measure_plates( own, validate_setting_of( own, setting ), i, workers, out, &seen, error );
        out->measures[i] = is_observed ? seen.load * own->theory[i] : (double)NAN;
        // outside the ladder the error is at least that of its first load
        sum += pow( isnan( seen.load ) ? 1.0 - LOWEST : seen.load - 1.0, 2.0 );
        sag = fmax( sag, seen.sag );
    }
    out->measures[own->width_count] = is_observed ? 100.0 * sag : (double)NAN;
    out->error = is_observed ? 100.0 * sqrt( sum / own->width_count ) : (double)NAN;
    return status;
}

// ---- settings ----

static const char* const mesh_names[VALIDATE_MESH_COUNT] = { "", ", one way", ", irregular" };

// Corners of the clamp make the order in cells a low one, so none is expected.
static void put_plate_cells( accuracy_scene* out, validate_solver solver, validate_mesh mesh, const int* cells,
                             int count, int substeps )
{
    char name[48];
    snprintf( name, sizeof name, "%s%s", validate_solver_names[solver], mesh_names[mesh] );
    validate_put_cells( out, (int)solver + VALIDATE_SOLVER_COUNT * (int)mesh, name, "cell / L", cells, count,
                        substeps );
}

// For each solver series in substeps, in cells, and in cells of the other meshes.
static void put_plates( accuracy_scene* out, bool is_quick )
{
    static const validate_solver solvers[] = { VALIDATE_DIHEDRAL, VALIDATE_ISOMETRIC, VALIDATE_IMPLICIT };
    static const int cells[] = { 5, 10, 20 };
    // Links of XPBD cloth need many substeps before a narrow sheet stops sagging; implicit cloth does not depend on them.
    static const int of_xpbd[] = { 128, 16, 8, 4 }, of_implicit[] = { 4, 2, 1 };
    for ( int s = 0; s < WISP_COUNT( solvers ); ++s )
    {
        const validate_solver solver = solvers[s];
        const bool is_implicit = solver == VALIDATE_IMPLICIT;
        const int substeps = is_implicit ? 8 : 32;
        validate_put_substeps( out, (int)solver, validate_solver_names[solver], cells[1],
                               is_implicit ? of_implicit : of_xpbd,
                               is_implicit ? WISP_COUNT( of_implicit ) : WISP_COUNT( of_xpbd ) );
        put_plate_cells( out, solver, VALIDATE_MESH_IN_TURN, cells, WISP_COUNT( cells ), substeps );
        put_plate_cells( out, solver, VALIDATE_MESH_IRREGULAR, cells, 2, substeps );
        if ( !is_quick )
        {
            put_plate_cells( out, solver, VALIDATE_MESH_ONE_WAY, cells, 2, substeps );
        }
    }
}

static const char* const NOTE = "A step is of seven sheets of one width, and its time is the median over the steps "
                                "of all widths. A critical load outside 0.6 "
                                "to 1.8 times theory is not measured (-) and counts as an error of 40 %. The sag is "
                                "the largest displacement of a tip in its plane "
                                "under 0.6 times theory: more than 1 % is that of links that have not converged. A "
                                "quick run leaves out the widest plate and the "
                                "mesh with all diagonals one way.";

// @param scene with the names of its measures, a width each
static wisp_status make_plates( bool is_sideways, const double* widths, accuracy_scene scene,
                                const bench_options* options, accuracy_scene* out, wisp_error* error )
{
    plates like = { .is_sideways = is_sideways, .width_count = scene.measure_count - ( options->quick ? 1 : 0 ) };
    int at = snprintf( scene.reference, sizeof scene.reference, "plate of Kirchhoff, by Ritz; G =" );
    for ( int i = 0; i < like.width_count; ++i )
    {
        const double load =
            plate_theory_load( widths[i], POISSON_BENDING, plate_theory_isotropic( POISSON_PLANE ), is_sideways );
        if ( isnan( load ) )
        {
            return wisp_fail( error, WISP_NO_MEMORY, "no memory for a theory" );
        }
        like.widths[i] = widths[i];
        like.theory[i] = load;
        at += snprintf( scene.reference + at, sizeof scene.reference - (size_t)at, " %.2f (W = %g L)", load,
                        widths[i] );
    }
    scene.measure_names[like.width_count] = "sag in the plane, % of L";
    scene.measure_count = like.width_count + 1;
    const wisp_status status = validate_make( &like, sizeof like, scene, out, error );
    if ( status == WISP_OK )
    {
        put_plates( out, options->quick );
    }
    return status;
}

wisp_status validate_lateral_buckling( const bench_options* options, double seconds, accuracy_scene* out,
                                       wisp_error* error )
{
    (void)seconds;
    static const double widths[] = { 0.05, 0.25, 0.5, 1.0 };
    const accuracy_scene scene = {
        .error_name = "distance of critical loads, root mean square",
        .error_unit = "%",
        .measure_names = { "G, W = 0.05 L", "G, W = 0.25 L", "G, W = 0.5 L", "G, W = L" },
        .measure_count = WISP_COUNT( widths ),
        .uncertainty = UNCERTAINTY,
        .note = NOTE,
        .run = run_plates,
    };
    return make_plates( true, widths, scene, options, out, error );
}

wisp_status validate_plate_column( const bench_options* options, double seconds, accuracy_scene* out,
                                   wisp_error* error )
{
    (void)seconds;
    static const double widths[] = { 0.25, 1.0, 2.0 };
    const accuracy_scene scene = {
        .error_name = "distance of critical loads, root mean square",
        .error_unit = "%",
        .measure_names = { "G, W = 0.25 L", "G, W = L", "G, W = 2 L" },
        .measure_count = WISP_COUNT( widths ),
        .uncertainty = UNCERTAINTY,
        .note = NOTE,
        .run = run_plates,
    };
    return make_plates( false, widths, scene, options, out, error );
}
