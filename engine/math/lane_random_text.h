// pcg4d in lanes; the scalar text is wisp_random_bits() in wisp/module/random.h.
// Included once per width with LANE_P (lane8, lane16); therefore no include guard.

#define P( name ) LANE_JOIN( LANE_P, name )

LANE_INLINE P( i ) P( _random_word )( P( i ) counter, uint32_t key_word )
{
    P( i ) mixed = P( i_xor )( counter, P( i_set1 )( (int32_t)key_word ) );
    return P( i_add )( P( i_mul )( mixed, P( i_set1 )( 1664525 ) ), P( i_set1 )( 1013904223 ) );
}

LANE_INLINE P( i ) P( _random_fold )( P( i ) a )
{
    return P( i_xor )( a, P( i_shift_right )( a, 16 ) );
}

// A float keeps 24 bits, and all of them come from the first of the two output words, so the second is never made.
LANE_INLINE LANE_P P( _random_unit )( wisp_random_key key, P( i ) a, P( i ) b, P( i ) c )
{
    P( i ) x = P( _random_word )( a, key.word[0] );
    P( i ) y = P( _random_word )( b, key.word[1] );
    P( i ) z = P( _random_word )( c, key.word[2] );
    P( i ) w = P( _random_word )( P( i_set1 )( 0 ), key.word[3] );
    x = P( i_add )( x, P( i_mul )( y, w ) );
    y = P( i_add )( y, P( i_mul )( z, x ) );
    z = P( i_add )( z, P( i_mul )( x, y ) );
    w = P( i_add )( w, P( i_mul )( y, z ) );
    x = P( _random_fold )( x );
    y = P( _random_fold )( y );
    w = P( _random_fold )( w );
    x = P( i_add )( x, P( i_mul )( y, w ) );
    return P( _mul )( P( _from_int )( P( i_shift_right )( x, 8 ) ), P( _set1 )( 0x1p-24f ) );
}

LANE_INLINE LANE_P P( _random_signed )( wisp_random_key key, P( i ) a, P( i ) b, P( i ) c )
{
    LANE_P unit = P( _random_unit )( key, a, b, c );
    return P( _sub )( P( _add )( unit, unit ), P( _set1 )( 1.0f ) );
}

#undef P
