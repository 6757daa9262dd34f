// Tearing: closed forms of a strip under a weight, what a split keeps, valid meshes, refusals; which edge tears, at which
// end and where, against the oracle: irregular sheets are pulled apart, one split a step; and in a world: the same bits
// everywhere, snapshots, memory that runs out, what it goes together with.
#include "saved_world.h"
#include "tearing_fixture.h"

#include "attachments.h"
#include "boundary.h"
#include "collision.h"
#include "contact.h"
#include "engine/pass_hook.h"
#include "motion_constraints.h"
#include "oracle/tearing_oracle.h"
#include "strands.h"
#include "wisp/module/anchor.h"

// ---- a strip ----

enum
{
    COLUMNS = 3,
    ROWS = 6,
    STRIP_VERTICES = COLUMNS * ROWS,
    STRIP_SPARES = 12,
};

static const float SPACING = 0.1f; // m
static const float ROW = 0.003f;   // kg, of a row of vertices
static const float WEIGHT = 0.05f; // kg, of the last row

typedef struct strip
{
    hosted* h;
    wisp_world* world;
    wisp_entity e;
    int triangle_count, vertex_count;
} strip;

// A strip of COLUMNS x ROWS vertices hangs from its first row, with a weight spread over its last one by width.
static strip open_strip( int substeps, int iterations, int workers )
{
    strip s = { .h = open_tearing( substeps, iterations, workers ) };
    s.world = s.h->world;
    SCOPED( test_mesh_free ) test_mesh mesh = hanging_mesh( COLUMNS, ROWS, SPACING, SPACING );
    s.triangle_count = mesh.triangle_count;
    add_spares( &mesh, STRIP_SPARES );
    s.vertex_count = mesh.vertex_count;
    static const int32_t PINS[COLUMNS] = { 0, 1, 2 };
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = false;
    wisp_surface_def surface = wisp_default_surface_def();
    surface.pins = PINS, surface.pin_count = COLUMNS;
    wisp_cloth_def cloth = undamped_cloth();
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    cloth.shear_compliance = 1e6f; // diagonals carry nothing
    s.e = add_cloth( s.world, &fabric, surface, &cloth, EARTH );
    assert_status( s.world, wisp_set_damping( s.world, s.e, 5.0f ), WISP_OK );
    // of each row, a quarter, a half and a quarter
    const wisp_fabric* f = wisp_world_fabric( s.world, s.e );
    float factors[STRIP_VERTICES + STRIP_SPARES];
    for ( int v = 0; v < s.vertex_count; ++v )
    {
        const float share = v % COLUMNS == 1 ? 0.5f : 0.25f;
        const float row = v < STRIP_VERTICES - COLUMNS ? ROW : WEIGHT;
        factors[v] = v < STRIP_VERTICES ? row * share / ( f->area[f->vertex_slot[v]] * surface.area_density ) : 1.0f;
    }
    assert_status( s.world, wisp_set_map( s.world, s.e, WISP_MAP_AREA_DENSITY, factors, s.vertex_count ), WISP_OK );
    return s;
}

static void step_strip( strip* s, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        assert_status( s->world, wisp_world_step( s->world, 1.0f / 60.0f ), WISP_OK );
    }
}

static void let_tear( strip* s, float strength )
{
    SET( s->world, s->e, tearing, d.strength = strength );
}

// N/m, of all that hangs from the first row, on the width of the strip
static float tension( void )
{
    return ( WEIGHT + ( ROWS - 2 ) * ROW ) * 9.81f / ( ( COLUMNS - 1 ) * SPACING );
}

TEST( the_tension_of_a_strip_is_its_weight_by_its_width )
{
    strip s = open_strip( 4, 10, 1 );
    step_strip( &s, 600 );
    let_tear( &s, 1000.0f );
    step_strip( &s, 1 );
    const float load = tearing_stats_of( s.world, s.e ).max_load;
    assert_float_equal( load * 1000.0f, tension(),
                        1e-3f * tension() ); // 4e-4 was seen, of a strip that is nearly at rest
    close_tearing( s.h );
}

