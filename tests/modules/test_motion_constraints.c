// Motion constraints in worlds: closed forms, targets that move, determinism, what they combine with, and refusals.
#include "cloth_fixture.h"

#include "balloon.h"
#include "collision.h"
#include "implicit_cloth.h"
#include "motion_constraints.h"
#include "oracle/double3.h"

static const wisp_module* const MODULES[] = { &wisp_balloon_module, &wisp_cloth_module,
                                              &wisp_motion_constraints_module, &wisp_collision_module,
                                              &wisp_implicit_cloth_module };

enum
{
    SIDE = 9,
    VERTICES = SIDE * SIDE,
};

static const float DT = 1.0f / 60.0f;

typedef struct held
{
    hosted* h;
    wisp_world* world;
    wisp_entity e;
    wisp_vec3 start[VERTICES];
} held;

// A plane of loose vertices at y = 1, or of cloth, in gravity.
static held open_held( int substeps, int iterations, int workers, const wisp_cloth_def* cloth, wisp_vec3 gravity )
{
    held s = { .h = new_hosted( MODULES, WISP_COUNT( MODULES ), substeps, iterations, workers ) };
    s.world = s.h->world;
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( SIDE, 0.05f );
    for ( int v = 0; v < VERTICES; ++v )
    {
        mesh.points[v].y = 1.0f;
        s.start[v] = mesh.points[v];
    }
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = fabric.coarse_sheets = true;
    wisp_surface_def surface = wisp_default_surface_def();
    surface.gravity = gravity;
    s.e = test_surface_of( s.world, &fabric, surface );
    if ( cloth != NULL )
    {
        assert_status( s.world, wisp_set_cloth( s.world, s.e, cloth ), WISP_OK );
    }
    assert_status( s.world, wisp_request( s.world, s.e, WISP_SURFACE_POINTS ), WISP_OK );
    return s;
}

static void close_held( held* s )
{
    void* h = s->h;
    close_hosted( &h );
}

static void steps( held* s, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        assert_status( s->world, wisp_world_step( s->world, DT ), WISP_OK );
    }
}

static void constrain( held* s, const wisp_motion_constraints_def* def )
{
    assert_status( s->world, wisp_set_motion_constraints( s->world, s->e, def ), WISP_OK );
}

static double distance_to( held* s, int vertex, wisp_vec3 place )
{
    const wisp_vec3 p = point_of( s->world, s->e, vertex );
    return double3_length( double3_sub( double3_widen( p ), double3_widen( place ) ) );
}

TEST( a_vertex_in_gravity_hangs_at_its_largest_distance )
{
    float distances[VERTICES];
    for ( int v = 0; v < VERTICES; ++v )
    {
        distances[v] = v % 4 == 0 ? INFINITY : 0.01f * (float)( v % 7 );
    }
    wisp_motion_constraints_def def = wisp_default_motion_constraints_def();
    def.max_distances = distances;
    SCOPED( close_held ) held s = open_held( 4, 1, 1, NULL, EARTH );
    constrain( &s, &def );
    steps( &s, 60 );
    for ( int v = 0; v < VERTICES; ++v )
    {
        // a second of free fall, by symplectic Euler; else the distance in floats of 1 m
        const double fallen = 0.5 * 9.81 * ( 1.0 + 1.0 / 240.0 );
        const double expected = v % 4 == 0 ? fallen : (double)distances[v];
        assert_near( distance_to( &s, v, s.start[v] ), expected, v % 4 == 0 ? 1e-3 : 2e-7 );
        assert_true( point_of( s.world, s.e, v ).y <= s.start[v].y );
    }
}

// By xpbd m g = (|x - t| - d) / compliance, whatever the iterations and the substeps.
TEST( a_compliant_distance_is_exceeded_by_the_weight )
{
    static const int NUMBERS[][2] = { { 4, 1 }, { 16, 1 }, { 4, 6 } };
    for ( int i = 0; i < WISP_COUNT( NUMBERS ); ++i )
    {
        wisp_motion_constraints_def def = wisp_default_motion_constraints_def();
        def.max_distance = 0.02f;
        def.distance_compliance = 5.0f;
        SCOPED( close_held ) held s = open_held( NUMBERS[i][0], NUMBERS[i][1], 1, NULL, EARTH );
        assert_status( s.world, wisp_set_damping( s.world, s.e, 8.0f ), WISP_OK );
        constrain( &s, &def );
        steps( &s, 300 );
        const int middle = VERTICES / 2;
        const int slot = wisp_world_fabric( s.world, s.e )->vertex_slot[middle];
        const float* position = wisp_world_column( s.world, s.e, WISP_PARTICLE_POSITION, 0 );
        const double mass = 1.0 / (double)position[4 * slot + 3];
        assert_near( distance_to( &s, middle, s.start[middle] ), 0.02 + 5.0 * mass * 9.81, 2e-5 );
    }
}

