// Cloth of Noh and Jung without a ball: accuracy, finer meshes and energy.
#include "figures_drape.h"

#include "bench_output.h"
#include "suite_study.h"

#include "oracle/triangle_oracle.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- cloth that hangs ----

// Cloth of Noh and Jung without a ball: it hangs, and its shape after a time is compared.

// Where it is held.
typedef enum hang_form
{
    HANG_SIDE,    // along the side of least z
    HANG_CORNERS, // by that side's two ends
    HANG_ROUND,   // along all four sides
} hang_form;

typedef struct hang_plan
{
    hang_form form;
    bool is_upright; // hangs straight down at the start; else it is level, and swings
    wisp_implicit_cloth_def cloth;
    float seconds; // a step
    int steps;
} hang_plan;

typedef struct hang_result
{
    wisp_vec3* points;     // [vertex_count] at the end, the caller's to free
    double iterations, ms; // of all steps together
} hang_result;

static bool is_held( hang_form form, wisp_vec3 p )
{
    const float edge = 0.5f * TRIANGLE_WIDTH - 1e-4f;
    const bool is_side = p.z<-edge, is_end = fabsf( p.x )> edge;
    switch ( form )
    {
        case HANG_SIDE:
            return is_side;
        case HANG_CORNERS:
            return is_side && is_end;
        case HANG_ROUND:
            break;
    }
    return is_end || fabsf( p.z ) > edge;
}

// @param pins [vertex_count] @return how many
static int find_pins( const wisp_mesh* mesh, hang_form form, int32_t* pins )
{
    int count = 0;
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        if ( is_held( form, mesh->points[i] ) )
        {
            pins[count++] = i;
        }
    }
    return count;
}

// Turned about the side that is held.
static void put_upright( const wisp_mesh* mesh, wisp_vec3* points )
{
    const float half = 0.5f * TRIANGLE_WIDTH;
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        const wisp_vec3 p = mesh->points[i];
        points[i] = ( wisp_vec3 ){ p.x, p.y - ( p.z + half ), -half };
    }
}

static wisp_status advance_hanging( surface_implementation* implementation, int steps, hang_result* out,
                                    wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < steps && status == WISP_OK; ++i )
    {
        wisp_implicit_cloth_stats seen = { 0 };
        const double begin = wisp_clock_seconds();
        status = surface_implementation_step( implementation, error );
        out->ms += 1e3 * ( wisp_clock_seconds() - begin );
        if ( status == WISP_OK &&
             wisp_read_implicit_cloth_stats( implementation->world, implementation->entity, &seen ) != WISP_OK )
        {
            status = bench_world_fail( implementation->world, WISP_CONFLICT, error );
        }
        out->iterations += seen.iterations;
    }
    return status;
}

