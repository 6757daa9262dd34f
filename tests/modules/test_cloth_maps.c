// Cloths that differ. Maps: parameters that differ from vertex to vertex (closed forms are in tests/claims). Small cloths of
// one fabric run side by side, with the bits that each has alone: whatever they differ in, and whatever happens to one of them.
#include "cloth_fixture.h"

#include "world.h"

#include "wisp/maps.h"

// ---- maps ----

static void fill( float* factors, int count, float value )
{
    for ( int i = 0; i < count; ++i )
    {
        factors[i] = value;
    }
}

// A strip whose warp is vertical: 40 links of 0.05 m a side and nothing else acts along it.
static wisp_entity hang_strip( hosted* h, const test_mesh* mesh, wisp_cloth_def cloth, float mass )
{
    const int32_t pins[2] = { 0, 1 };
    wisp_fabric_def fabric = test_fabric_def( mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.vertex_mass = mass;
    surface.pins = pins;
    surface.pin_count = 2;
    return add_cloth( h->world, &fabric, surface, &cloth, EARTH );
}

static wisp_cloth_def vertical_threads( float compliance )
{
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.warp = ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f };
    cloth.warp_compliance = compliance;
    cloth.weft_compliance = 1e6f;
    cloth.shear_compliance = 1e6f;
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    cloth.internal_damping = 20.0f;
    return cloth;
}

TEST( each_link_has_the_mean_of_its_ends_and_null_takes_it_back )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, 1, 1 );
    SCOPED( test_mesh_free ) test_mesh mesh = hanging_mesh( 4, 5, 0.05f, 0.05f );
    wisp_cloth_def cloth = vertical_threads( 1e-2f );
    cloth.bending = WISP_CLOTH_BENDING_LINKS;
    const wisp_entity e = hang_strip( &h, &mesh, cloth, 1e-3f );
    const wisp_fabric* f = wisp_world_fabric( h.world, e );
    const int slots = f->link_order.slot_count;
    float *before = calloc( (size_t)slots, sizeof( float ) ), factors[20];
    memcpy( before, wisp_world_column( h.world, e, WISP_LINK_OWN, 0 ), (size_t)slots * sizeof( float ) );
    for ( int i = 0; i < WISP_COUNT( factors ); ++i )
    {
        factors[i] = (float)i;
    }
    const uint64_t hash = wisp_world_hash( h.world );
    assert_status( h.world, wisp_set_map( h.world, e, WISP_MAP_STRETCH_COMPLIANCE, factors, 20 ), WISP_OK );
    assert_status( h.world, wisp_set_map( h.world, e, WISP_MAP_BEND_COMPLIANCE, factors, 20 ), WISP_OK );
    const float* column = wisp_world_column( h.world, e, WISP_LINK_OWN, 0 );
    int bend_links = 0;
    for ( int slot = 0; slot < slots; ++slot )
    {
        const int link = f->link_order.constraint[slot];
        // this mesh has no triangles back to back, so bend links are hinges, and a bend link has the mean of its edge
        const bool is_bend = link >= f->edge_count;
        const int32_t* ends = is_bend ? f->hinges + 4 * (size_t)( link - f->edge_count )
                                      : f->edges + 2 * (size_t)( link >= 0 ? link : 0 );
        const float mean = 0.5f * (float)( f->slot_vertex[ends[0]] + f->slot_vertex[ends[1]] );
        assert_true( column[slot] == ( link >= 0 ? before[slot] * mean : before[slot] ) );
        bend_links += is_bend ? 1 : 0;
    }
    assert_true( bend_links > 0 );
    // a change of the constant keeps the pattern
    cloth.warp_compliance = 2e-2f;
    assert_status( h.world, wisp_set_cloth( h.world, e, &cloth ), WISP_OK );
    cloth.warp_compliance = 1e-2f;
    assert_status( h.world, wisp_set_cloth( h.world, e, &cloth ), WISP_OK );
    assert_status( h.world, wisp_set_map( h.world, e, WISP_MAP_STRETCH_COMPLIANCE, NULL, 0 ), WISP_OK );
    assert_status( h.world, wisp_set_map( h.world, e, WISP_MAP_BEND_COMPLIANCE, NULL, 0 ), WISP_OK );
    column = wisp_world_column( h.world, e, WISP_LINK_OWN, 0 );
    assert_memory_equal( column, before, (size_t)slots * sizeof( float ) );
    assert_true( wisp_world_hash( h.world ) == hash ); // nothing is left of a map
    free( before );
}

