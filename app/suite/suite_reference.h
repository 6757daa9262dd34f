/// What errors of a suite are measured against: a stored recording, a converged run, or what runs with more and more substeps converge to. Runs
/// are made on request and kept.
#pragma once

#include "suite_motion.h"

typedef struct suite_reference
{
    bool exists;   ///< the suite has one
    bool is_start; ///< it is where bodies start
    suite_times times;
    suite_motion motion;
    suite_comparison
        doubt; ///< the coarser reference compared with this one. A stored one is compared with itself: 0, and the
               ///< distance that the suite says. NaN: rows have no such value
    double parts_at; ///< s, when both are one percent of their size apart; INFINITY: they never are
    int frame_count; ///< that are compared: those before, or all if there is none
    char description[200];
} suite_reference;

/// Read or make the reference of a suite, if it has one. Runs are kept in the cache folder (suite_cache_folder()) under the hash of their scene
/// and settings, and found there the next time.
/// @param out to be released, after a failure too
wisp_status suite_reference_make( const wisp_suite* suite, suite_reference* out, wisp_error* error );
void suite_reference_release( suite_reference* reference );

/// Run a row in this process, and measure its error too. Instructions are not counted.
/// @param observer may be null
/// @return WISP_BAD_INPUT the row cannot be compared with the reference (the message says why)
wisp_status suite_reference_run( const suite_reference* reference, const suite_row* row, const char* isa,
                                 const suite_observer* observer, suite_measurement* out, wisp_error* error );

/// `$WISP_CACHE`, else `$XDG_CACHE_HOME/wisp`, else `$HOME/.cache/wisp`. @return false: none of them is set
bool suite_cache_folder( char* out, size_t size );
