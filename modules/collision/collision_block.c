// A block of particles seen from a body: who may be within reach of it?
//
// Most particles are far from most bodies, so this decides what contacts cost. Everything is an array a coordinate,
// loops have no branches and compilers make vectors of them. Whoever is called far is beyond reach by the very numbers
// that the closest point would have been compared by, or by a bound that rounding cannot reverse, so that nothing
// depends on who was asked.
#include "collision_internal.h"

#include <math.h>
#include <string.h>

// ---- the block ----

static bool is_movable( const float* quad, const float* old )
{
    const float most = 1e9f; // as in collision_is_finite(), without its branches
    bool place = ( fabsf( quad[0] ) <= most ) & ( fabsf( quad[1] ) <= most ) & ( fabsf( quad[2] ) <= most );
    bool start = ( fabsf( old[0] ) <= most ) & ( fabsf( old[1] ) <= most ) & ( fabsf( old[2] ) <= most );
    return ( quad[3] > 0.0f ) & place & start;
}

static void keep_smaller( float* restrict x, const float* restrict other, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        x[i] = other[i] < x[i] ? other[i] : x[i];
    }
}

static void keep_larger( float* restrict x, const float* restrict other, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        x[i] = other[i] > x[i] ? other[i] : x[i];
    }
}

// The smallest and the largest of two arrays: one against the other, then always the upper half against the lower.
static void find_range( const float* a, const float* b, int count, float* low, float* high )
{
    const size_t bytes = (size_t)count * sizeof( float );
    float least[COLLISION_BLOCK], most[COLLISION_BLOCK];
    memcpy( least, a, bytes );
    memcpy( most, a, bytes );
    keep_smaller( least, b, count );
    keep_larger( most, b, count );
    for ( int half = count / 2; count > 1; half = count / 2 )
    {
        count -= half;
        keep_smaller( least, least + count, half );
        keep_larger( most, most + count, half );
    }
    *low = least[0];
    *high = most[0];
}

void collision_begin_block( const collision_find_job* job, int begin, int end, collision_block* block )
{
    WISP_ASSERT( end - begin <= COLLISION_BLOCK );
    const float* restrict position = job->position, * restrict previous = job->previous;
    float* restrict found = job->found;
    int n = 0;
    for ( int slot = begin; slot < end; ++slot )
    {
        const float *quad = position + (size_t)slot * 4, *old = previous + (size_t)slot * 4;
        memcpy( found + (size_t)slot * 4, quad, 3 * sizeof( float ) );
        found[(size_t)slot * 4 + 3] = INFINITY;
        block->slot[n] = slot;
        for ( int k = 0; k < 3; ++k )
        {
            block->now[k][n] = quad[k];
            block->old[k][n] = old[k];
        }
        n += is_movable( quad, old ) ? 1 : 0;
    }
    memset( job->count + begin, 0, (size_t)( end - begin ) * sizeof( *job->count ) );
    block->count = n;
    for ( int i = 0; i < n; ++i )
    {
        block->clear[i] = INFINITY;
    }
    if ( n > 0 )
    {
        find_range( block->now[0], block->old[0], n, &block->low.x, &block->high.x );
        find_range( block->now[1], block->old[1], n, &block->low.y, &block->high.y );
        find_range( block->now[2], block->old[2], n, &block->low.z, &block->high.z );
    }
}

// ---- who is far away ----

static void see( wisp_rigid pose, int count, float ( *restrict world )[COLLISION_BLOCK],
                 float ( *restrict seen )[COLLISION_BLOCK] )
{
    for ( int i = 0; i < count; ++i )
    {
        const wisp_vec3 p = wisp_rigid_to_body( pose, ( wisp_vec3 ){ world[0][i], world[1][i], world[2][i] } );
        seen[0][i] = p.x;
        seen[1][i] = p.y;
        seen[2][i] = p.z;
    }
}

static void measure_paths( float thickness, collision_block* b )
{
    for ( int i = 0; i < b->count; ++i )
    {
        const wisp_vec3 way = { b->to[0][i] - b->from[0][i], b->to[1][i] - b->from[1][i],
                                b->to[2][i] - b->from[2][i] };
        b->path[i] = collision_length( way );
        b->reach[i] = 2.0f * thickness + b->path[i];
    }
}

// A ball, or a capsule along y, is beyond reach where it is so by more than the rounding of both ways to say it.
static void measure_round( const wisp_shape* shape, const collision_block* b, float* restrict gap )
{
    const float sure = 1.00001f, half = shape->kind == WISP_SHAPE_CAPSULE ? shape->half_length : 0.0f;
    for ( int i = 0; i < b->count; ++i )
    {
        float y = fabsf( b->to[1][i] ) - half, limit = shape->radius + b->reach[i];
        y = y > 0.0f ? y : 0.0f;
        float squared = b->to[0][i] * b->to[0][i] + y * y + b->to[2][i] * b->to[2][i];
        gap[i] = squared > sure * limit * limit ? INFINITY : gap[i];
    }
}

// No more than the distance from the body, m, or infinite where that is beyond reach.
static void measure_gaps( const collision_body* body, const collision_block* b, float* restrict gap )
{
    if ( body->tree == NULL && body->shape.kind == WISP_SHAPE_PLANE )
    {
        memcpy( gap, b->to[1], (size_t)b->count * sizeof( float ) );
        return;
    }
    for ( int i = 0; i < b->count; ++i )
    {
        gap[i] = collision_box_distance( body, ( wisp_vec3 ){ b->to[0][i], b->to[1][i], b->to[2][i] } );
    }
    if ( body->tree == NULL && body->shape.kind != WISP_SHAPE_BOX )
    {
        measure_round( &body->shape, b, gap );
    }
}

void collision_see_block( const collision_view* view, collision_block* block )
{
    see( view->before, block->count, block->old, block->from );
    see( view->after, block->count, block->now, block->to );
    measure_paths( view->thickness, block );
    float gap[COLLISION_BLOCK];
    measure_gaps( view->body, block, gap );
    int n = 0;
    for ( int i = 0; i < block->count; ++i )
    {
        float nearest = block->reach[i] < block->clear[i] ? block->reach[i] : block->clear[i];
        block->clear[i] = gap[i] > block->reach[i] ? nearest : block->clear[i];
    }
    for ( int i = 0; i < block->count; ++i )
    {
        block->asked[n] = i;
        n += gap[i] > block->reach[i] ? 0 : 1;
    }
    block->asked_count = n;
}