static wisp_status run_hanging( const triangle_scene* scene, const triangle_setting* setting, int steps,
                                hang_result* out, wisp_error* error )
{
    surface_implementation implementation;
    wisp_status status = triangle_enter( scene, setting, &implementation, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const wisp_vec3* points;
    status = advance_hanging( &implementation, steps, out, error );
    status = status == WISP_OK ? surface_implementation_points( &implementation, &points, error ) : status;
    if ( status == WISP_OK )
    {
        memcpy( out->points, points, (size_t)scene->mesh.vertex_count * sizeof( wisp_vec3 ) );
    }
    surface_implementation_destroy( &implementation );
    return status;
}

static wisp_status hang_run( const triangle_scene* scene, const hang_plan* plan, hang_result* out, wisp_error* error )
{
    const size_t count = (size_t)scene->mesh.vertex_count;
    int32_t* pins = malloc( count * sizeof( int32_t ) );
    wisp_vec3* start = malloc( count * sizeof( wisp_vec3 ) );
    *out = ( hang_result ){ .points = malloc( count * sizeof( wisp_vec3 ) ) };
    wisp_status status = WISP_OK;
    if ( pins == NULL || start == NULL || out->points == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a cloth that hangs" );
    }
    else
    {
        triangle_setting setting = triangle_default_setting();
        put_upright( &scene->mesh, start );
        setting.cloth = plan->cloth;
        setting.seconds = plan->seconds;
        setting.requests_stats = true;
        setting.has_ball = false;
        setting.points = plan->is_upright ? start : NULL;
        setting.pins = pins;
        setting.pin_count = find_pins( &scene->mesh, plan->form, pins );
        status = run_hanging( scene, &setting, plan->steps, out, error );
    }
    free( pins );
    free( start );
    if ( status != WISP_OK )
    {
        free( out->points );
        out->points = NULL;
    }
    return status;
}

// ---- accuracy of a step ----

// Measure the cost of the accuracy of a step (extension, not in Noh and Jung): the suites in data/suites/figures, and what their rows
// must keep.

#define SUITE_SECONDS 2.0 // of both: errors are the same in every run

// @return mm, NaN: there is no such row
static double value_of( const results* all, const char* suite, const char* variant, const char* value )
{
    for ( int i = 0; i < all->row_count; ++i )
    {
        if ( strcmp( all->rows[i].name, suite ) == 0 && strcmp( all->rows[i].variant, variant ) == 0 )
        {
            return rows_error( &all->rows[i], value );
        }
    }
    return NAN;
}

#define DISTANCE "RMS_distance_to_the_reference_mm"

static double to_fine( const results* all, const char* variant )
{
    return value_of( all, "accuracy.step", variant, DISTANCE );
}

static double to_exact( const results* all, const char* variant )
{
    return value_of( all, "accuracy.tolerance", variant, DISTANCE );
}

// The default tolerance, 1e-4, should not be what limits a step. Tighter ones differ by roundings of floats.
static void check_tolerance( figures_case* page )
{
    static const char* const rows[] = { "euler, 0.01 s, tolerance=1e-2", "euler, 0.01 s, tolerance=1e-3",
                                        "euler, 0.01 s, tolerance=1e-4", "euler, 0.01 s, tolerance=1e-5",
                                        "euler, 0.01 s, tolerance=1e-6" };
    double exact[WISP_COUNT( rows )], most = 0.0;
    for ( int i = 0; i < WISP_COUNT( rows ); ++i )
    {
        exact[i] = to_exact( page->out, rows[i] );
        most = i < 2 || exact[i] <= most ? most : exact[i]; // a NaN stays
    }
    const double own = to_fine( page->out, rows[4] );
    figures_add( page, "Accuracy (extension)", "tolerance of a solve from 1e-2 to 1e-6, step 0.01 s",
                 "from 1e-4 on a solve adds less than a hundredth of the step's own error",
                 most < 0.01 * own && exact[2] < exact[0], "%.2f, %.3f, %.3f, %.3f, %.3f mm against %.1f mm",
                 exact[0], exact[1], exact[2], exact[3], exact[4], own );
}

static void check_solves( figures_case* page )
{
    const double fine[] = { to_fine( page->out, "euler, 0.01 s, tolerance=1e-6" ),
                            to_fine( page->out, "euler, 0.01 s, tolerance 1e-6, newton_iterations=2" ),
                            to_fine( page->out, "euler, 0.01 s, tolerance 1e-6, newton_iterations=4" ) };
    figures_add( page, "Accuracy (extension)", "1, 2 and 4 solves per step, step 0.01 s, tolerance 1e-6",
                 "the second helps, the fourth changes less than a tenth of that",
                 fine[1] < fine[0] && fabs( fine[2] - fine[1] ) < 0.1 * ( fine[0] - fine[1] ),
                 "%.2f, %.2f, %.2f mm from the fine run", fine[0], fine[1], fine[2] );
}

// Quick runs have the coarsest and the middle step of each series. What BDF2 leaves to Euler is no step of its own.
static void check_steps( figures_case* page )
{
    const results* all = page->out;
    const double euler[] = { to_fine( all, "euler, dt=0.02" ), to_fine( all, "euler, dt=0.005" ) };
    const double bdf2[] = { to_fine( all, "bdf2, dt=0.01" ), to_fine( all, "bdf2, dt=0.0025" ) };
    const double order1 = log2( euler[0] / euler[1] ) / 2.0, order2 = log2( bdf2[0] / bdf2[1] ) / 2.0;
    const double left = value_of( all, "accuracy.step", "bdf2, dt=0.01", "left_to_euler" ) +
                        value_of( all, "accuracy.step", "bdf2, dt=0.0025", "left_to_euler" );
    figures_add(
        page, "Accuracy (extension)", "steps of 0.02 to 0.0025 s, Euler and BDF2",
        "errors fall with orders near 1 and 2 (above 0.9 and 1.7); BDF2 is nearer and leaves no step to Euler",
        left == 0.0 && bdf2[0] < to_fine( all, "euler, 0.01 s, tolerance=1e-4" ) && bdf2[1] < euler[1] &&
            order1 > 0.9 && order2 > 1.7,
        "orders %.2f and %.2f; %.2f to %.3f mm, and %.3f to %.3f mm; %.0f left", order1, order2, euler[0], euler[1],
        bdf2[0], bdf2[1], left );
}

wisp_status figures_hang_accuracy( figures_case* page, wisp_error* error )
{
    static const char* const names[] = { "step", "tolerance" };
    const bench_options options = { .quick = page->quick, .workers = 1 };
    const wisp_status status =
        suite_bench_names( "figures", names, WISP_COUNT( names ), SUITE_SECONDS, &options, page->out, error );
    if ( status == WISP_OK )
    {
        check_tolerance( page );
        check_solves( page );
        check_steps( page );
    }
    return status;
}

// ---- finer meshes ----

// Check that a finer mesh stays the same cloth (extension, not in Noh and Jung). Stiffness that belongs to the sheet
// gives each link its share; stiffness that belongs to links does not.

enum
{
    MESH_COUNT = 3,
    QUICK_MESHES = 2,
    ROUND_HELD = 0, // of the forms below
    STIFF_HELD,
    CORNERS_HELD,
    SIDE_HELD,
    HELD_COUNT,
    SAG_STEPS = 200, // of 0.01 s: the energy that is left is below 1e-7 J
};

static const int sag_sizes[MESH_COUNT] = { 250, 1000, 4000 };

// Rigid enough that no arc gives way, or as cloth is.
#define STIFF_RIGIDITY 5e-2f // N m, of `sheet`
#define STIFF_BENDING 1e-2f  // N m^2, of `link`

static const struct
{
    hang_form form;
    bool is_stiff;
    const char *name, *measured;
} forms[HELD_COUNT] = {
    [ROUND_HELD] = { HANG_ROUND, false, "all round, level", "middle" },
    [STIFF_HELD] = { HANG_SIDE, true, "one side, D 5e-2 N m", "lower side" },
    [CORNERS_HELD] = { HANG_CORNERS, false, "two corners", "upper side" },
    [SIDE_HELD] = { HANG_SIDE, false, "one side", "lower side" },
};

typedef struct sag_row
{
    double sag[MESH_COUNT]; // m
    double iterations, ms;  // a step of the finest mesh
    int count;
} sag_row;

// How far down gravity has drawn it: the lowest place of what is held, or the mean of the side across.
static double sag_of( const wisp_mesh* mesh, const wisp_vec3* points, hang_form form )
{
    const double edge = 0.5 * (double)TRIANGLE_WIDTH - 1e-4;
    double most = 0.0, sum = 0.0;
    int count = 0;
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        const double down = (double)TRIANGLE_HEIGHT - (double)points[i].y, z = (double)mesh->points[i].z;
        if ( form == HANG_ROUND || ( form == HANG_CORNERS && z < -edge ) )
        {
            most = fmax( most, down );
        }
        if ( z > edge )
        {
            sum += down - (double)TRIANGLE_WIDTH;
            ++count;
        }
    }
    return form == HANG_SIDE ? sum / count : most;
}

