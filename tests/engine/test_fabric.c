// Fabrics: cooked data equal brute force on the triangles, and parallel work shares no slots.
#include "fabric_fixture.h"

typedef struct test_case
{
    const char* name;
    test_mesh mesh;
} test_case;

#define CASE_COUNT 12

static void make_cases( test_case* cases )
{
    const test_case made[CASE_COUNT] = {
        { "nothing", test_mesh_make( 0, 0 ) },
        { "unreferenced vertices alone", test_mesh_make( 70, 0 ) },
        { "one triangle", test_mesh_fan( 3 ) },
        { "a plane of one row", test_mesh_plane( 40, 2 ) },
        { "a plane", test_mesh_plane( 33, 20 ) },
        { "a large plane", test_mesh_plane( 100, 90 ) },
        { "a sphere", test_mesh_sphere( 20, 30 ) },
        { "a sphere with crowded poles", test_mesh_sphere( 9, 200 ) },
        { "a Moebius strip", test_mesh_moebius( 41, 4 ) },
        { "a book of three pages", test_mesh_book( 3 ) },
        { "a book of nine pages", test_mesh_book( 9 ) },
        { "a fan of many spokes", test_mesh_fan( 700 ) },
    };
    memcpy( cases, made, sizeof( made ) );
    cases[2].mesh.triangle_count = 1;
}

static void free_cases( test_case* cases )
{
    for ( int i = 0; i < CASE_COUNT; ++i )
    {
        test_mesh_free( &cases[i].mesh );
    }
}

TEST( every_mesh_becomes_the_fabric_that_brute_force_expects )
{
    test_case cases[CASE_COUNT];
    make_cases( cases );
    for ( int i = 0; i < CASE_COUNT; ++i )
    {
        for ( int variant = 0; variant < 16; ++variant )
        {
            wisp_fabric_def def = test_fabric_def( &cases[i].mesh );
            int32_t attachments[] = { def.vertex_count / 2, 0, def.vertex_count / 2 };
            def.solve_order = ( variant & 1 ) != 0 ? WISP_SOLVE_ORDER_LIST : WISP_SOLVE_ORDER_COLOUR;
            def.hinges = ( variant & 2 ) != 0;
            def.bend_links = ( variant & 4 ) == 0;
            def.tile_size = ( variant & 8 ) != 0 ? 64 : 0;
            def.attachments = attachments;
            def.attachment_count = ( variant & 2 ) != 0 && def.vertex_count > 0 ? 3 : 0;
            def.tethers = ( variant & 4 ) != 0;
            def.coarse_sheets = ( variant & 9 ) == 9;
            SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
            assert_fabric_holds( fabric, &def );
            assert_true( wisp_fabric_bytes( fabric ) > sizeof( wisp_fabric ) );
        }
    }
    free_cases( cases );
}

TEST( a_lean_fabric_makes_the_same_arrays_when_they_are_needed )
{
    test_case cases[CASE_COUNT];
    make_cases( cases );
    for ( int i = 0; i < CASE_COUNT; ++i )
    {
        wisp_fabric_def def = test_fabric_def( &cases[i].mesh );
        SCOPED( fabric_local ) wisp_fabric* whole = test_fabric_cook( &def );
        def.lean = true;
        SCOPED( fabric_local ) wisp_fabric* lean = test_fabric_cook( &def );
        assert_null( lean->edges );
        assert_null( lean->ring_begin );
        assert_null( lean->ring_x4 );
        assert_null( lean->hinges );
        assert_null( lean->link_order.constraint );
        assert_true( lean->hash == whole->hash );
        assert_true( wisp_fabric_bytes( lean ) < wisp_fabric_bytes( whole ) );
        assert_int_equal( wisp_fabric_need( lean, WISP_FABRIC_EDGES ), WISP_OK );
        assert_non_null( lean->edges );
        assert_null( lean->ring_begin );
        const int32_t* edges = lean->edges;
        assert_int_equal( wisp_fabric_need( lean, WISP_FABRIC_EDGES | WISP_FABRIC_RINGS ), WISP_OK );
        assert_null( lean->hinges );
        assert_int_equal( wisp_fabric_need( lean, WISP_FABRIC_EDGES | WISP_FABRIC_HINGES ), WISP_OK );
        assert_ptr_equal( lean->edges, edges );
        assert_memory_equal( lean->edges, whole->edges, 2 * (size_t)whole->edge_count * sizeof( int32_t ) );
        const size_t slices = (size_t)whole->ring_slice_count + 1;
        assert_memory_equal( lean->ring_begin, whole->ring_begin, slices * sizeof( int32_t ) );
        assert_memory_equal( lean->ring_x4, whole->ring_x4,
                             (size_t)whole->ring_begin[slices - 1] * sizeof( *whole->ring_x4 ) );
        assert_memory_equal( lean->hinges, whole->hinges, 4 * (size_t)whole->hinge_count * sizeof( int32_t ) );
        assert_memory_equal( lean->link_order.constraint, whole->link_order.constraint,
                             (size_t)whole->link_order.slot_count * sizeof( int32_t ) );
        assert_int_equal( wisp_fabric_bytes( lean ), wisp_fabric_bytes( whole ) );
    }
    free_cases( cases );
}