TEST( mapped_internal_damping_keeps_momentum_and_angular_momentum )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, 10, 1 );
    SCOPED( test_mesh_free ) test_mesh mesh = hanging_mesh( 6, 6, 0.1f, 0.1f );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.warp_compliance = cloth.weft_compliance = cloth.shear_compliance = 1e6f;
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    cloth.internal_damping = 5.0f;
    const wisp_entity e =
        add_cloth( h.world, &fabric, support_weightless_surface_def(), &cloth, ( wisp_vec3 ){ 0, 0, 0 } );
    float factors[36];
    for ( int v = 0; v < 36; ++v )
    {
        factors[v] = v < 18 ? 0.0f : 3.0f;
        for ( int k = 0; k < 3; ++k )
        {
            velocity_of( h.world, e, v )[k] = test_random_float( v, k, -1.0f, 1.0f );
        }
    }
    assert_status( h.world, wisp_set_map( h.world, e, WISP_MAP_INTERNAL_DAMPING, factors, 36 ), WISP_OK );
    run_steps( h.world, 1, 1e-4f );
    const wisp_motion_stats before = motion_stats_of( h.world, e );
    float free_one[3];
    memcpy( free_one, velocity_of( h.world, e, 3 ), sizeof( free_one ) );
    run_steps( h.world, 500, 1e-4f );
    const wisp_motion_stats after = motion_stats_of( h.world, e );
    for ( int k = 0; k < 3; ++k )
    {
        assert_within( after.momentum[k], before.momentum[k], 1e-6 );
        assert_within( after.angular_momentum[k], before.angular_momentum[k], 1e-6 );
        assert_within( (double)velocity_of( h.world, e, 3 )[k], (double)free_one[k], 1e-3 ); // factor 0
    }
    assert_true( after.kinetic_energy < 0.8 * before.kinetic_energy );
}

TEST( pins_snapshots_and_instances_keep_mapped_masses )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, 4, 1 );
    SCOPED( test_mesh_free ) test_mesh mesh = hanging_mesh( 4, 4, 0.1f, 0.1f );
    wisp_cloth_def cloth = vertical_threads( 1e-3f );
    const wisp_entity e = hang_strip( &h, &mesh, cloth, 0.0f );
    const wisp_fabric* f = wisp_world_fabric( h.world, e );
    float factors[16];
    fill( factors, 16, 1.0f );
    factors[9] = 5.0f;
    const size_t slot = (size_t)f->vertex_slot[9];
    const float plain = ( (float*)wisp_world_column( h.world, e, WISP_PARTICLE_POSITION, 0 ) )[4 * slot + 3];
    assert_status( h.world, wisp_set_map( h.world, e, WISP_MAP_AREA_DENSITY, factors, 16 ), WISP_OK );
    const size_t size = wisp_world_snapshot_size( h.world );
    SCOPED( free_local ) void* bytes = calloc( 1, size );
    assert_status( h.world, wisp_world_snapshot( h.world, bytes, size ), WISP_OK );
    factors[9] = 7.0f;
    assert_status( h.world, wisp_set_map( h.world, e, WISP_MAP_AREA_DENSITY, factors, 16 ), WISP_OK );
    assert_status( h.world, wisp_world_restore( h.world, bytes, size ), WISP_OK );
    const int32_t vertex = 9;
    assert_status( h.world, wisp_pin( h.world, e, &vertex, 1 ), WISP_OK );
    assert_status( h.world, wisp_unpin( h.world, e, &vertex, 1 ), WISP_OK );
    wisp_entity instance;
    assert_status( h.world, wisp_add_instance( h.world, e, NULL, &instance ), WISP_OK );
    const wisp_entity both[2] = { e, instance };
    for ( int i = 0; i < 2; ++i )
    {
        const float* position = wisp_world_column( h.world, both[i], WISP_PARTICLE_POSITION, 0 );
        assert_within( (double)position[4 * slot + 3], (double)plain / 5.0, 1e-6 * (double)plain );
    }
}

