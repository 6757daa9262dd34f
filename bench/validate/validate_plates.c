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
#define UNCERTAINTY 0.5 // %

// Bending of the solvers has Poisson's ratio 0. In its plane a sheet of links has 1/3 on the mesh with diagonals in turn; what
// another one changes is below 0.2 % (see the test of the theory).
static const double POISSON_BENDING = 0.0, POISSON_PLANE = 1.0 / 3.0;

typedef struct plates
{
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

static wisp_status read_aside( validate_bodies* b, double* out, wisp_error* error )
{
    for ( int i = 0; i < PLATE_RUNGS; ++i )
    {
        WISP_TRY( validate_aside( b, i, out + i, error ) );
    }
    return WISP_OK;
}

// The weight comes at once and shakes the sheets in their plane, so strong damping comes first.
static wisp_status swing_plates( validate_bodies* b, double slow, ladder* l, wisp_error* error )
{
    WISP_TRY( validate_create( b, error ) );
    WISP_TRY( validate_damp( b, 20.0 * slow, error ) );
    WISP_TRY( validate_step_for( b, 1.0 / slow, error ) );
    WISP_TRY( validate_damp( b, 2.0 * slow, error ) );
    WISP_TRY( validate_step_for( b, 3.0 / slow, error ) );
    WISP_TRY( read_aside( b, l->half, error ) );
    WISP_TRY( validate_step_for( b, 3.0 / slow, error ) );
    return read_aside( b, l->end, error );
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
    validate_bodies bodies = { .def = def, .world = { .run = out } };
    wisp_status status = swing_plates( &bodies, slow, &l, error );
    status = status == WISP_OK ? read_sag( &bodies, &seen->sag, error ) : status;
    status = validate_end( status, &bodies, error );
    seen->load = status == WISP_OK ? find_load( &l, validate_start( &def ) ) / theory : (double)NAN;
    return status;
}

static wisp_status run_plates( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                               wisp_error* error )
{
    const plates* own = validate_own( context );
    const validate_setting* w = ( (const validate_settings*)context )->list + setting;
    double sum = 0.0, sag = 0.0;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < own->width_count && status == WISP_OK; ++i )
    {
        found seen = { .load = NAN };
        status = measure_plates( own, w, i, workers, out, &seen, error );
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
                             int substeps )
{
    char name[48];
    snprintf( name, sizeof name, "%s%s", validate_solver_names[solver], mesh_names[mesh] );
    validate_put_cells( out, (int)solver + VALIDATE_SOLVER_COUNT * (int)mesh, name, "cell / L", cells, substeps );
}

// For each solver series in substeps, in cells, and in cells of the other meshes.
static void put_plates( accuracy_scene* out )
{
    static const int cells[] = { 5, 10, 20, 0 }, fewer[] = { 5, 10, 0 };
    // Links of XPBD cloth need many substeps before a narrow sheet stops sagging; implicit cloth does not depend on them.
    static const int of_xpbd[] = { 128, 16, 8, 4, 0 }, of_implicit[] = { 4, 2, 1, 0 };
    for ( validate_solver solver = VALIDATE_DIHEDRAL; solver <= VALIDATE_IMPLICIT; ++solver )
    {
        const bool is_implicit = solver == VALIDATE_IMPLICIT;
        const int substeps = is_implicit ? 8 : 32;
        validate_put_substeps( out, (int)solver, validate_solver_names[solver], cells[1],
                               is_implicit ? of_implicit : of_xpbd );
        put_plate_cells( out, solver, VALIDATE_MESH_IN_TURN, cells, substeps );
        put_plate_cells( out, solver, VALIDATE_MESH_IRREGULAR, fewer, substeps );
        if ( !( (const validate_settings*)out->context )->is_quick )
        {
            put_plate_cells( out, solver, VALIDATE_MESH_ONE_WAY, fewer, substeps );
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

// The case has a name of a measure for each width.
static wisp_status weigh_plates( accuracy_scene* out, bool is_sideways, const double* widths, wisp_error* error )
{
    plates* own = validate_own( out->context );
    const bool is_quick = ( (const validate_settings*)out->context )->is_quick;
    *own = ( plates ){ .is_sideways = is_sideways, .width_count = out->measure_count - ( is_quick ? 1 : 0 ) };
    int at = snprintf( out->reference, sizeof out->reference, "plate of Kirchhoff, by Ritz; G =" );
    for ( int i = 0; i < own->width_count; ++i )
    {
        own->widths[i] = widths[i];
        own->theory[i] =
            plate_theory_load( widths[i], POISSON_BENDING, plate_theory_isotropic( POISSON_PLANE ), is_sideways );
        WISP_TRY( isnan( own->theory[i] ) ? wisp_fail( error, WISP_NO_MEMORY, "no memory for a theory" ) : WISP_OK );
        at += snprintf( out->reference + at, sizeof out->reference - (size_t)at, " %.2f (W = %g L)", own->theory[i],
                        widths[i] );
    }
    out->measure_names[own->width_count] = "sag in the plane, % of L";
    out->measure_count = own->width_count + 1;
    out->note = NOTE;
    return WISP_OK;
}

static wisp_status weigh_level_plates( accuracy_scene* out, wisp_error* error )
{
    static const double widths[] = { 0.05, 0.25, 0.5, 1.0 };
    return weigh_plates( out, true, widths, error );
}

static wisp_status weigh_upright_plates( accuracy_scene* out, wisp_error* error )
{
    static const double widths[] = { 0.25, 1.0, 2.0 };
    return weigh_plates( out, false, widths, error );
}

const validate_case validate_lateral_buckling = {
    .name = "lateral_buckling",
    .title = "level plates on edge turn aside under their own weight",
    .scene = { .error_name = "distance of critical loads, root mean square",
               .error_unit = "%",
               .measure_names = { "G, W = 0.05 L", "G, W = 0.25 L", "G, W = 0.5 L", "G, W = L" },
               .measure_count = 4,
               .uncertainty = UNCERTAINTY,
               .run = run_plates },
    .own_size = sizeof( plates ),
    .prepare = weigh_level_plates,
    .put = put_plates,
};

const validate_case validate_plate_column = {
    .name = "plate_column",
    .title = "upright plates give way under their own weight",
    .scene = { .error_name = "distance of critical loads, root mean square",
               .error_unit = "%",
               .measure_names = { "G, W = 0.25 L", "G, W = L", "G, W = 2 L" },
               .measure_count = 3,
               .uncertainty = UNCERTAINTY,
               .run = run_plates },
    .own_size = sizeof( plates ),
    .prepare = weigh_upright_plates,
    .put = put_plates,
};
