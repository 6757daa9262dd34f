// The side of a plane on which a point is, and whether a segment passes through a triangle: exact, so all tolerances
// are zero.
#include "intersections_fixture.h"

#include "solid.h"

static int side_of_whole( const whole_point p[4], const int powers[3] )
{
    float f[4][3];
    for ( int i = 0; i < 4; ++i )
    {
        for ( int axis = 0; axis < 3; ++axis )
        {
            f[i][axis] = ldexpf( (float)p[i].at[axis], powers[axis] );
        }
    }
    return space_side_of_plane( f[0], f[1], f[2], f[3] );
}

// A finite float of any magnitude: all bit patterns are equally likely.
static float any_float( int a, int b )
{
    for ( int n = 0;; ++n )
    {
        const uint32_t word =
            (uint32_t)wisp_random_bits( wisp_random_make_key( 31, 0, 0 ), (uint32_t)a, (uint32_t)b, (uint32_t)n );
        float value;
        memcpy( &value, &word, sizeof( value ) );
        if ( isfinite( value ) )
        {
            return value;
        }
    }
}

// ---- signs ----

// Points in a plane, or as close to one as integers can be: d = a + i (b - a) + k (c - a), and one unit away from it.
static void near_a_plane( int n, whole_point p[4] )
{
    for ( int i = 0; i < 3; ++i )
    {
        p[i] = whole_random( n, i, 1 << 17 );
    }
    const int i = test_random( n, 20, 5 ) - 2, k = test_random( n, 21, 5 ) - 2;
    for ( int axis = 0; axis < 3; ++axis )
    {
        const int32_t a = p[0].at[axis];
        p[3].at[axis] = a + i * ( p[1].at[axis] - a ) + k * ( p[2].at[axis] - a );
    }
    p[3].at[test_random( n, 22, 3 )] += test_random( n, 23, 3 ) - 1;
}

// A power of two for each axis changes no sign. Coordinates are below 2^20, so all of them stay finite floats, down
// to the lowest subnormal one and up to 2^127.
TEST( signs_are_those_of_whole_numbers_at_any_scale )
{
    int seen[3] = { 0 };
    for ( int n = 0; n < 60000; ++n )
    {
        whole_point p[4];
        near_a_plane( n, p );
        if ( n % 3 == 0 )
        {
            p[3] = whole_random( n, 3, 1 << 19 );
        }
        const int powers[3] = { test_random( n, 30, 257 ) - 149, test_random( n, 31, 257 ) - 149,
                                test_random( n, 32, 257 ) - 149 };
        const int expected = whole_side( p[0], p[1], p[2], p[3] );
        assert_int_equal( side_of_whole( p, powers ), expected );
        ++seen[expected + 1];
    }
    assert_true( seen[0] > 10000 && seen[1] > 3000 && seen[2] > 10000 );
}

// The classroom examples of Kettner, Mehlhorn, Pion, Schirra, Yap 2008, one dimension up: a point walks a grid of
// ulps where a plane through far points, or through points nearly in a row, passes. In units of 2^-24, one ulp of a
// half, all coordinates are whole; the table has them in halves, and what is added in ulps.
TEST( a_grid_of_ulps_is_cut_by_the_plane_where_it_should_be )
{
    static const struct
    {
        whole_point halves[3], ulps;
    } rows[] = {
        { { { { 24, 24, 24 } }, { { 48, 48, 48 } }, { { 2, 4, 6 } } }, { { 0, 0, 0 } } },
        { { { { 17, 9, -11 } }, { { 61, 23, 15 } }, { { -75, -29, -1 } } }, { { 0, 0, 0 } } },
        { { { { 2, 0, 0 } }, { { 0, 2, 0 } }, { { 1, 1, 0 } } }, { { 1, 1, 3 } } },
    };
    static const int powers[3] = { -24, -24, -24 };
    for ( int row = 0; row < WISP_COUNT( rows ); ++row )
    {
        int seen[3] = { 0 };
        for ( int n = 0; n < 64 * 64; ++n )
        {
            const int32_t half = 1 << 23;
            whole_point p[4];
            for ( int i = 0; i < 3 * 3; ++i )
            {
                p[i / 3].at[i % 3] =
                    rows[row].halves[i / 3].at[i % 3] * half + ( i < 6 ? 0 : rows[row].ulps.at[i % 3] );
            }
            p[3] = ( whole_point ){ { half + n % 64 - 32, half + n / 64 - 32, row == 2 ? n % 5 - 2 : half } };
            const int expected = whole_side( p[0], p[1], p[2], p[3] );
            assert_int_equal( side_of_whole( p, powers ), expected );
            ++seen[expected + 1];
        }
        assert_true( seen[0] > 1000 && seen[1] > 0 && seen[2] > 1000 );
    }
}

