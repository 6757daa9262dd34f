// Strands carried by others, and bodies: ghosts next to a sphere, frozen hair on them, bodies that move, static
// strands.
#include "guide_hair_fixture.h"

#include "collision.h"
#include "strands.h"

enum
{
    TARGETS = 6,
    GHOSTS = 36,
    POINTS = GHOSTS * NODES,
};

static const float THICKNESS = 0.004f;
static const float RADIUS = 0.04f;
static const wisp_vec3 CENTRE = { 0.1f, 0.9f, 0.042f }; // the nearest ghosts hang inside it, their guides do not

// A push is rounded in the body's frame and in the world, whose coordinates are below 1.5 m.
static const double ROUNDED = 16.0 * (double)FLT_EPSILON;

static wisp_world* new_world( int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_collision_module, &wisp_frozen_hair_module,
                                                  &wisp_guide_hair_module, &wisp_strands_module };
    wisp_world_def def = wisp_default_world_def();
    def.modules = MODULES;
    def.module_count = WISP_COUNT( MODULES );
    def.log = guide_forget;
    def.workers = workers;
    def.substeps = 4;
    wisp_world* world = NULL;
    assert_int_equal( wisp_world_create( &def, &world, NULL ), WISP_OK );
    return world;
}

// Six guides with six ghosts each, as in the other tests of ghosts, in a world with collision.
static flock new_flock( int workers )
{
    flock f = { .s = make_scene( TARGETS, GHOSTS / TARGETS ), .ghost_nodes = NODES };
    for ( int n = 0; n < POINTS; ++n )
    {
        f.ghost[n] = guide_round( f.s.ghost[n] );
    }
    f.world = new_world( workers );
    f.targets = guide_add( f.world, f.s.target, TARGETS, NODES );
    f.ghosts = guide_add( f.world, f.ghost, GHOSTS, NODES );
    guide_ok( f.world, wisp_world_attach( f.world, f.targets, WISP_STRAND_VELOCITY ) );
    guide_ok( f.world, wisp_request( f.world, f.ghosts, WISP_STRAND_POINTS ) );
    guide_follow( &f, wisp_default_ghosts_def() );
    return f;
}

static wisp_entity add_body( wisp_world* world, wisp_collider_def def )
{
    wisp_entity body;
    guide_ok( world, wisp_add_collider( world, &def, &body ) );
    return body;
}

static wisp_transform at( wisp_vec3 place )
{
    return ( wisp_transform ){ { 0.0f, 0.0f, 0.0f, 1.0f }, place };
}

static wisp_collider_def sphere_at( wisp_vec3 centre )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_SPHERE;
    def.radius = RADIUS;
    def.pose = at( centre );
    return def;
}

static void collide( wisp_world* world, wisp_entity strands )
{
    wisp_collision_def def = wisp_default_collision_def();
    def.thickness = THICKNESS;
    guide_ok( world, wisp_set_collision( world, strands, &def ) );
    guide_ok( world, wisp_request_collision_stats( world, strands, true ) );
}

static wisp_collision_stats stats_of( wisp_world* world, wisp_entity strands )
{
    wisp_collision_stats stats;
    guide_ok( world, wisp_read_collision_stats( world, strands, &stats ) );
    return stats;
}

// Distance to the surface of the sphere; below 0 inside.
static double gap_to( wisp_vec3 centre, wisp_vec3 p )
{
    return vec_distance( p, centre ) - (double)RADIUS;
}

TEST( ghosts_keep_the_thickness_where_they_would_be_in_a_body )
{
    SCOPED( guide_end ) flock f = new_flock( 1 ), plain = new_flock( 1 );
    add_body( f.world, sphere_at( CENTRE ) );
    collide( f.world, f.ghosts );
    int inside = 0;
    for ( int frame = 0; frame < 60; ++frame )
    {
        guide_swing( &f );
        guide_swing( &plain );
        const wisp_vec3 *now = guide_points( f.world, f.ghosts ),
                        *without = guide_points( plain.world, plain.ghosts );
        int near = 0, edge = 0; // vertices to be moved, and those within rounding of the surface
        for ( int n = 0; n < POINTS; ++n )
        {
            const double gap = gap_to( CENTRE, without[n] );
            const bool moved = n % NODES > 0 && gap < (double)THICKNESS - ROUNDED;
            inside += gap < 0.0 ? 1 : 0;
            near += moved ? 1 : 0;
            if ( moved )
            {
                // at the thickness, radially outwards
                assert_close( gap_to( CENTRE, now[n] ), (double)THICKNESS, ROUNDED );
                const double fraction = ( (double)RADIUS + (double)THICKNESS ) / ( (double)RADIUS + gap );
                assert_close( (double)now[n].z - (double)CENTRE.z,
                              fraction * ( (double)without[n].z - (double)CENTRE.z ), ROUNDED );
            }
            else if ( n % NODES > 0 && gap < (double)THICKNESS + ROUNDED )
            {
                edge += 1;
            }
            else
            {
                assert_memory_equal( now + n, without + n, sizeof( wisp_vec3 ) );
            }
        }
        const wisp_collision_stats stats = stats_of( f.world, f.ghosts );
        assert_in_range( stats.contacts, near, near + edge );
        assert_true( (double)stats.penetration <= ROUNDED );
    }
    assert_true( inside > 100 );
}

