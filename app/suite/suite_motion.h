/// The motion of a scene: all points at some times, in memory and as recordings.
#pragma once

#include "io_file.h"
#include "record.h"
#include "suite_measure.h"

enum
{
    SUITE_MAX_FRAMES = 33, ///< compared of a run, the first one before its first step
};

/// Bodies that move, frames after each other.
typedef struct suite_motion
{
    wisp_record_body* bodies; ///< [body_count] with arrays of their own
    int body_count;
    int* first;        ///< [body_count + 1] of each body's points in a frame
    wisp_vec3* start;  ///< [points] before the first step, or null until there is a frame
    wisp_vec3* points; ///< [frame_count][points] m
    double* times;     ///< [frame_count] s
    wisp_vec3*
        energies; ///< [frame_count] J: kinetic, potential, 0; NaN in a recording that another program has written
    int frame_count;
    io_memory memory; ///< of all these
} suite_motion;

int suite_motion_points( const suite_motion* motion );

/// When motions are compared: at most SUITE_MAX_FRAMES - 1 times, at the ends of the steps of the row with the longest ones, evenly, up to the
/// end of the shortest row, with suite_moments among them where steps end then. Steps of all rows have to end at these times.
typedef struct suite_times
{
    double at[SUITE_MAX_FRAMES];
    int count;
} suite_times;

// ---- what errors of a suite are measured against ----

/// A stored recording, a converged run, or what runs with more and more substeps converge to. Runs are made on request and
/// kept.
typedef struct suite_reference
{
    bool exists;            ///< the suite has one
    const suite_runs* runs; ///< null: none are made
    bool is_start;          ///< it is where bodies start
    suite_times times;
    suite_motion motion;
    suite_comparison
        doubt; ///< the coarser reference compared with this one. A stored one is compared with itself: 0, and the
               ///< distance that the suite says. NaN: rows have no such value
    double parts_at;   ///< s, when both are one percent of their size apart; INFINITY: they never are
    int frame_count;   ///< that are compared: those before, or all if there is none
    double until;      ///< s, when the last one of these is; 0: there is none
    wisp_vec3 gravity; ///< m/s^2, of the row with the longest steps
} suite_reference;

/// The references of a suite: one for all rows whose worlds are one scene, and differ in how it is solved.
typedef struct suite_references
{
    const wisp_suite* suite;
    suite_reference* list;          ///< [count]
    bool* is_made;                  ///< [count]
    int* of_row;                    ///< [rows of the suite]
    int count;                      ///< more than rows need: of what is made, rows ask
    char description[200];          ///< of all of them; empty: there is none
    const suite_observer* observer; ///< of the runs that are made for them; null: nobody
} suite_references;

/// Find out which rows have one reference. Worlds are one scene if they have the same bodies at the same places, at rest and at the
/// start, the same pins and colliders, events, materials that the row names, and duration.
/// @param suite must outlive the references @param out to be released, after a failure too
wisp_status suite_references_find( const wisp_suite* suite, suite_references* out, wisp_error* error );
/// The reference of a row; read or made if no row has asked for it before. Runs are kept under the hash of their scene and settings, and
/// found there the next time: in `$WISP_CACHE`, else `$XDG_CACHE_HOME/wisp`, else `$HOME/.cache/wisp`.
/// @param out receives a part of the references
wisp_status suite_reference_of( suite_references* references, int row, const suite_reference** out,
                                wisp_error* error );
void suite_references_release( suite_references* references );
/// Whether motion is compared no longer because two converged runs part.
bool suite_reference_parts( const suite_reference* reference );

/// Run a row in this process, and measure its error too. Instructions are not counted.
/// @param observer may be null
/// @return WISP_BAD_INPUT the row cannot be compared with the reference (the message says why)
wisp_status suite_reference_run( const suite_reference* reference, const suite_row* row, const char* isa,
                                 const suite_observer* observer, suite_measurement* out, wisp_error* error );