// Coordinates of very different sizes: m B^k with B = 2^120 and k = 0, 1, 2. The determinant is a polynomial in B
// whose coefficients are far below B, so its sign is that of the first coefficient that is not zero.
typedef struct polynomial
{
    wide of[7];
} polynomial;

static polynomial polynomial_minus( polynomial a, polynomial b )
{
    for ( int k = 0; k < 7; ++k )
    {
        a.of[k] -= b.of[k];
    }
    return a;
}

static polynomial polynomial_times( polynomial a, polynomial b )
{
    polynomial product = { { 0 } };
    for ( int i = 0; i < 7; ++i )
    {
        for ( int k = 0; i + k < 7; ++k )
        {
            product.of[i + k] += a.of[i] * b.of[k];
        }
    }
    return product;
}

static polynomial polynomial_minor( polynomial m[3][3], int row, int column )
{
    const int r1 = ( row + 1 ) % 3, r2 = ( row + 2 ) % 3, c1 = ( column + 1 ) % 3, c2 = ( column + 2 ) % 3;
    return polynomial_minus( polynomial_times( m[r1][c1], m[r2][c2] ), polynomial_times( m[r1][c2], m[r2][c1] ) );
}

static int polynomial_sign( polynomial m[3][3] )
{
    polynomial sum = { { 0 } };
    for ( int row = 0; row < 3; ++row )
    {
        const polynomial fraction = polynomial_times( m[row][0], polynomial_minor( m, row, 0 ) );
        for ( int k = 0; k < 7; ++k )
        {
            sum.of[k] += fraction.of[k];
        }
    }
    int k = 6;
    for ( ; k > 0 && sum.of[k] == 0; --k )
    {
    }
    return sign_of( sum.of[k] );
}

TEST( coordinates_of_all_sizes_may_stand_beside_each_other )
{
    int seen[3] = { 0 };
    for ( int n = 0; n < 40000; ++n )
    {
        float f[4][3];
        polynomial p[4][3] = { 0 }, m[3][3];
        for ( int i = 0; i < 4 * 3; ++i )
        {
            const int size = test_random( n, 2 * i, 3 ), whole = test_random( n, 2 * i + 1, 5 ) - 2;
            f[i / 3][i % 3] = ldexpf( (float)whole, 120 * size - 149 );
            p[i / 3][i % 3].of[size] = whole;
        }
        for ( int i = 0; i < 3 * 3; ++i )
        {
            m[i / 3][i % 3] = polynomial_minus( p[i / 3 + 1][i % 3], p[0][i % 3] );
        }
        const int expected = polynomial_sign( m );
        assert_int_equal( space_side_of_plane( f[0], f[1], f[2], f[3] ), expected );
        ++seen[expected + 1];
    }
    assert_true( seen[0] > 1000 && seen[1] > 100 && seen[2] > 1000 );
}

// The plane x = y has the normal (1, -1, 0), so the side is a comparison of two floats, for any floats.
TEST( a_plane_tells_any_two_floats_apart )
{
    for ( int n = 0; n < 40000; ++n )
    {
        const float far = n % 2 == 0 ? FLT_MAX : 3e-38f;
        const float a[3] = { 0.0f, 0.0f, 0.0f }, b[3] = { far, far, 0.0f }, c[3] = { 0.0f, 0.0f, far };
        float x = any_float( n, 0 ), y = n % 3 == 0 ? any_float( n, 1 ) : x;
        y = n % 3 == 1 ? nextafterf( x, n % 4 < 2 ? INFINITY : -INFINITY ) : y;
        y = isfinite( y ) ? y : x;
        const float d[3] = { x, y, any_float( n, 2 ) };
        assert_int_equal( space_side_of_plane( a, b, c, d ), ( x > y ) - ( x < y ) );
    }
}