// Wind that blows down, in place of gravity, against planes and spheres behind the targets.
TEST( a_backstop_holds_against_what_pushes )
{
    for ( int sphere = 0; sphere < 2; ++sphere )
    {
        wisp_vec3 normals[VERTICES];
        for ( int v = 0; v < VERTICES; ++v )
        {
            normals[v] = ( wisp_vec3 ){ 0.0f, 3.0f, 0.0f };
        }
        wisp_cloth_def cloth = wisp_default_cloth_def();
        cloth.wind = ( wisp_vec3 ){ 0.0f, -20.0f, 0.0f };
        cloth.drag_coefficient = 2.0f;
        wisp_motion_constraints_def def = wisp_default_motion_constraints_def();
        def.backstop_distance = 0.03f;
        def.backstop_radius = sphere ? 0.5f : INFINITY;
        def.normals = normals;
        SCOPED( close_held ) held s = open_held( 8, 1, 1, &cloth, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
        constrain( &s, &def );
        double deepest = 0.0;
        for ( int i = 0; i < 30; ++i )
        {
            steps( &s, 1 );
            for ( int v = 0; v < VERTICES; ++v )
            {
                const wisp_vec3 p = point_of( s.world, s.e, v ), t = s.start[v];
                const double3 centre = { (double)t.x, (double)t.y - 0.03 - 0.5, (double)t.z };
                const double rho = double3_length( double3_sub( double3_widen( p ), centre ) );
                const double clear = sphere ? rho - 0.5 : (double)p.y - 0.97;
                assert_true( clear > -3e-7 );
                deepest = fmax( deepest, 1.0 - (double)p.y );
            }
        }
        assert_true( deepest > 0.0299 );
    }
}

static void move_all( held* s, wisp_vec3 by )
{
    wisp_vec3 targets[VERTICES];
    for ( int v = 0; v < VERTICES; ++v )
    {
        targets[v] = ( wisp_vec3 ){ s->start[v].x + by.x, s->start[v].y + by.y, s->start[v].z + by.z };
    }
    assert_status( s->world, wisp_move_motion_targets( s->world, s->e, targets, NULL ), WISP_OK );
}

TEST( an_infinite_distance_changes_no_bit_of_the_motion )
{
    const wisp_cloth_def cloth = wisp_default_cloth_def();
    const wisp_motion_constraints_def def = wisp_default_motion_constraints_def();
    SCOPED( close_held )
    held with = open_held( 4, 1, 1, &cloth, EARTH ), without = open_held( 4, 1, 1, &cloth, EARTH );
    constrain( &with, &def );
    for ( int i = 0; i < 20; ++i )
    {
        move_all( &with, ( wisp_vec3 ){ 0.1f * (float)i, 0.0f, 0.0f } );
        steps( &with, 1 );
        steps( &without, 1 );
    }
    const wisp_view a = view_of( with.world, with.e, WISP_SURFACE_POINTS ),
                    b = view_of( without.world, without.e, WISP_SURFACE_POINTS );
    assert_memory_equal( a.data, b.data, sizeof( wisp_vec3 ) * VERTICES );
    assert_int_equal( count_passes_named( without.world, "motion_constraints.project" ), 0 );
    assert_int_equal( count_passes_named( with.world, "motion_constraints.project" ), 1 );
    // targets that rest cost nothing at the start of a step
    steps( &with, 2 );
    assert_int_equal( wisp_world_hash( with.world ) == 0, 0 );
}

// With distance 0 a vertex goes with its target: its velocity in each substep is that of a straight path.
TEST( targets_move_in_a_straight_line_over_the_substeps )
{
    wisp_motion_constraints_def def = wisp_default_motion_constraints_def();
    def.max_distance = 0.0f;
    SCOPED( close_held ) held s = open_held( 5, 1, 1, NULL, EARTH );
    constrain( &s, &def );
    for ( int i = 1; i <= 4; ++i )
    {
        move_all( &s, ( wisp_vec3 ){ 0.25f * (float)i, 0.0f, 0.0f } );
        steps( &s, 1 );
        for ( int v = 0; v < VERTICES; ++v )
        {
            const wisp_vec3 p = point_of( s.world, s.e, v );
            assert_true( p.x == s.start[v].x + 0.25f * (float)i && p.y == 1.0f && p.z == s.start[v].z );
            // 15 m/s in a substep of 3.3 ms, of positions of 1 m in floats
            assert_near( (double)velocity_of( s.world, s.e, v )[0], 15.0, 2e-4 );
        }
    }
    steps( &s, 2 );
    assert_near( (double)velocity_of( s.world, s.e, 3 )[0], 0.0, 4e-5 ); // a digit of 1 m over a substep
}

// Steps of uneven length leave a part of a substep: the targets are then on their way, and vertices with them.
TEST( uneven_steps_arrive_where_even_ones_do )
{
    wisp_motion_constraints_def def = wisp_default_motion_constraints_def();
    def.max_distance = 0.0f;
    SCOPED( close_held ) held s = open_held( 4, 1, 1, NULL, EARTH );
    constrain( &s, &def );
    steps( &s, 1 );
    double before = (double)s.start[0].x;
    for ( int i = 1; i <= 12; ++i )
    {
        move_all( &s, ( wisp_vec3 ){ 0.01f * (float)i, 0.0f, 0.0f } );
        assert_status( s.world, wisp_world_step( s.world, DT * ( i % 3 == 1 ? 1.3f : 0.85f ) ), WISP_OK );
        const double now = (double)point_of( s.world, s.e, 0 ).x;
        assert_true( now >= before && now <= (double)s.start[0].x + 0.01 * i + 1e-6 );
        before = now;
    }
    steps( &s, 3 );
    assert_near( (double)point_of( s.world, s.e, 0 ).x, (double)s.start[0].x + 0.12, 1e-6 );
}

TEST( a_teleport_takes_targets_and_backstops_along )
{
    SCOPED( close_held ) held here = open_held( 4, 1, 1, NULL, EARTH ), there = open_held( 4, 1, 1, NULL, EARTH );
    const wisp_transform motion = { { 0.0f, 1.0f, 0.0f, 0.0f }, { 4.0f, 0.0f, 8.0f } }; // half a turn about gravity
    wisp_motion_constraints_def def = wisp_default_motion_constraints_def();
    def.max_distance = 0.03f;
    def.backstop_distance = 0.02f;
    def.backstop_radius = 0.3f;
    constrain( &here, &def );
    constrain( &there, &def );
    steps( &here, 3 );
    steps( &there, 3 );
    assert_status( there.world, wisp_teleport( there.world, there.e, motion, true ), WISP_OK );
    steps( &here, 40 );
    steps( &there, 40 );
    for ( int v = 0; v < VERTICES; ++v )
    {
        const wisp_vec3 p = wisp_transform_to_world( motion, point_of( here.world, here.e, v ) );
        assert_near( distance_to( &there, v, p ), 0.0, 5e-6 );
    }
}

TEST( balloons_and_implicit_cloth_are_held_too )
{
    const wisp_implicit_cloth_def implicit = wisp_default_implicit_cloth_def();
    wisp_motion_constraints_def def = wisp_default_motion_constraints_def();
    def.max_distance = 0.05f;
    def.backstop_distance = 0.0f;
    SCOPED( close_held ) held s = open_held( 4, 1, 1, NULL, EARTH );
    constrain( &s, &def );
    assert_status( s.world, wisp_set_implicit_cloth( s.world, s.e, &implicit ), WISP_OK );
    float speed = 0.0f;
    for ( int i = 0; i < 60; ++i )
    {
        move_all( &s, ( wisp_vec3 ){ 0.02f * (float)i, 0.0f, 0.0f } );
        steps( &s, 1 );
        for ( int v = 0; v < VERTICES; ++v )
        {
            const wisp_vec3 t = { s.start[v].x + 0.02f * (float)i, s.start[v].y, s.start[v].z };
            assert_true( distance_to( &s, v, t ) <= 0.05 + 1e-6 );
            speed = fmaxf( speed, fabsf( velocity_of( s.world, s.e, v )[0] ) );
        }
    }
    assert_true( speed > 1.0f && speed < 2.5f ); // the targets go at 1.2 m/s
}

TEST( what_cannot_be_is_refused_by_vertex )
{
    SCOPED( close_held ) held s = open_held( 4, 1, 1, NULL, EARTH );
    wisp_vec3 points[VERTICES];
    float map[VERTICES] = { 0.0f };
    memcpy( points, s.start, sizeof( points ) );
    wisp_motion_constraints_def def = wisp_default_motion_constraints_def();
    expect_refusal( s.world, wisp_move_motion_targets( s.world, s.e, points, NULL ), WISP_CONFLICT,
                    "has no motion constraints" );
    constrain( &s, &def );
    const uint64_t before = wisp_world_hash( s.world );
    points[17].y = NAN;
    expect_refusal( s.world, wisp_move_motion_targets( s.world, s.e, points, NULL ), WISP_BAD_INPUT,
                    "target of vertex 17: got" );
    expect_refusal( s.world, wisp_move_motion_targets( s.world, s.e, s.start, points ), WISP_BAD_INPUT,
                    "normal of vertex 17: got" );
    expect_refusal( s.world, wisp_move_motion_targets( s.world, s.e, NULL, NULL ), WISP_BAD_INPUT, "points" );
    map[5] = NAN;
    def.max_distances = map;
    expect_refusal( s.world, wisp_set_motion_constraints( s.world, s.e, &def ), WISP_BAD_INPUT,
                    "max_distance of vertex 5: got nan m" );
    def.max_distances = NULL;
    map[5] = 1e-9f;
    def.backstop_radii = map;
    expect_refusal( s.world, wisp_set_motion_constraints( s.world, s.e, &def ), WISP_BAD_INPUT,
                    "backstop_radius of vertex 5: got 1e-09 m" );
    def.backstop_radii = NULL;
    assert_true( wisp_world_hash( s.world ) == before );
    def.max_distance = 1.0f;
    def.enabled = false;
    constrain( &s, &def );
    steps( &s, 1 );
    assert_int_equal( count_passes_named( s.world, "motion_constraints.project" ), 0 );
}
