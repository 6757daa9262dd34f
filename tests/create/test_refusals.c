// What hosts get wrong: null pointers, removed entities, definitions that nobody filled, calls in the middle of a step, counts beyond
// sense. Each is a status with a message, and changes nothing.
#include "support.h"

#include "attachments.h"
#include "balloon.h"
#include "boundary.h"
#include "create.h"
#include "environment.h"
#include "frozen_hair.h"
#include "guide_hair.h"
#include "implicit_cloth.h"
#include "membrane.h"
#include "pick.h"
#include "seams.h"
#include "strand_appearance.h"
#include "tearing.h"
#include "wisp/explain.h"
#include "wisp/fabric.h"
#include "wisp/generate.h"

#include <pthread.h>
#include <unistd.h>

enum
{
    SIDE = 5,
};

typedef struct fixture
{
    wisp_world* world;
    wisp_entity cloth, hair, collider, stale;
    uint64_t hash;
} fixture;

static wisp_vec3 points[WISP_GRID_VERTICES( SIDE, SIDE )], strand_points[8];
static int32_t triangles[WISP_GRID_TRIANGLES( SIDE, SIDE )][3], offsets[5];
static const int32_t corners[] = { 0, SIDE - 1 };

static wisp_create_cloth_def cloth_def( void )
{
    wisp_create_cloth_def def = wisp_default_create_cloth_def();
    assert_int_equal( wisp_generate_grid( SIDE, SIDE, 0.1f, 0.1f, points, &triangles[0][0], NULL ), WISP_OK );
    def.points = points;
    def.vertex_count = WISP_COUNT( points );
    def.triangles = &triangles[0][0];
    def.triangle_count = WISP_COUNT( triangles );
    def.pins = corners;
    def.pin_count = WISP_COUNT( corners );
    return def;
}

static wisp_create_hair_def hair_def( void )
{
    wisp_create_hair_def def = wisp_default_create_hair_def();
    assert_int_equal( wisp_generate_strand_rows( 2, 2, 0.1f, 2, 0.1f, strand_points, offsets, NULL ), WISP_OK );
    def.points = strand_points;
    def.offsets = offsets;
    def.strand_count = 4;
    return def;
}

static int open_fixture( void** state )
{
    fixture* f = checked_calloc( 1, sizeof( fixture ) );
    const wisp_create_cloth_def cloth = cloth_def();
    const wisp_create_hair_def hair = hair_def();
    wisp_collider_def collider = wisp_default_collider_def();
    collider.kind = WISP_COLLIDER_SPHERE;
    wisp_world_def def = wisp_default_world_def();
    def.modules = wisp_all_modules( &def.module_count );
    assert_int_equal( wisp_world_create( &def, &f->world, NULL ), WISP_OK );
    assert_int_equal( wisp_create_cloth( f->world, &cloth, &f->cloth ), WISP_OK );
    assert_int_equal( wisp_create_cloth( f->world, &cloth, &f->stale ), WISP_OK );
    assert_int_equal( wisp_create_hair( f->world, &hair, &f->hair ), WISP_OK );
    assert_int_equal( wisp_add_collider( f->world, &collider, &f->collider ), WISP_OK );
    assert_int_equal( wisp_remove( f->world, f->stale ), WISP_OK );
    assert_int_equal( wisp_world_step( f->world, 1.0f / 60.0f ), WISP_OK );
    f->hash = wisp_world_hash( f->world );
    *state = f;
    return 0;
}

static int close_fixture( void** state )
{
    fixture* f = *state;
    wisp_world_destroy( f->world );
    free( f );
    return 0;
}

#define REFUSAL( name ) TEST_WITH( name, open_fixture, close_fixture )