// Sums of squares of sums tell triangles apart whatever their order.
static uint64_t triangle_word( const int32_t* v )
{
    const uint64_t a = (uint64_t)v[0] + 1, b = (uint64_t)v[1] + 1, c = (uint64_t)v[2] + 1;
    return ( a + b + c ) * ( a * a + b * b + c * c ) * ( a * b * c + 7 );
}

TEST( strips_have_every_triangle_once )
{
    test_case cases[CASE_COUNT];
    make_cases( cases );
    for ( int i = 0; i < CASE_COUNT; ++i )
    {
        wisp_fabric_def def = test_fabric_def( &cases[i].mesh );
        SCOPED( fabric_local ) wisp_fabric* f = test_fabric_cook( &def );
        assert_int_equal( wisp_fabric_need( f, WISP_FABRIC_STRIPS ), WISP_OK );
        uint64_t left = 0;
        for ( int t = 0; t < f->triangle_count; ++t )
        {
            left += triangle_word( f->triangles + 3 * (size_t)t );
        }
        for ( int lane = 0; lane < 8; ++lane )
        {
            int32_t v[3] = { f->vertex_count, f->vertex_count, 0 };
            for ( int step = 0; step < f->strips.order.slot_count; ++step )
            {
                const int flags = f->strips.flags[step] >> lane, stays = flags >> 8 & 1;
                v[2] = f->strips.next_x4[step][lane] / 4;
                left -= ( flags & 1 ) != 0 ? triangle_word( v ) : 0;
                assert_true( f->strips.leaving_x4[step][lane] == 4 * v[stays] || v[stays] >= f->vertex_count );
                v[0] = v[1 - stays], v[1] = v[2];
            }
            assert_true( v[0] >= f->vertex_count && v[1] >= f->vertex_count );
        }
        assert_true( left == 0 );
    }
    free_cases( cases );
}

// Of every fabric: nothing has them before.
TEST( spans_of_hinges_are_squared_distances )
{
    test_case cases[CASE_COUNT];
    make_cases( cases );
    for ( int i = 0; i < CASE_COUNT; ++i )
    {
        wisp_fabric_def def = test_fabric_def( &cases[i].mesh );
        def.hinges = true;
        SCOPED( fabric_local ) wisp_fabric* f = test_fabric_cook( &def );
        const size_t bytes = wisp_fabric_bytes( f );
        assert_null( f->hinge_span2 );
        assert_int_equal( wisp_fabric_need( f, WISP_FABRIC_SPANS ), WISP_OK );
        assert_true( wisp_fabric_bytes( f ) >= bytes + (size_t)f->hinge_order.slot_count * sizeof( float ) );
        for ( int slot = 0; slot < f->hinge_order.slot_count; ++slot )
        {
            const int hinge = f->hinge_order.constraint[slot];
            const int32_t* corner = f->hinges + 4 * (size_t)( hinge >= 0 ? hinge : 0 );
            const double span = hinge >= 0 ? vec_distance( f->rest[corner[2]], f->rest[corner[3]] ) : 0.0;
            assert_true( fabs( (double)f->hinge_span2[slot] - span * span ) <= 1e-6 * span * span );
        }
    }
    free_cases( cases );
}

