// All effects: entities with substeps of their own in one world move as each would alone in a world with its substeps; an
// entity that is teleported continues as if it had always been there; and the default parameters of the published methods,
// as their papers give them or as docs/methods.md states them. Results and figures are compared under these, so a default
// that drifts would move all of them without a test that fails.
#include "effects_fixture.h"

#include "attachments.h"
#include "balloon.h"
#include "boundary.h"
#include "environment.h"
#include "frozen_hair.h"
#include "guide_hair.h"
#include "implicit_cloth.h"
#include "membrane.h"
#include "motion_constraints.h"
#include "seams.h"
#include "strand_appearance.h"
#include "tearing.h"

#include "wisp/explain.h"
#include "wisp/maps.h"
#include "wisp/moving_frame.h"

// ---- substeps ----

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
    OPEN( h, EFFECTS, .substeps = substeps, .workers = workers );
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
    SCOPED( close_world ) hosted h;
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
    SCOPED( close_world ) hosted h;
    open_all( &h, 2, 1 );
    const wisp_entity touching = add( h.world, MEMBERS + MEMBER_COUNT - 1 ), cloth = add( h.world, MEMBERS ),
                      other = add( h.world, MEMBERS + MEMBER_COUNT - 1 );
    SET_DEFAULT( h.world, touching, contact );
    assert_status( h.world, wisp_set_substeps( h.world, other, 16 ), WISP_OK );
    assert_int_equal( substeps_of( h.world, touching ), 2 );
    assert_int_equal( substeps_of( h.world, cloth ), 2 );
    assert_int_equal( substeps_of( h.world, other ), 16 );
    take_steps( h.world, 4, 1.0f / 60.0f );
}

TEST( surfaces_in_contact_share_the_largest_number )
{
    SCOPED( close_world ) hosted h;
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
}

// ---- steps that fail ----

// All members, changing their detail in the step to come, after some steps.
static void open_changing( hosted* h, int steps )
{
    open_all( h, 2, 1 );
    for ( int i = 0; i < MEMBER_COUNT; ++i )
    {
        const wisp_entity e = add( h->world, MEMBERS + i );
        assert_status( h->world, wisp_set_substeps( h->world, e, MEMBERS[i].substeps ), WISP_OK );
        wisp_detail_def detail = wisp_default_detail_def();
        assert_status( h->world, wisp_set_detail( h->world, e, &detail ), WISP_OK );
        take_steps( h->world, i + 1 == MEMBER_COUNT ? steps : 0, 1.0f / 60.0f );
    }
    for ( int slot = 0; slot < h->world->store.entity_count; ++slot )
    {
        const wisp_entity e = store_handle( &h->world->store, slot );
        SET( h->world, e, detail, d.level = slot % 2 == 0 ? WISP_DETAIL_NOTHING : WISP_DETAIL_FEWER_SUBSTEPS,
             d.blend_steps = 0 );
        assert_status( h->world, wisp_request( h->world, e, WISP_MOTION_STATS ), WISP_OK );
    }
}

// Each request for memory of a step is refused in turn. A step that is not counted has changed nothing, and is made by the next call.
TEST( a_step_that_fails_before_its_passes_changes_nothing )
{
    for ( int steps = 0; steps < 4; steps += 3 )
    {
        hosted h;
        open_changing( &h, steps );
        take_steps( h.world, 1, 1.0f / 60.0f );
        const uint64_t made = wisp_world_hash( h.world );
        close_world( &h );
        bool was_refused = true;
        int unchanged = 0;
        for ( int n = 1; was_refused; ++n )
        {
            open_changing( &h, steps );
            const uint64_t hash = wisp_world_hash( h.world ),
                           counted = wisp_world_counter( h.world, WISP_COUNT_STEPS );
            test_host_refuse( &h.host, n, true );
            const wisp_status status = wisp_world_step( h.world, 1.0f / 60.0f );
            was_refused = test_host_has_refused( &h.host );
            test_host_refuse( &h.host, 0, false );
            assert_true( status == WISP_NO_MEMORY || ( status == WISP_OK && wisp_world_hash( h.world ) == made ) );
            if ( status != WISP_OK && wisp_world_counter( h.world, WISP_COUNT_STEPS ) == counted )
            {
                unchanged += 1;
                assert_true( wisp_world_hash( h.world ) == hash );
                take_steps( h.world, 1, 1.0f / 60.0f );
                assert_true( wisp_world_hash( h.world ) == made );
            }
            close_world( &h );
        }
        assert_true( unchanged > 0 );
    }
}

