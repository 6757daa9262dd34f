#include "strands_scene.h"

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

int strands_shape_size( const strands_shape* shape )
{
    return shape->strand_count * shape->vertices;
}

wisp_status strands_shape_make_horizontal( int strand_count, strands_shape* out, wisp_error* error )
{
    wisp_status status = strands_shape_create( strand_count, STRANDS_VERTICES, out, error );
    for ( int s = 0; s < strand_count && status == WISP_OK; ++s )
    {
        // Multiples of the golden angle never repeat.
        float angle = (float)fmod( 2.399963229728653 * s, 6.283185307179586 );
        float x = cosf( angle ), z = sinf( angle );
        for ( int v = 0; v < STRANDS_VERTICES; ++v )
        {
            float along = STRANDS_SPACING * (float)v;
            out->points[s * STRANDS_VERTICES + v] = ( wisp_vec3 ){ along * x, 0.0f, along * z };
        }
    }
    return status;
}

// ---- worlds ----

strands_generator strands_default_generator( const strands_shape* shape )
{
    return ( strands_generator ){
        .shape = shape,
        .dynamics = wisp_default_strand_dynamics_def(),
        .substeps = 10,
        .workers = 1,
        .iterations = 1,
        .seconds = STRANDS_STEP,
    };
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
    profile_samples_free( &implementation->profile );
    *implementation = ( strands_implementation ){ 0 };
}

wisp_status strands_implementation_step( void* context, wisp_error* error )
{
    strands_implementation* implementation = context;
    return bench_world_step( implementation->world, implementation->entity, implementation->generator.seconds,
                             &implementation->steps, &implementation->halted_at, error );
}

wisp_status strands_implementation_steps( strands_implementation* implementation, int count, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int s = 0; s < count && status == WISP_OK; ++s )
    {
        status = strands_implementation_step( implementation, error );
    }
    return status;
}

wisp_status strands_implementation_keep_profile( void* context )
{
    strands_implementation* implementation = context;
    return profile_samples_add( &implementation->profile, wisp_world_profile( implementation->world ) );
}

wisp_status strands_implementation_hash( strands_implementation* implementation, uint64_t* hash, wisp_error* error )
{
    return bench_world_hash( implementation->world, implementation->entity, WISP_STRAND_POINTS, hash, error );
}

wisp_status strands_implementation_points( strands_implementation* implementation, const wisp_vec3** points,
                                           wisp_error* error )
{
    return bench_world_points( implementation->world, implementation->entity, WISP_STRAND_POINTS,
                               strands_shape_size( implementation->generator.shape ), points, error );
}

// ---- measures ----

static double distance( wisp_vec3 a, wisp_vec3 b )
{
    double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
    return sqrt( x * x + y * y + z * z );
}

strands_stretch strands_measure_stretch( const strands_shape* rest, const wisp_vec3* points )
{
    strands_stretch stretch = { 0.0, 0.0 };
    for ( int s = 0; s < rest->strand_count; ++s )
    {
        size_t first = (size_t)s * (size_t)rest->vertices;
        for ( int v = 0; v + 1 < rest->vertices; ++v )
        {
            size_t i = first + (size_t)v;
            double l0 = distance( rest->points[i], rest->points[i + 1] );
            double strain = fabs( distance( points[i], points[i + 1] ) / l0 - 1.0 );

            // Not fmax: that would step over a NaN.
            stretch.max = strain <= stretch.max ? stretch.max : strain;
            stretch.mean += strain;
        }
    }
    stretch.mean /= (double)rest->strand_count * ( rest->vertices - 1 );
    return stretch;
}

double strands_rms_distance( const wisp_vec3* a, const wisp_vec3* b, int count )
{
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        double d = distance( a[i], b[i] );
        sum += d * d;
    }
    return count > 0 ? sqrt( sum / count ) : 0.0;
}
