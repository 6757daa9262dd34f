#include "compare_bench.h"

#include <math.h>
#include <stdlib.h>

const char* const compare_method_names[COMPARE_METHOD_COUNT] = { "pbd", "xpbd", "implicit" };

enum
{
    LIMIT_SUBSTEPS = 160, // with more, floats lose more by rounding than shorter substeps gain
};

// ---- variants ----

void compare_add_variant( compare_plan* plan, compare_variant variant )
{
    WISP_ASSERT( plan->variant_count < COMPARE_VARIANTS_MAX );
    const char* method = compare_method_names[variant.method];
    char* name = variant.name;
    switch ( variant.method )
    {
        case COMPARE_PBD:
            snprintf( name, sizeof( variant.name ), "%s %d, stiffness %g", method, variant.substeps,
                      (double)variant.stiffness );
            break;
        case COMPARE_XPBD:
            snprintf( name, sizeof( variant.name ), "%s %d", method, variant.substeps );
            break;
        default:
            snprintf( name, sizeof( variant.name ), "%s 1/%d, %s, %g, %d", method, variant.rate,
                      variant.bdf2 ? "BDF2" : "Euler", (double)variant.tolerance, variant.repeats );
    }
    plan->variants[plan->variant_count++] = variant;
}

static void add_position_based( compare_plan* plan, bool is_quick )
{
    static const int substeps[] = { 1, 2, 5, 10, 20, 40 };
    static const float stiffness[] = { 1.0f, 0.5f };
    for ( int k = 0; k < WISP_COUNT( stiffness ); ++k )
    {
        for ( int i = 0; i < WISP_COUNT( substeps ); ++i )
        {
            compare_add_variant( plan, ( compare_variant ){ .method = COMPARE_PBD,
                                                            .substeps = substeps[i],
                                                            .stiffness = stiffness[k],
                                                            .has_rest = !is_quick || substeps[i] <= 5 } );
        }
    }
    for ( int i = 0; i < WISP_COUNT( substeps ); ++i )
    {
        compare_add_variant( plan, ( compare_variant ){ .method = COMPARE_XPBD,
                                                        .substeps = substeps[i],
                                                        .has_rest = !is_quick || substeps[i] <= 5 } );
    }
    compare_add_variant(
        plan, ( compare_variant ){
                  .method = COMPARE_XPBD, .substeps = LIMIT_SUBSTEPS, .is_limit = true, .has_rest = !is_quick } );
}

// A short run has one tolerance and one solve per step.
static void add_implicit( compare_plan* plan, bool is_quick )
{
    static const int rates[] = { 60, 100, 200, 400, 800 };
    static const float tolerances[] = { 1e-4f, 1e-2f };
    static const int repeats[] = { 1, 3 };
    for ( int way = 0; way < ( is_quick ? 2 : 8 ); ++way )
    {
        for ( int i = 0; i < WISP_COUNT( rates ); ++i )
        {
            compare_variant variant = { .method = COMPARE_IMPLICIT,
                                        .rate = rates[i],
                                        .bdf2 = way % 2 == 1,
                                        .tolerance = tolerances[way / 2 % 2],
                                        .repeats = repeats[way / 4] };
            // the finest come to the same rest, and reaching it would take most of the time
            variant.has_rest = is_quick ? way == 0 && rates[i] <= 100 : way < 2 && rates[i] <= 400;
            compare_add_variant( plan, variant );
        }
    }
}

compare_plan compare_default_plan( const bench_options* options )
{
    compare_plan plan = {
        .scenario_count = COMPARE_SCENARIO_COUNT,
        .workers = { 1, options->workers },
        .worker_count = options->workers > 1 ? 2 : 1,
        .rounds_max = options->quick ? 1 : 64,
        .seconds = bench_seconds( options ),
        .folder = BENCH_DATA "/reference",
        .options = options,
    };
    for ( int i = 0; i < COMPARE_SCENARIO_COUNT; ++i )
    {
        plan.scenarios[i] = (compare_scenario)i;
    }
    add_position_based( &plan, options->quick );
    add_implicit( &plan, options->quick );
    return plan;
}

