#include "converge.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    COARSE,
    MIDDLE,
    FINE,
    RUNS,
};

/// Root mean square distances over the compared points, m.
typedef struct converge_moves
{
    double before, last; // displacement by the two doublings
    double differ;       // between the extrapolations from both
} converge_moves;

static converge_moves measure( const converge_plan* plan, double* const runs[RUNS] )
{
    converge_moves m = { 0.0, 0.0, 0.0 };
    for ( int i = 0; i < plan->compared; ++i )
    {
        const double before = runs[MIDDLE][i] - runs[COARSE][i], last = runs[FINE][i] - runs[MIDDLE][i];
        m.before += before * before;
        m.last += last * last;
        m.differ += ( 2.0 * last - before ) * ( 2.0 * last - before );
    }
    const double fraction = (double)plan->dimension / plan->compared;
    return ( converge_moves ){ sqrt( fraction * m.before ), sqrt( fraction * m.last ), sqrt( fraction * m.differ ) };
}

// The text in the tables ends with the resolution of the run.
static void describe( const converge_plan* plan, bool is_first_order, accuracy_reference* reference )
{
    const size_t length = strlen( reference->reference ), room = sizeof( reference->reference ) - length;
    if ( is_first_order )
    {
        snprintf( reference->reference + length, room, ", with %d and %d %s, extrapolated", plan->substeps / 2,
                  plan->substeps, plan->unit );
    }
    else
    {
        snprintf( reference->reference + length, room, ", with %d %s", plan->substeps, plan->unit );
    }
}

static void conclude( const converge_plan* plan, double* const runs[RUNS], accuracy_reference* reference )
{
    static const char* const kinds[] = {
        "the finest run, whose moves do not halve: its uncertainty is the larger one",
        "the finest run, and its uncertainty is the last move",
        "extrapolated, and its uncertainty is what the extrapolations from both differ by"
    };
    const converge_moves m = measure( plan, runs );
    const bool is_first_order = m.differ < m.last, falls = 2.0 * m.last <= m.before;
    for ( int i = 0; i < reference->number_count; ++i )
    {
        const double gain = is_first_order ? runs[FINE][i] - runs[MIDDLE][i] : 0.0;
        reference->numbers[i] = i < plan->converging ? runs[FINE][i] + gain : runs[COARSE][i];
    }
    describe( plan, is_first_order, reference );
    reference->substeps = plan->substeps;
    reference->uncertainty = is_first_order ? m.differ : falls ? m.last : fmax( m.last, m.before );
    snprintf(
        reference->converged, sizeof( reference->converged ),
        "where the uncertainty is at most %.3g mm, root mean square over all compared points; from %d to %d substeps "
        "they moved %.3g mm, to %d %.3g mm; this is %s",
        1e3 * plan->tolerance, plan->substeps / 4, plan->substeps / 2, 1e3 * m.before, plan->substeps, 1e3 * m.last,
        kinds[is_first_order ? 2 : falls] );
}

wisp_status converge( const converge_plan* plan, accuracy_reference* reference, wisp_error* error )
{
    double* runs[RUNS] = { NULL };
    wisp_status status = WISP_OK;
    WISP_ASSERT( plan->substeps % 4 == 0 );
    for ( int k = 0; k < RUNS && status == WISP_OK; ++k )
    {
        runs[k] = calloc( (size_t)reference->number_count, sizeof( double ) );
        status = runs[k] ? plan->run( plan->context, plan->substeps / ( 4 >> k ), runs[k], error )
                         : wisp_fail( error, WISP_NO_MEMORY, "no memory for %d numbers", reference->number_count );
    }
    if ( status == WISP_OK )
    {
        reference->numbers = calloc( (size_t)reference->number_count, sizeof( double ) );
        status = reference->numbers
                     ? WISP_OK
                     : wisp_fail( error, WISP_NO_MEMORY, "no memory for %d numbers", reference->number_count );
    }
    if ( status == WISP_OK )
    {
        conclude( plan, runs, reference );
        fprintf( stderr, "%s: converged %s\n", reference->scene, reference->converged );
        if ( !( reference->uncertainty <= plan->tolerance ) )
        {
            status =
                wisp_fail( error, WISP_CONFLICT, "it did not converge: its uncertainty is %.3g mm, more than %.3g",
                           1e3 * reference->uncertainty, 1e3 * plan->tolerance );
        }
    }
    for ( int k = 0; k < RUNS; ++k )
    {
        free( runs[k] );
    }
    return status;
}
