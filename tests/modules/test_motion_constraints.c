// Motion constraints in C: uneven steps and refusals. Closed forms are in tests/claims.
#include "cloth_fixture.h"

#include "motion_constraints.h"

static const wisp_module* const MODULES[] = { &wisp_motion_constraints_module };

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

// A plane of loose vertices at y = 1 in gravity.
static held open_held( void )
{
    held s = { .h = new_hosted( MODULES, WISP_COUNT( MODULES ), 4, 1, 1 ) };
    s.world = s.h->world;
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( SIDE, 0.05f );
    for ( int v = 0; v < VERTICES; ++v )
    {
        mesh.points[v].y = 1.0f;
        s.start[v] = mesh.points[v];
    }
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = wisp_default_surface_def();
    surface.gravity = EARTH;
    s.e = test_surface_of( s.world, &fabric, surface );
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

static void move_all( held* s, wisp_vec3 by )
{
    wisp_vec3 targets[VERTICES];
    for ( int v = 0; v < VERTICES; ++v )
    {
        targets[v] = ( wisp_vec3 ){ s->start[v].x + by.x, s->start[v].y + by.y, s->start[v].z + by.z };
    }
    assert_status( s->world, wisp_move_motion_targets( s->world, s->e, targets, NULL ), WISP_OK );
}

// Steps of uneven length leave a part of a substep: the targets are then on their way, and vertices with them.
TEST( uneven_steps_arrive_where_even_ones_do )
{
    wisp_motion_constraints_def def = wisp_default_motion_constraints_def();
    def.max_distance = 0.0f;
    SCOPED( close_held ) held s = open_held();
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

TEST( what_cannot_be_is_refused_by_vertex )
{
    SCOPED( close_held ) held s = open_held();
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
                    "max_distance of vertex 5: got nan," );
    def.max_distances = NULL;
    map[5] = 1e-9f;
    def.backstop_radii = map;
    expect_refusal( s.world, wisp_set_motion_constraints( s.world, s.e, &def ), WISP_BAD_INPUT,
                    "backstop_radius of vertex 5: got 1e-09," );
    def.backstop_radii = NULL;
    assert_true( wisp_world_hash( s.world ) == before );
    def.max_distance = 1.0f;
    def.enabled = false;
    constrain( &s, &def );
    steps( &s, 1 );
    assert_int_equal( count_passes_named( s.world, "motion_constraints.project" ), 0 );
}
