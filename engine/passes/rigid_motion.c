// The rigid motion of a surface: that with its momentum and its angular momentum.
#include "passes.h"

#include <math.h>

enum
{
    MAX_BLOCKS = 64,
    MIN_BLOCK = 1024, // slots
};

typedef struct rigid_loop
{
    const wisp_kernels* kernels;
    wisp_rigid_args args;
    int slot_count, block; // slots of a block
    wisp_rigid_sums* sums; // [block]
} rigid_loop;

static int block_of( int slots )
{
    const int most = ( slots / MAX_BLOCKS + 8 ) / 8 * 8; // whole lanes
    return most > MIN_BLOCK ? most : MIN_BLOCK;
}

static int end_of( const rigid_loop* loop, int block )
{
    const int end = ( block + 1 ) * loop->block;
    return end < loop->slot_count ? end : loop->slot_count;
}

static void sum_blocks( void* context, int begin, int end, int worker )
{
    (void)worker;
    rigid_loop* loop = context;
    for ( int b = begin; b < end; ++b )
    {
        loop->kernels->rigid_sums( &loop->args, b * loop->block, end_of( loop, b ), loop->sums + b );
    }
}

static void add_sums( wisp_rigid_sums* all, const wisp_rigid_sums* s )
{
    for ( size_t i = 0; i < sizeof( *all ) / sizeof( double ); ++i )
    {
        ( &all->mass )[i] += ( &s->mass )[i];
    }
}

static void cross_product( const double a[3], const double b[3], double out[3] )
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

// Solve I w = L for a symmetric I by its adjugate. Where all mass lies on a line I has no inverse, but its two
// moments across the line are equal, each half the trace, and L is across it too. With all mass at one point w is 0. A body 350
// times as long as wide counts as a line, because its moment about itself is within the rounding of the sums.
// @param i xx, yy, zz, xy, xz, yz of I
static void solve_inertia( const double i[6], const double l[3], double w[3] )
{
    const double xx = i[0], yy = i[1], zz = i[2], xy = i[3], xz = i[4], yz = i[5];
    const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
    const double determinant = xx * a + xy * b + xz * c, scale = xx + yy + zz;
    if ( fabs( determinant ) <= 1e-6 * scale * scale * scale )
    {
        for ( int k = 0; k < 3; ++k )
        {
            w[k] = scale > 0.0 ? 2.0 * l[k] / scale : 0.0;
        }
        return;
    }
    const double d = xx * zz - xz * xz, e = xy * xz - xx * yz, f = xx * yy - xy * xy;
    w[0] = ( a * l[0] + b * l[1] + c * l[2] ) / determinant;
    w[1] = ( b * l[0] + d * l[1] + e * l[2] ) / determinant;
    w[2] = ( c * l[0] + e * l[1] + f * l[2] ) / determinant;
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
    cross_product( s->moment, velocity, angular );
    for ( int k = 0; k < 3; ++k )
    {
        angular[k] = s->angular_momentum[k] - angular[k];
    }
    const double xx = s->xx - s->moment[0] * centre[0], yy = s->yy - s->moment[1] * centre[1],
                 zz = s->zz - s->moment[2] * centre[2], xy = s->xy - s->moment[0] * centre[1],
                 xz = s->xz - s->moment[0] * centre[2], yz = s->yz - s->moment[1] * centre[2];
    const double inertia[6] = { yy + zz, xx + zz, xx + yy, -xy, -xz, -yz };
    solve_inertia( inertia, angular, turning );
    cross_product( turning, centre, back );
    args->linear_velocity.x += (float)( velocity[0] - back[0] );
    args->linear_velocity.y += (float)( velocity[1] - back[1] );
    args->linear_velocity.z += (float)( velocity[2] - back[2] );
    args->angular_velocity = ( wisp_vec3 ){ (float)turning[0], (float)turning[1], (float)turning[2] };
}

