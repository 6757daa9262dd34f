// What contact did and where it ended: asked for rarely, so plain loops in double and in the order of the rows.
#include "contact_internal.h"

#include <string.h>

// The push and the rubbing of a row were lengths; divided by the sum of weights and by the time they are an impulse.
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
        impulse[k] = ( (double)row->pushed * (double)row->normal[k] + (double)row->rubbed[k] ) /
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
    for ( int r = 0; r < s->row_count; ++r )
    {
        if ( s->rows[r].pushed > 0.0f )
        {
            add_row( work, s->rows + r, &f->impulse );
            f->contacts += 1;
        }
    }
}

static float distance_now( const contact_work* work, const contact_row* row )
{
    const contact_soup* s = work->soup;
    if ( work->state->world.features == WISP_CONTACT_EXACT )
    {
        contact_pieces pieces;
        pieces.are_edges = row->split == 2;
        contact_put_pieces( &pieces, 0, row->point );
        return contact_measure_distances( work, s->now, &pieces, 1 )[0];
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

// The nearest pair at the end, over those that might have met in the last substep: no other is as near as its gap.
static float least_gap( const contact_work* work )
{
    const contact_soup* s = work->soup;
    float least = INFINITY;
    for ( int r = 0; r < s->row_count; ++r )
    {
        least = contact_smaller( least, distance_now( work, s->rows + r ) / s->rows[r].wanted );
    }
    return least;
}

static void count_crossings( const contact_work* work )
{
    contact_soup* s = work->soup;
    wisp_error error = { 0 };
    const wisp_crossing_job job = {
        .quads = s->now,
        .edges = s->edges,
        .edge_count = s->edge_count,
        .triangles = s->triangles,
        .triangle_count = s->triangle_count,
        .search = work->state->world.search,
    };
    const wisp_status status = wisp_crossings_find( &s->crossings, work->parallel, &job, &error );
    if ( status != WISP_OK )
    {
        wisp_frame_fail( work->frame, status, "%s", error.sentence );
    }
    work->memory->figures.crossings = s->crossings.count;
}

void contact_measure( wisp_frame* frame, const wisp_span* span, void* user )
{
    contact_state* state = user;
    const contact_work work = contact_begin_work( frame, span, state );
    wisp_contact_figures* out = wisp_frame_column( frame, span->entity, state->figures, 0 );
    wisp_contact_figures* f = &work.memory->figures;
    const contact_soup* s = work.soup;
    if ( s->is_listed == false )
    {
        return; // the step has failed
    }
    contact_gather( &work, false );
    if ( state->counts_crossings )
    {
        count_crossings( &work );
    }
    f->guests = state->guest_count;
    f->points = state->world.features == WISP_CONTACT_SAMPLES ? s->sample_count : s->point_count;
    f->edges = s->edge_count;
    f->triangles = s->triangle_count;
    f->least_gap = least_gap( &work );
    memset( f->pushed, 0, sizeof( f->pushed ) );
    for ( int g = 0; g < state->guest_count; ++g )
    {
        for ( int k = 0; k < 3; ++k )
        {
            f->pushed[k] += state->guests[g].impulse[k];
        }
    }
    *out = *f;
}
