// Rigid motion of a set of particles, and damping towards it.
//
// Positions and velocities are relative to a nearby point and a similar velocity, so floats suffice for a few
// hundred particles. Sums over more are doubles.
#include "kernel_isa.h"

enum
{
    LANES = 8,
    PART = 256, // slots that are summed in floats
    SUMS = 16,
};

typedef struct particles8
{
    lane8v at; // relative to args->origin
    lane8v velocity;
    lane8 inverse_mass;
} particles8;

LANE_INLINE particles8 particles_of( const wisp_rigid_args* args, int slot )
{
    particles8 p;
    lane8 none;
    lane8_load_xyzw_contiguous( args->position + (size_t)slot * 4, &p.at.x, &p.at.y, &p.at.z, &p.inverse_mass );
    lane8_load_xyzw_contiguous( args->velocity + (size_t)slot * 4, &p.velocity.x, &p.velocity.y, &p.velocity.z,
                                &none );
    p.at = lane8v_sub( p.at, lane8v_set1( args->origin ) );
    return p;
}

static void add_to( lane8* sum, lane8 term )
{
    *sum = lane8_add( *sum, term );
}

static void add_vector( lane8 sum[3], lane8v term )
{
    add_to( sum, term.x );
    add_to( sum + 1, term.y );
    add_to( sum + 2, term.z );
}

// Sums in the order of wisp_rigid_sums.
// @param unit the inverse mass of the sums' unit, times what a mass counts
LANE_INLINE void add_particles( const wisp_rigid_args* args, lane8 unit, const particles8* p, lane8 sums[SUMS] )
{
    const lane8 zero = lane8_zero(), times = lane8_div( unit, p->inverse_mass );
    const lane8 mass = lane8_select( lane8_gt( p->inverse_mass, zero ), times, zero );
    const lane8v r = p->at, heavy = lane8v_scale( r, mass ),
                 u = lane8v_sub( p->velocity, lane8v_set1( args->linear_velocity ) );
    add_to( sums, mass );
    add_vector( sums + 1, heavy );
    add_vector( sums + 4, lane8v_scale( u, mass ) );
    add_vector( sums + 7, lane8v_cross( heavy, u ) );
    add_vector( sums + 10,
                ( lane8v ){ lane8_mul( heavy.x, r.x ), lane8_mul( heavy.y, r.y ), lane8_mul( heavy.z, r.z ) } );
    add_vector( sums + 13,
                ( lane8v ){ lane8_mul( heavy.x, r.y ), lane8_mul( heavy.x, r.z ), lane8_mul( heavy.y, r.z ) } );
}

_Static_assert( sizeof( wisp_rigid_sums ) == SUMS * sizeof( double ), "as many numbers" );

// @param mapped particles have fractions of their own
LANE_INLINE void sum_all( const wisp_rigid_args* args, int begin, int end, bool mapped, wisp_rigid_sums* sums )
{
    const lane8 inverse_mass = lane8_set1( args->inverse_mass );
    double total[SUMS] = { 0.0 };
    for ( int part = begin; part < end; part += PART )
    {
        lane8 lanes[SUMS];
        for ( int k = 0; k < SUMS; ++k )
        {
            lanes[k] = lane8_zero();
        }
        for ( int slot = part; slot < end && slot < part + PART; slot += LANES )
        {
            const particles8 p = particles_of( args, slot );
            const lane8 unit =
                mapped ? lane8_mul( lane8_loadu( args->fractions + slot ), inverse_mass ) : inverse_mass;
            add_particles( args, unit, &p, lanes );
        }
        for ( int k = 0; k < SUMS; ++k )
        {
            total[k] += lane8_sum_doubles( lanes[k] );
        }
    }
    memcpy( sums, total, sizeof( total ) );
}

void KERNEL( rigid_sums )( const wisp_rigid_args* args, int begin, int end, wisp_rigid_sums* sums )
{
    if ( args->fractions != NULL )
    {
        sum_all( args, begin, end, true, sums );
    }
    else
    {
        sum_all( args, begin, end, false, sums );
    }
}

