// Air on the triangles around a vertex, written once for both widths. Included with LANE_P; therefore no include guard.

#define P( name ) LANE_JOIN( LANE_P, name )

typedef struct P( _air )
{
    P( v ) wind;
    LANE_P drag, lift, rate; // factors of the sums, of C_d, C_l and both
} P( _air );

// Sums over the triangles of a vertex, without the factors of P( _air ).
typedef struct P( _air_sum )
{
    P( v ) drag, lift;
    LANE_P flow; // m^3/s, the rate of drag
} P( _air_sum );

// Adds one triangle. With c = 2 A n, a triangle of any area has 2 A |u . n| = |c . u| and the lift
//
//   2 A |u . n| ( |u| n' - (u . n') / |u| u ) = (c . u) / (|c| |u|) ( |u|^2 c - (c . u) u )
//
// so drag needs no root, and lift one root and one division. Here u is three times the relative wind. Triangles with
// a corner that is not finite add nothing.
LANE_INLINE void P( _add_triangle )( P( v ) c, P( v ) u, bool lifts, P( _air_sum ) * sum )
{
    const LANE_P one = P( _set1 )( 1.0f ), zero = P( _zero )();
    LANE_P uu = P( v_dot )( u, u ), squares = P( _mul )( P( v_dot )( c, c ), uu );
    const P( m ) finite = P( _le )( squares, P( _set1 )( FLT_MAX ) );
    if ( P( m_all )( finite ) == false ) // hardly ever
    {
        const P( v ) nothing = { zero, zero, zero };
        c = P( v_select )( finite, c, nothing );
        u = P( v_select )( finite, u, nothing );
        uu = P( _select )( finite, uu, zero );
        squares = P( _select )( finite, squares, zero );
    }
    const LANE_P through = P( v_dot )( c, u ), flow = P( _abs )( through );
    sum->drag = P( v_mul_add )( sum->drag, flow, u );
    sum->flow = P( _add )( sum->flow, flow );
    if ( lifts )
    {
        const P( m ) flows = P( _ge )( squares, P( _set1 )( FLT_MIN ) );
        squares = P( _select )( flows, squares, one );
        const LANE_P cosine = P( _mul )( P( _div )( through, squares ), P( _sqrt )( squares ) ); // side by side
        const P( v ) across = P( v_sub )( P( v_scale )( c, uu ), P( v_scale )( u, through ) );
        sum->lift = P( v_mul_add )( sum->lift, cosine, across );
    }
}

// Lift is perpendicular to the relative wind and does no work in its frame. An explicit step across a velocity lengthens it all the
// same, by the square of the step, which makes a light vertex faster and faster: take that square out of the relative speed.
LANE_INLINE P( v ) P( _keep_energy )( const P( _air ) * air, P( v ) velocity, P( v ) step )
{
    const LANE_P zero = P( _zero )();
    const P( v ) relative = P( v_sub )( velocity, air->wind );
    const LANE_P square = P( v_dot )( relative, relative );
    const P( m ) moves = P( _lt )( zero, square );
    const LANE_P left = P( _max )( P( _sub )( square, P( v_dot )( step, step ) ), zero );
    const LANE_P kept = P( _sqrt )( P( _div )( left, P( _select )( moves, square, P( _set1 )( 1.0f ) ) ) );
    return P( v_add )( air->wind, P( v_scale )( relative, kept ) );
}

// Apply the force. Explicit drag can reverse the velocity of a light vertex in one step; a factor implicit in the
// rate keeps it below the wind's.
// @param lifts some lane lifts; `lifting` says which do
LANE_INLINE P( v ) P( _blow )( const P( _air ) * air, P( v ) old, LANE_P weight, LANE_P dt, const P( _air_sum ) * sum,
                               bool lifts, P( m ) lifting )
{
    const LANE_P one = P( _set1 )( 1.0f ), zero = P( _zero )();
    const P( m ) moves = P( _lt )( zero, weight );
    const LANE_P reach = P( _select )( moves, P( _mul )( dt, weight ), zero );
    const LANE_P change = P( _div )( reach, P( _add )( one, P( _mul )( reach, P( _mul )( air->rate, sum->flow ) ) ) );
    P( v ) blown = P( v_mul_add )( old, P( _mul )( change, air->drag ), sum->drag );
    if ( lifts )
    {
        const P( v ) step = P( v_scale )( sum->lift, P( _mul )( change, air->lift ) );
        blown = P( v_select )( lifting, P( _keep_energy )( air, P( v_add )( blown, step ), step ), blown );
    }
    return P( v_select )( moves, blown, old );
}

#undef P
