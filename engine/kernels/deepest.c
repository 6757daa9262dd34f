// Edges and triangles on their way into a shape in closed form, eight at a time.
//
// The signed distance of a convex shape is a convex function. So its tangent
// plane at any point is nowhere above it, and a minimum along a line is bracketed
// by two tangents (cutting planes; Kelley 1960, "The cutting-plane method for
// solving convex programs"). Where they meet is a lower bound and the next point.
//
// A triangle is of interest only where its deepest point is inside. Then that
// is the point of its plane that is deepest: the foot of the end of the axis, or
// of the corner, that is nearest to the plane. Only where the plane crosses the
// shape the triangle is searched: along one side for the best of the segments
// parallel to the opposite one. Between the two tangents of a segment lies one
// that is level along it; it is the tangent of the outer search even where the
// distance has a kink.
//
// Conservative advancement finds where a path first comes too near: no point
// moves farther than the fastest corner.
#include "shape_lanes.h"

enum
{
    CUTS = 18,
    ADVANCES = 16,
};

// Fraction of the thickness: error of the deepest point.
static const float TOLERANCE = 0.005f;

// Of the thickness: a start that is less deep counts as on the surface.
static const float SHALLOW = 0.1f;

// Weight of a corner below which a point of a triangle is on its border.
static const float BORDER = 0.01f;

// ---- distances ----

// Selects the nearest face of a box for points inside; the first of equals.
LANE_INLINE nearest8 nearest_face( const wisp_shape_lanes* s, lane8v e )
{
    nearest8 best = { .distance = lane8_set1( -INFINITY ) };
    for ( int k = 0; k < 3; ++k )
    {
        const lane8v axis = load_vector( s->axis[k], true );
        const lane8 at = lane8v_dot( axis, e ), depth = lane8_sub( lane8_abs( at ), load_row( s->size[k], true ) );
        const lane8 side = lane8_select( lane8_lt( at, lane8_zero() ), lane8_set1( -1.0f ), lane8_set1( 1.0f ) );
        const lane8m is_nearer = lane8_gt( depth, best.distance );
        best.normal =
            k == 0 ? lane8v_scale( axis, side ) : lane8v_select( is_nearer, lane8v_scale( axis, side ), best.normal );
        best.distance = lane8_select( is_nearer, depth, best.distance );
    }
    return best;
}

LANE_INLINE nearest8 select_nearest( lane8m m, nearest8 a, nearest8 b )
{
    return ( nearest8 ){ lane8v_select( m, a.normal, b.normal ), lane8_select( m, a.distance, b.distance ) };
}

LANE_INLINE nearest8 signed_distance_of( const wisp_shape_lanes* s, wisp_shape_kind kind, lane8v e )
{
    nearest8 found = nearest_to( s, kind, true, e );
    const lane8m has_normal = lane8_gt( lane8v_dot( found.normal, found.normal ), lane8_set1( 0.5f ) );
    if ( lane8m_all( has_normal ) )
    {
        return found;
    }
    // on the axis, or inside a box
    nearest8 other = { load_vector( s->axis[0], true ), found.distance };
    other = kind == WISP_SHAPE_BOX ? nearest_face( s, e ) : other;
    return select_nearest( has_normal, found, other );
}

static nearest8 signed_distance( const wisp_shape_lanes* s, lane8v e )
{
    switch ( s->kind )
    {
        case WISP_SHAPE_SPHERE:
            return signed_distance_of( s, WISP_SHAPE_SPHERE, e );
        case WISP_SHAPE_CAPSULE:
            return signed_distance_of( s, WISP_SHAPE_CAPSULE, e );
        case WISP_SHAPE_BOX:
            return signed_distance_of( s, WISP_SHAPE_BOX, e );
        default:
            return signed_distance_of( s, WISP_SHAPE_TAPERED_CAPSULE, e );
    }
}

// ---- along a line ----

// A point of a line with a plane below the distance: f( x ) >= bound + normal ( x - here ).
typedef struct tangent8
{
    lane8 at;       // parameter on the line
    lane8 bound;    // m
    lane8 slope;    // m, along the whole line
    lane8 distance; // m, of the best point
    lane8 inner;    // of a triangle: where the best point is on its segment
    lane8v normal;
} tangent8;

typedef struct line8
{
    const wisp_shape_lanes* shape;
    // of a triangle the segment at t goes from `from + t along` by t `across`
    lane8v from, along, across;
    lane8 tolerance;
    lane8 left, most; // m, what is not deeper than the ends by this, or not less than this, is of no interest
} line8;

typedef tangent8 evaluate_fn( const line8* l, lane8 at, bool is_apex );

