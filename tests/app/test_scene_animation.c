// Animated surfaces of scenes: glTF skeletons against the file's own poses in double precision, clips one after the other, and vertices
// that are where the clip has them.
#define _XOPEN_SOURCE 700

#include "scene_world_fixture.h"

#include "gltf_fixture.h"
#include "gltf_internal.h"
#include "skeleton.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#define FIGURE WISP_SOURCE_ROOT "/data/figure.glb"

// ---- glTF against double precision ----

TEST( joints_of_a_file_are_where_its_poses_in_double_precision_have_them )
{
    SCOPED( gltf_release ) gltf_model model = gltf_good( "strip.glb", "", "", 0 );
    SCOPED( wisp_skeleton_release ) wisp_skeleton skeleton;
    wisp_skin* skin;
    wisp_animation clip;
    wisp_error error = { .status = WISP_OK };
    assert_ok( gltf_rig( &model, 0, "strip.glb", &skeleton, &skin, &error ), error );
    assert_ok( gltf_rig_animation( &model, "bend", "strip.glb", &skeleton, &clip, &error ), error );
    clip.loops = false; // the pose of the file stays after its end
    double* work = malloc( gltf_pose_work( &model ) * sizeof *work );
    for ( int step = 0; step <= 20; ++step )
    {
        const float time = 0.1f * (float)step;
        wisp_affine joints[8];
        wisp_skeleton_pose( &skeleton, &clip, time, joints );
        const double* nodes = gltf_pose_nodes( &model, 0, (double)time, work );
        for ( int i = 0; i < skeleton.joint_count; ++i )
        {
            for ( int k = 0; k < 12; ++k )
            {
                const double expected = nodes[12 * (size_t)model.order[i] + (size_t)k];
                assert_true( fabs( (double)joints[i].m[k / 4][k % 4] - expected ) < 2e-6 );
            }
        }
    }
    free( work );
    wisp_animation_release( &clip );
    wisp_skin_release( skin );
}

// A matrix of rotation, scale and mirror comes apart into what multiplies to the same matrix; one with shear is refused.
TEST( nodes_with_a_matrix_are_split_or_refused )
{
    static const double matrices[][12] = {
        { 0, -2, 0, 5, 3, 0, 0, 6, 0, 0, 4, 7 },                      // a quarter turn, scales 3, 2 and 4
        { 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0 },                     // a half turn
        { -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 },                      // mirrored
        { 0.36, 0.48, -0.8, 1, -0.8, 0.6, 0, 2, 0.48, 0.64, 0.6, 3 }, // a rotation about no axis of the frame
    };
    for ( int i = 0; i < WISP_COUNT( matrices ); ++i )
    {
        SCOPED( gltf_release ) gltf_model model = gltf_good( "strip.glb", "", "", 0 );
        wisp_skeleton skeleton;
        wisp_skin* skin;
        wisp_error error = { .status = WISP_OK };
        model.nodes[2].has_matrix = true;
        memcpy( model.nodes[2].matrix, matrices[i], sizeof matrices[i] );
        model.nodes[2].parent = -1;
        assert_ok( gltf_rig( &model, 0, "strip.glb", &skeleton, &skin, &error ), error );
        wisp_affine joints[8];
        wisp_skeleton_pose( &skeleton, NULL, 0.0f, joints );
        const int joint = wisp_skeleton_find( &skeleton, "tip" );
        for ( int k = 0; k < 12; ++k )
        {
            assert_true( fabs( (double)joints[joint].m[k / 4][k % 4] - matrices[i][k] ) < 2e-6 );
        }
        wisp_skin_release( skin );
        wisp_skeleton_release( &skeleton );
        model.nodes[2].matrix[1] += 0.5;
        model.nodes[2].matrix[2] += 0.4;
        assert_int_equal( gltf_rig( &model, 0, "strip.glb", &skeleton, &skin, &error ), WISP_BAD_INPUT );
        assert_contains( error.message, "node 'tip' has a matrix that is not a scale and a rotation" );
    }
}

// ---- clips one after the other ----

static wisp_mesh figure;    // at rest
static wisp_skeleton bones; // of the figure
static wisp_skin* figure_skin;

static wisp_rig load( const char* clip_name )
{
    const wisp_scene_mesh mesh = { .file = FIGURE };
    const wisp_scene_clip clip = { clip_name, 0.0f, 1.0f, true };
    const wisp_scene_animation animation = { .clips = &clip, .clip_count = 1 };
    wisp_rig rig;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_rig_load( &mesh, &animation, 10.0f, &rig, &error ), error );
    return rig;
}

