// Where the memory of a world goes: the parts of every scene of the project add up to what the host has lent, and none is unnamed.
#define _XOPEN_SOURCE 700

#include "scene_fixture.h"

#include "world_from_scene.h"

#include <dirent.h>
#include <stdatomic.h>
#include <stdlib.h>

enum
{
    MAX_PARTS = 300,
    STEPS = 3,
};

static void* lend( void* user, size_t size, size_t alignment )
{
    atomic_fetch_add( (_Atomic size_t*)user, size );
    return aligned_alloc( alignment, ( size + alignment - 1 ) / alignment * alignment );
}

static void take_back( void* user, void* block, size_t size )
{
    atomic_fetch_sub( (_Atomic size_t*)user, size );
    free( block );
}

static const wisp_memory_part* find_part( const wisp_memory_part* parts, int count, const char* name )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( strcmp( parts[i].name, name ) == 0 )
        {
            return parts + i;
        }
    }
    return NULL;
}

// @return number of parts
static int check_parts( const wisp_world* world, size_t lent, const char* scene, wisp_memory_part parts[MAX_PARTS] )
{
    const int count = wisp_world_memory_parts( world, parts, MAX_PARTS );
    assert_true( count > 0 && count <= MAX_PARTS );
    assert_int_equal( wisp_world_memory_parts( world, NULL, 0 ), count );
    size_t sum = 0;
    for ( int i = 0; i < count; ++i )
    {
        sum += parts[i].kind != WISP_MEMORY_OUTSIDE ? parts[i].capacity : 0;
        assert_true( parts[i].capacity > 0 && parts[i].bytes <= parts[i].capacity );
        assert_true( i == 0 || parts[i].kind >= parts[i - 1].kind );
    }
    if ( sum != lent || wisp_world_memory( world ) != lent || find_part( parts, count, "other" ) )
    {
        const wisp_memory_part* other = find_part( parts, count, "other" );
        fail_msg( "%s: parts have %zu bytes, %zu of them unnamed; the world says %zu, its host %zu", scene, sum,
                  other ? other->capacity : 0, wisp_world_memory( world ), lent );
    }
    return count;
}

static void run_scene( const char* file, int workers )
{
    static wisp_memory_part parts[MAX_PARTS];
    _Atomic size_t lent = 0;
    const wisp_allocator allocator = { lend, take_back, &lent };
    const scene_world_options options = { .workers = workers, .is_quiet = true, .allocator = &allocator };
    wisp_scene scene = read_good( file );
    scene_world world;
    wisp_error error = { 0 };
    assert_ok( scene_world_create( &scene, &options, &world, &error ), error );
    check_parts( world.world, atomic_load( &lent ), file, parts );
    for ( int step = 0; step < scene.steps && step < STEPS; ++step )
    {
        assert_ok( scene_world_step( &world, &error ), error );
        check_parts( world.world, atomic_load( &lent ), file, parts );
    }
    scene_world_destroy( &world );
    assert_int_equal( atomic_load( &lent ), 0 );
    wisp_scene_release( &scene );
}

TEST( parts_of_every_scene_add_up_to_what_the_host_lent )
{
    struct dirent** entries;
    const int count = scandir( WISP_SOURCE_ROOT "/data/scenes", &entries, NULL, alphasort );
    int scenes = 0;
    assert_true( count > 0 );
    for ( int i = 0; i < count; ++i )
    {
        const char* dot = strrchr( entries[i]->d_name, '.' );
        if ( dot && strcmp( dot, ".yaml" ) == 0 )
        {
            run_scene( entries[i]->d_name, 1 + i % 2 );
            ++scenes;
        }
        free( entries[i] );
    }
    free( entries );
    assert_true( scenes >= 20 );
}

// Multipliers of links have rows with several iterations only.
TEST( what_one_iteration_does_not_read_has_no_rows )
{
    wisp_memory_part parts[MAX_PARTS];
    for ( int iterations = 1; iterations <= 2; ++iterations )
    {
        char text[300];
        snprintf( text, sizeof text,
                  "wisp: 1\niterations: %d\nsurfaces:\n"
                  "  - { name: a, generate: { shape: plane, columns: 9, rows: 9 }, pins: [0], cloth: {} }\n",
                  iterations );
        wisp_scene scene = parsed( text );
        const scene_world_options options = { .workers = 1, .is_quiet = true };
        scene_world world;
        wisp_error error = { 0 };
        assert_ok( scene_world_create( &scene, &options, &world, &error ), error );
        assert_ok( scene_world_step( &world, &error ), error );
        const int count = wisp_world_memory_parts( world.world, parts, MAX_PARTS );
        const wisp_memory_part* compliance = find_part( parts, count, "link.compliance" );
        const wisp_memory_part* lambda = find_part( parts, count, "link.lambda" );
        assert_non_null( compliance );
        assert_int_equal( compliance->kind, WISP_MEMORY_COMPONENT );
        assert_int_equal( lambda != NULL, iterations > 1 );
        assert_true( lambda == NULL || lambda->bytes == compliance->bytes );
        const wisp_memory_part* fabrics = find_part( parts, count, "fabrics" );
        assert_non_null( fabrics );
        assert_int_equal( fabrics->kind, WISP_MEMORY_OUTSIDE );
        assert_int_equal( fabrics->bytes, wisp_fabric_bytes( world.surfaces[0].fabric ) );
        scene_world_destroy( &world );
        wisp_scene_release( &scene );
    }
}
