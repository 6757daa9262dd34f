// Tearing in a world: the same bits everywhere, snapshots, memory that runs out, what it goes together with, refusals.
#include "tearing_fixture.h"

#include "saved_world.h"

#include "attachments.h"
#include "boundary.h"
#include "collision.h"
#include "contact.h"
#include "motion_constraints.h"
#include "strands.h"

enum
{
    SIDE = 33, // vertices: several tiles
    SPARES = 160,
    TRIANGLES = 2 * ( SIDE - 1 ) * ( SIDE - 1 ),
    STEPS = 36,
};

static const float STRENGTH = 25.0f; // N/m

typedef struct sheet_case
{
    wisp_cloth_bending bending;
    int substeps, iterations;
    bool has_contact, has_maps;
} sheet_case;

static const sheet_case CASES[] = {
    { WISP_CLOTH_BENDING_LINKS, 4, 1, false, false },    { WISP_CLOTH_BENDING_LINKS, 2, 4, false, true },
    { WISP_CLOTH_BENDING_DIHEDRAL, 4, 1, false, false }, { WISP_CLOTH_BENDING_ISOMETRIC, 4, 2, false, true },
    { WISP_CLOTH_BENDING_LINKS, 4, 1, true, false },
};

typedef struct sheet
{
    hosted h;
    wisp_entity e;
} sheet;

static void set_maps( wisp_world* world, wisp_entity e )
{
    float factors[SIDE * SIDE + SPARES];
    for ( int i = 0; i < WISP_COUNT( factors ); ++i )
    {
        factors[i] = test_random_float( 9, i, 0.5f, 1.5f );
    }
    assert_status( world, wisp_set_map( world, e, WISP_MAP_STRETCH_COMPLIANCE, factors, WISP_COUNT( factors ) ),
                   WISP_OK );
    assert_status( world, wisp_set_map( world, e, WISP_MAP_AREA_DENSITY, factors, WISP_COUNT( factors ) ), WISP_OK );
}

static wisp_cloth_def cloth_of( const sheet_case* c )
{
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = c->bending;
    cloth.warp_compliance = cloth.weft_compliance = 2e-4f, cloth.shear_compliance = 4e-4f;
    cloth.internal_damping = 0.5f, cloth.drag_coefficient = 0.5f;
    return cloth;
}

// A sheet that is held at two opposite edges, and a ball on its way through it.
static sheet* open_sheet( const sheet_case* c, int workers, const char* isa, float strength )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module, &wisp_contact_module,
                                                  &wisp_tearing_module };
    sheet* s = checked_calloc( 1, sizeof( sheet ) );
    s->h.def = hosted_def( &s->h );
    s->h.def.modules = MODULES, s->h.def.module_count = WISP_COUNT( MODULES );
    s->h.def.substeps = c->substeps, s->h.def.iterations = c->iterations;
    s->h.def.workers = workers, s->h.def.isa = isa;
    assert_int_equal( wisp_world_create( &s->h.def, &s->h.world, NULL ), WISP_OK );
    wisp_world* world = s->h.world;
    test_mesh mesh = hanging_mesh( SIDE, SIDE, 0.03f, 0.03f );
    int32_t pins[2 * SIDE];
    for ( int v = 0; v < SIDE * SIDE; ++v )
    {
        mesh.points[v].x += test_random_float( 3, 2 * v, -0.006f, 0.006f );
        mesh.points[v].y += test_random_float( 3, 2 * v + 1, -0.006f, 0.006f );
        mesh.points[v].z = test_random_float( 4, v, -0.003f, 0.003f ); // hinges have angles at rest
    }
    for ( int i = 0; i < SIDE; ++i )
    {
        pins[i] = i, pins[SIDE + i] = SIDE * ( SIDE - 1 ) + i;
    }
    add_spares( &mesh, SPARES );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = c->bending == WISP_CLOTH_BENDING_LINKS;
    fabric.hinges = c->bending != WISP_CLOTH_BENDING_LINKS;
    fabric.lean = true;
    wisp_surface_def surface = wisp_default_surface_def();
    surface.pins = pins, surface.pin_count = 2 * SIDE, surface.spare_count = SPARES;
    const wisp_cloth_def cloth = cloth_of( c );
    s->e = add_cloth( world, &fabric, surface, &cloth, EARTH );
    assert_status( world, wisp_request( world, s->e, WISP_SURFACE_NORMALS ), WISP_OK );
    assert_status( world, wisp_request( world, s->e, WISP_POINT_STRAIN ), WISP_OK );
    test_mesh_free( &mesh );
    if ( c->has_maps )
    {
        set_maps( world, s->e );
    }
    wisp_collider_def ball = wisp_default_collider_def();
    wisp_entity body;
    ball.kind = WISP_COLLIDER_SPHERE, ball.radius = 0.12f;
    assert_status( world, wisp_add_collider( world, &ball, &body ), WISP_OK );
    const wisp_collision_def collision = wisp_default_collision_def();
    assert_status( world, wisp_set_collision( world, s->e, &collision ), WISP_OK );
    wisp_contact_def contact = wisp_default_contact_def();
    contact.thickness = 0.006f;
    assert_status( world, c->has_contact ? wisp_set_contact( world, s->e, &contact ) : WISP_OK, WISP_OK );
    wisp_tearing_def def = wisp_default_tearing_def();
    def.strength = strength, def.max_splits = 16;
    assert_status( world, wisp_set_tearing( world, s->e, &def ), WISP_OK );
    s->h.host.refuse = 0;
    return s;
}

