// Moving particles of a block as arrays, and culling against a body. Most particles are far from most bodies, so
// culling determines the cost of bodies. The test uses the same arithmetic as the closest point, or a bound with a
// margin for rounding. Slots are taken in groups of eight, and a group that no body can reach for the rest of a step
// is left out altogether until one of its particles leaves the radius in which that is known.
#include "pose.h"

enum
{
    LANES = 8,
};

// ---- groups of slots ----

// Marks the fourth number of two rows.
LANE_INLINE lane8m fourth( void )
{
    return lane8i_eq( lane8i_and( lane8i_iota(), lane8i_set1( 3 ) ), lane8i_set1( 3 ) );
}

// All eight slots are settled or none is, so their order does not matter.
uint32_t KERNEL( find_unclear )( const float* position, const float* previous, const float* place, int begin,
                                 int end )
{
    const lane8m last = fourth();
    const lane8 zero = lane8_zero();
    uint32_t groups = 0;
    for ( int slot = begin; slot < end; slot += LANES )
    {
        const uint32_t group = 1u << ( slot - begin ) / LANES;
        if ( !( place[(size_t)slot * 4 + 3] < 0.0f ) )
        {
            groups |= group;
            continue;
        }
        lane8 q[4];
        for ( int i = 0; i < 4; ++i )
        {
            const size_t at = (size_t)slot * 4 + (size_t)i * LANES;
            const lane8 origin = lane8_loadu( place + at );
            const lane8 now = lane8_abs( lane8_sub( lane8_loadu( position + at ), origin ) ),
                        old = lane8_abs( lane8_sub( lane8_loadu( previous + at ), origin ) );
            // a comparison would lose a NaN
            const lane8 nothing = lane8_mul( lane8_add( now, old ), zero );
            q[i] = lane8_select( last, origin, lane8_add( lane8_max( now, old ), nothing ) );
        }
        lane8_transpose_quads( q );
        const lane8 squared =
            lane8_add( lane8_add( lane8_mul( q[0], q[0] ), lane8_mul( q[1], q[1] ) ), lane8_mul( q[2], q[2] ) );
        const lane8m settled = lane8m_and( lane8_lt( q[3], zero ), lane8_lt( squared, lane8_mul( q[3], q[3] ) ) );
        groups |= lane8m_all( settled ) ? 0u : group;
    }
    return groups;
}

// ---- moving particles ----