static wisp_animation read_clip( const char* name )
{
    SCOPED( wisp_rig_release ) wisp_rig rig = load( name );
    wisp_animation out = rig.animation;
    rig.animation = ( wisp_animation ){ 0 };
    return out;
}

static int load_figure( void** state )
{
    (void)state;
    wisp_rig rig = load( "walk" );
    bones = rig.skeleton;
    figure_skin = rig.skin;
    wisp_animation_release( &rig.animation );
    return gltf_mesh_read( FIGURE, &figure, NULL ) == WISP_OK ? 0 : -1;
}

static int release_figure( void** state )
{
    (void)state;
    wisp_skin_release( figure_skin );
    wisp_skeleton_release( &bones );
    wisp_mesh_release( &figure );
    return 0;
}

static double pose_difference( const wisp_animation* a, float time_a, const wisp_animation* b, float time_b )
{
    wisp_affine x[64], y[64];
    double most = 0.0;
    wisp_skeleton_pose( &bones, a, time_a, x );
    wisp_skeleton_pose( &bones, b, time_b, y );
    for ( int i = 0; i < 12 * bones.joint_count; ++i )
    {
        most = fmax( most, fabs( (double)x[i / 12].m[i % 12 / 4][i % 4] - (double)y[i / 12].m[i % 12 / 4][i % 4] ) );
    }
    return most;
}

TEST( one_clip_from_the_start_is_the_clip_itself )
{
    SCOPED( wisp_animation_release ) wisp_animation walk = read_clip( "walk" ), joined;
    const wisp_clip clip = { &walk, 0.0f, 10.0f, 1.0f };
    assert_int_equal( wisp_animation_join( &clip, 1, &bones, &joined, NULL ), WISP_OK );
    for ( int i = 0; i < 40; ++i )
    {
        assert_true( pose_difference( &walk, 0.13f * (float)i, &joined, 0.13f * (float)i ) == 0.0 );
    }
}

TEST( clips_follow_each_other_from_rest_without_a_jump )
{
    SCOPED( wisp_animation_release ) wisp_animation walk = read_clip( "walk" ), jump = read_clip( "jump" ), joined;
    const wisp_clip clips[] = { { &walk, 0.5f, 3.5f, 1.0f }, { &jump, 4.0f, 5.0f, 2.0f } };
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_animation_join( clips, 2, &bones, &joined, &error ), error );
    assert_ok( wisp_animation_check( &joined, &bones, &error ), error );
    assert_true( pose_difference( NULL, 0.0f, &joined, 0.0f ) < 1e-6 );
    for ( int k = 1; k < 16; ++k ) // keyframes of the first and the second round, 0.14 s apart
    {
        assert_true( pose_difference( &walk, 0.14f * (float)k, &joined, 0.5f + 0.14f * (float)k ) < 1e-3 );
    }
    assert_true( pose_difference( &jump, 0.0f, &joined, 4.0f ) < 1e-5 );
    // joints that the jump does not name swing out
    assert_true( pose_difference( &jump, jump.duration, &joined, 4.0f + 0.5f * jump.duration ) < 2e-3 );
    for ( int i = 0; i < 6 * 240; ++i )
    {
        const float time = (float)i / 240.0f;
        assert_true( pose_difference( &joined, time, &joined, time + 1.0f / 240.0f ) < 0.1 ); // at most 24 m/s
    }
}

// ---- the figure of the tree ----

static double distance( wisp_vec3 a, wisp_vec3 b )
{
    return sqrt( pow( (double)a.x - (double)b.x, 2.0 ) + pow( (double)a.y - (double)b.y, 2.0 ) +
                 pow( (double)a.z - (double)b.z, 2.0 ) );
}

static double longest_edge( const wisp_vec3* points )
{
    double most = 0.0;
    for ( int c = 0; c < 3 * figure.triangle_count; ++c )
    {
        const int32_t a = figure.triangles[c], b = figure.triangles[c % 3 == 2 ? c - 2 : c + 1];
        most = fmax( most, distance( points[a], points[b] ) );
    }
    return most;
}