TEST( roots_stay_in_the_body_that_they_grow_from )
{
    const wisp_vec3 head = { 0.05f, 1.0f, 0.0f };
    SCOPED( guide_end ) flock f = new_flock( 1 ), plain = new_flock( 1 );
    add_body( f.world, sphere_at( head ) );
    collide( f.world, f.ghosts );
    int roots = 0, moved = 0;
    for ( int frame = 0; frame < 20; ++frame )
    {
        guide_swing( &f );
        guide_swing( &plain );
        const wisp_vec3 *now = guide_points( f.world, f.ghosts ),
                        *without = guide_points( plain.world, plain.ghosts );
        for ( int n = 0; n < POINTS; ++n )
        {
            if ( n % NODES == 0 )
            {
                roots += gap_to( head, now[n] ) < 0.0 ? 1 : 0;
                assert_memory_equal( now + n, without + n, sizeof( wisp_vec3 ) );
            }
            else
            {
                moved += gap_to( head, without[n] ) < 0.0 ? 1 : 0;
                assert_true( gap_to( head, now[n] ) > (double)THICKNESS - ROUNDED );
            }
        }
    }
    assert_true( roots > 20 && moved > 20 );
}

// The world has four substeps, of which only the last one's end counts.
TEST( ghosts_keep_out_of_where_a_body_is_at_the_end_of_the_step )
{
    SCOPED( guide_end ) flock f = new_flock( 1 );
    const wisp_entity body = add_body( f.world, sphere_at( CENTRE ) );
    collide( f.world, f.ghosts );
    int touched = 0;
    for ( int frame = 0; frame < 40; ++frame )
    {
        const wisp_vec3 there = { 0.25f * (float)( frame % 8 ) / 8.0f, 0.9f, 0.03f };
        guide_ok( f.world, wisp_move_collider( f.world, body, at( there ) ) );
        guide_swing( &f );
        const wisp_vec3* now = guide_points( f.world, f.ghosts );
        for ( int n = 0; n < POINTS; ++n )
        {
            assert_true( n % NODES == 0 || gap_to( there, now[n] ) > (double)THICKNESS - ROUNDED );
        }
        touched += stats_of( f.world, f.ghosts ).contacts;
    }
    assert_true( touched > 100 );
}

TEST( nothing_is_left_of_a_body_that_is_gone )
{
    SCOPED( guide_end ) flock f = new_flock( 1 ), plain = new_flock( 1 );
    const wisp_entity body = add_body( f.world, sphere_at( CENTRE ) );
    collide( f.world, f.ghosts );
    for ( int frame = 0; frame < 20; ++frame )
    {
        guide_swing( &f );
        guide_swing( &plain );
    }
    assert_memory_not_equal( guide_points( f.world, f.ghosts ), guide_points( plain.world, plain.ghosts ),
                             POINTS * sizeof( wisp_vec3 ) );
    guide_ok( f.world, wisp_remove( f.world, body ) );
    guide_swing( &f );
    guide_swing( &plain );
    assert_memory_equal( guide_points( f.world, f.ghosts ), guide_points( plain.world, plain.ghosts ),
                         POINTS * sizeof( wisp_vec3 ) );
}

