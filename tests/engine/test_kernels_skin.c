// Skinning: the object, both methods against closed forms and the oracle, the same bits from every table and in any ranges.
#include "kernels_fixture.h"

#include "constraint_oracle.h"

#include "wisp/skin.h"

enum
{
    POINTS = 203,
    BONES = 9,
};

typedef struct bound_body
{
    wisp_vec3 points[POINTS];
    int32_t bones[POINTS][4];
    float weights[POINTS][4];
    wisp_affine inverse_bind[BONES], now[BONES];
    wisp_skin_def def;
} bound_body;

static wisp_transform random_pose( int seed )
{
    const wisp_quat q = { test_random_float( seed, 0, -1.0f, 1.0f ), test_random_float( seed, 1, -1.0f, 1.0f ),
                          test_random_float( seed, 2, -1.0f, 1.0f ), test_random_float( seed, 3, -1.0f, 1.0f ) };
    const wisp_vec3 t = { test_random_float( seed, 4, -2.0f, 2.0f ), test_random_float( seed, 5, -2.0f, 2.0f ),
                          test_random_float( seed, 6, -2.0f, 2.0f ) };
    return wisp_transform_make( q, t );
}

static wisp_affine random_rigid( int seed )
{
    return wisp_affine_from_transform( random_pose( seed ), ( wisp_vec3 ){ 1.0f, 1.0f, 1.0f } );
}

static wisp_vec3 applied( const wisp_affine* a, wisp_vec3 p )
{
    float out[3];
    for ( int r = 0; r < 3; ++r )
    {
        out[r] = a->m[r][0] * p.x + a->m[r][1] * p.y + a->m[r][2] * p.z + a->m[r][3];
    }
    return ( wisp_vec3 ){ out[0], out[1], out[2] };
}

// Points that follow one to four bones, in changing order; numbers of bones without weight are nonsense.
static void make_body( bound_body* b )
{
    for ( int v = 0; v < POINTS; ++v )
    {
        b->points[v] =
            ( wisp_vec3 ){ test_random_float( v, 10, -1.0f, 1.0f ), test_random_float( v, 11, -1.0f, 1.0f ),
                           test_random_float( v, 12, -1.0f, 1.0f ) };
        const int count = 1 + ( v * 7 / 3 ) % 4;
        for ( int k = 0; k < 4; ++k )
        {
            const bool used = ( k + v ) % 4 < count;
            b->bones[v][k] = used ? ( v + 2 * k ) % BONES : -1 - v;
            b->weights[v][k] = used ? test_random_float( v, 20 + k, 0.1f, 3.0f ) : 0.0f;
        }
    }
    for ( int i = 0; i < BONES; ++i )
    {
        b->inverse_bind[i] = random_rigid( 1000 + i );
        b->now[i] = random_rigid( 2000 + i );
    }
    b->def = wisp_default_skin_def();
    b->def.points = b->points;
    b->def.bones = (const int32_t( * )[4])b->bones;
    b->def.weights = (const float( * )[4])b->weights;
    b->def.point_count = POINTS;
    b->def.bone_count = BONES;
    b->def.inverse_bind = b->inverse_bind;
}

static wisp_skin* skin_of( const bound_body* b )
{
    wisp_skin* skin = NULL;
    wisp_error error = { 0 };
    if ( wisp_skin_create( &b->def, NULL, &skin, &error ) != WISP_OK )
    {
        fail_msg( "%s", error.message );
    }
    return skin;
}

static void compute( const bound_body* b, wisp_skin_method method, wisp_vec3* out )
{
    wisp_skin* skin = skin_of( b );
    wisp_skin_pose pose = { 0 };
    wisp_error error = { 0 };
    if ( wisp_skin_points( skin, &pose, method, b->now, out, &error ) != WISP_OK )
    {
        fail_msg( "%s", error.message );
    }
    wisp_skin_pose_release( &pose, NULL );
    wisp_skin_release( skin );
}

static double3 expected_point( const bound_body* b, wisp_skin_method method, int v )
{
    skin_oracle_bone bones[4];
    double weights[4], sum = 0.0;
    int count = 0;
    for ( int k = 0; k < 4; ++k )
    {
        sum += (double)b->weights[v][k];
        for ( int i = 0; b->weights[v][k] > 0.0f && i < 12; ++i )
        {
            const float( *m )[4] = b->now[b->bones[v][k]].m;
            const int r = i / 4, c = i % 4;
            double entry = c == 3 ? (double)m[r][3] : 0.0;
            for ( int j = 0; j < 3; ++j )
            {
                entry += (double)m[r][j] * (double)b->inverse_bind[b->bones[v][k]].m[j][c];
            }
            bones[count].m[r][c] = entry;
        }
        weights[count] = (double)b->weights[v][k];
        count += b->weights[v][k] > 0.0f ? 1 : 0;
    }
    for ( int k = 0; k < count; ++k )
    {
        weights[k] /= sum;
    }
    const double3 p = double3_widen( b->points[v] );
    return method == WISP_SKIN_LINEAR ? skin_oracle_linear( bones, weights, count, p )
                                      : skin_oracle_dual_quaternion( bones, weights, count, p );
}

