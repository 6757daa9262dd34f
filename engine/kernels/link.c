// Distance constraints between two particles, eight at a time. The links of a group share no particle (checked when
// the schedule is cooked). So there are no conflicts, and the result does not depend on how the range is split.
//
// This kernel is bound by the number of instructions, not by memory (bench case "links"). Particles are read as
// rows of four floats, and only their difference is transposed. Its fourth component holds the sum of the inverse
// masses.
#include "kernel_isa.h"

#include "lane_double_vec.h"
#include <string.h>

static const int32_t XYZ_SIGN[8] = { INT32_MIN, INT32_MIN, INT32_MIN, 0, INT32_MIN, INT32_MIN, INT32_MIN, 0 };

// Minimum denominator: squared length times inverse mass, m^2/kg. A shorter link is corrected more slowly, and not
// at all at length 0. For a pinned pair, which does not move, the step stays finite up to lengths of 1e6 m.
#define MIN_DENOMINATOR 1e-18f

// Kernels copy their arguments: stores to particles cannot alias a copy, so its pointers stay in registers.

// Eight pairs of particles as xyzw rows, and derived values.
typedef struct pairs
{
    int32_t a_x4[8]; // a copy too, until particles are stored
    lane8 a[4], b[4];
    lane8 along[4]; // a - b as rows, with wa + wb in the fourth component
    lane8 squared;  // m^2
    lane8 length;   // m
    lane8 weight;   // wa + wb, 1/kg
} pairs;

LANE_INLINE pairs load_pairs( const wisp_link_args* args, int link )
{
    const lane8i sign = lane8i_loadu( XYZ_SIGN );
    pairs p;
    lane8 d[4];
    for ( int l = 0; l < 8; ++l )
    {
        p.a_x4[l] = args->a_x4[link + l];
    }
    lane8_load_quads( args->position, p.a_x4, p.a );
    lane8_load_quads( args->position, args->b_x4 + link, p.b );
    for ( int r = 0; r < 4; ++r )
    {
        p.along[r] = d[r] = lane8_add( p.a[r], lane8_cast_float( lane8i_xor( lane8_cast_int( p.b[r] ), sign ) ) );
    }
    lane8_transpose_quads( d );
    const lane8v between = { d[0], d[1], d[2] };
    p.squared = lane8v_dot( between, between );
    p.length = lane8_sqrt( p.squared );
    p.weight = d[3];
    return p;
}

// Computes fraction error / (length weight). Only the squared length enters the division, so it runs in parallel
// with the square root.
LANE_INLINE lane8 step_of( const pairs* p, lane8 fraction, lane8 error, lane8 weight )
{
    lane8 denominator = lane8_max( lane8_mul( p->squared, weight ), lane8_set1( MIN_DENOMINATOR ) );
    return lane8_mul( error, lane8_mul( p->length, lane8_div( fraction, denominator ) ) );
}

// Applies a -= wa step (a - b), b += wb step (a - b). Inverse masses get 0 added.
LANE_INLINE void move_pairs( const wisp_link_args* args, int link, pairs* p, lane8 step )
{
    lane8 steps[4];
    lane8_spread_xyz( step, steps );
    for ( int r = 0; r < 4; ++r )
    {
        lane8 move = lane8_mul( steps[r], p->along[r] );
        p->a[r] = lane8_sub( p->a[r], lane8_mul( lane8_spread_last( p->a[r] ), move ) );
        p->b[r] = lane8_add( p->b[r], lane8_mul( lane8_spread_last( p->b[r] ), move ) );
    }
    lane8_store_quads( args->position, p->a_x4, p->a );
    lane8_store_quads( args->position, args->b_x4 + link, p->b );
}

