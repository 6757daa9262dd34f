// A strip of one row of cells, or a strand, hung between two supports: its rest is the catenary.
#include "validate_motion.h"

#include "oracle/sheet_theory.h"
#include "surface_implementation.h"
#include "validate_settings.h"
#include "validate_sheets.h"

#include <math.h>

#define SPAN 0.8 // m, of a strip of 1 m

enum
{
    MAX_CELLS = 64,
    STEPS = 240, // some 20 periods of the slowest swing, with its critical damping
};

static const double DAMPING = 12.0; // 1/s

// Distances from the point of the curve at the same arc length, in % of the span.
static void compare( const wisp_vec3* points, int count, int cells, accuracy_run* out )
{
    double sum = 0.0, lowest = 0.0;
    for ( int v = 0; v < count; ++v )
    {
        double exact[2];
        sheet_catenary( SPAN, (double)( v % ( cells + 1 ) ) / cells, exact );
        const double x = (double)points[v].x - exact[0], y = (double)points[v].y - exact[1];
        sum += x * x + y * y;
        lowest = fmin( lowest, (double)points[v].y );
    }
    double middle[2];
    sheet_catenary( SPAN, 0.5, middle );
    out->error = 100.0 * sqrt( sum / count ) / SPAN;
    out->measures[0] = -100.0 * lowest;
    out->measures[1] = -100.0 * middle[1];
}

static wisp_status measure( validate_world* world, int cells, accuracy_run* out, wisp_error* error )
{
    const wisp_vec3* points = NULL;
    wisp_motion_stats motion = { 0 };
    wisp_status status = validate_world_points( world, 0, &points, error );
    status = status == WISP_OK ? validate_world_motion( world, 0, &motion, error ) : status;
    if ( status == WISP_OK )
    {
        compare( points, world->bodies[0].vertex_count, cells, out );
        out->measures[2] = 100.0 * motion.strain_max;
        out->measures[3] = 1e3 * motion.speed_max;
    }
    return status;
}

// Half of the strip over half of the span, a right triangle.
static void lay_halves( const wisp_mesh* mesh, int cells, wisp_vec3* out )
{
    const double depth = sqrt( 0.25 - 0.25 * SPAN * SPAN );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        const double t = (double)( v % ( cells + 1 ) ) / cells;
        out[v] = ( wisp_vec3 ){ (float)( SPAN * ( t - 0.5 ) ), (float)( -2.0 * depth * fmin( t, 1.0 - t ) ),
                                mesh->points[v].z };
    }
}

static wisp_status hang( const validate_setting* setting, bool is_observed, validate_world* world, wisp_error* error )
{
    const int cells = setting->cells;
    const int32_t pins[] = { 0, cells, cells + 1, 2 * cells + 1 };
    wisp_mesh mesh = { .points = NULL };
    wisp_vec3 start[2 * ( MAX_CELLS + 1 )];
    wisp_status status = surface_plane( cells + 1, 2, 1.0 / cells, &mesh, error );
    if ( status == WISP_OK )
    {
        lay_halves( &mesh, cells, start );
        const sheet_def def = {
            .solver = (sheet_solver)setting->solver,
            .mesh = &mesh,
            .row = cells + 1,
            .start = start,
            .pins = pins,
            .pin_count = WISP_COUNT( pins ),
            .density = SHEET_DENSITY,
            .damping = DAMPING,
            .gravity = { 0.0f, (float)-SHEET_GRAVITY, 0.0f },
            .friction = -1.0,
        };
        status = sheet_add( world, &def, is_observed, error );
    }
    wisp_mesh_release( &mesh );
    return status;
}

static wisp_status run( void* context, int index, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    const validate_setting* setting = validate_setting_of( context, index );
    validate_world world;
    wisp_status status =
        sheet_world_create( (sheet_solver)setting->solver, setting->substeps, workers, false, &world, error );
    status = status == WISP_OK ? hang( setting, is_observed, &world, error ) : status;
    status = status == WISP_OK ? validate_world_step( &world, STEPS, out, error ) : status;
    status = status == WISP_OK && is_observed ? measure( &world, setting->cells, out, error ) : status;
    status = status == WISP_OK ? validate_world_finish( &world, out, error ) : status;
    validate_world_release( &world );
    return status;
}

wisp_status validate_catenary( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)options;
    (void)seconds;
    static const int solvers[] = { SHEET_STRANDS, SHEET_XPBD, SHEET_IMPLICIT };
    static const int cells[] = { 8, 16, 32, 64 };
    const validate_grid grid = {
        .names = sheet_solver_names,
        .solvers = solvers,
        .solver_count = WISP_COUNT( solvers ),
        .cells = cells,
        .cell_count = WISP_COUNT( cells ),
        .substeps = 32,
        .halvings = 3,
        .middle = 32,
    };
    const accuracy_scene scene = {
        .reference = "the catenary; root mean square over vertices, after 4 s",
        .error_name = "distance from the catenary",
        .error_unit = "% of span",
        .measure_names = { "sag, % of L", "theory", "largest strain, %", "speed left, mm/s" },
        .measure_count = 4,
        .run = run,
    };
    return validate_make_grid( &grid, scene, out, error );
}
