#include "figures_drape.h"

#include <math.h>

static wisp_status take_shot( const figures_case* page, const drape_plan* plan,
                              surface_implementation* implementation, const wisp_implicit_cloth_stats* seen,
                              drape_result* out, wisp_error* error )
{
    const drape_shot* shot = &plan->shots[out->shot_count];
    out->frames[out->shot_count] = shot->frame;
    out->contacts[out->shot_count] = seen->sticking + seen->sliding + seen->landing;
    wisp_status status =
        drape_observe( plan->scene, plan->border, implementation, &out->shots[out->shot_count], error );
    ++out->shot_count;
    if ( status == WISP_OK && shot->album != NULL )
    {
        status = figures_take( page, shot->album, implementation, error, "k %.0f, frame %d", (double)plan->stiffness,
                               shot->frame );
    }
    return status;
}

static wisp_status drop( const figures_case* page, const drape_plan* plan, surface_implementation* implementation,
                         drape_result* out, wisp_error* error )
{
    const int rest = (int)lrint( fmin( plan->steps, DRAPE_REST_SECONDS / (double)plan->seconds ) );
    wisp_status status = WISP_OK;
    for ( int step = 1; step <= plan->steps && status == WISP_OK; ++step )
    {
        wisp_implicit_cloth_stats seen;
        drape_observation observation;
        const double begin = wisp_clock_seconds();
        status = surface_implementation_step( implementation, error );
        out->ms += 1e3 * ( wisp_clock_seconds() - begin ) / plan->steps;
        status = status == WISP_OK ? drape_glance( implementation, &observation, error ) : status;
        if ( status == WISP_OK &&
             wisp_read_implicit_cloth_stats( implementation->world, implementation->entity, &seen ) != WISP_OK )
        {
            status = bench_world_fail( implementation->world, WISP_CONFLICT, error );
        }
        if ( status != WISP_OK )
        {
            return status;
        }
        out->max_kinetic = fmax( out->max_kinetic, observation.kinetic );
        out->min_gap = fmin( out->min_gap, observation.gap );
        out->iterations += (double)seen.iterations / plan->steps;
        out->is_finite = out->is_finite && observation.is_finite && implementation->halted_at == 0;
        if ( step == rest )
        {
            status = drape_observe( plan->scene, plan->border, implementation, &out->end, error );
        }
        while ( status == WISP_OK && out->shot_count < plan->shot_count &&
                plan->shots[out->shot_count].frame == step )
        {
            status = take_shot( page, plan, implementation, &seen, out, error );
        }
    }
    return status;
}

wisp_status drape_run( const figures_case* page, const drape_plan* plan, drape_result* out, wisp_error* error )
{
    *out = ( drape_result ){ .min_gap = INFINITY, .is_finite = true };
    triangle_setting setting = triangle_default_setting();
    setting.cloth.stretch_stiffness = plan->stiffness;
    setting.seconds = plan->seconds;
    setting.requests_stats = true;
    surface_implementation implementation;
    wisp_status status = triangle_enter( plan->scene, &setting, &implementation, error );
    if ( status == WISP_OK )
    {
        status = drop( page, plan, &implementation, out, error );
        surface_implementation_destroy( &implementation );
    }
    return status;
}

bool drape_is_at_rest( const drape_result* run )
{
    return run->is_finite && run->end.kinetic < DRAPE_REST * run->max_kinetic;
}