TEST( a_strip_tears_above_its_strength_and_not_below )
{
    strip s = open_strip( 4, 10, 1 );
    step_strip( &s, 600 );
    let_tear( &s, 1.03f * tension() );
    step_strip( &s, 60 );
    assert_int_equal( tearing_stats_of( s.world, s.e ).split_count, 0 );
    let_tear( &s, 0.97f * tension() );
    step_strip( &s, 1 );
    assert_int_equal( tearing_stats_of( s.world, s.e ).split_count, COLUMNS );
    assert_int_equal( wisp_world_counter( s.world, WISP_COUNT_SPLIT_VERTICES ), COLUMNS );
    step_strip( &s, 30 );
    const wisp_tearing_stats stats = tearing_stats_of( s.world, s.e );
    assert_int_equal( stats.split_count, COLUMNS );
    assert_int_equal( stats.spare_count, STRIP_SPARES - COLUMNS );
    assert_true( stats.max_load < 0.1f );
    close_tearing( s.h );
}

// A strip that was let to tear, and has.
static strip open_torn( void )
{
    strip s = open_strip( 4, 10, 1 );
    step_strip( &s, 600 );
    let_tear( &s, 0.97f * tension() );
    step_strip( &s, 1 );
    assert_int_equal( tearing_stats_of( s.world, s.e ).split_count, COLUMNS );
    return s;
}

TEST( a_torn_mesh_has_the_same_triangles_in_two_pieces )
{
    strip s = open_torn();
    test_mesh mesh = hanging_mesh( COLUMNS, ROWS, SPACING, SPACING );
    int32_t* t = read_triangles( s.world, s.e, s.triangle_count );
    const wisp_fabric* f = wisp_world_fabric( s.world, s.e );
    for ( int i = 0; i < 3 * s.triangle_count; ++i )
    {
        const wisp_vec3 was = mesh.points[mesh.triangles[i]], is = f->rest[f->vertex_slot[t[i]]];
        assert_true( was.x == is.x && was.y == is.y && was.z == is.z );
    }
    const mesh_report r = report_mesh( t, s.triangle_count, s.vertex_count, s.world, s.e );
    assert_int_equal( r.pieces, 2 );
    assert_int_equal( r.used_vertices, STRIP_VERTICES + COLUMNS );
    assert_int_equal( r.nonmanifold_edges, 0 );
    assert_int_equal( r.nonmanifold_vertices, 0 );
    assert_sound_fabric( s.world, s.e );
    free( t );
    test_mesh_free( &mesh );
    close_tearing( s.h );
}

TEST( a_split_keeps_mass_and_momentum )
{
    strip s = open_strip( 4, 10, 1 ), torn = open_strip( 4, 10, 1 );
    strip* both[2] = { &s, &torn };
    for ( int k = 0; k < 2; ++k )
    {
        step_strip( both[k], 20 ); // it still swings
        let_tear( both[k], k == 0 ? 1e6f : 1.0f );
        step_strip( both[k], 1 );
    }
    assert_true( tearing_stats_of( torn.world, torn.e ).split_count > 0 );
    const mass_sums before = sum_masses( s.world, s.e ), after = sum_masses( torn.world, torn.e );
    assert_true( fabs( after.mass - before.mass ) <= 1e-6 * before.mass ); // rounding of inverse masses
    for ( int k = 0; k < 3; ++k )
    {
        assert_true( fabs( after.momentum[k] - before.momentum[k] ) <= 1e-6 * before.mass );
        assert_true( fabs( after.centre[k] - before.centre[k] ) <= 1e-6 );
    }
    close_tearing( s.h );
    close_tearing( torn.h );
}

TEST( the_lower_piece_falls_freely_and_the_upper_one_hangs )
{
    strip s = open_torn();
    assert_status( s.world, wisp_set_damping( s.world, s.e, 0.0f ), WISP_OK );
    const float y = point_of( s.world, s.e, STRIP_VERTICES - 1 ).y;
    step_strip( &s, 30 );
    assert_float_equal( point_of( s.world, s.e, STRIP_VERTICES - 1 ).y, y - 0.5f * 9.81f * 0.25f, 0.03f );
    assert_float_equal( point_of( s.world, s.e, 0 ).y, 0.0f, 0.0f );
    close_tearing( s.h );
}

// An edge that a tear has laid open stands for half of its width, as if the torn mesh had been given.
TEST( limits_are_those_of_the_torn_mesh )
{
    strip s = open_torn();
    const wisp_component component = wisp_world_find_component( s.world, "tearing.limit" );
    const size_t bytes = (size_t)wisp_world_fabric( s.world, s.e )->link_order.slot_count * sizeof( float );
    float* torn = checked_malloc( bytes );
    memcpy( torn, wisp_world_column( s.world, s.e, component, 0 ), bytes );
    let_tear( &s, 0.97f * tension() ); // fills them anew
    assert_memory_equal( torn, wisp_world_column( s.world, s.e, component, 0 ), bytes );
    free( torn );
    close_tearing( s.h );
}