// ---- calls that fail ----

static const wisp_module* const ALL[] = { &wisp_cloth_module,
                                          &wisp_implicit_cloth_module,
                                          &wisp_balloon_module,
                                          &wisp_strands_module,
                                          &wisp_collision_module,
                                          &wisp_contact_module,
                                          &wisp_attachments_module,
                                          &wisp_boundary_module,
                                          &wisp_environment_module,
                                          &wisp_frozen_hair_module,
                                          &wisp_guide_hair_module,
                                          &wisp_membrane_module,
                                          &wisp_motion_constraints_module,
                                          &wisp_seams_module,
                                          &wisp_strand_appearance_module,
                                          &wisp_tearing_module };

// Worlds have one of each, and strands that do nothing.
typedef struct cast
{
    wisp_world* world;
    wisp_entity cloth, other, ball, hair, ghosts, plain, out;
} cast;

static const float FACTORS[21 * 21] = { 1.0f, 2.0f };

static wisp_status explain( wisp_world* world )
{
    wisp_plan_info* info = NULL;
    const wisp_status status = wisp_world_explain( world, &info );
    wisp_plan_info_release( info );
    return status;
}

// DEF( name, definition d, its changes, call ) PLAIN( name, call )
#define CALLS( DEF, PLAIN )                                                                                          \
    DEF( contact, contact, (void)0, wisp_set_contact( w, c->cloth, &d ) )                                            \
    DEF( collision, collision, d.features = WISP_COLLISION_ALL, wisp_set_collision( w, c->cloth, &d ) )              \
    DEF( tearing, tearing, (void)0, wisp_set_tearing( w, c->cloth, &d ) )                                            \
    DEF( tether, motion_constraints, d.max_distance = 0.1f, wisp_set_motion_constraints( w, c->cloth, &d ) )         \
    DEF( frame, moving_frame, d.linear_inertia = 0.5f, wisp_set_moving_frame( w, c->ball, &d ) )                     \
    DEF( sleep, sleep, (void)0, wisp_set_sleep( w, c->cloth, &d ) )                                                  \
    DEF( detail, detail, (void)0, wisp_set_detail( w, c->ghosts, &d ) )                                              \
    DEF( ghosts, ghosts, d.targets = c->hair, wisp_set_ghosts( w, c->plain, &d ) )                                   \
    DEF( dynamics, strand_dynamics, (void)0, wisp_set_strand_dynamics( w, c->plain, &d ) )                           \
    DEF( links, strand_dynamics, d.bending = WISP_STRAND_BEND_LINKS, wisp_set_strand_dynamics( w, c->hair, &d ) )    \
    DEF( grid, strand_grid, (void)0, wisp_set_strand_grid( w, c->hair, &d ) )                                        \
    DEF( appearance, strand_appearance, (void)0, wisp_set_strand_appearance( w, c->hair, &d ) )                      \
    DEF( environment, environment, (void)0, wisp_set_environment( w, c->hair, &d ) )                                 \
    DEF( frozen_hair, frozen_hair, (void)0, wisp_set_frozen_hair( w, c->plain, &d ) )                                \
    DEF( boundary, boundary, (void)0, wisp_set_boundary( w, c->ball, &d ) )                                          \
    DEF( bdf2, implicit_cloth, d.integrator = WISP_INTEGRATOR_BDF2, wisp_set_implicit_cloth( w, c->other, &d ) )     \
    DEF( collider, collider, (void)0, wisp_add_collider( w, &d, &c->out ) )                                          \
    DEF( seam, seam, ( d.a = c->cloth, d.b = c->other, d.within = 0.1f ), wisp_add_seam( w, &d, &c->out ) )          \
    PLAIN( instance, wisp_add_instance( w, c->cloth, NULL, &c->out ) )                                               \
    PLAIN( more_ghosts, wisp_add_instance( w, c->ghosts, NULL, &c->out ) )                                           \
    PLAIN( attachment, wisp_attach_pins( w, c->cloth, ( const int32_t[] ){ 0, 20 }, 2, c->ball ) )                   \
    PLAIN( pin, wisp_pin( w, c->cloth, ( const int32_t[] ){ 5, 7 }, 2 ) )                                            \
    PLAIN( map, wisp_set_map( w, c->cloth, WISP_MAP_BEND_RIGIDITY, FACTORS, 21 * 21 ) )                              \
    PLAIN( roots, wisp_root_strands( w, c->hair, c->ball ) )                                                         \
    PLAIN( tip, wisp_hold_strand_tip( w, c->hair, 1, WISP_STRAND_TIP_CLAMPED ) )                                     \
    PLAIN( speed, wisp_set_max_speed( w, c->hair, 3.0f ) )                                                           \
    PLAIN( strain, wisp_set_strain_limit( w, c->cloth, 0.9f, 1.1f ) )                                                \
    PLAIN( request, wisp_request( w, c->cloth, WISP_SURFACE_NORMALS ) )                                              \
    PLAIN( explanation, explain( w ) )

