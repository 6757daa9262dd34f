// The case `balloon`: the suites in data/suites/balloon, and what their rows must keep.
#include "balloon_bench.h"

#include "balloon_scene.h"
#include "rows_chart.h"
#include "suite/suite_folder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CLAIM_FLAT 1.4
#define CLAIM_VOLUME_NS 2.0
#define CLAIM_VOLUME_TRIANGLES 5000
// Time goes with vertices to this power, at least and at most. A fitted line of time would tell nothing: its coefficient of
// determination is that of the largest mesh alone.
#define LEAST_POWER 0.85
#define MOST_POWER 1.15

// The skin compresses the gas, at fill 1.2 by 2.5 % of its volume; the volume itself must be within 1 %.
#define TOLERATED_VOLUME 3.5 // %

enum
{
    SIZES_MAX = 8,
};

static const char sizes[] = "suite.sizes", sphere[] = "sphere, vertices=";

// @return 0: a row of another suite
static double vertices_of( const results_row* row )
{
    const size_t length = strlen( sphere );
    return strcmp( row->name, sizes ) == 0 && strncmp( row->variant, sphere, length ) == 0
               ? strtod( row->variant + length, NULL )
               : 0.0;
}

static double ns_a_vertex( const results_row* row )
{
    return 1e6 * row->ms_median / ( vertices_of( row ) * BALLOON_SUBSTEPS );
}

static double triangles_of( const results_row* row )
{
    return 2.0 * vertices_of( row ) - 4.0; // closed, without holes
}

static double ns_a_triangle( const results_row* row )
{
    double ms = NAN;
    for ( int i = 0; i < row->stages.count; ++i )
    {
        ms = strcmp( row->stages.items[i].name, "balloon.volume" ) == 0 ? row->stages.items[i].value : ms;
    }
    return 1e6 * ms / ( triangles_of( row ) * BALLOON_SUBSTEPS * BALLOON_ITERATIONS );
}

// ---- claims and checks ----

static void claim_flatness( int first_row, int workers, results* out )
{
    double least = INFINITY, most = 0.0, vertices[SIZES_MAX], ms[SIZES_MAX]; // logarithms
    int count = 0;
    for ( int i = first_row; i < out->row_count && count < SIZES_MAX; ++i )
    {
        const results_row* row = &out->rows[i];
        if ( vertices_of( row ) > 0.0 && row->workers == workers )
        {
            least = fmin( least, ns_a_vertex( row ) );
            most = fmax( most, ns_a_vertex( row ) );
            vertices[count] = log( vertices_of( row ) );
            ms[count++] = log( row->ms_p10 ); // of the steps that others on the machine disturbed least
        }
    }
    char claim[160];
    snprintf( claim, sizeof claim, "balloon, ns per vertex and substep with %d %s are flat within %.0f %%", workers,
              bench_workers_word( workers ), 100.0 * ( CLAIM_FLAT - 1.0 ) );
    results_add_claim( out, most <= CLAIM_FLAT * least, claim, 100.0 * ( most / least - 1.0 ), " % apart" );
    if ( count > 2 )
    {
        const double power = stats_fit_line( vertices, ms, count ).slope;
        const bool is_linear = power > LEAST_POWER && power < MOST_POWER;
        snprintf( claim, sizeof claim, "balloon, time with %d %s goes with vertices to the power %.2f to %.2f",
                  workers, bench_workers_word( workers ), LEAST_POWER, MOST_POWER );
        results_add_claim( out, is_linear, claim, power, "" );
        if ( workers == 1 && is_linear == false )
        {
            results_add_failure( out, "Balloon: the time of a step is not near linear in the vertices: power %.3f.",
                                 power );
        }
    }
}

static void claim_volume( int first_row, results* out )
{
    double most = 0.0;
    for ( int i = first_row; i < out->row_count; ++i )
    {
        const results_row* row = &out->rows[i];
        const bool counts = row->workers == 1 && triangles_of( row ) > CLAIM_VOLUME_TRIANGLES;
        most = counts ? fmax( most, ns_a_triangle( row ) ) : most;
    }
    if ( most > 0.0 )
    {
        char claim[160];
        snprintf( claim, sizeof claim, "volume, gradient and push, with 1 worker above %d triangles is under %.0f ns",
                  CLAIM_VOLUME_TRIANGLES, CLAIM_VOLUME_NS );
        results_add_claim( out, most < CLAIM_VOLUME_NS, claim, most, " ns a triangle" );
    }
}

static void check( const results_row* row, results* out )
{
    const double volume = rows_error( row, "volume_error_percent" ), halted = rows_error( row, "halted_at_step" );
    if ( strcmp( row->name, sizes ) == 0 && ( !( fabs( volume ) <= TOLERATED_VOLUME ) || halted > 0.0 ) )
    {
        results_add_failure( out,
                             "Balloon, %s: the volume differs from that of the gas by %.2f %%, or it was halted.",
                             row->variant, volume );
    }
}

void balloon_conclude( int first_row, int workers, results* out )
{
    claim_volume( first_row, out );
    claim_flatness( first_row, 1, out );
    if ( workers > 1 )
    {
        claim_flatness( first_row, workers, out );
    }
    for ( int i = first_row; i < out->row_count; ++i )
    {
        check( &out->rows[i], out );
    }
}

bench_case_fn balloon_bench;

wisp_status balloon_bench( const bench_options* options, results* out, wisp_error* error )
{
    const int first_row = out->row_count;
    const wisp_status status = suite_bench_folder( "balloon", 0.8 * bench_seconds( options ), options, out, error );
    if ( status == WISP_OK )
    {
        balloon_conclude( first_row, options->workers, out );
    }
    return status;
}
