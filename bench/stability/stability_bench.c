// The case `stability`: every cell has a line, and fails the run if it breaks without being listed, or is listed and
// holds.
#include "cells.h"
#include "stability.h"

#include <math.h>
#include <stdlib.h>

typedef struct tally
{
    results* out;
    const bench_options* options;
    int table;
    int cells, held, recovered, halted, known, failed, not_finite;
} tally;

static int begin_table( results* out, const char* title )
{
    static const char* const names[] = { "cell",       "verdict",   "strain %",   "of at most", "frames", "energy J",
                                         "of at most", "rest mm/s", "of at most", "engine",     "hash" };
    cells header = { .count = 0 };
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        cells_put( &header, "%s", names[i] );
    }
    return cells_begin_table( &header, title, out );
}

static void put_figure( cells* row, double value )
{
    cells_put( row, isfinite( value ) ? "%.3g" : "-", value );
}

// Actions of the engine according to the counters.
static void put_engine( const stability_outcome* o, cells* row )
{
    if ( o->halted > 0 )
    {
        cells_put( row, "halted at %d", o->score.halted );
    }
    else if ( o->laid > 0 )
    {
        cells_put( row, "reset %llu", (unsigned long long)o->laid );
    }
    else if ( o->unsolved > 0 )
    {
        cells_put( row, "unsolved %llu", (unsigned long long)o->unsolved );
    }
    else if ( o->undirected > 0 )
    {
        cells_put( row, "undirected %llu", (unsigned long long)o->undirected );
    }
    else
    {
        cells_put( row, "-" );
    }
}

static void put_verdict( const stability_outcome* o, bool is_known, cells* row )
{
    const stability_verdict* v = &o->verdict;
    if ( v->broke == STABILITY_LIMIT_NONE && o->is_refused )
    {
        cells_put( row, "refused, as expected" );
    }
    else if ( v->broke != STABILITY_LIMIT_NONE )
    {
        cells_put( row, is_known ? "limit: %s" : "FAILED: %s", stability_limit_names[v->broke] );
    }
    else if ( o->score.halted > 0 )
    {
        cells_put( row, "halted, as expected" );
    }
    else if ( v->frames > 0 )
    {
        cells_put( row, "recovered in %d", v->frames );
    }
    else
    {
        cells_put( row, "pass" );
    }
}

static void add_line( tally* t, const char* name, const stability_outcome* o, bool is_known )
{
    const stability_score* s = &o->score;
    cells row = { .count = 0 };
    cells_put( &row, "%s", name );
    put_verdict( o, is_known, &row );
    put_figure( &row, 100.0 * s->last.strain );
    put_figure( &row, 100.0 * s->last.strain_limit );
    cells_put( &row, "%d", s->frames );
    put_figure( &row, s->energy_rise );
    put_figure( &row, o->limits.energy );
    put_figure( &row, 1e3 * s->jitter );
    put_figure( &row, 1e3 * o->limits.jitter );
    put_engine( o, &row );
    cells_put_hash( &row, o->hash );
    cells_end_row( &row, t->table, t->out );
}

static void add_row( tally* t, const char* name, const stability_outcome* o )
{
    results_row* row = results_add_row( t->out, "stability", name );
    if ( row == NULL )
    {
        return;
    }
    row->workers = 1;
    row->steps = o->score.frames;
    snprintf( row->error_reference, sizeof( row->error_reference ), "the limits of bench/stability" );
    results_put( &row->error, "broke", (double)o->verdict.broke );
    results_put( &row->error, "strain", o->score.last.strain );
    results_put( &row->error, "strain_limit", o->score.last.strain_limit );
    results_put( &row->error, "frames_to_recover", o->verdict.frames );
    results_put( &row->error, "energy_rise_j", o->score.energy_rise );
    results_put( &row->error, "energy_limit_j", o->limits.energy );
    results_put( &row->error, "jitter_m_s", o->score.jitter );
    results_put( &row->error, "jitter_limit_m_s", o->limits.jitter );
    results_put( &row->error, "halted_at", o->score.halted );
    row->hash = o->hash;
    row->has_hash = true;
}

static const stability_known* find_known( const char* name )
{
    int count;
    const stability_known* known = stability_known_limits( &count );
    return stability_find_known( known, count, name );
}

