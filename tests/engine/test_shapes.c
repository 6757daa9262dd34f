// Bodies with a closed form: distances against their own gradients, paths against dense sampling, poses against each
// other, and inputs without a result.
#include "support.h"

#include "wisp/module/shapes.h"

enum
{
    POINTS = 4000,
    PATHS = 4000,
    SAMPLES = 2000, // along a path
};

static const wisp_shape SHAPES[] = {
    { .kind = WISP_SHAPE_PLANE },
    { .kind = WISP_SHAPE_SPHERE, .radius = 0.7f },
    { .kind = WISP_SHAPE_CAPSULE, .radius = 0.4f, .half_length = 0.6f },
    { .kind = WISP_SHAPE_BOX, .half_extent = { 0.5f, 0.3f, 0.8f } },
    { .kind = WISP_SHAPE_TAPERED_CAPSULE, .top_radius = 0.25f, .bottom_radius = 0.5f, .half_length = 0.5f },
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

static void assert_near( wisp_vec3 a, wisp_vec3 b, float tolerance )
{
    assert_true( length_of( blend( a, -1.0f, b ) ) <= tolerance );
}

// ---- distances ----

// The smallest distance from a ball of the family, by ternary search: it is convex along the axis.
static double tapered_distance( const wisp_shape* s, wisp_vec3 p )
{
    const double x = (double)p.x, y = (double)p.y, z = (double)p.z, half = (double)s->half_length;
    const double top = (double)s->top_radius, bottom = (double)s->bottom_radius;
    double lower = 0.0, upper = 1.0, distance = 0.0;
    for ( int i = 0; i < 120; ++i )
    {
        double at[2], d[2];
        for ( int k = 0; k < 2; ++k )
        {
            at[k] = lower + ( upper - lower ) * ( 1.0 + k ) / 3.0;
            const double up = y - ( 2.0 * at[k] - 1.0 ) * half;
            d[k] = sqrt( x * x + up * up + z * z ) - ( bottom + at[k] * ( top - bottom ) );
        }
        lower = d[0] > d[1] ? at[0] : lower;
        upper = d[0] > d[1] ? upper : at[1];
        distance = fmin( d[0], d[1] );
    }
    return distance;
}

// The definition, as directly as possible.
static double plain_distance( const wisp_shape* s, wisp_vec3 p )
{
    double x = (double)p.x, y = (double)p.y, z = (double)p.z;
    if ( s->kind == WISP_SHAPE_PLANE )
    {
        return y;
    }
    if ( s->kind == WISP_SHAPE_BOX )
    {
        double qx = fabs( x ) - (double)s->half_extent.x, qy = fabs( y ) - (double)s->half_extent.y,
               qz = fabs( z ) - (double)s->half_extent.z;
        double outside = sqrt( fmax( qx, 0.0 ) * fmax( qx, 0.0 ) + fmax( qy, 0.0 ) * fmax( qy, 0.0 ) +
                               fmax( qz, 0.0 ) * fmax( qz, 0.0 ) );
        return outside + fmin( fmax( qx, fmax( qy, qz ) ), 0.0 );
    }
    if ( s->kind == WISP_SHAPE_TAPERED_CAPSULE )
    {
        return tapered_distance( s, p );
    }
    double half = s->kind == WISP_SHAPE_CAPSULE ? (double)s->half_length : 0.0;
    double up = y - fmax( -half, fmin( half, y ) );
    return sqrt( x * x + up * up + z * z ) - (double)s->radius;
}

TEST( a_distance_is_the_definition_rounded_once )
{
    for ( int k = 0; k < WISP_COUNT( SHAPES ); ++k )
    {
        for ( int i = 0; i < POINTS; ++i )
        {
            wisp_vec3 p = random_point( i, k, 1.5f );
            double expected = plain_distance( SHAPES + k, p );
            // one rounding to float, and the last bits of double
            assert_true( fabs( (double)closest( SHAPES + k, p ).distance - expected ) <=
                         0x1p-24 * fabs( expected ) + 1e-15 );
        }
    }
}

TEST( the_closest_point_lies_on_the_surface_at_that_distance )
{
    for ( int k = 0; k < WISP_COUNT( SHAPES ); ++k )
    {
        for ( int i = 0; i < POINTS; ++i )
        {
            wisp_vec3 p = random_point( i, k, 1.5f );
            wisp_surface_point s = closest( SHAPES + k, p );
            // coordinates of up to 1.5 are rounded to 6e-8 each, a few times
            assert_true( fabs( plain_distance( SHAPES + k, s.point ) ) <= 4e-7 );
            assert_float_equal( length_of( s.normal ), 1.0f, 4e-7f );
            assert_near( blend( s.point, s.distance, s.normal ), p, 1e-6f );
        }
    }
}

// Kinks, where the gradient jumps, and the distance around them that a difference covers.
static bool is_near_kink( const wisp_shape* s, wisp_vec3 p, float reach )
{
    wisp_vec3 q = { fabsf( p.x ), fabsf( p.y ), fabsf( p.z ) };
    if ( s->kind != WISP_SHAPE_BOX )
    {
        return s->kind != WISP_SHAPE_PLANE && sqrtf( p.x * p.x + p.z * p.z ) < 0.1f;
    }
    float dx = q.x - s->half_extent.x, dy = q.y - s->half_extent.y, dz = q.z - s->half_extent.z;
    bool is_inside = dx < reach && dy < reach && dz < reach;
    bool is_tie = fabsf( dx - dy ) < reach || fabsf( dy - dz ) < reach || fabsf( dx - dz ) < reach;
    bool is_middle = q.x < reach || q.y < reach || q.z < reach;
    return is_inside && ( is_tie || is_middle );
}

TEST( the_normal_is_the_gradient_of_the_distance )
{
    const float step = 1e-3f;
    int compared = 0;
    for ( int k = 0; k < WISP_COUNT( SHAPES ); ++k )
    {
        for ( int i = 0; i < POINTS; ++i )
        {
            wisp_vec3 p = random_point( i, k, 1.5f );
            wisp_surface_point s = closest( SHAPES + k, p );
            if ( is_near_kink( SHAPES + k, p, 2.0f * step ) || fabsf( s.distance ) < 0.05f )
            {
                continue;
            }
            wisp_vec3 gradient;
            float* g = &gradient.x;
            for ( int axis = 0; axis < 3; ++axis )
            {
                wisp_vec3 e = { axis == 0, axis == 1, axis == 2 };
                double ahead = plain_distance( SHAPES + k, blend( p, step, e ) );
                double behind = plain_distance( SHAPES + k, blend( p, -step, e ) );
                g[axis] = (float)( ( ahead - behind ) / ( 2.0 * (double)step ) );
            }
            // curvature jumps where the round of an edge begins: step / (4 distance), and the distance is 0.05 or
            // more; in addition, positions are rounded by 6e-8 over the step
            assert_near( gradient, s.normal, 5.4e-3f );
            assert_float_equal( length_of( gradient ), 1.0f, 5.4e-3f );
            ++compared;
        }
    }
    assert_true( compared > 2 * POINTS );
}

TEST( points_without_a_single_closest_one_have_a_fixed_normal )
{
    const wisp_vec3 zero = { 0.0f, 0.0f, 0.0f }, x = { 1.0f, 0.0f, 0.0f }, y = { 0.0f, 1.0f, 0.0f };
    const wisp_shape cube = { .kind = WISP_SHAPE_BOX, .half_extent = { 1.0f, 1.0f, 1.0f } };
    wisp_surface_point sphere = closest( SHAPES + 1, zero ), capsule = closest( SHAPES + 2, zero );
    wisp_surface_point box = closest( SHAPES + 3, zero ), tie = closest( &cube, zero );
    assert_near( sphere.normal, y, 0.0f );
    assert_near( sphere.point, ( wisp_vec3 ){ 0.0f, 0.7f, 0.0f }, 0.0f );
    assert_near( capsule.normal, x, 0.0f );
    assert_near( box.normal, y, 0.0f ); // its nearest face
    assert_near( tie.normal, x, 0.0f );
    assert_near( closest( &cube, ( wisp_vec3 ){ -0.5f, 0.5f, -0.5f } ).normal, ( wisp_vec3 ){ -1.0f, 0.0f, 0.0f },
                 0.0f );
    assert_float_equal( sphere.distance, -0.7f, 0.0f );
    assert_float_equal( capsule.distance, -0.4f, 0.0f );
}

TEST( sizes_of_zero_have_a_surface_and_unit_normals )
{
    const wisp_shape flat[] = { { .kind = WISP_SHAPE_SPHERE },
                                { .kind = WISP_SHAPE_CAPSULE },
                                { .kind = WISP_SHAPE_CAPSULE, .half_length = 1.0f },
                                { .kind = WISP_SHAPE_BOX },
                                { .kind = WISP_SHAPE_BOX, .half_extent = { 1.0f, 0.0f, 1.0f } } };
    for ( int k = 0; k < WISP_COUNT( flat ); ++k )
    {
        wisp_surface_point at = closest( flat + k, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
        assert_float_equal( length_of( at.normal ), 1.0f, 0.0f );
        assert_float_equal( at.distance, 0.0f, 0.0f );
        for ( int i = 0; i < 200; ++i )
        {
            assert_true( closest( flat + k, random_point( i, k, 1.0f ) ).distance >= 0.0f );
        }
    }
}

TEST( numbers_of_any_size_are_answered )
{
    const float sizes[] = { FLT_MIN, 1e-44f, 1e-20f, 1e20f, 1e38f };
    for ( int k = 0; k < WISP_COUNT( SHAPES ); ++k )
    {
        for ( int i = 0; i < WISP_COUNT( sizes ); ++i )
        {
            wisp_surface_point s = closest( SHAPES + k, ( wisp_vec3 ){ sizes[i], sizes[i], -sizes[i] } );
            assert_float_equal( length_of( s.normal ), 1.0f, 4e-7f );
            assert_true( fabsf( s.distance ) <= 2.0f * sizes[i] + 1.0f );
        }
    }
    assert_true( closest( SHAPES + 1, ( wisp_vec3 ){ 1e38f, 0.0f, 0.0f } ).distance == 1e38f );
}

// ---- paths ----

// The first sample that is inside, as a time; 2 if none is.
static double sampled_time( const wisp_shape* s, wisp_vec3 a, wisp_vec3 b )
{
    for ( int i = 0; i <= SAMPLES; ++i )
    {
        float t = (float)i / (float)SAMPLES;
        wisp_vec3 p = { a.x + t * ( b.x - a.x ), a.y + t * ( b.y - a.y ), a.z + t * ( b.z - a.z ) };
        if ( plain_distance( s, p ) < -1e-6 )
        {
            return (double)t;
        }
    }
    return 2.0;
}

// The smallest distance of the path, which distinguishes a graze that sampling misses from a wrong result.
static double min_distance( const wisp_shape* s, wisp_vec3 a, wisp_vec3 b )
{
    double least = INFINITY;
    for ( int i = 0; i <= SAMPLES; ++i )
    {
        float t = (float)i / (float)SAMPLES;
        least = fmin( least, plain_distance( s, ( wisp_vec3 ){ a.x + t * ( b.x - a.x ), a.y + t * ( b.y - a.y ),
                                                               a.z + t * ( b.z - a.z ) } ) );
    }
    return least;
}

TEST( a_path_meets_the_surface_where_sampling_does )
{
    int met = 0, missed = 0;
    for ( int k = 0; k < WISP_COUNT( SHAPES ); ++k )
    {
        for ( int i = 0; i < PATHS / 4; ++i )
        {
            wisp_vec3 a = random_point( i, 2 * k, 1.5f ), b = random_point( i, 2 * k + 1, 1.5f );
            if ( plain_distance( SHAPES + k, a ) < 0.0 )
            {
                continue;
            }
            wisp_shape_hit hit;
            double length = (double)length_of( blend( b, -1.0f, a ) ), sample = length / SAMPLES;
            if ( wisp_shape_cast( SHAPES + k, a, b, &hit ) == false )
            {
                assert_true( min_distance( SHAPES + k, a, b ) >= -1e-6 );
                ++missed;
                continue;
            }
            ++met;
            wisp_vec3 at = blend( a, hit.time, blend( b, -1.0f, a ) );
            assert_true( hit.time >= 0.0f && hit.time <= 1.0f );
            // rounding of a position on a path of up to 5 m
            assert_near( at, hit.point, 2e-6f );
            assert_true( fabs( plain_distance( SHAPES + k, hit.point ) ) <= 5e-7 );
            double first = sampled_time( SHAPES + k, a, b );
            if ( first <= 1.0 )
            {
                assert_true( (double)hit.time <= first + 1e-5 );
                bool is_grazing = min_distance( SHAPES + k, a, b ) > -2.0 * sample;
                assert_true( is_grazing || first - (double)hit.time <= 60.0 / SAMPLES );
            }
        }
    }
    assert_true( met > PATHS / 8 && missed > PATHS / 16 );
}

TEST( a_hit_faces_the_path )
{
    for ( int k = 0; k < WISP_COUNT( SHAPES ); ++k )
    {
        for ( int i = 0; i < PATHS; ++i )
        {
            wisp_vec3 a = random_point( i, 2 * k, 1.5f ), b = random_point( i, 2 * k + 1, 1.5f );
            wisp_shape_hit hit;
            if ( wisp_shape_cast( SHAPES + k, a, b, &hit ) )
            {
                wisp_vec3 d = blend( b, -1.0f, a );
                // a path of 5 m may graze: 6e-7 is the rounding of the product
                assert_true( d.x * hit.normal.x + d.y * hit.normal.y + d.z * hit.normal.z <= 6e-7f );
                assert_float_equal( length_of( hit.normal ), 1.0f, 4e-7f );
            }
        }
    }
}

TEST( nothing_gets_inside_without_a_hit )
{
    int entered = 0;
    for ( int k = 0; k < WISP_COUNT( SHAPES ); ++k )
    {
        for ( int i = 0; i < PATHS; ++i )
        {
            // short steps back and forth across the surface, down to single roundings
            wisp_surface_point s = closest( SHAPES + k, random_point( i, k, 1.0f ) );
            float reach = ldexpf( 1.0f, -10 - i % 15 );
            wisp_vec3 a = blend( s.point, reach, random_point( i, 40 + k, 1.0f ) );
            wisp_vec3 b = blend( s.point, reach, random_point( i, 50 + k, 1.0f ) );
            wisp_shape_hit hit;
            bool begins_outside = closest( SHAPES + k, a ).distance >= 0.0f;
            bool ends_inside = closest( SHAPES + k, b ).distance < 0.0f;
            bool met = wisp_shape_cast( SHAPES + k, a, b, &hit );
            assert_true( met || !( begins_outside && ends_inside ) );
            assert_true( begins_outside || !met );
            entered += begins_outside && ends_inside ? 1 : 0;
        }
    }
    assert_true( entered > PATHS / 2 );
}

TEST( a_path_through_a_flat_plate_meets_it )
{
    const wisp_shape plate = { .kind = WISP_SHAPE_BOX, .half_extent = { 1.0f, 0.0f, 1.0f } };
    for ( int i = 0; i < 1000; ++i )
    {
        wisp_vec3 at = random_point( i, 0, 0.99f ), d = random_point( i, 1, 1.0f );
        float side = d.y < 0.0f ? 1.0f : -1.0f;
        at.y = 0.0f;
        wisp_shape_hit hit;
        assert_true( wisp_shape_cast( &plate, blend( at, -1.0f, d ), blend( at, 1.0f, d ), &hit ) ||
                     fabsf( at.x ) > 0.98f || fabsf( at.z ) > 0.98f );
        assert_near( hit.point, at, 1e-6f );
        assert_float_equal( hit.normal.y, side, 0.0f );
    }
}

TEST( beginning_on_the_surface_counts_only_on_the_way_in )
{
    const wisp_vec3 on[] = {
        { 0.3f, 0.0f, 0.2f }, { 0.7f, 0.0f, 0.0f }, { 0.4f, 0.1f, 0.0f }, { 0.5f, 0.1f, 0.1f }, { 0.0f, 0.75f, 0.0f }
    };
    const wisp_vec3 outward[] = {
        { 0.0f, 1.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 0.0f, 1.0f, 0.0f }
    };
    for ( int k = 0; k < WISP_COUNT( SHAPES ); ++k )
    {
        wisp_shape_hit hit;
        // through the whole body and out again, so that the end shows nothing
        assert_true( wisp_shape_cast( SHAPES + k, on[k], blend( on[k], -5.0f, outward[k] ), &hit ) );
        assert_float_equal( hit.time, 0.0f, 0.0f );
        assert_near( hit.normal, outward[k], 1e-6f );
        assert_false( wisp_shape_cast( SHAPES + k, on[k], blend( on[k], 1.0f, outward[k] ), &hit ) );
        assert_false( wisp_shape_cast( SHAPES + k, on[k], on[k], &hit ) );
    }
}

// ---- poses ----

static wisp_transform random_pose( int i, int k )
{
    wisp_vec3 q = random_point( i, k, 1.0f );
    float w = test_random_float( i, 3 * k + 90, -1.0f, 1.0f );
    return wisp_transform_make( ( wisp_quat ){ q.x, q.y, q.z, w }, random_point( i, k + 1, 2.0f ) );
}

TEST( into_the_body_and_back_is_where_one_was )
{
    for ( int i = 0; i < POINTS; ++i )
    {
        wisp_transform pose = random_pose( i, 0 );
        wisp_vec3 p = random_point( i, 5, 2.0f ), q = random_point( i, 6, 2.0f );
        wisp_vec3 a = wisp_transform_to_local( pose, p ), b = wisp_transform_to_local( pose, q );
        // coordinates of up to 6, a dozen roundings of 2^-24 each
        assert_near( wisp_transform_to_world( pose, a ), p, 5e-6f );
        assert_float_equal( length_of( blend( a, -1.0f, b ) ), length_of( blend( p, -1.0f, q ) ), 5e-6f );
    }
}

TEST( a_quarter_turn_goes_the_right_way )
{
    const float s = sqrtf( 0.5f );
    wisp_transform pose =
        wisp_transform_make( ( wisp_quat ){ 0.0f, 0.0f, 3.0f * s, 3.0f * s }, ( wisp_vec3 ){ 1, 2, 3 } );
    // one unit of rounding a product
    assert_near( wisp_transform_to_world( pose, ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f } ), ( wisp_vec3 ){ 1, 3, 3 },
                 5e-7f );
    assert_near( wisp_transform_to_world( pose, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } ), ( wisp_vec3 ){ 0, 2, 3 },
                 5e-7f );
}

