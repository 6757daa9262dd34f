/// Hard cases: cells of a matrix, each a scene that runs for some seconds, is sampled in every frame and checked
/// against limits.
#pragma once

#include "bench_options.h"
#include "wisp/wisp.h"

#define STABILITY_SECONDS 5.0 ///< duration of a cell
#define STABILITY_FRAME ( 1.0f / 60.0f )
#define STABILITY_GRAVITY 9.81f ///< m/s^2

// ---- samples and limits ----

/// Values of one frame.
typedef struct stability_observation
{
    bool is_finite;      ///< all coordinates and velocities
    bool is_halted;      ///< the engine has restored and halted it
    double strain;       ///< largest |l/l0 - 1| of the edges or segments
    double strain_limit; ///< reachable by the setting at this moment
    double energy;       ///< J, kinetic, potential and of violated constraints; NaN: not known
    double speed;        ///< m/s: largest displacement of a vertex since the last sample, over its time
    double breach;       ///< violation of a forbidden region: a depth over the allowed one, or intersections; 0: none
} stability_observation;

/// Limits of a cell. INFINITY: no limit.
typedef struct stability_limits
{
    double energy;       ///< J above the energy after the last push
    double jitter;       ///< m/s, the highest speed in the last frames
    double breach;       ///< largest, after the driven frames
    int driven_frames;   ///< with external forces, whose work is not known
    int recovery_frames; ///< after which the strain stays below its limit
    int still_frames;    ///< at the end, in which speeds are jitter
    double speed;        ///< m/s, limit at all times
    double strain; ///< in addition to the strain reachable by the setting: expected from the cell that starts at rest
    bool may_halt; ///< the engine is expected to halt it
} stability_limits;

typedef enum stability_limit
{
    STABILITY_LIMIT_NONE,
    STABILITY_LIMIT_FINITE,   ///< NaN or infinite
    STABILITY_LIMIT_HALTED,   ///< the engine restored and halted it, which is finite and no pass
    STABILITY_LIMIT_STRAIN,   ///< too long or too short at the end
    STABILITY_LIMIT_RECOVERY, ///< within the limit of strain too late
    STABILITY_LIMIT_ENERGY,   ///< energy above its initial value plus work
    STABILITY_LIMIT_SPEED,    ///< faster than its drive can explain
    STABILITY_LIMIT_JITTER,   ///< does not come to rest
    STABILITY_LIMIT_BREACH,   ///< intersections, or deep in a body
    STABILITY_LIMIT_CLAIM,    ///< the statement of a named case does not hold
    STABILITY_LIMIT_BITS,     ///< different bits with two workers
    STABILITY_LIMIT_COUNT,
} stability_limit;

/// One word each, [STABILITY_LIMIT_COUNT].
extern const char* const stability_limit_names[STABILITY_LIMIT_COUNT];

/// Results so far. Zero-initialised is empty.
typedef struct stability_score
{
    int frames; ///< samples after the one before the first step
    stability_observation last;
    double strain_max;
    double energy_start; ///< J, after the last push
    double energy_rise;  ///< J above it, at most; NaN: not known
    double jitter;
    double speed_max;
    double breach_max;
    int beyond;             ///< the last frame whose strain was beyond its limit; 0: none
    int not_finite, halted; ///< the first frame in which it was; 0: none
} stability_score;

/// @param frame_count of the whole run, to identify the last ones
void stability_watch( stability_score* score, const stability_limits* limits, int frame_count,
                      const stability_observation* observation );

typedef struct stability_verdict
{
    stability_limit broke;    ///< none: it holds
    double measured, allowed; ///< of the limit that broke
    int frames;               ///< time of recovery; 0: it was never beyond its limit
} stability_verdict;

stability_verdict stability_judge( const stability_score* score, const stability_limits* limits );

// ---- a cell while it runs ----

/// A scene that is stepped and sampled. The function that builds it fills it; its close() frees it.
typedef struct stability_trial
{
    stability_limits limits;
    int frame_count;
    void* context;
    wisp_status ( *step )( void* context, int frame, wisp_error* error ); ///< frames count from 1
    /// @param frame 0: before the first step
    wisp_status ( *observe )( void* context, int frame, stability_observation* out, wisp_error* error );
    uint64_t ( *hash )( void* context ); ///< hash of the final state
    wisp_world* world;                   ///< to read its counters; may be null
    void ( *close )( void* context );
} stability_trial;

