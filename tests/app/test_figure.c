// The generated figure: its mesh, its weights, and how it stands in every pose of its clips.
#include "mesh_fixture.h"

#include "figure.h"
#include "io_file.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#define MOTIONS WISP_SOURCE_ROOT "/data/figures/motions.yaml"

static wisp_figure made( float height, int triangles )
{
    const wisp_figure_generator generator = { height, triangles };
    wisp_figure figure;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_figure_generate( &generator, &figure, &error ), error );
    return figure;
}

static double distance( wisp_vec3 a, wisp_vec3 b )
{
    const double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
    return sqrt( x * x + y * y + z * z );
}

// ---- the mesh ----

TEST( figures_of_any_size_are_closed_and_have_as_many_triangles_as_was_asked )
{
    static const int counts[] = { WISP_FIGURE_MIN_TRIANGLES, 3000, 8000 };
    for ( int i = 0; i < WISP_COUNT( counts ); ++i )
    {
        wisp_figure figure = made( 1.0f + (float)i, counts[i] );
        wisp_mesh_diagnostics report;
        wisp_error error = { .status = WISP_OK };
        assert_ok( wisp_mesh_examine( &figure.mesh, &report, &error ), error );
        assert_ok( wisp_mesh_require( &report,
                                      WISP_MESH_CLOSED | WISP_MESH_ORIENTED | WISP_MESH_MANIFOLD | WISP_MESH_CLEAN,
                                      "figure", &error ),
                   error );
        assert_int_equal( report.component_count, 1 );
        assert_true( abs( figure.mesh.triangle_count - counts[i] ) * 20 <= counts[i] );
        float lowest = 1e9f, highest = -1e9f;
        for ( int v = 0; v < figure.mesh.vertex_count; ++v )
        {
            lowest = fminf( lowest, figure.mesh.points[v].y );
            highest = fmaxf( highest, figure.mesh.points[v].y );
        }
        // as tall as it is called, and on the ground
        assert_true( fabsf( highest - lowest - ( 1.0f + (float)i ) ) < 0.03f * ( 1.0f + (float)i ) );
        assert_true( fabsf( lowest ) < 0.02f * ( 1.0f + (float)i ) );
        wisp_figure_release( &figure );
    }
}

TEST( the_same_figure_has_the_same_bits )
{
    wisp_figure a = made( 1.75f, 3000 ), b = made( 1.75f, 3000 );
    assert_int_equal( a.mesh.vertex_count, b.mesh.vertex_count );
    assert_memory_equal( a.mesh.points, b.mesh.points, (size_t)a.mesh.vertex_count * sizeof( wisp_vec3 ) );
    assert_memory_equal( a.weights.weights, b.weights.weights,
                         (size_t)a.mesh.vertex_count * sizeof *a.weights.weights );
    wisp_figure_release( &a );
    wisp_figure_release( &b );
}

TEST( figures_that_cannot_be_made_are_refused_by_the_name_of_their_value )
{
    static const struct
    {
        wisp_figure_generator generator;
        const char* words;
    } cases[] = { { { 0.0f, 8000 }, "height: got 0, expected 0.001 .. 1000" },
                  { { NAN, 8000 }, "height: got nan" },
                  { { 1.75f, 1499 }, "triangles: got 1499, expected 1500 .. 200000" },
                  { { 1.75f, 200001 }, "triangles: got 200001" } };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        wisp_figure figure;
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( wisp_figure_generate( &cases[i].generator, &figure, &error ), WISP_BAD_INPUT );
        assert_contains( error.message, cases[i].words );
        assert_null( figure.mesh.points );
    }
}

// ---- weights ----

static wisp_vec3 place_of( const wisp_skeleton* skeleton, int joint )
{
    const wisp_affine* bind = &skeleton->joints[joint].inverse_bind;
    return ( wisp_vec3 ){ -bind->m[0][3], -bind->m[1][3], -bind->m[2][3] };
}

