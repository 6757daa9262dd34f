// Closest points of pairs, eight pairs at a time, and the direction between them.
//
// A contact pushes along the normal. The plane perpendicular to the normal must separate the pair; this matters
// more than an exact distance. Let e be the rounding error of a float and l the size of a pair. The difference of
// points at distance d has an error of e l, and its direction an error of e l / d. At the far end of an edge that
// is e l^2 / d, which may exceed d. Three rules keep the error at e l:
//
//   - The foot on a segment is measured from the nearer end. Near an end nothing cancels, and the sign of one
//     product decides whether the foot is beyond the end.
//   - Where the foot is inside a segment, the component of the difference along the segment is subtracted.
//   - Where both sides extend around the closest points (a face, or crossing segments), the normal is the cross
//     product of their directions, and the difference gives only its sign.
//
// Both kernels minimise d = r - x g - y h: for a triangle r = p - a, g = b - a and h = c - a; for segments
// r = a - c, g = a - b and h = d - c. The components along g are first subtracted from h and r, which is a QR
// decomposition. So d has an error of e l even for sliver triangles and nearly parallel segments. Where x and y are
// out of range, the nearest edge is used instead.
//
// Instructions of a group depend on each other, and the reorder window covers only a third of them. So work is
// split into two loops over a few groups. The second loop has the square roots and divisions, which have the
// longest latency.
#include "kernel_isa.h"

enum
{
    BLOCK = 8, // groups
};

// Minimum of |h less its part along g|^2 over |h|^2. Below it the difference has no significant digits.
#define MIN_WIDTH 1.6e-13f

// Ratio of squared distance to squared width above which the difference has a more accurate direction than the
// cross product. A somewhat larger value hardly matters, and lets the cross product decide between edges at equal
// distance.
#define WIDE 16.0f

// Factors of the squared distance that rank edges at equal distance, except for rounding. The inside of an edge is
// preferred to an end, since an end is the limit of feet inside. Of two insides, the one whose direction has all
// other points behind is preferred.
#define OF_BEYOND ( 1.0f + 8.0f * FLT_EPSILON )
#define OF_END ( 1.0f + 16.0f * FLT_EPSILON )

typedef struct segment
{
    lane8v along;  // from the end where the parameter is 0
    lane8 inverse; // 1 / squared length; finite for length 0
} segment;

// A pair of closest points: parameters x and y, and the vector between the points.
typedef struct candidate
{
    lane8v between;
    lane8 squared;
    segment on;    // edge that contains the foot
    lane8v inward; // towards the other points of the sides; d must not point there
    lane8m inside; // foot is inside the edge
    lane8 x, y;
} candidate;

typedef struct foot
{
    lane8v between;
    lane8 squared;
    lane8 t;
    lane8m inside;
} foot;

LANE_INLINE lane8 squared_of( lane8v v )
{
    return lane8v_dot( v, v );
}

LANE_INLINE segment segment_of( lane8v along, lane8 squared )
{
    const lane8 one = lane8_set1( 1.0f );
    return ( segment ){ along, lane8_div( one, lane8_max( squared, lane8_set1( FLT_MIN ) ) ) };
}

// Selects the foot measured from the nearer end.
// @param from_first, from_second the point less each end  @param second whether the second end is nearer
LANE_INLINE foot foot_on( segment on, lane8v from_first, lane8v from_second, lane8m second )
{
    const lane8 zero = lane8_zero(), one = lane8_set1( 1.0f );
    const lane8v from = lane8v_select( second, from_second, from_first );
    const lane8 lower = lane8_select( second, lane8_set1( -1.0f ), zero ), upper = lane8_add( lower, one );
    lane8 t = lane8_mul( lane8v_dot( from, on.along ), on.inverse );
    t = lane8_min( lane8_max( t, lower ), upper );
    foot f;
    f.between = lane8v_sub( from, lane8v_scale( on.along, t ) );
    f.squared = squared_of( f.between );
    f.inside = lane8m_not( lane8_eq( t, zero ) );
    f.t = lane8_sub( t, lower );
    return f;
}

LANE_INLINE candidate candidate_of( foot f, segment on, lane8v inward, lane8 x, lane8 y )
{
    const lane8m beyond = lane8_gt( lane8v_dot( f.between, inward ), lane8_zero() );
    const lane8 inside = lane8_select( beyond, lane8_set1( OF_BEYOND ), lane8_set1( 1.0f ) );
    const lane8 squared = lane8_mul( f.squared, lane8_select( f.inside, inside, lane8_set1( OF_END ) ) );
    return ( candidate ){ f.between, squared, on, inward, f.inside, x, y };
}