LANE_INLINE tangent8 select_tangent( lane8m m, const tangent8* a, const tangent8* b )
{
    return ( tangent8 ){ lane8_select( m, a->at, b->at ),       lane8_select( m, a->bound, b->bound ),
                         lane8_select( m, a->slope, b->slope ), lane8_select( m, a->distance, b->distance ),
                         lane8_select( m, a->inner, b->inner ), lane8v_select( m, a->normal, b->normal ) };
}

LANE_INLINE tangent8 evaluate( const line8* l, lane8 at, bool is_apex )
{
    (void)is_apex;
    const nearest8 s = signed_distance( l->shape, lane8v_mul_add( l->from, at, l->along ) );
    return ( tangent8 ){ at, s.distance, lane8v_dot( s.normal, l->along ), s.distance, lane8_zero(), s.normal };
}

LANE_INLINE lane8 plane_at( const tangent8* t, lane8 at )
{
    return lane8_mul_add( t->slope, lane8_sub( at, t->at ), t->bound );
}

// Finds where two tangents meet, which is below all between. @return a place there that is not close to their points
LANE_INLINE lane8 meeting_point( const tangent8* a, const tangent8* b, lane8* bound )
{
    const lane8 width = lane8_sub( b->at, a->at ), fall = lane8_sub( a->slope, b->slope );
    const lane8 rise = lane8_sub( lane8_sub( b->bound, a->bound ), lane8_mul( b->slope, width ) );
    const lane8 t = lane8_select( lane8_lt( fall, lane8_zero() ), lane8_div( rise, fall ),
                                  lane8_mul( lane8_set1( 0.5f ), width ) );
    const lane8 least = lane8_mul( lane8_set1( 0.02f ), width );
    *bound = lane8_mul_add( a->slope, t, a->bound );
    return lane8_add( a->at, lane8_max( least, lane8_min( lane8_sub( width, least ), t ) ) );
}

// Takes over the plane between both tangents that is level along the line.
LANE_INLINE tangent8 level_of( const tangent8* a, const tangent8* b, const tangent8* best )
{
    const lane8 share = lane8_div( a->slope, lane8_sub( a->slope, b->slope ) );
    const lane8 level = lane8_mul_add( share, lane8_sub( plane_at( b, best->at ), plane_at( a, best->at ) ),
                                       plane_at( a, best->at ) );
    tangent8 out = *best;
    out.normal = lane8v_mul_add( a->normal, share, lane8v_sub( b->normal, a->normal ) );
    out.bound = lane8_min( level, best->distance );
    return out;
}

// Finds the minimum on 0..1. @param limit receives what it would have to be below to be of interest
// @return the best point, and a plane below the distance that is level along the line or rises from its end into it
LANE_INLINE tangent8 minimise( const line8* l, evaluate_fn* evaluate_at, lane8m wanted, lane8* limit )
{
    const lane8 zero = lane8_zero();
    tangent8 a = evaluate_at( l, zero, true ), b = evaluate_at( l, lane8_set1( 1.0f ), false );
    *limit = lane8_min( lane8_sub( lane8_min( a.distance, b.distance ), l->left ), l->most );
    const lane8m is_first = lane8_ge( a.slope, zero ), is_last = lane8_le( b.slope, zero );
    lane8m between = lane8m_not( lane8m_or( is_first, is_last ) );
    const lane8m begins = lane8m_or( is_first, lane8m_and( between, lane8_le( a.distance, b.distance ) ) );
    tangent8 best = select_tangent( begins, &a, &b );
    lane8m open = lane8m_and( between, wanted );
    for ( int cut = 0; cut < CUTS; ++cut )
    {
        lane8 bound;
        const lane8 at = meeting_point( &a, &b, &bound );
        open = lane8m_and( open, lane8m_and( lane8_gt( lane8_sub( best.distance, bound ), l->tolerance ),
                                             lane8_lt( bound, *limit ) ) );
        if ( lane8m_any( open ) == false )
        {
            break;
        }
        const tangent8 next = evaluate_at( l, at, false );
        best = select_tangent( lane8m_and( open, lane8_lt( next.distance, best.distance ) ), &next, &best );
        const lane8m falls = lane8_lt( next.slope, zero ), is_flat = lane8m_and( open, lane8_eq( next.slope, zero ) );
        a = select_tangent( lane8m_and( open, falls ), &next, &a );
        b = select_tangent( lane8m_and_not( open, falls ), &next, &b );
        best = select_tangent( is_flat, &next, &best );
        between = lane8m_and_not( between, is_flat );
        open = lane8m_and_not( open, is_flat );
    }
    const tangent8 level = level_of( &a, &b, &best );
    return select_tangent( between, &level, &best );
}

