// An effect that is not requested costs nothing: the plan of every effect alone, of every pair and of all together
// has the passes of its parts and no other, and modules that are only registered change neither plan nor state nor
// memory.
#include "unit.h"

#include "effects/effect_world.h"
#include "world.h"

#define PLANS_FILE WISP_SOURCE_ROOT "/data/golden/effects.plan"

static const effect_size small = { .side = 6, .level = 1, .strands = 16 };

static effects known; // read once, before the tests

static int read_effects( void** state )
{
    (void)state;
    wisp_error error = { WISP_OK, "" };
    assert_ok( effects_read( &known, &error ), error );
    return 0;
}

static int release_effects( void** state )
{
    (void)state;
    effects_release( &known );
    return 0;
}

static effect_world* open_world( const int* chosen, int count, bool is_on, bool only_used, int steps )
{
    const effect_world_def def = {
        .all = &known, .chosen = chosen, .count = count, .is_on = is_on, .only_used = only_used, .size = small
    };
    effect_world* world;
    wisp_error error = { WISP_OK, "" };
    wisp_status status = effect_world_open( &def, &world, &error );
    for ( int i = 0; i < steps && status == WISP_OK; ++i )
    {
        status = effect_world_step( world, &error );
    }
    assert_ok( status, error );
    return world;
}

// The passes of a world, in plan order.
typedef struct pass_list
{
    const wisp_pass* passes[PLAN_MAX_PASSES];
    int count;
} pass_list;

static const wisp_pass* registered( const wisp_world* world, const char* name )
{
    for ( int i = 0; i < world->registry.pass_count; ++i )
    {
        if ( strcmp( world->registry.passes[i].name, name ) == 0 )
        {
            return world->registry.passes + i;
        }
    }
    return NULL;
}

static void read_plan( effect_world* world, char* text )
{
    wisp_error error = { WISP_OK, "" };
    assert_ok( effect_world_plan( world, text, NULL, &error ), error );
}

// @param world in which the passes are registered @param text the names, separated by blanks; is cut into them
static pass_list parse_plan( const wisp_world* world, char* text )
{
    pass_list list = { .count = 0 };
    for ( const char* name = strtok( text, " " ); name != NULL; name = strtok( NULL, " " ) )
    {
        const wisp_pass* pass = registered( world, name );
        assert_non_null( pass );
        list.passes[list.count++] = pass;
    }
    return list;
}

static int place_of( const pass_list* list, const wisp_pass* pass )
{
    for ( int i = 0; i < list->count; ++i )
    {
        if ( list->passes[i] == pass )
        {
            return i;
        }
    }
    return -1;
}

static bool conflict( const wisp_pass* a, const wisp_pass* b )
{
    const store_mask writes_a = store_mask_or( plan_mask( a->writes ), plan_mask( a->foreign ) ),
                     writes_b = store_mask_or( plan_mask( b->writes ), plan_mask( b->foreign ) );
    return store_mask_meets( writes_a, store_mask_or( writes_b, plan_mask( b->reads ) ) ) ||
           store_mask_meets( writes_b, plan_mask( a->reads ) );
}

// True if the plan has all passes of a part, with interacting ones in the order of the part.
static bool holds( const pass_list* all, const pass_list* part )
{
    bool good = true;
    for ( int i = 0; i < part->count; ++i )
    {
        const int place = place_of( all, part->passes[i] );
        good = good && place >= 0;
        for ( int before = 0; before < i; ++before )
        {
            good = good && ( !conflict( part->passes[before], part->passes[i] ) ||
                             place_of( all, part->passes[before] ) < place );
        }
    }
    return good;
}

// Contact needs stored contacts with bodies, which collision alone finds and projects in one sweep.
static bool is_stored_form( const pass_list* all, const wisp_pass* pass )
{
    bool has_contact = false;
    for ( int i = 0; i < all->count; ++i )
    {
        has_contact = has_contact || strcmp( all->passes[i]->name, "contact.find" ) == 0;
    }
    return has_contact &&
           ( strcmp( pass->name, "collision.find" ) == 0 || strcmp( pass->name, "collision.project" ) == 0 );
}

// The plan of some effects has the passes of each alone, and no other.
static void assert_sum_of_parts( const int* chosen, int count )
{
    effect_world* world = open_world( chosen, count, true, false, 0 );
    char text[EFFECT_PLAN_MAX], shown[EFFECT_PLAN_MAX];
    read_plan( world, text );
    memcpy( shown, text, sizeof( text ) );
    const pass_list all = parse_plan( world->world.world, text );
    bool owned[PLAN_MAX_PASSES] = { false };
    for ( int i = 0; i < count; ++i )
    {
        effect_world* alone = open_world( chosen + i, 1, true, false, 0 );
        read_plan( alone, text );
        const pass_list part = parse_plan( world->world.world, text );
        if ( !holds( &all, &part ) )
        {
            fail_msg( "%s alone has other passes than in '%s'", effects_name( &known, chosen[i] ), shown );
        }
        for ( int k = 0; k < all.count; ++k )
        {
            owned[k] = owned[k] || place_of( &part, all.passes[k] ) >= 0;
        }
        effect_world_close( alone );
    }
    for ( int k = 0; k < all.count; ++k )
    {
        if ( !owned[k] && !is_stored_form( &all, all.passes[k] ) )
        {
            fail_msg( "nobody asked for %s in '%s'", all.passes[k]->name, shown );
        }
    }
    effect_world_close( world );
}

