// Small cloths of one fabric run side by side, with the bits that each has alone: whatever they differ in, and
// whatever happens to one of them.
#include "cloth_fixture.h"

#include "world.h"

enum
{
    SIDE = 9, // vertices
    CLOTHS = 37,
    STEPS = 24,
    DAMPED = 12, // cloths from this one on are damped, and so make a batch of their own
    STIFF = 3,   // has another stiffness
    FLAT = 4,    // does not bend, so it has no folds
    FOLDED = 5,  // is folded onto itself
    WILD = 7,    // loses its bounds
    ROUNDED = 9, // has coordinates of -0
    SUBSTEPS = 5,
    SEARCHED = 8, // a step whose first substep searches for folds
};

typedef struct crowd
{
    hosted h;
    wisp_entity cloths[CLOTHS];
} crowd;

typedef struct crowd_case
{
    wisp_solver solver;
    int workers;
    const char* isa;
    bool apart; // no batches
    bool limp;  // stiffness of one that does not bend
    bool windy; // air and internal damping, each its own: only links run side by side
} crowd_case;

static wisp_entity add_instance( crowd* c, wisp_fabric* fabric, const test_mesh* mesh, const crowd_case* how, int i )
{
    wisp_world* world = c->h.world;
    wisp_vec3 points[SIDE * SIDE];
    for ( int v = 0; v < SIDE * SIDE; ++v )
    {
        const wisp_vec3 p = mesh->points[v];
        points[v] = ( wisp_vec3 ){ p.x + (float)i, p.y, i % 2 == 0 ? p.z : -p.z };
        points[v] = i == ROUNDED ? ( wisp_vec3 ){ -p.x, -p.y, -p.z } : points[v];
    }
    const int32_t pins[2] = { 0, i % 3 == 0 ? SIDE - 1 : SIDE * SIDE - 1 };
    wisp_surface_def def = support_weightless_surface_def();
    def.fabric = fabric;
    def.points = points;
    def.pins = pins;
    def.pin_count = 1 + i % 2;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.solver = how->solver;
    cloth.warp_compliance = i == STIFF ? 1e-4f : 1e-3f;
    cloth.bend_stiffness = how->limp ? 0.0f : i == STIFF ? 0.3f : 0.1f;
    cloth.bending = i == FLAT ? WISP_CLOTH_BENDING_NONE : WISP_CLOTH_BENDING_LINKS;
    if ( how->windy )
    {
        cloth.wind = ( wisp_vec3 ){ 3.0f, 0.1f * (float)i, 1.0f };
        cloth.drag_coefficient = 0.2f;
        cloth.lift_coefficient = i % 5 == 0 ? 0.0f : 0.7f;
        cloth.internal_damping = 1.0f + (float)( i % 4 );
    }
    wisp_entity e;
    assert_status( world, wisp_add_surface( world, &def, &e ), WISP_OK );
    assert_status( world, wisp_set_cloth( world, e, &cloth ), WISP_OK );
    assert_status( world, wisp_set_gravity( world, e, ( wisp_vec3 ){ 0.1f * (float)i, -9.81f, 0.0f } ), WISP_OK );
    assert_status( world, wisp_set_damping( world, e, i >= DAMPED ? 0.1f * (float)i : 0.0f ), WISP_OK );
    assert_status( world, wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    return e;
}

static void open_crowd( crowd* c, const crowd_case* how )
{
    *c = ( crowd ){ 0 };
    c->h.def = hosted_def( &c->h );
    c->h.def.substeps = SUBSTEPS;
    c->h.def.workers = how->workers;
    c->h.def.isa = how->isa;
    assert_int_equal( wisp_world_create( &c->h.def, &c->h.world, NULL ), WISP_OK );
    c->h.world->registry.batch_count = how->apart ? 0 : c->h.world->registry.batch_count;
    test_mesh mesh = test_plane( SIDE, 0.05f );
    wisp_fabric_def def = test_fabric_def( &mesh );
    def.tile_size = 64; // two tiles
    wisp_fabric* fabric = NULL;
    assert_int_equal( wisp_fabric_cook( &def, NULL, &fabric, NULL ), WISP_OK );
    for ( int i = 0; i < CLOTHS; ++i )
    {
        c->cloths[i] = add_instance( c, fabric, &mesh, how, i );
    }
    wisp_fabric_release( fabric );
    test_mesh_free( &mesh );
}

// Lay one half of a cloth over the other.
static void fold( wisp_world* world, wisp_entity e )
{
    float* position = wisp_world_column( world, e, WISP_PARTICLE_POSITION, 0 );
    const int32_t* slots = wisp_world_fabric( world, e )->vertex_slot;
    for ( int v = 0; v < SIDE * SIDE; ++v )
    {
        const int i = v % SIDE, j = v / SIDE, mirror = SIDE - 1 - j;
        for ( int k = 0; k < 3 && j > SIDE / 2; ++k )
        {
            position[4 * slots[v] + k] = position[4 * slots[mirror * SIDE + i] + k] + ( k == 1 ? 1e-3f : 0.0f );
        }
    }
}

// Pins of some cloths move, each its own way, and stop half way in some.
static void move_pins( crowd* c, int number )
{
    for ( int i = DAMPED; i < CLOTHS; ++i )
    {
        const int32_t pin = 0;
        const wisp_vec3 to = { (float)i + 0.001f * (float)( number * i ), 0.01f * (float)number, 0.0f };
        assert_status( c->h.world, wisp_move_pins( c->h.world, c->cloths[i], &pin, &to, number % 4 == 3 ? 0 : 1 ),
                       WISP_OK );
    }
}

static void disturb( crowd* c, int number )
{
    move_pins( c, number );
    if ( number == SEARCHED )
    {
        fold( c->h.world, c->cloths[FOLDED] );
    }
    if ( number == 4 )
    {
        velocity_of( c->h.world, c->cloths[WILD], 40 )[1] = NAN;
    }
    if ( number == 12 )
    {
        velocity_of( c->h.world, c->cloths[DAMPED + 1], 40 )[1] = 3e8f;
    }
}

static void run_crowd( crowd* c, uint64_t hashes[STEPS] )
{
    for ( int i = 0; i < STEPS; ++i )
    {
        disturb( c, i );
        run_steps( c->h.world, 1, 1.0f / 60.0f );
        hashes[i] = wisp_world_hash( c->h.world );
    }
}

// Batches of the plan with some entities.
static int count_batches( const wisp_world* world )
{
    int count = 0;
    for ( int i = 0; i < world->plan.loop_group_count; ++i )
    {
        const plan_loop_group* group = world->plan.loop_groups + i;
        count += group->batch >= 0 && group->count > 1 ? 1 : 0;
    }
    return count;
}

// With the same instruction set, because which NaN the wild cloth keeps is left open.
TEST( cloths_side_by_side_have_the_bits_that_each_has_alone )
{
    static const crowd_case cases[] = {
        { WISP_SOLVER_PBD, 1, "avx512", false, false, false },
        { WISP_SOLVER_PBD, 1, "avx2", false, false, false },
        { WISP_SOLVER_PBD, 3, NULL, false, false, false },
        { WISP_SOLVER_XPBD, 1, "baseline", false, false, false },
        { WISP_SOLVER_XPBD, 2, NULL, false, false, false },
        { WISP_SOLVER_PBD, 1, NULL, false, true, false },
        { .solver = WISP_SOLVER_PBD, .workers = 2, .windy = true },
        { .solver = WISP_SOLVER_XPBD, .workers = 1, .isa = "avx2", .windy = true },
        { .solver = WISP_SOLVER_PBD, .workers = 1, .limp = true, .windy = true },
    };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        uint64_t expected[STEPS], found[STEPS];
        crowd_case alone = cases[i];
        alone.apart = true;
        crowd c;
        open_crowd( &c, &alone );
        run_crowd( &c, expected );
        close_world( &c.h );
        open_crowd( &c, cases + i );
        run_crowd( &c, found );
        assert_int_equal( count_batches( c.h.world ), 3 );
        close_world( &c.h );
        assert_memory_equal( found, expected, sizeof( found ) );
    }
}

