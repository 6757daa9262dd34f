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

int strands_shape_size( const strands_shape* shape )
{
    return shape->strand_count * shape->vertices;
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
    return bench_world_points( implementation->world, implementation->entity, WISP_STRAND_POINTS,
                               strands_shape_size( implementation->generator.shape ), points, error );
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

// ---- hair on a head ----

hair_head_generator hair_head_default_generator( const strands_shape* moving )
{
    hair_head_generator generator = {
        .moving = moving,
        .follow = wisp_default_ghosts_def(),
        .dynamics = wisp_default_strand_dynamics_def(),
    };
    generator.dynamics.damping = 0.0f;
    return generator;
}

static wisp_status add( wisp_world* world, const strands_shape* shape, wisp_entity* out )
{
    wisp_strands_def def = wisp_default_strands_def();
    def.points = shape->points;
    def.offsets = shape->offsets;
    def.strand_count = shape->strand_count;
    return wisp_add_strands( world, &def, out );
}

static wisp_status add_all( hair_head* head )
{
    wisp_status status = add( head->world, head->generator.moving, &head->moving );
    if ( status == WISP_OK )
    {
        status = wisp_set_strand_dynamics( head->world, head->moving, &head->generator.dynamics );
    }
    if ( status == WISP_OK && head->generator.ghosts )
    {
        status = add( head->world, head->generator.ghosts, &head->ghosts );
        head->generator.follow.targets = head->moving;
        status = status == WISP_OK ? wisp_set_ghosts( head->world, head->ghosts, &head->generator.follow ) : status;
        status = status == WISP_OK ? wisp_request( head->world, head->ghosts, WISP_STRAND_POINTS ) : status;
    }
    if ( status == WISP_OK && ( !head->generator.ghosts || head->generator.shows_moving ) )
    {
        status = wisp_request( head->world, head->moving, WISP_STRAND_POINTS );
    }
    return status;
}

wisp_status hair_head_create( const hair_head_generator* generator, hair_head* out, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_strands_module, &wisp_guide_hair_module };
    *out = ( hair_head ){ .generator = *generator };
    const bench_world_def def = { modules, WISP_COUNT( modules ), .substeps = 10 };
    wisp_status status = bench_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_all( out );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        hair_head_destroy( out );
    }
    return status;
}

void hair_head_destroy( hair_head* head )
{
    wisp_world_destroy( head->world );
    *head = ( hair_head ){ 0 };
}

wisp_transform hair_head_pose( double seconds )
{
    // The ramp keeps the first step from being a blow.
    double ramp = fmin( seconds / 0.25, 1.0 );
    double sway = 0.04 * ramp * sin( 9.42477796 * seconds ), turn = 0.35 * ramp * sin( 7.0 * seconds );
    const wisp_quat rotation = { 0.0f, (float)sin( 0.5 * turn ), 0.0f, (float)cos( 0.5 * turn ) };
    const wisp_vec3 translation = { (float)sway, 0.0f, 0.0f };
    return wisp_transform_make( rotation, translation );
}

wisp_status hair_head_step_to( hair_head* head, wisp_transform pose, wisp_error* error )
{
    wisp_status status = wisp_move_strand_head( head->world, head->moving, pose );
    status = status == WISP_OK ? wisp_world_step( head->world, STRANDS_STEP ) : status;
    ++head->steps;
    return status == WISP_OK ? WISP_OK : bench_world_fail( head->world, status, error );
}

wisp_status hair_head_step( hair_head* head, wisp_error* error )
{
    return hair_head_step_to( head, hair_head_pose( (double)STRANDS_STEP * ( head->steps + 1 ) ), error );
}

// ---- what it shows ----

wisp_status hair_head_points( hair_head* head, const wisp_vec3** points, wisp_error* error )
{
    if ( head->generator.ghosts == NULL )
    {
        return hair_head_moving_points( head, points, error );
    }
    return bench_world_points( head->world, head->ghosts, WISP_STRAND_POINTS,
                               strands_shape_size( head->generator.ghosts ), points, error );
}

wisp_status hair_head_moving_points( hair_head* head, const wisp_vec3** points, wisp_error* error )
{
    return bench_world_points( head->world, head->moving, WISP_STRAND_POINTS,
                               strands_shape_size( head->generator.moving ), points, error );
}

void hair_head_moving_velocities( hair_head* head, wisp_vec3* out )
{
    const wisp_strand_topology* t = wisp_world_strands( head->world, head->moving );
    const float* velocity = wisp_world_column( head->world, head->moving, WISP_STRAND_VELOCITY, 0 );
    for ( int group = 0; group < t->group_count; ++group )
    {
        for ( int lane = 0; lane < 16; ++lane )
        {
            int strand = t->lane_strand[16 * group + lane];
            for ( int v = 0; v < t->lane_count[16 * group + lane]; ++v )
            {
                const float* row = velocity + 48 * (size_t)( t->group_row[group] + v ) + lane;
                out[t->offsets[strand] + v] = ( wisp_vec3 ){ row[0], row[16], row[32] };
            }
        }
    }
}