static wisp_status hang_all( const triangle_scene* scenes, int count, int which, wisp_implicit_stiffness stiffness,
                             sag_row* out, wisp_error* error )
{
    const hang_form form = forms[which].form;
    *out = ( sag_row ){ .count = count };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        hang_plan plan = {
            .form = form,
            .is_upright = form != HANG_ROUND,
            .cloth = triangle_default_setting().cloth,
            .seconds = 0.01f,
            .steps = SAG_STEPS,
        };
        plan.cloth.stiffness_model = stiffness;
        plan.cloth.weights = WISP_IMPLICIT_WEIGHTS_NONE;
        plan.cloth.bend_rigidity = forms[which].is_stiff ? STIFF_RIGIDITY : plan.cloth.bend_rigidity;
        plan.cloth.bend_stiffness = forms[which].is_stiff ? STIFF_BENDING : plan.cloth.bend_stiffness;
        hang_result result;
        status = hang_run( &scenes[i], &plan, &result, error );
        if ( status == WISP_OK )
        {
            out->sag[i] = sag_of( &scenes[i].mesh, result.points, form );
            out->iterations = result.iterations / SAG_STEPS;
            out->ms = result.ms / SAG_STEPS;
            free( result.points );
        }
    }
    return status;
}

// Of the sag of the finest.
static double change( const sag_row* row, int from )
{
    return row->sag[from] / row->sag[row->count - 1] - 1.0;
}

