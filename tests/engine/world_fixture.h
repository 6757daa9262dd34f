/// Worlds with the modules of the engine, on a host that counts its memory.
#pragma once

#include "support.h"

#include "world.h"

#include "environment.h"
#include "cloth.h"
#include "frozen_hair.h"
#include "strand_appearance.h"

typedef struct hosted
{
    test_host host;
    test_log log;
    wisp_world_def def;
    wisp_world* world;
} hosted;

static inline wisp_world_def hosted_def( hosted* h )
{
    static const wisp_module* const MODULES[] = { &wisp_environment_module, &wisp_cloth_module,
                                                  &wisp_frozen_hair_module, &wisp_strand_appearance_module };
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.modules = MODULES;
    def.module_count = WISP_COUNT( MODULES );
    def.allocator = test_host_allocator( &h->host );
    def.log = test_log_write;
    def.log_user = &h->log;
    def.workers = 1;
    return def;
}

/// A world of these modules, which live as long as it does; null: the four above. @param given what is 0 is 1, or the default
static inline void open_modules( hosted* h, const wisp_module* const* modules, int module_count,
                                 wisp_world_def given )
{
    *h = ( hosted ){ 0 };
    h->def = hosted_def( h );
    h->def.module_count = modules != NULL ? module_count : h->def.module_count;
    h->def.modules = modules != NULL ? modules : h->def.modules;
    h->def.substeps = given.substeps > 0 ? given.substeps : 1;
    h->def.iterations = given.iterations > 0 ? given.iterations : 1;
    h->def.workers = given.workers > 0 ? given.workers : 1;
    h->def.longest_step = given.longest_step > 0 ? given.longest_step : h->def.longest_step;
    h->def.isa = given.isa;
    h->def.parallel_for = given.parallel_for, h->def.parallel_for_user = given.parallel_for_user;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
}

/// OPEN( &h, MODULES, .substeps = 8, .workers = 2 ). Close with close_world().
#define OPEN( h, modules, ... ) open_modules( h, modules, WISP_COUNT( modules ), ( wisp_world_def ){ __VA_ARGS__ } )

/// Free with close_hosted().
static inline hosted* new_hosted( const wisp_module* const* modules, int module_count, int substeps, int iterations,
                                  int workers )
{
    hosted* h = checked_calloc( 1, sizeof( hosted ) );
    open_modules( h, modules, module_count,
                  ( wisp_world_def ){ .substeps = substeps, .iterations = iterations, .workers = workers } );
    return h;
}

static inline int open_hosted( void** state )
{
    *state = new_hosted( NULL, 0, 1, 1, 1 );
    return 0;
}

static inline int close_hosted( void** state )
{
    SCOPED( free_local ) hosted* h = *state;
    wisp_world_destroy( h->world );
    assert_host_memory_is_released( &h->host );
    return 0;
}

/// For locals that point to such a world.
static inline void close_local( hosted** h )
{
    void* state = *h;
    close_hosted( &state );
}

/// Frozen hair that clumps: neighbours are within its radius.
static inline wisp_frozen_hair_def clumping_def( void )
{
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    def.cursor = ( wisp_vec3 ){ 0.1f, 0.0f, 0.1f };
    def.reach = 1.0f;
    return def;
}

/// Strands with frozen hair whose points are requested.
static inline wisp_entity add_frozen( wisp_world* world, int strand_count, int length )
{
    wisp_entity e = test_add_strands( world, strand_count, length );
    wisp_frozen_hair_def def = clumping_def();
    assert_int_equal( wisp_set_frozen_hair( world, e, &def ), WISP_OK );
    assert_int_equal( wisp_request( world, e, WISP_STRAND_POINTS ), WISP_OK );
    return e;
}

static inline wisp_view view_of( wisp_world* world, wisp_entity e, wisp_component component )
{
    wisp_view view = { 0 };
    assert_int_equal( wisp_world_view( world, e, component, &view ), WISP_OK );
    return view;
}

static inline void assert_status( wisp_world* world, wisp_status status, wisp_status expected )
{
    if ( status != expected )
    {
        fail_msg( "%s instead of %s: %s", wisp_status_name( status ), wisp_status_name( expected ),
                  wisp_world_message( world ) );
    }
}

/// Give an entity an effect: its default definition `d`, changed by the last arguments. The call must succeed.
#define SET( world, entity, effect, ... )                                                                            \
    do                                                                                                               \
    {                                                                                                                \
        wisp_##effect##_def d = wisp_default_##effect##_def();                                                       \
        __VA_ARGS__;                                                                                                 \
        assert_status( world, wisp_set_##effect( world, entity, &d ), WISP_OK );                                     \
    } while ( 0 )
#define SET_DEFAULT( world, entity, effect ) SET( world, entity, effect, (void)0 )

static inline uint64_t hash_of( wisp_world* world, wisp_entity e, wisp_component component )
{
    uint64_t hash = 0;
    assert_int_equal( wisp_world_hash_column( world, e, component, &hash ), WISP_OK );
    return hash;
}

static inline void step( wisp_world* world )
{
    if ( wisp_world_step( world, 0.01f ) != WISP_OK )
    {
        fail_msg( "no step: %s", wisp_world_message( world ) );
    }
}

static inline void run_steps( wisp_world* world, int steps, float dt )
{
    for ( int i = 0; i < steps; ++i )
    {
        assert_status( world, wisp_world_step( world, dt ), WISP_OK );
    }
}

/// A world of its own, for a test that needs several or chooses substeps. Close with close_world().
static inline void open_world( hosted* h, int substeps, int iterations )
{
    open_modules( h, NULL, 0, ( wisp_world_def ){ .substeps = substeps, .iterations = iterations } );
}

static inline void close_world( hosted* h )
{
    wisp_world_destroy( h->world );
    assert_host_memory_is_released( &h->host );
}

static inline void assert_near( double actual, double expected, double tolerance )
{
    if ( !( fabs( actual - expected ) <= tolerance ) )
    {
        fail_msg( "%.9g is not within %g of %.9g", actual, tolerance, expected );
    }
}

/// Where a character is after some steps that it walks and turns about the vertical axis.
static inline wisp_transform walked_pose( int step, float way, float angle )
{
    const float t = (float)step, half = 0.5f * angle * t;
    return wisp_transform_make( ( wisp_quat ){ 0.0f, sinf( half ), 0.0f, cosf( half ) },
                                ( wisp_vec3 ){ way * t, 0.01f * way * t * t, -0.5f * way * t } );
}

/// Define a case in a world that `open` makes: HOSTED_TEST( name, open_hosted ) { ... h->world ... }
#define HOSTED_TEST( name, open )                                                                                    \
    static void name##_in( hosted* h );                                                                              \
    TEST_WITH( name, open, close_hosted )                                                                            \
    {                                                                                                                \
        name##_in( *state );                                                                                         \
    }                                                                                                                \
    static void name##_in( __attribute__( ( unused ) ) hosted* h )

#define WORLD_TEST( test ) HOSTED_TEST( test, open_hosted )