// Every call on an entity, with good arguments otherwise. W is the world, E the entity.
#define ENTITY_CALLS( X )                                                                                            \
    X( wisp_pin( W, E, corners, 1 ) )                                                                                \
    X( wisp_unpin( W, E, corners, 1 ) )                                                                              \
    X( wisp_move_pins( W, E, corners, points, 1 ) )                                                                  \
    X( wisp_attach_pins( W, E, corners, 1, E ) )                                                                     \
    X( wisp_detach_pins( W, E, corners, 1 ) )                                                                        \
    X( wisp_set_membrane( W, E, NULL ) )                                                                             \
    X( wisp_set_tearing( W, E, NULL ) )                                                                              \
    X( wisp_read_tearing_stats( W, E, &( wisp_tearing_stats ){ 0 } ) )                                               \
    X( wisp_read_triangles( W, E, &triangles[0][0], WISP_COUNT( triangles ) ) )                                      \
    X( wisp_set_gravity( W, E, points[0] ) )                                                                         \
    X( wisp_set_damping( W, E, 1.0f ) )                                                                              \
    X( wisp_set_strain_limit( W, E, 0.5f, 2.0f ) )                                                                   \
    X( wisp_set_velocity( W, E, points[0], points[0] ) )                                                             \
    X( wisp_apply_gust( W, E, points[0], false ) )                                                                   \
    X( wisp_add_instance( W, E, NULL, &( wisp_entity ){ 0 } ) )                                                      \
    X( wisp_remove( W, E ) )                                                                                         \
    X( wisp_teleport( W, E, ( wisp_transform ){ { 0, 0, 0, 1 }, { 0, 0, 0 } }, true ) )                              \
    X( wisp_resume( W, E ) )                                                                                         \
    X( wisp_set_substeps( W, E, 20 ) )                                                                               \
    X( wisp_read_substeps( W, E, &( int ){ 0 } ) )                                                                   \
    X( wisp_request( W, E, WISP_MOTION_STATS ) )                                                                     \
    X( wisp_cancel_request( W, E, WISP_MOTION_STATS ) )                                                              \
    X( wisp_world_view( W, E, WISP_SURFACE_POINTS, &( wisp_view ){ 0 } ) )                                           \
    X( wisp_read_motion_stats( W, E, &( wisp_motion_stats ){ 0 } ) )                                                 \
    X( wisp_pick( W, E, points[0], points[1], 0.0f, &( wisp_hit ){ 0 } ) )                                           \
    X( wisp_world_hash_column( W, E, WISP_SURFACE_POINTS, &( uint64_t ){ 0 } ) )                                     \
    X( wisp_set_cloth_wind( W, E, points[0] ) )                                                                      \
    X( wisp_set_balloon_gas_ratio( W, E, 1.0f ) )                                                                    \
    X( wisp_set_balloon_inflation( W, E, 1.0f ) )                                                                    \
    X( wisp_open_balloon( W, E, true ) )                                                                             \
    X( wisp_request_balloon_stats( W, E, true ) )                                                                    \
    X( wisp_read_balloon_stats( W, E, &( wisp_balloon_stats ){ 0 } ) )                                               \
    X( wisp_unset_boundary( W, E ) )                                                                                 \
    X( wisp_read_boundary( W, E, &( wisp_boundary_view ){ 0 } ) )                                                    \
    X( wisp_read_boundary_stats( W, E, &( wisp_boundary_stats ){ 0 } ) )                                             \
    X( wisp_move_collider( W, E, ( wisp_transform ){ { 0, 0, 0, 1 }, { 0, 0, 0 } } ) )                               \
    X( wisp_request_collision_stats( W, E, true ) )                                                                  \
    X( wisp_read_collision_stats( W, E, &( wisp_collision_stats ){ 0 } ) )                                           \
    X( wisp_unset_contact( W, E ) )                                                                                  \
    X( wisp_read_contact_impulse( W, E, ( double[3] ){ 0 } ) )                                                       \
    X( wisp_read_contact_intersections( W, E, E, &( int ){ 0 } ) )                                                   \
    X( wisp_command_frozen_hair( W, E, points[0] ) )                                                                 \
    X( wisp_begin_frozen_hair_stroke( W, E ) )                                                                       \
    X( wisp_replay_frozen_hair( W, E, points[0], 1 ) )                                                               \
    X( wisp_read_frozen_hair_stats( W, E, &( wisp_frozen_hair_stats ){ 0 } ) )                                       \
    X( wisp_ghosts_between( W, E, 0.5f, ( wisp_vec3[8] ){ { 0, 0, 0 } } ) )                                          \
    X( wisp_request_implicit_cloth_stats( W, E, true ) )                                                             \
    X( wisp_read_implicit_cloth_stats( W, E, &( wisp_implicit_cloth_stats ){ 0 } ) )                                 \
    X( wisp_set_strand_wind( W, E, points[0] ) )                                                                     \
    X( wisp_set_strand_gravity( W, E, points[0] ) )                                                                  \
    X( wisp_move_strand_head( W, E, ( wisp_transform ){ { 0, 0, 0, 1 }, { 0, 0, 0 } } ) )                            \
    X( wisp_root_strands( W, E, E ) )                                                                                \
    X( wisp_read_strand_tension( W, E, ( float[8] ){ 0 } ) )                                                         \
    X( wisp_read_strand_hold( W, E, &( wisp_strand_hold ){ 0 } ) )