#define CALL_PLAIN( name, call )                                                                                     \
    static wisp_status call_##name( cast* c )                                                                        \
    {                                                                                                                \
        wisp_world* w = c->world;                                                                                    \
        return call;                                                                                                 \
    }
#define CALL_DEF( name, definition, changes, call )                                                                  \
    static wisp_status call_##name( cast* c )                                                                        \
    {                                                                                                                \
        wisp_world* w = c->world;                                                                                    \
        wisp_##definition##_def d = wisp_default_##definition##_def();                                               \
        changes;                                                                                                     \
        return call;                                                                                                 \
    }
CALLS( CALL_DEF, CALL_PLAIN )

#define ROW_PLAIN( name, call ) { #name, call_##name },
#define ROW_DEF( name, definition, changes, call ) { #name, call_##name },
static const struct
{
    const char* name;
    wisp_status ( *call )( cast* c );
} CALL_ROWS[] = { CALLS( ROW_DEF, ROW_PLAIN ) };

static cast open_cast( hosted* h )
{
    OPEN( h, ALL, .substeps = 1 );
    cast c = { .world = h->world };
    c.cloth = add( h->world, &( member ){ .add = dihedral_cloth } );
    c.other = add( h->world, &( member ){ .add = implicit_cloth } );
    c.ball = add( h->world, &( member ){ .add = balloon } );
    c.hair = add( h->world, &( member ){ .add = hair_of_rods } );
    wisp_ghosts_def ghosts = wisp_default_ghosts_def();
    ghosts.targets = c.hair;
    wisp_entity* strands[] = { &c.ghosts, &c.plain };
    for ( int i = 0; i < 2; ++i )
    {
        wisp_vec3 points[24];
        const int32_t offsets[3] = { 0, 12, 24 };
        for ( int v = 0; v < 24; ++v )
        {
            points[v] = ( wisp_vec3 ){ 0.01f * (float)( v % 12 ), 0.001f, 0.01f * (float)( v / 12 ) };
        }
        wisp_strands_def def = wisp_default_strands_def();
        def.points = points, def.offsets = offsets, def.strand_count = 2;
        assert_status( h->world, wisp_add_strands( h->world, &def, strands[i] ), WISP_OK );
    }
    assert_status( h->world, wisp_set_ghosts( h->world, c.ghosts, &ghosts ), WISP_OK );
    assert_status( h->world, wisp_request( h->world, c.ghosts, WISP_STRAND_POINTS ), WISP_OK );
    take_steps( h->world, 2, 1.0f / 60.0f );
    return c;
}

