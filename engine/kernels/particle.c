// Particles: time integration and tethers. A particle is four floats, so a register holds two. Nothing is transposed where all
// four components are treated alike.
#include "kernel_isa.h"

// Selects x, y and z of two particles; fourth components are kept.
static const int32_t XYZ_MASK[8] = { -1, -1, -1, 0, -1, -1, -1, 0 };

// Selects particles with an inverse mass above 0.
LANE_INLINE lane8m moves( lane8 position )
{
    return lane8_lt( lane8_zero(), lane8_spread_last( position ) );
}

void KERNEL( accelerate )( const wisp_particle_args* args, int begin, int end )
{
    const float a[8] = {
        args->acceleration.x * args->dt, args->acceleration.y * args->dt, args->acceleration.z * args->dt, 0.0f,
        args->acceleration.x * args->dt, args->acceleration.y * args->dt, args->acceleration.z * args->dt, 0.0f,
    };
    const lane8 change = lane8_loadu( a );
    for ( int slot = begin; slot < end; slot += 2 )
    {
        lane8 velocity = lane8_load( args->velocity + (size_t)slot * 4 );
        lane8m free = moves( lane8_load( args->position + (size_t)slot * 4 ) );
        lane8 faster = lane8_add( velocity, change );
        lane8_store( args->velocity + (size_t)slot * 4, lane8_select( free, faster, velocity ) );
    }
}

// Adds the acceleration. The fourth component of a velocity is 0, so the inverse mass gets 0 added and keeps its
// bits.
void KERNEL( predict )( const wisp_particle_args* args, int begin, int end )
{
    const lane8 dt = lane8_set1( args->dt );
    for ( int slot = begin; slot < end; slot += 2 )
    {
        lane8 position = lane8_load( args->position + (size_t)slot * 4 );
        lane8 velocity = lane8_load( args->velocity + (size_t)slot * 4 );
        lane8_store( args->previous + (size_t)slot * 4, position );
        lane8 moved = lane8_mul_add( velocity, dt, position );
        lane8_store( args->position + (size_t)slot * 4, lane8_select( moves( position ), moved, position ) );
    }
}

// Computes velocities. Eq. 2 is v = (p - x) / dt. It is evaluated as v* + (p - p*) / dt, with the prediction p* = x
// + dt v* rounded as in predict(). So a particle that no constraint moved keeps the bits of its velocity. The plain
// difference would lose them: at 50 m from the origin, with substeps of a sixth of a millisecond, particles would
// not fall.
void KERNEL( velocity )( const wisp_particle_args* args, int begin, int end )
{
    const lane8 dt = lane8_set1( args->dt );
    const lane8i mask = lane8i_loadu( XYZ_MASK );
    for ( int slot = begin; slot < end; slot += 2 )
    {
        lane8 position = lane8_load( args->position + (size_t)slot * 4 );
        lane8 previous = lane8_load( args->previous + (size_t)slot * 4 );
        lane8 velocity = lane8_load( args->velocity + (size_t)slot * 4 );
        lane8 predicted = lane8_mul_add( velocity, dt, previous );
        lane8 v = lane8_add( velocity, lane8_div( lane8_sub( position, predicted ), dt ) );
        lane8 xyz = lane8_cast_float( lane8i_and( lane8_cast_int( v ), mask ) );
        lane8_store( args->velocity + (size_t)slot * 4, lane8_select( moves( position ), xyz, lane8_zero() ) );
    }
}

// Computes magnitudes of x, y and z of two particles, and 0 for each fourth component, which may be arbitrary.
LANE_INLINE lane8 magnitudes( const float* row )
{
    static const int32_t MASK[8] = { INT32_MAX, INT32_MAX, INT32_MAX, 0, INT32_MAX, INT32_MAX, INT32_MAX, 0 };
    return lane8_cast_float( lane8i_and( lane8_cast_int( lane8_load( row ) ), lane8i_loadu( MASK ) ) );
}

// Finds components out of bounds; the comparison fails for NaN. Eight particles are tested together. Single
// particles are tested only after a failure, which halts the entity.
int KERNEL( find_out_of_bounds )( const wisp_bound_args* args, int begin, int end )
{
    const lane8 bound = lane8_set1( args->bound );
    for ( int slot = begin; slot < end; slot += 8 )
    {
        lane8m within[4];
        for ( int r = 0; r < 4; ++r )
        {
            size_t row = (size_t)slot * 4 + (size_t)r * 8;
            within[r] = lane8m_and( lane8_le( magnitudes( args->position + row ), bound ),
                                    lane8_le( magnitudes( args->velocity + row ), bound ) );
        }
        if ( lane8m_all( lane8m_and( lane8m_and( within[0], within[1] ), lane8m_and( within[2], within[3] ) ) ) )
        {
            continue;
        }
        uint32_t bits = 0;
        for ( int r = 0; r < 4; ++r )
        {
            bits |= ( lane8m_bits( within[r] ) & 0xffu ) << ( 8 * r );
        }
        return slot + __builtin_ctz( ~bits ) / 4;
    }
    return end;
}