// Loads which lanes of a group have bend links.
LANE_INLINE lane8m bend_links( const uint8_t* group )
{
    static const int32_t BITS[8] = { 1, 2, 4, 8, 16, 32, 64, 128 };
    int32_t word; // the bytes of three further groups are not looked at
    memcpy( &word, group, sizeof( word ) );
    return lane8i_lt( lane8i_set1( 0 ), lane8i_and( lane8i_set1( word ), lane8i_loadu( BITS ) ) );
}

// Leaves bend links of sharp folds out and sets their bits. A link between vertices that lie on each other has no direction, and
// it does not know on which side of each other two triangles lie, so it can hold a fold as well as open it.
LANE_INLINE lane8 leave_folded( const wisp_link_args* args, int link, const pairs* p, lane8 step )
{
    const lane8m is_short = lane8_lt( lane8_add( p->length, p->length ), lane8_loadu( args->rest + link ) );
    if ( lane8m_any( is_short ) ) // hardly ever
    {
        const lane8m folded = lane8m_and( bend_links( args->bends + link / 8 ), is_short );
        args->folded[link / 8] = (uint8_t)lane8m_bits( folded );
        step = lane8_select( folded, lane8_zero(), step );
    }
    return step;
}

// Projects with s = k (length - rest) / (length (wa + wb)), or in compliant steps, with C = length - rest, a = compliance / dt^2 and
// change of lambda = -(C + a lambda) / (wa + wb + a).
LANE_INLINE void project( const wisp_link_args mine, int begin, int end, bool compliant, bool keeps_lambda,
                          bool folds, bool are_alike )
{
    const lane8 scale = lane8_set1( mine.inverse_dt2 );
    const lane8 of_edge = lane8_set1( compliant ? mine.alike[0] * mine.inverse_dt2 : mine.alike[0] );
    const lane8 of_bend = lane8_set1( compliant ? mine.alike[1] * mine.inverse_dt2 : mine.alike[1] );
    const uint8_t* group = mine.bends + begin / 8;
    for ( int link = begin; link < end; link += 8, ++group )
    {
        pairs p = load_pairs( &mine, link );
        lane8 own =
            are_alike ? lane8_select( bend_links( group ), of_bend, of_edge ) : lane8_loadu( mine.own + link );
        own = compliant && are_alike == false ? lane8_mul( own, scale ) : own;
        lane8 error = lane8_sub( p.length, lane8_loadu( mine.rest + link ) );
        lane8 lambda = keeps_lambda ? lane8_loadu( mine.lambda + link ) : lane8_zero();
        error = keeps_lambda ? lane8_mul_add( own, lambda, error ) : error;
        lane8 step = compliant ? step_of( &p, lane8_set1( 1.0f ), error, lane8_add( p.weight, own ) )
                               : step_of( &p, own, error, p.weight );
        step = folds ? leave_folded( &mine, link, &p, step ) : step;
        if ( keeps_lambda )
        {
            // a pair of pinned particles has no step, whatever its compliance
            step = lane8_select( lane8_lt( lane8_zero(), p.weight ), step, lane8_zero() );
            lane8_storeu( mine.lambda + link, lane8_sub( lambda, lane8_mul( step, p.length ) ) );
        }
        move_pairs( &mine, link, &p, step );
    }
}

LANE_INLINE void project_links( const wisp_link_args* args, int begin, int end, bool compliant )
{
    const bool are_alike = args->own == NULL, keeps_lambda = compliant && args->lambda != NULL;
    if ( args->folded != NULL )
    {
        project( *args, begin, end, compliant, keeps_lambda, true, are_alike );
    }
    else if ( keeps_lambda )
    {
        project( *args, begin, end, compliant, true, false, are_alike );
    }
    else if ( are_alike )
    {
        project( *args, begin, end, compliant, false, false, true );
    }
    else
    {
        project( *args, begin, end, compliant, false, false, false );
    }
}

void KERNEL( link_pbd )( const wisp_link_args* args, int begin, int end )
{
    project_links( args, begin, end, false );
}