static void close_sheet( sheet* s )
{
    void* state = &s->h;
    wisp_world_destroy( s->h.world );
    assert_host_memory_is_released( &s->h.host );
    (void)state;
    free( s );
}

static wisp_status step_sheet( sheet* s, int step )
{
    const wisp_entity ball = { 2, 1 };
    const wisp_vec3 place = { 0.47f, -0.5f, -0.5f + 0.08f * (float)step };
    assert_status( s->h.world,
                   wisp_move_collider( s->h.world, ball, wisp_transform_make( ( wisp_quat ){ 0, 0, 0, 1 }, place ) ),
                   WISP_OK );
    return wisp_world_step( s->h.world, 1.0f / 60.0f );
}

static void run_sheet( sheet* s, int from, int to )
{
    for ( int step = from; step < to; ++step )
    {
        assert_status( s->h.world, step_sheet( s, step ), WISP_OK );
    }
}

TEST( workers_and_instruction_sets_do_not_change_a_bit )
{
    const int workers[] = { 1, 2, 5 };
    const char* const isas[] = { "baseline", "avx2", "avx512" };
    for ( int n = 0; n < WISP_COUNT( CASES ); ++n )
    {
        uint64_t expected = 0;
        for ( int i = 0; i < WISP_COUNT( workers ); ++i )
        {
            sheet* s = open_sheet( CASES + n, workers[i], isas[i % 3], STRENGTH );
            run_sheet( s, 0, STEPS );
            assert_true( tearing_stats_of( s->h.world, s->e ).split_count > 5 );
            assert_int_equal( wisp_world_counter( s->h.world, WISP_COUNT_HALTED ), 0 );
            const uint64_t hash = wisp_world_hash( s->h.world );
            expected = i == 0 ? hash : expected;
            assert_true( hash == expected );
            close_sheet( s );
        }
    }
}

// Rows of links and hinges have gone along with a split: to set the cloth again, which fills them anew, changes none.
static void assert_rows_are_those_of_the_material( sheet* s, const sheet_case* c )
{
    static const wisp_component ALL[] = { WISP_LINK_COMPLIANCE, WISP_LINK_CONSTANT, WISP_HINGE_REST };
    const wisp_fabric* f = wisp_world_fabric( s->h.world, s->e );
    const wisp_cloth_def cloth = cloth_of( c );
    void* kept[WISP_COUNT( ALL )];
    size_t bytes[WISP_COUNT( ALL )];
    for ( int i = 0; i < WISP_COUNT( ALL ); ++i )
    {
        const void* column = wisp_world_column( s->h.world, s->e, ALL[i], 0 );
        const int rows = ALL[i] == WISP_HINGE_REST ? f->hinge_order.slot_count : f->link_order.slot_count;
        bytes[i] = column != NULL ? (size_t)rows * sizeof( float ) : 0;
        kept[i] = checked_malloc( bytes[i] + 1 );
        if ( column != NULL )
        {
            memcpy( kept[i], column, bytes[i] );
        }
    }
    assert_status( s->h.world, wisp_set_cloth( s->h.world, s->e, &cloth ), WISP_OK );
    for ( int i = 0; i < WISP_COUNT( ALL ); ++i )
    {
        const void* column = wisp_world_column( s->h.world, s->e, ALL[i], 0 );
        assert_true( bytes[i] == 0 || memcmp( kept[i], column, bytes[i] ) == 0 );
        free( kept[i] );
    }
}

