// Shapes in closed form in a substep, and their closest points, eight points at
// a time, along the axes of the world, relative to the shape: a point goes from
// f, as seen from where the shape was, to e.
#pragma once

#include "kernel_isa.h"

enum
{
    LANES = 8,
};

typedef struct nearest8
{
    lane8v normal;
    lane8 distance;
} nearest8;

// A row of numbers, or one number for all lanes. `alike` is a constant after
// inlining, as is a kind of shape.
LANE_INLINE lane8 load_row( const float* row, bool alike )
{
    return alike ? lane8_set1( row[0] ) : lane8_loadu( row );
}

LANE_INLINE lane8v load_vector( const float ( *rows )[LANES], bool alike )
{
    return ( lane8v ){ load_row( rows[0], alike ), load_row( rows[1], alike ), load_row( rows[2], alike ) };
}

LANE_INLINE lane8 clamp( lane8 x, lane8 lower, lane8 upper )
{
    return lane8_max( lower, lane8_min( x, upper ) );
}

LANE_INLINE nearest8 nearest_round( lane8v away, lane8 radius )
{
    const lane8 length = lane8v_length( away );
    return ( nearest8 ){ lane8v_scale( away, lane8_div( lane8_set1( 1.0f ), length ) ), lane8_sub( length, radius ) };
}

LANE_INLINE nearest8 nearest_on_box( const wisp_shape_lanes* s, lane8v e, bool alike )
{
    lane8v away = { lane8_zero(), lane8_zero(), lane8_zero() };
    for ( int k = 0; k < 3; ++k )
    {
        const lane8v axis = load_vector( s->axis[k], alike );
        const lane8 half = load_row( s->size[k], alike ), at = lane8v_dot( axis, e );
        away = lane8v_mul_add( away, lane8_sub( at, clamp( at, lane8_neg( half ), half ) ), axis );
    }
    return nearest_round( away, lane8_zero() );
}

// Computes the closest point of a shape from outside; inside, a distance that
// is not positive. `kind` is a constant after inlining.
LANE_INLINE nearest8 nearest_to( const wisp_shape_lanes* s, wisp_shape_kind kind, bool alike, lane8v e )
{
    if ( kind == WISP_SHAPE_BOX )
    {
        return nearest_on_box( s, e, alike );
    }
    const lane8 radius = load_row( s->size[0], alike );
    if ( kind == WISP_SHAPE_SPHERE )
    {
        return nearest_round( e, radius );
    }
    const lane8v axis = load_vector( s->axis[1], alike );
    const lane8 along = lane8v_dot( axis, e );
    if ( kind == WISP_SHAPE_PLANE )
    {
        return ( nearest8 ){ axis, along };
    }
    const lane8 lower = load_row( s->size[1], alike ), upper = load_row( s->size[2], alike );
    if ( kind == WISP_SHAPE_CAPSULE )
    {
        const lane8 y = clamp( along, lower, upper );
        return nearest_round( lane8v_mul_add( e, lane8_neg( y ), axis ), radius );
    }
    // as in taper.h
    const lane8 rho = lane8v_length( lane8v_mul_add( e, lane8_neg( along ), axis ) );
    const lane8 y = clamp( lane8_sub( along, lane8_mul( load_row( s->size[3], alike ), rho ) ), lower, upper );
    return nearest_round( lane8v_mul_add( e, lane8_neg( y ), axis ),
                          lane8_sub( radius, lane8_mul( load_row( s->size[4], alike ), y ) ) );
}

