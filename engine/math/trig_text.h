// Sine, cosine and arc tangent from + - * / sqrt and comparisons only: the same bits everywhere.
// Included once per width with LANE_P (lane1, lane8, lane16), so that scalar and lanes share one text; therefore no
// include guard. The polynomials are those of Cephes (Moshier, single precision); what trig.h promises is measured
// by tests/engine/test_math.c.

#define P( name ) LANE_JOIN( LANE_P, name )
#define TRIG_NUMBER( value ) P( _set1 )( value )

// The sign bit of `from` flips `to`.
LANE_INLINE LANE_P P( _trig_flip )( LANE_P to, P( i ) from )
{
    P( i ) sign = P( i_and )( from, P( i_set1 )( INT32_MIN ) );
    return P( _cast_float )( P( i_xor )( P( _cast_int )( to ), sign ) );
}

LANE_INLINE void P( _sincos )( LANE_P x, LANE_P* sine, LANE_P* cosine )
{
    // The quadrant, by truncation: how many times pi/2 is to be taken off |x|.
    LANE_P magnitude = P( _abs )( x );
    P( i ) quadrant = P( _truncate )( P( _mul_add )( magnitude, TRIG_NUMBER( 0.636619772f ), TRIG_NUMBER( 0.5f ) ) );
    LANE_P turns = P( _from_int )( quadrant );

    // Cody and Waite: pi/2 in three parts. The first two have so few bits that their products and differences are
    // exact up to |x| = 10000; only the third rounds.
    LANE_P r = P( _sub )( magnitude, P( _mul )( turns, TRIG_NUMBER( 1.5703125f ) ) );
    r = P( _sub )( r, P( _mul )( turns, TRIG_NUMBER( 4.837512969970703125e-4f ) ) );
    r = P( _sub )( r, P( _mul )( turns, TRIG_NUMBER( 7.54978995489188216e-8f ) ) );

    // Beyond the range r means nothing, but its sine and cosine stay in [-1, 1]. Within the range |r| passes pi/4 by
    // less than 0.001, where the quadrant was rounded. NaN passes: it is the second operand.
    r = P( _max )( TRIG_NUMBER( -0.79f ), P( _min )( TRIG_NUMBER( 0.79f ), r ) );

    LANE_P z = P( _mul )( r, r );
    LANE_P s = P( _mul_add )( z, TRIG_NUMBER( -1.9515295891e-4f ), TRIG_NUMBER( 8.3321608736e-3f ) );
    s = P( _mul_add )( z, s, TRIG_NUMBER( -1.6666654611e-1f ) );
    s = P( _mul_add )( P( _mul )( z, r ), s, r );
    LANE_P c = P( _mul_add )( z, TRIG_NUMBER( 2.443315711809948e-5f ), TRIG_NUMBER( -1.388731625493765e-3f ) );
    c = P( _mul_add )( z, c, TRIG_NUMBER( 4.166664568298827e-2f ) );
    c = P( _mul_add )( P( _mul )( z, z ), c, P( _mul_add )( z, TRIG_NUMBER( -0.5f ), TRIG_NUMBER( 1.0f ) ) );

    // Odd quadrants swap the two; bit 1 of the quadrant is the sign of the sine, of its successor that of the cosine.
    P( i ) one = P( i_set1 )( 1 );
    P( m ) swap = P( i_eq )( P( i_and )( quadrant, one ), one );
    P( i ) sine_sign = P( i_xor )( P( i_shift_left )( quadrant, 30 ), P( _cast_int )( x ) );
    P( i ) cosine_sign = P( i_shift_left )( P( i_add )( quadrant, one ), 30 );
    *sine = P( _trig_flip )( P( _select )( swap, c, s ), sine_sign );
    *cosine = P( _trig_flip )( P( _select )( swap, s, c ), cosine_sign );
}

LANE_INLINE LANE_P P( _atan2 )( LANE_P y, LANE_P x )
{
    // Fold into the octant 0 <= small <= large. The selects keep a NaN of either argument.
    LANE_P ax = P( _abs )( x );
    LANE_P ay = P( _abs )( y );
    P( m ) steep = P( _gt )( ay, ax );
    LANE_P large = P( _select )( steep, ay, ax );
    LANE_P small = P( _select )( steep, ax, ay );

    // Above tan( pi/8 ) turn back by pi/4: atan( s / l ) = pi/4 + atan( (s - l) / (s + l) ), one division for both.
    P( m ) turned = P( _gt )( small, P( _mul )( large, TRIG_NUMBER( 0.414213562f ) ) );
    LANE_P numerator = P( _select )( turned, P( _sub )( small, large ), small );
    LANE_P denominator = P( _select )( turned, P( _add )( small, large ), large );
    P( m ) is_origin = P( _eq )( large, P( _zero )() );
    LANE_P t = P( _div )( numerator, P( _select )( is_origin, TRIG_NUMBER( 1.0f ), denominator ) );

    LANE_P z = P( _mul )( t, t );
    LANE_P p = P( _mul_add )( z, TRIG_NUMBER( 8.05374449538e-2f ), TRIG_NUMBER( -1.38776856032e-1f ) );
    p = P( _mul_add )( z, p, TRIG_NUMBER( 1.99777106478e-1f ) );
    p = P( _mul_add )( z, p, TRIG_NUMBER( -3.33329491539e-1f ) );
    LANE_P angle = P( _mul_add )( P( _mul )( t, z ), p, t );
    angle = P( _add )( angle, P( _select )( turned, TRIG_NUMBER( 0.785398163f ), P( _zero )() ) );

    // Unfold. A negative zero is a zero: x decides by comparison, only y by its sign bit.
    angle = P( _select )( steep, P( _sub )( TRIG_NUMBER( 1.57079633f ), angle ), angle );
    P( m ) left = P( _lt )( x, P( _zero )() );
    angle = P( _select )( left, P( _sub )( TRIG_NUMBER( 3.14159265f ), angle ), angle );
    return P( _trig_flip )( angle, P( _cast_int )( y ) );
}

#undef TRIG_NUMBER
#undef P