TEST( torn_meshes_are_valid_and_finite_with_all_that_cloth_has )
{
    for ( int n = 0; n < WISP_COUNT( CASES ); ++n )
    {
        sheet* s = open_sheet( CASES + n, 1, NULL, STRENGTH );
        const double mass = sum_masses( s->h.world, s->e ).mass;
        int splits = 0;
        for ( int step = 0; step < STEPS; ++step )
        {
            run_sheet( s, step, step + 1 );
            const int now = tearing_stats_of( s->h.world, s->e ).split_count;
            assert_true( now - splits <= 16 );
            splits = now;
        }
        int32_t* t = read_triangles( s->h.world, s->e, TRIANGLES );
        const mesh_report r = report_mesh( t, TRIANGLES, SIDE * SIDE + SPARES, s->h.world, s->e );
        assert_int_equal( r.used_vertices, SIDE * SIDE + splits );
        assert_int_equal( r.nonmanifold_edges, 0 );
        assert_int_equal( r.nonmanifold_vertices, 0 );
        assert_true( is_finite( s->h.world, s->e ) );
        assert_sound_fabric( s->h.world, s->e );
        assert_rows_are_those_of_the_material( s, CASES + n );
        const double now = sum_masses( s->h.world, s->e ).mass;
        assert_true( fabs( now - mass ) <= 1e-5 * mass );
        free( t );
        close_sheet( s );
    }
}

TEST( a_snapshot_holds_a_torn_sheet_and_is_refused_by_another )
{
    sheet *s = open_sheet( CASES, 1, NULL, STRENGTH ), *whole = open_sheet( CASES, 1, NULL, STRENGTH );
    run_sheet( s, 0, STEPS - 8 );
    const saved_world saved = save_world( s->h.world );
    const int splits = tearing_stats_of( s->h.world, s->e ).split_count;
    wisp_tearing_def def = wisp_default_tearing_def();
    def.strength = 1e6f;
    assert_status( s->h.world, wisp_set_tearing( s->h.world, s->e, &def ), WISP_OK );
    const saved_world strong = save_world( s->h.world );
    run_sheet( s, STEPS - 8, STEPS );
    const uint64_t hash = wisp_world_hash( s->h.world );
    assert_int_equal( tearing_stats_of( s->h.world, s->e ).split_count, splits );
    assert_status( s->h.world, wisp_world_restore( s->h.world, strong.bytes, strong.size ), WISP_OK );
    run_sheet( s, STEPS - 8, STEPS );
    assert_true( wisp_world_hash( s->h.world ) == hash );
    run_sheet( whole, 0, 1 );
    const uint64_t before = wisp_world_hash( whole->h.world );
    assert_status( whole->h.world, wisp_world_restore( whole->h.world, saved.bytes, saved.size ), WISP_BAD_INPUT );
    assert_true( wisp_world_message( whole->h.world )[0] != '\0' );
    assert_true( wisp_world_hash( whole->h.world ) == before );
    free( saved.bytes );
    free( strong.bytes );
    close_sheet( s );
    close_sheet( whole );
}