// Swapping two points changes only the sign.
TEST( signs_alternate_with_the_order_of_points )
{
    for ( int n = 0; n < 3000; ++n )
    {
        float f[4][3];
        whole_point p[4];
        near_a_plane( n, p );
        for ( int i = 0; i < 4; ++i )
        {
            for ( int axis = 0; axis < 3; ++axis )
            {
                // integers near a plane; sums that are rounded; anything
                const float whole = (float)p[i].at[axis];
                f[i][axis] = n % 3 == 0 ? whole : n % 3 == 1 ? 0.1f + whole : any_float( n, 3 * i + axis );
            }
        }
        const int sign = space_side_of_plane( f[0], f[1], f[2], f[3] );
        for ( int code = 0; code < 4 * 4 * 4 * 4; ++code )
        {
            const int o[4] = { code & 3, code >> 2 & 3, code >> 4 & 3, code >> 6 };
            int swaps = 0;
            bool all_differ = true;
            for ( int i = 0; i < 4 * 4; ++i )
            {
                all_differ = all_differ && ( i / 4 == i % 4 || o[i / 4] != o[i % 4] );
                swaps += i / 4 < i % 4 && o[i / 4] > o[i % 4] ? 1 : 0;
            }
            const int expected = !all_differ ? 0 : swaps % 2 == 0 ? sign : -sign;
            assert_int_equal( space_side_of_plane( f[o[0]], f[o[1]], f[o[2]], f[o[3]] ), expected );
        }
    }
}

// Coordinates below 2^12 by steps of a half, moved by whole numbers below 2^22: the sums are floats.
TEST( signs_stay_when_everything_moves )
{
    for ( int n = 0; n < 20000; ++n )
    {
        float f[4][3], moved[4][3];
        const whole_point by = whole_random( n, 9, 1 << 22 );
        for ( int i = 0; i < 4; ++i )
        {
            const whole_point p = whole_random( n, i, n % 2 == 0 ? 5 : 1 << 12 );
            for ( int axis = 0; axis < 3; ++axis )
            {
                f[i][axis] = 0.5f * (float)p.at[axis];
                moved[i][axis] = f[i][axis] + (float)by.at[axis];
                assert_true( (double)moved[i][axis] == (double)f[i][axis] + (double)by.at[axis] );
            }
        }
        assert_int_equal( space_side_of_plane( moved[0], moved[1], moved[2], moved[3] ),
                          space_side_of_plane( f[0], f[1], f[2], f[3] ) );
    }
}

TEST( what_is_not_finite_is_on_no_side_and_crosses_nothing )
{
    static const float bad[] = { NAN, INFINITY, -INFINITY };
    for ( int n = 0; n < 3 * 5 * 3; ++n )
    {
        float p[5][3] = {
            { 0.2f, 0.2f, -1.0f }, { 0.2f, 0.2f, 1.0f }, { 0 }, { 1.0f, 0.0f, 0.0f }, { 0.0f, 1.0f, 0.0f }
        };
        assert_true( wisp_segment_intersects( p[0], p[1], p[2], p[3], p[4] ) );
        p[n / 3 % 5][n % 3] = bad[n / 15];
        assert_false( wisp_segment_intersects( p[0], p[1], p[2], p[3], p[4] ) );
        const int touched = n / 3 % 5;
        assert_int_equal(
            space_side_of_plane( p[touched], p[( touched + 1 ) % 5], p[( touched + 2 ) % 5], p[( touched + 3 ) % 5] ),
            0 );
    }
}

// ---- segments ----

static bool crosses_whole( const whole_point p[5] )
{
    float f[5][3];
    for ( int i = 0; i < 5; ++i )
    {
        whole_to_floats( p[i], f[i] );
    }
    return wisp_segment_intersects( f[0], f[1], f[2], f[3], f[4] );
}

// On a small lattice every kind of contact occurs: ends in the plane, through edges, through corners, flat triangles.
TEST( only_what_passes_through_the_inside_crosses )
{
    int seen[3] = { 0 };
    for ( int n = 0; n < 60000; ++n )
    {
        whole_point p[5];
        for ( int i = 0; i < 5; ++i )
        {
            p[i] = whole_random( n, i, 2 + n % 3 );
        }
        const whole_meeting expected = whole_meet( p[0], p[1], p[2], p[3], p[4] );
        assert_int_equal( crosses_whole( p ), expected == WHOLE_CROSS );
        ++seen[expected];
    }
    assert_true( seen[WHOLE_APART] > 10000 && seen[WHOLE_TOUCH] > 1000 && seen[WHOLE_CROSS] > 1000 );
}