// Each call in turn, with all requests for memory refused from one of them on. Afterwards it works.
TEST( a_call_that_fails_changes_nothing )
{
    for ( int k = 0; k < WISP_COUNT( CALL_ROWS ); ++k )
    {
        bool was_refused = true;
        for ( int n = 1; was_refused; ++n )
        {
            SCOPED( close_world ) hosted h;
            cast c = open_cast( &h );
            const uint64_t hash = wisp_world_hash( h.world );
            test_host_refuse( &h.host, n, true );
            const wisp_status status = CALL_ROWS[k].call( &c );
            was_refused = test_host_has_refused( &h.host );
            test_host_refuse( &h.host, 0, false );
            if ( status != ( was_refused ? WISP_NO_MEMORY : WISP_OK ) ||
                 ( status != WISP_OK &&
                   ( wisp_world_hash( h.world ) != hash || CALL_ROWS[k].call( &c ) != WISP_OK ) ) )
            {
                fail_msg( "%s, request %d: '%s'", CALL_ROWS[k].name, n, wisp_world_message( h.world ) );
            }
            take_steps( h.world, 1, 1.0f / 60.0f );
        }
    }
}

// ---- teleports ----

enum
{
    BEFORE = 30, // steps
    AFTER = 10,
};

// A half turn about the axis of gravity, then 9 m. All of it is exact in floats as long as positions are.
static const wisp_transform MOTION = { { 0.0f, 1.0f, 0.0f, 0.0f }, { 4.0f, 0.0f, 8.0f } };

static void make_steps( hosted* h, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        assert_status( h->world, wisp_world_step( h->world, 1.0f / 60.0f ), WISP_OK );
    }
}

static wisp_component points_of( wisp_world* world, wisp_entity e )
{
    return wisp_world_has( world, e, WISP_PARTICLE_MASS ) ? WISP_SURFACE_POINTS : WISP_STRAND_POINTS;
}

static wisp_view host_view( hosted* h, wisp_entity e )
{
    wisp_view view;
    assert_status( h->world, wisp_world_view( h->world, e, points_of( h->world, e ), &view ), WISP_OK );
    return view;
}

static void request_points( hosted* h, wisp_entity e )
{
    assert_status( h->world, wisp_request( h->world, e, points_of( h->world, e ) ), WISP_OK );
    assert_status( h->world, wisp_request( h->world, e, WISP_MOTION_STATS ), WISP_OK );
}

// Largest distance of the points of an entity to those of a twin that was not teleported but is carried there now.
static double distance_to_twin( hosted* h, wisp_entity e, hosted* twin, wisp_entity original )
{
    const wisp_view a = host_view( h, e ), b = host_view( twin, original );
    double most = 0.0;
    for ( int i = 0; i < a.count; ++i )
    {
        most = fmax( most, vec_distance( ( (const wisp_vec3*)a.data )[i],
                                         wisp_transform_to_world( MOTION, ( (const wisp_vec3*)b.data )[i] ) ) );
    }
    return most;
}

static wisp_entity second_order_cloth( wisp_world* world )
{
    const wisp_entity e = implicit_cloth( world );
    SET( world, e, implicit_cloth, d.integrator = WISP_INTEGRATOR_BDF2 );
    return e;
}

// A frame that has moved and turned, of which nothing is felt.
static wisp_entity carry( wisp_world* world, wisp_entity e )
{
    SET( world, e, moving_frame, d.linear_inertia = d.angular_inertia = 0.0f );
    assert_status( world, wisp_move_frame( world, e, walked_pose( 1, 0.1f, 0.05f ) ), WISP_OK );
    return e;
}

static wisp_entity carried_cloth( wisp_world* world )
{
    return carry( world, cloth_of_links( world ) );
}

static wisp_entity carried_hair( wisp_world* world )
{
    return carry( world, hair_of_rods( world ) );
}

