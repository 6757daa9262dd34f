// Distances between two particles, eight at a time. No two of a group share a particle (the schedule checks it when it is
// cooked), so there are no conflicts, and the result does not depend on how the range is cut.
//
// Stores are the limit of this kernel, not arithmetic (bench case "cloth"): particles are read as quads, only their
// difference is transposed, and the fourth number of that difference carries the sum of the inverse masses.
#include "kernel_isa.h"

static const int32_t XYZ_MASK[8] = { -1, -1, -1, 0, -1, -1, -1, 0 };
static const int32_t XYZ_SIGN[8] = { INT32_MIN, INT32_MIN, INT32_MIN, 0, INT32_MIN, INT32_MIN, INT32_MIN, 0 };

// Eight pairs of particles as rows of quads, and what a constraint wants to know of them.
typedef struct pairs
{
    lane8 a[4], b[4];
    lane8 along[4]; // a - b as rows, 0 behind
    lane8 length;   // m
    lane8 weight;   // wa + wb, 1/kg
} pairs;

LANE_INLINE pairs load_pairs( const wisp_link_job* job, int link )
{
    const lane8i mask = lane8i_loadu( XYZ_MASK ), sign = lane8i_loadu( XYZ_SIGN );
    pairs p;
    lane8 d[4];
    lane8_load_quads( job->position, job->a4 + link, p.a );
    lane8_load_quads( job->position, job->b4 + link, p.b );
    for ( int r = 0; r < 4; ++r )
    {
        d[r] = lane8_add( p.a[r], lane8_cast_float( lane8i_xor( lane8_cast_int( p.b[r] ), sign ) ) );
        p.along[r] = lane8_cast_float( lane8i_and( lane8_cast_int( d[r] ), mask ) );
    }
    lane8_transpose_quads( d );
    p.length = lane8v_length( ( lane8v ){ d[0], d[1], d[2] } );
    p.weight = d[3];
    return p;
}

// a -= wa step (a - b), b += wb step (a - b)
LANE_INLINE void move_pairs( const wisp_link_job* job, int link, pairs* p, lane8 step )
{
    lane8 steps[4];
    lane8_spread( step, steps );
    for ( int r = 0; r < 4; ++r )
    {
        lane8 of_a = lane8_mul( lane8_spread_last( p->a[r] ), steps[r] );
        lane8 of_b = lane8_mul( lane8_spread_last( p->b[r] ), steps[r] );
        p->a[r] = lane8_sub( p->a[r], lane8_mul( of_a, p->along[r] ) );
        p->b[r] = lane8_add( p->b[r], lane8_mul( of_b, p->along[r] ) );
    }
    lane8_store_quads( job->position, job->a4 + link, p->a );
    lane8_store_quads( job->position, job->b4 + link, p->b );
}

// A length times an inverse mass, m/kg, so small that a quotient by it could overflow.
#define SMALLEST_DENOMINATOR 1e-30f

// numerator / denominator, and 0 where the denominator is: two pinned ends, or coincident ones whose direction is
// undefined.
LANE_INLINE lane8 divide_or_zero( lane8 numerator, lane8 denominator )
{
    lane8m usable = lane8_ge( denominator, lane8_set1( SMALLEST_DENOMINATOR ) );
    return lane8_select( usable, lane8_div( numerator, lane8_select( usable, denominator, lane8_set1( 1.0f ) ) ),
                         lane8_zero() );
}

// s = k (length - rest) / (length (wa + wb))
void KERNEL( link_pbd )( const wisp_link_job* job, int begin, int end )
{
    for ( int link = begin; link < end; link += 8 )
    {
        pairs p = load_pairs( job, link );
        lane8 error = lane8_sub( p.length, lane8_loadu( job->rest + link ) );
        lane8 softened = lane8_mul( lane8_loadu( job->stiffness + link ), error );
        move_pairs( job, link, &p, divide_or_zero( softened, lane8_mul( p.length, p.weight ) ) );
    }
}

// C = length - rest, a = compliance / dt^2, change of lambda = -(C + a lambda) / (wa + wb + a); particles move by it.
void KERNEL( link_xpbd )( const wisp_link_job* job, int begin, int end )
{
    const lane8 inverse_dt2 = lane8_set1( job->inverse_dt2 );
    for ( int link = begin; link < end; link += 8 )
    {
        pairs p = load_pairs( job, link );
        lane8 alpha = lane8_mul( lane8_loadu( job->compliance + link ), inverse_dt2 );
        lane8 error = lane8_sub( p.length, lane8_loadu( job->rest + link ) );
        lane8 lambda = lane8_zero();
        if ( job->lambda != NULL )
        {
            lambda = lane8_loadu( job->lambda + link );
            error = lane8_mul_add( alpha, lambda, error );
        }
        // a pair of pinned particles would answer a compliance: it must not
        lane8 weight = lane8_select( lane8_lt( lane8_zero(), p.weight ), lane8_add( p.weight, alpha ), lane8_zero() );
        lane8 step = divide_or_zero( error, lane8_mul( p.length, weight ) );
        if ( job->lambda != NULL )
        {
            lane8_storeu( job->lambda + link, lane8_sub( lambda, lane8_mul( step, p.length ) ) );
        }
        move_pairs( job, link, &p, step );
    }
}

// As pbd with stiffness 1, where the pair is too long; nothing where it is slack.
void KERNEL( link_unilateral )( const wisp_link_job* job, int begin, int end )
{
    for ( int link = begin; link < end; link += 8 )
    {
        pairs p = load_pairs( job, link );
        lane8 error = lane8_sub( p.length, lane8_loadu( job->rest + link ) );
        lane8m stretched = lane8_lt( lane8_zero(), error );
        if ( lane8m_any( stretched ) == false )
        {
            continue;
        }
        lane8 step = divide_or_zero( error, lane8_mul( p.length, p.weight ) );
        move_pairs( job, link, &p, lane8_select( stretched, step, lane8_zero() ) );
    }
}

// The length is brought into [minimum rest, maximum rest].
void KERNEL( link_limit )( const wisp_link_job* job, int begin, int end )
{
    const lane8 minimum = lane8_set1( job->minimum ), maximum = lane8_set1( job->maximum );
    for ( int link = begin; link < end; link += 8 )
    {
        pairs p = load_pairs( job, link );
        lane8 rest = lane8_loadu( job->rest + link );
        lane8 allowed = lane8_min( lane8_max( p.length, lane8_mul( rest, minimum ) ), lane8_mul( rest, maximum ) );
        lane8 error = lane8_sub( p.length, allowed );
        if ( lane8m_any( lane8m_not( lane8_eq( error, lane8_zero() ) ) ) == false )
        {
            continue;
        }
        move_pairs( job, link, &p, divide_or_zero( error, lane8_mul( p.length, p.weight ) ) );
    }
}
