// Seams: the projection against its oracle, momentum, what hangs on several pairs; in worlds: boundaries that are
// found, substeps, removal, halted surfaces, teleports, implicit cloth, refusals, memory.
#include "seam_fixture.h"

#include "implicit_linked.h"
#include "oracle/double3.h"
#include "oracle/constraint_oracle.h"

enum
{
    SIDE = 5,
    VERTICES = SIDE * SIDE,
    PAIRS = 40,
};

// ---- against the oracle ----

typedef struct sewn
{
    hosted* h;
    wisp_world* world;
    wisp_entity a, b, seam;
    int32_t pairs[2 * PAIRS];
} sewn;

// Number of a pair in the order of the vertices.
static int rank_of( const int32_t pairs[2 * PAIRS], int pair )
{
    const int32_t* p = pairs + 2 * pair;
    int rank = 0;
    for ( int i = 0; i < PAIRS; ++i )
    {
        const int32_t* q = pairs + 2 * i;
        const bool is_same = q[0] == p[0] && q[1] == p[1];
        rank += q[0] < p[0] || ( q[0] == p[0] && q[1] < p[1] ) || ( is_same && i < pair ) ? 1 : 0;
    }
    return rank;
}

static void scatter_points( test_mesh* mesh, int seed )
{
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        mesh->points[v] = ( wisp_vec3 ){ test_random_float( seed, 3 * v, -0.5f, 0.5f ),
                                         test_random_float( seed, 3 * v + 1, -0.5f, 0.5f ),
                                         test_random_float( seed, 3 * v + 2, -0.5f, 0.5f ) };
    }
}

// Two clouds of loose vertices, some pinned, with random pairs between them; a vertex may be in several.
static sewn open_clouds( int iterations, int workers, wisp_seam_def def, bool has_pins )
{
    sewn s = { .h = open_sewing( 1, iterations, workers ) };
    s.world = s.h->world;
    static const int32_t PINS[] = { 0, 7, 11 };
    wisp_surface_def surface = support_weightless_surface_def();
    test_mesh meshes[2] = { test_plane( SIDE, 0.1f ), test_plane( SIDE, 0.1f ) };
    for ( int k = 0; k < 2; ++k )
    {
        scatter_points( meshes + k, 20 + k );
        surface.area_density = k == 0 ? 0.1f : 0.4f;
        surface.pins = PINS;
        surface.pin_count = has_pins ? WISP_COUNT( PINS ) : 0;
        *( k == 0 ? &s.a : &s.b ) = add_panel( s.world, meshes + k, surface, NULL );
        test_mesh_free( meshes + k );
    }
    for ( int p = 0; p < 2 * PAIRS; ++p )
    {
        s.pairs[p] = test_random( 3, p, VERTICES );
    }
    def.a = s.a, def.b = s.b, def.pairs = s.pairs, def.pair_count = PAIRS;
    s.seam = sew( s.world, &def );
    return s;
}

typedef struct cloud
{
    double3 at[2][VERTICES];
    double w[2][VERTICES];
    seam_oracle_pair pairs[PAIRS];
    int colour[PAIRS], colours;
} cloud;

static cloud read_cloud( sewn* s )
{
    cloud c = { .colours = 0 };
    for ( int v = 0; v < VERTICES; ++v )
    {
        const float *a = row_of( s->world, s->a, WISP_PARTICLE_POSITION, v ),
                    *b = row_of( s->world, s->b, WISP_PARTICLE_POSITION, v );
        c.at[0][v] = double3_from( a );
        c.at[1][v] = double3_from( b );
        c.w[0][v] = (double)a[3];
        c.w[1][v] = (double)b[3];
    }
    uint64_t taken[2][VERTICES] = { { 0 } };
    for ( int p = 0; p < PAIRS; ++p )
    {
        const int a = s->pairs[2 * p], b = s->pairs[2 * p + 1];
        while ( ( ( taken[0][a] | taken[1][b] ) >> c.colour[p] & 1 ) != 0 )
        {
            c.colour[p] += 1;
        }
        taken[0][a] |= UINT64_C( 1 ) << c.colour[p];
        taken[1][b] |= UINT64_C( 1 ) << c.colour[p];
        c.colours = c.colour[p] >= c.colours ? c.colour[p] + 1 : c.colours;
        c.pairs[p].rest = double3_distance( c.at[0][a], c.at[1][b] );
    }
    return c;
}

