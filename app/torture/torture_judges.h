/// What must be true of every run: judges of a trace, and judges that run a scene again in another way.
#pragma once

#include "torture_trace.h"
#include "text_tree.h"

/// In the order in which they judge; the first one that a run breaks is the verdict.
typedef enum torture_judge
{
    TORTURE_HOLDS = -1,
    TORTURE_CRASH,         ///< the process died
    TORTURE_TIME,          ///< it did not end
    TORTURE_REFUSED,       ///< the reader takes the scene and the engine does not
    TORTURE_STATUS,        ///< a step failed
    TORTURE_FINITE,        ///< a coordinate, energy or speed is not finite
    TORTURE_HALTED,        ///< the engine gave up an entity
    TORTURE_ENERGY,        ///< more energy than was brought in
    TORTURE_STRAIN,        ///< edges longer than weight and stiffness explain
    TORTURE_PENETRATION,   ///< vertices inside a collider at rest
    TORTURE_INTERSECTIONS, ///< edges through triangles that contact should have kept apart
    TORTURE_REST,          ///< motion that does not die
    TORTURE_BITS,          ///< other bits with other workers or instruction sets
    TORTURE_SNAPSHOT,      ///< other bits after a snapshot and its restoration
    TORTURE_SCALE,         ///< another motion at ten times or a tenth of the size
    TORTURE_SHIFT,         ///< another motion 100 m away
    TORTURE_JUDGE_COUNT,
} torture_judge;

/// Short names, as reports and options have them.
extern const char* const torture_judge_names[TORTURE_JUDGE_COUNT];

typedef struct torture_verdict
{
    torture_judge judge;
    int step;          ///< after which it shows, counted from 1; 0: none in particular
    double severity;   ///< what was measured over what is allowed; 1 where nothing is measured
    char message[320]; ///< a sentence with figures; empty if everything holds
} torture_verdict;

/// Judge a trace. @return whether it holds
bool torture_judge_trace( const torture_trace* trace, torture_verdict* out );

typedef bool torture_judge_fn( const torture_trace* trace, torture_verdict* out );
torture_judge_fn torture_judge_status, torture_judge_finite, torture_judge_halted, torture_judge_energy,
    torture_judge_strain, torture_judge_penetration, torture_judge_intersections, torture_judge_rest;

/// @return whether inputs rest long enough at the end of the run for its bodies to be judged as they are then
bool torture_is_at_rest( const torture_trace* trace );
/// @return whether pins, colliders or heads may hold a body stretched, or inside of something
bool torture_is_held( const torture_trace* trace, int body );

/// J, that bodies may have above their start at a time: what the inputs and the lifting of what starts inside can
/// bring.
double torture_energy_budget( const torture_trace* trace, int row );

// ---- twins ----

/// The twins that a scene is run as, or-ed.
enum
{
    TORTURE_TWIN_BITS = 1,
    TORTURE_TWIN_SNAPSHOT = 2,
    TORTURE_TWIN_SCALE = 4,
    TORTURE_TWIN_SHIFT = 8,
    TORTURE_TWIN_ALL = 15,
};

/// A scene as a tree and as read. @param name what messages call it, and whose folder its files are in
typedef struct torture_subject
{
    const text_node* tree;
    const char* name;
} torture_subject;

/// Read a subject's text.
wisp_status torture_read( const torture_subject* subject, wisp_scene* out, wisp_error* error );

/// Run the twins of a scene whose trace holds. @return whether all hold
bool torture_judge_twins( const torture_subject* subject, const torture_trace* trace, int twins,
                          torture_verdict* out );

/// Compare two runs of which one is the other at a scale, or elsewhere. @return whether they are alike
bool torture_compare_traces( const torture_trace* trace, const torture_trace* twin, torture_judge judge,
                             torture_verdict* out );

/// Compare the hashes after the steps of two runs. @param first steps before them @param how the second run was made,
/// such as "with 2 workers than with one" @return whether they are equal
bool torture_compare_bits( const uint64_t* expected, int expected_count, const uint64_t* found, int found_count,
                           torture_judge judge, int first, const char* how, torture_verdict* out );

/// Multiply all lengths of a scene by a factor, and everything whose unit holds a length: another choice of the
/// metre.
void torture_scale( text_node* scene, double factor );
/// Multiply lengths, areas and flows and nothing else: another scene, of the same materials.
void torture_resize( text_node* scene, double factor );
/// Move everything that has a place.
void torture_shift( text_node* scene, const double offset[3] );

// ---- a scene, in a process of its own ----

/// A process that judges a scene.
typedef struct torture_child
{
    int pid, in;         ///< -1: it could not be started
    double seconds, end; ///< s, that it may take, and when they are over
} torture_child;

/// Start to judge a scene. @param seconds of wall time that it may take
torture_child torture_start( const torture_subject* subject, int twins, double seconds );
/// Wait for the verdict. Each child must be finished.
torture_verdict torture_finish( const torture_child* child );

/// Run a scene and judge it. @param seconds of wall time that it may take
torture_verdict torture_judge_scene( const torture_subject* subject, int twins, double seconds );
