/// Shared by the tests of frozen hair: scenes and runs that must succeed, random inputs, comparisons.
#pragma once

#include "oracle_support.h"

#include "oracle/frozen_hair_scenes.h"

static const uint64_t random_seed = 99;

static inline double3* new_points( const frozen_scene* scene )
{
    double3* points = checked_calloc( (size_t)scene->vertex_count + 1, sizeof( double3 ) );
    return points;
}

static inline double* new_doubles( const frozen_scene* scene )
{
    double* values = checked_calloc( (size_t)scene->vertex_count + 1, sizeof( double ) );
    return values;
}

static inline frozen_scene new_scene( frozen_scene_shape shape, int dimension, int strands, int vertices,
                                      double spacing )
{
    frozen_scene scene;
    assert_true( frozen_scene_create( &scene, shape, dimension, strands, vertices, spacing ) );
    return scene;
}

static inline frozen_scene new_scene_from( int strands, const int* counts, const double3* points )
{
    frozen_scene scene;
    assert_true( frozen_scene_from_points( &scene, strands, counts, points ) );
    return scene;
}

static inline void set_stiffness( frozen_scene* scene, double stiffness )
{
    for ( int s = 0; s < scene->hair.strand_count; ++s )
    {
        scene->stretch_stiffness[s] = stiffness;
        scene->bend_stiffness[s] = stiffness;
    }
}

/// The oracle's pipeline; the caller frees the points.
static inline double3* run( const frozen_scene* scene, const frozen_oracle_options* options )
{
    double3* out = new_points( scene );
    wisp_error error = { WISP_OK, "" };
    if ( frozen_oracle_run( &scene->hair, options, NULL, out, &error ) != WISP_OK )
    {
        fail_msg( "the oracle refuses: %s", error.message );
    }
    return out;
}

static inline void clump_step( const frozen_scene* scene, const frozen_oracle_options* options, int iteration,
                               const double3* reference, const double3* in, double* delta, double* lambda,
                               double3* out )
{
    assert_int_equal(
        frozen_oracle_clump_step( &scene->hair, options, iteration, reference, in, NULL, delta, lambda, out ),
        WISP_OK );
}

static inline bool same_bits( const double3* a, const double3* b, int count )
{
    return memcmp( a, b, (size_t)count * sizeof( double3 ) ) == 0;
}

/// The strand that owns a vertex, for strands of equal vertex count.
static inline bool same_strand( const frozen_scene* scene, int v, int q )
{
    int vertices = scene->offsets[1];
    return v / vertices == q / vertices;
}