// Finds the best point of the segment of a triangle at a fraction of its height.
static tangent8 minimise_across( const line8* l, lane8 at, bool is_apex )
{
    const lane8 zero = lane8_zero(), one = lane8_set1( 1.0f );
    if ( is_apex )
    {
        // the way down is the steeper of both sides
        tangent8 apex = evaluate( l, at, true );
        const lane8 side = lane8v_dot( apex.normal, l->across );
        apex.slope = lane8_add( apex.slope, lane8_min( side, zero ) );
        apex.inner = lane8_select( lane8_lt( side, zero ), one, zero );
        return apex;
    }
    const line8 segment = { .shape = l->shape,
                            .from = lane8v_mul_add( l->from, at, l->along ),
                            .along = lane8v_scale( l->across, at ),
                            .tolerance = lane8_mul( lane8_set1( 0.5f ), l->tolerance ),
                            .left = lane8_set1( -INFINITY ),
                            .most = lane8_set1( INFINITY ) };
    lane8 limit;
    tangent8 best = minimise( &segment, evaluate, lane8m_first( LANES ), &limit );
    best.inner = best.at;
    best.at = at;
    best.slope = lane8v_dot( best.normal, lane8v_mul_add( l->along, best.inner, l->across ) );
    return best;
}

// ---- primitives ----

typedef struct deepest8
{
    lane8 distance, bound; // m, of the deepest point; below all points
    lane8 weights[3];
} deepest8;

typedef struct paths8
{
    int count; // of corners
    lane8v from[3], to[3];
    lane8 displacement; // m, of the fastest corner
    lane8m counts;      // finite, and of interest
    lane8 thickness;
} paths8;

static deepest8 search_segment( const wisp_shape_lanes* s, const lane8v* p, lane8 tolerance, lane8 left, lane8 most,
                                lane8m wanted, lane8* limit )
{
    if ( s->kind == WISP_SHAPE_SPHERE )
    {
        // the point that is nearest to the centre
        const lane8v along = lane8v_sub( p[1], p[0] );
        const lane8 squared = lane8_max( lane8v_dot( along, along ), lane8_set1( FLT_MIN ) ),
                    t = clamp( lane8_div( lane8_neg( lane8v_dot( p[0], along ) ), squared ), lane8_zero(),
                               lane8_set1( 1.0f ) ),
                    radius = load_row( s->size[0], true ),
                    nearer = lane8_min( lane8v_dot( p[0], p[0] ), lane8v_dot( p[1], p[1] ) ),
                    distance = lane8_sub( lane8v_length( lane8v_mul_add( p[0], t, along ) ), radius );
        *limit = lane8_min( lane8_sub( lane8_sub( lane8_sqrt( nearer ), radius ), left ), most );
        return ( deepest8 ){ distance, distance, { lane8_sub( lane8_set1( 1.0f ), t ), t, lane8_zero() } };
    }
    const line8 l = { .shape = s,
                      .from = p[0],
                      .along = lane8v_sub( p[1], p[0] ),
                      .tolerance = tolerance,
                      .left = left,
                      .most = most };
    const tangent8 best = minimise( &l, evaluate, wanted, limit );
    return (
        deepest8 ){ best.distance, best.bound, { lane8_sub( lane8_set1( 1.0f ), best.at ), best.at, lane8_zero() } };
}

static deepest8 search_triangle( const wisp_shape_lanes* s, const lane8v* p, lane8 tolerance, lane8m wanted )
{
    const lane8 one = lane8_set1( 1.0f );
    const line8 l = { .shape = s,
                      .from = p[0],
                      .along = lane8v_sub( p[1], p[0] ),
                      .across = lane8v_sub( p[2], p[1] ),
                      .tolerance = tolerance,
                      .left = lane8_set1( -INFINITY ),
                      .most = lane8_set1( INFINITY ) };
    lane8 limit;
    const tangent8 best = minimise( &l, minimise_across, wanted, &limit );
    return ( deepest8 ){ best.distance,
                         best.bound,
                         { lane8_sub( one, best.at ), lane8_mul( best.at, lane8_sub( one, best.inner ) ),
                           lane8_mul( best.at, best.inner ) } };
}

