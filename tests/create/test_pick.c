// Picking with a mouse, the nearest place to a point, and lines of what is simulated.
#include "support.h"

#include "create.h"
#include "pick.h"
#include "wisp/generate.h"
#include "wisp/lines.h"
#include "wisp/module/shapes.h"
#include "wisp/module/vec.h"

enum
{
    COLUMNS = 13,
    ROWS = 9,
    EDGES = ( COLUMNS - 1 ) * ROWS + COLUMNS * ( ROWS - 1 ) + ( COLUMNS - 1 ) * ( ROWS - 1 ),
};

static wisp_vec3 points[WISP_GRID_VERTICES( COLUMNS, ROWS )], strand_points[4 * 5];
static int32_t triangles[WISP_GRID_TRIANGLES( COLUMNS, ROWS )][3], offsets[5];
static wisp_line lines[4096];

typedef struct scene
{
    wisp_world* world;
    wisp_entity cloth, hair, ball;
} scene;

// A grid of 1.2 m x 0.8 m in y = 0, four strands that hang 3 m aside, and a ball.
static scene new_scene( void )
{
    scene s;
    wisp_world_def def = wisp_default_world_def();
    wisp_create_cloth_def cloth = wisp_default_create_cloth_def();
    wisp_create_hair_def hair = wisp_default_create_hair_def();
    wisp_collider_def ball = wisp_default_collider_def();
    assert_int_equal( wisp_generate_grid( COLUMNS, ROWS, 0.1f, 0.1f, points, &triangles[0][0], NULL ), WISP_OK );
    assert_int_equal( wisp_generate_strand_rows( 2, 2, 0.1f, 5, 0.2f, strand_points, offsets, NULL ), WISP_OK );
    for ( int i = 0; i < WISP_COUNT( strand_points ); ++i )
    {
        strand_points[i].x += 3.0f;
    }
    def.modules = wisp_all_modules( &def.module_count );
    cloth.points = points, cloth.vertex_count = WISP_COUNT( points );
    cloth.triangles = &triangles[0][0], cloth.triangle_count = WISP_COUNT( triangles );
    hair.points = strand_points, hair.offsets = offsets, hair.strand_count = 4;
    ball.kind = WISP_COLLIDER_SPHERE;
    assert_int_equal( wisp_world_create( &def, &s.world, NULL ), WISP_OK );
    assert_int_equal( wisp_create_cloth( s.world, &cloth, &s.cloth ), WISP_OK );
    assert_int_equal( wisp_create_hair( s.world, &hair, &s.hair ), WISP_OK );
    assert_int_equal( wisp_add_collider( s.world, &ball, &s.ball ), WISP_OK );
    return s;
}

static wisp_hit pick( const scene* s, wisp_entity entity, wisp_vec3 from, wisp_vec3 to, float radius )
{
    wisp_hit out;
    assert_int_equal( wisp_pick( s->world, entity, from, to, radius, &out ), WISP_OK );
    return out;
}

TEST( a_way_meets_the_first_and_a_point_the_nearest )
{
    scene s = new_scene();
    const wisp_vec3 above = { 0.03f, 1.0f, 0.02f }, below = { 0.03f, -1.0f, 0.02f }, near = { 0.03f, 0.2f, 0.02f },
                    beside = { 0.7f, 0.0f, 0.0f };
    wisp_hit hit = pick( &s, s.cloth, above, below, 0.0f );
    assert_int_equal( hit.vertex, ROWS / 2 * COLUMNS + COLUMNS / 2 ); // the middle
    assert_true( fabsf( hit.point.y ) < 1e-6f && fabsf( hit.distance - 1.0f ) < 1e-6f );
    bool is_corner = false;
    for ( int c = 0; c < 3; ++c )
    {
        is_corner = is_corner || triangles[hit.triangle][c] == hit.vertex;
    }
    assert_true( is_corner );
    assert_int_equal( pick( &s, s.cloth, above, near, 0.0f ).vertex, -1 ); // ends before it
    assert_int_equal( pick( &s, s.cloth, ( wisp_vec3 ){ 2.0f, 1.0f, 0.0f }, below, 0.0f ).vertex, -1 );
    hit = pick( &s, s.cloth, near, near, 0.3f );
    assert_true( hit.triangle >= 0 && fabsf( hit.distance - 0.2f ) < 1e-6f && fabsf( hit.point.x - 0.03f ) < 1e-6f );
    assert_int_equal( pick( &s, s.cloth, near, near, 0.1f ).vertex, -1 );
    hit = pick( &s, s.cloth, beside, beside, 0.3f ); // the nearest is on the rim
    assert_true( hit.triangle >= 0 && fabsf( hit.distance - 0.1f ) < 1e-6f );
    assert_int_equal( hit.vertex, ROWS / 2 * COLUMNS + COLUMNS - 1 );

    // 5 mm beside the third vertex of the first strand
    const wisp_vec3 v = strand_points[2];
    const wisp_vec3 before = { v.x + 0.005f, v.y, v.z - 1.0f }, behind = { v.x + 0.005f, v.y, v.z + 1.0f };
    hit = pick( &s, s.hair, before, behind, 0.01f );
    assert_true( hit.vertex == 2 && hit.triangle == -1 && fabsf( hit.point.x - v.x ) < 1e-6f );
    assert_int_equal( pick( &s, s.hair, before, behind, 0.001f ).vertex, -1 );
    wisp_hit out;
    expect_refusal( s.world, wisp_pick( s.world, s.cloth, above, below, -1.0f, &out ), WISP_BAD_INPUT, "radius" );
    expect_refusal( s.world, wisp_pick( s.world, s.ball, above, below, 0.0f, &out ), WISP_CONFLICT, "neither" );
    wisp_world_destroy( s.world );
}