TEST( a_rotation_without_a_direction_is_none )
{
    const wisp_quat bad[] = { { 0, 0, 0, 0 }, { NAN, 0, 0, 1 }, { INFINITY, 0, 0, 0 }, { 0, -INFINITY, NAN, 0 } };
    for ( int i = 0; i < WISP_COUNT( bad ); ++i )
    {
        wisp_transform pose = wisp_transform_make( bad[i], ( wisp_vec3 ){ 0, 0, 0 } );
        assert_near( wisp_transform_to_world( pose, ( wisp_vec3 ){ 1, 2, 3 } ), ( wisp_vec3 ){ 1, 2, 3 }, 0.0f );
    }
    wisp_transform tiny = wisp_transform_make( ( wisp_quat ){ 0, 1e-30f, 0, 0 }, ( wisp_vec3 ){ 0, 0, 0 } );
    assert_float_equal( tiny.rotation.y, 1.0f, 0.0f );
}

static wisp_transform turned_about_z( float degrees )
{
    float half = degrees * 0.00872664626f;
    return wisp_transform_make( ( wisp_quat ){ 0.0f, 0.0f, sinf( half ), cosf( half ) },
                                ( wisp_vec3 ){ degrees, 0, 0 } );
}

// The largest deviation from a uniform rotation, degrees.
static float turn_error( float degrees, float sign )
{
    wisp_transform from = turned_about_z( 0.0f ), to = turned_about_z( degrees );
    wisp_quat q = { sign * to.rotation.x, sign * to.rotation.y, sign * to.rotation.z, sign * to.rotation.w };
    to.rotation = q;
    float most = 0.0f;
    for ( int i = 0; i <= 100; ++i )
    {
        float t = 0.01f * (float)i;
        wisp_transform pose = wisp_transform_interpolate( from, to, t );
        wisp_vec3 x = wisp_quat_rotate( pose.rotation, ( wisp_vec3 ){ 1, 0, 0 } );
        most = fmaxf( most, fabsf( atan2f( x.y, x.x ) * 57.2957795f - t * degrees ) );
        assert_float_equal( pose.translation.x, t * degrees, 1e-5f );
        assert_float_equal( length_of( x ), 1.0f, 1e-6f );
    }
    return most;
}

