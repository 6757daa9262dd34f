// Broad phase: which clusters may come near each other before the next search. In: intersection-free positions and
// predicted motions. Out: the list of pairs with their cached bounds.
//
// The box of a cluster holds it as long as it keeps to its predicted motion within its margin, in a frame that moves
// with the mean of all points. Pairs are the overlaps of such boxes, found by grids (wisp/module/aabb_pairs.h).
// With too many overlaps the margins are halved until the list fits; displacements must then stay within them
// (displacement_limit.c). A cloth that folds is searched about twice per step; a thousand clusters cost 0.3 ms.
#include "broad_phase.h"

#include "cached_bounds.h"
#include "clusters.h"
#include "predicted_motion.h"

enum
{
    BOX_GRAIN = 256,
    MAX_PER_CLUSTER = 512, // pairs per cluster before margins are halved
    MAX_HALVINGS = 40,
};

// ---- boxes ----

static wisp_aabb box_of_motion( const contact_work* work, int p )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const contact_predicted_motion* predicted = s->motion->predicted + p;
    const float wide =
        0.5f * work->participants[s->clusters->items[p].participant].settings.thickness + predicted->margin;
    // with a search per step, ways are those of the step
    const int substeps = work->settings->level == WISP_CONTACT_EXACT ? CONTACT_SUBSTEPS_AHEAD : 1;
    wisp_aabb box = contact_box_around( work, s->clusters->items + p );
    for ( int k = 0; k < 3; ++k )
    {
        const float way = (float)substeps * predicted->displacement[k];
        box.lower[k] += contact_smaller( way, 0.0f ) - wide;
        box.upper[k] += contact_larger( way, 0.0f ) + wide;
    }
    return box;
}

static void box_clusters( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    for ( int p = begin; p < end; ++p )
    {
        work->contact_mesh->broad_phase->boxes[p] = box_of_motion( work, p );
    }
}

static int keep_allowed( const void* context, int query, int32_t* items, int count )
{
    int kept = 0;
    for ( int i = 0; i < count; ++i )
    {
        const int32_t item = items[i];
        items[kept] = item;
        kept += contact_clusters_may_meet( context, query, item ) ? 1 : 0;
    }
    return kept;
}

// ---- searching ----

static wisp_status find_cluster_pairs( const contact_work* work, wisp_error* error )
{
    contact_broad_phase* b = work->contact_mesh->broad_phase;
    const int count = work->contact_mesh->clusters->count;
    if ( contact_reserve( work, &b->box_buffer, (size_t)count * sizeof( *b->boxes ), (void**)&b->boxes ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for the boxes of %d clusters", count );
    }
    wisp_parallel_for( work->parallel, count, BOX_GRAIN, box_clusters, (void*)(uintptr_t)work );
    const wisp_aabb_args args = {
        .boxes = b->boxes,
        .box_count = count,
        .kernels = wisp_frame_kernels( work->frame ),
        .limit = (size_t)count * MAX_PER_CLUSTER,
        .filter = keep_allowed,
        .filter_context = work,
    };
    return wisp_aabb_pairs_find( &b->overlaps, work->parallel, &args, error );
}

static void halve_margins( const contact_contact_mesh* s )
{
    for ( int p = 0; p < s->clusters->count; ++p )
    {
        contact_predicted_motion* predicted = s->motion->predicted + p;
        predicted->margin *= 0.5f;
        for ( int k = 0; k < 3; ++k )
        {
            predicted->displacement[k] *= 0.5f;
        }
    }
}

wisp_status contact_search( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    contact_broad_phase* b = s->broad_phase;
    wisp_status status = WISP_BAD_INPUT;
    b->searches += 1;
    b->is_short = false;
    contact_predict_motion( work );
    for ( int halvings = 0; status == WISP_BAD_INPUT && halvings < MAX_HALVINGS; ++halvings )
    {
        status = find_cluster_pairs( work, error );
        if ( status == WISP_BAD_INPUT ) // more pairs than the limit
        {
            halve_margins( s );
            b->is_short = true;
        }
    }
    if ( status == WISP_OK && contact_list_cluster_pairs( work, &b->overlaps, s->is_listed ) == false )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "out of memory for %zu pairs", b->overlaps.pair_count );
    }
    s->is_listed = status == WISP_OK;
    return status;
}