TEST( the_figure_is_closed_and_at_rest_its_skin_is_the_mesh )
{
    wisp_mesh_diagnostics report;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_mesh_examine( &figure, &report, &error ), error );
    assert_ok( wisp_mesh_require( &report,
                                  WISP_MESH_CLOSED | WISP_MESH_ORIENTED | WISP_MESH_MANIFOLD | WISP_MESH_CLEAN,
                                  "figure", &error ),
               error );
    SCOPED( free_local ) wisp_vec3* points = calloc( (size_t)figure.vertex_count, sizeof *points );
    wisp_affine joints[64];
    wisp_skin_pose pose = { 0 };
    wisp_skeleton_pose( &bones, NULL, 0.0f, joints );
    for ( int method = 0; method < WISP_SKIN_METHOD_COUNT; ++method )
    {
        assert_ok( wisp_skin_points( figure_skin, &pose, (wisp_skin_method)method, joints, points, &error ), error );
        for ( int v = 0; v < figure.vertex_count; ++v )
        {
            assert_true( distance( points[v], figure.points[v] ) < 1e-6 );
        }
    }
    wisp_skin_pose_release( &pose, NULL );
}

// A vertex that follows a wrong joint leaves its neighbours behind.
TEST( the_figure_stays_whole_and_on_the_ground_in_all_clips )
{
    static const char* const names[] = { "walk", "turn", "jump" };
    SCOPED( free_local ) wisp_vec3* points = calloc( (size_t)figure.vertex_count, sizeof *points );
    wisp_affine joints[64];
    wisp_skin_pose pose = { 0 };
    for ( int c = 0; c < WISP_COUNT( names ); ++c )
    {
        SCOPED( wisp_animation_release ) wisp_animation clip = read_clip( names[c] );
        const bool jumps = c == 2;
        double highest = -1.0;
        for ( int i = 0; i < 2 * 20; ++i )
        {
            wisp_skeleton_pose( &bones, &clip, clip.duration * (float)( i / 2 ) / 20.0f, joints );
            assert_int_equal(
                wisp_skin_points( figure_skin, &pose, (wisp_skin_method)( i % 2 ), joints, points, NULL ), WISP_OK );
            double lowest = 1e9;
            for ( int v = 0; v < figure.vertex_count; ++v )
            {
                lowest = fmin( lowest, (double)points[v].y );
            }
            assert_true( lowest > -0.1 && ( jumps || lowest < 0.06 ) );
            assert_true( longest_edge( points ) < 0.18 ); // at rest 0.05 m
            highest = fmax( highest, lowest );
        }
        assert_true( !jumps || highest > 0.15 );
    }
    wisp_skin_pose_release( &pose, NULL );
}

// ---- scenes ----

#define BODY                                                                                                         \
    "wisp: 1\nsteps: 60\nsurfaces:\n"                                                                                \
    "  - name: body\n    file: " FIGURE "\n"                                                                         \
    "    transform: { translate: [3, 0, 0] }\n"                                                                      \
    "    animation: { clips: [ { clip: walk, time: 0.25 } ] }\n"

static const wisp_vec3* points_of( fixture* f, int surface )
{
    wisp_view view;
    assert_int_equal(
        wisp_world_view( f->world.world, f->world.surfaces[surface].entity, WISP_SURFACE_POINTS, &view ), WISP_OK );
    return view.data;
}

TEST( vertices_are_where_the_clip_has_them )
{
    SCOPED( release ) fixture f;
    build( &f, BODY );
    SCOPED( wisp_animation_release ) wisp_animation walk = read_clip( "walk" ), joined;
    const wisp_clip clip = { &walk, 0.25f, 1.0f + walk.duration, 1.0f };
    assert_int_equal( wisp_animation_join( &clip, 1, &bones, &joined, NULL ), WISP_OK );
    wisp_vec3* expected = calloc( (size_t)figure.vertex_count, sizeof *expected );
    wisp_skin_pose pose = { 0 };
    wisp_affine joints[64];
    double moved = 0.0;
    for ( int i = 1; i <= 60; ++i )
    {
        step( &f, 1 );
        wisp_skeleton_pose( &bones, &joined, (float)i / 60.0f, joints );
        assert_int_equal( wisp_skin_points( figure_skin, &pose, WISP_SKIN_LINEAR, joints, expected, NULL ), WISP_OK );
        const wisp_vec3* points = points_of( &f, 0 );
        for ( int v = 0; v < figure.vertex_count; ++v )
        {
            assert_true( fabsf( points[v].x - 3.0f - expected[v].x ) < 1e-4f );
            assert_true( fabsf( points[v].y - expected[v].y ) < 1e-4f &&
                         fabsf( points[v].z - expected[v].z ) < 1e-4f );
            moved = fmax( moved, fabs( (double)expected[v].z - (double)figure.points[v].z ) );
        }
    }
    assert_true( moved > 0.2 );
    free( expected );
    wisp_skin_pose_release( &pose, NULL );
}