// Every call that reads a definition. D is a pointer to a definition that nobody filled, or null.
#define DEFINITION_CALLS( X )                                                                                        \
    X( wisp_add_surface( W, (const wisp_surface_def*)D, &( wisp_entity ){ 0 } ) )                                    \
    X( wisp_add_strands( W, (const wisp_strands_def*)D, &( wisp_entity ){ 0 } ) )                                    \
    X( wisp_set_cloth( W, E, (const wisp_cloth_def*)D ) )                                                            \
    X( wisp_set_balloon( W, E, (const wisp_balloon_def*)D ) )                                                        \
    X( wisp_set_implicit_cloth( W, E, (const wisp_implicit_cloth_def*)D ) )                                          \
    X( wisp_set_boundary( W, E, (const wisp_boundary_def*)D ) )                                                      \
    X( wisp_add_collider( W, (const wisp_collider_def*)D, &( wisp_entity ){ 0 } ) )                                  \
    X( wisp_set_collision( W, E, (const wisp_collision_def*)D ) )                                                    \
    X( wisp_set_contact_settings( W, (const wisp_contact_settings*)D ) )                                             \
    X( wisp_set_contact( W, E, (const wisp_contact_def*)D ) )                                                        \
    X( wisp_set_environment( W, E, (const wisp_environment_def*)D ) )                                                \
    X( wisp_set_frozen_hair( W, E, (const wisp_frozen_hair_def*)D ) )                                                \
    X( wisp_set_ghosts( W, E, (const wisp_ghosts_def*)D ) )                                                          \
    X( wisp_add_curves( W, (const wisp_curves_def*)D, &( wisp_entity ){ 0 } ) )                                      \
    X( wisp_set_strand_appearance( W, E, (const wisp_strand_appearance_def*)D ) )                                    \
    X( wisp_set_strand_dynamics( W, E, (const wisp_strand_dynamics_def*)D ) )                                        \
    X( wisp_set_strand_grid( W, E, (const wisp_strand_grid_def*)D ) )                                                \
    X( wisp_create_cloth( W, (const wisp_create_cloth_def*)D, &( wisp_entity ){ 0 } ) )                              \
    X( wisp_create_hair( W, (const wisp_create_hair_def*)D, &( wisp_entity ){ 0 } ) )

// Every call of a world alone.
#define WORLD_CALLS( X )                                                                                             \
    X( wisp_world_step( W, 0.01f ) )                                                                                 \
    X( wisp_world_advance( W, 0.01f, 0.01f, NULL, NULL ) )                                                           \
    X( wisp_world_explain( W, &( wisp_plan_info* ){ NULL } ) )                                                       \
    X( wisp_world_plan( W, ignore_line, NULL ) )                                                                     \
    X( wisp_world_snapshot( W, ( char[4] ){ 0 }, 4 ) )                                                               \
    X( wisp_world_restore( W, ( char[4] ){ 0 }, 4 ) )                                                                \
    X( wisp_request_contact_stats( W, true, false ) )                                                                \
    X( wisp_read_contact_stats( W, &( wisp_contact_stats ){ 0 } ) )

static void ignore_line( void* user, const char* line )
{
    (void)user, (void)line;
}