typedef enum stability_start
{
    STABILITY_START_REST,
    STABILITY_START_RANDOM,     ///< every vertex at random in a box as wide as the body
    STABILITY_START_PLANE,      ///< flattened to the level plane through its centre
    STABILITY_START_POINT,      ///< all at its centre
    STABILITY_START_INSIDE_OUT, ///< reflected in the point it hangs from, or in its centre
    STABILITY_START_TWISTS,     ///< ten full turns about the vertical from one end to the other
    STABILITY_START_COUNT,
} stability_start;

extern const char* const stability_start_names[STABILITY_START_COUNT];

/// The position of a cell on the axes.
typedef struct stability_axes
{
    stability_start start;
    float seconds;    ///< per step
    float mass_ratio; ///< of the heaviest vertex, which hangs lowest, to the lightest
    float stiffness;  ///< SI, the stiffness of the solver; 0: its usual value
    float scale;      ///< of all lengths
} stability_axes;

/// The axes of a body that has several solvers.
typedef struct stability_subject
{
    const char* name; ///< of the solver, unique
    int way;
    wisp_status ( *enter )( int way, const stability_axes* axes, int workers, stability_trial* out,
                            wisp_error* error );
    bool has_stiffness, has_mass_ratio;
    bool has_pairs;      ///< pairs of ends run as well
    float max_stiffness; ///< above it the engine must reject the setting with a message; 0: no limit
} stability_subject;

typedef struct stability_cell
{
    char name[64];
    const stability_subject* subject;
    stability_axes axes;
    bool is_refused;  ///< required
    bool two_workers; ///< also run with two workers, which must give the same hash
} stability_cell;

typedef struct stability_outcome
{
    stability_score score;
    stability_limits limits;
    stability_verdict verdict;
    uint64_t hash;
    uint64_t undirected, laid, unsolved, halted; ///< counters of the world
    bool is_refused;                             ///< the engine rejected it
    char said[160];                              ///< the statement of a named case, with its numbers; empty: none
} stability_outcome;

/// Step a trial to its end, evaluate it and close it.
wisp_status stability_run( stability_trial* trial, stability_outcome* out, wisp_error* error );
/// Run a cell with one worker, and with two if it demands it.
/// @param max_strain INFINITY, or the limit of strain in addition to that reachable by the setting
wisp_status stability_run_cell( const stability_cell* cell, double max_strain, stability_outcome* out,
                                wisp_error* error );

// ---- the matrix ----

/// The solvers of a kind. @param count receives their number
const stability_subject* stability_cloths( int* count );
const stability_subject* stability_balloons( int* count );
const stability_subject* stability_strand_subjects( int* count );

/// The preceding cell that differs only in its start, which is at rest; -1 if there is none, or it is one itself.
int stability_twin( const stability_cell* cells, int cell );

/// The base, each axis alone, and all pairs of ends. @param cells to be freed @return -1 without memory
int stability_matrix( const stability_subject* subject, bool quick, stability_cell** cells );

// ---- cells with separate scenes ----

typedef struct stability_named
{
    const char* name;
    bool quick;
    bool is_long; ///< a long run, only if requested
    int kind;     ///< result of its run
    wisp_status ( *run )( int kind, int workers, stability_outcome* out, wisp_error* error );
} stability_named;

const stability_named* stability_drives( int* count );    ///< pins that jump, bodies that are fast, contact
const stability_named* stability_meshes( int* count );    ///< bad topology
const stability_named* stability_followers( int* count ); ///< ghosts, frozen hair, boundary particles
const stability_named* stability_failures( int* count );  ///< the nine known failures

/// The result of a cell with a statement about compared runs: broken unless it holds. The text has its numbers.
void stability_claim( stability_outcome* out, bool holds, const char* format, ... )
    __attribute__( ( format( printf, 3, 4 ) ) );

/// The case. Without `quick` all solvers and pairs; with `longest` the long runs as well.
bench_case_fn stability_bench;

// ---- lists of known failures ----

typedef struct stability_known
{
    const char* cell;
    stability_limit broke;
} stability_known;

/// Cells that docs/limits.md lists. @param count receives how many
const stability_known* stability_known_limits( int* count );
/// @return null if the cell is not on the list
const stability_known* stability_find_known( const stability_known* list, int count, const char* cell );
/// An unlisted cell holds, and a listed one breaks as stated: anything else is a failure of the run.
bool stability_is_as_known( const stability_known* known, stability_limit broke );
