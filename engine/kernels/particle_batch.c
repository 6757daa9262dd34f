// Moving particles of a block as arrays, and culling against a body. Most particles are far from most bodies, so
// culling determines the cost of bodies. The test uses the same arithmetic as the closest point, or a bound with a
// margin for rounding.
#include "kernel_isa.h"

enum
{
    LANES = 8,
};

// ---- moving particles ----

LANE_INLINE lane8m is_within( lane8v p, lane8 most )
{
    return lane8m_and( lane8m_and( lane8_le( lane8_abs( p.x ), most ), lane8_le( lane8_abs( p.y ), most ) ),
                       lane8_le( lane8_abs( p.z ), most ) );
}

LANE_INLINE void put( float* const to[3], int at, lane8v v, uint32_t bits )
{
    lane8_compress_store( to[0] + at, v.x, bits );
    lane8_compress_store( to[1] + at, v.y, bits );
    lane8_compress_store( to[2] + at, v.z, bits );
}

LANE_INLINE float min_of( lane8 v )
{
    float each[LANES], least = INFINITY;
    lane8_storeu( each, v );
    for ( int l = 0; l < LANES; ++l )
    {
        least = each[l] < least ? each[l] : least;
    }
    return least;
}

// Extends bounds by one coordinate of the moving particles: minimum of the coordinate and of its negative.
LANE_INLINE void widen( lane8m moves, lane8 now, lane8 old, lane8* lower, lane8* upper )
{
    const lane8 all = lane8_set1( INFINITY );
    *lower = lane8_min( *lower, lane8_select( moves, lane8_min( now, old ), all ) );
    *upper = lane8_min( *upper, lane8_select( moves, lane8_neg( lane8_max( now, old ) ), all ) );
}

int KERNEL( gather_particles )( const wisp_gather_args* args, int begin, int end )
{
    const lane8 most = lane8_set1( 1e9f );
    lane8 lower[3], upper[3];
    for ( int k = 0; k < 3; ++k )
    {
        lower[k] = upper[k] = lane8_set1( INFINITY );
    }
    int count = 0;
    for ( int slot = begin; slot < end; slot += LANES )
    {
        const size_t quad = (size_t)slot * 4;
        lane8v now, old;
        lane8 mass, none;
        lane8_load_xyzw_contiguous( args->position + quad, &now.x, &now.y, &now.z, &mass );
        lane8_load_xyzw_contiguous( args->previous + quad, &old.x, &old.y, &old.z, &none );
        lane8_store_xyzw_contiguous( args->search_origin + quad, now.x, now.y, now.z, lane8_set1( INFINITY ) );
        const lane8m is_finite = lane8m_and( is_within( now, most ), is_within( old, most ) );
        const lane8m moves = lane8m_and( is_finite, lane8_gt( mass, lane8_zero() ) );
        const uint32_t bits = lane8m_bits( moves );
        widen( moves, now.x, old.x, lower, upper );
        widen( moves, now.y, old.y, lower + 1, upper + 1 );
        widen( moves, now.z, old.z, lower + 2, upper + 2 );
        put( args->batch.now, count, now, bits );
        put( args->batch.old, count, old, bits );
        const lane8i slots = lane8i_add( lane8i_set1( slot ), lane8i_iota() );
        count += lane8i_compress_store( args->batch.slot + count, slots, bits );
    }
    for ( int k = 0; k < 3; ++k )
    {
        args->lower[k] = min_of( lower[k] );
        args->upper[k] = -min_of( upper[k] );
    }
    return count;
}

// ---- culling ----

// Same operations as wisp_transform_to_local(), in the same order.
LANE_INLINE lane8v to_body( wisp_transform pose, lane8v world )
{
    const lane8v v = lane8v_sub( world, lane8v_set1( pose.translation ) );
    const lane8v q = lane8v_set1( ( wisp_vec3 ){ -pose.rotation.x, -pose.rotation.y, -pose.rotation.z } );
    const lane8v t = lane8v_scale( lane8v_cross( q, v ), lane8_set1( 2.0f ) );
    return lane8v_add( lane8v_add( v, lane8v_scale( t, lane8_set1( pose.rotation.w ) ) ), lane8v_cross( q, t ) );
}

LANE_INLINE lane8v load( float* const from[3], int at )
{
    return ( lane8v ){ lane8_loadu( from[0] + at ), lane8_loadu( from[1] + at ), lane8_loadu( from[2] + at ) };
}

