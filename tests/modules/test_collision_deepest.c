// The deepest point of segments and triangles in convex bodies, against samples in double precision.
#include "oracle/deepest_oracle.h"
#include "surface_fixture.h"

#include "deepest_point.h"
#include "wisp/module/shapes.h"

static uint32_t seed;

static double random_in( double lower, double upper )
{
    seed = seed * 1664525u + 1013904223u;
    return lower + ( upper - lower ) * (double)( seed >> 8 ) / 16777216.0;
}

static wisp_vec3 random_point( double size )
{
    return ( wisp_vec3 ){ (float)random_in( -size, size ), (float)random_in( -size, size ),
                          (float)random_in( -size, size ) };
}

// Compare a primitive. Exact is what the tolerance and single precision leave.
static void compare( const wisp_shape* shape, const deepest_oracle_body* body, const wisp_vec3* corners, int count,
                     double tolerance )
{
    collision_deepest found;
    assert_true( collision_find_deepest( shape, corners, count, (float)tolerance, &found ) );
    double3 wide[3];
    double3 at = { 0.0, 0.0, 0.0 };
    double sum = 0.0, corner = INFINITY;
    for ( int k = 0; k < count; ++k )
    {
        wide[k] = double3_widen( corners[k] );
        assert_true( found.weights[k] >= 0.0f );
        at = double3_add_scaled( at, (double)found.weights[k], wide[k] );
        sum += (double)found.weights[k];
        corner = fmin( corner, deepest_oracle_distance( body, wide[k] ) );
    }
    const double rounding = 1e-6;
    const double least = deepest_oracle_find( body, wide, count, NULL );
    assert_near( sum, 1.0, rounding );
    float nearest;
    const float bound = collision_bound_deepest( shape, corners, count, &nearest );
    assert_near( (double)nearest, corner, rounding );
    assert_true( (double)bound <= least + rounding );
    // the distance is that of the point with these weights
    assert_near( (double)found.surface.distance, deepest_oracle_distance( body, at ), rounding );
    // and not above the smallest one by more than the tolerance
    if ( (double)found.surface.distance > least + tolerance + rounding )
    {
        fail_msg( "kind %d, %d corners: got %g, expected %g", (int)shape->kind, count, (double)found.surface.distance,
                  least );
    }
}

static void compare_many( const wisp_shape* shape, const deepest_oracle_body* body, int rounds )
{
    static const double sizes[] = { 0.02, 0.1, 0.5, 2.0 };
    for ( int n = 0; n < rounds; ++n )
    {
        const wisp_vec3 near = random_point( 1.0 );
        const double size = sizes[n % WISP_COUNT( sizes )];
        wisp_vec3 corners[3];
        for ( int k = 0; k < 3; ++k )
        {
            corners[k] = collision_add_scaled( near, 1.0f, random_point( size ) );
        }
        compare( shape, body, corners, 2, 1e-4 );
        compare( shape, body, corners, 3, 1e-4 );
    }
}

TEST( the_deepest_point_is_that_of_samples_in_each_closed_form )
{
    seed = 7;
    const wisp_shape shapes[] = {
        { .kind = WISP_SHAPE_SPHERE, .radius = 0.4f },
        { .kind = WISP_SHAPE_CAPSULE, .radius = 0.1f, .half_length = 0.6f },
        { .kind = WISP_SHAPE_CAPSULE, .radius = 0.001f, .half_length = 0.6f },
        { .kind = WISP_SHAPE_BOX, .half_extent = { 0.3f, 0.5f, 0.2f } },
        { .kind = WISP_SHAPE_TAPERED_CAPSULE, .top_radius = 0.1f, .bottom_radius = 0.3f, .half_length = 0.5f },
    };
    for ( int i = 0; i < WISP_COUNT( shapes ); ++i )
    {
        const deepest_oracle_body body = deepest_oracle_body_of( shapes + i );
        compare_many( shapes + i, &body, shapes[i].kind == WISP_SHAPE_TAPERED_CAPSULE ? 8 : 80 );
    }
}

TEST( the_deepest_point_is_that_of_samples_in_a_convex_polyhedron )
{
    seed = 11;
    test_mesh ball = test_ball( 0 );
    for ( int v = 0; v < ball.vertex_count; ++v )
    {
        const wisp_vec3 p = ball.points[v];
        ball.points[v] = ( wisp_vec3 ){ 0.5f * p.x + 0.1f * p.y, 0.3f * p.y, 0.4f * p.z };
    }
    wisp_convex* convex;
    assert_int_equal( wisp_convex_create( ball.points, ball.vertex_count, NULL, &convex, NULL ), WISP_OK );
    const wisp_shape shape = { .kind = WISP_SHAPE_CONVEX, .convex = convex };
    const deepest_oracle_body body = { .kind = WISP_SHAPE_CONVEX,
                                       .points = ball.points,
                                       .triangles = ball.triangles,
                                       .triangle_count = ball.triangle_count };
    compare_many( &shape, &body, 60 );
    wisp_convex_release( convex );
    test_mesh_free( &ball );
}

// The hard cases: parallel to an axis or a face, through the middle, degenerate.
TEST( flat_and_degenerate_primitives_have_a_deepest_point )
{
    const wisp_shape shapes[] = {
        { .kind = WISP_SHAPE_SPHERE, .radius = 0.4f },
        { .kind = WISP_SHAPE_CAPSULE, .radius = 0.1f, .half_length = 0.5f },
        { .kind = WISP_SHAPE_BOX, .half_extent = { 0.3f, 0.5f, 0.2f } },
    };
    static const wisp_vec3 cases[][3] = {
        { { -1, 0, 0 }, { 1, 0, 0 }, { 0, 0, 1 } },                           // through the middle
        { { 0, -1, 0 }, { 0, 1, 0 }, { 0.5f, 0, 0 } },                        // along the axis of the capsule
        { { -1, 0.5f, -1 }, { 1, 0.5f, -1 }, { 0, 0.5f, 1 } },                // in the plane of a face
        { { -1, 0.6f, -1 }, { 1, 0.6f, -1 }, { 0, 0.6f, 1 } },                // parallel to it
        { { 0.3f, 0.5f, 0.2f }, { 0.3f, 0.5f, 0.2f }, { 0.3f, 0.5f, 0.2f } }, // a point, the corner of the box
        { { 1, 1, 1 }, { 1, 1, 1 }, { -1, -1, -1 } },                         // a line
        { { -1, 0.7f, 0.2f }, { 0, 0.7f, 0.2f }, { 1, 0.7f, 0.2f } },
    };
    for ( int i = 0; i < WISP_COUNT( shapes ); ++i )
    {
        const deepest_oracle_body body = deepest_oracle_body_of( shapes + i );
        for ( int n = 0; n < WISP_COUNT( cases ); ++n )
        {
            compare( shapes + i, &body, cases[n], 2, 1e-4 );
            compare( shapes + i, &body, cases[n], 3, 1e-4 );
        }
    }
}

TEST( what_is_not_finite_has_no_deepest_point )
{
    const wisp_shape ball = { .kind = WISP_SHAPE_SPHERE, .radius = 0.4f };
    collision_deepest found;
    const wisp_vec3 corners[3] = { { 0, 1, 0 }, { NAN, 0, 0 }, { 1, 0, INFINITY } };
    assert_false( collision_find_deepest( &ball, corners, 2, 1e-4f, &found ) );
    assert_false( collision_find_deepest( &ball, corners, 3, 1e-4f, &found ) );
}