TEST( shuffled_meshes_hold_as_well )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_sphere( 20, 30 );
    test_mesh_shuffle( &mesh );
    wisp_fabric_def def = test_fabric_def( &mesh );
    def.hinges = true;
    def.tile_size = 64;
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
    assert_fabric_holds( fabric, &def );
}

TEST( a_plane_has_the_edges_that_counting_gives )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_plane( 30, 20 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );

    // along, across, diagonal; the border is a loop around
    assert_int_equal( fabric->edge_count, 29 * 20 + 30 * 19 + 29 * 19 );
    assert_int_equal( fabric->open_edge_count, 2 * ( 29 + 19 ) );
    assert_int_equal( fabric->nonmanifold_edge_count, 0 );
    assert_int_equal( fabric->link_count, fabric->edge_count + fabric->hinge_count );
}

TEST( a_sphere_has_no_border_and_eulers_number_two )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_sphere( 12, 17 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
    assert_int_equal( fabric->open_edge_count, 0 );
    assert_int_equal( fabric->hinge_count, fabric->edge_count );
    assert_int_equal( fabric->vertex_count - fabric->edge_count + fabric->triangle_count, 2 );
}

TEST( a_moebius_strip_is_wild_only_along_its_seam )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_moebius( 41, 4 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );

    // three edges across the band, where both sides run the same way; one border that goes round twice
    assert_int_equal( fabric->nonmanifold_edge_count, 3 );
    assert_int_equal( fabric->open_edge_count, 2 * 41 );
}

TEST( the_spine_of_a_book_is_wild_and_has_no_hinge )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_book( 3 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
    assert_int_equal( fabric->edge_count, 7 );
    assert_int_equal( fabric->nonmanifold_edge_count, 1 );
    assert_int_equal( fabric->hinge_count, 0 );
    assert_int_equal( fabric->open_edge_count, 6 );
}

TEST( two_triangles_back_to_back_have_hinges_but_no_bend_links )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_make( 3, 2 );
    int next = 0;
    mesh.points[1].x = mesh.points[2].y = 1.0f;
    test_mesh_triangle( &mesh, &next, 0, 1, 2 );
    test_mesh_triangle( &mesh, &next, 0, 2, 1 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    def.hinges = true;
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
    assert_int_equal( fabric->hinge_count, 3 );
    assert_int_equal( fabric->link_count, 3 );
    assert_fabric_holds( fabric, &def );
}

TEST( loose_vertices_stand_at_the_end_even_when_attached )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_make( 10, 1 );
    int next = 0;
    mesh.points[4].x = mesh.points[8].y = 1.0f;
    test_mesh_triangle( &mesh, &next, 2, 4, 8 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    int32_t attachments[] = { 1, 8 };
    def.attachments = attachments;
    def.attachment_count = 2;
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
    assert_int_equal( fabric->vertex_slot[8], 0 );
    assert_true( fabric->vertex_slot[1] >= 3 );
    assert_int_equal( fabric->attachment_count, 2 );
    assert_int_equal( fabric->attachments[0], fabric->vertex_slot[1] );
    assert_int_equal( fabric->attachments[1], 0 );
}

// Steps along edges from the attachments, by relaxing all edges until nothing changes.
static void measure_steps( const wisp_fabric* f, int* steps )
{
    bool changed = true;
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        steps[v] = 1 << 20;
    }
    for ( int i = 0; i < f->attachment_count; ++i )
    {
        steps[f->attachments[i]] = 0;
    }
    while ( changed )
    {
        changed = false;
        for ( int e = 0; e < 2 * f->edge_count; ++e )
        {
            int a = f->edges[e], b = f->edges[e ^ 1];
            changed = changed || steps[a] > steps[b] + 1;
            steps[a] = steps[a] > steps[b] + 1 ? steps[b] + 1 : steps[a];
        }
    }
}

