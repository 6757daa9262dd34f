/// The reference file of a comparison: the position of every vertex of a converged run in double precision at every
/// sample. Made by bench/reference, read by the benchmark.
///
///     bytes                    what, all of it little-endian
///     8                        "WISPTRUT"
///     u32 [4]                  version, scenario, vertices, observations
///     u64                      hash of the mesh
///     f64 [COMPARE_INFO]      what the cloth is made of, see compare_reference_info()
///     f64 [4]                  steps a second in the window and on to rest, order of the integrator, worst residual
///     observations of f64 [6]         time, hem, strain, energy, slack, uncertainty
///         and f32 [vertices][3]
///     u64                      FNV-1a of all bytes before
#pragma once

#include "compare_scene.h"

#define COMPARE_INFO 12
#define COMPARE_OBSERVATIONS_MAX 64
#define COMPARE_VERTICES_MAX 65536

typedef struct compare_reference_observation
{
    double time;                     ///< s
    compare_observation observation; ///< of the run in double
    double uncertainty;              ///< m, root mean square distance to the run with twice the step
} compare_reference_observation;

typedef struct compare_reference
{
    int scenario, vertex_count;
    int observation_count; ///< those of the window, and one at rest
    uint64_t mesh_hash;
    double info[COMPARE_INFO];
    double rate, rest_rate; ///< steps per second until the last sample of the window, and after it
    double order;           ///< 1 Euler, 2 BDF2
    double residual;        ///< largest of Newton's method, relative to the impulse of the cloth's weight in a step
    compare_reference_observation observations[COMPARE_OBSERVATIONS_MAX];
    float* points; ///< [observation_count][vertex_count][3]
} compare_reference;

/// The numbers on which a reference and a scene must agree.
void compare_reference_info( const compare_physics* physics, double info[COMPARE_INFO] );

/// Read untrusted bytes.
/// @param name for messages
/// @return WISP_BAD_INPUT too short, too long, not a reference, or broken; WISP_NO_MEMORY; out is then empty
wisp_status compare_reference_parse( const void* bytes, size_t size, const char* name, compare_reference* out,
                                     wisp_error* error );
/// @return WISP_IO_ERROR an error of the operating system, else as compare_reference_parse()
wisp_status compare_reference_read( const char* path, compare_reference* out, wisp_error* error );
/// Whether it is the reference of this scene. @return WISP_BAD_INPUT the message states the difference
wisp_status compare_reference_check( const compare_reference* reference, const compare_scene* scene, const char* name,
                                     wisp_error* error );
/// @return WISP_IO_ERROR, WISP_NO_MEMORY
wisp_status compare_reference_write( const compare_reference* reference, const char* path, wisp_error* error );
void compare_reference_free( compare_reference* reference );
