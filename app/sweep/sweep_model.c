// A model of cost: t = a + b S + c V S, with S substeps and V vertices. a is what a step costs once, b what a substep costs whatever it moves
// (passes, barriers), c is the work. Least squares of relative errors; every second item by size takes part in the fit, and the others
// check it.
#include "sweep_merge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    TERMS = 3,
    LEAST_ITEMS = 8,
};

typedef struct sample
{
    double vertices, substeps, ms;
} sample;

static int by_work( const void* a, const void* b )
{
    const sample *p = a, *q = b;
    const double d = p->vertices * p->substeps - q->vertices * q->substeps;
    return d != 0.0 ? ( d > 0.0 ) - ( d < 0.0 ) : ( p->substeps > q->substeps ) - ( p->substeps < q->substeps );
}

static void terms_of( const sample* s, double out[TERMS] )
{
    out[0] = 1.0;
    out[1] = s->substeps;
    out[2] = s->vertices * s->substeps;
}

// Gaussian elimination with pivots. @param a [TERMS] rows, the right side last @return false: the sizes do not tell the terms apart
static bool solve( double a[TERMS][TERMS + 1], double out[TERMS] )
{
    for ( int k = 0; k < TERMS; ++k )
    {
        int pivot = k;
        for ( int i = k + 1; i < TERMS; ++i )
        {
            pivot = fabs( a[i][k] ) > fabs( a[pivot][k] ) ? i : pivot;
        }
        for ( int j = 0; j <= TERMS; ++j )
        {
            const double kept = a[k][j];
            a[k][j] = a[pivot][j];
            a[pivot][j] = kept;
        }
        if ( !( fabs( a[k][k] ) >= 1e-9 ) )
        {
            return false;
        }
        for ( int i = 0; i < TERMS; ++i )
        {
            const double factor = i == k ? 0.0 : a[i][k] / a[k][k];
            for ( int j = k; j <= TERMS; ++j )
            {
                a[i][j] -= factor * a[k][j];
            }
        }
    }
    for ( int k = 0; k < TERMS; ++k )
    {
        out[k] = a[k][TERMS] / a[k][k];
    }
    return true;
}

// Columns are scaled to one size, so that the pivots tell whether they differ.
static bool fit( const sample* samples, int count, double out[TERMS] )
{
    double a[TERMS][TERMS + 1] = { { 0.0 } }, scale[TERMS] = { 0.0 }, x[TERMS];
    for ( int i = 0; i < count; i += 2 )
    {
        terms_of( samples + i, x );
        for ( int k = 0; k < TERMS; ++k )
        {
            scale[k] = fmax( scale[k], x[k] / samples[i].ms );
        }
    }
    for ( int i = 0; i < count; i += 2 )
    {
        terms_of( samples + i, x );
        for ( int k = 0; k < TERMS; ++k )
        {
            for ( int j = 0; j < TERMS; ++j )
            {
                a[k][j] += x[k] * x[j] / ( scale[k] * scale[j] * samples[i].ms * samples[i].ms );
            }
            a[k][TERMS] += x[k] / ( scale[k] * samples[i].ms );
        }
    }
    const bool good = solve( a, out );
    for ( int k = 0; k < TERMS && good; ++k )
    {
        out[k] /= scale[k];
    }
    return good;
}

static int by_size( const void* a, const void* b )
{
    const double p = *(const double*)a, q = *(const double*)b;
    return ( p > q ) - ( p < q );
}

typedef struct model
{
    double terms[TERMS]; // ms
    int fitted, checked;
    double median, largest; // relative errors of those that are checked
} model;

static bool make_model( sample* samples, int count, model* out )
{
    *out = ( model ){ .fitted = ( count + 1 ) / 2, .checked = count / 2 };
    qsort( samples, (size_t)count, sizeof *samples, by_work );
    double* errors = calloc( (size_t)count + 1, sizeof *errors );
    const bool good = count >= LEAST_ITEMS && errors != NULL && fit( samples, count, out->terms );
    for ( int i = 1; i < count && good; i += 2 )
    {
        double x[TERMS], sum = 0.0;
        terms_of( samples + i, x );
        for ( int k = 0; k < TERMS; ++k )
        {
            sum += out->terms[k] * x[k];
        }
        errors[i / 2] = fabs( sum / samples[i].ms - 1.0 );
    }
    if ( good )
    {
        qsort( errors, (size_t)out->checked, sizeof *errors, by_size );
        out->median = errors[out->checked / 2];
        out->largest = errors[out->checked - 1];
    }
    free( errors );
    return good;
}

