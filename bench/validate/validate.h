/// `wisp validate`: scenes with an answer from outside, in theory or in measurements that others published, by every solver that can do them.
#pragma once

#include "accuracy/accuracy.h"
#include "results.h"
#include "text_tree.h"

#define VALIDATE_PI 3.14159265358979323846

enum
{
    VALIDATE_MAX_SETTINGS = 64,
    VALIDATE_MAX_SERIES = 7, // settings of a series of a grid
};

/// Series in cells and in substeps for each of several solvers.
typedef struct validate_grid
{
    const char* const* names;           ///< of solvers, by their numbers
    unsigned solvers;                   ///< a bit for each; 0: no settings
    int cells[VALIDATE_MAX_SERIES + 1]; ///< of the series in cells, up to a 0
    const char* cell;                   ///< what 1 / cells is; null: "cell / L"
    int substeps;                       ///< of the series in cells
    int fewer[VALIDATE_MAX_SERIES + 1]; ///< substeps of the series in substeps, up to a 0
    int middle;                         ///< its cells
    bool starts_with_substeps;
} validate_grid;

struct validate_bodies;

/// A case: its scene, and how its settings are made and run.
typedef struct validate_case
{
    const char *name, *title;
    accuracy_scene scene; ///< without settings
    int rungs;            ///< of its ladder of loads, which has the uncertainty; 0: none
    validate_grid grid;   ///< the first settings
    size_t own_size;      ///< bytes behind the validate_settings of the context
    wisp_status ( *prepare )( accuracy_scene* out, wisp_error* error ); ///< fill them; null: nothing to do
    void ( *put )( accuracy_scene* out );                               ///< add more settings; null: there are none
    /// Run a setting in bodies that have its cells, substeps and workers, and are empty. Null: the scene has run()
    wisp_status ( *play )( struct validate_bodies* bodies, wisp_error* error );
} validate_case;

// All cases in their order.
#define VALIDATE_CASES( X )                                                                                          \
    X( cantilever )                                                                                                  \
    X( tip_load )                                                                                                    \
    X( column ) X( blade ) X( lateral_buckling ) X( plate_column ) X( curl ) X( bend_twist ) X( stick_slip )         \
        X( ring ) X( twisted ) X( writhe ) X( loop ) X( chain ) X( folded_chain ) X( catenary ) X( drape )           \
            X( incline ) X( capstan ) X( terminal ) X( inflate ) X( rubber ) X( mylar ) X( jet ) X( lift_off )       \
                X( rising_balloon )

#define X( name ) extern const validate_case validate_##name;
VALIDATE_CASES( X )
#undef X

/// The list of them.
const validate_case* const* validate_cases( int* count );

/// Make the scene of a case. @param subject the case
accuracy_scene_fn validate_make;

/// Read data/suites/validate/cases.yaml: a map of cases by their names, what is said of them and the largest allowed errors of settings.
/// @param out to be released; null on failure
wisp_status validate_read( text_node** out, wisp_error* error );

/// Run cases, and add their tables, charts and descriptions. A setting beyond its limit fails.
/// @param chosen a bit for each of validate_cases(); 0: all
/// @param summary [size] receives a sentence: which solvers come near theory
wisp_status validate_run( uint64_t chosen, const bench_options* options, results* out, char* summary, size_t size,
                          wisp_error* error );

// ---- the overview ----

/// Add the first table of a validation, empty: for each case and solver, how near it comes to the answer, and with what. @return its number
int validate_begin_overview( results* out );
/// Add the lines of a case.
/// @param first_row of the case in the results; all later ones are of it
void validate_add_to_overview( int table, const char* name, int first_row, results* out );
/// Say in a sentence how many of its lines come near theory, and which do not. Also a headline.
void validate_end_overview( int table, results* out, char* summary, size_t size );
