// Operations that every backend has by composition, so that they are written once.
// Included once per width with LANE_P (lane8, lane16) and LANE_COUNT; therefore no include guard.

#define P( name ) LANE_JOIN( LANE_P, name )

LANE_INLINE LANE_P P( _zero )( void )
{
    return P( _set1 )( 0.0f );
}

LANE_INLINE LANE_P P( _mul_add )( LANE_P a, LANE_P b, LANE_P c )
{
    return P( _add )( P( _mul )( a, b ), c );
}

LANE_INLINE LANE_P P( _neg )( LANE_P a )
{
    return P( _cast_float )( P( i_xor )( P( _cast_int )( a ), P( i_set1 )( INT32_MIN ) ) );
}

LANE_INLINE LANE_P P( _abs )( LANE_P a )
{
    return P( _cast_float )( P( i_and )( P( _cast_int )( a ), P( i_set1 )( INT32_MAX ) ) );
}

LANE_INLINE P( m ) P( _gt )( LANE_P a, LANE_P b )
{
    return P( _lt )( b, a );
}

LANE_INLINE P( m ) P( _ge )( LANE_P a, LANE_P b )
{
    return P( _le )( b, a );
}

LANE_INLINE bool P( m_any )( P( m ) a )
{
    return P( m_bits )( a ) != 0;
}

LANE_INLINE bool P( m_all )( P( m ) a )
{
    return P( m_bits )( a ) == ( 1u << LANE_COUNT ) - 1u;
}

LANE_INLINE P( m ) P( m_first )( int n )
{
    return P( i_lt )( P( i_iota )(), P( i_set1 )( n ) );
}

#undef P
