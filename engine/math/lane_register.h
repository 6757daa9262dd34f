// Operations of one register that are one instruction, of the same name in every width but for its prefix.
// Included with LANE_P (lane4, lane8, lane16), LANE_REGISTER (_mm, _mm256, _mm512) and LANE_INTEGERS (si128, si256, si512);
// therefore no include guard.

#define F LANE_P
#define I LANE_JOIN( LANE_P, i )
#define P( name ) LANE_JOIN( LANE_P, name )
#define R( name ) LANE_JOIN( LANE_REGISTER, name )
#define R_INTEGERS( name ) R( LANE_JOIN( name, LANE_INTEGERS ) )

#define REGISTER_1( T, A, name, instruction )                                                                        \
    LANE_INLINE T P( name )( A a )                                                                                   \
    {                                                                                                                \
        return instruction( a );                                                                                     \
    }

#define REGISTER_2( T, name, instruction )                                                                           \
    LANE_INLINE T P( name )( T a, T b )                                                                              \
    {                                                                                                                \
        return instruction( a, b );                                                                                  \
    }

#define REGISTER_STORE( T, type, name, instruction )                                                                 \
    LANE_INLINE void P( name )( type * to, T a )                                                                     \
    {                                                                                                                \
        instruction( (void*)to, a );                                                                                 \
    }

REGISTER_1( F, float, _set1, R( _set1_ps ) )
REGISTER_1( F, const float*, _load, R( _load_ps ) )
REGISTER_1( F, const float*, _loadu, R( _loadu_ps ) )
REGISTER_STORE( F, float, _store, R( _store_ps ) )
REGISTER_STORE( F, float, _storeu, R( _storeu_ps ) )
REGISTER_2( F, _add, R( _add_ps ) )
REGISTER_2( F, _sub, R( _sub_ps ) )
REGISTER_2( F, _mul, R( _mul_ps ) )
REGISTER_2( F, _div, R( _div_ps ) )
REGISTER_2( F, _min, R( _min_ps ) )
REGISTER_2( F, _max, R( _max_ps ) )
REGISTER_1( F, F, _sqrt, R( _sqrt_ps ) )
REGISTER_1( I, F, _truncate, R( _cvttps_epi32 ) )
REGISTER_1( F, I, _from_int, R( _cvtepi32_ps ) )
REGISTER_1( I, F, _cast_int, R_INTEGERS( _castps_ ) )
REGISTER_1( F, I, _cast_float, R( LANE_JOIN( _cast, LANE_JOIN( LANE_INTEGERS, _ps ) ) ) )

REGISTER_1( I, int32_t, i_set1, R( _set1_epi32 ) )
REGISTER_1( I, const void*, i_load, R_INTEGERS( _load_ ) )
REGISTER_1( I, const void*, i_loadu, R_INTEGERS( _loadu_ ) )
REGISTER_STORE( I, int32_t, i_storeu, R_INTEGERS( _storeu_ ) )
REGISTER_2( I, i_add, R( _add_epi32 ) )
REGISTER_2( I, i_sub, R( _sub_epi32 ) )
REGISTER_2( I, i_and, R_INTEGERS( _and_ ) )
REGISTER_2( I, i_or, R_INTEGERS( _or_ ) )
REGISTER_2( I, i_xor, R_INTEGERS( _xor_ ) )

#undef REGISTER_1
#undef REGISTER_2
#undef REGISTER_STORE
#undef F
#undef I
#undef P
#undef R
#undef R_INTEGERS
