/// Measure a row of a suite: what is the same in every run on any machine.
#pragma once

#include "suite.h"
#include "world_from_scene.h"

enum
{
    SUITE_MAX_PASSES = 64,
    SUITE_MOMENT_COUNT = 3,
};

/// When errors have columns of their own, s: 0.5, 1, 2.
extern const double suite_moments[SUITE_MOMENT_COUNT];

/// How far a motion is from another one, the reference. NaN: not compared, or not known of one of them.
typedef struct suite_comparison
{
    double distance;               ///< m, root mean square over all places and compared frames
    double largest;                ///< m, of a place in any compared frame
    double at[SUITE_MOMENT_COUNT]; ///< m, root mean square over all places at suite_moments
    double
        detail; ///< how much of the reference's fine curvature the surfaces have: 1 is as much; their meshes must be the same
    double
        energy; ///< kinetic and potential, above the reference's in the last compared frame, in parts of what that released
    double until; ///< s, of the last compared frame; 0: there is none
    bool parts;   ///< motion is compared no longer because two converged runs part
    /// What is left to compare when places are chance: means over the frames after those that are compared. NaN: there are none.
    double late_height; ///< m, of all places, above the reference's, against gravity
    double late_energy; ///< as `energy`
    double
        late_stretch; ///< total length of edges and segments, above the reference's in parts of it; meshes as for `detail`
    double late_detail; ///< as `detail`
} suite_comparison;

/// Until when rows are compared, from the first that ends to the last.
typedef struct suite_horizon
{
    double least, most; ///< s; 0: none is compared
    bool parts;         ///< of any row
} suite_horizon;

/// @param until 0: the row is not compared
void suite_horizon_add( suite_horizon* horizon, double until, bool parts );
/// Write "; compared until 1 s, where two converged runs part", or nothing.
void suite_horizon_text( const suite_horizon* horizon, char* out, size_t size );

/// A pass of the engine that ran, or several that one function runs together.
typedef struct suite_pass
{
    char name[48];       ///< "module.verb"
    uintptr_t code;      ///< address of its function in this process; 0 in base files
    double instructions; ///< of all steps; NaN: not counted
} suite_pass;

/// NaN everywhere.
extern const suite_comparison suite_not_compared;

typedef struct suite_measurement
{
    uint64_t hash;                      ///< of the states after all steps
    double values[SUITE_MEASURE_COUNT]; ///< NaN: not measured
    suite_comparison compared;          ///< with the reference
    int steps;
    int strands, vertices, substeps; ///< of what moves or is drawn; of a step
    char isa[16];                    ///< instruction set that the kernels used
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

/// Run a row and time its steps. Nothing is requested of the world.
/// @param observer of every step, outside its time; may be null
/// @param ms receives [steps] times, for free() in any case @param hash receives that of the states after all steps
/// @return WISP_CONFLICT a signal has come; or as scene_world_step()
wisp_status suite_time_row( const suite_row* row, int workers, const char* isa, const suite_observer* observer,
                            double** ms, int* steps, uint64_t* hash, wisp_error* error );

/// The statistics of a body's motion, of which suites sum energy and look for the largest strain. An animation alone moves a driven
/// surface: its strain and its energy are no result.
/// @return false for a body that has none
bool suite_motion_stats( const scene_world* world, int body, wisp_motion_stats* out );

/// Continue a hash over the bits of all points, as measurements have it. @param points [vertices of the scene] buffer
uint64_t suite_hash_points( const scene_world* world, wisp_vec3* points, uint64_t hash );
/// The same over any bytes.
uint64_t suite_hash_bytes( const void* bytes, size_t size, uint64_t hash );
/// What it begins with.
#define SUITE_HASH_BEGIN 0xcbf29ce484222325u

// ---- instructions, counted by callgrind in a process of its own ----

typedef struct suite_count_options
{
    bool has_cycles;  ///< simulate caches too, which takes three times as long
    const char* step; ///< option of `gate step` that the row is run with; null: none
} suite_count_options;

/// @param suite path, which the process reads again @param number of the row
/// @param out with the passes that ran; receives the instructions of all steps and of each pass, and the cycles
/// @return WISP_IO_ERROR valgrind is missing or counted nothing (the message says why)
wisp_status suite_count_instructions( const char* suite, int number, const suite_count_options* options,
                                      suite_measurement* out, wisp_error* error );

// ---- balloons in each other ----

/// How deep they are, by another way than that of contact: signed distances of the vertices of each from the others.
typedef struct suite_overlap
{
    double depth; ///< m, how much nearer than the thickness, or how deep in another balloon, a vertex is at most
    double
        missed; ///< fraction of all vertices that are nearer than half of the thickness to another balloon, or in it
    /// m, of the vertices of the first balloon next to the second: how far they are from the line between both centres at most, and the root
    /// mean square of their distances from a plane across it; NaN without them
    double wall_radius, wall_unevenness;
} suite_overlap;

/// Of the balloons of a scene. What is deeper than half of the smallest extent of a balloon counts as that.
/// @return WISP_CONFLICT their points are not requested
wisp_status suite_overlap_find( const scene_world* world, suite_overlap* out, wisp_error* error );
