// Measure the cost of the accuracy of a step (extension, not in Noh and Jung). A level cloth is held along one side
// and swings for half a second; then its vertices are compared with those of a run in much finer steps.
#include "figures_hang.h"

#include "cells.h"

#include <math.h>
#include <stdlib.h>

#define FLIGHT_SECONDS 0.5
#define STEP 0.01f // where nothing else is said
#define STEP_LONGEST 0.02f
#define MIN_TOLERANCE 1e-7f

enum
{
    TOLERANCE_COUNT = 5, // 1e-2 to 1e-6
    REPEAT_COUNT = 3,    // 1, 2, 4
    HALVING_COUNT = 5,   // 0.02 to 0.00125 s
    FINE_HALVING = 6,    // 0.0003125 s
    QUICK_VERTICES = 250,
};

typedef struct swing
{
    float seconds; // a step
    wisp_implicit_integrator integrator;
    int repeats;
    float tolerance;
} swing;

typedef struct distances
{
    double mean, most; // m, root of the mean square, and the largest
} distances;

// What a swing came to.
typedef struct outcome
{
    distances to_fine, to_exact;
    double first_order; // steps that BDF2 left to Euler
} outcome;

typedef struct swing_page
{
    figures_case* page;
    triangle_scene scene;
    hang_result fine;  // short steps of second order, solved twice
    hang_result exact; // the printed step of STEP, its system solved as well as floats allow
    int table;
} swing_page;

static wisp_status run( const triangle_scene* scene, const swing* how, hang_result* out, wisp_error* error )
{
    hang_plan plan = {
        .form = HANG_SIDE,
        .cloth = wisp_default_implicit_cloth_def(),
        .seconds = how->seconds,
        .steps = (int)lrint( FLIGHT_SECONDS / (double)how->seconds ),
    };
    plan.cloth.integrator = how->integrator;
    plan.cloth.newton_iterations = how->repeats;
    plan.cloth.tolerance = how->tolerance;
    return hang_run( scene, &plan, out, error );
}

static distances compare( const triangle_scene* scene, const hang_result* a, const hang_result* b )
{
    distances d = { 0.0, 0.0 };
    for ( int i = 0; i < scene->mesh.vertex_count; ++i )
    {
        const wisp_vec3 p = a->points[i], q = b->points[i];
        const double x = (double)p.x - (double)q.x, y = (double)p.y - (double)q.y, z = (double)p.z - (double)q.z;
        const double square = x * x + y * y + z * z;
        d.mean += square / scene->mesh.vertex_count;
        d.most = fmax( d.most, sqrt( square ) );
    }
    d.mean = sqrt( d.mean );
    return d;
}

// ---- the table ----

static int begin_table( figures_case* page, int vertices )
{
    static const char* const names[] = { "varied",     "integrator", "step s",       "solves",
                                         "tolerance",  "to fine mm", "most mm",      "to exact mm",
                                         "iterations", "ms in all",  "left to Euler" };
    char title[120];
    snprintf( title, sizeof( title ), "Accuracy of a step: cost of accuracy, %d vertices swinging for 0.5 s",
              vertices );
    cells header = { .count = 0 };
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        cells_put( &header, "%s", names[i] );
    }
    return cells_begin_table( &header, title, page->out );
}

// @param is_own the step is that of the exact run, to which it is compared too
static wisp_status add_line( swing_page* s, const char* varied, const swing* how, bool is_own, outcome* out,
                             wisp_error* error )
{
    hang_result result;
    wisp_status status = run( &s->scene, how, &result, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    *out = ( outcome ){ .to_fine = compare( &s->scene, &result, &s->fine ),
                        .to_exact = is_own ? compare( &s->scene, &result, &s->exact ) : ( distances ){ NAN, NAN },
                        .first_order = result.first_order };
    cells row = { .count = 0 };
    cells_put( &row, "%s", varied );
    cells_put( &row, "%s", how->integrator == WISP_IMPLICIT_EULER ? "Euler" : "BDF2" );
    cells_put( &row, "%g", (double)how->seconds );
    cells_put( &row, "%d", how->repeats );
    cells_put( &row, "%.0e", (double)how->tolerance );
    cells_put_number( &row, 1e3 * out->to_fine.mean, 3 );
    cells_put_number( &row, 1e3 * out->to_fine.most, 3 );
    cells_put_number( &row, 1e3 * out->to_exact.mean, 4 );
    cells_put_number( &row, result.iterations, 0 );
    cells_put_number( &row, result.ms, 0 );
    cells_put_number( &row, result.first_order, 0 );
    cells_end_row( &row, s->table, s->page->out );
    free( result.points );
    return WISP_OK;
}

// ---- what is varied ----

// The default tolerance, 1e-4, should not be what limits a step. Tighter ones differ by roundings of floats.
static wisp_status vary_tolerance( swing_page* s, wisp_error* error )
{
    enum
    {
        DEFAULT = 2,
    };
    outcome came[TOLERANCE_COUNT];
    double most = 0.0;
    wisp_status status = WISP_OK;
    float tolerance = 1e-2f;
    for ( int i = 0; i < TOLERANCE_COUNT && status == WISP_OK; ++i, tolerance *= 0.1f )
    {
        const swing how = { STEP, WISP_IMPLICIT_EULER, 1, tolerance };
        status = add_line( s, "tolerance", &how, true, &came[i], error );
        most = i < DEFAULT ? 0.0 : fmax( most, came[i].to_exact.mean );
    }
    if ( status == WISP_OK )
    {
        figures_add( s->page, "Accuracy (extension)", "tolerance of a solve from 1e-2 to 1e-6, step 0.01 s",
                     "from 1e-4 on a solve adds less than a hundredth of the step's own error",
                     most < 0.01 * came[TOLERANCE_COUNT - 1].to_fine.mean &&
                         came[DEFAULT].to_exact.mean < came[0].to_exact.mean,
                     "%.2f, %.3f, %.3f, %.3f, %.3f mm against %.1f mm", 1e3 * came[0].to_exact.mean,
                     1e3 * came[1].to_exact.mean, 1e3 * came[2].to_exact.mean, 1e3 * came[3].to_exact.mean,
                     1e3 * came[4].to_exact.mean, 1e3 * came[TOLERANCE_COUNT - 1].to_fine.mean );
    }
    return status;
}

static wisp_status vary_repeats( swing_page* s, wisp_error* error )
{
    outcome came[REPEAT_COUNT];
    wisp_status status = WISP_OK;
    for ( int i = 0; i < REPEAT_COUNT && status == WISP_OK; ++i )
    {
        const swing how = { STEP, WISP_IMPLICIT_EULER, 1 << i, 1e-6f };
        status = add_line( s, "solves", &how, true, &came[i], error );
    }
    if ( status == WISP_OK )
    {
        const double fine[REPEAT_COUNT] = { came[0].to_fine.mean, came[1].to_fine.mean, came[2].to_fine.mean };
        figures_add( s->page, "Accuracy (extension)", "1, 2 and 4 solves per step, step 0.01 s, tolerance 1e-6",
                     "the second helps, the fourth changes less than a tenth of that",
                     fine[1] < fine[0] && fabs( fine[2] - fine[1] ) < 0.1 * ( fine[0] - fine[1] ),
                     "%.2f, %.2f, %.2f mm from the fine run", 1e3 * fine[0], 1e3 * fine[1], 1e3 * fine[2] );
    }
    return status;
}

static wisp_status vary_step( swing_page* s, wisp_implicit_integrator integrator, outcome* came, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < HALVING_COUNT && status == WISP_OK; ++i )
    {
        const swing how = { STEP_LONGEST / (float)( 1 << i ), integrator, 1, 1e-4f };
        status = add_line( s, "step", &how, false, &came[i], error );
    }
    return status;
}

