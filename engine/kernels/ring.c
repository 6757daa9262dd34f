// Area vectors, volume and normals of vertices over ordered one-rings. No scatter; sums are in ring order for any
// lane width.
//
// The sum over a range consists of sums of blocks of 64 slices, in order. To get the same bits for any number of
// workers, ranges must be cut at the same multiples of 64 and added in order.
#include "kernel_isa.h"

enum
{
    BLOCK = 64, // slices summed in floats before they go into a double
};

typedef struct vertex_lanes
{
    lane8v point;
    lane8 weight;  // inverse mass
    lane8v vector; // sum of (a - p) x (b - p), m^2
    lane8 area;    // sum of their lengths, if asked for
} vertex_lanes;

LANE_INLINE lane8v load_neighbours( const wisp_ring_args* args, int entry )
{
    lane8v n;
    lane8_load_xyz( args->position, args->ring_x4[entry], &n.x, &n.y, &n.z );
    return n;
}

LANE_INLINE void add_area( vertex_lanes* v, lane8v a, lane8v b )
{
    v->area = lane8_add( v->area, lane8v_length( lane8v_cross( a, b ) ) );
}

// Two adjacent triangles of a fan share a neighbour, and
//
//   (a - p) x (b - p) + (b - p) x (c - p) = (b - p) x (c - a)
//
// so a pair of entries needs one cross product, and each neighbour is loaded once. Areas need each triangle separately.
LANE_INLINE vertex_lanes walk_ring( const wisp_ring_args* args, int slice, bool areas )
{
    const int end = args->ring_begin[slice + 1];
    int e = args->ring_begin[slice];
    vertex_lanes v = { .vector = { lane8_zero(), lane8_zero(), lane8_zero() }, .area = lane8_zero() };
    lane8_load_xyzw_contiguous( args->position + (size_t)slice * 32, &v.point.x, &v.point.y, &v.point.z, &v.weight );
    lane8v a = e < end ? load_neighbours( args, e ) : v.point;
    for ( ; e + 2 < end; e += 2 )
    {
        lane8v b = load_neighbours( args, e + 1 ), c = load_neighbours( args, e + 2 );
        lane8v to_b = lane8v_sub( b, v.point );
        v.vector = lane8v_add( v.vector, lane8v_cross( to_b, lane8v_sub( c, a ) ) );
        if ( areas )
        {
            add_area( &v, lane8v_sub( a, v.point ), to_b );
            add_area( &v, to_b, lane8v_sub( c, v.point ) );
        }
        a = c;
    }
    if ( e + 1 < end )
    {
        lane8v to_a = lane8v_sub( a, v.point ), to_b = lane8v_sub( load_neighbours( args, e + 1 ), v.point );
        v.vector = lane8v_add( v.vector, lane8v_cross( to_a, to_b ) );
        if ( areas )
        {
            add_area( &v, to_a, to_b );
        }
    }
    return v;
}

LANE_INLINE void store_area( const wisp_ring_args* args, int slice, lane8 area )
{
    lane8_storeu( args->area + (size_t)( slice - args->first_slice ) * 8,
                  lane8_mul( area, lane8_set1( 1.0f / 6.0f ) ) );
}

LANE_INLINE float* gradient_of( const wisp_ring_args* args, int slice )
{
    return args->gradient + (size_t)( slice - args->first_slice ) * 24;
}

LANE_INLINE void sum_gradients( const wisp_ring_args* args, int begin, int end, bool areas, wisp_ring_sums* sums )
{
    const lane8v origin = lane8v_set1( args->origin );
    const lane8 sixth = lane8_set1( 1.0f / 6.0f );
    *sums = ( wisp_ring_sums ){ 0.0, 0.0 };
    for ( int block = begin; block < end; block += BLOCK )
    {
        lane8 volume = lane8_zero(), weighted = lane8_zero();
        for ( int slice = block; slice < end && slice < block + BLOCK; ++slice )
        {
            vertex_lanes v = walk_ring( args, slice, areas );
            lane8v gradient = lane8v_scale( v.vector, sixth );
            lane8v_store( gradient_of( args, slice ), gradient );
            volume = lane8_add( volume, lane8v_dot( lane8v_sub( v.point, origin ), gradient ) );
            weighted = lane8_add( weighted, lane8_mul( v.weight, lane8v_dot( gradient, gradient ) ) );
            if ( areas )
            {
                store_area( args, slice, v.area );
            }
        }
        sums->volume += (double)lane8_sum_ordered( volume ) / 3.0;
        sums->weighted += (double)lane8_sum_ordered( weighted );
    }
}