static int list( wisp_world* world, unsigned kinds )
{
    int count = -1;
    assert_int_equal( wisp_debug_lines( world, kinds, NULL, lines, WISP_COUNT( lines ), &count ), WISP_OK );
    assert_in_range( count, 0, WISP_COUNT( lines ) );
    return count;
}

static float length_of( const wisp_line* l )
{
    return wisp_v3_length( wisp_v3_sub( l->ends[1].point, l->ends[0].point ) );
}

// A cloth of two pins hangs against a ball. Nothing of the world changes by lines.
TEST( lines_show_links_pins_and_what_touches_a_collider )
{
    const int32_t corners[] = { 0, COLUMNS - 1 };
    const wisp_vec3 centre = { 0.1f, -1.01f, 0.0f };
    const float radius = 1.0f;
    scene s = new_scene(), unseen = new_scene();
    const scene* const twins[] = { &s, &unseen };
    for ( int i = 0; i < 6; ++i )
    {
        const scene* of = twins[i % 2];
        const wisp_transform pose = { { 0, 0, 0, 1 }, i < 2 ? centre : wisp_v3( 0.0f, 0.0f, 0.0f ) };
        assert_int_equal( wisp_teleport( of->world, of->ball, pose, false ), WISP_OK );
        assert_int_equal( wisp_pin( of->world, of->cloth, corners, 2 ), WISP_OK );
        assert_int_equal( wisp_request( of->world, of->cloth, WISP_SURFACE_POINTS ), WISP_OK );
        assert_int_equal( wisp_request( of->world, of->cloth, WISP_MOTION_STATS ), WISP_OK );
        assert_int_equal( wisp_world_step( of->world, 1.0f / 60.0f ), WISP_OK );
        list( s.world, WISP_LINES_ALL );
    }
    assert_true( wisp_world_hash( s.world ) == wisp_world_hash( unseen.world ) );

    // links of the cloth come first: the strain that a colour tells is that of the statistics
    wisp_motion_stats stats;
    assert_int_equal( wisp_read_motion_stats( s.world, s.cloth, &stats ), WISP_OK );
    assert_int_equal( list( s.world, WISP_LINES_LINKS ), EDGES + 4 * 4 );
    float strain = 0.0f;
    for ( int i = 0; i < EDGES; ++i )
    {
        const wisp_vec3 c = lines[i].ends[0].colour;
        const bool is_long = c.x > 0.4f;
        strain = fmaxf( strain, 0.05f * ( is_long ? c.x - 0.4f : c.z - 0.4f ) / 0.6f );
        assert_true( is_long ? c.y < 0.4f && c.z < 0.4f : c.x <= 0.4f && c.z >= 0.4f );
    }
    assert_true( stats.strain_max > 1e-4 && fabs( (double)strain - stats.strain_max ) < 1e-5 );

    wisp_view view;
    assert_int_equal( wisp_world_view( s.world, s.cloth, WISP_SURFACE_POINTS, &view ), WISP_OK );
    const wisp_vec3* at = view.data;
    assert_int_equal( list( s.world, WISP_LINES_PINS ), 3 * ( 2 + 4 ) ); // roots of strands
    for ( int i = 0; i < 6; ++i )
    {
        const wisp_line* l = lines + i;
        const wisp_vec3 middle = wisp_v3_scale( wisp_v3_add( l->ends[0].point, l->ends[1].point ), 0.5f );
        assert_true( wisp_v3_length( wisp_v3_sub( middle, at[corners[i / 3]] ) ) < 1e-6f && length_of( l ) > 0.03f );
    }

    const int contacts = list( s.world, WISP_LINES_CONTACTS );
    const float thickness = length_of( lines );
    int near = 0;
    for ( int v = 0; v < view.count; ++v )
    {
        const bool is_pinned = v == corners[0] || v == corners[1];
        near += is_pinned == false && wisp_v3_length( wisp_v3_sub( at[v], centre ) ) < radius + 1.01f * thickness;
    }
    assert_true( near > 5 && contacts == near );
    for ( int i = 0; i < contacts; ++i )
    {
        const wisp_vec3 from = wisp_v3_sub( lines[i].ends[0].point, centre ),
                        to = wisp_v3_sub( lines[i].ends[1].point, centre );
        assert_true( fabsf( wisp_v3_length( from ) - radius ) < 1e-5f );
        assert_true( fabsf( wisp_v3_length( to ) - radius - thickness ) < 1e-5f );
    }
    wisp_world_destroy( s.world );
    wisp_world_destroy( unseen.world );
}