static wisp_status vary_steps( swing_page* s, wisp_error* error )
{
    outcome first[HALVING_COUNT], second[HALVING_COUNT];
    wisp_status status = vary_step( s, WISP_IMPLICIT_EULER, first, error );
    status = status == WISP_OK ? vary_step( s, WISP_IMPLICIT_BDF2, second, error ) : status;
    if ( status == WISP_OK )
    {
        // what is left to Euler is a step of Euler, so the order of BDF2 begins behind it
        const int last = HALVING_COUNT - 1;
        int own = 0;
        while ( own < last && second[own].first_order > 0.0 )
        {
            own += 1;
        }
        const double order1 = log2( first[0].to_fine.mean / first[last].to_fine.mean ) / last;
        const double order2 = log2( second[own].to_fine.mean / second[last].to_fine.mean ) / ( last - own );
        bool is_nearer = own < last;
        for ( int i = own; i <= last; ++i )
        {
            is_nearer = is_nearer && second[i].to_fine.mean < first[i].to_fine.mean && second[i].first_order == 0.0;
        }
        figures_add( s->page, "Accuracy (extension)", "steps of 0.02 to 0.00125 s, Euler and BDF2",
                     "errors fall with orders near 1 and 2 (above 0.9 and 1.7); BDF2 is nearer at every step that it "
                     "does not leave to Euler",
                     is_nearer && order1 > 0.9 && order2 > 1.7,
                     "orders %.2f and %.2f; %.2f to %.3f mm, and %.3f to %.3f mm; %d of %d left", order1, order2,
                     1e3 * first[0].to_fine.mean, 1e3 * first[last].to_fine.mean, 1e3 * second[own].to_fine.mean,
                     1e3 * second[last].to_fine.mean, own, HALVING_COUNT );
    }
    return status;
}

wisp_status figures_hang_accuracy( figures_case* page, wisp_error* error )
{
    const swing fine = { STEP_LONGEST / (float)( 1 << FINE_HALVING ), WISP_IMPLICIT_BDF2, 2, 1e-6f };
    const swing exact = { STEP, WISP_IMPLICIT_EULER, 1, MIN_TOLERANCE };
    const int vertices = page->quick ? QUICK_VERTICES : TRIANGLE_VERTICES;
    swing_page s = { .page = page };
    wisp_status status = triangle_scene_make( vertices, &s.scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    s.table = begin_table( page, vertices );
    status = run( &s.scene, &fine, &s.fine, error );
    status = status == WISP_OK ? run( &s.scene, &exact, &s.exact, error ) : status;
    status = status == WISP_OK ? vary_tolerance( &s, error ) : status;
    status = status == WISP_OK ? vary_repeats( &s, error ) : status;
    status = status == WISP_OK ? vary_steps( &s, error ) : status;
    if ( status == WISP_OK )
    {
        results_add_note( page->out, "Accuracy of a step: a level cloth held along one side swings down. "
                                     "Distances of vertices after 0.5 s: root mean square and largest." );
        results_add_note( page->out,
                          "fine: BDF2 in steps of %g s, two solves, tolerance 1e-6, %.0f iterations; exact: one "
                          "Euler solve per step to 1e-7.",
                          (double)fine.seconds, s.fine.iterations );
    }
    free( s.fine.points );
    free( s.exact.points );
    triangle_scene_free( &s.scene );
    return status;
}
