/// What must be true of every run of a scene: checks of its trace, and of its bits.
#pragma once

#include "stability_trace.h"

/// In the order in which they judge; the first one that a run breaks is the verdict.
typedef enum stability_check
{
    STABILITY_HOLDS = -1,
    STABILITY_CRASH,         ///< the process died
    STABILITY_TIME,          ///< it did not end
    STABILITY_REFUSED,       ///< the reader takes the scene and the engine does not
    STABILITY_STATUS,        ///< a step failed
    STABILITY_FINITE,        ///< a coordinate, energy or speed is not finite
    STABILITY_HALTED,        ///< the engine gave up an entity
    STABILITY_ENERGY,        ///< more energy than was brought in
    STABILITY_STRAIN,        ///< edges longer than weight and stiffness explain
    STABILITY_RECOVERY,      ///< the same, until too late
    STABILITY_SPEED,         ///< faster than what moves it can explain
    STABILITY_PENETRATION,   ///< vertices inside a collider at rest
    STABILITY_INTERSECTIONS, ///< edges through triangles that contact should have kept apart
    STABILITY_REST,          ///< motion that does not die
    STABILITY_NEAR,          ///< a measure far from the value that it should have
    STABILITY_SAME,          ///< other bits than another row
    STABILITY_BITS,          ///< other bits with other workers or instruction sets
    STABILITY_SNAPSHOT,      ///< other bits after a snapshot and its restoration
    STABILITY_SCALE,         ///< another motion at ten times or a tenth of the size
    STABILITY_SHIFT,         ///< another motion 100 m away
    STABILITY_CHECK_COUNT,
} stability_check;

/// Short names, as reports and options have them.
extern const char* const stability_check_names[STABILITY_CHECK_COUNT];

typedef struct stability_verdict
{
    stability_check check;
    int step;          ///< after which it shows, counted from 1; 0: none in particular
    double severity;   ///< what was measured over what is allowed; 1 where nothing is measured
    char message[320]; ///< a sentence with figures; empty if everything holds
} stability_verdict;

/// A check in a set of them.
static inline unsigned stability_bit( stability_check check )
{
    return 1u << check;
}

enum
{
    STABILITY_CLOSE = 1u << 30, ///< with the limits of stability_figures, too
    STABILITY_ALL = ( 1u << STABILITY_CHECK_COUNT ) - 1,
};

enum
{
    STABILITY_MAX_NEAR = 16,
};

/// What is taken of a measure over the run.
typedef enum stability_take
{
    STABILITY_TAKE_END, ///< its value at a time
    STABILITY_TAKE_MEAN,
    STABILITY_TAKE_MIN,
    STABILITY_TAKE_MAX,
    STABILITY_TAKE_PERIOD, ///< s, of its swing about its mean
    STABILITY_TAKE_CHANGE, ///< its value at the end less that at a time
    STABILITY_TAKE_COUNT,
} stability_take;

extern const char* const stability_near_takes[STABILITY_TAKE_COUNT];

/// A measure of a body and the value that it must come near.
typedef struct stability_near
{
    char of[96];       ///< such as "rod.tip.y": the body, a point and an axis; or the body and `speed`, `volume`, ..
    int name_length;   ///< of the body in it
    int measure, axis; ///< measure: by its number in a table; -1: the vertex
    int vertex, other; ///< other: to which the distance is; -1: none
    stability_take take;
    double at;            ///< s; 0: the end, or all of the run
    double value, within; ///< in SI units
    char from[120];       ///< where the value is from
} stability_near;

/// Limits that a user gives in place of those that are found. 0: none is given.
typedef struct stability_limits
{
    stability_near near[STABILITY_MAX_NEAR];
    int near_count;
    char same[160]; ///< the row with the same bits; empty: none
    double strain;  ///< at the end, 1
    double energy;  ///< J, above that when inputs came to rest, or above the start if they never do
    double speed;   ///< m/s
    double rest;    ///< m/s, in the last twentieth of the run
} stability_limits;

/// Read what is measured, such as "rod.tip.y". @return false: it is no measure
bool stability_near_parse( const char* of, stability_near* out );
/// All words for measures, in a list.
const char* stability_near_words( void );
/// Put what is measured of a body after a step into the trace. @param at [vertex_count] @param row 0: the start
void stability_measure_near( const scene_world* world, int body, const wisp_vec3* at, const stability_sample* sample,
                             int row, stability_trace* trace );
bool stability_judge_near( const stability_trace* trace, const stability_limits* limits, stability_verdict* out );

/// Judge a trace. @param checks or-ed; those that need more than a trace are left out
/// @param limits null: none are given @return whether it holds
bool stability_judge_trace( const stability_trace* trace, unsigned checks, const stability_limits* limits,
                            stability_verdict* out );

typedef bool stability_judge_fn( const stability_trace* trace, stability_verdict* out );
stability_judge_fn stability_judge_status, stability_judge_finite, stability_judge_halted, stability_judge_energy,
    stability_judge_strain, stability_judge_penetration, stability_judge_intersections, stability_judge_rest;

/// @return whether inputs rest long enough at the end of the run for its bodies to be judged as they are then
bool stability_is_at_rest( const stability_trace* trace );
/// @return whether pins, colliders or heads may hold a body stretched, or inside of something
bool stability_is_held( const stability_trace* trace, int body );

/// What a run shows next to its limits, which are infinite where none is known.
typedef struct stability_figures
{
    double strain, strain_limit; ///< at the end, of the body that is nearest to its limit, or of all if there is none
    double recovery, recovery_limit; ///< s after all inputs came to rest, until no edge is beyond its limit
    double energy, energy_limit;     ///< J above that when inputs came to rest
    double speed, speed_limit;       ///< m/s
    double rest, rest_limit;         ///< m/s, in the last twentieth of the run
    int strain_body, rest_body;      ///< -1: nothing moves
    int recovery_body;
    int recovery_row, energy_row, speed_row; ///< when; 0: never
} stability_figures;

/// @param limits null: none are given
stability_figures stability_figures_of( const stability_trace* trace, const stability_limits* limits );
/// @return those of energy, strain and rest among `checks` that have no limit but those for any run, or-ed
unsigned stability_without_limit( const stability_figures* figures, unsigned checks );

/// Make steps and keep the hash after each. @return steps that were made
int stability_hash_steps( scene_world* world, int steps, uint64_t* hashes );
/// Compare the hashes after the steps of two runs. @param first steps before them @param how the second run was made,
/// such as "with 2 workers than with one" @return whether they are equal
bool stability_compare_bits( const uint64_t* expected, int expected_count, const uint64_t* found, int found_count,
                             stability_check judge, int first, const char* how, stability_verdict* out );

/// Run a scene with other numbers of workers and other instruction sets, and compare bits after every step.
/// @param steps at most @return whether they are equal
bool stability_judge_bits( const wisp_scene* scene, int steps, stability_verdict* out );
