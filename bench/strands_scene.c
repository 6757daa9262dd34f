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

wisp_status strands_shape_make_straight( int vertices, wisp_vec3 direction, double length, strands_shape* out,
                                         wisp_error* error )
{
    wisp_status status = strands_shape_create( 1, vertices, out, error );
    for ( int v = 0; v < vertices && status == WISP_OK; ++v )
    {
        float along = (float)( length * v / ( vertices - 1 ) );
        out->points[v] = ( wisp_vec3 ){ along * direction.x, along * direction.y, along * direction.z };
    }
    return status;
}

// ---- worlds ----

strands_recipe strands_default_recipe( const strands_shape* shape )
{
    return ( strands_recipe ){
        .shape = shape,
        .dynamics = wisp_default_strand_dynamics_def(),
        .substeps = 10,
        .workers = 1,
        .iterations = 1,
        .seconds = STRANDS_STEP,
    };
}

static wisp_status add_strands( strands_entrant* entrant )
{
    const strands_shape* shape = entrant->recipe.shape;
    wisp_strands_def def = wisp_default_strands_def();
    def.points = shape->points;
    def.offsets = shape->offsets;
    def.strand_count = shape->strand_count;
    wisp_status status = wisp_add_strands( entrant->world, &def, &entrant->entity );
    if ( status == WISP_OK )
    {
        status = wisp_set_strand_dynamics( entrant->world, entrant->entity, &entrant->recipe.dynamics );
    }
    if ( status == WISP_OK )
    {
        status = wisp_want( entrant->world, entrant->entity, WISP_STRAND_POINTS );
    }
    if ( status == WISP_OK && entrant->recipe.has_quality )
    {
        status = wisp_want( entrant->world, entrant->entity, WISP_QUALITY );
    }
    return status;
}

wisp_status strands_entrant_create( const strands_recipe* recipe, strands_entrant* out, wisp_error* error )
{
    const wisp_module* module = &wisp_strands_module;
    *out = ( strands_entrant ){ .recipe = *recipe };
    wisp_world_def def = wisp_default_world_def();
    def.modules = &module;
    def.module_count = 1;
    def.log = bench_world_drop_log;
    def.workers = recipe->workers;
    def.substeps = recipe->substeps;
    def.iterations = recipe->iterations;
    wisp_status status = wisp_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_strands( out );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        strands_entrant_destroy( out );
    }
    return status;
}

void strands_entrant_destroy( strands_entrant* entrant )
{
    wisp_world_destroy( entrant->world );
    profile_samples_free( &entrant->profile );
    *entrant = ( strands_entrant ){ 0 };
}

wisp_status strands_entrant_step( void* context, wisp_error* error )
{
    strands_entrant* entrant = context;
    return bench_world_step( entrant->world, entrant->entity, entrant->recipe.seconds, &entrant->steps,
                             &entrant->halted_at, error );
}

wisp_status strands_entrant_steps( strands_entrant* entrant, int count, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int s = 0; s < count && status == WISP_OK; ++s )
    {
        status = strands_entrant_step( entrant, error );
    }
    return status;
}

wisp_status strands_entrant_keep_profile( void* context )
{
    strands_entrant* entrant = context;
    return profile_samples_add( &entrant->profile, wisp_world_profile( entrant->world ) );
}

wisp_status strands_entrant_hash( strands_entrant* entrant, uint64_t* hash, wisp_error* error )
{
    return bench_world_hash( entrant->world, entrant->entity, WISP_STRAND_POINTS, hash, error );
}

wisp_status strands_entrant_points( strands_entrant* entrant, const wisp_vec3** points, wisp_error* error )
{
    return bench_world_points( entrant->world, entrant->entity, WISP_STRAND_POINTS,
                               strands_shape_size( entrant->recipe.shape ), points, error );
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
