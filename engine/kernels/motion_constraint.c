// Targets: a largest distance of each particle from a target that moves, and a backstop behind the target, a sphere
// or a plane that the particle may not pass (the separation constraints of NvCloth). Targets move in a straight line over a step.
//
// Most particles of a garment are well inside their spheres. So a group of eight is first tested against a cube around the middle of
// each target's path, which is inside the sphere and in front of the backstop wherever the target is in the step. Rows of positions
// are compared as they are, without a transposition.
#include "kernel_isa.h"

#include <math.h>

// Selects x, y and z of two particles, without their signs.
static const int32_t MAGNITUDE_MASK[8] = { INT32_MAX, INT32_MAX, INT32_MAX, 0, INT32_MAX, INT32_MAX, INT32_MAX, 0 };

// Ratio of half the edge of a cube to the radius of the sphere around it, rounded down.
#define CUBE_IN_SPHERE 0.5773f

LANE_INLINE lane8 distances( const float* position, const float* bound, lane8i mask )
{
    const lane8 difference = lane8_sub( lane8_load( position ), lane8_load( bound ) );
    return lane8_cast_float( lane8i_and( lane8_cast_int( difference ), mask ) );
}

// NaN counts as inside: such a particle cannot be projected.
LANE_INLINE bool is_inside( const float* position, const float* bound, lane8i mask )
{
    const lane8 a = lane8_max( distances( position, bound, mask ), distances( position + 8, bound + 8, mask ) );
    const lane8 b =
        lane8_max( distances( position + 16, bound + 16, mask ), distances( position + 24, bound + 24, mask ) );
    return lane8m_any( lane8_lt( lane8_set1( bound[3] ), lane8_max( a, b ) ) ) == false;
}

// A vector at the end of the substep: its value at the end of the step less what it still has to change.
LANE_INLINE lane8v at_substep( const float* end, const float* change, lane8 left )
{
    const lane8v e = lane8v_load( end ), c = lane8v_load( change );
    return ( lane8v ){ lane8_sub( e.x, lane8_mul( left, c.x ) ), lane8_sub( e.y, lane8_mul( left, c.y ) ),
                       lane8_sub( e.z, lane8_mul( left, c.z ) ) };
}

typedef struct constrained
{
    lane8v place, target;
    lane8 inverse_mass;
    lane8m moves; // lanes that are not pinned
    lane8m changed;
} constrained;

// Fraction of an error that is removed: the stiffness, or by xpbd w / (w + compliance / dt^2).
LANE_INLINE lane8 fraction_of( lane8 inverse_mass, lane8m pulls, wisp_motion_response response )
{
    const lane8 one = lane8_set1( 1.0f );
    const lane8 w = lane8_select( pulls, inverse_mass, one );
    const lane8 softened = lane8_div( w, lane8_add( w, lane8_set1( response.compliance ) ) );
    return response.compliance == 0.0f ? lane8_set1( response.stiffness ) : softened;
}

// C = |x - t| - d <= 0. A hard constraint puts the particle at t + d (x - t) / |x - t|, exactly at t for d = 0.
LANE_INLINE void hold_near( const wisp_motion_constraint_args* args, int slot, constrained* p )
{
    const lane8v e = lane8v_sub( p->place, p->target );
    const lane8 longest = lane8_load( args->max_distance + slot ), squared = lane8v_dot( e, e ),
                one = lane8_set1( 1.0f );
    const lane8m pulls = lane8m_and( p->moves, lane8_lt( lane8_mul( longest, longest ), squared ) );
    if ( lane8m_any( pulls ) )
    {
        const lane8 length = lane8_sqrt( lane8_select( pulls, squared, one ) );
        const lane8 fraction = fraction_of( p->inverse_mass, pulls, args->distance );
        const lane8 keep = lane8_mul_add( fraction, lane8_div( longest, length ), lane8_sub( one, fraction ) );
        p->place = lane8v_select( pulls, lane8v_mul_add( p->target, keep, e ), p->place );
        p->changed = lane8m_or( p->changed, pulls );
    }
}

typedef struct backstop
{
    lane8v normal;
    lane8v from_foot; // m, of the particle from the point of the backstop that is nearest to the target
    lane8 depth;      // m, C < 0 inside
    lane8v direction; // out of the backstop, unit
    lane8m is_inside;
} backstop;