TEST( poses_between_two_go_the_short_way_at_nearly_constant_speed )
{
    // the bounds that the header states; q and -q are the same rotation
    assert_true( turn_error( 20.0f, 1.0f ) <= 0.02f );
    assert_true( turn_error( 90.0f, 1.0f ) <= 2.0f );
    assert_true( turn_error( 90.0f, -1.0f ) <= 2.0f );
    assert_true( turn_error( 90.0f, 1.0f ) > 0.5f ); // the bound is not much too large

    wisp_transform a = random_pose( 3, 0 ), b = random_pose( 4, 0 );
    wisp_transform first = wisp_transform_interpolate( a, b, 0.0f ), last = wisp_transform_interpolate( a, b, 1.0f );
    assert_memory_equal( &first, &a, sizeof( a ) );
    assert_memory_equal( &last, &b, sizeof( b ) );
}

TEST( velocity_is_what_moves_a_point_from_pose_to_pose )
{
    for ( int i = 0; i < 200; ++i )
    {
        wisp_transform a = random_pose( i, 0 ), b = random_pose( i, 10 );
        wisp_vec3 p = random_point( i, 30, 1.0f ), start = wisp_transform_to_world( a, p );
        wisp_vec3 v = wisp_transform_velocity( a, b, 0.25f, p );
        assert_near( blend( start, 0.25f, v ), wisp_transform_to_world( b, p ),
                     2e-6f ); // roundings of positions of up to 4
        assert_near( wisp_transform_velocity( a, b, 0.0f, p ), ( wisp_vec3 ){ 0, 0, 0 }, 0.0f );
    }
}

