// Trigonometry against double precision, rotations against their defining properties. Built once per backend of
// lane.h, whose flags must not change a bit of them either.
#include "math_fixture.h"

// ---- trigonometry

static void check_sincos( float x )
{
    float sine, cosine;
    trig_sincos( x, &sine, &cosine );
    double sine_error = fabs( (double)sine - sin( (double)x ) );
    double cosine_error = fabs( (double)cosine - cos( (double)x ) );
    if ( !( sine_error <= (double)TRIG_SINCOS_ERROR && cosine_error <= (double)TRIG_SINCOS_ERROR ) )
    {
        fail_msg( "x = %.9g: sine off by %g, cosine by %g", (double)x, sine_error, cosine_error );
    }
}

// Every 499th float, so that all exponents occur, and the neighbourhood of the largest error of all floats.
TEST( sine_and_cosine_keep_their_bound )
{
    uint32_t last = bits_of( TRIG_SINCOS_RANGE );
    for ( uint32_t bits = bits_of( 0x1p-20f ); bits <= last; bits += 499 )
    {
        check_sincos( float_of( bits ) );
        check_sincos( -float_of( bits ) );
    }
    check_sincos( 2100.9021f );
    check_sincos( 3.90851426f );
    check_sincos( TRIG_SINCOS_RANGE );
    check_sincos( 0x1p-149f );
    check_sincos( 0.0f );
}

TEST( sine_and_cosine_stay_bounded_beyond_their_range )
{
    for ( int k = 0; k < OPERAND_COUNT; ++k )
    {
        float sine, cosine;
        trig_sincos( operand_a[k], &sine, &cosine );
        if ( isnan( operand_a[k] ) )
        {
            assert_true( isnan( sine ) && isnan( cosine ) );
        }
        else
        {
            assert_true( fabsf( sine ) <= 1.0f && fabsf( cosine ) <= 1.0f );
        }
    }
}

static void check_atan2( float y, float x )
{
    double error = fabs( (double)trig_atan2( y, x ) - atan2( (double)y, (double)x ) );
    if ( !( error <= (double)TRIG_ATAN2_ERROR ) )
    {
        fail_msg( "y = %.9g, x = %.9g: angle off by %g", (double)y, (double)x, error );
    }
}

TEST( arc_tangent_keeps_its_bound )
{
    wisp_random_key key = wisp_random_make_key( 4, 5, 6 );
    for ( uint32_t k = 0; k < 500000; ++k )
    {
        float y = 2.0f * wisp_random_unit_float( key, k, 0, 0 ) - 1.0f;
        float x = 2.0f * wisp_random_unit_float( key, k, 1, 0 ) - 1.0f;
        check_atan2( y, x );
        check_atan2( ldexpf( y, -(int)( k % 30 ) ), x );
    }
    check_atan2( 0.471258193f, -0.216977909f );
    check_atan2( 1e-40f, 2e-40f );
    check_atan2( 1e37f, -1e37f );
    check_atan2( 0x1p-149f, -0x1p-149f );
}

TEST( arc_tangent_knows_its_quadrants )
{
    const float quarter = 0.785398163f, half = 1.57079633f, whole = 3.14159265f;
    assert_same_bits( trig_atan2( 0.0f, 1.0f ), 0.0f, 0 );
    assert_same_bits( trig_atan2( 1.0f, 0.0f ), half, 0 );
    assert_same_bits( trig_atan2( 1.0f, -0.0f ), half, 0 );
    assert_same_bits( trig_atan2( 0.0f, -1.0f ), whole, 0 );
    assert_same_bits( trig_atan2( -0.0f, -1.0f ), -whole, 0 );
    assert_same_bits( trig_atan2( -1.0f, 0.0f ), -half, 0 );
    assert_same_bits( trig_atan2( 2.0f, 2.0f ), quarter, 0 );
    assert_same_bits( trig_atan2( -2.0f, 2.0f ), -quarter, 0 );
    assert_true( trig_atan2( 2.0f, -2.0f ) > half && trig_atan2( -2.0f, -2.0f ) < -half );
}

TEST( the_angle_of_the_origin_is_zero )
{
    for ( int k = 0; k < 4; ++k )
    {
        assert_true( trig_atan2( k & 1 ? -0.0f : 0.0f, k & 2 ? -0.0f : 0.0f ) == 0.0f );
    }
    assert_true( isnan( trig_atan2( NAN, 1.0f ) ) );
    assert_true( isnan( trig_atan2( 1.0f, NAN ) ) );
}

// ---- vectors

// Each entry of a product of unit vectors rounds a handful of times, each time by FLT_EPSILON / 2 at most.
static const float few_roundings = 6.0f * FLT_EPSILON;

