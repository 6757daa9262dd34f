/// Runs of a scene with fewer and more substeps, and their limit. A method of first order in the substep moves half
/// as far with every doubling, so twice the finest run minus the previous one is the limit of infinitely many
/// substeps. Where three runs show that order, that limit is the reference, and its uncertainty is the difference of
/// two such extrapolations. Otherwise the finest run is the reference. Its uncertainty is its change by the last
/// doubling, which exceeds the remaining error as long as changes halve. Where they do not, because only long
/// substeps damp some motion, it is the larger of both changes.
/// not, what only long substeps damp goes on for ever, and the uncertainty is the larger of both moves.
#pragma once

#include "accuracy/accuracy_reference.h"

/// One run. @param numbers [reference->number_count]
typedef wisp_status converge_fn( void* context, int substeps, double* numbers, wisp_error* error );

typedef struct converge_plan
{
    converge_fn* run;
    void* context;
    const char* unit; ///< "substeps", as in the tables
    int substeps;     ///< of the finest run, a multiple of 4; the others have half and a quarter of them
    int compared;     ///< leading numbers that are coordinates of compared points
    int dimension;    ///< of a point: 2 or 3
    int converging;   ///< leading numbers from the finest runs; the following ones are from the coarsest
    double tolerance; ///< m, root mean square, limit of the uncertainty
} converge_plan;

/// Fill in numbers, substeps, uncertainty and the criterion of convergence.
/// @param reference with scene, facts, number_count and texts
/// @return WISP_CONFLICT it did not converge: the message states the distance
wisp_status converge( const converge_plan* plan, accuracy_reference* reference, wisp_error* error );
