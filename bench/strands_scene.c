#include "strands_scene.h"

#include "mesh.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>

// ---- shapes ----

wisp_status strands_shape_create( int strand_count, int vertices, strands_shape* out, wisp_error* error )
{
    *out = ( strands_shape ){ .strand_count = strand_count, .vertices = vertices };
    out->points = calloc( (size_t)strand_count * (size_t)vertices, sizeof( wisp_vec3 ) );
    out->offsets = calloc( (size_t)strand_count + 1, sizeof( int32_t ) );
    if ( !out->points || !out->offsets )
    {
        strands_shape_free( out );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %d strands of %d vertices", strand_count, vertices );
    }
    for ( int s = 0; s <= strand_count; ++s )
    {
        out->offsets[s] = s * vertices;
    }
    return WISP_OK;
}

void strands_shape_free( strands_shape* shape )
{
    free( shape->points );
    free( shape->offsets );
    *shape = ( strands_shape ){ 0 };
}

// ---- worlds ----

strands_generator strands_default_generator( const strands_shape* shape )
{
    strands_generator generator = {
        .shape = shape,
        .dynamics = wisp_default_strand_dynamics_def(),
        .substeps = 10,
        .workers = 1,
        .iterations = 1,
        .seconds = STRANDS_STEP,
    };
    generator.dynamics.damping = 0.0f;
    return generator;
}

static wisp_status add_strands( strands_implementation* implementation )
{
    const strands_shape* shape = implementation->generator.shape;
    wisp_strands_def def = wisp_default_strands_def();
    def.points = shape->points;
    def.offsets = shape->offsets;
    def.strand_count = shape->strand_count;
    wisp_status status = wisp_add_strands( implementation->world, &def, &implementation->entity );
    if ( status == WISP_OK )
    {
        status = wisp_set_strand_dynamics( implementation->world, implementation->entity,
                                           &implementation->generator.dynamics );
    }
    if ( status == WISP_OK )
    {
        status = wisp_request( implementation->world, implementation->entity, WISP_STRAND_POINTS );
    }
    return status;
}

wisp_status strands_implementation_create( const strands_generator* generator, strands_implementation* out,
                                           wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_strands_module };
    *out = ( strands_implementation ){ .generator = *generator };
    const bench_world_def def = { modules, WISP_COUNT( modules ), generator->workers, generator->substeps,
                                  generator->iterations };
    wisp_status status = bench_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_strands( out );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        strands_implementation_destroy( out );
    }
    return status;
}

void strands_implementation_destroy( strands_implementation* implementation )
{
    wisp_world_destroy( implementation->world );
    *implementation = ( strands_implementation ){ 0 };
}

wisp_status strands_implementation_step( void* context, wisp_error* error )
{
    strands_implementation* implementation = context;
    return bench_world_step( implementation->world, implementation->entity, implementation->generator.seconds,
                             &implementation->steps, &implementation->halted_at, error );
}

wisp_status strands_implementation_hash( strands_implementation* implementation, uint64_t* hash, wisp_error* error )
{
    return bench_world_hash( implementation->world, implementation->entity, WISP_STRAND_POINTS, hash, error );
}

wisp_status strands_implementation_points( strands_implementation* implementation, const wisp_vec3** points,
                                           wisp_error* error )
{
    return bench_world_points(
        implementation->world, implementation->entity, WISP_STRAND_POINTS,
        implementation->generator.shape->strand_count * implementation->generator.shape->vertices, points, error );
}

// ---- measures ----

double strands_measure_stretch( const strands_shape* rest, const wisp_vec3* points )
{
    double most = 0.0;
    for ( int s = 0; s < rest->strand_count; ++s )
    {
        size_t first = (size_t)s * (size_t)rest->vertices;
        for ( int v = 0; v + 1 < rest->vertices; ++v )
        {
            size_t i = first + (size_t)v;
            double l0 = wisp_mesh_distance( rest->points[i], rest->points[i + 1] );
            double strain = fabs( wisp_mesh_distance( points[i], points[i + 1] ) / l0 - 1.0 );

            // Not fmax: that would step over a NaN.
            most = strain <= most ? most : strain;
        }
    }
    return most;
}