// Lines of every kind of collider reach as far as it does, and end on what has a closed form.
TEST( lines_show_colliders )
{
    static const wisp_vec3 hull[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    static const int32_t faces[] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };
    static const float heights[12] = { 0.0f, 0.5f, 0.0f, 0.0f, 0.25f };
    static const struct
    {
        int count;
        float lower, upper; // m, heights
    } expected[] = {
        [WISP_COLLIDER_PLANE] = { 2 * 10 * 11, 0.0f, 0.0f },
        [WISP_COLLIDER_SPHERE] = { 5 * 24, -0.5f, 0.5f },
        [WISP_COLLIDER_CAPSULE] = { 25 * 4 + 2 * 24, -1.5f, 1.5f },
        [WISP_COLLIDER_BOX] = { 12, -1.0f, 1.0f },
        [WISP_COLLIDER_MESH] = { 6, 0.0f, 1.0f },
        [WISP_COLLIDER_TAPERED_CAPSULE] = { 25 * 4 + 2 * 24, -1.75f, 1.25f },
        [WISP_COLLIDER_CONVEX] = { 6, 0.0f, 1.0f },
        [WISP_COLLIDER_HEIGHT_FIELD] = { 3 * 3 + 4 * 2, 0.0f, 0.5f },
        [WISP_COLLIDER_SURFACE] = { 3 * 2 * 12 * 8, 0.0f, 0.0f },
    };
    for ( int kind = 0; kind < WISP_COLLIDER_COUNT; ++kind )
    {
        scene s = new_scene();
        wisp_collider_def def = wisp_default_collider_def();
        wisp_entity body;
        def.kind = (wisp_collider_kind)kind, def.radius = 0.5f, def.bottom_radius = 0.75f, def.top_radius = 0.25f,
        def.spacing = 0.5f;
        def.points = hull, def.point_count = 4, def.triangles = faces, def.triangle_count = 4;
        def.heights = heights, def.height_count_x = 4, def.height_count_z = 3;
        def.surface = s.cloth, def.double_sided = kind == WISP_COLLIDER_SURFACE;
        def.pose.translation = wisp_v3( 0.0f, kind == WISP_COLLIDER_SURFACE ? 0.0f : 3.0f, 0.0f );
        assert_int_equal( wisp_remove( s.world, s.ball ), WISP_OK );
        assert_int_equal( wisp_add_collider( s.world, &def, &body ), WISP_OK );
        const int count = list( s.world, WISP_LINES_COLLIDERS );
        const bool is_closed_form = kind <= WISP_COLLIDER_BOX || kind == WISP_COLLIDER_TAPERED_CAPSULE;
        const wisp_shape shape = { .kind =
                                       kind <= WISP_COLLIDER_BOX ? (wisp_shape_kind)kind : WISP_SHAPE_TAPERED_CAPSULE,
                                   .radius = 0.5f,
                                   .half_length = 1.0f,
                                   .half_extent = { 1, 1, 1 },
                                   .top_radius = 0.25f,
                                   .bottom_radius = 0.75f };
        float lower = INFINITY, upper = -INFINITY;
        for ( int i = 0; i < 2 * count; ++i )
        {
            const wisp_vec3 at = wisp_v3_sub( lines[i / 2].ends[i % 2].point, def.pose.translation );
            wisp_surface_point on = { .distance = 0.0f };
            assert_true( is_closed_form == false || wisp_shape_closest( &shape, at, &on ) );
            assert_true( fabsf( on.distance ) < 1e-5f );
            lower = fminf( lower, at.y ), upper = fmaxf( upper, at.y );
        }
        assert_int_equal( count, expected[kind].count );
        assert_true( fabsf( lower - expected[kind].lower ) < 1e-5f && fabsf( upper - expected[kind].upper ) < 1e-5f );
        wisp_world_destroy( s.world );
    }
}

