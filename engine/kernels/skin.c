// Skinning: points that follow up to four bones.
//
// Sums are written as x_0 + sum_k w_k (x_k - x_0), with the largest weight left out. Weights then sum to 1 by construction: bones
// that are equal to the last bit give exactly their transform, and a point that follows one bone has no weights at all.
#include "kernel_isa.h"

enum
{
    ROW = 16, // floats of a bone
    QUADS = 3,
};

// Quads of one row of the bones, one per point: register r holds those of points r and r + 4.
LANE_INLINE void load_bones( const wisp_skin_args* args, const int32_t ( *bones )[4], int influence, int quad,
                             lane8 rows[4] )
{
    int32_t index[8];
    for ( int l = 0; l < 8; ++l )
    {
        index[l] = bones[l][influence] * ROW;
    }
    lane8_load_quads( args->rows + 4 * quad, index, rows );
}

// Lanes to the user's order. Padding repeats a point and writes the same numbers again.
LANE_INLINE void store_points( const wisp_skin_args* args, int group, lane8v p )
{
    _Alignas( 32 ) float rows[8][4];
    const int32_t* point = args->point + 8 * (size_t)group;
    lane8_store_xyzw_contiguous( rows[0], p.x, p.y, p.z, lane8_zero() );
    for ( int l = 0; l < 8; ++l )
    {
        memcpy( &args->out[point[l]], rows[l], sizeof( wisp_vec3 ) );
    }
}

// Magnenat-Thalmann, Laperriere, Thalmann 1988: p' = (sum_k w_k M_k) p.
LANE_INLINE void skin_linear( const wisp_skin_args* args, int begin, int end, int influences )
{
    for ( int g = begin; g < end; ++g )
    {
        const int32_t( *bones )[4] = args->bones + 8 * (size_t)g;
        lane8 weights[4], spread[WISP_SKIN_MAX_INFLUENCES][4], moved[QUADS];
        lane8_load_quads( args->weights[8 * (size_t)g], lane_quad_iota, weights );
        for ( int r = 0; r < 4 && influences > 1; ++r )
        {
            spread[1][r] = lane8_spread_second( weights[r] );
            spread[2][r] = lane8_spread_third( weights[r] );
            spread[3][r] = lane8_spread_last( weights[r] );
        }
        const lane8v p = lane8v_load( args->xyz + 24 * (size_t)g );
        for ( int quad = 0; quad < QUADS; ++quad )
        {
            // means of rows of the matrices, four numbers of a point side by side
            lane8 first[4], row[4];
            load_bones( args, bones, 0, quad, first );
            memcpy( row, first, sizeof( row ) );
            for ( int k = 1; k < influences; ++k )
            {
                lane8 other[4];
                load_bones( args, bones, k, quad, other );
                for ( int r = 0; r < 4; ++r )
                {
                    row[r] = lane8_mul_add( spread[k][r], lane8_sub( other[r], first[r] ), row[r] );
                }
            }
            lane8_transpose_quads( row );
            moved[quad] = lane8_add( lane8v_dot( ( lane8v ){ row[0], row[1], row[2] }, p ), row[3] );
        }
        store_points( args, g, ( lane8v ){ moved[0], moved[1], moved[2] } );
    }
}

typedef struct dual_quat8
{
    lane8 part[2][4]; // real, dual; x, y, z, w
} dual_quat8;

LANE_INLINE dual_quat8 load_dual_quats( const wisp_skin_args* args, const int32_t ( *bones )[4], int influence )
{
    dual_quat8 q;
    for ( int i = 0; i < 2; ++i )
    {
        load_bones( args, bones, influence, i, q.part[i] );
        lane8_transpose_quads( q.part[i] );
    }
    return q;
}

// sum += weight (sign q - first). A quaternion and its negative are the same rotation: of the two, the one nearer to that of the
// largest weight (Kavan et al. 2008, section 4.1).
LANE_INLINE void add_dual_quat( dual_quat8* sum, const dual_quat8* first, const dual_quat8* q, lane8 weight )
{
    lane8 dot = lane8_mul( first->part[0][0], q->part[0][0] );
    for ( int c = 1; c < 4; ++c )
    {
        dot = lane8_mul_add( first->part[0][c], q->part[0][c], dot );
    }
    const lane8m is_near = lane8_ge( dot, lane8_zero() );
    for ( int i = 0; i < 2; ++i )
    {
        for ( int c = 0; c < 4; ++c )
        {
            const lane8 near = lane8_select( is_near, q->part[i][c], lane8_neg( q->part[i][c] ) );
            sum->part[i][c] = lane8_mul_add( weight, lane8_sub( near, first->part[i][c] ), sum->part[i][c] );
        }
    }
}

// p' = p + 2 v x (v x p + w p) + 2 (w d - e v + v x d) for the unit real part (v, w) and the dual part (d, e). The sum is divided
// by its length where products of two of its parts appear, so there is no square root.
LANE_INLINE lane8v apply_dual_quat( const dual_quat8* q, lane8v p )
{
    const lane8v v = { q->part[0][0], q->part[0][1], q->part[0][2] },
                 d = { q->part[1][0], q->part[1][1], q->part[1][2] };
    const lane8 w = q->part[0][3], e = q->part[1][3];
    const lane8 scale = lane8_div( lane8_set1( 2.0f ), lane8_mul_add( w, w, lane8v_dot( v, v ) ) );
    const lane8v turned = lane8v_cross( v, lane8v_mul_add( lane8v_cross( v, p ), w, p ) );
    const lane8v moved = lane8v_add( lane8v_sub( lane8v_scale( d, w ), lane8v_scale( v, e ) ), lane8v_cross( v, d ) );
    return lane8v_mul_add( p, scale, lane8v_add( turned, moved ) );
}

LANE_INLINE void skin_dual_quaternion( const wisp_skin_args* args, int begin, int end, int influences )
{
    for ( int g = begin; g < end; ++g )
    {
        const int32_t( *bones )[4] = args->bones + 8 * (size_t)g;
        lane8 weights[4];
        lane8_load_quads( args->weights[8 * (size_t)g], lane_quad_iota, weights );
        lane8_transpose_quads( weights );
        const dual_quat8 first = load_dual_quats( args, bones, 0 );
        dual_quat8 sum = first;
        for ( int k = 1; k < influences; ++k )
        {
            const dual_quat8 q = load_dual_quats( args, bones, k );
            add_dual_quat( &sum, &first, &q, weights[k] );
        }
        store_points( args, g, apply_dual_quat( &sum, lane8v_load( args->xyz + 24 * (size_t)g ) ) );
    }
}

// A loop for each number of bones, without branches inside.
#define SKIN_KERNEL( name )                                                                                          \
    void KERNEL( name )( const wisp_skin_args* args, int begin, int end )                                            \
    {                                                                                                                \
        switch ( args->influence_count )                                                                             \
        {                                                                                                            \
            case 1:                                                                                                  \
                name( args, begin, end, 1 );                                                                         \
                break;                                                                                               \
            case 2:                                                                                                  \
                name( args, begin, end, 2 );                                                                         \
                break;                                                                                               \
            case 3:                                                                                                  \
                name( args, begin, end, 3 );                                                                         \
                break;                                                                                               \
            default:                                                                                                 \
                name( args, begin, end, 4 );                                                                         \
                break;                                                                                               \
        }                                                                                                            \
    }

SKIN_KERNEL( skin_linear )
SKIN_KERNEL( skin_dual_quaternion )