// Requests of a step that tears are refused in turn: the step fails, and the next ones go on.
TEST( a_step_without_memory_fails_and_the_next_one_goes_on )
{
    const int first = 10;
    int failures = 0;
    bool is_refused = true;
    for ( int64_t n = 1; is_refused; n += 1 + n / 8 )
    {
        sheet* s = open_sheet( CASES + 3, 1, NULL, 1e6f );
        run_sheet( s, 0, first );
        wisp_tearing_def def = wisp_default_tearing_def();
        def.strength = 5.0f;
        assert_status( s->h.world, wisp_set_tearing( s->h.world, s->e, &def ), WISP_OK );
        s->h.host.refuse = atomic_load( &s->h.host.queried ) + n;
        const wisp_status status = step_sheet( s, first );
        is_refused = atomic_load( &s->h.host.queried ) >= s->h.host.refuse;
        s->h.host.refuse = 0;
        assert_int_equal( status, is_refused ? WISP_NO_MEMORY : WISP_OK );
        failures += is_refused ? 1 : 0;
        run_sheet( s, first + 1, first + 3 );
        assert_sound_fabric( s->h.world, s->e );
        assert_true( is_finite( s->h.world, s->e ) );
        close_sheet( s );
    }
    assert_true( failures > 20 );
}

TEST( a_cloth_without_tearing_has_no_pass_and_no_column )
{
    sheet* s = open_sheet( CASES, 1, NULL, STRENGTH );
    assert_status( s->h.world, wisp_set_tearing( s->h.world, s->e, NULL ), WISP_OK );
    run_sheet( s, 0, 2 );
    wisp_tearing_stats stats;
    assert_int_equal( count_passes_named( s->h.world, "tearing.measure" ), 0 );
    assert_false( wisp_world_has( s->h.world, s->e, WISP_LINK_LAMBDA ) );
    assert_status( s->h.world, wisp_read_tearing_stats( s->h.world, s->e, &stats ), WISP_CONFLICT );
    run_sheet( s, 2, STEPS );
    assert_int_equal( wisp_world_counter( s->h.world, WISP_COUNT_SPLIT_VERTICES ), 0 );
    close_sheet( s );
}

// A weak half: only it tears.
TEST( a_map_of_factors_decides_where_it_tears )
{
    sheet* s = open_sheet( CASES, 1, NULL, STRENGTH );
    float factors[SIDE * SIDE + SPARES];
    for ( int v = 0; v < SIDE * SIDE + SPARES; ++v )
    {
        factors[v] = v % SIDE < SIDE / 2 ? 1.0f : 1000.0f;
    }
    wisp_tearing_def def = wisp_default_tearing_def();
    def.strength = STRENGTH, def.factors = factors;
    assert_status( s->h.world, wisp_set_tearing( s->h.world, s->e, &def ), WISP_OK );
    run_sheet( s, 0, STEPS );
    const wisp_fabric* f = wisp_world_fabric( s->h.world, s->e );
    int copies = 0;
    for ( int v = SIDE * SIDE; v < SIDE * SIDE + SPARES; ++v )
    {
        if ( f->area[f->vertex_slot[v]] > 0.0f )
        {
            copies += 1;
            assert_true( f->rest[f->vertex_slot[v]].x < 0.03f * ( SIDE / 2 ) + 0.02f );
        }
    }
    assert_true( copies > 5 );
    close_sheet( s );
}

// ---- what is attached to it ----

static bool is_triangle( const wisp_fabric* f, const int32_t corner[3] )
{
    for ( int t = 0; t < f->triangle_count; ++t )
    {
        if ( memcmp( f->triangles + 3 * (size_t)t, corner, 3 * sizeof( int32_t ) ) == 0 )
        {
            return true;
        }
    }
    return false;
}