// ---- the page ----

static int begin_sag_table( figures_case* page, int count )
{
    results_cells header = { .count = 0 };
    cells_put( &header, "held\tsag of\tstiffness" );
    for ( int i = 0; i < count; ++i )
    {
        cells_put( &header, "%d mm", sag_sizes[i] );
    }
    for ( int i = 0; i + 1 < count; ++i )
    {
        cells_put( &header, "%d %%", sag_sizes[i] );
    }
    cells_put( &header, "iterations\tms per step" );
    return cells_begin_table( &header,
                              "Finer meshes: the sag by number of vertices, k_s 200 N/m, D 5e-6 N m unless stated "
                              "(extension, not in Noh and Jung)",
                              page->out );
}

static void add_sag_line( figures_case* page, int table, int form, wisp_implicit_stiffness stiffness,
                          const sag_row* row )
{
    results_cells line = { .count = 0 };
    cells_put( &line, "%s\t%s\t%s", forms[form].name, forms[form].measured,
               stiffness == WISP_IMPLICIT_STIFFNESS_MATERIAL ? "sheet" : "link" );
    for ( int i = 0; i < row->count; ++i )
    {
        cells_put( &line, "%.2f", 1e3 * row->sag[i] );
    }
    for ( int i = 0; i + 1 < row->count; ++i )
    {
        cells_put( &line, "%+.1f", 100.0 * change( row, i ) );
    }
    cells_put( &line, "%.1f\t%.2f", row->iterations, row->ms );
    cells_end_row( &line, table, page->out );
}

// Of the finest.
static double largest_change( const sag_row* row )
{
    double most = 0.0;
    for ( int i = 0; i + 1 < row->count; ++i )
    {
        most = fmax( most, fabs( change( row, i ) ) );
    }
    return most;
}