static wisp_entity cloth_near_targets( wisp_world* world )
{
    const wisp_entity e = cloth_of_links( world );
    SET( world, e, motion_constraints,
         ( d.max_distance = 0.03f, d.backstop_distance = 0.02f, d.backstop_radius = 0.3f ) );
    return e;
}

static const struct
{
    const char* name;
    effect_setup* add;
} KINDS[] = {
    { "cloth with bend links", cloth_of_links },
    { "cloth with dihedral bending", dihedral_cloth },
    { "implicit cloth", implicit_cloth },
    { "implicit cloth of second order", second_order_cloth },
    { "balloon", balloon },
    { "strands of links", hair_of_links },
    { "strands of rods", hair_of_rods },
    { "cloth that a frame carries", carried_cloth },
    { "strands that a frame carries", carried_hair },
    { "cloth near targets, with a backstop", cloth_near_targets },
};

TEST( an_entity_goes_on_as_if_it_had_been_there )
{
    for ( int k = 0; k < WISP_COUNT( KINDS ); ++k )
    {
        SCOPED( close_world ) hosted twin, h;
        open_all( &twin, 8, 1 );
        open_all( &h, 8, 1 );
        const wisp_entity original = KINDS[k].add( twin.world ), e = KINDS[k].add( h.world );
        request_points( &twin, original );
        request_points( &h, e );
        make_steps( &twin, BEFORE );
        make_steps( &h, BEFORE );
        assert_status( h.world, wisp_teleport( h.world, e, MOTION, true ), WISP_OK );
        const double at_once = distance_to_twin( &h, e, &twin, original );
        make_steps( &twin, AFTER );
        make_steps( &h, AFTER );
        const double later = distance_to_twin( &h, e, &twin, original );
        // Cloth that buckles makes millimetres of the rounding at the new place in these steps.
        if ( !( at_once < 3e-6 && later < 5e-3 ) )
        {
            fail_msg( "%s: %.3g m from its twin at once, %.3g m after %d steps", KINDS[k].name, at_once, later,
                      AFTER );
        }
    }
}

static double sum_of_speeds( wisp_world* world, wisp_entity e )
{
    const bool is_surface = wisp_world_has( world, e, WISP_PARTICLE_MASS );
    const float* v = wisp_world_column( world, e, is_surface ? WISP_PARTICLE_VELOCITY : WISP_STRAND_VELOCITY, 0 );
    const int count = is_surface ? 4 * wisp_world_fabric( world, e )->slot_count
                                 : 3 * WISP_LANES * wisp_world_strands( world, e )->row_count;
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        sum += fabs( (double)v[i] );
    }
    return sum;
}

// What moves before the teleport moves after it only by what forces do in a step: far less than it did.
TEST( velocities_can_end )
{
    for ( int k = 0; k < WISP_COUNT( KINDS ); ++k )
    {
        SCOPED( close_world ) hosted h;
        open_all( &h, 8, 1 );
        const wisp_entity e = KINDS[k].add( h.world );
        request_points( &h, e );
        make_steps( &h, 2 );
        const double before = sum_of_speeds( h.world, e );
        assert_status( h.world, wisp_teleport( h.world, e, MOTION, false ), WISP_OK );
        assert_true( sum_of_speeds( h.world, e ) == 0.0 );
        make_steps( &h, 1 );
        const double after = sum_of_speeds( h.world, e );
        if ( !( after < 0.7 * before ) )
        {
            fail_msg( "%s: sum of speeds %.3g m/s before, %.3g m/s after a step", KINDS[k].name, before, after );
        }
    }
}

