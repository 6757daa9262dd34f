// Particles one by one: time integration, tethers, and what coarse levels hand down. Particles are quads in memory, so a
// row of lanes holds two of them and nothing is transposed where the four numbers are treated alike.
#include "kernel_isa.h"

// x, y and z of two particles; the fourth numbers stay what they are.
static const int32_t XYZ_MASK[8] = { -1, -1, -1, 0, -1, -1, -1, 0 };

// A particle of a row moves only if its inverse mass is above 0.
LANE_INLINE lane8m moves( lane8 position )
{
    return lane8_lt( lane8_zero(), lane8_spread_last( position ) );
}

void KERNEL( accelerate )( const wisp_particle_job* job, int begin, int end )
{
    const float a[8] = {
        job->acceleration.x * job->dt, job->acceleration.y * job->dt, job->acceleration.z * job->dt, 0.0f,
        job->acceleration.x * job->dt, job->acceleration.y * job->dt, job->acceleration.z * job->dt, 0.0f,
    };
    const lane8 change = lane8_loadu( a );
    for ( int slot = begin; slot < end; slot += 2 )
    {
        lane8 velocity = lane8_load( job->velocity + (size_t)slot * 4 );
        lane8m free = moves( lane8_load( job->position + (size_t)slot * 4 ) );
        lane8 faster = lane8_add( velocity, change );
        lane8_store( job->velocity + (size_t)slot * 4, lane8_select( free, faster, velocity ) );
    }
}

// The fourth number of a velocity is 0, so the inverse mass gets 0 added and keeps its bits.
void KERNEL( predict )( const wisp_particle_job* job, int begin, int end )
{
    const lane8 dt = lane8_set1( job->dt );
    for ( int slot = begin; slot < end; slot += 2 )
    {
        lane8 position = lane8_load( job->position + (size_t)slot * 4 );
        lane8 velocity = lane8_load( job->velocity + (size_t)slot * 4 );
        lane8_store( job->previous + (size_t)slot * 4, position );
        lane8 there = lane8_mul_add( velocity, dt, position );
        lane8_store( job->position + (size_t)slot * 4, lane8_select( moves( position ), there, position ) );
    }
}

// Eq. 2 is v = (p - x) / dt. Written as v* + (p - p*) / dt, with the prediction p* = x + dt v* rounded as predict() rounded
// it, a particle that no constraint moved keeps its velocity to the last bit. A difference of positions would lose it:
// 50 m from the origin and in steps of a sixth of a millisecond, nothing falls.
void KERNEL( velocity )( const wisp_particle_job* job, int begin, int end )
{
    const lane8 dt = lane8_set1( job->dt );
    const lane8i mask = lane8i_loadu( XYZ_MASK );
    for ( int slot = begin; slot < end; slot += 2 )
    {
        lane8 position = lane8_load( job->position + (size_t)slot * 4 );
        lane8 previous = lane8_load( job->previous + (size_t)slot * 4 );
        lane8 velocity = lane8_load( job->velocity + (size_t)slot * 4 );
        lane8 predicted = lane8_mul_add( velocity, dt, previous );
        lane8 v = lane8_add( velocity, lane8_div( lane8_sub( position, predicted ), dt ) );
        lane8 xyz = lane8_cast_float( lane8i_and( lane8_cast_int( v ), mask ) );
        lane8_store( job->velocity + (size_t)slot * 4, lane8_select( moves( position ), xyz, lane8_zero() ) );
    }
}

// A long-range attachment only ever pulls (Kim, Chentanez and Mueller-Fischer 2012): p moves onto the sphere of the
// distance along the mesh when it has left it.
void KERNEL( tether )( const wisp_tether_job* job, int begin, int end )
{
    const lane8 slack = lane8_set1( job->slack ), zero = lane8_zero();
    for ( int slot = begin; slot < end; slot += 8 )
    {
        float* quads = job->position + (size_t)slot * 4;
        lane8v p, a;
        lane8 w, anchor_w;
        lane8_load_xyzw_contiguous( quads, &p.x, &p.y, &p.z, &w );
        lane8_load_xyzw( job->position, job->anchor4 + slot, &a.x, &a.y, &a.z, &anchor_w );
        lane8v d = lane8v_sub( p, a );
        lane8 length = lane8v_length( d );
        lane8 longest = lane8_mul( lane8_loadu( job->rest + slot ), slack );
        lane8m pulls =
            lane8m_and( lane8_lt( longest, length ), lane8m_and( lane8_lt( zero, w ), lane8_eq( anchor_w, zero ) ) );
        // its own anchor, at distance 0, pads
        pulls = lane8m_and( pulls, lane8_lt( zero, longest ) );
        if ( lane8m_any( pulls ) == false )
        {
            continue;
        }
        lane8 keep = lane8_div( longest, lane8_select( pulls, length, lane8_set1( 1.0f ) ) );
        lane8v there = lane8v_mul_add( a, keep, d );
        _Alignas( 64 ) float moved[32];
        lane8_store_xyzw_contiguous( moved, there.x, there.y, there.z, w );

        // Only what moves is written: other workers read the anchors among these slots.
        uint32_t bits = lane8m_bits( pulls );
        for ( size_t lane = 0; lane < 8; ++lane )
        {
            if ( ( bits >> lane & 1 ) != 0 )
            {
                memcpy( quads + 4 * lane, moved + 4 * lane, 4 * sizeof( float ) );
            }
        }
    }
}

void KERNEL( prolong )( const wisp_prolong_job* job, int begin, int end )
{
    for ( int slice = begin; slice < end; ++slice )
    {
        const int32_t* child4 = job->child4 + (size_t)slice * 8;
        lane8v sum = { lane8_zero(), lane8_zero(), lane8_zero() };
        for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
        {
            size_t row = ( (size_t)slice * WISP_FABRIC_PARENTS + (size_t)k ) * 8;
            lane8v now, before;
            lane8_load_xyz( job->position, job->parent4 + row, &now.x, &now.y, &now.z );
            lane8_load_xyz( job->before, job->parent4 + row, &before.x, &before.y, &before.z );
            sum = lane8v_mul_add( sum, lane8_loadu( job->weight + row ), lane8v_sub( now, before ) );
        }
        lane8v p;
        lane8 w;
        lane8_load_xyzw( job->position, child4, &p.x, &p.y, &p.z, &w );
        lane8v there = lane8v_select( lane8_lt( lane8_zero(), w ), lane8v_add( p, sum ), p );
        lane8_store_xyzw( job->position, child4, there.x, there.y, there.z, w );
    }
}
