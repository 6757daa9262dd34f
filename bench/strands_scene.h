/// Strands in a world of their own.
#pragma once

#include "bench_world.h"

#include "strands/strands.h"

#define STRANDS_STEP ( 1.0f / 60.0f )
#define STRANDS_GRAVITY 9.81

// ---- shapes ----

/// Polylines of equally many vertices.
typedef struct strands_shape
{
    int strand_count, vertices; ///< vertices a strand
    wisp_vec3* points;          ///< [strand_count][vertices] m
    int32_t* offsets;           ///< [strand_count + 1]
} strands_shape;

/// Room for a shape, every point at the origin.
wisp_status strands_shape_create( int strand_count, int vertices, strands_shape* out, wisp_error* error );
void strands_shape_free( strands_shape* shape );

// ---- worlds ----

typedef struct strands_generator
{
    const strands_shape* shape; ///< the caller's, who keeps it until the implementation is gone
    wisp_strand_dynamics_def dynamics;
    int substeps, workers;
    int iterations; ///< of what is not solved directly: sweeps a substep
    float seconds;  ///< a step
} strands_generator;

/// Steps of 1/60 s, one worker, ten substeps of one iteration, the engine's defaults.
strands_generator strands_default_generator( const strands_shape* shape );

typedef struct strands_implementation
{
    wisp_world* world;
    wisp_entity entity;
    strands_generator generator;
    int steps;
    int halted_at; ///< the step at which the engine halted it; 0: it never did
} strands_implementation;

/// Strands at rest, with WISP_STRAND_POINTS wanted as a renderer would.
wisp_status strands_implementation_create( const strands_generator* generator, strands_implementation* out,
                                           wisp_error* error );
void strands_implementation_destroy( strands_implementation* implementation );

/// One step. @param context the implementation
wisp_status strands_implementation_step( void* context, wisp_error* error );
wisp_status strands_implementation_hash( strands_implementation* implementation, uint64_t* hash, wisp_error* error );
/// The vertices in the user's order, valid until the next step.
wisp_status strands_implementation_points( strands_implementation* implementation, const wisp_vec3** points,
                                           wisp_error* error );

/// The largest |l/l0 - 1|; NaN if a coordinate is.
double strands_measure_stretch( const strands_shape* rest, const wisp_vec3* points );