// Selects points that are surely farther from a shape than a limit above 0, by
// squares alone: nearest_to() has a root and a quotient. False for NaN.
LANE_INLINE lane8m is_beyond( const wisp_shape_lanes* s, wisp_shape_kind kind, bool alike, lane8v e, lane8 limit )
{
    lane8 radius = lane8_zero(), squared = lane8_zero();
    if ( kind == WISP_SHAPE_BOX )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const lane8 at = lane8_abs( lane8v_dot( load_vector( s->axis[k], alike ), e ) ),
                        out = lane8_max( lane8_sub( at, load_row( s->size[k], alike ) ), lane8_zero() );
            squared = lane8_mul_add( out, out, squared );
        }
    }
    else
    {
        radius = load_row( s->size[0], alike );
        if ( kind == WISP_SHAPE_CAPSULE || kind == WISP_SHAPE_TAPERED_CAPSULE )
        {
            const lane8v axis = load_vector( s->axis[1], alike );
            const lane8 lower = load_row( s->size[1], alike ), upper = load_row( s->size[2], alike ),
                        sine = load_row( s->size[4], alike );
            e = lane8v_mul_add( e, lane8_neg( clamp( lane8v_dot( axis, e ), lower, upper ) ), axis );
            radius = kind == WISP_SHAPE_CAPSULE
                         ? radius
                         : lane8_sub( radius, lane8_min( lane8_mul( sine, lower ), lane8_mul( sine, upper ) ) );
        }
        squared = lane8v_dot( e, e );
    }
    const lane8 both = lane8_add( radius, limit );
    return lane8_gt( squared, lane8_mul( lane8_set1( 1.00001f ), lane8_mul( both, both ) ) );
}

LANE_INLINE lane8v turn( const wisp_shape_lanes* s, lane8v v, bool alike )
{
    return ( lane8v ){ lane8v_dot( load_vector( s->turn[0], alike ), v ),
                       lane8v_dot( load_vector( s->turn[1], alike ), v ),
                       lane8v_dot( load_vector( s->turn[2], alike ), v ) };
}

LANE_INLINE lane8v turn_back( const wisp_shape_lanes* s, lane8v v, bool alike )
{
    const lane8v x = lane8v_scale( load_vector( s->turn[0], alike ), v.x );
    return lane8v_mul_add( lane8v_mul_add( x, v.y, load_vector( s->turn[1], alike ) ), v.z,
                           load_vector( s->turn[2], alike ) );
}

// Fractions of the thickness: distance at which a path is stopped, what corners may leave.
static const float STOP = 0.1f, LEFT_TO_CORNERS = 0.05f;

// Bounds the squared distance of points of primitives from their nearest corner: by half a segment; by the radius of the circle around a
// triangle, and 1 / sqrt 3 of its longest side.
LANE_INLINE lane8 spread_of( const lane8v* p, int count )
{
    const lane8v u = lane8v_sub( p[1], p[0] );
    const lane8 a = lane8v_dot( u, u );
    if ( count == 2 )
    {
        return lane8_mul( lane8_set1( 0.25f ), a );
    }
    const lane8v v = lane8v_sub( p[2], p[0] ), w = lane8v_sub( p[2], p[1] ), n = lane8v_cross( u, v );
    const lane8 b = lane8v_dot( v, v ), c = lane8v_dot( w, w ),
                area = lane8_mul( lane8_set1( 4.0f ), lane8v_dot( n, n ) );
    const lane8 around = lane8_div( lane8_mul( lane8_mul( a, b ), c ), area );
    return lane8_min( around, lane8_mul( lane8_set1( 0.334f ), lane8_max( lane8_max( a, b ), c ) ) );
}

// Computes the radius of a ball that touches a round shape inside, anywhere.
LANE_INLINE lane8 blunt_radius( const wisp_shape_lanes* s, wisp_shape_kind kind )
{
    const lane8 radius = load_row( s->size[0], true ), sine = load_row( s->size[4], true );
    return kind != WISP_SHAPE_TAPERED_CAPSULE
               ? radius
               : lane8_sub( radius, lane8_max( lane8_mul( sine, load_row( s->size[1], true ) ),
                                               lane8_mul( sine, load_row( s->size[2], true ) ) ) );
}

LANE_INLINE void find_quads( const int32_t* of_all, int corner_count, const int32_t* primitives, int count,
                             int32_t ( *quads )[LANES] )
{
    for ( int l = 0; l < LANES; ++l )
    {
        const int32_t* corners = of_all + (size_t)primitives[l < count ? l : 0] * (size_t)corner_count;
        for ( int k = 0; k < corner_count; ++k )
        {
            quads[k][l] = 4 * corners[k];
        }
    }
}