// ---- against the oracle ----

enum
{
    PULLED_SIDE = 9,
    PULLED_SPARES = 60,
    PULLED_VERTICES = PULLED_SIDE * PULLED_SIDE + PULLED_SPARES,
    PULLED_TRIANGLES = 2 * ( PULLED_SIDE - 1 ) * ( PULLED_SIDE - 1 ),
    PULLED_STEPS = 120,
};

static const double PULLED_STRENGTH = 30.0; // N/m

// An edge and its force, as they were before the split.
typedef struct pulled_edge
{
    int a, b; // the user's order, a < b
    double force, tension;
} pulled_edge;

typedef struct pulled_sheet
{
    hosted* h;
    wisp_world* world;
    wisp_entity e;
    pulled_edge edges[3 * PULLED_TRIANGLES];
    int edge_count;
    double inverse_dt2;
    pass_hook hook;
} pulled_sheet;

// Read the multipliers behind the pass, before the step ends with a split.
static void read_forces( void* user )
{
    pulled_sheet* s = user;
    const wisp_fabric* f = wisp_world_fabric( s->world, s->e );
    const float* lambda = wisp_world_column( s->world, s->e, WISP_LINK_LAMBDA, 0 );
    s->edge_count = 0;
    for ( int slot = 0; slot < f->link_order.slot_count; ++slot )
    {
        const int link = f->link_order.constraint[slot];
        if ( link >= 0 && link < f->edge_count )
        {
            const int a = f->slot_vertex[f->link_a_x4[slot] / 4], b = f->slot_vertex[f->link_b_x4[slot] / 4];
            s->edges[s->edge_count++] = ( pulled_edge ){ .a = a < b ? a : b,
                                                         .b = a < b ? b : a,
                                                         .force = -(double)lambda[slot] * s->inverse_dt2 };
        }
    }
}

static pulled_sheet* open_pulled_sheet( int seed )
{
    pulled_sheet* s = checked_calloc( 1, sizeof( pulled_sheet ) );
    s->h = open_tearing( 2, 4, 1 );
    s->world = s->h->world;
    s->inverse_dt2 = 120.0 * 120.0;
    SCOPED( test_mesh_free ) test_mesh mesh = hanging_mesh( PULLED_SIDE, PULLED_SIDE, 0.1f, 0.1f );
    int32_t pins[2 * PULLED_SIDE];
    for ( int v = 0; v < PULLED_SIDE * PULLED_SIDE; ++v )
    {
        mesh.points[v].x += test_random_float( seed, 2 * v, -0.02f, 0.02f );
        mesh.points[v].y += test_random_float( seed, 2 * v + 1, -0.02f, 0.02f );
    }
    for ( int i = 0; i < PULLED_SIDE; ++i )
    {
        pins[i] = i;
        pins[PULLED_SIDE + i] = PULLED_SIDE * ( PULLED_SIDE - 1 ) + i;
    }
    add_spares( &mesh, PULLED_SPARES );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = wisp_default_surface_def();
    surface.pins = pins, surface.pin_count = 2 * PULLED_SIDE, surface.spare_count = PULLED_SPARES;
    wisp_cloth_def cloth = undamped_cloth();
    cloth.warp_compliance = cloth.weft_compliance = 1e-3f, cloth.shear_compliance = 2e-3f;
    s->e = add_cloth( s->world, &fabric, surface, &cloth, EARTH );
    s->hook = ( pass_hook ){ .after = read_forces, .user = s };
    pass_hook_set( s->world, "tearing.measure", &s->hook );
    return s;
}

static int compare( const void* left, const void* right )
{
    const pulled_edge *a = left, *b = right;
    return a->tension > b->tension ? -1 : a->tension < b->tension ? 1 : 0;
}

static bool is_pinned( const pulled_sheet* s, int vertex )
{
    (void)s;
    return vertex < PULLED_SIDE ||
           ( vertex >= PULLED_SIDE * ( PULLED_SIDE - 1 ) && vertex < PULLED_SIDE * PULLED_SIDE );
}

