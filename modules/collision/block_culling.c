// Culling of particles. In: a block of particles, a body. Out: the particles that may be within reach of the body.
// Most particles are far from most bodies, so kernels do this for a block at once. A particle is culled only where
// its closest point query would have found nothing either, so results do not depend on it.
#include "block_culling.h"

#include "collision_vectors.h"

#include <string.h>

static wisp_swarm swarm_of( collision_block* b )
{
    return ( wisp_swarm ){ b->slot, { b->now[0], b->now[1], b->now[2] }, { b->old[0], b->old[1], b->old[2] } };
}

void collision_begin_block( const collision_find_job* job, int begin, int end, collision_block* block )
{
    WISP_ASSERT( end - begin <= COLLISION_BLOCK );
    float low[3], high[3];
    const wisp_swarm_job take = {
        .position = job->position,
        .previous = job->previous,
        .place = job->found,
        .swarm = swarm_of( block ),
        .low = low,
        .high = high,
    };
    block->count = job->kernels->swarm_take( &take, begin, end );
    block->low = collision_load( low );
    block->high = collision_load( high );
    memset( job->count + begin, 0, (size_t)( end - begin ) * sizeof( *job->count ) );
    for ( int i = 0; i < COLLISION_BLOCK; ++i )
    {
        block->clear[i] = INFINITY;
    }
}

static wisp_swarm_bound bound_of( const collision_body* body )
{
    if ( body->tree != NULL || body->shape.kind == WISP_SHAPE_BOX )
    {
        return WISP_SWARM_BOX;
    }
    return body->shape.kind == WISP_SHAPE_PLANE ? WISP_SWARM_HALF_SPACE : WISP_SWARM_ROUND;
}

void collision_cull_block( const wisp_kernels* kernels, const collision_view* view, collision_block* block )
{
    const collision_body* body = view->body;
    const wisp_swarm_sight sight = {
        .swarm = swarm_of( block ),
        .before = view->before,
        .after = view->after,
        .bound = bound_of( body ),
        .centre = body->centre,
        .half = body->half,
        .radius = body->shape.radius,
        .half_length = body->shape.kind == WISP_SHAPE_CAPSULE ? body->shape.half_length : 0.0f,
        .margin = 2.0f * view->thickness,
        .from = { block->from[0], block->from[1], block->from[2] },
        .to = { block->to[0], block->to[1], block->to[2] },
        .path = block->path,
        .reach = block->reach,
        .clear = block->clear,
        .asked = block->candidates,
    };
    block->candidate_count = kernels->swarm_see( &sight, block->count );
}
