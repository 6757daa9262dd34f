// Culling of particles. In: a block of particles, a body. Out: the particles that may be within reach of the body.
// Most particles are far from most bodies, so kernels do this for a block at once. A particle is culled only where
// its closest point query would have found nothing either, so results do not depend on it.
//
// In the first substep of a step, each particle gets a radius within which it may move for the rest of the step
// without being found by a body, however that moves. A group of eight slots whose particles all have one is settled:
// later substeps only test whether they are still within their radius, and search again for the group if one is not.
// The last substep searches for all, so what is stored after a step is the same as without this.
#include "particle_contacts.h"

#include "collision_vectors.h"

#include <string.h>

static wisp_particle_batch particle_batch_of( collision_block* b )
{
    return ( wisp_particle_batch ){
        b->slot, b->moving, b->pinned, { b->now[0], b->now[1], b->now[2] }, { b->old[0], b->old[1], b->old[2] }
    };
}

static void clear_counts( const collision_find_args* args, const collision_block* block, uint32_t groups )
{
    for ( int slot = block->begin; slot < block->end; slot += COLLISION_GROUP, groups >>= 1 )
    {
        const int left = block->end - slot, count = left < COLLISION_GROUP ? left : COLLISION_GROUP;
        if ( ( groups & 1u ) != 0 )
        {
            memset( args->count + slot, 0, (size_t)count * sizeof( *args->count ) );
        }
    }
}

void collision_begin_block( const collision_find_args* args, int begin, int end, collision_block* block )
{
    WISP_ASSERT( end - begin <= COLLISION_BLOCK );
    float lower[3], upper[3];
    const wisp_kernels* kernels = args->kernels;
    const uint32_t groups = args->has_settled
                                ? kernels->find_unclear( args->position, args->previous, args->found, begin, end )
                                : ~args->left_out;
    const wisp_gather_args take = {
        .position = args->position,
        .previous = args->previous,
        .search_origin = args->found,
        .groups = groups,
        .batch = particle_batch_of( block ),
        .lower = lower,
        .upper = upper,
    };
    block->begin = begin;
    block->end = end;
    block->is_last = false;
    block->met = 0;
    block->count = groups != 0 ? kernels->gather_particles( &take, begin, end ) : 0;
    clear_counts( args, block, groups );
    if ( block->count > 0 )
    {
        block->lower = wisp_v3_load( lower );
        block->upper = wisp_v3_load( upper );
    }
    for ( int i = 0; i < block->count; ++i )
    {
        block->clear[i] = INFINITY;
        block->free_radius[i] = INFINITY;
    }
}

static wisp_cull_shape bound_of( const collision_body* body )
{
    if ( body->tree != NULL )
    {
        return WISP_CULL_BOX_AND_BALL;
    }
    if ( body->shape.kind == WISP_SHAPE_BOX || body->shape.kind == WISP_SHAPE_CONVEX )
    {
        return WISP_CULL_BOX;
    }
    const bool is_ground = body->shape.kind == WISP_SHAPE_PLANE || body->shape.kind == WISP_SHAPE_HEIGHT_FIELD;
    return is_ground ? WISP_CULL_HALF_SPACE : WISP_CULL_ROUND;
}

// Return the radius of a round bound, or that of the ball around a mesh.
static float radius_of( const collision_body* body )
{
    const wisp_shape* s = &body->shape;
    const bool tapered = s->kind == WISP_SHAPE_TAPERED_CAPSULE;
    return body->tree != NULL ? body->tight_radius : tapered ? fmaxf( s->top_radius, s->bottom_radius ) : s->radius;
}

static float half_length_of( const collision_body* body )
{
    const bool is_long = body->shape.kind == WISP_SHAPE_CAPSULE || body->shape.kind == WISP_SHAPE_TAPERED_CAPSULE;
    return is_long ? body->shape.half_length : 0.0f;
}

void collision_cull_block( const collision_find_args* args, const collision_view* view, collision_block* block )
{
    const collision_body* body = view->body;
    const wisp_cull_args sight = {
        .batch = particle_batch_of( block ),
        .before = view->before,
        .after = view->after,
        .shape = bound_of( body ),
        .centre = body->centre,
        .half = body->half,
        .radius = radius_of( body ),
        .half_length = half_length_of( body ),
        .margin = 2.0f * view->thickness + collision_surface_shift( view ),
        .shift = view->shift,
        .turn = view->turn,
        .clearance = block->clear,
        .free_radius = args->settles ? block->free_radius : NULL,
        .from = { block->from[0], block->from[1], block->from[2] },
        .to = { block->to[0], block->to[1], block->to[2] },
        .path = block->path,
        .reach = block->reach,
        .candidates = block->candidates,
    };
    block->candidate_count = args->kernels->cull_particles( &sight, block->count );
}

void collision_skip_block( const collision_view* view, float apart, collision_block* block )
{
    const wisp_vec3 l = block->lower, u = block->upper;
    const float size =
        fabsf( l.x ) + fabsf( l.y ) + fabsf( l.z ) + fabsf( u.x ) + fabsf( u.y ) + fabsf( u.z ) + apart;
    const float spare = apart - 2.0f * ( view->shift + view->thickness ) - 1e-5f * size;
    const float radius = view->turn > 0.0f ? -1.0f : 0.33f * spare;
    for ( int i = 0; i < block->count; ++i )
    {
        block->clear[i] = apart < block->clear[i] ? apart : block->clear[i];
        block->free_radius[i] = radius < block->free_radius[i] ? radius : block->free_radius[i];
    }
}

// ---- the end ----

static bool is_settled( const collision_block* block, int group )
{
    const float* radius = block->free_radius + group * COLLISION_GROUP;
    unsigned free = block->pinned[group];
    for ( int l = 0; l < COLLISION_GROUP; ++l )
    {
        free |= radius[l] > 0.0f ? (unsigned)block->moving[group] & 1u << l : 0u;
    }
    return free == 255u;
}

void collision_end_block( const collision_find_args* args, const collision_block* block )
{
    for ( int group = 0; group * COLLISION_GROUP < block->count; ++group )
    {
        const bool settled = args->settles && is_settled( block, group );
        float* found = args->found + (size_t)block->slot[group] * 4 + 3;
        for ( int l = 0; l < COLLISION_GROUP; ++l, found += 4 )
        {
            const int i = group * COLLISION_GROUP + l;
            const float distance = settled ? -block->free_radius[i] : block->clear[i];
            const bool moves = ( block->moving[group] >> l & 1 ) != 0;
            *found = moves ? distance : ( settled ? -INFINITY : INFINITY );
        }
    }
}