// Bounds the distance by the tangent planes at the corners. @param corner receives the least distance of a corner
static lane8 bound_by_corners( const wisp_shape_lanes* s, const lane8v* p, int count, lane8* corner )
{
    lane8 bound = lane8_set1( -INFINITY );
    *corner = lane8_set1( INFINITY );
    for ( int k = 0; k < count; ++k )
    {
        const nearest8 at = signed_distance( s, p[k] );
        lane8 fall = lane8_zero();
        for ( int j = 0; j < count; ++j )
        {
            fall = lane8_min( fall, lane8v_dot( at.normal, lane8v_sub( p[j], p[k] ) ) );
        }
        bound = lane8_max( bound, lane8_add( at.distance, fall ) );
        *corner = lane8_min( *corner, at.distance );
    }
    return bound;
}

// The deepest point of the plane of a triangle.
typedef struct foot8
{
    deepest8 deepest;
    lane8m is_known; // the plane does not cross the shape
} foot8;

LANE_INLINE lane8v nearest_corner( const wisp_shape_lanes* s, lane8v normal )
{
    lane8v q = { lane8_zero(), lane8_zero(), lane8_zero() };
    for ( int k = 0; k < 3; ++k )
    {
        const lane8v axis = load_vector( s->axis[k], true );
        const lane8 half = load_row( s->size[k], true );
        const lane8m is_ahead = lane8_gt( lane8v_dot( normal, axis ), lane8_zero() );
        q = lane8v_mul_add( q, lane8_select( is_ahead, lane8_neg( half ), half ), axis );
    }
    return q;
}

// Selects the end of the axis that is nearer, or where the axis crosses the plane. @param side height of the origin times `length`
LANE_INLINE lane8v nearest_end( const wisp_shape_lanes* s, lane8v normal, lane8 length, lane8 side, lane8* radius,
                                lane8m* is_known )
{
    const bool is_ball = s->kind == WISP_SHAPE_SPHERE;
    const lane8 none = lane8_zero(), middle = load_row( s->size[0], true ),
                sine = is_ball ? none : load_row( s->size[4], true );
    const lane8 y[2] = { is_ball ? none : load_row( s->size[1], true ),
                         is_ball ? none : load_row( s->size[2], true ) };
    const lane8v axis = load_vector( s->axis[1], true );
    const lane8 rise = lane8v_dot( normal, axis );
    lane8 height[2], r[2], apart[2];
    for ( int k = 0; k < 2; ++k )
    {
        height[k] = lane8_mul_add( y[k], rise, side );
        r[k] = lane8_sub( middle, lane8_mul( sine, y[k] ) );
        apart[k] = lane8_sub( lane8_abs( height[k] ), lane8_mul( r[k], length ) );
    }
    const lane8m is_first = lane8_lt( apart[0], apart[1] ),
                 crosses = lane8_le( lane8_mul( height[0], height[1] ), none );
    const lane8 cut = lane8_div( lane8_neg( side ), rise );
    const bool is_straight = s->kind != WISP_SHAPE_TAPERED_CAPSULE;
    lane8 at = lane8_select( is_first, y[0], y[1] );
    at = is_straight && is_ball == false ? lane8_select( crosses, cut, at ) : at;
    *radius = lane8_select( is_first, r[0], r[1] );
    *is_known = is_straight ? lane8_ge( length, none ) : lane8m_not( crosses );
    return lane8v_scale( axis, at );
}

static foot8 foot_on_plane( const wisp_shape_lanes* s, const lane8v* p )
{
    const lane8v u = lane8v_sub( p[1], p[0] ), v = lane8v_sub( p[2], p[0] ), n = lane8v_cross( u, v );
    const lane8 squared = lane8v_dot( n, n ), length = lane8_sqrt( squared ),
                out = lane8_neg( lane8v_dot( n, p[0] ) );
    lane8 radius = lane8_zero();
    foot8 foot;
    lane8v q;
    if ( s->kind == WISP_SHAPE_BOX )
    {
        const lane8m is_below = lane8_lt( out, lane8_zero() );
        const lane8v back = { lane8_neg( n.x ), lane8_neg( n.y ), lane8_neg( n.z ) };
        const lane8v towards = lane8v_select( is_below, back, n );
        q = nearest_corner( s, towards );
        foot.is_known = lane8_gt( lane8v_dot( towards, lane8v_sub( q, p[0] ) ), lane8_zero() );
    }
    else
    {
        q = nearest_end( s, n, length, out, &radius, &foot.is_known );
    }
    const lane8v w = lane8v_sub( q, p[0] );
    const lane8 one = lane8_set1( 1.0f ), over = lane8_div( one, squared ),
                b = lane8_mul( lane8v_dot( lane8v_cross( w, v ), n ), over ),
                c = lane8_mul( lane8v_dot( lane8v_cross( u, w ), n ), over );
    const lane8 distance = lane8_sub( lane8_div( lane8_abs( lane8v_dot( n, w ) ), length ), radius );
    foot.deepest = ( deepest8 ){ distance, distance, { lane8_sub( lane8_sub( one, b ), c ), b, c } };
    return foot;
}

