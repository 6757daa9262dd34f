// What motion costs: the same cloth folds over a ball that rests, and over one that swings slowly or fast. Pairs are
// found by how near they are and how fast they come nearer, so what moves against itself costs more.
#include "contact_fold.h"

#include <math.h>

static const contact_way ways[] = {
    { .name = "no contact", .is_off = true, .margin = 1.0f },
    { .name = "ball at rest", .margin = 1.0f, .ball_held = 1.0f },
    { .name = "a quarter of its pace", .margin = 1.0f, .ball_held = 0.75f },
    { .name = "half of its pace", .margin = 1.0f, .ball_held = 0.5f },
    { .name = "its pace", .margin = 1.0f },
    { .name = "twice its pace", .margin = 1.0f, .ball_held = -1.0f },
};

// m/s, of the ball where it is fastest.
static double speed_of( const contact_way* way )
{
    return (double)( FOLD_SWING * hypotf( FOLD_SWING_X, FOLD_SWING_Z ) * ( 1.0f - way->ball_held ) );
}

static void add_line( const contact_comparison* comparison, const contact_run* run, int table, results* out )
{
    const contact_tally* t = &run->tally;
    const double speed = speed_of( &run->way );
    cells row = { .count = 0 };
    cells_put( &row, "%s", run->way.name );
    cells_put_number( &row, speed, 2 );
    cells_put_number( &row, speed * (double)( CONTACT_STEP / CONTACT_SUBSTEPS / comparison->scene->thickness ), 2 );
    contact_comparison_put_times( comparison, run, &row );
    cells_put( &row, "%d", run->steps );
    cells_put_number( &row, t->contacts, 0 );
    cells_put_number( &row, t->searches, 2 );
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
    snprintf( title, sizeof( title ),
              "Contact, cost of motion: cloth of %d vertices folding over a ball, %d steps of %d substeps",
              comparison->scene->mesh.vertex_count, comparison->steps, CONTACT_SUBSTEPS );
    cells header = { .count = 0 };
    cells_put( &header, "ball" );
    cells_put( &header, "max speed, m/s" );
    cells_put( &header, "displacement / thickness" );
    static const char* const names[] = { "steps",
                                         "contacts",
                                         "searches",
                                         "max intersections",
                                         "steps with intersections",
                                         "min gap / thickness",
                                         "limited displacements",
                                         "hash",
                                         "same" };
    return contact_comparison_begin_table( comparison, &header, names, WISP_COUNT( names ), title, out );
}

static void write_table( const contact_comparison* comparison, const contact_run* runs, results* out )
{
    const int table = begin_table( comparison, out );
    for ( int i = 0; i < comparison->way_count; ++i )
    {
        add_line( comparison, runs + i, table, out );
        contact_comparison_add_rows( comparison, runs + i, out );
        contact_comparison_check( comparison, runs + i, out );
        if ( runs[i].way.is_off == false && runs[i].tally.max_intersections > 0 )
        {
            results_add_failure( out, "Contact of cloth, %s: %d edges pass through triangles, expected 0.",
                                 runs[i].way.name, runs[i].tally.max_intersections );
        }
    }
    results_add_note( out, "Contact, motion: in the first second the cloth falls whatever the ball does; the mean "
                           "includes this, the median does not. displacement: largest of the ball in a substep." );
}

wisp_status contact_motion( const contact_plan* plan, results* out, wisp_error* error )
{
    const contact_comparison comparison = {
        .ways = ways,
        .way_count = WISP_COUNT( ways ),
        .seconds = plan->motion_seconds,
        .name = "contact.motion",
        .begin = 0.55,
        .span = 0.15,
    };
    return contact_comparison_fold( plan, comparison, write_table, out, error );
}