// No link is pressed where a cloth is pulled both ways, or arcs do not give way: this is what the shares are made
// for.
static void add_pulled_rows( figures_case* page, const sag_row* sheet, const sag_row* link )
{
    const int finest = sheet[ROUND_HELD].count - 1;
    figures_add( page, "Finer meshes (extension)", "`sheet`, level, held all round, 250 vertices and more",
                 "sags within 3 % of each other", largest_change( &sheet[ROUND_HELD] ) < 0.03,
                 "%.2f to %.2f mm, %.1f %% apart; with `link` %.1f %%", 1e3 * sheet[ROUND_HELD].sag[0],
                 1e3 * sheet[ROUND_HELD].sag[finest], 100.0 * largest_change( &sheet[ROUND_HELD] ),
                 100.0 * largest_change( &link[ROUND_HELD] ) );

    // rho g L^2 / (2 k_s) of a strip that may narrow; the side that is held may not
    const double side = (double)TRIANGLE_WIDTH,
                 stiffness = (double)wisp_default_implicit_cloth_def().stretch_stiffness;
    const double strip = (double)TRIANGLE_DENSITY * (double)TRIANGLE_GRAVITY * side * side / ( 2.0 * stiffness );
    const double apart = sheet[STIFF_HELD].sag[finest] / strip - 1.0;
    figures_add_known( page, "Finer meshes (extension)",
                       "`sheet`, hung by one side, diagonals that do not give way (D 5e-2 N m)",
                       "sags within 5 % of each other, and within 15 % of a strip's in closed form",
                       largest_change( &sheet[STIFF_HELD] ) < 0.05 && fabs( apart ) < 0.15,
                       "%.2f to %.2f mm, at most %.1f %% apart; strip %.2f mm, %+.1f %%; with `link` %.1f %%",
                       1e3 * sheet[STIFF_HELD].sag[0], 1e3 * sheet[STIFF_HELD].sag[finest],
                       100.0 * largest_change( &sheet[STIFF_HELD] ), 1e3 * strip, 100.0 * apart,
                       100.0 * largest_change( &link[STIFF_HELD] ) );
}

// Edges take no pressure. A cloth that is pulled one way narrows until its diagonals hold it, and a short arc holds
// more.
static void add_narrow_rows( figures_case* page, const sag_row* sheet, const sag_row* link )
{
    const sag_row *corners = &sheet[CORNERS_HELD], *limp = &sheet[SIDE_HELD];
    figures_add_known( page, "Finer meshes (extension)", "`sheet`, hung by two corners, 1000 and 4000 vertices",
                       "sags within 5 % of each other", fabs( change( corners, 1 ) ) < 0.05,
                       "%.1f and %.1f mm, %+.1f %%; with `link` %.1f and %.1f mm", 1e3 * corners->sag[1],
                       1e3 * corners->sag[2], 100.0 * change( corners, 1 ), 1e3 * link[CORNERS_HELD].sag[1],
                       1e3 * link[CORNERS_HELD].sag[2] );
    results_add_note( page->out,
                      "Finer meshes, more than a few percent from 4000 vertices: hung by two corners 250 (%+.1f %%); "
                      "hung by one side 250 and 1000 (%+.1f %%, %+.1f %%).",
                      100.0 * change( corners, 0 ), 100.0 * change( limp, 0 ), 100.0 * change( limp, 1 ) );
    results_add_note( page->out, "Finer meshes: edges take no pressure, so a pulled cloth narrows until its "
                                 "diagonals hold it, and how much they hold depends on their length." );
}

wisp_status figures_hang_refined( figures_case* page, wisp_error* error )
{
    const int count = page->quick ? QUICK_MESHES : MESH_COUNT;
    triangle_scene scenes[MESH_COUNT] = { { .fabric = NULL } };
    sag_row sheet[HELD_COUNT], link[HELD_COUNT];
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        status = triangle_scene_make( sag_sizes[i], &scenes[i], error );
    }
    const int table = begin_sag_table( page, count );
    for ( int i = 0; i < ( page->quick ? CORNERS_HELD : HELD_COUNT ) && status == WISP_OK; ++i )
    {
        status = hang_all( scenes, count, i, WISP_IMPLICIT_STIFFNESS_MATERIAL, &sheet[i], error );
        status =
            status == WISP_OK ? hang_all( scenes, count, i, WISP_IMPLICIT_STIFFNESS_LINK, &link[i], error ) : status;
        if ( status == WISP_OK )
        {
            add_sag_line( page, table, i, WISP_IMPLICIT_STIFFNESS_MATERIAL, &sheet[i] );
            add_sag_line( page, table, i, WISP_IMPLICIT_STIFFNESS_LINK, &link[i] );
        }
    }
    if ( status == WISP_OK )
    {
        add_pulled_rows( page, sheet, link );
        if ( count == MESH_COUNT )
        {
            add_narrow_rows( page, sheet, link );
        }
    }
    for ( int i = 0; i < count; ++i )
    {
        triangle_scene_free( &scenes[i] );
    }
    return status;
}

