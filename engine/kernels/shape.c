// Closest points of shapes in closed form, eight particles at a time. The operations are those of
// wisp_shape_closest(), in doubles and in the same order, so the bits are the same.
#include "kernel_isa.h"

#include "lane_double_vec.h"
#include "wisp/module/taper.h"

enum
{
    LANES = 8,
};

typedef struct surface8
{
    lane8dv point, normal;
    lane8d distance;
} surface8;

LANE_INLINE lane8d clamp( lane8d x, lane8d lower, lane8d upper )
{
    const lane8d at_most = lane8d_select( lane8d_lt( upper, x ), upper, x );
    return lane8d_select( lane8d_lt( x, lower ), lower, at_most );
}

// ---- shapes ----

LANE_INLINE surface8 closest_to_plane( lane8dv p )
{
    const lane8d zero = lane8d_set1( 0.0 );
    return ( surface8 ){ { p.x, zero, p.z }, { zero, lane8d_set1( 1.0 ), zero }, p.y };
}

// Computes the surface around a point q, the centre of a sphere or the nearest point on the axis of a capsule.
// @param fallback normal at q
LANE_INLINE surface8 closest_round( lane8dv p, lane8dv q, lane8d r, const double fallback[3] )
{
    const lane8d zero = lane8d_set1( 0.0 );
    const lane8dv away = lane8dv_sub( p, q );
    const lane8d length = lane8dv_length( away );
    const lane8dm has_direction = lane8d_lt( zero, length );
    const lane8dv unit = lane8dv_scale( away, lane8d_div( lane8d_set1( 1.0 ), length ) );
    const lane8dv normal = {
        lane8d_select( has_direction, unit.x, lane8d_set1( fallback[0] ) ),
        lane8d_select( has_direction, unit.y, lane8d_set1( fallback[1] ) ),
        lane8d_select( has_direction, unit.z, lane8d_set1( fallback[2] ) ),
    };
    const lane8dv reach = lane8dv_scale( normal, r );
    return ( surface8 ){
        { lane8d_add( q.x, reach.x ), lane8d_add( q.y, reach.y ), lane8d_add( q.z, reach.z ) },
        normal,
        lane8d_sub( length, r ),
    };
}

LANE_INLINE surface8 closest_to_sphere( const wisp_shape* shape, lane8dv p )
{
    const lane8d zero = lane8d_set1( 0.0 );
    const double up[3] = { 0.0, 1.0, 0.0 };
    return closest_round( p, ( lane8dv ){ zero, zero, zero }, lane8d_set1( (double)shape->radius ), up );
}

LANE_INLINE surface8 closest_to_capsule( const wisp_shape* shape, lane8dv p )
{
    const lane8d zero = lane8d_set1( 0.0 );
    const double half = (double)shape->half_length;
    const lane8d y = clamp( p.y, lane8d_set1( -half ), lane8d_set1( half ) );
    const double aside[3] = { 1.0, 0.0, 0.0 };
    return closest_round( p, ( lane8dv ){ zero, y, zero }, lane8d_set1( (double)shape->radius ), aside );
}

LANE_INLINE surface8 closest_to_tapered_capsule( const wisp_shape* shape, lane8dv p )
{
    const lane8d zero = lane8d_set1( 0.0 );
    const wisp_taper t = wisp_taper_of( shape );
    const lane8d rho = lane8d_sqrt( lane8d_add( lane8d_mul( p.x, p.x ), lane8d_mul( p.z, p.z ) ) );
    const lane8d y = clamp( lane8d_sub( p.y, lane8d_mul( lane8d_set1( t.slope ), rho ) ), lane8d_set1( t.lower ),
                            lane8d_set1( t.upper ) );
    const lane8d radius = lane8d_sub( lane8d_set1( t.middle ), lane8d_mul( lane8d_set1( t.sine ), y ) );
    const double aside[3] = { t.cosine, t.sine, 0.0 };
    return closest_round( p, ( lane8dv ){ zero, y, zero }, radius, aside );
}

// Selects the nearest face for points inside or on the surface; the first of equals.
LANE_INLINE surface8 closest_inside_box( lane8dv p, lane8dv h )
{
    const lane8d zero = lane8d_set1( 0.0 ), one = lane8d_set1( 1.0 );
    const lane8d at[3] = { p.x, p.y, p.z }, half[3] = { h.x, h.y, h.z };
    lane8d most = lane8d_sub( lane8d_abs( at[0] ), half[0] ), best = zero;
    for ( int k = 1; k < 3; ++k )
    {
        const lane8d depth = lane8d_sub( lane8d_abs( at[k] ), half[k] );
        const lane8dm deeper = lane8d_lt( most, depth );
        best = lane8d_select( deeper, lane8d_set1( (double)k ), best );
        most = lane8d_select( deeper, depth, most );
    }
    lane8d point[3], normal[3];
    for ( int k = 0; k < 3; ++k )
    {
        const lane8d side = lane8d_select( lane8d_lt( at[k], zero ), lane8d_set1( -1.0 ), one );
        const lane8d off = lane8d_abs( lane8d_sub( best, lane8d_set1( (double)k ) ) );
        const lane8dm is_other = lane8d_lt( zero, off );
        const lane8d to_face = lane8d_sub( lane8d_mul( side, half[k] ), at[k] );
        point[k] = lane8d_add( at[k], lane8d_select( is_other, zero, to_face ) );
        normal[k] = lane8d_select( is_other, zero, side );
    }
    return ( surface8 ){ { point[0], point[1], point[2] }, { normal[0], normal[1], normal[2] }, most };
}

