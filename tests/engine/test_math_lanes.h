// Tests of one lane width against scalar C, bit for bit. Included by test_math.c once per width with LANE_P (lane8,
// lane16) and LANE_COUNT; therefore no include guard.

#define P( name ) LANE_JOIN( LANE_P, name )

// Run `lanes` over all operands in blocks of one register, and compare lane l of `result` with `expected` at
// operand k + l. A, B and C are the operands in lanes; a, b and c in scalars.
#define EACH_OPERAND( result_type, result_store, lanes, expected, assert_same )                                      \
    for ( int k = 0; k < OPERAND_COUNT; k += LANE_COUNT )                                                            \
    {                                                                                                                \
        LANE_P A = P( _loadu )( operand_a + k ), B = P( _loadu )( operand_b + k ), C = P( _loadu )( operand_c + k ); \
        (void)A, (void)B, (void)C;                                                                                   \
        result_type result[LANE_COUNT];                                                                              \
        result_store( result, lanes );                                                                               \
        for ( int l = 0; l < LANE_COUNT; ++l )                                                                       \
        {                                                                                                            \
            float a = operand_a[k + l], b = operand_b[k + l], c = operand_c[k + l];                                  \
            (void)a, (void)b, (void)c;                                                                               \
            assert_same( result[l], expected, k + l );                                                               \
        }                                                                                                            \
    }

#define EACH_FLOAT( lanes, expected, assert_same ) EACH_OPERAND( float, P( _storeu ), lanes, expected, assert_same )
#define EACH_INT( lanes, expected ) EACH_OPERAND( int32_t, P( i_storeu ), lanes, expected, assert_same_int )

// A mask becomes ones and zeros by a select, which is itself compared with scalars below.
#define EACH_MASK( lanes, expected )                                                                                 \
    EACH_INT( P( i_select )( lanes, P( i_set1 )( 1 ), P( i_set1 )( 0 ) ), ( expected ) ? 1 : 0 )

TEST( P( _arithmetic_is_the_scalar_arithmetic ) )
{
    EACH_FLOAT( P( _add )( A, B ), a + b, assert_same_value );
    EACH_FLOAT( P( _sub )( A, B ), a - b, assert_same_value );
    EACH_FLOAT( P( _mul )( A, B ), a * b, assert_same_value );
    EACH_FLOAT( P( _div )( A, B ), a / b, assert_same_value );
    EACH_FLOAT( P( _sqrt )( A ), sqrtf( a ), assert_same_value );
    EACH_FLOAT( P( _floor )( A ), floorf( a ), assert_same_value );
    EACH_FLOAT( P( _mul_add )( A, B, C ), two_roundings( a, b, c ), assert_same_value );
    EACH_FLOAT( P( _neg )( A ), float_of( bits_of( a ) ^ 0x80000000u ), assert_same_bits );
    EACH_FLOAT( P( _abs )( A ), float_of( bits_of( a ) & 0x7fffffffu ), assert_same_bits );
    EACH_FLOAT( P( _set1 )( 0.1f ), 0.1f, assert_same_bits );
    EACH_FLOAT( P( _zero )(), 0.0f, assert_same_bits );
}

TEST( P( _minimum_and_maximum_answer_the_second_operand_unless_the_first_wins ) )
{
    EACH_FLOAT( P( _min )( A, B ), a < b ? a : b, assert_same_bits );
    EACH_FLOAT( P( _max )( A, B ), a > b ? a : b, assert_same_bits );
}

TEST( P( _comparisons_are_the_scalar_comparisons ) )
{
    EACH_MASK( P( _lt )( A, B ), a < b );
    EACH_MASK( P( _le )( A, B ), a <= b );
    EACH_MASK( P( _gt )( A, B ), a > b );
    EACH_MASK( P( _ge )( A, B ), a >= b );
    EACH_MASK( P( _eq )( A, B ), a == b );
    EACH_MASK( P( _eq )( A, A ), a == a );
    EACH_FLOAT( P( _select )( P( _lt )( C, B ), A, B ), c < b ? a : b, assert_same_bits );
}

