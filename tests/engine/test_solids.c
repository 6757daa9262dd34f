// Convex polyhedra and height fields: against boxes, planes, brute force over all triangles, and dense sampling.
#include "support.h"

#include "wisp/module/shapes.h"

enum
{
    POINTS = 1500,
    PATHS = 1500,
};

static wisp_vec3 random_point( int i, int k, float size )
{
    return ( wisp_vec3 ){ test_random_float( i, 3 * k, -size, size ), test_random_float( i, 3 * k + 1, -size, size ),
                          test_random_float( i, 3 * k + 2, -size, size ) };
}

static wisp_vec3 blend( wisp_vec3 a, float s, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x + s * b.x, a.y + s * b.y, a.z + s * b.z };
}

static float length_of( wisp_vec3 v )
{
    return sqrtf( v.x * v.x + v.y * v.y + v.z * v.z );
}

static wisp_surface_point closest( const wisp_shape* shape, wisp_vec3 p )
{
    wisp_surface_point s;
    assert_true( wisp_shape_closest( shape, p, &s ) );
    return s;
}

static wisp_shape hull_of( const wisp_vec3* points, int count )
{
    wisp_convex* convex;
    wisp_error error = { 0 };
    if ( wisp_convex_create( points, count, NULL, &convex, &error ) != WISP_OK )
    {
        fail_msg( "no hull: %s", error.message );
    }
    return ( wisp_shape ){ .kind = WISP_SHAPE_CONVEX, .convex = convex };
}

static void release( wisp_shape shape )
{
    wisp_convex* convex;
    memcpy( &convex, &shape.convex, sizeof( convex ) );
    wisp_convex_release( convex );
}

// ---- a box ----

TEST( a_convex_box_is_a_box )
{
    const wisp_shape box = { .kind = WISP_SHAPE_BOX, .half_extent = { 0.5f, 0.3f, 0.8f } };
    wisp_vec3 corners[9] = { { 0.0f, 0.0f, 0.0f } }; // one is inside
    for ( int c = 0; c < 8; ++c )
    {
        corners[c + 1] = ( wisp_vec3 ){ c & 1 ? 0.5f : -0.5f, c & 2 ? 0.3f : -0.3f, c & 4 ? 0.8f : -0.8f };
    }
    const wisp_shape convex = hull_of( corners, 9 );
    const int32_t* triangles;
    assert_int_equal( wisp_convex_triangles( convex.convex, &triangles ), 12 );
    for ( int i = 0; i < POINTS; ++i )
    {
        const wisp_vec3 p = random_point( i, 0, 1.2f );
        const wisp_surface_point a = closest( &box, p ), b = closest( &convex, p );
        assert_float_equal( a.distance, b.distance, 1e-7f );
        const bool is_inside = a.distance < 0.0f; // where two faces may be equally near
        assert_true( is_inside || length_of( blend( a.point, -1.0f, b.point ) ) < 2e-7f );
        assert_true( is_inside || length_of( blend( a.normal, -1.0f, b.normal ) ) < 4e-7f );
        const wisp_vec3 q = random_point( i, 1, 1.2f );
        wisp_shape_hit h, k;
        assert_true( wisp_shape_cast( &box, p, q, &h ) == wisp_shape_cast( &convex, p, q, &k ) );
        assert_float_equal( h.time, k.time, 1e-6f );
    }
    release( convex );
}

// ---- brute force ----