LANE_INLINE candidate nearer( candidate a, candidate b )
{
    const lane8m m = lane8_lt( b.squared, a.squared );
    return ( candidate ){
        .between = lane8v_select( m, b.between, a.between ),
        .squared = lane8_select( m, b.squared, a.squared ),
        .on = { lane8v_select( m, b.on.along, a.on.along ), lane8_select( m, b.on.inverse, a.on.inverse ) },
        .inward = lane8v_select( m, b.inward, a.inward ),
        .inside = lane8m_or( lane8m_and( m, b.inside ), lane8m_and_not( a.inside, m ) ),
        .x = lane8_select( m, b.x, a.x ),
        .y = lane8_select( m, b.y, a.y ),
    };
}

// Minimum of |r - x g - y h| over all x and y.
typedef struct intersection
{
    lane8v between;
    lane8v width;  // h less its part along g
    lane8 squared; // |width|^2
    lane8m wide;
    lane8 x, y;
} intersection;

LANE_INLINE intersection cross_at( segment g, lane8 g_squared, lane8v h, lane8 h_squared, lane8v r )
{
    const lane8 least = lane8_set1( FLT_MIN );
    const lane8 slant = lane8_mul( lane8v_dot( h, g.along ), g.inverse ),
                ahead = lane8_mul( lane8v_dot( r, g.along ), g.inverse );
    const lane8v across_g = lane8v_sub( r, lane8v_scale( g.along, ahead ) );
    intersection c;
    c.width = lane8v_sub( h, lane8v_scale( g.along, slant ) );
    c.squared = squared_of( c.width );
    c.wide = lane8m_and( lane8_gt( c.squared, lane8_mul( h_squared, lane8_set1( MIN_WIDTH ) ) ),
                         lane8_ge( lane8_mul( c.squared, g_squared ), least ) );
    c.y = lane8_div( lane8v_dot( across_g, c.width ), lane8_max( c.squared, least ) );
    c.x = lane8_sub( ahead, lane8_mul( c.y, slant ) );
    c.between = lane8v_sub( across_g, lane8v_scale( c.width, c.y ) );
    return c;
}

// Rounds a number in [0, 1] so that x and 1 - x sum to exactly 1.
LANE_INLINE lane8 whole_fraction( lane8 x )
{
    const lane8 one = lane8_set1( 1.0f );
    return lane8_sub( one, lane8_sub( one, x ) );
}

// Values of eight pairs that the second loop needs.
typedef struct nearest
{
    lane8v between;
    segment on;      // segment to which `between` is perpendicular
    lane8m straight; // `on` is valid: the foot is not at an end
    lane8v inward;
    lane8m inside;  // foot is inside an edge
    lane8m allowed; // minimum is inside both sides
    lane8m wide;
    lane8v product; // cross product of the two directions
    lane8 width_squared;
    lane8 poison; // 0, or NaN if a coordinate of the pair is not finite, since comparisons may have skipped it
} nearest;

// Collects the values.
// @param best nearest edge
LANE_INLINE nearest nearest_of( candidate best, intersection c, lane8m allowed, segment g, lane8 poison )
{
    return ( nearest ){
        .between = lane8v_select( allowed, c.between, best.between ),
        .on = { lane8v_select( allowed, g.along, best.on.along ),
                lane8_select( allowed, g.inverse, best.on.inverse ) },
        .straight = lane8m_or( allowed, best.inside ),
        .inward = best.inward,
        .inside = best.inside,
        .allowed = allowed,
        .wide = c.wide,
        .product = lane8v_cross( g.along, c.width ),
        .width_squared = c.squared,
        .poison = poison,
    };
}

// Subtracts the component of d along an edge, in the lanes of `mask`.
LANE_INLINE lane8v subtract_along( lane8v d, segment on, lane8m mask )
{
    const lane8 excess = lane8_mul( lane8v_dot( d, on.along ), on.inverse );
    return lane8v_sub( d, lane8v_scale( on.along, lane8_select( mask, excess, lane8_zero() ) ) );
}

LANE_INLINE void store_normal( float ( *normal )[8], const nearest* n, lane8v d, lane8 squared )
{
    const lane8 zero = lane8_zero(), one = lane8_set1( 1.0f );
    // if the other points of the sides are nearer along d, this edge was nearest only by rounding
    const lane8m beyond = lane8m_and( n->inside, lane8_gt( lane8v_dot( d, n->inward ), zero ) );
    const lane8m near = lane8_lt( squared, lane8_mul( n->width_squared, lane8_set1( WIDE ) ) );
    const lane8m across = lane8m_and( lane8m_and( n->wide, near ), lane8m_or( n->allowed, beyond ) );
    const lane8v direction = lane8v_select( across, n->product, d );
    const lane8m turned = lane8_lt( lane8v_dot( direction, d ), zero );
    const lane8 sign = lane8_select( turned, lane8_set1( -1.0f ), one );
    const lane8 length = lane8_sqrt( lane8_max( squared_of( direction ), lane8_set1( FLT_MIN ) ) );
    const lane8 scale = lane8_select( lane8_eq( squared, zero ), zero, lane8_div( sign, length ) );
    const lane8v unit = lane8v_scale( direction, scale );
    lane8_storeu( normal[0], unit.x );
    lane8_storeu( normal[1], unit.y );
    lane8_storeu( normal[2], unit.z );
}