TEST( P( _conversions_are_the_scalar_conversions ) )
{
    EACH_INT( P( _truncate )( A ), truncated( a ) );
    EACH_INT( P( _cast_int )( A ), (int32_t)bits_of( a ) );
    EACH_FLOAT( P( _from_int )( P( _cast_int )( A ) ), (float)(int32_t)bits_of( a ), assert_same_bits );
    EACH_FLOAT( P( _cast_float )( P( i_add )( P( _cast_int )( A ), P( i_set1 )( 1 ) ) ),
                float_of( bits_of( a ) + 1u ), assert_same_bits )
}

#define I( X ) P( _cast_int )( X )

TEST( P( _integers_wrap_as_unsigned_scalars_do ) )
{
    EACH_INT( P( i_add )( I( A ), I( B ) ), (int32_t)( bits_of( a ) + bits_of( b ) ) );
    EACH_INT( P( i_sub )( I( A ), I( B ) ), (int32_t)( bits_of( a ) - bits_of( b ) ) );
    EACH_INT( P( i_mul )( I( A ), I( B ) ), (int32_t)( bits_of( a ) * bits_of( b ) ) );
    EACH_INT( P( i_and )( I( A ), I( B ) ), (int32_t)( bits_of( a ) & bits_of( b ) ) );
    EACH_INT( P( i_or )( I( A ), I( B ) ), (int32_t)( bits_of( a ) | bits_of( b ) ) );
    EACH_INT( P( i_xor )( I( A ), I( B ) ), (int32_t)( bits_of( a ) ^ bits_of( b ) ) );
    EACH_INT( P( i_set1 )( -123456789 ), -123456789 );
    EACH_INT( P( i_iota )(), l );
    EACH_MASK( P( i_eq )( I( A ), I( B ) ), bits_of( a ) == bits_of( b ) );
    EACH_MASK( P( i_eq )( I( A ), I( A ) ), true );
    EACH_MASK( P( i_lt )( I( A ), I( B ) ), (int32_t)bits_of( a ) < (int32_t)bits_of( b ) );
    EACH_INT( P( i_select )( P( _lt )( A, B ), I( B ), I( C ) ), (int32_t)bits_of( a < b ? b : c ) );
}

#define SHIFTED( count )                                                                                             \
    EACH_INT( P( i_shift_left )( I( A ), count ), (int32_t)( bits_of( a ) << count ) )                               \
    EACH_INT( P( i_shift_right )( I( A ), count ), (int32_t)( bits_of( a ) >> count ) );

TEST( P( _shifts_fill_with_zeros ) )
{
    SHIFTED( 0 );
    SHIFTED( 1 );
    SHIFTED( 8 );
    SHIFTED( 16 );
    SHIFTED( 30 );
    SHIFTED( 31 );
}

#undef SHIFTED
#undef I

TEST( P( _loads_and_stores_touch_their_own_lanes_only ) )
{
    _Alignas( 64 ) float from[3 * LANE_COUNT], to[3 * LANE_COUNT];
    _Alignas( 64 ) int32_t from_int[3 * LANE_COUNT], to_int[3 * LANE_COUNT];
    for ( int k = 0; k < 3 * LANE_COUNT; ++k )
    {
        from[k] = (float)k + 0.5f;
        from_int[k] = 1000 + k;
        to[k] = -1.0f;
        to_int[k] = -1;
    }

    P( _store )( to, P( _load )( from + LANE_COUNT ) );
    P( _storeu )( to + LANE_COUNT + 1, P( _loadu )( from + 3 ) );
    P( i_storeu )( to_int, P( i_load )( from_int + LANE_COUNT ) );
    P( i_storeu )( to_int + LANE_COUNT + 1, P( i_loadu )( from_int + 3 ) );

    for ( int k = 0; k < 3 * LANE_COUNT; ++k )
    {
        int source = k < LANE_COUNT ? k + LANE_COUNT : k - ( LANE_COUNT + 1 ) + 3;
        bool written = k != LANE_COUNT && k < 2 * LANE_COUNT + 1;
        assert_same_bits( to[k], written ? from[source] : -1.0f, k );
        assert_same_int( to_int[k], written ? from_int[source] : -1, k );
    }
}