TEST( the_order_sweeps_away_from_the_attachments )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_plane( 30, 25 );
    test_mesh_shuffle( &mesh );
    wisp_fabric_def def = test_fabric_def( &mesh );
    int32_t attachments[] = { 17, 400, 3, 17 };
    def.attachments = attachments;
    def.attachment_count = 4;
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
    SCOPED( free_local ) int* steps = calloc( (size_t)fabric->vertex_count, sizeof( int ) );
    measure_steps( fabric, steps );
    assert_int_equal( fabric->attachment_count, 3 );
    for ( int i = 0; i < 3; ++i )
    {
        assert_int_equal( fabric->vertex_slot[attachments[i]], i );
    }
    for ( int s = 1; s < fabric->vertex_count; ++s )
    {
        assert_true( steps[s] >= steps[s - 1] );
    }
}

TEST( components_come_one_after_another_attached_ones_first )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_make( 3 * 200, 3 * 200 );
    for ( int v = 0; v < 600; ++v )
    {
        mesh.points[v].x = (float)test_random( v, 0, 1000 );
    }
    int next = 0;
    for ( int t = 0; t < 198; ++t )
    {
        // three strips, their vertices interleaved
        for ( int strip = 0; strip < 3; ++strip )
        {
            test_mesh_triangle( &mesh, &next, 3 * t + strip, 3 * t + strip + 3, 3 * t + strip + 6 );
        }
    }
    mesh.triangle_count = next;
    wisp_fabric_def def = test_fabric_def( &mesh );
    int32_t attachment = 599;
    def.attachments = &attachment;
    def.attachment_count = 1;
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
    for ( int s = 0; s < 600; ++s )
    {
        static const int strip_of_part[] = { 2, 0, 1 };
        assert_int_equal( fabric->slot_vertex[s] % 3, strip_of_part[s / 200] );
    }
    assert_int_equal( fabric->vertex_slot[599], 0 );
}

// Neighbours around one of the user's vertices, in the user's numbering.
static void assert_fan( const wisp_fabric* f, int vertex, const int* expected, int count )
{
    int slot = f->vertex_slot[vertex];
    for ( int e = 0; e < count; ++e )
    {
        assert_int_equal( f->slot_vertex[test_ring_slot( f, slot, e )], expected[e] );
    }
    assert_int_equal( test_ring_slot( f, slot, count ), slot );
}

TEST( fans_begin_at_borders_or_with_the_users_first_triangle )
{
    // around vertex 0 a closed fan, and an open one whose triangles come in the wrong order
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_make( 7, 5 );
    static const int corners[5][3] = { { 0, 2, 3 }, { 0, 5, 6 }, { 0, 1, 2 }, { 3, 1, 0 }, { 4, 5, 0 } };
    int next = 0;
    for ( int t = 0; t < 5; ++t )
    {
        test_mesh_triangle( &mesh, &next, corners[t][0], corners[t][1], corners[t][2] );
    }
    wisp_fabric_def def = test_fabric_def( &mesh );
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
    assert_fan( fabric, 0, ( const int[] ){ 4, 5, 6, 0, 2, 3, 1, 2 }, 8 );
    assert_fan( fabric, 1, ( const int[] ){ 2, 0, 3 }, 3 );
    assert_fan( fabric, 5, ( const int[] ){ 6, 0, 4 }, 3 );
}

TEST( a_shuffled_plane_is_ordered_as_narrow_as_its_rings )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_plane( 40, 40 );
    test_mesh_shuffle( &mesh );
    wisp_fabric_def def = test_fabric_def( &mesh );
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
    int shuffled = 0;
    for ( int i = 0; i < 3 * mesh.triangle_count; ++i )
    {
        int reach = abs( mesh.triangles[i] - mesh.triangles[i - i % 3 + ( i + 1 ) % 3] );
        shuffled = reach > shuffled ? reach : shuffled;
    }

    // a ring around a corner has at most two sides of the square, and an edge is at most as long as the distance to
    // the next ring
    assert_true( test_bandwidth( fabric ) <= 2 * ( 40 + 40 ) );
    assert_true( test_bandwidth( fabric ) < shuffled / 8 );
}