// With y the position relative to the foot t - b n, and k = 1/r: g = n.y + k/2 |y|^2 is (rho^2 - r^2) / (2 r), rho the distance
// from the centre. C = rho - r = 2 g / (1 + s) and its direction is (n + k y) / s, with s = |n + k y| = rho / r. A plane is k = 0.
// @param of_all false: where the particle is farther from its target than the backstop; the others are outside
LANE_INLINE backstop find_backstop( const wisp_motion_constraint_args* args, int slot, const constrained* p,
                                    bool of_all )
{
    const lane8 zero = lane8_zero(), one = lane8_set1( 1.0f ), two = lane8_set1( 2.0f ), half = lane8_set1( 0.5f );
    const lane8v e = lane8v_sub( p->place, p->target );
    const lane8 behind = lane8_load( args->backstop_distance + slot ), k = lane8_load( args->curvature + slot );
    backstop b;
    b.is_inside = lane8m_and( p->moves, of_all ? lane8_lt( behind, lane8_set1( INFINITY ) )
                                               : lane8_lt( lane8_mul( behind, behind ), lane8v_dot( e, e ) ) );
    if ( lane8m_any( b.is_inside ) == false )
    {
        return b;
    }
    const lane8v n = at_substep( args->normal + 3 * (size_t)slot, args->normal_change + 3 * (size_t)slot,
                                 lane8_set1( args->left ) );
    const lane8 length = lane8v_length( n );
    b.is_inside = lane8m_and( b.is_inside, lane8_lt( zero, length ) );
    b.normal = lane8v_scale( n, lane8_div( one, lane8_select( b.is_inside, length, one ) ) );
    b.from_foot = lane8v_mul_add( e, behind, b.normal );
    const lane8 g = lane8_mul_add( lane8_mul( half, k ), lane8v_dot( b.from_foot, b.from_foot ),
                                   lane8v_dot( b.normal, b.from_foot ) );
    b.is_inside = of_all ? b.is_inside : lane8m_and( b.is_inside, lane8_lt( g, zero ) );
    const lane8v outward = lane8v_mul_add( b.normal, k, b.from_foot );
    const lane8 s = lane8v_length( outward );
    const lane8m has_direction = lane8_lt( lane8_set1( 1e-6f ), s ); // else it is the centre, and the normal will do
    b.depth = lane8_div( lane8_mul( two, g ), lane8_add( one, s ) );
    b.direction = lane8v_select(
        has_direction, lane8v_scale( outward, lane8_div( one, lane8_select( has_direction, s, one ) ) ), b.normal );
    return b;
}

LANE_INLINE void stop_behind( const wisp_motion_constraint_args* args, int slot, constrained* p )
{
    const backstop b = find_backstop( args, slot, p, false );
    if ( lane8m_any( b.is_inside ) )
    {
        const lane8 shift = lane8_mul( fraction_of( p->inverse_mass, b.is_inside, args->backstop ), b.depth );
        p->place =
            lane8v_select( b.is_inside, lane8v_mul_add( p->place, lane8_neg( shift ), b.direction ), p->place );
        p->changed = lane8m_or( p->changed, b.is_inside );
    }
}

// ---- several iterations of a compliant constraint: the multiplier is kept within the substep ----

// Change of the multiplier, (-C - compliance lambda) / (w + compliance). It may push (C < 0) and never pull.
LANE_INLINE lane8 advance_multiplier( float* lambda, lane8 c, const constrained* p, float compliance )
{
    const lane8 softness = lane8_set1( compliance ), before = lane8_load( lambda ), zero = lane8_zero();
    const lane8 sum = lane8_add( p->inverse_mass, softness );
    const lane8 wanted = lane8_add( before, lane8_div( lane8_neg( lane8_mul_add( softness, before, c ) ), sum ) );
    const lane8 after = lane8_select( lane8m_and( p->moves, lane8_lt( zero, wanted ) ), wanted, zero );
    lane8_store( lambda, after );
    return lane8_sub( after, before );
}

LANE_INLINE void hold_near_softly( const wisp_motion_constraint_args* args, int slot, constrained* p )
{
    const lane8v e = lane8v_sub( p->place, p->target );
    const lane8 length = lane8v_length( e ), one = lane8_set1( 1.0f );
    const lane8m has_direction = lane8_lt( lane8_zero(), length );
    const lane8 excess = lane8_sub( length, lane8_load( args->max_distance + slot ) );
    const lane8 change =
        advance_multiplier( args->lambda + 2 * (size_t)slot, lane8_neg( excess ), p, args->distance.compliance );
    const lane8 shift = lane8_div( lane8_mul( p->inverse_mass, change ), lane8_select( has_direction, length, one ) );
    const lane8m pulls =
        lane8m_and( lane8m_and( p->moves, has_direction ), lane8m_not( lane8_eq( change, lane8_zero() ) ) );
    p->place = lane8v_select( pulls, lane8v_mul_add( p->place, lane8_neg( shift ), e ), p->place );
    p->changed = lane8m_or( p->changed, pulls );
}

LANE_INLINE void stop_softly( const wisp_motion_constraint_args* args, int slot, constrained* p )
{
    backstop b = find_backstop( args, slot, p, true );
    if ( lane8m_any( b.is_inside ) )
    {
        const lane8 c = lane8_select( b.is_inside, b.depth, lane8_zero() );
        const lane8 change =
            advance_multiplier( args->lambda + 2 * (size_t)slot + 8, c, p, args->backstop.compliance );
        b.is_inside = lane8m_and( b.is_inside, lane8m_not( lane8_eq( change, lane8_zero() ) ) );
        const lane8v moved = lane8v_mul_add( p->place, lane8_mul( p->inverse_mass, change ), b.direction );
        p->place = lane8v_select( b.is_inside, moved, p->place );
        p->changed = lane8m_or( p->changed, b.is_inside );
    }
}

