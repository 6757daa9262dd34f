/// A scenario: steps to warm up and measured steps, the same for every worker count, with samples of the state.
#pragma once

#include "results.h"
#include "surface_implementation.h"

#define SCENARIO_IMPLEMENTATIONS_MAX 2

typedef struct scenario_plan
{
    int warm_steps, measured_steps;
    int turn_steps; ///< steps per turn; the first step of a turn refills the caches and is not counted
} scenario_plan;

/// Where all vertices were at the observations of the warm-up: what falls has not folded yet, and folds are chaotic. No two
/// solvers agree on them, so a path through them measures nothing.
typedef struct path_record
{
    int vertex_count, observation_count;
    double* points; ///< [observation_count][vertex_count][3], the user's order; null: there is none
} path_record;

/// Observations of the path: after every `turn_steps` of the warm-up.
int scenario_path_observations( const scenario_plan* plan );
/// @return WISP_NO_MEMORY
wisp_status path_record_create( int vertex_count, int observation_count, path_record* out, wisp_error* error );
void path_record_destroy( path_record* record );

/// What a scenario showed. Averages are over observations at the end of each turn of the measured steps.
typedef struct scenario_stats
{
    stats_summary ms[SCENARIO_IMPLEMENTATIONS_MAX]; ///< NaN if the surface was halted
    double links_ms[SCENARIO_IMPLEMENTATIONS_MAX];  ///< of the passes over links
    double stretch_max, stretch_mean;               ///< averages
    double kinetic;                                 ///< J, average
    double energy_lost; ///< share of the potential energy released by the end of the warm-up that is no longer there
    double path;        ///< m, root mean square distance to the reference's path over the warm-up; NaN without one
    uint64_t hash[SCENARIO_IMPLEMENTATIONS_MAX];
    int halted_at; ///< 0: never
} scenario_stats;

/// Run a scenario with implementations that differ only in workers.
/// @param reference the path to compare with, or null
/// @param record [scenario_path_observations()] receives the first implementation's path, or null
wisp_status scenario_run( surface_implementation* implementations, int count, const scenario_plan* plan,
                          const path_record* reference, path_record* record, scenario_stats* out, wisp_error* error );

/// A failure unless all hashes are the same.
/// @param what names the row in the message
void scenario_check_hashes( const surface_implementation* implementations, int count, const uint64_t* hashes,
                            const char* what, results* out );

struct cells;

/// Cells of the median and the quantiles for each implementation, or the step at which the engine halted it.
void scenario_put_times( const scenario_stats* stats, int count, struct cells* row );
/// A row for machines for each implementation.
void scenario_add_rows( const surface_implementation* implementations, int count, const scenario_stats* stats,
                        const char* name, const char* variant, const char* reference_name, results* out );