TEST( a_cloth_that_halts_stops_no_neighbour )
{
    static const crowd_case how = { WISP_SOLVER_PBD, 2, NULL, false, false, false };
    uint64_t hashes[STEPS];
    crowd c;
    open_crowd( &c, &how );
    run_crowd( &c, hashes );
    for ( int i = 0; i < CLOTHS; ++i )
    {
        assert_int_equal( wisp_is_halted( c.h.world, c.cloths[i] ), i == WILD || i == DAMPED + 1 );
        assert_true( is_finite( c.h.world, c.cloths[i] ) );
    }
    close_world( &c.h );
}

static void check_folds( const crowd_case* how )
{
    crowd c;
    open_crowd( &c, how );
    run_steps( c.h.world, SEARCHED, 1.0f / 60.0f );
    fold( c.h.world, c.cloths[FOLDED] );
    run_steps( c.h.world, 1, 1.0f / 60.0f );
    assert_true( *(int32_t*)wisp_world_column( c.h.world, c.cloths[FOLDED], WISP_LINK_FOLDS, 1 ) > 0 );
    assert_int_equal( *(int32_t*)wisp_world_column( c.h.world, c.cloths[FOLDED + 1], WISP_LINK_FOLDS, 1 ), 0 );
    close_world( &c.h );
}

TEST( folds_are_found_and_opened )
{
    check_folds( &( crowd_case ){ .solver = WISP_SOLVER_XPBD, .workers = 1 } );
    check_folds( &( crowd_case ){ .solver = WISP_SOLVER_XPBD, .workers = 1, .windy = true } );
}

static void check_times( const crowd_case* how )
{
    crowd c;
    open_crowd( &c, how );
    run_steps( c.h.world, 8, 1.0f / 60.0f );
    const wisp_profile profile = wisp_world_profile( c.h.world );
    double links = 0.0, sum = 0.0;
    for ( int i = 0; i < profile.count; ++i )
    {
        sum += profile.lines[i].seconds;
        links += strcmp( profile.lines[i].pass, "links.pbd" ) == 0 ? profile.lines[i].seconds : 0.0;
    }
    assert_true( links > 0.0 && links < sum && sum > 0.3 * profile.seconds && sum <= profile.seconds );
    close_world( &c.h );
}

TEST( the_times_of_passes_add_up_to_most_of_a_step )
{
    check_times( &( crowd_case ){ .solver = WISP_SOLVER_PBD, .workers = 1 } );
    check_times( &( crowd_case ){ .solver = WISP_SOLVER_PBD, .workers = 1, .windy = true } );
}

static void check_allocations( const crowd_case* how )
{
    crowd c;
    open_crowd( &c, how );
    run_steps( c.h.world, 3, 1.0f / 60.0f );
    const int64_t calls = c.h.host.queried;
    run_steps( c.h.world, 5, 1.0f / 60.0f );
    assert_true( c.h.host.queried == calls );
    close_world( &c.h );
}

TEST( a_warm_step_allocates_nothing )
{
    check_allocations( &( crowd_case ){ .solver = WISP_SOLVER_PBD, .workers = 2 } );
    check_allocations( &( crowd_case ){ .solver = WISP_SOLVER_PBD, .workers = 2, .windy = true } );
}