LANE_INLINE void store( float* const to[3], int at, lane8v v )
{
    lane8_storeu( to[0] + at, v.x );
    lane8_storeu( to[1] + at, v.y );
    lane8_storeu( to[2] + at, v.z );
}

LANE_INLINE lane8 outside( lane8 distance, float half )
{
    return lane8_max( lane8_sub( lane8_abs( distance ), lane8_set1( half ) ), lane8_zero() );
}

// Tests whether a particle is beyond reach of a sphere, or of a capsule along y, by more than the rounding error.
LANE_INLINE lane8m is_beyond_round( const wisp_cull_args* args, lane8v p, lane8 reach )
{
    const lane8 limit = lane8_add( lane8_set1( args->radius ), reach ), y = outside( p.y, args->half_length );
    const lane8 squared = lane8_add( lane8_add( lane8_mul( p.x, p.x ), lane8_mul( y, y ) ), lane8_mul( p.z, p.z ) );
    return lane8_gt( squared, lane8_mul( lane8_mul( lane8_set1( 1.00001f ), limit ), limit ) );
}

LANE_INLINE lane8m is_beyond( const wisp_cull_args* args, wisp_cull_shape bound, lane8v p, lane8 reach )
{
    if ( bound == WISP_CULL_HALF_SPACE )
    {
        return lane8_gt( p.y, reach );
    }
    const lane8v d = lane8v_sub( p, lane8v_set1( args->centre ) );
    const lane8v out = { outside( d.x, args->half.x ), outside( d.y, args->half.y ), outside( d.z, args->half.z ) };
    const lane8m beyond = lane8_gt( lane8v_length( out ), reach );
    return bound == WISP_CULL_BOX ? beyond : lane8m_or( beyond, is_beyond_round( args, p, reach ) );
}

// Culls particles. `bound` is a constant after inlining.
LANE_INLINE int cull( const wisp_cull_args* args, wisp_cull_shape bound, int count )
{
    const lane8 margin = lane8_set1( args->margin );
    int found = 0;
    for ( int i = 0; i < count; i += LANES )
    {
        const lane8v from = to_body( args->before, load( args->batch.old, i ) ),
                     to = to_body( args->after, load( args->batch.now, i ) );
        const lane8 path = lane8v_length( lane8v_sub( to, from ) ), reach = lane8_add( margin, path ),
                    clear = lane8_loadu( args->clearance + i );
        const lane8m beyond = is_beyond( args, bound, to, reach );
        store( args->from, i, from );
        store( args->to, i, to );
        lane8_storeu( args->path + i, path );
        lane8_storeu( args->reach + i, reach );
        lane8_storeu( args->clearance + i, lane8_select( beyond, lane8_min( reach, clear ), clear ) );
        const uint32_t bits = lane8m_bits( lane8m_and_not( lane8m_first( count - i ), beyond ) );
        const lane8i numbers = lane8i_add( lane8i_set1( i ), lane8i_iota() );
        found += lane8i_compress_store( args->candidates + found, numbers, bits );
    }
    return found;
}

int KERNEL( cull_particles )( const wisp_cull_args* args, int count )
{
    switch ( args->shape )
    {
        case WISP_CULL_HALF_SPACE:
            return cull( args, WISP_CULL_HALF_SPACE, count );
        case WISP_CULL_ROUND:
            return cull( args, WISP_CULL_ROUND, count );
        default:
            return cull( args, WISP_CULL_BOX, count );
    }
}

// ---- displaced particles ----

int KERNEL( find_displaced )( const float* position, const float* place, int begin, int end, int32_t* displaced )
{
    int count = 0;
    for ( int slot = begin; slot < end; slot += LANES )
    {
        lane8v p, q;
        lane8 none, most;
        lane8_load_xyzw_contiguous( position + (size_t)slot * 4, &p.x, &p.y, &p.z, &none );
        lane8_load_xyzw_contiguous( place + (size_t)slot * 4, &q.x, &q.y, &q.z, &most );
        const uint32_t bits = lane8m_bits( lane8_gt( lane8v_length( lane8v_sub( p, q ) ), most ) );
        const lane8i slots = lane8i_add( lane8i_set1( slot ), lane8i_iota() );
        count += lane8i_compress_store( displaced + count, slots, bits );
    }
    return count;
}
