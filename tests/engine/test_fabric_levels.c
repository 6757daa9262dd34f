// Coarse levels: their vertices, links and parents; on planes, where straight lines are the reference.
#include "fabric_planes.h"

// Spacing of a level in mean edges, at level 0 of the list.
#define FIRST_SPACING ( 2.0 * 0.72 )

static wisp_fabric* cook_levels( const test_mesh* mesh, const int32_t* attachments, int count )
{
    wisp_fabric_def def = test_fabric_def( mesh );
    def.levels = WISP_FABRIC_MAX_LEVELS;
    def.attachments = attachments;
    def.attachment_count = count;
    wisp_fabric* fabric = test_fabric_cook( &def );
    assert_fabric_is_safe( fabric );
    return fabric;
}

static double mean_edge( const wisp_fabric* f )
{
    double sum = 0.0;
    for ( int e = 0; e < f->edge_count; ++e )
    {
        sum += vec_distance( f->rest[f->edges[2 * e]], f->rest[f->edges[2 * e + 1]] );
    }
    return sum / f->edge_count;
}

// The level of every slot: number of levels of the list that contain it.
static int* levels_of_slots( const wisp_fabric* f )
{
    int* level = checked_calloc( (size_t)f->slot_count, sizeof( int ) );
    for ( int l = 0; l < f->level_count; ++l )
    {
        for ( int i = 0; i < f->levels[l].vertex_count; ++i )
        {
            level[f->levels[l].vertex_x4[i] / 4] += 1;
        }
    }
    return level;
}

// Properties for every mesh: nesting, children, weights, lengths.
static void assert_levels_hold( const wisp_fabric* f )
{
    int* level = levels_of_slots( f );
    int finer = f->vertex_count;
    for ( int l = 0; l < f->level_count; ++l )
    {
        const wisp_fabric_level* at = &f->levels[l];
        int members = 0;
        for ( int slot = 0; slot < f->vertex_count; ++slot )
        {
            members += level[slot] > l ? 1 : 0;
        }

        // as many slots reached level l as it has, so its members are in all finer ones
        assert_int_equal( members, at->vertex_count );
        assert_int_equal( at->child_count, finer - at->vertex_count );
        finer = at->vertex_count;
        for ( int i = 0; i < fabric_padded( at->vertex_count ); ++i )
        {
            bool pads = i >= at->vertex_count;
            assert_true( pads ? at->vertex_x4[i] == 4 * f->vertex_count
                              : i == 0 || at->vertex_x4[i - 1] < at->vertex_x4[i] );
        }
        for ( int i = 0; i < fabric_padded( at->child_count ); ++i )
        {
            const int32_t* parent_x4 = at->parent_x4 + ( i / 8 * WISP_FABRIC_PARENTS * 8 + i % 8 );
            const float* weight = at->weight + ( i / 8 * WISP_FABRIC_PARENTS * 8 + i % 8 );
            bool pads = i >= at->child_count;
            double sum = 0.0;
            assert_true( pads ? at->child_x4[i] == 4 * f->vertex_count : level[at->child_x4[i] / 4] == l );
            for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
            {
                assert_true( weight[8 * k] >= 0.0f );
                assert_true( pads ? weight[8 * k] == 0.0f : level[parent_x4[8 * k] / 4] > l );
                sum += weight[8 * k];
            }

            // three roundings of numbers up to one
            assert_true( fabs( sum - ( pads ? 0.0 : 1.0 ) ) <= 3 * FLT_EPSILON );
        }
        int links = 0;
        for ( int i = 0; i < at->schedule.slot_count; ++i )
        {
            int32_t a = at->a_x4[i] / 4, b = at->b_x4[i] / 4;
            bool pads = at->schedule.constraint[i] < 0;
            links += pads ? 0 : 1;
            assert_true( pads ? at->rest[i] == 0.0f : level[a] > l && level[b] > l );
            assert_true( pads || at->rest[i] >= vec_distance( f->rest[a], f->rest[b] ) );
        }
        assert_int_equal( links, at->link_count );
    }
    free( level );
}