// A sheet on a ball, teleported with it, lies on it as before; contact of two sheets goes along too.
static wisp_entity lay_on_ball( wisp_world* world, wisp_entity* ball, wisp_entity* upper )
{
    test_mesh mesh = test_plane( 13, 0.05f );
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_entity sheets[2];
    for ( int i = 0; i < 2; ++i )
    {
        for ( int v = 0; v < mesh.vertex_count; ++v )
        {
            mesh.points[v].x -= i == 0 ? 0.3f : 0.0f;
            mesh.points[v].z -= i == 0 ? 0.3f : 0.0f;
            mesh.points[v].y = 0.02f + 0.02f * (float)i;
        }
        sheets[i] = test_surface_of( world, &fabric, support_weightless_surface_def() );
        const wisp_cloth_def cloth = wisp_default_cloth_def();
        const wisp_collision_def collision = wisp_default_collision_def();
        const wisp_contact_def contact = wisp_default_contact_def();
        assert_status( world, wisp_set_cloth( world, sheets[i], &cloth ), WISP_OK );
        assert_status( world, wisp_set_gravity( world, sheets[i], EARTH ), WISP_OK );
        assert_status( world, wisp_set_collision( world, sheets[i], &collision ), WISP_OK );
        assert_status( world, wisp_set_contact( world, sheets[i], &contact ), WISP_OK );
    }
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_SPHERE;
    def.radius = 0.2f;
    def.pose.translation = ( wisp_vec3 ){ 0.0f, -0.2f, 0.0f };
    assert_status( world, wisp_add_collider( world, &def, ball ), WISP_OK );
    test_mesh_free( &mesh );
    *upper = sheets[1];
    return sheets[0];
}

TEST( bodies_and_what_lies_on_them_go_together )
{
    SCOPED( close_world ) hosted twin, h;
    open_all( &twin, 8, 1 );
    open_all( &h, 8, 1 );
    wisp_entity balls[2], uppers[2], lowers[2];
    lowers[0] = lay_on_ball( twin.world, &balls[0], &uppers[0] );
    lowers[1] = lay_on_ball( h.world, &balls[1], &uppers[1] );
    const wisp_entity moved[3] = { balls[1], uppers[1], lowers[1] };
    request_points( &twin, lowers[0] );
    request_points( &h, lowers[1] );
    make_steps( &twin, BEFORE );
    make_steps( &h, BEFORE );
    for ( int i = 0; i < 3; ++i )
    {
        assert_status( h.world, wisp_teleport( h.world, moved[i], MOTION, true ), WISP_OK );
    }
    make_steps( &twin, 5 );
    make_steps( &h, 5 );
    assert_true( distance_to_twin( &h, lowers[1], &twin, lowers[0] ) < 2e-3 );
}

// A collider that passes through a sheet in a teleport does not touch it, and gives it no velocity.
TEST( a_collider_meets_nothing_on_its_way )
{
    SCOPED( close_world ) hosted h;
    open_all( &h, 8, 1 );
    const wisp_entity e = cloth_of_links( h.world );
    SET_DEFAULT( h.world, e, collision );
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_SPHERE;
    def.radius = 0.1f;
    def.pose.translation = ( wisp_vec3 ){ 0.5f, 0.0f, -3.0f };
    wisp_entity ball;
    assert_status( h.world, wisp_add_collider( h.world, &def, &ball ), WISP_OK );
    request_points( &h, e );
    make_steps( &h, 600 );
    const double rest = motion_stats_of( h.world, e ).speed_max;
    const wisp_transform across = { { 0, 0, 0, 1 }, { 0.0f, -0.5f, 9.0f } };
    assert_status( h.world, wisp_teleport( h.world, ball, across, true ), WISP_OK );
    make_steps( &h, 2 );
    assert_true( motion_stats_of( h.world, e ).speed_max < rest + 1e-3 );
}

static wisp_entity root_on( wisp_world* world, wisp_entity surface )
{
    wisp_vec3 points[8];
    for ( int v = 0; v < 8; ++v )
    {
        points[v] = ( wisp_vec3 ){ 0.4f + 0.2f * (float)( v / 4 ), -0.02f * (float)( v % 4 ), 0.4f };
    }
    const int32_t offsets[] = { 0, 4, 8 };
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = 2;
    wisp_entity e;
    const wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    assert_status( world, wisp_add_strands( world, &def, &e ), WISP_OK );
    assert_status( world, wisp_set_strand_dynamics( world, e, &dynamics ), WISP_OK );
    assert_status( world, wisp_root_strands( world, e, surface ), WISP_OK );
    return e;
}

