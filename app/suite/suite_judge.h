/// Run a row of a suite and check that it stays stable.
#pragma once

#include "stability_judges.h"
#include "suite.h"

/// What rows are compared with: strains of scenes that start at rest, hashes. Zero-initialised is empty.
typedef struct suite_twins
{
    struct suite_twin
    {
        uint64_t key; ///< of the scene without its starts
        double* strains;
        int count;
    } * list;
    int count, capacity;
    struct suite_hash
    {
        const suite_row* row;
        uint64_t hash;
    } * hashes; ///< of rows that ran, for `same`
    int hash_count, hash_capacity;
} suite_twins;

void suite_twins_release( suite_twins* twins );

typedef struct suite_outcome
{
    stability_verdict
        verdict; ///< its check is STABILITY_REFUSED for what is refused and should not be, or the other way
    stability_figures figures;
    unsigned without_limit; ///< checks of the row that only limits for any run were found for
    bool is_refused;        ///< by the reader or the engine, which is what the row expects
    int steps;
    double depth;  ///< of the lowest vertex at the end below the highest at the start, in sizes of its body
    uint64_t hash; ///< of all points after the last step
    uint64_t resets, not_converged, degenerate; ///< counters
} suite_outcome;

/// @return WISP_NO_MEMORY; WISP_IO_ERROR. All else is a verdict
wisp_status suite_judge_row( const suite_row* row, suite_twins* twins, suite_outcome* out, wisp_error* error );

/// @return whether the row breaks what it is known to break, and nothing if nothing is known
bool suite_is_as_known( const suite_row* row, const suite_outcome* outcome );
