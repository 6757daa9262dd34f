// What accuracy costs: one folding cloth by every way to keep it from itself, and what each way misses.
#include "contact_fold.h"
#include "rows_chart.h"

#include <math.h>
#include <string.h>

static const contact_way ways[] = {
    { .name = "none", .is_off = true, .margin = 2.0f },
    { .name = "samples, 4 apart", .primitives = WISP_CONTACT_PARTICLES, .spacing = 4.0f, .margin = 2.0f },
    { .name = "samples, 2 apart", .primitives = WISP_CONTACT_PARTICLES, .spacing = 2.0f, .margin = 2.0f },
    { .name = "samples, 1 apart", .primitives = WISP_CONTACT_PARTICLES, .spacing = 1.0f, .margin = 2.0f },
    { .name = "exact, no guard", .margin = 2.0f, .no_displacement_limit = true },
    { .name = "exact, margin 1", .margin = 1.0f },
    { .name = "exact, margin 2", .margin = 2.0f },
    { .name = "exact, margin 4", .margin = 4.0f },
    { .name = "exact, margin 2, tree", .margin = 2.0f, .search = WISP_PAIR_SEARCH_TREE },
};

enum
{
    STANDARD = 6, // the default of the module
    BY_TREE = 8,
};

static void add_line( const contact_comparison* comparison, const contact_run* run, const contact_run* standard,
                      int table, results* out )
{
    const contact_tally* t = &run->tally;
    cells row = { .count = 0 };
    cells_put( &row, "%s", run->way.name );
    contact_comparison_put_times( comparison, run, &row );
    cells_put( &row, "%d", run->steps );
    cells_put_number( &row, run->steps == standard->steps ? run->mean[0] / standard->mean[0] : NAN, 2 );
    cells_put_number( &row, t->pairs, 0 );
    cells_put_number( &row, t->contacts, 0 );
    cells_put_number( &row, t->searches, 2 );
    cells_put( &row, "%d", t->intersections_last );
    cells_put( &row, "%d", t->max_intersections );
    cells_put( &row, "%d", t->crossed_steps );
    cells_put_number( &row, (double)t->min_gap, 3 );
    cells_put( &row, "%lld", (long long)t->limited );
    cells_put_hash( &row, run->hash );
    cells_put( &row, "%s", run->same_hash ? "yes" : "NO" );
    cells_end_row( &row, table, out );
}

static int begin_table( const contact_comparison* comparison, results* out )
{
    char title[160];
    snprintf(
        title, sizeof( title ),
        "Contact, the cost of accuracy: cloth of %d vertices folding over a moving ball, %d steps of %d substeps",
        comparison->scene->mesh.vertex_count, comparison->steps, CONTACT_SUBSTEPS );
    cells header = { .count = 0 };
    cells_put( &header, "way" );
    static const char* const names[] = { "steps",
                                         "time / margin 2",
                                         "pairs",
                                         "contacts",
                                         "searches",
                                         "intersections at the end",
                                         "max intersections",
                                         "steps with intersections",
                                         "min gap / thickness",
                                         "limited displacements",
                                         "hash",
                                         "same" };
    return contact_comparison_begin_table( comparison, &header, names, WISP_COUNT( names ), title, out );
}

static void check( const contact_comparison* comparison, const contact_run* run, results* out )
{
    const bool is_tight = run->way.is_off == false && run->way.no_displacement_limit == false &&
                          run->way.primitives == WISP_CONTACT_TRIANGLES;
    contact_comparison_check( comparison, run, out );
    if ( is_tight && run->tally.max_intersections > 0 )
    {
        results_add_failure( out, "Contact of cloth, %s: %d edges pass through triangles, expected 0.", run->way.name,
                             run->tally.max_intersections );
    }
}

static double mean_ms_of( const results_row* row )
{
    for ( int i = 0; i < row->stages.count; ++i )
    {
        if ( strcmp( row->stages.items[i].name, "mean" ) == 0 )
        {
            return row->stages.items[i].value;
        }
    }
    return NAN;
}

static double crossed_steps_of( const results_row* row )
{
    return 100.0 * rows_error( row, "crossed_steps" ) / row->steps;
}

static void add_chart( const contact_comparison* comparison, int first_row, results* out )
{
    rows_chart_add( &( rows_chart ){ .first_row = first_row,
                                     .name = comparison->name,
                                     .workers = comparison->teams->workers[comparison->teams->count - 1],
                                     .min_steps = comparison->steps,
                                     .title = "Contact, the cost of accuracy: a cloth that folds on itself",
                                     .x_label = "ms per step, mean",
                                     .y_label = "steps that end with intersections, %",
                                     .caption = "Ringed: no other way is both faster and more accurate. A way that "
                                                "ran out of time has no mean to compare.",
                                     .x = mean_ms_of,
                                     .y = crossed_steps_of,
                                     .y_linear = true,
                                     .is_front = true },
                    out );
}

static void write_table( const contact_comparison* comparison, const contact_run* runs, results* out )
{
    const int first_row = out->row_count;
    const int table = begin_table( comparison, out );
    for ( int i = 0; i < comparison->way_count; ++i )
    {
        add_line( comparison, runs + i, runs + STANDARD, table, out );
        contact_comparison_add_rows( comparison, runs + i, out );
        check( comparison, runs + i, out );
    }
    add_chart( comparison, first_row, out );
    if ( runs[BY_TREE].steps == runs[STANDARD].steps && runs[BY_TREE].hash != runs[STANDARD].hash )
    {
        results_add_failure( out, "The cloth folds differently when its pairs are found by the tree." );
    }
    results_add_note( out, "Contact, cost: spacing of samples is in thicknesses. time / margin 2: the mean over that "
                           "of the default with one worker, where both made all steps." );
    results_add_note( out,
                      "Contact, cost: pairs, contacts, searches: means per step. intersections: edges through "
                      "triangles, by exact tests: after the last step, at most, and steps that ended with some." );
    results_add_note( out, "Contact, cost: the gap of samples is between samples; the surface between them is not "
                           "measured. limited displacements: vertices shortened by the guard, all substeps. same: "
                           "the measured world ends like the timed ones." );
}

wisp_status contact_price( const contact_plan* plan, results* out, wisp_error* error )
{
    const contact_comparison comparison = {
        .ways = ways,
        .way_count = WISP_COUNT( ways ),
        .seconds = plan->fold_seconds,
        .name = "contact.fold",
        .begin = 0.3,
        .span = 0.25,
    };
    return contact_comparison_fold( plan, comparison, write_table, out, error );
}