void KERNEL( link_xpbd )( const wisp_link_args* args, int begin, int end )
{
    project_links( args, begin, end, true );
}

// Clamps the length to [minimum rest, maximum rest].
void KERNEL( link_limit )( const wisp_link_args* args, int begin, int end )
{
    const wisp_link_args mine = *args;
    const lane8 minimum = lane8_set1( mine.minimum ), maximum = lane8_set1( mine.maximum );
    for ( int link = begin; link < end; link += 8 )
    {
        pairs p = load_pairs( &mine, link );
        lane8 rest = lane8_loadu( mine.rest + link );
        lane8 allowed = lane8_min( lane8_max( p.length, lane8_mul( rest, minimum ) ), lane8_mul( rest, maximum ) );
        lane8 error = lane8_sub( p.length, allowed );
        if ( lane8m_all( lane8_eq( error, lane8_zero() ) ) == false )
        {
            move_pairs( &mine, link, &p, step_of( &p, lane8_set1( 1.0f ), error, p.weight ) );
        }
    }
}

// Loads the vectors from b to a. Their floats are exact where the ends differ by less than a factor of two, so they have the
// digits that positions have.
LANE_INLINE lane8v load_vectors( const wisp_link_args* args, int link )
{
    lane8 a[4], b[4];
    lane8_load_quads( args->position, args->a_x4 + link, a );
    lane8_load_quads( args->position, args->b_x4 + link, b );
    for ( int r = 0; r < 4; ++r )
    {
        a[r] = lane8_sub( a[r], b[r] );
    }
    lane8_transpose_quads( a );
    return ( lane8v ){ a[0], a[1], a[2] };
}

// Sums T l with T = k (l - rest), in doubles: tensions are small differences of lengths. What pads has no length.
double KERNEL( link_virial )( const wisp_link_args* args, float edge_stiffness, float bend_stiffness, int begin,
                              int end )
{
    const wisp_link_args mine = *args;
    const lane8 edge = lane8_set1( edge_stiffness ), bend = lane8_set1( bend_stiffness );
    lane8d sum = lane8d_set1( 0.0 );
    for ( int link = begin; link < end; link += 8 )
    {
        const lane8d k = lane8d_widen( lane8_select( bend_links( mine.bends + link / 8 ), bend, edge ) );
        const lane8d length = lane8dv_length( lane8dv_widen( load_vectors( &mine, link ) ) );
        const lane8d tension = lane8d_mul( k, lane8d_sub( length, lane8d_widen( lane8_loadu( mine.rest + link ) ) ) );
        sum = lane8d_add( sum, lane8d_mul( tension, length ) );
    }
    return lane8d_sum_ordered( sum );
}

double KERNEL( link_strain )( const wisp_link_args* args, int begin, int end, float* largest )
{
    const wisp_link_args mine = *args;
    const lane8 zero = lane8_zero(), one = lane8_set1( 1.0f );
    lane8d sum = lane8d_set1( 0.0 );
    lane8 most = zero;
    for ( int link = begin; link < end; link += 8 )
    {
        const lane8 rest = lane8_loadu( mine.rest + link ), length = lane8v_length( load_vectors( &mine, link ) );
        const lane8m is_edge = lane8m_and_not( lane8_lt( zero, rest ), bend_links( mine.bends + link / 8 ) );
        const lane8 strain = lane8_abs( lane8_sub( lane8_div( length, lane8_select( is_edge, rest, one ) ), one ) );
        const lane8 of_edge = lane8_select( is_edge, strain, zero );
        sum = lane8d_add( sum, lane8d_widen( of_edge ) );
        most = lane8_max( of_edge, most );
    }
    float each[8];
    lane8_storeu( each, most );
    *largest = 0.0f;
    for ( int l = 0; l < 8; ++l )
    {
        *largest = each[l] > *largest ? each[l] : *largest;
    }
    return lane8d_sum_ordered( sum );
}