// Vertices that a cut takes: the new one, and one for each end at the rim whose triangles part.
static int count_new( const pulled_sheet* s, const tearing_oracle_mesh* mesh, const tearing_oracle_cut* cut )
{
    int count = 1;
    for ( int k = 0; k < 2; ++k )
    {
        const int end = cut->ends[k];
        count += end >= 0 && is_pinned( s, end ) == false && tearing_oracle_is_inside( mesh, end ) == false ? 1 : 0;
    }
    return count;
}

// What the oracle would split first: vertex, and which triangles leave it. @return false: nothing
static bool predict( const pulled_sheet* s, const tearing_oracle_mesh* mesh, pulled_edge* edges, int max_splits,
                     int* vertex, bool* leaves )
{
    for ( int i = 0; i < s->edge_count && edges[i].tension > PULLED_STRENGTH; ++i )
    {
        bool both[2][PULLED_TRIANGLES];
        tearing_oracle_cut cuts[2];
        const int ends[2] = { edges[i].a, edges[i].b };
        for ( int k = 0; k < 2; ++k )
        {
            cuts[k] = tearing_oracle_cut_at( mesh, ends[k], ends[1 - k], both[k] );
            cuts[k].is_possible = cuts[k].is_possible && is_pinned( s, ends[k] ) == false &&
                                  count_new( s, mesh, cuts + k ) <= max_splits;
        }
        if ( cuts[0].is_possible || cuts[1].is_possible )
        {
            const bool second =
                cuts[1].is_possible &&
                ( cuts[0].is_possible == false ||
                  ( cuts[0].is_inside != cuts[1].is_inside ? cuts[0].is_inside : cuts[1].cost < cuts[0].cost ) );
            *vertex = ends[second ? 1 : 0];
            memcpy( leaves, both[second ? 1 : 0], sizeof( both[0] ) );
            return true;
        }
    }
    return false;
}

// @return splits that were compared
static int compare_step( pulled_sheet* s, int max_splits, bool* is_torn )
{
    SET( s->world, s->e, tearing, d.strength = (float)PULLED_STRENGTH, d.max_splits = max_splits );
    SCOPED( free_local ) int32_t* before = read_triangles( s->world, s->e, PULLED_TRIANGLES );
    const wisp_fabric* f = wisp_world_fabric( s->world, s->e );
    double rest[PULLED_VERTICES][2];
    for ( int v = 0; v < PULLED_VERTICES; ++v )
    {
        rest[v][0] = (double)f->rest[f->vertex_slot[v]].x;
        rest[v][1] = (double)f->rest[f->vertex_slot[v]].y;
    }
    assert_status( s->world, wisp_world_step( s->world, 1.0f / 60.0f ), WISP_OK );
    const tearing_oracle_mesh mesh = { ( const double( * )[2] )(const void*)rest,
                                       ( const int32_t( * )[3] )(const void*)before, PULLED_TRIANGLES };
    double largest = 0.0;
    int over = 0;
    for ( int i = 0; i < s->edge_count; ++i )
    {
        s->edges[i].tension = tearing_oracle_tension( &mesh, s->edges[i].a, s->edges[i].b, s->edges[i].force );
        largest = fmax( largest, s->edges[i].tension );
        over += s->edges[i].tension > PULLED_STRENGTH ? 1 : 0;
    }
    qsort( s->edges, (size_t)s->edge_count, sizeof( *s->edges ), compare );
    const wisp_tearing_stats stats = tearing_stats_of( s->world, s->e );
    assert_true( fabs( (double)stats.max_load * PULLED_STRENGTH - largest ) <= 1e-5 * largest ); // rounding of widths
    assert_int_equal( stats.over_count, over );
    int vertex = -1, moved = 0;
    bool leaves[PULLED_TRIANGLES];
    const bool tears = predict( s, &mesh, s->edges, max_splits, &vertex, leaves );
    SCOPED( free_local ) int32_t* after = read_triangles( s->world, s->e, PULLED_TRIANGLES );
    for ( int i = 0; i < 3 * PULLED_TRIANGLES; ++i )
    {
        moved += after[i] != before[i] ? 1 : 0;
        if ( tears && before[i] == vertex )
        {
            // a later split of the same step may part what is left of it
            assert_true( leaves[i / 3] ? after[i] != vertex : after[i] == vertex || max_splits > 1 );
        }
    }
    assert_int_equal( moved > 0, tears );
    *is_torn = *is_torn || tears;
    return tears ? 1 : 0;
}

static int count_spares( const pulled_sheet* s )
{
    const wisp_fabric* f = wisp_world_fabric( s->world, s->e );
    int count = 0;
    for ( int slot = 0; slot < f->vertex_count; ++slot )
    {
        count += f->area[slot] == 0.0f ? 1 : 0;
    }
    return count;
}

