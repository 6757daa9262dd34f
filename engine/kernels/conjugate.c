// Vectors of filtered conjugate gradients (Baraff and Witkin 1998; Noh and Jung, section 4). Sums over a range are
// sums of blocks of 64 slices, in order. Ranges cut at the same places and added in order give the same bits for
// any number of workers.
#include "kernel_isa.h"

enum
{
    BLOCK = 64, // slices summed in floats before they go into a double
};

LANE_INLINE lane8v multiply( const float matrix[6][8], lane8v v )
{
    const lane8 xx = lane8_load( matrix[0] ), xy = lane8_load( matrix[1] ), xz = lane8_load( matrix[2] );
    const lane8 yy = lane8_load( matrix[3] ), yz = lane8_load( matrix[4] ), zz = lane8_load( matrix[5] );
    return ( lane8v ){
        lane8_mul_add( xz, v.z, lane8_mul_add( xy, v.y, lane8_mul( xx, v.x ) ) ),
        lane8_mul_add( yz, v.z, lane8_mul_add( yy, v.y, lane8_mul( xy, v.x ) ) ),
        lane8_mul_add( zz, v.z, lane8_mul_add( yz, v.y, lane8_mul( xz, v.x ) ) ),
    };
}

double KERNEL( conjugate_advance )( const wisp_conjugate_args* args, float step, int begin, int end )
{
    const lane8 a = lane8_set1( step );
    double sum = 0.0;
    for ( int block = begin; block < end; block += BLOCK )
    {
        lane8 dot = lane8_zero();
        for ( int slice = block; slice < end && slice < block + BLOCK; ++slice )
        {
            const lane8v q = lane8v_scale( lane8v_load( args->product[slice][0] ), a );
            lane8v r = lane8v_sub( lane8v_load( args->residual[slice][0] ), q );
            lane8v_store( args->residual[slice][0], r );
            const bool filtered = args->filtered[slice] != 0;
            r = filtered ? multiply( args->filter[slice], r ) : r;
            lane8v s = multiply( args->inverse[slice], r );
            s = filtered ? multiply( args->filter[slice], s ) : s;
            lane8v_store( args->search[slice][0], s );
            dot = lane8_add( dot, lane8v_dot( r, s ) );
        }
        sum += (double)lane8_sum_ordered( dot );
    }
    return sum;
}

// Updates the solution in this loop, where the direction is in registers: large cloths are bound by memory.
void KERNEL( conjugate_update )( const wisp_conjugate_args* args, float step, float fraction, int begin, int end )
{
    const lane8 a = lane8_set1( step ), b = lane8_set1( fraction );
    for ( int slice = begin; slice < end; ++slice )
    {
        float* xyzw = args->direction + (size_t)slice * 32;
        lane8v c;
        lane8 mass;
        lane8_load_xyzw_contiguous( xyzw, &c.x, &c.y, &c.z, &mass );
        lane8v_store( args->solution[slice][0], lane8v_mul_add( lane8v_load( args->solution[slice][0] ), a, c ) );
        c = lane8v_mul_add( lane8v_load( args->search[slice][0] ), b, c );
        lane8_store_xyzw_contiguous( xyzw, c.x, c.y, c.z, mass );
    }
}
