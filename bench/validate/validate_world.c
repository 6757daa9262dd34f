#include "validate_world.h"

#include "interruption.h"

#include <math.h>

int validate_steps( double seconds )
{
    return (int)ceil( seconds / (double)VALIDATE_STEP );
}

wisp_status validate_world_create( const bench_world_def* def, validate_world* out, wisp_error* error )
{
    *out = ( validate_world ){ .substeps = def->substeps };
    return bench_world_create( def, &out->world, error );
}

void validate_world_release( validate_world* w )
{
    wisp_world_destroy( w->world );
    w->world = NULL;
}

wisp_status validate_world_add( validate_world* w, wisp_entity entity, wisp_component points, int vertex_count )
{
    WISP_ASSERT( w->count < VALIDATE_MAX_BODIES );
    w->bodies[w->count++] = ( validate_body ){ entity, points, vertex_count };
    return wisp_request( w->world, entity, points );
}

static wisp_status step( validate_world* w, accuracy_run* out, wisp_error* error )
{
    const double begin = wisp_clock_seconds();
    const wisp_status status = wisp_world_step( w->world, VALIDATE_STEP );
    const double ms = 1e3 * ( wisp_clock_seconds() - begin );
    w->steps += 1;
    if ( w->halted_at == 0 && wisp_world_counter( w->world, WISP_COUNT_HALTED ) > 0 )
    {
        w->halted_at = w->steps;
    }
    return status == WISP_OK ? accuracy_keep_ms( out, ms ) : bench_world_fail( w->world, status, error );
}

wisp_status validate_world_step( validate_world* w, int steps, accuracy_run* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < steps && status == WISP_OK; ++i )
    {
        status = interruption_check( error );
        status = status == WISP_OK ? step( w, out, error ) : status;
    }
    return status;
}

wisp_status validate_world_points( validate_world* w, int body, const wisp_vec3** out, wisp_error* error )
{
    const validate_body* b = w->bodies + body;
    return bench_world_points( w->world, b->entity, b->points, b->vertex_count, out, error );
}

wisp_status validate_world_watch( validate_world* w, int body, wisp_error* error )
{
    const wisp_status status = wisp_request( w->world, w->bodies[body].entity, WISP_MOTION_STATS );
    return status == WISP_OK ? WISP_OK : bench_world_fail( w->world, status, error );
}

wisp_status validate_world_motion( validate_world* w, int body, wisp_motion_stats* out, wisp_error* error )
{
    const wisp_status status = wisp_read_motion_stats( w->world, w->bodies[body].entity, out );
    return status == WISP_OK ? WISP_OK : bench_world_fail( w->world, status, error );
}

wisp_status validate_world_finish( validate_world* w, accuracy_run* out, wisp_error* error )
{
    double vertices = 0.0;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < w->count && status == WISP_OK; ++i )
    {
        uint64_t hash = 0;
        status = bench_world_hash( w->world, w->bodies[i].entity, w->bodies[i].points, &hash, error );
        out->hash = ( out->hash ^ hash ) * 0x100000001b3u;
        vertices += w->bodies[i].vertex_count;
    }
    out->halted_at = out->halted_at > 0 ? out->halted_at : w->halted_at;
    out->work = ( accuracy_work ){ .vertices = vertices,
                                   .substeps = w->substeps,
                                   .bytes = (double)wisp_world_memory( w->world ) };
    return status;
}