// The closest point of a triangle by the projections on its plane, edges and corners; the nearest that is in it.
static double distance_to_triangle( const double p[3], const double t[3][3] )
{
    double least = INFINITY;
    for ( int i = 0; i < 3; ++i )
    {
        double e[3], d[3], along = 0.0, size = 0.0, squared = 0.0;
        for ( int k = 0; k < 3; ++k )
        {
            e[k] = t[( i + 1 ) % 3][k] - t[i][k];
            d[k] = p[k] - t[i][k];
            along += e[k] * d[k];
            size += e[k] * e[k];
        }
        const double at = size > 0.0 ? fmax( 0.0, fmin( 1.0, along / size ) ) : 0.0;
        for ( int k = 0; k < 3; ++k )
        {
            squared += ( d[k] - at * e[k] ) * ( d[k] - at * e[k] );
        }
        least = fmin( least, sqrt( squared ) );
    }
    double u[3], v[3], n[3], d[3], size = 0.0, height = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        u[k] = t[1][k] - t[0][k];
        v[k] = t[2][k] - t[0][k];
        d[k] = p[k] - t[0][k];
    }
    for ( int k = 0; k < 3; ++k )
    {
        n[k] = u[( k + 1 ) % 3] * v[( k + 2 ) % 3] - u[( k + 2 ) % 3] * v[( k + 1 ) % 3];
        size += n[k] * n[k];
        height += n[k] * d[k];
    }
    bool is_over = size > 0.0;
    for ( int i = 0; i < 3 && is_over; ++i )
    {
        double side = 0.0;
        for ( int k = 0; k < 3; ++k )
        {
            const int a = ( k + 1 ) % 3, b = ( k + 2 ) % 3, j = ( i + 1 ) % 3;
            side +=
                n[k] * ( ( t[j][a] - t[i][a] ) * ( p[b] - t[i][b] ) - ( t[j][b] - t[i][b] ) * ( p[a] - t[i][a] ) );
        }
        is_over = side >= 0.0;
    }
    return is_over ? fmin( least, fabs( height ) / sqrt( size ) ) : least;
}

static void spread( wisp_vec3 v, double out[3] )
{
    out[0] = (double)v.x;
    out[1] = (double)v.y;
    out[2] = (double)v.z;
}

TEST( random_hulls_are_those_of_brute_force )
{
    for ( int seed = 0; seed < 12; ++seed )
    {
        enum
        {
            COUNT = 60,
        };
        wisp_vec3 points[COUNT];
        const int count = 4 + seed * 5;
        for ( int i = 0; i < count; ++i )
        {
            points[i] = random_point( i, 20 + seed, 1.0f );
            // half of the hulls have all points on a sphere
            const float r = length_of( points[i] );
            points[i] = seed % 2 == 0 ? blend( ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, 1.0f / r, points[i] ) : points[i];
        }
        const wisp_shape shape = hull_of( points, count );
        const int32_t* triangles;
        const int faces = wisp_convex_triangles( shape.convex, &triangles );
        // every plane through three points that has all others behind it is a face, and there is none else
        for ( int i = 0; i < POINTS / 4; ++i )
        {
            const wisp_vec3 at = random_point( i, 2, 1.5f );
            double p[3], least = INFINITY;
            spread( at, p );
            bool is_inside = true;
            for ( int t = 0; t < faces; ++t )
            {
                double c[3][3], n[3], height = 0.0;
                for ( int k = 0; k < 3; ++k )
                {
                    spread( points[triangles[3 * t + k]], c[k] );
                }
                for ( int k = 0; k < 3; ++k )
                {
                    const int a = ( k + 1 ) % 3, b = ( k + 2 ) % 3;
                    n[k] =
                        ( c[1][a] - c[0][a] ) * ( c[2][b] - c[0][b] ) - ( c[1][b] - c[0][b] ) * ( c[2][a] - c[0][a] );
                    height += n[k] * ( p[k] - c[0][k] );
                }
                is_inside = is_inside && height <= 0.0;
                least = fmin( least, distance_to_triangle( p, (const double( * )[3])c ) );
                for ( int o = 0; o < count && i == 0; ++o )
                {
                    double q[3], above = 0.0;
                    spread( points[o], q );
                    for ( int k = 0; k < 3; ++k )
                    {
                        above += n[k] * ( q[k] - c[0][k] );
                    }
                    assert_true( above <= 1e-5 );
                }
            }
            const wisp_surface_point s = closest( &shape, at );
            const double expected = is_inside ? -least : least;
            assert_true( fabs( (double)s.distance - expected ) <= 2e-7 );
            assert_float_equal( length_of( s.normal ), 1.0f, 4e-7f );
            assert_true( length_of( blend( blend( s.point, s.distance, s.normal ), -1.0f, at ) ) < 1e-6f );
        }
        release( shape );
    }
}

// ---- height fields ----

enum
{
    NX = 9,
    NZ = 7,
};

static wisp_shape field_of( float* heights, float roughness )
{
    for ( int i = 0; i < NX * NZ; ++i )
    {
        heights[i] = test_random_float( i, 60, -roughness, roughness );
    }
    return ( wisp_shape ){ .kind = WISP_SHAPE_HEIGHT_FIELD,
                           .height_field = { .heights = heights, .count_x = NX, .count_z = NZ, .spacing = 0.25f } };
}

