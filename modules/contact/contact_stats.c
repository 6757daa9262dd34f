// Statistics. In: the rows of a substep, positions at the end of a step. Out: wisp_contact_stats. They are
// requested rarely, so these are scalar loops in double precision, in the order of the rows.
#include "contact_stats.h"

#include "closest_points.h"
#include "constraints.h"
#include "intersections.h"
#include "spheres.h"

#include <string.h>

// Add the impulse of a row: its accumulated corrections, divided by the sum of weighted inverse masses and by the
// time.
static void add_row( const contact_work* work, const contact_row* row, double* sum )
{
    const contact_contact_mesh* s = work->contact_mesh;
    double weights = 0.0, impulse[3], squared = 0.0;
    for ( int i = 0; i < row->count; ++i )
    {
        weights += (double)s->now[(size_t)row->point[i] * 4 + 3] * (double)row->weight[i] * (double)row->weight[i];
    }
    contact_participant *a = contact_participant_of( work, row->point[0] ),
                        *b = contact_participant_of( work, row->point[row->count - 1] );
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
    const contact_contact_mesh* s = work->contact_mesh;
    wisp_contact_stats* f = &work->memory->stats;
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
    const contact_contact_mesh* s = work->contact_mesh;
    contact_primitives primitives;
    primitives.are_edges = row->split == 2;
    contact_put_primitives( &primitives, 0, row->point );
    return contact_measure_primitives( work, s->now, &primitives, 1, NULL, NULL )[0];
}

// Return the smallest distance at the end, in gaps, over the rows of the last substep: all other pairs are farther
// than their gap.
static float min_gap( const contact_work* work )
{
    const contact_contact_mesh* s = work->contact_mesh;
    float least = INFINITY;
    for ( int r = 0; r < s->constraints->row_count; ++r )
    {
        least = contact_smaller( least,
                                 distance_now( work, s->constraints->rows + r ) / s->constraints->rows[r].requested );
    }
    return least;
}

static void count_intersections( const contact_work* work )
{
    wisp_error error = { 0 };
    const wisp_status status = contact_find_intersections( work, work->contact_mesh->now, &error );
    if ( status != WISP_OK )
    {
        wisp_frame_fail( work->frame, status, "%s", error.message );
    }
    const wisp_intersections* found = &work->contact_mesh->intersections->intersections;
    work->memory->stats.intersections = 0;
    for ( int i = 0; i < found->count && status == WISP_OK; ++i )
    {
        work->memory->stats.intersections += contact_is_movable( work->contact_mesh, found->list + i );
    }
}

void contact_fill_stats( const contact_work* work, bool counts_intersections )
{
    const contact_contact_mesh* s = work->contact_mesh;
    wisp_contact_stats* f = &work->memory->stats;
    if ( counts_intersections )
    {
        count_intersections( work );
    }
    f->participants = work->participant_count;
    const bool are_spheres = work->settings->level == WISP_CONTACT_SPHERES;
    f->points = are_spheres ? s->spheres->count : s->point_count;
    f->edges = s->edge_count;
    f->triangles = s->triangle_count;
    f->min_gap = are_spheres ? contact_least_sphere_gap( work ) : min_gap( work );
    memset( f->net_impulse, 0, sizeof( f->net_impulse ) );
    for ( int g = 0; g < work->participant_count; ++g )
    {
        for ( int k = 0; k < 3; ++k )
        {
            f->net_impulse[k] += work->participants[g].impulse[k];
        }
    }
}