// One subtraction suffices for the length. The direction needs two: where the sides touch, nearly all of d is along
// the edge.
LANE_INLINE void store_answer( const wisp_closest_args* args, int group, const nearest* n, bool requests_normal )
{
    const lane8v once = subtract_along( n->between, n->on, n->straight );
    const lane8 all = squared_of( once );
    const lane8 squared = lane8_select( lane8_lt( all, lane8_set1( FLT_MIN ) ), lane8_zero(), all );
    lane8_storeu( args->distance + 8 * (ptrdiff_t)group, lane8_add( lane8_sqrt( squared ), n->poison ) );
    if ( requests_normal )
    {
        const lane8v twice = subtract_along( once, n->on, n->straight );
        const lane8m nothing = lane8_lt( squared_of( twice ), lane8_set1( FLT_MIN ) );
        store_normal( args->normal[group], n, lane8v_select( nothing, once, twice ), squared );
    }
}

LANE_INLINE lane8v load_point( const wisp_closest_args* args, int group, int k )
{
    lane8v p;
    lane8_load_xyz( args->xyzw, args->point_x4[k] + 8 * (ptrdiff_t)group, &p.x, &p.y, &p.z );
    return p;
}

// Minimises over a triangle; x and y are the weights of b and c.
LANE_INLINE nearest solve_triangle( const wisp_closest_args* args, int group, bool requests_weights )
{
    const lane8 zero = lane8_zero(), one = lane8_set1( 1.0f );
    const lane8v p = load_point( args, group, 0 ), a = load_point( args, group, 1 ), b = load_point( args, group, 2 ),
                 c = load_point( args, group, 3 );
    const lane8v ap = lane8v_sub( p, a ), bp = lane8v_sub( p, b ), cp = lane8v_sub( p, c );
    const lane8v to_b = lane8v_sub( b, a ), to_c = lane8v_sub( c, a ), b_to_c = lane8v_sub( c, b );
    const lane8 ab_squared = squared_of( to_b ), ac_squared = squared_of( to_c );
    const lane8 from_a = squared_of( ap ), from_b = squared_of( bp ), from_c = squared_of( cp );
    const segment ab = segment_of( to_b, ab_squared ), ac = segment_of( to_c, ac_squared ),
                  bc = segment_of( b_to_c, squared_of( b_to_c ) );
    const lane8v to_a = { lane8_neg( to_b.x ), lane8_neg( to_b.y ), lane8_neg( to_b.z ) };

    const foot on_ab = foot_on( ab, ap, bp, lane8_lt( from_b, from_a ) ),
               on_ac = foot_on( ac, ap, cp, lane8_lt( from_c, from_a ) ),
               on_bc = foot_on( bc, bp, cp, lane8_lt( from_c, from_b ) );
    const candidate best = nearer(
        nearer( candidate_of( on_ab, ab, to_c, on_ab.t, zero ), candidate_of( on_ac, ac, to_b, zero, on_ac.t ) ),
        candidate_of( on_bc, bc, to_a, lane8_sub( one, on_bc.t ), on_bc.t ) );

    intersection face = cross_at( ab, ab_squared, to_c, ac_squared, ap );
    face.x = whole_fraction( face.x );
    face.y = whole_fraction( face.y );
    const lane8m to_the_right = lane8m_and( lane8_ge( face.x, zero ), lane8_ge( face.y, zero ) );
    const lane8m below = lane8_ge( lane8_sub( lane8_sub( one, face.x ), face.y ), zero );
    const lane8m allowed = lane8m_and( face.wide, lane8m_and( to_the_right, below ) );
    const lane8 poison = lane8_mul( lane8_add( ab_squared, ac_squared ), zero );
    if ( requests_weights )
    {
        const lane8 x = whole_fraction( lane8_select( allowed, face.x, best.x ) ),
                    y = whole_fraction( lane8_select( allowed, face.y, best.y ) );
        lane8_storeu( args->weight[group][0], one );
        lane8_storeu( args->weight[group][1], lane8_sub( y, lane8_sub( one, x ) ) );
        lane8_storeu( args->weight[group][2], lane8_neg( x ) );
        lane8_storeu( args->weight[group][3], lane8_neg( y ) );
    }
    return nearest_of( best, face, allowed, ab, poison );
}

