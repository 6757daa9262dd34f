// A wide lane type as two halves, each operation forwarded to both. Used wherever registers are narrower than the type:
// lane8 from two lane4 (SSE2) and lane16 from two lane8 (plain, SSE2, AVX2).
// Included with LANE_WIDE, LANE_HALF and LANE_HALF_COUNT; therefore no include guard.

#define F LANE_WIDE
#define I LANE_JOIN( LANE_WIDE, i )
#define M LANE_JOIN( LANE_WIDE, m )
#define WIDE( name ) LANE_JOIN( LANE_WIDE, name )
#define HALF( name ) LANE_JOIN( LANE_HALF, name )

typedef struct F
{
    LANE_HALF lower, upper;
} F;

typedef struct I
{
    HALF( i ) lower, upper;
} I;

typedef struct M
{
    HALF( m ) lower, upper;
} M;

#define PAIR_1( R, A, name )                                                                                         \
    LANE_INLINE R WIDE( name )( A a )                                                                                \
    {                                                                                                                \
        return ( R ){ HALF( name )( a.lower ), HALF( name )( a.upper ) };                                            \
    }

#define PAIR_2( R, A, B, name )                                                                                      \
    LANE_INLINE R WIDE( name )( A a, B b )                                                                           \
    {                                                                                                                \
        return ( R ){ HALF( name )( a.lower, b.lower ), HALF( name )( a.upper, b.upper ) };                          \
    }

#define PAIR_3( R, A, B, C, name )                                                                                   \
    LANE_INLINE R WIDE( name )( A a, B b, C c )                                                                      \
    {                                                                                                                \
        return ( R ){ HALF( name )( a.lower, b.lower, c.lower ), HALF( name )( a.upper, b.upper, c.upper ) };        \
    }

#define PAIR_SET( R, type, name )                                                                                    \
    LANE_INLINE R WIDE( name )( type value )                                                                         \
    {                                                                                                                \
        return ( R ){ HALF( name )( value ), HALF( name )( value ) };                                                \
    }

#define PAIR_SHIFT( R, name )                                                                                        \
    LANE_INLINE R WIDE( name )( R a, int count )                                                                     \
    {                                                                                                                \
        return ( R ){ HALF( name )( a.lower, count ), HALF( name )( a.upper, count ) };                              \
    }

#define PAIR_LOAD( R, type, name )                                                                                   \
    LANE_INLINE R WIDE( name )( const type* from )                                                                   \
    {                                                                                                                \
        return ( R ){ HALF( name )( from ), HALF( name )( from + LANE_HALF_COUNT ) };                                \
    }

#define PAIR_STORE( R, type, name )                                                                                  \
    LANE_INLINE void WIDE( name )( type * to, R a )                                                                  \
    {                                                                                                                \
        HALF( name )( to, a.lower );                                                                                 \
        HALF( name )( to + LANE_HALF_COUNT, a.upper );                                                               \
    }

PAIR_SET( F, float, _set1 )
PAIR_LOAD( F, float, _load )
PAIR_LOAD( F, float, _loadu )
PAIR_STORE( F, float, _store )
PAIR_STORE( F, float, _storeu )
PAIR_2( F, F, F, _add )
PAIR_2( F, F, F, _sub )
PAIR_2( F, F, F, _mul )
PAIR_2( F, F, F, _div )
PAIR_2( F, F, F, _min )
PAIR_2( F, F, F, _max )
PAIR_1( F, F, _sqrt )
PAIR_1( F, F, _floor )
PAIR_2( M, F, F, _lt )
PAIR_2( M, F, F, _le )
PAIR_2( M, F, F, _eq )
PAIR_3( F, M, F, F, _select )
PAIR_1( I, F, _truncate )
PAIR_1( F, I, _from_int )
PAIR_1( I, F, _cast_int )
PAIR_1( F, I, _cast_float )

PAIR_SET( I, int32_t, i_set1 )
PAIR_LOAD( I, int32_t, i_load )
PAIR_LOAD( I, int32_t, i_loadu )
PAIR_STORE( I, int32_t, i_storeu )
PAIR_2( I, I, I, i_add )
PAIR_2( I, I, I, i_sub )
PAIR_2( I, I, I, i_mul )
PAIR_2( I, I, I, i_and )
PAIR_2( I, I, I, i_or )
PAIR_2( I, I, I, i_xor )
PAIR_SHIFT( I, i_shift_left )
PAIR_SHIFT( I, i_shift_right )
PAIR_2( M, I, I, i_eq )
PAIR_2( M, I, I, i_lt )
PAIR_3( I, M, I, I, i_select )

PAIR_2( M, M, M, m_and )
PAIR_2( M, M, M, m_or )
PAIR_2( M, M, M, m_and_not )
PAIR_1( M, M, m_not )

LANE_INLINE uint32_t WIDE( m_bits )( M a )
{
    return HALF( m_bits )( a.lower ) | HALF( m_bits )( a.upper ) << LANE_HALF_COUNT;
}

LANE_INLINE I WIDE( i_iota )( void )
{
    HALF( i ) lower = HALF( i_iota )();
    return ( I ){ lower, HALF( i_add )( lower, HALF( i_set1 )( LANE_HALF_COUNT ) ) };
}

LANE_INLINE F WIDE( _join )( LANE_HALF lower, LANE_HALF upper )
{
    return ( F ){ lower, upper };
}

LANE_INLINE I WIDE( i_join )( HALF( i ) lower, HALF( i ) upper )
{
    return ( I ){ lower, upper };
}

LANE_INLINE float WIDE( _sum_ordered )( F a )
{
    return HALF( _sum_ordered )( HALF( _add )( a.lower, a.upper ) );
}

#undef PAIR_1
#undef PAIR_2
#undef PAIR_3
#undef PAIR_SET
#undef PAIR_SHIFT
#undef PAIR_LOAD
#undef PAIR_STORE
#undef F
#undef I
#undef M
#undef WIDE
#undef HALF