// Items of a scene on a processor with a number of workers. @param samples [items] buffer
static int gather( const sweep_merge* merge, const sweep_merged* like, int time, sample* samples )
{
    char wanted[160], processor[160];
    sweep_processor( &merge->parts[like->timed_part].header, wanted );
    int count = 0;
    for ( int i = 0; i < merge->parts[0].header.items; ++i )
    {
        const sweep_merged* item = merge->items + i;
        const sweep_record* r = item->timed;
        if ( r == NULL || strcmp( r->name, like->timed->name ) != 0 || r->time_count <= time ||
             r->times[time].workers != like->timed->times[time].workers || !( r->times[time].median > 0.0 ) )
        {
            continue;
        }
        sweep_processor( &merge->parts[item->timed_part].header, processor );
        samples[count] = ( sample ){ r->vertices, r->substeps, r->times[time].median };
        count += strcmp( processor, wanted ) == 0 ? 1 : 0;
    }
    return count;
}

static void add_model( const sweep_merged* like, int time, const model* m, int* table, results* out )
{
    static const char* const header[] = {
        "scene",  "workers",         "a step, us",      "a substep, us",   "a vertex and substep, ns",
        "fitted", "others, checked", "median error, %", "largest error, %"
    };
    char cells[WISP_COUNT( header )][SUITE_MAX_NAME];
    const char* pointers[WISP_COUNT( header )];
    *table = *table < 0 ? results_add_table( out, "Model of cost", WISP_COUNT( header ), header ) : *table;
    snprintf( cells[0], sizeof cells[0], "%s", like->timed->name );
    snprintf( cells[1], sizeof cells[1], "%d", like->timed->times[time].workers );
    snprintf( cells[2], sizeof cells[2], "%.3g", 1e3 * m->terms[0] );
    snprintf( cells[3], sizeof cells[3], "%.3g", 1e3 * m->terms[1] );
    snprintf( cells[4], sizeof cells[4], "%.3g", 1e6 * m->terms[2] );
    snprintf( cells[5], sizeof cells[5], "%d", m->fitted );
    snprintf( cells[6], sizeof cells[6], "%d", m->checked );
    snprintf( cells[7], sizeof cells[7], "%.1f", 100.0 * m->median );
    snprintf( cells[8], sizeof cells[8], "%.1f", 100.0 * m->largest );
    for ( int i = 0; i < WISP_COUNT( header ); ++i )
    {
        pointers[i] = cells[i];
    }
    results_add_cells( out, *table, pointers );
}

// Whether an item is the first one of its scene that has times on its processor.
static bool is_first( const sweep_merge* merge, int item )
{
    char mine[160], other[160];
    const sweep_merged* of = merge->items + item;
    if ( of->timed == NULL )
    {
        return false;
    }
    sweep_processor( &merge->parts[of->timed_part].header, mine );
    for ( int i = 0; i < item; ++i )
    {
        const sweep_merged* before = merge->items + i;
        if ( before->timed != NULL && strcmp( before->timed->name, of->timed->name ) == 0 )
        {
            sweep_processor( &merge->parts[before->timed_part].header, other );
            if ( strcmp( mine, other ) == 0 )
            {
                return false;
            }
        }
    }
    return true;
}

void sweep_add_models( const sweep_merge* merge, results* out )
{
    const int items = merge->parts[0].header.items;
    sample* samples = calloc( (size_t)items + 1, sizeof *samples );
    int table = -1;
    for ( int i = 0; i < items && samples != NULL; ++i )
    {
        for ( int t = 0; is_first( merge, i ) && t < merge->items[i].timed->time_count; ++t )
        {
            model m;
            const int count = gather( merge, merge->items + i, t, samples );
            if ( make_model( samples, count, &m ) )
            {
                add_model( merge->items + i, t, &m, &table, out );
            }
        }
    }
    free( samples );
    if ( table >= 0 )
    {
        results_add_note( out, "model of cost: the time of a step by its vertices V and substeps S is a + b S + c V "
                               "S; every second item by size "
                               "made it, and the others check it" );
    }
}