// ---- energy of a free cloth ----

// Noh and Jung, section 3.3: a cloth that is stretched, spins and flies free. What is conserved is the energy of the
// rows: their masses, the stretch of eq. 5 and the potential of eq. 12. The implicit step and damping may only take
// from it.

enum
{
    SECONDS = 10,
    QUICK_VERTICES = 250,
};

#define STRETCHED 1.1f
// Allowed rise above the least energy so far. Against the first nothing could rise: three quarters of it go in one step.
#define GROWTH_ALLOWED 0.01

static const wisp_vec3 spin = { 1.0f, 4.0f, 0.5f }; // rad/s

typedef struct flight
{
    float damping; // N s/m
    float seconds; // a step
    wisp_integrator integrator;
    double first, last;           // J, before and at the end
    double growth;                // the most that it ever was above the least before, as a fraction of that
    double observations[SECONDS]; // J, after each second
    double iterations, solves;    // a step, mean
    bool is_finite;
} flight;

typedef struct free_cloth
{
    triangle_scene scene;
    wisp_vec3* stretched; // [vertex_count]
    double* fraction;     // [vertex_count] of a row's mass in the vertex's
} free_cloth;

// ---- the masses of the rows ----

static wisp_status count_neighbours( const wisp_mesh* mesh, double* fraction, wisp_error* error )
{
    const size_t count = (size_t)mesh->vertex_count;
    double3* points = malloc( count * sizeof( double3 ) );
    double* masses = malloc( count * sizeof( double ) );
    wisp_status status = WISP_OK;
    if ( points == NULL || masses == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a cloth that flies" );
    }
    else
    {
        for ( size_t i = 0; i < count; ++i )
        {
            points[i] =
                ( double3 ){ (double)mesh->points[i].x, (double)mesh->points[i].y, (double)mesh->points[i].z };
            masses[i] = 1.0;
        }
        const triangle_oracle_params params = triangle_oracle_default_params();
        const triangle_oracle_def def = {
            .count = mesh->vertex_count,
            .points = points,
            .triangle_count = mesh->triangle_count,
            .triangles = mesh->triangles,
            .masses = masses,
        };
        triangle_oracle oracle = triangle_oracle_create( &def, &params );
        for ( size_t i = 0; i < count; ++i )
        {
            fraction[i] = oracle.mass[i];
        }
        triangle_oracle_destroy( &oracle );
    }
    free( points );
    free( masses );
    return status;
}

static double kinetic_energy( surface_implementation* implementation, const double* fraction )
{
    const wisp_fabric* fabric = implementation->fabric;
    const float* position =
        wisp_world_column( implementation->world, implementation->entity, WISP_PARTICLE_POSITION, 0 );
    const float* velocity =
        wisp_world_column( implementation->world, implementation->entity, WISP_PARTICLE_VELOCITY, 0 );
    double sum = 0.0;
    for ( int i = 0; i < fabric->vertex_count; ++i )
    {
        const size_t row = 4 * (size_t)fabric->vertex_slot[i];
        const double v[3] = { (double)velocity[row], (double)velocity[row + 1], (double)velocity[row + 2] };
        sum += 0.5 * fraction[i] / (double)position[row + 3] * ( v[0] * v[0] + v[1] * v[1] + v[2] * v[2] );
    }
    return sum;
}

// Every edge is a tenth longer than at rest, so that no diagonal bends.
static double stretch_energy_at_first( const wisp_fabric* fabric, double stiffness )
{
    double sum = 0.0;
    for ( int e = 0; e < fabric->edge_count; ++e )
    {
        const wisp_vec3 a = fabric->rest[fabric->edges[2 * e]], b = fabric->rest[fabric->edges[2 * e + 1]];
        const double d[3] = { (double)a.x - (double)b.x, (double)a.y - (double)b.y, (double)a.z - (double)b.z };
        const double over = (double)STRETCHED - 1.0;
        sum += 0.5 * stiffness * over * over * ( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] );
    }
    return sum;
}