// Links whose length is not the distance of the same vertices of a flat mesh.
// @param flat [vertex_count] by the user's vertex
static int wrong_links( const wisp_fabric* f, const wisp_vec3* flat, double tolerance )
{
    int wrong = 0;
    for ( int l = 0; l < f->level_count; ++l )
    {
        const wisp_fabric_level* at = &f->levels[l];
        for ( int i = 0; i < at->schedule.slot_count; ++i )
        {
            if ( at->schedule.constraint[i] >= 0 )
            {
                wisp_vec3 a = flat[f->slot_vertex[at->a_x4[i] / 4]], b = flat[f->slot_vertex[at->b_x4[i] / 4]];
                double expected = vec_distance( a, b );
                wrong += fabs( at->rest[i] - expected ) > tolerance * expected ? 1 : 0;
            }
        }
    }
    return wrong;
}

// Children whose parents interpolate them to another position, on a flat mesh.
static int wrong_children( const wisp_fabric* f, const wisp_vec3* flat, int l, double tolerance )
{
    const wisp_fabric_level* at = &f->levels[l];
    int wrong = 0;
    for ( int i = 0; i < at->child_count; ++i )
    {
        wisp_vec3 sum = { 0.0f, 0.0f, 0.0f }, child = flat[f->slot_vertex[at->child_x4[i] / 4]];
        for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
        {
            int place = ( i / 8 * WISP_FABRIC_PARENTS + k ) * 8 + i % 8;
            wisp_vec3 p = flat[f->slot_vertex[at->parent_x4[place] / 4]];
            sum.x += at->weight[place] * p.x;
            sum.z += at->weight[place] * p.z;
        }
        wrong += hypot( sum.x - child.x, sum.z - child.z ) > tolerance ? 1 : 0;
    }
    return wrong;
}

// ---- vertices ----

static void a_level_keeps_its_spacing_and_cannot_be_extended( void** state )
{
    (void)state;
    for ( int kind = 0; kind < 3; ++kind )
    {
        test_mesh mesh = test_mesh_uneven_plane( 33, 29, 0.12f * (float)kind, 1.0f );
        wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
        int* level = levels_of_slots( f );
        double spacing = FIRST_SPACING * mean_edge( f );
        assert_true( f->level_count >= 3 );
        for ( int l = 0; l < f->level_count; ++l, spacing *= 2.0 )
        {
            for ( int a = 0; a < f->vertex_count; ++a )
            {
                double nearest = 1e30;
                for ( int i = 0; i < f->levels[l].vertex_count; ++i )
                {
                    int b = f->levels[l].vertex_x4[i] / 4;
                    nearest = a == b ? nearest : fmin( nearest, vec_distance( f->rest[a], f->rest[b] ) );
                }

                // lengths are in single precision
                assert_true( level[a] > l ? nearest > spacing * 0.99999
                                          : level[a] < l || nearest < spacing * 1.00001 );
            }
        }
        free( level );
        wisp_fabric_release( f );
        test_mesh_free( &mesh );
    }
}