// A cloth lies on one that is pinned all over; strands are clamped.
TEST( lines_show_pairs_and_frames_up_to_a_capacity )
{
    scene s = new_scene();
    int32_t all[COLUMNS * ROWS];
    wisp_entity lower, far;
    wisp_create_cloth_def cloth = wisp_default_create_cloth_def();
    wisp_contact_def contact = wisp_default_contact_def();
    contact.thickness = 0.02f;
    cloth.points = points, cloth.vertex_count = WISP_COUNT( points );
    cloth.triangles = &triangles[0][0], cloth.triangle_count = WISP_COUNT( triangles );
    cloth.pins = all, cloth.pin_count = WISP_COUNT( all );
    for ( int v = 0; v < WISP_COUNT( all ); ++v )
    {
        all[v] = v, points[v].y -= 0.021f;
    }
    assert_int_equal( wisp_remove( s.world, s.ball ), WISP_OK );
    assert_int_equal( wisp_create_cloth( s.world, &cloth, &lower ), WISP_OK );
    assert_int_equal( wisp_set_contact( s.world, lower, &contact ), WISP_OK );
    assert_int_equal( wisp_set_contact( s.world, s.cloth, &contact ), WISP_OK );
    assert_int_equal( wisp_request_contact_stats( s.world, true, false ), WISP_OK );
    for ( int step = 0; step < 10; ++step )
    {
        assert_int_equal( wisp_world_step( s.world, 1.0f / 60.0f ), WISP_OK );
    }
    wisp_contact_stats stats;
    assert_int_equal( wisp_read_contact_stats( s.world, &stats ), WISP_OK );
    const int contacts = list( s.world, WISP_LINES_CONTACTS );
    assert_true( stats.contacts > 50 && contacts == stats.contacts );
    for ( int i = 0; i < contacts; ++i ) // between both, across them
    {
        const float from = lines[i].ends[0].point.y, to = lines[i].ends[1].point.y;
        assert_true( fminf( from, to ) > -0.025f && fmaxf( from, to ) < 0.005f );
        assert_true( fabsf( fabsf( to - from ) - 0.02f ) < 1e-4f );
    }
    assert_int_equal( wisp_create_cloth( s.world, &cloth, &far ), WISP_OK );
    assert_int_equal( wisp_set_contact( s.world, far, &contact ), WISP_OK );
    assert_int_equal( list( s.world, WISP_LINES_CONTACTS ), 0 ); // the pairs are of other participants

    assert_int_equal( list( s.world, WISP_LINES_FRAMES ), 2 * 4 * 4 );
    for ( int i = 0; i < 32; ++i ) // across the strand, which hangs, and each other
    {
        const wisp_vec3 way = wisp_v3_sub( lines[i].ends[1].point, lines[i].ends[0].point );
        const wisp_vec3 other = wisp_v3_sub( lines[i ^ 1].ends[1].point, lines[i ^ 1].ends[0].point );
        assert_true( fabsf( length_of( lines + i ) - 0.025f ) < 1e-4f && fabsf( way.y ) < 1e-4f );
        assert_true( fabsf( wisp_v3_dot( way, other ) ) < 1e-6f );
    }

    // what there is no room for is counted, and places are relative to an origin
    const int every = list( s.world, WISP_LINES_ALL );
    const double origin[3] = { 1.0, 2.0, -3.0 };
    const wisp_line first = lines[0], behind = lines[7];
    int count = 0;
    assert_int_equal( wisp_debug_lines( s.world, WISP_LINES_ALL, origin, lines, 7, &count ), WISP_OK );
    assert_true( count == every && memcmp( &behind, lines + 7, sizeof( behind ) ) == 0 );
    const wisp_vec3 by = wisp_v3_sub( first.ends[0].point, lines[0].ends[0].point );
    assert_true( wisp_v3_length( wisp_v3_sub( by, wisp_v3( 1.0f, 2.0f, -3.0f ) ) ) < 1e-6f );
    assert_int_equal( wisp_debug_lines( s.world, WISP_LINES_ALL, NULL, NULL, 0, &count ), WISP_OK );
    assert_int_equal( count, every );
    expect_refusal( s.world, wisp_debug_lines( s.world, 32, NULL, NULL, 0, &count ), WISP_BAD_INPUT, "kinds" );
    expect_refusal( s.world, wisp_debug_lines( s.world, 1, NULL, NULL, 1, &count ), WISP_BAD_INPUT, "lines" );
    expect_refusal( s.world, wisp_debug_lines( s.world, 1, ( double[3] ){ NAN }, NULL, 0, &count ), WISP_BAD_INPUT,
                    "origin" );
    wisp_world_destroy( s.world );
}
