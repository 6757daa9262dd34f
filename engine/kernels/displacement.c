// Displacements of points, and upper bounds of how much they can bring points closer together.
#include "kernel_isa.h"

enum
{
    LANES = 8,
};

LANE_INLINE lane8v displacement_of( const wisp_displacement_args* args, int point )
{
    lane8v now, before;
    lane8 weight;
    lane8_load_xyzw_contiguous( args->now + (size_t)point * 4, &now.x, &now.y, &now.z, &weight );
    lane8_load_xyzw_contiguous( args->before + (size_t)point * 4, &before.x, &before.y, &before.z, &weight );
    return lane8v_sub( now, before );
}

// Replaces a length that is NaN or too large by 0.
LANE_INLINE lane8 length_of( lane8v displacement )
{
    const lane8 length = lane8_sqrt( lane8v_dot( displacement, displacement ) );
    return lane8_select( lane8_lt( length, lane8_set1( 1e6f ) ), length, lane8_zero() );
}

bool KERNEL( sum_displacements )( const wisp_displacement_args* args, int begin, int end, double sum[3] )
{
    const lane8 zero = lane8_zero(), most = lane8_set1( 1e6f );
    lane8 lanes[3] = { zero, zero, zero };
    uint32_t fixed = 0;
    for ( int p = begin; p < end; p += LANES )
    {
        const lane8m valid = lane8m_first( end - p );
        const lane8v displacement = displacement_of( args, p );
        const lane8 each[3] = { displacement.x, displacement.y, displacement.z };
        for ( int k = 0; k < 3; ++k )
        {
            const lane8m counts = lane8m_and( valid, lane8_lt( lane8_abs( each[k] ), most ) );
            lanes[k] = lane8_add( lanes[k], lane8_select( counts, each[k], zero ) );
        }
        lane8 x, y, z, weight;
        lane8_load_xyzw_contiguous( args->now + (size_t)p * 4, &x, &y, &z, &weight );
        fixed |= lane8m_bits( lane8m_and( valid, lane8_eq( weight, zero ) ) );
    }
    for ( int k = 0; k < 3; ++k )
    {
        sum[k] = lane8_sum_doubles( lanes[k] );
    }
    return fixed != 0;
}

void KERNEL( measure_displacements )( const wisp_displacement_args* args, int begin, int end )
{
    const lane8v common = { lane8_set1( args->common_displacement[0] ), lane8_set1( args->common_displacement[1] ),
                            lane8_set1( args->common_displacement[2] ) };
    const lane8 fraction = lane8_set1( args->relative_margin ), spare = lane8_set1( args->margin );
    for ( int p = begin; p < end; p += LANES )
    {
        const lane8v displacement = displacement_of( args, p );
        const lane8 most = lane8_add( lane8_mul( fraction, length_of( lane8v_sub( displacement, common ) ) ), spare );
        lane8_store_xyzw_contiguous( args->displacement + (size_t)p * 4, displacement.x, displacement.y,
                                     displacement.z, most );
    }
}

bool KERNEL( exceeds_prediction )( const wisp_displacement_args* args, int begin, int end )
{
    uint32_t bits = 0;
    for ( int p = begin; p < end; p += LANES )
    {
        lane8v expected;
        lane8 most;
        lane8_load_xyzw_contiguous( args->displacement + (size_t)p * 4, &expected.x, &expected.y, &expected.z,
                                    &most );
        const lane8m beyond = lane8_gt( length_of( lane8v_sub( displacement_of( args, p ), expected ) ), most );
        bits |= lane8m_bits( lane8m_and( beyond, lane8m_first( end - p ) ) );
    }
    return bits != 0;
}

// Computes by how much two points can approach each other.
LANE_INLINE lane8 approach_of( const lane8 p[4], const lane8 q[4] )
{
    const lane8v between = { lane8_sub( p[0], q[0] ), lane8_sub( p[1], q[1] ), lane8_sub( p[2], q[2] ) };
    return lane8_add( lane8_sqrt( lane8v_dot( between, between ) ), lane8_add( p[3], q[3] ) );
}