TEST( splits_are_those_of_the_oracle )
{
    int compared = 0;
    for ( int seed = 1; seed <= 10; ++seed )
    {
        SCOPED( free_local ) pulled_sheet* s = open_pulled_sheet( seed );
        bool is_torn = false;
        for ( int step = 0; step < PULLED_STEPS && count_spares( s ) >= 3; ++step )
        {
            int32_t pins[PULLED_SIDE];
            wisp_vec3 targets[PULLED_SIDE];
            for ( int i = 0; i < PULLED_SIDE; ++i ) // the lower edge goes down at 0.3 m/s
            {
                pins[i] = PULLED_SIDE * ( PULLED_SIDE - 1 ) + i;
                targets[i] =
                    step == 0 ? ( wisp_vec3 ){ 0.1f * (float)i, -0.8f, 0.0f } : point_of( s->world, s->e, pins[i] );
                targets[i].y -= 0.005f;
            }
            assert_status( s->world, wisp_move_pins( s->world, s->e, pins, targets, PULLED_SIDE ), WISP_OK );
            compared += compare_step( s, step % 2 == 0 ? 1 : 3, &is_torn );
        }
        assert_true( is_torn );
        assert_sound_fabric( s->world, s->e );
        close_tearing( s->h );
    }
    printf( "%d splits compared\n", compared );
    assert_true( compared > 60 );
}

// ---- worlds ----

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
    wisp_cloth_def cloth = undamped_cloth();
    cloth.bending = c->bending;
    cloth.warp_compliance = cloth.weft_compliance = 2e-4f, cloth.shear_compliance = 4e-4f;
    cloth.internal_damping = 0.5f, cloth.drag_coefficient = 0.5f;
    return cloth;
}

// A sheet that is held at two opposite edges, and a ball on its way through it.
static sheet* open_sheet( const sheet_case* c, float strength )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module, &wisp_contact_module,
                                                  &wisp_tearing_module };
    sheet* s = checked_calloc( 1, sizeof( sheet ) );
    OPEN( &s->h, MODULES, .substeps = c->substeps, .iterations = c->iterations );
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
    SET_DEFAULT( world, s->e, collision );
    wisp_contact_def contact = wisp_default_contact_def();
    contact.thickness = 0.006f;
    assert_status( world, c->has_contact ? wisp_set_contact( world, s->e, &contact ) : WISP_OK, WISP_OK );
    SET( world, s->e, tearing, d.strength = strength, d.max_splits = 16 );
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

