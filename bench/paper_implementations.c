#include "paper_implementations.h"

#include "oracle/frozen_hair_oracle.h"

#include <math.h>
#include <stdlib.h>

// Together these give every vertex about a dozen neighbours, at any number of strands: a root every half millimetre
// and a vertex every centimetre along a strand.
#define PAPER_VERTICES 20
#define PAPER_SPACING 0.0005f
#define PAPER_LENGTH 0.2f
#define PAPER_CLUMP_RADIUS 0.0042f

static double farthest_coordinate( const wisp_groom* groom )
{
    double farthest = 0.0;
    for ( int i = 0; i < groom->vertex_count; ++i )
    {
        farthest = fmax( farthest, fabs( (double)groom->points[i].x ) );
        farthest = fmax( farthest, fabs( (double)groom->points[i].y ) );
    }
    return farthest;
}

wisp_status paper_scene_make( int strand_count, paper_scene* out, wisp_error* error )
{
    *out = ( paper_scene ){ .def = wisp_default_frozen_hair_def() };
    wisp_groom_generator generator = wisp_default_groom_generator( WISP_GROOM_WAVY, 2 );
    generator.strand_count = strand_count;
    generator.vertices_per_strand = PAPER_VERTICES;
    generator.length = PAPER_LENGTH;
    generator.spacing = PAPER_SPACING;
    generator.thickness = 0.0f;
    wisp_status status = wisp_groom_generate( &generator, &out->groom, error );
    if ( status != WISP_OK )
    {
        return status;
    }

    // Far away and below: every strand turns, neighbouring ones by almost the same angle, so the density stays.
    float width = PAPER_SPACING * (float)strand_count;
    out->def.cursor = ( wisp_vec3 ){ 3.0f * width, -10.0f * width, 0.0f };
    out->def.reach = 20.0f * width + 1.0f;
    out->def.clump_radius = PAPER_CLUMP_RADIUS;
    out->extent = farthest_coordinate( &out->groom );
    return WISP_OK;
}

void paper_scene_free( paper_scene* scene )
{
    wisp_groom_release( &scene->groom );
}

// ---- the engine ----

wisp_status paper_world_create( const paper_scene* scene, int workers, paper_world* out, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_frozen_hair_module };
    *out = ( paper_world ){ .scene = scene };
    const bench_world_def def = { modules, WISP_COUNT( modules ), .workers = workers };
    wisp_status status = bench_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = scene->groom.points;
    strands.offsets = scene->groom.offsets;
    strands.strand_count = scene->groom.strand_count;
    strands.dimension = 2;
    status = wisp_add_strands( out->world, &strands, &out->hair );
    if ( status == WISP_OK )
    {
        status = wisp_set_frozen_hair( out->world, out->hair, &scene->def );
    }
    if ( status == WISP_OK )
    {
        status = wisp_request( out->world, out->hair, WISP_STRAND_POINTS );
    }
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        paper_world_destroy( out );
    }
    return status;
}

wisp_status paper_world_step( void* context, wisp_error* error )
{
    paper_world* implementation = context;
    wisp_status status =
        wisp_command_frozen_hair( implementation->world, implementation->hair, implementation->scene->def.cursor );
    if ( status == WISP_OK )
    {
        status = wisp_world_step( implementation->world, 1.0f / 60.0f );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

wisp_status paper_world_after( void* context )
{
    paper_world* implementation = context;
    return profile_samples_add( &implementation->profile, wisp_world_profile( implementation->world ) );
}

wisp_status paper_world_replay( paper_world* implementation, uint64_t event, const wisp_vec3** points, uint64_t* hash,
                                wisp_error* error )
{
    wisp_status status = wisp_replay_frozen_hair( implementation->world, implementation->hair,
                                                  implementation->scene->def.cursor, event );
    if ( status == WISP_OK )
    {
        status = wisp_world_step( implementation->world, 1.0f / 60.0f );
    }
    if ( status != WISP_OK )
    {
        return bench_world_fail( implementation->world, status, error );
    }
    status = bench_world_hash( implementation->world, implementation->hair, WISP_STRAND_POINTS, hash, error );
    return status == WISP_OK ? bench_world_points( implementation->world, implementation->hair, WISP_STRAND_POINTS,
                                                   implementation->scene->groom.vertex_count, points, error )
                             : status;
}

void paper_world_destroy( paper_world* implementation )
{
    wisp_world_destroy( implementation->world );
    profile_samples_free( &implementation->profile );
    *implementation = ( paper_world ){ 0 };
}

// ---- the oracle ----

static float or_default( float value, float fallback )
{
    return value < 0.0f ? fallback : value;
}

static frozen_oracle_options oracle_options( const wisp_frozen_hair_def* def, uint64_t event )
{
    frozen_oracle_options options = frozen_oracle_default_options();
    options.theta_max = (double)def->max_bend_angle;
    options.cursor = ( double3 ){ (double)def->cursor.x, (double)def->cursor.y, (double)def->cursor.z };
    options.cursor_radius = (double)def->reach;
    options.clump_radius = (double)def->clump_radius;
    options.clump_iterations = def->clump_iterations;
    options.clump_step = (double)or_default( def->clump_step_length, 0.1f * def->clump_radius );
    options.min_distance = (double)or_default( def->min_distance, 0.02f * def->clump_radius );
    options.lambda_min = (double)def->min_lambda;
    options.gap = (frozen_oracle_gap)def->gap; // both list them in the same order
    options.clump = def->clump;
    options.dimension = 2;
    options.seed = def->seed;
    options.event = event;
    return options;
}

wisp_status paper_oracle_run( const paper_scene* scene, uint64_t event, double* out, wisp_error* error )
{
    const wisp_groom* groom = &scene->groom;
    size_t vertices = (size_t)groom->vertex_count, strands = (size_t)groom->strand_count;
    double3* rest = malloc( 2 * vertices * sizeof( double3 ) );
    double* parameters = malloc( 3 * strands * sizeof( double ) );
    wisp_status status = WISP_NO_MEMORY;
    if ( rest && parameters )
    {
        double3* points = rest + vertices;
        for ( size_t i = 0; i < vertices; ++i )
        {
            wisp_vec3 p = groom->points[i];
            rest[i] = ( double3 ){ (double)p.x, (double)p.y, (double)p.z };
        }
        for ( size_t s = 0; s < strands; ++s )
        {
            parameters[s] = (double)scene->def.stretch_stiffness;
            parameters[strands + s] = (double)scene->def.bend_stiffness;
            parameters[2 * strands + s] = (double)scene->def.intensity;
        }
        const frozen_oracle_hair hair = {
            .strand_count = groom->strand_count,
            .offsets = groom->offsets,
            .rest = rest,
            .stretch_stiffness = parameters,
            .bend_stiffness = parameters + strands,
            .intensity = parameters + 2 * strands,
        };
        const frozen_oracle_options options = oracle_options( &scene->def, event );
        status = frozen_oracle_run( &hair, &options, NULL, points );
        for ( size_t i = 0; i < vertices && status == WISP_OK; ++i )
        {
            out[3 * i + 0] = points[i].x;
            out[3 * i + 1] = points[i].y;
            out[3 * i + 2] = points[i].z;
        }
    }
    else
    {
        wisp_fail( error, status, "no memory for the oracle of %d strands", groom->strand_count );
    }
    free( rest );
    free( parameters );
    return status;
}