// Ghosts that are pushed and turn to a cursor each frame, against static hair at the positions to which they were
// pushed.
TEST( frozen_hair_starts_from_where_ghosts_were_pushed )
{
    SCOPED( guide_end ) flock f = new_flock( 2 ), bare = new_flock( 1 );
    wisp_frozen_hair_def look = wisp_default_frozen_hair_def();
    look.freeze = look.clump = false;
    look.update_on = WISP_FROZEN_UPDATE_FRAME;
    look.cursor = ( wisp_vec3 ){ 0.3f, 0.5f, 0.2f };
    look.reach = 100.0f;
    guide_ok( f.world, wisp_set_frozen_hair( f.world, f.ghosts, &look ) );
    guide_ok( f.world, wisp_request( f.world, f.ghosts, WISP_STRAND_POSED ) );
    add_body( f.world, sphere_at( CENTRE ) );
    add_body( bare.world, sphere_at( CENTRE ) );
    collide( f.world, f.ghosts );
    collide( bare.world, bare.ghosts );
    for ( int frame = 0; frame < 20; ++frame )
    {
        guide_swing( &f );
        guide_swing( &bare );
        assert_true( stats_of( bare.world, bare.ghosts ).contacts > 0 );
        double3 pushed[POINTS];
        for ( int n = 0; n < POINTS; ++n )
        {
            pushed[n] = guide_ghost( &bare, n / NODES, n % NODES );
        }
        SCOPED( destroy_local ) wisp_world* still = new_world( 1 );
        const wisp_entity hair = guide_add( still, pushed, GHOSTS, NODES );
        guide_ok( still, wisp_request( still, hair, WISP_STRAND_POINTS ) );
        guide_ok( still, wisp_set_frozen_hair( still, hair, &look ) );
        guide_step( still );
        assert_memory_equal( guide_points( f.world, f.ghosts ), guide_points( still, hair ),
                             POINTS * sizeof( wisp_vec3 ) );
    }
}

// Strands of two to ten vertices, so that some lanes end early and some are empty.
static wisp_entity add_uneven( wisp_world* world )
{
    int counts[20], total = 0;
    double3 nodes[20 * NODES];
    for ( int s = 0; s < 20; ++s )
    {
        counts[s] = 2 + s % 9;
        for ( int i = 0; i < counts[s]; ++i )
        {
            nodes[total++] = double3_make( 0.02 * s - 0.2, -0.01 * i, 0.001 * i );
        }
    }
    const wisp_entity strands = guide_add_mixed( world, nodes, 20, counts );
    guide_ok( world, wisp_request( world, strands, WISP_STRAND_POINTS ) );
    return strands;
}

TEST( still_strands_leave_every_kind_of_body_and_then_rest )
{
    for ( int kind = WISP_COLLIDER_PLANE; kind < WISP_COLLIDER_MESH; ++kind )
    {
        SCOPED( destroy_local ) wisp_world* world = new_world( 1 );
        const wisp_entity hair = add_uneven( world );
        wisp_collider_def def = wisp_default_collider_def();
        def.kind = (wisp_collider_kind)kind;
        def.radius = RADIUS;
        def.half_length = 0.05f;
        def.half_extent = ( wisp_vec3 ){ 0.1f, 0.02f, 0.03f };
        // turned by 30 degrees about z
        def.pose = ( wisp_transform ){ { 0.0f, 0.0f, 0.258819045f, 0.965925826f }, { 0.01f, -0.05f, 0.002f } };
        add_body( world, def );
        collide( world, hair );
        guide_step( world );
        const wisp_collision_stats stats = stats_of( world, hair );
        assert_true( stats.contacts >= 8 );
        // vertices that were moved are at their distance
        assert_true( (double)stats.penetration <= ROUNDED );
        const int count = wisp_world_strands( world, hair )->vertex_count;
        SCOPED( free_local ) wisp_vec3* before = checked_calloc( (size_t)count, sizeof( wisp_vec3 ) );
        memcpy( before, guide_points( world, hair ), (size_t)count * sizeof( wisp_vec3 ) );
        guide_step( world );
        for ( int n = 0; n < count; ++n )
        {
            const wisp_vec3 a = before[n], b = guide_points( world, hair )[n];
            assert_at( double3_make( (double)a.x, (double)a.y, (double)a.z ),
                       double3_make( (double)b.x, (double)b.y, (double)b.z ), ROUNDED );
        }
    }
}

// Strands for four ghosts over a floor, with dynamics added later: after the next request they fall on it.
TEST( strands_that_move_later_collide_as_such_when_queried_again )
{
    SCOPED( destroy_local ) wisp_world* world = new_world( 1 );
    const wisp_entity hair = add_uneven( world );
    wisp_collider_def floor = wisp_default_collider_def();
    floor.pose = at( ( wisp_vec3 ){ 0.0f, -0.105f, 0.0f } );
    add_body( world, floor );
    collide( world, hair );
    guide_step( world );
    const wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    guide_ok( world, wisp_set_strand_dynamics( world, hair, &dynamics ) );
    collide( world, hair );
    for ( int frame = 0; frame < 30; ++frame )
    {
        guide_step( world );
    }
    assert_true( stats_of( world, hair ).penetration < THICKNESS );
}

TEST( strands_that_move_in_a_way_without_weights_are_refused )
{
    SCOPED( guide_end ) flock f = new_flock( 1 );
    const wisp_collision_def def = wisp_default_collision_def();
    const uint64_t before = wisp_world_hash( f.world );
    assert_int_equal( wisp_set_collision( f.world, f.targets, &def ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( f.world ), "dynamics" ) );
    assert_int_equal( wisp_world_hash( f.world ), before );
}