static P( m ) P( _mask_of )( uint32_t bits )
{
    int32_t ones[LANE_COUNT];
    for ( int l = 0; l < LANE_COUNT; ++l )
    {
        ones[l] = (int32_t)( bits >> l & 1u );
    }
    return P( i_eq )( P( i_loadu )( ones ), P( i_set1 )( 1 ) );
}

TEST( P( _masks_are_sets_of_lanes ) )
{
    const uint32_t full = ( 1u << LANE_COUNT ) - 1u;
    for ( uint32_t a = 0; a <= full; a += LANE_COUNT == 8 ? 1 : 61 )
    {
        P( m ) mask = P( _mask_of )( a );
        assert_int_equal( P( m_bits )( mask ), a );
        assert_int_equal( P( m_bits )( P( m_not )( mask ) ), ~a & full );
        assert_int_equal( P( m_any )( mask ), a != 0 );
        assert_int_equal( P( m_all )( mask ), a == full );
        for ( uint32_t k = 0; k <= LANE_COUNT; ++k )
        {
            uint32_t b = ( a * 2654435761u >> k ) & full;
            P( m ) other = P( _mask_of )( b );
            assert_int_equal( P( m_bits )( P( m_and )( mask, other ) ), a & b );
            assert_int_equal( P( m_bits )( P( m_or )( mask, other ) ), a | b );
            assert_int_equal( P( m_bits )( P( m_and_not )( mask, other ) ), a & ~b );
        }
    }
    assert_true( P( m_all )( P( _mask_of )( full ) ) );
    for ( int n = -2; n <= LANE_COUNT + 2; ++n )
    {
        int lanes = n < 0 ? 0 : n > LANE_COUNT ? LANE_COUNT : n;
        assert_int_equal( P( m_bits )( P( m_first )( n ) ), ( 1u << lanes ) - 1u );
    }
}

TEST( P( _sum_folds_the_upper_half_onto_the_lower ) )
{
    for ( int k = 0; k < ORDINARY_COUNT; k += LANE_COUNT )
    {
        float part[LANE_COUNT];
        memcpy( part, ordinary + k, sizeof part );
        float sum = P( _sum_ordered )( P( _loadu )( part ) );
        for ( int half = LANE_COUNT / 2; half > 0; half /= 2 )
        {
            for ( int l = 0; l < half; ++l )
            {
                part[l] += part[l + half];
            }
        }
        assert_same_bits( sum, part[0], k );
    }
}

TEST( P( _random_numbers_are_the_scalar_ones ) )
{
    wisp_random_key key = wisp_random_make_key( 7, 8, 9 );
#define DRAWN wisp_random_unit_float( key, bits_of( a ), bits_of( b ), bits_of( c ) )
    EACH_FLOAT( P( _random_unit )( key, P( _cast_int )( A ), P( _cast_int )( B ), P( _cast_int )( C ) ), DRAWN,
                assert_same_bits )
    EACH_FLOAT( P( _random_signed )( key, P( _cast_int )( A ), P( _cast_int )( B ), P( _cast_int )( C ) ),
                2.0f * DRAWN - 1.0f, assert_same_bits )
#undef DRAWN
}

// Over the operands, which include all special numbers, and over usual angles.
TEST( P( _trigonometry_is_the_scalar_one ) )
{
    LANE_P sine, cosine;
    for ( int k = 0; k < ORDINARY_COUNT; k += LANE_COUNT )
    {
        P( _sincos )( P( _loadu )( ordinary + k ), &sine, &cosine );
        float s[LANE_COUNT], c[LANE_COUNT];
        P( _storeu )( s, sine );
        P( _storeu )( c, cosine );
        for ( int l = 0; l < LANE_COUNT; ++l )
        {
            assert_same_bits( s[l], scalar_sine( ordinary[k + l] ), k + l );
            assert_same_bits( c[l], scalar_cosine( ordinary[k + l] ), k + l );
        }
    }

    EACH_FLOAT( ( P( _sincos )( A, &sine, &cosine ), sine ), scalar_sine( a ), assert_same_value );
    EACH_FLOAT( ( P( _sincos )( A, &sine, &cosine ), cosine ), scalar_cosine( a ), assert_same_value );
    EACH_FLOAT( P( _atan2 )( A, B ), trig_atan2( a, b ), assert_same_value );
}