TEST( points_are_those_of_the_oracle )
{
    bound_body b;
    make_body( &b );
    for ( int method = 0; method < WISP_SKIN_METHOD_COUNT; ++method )
    {
        wisp_vec3 out[POINTS];
        compute( &b, (wisp_skin_method)method, out );
        for ( int v = 0; v < POINTS; ++v )
        {
            // 5 m at most, some thirty roundings; the mean of quaternions may be as short as the largest weight, a quarter
            const double tolerance = ( method == WISP_SKIN_LINEAR ? 20.0 : 120.0 ) * (double)FLT_EPSILON;
            assert_near_vector( double3_widen( out[v] ), expected_point( &b, (wisp_skin_method)method, v ), tolerance,
                                "distance from the oracle", v );
        }
    }
}

TEST( every_table_gives_the_same_bits )
{
    bound_body b;
    make_body( &b );
    wisp_skin* skin = skin_of( &b );
    for ( int method = 0; method < WISP_SKIN_METHOD_COUNT; ++method )
    {
        wisp_skin_pose pose = { 0 };
        wisp_vec3 expected[POINTS];
        assert_int_equal( wisp_skin_points( skin, &pose, (wisp_skin_method)method, b.now, expected, NULL ), WISP_OK );
        for ( const wisp_kernels* const* t = every_table(); *t != NULL; ++t )
        {
            wisp_vec3 found[POINTS] = { { 0 } };
            for ( int k = 0; k < 4; ++k )
            {
                const wisp_skin_args args = { skin->xyz, skin->point, skin->bones, skin->weights,
                                              pose.rows, found,       k + 1 };
                ( method == WISP_SKIN_LINEAR ? ( *t )->skin_linear : ( *t )->skin_dual_quaternion )(
                    &args, skin->influence_begin[k], skin->influence_begin[k + 1] );
            }
            assert_memory_equal( found, expected, sizeof( found ) );
        }
        wisp_skin_pose_release( &pose, NULL );
    }
    wisp_skin_release( skin );
}

TEST( one_motion_of_all_bones_is_that_of_the_points )
{
    bound_body b;
    make_body( &b );
    const wisp_affine motion = random_rigid( 5 );
    wisp_vec3 out[POINTS];

    // without bind transforms, linear blend gives the motion to the last bit whatever the weights
    b.def.inverse_bind = NULL;
    for ( int i = 0; i < BONES; ++i )
    {
        b.now[i] = motion;
    }
    compute( &b, WISP_SKIN_LINEAR, out );
    for ( int v = 0; v < POINTS; ++v )
    {
        const wisp_vec3 p = applied( &motion, b.points[v] );
        assert_memory_equal( &out[v], &p, sizeof( p ) );
    }

    // with them, matrices and quaternions are rounded
    b.def.inverse_bind = b.inverse_bind;
    for ( int i = 0; i < BONES; ++i )
    {
        const wisp_transform pose = random_pose( 1000 + i );
        const wisp_quat q = pose.rotation, back = { -q.x, -q.y, -q.z, q.w };
        const wisp_vec3 from = wisp_transform_to_local( pose, ( wisp_vec3 ){ 0 } ), unit = { 1.0f, 1.0f, 1.0f };
        const wisp_affine bind = wisp_affine_from_transform( wisp_transform_make( back, from ), unit );
        b.now[i] = wisp_affine_multiply( &motion, &bind );
    }
    for ( int method = 0; method < WISP_SKIN_METHOD_COUNT; ++method )
    {
        compute( &b, (wisp_skin_method)method, out );
        for ( int v = 0; v < POINTS; ++v )
        {
            const double3 p = double3_widen( applied( &motion, b.points[v] ) );
            assert_near_vector( double3_widen( out[v] ), p, 40.0 * (double)FLT_EPSILON, "rigid motion", v );
        }
    }
}