TEST( wrong_maps_are_refused_with_one_message )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, 4, 1 );
    SCOPED( test_mesh_free ) test_mesh mesh = hanging_mesh( 4, 4, 0.1f, 0.1f );
    const wisp_entity e = hang_strip( &h, &mesh, vertical_threads( 1e-3f ), 0.0f );
    float factors[16];
    fill( factors, 16, 1.0f );
    const uint64_t hash = wisp_world_hash( h.world );
    expect_refusal( h.world, wisp_set_map( h.world, e, WISP_MAP_AREA_DENSITY, factors, 15 ), WISP_BAD_INPUT,
                    "got 15 factors, but the surface has 16 vertices" );
    expect_refusal( h.world, wisp_set_map( h.world, e, WISP_MAP_DRAG, factors, 16 ), WISP_CONFLICT,
                    "has no such constant" );
    expect_refusal( h.world, wisp_set_map( h.world, e, WISP_MAP_STRETCH_STIFFNESS, factors, 16 ), WISP_CONFLICT,
                    "has no such constant" );
    expect_refusal( h.world, wisp_set_map( h.world, e, WISP_SURFACE_POINTS, factors, 16 ), WISP_BAD_INPUT,
                    "is not a map" );
    const float wrong[] = { 0.0f, -1.0f, NAN, INFINITY, 2e6f };
    for ( int i = 0; i < 5; ++i )
    {
        factors[11] = wrong[i];
        expect_refusal( h.world, wisp_set_map( h.world, e, WISP_MAP_AREA_DENSITY, factors, 16 ), WISP_BAD_INPUT,
                        "vertex 11: got the factor" );
    }
    assert_true( wisp_world_hash( h.world ) == hash );
}

// ---- instances ----

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
    bool apart;  // no batches
    bool limp;   // stiffness of one that does not bend
    bool windy;  // air and internal damping, each its own
    bool mapped; // drag by a map besides: only links run side by side
    bool damped; // internal damping alone, each its own, and some without pins
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
    def.pin_count = how->damped && i < DAMPED && i % 3 == 1 ? 0 : 1 + i % 2;
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
    }
    cloth.internal_damping = how->windy || how->damped ? 1.0f + (float)( i % 4 ) : 0.0f;
    wisp_entity e;
    assert_status( world, wisp_add_surface( world, &def, &e ), WISP_OK );
    assert_status( world, wisp_set_cloth( world, e, &cloth ), WISP_OK );
    assert_status( world, wisp_set_gravity( world, e, ( wisp_vec3 ){ 0.1f * (float)i, -9.81f, 0.0f } ), WISP_OK );
    assert_status( world, wisp_set_damping( world, e, i >= DAMPED ? 0.1f * (float)i : 0.0f ), WISP_OK );
    assert_status( world, wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    float factors[SIDE * SIDE];
    for ( int v = 0; v < SIDE * SIDE; ++v )
    {
        factors[v] = 0.01f * (float)( v + i );
    }
    if ( how->mapped )
    {
        assert_status( world, wisp_set_map( world, e, WISP_MAP_DRAG, factors, SIDE * SIDE ), WISP_OK );
    }
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
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( SIDE, 0.05f );
    wisp_fabric_def def = test_fabric_def( &mesh );
    def.tile_size = 64; // two tiles
    wisp_fabric* fabric = NULL;
    assert_int_equal( wisp_fabric_cook( &def, NULL, &fabric, NULL ), WISP_OK );
    for ( int i = 0; i < CLOTHS; ++i )
    {
        c->cloths[i] = add_instance( c, fabric, &mesh, how, i );
    }
    wisp_fabric_release( fabric );
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
        { .solver = WISP_SOLVER_PBD, .workers = 1, .isa = "avx512" },
        { .solver = WISP_SOLVER_PBD, .workers = 1, .isa = "avx2" },
        { .solver = WISP_SOLVER_PBD, .workers = 3 },
        { .solver = WISP_SOLVER_XPBD, .workers = 1, .isa = "baseline" },
        { .solver = WISP_SOLVER_XPBD, .workers = 2 },
        { .solver = WISP_SOLVER_PBD, .workers = 1, .limp = true },
        { .solver = WISP_SOLVER_PBD, .workers = 2, .windy = true },
        { .solver = WISP_SOLVER_XPBD, .workers = 1, .isa = "avx2", .windy = true },
        { .solver = WISP_SOLVER_PBD, .workers = 1, .limp = true, .windy = true },
        { .solver = WISP_SOLVER_PBD, .workers = 2, .windy = true, .mapped = true },
        { .solver = WISP_SOLVER_XPBD, .workers = 1, .isa = "baseline", .windy = true, .mapped = true },
        { .solver = WISP_SOLVER_PBD, .workers = 2, .damped = true },
        { .solver = WISP_SOLVER_XPBD, .workers = 1, .isa = "baseline", .damped = true },
        { .solver = WISP_SOLVER_XPBD, .workers = 1, .isa = "avx2", .damped = true },
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
    static const crowd_case how = { .solver = WISP_SOLVER_PBD, .workers = 2 };
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
    check_folds( &( crowd_case ){ .solver = WISP_SOLVER_XPBD, .workers = 1, .windy = true, .mapped = true } );
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
    check_times( &( crowd_case ){ .solver = WISP_SOLVER_PBD, .workers = 1, .damped = true } );
    check_times( &( crowd_case ){ .solver = WISP_SOLVER_PBD, .workers = 1, .windy = true, .mapped = true } );
}
