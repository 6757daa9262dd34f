#include "compare_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

compare_physics compare_physics_of( compare_scenario scenario )
{
    static const compare_physics all[COMPARE_SCENARIO_COUNT] = {
        [COMPARE_DRAPE] = { .name = "drape",
                            .has_ball = true,
                            .drop = 0.1f,
                            .widening = 1.0f,
                            .bend = 1e-6f,
                            .damping = 2.0f,
                            .observation_count = 7,
                            .timed_observation = 2,
                            .rest_seconds = 5.0f },
        [COMPARE_TAUT] = { .name = "taut",
                           .widening = 1.03f,
                           .damping = 2.0f,
                           .observation_count = 8,
                           .rest_seconds = 5.0f },
    };
    return all[scenario];
}

// ---- the mesh ----

// FNV-1a over the bits of coordinates and indices, byte by byte, the lowest first.
static uint64_t hash_words( uint64_t hash, const void* words, size_t count )
{
    for ( size_t i = 0; i < count; ++i )
    {
        uint32_t word;
        memcpy( &word, (const char*)words + 4 * i, 4 );
        for ( int byte = 0; byte < 4; ++byte )
        {
            hash = ( hash ^ ( ( word >> ( 8 * byte ) ) & 0xffu ) ) * 0x100000001b3ull;
        }
    }
    return hash;
}

static uint64_t hash_mesh( const wisp_mesh* mesh )
{
    const uint64_t hash = hash_words( 0xcbf29ce484222325ull, mesh->points, 3 * (size_t)mesh->vertex_count );
    return hash_words( hash, mesh->triangles, 3 * (size_t)mesh->triangle_count );
}

static void place_start( compare_scene* scene )
{
    const wisp_mesh* mesh = &scene->base.mesh;
    const float half = 0.5f * TRIANGLE_WIDTH, near = 1e-4f * TRIANGLE_WIDTH;
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        const wisp_vec3 p = mesh->points[i];
        const float wide = scene->physics.widening;
        scene->start[i] = ( wisp_vec3 ){ wide * p.x, p.y - scene->physics.drop, wide * p.z };
        if ( fmaxf( fabsf( p.x ), fabsf( p.z ) ) > half - near )
        {
            scene->border[scene->border_count++] = i;
        }
    }
}

// Edges, lengths and masses are the oracle's, so that the reference and the samples use the same.
static wisp_status take_from_oracle( compare_scene* scene, wisp_error* error )
{
    const wisp_mesh* mesh = &scene->base.mesh;
    double3* points = calloc( (size_t)mesh->vertex_count, sizeof( double3 ) );
    triangle_oracle oracle = { .count = 0 };
    if ( !points )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %d vertices", mesh->vertex_count );
    }
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        const wisp_vec3 p = mesh->points[i];
        points[i] = double3_make( (double)p.x, (double)p.y, (double)p.z );
    }
    const triangle_oracle_def def = { .count = mesh->vertex_count,
                                      .points = points,
                                      .triangle_count = mesh->triangle_count,
                                      .triangles = mesh->triangles,
                                      .masses = scene->masses };
    triangle_oracle_params params = triangle_oracle_default_params();
    // with the rigidity 9/8 a diagonal of a sheet has the stiffness A / L
    params.stiffness = TRIANGLE_ORACLE_STIFFNESS_MATERIAL;
    params.bend_rigidity = 9.0 / 8.0;
    triangle_oracle_lump( &def, (double)TRIANGLE_DENSITY, scene->masses );
    wisp_status status = triangle_oracle_create( &def, &params, &oracle, error );
    double fractions = 0.0;
    for ( int k = 0; k < oracle.link_count; ++k )
    {
        const triangle_oracle_link* link = &oracle.link[k];
        if ( link->bends )
        {
            fractions += link->bend;
            continue;
        }
        scene->edges[2 * scene->edge_count] = link->i;
        scene->edges[2 * scene->edge_count + 1] = link->j;
        scene->lengths[scene->edge_count++] = link->length;
    }
    scene->rigidity = fractions > 0.0 ? 9.0 / 8.0 * (double)scene->physics.bend * oracle.bend_count / fractions : 0.0;
    triangle_oracle_destroy( &oracle );
    free( points );
    return status;
}

wisp_status compare_scene_make( compare_scenario scenario, int vertices, compare_scene* out, wisp_error* error )
{
    *out = ( compare_scene ){ .physics = compare_physics_of( scenario ) };
    wisp_status status = triangle_scene_make( vertices, &out->base, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const size_t n = (size_t)out->base.mesh.vertex_count, max_edges = 3 * (size_t)out->base.mesh.triangle_count;
    out->start = calloc( n, sizeof( wisp_vec3 ) );
    out->border = calloc( n, sizeof( int32_t ) );
    out->masses = calloc( n, sizeof( double ) );
    out->edges = calloc( max_edges, 2 * sizeof( int32_t ) );
    out->lengths = calloc( max_edges, sizeof( double ) );
    if ( out->start && out->border && out->masses && out->edges && out->lengths )
    {
        place_start( out );
        out->hash = hash_mesh( &out->base.mesh );
        status = take_from_oracle( out, error );
    }
    else
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a scene of %zu vertices", n );
    }
    if ( status != WISP_OK )
    {
        compare_scene_free( out );
    }
    return status;
}

void compare_scene_free( compare_scene* scene )
{
    triangle_scene_free( &scene->base );
    free( scene->start );
    free( scene->border );
    free( scene->masses );
    free( scene->edges );
    free( scene->lengths );
    *scene = ( compare_scene ){ .start = NULL };
}

// ---- samples ----

static double height_of( const compare_scene* scene, const double* points )
{
    double sum = 0.0;
    const int all = scene->base.mesh.vertex_count, count = scene->physics.has_ball ? scene->border_count : all;
    for ( int i = 0; i < count; ++i )
    {
        sum += points[3 * ( scene->physics.has_ball ? scene->border[i] : i ) + 1];
    }
    return sum / count;
}

compare_observation compare_observe( const compare_scene* scene, const double* points, const double* velocities )
{
    compare_observation observation = { .hem = height_of( scene, points ) };
    for ( int e = 0; e < scene->edge_count; ++e )
    {
        const double *p = points + 3 * scene->edges[2 * e], *q = points + 3 * scene->edges[2 * e + 1];
        const double x = q[0] - p[0], y = q[1] - p[1], z = q[2] - p[2];
        const double over = sqrt( x * x + y * y + z * z ) - scene->lengths[e];
        observation.strain += fabs( over ) / scene->lengths[e] / scene->edge_count;
        observation.slack += over < 0.0 ? 1.0 : 0.0;
        observation.energy += over > 0.0 ? 0.5 * (double)COMPARE_STRETCH_STIFFNESS * over * over : 0.0;
    }
    for ( int i = 0; i < scene->base.mesh.vertex_count; ++i )
    {
        const double *v = velocities + 3 * i, square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        observation.energy += scene->masses[i] * ( 0.5 * square + (double)TRIANGLE_GRAVITY * points[3 * i + 1] );
    }
    return observation;
}