TEST( the_same_mesh_has_the_same_hash_and_another_has_another )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_sphere( 20, 30 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    def.hinges = true;
    SCOPED( fabric_local ) wisp_fabric* first = test_fabric_cook( &def );
    SCOPED( fabric_local ) wisp_fabric* second = test_fabric_cook( &def );
    assert_true( first->hash == second->hash );
    mesh.points[5].x += 0.25f;
    SCOPED( fabric_local ) wisp_fabric* moved = test_fabric_cook( &def );
    assert_true( first->hash != moved->hash );
    def.solve_order = WISP_SOLVE_ORDER_LIST;
    SCOPED( fabric_local ) wisp_fabric* swept = test_fabric_cook( &def );
    assert_true( moved->hash != swept->hash );
}

TEST( there_are_at_least_four_tiles_unless_they_would_be_smaller_than_256 )
{
    static const struct
    {
        int vertices, tile_size, tiles;
    } cases[] = {
        { 3 * 1024 + 1, 1024, 4 }, { 3 * 1024, 512, 6 }, { 3 * 512 + 1, 512, 4 }, { 3 * 512, 256, 6 }, { 300, 256, 2 }
    };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_make( cases[i].vertices, 0 );
        wisp_fabric_def def = test_fabric_def( &mesh );
        SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
        assert_int_equal( fabric->tile_size, cases[i].tile_size );
        assert_int_equal( fabric->tile_count, cases[i].tiles );
    }
}

TEST( what_hangs_on_an_attachment_comes_last_in_its_tile )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_plane( 20, 20 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    const int32_t corners[2] = { 0, 19 };
    def.attachments = corners;
    def.attachment_count = 2;
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
    const wisp_schedule* order = &fabric->link_order;
    for ( int tile = 0; tile < order->tile_count; ++tile )
    {
        bool seen = false;
        for ( int group = order->tile_begin[tile] / 8; group < order->tile_begin[tile + 1] / 8; ++group )
        {
            bool attached = false;
            for ( int slot = 8 * group; slot < 8 * group + 8; ++slot )
            {
                bool real = order->constraint[slot] >= 0;
                attached = attached || ( real && ( fabric->link_a_x4[slot] < 8 || fabric->link_b_x4[slot] < 8 ) );
            }
            assert_false( seen && attached == false );
            seen = seen || attached;
        }
    }
}

TEST( cloth_wastes_few_lanes_and_crowded_poles_few_more )
{
    test_mesh meshes[] = { test_mesh_plane( 128, 128 ), test_mesh_plane( 64, 64 ), test_mesh_sphere( 60, 200 ) };
    for ( int i = 0; i < 3; ++i )
    {
        for ( int solve_order = 0; solve_order < WISP_SOLVE_ORDER_COUNT; ++solve_order )
        {
            wisp_fabric_def def = test_fabric_def( &meshes[i] );
            def.solve_order = (wisp_solve_order)solve_order;
            SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
            double fill = (double)fabric->link_count / fabric->link_order.slot_count;

            // cloth requires 0.93; a list closes groups early around a pole, one spoke per group
            assert_true( fill > ( i == 2 && solve_order == WISP_SOLVE_ORDER_LIST ? 0.85 : 0.93 ) );
        }
        test_mesh_free( &meshes[i] );
    }
}

TEST( without_tiles_a_colour_is_a_tile_that_shares_no_vertex )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_sphere( 9, 200 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
    SCOPED( fabric_pool_release ) fabric_pool keep = { 0 };
    wisp_schedule schedule;
    fabric_constraints constraints = {
        .slots = fabric->edges, .count = fabric->edge_count, .arity = 2, .vertex_count = fabric->vertex_count
    };
    assert_true( fabric_schedule_build( &constraints, &keep, &keep, &schedule ) );
    assert_int_equal( schedule.colour_count, schedule.tile_count );
    SCOPED( free_local ) int32_t* colour = calloc( (size_t)fabric->vertex_count, sizeof( int32_t ) );
    int found = 0;
    for ( int tile = 0; tile < schedule.tile_count; ++tile )
    {
        for ( int i = schedule.tile_begin[tile]; i < schedule.tile_begin[tile + 1]; ++i )
        {
            for ( int k = 0; k < 2 && schedule.constraint[i] >= 0; ++k )
            {
                int32_t slot = fabric->edges[2 * schedule.constraint[i] + k];
                assert_true( colour[slot] <= tile );
                colour[slot] = tile + 1;
                found += k;
            }
        }
    }
    assert_int_equal( found, fabric->edge_count );
}

