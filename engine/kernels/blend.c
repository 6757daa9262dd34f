// Weighted points between parents (boundary particle paper, sections 2.2, 3.4 and 5). Eight points are four
// registers of two xyzw rows; register r holds points r and r + 4. Parents are loaded and stored as whole rows, so
// only lengths of normals are transposed.
#include "kernel_isa.h"

enum
{
    MAX_PARENTS = 3,
};

LANE_INLINE void load_parents( const float* xyzw, const int32_t ( *parents )[4], int parent, lane8 rows[4] )
{
    const int32_t index[8] = { parents[0][parent], parents[1][parent], parents[2][parent], parents[3][parent],
                               parents[4][parent], parents[5][parent], parents[6][parent], parents[7][parent] };
    lane8_load_quads( xyzw, index, rows );
}

// Loads the first `count` weights of eight points, each repeated four times.
LANE_INLINE void load_weights( const float ( *weights )[4], int count, lane8 spread[MAX_PARENTS][4] )
{
    lane8 rows[4];
    lane8_load_quads( weights[0], lane_quad_iota, rows );
    for ( int r = 0; r < 4; ++r )
    {
        spread[0][r] = lane8_spread_first( rows[r] );
        spread[1][r] = lane8_spread_second( rows[r] );
        if ( count > 2 )
        {
            spread[2][r] = lane8_spread_third( rows[r] );
        }
    }
}

LANE_INLINE void sum_parents( const float* xyzw, const int32_t ( *parents )[4], int count,
                              lane8 weights[MAX_PARENTS][4], lane8 sum[4] )
{
    lane8 rows[4];
    load_parents( xyzw, parents, 0, rows );
    for ( int r = 0; r < 4; ++r )
    {
        sum[r] = lane8_mul( weights[0][r], rows[r] );
    }
    for ( int k = 1; k < count; ++k )
    {
        load_parents( xyzw, parents, k, rows );
        for ( int r = 0; r < 4; ++r )
        {
            sum[r] = lane8_mul_add( weights[k][r], rows[r], sum[r] );
        }
    }
}

// Keeps the old normal and marks it where the new one cancels, for a caller that knows the triangles. This is rare,
// so it goes through memory.
static void keep_normals( float* out, const float* before, uint32_t invalid )
{
    for ( int l = 0; l < 8; ++l )
    {
        if ( ( invalid >> l & 1u ) != 0 )
        {
            memcpy( out + 4 * l, before + 4 * l, 3 * sizeof( float ) );
            out[4 * l + 3] = 1.0f;
        }
    }
}

LANE_INLINE int store_normals( float* out, const lane8 sum[4] )
{
    lane8 lanes[4] = { sum[0], sum[1], sum[2], sum[3] }, scales[4], unit[4];
    lane8_transpose_quads( lanes );
    const lane8v normal = { lanes[0], lanes[1], lanes[2] };
    const lane8 squared = lane8v_dot( normal, normal ), one = lane8_set1( 1.0f );
    const lane8m valid = lane8_ge( squared, lane8_set1( WISP_MIN_BLEND_LENGTH * WISP_MIN_BLEND_LENGTH ) );
    lane8_spread_xyz( lane8_div( one, lane8_sqrt( lane8_select( valid, squared, one ) ) ), scales );
    for ( int r = 0; r < 4; ++r )
    {
        unit[r] = lane8_mul( sum[r], scales[r] );
    }
    if ( lane8m_all( valid ) )
    {
        lane8_store_quads( out, lane_quad_iota, unit );
        return 0;
    }
    float before[32];
    memcpy( before, out, sizeof( before ) );
    lane8_store_quads( out, lane_quad_iota, unit );
    const uint32_t invalid = ~lane8m_bits( valid ) & 0xffu;
    keep_normals( out, before, invalid );
    return __builtin_popcount( invalid );
}

LANE_INLINE int blend( const wisp_blend_args* args, int begin, int end, int parent_count )
{
    const lane8i corner = lane8i_and( lane8i_iota(), lane8i_set1( 3 ) );
    const lane8m xyz = lane8i_lt( corner, lane8i_set1( 3 ) );
    int invalid = 0;
    for ( int p = begin; p < end; p += 8 )
    {
        lane8 weights[MAX_PARENTS][4], sum[4], own[4];
        float* out = args->xyzw + (size_t)p * 4;
        load_weights( args->weights + p, parent_count, weights );
        sum_parents( args->position, args->parents + p, parent_count, weights, sum );
        lane8_load_quads( out, lane_quad_iota, own );
        for ( int r = 0; r < 4; ++r )
        {
            own[r] = lane8_select( xyz, sum[r], own[r] );
        }
        lane8_store_quads( out, lane_quad_iota, own );
        if ( args->normal == NULL )
        {
            continue;
        }
        sum_parents( args->normal, args->parents + p, parent_count, weights, sum );
        invalid += store_normals( args->normals + (size_t)p * 4, sum );
    }
    return invalid;
}

int KERNEL( blend_two )( const wisp_blend_args* args, int begin, int end )
{
    return blend( args, begin, end, 2 );
}

int KERNEL( blend_three )( const wisp_blend_args* args, int begin, int end )
{
    return blend( args, begin, end, 3 );
}
