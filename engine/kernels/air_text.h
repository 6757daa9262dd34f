// Air on a triangle and on a vertex, written once for both widths. Included with LANE_P; therefore no include guard.

#define P( name ) LANE_JOIN( LANE_P, name )

// Sums over the triangles of a vertex: with twice the area, and with three times the wind, squared or once.
typedef struct P( _air_sum )
{
    P( v ) force;
    LANE_P rate; // m^3/s, the rate of drag
} P( _air_sum );

// Computes the force on a triangle. With c = 2 A n, a triangle of any area has 2 A |u . n| = |c . u| and the lift
//
//   2 A |u . n| ( |u| n' - (u . n') / |u| u ) = (c . u) / (|c| |u|) ( |u|^2 c - (c . u) u )
//
// so drag needs no root, and lift one root and one division. Here u is three times the relative wind. Triangles with
// a corner that is not finite have no force.
LANE_INLINE P( _air_sum ) P( _triangle_air )( P( v ) c, P( v ) u, LANE_P drag, LANE_P lift, bool lifts )
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
    P( _air_sum ) air = { P( v_scale )( u, P( _mul )( flow, drag ) ), P( _mul )( flow, P( _add )( drag, lift ) ) };
    if ( lifts )
    {
        const P( m ) flows = P( _ge )( squares, P( _set1 )( FLT_MIN ) );
        squares = P( _select )( flows, squares, one );
        const LANE_P cosine = P( _mul )( P( _div )( through, squares ), P( _sqrt )( squares ) ); // side by side
        const P( v ) across = P( v_sub )( P( v_scale )( c, uu ), P( v_scale )( u, through ) );
        air.force = P( v_mul_add )( air.force, P( _mul )( cosine, lift ), across );
    }
    return air;
}

LANE_INLINE P( _air_sum ) P( _add_air )( P( _air_sum ) a, P( _air_sum ) b )
{
    return ( P( _air_sum ) ){ P( v_add )( a.force, b.force ), P( _add )( a.rate, b.rate ) };
}

// Lift is perpendicular to the relative wind and does no work in its frame. An explicit step across a velocity lengthens it all the
// same, by the square of the step, which makes a light vertex faster and faster: only the part along it changes the relative speed.
LANE_INLINE P( v ) P( _keep_energy )( P( v ) wind, P( v ) old, P( v ) step )
{
    const P( v ) before = P( v_sub )( old, wind ), after = P( v_add )( before, step );
    const LANE_P square = P( v_dot )( before, before );
    const LANE_P squares = P( _mul )( square, P( v_dot )( after, after ) );
    const P( m ) moves = P( _le )( P( _set1 )( FLT_MIN ), squares );
    const LANE_P along = P( _abs )( P( _add )( square, P( v_dot )( before, step ) ) );
    const LANE_P kept = P( _div )( along, P( _sqrt )( P( _select )( moves, squares, P( _set1 )( 1.0f ) ) ) );
    return P( v_select )( moves, P( v_add )( wind, P( v_scale )( after, kept ) ), P( v_add )( old, step ) );
}

// Apply the force. Explicit drag can reverse the velocity of a light vertex in one step; a factor implicit in the
// rate keeps it below the wind's.
// @param lifts some lane lifts; `lifting` says which do
LANE_INLINE P( v ) P( _blow )( P( v ) wind, LANE_P density, P( v ) old, LANE_P weight, LANE_P dt,
                               const P( _air_sum ) * sum, bool lifts, P( m ) lifting )
{
    const LANE_P one = P( _set1 )( 1.0f ), zero = P( _zero )();
    const P( m ) moves = P( _lt )( zero, weight );
    // a third of 1/2 rho
    const LANE_P reach =
        P( _mul )( P( _select )( moves, P( _mul )( dt, weight ), zero ), P( _div )( density, P( _set1 )( 36.0f ) ) );
    const LANE_P change = P( _div )( reach, P( _add )( one, P( _mul )( reach, sum->rate ) ) );
    const P( v ) step = P( v_scale )( sum->force, P( _mul )( change, P( _set1 )( 1.0f / 3.0f ) ) );
    P( v ) blown = P( v_add )( old, step );
    if ( lifts )
    {
        blown = P( v_select )( lifting, P( _keep_energy )( wind, old, step ), blown );
    }
    return P( v_select )( moves, blown, old );
}

#undef P