TEST( triangles_without_area_keep_their_edges )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_make( 3, 1 );
    int next = 0;
    test_mesh_triangle( &mesh, &next, 0, 1, 2 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    SCOPED( fabric_local ) wisp_fabric* fabric = test_fabric_cook( &def );
    assert_int_equal( fabric->edge_count, 3 );
    assert_true( fabric->area[0] == 0.0f && fabric->area[1] == 0.0f && fabric->area[2] == 0.0f );
}

static void expect_fabric_refusal( const wisp_fabric_def* def, const char* part )
{
    wisp_error error = { 0 };
    wisp_fabric* fabric = (wisp_fabric*)&error;
    assert_int_equal( wisp_fabric_cook( def, NULL, &fabric, &error ), WISP_BAD_INPUT );
    assert_null( fabric );
    assert_one_message( error.message );
    assert_contains( error.message, part );
}

TEST( bad_input_is_refused_by_a_message_that_names_it )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_plane( 4, 4 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    int32_t kept = mesh.triangles[7], attachment = 16;
    mesh.triangles[7] = 16;
    expect_fabric_refusal( &def, "triangle 2: got vertex 16" );
    mesh.triangles[7] = -1;
    expect_fabric_refusal( &def, "triangle 2: got vertex -1" );
    mesh.triangles[7] = mesh.triangles[6];
    expect_fabric_refusal( &def, "triangle 2: got vertex 1 twice" );
    mesh.triangles[7] = kept;
    static const float bad[] = { NAN, INFINITY, -INFINITY, 1.1e6f };
    for ( int i = 0; i < WISP_COUNT( bad ); ++i )
    {
        mesh.points[11].y = bad[i];
        expect_fabric_refusal( &def, "vertex 11" );
    }
    mesh.points[11].y = 0.0f;
    def.attachments = &attachment;
    def.attachment_count = 1;
    expect_fabric_refusal( &def, "attachment 0: got vertex 16" );
    def = test_fabric_def( &mesh );
    def.points = NULL;
    expect_fabric_refusal( &def, "got a null list" );
    def = test_fabric_def( &mesh );
    def.tile_size = 68;
    expect_fabric_refusal( &def, "tiles" );
}

TEST( cooking_without_memory_says_so_and_leaks_nothing )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_sphere( 5, 8 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    int32_t attachment = 3;
    def.hinges = def.tethers = true;
    def.coarse_sheets = true;
    def.attachments = &attachment;
    def.attachment_count = 1;
    bool refused = true;
    int64_t failures = 0;
    for ( int64_t n = 1; refused; ++n )
    {
        test_host host = { 0 };
        wisp_allocator allocator = test_host_allocator( &host );
        wisp_error error = { 0 };
        wisp_fabric* fabric = NULL;
        test_host_refuse( &host, n, false );
        wisp_status status = wisp_fabric_cook( &def, &allocator, &fabric, &error );
        refused = test_host_has_refused( &host );
        assert_int_equal( status, refused ? WISP_NO_MEMORY : WISP_OK );
        assert_int_equal( fabric == NULL, refused );
        failures += refused ? 1 : 0;
        wisp_fabric_release( fabric );
        assert_host_memory_is_released( &host );
    }
    assert_true( failures > 50 );
}

TEST( a_fabric_dies_with_its_last_owner )
{
    test_host host = { 0 };
    wisp_allocator allocator = test_host_allocator( &host );
    SCOPED( test_mesh_free ) test_mesh mesh = test_mesh_plane( 9, 9 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    wisp_fabric* fabric = NULL;
    assert_int_equal( wisp_fabric_cook( &def, &allocator, &fabric, NULL ), WISP_OK );

    // all scratch memory is freed, and the remainder is the size that the fabric reports
    assert_int_equal( (int64_t)wisp_fabric_bytes( fabric ), atomic_load( &host.bytes ) );
    wisp_fabric_retain( fabric );
    wisp_fabric_release( fabric );
    assert_fabric_holds( fabric, &def );
    wisp_fabric_release( fabric );
    wisp_fabric_release( NULL );
    assert_host_memory_is_released( &host );
}
