#include "compare_plan.h"

#include "accuracy/accuracy_reference.h"

#include <stdio.h>

const char* const compare_method_names[COMPARE_METHOD_COUNT] = { "pbd", "xpbd", "implicit" };

enum
{
    LIMIT_SUBSTEPS = 160, // beyond that floats lose more by rounding than shorter substeps gain
};

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

// A short run has one tolerance and one solve a step.
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
            // the finest are at the same rest, and reaching it would take most of the time
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
        .folder = accuracy_reference_folder(),
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