static void step_cloud( cloud* c, const sewn* s, int iterations, const wisp_seam_def* def )
{
    const double dt = 1.0 / 60.0, alpha = (double)def->compliance / ( dt * dt );
    for ( int p = 0; p < PAIRS; ++p )
    {
        c->pairs[p].rest =
            seam_oracle_close( c->pairs[p].rest, (double)def->distance, (double)def->closing_speed * dt );
        c->pairs[p].lambda = double3_make( 0.0, 0.0, 0.0 );
    }
    for ( int n = 0; n < iterations * c->colours; ++n )
    {
        for ( int p = 0; p < PAIRS; ++p )
        {
            const int a = s->pairs[2 * p], b = s->pairs[2 * p + 1];
            if ( c->colour[p] == n % c->colours )
            {
                seam_oracle_project( c->pairs + p, c->at[0] + a, c->at[1] + b,
                                     ( const double[2] ){ c->w[0][a], c->w[1][b] }, alpha );
            }
        }
    }
}

TEST( a_substep_of_a_seam_is_that_of_the_oracle )
{
    static const struct
    {
        float distance, closing_speed, compliance;
        int iterations;
    } CASES[] = { { 0.0f, 1.0f, 0.0f, 1 },      { 0.0f, INFINITY, 0.0f, 1 }, { 0.0f, INFINITY, 0.05f, 1 },
                  { 0.0f, INFINITY, 0.05f, 3 }, { 0.2f, INFINITY, 0.0f, 2 }, { 0.2f, INFINITY, 0.05f, 4 },
                  { 0.9f, 3.0f, 0.01f, 2 } };
    for ( int i = 0; i < WISP_COUNT( CASES ); ++i )
    {
        wisp_seam_def def = wisp_default_seam_def();
        def.distance = CASES[i].distance;
        def.closing_speed = CASES[i].closing_speed;
        def.compliance = CASES[i].compliance;
        sewn s = open_clouds( CASES[i].iterations, 1, def, true );
        cloud c = read_cloud( &s );
        step_for( s.world, 1 );
        step_cloud( &c, &s, CASES[i].iterations, &def );
        for ( int v = 0; v < VERTICES; ++v )
        {
            // positions of 1 m, each projected up to 20 times; each rounds by 6e-8
            assert_true( double3_distance( c.at[0][v], double3_widen( point_of( s.world, s.a, v ) ) ) < 2e-6 );
            assert_true( double3_distance( c.at[1][v], double3_widen( point_of( s.world, s.b, v ) ) ) < 2e-6 );
        }
        for ( int p = 0; p < PAIRS; ++p )
        {
            const sewn_pair pair = pair_of( s.world, s.seam, rank_of( s.pairs, p ) );
            const double force = seam_oracle_force( c.pairs + p, 1.0 / 60.0 );
            assert_true( pair.vertices[0] == s.pairs[2 * p] && pair.vertices[1] == s.pairs[2 * p + 1] );
            assert_true( fabs( fabs( pair.force ) - force ) < 1e-4 + 1e-5 * force );
            assert_true( pair.broken == false );
        }
        assert_int_equal( wisp_count_broken_seam_pairs( s.world, s.seam ), 0 );
        close_sewing( s.h );
    }
}

