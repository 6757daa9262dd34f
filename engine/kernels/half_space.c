// Contact of particles with half spaces, with Coulomb friction, eight particles at a time. With q a point of the
// surface and n its normal away from the body:
//
//   N <- max( 0, N + gap - n (p - q) )
//   u = tangential part of (p - previous) - motion, without the friction applied so far
//   T <- -u if |u| <= mu_s N, else -mu_k N u / |u|
//
// N and T are the accumulated normal and tangential corrections. They are clamped in place, so another call with
// the same rows is another sweep of projected Gauss-Seidel. A row is 64 bytes, one cache line, and is loaded into
// lanes by four transpositions.
#include "kernel_isa.h"

typedef struct half_space
{
    lane8v point, normal, motion, tangential_correction;
    lane8 gap, normal_correction, static_friction, kinetic_friction;
} half_space;

static half_space load_rows( const float* rows, const int32_t* row16 )
{
    half_space h;
    lane8_load_xyzw( rows, row16, &h.point.x, &h.point.y, &h.point.z, &h.normal.x );
    lane8_load_xyzw( rows + 4, row16, &h.normal.y, &h.normal.z, &h.motion.x, &h.motion.y );
    lane8_load_xyzw( rows + 8, row16, &h.motion.z, &h.gap, &h.normal_correction, &h.tangential_correction.x );
    lane8_load_xyzw( rows + 12, row16, &h.tangential_correction.y, &h.tangential_correction.z, &h.static_friction,
                     &h.kinetic_friction );
    return h;
}

static void store_rows( float* rows, const int32_t* row16, const half_space* h )
{
    lane8_store_xyzw( rows + 8, row16, h->motion.z, h->gap, h->normal_correction, h->tangential_correction.x );
    lane8_store_xyzw( rows + 12, row16, h->tangential_correction.y, h->tangential_correction.z, h->static_friction,
                      h->kinetic_friction );
}

// Computes the new tangential correction.
// @return the value that replaces h->tangential_correction
static lane8v find_friction( const half_space* h, lane8v p, lane8v previous )
{
    lane8v u = lane8v_sub( lane8v_sub( p, previous ), h->motion );
    u = lane8v_mul_add( u, lane8_neg( lane8v_dot( h->normal, u ) ), h->normal );
    u = lane8v_sub( u, h->tangential_correction );
    lane8 length = lane8v_length( u );
    lane8m sticks = lane8_le( length, lane8_mul( h->static_friction, h->normal_correction ) );
    lane8 slides = lane8_div( lane8_mul( h->kinetic_friction, h->normal_correction ), length );
    return lane8v_scale( u, lane8_neg( lane8_select( sticks, lane8_set1( 1.0f ), slides ) ) );
}

void KERNEL( half_space )( const wisp_half_space_args* args, int begin, int end )
{
    for ( int k = begin; k < end; k += 8 )
    {
        half_space h = load_rows( args->rows, args->row_x16 + k );
        lane8v p, previous;
        lane8 inverse_mass;
        lane8_load_xyzw( args->position, args->particle_x4 + k, &p.x, &p.y, &p.z, &inverse_mass );
        lane8_load_xyz( args->previous, args->particle_x4 + k, &previous.x, &previous.y, &previous.z );

        lane8 violation = lane8_sub( h.gap, lane8v_dot( h.normal, lane8v_sub( p, h.point ) ) );
        lane8 normal_correction = lane8_max( lane8_add( h.normal_correction, violation ), lane8_zero() );
        p = lane8v_mul_add( p, lane8_sub( normal_correction, h.normal_correction ), h.normal );
        h.normal_correction = normal_correction;

        const lane8v tangential_correction = find_friction( &h, p, previous );
        p = lane8v_add( p, lane8v_sub( tangential_correction, h.tangential_correction ) );
        h.tangential_correction = tangential_correction;

        lane8_store_xyzw( args->position, args->particle_x4 + k, p.x, p.y, p.z, inverse_mass );
        store_rows( args->rows, args->row_x16 + k, &h );
    }
}