// ---- groups of eight ----

LANE_INLINE void add_velocity( const wisp_motion_constraint_args* args, int slot, const constrained* p,
                               lane8v before )
{
    float* row = args->velocity + 4 * (size_t)slot;
    lane8v v;
    lane8 none;
    lane8_load_xyzw_contiguous( row, &v.x, &v.y, &v.z, &none );
    const lane8v change = lane8v_scale( lane8v_sub( p->place, before ), lane8_set1( args->inverse_dt ) );
    v = lane8v_select( p->changed, lane8v_add( v, change ), v );
    lane8_store_xyzw_contiguous( row, v.x, v.y, v.z, none );
}

LANE_INLINE void constrain_group( const wisp_motion_constraint_args* args, int slot, bool has_backstop )
{
    float* row = args->position + 4 * (size_t)slot;
    constrained p;
    lane8_load_xyzw_contiguous( row, &p.place.x, &p.place.y, &p.place.z, &p.inverse_mass );
    const lane8v before = p.place;
    p.target = at_substep( args->target + 3 * (size_t)slot, args->displacement + 3 * (size_t)slot,
                           lane8_set1( args->left ) );
    p.moves = lane8_lt( lane8_zero(), p.inverse_mass );
    p.changed = lane8_lt( lane8_zero(), lane8_zero() );
    if ( args->lambda != NULL && args->distance.compliance > 0.0f )
    {
        hold_near_softly( args, slot, &p );
    }
    else
    {
        hold_near( args, slot, &p );
    }
    if ( has_backstop && args->lambda != NULL && args->backstop.compliance > 0.0f )
    {
        stop_softly( args, slot, &p );
    }
    else if ( has_backstop )
    {
        stop_behind( args, slot, &p );
    }
    if ( lane8m_any( p.changed ) )
    {
        lane8_store_xyzw_contiguous( row, p.place.x, p.place.y, p.place.z, p.inverse_mass );
        if ( args->velocity != NULL )
        {
            add_velocity( args, slot, &p, before );
        }
    }
}

void KERNEL( motion_constraint )( const wisp_motion_constraint_args* args, int begin, int end )
{
    const wisp_motion_constraint_args mine = *args;
    const lane8i mask = lane8i_loadu( MAGNITUDE_MASK );
    const bool has_backstop = mine.normal != NULL;
    for ( int slot = begin; slot < end; slot += 8 )
    {
        const size_t row = 4 * (size_t)slot;
        if ( mine.lambda == NULL && is_inside( mine.position + row, mine.bound + row, mask ) )
        {
            continue;
        }
        constrain_group( &mine, slot, has_backstop );
    }
}

// ---- once per step ----

// Start the path of each vector where it is now, and end it at its next value.
LANE_INLINE lane8v begin_path( float* end, float* change, const float* next, lane8 left )
{
    const lane8v to = lane8v_load( next ), displacement = lane8v_sub( to, at_substep( end, change, left ) );
    lane8v_store( end, to );
    lane8v_store( change, displacement );
    return displacement;
}

LANE_INLINE lane8 smallest_of_all( lane8 v )
{
    float each[8];
    lane8_storeu( each, v );
    float smallest = each[0];
    for ( int l = 1; l < 8; ++l )
    {
        smallest = each[l] < smallest ? each[l] : smallest;
    }
    return lane8_set1( smallest );
}

void KERNEL( motion_targets )( const wisp_motion_target_args* args, int begin, int end )
{
    const lane8 left = lane8_set1( args->left ), half = lane8_set1( 0.5f );
    for ( int slot = begin; slot < end; slot += 8 )
    {
        const size_t vector = 3 * (size_t)slot;
        const lane8v displacement =
            begin_path( args->target + vector, args->displacement + vector, args->next + vector, left );
        lane8 radius = lane8_load( args->max_distance + slot );
        if ( args->normal != NULL )
        {
            begin_path( args->normal + vector, args->normal_change + vector, args->next_normal + vector, left );
            radius = lane8_min( radius, lane8_load( args->backstop_distance + slot ) );
        }
        const lane8 longest = lane8_max( lane8_max( lane8_abs( displacement.x ), lane8_abs( displacement.y ) ),
                                         lane8_abs( displacement.z ) );
        const lane8 reach =
            lane8_sub( lane8_mul( radius, lane8_set1( CUBE_IN_SPHERE ) ), lane8_mul( half, longest ) );
        const lane8v middle = at_substep( args->target + vector, args->displacement + vector, half );
        lane8_store_xyzw_contiguous( args->bound + 4 * (size_t)slot, middle.x, middle.y, middle.z,
                                     smallest_of_all( reach ) );
    }
}
