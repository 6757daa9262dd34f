// Centres and edge vectors of primitives of surfaces (points, edges and triangles), eight at a time, and separation
// of point sets.
#include "kernel_isa.h"

enum
{
    LANES = 8,
};

LANE_INLINE lane8v point_of( const float* xyzw, const int32_t* point_x4 )
{
    lane8v p;
    lane8_load_xyz( xyzw, point_x4, &p.x, &p.y, &p.z );
    return p;
}

LANE_INLINE void store( float to[3][8], lane8v v )
{
    lane8v_store( to[0], v );
}

LANE_INLINE void place_triangle( wisp_primitive_pack* row, lane8v a, lane8v b, lane8v c )
{
    const lane8v across = lane8v_cross( lane8v_sub( b, a ), lane8v_sub( c, a ) );
    const lane8 squared = lane8v_dot( across, across ), zero = lane8_zero();
    const lane8m wide = lane8_gt( squared, lane8_set1( KERNEL_MIN_SQUARED ) );
    const lane8 one_over = lane8_div( lane8_set1( 1.0f ), lane8_sqrt( squared ) );
    const lane8v normal = lane8v_scale( across, lane8_select( wide, one_over, zero ) );
    lane8 rounded = lane8_abs( lane8v_dot( normal, a ) );
    rounded = lane8_max( rounded, lane8_abs( lane8v_dot( normal, b ) ) );
    rounded = lane8_max( rounded, lane8_abs( lane8v_dot( normal, c ) ) );
    store( row->other_edge_vector[0], b );
    store( row->other_edge_vector[1], c );
    store( row->normal, normal );
    lane8_store( row->rounding, rounded );
}

void KERNEL( place_primitives )( const float* xyzw, wisp_primitive_pack* rows, int points, int begin, int end )
{
    const lane8 half = lane8_set1( 0.5f ), third = lane8_set1( 1.0f / 3.0f );
    for ( int r = begin; r < end; ++r )
    {
        wisp_primitive_pack* row = rows + r;
        const lane8v a = point_of( xyzw, row->point_x4[0] );
        if ( points == 1 )
        {
            store( row->centre, a );
            continue;
        }
        const lane8v b = point_of( xyzw, row->point_x4[1] );
        lane8v centre = lane8v_scale( lane8v_add( a, b ), half );
        if ( points == 3 )
        {
            const lane8v c = point_of( xyzw, row->third_x4 );
            centre = lane8v_scale( lane8v_add( lane8v_add( a, b ), c ), third );
            place_triangle( row, lane8v_sub( a, centre ), lane8v_sub( b, centre ), lane8v_sub( c, centre ) );
        }
        store( row->edge_vector, lane8v_sub( a, centre ) );
        store( row->centre, centre );
    }
}

// Computes the minimum over the lanes of each of eight registers.
LANE_INLINE lane8 min_of_each( const lane8 v[8] )
{
    lane8i rows[8];
    for ( int i = 0; i < 8; ++i )
    {
        rows[i] = lane8_cast_int( v[i] );
    }
    lane8i_transpose( rows );
    lane8 least = lane8_cast_float( rows[0] );
    for ( int i = 1; i < 8; ++i )
    {
        least = lane8_min( least, lane8_cast_float( rows[i] ) );
    }
    return least;
}

float KERNEL( separation )( const wisp_separating_axis_args* args )
{
    enum
    {
        AXES = 3,
    };
    // minimum of each set along each axis, and along its negative
    lane8 lower[8], upper[8];
    for ( int i = 0; i < 8; ++i )
    {
        lower[i] = upper[i] = lane8_set1( INFINITY );
    }
    for ( int set = 0; set < 2; ++set )
    {
        for ( int i = 0; i < args->count[set]; i += LANES )
        {
            const lane8v p = point_of( args->xyzw, args->point_x4[set] + i );
            for ( int k = 0; k < AXES; ++k )
            {
                const float* a = args->axis[k];
                const lane8v axis = { lane8_set1( a[0] ), lane8_set1( a[1] ), lane8_set1( a[2] ) };
                const lane8 at = lane8v_dot( p, axis );
                lower[AXES * set + k] = lane8_min( at, lower[AXES * set + k] );
                upper[AXES * set + k] = lane8_min( lane8_neg( at ), upper[AXES * set + k] );
            }
        }
    }
    float least[8], most[8], max_gap = -1.0f;
    lane8_storeu( least, min_of_each( lower ) );
    lane8_storeu( most, min_of_each( upper ) );
    for ( int k = 0; k < AXES; ++k )
    {
        const float* a = args->axis[k];
        const float one = least[k] + most[AXES + k], other = least[AXES + k] + most[k];
        const float squared = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
        const float gap = squared > KERNEL_MIN_SQUARED ? ( one > other ? one : other ) / sqrtf( squared ) : -1.0f;
        max_gap = gap > max_gap ? gap : max_gap;
    }
    return max_gap;
}