TEST( strands_on_a_surface_go_along )
{
    SCOPED( close_world ) hosted twin, h;
    open_all( &twin, 8, 1 );
    open_all( &h, 8, 1 );
    const wisp_entity on[2] = { cloth_of_links( twin.world ), cloth_of_links( h.world ) };
    const wisp_entity hairs[2] = { root_on( twin.world, on[0] ), root_on( h.world, on[1] ) };
    request_points( &twin, hairs[0] );
    request_points( &h, hairs[1] );
    make_steps( &twin, BEFORE );
    make_steps( &h, BEFORE );
    expect_refusal( h.world, wisp_teleport( h.world, hairs[1], MOTION, true ), WISP_CONFLICT, "rooted in a surface" );
    assert_status( h.world, wisp_teleport( h.world, on[1], MOTION, true ), WISP_OK );
    assert_true( distance_to_twin( &h, hairs[1], &twin, hairs[0] ) < 3e-6 );
    make_steps( &twin, AFTER );
    make_steps( &h, AFTER );
    assert_true( distance_to_twin( &h, hairs[1], &twin, hairs[0] ) < 1e-3 );
}

// Views between two steps are on neither side of the gap.
TEST( views_are_not_interpolated_across_a_teleport )
{
    SCOPED( close_world ) hosted h;
    open_all( &h, 8, 1 );
    const wisp_entity e = cloth_of_links( h.world );
    request_points( &h, e );
    assert_status( h.world, wisp_world_advance( h.world, 2.5f / 60.0f, 1.0f / 60.0f, NULL, NULL ), WISP_OK );
    assert_status( h.world, wisp_teleport( h.world, e, MOTION, true ), WISP_OK );
    assert_status( h.world, wisp_world_advance( h.world, 0.1f / 60.0f, 1.0f / 60.0f, NULL, NULL ), WISP_OK );
    assert_true( vec_distance( point_of( h.world, e, 0 ),
                               wisp_transform_to_world( MOTION, ( wisp_vec3 ){ 0, 0, 0 } ) ) < 1e-5 );
}

TEST( wrong_teleports_change_nothing )
{
    SCOPED( close_world ) hosted h;
    open_all( &h, 8, 1 );
    const wisp_entity e = cloth_of_links( h.world );
    wisp_vec3 points[2] = { { 0, 0, 0 }, { 0, -0.1f, 0 } };
    const int32_t offsets[] = { 0, 2 };
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = 1;
    wisp_entity still;
    assert_status( h.world, wisp_add_strands( h.world, &def, &still ), WISP_OK );
    request_points( &h, e );
    make_steps( &h, 2 );
    const uint64_t hash = wisp_world_hash( h.world );
    wisp_transform wrong = MOTION;
    wrong.translation.x = NAN;
    expect_refusal( h.world, wisp_teleport( h.world, e, wrong, true ), WISP_BAD_INPUT, "expected at most 1e6 m" );
    wrong.translation.x = -999999.9f;
    expect_refusal( h.world, wisp_teleport( h.world, e, wrong, true ), WISP_BAD_INPUT, "a vertex would be at" );
    wrong = ( wisp_transform ){ 0 };
    expect_refusal( h.world, wisp_teleport( h.world, e, wrong, true ), WISP_BAD_INPUT, "is not a rotation" );
    expect_refusal( h.world, wisp_teleport( h.world, still, MOTION, true ), WISP_CONFLICT, "nor strands that move" );
    expect_refusal( h.world, wisp_teleport( h.world, ( wisp_entity ){ 99, 1 }, MOTION, true ), WISP_STALE_ID,
                    "does not exist" );
    assert_true( wisp_world_hash( h.world ) == hash );
}