static void judge_against_list( tally* t, const char* name, const stability_outcome* o )
{
    const stability_known* known = find_known( name );
    const stability_verdict* v = &o->verdict;
    const bool broke = v->broke != STABILITY_LIMIT_NONE;
    const bool is_as_known = stability_is_as_known( known, v->broke );
    if ( broke && is_as_known == false )
    {
        ++t->failed;
        results_add_failure( t->out, "stability, %s: broke %s, %.4g where at most %.4g is allowed%s%s", name,
                             stability_limit_names[v->broke], v->measured, v->allowed, o->said[0] ? ": " : "",
                             o->said );
    }
    else if ( is_as_known == false )
    {
        ++t->failed;
        results_add_failure( t->out, "stability, %s: holds now; remove it from the list of known limits", name );
    }
    t->known += broke && is_as_known ? 1 : 0;
    t->held += broke == false && v->frames == 0 && o->score.halted == 0 ? 1 : 0;
    t->recovered += broke == false && v->frames > 0 ? 1 : 0;
    t->halted += o->score.halted > 0 ? 1 : 0;
    t->not_finite += o->score.not_finite > 0 ? 1 : 0;
    ++t->cells;
}

static void take( tally* t, const char* name, const stability_outcome* o )
{
    add_line( t, name, o, find_known( name ) != NULL );
    add_row( t, name, o );
    judge_against_list( t, name, o );
}

// A body with another start must reach about the state of the same cell from rest.
#define TWIN_STRAINS 2.0
#define MIN_TWIN 0.01

static wisp_status run_cells( tally* t, const stability_cell* list, int count, double fraction, wisp_error* error )
{
    double* strains = malloc( (size_t)count * sizeof( double ) );
    wisp_status status =
        strains != NULL ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for the strains of cells" );
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        const int twin = stability_twin( list, i );
        const double most = twin >= 0 ? fmax( TWIN_STRAINS * strains[twin], MIN_TWIN ) : INFINITY;
        bench_progress( t->options, fraction, list[i].name );
        stability_outcome outcome;
        status = stability_run_cell( list + i, most, &outcome, error );
        strains[i] = outcome.score.last.strain;
        if ( status == WISP_OK )
        {
            take( t, list[i].name, &outcome );
        }
    }
    free( strains );
    return status;
}

static wisp_status run_matrix( tally* t, const stability_subject* subject, double fraction, wisp_error* error )
{
    stability_cell* list;
    const int count = stability_matrix( subject, t->options->quick, &list );
    char title[120];
    snprintf( title, sizeof( title ), "Stability, %s: 5 s of each cell", subject->name );
    t->table = begin_table( t->out, title );
    wisp_status status = count < 0 ? wisp_fail( error, WISP_NO_MEMORY, "no memory for the matrix" )
                                   : run_cells( t, list, count, fraction, error );
    free( list );
    return status;
}

static wisp_status run_named( tally* t, const stability_named* named, wisp_error* error )
{
    stability_outcome outcome = { 0 };
    bench_progress( t->options, 0.9, named->name );
    const wisp_status status = named->run( named->kind, 1, &outcome, error );
    if ( status == WISP_OK )
    {
        take( t, named->name, &outcome );
        if ( outcome.said[0] != '\0' )
        {
            results_add_note( t->out, "stability, %s: %s", named->name, outcome.said );
        }
    }
    return status;
}

static wisp_status run_list( tally* t, const stability_named* list, int count, const char* title, wisp_error* error )
{
    const bench_options* options = t->options;
    wisp_status status = WISP_OK;
    t->table = begin_table( t->out, title );
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        const bool is_due = list[i].is_long ? options->longest : list[i].quick || options->quick == false;
        if ( is_due )
        {
            status = run_named( t, list + i, error );
        }
    }
    return status;
}

typedef const stability_named* list_fn( int* count );
static const struct
{
    list_fn* list;
    const char* title;
} lists[] = {
    { stability_drives, "Stability, what is pushed and pulled" },
    { stability_meshes, "Stability, meshes that are ill" },
    { stability_followers, "Stability, what follows others" },
    { stability_failures, "Stability, known failures of other engines" },
};

typedef const stability_subject* room_fn( int* count );
static room_fn* const rooms[] = { stability_cloths, stability_balloons, stability_strand_subjects };

wisp_status stability_bench( const bench_options* options, results* out, wisp_error* error )
{
    tally t = { .out = out, .options = options };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( rooms ) && status == WISP_OK; ++i )
    {
        int count;
        const stability_subject* subjects = rooms[i]( &count );
        for ( int k = 0; k < count && status == WISP_OK; ++k )
        {
            const bool is_due = options->quick == false || subjects[k].has_pairs; // the most used solvers
            const double fraction = ( i + (double)k / count ) / WISP_COUNT( rooms );
            status = is_due ? run_matrix( &t, subjects + k, fraction, error ) : WISP_OK;
        }
    }
    for ( int i = 0; i < WISP_COUNT( lists ) && status == WISP_OK; ++i )
    {
        int count;
        const stability_named* list = lists[i].list( &count );
        status = run_list( &t, list, count, lists[i].title, error );
    }
    results_add_note( out,
                      "stability: %d cells: %d hold, %d recover, %d are halted, %d break as docs/limits.md says, %d "
                      "fail, %d have NaN or infinity",
                      t.cells, t.held, t.recovered, t.halted, t.known, t.failed, t.not_finite );
    return status;
}