#define SHOWN( call, expected )                                                                                      \
    {                                                                                                                \
        const wisp_status got = call;                                                                                \
        if ( got != ( expected ) || wisp_world_message( W )[0] == '\0' )                                             \
        {                                                                                                            \
            fail_msg( "%s: %s, '%s'", #call, wisp_status_name( got ), wisp_world_message( W ) );                     \
        }                                                                                                            \
    }

REFUSAL( a_world_that_is_null_is_a_status )
{
    const fixture* f = *state;
    wisp_world* W = NULL;
    const wisp_entity E = f->cloth;
    const wisp_cloth_def filled = wisp_default_cloth_def();
    const void* D = &filled;
#define X( call ) SHOWN( call, WISP_BAD_INPUT )
    ENTITY_CALLS( X )
    DEFINITION_CALLS( X )
    WORLD_CALLS( X )
#undef X
    assert_string_equal( wisp_world_message( NULL ), "world: got null" );
    assert_false( wisp_is_alive( NULL, E ) || wisp_is_halted( NULL, E ) || wisp_has_strands( NULL, E ) );
    assert_int_equal( wisp_world_counter( NULL, WISP_COUNT_STEPS ) + wisp_world_hash( NULL ), 0 );
    assert_int_equal( wisp_world_memory( NULL ) + wisp_world_snapshot_size( NULL ), 0 );
    assert_int_equal( wisp_world_workers( NULL ) + wisp_world_memory_parts( NULL, NULL, 0 ), 0 );
    assert_int_equal( wisp_world_plan_passes( NULL ), -1 );
    assert_int_equal( wisp_world_profile( NULL ).count, 0 );
    assert_string_equal( wisp_world_isa( NULL ), "none" );
    assert_int_equal( wisp_world_find_component( NULL, "point.strain" ), 0 );
    assert_string_equal( wisp_world_component_name( NULL, WISP_POINT_STRAIN ), "unknown" );
}

REFUSAL( an_entity_that_was_removed_is_a_status )
{
    const fixture* f = *state;
    wisp_world* W = f->world;
    const wisp_entity entities[] = { f->stale, { 0, 0 }, { 1u << 31, 7 } };
    for ( int i = 0; i < WISP_COUNT( entities ); ++i )
    {
        const wisp_entity E = entities[i];
#define X( call ) SHOWN( call, WISP_STALE_ID )
        ENTITY_CALLS( X )
#undef X
        assert_false( wisp_is_alive( W, E ) );
    }
    assert_true( wisp_world_hash( W ) == f->hash );
}

REFUSAL( a_definition_that_is_null_or_was_not_filled_is_a_status )
{
    const fixture* f = *state;
    wisp_world* W = f->world;
    const wisp_entity E = f->cloth;
    static const uint32_t zeros[256], large[256] = { 1024 };
    const void* definitions[] = { NULL, zeros, large };
    for ( int i = 0; i < WISP_COUNT( definitions ); ++i )
    {
        const void* D = definitions[i];
#define X( call ) SHOWN( call, WISP_BAD_INPUT )
        DEFINITION_CALLS( X )
#undef X
    }
    assert_contains( wisp_world_message( W ), "wisp_default_create_hair_def()" );
    assert_true( wisp_world_hash( W ) == f->hash );
}

REFUSAL( pointers_that_are_null_are_named )
{
    const fixture* f = *state;
    wisp_world* W = f->world;
    const wisp_entity E = f->cloth;
    const wisp_create_cloth_def cloth = cloth_def();
    const wisp_collider_def collider = wisp_default_collider_def();
#define NAMED( call, name )                                                                                          \
    SHOWN( call, WISP_BAD_INPUT )                                                                                    \
    assert_contains( wisp_world_message( W ), name ": got null" );
    NAMED( wisp_pin( W, E, NULL, 3 ), "vertices" )
    NAMED( wisp_move_pins( W, E, corners, NULL, 1 ), "targets" )
    NAMED( wisp_world_view( W, E, WISP_SURFACE_POINTS, NULL ), "out" )
    NAMED( wisp_read_motion_stats( W, E, NULL ), "out" )
    NAMED( wisp_world_snapshot( W, NULL, 100 ), "out" )
    NAMED( wisp_world_restore( W, NULL, 100 ), "bytes" )
    NAMED( wisp_world_explain( W, NULL ), "out" )
    NAMED( wisp_world_plan( W, NULL, NULL ), "write" )
    NAMED( wisp_add_collider( W, &collider, NULL ), "out" )
    NAMED( wisp_create_cloth( W, &cloth, NULL ), "out" )
    NAMED( wisp_read_contact_stats( W, NULL ), "out" )
    NAMED( wisp_read_strand_tension( W, f->hair, NULL ), "tensions" )
#undef NAMED
    assert_int_equal( wisp_world_find_component( W, NULL ), 0 );
    assert_contains( wisp_world_message( W ), "name: got null" );
    SHOWN( wisp_pin( W, E, corners, -1 ), WISP_BAD_INPUT )
    assert_contains( wisp_world_message( W ), "got -1 of them" );
    wisp_error error;
    assert_int_equal( wisp_world_create( NULL, NULL, &error ), WISP_BAD_INPUT );
    assert_int_equal( wisp_fabric_cook( NULL, NULL, NULL, &error ), WISP_BAD_INPUT );
    assert_true( wisp_environment_stiffness( NULL, 0.0f, 0.0f ) == 0.0f );
    wisp_strand_appearance_at( NULL, 0.5f, &( float ){ 0 }, NULL );
    wisp_plan_info_text( NULL, NULL, 0 );
    wisp_plan_pass_text( NULL, NULL, 0 );
    wisp_entity garbage = { 7, 7 };
    assert_int_equal( wisp_add_surface( W, NULL, &garbage ), WISP_BAD_INPUT );
    assert_int_equal( garbage.index, 0 );
    assert_int_equal( wisp_fabric_need( NULL, WISP_FABRIC_EDGES ), WISP_BAD_INPUT );
    assert_int_equal( wisp_fabric_bytes( NULL ), 0 );
    wisp_fabric_retain( NULL );
    wisp_fabric_release( NULL );
    wisp_plan_info_release( NULL );
    assert_true( wisp_world_hash( W ) == f->hash );
}

REFUSAL( a_message_is_gone_after_a_call_that_works )
{
    const fixture* f = *state;
    assert_int_equal( wisp_request( f->world, f->stale, WISP_SURFACE_POINTS ), WISP_STALE_ID );
    assert_true( wisp_world_message( f->world )[0] != '\0' );
    assert_int_equal( wisp_request( f->world, f->cloth, WISP_SURFACE_POINTS ), WISP_OK );
    assert_string_equal( wisp_world_message( f->world ), "" );
}

REFUSAL( components_are_found_by_their_names )
{
    const fixture* f = *state;
    assert_int_equal( wisp_world_find_component( f->world, "point.strain" ), WISP_POINT_STRAIN );
    assert_int_equal( wisp_world_find_component( f->world, "surface.points" ), WISP_SURFACE_POINTS );
    assert_string_equal( wisp_world_component_name( f->world, WISP_SURFACE_NORMALS ), "surface.normals" );
    assert_int_equal( wisp_world_find_component( f->world, "surface.colour" ), 0 );
    assert_contains( wisp_world_message( f->world ), "'surface.colour'" );
    assert_string_equal( wisp_world_component_name( f->world, 60000 ), "unknown" );
}

REFUSAL( numbers_beyond_sense_are_refused_with_the_reason )
{
    const fixture* f = *state;
    wisp_world* W = f->world;
    SHOWN( wisp_set_substeps( W, f->cloth, 2000000000 ), WISP_BAD_INPUT )
    assert_contains( wisp_world_message( W ), "substeps: got 2000000000, expected 0 to 1000000" );
    const float wrong[] = { INFINITY, -INFINITY, NAN, 0.0f, -1.0f, 1e30f };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        SHOWN( wisp_world_step( W, wrong[i] ), WISP_BAD_INPUT )
        assert_contains( wisp_world_message( W ), "expected a number above 0 and below 1e6" );
        SHOWN( wisp_world_advance( W, 0.1f, wrong[i], NULL, NULL ), WISP_BAD_INPUT )
    }
    SHOWN( wisp_set_gravity( W, f->cloth, ( wisp_vec3 ){ 0.0f, INFINITY, 0.0f } ), WISP_BAD_INPUT )
    SHOWN( wisp_set_gravity( W, f->hair, points[0] ), WISP_CONFLICT )
    assert_contains( wisp_world_message( W ), "is not a surface: it has strands" );
    const size_t size = wisp_world_snapshot_size( W );
    char* bytes = checked_malloc( size );
    SHOWN( wisp_world_snapshot( W, bytes, size - 1 ), WISP_BAD_INPUT )
    assert_contains( wisp_world_message( W ), "snapshot: got room for" );
    free( bytes );
    assert_int_equal( wisp_world_counter( W, (wisp_counter)999 ), 0 );
    assert_true( wisp_world_hash( W ) == f->hash );
}