// Measures relative to a free vertex and its mass, so that floats keep their digits far from the origin.
static void measure( rigid_loop* loop, const wisp_parallel* parallel )
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
    loop->args.origin = wisp_v3_load( position + (size_t)first * 4 );
    loop->args.linear_velocity = wisp_v3_load( loop->args.velocity + (size_t)first * 4 );
    loop->args.inverse_mass = position[(size_t)first * 4 + 3];
    loop->sums = sums;
    wisp_parallel_for( parallel, blocks, 1, sum_blocks, loop );
    wisp_rigid_sums all = { 0 };
    for ( int b = 0; b < blocks; ++b ) // in their order
    {
        add_sums( &all, sums + b );
    }
    if ( all.mass > 0.0 ) // a map may leave none
    {
        find_motion( &all, &loop->args );
    }
}

// An unreferenced vertex has no mass and counts as pinned, but holds nothing.
bool passes_has_pins( const wisp_fabric* fabric, const float* position )
{
    for ( int slot = 0; slot < fabric->slot_count; ++slot )
    {
        if ( position[(size_t)slot * 4 + 3] == 0.0f && fabric->area[slot] > 0.0f )
        {
            return true;
        }
    }
    return false;
}

WISP_KERNEL_RANGE( rigid_loop, approach_rigid, rigid_approach, args, 1 )

void wisp_approach_rigid_motion( const wisp_kernels* kernels, const wisp_parallel* parallel,
                                 const wisp_fabric* fabric, const wisp_rigid_args* args )
{
    rigid_loop loop = { kernels, *args, fabric->slot_count, block_of( fabric->slot_count ), NULL };
    if ( passes_has_pins( fabric, args->position ) == false )
    {
        measure( &loop, parallel );
    }
    wisp_parallel_for( parallel, fabric->slot_count, MIN_BLOCK, approach_rigid, &loop );
}

// Measure relative to the first free vertex, as measure() does. @return false if nothing moves
static bool start_lane( const wisp_instances_args* lanes, int lane, wisp_rigid_args* args )
{
    int slot = 0;
    const float* p = lanes->position + lane;
    for ( ; slot < lanes->slot_count && !( p[3 * WISP_INSTANCE_LANES] > 0.0f ); ++slot )
    {
        p += 4 * WISP_INSTANCE_LANES;
    }
    if ( slot == lanes->slot_count )
    {
        return false;
    }
    const float* v = lanes->velocity + (size_t)slot * 3 * WISP_INSTANCE_LANES + lane;
    args->origin = ( wisp_vec3 ){ p[0], p[WISP_INSTANCE_LANES], p[2 * WISP_INSTANCE_LANES] };
    args->linear_velocity = ( wisp_vec3 ){ v[0], v[WISP_INSTANCE_LANES], v[2 * WISP_INSTANCE_LANES] };
    args->inverse_mass = p[3 * WISP_INSTANCE_LANES];
    return true;
}

void wisp_approach_rigid_motions( const wisp_kernels* kernels, const wisp_crowd* crowd, wisp_rigid_args* args )
{
    const wisp_instances_args* lanes = crowd->args;
    uint32_t moves = 0; // lanes that are measured
    for ( int lane = 0; lane < WISP_INSTANCE_LANES; ++lane )
    {
        moves |= ( lanes->pinned >> lane & 1 ) == 0 && start_lane( lanes, lane, args + lane ) ? 1u << lane : 0;
    }
    wisp_rigid_sums all[WISP_INSTANCE_LANES] = { 0 };
    const int block = block_of( lanes->slot_count );
    for ( int begin = 0; begin < lanes->slot_count && moves != 0; begin += block )
    {
        wisp_rigid_sums sums[WISP_INSTANCE_LANES];
        const int left = lanes->slot_count - begin;
        kernels->instances_rigid_sums( lanes, args, begin, begin + ( left < block ? left : block ), sums );
        for ( int lane = 0; lane < WISP_INSTANCE_LANES; ++lane )
        {
            add_sums( all + lane, sums + lane );
        }
    }
    for ( ; moves != 0; moves &= moves - 1 )
    {
        const int lane = __builtin_ctz( moves );
        if ( all[lane].mass > 0.0 )
        {
            find_motion( all + lane, args + lane );
        }
    }
    kernels->instances_rigid_approach( lanes, args );
}
