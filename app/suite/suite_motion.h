/// The motion of a scene: all points at some times, in memory and as recordings.
#pragma once

#include "suite_measure.h"
#include "record.h"

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
    int frame_count, frame_capacity;
} suite_motion;

void suite_motion_release( suite_motion* motion );
int suite_motion_points( const suite_motion* motion );

/// When motions are compared: at most SUITE_MAX_FRAMES - 1 times, at the ends of the steps of the row with the longest ones, evenly, up to the
/// end of the shortest row, with suite_moments among them where steps end then. Steps of all rows have to end at these times.
typedef struct suite_times
{
    double at[SUITE_MAX_FRAMES];
    int count;
} suite_times;

/// @return WISP_BAD_INPUT a row is no scene
wisp_status suite_choose_times( const wisp_suite* suite, suite_times* out, wisp_error* error );

/// Run a row and keep its points at some times.
/// @param also told of the run, too; may be null
/// @param out to be released, after a failure too
/// @return WISP_BAD_INPUT no step of the row ends at one of the times (the message names it)
wisp_status suite_motion_run( const suite_row* row, const char* isa, const suite_times* times,
                              const suite_observer* also, suite_motion* out, suite_measurement* measured,
                              wisp_error* error );

/// Move the points and energies of a motion away from those of a coarser one by a part of their difference.
/// @return WISP_BAD_INPUT the motions have other bodies or frames
wisp_status suite_motion_extrapolate( suite_motion* motion, const suite_motion* coarser, double part,
                                      wisp_error* error );

/// Read a recording. @param out to be released, after a failure too
/// @return WISP_BAD_INPUT it is none, or has no frame at one of the times; WISP_IO_ERROR; WISP_NO_MEMORY
wisp_status suite_motion_read( const char* path, const suite_times* times, suite_motion* out, wisp_error* error );
wisp_status suite_motion_write( const suite_motion* motion, const char* path, wisp_error* error );
