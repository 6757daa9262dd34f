/// The truth file of a comparison: where every vertex of a converged run in double precision is at every look. Made by
/// bench/truth, read by the benchmark.
///
///     bytes                    what, all of it little-endian
///     8                        "WISPTRUT"
///     u32 [4]                  version, scenario, vertices, looks
///     u64                      hash of the mesh
///     f64 [COMPARE_FACTS]      what the cloth is made of, see compare_truth_facts()
///     f64 [4]                  steps a second in the window and on to rest, order of the integrator, worst residual
///     looks of f64 [6]         time, hem, strain, energy, slack, doubt
///         and f32 [vertices][3]
///     u64                      FNV-1a of all bytes before
#pragma once

#include "compare_scene.h"

#define COMPARE_FACTS 12
#define COMPARE_LOOKS_MAX 64
#define COMPARE_VERTICES_MAX 65536

typedef struct compare_truth_look
{
    double time;       ///< s
    compare_look look; ///< of the run in double
    double doubt;      ///< m, root mean square distance to the run of twice the step
} compare_truth_look;

typedef struct compare_truth
{
    int scenario, vertex_count;
    int look_count; ///< those of the window, and one at rest
    uint64_t mesh_hash;
    double facts[COMPARE_FACTS];
    double rate, rest_rate; ///< steps a second until the last look of the window, and after it
    double order;           ///< 1 Euler, 2 BDF2
    double residual;        ///< worst of Newton's method, over the impulse of the cloth's weight in a step
    compare_truth_look looks[COMPARE_LOOKS_MAX];
    float* points; ///< [look_count][vertex_count][3]
} compare_truth;

/// The numbers that a truth and a scene must agree in.
void compare_truth_facts( const compare_physics* physics, double facts[COMPARE_FACTS] );

/// Read bytes that nobody vouches for.
/// @param name what the sentence calls them
/// @return WISP_BAD_INPUT too short, too long, not a truth, or broken; WISP_NO_MEMORY; out is then empty
wisp_status compare_truth_parse( const void* bytes, size_t size, const char* name, compare_truth* out,
                                 wisp_error* error );
/// @return WISP_IO_ERROR the operating system refused, else as compare_truth_parse()
wisp_status compare_truth_read( const char* path, compare_truth* out, wisp_error* error );
/// Whether it is the truth of this scene. @return WISP_BAD_INPUT the sentence says what differs
wisp_status compare_truth_check( const compare_truth* truth, const compare_scene* scene, const char* name,
                                 wisp_error* error );
/// @return WISP_IO_ERROR, WISP_NO_MEMORY
wisp_status compare_truth_write( const compare_truth* truth, const char* path, wisp_error* error );
void compare_truth_free( compare_truth* truth );