// ---- inputs without a result ----

TEST( numbers_that_are_none_are_answered_with_nothing )
{
    const float bad[] = { NAN, INFINITY, -INFINITY };
    const wisp_vec3 good = { 0.0f, 3.0f, 0.0f };
    for ( int k = 0; k < WISP_COUNT( SHAPES ); ++k )
    {
        for ( int i = 0; i < 9; ++i )
        {
            wisp_vec3 p = { 0.1f, 0.2f, 0.3f };
            ( &p.x )[i % 3] = bad[i / 3];
            wisp_surface_point s;
            wisp_shape_hit hit;
            assert_false( wisp_shape_closest( SHAPES + k, p, &s ) );
            assert_true( isinf( s.distance ) && s.distance > 0.0f );
            assert_float_equal( length_of( s.normal ), 1.0f, 0.0f );
            assert_false( wisp_shape_cast( SHAPES + k, p, good, &hit ) );
            assert_false( wisp_shape_cast( SHAPES + k, good, p, &hit ) );
            assert_float_equal( hit.time, 0.0f, 0.0f );
        }
    }
}

TEST( a_wrong_size_has_no_surface )
{
    const wisp_shape wrong[] = {
        { .kind = WISP_SHAPE_SPHERE, .radius = -1.0f },
        { .kind = WISP_SHAPE_SPHERE, .radius = NAN },
        { .kind = WISP_SHAPE_CAPSULE, .radius = INFINITY },
        { .kind = WISP_SHAPE_CAPSULE, .half_length = -1e-9f },
        { .kind = WISP_SHAPE_BOX, .half_extent = { 1.0f, NAN, 1.0f } },
        { .kind = WISP_SHAPE_TAPERED_CAPSULE, .top_radius = NAN },
        { .kind = WISP_SHAPE_TAPERED_CAPSULE, .bottom_radius = -1.0f },
        { .kind = WISP_SHAPE_CONVEX },
        { .kind = WISP_SHAPE_HEIGHT_FIELD },
        { .kind = (wisp_shape_kind)17 },
    };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        wisp_surface_point s;
        wisp_shape_hit hit;
        const wisp_vec3 from = { 0.0f, 3.0f, 0.0f }, to = { 0.0f, -3.0f, 0.0f };
        assert_false( wisp_shape_closest( wrong + i, ( wisp_vec3 ){ 0, 0, 0 }, &s ) );
        assert_false( wisp_shape_cast( wrong + i, from, to, &hit ) );
    }
}