// ---- plans ----

TEST( an_empty_scene_has_no_pass )
{
    char text[EFFECT_PLAN_MAX];
    effect_world* world = open_world( NULL, 0, true, false, 0 );
    read_plan( world, text );
    assert_string_equal( text, "" );
    effect_world_close( world );
}

// In the form of a line of the file.
static void plan_line( int which, char* line, size_t size )
{
    char text[EFFECT_PLAN_MAX];
    effect_world* world = open_world( &which, 1, true, false, 0 );
    read_plan( world, text );
    snprintf( line, size, "%s: %s\n", effects_name( &known, which ), text );
    effect_world_close( world );
}

static void write_plans( void )
{
    FILE* file = fopen( PLANS_FILE, "w" );
    assert_non_null( file );
    for ( int i = 0; i < known.count; ++i )
    {
        char line[EFFECT_PLAN_MAX + 80];
        plan_line( i, line, sizeof( line ) );
        fputs( line, file );
    }
    assert_int_equal( fclose( file ), 0 );
}

// WISP_GOLDEN=write in the environment rewrites the file first.
TEST( each_effect_alone_has_the_passes_that_are_written_down_and_no_other )
{
    const char* mode = getenv( "WISP_GOLDEN" );
    if ( mode != NULL && strcmp( mode, "write" ) == 0 )
    {
        write_plans();
    }
    int lines = 0;
    FILE* file = fopen( PLANS_FILE, "r" );
    assert_non_null( file );
    static char line[EFFECT_PLAN_MAX + 80], expected[EFFECT_PLAN_MAX + 80];
    for ( ; fgets( line, sizeof( line ), file ) != NULL; ++lines )
    {
        assert_true( lines < known.count );
        plan_line( lines, expected, sizeof( expected ) );
        assert_string_equal( expected, line );
    }
    fclose( file );
    assert_int_equal( lines, known.count );
}

TEST( the_plan_of_every_pair_is_that_of_its_parts_together )
{
    for ( int i = 0; i < known.count; ++i )
    {
        for ( int k = i + 1; k < known.count; ++k )
        {
            assert_sum_of_parts( ( const int[] ){ i, k }, 2 );
        }
    }
}

TEST( the_plan_of_all_effects_is_that_of_all_parts )
{
    int chosen[EFFECT_SCENES_MAX];
    for ( int i = 0; i < known.count; ++i )
    {
        chosen[i] = i;
    }
    assert_sum_of_parts( chosen, known.count );
}

// ---- modules that are only registered ----

TEST( an_empty_world_grows_by_its_registry_alone )
{
    effect_world *every = open_world( NULL, 0, true, false, 3 ), *none = open_world( NULL, 0, true, true, 3 );
    assert_int_equal( none->world.module_count, 0 );
    assert_int_equal( effect_world_bytes( every ), 0 );
    assert_int_equal( effect_world_bytes( none ), 0 );
    effect_world_close( every );
    effect_world_close( none );
}

// ---- scenes ----

// A scene in which its effect does nothing would prove nothing.
TEST( every_effect_that_moves_something_moves_it )
{
    static const char* const STILL[] = { "boundary", "environment",
                                         "strand_appearance" }; // their outputs are not points
    for ( int i = 0; i < known.count; ++i )
    {
        effect_world *on = open_world( &i, 1, true, false, 5 ), *off = open_world( &i, 1, false, false, 5 );
        uint64_t hash[2];
        wisp_error error = { WISP_OK, "" };
        assert_int_equal( effect_world_hash( on, 0, hash, &error ), WISP_OK );
        assert_int_equal( effect_world_hash( off, 0, hash + 1, &error ), WISP_OK );
        bool is_still = false;
        for ( int k = 0; k < WISP_COUNT( STILL ); ++k )
        {
            is_still = is_still || strcmp( STILL[k], effects_name( &known, i ) ) == 0;
        }
        if ( ( hash[0] == hash[1] ) != is_still )
        {
            fail_msg( "the scene of %s is not what it should be", effects_name( &known, i ) );
        }
        effect_world_close( on );
        effect_world_close( off );
    }
}

// On or off, and whether modules that do not act are registered: plan, points and memory beyond the registry are the same.
TEST( unused_modules_change_neither_plan_nor_bits_nor_memory )
{
    for ( int i = 0; i < 2 * known.count; ++i )
    {
        const int which = i / 2;
        effect_world *every = open_world( &which, 1, i % 2 == 0, false, 5 ),
                     *used = open_world( &which, 1, i % 2 == 0, true, 5 );
        char text[2][EFFECT_PLAN_MAX];
        uint64_t hash[2];
        wisp_error error = { WISP_OK, "" };
        read_plan( every, text[0] );
        read_plan( used, text[1] );
        assert_string_equal( text[0], text[1] );
        assert_ok( effect_world_hash( every, 0, hash, &error ), error );
        assert_ok( effect_world_hash( used, 0, hash + 1, &error ), error );
        assert_true( hash[0] == hash[1] );
        assert_int_equal( effect_world_bytes( every ), effect_world_bytes( used ) );
        effect_world_close( every );
        effect_world_close( used );
    }
}

TEST_GROUP( read_effects, release_effects )
