/// Hard cases: cells of a matrix, each a scene that is run for some seconds, watched in every frame and judged by
/// limits.
#pragma once

#include "bench_options.h"
#include "wisp/wisp.h"

#define STABILITY_SECONDS 5.0 ///< that a cell lasts
#define STABILITY_FRAME ( 1.0f / 60.0f )
#define STABILITY_GRAVITY 9.81f ///< m/s^2

// ---- what is seen, and what is allowed ----

/// What a frame shows.
typedef struct stability_look
{
    bool is_finite;      ///< all coordinates and velocities
    bool is_halted;      ///< the engine has put it back and halted it
    double strain;       ///< largest |l/l0 - 1| of the edges or segments
    double strain_limit; ///< what the setting can deliver in this moment
    double energy;       ///< J, of motion, height and constraints that are not met; NaN: not known
    double speed;        ///< m/s: the farthest way of a vertex since the look before, over its time
    double
        breach; ///< how far something is where it must not be: a depth over what is allowed, or intersections; 0: nothing
} stability_look;

/// What breaks a cell. INFINITY: no limit.
typedef struct stability_limits
{
    double energy;       ///< J above the energy after the last push
    double jitter;       ///< m/s, the highest speed in the last frames
    double breach;       ///< at most, after the frames that are driven
    int driven_frames;   ///< in which something is pushed or pulled from outside: its work is not known
    int recovery_frames; ///< after which the strain is below its limit and stays there
    int still_frames;    ///< at the end, in which speeds are jitter
    double speed;        ///< m/s that nothing may ever exceed
    double strain; ///< at most, beside what the setting can deliver: what a twin that starts at rest leads to expect
    bool may_halt; ///< to halt is what the engine is expected to do
} stability_limits;

typedef enum stability_limit
{
    STABILITY_LIMIT_NONE,
    STABILITY_LIMIT_FINITE,   ///< a number is none
    STABILITY_LIMIT_HALTED,   ///< the engine put it back and halted it, which is finite and no pass
    STABILITY_LIMIT_STRAIN,   ///< too long or too short at the end
    STABILITY_LIMIT_RECOVERY, ///< within the limits of strain too late
    STABILITY_LIMIT_ENERGY,   ///< more energy than there was and work was done
    STABILITY_LIMIT_SPEED,    ///< faster than what pushed it can make it
    STABILITY_LIMIT_JITTER,   ///< does not come to rest
    STABILITY_LIMIT_BREACH,   ///< intersections, or deep in a body
    STABILITY_LIMIT_CLAIM,    ///< what a named case claims does not hold
    STABILITY_LIMIT_BITS,     ///< other bits with two workers
    STABILITY_LIMIT_COUNT,
} stability_limit;

/// One word each, [STABILITY_LIMIT_COUNT].
extern const char* const stability_limit_names[STABILITY_LIMIT_COUNT];

/// What was seen so far. Zero-initialised is nothing.
typedef struct stability_score
{
    int frames; ///< looks after the one before the first step
    stability_look last;
    double strain_max;
    double energy_start; ///< J, after the last push
    double energy_rise;  ///< J above it, at most; NaN: not known
    double jitter;
    double speed_max;
    double breach_max;
    int beyond;             ///< the last frame whose strain was beyond its limit; 0: none
    int not_finite, halted; ///< the first frame in which it was; 0: none
} stability_score;

/// @param frame_count of the whole run, so that the last ones are known
void stability_watch( stability_score* score, const stability_limits* limits, int frame_count,
                      const stability_look* look );

typedef struct stability_verdict
{
    stability_limit broke;    ///< none: it holds
    double measured, allowed; ///< of the limit that broke
    int frames;               ///< that it took to recover; 0: it was never beyond its limit
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
    wisp_status ( *look )( void* context, int frame, stability_look* out, wisp_error* error );
    uint64_t ( *hash )( void* context ); ///< of what is seen at the end
    wisp_world* world;                   ///< to read its counters; may be null
    void ( *close )( void* context );
} stability_trial;

