// Statistics. In: the rows of a substep, positions at the end of a step. Out: wisp_contact_figures. They are
// requested rarely, so these are scalar loops in double precision, in the order of the rows.
#include "contact_stats.h"

#include "boundary_samples.h"
#include "closest_points.h"
#include "constraints.h"
#include "intersections.h"

#include <string.h>

// Add the impulse of a row: its accumulated corrections, divided by the sum of weighted inverse masses and by the
// time.
static void add_row( const contact_work* work, const contact_row* row, double* sum )
{
    const contact_soup* s = work->soup;
    double weights = 0.0, impulse[3], squared = 0.0;
    for ( int i = 0; i < row->count; ++i )
    {
        weights += (double)s->now[(size_t)row->point[i] * 4 + 3] * (double)row->weight[i] * (double)row->weight[i];
    }
    contact_guest *a = contact_guest_of( work, row->point[0] ),
                  *b = contact_guest_of( work, row->point[row->count - 1] );
    for ( int k = 0; k < 3 && weights > 0.0; ++k )
    {
        impulse[k] =
            ( (double)row->normal_correction * (double)row->normal[k] + (double)row->tangential_correction[k] ) /
            ( weights * (double)work->seconds );
        squared += impulse[k] * impulse[k];
        a->impulse[k] += impulse[k];
        b->impulse[k] -= impulse[k];
    }
    *sum += sqrt( squared );
}

void contact_sum_impulses( const contact_work* work )
{
    const contact_soup* s = work->soup;
    wisp_contact_figures* f = &work->memory->figures;
    f->contacts = 0;
    for ( int r = 0; r < s->constraints->row_count; ++r )
    {
        if ( s->constraints->rows[r].normal_correction > 0.0f )
        {
            add_row( work, s->constraints->rows + r, &f->impulse );
            f->contacts += 1;
        }
    }
}

static float distance_now( const contact_work* work, const contact_row* row )
{
    const contact_soup* s = work->soup;
    if ( contact_has_samples( work ) == false )
    {
        contact_pieces pieces;
        pieces.are_edges = row->split == 2;
        contact_put_pieces( &pieces, 0, row->point );
        return contact_measure_pieces( work, s->now, &pieces, 1, NULL, NULL )[0];
    }
    float d[3] = { 0.0f, 0.0f, 0.0f };
    for ( int i = 0; i < row->count; ++i )
    {
        for ( size_t k = 0; k < 3; ++k )
        {
            d[k] += row->weight[i] * s->now[(size_t)row->point[i] * 4 + k];
        }
    }
    return sqrtf( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] );
}

// Return the smallest distance at the end, in gaps, over the rows of the last substep: all other pairs are farther
// than their gap.
static float least_gap( const contact_work* work )
{
    const contact_soup* s = work->soup;
    float least = INFINITY;
    for ( int r = 0; r < s->constraints->row_count; ++r )
    {
        least =
            contact_smaller( least, distance_now( work, s->constraints->rows + r ) / s->constraints->rows[r].wanted );
    }
    return least;
}

static void count_crossings( const contact_work* work )
{
    wisp_error error = { 0 };
    const wisp_status status = contact_find_crossings( work, work->soup->now, &error );
    if ( status != WISP_OK )
    {
        wisp_frame_fail( work->frame, status, "%s", error.sentence );
    }
    work->memory->figures.crossings = work->soup->intersections->crossings.count;
}

void contact_fill_figures( const contact_work* work, bool counts_crossings )
{
    const contact_soup* s = work->soup;
    wisp_contact_figures* f = &work->memory->figures;
    if ( counts_crossings )
    {
        count_crossings( work );
    }
    f->guests = work->guest_count;
    f->points = contact_has_samples( work ) ? s->samples->count : s->point_count;
    f->edges = s->edge_count;
    f->triangles = s->triangle_count;
    f->least_gap = least_gap( work );
    memset( f->pushed, 0, sizeof( f->pushed ) );
    for ( int g = 0; g < work->guest_count; ++g )
    {
        for ( int k = 0; k < 3; ++k )
        {
            f->pushed[k] += work->guests[g].impulse[k];
        }
    }
}