LANE_INLINE lane8m is_inside( const deepest8* d )
{
    const lane8 border = lane8_set1( BORDER );
    return lane8m_and( lane8_ge( d->weights[0], border ),
                       lane8m_and( lane8_ge( d->weights[1], border ), lane8_ge( d->weights[2], border ) ) );
}

// ---- paths ----

LANE_INLINE deepest8 select_deepest( lane8m m, const deepest8* a, const deepest8* b )
{
    deepest8 out = { .distance = lane8_select( m, a->distance, b->distance ),
                     .bound = lane8_select( m, a->bound, b->bound ) };
    for ( int k = 0; k < 3; ++k )
    {
        out.weights[k] = lane8_select( m, a->weights[k], b->weights[k] );
    }
    return out;
}

// Where paths meet a shape.
typedef struct meeting8
{
    lane8m meets;
    lane8 time;
    deepest8 deepest;
} meeting8;

// Finds the first time at which paths are as near as they are stopped at, or one shortly before.
static void advance( const wisp_shape_lanes* s, const paths8* path, lane8m open, meeting8* m )
{
    const lane8 one = lane8_set1( 1.0f ), none = lane8_set1( -INFINITY ), any = lane8_set1( INFINITY );
    const lane8 stop = lane8_mul( lane8_set1( STOP ), path->thickness ), half = lane8_mul( lane8_set1( 0.5f ), stop ),
                tolerance = lane8_mul( lane8_set1( TOLERANCE ), path->thickness ),
                fastest = lane8_max( path->displacement, lane8_set1( 1e-30f ) );
    lane8 time = lane8_zero();
    const lane8m all = open;
    deepest8 found = m->deepest;
    for ( int i = 0; i < ADVANCES && lane8m_any( open ); ++i )
    {
        lane8v p[3];
        for ( int k = 0; k < path->count; ++k )
        {
            p[k] = lane8v_mul_add( path->from[k], time, lane8v_sub( path->to[k], path->from[k] ) );
        }
        lane8 limit;
        const deepest8 now = path->count == 2 ? search_segment( s, p, tolerance, none, any, open, &limit )
                                              : search_triangle( s, p, tolerance, open );
        found = select_deepest( open, &now, &found );
        open = lane8m_and( open, lane8_gt( now.distance, stop ) );
        // not quite, so that rounding and the tolerance do not carry it through
        const lane8 step = lane8_div( lane8_sub( now.distance, half ), fastest ), ahead = lane8_sub( one, time );
        const lane8 next = lane8_select( lane8_lt( step, ahead ), lane8_add( time, step ), one );
        // what has been found stays that of its time
        time = lane8_select( i + 1 < ADVANCES ? open : lane8m_first( 0 ), next, time );
        open = lane8m_and( open, lane8_lt( time, one ) );
    }
    const lane8m stopped = lane8m_and( all, lane8_lt( time, one ) );
    m->deepest = select_deepest( stopped, &found, &m->deepest );
    m->time = lane8_select( stopped, time, m->time );
    // a point on the border of a triangle is left to its edges
    const lane8m counts = path->count == 2 ? stopped : lane8m_and( stopped, is_inside( &found ) );
    m->meets = lane8m_or( lane8m_and_not( m->meets, stopped ), counts );
}

static void meet_segments( const wisp_shape_lanes* s, const paths8* path, lane8 most, meeting8* m, lane8* bound )
{
    lane8 limit;
    m->deepest =
        search_segment( s, path->to, lane8_mul( lane8_set1( TOLERANCE ), path->thickness ),
                        lane8_mul( lane8_set1( LEFT_TO_CORNERS ), path->thickness ), most, path->counts, &limit );
    m->meets = lane8m_and( path->counts, lane8_lt( m->deepest.distance, limit ) );
    *bound = m->deepest.bound;
}