// More pairs than colours meet at one vertex: the rest of them are projected one after another, in the order in which they are given.
TEST( a_vertex_in_many_pairs_is_that_of_the_oracle )
{
    enum
    {
        MANY = 81,
    };
    SCOPED( close_local ) hosted* h = open_sewing( 1, 1, 3 );
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( 9, 0.1f );
    int32_t pairs[2 * MANY] = { 0 };
    double3 at[MANY], centre;
    double w[MANY];
    wisp_seam_def def = wisp_default_seam_def();
    def.a = add_panel( h->world, &mesh, support_weightless_surface_def(), NULL );
    scatter_points( &mesh, 31 );
    def.b = add_panel( h->world, &mesh, support_weightless_surface_def(), NULL );
    for ( int p = 0; p < MANY; ++p )
    {
        pairs[2 * p + 1] = p;
        at[p] = double3_from( row_of( h->world, def.b, WISP_PARTICLE_POSITION, p ) );
        w[p] = (double)row_of( h->world, def.b, WISP_PARTICLE_POSITION, p )[3];
    }
    const float* first = row_of( h->world, def.a, WISP_PARTICLE_POSITION, 0 );
    const double weight = (double)first[3];
    centre = double3_from( first );
    def.pairs = pairs, def.pair_count = MANY;
    def.closing_speed = INFINITY;
    sew( h->world, &def );
    step_for( h->world, 1 );
    for ( int p = 0; p < MANY; ++p )
    {
        seam_oracle_pair pair = { .rest = 0.0 };
        seam_oracle_project( &pair, &centre, at + p, ( const double[2] ){ weight, w[p] }, 0.0 );
        assert_true( double3_distance( at[p], double3_widen( point_of( h->world, def.b, p ) ) ) < 2e-6 );
    }
    assert_true( double3_distance( centre, double3_widen( point_of( h->world, def.a, 0 ) ) ) < 2e-6 );
}

// ---- worlds ----

enum
{
    SHEET_SIDE = 7,
    SHEET_VERTICES = SHEET_SIDE * SHEET_SIDE,
};

// Two sheets of 0.3 m side by side with a gap, in the plane y = 0.
typedef struct sheets
{
    hosted* h;
    wisp_world* world;
    wisp_entity a, b;
} sheets;

static wisp_entity add_sheet( wisp_world* world, int n, float x, bool is_cloth )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( n, 0.3f / (float)( n - 1 ) );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        mesh.points[v].x += x;
    }
    const wisp_cloth_def cloth = undamped_cloth();
    return add_panel( world, &mesh, support_weightless_surface_def(), is_cloth ? &cloth : NULL );
}

static sheets open_sheets( int substeps, float gap )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_seams_module,
                                                  &wisp_implicit_cloth_module };
    sheets s = { .h = new_hosted( MODULES, WISP_COUNT( MODULES ), substeps, 1, 1 ) };
    s.world = s.h->world;
    s.a = add_sheet( s.world, SHEET_SIDE, 0.0f, true );
    s.b = add_sheet( s.world, SHEET_SIDE, 0.3f + gap, true );
    return s;
}

static wisp_seam_def edge_seam( const sheets* s )
{
    wisp_seam_def def = wisp_default_seam_def();
    def.a = s->a, def.b = s->b, def.within = 0.06f;
    return def;
}

TEST( edges_within_a_distance_are_paired )
{
    sheets s = open_sheets( 4, 0.05f );
    const wisp_seam_def def = edge_seam( &s );
    const wisp_entity seam = sew( s.world, &def );
    assert_int_equal( wisp_count_seam_pairs( s.world, seam ), SHEET_SIDE );
    for ( int j = 0; j < SHEET_SIDE; ++j )
    {
        const sewn_pair pair = pair_of( s.world, seam, j );
        assert_int_equal( pair.vertices[0], j * SHEET_SIDE + SHEET_SIDE - 1 );
        assert_int_equal( pair.vertices[1], j * SHEET_SIDE );
        assert_near( pair.opening, 0.05, 1e-7 );
        assert_true( pair.force == 0.0 );
    }
    step_for( s.world, 60 );
    for ( int j = 0; j < SHEET_SIDE; ++j )
    {
        assert_true( pair_of( s.world, seam, j ).opening < 1e-4 );
    }
    close_sewing( s.h );
}

