/// Files that `wisp run` writes and compares while a scene runs: recordings, tracks of vertices, and the check that a
/// recording is reproduced bit for bit.
#pragma once

#include "record.h"
#include "world_from_scene.h"

/// Values that a recording can hold.
enum
{
    RUN_VALUE_STRAIN = 1,
    RUN_VALUE_SPEED = 2,
    RUN_VALUE_COUNT = 2,
};

/// Name of the value with bit `1 << index`.
extern const char* const run_value_names[RUN_VALUE_COUNT];

#define RUN_TRACKS_MAX 1000

/// A vertex given on the command line.
typedef struct run_track
{
    const char* name; ///< of a body, not zero-terminated
    int name_length;
    int vertex;
} run_track;

typedef struct run_recorder_def
{
    const char* record; ///< file, or null; its extension decides on the format
    int every;          ///< steps between two frames, >= 1
    unsigned values;    ///< to be recorded besides those that the scene computes: a set of RUN_VALUE_..
    const char* track_file;
    run_track tracks[RUN_TRACKS_MAX];
    int track_count;
    const char* verify; ///< a .wisp recording to be compared, or null
    int steps;          ///< of the run
    bool is_part;       ///< only the first steps were asked for: the recording may go on after them
} run_recorder_def;

typedef struct run_recorder run_recorder;

/// Request the points of all bodies from the world and open the files. Call before the first step.
/// @param world must stay where it is and outlive the recorder
/// @param out receives the recorder, for run_recorder_close(); null if nothing is to be written, and on failure
/// @return WISP_BAD_INPUT a body or vertex that does not exist, a recording of another scene, a format that cannot
///         hold a body or so many frames, a value that no body has; WISP_IO_ERROR; WISP_NO_MEMORY
wisp_status run_recorder_open( const run_recorder_def* def, scene_world* world, run_recorder** out,
                               wisp_error* error );

/// Record the present state: write a frame and compare one, if this step has one. Null is allowed.
/// @return WISP_CONFLICT a frame differs from the recording (the message names frame, body and vertex); results of
///        wisp_recorder_frame()
wisp_status run_recorder_step( run_recorder* recorder, wisp_error* error );

/// Frames written, frames that were equal, and frames of the compared recording that the run did not reach.
typedef struct run_recorder_counts
{
    int written, verified, unreached;
    char files[280]; ///< names of the written ones, as many as fit
} run_recorder_counts;

run_recorder_counts run_recorder_count( const run_recorder* recorder );

/// Finish the files and free the recorder, at any step and after any failure too: a run that ends early leaves valid
/// files of the frames so far. Null is allowed.
/// @return the first file that could not be finished
wisp_status run_recorder_close( run_recorder* recorder, wisp_error* error );
