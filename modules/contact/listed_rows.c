// Pairs of triangles that are searched once per step. In: positions at its first substep, predicted for the rest of it. Out: in each
// substep the constraints of those that are near, with their closest points of then.
#include "listed_rows.h"

#include "broad_phase.h"
#include "primitive_pairs.h"
#include "constraints.h"
#include "gather_scatter.h"
#include "predicted_motion.h"

#include <string.h>

// Up to a batch of listed pairs of one kind.
typedef struct contact_listed_batch
{
    int first, count; // of the listed rows
    contact_primitives primitives;
    float reach[CONTACT_BATCH]; // m, distance below which a pair may press in a substep
    uint8_t is_near[CONTACT_BATCH];
} contact_listed_batch;

// Pairs are near within this part of their gap beyond it, and of their approach beyond that.
static const float NEAR_SPARE = 0.25f;

// Return how far the closest points of a pair move against each other in a substep, m.
static float approach_of( const contact_contact_mesh* s, const contact_row* row )
{
    float way[3] = { 0.0f, 0.0f, 0.0f };
    for ( int i = 0; i < row->count; ++i )
    {
        const size_t at = (size_t)row->point[i] * 4;
        for ( size_t k = 0; k < 3; ++k )
        {
            way[k] += row->weight[i] * ( s->now[at + k] - s->intersection_free[at + k] );
        }
    }
    return sqrtf( way[0] * way[0] + way[1] * way[1] + way[2] * way[2] );
}

static bool fill_batches( const contact_work* work )
{
    contact_listed_rows* listed = work->contact_mesh->listed;
    const size_t most = (size_t)( listed->count / CONTACT_BATCH + 2 );
    if ( contact_reserve( work, listed->buffers + 1, most * sizeof( *listed->batches ), (void**)&listed->batches ) ==
         false )
    {
        return false;
    }
    listed->batch_count = 0;
    for ( int first = 0; first < listed->count; )
    {
        contact_listed_batch* batch = listed->batches + listed->batch_count++;
        const int end = first < listed->split ? listed->split : listed->count;
        batch->first = first;
        batch->count = end - first < CONTACT_BATCH ? end - first : CONTACT_BATCH;
        batch->primitives.are_edges = first >= listed->split;
        for ( int i = 0; i < batch->count; ++i )
        {
            const contact_row* row = listed->rows + first + i;
            contact_put_primitives( &batch->primitives, i, row->point );
            batch->reach[i] = ( 1.0f + NEAR_SPARE ) * ( row->requested + approach_of( work->contact_mesh, row ) );
        }
        first += batch->count;
    }
    return true;
}

wisp_status contact_list_rows( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    contact_listed_rows* listed = s->listed;
    listed->count = 0;
    for ( size_t i = 0; i < (size_t)s->point_count * 4; ++i )
    {
        const float way = i % 4 < 3 ? s->now[i] - s->intersection_free[i] : 0.0f;
        s->now[i] += (float)( work->substeps_left - 1 ) * way;
    }
    s->is_listed = false; // bounds of the step before do not hold
    (void)contact_expect_ways( work );
    wisp_status status = contact_search( work, error );
    status = status == WISP_OK ? contact_find_rows( work, error ) : status;
    contact_gather( work, false );
    const size_t bytes = (size_t)s->constraints->row_count * sizeof( contact_row );
    if ( status == WISP_OK && contact_reserve( work, listed->buffers, bytes, (void**)&listed->rows ) )
    {
        memcpy( listed->rows, s->constraints->rows, bytes );
        listed->count = s->constraints->row_count;
        listed->split = s->constraints->split;
    }
    return status != WISP_OK || ( listed->count == s->constraints->row_count && fill_batches( work ) )
               ? status
               : wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d contact pairs", s->constraints->row_count );
}

// ---- in a substep ----

static void find_near_listed( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    for ( int b = begin; b < end; ++b )
    {
        contact_listed_batch* batch = work->contact_mesh->listed->batches + b;
        const float* distance = contact_measure_primitives( work, work->contact_mesh->intersection_free,
                                                            &batch->primitives, batch->count, NULL, NULL );
        for ( int i = 0; i < batch->count; ++i )
        {
            batch->is_near[i] = distance[i] > 0.0f && distance[i] < batch->reach[i];
        }
    }
}

static void measure_listed( const contact_work* work, contact_row* rows, int count )
{
    _Alignas( 64 ) float weight[CONTACT_BATCH / WISP_SLICE][4][WISP_SLICE];
    _Alignas( 64 ) float normal[CONTACT_BATCH / WISP_SLICE][3][WISP_SLICE];
    contact_primitives primitives;
    primitives.are_edges = rows->split == 2;
    for ( int i = 0; i < count; ++i )
    {
        contact_put_primitives( &primitives, i, rows[i].point );
    }
    const float* distance =
        contact_measure_primitives( work, work->contact_mesh->intersection_free, &primitives, count, weight, normal );
    for ( int i = 0; i < count; ++i )
    {
        contact_row* row = rows + i;
        row->distance = distance[i];
        row->gap = contact_smaller( row->requested, row->distance );
        for ( int k = 0; k < 4; ++k )
        {
            row->weight[k] = weight[i / WISP_SLICE][k][i % WISP_SLICE];
        }
        for ( int k = 0; k < 3; ++k )
        {
            row->normal[k] = normal[i / WISP_SLICE][k][i % WISP_SLICE];
        }
    }
}

static void measure_taken( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    const contact_constraints* c = work->contact_mesh->constraints;
    for ( int first = begin; first < end; )
    {
        const int kind_end = first < c->split && c->split < end ? c->split : end;
        const int count = kind_end - first < CONTACT_BATCH ? kind_end - first : CONTACT_BATCH;
        measure_listed( work, c->rows + first, count );
        first += count;
    }
}

wisp_status contact_take_listed_rows( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    const contact_listed_rows* listed = s->listed;
    contact_constraints* c = s->constraints;
    c->row_count = c->split = c->missed_row_count = 0;
    if ( contact_reserve( work, &c->row_buffer, (size_t)listed->count * sizeof( contact_row ), (void**)&c->rows ) ==
         false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d contact pairs", listed->count );
    }
    wisp_parallel_for( work->parallel, listed->batch_count, 4, find_near_listed, (void*)(uintptr_t)work );
    for ( int b = 0; b < listed->batch_count; ++b )
    {
        const contact_listed_batch* batch = listed->batches + b;
        for ( int i = 0; i < batch->count; ++i )
        {
            if ( batch->is_near[i] != 0 )
            {
                c->rows[c->row_count++] = listed->rows[batch->first + i];
                c->split += batch->primitives.are_edges ? 0 : 1;
            }
        }
    }
    wisp_parallel_for( work->parallel, c->row_count, CONTACT_BATCH, measure_taken, (void*)(uintptr_t)work );
    return WISP_OK;
}