// An edge of 13 vertices against one of 7: all of both are sewn, each pair once.
TEST( edges_of_different_resolution_are_sewn_whole )
{
    sheets s = open_sheets( 4, 0.05f );
    wisp_seam_def def = edge_seam( &s );
    def.a = add_sheet( s.world, 13, -0.35f, true );
    def.b = s.a;
    for ( int swapped = 0; swapped < 2; ++swapped )
    {
        const wisp_entity seam = sew( s.world, &def );
        const int count = wisp_count_seam_pairs( s.world, seam );
        bool fine[13] = { false }, coarse[SHEET_SIDE] = { false };
        for ( int p = 0; p < count; ++p )
        {
            const sewn_pair pair = pair_of( s.world, seam, p );
            const int f = pair.vertices[swapped] / 13, c = pair.vertices[1 - swapped] / SHEET_SIDE;
            assert_true( pair.vertices[swapped] % 13 == 12 && pair.vertices[1 - swapped] % SHEET_SIDE == 0 );
            fine[f] = coarse[c] = true;
            assert_true( abs( f - 2 * c ) <= 1 );
        }
        for ( int i = 0; i < 13; ++i )
        {
            assert_true( fine[i] && ( i >= SHEET_SIDE || coarse[i] ) );
        }
        assert_int_equal( count, 13 );
        assert_status( s.world, wisp_remove( s.world, seam ), WISP_OK );
        const wisp_entity a = def.a;
        def.a = def.b;
        def.b = a;
    }
    close_sewing( s.h );
}

TEST( surfaces_that_are_sewn_share_their_substeps )
{
    sheets s = open_sheets( 2, 0.0f );
    const wisp_entity alone = add_sheet( s.world, SHEET_SIDE, 5.0f, true );
    assert_status( s.world, wisp_set_substeps( s.world, s.b, 12 ), WISP_OK );
    const wisp_seam_def def = edge_seam( &s );
    const wisp_entity seam = sew( s.world, &def );
    step_for( s.world, 2 );
    const wisp_entity all[] = { s.a, s.b, alone };
    static const int SEWN[] = { 12, 12, 2 }, APART[] = { 2, 12, 2 };
    for ( int i = 0; i < 3; ++i )
    {
        int substeps = 0;
        assert_status( s.world, wisp_read_substeps( s.world, all[i], &substeps ), WISP_OK );
        assert_int_equal( substeps, SEWN[i] );
    }
    assert_status( s.world, wisp_remove( s.world, seam ), WISP_OK );
    step_for( s.world, 1 );
    for ( int i = 0; i < 3; ++i )
    {
        int substeps = 0;
        assert_status( s.world, wisp_read_substeps( s.world, all[i], &substeps ), WISP_OK );
        assert_int_equal( substeps, APART[i] );
    }
    close_sewing( s.h );
}

TEST( a_removed_seam_leaves_no_pass )
{
    sheets s = open_sheets( 2, 0.05f );
    step_for( s.world, 1 );
    assert_int_equal( count_passes_named( s.world, "seams.project" ), 0 );
    const wisp_seam_def def = edge_seam( &s );
    const wisp_entity first = sew( s.world, &def ), second = sew( s.world, &def );
    step_for( s.world, 1 );
    assert_int_equal( count_passes_named( s.world, "seams.project" ), 1 );
    assert_status( s.world, wisp_remove( s.world, first ), WISP_OK );
    step_for( s.world, 60 );
    assert_int_equal( count_passes_named( s.world, "seams.project" ), 1 );
    assert_true( pair_of( s.world, second, 3 ).opening < 1e-4 ); // the other one still closes
    assert_status( s.world, wisp_remove( s.world, second ), WISP_OK );
    step_for( s.world, 1 );
    assert_int_equal( count_passes_named( s.world, "seams.project" ), 0 );
    const wisp_entity third = sew( s.world, &def );
    step_for( s.world, 1 );
    assert_int_equal( count_passes_named( s.world, "seams.project" ), 1 );
    assert_true( wisp_count_seam_pairs( s.world, third ) >= SHEET_SIDE );
    assert_int_equal( wisp_count_seam_pairs( s.world, first ), 0 );
    close_sewing( s.h );
}