void KERNEL( max_approach )( const wisp_approach_args* args, int begin, int end )
{
    const int split = args->are_edges ? 2 : 1;
    for ( int pair = begin; pair < end; pair += LANES )
    {
        lane8 corners[4][4], most = lane8_zero();
        for ( int i = 0; i < 4; ++i )
        {
            lane8* p = corners[i];
            lane8_load_xyzw( args->predicted, args->point_x4[i] + pair, p, p + 1, p + 2, p + 3 );
        }
        for ( int i = 0; i < split; ++i )
        {
            for ( int k = split; k < 4; ++k )
            {
                const lane8 approach = approach_of( corners[i], corners[k] );
                most = lane8_select( lane8_gt( most, approach ), most, approach );
            }
        }
        lane8_storeu( args->max_approach + pair, most );
    }
}

// Computes an upper bound of the approach of two sides, with a margin for rounding.
LANE_INLINE lane8 approach_of_sides( const float* displacements, const int32_t first4[8], const int32_t second4[8] )
{
    lane8 a[4], b[4];
    lane8_load_xyzw( displacements, first4, a, a + 1, a + 2, a + 3 );
    lane8_load_xyzw( displacements, second4, b, b + 1, b + 2, b + 3 );
    return lane8_mul( lane8_set1( 1.0001f ), approach_of( a, b ) );
}

int KERNEL( find_active_pairs )( const wisp_separation_args* args, int begin, int end )
{
    int count = 0;
    for ( int pair = begin; pair < end; pair += LANES )
    {
        int32_t first4[LANES], second4[LANES];
        lane8i_storeu( first4, lane8i_shift_left( lane8i_loadu( args->first + pair ), 2 ) );
        lane8i_storeu( second4, lane8i_shift_left( lane8i_loadu( args->second + pair ), 2 ) );
        lane8 slack = lane8_loadu( args->separation_bound + pair );
        if ( args->moved != NULL )
        {
            slack = lane8_sub( slack, approach_of_sides( args->moved, first4, second4 ) );
            lane8_storeu( args->separation_bound + pair, slack );
        }
        const lane8m left = lane8_gt( slack, approach_of_sides( args->predicted, first4, second4 ) );
        const uint32_t bits = lane8m_bits( lane8m_and_not( lane8m_first( end - pair ), left ) );
        const lane8i numbers = lane8i_add( lane8i_set1( pair ), lane8i_iota() );
        count += lane8i_compress_store( args->active + begin + count, numbers, bits );
    }
    return count;
}

void KERNEL( xyzw_range )( const float* xyzw, const float* less, const int32_t* point_x4, int count, float lower[4],
                           float upper[4] )
{
    lane8 least = lane8_set1( INFINITY ), most = lane8_set1( -INFINITY );
    for ( int i = 0; i < count; i += LANES )
    {
        lane8 q[4], from[4];
        lane8_load_quads( xyzw, point_x4 + i, q );
        if ( less != NULL )
        {
            lane8_load_quads( less, point_x4 + i, from );
        }
        for ( int k = 0; k < 4; ++k )
        {
            const lane8 v = less != NULL ? lane8_sub( q[k], from[k] ) : q[k];
            least = lane8_min( v, least ); // a NaN in v yields the second operand
            most = lane8_max( v, most );
        }
    }
    float both[2][LANES];
    lane8_storeu( both[0], least );
    lane8_storeu( both[1], most );
    for ( int k = 0; k < 4; ++k )
    {
        lower[k] = both[0][k] < both[0][k + 4] ? both[0][k] : both[0][k + 4];
        upper[k] = both[1][k] > both[1][k + 4] ? both[1][k] : both[1][k + 4];
    }
}
