// Bending of thin plates as a matrix over vertices, eight rows at a time (wisp/module/plate.h), and the stages of an implicit
// step with it.
#include "kernel_isa.h"

// Negative where a row of two particles has a weight.
static const int32_t WEIGHTS_OF_ROW[8] = { 0, 0, 0, -1, 0, 0, 0, -1 };

// Computes Q x of a slice. Rows sum to zero, so it is a sum of differences, which float keeps far from the origin.
LANE_INLINE lane8v multiply_rows( const wisp_plate_rows* rows, const float* xyzw, int slice, lane8v own,
                                  bool is_near )
{
    lane8v sum = { lane8_zero(), lane8_zero(), lane8_zero() };
    const float* first = is_near ? xyzw + (size_t)slice * 32 : xyzw;
    for ( int entry = rows->begin[slice]; entry < rows->begin[slice + 1]; ++entry )
    {
        lane8v other;
        int32_t at_x4[8];
        for ( int lane = 0; lane < 8; ++lane )
        {
            at_x4[lane] = is_near ? rows->near_x4[entry][lane] : rows->other_x4[entry][lane];
        }
        lane8_load_xyz( first, at_x4, &other.x, &other.y, &other.z );
        sum = lane8v_mul_add( sum, lane8_loadu( rows->weight[entry] ), lane8v_sub( own, other ) );
    }
    return sum;
}

LANE_INLINE lane8v multiply( const wisp_plate_rows* rows, const float* xyzw, int slice, lane8v own )
{
    return rows->near_x4 != NULL ? multiply_rows( rows, xyzw, slice, own, true )
                                 : multiply_rows( rows, xyzw, slice, own, false );
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

void KERNEL( plate_begin )( const wisp_plate_args* args, int begin, int end )
{
    const wisp_plate_args mine = *args;
    const lane8 gain = lane8_set1( mine.gain );
    for ( int i = 32 * begin; i < 32 * end; i += 8 )
    {
        const lane8 weight = lane8_mul( gain, lane8_spread_last( lane8_loadu( mine.position + i ) ) );
        lane8_storeu( mine.newer + i, lane8_mul( weight, lane8_loadu( mine.impulse + i ) ) );
        lane8_storeu( mine.older + i, lane8_zero() );
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

// ---- before and after the stages ----

// As the passes that follow predict it: pinned particles stay, or go to their targets.
void KERNEL( plate_predict )( const wisp_plate_move_args* args, int begin, int end )
{
    const wisp_plate_move_args mine = *args;
    const float h = mine.dt, fall[3] = { h * mine.gravity.x, h * mine.gravity.y, h * mine.gravity.z };
    const float falls[8] = { fall[0], fall[1], fall[2], 0.0f, fall[0], fall[1], fall[2], 0.0f };
    const lane8 gain = lane8_loadu( falls ), dt = lane8_set1( h ), zero = lane8_zero();
    const lane8 to_target = lane8_set1( mine.to_target );
    const lane8m is_weight = lane8i_lt( lane8i_loadu( WEIGHTS_OF_ROW ), lane8i_set1( 0 ) );
    for ( int i = 32 * begin; i < 32 * end; i += 8 )
    {
        const lane8 x = lane8_loadu( mine.position + i ), target = lane8_loadu( mine.target + i );
        const lane8m pinned = lane8_eq( lane8_spread_last( x ), zero );
        const lane8m stays = lane8_eq( lane8_spread_last( target ), zero );
        const lane8 free = lane8_add( x, lane8_mul( dt, lane8_add( lane8_loadu( mine.velocity + i ), gain ) ) );
        const lane8 held = lane8_add( x, lane8_mul( to_target, lane8_sub( target, x ) ) );
        const lane8 moved = lane8_select( pinned, lane8_select( stays, x, held ), free );
        lane8_storeu( mine.predicted + i, lane8_select( is_weight, x, moved ) );
        lane8_storeu( mine.impulse + i, zero );
    }
}

float KERNEL( plate_largest_move )( const wisp_plate_move_args* args, int begin, int end )
{
    const wisp_plate_move_args mine = *args;
    lane8 largest = lane8_zero();
    for ( int slice = begin; slice < end; ++slice )
    {
        lane8v y;
        lane8 unused;
        lane8_load_xyzw_contiguous( mine.moved + (size_t)slice * 32, &y.x, &y.y, &y.z, &unused );
        const lane8 least = lane8_loadu( mine.least_height + (size_t)slice * 8 );
        largest = lane8_max( lane8_div( lane8v_dot( y, y ), lane8_mul( least, least ) ), largest );
    }
    float lanes[8], all = 0.0f;
    lane8_storeu( lanes, largest );
    for ( int lane = 0; lane < 8; ++lane )
    {
        all = lanes[lane] > all ? lanes[lane] : all;
    }
    return all;
}

void KERNEL( plate_accelerate )( const wisp_plate_move_args* args, int begin, int end )
{
    const wisp_plate_move_args mine = *args;
    const lane8 scale = lane8_set1( mine.scale ), dt = lane8_set1( mine.dt );
    for ( int i = 32 * begin; i < 32 * end; i += 8 )
    {
        const lane8 change = lane8_div( lane8_mul( scale, lane8_loadu( mine.moved + i ) ), dt );
        lane8_storeu( mine.velocity + i, lane8_add( lane8_loadu( mine.velocity + i ), change ) );
    }
}
