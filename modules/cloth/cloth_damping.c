// Damping that does not touch rigid motion (Mueller et al. 2007, section 3.5): it reduces the
// difference between a velocity and the rigid motion with the same momentum and angular momentum.
#include "cloth_internal.h"

#include "wisp/module/inertia.h"

// ---- the rigid motion ----

enum
{
    MAX_BLOCKS = 64,
    MIN_BLOCK = 1024, // slots
};

typedef struct damping_loop
{
    const wisp_kernels* kernels;
    wisp_rigid_args args;
    int slot_count, block; // slots of a block
    wisp_rigid_sums* sums; // [block]
} damping_loop;

static int end_of( const damping_loop* loop, int block )
{
    const int end = ( block + 1 ) * loop->block;
    return end < loop->slot_count ? end : loop->slot_count;
}

static void sum_blocks( void* context, int begin, int end, int worker )
{
    (void)worker;
    damping_loop* loop = context;
    for ( int b = begin; b < end; ++b )
    {
        loop->kernels->rigid_sums( &loop->args, b * loop->block, end_of( loop, b ), loop->sums + b );
    }
}

// Sum the blocks in their order.
static wisp_rigid_sums add_up( const damping_loop* loop, int blocks )
{
    wisp_rigid_sums all = { 0 };
    for ( int b = 0; b < blocks; ++b )
    {
        const wisp_rigid_sums* s = loop->sums + b;
        all.mass += s->mass;
        for ( int k = 0; k < 3; ++k )
        {
            all.moment[k] += s->moment[k];
            all.momentum[k] += s->momentum[k];
            all.angular_momentum[k] += s->angular_momentum[k];
        }
        all.xx += s->xx;
        all.yy += s->yy;
        all.zz += s->zz;
        all.xy += s->xy;
        all.xz += s->xz;
        all.yz += s->yz;
    }
    return all;
}

// From sums about the origin to sums about the centre of mass, and to the rigid motion with the same momenta.
static void find_motion( const wisp_rigid_sums* s, wisp_rigid_args* args )
{
    double centre[3], velocity[3], angular[3], turning[3], back[3];
    for ( int k = 0; k < 3; ++k )
    {
        centre[k] = s->moment[k] / s->mass;
        velocity[k] = s->momentum[k] / s->mass;
    }
    wisp_cross_product( s->moment, velocity, angular );
    for ( int k = 0; k < 3; ++k )
    {
        angular[k] = s->angular_momentum[k] - angular[k];
    }
    const double xx = s->xx - s->moment[0] * centre[0], yy = s->yy - s->moment[1] * centre[1],
                 zz = s->zz - s->moment[2] * centre[2], xy = s->xy - s->moment[0] * centre[1],
                 xz = s->xz - s->moment[0] * centre[2], yz = s->yz - s->moment[1] * centre[2];
    const double inertia[6] = { yy + zz, xx + zz, xx + yy, -xy, -xz, -yz };
    wisp_solve_inertia( inertia, angular, turning );
    wisp_cross_product( turning, centre, back );
    args->linear_velocity.x += (float)( velocity[0] - back[0] );
    args->linear_velocity.y += (float)( velocity[1] - back[1] );
    args->linear_velocity.z += (float)( velocity[2] - back[2] );
    args->angular_velocity = ( wisp_vec3 ){ (float)turning[0], (float)turning[1], (float)turning[2] };
}

static wisp_vec3 vector_at( const float* xyzw, int slot )
{
    const float* q = xyzw + (size_t)slot * 4;
    return ( wisp_vec3 ){ q[0], q[1], q[2] };
}

// Measure relative to a free vertex and its mass, so that floats keep their digits far from the origin.
static void measure( damping_loop* loop, const wisp_parallel* parallel )
{
    const float* position = loop->args.position;
    int first = 0;
    while ( first < loop->slot_count && !( position[(size_t)first * 4 + 3] > 0.0f ) )
    {
        first += 1;
    }
    if ( first == loop->slot_count )
    {
        return; // nothing moves
    }
    wisp_rigid_sums sums[MAX_BLOCKS];
    const int blocks = ( loop->slot_count + loop->block - 1 ) / loop->block;
    loop->args.origin = vector_at( position, first );
    loop->args.linear_velocity = vector_at( loop->args.velocity, first );
    loop->args.inverse_mass = position[(size_t)first * 4 + 3];
    loop->sums = sums;
    wisp_parallel_for( parallel, blocks, 1, sum_blocks, loop );
    const wisp_rigid_sums all = add_up( loop, blocks );
    if ( !( all.mass > 0.0 ) )
    {
        return; // a map damps nothing that moves
    }
    find_motion( &all, &loop->args );
}

// ---- damping ----

static bool has_triangle( const wisp_fabric* f, int slot )
{
    int first = f->ring_begin[slot / 8];
    return first < f->ring_begin[slot / 8 + 1] && f->ring_x4[first][slot % 8] != 4 * slot;
}

// The rigid motion of a pinned cloth is rest. An unreferenced vertex has no mass and counts as pinned, but holds nothing.
static bool is_pinned( const wisp_fabric* f, const float* position )
{
    for ( int slot = 0; slot < f->vertex_count; ++slot )
    {
        if ( position[(size_t)slot * 4 + 3] == 0.0f && has_triangle( f, slot ) )
        {
            return true;
        }
    }
    return false;
}

static void approach( void* context, int begin, int end, int worker )
{
    (void)worker;
    const damping_loop* loop = context;
    loop->kernels->rigid_approach( &loop->args, begin, end );
}

// What each velocity loses in this substep. @return null without memory
static const float* list_fractions( wisp_frame* frame, const wisp_span* span, float lost, const float* factor )
{
    const int count = wisp_frame_fabric( frame, span->entity )->slot_count;
    float* fractions =
        wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker, (size_t)count * sizeof( float ) );
    if ( fractions == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the damping of %d particles", count );
        return NULL;
    }
    for ( int slot = 0; slot < count; ++slot )
    {
        const float own = lost * factor[slot];
        fractions[slot] = own / ( 1.0f + own );
    }
    return fractions;
}

void cloth_damp( wisp_frame* frame, const wisp_span* span, void* user )
{
    enum
    {
        GRAIN = 1024,
        LANES = 8,
    };
    const cloth_state* state = user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const float rate = *(float*)wisp_frame_column( frame, span->entity, state->damping, 0 );
    const float lost = rate * wisp_frame_dt( frame, span->entity );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    const int most = ( fabric->slot_count / MAX_BLOCKS + LANES ) / LANES * LANES;
    damping_loop loop = {
        .kernels = wisp_frame_kernels( frame ),
        .slot_count = fabric->slot_count,
        .block = most > MIN_BLOCK ? most : MIN_BLOCK,
    };
    // a pinned cloth comes to rest
    loop.args = ( wisp_rigid_args ){
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .fraction = lost / ( 1.0f + lost ),
    };
    const float* factor = wisp_frame_column( frame, span->entity, WISP_MAP_INTERNAL_DAMPING, 0 );
    if ( factor != NULL )
    {
        loop.args.fractions = list_fractions( frame, span, lost, factor );
        if ( loop.args.fractions == NULL )
        {
            return;
        }
    }
    if ( is_pinned( fabric, loop.args.position ) == false )
    {
        measure( &loop, parallel );
    }
    wisp_parallel_for( parallel, fabric->slot_count, GRAIN, approach, &loop );
}