TEST( a_seam_whose_surface_was_removed_joins_nothing )
{
    sheets s = open_sheets( 2, 0.05f );
    const wisp_entity c = add_sheet( s.world, SHEET_SIDE, -0.35f, true );
    wisp_seam_def def = edge_seam( &s ), other = def;
    other.a = c, other.b = s.a;
    const wisp_entity seam = sew( s.world, &def ), rest = sew( s.world, &other );
    step_for( s.world, 1 );
    assert_status( s.world, wisp_remove( s.world, s.b ), WISP_OK );
    assert_int_equal( wisp_count_seam_pairs( s.world, seam ), 0 );
    assert_int_equal( wisp_count_broken_seam_pairs( s.world, seam ), 0 );
    step_for( s.world, 60 );
    assert_true( pair_of( s.world, rest, 2 ).opening < 1e-4 );
    assert_status( s.world, wisp_remove( s.world, c ), WISP_OK );
    step_for( s.world, 1 );
    assert_int_equal( count_passes_named( s.world, "seams.project" ), 0 );
    assert_status( s.world, wisp_remove( s.world, seam ), WISP_OK );
    assert_status( s.world, wisp_remove( s.world, rest ), WISP_OK );
    step_for( s.world, 1 );
    close_sewing( s.h );
}

TEST( a_surface_that_is_not_finite_halts_alone )
{
    sheets s = open_sheets( 2, 0.05f );
    const wisp_seam_def def = edge_seam( &s );
    const wisp_entity seam = sew( s.world, &def );
    step_for( s.world, 2 );
    velocity_of( s.world, s.a, SHEET_SIDE - 1 )[0] = NAN;
    step_for( s.world, 1 );
    assert_true( wisp_is_halted( s.world, s.a ) && wisp_is_halted( s.world, s.b ) == false );
    assert_true( is_finite( s.world, s.a ) && is_finite( s.world, s.b ) );
    // what is halted stands still, and the other one is sewn to it
    float before[4];
    memcpy( before, row_of( s.world, s.a, WISP_PARTICLE_POSITION, 2 * SHEET_SIDE - 1 ), sizeof before );
    step_for( s.world, 60 );
    assert_memory_equal( before, row_of( s.world, s.a, WISP_PARTICLE_POSITION, 2 * SHEET_SIDE - 1 ), sizeof before );
    assert_true( pair_of( s.world, seam, 1 ).opening < 1e-4 );
    close_sewing( s.h );
}

TEST( a_teleport_of_both_surfaces_changes_nothing_else )
{
    sheets here = open_sheets( 4, 0.05f ), there = open_sheets( 4, 0.05f );
    wisp_seam_def def = edge_seam( &here );
    def.closing_speed = 0.1f;
    sew( here.world, &def );
    def.a = there.a, def.b = there.b;
    sew( there.world, &def );
    step_for( here.world, 10 );
    step_for( there.world, 10 );
    const wisp_transform motion = { { 0.0f, 1.0f, 0.0f, 0.0f }, { 4.0f, 0.0f, 8.0f } };
    assert_status( there.world, wisp_teleport( there.world, there.a, motion, true ), WISP_OK );
    assert_status( there.world, wisp_teleport( there.world, there.b, motion, true ), WISP_OK );
    step_for( here.world, 40 );
    step_for( there.world, 40 );
    for ( int v = 0; v < SHEET_VERTICES; ++v )
    {
        const wisp_vec3 p = wisp_transform_to_world( motion, point_of( here.world, here.b, v ) );
        // 200 substeps, each of which rounds positions of 8 m by 5e-7
        assert_true( vec_distance( p, point_of( there.world, there.b, v ) ) < 1e-4 ); // digits of 8 m, 200 substeps
    }
    close_sewing( here.h );
    close_sewing( there.h );
}

