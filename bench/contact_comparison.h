/// One scene by several ways to keep surfaces apart, step by step in turns: each in a world of its own for every
/// worker count, without figures, and once more with figures. Their hashes must be the same.
#pragma once

#include "bench_options.h"
#include "cells.h"
#include "contact_scene.h"

#define CONTACT_TEAMS_MAX 2

/// Worker counts that are timed.
typedef struct contact_teams
{
    int workers[CONTACT_TEAMS_MAX], count;
} contact_teams;

/// What the figures of all steps come to.
typedef struct contact_tally
{
    double pairs, contacts, searches; ///< means per step; NaN without contact
    int intersections_last, max_intersections, crossed_steps;
    float min_gap;     ///< of the thickness, of all steps; infinite where no pair was near
    int64_t limited;   ///< sum
    double impulse;    ///< N s, of the last step, sum of magnitudes
    double unbalanced; ///< N s, the most that forces between participants did not cancel in a step
    double speed;      ///< m/s, of the fastest vertex at the end
    int halted_at;
} contact_tally;

typedef struct contact_run
{
    contact_way way;
    contact_world timed[CONTACT_TEAMS_MAX], seen;
    double* ms[CONTACT_TEAMS_MAX]; ///< [steps]
    stats_summary time[CONTACT_TEAMS_MAX];
    double mean[CONTACT_TEAMS_MAX], worst[CONTACT_TEAMS_MAX]; ///< ms
    int steps;                                                ///< that it made
    double seconds;                                           ///< that it took
    uint64_t hash;
    bool same_hash; ///< of every world
    contact_tally tally;
} contact_run;

/// Measures the world after a step.
typedef wisp_status contact_observation_fn( contact_run* run, int number, void* context, wisp_error* error );

typedef struct contact_comparison
{
    const contact_scene* scene;
    contact_enter_fn* enter;
    const contact_way* ways;
    int way_count, steps;
    double seconds; ///< a way that takes longer ends with that turn
    const contact_teams* teams;
    contact_observation_fn* observe; ///< may be null
    void* context;                   ///< for `observe`
    int observe_every;               ///< steps
    const bench_options* options;
    const char* name;   ///< for progress and rows
    double begin, span; ///< share of the case that is done before, and that the race is
} contact_comparison;

/// @param runs [way_count] receives what was measured; their worlds are gone
wisp_status contact_comparison_run( const contact_comparison* comparison, contact_run* runs, wisp_error* error );

/// Rows for machines, one for each worker count.
void contact_comparison_add_rows( const contact_comparison* comparison, const contact_run* run, results* out );
/// Begin a table: what `header` has already, times for each worker count, then `names`.
int contact_comparison_begin_table( const contact_comparison* comparison, cells* header, const char* const* names,
                                    int name_count, const char* title, results* out );
/// Cells `median / mean / worst` for each worker count.
void contact_comparison_put_times( const contact_comparison* comparison, const contact_run* run, cells* row );
/// A failure unless all worlds of a run have one hash, and none was halted.
void contact_comparison_check( const contact_comparison* comparison, const contact_run* run, results* out );