typedef struct tethered
{
    lane8v place;
    lane8 weight;  // inverse mass of the particle
    uint32_t bits; // lanes that move
} tethered;

// Loads attachments. Neighbours mostly share one attachment, which is then read once.
LANE_INLINE void load_anchors( const float* position, const int32_t* anchor_x4, lane8v* place, lane8* weight )
{
    const lane8i all = lane8i_loadu( anchor_x4 );
    if ( lane8m_all( lane8i_eq( all, lane8i_set1( anchor_x4[0] ) ) ) )
    {
        const float* quad = position + anchor_x4[0];
        *place = ( lane8v ){ lane8_set1( quad[0] ), lane8_set1( quad[1] ), lane8_set1( quad[2] ) };
        *weight = lane8_set1( quad[3] );
        return;
    }
    lane8_load_xyzw( position, anchor_x4, &place->x, &place->y, &place->z, weight );
}

// Applies tethers as long range attachments (Kim, Chentanez and Mueller-Fischer 2012): a particle outside the
// sphere of the geodesic distance moves onto it.
LANE_INLINE void pull( const wisp_tether_args* args, size_t tether, tethered* p )
{
    const lane8 zero = lane8_zero();
    lane8v a;
    lane8 anchor_weight;
    load_anchors( args->position, args->anchor_x4 + tether, &a, &anchor_weight );
    lane8v d = lane8v_sub( p->place, a );
    lane8 length = lane8v_length( d );
    lane8 longest = lane8_mul( lane8_loadu( args->rest + tether ), lane8_set1( args->slack ) );
    lane8m pulls = lane8m_and( lane8_lt( longest, length ),
                               lane8m_and( lane8_lt( zero, p->weight ), lane8_eq( anchor_weight, zero ) ) );
    // padding refers to the particle itself, at distance 0
    pulls = lane8m_and( pulls, lane8_lt( zero, longest ) );
    if ( lane8m_any( pulls ) )
    {
        lane8 keep = lane8_div( longest, lane8_select( pulls, length, lane8_set1( 1.0f ) ) );
        p->place = lane8v_select( pulls, lane8v_mul_add( a, keep, d ), p->place );
        p->bits |= lane8m_bits( pulls );
    }
}

void KERNEL( tether )( const wisp_tether_args* args, int begin, int end )
{
    const wisp_tether_args mine = *args;
    for ( int slot = begin; slot < end; slot += 8 )
    {
        float* xyzw = mine.position + (size_t)slot * 4;
        tethered p = { .bits = 0 };
        lane8_load_xyzw_contiguous( xyzw, &p.place.x, &p.place.y, &p.place.z, &p.weight );
        for ( int layer = 0; layer < mine.layer_count; ++layer )
        {
            pull( &mine, (size_t)layer * (size_t)mine.slot_count + (size_t)slot, &p );
        }

        // write only particles that move: other workers read attachments among these slots
        if ( ( p.bits & 0xffu ) == 0xffu )
        {
            lane8_store_xyzw_contiguous( xyzw, p.place.x, p.place.y, p.place.z, p.weight );
        }
        else if ( p.bits != 0 )
        {
            _Alignas( 64 ) float moved[32];
            lane8_store_xyzw_contiguous( moved, p.place.x, p.place.y, p.place.z, p.weight );
            for ( uint32_t bits = p.bits & 0xffu; bits != 0; bits &= bits - 1 )
            {
                size_t lane = (size_t)__builtin_ctz( bits );
                memcpy( xyzw + 4 * lane, moved + 4 * lane, 4 * sizeof( float ) );
            }
        }
    }
}

// Scales velocities, so that their direction stays. A velocity that is not finite stays for the state check.
int KERNEL( limit_speed )( float* velocity, float max_speed, int begin, int end )
{
    const lane8 longest = lane8_set1( max_speed ), one = lane8_set1( 1.0f );
    int count = 0;
    for ( int slot = begin; slot < end; slot += 8 )
    {
        lane8v v;
        lane8 none;
        lane8_load_xyzw_contiguous( velocity + (size_t)slot * 4, &v.x, &v.y, &v.z, &none );
        const lane8 speed = lane8v_length( v );
        const lane8m fast = lane8_lt( longest, speed );
        if ( lane8m_any( fast ) )
        {
            const lane8 keep = lane8_div( longest, lane8_select( fast, speed, one ) );
            v = lane8v_select( fast, lane8v_scale( v, keep ), v );
            lane8_store_xyzw_contiguous( velocity + (size_t)slot * 4, v.x, v.y, v.z, none );
            count += __builtin_popcount( lane8m_bits( fast ) & 0xffu );
        }
    }
    return count;
}
