// Every scene of data/scenes, the smallest scene of every module and scenes of effects together: no step halts, neither workers nor the instruction set nor a
// snapshot in the middle change a bit of the world, and steps that are repeated ask for no memory.
#include "scene_world_fixture.h"
#include "support.h"
#include "world.h"

#include <glob.h>

// What a host saves of a scene in the middle.
typedef struct saved_scene
{
    char* bytes;
    size_t pins, world;
    int step, command, event;
} saved_scene;

static saved_scene save( scene_world* w )
{
    saved_scene s = { .pins = scene_pins_state_size( w ), .world = wisp_world_snapshot_size( w->world ) };
    s.step = w->next_step, s.command = w->next_command, s.event = w->next_event;
    s.bytes = checked_calloc( s.pins + s.world, 1 );
    scene_pins_save( w, s.bytes );
    assert_int_equal( wisp_world_snapshot( w->world, s.bytes + s.pins, s.world ), WISP_OK );
    return s;
}

// A mesh that has torn since has other columns. @return false if nothing was restored
static bool load( scene_world* w, const saved_scene* s )
{
    if ( wisp_world_snapshot_size( w->world ) != s->world )
    {
        return false;
    }
    scene_pins_load( w, s->bytes );
    if ( wisp_world_restore( w->world, s->bytes + s->pins, s->world ) != WISP_OK )
    {
        fail_msg( "%s", wisp_world_message( w->world ) );
    }
    w->next_step = s->step, w->next_command = s->command, w->next_event = s->event;
    return true;
}

static void assert_hash( const fixture* f, const char* path, const char* what, uint64_t expected )
{
    if ( wisp_world_hash( f->world.world ) != expected ||
         wisp_world_counter( f->world.world, WISP_COUNT_HALTED ) > 0 )
    {
        fail_msg( "%s: another hash %s, or halted", path, what );
    }
}

// @return whether its snapshot was restored, in three worlds
static bool check_scene( const char* path, int steps )
{
    const int middle_step = steps * 2 / 5, rest = steps - middle_step;
    test_host host = { 0 };
    const wisp_allocator counted = test_host_allocator( &host );
    const scene_world_options others[] = { { .workers = 2, .is_quiet = true, .allocator = &counted },
                                           { .workers = 5, .isa = "avx2", .is_quiet = true, .allocator = &counted } };
    const scene_world_options one = { .workers = 1, .isa = "baseline", .is_quiet = true };
    SCOPED( release ) fixture f = { 0 };
    assert_ok( wisp_scene_read( path, &f.scene, &f.error ), f.error );
    assert_ok( scene_world_create( &f.scene, &one, &f.world, &f.error ), f.error );
    step( &f, middle_step );
    saved_scene middle = save( &f.world );
    step( &f, rest );
    const uint64_t expected = wisp_world_hash( f.world.world );
    const bool is_restored = load( &f.world, &middle );
    step( &f, is_restored ? rest : 0 );
    assert_hash( &f, path, "behind a snapshot", expected );
    for ( int i = 0; i < WISP_COUNT( others ); ++i )
    {
        fixture g = { .scene = f.scene };
        assert_ok( scene_world_create( &f.scene, others + i, &g.world, &g.error ), g.error );
        step( &g, steps );
        assert_hash( &g, path, i == 0 ? "with 2 workers" : "with 5 workers and AVX2", expected );
        assert_true( load( &g.world, &middle ) == is_restored );
        const int64_t queried = atomic_load( &host.queried );
        step( &g, is_restored ? rest : 0 );
        assert_hash( &g, path, "behind a snapshot of another world", expected );
        if ( atomic_load( &host.queried ) != queried )
        {
            fail_msg( "%s: repeated steps ask for memory %d times", path,
                      (int)( atomic_load( &host.queried ) - queried ) );
        }
        scene_world_destroy( &g.world );
        assert_host_memory_is_released( &host );
    }
    free( middle.bytes );
    return is_restored;
}

static void check_folder( const char* pattern, size_t least, int steps )
{
    SCOPED( globfree ) glob_t found;
    size_t restored = 0;
    assert_int_equal( glob( pattern, 0, NULL, &found ), 0 );
    assert_true( found.gl_pathc >= least );
    for ( size_t i = 0; i < found.gl_pathc; ++i )
    {
        restored += check_scene( found.gl_pathv[i], steps ) ? 1 : 0;
    }
    assert_true( restored + 1 >= found.gl_pathc );
}

TEST( scenes_of_the_project_have_the_same_bits_with_any_workers_and_behind_a_snapshot )
{
    check_folder( WISP_SOURCE_ROOT "/data/scenes/*.yaml", 40, 10 );
}

TEST( each_module_alone_has_the_same_bits_with_any_workers_and_behind_a_snapshot )
{
    check_folder( WISP_SOURCE_ROOT "/data/suites/scenes/effects/*.yaml", 16, 10 );
}

TEST( effects_together_have_the_same_bits_with_any_workers_and_behind_a_snapshot )
{
    check_folder( WISP_SOURCE_ROOT "/data/suites/scenes/bits/*.yaml", 14, 30 );
}