// A sheet that tears, one whose vertices are attached to it all over, and hair on it.
TEST( pins_and_roots_go_with_their_triangles )
{
    static const wisp_module* const MODULES[] = { &wisp_attachments_module, &wisp_cloth_module, &wisp_strands_module,
                                                  &wisp_tearing_module };
    enum
    {
        N = 12,
        MORE = 40,
        COUNT = N * N,
    };
    hosted* h = new_hosted( MODULES, WISP_COUNT( MODULES ), 2, 2, 1 );
    wisp_world* w = h->world;
    test_mesh mesh = hanging_mesh( N, N, 0.05f, 0.05f ), upper = hanging_mesh( N, N, 0.045f, 0.045f );
    int32_t top[N], all[COUNT];
    wisp_vec3 points[2 * COUNT];
    int32_t offsets[COUNT + 1];
    add_spares( &mesh, MORE );
    for ( int v = 0; v < COUNT; ++v )
    {
        all[v] = v;
        top[v % N] = v % N;
        upper.points[v].x += 0.011f, upper.points[v].y -= 0.013f, upper.points[v].z = 0.02f;
        points[2 * v] = points[2 * v + 1] = upper.points[v];
        points[2 * v + 1].z += 0.02f;
        offsets[v + 1] = 2 * ( v + 1 );
    }
    offsets[0] = 0;
    wisp_fabric_def fabric = test_fabric_def( &mesh ), above = test_fabric_def( &upper );
    wisp_surface_def surface = wisp_default_surface_def(), loose = surface;
    surface.pins = top, surface.pin_count = N, surface.spare_count = MORE;
    loose.pins = all, loose.pin_count = COUNT;
    const wisp_cloth_def cloth = wisp_default_cloth_def();
    const wisp_entity e = add_cloth( w, &fabric, surface, &cloth, EARTH ),
                      pinned = test_surface_of( w, &above, loose );
    assert_status( w, wisp_request( w, pinned, WISP_SURFACE_POINTS ), WISP_OK );
    assert_status( w, wisp_attach_pins( w, pinned, all, COUNT, e ), WISP_OK );
    wisp_entity hair;
    wisp_strands_def strands = wisp_default_strands_def();
    const wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    strands.points = points, strands.offsets = offsets, strands.strand_count = COUNT;
    assert_status( w, wisp_add_strands( w, &strands, &hair ), WISP_OK );
    assert_status( w, wisp_set_strand_dynamics( w, hair, &dynamics ), WISP_OK );
    assert_status( w, wisp_root_strands( w, hair, e ), WISP_OK );
    assert_status( w, wisp_request( w, hair, WISP_STRAND_POINTS ), WISP_OK );
    wisp_tearing_def def = wisp_default_tearing_def();
    def.strength = 0.3f;
    assert_status( w, wisp_set_tearing( w, e, &def ), WISP_OK );
    for ( int step = 0; step < 10; ++step )
    {
        assert_status( w, wisp_world_step( w, 1.0f / 60.0f ), WISP_OK );
    }
    assert_true( tearing_stats_of( w, e ).split_count > 10 );
    const wisp_fabric* f = wisp_world_fabric( w, e );
    const char* place = wisp_world_column( w, pinned, wisp_world_find_component( w, "attachments.place" ), 0 );
    const int32_t* anchor = wisp_world_column( w, hair, wisp_world_find_component( w, "strands.anchor" ), 0 );
    int changed = 0;
    for ( int v = 0; v < COUNT; ++v )
    {
        int32_t corner[3];
        memcpy( corner, place + 44 * (size_t)wisp_world_fabric( w, pinned )->vertex_slot[v] + 8, sizeof( corner ) );
        assert_true( is_triangle( f, corner ) );
        const int lane = v % WISP_LANES, first = v / WISP_LANES * 3 * WISP_LANES + lane;
        const int32_t root[3] = { anchor[first], anchor[first + WISP_LANES], anchor[first + 2 * WISP_LANES] };
        assert_true( is_triangle( f, root ) );
        changed += f->slot_vertex[corner[0]] >= COUNT || f->slot_vertex[corner[1]] >= COUNT ||
                           f->slot_vertex[corner[2]] >= COUNT
                       ? 1
                       : 0;
    }
    assert_true( changed > 5 );
    test_mesh_free( &mesh );
    test_mesh_free( &upper );
    close_tearing( h );
}

// ---- refusals ----

static void assert_refused( wisp_world* world, wisp_entity e, wisp_tearing_def def, wisp_status status,
                            const char* message )
{
    assert_status( world, wisp_set_tearing( world, e, &def ), status );
    assert_non_null( strstr( wisp_world_message( world ), message ) );
}