static void meet_triangles( const wisp_shape_lanes* s, const paths8* path, lane8 most, lane8 fast, meeting8* m,
                            lane8* bound )
{
    const foot8 foot = foot_on_plane( s, path->to );
    const lane8 none = lane8_set1( -INFINITY );
    m->deepest = foot.deepest;
    m->meets = lane8m_and( path->counts, lane8m_first( 0 ) );
    *bound = lane8_select( foot.is_known, foot.deepest.distance, none );
    const lane8m inside = lane8m_and( is_inside( &foot.deepest ), lane8_lt( foot.deepest.distance, most ) );
    const lane8m unsure = lane8m_or( lane8m_not( foot.is_known ), lane8m_not( lane8_gt( *bound, fast ) ) );
    if ( lane8m_any( lane8m_and( path->counts, lane8m_or( inside, unsure ) ) ) == false )
    {
        return;
    }
    lane8 corner;
    *bound = lane8_max( bound_by_corners( s, path->to, 3, &corner ), *bound );
    const lane8 left = lane8_mul( lane8_set1( LEFT_TO_CORNERS ), path->thickness ),
                limit = lane8_min( lane8_sub( corner, left ), most );
    m->meets = lane8m_and( lane8m_and( path->counts, foot.is_known ),
                           lane8m_and( inside, lane8_lt( foot.deepest.distance, limit ) ) );
    const lane8m searched = lane8m_and( lane8m_and_not( path->counts, foot.is_known ), lane8_lt( *bound, limit ) );
    if ( lane8m_any( searched ) )
    {
        const deepest8 d =
            search_triangle( s, path->to, lane8_mul( lane8_set1( TOLERANCE ), path->thickness ), searched );
        const lane8m found = lane8m_and( searched, lane8m_and( is_inside( &d ), lane8_lt( d.distance, limit ) ) );
        m->deepest = select_deepest( found, &d, &m->deepest );
        m->meets = lane8m_or( m->meets, found );
        *bound = lane8_select( searched, lane8_max( d.bound, *bound ), *bound );
    }
}

static meeting8 meet( const wisp_shape_lanes* s, const paths8* path )
{
    const lane8 twice = lane8_add( path->displacement, path->displacement ),
                stop = lane8_mul( lane8_set1( STOP ), path->thickness ), fast = lane8_add( stop, twice ),
                most = lane8_add( lane8_add( path->thickness, path->thickness ), path->displacement );
    meeting8 m = { .time = lane8_set1( 1.0f ) };
    lane8 bound, corner;
    path->count == 2 ? meet_segments( s, path, most, &m, &bound ) : meet_triangles( s, path, most, fast, &m, &bound );
    lane8m may_stop = lane8m_and_not( path->counts, lane8_gt( bound, fast ) );
    if ( lane8m_any( may_stop ) )
    {
        bound = bound_by_corners( s, path->from, path->count, &corner );
        may_stop = lane8m_and_not( may_stop, lane8_gt( lane8_sub( bound, path->displacement ), stop ) );
        advance( s, path, may_stop, &m );
    }
    return m;
}

// ---- a first look ----

// Bounds the distance by that of the corners: with r the radius of a ball that touches a round shape inside,
// ( r + bound )^2 >= ( r + corner )^2 - spread^2.
LANE_INLINE lane8 bound_around( const wisp_shape_lanes* s, wisp_shape_kind kind, const paths8* path, lane8* corner )
{
    const lane8 radius = blunt_radius( s, kind );
    *corner = nearest_to( s, kind, true, path->to[0] ).distance;
    for ( int k = 1; k < path->count; ++k )
    {
        *corner = lane8_min( *corner, nearest_to( s, kind, true, path->to[k] ).distance );
    }
    const lane8 out = lane8_add( radius, *corner ),
                left = lane8_sub( lane8_mul( out, out ), spread_of( path->to, path->count ) );
    // the last digits may be wrong
    return lane8_sub( lane8_sqrt( lane8_max( left, lane8_zero() ) ), lane8_mul( lane8_set1( 1.000001f ), radius ) );
}

// Bounds the distance from a box by that from the planes of its faces. @param between receives by how much a primitive is between two
// faces that are opposite, the most of all three pairs
LANE_INLINE lane8 bound_by_faces( const wisp_shape_lanes* s, const paths8* path, lane8* corner, lane8* between )
{
    lane8 squared[3] = { lane8_zero(), lane8_zero(), lane8_zero() }, bound = lane8_set1( -INFINITY );
    *between = bound;
    for ( int k = 0; k < 3; ++k )
    {
        const lane8v axis = load_vector( s->axis[k], true );
        const lane8 half = load_row( s->size[k], true );
        lane8 lowest = lane8_set1( INFINITY ), highest = lane8_neg( lowest );
        for ( int c = 0; c < path->count; ++c )
        {
            const lane8 at = lane8v_dot( axis, path->to[c] ),
                        out = lane8_max( lane8_sub( lane8_abs( at ), half ), lane8_zero() );
            squared[c] = lane8_mul_add( out, out, squared[c] );
            lowest = lane8_min( at, lowest );
            highest = lane8_max( at, highest );
        }
        bound = lane8_max( bound, lane8_sub( lane8_max( lowest, lane8_neg( highest ) ), half ) );
        *between = lane8_max( *between, lane8_sub( half, lane8_max( lane8_neg( lowest ), highest ) ) );
    }
    lane8 least = squared[0];
    for ( int c = 1; c < path->count; ++c )
    {
        least = lane8_min( least, squared[c] );
    }
    *corner = lane8_sqrt( least );
    return bound;
}