// ---- flights ----

static wisp_status advance_free( surface_implementation* implementation, const double* fraction, flight* f,
                                 wisp_error* error )
{
    const int steps = (int)lrint( SECONDS / (double)f->seconds );
    double least = f->first;
    for ( int step = 1; step <= steps; ++step )
    {
        wisp_implicit_cloth_stats seen;
        wisp_status status = surface_implementation_step( implementation, error );
        if ( status != WISP_OK )
        {
            return status;
        }
        status = wisp_read_implicit_cloth_stats( implementation->world, implementation->entity, &seen );
        if ( status != WISP_OK )
        {
            return bench_world_fail( implementation->world, status, error );
        }
        f->last = kinetic_energy( implementation, fraction ) + seen.stretch_energy + seen.bend_energy;
        f->growth = fmax( f->growth, f->last / least - 1.0 );
        least = fmin( least, f->last );
        f->is_finite = f->is_finite && isfinite( f->last ) && implementation->halted_at == 0;
        f->iterations += (double)seen.iterations / steps;
        f->solves += (double)seen.newton_iterations / steps;
        if ( step * SECONDS % steps == 0 )
        {
            f->observations[step * SECONDS / steps - 1] = f->last;
        }
    }
    return WISP_OK;
}

static wisp_status fly_free( const free_cloth* cloth, flight* f, wisp_error* error )
{
    f->is_finite = true;
    triangle_setting setting = triangle_default_setting();
    setting.cloth.link_damping = f->damping;
    setting.cloth.integrator = f->integrator;
    setting.seconds = f->seconds;
    setting.has_ball = false;
    setting.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    setting.points = cloth->stretched;
    setting.requests_stats = true;
    surface_implementation implementation;
    wisp_status status = triangle_enter( &cloth->scene, &setting, &implementation, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status =
        wisp_set_velocity( implementation.world, implementation.entity, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, spin );
    if ( status == WISP_OK )
    {
        f->first = kinetic_energy( &implementation, cloth->fraction ) +
                   stretch_energy_at_first( cloth->scene.fabric, (double)setting.cloth.stretch_stiffness );
        status = advance_free( &implementation, cloth->fraction, f, error );
    }
    else
    {
        bench_world_fail( implementation.world, status, error );
    }
    surface_implementation_destroy( &implementation );
    return status;
}

static void free_cloth_free( free_cloth* cloth )
{
    free( cloth->stretched );
    free( cloth->fraction );
    triangle_scene_free( &cloth->scene );
}

static wisp_status free_cloth_make( int vertices, free_cloth* out, wisp_error* error )
{
    *out = ( free_cloth ){ .stretched = NULL };
    wisp_status status = triangle_scene_make( vertices, &out->scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const wisp_mesh* mesh = &out->scene.mesh;
    out->stretched = malloc( (size_t)mesh->vertex_count * sizeof( wisp_vec3 ) );
    out->fraction = malloc( (size_t)mesh->vertex_count * sizeof( double ) );
    if ( out->stretched == NULL || out->fraction == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a cloth that flies" );
    }
    else
    {
        for ( int i = 0; i < mesh->vertex_count; ++i )
        {
            const wisp_vec3 p = mesh->points[i];
            out->stretched[i] = ( wisp_vec3 ){ STRETCHED * p.x, p.y, STRETCHED * p.z };
        }
        status = count_neighbours( mesh, out->fraction, error );
    }
    if ( status != WISP_OK )
    {
        free_cloth_free( out );
    }
    return status;
}

// ---- the page ----

enum
{
    EULER_COUNT = 4, // the first flights: in steps of the paper, with more and more damping
    QUICK_COUNT = 6,
    FLIGHT_COUNT = 10,
};

static int begin_energy_table( figures_case* page )
{
    results_cells header = { .count = 0 };
    cells_put( &header, "k_d N s/m\tstep s\tintegrator\tfirst J" );
    for ( int i = 1; i <= SECONDS; i += 3 )
    {
        cells_put( &header, "%d s", i );
    }
    cells_put( &header, "growth %%\tsolves\titerations" );
    return cells_begin_table( &header, "Noh and Jung 3.3: energy in free flight, J", page->out );
}

static void add_energy_line( figures_case* page, int table, const flight* f )
{
    results_cells row = { .count = 0 };
    cells_put( &row, "%g\t%g\t%s\t%.3f", (double)f->damping, (double)f->seconds,
               f->integrator == WISP_INTEGRATOR_EULER ? "Euler" : "BDF2", f->first );
    for ( int i = 1; i <= SECONDS; i += 3 )
    {
        cells_put( &row, "%.2e", f->observations[i - 1] );
    }
    cells_put( &row, "%.2f\t%.2f\t%.1f", 100.0 * f->growth, f->solves, f->iterations );
    cells_end_row( &row, table, page->out );
}

static void add_energy_row( figures_case* page, int vertices, const flight* flights, int count )
{
    int worst = 0;
    bool is_finite = true, falls_faster = true;
    for ( int i = 0; i < count; ++i )
    {
        is_finite = is_finite && flights[i].is_finite;
        worst = flights[i].growth > flights[worst].growth ? i : worst;
        falls_faster = falls_faster && ( i == 0 || i >= EULER_COUNT || flights[i].last < flights[i - 1].last );
    }
    const flight* f = &flights[worst];
    char experiment[120];
    snprintf( experiment, sizeof( experiment ),
              "%d vertices stretched by 10 %%, spinning, free for 10 s, k_d 0 to 0.2, Euler and BDF2", vertices );
    figures_add( page, "Noh and Jung, sect. 3.3", experiment,
                 "energy never 1 % above its least so far; less is left with more damping",
                 is_finite && f->growth <= GROWTH_ALLOWED && falls_faster,
                 "at most %+.2f %% (k_d %g, steps of %g s, %s); %.1e, %.1e, %.1e, %.1e of the first left",
                 100.0 * f->growth, (double)f->damping, (double)f->seconds,
                 f->integrator == WISP_INTEGRATOR_EULER ? "Euler" : "BDF2", flights[0].last / flights[0].first,
                 flights[1].last / flights[1].first, flights[2].last / flights[2].first,
                 flights[3].last / flights[3].first );
}

wisp_status figures_free_flight( figures_case* page, wisp_error* error )
{
    flight flights[FLIGHT_COUNT] = {
        { .damping = 0.0f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_EULER },
        { .damping = 0.002f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_EULER },
        { .damping = 0.02f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_EULER },
        { .damping = 0.2f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_EULER },
        { .damping = 0.0f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_BDF2 },
        { .damping = 0.002f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_BDF2 },
        { .damping = 0.02f, .seconds = 0.01f, .integrator = WISP_INTEGRATOR_BDF2 },
        { .damping = 0.002f, .seconds = 0.0025f, .integrator = WISP_INTEGRATOR_EULER },
        { .damping = 0.0f, .seconds = 0.025f, .integrator = WISP_INTEGRATOR_EULER },
        { .damping = 0.0f, .seconds = 0.05f, .integrator = WISP_INTEGRATOR_EULER }, // stiff
    };
    const int vertices = page->quick ? QUICK_VERTICES : TRIANGLE_VERTICES;
    free_cloth cloth;
    wisp_status status = free_cloth_make( vertices, &cloth, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const int table = begin_energy_table( page );
    const int count = page->quick ? QUICK_COUNT : FLIGHT_COUNT;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        status = fly_free( &cloth, &flights[i], error );
        if ( status == WISP_OK )
        {
            add_energy_line( page, table, &flights[i] );
        }
    }
    if ( status == WISP_OK )
    {
        add_energy_row( page, vertices, flights, count );
        results_add_note( page->out,
                          "Noh and Jung, section 3.3, energy: kinetic with the masses of the rows, stretch (eq. 5) "
                          "and bend (eq. 12). growth: above the least so far. solves and iterations: per step." );
    }
    free_cloth_free( &cloth );
    return status;
}