typedef enum stability_start
{
    STABILITY_START_REST,
    STABILITY_START_RANDOM,     ///< every vertex anywhere in a box as wide as the body
    STABILITY_START_PLANE,      ///< flattened to the level plane through its middle
    STABILITY_START_POINT,      ///< all in its middle
    STABILITY_START_INSIDE_OUT, ///< reflected in the point it hangs from, or in its middle
    STABILITY_START_TWISTS,     ///< ten full turns about the vertical from one end to the other
    STABILITY_START_COUNT,
} stability_start;

extern const char* const stability_start_names[STABILITY_START_COUNT];

/// Where a cell stands on the axes.
typedef struct stability_axes
{
    stability_start start;
    float seconds;    ///< a step
    float mass_ratio; ///< of the heaviest vertex, which hangs lowest, to the lightest
    float stiffness;  ///< SI, of what the solver calls its stiffness; 0: what it is used with
    float scale;      ///< of all lengths
} stability_axes;

/// What axes mean to something that can be simulated in several ways.
typedef struct stability_subject
{
    const char* name; ///< of the way, unique
    int way;
    wisp_status ( *enter )( int way, const stability_axes* axes, int workers, stability_trial* out,
                            wisp_error* error );
    bool has_stiffness, has_mass_ratio;
    bool has_pairs;      ///< pairs of ends are tried as well
    float max_stiffness; ///< beyond it the engine must refuse with a message; 0: it takes all
} stability_subject;

typedef struct stability_cell
{
    char name[64];
    const stability_subject* subject;
    stability_axes axes;
    bool is_refused;  ///< it must be
    bool two_workers; ///< it is run with two workers as well, and must have the same hash
} stability_cell;

typedef struct stability_outcome
{
    stability_score score;
    stability_limits limits;
    stability_verdict verdict;
    uint64_t hash;
    uint64_t undirected, laid, unsolved, halted; ///< counters of the world
    bool is_refused;                             ///< the engine did not take it
    char said[160];                              ///< what a named case claims, with its figures; empty: nothing
} stability_outcome;

/// Step a trial to its end, judge it and close it.
wisp_status stability_run( stability_trial* trial, stability_outcome* out, wisp_error* error );
/// Run a cell with one worker, and with two where it asks for it.
/// @param max_strain INFINITY, or what the strain is held to beside what the setting can deliver
wisp_status stability_run_cell( const stability_cell* cell, double max_strain, stability_outcome* out,
                                wisp_error* error );

// ---- the matrix ----

/// Ways of each room. @param count receives how many
const stability_subject* stability_cloths( int* count );
const stability_subject* stability_balloons( int* count );
const stability_subject* stability_strand_subjects( int* count );

/// Of the cell before it that differs in the start alone, which is at rest; -1 if there is none, or it is one itself.
int stability_twin( const stability_cell* cells, int cell );

/// The base, each axis alone, and all pairs of extremes. @param cells to be freed @return -1 without memory
int stability_matrix( const stability_subject* subject, bool quick, stability_cell** cells );

// ---- cells with a scene of their own ----

typedef struct stability_named
{
    const char* name;
    bool quick;
    bool is_long; ///< a long run, only if requested
    int kind;     ///< what its run makes of it
    wisp_status ( *run )( int kind, int workers, stability_outcome* out, wisp_error* error );
} stability_named;

const stability_named* stability_drives( int* count );    ///< pins that jump, bodies that are fast, contact
const stability_named* stability_meshes( int* count );    ///< topology that breaks others
const stability_named* stability_followers( int* count ); ///< ghosts, frozen hair, boundary particles
const stability_named* stability_failures( int* count );  ///< the nine known failures

/// A cell's outcome where something is claimed and compared: broken unless it holds. The words have its figures.
void stability_claim( stability_outcome* out, bool holds, const char* format, ... )
    __attribute__( ( format( printf, 3, 4 ) ) );

/// The case. Without `quick` all ways and pairs; with `longest` the soaks as well.
bench_case_fn stability_bench;

// ---- lists of what does not hold ----

typedef struct stability_known
{
    const char* cell;
    stability_limit broke;
} stability_known;

/// Cells that docs/limits.md lists. @param count receives how many
const stability_known* stability_known_limits( int* count );
/// @return null if the cell is not on the list
const stability_known* stability_find_known( const stability_known* list, int count, const char* cell );
/// A cell off the list holds, and one on it breaks as it says: whatever else is a failure of the run.
bool stability_is_as_known( const stability_known* known, stability_limit broke );
