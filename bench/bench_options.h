/// What a case is told: how long it may take, with how many workers, and whom it tells of its progress.
#pragma once

#include "results.h"
#include "wisp/base.h"

typedef struct bench_options
{
    bool quick; ///< fewer samples and settings, shorter runs, without the largest sizes; notes say what is left out
    double seconds;       ///< about how long a case may take; 0: 85, or 18 when quick, so that 90 and 20 are kept
    int workers;          ///< of the parallel variant
    uint64_t scenes;      ///< the case `accuracy`: bit i chooses scene i of accuracy_entries(); 0: all of them
    bool longest;         ///< the case `stability`: a million steps at rest as well
    const char* pictures; ///< folder that cases with pictures write them to, which must exist; null: no pictures
    /// Told what is running and how much of the case is done, in [0, 1]; may be null.
    void ( *progress )( void* user, double fraction, const char* what );
    void* progress_user;
} bench_options;

/// Default options of the program.
bench_options bench_default_options( void );
/// The case's time in seconds after its defaults.
double bench_seconds( const bench_options* options );
/// "worker" or "workers".
const char* bench_workers_word( int workers );
void bench_progress( const bench_options* options, double fraction, const char* what );

typedef wisp_status bench_case_fn( const bench_options* options, results* out, wisp_error* error );