TEST( implicit_cloth_is_sewn_too )
{
    sheets s = open_sheets( 4, 0.05f );
    const wisp_entity other = add_sheet( s.world, SHEET_SIDE, -0.35f, false );
    const wisp_implicit_cloth_def cloth = linked_def();
    assert_status( s.world, wisp_set_implicit_cloth( s.world, other, &cloth ), WISP_OK );
    wisp_seam_def def = edge_seam( &s );
    def.a = other, def.b = s.a;
    const wisp_entity seam = sew( s.world, &def );
    step_for( s.world, 120 );
    float speed = 0.0f;
    for ( int v = 0; v < SHEET_VERTICES; ++v )
    {
        speed = fmaxf( speed, fabsf( velocity_of( s.world, other, v )[0] ) );
    }
    assert_true( speed < 0.5f );
    for ( int j = 0; j < SHEET_SIDE; ++j )
    {
        assert_true( pair_of( s.world, seam, j ).opening < 1e-3 );
    }
    assert_true( fabsf( point_of( s.world, other, 0 ).x + 0.35f ) > 0.01f ); // the whole sheet was pulled along
    close_sewing( s.h );
}

TEST( what_cannot_be_is_refused )
{
    sheets s = open_sheets( 4, 0.05f );
    wisp_entity out;
    int32_t pairs[] = { 1, 2, 3, 4 };
    const wisp_entity none = { 0, 0 };
    step_for( s.world, 1 );
    const uint64_t before = wisp_world_hash( s.world );
#define REFUSED( status, words, ... )                                                                                \
    {                                                                                                                \
        wisp_seam_def d = edge_seam( &s );                                                                           \
        __VA_ARGS__;                                                                                                 \
        out = s.a;                                                                                                   \
        expect_refusal( s.world, wisp_add_seam( s.world, &d, &out ), status, words );                                \
        assert_true( out.index == 0 );                                                                               \
        assert_true( wisp_world_hash( s.world ) == before );                                                         \
    }
    REFUSED( WISP_BAD_INPUT, "within 0.01 m of", d.within = 0.01f )
    REFUSED( WISP_BAD_INPUT, "expected one of the two", d.pairs = pairs; d.pair_count = 2 )
    REFUSED( WISP_BAD_INPUT, "got 0 pairs", d.within = 0.0f )
    REFUSED( WISP_BAD_INPUT, "pairs", d.within = 0.0f; d.pair_count = 2 )
    REFUSED( WISP_BAD_INPUT, "pairs", d.within = 0.0f; d.pairs = pairs; d.pair_count = -2 )
    REFUSED( WISP_CONFLICT, "twice", d.b = s.a )
    REFUSED( WISP_STALE_ID, "entity 0", d.a = none )
    pairs[3] = SHEET_VERTICES;
    REFUSED( WISP_BAD_INPUT, "pair 1: got vertex 49 of surface b, which has 49 vertices", d.within = 0.0f;
             d.pairs = pairs; d.pair_count = 2 )
    pairs[2] = -1;
    REFUSED( WISP_BAD_INPUT, "pair 1: got vertex -1 of surface a", d.within = 0.0f; d.pairs = pairs;
             d.pair_count = 2 )
    pairs[1] = 1;
    REFUSED( WISP_BAD_INPUT, "pair 0: got vertex 1 twice", d.within = 0.0f; d.b = s.a; d.pairs = pairs;
             d.pair_count = 1 )
#undef REFUSED
    const wisp_seam_def def = edge_seam( &s );
    expect_refusal( s.world, wisp_add_seam( s.world, &def, NULL ), WISP_BAD_INPUT, "out" );
    const wisp_entity seam = sew( s.world, &def );
    wisp_seam_def nested = def;
    nested.b = seam;
    expect_refusal( s.world, wisp_add_seam( s.world, &nested, &out ), WISP_CONFLICT, "surface" );
    assert_int_equal( wisp_count_seam_pairs( NULL, seam ), 0 );
    assert_int_equal( wisp_count_broken_seam_pairs( s.world, s.a ), 0 );
    close_sewing( s.h );
}
