// Fine curvature against ripples in closed form.
#include "unit.h"

#include "suite_compare.h"

#include <math.h>

enum
{
    SIDE = 17,
};

// A sheet with ripples along x. The normal of its vertices is upright but for the square of the slope.
static void ripple( double height, wisp_vec3* points )
{
    for ( int i = 0; i < SIDE * SIDE; ++i )
    {
        const double x = i % SIDE;
        points[i] = ( wisp_vec3 ){ (float)x, (float)( height * sin( x ) ), (float)( i / SIDE ) };
    }
}

static int make_triangles( int32_t* out )
{
    int count = 0;
    for ( int i = 0; i < SIDE * ( SIDE - 1 ); ++i )
    {
        if ( i % SIDE < SIDE - 1 )
        {
            const int32_t corners[6] = { i, i + SIDE, i + 1, i + 1, i + SIDE, i + SIDE + 1 };
            memcpy( out + 3 * (size_t)count, corners, sizeof corners );
            count += 2;
        }
    }
    return count;
}

TEST( ripples_of_half_the_height_are_half_the_detail )
{
    static wisp_vec3 low[SIDE * SIDE], high[SIDE * SIDE];
    static int32_t triangles[6 * SIDE * SIDE];
    int first[2] = { 0, SIDE * SIDE };
    wisp_record_body body = { .name = "sheet", .triangles = triangles, .vertex_count = SIDE * SIDE };
    body.triangle_count = make_triangles( triangles );
    ripple( 0.005, low );
    ripple( 0.01, high );
    const suite_motion one = { .bodies = &body, .body_count = 1, .first = first, .points = low, .frame_count = 1 };
    const suite_motion other = { .bodies = &body, .body_count = 1, .first = first, .points = high, .frame_count = 1 };
    // the square of the slope is 1e-4
    assert_true( fabs( suite_detail( &one, &other, 1 ) - 0.5 ) < 1e-4 );
    assert_true( fabs( suite_detail( &other, &other, 1 ) - 1.0 ) < 1e-12 );
    ripple( 0.0, low );
    assert_true( suite_detail( &one, &other, 1 ) == 0.0 );
    assert_true( isnan( suite_detail( &other, &one, 1 ) ) );
}