// Adds what differs from the rigid motion, and a shift, to other vectors.
LANE_INLINE void add_rest( const wisp_rigid_args* args, int slot, lane8m moves, lane8v difference )
{
    lane8v rest;
    lane8 last;
    lane8_load_xyzw_contiguous( args->rest + (size_t)slot * 4, &rest.x, &rest.y, &rest.z, &last );
    const lane8v sum = lane8v_add( rest, lane8v_add( difference, lane8v_set1( args->shift ) ) );
    rest = lane8v_select( moves, sum, rest );
    lane8_store_xyzw_contiguous( args->rest + (size_t)slot * 4, rest.x, rest.y, rest.z, last );
}

LANE_INLINE void approach( const wisp_rigid_args* args, int begin, int end, bool mapped )
{
    const lane8v turning = lane8v_set1( args->angular_velocity ), drift = lane8v_set1( args->linear_velocity );
    const lane8 fraction = lane8_set1( args->fraction );
    for ( int slot = begin; slot < end; slot += LANES )
    {
        const particles8 p = particles_of( args, slot );
        const lane8v rigid = lane8v_add( drift, lane8v_cross( turning, p.at ) );
        const lane8v nearer = lane8v_mul_add( p.velocity, mapped ? lane8_loadu( args->fractions + slot ) : fraction,
                                              lane8v_sub( rigid, p.velocity ) );
        const lane8m moves = lane8_gt( p.inverse_mass, lane8_zero() );
        if ( args->rest != NULL )
        {
            add_rest( args, slot, moves, lane8v_sub( p.velocity, nearer ) );
            continue;
        }
        const lane8v v = lane8v_select( moves, nearer, p.velocity );
        lane8_store_xyzw_contiguous( args->velocity + (size_t)slot * 4, v.x, v.y, v.z, lane8_zero() );
    }
}

void KERNEL( rigid_approach )( const wisp_rigid_args* args, int begin, int end )
{
    if ( args->fractions != NULL )
    {
        approach( args, begin, end, true );
    }
    else
    {
        approach( args, begin, end, false );
    }
}

// Change of vectors by a rotation less the identity.
LANE_INLINE lane8v turned( const wisp_frame_motion_args* args, lane8v v )
{
    lane8v rows[3];
    for ( int r = 0; r < 3; ++r )
    {
        rows[r] = lane8v_set1( ( wisp_vec3 ){ args->turn[3 * r], args->turn[3 * r + 1], args->turn[3 * r + 2] } );
    }
    return ( lane8v ){ lane8v_dot( rows[0], v ), lane8v_dot( rows[1], v ), lane8v_dot( rows[2], v ) };
}

void KERNEL( move_points )( const wisp_frame_motion_args* args, float* xyzw, int begin, int end )
{
    const wisp_frame_motion_args mine = *args;
    const lane8v origin = lane8v_set1( mine.origin ), shift = lane8v_set1( mine.shift );
    for ( int slot = begin; slot < end; slot += LANES )
    {
        lane8v x;
        lane8 w;
        lane8_load_xyzw_contiguous( xyzw + (size_t)slot * 4, &x.x, &x.y, &x.z, &w );
        x = lane8v_add( x, lane8v_add( turned( &mine, lane8v_sub( x, origin ) ), shift ) );
        lane8_store_xyzw_contiguous( xyzw + (size_t)slot * 4, x.x, x.y, x.z, w );
    }
}

void KERNEL( turn_vectors )( const wisp_frame_motion_args* args, float* xyzw, int begin, int end )
{
    const wisp_frame_motion_args mine = *args;
    for ( int slot = begin; slot < end; slot += LANES )
    {
        lane8v v;
        lane8 w;
        lane8_load_xyzw_contiguous( xyzw + (size_t)slot * 4, &v.x, &v.y, &v.z, &w );
        v = lane8v_add( v, turned( &mine, v ) );
        lane8_store_xyzw_contiguous( xyzw + (size_t)slot * 4, v.x, v.y, v.z, w );
    }
}
