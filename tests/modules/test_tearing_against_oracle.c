// Which edge tears, at which end and where, against the oracle: irregular sheets are pulled apart, one split a step.
#include "tearing_fixture.h"
#include "engine/pass_hook.h"

#include "oracle/tearing_oracle.h"

enum
{
    SIDE = 9,
    SPARES = 60,
    VERTICES = SIDE * SIDE + SPARES,
    TRIANGLES = 2 * ( SIDE - 1 ) * ( SIDE - 1 ),
    STEPS = 120,
};

static const double STRENGTH = 30.0; // N/m

// An edge and its force, as they were before the split.
typedef struct pulled_edge
{
    int a, b; // the user's order, a < b
    double force, tension;
} pulled_edge;

typedef struct sheet
{
    hosted* h;
    wisp_world* world;
    wisp_entity e;
    pulled_edge edges[3 * TRIANGLES];
    int edge_count;
    double inverse_dt2;
    pass_hook hook;
} sheet;

// Read the multipliers behind the pass, before the step ends with a split.
static void read_forces( void* user )
{
    sheet* s = user;
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

static sheet* open_sheet( int seed )
{
    sheet* s = checked_calloc( 1, sizeof( sheet ) );
    s->h = open_tearing( 2, 4, 1 );
    s->world = s->h->world;
    s->inverse_dt2 = 120.0 * 120.0;
    test_mesh mesh = hanging_mesh( SIDE, SIDE, 0.1f, 0.1f );
    int32_t pins[2 * SIDE];
    for ( int v = 0; v < SIDE * SIDE; ++v )
    {
        mesh.points[v].x += test_random_float( seed, 2 * v, -0.02f, 0.02f );
        mesh.points[v].y += test_random_float( seed, 2 * v + 1, -0.02f, 0.02f );
    }
    for ( int i = 0; i < SIDE; ++i )
    {
        pins[i] = i;
        pins[SIDE + i] = SIDE * ( SIDE - 1 ) + i;
    }
    add_spares( &mesh, SPARES );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = wisp_default_surface_def();
    surface.pins = pins, surface.pin_count = 2 * SIDE, surface.spare_count = SPARES;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.warp_compliance = cloth.weft_compliance = 1e-3f, cloth.shear_compliance = 2e-3f;
    s->e = add_cloth( s->world, &fabric, surface, &cloth, EARTH );
    s->hook = ( pass_hook ){ .after = read_forces, .user = s };
    pass_hook_set( s->world, "tearing.measure", &s->hook );
    test_mesh_free( &mesh );
    return s;
}

static int compare( const void* left, const void* right )
{
    const pulled_edge *a = left, *b = right;
    return a->tension > b->tension ? -1 : a->tension < b->tension ? 1 : 0;
}

static bool is_pinned( const sheet* s, int vertex )
{
    (void)s;
    return vertex < SIDE || ( vertex >= SIDE * ( SIDE - 1 ) && vertex < SIDE * SIDE );
}

// Vertices that a cut takes: the new one, and one for each end at the rim whose triangles part.
static int count_new( const sheet* s, const tearing_oracle_mesh* mesh, const tearing_oracle_cut* cut )
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
static bool predict( const sheet* s, const tearing_oracle_mesh* mesh, pulled_edge* edges, int max_splits, int* vertex,
                     bool* leaves )
{
    for ( int i = 0; i < s->edge_count && edges[i].tension > STRENGTH; ++i )
    {
        bool both[2][TRIANGLES];
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
static int compare_step( sheet* s, int max_splits, bool* is_torn )
{
    wisp_tearing_def def = wisp_default_tearing_def();
    def.strength = (float)STRENGTH, def.max_splits = max_splits;
    assert_status( s->world, wisp_set_tearing( s->world, s->e, &def ), WISP_OK );
    int32_t* before = read_triangles( s->world, s->e, TRIANGLES );
    const wisp_fabric* f = wisp_world_fabric( s->world, s->e );
    double rest[VERTICES][2];
    for ( int v = 0; v < VERTICES; ++v )
    {
        rest[v][0] = (double)f->rest[f->vertex_slot[v]].x;
        rest[v][1] = (double)f->rest[f->vertex_slot[v]].y;
    }
    assert_status( s->world, wisp_world_step( s->world, 1.0f / 60.0f ), WISP_OK );
    const tearing_oracle_mesh mesh = { ( const double( * )[2] )(const void*)rest,
                                       ( const int32_t( * )[3] )(const void*)before, TRIANGLES };
    double largest = 0.0;
    int over = 0;
    for ( int i = 0; i < s->edge_count; ++i )
    {
        s->edges[i].tension = tearing_oracle_tension( &mesh, s->edges[i].a, s->edges[i].b, s->edges[i].force );
        largest = fmax( largest, s->edges[i].tension );
        over += s->edges[i].tension > STRENGTH ? 1 : 0;
    }
    qsort( s->edges, (size_t)s->edge_count, sizeof( *s->edges ), compare );
    const wisp_tearing_stats stats = tearing_stats_of( s->world, s->e );
    assert_true( fabs( (double)stats.max_load * STRENGTH - largest ) <= 1e-5 * largest ); // rounding of widths
    assert_int_equal( stats.over_count, over );
    int vertex = -1, moved = 0;
    bool leaves[TRIANGLES];
    const bool tears = predict( s, &mesh, s->edges, max_splits, &vertex, leaves );
    int32_t* after = read_triangles( s->world, s->e, TRIANGLES );
    for ( int i = 0; i < 3 * TRIANGLES; ++i )
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
    free( before );
    free( after );
    return tears ? 1 : 0;
}

static int count_spares( const sheet* s )
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
        sheet* s = open_sheet( seed );
        bool is_torn = false;
        for ( int step = 0; step < STEPS && count_spares( s ) >= 3; ++step )
        {
            int32_t pins[SIDE];
            wisp_vec3 targets[SIDE];
            for ( int i = 0; i < SIDE; ++i ) // the lower edge goes down at 0.3 m/s
            {
                pins[i] = SIDE * ( SIDE - 1 ) + i;
                targets[i] =
                    step == 0 ? ( wisp_vec3 ){ 0.1f * (float)i, -0.8f, 0.0f } : point_of( s->world, s->e, pins[i] );
                targets[i].y -= 0.005f;
            }
            assert_status( s->world, wisp_move_pins( s->world, s->e, pins, targets, SIDE ), WISP_OK );
            compared += compare_step( s, step % 2 == 0 ? 1 : 3, &is_torn );
        }
        assert_true( is_torn );
        assert_sound_fabric( s->world, s->e );
        close_tearing( s->h );
        free( s );
    }
    printf( "%d splits compared\n", compared );
    assert_true( compared > 60 );
}