LANE_INLINE lane8m is_within( lane8v p, lane8 most )
{
    return lane8m_and( lane8m_and( lane8_le( lane8_abs( p.x ), most ), lane8_le( lane8_abs( p.y ), most ) ),
                       lane8_le( lane8_abs( p.z ), most ) );
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

LANE_INLINE void store( float* const to[3], int at, lane8v v )
{
    lane8_storeu( to[0] + at, v.x );
    lane8_storeu( to[1] + at, v.y );
    lane8_storeu( to[2] + at, v.z );
}

// Reads eight rows, and writes them as the place where they were found.
LANE_INLINE void load_rows( const wisp_gather_args* args, size_t quad, lane8v* now, lane8* mass )
{
    const lane8m last = fourth();
    lane8 q[4], place[4];
    lane8_load_quads( args->position + quad, lane_quad_iota, q );
    for ( int i = 0; i < 4; ++i )
    {
        place[i] = lane8_select( last, lane8_set1( INFINITY ), q[i] );
    }
    lane8_store_quads( args->search_origin + quad, lane_quad_iota, place );
    lane8_transpose_quads( q );
    *now = ( lane8v ){ q[0], q[1], q[2] };
    *mass = q[3];
}

int KERNEL( gather_particles )( const wisp_gather_args* args, int begin, int end )
{
    const lane8 most = lane8_set1( 1e9f ), zero = lane8_zero();
    lane8 lower[3], upper[3];
    for ( int k = 0; k < 3; ++k )
    {
        lower[k] = upper[k] = lane8_set1( INFINITY );
    }
    int count = 0;
    uint32_t any = 0;
    for ( int slot = begin; slot < end; slot += LANES )
    {
        if ( ( args->groups >> ( slot - begin ) / LANES & 1u ) == 0 )
        {
            continue;
        }
        const size_t quad = (size_t)slot * 4;
        lane8v now, old;
        lane8 mass, none;
        load_rows( args, quad, &now, &mass );
        lane8_load_xyzw_contiguous( args->previous + quad, &old.x, &old.y, &old.z, &none );
        const lane8m is_finite = lane8m_and( is_within( now, most ), is_within( old, most ) );
        const lane8m moves = lane8m_and( is_finite, lane8_gt( mass, zero ) );
        widen( moves, now.x, old.x, lower, upper );
        widen( moves, now.y, old.y, lower + 1, upper + 1 );
        widen( moves, now.z, old.z, lower + 2, upper + 2 );
        store( args->batch.now, count, now );
        store( args->batch.old, count, old );
        const int group = count / LANES;
        args->batch.slot[group] = slot;
        args->batch.moving[group] = (uint8_t)lane8m_bits( moves );
        args->batch.pinned[group] = (uint8_t)lane8m_bits( lane8m_and( is_finite, lane8_eq( mass, zero ) ) );
        any |= lane8m_bits( moves );
        count += LANES;
    }
    for ( int k = 0; k < 3; ++k )
    {
        args->lower[k] = min_of( lower[k] );
        args->upper[k] = -min_of( upper[k] );
    }
    return any != 0 ? count : 0;
}

void KERNEL( bound_paths )( const float* position, const float* previous, int begin, int end, float* lower,
                            float* upper )
{
    lane8 low[3], high[3];
    for ( int k = 0; k < 3; ++k )
    {
        low[k] = high[k] = lane8_set1( INFINITY );
    }
    for ( int slot = begin; slot < end; slot += LANES )
    {
        lane8v now, old;
        lane8 mass, none;
        lane8_load_xyzw_contiguous( position + (size_t)slot * 4, &now.x, &now.y, &now.z, &mass );
        lane8_load_xyzw_contiguous( previous + (size_t)slot * 4, &old.x, &old.y, &old.z, &none );
        const lane8m moves = lane8_gt( mass, lane8_zero() );
        widen( moves, now.x, old.x, low, high );
        widen( moves, now.y, old.y, low + 1, high + 1 );
        widen( moves, now.z, old.z, low + 2, high + 2 );
    }
    for ( int k = 0; k < 3; ++k )
    {
        lower[k] = min_of( low[k] );
        upper[k] = -min_of( high[k] );
    }
}

void KERNEL( instances_bound_paths )( const wisp_instances_args* args, float* lower, float* upper )
{
    enum
    {
        WIDTH = WISP_INSTANCE_LANES,
    };
    for ( int k = 0; k < 3 * WIDTH; k += WIDTH )
    {
        const lane16 all = lane16_set1( INFINITY );
        lane16 low = all, high = all;
        for ( int slot = 0; slot < args->slot_count; ++slot )
        {
            const float* row = args->position + (size_t)slot * 4 * WIDTH;
            const lane16 now = lane16_load( row + k ),
                         old = lane16_load( args->previous + (size_t)slot * 3 * WIDTH + k );
            const lane16m moves = lane16_gt( lane16_load( row + 3 * WIDTH ), lane16_zero() );
            low = lane16_min( low, lane16_select( moves, lane16_min( now, old ), all ) );
            high = lane16_min( high, lane16_select( moves, lane16_neg( lane16_max( now, old ) ), all ) );
        }
        lane16_storeu( lower + k, low );
        lane16_storeu( upper + k, lane16_neg( high ) );
    }
}

// ---- culling ----

LANE_INLINE lane8 outside( lane8 distance, float half )
{
    return lane8_max( lane8_sub( lane8_abs( distance ), lane8_set1( half ) ), lane8_zero() );
}

// A lower bound of the distance, and whether it is beyond reach by more than the rounding error.
typedef struct separation
{
    lane8 distance;
    lane8m beyond;
} separation;

// Of a sphere, or of a capsule along y. The square is compared, so the root is only for those who need a distance.
LANE_INLINE separation apart_round( const wisp_cull_args* args, lane8v p, lane8 reach )
{
    const lane8 radius = lane8_set1( args->radius ), limit = lane8_add( radius, reach ),
                y = outside( p.y, args->half_length );
    const lane8 squared = lane8_add( lane8_add( lane8_mul( p.x, p.x ), lane8_mul( y, y ) ), lane8_mul( p.z, p.z ) );
    return ( separation ){
        lane8_sub( lane8_sqrt( squared ), radius ),
        lane8_gt( squared, lane8_mul( lane8_mul( lane8_set1( 1.00001f ), limit ), limit ) ),
    };
}

LANE_INLINE separation apart_from( const wisp_cull_args* args, wisp_cull_shape bound, lane8v p, lane8 reach )
{
    if ( bound == WISP_CULL_HALF_SPACE )
    {
        const lane8 above = lane8_sub( p.y, lane8_set1( args->centre.y ) );
        return ( separation ){ above, lane8_gt( above, reach ) };
    }
    if ( bound == WISP_CULL_ROUND )
    {
        return apart_round( args, p, reach );
    }
    const lane8v d = lane8v_sub( p, lane8v_set1( args->centre ) );
    const lane8v out = { outside( d.x, args->half.x ), outside( d.y, args->half.y ), outside( d.z, args->half.z ) };
    const lane8 distance = lane8v_length( out );
    const lane8m beyond = lane8_gt( distance, reach );
    if ( bound == WISP_CULL_BOX )
    {
        return ( separation ){ distance, beyond };
    }
    // most of a mesh that is about as long as it is wide lies well within the corners of its box
    const lane8 radius = lane8_set1( args->radius ), limit = lane8_add( radius, reach ), squared = lane8v_dot( d, d );
    const lane8m outside_ball = lane8_gt( squared, lane8_mul( lane8_mul( lane8_set1( 1.00001f ), limit ), limit ) );
    return ( separation ){ lane8_max( distance, lane8_sub( lane8_sqrt( squared ), radius ) ),
                           lane8m_or( beyond, outside_ball ) };
}

// Computes a radius e within which a particle may move for the rest of the step without being found by the body:
// for any two points a and b that are no more than e from here,
//
//   distance of b in any pose > margin + |a - b| + motion of the body
//
// The body moves by no more than `motion` here, and changes the distance by no more than that.
LANE_INLINE lane8 free_radius( const wisp_cull_args* args, lane8v world, lane8v local, lane8 distance )
{
    const lane8 length = lane8v_length( local );
    const lane8 shift = lane8_set1( args->shift );
    const lane8 arm = lane8_add( lane8_add( length, length ), lane8_add( lane8_abs( distance ), shift ) );
    const lane8 motion = lane8_add( shift, lane8_mul( lane8_set1( args->turn ), arm ) );
    const lane8 sum = lane8_add( lane8_add( lane8_abs( world.x ), lane8_abs( world.y ) ), lane8_abs( world.z ) );
    const lane8 rounding = lane8_mul( lane8_set1( 1e-5f ), lane8_add( lane8_add( sum, length ), length ) );
    const lane8 spare = lane8_sub( lane8_sub( distance, lane8_add( motion, motion ) ),
                                   lane8_add( lane8_set1( args->margin ), rounding ) );
    return lane8_mul( spare, lane8_set1( 0.33f ) );
}

// Culls particles. `bound` is a constant after inlining.
LANE_INLINE int cull( const wisp_cull_args* args, wisp_cull_shape bound, int count )
{
    const lane8 margin = lane8_set1( args->margin );
    const bool was_turned = pose_is_turned( args->before.rotation ),
               is_turned = pose_is_turned( args->after.rotation );
    int found = 0;
    for ( int i = 0; i < count; i += LANES )
    {
        const lane8v now = load_three( (const float* const*)args->batch.now, i );
        const lane8v from = pose_to_local( args->before, was_turned,
                                           load_three( (const float*const*)args->batch.old, i ) ),
                     to = pose_to_local( args->after, is_turned, now );
        const lane8 path = lane8v_length( lane8v_sub( to, from ) ), reach = lane8_add( margin, path ),
                    clear = lane8_loadu( args->clearance + i );
        const separation apart = apart_from( args, bound, to, reach );
        lane8_storeu( args->clearance + i, lane8_select( apart.beyond, lane8_min( reach, clear ), clear ) );
        if ( args->free_radius != NULL )
        {
            const lane8 all = free_radius( args, now, to, apart.distance ),
                        least = lane8_loadu( args->free_radius + i );
            const lane8 radius = lane8_select( apart.beyond, all, lane8_set1( -1.0f ) );
            lane8_storeu( args->free_radius + i, lane8_min( radius, least ) );
        }
        const uint32_t bits = ~lane8m_bits( apart.beyond ) & args->batch.moving[i / LANES];
        if ( bits != 0 )
        {
            pack_three( args->from, found, from, bits );
            pack_three( args->to, found, to, bits );
            pack_lanes( args->path + found, path, bits );
            pack_lanes( args->reach + found, reach, bits );
            const lane8i numbers = lane8i_add( lane8i_set1( i ), lane8i_iota() );
            found += lane8i_compress_store( args->candidates + found, numbers, bits );
        }
    }
    return found;
}

int KERNEL( cull_particles )( const wisp_cull_args* args, int count )
{
    const wisp_cull_args mine = *args;
    switch ( mine.shape )
    {
        case WISP_CULL_HALF_SPACE:
            return cull( &mine, WISP_CULL_HALF_SPACE, count );
        case WISP_CULL_ROUND:
            return cull( &mine, WISP_CULL_ROUND, count );
        case WISP_CULL_BOX_AND_BALL:
            return cull( &mine, WISP_CULL_BOX_AND_BALL, count );
        default:
            return cull( &mine, WISP_CULL_BOX, count );
    }
}

// ---- after culling ----

int KERNEL( find_displaced )( const float* position, const float* place, int begin, int end, int32_t* displaced )
{
    const lane8m last = fourth();
    int count = 0;
    for ( int slot = begin; slot < end; slot += LANES )
    {
        lane8 q[4], origin[4];
        lane8_load_quads( position + (size_t)slot * 4, lane_quad_iota, q );
        lane8_load_quads( place + (size_t)slot * 4, lane_quad_iota, origin );
        for ( int i = 0; i < 4; ++i )
        {
            q[i] = lane8_select( last, origin[i], lane8_sub( q[i], origin[i] ) );
        }
        lane8_transpose_quads( q );
        const lane8 length = lane8v_length( ( lane8v ){ q[0], q[1], q[2] } );
        const uint32_t bits = lane8m_bits( lane8_gt( length, lane8_abs( q[3] ) ) );
        if ( bits != 0 )
        {
            const lane8i slots = lane8i_add( lane8i_set1( slot ), lane8i_iota() );
            count += lane8i_compress_store( displaced + count, slots, bits );
        }
    }
    return count;
}

int KERNEL( list_counts )( const int32_t* counts, int count, int32_t* single, int32_t* several, int* several_count )
{
    int one = 0, more = 0;
    for ( int i = 0; i < count; i += LANES )
    {
        const lane8i n = lane8i_loadu( counts + i ), numbers = lane8i_add( lane8i_set1( i ), lane8i_iota() );
        const lane8m valid = lane8m_first( count - i );
        const uint32_t any = lane8m_bits( lane8m_and( valid, lane8i_lt( lane8i_set1( 0 ), n ) ) );
        if ( any != 0 )
        {
            const uint32_t only = lane8m_bits( lane8i_eq( n, lane8i_set1( 1 ) ) ) & any;
            one += lane8i_compress_store( single + one, numbers, only );
            more += lane8i_compress_store( several + more, numbers, any & ~only );
        }
    }
    *several_count = more;
    return one;
}
