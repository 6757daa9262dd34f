// Balloons that press on each other: how deep they overlap by distances that contact has no part in, whether forces
// are equal and opposite, whether they come to rest, and what that costs.
#include "contact_bench.h"
#include "contact_overlap.h"

#include <math.h>

static const contact_way ways[] = {
    { .name = "none", .is_off = true, .margin = 2.0f },
    { .name = "samples, 2 apart", .primitives = WISP_CONTACT_PARTICLES, .spacing = 2.0f, .margin = 2.0f },
    { .name = "samples, 1 apart", .primitives = WISP_CONTACT_PARTICLES, .spacing = 1.0f, .margin = 2.0f },
    { .name = "exact, no guard", .margin = 2.0f, .no_displacement_limit = true },
    { .name = "exact, margin 2", .margin = 2.0f },
};

enum
{
    OBSERVE_EVERY = 10, // steps: an observation takes as long as some steps
};

/// What a balloon scene shows besides the tally.
typedef struct press_observation
{
    contact_overlap last;
    double most;  // m, of all observations
    double force; // N, of contact on the first balloon against x in the last step
} press_observation;

static wisp_status observe( contact_run* run, int number, void* context, wisp_error* error )
{
    press_observation* l = (press_observation*)context + number;
    wisp_status status = contact_find_overlap( &run->seen, &l->last, error );
    l->most = fmax( l->most, l->last.overlap );
    double impulse[3] = { 0.0, 0.0, 0.0 };
    if ( status == WISP_OK )
    {
        status = wisp_read_contact_impulse( run->seen.world, run->seen.surfaces[0], impulse );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( run->seen.world, status, error );
    }
    l->force = -impulse[0] / (double)CONTACT_STEP;
    return status;
}

static int begin_table( const contact_comparison* comparison, const char* what, results* out )
{
    char title[160];
    snprintf( title, sizeof( title ), "Contact, %s of %d vertices each, %d steps of %d substeps", what,
              comparison->scene->mesh.vertex_count, comparison->steps, CONTACT_SUBSTEPS );
    cells header = { .count = 0 };
    cells_put( &header, "way" );
    static const char* const names[] = { "steps",
                                         "overlap at the end, %",
                                         "max overlap, %",
                                         "intersections at the end",
                                         "max intersections",
                                         "force N",
                                         "wall %",
                                         "uneven %",
                                         "impulse N s",
                                         "unbalanced N s",
                                         "speed m/s",
                                         "pairs",
                                         "searches",
                                         "hash",
                                         "same" };
    return contact_comparison_begin_table( comparison, &header, names, WISP_COUNT( names ), title, out );
}

static void add_line( const contact_comparison* comparison, const contact_run* run, const press_observation* l,
                      bool is_pair, int table, results* out )
{
    const contact_tally* t = &run->tally;
    const double percent = 100.0 / (double)PRESS_RADIUS;
    const bool has_wall = is_pair && run->way.is_off == false;
    cells row = { .count = 0 };
    cells_put( &row, "%s", run->way.name );
    contact_comparison_put_times( comparison, run, &row );
    cells_put( &row, "%d", run->steps );
    cells_put_number( &row, percent * l->last.overlap, 3 );
    cells_put_number( &row, percent * l->most, 3 );
    cells_put( &row, "%d", t->intersections_last );
    cells_put( &row, "%d", t->max_intersections );
    cells_put_number( &row, has_wall ? l->force : NAN, 2 );
    cells_put_number( &row, has_wall ? percent * l->last.patch : NAN, 1 );
    cells_put_number( &row, has_wall ? percent * l->last.unevenness : NAN, 3 );
    cells_put_number( &row, t->impulse, 4 );
    cells_put( &row, "%.1e", t->unbalanced );
    cells_put_number( &row, t->speed, 4 );
    cells_put_number( &row, t->pairs, 0 );
    cells_put_number( &row, t->searches, 2 );
    cells_put_hash( &row, run->hash );
    cells_put( &row, "%s", run->same_hash ? "yes" : "NO" );
    cells_end_row( &row, table, out );
}

static void check( const contact_comparison* comparison, const contact_run* run, const press_observation* l,
                   results* out )
{
    static const double MAX_OVERLAP = 0.01; // of the radius
    contact_comparison_check( comparison, run, out );
    const bool is_tight = run->way.is_off == false && run->way.primitives == WISP_CONTACT_TRIANGLES;
    if ( is_tight && l->most > MAX_OVERLAP * (double)PRESS_RADIUS )
    {
        results_add_failure( out, "Contact of balloons, %s, %s: balloons overlap by %.2f %% of the radius.",
                             comparison->name, run->way.name, 100.0 * l->most / (double)PRESS_RADIUS );
    }
    // each row gives one side what it takes from the other; sums of a hundred thousand products in double remain
    if ( run->tally.unbalanced > 1e-9 * fmax( run->tally.impulse, 1.0 ) )
    {
        results_add_failure( out, "Contact of balloons, %s, %s: opposite forces differ by %.1e N s.",
                             comparison->name, run->way.name, run->tally.unbalanced );
    }
}

static wisp_status run_scene( const contact_comparison* comparison, const char* what, bool is_pair, results* out,
                              wisp_error* error )
{
    contact_run runs[WISP_COUNT( ways )] = { { .hash = 0 } };
    press_observation observations[WISP_COUNT( ways )] = { { .most = 0.0 } };
    contact_comparison mine = *comparison;
    mine.context = observations;
    const wisp_status status = contact_comparison_run( &mine, runs, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const int table = begin_table( comparison, what, out );
    for ( int i = 0; i < comparison->way_count; ++i )
    {
        add_line( comparison, runs + i, observations + i, is_pair, table, out );
        contact_comparison_add_rows( comparison, runs + i, out );
        check( comparison, runs + i, observations + i, out );
    }
    return WISP_OK;
}

wisp_status contact_balloons( const contact_plan* plan, results* out, wisp_error* error )
{
    contact_scene scene;
    wisp_status status = contact_make_balloon( plan->balloon_level, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    contact_comparison comparison = {
        .scene = &scene,
        .enter = contact_enter_pair,
        .ways = ways,
        .way_count = WISP_COUNT( ways ),
        .steps = plan->balloon_steps,
        .seconds = plan->balloon_seconds,
        .teams = &plan->teams,
        .observe = observe,
        .observe_every = OBSERVE_EVERY,
        .options = plan->options,
        .name = "contact.pair",
        .begin = 0.7,
        .span = 0.05,
    };
    status = run_scene( &comparison, "two balloons pressed together,", true, out, error );
    comparison.enter = contact_enter_stack;
    comparison.name = "contact.stack";
    comparison.begin = 0.75;
    comparison.span = 0.15;
    status = status == WISP_OK ? run_scene( &comparison, "ten balloons in a box,", false, out, error ) : status;
    contact_scene_free( &scene );
    if ( status == WISP_OK )
    {
        results_add_note(
            out,
            "Contact, balloons: overlap, in %% of the radius: how far a vertex is below the thickness or inside "
            "another balloon, in the last step and at most, by signed distances every %d steps.",
            OBSERVE_EVERY );
        results_add_note( out, "Contact, balloons: wall: distance from the axis of the vertices of the first balloon "
                               "that touch the other; uneven: root mean square of their distances from a plane." );
        results_add_note( out, "Contact, balloons: force: on the first balloon of the pair, pressed by plates; "
                               "impulse: of all pairs in the last step; unbalanced: largest sum of opposite forces; "
                               "speed: of the fastest vertex after the last step." );
    }
    return status;
}
