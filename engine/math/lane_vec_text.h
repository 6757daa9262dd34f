// Vectors in lanes, written once for both widths. Included with LANE_P and LANE_COUNT; therefore no include guard.

#define P( name ) LANE_JOIN( LANE_P, name )

typedef struct P( v )
{
    LANE_P x, y, z;
} P( v );

LANE_INLINE P( v ) P( v_set1 )( wisp_vec3 a )
{
    return ( P( v ) ){ P( _set1 )( a.x ), P( _set1 )( a.y ), P( _set1 )( a.z ) };
}

LANE_INLINE P( v ) P( v_load )( const float* rows )
{
    return ( P( v ) ){ P( _load )( rows ), P( _load )( rows + LANE_COUNT ), P( _load )( rows + 2 * LANE_COUNT ) };
}

LANE_INLINE void P( v_store )( float* rows, P( v ) a )
{
    P( _store )( rows, a.x );
    P( _store )( rows + LANE_COUNT, a.y );
    P( _store )( rows + 2 * LANE_COUNT, a.z );
}

LANE_INLINE P( v ) P( v_add )( P( v ) a, P( v ) b )
{
    return ( P( v ) ){ P( _add )( a.x, b.x ), P( _add )( a.y, b.y ), P( _add )( a.z, b.z ) };
}

LANE_INLINE P( v ) P( v_sub )( P( v ) a, P( v ) b )
{
    return ( P( v ) ){ P( _sub )( a.x, b.x ), P( _sub )( a.y, b.y ), P( _sub )( a.z, b.z ) };
}

LANE_INLINE P( v ) P( v_scale )( P( v ) a, LANE_P s )
{
    return ( P( v ) ){ P( _mul )( a.x, s ), P( _mul )( a.y, s ), P( _mul )( a.z, s ) };
}

LANE_INLINE P( v ) P( v_mul_add )( P( v ) a, LANE_P s, P( v ) b )
{
    return P( v_add )( a, P( v_scale )( b, s ) );
}

LANE_INLINE LANE_P P( v_dot )( P( v ) a, P( v ) b )
{
    return P( _add )( P( _add )( P( _mul )( a.x, b.x ), P( _mul )( a.y, b.y ) ), P( _mul )( a.z, b.z ) );
}

LANE_INLINE P( v ) P( v_cross )( P( v ) a, P( v ) b )
{
    return ( P( v ) ){
        P( _sub )( P( _mul )( a.y, b.z ), P( _mul )( a.z, b.y ) ),
        P( _sub )( P( _mul )( a.z, b.x ), P( _mul )( a.x, b.z ) ),
        P( _sub )( P( _mul )( a.x, b.y ), P( _mul )( a.y, b.x ) ),
    };
}

LANE_INLINE LANE_P P( v_length )( P( v ) a )
{
    return P( _sqrt )( P( v_dot )( a, a ) );
}

LANE_INLINE P( v ) P( v_select )( P( m ) m, P( v ) a, P( v ) b )
{
    return ( P( v ) ){ P( _select )( m, a.x, b.x ), P( _select )( m, a.y, b.y ), P( _select )( m, a.z, b.z ) };
}

LANE_INLINE P( v ) P( v_rotate )( P( v ) axis, LANE_P sine, LANE_P cosine, P( v ) v )
{
    LANE_P along = P( _mul )( P( _sub )( P( _set1 )( 1.0f ), cosine ), P( v_dot )( axis, v ) );
    P( v ) turned = P( v_mul_add )( P( v_scale )( axis, along ), cosine, v );
    return P( v_mul_add )( turned, sine, P( v_cross )( axis, v ) );
}

LANE_INLINE void P( v_basis )( P( v ) t, P( v ) * b1, P( v ) * b2 )
{
    LANE_P one = P( _set1 )( 1.0f );
    LANE_P sign = P( _select )( P( _ge )( t.z, P( _zero )() ), one, P( _set1 )( -1.0f ) );
    LANE_P a = P( _div )( P( _set1 )( -1.0f ), P( _add )( sign, t.z ) );
    LANE_P b = P( _mul )( P( _mul )( t.x, t.y ), a );
    LANE_P xx = P( _mul )( P( _mul )( P( _mul )( sign, t.x ), t.x ), a );
    *b1 = ( P( v ) ){ P( _add )( one, xx ), P( _mul )( sign, b ), P( _mul )( P( _neg )( sign ), t.x ) };
    *b2 = ( P( v ) ){ b, P( _add )( sign, P( _mul )( P( _mul )( t.y, t.y ), a ) ), P( _neg )( t.y ) };
}

#undef P