static P( v ) P( v_directions )( int first )
{
    _Alignas( 64 ) float rows[3 * LANE_COUNT];
    for ( int l = 0; l < LANE_COUNT; ++l )
    {
        wisp_vec3 v = direction( ( first + l ) % DIRECTION_COUNT );
        rows[l] = v.x;
        rows[l + LANE_COUNT] = v.y;
        rows[l + 2 * LANE_COUNT] = v.z;
    }
    return P( v_load )( rows );
}

static void P( v_check )( P( v ) actual, const wisp_vec3* expected, int k, int line )
{
    _Alignas( 64 ) float rows[3 * LANE_COUNT];
    P( v_store )( rows, actual );
    for ( int l = 0; l < LANE_COUNT; ++l )
    {
        check_bits( rows[l], expected[l].x, k + l, false, line );
        check_bits( rows[l + LANE_COUNT], expected[l].y, k + l, false, line );
        check_bits( rows[l + 2 * LANE_COUNT], expected[l].z, k + l, false, line );
    }
}

// Lane l holds directions k + l (a), k + 7 + l (b) and the sine and cosine of an angle of its own.
#define EACH_VECTOR( lanes, expected )                                                                               \
    for ( int l = 0; l < LANE_COUNT; ++l )                                                                           \
    {                                                                                                                \
        wisp_vec3 a = direction( ( k + l ) % DIRECTION_COUNT ), b = direction( ( k + 7 + l ) % DIRECTION_COUNT );    \
        float s = scalar_sine( ordinary[k + l] ), c = scalar_cosine( ordinary[k + l] );                              \
        wisp_vec3 b1, b2;                                                                                            \
        basis( a, &b1, &b2 );                                                                                        \
        (void)b, (void)s, (void)c;                                                                                   \
        rows[l] = expected;                                                                                          \
    }                                                                                                                \
    P( v_check )( lanes, rows, k, __LINE__ );

TEST( P( v_vectors_are_the_scalar_ones ) )
{
    for ( int k = 0; k < DIRECTION_COUNT; k += LANE_COUNT )
    {
        wisp_vec3 rows[LANE_COUNT];
        P( v ) A = P( v_directions )( k ), B = P( v_directions )( k + 7 ), B1, B2;
        LANE_P S, C;
        P( _sincos )( P( _loadu )( ordinary + k ), &S, &C );
        P( v_basis )( A, &B1, &B2 );
        EACH_VECTOR( P( v_add )( A, B ), wisp_v3_add( a, b ) )
        EACH_VECTOR( P( v_sub )( A, B ), wisp_v3_sub( a, b ) )
        EACH_VECTOR( P( v_scale )( A, S ), wisp_v3_scale( a, s ) )
        EACH_VECTOR( P( v_mul_add )( A, C, B ), wisp_v3_mul_add( a, c, b ) )
        EACH_VECTOR( P( v_cross )( A, B ), wisp_v3_cross( a, b ) )
        EACH_VECTOR( P( v_scale )( A, P( v_dot )( A, B ) ), wisp_v3_scale( a, wisp_v3_dot( a, b ) ) )
        EACH_VECTOR( P( v_scale )( B, P( v_length )( A ) ), wisp_v3_scale( b, wisp_v3_length( a ) ) )
        EACH_VECTOR( P( v_select )( P( _lt )( S, C ), A, B ), s < c ? a : b )
        EACH_VECTOR( P( v_rotate )( A, S, C, B ), wisp_v3_rotate( a, s, c, b ) )
        EACH_VECTOR( B1, b1 )
        EACH_VECTOR( B2, b2 )
        EACH_VECTOR( P( v_set1 )( direction( k ) ), direction( k ) )
    }
}

#undef EACH_VECTOR
#undef EACH_OPERAND
#undef EACH_FLOAT
#undef EACH_INT
#undef EACH_MASK
#undef P