// From the nearest point of the bones that begin at a joint.
static double distance_from_bones( const wisp_skeleton* skeleton, int joint, wisp_vec3 p )
{
    const wisp_vec3 from = place_of( skeleton, joint );
    double least = distance( from, p );
    for ( int j = 0; j < skeleton->joint_count; ++j )
    {
        const wisp_vec3 to = place_of( skeleton, j );
        for ( int i = 1; skeleton->joints[j].parent == joint && i <= 10; ++i )
        {
            const float s = 0.1f * (float)i;
            const wisp_vec3 q = { from.x + s * ( to.x - from.x ), from.y + s * ( to.y - from.y ),
                                  from.z + s * ( to.z - from.z ) };
            least = fmin( least, distance( q, p ) );
        }
    }
    return least;
}

TEST( vertices_follow_joints_whose_bones_are_near )
{
    wisp_figure figure = made( 1.0f, 8000 );
    for ( int v = 0; v < figure.mesh.vertex_count; ++v )
    {
        double sum = 0.0;
        for ( int k = 0; k < 4; ++k )
        {
            const float weight = figure.weights.weights[v][k];
            sum += (double)weight;
            assert_true( weight >= 0.0f && weight <= 1.0f );
            // the fingertips are the farthest from a joint, and the chest is wide
            assert_true( weight < 0.02f || distance_from_bones( &figure.skeleton, figure.weights.joints[v][k],
                                                                figure.mesh.points[v] ) < 0.15 );
        }
        assert_true( fabs( sum - 1.0 ) < 1e-6 );
    }
    wisp_figure_release( &figure );
}

// ---- poses ----

typedef struct posed
{
    wisp_figure figure;
    wisp_skin* skin;
    wisp_animation clip;
    wisp_skin_pose pose;
    wisp_affine joints[64];
    wisp_vec3* points;
} posed;

static void read_clip( posed* p, const char* name )
{
    unsigned char* text = NULL;
    size_t size = 0;
    wisp_error error = { .status = WISP_OK };
    assert_ok( io_file_read( MOTIONS, 1 << 20, &text, &size, &error ), error );
    assert_ok( wisp_animation_parse( text, size, MOTIONS, name, &p->figure.skeleton, 1.0f, &p->clip, &error ),
               error );
    free( text );
}

static void set_up( posed* p, const char* clip )
{
    *p = ( posed ){ .figure = made( 1.75f, 3000 ) };
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_skeleton_check( &p->figure.skeleton, &error ), error );
    assert_ok( wisp_skeleton_skin( &p->figure.skeleton, p->figure.mesh.points, &p->figure.weights, &p->skin, &error ),
               error );
    p->points = calloc( (size_t)p->figure.mesh.vertex_count, sizeof *p->points );
    if ( clip != NULL )
    {
        read_clip( p, clip );
    }
}

static void pose_at( posed* p, float time, wisp_skin_method method )
{
    wisp_error error = { .status = WISP_OK };
    wisp_skeleton_pose( &p->figure.skeleton, p->clip.track_count > 0 ? &p->clip : NULL, time, p->joints );
    assert_ok( wisp_skin_points( p->skin, &p->pose, method, p->joints, p->points, &error ), error );
}

static void tear_down( posed* p )
{
    wisp_skin_pose_release( &p->pose, NULL );
    wisp_skin_release( p->skin );
    wisp_animation_release( &p->clip );
    wisp_figure_release( &p->figure );
    free( p->points );
}

TEST( at_rest_the_skin_is_the_mesh )
{
    posed p;
    set_up( &p, NULL );
    for ( int method = 0; method < WISP_SKIN_METHOD_COUNT; ++method )
    {
        pose_at( &p, 0.0f, (wisp_skin_method)method );
        for ( int v = 0; v < p.figure.mesh.vertex_count; ++v )
        {
            assert_true( distance( p.points[v], p.figure.mesh.points[v] ) < 1e-6 );
        }
    }
    tear_down( &p );
}

