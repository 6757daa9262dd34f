// Culling of particles. In: a block of particles, a body. Out: the particles that may be within reach of the body.
// Most particles are far from most bodies, so kernels do this for a block at once. A particle is culled only where
// its closest point query would have found nothing either, so results do not depend on it.
#include "block_culling.h"

#include "collision_vectors.h"

#include <string.h>

static wisp_particle_batch particle_batch_of( collision_block* b )
{
    return (
        wisp_particle_batch ){ b->slot, { b->now[0], b->now[1], b->now[2] }, { b->old[0], b->old[1], b->old[2] } };
}

void collision_begin_block( const collision_find_args* args, int begin, int end, collision_block* block )
{
    WISP_ASSERT( end - begin <= COLLISION_BLOCK );
    float lower[3], upper[3];
    const wisp_gather_args take = {
        .position = args->position,
        .previous = args->previous,
        .search_origin = args->found,
        .batch = particle_batch_of( block ),
        .lower = lower,
        .upper = upper,
    };
    block->count = args->kernels->gather_particles( &take, begin, end );
    block->lower = collision_load( lower );
    block->upper = collision_load( upper );
    memset( args->count + begin, 0, (size_t)( end - begin ) * sizeof( *args->count ) );
    for ( int i = 0; i < COLLISION_BLOCK; ++i )
    {
        block->clear[i] = INFINITY;
    }
}

static wisp_cull_shape bound_of( const collision_body* body )
{
    if ( body->tree != NULL || body->shape.kind == WISP_SHAPE_BOX )
    {
        return WISP_CULL_BOX;
    }
    return body->shape.kind == WISP_SHAPE_PLANE ? WISP_CULL_HALF_SPACE : WISP_CULL_ROUND;
}

void collision_cull_block( const wisp_kernels* kernels, const collision_view* view, collision_block* block )
{
    const collision_body* body = view->body;
    const wisp_cull_args sight = {
        .batch = particle_batch_of( block ),
        .before = view->before,
        .after = view->after,
        .shape = bound_of( body ),
        .centre = body->centre,
        .half = body->half,
        .radius = body->shape.radius,
        .half_length = body->shape.kind == WISP_SHAPE_CAPSULE ? body->shape.half_length : 0.0f,
        .margin = 2.0f * view->thickness,
        .from = { block->from[0], block->from[1], block->from[2] },
        .to = { block->to[0], block->to[1], block->to[2] },
        .path = block->path,
        .reach = block->reach,
        .clearance = block->clear,
        .candidates = block->candidates,
    };
    block->candidate_count = kernels->cull_particles( &sight, block->count );
}