TEST( a_point_of_one_bone_follows_it )
{
    bound_body b;
    make_body( &b );
    b.def.inverse_bind = NULL;
    for ( int v = 0; v < POINTS; ++v )
    {
        for ( int k = 0; k < 4; ++k )
        {
            // one bone twice is one bone
            b.weights[v][k] = k == v % 4 || k == 0 ? 0.3f : 0.0f;
            b.bones[v][k] = v % BONES;
        }
    }
    wisp_vec3 out[POINTS];
    compute( &b, WISP_SKIN_LINEAR, out );
    for ( int v = 0; v < POINTS; ++v )
    {
        const wisp_vec3 p = applied( &b.now[v % BONES], b.points[v] );
        assert_memory_equal( &out[v], &p, sizeof( p ) );
    }
    compute( &b, WISP_SKIN_DUAL_QUATERNION, out );
    for ( int v = 0; v < POINTS; ++v )
    {
        const wisp_vec3 p = applied( &b.now[v % BONES], b.points[v] );
        assert_near_vector( double3_widen( out[v] ), double3_widen( p ), 30.0 * (double)FLT_EPSILON, "bone", v );
    }
}

// A ring of a tube along y between two bones, of which one turns about y by an angle. With equal weights, linear blend shrinks its
// radius to cos( angle / 2 ), and dual quaternions keep it and turn it by half the angle.
TEST( a_twist_collapses_linear_blend_and_keeps_the_radius_of_dual_quaternions )
{
    for ( int step = 0; step <= 4; ++step )
    {
        const double angle = 0.785398163397448310 * step, radius = 0.25, from = 0.7;
        const wisp_vec3 p = { (float)( radius * cos( from ) ), 0.5f, (float)( radius * -sin( from ) ) };
        const int32_t bones[1][4] = { { 0, 1, 0, 0 } };
        const float weights[1][4] = { { 0.5f, 0.5f, 0.0f, 0.0f } };
        wisp_skin_def def = wisp_default_skin_def();
        def.points = &p, def.bones = bones, def.weights = weights, def.point_count = 1, def.bone_count = 2;
        const wisp_quat turn = { 0.0f, (float)sin( 0.5 * angle ), 0.0f, (float)cos( 0.5 * angle ) };
        const wisp_vec3 none = { 0.0f, 0.0f, 0.0f }, unit = { 1.0f, 1.0f, 1.0f };
        const wisp_affine now[2] = { wisp_affine_identity(),
                                     wisp_affine_from_transform( wisp_transform_make( turn, none ), unit ) };
        wisp_skin* skin = NULL;
        wisp_skin_pose pose = { 0 };
        wisp_vec3 out;
        assert_int_equal( wisp_skin_create( &def, NULL, &skin, NULL ), WISP_OK );
        assert_int_equal( wisp_skin_points( skin, &pose, WISP_SKIN_LINEAR, now, &out, NULL ), WISP_OK );
        const double shrunk = radius * cos( 0.5 * angle ), at = from + 0.5 * angle;
        assert_near_vector( double3_widen( out ), double3_make( shrunk * cos( at ), 0.5, -shrunk * sin( at ) ),
                            2.0 * (double)FLT_EPSILON, "linear blend", step );
        assert_int_equal( wisp_skin_points( skin, &pose, WISP_SKIN_DUAL_QUATERNION, now, &out, NULL ), WISP_OK );
        assert_near_vector( double3_widen( out ), double3_make( radius * cos( at ), 0.5, -radius * sin( at ) ),
                            2.0 * (double)FLT_EPSILON, "dual quaternions", step );
        wisp_skin_pose_release( &pose, NULL );
        wisp_skin_release( skin );
    }
}

TEST( scale_of_the_bind_pose_that_bones_undo_is_rigid )
{
    bound_body b;
    make_body( &b );
    const wisp_vec3 none = { 0.0f, 0.0f, 0.0f }, small = { 1 / 128.0f, 1 / 128.0f, 1 / 128.0f },
                    large = { 128.0f, 128.0f, 128.0f };
    const wisp_transform rest = wisp_transform_make( ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 1.0f }, none );
    const wisp_affine scale = wisp_affine_from_transform( rest, small );
    for ( int i = 0; i < BONES; ++i )
    {
        b.inverse_bind[i] = wisp_affine_from_transform( rest, large );
        b.now[i] = wisp_affine_multiply( &b.now[i], &scale );
    }
    wisp_vec3 out[POINTS];
    compute( &b, WISP_SKIN_DUAL_QUATERNION, out );
    assert_near_vector( double3_widen( out[5] ), expected_point( &b, WISP_SKIN_DUAL_QUATERNION, 5 ), 2e-5, "point",
                        5 );
}

