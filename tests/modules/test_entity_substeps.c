// Entities with substeps of their own in one world: each moves as it would alone in a world with its substeps.
#include "effects_fixture.h"

#include "wisp/explain.h"

typedef struct member
{
    const char* name;
    effect_setup* add;
    int substeps; // asked for
} member;

static const member MEMBERS[] = {
    { "cloth of links", cloth_of_links, 0 },
    { "dihedral cloth", dihedral_cloth, 4 },
    { "isometric cloth", isometric_cloth, 6 },
    { "implicit cloth", implicit_cloth, 1 },
    { "balloon", balloon, 7 },
    { "hair of links", hair_of_links, 9 },
    { "hair of rods", hair_of_rods, 50 },
};

enum
{
    MEMBER_COUNT = WISP_COUNT( MEMBERS ),
    STEPS = 40,
};

// Substeps of a world, and its steps.
typedef struct pace
{
    int substeps;
    float dt; // s
} pace;

static const pace PACES[] = { { 2, 1.0f / 60.0f }, { 3, 1.0f / 25.0f }, { 10, 1.0f / 60.0f }, { 7, 1.0f / 30.0f } };

static void open_all( hosted* h, int substeps, int workers )
{
    *h = ( hosted ){ 0 };
    h->def = hosted_def( h );
    h->def.modules = EFFECTS;
    h->def.module_count = WISP_COUNT( EFFECTS );
    h->def.substeps = substeps;
    h->def.workers = workers;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
}

static bool is_surface( wisp_world* world, wisp_entity e )
{
    return wisp_world_has( world, e, WISP_PARTICLE_POSITION );
}

static wisp_entity add( wisp_world* world, const member* m )
{
    const wisp_entity e = m->add( world );
    assert_status( world, wisp_request( world, e, is_surface( world, e ) ? WISP_SURFACE_POINTS : WISP_STRAND_POINTS ),
                   WISP_OK );
    return e;
}

static uint64_t points_hash( wisp_world* world, wisp_entity e )
{
    uint64_t hash = 0;
    assert_status(
        world,
        wisp_world_hash_column( world, e, is_surface( world, e ) ? WISP_SURFACE_POINTS : WISP_STRAND_POINTS, &hash ),
        WISP_OK );
    return hash;
}

static void take_steps( wisp_world* world, int count, float dt )
{
    for ( int i = 0; i < count; ++i )
    {
        assert_status( world, wisp_world_step( world, dt ), WISP_OK );
    }
}

// Alone in a world with its substeps.
static uint64_t run_alone( const member* m, const pace* p )
{
    hosted h;
    const int split = m->substeps > p->substeps ? ( m->substeps - 1 ) / p->substeps + 1 : 1;
    open_all( &h, p->substeps * split, 1 );
    const wisp_entity e = add( h.world, m );
    take_steps( h.world, STEPS, p->dt );
    const uint64_t hash = points_hash( h.world, e );
    wisp_world_destroy( h.world );
    assert_host_memory_is_released( &h.host );
    return hash;
}

// Members [first, first + count) in one world.
static void check_together( int first, int count, int workers, const pace* p )
{
    hosted h;
    wisp_entity entities[MEMBER_COUNT];
    open_all( &h, p->substeps, workers );
    for ( int i = 0; i < count; ++i )
    {
        entities[i] = add( h.world, MEMBERS + first + i );
        assert_status( h.world, wisp_set_substeps( h.world, entities[i], MEMBERS[first + i].substeps ), WISP_OK );
    }
    take_steps( h.world, STEPS, p->dt );
    for ( int i = 0; i < count; ++i )
    {
        if ( points_hash( h.world, entities[i] ) != run_alone( MEMBERS + first + i, p ) )
        {
            fail_msg( "%s: not as alone, among %d with %d workers and %d substeps of the world",
                      MEMBERS[first + i].name, count, workers, p->substeps );
        }
    }
    wisp_world_destroy( h.world );
    assert_host_memory_is_released( &h.host );
}

// Many small surfaces have loops of their own; a single one runs in waves.
TEST( each_moves_as_alone )
{
    for ( int i = 0; i < WISP_COUNT( PACES ); ++i )
    {
        check_together( 0, MEMBER_COUNT, 1 + 4 * ( i % 2 ), PACES + i );
    }
    check_together( 1, 2, 5, PACES );
    check_together( 3, 3, 2, PACES + 1 );
}