// Minimises over two segments; x is measured from a and y from c.
LANE_INLINE nearest solve_segments( const wisp_closest_args* args, int group, bool requests_weights )
{
    const lane8 zero = lane8_zero(), one = lane8_set1( 1.0f );
    const lane8v a = load_point( args, group, 0 ), b = load_point( args, group, 1 ), c = load_point( args, group, 2 ),
                 d = load_point( args, group, 3 );
    const lane8v ac = lane8v_sub( a, c ), ad = lane8v_sub( a, d ), bc = lane8v_sub( b, c ), bd = lane8v_sub( b, d );
    const lane8v back = lane8v_sub( a, b ), ahead = lane8v_sub( b, a );
    const lane8v to_d = lane8v_sub( d, c ), to_c = lane8v_sub( c, d );
    const lane8 first_squared = squared_of( back ), second_squared = squared_of( to_d );
    const lane8 ac_squared = squared_of( ac ), ad_squared = squared_of( ad ), bc_squared = squared_of( bc ),
                bd_squared = squared_of( bd );
    // differences point from the second side to the first, so the first segment is reversed
    const segment first = segment_of( back, first_squared ), second = segment_of( to_d, second_squared );

    const foot of_a = foot_on( second, ac, ad, lane8_lt( ad_squared, ac_squared ) ),
               of_b = foot_on( second, bc, bd, lane8_lt( bd_squared, bc_squared ) ),
               of_c = foot_on( first, ac, bc, lane8_lt( bc_squared, ac_squared ) ),
               of_d = foot_on( first, ad, bd, lane8_lt( bd_squared, ad_squared ) );
    const candidate best = nearer(
        nearer( candidate_of( of_a, second, back, zero, of_a.t ), candidate_of( of_b, second, ahead, one, of_b.t ) ),
        nearer( candidate_of( of_c, first, to_d, of_c.t, zero ), candidate_of( of_d, first, to_c, of_d.t, one ) ) );

    const intersection both = cross_at( first, first_squared, to_d, second_squared, ac );
    const lane8m on_first = lane8m_and( lane8_ge( both.x, zero ), lane8_le( both.x, one ) ),
                 on_second = lane8m_and( lane8_ge( both.y, zero ), lane8_le( both.y, one ) );
    const lane8m allowed = lane8m_and( both.wide, lane8m_and( on_first, on_second ) );
    const lane8 poison = lane8_mul( lane8_add( first_squared, second_squared ), zero );
    if ( requests_weights )
    {
        const lane8 x = whole_fraction( lane8_select( allowed, both.x, best.x ) ),
                    y = whole_fraction( lane8_select( allowed, both.y, best.y ) );
        lane8_storeu( args->weight[group][0], lane8_sub( one, x ) );
        lane8_storeu( args->weight[group][1], x );
        lane8_storeu( args->weight[group][2], lane8_sub( y, one ) );
        lane8_storeu( args->weight[group][3], lane8_neg( y ) );
    }
    return nearest_of( best, both, allowed, first, poison );
}

LANE_INLINE void run_triangle( const wisp_closest_args* args, int begin, int end, bool requests_all )
{
    nearest found[BLOCK];
    for ( int block = begin; block < end; block += BLOCK )
    {
        const int count = end - block < BLOCK ? end - block : BLOCK;
        for ( int k = 0; k < count; ++k )
        {
            found[k] = solve_triangle( args, block + k, requests_all );
        }
        for ( int k = 0; k < count; ++k )
        {
            store_answer( args, block + k, &found[k], requests_all );
        }
    }
}

LANE_INLINE void run_segments( const wisp_closest_args* args, int begin, int end, bool requests_all )
{
    nearest found[BLOCK];
    for ( int block = begin; block < end; block += BLOCK )
    {
        const int count = end - block < BLOCK ? end - block : BLOCK;
        for ( int k = 0; k < count; ++k )
        {
            found[k] = solve_segments( args, block + k, requests_all );
        }
        for ( int k = 0; k < count; ++k )
        {
            store_answer( args, block + k, &found[k], requests_all );
        }
    }
}

void KERNEL( closest_triangle )( const wisp_closest_args* args, int begin, int end )
{
    const wisp_closest_args mine = *args;
    if ( mine.weight != NULL )
    {
        run_triangle( &mine, begin, end, true );
    }
    else
    {
        run_triangle( &mine, begin, end, false );
    }
}

void KERNEL( closest_segments )( const wisp_closest_args* args, int begin, int end )
{
    const wisp_closest_args mine = *args;
    if ( mine.weight != NULL )
    {
        run_segments( &mine, begin, end, true );
    }
    else
    {
        run_segments( &mine, begin, end, false );
    }
}
