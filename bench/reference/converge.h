/// Runs of a scene with fewer and more substeps, and what they tend to. A method of first order in the substep moves half as far with
/// every doubling, so twice the finest run less the one before is what infinitely many substeps would give. Where three runs show
/// that order, that is the reference, and its doubt is by how much two such extrapolations differ. Where they do not, the finest run is
/// the reference. Its doubt is how far the last doubling has moved it, for what is missing is less as long as moves halve; where they do
/// not, what only long substeps damp goes on for ever, and the doubt is the larger of both moves.
#pragma once

#include "accuracy/accuracy_reference.h"

/// One run. @param numbers [reference->number_count]
typedef wisp_status converge_fn( void* context, int substeps, double* numbers, wisp_error* error );

typedef struct converge_plan
{
    converge_fn* run;
    void* context;
    const char* unit; ///< "substeps", as tables say it
    int substeps;     ///< of the finest run, a multiple of 4; the others have half and a quarter of them
    int compared;     ///< numbers, from the first, that are coordinates of compared points
    int dimension;    ///< of a point: 2 or 3
    int converging;   ///< numbers, from the first, that are of the finest runs; those behind are of the coarsest
    double tolerance; ///< m, root mean square, that the doubt may be
} converge_plan;

/// Fill in numbers, substeps, how many of them behind `truth`, doubt and what counts as converged.
/// @param reference scene, facts, number_count and texts are there already
/// @return WISP_CONFLICT it did not converge: the message says how far from it
wisp_status converge( const converge_plan* plan, accuracy_reference* reference, wisp_error* error );