// Rows of links and hinges have gone along with a split: to set the cloth again, which fills them anew, changes none.
static void assert_rows_are_those_of_the_material( sheet* s, const sheet_case* c )
{
    static const wisp_component ALL[] = { WISP_LINK_OWN, WISP_LINK_CONSTANT, WISP_HINGE_REST };
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
        sheet* s = open_sheet( CASES + n, STRENGTH );
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
    sheet *s = open_sheet( CASES, STRENGTH ), *whole = open_sheet( CASES, STRENGTH );
    run_sheet( s, 0, STEPS - 8 );
    const saved_world saved = save_world( s->h.world );
    const int splits = tearing_stats_of( s->h.world, s->e ).split_count;
    SET( s->h.world, s->e, tearing, d.strength = 1e6f );
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
        sheet* s = open_sheet( CASES + 3, 1e6f );
        run_sheet( s, 0, first );
        SET( s->h.world, s->e, tearing, d.strength = 5.0f );
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

// A weak half: only it tears.
TEST( a_map_of_factors_decides_where_it_tears )
{
    sheet* s = open_sheet( CASES, STRENGTH );
    float factors[SIDE * SIDE + SPARES];
    for ( int v = 0; v < SIDE * SIDE + SPARES; ++v )
    {
        factors[v] = v % SIDE < SIDE / 2 ? 1.0f : 1000.0f;
    }
    SET( s->h.world, s->e, tearing, d.strength = STRENGTH, d.factors = factors );
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
    SCOPED( close_local ) hosted* h = new_hosted( MODULES, WISP_COUNT( MODULES ), 2, 2, 1 );
    wisp_world* w = h->world;
    SCOPED( test_mesh_free )
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
    const wisp_cloth_def cloth = undamped_cloth();
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
    SET( w, e, tearing, d.strength = 0.3f );
    for ( int step = 0; step < 10; ++step )
    {
        assert_status( w, wisp_world_step( w, 1.0f / 60.0f ), WISP_OK );
    }
    assert_true( tearing_stats_of( w, e ).split_count > 10 );
    const wisp_fabric* f = wisp_world_fabric( w, e );
    const float* position = wisp_world_column( w, e, WISP_PARTICLE_POSITION, 0 );
    const float* pins = wisp_world_column( w, pinned, WISP_PARTICLE_POSITION, 0 );
    const char* place = wisp_world_column( w, pinned, wisp_world_find_component( w, "attachments.place" ), 0 );
    const wisp_component anchor = wisp_world_find_component( w, "strands.anchor" );
    const int32_t* root_triangle = wisp_world_column( w, hair, anchor, 0 );
    const float *root_weights = wisp_world_column( w, hair, anchor, 1 ),
                *roots = wisp_world_column( w, hair, WISP_STRAND_ROOT, 0 );
    int changed = 0;
    for ( int v = 0; v < COUNT; ++v )
    {
        const size_t slot = (size_t)wisp_world_fabric( w, pinned )->vertex_slot[v],
                     first = (size_t)( v / WISP_LANES * 3 * WISP_LANES + v % WISP_LANES );
        wisp_anchor pin;
        memcpy( &pin, place + 36 * slot + 8, sizeof( pin ) );
        const wisp_triangle of_pin = wisp_triangle_of( f, position, pin.triangle ),
                            of_root = wisp_triangle_of( f, position, root_triangle[v] );
        const float *w3 = root_weights + first, *r3 = roots + first;
        const float weights[3] = { w3[0], w3[WISP_LANES], w3[2 * WISP_LANES] };
        const wisp_vec3 root = { r3[0], r3[WISP_LANES], r3[2 * WISP_LANES] };
        const wisp_vec3 foot = wisp_triangle_point( &of_pin, pin.weights );
        const float away = wisp_v3_length( wisp_v3_sub( wisp_v3_load( pins + 4 * slot ), foot ) );
        assert_true( away > 0.01f && away < 0.03f );
        assert_true( wisp_v3_length( wisp_v3_sub( root, wisp_triangle_point( &of_root, weights ) ) ) < 1e-5f );
        for ( int k = 0; k < 3; ++k )
        {
            changed += f->slot_vertex[f->triangles[3 * (size_t)pin.triangle + (size_t)k]] >= COUNT ? 1 : 0;
        }
    }
    assert_true( changed > 5 );
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
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 30, 0.1f );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    static const int32_t PINS[1] = { 0 };
    fabric.coarse_sheets = coarse, fabric.tethers = true, fabric.attachments = PINS, fabric.attachment_count = 1;
    wisp_surface_def surface = wisp_default_surface_def();
    surface.vertex_mass = vertex_mass;
    const wisp_entity e = test_surface_of( world, &fabric, surface );
    assert_status( world, cloth != NULL ? wisp_set_cloth( world, e, cloth ) : WISP_OK, WISP_OK );
    return e;
}

TEST( what_does_not_tear_is_refused_with_its_reason )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_motion_constraints_module,
                                                  &wisp_boundary_module, &wisp_tearing_module };
    SCOPED( close_local ) hosted* h = new_hosted( MODULES, WISP_COUNT( MODULES ), 1, 1, 1 );
    wisp_world* w = h->world;
    wisp_tearing_def def = wisp_default_tearing_def(), bad;
    def.strength = 10.0f;
    wisp_cloth_def cloth = undamped_cloth(), pbd = cloth, tethered = cloth;
    pbd.solver = WISP_SOLVER_PBD;
    tethered.tethers = true;
    assert_refused( w, add_sheet( w, NULL, 0.0f, false ), def, WISP_CONFLICT, "is no cloth yet" );
    assert_refused( w, add_sheet( w, &pbd, 0.0f, false ), def, WISP_CONFLICT, "moves by pbd" );
    assert_refused( w, add_sheet( w, &tethered, 0.0f, false ), def, WISP_CONFLICT, "has tethers" );
    assert_refused( w, add_sheet( w, &cloth, 0.0f, true ), def, WISP_CONFLICT, "has coarse sheets" );
    assert_refused( w, add_sheet( w, &cloth, 0.1f, false ), def, WISP_CONFLICT, "has vertex_mass" );
    const wisp_entity e = add_sheet( w, &cloth, 0.0f, false );
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
}