// ---- untrusted snapshots ----

// An integer that is used as an index, a count or an enumerator, in a scene that has it.
typedef struct index_column
{
    const char *scene, *component;
    int column, word; // of the first row
    int32_t bad;
} index_column;

// Write it into every entity that has the component. @return how many have
static int write_word( wisp_world* world, const index_column* t, int32_t value, int32_t* was )
{
    const store* s = &world->store;
    int count = 0;
    for ( int c = 1; c < s->component_count; ++c )
    {
        for ( int i = 0; i < s->entity_count && strcmp( s->components[c].def.name, t->component ) == 0; ++i )
        {
            const store_entity* e = s->entities + i;
            int32_t* rows = e->alive ? store_column( s, e, (wisp_component)c, t->column ) : NULL;
            if ( rows != NULL && e->rows[s->components[c].def.table].count > 0 && count == 0 )
            {
                *was = rows[t->word];
                rows[t->word] = value;
                count += 1;
            }
        }
    }
    return count;
}

static void check_index( const index_column* t )
{
    SCOPED( release ) fixture f = { 0 };
    char path[512];
    snprintf( path, sizeof path, "%s/data/%s.yaml", WISP_SOURCE_ROOT, t->scene );
    assert_ok( wisp_scene_read( path, &f.scene, &f.error ), f.error );
    create( &f, 1 );
    step( &f, 2 );
    wisp_world* world = f.world.world;
    const size_t size = wisp_world_snapshot_size( world );
    char *good = checked_malloc( size ), *block = checked_malloc( size + 1 ), *bad = block + 1; // aligned to nothing
    int32_t was, ignored;
    assert_int_equal( wisp_world_snapshot( world, good, size ), WISP_OK );
    if ( write_word( world, t, t->bad, &was ) == 0 )
    {
        fail_msg( "%s has no %s", t->scene, t->component );
    }
    assert_int_equal( wisp_world_snapshot( world, bad, size ), WISP_OK );
    write_word( world, t, was, &ignored );
    const uint64_t hash = wisp_world_hash( world );
    if ( wisp_world_restore( world, bad, size ) != WISP_BAD_INPUT ||
         strstr( wisp_world_message( world ), t->component ) == NULL ||
         strstr( wisp_world_message( world ), "row 0" ) == NULL )
    {
        fail_msg( "%s: %s, column %d, word %d: %d was restored, or refused with: %s", t->scene, t->component,
                  t->column, t->word, t->bad, wisp_world_message( world ) );
    }
    assert_true( wisp_world_hash( world ) == hash );
    assert_int_equal( wisp_world_restore( world, good, size ), WISP_OK );
    free( good );
    free( block );
}

TEST( a_snapshot_with_an_index_out_of_its_range_is_refused_and_changes_nothing )
{
    static const index_column COLUMNS[] = {
#define EFFECT "suites/scenes/effects/"
        { EFFECT "attachments", "attachments.place", 0, 0, 77 },
        { EFFECT "attachments", "attachments.place", 0, 2, 1 << 28 },
        { EFFECT "attachments", "attachments.place", 0, 2, -2 },
        { "scenes/character", "strands.surface", 0, 0, 1000 },
        { "scenes/character", "strands.anchor", 0, 15, 1 << 28 },
        { "scenes/character", "strands.anchor", 0, 0, -4 },
        { EFFECT "seams", "seams.pairs", 2, 0, 2 },
        { EFFECT "tearing", "tearing.result", 0, 0, 1 << 28 },
        { EFFECT "tearing", "tearing.settings", 0, 0, INT32_MAX },
        { "scenes/cloth_on_ball", "particle.half_spaces", 0, 0, -1 },
        { "scenes/hanging_cloth", "surface.levels", 0, 0, INT32_MAX },
        { "scenes/hanging_cloth", "surface.levels", 1, 0, 65 },
        { "scenes/hanging_cloth", "surface.levels", 2, 0, 3 },
        { "scenes/hanging_cloth", "surface.levels", 3, 0, -1 },
        { "scenes/pear_jet", "balloon.outlet", 0, 21, 1 << 20 },
        { "scenes/pear_jet", "balloon.outlet", 0, 22, 1 << 28 },
        { EFFECT "boundary", "boundary.settings", 0, 1, 99 },
        { EFFECT "implicit_cloth", "implicit_cloth.material", 0, 3, -1 },
        { EFFECT "motion_constraints", "motion_constraints.settings", 0, 4, 3 },
        { EFFECT "frozen_hair", "frozen_hair.settings", 0, 2, 9 },
        { EFFECT "environment", "environment.settings", 0, 5, 1 << 20 },
        { EFFECT "contact", "contact.settings", 0, 5, -1 },
        { EFFECT "strands", "strands.settings", 0, 7, 3 },
        { "scenes/detail", "detail.state", 0, 0, 9 },
    };
    for ( int i = 0; i < WISP_COUNT( COLUMNS ); ++i )
    {
        check_index( COLUMNS + i );
    }
}
