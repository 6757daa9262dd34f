/// The search for scenes that break a judge, and what it has found.
#pragma once

#include "results.h"
#include "text_tree.h"
#include "torture_generate.h"
#include "torture_twins.h"

typedef struct torture_search
{
    torture_generator generator;
    int first;            ///< number of the first scene
    int jobs;             ///< scenes at the same time, >= 1
    int max_scenes;       ///< 0: as many as the time allows
    double max_seconds;   ///< of wall time; infinite: as many scenes as requested
    double scene_seconds; ///< wall time of a scene
    const char* folder;   ///< where smaller scenes that break are written
    int close;            ///< TORTURE_CLOSE, or 0
    int keep;             ///< scenes of a kind that are made smaller and written; more are only counted
} torture_search;

typedef struct torture_found
{
    int scenes, refused; ///< tried, and of those refused
    int broken[STABILITY_CHECK_COUNT];
    double seconds;
} torture_found;

/// Search. @param out receives what was found, also as tables @return a folder that cannot be written
wisp_status torture_search_run( const torture_search* search, torture_found* found, results* out, wisp_error* error );

/// Judge files with all twins. @param close TORTURE_CLOSE, or 0 @return a file that cannot be read
wisp_status torture_replay( const char* const* files, int count, int close, double scene_seconds,
                            torture_found* found, results* out, wisp_error* error );

/// @return the twin that a search runs of a scene: each has one, in turn
int torture_twins_for( int number );

/// @return scenes that broke a judge
int torture_broken_count( const torture_found* found );

// ---- smaller scenes of which something stays true, such as that they break the same judge ----

/// @return whether the smaller scene still shows what is looked for
typedef bool torture_shows_fn( void* user, const text_node* scene );

typedef struct torture_shrink_def
{
    torture_shows_fn* shows;
    void* user;
    int max_tries;      ///< runs
    double max_seconds; ///< of wall time
} torture_shrink_def;

/// Take entries, keys and items out, lower counts, and round numbers to one or two digits, over and over, until
/// nothing smaller shows it or a limit is reached. @param scene shows it, and is changed @return tries that were made
int torture_shrink( const torture_shrink_def* def, text_node* scene );
