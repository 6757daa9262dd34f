/// A scene run again in another way, judges that compare both runs, and a process for each scene.
#pragma once

#include "stability_judges.h"
#include "text_tree.h"

/// The twins that a scene is run as, or-ed.
enum
{
    TORTURE_TWIN_BITS = 1,
    TORTURE_TWIN_SNAPSHOT = 2,
    TORTURE_TWIN_SCALE = 4,
    TORTURE_TWIN_SHIFT = 8,
    TORTURE_TWIN_ALL = 15,
    TORTURE_CLOSE = 16, ///< no twin: the scene itself is judged by the close limits of suites, too
};

/// A scene as a tree and as read. @param name what messages call it, and whose folder its files are in
typedef struct torture_subject
{
    const text_node* tree;
    const char* name;
} torture_subject;

/// Read a subject's text.
wisp_status torture_read( const torture_subject* subject, wisp_scene* out, wisp_error* error );

/// Compare two runs of which one is the other at a scale, or elsewhere. @return whether they are alike
bool torture_compare_traces( const stability_trace* trace, const stability_trace* twin, stability_check judge,
                             stability_verdict* out );

/// Multiply all lengths of a scene by a factor, and everything whose unit holds a length: another choice of the
/// metre.
void torture_scale( text_node* scene, double factor );
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
stability_verdict torture_finish( const torture_child* child );

/// Run a scene and judge it. @param seconds of wall time that it may take
stability_verdict torture_judge_scene( const torture_subject* subject, int twins, double seconds );