// Returns whether a path may meet the shape.
LANE_INLINE lane8m may_meet( const wisp_shape_lanes* s, wisp_shape_kind kind, const paths8* path )
{
    lane8 corner, between = lane8_set1( -INFINITY );
    const lane8 bound = kind == WISP_SHAPE_BOX ? bound_by_faces( s, path, &corner, &between )
                                               : bound_around( s, kind, path, &corner );
    const lane8 h = path->thickness, twice = lane8_add( path->displacement, path->displacement );
    const lane8 most = lane8_add( lane8_add( h, h ), path->displacement ),
                limit = lane8_min( lane8_sub( corner, lane8_mul( lane8_set1( LEFT_TO_CORNERS ), h ) ), most ),
                fast = lane8_mul_add( lane8_set1( STOP ), h, twice );
    lane8m is_left = lane8m_and( lane8_ge( bound, limit ), lane8_gt( bound, fast ) );
    if ( kind == WISP_SHAPE_BOX && path->count == 3 )
    {
        // outside of a box the inside of a triangle is nearest only to its corners, and these are between no faces
        const lane8m has_corners = lane8_le( between, lane8_add( most, path->displacement ) );
        is_left = lane8m_or( is_left, lane8m_and_not( lane8_gt( bound, lane8_zero() ), has_corners ) );
    }
    return lane8m_and_not( path->counts, is_left );
}

// ---- kernels ----

LANE_INLINE lane8v load_seen( const float* rows, const int32_t* index, const float ( *origin )[LANES] )
{
    lane8v p;
    lane8_load_xyz( rows, index, &p.x, &p.y, &p.z );
    return lane8v_sub( p, load_vector( origin, true ) );
}

LANE_INLINE paths8 load_paths( const wisp_primitive_paths* args, const wisp_shape_lanes* s, int corner_count,
                               int32_t ( *quads )[LANES], lane8 thickness )
{
    paths8 path = {
        .count = corner_count, .displacement = lane8_zero(), .counts = lane8m_first( LANES ), .thickness = thickness
    };
    const lane8 largest = lane8_set1( 1e18f );
    for ( int k = 0; k < path.count; ++k )
    {
        path.to[k] = load_seen( args->position, quads[k], s->at );
        const lane8v back = load_seen( args->previous, quads[k], s->was );
        path.from[k] = s->turns ? turn( s, back, true ) : back;
        path.displacement = lane8_max( lane8v_length( lane8v_sub( path.to[k], path.from[k] ) ), path.displacement );
        const lane8 size =
            lane8_add( lane8v_dot( path.to[k], path.to[k] ), lane8v_dot( path.from[k], path.from[k] ) );
        path.counts = lane8m_and( path.counts, lane8_lt( size, largest ) );
    }
    return path;
}

// Blends corners with the weights of meetings.
LANE_INLINE lane8v blend( const meeting8* m, const lane8v* corners, int count )
{
    lane8v p = lane8v_scale( corners[0], m->deepest.weights[0] );
    for ( int k = 1; k < count; ++k )
    {
        p = lane8v_mul_add( p, m->deepest.weights[k], corners[k] );
    }
    return p;
}

// The surface where the point of a meeting is nearest to it when it is stopped, or at the end, in the world.
typedef struct touched8
{
    lane8v point, normal, motion;
    lane8 start;
} touched8;

