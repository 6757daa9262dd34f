// Area vectors, volume and normals of vertices over ordered one-rings, and the drag of air at rest on these vectors.
// No scatter; sums are in ring order for any lane width.
//
// The sum over a range consists of sums of blocks of 64 slices, in order. To get the same bits for any number of
// workers, ranges must be cut at the same multiples of 64 and added in order.
#include "kernel_isa.h"

#include "lane_double_vec.h"

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

// Limits an explicit step so that drag never reverses a velocity.
LANE_INLINE lane8v force_on( const wisp_vertex_drag_args* args, int slot, lane8v velocity, lane8 dt_w )
{
    const lane8 zero = lane8_zero(), one = lane8_set1( 1.0f );
    const lane8v vector = lane8v_load( args->vectors + (size_t)slot * 3 ), nothing = { zero, zero, zero };
    const lane8 area = lane8_loadu( args->areas + slot );
    const lane8 speed = lane8v_length( velocity ), size = lane8v_length( vector );
    // at rest, or a normal that cancels
    const lane8m large =
        lane8m_and( lane8_ge( size, lane8_mul( lane8_set1( 1e-12f ), area ) ), lane8_gt( size, zero ) );
    const lane8m acts = lane8m_and( lane8_gt( speed, zero ), large );
    const lane8 along = lane8_div( lane8v_dot( velocity, vector ), lane8_mul( speed, size ) );
    const lane8 c = lane8_mul( lane8_mul( lane8_set1( args->half_density_drag ), area ), lane8_max( along, zero ) );
    const lane8 flow = lane8_mul( c, speed ), limit = lane8_add( one, lane8_mul( flow, dt_w ) );
    return lane8v_select( acts, lane8v_scale( velocity, lane8_neg( lane8_div( flow, limit ) ) ), nothing );
}

LANE_INLINE lane8v load_velocity( const wisp_vertex_drag_args* args, int slot, lane8* last )
{
    lane8v v;
    lane8_load_xyzw_contiguous( args->velocity + (size_t)slot * 4, &v.x, &v.y, &v.z, last );
    return v;
}

LANE_INLINE lane8 load_dt_w( const wisp_vertex_drag_args* args, int slot )
{
    lane8v at;
    lane8 w;
    lane8_load_xyzw_contiguous( args->position + (size_t)slot * 4, &at.x, &at.y, &at.z, &w );
    return lane8_mul( lane8_set1( args->dt ), w );
}

void KERNEL( vertex_drag )( const wisp_vertex_drag_args* args, int begin, int end )
{
    const wisp_vertex_drag_args mine = *args;
    for ( int slot = begin; slot < end; slot += 8 )
    {
        lane8 last;
        const lane8v v = load_velocity( &mine, slot, &last );
        const lane8 dt_w = load_dt_w( &mine, slot );
        const lane8v next = lane8v_mul_add( v, dt_w, force_on( &mine, slot, v, dt_w ) );
        lane8_store_xyzw_contiguous( mine.velocity + (size_t)slot * 4, next.x, next.y, next.z, last );
    }
}

void KERNEL( sum_vertex_drag )( const wisp_vertex_drag_args* args, int begin, int end, double sum[3] )
{
    const wisp_vertex_drag_args mine = *args;
    lane8dv total = lane8dv_set1( ( double[3] ){ 0.0, 0.0, 0.0 } );
    for ( int slot = begin; slot < end; slot += 8 )
    {
        lane8 last;
        const lane8v v = load_velocity( &mine, slot, &last );
        total = lane8dv_add( total, lane8dv_widen( force_on( &mine, slot, v, load_dt_w( &mine, slot ) ) ) );
    }
    sum[0] = lane8d_sum_ordered( total.x );
    sum[1] = lane8d_sum_ordered( total.y );
    sum[2] = lane8d_sum_ordered( total.z );
}
