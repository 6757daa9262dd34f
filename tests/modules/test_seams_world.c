// Seams in worlds: boundaries that are found, substeps, removal, halted surfaces, teleports, implicit cloth, refusals, memory.
#include "seam_fixture.h"

#include "implicit_cloth.h"
#include "oracle/double3.h"

enum
{
    SIDE = 7,
    VERTICES = SIDE * SIDE,
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
    test_mesh mesh = test_plane( n, 0.3f / (float)( n - 1 ) );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        mesh.points[v].x += x;
    }
    const wisp_cloth_def cloth = wisp_default_cloth_def();
    const wisp_entity e = add_panel( world, &mesh, support_weightless_surface_def(), is_cloth ? &cloth : NULL );
    test_mesh_free( &mesh );
    return e;
}

static sheets open_sheets( int substeps, float gap )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_seams_module,
                                                  &wisp_implicit_cloth_module };
    sheets s = { .h = new_hosted( MODULES, WISP_COUNT( MODULES ), substeps, 1, 1 ) };
    s.world = s.h->world;
    s.a = add_sheet( s.world, SIDE, 0.0f, true );
    s.b = add_sheet( s.world, SIDE, 0.3f + gap, true );
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
    assert_int_equal( wisp_count_seam_pairs( s.world, seam ), SIDE );
    for ( int j = 0; j < SIDE; ++j )
    {
        const sewn_pair pair = pair_of( s.world, seam, j );
        assert_int_equal( pair.vertices[0], j * SIDE + SIDE - 1 );
        assert_int_equal( pair.vertices[1], j * SIDE );
        assert_near( pair.opening, 0.05, 1e-7 );
        assert_true( pair.force == 0.0 );
    }
    step_for( s.world, 60 );
    for ( int j = 0; j < SIDE; ++j )
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
        bool fine[13] = { false }, coarse[SIDE] = { false };
        for ( int p = 0; p < count; ++p )
        {
            const sewn_pair pair = pair_of( s.world, seam, p );
            const int f = pair.vertices[swapped] / 13, c = pair.vertices[1 - swapped] / SIDE;
            assert_true( pair.vertices[swapped] % 13 == 12 && pair.vertices[1 - swapped] % SIDE == 0 );
            fine[f] = coarse[c] = true;
            assert_true( abs( f - 2 * c ) <= 1 );
        }
        for ( int i = 0; i < 13; ++i )
        {
            assert_true( fine[i] && ( i >= SIDE || coarse[i] ) );
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
    const wisp_entity alone = add_sheet( s.world, SIDE, 5.0f, true );
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
    assert_true( wisp_count_seam_pairs( s.world, third ) >= SIDE );
    assert_int_equal( wisp_count_seam_pairs( s.world, first ), 0 );
    close_sewing( s.h );
}

TEST( a_seam_whose_surface_was_removed_joins_nothing )
{
    sheets s = open_sheets( 2, 0.05f );
    const wisp_entity c = add_sheet( s.world, SIDE, -0.35f, true );
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
    velocity_of( s.world, s.a, SIDE - 1 )[0] = NAN;
    step_for( s.world, 1 );
    assert_true( wisp_is_halted( s.world, s.a ) && wisp_is_halted( s.world, s.b ) == false );
    assert_true( is_finite( s.world, s.a ) && is_finite( s.world, s.b ) );
    // what is halted stands still, and the other one is sewn to it
    float before[4];
    memcpy( before, row_of( s.world, s.a, WISP_PARTICLE_POSITION, 2 * SIDE - 1 ), sizeof before );
    step_for( s.world, 60 );
    assert_memory_equal( before, row_of( s.world, s.a, WISP_PARTICLE_POSITION, 2 * SIDE - 1 ), sizeof before );
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
    for ( int v = 0; v < VERTICES; ++v )
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
    const wisp_entity other = add_sheet( s.world, SIDE, -0.35f, false );
    const wisp_implicit_cloth_def implicit = wisp_default_implicit_cloth_def();
    assert_status( s.world, wisp_set_implicit_cloth( s.world, other, &implicit ), WISP_OK );
    wisp_seam_def def = edge_seam( &s );
    def.a = other, def.b = s.a;
    const wisp_entity seam = sew( s.world, &def );
    step_for( s.world, 120 );
    float speed = 0.0f;
    for ( int v = 0; v < VERTICES; ++v )
    {
        speed = fmaxf( speed, fabsf( velocity_of( s.world, other, v )[0] ) );
    }
    assert_true( speed < 0.5f );
    for ( int j = 0; j < SIDE; ++j )
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
    REFUSED( WISP_BAD_INPUT, "within", d.within = NAN )
    REFUSED( WISP_BAD_INPUT, "within", d.within = -1.0f )
    REFUSED( WISP_BAD_INPUT, "distance", d.distance = -1.0f )
    REFUSED( WISP_BAD_INPUT, "closing_speed", d.closing_speed = 0.0f )
    REFUSED( WISP_BAD_INPUT, "compliance", d.compliance = INFINITY )
    REFUSED( WISP_BAD_INPUT, "strength", d.strength = 0.0f )
    REFUSED( WISP_BAD_INPUT, "strength", d.strength = NAN )
    REFUSED( WISP_BAD_INPUT, "within 0.01 m of", d.within = 0.01f )
    REFUSED( WISP_BAD_INPUT, "expected one of the two", d.pairs = pairs; d.pair_count = 2 )
    REFUSED( WISP_BAD_INPUT, "got 0 pairs", d.within = 0.0f )
    REFUSED( WISP_BAD_INPUT, "pairs", d.within = 0.0f; d.pair_count = 2 )
    REFUSED( WISP_BAD_INPUT, "pairs", d.within = 0.0f; d.pairs = pairs; d.pair_count = -2 )
    REFUSED( WISP_CONFLICT, "twice", d.b = s.a )
    REFUSED( WISP_STALE_ID, "entity 0", d.a = none )
    pairs[3] = VERTICES;
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

TEST( a_host_without_memory_gets_no_seam_and_loses_nothing )
{
    int refused = 0;
    for ( int64_t n = 1; n < 100; ++n )
    {
        sheets s = open_sheets( 2, 0.05f );
        const wisp_seam_def def = edge_seam( &s );
        wisp_entity seam;
        const uint64_t hash = wisp_world_hash( s.world );
        test_host_refuse( &s.h->host, n, true );
        const wisp_status status = wisp_add_seam( s.world, &def, &seam );
        const bool was_refused = test_host_has_refused( &s.h->host );
        test_host_refuse( &s.h->host, 0, false );
        assert_int_equal( status, was_refused ? WISP_NO_MEMORY : WISP_OK );
        if ( was_refused )
        {
            assert_true( seam.index == 0 && wisp_world_hash( s.world ) == hash );
            seam = sew( s.world, &def );
        }
        step_for( s.world, 2 );
        const int64_t queried = atomic_load( &s.h->host.queried );
        step_for( s.world, 3 );
        assert_true( atomic_load( &s.h->host.queried ) == queried ); // a warm step allocates nothing
        assert_int_equal( wisp_count_seam_pairs( s.world, seam ), SIDE );
        close_sewing( s.h ); // and checks that all memory is released
        refused += was_refused ? 1 : 0;
        if ( was_refused == false )
        {
            break;
        }
    }
    assert_true( refused > 5 && refused < 99 );
}