static int runs_of( wisp_world* world, const char* pass, int* fewest )
{
    wisp_plan_info* info = NULL;
    assert_status( world, wisp_world_explain( world, &info ), WISP_OK );
    int runs = -1;
    for ( int i = 0; i < info->pass_count; ++i )
    {
        if ( strcmp( info->passes[i].name, pass ) == 0 )
        {
            runs = info->passes[i].runs;
            *fewest = info->passes[i].fewest_runs;
        }
    }
    wisp_plan_info_release( info );
    return runs;
}

TEST( the_plan_shows_the_substeps_of_both )
{
    hosted h;
    int fewest = 0;
    open_all( &h, 1, 1 );
    add( h.world, MEMBERS );
    const wisp_entity strands = add( h.world, MEMBERS + MEMBER_COUNT - 1 );
    assert_status( h.world, wisp_set_substeps( h.world, strands, 10 ), WISP_OK );
    assert_int_equal( runs_of( h.world, "particles.predict", &fewest ), 1 );
    assert_int_equal( runs_of( h.world, "strands.predict", &fewest ), 10 );
    const wisp_entity other = add( h.world, MEMBERS );
    assert_status( h.world, wisp_set_substeps( h.world, other, 3 ), WISP_OK );
    assert_int_equal( runs_of( h.world, "particles.predict", &fewest ), 3 );
    assert_int_equal( fewest, 1 );
    int substeps;
    assert_status( h.world, wisp_read_substeps( h.world, other, &substeps ), WISP_OK );
    assert_int_equal( substeps, 3 );
    assert_status( h.world, wisp_read_substeps( h.world, ( wisp_entity ){ 99, 1 }, &substeps ), WISP_STALE_ID );
    assert_int_equal( substeps, 0 );
    close_world( &h );
}

static int substeps_of( wisp_world* world, wisp_entity e )
{
    int substeps = 0;
    assert_status( world, wisp_read_substeps( world, e, &substeps ), WISP_OK );
    return substeps;
}

// Hair with contact leaves its own loop, and no one else.
TEST( hair_in_contact_leaves_the_others_alone )
{
    hosted h;
    open_all( &h, 2, 1 );
    const wisp_entity touching = add( h.world, MEMBERS + MEMBER_COUNT - 1 ), cloth = add( h.world, MEMBERS ),
                      other = add( h.world, MEMBERS + MEMBER_COUNT - 1 );
    const wisp_contact_def contact = wisp_default_contact_def();
    assert_status( h.world, wisp_set_contact( h.world, touching, &contact ), WISP_OK );
    assert_status( h.world, wisp_set_substeps( h.world, other, 16 ), WISP_OK );
    assert_int_equal( substeps_of( h.world, touching ), 2 );
    assert_int_equal( substeps_of( h.world, cloth ), 2 );
    assert_int_equal( substeps_of( h.world, other ), 16 );
    take_steps( h.world, 4, 1.0f / 60.0f );
    close_world( &h );
}

TEST( surfaces_in_contact_share_the_largest_number )
{
    hosted h;
    int fewest = 0;
    open_all( &h, 2, 1 );
    for ( int i = 0; i < 2; ++i )
    {
        const wisp_entity e = add( h.world, MEMBERS );
        const wisp_contact_def contact = wisp_default_contact_def();
        assert_status( h.world, wisp_set_contact( h.world, e, &contact ), WISP_OK );
        assert_status( h.world, wisp_set_substeps( h.world, e, i == 0 ? 6 : 0 ), WISP_OK );
    }
    assert_int_equal( runs_of( h.world, "contact.find", &fewest ), 6 );
    assert_int_equal( runs_of( h.world, "particles.predict", &fewest ), 6 );
    assert_int_equal( fewest, 6 );
    take_steps( h.world, 4, 1.0f / 60.0f );
    close_world( &h );
}

TEST( steps_of_any_length_keep_their_bits_with_any_workers )
{
    uint64_t hashes[2];
    for ( int k = 0; k < 2; ++k )
    {
        hosted h;
        open_all( &h, 1, k == 0 ? 1 : 5 );
        for ( int i = 0; i < MEMBER_COUNT; ++i )
        {
            const wisp_entity e = add( h.world, MEMBERS + i );
            assert_status( h.world, wisp_set_substeps( h.world, e, MEMBERS[i].substeps + 4 ), WISP_OK );
        }
        for ( int i = 0; i < 120; ++i )
        {
            const float dt = test_random_float( i, 5, 0.002f, 0.04f );
            assert_status( h.world, wisp_world_step( h.world, dt ), WISP_OK );
        }
        assert_int_equal( wisp_world_counter( h.world, WISP_COUNT_HALTED ), 0 );
        hashes[k] = wisp_world_hash( h.world );
        wisp_world_destroy( h.world );
        assert_host_memory_is_released( &h.host );
    }
    assert_true( hashes[0] == hashes[1] );
}