TEST( what_touches_does_not_cross )
{
    static const struct
    {
        whole_point p[5];
        bool crosses;
    } rows[] = {
        { { { { 1, 1, -1 } }, { { 1, 1, 1 } }, { { 0, 0, 0 } }, { { 4, 0, 0 } }, { { 0, 4, 0 } } }, true },
        { { { { 1, 1, 0 } }, { { 1, 1, 1 } }, { { 0, 0, 0 } }, { { 4, 0, 0 } }, { { 0, 4, 0 } } }, false }, // an end
        { { { { 1, 0, -1 } }, { { 1, 0, 1 } }, { { 0, 0, 0 } }, { { 4, 0, 0 } }, { { 0, 4, 0 } } },
          false }, // an edge
        { { { { 2, 2, -1 } }, { { 2, 2, 1 } }, { { 0, 0, 0 } }, { { 4, 0, 0 } }, { { 0, 4, 0 } } },
          false }, // the third
        { { { { 0, 0, -1 } }, { { 0, 0, 1 } }, { { 0, 0, 0 } }, { { 4, 0, 0 } }, { { 0, 4, 0 } } },
          false }, // a corner
        { { { { -1, 1, 0 } }, { { 5, 1, 0 } }, { { 0, 0, 0 } }, { { 4, 0, 0 } }, { { 0, 4, 0 } } },
          false }, // in plane
        { { { { 1, 0, -1 } }, { { 1, 0, 1 } }, { { 0, 0, 0 } }, { { 4, 0, 0 } }, { { 2, 0, 0 } } }, false }, // flat
        { { { { 1, 1, 1 } }, { { 1, 1, 1 } }, { { 0, 0, 0 } }, { { 4, 0, 0 } }, { { 0, 4, 0 } } },
          false }, // no length
        { { { { 1, 1, 1 } }, { { 1, 1, 9 } }, { { 0, 0, 0 } }, { { 4, 0, 0 } }, { { 0, 4, 0 } } },
          false }, // too short
        { { { { 3, 3, -1 } }, { { 3, 3, 1 } }, { { 0, 0, 0 } }, { { 4, 0, 0 } }, { { 0, 4, 0 } } }, false }, // beside
    };
    for ( int i = 0; i < WISP_COUNT( rows ); ++i )
    {
        assert_int_equal( crosses_whole( rows[i].p ), rows[i].crosses );
    }
}

TEST( intersection_knows_neither_direction_nor_facing )
{
    static const int orders[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 0, 2, 1 }, { 2, 1, 0 }, { 1, 0, 2 } };
    int intersection = 0;
    for ( int n = 0; n < 20000; ++n )
    {
        float p[2][3], t[3][3];
        for ( int i = 0; i < 5 * 3; ++i )
        {
            float* to = i < 6 ? &p[i / 3][i % 3] : &t[i / 3 - 2][i % 3];
            *to = n % 2 == 0 ? any_float( n, i ) : test_random_float( n, i, -1.0f, 1.0f );
        }
        const bool expected = wisp_segment_intersects( p[0], p[1], t[0], t[1], t[2] );
        intersection += expected ? 1 : 0;
        for ( int k = 0; k < 12; ++k )
        {
            const int* o = orders[k / 2];
            assert_int_equal( wisp_segment_intersects( p[k % 2], p[1 - k % 2], t[o[0]], t[o[1]], t[o[2]] ),
                              expected );
        }
    }
    assert_true( intersection > 100 );
}

// A line through a closed fan around an inner point cannot leave it elsewhere: it passes through one triangle, or
// touches an edge or the point. Rounded tests let rays slip through between two triangles, or hit both.
TEST( a_fan_has_no_gaps_and_no_overlaps )
{
    enum
    {
        SIDES = 7,
    };
    float ring[SIDES][3];
    const float hub[3] = { 0.013f, -0.021f, 1e-7f };
    for ( int i = 0; i < SIDES; ++i )
    {
        ring[i][0] = cosf( 0.9f * (float)i );
        ring[i][1] = sinf( 0.9f * (float)i );
        ring[i][2] = 1e-7f * (float)( i % 3 );
    }
    for ( int n = 0; n < 20000; ++n )
    {
        // close to spokes, where a rounding decides
        const float s = test_random_float( n, 0, 0.0f, 0.8f ), off = test_random_float( n, 1, -1e-7f, 1e-7f );
        const float* spoke = ring[n % SIDES];
        const float p[3] = { hub[0] + s * ( spoke[0] - hub[0] ) + off, hub[1] + s * ( spoke[1] - hub[1] ) - off,
                             -1.0f };
        const float q[3] = { p[0], p[1], 1.0f };
        int hits = 0, touches = 0;
        for ( int i = 0; i < SIDES; ++i )
        {
            const float *a = ring[i], *b = ring[( i + 1 ) % SIDES];
            hits += wisp_segment_intersects( p, q, hub, a, b ) ? 1 : 0;
            touches += space_side_of_plane( p, q, hub, a ) == 0 ? 1 : 0;
        }
        assert_int_equal( hits, touches > 0 ? 0 : 1 );
    }
}