// Cloth that is held by motion constraints of length 0 alone, and cloth that is pinned.
TEST( targets_and_pins_of_cloth_go_along )
{
    SCOPED( release ) fixture f;
    build( &f, BODY "    cloth: {}\n    gravity: [0, 0, 0]\n    motion_constraints: { max_distance: 0 }\n"
                    "  - name: other\n    instance_of: body\n    transform: { translate: [3, 0, 0] }\n"
                    "    animation: { clips: [ { clip: walk, time: 0.25 } ] }\n" );
    assert_int_equal( f.world.surfaces[0].pin_count, 0 );
    assert_int_equal( f.world.surfaces[1].pin_count, f.world.surfaces[1].mesh.vertex_count );
    step( &f, 40 );
    const wisp_vec3 *held = points_of( &f, 0 ), *pinned = points_of( &f, 1 );
    for ( int v = 0; v < f.world.surfaces[1].mesh.vertex_count; ++v )
    {
        assert_true( fabsf( held[v].x - pinned[v].x ) < 1e-4f && fabsf( held[v].y - pinned[v].y ) < 1e-4f &&
                     fabsf( held[v].z - pinned[v].z ) < 1e-4f );
    }
}

TEST( a_file_without_the_clip_is_refused_with_the_line_of_the_surface )
{
    demand_refusal( "wisp: 1\nsurfaces:\n  - name: body\n    file: " FIGURE "\n"
                    "    animation: { clips: [ { clip: dance } ] }\n",
                    "test.yaml:3:5: surface 'body': " FIGURE
                    ": there is no animation 'dance', expected one of: 'walk', 'turn', 'jump'" );
}

// ---- clothes ----

// A sleeve that is attached to an arm. The figure jumps, and its arms fall at several thicknesses of the cloth per substep.
static const char SLEEVE[] =
    "wisp: 1\n"
    "dt: 0.0166667\n"
    "substeps: %d\n"
    "surfaces:\n"
    "  - name: body\n"
    "    file: " FIGURE "\n"
    "    animation:\n"
    "      clips: [{ clip: jump, time: 0.4, loop: false }]\n"
    "    contact: { thickness: 0.005, self: false }\n"
    "  - name: sleeve\n"
    "    generate: { shape: tube, segments: 40, length_segments: 10, radius: 0.07, lower_radius: 0.085, "
    "length: 0.22 }\n"
    "    transform: { rotate: { axis: [0, 0, 1], degrees: 35.7 }, translate: [0.339, 1.173, -0.018] }\n"
    "    area_density: 0.2\n"
    "    pin_box: { min: [0.199, 1.209, -0.2], max: [0.339, 1.319, 0.2] }\n"
    "    attach_pins: body\n"
    "    cloth: { bending: dihedral, bend_rigidity: 1e-5, internal_damping: 0 }\n"
    "    damping: 0.5\n"
    "    contact: { thickness: 0.005, friction: 0.2 }\n";

// Without what a cut leaves them, cut vertices stay behind their arm, and the sleeve passes through itself in a third of the steps.
TEST( a_sleeve_on_an_arm_that_falls_stays_free_of_intersections )
{
    static const int SUBSTEPS[] = { 4, 6 };
    for ( int k = 0; k < WISP_COUNT( SUBSTEPS ); ++k )
    {
        char text[4000];
        snprintf( text, sizeof text, SLEEVE, SUBSTEPS[k] );
        SCOPED( release ) fixture f = { .scene = parsed( text ) };
        create( &f, 2 );
        assert_int_equal( wisp_request_contact_stats( f.world.world, true, true ), WISP_OK );
        int limited = 0;
        for ( int i = 0; i < 130; ++i )
        {
            wisp_contact_stats stats;
            step( &f, 1 );
            assert_int_equal( wisp_read_contact_stats( f.world.world, &stats ), WISP_OK );
            assert_int_equal( stats.intersections, 0 );
            limited += stats.displacement_limited;
        }
        assert_true( limited > 20 );
    }
}

TEST_GROUP( load_figure, release_figure )