void KERNEL( ring_gradient )( const wisp_ring_args* args, int begin, int end, wisp_ring_sums* sums )
{
    if ( args->area != NULL )
    {
        sum_gradients( args, begin, end, true, sums );
    }
    else
    {
        sum_gradients( args, begin, end, false, sums );
    }
}

LANE_INLINE void store_normals( const wisp_ring_args* args, int begin, int end, bool areas )
{
    for ( int slice = begin; slice < end; ++slice )
    {
        vertex_lanes v = walk_ring( args, slice, areas );
        lane8 squared = lane8v_dot( v.vector, v.vector );
        lane8m valid = lane8_ge( squared, lane8_set1( FLT_MIN ) );
        lane8 scale =
            lane8_div( lane8_set1( 1.0f ), lane8_sqrt( lane8_select( valid, squared, lane8_set1( 1.0f ) ) ) );
        lane8v_store( gradient_of( args, slice ),
                      lane8v_scale( v.vector, lane8_select( valid, scale, lane8_zero() ) ) );
        if ( areas )
        {
            store_area( args, slice, v.area );
        }
    }
}

void KERNEL( ring_normal )( const wisp_ring_args* args, int begin, int end )
{
    if ( args->area != NULL )
    {
        store_normals( args, begin, end, true );
    }
    else
    {
        store_normals( args, begin, end, false );
    }
}

// Computes the mean of unit normals, regardless of the areas. A triangle without area has no direction; padding of
// a ring is such a triangle. One with a corner that is not finite is skipped, so that it does not spread NaN.
LANE_INLINE lane8v add_face_normal( lane8v sum, lane8v across )
{
    const lane8 squared = lane8v_dot( across, across ), one = lane8_set1( 1.0f );
    const lane8m valid =
        lane8m_and( lane8_ge( squared, lane8_set1( FLT_MIN ) ), lane8_le( squared, lane8_set1( FLT_MAX ) ) );
    const lane8 scale = lane8_div( one, lane8_sqrt( lane8_select( valid, squared, one ) ) );
    const lane8v nothing = { lane8_zero(), lane8_zero(), lane8_zero() };
    return lane8v_add( sum, lane8v_select( valid, lane8v_scale( across, scale ), nothing ) );
}

void KERNEL( ring_mean_normal )( const wisp_ring_args* args, int begin, int end, float* xyzw )
{
    const lane8 one = lane8_set1( 1.0f );
    for ( int slice = begin; slice < end; ++slice )
    {
        lane8v point, sum = { lane8_zero(), lane8_zero(), lane8_zero() };
        lane8 weight;
        lane8_load_xyzw_contiguous( args->position + (size_t)slice * 32, &point.x, &point.y, &point.z, &weight );
        lane8v a = { lane8_zero(), lane8_zero(), lane8_zero() };
        for ( int e = args->ring_begin[slice]; e < args->ring_begin[slice + 1]; ++e )
        {
            const lane8v b = lane8v_sub( load_neighbours( args, e ), point );
            sum = add_face_normal( sum, lane8v_cross( a, b ) );
            a = b;
        }
        // a sum that cancels consists of rounding errors of unit vectors
        const lane8 squared = lane8v_dot( sum, sum );
        const lane8m valid = lane8_ge( squared, lane8_set1( WISP_MIN_BLEND_LENGTH * WISP_MIN_BLEND_LENGTH ) );
        const lane8 scale = lane8_div( one, lane8_sqrt( lane8_select( valid, squared, one ) ) );
        const lane8v unit = lane8v_scale( sum, lane8_select( valid, scale, lane8_zero() ) );
        lane8_store_xyzw_contiguous( xyzw + (size_t)slice * 32, unit.x, unit.y, unit.z, lane8_zero() );
    }
}

void KERNEL( push )( const wisp_push_args* args, int begin, int end )
{
    const lane8 factor = lane8_set1( args->factor );
    for ( int slice = begin; slice < end; ++slice )
    {
        float* xyzw = args->position + (size_t)slice * 32;
        lane8v p;
        lane8 w;
        lane8_load_xyzw_contiguous( xyzw, &p.x, &p.y, &p.z, &w );
        lane8v result =
            lane8v_mul_add( p, lane8_mul( w, factor ), lane8v_load( args->gradient + (size_t)slice * 24 ) );
        lane8_store_xyzw_contiguous( xyzw, result.x, result.y, result.z, w );
    }
}