static void attachments_are_in_every_level_and_not_linked_to_each_other( void** state )
{
    (void)state;
    test_mesh mesh = test_mesh_plane( 40, 40 );
    int32_t border[40];
    for ( int i = 0; i < 40; ++i )
    {
        border[i] = i;
    }
    wisp_fabric* f = cook_levels( &mesh, border, 40 );
    int* level = levels_of_slots( f );
    assert_true( f->level_count >= 3 );
    for ( int i = 0; i < 40; ++i )
    {
        assert_int_equal( level[f->vertex_slot[border[i]]], f->level_count );
    }
    for ( int l = 0; l < f->level_count; ++l )
    {
        const wisp_fabric_level* at = &f->levels[l];
        for ( int i = 0; i < at->schedule.slot_count; ++i )
        {
            bool pads = at->schedule.constraint[i] < 0;
            assert_true( pads || f->rest[at->a_x4[i] / 4].z > 0.0f || f->rest[at->b_x4[i] / 4].z > 0.0f );
        }

        // a dense border does not make a coarse level dense
        assert_true( at->link_count <= 6 * at->vertex_count );
    }
    assert_levels_hold( f );
    free( level );
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

static void large_levels_run_in_tiles_and_small_ones_in_one( void** state )
{
    (void)state;
    test_mesh mesh = test_mesh_plane( 64, 64 );
    wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
    const wisp_schedule *finest = &f->levels[0].schedule, *coarsest = &f->levels[f->level_count - 1].schedule;
    assert_true( finest->tile_count >= 4 && finest->tile_count <= f->levels[0].link_count / 512 );
    assert_int_equal( coarsest->tile_count, 1 );

    // two workers have work in each colour
    for ( int colour = 0; colour < finest->colour_count; ++colour )
    {
        assert_true( finest->colour_tile[colour + 1] - finest->colour_tile[colour] >= 2 );
    }
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

static void a_finest_level_of_two_begins_where_the_second_would_be( void** state )
{
    (void)state;
    test_mesh mesh = test_mesh_plane( 64, 64 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    def.levels = 2;
    def.finest_level = 2;
    wisp_fabric *sparse = test_fabric_cook( &def ), *all = cook_levels( &mesh, NULL, 0 );
    assert_fabric_is_safe( sparse );
    assert_levels_hold( sparse );
    assert_int_equal( sparse->level_count, 2 );
    for ( int l = 0; l < 2; ++l )
    {
        // chosen from other vertices, so about as many
        int expected = all->levels[l + 1].vertex_count;
        assert_in_range( sparse->levels[l].vertex_count, expected * 4 / 5, expected * 5 / 4 );
    }
    assert_int_equal( sparse->levels[0].child_count, sparse->vertex_count - sparse->levels[0].vertex_count );
    wisp_fabric_release( sparse );
    wisp_fabric_release( all );
    test_mesh_free( &mesh );
}

static void levels_thin_out_by_about_four_and_stop_before_they_are_tiny( void** state )
{
    (void)state;
    test_mesh mesh = test_mesh_plane( 64, 64 );
    wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
    int finer = f->vertex_count, links = 0;
    for ( int l = 0; l < f->level_count; ++l )
    {
        int count = f->levels[l].vertex_count;
        assert_in_range( count, l + 1 < f->level_count ? finer / 6 : 9, finer / 2 );
        finer = count;
        links += f->levels[l].link_count;
    }
    assert_in_range( f->level_count, 4, 5 );
    assert_in_range( finer, 9, 40 );
    assert_true( links <= f->link_count * 3 / 10 );
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

static void no_more_levels_come_than_are_queried_for_and_the_same_ones( void** state )
{
    (void)state;
    test_mesh mesh = test_mesh_uneven_plane( 40, 40, 0.2f, 1.0f );
    wisp_fabric* all = cook_levels( &mesh, NULL, 0 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    def.levels = 2;
    wisp_fabric* two = test_fabric_cook( &def );
    assert_true( all->level_count > 2 );
    assert_int_equal( two->level_count, 2 );
    for ( int l = 0; l < 2; ++l )
    {
        const wisp_fabric_level *a = &all->levels[l], *b = &two->levels[l];
        assert_int_equal( a->vertex_count, b->vertex_count );
        assert_int_equal( a->link_count, b->link_count );
        assert_int_equal( a->schedule.slot_count, b->schedule.slot_count );
        assert_memory_equal( a->vertex_x4, b->vertex_x4, (size_t)a->vertex_count * 4 );
        assert_memory_equal( a->rest, b->rest, (size_t)a->schedule.slot_count * 4 );
        assert_memory_equal( a->weight, b->weight, (size_t)fabric_padded( a->child_count ) * 16 );
    }
    wisp_fabric_release( all );
    wisp_fabric_release( two );
    test_mesh_free( &mesh );
}

// ---- lengths and weights ----

static void on_planes_links_are_straight_lines_and_parents_surround_their_children( void** state )
{
    (void)state;
    static const float jitters[] = { 0.0f, 0.1f, 0.24f };
    for ( int i = 0; i < WISP_COUNT( jitters ); ++i )
    {
        test_mesh mesh = test_mesh_uneven_plane( 48, 40, jitters[i], 1.0f );
        const int32_t attachments[] = { 0, 47 };
        wisp_fabric* f = cook_levels( &mesh, attachments, 2 );
        assert_levels_hold( f );
        assert_int_equal( wrong_links( f, mesh.points, 1e-4 ), 0 );
        for ( int l = 0; l < f->level_count; ++l )
        {
            // weights and distances in single precision, up to thirty metres long
            assert_int_equal( wrong_children( f, mesh.points, l, 1e-3 ), 0 );
        }
        wisp_fabric_release( f );
        test_mesh_free( &mesh );
    }
}

static void rolling_a_plane_up_changes_no_link( void** state )
{
    (void)state;
    test_mesh mesh = test_mesh_plane( 40, 30 );
    wisp_vec3* flat = test_mesh_roll( &mesh, 0.1 );
    wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
    assert_levels_hold( f );
    assert_true( f->level_count >= 3 );
    assert_int_equal( wrong_links( f, flat, 1e-4 ), 0 );
    wisp_fabric_release( f );
    free( flat );
    test_mesh_free( &mesh );
}

static void levels_of_large_meshes_are_measured_over_coarse_ones_and_still_hold( void** state )
{
    (void)state;
    test_mesh mesh = test_mesh_uneven_plane( 150, 150, 0.2f, 1.0f );
    wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
    int links = 0;
    for ( int l = 0; l < f->level_count; ++l )
    {
        links += f->levels[l].link_count;
    }
    assert_levels_hold( f );
    assert_true( f->level_count >= 5 );

    // triangles between coarse vertices leave a few gaps at seams of the packing, where paths go along links
    assert_in_range( wrong_links( f, mesh.points, 1e-4 ), 0, links / 500 );
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

// ---- other meshes ----

static void a_closed_mesh_without_attachments_has_levels( void** state )
{
    (void)state;
    test_mesh mesh = test_mesh_sphere( 19, 30 );
    wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
    assert_int_equal( f->tether_count, 0 );
    assert_true( f->level_count >= 2 );
    assert_levels_hold( f );
    for ( int l = 0; l < f->level_count; ++l )
    {
        const wisp_fabric_level* at = &f->levels[l];
        for ( int i = 0; i < at->schedule.slot_count; ++i )
        {
            double chord = vec_distance( f->rest[at->a_x4[i] / 4], f->rest[at->b_x4[i] / 4] );
            double circle = 2.0 * asin( fmin( 1.0, 0.5 * chord ) );
            assert_true( fabs( at->rest[i] - circle ) <= 0.02 * circle );
        }
    }
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

static void shells_have_no_links_or_parents_in_common_and_loose_vertices_stay_alone( void** state )
{
    (void)state;
    test_mesh above = test_mesh_plane( 12, 12 );
    for ( int v = 0; v < above.vertex_count; ++v )
    {
        above.points[v].y = 0.1f;
    }
    test_mesh mesh = test_mesh_join( test_mesh_plane( 12, 12 ), above );
    mesh.vertex_count += 1;
    wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
    int* level = levels_of_slots( f );
    assert_true( f->level_count >= 1 );
    assert_levels_hold( f );
    assert_int_equal( level[f->vertex_slot[288]], f->level_count );
    for ( int l = 0; l < f->level_count; ++l )
    {
        const wisp_fabric_level* at = &f->levels[l];
        for ( int i = 0; i < at->schedule.slot_count; ++i )
        {
            int32_t a = f->slot_vertex[at->a_x4[i] / 4], b = f->slot_vertex[at->b_x4[i] / 4];
            assert_true( a < 288 && b < 288 && ( a < 144 ) == ( b < 144 ) );
        }
        for ( int i = 0; i < 4 * at->child_count / 8 * 8; ++i )
        {
            int child = i / 32 * 8 + i % 8;
            int32_t c = f->slot_vertex[at->child_x4[child] / 4], p = f->slot_vertex[at->parent_x4[i] / 4];
            assert_true( child >= at->child_count || ( c < 144 ) == ( p < 144 ) );
        }
    }
    free( level );
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

static void tiny_meshes_have_no_levels( void** state )
{
    (void)state;
    test_mesh meshes[] = { test_mesh_make( 0, 0 ),  test_mesh_make( 1, 0 ),  test_mesh_make( 40, 0 ),
                           test_mesh_plane( 2, 2 ), test_mesh_plane( 3, 3 ), test_mesh_fan( 5 ) };
    for ( int i = 0; i < WISP_COUNT( meshes ); ++i )
    {
        wisp_fabric* f = cook_levels( &meshes[i], NULL, 0 );
        assert_int_equal( f->level_count, 0 );
        wisp_fabric_release( f );
        test_mesh_free( &meshes[i] );
    }
}

static void ribbons_fans_books_and_flattened_meshes_hold_too( void** state )
{
    (void)state;
    test_mesh meshes[] = { test_mesh_plane( 200, 2 ),
                           test_mesh_fan( 300 ),
                           test_mesh_book( 30 ),
                           test_mesh_moebius( 60, 5 ),
                           test_mesh_uneven_plane( 30, 30, 0.2f, 0.05f ),
                           test_mesh_uneven_plane( 30, 30, 0.0f, 1e-5f ),
                           test_mesh_uneven_plane( 30, 30, 0.0f, 0.0f ) };
    for ( int i = 0; i < WISP_COUNT( meshes ); ++i )
    {
        const int32_t attachments[] = { 0, 1 };
        wisp_fabric* f = cook_levels( &meshes[i], attachments, i % 3 );
        assert_levels_hold( f );
        assert_true( i != 0 || f->level_count >= 2 );
        wisp_fabric_release( f );
        test_mesh_free( &meshes[i] );
    }
}

static void points_that_all_coincide_have_no_levels( void** state )
{
    (void)state;
    test_mesh mesh = test_mesh_plane( 10, 10 );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        mesh.points[v] = ( wisp_vec3 ){ 1.0f, 2.0f, 3.0f };
    }
    wisp_fabric* f = cook_levels( &mesh, NULL, 0 );
    assert_int_equal( f->level_count, 0 );
    wisp_fabric_release( f );
    test_mesh_free( &mesh );
}

static void the_same_mesh_has_the_same_levels_bit_for_bit( void** state )
{
    (void)state;
    test_mesh mesh = test_mesh_uneven_plane( 30, 30, 0.2f, 1.0f );
    const int32_t attachments[] = { 0, 29, 450 };
    wisp_fabric *a = cook_levels( &mesh, attachments, 3 ), *b = cook_levels( &mesh, attachments, 3 );

    // the hash is over every array of every level
    assert_true( a->hash == b->hash && a->level_count == b->level_count );
    wisp_fabric_release( a );
    wisp_fabric_release( b );
    test_mesh_free( &mesh );
}

// ---- memory ----

// @param step refuse every `step`-th request
static void expect_failures( const test_mesh* mesh, int64_t step )
{
    const int32_t attachments[] = { 0, 1, 5 };
    wisp_fabric_def def = test_fabric_def( mesh );
    def.levels = WISP_FABRIC_MAX_LEVELS;
    def.attachments = attachments;
    def.attachment_count = 3;
    assert_no_cook_without_memory( &def, step );
}

static void levels_without_memory_fail_and_leak_nothing( void** state )
{
    (void)state;
    test_mesh small = test_mesh_plane( 14, 14 ), large = test_mesh_plane( 130, 130 );
    expect_failures( &small, 1 );

    // so large that marches run over coarse nets; requests of the fabric's other parts are tested on the small one
    expect_failures( &large, 7 );
    test_mesh_free( &small );
    test_mesh_free( &large );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_level_keeps_its_spacing_and_cannot_be_extended ),
        cmocka_unit_test( attachments_are_in_every_level_and_not_linked_to_each_other ),
        cmocka_unit_test( large_levels_run_in_tiles_and_small_ones_in_one ),
        cmocka_unit_test( a_finest_level_of_two_begins_where_the_second_would_be ),
        cmocka_unit_test( levels_thin_out_by_about_four_and_stop_before_they_are_tiny ),
        cmocka_unit_test( no_more_levels_come_than_are_queried_for_and_the_same_ones ),
        cmocka_unit_test( on_planes_links_are_straight_lines_and_parents_surround_their_children ),
        cmocka_unit_test( rolling_a_plane_up_changes_no_link ),
        cmocka_unit_test( levels_of_large_meshes_are_measured_over_coarse_ones_and_still_hold ),
        cmocka_unit_test( a_closed_mesh_without_attachments_has_levels ),
        cmocka_unit_test( shells_have_no_links_or_parents_in_common_and_loose_vertices_stay_alone ),
        cmocka_unit_test( tiny_meshes_have_no_levels ),
        cmocka_unit_test( ribbons_fans_books_and_flattened_meshes_hold_too ),
        cmocka_unit_test( points_that_all_coincide_have_no_levels ),
        cmocka_unit_test( the_same_mesh_has_the_same_levels_bit_for_bit ),
        cmocka_unit_test( levels_without_memory_fail_and_leak_nothing ),
    };
    return cmocka_run_group_tests_name( "fabric levels", tests, NULL, NULL );
}