TEST( a_flat_height_field_is_a_plane )
{
    float heights[NX * NZ];
    const wisp_shape field = field_of( heights, 0.0f ), plane = { .kind = WISP_SHAPE_PLANE };
    for ( int i = 0; i < POINTS; ++i )
    {
        const wisp_vec3 p = random_point( i, 0, i % 9 == 0 ? 100.0f : 1.5f ), q = random_point( i, 1, 1.5f );
        const wisp_surface_point a = closest( &plane, p ), b = closest( &field, p );
        assert_float_equal( a.distance, b.distance, 1e-6f * ( 1.0f + fabsf( a.distance ) ) );
        assert_true( length_of( blend( a.point, -1.0f, b.point ) ) < 1e-5f );
        assert_true( length_of( blend( a.normal, -1.0f, b.normal ) ) < 1e-5f );
        wisp_shape_hit h, k;
        assert_true( wisp_shape_cast( &plane, p, q, &h ) == wisp_shape_cast( &field, p, q, &k ) );
        assert_float_equal( h.time, k.time, 1e-6f );
        assert_true( length_of( blend( h.point, -1.0f, k.point ) ) < 2e-5f );
    }
}

// All triangles, with eight more rows and columns of the border's heights on each side.
static double field_distance( const wisp_shape* s, const double p[3], bool* is_below )
{
    const float* heights = s->height_field.heights;
    double least = INFINITY;
    for ( int k = -8; k < NZ + 7; ++k )
    {
        for ( int i = -8; i < NX + 7; ++i )
        {
            double c[4][3];
            for ( int o = 0; o < 4; ++o )
            {
                const int x = i + o % 2, z = k + o / 2;
                const int cx = x < 0 ? 0 : ( x > NX - 1 ? NX - 1 : x ), cz = z < 0 ? 0 : ( z > NZ - 1 ? NZ - 1 : z );
                c[o][0] = 0.25 * ( x - 0.5 * ( NX - 1 ) );
                c[o][1] = (double)heights[cz * NX + cx];
                c[o][2] = 0.25 * ( z - 0.5 * ( NZ - 1 ) );
            }
            const double t[2][3][3] = {
                { { c[0][0], c[0][1], c[0][2] }, { c[2][0], c[2][1], c[2][2] }, { c[3][0], c[3][1], c[3][2] } },
                { { c[0][0], c[0][1], c[0][2] }, { c[3][0], c[3][1], c[3][2] }, { c[1][0], c[1][1], c[1][2] } }
            };
            least = fmin( least, fmin( distance_to_triangle( p, t[0] ), distance_to_triangle( p, t[1] ) ) );
            const double u = ( p[0] - c[0][0] ) / 0.25, w = ( p[2] - c[0][2] ) / 0.25;
            if ( u >= 0.0 && u < 1.0 && w >= 0.0 && w < 1.0 )
            {
                const double h = w >= u ? c[0][1] + w * ( c[2][1] - c[0][1] ) + u * ( c[3][1] - c[2][1] )
                                        : c[0][1] + u * ( c[1][1] - c[0][1] ) + w * ( c[3][1] - c[1][1] );
                *is_below = p[1] < h;
            }
        }
    }
    return least;
}

TEST( a_rough_height_field_is_that_of_brute_force )
{
    float heights[NX * NZ];
    const wisp_shape field = field_of( heights, 0.4f );
    int below = 0;
    for ( int i = 0; i < 600; ++i )
    {
        // a third is outside of the grid
        const wisp_vec3 at = random_point( i, 3, 1.8f );
        double p[3];
        spread( at, p );
        bool is_below = false;
        const double expected = field_distance( &field, p, &is_below );
        const wisp_surface_point s = closest( &field, at );
        below += is_below ? 1 : 0;
        assert_true( fabs( (double)s.distance - ( is_below ? -expected : expected ) ) <= 3e-7 );
        assert_float_equal( length_of( s.normal ), 1.0f, 4e-7f );
        assert_true( length_of( blend( blend( s.point, s.distance, s.normal ), -1.0f, at ) ) < 2e-6f );
    }
    assert_true( below > 100 && below < 500 );
}