static wisp_entity add_sheet( wisp_world* world, const wisp_cloth_def* cloth, float vertex_mass, bool coarse )
{
    test_mesh mesh = test_plane( 30, 0.1f );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    static const int32_t PINS[1] = { 0 };
    fabric.coarse_sheets = coarse, fabric.tethers = true, fabric.attachments = PINS, fabric.attachment_count = 1;
    wisp_surface_def surface = wisp_default_surface_def();
    surface.vertex_mass = vertex_mass;
    const wisp_entity e = test_surface_of( world, &fabric, surface );
    assert_status( world, cloth != NULL ? wisp_set_cloth( world, e, cloth ) : WISP_OK, WISP_OK );
    test_mesh_free( &mesh );
    return e;
}

TEST( what_does_not_tear_is_refused_with_its_reason )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_motion_constraints_module,
                                                  &wisp_boundary_module, &wisp_tearing_module };
    hosted* h = new_hosted( MODULES, WISP_COUNT( MODULES ), 1, 1, 1 );
    wisp_world* w = h->world;
    wisp_tearing_def def = wisp_default_tearing_def(), bad;
    def.strength = 10.0f;
    wisp_cloth_def cloth = wisp_default_cloth_def(), pbd = cloth, tethered = cloth;
    pbd.solver = WISP_SOLVER_PBD;
    tethered.tethers = true;
    assert_refused( w, add_sheet( w, NULL, 0.0f, false ), def, WISP_CONFLICT, "is no cloth yet" );
    assert_refused( w, add_sheet( w, &pbd, 0.0f, false ), def, WISP_CONFLICT, "moves by pbd" );
    assert_refused( w, add_sheet( w, &tethered, 0.0f, false ), def, WISP_CONFLICT, "has tethers" );
    assert_refused( w, add_sheet( w, &cloth, 0.0f, true ), def, WISP_CONFLICT, "has coarse sheets" );
    assert_refused( w, add_sheet( w, &cloth, 0.1f, false ), def, WISP_CONFLICT, "has vertex_mass" );
    const wisp_entity e = add_sheet( w, &cloth, 0.0f, false );
    bad = def, bad.strength = 0.0f;
    assert_refused( w, e, bad, WISP_BAD_INPUT, "tearing: strength: got 0" );
    bad = def, bad.strength = NAN;
    assert_refused( w, e, bad, WISP_BAD_INPUT, "tearing: strength" );
    bad = def, bad.max_splits = 0;
    assert_refused( w, e, bad, WISP_BAD_INPUT, "tearing: max_splits: got 0" );
    float factors[900] = { 0.0f };
    bad = def, bad.factors = factors;
    assert_refused( w, e, bad, WISP_BAD_INPUT, "tearing: factors: vertex 0: got 0" );
    bad = ( wisp_tearing_def ){ 0 };
    assert_refused( w, e, bad, WISP_BAD_INPUT, "wisp_default_tearing_def" );
    const wisp_boundary_def boundary = wisp_default_boundary_def();
    assert_status( w, wisp_set_boundary( w, e, &boundary ), WISP_OK );
    assert_refused( w, e, def, WISP_CONFLICT, "has boundary particles" );
    const wisp_entity held = add_sheet( w, &cloth, 0.0f, false );
    const wisp_motion_constraints_def motion = wisp_default_motion_constraints_def();
    assert_status( w, wisp_set_motion_constraints( w, held, &motion ), WISP_OK );
    assert_refused( w, held, def, WISP_CONFLICT, "has motion constraints" );
    assert_refused( w, ( wisp_entity ){ 99, 1 }, def, WISP_STALE_ID, "99" );
    int32_t few[3];
    assert_status( w, wisp_read_triangles( w, e, few, 1 ), WISP_BAD_INPUT );
    close_tearing( h );
}

TEST( a_world_without_the_module_says_so )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module };
    hosted* h = new_hosted( MODULES, 1, 1, 1, 1 );
    const wisp_cloth_def cloth = wisp_default_cloth_def();
    wisp_tearing_def def = wisp_default_tearing_def();
    def.strength = 10.0f;
    assert_refused( h->world, add_sheet( h->world, &cloth, 0.0f, false ), def, WISP_CONFLICT, "tearing" );
    close_tearing( h );
}
