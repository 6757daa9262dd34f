// Bodies with a closed form: distances against their own gradients, paths against dense sampling, poses against each
// other, and inputs without a result. Convex polyhedra and height fields: against boxes, planes, brute force over all
// triangles, and dense sampling.
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

enum
{
    SOLID_POINTS = 1500,
    SOLID_PATHS = 1500,
};

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
    for ( int i = 0; i < SOLID_POINTS; ++i )
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
        for ( int i = 0; i < SOLID_POINTS / 4; ++i )
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
    for ( int i = 0; i < SOLID_POINTS; ++i )
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

// ---- paths to solids ----

static void check_paths( const wisp_shape* shape )
{
    int met = 0, entered = 0;
    for ( int i = 0; i < SOLID_PATHS; ++i )
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
    assert_true( met > SOLID_PATHS / 20 && entered > SOLID_PATHS / 20 );
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