// ---- calls in the middle of a step ----

typedef struct intruder
{
    fixture f;
    int calls;
} intruder;

static void* step_from_a_thread( void* user )
{
    intruder* i = user;
    wisp_world* W = i->f.world;
    SHOWN( wisp_world_step( W, 0.01f ), WISP_CONFLICT )
    return NULL;
}

static void intrude( void* user, int block_count, wisp_block_fn* run, void* context )
{
    intruder* i = user;
    wisp_world* W = i->f.world;
    if ( W != NULL && i->calls++ == 0 )
    {
        const wisp_entity E = i->f.cloth;
        const wisp_cloth_def filled = wisp_default_cloth_def();
        const void* D = &filled;
#define X( call ) SHOWN( call, WISP_CONFLICT )
        ENTITY_CALLS( X )
        DEFINITION_CALLS( X )
        WORLD_CALLS( X )
#undef X
        assert_contains( wisp_world_message( W ), "a step of this world runs" );
        wisp_world_destroy( W );
        pthread_t thread;
        assert_int_equal( pthread_create( &thread, NULL, step_from_a_thread, i ), 0 );
        assert_int_equal( pthread_join( thread, NULL ), 0 );
    }
    for ( int block = 0; block < block_count; ++block )
    {
        run( context, block, 0 );
    }
}

