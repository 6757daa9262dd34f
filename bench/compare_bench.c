#include "compare_bench.h"

#include <math.h>
#include <stdlib.h>

// ---- a scene ----

static void add_notes( const compare_scene* scene, const compare_reference* reference, const compare_stats* stats,
                       const compare_plan* plan, results* out )
{
    double uncertainty = 0.0, slack = 0.0;
    for ( int k = 1; k < reference->observation_count - 1; ++k )
    {
        uncertainty += reference->observations[k].uncertainty * reference->observations[k].uncertainty /
                       ( reference->observation_count - 2 );
        slack = reference->observations[k].observation.slack > slack ? reference->observations[k].observation.slack
                                                                     : slack;
    }
    results_add_note( out,
                      "Comparison `%s`: the reference is %s in double precision, %g steps per second, solved by "
                      "Newton's method to %.1e of the weight's impulse.",
                      scene->physics.name, reference->order > 1.5 ? "BDF2" : "implicit Euler", reference->rate,
                      reference->residual );
    results_add_note( out,
                      "Comparison: with half as many steps the reference differs by %.3g mm in the window and %.3g "
                      "mm at rest. Up to %.0f of %d edges are slack in the window.",
                      1e3 * sqrt( uncertainty ),
                      1e3 * reference->observations[reference->observation_count - 1].uncertainty, slack,
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