static touched8 touch( const wisp_primitive_paths* args, const wisp_shape_lanes* s, const paths8* path,
                       int32_t ( *quads )[LANES], const meeting8* m )
{
    const lane8v from = blend( m, path->from, path->count ), to = blend( m, path->to, path->count ),
                 p = lane8v_mul_add( from, m->time, lane8v_sub( to, from ) ), at = load_vector( s->at, true );
    const nearest8 found = signed_distance( s, p );
    const lane8v surface = lane8v_mul_add( p, lane8_neg( found.distance ), found.normal );
    touched8 t = { .point = lane8v_add( at, surface ),
                   .normal = found.normal,
                   .motion = lane8v_sub( at, load_vector( s->was, true ) ) };
    if ( s->turns )
    {
        t.motion = lane8v_add( t.motion, lane8v_sub( surface, turn_back( s, surface, true ) ) );
    }
    t.start = lane8_sub( lane8v_dot( found.normal, lane8v_sub( from, surface ) ), path->thickness );
    const lane8m deep = lane8_lt( t.start, lane8_mul( lane8_set1( -SHALLOW ), path->thickness ) );
    if ( lane8m_any( deep ) )
    {
        // the surface is curved between start and end
        const lane8 exact = lane8_sub( signed_distance( s, from ).distance, path->thickness );
        t.start = lane8_select( deep, lane8_max( t.start, lane8_min( exact, lane8_zero() ) ), t.start );
    }
    lane8 along = lane8_zero();
    for ( int k = 0; k < path->count; ++k )
    {
        lane8v old;
        lane8_load_xyz( args->previous, quads[k], &old.x, &old.y, &old.z );
        along = lane8_mul_add( m->deepest.weights[k], lane8v_dot( found.normal, old ), along );
    }
    t.start = lane8_sub( t.start, along );
    return t;
}

static int write_meetings( const meeting8* m, const touched8* t, const int32_t* primitives,
                           wisp_primitive_meeting* out )
{
    enum
    {
        EACH = sizeof( wisp_primitive_meeting ) / sizeof( float ) - 1, // but for the number
    };
    const lane8 each[EACH] = { m->time,
                               m->deepest.weights[0],
                               m->deepest.weights[1],
                               m->deepest.weights[2],
                               t->point.x,
                               t->point.y,
                               t->point.z,
                               t->normal.x,
                               t->normal.y,
                               t->normal.z,
                               t->motion.x,
                               t->motion.y,
                               t->motion.z,
                               t->start };
    float rows[EACH][LANES];
    int met = 0;
    for ( int k = 0; k < EACH; ++k )
    {
        lane8_storeu( rows[k], each[k] );
    }
    for ( uint32_t bits = lane8m_bits( m->meets ); bits != 0; bits &= bits - 1 )
    {
        const int l = __builtin_ctz( bits );
        float one[EACH];
        for ( int k = 0; k < EACH; ++k )
        {
            one[k] = rows[k][l];
        }
        out[met].primitive = primitives[l];
        memcpy( (char*)( out + met++ ) + offsetof( wisp_primitive_meeting, time ), one, sizeof( one ) );
    }
    return met;
}

LANE_INLINE int meet_kind( const wisp_primitive_paths* args, const wisp_shape_lanes* shape, wisp_shape_kind kind,
                           int corner_count, const float* thickness, const int32_t* primitives, int count,
                           wisp_primitive_meeting* out )
{
    int met = 0;
    for ( int i = 0; i < count; i += LANES )
    {
        int32_t quads[3][LANES];
        find_quads( args->corners, corner_count, primitives + i, count - i, quads );
        const lane8 h = thickness != NULL ? lane8_loadu( thickness + i ) : lane8_set1( shape->thickness[0] );
        paths8 path = load_paths( args, shape, corner_count, quads, h );
        const lane8m may = lane8m_and( may_meet( shape, kind, &path ), lane8m_first( count - i ) );
        if ( lane8m_any( may ) )
        {
            path.counts = may;
            const meeting8 m = meet( shape, &path );
            if ( lane8m_any( m.meets ) )
            {
                const touched8 t = touch( args, shape, &path, quads, &m );
                met += write_meetings( &m, &t, primitives + i, out + met );
            }
        }
    }
    return met;
}

#define MEET( kind, corner_count ) meet_kind( args, shape, kind, corner_count, thickness, primitives, count, out )

int KERNEL( meet_shape )( const wisp_primitive_paths* args, const wisp_shape_lanes* shape, const float* thickness,
                          const int32_t* primitives, int count, wisp_primitive_meeting* out )
{
    const bool is_edges = args->corner_count == 2;
    switch ( shape->kind )
    {
        case WISP_SHAPE_SPHERE:
            return is_edges ? MEET( WISP_SHAPE_SPHERE, 2 ) : MEET( WISP_SHAPE_SPHERE, 3 );
        case WISP_SHAPE_CAPSULE:
            return is_edges ? MEET( WISP_SHAPE_CAPSULE, 2 ) : MEET( WISP_SHAPE_CAPSULE, 3 );
        case WISP_SHAPE_BOX:
            return is_edges ? MEET( WISP_SHAPE_BOX, 2 ) : MEET( WISP_SHAPE_BOX, 3 );
        default:
            return is_edges ? MEET( WISP_SHAPE_TAPERED_CAPSULE, 2 ) : MEET( WISP_SHAPE_TAPERED_CAPSULE, 3 );
    }
}