TEST( a_call_during_a_step_is_refused_and_the_step_goes_on )
{
    enum
    {
        WIDE = 60, // vertices on a side: enough for several blocks
    };
    static wisp_vec3 many_points[WISP_GRID_VERTICES( WIDE, WIDE )];
    static int32_t many_triangles[WISP_GRID_TRIANGLES( WIDE, WIDE )][3];
    uint64_t hashes[2];
    for ( int variant = 0; variant < 2; ++variant )
    {
        intruder i = { .calls = variant == 0 ? 0 : 1 };
        test_log log = { 0 };
        wisp_create_cloth_def cloth = cloth_def();
        assert_int_equal( wisp_generate_grid( WIDE, WIDE, 0.1f, 0.1f, many_points, &many_triangles[0][0], NULL ),
                          WISP_OK );
        cloth.points = many_points;
        cloth.vertex_count = WISP_COUNT( many_points );
        cloth.triangles = &many_triangles[0][0];
        cloth.triangle_count = WISP_COUNT( many_triangles );
        wisp_world_def def = wisp_default_world_def();
        wisp_world* world;
        def.modules = wisp_all_modules( &def.module_count );
        def.workers = 2;
        def.parallel_for = intrude;
        def.parallel_for_user = &i;
        def.log = test_log_write;
        def.log_user = &log;
        assert_int_equal( wisp_world_create( &def, &world, NULL ), WISP_OK );
        assert_int_equal( wisp_create_cloth( world, &cloth, &i.f.cloth ), WISP_OK );
        i.f.world = world;
        assert_int_equal( wisp_world_step( world, 0.01f ), WISP_OK );
        assert_true( i.calls > variant );
        assert_string_equal( wisp_world_message( world ), "" );
        assert_int_equal( wisp_world_counter( world, WISP_COUNT_STEPS ), 1 );
        hashes[variant] = wisp_world_hash( world );
        wisp_world_destroy( world );
    }
    assert_true( hashes[0] == hashes[1] );
}

// ---- what is printed ----

TEST( a_step_that_nothing_was_requested_of_says_so_once )
{
    test_log log = { 0 };
    wisp_world_def def = wisp_default_world_def();
    def.modules = wisp_all_modules( &def.module_count );
    def.log = test_log_write;
    def.log_user = &log;
    wisp_world* world;
    wisp_entity cloth;
    wisp_create_cloth_def piece = cloth_def();
    assert_int_equal( wisp_world_create( &def, &world, NULL ), WISP_OK );
    assert_int_equal( wisp_world_step( world, 0.01f ), WISP_OK );
    assert_int_equal( log.count, 0 ); // an empty world is empty
    assert_int_equal( wisp_create_cloth( world, &piece, &cloth ), WISP_OK );
    assert_int_equal( wisp_cancel_request( world, cloth, WISP_SURFACE_POINTS ), WISP_OK );
    assert_int_equal( wisp_cancel_request( world, cloth, WISP_SURFACE_NORMALS ), WISP_OK );
    for ( int step = 0; step < 3; ++step )
    {
        assert_int_equal( wisp_world_step( world, 0.01f ), WISP_OK );
    }
    assert_int_equal( log.count, 1 );
    assert_contains( log.last, "nothing is requested" );
    wisp_world_destroy( world );
}

REFUSAL( a_call_that_fails_prints_nothing_unless_the_host_asked )
{
    const fixture* f = *state; // without a log
    FILE* kept = tmpfile();
    assert_non_null( kept );
    fflush( stderr );
    const int before = dup( fileno( stderr ) );
    assert_true( dup2( fileno( kept ), fileno( stderr ) ) >= 0 );
    assert_int_equal( wisp_remove( f->world, f->stale ), WISP_STALE_ID );
    assert_int_equal( wisp_world_step( f->world, NAN ), WISP_BAD_INPUT );
    fflush( stderr );
    assert_true( dup2( before, fileno( stderr ) ) >= 0 );
    close( before );
    fseek( kept, 0, SEEK_END );
    assert_int_equal( ftell( kept ), 0 );
    fclose( kept );
}
