// Test whether sample counts are still valid, in floats with bounds that allow for rounding. The caller measures
// elements that fail again in double precision.
#include "kernel_isa.h"

// Rounding of a cross product, relative to |a| |b|, and of a height, relative to the side that it is computed from.
static const float CROSS_ROUNDING = 2e-6f;
// Factor by which the base must be shorter to be certainly the shortest: three times the rounding of a squared
// length.
static const float SHORTER = 1.0f + 2e-6f;

LANE_INLINE lane8 spacing_of( const wisp_extent_args* args, int slice )
{
    return args->element_spacing != NULL ? lane8_loadu( args->element_spacing + (size_t)slice * 8 )
                                         : lane8_set1( args->spacing );
}

LANE_INLINE lane8v load_points( const float* xyzw, const int32_t* index )
{
    lane8v p;
    lane8_load_xyz( xyzw, index, &p.x, &p.y, &p.z );
    return p;
}

// Tests whether a squared length is at least FLT_MIN; below, it has lost digits.
LANE_INLINE lane8m is_measured( lane8 squared )
{
    return lane8_ge( squared, lane8_set1( FLT_MIN ) );
}

LANE_INLINE lane8m is_between( const float* lower, const float* upper, int slice, lane8 least, lane8 most )
{
    return lane8m_and( lane8_ge( least, lane8_loadu( lower + (size_t)slice * 8 ) ),
                       lane8_le( most, lane8_loadu( upper + (size_t)slice * 8 ) ) );
}

void KERNEL( check_edge_extents )( const wisp_extent_args* args, int begin, int end )
{
    for ( int slice = begin; slice < end; ++slice )
    {
        const lane8v a = load_points( args->position, args->pair_x4[slice][0] );
        const lane8v along = lane8v_sub( load_points( args->position, args->pair_x4[slice][1] ), a );
        const lane8 squared = lane8v_dot( along, along );
        const lane8 ratio = lane8_div( lane8_sqrt( squared ), spacing_of( args, slice ) );
        const lane8m held = is_between( args->lower, args->upper, slice, ratio, ratio );
        args->unchanged[slice] = (uint8_t)lane8m_bits( lane8m_and( held, is_measured( squared ) ) );
    }
}

void KERNEL( check_triangle_extents )( const wisp_extent_args* args, int begin, int end )
{
    const lane8 rounding = lane8_set1( CROSS_ROUNDING );
    for ( int slice = begin; slice < end; ++slice )
    {
        const lane8v a = load_points( args->position, args->corner_x4[slice][0] );
        const lane8v b = load_points( args->position, args->corner_x4[slice][1] );
        const lane8v c = load_points( args->position, args->corner_x4[slice][2] );
        const lane8v ab = lane8v_sub( b, a ), ac = lane8v_sub( c, a ), bc = lane8v_sub( c, b );
        const lane8 base2 = lane8v_dot( ab, ab ), left2 = lane8v_dot( ac, ac );
        const lane8 least = lane8_mul( base2, lane8_set1( SHORTER ) );
        const lane8m shortest = lane8m_and( lane8_lt( least, left2 ), lane8_lt( least, lane8v_dot( bc, bc ) ) );

        const lane8 spacing = spacing_of( args, slice ), base = lane8_sqrt( base2 );
        const lane8v across = lane8v_cross( ab, ac );
        const lane8 area2 = lane8v_dot( across, across );
        const lane8 height = lane8_div( lane8_sqrt( area2 ), lane8_mul( base, spacing ) );
        const lane8 slack = lane8_div( lane8_mul( rounding, lane8_sqrt( left2 ) ), spacing );
        const lane8 ratio = lane8_div( base, spacing );
        const lane8m base_held = is_between( args->lower, args->upper, slice, ratio, ratio );
        const lane8m height_held = is_between( args->lower_height, args->upper_height, slice,
                                               lane8_sub( height, slack ), lane8_add( height, slack ) );
        const lane8m held = lane8m_and( lane8m_and( base_held, height_held ), shortest );
        args->unchanged[slice] = (uint8_t)lane8m_bits( lane8m_and( held, is_measured( area2 ) ) );
    }
}