static void assert_refused( const bound_body* b, const char* message )
{
    wisp_skin* skin = NULL;
    wisp_error error = { 0 };
    assert_int_equal( wisp_skin_create( &b->def, NULL, &skin, &error ), WISP_BAD_INPUT );
    assert_string_equal( error.message, message );
    assert_null( skin );
}

TEST( wrong_vertices_are_named )
{
    bound_body b;
    make_body( &b );
    b.weights[17][0] = NAN;
    assert_refused( &b, "vertex 17: got weight nan, expected a finite number of 0 or more" );
    b.weights[17][0] = -0.5f;
    assert_refused( &b, "vertex 17: got weight -0.5, expected a finite number of 0 or more" );
    make_body( &b );
    memset( b.weights[9], 0, sizeof( b.weights[9] ) );
    assert_refused( &b, "vertex 9: got weights that sum to 0, expected a sum above 0" );
    make_body( &b );
    b.weights[11][3] = 1.0f;
    b.bones[11][3] = BONES;
    assert_refused( &b, "vertex 11: got bone 9, but the skin has 9 bones" );
    make_body( &b );
    b.points[3].y = INFINITY;
    b.points[3].x = b.points[3].z = 0.0f;
    assert_refused( &b, "vertex 3: got (0, inf, 0), expected finite coordinates within 1e+06 m of the origin" );
    make_body( &b );
    b.inverse_bind[4].m[2][3] = NAN;
    assert_refused( &b, "bone 4: got an inverse bind transform that is not finite" );
    make_body( &b );
    b.def.bone_count = 0;
    assert_refused( &b, "skin: bone_count: got 0, expected 1 to 65536" );
    make_body( &b );
    b.def.weights = NULL;
    assert_refused( &b, "skin: got a null list, expected points, bones and weights of 203 points" );
}

TEST( wrong_bones_are_named_and_nothing_is_written )
{
    bound_body b;
    make_body( &b );
    wisp_skin* skin = skin_of( &b );
    wisp_skin_pose pose = { 0 };
    wisp_vec3 out[POINTS] = { { 0 } }, zero[POINTS] = { { 0 } };
    wisp_error error = { 0 };
    b.now[6].m[1][1] = NAN;
    assert_int_equal( wisp_skin_points( skin, &pose, WISP_SKIN_LINEAR, b.now, out, &error ), WISP_BAD_INPUT );
    assert_string_equal( error.message, "bone 6: got a matrix that is not finite" );
    make_body( &b );
    for ( int i = 0; i < 12; ++i )
    {
        b.now[7].m[i / 4][i % 4] *= i < 4 ? -1.0f : 1.0f;
    }
    assert_int_equal( wisp_skin_points( skin, &pose, WISP_SKIN_DUAL_QUATERNION, b.now, out, &error ),
                      WISP_BAD_INPUT );
    assert_string_equal( error.message, "bone 7: got a matrix that scales, shears or mirrors the bind pose (by 2), "
                                        "expected a rotation and a translation for dual quaternions" );
    assert_memory_equal( out, zero, sizeof( out ) );
    assert_int_equal( wisp_skin_points( skin, &pose, WISP_SKIN_LINEAR, b.now, out, &error ), WISP_OK );
    assert_int_equal( wisp_skin_points( skin, &pose, (wisp_skin_method)7, b.now, out, &error ), WISP_BAD_INPUT );
    wisp_skin_pose_release( &pose, NULL );
    wisp_skin_release( skin );
}

TEST( memory_is_of_the_host_and_taken_once )
{
    bound_body b;
    make_body( &b );
    test_host counted = { 0 }, empty = { .refuse = 1, .refuse_rest = true };
    const wisp_allocator host = test_host_allocator( &counted ), mean = test_host_allocator( &empty );
    wisp_skin *skin = NULL, *refused = NULL;
    assert_int_equal( wisp_skin_create( &b.def, &mean, &refused, NULL ), WISP_NO_MEMORY );
    assert_null( refused );
    assert_int_equal( wisp_skin_create( &b.def, &host, &skin, NULL ), WISP_OK );
    wisp_skin_pose pose = { 0 };
    assert_int_equal( wisp_skin_pose_set( &pose, skin, WISP_SKIN_LINEAR, b.now, &mean, NULL ), WISP_NO_MEMORY );
    for ( int i = 0; i < 3; ++i )
    {
        assert_int_equal( wisp_skin_pose_set( &pose, skin, WISP_SKIN_LINEAR, b.now, &host, NULL ), WISP_OK );
    }
    assert_int_equal( atomic_load( &counted.queried ), 2 );
    wisp_skin_pose_release( &pose, &host );
    wisp_skin_release( skin );
    assert_host_memory_is_released( &counted );
}
