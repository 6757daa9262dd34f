/// A suite: scenes, settings to vary, budgets, checks, and what errors are measured against. A YAML file, read into rows, each of which
/// is a scene with its settings.
#pragma once

#include "scene.h"
#include "stability_judges.h"
#include "text_tree.h"
#include "wisp/base.h"

#include <stdio.h>

enum
{
    SUITE_MAX_ROWS = 1 << 14,
    SUITE_MAX_NAME = 64,
    SUITE_MAX_VARIANT = 192,
    SUITE_MAX_LABEL = SUITE_MAX_NAME + SUITE_MAX_VARIANT + 4,
};

/// What is measured of a row, and may become worse by its budget.
typedef enum suite_measure
{
    SUITE_INSTRUCTIONS, ///< of all steps; NaN where they were not counted
    SUITE_CYCLES,       ///< estimated: instructions, misses of caches, divisions and roots; NaN as above
    SUITE_BYTES,        ///< of the world at the end
    SUITE_ALLOCATIONS,  ///< in the second half of the steps
    SUITE_ERROR,   ///< m, root mean square distance to the reference; NaN without one, infinity if it is not finite
    SUITE_STRETCH, ///< the largest mean of an entity's |l / l0 - 1| after any step
    SUITE_ENERGY,  ///< J, the largest sum of all entities above the start
    SUITE_PENETRATION,       ///< m, of the deepest vertex below what a collider keeps, after any step
    SUITE_INTERSECTIONS,     ///< edges through triangles at the end, where the scene counts them
    SUITE_SOLVER_ITERATIONS, ///< of linear solves in all steps; NaN where nothing is solved so
    SUITE_RESETS,            ///< strands that were put back to their rest lengths
    SUITE_NOT_CONVERGED,     ///< linear solves that reached their limit
    SUITE_HALTED,            ///< entities
    SUITE_MEASURE_COUNT,
    SUITE_HASH = SUITE_MEASURE_COUNT, ///< other bits, 1 or 0: has a budget and no value
    SUITE_BUDGET_COUNT,
} suite_measure;

/// A budget: how much larger than in the base a value may be.
typedef struct suite_budget
{
    double relative; ///< fraction of the base's value
    double absolute; ///< in the unit of the measure, added to that
} suite_budget;

typedef struct suite_measure_info
{
    const char* name;    ///< key of budgets and of base files
    suite_budget budget; ///< default
} suite_measure_info;

extern const suite_measure_info suite_measures[SUITE_BUDGET_COUNT];

/// A scene in memory, which a suite has in place of its scenes' file.
typedef struct suite_given
{
    const char* text; ///< [size]
    size_t size;
    const wisp_scene_arrays* arrays; ///< [array_count] in place of files that the scene names
    int array_count;
} suite_given;

/// A scene with its settings.
typedef struct suite_row
{
    char name[SUITE_MAX_NAME];
    char variant[SUITE_MAX_VARIANT]; ///< the values that vary, such as `substeps=4`; empty: none do
    char series[192];                ///< rows that differ from this one in `along` alone; empty: it is in no series
    char along[SUITE_MAX_NAME];      ///< the field that a series varies
    double along_value;
    double order;             ///< at which errors of the series should fall; NaN: none is promised
    char* path;               ///< of the scene, whose folder its files are in
    const suite_given* given; ///< where the scene came from; null: a file
    char* text;               ///< the scene
    int steps;                ///< that are made; 0: all of the scene
    suite_budget budgets[SUITE_BUDGET_COUNT];
    unsigned checks;         ///< that must hold, as stability_bit() has them; 0: none
    stability_limits limits; ///< that checks are given
    int same;                ///< rows from here to that with the same bits; 0: none
    double seconds;          ///< that are simulated; 0: `steps`
    bool is_refused;         ///< the reader or the engine must refuse it with a message
    char refusal[200];       ///< the reader's, of a row that is_refused; empty: it took it
    bool is_slow;            ///< left out with --quick
    bool is_long;            ///< only with --long
    double agree;            ///< how far rows of this name may hang from each other, in sizes; 0: any
    int known;               ///< stability_check that it is known to break; -1: it must hold
    int reference;           ///< of the suite's `references`
} suite_row;

/// The converged run that errors are measured against, and a coarser one whose distance to it is its doubt. With `extrapolate` they
/// have a half and a quarter of the substeps: `check` and `coarsest`, which has text then.
typedef struct suite_runs
{
    suite_row fine, check, coarsest;
} suite_runs;

typedef struct wisp_suite
{
    char name[SUITE_MAX_NAME]; ///< that of the file, without folder and extension
    char title[160];           ///< one line; empty: none
    char* note;                ///< for readers of the tables; null: none
    suite_row* rows;
    int row_count;
    suite_runs*
        references; ///< [reference_count] the first one of the suite's file, then those of rows that differ in text
    int reference_count;
    double extrapolate;    ///< order of the runs that the reference is extrapolated from; 0: it is a run
    bool compares_start;   ///< errors are distances from where bodies start
    bool compares_overlap; ///< errors are how deep balloons are in each other
    char* stored;          ///< recording that is the reference, in place of a run; null: none
    double stored_doubt;   ///< m, how far it may be from the truth; 0: not said
    bool has_checks;       ///< of any row
} wisp_suite;

/// Read a suite and its scenes, and check that every row is a scene.
/// @param out to be released, also after a failure
/// @return WISP_BAD_INPUT the suite or a row is wrong (the message names file, line and path); WISP_IO_ERROR
wisp_status suite_read( const char* path, wisp_suite* out, wisp_error* error );
/// The same from a text. @param path of the suite, which its files are relative to and messages name
/// @param given all scenes are this one, which must outlive the suite; may be null
wisp_status suite_parse( const char* text, size_t size, const char* path, const suite_given* given, wisp_suite* out,
                         wisp_error* error );
void suite_release( wisp_suite* suite );

/// The name of a row and what varies, as tables and lists of rows have it: "cloth: random, k 1e8".
void suite_label( const suite_row* row, char out[SUITE_MAX_LABEL] );

/// Whether errors grow with a field, such as `dt`, or fall, as with `substeps`. @param along path of the field
bool suite_error_grows( const char* along );

/// Make a row that runs another scene for as long as a row of a suite with `seconds`. @param out its text is for free()
wisp_status suite_row_of( const suite_row* like, const suite_given* given, suite_row* out, wisp_error* error );

/// Read the scene of a row. @param out to be released
wisp_status suite_scene( const suite_row* row, wisp_scene* out, wisp_error* error );

// ---- the suite that `wisp accuracy` makes of a scene ----

/// What accuracy costs, by substeps and by methods that the scene can do without being another. `wisp tune` has the same reference.
typedef struct suite_of_scene_def
{
    const char* path;         ///< of the scene
    const char* file;         ///< the same as the suite is to name it
    double length;            ///< s of motion that is compared; 0: all of the scene, but at most 1 s
    const suite_given* given; ///< the scene; null: the file has it
    wisp_log_fn* log;         ///< receives the warnings of the scene; null: stderr
    void* log_user;
} suite_of_scene_def;

/// Write the suite as YAML.
/// @param out receives a text to be freed
/// @return WISP_BAD_INPUT it is no scene, or nothing in it moves (the message names the cause); WISP_IO_ERROR
wisp_status suite_of_scene( const suite_of_scene_def* def, char** out, wisp_error* error );
