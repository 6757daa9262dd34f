/// Measure a row of a suite: what is the same in every run on any machine.
#pragma once

#include "suite.h"
#include "world_from_scene.h"

enum
{
    SUITE_MAX_PASSES = 64,
};

/// A pass of the engine that ran, or several that one function runs together.
typedef struct suite_pass
{
    char name[48];       ///< "module.verb"
    uintptr_t code;      ///< address of its function in this process; 0 in base files
    double instructions; ///< of all steps; NaN: not counted
} suite_pass;

typedef struct suite_measurement
{
    uint64_t hash;                      ///< of the states after all steps
    double values[SUITE_MEASURE_COUNT]; ///< NaN: not measured
    double largest_distance;            ///< m, of a place to the reference; NaN: not compared with a run
    int steps;
    char isa[16]; ///< instruction set that the kernels used
    suite_pass passes[SUITE_MAX_PASSES];
    int pass_count;
} suite_measurement;

/// Told of a run before its first step and after every step.
typedef struct suite_observer
{
    wisp_status ( *observe )( void* user, const scene_world* world, wisp_error* error );
    void* user;
    /// Request statistics of contact and intersections from the first step on. Surfaces without contact have their intersections
    /// counted too, and meet nothing.
    bool requests_contact;
} suite_observer;

/// Run a row in this process. Instructions are not counted, and there is no error.
/// @param observer may be null
wisp_status suite_run_row( const suite_row* row, const char* isa, const suite_observer* observer,
                           suite_measurement* out, wisp_error* error );

/// Continue a hash over the bits of all points, as measurements have it. @param points [vertices of the scene] buffer
uint64_t suite_hash_points( const scene_world* world, wisp_vec3* points, uint64_t hash );
/// What it begins with.
#define SUITE_HASH_BEGIN 0xcbf29ce484222325u
