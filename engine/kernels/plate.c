// Bending of thin plates as a matrix over vertices, eight rows at a time (wisp/module/plate.h), and the stages of an implicit
// step with it.
#include "kernel_isa.h"

// Computes Q x of a slice. Rows sum to zero, so it is a sum of differences, which float keeps far from the origin.
LANE_INLINE lane8v multiply( const wisp_plate_rows* rows, const float* xyzw, int slice, lane8v own )
{
    lane8v sum = { lane8_zero(), lane8_zero(), lane8_zero() };
    for ( int entry = rows->begin[slice]; entry < rows->begin[slice + 1]; ++entry )
    {
        lane8v other;
        lane8_load_xyz( xyzw, rows->other_x4[entry], &other.x, &other.y, &other.z );
        sum = lane8v_mul_add( sum, lane8_loadu( rows->weight[entry] ), lane8v_sub( own, other ) );
    }
    return sum;
}

void KERNEL( plate_impulse )( const wisp_plate_args* args, int begin, int end )
{
    const wisp_plate_args mine = *args;
    const lane8 rate = lane8_set1( -mine.rate );
    for ( int slice = begin; slice < end; ++slice )
    {
        lane8v own;
        lane8 weight;
        lane8_load_xyzw_contiguous( mine.position + (size_t)slice * 32, &own.x, &own.y, &own.z, &weight );
        const lane8v b = lane8v_scale( multiply( &mine.rows, mine.position, slice, own ), rate );
        lane8_store_xyzw_contiguous( mine.impulse + (size_t)slice * 32, b.x, b.y, b.z, lane8_zero() );
    }
}

void KERNEL( plate_stage )( const wisp_plate_args* args, int begin, int end )
{
    const wisp_plate_args mine = *args;
    const lane8 rate = lane8_set1( -mine.rate ), momentum = lane8_set1( mine.momentum );
    const lane8 gain = lane8_set1( mine.gain );
    for ( int slice = begin; slice < end; ++slice )
    {
        const size_t row = (size_t)slice * 32;
        lane8v place, b, newer, older;
        lane8 weight, unused;
        lane8_load_xyzw_contiguous( mine.position + row, &place.x, &place.y, &place.z, &weight );
        lane8_load_xyzw_contiguous( mine.impulse + row, &b.x, &b.y, &b.z, &unused );
        lane8_load_xyzw_contiguous( mine.newer + row, &newer.x, &newer.y, &newer.z, &unused );
        lane8_load_xyzw_contiguous( mine.older + row, &older.x, &older.y, &older.z, &unused );
        b = lane8v_mul_add( b, rate, multiply( &mine.rows, mine.newer, slice, newer ) );
        lane8v y = lane8v_mul_add( newer, momentum, lane8v_sub( newer, older ) );
        y = lane8v_mul_add( y, lane8_mul( gain, weight ), b );
        lane8_store_xyzw_contiguous( mine.older + row, y.x, y.y, y.z, lane8_zero() );
    }
}