static double longest_edge( const posed* p )
{
    double most = 0.0;
    const wisp_mesh* mesh = &p->figure.mesh;
    for ( int c = 0; c < 3 * mesh->triangle_count; ++c )
    {
        const int32_t a = mesh->triangles[c], b = mesh->triangles[c % 3 == 2 ? c - 2 : c + 1];
        most = fmax( most, distance( p->points[a], p->points[b] ) );
    }
    return most;
}

// A vertex that follows a wrong joint leaves its neighbours behind.
TEST( the_skin_stays_whole_and_on_the_ground_in_all_clips )
{
    static const char* const names[] = { "walk", "turn", "jump" };
    for ( int c = 0; c < WISP_COUNT( names ); ++c )
    {
        posed p;
        set_up( &p, names[c] );
        pose_at( &p, -1.0f, WISP_SKIN_LINEAR );
        const bool jumps = c == 2;
        float highest = -1.0f;
        double longest = 0.0;
        for ( int i = 0; i < 2 * 20; ++i )
        {
            pose_at( &p, p.clip.duration * (float)( i / 2 ) / 20.0f, (wisp_skin_method)( i % 2 ) );
            longest = fmax( longest, longest_edge( &p ) );
            float lowest = 1e9f;
            for ( int v = 0; v < p.figure.mesh.vertex_count; ++v )
            {
                lowest = fminf( lowest, p.points[v].y );
            }
            assert_true( lowest > -0.1f && ( jumps || lowest < 0.06f ) );
            highest = fmaxf( highest, lowest );
        }
        assert_true( longest < 0.18 ); // at rest 0.08 m
        assert_true( !jumps || highest > 0.15f );
        tear_down( &p );
    }
}

TEST( the_walk_ends_as_it_begins )
{
    posed p;
    set_up( &p, "walk" );
    wisp_affine begin[64];
    assert_true( p.clip.loops );
    wisp_skeleton_pose( &p.figure.skeleton, &p.clip, 0.0f, begin );
    wisp_skeleton_pose( &p.figure.skeleton, &p.clip, p.clip.duration * 0.9999f, p.joints );
    for ( int j = 0; j < p.figure.skeleton.joint_count; ++j )
    {
        for ( int i = 0; i < 12; ++i )
        {
            assert_true( fabsf( begin[j].m[i / 4][i % 4] - p.joints[j].m[i / 4][i % 4] ) < 2e-3f );
        }
    }
    tear_down( &p );
}

// ---- keyframes that are refused ----

TEST( keyframes_are_refused_where_they_stand )
{
    static const struct
    {
        const char *text, *words;
    } cases[] = {
        { "clips: [ { name: a, duration: 1, keys: [ { time: 0, rotations: { tail: [0, 0, 0] } } ] } ]",
          "the skeleton has no joint 'tail'" },
        { "clips: [ { name: a, duration: 1, keys: [ { time: 0 }, { time: 0 } ] } ]", "got time 0 after 0" },
        { "clips: [ { name: a, duration: 1, keys: [ { time: 2 } ] } ]", "got a keyframe at 2 s, expected at most the "
                                                                        "duration, 1 s" },
        { "clips: [ { name: a, duration: 1, keys: [ { time: 0, rotations: { hips: [0, 0, 0, 0] } } ] } ]",
          "got a quaternion of length 0" },
        { "clips: [ { name: b, duration: 1, keys: [ { time: 0 } ] } ]", "there is no clip 'a'" },
        { "clips: 3", "expected a list of clips" },
        { "[", "fuzz.yaml:" },
    };
    wisp_figure figure = made( 1.75f, 1500 );
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        wisp_animation clip;
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( wisp_animation_parse( cases[i].text, strlen( cases[i].text ), "fuzz.yaml", "a",
                                                &figure.skeleton, 1.0f, &clip, &error ),
                          WISP_BAD_INPUT );
        assert_contains( error.message, cases[i].words );
        assert_contains( error.message, "fuzz.yaml:" );
        assert_null( clip.tracks );
    }
    wisp_figure_release( &figure );
}