// ---- paths ----

static void check_paths( const wisp_shape* shape )
{
    int met = 0, entered = 0;
    for ( int i = 0; i < PATHS; ++i )
    {
        const wisp_vec3 a = random_point( i, 4, 1.3f ), b = random_point( i, 5, 1.3f ), d = blend( b, -1.0f, a );
        wisp_shape_hit hit;
        const bool begins_outside = closest( shape, a ).distance >= 0.0f;
        const bool meets = wisp_shape_cast( shape, a, b, &hit );
        assert_true( begins_outside || meets == false );
        float first = 2.0f;
        for ( int k = 0; k <= 200 && begins_outside && first > 1.0f; ++k )
        {
            const float time = 0.005f * (float)k;
            first = closest( shape, blend( a, time, d ) ).distance < -1e-5f ? time : first;
        }
        assert_true( first > 1.0f || meets );
        if ( meets )
        {
            met += 1;
            assert_true( hit.time <= first &&
                         length_of( blend( blend( a, hit.time, d ), -1.0f, hit.point ) ) < 1e-5f );
            assert_true( fabsf( closest( shape, hit.point ).distance ) < 1e-6f );
            assert_true( d.x * hit.normal.x + d.y * hit.normal.y + d.z * hit.normal.z <= 1e-6f );
        }
        // down to single roundings across the surface
        const float reach = ldexpf( 1.0f, -10 - i % 15 );
        const wisp_vec3 on = closest( shape, a ).point, c = blend( on, reach, random_point( i, 6, 1.0f ) ),
                        e = blend( on, reach, random_point( i, 7, 1.0f ) );
        const bool crosses = closest( shape, c ).distance >= 0.0f && closest( shape, e ).distance < 0.0f;
        assert_true( crosses == false || wisp_shape_cast( shape, c, e, &hit ) );
        entered += crosses ? 1 : 0;
    }
    assert_true( met > PATHS / 20 && entered > PATHS / 20 );
}

TEST( no_path_gets_inside_without_a_hit )
{
    wisp_vec3 points[40];
    for ( int i = 0; i < 40; ++i )
    {
        points[i] = random_point( i, 20, 0.8f );
    }
    const wisp_shape convex = hull_of( points, 40 );
    check_paths( &convex );
    release( convex );
    float heights[NX * NZ];
    const wisp_shape field = field_of( heights, 0.3f );
    check_paths( &field );
}

// ---- bad input, far away ----

TEST( what_is_no_solid_is_refused )
{
    const wisp_vec3 flat[5] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 0, 1 }, { 1, 0, 1 }, { 0.3f, 0, 0.2f } };
    wisp_vec3 bad[5];
    memcpy( bad, flat, sizeof( flat ) );
    bad[4].y = NAN;
    const struct
    {
        const wisp_vec3* points;
        int count;
        const char* word;
    } rows[] = { { flat, 5, "plane" },
                 { flat, 3, "3 points" },
                 { bad, 5, "point 4" },
                 { flat, 1025, "1025 points" },
                 { NULL, 8, "0 points" } };
    for ( int i = 0; i < WISP_COUNT( rows ); ++i )
    {
        wisp_convex* convex;
        wisp_error error = { 0 };
        assert_int_equal( wisp_convex_create( rows[i].points, rows[i].count, NULL, &convex, &error ),
                          WISP_BAD_INPUT );
        assert_null( convex );
        assert_one_message( error.message );
        assert_non_null( strstr( error.message, rows[i].word ) );
    }
}

TEST( far_away_is_answered )
{
    float heights[NX * NZ];
    const wisp_shape field = field_of( heights, 0.3f );
    const wisp_vec3 far[] = {
        { 1e6f, 1.0f, 0.0f }, { 0.0f, -1e6f, 0.0f }, { -1e6f, 1e6f, 1e6f }, { 1e9f, 0.0f, 1e9f }
    };
    for ( int i = 0; i < WISP_COUNT( far ); ++i )
    {
        wisp_shape_hit hit;
        assert_float_equal( length_of( closest( &field, far[i] ).normal ), 1.0f, 4e-7f );
        wisp_shape_cast( &field, far[i], far[( i + 1 ) % WISP_COUNT( far )], &hit );
    }
}