// ---- a scene ----

static void add_notes( const compare_scene* scene, const compare_reference* reference, const compare_stats* stats,
                       const compare_plan* plan, results* out )
{
    double doubt = 0.0, slack = 0.0;
    for ( int k = 1; k < reference->look_count - 1; ++k )
    {
        doubt += reference->looks[k].doubt * reference->looks[k].doubt / ( reference->look_count - 2 );
        slack = reference->looks[k].look.slack > slack ? reference->looks[k].look.slack : slack;
    }
    results_add_note( out,
                      "Comparison `%s`: the reference is %s in double precision, %g steps per second, solved by "
                      "Newton's method to %.1e of the weight's impulse.",
                      scene->physics.name, reference->order > 1.5 ? "BDF2" : "implicit Euler", reference->rate,
                      reference->residual );
    results_add_note( out,
                      "Comparison: with half as many steps the reference differs by %.3g mm in the window and %.3g "
                      "mm at rest. Up to %.0f of %d edges are slack in the window.",
                      1e3 * sqrt( doubt ), 1e3 * reference->looks[reference->look_count - 1].doubt, slack,
                      scene->edge_count );
    for ( int i = 0; i < plan->variant_count; ++i )
    {
        if ( plan->variants[i].is_limit )
        {
            results_add_note( out,
                              "Comparison `%s`: the last error of %s, %.3g mm, comes from the model and float "
                              "rounding. Its edges resist compression too, unlike those of Noh and Jung%s.",
                              scene->physics.name, plan->variants[i].name, 1e3 * stats[i].path,
                              scene->physics.has_ball ? ", and it bends by angles between triangles" : "" );
        }
    }
}

static wisp_status compare_one( const compare_plan* plan, compare_scenario scenario, double seconds, results* out,
                                wisp_error* error )
{
    char path[1024];
    compare_scene scene;
    compare_reference reference = { .points = NULL };
    compare_stats* stats = calloc( COMPARE_VARIANTS_MAX, sizeof( compare_stats ) );
    wisp_status status = compare_scene_make( scenario, TRIANGLE_VERTICES, &scene, error );
    if ( status == WISP_OK && !stats )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the figures of a comparison" );
    }
    snprintf( path, sizeof( path ), "%s/%s.reference", plan->folder, compare_physics_of( scenario ).name );
    status = status == WISP_OK ? compare_reference_read( path, &reference, error ) : status;
    status = status == WISP_OK ? compare_reference_check( &reference, &scene, path, error ) : status;
    status = status == WISP_OK ? compare_scene_run( plan, &scene, &reference, seconds, stats, out, error ) : status;
    if ( status == WISP_OK )
    {
        compare_add_table( plan, &scene, &reference, stats, out );
        compare_add_summaries( plan, &scene, stats, out );
        add_notes( &scene, &reference, stats, plan, out );
    }
    compare_reference_free( &reference );
    compare_scene_free( &scene );
    free( stats );
    return status;
}

wisp_status compare_bench_run( const compare_plan* plan, results* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < plan->scenario_count && status == WISP_OK; ++i )
    {
        bench_progress( plan->options, (double)i / plan->scenario_count,
                        compare_physics_of( plan->scenarios[i] ).name );
        status = compare_one( plan, plan->scenarios[i], plan->seconds / plan->scenario_count, out, error );
    }
    results_add_note( out, "Comparison: a frame is 1/60 s. pbd and xpbd are named by their substeps of one pass; "
                           "implicit steps by length, integrator, tolerance and linear solves per step." );
    results_add_note( out, "Comparison: pbd has no stiffness in SI units. Links are not damped; velocity is damped "
                           "by 2/s; friction 0.3 / 0.2, margin 5 mm." );
    return status;
}
