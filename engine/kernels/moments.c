// Moments of particles and small rotations, in doubles. What is left of an angular momentum after its removal is the rounding
// error of these sums, and it adds up over all substeps.
#include "kernel_isa.h"

#include "lane_double_vec.h"

typedef struct moment_lanes
{
    lane8d mass;
    lane8dv first, previous, momentum, angular;
    lane8dv mixed[3];
} moment_lanes;

// Eight particles, relative to the origin.
typedef struct particles8
{
    lane8d mass; // 0 if pinned
    lane8dv now, previous, velocity;
} particles8;

LANE_INLINE lane8v load_xyz( const float* xyzw, int slot, lane8* w )
{
    lane8v v;
    lane8_load_xyzw_contiguous( xyzw + (size_t)slot * 4, &v.x, &v.y, &v.z, w );
    return v;
}

LANE_INLINE particles8 load_particles( const wisp_moment_args* args, int slot, lane8dv origin, bool moved,
                                       lane8* inverse_mass )
{
    lane8 none;
    const lane8d zero = lane8d_set1( 0.0 );
    const lane8v now = load_xyz( args->position, slot, inverse_mass );
    const lane8v previous = moved ? load_xyz( args->previous, slot, &none ) : now;
    const lane8d w = lane8d_widen( *inverse_mass );
    return ( particles8 ){
        .mass = lane8d_select( lane8d_lt( zero, w ), lane8d_div( lane8d_set1( 1.0 ), w ), zero ),
        .now = lane8dv_sub( lane8dv_widen( now ), origin ),
        .previous = lane8dv_sub( lane8dv_widen( previous ), origin ),
        .velocity = lane8dv_widen( load_xyz( args->velocity, slot, &none ) ),
    };
}

LANE_INLINE void add_particles( moment_lanes* m, particles8 p )
{
    const lane8dv heavy = lane8dv_scale( p.now, p.mass ), momentum = lane8dv_scale( p.velocity, p.mass );
    m->mass = lane8d_add( m->mass, p.mass );
    m->first = lane8dv_add( m->first, heavy );
    m->previous = lane8dv_add( m->previous, lane8dv_scale( p.previous, p.mass ) );
    m->momentum = lane8dv_add( m->momentum, momentum );
    m->angular = lane8dv_add( m->angular, lane8dv_cross( p.previous, momentum ) );
    m->mixed[0] = lane8dv_add( m->mixed[0], lane8dv_scale( p.previous, heavy.x ) );
    m->mixed[1] = lane8dv_add( m->mixed[1], lane8dv_scale( p.previous, heavy.y ) );
    m->mixed[2] = lane8dv_add( m->mixed[2], lane8dv_scale( p.previous, heavy.z ) );
}

LANE_INLINE void sum_lanes( lane8dv v, double sum[3] )
{
    sum[0] = lane8d_sum_ordered( v.x );
    sum[1] = lane8d_sum_ordered( v.y );
    sum[2] = lane8d_sum_ordered( v.z );
}

// @param moved previous positions are other ones
LANE_INLINE void sum_particles( const wisp_moment_args* args, int begin, int end, bool moved, wisp_moments* sums )
{
    const double about[3] = { (double)args->origin.x, (double)args->origin.y, (double)args->origin.z };
    const lane8dv origin = lane8dv_set1( about ), none = lane8dv_set1( ( double[3] ){ 0.0, 0.0, 0.0 } );
    moment_lanes m = { none.x, none, none, none, none, { none, none, none } };
    int pinned = 0;
    for ( int slot = begin; slot < end; slot += 8 )
    {
        lane8 inverse_mass;
        add_particles( &m, load_particles( args, slot, origin, moved, &inverse_mass ) );
        const lane8m moves = lane8_lt( lane8_zero(), inverse_mass );
        pinned += __builtin_popcount( lane8m_bits( lane8m_and_not( lane8m_first( end - slot ), moves ) ) );
    }
    sums->mass = lane8d_sum_ordered( m.mass );
    sum_lanes( m.first, sums->first );
    sum_lanes( m.previous, sums->previous );
    sum_lanes( m.momentum, sums->momentum );
    sum_lanes( m.angular, sums->angular_momentum );
    for ( int k = 0; k < 3; ++k )
    {
        sum_lanes( m.mixed[k], sums->mixed[k] );
    }
    sums->pinned = (double)pinned;
}

void KERNEL( moments )( const wisp_moment_args* args, int begin, int end, wisp_moments* sums )
{
    if ( args->previous != args->position )
    {
        sum_particles( args, begin, end, true, sums );
    }
    else
    {
        sum_particles( args, begin, end, false, sums );
    }
}

void KERNEL( turn )( const wisp_turn_args* args, int begin, int end )
{
    const wisp_turn_args mine = *args;
    const lane8dv angle = lane8dv_set1( mine.angle ), centre = lane8dv_set1( mine.centre );
    for ( int slot = begin; slot < end; slot += 8 )
    {
        lane8 inverse_mass, last;
        const lane8v at = load_xyz( mine.position, slot, &inverse_mass ), old = load_xyz( mine.rows, slot, &last );
        const lane8dv change = lane8dv_cross( angle, lane8dv_sub( lane8dv_widen( at ), centre ) );
        const lane8v turned = lane8dv_narrow( lane8dv_add( lane8dv_widen( old ), change ) );
        const lane8v row = lane8v_select( lane8_lt( lane8_zero(), inverse_mass ), turned, old );
        lane8_store_xyzw_contiguous( mine.rows + (size_t)slot * 4, row.x, row.y, row.z, last );
    }
}