static void assert_close( float actual, float expected )
{
    if ( !( fabsf( actual - expected ) <= few_roundings ) )
    {
        fail_msg( "%.9g, expected %.9g", (double)actual, (double)expected );
    }
}

static void assert_close_v3( wisp_vec3 actual, wisp_vec3 expected )
{
    assert_close( actual.x, expected.x );
    assert_close( actual.y, expected.y );
    assert_close( actual.z, expected.z );
}

TEST( a_basis_is_orthonormal_and_right_handed )
{
    for ( int k = 0; k < DIRECTION_COUNT; ++k )
    {
        wisp_vec3 t = direction( k ), b1, b2;
        v3_basis( t, &b1, &b2 );
        assert_close( v3_length( b1 ), 1.0f );
        assert_close( v3_length( b2 ), 1.0f );
        assert_close( v3_dot( b1, b2 ), 0.0f );
        assert_close( v3_dot( b1, t ), 0.0f );
        assert_close( v3_dot( b2, t ), 0.0f );
        assert_close_v3( v3_cross( b1, b2 ), t );
    }
}

TEST( a_rotation_keeps_lengths_and_angles )
{
    for ( int k = 0; k < DIRECTION_COUNT; ++k )
    {
        float sine, cosine;
        trig_sincos( 0.01f * (float)k, &sine, &cosine );
        wisp_vec3 axis = direction( k ), v = direction( ( k * 7 ) % DIRECTION_COUNT );
        wisp_vec3 other = direction( ( k * 13 + 5 ) % DIRECTION_COUNT );
        wisp_vec3 turned = v3_rotate( axis, sine, cosine, v );
        wisp_vec3 other_turned = v3_rotate( axis, sine, cosine, other );

        assert_close( v3_length( turned ), 1.0f );
        assert_close( v3_dot( turned, other_turned ), v3_dot( v, other ) );
        assert_close( v3_dot( turned, axis ), v3_dot( v, axis ) );
        assert_close_v3( v3_rotate( axis, -sine, cosine, turned ), v );
        assert_close_v3( v3_rotate( axis, sine, cosine, axis ), axis );
    }
}

TEST( a_rotation_turns_counter_clockwise_by_its_angle )
{
    const wisp_vec3 x = { 1.0f, 0.0f, 0.0f }, y = { 0.0f, 1.0f, 0.0f }, z = { 0.0f, 0.0f, 1.0f };
    assert_close_v3( v3_rotate( z, 1.0f, 0.0f, x ), y );
    assert_close_v3( v3_rotate( x, 1.0f, 0.0f, y ), z );
    assert_close_v3( v3_rotate( y, 1.0f, 0.0f, z ), x );
    assert_close_v3( v3_rotate( z, 0.6f, 0.8f, x ), ( wisp_vec3 ){ 0.8f, 0.6f, 0.0f } );
}

TEST( vectors_are_added_scaled_and_multiplied )
{
    const wisp_vec3 a = { 1.0f, 2.0f, 3.0f }, b = { 4.0f, -5.0f, 6.0f };
    assert_close_v3( v3_add( a, b ), ( wisp_vec3 ){ 5.0f, -3.0f, 9.0f } );
    assert_close_v3( v3_sub( a, b ), ( wisp_vec3 ){ -3.0f, 7.0f, -3.0f } );
    assert_close_v3( v3_scale( a, -2.0f ), ( wisp_vec3 ){ -2.0f, -4.0f, -6.0f } );
    assert_close_v3( v3_mul_add( a, 2.0f, b ), ( wisp_vec3 ){ 9.0f, -8.0f, 15.0f } );
    assert_close_v3( v3_cross( a, b ), ( wisp_vec3 ){ 27.0f, 6.0f, -13.0f } );
    assert_close( v3_dot( a, b ), 12.0f );
    assert_close( v3_length( ( wisp_vec3 ){ 3.0f, 0.0f, -4.0f } ), 5.0f );
}

TEST( what_has_no_direction_gets_the_fallback )
{
    const wisp_vec3 fallback = { 0.0f, 0.0f, 1.0f };
    const float lost[] = { 0.0f, -0.0f, 1e-20f, 1e20f, INFINITY, NAN };
    for ( int k = 0; k < WISP_COUNT( lost ); ++k )
    {
        assert_close_v3( v3_normalize_or( ( wisp_vec3 ){ lost[k], 0.0f, 0.0f }, fallback ), fallback );
    }
    const float kept[] = { 1.2e-19f, 1e-9f, 1.0f, 1.8e19f };
    for ( int k = 0; k < WISP_COUNT( kept ); ++k )
    {
        assert_close_v3( v3_normalize_or( ( wisp_vec3 ){ 0.0f, -kept[k], 0.0f }, fallback ),
                         ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f } );
    }
}

TEST_OBSTACLE( missing_backend )
TEST_GROUP( fill_operands, NULL )