LANE_INLINE surface8 closest_to_box( const wisp_shape* shape, lane8dv p )
{
    const lane8d zero = lane8d_set1( 0.0 );
    const wisp_vec3 e = shape->half_extent;
    const lane8dv h = { lane8d_set1( (double)e.x ), lane8d_set1( (double)e.y ), lane8d_set1( (double)e.z ) };
    const lane8dv q = { clamp( p.x, lane8d_set1( -(double)e.x ), h.x ),
                        clamp( p.y, lane8d_set1( -(double)e.y ), h.y ),
                        clamp( p.z, lane8d_set1( -(double)e.z ), h.z ) };
    const lane8dv away = lane8dv_sub( p, q );
    const lane8d length = lane8dv_length( away );
    const lane8dm is_outside = lane8d_lt( zero, length );
    surface8 s = { q, lane8dv_scale( away, lane8d_div( lane8d_set1( 1.0 ), length ) ), length };
    if ( lane8dm_bits( is_outside ) != 255u )
    {
        const surface8 inside = closest_inside_box( p, h );
        s = ( surface8 ){ lane8dv_select( is_outside, s.point, inside.point ),
                          lane8dv_select( is_outside, s.normal, inside.normal ),
                          lane8d_select( is_outside, length, inside.distance ) };
    }
    return s;
}

// `kind` is a constant after inlining.
LANE_INLINE surface8 closest_to( const wisp_shape* shape, wisp_shape_kind kind, lane8dv p )
{
    switch ( kind )
    {
        case WISP_SHAPE_SPHERE:
            return closest_to_sphere( shape, p );
        case WISP_SHAPE_CAPSULE:
            return closest_to_capsule( shape, p );
        case WISP_SHAPE_BOX:
            return closest_to_box( shape, p );
        case WISP_SHAPE_TAPERED_CAPSULE:
            return closest_to_tapered_capsule( shape, p );
        default:
            return closest_to_plane( p );
    }
}

// ---- candidates ----

// Lists the positions, in the packed arrays, of those that the caller has to look at one by one.
LANE_INLINE int find_near( const wisp_shape_query_args* args, wisp_shape_kind kind, int count,
                           int32_t* special_count )
{
    const lane8 thickness = lane8_set1( args->thickness ), shallow = lane8_set1( -args->shallow );
    int near = 0, special = 0;
    for ( int i = 0; i < count; i += LANES )
    {
        const lane8v to = load_three( args->to, i ), from = load_three( args->from, i );
        const surface8 s = closest_to( &args->shape, kind, lane8dv_widen( to ) );
        const lane8v point = lane8dv_narrow( s.point ), normal = lane8dv_narrow( s.normal );
        const lane8 distance = lane8d_narrow( s.distance ), reach = lane8_loadu( args->reach + i ),
                    path = lane8_loadu( args->path + i );
        const lane8 start = lane8_sub( lane8v_dot( normal, lane8v_sub( from, point ) ), thickness );

        const lane8m is_near = lane8m_and( lane8_le( distance, reach ), lane8m_first( count - i ) );
        const lane8m meets = lane8_le( lane8_abs( distance ), path ), is_deep = lane8_lt( start, shallow );
        const lane8 clear = lane8_select( lane8_gt( distance, lane8_zero() ), distance, lane8_set1( INFINITY ) );
        lane8_storeu( args->clearance + i, lane8_select( is_near, clear, reach ) );

        const uint32_t bits = lane8m_bits( is_near );
        uint32_t wanted = lane8m_bits( lane8m_and( is_near, lane8m_or( meets, is_deep ) ) );
        for ( ; wanted != 0; wanted &= wanted - 1 )
        {
            const uint32_t below = ( wanted & ( 0u - wanted ) ) - 1u;
            args->special[special++] = near + __builtin_popcount( bits & below );
        }
        pack_three( args->point, near, point, bits );
        pack_three( args->normal, near, normal, bits );
        pack_lanes( args->distance + near, distance, bits );
        pack_lanes( args->start + near, start, bits );
        near += lane8i_compress_store( args->near + near, lane8i_add( lane8i_set1( i ), lane8i_iota() ), bits );
    }
    *special_count = special;
    return near;
}

int KERNEL( query_shape )( const wisp_shape_query_args* args, int count, int32_t* special_count )
{
    const wisp_shape_query_args mine = *args;
    switch ( mine.shape.kind )
    {
        case WISP_SHAPE_SPHERE:
            return find_near( &mine, WISP_SHAPE_SPHERE, count, special_count );
        case WISP_SHAPE_CAPSULE:
            return find_near( &mine, WISP_SHAPE_CAPSULE, count, special_count );
        case WISP_SHAPE_BOX:
            return find_near( &mine, WISP_SHAPE_BOX, count, special_count );
        case WISP_SHAPE_TAPERED_CAPSULE:
            return find_near( &mine, WISP_SHAPE_TAPERED_CAPSULE, count, special_count );
        default:
            return find_near( &mine, WISP_SHAPE_PLANE, count, special_count );
    }
}
