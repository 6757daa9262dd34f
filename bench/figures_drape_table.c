#include "figures_drape.h"

#include "cells.h"

static int begin_table( figures_case* page, const char* title, const char* const* names, int count )
{
    cells header = { .count = 0 };
    for ( int i = 0; i < count; ++i )
    {
        cells_put( &header, "%s", names[i] );
    }
    return cells_begin_table( &header, title, page->out );
}

static void put_shape( cells* row, const drape_observation* observation )
{
    cells_put_number( row, 1e3 * observation->gap, 3 );
    cells_put_number( row, 1e3 * observation->gap_between, 3 );
    cells_put_number( row, 100.0 * observation->strain, 2 );
    cells_put_number( row, observation->hem_mean, 4 );
    cells_put_number( row, observation->min_hem, 4 );
    cells_put( row, "%d", observation->folds );
}

void drape_add_terms( figures_case* page )
{
    results_add_note( page->out,
                      "Cloth on a ball: 1 m x 1 m, 0.2 kg/m2, falls 0.15 m onto a ball of 0.25 m at height 0.6 m." );
    results_add_note(
        page->out,
        "Cloth on a ball: k_b 1e-6 N m2, k_d 0.02 N s/m, margin 5 mm, friction 0.3 and 0.2, no self-collision.%s",
        page->quick ? " A quick run ends after frame 480, long steps after 6 s, and has fewer stiffnesses and steps."
                    : "" );
    results_add_note(
        page->out,
        "phi: least distance of a vertex from the ball's surface, negative inside; between: of edge midpoints. edge: "
        "the longest, against its rest length. hem: mean and least height of the border." );
    results_add_note( page->out,
                      "folds: maxima of the border's distance from the ball's axis, 1 cm above their surroundings, "
                      "after a mean over 18 cm. ms per step: the mean of one run alone, not timed in turns." );
}

void drape_add_sequence( figures_case* page, const char* title, int shot_count, const drape_result* run )
{
    static const char* const names[] = { "frame",      "kinetic J", "of the largest", "held",     "phi mm",
                                         "between mm", "edge %",    "hem m",          "lowest m", "folds" };
    int table = begin_table( page, title, names, WISP_COUNT( names ) );
    for ( int i = 0; i < shot_count; ++i )
    {
        const drape_observation* observation = &run->shots[i];
        cells row = { .count = 0 };
        cells_put( &row, "%d", run->frames[i] );
        cells_put( &row, "%.2e", observation->kinetic );
        cells_put( &row, "%.1e", observation->kinetic / run->max_kinetic );
        cells_put( &row, "%d", run->contacts[i] );
        put_shape( &row, observation );
        cells_end_row( &row, table, page->out );
    }
}

void drape_add_runs( figures_case* page, const char* title, const float* stiffnesses, int count,
                     const drape_result* runs )
{
    static const char* const names[] = { "k N/m", "energy left", "least phi mm", "phi mm",     "between mm", "edge %",
                                         "hem m", "lowest m",    "folds",        "iterations", "ms per step" };
    int table = begin_table( page, title, names, WISP_COUNT( names ) );
    for ( int i = 0; i < count; ++i )
    {
        if ( runs[i].iterations > 0.0 )
        {
            cells row = { .count = 0 };
            cells_put_number( &row, (double)stiffnesses[i], 0 );
            cells_put( &row, "%.1e", runs[i].end.kinetic / runs[i].max_kinetic );
            cells_put_number( &row, 1e3 * runs[i].min_gap, 3 );
            put_shape( &row, &runs[i].end );
            cells_put_number( &row, runs[i].iterations, 1 );
            cells_put_number( &row, runs[i].ms, 2 );
            cells_end_row( &row, table, page->out );
        }
    }
}

// ---- long steps ----

#define STEP_STIFFNESS 350.0f
#define QUICK_SECONDS 6

wisp_status figures_drape_steps( figures_case* page, wisp_error* error )
{
    static const int rates[] = { 100, 60, 30 };
    static const char* const names[] = { "step s",   "iterations", "energy left", "least phi mm",
                                         "phi mm",   "between mm", "edge %",      "hem m",
                                         "lowest m", "folds",      "ms per step" };
    const int seconds = page->quick ? QUICK_SECONDS : (int)DRAPE_REST_SECONDS;
    triangle_scene scene;
    drape_border border = { .count = 0 };
    wisp_status status = triangle_scene_make( TRIANGLE_VERTICES, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = drape_border_find( &scene.mesh, &border, error );
    int table =
        begin_table( page, "The stiffest cloth, k 350 N/m, on the ball in long steps", names, WISP_COUNT( names ) );
    for ( int i = page->quick ? WISP_COUNT( rates ) - 1 : 0; i < WISP_COUNT( rates ) && status == WISP_OK; ++i )
    {
        drape_result run;
        const drape_plan plan = {
            .scene = &scene,
            .border = &border,
            .stiffness = STEP_STIFFNESS,
            .seconds = 1.0f / (float)rates[i],
            .steps = seconds * rates[i],
        };
        status = drape_run( page, &plan, &run, error );
        if ( status != WISP_OK )
        {
            break;
        }
        const double left = run.end.kinetic / run.max_kinetic;
        cells row = { .count = 0 };
        cells_put( &row, "1/%d", rates[i] );
        cells_put_number( &row, run.iterations, 1 );
        cells_put( &row, "%.1e", left );
        cells_put_number( &row, 1e3 * run.min_gap, 3 );
        put_shape( &row, &run.end );
        cells_put_number( &row, run.ms, 2 );
        cells_end_row( &row, table, page->out );
        char experiment[80], expected[120];
        snprintf( experiment, sizeof( experiment ), "958 vertices, k 350 N/m, steps of 1/%d s", rates[i] );
        snprintf( expected, sizeof( expected ),
                  "finite; kinetic energy after %d s below 1e-4 of its largest; no vertex ever deeper than 1 mm",
                  seconds );
        figures_add( page, "Long steps", experiment, expected, drape_is_at_rest( &run ) && run.min_gap > -DRAPE_DEPTH,
                     "%.1e left, phi at least %.2f mm, %.0f iterations per step", left, 1e3 * run.min_gap,
                     run.iterations );
    }
    drape_border_free( &border );
    triangle_scene_free( &scene );
    return status;
}
